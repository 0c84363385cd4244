//! The stitches of a scene: a pattern by name, symbols, or a file of written instructions.

use std::fs::File;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use super::{Failure, exactly_one};
use crate::pattern::instructions::{self, LARGEST_TEXT, read_instructions};
use crate::pattern::named::{self, NamedPatternError, named_pattern};
use crate::pattern::symbols::{Legend, default_legend, read_symbols};
use crate::pattern::{Chart, ChartError, Lean, Side, Stitch, Working};
use crate::scene::error::{Complaint, ErrorClass, SceneError, nearest, shortened};
use crate::scene::schema::{ChartText, FirstRow, StitchName, Worked};

/// The chart of a scene, how it is worked, and the files it was read from.
pub(super) struct Stitches {
    pub chart: Chart,
    pub working: Working,
    pub inputs: Vec<PathBuf>,
}

const HERE: &str = "fabric.chart";

pub(super) fn resolve(text: Option<&ChartText>, directory: Option<&Path>) -> Result<Stitches, Failure> {
    let Some(text) = text else {
        return Err(Complaint::new("fabric", "the fabric has no chart")
            .mend("add [fabric.chart] with pattern = \"garter\", columns = 20 and rows = 20")
            .into());
    };
    let given =
        [("pattern", text.pattern.is_some()), ("symbols", text.symbols.is_some()), ("file", text.file.is_some())];
    exactly_one(HERE, &given)?;
    if text.legend.is_some() && text.symbols.is_none() {
        let complaint = Complaint::new(format!("{HERE}.legend"), "a legend without symbols");
        return Err(complaint.mend("leave the legend out, or draw the chart with symbols").into());
    }
    let working = working(text)?;
    if let Some(name) = &text.pattern {
        let chart = sized(&pattern(name)?, text, true)?;
        return Ok(Stitches { chart, working, inputs: Vec::new() });
    }
    if let Some(lines) = &text.symbols {
        let chart = sized(&symbols(lines, text)?, text, false)?;
        return Ok(Stitches { chart, working, inputs: Vec::new() });
    }
    written(text, text.file.as_deref().unwrap_or_default(), directory)
}

fn working(text: &ChartText) -> Result<Working, Complaint> {
    match (text.worked, text.first_row) {
        (Some(Worked::Round), Some(_)) => {
            Err(Complaint::new(format!("{HERE}.first_row"), "a fabric in the round has no first_row")
                .why("all its rounds are worked from the right side")
                .mend("leave first_row out"))
        }
        (Some(Worked::Round), None) => Ok(Working::Round),
        (_, Some(FirstRow::WrongSide)) => Ok(Working::Flat { first_row: Side::WrongSide }),
        _ => Ok(Working::default()),
    }
}

fn pattern(name: &str) -> Result<Chart, Complaint> {
    named_pattern(name).map_err(|error| {
        let complaint = size_complaint(
            format!("{HERE}.pattern"),
            error.to_string(),
            match &error {
                NamedPatternError::Size(size) => Some(size),
                _ => None,
            },
        );
        let near = nearest(name, named::NAMES).map(|near| format!("did you mean \"{near}\"? "));
        complaint.mend(format!("{}patterns are: {}", near.unwrap_or_default(), named::NAMES.join(", ")))
    })
}

/// A size error; too large a chart is no wrong input but one that asks for too much.
fn size_complaint(path: String, what: String, size: Option<&ChartError>) -> Complaint {
    match size {
        Some(ChartError::TooLarge { .. }) => Complaint::new(path, what).class(ErrorClass::ResourceLimit),
        _ => Complaint::new(path, what),
    }
}

/// The chart repeated to the size that the scene asks for.
fn sized(chart: &Chart, text: &ChartText, required: bool) -> Result<Chart, Complaint> {
    for (key, count) in [("columns", text.columns), ("rows", text.rows)] {
        if required && count.is_none() {
            let complaint = Complaint::new(HERE, format!("a pattern needs {key}"));
            return Err(complaint.mend(format!("add {key} = 20")));
        }
        if count == Some(0) {
            let complaint = Complaint::new(format!("{HERE}.{key}"), format!("{key} must be at least 1"));
            return Err(complaint);
        }
    }
    let columns = text.columns.unwrap_or(chart.column_count() as u64);
    let rows = text.rows.unwrap_or(chart.row_count() as u64);
    let key = if text.columns >= text.rows { "columns" } else { "rows" };
    let refused = |error: ChartError| {
        size_complaint(format!("{HERE}.{key}"), error.to_string(), Some(&error)).mend("make the fabric smaller")
    };
    Chart::check_size(columns, rows).map_err(refused)?;
    // Checked above: both counts are below the limit of loops.
    chart.repeat(columns as usize, rows as usize).map_err(refused)
}

fn stitch_of(name: StitchName) -> Stitch {
    let together = |knit, loops, lean| Stitch::Together { knit, loops, lean };
    match name {
        StitchName::Knit => Stitch::Knit,
        StitchName::Purl => Stitch::Purl,
        StitchName::Yo => Stitch::YarnOver,
        StitchName::K2tog => together(true, 2, Lean::Right),
        StitchName::Ssk => together(true, 2, Lean::Left),
        StitchName::P2tog => together(false, 2, Lean::Right),
        StitchName::Ssp => together(false, 2, Lean::Left),
        StitchName::K3tog => together(true, 3, Lean::Right),
        StitchName::Sssk => together(true, 3, Lean::Left),
        StitchName::P3tog => together(false, 3, Lean::Right),
        StitchName::Sssp => together(false, 3, Lean::Left),
        StitchName::Cdd => together(true, 3, Lean::Centre),
        StitchName::Cddp => together(false, 3, Lean::Centre),
    }
}

