//! The clamped stretch test: a swatch between two clamps that are drawn apart [Sperl2022, section 4.3].

use wale::energy::MembraneStiffness;
use wale::fabric::coordinates::BLOCK;

use super::card::ShellCard;
use super::error::{ShellError, positive};
use super::mesh::Rectangle;
use super::rest::{RestSettings, advance_load};
use super::stretch_curve::StretchPoint;
use super::system::{ShellSystem, dot};

/// Whether a swatch may leave its plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutOfPlane {
    /// It stays flat; bending plays no role.
    Flat,
    /// It may wrinkle, and is laid with waves of this height \[m\] at first, so that it can.
    Free {
        /// Height of the waves \[m\].
        disturbance: f64,
    },
}

/// A swatch between two clamps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClampedStretch {
    /// Length between the clamps \[m\].
    pub length: f64,
    /// Width \[m\].
    pub width: f64,
    /// Direction of the pull from the weft (0) towards the warp (π/2) \[rad\].
    pub angle: f64,
    /// Edge length of the mesh \[m\].
    pub edge: f64,
    /// Whether it may wrinkle.
    pub out_of_plane: OutOfPlane,
    /// Largest load step, in stretch \[–\].
    pub largest_step: f64,
    /// When it is at rest.
    pub rest: RestSettings,
}

impl Default for ClampedStretch {
    /// The swatch of [Sperl2022, section 4.3], 10 cm long and 6 cm wide, along the weft, flat.
    fn default() -> Self {
        Self {
            length: 0.1,
            width: 0.06,
            angle: 0.0,
            edge: 0.004,
            out_of_plane: OutOfPlane::Flat,
            largest_step: 0.2,
            rest: RestSettings::default(),
        }
    }
}

/// A point of a clamped stretch with its derivatives by the six stiffnesses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensitivePoint {
    /// Stretch, force \[N\] and compression.
    pub point: StretchPoint,
    /// Derivatives of the force by each stiffness \[m\].
    pub force_slope: [f64; MembraneStiffness::COUNT],
    /// Derivatives of the compression by each stiffness \[m/N\].
    pub compression_slope: [f64; MembraneStiffness::COUNT],
}

/// A swatch as it lies.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Places of the vertices at rest, along and across the pull \[m\].
    pub rest: Vec<[f64; 2]>,
    /// Where they are \[m\].
    pub places: Vec<[f64; 3]>,
    /// Vertices of the triangles.
    pub triangles: Vec<[u32; 3]>,
}

impl Sheet {
    /// The largest principal stretch of each triangle, one where it is not deformed \[–\].
    #[must_use]
    pub fn principal_stretches(&self) -> Vec<f64> {
        let one = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| v as usize);
            let (p, q) =
                ([0, 1].map(|i| self.rest[b][i] - self.rest[a][i]), [0, 1].map(|i| self.rest[c][i] - self.rest[a][i]));
            let determinant = p[0] * q[1] - p[1] * q[0];
            let along = [0, 1, 2].map(|i| self.places[b][i] - self.places[a][i]);
            let other = [0, 1, 2].map(|i| self.places[c][i] - self.places[a][i]);
            // F = [b − a, c − a] [p q]⁻¹, column by column, and the larger eigenvalue of FᵀF.
            let x: [f64; 3] = std::array::from_fn(|i| (along[i] * q[1] - other[i] * p[1]) / determinant);
            let y: [f64; 3] = std::array::from_fn(|i| (other[i] * p[0] - along[i] * q[0]) / determinant);
            let product = |a: &[f64; 3], b: &[f64; 3]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
            let (xx, xy, yy) = (product(&x, &x), product(&x, &y), product(&y, &y));
            (0.5 * (xx + yy) + (0.25 * (xx - yy).powi(2) + xy * xy).sqrt()).sqrt()
        };
        self.triangles.iter().map(one).collect()
    }
}

