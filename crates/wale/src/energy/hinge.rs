//! Bending of a thin shell: an edge between two triangles that resists being folded.

use std::f64::consts::FRAC_PI_4;

use wale_numerics::check::Local;
use wale_numerics::jet::Real;
use wale_numerics::jet::vector3::{cross, dot, scale, sub};

use super::element::{Element, point};

/// The three bending stiffnesses `k_θ` of a fabric, by the direction in which it curves \[N·m\].
///
/// A strip bent to radius `R` stores `k_θ A/R²`, so the flexural rigidity that textile tests report is `B = 2k_θ`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendingStiffness {
    /// Curving along the weft (its axis lies along the warp).
    pub weft: f64,
    /// Curving along the bias, at 45°.
    pub bias: f64,
    /// Curving along the warp.
    pub warp: f64,
}

impl BendingStiffness {
    /// Number of stiffnesses.
    pub const COUNT: usize = 3;
    /// Their names, in the order of [`Self::to_array`].
    pub const NAMES: [&'static str; Self::COUNT] = ["k_θ,weft", "k_θ,bias", "k_θ,warp"];

    /// The same in all directions \[N·m\].
    #[must_use]
    pub fn isotropic(stiffness: f64) -> Self {
        Self { weft: stiffness, bias: stiffness, warp: stiffness }
    }
    /// The three numbers \[N·m\].
    #[must_use]
    pub fn to_array(self) -> [f64; Self::COUNT] {
        [self.weft, self.bias, self.warp]
    }
    /// From the three numbers \[N·m\].
    #[must_use]
    pub fn from_array([weft, bias, warp]: [f64; Self::COUNT]) -> Self {
        Self { weft, bias, warp }
    }
    /// One of the three is 1 N·m, the others zero: the energy is linear in them.
    #[must_use]
    pub fn unit(index: usize) -> Self {
        let mut array = [0.0; Self::COUNT];
        array[index] = 1.0;
        Self::from_array(array)
    }
    /// Stiffness \[N·m\] of curving along `direction` (weft, warp): linear in the angle between weft, bias and warp.
    #[must_use]
    pub fn along(&self, direction: [f64; 2]) -> f64 {
        let angle = direction[1].abs().atan2(direction[0].abs()) / FRAC_PI_4;
        if angle <= 1.0 {
            self.weft + angle * (self.bias - self.weft)
        } else {
            self.bias + (angle - 1.0) * (self.warp - self.bias)
        }
    }
}

/// An edge with its two triangles.
///
/// `V = k_θ κ² A`, `κ = θ/H`, with the bend angle `θ` of the edge, the mean altitude `H` of its triangles over it and their
/// area `A = ℓH`      [Sperl2022, Eq. 4]
///
/// Local coordinates: the ends of the edge, the vertex to its left, the vertex to its right `x₀ x₁ x₂ x₃` \[m\]. `θ` is in
/// (−π, π), positive where the edge is a ridge as seen against the normals; undefined where a triangle has no area or both lie
/// on each other.
///
/// Differs from the paper: it prints `κ = 3θ/H`, which is the curvature of a cylinder only as a mean over the three edges of a
/// triangle of which one lies along the axis. Squared and summed over edges, with the whole area of both triangles, it stores
/// nine times `k_θ A/R²`. With `κ = θ/H` a strip bent to radius `R` stores `k_θ A/R²` on equilateral meshes in every
/// direction, and on right-angled ones where the axis lies along edges that leave strips flat between them. A form that is a
/// sum of squares over edges cannot do so for every mesh and every axis: an axis across the hypotenuses of right-angled
/// triangles stores three times as much, so swatches are meshed by nearly equilateral triangles. Tests:
/// `a_strip_bent_to_a_radius_stores_stiffness_times_area_over_its_square`, `right_angled_triangles_are_stiff_one_way`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hinge {
    /// `k_θ A/H² = k_θ ℓ/H` of the rest shape \[N·m\]: the energy is this times `θ²`.
    pub weight: f64,
}

