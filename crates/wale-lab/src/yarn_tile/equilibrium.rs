//! Equilibrium of a tile under a coarse deformation, by Newton's method.

use serde::{Deserialize, Serialize};
use thiserror::Error;
use wale_numerics::block_matrix::SLOTS;
use wale_numerics::sparse_cholesky::CholeskyError;
use wale_numerics::trust::{Foreseen, Trust, TrustRule, is_enough};

use super::coarse::CoarseDeformation;
use super::material::RodMaterial;
use super::path::check;
use super::stress::CoarseStress;
use super::system::TileSystem;
use super::tile::YarnTile;

/// How a tile is brought to rest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EquilibriumSettings {
    /// Net force on a vertex at which it is at rest, in `k_b/R² + 10⁻³ k_s1` \[–\].
    pub tolerance: f64,
    /// Most Newton iterations, as linear systems factored.
    pub max_iterations: usize,
    /// Stiffness of springs that hold every vertex where the coarse deformation takes it, over `(k_b/R² + 10⁻³ k_s1)/R` \[–\].
    ///
    /// Yarns without friction slide along themselves and past each other at next to no cost, in valleys up to `10⁷` times softer than
    /// a yarn is: where they stop is chance. Springs a ten-thousandth as stiff as a bent yarn end that, and bear next to no stress.
    pub anchor: f64,
}

impl Default for EquilibriumSettings {
    fn default() -> Self {
        Self { tolerance: 1e-8, max_iterations: 600, anchor: 0.0 }
    }
}

/// Why there is no equilibrium.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TileError {
    /// The system could not be built or solved.
    #[error(transparent)]
    Cholesky(#[from] CholeskyError),
    /// A parameter of the material is none.
    #[error("the {what} is {value}: {why}")]
    Material {
        /// Which.
        what: &'static str,
        /// What it is.
        value: f64,
        /// What it should be.
        why: &'static str,
    },
    /// The deformation turns the fabric inside out, or is not finite.
    #[error("a deformation with determinant {determinant} and curvature {curvature} cannot be applied")]
    Deformation {
        /// Area after over area before.
        determinant: f64,
        /// Curvature \[1/m\].
        curvature: f64,
    },
    /// Newton's method ended elsewhere.
    #[error("no equilibrium was found: forces of {residual} units are left; smaller steps of deformation may help")]
    NoEquilibrium {
        /// Largest net force left, in the unit of [`EquilibriumSettings::tolerance`].
        residual: f64,
    },
}

/// A tile at rest under a coarse deformation.
#[derive(Clone, Debug, PartialEq)]
pub struct TileEquilibrium {
    /// The coarse deformation, with the compression that was found if it was free.
    pub deformation: CoarseDeformation,
    /// Displacements `ũ` of the vertices from the stretched plane \[m\].
    pub displacement: Vec<[f64; 3]>,
    /// Energy over area at rest, `Ψ` \[J/m²\].
    pub energy_density: f64,
    /// Homogenised stress \[N/m\].
    pub stress: CoarseStress,
    /// Newton iterations used: linear systems factored, those of steps that were not taken too.
    pub iterations: usize,
    /// Largest net force left, in the unit of [`EquilibriumSettings::tolerance`].
    pub residual: f64,
    /// Whether that is within the tolerance.
    pub converged: bool,
}

/// Finds equilibria of one tile of one material, each from the one before.
#[derive(Debug)]
pub struct TileSolver {
    pub(super) system: TileSystem,
    settings: EquilibriumSettings,
    pub(super) displacement: Vec<f64>,
    /// Equilibrium before the last, with its deformation, from which the next is guessed.
    pub(super) before: Option<(CoarseDeformation, Vec<f64>)>,
    pub(super) last: Option<(CoarseDeformation, Vec<f64>)>,
    pub(super) free_compression: bool,
    /// Unit of force \[N\] and of length \[m\].
    pub(super) force: f64,
    pub(super) length: f64,
    trust: Trust,
    energy: f64,
    pub(super) residual: f64,
    /// Linear systems factored since the last deformation.
    iterations: usize,
}

