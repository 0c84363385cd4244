//! Whether yarns have passed through each other from one frame to the next.
//!
//! Let every point of the drawn centre lines go straight from where it was to where it is. If no two pieces cross on that
//! way, the yarns have been carried from one frame to the other without cutting, so that they are linked as they were. The
//! straight way is one of many, so a crossing that is undone in a later frame is no passage: crossings of the same two
//! segments of yarn are counted with their sign, and what is left at the end is one.

use std::collections::{BTreeMap, HashMap};

use glam::DVec3;
use rayon::prelude::*;

use super::Curve;
use crate::model::Network;

/// Most cells of the search that a piece is put into on its way.
const MOST_CELLS: f64 = 512.0;

/// Crossings of pairs of yarn segments, each named by the pass before it.
#[derive(Clone, Debug, Default)]
pub struct Passages {
    /// The contacts at both ends of the segment after each pass; a node of no stitch contact is one of its own.
    contacts: Vec<[u32; 2]>,
    /// Crossings with their sign, by the two segments, the smaller first.
    net: BTreeMap<[u32; 2], i32>,
    /// All of them.
    pub crossings: usize,
}

/// A piece of a centre line and where it goes.
#[derive(Clone, Copy)]
struct Piece {
    segment: u32,
    /// Yarn, and place along it.
    place: (u32, u32),
    before: [DVec3; 2],
    after: [DVec3; 2],
}

impl Passages {
    /// Of a network. Segments that meet in a contact are not looked at: there it is the order in the contact that keeps
    /// them apart.
    #[must_use]
    pub fn of(network: &Network) -> Self {
        let of_node = network.contact_of_nodes();
        let node = |pass: usize| of_node[network.pass_node[pass].index()];
        let last = network.pass_count().saturating_sub(1);
        let contacts = (0..network.pass_count()).map(|pass| [node(pass), node((pass + 1).min(last))]).collect();
        Self { contacts, ..Self::default() }
    }

    fn joined(&self, a: u32, b: u32) -> bool {
        let of = |segment: u32| self.contacts.get(segment as usize).map_or(&[][..], |contacts| contacts);
        of(a).iter().any(|contact| of(b).contains(contact))
    }

    /// Follows the centre lines from one frame to the next. Both have the same yarns and as many points.
    pub fn follow(&mut self, before: &[Curve], after: &[Curve]) {
        let pieces = pieces(before, after);
        let reach = pieces.iter().map(|piece| size(&bounds(piece))).sum::<f64>() / pieces.len().max(1) as f64;
        let cell_of = |x: DVec3| (x / reach.max(1e-9)).floor().as_i64vec3().to_array();
        let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
        // What was torn across the fabric is held against everything: it would be in nearly every cell.
        let mut torn = Vec::new();
        for (index, piece) in pieces.iter().enumerate() {
            let [low, high] = bounds(piece).map(cell_of);
            if (0..3).map(|k| (high[k] - low[k] + 1) as f64).product::<f64>() > MOST_CELLS {
                torn.push(index as u32);
                continue;
            }
            for x in low[0]..=high[0] {
                for y in low[1]..=high[1] {
                    for z in low[2]..=high[2] {
                        cells.entry([x, y, z]).or_default().push(index as u32);
                    }
                }
            }
        }
        // Of the cells that both are in, one counts.
        let cross = |a: u32, b: u32, within: Option<[i64; 3]>| {
            let (a, b) = (&pieces[a as usize], &pieces[b as usize]);
            let near = a.place.0 == b.place.0 && a.place.1.abs_diff(b.place.1) <= 1;
            let ([la, ha], [lb, hb]) = (bounds(a), bounds(b));
            let apart = la.cmpgt(hb).any() || lb.cmpgt(ha).any();
            let elsewhere = within.is_some_and(|cell| cell_of(la.max(lb)) != cell);
            if near || apart || elsewhere || self.joined(a.segment, b.segment) {
                return None;
            }
            let sign = crossing(a, b);
            let pair = [a.segment.min(b.segment), a.segment.max(b.segment)];
            (sign != 0).then_some((pair, sign))
        };
        let mut found: Vec<([u32; 2], i32)> = cells
            .par_iter()
            .flat_map_iter(|(cell, list)| {
                let pairs = list.iter().enumerate().flat_map(|(k, &a)| list[k + 1..].iter().map(move |&b| (a, b)));
                pairs.filter_map(|(a, b)| cross(a, b, Some(*cell)))
            })
            .collect();
        for &a in &torn {
            let others = (0..pieces.len() as u32).filter(|&b| b != a && (b < a || torn.binary_search(&b).is_err()));
            found.extend(others.filter_map(|b| cross(a, b, None)));
        }
        self.crossings += found.len();
        for (pair, sign) in found {
            *self.net.entry(pair).or_default() += sign;
        }
    }

