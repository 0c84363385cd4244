//! Newton's method for a periodic tile.

use wale_numerics::trust::{Trust, TrustRule, is_enough};

use super::tile_equilibrium::TileSettings;
use super::tile_system::{Step, TileSystem};

/// Newton's method within a region that it trusts ([`wale_numerics::trust`]), with shifts in `k_b/ℓ³`.
pub(super) struct Descent<'a> {
    pub system: &'a mut TileSystem,
    pub unknowns: Vec<f64>,
    /// Force unit `k_b/ℓ²` \[N\] and length unit `ℓ` \[m\].
    force: f64,
    length: f64,
    settings: TileSettings,
    pub trust: Trust,
    /// How far coordinates have moved at most, and may move before it stops \[m\].
    moved: f64,
    pub leash: f64,
    pub energy: f64,
    pub iterations: usize,
    pub residual: f64,
}

/// First shift, in `k_b/ℓ³`, and the largest: a step so short that nothing is gained by another.
pub(super) const FIRST_SHIFT: f64 = 100.0;
const LARGEST_SHIFT: f64 = 1e12;
pub(super) const RULE: TrustRule = TrustRule { least: 1e-4, doubted: 1e-4, refused: 1.0, growth: 4.0, fall: 0.2 };
/// Largest move of a coordinate in a step, in loop lengths.
const LONGEST_MOVE: f64 = 0.05;
/// Part of the foreseen gain below which a shorter step is tried, how much shorter, and the last one.
const LEAST_SHARE: f64 = 0.1;
const SHORTER: f64 = 0.4;
const SHORTEST_PART: f64 = 0.1;

impl<'a> Descent<'a> {
    /// From given unknowns; `force` is `k_b/ℓ²` \[N\] and `length` is `ℓ` \[m\].
    pub fn new(
        system: &'a mut TileSystem,
        unknowns: Vec<f64>,
        force: f64,
        length: f64,
        settings: TileSettings,
        trust: Trust,
    ) -> Self {
        Self {
            system,
            unknowns,
            force,
            length,
            settings,
            trust,
            moved: 0.0,
            leash: f64::INFINITY,
            energy: f64::NAN,
            iterations: 0,
            residual: f64::INFINITY,
        }
    }

    /// Goes on until the tile is at rest, no step lowers the energy, there were too many, or it is at the end of its leash; whether
    /// that was it.
    pub fn run(&mut self) -> bool {
        while self.iterations <= self.settings.max_iterations {
            self.linearise();
            if self.residual <= self.settings.tolerance || self.iterations == self.settings.max_iterations {
                return false;
            }
            if !self.advance() {
                return false;
            }
            self.iterations += 1;
            if self.moved > self.leash {
                return true;
            }
        }
        false
    }

    fn linearise(&mut self) {
        self.energy = self.system.linearise(&self.unknowns, self.trust.convexity);
        self.residual = self.system.largest_force() / self.force;
    }

    /// A step that lowers the energy about as much as the second derivatives say; whether there was one.
    fn advance(&mut self) -> bool {
        while self.trust.shift < LARGEST_SHIFT {
            let Ok(found) = self.system.step(self.trust.used_shift() * self.force / self.length) else { return false };
            let Some(step) = found else {
                if self.trust.refuse() {
                    self.linearise();
                }
                continue;
            };
            if self.follow(&step) {
                return true;
            }
        }
        false
    }

    /// Goes along a step as far as it lowers the energy; whether it did. Along a step that goes too far a shorter one often does:
    /// barriers make the energy rise steeply behind a minimum that the second derivatives foresee, and to shift them instead
    /// turns the direction away from it.
    fn follow(&mut self, step: &Step) -> bool {
        let longest = self.system.longest_step(&self.unknowns, &step.direction, LONGEST_MOVE * self.length);
        let mut part = longest;
        loop {
            let trial: Vec<f64> = self.unknowns.iter().zip(&step.direction).map(|(u, d)| u + part * d).collect();
            let gained = self.energy - self.system.energy(&trial);
            let share = step.foreseen.share(part, gained, self.energy, 1e-12);
            if self.settings.shorten && (share.is_nan() || share < LEAST_SHARE) && part > SHORTEST_PART * longest {
                part *= SHORTER;
                continue;
            }
            self.trust.judge(share, part, 0.0);
            if is_enough(share) {
                self.moved += part * step.direction.iter().fold(0.0f64, |m, d| m.max(d.abs()));
                self.unknowns = trial;
                return true;
            }
            return false;
        }
    }
}
