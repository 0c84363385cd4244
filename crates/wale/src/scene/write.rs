//! A scene written out in full, in SI units: reading it back gives the same scene.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DQuat, DVec3};

use super::resolve::text_of_yarn;
use super::schema::{
    Axes, AxisAngle, BiasText, BoxText, CapsuleText, ChartText, Color, ContactModel, FabricText, FirstRow, Gravity,
    GripText, KeyText, MotionText, ObstacleText, OutputText, PlaneText, PullText, RegionText, SceneText, SelectText,
    SelvedgeText, SimulationText, SphereText, WeaveText, Worked, YarnEndText, YarnText,
};
use super::units::{Bounds, Dimension, Quantity};
use super::{SCHEMA, Scene};
use crate::model::{Drive, Edge, FabricCard, Grip, Motion, Obstacle, Selection, Shape, WovenCard};
use crate::pattern::weave::{Selvedge, Thread, Woven};
use crate::pattern::{Chart, Side, Stitch, Structure, Working};

/// A number that is out of the bounds of the scene format, in words.
type Written<T> = Result<T, String>;

/// What a scene file would have to say to give this scene.
pub(super) fn text_of(scene: &Scene) -> Written<SceneText> {
    Ok(SceneText {
        schema: SCHEMA,
        title: Some(scene.title.clone()),
        yarn: Some(yarn(scene, 0)?),
        yarns: other_yarns(scene)?,
        fabric: fabric(scene)?,
        simulation: Some(simulation(scene)?),
        output: Some(output(scene)?),
        obstacle: scene.plan.obstacles.iter().map(obstacle).collect::<Written<_>>()?,
        grip: scene.plan.grips.iter().map(|of| grip(scene, of)).collect::<Written<_>>()?,
    })
}

fn of<D: Dimension, B: Bounds>(value: f64) -> Written<Quantity<D, B>> {
    Quantity::new(value)
}

fn some<D: Dimension, B: Bounds>(value: f64) -> Written<Option<Quantity<D, B>>> {
    of(value).map(Some)
}

fn vector<D: Dimension, B: Bounds>(value: DVec3) -> Written<[Quantity<D, B>; 3]> {
    Ok([of(value.x)?, of(value.y)?, of(value.z)?])
}

fn quaternion(value: DQuat) -> Written<Option<AxisAngle>> {
    let [x, y, z, w] = value.to_array();
    Ok(Some(AxisAngle { axis: None, angle: None, quaternion: Some([of(x)?, of(y)?, of(z)?, of(w)?]) }))
}

/// A yarn by its number.
fn yarn(scene: &Scene, number: u8) -> Written<YarnText> {
    let color = scene.yarn_colors.get(usize::from(number)).copied().unwrap_or_default();
    text_of_yarn(scene.yarns.of(number), color)
}

fn fabric(scene: &Scene) -> Written<FabricText> {
    let card = &scene.fabric;
    let placement = scene.plan.placement;
    let common = FabricText {
        spacing_stiffness: some(card.spacing_stiffness())?,
        anchor_stiffness: some(card.anchor_stiffness())?,
        residual_compression: some(card.residual_compression())?,
        center: Some(vector(placement.center)?),
        rotation: quaternion(placement.rotation)?,
        ..FabricText::default()
    };
    match (card, &scene.structure) {
        (FabricCard::Knit(card), _) => Ok(FabricText {
            path_ratio: some(card.path_ratio)?,
            model_loop_length: some(card.loop_length)?,
            wale_spacing: some(card.wale_spacing)?,
            course_spacing: some(card.course_spacing)?,
            transition_length: some(card.transition_length)?,
            stitch_length: some(card.stitch_length)?,
            wrapping_stiffness: some(card.wrapping_stiffness)?,
            wrapping_angle_course: some(card.wrapping_angle_course)?,
            wrapping_angle_leg: some(card.wrapping_angle_leg)?,
            bend_angle_foot_head: some(card.bend_angle_foot_head)?,
            bend_angle_leg: some(card.bend_angle_leg)?,
            length_stiffness: some(card.length_stiffness)?,
            spacing_leg: some(card.spacing_leg)?,
            spacing_head_sinker: some(card.spacing_head_sinker)?,
            contacts: card.thickness.map(|_| ContactModel::Thick),
            contact_distance: card.thickness.map(|thickness| of(thickness.contact_distance)).transpose()?,
            leg_distance: card.thickness.map(|thickness| of(thickness.leg_distance)).transpose()?,
            leg_stiffness: card.thickness.map(|thickness| of(thickness.leg_stiffness)).transpose()?,
            crossing_spacing: card.thickness.map(|thickness| of(thickness.crossing_spacing)).transpose()?,
            facing_distance: card.thickness.map(|thickness| of(thickness.facing_distance)).transpose()?,
            chart: Some(chart(scene)),
            ..common
        }),
        (FabricCard::Woven(card), Structure::Woven(woven)) => {
            Ok(FabricText { weave: Some(weave(woven, card)?), ..common })
        }
        (FabricCard::Woven(_), _) => Err("a woven fabric without a draft".to_owned()),
    }
}

