//! The yarn of a fabric file, as a problem to be fitted.

use std::path::PathBuf;

use thiserror::Error;
use wale::energy::{BendingStiffness, ContactPhase, ContactReading};
use wale::scene::ErrorClass;

pub use super::ablation::Ablation;
use super::objective::BendingTarget;
use super::problem::YarnProblem;
use super::pull::PullSettings;
use super::space::RodSpace;
use super::target::Target;
use crate::fabric_file::{FabricFile, Rigidity, Structure};
use crate::shell::of_fabric::ShellFit;
use crate::shell::uniform::uniform_stretch;
use crate::shell::{ShellError, StretchCurve, StretchPoint};
use crate::yarn_tile::{
    PatternFileError, RestShapeSettings, RodMaterial, RodParameter, StructureError, TileError, Unsound, YarnTile,
    contact_radius, read_pattern, tile_of_chart, tile_of_draft, unsound,
};

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
    /// The tile is no fabric.
    #[error("{}: {reason}", .path.display())]
    Unsound {
        /// The file.
        path: PathBuf,
        /// Why not.
        reason: Unsound,
    },
    /// The chart or draft is no tile.
    #[error("the structure's scene: {0}")]
    Structure(#[from] StructureError),
    /// It cannot be brought to the spacings of the file.
    #[error("the tile does not come to rest with the spacings under [structure]: {0}; give others, or leave them out")]
    Spacing(#[from] TileError),
    /// The structure is neither a chart nor a draft.
    #[error("the structure's scene has neither a chart nor a draft that repeats; give the tile as a .pyp file")]
    NoRepeat,
    /// Fabrics of one yarn say different things of it.
    #[error("the fabrics are not of one yarn: its stiffness is {} N in one file and {} N in another", .stiffness[0], .stiffness[1])]
    OtherYarn {
        /// The stiffness \[N\] in both.
        stiffness: [f64; 2],
    },
    /// Or of one of its numbers.
    #[error("the fabrics are not of one yarn: what [held] and [within] say of its {name} is not the same in all files")]
    OtherNumber {
        /// The number.
        name: &'static str,
    },
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
/// How far stiffnesses of one yarn may be apart in two files \[–\]: they were rounded.
const SAME: f64 = 1e-2;
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
pub fn uniform_targets(fabric: &FabricFile, shell: &ShellFit) -> Result<Vec<Target>, ShellError> {
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
            let tile = read_pattern(&path.display().to_string(), &text)?;
            match unsound(&tile) {
                Some(reason) => Err(YarnProblemError::Unsound { path: path.clone(), reason }),
                None => Ok(tile),
            }
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

/// What a fabric adds to the problem of its yarn.
#[derive(Clone, Debug)]
pub struct Part {
    /// How its yarns lie.
    pub tile: YarnTile,
    /// Uniform stretches.
    pub targets: Vec<Target>,
    /// Bending stiffnesses, empty if they are not fitted.
    pub bending: Vec<BendingTarget>,
}

/// The problem of a fabric whose shell is fitted.
///
/// # Errors
/// [`YarnProblemError`].
pub fn yarn_problem(
    fabric: &FabricFile,
    shell: &ShellFit,
    ablation: Ablation,
) -> Result<YarnProblem, YarnProblemError> {
    yarn_problems(&[(fabric, shell)], ablation).map(|mut problems| problems.remove(0))
}

/// The problems of fabrics of one yarn whose shells are fitted, in their order.
///
/// # Errors
/// [`YarnProblemError`].
pub fn yarn_problems(
    fabrics: &[(&FabricFile, &ShellFit)],
    ablation: Ablation,
) -> Result<Vec<YarnProblem>, YarnProblemError> {
    let mut parts = Vec::with_capacity(fabrics.len());
    let mut known = fabrics.first().map_or([None; RodParameter::COUNT], |(fabric, _)| fabric.known);
    let stiff = RodParameter::StiffStretch as usize;
    let mut stiffest = known[stiff].filter(|[least, largest]| least == largest).map(|[value, _]| value);
    for (fabric, shell) in fabrics {
        if let Some(k) = (0..RodParameter::COUNT).find(|&k| fabric.known[k] != known[k]) {
            return Err(YarnProblemError::OtherNumber { name: RodParameter::NAMES[k] });
        }
        let tile = structure_tile(fabric)?;
        let targets = uniform_targets(fabric, shell)?;
        let bending = if ablation.with_bending { bending_targets(fabric, shell, &tile) } else { Vec::new() };
        parts.push(Part { tile, targets, bending });
        if let Some(stiffness) = fabric.yarns.iter().filter_map(|yarn| yarn.stiffness).reduce(f64::max) {
            match stiffest {
                Some(other) if (other / stiffness - 1.0).abs() > SAME => {
                    return Err(YarnProblemError::OtherYarn { stiffness: [other, stiffness] });
                }
                _ => stiffest = Some(stiffness),
            }
        }
    }
    // What an ablation leaves out is not to be had either.
    if ablation.one_phase {
        known[RodParameter::Onset as usize] = None;
        known[RodParameter::SoftStretch as usize] = None;
    }
    if ablation.nothing_holds {
        known[RodParameter::Holding as usize] = None;
    }
    let mut problems = problems(parts, stiffest, ablation);
    problems.iter_mut().for_each(|problem| problem.space = problem.space.narrowed(&known));
    Ok(problems)
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
    problems(vec![Part { tile, targets, bending }], stiffest, ablation).remove(0)
}

/// The problems of fabrics of one yarn: all have the same bounds and the same inner contact, made from the mean radius at which the
/// yarns of a tile touch and from the largest tension that any fabric asks of its yarns.
#[must_use]
pub fn problems(parts: Vec<Part>, stiffest: Option<f64>, ablation: Ablation) -> Vec<YarnProblem> {
    let radius = parts.iter().map(|part| contact_radius(&part.tile)).sum::<f64>() / parts.len().max(1) as f64;
    let (mut space, stiff) = match stiffest {
        Some(stiffness) => (RodSpace::paper(stiffness, radius), stiffness),
        None => {
            let tension = parts.iter().map(|part| tension(&part.tile, &part.targets)).fold(0.0, f64::max);
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
    let of_part = |Part { tile, targets, bending }: Part| YarnProblem {
        tile,
        base,
        space,
        targets,
        bending,
        rest_shapes: !ablation.no_rest_shapes,
        // Differs from the paper: no rounds that are cut short, at the few iterations of which rest shapes jump as numbers change, so
        // that no derivative leads to the bottom of a valley; yarns that grow, instead. Tests:
        // `a_yarn_is_found_again_from_its_curves`, `rest_shapes_change_little_with_the_material`.
        rest: RestShapeSettings { early_rounds: 0, growing_rounds: 8, late_rounds: 22, ..RestShapeSettings::default() },
        pull: PullSettings::default(),
    };
    parts.into_iter().map(of_part).collect()
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

/// Rigidities that the tile should have: those that instruments printed, or those of the fitted shell, along weft, bias and
/// warp. None if bending was not measured.
fn bending_targets(fabric: &FabricFile, shell: &ShellFit, tile: &YarnTile) -> Vec<BendingTarget> {
    let curvature = CURVATURE / tile.periods()[0].max(tile.periods()[1]);
    let known = rigidities(&fabric.rigidity, shell.bending.as_ref().map(|fit| &fit.stiffness));
    known.into_iter().map(|known| BendingTarget { angle: known.direction, stiffness: known.value, curvature }).collect()
}

/// Rigidities `B` as they were printed, or else those of a shell, `B = 2k_θ`: the second difference of a tile's energy is `B`.
fn rigidities(printed: &[Rigidity], fitted: Option<&BendingStiffness>) -> Vec<Rigidity> {
    if !printed.is_empty() {
        return printed.to_vec();
    }
    let angles = [0.0, std::f64::consts::FRAC_PI_4, std::f64::consts::FRAC_PI_2];
    let of_shell = fitted.into_iter().flat_map(|fitted| angles.into_iter().zip(fitted.to_array()));
    of_shell.map(|(direction, stiffness)| Rigidity { direction, value: 2.0 * stiffness }).collect()
}

/// Whether there is anything to which a yarn's bending can be fitted.
#[must_use]
pub fn bending_is_known(fabric: &FabricFile, shell: &ShellFit) -> bool {
    !fabric.rigidity.is_empty() || shell.bending.is_some()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shell::of_fabric::printed;

    #[test]
    fn a_rigidity_is_the_same_target_by_an_instrument_and_by_the_shell_made_of_it() {
        let angles = [0.0, std::f64::consts::FRAC_PI_4, std::f64::consts::FRAC_PI_2];
        let of_instrument: Vec<Rigidity> = angles
            .into_iter()
            .zip([1e-6, 3e-6, 4e-6])
            .map(|(direction, value)| Rigidity { direction, value })
            .collect();
        let shell = printed(&of_instrument, &mut Vec::new()).expect("weft and warp are there");
        assert_eq!(rigidities(&of_instrument, None), of_instrument);
        assert_eq!(rigidities(&[], Some(&shell)), of_instrument);
        assert_eq!(rigidities(&[], None), []);
    }
}
