//! The energy of a shell by the places of its vertices, with its derivatives as a block-sparse matrix.

use std::sync::Arc;

use wale::energy::{BendingStiffness, Element, Hinge, Membrane, MembraneStiffness};
use wale::fabric::coordinates::BLOCK;
use wale::fabric::{Dof, Elements};
use wale_numerics::block_matrix::BlockMatrix;
use wale_numerics::block_pattern::BlockPattern;
use wale_numerics::check::Local;
use wale_numerics::sparse_cholesky::{BlockOrder, CholeskyError, SparseCholesky};
use wale_numerics::trust::Foreseen;

use super::card::ShellCard;
use super::error::ShellError;
use super::mesh::TriangleMesh;

/// Values of a block.
const BLOCK_VALUES: usize = BLOCK * BLOCK;

/// A piece of fabric whose vertices are in part held.
///
/// Places are vectors of five slots a vertex, of which three are the position \[m\] and two stay zero.
#[derive(Debug)]
pub struct ShellSystem {
    membranes: Elements<Membrane, 9>,
    hinges: Elements<Hinge, 12>,
    /// Energy of each hinge by each bending stiffness, over the square of its angle \[–\].
    hinge_shares: Vec<[f64; BendingStiffness::COUNT]>,
    /// Mass of each vertex \[kg\].
    masses: Vec<f64>,
    /// Weight of each slot \[N\].
    weight: Vec<f64>,
    free: Vec<bool>,
    matrix: BlockMatrix,
    factor: SparseCholesky,
    /// Where in the matrix the second derivatives of every element go, element by element, column by column.
    places: Vec<u32>,
    /// Multiple of the identity that the matrix holds \[N/m\].
    shift: f64,
    gradient: Vec<f64>,
    element_force: f64,
    /// Mean length of the mesh's edges \[m\].
    edge: f64,
    ones: Vec<f64>,
}

impl ShellSystem {
    /// A mesh of this fabric, cut so that its first coordinate runs at `angle` \[rad\] from the weft towards the warp, under
    /// `gravity` \[m/s²\]. `held` says of each coordinate of each vertex whether it is held.
    ///
    /// A shell whose every third coordinate is held stays flat, and has no hinges.
    ///
    /// # Errors
    /// [`ShellError::Number`] and [`ShellError::Mesh`] where card or mesh are of no use, [`ShellError::Cholesky`] if it does not
    /// fit in memory.
    pub fn new(
        mesh: &TriangleMesh,
        card: &ShellCard,
        angle: f64,
        gravity: [f64; 3],
        held: &[[bool; 3]],
    ) -> Result<Self, ShellError> {
        card.check()?;
        if held.len() != mesh.points.len() || mesh.triangles.is_empty() {
            return Err(ShellError::Mesh("there are no triangles, or not a flag for each vertex".into()));
        }
        let (sin, cos) = angle.sin_cos();
        let fabric = |v: u32| {
            let [x, y] = mesh.points[v as usize];
            [cos * x - sin * y, sin * x + cos * y]
        };
        let edges = mesh.inner_edges()?;
        let mut masses = vec![0.0; mesh.points.len()];
        let mut membranes = Elements::default();
        for t in &mesh.triangles {
            let element = Membrane::new(card.membrane, t.map(fabric))
                .ok_or_else(|| ShellError::Mesh(format!("triangle {t:?} has no area")))?;
            for &v in t {
                masses[v as usize] += card.areal_mass * element.area / 3.0;
            }
            membranes.push(element, std::array::from_fn(|k| slot(BLOCK * t[k / 3] as usize + k % 3)));
        }
        let (mut hinges, mut hinge_shares) = (Elements::default(), Vec::new());
        if held.iter().any(|held| !held[2]) {
            for e in &edges {
                let rest = e.map(fabric);
                let weigh = |stiffness: &BendingStiffness| {
                    Hinge::new(stiffness, rest)
                        .ok_or_else(|| ShellError::Mesh(format!("edge {e:?} has a flat triangle")))
                };
                hinges.push(weigh(&card.bending)?, std::array::from_fn(|k| slot(BLOCK * e[k / 3] as usize + k % 3)));
                let mut shares = [0.0; BendingStiffness::COUNT];
                for (index, share) in shares.iter_mut().enumerate() {
                    *share = weigh(&BendingStiffness::unit(index))?.weight;
                }
                hinge_shares.push(shares);
            }
        }
        let free: Vec<bool> =
            held.iter().flat_map(|held| (0..BLOCK).map(move |slot| slot < 3 && !held[slot])).collect();
        let pairs = |of: &[Dof]| {
            let blocks: Vec<u32> = of.iter().step_by(3).map(|&d| d / BLOCK as u32).collect();
            blocks.iter().flat_map(|&a| blocks.iter().map(move |&b| (a, b))).collect::<Vec<_>>()
        };
        let pairs =
            membranes.stencils.iter().flat_map(|s| pairs(s)).chain(hinges.stencils.iter().flat_map(|s| pairs(s)));
        let pattern = Arc::new(BlockPattern::from_pairs(mesh.points.len(), pairs.collect::<Vec<_>>()));
        let mut places = Vec::new();
        for stencil in &membranes.stencils {
            push_places(&pattern, stencil, &mut places);
        }
        for stencil in &hinges.stencils {
            push_places(&pattern, stencil, &mut places);
        }
        let factor = SparseCholesky::new(Arc::clone(&pattern), &free, BlockOrder::MinimumDegree)?;
        let length = |e: &[u32; 4]| {
            let [p, q] = [e[0], e[1]].map(|v| mesh.points[v as usize]);
            (p[0] - q[0]).hypot(p[1] - q[1])
        };
        let area: f64 = mesh.areas().sum::<f64>() / mesh.triangles.len() as f64;
        let edge = if edges.is_empty() {
            (2.0 * area).sqrt()
        } else {
            edges.iter().map(length).sum::<f64>() / edges.len() as f64
        };
        let mut system = Self {
            hinge_shares,
            weight: vec![0.0; free.len()],
            masses,
            matrix: BlockMatrix::zeros(pattern),
            factor,
            places,
            shift: 0.0,
            gradient: vec![0.0; free.len()],
            element_force: 0.0,
            edge,
            ones: vec![1.0; free.len()],
            free,
            membranes,
            hinges,
        };
        system.set_gravity(gravity);
        Ok(system)
    }

