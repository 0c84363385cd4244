//! The coarse deformation of a tile: an even stretch of the plane, and the cylinder that the plane is rolled onto.

/// A uniform deformation `q = (s, c, κ, U)` of a fabric [Sperl2022, section 7.1]: stretch `s` along a direction of the plane,
/// compression `c` across it, and curvature `κ` along it; or any other even deformation of the plane.
///
/// A point `X` of the tile goes to `y = F X + ũ`, an image of it `k` periods away to `F (X + kP) + ũ`, and from there onto a
/// cylinder: `x_d = (1/κ − h) sin κt`, `x_n = 1/κ − (1/κ − h) cos κt`, with `t` along the direction and `h` the height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoarseDeformation {
    /// Deformation gradient `F` of the plane by rows \[–\]; without rotation, since what keeps yarns from sliding is measured in the
    /// directions of the tile.
    pub plane: [[f64; 2]; 2],
    /// Unit vector along which `s` and `κ` are measured.
    pub direction: [f64; 2],
    /// Curvature `κ` \[1/m\]; positive bends the fabric towards its upper side.
    pub curvature: f64,
}

impl CoarseDeformation {
    /// None.
    pub const REST: Self = Self { plane: [[1.0, 0.0], [0.0, 1.0]], direction: [1.0, 0.0], curvature: 0.0 };

    /// Stretch `s` along a direction at an angle \[rad\] from the first period, and compression `c` across it:
    /// `F = U diag(1 + s, 1 − c) Uᵀ`.
    #[must_use]
    pub fn stretched(angle: f64, stretch: f64, compression: f64) -> Self {
        let direction = [angle.cos(), angle.sin()];
        let mut deformation = Self { direction, ..Self::REST };
        deformation.add(&deformation.stretch_rate(), stretch);
        deformation.add(&deformation.compression_rate(), compression);
        deformation
    }

    /// Any even deformation of the plane by its gradient `F`, whose rotation `R` is taken out: `F = R U`, and a tile is given `U`.
    /// Stretch is measured along a direction at an angle \[rad\]. Returns `R` beside it.
    ///
    /// # Panics
    /// If `F` turns the plane inside out.
    #[must_use]
    pub fn of_gradient(gradient: [[f64; 2]; 2], angle: f64) -> (Self, [[f64; 2]; 2]) {
        let [[a, b], [c, d]] = gradient;
        assert!(a * d - b * c > 0.0, "a deformation turns the plane inside out");
        // Of two by two numbers, R turns by the angle whose tangent is (F21 − F12)/(F11 + F22).
        let size = (a + d).hypot(c - b);
        let (cos, sin) = ((a + d) / size, (c - b) / size);
        let across = 0.5 * (cos * b + sin * d - sin * a + cos * c);
        let plane = [[cos * a + sin * c, across], [across, cos * d - sin * b]];
        (Self { plane, direction: [angle.cos(), angle.sin()], curvature: 0.0 }, [[cos, -sin], [sin, cos]])
    }

    /// The same, bent with a curvature \[1/m\] along its direction.
    #[must_use]
    pub fn bent(self, curvature: f64) -> Self {
        Self { curvature, ..self }
    }

    /// `∂F/∂s`.
    #[must_use]
    pub fn stretch_rate(&self) -> [[f64; 2]; 2] {
        let [a, b] = self.direction;
        [[a * a, a * b], [a * b, b * b]]
    }

    /// `∂F/∂c`.
    #[must_use]
    pub fn compression_rate(&self) -> [[f64; 2]; 2] {
        let [a, b] = self.direction;
        [[-b * b, a * b], [a * b, -a * a]]
    }

    /// Stretch `s` along the direction \[–\].
    #[must_use]
    pub fn stretch(&self) -> f64 {
        let [a, b] = self.direction;
        quadratic(&self.plane, [a, b]) - 1.0
    }

    /// Compression `c` across the direction \[–\].
    #[must_use]
    pub fn compression(&self) -> f64 {
        let [a, b] = self.direction;
        1.0 - quadratic(&self.plane, [-b, a])
    }

    /// Adds a multiple of a matrix to the deformation gradient.
    pub(super) fn add(&mut self, rate: &[[f64; 2]; 2], factor: f64) {
        for i in 0..2 {
            for j in 0..2 {
                self.plane[i][j] += factor * rate[i][j];
            }
        }
    }

    /// Area after over area before \[–\].
    #[must_use]
    pub fn determinant(&self) -> f64 {
        self.plane[0][0] * self.plane[1][1] - self.plane[0][1] * self.plane[1][0]
    }

    /// From the stretched plane onto the cylinder.
    pub(super) fn onto_cylinder(&self, y: [f64; 3]) -> [f64; 3] {
        if self.curvature == 0.0 {
            return y;
        }
        let ([a, b], k) = (self.direction, self.curvature);
        let (t, across) = (a * y[0] + b * y[1], a * y[1] - b * y[0]);
        let (sin, cos) = (k * t).sin_cos();
        // sin κt/κ and (1 − cos κt)/κ without loss for small curvatures.
        let (along, up) = ((1.0 - k * y[2]) * sin / k, y[2] * cos + 2.0 * (0.5 * k * t).sin().powi(2) / k);
        [a * along - b * across, b * along + a * across, up]
    }

