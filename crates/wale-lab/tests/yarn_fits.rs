//! Yarns are found again from the curves that they made; failures cost, and never stop a fit; threads change nothing.

use std::convert::Infallible;
use std::sync::atomic::{AtomicUsize, Ordering};

use wale::pattern::Chart;
use wale::scene::schema::PresetName;
use wale::scene::{Scene, text_of_preset};
use wale_lab::shell::StretchCurve;
use wale_lab::yarn_fit::gradients::{GradientSettings, Round, improve};
use wale_lab::yarn_fit::of_fabric::{Ablation, Part, problem, problems};
use wale_lab::yarn_fit::problem::{Answers, Evaluation, Here, P, Question, YarnProblem, ask_all, best_scale};
use wale_lab::yarn_fit::run::{Way, YarnFit, fit_together, fit_yarn};
use wale_lab::yarn_fit::swarm::SwarmSettings;
use wale_lab::yarn_fit::{BendingTarget, Progress, RodSpace, Target, pull};
use wale_lab::yarn_tile::{
    CoarseDeformation, RestShapeSettings, RodMaterial, RodParameter, YarnTile, bending_stiffness, contact_radius,
    estimate_rest_shapes, tile_of_chart,
};

const STIFFNESS: f64 = 100.0;
const POINTS: usize = 4;

/// A jersey, the curves that it makes with known numbers along course and wale, and these numbers. Bending, contact and what holds
/// the yarns are to be found; the rest is held.
fn known() -> (YarnProblem, [f64; P]) {
    let scene = Scene::from_text(&text_of_preset(PresetName::WorstedWool), "preset.toml").unwrap();
    let tile = tile_of_chart(&Chart::stockinette(), &scene.yarns, scene.fabric.knit().unwrap()).unwrap();
    let mut problem = problem(tile, Vec::new(), Vec::new(), Some(STIFFNESS), Ablation::default());
    problem.rest = RestShapeSettings { growing_rounds: 2, late_rounds: 2, ..problem.rest };
    let touching = contact_radius(&problem.tile);
    let bending = 0.05 * 0.25 * STIFFNESS * touching * touching;
    let holding = 1e-2 * bending / touching.powi(4);
    let contact = 0.02 * STIFFNESS / touching;
    let truth = [20.0, STIFFNESS, 0.05, bending, 1.05 * touching, contact, holding];
    for held in [RodParameter::SoftStretch, RodParameter::Onset, RodParameter::OuterRadius] {
        problem.space = problem.space.holding(held, truth[held as usize]);
    }
    let rested = problem.rested(&truth).unwrap();
    let material = problem.base.with_parameters(truth);
    problem.targets = [(0.0, 0.3), (std::f64::consts::FRAC_PI_2, 0.2)]
        .map(|(angle, largest)| {
            let stretches: Vec<f64> = (1..=POINTS).map(|k| largest * k as f64 / POINTS as f64).collect();
            let answers = pull(&rested, &material, angle, &stretches, false, &problem.pull).unwrap();
            let points: Vec<_> = answers.iter().map(|answer| answer.point).collect();
            let comfort = 0.4 * points[POINTS - 1].force;
            Target::new(&StretchCurve { angle, points }, true, comfort)
        })
        .into();
    (problem, truth)
}

/// The same yarn in a jersey and in a garter, each with the curve that it makes along its courses.
fn known_pair() -> Vec<YarnProblem> {
    let (jersey, truth) = known();
    let scene = Scene::from_text(&text_of_preset(PresetName::WorstedWool), "preset.toml").unwrap();
    let garter = tile_of_chart(&Chart::garter(), &scene.yarns, scene.fabric.knit().unwrap()).unwrap();
    let part = |tile: YarnTile| Part { tile, targets: Vec::new(), bending: Vec::new() };
    let parts = vec![part(jersey.tile.clone()), part(garter)];
    let mut problems = problems(parts, Some(STIFFNESS), Ablation::default());
    assert_eq!((problems[0].base, problems[0].space), (problems[1].base, problems[1].space));
    for problem in &mut problems {
        problem.rest = jersey.rest;
        problem.space = jersey.space;
        let rested = problem.rested(&truth).unwrap();
        let material = problem.base.with_parameters(truth);
        let answers = pull(&rested, &material, 0.0, &[0.08, 0.16], false, &problem.pull).unwrap();
        let points: Vec<_> = answers.iter().map(|answer| answer.point).collect();
        let comfort = 0.4 * points[1].force;
        problem.targets = vec![Target::new(&StretchCurve { angle: 0.0, points }, true, comfort)];
    }
    problems
}

