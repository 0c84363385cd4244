//! Frames as few bytes: yarns sampled anew at equal rest arc length, places in 16 bits, differences, zlib.
//!
//! Points of a yarn keep their material place over time, so that differences in time and along the yarn are both small.

use std::io::Write;

use flate2::{Compression, write::ZlibEncoder};
use glam::DVec3;

use super::{ViewData, ViewError, ViewSettings};
use crate::{
    geometry::{Curve, Quantity},
    picture::{base64, color_range},
};

/// A yarn as the page knows it: equally spaced points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PackedYarn {
    /// Rest arc length of the first point \[m\].
    pub first: f64,
    /// Rest arc length between points \[m\].
    pub spacing: f64,
    pub points: usize,
    pub radius: f64,
    pub color: [u8; 3],
}

/// All numbers of a page.
#[derive(Debug)]
pub(super) struct Packed {
    pub yarns: Vec<PackedYarn>,
    /// Which frames of the data are in the page.
    pub kept: Vec<usize>,
    /// Smallest corner of each kept frame \[m\].
    pub origins: Vec<DVec3>,
    /// Length of one step of the 16 bits \[m\].
    pub step: f64,
    /// Box around all kept frames \[m\].
    pub low: DVec3,
    pub high: DVec3,
    /// Quantities in the page with the values at both ends of their colours (SI).
    pub quantities: Vec<(Quantity, [f64; 2])>,
    /// Base64 of the compressed numbers.
    pub text: String,
}

pub(super) fn pack(data: &ViewData, settings: &ViewSettings) -> Result<Packed, ViewError> {
    let yarns = lay_out(data, settings)?;
    let points: usize = yarns.iter().map(|y| y.points).sum();
    let quantities: Vec<Quantity> = Quantity::ALL
        .into_iter()
        .filter(|q| data.frames.iter().all(|f| matches(f.scalars.of(*q), &f.curves)))
        .collect();
    let frame_bytes = points * (6 + quantities.len());
    let most = (settings.budget / frame_bytes.max(1)).max(1);
    let kept = keep(data.frames.len(), most);
    let ranges: Vec<(Quantity, [f64; 2])> = quantities
        .into_iter()
        .map(|q| {
            let all: Vec<Vec<f64>> = kept.iter().flat_map(|f| data.frames[*f].scalars.of(q).iter().cloned()).collect();
            (q, color_range(q, &all))
        })
        .collect();

    let places: Vec<Vec<DVec3>> = kept
        .iter()
        .map(|&f| {
            let curves = data.frames[f].curves.iter().zip(&yarns);
            curves.flat_map(|(c, y)| sample(c, y, &c.points)).collect()
        })
        .collect();
    let boxes: Vec<(DVec3, DVec3)> = places
        .iter()
        .map(|p| p.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x))))
        .collect();
    let largest = boxes.iter().map(|(a, b)| (*b - *a).max_element()).fold(0.0, f64::max);
    let step = (largest / f64::from(u16::MAX)).max(1e-12);

    let mut writer = ZlibEncoder::new(Vec::new(), Compression::default());
    let mut before: Option<Vec<Vec<i32>>> = None;
    for (k, &f) in kept.iter().enumerate() {
        let origin = boxes[k].0;
        let mut columns: Vec<(Vec<i32>, u32)> = (0..3)
            .map(|axis| {
                let column = places[k].iter().map(|p| ((p[axis] - origin[axis]) / step).round() as i32);
                (column.collect(), 16)
            })
            .collect();
        for (quantity, range) in &ranges {
            let frame = &data.frames[f];
            let column = frame
                .curves
                .iter()
                .zip(&yarns)
                .zip(frame.scalars.of(*quantity))
                .flat_map(|((c, y), values)| sample_numbers(c, y, values))
                .map(|v| (255.0 * (v - range[0]) / (range[1] - range[0])).round().clamp(0.0, 255.0) as i32);
            columns.push((column.collect(), 8));
        }
        let mut steps = Vec::with_capacity(columns.len());
        for (c, (column, bits)) in columns.iter().enumerate() {
            let along: Vec<i32> =
                (0..column.len()).map(|i| column[i] - if i > 0 { column[i - 1] } else { 0 }).collect();
            let folded: Vec<u32> = along
                .iter()
                .enumerate()
                .map(|(i, d)| fold(d - before.as_ref().map_or(0, |b| b[c][i]), *bits))
                .collect();
            let byte = |shift: u32| folded.iter().map(|f| (f >> shift) as u8).collect::<Vec<u8>>();
            writer.write_all(&byte(0))?;
            if *bits == 16 {
                writer.write_all(&byte(8))?;
            }
            steps.push(along);
        }
        before = Some(steps);
    }
    Ok(Packed {
        yarns,
        kept,
        origins: boxes.iter().map(|b| b.0).collect(),
        step,
        low: boxes.iter().fold(DVec3::INFINITY, |a, b| a.min(b.0)),
        high: boxes.iter().fold(DVec3::NEG_INFINITY, |a, b| a.max(b.1)),
        quantities: ranges,
        text: base64(&writer.finish()?),
    })
}

