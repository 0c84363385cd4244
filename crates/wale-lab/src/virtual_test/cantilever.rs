//! The cantilever test of ASTM D1388, option A, with the shape in which the strip hangs.

use crate::shell::cantilever::{Cantilever, CantileverReport};
use crate::shell::{ShellCard, ShellError};

/// A strip that is pushed over an edge: [`Cantilever`] says all of it.
pub type CantileverTest = Cantilever;

/// What the test reports.
#[derive(Clone, Debug, PartialEq)]
pub struct CantileverResult {
    /// Overhang, bending length `c`, rigidity `G = W c³`.
    pub report: CantileverReport,
    /// How the strip hangs, along and up from the edge \[m\].
    pub profile: Vec<[f64; 2]>,
}

/// Pushes a strip over the edge until its end is low enough.
///
/// # Errors
/// As [`Cantilever::run`].
pub fn run(test: &CantileverTest, card: &ShellCard) -> Result<CantileverResult, ShellError> {
    let report = test.run(card)?;
    Ok(CantileverResult { report, profile: test.profile(card, report.overhang)? })
}

#[cfg(test)]
mod tests {
    use super::*;
    use wale::energy::{BendingStiffness, MembraneStiffness};

    #[test]
    fn the_strip_hangs_to_the_line_that_the_instrument_has() {
        let membrane =
            MembraneStiffness { xx: 400.0, xy: 20.0, yy: 400.0, ss: 80.0, n1: 2.0, n2: 4.0, ..MembraneStiffness::NONE };
        let card = ShellCard { membrane, bending: BendingStiffness::isotropic(3e-6), areal_mass: 0.2 };
        let test = CantileverTest { rows: 24, ..CantileverTest::default() };
        let found = run(&test, &card).unwrap();
        let [x, z] = found.profile[found.profile.len() - 1];
        assert!(((-z).atan2(x).to_degrees() - 41.5).abs() < 1e-2);
        // W L³/B is known there (`shell::cantilever` has the elastica); a quarter of a per cent for twelve rows fewer.
        assert_eq!(found.report.bending_length, 0.5 * found.report.overhang);
        let length: f64 = found.profile.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])).sum();
        // Half of the first row lies behind the edge.
        assert!((length / found.report.overhang - 24.0 / 23.5).abs() < 2e-3, "{length} {:?}", found.report);
    }
}
