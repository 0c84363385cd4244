//! Fits of known curves, and of what cannot be fitted.

use std::f64::consts::FRAC_PI_2;

use wale::dynamics::tile_equilibrium::TileSettings;
use wale::dynamics::tile_stiffness::TileStiffness;

use super::{knit_of, yarn};
use crate::network_fit::{NetworkFitError, NetworkFitSettings, NetworkProblem, NetworkPullSettings, fit_network};
use crate::shell::{StretchCurve, StretchPoint};
use crate::yarn_fit::Target;

/// Factors by which the known stiffnesses differ from those at which the search begins.
const TRUTH: [f64; TileStiffness::COUNT] = [0.6, 1.6, 1.3, 1.4, 1.5, 2.0];

/// What a tile does that is pulled along course and wale.
fn curves(factors: [f64; TileStiffness::COUNT]) -> Vec<Target> {
    let (network, yarns, card) = knit_of(1, 1, true);
    let ends = [(0.0, 0.28), (FRAC_PI_2, 0.14)];
    let zero = ends.map(|(angle, end)| {
        let points = (1..=6).map(|k| [end * f64::from(k) / 6.0, f64::from(k), 0.0]).map(StretchPoint::from).collect();
        Target::new(&StretchCurve { angle, points }, true, 1.0)
    });
    let (tile, pull) = (TileSettings::of(&card), NetworkPullSettings::default());
    let problem = NetworkProblem::new(&network, &yarns, &card, zero.to_vec(), tile, pull, 1).unwrap();
    let given = problem.stiffness();
    let found = problem.evaluate(std::array::from_fn(|k| given[k] * factors[k]), false).unwrap();
    let all = zero.iter().zip(found.answers);
    all.map(|(target, answers)| {
        let points: Vec<StretchPoint> = answers.iter().map(|answer| answer.point).collect();
        let most = points[points.len() - 1].force;
        Target::new(&StretchCurve { angle: target.angle, points }, true, 0.4 * most)
    })
    .collect()
}

#[test]
fn curves_of_known_stiffnesses_are_met() {
    let targets = curves(TRUTH);
    let (network, yarns, card) = knit_of(1, 1, true);
    let fit = fit_network(&network, &yarns, &card, &targets, &NetworkFitSettings::default()).unwrap();
    let start = fit.start_error.unwrap();
    assert!(start.comfort > 0.05, "{start:?}");
    assert!(fit.error.comfort < 0.01 && fit.error.full < 0.01 && fit.error.compression < 0.02, "{:?}", fit.error);
    // Bending is what a knit resists with at first: it is known.
    let at = fit.kinds.iter().position(|&kind| kind == TileStiffness::Bending).unwrap();
    let bending = fit.stiffness[at] / yarn().bending_stiffness;
    assert!((bending / 1.6 - 1.0).abs() < 0.1, "{bending}: {:?} {:?}", fit.stiffness, fit.within);
}

#[test]
fn what_cannot_be_fitted_is_told() {
    let (network, yarns, card) = knit_of(1, 1, true);
    let settings = NetworkFitSettings { max_evaluations: 3, ..NetworkFitSettings::default() };
    assert_eq!(fit_network(&network, &yarns, &card, &[], &settings).unwrap_err(), NetworkFitError::NoTarget);
    // Shorter than nothing.
    let far = StretchCurve { angle: 0.0, points: vec![StretchPoint { stretch: -1.5, force: 1.0, compression: 0.0 }] };
    let told = fit_network(&network, &yarns, &card, &[Target::new(&far, true, 1.0)], &settings).unwrap_err();
    assert_eq!(told, NetworkFitError::NoStart);
    let mut weak = yarn();
    weak.stretch_stiffness = 0.0;
    let told = fit_network(&network, &weak, &card, &curves([1.0; 6])[..1], &settings).unwrap_err();
    assert!(matches!(told, NetworkFitError::Stiffness { what: "stretch", .. }));
    let mut wild = settings.clone();
    wild.bounds[1] = [2.0, 1.0];
    let told = fit_network(&network, &yarns, &card, &[Target::new(&far, true, 1.0)], &wild).unwrap_err();
    assert_eq!(told, NetworkFitError::Bounds { what: "bending" });
    let mut restless = settings.clone();
    restless.tile = Some(TileSettings { max_iterations: 1, ..TileSettings::of(&card) });
    let target = Target::new(&far, true, 1.0);
    assert!(matches!(fit_network(&network, &yarns, &card, &[target], &restless), Err(NetworkFitError::Tile(_))));
}