#[test]
fn one_yarn_is_fitted_to_two_fabrics_at_once() {
    let problems = known_pair();
    let round = |evaluations| Round { starts: 1, evaluations, samples: 2 };
    let rounds = [round(3), round(1), Round { starts: 0, ..round(0) }];
    let settings = GradientSettings { screened: 3, rounds, ..GradientSettings::default() };
    let silent = |_: &wale_lab::yarn_fit::Step| {};
    let here = Here::of(&problems);
    let Ok(fits) = fit_together(&problems, &here, &Way::Gradients(settings), &Progress::new(&silent));
    let fits = fits.unwrap();
    assert_eq!(fits.len(), 2);
    assert_eq!((fits[0].material, fits[0].cost), (fits[1].material, fits[1].cost), "it is one yarn");
    // The sum that was made small is that of both.
    let at = fits[0].material.parameters();
    let costs = [0, 1].map(|fabric| {
        let question = Question { fabric, ..Question::of(at, 2, false) };
        let Ok(found) = here.answer(&question);
        problems[fabric].residuals(&question, &found.unwrap()).cost()
    });
    assert!((costs[0] + costs[1] - fits[0].cost).abs() <= 1e-9 * fits[0].cost.max(1e-12), "{costs:?} {}", fits[0].cost);
    // Of a fabric that is not there nothing is known.
    let Ok(none) = here.answer(&Question { fabric: 2, ..Question::of(at, 2, false) });
    assert!(none.is_none());
}

fn fit<A: Answers<Unanswered = Infallible>>(problem: &YarnProblem, answers: &A, way: &Way) -> Option<YarnFit> {
    let silent = |_: &wale_lab::yarn_fit::Step| {};
    let Ok(found) = fit_yarn(problem, answers, way, &Progress::new(&silent));
    found
}

fn gradients() -> GradientSettings {
    let round = |starts, evaluations| Round { starts, evaluations, samples: POINTS };
    let rounds = [round(2, 10), round(1, 4), round(0, 0)];
    GradientSettings { screened: 8, screening_samples: 2, rounds, ..GradientSettings::default() }
}

#[test]
fn a_yarn_is_found_again_from_its_curves() {
    let (problem, truth) = known();
    let found = fit(&problem, &Here::new(&problem), &Way::Gradients(gradients())).unwrap();
    let error = found.error;
    assert!(error.comfort < 1e-3 && error.full < 1e-3 && error.compression < 1e-3, "{error:?}");
    let bending = found.material.parameters()[RodParameter::Bending as usize] / truth[RodParameter::Bending as usize];
    assert!((bending - 1.0).abs() < 1e-3, "{bending}");
    assert_eq!(found.within[RodParameter::Onset as usize], 1.0, "it was held");
}

#[test]
fn a_yarn_of_which_all_numbers_are_held_is_evaluated() {
    let (mut problem, truth) = known();
    problem.space.bounds = truth.map(|number| [number; 2]);
    for way in [Way::Local(SwarmSettings::quick()), Way::Gradients(gradients())] {
        let found = fit(&problem, &Here::new(&problem), &way).unwrap();
        assert!(found.cost < 0.01, "{}", found.cost);
    }
}

