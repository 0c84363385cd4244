//! A swatch between clamps that is drawn apart to a load and brought back: with friction, so that not all work returns.

use glam::DVec3;
use wale::dynamics::State;
use wale::model::motion::Key;
use wale::model::{Drive, Edge, Frame, Grip, Motion, Network, Selection};
use wale::scene::Scene;
use wale::simulation::{Simulation, Start};

use super::{MOST_LOOPS, SwatchTestError, relaxed_spacing, start, swatch};
use crate::virtual_test::rig::Specimen;
use crate::virtual_test::stretch::Until;

/// A test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClampedSwatch {
    /// What is clamped, if it has few enough loops.
    pub specimen: Specimen,
    /// Whether it is drawn along the wales (warp), not along the courses (weft).
    pub along_wales: bool,
    /// How far.
    pub until: Until,
    /// Stretch by time \[1/s\]; slow enough that only friction tells the way back from the way there.
    pub rate: f64,
    /// Stretch between two points of the curve \[–\].
    pub spacing: f64,
    /// Most loops; a larger specimen is made smaller in proportion.
    pub most_loops: usize,
}

impl ClampedSwatch {
    /// A specimen drawn at 5 % a second, with a point every half per cent.
    #[must_use]
    pub fn new(specimen: Specimen, along_wales: bool, until: Until) -> Self {
        Self { specimen, along_wales, until, rate: 0.05, spacing: 0.005, most_loops: 400 }
    }
}

/// What the test reports.
#[derive(Clone, Debug, PartialEq)]
pub struct ClampedResult {
    /// Columns and rows of loops.
    pub loops: [usize; 2],
    /// Length between the clamps, and width, before it is drawn \[m\].
    pub specimen: Specimen,
    /// Whether the specimen that was asked for had more loops than are tested.
    pub made_smaller: bool,
    /// Stretch \[–\], force by width \[N/m\], contraction at mid-length \[–\], on the way there.
    pub loading: Vec<[f64; 3]>,
    /// On the way back, down to no force or no stretch.
    pub unloading: Vec<[f64; 3]>,
    /// Work by area on the way there \[J/m²\].
    pub work: f64,
    /// Part of it that comes back \[–\].
    pub returned: f64,
    /// Stretch that is left where the force has gone \[–\].
    pub residual: f64,
}

/// Least loops along each side.
const FEWEST: usize = 6;
/// Stretch at which a load is given up \[–\].
const LARGEST: f64 = 3.0;
/// Longest time step \[s\]: at a slow pull, steps may be longer than a scene's.
const LONGEST_STEP: f64 = 0.02;
/// Time for which the swatch settles between the clamps before it is drawn \[s\].
const SETTLE: f64 = 0.5;