/// First shift, in units of force over length, and the largest: a step so short that nothing is gained by another.
const FIRST_SHIFT: f64 = 1.0;
const LARGEST_SHIFT: f64 = 1e12;
const RULE: TrustRule = TrustRule { least: 1e-9, doubted: 1e-9, refused: 1e-2, growth: 4.0, fall: 0.3 };
/// Longest move of a vertex in a step, in reaches of contact: less than lies between the search for contacts and its margin.
pub(super) const LONGEST_MOVE: f64 = 0.12;
/// How often, and to which part, a step is shortened before another is asked for.
const MOST_SHORTENED: u32 = 2;
const SHORTENED: f64 = 0.3;

impl TileSolver {
    /// A solver at the tile as it was drawn, with the whole coarse deformation given.
    ///
    /// # Errors
    /// If the tile is too large.
    pub fn new(tile: &YarnTile, material: &RodMaterial, settings: EquilibriumSettings) -> Result<Self, TileError> {
        Self::with(tile, material, settings, false)
    }

    /// A solver that finds the compression `c` of least energy together with the displacements.
    ///
    /// Differs from the paper: there COBYLA looks for `c` and solves for equilibrium at every try; here `c` is one more
    /// unknown of Newton's method, a dense row and column beside the sparse matrix. Test:
    /// `free_compression_is_that_of_least_energy`.
    ///
    /// # Errors
    /// If the tile is too large.
    pub fn free_compression(
        tile: &YarnTile,
        material: &RodMaterial,
        settings: EquilibriumSettings,
    ) -> Result<Self, TileError> {
        Self::with(tile, material, settings, true)
    }

    fn with(
        tile: &YarnTile,
        material: &RodMaterial,
        settings: EquilibriumSettings,
        free_compression: bool,
    ) -> Result<Self, TileError> {
        material.check(tile)?;
        let radius = material.contact[0].radius;
        let force = material.force_unit();
        let system = TileSystem::new(tile, material, settings.anchor * force / radius, free_compression)?;
        Ok(Self {
            system,
            settings,
            displacement: vec![0.0; SLOTS * tile.vertex_count()],
            before: None,
            last: None,
            free_compression,
            force,
            length: radius,
            trust: Trust::new(RULE, FIRST_SHIFT, 1.0),
            energy: f64::NAN,
            residual: f64::INFINITY,
            iterations: 0,
        })
    }

    /// The tile.
    #[must_use]
    pub fn tile(&self) -> &YarnTile {
        &self.system.tile
    }

    /// The deformation that it is under.
    #[must_use]
    pub fn deformation(&self) -> CoarseDeformation {
        self.system.deformation
    }

    /// Brings the tile to rest under a deformation, from where it is. If compression is free, that of the deformation is where the
    /// search begins.
    ///
    /// # Errors
    /// If the deformation is impossible or numbers are not finite. An equilibrium that was not reached is told by
    /// [`TileEquilibrium::converged`].
    pub fn solve(&mut self, deformation: &CoarseDeformation) -> Result<TileEquilibrium, TileError> {
        self.move_to(deformation)?;
        self.extrapolate();
        self.iterations = 0;
        loop {
            self.linearise()?;
            if self.residual <= self.settings.tolerance || self.iterations >= self.settings.max_iterations {
                break;
            }
            if !self.advance()? {
                break;
            }
        }
        self.before = self.last.replace((self.system.deformation, self.displacement.clone()));
        Ok(self.found())
    }

    /// The displacements as they are, as an equilibrium.
    fn found(&self) -> TileEquilibrium {
        let of_blocks = self.displacement.as_chunks::<SLOTS>().0;
        TileEquilibrium {
            deformation: self.system.deformation,
            displacement: of_blocks.iter().map(|u| [u[0], u[1], u[2]]).collect(),
            energy_density: self.energy / self.system.tile.area(),
            stress: CoarseStress::gather(&self.system, &self.displacement),
            iterations: self.iterations,
            residual: self.residual,
            converged: self.residual <= self.settings.tolerance,
        }
    }

