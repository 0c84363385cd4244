//! How stress and compression of a tile in equilibrium follow the numbers of its material.

use wale::energy::{ContactPhase, Element, RodBending, RodContact, RodStretch};
use wale_numerics::block_matrix::SLOTS;

use serde::{Deserialize, Serialize};

use super::coarse::{CoarseDeformation, times};
use super::equilibrium::{EquilibriumSettings, TileError, TileSolver};
use super::kinds::Image;
use super::material::RodMaterial;
use super::system::TileSystem;
use super::tile::YarnTile;

/// A number of a material that a fit may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RodParameter {
    /// `k_s1` \[N\].
    SoftStretch,
    /// `k_s2` \[N\].
    StiffStretch,
    /// `ε̄` \[–\].
    Onset,
    /// `k_b` \[N·m²\].
    Bending,
    /// `R₁` \[m\].
    OuterRadius,
    /// `k_c1` \[J/m²\].
    OuterContact,
    /// `k_h` \[N/m²\].
    Holding,
}

impl RodParameter {
    /// Number of them.
    pub const COUNT: usize = 7;
    /// All, in the order of arrays.
    pub const ALL: [Self; Self::COUNT] = [
        Self::SoftStretch,
        Self::StiffStretch,
        Self::Onset,
        Self::Bending,
        Self::OuterRadius,
        Self::OuterContact,
        Self::Holding,
    ];
    /// What they are called in files, in the same order.
    pub const NAMES: [&'static str; Self::COUNT] = ["k_s1", "k_s2", "onset", "k_b", "R_1", "k_c1", "k_h"];
}

impl RodMaterial {
    /// The numbers that a fit may change, in the order of [`RodParameter::ALL`].
    #[must_use]
    pub fn parameters(&self) -> [f64; RodParameter::COUNT] {
        let ContactPhase { radius, stiffness } = self.contact[0];
        [self.soft_stretch, self.stiff_stretch, self.onset, self.bending, radius, stiffness, self.holding]
    }

    /// The same material with these numbers.
    #[must_use]
    pub fn with_parameters(&self, parameters: [f64; RodParameter::COUNT]) -> Self {
        let [soft_stretch, stiff_stretch, onset, bending, radius, stiffness, holding] = parameters;
        let contact = [ContactPhase { radius, stiffness }, self.contact[1]];
        Self { soft_stretch, stiff_stretch, onset, bending, contact, reading: self.reading, holding }
    }
}

/// Derivatives of what a stretch test measures, through equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EquilibriumSlopes {
    /// `dσ_s/dp`, the stress in N/m.
    pub stress: [f64; RodParameter::COUNT],
    /// `dc/dp` of a free compression, else zero.
    pub compression: [f64; RodParameter::COUNT],
    /// Whether the equilibrium is a minimum of the energy. If not, the second derivatives were shifted to find these.
    pub stable: bool,
}

/// A bending stiffness with its derivatives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BendingAnswer {
    /// Stiffness \[N·m\].
    pub stiffness: f64,
    /// Derivatives by the numbers of the material.
    pub slope: [f64; RodParameter::COUNT],
}

/// As [`super::bending_stiffness`], with derivatives: at rest the energy changes with a number of the material as if nothing moved.
///
/// # Errors
/// As there.
pub fn bending_answer(
    tile: &YarnTile,
    material: &RodMaterial,
    settings: EquilibriumSettings,
    flat: &CoarseDeformation,
    curvature: f64,
) -> Result<BendingAnswer, TileError> {
    let mut solver = TileSolver::new(tile, material, settings)?;
    let (mut stiffness, mut slope) = (0.0, [0.0; RodParameter::COUNT]);
    // Back to the flat tile before it is bent the other way.
    for (curvature_now, factor) in [(0.0, -2.0), (curvature, 1.0), (0.0, 0.0), (-curvature, 1.0)] {
        let found = solver.solve(&flat.bent(curvature_now))?;
        if !found.converged {
            return Err(TileError::NoEquilibrium { residual: found.residual });
        }
        let factor = factor / (curvature * curvature);
        stiffness += factor * found.energy_density;
        let energies = solver.system.energy_by_parameters(&solver.displacement);
        slope.iter_mut().zip(energies).for_each(|(s, e)| *s += factor * e / tile.area());
    }
    Ok(BendingAnswer { stiffness, slope })
}

