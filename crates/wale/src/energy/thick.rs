//! Energies of yarns that lie beside each other at a contact, each on its side of the node.

use wale_numerics::check::Local;
use wale_numerics::jet::vector3::{cross, dot, scale, sub};
use wale_numerics::jet::{Jet, Real};

use super::element::{Element, point};

/// Coordinates of a pass: its node, the three nodes around it, and its sliding coordinate.
const OF_PASS: usize = 13;
/// Coordinates that an energy without thickness has of a pass: a position and a sliding coordinate.
const INNER: usize = 4;

/// An energy of `P` passes of a yarn that do not lie in their nodes, but beside them along the normal of the contact:
///
/// `V = V_inner(y₁ u₁ … )`, `y = x + o n̂`, `n̂ = N/√(N² + ε²)`, `N = (b − a) × (c − a)`
///
/// where `a`, `b`, `c` are the three nodes next to `x` on the yarns of its contact, seen anticlockwise from the front. Local
/// coordinates, for each pass: `x a b c u` \[m\].
///
/// The normal is of the triangle of the three, so that it is there for as long as the yarns do not run along one straight
/// line; near that, the offset fades.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thick<E, const P: usize> {
    /// The energy of the yarn's own points.
    pub inner: E,
    /// How far in front of its node each pass lies \[m\].
    pub offset: [f64; P],
    /// `ε` \[m²\].
    pub softness: f64,
}

/// Unit normal of a triangle, shorter where the triangle is smaller than `ε`.
pub fn normal<T: Real>(a: [T; 3], b: [T; 3], c: [T; 3], softness: f64) -> [T; 3] {
    let n = cross(sub(b, a), sub(c, a));
    scale(n, T::constant(1.0) / dot(n, n).offset(softness * softness).sqrt())
}

/// What turns a change of a pass's coordinates into one of its point and sliding coordinate.
type Move = [[f64; OF_PASS]; INNER];

impl<E: Copy, const P: usize> Thick<E, P> {
    /// Another energy of the same points.
    #[must_use]
    pub fn with<F>(&self, inner: F) -> Thick<F, P> {
        Thick { inner, offset: self.offset, softness: self.softness }
    }

    /// Points and sliding coordinates of the passes.
    pub fn points<T: Real, const L: usize, const N: usize>(&self, q: &[T; N]) -> [T; L] {
        let mut out = [T::constant(0.0); L];
        for pass in 0..P {
            let at = OF_PASS * pass;
            out[INNER * pass..INNER * pass + 3].copy_from_slice(&point(q, at));
            out[INNER * pass + 3] = q[at + 12];
            // A pass in its node has no normal: there may be nothing around it.
            if self.offset[pass] != 0.0 {
                let [a, b, c] = [3, 6, 9].map(|k| point(q, at + k));
                let n = normal(a, b, c, self.softness);
                for i in 0..3 {
                    out[INNER * pass + i] = q[at + i] + n[i].scale(self.offset[pass]);
                }
            }
        }
        out
    }

    /// First derivatives of a pass's point and sliding coordinate.
    fn moved<const N: usize>(&self, pass: usize, q: &[f64; N]) -> Move {
        let at = OF_PASS * pass;
        let mut out = [[0.0; OF_PASS]; INNER];
        for (i, row) in out.iter_mut().enumerate() {
            row[if i < 3 { i } else { OF_PASS - 1 }] = 1.0;
        }
        if self.offset[pass] == 0.0 {
            return out;
        }
        let [a, b, c] = [3, 6, 9].map(|k| point(q, at + k));
        let (e1, e2) = (sub(b, a), sub(c, a));
        let n = cross(e1, e2);
        let size = (dot(n, n) + self.softness * self.softness).sqrt();
        let unit = scale(n, 1.0 / size);
        // A change of N by b is −e₂ × δ, by c it is e₁ × δ, and by a what keeps their sum zero.
        let axis = |j: usize| std::array::from_fn::<f64, 3, _>(|i| if i == j { 1.0 } else { 0.0 });
        for j in 0..3 {
            let by_b = scale(cross(e2, axis(j)), -1.0);
            let by_c = cross(e1, axis(j));
            let by_a = scale([by_b[0] + by_c[0], by_b[1] + by_c[1], by_b[2] + by_c[2]], -1.0);
            for (k, change) in [by_a, by_b, by_c].into_iter().enumerate() {
                let along = dot(unit, change);
                for i in 0..3 {
                    out[i][3 + 3 * k + j] = self.offset[pass] / size * (change[i] - along * unit[i]);
                }
            }
        }
        out
    }