impl Hinge {
    /// The edge whose vertices lie at rest at `rest`, in the fabric's coordinates (weft, warp) \[m\]: ends, left, right; `None`
    /// if a triangle has no area there.
    #[must_use]
    pub fn new(stiffness: &BendingStiffness, rest: [[f64; 2]; 4]) -> Option<Self> {
        let from = |k: usize| [rest[k][0] - rest[0][0], rest[k][1] - rest[0][1]];
        let (e, left, right) = (from(1), from(2), from(3));
        let square = e[0] * e[0] + e[1] * e[1];
        let doubles = [e[0] * left[1] - e[1] * left[0], e[1] * right[0] - e[0] * right[1]];
        // Written so that a NaN fails.
        if !(doubles[0] > 0.0 && doubles[1] > 0.0 && square < f64::INFINITY) {
            return None;
        }
        // ℓ/H with H = (h₁ + h₂)/2 and ℓh = twice the area of a triangle.
        Some(Self { weight: stiffness.along([-e[1], e[0]]) * 2.0 * square / (doubles[0] + doubles[1]) })
    }

    /// The bend angle \[rad\], zero where both triangles lie in one plane.
    pub fn angle<T: Real>(q: &[T; 12]) -> T {
        let e = sub(point(q, 3), point(q, 0));
        let n1 = cross(e, sub(point(q, 6), point(q, 0)));
        let n2 = cross(sub(point(q, 9), point(q, 0)), e);
        let along = dot(cross(n1, n2), scale(e, T::constant(1.0) / dot(e, e).sqrt()));
        along.atan2(dot(n1, n2))
    }
}

/// The angle with its derivatives by the vectors `e`, `a`, `b` from the first vertex to the other three.
struct BendAngle {
    angle: f64,
    first: [[f64; 3]; 3],
    second: [[f64; 9]; 9],
}

/// One triangle's part: the vertex beside the edge turns the angle by `p = ℓ n/|n|²`, and the edge by `−s p`, where `s` is how
/// far along the edge the vertex lies.
struct Side {
    p: [f64; 3],
    s: f64,
    /// `∂p/∂a` and `∂p/∂e`, by rows.
    by_vertex: [[f64; 3]; 3],
    by_edge: [[f64; 3]; 3],
    /// `∂s/∂e`.
    s_by_edge: [f64; 3],
}

impl Side {
    /// `sign` is 1 for the triangle to the left, whose normal is `e × a`, −1 for that to the right.
    fn new(e: [f64; 3], a: [f64; 3], sign: f64) -> Self {
        let n = cross(e, a).map(|x| sign * x);
        let (square, length) = (dot(n, n), dot(e, e).sqrt());
        let along = dot(a, e) / (length * length);
        let q = n.map(|x| x / square);
        // ∂(n/|n|²)/∂n, then the rows of [e]× and −[a]× by it.
        let inverse: [[f64; 3]; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| (f64::from(u8::from(i == j)) - 2.0 * n[i] * n[j] / square) / square)
        });
        // Row · [v]× = row × v.
        let by_vertex = inverse.map(|row| cross(row, e).map(|x| sign * length * x));
        let by_edge: [[f64; 3]; 3] = std::array::from_fn(|i| {
            let turned = cross(inverse[i], a);
            std::array::from_fn(|j| q[i] * e[j] / length - sign * length * turned[j])
        });
        Self {
            p: q.map(|x| length * x),
            s: along,
            by_vertex,
            by_edge,
            s_by_edge: std::array::from_fn(|i| (a[i] - 2.0 * along * e[i]) / (length * length)),
        }
    }
}

impl BendAngle {
    fn edges(q: &[f64; 12]) -> [[f64; 3]; 3] {
        [3, 6, 9].map(|start| sub(point(q, start), point(q, 0)))
    }

    /// Angle and gradient; the second derivatives stay zero unless asked for.
    fn new(q: &[f64; 12], curved: bool) -> Self {
        let [e, a, b] = Self::edges(q);
        let sides = [Side::new(e, a, 1.0), Side::new(e, b, -1.0)];
        let by_edge = std::array::from_fn(|i| -sides[0].s * sides[0].p[i] - sides[1].s * sides[1].p[i]);
        // The angle grows where the vertices beside the edge sink below it.
        let first = [by_edge, sides[0].p, sides[1].p].map(|v: [f64; 3]| v.map(|x| -x));
        let mut second = [[0.0; 9]; 9];
        if curved {
            for (index, side) in sides.iter().enumerate() {
                let start = 3 + 3 * index;
                for i in 0..3 {
                    for j in 0..3 {
                        second[start + i][start + j] = -side.by_vertex[i][j];
                        second[start + i][j] = -side.by_edge[i][j];
                        second[j][start + i] = -side.by_edge[i][j];
                        second[i][j] += side.s * side.by_edge[i][j] + side.p[i] * side.s_by_edge[j];
                    }
                }
            }
        }
        Self { angle: Hinge::angle(q), first, second }
    }

