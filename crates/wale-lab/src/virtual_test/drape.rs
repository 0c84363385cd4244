//! The drape test of Cusick (BS 5058, ISO 9073-9): a round specimen hangs over a round support.

use std::f64::consts::{PI, TAU};

use wale::fabric::coordinates::BLOCK;

use super::drape_mesh::{RoundSpecimen, round_specimen};
use super::shadow::{covered_area, nodes, outline};
use crate::shell::error::{ShellError, positive};
use crate::shell::rest::{RestSettings, come_to_rest};
use crate::shell::{ShellCard, ShellSystem};

/// A specimen on its support.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrapeTest {
    /// Diameter of the specimen \[m\].
    pub specimen: f64,
    /// Diameter of the support \[m\].
    pub support: f64,
    /// Gravity, downward \[m/s²\].
    pub gravity: f64,
    /// Edge length of the mesh \[m\].
    pub edge: f64,
    /// Which of many small pushes the specimen starts with: as in the laboratory, folds depend on it.
    pub start: u32,
    /// When it is at rest.
    pub rest: RestSettings,
}

impl Default for DrapeTest {
    /// 30 cm on 18 cm.
    fn default() -> Self {
        let rest = RestSettings { tolerance: 1e-7, max_iterations: 2000 };
        Self { specimen: 0.30, support: 0.18, gravity: 9.81, edge: 0.007, start: 1, rest }
    }
}

/// What the test reports.
#[derive(Clone, Debug, PartialEq)]
pub struct DrapeResult {
    /// `DC = (A_shadow − A_support)/(A_specimen − A_support)` \[–\].
    pub coefficient: f64,
    /// Area of the shadow \[m²\].
    pub shadow: f64,
    /// Area of the specimen \[m²\].
    pub specimen: f64,
    /// Area of the support \[m²\].
    pub support: f64,
    /// Nodes of the shadow's outline.
    pub nodes: usize,
    /// How far the shadow reaches in evenly spread directions, counter-clockwise from the weft \[m\].
    pub outline: Vec<f64>,
    /// How far the lowest point hangs below the support \[m\].
    pub depth: f64,
    /// Places of the vertices, the support's surface at height zero \[m\].
    pub places: Vec<[f64; 3]>,
    /// Vertices of the triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Energy \[J\], that of the flat sheet at the height of its support being zero.
    pub energy: f64,
    /// Newton iterations.
    pub iterations: usize,
}

/// Height of a push over the free width \[–\].
const PUSH: f64 = 0.05;
/// Gravity is doubled so many times less one. Under all of its weight at once a flat sheet falls into more and smaller folds, whose
/// energy is higher.
const RAMP: usize = 6;
/// Part of its forces that may be left before gravity is doubled \[–\].
const ROUGHLY: f64 = 1e-3;
/// How often a sheet that rests on no minimum is pushed again.
const MOST_PUSHES: usize = 4;
/// Waves around the specimen of which the push is made.
const WAVES: std::ops::RangeInclusive<u32> = 1..=9;

