//! Rest shapes of registered yarns: what they would be if the fabric, as it lies, were nearly at rest.

use serde::{Deserialize, Serialize};

use super::coarse::CoarseDeformation;
use super::equilibrium::{EquilibriumSettings, TileEquilibrium, TileError, TileSolver};
use super::material::RodMaterial;
use super::soundness::distances;
use super::tile::YarnTile;

/// How rest shapes are found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RestShapeSettings {
    /// Resets with few iterations between them, while contacts are strong and local.
    pub early_rounds: usize,
    /// Newton iterations before each of these.
    pub early_iterations: usize,
    /// Resets after equilibria of yarns whose outer contact grows from one to the next, from nothing but the inner one.
    ///
    /// Yarns that are pushed from each other all at once can go this way for one material and that way for another that is hardly
    /// different; if they grow, they go the same way. Test: `rest_shapes_change_little_with_the_material`.
    pub growing_rounds: usize,
    /// Resets after equilibria.
    pub late_rounds: usize,
    /// Largest change of an edge's rest length from the registered one \[–\].
    pub most_change: f64,
    /// How equilibria are found.
    pub equilibrium: EquilibriumSettings,
}

impl Default for RestShapeSettings {
    fn default() -> Self {
        Self {
            early_rounds: 8,
            early_iterations: 4,
            growing_rounds: 0,
            late_rounds: 30,
            most_change: 0.2,
            equilibrium: EquilibriumSettings::default(),
        }
    }
}

/// Rest shapes and what they do.
#[derive(Clone, Debug)]
pub struct RestShapeReport {
    /// The tile with its rest shapes, where it lies in equilibrium.
    pub tile: YarnTile,
    /// Size of the coarse stress `(dΨ/ds, dΨ/dc)` of the undeformed tile in equilibrium with the rest shapes as registered \[N/m\].
    pub stress_before: f64,
    /// The same after each late round \[N/m\].
    pub stress: Vec<f64>,
    /// Largest move of a vertex from where it was registered \[m\].
    pub moved: f64,
    /// The last equilibrium, under no coarse deformation.
    pub equilibrium: TileEquilibrium,
}

/// Finds rest lengths, curvatures and torsions with which the undeformed tile bears little stress, by turns of equilibria and of
/// resetting the rest shapes to them [Sperl2022, section 7.2].
///
/// # Errors
/// [`TileError`]; an early equilibrium that was not reached is none.
pub fn estimate_rest_shapes(
    registered: &YarnTile,
    material: &RodMaterial,
    settings: &RestShapeSettings,
) -> Result<RestShapeReport, TileError> {
    let lengths = registered.lengths();
    let mut tile = registered.at_rest_as_it_lies();
    let early = EquilibriumSettings { max_iterations: settings.early_iterations, ..settings.equilibrium };
    let before = TileSolver::new(&tile, material, settings.equilibrium)?.solve(&CoarseDeformation::REST)?;
    let mut stress = Vec::new();
    // Each from no trust in second derivatives: with that of the turn before Newton's method is a tenth quicker, and now and then goes
    // another way for a material that is hardly different.
    let rest = |tile: &YarnTile, material: &RodMaterial, equilibrium: EquilibriumSettings| {
        TileSolver::new(tile, material, equilibrium)?.solve(&CoarseDeformation::REST)
    };
    for round in 1..=settings.growing_rounds {
        let [outer, inner] = material.contact.map(|contact| contact.radius);
        let mut thinner = *material;
        thinner.contact[0].radius = inner + (outer - inner) * round as f64 / (settings.growing_rounds + 1) as f64;
        let found = rest(&tile, &thinner, settings.equilibrium)?;
        tile = reset(&tile, &found, &lengths, settings.most_change);
    }
    for round in 0..settings.early_rounds + settings.late_rounds {
        let late = round >= settings.early_rounds;
        let of_round = if late { settings.equilibrium } else { early };
        let found = rest(&tile, material, of_round)?;
        if late {
            stress.push(size(&found));
        }
        tile = reset(&tile, &found, &lengths, settings.most_change);
    }
    let found = rest(&tile, material, settings.equilibrium)?;
    stress.push(size(&found));
    let tile = moved(&tile, &found);
    let moved = tile
        .vertices()
        .iter()
        .zip(registered.vertices())
        .map(|(a, b)| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt())
        .fold(0.0, f64::max);
    Ok(RestShapeReport { tile, stress_before: size(&before), stress, moved, equilibrium: found })
}

fn size(found: &TileEquilibrium) -> f64 {
    found.stress.stretch.hypot(found.stress.compression)
}

/// The tile where an equilibrium without coarse deformation has taken it.
fn moved(tile: &YarnTile, found: &TileEquilibrium) -> YarnTile {
    let mut tile = tile.clone();
    for (x, u) in tile.vertices.iter_mut().zip(&found.displacement) {
        *x = [x[0] + u[0], x[1] + u[1], x[2] + u[2]];
    }
    tile
}

/// The tile there, at rest as it lies but for edges that would have changed too much.
fn reset(tile: &YarnTile, found: &TileEquilibrium, registered: &[f64], most: f64) -> YarnTile {
    let mut tile = moved(tile, found).at_rest_as_it_lies();
    for (rest, &length) in tile.rest.lengths.iter_mut().zip(registered) {
        *rest = rest.clamp((1.0 - most) * length, (1.0 + most) * length);
    }
    tile
}

/// The least radius \[m\] with which every edge of a tile touches another, `R_est` [Sperl2022, section 7.3.2].
#[must_use]
pub fn contact_radius(tile: &YarnTile) -> f64 {
    let mut within = 3.0 * tile.radius();
    // Farther than this no edge of a fabric is from all others.
    let farthest = 2.0 * (tile.periods()[0] + tile.periods()[1]);
    loop {
        let mut nearest = vec![f64::INFINITY; tile.vertex_count()];
        for (pair, distance) in distances(tile, within) {
            for edge in [pair.first, pair.second] {
                let least = &mut nearest[edge as usize];
                *least = least.min(distance);
            }
        }
        let largest = nearest.iter().copied().fold(0.0, f64::max);
        if largest.is_finite() || within > farthest {
            return 0.5 * largest;
        }
        within *= 1.5;
    }
}