/// A swatch in its clamps.
struct Clamped {
    rectangle: Rectangle,
    system: ShellSystem,
    q: Vec<f64>,
}

impl ClampedStretch {
    /// Pulls a fabric to the given stretches, one after the other.
    ///
    /// # Errors
    /// [`ShellError`]: an impossible number, or a swatch that does not come to rest.
    pub fn run(&self, card: &ShellCard, stretches: &[f64]) -> Result<Vec<StretchPoint>, ShellError> {
        self.run_with_sheet(card, stretches).map(|(points, _)| points)
    }

    /// The same, and how the swatch lies at the last of them.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn run_with_sheet(
        &self,
        card: &ShellCard,
        stretches: &[f64],
    ) -> Result<(Vec<StretchPoint>, Sheet), ShellError> {
        let mut clamped = self.clamp(card)?;
        let mut points = Vec::with_capacity(stretches.len());
        let mut from = 0.0;
        for &stretch in stretches {
            self.pull(&mut clamped, [from, stretch])?;
            clamped.system.linearise(&clamped.q, 0.0);
            points.push(clamped.measure(stretch));
            from = stretch;
        }
        let Clamped { rectangle: Rectangle { mesh, .. }, q, .. } = clamped;
        let places = (0..mesh.points.len()).map(|v| [0, 1, 2].map(|i| q[BLOCK * v + i])).collect();
        Ok((points, Sheet { rest: mesh.points, places, triangles: mesh.triangles }))
    }

    /// The same with the derivatives by the six stiffnesses, exact through equilibrium: for each number that is measured one
    /// more solve with the factor of the last Newton step.
    ///
    /// # Errors
    /// As [`Self::run`]; and [`ShellError::Cholesky`] where the swatch rests on no strict minimum.
    pub fn run_with_slopes(&self, card: &ShellCard, stretches: &[f64]) -> Result<Vec<SensitivePoint>, ShellError> {
        let mut clamped = self.clamp(card)?;
        let mut points = Vec::with_capacity(stretches.len());
        let mut from = 0.0;
        for &stretch in stretches {
            self.pull(&mut clamped, [from, stretch])?;
            points.push(clamped.measure_with_slopes(stretch)?);
            from = stretch;
        }
        Ok(points)
    }

    fn clamp(&self, card: &ShellCard) -> Result<Clamped, ShellError> {
        positive("largest load step", self.largest_step)?;
        let rectangle = Rectangle::new(self.length, self.width, self.edge)?;
        let flat = self.out_of_plane == OutOfPlane::Flat;
        let mut held = vec![[false, false, flat]; rectangle.mesh.points.len()];
        for end in rectangle.ends() {
            held[end].fill([true; 3]);
        }
        let system = ShellSystem::new(&rectangle.mesh, card, self.angle, [0.0; 3], &held)?;
        let mut q = rectangle.mesh.laid_flat();
        if let OutOfPlane::Free { disturbance } = self.out_of_plane {
            for (v, [x, y]) in rectangle.mesh.points.iter().enumerate().filter(|(v, _)| !held[*v][2]) {
                // Folds along the pull are what clamped sheets wrinkle to; five across, and one beside to break the symmetry.
                let wave = (std::f64::consts::PI * x / self.length).sin();
                let across = std::f64::consts::TAU * y / self.width;
                q[BLOCK * v + 2] = disturbance * wave * ((5.0 * across).cos() + 0.3 * across.sin());
            }
        }
        Ok(Clamped { rectangle, system, q })
    }

    fn pull(&self, clamped: &mut Clamped, range: [f64; 2]) -> Result<(), ShellError> {
        for stretch in range {
            positive("1 + stretch", 1.0 + stretch)?;
        }
        let along = |from: f64, to: f64, q: &mut [f64]| {
            q.iter_mut().step_by(BLOCK).for_each(|x| *x *= (1.0 + to) / (1.0 + from));
        };
        advance_load(&mut clamped.system, &mut clamped.q, &self.rest, range, self.largest_step, "a stretch of", along)
    }
}

