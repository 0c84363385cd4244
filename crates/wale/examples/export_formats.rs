//! Writes a small stockinette, rolled up by hand, in every format: the files that `tools/check_usd.py` opens.
//!
//! `cargo run -p wale --example export_formats -- FOLDER`

use std::error::Error;
use std::path::PathBuf;

use glam::DVec3;
use wale::dynamics::tile_equilibrium::{TileSettings, relax_tile};
use wale::export::{Format, FrameSnapshots, Settings, Snapshot, write};
use wale::fabric::TileCoordinates;
use wale::geometry::CurveSettings;
use wale::model::{Frame, KnitCard, Network, YarnCard};
use wale::pattern::{Chart, Working, knit};

const LOOP: f64 = 10e-3;
const RADIUS: f64 = 0.03 * LOOP;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("name the folder to write to")?);
    std::fs::create_dir_all(&folder)?;
    let (yarn, card) = cards();
    let settings = Settings { plies: 2, twist: 250.0, ..Settings::default() };

    let network = knit::fabric(&Chart::stockinette().repeat(8, 6)?, Working::default(), &card);
    for format in Format::ALL {
        let count = if matches!(format, Format::Obj | Format::Ply) { 1 } else { 6 };
        let mut frames = FrameSnapshots {
            network: &network,
            settings: CurveSettings::new(RADIUS),
            count,
            read: |k| Ok(rolled(&network, k as f64 / 24.0)),
        };
        let path = folder.join("rolled").with_extension(format.extension());
        report(write(&path, format, &mut frames, &settings)?);
    }

    for (name, chart) in [("stockinette", Chart::stockinette()), ("rib", Chart::rib(2, 2)?)] {
        let tile = relaxed(&chart, &yarn, &card);
        for format in [Format::Ply, Format::Usda] {
            let path = folder.join(name).with_extension(format.extension());
            report(write(&path, format, &mut vec![tile.clone()], &settings)?);
        }
    }
    Ok(())
}

fn report(files: Vec<PathBuf>) {
    if let Some(file) = files.last() {
        println!("{} ({} files)", file.display(), files.len());
    }
}

/// The fabric wound about the y axis, tighter with time.
fn rolled(network: &Network, time: f64) -> Frame {
    let curvature = 1e-6 + 300.0 * time;
    let roll = |x: &DVec3| {
        let (sin, cos) = (x.x * curvature).sin_cos();
        DVec3::new(sin, 0.0, cos) * (1.0 / curvature + x.z) + DVec3::new(0.0, x.y, -1.0 / curvature)
    };
    Frame { time, positions: network.position.iter().map(roll).collect(), sliding: network.arc_length.clone() }
}

/// A relaxed tile, laid out a few times along course and wale.
fn relaxed(chart: &Chart, yarn: &YarnCard, card: &KnitCard) -> Snapshot {
    let network = knit::tile(chart, card).expect("the repeat has no end");
    let rest = relax_tile(&network, yarn, card, &TileSettings::of(card));
    let periods = [
        DVec3::X * rest.wale_spacing * chart.column_count() as f64,
        DVec3::Y * rest.course_spacing * chart.row_count() as f64,
    ];
    let frame = TileCoordinates::new(&network).own().frame(0.0, &rest.coordinates);
    let one = Snapshot::of(&network, &frame, &CurveSettings { periods: Some(periods), ..CurveSettings::new(RADIUS) });
    let mut many = Snapshot { curves: Vec::new(), ..one.clone() };
    for (i, j) in (0..8).flat_map(|i| (0..6).map(move |j| (i, j))) {
        for curve in &one.curves {
            let mut copy = curve.clone();
            for point in &mut copy.points {
                *point += periods[0] * f64::from(i) + periods[1] * f64::from(j);
            }
            many.curves.push(copy);
        }
    }
    many
}

/// A soft wool: weak wrap, rest bend angles by pass.
fn cards() -> (YarnCard, KnitCard) {
    let bending = 1e-9;
    let force = bending / (LOOP * LOOP);
    let stitch = 0.107 * LOOP;
    let yarn = YarnCard {
        linear_density: 1e-4,
        radius: RADIUS,
        stretch_stiffness: 3e4 * force,
        bending_stiffness: bending,
        friction_coefficient: 0.3,
        mass_damping: 1.0,
        stiffness_damping: 0.0,
        loose_ends: false,
        plies: 2,
        twist: 250.0,
    };
    let card = KnitCard {
        loop_length: LOOP,
        path_ratio: 1.0,
        transition_length: 0.085,
        stitch_length: stitch,
        wale_spacing: 0.317 * LOOP,
        course_spacing: 0.241 * LOOP,
        wrapping_stiffness: 2.1 * bending / (LOOP * stitch),
        wrapping_angle_course: 2.15,
        wrapping_angle_leg: 1.62,
        bend_angle_foot_head: 0.43,
        bend_angle_leg: 1.10,
        length_stiffness: 3e4 * force,
        spacing_stiffness: 2e3 * force,
        spacing_leg: 0.221 * LOOP,
        spacing_head_sinker: 0.073 * LOOP,
        thickness: None,
        anchor_stiffness: 1.0,
        residual_compression: 0.0,
    };
    (yarn, card)
}
