//! The elements of a tile: stretch and bending along its yarns, contact and sticking between them.

use wale::energy::{RodBending, RodContact, RodStick, RodStretch};

use super::kinds::{ElementKind, Image, Kind};
use super::material::RodMaterial;
use super::neighbours::Pair;
use super::sticks::sticks;
use super::tile::YarnTile;

/// Most vertices that an element reads.
pub const MOST_VERTICES: usize = 4;

/// The elements of a tile, kind by kind.
#[derive(Debug)]
pub struct TileElements {
    stretch: Kind<RodStretch, 2, 6>,
    bending: Kind<RodBending, 4, 12>,
    /// Pairs of edges that are near each other.
    pub contact: Kind<RodContact, 4, 12>,
    /// Yarns that touch at rest and stick.
    stick: Kind<RodStick, 4, 12>,
}

impl TileElements {
    /// Those of a tile that has not been searched for contacts.
    pub fn new(tile: &YarnTile, material: &RodMaterial) -> Self {
        let stretch = Kind::new((0..).zip(&tile.rest.lengths).map(|(edge, &rest_length)| {
            let RodMaterial { soft_stretch: soft, stiff_stretch: stiff, onset, .. } = *material;
            (RodStretch { soft, stiff, onset, rest_length }, tile.ends(edge, [0, 0]).map(Image::from))
        }));
        let bending = Kind::new(tile.edges.iter().enumerate().map(|(index, edge)| {
            let [first, last] = edge.ends;
            let [before, after] = [tile.around[first as usize][0], tile.around[last as usize][1]];
            let element = RodBending {
                stiffness: material.bending,
                rest_curvatures: edge.ends.map(|vertex| tile.rest.curvatures[vertex as usize]),
                rest_torsion: tile.rest.torsions[index],
                rest_lengths: [before, index as u32, after].map(|edge| tile.rest.lengths[edge as usize]),
            };
            let [before, _] = tile.beside(first as usize);
            let [_, (after, beyond)] = tile.beside(last as usize);
            let beyond = [edge.shift[0] + beyond[0], edge.shift[1] + beyond[1]];
            (element, [before, (first, [0, 0]), (last, edge.shift), (after, beyond)].map(Image::from))
        }));
        Self { stretch, bending, contact: Kind::new(std::iter::empty()), stick: sticks(tile, material) }
    }

    /// Puts these pairs of edges in contact.
    pub fn touch(&mut self, tile: &YarnTile, material: &RodMaterial, pairs: &[Pair]) {
        let (phases, reading) = (material.contact, material.reading);
        self.contact = Kind::new(pairs.iter().map(|pair| {
            let [a, b] = tile.ends(pair.first, [0, 0]).map(Image::from);
            let [c, d] = tile.ends(pair.second, pair.shift).map(Image::from);
            let rest_area = tile.rest.lengths[pair.first as usize] * tile.rest.lengths[pair.second as usize];
            (RodContact { phases, reading, rest_area }, [a, b, c, d])
        }));
    }

    /// All kinds.
    pub fn kinds(&self) -> [&dyn ElementKind; 4] {
        [&self.stretch, &self.bending, &self.contact, &self.stick]
    }

    /// The same to change them.
    pub fn kinds_mut(&mut self) -> [&mut dyn ElementKind; 4] {
        [&mut self.stretch, &mut self.bending, &mut self.contact, &mut self.stick]
    }
}
