//! Yarns as smooth curves: through every node, offset by each pass's place in the node's stack.
//!
//! The simulation knows a node as one point. For drawing, the passes of a stack of `n` lie side by side along the
//! node's normal, front to back, at `((n−1)/2 − k) 2R`, and smooth splines join them [Cirio2017, 3.2].
//!
//! One thing goes beyond the paper. The two yarns of a stitch contact change places between its two nodes, so
//! splines through the offset points alone would meet halfway. They are led around each other instead, by a point
//! halfway with a lateral offset of `±R`: a half turn of the helix that clasped yarns form.

use glam::DVec3;

use super::claspings::claspings;
use super::passes::{Passes, translation};
use super::stack_normal::stack_normals;
use super::{Curve, spline};
use crate::model::{FabricCard, Frame, Network, PassId, YarnId, YarnRole, Yarns};

/// How curves are drawn from a network.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveSettings {
    /// Radius of each of the fabric's yarns by its number \[m\]; at least one.
    pub radii: Vec<f64>,
    /// How far warp and weft go from the back of a woven fabric to its front \[m\]; the sum of their diameters if zero.
    pub crimp_height: [f64; 2],
    /// Straight pieces that a segment is drawn with, at least one. The count does not depend on the frame.
    pub samples_per_segment: usize,
    /// Sideways distance of the yarns at the middle of a stitch contact, as a share of their touching distance.
    /// One leads them around each other like hard round yarns, zero straight through each other.
    pub clasp: f64,
    /// Periods of a periodic tile in this frame \[m\]; the network's initial ones if not given.
    pub periods: Option<[DVec3; 2]>,
}

impl CurveSettings {
    /// Six pieces a segment, yarns of one radius led fully around each other.
    #[must_use]
    pub fn new(radius: f64) -> Self {
        Self { radii: vec![radius], crimp_height: [0.0; 2], samples_per_segment: 6, clasp: 1.0, periods: None }
    }

    /// The same for a fabric of some yarns.
    #[must_use]
    pub fn of(yarns: &Yarns, card: &FabricCard) -> Self {
        let radii = yarns.cards().iter().map(|yarn| yarn.radius).collect();
        let crimp_height = card.woven().map_or([0.0; 2], |card| card.crimp_height);
        Self { radii, crimp_height, ..Self::new(0.0) }
    }

    /// Radius of a yarn of a network \[m\].
    pub(super) fn radius(&self, network: &Network, yarn: YarnId) -> f64 {
        let kind = usize::from(network.yarn_kind[yarn.index()]);
        self.radii.get(kind).or(self.radii.first()).copied().unwrap_or_default()
    }
}

/// The centre lines of all yarns in a frame, one curve per yarn.
///
/// A yarn that closes on a periodic image of itself is drawn for one period; its last point is the first point of
/// the next. Finite positions give finite curves, whatever the segments' lengths.
///
/// # Panics
/// If the frame does not belong to the network (another number of nodes or passes).
#[must_use]
pub fn curves(network: &Network, frame: &Frame, settings: &CurveSettings) -> Vec<Curve> {
    assert_eq!(frame.positions.len(), network.node_count(), "nodes");
    assert_eq!(frame.sliding.len(), network.pass_count(), "passes");
    let rest_periods = network.periods.unwrap_or_default();
    let periods = settings.periods.unwrap_or(rest_periods);
    let passes = Passes::new(network);
    let normals = stack_normals(network, &passes, &frame.positions, periods, rest_periods);
    let out = network.pulled_out_at(&frame.sliding);
    let mut drawing = Drawing {
        network,
        frame,
        settings,
        periods,
        points: offset_points(network, frame, settings, &passes, &normals, periods, &out),
        claspings: claspings(network, frame, settings, &passes, &normals),
        passes,
    };
    drawing.leave_contacts(&out);
    (0..network.yarn_count()).map(|y| drawing.curve(YarnId::new(y))).collect()
}

/// Where each pass is drawn \[m\]: its node, offset along the node's normal by its place in the stack.
fn offset_points(
    network: &Network,
    frame: &Frame,
    settings: &CurveSettings,
    passes: &Passes,
    normals: &[DVec3],
    periods: [DVec3; 2],
    out: &[bool],
) -> Vec<DVec3> {
    let mut points: Vec<DVec3> =
        (0..network.pass_count()).map(|p| passes.place(&frame.positions, periods, p)).collect();
    let yarn_of = network.pass_yarn();
    for (node, normal) in normals.iter().enumerate() {
        let stack = network.stack(crate::model::NodeId::new(node)).iter().copied();
        let live: Vec<PassId> = stack.filter(|pass| !out[pass.index()]).collect();
        for (pass, height) in live.iter().zip(heights(network, &live, &yarn_of, settings)) {
            points[pass.index()] += *normal * height;
        }
    }
    points
}

