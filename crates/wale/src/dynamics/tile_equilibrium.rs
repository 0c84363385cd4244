//! Equilibrium of a periodic tile with both periods unknown, by direct Newton steps.

use wale_numerics::dense::{DirectionKind, descent_direction};

use crate::energy::Foundation;
use crate::fabric::coordinates::{BLOCK, dof};
use crate::fabric::elements::{ElementSet, Elements};
use crate::fabric::{Mechanics, TileCoordinates};
use crate::model::{KnitCard, Network, PassId, YarnId, Yarns};

/// How a tile is brought to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileSettings {
    /// Stiffness of the bed under every node, in `k_b/ℓ³` \[–\].
    ///
    /// Real swatches are measured lying flat; without a bed, bands of four equal wales and more roll into tubes.
    pub bed: f64,
    /// Size of the random displacement that breaks the flat layout's symmetry, in loop lengths \[–\].
    pub noise: f64,
    /// Seed of that displacement.
    pub seed: u64,
    /// Most Newton iterations.
    pub max_iterations: usize,
    /// Residual at which the tile is at rest, in `k_b/ℓ²` a coordinate \[–\].
    pub tolerance: f64,
}

impl Default for TileSettings {
    fn default() -> Self {
        Self { bed: 10.0, noise: 0.01, seed: 1, max_iterations: 300, tolerance: 1e-7 }
    }
}

/// A tile at rest.
#[derive(Clone, Debug)]
pub struct TileEquilibrium {
    /// Own slots, then the two periods \[m\].
    pub unknowns: Vec<f64>,
    /// Period along the course, over the tile's columns: the relaxed wale spacing `W` \[m\].
    pub wale_spacing: f64,
    /// Period along the wale, over the tile's rows: the relaxed course spacing `C` \[m\].
    pub course_spacing: f64,
    /// Elastic energy a loop, the bed's included \[J\].
    pub energy: f64,
    /// Iterations used.
    pub iterations: usize,
    /// Largest component of the gradient left, in `k_b/ℓ²` \[–\].
    pub residual: f64,
    /// Whether the residual reached the tolerance.
    pub converged: bool,
}

/// Relaxes a periodic tile without friction from a slightly disturbed start.
///
/// Unknowns are all positions, all sliding coordinates and both periods; one node's place in the plane and one sliding
/// coordinate of each yarn are held, which fixes the rigid motions and nothing else.
#[must_use]
pub fn relax_tile(
    network: &Network,
    yarns: impl Into<Yarns>,
    card: &KnitCard,
    settings: &TileSettings,
) -> TileEquilibrium {
    Problem::new(network, &yarns.into(), card, settings).solve(settings)
}

struct Problem {
    coordinates: TileCoordinates,
    mechanics: Mechanics,
    bed: Elements<Foundation, 1>,
    /// Unknown of each row of the dense system.
    rows: Vec<usize>,
    /// Row of each unknown.
    row_of: Vec<Option<usize>>,
    unknowns: Vec<f64>,
    world: Vec<f64>,
    loop_count: f64,
    columns: f64,
    chart_rows: f64,
    /// Force unit `k_b/ℓ²` \[N\].
    force: f64,
    /// Largest move of a coordinate in one step \[m\].
    longest_move: f64,
}

impl Problem {
    fn new(network: &Network, yarns: &Yarns, card: &KnitCard, settings: &TileSettings) -> Self {
        let mut coordinates = TileCoordinates::new(network);
        let mechanics = Mechanics::new(network, yarns, &card.into(), &mut coordinates);
        let length = card.loop_length;
        let force = yarns.first().bending_stiffness / (length * length);
        let mut bed = Elements::default();
        if settings.bed > 0.0 {
            let stiffness = settings.bed * force / length;
            for node in 0..network.node_count() {
                bed.push(Foundation { stiffness, place: 0.0 }, [dof(BLOCK * node + 2)]);
            }
        }
        let mut held = vec![false; coordinates.unknown_len()];
        for (held, free) in held.iter_mut().zip(coordinates.own().free()) {
            *held = !free;
        }
        held[0] = true;
        held[1] = true;
        held[2] = settings.bed <= 0.0;
        for y in 0..network.yarn_count() {
            let first = PassId::new(network.yarn_passes(YarnId::new(y)).start);
            held[coordinates.own().slot(first)] = true;
        }
        let rows: Vec<usize> = (0..held.len()).filter(|&i| !held[i]).collect();
        let mut row_of = vec![None; held.len()];
        for (row, &unknown) in rows.iter().enumerate() {
            row_of[unknown] = Some(row);
        }
        let mut unknowns = coordinates.initial(network);
        let mut random = settings.seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        for node in 0..network.node_count() {
            for k in 0..3 {
                random ^= random << 13;
                random ^= random >> 7;
                random ^= random << 17;
                let unit = (random >> 11) as f64 / (1u64 << 52) as f64 - 1.0;
                unknowns[BLOCK * node + k] += settings.noise * length * unit;
            }
        }
        Self {
            coordinates,
            mechanics,
            bed,
            rows,
            row_of,
            unknowns,
            world: Vec::new(),
            loop_count: network.loops.len() as f64,
            columns: f64::from(network.chart_size[1]),
            chart_rows: f64::from(network.chart_size[0]),
            force,
            longest_move: 0.05 * length,
        }
    }

