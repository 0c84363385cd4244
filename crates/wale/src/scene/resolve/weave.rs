//! The draft of a scene and the card of its fabric.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use super::beside::{path_beside, read_bytes};
use super::{Failure, exactly_one, si};
use crate::model::{WovenCard, Yarns};
use crate::pattern::Structure;
use crate::pattern::instructions::MOST_YARNS;
use crate::pattern::weave::peirce::Jammed;
use crate::pattern::weave::wif::{LARGEST_WIF, Wif};
use crate::pattern::weave::{
    BiasCut, Draft, DraftError, Selvedge, Thread, WifErrorReason, Woven, named, named_weave, peirce, read_draft,
    read_wif,
};
use crate::scene::error::{Complaint, ErrorClass, SceneError, shortened};
use crate::scene::schema::{Color, FabricText, SelvedgeText, WeaveText};
use crate::scene::units::{Bounds, Dimension, Quantity};

const HERE: &str = "fabric.weave";

/// Stands for a distance of threads that nothing says \[m\]: far, so that a piece has few.
const UNSET: f64 = 1.0;

/// What a scene weaves: the draft at its size, the names of its yarns, its sett, and the files it was read from.
pub(super) struct Drafted {
    pub woven: Woven,
    pub yarns: Vec<String>,
    pub spacing: [f64; 2],
    /// That nothing says what the sett is; the yarns will tell how close it can be.
    unset: Option<Complaint>,
    pub inputs: Vec<PathBuf>,
}

impl Drafted {
    /// Where some threads of a system have a colour of their own, the others take that of their yarn.
    pub fn complete_colors(&mut self, colors: &[[u8; 3]]) {
        for threads in [&mut self.woven.draft.warp, &mut self.woven.draft.weft] {
            if threads.iter().any(|thread| thread.color.is_some()) {
                for thread in threads {
                    thread.color = thread.color.or(colors.get(usize::from(thread.yarn)).copied());
                }
            }
        }
    }

    pub fn structure(self) -> Structure {
        Structure::Woven(Box::new(self.woven))
    }
}

pub(super) fn resolve(text: &WeaveText, directory: Option<&Path>) -> Result<Drafted, Failure> {
    let given =
        [("pattern", text.pattern.is_some()), ("symbols", text.symbols.is_some()), ("file", text.file.is_some())];
    exactly_one(HERE, &given)?;
    let mut inputs = Vec::new();
    let mut remarks = Vec::new();
    let draft = if let Some(name) = &text.pattern {
        named_weave(name).ok_or_else(|| {
            Complaint::new(format!("{HERE}.pattern"), format!("there is no weave \"{}\"", shortened(name)))
                .mend(format!("weaves are: {}", named::NAMES))
        })?
    } else if let Some(lines) = &text.symbols {
        read_draft(lines).map_err(|error| Complaint::new(format!("{HERE}.symbols"), error.to_string()))?
    } else {
        let (read, path) = wif(text.file.as_deref().unwrap_or_default(), directory)?;
        inputs.push(path);
        remarks = read.remarks;
        read.draft
    };
    let bias = bias(text)?;
    if bias.is_none() {
        counts(text)?;
    }
    let (spacing, unset) = spacing(&draft, text)?;
    let draft = sized(draft, text, bias.map(|cut| cut.reach(spacing)))?;
    let (draft, yarns) = threads(draft, text)?;
    let mut woven = Woven::new(draft, spacing);
    (woven.bias, woven.remarks) = (bias, remarks);
    if text.selvedge == Some(SelvedgeText::Cut) {
        woven.selvedge = Selvedge::Cut;
    }
    for (fringe, said) in woven.fringe.iter_mut().zip([text.warp_fringe, text.weft_fringe]) {
        *fringe = si(said).unwrap_or(*fringe);
    }
    Ok(Drafted { woven, yarns, spacing, unset, inputs })
}

