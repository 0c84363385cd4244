//! How stress and compression of a stretched tile follow its stiffnesses, through equilibrium (the adjoint).

use super::solver::{StretchError, StretchedTile};
use crate::dynamics::tile_stiffness::TileStiffness;
use crate::fabric::Matrix2;

/// Derivatives of what a stretch test measures, by the stiffnesses in the order of [`TileStiffness::all`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StretchSlopes {
    /// `dσ_s/dp`, the stress in N/m.
    pub stress: [f64; TileStiffness::COUNT],
    /// `dc/dp` of a free compression, else zero.
    pub compression: [f64; TileStiffness::COUNT],
    /// Whether the equilibrium is a minimum of the energy. If not, the second derivatives were shifted to find these.
    pub stable: bool,
}

/// First shift that is tried, the largest, and by how much it grows, in `k_b/ℓ³`.
const FIRST_SHIFT: f64 = 1e-6;
const LARGEST_SHIFT: f64 = 1e6;
const GROWTH: f64 = 10.0;

impl StretchedTile {
    /// Derivatives by the stiffnesses where the last solve has ended.
    ///
    /// With the relaxed tile held, `∂W/∂z = 0` in the unknowns `z = (ũ, c)` gives `A dσ_s/dp = v · ∂²W/∂y∂p` over `y = (ũ, s, c)` with
    /// `v = (−λ, 1)`, `λ = H⁻¹ ∂²W/∂z∂s`: one solve answers for all stiffnesses, and one, `μ = H⁻¹ e_c`, for the compression.
    ///
    /// The relaxed tile follows the stiffnesses too. With `size_slopes`, the derivatives of the logarithms `θ` of its periods
    /// ([`super::TileReference::size_slopes`]), what that adds is included: `∂²W/∂y∂θ` meets the same `v` and `μ`. Without, it is not.
    ///
    /// # Errors
    /// [`StretchError::Cholesky`]; [`StretchError::NoEquilibrium`] where no shift makes the second derivatives positive definite.
    pub fn slopes(
        &mut self,
        size_slopes: Option<&[[f64; TileStiffness::COUNT]; 2]>,
    ) -> Result<StretchSlopes, StretchError> {
        let n = self.unknowns.len();
        self.system.linearise(&self.unknowns, 0.0);
        let (beside, corner) = self.system.held_border(0);
        let beside = beside.to_vec();
        let coupled = if self.free_compression { corner[0][1] } else { 0.0 };
        let (mut along, stable) = self.solved(&beside, coupled)?;
        along.iter_mut().for_each(|x| *x = -*x);
        along[n - 2] = 1.0;
        let across = if self.free_compression { self.solved(&vec![0.0; n - 2], 1.0)?.0 } else { vec![0.0; n] };
        let work = self.units.work(&self.unknowns, [&along, &across]);
        let mut slopes = StretchSlopes {
            stress: work.map(|[along, _]| along / self.length),
            compression: work.map(|[_, across]| -across / self.length),
            stable,
        };
        if let Some(of_size) = size_slopes {
            let by_size = self.by_size(&along, &across);
            for (axis, [stress, compression]) in by_size.into_iter().enumerate() {
                for k in 0..TileStiffness::COUNT {
                    slopes.stress[k] += stress * of_size[axis][k];
                    slopes.compression[k] += compression * of_size[axis][k];
                }
            }
        }
        Ok(slopes)
    }

    /// Solves for a right side of own slots and one of compression; also whether that was possible without a shift.
    fn solved(&mut self, own: &[f64], compression: f64) -> Result<(Vec<f64>, bool), StretchError> {
        let unit = self.force / self.unit_length;
        let mut shift = 0.0;
        loop {
            let mut right = own.to_vec();
            let mut plane = [0.0, compression];
            if self.system.solve(shift * unit, &mut right, &mut plane)? {
                right.extend(plane);
                return Ok((right, shift == 0.0));
            }
            shift = (GROWTH * shift).max(FIRST_SHIFT);
            if shift > LARGEST_SHIFT {
                let stretch = self.unknowns[self.unknowns.len() - 2] / self.length;
                return Err(StretchError::NoEquilibrium { stretch, residual: f64::NAN });
            }
        }
    }

    /// Derivatives of stress and compression by the logarithm of each period of the relaxed tile, the stiffnesses held.
    ///
    /// `world = ũ + F P X` with `P = diag(e^θ)` moves with `θ_j` by `F P E_j X`, and its rates by `s` and `c` with it.
    fn by_size(&mut self, along: &[f64], across: &[f64]) -> [[f64; 2]; 2] {
        let n = self.unknowns.len();
        let map = *self.system.coordinates.map();
        let now = map.at([self.unknowns[n - 2], self.unknowns[n - 1]]);
        let still = vec![0.0; n - 2];
        let [stress, _] = self.system.period_gradient.map(|g| g / self.length);
        [0, 1].map(|axis| {
            let size = self.system.coordinates.motion(&still, &column(&now, axis));
            let [of_stress, of_compression] = [along, across].map(|v| {
                let rate = map.rate([v[n - 2], v[n - 1]]);
                let motion = self.system.coordinates.moved(v);
                let turned = self.system.coordinates.motion(&still, &column(&rate, axis));
                (
                    self.system.second_along(&self.unknowns, &motion, &size),
                    self.system.first_along(&self.unknowns, &turned),
                )
            });
            let total = |(second, first): (f64, f64)| (second + first) / self.length;
            [total(of_stress) - stress, -total(of_compression)]
        })
    }
}

/// A matrix of which one column is left.
fn column(matrix: &Matrix2, axis: usize) -> Matrix2 {
    matrix.map(|row| std::array::from_fn(|k| if k == axis { row[k] } else { 0.0 }))
}
