//! A fabric file with the tests of a known shell gives that shell back, each test with its own specimen.

use std::fmt::Write;
use std::fs;

use wale::energy::{BendingStiffness, MembraneStiffness};
use wale_lab::fabric_file::FabricFile;
use wale_lab::shell::membrane_fit::{MembraneFitSettings, MembraneLaw};
use wale_lab::shell::of_fabric::{ShellFit, fit_shell};
use wale_lab::shell::uniform::uniform_stretch;
use wale_lab::shell::{ClampedStretch, PearLoop, ShellCard};
use wale_lab::yarn_fit::of_fabric::uniform_targets;

#[test]
fn specimens_of_different_size_are_fitted_as_what_they_are() {
    let membrane =
        MembraneStiffness { xx: 300.0, xy: 20.0, yy: 600.0, ss: 60.0, n1: 2.0, n2: 4.0, ..MembraneStiffness::NONE };
    let bending = BendingStiffness { weft: 1.5e-6, bias: 2.5e-6, warp: 5e-6 };
    let card = ShellCard { membrane, bending, areal_mass: 0.2 };
    let folder = tempfile::tempdir().unwrap();
    let mut fabric = String::from("schema = 1\nareal_mass = \"200 g/m^2\"\n");
    let mut add = |kind: &str, degrees: f64, [length, width]: [f64; 2], table: &str| {
        let name = format!("{kind}-{degrees}.csv");
        fs::write(folder.path().join(&name), table).unwrap();
        let _ = write!(
            fabric,
            "[[{kind}]]\ndirection = \"{degrees} deg\"\nfile = \"{name}\"\nlength = {length:?}\nwidth = {width:?}\n"
        );
    };
    for (degrees, size) in [(0.0, [0.1_f64, 0.06]), (45.0, [0.08, 0.05]), (90.0, [0.06, 0.08])] {
        let [length, width] = size;
        let edge = 0.1 * length.min(width);
        let test = ClampedStretch { length, width, edge, angle: f64::to_radians(degrees), ..ClampedStretch::default() };
        let mut table = String::from("stretch,force (N),compression\n0,0,0\n");
        for point in test.run(&card, &[0.05, 0.1, 0.15, 0.2, 0.25, 0.3]).unwrap() {
            let _ = writeln!(table, "{},{},{}", point.stretch, point.force, point.compression);
        }
        add("stretch", degrees, size, &table);
    }
    for (degrees, size) in [(0.0, [0.1, 0.03]), (90.0, [0.12, 0.04])] {
        let [length, width] = size;
        let test =
            PearLoop { length, width, edge: 0.1 * width, angle: f64::to_radians(degrees), ..PearLoop::default() };
        let mut table = String::from("clamp distance (m),aspect ratio\n");
        for point in test.run(&card, &[0.01, 0.02, 0.03]).unwrap() {
            let _ = writeln!(table, "{},{}", point.distance, point.aspect);
        }
        add("bending", degrees, size, &table);
    }
    let path = folder.path().join("fabric.toml");
    fs::write(&path, fabric).unwrap();
    let fabric = FabricFile::read(&path).unwrap();
    let found = fit_shell(&fabric, &MembraneFitSettings::default()).unwrap();
    assert!(found.membrane.force_error < 2e-3 && found.membrane.compression_error < 5e-3, "{:?}", found.membrane);
    let [k, truth] = [found.membrane.stiffness, membrane].map(|k| [k.xx, k.yy, k.ss]);
    assert!(k.iter().zip(truth).all(|(k, truth)| (k / truth - 1.0).abs() < 0.05), "{k:?}");
    let fitted = found.bending.as_ref().unwrap().stiffness;
    assert!((fitted.weft / bending.weft - 1.0).abs() < 0.03, "{fitted:?}");
    assert!((fitted.warp / bending.warp - 1.0).abs() < 0.03, "{fitted:?}");
    assert!(found.open.iter().any(|open| open.contains("k_θ,bias")), "{:?}", found.open);
    targets_of_a_shell_are_its_uniform_curves(&fabric, &found, &membrane);
}

