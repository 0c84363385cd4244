//! Which yarn each stitch is of: stripes, a grid of names, or an image.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::Failure;
use super::beside::{path_beside, read_bytes};
use super::chart::{HERE, unknown_stitch};
use crate::pattern::image::{self, LARGEST_IMAGE, Pixels};
use crate::pattern::instructions::MOST_YARNS;
use crate::pattern::{Chart, Stitch};
use crate::scene::error::{Complaint, ErrorClass, shortened};
use crate::scene::schema::ChartText;

/// What an image draws, the lowest row first.
pub(super) enum Drawn {
    Stitches(PathBuf, Chart),
    Yarns(PathBuf, Grid),
}

/// Which yarn stands at every place: an image may have sixteen million of them.
#[derive(Clone, Default)]
pub(super) struct Grid {
    /// In alphabetical order, few enough for a byte.
    names: Vec<String>,
    /// The lowest row first.
    pub rows: Vec<Vec<u8>>,
}

impl Grid {
    fn new<'a>(key: &str, rows: &[Vec<&'a str>]) -> Result<Self, Complaint> {
        if rows.is_empty() || rows.iter().any(Vec::is_empty) {
            return Err(Complaint::new(key, "a row without a yarn"));
        }
        let names: BTreeSet<&'a str> = rows.iter().flatten().copied().collect();
        if names.len() > MOST_YARNS {
            return Err(Complaint::new(key, format!("{} yarns", names.len()))
                .why(format!("at most {MOST_YARNS} can be told apart")));
        }
        let names: Vec<&str> = names.into_iter().collect();
        let number = |name: &&str| names.binary_search(name).unwrap_or(0) as u8;
        let rows = rows.iter().map(|row| row.iter().map(number).collect()).collect();
        Ok(Self { rows, names: names.into_iter().map(str::to_owned).collect() })
    }
}

impl Drawn {
    pub fn path(&self) -> &Path {
        match self {
            Self::Stitches(path, _) | Self::Yarns(path, _) => path,
        }
    }
}

/// Reads the image of a chart, if it has one.
pub(super) fn image(text: &ChartText, directory: Option<&Path>) -> Result<Option<Drawn>, Failure> {
    let Some(name) = &text.image else {
        return match &text.palette {
            None => Ok(None),
            Some(_) => Err(Complaint::new(format!("{HERE}.palette"), "a palette without an image").into()),
        };
    };
    let key = format!("{HERE}.image");
    let Some(palette) = &text.palette else {
        return Err(Complaint::new(key, "an image without a palette")
            .mend("say what its colours are: palette = { \"#ffffff\" = \"A\", \"#c03020\" = \"B\" }")
            .into());
    };
    let path = path_beside(&key, name, directory)?;
    let bytes = read_bytes(&path, &key, name, LARGEST_IMAGE)?;
    let pixels = image::read_pixels(&bytes).map_err(|error| {
        let class = if error.is_size() { ErrorClass::ResourceLimit } else { ErrorClass::BadInput };
        Complaint::new(key.as_str(), format!("\"{}\": {error}", shortened(name))).class(class)
    })?;
    let mut meaning = BTreeMap::new();
    for (color, name) in palette {
        let rgb = image::color(color).ok_or_else(|| {
            Complaint::new(format!("{HERE}.palette.{color}"), format!("`{}` is no colour", shortened(color)))
                .mend("write six hexadecimal digits, as in \"#8a3324\"")
        })?;
        meaning.insert(rgb, name.as_str());
    }
    let grid = names(&pixels, &meaning)?;
    if meaning.values().all(|name| Stitch::read(name).is_none()) {
        return Ok(Some(Drawn::Yarns(path, Grid::new(&key, &grid)?)));
    }
    let known: BTreeMap<&str, Option<Stitch>> = meaning.values().map(|name| (*name, Stitch::read(name))).collect();
    let stitch = |name: &str| {
        known.get(name).copied().flatten().ok_or_else(|| {
            let color = palette.iter().find(|(_, known)| *known == name).map_or("", |(color, _)| color);
            unknown_stitch(&format!("{HERE}.palette.{color}"), name)
        })
    };
    let rows: Result<Vec<Vec<Stitch>>, Complaint> =
        grid.into_iter().map(|row| row.into_iter().map(stitch).collect()).collect();
    let chart = Chart::new(rows?).map_err(|error| Complaint::new(key.as_str(), error.to_string()))?;
    Ok(Some(Drawn::Stitches(path, chart)))
}

