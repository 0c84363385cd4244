//! The yarn of a fabric file, as a problem to be fitted.

use std::path::PathBuf;

use thiserror::Error;
use wale::energy::{BendingStiffness, ContactPhase, ContactReading};
use wale::scene::ErrorClass;

use super::objective::BendingTarget;
use super::problem::YarnProblem;
use super::pull::PullSettings;
use super::space::RodSpace;
use super::target::Target;
use crate::fabric_file::{FabricFile, Structure};
use crate::fabric_fit::FabricFit;
use crate::shell::uniform::uniform_stretch;
use crate::shell::{ShellError, StretchCurve, StretchPoint};
use crate::yarn_tile::{
    PatternFileError, RestShapeSettings, RodMaterial, RodParameter, StructureError, TileError, YarnTile,
    contact_radius, read_pattern, tile_of_chart, tile_of_draft,
};

/// What of the paper's model is left out, to see what it is for [Sperl2022, Figs. 16 to 18].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ablation {
    /// Yarns of one stiffness.
    pub one_phase: bool,
    /// Yarns at rest as they were registered.
    pub no_rest_shapes: bool,
    /// Bending stiffnesses are fitted too.
    pub with_bending: bool,
    /// Nothing holds the yarns, as in the paper.
    pub nothing_holds: bool,
}

