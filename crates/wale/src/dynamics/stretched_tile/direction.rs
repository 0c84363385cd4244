//! The direction of a stretch, and the deformation of the plane that it is.

use crate::fabric::Matrix2;

/// Unit vector of the plane along which stretch is measured, from the course.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction {
    along: [f64; 2],
}

impl Direction {
    /// At an angle \[rad\] from the course.
    #[must_use]
    pub fn at(angle: f64) -> Self {
        Self { along: [angle.cos(), angle.sin()] }
    }

    /// `∂F/∂s`.
    #[must_use]
    pub fn stretch_rate(&self) -> Matrix2 {
        let [a, b] = self.along;
        [[a * a, a * b], [a * b, b * b]]
    }

    /// `∂F/∂c`.
    #[must_use]
    pub fn compression_rate(&self) -> Matrix2 {
        let [a, b] = self.along;
        [[-b * b, a * b], [a * b, -a * a]]
    }
}