/// What the palette calls each pixel, the lowest row first.
fn names<'a>(pixels: &Pixels, meaning: &BTreeMap<[u8; 3], &'a str>) -> Result<Vec<Vec<&'a str>>, Complaint> {
    let mut rows = Vec::with_capacity(pixels.height);
    for (line, row) in pixels.colors.chunks(pixels.width).enumerate().rev() {
        let mut found = Vec::with_capacity(pixels.width);
        for (at, color) in row.iter().enumerate() {
            let [r, g, b] = color;
            found.push(*meaning.get(color).ok_or_else(|| {
                let what =
                    format!("the pixel {} from the left, {} from the top is #{r:02x}{g:02x}{b:02x}", at + 1, line + 1);
                Complaint::new(format!("{HERE}.palette"), what)
                    .why("the palette does not have this colour")
                    .mend(format!("add \"#{r:02x}{g:02x}{b:02x}\" to it, or save the image without smoothing"))
            })?);
        }
        rows.push(found);
    }
    Ok(rows)
}

/// The chart with the yarns that the scene gives its stitches, and the names of the yarns.
pub(super) fn assign(
    chart: Chart,
    named: Vec<String>,
    text: &ChartText,
    drawn: Option<&Drawn>,
) -> Result<(Chart, Vec<String>), Complaint> {
    let characters =
        |line: &'_ String| -> Vec<String> { line.chars().filter(|c| !c.is_whitespace()).map(String::from).collect() };
    let said = |rows: &[Vec<String>], key: &str| {
        let rows: Vec<Vec<&str>> = rows.iter().map(|row| row.iter().map(String::as_str).collect()).collect();
        Grid::new(&format!("{HERE}.{key}"), &rows)
    };
    let image = match drawn {
        Some(Drawn::Yarns(_, grid)) => Some(grid),
        _ => None,
    };
    let given = [
        ("stripes", text.stripes.is_some()),
        ("yarns", text.yarns.is_some()),
        ("image", image.is_some()),
        ("file", !named.is_empty()),
    ];
    let given: Vec<&str> = given.into_iter().filter(|(_, given)| *given).map(|(key, _)| key).collect();
    if let [first, second, ..] = given.as_slice() {
        let complaint = Complaint::new(format!("{HERE}.{second}"), format!("{first} and {second} both give the yarns"));
        return Err(complaint.mend("keep one of them"));
    }
    let (key, grid) = if let Some(stripes) = &text.stripes {
        ("stripes", said(&stripes.iter().map(|name| vec![name.clone()]).collect::<Vec<_>>(), "stripes")?)
    } else if let Some(lines) = &text.yarns {
        ("yarns", said(&lines.iter().rev().map(characters).collect::<Vec<_>>(), "yarns")?)
    } else if let Some(grid) = image {
        ("image", grid.clone())
    } else {
        return Ok((chart, named));
    };
    let yarns = chart
        .rows()
        .iter()
        .zip(grid.rows.iter().cycle())
        .map(|(row, yarns)| yarns.iter().copied().cycle().take(row.len()).collect());
    let yarns = yarns.collect();
    let chart = chart.with_yarns(yarns).map_err(|error| Complaint::new(format!("{HERE}.{key}"), error.to_string()))?;
    Ok((chart, grid.names))
}