impl Clamped {
    /// The clamp that moves, as a direction over all slots: force is the gradient along it.
    fn moving_clamp(&self) -> Vec<f64> {
        let mut clamp = vec![0.0; self.q.len()];
        let [_, end] = self.rectangle.ends();
        end.for_each(|v| clamp[BLOCK * v] = 1.0);
        clamp
    }

    /// Slots of the second coordinate of both sides at mid-length.
    fn sides(&self) -> [usize; 2] {
        let middle = self.rectangle.middle();
        [middle.start, middle.end - 1].map(|v| BLOCK * v + 1)
    }

    fn measure(&self, stretch: f64) -> StretchPoint {
        let [left, right] = self.sides();
        StretchPoint {
            stretch,
            force: dot(&self.moving_clamp(), self.system.gradient()),
            compression: 1.0 - (self.q[right] - self.q[left]) / self.rectangle.width,
        }
    }

    fn measure_with_slopes(&mut self, stretch: f64) -> Result<SensitivePoint, ShellError> {
        self.system.prepare_sensitivity(&self.q)?;
        let point = self.measure(stretch);
        // f = c·g(x, k) and H dx/dk = −∂g/∂k give df/dk = (c − H⁻¹Hc)·∂g/∂k.
        let clamp = self.moving_clamp();
        let mut adjoint = self.system.multiply(&clamp);
        self.system.solve(&mut adjoint);
        let direction: Vec<f64> = clamp.iter().zip(&adjoint).map(|(c, a)| c - a).collect();
        let force_slope = self.system.by_membrane(&self.q, &direction);
        let [left, right] = self.sides();
        let mut adjoint = vec![0.0; self.q.len()];
        adjoint[right] = 1.0 / self.rectangle.width;
        adjoint[left] = -1.0 / self.rectangle.width;
        self.system.solve(&mut adjoint);
        let compression_slope = self.system.by_membrane(&self.q, &adjoint);
        Ok(SensitivePoint { point, force_slope, compression_slope })
    }
}

#[cfg(test)]
mod tests {
    use super::super::uniform::uniform_stretch;
    use super::*;
    use wale::energy::BendingStiffness;

    fn card() -> ShellCard {
        let membrane =
            MembraneStiffness { xx: 30.0, xy: 5.0, yy: 90.0, ss: 8.0, n1: 2.0, n2: 4.0, ..MembraneStiffness::NONE };
        ShellCard { membrane, bending: BendingStiffness::isotropic(1e-6), areal_mass: 0.2 }
    }

    #[test]
    fn a_long_swatch_is_stretched_as_a_uniform_strip() {
        let test = ClampedStretch { length: 0.4, width: 0.02, edge: 0.005, ..ClampedStretch::default() };
        for stretch in [0.1, 0.6] {
            let point = test.run(&card(), &[stretch]).unwrap()[0];
            let strip = uniform_stretch(&card().membrane, 0.0, stretch).unwrap().point;
            assert!((point.compression - strip.compression).abs() < 1e-3, "{point:?} {strip:?}");
            // Clamps stiffen an end of about a width's length by a few per cent.
            assert!((point.force / 0.02 / strip.force - 1.0).abs() < 0.02, "{point:?} {strip:?}");
        }
    }

