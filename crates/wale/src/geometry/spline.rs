//! Smooth curves through points: centripetal Catmull–Rom, which neither overshoots nor loops at short segments.

use glam::DVec3;

/// Tangents for the piece between points `i` and `i + 1`, scaled to that piece's parameter range.
///
/// `before` and `after` are the points outside the piece; at a curve's ends, use [`beyond`].
fn tangents(before: DVec3, start: DVec3, end: DVec3, after: DVec3) -> [DVec3; 2] {
    // Centripetal knots: parameter steps are square roots of distances. The floor keeps coincident points finite:
    // their differences are zero, so its size does not matter.
    let knot = |a: DVec3, b: DVec3| a.distance(b).sqrt().max(1e-12);
    let (k0, k1, k2) = (knot(before, start), knot(start, end), knot(end, after));
    let at_start = (start - before) / k0 - (end - before) / (k0 + k1) + (end - start) / k1;
    let at_end = (end - start) / k1 - (after - start) / (k1 + k2) + (after - end) / k2;
    [at_start * k1, at_end * k1]
}

/// A point past the end of a curve, `end` mirrored in its neighbour: the curve runs out straight.
pub(super) fn beyond(end: DVec3, inner: DVec3) -> DVec3 {
    end * 2.0 - inner
}

/// Points at `0, 1/n, … (n−1)/n` of the piece from `start` to `end`.
pub(super) fn sample(
    before: DVec3,
    start: DVec3,
    end: DVec3,
    after: DVec3,
    samples: usize,
) -> impl Iterator<Item = DVec3> {
    let [m0, m1] = tangents(before, start, end, after);
    (0..samples).map(move |k| {
        let t = k as f64 / samples as f64;
        let (t2, t3) = (t * t, t * t * t);
        start * (2.0 * t3 - 3.0 * t2 + 1.0) + m0 * (t3 - 2.0 * t2 + t) + end * (3.0 * t2 - 2.0 * t3) + m1 * (t3 - t2)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_stays_straight_and_even() {
        let p = |x: f64| DVec3::new(x, 2.0 * x, -x);
        for (k, point) in sample(p(0.0), p(1.0), p(2.0), p(3.0), 4).enumerate() {
            assert!(point.distance(p(1.0 + k as f64 / 4.0)) < 1e-12);
        }
    }

    #[test]
    fn a_short_piece_between_long_ones_does_not_overshoot() {
        // Uniform Catmull–Rom swings far out of this corner; the centripetal one stays within its own length.
        let (a, b) = (DVec3::ZERO, DVec3::new(0.01, 0.01, 0.0));
        for point in sample(DVec3::new(-1.0, 0.0, 0.0), a, b, DVec3::new(0.01, 1.0, 0.0), 16) {
            assert!(point.distance((a + b) / 2.0) < 0.015, "{point}");
        }
    }

    #[test]
    fn coincident_points_stay_finite() {
        let p = DVec3::ONE;
        for point in sample(p, p, p, p, 4).chain(sample(DVec3::ZERO, p, p, DVec3::X, 4)) {
            assert!(point.is_finite() && point.distance(p) < 1e-9, "{point}");
        }
    }
}
