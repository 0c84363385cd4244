//! From the words of a fabric file to numbers.

use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde::de::IntoDeserializer;
use serde::de::value::{Error as PlainError, StrDeserializer};
use wale::scene::dimensions::Angle;
use wale::scene::units::{Any, Quantity};
use wale::scene::{Scene, TextFile};

use super::known::known;
use super::schema::{FabricText, StructureText, TestText};
use super::{FabricFile, FabricFileError, LoopTest, Rigidity, SCHEMA, StretchTest, Structure, Yarn};
use crate::curve::{LoopCurve, Request, Specimen, StretchCurve, Table, TableFormat};
use crate::yarn_tile::RodParameter;

/// How far the shares of the yarns may be from the whole \[–\].
const ROUNDING: f64 = 0.011;
/// Specimen of [Sperl2022, section 4.3] \[m\].
const SPECIMEN: Specimen = Specimen { length: 0.1, width: 0.06 };

pub(super) fn fabric(path: &Path, file: &TextFile) -> Result<FabricFile, FabricFileError> {
    let text: FabricText = file.parse()?;
    if text.schema != SCHEMA {
        let what = format!("schema {} is not known", text.schema);
        return Err(file.error("schema", what, format!("write schema = {SCHEMA}")).into());
    }
    if !text.rigidity.is_empty() && !text.bending.is_empty() {
        let what = "bending is given twice, by loops and by rigidities".to_owned();
        return Err(file.error("rigidity.0", what, "leave one of them out").into());
    }
    let mut inputs = vec![path.to_owned()];
    let yarns: Vec<Yarn> = text.yarn.iter().map(yarn).collect();
    let shares: Vec<f64> = yarns.iter().filter_map(|yarn| yarn.share).collect();
    let whole: f64 = shares.iter().sum();
    if shares.len() == yarns.len() && !yarns.is_empty() && (whole - 1.0).abs() > ROUNDING || whole > 1.0 + ROUNDING {
        let what = format!("the shares of the yarns sum to {:.1} %", 100.0 * whole);
        return Err(file
            .error("yarn.0.share", what, "shares are parts of the fabric's mass; all of them are 100 %")
            .into());
    }
    let spacing = text.structure.as_ref().map_or([None; 2], |s| [s.wale_spacing, s.course_spacing]);
    let structure = text.structure.as_ref().map(|text| structure(text, file, &mut inputs)).transpose()?;
    let mut stretch = Vec::new();
    for (index, test) in text.stretch.iter().enumerate() {
        let read = Reading::of(test, &format!("stretch.{index}"), file, &mut inputs)?;
        let mut curve = StretchCurve::of(&read.table, &read.request, read.specimen)?;
        let mut specimen = read.specimen;
        if test.uniform {
            // Force goes with width.
            curve.force.iter_mut().for_each(|force| *force /= specimen.width);
            specimen.width = 1.0;
        }
        stretch.push(StretchTest { direction: read.direction, specimen, uniform: test.uniform, curve });
    }
    let mut bending = Vec::new();
    for (index, test) in text.bending.iter().enumerate() {
        let read = Reading::of(test, &format!("bending.{index}"), file, &mut inputs)?;
        if test.uniform {
            let what = "a loop is clamped".to_owned();
            return Err(file.error(&format!("bending.{index}.uniform"), what, "leave it out").into());
        }
        let curve = LoopCurve::of(&read.table, &read.request, read.specimen)?;
        bending.push(LoopTest { direction: read.direction, specimen: read.specimen, curve });
    }
    let mut rigidity = Vec::new();
    for (index, test) in text.rigidity.iter().enumerate() {
        let direction = direction(&test.direction, &format!("rigidity.{index}"), file)?;
        rigidity.push(Rigidity { direction, value: test.value.si() });
    }
    let known = known(text.held, text.within, file)?;
    if let (Some(_), Some(index)) = (known[RodParameter::StiffStretch as usize], stiffest(&yarns)) {
        let what = "the stiffness of a yarn is its k_s2, which is given again".to_owned();
        return Err(file.error(&format!("yarn.{index}.stiffness"), what, "leave one of them out").into());
    }
    rigidity.sort_by(|a, b| a.direction.total_cmp(&b.direction));
    stretch.sort_by(|a, b| a.direction.total_cmp(&b.direction));
    bending.sort_by(|a, b| a.direction.total_cmp(&b.direction));
    Ok(FabricFile {
        title: text.title.unwrap_or_default(),
        areal_mass: text.areal_mass.map(Quantity::si),
        assumed: text.assumed,
        yarns,
        structure,
        spacing: spacing.map(|spacing| spacing.map(Quantity::si)),
        stretch,
        bending,
        rigidity,
        known,
        inputs,
    })
}

