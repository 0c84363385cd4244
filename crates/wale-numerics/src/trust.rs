//! How far Newton's method trusts its second derivatives.
//!
//! Where the exact ones are not positive definite, ones nearer to convex take their place; and a multiple of the identity, the
//! *shift*, is added to them, grows where they do not tell what the energy does, and vanishes where they do.

/// Least convexity that is not none, and the first after none.
const LEAST_CONVEXITY: f64 = 0.02;
const SOME_CONVEXITY: f64 = 0.125;
/// Shares of the foreseen gain above which the second derivatives are believed more, and below which less.
const GOOD: f64 = 0.75;
const POOR: f64 = 0.25;
/// Part of a step that counts as all of it.
const WHOLE: f64 = 0.9;
/// Share of the foreseen gain that is enough to take a step.
const ENOUGH: f64 = 1e-3;

/// How the shift goes, in the caller's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrustRule {
    /// Below this a shift is none.
    pub least: f64,
    /// Least shift after a step that gained too little.
    pub doubted: f64,
    /// Least shift after convex second derivatives that were not positive definite even so.
    pub refused: f64,
    /// Factor by which it grows and by which it falls.
    pub growth: f64,
    /// See `growth`.
    pub fall: f64,
}

/// Shift and convexity as they are now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trust {
    /// Multiple of the identity, in the caller's unit.
    pub shift: f64,
    /// 0 for the exact second derivatives, 1 for convex ones.
    pub convexity: f64,
    rule: TrustRule,
}

impl Trust {
    /// Where to begin.
    #[must_use]
    pub fn new(rule: TrustRule, shift: f64, convexity: f64) -> Self {
        Self { shift, convexity, rule }
    }

    /// The shift to add: none below the least.
    #[must_use]
    pub fn used_shift(&self) -> f64 {
        if self.shift < self.rule.least { 0.0 } else { self.shift }
    }

    /// The second derivatives were not positive definite. Whether they have another convexity now, and must be found again.
    pub fn refuse(&mut self) -> bool {
        if self.convexity < 1.0 {
            self.convexity = (2.0 * self.convexity).clamp(SOME_CONVEXITY, 1.0);
            return true;
        }
        self.shift = (self.rule.growth * self.shift).max(self.rule.refused);
        false
    }

    /// Learns from a step of which a part was gone and that gained a share of what was foreseen. A shift that grows is at
    /// least `along`.
    pub fn judge(&mut self, share: f64, part: f64, along: f64) {
        if share > GOOD && part > WHOLE {
            self.shift *= self.rule.fall;
            self.convexity = if self.convexity > LEAST_CONVEXITY { 0.5 * self.convexity } else { 0.0 };
        } else if share.is_nan() || share < POOR {
            self.shift = (self.rule.growth * self.shift).max(along).max(self.rule.doubted);
        }
    }
}

/// A step as the second derivatives foresee it: its slope `gᵀd` and its curvature `dᵀHd` \[J\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foreseen {
    /// `gᵀd`.
    pub slope: f64,
    /// `dᵀHd`.
    pub curvature: f64,
}

impl Foreseen {
    /// Share of the foreseen gain that a part of the step has gained; one where the energy does not resolve it, within
    /// `resolution` of its size: close to rest Newton's method is trusted.
    #[must_use]
    pub fn share(&self, part: f64, gained: f64, energy: f64, resolution: f64) -> f64 {
        let foreseen = -part * self.slope - 0.5 * part * part * self.curvature;
        if foreseen > resolution * energy.abs() { gained / foreseen } else { 1.0 }
    }
}

/// Whether a share is enough to take the step.
#[must_use]
pub fn is_enough(share: f64) -> bool {
    share > ENOUGH
}

#[cfg(test)]
mod tests {
    use super::*;

    const RULE: TrustRule = TrustRule { least: 1e-4, doubted: 1e-4, refused: 1.0, growth: 4.0, fall: 0.2 };

    #[test]
    fn convexity_comes_before_shift_and_both_go_again() {
        let mut trust = Trust::new(RULE, 0.0, 0.0);
        assert!([0.125, 0.25, 0.5, 1.0].iter().all(|c| trust.refuse() && trust.convexity == *c));
        assert!(!trust.refuse() && trust.used_shift() == 1.0);
        assert!(!trust.refuse() && trust.used_shift() == 4.0);
        for _ in 0..7 {
            trust.judge(0.9, 1.0, 0.0);
        }
        assert_eq!((trust.convexity, trust.used_shift()), (0.0, 0.0));
        // Neither a middling step nor a part of one changes anything; a poor one or none does.
        let before = trust;
        trust.judge(0.5, 1.0, 0.0);
        trust.judge(0.9, 0.5, 0.0);
        assert_eq!(trust, before);
        trust.judge(f64::NAN, 1.0, 0.3);
        assert_eq!(trust.used_shift(), 0.3);
    }

    #[test]
    fn a_parabola_gains_what_it_foresees() {
        // E = 2(x − 1)² from 0 by d = 1: slope −4, curvature 4.
        let step = Foreseen { slope: -4.0, curvature: 4.0 };
        for part in [0.3f64, 1.0] {
            let gained = 2.0 - 2.0 * (part - 1.0).powi(2);
            assert!((step.share(part, gained, 2.0, 1e-12) - 1.0).abs() < 1e-14);
        }
        assert!(!is_enough(step.share(1.0, -0.1, 2.0, 1e-12)) && is_enough(step.share(1.0, -0.1, 1e15, 1e-12)));
    }
}