/// A motion of the whole tile: of its vertices, and of its plane.
struct Motion {
    vertices: Vec<f64>,
    plane: [[f64; 2]; 2],
}

impl Motion {
    fn of(&self, system: &TileSystem, image: Image) -> [f64; 3] {
        let x = system.tile.image(image.vertex, image.shift);
        let [a, b] = times(&self.plane, [x[0], x[1]]);
        let u = &self.vertices[SLOTS * image.vertex as usize..];
        [a + u[0], b + u[1], u[2]]
    }
}

/// Largest shift, and by how much it grows, in units of force over length.
const LARGEST_SHIFT: f64 = 1e6;
const GROWTH: f64 = 10.0;
const FIRST_SHIFT: f64 = 1e-6;

impl TileSolver {
    /// Derivatives of stress and compression by the numbers of the material, where the last solve has ended.
    ///
    /// At rest `∂W/∂z = 0` in the unknowns `z = (ũ, c)`, so that `dz/dp = −H⁻¹ ∂²W/∂z∂p`, and
    /// `A dσ_s/dp = ∂²W/∂s∂p − ∂²W/∂s∂z H⁻¹ ∂²W/∂z∂p`. With `λ = H⁻¹ ∂²W/∂z∂s` one solve answers for all numbers (the adjoint), and
    /// one more for the compression.
    ///
    /// # Errors
    /// [`TileError`]; [`TileError::Deformation`] of a bent tile.
    pub fn slopes(&mut self) -> Result<EquilibriumSlopes, TileError> {
        let deformation = self.system.deformation;
        if deformation.curvature != 0.0 {
            let (determinant, curvature) = (deformation.determinant(), deformation.curvature);
            return Err(TileError::Deformation { determinant, curvature });
        }
        let weight = self.system.tile.area() * self.displacement.len() as f64 / (3.0 * SLOTS as f64);
        let free = self.free_compression;
        let (mut coupling, coupled) = self.system.stretch_border(&self.displacement);
        self.system.constraints.project(&mut coupling);
        self.system.linearise(&self.displacement, 0.0);
        let mut shift = 0.0;
        while !self.system.second.factor(shift, weight)? {
            shift = (GROWTH * shift).max(FIRST_SHIFT * self.force / self.length);
            if shift > LARGEST_SHIFT * self.force / self.length {
                return Err(TileError::NoEquilibrium { residual: self.residual });
            }
        }
        let (stretch, compress) = (deformation.stretch_rate(), deformation.compression_rate());
        let scaled = |rate: [[f64; 2]; 2], factor: f64| rate.map(|row| row.map(|r| factor * r));
        let mut border = if free { vec![coupled] } else { Vec::new() };
        self.system.second.solve(&mut coupling, &mut border);
        let back = scaled(compress, border.first().copied().unwrap_or(0.0));
        let along = Motion {
            vertices: coupling.iter().map(|x| -x).collect(),
            plane: std::array::from_fn(|i| std::array::from_fn(|j| stretch[i][j] - back[i][j])),
        };
        let mut across = Motion { vertices: vec![0.0; self.displacement.len()], plane: [[0.0; 2]; 2] };
        if free {
            let mut border = vec![1.0];
            self.system.second.solve(&mut across.vertices, &mut border);
            across.plane = scaled(compress, border[0]);
        }
        let area = self.system.tile.area();
        let work = self.system.work_of_parameters(&self.displacement, &[along, across]);
        Ok(EquilibriumSlopes {
            stress: work.map(|[along, _]| along / area),
            compression: work.map(|[_, across]| -across),
            stable: shift == 0.0,
        })
    }
}

