//! Woven fabrics, and yarns that are pulled.

use glam::DVec3;
use wale::model::{Network, PassId, YarnId, YarnRole};

use super::play::{Played, play_beside_others};

/// Energy of a kind at the step that ends nearest to a time \[J\].
fn energy_at(played: &Played, kind: &str, time: f64) -> f64 {
    let step = played.step_at(time);
    step.energies.iter().find(|(name, _)| *name == kind).unwrap().1
}

fn out_of(network: &Network, yarn: usize) -> (usize, usize) {
    let passes = network.yarn_passes(YarnId::new(yarn));
    let sliding = passes.clone().filter(|&p| network.pass_slides[p]).count();
    (passes.filter(|&p| network.slides(PassId::new(p))).count(), sliding)
}

#[test]
fn a_frame_that_closes_shears_the_weave_evenly_until_it_locks() {
    let played = play_beside_others("picture-frame.toml");
    let card = played.scene.fabric.woven().unwrap();
    // 21 × 21 crossings, of which those at the edges have half their neighbours, at corners a quarter.
    let unlocked = |time: f64| {
        let angle = (55.0 * time).to_radians();
        400.0 * 0.5 * card.shear_stiffness * card.spacing[0] * angle * angle
    };
    for time in [0.3, 0.6, 0.9] {
        let expected = unlocked(time);
        let found = energy_at(&played, "shear", time);
        assert!((found / expected - 1.0).abs() < 0.03, "{time}: {found} {expected}");
        assert!(energy_at(&played, "stretch", time) < 0.01 * found);
    }
    // Threads of a system lie side by side from 57° on: a frame that turns by 9° more has to do as much again.
    assert!((55.0..58.0).contains(&card.shear_jamming_angle.to_degrees()));
    let locked = energy_at(&played, "shear", 1.2) / unlocked(1.2);
    let force = |time: f64| played.step_at(time).grips[1].force.length();
    println!("locked: {locked:.2} times the energy, {:.3} N where it was {:.3} N", force(1.2), force(0.9));
    assert!(locked > 1.3 && force(1.2) > 4.0 * force(0.9));
}

#[test]
fn a_strip_on_the_bias_gives_until_its_threads_lie_side_by_side() {
    let played = play_beside_others("bias-extension.toml");
    let force = |time: f64| played.step_at(time).grips[1].force.y;
    // Nearly straight at first, then many times as stiff.
    let (soft, hard) = (force(0.6) / 0.6, (force(2.0) - force(1.8)) / 0.2);
    assert!(soft > 0.05 && hard > 10.0 * soft, "{soft} {hard} N/s");
    let width = |positions: &[DVec3]| {
        let middle = positions.iter().filter(|x| x.y.abs() < 3e-3).map(|x| x.x.abs());
        2.0 * middle.fold(0.0, f64::max)
    };
    let (before, after) = (width(&played.simulation.network().position), width(&played.frame().positions));
    assert!(after < 0.5 * before, "{before} {after}");
    assert!(played.steps.iter().all(|step| step.largest_stretch < 1.03));
}

#[test]
fn an_end_pulled_through_a_weave_leaves_work_behind() {
    let played = play_beside_others("yarn-pull.toml");
    // Both ends of the thread.
    let force = |time: f64| played.step_at(time).grips[2].force.y;
    // Sliding, each of fifteen picks holds it with μ λ.
    let card = played.scene.fabric.woven().unwrap();
    let expected = 15.0 * 0.3 * card.residual_compression;
    for time in [0.6, 0.7, 0.8] {
        assert!((force(time) / expected - 1.0).abs() < 0.2, "{time}: {} {expected}", force(time));
    }
    // On the way back it is held the other way; pulled again it comes back to what it was.
    for (time, sign) in [(1.4, -1.0), (1.5, -1.0), (1.6, -1.0), (2.3, 1.0), (2.4, 1.0)] {
        assert!((force(time) / (sign * expected) - 1.0).abs() < 0.25, "{time}: {} {expected}", force(time));
    }
    // Once around, from where it slides up to where it does so again, takes friction both ways, but for where the fabric gives.
    let work = |time: f64| played.step_at(time).grips[2].work;
    let (around, most) = (work(2.4) - work(0.8), 2.0 * 2.5e-3 * expected);
    println!("pulled: {:.2} mN, {:.2} of the work of sliding alone", 1e3 * force(0.8), around / most);
    assert!((0.6..1.2).contains(&(around / most)), "{around} {most}");
}