impl ClampedSwatch {
    /// Draws a swatch of a scene's pattern and yarns.
    ///
    /// # Errors
    /// [`SwatchTestError`].
    pub fn run(&self, scene: &Scene) -> Result<ClampedResult, SwatchTestError> {
        let Specimen { length, width } = self.specimen;
        for (what, value) in [
            ("length of the specimen", length),
            ("width of the specimen", width),
            ("rate", self.rate),
            ("spacing", self.spacing),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(SwatchTestError::Number { what, value, must: "positive and finite" });
            }
        }
        let (load, largest) = match self.until {
            Until::Stretch(stretch) => (f64::INFINITY, stretch),
            Until::LineLoad(load) => (load, LARGEST),
        };
        if !(load > 0.0 && largest > 0.0 && largest <= LARGEST) {
            let must = "a positive load, or a stretch above 0 and at most 300 %";
            return Err(SwatchTestError::Number { what: "end of the test", value: load.min(largest), must });
        }
        let (loops, made_smaller) = self.loops(scene)?;
        let mut scene = swatch(scene, loops[0], loops[1])?;
        scene.plan.simulation.largest_step = scene.plan.simulation.largest_step.max(LONGEST_STEP);
        scene.plan.simulation.frame_rate = self.rate / self.spacing;
        // When it ends, the force says.
        scene.plan.simulation.duration = f64::MAX;
        let laid = start(&scene, true);
        let axis = usize::from(self.along_wales);
        let measured = Measured::new(&laid.network, axis);
        let gauge = measured.length;
        scene.plan.grips = self.grips(&[[0.0, 0.0], [SETTLE, 0.0], [SETTLE + largest / self.rate, largest * gauge]]);
        let mut drawn = Drawn::new(&scene, &laid, &measured, axis);
        drawn.go(&mut |time, _| time < SETTLE - 1e-9, SETTLE)?;
        let first = drawn.point();
        let end = SETTLE + largest / self.rate;
        let mut loading = vec![first];
        loading.extend(drawn.go(&mut |_, point| point[1] < load, end)?);
        let last = loading[loading.len() - 1];
        if last[1] < load && load.is_finite() {
            return Err(SwatchTestError::Load { load, stretch: last[0], force: last[1] });
        }
        // The same clamp turns round where it is.
        let (now, there) = (drawn.simulation.state().time, last[0] * gauge);
        let back = now + last[0] / self.rate;
        scene.plan.grips = self.grips(&[[0.0, 0.0], [SETTLE, 0.0], [now, there], [back, 0.0]]);
        let state = drawn.simulation.state().clone();
        let mut drawn = Drawn::new(&scene, &laid, &measured, axis);
        drawn.restore(state);
        let mut unloading = vec![last];
        unloading.extend(drawn.go(&mut |_, point| point[1] > 0.0, back)?);
        Ok(self.result(loops, made_smaller, &measured, loading, unloading))
    }

    /// Columns and rows for the specimen, and whether it was made smaller.
    fn loops(&self, scene: &Scene) -> Result<([usize; 2], bool), SwatchTestError> {
        let spacing = relaxed_spacing(scene)?;
        let Specimen { length, width } = self.specimen;
        let size = if self.along_wales { [width, length] } else { [length, width] };
        let wanted = [0, 1].map(|axis| size[axis] / spacing[axis]);
        let most = self.most_loops.min(MOST_LOOPS) as f64;
        let factor = (most / (wanted[0] * wanted[1])).sqrt().min(1.0);
        Ok((wanted.map(|count| ((factor * count).round() as usize).max(FEWEST)), factor < 1.0))
    }

    /// One edge held still, the other moved by keys of time \[s\] and way \[m\].
    fn grips(&self, keys: &[[f64; 2]]) -> Vec<Grip> {
        let (still, moved) = if self.along_wales { (Edge::Bottom, Edge::Top) } else { (Edge::Left, Edge::Right) };
        let way = if self.along_wales { DVec3::Y } else { DVec3::X };
        let key = |&[time, far]: &[f64; 2]| Key { time, rotation: DVec3::ZERO, translation: far * way };
        let grip = |name: &str, edge, keys: Vec<Key>| Grip {
            name: name.to_owned(),
            nodes: Selection::Edge { edge, depth: 1 },
            axes: [true; 3],
            drive: Drive::Follow(Motion { keys, pivot: DVec3::ZERO }),
            from: 0.0,
            until: None,
        };
        vec![grip("still clamp", still, Vec::new()), grip("moved clamp", moved, keys.iter().map(key).collect())]
    }

    fn result(
        &self,
        loops: [usize; 2],
        made_smaller: bool,
        measured: &Measured,
        loading: Vec<[f64; 3]>,
        mut unloading: Vec<[f64; 3]>,
    ) -> ClampedResult {
        // Where the force goes, between two points.
        let residual = match unloading.len() {
            n if n >= 2 && unloading[n - 1][1] <= 0.0 => {
                let (a, b) = (unloading[n - 2], unloading[n - 1]);
                let part = a[1] / (a[1] - b[1]);
                let end = [a[0] + part * (b[0] - a[0]), 0.0, a[2] + part * (b[2] - a[2])];
                unloading[n - 1] = end;
                end[0]
            }
            // It is back where it was, and still pulls.
            _ => 0.0,
        };
        let area = |points: &[[f64; 3]]| -> f64 {
            points.windows(2).map(|p| 0.5 * (p[1][0] - p[0][0]) * (p[0][1] + p[1][1])).sum()
        };
        let work = area(&loading);
        ClampedResult {
            loops,
            specimen: Specimen { length: measured.length, width: measured.width },
            made_smaller,
            returned: -area(&unloading) / work,
            loading,
            unloading,
            work,
            residual,
        }
    }
}

/// What is measured of a frame.
struct Measured {
    /// Length between the clamps \[m\].
    length: f64,
    /// Width at mid-length, and by which forces are divided \[m\].
    width: f64,
    /// Nodes of loops on either side, at mid-length.
    sides: [Vec<usize>; 2],
    across: usize,
}

impl Measured {
    fn new(network: &Network, axis: usize) -> Self {
        let [rows, columns] = network.chart_size;
        let across = 1 - axis;
        let nodes = |edge| Selection::Edge { edge, depth: 1 }.nodes(network, &network.position);
        let mean = |edge| {
            let nodes = nodes(edge);
            nodes.iter().map(|node| network.position[node.index()][axis]).sum::<f64>() / nodes.len() as f64
        };
        let (low, high) = if axis == 1 { (Edge::Bottom, Edge::Top) } else { (Edge::Left, Edge::Right) };
        // The two middle columns (or rows), and of them the loops at either end.
        let middle = |at: u32, count: u32| at + 1 >= count / 2 && at <= count / 2;
        let side = |last: bool| -> Vec<usize> {
            let of = |along: u32, count: u32, across: u32, wide: u32| {
                middle(along, count) && across == if last { wide - 1 } else { 0 }
            };
            let picked = network.loops.iter().filter(|info| match axis {
                0 => of(info.column, columns, info.row, rows),
                _ => of(info.row, rows, info.column, columns),
            });
            picked.flat_map(|info| info.nodes.iter().map(|node| node.index())).collect()
        };
        let mut measured =
            Self { length: mean(high) - mean(low), width: 1.0, sides: [side(false), side(true)], across };
        // Loops stand for the fabric half a spacing around their middle.
        let counts = [columns, rows].map(f64::from);
        let between = measured.between(&network.position);
        measured.width = between * counts[across] / (counts[across] - 1.0);
        measured
    }

