//! Thin-shell fits of the ten fabrics of [Wang2011], to their uniform tension and transverse contraction along three directions.
//!
//! Reads `sheet-materials-wang2011` from a folder of measured data beside the repository, or from the one named as argument:
//!
//! ```text
//! cargo run --release -p wale-lab --example sheet_materials [FOLDER]
//! ```

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;

use wale_lab::shell::membrane_fit::{MeasuredStretch, MembraneFitSettings, MembraneLaw, StretchTest, fit_membrane};
use wale_lab::shell::{StretchCurve, StretchPoint};

fn main() -> ExitCode {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/sheet-materials-wang2011");
    let folder = std::env::args().nth(1).map_or(beside, PathBuf::from);
    let path = folder.join("wang2011_arcsim_uniaxial.csv");
    let text = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(error) => {
            eprintln!("{}: {error}; name the folder that holds it", path.display());
            return ExitCode::FAILURE;
        }
    };
    for law in [MembraneLaw::Quadratic, MembraneLaw::Stiffening] {
        println!("\n{law:?}");
        table(&text, law);
    }
    ExitCode::SUCCESS
}

fn table(text: &str, law: MembraneLaw) {
    println!("Errors are means over six targets a direction, over the mean measured value. Stiffnesses in N/m.");
    println!(
        "{:20} {:>7} {:>7}  {:>52}  not determined within a factor of three",
        "fabric", "force", "compr.", "k_xx k_xy k_yy k_ss k_n1 k_n2, m_xx m_yy m_ss m_xy"
    );
    let (mut sum, mut count) = ([0.0; 2], 0.0);
    for (fabric, curves) in read(text) {
        let uniform = |curve| MeasuredStretch::new(curve, StretchTest::Uniform);
        let curves: Vec<_> = curves.into_iter().map(uniform).collect();
        match fit_membrane(&curves, &MembraneFitSettings { law, ..MembraneFitSettings::default() }) {
            Ok(fit) => {
                let k: String =
                    fit.stiffness.to_array()[..fit.stiffness.used()].iter().map(|k| format!("{k:9.3}")).collect();
                let errors = [fit.force_error, fit.compression_error];
                println!(
                    "{fabric:20} {:6.1}% {:6.1}% {k}  {}",
                    100.0 * errors[0],
                    100.0 * errors[1],
                    fit.undetermined().join(" ")
                );
                sum = [sum[0] + errors[0], sum[1] + errors[1]];
                count += 1.0;
            }
            Err(error) => println!("{fabric:20} {error}"),
        }
    }
    let [force, compression] = sum.map(|sum| 100.0 * sum / count);
    println!("{:20} {force:6.1}% {compression:6.1}%", "mean");
    println!("{:20} {:6.1}% {:6.1}%  its 33 knits, clamped swatches", "[Sperl2022]", 17.6, 16.8);
}

/// Curves by fabric, from rows of fabric, direction, strain, contraction and tension; direction ends in its angle in degrees.
fn read(text: &str) -> BTreeMap<String, Vec<StretchCurve>> {
    let mut fabrics: BTreeMap<String, BTreeMap<String, StretchCurve>> = BTreeMap::new();
    for line in text.lines() {
        let fields: Vec<&str> = line.split(',').collect();
        let [fabric, direction, numbers @ ..] = &fields[..] else { continue };
        let numbers: Vec<f64> = numbers.iter().filter_map(|field| field.parse().ok()).collect();
        let (Some(degrees), [stretch, compression, force, ..]) =
            (direction.rsplit('_').next().and_then(|angle| angle.parse::<f64>().ok()), &numbers[..])
        else {
            continue;
        };
        let empty = StretchCurve { angle: degrees.to_radians(), points: Vec::new() };
        let curve = fabrics.entry((*fabric).into()).or_default().entry((*direction).into()).or_insert(empty);
        curve.points.push(StretchPoint { stretch: *stretch, force: *force, compression: *compression });
    }
    fabrics.into_iter().map(|(fabric, curves)| (fabric, curves.into_values().collect())).collect()
}
