//! Relaxed sizes of periodic tiles with the B4 numbers.
use wale::dynamics::tile_equilibrium::{TileSettings, relax_tile};
use wale::model::{FabricCard, YarnCard};
use wale::pattern::{Chart, knit};

fn main() {
    let l = 1.0;
    let kb = 1.0;
    let yarn = YarnCard {
        linear_density: 1.0,
        radius: 0.03,
        stretch_stiffness: 3e4 * kb / (l * l),
        bending_stiffness: kb,
        friction_coefficient: 0.3,
        mass_damping: 1.0,
        stiffness_damping: 0.0,
        plies: 2,
        twist: 1.0,
    };
    let ls = 0.09714842379766225;
    let card = FabricCard {
        loop_length: l,
        path_ratio: 1.0,
        transition_length: 0.085,
        stitch_length: ls,
        wale_spacing: 0.317,
        course_spacing: 0.241,
        wrapping_stiffness: 2.1474455654553606 * kb / (l * ls),
        wrapping_angle_course: 2.087413521149509,
        wrapping_angle_leg: 1.5688398517316826,
        bend_angle_foot_head: 0.4629159385017176,
        bend_angle_leg: 1.1122829701561612,
        length_stiffness: 3e4,
        spacing_stiffness: 2e3,
        spacing_leg: 0.21125728234404484,
        spacing_head_sinker: 0.06803056665718818,
        anchor_stiffness: 1.0,
        residual_compression: 0.0,
    };
    let charts = [
        ("stock", Chart::stockinette()),
        ("garter", Chart::garter()),
        ("k1p1", Chart::rib(1, 1).unwrap()),
        ("k2p2", Chart::rib(2, 2).unwrap()),
        ("seed", Chart::seed()),
        ("moss", Chart::moss()),
        ("welt", Chart::welting(2, 2).unwrap()),
    ];
    let mut stock = (1.0, 1.0);
    for (name, chart) in charts {
        for seed in 1..=3 {
            let network = knit::tile(&chart, &card);
            let start = std::time::Instant::now();
            let t = relax_tile(&network, &yarn, &card, &TileSettings { seed, ..TileSettings::default() });
            if name == "stock" {
                stock = (t.wale_spacing, t.course_spacing);
            }
            println!(
                "{name} W {:.4} H {:.4}  rel {:.3}/{:.3} W/H {:.3} E {:.5} it {} res {:.1e} {:.0} ms",
                t.wale_spacing,
                t.course_spacing,
                t.wale_spacing / stock.0,
                t.course_spacing / stock.1,
                t.wale_spacing / t.course_spacing,
                t.energy,
                t.iterations,
                t.residual,
                start.elapsed().as_secs_f64() * 1e3
            );
        }
    }
}
