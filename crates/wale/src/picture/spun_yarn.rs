//! The look of spun yarn: the bumps of its plies and the streaks of its fibres, from the place on the yarn alone.

use std::f32::consts::{PI, TAU};

/// Shape of a spun yarn's surface at one place, in units of the yarn's radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Surface {
    /// Unit normal: outwards, around (in the sense of growing angle), along the yarn.
    pub normal: [f32; 3],
    /// From 0 at the bottom of the groove between two plies to 1 on a ply's crest.
    pub crest: f32,
    /// Lighter and darker fibres, about −1 to 1.
    pub streak: f32,
}

/// How the yarn is spun.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spin {
    pub plies: u32,
    /// Turns per metre.
    pub twist: f64,
    /// Yarn radius \[m\].
    pub radius: f64,
}

/// The surface at an angle around the yarn \[rad\] and a rest arc length \[m\]. `detail` from 0 to 1 fades what is too
/// small to see.
pub(super) fn surface(spin: Spin, angle: f32, arc_length: f64, detail: f32) -> Surface {
    // Turns are taken off in double precision: a long yarn has tens of thousands of them.
    let turn = (spin.twist * arc_length).rem_euclid(1.0) as f32;
    let around = angle - TAU * turn;
    let slope = TAU * (spin.twist * spin.radius) as f32;
    let length = (arc_length / spin.radius).rem_euclid(4096.0) as f32;
    if spin.plies < 2 {
        let streak = fibres(around / TAU, 36, length, 0);
        return tilted(0.45 * detail * streak, slope, 1.0, streak * detail);
    }
    let plies = spin.plies as f32;
    let half = PI / plies;
    let sector = (around / (2.0 * half)).floor();
    let s = around - (sector + 0.5) * 2.0 * half;
    // Round plies that touch: centres at `centre`, radius `ply`, outermost point at 1.
    let ply = half.sin() / (1.0 + half.sin());
    let centre = 1.0 - ply;
    let across = centre * s.sin();
    let reach = (ply * ply - across * across).max(0.0).sqrt();
    let (x, y) = (reach, across);
    // Normal of the ply's circle, turned back to the yarn's own outward direction. Grooves are filled with hair: they
    // are never as steep as those of smooth cylinders.
    let tilt = (y.atan2(x) * 0.9).clamp(-1.15, 1.15);
    let crest = (reach / ply).clamp(0.0, 1.0);
    // Fibres of a ply are spun against the plies' own twist, so that they run nearly along the yarn.
    let within = y.atan2(x) / TAU - 0.55 * slope / TAU * length;
    let streak = fibres(within, 24, length, sector as i32);
    tilted(detail * (tilt + 0.45 * streak), slope, 1.0 - detail * (1.0 - crest), detail * streak)
}

fn tilted(tilt: f32, slope: f32, crest: f32, streak: f32) -> Surface {
    let (around, outward) = tilt.sin_cos();
    // The surface is a helix: its normal has no part along the helix.
    let along = -slope * around;
    let length = (1.0 + along * along).sqrt();
    Surface { normal: [outward / length, around / length, along / length], crest, streak }
}

/// Smooth noise drawn out along the yarn; `around` in turns.
fn fibres(around: f32, count: i32, length: f32, ply: i32) -> f32 {
    let mut sum = 0.0;
    for (octave, weight) in [(1, 0.6), (2, 0.4)] {
        let count = count * octave;
        let x = around.rem_euclid(1.0) * count as f32;
        let y = length * (0.30 * octave as f32);
        let (x0, y0) = (x.floor(), y.floor());
        let ease = |t: f32| t * t * (3.0 - 2.0 * t);
        let (fx, fy) = (ease(x - x0), ease(y - y0));
        let at = |dx: i32, dy: i32| {
            let column = (x0 as i32 + dx).rem_euclid(count);
            unit_hash(column as u32, (y0 as i32 + dy) as u32, (ply + 7 * octave) as u32)
        };
        let low = at(0, 0) + fx * (at(1, 0) - at(0, 0));
        let high = at(0, 1) + fx * (at(1, 1) - at(0, 1));
        sum += weight * (2.0 * (low + fy * (high - low)) - 1.0);
    }
    sum
}

/// A number from 0 to 1 that follows from three integers and looks random.
pub(super) fn unit_hash(a: u32, b: u32, c: u32) -> f32 {
    let mut h = a.wrapping_mul(0x9e37_79b1) ^ b.wrapping_mul(0x85eb_ca6b) ^ c.wrapping_mul(0xc2b2_ae35);
    h = (h ^ (h >> 16)).wrapping_mul(0x7feb_352d);
    h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
    h ^= h >> 16;
    (h >> 8) as f32 / (1u32 << 24) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPIN: Spin = Spin { plies: 3, twist: 200.0, radius: 5e-4 };

    #[test]
    fn each_turn_shows_every_ply_once() {
        let grooves = |spin: Spin| {
            let crest = |i: i32| surface(spin, i as f32 * TAU / 3600.0, 0.0, 1.0).crest;
            (0..3600).filter(|&i| crest(i) < 0.5 && crest(i + 1) >= 0.5).count()
        };
        for plies in [2, 3, 4, 6] {
            assert_eq!(grooves(Spin { plies, ..SPIN }), plies as usize);
        }
    }

    #[test]
    fn the_pattern_winds_with_the_twist() {
        let pitch = 1.0 / SPIN.twist;
        for i in 0..20 {
            let angle = i as f32 * 0.31;
            let here = surface(SPIN, angle, 0.0, 1.0).crest;
            let quarter = surface(SPIN, angle + 0.25 * TAU, 0.25 * pitch, 1.0).crest;
            assert!((here - quarter).abs() < 1e-3);
        }
    }

    #[test]
    fn normals_have_unit_length_and_fade_to_smooth() {
        for i in 0..100 {
            let angle = i as f32 * 0.07;
            let s = surface(SPIN, angle, 0.001 * f64::from(i), 1.0);
            let length: f32 = s.normal.iter().map(|x| x * x).sum();
            assert!((length - 1.0).abs() < 1e-5);
            let far = surface(SPIN, angle, 0.001 * f64::from(i), 0.0);
            assert_eq!((far.normal[0], far.crest, far.streak), (1.0, 1.0, 0.0));
        }
    }
}
