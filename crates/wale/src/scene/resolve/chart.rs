//! The stitches of a scene: a pattern by name, symbols, or a file of written instructions.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::beside::{path_beside, read_text};
use super::{Failure, exactly_one, yarns};
use crate::pattern::instructions::{self, LARGEST_TEXT, read_instructions};
use crate::pattern::knitout::{KnitoutError, KnitoutErrorReason, LARGEST_PROGRAM};
use crate::pattern::named::{self, NamedPatternError, named_pattern};
use crate::pattern::symbols::{Legend, default_legend, read_symbols};
use crate::pattern::{Chart, ChartError, NotHeld, Program, Side, Stitch, Structure, Working};
use crate::scene::error::{Complaint, ErrorClass, SceneError, nearest, shortened};
use crate::scene::schema::{ChartText, FirstRow, Worked};

/// The chart of a scene, how it is worked, the names of its yarns, and the files it was read from.
pub(super) struct Stitches {
    pub structure: Structure,
    /// By the chart's numbers; empty where none is named.
    pub yarns: Vec<String>,
    /// Those of them that are several yarns which run together, and which.
    pub together: BTreeMap<String, Vec<String>>,
    pub inputs: Vec<PathBuf>,
}

pub(super) const HERE: &str = "fabric.chart";

pub(super) fn resolve(text: Option<&ChartText>, directory: Option<&Path>) -> Result<Stitches, Failure> {
    let Some(text) = text else {
        return Err(Complaint::new("fabric", "the fabric has no chart and no weave")
            .mend("add [fabric.chart] with pattern = \"garter\", columns = 20 and rows = 20")
            .into());
    };
    // An image may give the yarns of stitches that something else gives.
    let drawn = yarns::image(text, directory)?;
    let image_of_stitches = matches!(drawn, Some(yarns::Drawn::Stitches(..)));
    let plain = matches!(drawn, Some(yarns::Drawn::Yarns(..)))
        && text.pattern.is_none()
        && text.symbols.is_none()
        && text.file.is_none();
    let given = [
        ("pattern", text.pattern.is_some() || plain),
        ("symbols", text.symbols.is_some()),
        ("image", image_of_stitches),
        ("file", text.file.is_some()),
        ("knitout", text.knitout.is_some()),
    ];
    exactly_one(HERE, &given)?;
    if text.legend.is_some() && text.symbols.is_none() {
        let complaint = Complaint::new(format!("{HERE}.legend"), "a legend without symbols");
        return Err(complaint.mend("leave the legend out, or draw the chart with symbols").into());
    }
    if let Some(program) = &text.knitout {
        let program = Program::new(program.clone()).map_err(|error| {
            Complaint::new(format!("{HERE}.knitout"), error.to_string()).class(program_class(&error))
        })?;
        return machine(text, program, Vec::new());
    }
    if let Some(name) = text.file.as_deref().filter(|name| is_program(Path::new(name))) {
        let key = format!("{HERE}.file");
        let path = path_beside(&key, name, directory)?;
        let content = read_text(&path, &key, name, LARGEST_PROGRAM)?;
        let program = Program::new(content.clone()).map_err(|error| {
            let complaint = Complaint::new("", error.to_string()).class(program_class(&error));
            let span = Some(error.span.clone());
            Failure::Elsewhere(Box::new(SceneError::new(complaint, &path.display().to_string(), &content, span)))
        })?;
        return machine(text, program, vec![path]);
    }
    let worked = working(text)?;
    let mut inputs: Vec<PathBuf> = drawn.iter().map(|drawn| drawn.path().to_path_buf()).collect();
    let (chart, working, named) = if let Some(name) = &text.pattern {
        let chart = sized(&pattern(name)?, text, true)?;
        // A pattern of several yarns names them itself, unless the scene does.
        let says = text.stripes.is_some() || text.yarns.is_some() || text.image.is_some();
        let count = if says { 1 } else { chart.yarn_count() };
        let letters = (0..count).filter(|_| count > 1).map(|yarn| char::from(b'A' + yarn as u8).to_string());
        (chart, worked, letters.collect())
    } else if let Some(lines) = &text.symbols {
        (sized(&symbols(lines, text)?, text, false)?, worked, Vec::new())
    } else if let Some(file) = text.file.as_deref() {
        let read = written(text, file, directory)?;
        inputs.push(read.input);
        (read.chart, read.working, read.yarns)
    } else {
        match &drawn {
            Some(yarns::Drawn::Stitches(_, chart)) => (sized(chart, text, false)?, worked, Vec::new()),
            // Yarns alone are knitted plain, as large as they are drawn.
            Some(yarns::Drawn::Yarns(_, grid)) => {
                let [columns, rows] = [grid.rows[0].len(), grid.rows.len()].map(|n| Some(n as u64));
                let text = ChartText { columns: text.columns.or(columns), rows: text.rows.or(rows), ..text.clone() };
                (sized(&Chart::stockinette(), &text, true)?, worked, Vec::new())
            }
            None => return Err(Complaint::new(HERE, "the chart has no stitches").into()),
        }
    };
    let together = if text.file.is_some() { named_together(&named) } else { BTreeMap::new() };
    let (chart, yarns) = yarns::assign(chart, named, text, drawn.as_ref())?;
    Ok(Stitches { structure: Structure::Chart { chart, working }, yarns, together, inputs })
}

