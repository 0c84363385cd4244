//! The pear loop: a strip bent into a loop by clamps that are brought near each other [Peirce1930; Sperl2022, section 4.3].

use std::f64::consts::TAU;

use wale::energy::BendingStiffness;
use wale::fabric::coordinates::BLOCK;

use super::card::ShellCard;
use super::error::{ShellError, positive};
use super::mesh::Rectangle;
use super::rest::{RestSettings, come_to_rest};
use super::system::ShellSystem;

/// A strip between two clamps at one height, `x` from clamp to clamp, `y` along them, `z` up; the loop is below them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PearLoop {
    /// Free length between the clamps \[m\].
    pub length: f64,
    /// Width \[m\].
    pub width: f64,
    /// Direction of the strip from the weft (0) towards the warp (π/2) \[rad\].
    pub angle: f64,
    /// How far down the fabric leaves the clamps: 0 where they face each other, π/2 where they lie side by side \[rad\].
    pub clamp_angle: f64,
    /// Gravity \[m/s²\]; upward for a loop that stands on its clamps, turned upside down.
    pub gravity: [f64; 3],
    /// Edge length of the mesh \[m\].
    pub edge: f64,
    /// When it is at rest.
    pub rest: RestSettings,
}

impl Default for PearLoop {
    /// The strip of [Sperl2022, section 4.3], 100 × 60 mm along the weft, hanging from clamps that face each other, as those of
    /// the stretch test do.
    fn default() -> Self {
        Self {
            length: 0.1,
            width: 0.06,
            angle: 0.0,
            clamp_angle: 0.0,
            gravity: [0.0, 0.0, -9.81],
            edge: 0.004,
            rest: RestSettings::default(),
        }
    }
}

/// A loop at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PearPoint {
    /// Distance between the clamps \[m\].
    pub distance: f64,
    /// Height of the loop from the clamps down \[m\].
    pub height: f64,
    /// Width of the loop, at least the distance of the clamps \[m\].
    pub width: f64,
    /// `h/p`: height over width \[–\].
    pub aspect: f64,
    /// Derivatives of the aspect by each bending stiffness \[1/(N·m)\].
    pub aspect_slope: [f64; BendingStiffness::COUNT],
}

/// An extreme of a profile, between its vertices: value, and how it hangs on each row.
struct Extreme {
    value: f64,
    rows: Vec<(usize, f64)>,
}

impl PearLoop {
    /// Bends a fabric at the given distances between the clamps \[m\], each from an elastica-like guess.
    ///
    /// # Errors
    /// [`ShellError`]: an impossible number, a distance that the strip does not reach or that would fold it over, or a loop that
    /// does not come to rest.
    pub fn run(&self, card: &ShellCard, distances: &[f64]) -> Result<Vec<PearPoint>, ShellError> {
        distances.iter().map(|&distance| self.at(card, distance)).collect()
    }

    fn at(&self, card: &ShellCard, distance: f64) -> Result<PearPoint, ShellError> {
        positive("length of the strip", self.length)?;
        positive("edge length of the mesh", self.edge)?;
        positive("distance of the clamps", distance)?;
        let altitude = 0.75f64.sqrt() * self.edge;
        let strips = 2.0 * (0.5 * self.length / altitude).round().max(4.0);
        // Clamps end in the middle of the first and the last row of triangles: the hinges beside them then bend for half a row
        // to either side, like all others.
        let step = self.length / (strips - 1.0);
        let rectangle = Rectangle::new(step * strips, self.width, step / 0.75f64.sqrt())?;
        let rows = rectangle.rows.len();
        let mut held = vec![[false; 3]; rectangle.mesh.points.len()];
        for row in [0, 1, rows - 2, rows - 1] {
            held[rectangle.rows[row].clone()].fill([true; 3]);
        }
        let mut system = ShellSystem::new(&rectangle.mesh, card, self.angle, self.gravity, &held)?;
        let profile = self.guess(distance, rows, step)?;
        let mut q = vec![0.0; BLOCK * rectangle.mesh.points.len()];
        for (row, [x, z]) in profile.iter().enumerate() {
            for v in rectangle.rows[row].clone() {
                q[BLOCK * v..BLOCK * v + 3].copy_from_slice(&[*x, rectangle.mesh.points[v][1], *z]);
            }
        }
        come_to_rest(&mut system, &mut q, &self.rest).map_err(|error| match error {
            ShellError::NotAtRest { iterations, residual, .. } => {
                ShellError::NotAtRest { load: format!("clamps {distance:.4} m apart"), iterations, residual }
            }
            other => other,
        })?;
        measure(&mut system, &rectangle, &q, distance)
    }