    /// Derivatives `∂x/∂y` by rows of [`Self::onto_cylinder`].
    pub(super) fn jacobian(&self, y: [f64; 3]) -> [[f64; 3]; 3] {
        let ([a, b], k) = (self.direction, self.curvature);
        let (sin, cos) = (k * (a * y[0] + b * y[1])).sin_cos();
        let stretch = 1.0 - k * y[2];
        let by = |t: f64, across: f64, h: f64| {
            let along = stretch * cos * t - sin * h;
            [a * along - b * across, b * along + a * across, stretch * sin * t + cos * h]
        };
        let columns = [by(a, -b, 0.0), by(b, a, 0.0), by(0.0, 0.0, 1.0)];
        std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]))
    }

    /// `g · ∂²x/∂y²`, symmetric.
    pub(super) fn second(&self, y: [f64; 3], g: [f64; 3]) -> [[f64; 3]; 3] {
        let ([a, b], k) = (self.direction, self.curvature);
        let (sin, cos) = (k * (a * y[0] + b * y[1])).sin_cos();
        let stretch = 1.0 - k * y[2];
        let (along, up) = (a * g[0] + b * g[1], g[2]);
        let twice = k * stretch * (up * cos - along * sin);
        let mixed = -k * (along * cos + up * sin);
        let d = [a, b];
        std::array::from_fn(|i| {
            std::array::from_fn(|j| match (i < 2, j < 2) {
                (true, true) => twice * d[i] * d[j],
                (true, false) => mixed * d[i],
                (false, true) => mixed * d[j],
                (false, false) => 0.0,
            })
        })
    }
}

/// `M v` of a vector in the plane.
pub(super) fn times(m: &[[f64; 2]; 2], v: [f64; 2]) -> [f64; 2] {
    [m[0][0] * v[0] + m[0][1] * v[1], m[1][0] * v[0] + m[1][1] * v[1]]
}

fn quadratic(m: &[[f64; 2]; 2], v: [f64; 2]) -> f64 {
    let w = times(m, v);
    w[0] * v[0] + w[1] * v[1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretch_and_compression_are_what_was_asked_for() {
        for angle in [0.0, 0.4, 1.5] {
            let deformation = CoarseDeformation::stretched(angle, 0.3, 0.2);
            assert!((deformation.stretch() - 0.3).abs() < 1e-14 && (deformation.compression() - 0.2).abs() < 1e-14);
            assert!((deformation.determinant() - 1.3 * 0.8).abs() < 1e-14);
            assert!((deformation.plane[0][1] - deformation.plane[1][0]).abs() < 1e-15);
        }
    }

    #[test]
    fn a_gradient_is_a_stretch_that_is_turned() {
        for f in [[[1.2, 0.4], [-0.1, 0.8]], [[1.0, 0.0], [0.0, 1.0]], [[-0.3, -1.1], [0.9, 0.2]]] {
            let (deformation, r) = CoarseDeformation::of_gradient(f, 0.3);
            let u = deformation.plane;
            assert!((r[0][0] * r[1][1] - r[0][1] * r[1][0] - 1.0).abs() < 1e-14);
            assert!((u[0][1] - u[1][0]).abs() < 1e-15 && u[0][0] + u[1][1] > 0.0);
            for i in 0..2 {
                for j in 0..2 {
                    assert!((r[i][0] * u[0][j] + r[i][1] * u[1][j] - f[i][j]).abs() < 1e-14, "{f:?}");
                }
            }
        }
    }

    #[test]
    fn a_bent_plane_lies_on_a_cylinder_and_keeps_its_lengths() {
        let deformation = CoarseDeformation::stretched(0.6, 0.0, 0.0).bent(2.0);
        let [a, b] = deformation.direction;
        // All points of the plane are half a metre from the axis at height ½.
        for (t, w) in [(0.3, -0.2), (-0.7, 0.4), (0.0, 1.0)] {
            let x = deformation.onto_cylinder([a * t - b * w, b * t + a * w, 0.0]);
            let along = a * x[0] + b * x[1];
            assert!((along.hypot(x[2] - 0.5) - 0.5).abs() < 1e-14);
            assert!((a * x[1] - b * x[0] - w).abs() < 1e-14);
            let turned = (along / 0.5).atan2(1.0 - x[2] / 0.5);
            assert!((turned - 2.0 * t).abs() < 1e-14, "an arc as long as the plane was");
        }
        // Little curvature is nearly none.
        let (y, flat) = ([0.3, -0.2, 0.05], CoarseDeformation::REST.bent(1e-9));
        assert!(flat.onto_cylinder(y).iter().zip(y).all(|(x, y)| (x - y).abs() < 1e-9));
    }

    #[test]
    fn derivatives_of_the_cylinder() {
        let deformation = CoarseDeformation::stretched(0.6, 0.1, 0.2).bent(1.7);
        let (y, g, h) = ([0.4, -0.3, 0.1], [0.3, -1.0, 0.7], 1e-5);
        let (jacobian, second) = (deformation.jacobian(y), deformation.second(y, g));
        for j in 0..3 {
            let moved = |s: f64| std::array::from_fn(|k| y[k] + if k == j { s * h } else { 0.0 });
            let (high, low) = (deformation.onto_cylinder(moved(1.0)), deformation.onto_cylinder(moved(-1.0)));
            let (steep, flat) = (deformation.jacobian(moved(1.0)), deformation.jacobian(moved(-1.0)));
            for i in 0..3 {
                assert!(((high[i] - low[i]) / (2.0 * h) - jacobian[i][j]).abs() < 1e-9);
                let slope = (0..3).map(|k| g[k] * (steep[k][i] - flat[k][i])).sum::<f64>() / (2.0 * h);
                assert!((slope - second[i][j]).abs() < 1e-8, "{i} {j}: {slope} {}", second[i][j]);
            }
        }
    }
}