    /// The gradient by the four vertices.
    fn gradient(&self) -> [f64; 12] {
        let [e, a, b] = &self.first;
        std::array::from_fn(|k| match k / 3 {
            0 => -e[k] - a[k] - b[k],
            vertex => self.first[vertex - 1][k % 3],
        })
    }

    /// Adds `factor` times the second derivatives by the four vertices.
    fn add_second(&self, factor: f64, hessian: &mut [[f64; 12]; 12]) {
        let mut columns = [[0.0; 3]; 9];
        for i in 0..9 {
            for j in 0..9 {
                let value = factor * self.second[i][j];
                hessian[3 + i][3 + j] += value;
                columns[i][j % 3] += value;
            }
        }
        for i in 0..9 {
            for j in 0..3 {
                hessian[3 + i][j] -= columns[i][j];
                hessian[j][3 + i] -= columns[i][j];
                hessian[i % 3][j] += columns[i][j];
            }
        }
    }
}

impl Element<12> for Hinge {
    const NAME: &'static str = "hinge";

    fn energy<T: Real>(&self, q: &[T; 12]) -> T {
        Self::angle(q).square().scale(self.weight)
    }

    fn convex(&self, q: &[f64; 12]) -> Local<12> {
        let mut local = Local::zero();
        self.add_blended(q, 1.0, &mut local);
        local
    }

    fn add_blended(&self, q: &[f64; 12], convexity: f64, sum: &mut Local<12>) {
        let bend = BendAngle::new(q, convexity < 1.0);
        let gradient = bend.gradient();
        let slope = 2.0 * self.weight * bend.angle;
        sum.add_gradient((self.weight * bend.angle * bend.angle, gradient.map(|g| slope * g)));
        sum.add_square(2.0 * self.weight, &gradient);
        if convexity < 1.0 {
            bend.add_second((1.0 - convexity) * slope, &mut sum.hessian);
        }
    }

