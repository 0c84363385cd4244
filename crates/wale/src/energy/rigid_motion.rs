//! What every element of positions alone must pass: turning and moving everything changes no energy and turns the forces.

use super::element::testing::Random;
use super::element::{Element, point};

/// Energy and gradient after random rigid motions.
pub fn check_rigid_motion<E: Element<N>, const N: usize>(element: &E, q: &[f64; N]) {
    let mut random = Random::new(99);
    let (energy, gradient) = element.gradient(q);
    let size = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
    assert!(size > 0.0, "{}: the gradient is zero at the tested state", E::NAME);
    for _ in 0..5 {
        let rotation = rotation(&mut random);
        let turn = |x: [f64; 3]| rotation.map(|row| row[0] * x[0] + row[1] * x[1] + row[2] * x[2]);
        let shift: [f64; 3] = std::array::from_fn(|_| random.next());
        let moved: [f64; N] = std::array::from_fn(|k| turn(point(q, k / 3 * 3))[k % 3] + shift[k % 3]);
        let (found, turned) = element.gradient(&moved);
        assert!((found - energy).abs() <= 1e-10 * energy.abs(), "{}: {found} {energy}", E::NAME);
        for k in 0..N {
            let expected = turn(point(&gradient, k / 3 * 3))[k % 3];
            assert!((turned[k] - expected).abs() <= 1e-9 * size, "{}: {k}: {} {expected}", E::NAME, turned[k]);
        }
    }
}

/// A rotation by a quaternion.
fn rotation(random: &mut Random) -> [[f64; 3]; 3] {
    let q: [f64; 4] = std::array::from_fn(|_| random.next());
    let n = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [w, x, y, z] = q.map(|x| x / n);
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}