    /// The pairs of segments that have passed through each other and have not come back.
    pub fn pairs(&self) -> impl Iterator<Item = [u32; 2]> {
        self.net.iter().filter(|(_, net)| **net != 0).map(|(pair, _)| *pair)
    }
}

/// All pieces; what all have moved together is taken out.
fn pieces(before: &[Curve], after: &[Curve]) -> Vec<Piece> {
    let middle = |curves: &[Curve]| {
        let points = curves.iter().flat_map(|curve| &curve.points);
        points.clone().sum::<DVec3>() / points.count().max(1) as f64
    };
    let (from, to) = (middle(before), middle(after));
    let mut pieces = Vec::new();
    for (yarn, (old, new)) in before.iter().zip(after).enumerate() {
        let ends = old.points.windows(2).zip(new.points.windows(2)).zip(&old.pass);
        for (at, ((old, new), pass)) in ends.enumerate() {
            pieces.push(Piece {
                segment: *pass,
                place: (yarn as u32, at as u32),
                before: [old[0] - from, old[1] - from],
                after: [new[0] - to, new[1] - to],
            });
        }
    }
    pieces
}

fn bounds(piece: &Piece) -> [DVec3; 2] {
    let [a, b] = piece.before;
    let [c, d] = piece.after;
    [a.min(b).min(c).min(d), a.max(b).max(c).max(d)]
}

fn size([low, high]: &[DVec3; 2]) -> f64 {
    (*high - *low).max_element()
}

/// The sign with which two pieces cross on their way, the sum of all times that they do.
fn crossing(a: &Piece, b: &Piece) -> i32 {
    let at = |t: f64| {
        let along = |piece: &Piece| [0, 1].map(|k| piece.before[k].lerp(piece.after[k], t));
        (along(a), along(b))
    };
    // The volume that the four points span is a cubic of time; where it is zero they lie in a plane.
    let volume = |t: f64| {
        let ([p, q], [r, s]) = at(t);
        (q - p).cross(s - r).dot(r - p)
    };
    let [v0, v1, v2, v3] = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(volume);
    let third = 4.5 * (v3 - 3.0 * v2 + 3.0 * v1 - v0);
    let second = 4.5 * (2.0 * v0 - 5.0 * v1 + 4.0 * v2 - v3);
    let first = -5.5 * v0 + 9.0 * v1 - 4.5 * v2 + v3;
    let mut stops = vec![0.0];
    let (a2, b2, c2) = (3.0 * third, 2.0 * second, first);
    let discriminant = b2 * b2 - 4.0 * a2 * c2;
    if discriminant > 0.0 {
        let q = -0.5 * (b2 + discriminant.sqrt().copysign(b2));
        for root in [q / a2, c2 / q] {
            if root > 0.0 && root < 1.0 {
                stops.push(root);
            }
        }
    }
    stops.push(1.0);
    stops.sort_by(f64::total_cmp);
    let mut net = 0;
    for pair in stops.windows(2) {
        let [mut low, mut high] = [pair[0], pair[1]];
        let (start, end) = (volume(low), volume(high));
        if start * end >= 0.0 {
            continue;
        }
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if volume(middle) * start > 0.0 { low = middle } else { high = middle }
        }
        let ([p, q], [r, s]) = at(0.5 * (low + high));
        if meet(q - p, s - r, r - p) {
            net += if end > start { 1 } else { -1 };
        }
    }
    net
}

