//! The angle between two segments, and what derivatives of energies of it are made of.

use wale_numerics::jet::vector3::{add, cross, dot, scale, sub};

/// Largest `tan(θ/2)`: a yarn folded in two exactly, as a straight strand is whose nodes pass each other, would bend out of
/// its plane with infinite curvature.
const STEEPEST: f64 = 1e4;

/// The turning angle of two segments and what its derivatives are made of.
///
/// With `μ`, `τ` and `β` how far the end of a segment moves along its normal in the plane of the bend, along itself and
/// out of the plane, in lengths of the segment, `θ` changes by
/// `μ₂ − μ₁ + τ₁μ₁ − τ₂μ₂ + ¼ cot(θ/2) (β₁ − β₂)² − ¼ tan(θ/2) (β₁ + β₂)²` to second order.
pub(super) struct Angle {
    pub theta: f64,
    /// `tan(θ/2)`.
    pub half_tangent: f64,
    /// By `x₀`, `x₁`, `x₂`.
    pub gradient: [[f64; 3]; 3],
    /// Unit vectors along the segments.
    tangent: [[f64; 3]; 2],
    /// Unit vector normal to both segments (any, where they are parallel).
    binormal: [f64; 3],
    /// Unit vectors in the plane of the bend, normal to each segment.
    in_plane: [[f64; 3]; 2],
    length: [f64; 2],
}

impl Angle {
    /// From the first point over the second to the third.
    pub fn new(x: [[f64; 3]; 3]) -> Self {
        let (d1, d2) = (sub(x[1], x[0]), sub(x[2], x[1]));
        let length = [dot(d1, d1).sqrt(), dot(d2, d2).sqrt()];
        let (t1, t2) = (scale(d1, 1.0 / length[0]), scale(d2, 1.0 / length[1]));
        let (difference, sum) = (sub(t2, t1), add(t1, t2));
        let (opening, closing) = (dot(difference, difference).sqrt(), dot(sum, sum).sqrt());
        let normal = cross(t1, t2);
        let sine = dot(normal, normal).sqrt();
        let binormal = if sine < 1e-12 {
            // Straight: θ has no direction, but every energy here is even in it, so no gradient is lost.
            let axis = if t1[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
            let b = cross(t1, axis);
            scale(b, 1.0 / dot(b, b).sqrt())
        } else {
            scale(normal, 1.0 / sine)
        };
        // In-plane unit vectors: turning t₂ along m₂, or t₁ against m₁, increases θ.
        let (m1, m2) = (cross(binormal, t1), cross(binormal, t2));
        let (a, b) = (scale(m1, 1.0 / length[0]), scale(m2, 1.0 / length[1]));
        Self {
            theta: 2.0 * opening.atan2(closing),
            half_tangent: (opening / closing).min(STEEPEST),
            gradient: [a, sub(scale(a, -1.0), b), b],
            tangent: [t1, t2],
            binormal,
            in_plane: [m1, m2],
            length,
        }
    }

    /// `θ cot(θ/2)`, finite at the straight yarn.
    pub fn over_half_tangent(&self) -> f64 {
        if self.half_tangent > 1e-4 { self.theta / self.half_tangent } else { 2.0 - self.theta * self.theta / 6.0 }
    }

    /// Adds the second derivatives of an energy of the angle to rows and columns that begin, for each point, there.
    pub fn add_hessian<const N: usize>(&self, second: &Turning, [a, b, c]: [usize; 3], hessian: &mut [[f64; N]; N]) {
        let [l1, l2] = self.length.map(|length| 1.0 / length);
        let ([t1, t2], [m1, m2], n) = (self.tangent, self.in_plane, self.binormal);
        for i in 0..3 {
            for j in 0..3 {
                // By d₁ = x₁ − x₀ and d₂ = x₂ − x₁.
                let across = n[i] * n[j];
                let out = (second.opposite + second.together) * across;
                let h11 =
                    l1 * l1 * (second.in_plane * m1[i] * m1[j] + second.tilt * (t1[i] * m1[j] + m1[i] * t1[j]) + out);
                let h22 =
                    l2 * l2 * (second.in_plane * m2[i] * m2[j] - second.tilt * (t2[i] * m2[j] + m2[i] * t2[j]) + out);
                let turn = (second.together - second.opposite) * across;
                let h12 = l1 * l2 * (turn - second.by_angle * m1[i] * m2[j]);
                let h21 = l1 * l2 * (turn - second.by_angle * m2[i] * m1[j]);
                hessian[a + i][a + j] += h11;
                hessian[a + i][b + j] += h12 - h11;
                hessian[a + i][c + j] -= h12;
                hessian[b + i][a + j] += h21 - h11;
                hessian[b + i][b + j] += h11 + h22 - h12 - h21;
                hessian[b + i][c + j] += h12 - h22;
                hessian[c + i][a + j] -= h21;
                hessian[c + i][b + j] += h21 - h22;
                hessian[c + i][c + j] += h22;
            }
        }
    }
}

/// Second derivatives of an energy `E(θ)` along the motions that change `θ`.
pub(super) struct Turning {
    /// By the angle: `E″`.
    pub by_angle: f64,
    /// The same where one segment turns alone.
    pub in_plane: f64,
    /// Of turning and lengthening together: `E′`.
    pub tilt: f64,
    /// Of turning the segments out of the plane against each other: `½ E′ cot(θ/2)`.
    pub opposite: f64,
    /// Of turning them out of the plane together: `−½ E′ tan(θ/2)`.
    pub together: f64,
}

impl Turning {
    /// Second derivatives from `E′`, `E″` and `E′ cot(θ/2)`, between the exact ones (`convexity = 0`) and ones of a
    /// positive semi-definite Hessian (`convexity = 1`): what turns the bend out of its plane, and what tilts a segment while
    /// it changes length, changes `θ` to second order with either sign; the convex Hessian takes the size.
    pub fn new(angle: &Angle, first: f64, second: f64, over_half_tangent: f64, convexity: f64) -> Self {
        let blend = |curvature: f64| curvature + convexity * (curvature.abs() - curvature);
        Self {
            by_angle: second,
            in_plane: second + convexity * first.abs(),
            tilt: (1.0 - convexity) * first,
            opposite: blend(0.5 * over_half_tangent),
            together: blend(-0.5 * first * angle.half_tangent),
        }
    }
}