    /// Puts the piece under another gravity \[m/s²\].
    pub fn set_gravity(&mut self, gravity: [f64; 3]) {
        for (slots, mass) in self.weight.chunks_exact_mut(BLOCK).zip(&self.masses) {
            slots.iter_mut().zip(gravity).for_each(|(weight, g)| *weight = mass * g);
        }
    }

    /// Which slots are unknowns.
    #[must_use]
    pub fn free(&self) -> &[bool] {
        &self.free
    }
    /// Mean length of the mesh's edges \[m\].
    #[must_use]
    pub fn edge(&self) -> f64 {
        self.edge
    }
    /// Largest stretch stiffness \[N/m\].
    #[must_use]
    pub fn stiffness(&self) -> f64 {
        self.membranes.elements.first().map_or(0.0, |m| m.stiffness.xx.max(m.stiffness.yy))
    }
    /// Gradient of the energy where it was last linearised \[N\]; at held slots what holds them.
    #[must_use]
    pub fn gradient(&self) -> &[f64] {
        &self.gradient
    }

    /// Energy \[J\] of the elements less the work of the weight.
    #[must_use]
    pub fn energy(&self, q: &[f64]) -> f64 {
        self.membranes.energy(q) + self.hinges.energy(q) - dot(&self.weight, q)
    }

    /// Energy \[J\]; finds the gradient, and second derivatives between the exact (`convexity = 0`) and positive semi-definite
    /// ones (`convexity = 1`).
    pub fn linearise(&mut self, q: &[f64], convexity: f64) -> f64 {
        self.shift = 0.0;
        self.matrix.values.fill(0.0);
        self.gradient.iter_mut().zip(&self.weight).for_each(|(g, w)| *g = -w);
        self.element_force = self.weight.iter().fold(0.0f64, |m, w| m.max(w.abs()));
        let mut into = Assembly {
            matrix: &mut self.matrix.values,
            gradient: &mut self.gradient,
            force: &mut self.element_force,
            places: &self.places,
        };
        let energy = into.add(&self.membranes, q, convexity) + into.add(&self.hinges, q, convexity);
        energy - dot(&self.weight, q)
    }

    /// Largest component of the gradient by an unknown, over the largest force that an element exerts \[–\].
    ///
    /// Forces below `10⁻⁹` of what a stretch by one would exert on an edge count as none.
    #[must_use]
    pub fn residual(&self) -> f64 {
        let free = self.gradient.iter().zip(&self.free).filter(|(_, free)| **free);
        // Written so that a NaN is never at rest.
        let largest = free.fold(0.0f64, |m, (g, _)| if g.abs() <= m { m } else { g.abs() });
        largest / self.element_force.max(1e-9 * self.stiffness() * self.edge)
    }

    /// Newton's step with a multiple of the identity \[N/m\] added to the second derivatives, and its slope and curvature `gᵀd`
    /// and `dᵀHd` \[J\]; `None` if they are not positive definite even so.
    ///
    /// # Errors
    /// [`CholeskyError::NotFinite`].
    pub fn step(&mut self, shift: f64) -> Result<Option<ShellStep>, CholeskyError> {
        if shift != self.shift {
            self.matrix.add_diagonal(&self.ones, shift - self.shift);
            self.shift = shift;
        }
        match self.factor.factor(&self.matrix, 0.0) {
            Err(CholeskyError::NotPositiveDefinite { .. }) => return Ok(None),
            other => other?,
        }
        let mut direction: Vec<f64> = self.gradient.iter().map(|g| -g).collect();
        self.factor.solve_in_place(&mut direction);
        let slope = dot(&direction, &self.gradient);
        let curvature = -slope - shift * dot(&direction, &direction);
        Ok(Some(ShellStep { direction, foreseen: Foreseen { slope, curvature } }))
    }