    #[test]
    fn a_swatch_is_stretched_most_in_its_middle_and_as_far_as_its_clamps_say() {
        let test = ClampedStretch { edge: 0.01, ..ClampedStretch::default() };
        let (points, sheet) = test.run_with_sheet(&card(), &[0.3]).unwrap();
        assert_eq!(points, test.run(&card(), &[0.3]).unwrap());
        let stretches = sheet.principal_stretches();
        let rest = Sheet { places: sheet.rest.iter().map(|&[x, y]| [x, y, 0.0]).collect(), ..sheet.clone() };
        assert!(rest.principal_stretches().iter().all(|s| (s - 1.0).abs() < 1e-12));
        let ends =
            sheet.places.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |m, x| [m[0].min(x[0]), m[1].max(x[0])]);
        assert!((ends[1] - ends[0] - 0.13).abs() < 1e-12);
        let mean = stretches.iter().sum::<f64>() / stretches.len() as f64;
        assert!((mean - 1.3).abs() < 0.02, "{mean}");
    }

    #[test]
    fn slopes_are_those_of_differences() {
        for angle in [0.0, 0.25 * std::f64::consts::PI] {
            let test = ClampedStretch { edge: 0.01, angle, ..ClampedStretch::default() };
            let found = test.run_with_slopes(&card(), &[0.2, 0.7]).unwrap();
            for k in 0..6 {
                let moved = |by: f64| {
                    let mut array = card().membrane.to_array();
                    array[k] += by;
                    let card = ShellCard { membrane: MembraneStiffness::from_array(array), ..card() };
                    test.run(&card, &[0.2, 0.7]).unwrap()
                };
                let (up, down) = (moved(1e-3), moved(-1e-3));
                for (point, (up, down)) in found.iter().zip(up.iter().zip(&down)) {
                    let force = (up.force - down.force) / 2e-3;
                    let compression = (up.compression - down.compression) / 2e-3;
                    assert!((force - point.force_slope[k]).abs() < 1e-6, "{k}: {force} {}", point.force_slope[k]);
                    assert!((compression - point.compression_slope[k]).abs() < 1e-6, "{k}: {compression}");
                }
            }
        }
    }

    #[test]
    fn it_comes_to_rest_at_large_stretch_in_every_direction() {
        for degrees in [0.0f64, 20.0, 45.0, 90.0] {
            let test = ClampedStretch { angle: degrees.to_radians(), edge: 0.006, ..ClampedStretch::default() };
            let points = test.run(&card(), &[0.4, 0.8, 1.2, 1.6]).unwrap();
            for pair in points.windows(2) {
                assert!(pair[1].force > pair[0].force && pair[1].compression > pair[0].compression, "{degrees}");
            }
        }
    }

    #[test]
    fn a_swatch_that_may_wrinkle_is_no_stiffer_than_one_that_may_not() {
        let flat = ClampedStretch { edge: 0.005, ..ClampedStretch::default() };
        let free = ClampedStretch { out_of_plane: OutOfPlane::Free { disturbance: 1e-4 }, ..flat };
        let [flat, free] = [flat, free].map(|test| test.run(&card(), &[0.3]).unwrap()[0]);
        assert!(free.force <= flat.force * (1.0 + 1e-9) && free.force > 0.95 * flat.force, "{free:?} {flat:?}");
    }

    #[test]
    fn a_swatch_that_may_wrinkle_comes_to_rest_at_large_stretch_along_the_bias() {
        let out_of_plane = OutOfPlane::Free { disturbance: 1e-4 };
        let angle = std::f64::consts::FRAC_PI_4;
        let test = ClampedStretch { angle, edge: 0.006, out_of_plane, ..ClampedStretch::default() };
        let points = test.run(&card(), &[0.8, 1.6]).unwrap();
        assert!(points[1].force > points[0].force, "{points:?}");
    }

    #[test]
    fn impossible_tests_are_errors() {
        let test = ClampedStretch::default();
        assert!(test.run(&card(), &[-1.0]).is_err());
        assert!(ClampedStretch { length: 0.0, ..test }.run(&card(), &[0.1]).is_err());
        let hurried = RestSettings { max_iterations: 1, ..RestSettings::default() };
        let error = ClampedStretch { rest: hurried, ..test }.run(&card(), &[0.5]).unwrap_err();
        assert!(error.to_string().contains("did not come to rest at a stretch of"), "{error}");
    }
}
