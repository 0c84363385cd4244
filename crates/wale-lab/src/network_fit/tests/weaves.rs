//! Weaves: straight threads that cross, of which the answers are known.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use std::path::Path;

use wale::dynamics::stretched_tile::{StretchError, StretchedEquilibrium, StretchedTile, TileReference};
use wale::dynamics::tile_equilibrium::{TileSettings, relax_tile};
use wale::dynamics::tile_stiffness::TileStiffness;
use wale::model::{Network, WovenCard, YarnCard, Yarns};
use wale::pattern::weave::{self, Draft, peirce};
use wale::scene::Scene;

use super::{pulled, yarn};
use crate::fabric_file::{FabricFile, Structure};
use crate::network_fit::{
    NetworkFitSettings, NetworkProblem, NetworkPull, NetworkPullSettings, fit_network, fit_scene, relaxed_reference,
};
use crate::shell::membrane_fit::MembraneFitSettings;
use crate::shell::of_fabric::fit_shell;
use crate::shell::{StretchCurve, StretchPoint};
use crate::yarn_fit::of_fabric::uniform_targets;
use crate::yarn_fit::{Answer, Target};

const P: usize = TileStiffness::COUNT;
/// Distance of ends, and of picks \[m\].
const SPACING: [f64; 2] = [0.5e-3, 0.6e-3];

/// Cotton of the warp, and softer cotton of the weft.
fn threads() -> [YarnCard; 2] {
    let warp = YarnCard { radius: 0.135e-3, stretch_stiffness: 50.0, bending_stiffness: 5e-9, ..yarn() };
    let weft = YarnCard { stretch_stiffness: 30.0, bending_stiffness: 3e-9, ..warp.clone() };
    [warp, weft]
}

pub(super) fn weave_of(draft: &Draft) -> (Network, Yarns, WovenCard) {
    let [warp, weft] = threads();
    let geometry = peirce::geometry(draft, [&warp, &weft], SPACING).unwrap();
    let card = WovenCard::new(&warp, &weft, &geometry);
    (weave::tile(draft, SPACING).unwrap(), Yarns::new(warp, [weft]), card)
}

fn at_sett(draft: &Draft) -> TileReference {
    let (network, yarns, card) = weave_of(draft);
    reference(&network, &yarns, &card).unwrap()
}

fn reference(network: &Network, yarns: &Yarns, card: &WovenCard) -> Result<TileReference, StretchError> {
    let settings = TileSettings { tolerance: 2e-9, ..TileSettings::of(card) };
    TileReference::new(network, yarns, card, &settings, relax_tile(network, yarns, card, &settings))
}

/// Plain weave, twill, satin, and a warp rib of one end.
fn drafts() -> [Draft; 4] {
    let rib = Draft::new(vec![vec![true], vec![false], vec![false]]).unwrap();
    [Draft::plain(), Draft::twill(2, 1).unwrap(), Draft::satin(5, 2).unwrap(), rib]
}

/// Energy by area of threads that stay straight and cross where they are, at a stretch along an angle and a compression across.
fn even(card: &WovenCard, angle: f64, stretch: f64, compression: f64) -> f64 {
    let (sine, cosine) = angle.sin_cos();
    let (along, across) = (1.0 + stretch, 1.0 - compression);
    let mixed = (along - across) * sine * cosine;
    let weft = [along * cosine * cosine + across * sine * sine, mixed];
    let warp = [mixed, along * sine * sine + across * cosine * cosine];
    let lengths = [warp, weft].map(|[x, y]: [f64; 2]| x.hypot(y));
    let between = (warp[0] * weft[0] + warp[1] * weft[1]) / (lengths[0] * lengths[1]);
    let sheared = between.asin().abs();
    let over = (sheared - card.shear_jamming_angle).max(0.0);
    let pitch = 0.5 * (SPACING[0] + SPACING[1]);
    let shear = 0.5 * card.shear_stiffness * pitch * (sheared.powi(2) + 200.0 * over.powi(3));
    let yarns = threads().map(|yarn| yarn.stretch_stiffness);
    let stretch = (0..2).map(|k| 0.5 * yarns[k] * (lengths[k] - 1.0).powi(2) / SPACING[k]).sum::<f64>();
    stretch + shear / (SPACING[0] * SPACING[1])
}

