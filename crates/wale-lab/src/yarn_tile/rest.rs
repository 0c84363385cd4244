//! Rest shape of a tile's yarns: what each would be without the others.

use serde::{Deserialize, Serialize};
use wale::energy::{rod_curvature, rod_torsion};
use wale_numerics::jet::vector3::dot;

use super::tile::{Edge, TileFault, YarnTile};

/// Rest shape of yarns, of which nothing says where they lie or how they are turned.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RestShape {
    /// Lengths of the edges \[m\].
    pub lengths: Vec<f64>,
    /// Sizes of the curvatures at the vertices, `2 tan(θ/2)` \[–\].
    pub curvatures: Vec<f64>,
    /// Angles by which curvatures turn about each edge from its first vertex to its last \[rad\].
    pub torsions: Vec<f64>,
}

impl RestShape {
    /// The shape of a tile as it lies.
    #[must_use]
    pub fn of(tile: &YarnTile) -> Self {
        let edges: Vec<[f64; 3]> = tile.edge_vectors().collect();
        let bends: Vec<[f64; 3]> = tile
            .around
            .iter()
            .map(|&[before, after]| rod_curvature(edges[before as usize], edges[after as usize]))
            .collect();
        let torsion = |(edge, &along): (&Edge, &[f64; 3])| rod_torsion(along, edge.ends.map(|v| bends[v as usize]));
        Self {
            lengths: tile.lengths(),
            curvatures: bends.iter().map(|&bend| dot(bend, bend).sqrt()).collect(),
            torsions: tile.edges.iter().zip(&edges).map(torsion).collect(),
        }
    }

    /// Yarns of these lengths, straight if they were free.
    #[must_use]
    pub fn straight(lengths: Vec<f64>) -> Self {
        let zeros = vec![0.0; lengths.len()];
        Self { lengths, curvatures: zeros.clone(), torsions: zeros }
    }

    /// The shapes of several tiles beside each other.
    pub(super) fn repeated(&self, copies: usize) -> Self {
        let Self { lengths, curvatures, torsions } = self;
        Self {
            lengths: lengths.repeat(copies),
            curvatures: curvatures.repeat(copies),
            torsions: torsions.repeat(copies),
        }
    }

    /// Whether it is one of so many vertices and edges.
    ///
    /// # Errors
    /// [`TileFault::Count`] or [`TileFault::Rest`].
    pub(super) fn check(&self, count: usize) -> Result<(), TileFault> {
        let lists = [
            ("rest lengths", "length", &self.lengths),
            ("rest curvatures", "curvature", &self.curvatures),
            ("rest torsions", "torsion", &self.torsions),
        ];
        for (all, what, values) in lists {
            if values.len() != count {
                return Err(TileFault::Count { what: all, found: values.len(), wanted: count });
            }
            let fits = |value: f64| match what {
                "length" => value > 0.0,
                "curvature" => value >= 0.0,
                _ => true,
            };
            if let Some(index) = values.iter().position(|&value| !value.is_finite() || !fits(value)) {
                return Err(TileFault::Rest { what, index, value: values[index] });
            }
        }
        Ok(())
    }
}