fn wif(name: &str, directory: Option<&Path>) -> Result<(Wif, PathBuf), Failure> {
    let key = format!("{HERE}.file");
    let path = path_beside(&key, name, directory)?;
    let bytes = read_bytes(&path, &key, name, LARGEST_WIF)?;
    let read = read_wif(&bytes).map_err(|error| {
        let class = match *error.reason {
            WifErrorReason::TooLong { .. } | WifErrorReason::TooMany { .. } => ErrorClass::ResourceLimit,
            WifErrorReason::Size(ref size) if size.is_size() => ErrorClass::ResourceLimit,
            _ => ErrorClass::BadInput,
        };
        let complaint = Complaint::new("", error.reason.to_string()).class(class);
        // Shown as the reader saw it, whatever its code page; text of two bytes a character would be shown with gaps.
        let content = match *error.reason {
            WifErrorReason::Utf16 => Cow::default(),
            _ => String::from_utf8_lossy(&bytes),
        };
        let span = Some(error.span.clone());
        Failure::Elsewhere(Box::new(SceneError::new(complaint, &path.display().to_string(), &content, span)))
    })?;
    Ok((read, path))
}

/// The piece that is cut out, which says how many ends and picks there are.
fn bias(text: &WeaveText) -> Result<Option<BiasCut>, Complaint> {
    let Some(cut) = text.bias else { return Ok(None) };
    for (key, given) in [("ends", text.ends.is_some()), ("picks", text.picks.is_some())] {
        if given {
            return Err(Complaint::new(format!("{HERE}.{key}"), format!("{key} beside bias"))
                .why("a piece has as many threads as its size and the sett make")
                .mend(format!("leave {key} out")));
        }
    }
    if text.selvedge == Some(SelvedgeText::Woven) {
        let complaint = Complaint::new(format!("{HERE}.selvedge"), "a piece that is cut out has no woven selvedge");
        return Err(complaint.mend("leave selvedge out"));
    }
    Ok(Some(BiasCut { angle: cut.angle.si(), size: [cut.width.si(), cut.length.si()] }))
}

/// Ends and picks are given, unless a file has them, and are some.
fn counts(text: &WeaveText) -> Result<(), Complaint> {
    for (key, count) in [("ends", text.ends), ("picks", text.picks)] {
        if count.is_none() && text.file.is_none() {
            return Err(Complaint::new(HERE, format!("a weave needs {key}")).mend(format!("add {key} = 40")));
        }
        if count == Some(0) {
            return Err(Complaint::new(format!("{HERE}.{key}"), format!("{key} must be at least 1")));
        }
    }
    Ok(())
}

fn sized(draft: Draft, text: &WeaveText, reach: Option<[f64; 2]>) -> Result<Draft, Complaint> {
    let refused = |error: DraftError| {
        let key = match reach {
            Some(_) => "bias",
            None if text.ends >= text.picks => "ends",
            None => "picks",
        };
        let complaint = Complaint::new(format!("{HERE}.{key}"), error.to_string()).mend("make the fabric smaller");
        if error.is_size() { complaint.class(ErrorClass::ResourceLimit) } else { complaint }
    };
    if let Some(reach) = reach {
        let [ends, picks] = reach.map(|count| (count as u64).saturating_add(1));
        Draft::check_size(ends, picks).map_err(refused)?;
        return draft.repeat(ends as usize, picks as usize).map_err(refused);
    }
    let ends = text.ends.unwrap_or(draft.ends() as u64);
    let picks = text.picks.unwrap_or(draft.picks() as u64);
    Draft::check_size(ends, picks).map_err(refused)?;
    // Checked above: both counts are below the limit of crossings.
    draft.repeat(ends as usize, picks as usize).map_err(refused)
}

/// Distance of ends, and of picks \[m\]: as the scene says, or as the draft does on the mean of its threads. Where nothing does, the
/// complaint of it beside distances that are none.
fn spacing(draft: &Draft, text: &WeaveText) -> Result<([f64; 2], Option<Complaint>), Complaint> {
    let systems = [
        ("end_spacing", text.end_spacing, "end_count", text.end_count, &draft.warp),
        ("pick_spacing", text.pick_spacing, "pick_count", text.pick_count, &draft.weft),
    ];
    let (mut spacing, mut unset) = ([UNSET; 2], None);
    for (spacing, (key, said, count_key, count, threads)) in spacing.iter_mut().zip(systems) {
        let of_file: Option<f64> = threads.iter().map(|thread: &Thread| thread.spacing).sum();
        *spacing = match (si(said), si(count), of_file) {
            (Some(_), Some(_), _) => {
                return Err(Complaint::new(
                    format!("{HERE}.{count_key}"),
                    format!("{key} and {count_key} are both given"),
                )
                .mend("keep one of them"));
            }
            (Some(spacing), ..) => spacing,
            (_, Some(count), _) => 1.0 / count,
            (_, _, Some(sum)) => sum / threads.len() as f64,
            _ => {
                let in_file = if text.file.is_some() { ", and no spacing with its unit in the file" } else { "" };
                let nothing = format!("nothing says how close the threads lie: no {key}{in_file}");
                let complaint = Complaint::new(HERE, nothing);
                unset.get_or_insert(complaint.mend(format!("add {key} = \"0.5 mm\" or {count_key} = \"20 /cm\"")));
                UNSET
            }
        };
    }
    Ok((spacing, unset))
}