fn pair<D: Dimension, B: Bounds>([first, second]: [f64; 2]) -> Written<Option<[Quantity<D, B>; 2]>> {
    Ok(Some([of(first)?, of(second)?]))
}

fn weave(woven: &Woven, card: &WovenCard) -> Written<WeaveText> {
    let draft = &woven.draft;
    let repeat = draft.smallest_repeat();
    let names = |threads: &[Thread]| Some(threads.iter().map(|thread| name(thread.yarn).to_string()).collect());
    // Either all threads of a system have a colour of their own, or none.
    let colors = |threads: &[Thread]| threads.iter().map(|thread| thread.color.map(Color)).collect();
    let bias = woven.bias.map(|cut| -> Written<BiasText> {
        Ok(BiasText { angle: of(cut.angle)?, width: of(cut.size[0])?, length: of(cut.size[1])? })
    });
    Ok(WeaveText {
        symbols: Some(repeat.lines()),
        ends: woven.bias.is_none().then_some(draft.ends() as u64),
        picks: woven.bias.is_none().then_some(draft.picks() as u64),
        bias: bias.transpose()?,
        end_spacing: some(card.spacing[0])?,
        pick_spacing: some(card.spacing[1])?,
        selvedge: woven.bias.is_none().then_some(match woven.selvedge {
            Selvedge::Woven => SelvedgeText::Woven,
            Selvedge::Cut => SelvedgeText::Cut,
        }),
        warp_fringe: some(woven.fringe[0])?,
        weft_fringe: some(woven.fringe[1])?,
        warp: names(&repeat.warp),
        weft: names(&repeat.weft),
        warp_colors: colors(&repeat.warp),
        weft_colors: colors(&repeat.weft),
        crimp: pair(card.crimp)?,
        crimp_height: pair(card.crimp_height)?,
        interlacing_spacing: pair(card.interlacing_spacing)?,
        float_spacing: pair(card.float_spacing)?,
        shear_stiffness: some(card.shear_stiffness)?,
        shear_jamming_angle: some(card.shear_jamming_angle)?,
        ..WeaveText::default()
    })
}

/// The smallest repeat and the size, so that a large fabric of a small repeat stays readable.
fn chart(scene: &Scene) -> ChartText {
    let (chart, working) = match &scene.structure {
        Structure::Chart { chart, working } => (chart, *working),
        Structure::Machine(program) => {
            return ChartText { knitout: Some(program.text.clone()), ..ChartText::default() };
        }
        Structure::Woven(_) => return ChartText::default(),
    };
    let (worked, first_row) = match working {
        Working::Round => (Worked::Round, None),
        Working::Flat { first_row: Side::RightSide } => (Worked::Flat, Some(FirstRow::RightSide)),
        Working::Flat { first_row: Side::WrongSide } => (Worked::Flat, Some(FirstRow::WrongSide)),
    };
    let repeat = chart.smallest_repeat();
    let (lines, legend) = spelled(&repeat);
    let names = |row: &[Stitch], at: usize| (0..row.len()).map(|k| name(repeat.yarn(at, k))).collect();
    let yarns = repeat.rows().iter().enumerate().rev().map(|(at, row)| names(row, at)).collect();
    ChartText {
        symbols: Some(lines),
        legend: Some(legend),
        yarns: (scene.yarn_colors.len() > 1 || scene.yarns.name(0).is_some()).then_some(yarns),
        columns: Some(chart.cast_on() as u64),
        rows: Some(chart.row_count() as u64),
        worked: Some(worked),
        first_row,
        ..ChartText::default()
    }
}

