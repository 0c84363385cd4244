//! Obstacles, grips and motions of a scene.

use glam::{DQuat, DVec3};

use super::{exactly_one, rotation, si, unit, vector};
use crate::model::motion::Key;
use crate::model::{Drive, Edge, Grip, Motion, Obstacle, Selection, Shape};
use crate::scene::error::{Complaint, shortened};
use crate::scene::schema::{Corner, GripText, MotionText, ObstacleText, SelectText, YarnEndText};

pub(super) fn obstacles(texts: &[ObstacleText], duration: f64) -> Result<Vec<Obstacle>, Complaint> {
    let names = names(texts.iter().map(|text| text.name.as_deref()), "obstacle")?;
    let mut obstacles = Vec::with_capacity(texts.len());
    for (i, (text, name)) in texts.iter().zip(names).enumerate() {
        let path = format!("obstacle.{i}");
        let (shape, middle) = shape(text, &path)?;
        let motion = match &text.motion {
            Some(motion) => self::motion(motion, &format!("{path}.motion"), middle, 0.0, duration)?,
            None => Motion::default(),
        };
        obstacles.push(Obstacle { name, shape, motion, friction_coefficient: si(text.friction).unwrap_or(0.3) });
    }
    Ok(obstacles)
}

/// The shape, and the point that it turns about if the scene says nothing else.
fn shape(text: &ObstacleText, path: &str) -> Result<(Shape, DVec3), Complaint> {
    let given = [
        ("plane", text.plane.is_some()),
        ("sphere", text.sphere.is_some()),
        ("capsule", text.capsule.is_some()),
        ("box", text.block.is_some()),
    ];
    exactly_one(path, &given)?;
    if let Some(plane) = &text.plane {
        let normal = match &plane.normal {
            Some(normal) => unit(normal, &format!("{path}.plane.normal"))?,
            None => DVec3::Z,
        };
        let point = vector(&plane.point);
        return Ok((Shape::Plane { point, normal }, point));
    }
    if let Some(sphere) = &text.sphere {
        let center = vector(&sphere.center);
        return Ok((Shape::Sphere { center, radius: sphere.radius.si() }, center));
    }
    if let Some(capsule) = &text.capsule {
        let (a, b) = (vector(&capsule.a), vector(&capsule.b));
        return Ok((Shape::Capsule { a, b, radius: capsule.radius.si() }, 0.5 * (a + b)));
    }
    let Some(block) = &text.block else {
        return Err(Complaint::new(path, "the obstacle has no shape"));
    };
    let center = vector(&block.center);
    let turned = match &block.rotation {
        Some(turn) => rotation(turn, &format!("{path}.box.rotation"))?,
        None => DQuat::IDENTITY,
    };
    Ok((Shape::Block { center, half_size: 0.5 * vector(&block.size), rotation: turned }, center))
}

pub(super) fn grips(
    texts: &[GripText],
    duration: f64,
    middle: DVec3,
    size: [usize; 2],
    yarns: &[String],
) -> Result<Vec<Grip>, Complaint> {
    let names = names(texts.iter().map(|text| text.name.as_deref()), "grip")?;
    let mut grips = Vec::with_capacity(texts.len());
    for (i, (text, name)) in texts.iter().zip(names).enumerate() {
        let path = format!("grip.{i}");
        let from = si(text.from).unwrap_or(0.0);
        let until = si(text.until);
        if until.is_some_and(|until| until <= from) {
            let complaint = Complaint::new(format!("{path}.until"), "the grip lets go before it takes hold");
            return Err(complaint.why(format!("it takes hold at {from:?} s")));
        }
        let axes = text.axes.map_or([true; 3], |axes| axes.0);
        let drive = drive(text, &path, middle, (from, until.unwrap_or(duration)))?;
        if let Drive::Follow(motion) = &drive
            && motion.keys.iter().any(|key| key.rotation != DVec3::ZERO)
            && axes != [true; 3]
        {
            return Err(Complaint::new(format!("{path}.axes"), "a grip that turns holds all three axes")
                .mend("leave axes out, or the turn"));
        }
        let nodes = selection(&text.select, &format!("{path}.select"), size, yarns)?;
        grips.push(Grip { name, nodes, axes, drive, from, until });
    }
    Ok(grips)
}