/// What a yarn is fitted to: the clamps' share is taken out of what was measured.
fn targets_of_a_shell_are_its_uniform_curves(fabric: &FabricFile, found: &ShellFit, truth: &MembraneStiffness) {
    let targets = uniform_targets(fabric, found).unwrap();
    assert_eq!(targets.len(), 3);
    let mut clamped_off = 0.0f64;
    for (target, points) in targets.iter().zip(&found.membrane.points) {
        assert!(target.compression && target.comfort > 0.0 && target.comfort <= 0.3 + 1e-9);
        let width = fabric.stretch.iter().find(|test| test.direction == target.angle).unwrap().specimen.width;
        for (&[stretch, force, compression], [measured, _]) in target.points.iter().zip(points) {
            let uniform = uniform_stretch(truth, target.angle, stretch).unwrap().point;
            assert!((force / uniform.force - 1.0).abs() < 0.01, "{stretch}: {force} {}", uniform.force);
            assert!((compression - uniform.compression).abs() < 0.003);
            clamped_off = clamped_off.max((measured.force / width / uniform.force - 1.0).abs());
        }
    }
    assert!(clamped_off > 0.03, "clamps make a difference here: {clamped_off}");
}

#[test]
fn uniform_curves_and_a_rigidity_of_an_instrument_make_a_card() {
    let stiff = MembraneStiffness { xx: 60.0, xy: 5.0, yy: 90.0, ss: 9.0, n1: 0.1, n2: 0.1, ..MembraneStiffness::NONE };
    let membrane = MembraneStiffness { stiffening_xx: 300.0, stiffening_yy: 900.0, stiffening_ss: 60.0, ..stiff };
    let folder = tempfile::tempdir().unwrap();
    let mut fabric = String::from("schema = 1\nareal_mass = \"200 g/m^2\"\nassumed = [\"the mass\"]\n");
    for degrees in [0.0, 45.0, 90.0] {
        let mut table = String::from("stretch,force (N),compression\n0,0,0\n");
        for k in 1..=12 {
            let point = uniform_stretch(&membrane, f64::to_radians(degrees), 0.025 * f64::from(k)).unwrap().point;
            // Of a strip 5 cm wide.
            let _ = writeln!(table, "{},{},{}", point.stretch, 0.05 * point.force, point.compression);
        }
        let name = format!("{degrees}.csv");
        fs::write(folder.path().join(&name), table).unwrap();
        let _ = write!(
            fabric,
            "[[stretch]]\ndirection = \"{degrees} deg\"\nfile = \"{name}\"\nwidth = \"5 cm\"\nuniform = true\n"
        );
    }
    for (direction, value) in [("weft", 4), ("bias", 3), ("warp", 2)] {
        let _ = write!(fabric, "[[rigidity]]\ndirection = \"{direction}\"\nvalue = \"{value} uN m\"\n");
    }
    let path = folder.path().join("fabric.toml");
    fs::write(&path, &fabric).unwrap();
    let file = FabricFile::read(&path).unwrap();
    let settings = MembraneFitSettings { law: MembraneLaw::Stiffening, ..MembraneFitSettings::default() };
    let found = fit_shell(&file, &settings).unwrap();
    assert!(found.membrane.force_error < 5e-3 && found.membrane.compression_error < 0.02, "{:?}", found.membrane);
    assert!((found.membrane.stiffness.stiffening_yy / 900.0 - 1.0).abs() < 0.3, "{:?}", found.membrane.stiffness);
    // B = 2k_θ.
    assert_eq!(found.card.bending, Some(BendingStiffness { weft: 2e-6, bias: 1.5e-6, warp: 1e-6 }));
    assert!(found.card.open.contains(&"assumed: the mass".to_owned()), "{:?}", found.card.open);
    for target in uniform_targets(&file, &found).unwrap() {
        for [stretch, force, _] in target.points {
            let known = uniform_stretch(&membrane, target.angle, stretch).unwrap().point.force;
            assert!((force / known - 1.0).abs() < 0.02, "{stretch}: {force} {known}");
        }
    }
    let looped = fabric.clone() + "[[bending]]\ndirection = \"weft\"\nfile = \"0.csv\"\n";
    fs::write(&path, looped).unwrap();
    assert!(FabricFile::read(&path).unwrap_err().to_string().contains("given twice"));
}