/// Why a fabric's yarn cannot be fitted.
#[derive(Clone, Debug, Error)]
pub enum YarnProblemError {
    /// Nothing says how the yarns lie.
    #[error("nothing says how the yarns lie; add [structure] with a scene or a tile")]
    NoStructure,
    /// The file of the tile cannot be read.
    #[error("{}: {reason}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why not.
        reason: String,
    },
    /// It is no tile.
    #[error(transparent)]
    Pattern(#[from] PatternFileError),
    /// The chart or draft is no tile.
    #[error("the structure's scene: {0}")]
    Structure(#[from] StructureError),
    /// It cannot be brought to the spacings of the file.
    #[error("the tile does not come to rest with the spacings under [structure]: {0}; give others, or leave them out")]
    Spacing(#[from] TileError),
    /// The structure is neither a chart nor a draft.
    #[error("the structure's scene has neither a chart nor a draft that repeats; give the tile as a .pyp file")]
    NoRepeat,
    /// Curves cannot be made uniform.
    #[error(transparent)]
    Shell(#[from] ShellError),
}

impl YarnProblemError {
    /// What kind of error this is.
    #[must_use]
    pub fn class(&self) -> ErrorClass {
        ErrorClass::BadInput
    }
}

/// Part of the largest stress up to which fabrics are worn in comfort: the paper tests to 5 N, and takes 2 N for the end of comfort
/// [Sperl2022, section 4.3].
pub const COMFORT: f64 = 0.4;
/// Stiffness of a yarn of which none was measured, in tensions that it bears at the largest stress.
const STIFFNESS: [f64; 2] = [2.0, 500.0];
/// Bounds of the contact stiffness, in `k_s2/R_est`.
const CONTACT: [f64; 2] = [1e-5, 10.0];
/// Curvature to which tiles are bent, over one by the longer period [after Sperl2022, section 9.1].
const CURVATURE: f64 = 0.1;

/// Uniform stretches of a fabric, from what was measured between clamps.
///
/// Differs from the paper: there the fitted shell's own curves are the targets. A shell of a quadratic law leaves 10 to 20 % of the
/// force of a knit; here it only says how much a uniform strip differs from the clamped swatch, and what was measured is multiplied
/// by that. Test: `targets_of_a_shell_are_its_uniform_curves`.
///
/// # Errors
/// If the shell collapses at a stretch that was measured.
pub fn uniform_targets(fabric: &FabricFile, shell: &FabricFit) -> Result<Vec<Target>, ShellError> {
    let mut curves = Vec::new();
    for (test, points) in fabric.stretch.iter().zip(&shell.membrane.points) {
        let width = test.specimen.width;
        let uniform = |&[measured, clamped]: &[StretchPoint; 2]| -> Result<StretchPoint, ShellError> {
            let strip = uniform_stretch(&shell.membrane.stiffness, test.direction, measured.stretch)?.point;
            let ratio = |uniform: f64, clamped: f64, least: f64| {
                if clamped.abs() > least { (uniform / clamped).clamp(0.5, 2.0) } else { 1.0 }
            };
            let force = measured.force / width * ratio(strip.force * width, clamped.force, 0.0);
            let compression = measured.compression * ratio(strip.compression, clamped.compression, 1e-3);
            Ok(StretchPoint { stretch: measured.stretch, force, compression })
        };
        let points = points.iter().map(uniform).collect::<Result<Vec<_>, _>>()?;
        // A table that never leaves rest has no target.
        if !points.is_empty() {
            curves.push((StretchCurve { angle: test.direction, points }, test.curve.compression.is_some()));
        }
    }
    let largest = curves.iter().flat_map(|(curve, _)| &curve.points).fold(0.0f64, |m, p| m.max(p.force));
    Ok(curves.iter().map(|(curve, compression)| Target::new(curve, *compression, COMFORT * largest)).collect())
}

/// The tile of a fabric's structure.
///
/// # Errors
/// [`YarnProblemError`].
pub fn structure_tile(fabric: &FabricFile) -> Result<YarnTile, YarnProblemError> {
    match fabric.structure.as_ref().ok_or(YarnProblemError::NoStructure)? {
        Structure::Tile(path) => {
            let text = std::fs::read_to_string(path)
                .map_err(|error| YarnProblemError::File { path: path.clone(), reason: error.to_string() })?;
            Ok(read_pattern(&path.display().to_string(), &text)?)
        }
        Structure::Scene(scene) => {
            if let (Some(chart), Some(card)) = (scene.structure.chart(), scene.fabric.knit()) {
                let tile = tile_of_chart(chart, &scene.yarns, card)?;
                let repeat = chart.smallest_repeat();
                let counts = [repeat.column_count(), repeat.row_count()].map(|count| count as f64);
                let asked = |axis: usize| fabric.spacing[axis].map_or(tile.periods()[axis], |s| s * counts[axis]);
                return Ok(tile.pushed_to([asked(0), asked(1)])?);
            }
            let (Some(woven), Some(card)) = (scene.structure.woven(), scene.fabric.woven()) else {
                return Err(YarnProblemError::NoRepeat);
            };
            let radius = scene.yarns.first().radius;
            Ok(tile_of_draft(&woven.draft, radius, card.spacing, card.crimp_height)?)
        }
    }
}

/// The problem of a fabric whose shell is fitted.
///
/// # Errors
/// [`YarnProblemError`].
pub fn yarn_problem(
    fabric: &FabricFile,
    shell: &FabricFit,
    ablation: Ablation,
) -> Result<YarnProblem, YarnProblemError> {
    let tile = structure_tile(fabric)?;
    let targets = uniform_targets(fabric, shell)?;
    let stiffest = fabric.yarns.iter().filter_map(|yarn| yarn.stiffness).reduce(f64::max);
    let bending = match (&shell.bending, ablation.with_bending) {
        (Some(fit), true) => bending_targets(&fit.stiffness, &tile),
        _ => Vec::new(),
    };
    Ok(problem(tile, targets, bending, stiffest, ablation))
}

/// The problem of a tile and its targets; `stiffest` is the stiffness \[N\] of the stiffest yarn, if it was measured.
#[must_use]
pub fn problem(
    tile: YarnTile,
    targets: Vec<Target>,
    bending: Vec<BendingTarget>,
    stiffest: Option<f64>,
    ablation: Ablation,
) -> YarnProblem {
    let radius = contact_radius(&tile);
    let (mut space, stiff) = match stiffest {
        Some(stiffness) => (RodSpace::paper(stiffness, radius), stiffness),
        None => {
            let tension = tension(&tile, &targets);
            let stiff = tension * (STIFFNESS[0] * STIFFNESS[1]).sqrt();
            let bounds = STIFFNESS.map(|factor| factor * tension);
            let soft = [1e-3 * stiff, bounds[1]];
            let space = RodSpace::paper(stiff, radius).within(RodParameter::StiffStretch, bounds);
            (space.within(RodParameter::SoftStretch, soft), stiff)
        }
    };
    space = space.within(RodParameter::OuterContact, CONTACT.map(|factor| factor * stiff / radius));
    if !ablation.nothing_holds {
        space = space.with_holding();
    }
    if ablation.one_phase {
        // Without an onset the soft phase is never reached.
        space = space.holding(RodParameter::Onset, 0.0).holding(RodParameter::SoftStretch, stiff);
    }
    let inner = ContactPhase {
        radius: RodMaterial::INNER_RADIUS * radius,
        stiffness: (1e-2 * stiff / radius).max(RodMaterial::INNER_STIFFNESS),
    };
    let rod = RodMaterial::solid_rod(radius, 1.0, 1.0);
    let base = RodMaterial { contact: [rod.contact[0], inner], reading: ContactReading::Barrier, ..rod };
    YarnProblem {
        tile,
        base,
        space,
        targets,
        bending,
        rest_shapes: !ablation.no_rest_shapes,
        // Differs from the paper: no rounds that are cut short, at the few iterations of which rest shapes jump as numbers change, so
        // that no derivative leads to the bottom of a valley. Test: `a_yarn_is_found_again_from_its_curves`.
        rest: RestShapeSettings { early_rounds: 0, ..RestShapeSettings::default() },
        pull: PullSettings::default(),
    }
}

/// Tension \[N\] of a yarn at the largest stress, if the yarns that cross a period share it.
fn tension(tile: &YarnTile, targets: &[Target]) -> f64 {
    let [width, height] = tile.periods();
    let share = |target: &Target| {
        let stress = target.points.iter().fold(0.0f64, |m, p| m.max(p[1]));
        stress * width.min(height)
    };
    targets.iter().map(share).fold(0.0, f64::max).max(f64::MIN_POSITIVE)
}

/// Bending stiffnesses that the tile should have, along weft, bias and warp.
fn bending_targets(stiffness: &BendingStiffness, tile: &YarnTile) -> Vec<BendingTarget> {
    let curvature = CURVATURE / tile.periods()[0].max(tile.periods()[1]);
    let angles = [0.0, std::f64::consts::FRAC_PI_4, std::f64::consts::FRAC_PI_2];
    let all = angles.into_iter().zip(stiffness.to_array());
    all.map(|(angle, stiffness)| BendingTarget { angle, stiffness, curvature }).collect()
}
