//! Derivatives, known answers and laws of the membrane.

use super::super::element::testing::{Random, check, check_blend};
use super::*;

const STIFFNESS: MembraneStiffness =
    MembraneStiffness { xx: 40.0, xy: 9.0, yy: 110.0, ss: 6.0, n1: 3.0, n2: 5.0, ..MembraneStiffness::NONE };
const STIFFENS: MembraneStiffness = MembraneStiffness {
    stiffening_xx: 300.0,
    stiffening_yy: 900.0,
    stiffening_ss: 50.0,
    stiffening_xy: 0.6,
    ..STIFFNESS
};

fn triangle(random: &mut Random, stiffness: MembraneStiffness) -> (Membrane, [f64; 9]) {
    let mut rest = [[0.0, 0.0], [1.0, 0.1], [0.3, 0.9]];
    rest.iter_mut().flatten().for_each(|x| *x += 0.15 * random.next());
    let element = Membrane::new(stiffness, rest).expect("a triangle with an area");
    let mut q = [0.0; 9];
    for (k, x) in q.iter_mut().enumerate() {
        *x = (if k % 3 < 2 { 1.3 * rest[k / 3][k % 3] } else { 0.0 }) + 0.3 * random.next();
    }
    (element, q)
}

#[test]
fn derivatives() {
    let mut random = Random::new(5);
    for _ in 0..50 {
        let (element, q) = triangle(&mut random, STIFFNESS);
        check(&element, &q, 0.1);
        check_blend(&element, &q, 1e-10);
    }
}

#[test]
fn derivatives_of_a_fabric_that_stiffens() {
    let mut random = Random::new(10);
    for _ in 0..50 {
        let (element, q) = triangle(&mut random, STIFFENS);
        check(&element, &q, 0.1);
        check_blend(&element, &q, 1e-10);
    }
    // At rest the term is silent: no stress, and the paper's second derivatives.
    let rest = [[0.1, 0.0], [1.0, 0.2], [0.2, 1.1]];
    let at_rest = std::array::from_fn(|k| if k % 3 < 2 { rest[k / 3][k % 3] } else { 0.0 });
    let of = |stiffness| Membrane::new(stiffness, rest).unwrap().convex(&at_rest);
    let (with, without) = (of(STIFFENS), of(STIFFNESS));
    for (a, b) in with.hessian.iter().flatten().zip(without.hessian.iter().flatten()) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
}

#[test]
fn a_strip_that_is_held_in_width_stiffens_by_the_square_of_its_strain() {
    let pulled = |stiffness, stretch: f64| {
        let element = Membrane::new(stiffness, [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]).unwrap();
        // The unit square's force is twice that of the triangle's vertex; first Piola–Kirchhoff stress P = λ S.
        2.0 * element.gradient(&[0.0, 0.0, 0.0, 1.0 + stretch, 0.0, 0.0, 0.0, 1.0, 0.0]).1[3]
    };
    for stretch in [0.05, 0.3, 1.0] {
        let strain = stretch + 0.5 * stretch * stretch;
        let more = pulled(STIFFENS, stretch) - pulled(STIFFNESS, stretch);
        let known = (1.0 + stretch) * 300.0 * strain * strain;
        assert!((more / known - 1.0).abs() < 1e-10, "{stretch}: {more} {known}");
    }
}

#[test]
fn slopes_by_the_stiffnesses_are_those_of_differences() {
    let mut random = Random::new(11);
    for _ in 0..20 {
        let (element, q) = triangle(&mut random, STIFFENS);
        let direction: [f64; 9] = std::array::from_fn(|_| random.next());
        let slopes = element.gradient_slopes(&q, &direction);
        for (index, slope) in slopes.into_iter().enumerate() {
            let step = 1e-4 * STIFFENS.to_array()[index];
            let along = |by: f64| {
                let mut array = STIFFENS.to_array();
                array[index] += by;
                let moved = Membrane { stiffness: MembraneStiffness::from_array(array), ..element };
                moved.gradient(&q).1.iter().zip(&direction).map(|(g, d)| g * d).sum::<f64>()
            };
            let difference = (along(step) - along(-step)) / (2.0 * step);
            assert!((slope - difference).abs() < 1e-6 * (1.0 + difference.abs()), "{index} {slope} {difference}");
        }
    }
}

#[test]
fn derivatives_by_each_stiffness_alone() {
    let mut random = Random::new(6);
    for index in 0..MembraneStiffness::COUNT - 1 {
        for _ in 0..10 {
            let mut array = [0.0; MembraneStiffness::COUNT];
            array[index] = 1.0;
            let (element, q) = triangle(&mut random, MembraneStiffness::from_array(array));
            check(&element, &q, 0.1);
            check_blend(&element, &q, 1e-9);
        }
    }
}