fn drive(text: &GripText, path: &str, middle: DVec3, (from, until): (f64, f64)) -> Result<Drive, Complaint> {
    match (&text.motion, &text.pull) {
        (Some(_), Some(_)) => {
            Err(Complaint::new(format!("{path}.pull"), "motion and pull are both given").mend("keep one of them"))
        }
        (None, None) => Ok(Drive::Follow(Motion::default())),
        (None, Some(pull)) => Ok(Drive::Force { force: vector(&pull.force), ramp: si(pull.ramp).unwrap_or(0.0) }),
        (Some(text), None) => {
            let path = format!("{path}.motion");
            let mut motion = motion(text, &path, middle, from, until)?;
            if let Some(first) = motion.keys.first().copied()
                && (first.translation != DVec3::ZERO || first.rotation != DVec3::ZERO)
            {
                if first.time <= from {
                    return Err(Complaint::new(format!("{path}.keys.0"), "the grip would jump when it takes hold")
                        .why(format!("it takes hold at {from:?} s, where the first key is not the initial place"))
                        .mend("let the first key have no translation and no rotation"));
                }
                motion.keys.insert(0, Key { time: from, rotation: DVec3::ZERO, translation: DVec3::ZERO });
            }
            Ok(Drive::Follow(motion))
        }
    }
}

/// A motion that lasts from `from` until `until` where the text does not say it.
fn motion(text: &MotionText, path: &str, middle: DVec3, from: f64, until: f64) -> Result<Motion, Complaint> {
    let pivot = text.pivot.as_ref().map_or(middle, vector);
    let steady = text.velocity.is_some() || text.turn.is_some();
    if let Some(texts) = &text.keys {
        if steady || text.from.is_some() || text.until.is_some() {
            return Err(Complaint::new(format!("{path}.keys"), "a motion has keys, or velocity and turn")
                .mend("keep the keys alone, or leave them out"));
        }
        let mut keys: Vec<Key> = Vec::with_capacity(texts.len());
        for (i, key) in texts.iter().enumerate() {
            let time = key.time.si();
            if let Some(before) = keys.last()
                && time <= before.time
            {
                return Err(Complaint::new(format!("{path}.keys.{i}.time"), "keys are not in order of time")
                    .why(format!("the key before is at {:?} s", before.time)));
            }
            let translation = key.translation.as_ref().map_or(DVec3::ZERO, vector);
            let rotation = key.rotation.as_ref().map_or(DVec3::ZERO, vector);
            keys.push(Key { time, rotation, translation });
        }
        if keys.is_empty() {
            let complaint = Complaint::new(format!("{path}.keys"), "a motion needs at least one key");
            return Err(complaint.mend("leave the motion out to stay still"));
        }
        return Ok(Motion { keys, pivot });
    }
    if !steady {
        return Err(Complaint::new(path, "a motion needs velocity, turn or keys")
            .mend("write for instance motion = { velocity = [\"10 mm/s\", 0, 0] }"));
    }
    let start = si(text.from).unwrap_or(from);
    let end = si(text.until).unwrap_or(until);
    if end <= start {
        // A run that lasts no longer than this has no time for the motion; a stated end before the start is a slip.
        if text.until.is_none() {
            return Ok(Motion::default());
        }
        let complaint = Complaint::new(format!("{path}.until"), "the motion ends before it begins");
        return Err(complaint.why(format!("it begins at {start:?} s")));
    }
    let translation = text.velocity.as_ref().map_or(DVec3::ZERO, vector) * (end - start);
    let rotation = match &text.turn {
        Some(turn) => unit(&turn.axis, &format!("{path}.turn.axis"))? * (turn.rate.si() * (end - start)),
        None => DVec3::ZERO,
    };
    let rest = Key { time: start, rotation: DVec3::ZERO, translation: DVec3::ZERO };
    Ok(Motion { keys: vec![rest, Key { time: end, rotation, translation }], pivot })
}

