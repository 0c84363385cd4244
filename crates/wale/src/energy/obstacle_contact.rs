//! Contact of a node with a rigid obstacle: a penalty on depth, and friction against the surface.

use wale_numerics::check::Local;
use wale_numerics::jet::Real;

use super::element::Element;

/// Contact of one node with the tangent plane of an obstacle's surface near it.
///
/// `V = ½ k p² + Φ(|s|)`, `p = max(0, n·(x₀ − x))`, `s` the part of `x − x̄` along the surface, `Φ` the Coulomb
/// potential of [`super::AnchoredSpring`] with the limit `μN` of the last step.
///
/// Local coordinates: `x` \[m\]. The plane (`x₀`, `n`) is that of the surface point nearest to where the node was
/// expected, moved with the obstacle; it is found anew in every Newton iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObstacleContact {
    /// Stiffness `k` of the penalty \[N/m\].
    pub stiffness: f64,
    /// A point of the plane that the node may not pass, a yarn radius outside the surface \[m\].
    pub point: [f64; 3],
    /// Outward unit normal `n`.
    pub normal: [f64; 3],
    /// Place `x̄` where friction holds the node \[m\].
    pub anchor: [f64; 3],
    /// Stiffness of the friction anchor \[N/m\].
    pub anchor_stiffness: f64,
    /// Largest friction force \[N\].
    pub limit: f64,
}

impl ObstacleContact {
    /// Depth below the plane \[m\], positive inside.
    #[must_use]
    pub fn depth(&self, x: [f64; 3]) -> f64 {
        (0..3).map(|k| self.normal[k] * (self.point[k] - x[k])).sum()
    }
    /// Slip along the surface from the anchor \[m\].
    #[must_use]
    pub fn slip(&self, x: [f64; 3]) -> [f64; 3] {
        let d: [f64; 3] = std::array::from_fn(|k| x[k] - self.anchor[k]);
        let along: f64 = (0..3).map(|k| d[k] * self.normal[k]).sum();
        std::array::from_fn(|k| d[k] - along * self.normal[k])
    }
}

impl Element<3> for ObstacleContact {
    const NAME: &'static str = "obstacles";

    fn energy<T: Real>(&self, q: &[T; 3]) -> T {
        let n = self.normal.map(T::constant);
        let depth = (0..3).fold(T::constant(0.0), |sum, k| sum + n[k] * (T::constant(self.point[k]) - q[k]));
        let mut energy = T::constant(0.0);
        if depth.value() > 0.0 {
            energy = energy + depth.square().scale(0.5 * self.stiffness);
        }
        if self.limit > 0.0 {
            let d: [T; 3] = std::array::from_fn(|k| q[k].offset(-self.anchor[k]));
            let along = d[0] * n[0] + d[1] * n[1] + d[2] * n[2];
            let s2 = d[0].square() + d[1].square() + d[2].square() - along.square();
            let reach = self.limit / self.anchor_stiffness;
            energy = energy
                + if s2.value() <= reach * reach {
                    s2.scale(0.5 * self.anchor_stiffness)
                } else {
                    s2.sqrt().scale(self.limit).offset(-0.5 * self.limit * reach)
                };
        }
        energy
    }

    fn convex(&self, q: &[f64; 3]) -> Local<3> {
        let mut local = Local::zero();
        let depth = self.depth(*q);
        if depth > 0.0 {
            local.energy = 0.5 * self.stiffness * depth * depth;
            local.gradient = self.normal.map(|n| -self.stiffness * depth * n);
            local.add_square(self.stiffness, &self.normal);
        }
        if self.limit > 0.0 {
            let s = self.slip(*q);
            let size = (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]).sqrt();
            let reach = self.limit / self.anchor_stiffness;
            let (energy, secant) = if size <= reach {
                (0.5 * self.anchor_stiffness * size * size, self.anchor_stiffness)
            } else {
                (self.limit * (size - 0.5 * reach), self.limit / size)
            };
            local.energy += energy;
            for i in 0..3 {
                local.gradient[i] += secant * s[i];
                for j in 0..3 {
                    let eye = f64::from(u8::from(i == j));
                    local.hessian[i][j] += secant * (eye - self.normal[i] * self.normal[j]);
                }
            }
        }
        local
    }
}

#[cfg(test)]
mod tests {
    use super::super::element::testing::check;
    use super::*;

    fn contact(limit: f64) -> ObstacleContact {
        ObstacleContact {
            stiffness: 3.0,
            point: [0.0, 0.0, 1.0],
            normal: [0.0, 0.6, 0.8],
            anchor: [0.1, 0.0, 0.9],
            anchor_stiffness: 5.0,
            limit,
        }
    }

    #[test]
    fn derivatives() {
        for limit in [0.0, 0.2, 9.0] {
            check(&contact(limit), &[0.3, 0.2, 0.6], 0.1);
        }
        check(&contact(0.3), &[0.5, 0.2, 1.6], 0.1);
    }

    #[test]
    fn pushes_out_and_rubs_no_harder_than_the_limit() {
        let local = contact(0.2).convex(&[1.0, 0.0, 0.5]);
        let normal_force: f64 = (0..3).map(|k| -local.gradient[k] * [0.0, 0.6, 0.8][k]).sum();
        assert!((normal_force - 3.0 * 0.4).abs() < 1e-12);
        let along: f64 = (0..3).map(|k| (-local.gradient[k] - normal_force * [0.0, 0.6, 0.8][k]).powi(2)).sum();
        assert!((along.sqrt() - 0.2).abs() < 1e-12);
    }
}