#[test]
fn derivatives_of_a_crushed_triangle() {
    let mut random = Random::new(7);
    for squeeze in [0.5, 0.2, 0.05] {
        let (element, mut q) = triangle(&mut random, STIFFNESS);
        q.iter_mut().step_by(3).for_each(|x| *x *= squeeze);
        check(&element, &q, 0.1 * squeeze);
        check_blend(&element, &q, 1e-10);
    }
}

#[test]
fn rigid_motions_cost_nothing() {
    let (element, q) = triangle(&mut Random::new(8), STIFFNESS);
    let (s, c) = 0.7f64.sin_cos();
    let mut turned = q;
    for v in 0..3 {
        let [x, y, z] = point(&q, 3 * v);
        let (x, y) = (c * x - s * y, s * x + c * y);
        let (y, z) = (c * y - s * z, s * y + c * z);
        turned[3 * v..3 * v + 3].copy_from_slice(&[x + 0.3, y - 2.0, z + 1.0]);
    }
    let (before, after) = (element.energy(&q), element.energy(&turned));
    assert!((before - after).abs() < 1e-13 * before, "{before} {after}");
    let rest = [[0.1, 0.0], [1.0, 0.2], [0.2, 1.1]];
    let element = Membrane::new(STIFFNESS, rest).unwrap();
    let at_rest = std::array::from_fn(|k| if k % 3 < 2 { rest[k / 3][k % 3] } else { 4.0 });
    let (energy, gradient) = element.gradient(&at_rest);
    assert!(energy.abs() < 1e-28 && gradient.iter().all(|g| g.abs() < 1e-13));
}

#[test]
fn small_strains_have_the_plane_stress_modulus_and_poisson_ratio() {
    // E_x = C_xx − C_xy²/C_yy and ν = C_xy/C_yy with C_ij = k_ij + 2(k_n1 + k_n2).
    let area = 2.0 * (STIFFNESS.n1 + STIFFNESS.n2);
    let [cxx, cxy, cyy] = [STIFFNESS.xx, STIFFNESS.xy, STIFFNESS.yy].map(|k| k + area);
    let element = Membrane::new(STIFFNESS, [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]).unwrap();
    let strain = 1e-6;
    let nu = cxy / cyy;
    let q = [0.0, 0.0, 0.0, 1.0 + strain, 0.0, 0.0, 0.0, 1.0 - nu * strain, 0.0];
    let gradient = element.gradient(&q).1;
    // Forces at the two free vertices are the stress times half the unit square.
    let (along, across) = (2.0 * gradient[3] / strain, 2.0 * gradient[7] / strain);
    assert!((along / (cxx - cxy * cxy / cyy) - 1.0).abs() < 1e-5, "{along}");
    assert!(across.abs() < 1e-4 * along, "{across}");
}

#[test]
fn a_step_stops_before_the_triangle_is_turned_over() {
    let q = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut down = [0.0; 9];
    down[7] = -4.0; // the apex goes through the base at a quarter of the step
    assert!((Membrane::longest_step(&q, &down) - 0.25).abs() < 1e-15);
    down[7] = 4.0;
    assert_eq!(Membrane::longest_step(&q, &down), 1.0);
    down[7] = -0.5;
    assert_eq!(Membrane::longest_step(&q, &down), 1.0);
    // Both edges shrink to nothing and come out turned about: a double root at one half.
    let shrink = q.map(|x| -2.0 * x);
    assert!((Membrane::longest_step(&q, &shrink) - 0.5).abs() < 1e-7);
    // Against a search, at random.
    let mut random = Random::new(9);
    for _ in 0..200 {
        let (q, d): ([f64; 9], [f64; 9]) =
            (std::array::from_fn(|_| random.next()), std::array::from_fn(|_| 3.0 * random.next()));
        let normal = |t: f64| {
            let at: [f64; 9] = std::array::from_fn(|k| q[k] + t * d[k]);
            cross(sub(point(&at, 3), point(&at, 0)), sub(point(&at, 6), point(&at, 0)))
        };
        let found = (0..=4000).map(|k| f64::from(k) / 4000.0).find(|&t| dot(normal(t), normal(0.0)) <= 0.0);
        let part = Membrane::longest_step(&q, &d);
        assert!((part - found.unwrap_or(1.0)).abs() <= 1.0 / 4000.0, "{part} {found:?}");
    }
}

#[test]
fn a_triangle_without_area_is_none() {
    assert!(Membrane::new(STIFFNESS, [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]).is_none());
    assert!(Membrane::new(STIFFNESS, [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]]).is_none());
    assert!(Membrane::new(STIFFNESS, [[0.0, 0.0], [f64::NAN, 0.0], [0.0, 1.0]]).is_none());
}