    fn gradient_of<const L: usize, const N: usize>(&self, moves: &[Move; P], inner: &[f64; L]) -> [f64; N] {
        let mut gradient = [0.0; N];
        for (pass, moved) in moves.iter().enumerate() {
            for (i, row) in moved.iter().enumerate() {
                let g = inner[INNER * pass + i];
                for (out, by) in gradient[OF_PASS * pass..].iter_mut().zip(row) {
                    *out += g * by;
                }
            }
        }
        gradient
    }

    fn add_hessian<const L: usize, const N: usize>(
        &self,
        moves: &[Move; P],
        inner: &[[f64; L]; L],
        hessian: &mut [[f64; N]; N],
    ) {
        for (p, left) in moves.iter().enumerate() {
            for (r, right) in moves.iter().enumerate() {
                let mut product = [[0.0; OF_PASS]; INNER];
                for (i, row) in product.iter_mut().enumerate() {
                    for (k, by) in right.iter().enumerate() {
                        let h = inner[INNER * p + i][INNER * r + k];
                        for (out, by) in row.iter_mut().zip(by) {
                            *out += h * by;
                        }
                    }
                }
                for (i, by) in left.iter().enumerate() {
                    for (j, &by) in by.iter().enumerate() {
                        if by == 0.0 {
                            continue;
                        }
                        let row = &mut hessian[OF_PASS * p + j][OF_PASS * r..OF_PASS * (r + 1)];
                        for (out, value) in row.iter_mut().zip(&product[i]) {
                            *out += by * value;
                        }
                    }
                }
            }
        }
    }

    /// Adds `factor · o g · ∇²n̂` of every pass.
    fn add_turning<const L: usize, const N: usize>(
        &self,
        q: &[f64; N],
        gradient: &[f64; L],
        factor: f64,
        hessian: &mut [[f64; N]; N],
    ) {
        for pass in 0..P {
            let weight = factor * self.offset[pass];
            if weight == 0.0 {
                continue;
            }
            let at = OF_PASS * pass + 3;
            let corners: [f64; 9] = std::array::from_fn(|i| q[at + i]);
            let corners = Jet::variables(&corners);
            let n = normal(point(&corners, 0), point(&corners, 3), point(&corners, 6), self.softness);
            let force = (0..3).fold(Jet::constant(0.0), |sum, i| sum + n[i].scale(gradient[INNER * pass + i]));
            for (i, row) in force.hessian().iter().enumerate() {
                for (j, value) in row.iter().enumerate() {
                    hessian[at + i][at + j] += weight * value;
                }
            }
        }
    }
}

macro_rules! of_passes {
    ($passes:literal, $inner:literal, $all:literal) => {
        impl<E: Element<$inner>> Element<$all> for Thick<E, $passes> {
            const NAME: &'static str = E::NAME;

            fn energy<T: Real>(&self, q: &[T; $all]) -> T {
                self.inner.energy(&self.points(q))
            }
            fn convex(&self, q: &[f64; $all]) -> Local<$all> {
                let mut local = Local::zero();
                self.add_blended(q, 1.0, &mut local);
                local
            }
            fn add_blended(&self, q: &[f64; $all], convexity: f64, sum: &mut Local<$all>) {
                let mut inner = Local::zero();
                self.inner.add_blended(&self.points(q), convexity, &mut inner);
                let moves = std::array::from_fn(|pass| self.moved(pass, q));
                sum.add_gradient((inner.energy, self.gradient_of(&moves, &inner.gradient)));
                self.add_hessian(&moves, &inner.hessian, &mut sum.hessian);
                if convexity < 1.0 {
                    self.add_turning(q, &inner.gradient, 1.0 - convexity, &mut sum.hessian);
                }
            }
            fn acts(&self, q: &[f64; $all]) -> bool {
                self.inner.acts(&self.points(q))
            }
            fn gradient(&self, q: &[f64; $all]) -> (f64, [f64; $all]) {
                let (energy, gradient) = self.inner.gradient(&self.points(q));
                (energy, self.gradient_of(&std::array::from_fn(|pass| self.moved(pass, q)), &gradient))
            }
        }
    };
}

