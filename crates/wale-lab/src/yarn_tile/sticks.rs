//! Where the yarns of a tile touch at rest and stick.

use wale::energy::{RodStick, stick_offsets};

use super::kinds::{Image, Kind};
use super::material::RodMaterial;
use super::soundness::distances;
use super::tile::YarnTile;

/// Distance of centrelines within which yarns stick, over the radius `R` at which all edges touch.
const REACH: f64 = 3.0;

/// Yarns stick where they touch as the tile lies, `k_h L̄_a L̄_b (1 − (D/3R)²)²/R` for two edges at a distance `D`.
///
/// Nearness is a smooth function of the tile, and `R` that of the inner contact, so that a fit of the outer radius changes no list.
pub fn sticks(tile: &YarnTile, material: &RodMaterial) -> Kind<RodStick, 4, 12> {
    if material.holding == 0.0 {
        return Kind::new(std::iter::empty());
    }
    let radius = material.contact[1].radius / RodMaterial::INNER_RADIUS;
    let within = REACH * radius;
    Kind::new(distances(tile, within).into_iter().map(|(pair, distance)| {
        let [a, b] = tile.ends(pair.first, [0, 0]);
        let [c, d] = tile.ends(pair.second, pair.shift);
        let stencil = [a, b, c, d].map(Image::from);
        let mut q = [0.0; 12];
        for (x, image) in q.as_chunks_mut::<3>().0.iter_mut().zip(stencil) {
            *x = tile.image(image.vertex, image.shift);
        }
        let nearness = 1.0 - (distance / within).powi(2);
        let area = tile.rest.lengths[pair.first as usize] * tile.rest.lengths[pair.second as usize];
        let stiffness = material.holding * nearness * nearness * area / radius;
        (RodStick { stiffness, rest: stick_offsets(&q) }, stencil)
    }))
}