/// How far in front of the node each pass of its stack lies \[m\]: side by side, about the middle; at the crossings of a
/// weave where the crimp of either yarn puts it.
fn heights<'a>(
    network: &'a Network,
    stack: &'a [PassId],
    yarn_of: &'a [YarnId],
    settings: &'a CurveSettings,
) -> impl Iterator<Item = f64> + 'a {
    let radius = |pass: &PassId| settings.radius(network, yarn_of[pass.index()]);
    let thickness: f64 = stack.iter().map(|pass| 2.0 * radius(pass)).sum();
    let crossing = stack.len() == 2 && settings.crimp_height != [0.0; 2];
    let mut above = 0.0;
    stack.iter().enumerate().map(move |(k, pass)| {
        let middle = match network.yarn_role[yarn_of[pass.index()].index()] {
            YarnRole::Warp if crossing => Some(0.5 * settings.crimp_height[0]),
            YarnRole::Weft if crossing => Some(0.5 * settings.crimp_height[1]),
            _ => None,
        };
        above += 2.0 * radius(pass);
        match middle {
            Some(height) => height * if k == 0 { 1.0 } else { -1.0 },
            None => 0.5 * thickness - above + radius(pass),
        }
    })
}

/// All that a yarn's curve is made from.
struct Drawing<'a> {
    network: &'a Network,
    frame: &'a Frame,
    settings: &'a CurveSettings,
    periods: [DVec3; 2],
    passes: Passes<'a>,
    points: Vec<DVec3>,
    claspings: Vec<Option<DVec3>>,
}

/// A point that a curve goes through.
#[derive(Clone, Copy)]
struct Knot {
    point: DVec3,
    arc_length: f64,
    pass: u32,
    /// Straight pieces that the way to the next knot is drawn with.
    samples: usize,
}

impl Drawing<'_> {
    /// A pass that its yarn has been pulled out of lies where the end of the yarn is, and clasps nothing.
    fn leave_contacts(&mut self, out: &[bool]) {
        for yarn in (0..self.network.yarn_count()).map(YarnId::new) {
            let passes = self.network.yarn_passes(yarn);
            for p in passes.clone().filter(|&p| out[p]) {
                let first = self.frame.sliding[p] == self.frame.sliding[passes.start];
                self.points[p] = self.points[if first { passes.start } else { passes.end - 1 }];
                self.claspings[p] = self.claspings[p].map(|_| DVec3::ZERO);
            }
        }
    }

    fn curve(&self, yarn: YarnId) -> Curve {
        let range = self.network.yarn_passes(yarn);
        let closure = self.network.yarn_closure[yarn.index()];
        let samples = self.settings.samples_per_segment.max(1);
        let mut knots = Vec::with_capacity(2 * range.len() + 1);
        for p in range.clone() {
            let clasp = self.claspings[p];
            let knot = Knot {
                point: self.points[p],
                arc_length: self.frame.sliding[p],
                pass: u32::try_from(p).unwrap_or(u32::MAX),
                samples: clasp.map_or(samples, |_| samples.div_ceil(2)),
            };
            knots.push(knot);
            let Some(next) = self.passes.after(p) else {
                continue;
            };
            let end = Knot {
                point: self.points[next.pass] + translation(self.periods, next.shift),
                arc_length: self.frame.sliding[next.pass]
                    + f64::from(next.turns) * closure.map_or(0.0, |(_, length)| length),
                // Only kept as a closed yarn's last point, which belongs to the last segment.
                ..knot
            };
            if let Some(offset) = clasp {
                knots.push(Knot {
                    point: (knot.point + end.point) / 2.0 + offset,
                    arc_length: (knot.arc_length + end.arc_length) / 2.0,
                    ..knot
                });
            }
            if p + 1 == range.end {
                knots.push(end);
            }
        }
        let period = closure.map(|(image, _)| translation(self.periods, image.map(i32::from)));
        let mut curve = Curve {
            radius: self.settings.radius(self.network, yarn),
            color: self.network.yarn_color[yarn.index()],
            ..Curve::default()
        };
        join(&knots, period, &mut curve);
        curve
    }
}

