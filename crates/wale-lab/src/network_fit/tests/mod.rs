//! Tests of stretched tiles and of fits to them.

mod fits;
mod known;
mod slopes;
mod stress;

use wale::dynamics::stretched_tile::{StretchedTile, TileReference};
use wale::dynamics::tile_equilibrium::{TileSettings, relax_tile};
use wale::model::{KnitCard, LoopProportions, Network, YarnCard, Yarns};
use wale::pattern::{Chart, Stitch, knit};

/// Acrylic yarn, and a loop of it.
pub(super) fn yarn() -> YarnCard {
    YarnCard {
        linear_density: 500e-6,
        radius: 0.74e-3,
        stretch_stiffness: 20.0,
        bending_stiffness: 45e-9,
        friction_coefficient: 0.3,
        mass_damping: 0.5,
        stiffness_damping: 0.05,
        loose_ends: false,
        plies: 4,
        twist: 100.0,
    }
}

pub(super) const LOOP_LENGTH: f64 = 0.0169;

/// A knit of knit loops, its yarn and its card.
pub(super) fn knit_of(columns: usize, rows: usize, thick: bool) -> (Network, Yarns, KnitCard) {
    let proportions = if thick { LoopProportions::thick() } else { LoopProportions::default() };
    let card = proportions.card(&yarn(), LOOP_LENGTH);
    let network = knit::tile(&Chart::new(vec![vec![Stitch::Knit; columns]; rows]).unwrap(), &card).unwrap();
    (network, (&yarn()).into(), card)
}

/// Settings so tight that differences can be taken.
pub(super) fn tight(card: &KnitCard) -> TileSettings {
    TileSettings { tolerance: 2e-9, ..TileSettings::of(card) }
}

pub(super) fn relaxed(columns: usize, rows: usize, thick: bool) -> TileReference {
    let (network, yarns, card) = knit_of(columns, rows, thick);
    let rest = relax_tile(&network, &yarns, &card, &tight(&card));
    TileReference::new(&network, &yarns, &card, &tight(&card), rest).unwrap()
}

/// Pulls in steps with the compression free or, as a multiple of the stretch, given.
pub(super) fn pulled(
    reference: &TileReference,
    angle: f64,
    stretch: f64,
    across: Option<f64>,
) -> (StretchedTile, wale::dynamics::stretched_tile::StretchedEquilibrium) {
    let mut tile = StretchedTile::new(reference, angle, across.is_none()).unwrap();
    let mut found = tile.solve(0.0, 0.0).unwrap();
    let steps = (stretch.abs() / 0.02).ceil() as u32;
    for step in 1..=steps {
        let s = stretch * f64::from(step) / f64::from(steps);
        found = tile.solve(s, across.unwrap_or(0.0) * s).unwrap();
    }
    (tile, found)
}

mod bits {
    use wale::dynamics::tile_equilibrium::{TileSettings, relax_tile};
    use wale::model::LoopProportions;
    use wale::pattern::{Chart, knit};
    #[test]
    fn bits() {
        let text = wale::scene::text_of_preset(wale::scene::schema::PresetName::ThickAcrylic);
        let scene = wale::scene::Scene::from_text(&text, "preset.toml").unwrap();
        for (name, proportions) in [("point", LoopProportions::default()), ("thick", LoopProportions::thick())] {
            let card = proportions.card(scene.yarns.first(), 0.02);
            for (rows, chart) in
                [("k", Chart::stockinette()), ("kp", Chart::rib(1, 1).unwrap()), ("k p", Chart::garter())]
            {
                let network = knit::tile(&chart, &card).unwrap();
                let now = std::time::Instant::now();
                let at = relax_tile(&network, &scene.yarns, &card, &TileSettings::of(&card));
                let hash = at.coordinates.iter().fold(0u64, |h, x| h.wrapping_mul(0x100000001b3) ^ x.to_bits());
                println!(
                    "{name} {rows:?} {hash:x} {} {} {:?} nodes {} thick {:?}",
                    at.iterations,
                    at.converged,
                    now.elapsed(),
                    network.node_count(),
                    card.thickness.is_some()
                );
            }
        }
    }
}

#[test]
fn explore() {
    for thick in [false, true] {
        for (c, r) in [(1, 1), (2, 1), (1, 2)] {
            let (network, yarns, card) = knit_of(c, r, thick);
            for seed in 1..5 {
                let settings = TileSettings { seed, ..tight(&card) };
                let rest = relax_tile(&network, &yarns, &card, &settings);
                let reference = TileReference::new(&network, &yarns, &card, &settings, rest.clone()).unwrap();
                let (_, bias) = pulled(&reference, std::f64::consts::FRAC_PI_4, 0.0, Some(0.0));
                println!(
                    "EX {thick} {c}x{r} seed {seed} E {:.9e} W {:.6e} C {:.6e} shear {:.4}",
                    rest.energy, rest.wale_spacing, rest.course_spacing, bias.stress
                );
                if c * r == 1 && seed < 3 {
                    for n in 0..4 {
                        println!(
                            "   {:?} {:?}",
                            &rest.coordinates[5 * n..5 * n + 5]
                                .iter()
                                .map(|x| (x * 1e6).round() / 1e3)
                                .collect::<Vec<_>>(),
                            network.chart_place[n]
                        );
                    }
                }
            }
        }
        let reference = relaxed(1, 1, thick);
        for angle in [0.0, 1.5707963] {
            let mut tile = StretchedTile::new(&reference, angle, true).unwrap();
            for k in 0..25 {
                match tile.solve(0.02 * k as f64, 0.0) {
                    Ok(f) => println!(
                        "PULL {thick} {angle:.2} {:.3} {:.4} {:.4} it {} E {:.6} stable {:?}",
                        f.stretch,
                        f.stress,
                        f.compression,
                        f.iterations,
                        f.energy_density,
                        tile.slopes(None).map(|s| s.stable)
                    ),
                    Err(e) => println!("PULL {thick} {angle:.2} {e}"),
                }
            }
        }
    }
}