/// Stress and the compression of least energy, by differences and bisection.
fn known(card: &WovenCard, angle: f64, stretch: f64) -> [f64; 2] {
    let h = 1e-6;
    let across = |c: f64| even(card, angle, stretch, c + h) - even(card, angle, stretch, c - h);
    let (mut low, mut high) = (-0.3, 0.8);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if across(middle) < 0.0 { low = middle } else { high = middle }
    }
    let stress = (even(card, angle, stretch + h, low) - even(card, angle, stretch - h, low)) / (2.0 * h);
    [stress, low]
}

#[test]
fn a_weave_is_at_rest_at_its_sett() {
    for draft in drafts() {
        let found = at_sett(&draft);
        assert_eq!((found.rest().iterations, found.rest().energy < 1e-20), (0, true), "{:?}", found.rest());
        assert!((found.rest().wale_spacing / SPACING[0] - 1.0).abs() < 1e-12);
        assert!((found.rest().course_spacing / SPACING[1] - 1.0).abs() < 1e-12);
        assert_eq!(found.size_slopes(), Some([[0.0; P]; 2]));
    }
}

#[test]
fn along_its_threads_a_weave_bears_what_they_do_and_nothing_across() {
    let [warp, weft] = threads().map(|yarn| yarn.stretch_stiffness);
    for draft in drafts() {
        let reference = at_sett(&draft);
        for (angle, by_width) in [(0.0, weft / SPACING[1]), (FRAC_PI_2, warp / SPACING[0])] {
            let (_, held) = pulled(&reference, angle, 0.1, Some(0.0));
            assert!((held.stress / (0.1 * by_width) - 1.0).abs() < 1e-9, "{held:?}");
            assert!(held.stress_across.abs() < 1e-9 * held.stress, "{held:?}");
            let (_, free) = pulled(&reference, angle, 0.1, None);
            assert!((free.stress / held.stress - 1.0).abs() < 1e-9 && free.compression.abs() < 1e-9, "{free:?}");
        }
    }
}

#[test]
fn on_the_bias_a_weave_shears_at_first_and_locks_at_its_jamming_angle() {
    let (network, yarns, card) = weave_of(&Draft::twill(2, 1).unwrap());
    let reference = reference(&network, &yarns, &card).unwrap();
    // With u = s − c threads stretch by u/2, with v = s + c they shear by v: W = ½ K (u/2)² + ½ G v² is least across at σ = 2 G v.
    let [warp, weft] = threads().map(|yarn| yarn.stretch_stiffness);
    let stretch = warp / SPACING[0] + weft / SPACING[1];
    let shear = card.shear_stiffness * 0.5 * (SPACING[0] + SPACING[1]) / (SPACING[0] * SPACING[1]);
    let (_, small) = pulled(&reference, FRAC_PI_4, 1e-4, None);
    let wanted = 4.0 * shear * 1e-4 / (1.0 + 4.0 * shear / stretch);
    assert!((small.stress / wanted - 1.0).abs() < 1e-3, "{small:?} {wanted}");
    // Threads of constant length shear by ψ = π/2 − 2 acos((1 + s)/√2), and store ½ G ψ².
    let at = |stretch: f64| pulled(&reference, FRAC_PI_4, stretch, None).1;
    let half = |stretch: f64| ((1.0 + stretch) / 2f64.sqrt()).acos();
    let trellis =
        |stretch: f64| shear * (FRAC_PI_2 - 2.0 * half(stretch)) * 2.0 / (2.0 - (1.0 + stretch).powi(2)).sqrt();
    let locked = 2f64.sqrt() * (0.5 * (FRAC_PI_2 - card.shear_jamming_angle)).cos() - 1.0;
    for stretch in [0.2 * locked, 0.5 * locked] {
        let found = at(stretch);
        assert!((found.stress / trellis(stretch) - 1.0).abs() < 0.03, "{found:?} {}", trellis(stretch));
    }
    // Jammed, they turn little more: W = ½ K (λ − 1)², λ = (1 + s)/(√2 cos α) at the angle α of a thread from the pull.
    let slope = |stretch: f64| (at(stretch + 1e-3).stress - at(stretch - 1e-3).stress) / 2e-3;
    let of_threads = 0.5 * stretch / (0.5 * (FRAC_PI_2 - card.shear_jamming_angle)).cos().powi(2);
    let far = 1.3 * locked;
    let found = at(far);
    let sheared = FRAC_PI_2 - 2.0 * ((1.0 - found.compression) / (1.0 + far)).atan();
    assert!(sheared > card.shear_jamming_angle && sheared < card.shear_jamming_angle + 0.15, "{sheared}");
    assert!((slope(far) / of_threads - 1.0).abs() < 0.2, "{} {of_threads}", slope(far));
    assert!(slope(0.5 * locked) < 0.03 * of_threads);
}

