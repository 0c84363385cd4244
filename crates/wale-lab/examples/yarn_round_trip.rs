//! Stretch curves made by yarns of known numbers, and the yarns that a fit finds from the curves alone: six fabrics.
//!
//! ```text
//! cargo run --release -p wale-lab --example yarn_round_trip -- [FABRIC]
//! ```

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use std::time::Instant;

use rayon::prelude::*;
use wale::pattern::weave::Draft;
use wale::pattern::{Chart, Stitch};
use wale::scene::schema::PresetName;
use wale::scene::{Scene, text_of_preset};
use wale_lab::shell::{StretchCurve, StretchPoint};
use wale_lab::yarn_fit::gradients::GradientSettings;
use wale_lab::yarn_fit::of_fabric::{Ablation, COMFORT, problem};
use wale_lab::yarn_fit::problem::{Here, YarnProblem};
use wale_lab::yarn_fit::run::{Way, fit_yarn};
use wale_lab::yarn_fit::{Progress, RodSpace, Target, pull};
use wale_lab::yarn_tile::{RodMaterial, RodParameter, YarnTile, contact_radius, tile_of_chart, tile_of_draft};

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Stiffness of the yarns, as a tensile tester would measure it \[N\].
const STIFFNESS: f64 = 100.0;
/// Points along each curve.
const POINTS: usize = 8;

fn knit(chart: &Chart) -> Result<YarnTile, Failure> {
    let scene = Scene::from_text(&text_of_preset(PresetName::WorstedWool), "preset.toml")?;
    let card = scene.fabric.knit().ok_or("the preset is a knit")?;
    Ok(tile_of_chart(chart, &scene.yarns, card)?)
}

fn weave(draft: &Draft) -> Result<YarnTile, Failure> {
    let radius = 0.25e-3;
    Ok(tile_of_draft(draft, radius, [1.1e-3, 1.2e-3], [2.0 * radius; 2])?)
}

/// Two layers of rib, each knitted on every other needle: the yarn of a course goes from layer to layer.
fn interlock() -> Result<Chart, Failure> {
    let (before, behind) = (Stitch::Slip { in_front: true }, Stitch::Slip { in_front: false });
    let courses =
        vec![vec![Stitch::Knit, before, behind, Stitch::Purl], vec![behind, Stitch::Purl, Stitch::Knit, before]];
    Ok(Chart::new(courses)?)
}

/// A fabric of which curves are made.
struct Fabric {
    name: &'static str,
    tile: Result<YarnTile, Failure>,
    /// How far it is pulled along weft, bias and warp \[–\].
    largest: [f64; 3],
    /// Its yarn: `k_b` in that of a solid rod as stiff in stretch, and `k_h` in `k_b/R⁴`.
    bending: f64,
    holding: f64,
}

fn fabrics() -> Result<Vec<Fabric>, Failure> {
    // Fibres slide past each other in a yarn, so that it bends far more easily than a rod. Knits stick about half as hard as acrylic
    // stockinette is fitted with.
    let knitted =
        |name, chart: &Chart, largest| Fabric { name, tile: knit(chart), largest, bending: 0.05, holding: 0.1 };
    // Firm yarns in a firm weave, which stick so little that it shears, as weaves do, a fifth as hard as it stretches.
    let woven = |name, draft: &Draft| Fabric {
        name,
        tile: weave(draft),
        largest: [0.08, 0.15, 0.08],
        bending: 0.5,
        holding: 0.004,
    };
    Ok(vec![
        knitted("jersey", &Chart::stockinette(), [0.45, 0.35, 0.3]),
        knitted("garter", &Chart::garter(), [0.4, 0.35, 0.4]),
        knitted("rib", &Chart::rib(1, 1)?, [0.5, 0.35, 0.25]),
        knitted("interlock", &interlock()?, [0.3, 0.25, 0.2]),
        woven("plain", &Draft::plain()),
        woven("twill", &Draft::twill(2, 1)?),
    ])
}

