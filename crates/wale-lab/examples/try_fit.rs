//! Experiment.
use rayon::prelude::*;
use std::time::Instant;
use wale::pattern::Chart;
use wale::scene::{Scene, text_of_preset};
use wale_lab::least_squares::{LeastSquaresSettings, Residuals, fit};
use wale_lab::shell::StretchCurve;
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
    let space = RodSpace::paper(ks2, r).within(RodParameter::OuterContact, [1e-7 * ks2 / r, 1e0 * ks2 / r]);
    let rest = |m: &RodMaterial| {
        let t = Instant::now();
        let x = estimate_rest_shapes(&tile, m, &RestShapeSettings::default());
        if let Ok(x) = &x {
            println!(
                "rest {:.2}s before {:.3e} after {:?} moved {:.2} R",
                t.elapsed().as_secs_f64(),
                x.stress_before,
                x.stress.iter().step_by(6).map(|x| format!("{x:.2e}")).collect::<Vec<_>>(),
                x.moved / r
            );
        }
        x.map(|x| x.tile)
    };
    let truth_tile = rest(&base).unwrap();
    let mut settings = PullSettings::default();
    if let Ok(a) = std::env::var("ANCHOR") {
        settings.equilibrium.anchor = a.parse().unwrap();
    }
    let n = 8;
    let targets: Vec<Target> = [(0.0, 0.5), (std::f64::consts::FRAC_PI_4, 0.4), (std::f64::consts::FRAC_PI_2, 0.4)]
        .par_iter()
        .map(|&(angle, most)| {
            let s: Vec<f64> = (1..=n).map(|k| most * k as f64 / n as f64).collect();
            let a = pull(&truth_tile, &base, angle, &s, false, &settings).unwrap();
            for x in &a {
                println!("{:.2} {:.3} {:.3e} {:.3}", angle, x.point.stretch, x.point.force, x.point.compression);
            }
            let comfort = a[n * 2 / 3].point.force;
            Target::new(&StretchCurve { angle, points: a.iter().map(|x| x.point).collect() }, true, comfort)
        })
        .collect();
    let truth = RodSpace::coordinates(base.parameters());
    let composite = std::env::args().nth(2).is_some();
    if std::env::var("STOP").is_ok() {
        return;
    }
    for start in [[0.5, 0.5, 0.5, 0.5, 0.5, 0.5], [0.8, 0.5, 0.2, 0.3, 0.6, 0.9], [0.3, 0.5, 0.8, 0.7, 0.4, 0.6]] {
        let t0 = Instant::now();
        let mut at = space.at_parts(start);
        let mut now = None;
        for round in 0..8 {
            let m = material_at(&base, at);
            let Ok(tile_now) = rest(&m) else {
                println!("rest failed");
                break;
            };
            let evaluate = |x: &[f64; 6]| -> Result<Option<Residuals<6>>, ()> {
                let p = RodSpace::parameters(*x);
                let m = base.with_parameters(p);
                let t = if composite {
                    match estimate_rest_shapes(&tile, &m, &RestShapeSettings::default()) {
                        Ok(t) => t.tile,
                        Err(_) => return Ok(None),
                    }
                } else {
                    tile_now.clone()
                };
                let a: Option<Vec<_>> = targets
                    .par_iter()
                    .map(|g| {
                        pull(&t, &m, g.angle, &g.stretches(), true, &settings)
                            .map_err(|e| println!("{e} {:.2}", g.angle))
                            .ok()
                    })
                    .collect();
                let Some(a) = a else {
                    println!("failed");
                    return Ok(None);
                };
                let mut out = Residuals::default();
                for (g, a) in targets.iter().zip(&a) {
                    add_residuals(g, a, |s| RodSpace::by_coordinates(&p, s), &mut out);
                }
                println!(
                    "   cost {:.4e} {:?} at {:?}",
                    out.values.iter().map(|r| r * r).sum::<f64>(),
                    errors(&targets, &a),
                    x.iter().zip(&truth).map(|(a, b)| format!("{:.3}", a - b)).collect::<Vec<_>>()
                );
                Ok(Some(out))
            };
            let f = fit(
                evaluate,
                &[at],
                &LeastSquaresSettings {
                    max_evaluations: if composite { 40 } else { 10 },
                    bounds: space.coordinate_bounds(),
                    least_noise: 0.01,
                },
            )
            .unwrap();
            let Some(f) = f else {
                println!("no fit");
                break;
            };
            println!("round {round}: cost {:.4e} evals {} {:.1}s", f.cost, f.evaluations, t0.elapsed().as_secs_f64());
            at = f.parameters;
            now = Some(f);
            if composite {
                break;
            }
        }
        if let Some(f) = now {
            println!("START {start:?} -> {:.3e} unc {:?}", f.cost, f.uncertainty);
        }
    }
}
