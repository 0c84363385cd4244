//! Knits that curl, stretch, drape and are lace.

use wale::model::LoopInfo;
use wale::simulation::Simulation;

use super::play::{Played, play_beside_others};

#[test]
fn stockinette_curls_and_garter_lies_flat() {
    let curl = play_beside_others("stockinette-curl.toml");
    println!("stockinette: {:?}, speed {:.1} mm/s", curl.last, 1e3 * curl.speed);
    assert!(curl.last.end_edges.wale_per_m > 50.0, "positive is to the front");
    assert!(curl.last.side_edges.course_per_m.abs() < 0.1 * curl.last.end_edges.wale_per_m, "a roll is straight");
    assert!(curl.speed < 0.02, "it is at rest, but for {} m/s", curl.speed);
    assert!(curl.last.extent_m[1] < 0.5 * curl.first.extent_m[1], "rolled up from both ends");

    let garter = play_beside_others("garter-flat.toml");
    println!("garter: {:?}, speed {:.1} mm/s", garter.last, 1e3 * garter.speed);
    assert!(garter.last.curvature.wale_per_m.abs() < 0.05 * curl.last.end_edges.wale_per_m);
    assert!(garter.last.curvature.course_per_m.abs() < 0.05 * curl.last.end_edges.wale_per_m);
}

#[test]
fn hanging_stockinette_rolls_to_the_front_below_and_to_the_back_beside() {
    let hung = play_beside_others("stockinette-hanging.toml");
    println!("hung: {:?}, speed {:.1} mm/s", hung.last, 1e3 * hung.speed);
    assert!(hung.last.end_edges.wale_per_m > 50.0, "positive is to the front");
    assert!(hung.last.side_edges.course_per_m < -20.0, "negative is to the back");
    assert!(hung.speed < 0.02, "it is at rest, but for {} m/s", hung.speed);
}

#[test]
fn the_sides_of_stockinette_roll_to_the_back() {
    let sides = play_beside_others("stockinette-sides.toml");
    println!("held at both ends: {:?}, speed {:.1} mm/s", sides.last, 1e3 * sides.speed);
    assert!(sides.last.side_edges.course_per_m < -30.0, "negative is to the back");
    assert!(sides.last.curvature.wale_per_m.abs() < 0.2 * sides.last.side_edges.course_per_m.abs());
}

#[test]
fn thick_contacts_roll_the_ends_of_stockinette_to_the_front() {
    let thick = play_beside_others("thick-contacts.toml");
    println!("thick contacts: {:?}, speed {:.1} mm/s", thick.last, 1e3 * thick.speed);
    assert!(thick.last.end_edges.wale_per_m > 50.0, "positive is to the front");
    let stretch = thick.steps.iter().fold(0.0f64, |most, step| most.max(step.largest_stretch));
    assert!(stretch < 1.1, "yarns are as long as they are: {stretch}");
}

#[test]
fn a_rib_unfolds_then_slides_then_stretches() {
    let rib = play_beside_others("rib-stretch.toml");
    // Slopes of the force in the three regimes [N/m]: the grip moves 60 mm a second.
    let slope = |from: f64, to: f64| (rib.force_at(1, to / 60.0) - rib.force_at(1, from / 60.0)) / (1e-3 * (to - from));
    let (unfolding, sliding, stretching) = (slope(5.0, 30.0), slope(45.0, 80.0), slope(120.0, 150.0));
    println!("rib: {unfolding:.1}, {sliding:.1}, {stretching:.1} N/m");
    assert!(sliding > 1.5 * unfolding && stretching > 5.0 * sliding);
    let kind = |name: &str| {
        let last = rib.steps.last().unwrap();
        last.energies.iter().find(|(kind, _)| *kind == name).unwrap().1
    };
    assert!(kind("stretch") > 3.0 * kind("bending"), "at the end it is the yarn that is stretched");
}

#[test]
fn a_long_pull_leaves_a_set_and_a_small_one_none() {
    let (long, small) = (play_beside_others("permanent-set.toml"), play_beside_others("small-pull.toml"));
    let widening = long.last.wale_spacing_m / small.last.wale_spacing_m - 1.0;
    println!(
        "wale spacing: {:.2} mm laid out, {:.2} mm after a small pull, {:.2} mm after a long one: {:+.1} %",
        1e3 * small.first.wale_spacing_m,
        1e3 * small.last.wale_spacing_m,
        1e3 * long.last.wale_spacing_m,
        100.0 * widening
    );
    assert!(widening > 0.05);
    assert!((small.last.wale_spacing_m / small.first.wale_spacing_m - 1.0).abs() < 0.5 * widening);
}

#[test]
fn a_loop_of_loading_and_unloading_takes_work() {
    let pulled = play_beside_others("load-unload.toml");
    let most = pulled.steps.iter().map(|step| step.grips[1].work).fold(0.0, f64::max);
    let left = pulled.steps.last().unwrap().grips[1].work;
    let (out, back) = (pulled.force_at(1, 0.7), pulled.force_at(1, 1.3));
    println!(
        "work {:.2} mJ out, {:.2} mJ not returned; force at 21 mm {out:.2} N out, {back:.2} N back",
        1e3 * most,
        1e3 * left
    );
    assert!(left > 0.1 * most && back < 0.8 * out);
}