#[test]
fn every_crossing_moves_as_the_plane_does() {
    // Elsewhere threads of one system are pushed together, as F has no shear by itself: near a thread little enough not to buckle.
    let pulls =
        [0.0, FRAC_PI_4, FRAC_PI_2].into_iter().flat_map(|angle| [0.02, 0.15, 0.5].map(|stretch| (angle, stretch)));
    let pulls: Vec<_> = pulls.chain([(0.08, 0.02), (1.5, 0.02)]).collect();
    for draft in drafts() {
        let (network, yarns, card) = weave_of(&draft);
        let reference = reference(&network, &yarns, &card).unwrap();
        for &(angle, stretch) in &pulls {
            let (mut tile, found) = pulled(&reference, angle, stretch, None);
            let [stress, compression] = known(&card, angle, stretch);
            assert!((found.stress / stress - 1.0).abs() < 1e-5, "{angle} {stretch}: {found:?} {stress}");
            assert!((found.compression - compression).abs() < 1e-6, "{angle} {stretch}: {found:?} {compression}");
            assert!(tile.slopes(None).unwrap().stable, "{angle} {stretch}");
        }
    }
}

#[test]
fn a_doubled_tile_of_a_weave_bears_the_same() {
    let twill = Draft::twill(2, 1).unwrap();
    let one = at_sett(&twill);
    let more = at_sett(&twill.repeat(6, 3).unwrap());
    assert!((more.area() / one.area() - 2.0).abs() < 1e-12);
    for angle in [0.0, FRAC_PI_4, FRAC_PI_2] {
        let [(_, a), (_, b)] = [&one, &more].map(|reference| pulled(reference, angle, 0.3, None));
        assert!(
            (b.stress / a.stress - 1.0).abs() < 1e-9 && (b.compression - a.compression).abs() < 1e-9,
            "{a:?} {b:?}"
        );
    }
}

/// The fabric with one stiffness changed by a factor, its tile at rest where it was.
fn changed(reference: &TileReference, draft: &Draft, k: usize, factor: f64) -> TileReference {
    let (network, yarns, card) = weave_of(draft);
    let mut stiffness = TileStiffness::of(&network, &yarns, &(&card).into());
    stiffness[k] *= factor;
    let (yarns, other) = TileStiffness::with(&network, &yarns, &(&card).into(), stiffness);
    let settings = TileSettings { tolerance: 2e-9, ..TileSettings::of(&card) };
    TileReference::new(&network, &yarns, &other, &settings, reference.rest().clone()).unwrap()
}

/// Checks the slopes of stress and compression against differences; gives the logarithmic slopes of the stress over the stress.
fn check_slopes(
    reference: &TileReference,
    draft: &Draft,
    pull: impl Fn(&TileReference) -> (StretchedTile, StretchedEquilibrium),
) -> [f64; P] {
    let (mut tile, found) = pull(reference);
    let slopes = tile.slopes(reference.size_slopes().as_ref()).unwrap();
    assert!(slopes.stable);
    let stiffness = reference.stiffness();
    std::array::from_fn(|k| {
        let h: f64 = 1e-3;
        let [low, high] = [(-h).exp(), h.exp()].map(|factor| pull(&changed(reference, draft, k, factor)).1);
        let [by_stress, by_compression] = [slopes.stress[k], slopes.compression[k]].map(|slope| slope * stiffness[k]);
        let [stress, compression] =
            [high.stress - low.stress, high.compression - low.compression].map(|d| d / (2.0 * h));
        assert!((by_stress - stress).abs() < 1e-6 * found.stress.abs(), "{k}: {by_stress} {stress} of {found:?}");
        assert!((by_compression - compression).abs() < 1e-6, "{k}: {by_compression} {compression} of {found:?}");
        by_stress / found.stress
    })
}

