//! `wale check`: whether a scene is sound, how large it is, and what it will take.

use serde_json::json;
use wale::record::{Checkpoints, Frames};

use crate::arguments::Check;
use crate::commands::census::{FabricFacts, laid_out};
use crate::commands::topology::topology;
use crate::exit::Failure;
use crate::opened::OpenedScene;
use crate::output::{bytes, grouped, span};
use crate::{machine, output, say};

/// Checks it.
pub fn check(arguments: &Check) -> Result<(), Failure> {
    if arguments.topology {
        return topology(arguments);
    }
    let opened = OpenedScene::read_with_yarn(&arguments.scene, arguments.yarn)?;
    if arguments.resolved {
        return output::line(format_args!("{}", opened.resolved()?.trim_end()));
    }
    opened.check_memory(arguments.limits.max_memory)?;
    let [rows, columns] = opened.chart_size();
    let estimate = opened.estimate();
    let network = opened.measured_network();
    let facts = FabricFacts::of(&opened.scene, &network, &laid_out(&network), opened.assumed);
    let census = &facts.census;
    let plan = &opened.scene.plan.simulation;
    let frames = (plan.duration * plan.frame_rate + 1e-6).floor() as u64 + 1;
    let frame_bytes = Frames::byte_count(census.nodes, census.passes);
    let checkpoint_bytes = Checkpoints::byte_count_of(census.nodes, census.passes);
    let files = frames.saturating_mul(frame_bytes).saturating_add(2 * checkpoint_bytes);
    let seconds = estimate.seconds(plan.duration, plan.largest_step);
    if arguments.json {
        let mut told = facts.json();
        told["scene"] = json!(arguments.scene);
        told["frames"] = json!(frames);
        let items = estimate.memory.iter().map(|(name, bytes)| json!({"item": name, "bytes": bytes}));
        told["memory"] = items.collect();
        told["memory_bytes"] = json!(estimate.total());
        told["files_bytes"] = json!(files);
        told["time_s"] = json!({ "least": seconds[0], "most": seconds[1] });
        return output::json(&told);
    }
    say!("{}: sound", arguments.scene.display())?;
    facts.say_assumed()?;
    let cells = grouped(census.loops as u64);
    if opened.scene.structure.woven().is_some() {
        say!("  draft    {columns} ends, {rows} picks, {cells} crossings")?;
    } else {
        say!("  chart    {rows} rows, {columns} columns, {cells} loops")?;
    }
    say!(
        "  fabric   {} nodes, {} degrees of freedom, {:.2} m of yarn, {:.2} g",
        grouped(census.nodes as u64),
        grouped(census.degrees_of_freedom as u64),
        census.yarn_length_m,
        1e3 * census.mass_kg
    )?;
    facts.say(arguments.longest_float)?;
    say!(
        "  run      {} s, {} frames, steps of at most {} ms",
        plan.duration,
        grouped(frames),
        1e3 * plan.largest_step
    )?;
    say!("  memory   about {}", bytes(estimate.total()))?;
    for (name, size) in &estimate.memory {
        say!("             {:>9}  {name}", bytes(*size))?;
    }
    if let Some(free) = machine::available_memory() {
        say!("             {:>9}  free now", bytes(free))?;
    }
    say!("  files    about {}", bytes(files))?;
    say!("  time     {} to {}, by the speed of a common machine", span(seconds[0]), span(seconds[1]))
}