#[test]
fn a_snag_stays_and_draws_its_ends_in() {
    let played = play_beside_others("snag.toml");
    let (network, frame) = (played.simulation.network(), played.frame());
    let middle = &network.loops.iter().find(|info| (info.row, info.column) == (12, 12)).unwrap().nodes;
    let node = middle[0].index();
    assert!(frame.positions[node].z > 1e-3, "{}", frame.positions[node]);
    let ends = |yarn: usize| {
        let passes = network.yarn_passes(YarnId::new(yarn));
        let at = |p: usize| frame.positions[network.pass_node[p].index()];
        at(passes.start).distance(at(passes.end - 1))
    };
    assert!(ends(12) < ends(3) - 0.5e-3, "{} {}", ends(12), ends(3));
}

#[test]
fn picks_drawn_out_of_an_edge_leave_a_fringe() {
    let played = play_beside_others("frayed-edge.toml");
    let network = played.simulation.network();
    let wefts: Vec<usize> = (0..network.yarn_count()).filter(|&y| network.yarn_role[y] == YarnRole::Weft).collect();
    assert_eq!(out_of(network, wefts[0]), (0, 16));
    let (left, all) = out_of(network, wefts[1]);
    assert!(left < all, "{left} of {all}");
    for &weft in &wefts[2..] {
        assert_eq!(out_of(network, weft), (16, 16));
    }
}

#[test]
fn a_row_is_pulled_out_whole() {
    let played = play_beside_others("row-pull-out.toml");
    let (network, frame) = (played.simulation.network(), played.frame());
    let row = (0..network.yarn_count()).find(|&y| network.yarn_kind[y] == 1).unwrap();
    assert_eq!(out_of(network, row).0, 0, "contacts are left");
    let passes = network.yarn_passes(YarnId::new(row));
    let at = |p: usize| frame.positions[network.pass_node[p].index()];
    let strand = at(passes.start).distance(at(passes.end - 1));
    let yarn = network.length_of(YarnId::new(row));
    // A straight strand, as long as its ten loops and short ends.
    assert!((strand / yarn - 1.0).abs() < 0.02, "{strand} {yarn}");
    let loops = 10.0 * played.scene.fabric.knit().unwrap().loop_length;
    assert!(yarn > loops && yarn < 1.1 * loops, "{yarn} {loops}");
    // The pass of every contact that it left is known by its arc length, and the rows beside it keep all others.
    let others: usize = (0..network.yarn_count()).filter(|&y| y != row).map(|y| out_of(network, y).0).sum();
    assert!(others > 200, "{others}");
}

#[test]
fn a_weave_on_a_ball_shears() {
    let played = play_beside_others("weave-drape.toml");
    let (network, frame) = (played.simulation.network(), played.frame());
    assert!(played.steps.iter().all(|step| step.largest_stretch < 1.02));
    let yarn_of = network.pass_yarn();
    let along = |pass: PassId| {
        let near = |step| network.neighbour(yarn_of[pass.index()], pass, step).map(|near| near.pass);
        let at = |pass: PassId| frame.positions[network.pass_node[pass.index()].index()];
        (at(near(1).unwrap()) - at(near(-1).unwrap())).normalize()
    };
    let sheared = network.crossings.iter().map(|crossing| along(crossing.warp).dot(along(crossing.weft)).abs().asin());
    // A sheet that cannot shear, as paper, would fold and keep its right angles.
    let most = sheared.fold(0.0, f64::max).to_degrees();
    assert!((5.0..80.0).contains(&most), "{most} degrees");
    let heights = frame.positions.iter().map(|x| x.z);
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), z| (a.min(z), b.max(z)));
    assert!(high < 21e-3 && low < 8e-3, "{low} {high}");
}