    fn gradient(&self, q: &[f64; 12]) -> (f64, [f64; 12]) {
        let bend = BendAngle::new(q, false);
        let slope = 2.0 * self.weight * bend.angle;
        (self.weight * bend.angle * bend.angle, bend.gradient().map(|g| slope * g))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::super::element::testing::{Random, check, check_blend};
    use super::*;

    const REST: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.1], [0.3, 0.9], [0.6, -0.7]];

    #[test]
    fn derivatives() {
        let mut random = Random::new(11);
        let element = Hinge::new(&BendingStiffness { weft: 1.0, bias: 2.0, warp: 5.0 }, REST).unwrap();
        for fold in [0.0, 0.5, 1.5] {
            for _ in 0..30 {
                let q = std::array::from_fn(|k| {
                    let plane = if k % 3 < 2 { REST[k / 3][k % 3] } else { 0.0 };
                    let folded = if k % 3 == 2 && k > 5 { fold } else { 0.0 };
                    plane + folded + 0.2 * random.next()
                });
                check(&element, &q, 0.1);
                check_blend(&element, &q, 1e-9);
            }
        }
    }

    #[test]
    fn the_angle_is_that_between_the_planes_and_rigid_motions_cost_nothing() {
        for angle in [-2.5f64, -0.3, 0.0, 1e-9, 1.0, 3.0] {
            let q = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.2, 1.0, 0.0, 0.7, -angle.cos(), -angle.sin()];
            assert!((Hinge::angle(&q) - angle).abs() < 1e-14);
            let (s, c) = 0.9f64.sin_cos();
            let turned: [f64; 12] = std::array::from_fn(|k| match k % 3 {
                0 => c * q[k] - s * q[k + 2] + 0.5,
                1 => q[k] - 3.0,
                _ => s * q[k - 2] + c * q[k],
            });
            assert!((Hinge::angle(&turned) - angle).abs() < 1e-14);
        }
    }

    #[test]
    fn stiffness_is_interpolated_by_the_direction_of_curvature() {
        let stiffness = BendingStiffness { weft: 1.0, bias: 3.0, warp: 7.0 };
        let at = |degrees: f64| stiffness.along([degrees.to_radians().cos(), degrees.to_radians().sin()]);
        for (degrees, expected) in
            [(0.0, 1.0), (22.5, 2.0), (45.0, 3.0), (67.5, 5.0), (90.0, 7.0), (135.0, 3.0), (-45.0, 3.0)]
        {
            assert!((at(degrees) - expected).abs() < 1e-12, "{degrees}: {}", at(degrees));
        }
        // An edge along the warp bends the fabric along the weft.
        let warp_edge = [[0.0, 0.0], [0.0, 1.0], [-1.0, 0.5], [1.0, 0.5]];
        assert!((Hinge::new(&stiffness, warp_edge).unwrap().weight - 1.0).abs() < 1e-15);
        assert!(Hinge::new(&stiffness, [[0.0, 0.0], [0.0, 1.0], [1.0, 0.5], [-1.0, 0.5]]).is_none());
    }

    /// Energy of a patch rolled onto a cylinder over `k_θ A/R²`, hinges at the patch's border left out; the area is that which
    /// the hinges inside share out.
    fn energy_ratio(points: &[[f64; 2]], triangles: &[[usize; 3]], axis_degrees: f64, radius: f64) -> f64 {
        let (s, c) = axis_degrees.to_radians().sin_cos();
        let place = |p: [f64; 2]| {
            let (along, across) = (c * p[0] + s * p[1], c * p[1] - s * p[0]);
            [along, radius * (across / radius).sin(), radius * (across / radius).cos()]
        };
        let mut edges: HashMap<(usize, usize), usize> = HashMap::new();
        for t in triangles {
            for k in 0..3 {
                edges.insert((t[k], t[(k + 1) % 3]), t[(k + 2) % 3]);
            }
        }
        let (mut energy, mut area) = (0.0, 0.0);
        for (&(a, b), &left) in &edges {
            let Some(&right) = edges.get(&(b, a)) else { continue };
            if a > b {
                continue;
            }
            let vertices = [a, b, left, right];
            let element = Hinge::new(&BendingStiffness::isotropic(1.0), vertices.map(|v| points[v])).unwrap();
            let q: [f64; 12] = std::array::from_fn(|k| place(points[vertices[k / 3]])[k % 3]);
            energy += element.energy(&q);
            // Each of a triangle's three edges gets a third of it.
            let d = |u: usize, v: usize| [points[v][0] - points[u][0], points[v][1] - points[u][1]];
            let (e, l, r) = (d(a, b), d(a, left), d(a, right));
            area += ((e[0] * l[1] - e[1] * l[0]) + (e[1] * r[0] - e[0] * r[1])) / 6.0;
        }
        energy * radius * radius / area
    }

    /// A patch of 40 × 40 cells spanned by two vectors, cut along the diagonal `u + v`.
    fn patch(u: [f64; 2], v: [f64; 2]) -> (Vec<[f64; 2]>, Vec<[usize; 3]>) {
        let n = 40;
        let at = |i: usize, j: usize| i * (n + 1) + j;
        let mut points = Vec::new();
        for i in 0..=n {
            for j in 0..=n {
                points.push([0, 1].map(|k| i as f64 * u[k] + j as f64 * v[k]));
            }
        }
        let mut triangles = Vec::new();
        for i in 0..n {
            for j in 0..n {
                triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        (points, triangles)
    }

    #[test]
    fn a_strip_bent_to_a_radius_stores_stiffness_times_area_over_its_square() {
        let within = |ratio: f64, what: &str| assert!((ratio - 1.0).abs() < 0.02, "{what}: {ratio}");
        // Regular: squares with a diagonal, the axis along their sides.
        let (points, triangles) = patch([0.01, 0.0], [0.0, 0.01]);
        within(energy_ratio(&points, &triangles, 0.0, 0.5), "regular, axis along x");
        within(energy_ratio(&points, &triangles, 90.0, 0.5), "regular, axis along y");
        // 45°: the axis along the diagonals of those squares.
        within(energy_ratio(&points, &triangles, 45.0, 0.5), "45°");
        // Equilateral: in every direction.
        let (points, triangles) = patch([0.01, 0.0], [-0.005, 0.005 * 3f64.sqrt()]);
        for degrees in [0.0, 10.0, 30.0, 45.0, 77.0, 90.0] {
            within(energy_ratio(&points, &triangles, degrees, 0.5), "equilateral");
        }
    }

    #[test]
    fn right_angled_triangles_are_stiff_one_way() {
        let (points, triangles) = patch([0.01, 0.0], [0.0, 0.01]);
        let across = energy_ratio(&points, &triangles, 135.0, 0.5);
        assert!((across - 3.0).abs() < 0.1, "{across}");
    }
}
