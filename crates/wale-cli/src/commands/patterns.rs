//! `wale patterns`: the stitch patterns that have a name.

use std::collections::BTreeSet;

use serde_json::json;
use wale::pattern::instructions::write_instructions;
use wale::pattern::library::patterns as library;
use wale::pattern::named::{PLAIN, named_pattern, names};
use wale::pattern::symbols::write_symbols;
use wale::pattern::{Chart, Stitch, Working};

use crate::arguments::Patterns;
use crate::commands::pattern_pictures;
use crate::exit::{Code, Failure};
use crate::{output, say};

/// Lists or shows them.
pub fn patterns(arguments: &Patterns) -> Result<(), Failure> {
    if let Some(folder) = &arguments.pictures {
        let all = || names().map(str::to_owned).collect();
        let names = arguments.name.as_ref().map_or_else(all, |name| vec![name.to_lowercase()]);
        return pattern_pictures::draw(&names, folder);
    }
    match &arguments.name {
        Some(name) => show(name, arguments.json),
        None => list(arguments.json),
    }
}

fn list(as_json: bool) -> Result<(), Failure> {
    if as_json {
        let plain = PLAIN.iter().map(|name| json!({ "name": name, "group": "plain" }));
        let all = plain.chain(library().iter().map(|pattern| {
            json!({
                "name": pattern.name,
                "group": pattern.group,
                "about": pattern.about,
                "columns": pattern.chart.cast_on(),
                "rows": pattern.chart.row_count(),
            })
        }));
        return output::json(&json!(all.collect::<Vec<_>>()));
    }
    say!("plain (with counts of your own)")?;
    for name in PLAIN {
        say!("  {name}")?;
    }
    let mut group = "";
    for pattern in library() {
        if pattern.group != group {
            group = &pattern.group;
            say!("{group}")?;
        }
        say!("  {:<22}{}", pattern.name, pattern.about)?;
    }
    say!("Show one with `wale patterns NAME`; knit it with pattern = \"NAME\" in a scene's [fabric.chart].")
}

fn show(name: &str, as_json: bool) -> Result<(), Failure> {
    let chart = named_pattern(name).map_err(|error| {
        Failure::new(Code::Usage, format_args!("{error}; `wale patterns` lists those that it knows"))
    })?;
    let about = library().iter().find(|pattern| pattern.name == name.to_lowercase()).map(|pattern| &pattern.about);
    let lines = write_symbols(&chart);
    // A flat piece of an odd number of rows comes to its other side when it is worked again.
    let rows = chart.row_count() * if chart.row_count().is_multiple_of(2) { 1 } else { 2 };
    let whole = chart.repeat(chart.cast_on(), rows).unwrap_or_else(|_| chart.clone());
    let instructions = write_instructions(&whole, Working::default());
    if as_json {
        return output::json(&json!({
            "name": name,
            "about": about,
            "columns": chart.cast_on(),
            "rows": chart.row_count(),
            "symbols": lines,
            "yarns": yarn_lines(&chart),
            "instructions": instructions,
        }));
    }
    say!("{name}: {} stitches, {} rows", chart.cast_on(), chart.row_count())?;
    if let Some(about) = about {
        say!("{about}")?;
    }
    say!("")?;
    let yarns = yarn_lines(&chart);
    for (at, line) in lines.iter().enumerate() {
        let yarns = yarns.get(at).map(|line| format!("    {line}")).unwrap_or_default();
        say!("  {:>3}  {line}{yarns}", lines.len() - at)?;
    }
    say!("")?;
    let used: BTreeSet<Stitch> = chart.rows().iter().flatten().copied().collect();
    let legend: Vec<String> = used.iter().map(|stitch| format!("{} {stitch}", stitch.symbol())).collect();
    say!("  as seen from the front: {}", legend.join(", "))?;
    say!("")?;
    for line in instructions.lines() {
        say!("  {line}")?;
    }
    Ok(())
}

/// The letters of the yarns, as the chart's lines; none of a single yarn.
fn yarn_lines(chart: &Chart) -> Vec<String> {
    if chart.yarn_count() == 1 {
        return Vec::new();
    }
    let line = |(row, stitches): (usize, &Vec<Stitch>)| {
        (0..stitches.len()).map(|at| char::from(b'A' + chart.yarn(row, at) % 26)).collect()
    };
    chart.rows().iter().enumerate().rev().map(line).collect()
}