/// At most `most` of `count` frames, evenly, the last among them (the first too if two fit).
fn keep(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    if most == 1 {
        return vec![count - 1];
    }
    (0..most).map(|i| i * (count - 1) / (most - 1)).collect()
}

/// Whether there is a value for each point.
fn matches(values: &[Vec<f64>], curves: &[Curve]) -> bool {
    values.len() == curves.len() && values.iter().zip(curves).all(|(v, c)| v.len() == c.points.len())
}

/// Most points of a frame, but for one or two a yarn.
const MOST_POINTS: f64 = 4e6;

/// Checks all curves and decides where the points of each yarn lie.
fn lay_out(data: &ViewData, settings: &ViewSettings) -> Result<Vec<PackedYarn>, ViewError> {
    let first = data.frames.first().ok_or(ViewError::Nothing)?;
    for (frame, f) in data.frames.iter().enumerate() {
        if f.curves.len() != first.curves.len() {
            return Err(ViewError::YarnCount { frame, found: f.curves.len(), expected: first.curves.len() });
        }
        for (yarn, curve) in f.curves.iter().enumerate() {
            let wrong = |reason| Err(ViewError::Curve { frame, yarn, reason });
            if curve.arc_length.len() != curve.points.len() {
                return wrong("it has not one arc length a point");
            }
            if curve.points.len() < 2 {
                return wrong("it has fewer than two points");
            }
            if !(curve.radius.is_finite() && curve.radius > 0.0) {
                return wrong("its radius is not a positive length");
            }
            if curve.points.iter().any(|p| !p.is_finite()) {
                return Err(ViewError::NotFinite { frame, yarn });
            }
            let rises = curve.arc_length.windows(2).all(|w| w[1] >= w[0]);
            if !rises || curve.arc_length[0] >= curve.arc_length[curve.arc_length.len() - 1] {
                return wrong("its arc length does not rise");
            }
        }
    }
    if first.curves.is_empty() {
        return Err(ViewError::Nothing);
    }
    let length = |curve: &Curve| curve.arc_length[curve.arc_length.len() - 1] - curve.arc_length[0];
    let all: f64 = first.curves.iter().map(|curve| length(curve) / (settings.spacing * curve.radius)).sum();
    // Points of a fabric of very much yarn lie further apart.
    let spacing = settings.spacing * (all / MOST_POINTS).max(1.0);
    Ok(first
        .curves
        .iter()
        .map(|curve| {
            let (start, length) = (curve.arc_length[0], length(curve));
            let pieces = (length / (spacing * curve.radius)).ceil().max(1.0) as usize;
            PackedYarn {
                first: start,
                spacing: length / pieces as f64,
                points: pieces + 1,
                radius: curve.radius,
                color: curve.color,
            }
        })
        .collect())
}

