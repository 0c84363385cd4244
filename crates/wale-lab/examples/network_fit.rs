//! Fits the stiffnesses of the contact model to the hand-knitted acrylic stockinette of `fabrics/acrylic-stockinette`, and prints
//! what it does against what was measured: `cargo run -p wale-lab --example network_fit -- [point|thick] [loop length in mm]`.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use wale::dynamics::tile_stiffness::TileStiffness;
use wale::pattern::{Chart, knit};
use wale::scene::Scene;
use wale_lab::fabric_file::FabricFile;
use wale_lab::network_fit::{NetworkFit, NetworkFitSettings, fit_network};
use wale_lab::shell::membrane_fit::MembraneFitSettings;
use wale_lab::shell::of_fabric::fit_shell;
use wale_lab::yarn_fit::Target;
use wale_lab::yarn_fit::of_fabric::uniform_targets;

fn main() -> Result<(), Box<dyn Error>> {
    let contacts = std::env::args().nth(1).unwrap_or_else(|| "thick".to_owned());
    let loop_length = std::env::args().nth(2).unwrap_or_else(|| "11.28".to_owned());
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fabrics/acrylic-stockinette/fabric.toml");
    let fabric = FabricFile::read(&folder)?;
    let targets = uniform_targets(&fabric, &fit_shell(&fabric, &MembraneFitSettings::default())?)?;
    let scene = format!(
        "schema = 1\n[yarn]\npreset = \"thick-acrylic\"\ndiameter = \"0.6 mm\"\n[fabric]\nloop_length = \"{loop_length} mm\"\ncontacts = \"{contacts}\"\n\
         [fabric.chart]\npattern = \"stockinette\"\ncolumns = 1\nrows = 1\n"
    );
    let scene = Scene::from_text(&scene, "network_fit.toml").map_err(|error| error.to_string())?;
    let card = scene.fabric.knit().ok_or("a chart makes a knit")?;
    let network = knit::tile(&Chart::stockinette(), card)?;
    let mut settings = NetworkFitSettings { max_evaluations: 100, ..NetworkFitSettings::default() };
    // Bending, spacing and legs, at first and stiffer.
    let corner = |start: usize, bit: usize, factor: f64| if (start >> bit) & 1 == 1 { factor } else { 1.0 };
    let start = |k: usize| [1.0, corner(k, 0, 8.0), 1.0, 1.0, corner(k, 1, 30.0), corner(k, 2, 10.0)];
    settings.starts = (0..8).map(start).collect();
    let begin = Instant::now();
    let fit = fit_network(&network, &scene.yarns, card, &targets, &settings)?;
    let given = TileStiffness::of(&network, &scene.yarns, &scene.fabric);
    println!("{contacts} contacts, loop length {loop_length} mm, fitted in {:.1} s", begin.elapsed().as_secs_f64());
    print(&fit, &targets, given);
    Ok(())
}

fn print(fit: &NetworkFit, targets: &[Target], given: [f64; TileStiffness::COUNT]) {
    println!("{:>9} {:>11} {:>11} {:>9} {:>9}", "stiffness", "given", "fitted", "factor", "within");
    for (k, kind) in fit.kinds.into_iter().enumerate().filter(|(k, _)| given[*k] > 0.0) {
        let (fitted, within) = (fit.stiffness[k], fit.within[k]);
        println!("{:>9} {:>11.3e} {fitted:>11.3e} {:>9.3} {within:>9.2}", kind.name(), given[k], fitted / given[k]);
    }
    println!("not determined: {:?}; at a bound: {:?}", fit.undetermined, fit.at_bound);
    println!(
        "relaxed wale and course spacing {:.2} {:.2} mm",
        1e3 * fit.rest.wale_spacing,
        1e3 * fit.rest.course_spacing
    );
    for (target, answers) in targets.iter().zip(&fit.answers) {
        println!(
            "at {:.0}° from the course: stretch, N/m measured and fitted, compression measured and fitted",
            target.angle.to_degrees()
        );
        for ([stretch, force, compression], answer) in target.points.iter().zip(answers) {
            let point = answer.point;
            println!("{stretch:>8.3} {force:>8.1} {:>8.1} {compression:>8.3} {:>8.3}", point.force, point.compression);
        }
    }
    let least = &fit.least_squares;
    println!(
        "cost {:.4} from {:.4}, {} evaluations, {} starts",
        least.cost, least.start_cost, least.evaluations, least.starts_that_ended
    );
    println!("errors at first {:?}", fit.start_error);
    println!("errors fitted   {:?}", fit.error);
}
