//! Frames carried along a curve without turning about it (the double reflection of Wang et al. 2008).

use glam::DVec3;

/// At each point of a curve, a unit tangent and a unit normal; the normals turn about the curve as little as can be.
///
/// Coincident points take the tangent of the ones before them. Finite points give finite frames.
pub(crate) fn transported_frames(points: &[DVec3]) -> Vec<(DVec3, DVec3)> {
    let tangents = tangents(points);
    let Some(first) = tangents.first() else {
        return Vec::new();
    };
    let mut normal = first.any_orthonormal_vector();
    let mut frames = vec![(*first, normal)];
    for i in 1..points.len() {
        let reflect = |v: DVec3, mirror: DVec3| {
            let length_squared = mirror.length_squared();
            if length_squared > 0.0 { v - mirror * (2.0 * v.dot(mirror) / length_squared) } else { v }
        };
        let step = (points[i] - points[i - 1]).normalize_or_zero();
        let tangent = reflect(tangents[i - 1], step);
        let carried = reflect(reflect(normal, step), tangents[i] - tangent);
        // Against the drift of rounding.
        normal = (carried - tangents[i] * carried.dot(tangents[i])).normalize_or(tangents[i].any_orthonormal_vector());
        frames.push((tangents[i], normal));
    }
    frames
}

/// Unit tangents by differences of the neighbouring points.
fn tangents(points: &[DVec3]) -> Vec<DVec3> {
    let n = points.len();
    let mut last =
        points.windows(2).map(|w| (w[1] - w[0]).normalize_or_zero()).find(|d| *d != DVec3::ZERO).unwrap_or(DVec3::X);
    (0..n)
        .map(|i| {
            let difference = points[(i + 1).min(n - 1)] - points[i.saturating_sub(1)];
            last = difference.normalize_or(last);
            last
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_orthonormal_and_turn_little() {
        let points: Vec<DVec3> = (0..200)
            .map(|i| {
                let t = f64::from(i) * 0.05;
                DVec3::new(t.cos(), t.sin(), 0.2 * t)
            })
            .collect();
        let frames = transported_frames(&points);
        for w in frames.windows(2) {
            assert!(w[1].0.dot(w[1].1).abs() < 1e-12);
            assert!((w[1].1.length() - 1.0).abs() < 1e-12);
            // The normal's change lies along the tangent: no turn about the curve.
            let change = w[1].1 - w[0].1;
            let middle = (w[0].0 + w[1].0).normalize();
            assert!((change - middle * change.dot(middle)).length() < 1e-3 * 0.05);
        }
    }

    #[test]
    fn hairpins_and_coincident_points_are_finite() {
        let points = [0.0, 0.0, 1.0, 1.0, 0.0, 2.0, 2.0].map(|x| DVec3::X * x);
        for (tangent, normal) in transported_frames(&points) {
            assert!((tangent.length() - 1.0).abs() < 1e-12 && (normal.length() - 1.0).abs() < 1e-12);
            assert!(tangent.dot(normal).abs() < 1e-12);
        }
        assert_eq!(transported_frames(&[DVec3::ONE]).len(), 1);
        assert!(transported_frames(&[]).is_empty());
    }
}