/// The lines of a chart, and what their symbols mean: those of charts, and others for increases that have none.
fn spelled(chart: &Chart) -> (Vec<String>, BTreeMap<String, String>) {
    let used: BTreeSet<Stitch> = chart.rows().iter().flatten().copied().collect();
    let taken: BTreeSet<char> = Stitch::all().map(|(_, symbol, _)| symbol).collect();
    let mut spare = ('0'..='9').chain('A'..='Z').chain('À'..).filter(|c| !taken.contains(c));
    let symbols: BTreeMap<Stitch, char> = used
        .into_iter()
        .map(|stitch| {
            (stitch, if taken.contains(&stitch.symbol()) { stitch.symbol() } else { spare.next().unwrap_or('?') })
        })
        .collect();
    let line = |row: &Vec<Stitch>| row.iter().map(|stitch| symbols[stitch]).collect();
    let lines = chart.rows().iter().rev().map(line).collect();
    (lines, symbols.into_iter().map(|(stitch, symbol)| (symbol.to_string(), stitch.to_string())).collect())
}

/// The letter that stands for a yarn of a chart.
fn name(yarn: u8) -> char {
    char::from(b'A' + yarn % 26)
}

/// The yarns after the first by their letters, and the first where it has another name or is several.
fn other_yarns(scene: &Scene) -> Written<BTreeMap<String, YarnText>> {
    let of_the_fabric = |text: YarnText| YarnText { mass_damping: None, stiffness_damping: None, ..text };
    let count = u8::try_from(scene.yarn_colors.len()).unwrap_or(u8::MAX);
    let keys: BTreeSet<String> = (0..count).map(|at| yarn_name(scene, at)).collect();
    let mut tables = BTreeMap::new();
    for at in 0..count {
        let key = yarn_name(scene, at);
        let mut together = Vec::new();
        for member in scene.yarns.members(at) {
            let mut own_key = format!("{key}.{}", together.len() + 1);
            while keys.contains(&own_key) {
                own_key.push('\'');
            }
            let text = of_the_fabric(text_of_yarn(&member.card, member.color)?);
            tables.insert(own_key.clone(), YarnText { name: Some(member.name.clone()), ..text });
            together.push(own_key);
        }
        let name = scene.yarns.name(at).filter(|name| *name != key).map(str::to_owned);
        let together = (!together.is_empty()).then_some(together);
        let numbers = match (at, &together) {
            // The scene's yarn says them.
            (0, None) => YarnText::default(),
            _ => of_the_fabric(yarn(scene, at)?),
        };
        let text = YarnText { name, together, ..numbers };
        if text != YarnText::default() {
            tables.insert(key, text);
        }
    }
    Ok(tables)
}

/// Letters name the yarns of a chart and of a draft, carriers those of a program.
fn yarn_name(scene: &Scene, at: u8) -> String {
    match &scene.structure {
        Structure::Chart { .. } | Structure::Woven(_) => name(at).to_string(),
        Structure::Machine(program) => program.knitted.carriers.get(usize::from(at)).cloned().unwrap_or_default(),
    }
}

fn simulation(scene: &Scene) -> Written<SimulationText> {
    let settings = &scene.plan.simulation;
    let narrow = |name: &str, value: u64| u32::try_from(value).map_err(|_| format!("{name} {value} is too large"));
    Ok(SimulationText {
        duration: some(settings.duration)?,
        frame_rate: some(settings.frame_rate)?,
        gravity: Some(Gravity(vector(settings.gravity)?)),
        air_drag: some(settings.air_drag)?,
        relax_first: Some(settings.relax_first),
        rest_shape_compensation: Some(settings.rest_shape_compensation),
        friction: Some(settings.friction),
        self_contact: Some(settings.self_contact),
        strand_contact: Some(settings.strand_contact),
        soft_start: some(settings.soft_start)?,
        seed: Some(narrow("seed", settings.seed)?),
        largest_step: some(settings.largest_step)?,
        smallest_step: some(settings.smallest_step)?,
        newton_iterations: Some(settings.newton_iterations),
        newton_tolerance: some(settings.newton_tolerance)?,
        linear_solver: Some(settings.linear_solver),
        linear_tolerance: some(settings.linear_tolerance)?,
        threads: settings.threads.map(|threads| narrow("threads", threads as u64)).transpose()?,
    })
}