of_passes!(2, 8, 26);
of_passes!(3, 12, 39);
of_passes!(4, 16, 52);

#[cfg(test)]
mod tests {
    use super::super::element::testing::{Random, check, check_blend};
    use super::super::{Bending, Stretch};
    use super::*;

    /// Passes of a yarn one after the other, each with three nodes around it.
    fn passes<const N: usize>(random: &mut Random) -> [f64; N] {
        let around = [[0.8, 0.1, 0.0], [-0.5, 0.7, 0.1], [-0.3, -0.6, -0.1]];
        std::array::from_fn(|i| {
            let (pass, k) = ((i / OF_PASS) as f64, i % OF_PASS);
            match k {
                12 => 1.1 * pass + 0.2 * random.next(),
                _ => {
                    let (corner, axis) = (k / 3, k % 3);
                    let off = if corner > 0 { around[corner - 1][axis] } else { 0.0 };
                    off + if axis == 0 { pass } else { 0.0 } + 0.25 * random.next()
                }
            }
        })
    }

    #[test]
    fn derivatives() {
        let mut random = Random::new(31);
        for _ in 0..20 {
            let stretch = Thick { inner: Stretch { stiffness: 3.0 }, offset: [0.2, -0.15], softness: 0.1 };
            let q = passes::<26>(&mut random);
            check(&stretch, &q, 1.0);
            check_blend(&stretch, &q, 1e-9);
            let bending =
                Thick { inner: Bending { stiffness: 3.0, rest_angle: 0.5 }, offset: [0.2, -0.15, 0.1], softness: 0.1 };
            let q = passes::<39>(&mut random);
            check(&bending, &q, 1.0);
            check_blend(&bending, &q, 1e-9);
        }
    }

    #[test]
    fn a_pass_in_its_node_needs_nothing_around_it() {
        // Nothing around either node, and no distance over which a normal could fade.
        let mut q = [0.0; 26];
        for corner in 0..4 {
            q[OF_PASS + 3 * corner] = 1.5;
        }
        q[25] = 1.0;
        let element = Thick { inner: Stretch { stiffness: 2.0 }, offset: [0.0; 2], softness: 0.0 };
        let local = element.exact(&q);
        let plain = element.inner.exact(&[0.0, 0.0, 0.0, 0.0, 1.5, 0.0, 0.0, 1.0]);
        let mut closed = Local::zero();
        element.add_blended(&q, 0.0, &mut closed);
        assert!(local.energy == plain.energy && closed.energy == plain.energy && plain.gradient[4] > 0.0);
        assert!(
            closed.gradient[OF_PASS] == plain.gradient[4] && closed.hessian.iter().flatten().all(|h| h.is_finite())
        );
    }

    #[test]
    fn yarns_lie_on_their_sides() {
        // A triangle in the plane seen anticlockwise from +z: the pass lies half a yarn in front.
        let mut q = [0.0; 26];
        for pass in 0..2 {
            q[OF_PASS * pass] = pass as f64;
            for (k, corner) in [[1.0, 0.0], [0.0, 1.0], [-1.0, -1.0]].into_iter().enumerate() {
                q[OF_PASS * pass + 3 + 3 * k] = corner[0];
                q[OF_PASS * pass + 4 + 3 * k] = corner[1];
            }
            q[OF_PASS * pass + 12] = pass as f64;
        }
        let element = Thick { inner: Stretch { stiffness: 1.0 }, offset: [0.3, -0.3], softness: 0.0 };
        let y: [f64; 8] = element.points(&q);
        assert!((y[2] - 0.3).abs() < 1e-15 && (y[6] + 0.3).abs() < 1e-15);
        // From side to side the yarn is longer than from node to node.
        let strain = 1.36f64.sqrt() - 1.0;
        assert!((element.energy(&q) - 0.5 * strain * strain).abs() < 1e-15);
    }
}