fn symbols(lines: &[String], text: &ChartText) -> Result<Chart, Complaint> {
    let legend = match &text.legend {
        None => default_legend(),
        Some(own) => {
            let mut legend = Legend::new();
            for (symbol, name) in own {
                let mut characters = symbol.chars();
                let (Some(c), None) = (characters.next(), characters.next()) else {
                    let path = format!("{HERE}.legend.{symbol}");
                    let what = format!("\"{}\" is not one symbol", shortened(symbol));
                    return Err(Complaint::new(path, what).why("every stitch of a chart is one character"));
                };
                legend.insert(c, stitch_of(*name));
            }
            legend
        }
    };
    read_symbols(lines, &legend).map_err(|error| {
        let size = match &error.reason {
            crate::pattern::symbols::SymbolErrorReason::Chart(size) => Some(size.clone()),
            _ => None,
        };
        let place = match &error.bytes {
            Some(bytes) => format!("{HERE}.symbols.{}.{}-{}", error.line, bytes.start, bytes.end),
            None => format!("{HERE}.symbols.{}", error.line),
        };
        size_complaint(place, error.to_string(), size.as_ref())
            .why("every row has the same number of stitches, and every symbol a meaning")
    })
}

/// A chart from a file of written instructions.
fn written(text: &ChartText, name: &str, directory: Option<&Path>) -> Result<Stitches, Failure> {
    let path = path_beside(name, directory)?;
    let content = read_text(&path, name)?;
    let columns = text.columns.map(|columns| usize::try_from(columns).unwrap_or(usize::MAX));
    let read = read_instructions(&content, columns).map_err(|error| {
        let class = match &error.reason {
            instructions::InstructionErrorReason::Size(ChartError::TooLarge { .. }) => ErrorClass::ResourceLimit,
            _ => ErrorClass::BadInput,
        };
        let span = (error.span != (0..0)).then(|| error.span.clone());
        let complaint = Complaint::new("", error.to_string()).class(class);
        Failure::Elsewhere(Box::new(SceneError::new(complaint, &path.display().to_string(), &content, span)))
    })?;
    let conflict = |key: &str, what: String| {
        Err(Complaint::new(format!("{HERE}.{key}"), what).mend(format!("leave {key} out, or change the file")).into())
    };
    let chart = read.chart;
    if let Some(columns) = text.columns
        && columns != chart.column_count() as u64
    {
        return conflict("columns", format!("the file casts on {}, the scene {columns}", chart.column_count()));
    }
    let round = read.working == Working::Round;
    if text.worked.is_some_and(|worked| (worked == Worked::Round) != round) {
        let worked = if round { "in the round (Rnd)" } else { "flat (Row)" };
        return conflict("worked", format!("the file is worked {worked}"));
    }
    if text.first_row.is_some() {
        return conflict("first_row", "the file says which side its first row is on".to_owned());
    }
    if let Some(rows) = text.rows
        && !round
        && rows > chart.row_count() as u64
        && chart.row_count() % 2 == 1
    {
        return Err(Complaint::new(format!("{HERE}.rows"), format!("{} rows repeated flat", chart.row_count()))
            .why("an odd number of rows comes to the other side when it is worked again")
            .mend("write the rows out twice in the file")
            .into());
    }
    let chart = sized(&chart, text, false)?;
    Ok(Stitches { chart, working: read.working, inputs: vec![path] })
}

/// A file that lies in the scene's folder or below it, links followed.
fn path_beside(name: &str, directory: Option<&Path>) -> Result<PathBuf, Complaint> {
    let complain = |what: String| {
        Complaint::new(format!("{HERE}.file"), what)
            .why("a chart file lies in the folder of its scene, or below it")
            .mend("write for instance file = \"rib.knit\"")
    };
    let shown = shortened(name);
    let inside = !name.is_empty()
        && !name.contains(['\\', ':', '\0'])
        && Path::new(name).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if !inside {
        return Err(complain(format!("\"{}\" is not a path inside the scene's folder", shown.escape_debug())));
    }
    let Some(directory) = directory else {
        return Err(complain("this scene has no folder to read files from".to_owned()));
    };
    // A scene that is given by its bare name lies in the working directory.
    let directory = if directory.as_os_str().is_empty() { Path::new(".") } else { directory };
    let path = directory.join(name);
    let unreadable = |error: &std::io::Error| unreadable(&shown, error);
    let real = path.canonicalize().map_err(|error| unreadable(&error))?;
    let folder = directory.canonicalize().map_err(|error| unreadable(&error))?;
    if !real.starts_with(&folder) {
        return Err(complain(format!("\"{shown}\" leads out of the scene's folder")));
    }
    if !real.is_file() {
        return Err(complain(format!("\"{shown}\" is no file")));
    }
    Ok(path)
}

fn unreadable(name: &str, error: &std::io::Error) -> Complaint {
    let complaint = Complaint::new(format!("{HERE}.file"), format!("\"{name}\" cannot be read: {error}"));
    match error.kind() {
        std::io::ErrorKind::NotFound => complaint.mend("check the name; it is relative to the scene's folder"),
        _ => complaint.class(ErrorClass::InputOutput),
    }
}

/// The text of a file, no more than is allowed of it.
fn read_text(path: &Path, name: &str) -> Result<String, Complaint> {
    let mut bytes = Vec::new();
    let limit = LARGEST_TEXT as u64 + 1;
    File::open(path)
        .and_then(|file| file.take(limit).read_to_end(&mut bytes))
        .map_err(|error| unreadable(&shortened(name), &error))?;
    String::from_utf8(bytes).map_err(|_| {
        let what = format!("\"{}\" is not text in UTF-8", shortened(name));
        Complaint::new(format!("{HERE}.file"), what)
    })
}