    /// The largest part of a step, at most one, in which no triangle loses a tenth of what keeps its area from vanishing, and no
    /// coordinate moves further than `most` \[m\].
    #[must_use]
    pub fn longest_step(&self, q: &[f64], direction: &[f64], most: f64) -> f64 {
        let largest = direction.iter().fold(0.0f64, |m, d| m.max(d.abs()));
        let mut longest = 1.0f64.min(most / largest.max(f64::MIN_POSITIVE));
        for index in 0..self.membranes.len() {
            let part = Membrane::longest_step(&self.membranes.local(index, q), &self.membranes.local(index, direction));
            if part < 1.0 {
                longest = longest.min(0.9 * part);
            }
        }
        longest
    }

    /// Takes the exact second derivatives and their factor at an equilibrium, for sensitivities.
    ///
    /// # Errors
    /// [`CholeskyError`] where it is no strict minimum.
    pub fn prepare_sensitivity(&mut self, q: &[f64]) -> Result<(), CholeskyError> {
        self.linearise(q, 0.0);
        self.factor.factor(&self.matrix, 0.0)
    }

    /// `H⁻¹ b` over the unknowns; zero at held slots. After [`Self::prepare_sensitivity`].
    pub fn solve(&mut self, b: &mut [f64]) {
        self.factor.solve_in_place(b);
    }
    /// `H b` over all slots, held ones included. After [`Self::prepare_sensitivity`].
    #[must_use]
    pub fn multiply(&self, b: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; b.len()];
        self.matrix.multiply(b, &mut out);
        out
    }

    /// Derivative of `direction · gradient` by each in-plane stiffness \[m\] for a direction over all slots.
    #[must_use]
    pub fn by_membrane(&self, q: &[f64], direction: &[f64]) -> [f64; MembraneStiffness::COUNT] {
        let mut out = [0.0; MembraneStiffness::COUNT];
        for (index, element) in self.membranes.elements.iter().enumerate() {
            let (place, along) = (self.membranes.local(index, q), self.membranes.local(index, direction));
            let slopes = element.gradient_slopes(&place, &along);
            out.iter_mut().zip(slopes).for_each(|(sum, slope)| *sum += slope);
        }
        out
    }

    /// Derivative of `direction · gradient` by each bending stiffness \[1\] for a direction over all slots.
    #[must_use]
    pub fn by_bending(&self, q: &[f64], direction: &[f64]) -> [f64; BendingStiffness::COUNT] {
        let mut out = [0.0; BendingStiffness::COUNT];
        for (index, shares) in self.hinge_shares.iter().enumerate() {
            let gradient = Hinge { weight: 1.0 }.gradient(&self.hinges.local(index, q)).1;
            let slope = dot(&gradient, &self.hinges.local(index, direction));
            out.iter_mut().zip(shares).for_each(|(sum, share)| *sum += share * slope);
        }
        out
    }
}

/// A step by all slots.
#[derive(Clone, Debug)]
pub struct ShellStep {
    /// Change of each slot \[m\].
    pub direction: Vec<f64>,
    /// What it is foreseen to gain \[J\].
    pub foreseen: Foreseen,
}

/// Where the derivatives of elements are added up.
struct Assembly<'a> {
    matrix: &'a mut [f64],
    gradient: &'a mut [f64],
    force: &'a mut f64,
    /// Places that are not yet used.
    places: &'a [u32],
}

impl Assembly<'_> {
    /// Adds all elements of a kind; their energy \[J\].
    fn add<E: Element<N>, const N: usize>(&mut self, set: &Elements<E, N>, q: &[f64], convexity: f64) -> f64 {
        let mut energy = 0.0;
        for (index, (element, stencil)) in set.elements.iter().zip(&set.stencils).enumerate() {
            let mut local = Local::zero();
            element.add_blended(&set.local(index, q), convexity, &mut local);
            energy += local.energy;
            let (here, rest) = self.places.split_at(N * N);
            self.places = rest;
            for (&place, value) in here.iter().zip(local.hessian.iter().flatten()) {
                self.matrix[place as usize] += value;
            }
            for (&dof, g) in stencil.iter().zip(&local.gradient) {
                self.gradient[dof as usize] += g;
                *self.force = self.force.max(g.abs());
            }
        }
        energy
    }
}

fn slot(index: usize) -> Dof {
    Dof::try_from(index).expect("a mesh of fewer than a thousand million vertices")
}

fn push_places(pattern: &BlockPattern, stencil: &[Dof], places: &mut Vec<u32>) {
    for &b in stencil {
        for &a in stencil {
            let (a, b) = (a as usize, b as usize);
            let block = pattern.position(a / BLOCK, b / BLOCK).expect("what an element couples meets");
            places.push((BLOCK_VALUES * block + BLOCK * (b % BLOCK) + a % BLOCK) as u32);
        }
    }
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