/// For each point of the packed yarn: the curve's point at or before it, and how far towards the next, 0 to 1.
///
/// A frame's curve may begin or end elsewhere than the first frame's (yarn pulled out): it is sampled over its own length.
fn stations<'a>(curve: &'a Curve, yarn: &PackedYarn) -> impl Iterator<Item = (usize, f64)> + 'a {
    let u = &curve.arc_length;
    let (start, length) = (u[0], u[u.len() - 1] - u[0]);
    let pieces = yarn.points - 1;
    let mut i = 0;
    (0..=pieces).map(move |k| {
        let at = start + length * k as f64 / pieces as f64;
        while i + 2 < u.len() && u[i + 1] <= at {
            i += 1;
        }
        let rise = u[i + 1] - u[i];
        let s = if rise > 0.0 { ((at - u[i]) / rise).clamp(0.0, 1.0) } else { 0.0 };
        (i, s)
    })
}

/// The curve's points at the yarn's stations, on the cubic through its neighbours.
fn sample(curve: &Curve, yarn: &PackedYarn, points: &[DVec3]) -> Vec<DVec3> {
    let last = points.len() - 1;
    stations(curve, yarn)
        .map(|(i, s)| {
            let (p1, p2) = (points[i], points[i + 1]);
            let p0 = if i > 0 { points[i - 1] } else { 2.0 * p1 - p2 };
            let p3 = if i + 2 <= last { points[i + 2] } else { 2.0 * p2 - p1 };
            let (m1, m2) = (0.5 * (p2 - p0), 0.5 * (p3 - p1));
            let c2 = 3.0 * (p2 - p1) - 2.0 * m1 - m2;
            let c3 = 2.0 * (p1 - p2) + m1 + m2;
            p1 + s * (m1 + s * (c2 + s * c3))
        })
        .collect()
}

fn sample_numbers(curve: &Curve, yarn: &PackedYarn, values: &[f64]) -> Vec<f64> {
    stations(curve, yarn)
        .map(|(i, s)| {
            let v = values[i] + s * (values[i + 1] - values[i]);
            if v.is_finite() { v } else { 0.0 }
        })
        .collect()
}

/// A difference modulo 2^bits with small ones of either sign small.
fn fold(difference: i32, bits: u32) -> u32 {
    let shift = 32 - bits;
    let wrapped = (difference << shift) >> shift;
    ((wrapped << 1) ^ (wrapped >> 31)) as u32 & (u32::MAX >> shift)
}

#[cfg(test)]
pub(super) mod tests {
    use std::io::Read;

    use super::*;
    use crate::{geometry::PointScalars, view::ViewFrame};

    /// A waving yarn that moves and stretches, over several frames.
    pub fn waving(frames: usize) -> ViewData {
        let frame = |f: usize| {
            let t = f as f64 / frames.max(2) as f64;
            let n = 400;
            let s = |i: usize| i as f64 / n as f64;
            let points: Vec<DVec3> =
                (0..=n).map(|i| DVec3::new(0.1 * s(i) + 0.05 * t, 0.01 * (30.0 * s(i) + t).sin(), 0.01 * t)).collect();
            let ramp: Vec<f64> = (0..=n).map(|i| (s(i) - 0.5) * t).collect();
            ViewFrame {
                time: t,
                curves: vec![Curve {
                    arc_length: (0..=n).map(|i| 0.12 * s(i)).collect(),
                    pass: vec![0; points.len()],
                    points,
                    radius: 5e-4,
                    color: [200, 40, 40],
                }],
                scalars: PointScalars { stretch: vec![ramp], ..PointScalars::default() },
                solids: Vec::new(),
            }
        };
        ViewData { title: "waving".to_owned(), frames: (0..frames).map(frame).collect(), plies: 3, twist: 200.0 }
    }

