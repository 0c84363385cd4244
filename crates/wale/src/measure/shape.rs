//! The shape of a frame: extent, stitch density, and how the fabric curves along course and wale.

use glam::DVec3;
use serde::Serialize;

use crate::model::{Frame, Network};

/// Mean curvature of a part of the fabric \[1/m\], positive where it curls to the front (the right side).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Curvature {
    /// Along the courses.
    pub course_per_m: f64,
    /// Along the wales.
    pub wale_per_m: f64,
}

/// What one frame measures. Loops are taken at the middle of their nodes.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Shape {
    /// Size of the box around all nodes, along the world's axes \[m\].
    pub extent_m: [f64; 3],
    /// Mean distance of neighbouring loops along a course \[m\].
    pub wale_spacing_m: f64,
    /// Mean distance of neighbouring loops along a wale \[m\].
    pub course_spacing_m: f64,
    /// Loops an area \[1/m²\], along the fabric where it curves.
    pub stitch_density_per_m2: f64,
    /// Mean over the whole fabric.
    pub curvature: Curvature,
    /// Mean over the outermost loops of the left and right edges.
    pub side_edges: Curvature,
    /// Mean over the outermost loops of the cast-on and bind-off edges.
    pub end_edges: Curvature,
}

/// Most loops to either side over which a curvature is taken; single loops stand too unevenly.
const REACH: usize = 2;
/// Share of the chart that counts as an edge.
const EDGE: f64 = 0.15;

impl Shape {
    /// Measures a frame of a network; lengths and curvatures are zero where there are too few loops.
    #[must_use]
    pub fn of(network: &Network, frame: &Frame) -> Self {
        let (low, high) = frame
            .positions
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
        let chart = LoopCentres::new(network, frame);
        let wale_spacing = chart.mean_distance(0, 1);
        let course_spacing = chart.mean_distance(1, 0);
        let area = wale_spacing * course_spacing;
        let [rows, columns] = [chart.rows, chart.columns];
        let is_edge = |at: usize, count: usize| {
            let width = Self::edge_loops(count);
            at < width || at + width >= count
        };
        Self {
            extent_m: if frame.positions.is_empty() { [0.0; 3] } else { (high - low).to_array() },
            wale_spacing_m: wale_spacing,
            course_spacing_m: course_spacing,
            stitch_density_per_m2: if area > 0.0 { 1.0 / area } else { 0.0 },
            curvature: chart.mean_curvature(|_, _| true),
            side_edges: chart.mean_curvature(|_, column| is_edge(column, columns)),
            end_edges: chart.mean_curvature(|row, _| is_edge(row, rows)),
        }
    }
}

impl Shape {
    /// Outermost loops that count as an edge, of so many side by side.
    #[must_use]
    pub fn edge_loops(count: usize) -> usize {
        (EDGE * count as f64).ceil() as usize
    }

    /// Mean curvature \[1/m\] along the courses by column, and along the wales by row.
    #[must_use]
    pub fn profiles(network: &Network, frame: &Frame) -> [Vec<f64>; 2] {
        let chart = LoopCentres::new(network, frame);
        let of_column = |k: usize| chart.mean_curvature(|_, column| column == k).course_per_m;
        let of_row = |k: usize| chart.mean_curvature(|row, _| row == k).wale_per_m;
        [(0..chart.columns).map(of_column).collect(), (0..chart.rows).map(of_row).collect()]
    }
}

/// Places that a loop's neighbour is looked for.
const BEYOND: isize = 4;

/// Middles of the loops, by row and column of the chart.
struct LoopCentres {
    rows: usize,
    columns: usize,
    centres: Vec<Option<DVec3>>,
}

impl LoopCentres {
    fn new(network: &Network, frame: &Frame) -> Self {
        // The loops themselves say how large the chart is: what a file claims need not be so.
        let rows = network.loops.iter().map(|info| info.row as usize + 1).max().unwrap_or(0);
        let columns = network.loops.iter().map(|info| info.column as usize + 1).max().unwrap_or(0);
        let mut centres = vec![None; rows * columns];
        for info in &network.loops {
            let sum: DVec3 = info.nodes.iter().map(|node| frame.positions[node.index()]).sum();
            if !info.nodes.is_empty() {
                centres[info.row as usize * columns + info.column as usize] = Some(sum / info.nodes.len() as f64);
            }
        }
        Self { rows, columns, centres }
    }

    fn at(&self, row: isize, column: isize) -> Option<DVec3> {
        let row = usize::try_from(row).ok().filter(|row| *row < self.rows)?;
        let column = usize::try_from(column).ok().filter(|column| *column < self.columns)?;
        self.centres[row * self.columns + column]
    }

    fn places(&self) -> impl Iterator<Item = (usize, usize)> {
        let columns = self.columns;
        (0..self.rows).flat_map(move |row| (0..columns).map(move |column| (row, column)))
    }

    /// Mean distance of a loop from the next one so many rows and columns on. Where that place has no loop of its own (a
    /// yarn-over, a slip, a tuck) the next one beyond stands for it.
    fn mean_distance(&self, rows: isize, columns: isize) -> f64 {
        mean(self.places().filter_map(|(row, column)| {
            let (row, column) = (row as isize, column as isize);
            let here = self.at(row, column)?;
            (1..=BEYOND).find_map(|k| Some(here.distance(self.at(row + k * rows, column + k * columns)?) / k as f64))
        }))
    }