    /// Takes displacements \[m\] from elsewhere, of which what the constraints forbid is left out, under a deformation.
    ///
    /// # Errors
    /// If the deformation is impossible.
    ///
    /// # Panics
    /// If there are not as many as vertices.
    pub fn place(&mut self, deformation: &CoarseDeformation, displacement: &[[f64; 3]]) -> Result<(), TileError> {
        check(deformation)?;
        assert_eq!(displacement.len(), self.system.tile.vertex_count());
        for (to, from) in self.displacement.as_chunks_mut::<SLOTS>().0.iter_mut().zip(displacement) {
            to[..3].copy_from_slice(from);
        }
        self.system.constraints.project(&mut self.displacement);
        self.system.deformation = *deformation;
        (self.before, self.last) = (None, None);
        Ok(())
    }

    fn linearise(&mut self) -> Result<(), TileError> {
        self.system.refresh_contacts(&self.displacement)?;
        self.energy = self.system.linearise(&self.displacement, self.trust.convexity);
        // The forces of the constraints take the rest.
        self.system.constraints.project(&mut self.system.gradient);
        let largest = self.system.gradient.iter().fold(0.0f64, |m, g| m.max(g.abs()));
        let along = if self.free_compression {
            self.system.compression_gradient.abs() / self.system.tile.area().sqrt()
        } else {
            0.0
        };
        self.residual = largest.max(along) / self.force;
        if self.residual.is_nan() || !self.energy.is_finite() {
            return Err(CholeskyError::NotFinite.into());
        }
        Ok(())
    }

    /// A step that lowers the energy about as much as the second derivatives say; whether there was one.
    fn advance(&mut self) -> Result<bool, TileError> {
        let weight = self.system.tile.area() * self.displacement.len() as f64 / (3.0 * SLOTS as f64);
        while self.trust.shift < LARGEST_SHIFT {
            self.iterations += 1;
            let used = self.trust.used_shift() * self.force / self.length;
            if !self.system.second.factor(used, weight)? {
                if self.trust.refuse() {
                    self.linearise()?;
                }
                continue;
            }
            let mut direction: Vec<f64> = self.system.gradient.iter().map(|g| -g).collect();
            let mut compression =
                if self.free_compression { vec![-self.system.compression_gradient] } else { Vec::new() };
            self.system.second.solve(&mut direction, &mut compression);
            let by_compression = compression.first().copied().unwrap_or(0.0);
            let slope = dot(&direction, &self.system.gradient) + by_compression * self.system.compression_gradient;
            let square = dot(&direction, &direction) + weight * by_compression * by_compression;
            let curvature = -slope - used * square;
            let most = LONGEST_MOVE * 2.0 * self.length;
            let mut part = self.system.longest_step(&self.displacement, &direction, by_compression, most);
            let (before, energy) = ((self.system.deformation, self.displacement.clone()), self.energy);
            let rate = self.system.deformation.compression_rate();
            let mut searched = false;
            for attempt in 0..=MOST_SHORTENED {
                self.displacement.iter_mut().zip(&before.1).zip(&direction).for_each(|((u, b), d)| *u = b + part * d);
                self.system.deformation = before.0;
                self.system.deformation.add(&rate, part * by_compression);
                searched |= self.system.refresh_contacts(&self.displacement)?;
                let gained = energy - self.system.energy(&self.displacement);
                let share = Foreseen { slope, curvature }.share(part, gained, energy, 1e-11);
                if attempt == 0 {
                    // At least as stiff as the valley is along the step.
                    self.trust.judge(share, part, (curvature / square).max(0.0) * self.length / self.force);
                }
                if is_enough(share) {
                    return Ok(true);
                }
                // Along a curved valley a shorter step is cheaper than another factor.
                part *= SHORTENED;
            }
            (self.system.deformation, self.displacement) = before;
            if searched {
                self.linearise()?;
            }
        }
        self.trust.shift = FIRST_SHIFT;
        Ok(false)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
