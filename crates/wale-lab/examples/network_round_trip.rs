//! Stretch curves made by fabrics of known stiffnesses in the contact model, and the stiffnesses that a fit finds from the curves alone.
//!
//! ```text
//! cargo run --release -p wale-lab --example network_round_trip -- [FABRIC] [point|thick|crossing]
//! ```

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use std::time::Instant;

use wale::dynamics::tile_equilibrium::TileSettings;
use wale::dynamics::tile_stiffness::TileStiffness;
use wale::model::Network;
use wale::pattern::weave::{self, Draft};
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
/// Known stiffnesses over those of the scene, with which the first search begins.
const TRUTH: [f64; P] = [0.6, 1.6, 1.3, 1.4, 1.5, 2.0];
/// Factor within which a stiffness is known to count as found.
const FOUND: f64 = 3.0;

/// A fabric, and how far it is pulled along each direction.
struct Known {
    name: &'static str,
    contacts: &'static str,
    scene: Scene,
    network: Network,
    pulls: Vec<[f64; 2]>,
    starts: Vec<[f64; P]>,
}

/// Two layers of rib, each knitted on every other needle: the yarn of a course goes from layer to layer.
fn interlock() -> Result<Chart, Failure> {
    let (before, behind) = (Stitch::Slip { in_front: true }, Stitch::Slip { in_front: false });
    let courses =
        vec![vec![Stitch::Knit, before, behind, Stitch::Purl], vec![behind, Stitch::Purl, Stitch::Knit, before]];
    Ok(Chart::new(courses)?)
}

/// Where searches begin: at the scene, and with three stiffnesses several times as stiff and as soft.
fn starts(several: [usize; 3], times: f64) -> Vec<[f64; P]> {
    let around = (0..8).map(|k| {
        let mut start = [1.0; P];
        for (bit, &of) in several.iter().enumerate() {
            start[of] = if (k >> bit) & 1 == 1 { times } else { 1.0 / times };
        }
        start
    });
    std::iter::once([1.0; P]).chain(around).collect()
}

fn knitted(
    name: &'static str,
    chart: &Chart,
    [course, wale]: [f64; 2],
    contacts: &'static str,
) -> Result<Known, Failure> {
    let scene = format!(
        "schema = 1\n[yarn]\npreset = \"worsted-wool\"\n[fabric]\nloop_length = \"10 mm\"\ncontacts = \"{contacts}\"\n\
         [fabric.chart]\npattern = \"stockinette\"\ncolumns = 1\nrows = 1\n"
    );
    let scene = Scene::from_text(&scene, "network_round_trip.toml").map_err(|error| error.to_string())?;
    let network = knit::tile(&chart.smallest_repeat(), scene.fabric.knit().ok_or("a chart makes a knit")?)?;
    let pulls = vec![[0.0, course], [FRAC_PI_2, wale]];
    // Bending, wrapping and spacing.
    Ok(Known { name, contacts, scene, network, pulls, starts: starts([1, 2, 4], 2.0) })
}

/// Of cotton, finer in the weft; the bias is pulled until it is jammed.
fn woven(name: &'static str, draft: &Draft) -> Result<Known, Failure> {
    let scene = format!(
        "schema = 1\n[yarn]\nlinear_density = \"30 tex\"\ndiameter = \"0.2 mm\"\nstretch_stiffness = \"30 N\"\n\
         bending_stiffness = \"2 mN mm^2\"\nfriction = 0.3\n[yarns.weft]\nlinear_density = \"20 tex\"\n\
         diameter = \"0.16 mm\"\nstretch_stiffness = \"20 N\"\nbending_stiffness = \"1 mN mm^2\"\n\
         [fabric.weave]\npattern = \"{name}\"\nends = 6\npicks = 6\nend_spacing = \"0.4 mm\"\npick_spacing = \"0.5 mm\"\n"
    );
    let scene = Scene::from_text(&scene, "network_round_trip.toml").map_err(|error| error.to_string())?;
    let card = scene.fabric.woven().ok_or("a draft makes a weave")?;
    let network = weave::tile(draft, card.spacing)?;
    let pulls = vec![[0.0, 0.1], [FRAC_PI_4, 0.45], [FRAC_PI_2, 0.1]];
    // Stretch of warp and weft, and shear.
    Ok(Known { name, contacts: "crossing", scene, network, pulls, starts: starts([0, 1, 2], 10.0) })
}

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let knits = [
        ("jersey", Chart::stockinette(), [0.28, 0.14]),
        ("garter", Chart::garter(), [0.28, 0.2]),
        ("rib", Chart::rib(1, 1)?, [0.3, 0.14]),
        ("interlock", interlock()?, [0.2, 0.1]),
    ];
    let mut all = vec![woven("plain", &Draft::plain())?, woven("twill 2/1", &Draft::twill(2, 1)?)?];
    for (name, chart, pulls) in knits {
        for contacts in ["thick", "point"] {
            all.push(knitted(name, &chart, pulls, contacts)?);
        }
    }
    println!("fabric     contacts  comfort    full  compression  evaluations  seconds  stiffnesses found over true");
    for known in all {
        if arguments.iter().any(|asked| asked != known.name && asked != known.contacts) {
            continue;
        }
        if let Err(error) = round_trip(&known) {
            println!("{:<10} {:<8}  {error}", known.name, known.contacts);
        }
    }
    Ok(())
}

fn round_trip(Known { name, contacts, scene, network, pulls, starts }: &Known) -> Result<(), Failure> {
    let card = &scene.fabric;
    let zero = pulls.iter().map(|&[angle, end]| {
        let point = |k| StretchPoint { stretch: end * f64::from(k) / f64::from(POINTS), force: 1.0, compression: 0.0 };
        Target::new(&StretchCurve { angle, points: (1..=POINTS).map(point).collect() }, true, 1.0)
    });
    let zero: Vec<Target> = zero.collect();
    let (tile, pull) =
        (TileSettings { strand_contact: false, ..TileSettings::of(card) }, NetworkPullSettings::default());
    let problem = NetworkProblem::new(network, &scene.yarns, card, zero.clone(), tile, pull, 2)?;
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
    let settings = NetworkFitSettings { max_evaluations: 40, starts: starts.clone(), ..NetworkFitSettings::default() };
    let found = fit_network(network, &scene.yarns, card, &targets, &settings)?;
    let ratio = |k: usize| match found.within[k] {
        within if within > FOUND => format!("{} –", found.kinds[k].name()),
        _ => format!("{} {:.3}", found.kinds[k].name(), found.stiffness[k] / truth[k]),
    };
    let ratios: Vec<String> = (0..P).filter(|&k| truth[k] > 0.0).map(ratio).collect();
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