    fn mean_curvature(&self, part: impl Fn(usize, usize) -> bool) -> Curvature {
        let reach = |count: usize| (count / 5).clamp(1, REACH) as isize;
        let (down, along) = (reach(self.rows), reach(self.columns));
        // Next to an edge there is no room to both sides: the nearest place inside stands for it.
        let inward = |at: usize, reach: isize, count: usize| {
            let last = count as isize - 1 - reach;
            (reach <= last).then(|| (at as isize).clamp(reach, last))
        };
        let at = |row: usize, column: usize| {
            let (row, column) = (inward(row, down, self.rows)?, inward(column, along, self.columns)?);
            let middle = self.at(row, column)?;
            let course = [self.at(row, column - along)?, self.at(row, column + along)?];
            let wale = [self.at(row - down, column)?, self.at(row + down, column)?];
            let front = (course[1] - course[0]).cross(wale[1] - wale[0]).try_normalize()?;
            Some([course, wale].map(|[before, after]| {
                let arc = 0.5 * (middle.distance(before) + middle.distance(after));
                (before + after - 2.0 * middle).dot(front) / (arc * arc)
            }))
        };
        let found: Vec<[f64; 2]> = self
            .places()
            .filter(|(row, column)| part(*row, *column))
            .filter_map(|(row, column)| at(row, column))
            .filter(|pair| pair.iter().all(|curvature| curvature.is_finite()))
            .collect();
        Curvature {
            course_per_m: mean(found.iter().map(|pair| pair[0])),
            wale_per_m: mean(found.iter().map(|pair| pair[1])),
        }
    }
}

/// The mean; zero of nothing.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0usize), |(sum, count), value| (sum + value, count + 1));
    if count == 0 { 0.0 } else { sum / count as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{LoopInfo, NodeId};

    /// A sheet of one node a loop, bent by a function of row and column \[loops from the middle\].
    fn sheet(rows: u32, columns: u32, place: impl Fn(f64, f64) -> DVec3) -> (Network, Frame) {
        let (mut network, mut frame) = (Network::default(), Frame::default());
        for row in 0..rows {
            for column in 0..columns {
                let node = NodeId::new(frame.positions.len());
                network.loops.push(LoopInfo { row, column, nodes: vec![node], knit: true, held: true });
                let middle = |at: u32, count: u32| f64::from(at) - f64::from(count - 1) / 2.0;
                frame.positions.push(place(middle(row, rows), middle(column, columns)));
            }
        }
        network.chart_size = [rows, columns];
        (network, frame)
    }

    #[test]
    fn a_flat_sheet_is_flat_and_its_density_known() {
        let (network, frame) = sheet(20, 30, |row, column| DVec3::new(2e-3 * column, 1e-3 * row, 0.0));
        let shape = Shape::of(&network, &frame);
        assert!((shape.stitch_density_per_m2 - 5e5).abs() < 1e-3);
        assert!((shape.extent_m[0] - 58e-3).abs() < 1e-12 && shape.extent_m[2] == 0.0);
        for part in [shape.curvature, shape.side_edges, shape.end_edges] {
            assert!(part.course_per_m.abs() < 1e-9 && part.wale_per_m.abs() < 1e-9);
        }
    }

    #[test]
    fn a_roll_has_the_curvature_of_its_cylinder_and_the_sign_of_its_side() {
        for (radius, sign) in [(0.02, 1.0), (0.05, -1.0)] {
            let (network, frame) = sheet(20, 20, |row, column| {
                let angle = 1e-3 * column / radius;
                DVec3::new(radius * angle.sin(), 1e-3 * row, sign * radius * (1.0 - angle.cos()))
            });
            let shape = Shape::of(&network, &frame);
            for part in [shape.curvature, shape.side_edges, shape.end_edges] {
                assert!((part.course_per_m - sign / radius).abs() < 2e-3 / radius, "{part:?}");
                assert!(part.wale_per_m.abs() < 1e-6);
            }
        }
    }

    #[test]
    fn edges_are_told_apart_from_the_middle() {
        // Sides roll back, ends roll to the front.
        let (network, frame) = sheet(30, 30, |row, column| {
            let bent = |at: f64| (at.abs() - 10.0).max(0.0).powi(2) * 1e-4;
            DVec3::new(1e-3 * column, 1e-3 * row, bent(row) - bent(column))
        });
        let shape = Shape::of(&network, &frame);
        assert!(shape.side_edges.course_per_m < -50.0, "{shape:?}");
        assert!(shape.end_edges.wale_per_m > 50.0, "{shape:?}");
        assert!(shape.end_edges.course_per_m.abs() < 0.5 * shape.side_edges.course_per_m.abs());
        let [course, wale] = Shape::profiles(&network, &frame);
        assert!((course.len(), wale.len()) == (30, 30) && Shape::edge_loops(30) == 5);
        assert!(course[0] < -50.0 && wale[29] > 50.0 && course[15].abs() < 1e-6 && wale[15].abs() < 1e-6);
    }

    #[test]
    fn small_and_empty_fabrics_measure_something_finite() {
        for (rows, columns) in [(0, 0), (1, 1), (1, 5), (2, 2), (3, 3)] {
            let (network, frame) = sheet(rows, columns, |row, column| DVec3::new(column, row, 0.0));
            let shape = Shape::of(&network, &frame);
            assert!(shape.curvature.course_per_m == 0.0 && shape.extent_m.iter().all(|side| side.is_finite()));
        }
    }
}