impl TileSystem {
    /// `∂²W/∂ũ∂s`, and `∂²W/∂c∂s`, of a flat tile.
    fn stretch_border(&self, displacement: &[f64]) -> (Vec<f64>, f64) {
        let mut border = (vec![0.0; displacement.len()], 0.0);
        self.add_stretch_border(&self.stretch, displacement, &mut border);
        self.add_stretch_border(&self.bending, displacement, &mut border);
        self.add_stretch_border(&self.contact, displacement, &mut border);
        self.add_stretch_border(&self.stick, displacement, &mut border);
        border
    }

    fn add_stretch_border<E: Element<N>, const N: usize, const K: usize>(
        &self,
        kind: &super::kinds::Kind<E, K>,
        displacement: &[f64],
        (border, corner): &mut (Vec<f64>, f64),
    ) {
        let still = vec![0.0; displacement.len()];
        let motion = |plane| Motion { vertices: still.clone(), plane };
        let (along, across) = (motion(self.deformation.stretch_rate()), motion(self.deformation.compression_rate()));
        for (element, stencil) in kind.elements.iter().zip(&kind.stencils) {
            let q: [f64; N] = self.positions(stencil, displacement);
            if !element.acts(&q) {
                continue;
            }
            let mut local = wale_numerics::check::Local::zero();
            element.add_blended(&q, 0.0, &mut local);
            let moves = stencil.map(|image| along.of(self, image));
            for (a, &image) in stencil.iter().enumerate() {
                let narrowing = across.of(self, image);
                for i in 0..3 {
                    let value: f64 = (0..K)
                        .map(|b| (0..3).map(|j| local.hessian[3 * a + i][3 * b + j] * moves[b][j]).sum::<f64>())
                        .sum();
                    border[SLOTS * image.vertex as usize + i] += value;
                    *corner += narrowing[i] * value;
                }
            }
        }
    }

    /// How the forces change with each number of the material, and the work that these changes do in two motions.
    fn work_of_parameters(&self, displacement: &[f64], motions: &[Motion; 2]) -> [[f64; 2]; RodParameter::COUNT] {
        let mut work = [[0.0; 2]; RodParameter::COUNT];
        for (element, stencil) in self.stretch.elements.iter().zip(&self.stretch.stencils) {
            let q = self.positions(stencil, displacement);
            let soft = RodStretch { soft: 1.0, stiff: 0.0, ..*element }.gradient(&q).1;
            let stiff = RodStretch { soft: 0.0, stiff: 1.0, ..*element }.gradient(&q).1;
            self.add_work(stencil, &soft, motions, &mut work[RodParameter::SoftStretch as usize]);
            self.add_work(stencil, &stiff, motions, &mut work[RodParameter::StiffStretch as usize]);
            self.add_work(stencil, &element.gradient_by_onset(&q), motions, &mut work[RodParameter::Onset as usize]);
        }
        for (element, stencil) in self.bending.elements.iter().zip(&self.bending.stencils) {
            let q = self.positions(stencil, displacement);
            let unit = RodBending { stiffness: 1.0, ..*element }.gradient(&q).1;
            self.add_work(stencil, &unit, motions, &mut work[RodParameter::Bending as usize]);
        }
        for (element, stencil) in self.contact.elements.iter().zip(&self.contact.stencils) {
            let q = self.positions(stencil, displacement);
            if !element.acts(&q) {
                continue;
            }
            let [outer, inner] = element.phases;
            let phases = [ContactPhase { stiffness: 1.0, ..outer }, ContactPhase { stiffness: 0.0, ..inner }];
            let unit = RodContact { phases, ..*element }.gradient(&q).1;
            self.add_work(stencil, &unit, motions, &mut work[RodParameter::OuterContact as usize]);
            let wider = element.gradient_by_outer_radius(&q);
            self.add_work(stencil, &wider, motions, &mut work[RodParameter::OuterRadius as usize]);
        }
        for (element, stencil) in self.stick.elements.iter().zip(&self.stick.stencils) {
            let force = element.gradient(&self.positions(stencil, displacement)).1;
            let unit = force.map(|force| force / self.material.holding);
            self.add_work(stencil, &unit, motions, &mut work[RodParameter::Holding as usize]);
        }
        let by_anchor = self.anchor_by_parameters();
        for (k, motion) in motions.iter().enumerate() {
            let pull: f64 = motion.vertices.iter().zip(displacement).map(|(d, u)| d * u).sum();
            work.iter_mut().zip(by_anchor).for_each(|(work, anchor)| work[k] += anchor * pull);
        }
        work
    }