fn yarn_end(text: &YarnEndText, path: &str, yarns: &[String]) -> Result<Selection, Complaint> {
    let one = ["A".to_owned()];
    let yarns = if yarns.is_empty() { &one } else { yarns };
    let Some(yarn) = yarns.iter().position(|name| *name == text.yarn) else {
        let path = format!("{path}.yarn_end.yarn");
        return Err(Complaint::new(path, format!("the fabric has no yarn \"{}\"", shortened(&text.yarn)))
            .mend(format!("its yarns are: {}", yarns.join(", "))));
    };
    if text.number == Some(0) {
        let complaint = Complaint::new(format!("{path}.yarn_end.number"), "lengths of yarn are counted from 1");
        return Err(complaint.mend("leave number out for all of them"));
    }
    let length = text.number.map(|number| number - 1);
    Ok(Selection::YarnEnd { yarn: yarn as u8, length, end: text.end })
}

fn selection(
    text: &SelectText,
    path: &str,
    [rows, columns]: [usize; 2],
    yarns: &[String],
) -> Result<Selection, Complaint> {
    let loops = text.rows.is_some() || text.columns.is_some();
    let given = [
        ("edge", text.edge.is_some()),
        ("corner", text.corner.is_some()),
        (if text.rows.is_some() { "rows" } else { "columns" }, loops),
        ("region", text.region.is_some()),
        ("yarn_end", text.yarn_end.is_some()),
        ("all", text.all == Some(true)),
    ];
    exactly_one(path, &given)?;
    if text.depth.is_some() && text.edge.is_none() && text.corner.is_none() {
        let complaint = Complaint::new(format!("{path}.depth"), "only edges and corners have a depth");
        return Err(complaint.mend("leave depth out"));
    }
    let depth = text.depth.unwrap_or(1);
    if depth == 0 || depth as usize > rows.max(columns) {
        let what = format!("a depth of {depth} loops");
        return Err(Complaint::new(format!("{path}.depth"), what)
            .why(format!("it is at least 1, and the chart has {rows} rows and {columns} columns")));
    }
    if let Some(edge) = text.edge {
        return Ok(Selection::Edge { edge, depth });
    }
    if let Some(corner) = text.corner {
        let (horizontal, vertical) = match corner {
            Corner::TopLeft => (Edge::Top, Edge::Left),
            Corner::TopRight => (Edge::Top, Edge::Right),
            Corner::BottomLeft => (Edge::Bottom, Edge::Left),
            Corner::BottomRight => (Edge::Bottom, Edge::Right),
        };
        return Ok(Selection::Corner { horizontal, vertical, depth });
    }
    if let Some(end) = &text.yarn_end {
        return yarn_end(end, path, yarns);
    }
    if let Some(region) = &text.region {
        let (low, high) = (vector(&region.low), vector(&region.high));
        if low.cmpgt(high).any() {
            let complaint = Complaint::new(format!("{path}.region.high"), "the region is empty");
            return Err(complaint.why("no part of low may be above high"));
        }
        return Ok(Selection::Region { low, high });
    }
    if loops {
        let range = |key: &str, ends: Option<[u32; 2]>, count: usize| match ends {
            None => Ok(None),
            Some([first, last]) if 1 <= first && first <= last && last as usize <= count => Ok(Some(first - 1..last)),
            Some([first, last]) => Err(Complaint::new(format!("{path}.{key}"), format!("{key} {first} to {last}"))
                .why(format!("{key} are counted from 1 to {count}, the first before the last"))),
        };
        let (rows, columns) = (range("rows", text.rows, rows)?, range("columns", text.columns, columns)?);
        return Ok(Selection::Loops { rows, columns });
    }
    Ok(Selection::All)
}

/// A name for each, none twice.
fn names<'a>(given: impl Iterator<Item = Option<&'a str>>, kind: &str) -> Result<Vec<String>, Complaint> {
    let mut names: Vec<String> = Vec::new();
    let mut seen = std::collections::BTreeSet::new();
    for (i, name) in given.enumerate() {
        let name = name.map_or_else(|| format!("{kind} {}", i + 1), str::to_owned);
        let usable = (1..=60).contains(&name.chars().count()) && !name.chars().any(char::is_control);
        if !usable {
            let complaint = Complaint::new(format!("{kind}.{i}.name"), "a name has 1 to 60 characters on one line");
            return Err(complaint);
        }
        if !seen.insert(name.clone()) {
            let what = format!("there is another {kind} named \"{name}\"");
            return Err(Complaint::new(format!("{kind}.{i}.name"), what).mend("give each its own name"));
        }
        names.push(name);
    }
    Ok(names)
}
