//! A start that does not snap: yarn is easy to stretch at first.
//!
//! The plain layout of a fabric may stretch its yarn to a multiple of its length, where a decrease draws together loops from columns
//! away. Let go, it would snap within a millisecond, with a force that no contact withstands.

use super::system::System;

/// Share of its stretch stiffness that yarn begins with.
const SOFTEST: f64 = 1e-3;

/// How far a soft start has come at a time after the start of a run, from 0 to 1; both \[s\]. `None` without one.
pub(crate) fn progress(time: f64, soft_start: f64) -> Option<f64> {
    (soft_start > 0.0).then(|| (time / soft_start).min(1.0))
}

/// Share of its stretch stiffness that yarn has by then.
pub(crate) fn stretch_share(progress: Option<f64>) -> f64 {
    progress.map_or(1.0, |progress| SOFTEST.powf(1.0 - progress))
}

impl System {
    /// Gives the yarn a share of its stretch stiffness.
    pub(crate) fn soften(&mut self, share: f64) {
        if share == 1.0 && self.full_stiffness.is_empty() {
            return;
        }
        let thin = self.segments.set.elements.iter_mut().map(|((stretch, _), _)| stretch);
        let thick = self.thick_segments.set.elements.iter_mut().map(|thick| &mut thick.inner);
        let all = thin.chain(thick);
        if self.full_stiffness.is_empty() {
            for stretch in all {
                self.full_stiffness.push(stretch.stiffness);
                stretch.stiffness *= share;
            }
        } else {
            for (stretch, full) in all.zip(&self.full_stiffness) {
                stretch.stiffness = full * share;
            }
        }
        if share == 1.0 {
            self.full_stiffness.clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{progress, stretch_share};

    #[test]
    fn stiffness_grows_evenly_by_factors() {
        let at = |time: f64| stretch_share(progress(time, 0.03));
        assert!((at(0.0) - 1e-3).abs() < 1e-12 && (at(0.02) / at(0.01) - 10.0).abs() < 1e-9);
        assert_eq!([at(0.03), at(1.0), stretch_share(progress(0.0, 0.0))], [1.0; 3]);
    }
}