#[test]
fn slopes_of_a_weave_are_differences() {
    let draft = Draft::twill(2, 1).unwrap();
    let reference = at_sett(&draft);
    let (network, yarns, card) = weave_of(&draft);
    let all = TileStiffness::all(&(&card).into());
    assert_eq!(reference.stiffness(), TileStiffness::of(&network, &yarns, &(&card).into()));
    let at = |kind: TileStiffness| all.iter().position(|&one| one == kind).unwrap();
    let [warp, weft, shear] = [TileStiffness::WarpStretch, TileStiffness::WeftStretch, TileStiffness::Shear].map(at);
    let slopes = |angle, stretch| check_slopes(&reference, &draft, |of| pulled(of, angle, stretch, None));
    // Straight threads say themselves what they bear.
    let along = slopes(0.0, 0.1);
    assert!((along[weft] - 1.0).abs() < 1e-9 && along[warp].abs() < 1e-9, "{along:?}");
    let across = slopes(FRAC_PI_2, 0.1);
    assert!((across[warp] - 1.0).abs() < 1e-9 && across[weft].abs() < 1e-9, "{across:?}");
    // On the bias shear does at first, and all three where it is jammed.
    let bias = slopes(FRAC_PI_4, 0.1);
    assert!(bias[shear] > 0.9, "{bias:?}");
    let locked = slopes(FRAC_PI_4, 0.45);
    assert!([warp, weft, shear].iter().all(|&k| locked[k] > 0.05), "{locked:?}");
    // The energy is linear in all stiffnesses.
    for slopes in [along, across, bias, locked] {
        assert!((slopes.iter().sum::<f64>() - 1.0).abs() < 1e-6, "{slopes:?}");
    }
}

#[test]
fn picks_that_are_pushed_together_buckle_and_resist_by_bending() {
    let draft = Draft::plain();
    let flat = at_sett(&draft);
    let (network, yarns, card) = weave_of(&draft);
    // One end begins a little above the other.
    let mut rest = flat.rest().clone();
    for (node, place) in network.chart_place.iter().enumerate() {
        rest.coordinates[5 * node + 2] += 0.02e-3 * place[0];
    }
    let settings = TileSettings { tolerance: 2e-9, ..TileSettings::of(&card) };
    let reference = TileReference::new(&network, &yarns, &card, &settings, rest).unwrap();
    let push = |of: &TileReference| {
        let mut tile = StretchedTile::new(of, 0.0, true).unwrap();
        let found = tile.solve(-0.02, 0.0).unwrap();
        (tile, found)
    };
    let slopes = check_slopes(&reference, &draft, push);
    let at = TileStiffness::all(&(&card).into()).iter().position(|&kind| kind == TileStiffness::WeftBending).unwrap();
    assert!(slopes[at] > 0.9, "{slopes:?}");
    assert!((slopes.iter().sum::<f64>() - 1.0).abs() < 1e-6, "{slopes:?}");
    // A bend of an angle θ at every crossing stores k_b θ²/2p, and cos(θ/2) of the picks' length is left, s = −θ²/8, as far as they keep
    // it: W/A = −4 k_b s/(p² q).
    let stress = -push(&reference).1.stress;
    let wanted = 4.0 * threads()[1].bending_stiffness / (SPACING[0] * SPACING[0] * SPACING[1]);
    assert!((stress / wanted - 1.0).abs() < 0.1, "{stress} {wanted}");
}

