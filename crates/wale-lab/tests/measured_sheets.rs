//! The ten measured sheets of [Wang2011], by the paper's law of a thin shell and by the one that stiffens.

#[path = "../../wale/tests/shared/mod.rs"]
mod shared;

use std::collections::BTreeMap;

use shared::shared;
use wale_lab::shell::membrane_fit::{MeasuredStretch, MembraneFitSettings, MembraneLaw, StretchTest, fit_membrane};
use wale_lab::shell::{StretchCurve, StretchPoint};

#[test]
fn ten_measured_sheets() {
    let Some(path) = shared("sheet-materials-wang2011/wang2011_arcsim_uniaxial.csv") else { return };
    let text = std::fs::read_to_string(path).unwrap();
    let mut fabrics: BTreeMap<&str, Vec<StretchCurve>> = BTreeMap::new();
    for line in text.lines() {
        let fields: Vec<&str> = line.split(',').collect();
        let [fabric, direction, stretch, compression, force, _] = fields[..] else { continue };
        let numbers: Vec<f64> = [stretch, compression, force].iter().filter_map(|field| field.parse().ok()).collect();
        let [stretch, compression, force] = numbers[..] else { continue };
        let angle = direction.rsplit('_').next().unwrap().parse::<f64>().unwrap().to_radians();
        let curves = fabrics.entry(fabric).or_default();
        if curves.last().is_none_or(|curve| curve.angle != angle) {
            curves.push(StretchCurve { angle, points: Vec::new() });
        }
        curves.last_mut().unwrap().points.push(StretchPoint { stretch, force, compression });
    }
    assert_eq!(fabrics.len(), 10);
    let mean = |law| {
        let settings = MembraneFitSettings { law, ..MembraneFitSettings::default() };
        let errors: Vec<[f64; 2]> = fabrics
            .values()
            .map(|curves| {
                let uniform = |curve: &StretchCurve| MeasuredStretch::new(curve.clone(), StretchTest::Uniform);
                let fit = fit_membrane(&curves.iter().map(uniform).collect::<Vec<_>>(), &settings).unwrap();
                [fit.force_error, fit.compression_error]
            })
            .collect();
        [0, 1].map(|k| errors.iter().map(|error| error[k]).sum::<f64>() / errors.len() as f64)
    };
    let (quadratic, stiffening) = (mean(MembraneLaw::Quadratic), mean(MembraneLaw::Stiffening));
    println!("force and compression: quadratic {quadratic:?}, stiffening {stiffening:?}");
    // The paper's law cannot; what the wanted 10 % take is the term that stiffens.
    assert!(quadratic[0] > 0.11 && quadratic[1] > 0.15, "{quadratic:?}");
    assert!(stiffening[0] < 0.10 && stiffening[1] < 0.10, "{stiffening:?}");
}
