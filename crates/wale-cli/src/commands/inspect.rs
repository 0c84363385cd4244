//! `wale inspect`: what a scene's fabric, or a run's, consists of and measures.

use serde_json::{Value, json};
use wale::measure::{Census, Shape, shadow_area};
use wale::model::{Frame, Network};
use wale::pattern::Structure;
use wale::record::{RunReader, Status};

use crate::arguments::{FrameChoice, Inspect};
use crate::exit::Failure;
use crate::opened::{OpenedRun, OpenedScene};
use crate::output::{self, grouped};
use crate::say;

/// Inspects it.
pub fn inspect(arguments: &Inspect) -> Result<(), Failure> {
    let path = &arguments.path;
    let (network, scene, frame, run);
    if path.is_dir() {
        let opened = OpenedRun::open(path, FrameChoice::Last)?;
        frame = opened.frame(opened.frames.start)?;
        run = Some(run_facts(&opened.reader, &frame)?);
        (network, scene) = (opened.network, opened.scene);
    } else {
        let opened = OpenedScene::read(path)?;
        opened.check_memory(None)?;
        network = opened.start().network;
        frame = initial(&network);
        run = None;
        scene = opened.scene;
    }
    let census = Census::of(&network, &scene.yarns, &scene.fabric);
    let shape = Shape::of(&network, &frame);
    let areal_mass = census.areal_mass(shape.stitch_density_per_m2);
    let shadow = shadow_area(&network, &frame, scene.fabric.cell());
    if arguments.json {
        let mut facts = json!({
            "path": path,
            "fabric": census,
            "shape": shape,
            "areal_mass_kg_per_m2": areal_mass,
            "shadow_area_m2": shadow,
        });
        if let Some(run) = run {
            facts["run"] = run;
        }
        return output::json(&facts);
    }
    say!("{}", path.display())?;
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
    yarns_and_flaws(&census, arguments.longest_float)?;
    remarks(&scene.structure)?;
    let [x, y, z] = shape.extent_m.map(|side| 1e3 * side);
    say!("  size     {x:.1} × {y:.1} × {z:.1} mm")?;
    say!("  shadow   {:.2} cm² from straight above", 1e4 * shadow)?;
    let [cell, cells] = match scene.fabric.woven() {
        Some(_) => ["crossing", "crossings"],
        None => ["stitch  ", "loops"],
    };
    say!(
        "  {cell} {:.2} mm wide, {:.2} mm high, {:.2} {cells}/cm²",
        1e3 * shape.wale_spacing_m,
        1e3 * shape.course_spacing_m,
        1e-4 * shape.stitch_density_per_m2
    )?;
    say!("  mass     {:.0} g/m²", 1e3 * areal_mass)?;
    say!(
        "  curl     sides {:+.1} 1/m along the course, ends {:+.1} 1/m along the wale (+ to the front)",
        shape.side_edges.course_per_m,
        shape.end_edges.wale_per_m
    )
}

/// Prints how much there is of each yarn, and what a knitter would mend: dropped loops and long floats.
pub fn yarns_and_flaws(census: &Census, longest_float: u32) -> Result<(), Failure> {
    if census.yarn_lengths_m.len() > 1 {
        for (at, length) in census.yarn_lengths_m.iter().enumerate() {
            let mass = 1e3 * census.yarn_masses_kg[at];
            say!("             {length:>8.3} m, {mass:.3} g of yarn {}", at + 1)?;
        }
    }
    let dropped = census.unsupported_loops.len();
    if dropped > 0 {
        let shown: Vec<String> = census
            .unsupported_loops
            .iter()
            .take(5)
            .map(|[row, column]| format!("row {} column {}", row + 1, column + 1))
            .collect();
        let more = if dropped > shown.len() { ", …" } else { "" };
        say!("  dropped  {dropped} loops that nothing holds: {}{more}", shown.join(", "))?;
    }
    let long = census.floats.iter().take_while(|float| **float > longest_float).count();
    if long > 0 {
        say!(
            "  floats   {long} pass more than {longest_float} stitches, the longest {}",
            census.floats.first().copied().unwrap_or(0)
        )?;
    }
    Ok(())
}

/// Prints what was unusual in the file that the fabric was read from.
pub fn remarks(structure: &Structure) -> Result<(), Failure> {
    for (line, what) in structure.remarks() {
        say!("  line {line:<4} {what}")?;
    }
    Ok(())
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

/// The initial layout as a frame.
fn initial(network: &Network) -> Frame {
    Frame { time: 0.0, positions: network.position.clone(), sliding: network.arc_length.clone() }
}