    fn sets(&self) -> Vec<&dyn ElementSet> {
        let mut sets = self.mechanics.sets().to_vec();
        sets.push(&self.bed);
        sets
    }

    fn energy(&self, unknowns: &[f64], world: &mut Vec<f64>) -> f64 {
        self.coordinates.place(unknowns, world);
        self.sets().iter().map(|set| set.total(world)).sum()
    }

    /// Energy, gradient and full Hessian by the rows' unknowns.
    fn linearise(&self, gradient: &mut [f64], hessian: &mut [f64]) -> f64 {
        let n = self.rows.len();
        gradient.fill(0.0);
        hessian.fill(0.0);
        let mut energy = 0.0;
        let mut targets: Vec<(usize, usize, f64)> = Vec::new();
        for set in self.sets() {
            energy += set.visit(&self.world, &mut |stencil, slope, curvature| {
                targets.clear();
                for (i, &world) in stencil.iter().enumerate() {
                    for (unknown, factor) in self.coordinates.sources(world) {
                        if factor != 0.0
                            && let Some(row) = self.row_of[unknown]
                        {
                            gradient[row] += factor * slope[i];
                            targets.push((i, row, factor));
                        }
                    }
                }
                for &(i, row, a) in &targets {
                    for &(j, column, b) in &targets {
                        hessian[row * n + column] += a * b * curvature(i, j);
                    }
                }
            });
        }
        energy
    }

    /// The longest step along `direction` that no segment's rest length reaches zero in.
    fn longest_step(&self, direction: &[f64]) -> f64 {
        let change = |world: u32| -> f64 {
            self.coordinates.sources(world).iter().map(|&(unknown, factor)| factor * direction[unknown]).sum()
        };
        let mut longest: f64 = 1.0;
        for stencil in &self.mechanics.stretch.stencils {
            let rest = self.world[stencil[7] as usize] - self.world[stencil[3] as usize];
            let rate = change(stencil[7]) - change(stencil[3]);
            if rate < 0.0 {
                longest = longest.min(0.9 * rest / -rate);
            }
        }
        let largest = direction.iter().fold(0.0f64, |m, d| m.max(d.abs()));
        longest.min(self.longest_move / largest.max(f64::MIN_POSITIVE))
    }

    fn solve(mut self, settings: &TileSettings) -> TileEquilibrium {
        let n = self.rows.len();
        let (mut gradient, mut hessian) = (vec![0.0; n], vec![0.0; n * n]);
        let mut scratch = Vec::new();
        let mut energy = f64::NAN;
        let (mut iterations, mut residual) = (0, f64::INFINITY);
        while iterations <= settings.max_iterations {
            self.coordinates.place(&self.unknowns, &mut self.world);
            energy = self.linearise(&mut gradient, &mut hessian);
            residual = gradient.iter().fold(0.0f64, |m, g| m.max(g.abs())) / self.force;
            if residual <= settings.tolerance || iterations == settings.max_iterations {
                break;
            }
            let Some((step, kind)) = descent_direction(&hessian, &gradient) else { break };
            let mut direction = vec![0.0; self.unknowns.len()];
            for (row, &unknown) in self.rows.iter().enumerate() {
                direction[unknown] = step[row];
            }
            let slope: f64 = step.iter().zip(&gradient).map(|(d, g)| d * g).sum();
            let mut length = self.longest_step(&direction);
            let full = length >= 1.0 && kind == DirectionKind::Newton;
            let mut accepted = false;
            for _ in 0..40 {
                let trial: Vec<f64> = self.unknowns.iter().zip(&direction).map(|(u, d)| u + length * d).collect();
                let new = self.energy(&trial, &mut scratch);
                // Close to rest the energy no longer resolves the step: trust Newton there.
                let noise = 1e-14 * energy.abs();
                if new <= energy + 1e-4 * length * slope + noise || (full && residual < 1e-5) {
                    self.unknowns = trial;
                    accepted = true;
                    break;
                }
                length *= 0.5;
            }
            iterations += 1;
            if !accepted {
                break;
            }
        }
        let n = self.unknowns.len();
        TileEquilibrium {
            wale_spacing: self.unknowns[n - 2] / self.columns,
            course_spacing: self.unknowns[n - 1] / self.chart_rows,
            energy: energy / self.loop_count,
            iterations,
            residual,
            converged: residual <= settings.tolerance,
            unknowns: self.unknowns,
        }
    }
}