/// Whether `x d = offset + y e` with both between 0 and 1, all in one plane.
fn meet(d: DVec3, e: DVec3, offset: DVec3) -> bool {
    let normal = d.cross(e);
    let square = normal.length_squared();
    let along = |other: DVec3| offset.cross(other).dot(normal) / square;
    let (x, y) = (along(e), along(d));
    square > 0.0 && (0.0..1.0).contains(&x) && (0.0..1.0).contains(&y)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight yarn of ten pieces through a point, its passes counted from a number.
    fn yarn(middle: DVec3, along: DVec3, first: u32) -> Curve {
        let points = (-5..=5).map(|k| middle + along * f64::from(k)).collect();
        Curve { points, pass: (first..first + 11).collect(), ..Curve::default() }
    }

    fn passed(ways: &[[DVec3; 2]]) -> (usize, usize) {
        let mut passages = Passages::default();
        let still = yarn(DVec3::new(0.13, 0.21, 0.0), DVec3::X, 0);
        for [from, to] in ways {
            let frames = [from, to].map(|middle| vec![still.clone(), yarn(*middle, DVec3::new(0.1, 1.0, 0.02), 20)]);
            passages.follow(&frames[0], &frames[1]);
        }
        (passages.crossings, passages.pairs().count())
    }

    #[test]
    fn a_yarn_that_goes_through_another_is_seen() {
        let [above, below] = [DVec3::Z * 0.5, DVec3::Z * -0.7];
        assert_eq!(passed(&[[above, below]]), (1, 1));
        // And back again: nothing has happened in the end.
        assert_eq!(passed(&[[above, below], [below, above]]), (2, 0));
        assert_eq!(passed(&[[above, above + DVec3::X * 2.0]]).0, 0);
    }

    #[test]
    fn a_yarn_that_goes_around_the_end_of_another_is_not() {
        let [above, below] = [DVec3::new(9.0, 0.0, 0.5), DVec3::new(9.0, 0.0, -0.5)];
        let way = [[DVec3::Z * 0.5, above], [above, below], [below, DVec3::Z * -0.5]];
        assert_eq!(passed(&way), (0, 0));
    }

    #[test]
    fn a_yarn_that_is_torn_across_the_others_is_held_against_all_of_them() {
        // Forty yarns beside each other that hardly move, and one that is pulled far through them.
        let still: Vec<Curve> =
            (0..40).map(|k| yarn(DVec3::new(0.13, f64::from(k) + 0.5, 0.0), DVec3::X, 11 * k)).collect();
        let torn = |by: f64| yarn(DVec3::new(0.4 + by, 20.0 + by, by), DVec3::new(0.003, 3.85, 0.02), 500);
        let after = [30.0, -30.0].map(|by| still.iter().cloned().chain([torn(by)]).collect::<Vec<_>>());
        let before = [30.0, -30.0].map(|by| std::iter::once(torn(by)).chain(still.iter().cloned()).collect::<Vec<_>>());
        for frames in [after, before] {
            let mut passages = Passages::default();
            passages.follow(&frames[0], &frames[1]);
            assert_eq!((passages.crossings, passages.pairs().count()), (38, 38));
        }
    }

    #[test]
    fn contacts_are_left_to_their_order() {
        let still = yarn(DVec3::ZERO, DVec3::X, 0);
        let frames = [0.5, -0.5].map(|z| vec![still.clone(), yarn(DVec3::new(0.1, 0.2, z), DVec3::Y, 11)]);
        let one_contact = Passages { contacts: vec![[7, 7]; 22], ..Passages::default() };
        for (mut passages, expected) in [(Passages::default(), 1), (one_contact, 0)] {
            passages.follow(&frames[0], &frames[1]);
            assert_eq!(passages.crossings, expected);
        }
    }
}
