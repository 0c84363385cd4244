//! Known answers of compression.

use super::*;

/// A yarn with tensions `T₁`, `T₂` turned by `angle` over a node held by another.
fn turned(tensions: [f64; 2], angle: f64) -> f64 {
    let half = 0.5 * angle;
    let side = |tension: f64, sign: f64| {
        // stretch stiffness 1: length over rest is 1 + T
        ([sign * half.cos() * (1.0 + tension), -half.sin() * (1.0 + tension), 0.0], sign)
    };
    let (before, after) = (side(tensions[0], -1.0), side(tensions[1], 1.0));
    let mut q = vec![0.0; 25];
    for (block, (x, u)) in [(1, before), (2, after)] {
        q[5 * block..5 * block + 3].copy_from_slice(&x);
        q[5 * block + 3] = u;
    }
    let yarn = Neighbours { block: [1, 0, 2], slot: [8, 3, 13], ..Neighbours::default() };
    // The other yarn pulls the node back with the opposite of the first one's resultant, as in equilibrium.
    let strands = vec![Strand { stiffness: [1.0; 2], crimp_height: 0.0 }];
    let mut compression = Compression { strands, ..Compression::default() };
    let own = yarn.pull(&q, &compression);
    let f = across_both(own.force, own.along, [0.0; 3]);
    let mut out = Vec::new();
    let pull = (f[0] * f[0] + f[1] * f[1]).sqrt();
    // Two ends, the half of it each, out of the plane by a hair so that the holder has a direction.
    for (block, z) in [(3, 1e-6), (4, -1e-6)] {
        q[5 * block] = -f[0] * (1.0 + 0.5 * pull) / pull;
        q[5 * block + 1] = -f[1] * (1.0 + 0.5 * pull) / pull;
        q[5 * block + 2] = z;
    }
    (q[18], q[23]) = (-1.0, 1.0);
    let holder = Neighbours { block: [3, 0, 4], slot: [18, 4, 23], ..Neighbours::default() };
    compression.contacts = vec![Contact { yarns: [yarn, holder], side: None }];
    compression.evaluate(&q, &mut out);
    out[0]
}

#[test]
fn a_yarn_beside_its_node_pulls_from_where_it_lies() {
    // A straight yarn from −1 over 0 to 1, in front of its node by a half: from the triangle's z-axis both sides pull it back.
    let mut q = vec![0.0; 30];
    for (block, [x, y]) in [(1, [-1.0, 0.0]), (2, [1.0, 0.0]), (3, [1.0, 0.0]), (4, [0.0, 1.0]), (5, [-1.0, -1.0])] {
        (q[5 * block], q[5 * block + 1]) = (x, y);
    }
    (q[8], q[13]) = (-1.0, 1.0);
    let yarn = Neighbours { block: [1, 0, 2], slot: [8, 3, 13], offset: [0.0, 0.5, 0.0], ..Neighbours::default() };
    let around = vec![Some([3, 4, 5]), None, None, None, None, None];
    let compression = Compression {
        strands: vec![Strand { stiffness: [2.0; 2], crimp_height: 0.0 }],
        normals: Some(Normals { around, softness: 0.0 }),
        ..Compression::default()
    };
    let length = 1.25f64.sqrt();
    let force = yarn.pull(&q, &compression).force;
    assert!(force[0].abs() < 1e-15 && force[1].abs() < 1e-15);
    assert!((force[2] + 2.0 * 2.0 * (length - 1.0) * 0.5 / length).abs() < 1e-15, "{force:?}");
}

/// A yarn over a node: the direction it runs in, across which both its sides rise (+1) or fall (−1) by half their length, and
/// their tensions. Of equal tensions it pulls with just one of them.
struct Over {
    along: [f64; 2],
    rise: f64,
    tensions: [f64; 2],
}

/// Compressions of a stack of yarns over one node, from that of the loop that was worked on.
fn pressed(yarns: &[Over]) -> Vec<f64> {
    let blocks = 1 + 2 * yarns.len();
    // Sliding coordinates of the node's passes stand behind its block and the blocks of the ends.
    let mut q = vec![0.0; BLOCK * blocks + yarns.len()];
    let mut neighbours = Vec::new();
    for (k, yarn) in yarns.iter().enumerate() {
        let ends = [1 + 2 * k, 2 + 2 * k];
        for ((end, sign), tension) in ends.into_iter().zip([-1.0, 1.0]).zip(yarn.tensions) {
            // Stretch stiffness 1: length over rest is 1 + T.
            let (flat, length) = (sign * 0.75f64.sqrt(), 1.0 + tension);
            let x = [flat * yarn.along[0] * length, flat * yarn.along[1] * length, 0.5 * yarn.rise * length];
            q[BLOCK * end..BLOCK * end + 3].copy_from_slice(&x);
            q[BLOCK * end + 3] = sign;
        }
        let slot = [BLOCK * ends[0] + 3, BLOCK * blocks + k, BLOCK * ends[1] + 3].map(|slot| slot as u32);
        neighbours.push(Neighbours { block: [ends[0] as u32, 0, ends[1] as u32], slot, ..Neighbours::default() });
    }
    let count = yarns.len();
    let stack = Stack { yarns: std::array::from_fn(|k| neighbours[k.min(count - 1)]), count };
    let strands = vec![Strand { stiffness: [1.0; 2], crimp_height: 0.0 }];
    let compression = Compression { strands, stacks: vec![stack], stacked: count - 1, ..Compression::default() };
    let mut out = Vec::new();
    compression.evaluate(&q, &mut out);
    out
}