#[test]
fn garter_comes_to_rest_on_a_ball() {
    let ball = play_beside_others("garter-on-ball.toml");
    println!("garter on a ball: {} steps, speed {:.2} mm/s, {:?}", ball.steps.len(), 1e3 * ball.speed, ball.last);
    assert!(ball.speed < 0.02, "{} m/s", ball.speed);
    assert!(ball.steps.last().unwrap().contacts > 100);
    assert!(ball.last.extent_m[2] > 0.03, "it hangs down around the ball");
    assert!(ball.steps.last().unwrap().largest_stretch < 1.2);
}

#[test]
fn rest_shape_compensation_keeps_the_size() {
    // Height of the hanging fabric at the end over that of its layout.
    let shrinkage = |played: &Played| 1.0 - played.last.extent_m[2] / played.first.extent_m[2];
    let (with, without) = (play_beside_others("rest-shape-with.toml"), play_beside_others("rest-shape-without.toml"));
    println!("shrinkage {:.1} % with, {:.1} % without", 100.0 * shrinkage(&with), 100.0 * shrinkage(&without));
    assert!(with.start.compensation.is_some() && without.start.compensation.is_none());
    assert!(shrinkage(&with).abs() < 0.03 && shrinkage(&without).abs() > 3.0 * shrinkage(&with).abs());
}

/// How far the loops of a row lie above and below its mean, by their place in a repeat of so many columns \[m\].
fn wave(simulation: &Simulation, row: u32, repeat: u32) -> f64 {
    swing(simulation, repeat, 1, |info| (info.row == row).then_some(info.column))
}

/// The same of the loops of the first column, to the left and the right, in a repeat of so many rows.
fn wave_of_side(simulation: &Simulation, repeat: u32) -> f64 {
    swing(simulation, repeat, 0, |info| (info.column == 0).then_some(info.row))
}

/// How far loops lie apart along an axis, each the mean of those at its place in a repeat \[m\].
fn swing(simulation: &Simulation, repeat: u32, axis: usize, place: impl Fn(&LoopInfo) -> Option<u32>) -> f64 {
    let frame = simulation.frame();
    let mut means = vec![(0.0, 0_u32); repeat as usize];
    for info in simulation.network().loops.iter().filter(|info| !info.nodes.is_empty()) {
        let Some(place) = place(info) else { continue };
        let along = info.nodes.iter().map(|node| frame.positions[node.index()][axis]);
        let at = &mut means[(place % repeat) as usize];
        *at = (at.0 + along.sum::<f64>() / info.nodes.len() as f64, at.1 + 1);
    }
    let means: Vec<f64> = means.iter().filter(|at| at.1 > 0).map(|at| at.0 / f64::from(at.1)).collect();
    means.iter().copied().fold(f64::MIN, f64::max) - means.iter().copied().fold(f64::MAX, f64::min)
}

#[test]
fn feather_and_fan_waves() {
    let lace = play_beside_others("feather-and-fan.toml");
    // Plain rows below and above the eyelets.
    let waves = [16, 17, 19].map(|row| wave(&lace.simulation, row, 18));
    println!("feather and fan: waves of {waves:.4?} m, speed {:.1} mm/s, {:?}", 1e3 * lace.speed, lace.last);
    assert!(waves.iter().all(|wave| *wave > 2.0 * lace.last.course_spacing_m), "{waves:?}");
    assert!(lace.steps.last().unwrap().largest_stretch < 1.2);
}

#[test]
fn lace_that_cannot_curl_waves_along_its_rows_and_its_sides() {
    for (name, [columns, rows]) in [("flame-chevron-relaxed.toml", [7, 24]), ("open-diamonds-relaxed.toml", [8, 12])] {
        let lace = play_beside_others(name);
        let (row, side) = (wave(&lace.simulation, rows / 2, columns), wave_of_side(&lace.simulation, rows));
        let [wale, course] = [lace.last.wale_spacing_m, lace.last.course_spacing_m];
        println!("{name}: {row:.4} and {side:.4} m, loops {wale:.4} by {course:.4}, {:.1} mm/s", 1e3 * lace.speed);
        assert!(row > 0.5 * course && side > wale, "{name}: {row} {side}");
        assert!(lace.speed < 0.03 && lace.steps.last().unwrap().largest_stretch < 1.2, "{name}");
        // Yarn-overs stay open: the fabric is no thicker than the plates are apart.
        assert!(lace.last.extent_m[2] < 6e-3, "{name}: {:?}", lace.last.extent_m);
    }
}

#[test]
fn tucks_berries_and_stripes_lie_as_cloth() {
    for name in ["fishermans-rib.toml", "bramble.toml", "garter-stripes.toml"] {
        let played = play_beside_others(name);
        let last = played.steps.last().unwrap();
        println!(
            "{name}: speed {:.1} mm/s, stretch {:.3}, {:?}",
            1e3 * played.speed,
            last.largest_stretch,
            played.last
        );
        assert!(last.largest_stretch < 1.2 && played.speed < 0.05, "{name}");
        let [width, height] = [0, 1].map(|axis| played.last.extent_m[axis] / played.first.extent_m[axis]);
        assert!((0.8..1.25).contains(&width) && (0.8..1.25).contains(&height), "{name}: {width} {height}");
        assert!(played.last.extent_m[2] < 0.35 * played.last.extent_m[1], "{name} lies on the table");
    }
}

#[test]
fn a_machines_program_becomes_cloth() {
    let sampler = play_beside_others("machine-sampler.toml");
    let last = sampler.steps.last().unwrap();
    println!("sampler: speed {:.1} mm/s, stretch {:.3}, {:?}", 1e3 * sampler.speed, last.largest_stretch, sampler.last);
    assert!(last.largest_stretch < 1.2);
}