    fn unbase64(text: &str) -> Vec<u8> {
        let value = |c: u8| match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            _ => 63,
        };
        let mut bytes = Vec::new();
        for four in text.as_bytes().chunks(4) {
            let word = four.iter().fold(0u32, |w, c| w << 6 | u32::from(value(*c)));
            let count = 3 - four.iter().filter(|c| **c == b'=').count();
            bytes.extend(&word.to_be_bytes()[1..1 + count]);
        }
        bytes
    }

    #[test]
    fn what_the_page_unpacks_is_the_yarn_within_a_step() {
        let data = waving(4);
        let packed = pack(&data, &ViewSettings::default()).unwrap();
        let mut raw = Vec::new();
        flate2::read::ZlibDecoder::new(&unbase64(&packed.text)[..]).read_to_end(&mut raw).unwrap();
        assert_eq!(packed.quantities.len(), 1);
        let n = packed.yarns[0].points;
        assert_eq!(raw.len(), 4 * n * 7);
        // The page's own way of reading (unpack.js).
        let mut before = vec![vec![0u16; n]; 3];
        for f in 0..4 {
            let at = f * n * 7;
            let mut place = vec![DVec3::ZERO; n];
            for axis in 0..3 {
                let mut sum = 0u16;
                for i in 0..n {
                    let low = u32::from(raw[at + axis * 2 * n + i]);
                    let high = u32::from(raw[at + axis * 2 * n + n + i]);
                    let folded = low | high << 8;
                    let change = (folded >> 1) ^ (folded & 1).wrapping_neg();
                    before[axis][i] = before[axis][i].wrapping_add(change as u16);
                    sum = sum.wrapping_add(before[axis][i]);
                    place[i][axis] = packed.origins[f][axis] + packed.step * f64::from(sum);
                }
            }
            let curve = &data.frames[f].curves[0];
            let wanted = sample(curve, &packed.yarns[0], &curve.points);
            for (a, b) in place.iter().zip(&wanted) {
                assert!((*a - *b).abs().max_element() <= 0.51 * packed.step);
            }
        }
    }

    #[test]
    fn samples_lie_on_the_curve() {
        let data = waving(1);
        let curve = &data.frames[0].curves[0];
        let packed = pack(&data, &ViewSettings::default()).unwrap();
        let yarn = &packed.yarns[0];
        for (k, p) in sample(curve, yarn, &curve.points).iter().enumerate() {
            let s = (yarn.first + k as f64 * yarn.spacing) / 0.12;
            let wanted = DVec3::new(0.1 * s, 0.01 * (30.0 * s).sin(), 0.0);
            assert!(p.distance(wanted) < 1e-6, "{k}: {p} {wanted}");
        }
    }

    #[test]
    fn frames_beyond_the_budget_are_left_out_evenly() {
        assert_eq!(keep(5, 10), [0, 1, 2, 3, 4]);
        assert_eq!(keep(9, 5), [0, 2, 4, 6, 8]);
        assert_eq!(keep(9, 1), [8]);
        let data = waving(40);
        let settings = ViewSettings { budget: 12_000, ..ViewSettings::default() };
        let packed = pack(&data, &settings).unwrap();
        assert!(packed.kept.len() > 2 && packed.kept.len() < 20);
        assert_eq!(packed.kept.last(), Some(&39));
    }

    #[test]
    fn what_is_no_curve_is_refused() {
        let settings = ViewSettings::default();
        let mut data = waving(3);
        data.frames[2].curves[0].points[5].x = f64::NAN;
        assert!(matches!(pack(&data, &settings), Err(ViewError::NotFinite { frame: 2, yarn: 0 })));
        let mut data = waving(3);
        data.frames[1].curves.clear();
        assert!(matches!(pack(&data, &settings), Err(ViewError::YarnCount { frame: 1, .. })));
        let mut data = waving(2);
        data.frames[0].curves[0].arc_length.reverse();
        assert!(matches!(pack(&data, &settings), Err(ViewError::Curve { .. })));
        assert!(matches!(pack(&ViewData::default(), &settings), Err(ViewError::Nothing)));
    }
}