    fn between(&self, positions: &[DVec3]) -> f64 {
        let [low, high] = [0, 1].map(|side: usize| {
            let nodes = &self.sides[side];
            nodes.iter().map(|&node| positions[node][self.across]).sum::<f64>() / nodes.len().max(1) as f64
        });
        high - low
    }
}

/// A swatch on its way.
struct Drawn<'a> {
    simulation: Simulation,
    measured: &'a Measured,
    axis: usize,
    between: f64,
}

impl<'a> Drawn<'a> {
    fn new(scene: &Scene, laid: &Start, measured: &'a Measured, axis: usize) -> Self {
        let simulation = Simulation::new(laid.network.clone(), &scene.yarns, &scene.fabric, scene.plan.clone());
        Self { simulation, measured, axis, between: measured.between(&laid.network.position) }
    }

    fn restore(&mut self, state: State) {
        let fits = self.simulation.restore(state);
        assert!(fits, "the same swatch has the same state");
    }

    /// Goes on while it may, to a time; the points at its frames.
    fn go(&mut self, on: &mut dyn FnMut(f64, &[f64; 3]) -> bool, end: f64) -> Result<Vec<[f64; 3]>, SwatchTestError> {
        let mut points = Vec::new();
        while self.simulation.state().time < end - 1e-9 {
            let report = self.simulation.step();
            report.map_err(|cause| SwatchTestError::Stopped { stretch: self.point()[0], cause })?;
            if self.simulation.frame_due().is_none() && self.simulation.state().time < end - 1e-9 {
                continue;
            }
            let point = self.point();
            points.push(point);
            if !on(self.simulation.state().time, &point) {
                break;
            }
        }
        Ok(points)
    }

    /// Stretch, force by width, contraction.
    fn point(&mut self) -> [f64; 3] {
        let report = self.simulation.standing();
        let (grip, frame): (_, Frame) = (&report.grips[1], self.simulation.frame());
        let contraction = 1.0 - self.measured.between(&frame.positions) / self.between;
        let stretch = grip.displacement[self.axis] / self.measured.length;
        [stretch, grip.force[self.axis] / self.measured.width, contraction]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn garter() -> Scene {
        let text = "schema = 1\n[fabric.chart]\npattern = \"garter\"\ncolumns = 4\nrows = 4\n";
        Scene::from_text(text, "garter.toml").unwrap()
    }

    #[test]
    fn what_is_drawn_with_friction_does_not_give_all_work_back() {
        let specimen = Specimen { length: 0.2, width: 0.2 };
        let test = ClampedSwatch {
            rate: 0.2,
            spacing: 0.01,
            most_loops: 36,
            ..ClampedSwatch::new(specimen, false, Until::Stretch(0.1))
        };
        let found = test.run(&garter()).unwrap();
        assert!(found.made_smaller && found.loops.iter().all(|&count| count >= 6), "{found:?}");
        let last = found.loading[found.loading.len() - 1];
        assert!((last[0] - 0.1).abs() < 1e-6 && found.loading.len() == 11, "{found:?}");
        assert!(last[1] > found.loading[0][1] && found.work > 0.0);
        assert!(found.returned > 0.2 && found.returned < 0.98, "{}", found.returned);
        assert!(found.residual >= 0.0 && found.residual < 0.1);
        // At each stretch the force is smaller on the way back.
        let there = |stretch: f64| found.loading.iter().find(|p| (p[0] - stretch).abs() < 1e-6).map(|p| p[1]);
        for point in &found.unloading[1..found.unloading.len() - 1] {
            assert!(there(point[0]).is_none_or(|force| point[1] < force), "{point:?}");
        }
    }

    #[test]
    fn impossible_tests_are_errors() {
        let specimen = Specimen { length: 0.1, width: 0.1 };
        let test = |until| ClampedSwatch::new(specimen, true, until).run(&garter());
        assert!(matches!(test(Until::Stretch(-0.1)), Err(SwatchTestError::Number { .. })));
        assert!(matches!(test(Until::LineLoad(f64::NAN)), Err(SwatchTestError::Number { .. })));
        let still = ClampedSwatch { rate: 0.0, ..ClampedSwatch::new(specimen, true, Until::Stretch(0.1)) };
        assert!(matches!(still.run(&garter()), Err(SwatchTestError::Number { .. })));
        assert!(matches!(crate::swatch_test::curl(&garter(), 100, 100), Err(SwatchTestError::TooLarge { .. })));
    }
}
