//! Numbers along the yarns to colour them by: stretch, sliding, curvature.

use glam::DVec3;

use super::Curve;
use crate::model::{Frame, Network, YarnId};

/// What a yarn is coloured by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Hash)]
pub enum Quantity {
    /// Length over rest length, less one \[–\].
    #[default]
    Stretch,
    /// How far yarn has slid through its contact since the start \[m\], positive towards the yarn's end.
    Sliding,
    /// Turning angle at a node over the rest length around it \[1/m\].
    Curvature,
}

impl Quantity {
    /// All of them, in the order of legends.
    pub const ALL: [Self; 3] = [Self::Stretch, Self::Sliding, Self::Curvature];

    /// The name users write.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Stretch => "stretch",
            Self::Sliding => "sliding",
            Self::Curvature => "curvature",
        }
    }
    /// Unit in legends, and how many of it are one SI unit.
    #[must_use]
    pub fn legend_unit(self) -> (&'static str, f64) {
        match self {
            Self::Stretch => ("%", 100.0),
            Self::Sliding => ("mm", 1e3),
            Self::Curvature => ("1/mm", 1e-3),
        }
    }
    /// Whether zero is the middle of the scale rather than its lower end.
    #[must_use]
    pub fn is_signed(self) -> bool {
        self != Self::Curvature
    }
}

/// The quantities at each point of each curve, SI units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointScalars {
    /// Stretch \[–\] of the segment a point lies on.
    pub stretch: Vec<Vec<f64>>,
    /// Sliding \[m\].
    pub sliding: Vec<Vec<f64>>,
    /// Curvature \[1/m\].
    pub curvature: Vec<Vec<f64>>,
}

impl PointScalars {
    /// The values of one quantity.
    #[must_use]
    pub fn of(&self, quantity: Quantity) -> &[Vec<f64>] {
        match quantity {
            Quantity::Stretch => &self.stretch,
            Quantity::Sliding => &self.sliding,
            Quantity::Curvature => &self.curvature,
        }
    }
}

/// The quantities at the points of `curves`, which must be curves of this network in this frame.
///
/// Stretch is constant along a segment; sliding and curvature are known at passes and run straight in between.
/// A point whose pass is not in the network gets zeros.
#[must_use]
pub fn point_scalars(network: &Network, frame: &Frame, curves: &[Curve]) -> PointScalars {
    let passes = network.pass_count();
    let (mut stretch, mut curvature) = (vec![0.0; passes], vec![0.0; passes]);
    let mut next = vec![0; passes];
    for yarn in 0..network.yarn_count() {
        let range = network.yarn_passes(YarnId::new(yarn));
        let place = |p: usize| {
            let image = network.pass_image.get(p).copied().unwrap_or_default();
            let shift = network
                .periods
                .map_or(DVec3::ZERO, |[course, wale]| f64::from(image[0]) * course + f64::from(image[1]) * wale);
            frame.positions[network.pass_node[p].index()] + shift
        };
        for p in range.clone() {
            next[p] = (p + 1).min(range.end - 1);
            if p + 1 < range.end {
                let rest = frame.sliding[p + 1] - frame.sliding[p];
                stretch[p] = (place(p + 1) - place(p)).length() / rest - 1.0;
            } else if p > range.start {
                stretch[p] = stretch[p - 1];
            }
            if p > range.start && p + 1 < range.end {
                let (a, b) = (place(p) - place(p - 1), place(p + 1) - place(p));
                let around = 0.5 * (frame.sliding[p + 1] - frame.sliding[p - 1]);
                curvature[p] = a.cross(b).length().atan2(a.dot(b)) / around;
            }
        }
    }
    let slid: Vec<f64> = (0..passes).map(|p| frame.sliding[p] - network.arc_length[p]).collect();
    let at_points = |value: &dyn Fn(usize, f64) -> f64| -> Vec<Vec<f64>> {
        curves
            .iter()
            .map(|curve| {
                curve
                    .pass
                    .iter()
                    .zip(&curve.arc_length)
                    .map(|(&pass, &u)| {
                        let p = pass as usize;
                        if p >= passes {
                            return 0.0;
                        }
                        let (u0, u1) = (frame.sliding[p], frame.sliding[next[p]]);
                        let s = if u1 > u0 { ((u - u0) / (u1 - u0)).clamp(0.0, 1.0) } else { 0.0 };
                        value(p, s)
                    })
                    .collect()
            })
            .collect()
    };
    let between = |values: &[f64], p: usize, s: f64| values[p] + s * (values[next[p]] - values[p]);
    PointScalars {
        stretch: at_points(&|p, _| stretch[p]),
        sliding: at_points(&|p, s| between(&slid, p, s)),
        curvature: at_points(&|p, s| between(&curvature, p, s)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{NodeId, PassKind};

    /// A yarn of four passes around the corner of a square of side `side`.
    fn corner(side: f64) -> (Network, Frame, Curve) {
        let position: Vec<DVec3> =
            [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (1.0, 2.0)].map(|(x, y)| side * DVec3::new(x, y, 0.0)).to_vec();
        let network = Network {
            pass_node: (0..4).map(NodeId::new).collect(),
            pass_image: vec![[0; 2]; 4],
            pass_kind: vec![PassKind::Edge; 4],
            arc_length: vec![0.0, 1.0, 2.0, 3.0],
            yarn_start: vec![0, 4],
            yarn_closure: vec![None],
            position: position.clone(),
            ..Network::default()
        };
        let frame = Frame { positions: position.clone(), sliding: vec![0.0, 1.2, 2.0, 3.0], ..Frame::default() };
        let curve = Curve {
            points: vec![position[0], position[1], position[1].lerp(position[2], 0.5), position[3]],
            arc_length: vec![0.0, 1.2, 1.6, 3.0],
            pass: vec![0, 1, 1, 3],
            radius: 0.1,
            ..Curve::default()
        };
        (network, frame, curve)
    }

    #[test]
    fn known_answers_on_a_corner() {
        let (network, frame, curve) = corner(1.5);
        let scalars = point_scalars(&network, &frame, &[curve]);
        let near = |a: &[f64], b: [f64; 4]| {
            for (x, y) in a.iter().zip(b) {
                assert!((x - y).abs() < 1e-12, "{a:?} {b:?}");
            }
        };
        near(&scalars.stretch[0], [1.5 / 1.2 - 1.0, 1.5 / 0.8 - 1.0, 1.5 / 0.8 - 1.0, 0.5]);
        near(&scalars.sliding[0], [0.0, 0.2, 0.1, 0.0]);
        let bend = std::f64::consts::FRAC_PI_2 / 1.0;
        near(&scalars.curvature[0], [0.0, bend, 0.5 * bend, 0.0]);
    }

    #[test]
    fn a_point_of_no_pass_is_zero_not_a_crash() {
        let (network, frame, mut curve) = corner(1.0);
        curve.pass[2] = 999;
        let scalars = point_scalars(&network, &frame, &[curve]);
        assert_eq!(scalars.stretch[0][2], 0.0);
        assert_eq!(scalars.stretch[0].len(), 4);
    }
}
