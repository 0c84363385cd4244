//! Known fabrics are tested between clamps and in pear loops, and what was measured gives them back.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use wale::energy::{BendingStiffness, MembraneStiffness};
use wale_lab::shell::bending_fit::{PearCurve, distances, fit_bending};
use wale_lab::shell::membrane_fit::{MeasuredStretch, MembraneFitSettings, StretchTest, fit_membrane};
use wale_lab::shell::uniform::uniform_stretch;
use wale_lab::shell::{ClampedStretch, PearLoop, ShellCard, StretchCurve};

const TRUTH: MembraneStiffness =
    MembraneStiffness { xx: 25.0, xy: 4.0, yy: 80.0, ss: 7.0, n1: 1.5, n2: 3.0, ..MembraneStiffness::NONE };

#[test]
fn clamped_swatches_of_a_known_fabric_give_its_stress_back() {
    let card = ShellCard { membrane: TRUTH, bending: BendingStiffness::isotropic(1e-6), areal_mass: 0.2 };
    let test = ClampedStretch { edge: 0.01, ..ClampedStretch::default() };
    let ranges = [(0.0, 1.0), (FRAC_PI_4, 0.8), (FRAC_PI_2, 0.5)];
    let curves = ranges.map(|(angle, largest)| {
        let stretches: Vec<f64> = (1..=6).map(|k| largest * f64::from(k) / 6.0).collect();
        let points = ClampedStretch { angle, ..test }.run(&card, &stretches).unwrap();
        MeasuredStretch::new(StretchCurve { angle, points }, StretchTest::Clamped(test))
    });
    let settings = MembraneFitSettings { starts: 2, ..MembraneFitSettings::default() };
    let fit = fit_membrane(&curves, &settings).unwrap();
    assert!(fit.force_error < 1e-3 && fit.compression_error < 1e-3, "{fit:?}");
    // The uniform strip, which no clamped swatch is, comes out as that of the truth: within a per cent.
    for (angle, largest) in ranges {
        for part in [0.1, 0.5, 1.0] {
            let [found, truth] =
                [fit.stiffness, TRUTH].map(|k| uniform_stretch(&k, angle, part * largest).unwrap().point.force);
            assert!((found / truth - 1.0).abs() < 0.01, "{angle} {part}: {found} {truth}");
        }
    }
    // The same bits on one thread.
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let again = one.install(|| fit_membrane(&curves, &settings).unwrap());
    assert_eq!(fit, again);
}

#[test]
fn pear_loops_of_a_known_fabric_give_its_bending_back() {
    let membrane =
        MembraneStiffness { xx: 300.0, xy: 20.0, yy: 300.0, ss: 60.0, n1: 2.0, n2: 4.0, ..MembraneStiffness::NONE };
    let bending = BendingStiffness { weft: 1.5e-6, bias: 2.5e-6, warp: 5e-6 };
    let card = ShellCard { membrane, bending, areal_mass: 0.2 };
    let test = PearLoop { edge: 0.008, width: 0.024, ..PearLoop::default() };
    let curve = |angle: f64| {
        let test = PearLoop { angle, ..test };
        let points = test.run(&card, &distances()).unwrap();
        PearCurve { test, points: points.iter().map(|point| [point.distance, point.aspect]).collect() }
    };
    let guess = ShellCard { bending: BendingStiffness::isotropic(1e-9), ..card };
    let curves = [0.0, FRAC_PI_4, FRAC_PI_2].map(curve);
    let fit = fit_bending(&curves, &guess, 0.01).unwrap();
    assert!(fit.aspect_error < 1e-4, "{}", fit.aspect_error);
    for (found, truth) in fit.stiffness.to_array().iter().zip(bending.to_array()) {
        assert!((found / truth - 1.0).abs() < 0.02, "{:?}", fit.stiffness);
    }
    let fit = fit_bending(&curves[..1], &guess, 0.01).unwrap();
    assert!((fit.stiffness.weft / bending.weft - 1.0).abs() < 0.02, "{:?}", fit.stiffness);
    assert_eq!(fit.undetermined(), ["k_θ,bias", "k_θ,warp"]);
}
