//! Stretch curves made by knits of known stiffnesses in the contact model, and the stiffnesses that a fit finds from the curves alone.
//!
//! ```text
//! cargo run --release -p wale-lab --example network_round_trip -- [FABRIC] [point|thick]
//! ```

use std::f64::consts::FRAC_PI_2;
use std::time::Instant;

use wale::dynamics::tile_equilibrium::TileSettings;
use wale::dynamics::tile_stiffness::TileStiffness;
use wale::pattern::{Chart, Stitch, knit};
use wale::scene::Scene;
use wale_lab::network_fit::{NetworkFitSettings, NetworkProblem, NetworkPullSettings, fit_network};
use wale_lab::shell::{StretchCurve, StretchPoint};
use wale_lab::yarn_fit::Target;
use wale_lab::yarn_fit::of_fabric::COMFORT;

type Failure = Box<dyn std::error::Error + Send + Sync>;

const P: usize = TileStiffness::COUNT;
/// Points along each curve.
const POINTS: u32 = 8;
/// Known stiffnesses over those of the preset, with which the search begins.
const TRUTH: [f64; P] = [0.6, 1.6, 1.3, 1.4, 1.5, 2.0];

/// Two layers of rib, each knitted on every other needle: the yarn of a course goes from layer to layer.
fn interlock() -> Result<Chart, Failure> {
    let (before, behind) = (Stitch::Slip { in_front: true }, Stitch::Slip { in_front: false });
    let courses =
        vec![vec![Stitch::Knit, before, behind, Stitch::Purl], vec![behind, Stitch::Purl, Stitch::Knit, before]];
    Ok(Chart::new(courses)?)
}

/// Where searches begin: at the preset, and with bending, wrapping, spacing and legs twice as stiff and half as stiff.
fn starts() -> Vec<[f64; P]> {
    let corner = |k: usize, bit: usize| if (k >> bit) & 1 == 1 { 2.0 } else { 0.5 };
    let around = (0..8).map(|k| [1.0, corner(k, 0), corner(k, 1), 1.0, corner(k, 2), 1.0]);
    std::iter::once([1.0; P]).chain(around).collect()
}

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let fabrics = [
        ("jersey", Chart::stockinette(), [0.28, 0.14]),
        ("garter", Chart::garter(), [0.28, 0.2]),
        ("rib", Chart::rib(1, 1)?, [0.3, 0.14]),
        ("interlock", interlock()?, [0.2, 0.1]),
    ];
    println!("fabric     contacts  comfort    full  compression  evaluations  seconds  stiffnesses found over true");
    for ((name, chart, largest), contacts) in
        fabrics.iter().flat_map(|f| ["thick", "point"].map(|contacts| (f, contacts)))
    {
        if arguments.iter().any(|asked| asked != name && asked != contacts) {
            continue;
        }
        if let Err(error) = round_trip(name, chart, *largest, contacts) {
            println!("{name:<10} {contacts:<8}  {error}");
        }
    }
    Ok(())
}

fn round_trip(name: &str, chart: &Chart, largest: [f64; 2], contacts: &str) -> Result<(), Failure> {
    let scene = format!(
        "schema = 1\n[yarn]\npreset = \"worsted-wool\"\n[fabric]\nloop_length = \"10 mm\"\ncontacts = \"{contacts}\"\n\
         [fabric.chart]\npattern = \"stockinette\"\ncolumns = 1\nrows = 1\n"
    );
    let scene = Scene::from_text(&scene, "network_round_trip.toml").map_err(|error| error.to_string())?;
    let card = scene.fabric.knit().ok_or("a chart makes a knit")?;
    let network = knit::tile(&chart.smallest_repeat(), card)?;
    let zero = [0.0, FRAC_PI_2].into_iter().zip(largest).map(|(angle, end)| {
        let point = |k| StretchPoint { stretch: end * f64::from(k) / f64::from(POINTS), force: 1.0, compression: 0.0 };
        Target::new(&StretchCurve { angle, points: (1..=POINTS).map(point).collect() }, true, 1.0)
    });
    let zero: Vec<Target> = zero.collect();
    let (tile, pull) = (TileSettings::of(card), NetworkPullSettings::default());
    let problem = NetworkProblem::new(&network, &scene.yarns, card, zero.clone(), tile, pull, 2)?;
    let given = problem.stiffness();
    let truth: [f64; P] = std::array::from_fn(|k| given[k] * TRUTH[k]);
    let known = problem.evaluate(truth, false).ok_or("no curves: it cannot be pulled so far")?;
    let targets: Vec<Target> = zero
        .iter()
        .zip(&known.answers)
        .map(|(target, answers)| {
            let points: Vec<StretchPoint> = answers.iter().map(|answer| answer.point).collect();
            let most = points.iter().fold(0.0f64, |most, point| most.max(point.force));
            Target::new(&StretchCurve { angle: target.angle, points }, true, COMFORT * most)
        })
        .collect();
    let begun = Instant::now();
    let settings = NetworkFitSettings { max_evaluations: 40, starts: starts(), ..NetworkFitSettings::default() };
    let found = fit_network(&network, &scene.yarns, card, &targets, &settings)?;
    let ratios: Vec<String> = (0..P)
        .filter(|&k| truth[k] > 0.0)
        .map(|k| format!("{} {:.3}", TileStiffness::NAMES[k], found.stiffness[k] / truth[k]))
        .collect();
    println!(
        "{name:<10} {contacts:<8} {:7.2} % {:6.2} % {:10.2} % {:12} {:8.0}  {}",
        100.0 * found.error.comfort,
        100.0 * found.error.full,
        100.0 * found.error.compression,
        found.least_squares.evaluations,
        begun.elapsed().as_secs_f64(),
        ratios.join(", "),
    );
    for target in &targets {
        let curve: Vec<String> = target.points.iter().map(|[_, force, _]| format!("{force:.1}")).collect();
        println!("           along {:3.0}°: N/m {}", target.angle.to_degrees(), curve.join(" "));
    }
    Ok(())
}
