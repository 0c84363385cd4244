//! `wale inspect`: what a scene's fabric, or a run's, consists of and measures.

use serde_json::{Value, json};
use wale::measure::shadow_area;
use wale::model::Frame;
use wale::record::{RunReader, Status};

use crate::arguments::{FrameChoice, Inspect};
use crate::commands::census::{FabricFacts, laid_out};
use crate::exit::Failure;
use crate::opened::{OpenedRun, OpenedScene, no_yarn};
use crate::output::{self, grouped};
use crate::say;

/// Inspects it.
pub fn inspect(arguments: &Inspect) -> Result<(), Failure> {
    let path = &arguments.path;
    let (network, scene, frame, run, assumed);
    if path.is_dir() {
        no_yarn(path, arguments.yarn)?;
        let opened = OpenedRun::open(path, FrameChoice::Last)?;
        frame = opened.frame(opened.frames.start)?;
        run = Some(run_facts(&opened.reader, &frame)?);
        (network, scene, assumed) = (opened.network, opened.scene, None);
    } else {
        let opened = OpenedScene::read_with_yarn(path, arguments.yarn)?;
        opened.check_memory(None)?;
        network = opened.measured_network();
        frame = laid_out(&network);
        run = None;
        (scene, assumed) = (opened.scene, opened.assumed);
    }
    let facts = FabricFacts::of(&scene, &network, &frame, assumed);
    let FabricFacts { census, shape, .. } = &facts;
    let shadow = shadow_area(&network, &frame, scene.fabric.cell());
    if arguments.json {
        let mut told = facts.json();
        told["path"] = json!(path);
        told["shadow_area_m2"] = json!(shadow);
        if let Some(run) = run {
            told["run"] = run;
        }
        return output::json(&told);
    }
    say!("{}", path.display())?;
    facts.say_assumed()?;
    if let Some(run) = &run {
        let text = |key: &str| run[key].as_str().unwrap_or_default().to_owned();
        say!("  run      {}, {} frames, last at {} s", text("status"), run["frames"], run["time_s"])?;
    }
    let (rows, columns) = (census.rows, census.columns);
    if let Some(card) = scene.fabric.woven() {
        let up = 100.0 * census.knit_loops as f64 / census.loops.max(1) as f64;
        say!("  threads  {columns} ends, {rows} picks; the warp lies on top at {up:.0} % of the crossings")?;
        let [warp, weft] = card.crimp.map(|crimp| 100.0 * crimp);
        say!("  crimp    {warp:.2} % of the warp, {weft:.2} % of the weft")?;
    } else {
        say!(
            "  loops    {} ({rows} rows, {columns} columns; {} knit as seen from the front)",
            grouped(census.loops as u64),
            grouped(census.knit_loops as u64)
        )?;
    }
    say!("  nodes    {}", grouped(census.nodes as u64))?;
    for (size, count) in census.nodes_by_stack_size.iter().enumerate().filter(|(_, count)| **count > 0) {
        say!("             {:>9}  with a stack of {size}", grouped(*count as u64))?;
    }
    say!("  freedom  {} coordinates", grouped(census.degrees_of_freedom as u64))?;
    say!(
        "  yarn     {} in {:.3} m, {:.3} g",
        if census.yarns == 1 { "one".to_owned() } else { census.yarns.to_string() },
        census.yarn_length_m,
        1e3 * census.mass_kg
    )?;
    facts.say(arguments.longest_float)?;
    let [x, y, z] = shape.extent_m.map(|side| 1e3 * side);
    say!("  size     {x:.1} × {y:.1} × {z:.1} mm")?;
    say!("  shadow   {:.2} cm² from straight above", 1e4 * shadow)?;
    say!(
        "  curl     sides {:+.1} 1/m along the course, ends {:+.1} 1/m along the wale (+ to the front)",
        shape.side_edges.course_per_m,
        shape.end_edges.wale_per_m
    )
}

fn run_facts(reader: &RunReader, last: &Frame) -> Result<Value, Failure> {
    let status = match reader.status()? {
        Status::Running if !reader.is_held() => "killed (go on with `wale resume`)".to_owned(),
        status => status.to_string(),
    };
    Ok(json!({
        "status": status,
        "frames": reader.frames().count()?,
        "time_s": last.time,
        "version": reader.environment()?.version,
    }))
}