/// The draft with the yarns and colours that the scene gives its threads, and the names of the yarns.
fn threads(mut draft: Draft, text: &WeaveText) -> Result<(Draft, Vec<String>), Complaint> {
    let mut names: Vec<String> = Vec::new();
    let systems = [
        ("warp", &mut draft.warp, &text.warp, &text.warp_colors),
        ("weft", &mut draft.weft, &text.weft, &text.weft_colors),
    ];
    for (key, threads, yarns, colors) in systems {
        let empty = |list: Option<usize>, key: String| match list {
            Some(0) => {
                Err(Complaint::new(format!("{HERE}.{key}"), format!("{key} has no threads")).mend("leave it out"))
            }
            _ => Ok(()),
        };
        empty(yarns.as_ref().map(Vec::len), key.to_owned())?;
        empty(colors.as_ref().map(Vec::len), format!("{key}_colors"))?;
        let default = [key.to_owned()];
        let yarns = yarns.as_deref().unwrap_or(&default);
        for name in yarns {
            if !names.contains(name) {
                names.push(name.clone());
            }
        }
        if names.len() > MOST_YARNS {
            return Err(Complaint::new(format!("{HERE}.{key}"), format!("{} yarns", names.len()))
                .why(format!("at most {MOST_YARNS} can be told apart")));
        }
        for (thread, name) in threads.iter_mut().zip(yarns.iter().cycle()) {
            thread.yarn = names.iter().position(|known| known == name).unwrap_or(0) as u8;
        }
        for (thread, Color(color)) in threads.iter_mut().zip(colors.iter().flatten().cycle()) {
            thread.color = Some(*color);
        }
        // What the file said of them is said by the sett now.
        threads.iter_mut().for_each(|thread| (thread.spacing, thread.thickness) = (None, None));
    }
    Ok((draft, names))
}

