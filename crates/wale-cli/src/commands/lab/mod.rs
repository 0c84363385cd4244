//! `wale lab`: virtual textile tests of a fabric that was fitted.

mod bending;
mod card;
mod drape;
mod in_plane;
mod report;
mod shear;
mod sheet_picture;

use rayon::prelude::*;
use wale::picture::Series;
use wale_lab::shell::ShellError;

use crate::arguments::lab::{Common, Lab, Test};
use crate::exit::{Code, Failure};
use crate::machine;
use card::{Card, Needs, card};
use report::{Report, direction_name, refuse_taken};

/// Does a test.
pub fn lab(arguments: &Lab) -> Result<(), Failure> {
    const MEMBRANE: Needs = Needs { bending: false, mass: false };
    const BENDING: Needs = Needs { bending: true, mass: false };
    const HANGING: Needs = Needs { bending: true, mass: true };
    match &arguments.test {
        Test::Stretch(of) => {
            let needs = Needs { bending: of.wrinkle, mass: false };
            perform(&of.directed.common, "stretch", &[], needs, |card| in_plane::stretch(card, of, "stretch"))
        }
        Test::Strip(of) => {
            let needs = Needs { bending: of.wrinkle, mass: false };
            perform(&of.directed.common, "strip", &[], needs, |card| in_plane::stretch(card, of, "strip"))
        }
        Test::KesTensile(of) => {
            perform(&of.common, "kes-tensile", &[], MEMBRANE, |card| in_plane::kes_tensile(card, of))
        }
        Test::KesShear(of) => perform(&of.common, "kes-shear", &[], MEMBRANE, |card| shear::kes_shear(card, of)),
        Test::KesBending(of) => perform(&of.common, "kes-bending", &[], BENDING, |card| bending::kes_bending(card, of)),
        Test::Cantilever(of) => {
            perform(&of.directed.common, "cantilever", &[], HANGING, |card| bending::cantilever(card, of))
        }
        Test::PearLoop(of) => {
            perform(&of.directed.common, "pear-loop", &[], HANGING, |card| bending::pear_loop(card, of))
        }
        Test::Drape(of) => perform(&of.common, "drape", &drape::EXTRAS, HANGING, |card| drape::drape(card, of)),
        Test::PictureFrame(of) => {
            perform(&of.directed.common, "picture-frame", &[], MEMBRANE, |card| shear::picture_frame(card, of))
        }
        Test::BiasExtension(of) => {
            perform(&of.common, "bias-extension", &[], MEMBRANE, |card| shear::bias_extension(card, of))
        }
        Test::Fast(of) => perform(of, "fast", &[], HANGING, in_plane::fast),
    }
}

/// Looks for a place, then for the card, does the test and delivers what it reports.
fn perform(
    arguments: &Common,
    test: &'static str,
    extras: &[&'static str],
    needs: Needs,
    run: impl FnOnce(&Card) -> Result<Report, ShellError>,
) -> Result<(), Failure> {
    let card = card(arguments, needs)?;
    let folder = arguments.results.out.clone().unwrap_or_else(|| arguments.fabric.with_extension("lab"));
    refuse_taken(&folder, test, &Report::suffixes(extras), arguments.results.force)?;
    machine::use_threads(arguments.results.threads.map(usize::from))?;
    let mut report = run(&card).map_err(|error| {
        let code = match error {
            ShellError::Number { .. } | ShellError::Mesh(_) => Code::BadInput,
            _ => Code::NotConverged,
        };
        Failure::new(code, format_args!("{}: {error}", arguments.fabric.display()))
    })?;
    report.remarks.extend(card.remarks.iter().cloned());
    report.deliver(&card.title, &folder, arguments.results.json)
}

/// Directions that were asked for; weft, bias and warp if none was.
fn directions(asked: &[f64]) -> Vec<f64> {
    if asked.is_empty() { [0.0, 45.0, 90.0].map(f64::to_radians).to_vec() } else { asked.to_vec() }
}

/// A test in several directions at once, in their order.
fn in_directions<T: Send>(
    directions: &[f64],
    run: impl Fn(f64) -> Result<T, ShellError> + Sync,
) -> Result<Vec<(f64, T)>, ShellError> {
    directions.par_iter().map(|&angle| Ok((angle, run(angle)?))).collect()
}

/// A line of a plot, by direction.
fn line(angle: f64, points: impl Iterator<Item = [f64; 2]>) -> Series {
    let (xs, ys) = points.map(|[x, y]| (x, y)).unzip();
    Series { name: direction_name(angle), xs, ys }
}
