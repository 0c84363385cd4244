//! `wale relax`: one repeat of the fabric brought to rest, endless along both directions, without friction or as it comes off its needles.

use serde_json::json;
use wale::dynamics::off_needles::{OffNeedles, off_needles};
use wale::dynamics::tile_equilibrium::{TileSettings, relax_from_starts};
use wale::dynamics::tile_shaking::shaken;
use wale::measure::Census;
use wale::model::{KnitCard, Network, Yarns};
use wale::pattern::{Stitch, knit};

use crate::arguments::Relax;
use crate::exit::{Code, Failure};
use crate::opened::OpenedScene;
use crate::{output, say};

/// Most loops of a repeat: one of as many takes minutes.
const MOST_LOOPS: usize = 4000;

/// Relaxes it.
pub fn relax(arguments: &Relax) -> Result<(), Failure> {
    let opened = OpenedScene::read(&arguments.scene)?;
    let yarns = &opened.scene.yarns;
    let (Some(chart), Some(card)) = (opened.scene.structure.chart(), opened.scene.fabric.knit()) else {
        return Err(Failure::new(
            Code::BadInput,
            format_args!(
                "{}: only the repeat of a chart can be relaxed; set relax_first in its scene",
                arguments.scene.display()
            ),
        ));
    };
    let repeat = chart.smallest_repeat();
    let loops = repeat.loop_count();
    if loops > MOST_LOOPS {
        return Err(Failure::new(
            Code::ResourceLimit,
            format_args!(
                "{}: the smallest repeat of the chart has {loops} loops, and at most {MOST_LOOPS} are relaxed",
                arguments.scene.display()
            ),
        ));
    }
    let tile = knit::tile(&repeat, card)
        .map_err(|error| Failure::new(Code::BadInput, format_args!("{}: {error}", arguments.scene.display())))?;
    let usual = TileSettings::of(card);
    let settings = TileSettings { bed: arguments.bed.unwrap_or(usual.bed), ..usual };
    let needles = arguments.off_needles.then(|| needles(arguments, &tile, yarns, card)).transpose()?;
    let (found, best) = match &needles {
        Some(how) => (Vec::new(), off_needles(&tile, yarns, card, &settings, how)),
        None => {
            let found = relax_from_starts(&tile, yarns, card, &settings, arguments.starts as usize);
            let best = shaken(&tile, yarns, card, &settings, found[0].clone(), arguments.shakes as usize);
            (found, best)
        }
    };
    if !best.converged {
        return Err(Failure::new(
            Code::NotConverged,
            format_args!(
                "{}: not at rest after {} iterations, residual {:.1e}{}",
                arguments.scene.display(),
                best.iterations,
                best.residual,
                if needles.is_some() { "; try another --needle-pitch, or a smaller --take-down" } else { "" }
            ),
        ));
    }
    let (width, height) = (best.wale_spacing, best.course_spacing);
    let density = 1.0 / (width * height);
    let areal_mass = Census::of(&tile, yarns, card).areal_mass(density);
    let force = OffNeedles::force(yarns, card);
    if arguments.json {
        return output::json(&json!({
            "scene": arguments.scene,
            "repeat": { "rows": repeat.row_count(), "columns": repeat.column_count() },
            "wale_spacing_m": width,
            "course_spacing_m": height,
            "stitch_density_per_m2": density,
            "areal_mass_kg_per_m2": areal_mass,
            "energy_per_loop_J": best.energy,
            "iterations": best.iterations,
            "residual": best.residual,
            "shakes": if needles.is_some() { 0 } else { arguments.shakes },
            "off_needles": needles.map(|how| json!({
                "needle_pitch_m": how.pitch * card.loop_length,
                "take_down_N": how.take_down * force,
                "friction_N": how.friction * force,
            })),
            "starts": found.iter().map(|at| json!({
                "converged": at.converged,
                "wale_spacing_m": at.wale_spacing,
                "course_spacing_m": at.course_spacing,
                "energy_per_loop_J": at.energy,
            })).collect::<Vec<_>>(),
        }));
    }
    let [rows, columns] = opened.chart_size();
    say!("{}: at rest after {} iterations", arguments.scene.display(), best.iterations)?;
    if let Some(how) = needles {
        say!(
            "  needles  {:.3} mm apart, wales pulled with {:.3} mN; {:.3} mN to slide afterwards",
            1e3 * how.pitch * card.loop_length,
            1e3 * how.take_down * force,
            1e3 * how.friction * force
        )?;
    }
    say!("  repeat   {} rows, {} columns", repeat.row_count(), repeat.column_count())?;
    say!("  stitch   {:.3} mm wide, {:.3} mm high, {:.2} loops/cm²", 1e3 * width, 1e3 * height, 1e-4 * density)?;
    say!("  chart    {:.1} × {:.1} mm lying flat", 1e3 * width * columns as f64, 1e3 * height * rows as f64)?;
    say!("  mass     {:.0} g/m²", 1e3 * areal_mass)?;
    let others = found.iter().filter(|at| at.converged && at.energy > best.energy * (1.0 + 1e-6)).count();
    if others > 0 {
        say!("  starts   {others} of {} came to rest higher: the equilibrium is not unique", found.len())?;
    }
    if needles.is_none() && repeat.rows().iter().flatten().any(|stitch| *stitch == Stitch::YarnOver) {
        say!("  lace     keeps its width by friction, of which there is none here: see --off-needles")?;
    }
    Ok(())
}

/// What the fabric goes through on its needles: what is asked for, and the card's for the rest.
fn needles(arguments: &Relax, tile: &Network, yarns: &Yarns, card: &KnitCard) -> Result<OffNeedles, Failure> {
    let usual = OffNeedles::of(tile, yarns, card);
    // Between a yarn beside each needle and a loop that is drawn out straight, which has to go there and back.
    let bounds = [2.0 * yarns.first().radius, 0.5 * card.loop_length];
    if let Some(pitch) = arguments.needle_pitch.filter(|pitch| !(bounds[0]..=bounds[1]).contains(pitch)) {
        let [pitch, least, most] = [pitch, bounds[0], bounds[1]].map(|length| 1e3 * length);
        return Err(Failure::new(
            Code::BadInput,
            format_args!(
                "{}: --needle-pitch of {pitch:.3} mm: yarn {least:.3} mm thick in loops of {:.3} mm can be knitted on \
                 needles {least:.3} to {most:.3} mm apart",
                arguments.scene.display(),
                2.0 * most
            ),
        ));
    }
    Ok(OffNeedles {
        pitch: arguments.needle_pitch.map_or(usual.pitch, |pitch| pitch / card.loop_length),
        take_down: arguments.take_down.map_or(usual.take_down, |pull| pull / OffNeedles::force(yarns, card)),
        ..usual
    })
}