/// What a fabric does that is pulled along weft, bias and warp, with stiffnesses that are factors of those it has.
fn curves(draft: &Draft, factors: [f64; P]) -> Vec<Target> {
    let (network, yarns, card) = weave_of(draft);
    let zero = [(0.0, 0.1), (FRAC_PI_4, 0.42), (FRAC_PI_2, 0.08)].map(|(angle, end)| {
        let points = (1..=8).map(|k| [end * f64::from(k) / 8.0, f64::from(k), 0.0]).map(StretchPoint::from).collect();
        Target::new(&StretchCurve { angle, points }, true, 1.0)
    });
    let (tile, pull) = (TileSettings::of(&card), NetworkPullSettings::default());
    let problem = NetworkProblem::new(&network, &yarns, &card, zero.to_vec(), tile, pull, 1).unwrap();
    let given = problem.stiffness();
    let found = problem.evaluate(std::array::from_fn(|k| given[k] * factors[k]), false).unwrap();
    let target = |(target, answers): (&Target, Vec<Answer<P>>)| {
        let points: Vec<StretchPoint> = answers.iter().map(|answer| answer.point).collect();
        let most = points[points.len() - 1].force;
        Target::new(&StretchCurve { angle: target.angle, points }, true, 0.4 * most)
    };
    zero.iter().zip(found.answers).map(target).collect()
}

#[test]
fn curves_of_known_stiffnesses_of_a_weave_are_met() {
    for draft in [Draft::plain(), Draft::twill(2, 1).unwrap()] {
        let truth = [0.6, 1.6, 2.0, 1.0, 1.0, 1.0];
        let targets = curves(&draft, truth);
        let (network, yarns, card) = weave_of(&draft);
        let starts = vec![[1.0; P], [4.0, 0.2, 0.1, 1.0, 1.0, 1.0], [0.1, 5.0, 10.0, 1.0, 1.0, 1.0]];
        for start in starts {
            let settings = NetworkFitSettings { starts: vec![start], ..NetworkFitSettings::default() };
            let fit = fit_network(&network, &yarns, &card, &targets, &settings).unwrap();
            assert!(fit.start_error.unwrap().comfort > 0.2, "{:?}", fit.start_error);
            let error = fit.error;
            assert!(error.comfort < 1e-3 && error.full < 1e-3 && error.compression < 1e-3, "{error:?} from {start:?}");
            let given = TileStiffness::of(&network, &yarns, &(&card).into());
            for k in 0..3 {
                let found = fit.stiffness[k] / given[k] / truth[k];
                assert!((found - 1.0).abs() < 1e-2 && fit.within[k] < 1.1, "{}: {found}", fit.kinds[k].name());
            }
            // Nothing bends and nothing slides where all moves as the plane does.
            assert_eq!(fit.undetermined, ["warp bending", "weft bending", "spacing"]);
            assert_eq!(fit.stiffness[3..], given[3..]);
        }
    }
}

#[test]
fn a_fabric_file_with_a_draft_has_its_contact_model_fitted() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fabrics/cotton-print/fabric.toml");
    let fabric = FabricFile::read(&path).unwrap();
    let shell = fit_shell(&fabric, &MembraneFitSettings::default()).unwrap();
    let targets = uniform_targets(&fabric, &shell).unwrap();
    let Some(Structure::Scene(scene)) = &fabric.structure else { panic!("it has a scene") };
    let (fitted, found) = fit_scene(scene, &targets).unwrap();
    assert!(found.start_error.unwrap().comfort > 1.0, "{:?}", found.start_error);
    assert!(
        found.error.comfort < 0.05 && found.error.full < 0.06 && found.error.compression < 0.08,
        "{:?}",
        found.error
    );
    // The scene that is written bears what was fitted.
    let written = Scene::from_text(&fitted.resolved_toml().unwrap(), "swatch.toml").unwrap();
    let reference = relaxed_reference(&written).unwrap();
    for (target, answers) in targets.iter().zip(&found.answers) {
        let mut strip = NetworkPull::new(&reference, target.angle, &NetworkPullSettings::default()).unwrap();
        for answer in answers {
            let stress = strip.to(answer.point.stretch).unwrap().stress;
            assert!((stress / answer.point.force - 1.0).abs() < 1e-9, "{stress} {answer:?}");
        }
    }
}
