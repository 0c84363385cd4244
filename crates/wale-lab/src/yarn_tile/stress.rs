//! Coarse stress from the forces over a tile's border, and bending stiffness from energies of bent tiles.

use super::coarse::{CoarseDeformation, times};
use super::equilibrium::{EquilibriumSettings, TileError, TileSolver};
use super::material::RodMaterial;
use super::system::TileSystem;
use super::tile::YarnTile;

/// Homogenised stress of a tile in equilibrium \[N/m\], of the first Piola-Kirchhoff kind: forces over lengths at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CoarseStress {
    /// `σ_s = dΨ/ds` along the direction of stretch.
    pub stretch: f64,
    /// `dΨ/dc` across it, positive where the fabric resists becoming narrower.
    pub compression: f64,
    /// The part of both that the forces carry which keep yarns from sliding; nothing else is left inside a tile in equilibrium.
    pub reaction: [f64; 2],
    /// All of it, `∂Ψ/∂F` by rows as the deformation gradient is.
    pub plane: [[f64; 2]; 2],
}

impl CoarseStress {
    /// Gathers the forces of the elements that reach over the tile's border [Sperl2022, Eq. 10].
    ///
    /// With `ũ` held, an image `k` periods away moves by `∂F/∂s (X + kP)`. The part of `X` meets the net forces on the
    /// vertices, which are the constraints' alone; the part of `kP` the forces of elements with images beyond the border.
    pub(super) fn gather(system: &TileSystem, displacement: &[f64]) -> Self {
        let rates = [system.deformation.stretch_rate(), system.deformation.compression_rate()];
        let area = system.tile.area();
        let (mut border, mut plane) = ([0.0; 2], [[0.0; 2]; 2]);
        let add = |plane: &mut [[f64; 2]; 2], f: [f64; 2], at: [f64; 2]| {
            for (row, f) in plane.iter_mut().zip(f) {
                row.iter_mut().zip(at).for_each(|(sum, x)| *sum += f * x / area);
            }
        };
        let mut net = vec![[0.0; 2]; system.tile.vertex_count()];
        system.for_each_force(displacement, |stencil, force| {
            for (a, image) in stencil.iter().enumerate() {
                let f = [force[3 * a], force[3 * a + 1]];
                let sum = &mut net[image.vertex as usize];
                *sum = [sum[0] + f[0], sum[1] + f[1]];
                if image.shift == [0, 0] {
                    continue;
                }
                let periods = [0, 1].map(|axis| f64::from(image.shift[axis]) * system.tile.periods()[axis]);
                add(&mut plane, f, periods);
                for (sum, rate) in border.iter_mut().zip(&rates) {
                    let moved = times(rate, periods);
                    *sum += f[0] * moved[0] + f[1] * moved[1];
                }
            }
        });
        let mut reaction = [0.0; 2];
        for (f, x) in net.iter().zip(system.tile.vertices()) {
            add(&mut plane, *f, [x[0], x[1]]);
            for (sum, rate) in reaction.iter_mut().zip(&rates) {
                let moved = times(rate, [x[0], x[1]]);
                *sum += f[0] * moved[0] + f[1] * moved[1];
            }
        }
        let reaction = reaction.map(|r| r / area);
        Self { stretch: border[0] / area + reaction[0], compression: border[1] / area + reaction[1], reaction, plane }
    }

    /// Second Piola-Kirchhoff stress `σ_s/(1 + s)` \[N/m\] [Sperl2022, section 7.3.1].
    #[must_use]
    pub fn second_piola_kirchhoff(&self, deformation: &CoarseDeformation) -> f64 {
        self.stretch / (1.0 + deformation.stretch())
    }
}

/// Bending stiffness `B` \[N·m\] of a fabric along a direction at an angle \[rad\], `Ψ = Ψ₀ + ½ B κ²`, from the energies of the
/// tile flat and bent both ways to a curvature \[1/m\].
///
/// # Errors
/// [`TileError`], [`TileError::NoEquilibrium`] if one of the three was not found.
pub fn bending_stiffness(
    tile: &YarnTile,
    material: &RodMaterial,
    settings: EquilibriumSettings,
    flat: &CoarseDeformation,
    curvature: f64,
) -> Result<f64, TileError> {
    let mut solver = TileSolver::new(tile, material, settings)?;
    let mut density = |curvature: f64| -> Result<f64, TileError> {
        let found = solver.solve(&flat.bent(curvature))?;
        if found.converged {
            Ok(found.energy_density)
        } else {
            Err(TileError::NoEquilibrium { residual: found.residual })
        }
    };
    let middle = density(0.0)?;
    let towards = density(curvature)?;
    density(0.0)?;
    let away = density(-curvature)?;
    Ok((towards - 2.0 * middle + away) / (curvature * curvature))
}