    /// A profile of the right length that meets both clamps at their angle: a curve whose direction is a sine of its arc length
    /// beside a straight turn, as elasticas nearly are.
    fn guess(&self, distance: f64, rows: usize, step: f64) -> Result<Vec<[f64; 2]>, ShellError> {
        let (length, clamp) = (self.length, self.clamp_angle);
        // Directions of the strips between rows; the first and the last lie in the clamps.
        let directions = |bulge: f64| -> Vec<f64> {
            let at = |strip: usize| (strip as f64 * step / length).clamp(0.0, 1.0);
            (0..rows - 1).map(|k| -clamp * (1.0 - 2.0 * at(k)) - bulge * (TAU * at(k)).sin()).collect()
        };
        let chord = |bulge: f64| {
            let directions = directions(bulge);
            let ends = 0.5 * (directions[0].cos() + directions[rows - 2].cos());
            step * (directions[1..rows - 2].iter().map(|d| d.cos()).sum::<f64>() + ends)
        };
        let (mut less, mut more) = (-1.0, 2.6);
        if !(chord(less) >= distance && chord(more) <= distance) {
            let must = "smaller than the strip is long, and large enough that it need not fold over";
            return Err(ShellError::Number { what: "distance of the clamps", value: distance, must });
        }
        for _ in 0..80 {
            let middle = 0.5 * (less + more);
            if chord(middle) > distance { less = middle } else { more = middle }
        }
        let directions = directions(less);
        // The first clamp's end is the origin.
        let mut place = [-0.5 * step * directions[0].cos(), -0.5 * step * directions[0].sin()];
        let mut profile = vec![place];
        for d in directions {
            place = [place[0] + step * d.cos(), place[1] + step * d.sin()];
            profile.push(place);
        }
        Ok(profile)
    }
}

fn measure(system: &mut ShellSystem, rectangle: &Rectangle, q: &[f64], distance: f64) -> Result<PearPoint, ShellError> {
    let mean = |row: usize, axis: usize| {
        let vertices = rectangle.rows[row].clone();
        let count = vertices.len() as f64;
        vertices.map(|v| q[BLOCK * v + axis]).sum::<f64>() / count
    };
    let line =
        |axis: usize, sign: f64| -> Vec<f64> { (0..rectangle.rows.len()).map(|row| sign * mean(row, axis)).collect() };
    let bottom = largest(&line(2, -1.0), 0.0);
    let (right, left) = (largest(&line(0, 1.0), distance), largest(&line(0, -1.0), 0.0));
    let (height, width) = (bottom.value, right.value + left.value);
    let aspect = height / width;

    // d(h/p) = (dh − h/p dp)/p, and dx = −H⁻¹ ∂g/∂k dk.
    system.prepare_sensitivity(q)?;
    let mut adjoint = vec![0.0; q.len()];
    for (extreme, axis, by) in [(&bottom, 2, -1.0), (&right, 0, -aspect), (&left, 0, aspect)] {
        for &(row, weight) in &extreme.rows {
            let vertices = rectangle.rows[row].clone();
            let share = by * weight / (width * vertices.len() as f64);
            vertices.for_each(|v| adjoint[BLOCK * v + axis] += share);
        }
    }
    system.solve(&mut adjoint);
    let aspect_slope = system.by_bending(q, &adjoint).map(|slope| -slope);
    Ok(PearPoint { distance, height, width, aspect, aspect_slope })
}