impl DrapeTest {
    /// Lets a fabric hang until it is at rest.
    ///
    /// A flat sheet that sags evenly is an equilibrium, though not one that lasts: a push of unequal waves lets folds form. They
    /// do not touch each other: a limp sheet whose folds would lie on each other passes through itself.
    ///
    /// # Errors
    /// [`ShellError`]: an impossible number, a fabric without weight or bending stiffness, or a specimen that does not come to rest.
    pub fn run(&self, card: &ShellCard) -> Result<DrapeResult, ShellError> {
        positive("gravity", self.gravity)?;
        positive("areal mass", card.areal_mass)?;
        for stiffness in card.bending.to_array() {
            positive("bending stiffness", stiffness)?;
        }
        let RoundSpecimen { mesh, held } = round_specimen(0.5 * self.specimen, 0.5 * self.support, self.edge)?;
        let held: Vec<[bool; 3]> = held.iter().map(|&held| [held; 3]).collect();
        let mut system = ShellSystem::new(&mesh, card, 0.0, [0.0, 0.0, -self.gravity], &held)?;
        let (q, energy, iterations) = self.hang(&mut system, &mesh.points, &held, mesh.laid_flat())?;
        let places: Vec<[f64; 3]> = q.chunks_exact(BLOCK).map(|slots| [slots[0], slots[1], slots[2]]).collect();
        let seen: Vec<[[f64; 2]; 3]> =
            mesh.triangles.iter().map(|t| t.map(|v| [places[v as usize][0], places[v as usize][1]])).collect();
        let area = |diameter: f64| 0.25 * PI * diameter * diameter;
        let [specimen, support] = [self.specimen, self.support].map(area);
        let (shadow, outline) = (covered_area(&seen), outline(&seen));
        Ok(DrapeResult {
            coefficient: (shadow - support) / (specimen - support),
            shadow,
            specimen,
            support,
            nodes: nodes(&outline, 0.5 * self.specimen),
            outline,
            depth: places.iter().fold(0.0f64, |depth, p| depth.max(-p[2])),
            places,
            triangles: mesh.triangles,
            energy,
            iterations,
        })
    }

    /// Lets the sheet hang under a gravity that grows, and pushes it a little each time.
    fn hang(
        &self,
        system: &mut ShellSystem,
        points: &[[f64; 2]],
        held: &[[bool; 3]],
        mut q: Vec<f64>,
    ) -> Result<(Vec<f64>, f64, usize), ShellError> {
        let mut iterations = 0;
        for k in 1..=RAMP + MOST_PUSHES {
            system.set_gravity([0.0, 0.0, -self.gravity * 0.5f64.powi(RAMP.saturating_sub(k) as i32)]);
            self.push(points, held, &mut q);
            let rest = if k < RAMP { RestSettings { tolerance: ROUGHLY, ..self.rest } } else { self.rest };
            let report = come_to_rest(system, &mut q, &rest).map_err(|error| match error {
                ShellError::NotAtRest { iterations, residual, .. } => {
                    ShellError::NotAtRest { load: "the end of the drape test".into(), iterations, residual }
                }
                other => other,
            })?;
            iterations += report.iterations;
            // A sheet that sags evenly is at rest too; the second derivatives tell.
            if k >= RAMP && system.prepare_sensitivity(&q).is_ok() {
                return Ok((q, report.energy, iterations));
            }
        }
        Err(ShellError::Unstable("the sheet".into()))
    }

