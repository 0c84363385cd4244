//! Experiment.
use rayon::prelude::*;
use std::time::Instant;
use wale::pattern::Chart;
use wale::scene::{Scene, text_of_preset};
use wale_lab::shell::StretchCurve;
use wale_lab::yarn_fit::gradients::*;
use wale_lab::yarn_fit::problem::*;
use wale_lab::yarn_fit::swarm::*;
use wale_lab::yarn_fit::*;
use wale_lab::yarn_tile::*;

fn main() {
    let scene = Scene::from_text(&text_of_preset(wale::scene::schema::PresetName::WorstedWool), "p").unwrap();
    let chart = match std::env::args().nth(1).as_deref() {
        Some("garter") => Chart::garter(),
        Some("rib") => Chart::rib(1, 1).unwrap(),
        _ => Chart::stockinette(),
    };
    let tile = tile_of_chart(&chart, &scene.yarns, scene.fabric.knit().unwrap()).unwrap();
    let r = contact_radius(&tile);
    println!("{} vertices, periods {:?}, R {} R_est {}", tile.vertex_count(), tile.periods(), tile.radius(), r);
    let ks2 = 100.0;
    let kc: f64 = std::env::var("KC").map_or(2e4, |x| x.parse().unwrap());
    let base = RodMaterial {
        soft_stretch: 5.0,
        stiff_stretch: ks2,
        onset: 0.06,
        bending: 0.05 * 0.25 * ks2 * r * r,
        contact: [
            wale::energy::ContactPhase { radius: 1.1 * r, stiffness: kc },
            wale::energy::ContactPhase { radius: 0.25 * r, stiffness: 1e4 },
        ],
        reading: Default::default(),
    };
    let space = RodSpace::paper(ks2, r).within(RodParameter::OuterContact, [1e-5 * ks2 / r, 1e1 * ks2 / r]);
    let mut problem = YarnProblem {
        tile: tile.clone(),
        base,
        space,
        targets: vec![],
        bending: vec![],
        rest_shapes: true,
        rest: Default::default(),
        pull: Default::default(),
    };
    let truth_tile = problem.rested(&base.parameters()).unwrap();
    let n = 8;
    problem.targets = [(0.0, 0.5), (std::f64::consts::FRAC_PI_4, 0.4), (std::f64::consts::FRAC_PI_2, 0.4)]
        .par_iter()
        .map(|&(angle, most)| {
            let s: Vec<f64> = (1..=n).map(|k| most * k as f64 / n as f64).collect();
            let a = pull(&truth_tile, &base, angle, &s, false, &problem.pull).unwrap();
            let comfort = a[n * 2 / 3].point.force;
            Target::new(&StretchCurve { angle, points: a.iter().map(|x| x.point).collect() }, true, comfort)
        })
        .collect();
    let truth = RodSpace::coordinates(base.parameters());
    let t0 = Instant::now();
    let tell = |s: &Step| {
        if s.evaluations % 8 == 0 {
            println!("{} best {:.3e} {:.1}s", s.evaluations, s.best, t0.elapsed().as_secs_f64())
        }
    };
    let progress = Progress::new(&tell);
    let here = Here::new(&problem);
    let Ok(found) = (if std::env::args().nth(2).is_some() {
        fit_by_swarm(&problem, &here, &SwarmSettings::default(), &progress)
    } else {
        fit_by_gradients(&problem, &here, &GradientSettings::default(), &progress)
    });
    let found = found.unwrap();
    println!(
        "{:.1}s cost {:.3e} evals {} off {:?}",
        t0.elapsed().as_secs_f64(),
        found.cost,
        progress.now().evaluations,
        found.coordinates.iter().zip(&truth).map(|(a, b)| format!("{:.3}", a - b)).collect::<Vec<_>>()
    );
    if let Some(l) = &found.least_squares {
        println!("uncertainty {:?}", l.uncertainty);
    }
    let q = Question::of(RodSpace::parameters(found.coordinates), 20, false);
    let Ok(e) = here.answer(&q);
    let t: Vec<Target> = problem.targets.iter().map(|t| t.resampled(20)).collect();
    println!("{:?}", errors(&t, &e.unwrap().stretch));
}