/// A yarn within the bounds, but not in their middle: what is to be found.
fn truth(fabric: &Fabric, tile: &YarnTile, base: &RodMaterial) -> RodMaterial {
    let radius = contact_radius(tile);
    let bending = fabric.bending * 0.25 * STIFFNESS * radius * radius;
    let holding = fabric.holding * bending / radius.powi(4);
    base.with_parameters([8.0, STIFFNESS, 0.05, bending, 1.05 * radius, 0.05 * STIFFNESS / radius, holding])
}

fn curves(problem: &YarnProblem, material: &RodMaterial, largest: [f64; 3]) -> Result<Vec<Target>, Failure> {
    let tile = problem.rested(&material.parameters()).ok_or("no rest shapes")?;
    let curve = |(angle, largest): (f64, f64)| -> Result<StretchCurve, Failure> {
        let stretches: Vec<f64> = (1..=POINTS).map(|k| largest * k as f64 / POINTS as f64).collect();
        let answers = pull(&tile, material, angle, &stretches, false, &problem.pull)?;
        Ok(StretchCurve { angle, points: answers.iter().map(|answer| answer.point).collect::<Vec<StretchPoint>>() })
    };
    let angles = [0.0, FRAC_PI_4, FRAC_PI_2].into_par_iter().zip(largest.into_par_iter());
    let curves: Vec<StretchCurve> = angles.map(curve).collect::<Result<_, _>>()?;
    let most = |curve: &StretchCurve| curve.points.iter().fold(0.0f64, |m, p| m.max(p.force));
    Ok(curves.iter().map(|curve| Target::new(curve, true, COMFORT * most(curve))).collect())
}

fn main() -> Result<(), Failure> {
    let only = std::env::args().nth(1);
    println!("fabric     vertices  comfort    full  compression  evaluations  seconds  parameters found over true");
    for fabric in fabrics()? {
        let name = fabric.name;
        if only.as_ref().is_some_and(|only| only != name) {
            continue;
        }
        let tile = match &fabric.tile {
            Ok(tile) => tile.clone(),
            Err(error) => {
                println!("{name:<10} no tile: {error}");
                continue;
            }
        };
        let mut problem = problem(tile, Vec::new(), Vec::new(), Some(STIFFNESS), Ablation::default());
        let material = truth(&fabric, &problem.tile, &problem.base);
        problem.targets = match curves(&problem, &material, fabric.largest) {
            Ok(targets) => targets,
            Err(error) => {
                println!("{name:<10} no curves: {error}");
                continue;
            }
        };
        let begun = Instant::now();
        let silent = |_: &wale_lab::yarn_fit::Step| {};
        let way = Way::Gradients(GradientSettings::default());
        let Ok(found) = fit_yarn(&problem, &Here::new(&problem), &way, &Progress::new(&silent));
        let Some(found) = found else {
            println!("{name:<10} could not be tested");
            continue;
        };
        let ratios: Vec<String> = found
            .material
            .parameters()
            .iter()
            .zip(material.parameters())
            .zip(RodParameter::NAMES)
            .map(|((found, truth), name)| format!("{name} {:.3}", found / truth))
            .collect();
        println!(
            "{name:<10} {:8} {:7.2} % {:6.2} % {:10.2} % {:12} {:8.0}  {}",
            problem.tile.vertex_count(),
            100.0 * found.error.comfort,
            100.0 * found.error.full,
            100.0 * found.error.compression,
            found.evaluations,
            begun.elapsed().as_secs_f64(),
            ratios.join(", "),
        );
        for target in &problem.targets {
            let last = target.points[target.points.len() - 1];
            println!(
                "           along {:3.0}°: {:.1} N/m and {:.3} at {:.0} %",
                target.angle.to_degrees(),
                last[1],
                last[2],
                100.0 * last[0]
            );
        }
        let at = RodSpace::coordinates(found.material.parameters());
        if found.open.iter().any(|open| open.contains("bound")) {
            println!("           {}; at {at:?}", found.open.join("; "));
        }
    }
    Ok(())
}
