//! Elements of one kind with the coordinates each one reads.

use wale_numerics::check::Local;

use super::coordinates::Dof;
use crate::energy::Element;

/// Elements of one kind.
#[derive(Clone, Debug)]
pub struct Elements<E, const N: usize> {
    /// The elements.
    pub elements: Vec<E>,
    /// The coordinates each reads, in its local order.
    pub stencils: Vec<[Dof; N]>,
}

impl<E, const N: usize> Default for Elements<E, N> {
    fn default() -> Self {
        Self { elements: Vec::new(), stencils: Vec::new() }
    }
}

impl<E: Element<N>, const N: usize> Elements<E, N> {
    /// Adds an element.
    pub fn push(&mut self, element: E, stencil: [Dof; N]) {
        self.elements.push(element);
        self.stencils.push(stencil);
    }
    /// The same places with other elements.
    pub fn map<F>(self, element: impl FnMut(E) -> F) -> Elements<F, N> {
        Elements { elements: self.elements.into_iter().map(element).collect(), stencils: self.stencils }
    }
    /// Number of elements.
    #[must_use]
    pub fn len(&self) -> usize {
        self.elements.len()
    }
    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.elements.is_empty()
    }
    /// Local coordinates of an element.
    #[must_use]
    pub fn local(&self, index: usize, q: &[f64]) -> [f64; N] {
        let stencil = &self.stencils[index];
        std::array::from_fn(|i| q[stencil[i] as usize])
    }
    /// Sum of the energies \[J\].
    #[must_use]
    pub fn energy(&self, q: &[f64]) -> f64 {
        (0..self.len()).map(|index| self.elements[index].energy(&self.local(index, q))).sum()
    }
}

/// What is done with each element: its stencil, gradient, and Hessian by row and column.
pub type Visit<'a> = dyn FnMut(&[Dof], &[f64], &dyn Fn(usize, usize) -> f64) + 'a;

/// Elements of some kind, as a solver that visits them one by one sees them.
pub trait ElementSet {
    /// Name of the kind.
    fn name(&self) -> &'static str;
    /// Sum of the energies \[J\].
    fn total(&self, q: &[f64]) -> f64;
    /// Calls `visit` with the stencil of every element, in order.
    fn stencils(&self, visit: &mut dyn FnMut(&[Dof]));
    /// Calls `visit(stencil, gradient, Hessian)` for every element, in order, and returns the energy \[J\]; the Hessian is
    /// between the exact one (`convexity = 0`) and a positive semi-definite one (`convexity = 1`). Of an element that does not act the
    /// gradient is empty and the Hessian zero.
    fn visit(&self, q: &[f64], convexity: f64, visit: &mut Visit<'_>) -> f64;
    /// Calls `visit(stencil, gradient)` for every element and returns the energy \[J\].
    fn visit_gradient(&self, q: &[f64], visit: &mut dyn FnMut(&[Dof], &[f64])) -> f64;
}

impl<E: Element<N>, const N: usize> ElementSet for Elements<E, N> {
    fn name(&self) -> &'static str {
        E::NAME
    }
    fn total(&self, q: &[f64]) -> f64 {
        self.energy(q)
    }
    fn stencils(&self, visit: &mut dyn FnMut(&[Dof])) {
        self.stencils.iter().for_each(|stencil| visit(stencil));
    }
    fn visit(&self, q: &[f64], convexity: f64, visit: &mut Visit<'_>) -> f64 {
        let mut energy = 0.0;
        for (index, element) in self.elements.iter().enumerate() {
            let q = self.local(index, q);
            if !element.acts(&q) {
                visit(&self.stencils[index], &[], &|_, _| 0.0);
                continue;
            }
            let mut local = Local::zero();
            element.add_blended(&q, convexity, &mut local);
            energy += local.energy;
            visit(&self.stencils[index], &local.gradient, &|i, j| local.hessian[i][j]);
        }
        energy
    }
    fn visit_gradient(&self, q: &[f64], visit: &mut dyn FnMut(&[Dof], &[f64])) -> f64 {
        let mut energy = 0.0;
        for (index, element) in self.elements.iter().enumerate() {
            let (value, gradient) = element.gradient(&self.local(index, q));
            energy += value;
            visit(&self.stencils[index], &gradient);
        }
        energy
    }
}