/// The card of a woven fabric; `base` stands behind what the scene says of its stiffnesses. Lengths follow from the sett.
pub(super) fn card(
    text: &FabricText,
    base: &FabricText,
    drafted: &Drafted,
    yarns: &Yarns,
) -> Result<WovenCard, Complaint> {
    knit_keys(text)?;
    let Some(weave) = &text.weave else { return Err(Complaint::new("fabric", "the fabric has no weave")) };
    // Of several yarns the thickest decides what is possible.
    let thickest = |threads: &[Thread]| {
        let cards = threads.iter().map(|thread| yarns.of(thread.yarn));
        cards.max_by(|a, b| a.radius.total_cmp(&b.radius)).unwrap_or(yarns.first())
    };
    let draft = &drafted.woven.draft;
    let [warp, weft] = [thickest(&draft.warp), thickest(&draft.weft)];
    if let Some(unset) = &drafted.unset {
        let too_close = 0.1 * warp.radius.min(weft.radius);
        let jams = peirce::geometry(draft, [warp, weft], [too_close; 2]).err();
        let why = jams.map(|Jammed { jammed: [closest, _], diameter: [d, e], .. }| {
            let [closest, d, e] = [closest, d, e].map(|length| 1e3 * length);
            format!("this weave of yarns {d:.4} mm and {e:.4} mm thick jams at {closest:.4} mm, if ends and picks lie equally close")
        });
        return Err(why.iter().fold(unset.clone(), |complaint, why| complaint.why(why)));
    }
    let geometry = peirce::geometry(draft, [warp, weft], drafted.spacing).map_err(|jammed| {
        Complaint::new(HERE, jammed.to_string())
            .why("the yarns of a jammed weave have no straight part left [Peirce 1937]")
            .mend("set the threads further apart, take thinner yarns, or a weave with longer floats")
    })?;
    let mut card = WovenCard::new(warp, weft, &geometry);
    fn pair<D: Dimension, B: Bounds>(numbers: &mut [f64; 2], stated: Option<[Quantity<D, B>; 2]>) {
        if let Some(values) = stated {
            *numbers = values.map(Quantity::si);
        }
    }
    pair(&mut card.crimp, weave.crimp);
    pair(&mut card.crimp_height, weave.crimp_height);
    pair(&mut card.interlacing_spacing, weave.interlacing_spacing);
    pair(&mut card.float_spacing, weave.float_spacing);
    // A preset is a knit's, and says nothing of a weave's contacts.
    let known = base.weave.as_ref().map(|weave| (weave, base));
    let shear_stiffness = weave.shear_stiffness.or(known.and_then(|(weave, _)| weave.shear_stiffness));
    let spacing_stiffness = text.spacing_stiffness.or(known.and_then(|(_, base)| base.spacing_stiffness));
    let anchor_stiffness = text.anchor_stiffness.or(known.and_then(|(_, base)| base.anchor_stiffness));
    let residual_compression = text.residual_compression.or(known.and_then(|(_, base)| base.residual_compression));
    card.shear_stiffness = si(shear_stiffness).unwrap_or(card.shear_stiffness);
    card.shear_jamming_angle = si(weave.shear_jamming_angle).unwrap_or(card.shear_jamming_angle);
    card.spacing_stiffness = si(spacing_stiffness).unwrap_or(card.spacing_stiffness);
    card.anchor_stiffness = si(anchor_stiffness).unwrap_or(card.anchor_stiffness);
    card.residual_compression = si(residual_compression).unwrap_or(card.residual_compression);
    if card.shear_jamming_angle >= std::f64::consts::FRAC_PI_2 {
        let complaint = Complaint::new(
            format!("{HERE}.shear_jamming_angle"),
            format!("a shear_jamming_angle of {:.4} rad", card.shear_jamming_angle),
        );
        return Err(complaint.why("it is below 90 degrees").mend("a bare number is in radians; write \"45 deg\""));
    }
    Ok(card)
}

/// Keys that only a knit has.
fn knit_keys(text: &FabricText) -> Result<(), Complaint> {
    let knit = [
        ("loop_length", text.loop_length.is_some()),
        ("wale_spacing", text.wale_spacing.is_some()),
        ("course_spacing", text.course_spacing.is_some()),
        ("path_ratio", text.path_ratio.is_some()),
        ("model_loop_length", text.model_loop_length.is_some()),
        ("transition_length", text.transition_length.is_some()),
        ("stitch_length", text.stitch_length.is_some()),
        ("wrapping_stiffness", text.wrapping_stiffness.is_some()),
        ("wrapping_angle_course", text.wrapping_angle_course.is_some()),
        ("wrapping_angle_leg", text.wrapping_angle_leg.is_some()),
        ("bend_angle_foot_head", text.bend_angle_foot_head.is_some()),
        ("bend_angle_leg", text.bend_angle_leg.is_some()),
        ("length_stiffness", text.length_stiffness.is_some()),
        ("spacing_leg", text.spacing_leg.is_some()),
        ("spacing_head_sinker", text.spacing_head_sinker.is_some()),
        ("contacts", text.contacts.is_some()),
        ("contact_distance", text.contact_distance.is_some()),
        ("leg_distance", text.leg_distance.is_some()),
        ("leg_stiffness", text.leg_stiffness.is_some()),
        ("crossing_spacing", text.crossing_spacing.is_some()),
        ("facing_distance", text.facing_distance.is_some()),
        ("paper_table_1", text.paper_table_1.is_some()),
        ("chart", text.chart.is_some()),
    ];
    match knit.iter().find(|(_, given)| *given) {
        Some((key, _)) => Err(Complaint::new(format!("fabric.{key}"), format!("{key} beside a weave"))
            .why("only knits have it")
            .mend(format!("leave {key} out, or leave [fabric.weave] out"))),
        None => Ok(()),
    }
}