    /// How the energy \[J\] changes with each number of the material, the vertices held.
    fn energy_by_parameters(&self, displacement: &[f64]) -> [f64; RodParameter::COUNT] {
        let mut sums = [0.0; RodParameter::COUNT];
        for (element, stencil) in self.stretch.elements.iter().zip(&self.stretch.stencils) {
            let q = self.positions(stencil, displacement);
            let energy = |soft, stiff| RodStretch { soft, stiff, ..*element }.gradient(&q).0;
            sums[RodParameter::SoftStretch as usize] += energy(1.0, 0.0);
            sums[RodParameter::StiffStretch as usize] += energy(0.0, 1.0);
            sums[RodParameter::Onset as usize] += element.energy_by_onset(&q);
        }
        for (element, stencil) in self.bending.elements.iter().zip(&self.bending.stencils) {
            let q = self.positions(stencil, displacement);
            sums[RodParameter::Bending as usize] += RodBending { stiffness: 1.0, ..*element }.gradient(&q).0;
        }
        for (element, stencil) in self.contact.elements.iter().zip(&self.contact.stencils) {
            let q = self.positions(stencil, displacement);
            if !element.acts(&q) {
                continue;
            }
            let [outer, inner] = element.phases;
            let phases = [ContactPhase { stiffness: 1.0, ..outer }, ContactPhase { stiffness: 0.0, ..inner }];
            sums[RodParameter::OuterContact as usize] += RodContact { phases, ..*element }.gradient(&q).0;
            sums[RodParameter::OuterRadius as usize] += element.energy_by_outer_radius(&q);
        }
        for (element, stencil) in self.stick.elements.iter().zip(&self.stick.stencils) {
            let energy = element.gradient(&self.positions(stencil, displacement)).0;
            sums[RodParameter::Holding as usize] += energy / self.material.holding;
        }
        let square: f64 = displacement.iter().map(|u| u * u).sum();
        let by_anchor = self.anchor_by_parameters();
        sums.iter_mut().zip(by_anchor).for_each(|(sum, anchor)| *sum += 0.5 * anchor * square);
        sums
    }

    /// How the anchors' stiffness, a multiple of `(k_b/R² + 10⁻³ k_s1)/R`, changes with each number of the material.
    fn anchor_by_parameters(&self) -> [f64; RodParameter::COUNT] {
        let (radius, force) = (self.material.contact[0].radius, self.material.force_unit());
        let multiple = self.anchor * radius / force;
        let mut by = [0.0; RodParameter::COUNT];
        by[RodParameter::SoftStretch as usize] = multiple * 1e-3 / radius;
        by[RodParameter::Bending as usize] = multiple / radius.powi(3);
        by[RodParameter::OuterRadius as usize] =
            -multiple * (force / radius + 2.0 * self.material.bending / radius.powi(3)) / radius;
        by
    }

    fn add_work<const K: usize, const N: usize>(
        &self,
        stencil: &[Image; K],
        force: &[f64; N],
        motions: &[Motion; 2],
        work: &mut [f64; 2],
    ) {
        for (sum, motion) in work.iter_mut().zip(motions) {
            for (&image, f) in stencil.iter().zip(force.as_chunks::<3>().0) {
                let d = motion.of(self, image);
                *sum += d[0] * f[0] + d[1] * f[1] + d[2] * f[2];
            }
        }
    }
}
