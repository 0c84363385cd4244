//! The distance of two segments.

use wale_numerics::jet::vector3::{dot, sub};

/// Least distance between the segments from `a` to `b` and from `c` to `d`.
pub fn segment_distance([a, b]: [[f64; 3]; 2], [c, d]: [[f64; 3]; 2]) -> f64 {
    let (u, v, w) = (sub(b, a), sub(d, c), sub(a, c));
    let (uu, vv, uv, uw, vw) = (dot(u, u), dot(v, v), dot(u, v), dot(u, w), dot(v, w));
    let below = uu * vv - uv * uv;
    let part = |above: f64, below: f64| if below > 0.0 { (above / below).clamp(0.0, 1.0) } else { 0.0 };
    let mut s = if below > 1e-12 * uu * vv { part(uv * vw - vv * uw, below) } else { 0.0 };
    let t = part(uv * s + vw, vv);
    s = part(uv * t - uw, uu);
    // The nearest point to a clamped one may move the other: twice is enough for segments.
    let t = part(uv * s + vw, vv);
    let apart: [f64; 3] = std::array::from_fn(|i| w[i] + s * u[i] - t * v[i]);
    dot(apart, apart).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_a_search() {
        let mut random = 7u64;
        let mut next = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        for _ in 0..200 {
            let points: [[f64; 3]; 4] = std::array::from_fn(|_| std::array::from_fn(|_| next()));
            let [a, b, c, d] = points;
            let mut least = f64::INFINITY;
            for i in 0..=200 {
                let s = f64::from(i) / 200.0;
                let p: [f64; 3] = std::array::from_fn(|k| a[k] + s * (b[k] - a[k]));
                // The other parameter in closed form.
                let (v, w) = (sub(d, c), sub(p, c));
                let t = (dot(v, w) / dot(v, v)).clamp(0.0, 1.0);
                let apart: [f64; 3] = std::array::from_fn(|k| w[k] - t * v[k]);
                least = least.min(dot(apart, apart).sqrt());
            }
            let found = segment_distance([a, b], [c, d]);
            assert!(found <= least + 1e-12 && found > least - 0.02, "{found} {least}");
        }
    }

    #[test]
    fn parallel_and_touching_segments() {
        let a = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
        assert_eq!(segment_distance(a, [[0.5, 0.3, 0.0], [1.5, 0.3, 0.0]]), 0.3);
        assert_eq!(segment_distance(a, [[2.0, 0.0, 0.0], [3.0, 0.0, 0.0]]), 1.0);
        assert_eq!(segment_distance(a, [[0.5, -0.5, 0.0], [0.5, 0.5, 0.0]]), 0.0);
    }
}