#[test]
fn a_stack_is_pressed_along_the_pull_of_the_loop_that_was_worked() {
    let over = |along: [f64; 2], rise: f64, tension: f64| Over { along, rise, tensions: [tension; 2] };
    let assert_pressed = |yarns: &[Over], expected: &[f64], tolerance: f64| {
        let found = pressed(yarns);
        assert_eq!(found.len(), expected.len());
        let near = |(a, b): (&f64, &f64)| (a - b).abs() < tolerance;
        assert!(found.iter().zip(expected).all(near), "{found:?}, not {expected:?}");
    };
    // The worked loop pulls down with 4 over two that pull up with 1 and with 3: each contact bears what lies beyond it.
    let (child, light, heavy) =
        (|| over([0.0, 1.0], -1.0, 4.0), || over([1.0, 0.0], 1.0, 1.0), || over([1.0, 0.0], 1.0, 3.0));
    assert_pressed(&[child(), light(), heavy()], &[4.0, 3.0], 1e-12);
    assert_pressed(&[child(), heavy(), light()], &[4.0, 1.0], 1e-12);
    // Seen from behind, and with a yarn that runs the other way, it is the same stack.
    let turned = |yarn: Over| Over { rise: -yarn.rise, ..yarn };
    assert_pressed(&[turned(child()), turned(light()), turned(heavy())], &[4.0, 3.0], 1e-12);
    assert_pressed(&[child(), over([-1.0, 0.0], 1.0, 1.0), heavy()], &[4.0, 3.0], 1e-12);
    // One that is slack presses on none, but hands on.
    assert_pressed(&[child(), over([1.0, 0.0], 1.0, 0.0), over([1.0, 0.0], 1.0, 4.0)], &[4.0, 4.0], 1e-12);
    // What a yarn pulls along itself, or along those that it crosses, is held by friction and presses nothing.
    let dragged = Over { along: [1.0, 0.0], rise: 1.0, tensions: [0.5, 1.5] };
    assert_pressed(&[child(), dragged, heavy()], &[4.0, 3.0], 2e-3);
    // Nothing pulls: nothing is pressed.
    assert_pressed(
        &[over([0.0, 1.0], -1.0, 0.0), over([1.0, 0.0], 1.0, 0.0), over([1.0, 0.0], 1.0, 0.0)],
        &[0.0; 2],
        1e-12,
    );
}

#[test]
fn crimp_presses_a_flat_weave() {
    // A flat crossing: segments of 2 m that were 1.9 m long, both to the other side, of both yarns.
    let mut q = vec![0.0; 25];
    let ends = [[2.0, 0.0], [-2.0, 0.0], [0.0, 2.0], [0.0, -2.0]];
    for (k, [x, y]) in ends.into_iter().enumerate() {
        (q[5 * k + 5], q[5 * k + 6], q[5 * k + 8]) = (x, y, if k % 2 == 0 { 1.9 } else { -1.9 });
    }
    let strands =
        vec![Strand { stiffness: [3.0; 2], crimp_height: 0.2 }, Strand { stiffness: [5.0; 2], crimp_height: 0.3 }];
    let yarn = |strand: u16, block: [u32; 3], own: u32| Neighbours {
        block,
        slot: [5 * block[0] + 3, own, 5 * block[2] + 3],
        chain: [false; 2],
        interlaces: [true; 2],
        offset: [0.0; 3],
        strand,
    };
    let yarns = [yarn(0, [2, 0, 1], 3), yarn(1, [4, 0, 3], 4)];
    let contacts = vec![Contact { yarns, side: Some(1.0) }];
    let compression = Compression { strands, contacts, ..Compression::default() };
    let mut out = Vec::new();
    compression.evaluate(&q, &mut out);
    let strain = 2.0 / 1.9 - 1.0;
    let expected = 0.5 * strain * (2.0 * 3.0 * 0.2 / 2.0 + 2.0 * 5.0 * 0.3 / 2.0);
    assert!((out[0] / expected - 1.0).abs() < 1e-12, "{} {expected}", out[0]);
    // Bent over the yarn behind it, the front yarn presses more; bent away from it, less.
    (q[7], q[12]) = (-0.1, -0.1);
    compression.evaluate(&q, &mut out);
    assert!(out[0] > 1.05 * expected);
    (q[7], q[12]) = (0.1, 0.1);
    compression.evaluate(&q, &mut out);
    assert!(out[0] < 0.95 * expected);
}

#[test]
fn capstan() {
    // Slipping over n nodes in all of π: at each T₂ − T₁ = μλ(T₁, T₂), solved by bisection.
    let mu = 0.3;
    for (n, expected) in [(8, 2.5536), (16, 2.56315), (64, 2.56613)] {
        let angle = std::f64::consts::PI / f64::from(n);
        let mut tension = 1e-3;
        for _ in 0..n {
            let (mut low, mut high) = (tension, 2.0 * tension);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if middle - tension < mu * turned([tension, middle], angle) {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            tension = low;
        }
        let ratio: f64 = tension / 1e-3;
        assert!((ratio / expected - 1.0).abs() < 1e-3, "{n}: {ratio} {expected}");
    }
}