/// Samples a spline through knots into a curve; the ends run out straight, or on into the next period.
fn join(knots: &[Knot], period: Option<DVec3>, curve: &mut Curve) {
    let Some(last) = knots.last() else {
        return;
    };
    let n = knots.len();
    for i in 0..n - 1 {
        let (start, end) = (&knots[i], &knots[i + 1]);
        let before = match (i, period) {
            (0, Some(period)) => knots[n - 2].point - period,
            (0, None) => spline::beyond(start.point, end.point),
            _ => knots[i - 1].point,
        };
        let after = match (i + 2 == n, period) {
            (true, Some(period)) => knots[1].point + period,
            (true, None) => spline::beyond(end.point, start.point),
            _ => knots[i + 2].point,
        };
        let points = spline::sample(before, start.point, end.point, after, start.samples);
        for (k, point) in points.enumerate() {
            let t = k as f64 / start.samples as f64;
            curve.points.push(point);
            curve.arc_length.push(start.arc_length + (end.arc_length - start.arc_length) * t);
            curve.pass.push(start.pass);
        }
    }
    curve.points.push(last.point);
    curve.arc_length.push(last.arc_length);
    curve.pass.push(last.pass);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sample_fabric::plain_weave;
    use crate::model::{KnitCard, NodeId};
    use crate::pattern::{Chart, Working, knit};
    use glam::{DQuat, EulerRot};

    fn frame_of(network: &Network) -> Frame {
        Frame { time: 0.0, positions: network.position.clone(), sliding: network.arc_length.clone() }
    }

    /// The point of a curve at a pass: the first one that carries it.
    fn at_pass(curves: &[Curve], pass: usize) -> (DVec3, f64) {
        curves
            .iter()
            .find_map(|curve| {
                let i = curve.pass.iter().position(|p| *p as usize == pass)?;
                Some((curve.points[i], curve.arc_length[i]))
            })
            .expect("every pass is drawn")
    }

    #[test]
    fn stacks_are_drawn_front_to_back_one_diameter_apart() {
        let network = plain_weave(5, 4, 2e-3);
        let settings = CurveSettings::new(0.3e-3);
        let curves = curves(&network, &frame_of(&network), &settings);
        assert_eq!(curves.len(), 9);
        for node in 0..20 {
            let stack = network.stack(NodeId::new(node));
            assert_eq!(stack.len(), 2);
            let (front, u) = at_pass(&curves, stack[0].index());
            let (back, _) = at_pass(&curves, stack[1].index());
            assert!(front.distance(network.position[node] + DVec3::Z * 0.3e-3) < 1e-12);
            assert!(back.distance(network.position[node] - DVec3::Z * 0.3e-3) < 1e-12);
            assert_eq!(u, network.arc_length[stack[0].index()]);
        }
        for curve in &curves {
            assert!(curve.arc_length.windows(2).all(|w| w[0] < w[1]));
            assert!(curve.pass.windows(2).all(|w| w[0] <= w[1]));
        }
    }

    #[test]
    fn drawing_moves_with_the_fabric() {
        let network = plain_weave(4, 4, 2e-3);
        let settings = CurveSettings::new(0.3e-3);
        let mut frame = frame_of(&network);
        for (i, x) in frame.positions.iter_mut().enumerate() {
            // A fixed irregular crumple.
            *x += DVec3::new((i as f64 * 1.7).sin(), (i as f64 * 2.3).cos(), (i as f64).sin()) * 0.4e-3;
        }
        let still = curves(&network, &frame, &settings);
        let turn = DQuat::from_euler(EulerRot::XYZ, 2.5, -0.7, 4.0);
        let shift = DVec3::new(0.1, 0.2, -0.3);
        for x in &mut frame.positions {
            *x = turn * *x + shift;
        }
        let moved = curves(&network, &frame, &settings);
        for (a, b) in still.iter().zip(&moved) {
            for (x, y) in a.points.iter().zip(&b.points) {
                assert!((turn * *x + shift).distance(*y) < 1e-12);
            }
        }
    }

    #[test]
    fn collapsed_fabrics_are_finite() {
        let network = plain_weave(3, 3, 2e-3);
        let mut frame = frame_of(&network);
        frame.positions.fill(DVec3::ONE);
        frame.sliding.fill(0.0);
        for curve in curves(&network, &frame, &CurveSettings::new(0.3e-3)) {
            assert!(curve.points.iter().all(|p| p.is_finite()));
        }
    }

    #[test]
    fn a_closed_yarn_meets_its_next_period_smoothly() {
        let mut network = plain_weave(2, 1, 1e-3);
        // Keep the weft alone, without its free ends, and close it on its neighbour along the course.
        network.pass_node = vec![NodeId(0), NodeId(1)];
        network.pass_image = vec![[0, 0]; 2];
        network.arc_length = vec![0.0, 1e-3];
        network.yarn_start = vec![0, 2];
        network.yarn_closure = vec![Some(([1, 0], 2.5e-3))];
        network.yarn_color.truncate(1);
        network.yarn_kind.truncate(1);
        network.yarn_role.truncate(1);
        network.position = vec![DVec3::ZERO, DVec3::new(1e-3, 0.5e-3, 0.0)];
        network.front.truncate(2);
        network.set_stacks(&[vec![crate::model::PassId(0)], vec![crate::model::PassId(1)]]);
        let periods = [DVec3::X * 2e-3, DVec3::Y * 2e-3];
        let settings = CurveSettings { periods: Some(periods), ..CurveSettings::new(0.2e-3) };
        let curve = &curves(&network, &frame_of(&network), &settings)[0];
        let n = curve.points.len();
        assert!(curve.points[n - 1].distance(curve.points[0] + periods[0]) < 1e-15);
        assert!((curve.arc_length[n - 1] - 2.5e-3).abs() < 1e-15);
        // The two neighbours of the seam are mirror images here: the curve has its crest on the seam.
        let (left, right) = (curve.points[n - 2] - periods[0], curve.points[1]);
        assert!((left.x + right.x).abs() < 1e-12 && (left.y - right.y).abs() < 1e-12);
    }

    /// Smallest distance of the two yarns within a stitch contact, over all contacts, in yarn diameters.
    fn clearance(network: &Network, radius: f64, clasp: f64) -> f64 {
        let settings = CurveSettings { clasp, samples_per_segment: 16, ..CurveSettings::new(radius) };
        let curves = curves(network, &frame_of(network), &settings);
        let passes = Passes::new(network);
        let piece = |[a, b]: [crate::model::PassId; 2]| -> Vec<DVec3> {
            let first = passes.earlier(a, b).expect("a contact's passes are neighbours");
            curves
                .iter()
                .flat_map(|c| c.points.iter().zip(&c.pass))
                .filter(|(_, p)| **p as usize == first)
                .map(|(x, _)| *x)
                .collect()
        };
        let mut least = f64::INFINITY;
        for stitch in &network.stitches {
            let (a, b) = (piece(stitch.passes[0]), piece(stitch.passes[1]));
            assert!(a.len() >= 16 && b.len() >= 16);
            for (x, y) in a.iter().flat_map(|x| b.iter().map(move |y| (x, y))) {
                least = least.min(x.distance(*y) / (2.0 * radius));
            }
        }
        least
    }

    #[test]
    fn clasped_yarns_go_around_each_other_and_not_through() {
        let card = KnitCard {
            loop_length: 10e-3,
            path_ratio: 1.0,
            transition_length: 0.1,
            stitch_length: 1.07e-3,
            wale_spacing: 3.2e-3,
            course_spacing: 2.4e-3,
            wrapping_stiffness: 0.0,
            wrapping_angle_course: 0.0,
            wrapping_angle_leg: 0.0,
            bend_angle_foot_head: 0.0,
            bend_angle_leg: 0.0,
            length_stiffness: 0.0,
            spacing_stiffness: 0.0,
            spacing_leg: 0.0,
            spacing_head_sinker: 0.0,
            thickness: None,
            anchor_stiffness: 0.0,
            residual_compression: 0.0,
        };
        // Knits and purls, left and right: all four signs of wrapping.
        let chart = Chart::rib(1, 1).expect("a rib").repeat(2, 3).expect("it is small");
        let network = knit::fabric(&chart, Working::default(), &card);
        let (led, straight) = (clearance(&network, 0.3e-3, 1.0), clearance(&network, 0.3e-3, 0.0));
        assert!(led > 0.75, "{led}");
        assert!(straight < 0.5, "{straight}");
        let wrong_way = clearance(&network, 0.3e-3, -1.0);
        assert!(wrong_way < led, "{wrong_way} {led}");
    }
}