    /// Waves of all numbers around, with sizes and places that depend on the start, growing outward.
    fn push(&self, points: &[[f64; 2]], held: &[[bool; 3]], q: &mut [f64]) {
        let inner = 0.5 * self.support;
        let free = 0.5 * self.specimen - inner;
        // The low-discrepancy sequence of the golden ratio: no start is like another, and all are the same on every machine.
        let share = |k: u32| (0.5 + 0.618_033_988_749_895 * f64::from(k)).fract();
        let waves: Vec<[f64; 3]> = WAVES
            .map(|n| {
                let k = self.start.wrapping_mul(31).wrapping_add(n) % 100_003;
                [f64::from(n), 0.5 + 0.5 * share(2 * k), TAU * share(7 * k + 3)]
            })
            .collect();
        for (v, &[x, y]) in points.iter().enumerate().filter(|(v, _)| !held[*v][2]) {
            let (part, angle) = ((x.hypot(y) - inner) / free, y.atan2(x));
            let sum: f64 = waves.iter().map(|[n, size, phase]| size * (n * angle + phase).cos()).sum();
            q[BLOCK * v + 2] += PUSH * free * part * part * sum / waves.len() as f64;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wale::energy::{BendingStiffness, MembraneStiffness};

    fn card(bending: f64) -> ShellCard {
        let membrane =
            MembraneStiffness { xx: 500.0, xy: 50.0, yy: 500.0, ss: 50.0, n1: 1.0, n2: 2.0, ..MembraneStiffness::NONE };
        ShellCard { membrane, bending: BendingStiffness::isotropic(bending), areal_mass: 0.2 }
    }

    /// How far the border of a plate sinks that is clamped at `a`, free at `b`, with rigidity `D` and Poisson's ratio `ν`, under a
    /// load `q` by area: `D (∇²w)′ = q (r² − b²)/(2r)`, so `D w′ = q (r³/16 − b² (r ln r/4 − r/8)) + c₁ r/2 + c₂/r`.
    fn plate(a: f64, b: f64, rigidity: f64, poisson: f64, load: f64) -> f64 {
        let own = |r: f64| load * (r.powi(3) / 16.0 - b * b * (r * r.ln() / 4.0 - r / 8.0));
        let own_slope = |r: f64| load * (3.0 * r * r / 16.0 - b * b * (r.ln() / 4.0 + 1.0 / 8.0));
        // w′(a) = 0 and w″(b) + ν w′(b)/b = 0.
        let rows = [
            [0.5 * a, 1.0 / a, -own(a)],
            [0.5 + 0.5 * poisson, (poisson - 1.0) / (b * b), -own_slope(b) - poisson * own(b) / b],
        ];
        let determinant = rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0];
        let c1 = (rows[0][2] * rows[1][1] - rows[0][1] * rows[1][2]) / determinant;
        let c2 = (rows[0][0] * rows[1][2] - rows[0][2] * rows[1][0]) / determinant;
        let slope = |r: f64| (own(r) + 0.5 * c1 * r + c2 / r) / rigidity;
        let (n, h) = (200, (b - a) / 200.0);
        (0..n).map(|k| h * slope(a + (f64::from(k) + 0.5) * h)).sum()
    }

    #[test]
    fn a_stiff_sheet_sags_as_a_plate_and_casts_all_of_its_shadow() {
        let test = DrapeTest { edge: 0.008, ..DrapeTest::default() };
        let found = test.run(&card(5e-3)).unwrap();
        assert!(found.coefficient > 0.9999 && found.coefficient < 1.0 + 1e-6, "{}", found.coefficient);
        assert_eq!(found.nodes, 0);
        // Hinges on equilateral triangles have a Poisson's ratio of −⅓; meshes of discs are within six per cent.
        let depth = plate(0.09, 0.15, 2.0 * 5e-3, -1.0 / 3.0, 0.2 * 9.81);
        assert!((found.depth / depth - 1.0).abs() < 0.06, "{} {depth}", found.depth);
        assert!((found.specimen - 706.86e-4).abs() < 1e-6 && (found.support - 254.47e-4).abs() < 1e-6);
    }

    #[test]
    fn the_limper_a_sheet_the_lower_it_hangs_and_the_more_it_folds() {
        let test = DrapeTest { edge: 0.010, ..DrapeTest::default() };
        let found: Vec<DrapeResult> = [1e-4, 1e-5, 1e-6].map(|bending| test.run(&card(bending)).unwrap()).into();
        assert!(found.windows(2).all(|pair| pair[1].coefficient < pair[0].coefficient - 0.1));
        assert!(found.windows(2).all(|pair| pair[1].energy < pair[0].energy));
        assert!(found[2].coefficient < 0.35 && found[2].nodes >= 5, "{} {}", found[2].coefficient, found[2].nodes);
        // No part hangs lower than the free width, but for what its weight stretches it by.
        assert!(found.iter().all(|one| one.depth < 0.06 * 1.01));
        // The shadow of a sheet that hangs straight down is that of its support: none is smaller by more than a fold.
        assert!(found.iter().all(|one| one.shadow > 0.98 * one.support));
    }

    #[test]
    fn sheets_that_cannot_hang_are_errors() {
        let test = DrapeTest::default();
        assert!(test.run(&card(0.0)).is_err());
        assert!(test.run(&ShellCard { areal_mass: 0.0, ..card(1e-5) }).is_err());
        assert!(DrapeTest { support: 0.3, ..test }.run(&card(1e-5)).is_err());
    }
}
