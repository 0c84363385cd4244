//! Which tests are made by which models, and how.

use super::fabric::Specimen;
use super::failure::TestFailure;
use super::report::Report;
use super::{bending, drape, in_plane, shear, tiles, yarns};
use crate::arguments::lab::{By, Test};

/// The model that suits a test best.
pub fn usual(test: &Test) -> By {
    match test {
        Test::Curl(_) => By::Yarns,
        Test::Relaxation(_) => By::Contacts,
        _ => By::Shell,
    }
}

/// Directions in degrees from the weft that are tested if none is asked for, as angles \[rad\].
pub fn usual_directions(test: &Test, by: By) -> Vec<f64> {
    let degrees: &[f64] = match (test, by) {
        // Bars lie along the weft and the warp.
        (Test::PictureFrame(_), _) => &[0.0],
        // On the bias shear compresses yarns, which a specimen that is kept flat may not bear: only who asks gets it.
        (Test::KesShear(_), _) => &[0.0, 90.0],
        // A swatch of yarns is clamped along its courses or its wales.
        (_, By::Yarns) => &[0.0, 90.0],
        _ => &[0.0, 45.0, 90.0],
    };
    degrees.iter().map(|angle| angle.to_radians()).collect()
}

/// Why a test is not made by a model, in words that follow the test's name.
pub fn cannot(test: &Test, by: By) -> Option<&'static str> {
    match (by, test) {
        (By::Shell, Test::Curl(_)) => Some("is not made by shell, which is flat at rest: use --by yarns or --by tile"),
        (By::Shell, Test::Relaxation(_)) => {
            Some("is not made by shell, which is at rest as it is: use --by contacts or --by yarns")
        }
        (By::Tile | By::Contacts, Test::Drape(_) | Test::PearLoop(_)) => {
            Some("is not made by a tile, which is without end: nothing of it can hang or fold; use --by shell")
        }
        (By::Tile | By::Contacts, Test::BiasExtension(_)) => Some(
            "is not made by a tile, which has no clamps and so no zones; use `strip --direction bias`, or --by shell",
        ),
        (By::Tile, Test::Relaxation(_)) => {
            Some("is not made by tile: its rest shapes are estimated from the size that it is given; use --by contacts")
        }
        (
            By::Contacts,
            Test::KesShear(_) | Test::KesBending(_) | Test::Cantilever(_) | Test::PictureFrame(_) | Test::Curl(_),
        ) => Some("is not made by contacts, whose tile is stretched along one direction alone; use --by tile"),
        (By::Tile | By::Contacts | By::Yarns, Test::Stretch(of) | Test::Strip(of)) if of.wrinkle => {
            Some("with --wrinkle is made by shell alone")
        }
        (By::Yarns, Test::Stretch(_) | Test::Strip(_) | Test::KesTensile(_)) => None,
        (By::Yarns, Test::Curl(_) | Test::Relaxation(_)) => None,
        (By::Yarns, _) => {
            Some("is not made by yarns: stretch, strip, kes-tensile, curl and relaxation are; scenes do whatever else")
        }
        _ => None,
    }
}

/// Does a test.
///
/// # Errors
/// [`TestFailure`].
pub fn run(test: &Test, specimen: &Specimen, title: &str) -> Result<Report, TestFailure> {
    let by = match specimen {
        Specimen::Shell(_) => By::Shell,
        Specimen::Tile(..) => By::Tile,
        Specimen::Contacts(_) => By::Contacts,
        Specimen::Yarns(_) => By::Yarns,
    };
    // A question from elsewhere may ask for anything.
    if let Some(why) = cannot(test, by) {
        return Err(TestFailure::bad_input(format_args!("{} {why}", test.name())));
    }
    let card = match specimen {
        Specimen::Shell(card) => card,
        Specimen::Tile(tested, mass) => return tiles::run(test, tested, *mass, title),
        Specimen::Contacts(scene) => return tiles::run_contacts(test, scene, title),
        Specimen::Yarns(scene) => return yarns::run(test, scene, title),
    };
    let mut report = match test {
        Test::Stretch(of) => in_plane::stretch(card, of, "stretch"),
        Test::Strip(of) => in_plane::stretch(card, of, "strip"),
        Test::KesTensile(of) => in_plane::kes_tensile(card, of),
        Test::KesShear(of) => shear::kes_shear(card, of),
        Test::KesBending(of) => bending::kes_bending(card, of),
        Test::Cantilever(of) => bending::cantilever(card, of),
        Test::PearLoop(of) => bending::pear_loop(card, of),
        Test::Drape(of) => drape::drape(card, of),
        Test::PictureFrame(of) => shear::picture_frame(card, of),
        Test::BiasExtension(of) => shear::bias_extension(card, of),
        Test::Fast(_) => in_plane::fast(card),
        Test::Curl(_) | Test::Relaxation(_) => Err(TestFailure::bad_input("a shell is not tested so")),
    }?;
    report.remarks.extend(card.remarks.iter().cloned());
    Ok(report)
}
