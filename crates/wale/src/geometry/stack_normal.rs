//! The direction along which a node's passes are stacked: the normal of the plane through its incident segments.
//!
//! The paper fits a plane to the incident segments and orients it by reference directions of the rest state
//! [Cirio2017, 3.2]. Both are done here at once. In the initial layout the incident segments have unit directions
//! `r_j` about the front vector `f`, with `t₁, t₂` completing a right-handed frame `t₁ × t₂ = f`; now they have
//! directions `d_j`. The columns `h_k = Σ_j d_j (r_j · t_k)` span the image of the fabric's plane under the
//! least-squares deformation that carries `r_j` to `d_j`, so
//!
//! ```text
//! n = h₁ × h₂ / |h₁ × h₂|
//! ```
//!
//! is the normal, already pointing to the fabric's front however the fabric is turned, curled or folded. When the
//! segments are coplanar it is the fitted plane's normal; when they are not, it stays continuous where the fitted
//! plane would jump (segments folded by more than 45° out of the plane).

use glam::DVec3;

use super::passes::Passes;
use crate::model::{Frame, Network, NodeId};

/// Below this share of the flattest possible fit, a node's own normal gives way to its neighbours'.
const TRUSTED: f64 = 0.05;

/// Unit normals, one per node, from the back of the fabric to its front.
pub(super) fn stack_normals(
    network: &Network,
    passes: &Passes,
    positions: &[DVec3],
    periods: [DVec3; 2],
    rest_periods: [DVec3; 2],
) -> Vec<DVec3> {
    let fits: Vec<Fit> =
        (0..network.node_count()).map(|i| Fit::at(i, network, passes, positions, periods, rest_periods)).collect();
    let mut normals: Vec<DVec3> = fits.iter().map(|fit| fit.normal).collect();
    for (i, fit) in fits.iter().enumerate() {
        if fit.trust >= 1.0 {
            continue;
        }
        let around = neighbours_normal(i, network, passes, &fits);
        // The stack stands across the yarns, whatever the neighbours say.
        let across = (around - fit.along * around.dot(fit.along)).normalize_or(fit.carried);
        normals[i] = (fit.normal * fit.trust + across * (1.0 - fit.trust)).normalize_or(across);
    }
    normals
}

/// Unit normals of a frame, one per node, from the back of the fabric to its front.
#[must_use]
pub fn fronts(network: &Network, frame: &Frame) -> Vec<DVec3> {
    let periods = network.periods.unwrap_or_default();
    stack_normals(network, &Passes::new(network), &frame.positions, periods, periods)
}

/// Sum of the trusted normals of the nodes next to a node.
fn neighbours_normal(node: usize, network: &Network, passes: &Passes, fits: &[Fit]) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for pass in network.stack(NodeId::new(node)) {
        let p = pass.index();
        for neighbour in [passes.before(p), passes.after(p)].into_iter().flatten() {
            let fit = &fits[network.pass_node[neighbour.pass].index()];
            sum += fit.normal * fit.trust;
        }
    }
    sum
}

/// The plane fitted at one node.
struct Fit {
    /// Unit normal; `carried` where the segments span no plane.
    normal: DVec3,
    /// From 0 (the segments span no plane) to 1 (use the normal as it is).
    trust: f64,
    /// Unit direction that most segments follow; zero if there are none.
    along: DVec3,
    /// The front vector, carried by the smallest turn of the direction that most segments follow.
    carried: DVec3,
}

impl Fit {
    fn at(
        node: usize,
        network: &Network,
        passes: &Passes,
        positions: &[DVec3],
        periods: [DVec3; 2],
        rest_periods: [DVec3; 2],
    ) -> Self {
        let front = network.front[node].normalize_or(DVec3::Z);
        let first = front.any_orthonormal_vector();
        let second = front.cross(first);
        let (mut h1, mut h2) = (DVec3::ZERO, DVec3::ZERO);
        let (mut longest, mut along, mut along_rest) = (0.0, DVec3::ZERO, DVec3::ZERO);
        for pass in network.stack(NodeId::new(node)) {
            let p = pass.index();
            let here = passes.place(positions, periods, p);
            let here_rest = passes.place(&network.position, rest_periods, p);
            for neighbour in [passes.before(p), passes.after(p)].into_iter().flatten() {
                let current = passes.neighbour_place(positions, periods, neighbour) - here;
                let direction = current.normalize_or_zero();
                let rest = (passes.neighbour_place(&network.position, rest_periods, neighbour) - here_rest)
                    .normalize_or_zero();
                h1 += direction * rest.dot(first);
                h2 += direction * rest.dot(second);
                if current.length() > longest {
                    (longest, along, along_rest) = (current.length(), direction, rest);
                }
            }
        }
        let carried = carry(front, along_rest, along);
        let area = h1.cross(h2);
        // At most 1, for two equally long and perpendicular columns.
        let flatness = 2.0 * area.length() / (h1.length_squared() + h2.length_squared());
        let trust = if flatness.is_finite() { (flatness / TRUSTED).min(1.0) } else { 0.0 };
        Self { normal: area.normalize_or(carried), trust, along, carried }
    }
}