fn output(scene: &Scene) -> Written<OutputText> {
    let output = &scene.plan.output;
    Ok(OutputText {
        pictures: Some(output.pictures),
        view: Some(output.view),
        exports: Some(output.exports.clone()),
        checkpoint_every: some(output.checkpoint_every)?,
    })
}

fn obstacle(obstacle: &Obstacle) -> Written<ObstacleText> {
    let mut text = ObstacleText {
        name: Some(obstacle.name.clone()),
        friction: some(obstacle.friction_coefficient)?,
        motion: motion(&obstacle.motion)?,
        ..ObstacleText::default()
    };
    match obstacle.shape {
        Shape::Plane { point, normal } => {
            text.plane = Some(PlaneText { point: vector(point)?, normal: Some(vector(normal)?) });
        }
        Shape::Sphere { center, radius } => {
            text.sphere = Some(SphereText { center: vector(center)?, radius: of(radius)? });
        }
        Shape::Capsule { a, b, radius } => {
            text.capsule = Some(CapsuleText { a: vector(a)?, b: vector(b)?, radius: of(radius)? });
        }
        Shape::Block { center, half_size, rotation } => {
            let (center, size) = (vector(center)?, vector(2.0 * half_size)?);
            text.block = Some(BoxText { center, size, rotation: quaternion(rotation)? });
        }
    }
    Ok(text)
}

fn motion(motion: &Motion) -> Written<Option<MotionText>> {
    if motion.keys.is_empty() {
        return Ok(None);
    }
    let key = |key: &crate::model::motion::Key| -> Written<KeyText> {
        Ok(KeyText {
            time: of(key.time)?,
            translation: Some(vector(key.translation)?),
            rotation: Some(vector(key.rotation)?),
        })
    };
    let keys = motion.keys.iter().map(key).collect::<Written<Vec<_>>>()?;
    Ok(Some(MotionText { keys: Some(keys), pivot: Some(vector(motion.pivot)?), ..MotionText::default() }))
}

fn grip(scene: &Scene, grip: &Grip) -> Written<GripText> {
    let (motion, pull) = match &grip.drive {
        Drive::Follow(follow) => (motion(follow)?, None),
        Drive::Force { force, ramp } => (None, Some(PullText { force: vector(*force)?, ramp: some(*ramp)? })),
    };
    Ok(GripText {
        name: Some(grip.name.clone()),
        select: select(scene, &grip.nodes)?,
        axes: Some(Axes(grip.axes)),
        motion,
        pull,
        from: some(grip.from)?,
        until: grip.until.map(of).transpose()?,
    })
}

fn select(scene: &Scene, selection: &Selection) -> Written<SelectText> {
    use super::schema::Corner;
    let mut text = SelectText::default();
    match selection {
        Selection::All => text.all = Some(true),
        Selection::Edge { edge, depth } => (text.edge, text.depth) = (Some(*edge), Some(*depth)),
        Selection::Corner { horizontal, vertical, depth } => {
            text.corner = Some(match (horizontal, vertical) {
                (Edge::Top, Edge::Left) => Corner::TopLeft,
                (Edge::Top, Edge::Right) => Corner::TopRight,
                (Edge::Bottom, Edge::Left) => Corner::BottomLeft,
                (Edge::Bottom, Edge::Right) => Corner::BottomRight,
                other => return Err(format!("{other:?} make no corner")),
            });
            text.depth = Some(*depth);
        }
        Selection::Loops { rows, columns } => {
            let ends = |range: &std::ops::Range<u32>| [range.start.saturating_add(1), range.end];
            (text.rows, text.columns) = (rows.as_ref().map(ends), columns.as_ref().map(ends));
        }
        Selection::YarnEnd { yarn, length, end } => {
            text.yarn_end = Some(YarnEndText {
                yarn: yarn_name(scene, *yarn),
                number: length.map(|length| length.saturating_add(1)),
                end: *end,
            });
        }
        Selection::Region { low, high } => {
            text.region = Some(RegionText { low: vector(*low)?, high: vector(*high)? });
        }
    }
    Ok(text)
}