#[test]
fn with_bending_among_its_targets_a_yarn_bends_more_as_it_was_measured() {
    // A fabric that stretches as it did and is said to be twice as stiff in bending: both cannot be had, and a fit gives of each.
    let (mut problem, truth) = known();
    let material = problem.base.with_parameters(truth);
    let rested = problem.rested(&truth).unwrap();
    let flat = CoarseDeformation::stretched(0.0, 0.0, 0.0);
    let curvature = 0.1 / problem.tile.periods()[0];
    let equilibrium = problem.pull.equilibrium;
    let rigidity = |tile: &YarnTile, material: &RodMaterial| {
        bending_stiffness(tile, material, equilibrium, &flat, curvature).unwrap()
    };
    let measured = 2.0 * rigidity(&rested, &material);
    let pulled = problem.clone();
    problem.bending = vec![BendingTarget { angle: 0.0, stiffness: measured, curvature }];
    let question = Question::of(truth, POINTS, true);
    let at_truth = problem.residuals(&question, &problem.evaluate(&rested, &question).unwrap());
    let [stretch, bending] = [at_truth.values.len() - 1, 1].map(|count| count as f64);
    assert_eq!(stretch, 4.0 * POINTS as f64);
    let last = at_truth.values.last().unwrap();
    assert!(
        (last + 0.5).abs() < 1e-3 && (at_truth.cost() - 0.25 * bending).abs() < 1e-3,
        "half of it is missing: {last}"
    );
    let round = Round { starts: 1, evaluations: 4, samples: POINTS };
    let silent = |_: &wale_lab::yarn_fit::Step| {};
    let problems = [problem];
    let from = RodSpace::coordinates(truth);
    let Ok(found) = improve(&problems, &Here::of(&problems), from, &round, 0.01, &Progress::new(&silent));
    let at = RodSpace::parameters(found.unwrap().coordinates);
    let there = rigidity(&problems[0].rested(&at).unwrap(), &problems[0].base.with_parameters(at));
    assert!(there > 0.6 * measured && there < 1.1 * measured, "{there} {measured}");
    let stretched = pulled
        .residuals(&question, &pulled.evaluate(&pulled.rested(&at).unwrap(), &Question::of(at, POINTS, true)).unwrap());
    assert!(stretched.cost() > 1e-6 && stretched.cost() < 0.2, "{}", stretched.cost());
}

#[test]
fn all_numbers_that_the_curves_feel_are_found_again_from_near() {
    // All but the stiffness that a tensile tester measures and an onset that these yarns do not reach are wrong by a twentieth.
    let (mut problem, truth) = known();
    let whole = wale_lab::yarn_fit::of_fabric::problem(
        problem.tile.clone(),
        Vec::new(),
        Vec::new(),
        Some(STIFFNESS),
        Ablation::default(),
    );
    problem.space = whole.space.holding(RodParameter::Onset, truth[RodParameter::Onset as usize]);
    let bounds = problem.space.coordinate_bounds();
    let mut from = RodSpace::coordinates(truth);
    for (k, coordinate) in from.iter_mut().enumerate().filter(|(k, _)| bounds[*k][0] < bounds[*k][1]) {
        *coordinate += if k % 2 == 0 { 0.05 } else { -0.05 };
    }
    let silent = |_: &wale_lab::yarn_fit::Step| {};
    let here = Here::new(&problem);
    let round = Round { starts: 1, evaluations: 9, samples: POINTS };
    let Ok(found) = improve(std::slice::from_ref(&problem), &here, from, &round, 0.01, &Progress::new(&silent));
    let found = found.unwrap();
    let start = found.least_squares.as_ref().unwrap().start_cost;
    assert!(start > 1e-3 && found.cost < 1e-6, "{start} {}", found.cost);
    for (k, (found, truth)) in RodSpace::parameters(found.coordinates).iter().zip(truth).enumerate() {
        assert!((found / truth - 1.0).abs() < 0.02, "{}: {found} {truth}", RodParameter::NAMES[k]);
    }
}

#[test]
fn a_fit_comes_back_from_an_onset_that_no_yarn_reaches() {
    let (mut problem, mut truth) = known();
    let [soft, onset] = [RodParameter::SoftStretch as usize, RodParameter::Onset as usize];
    (truth[soft], truth[onset]) = (4.0, 0.01);
    problem.space.bounds = std::array::from_fn(|k| match k {
        k if k == soft => [1.0, STIFFNESS],
        k if k == onset => [0.0, 0.15],
        k => [truth[k]; 2],
    });
    let (rested, material) = (problem.rested(&truth).unwrap(), problem.base.with_parameters(truth));
    for target in &mut problem.targets {
        let answers = pull(&rested, &material, target.angle, &target.stretches(), false, &problem.pull).unwrap();
        for (point, answer) in target.points.iter_mut().zip(&answers) {
            point[1..].copy_from_slice(&[answer.point.force, answer.point.compression]);
        }
    }
    let mut from = truth;
    (from[soft], from[onset]) = (8.0, 0.14);
    let (problems, here) = (std::slice::from_ref(&problem), Here::new(&problem));
    let slope = |at: [f64; P]| {
        let Ok(found) = ask_all(problems, &here, &Question::of(at, POINTS, true));
        found.unwrap().slopes.iter().map(|row| row[onset].abs()).fold(0.0, f64::max)
    };
    assert!(slope(from) == 0.0 && slope(truth) > 1e-3, "{} {}", slope(from), slope(truth));
    let round = Round { starts: 1, evaluations: 12, samples: POINTS };
    let silent = |_: &wale_lab::yarn_fit::Step| {};
    let from = RodSpace::coordinates(from);
    let Ok(found) = improve(problems, &here, from, &round, 0.01, &Progress::new(&silent));
    let found = RodSpace::parameters(found.unwrap().coordinates);
    assert!((found[onset] / 0.01 - 1.0).abs() < 0.02 && (found[soft] / 4.0 - 1.0).abs() < 0.02, "{found:?}");
}