/// The largest value of a line between the clamps, by the parabola through its largest free vertex and both neighbours; the
/// clamps' ends, where the line lies nowhere beyond them.
fn largest(line: &[f64], clamps: f64) -> Extreme {
    let top = (2..line.len() - 2).fold(2, |top, k| if line[k] > line[top] { k } else { top });
    if line[top] <= clamps {
        return Extreme { value: clamps, rows: Vec::new() };
    }
    let (before, here, after) = (line[top - 1], line[top], line[top + 1]);
    let bend = after - 2.0 * here + before;
    let t = if bend < 0.0 { -0.5 * (after - before) / bend } else { 0.0 };
    let weights = [0.5 * t * (t - 1.0), 1.0 - t * t, 0.5 * t * (t + 1.0)];
    let value = weights[0] * before + weights[1] * here + weights[2] * after;
    Extreme { value, rows: weights.into_iter().enumerate().map(|(k, weight)| (top - 1 + k, weight)).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;
    use wale::energy::MembraneStiffness;

    fn card(bending: BendingStiffness) -> ShellCard {
        let membrane =
            MembraneStiffness { xx: 300.0, xy: 20.0, yy: 300.0, ss: 60.0, n1: 2.0, n2: 4.0, ..MembraneStiffness::NONE };
        ShellCard { membrane, bending, areal_mass: 0.2 }
    }

    #[test]
    fn limp_loops_are_longer_and_weightless_ones_are_all_alike() {
        let test = PearLoop { edge: 0.008, width: 0.024, ..PearLoop::default() };
        let aspect = |test: &PearLoop, stiffness: f64| {
            test.run(&card(BendingStiffness::isotropic(stiffness)), &[0.01]).unwrap()[0].aspect
        };
        assert!(aspect(&test, 0.5e-6) > 1.1 * aspect(&test, 5e-6));
        let floating = PearLoop { gravity: [0.0; 3], ..test };
        assert!((aspect(&floating, 1e-6) / aspect(&floating, 4e-6) - 1.0).abs() < 1e-3);
        // Standing upon its clamps a loop sags, hanging it is drawn long.
        let standing = PearLoop { gravity: [0.0, 0.0, 9.81], ..test };
        let [standing, floating, hanging] = [standing, floating, test].map(|test| aspect(&test, 2e-5));
        assert!(standing < floating && floating < hanging, "{standing} {floating} {hanging}");
    }

    #[test]
    fn a_strip_held_by_its_ends_side_by_side_hangs_in_a_pear() {
        let test = PearLoop { clamp_angle: FRAC_PI_2, edge: 0.008, width: 0.024, ..PearLoop::default() };
        let point = test.run(&card(BendingStiffness::isotropic(2e-6)), &[0.003]).unwrap()[0];
        assert!(point.aspect > 1.2 && point.width > 0.01 && point.height < 0.05, "{point:?}");
    }

    #[test]
    fn slopes_are_those_of_differences() {
        let stiffness = BendingStiffness { weft: 2e-6, bias: 3e-6, warp: 4e-6 };
        for angle in [0.0, 0.5 * FRAC_PI_2] {
            let test = PearLoop { edge: 0.01, width: 0.03, angle, ..PearLoop::default() };
            let found = test.run(&card(stiffness), &[0.02]).unwrap()[0];
            for k in 0..3 {
                let moved = |by: f64| {
                    let mut array = stiffness.to_array();
                    array[k] += by;
                    test.run(&card(BendingStiffness::from_array(array)), &[0.02]).unwrap()[0].aspect
                };
                let slope = (moved(2e-8) - moved(-2e-8)) / 4e-8;
                let largest = found.aspect_slope.iter().fold(0.0f64, |m, s| m.max(s.abs()));
                assert!(
                    (slope - found.aspect_slope[k]).abs() < 1e-3 * largest,
                    "{k}: {slope} {:?}",
                    found.aspect_slope
                );
            }
        }
    }

    #[test]
    fn distances_that_cannot_be_are_errors() {
        let card = card(BendingStiffness::isotropic(1e-6));
        for distance in [0.0, 0.2, f64::NAN] {
            assert!(PearLoop::default().run(&card, &[distance]).is_err());
        }
    }
}