/// Turns `front` by the smallest rotation that takes `rest` to `current`, and makes it perpendicular to `current`.
fn carry(front: DVec3, rest: DVec3, current: DVec3) -> DVec3 {
    if current == DVec3::ZERO || rest == DVec3::ZERO {
        return front;
    }
    let turned = glam::DQuat::from_rotation_arc(rest, current) * front;
    (turned - current * turned.dot(current)).normalize_or(current.any_orthonormal_vector())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sample_fabric::plain_weave;
    use glam::{DQuat, EulerRot};

    /// Normal of the plane through the origin nearest to the vectors, by power iteration on `tr(C) I − C`.
    fn fitted_plane(vectors: &[DVec3]) -> DVec3 {
        let trace: f64 = vectors.iter().map(|v| v.length_squared()).sum();
        let mut normal = DVec3::new(0.3, 0.5, 0.8).normalize();
        for _ in 0..2000 {
            let product: DVec3 = vectors.iter().map(|v| *v * v.dot(normal)).sum();
            normal = (normal * trace - product).normalize();
        }
        normal
    }

    #[test]
    fn coplanar_segments_give_the_fitted_plane() {
        let network = plain_weave(4, 4, 2e-3);
        let passes = Passes::new(&network);
        // An affine map keeps segments coplanar; this one also shears and shrinks.
        let map = glam::DMat3::from_cols(DVec3::new(0.7, 0.2, -0.4), DVec3::new(0.5, 0.9, 0.6), DVec3::Z);
        let positions: Vec<DVec3> = network.position.iter().map(|x| map * *x).collect();
        let none = [DVec3::ZERO; 2];
        let normals = stack_normals(&network, &passes, &positions, none, none);
        let plane = fitted_plane(&positions.iter().map(|x| *x - positions[0]).collect::<Vec<_>>());
        for (i, normal) in normals.iter().enumerate() {
            if network.stack(NodeId::new(i)).len() > 1 {
                assert!(normal.dot(plane).abs() > 1.0 - 1e-9, "{normal} {plane}");
                assert!(normal.dot(map.x_axis.cross(map.y_axis)) > 0.0);
            }
        }
    }

    #[test]
    fn a_fabric_turned_upside_down_keeps_its_front() {
        let network = plain_weave(3, 3, 2e-3);
        let passes = Passes::new(&network);
        let turn = DQuat::from_euler(EulerRot::XYZ, 3.0, 0.4, 1.0);
        let positions: Vec<DVec3> = network.position.iter().map(|x| turn * *x).collect();
        let none = [DVec3::ZERO; 2];
        for normal in stack_normals(&network, &passes, &positions, none, none) {
            assert!(normal.dot(turn * DVec3::Z) > 1.0 - 1e-9, "{normal}");
        }
    }

    #[test]
    fn collinear_and_coincident_segments_still_have_a_unit_normal() {
        let network = plain_weave(3, 3, 2e-3);
        let passes = Passes::new(&network);
        let none = [DVec3::ZERO; 2];
        for squeeze in [0.0, 1e-300, 1e-12] {
            for positions in [
                network.position.iter().map(|x| DVec3::new(x.x, x.y * squeeze, 0.0)).collect(),
                vec![DVec3::splat(squeeze); network.node_count()],
            ] {
                let positions: Vec<DVec3> = positions;
                for normal in stack_normals(&network, &passes, &positions, none, none) {
                    assert!((normal.length() - 1.0).abs() < 1e-9, "{normal}");
                }
            }
        }
    }
}