#[test]
fn yarns_that_are_too_soft_in_everything_are_off_by_one_factor() {
    let (problem, truth) = known();
    let mut softer = truth;
    for (k, number) in softer.iter_mut().enumerate() {
        if k != RodParameter::Onset as usize && k != RodParameter::OuterRadius as usize {
            *number *= 0.3;
        }
    }
    let (problems, here) = (std::slice::from_ref(&problem), Here::new(&problem));
    let question = Question::of(softer, POINTS, false);
    let Ok(found) = ask_all(problems, &here, &question);
    let Ok(scaled) = best_scale(problems, &here, &question);
    let ((scale, cost), off) = (scaled.unwrap(), found.unwrap().cost());
    // The inner contact is not one of the numbers, and stays.
    assert!((0.3 * scale - 1.0).abs() < 0.02 && cost < 1e-3 * off && off > 0.1, "{scale} {cost} {off}");
    let place = problem.space.scaled(&RodSpace::coordinates(softer), 1.0 / 0.3);
    let bending = RodParameter::Bending as usize;
    assert!((RodSpace::parameters(place)[bending] / truth[bending] - 1.0).abs() < 1e-12);
}

#[test]
fn rest_shapes_change_little_with_the_material() {
    let scene = Scene::from_text(&text_of_preset(PresetName::WorstedWool), "preset.toml").unwrap();
    let tile = tile_of_chart(&Chart::rib(1, 1).unwrap(), &scene.yarns, scene.fabric.knit().unwrap()).unwrap();
    let problem = problem(tile, Vec::new(), Vec::new(), Some(STIFFNESS), Ablation::default());
    let radius = contact_radius(&problem.tile);
    let bending = 0.05 * 0.25 * STIFFNESS * radius * radius;
    let holding = 0.1 * bending / radius.powi(4);
    let truth = [8.0, STIFFNESS, 0.05, bending, 1.05 * radius, 0.05 * STIFFNESS / radius, holding];
    let mut near = RodSpace::coordinates(truth);
    let off = [1.2e-3, 0.0, 3e-3, 5.5e-3, 7e-4, 6.6e-3, -2.6e-3];
    near.iter_mut().zip(off).for_each(|(coordinate, off)| *coordinate += off);
    let apart = |growing_rounds: usize| {
        let settings = RestShapeSettings { growing_rounds, late_rounds: 1, ..problem.rest };
        let [a, b] = [truth, RodSpace::parameters(near)].map(|parameters| {
            estimate_rest_shapes(&problem.tile, &problem.base.with_parameters(parameters), &settings).unwrap().tile
        });
        let pairs = a.vertices().iter().zip(b.vertices());
        pairs.map(|(a, b)| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()).fold(0.0, f64::max) / radius
    };
    // Numbers that differ by half a per cent; yarns of which only sizes of curvatures are compared came to rest a radius apart.
    for growing_rounds in [0, 8] {
        let moved = apart(growing_rounds);
        assert!(moved > 0.0 && moved < 0.01, "{growing_rounds}: {moved}");
    }
}

#[test]
fn a_number_that_ends_at_its_bound_is_said_to() {
    let (problem, truth) = known();
    let k = RodParameter::Bending as usize;
    // The yarn that made the curves lies below these bounds, then above.
    for (bounds, says) in [([3.0, 30.0], "k_b is at its lower bound"), ([0.01, 0.3], "k_b is at its upper bound")] {
        let space = problem.space.within(RodParameter::Bending, bounds.map(|factor| factor * truth[k]));
        let held = [RodParameter::OuterContact, RodParameter::Holding];
        let space = held.into_iter().fold(space, |space, held| space.holding(held, truth[held as usize]));
        let problem = YarnProblem { space, ..problem.clone() };
        let round = |starts, evaluations| Round { starts, evaluations, samples: POINTS };
        let rounds = [round(1, 8), round(0, 0), round(0, 0)];
        let settings = GradientSettings { screened: 1, rounds, ..gradients() };
        let found = fit(&problem, &Here::new(&problem), &Way::Gradients(settings)).unwrap();
        assert_eq!(found.open, [says], "{:?}", found.material);
    }
}

