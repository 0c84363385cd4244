//! A chart, a machine's program, an image or a draft without a scene: the scene that says no more than its file and its yarn.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::error::{Complaint, ErrorClass, SceneError};
use super::resolve::{self, Failure};
use super::schema::{ChartText, Color, FabricText, PresetName, SceneText, WeaveText, YarnText};
use super::{SCHEMA, SceneFile};
use crate::pattern::image::{self, LARGEST_IMAGE};
use crate::pattern::instructions::MOST_YARNS;

/// What a file describes without a scene, by its extension.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Written instructions, or a program in knitout.
    Chart,
    /// A yarn a pixel.
    Image,
    Draft,
}

fn kind(path: &Path) -> Option<Kind> {
    let extension = path.extension()?.to_str()?.to_ascii_lowercase();
    match extension.as_str() {
        "knit" | "txt" => Some(Kind::Chart),
        "png" => Some(Kind::Image),
        "wif" => Some(Kind::Draft),
        _ => resolve::is_program(path).then_some(Kind::Chart),
    }
}

/// Whether a file is the chart or the draft of a fabric, and no scene: instructions (`.knit`, `.txt`), knitout (`.k`, `.knitout`), an
/// image of yarns (`.png`) or a draft (`.wif`).
#[must_use]
pub fn is_bare(path: &Path) -> bool {
    kind(path).is_some()
}

/// The scene of such a file, of a yarn that wale knows.
///
/// # Errors
/// If the file cannot be read, something in it is wrong, or it does not say what a scene would have to.
pub fn read_bare(path: &Path, yarn: PresetName) -> Result<SceneFile, SceneError> {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let kind = kind(path).unwrap_or(Kind::Chart);
    let text = scene_of(path, kind, name, yarn).map_err(Failure::Here);
    match text.and_then(|text| resolve::scene(&text, path.parent())) {
        Ok((scene, inputs)) => Ok(SceneFile { scene, inputs }),
        Err(Failure::Elsewhere(error)) => Err(*error),
        Err(Failure::Here(mut complaint)) => {
            // What a scene would say has no place in the file.
            let table = match kind {
                Kind::Chart => Some("chart"),
                Kind::Draft => Some("weave"),
                Kind::Image => None,
            };
            if let (Some(table), Some(mend)) = (table, &mut complaint.mend) {
                let yarn = yarn.name();
                mend.push_str(&format!(": in a scene, with file = \"{name}\" under [fabric.{table}]; "));
                mend.push_str(&format!("the yarn {yarn} was assumed, and --yarn takes another"));
            }
            Err(SceneError::new(complaint, &path.display().to_string(), "", None))
        }
    }
}

fn scene_of(path: &Path, kind: Kind, name: &str, preset: PresetName) -> Result<SceneText, Complaint> {
    let file = File::open(path).map_err(|error| unreadable(&error))?;
    let name = Some(name.to_owned());
    let mut yarns = BTreeMap::new();
    let mut fabric = FabricText::default();
    match kind {
        Kind::Chart => fabric.chart = Some(ChartText { file: name, ..ChartText::default() }),
        Kind::Draft => fabric.weave = Some(WeaveText { file: name, ..WeaveText::default() }),
        Kind::Image => {
            let colors = colors_of(file)?;
            let hex = |[r, g, b]: [u8; 3]| format!("#{r:02x}{g:02x}{b:02x}");
            // Every colour is a yarn that is called by it.
            let palette = colors.iter().map(|color| (hex(*color), hex(*color))).collect();
            yarns.extend(
                colors
                    .iter()
                    .map(|color| (hex(*color), YarnText { color: Some(Color(*color)), ..YarnText::default() })),
            );
            fabric.chart = Some(ChartText { image: name, palette: Some(palette), ..ChartText::default() });
        }
    }
    Ok(SceneText {
        schema: SCHEMA,
        title: None,
        yarn: Some(YarnText { preset: Some(preset), ..YarnText::default() }),
        yarns,
        fabric,
        simulation: None,
        output: None,
        obstacle: Vec::new(),
        grip: Vec::new(),
    })
}

/// The colours of an image, few enough to be those of yarns.
fn colors_of(file: File) -> Result<BTreeSet<[u8; 3]>, Complaint> {
    let mut bytes = Vec::new();
    file.take(LARGEST_IMAGE as u64 + 1).read_to_end(&mut bytes).map_err(|error| unreadable(&error))?;
    let pixels = image::read_pixels(&bytes).map_err(|error| {
        let class = if error.is_size() { ErrorClass::ResourceLimit } else { ErrorClass::BadInput };
        Complaint::new("", error.to_string()).class(class)
    })?;
    let colors: BTreeSet<[u8; 3]> = pixels.colors.into_iter().collect();
    if colors.len() > MOST_YARNS {
        let what = format!("the image has {} colours, and at most {MOST_YARNS} yarns can be told apart", colors.len());
        return Err(Complaint::new("", what)
            .mend("draw it with one colour for each yarn, or save it without smoothing and lossy compression"));
    }
    Ok(colors)
}

fn unreadable(error: &std::io::Error) -> Complaint {
    let complaint = Complaint::new("", format!("the file cannot be read: {error}"));
    match error.kind() {
        std::io::ErrorKind::NotFound => complaint,
        _ => complaint.class(ErrorClass::InputOutput),
    }
}