/// The names that files give to yarns which run together: those of all of them, with spaces between, which no single yarn of a
/// file has in its name.
fn named_together(names: &[String]) -> BTreeMap<String, Vec<String>> {
    let several = names.iter().filter(|name| name.contains(' '));
    several.map(|name| (name.clone(), name.split(' ').map(str::to_owned).collect())).collect()
}

/// Whether a file is a machine's program, by its extension.
pub(in crate::scene) fn is_program(path: &Path) -> bool {
    path.extension().is_some_and(|kind| kind.eq_ignore_ascii_case("k") || kind.eq_ignore_ascii_case("knitout"))
}

/// A machine's program says all itself.
fn machine(text: &ChartText, program: Program, inputs: Vec<PathBuf>) -> Result<Stitches, Failure> {
    let beside = [
        ("columns", text.columns.is_some()),
        ("rows", text.rows.is_some()),
        ("worked", text.worked.is_some()),
        ("first_row", text.first_row.is_some()),
        ("stripes", text.stripes.is_some()),
        ("yarns", text.yarns.is_some()),
        ("legend", text.legend.is_some()),
        ("image", text.image.is_some()),
    ];
    if let Some((key, _)) = beside.iter().find(|(_, given)| *given) {
        let complaint = Complaint::new(format!("{HERE}.{key}"), format!("{key} beside a program in knitout"));
        return Err(complaint.why("the program says it itself").mend(format!("leave {key} out")).into());
    }
    let yarns = program.knitted.carriers.clone();
    let together = named_together(&yarns);
    Ok(Stitches { structure: Structure::Machine(Box::new(program)), yarns, together, inputs })
}

fn program_class(error: &KnitoutError) -> ErrorClass {
    match *error.reason {
        KnitoutErrorReason::TooLong { .. } | KnitoutErrorReason::TooManyLoops => ErrorClass::ResourceLimit,
        _ => ErrorClass::BadInput,
    }
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
        let near = nearest(name, named::names()).map(|near| format!("did you mean \"{near}\"? "));
        let plain = named::PLAIN.join(", ");
        complaint
            .mend(format!("{}patterns are: {plain}, and those that `wale patterns` lists", near.unwrap_or_default()))
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
    let columns = text.columns.unwrap_or(chart.cast_on() as u64);
    let rows = text.rows.unwrap_or(chart.row_count() as u64);
    let key = if text.columns >= text.rows { "columns" } else { "rows" };
    let refused = |error: ChartError| {
        size_complaint(format!("{HERE}.{key}"), error.to_string(), Some(&error)).mend("make the fabric smaller")
    };
    Chart::check_size(columns, rows).map_err(refused)?;
    // Checked above: both counts are below the limit of loops.
    chart.repeat(columns as usize, rows as usize).map_err(refused)
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
                let stitch =
                    Stitch::read(name).ok_or_else(|| unknown_stitch(&format!("{HERE}.legend.{symbol}"), name))?;
                legend.insert(c, stitch);
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

/// A name that is no stitch.
pub(super) fn unknown_stitch(path: &str, name: &str) -> Complaint {
    if let Some(not_held) = NotHeld::named(name) {
        return Complaint::new(path, format!("\"{}\" is {not_held}", shortened(name)));
    }
    let near = nearest(name, Stitch::all().map(|(name, ..)| name));
    let near = near.map(|near| format!("did you mean \"{near}\"? ")).unwrap_or_default();
    Complaint::new(path, format!("\"{}\" is no stitch that wale knows", shortened(name)))
        .mend(format!("{near}stitches are: {}", Stitch::names()))
}

/// What a file of written instructions says.
struct Read {
    chart: Chart,
    working: Working,
    yarns: Vec<String>,
    input: PathBuf,
}

/// A chart from a file of written instructions.
fn written(text: &ChartText, name: &str, directory: Option<&Path>) -> Result<Read, Failure> {
    let key = format!("{HERE}.file");
    let path = path_beside(&key, name, directory)?;
    let content = read_text(&path, &key, name, LARGEST_TEXT)?;
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
        && columns != chart.cast_on() as u64
    {
        return conflict("columns", format!("the file casts on {}, the scene {columns}", chart.cast_on()));
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
    Ok(Read { chart, working: read.working, yarns: read.yarns, input: path })
}