/// The first yarn whose stiffness is given.
fn stiffest(yarns: &[Yarn]) -> Option<usize> {
    yarns.iter().position(|yarn| yarn.stiffness.is_some())
}

fn yarn(text: &super::schema::YarnText) -> Yarn {
    Yarn {
        name: text.name.clone(),
        linear_density: text.linear_density.si(),
        filaments: text.filaments,
        share: text.share.map(Quantity::si),
        stiffness: text.stiffness.map(Quantity::si),
        finish: text.finish.clone(),
    }
}

fn structure(text: &StructureText, file: &TextFile, inputs: &mut Vec<PathBuf>) -> Result<Structure, FabricFileError> {
    if text.tile.is_some() && (text.wale_spacing.is_some() || text.course_spacing.is_some()) {
        let what = "a tile says itself how far its wales and courses are apart".to_owned();
        return Err(file.error("structure.tile", what, "leave wale_spacing and course_spacing out").into());
    }
    match (&text.tile, &text.scene) {
        (Some(tile), None) => {
            let path = beside(file, "structure.tile", tile)?;
            inputs.push(path.clone());
            Ok(Structure::Tile(path))
        }
        (None, Some(scene)) => {
            let read = Scene::read_with_inputs(&beside(file, "structure.scene", scene)?)?;
            inputs.extend(read.inputs);
            Ok(Structure::Scene(Box::new(read.scene)))
        }
        _ => {
            let mend = "name one: tile = \"jersey.pyp\" or scene = \"jersey.toml\"";
            Err(file.error("structure", "a structure is one tile or one scene", mend).into())
        }
    }
}

/// A test's table and how it is to be read.
struct Reading {
    direction: f64,
    specimen: Specimen,
    table: Table,
    request: Request,
}

impl Reading {
    fn of(text: &TestText, key: &str, file: &TextFile, inputs: &mut Vec<PathBuf>) -> Result<Self, FabricFileError> {
        let path = beside(file, &format!("{key}.file"), &text.file)?;
        inputs.push(path.clone());
        Ok(Self {
            direction: direction(&text.direction, key, file)?,
            specimen: Specimen {
                length: text.length.map_or(SPECIMEN.length, Quantity::si),
                width: text.width.map_or(SPECIMEN.width, Quantity::si),
            },
            table: Table::read(&path, TableFormat { delimiter: text.delimiter, decimal: text.decimal })?,
            request: Request { columns: text.columns.clone(), units: text.units.clone(), only: text.only.clone() },
        })
    }
}

/// The angle of a direction from the weft \[rad\].
fn direction(text: &str, key: &str, file: &TextFile) -> Result<f64, FabricFileError> {
    let degrees = match text {
        "weft" | "course" => 0.0,
        "bias" => 45.0,
        "warp" | "wale" => 90.0,
        _ => {
            let source: StrDeserializer<'_, PlainError> = text.into_deserializer();
            let angle = Quantity::<Angle, Any>::deserialize(source).ok().map(|angle| angle.si().to_degrees());
            angle.filter(|angle| (-90.0..=180.0).contains(angle)).ok_or_else(|| {
                let what = format!("\"{}\" is no direction", text.chars().take(40).collect::<String>());
                file.error(
                    &format!("{key}.direction"),
                    what,
                    "write \"weft\", \"bias\", \"warp\", or an angle such as \"30 deg\"",
                )
            })?
        }
    };
    Ok(degrees.to_radians())
}

/// A file that lies beside the fabric file or below.
fn beside(file: &TextFile, key: &str, name: &str) -> Result<PathBuf, FabricFileError> {
    let path = file.directory().unwrap_or(Path::new("")).join(name);
    if path.is_file() {
        return Ok(path);
    }
    let what = format!("\"{name}\" is not there");
    Err(file.error(key, what, format!("it is looked for at {}", path.display())).into())
}
