//! How stress and compression of a tile in equilibrium follow the numbers of its material.

use serde::{Deserialize, Serialize};
use wale_numerics::block_matrix::SLOTS;

use super::coarse::CoarseDeformation;
use super::elements::MOST_VERTICES;
use super::equilibrium::{EquilibriumSettings, TileError, TileSolver};
use super::kinds::{Frame, Image};
use super::material::RodMaterial;
use super::parameters::RodParameter;
use super::system::TileSystem;
use super::tile::YarnTile;

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
    fn of(&self, frame: &Frame<'_>, image: Image) -> [f64; 3] {
        let [a, b] = frame.carried(&self.plane, image);
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
        let frame = self.frame(displacement);
        let still = vec![0.0; displacement.len()];
        let motion = |plane| Motion { vertices: still.clone(), plane };
        let (along, across) = (motion(self.deformation.stretch_rate()), motion(self.deformation.compression_rate()));
        let (mut border, mut corner) = (vec![0.0; displacement.len()], 0.0);
        for kind in self.elements.kinds() {
            kind.linearise(&frame, 0.0, &mut |element| {
                let mut moves = [[0.0; 3]; MOST_VERTICES];
                let moves = &mut moves[..element.stencil.len()];
                moves.iter_mut().zip(element.stencil).for_each(|(m, &image)| *m = along.of(&frame, image));
                for (a, &image) in element.stencil.iter().enumerate() {
                    let narrowing = across.of(&frame, image);
                    for i in 0..3 {
                        let value = element.hessian_along(3 * a + i, moves);
                        border[SLOTS * image.vertex as usize + i] += value;
                        corner += narrowing[i] * value;
                    }
                }
            });
        }
        (border, corner)
    }

    /// How the forces change with each number of the material, and the work that these changes do in two motions.
    fn work_of_parameters(&self, displacement: &[f64], motions: &[Motion; 2]) -> [[f64; 2]; RodParameter::COUNT] {
        let frame = self.frame(displacement);
        let mut work = [[0.0; 2]; RodParameter::COUNT];
        for kind in self.elements.kinds() {
            kind.by_parameters(&frame, &self.material, &mut |number, stencil, _, force| {
                for (sum, motion) in work[number as usize].iter_mut().zip(motions) {
                    for (&image, f) in stencil.iter().zip(force.as_chunks::<3>().0) {
                        let d = motion.of(&frame, image);
                        *sum += d[0] * f[0] + d[1] * f[1] + d[2] * f[2];
                    }
                }
            });
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
        for kind in self.elements.kinds() {
            kind.by_parameters(&self.frame(displacement), &self.material, &mut |number, _, energy, _| {
                sums[number as usize] += energy;
            });
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
}