#[test]
fn slopes_through_rest_shapes_are_those_of_differences() {
    // What least squares is given, against differences of the whole: rest shapes and pulls with numbers that differ a little.
    let (problem, truth) = known();
    let here = Here::new(&problem);
    let mut off = truth;
    off[RodParameter::Bending as usize] *= 1.3;
    let residuals = |rest: [f64; P], at: [f64; P], slopes: bool| {
        let question = Question { fabric: 0, rest, at, samples: POINTS, slopes };
        let Ok(found) = here.answer(&question);
        problem.residuals(&question, &found.unwrap())
    };
    let k = RodParameter::Bending as usize;
    let moved = |by: f64| {
        let mut coordinates = RodSpace::coordinates(off);
        coordinates[k] += by;
        RodSpace::parameters(coordinates)
    };
    let (up, down) = (moved(1e-3), moved(-1e-3));
    let exact = residuals(off, off, true);
    let [whole, by_rest] = [(up, down, true), (up, down, false)].map(|(up, down, both)| {
        let [a, b] = [up, down].map(|rest| residuals(rest, if both { rest } else { off }, false).values);
        a.iter().zip(&b).map(|(a, b)| (a - b) / 2e-3).collect::<Vec<f64>>()
    });
    let size = whole.iter().fold(0.0f64, |m, s| m.max(s.abs()));
    assert!(size > 1e-3);
    for ((row, whole), rest) in exact.slopes.iter().zip(&whole).zip(&by_rest) {
        assert!((row[k] + rest - whole).abs() < 2e-2 * size, "{} + {rest}, {whole}", row[k]);
    }
}

/// Fails at every third question.
struct Fails<'a> {
    by: Here<'a>,
    asked: AtomicUsize,
}

impl Answers for Fails<'_> {
    type Unanswered = Infallible;
    fn answer(&self, question: &Question) -> Result<Option<Evaluation>, Infallible> {
        if self.asked.fetch_add(1, Ordering::Relaxed).is_multiple_of(3) { Ok(None) } else { self.by.answer(question) }
    }
}

#[test]
fn failures_cost_and_do_not_stop_a_fit() {
    let (problem, _) = known();
    let quick = SwarmSettings { particles: 6, steps: 2, samples: 2, local: [6, 2], ..SwarmSettings::default() };
    let hasty = gradients().rounds.map(|round| Round { evaluations: 2, ..round });
    for way in [Way::Swarm(quick), Way::Gradients(GradientSettings { rounds: hasty, ..gradients() })] {
        let fails = Fails { by: Here::new(&problem), asked: AtomicUsize::new(1) };
        // One thread: which question fails must not depend on who comes first.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let found = pool.install(|| fit(&problem, &fails, &way));
        assert!(
            found.is_some_and(|found| found.cost.is_finite()),
            "a third of the questions were not answered, no more"
        );
    }
    // A tile that can be tested nowhere gives nothing, and no panic.
    let nowhere = problem.space.within(RodParameter::OuterRadius, [1.0, 2.0]);
    let nowhere = YarnProblem { space: nowhere, ..problem };
    for way in [Way::Swarm(quick), Way::Local(quick), Way::Gradients(gradients())] {
        assert!(fit(&nowhere, &Here::new(&nowhere), &way).is_none(), "{way:?}");
    }
}

#[test]
fn a_swarm_is_the_same_for_a_seed_on_any_number_of_threads() {
    let (problem, _) = known();
    let run = |threads: usize, seed: u64| {
        let way = Way::Swarm(SwarmSettings {
            particles: 8,
            steps: 3,
            samples: 2,
            local: [8, 2],
            seed,
            ..SwarmSettings::default()
        });
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| fit(&problem, &Here::new(&problem), &way)).unwrap()
    };
    let (one, two, other) = (run(1, 5), run(2, 5), run(2, 6));
    assert_eq!(one.material, two.material);
    assert_eq!((one.cost, one.evaluations), (two.cost, two.evaluations));
    assert!(one.material != other.material);
    // Better than where nobody looked: the middle of the bounds.
    let middle = RodSpace::parameters(problem.space.at_parts([0.5; P]));
    let question = Question::of(middle, 2, false);
    let Ok(found) = Here::new(&problem).answer(&question);
    assert!(one.cost < problem.residuals(&question, &found.unwrap()).cost());
}
