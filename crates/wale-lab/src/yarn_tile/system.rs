//! The energy of a tile by its displacements and its compression, with second derivatives.

use std::sync::Arc;

use wale_numerics::block_matrix::{BLOCK, SLOTS};
use wale_numerics::block_pattern::BlockPattern;
use wale_numerics::constrained::ConstrainedSystem;
use wale_numerics::sparse_cholesky::CholeskyError;

use super::closest::segment_distance;
use super::coarse::CoarseDeformation;
use super::constraints::Constraints;
use super::elements::{MOST_VERTICES, TileElements};
use super::kinds::{ElementKind, Frame, Image, Linearised, NOWHERE};
use super::material::RodMaterial;
use super::neighbours::{Followers, near_pairs};
use super::tile::YarnTile;

/// A tile's elements over its unknowns: displacements `ũ` in blocks of five slots, of which three are used, and the compression.
#[derive(Debug)]
pub struct TileSystem {
    pub tile: YarnTile,
    pub deformation: CoarseDeformation,
    pub constraints: Constraints,
    pub elements: TileElements,
    pub second: ConstrainedSystem,
    /// Gradient by the displacements, and by the compression \[N, J\].
    pub gradient: Vec<f64>,
    pub compression_gradient: f64,
    /// Stiffness of the spring that holds each vertex \[N/m\], and of each slot of `ũ`.
    pub anchor: f64,
    anchors: Vec<f64>,
    pub material: RodMaterial,
    followers: Followers,
    free_compression: bool,
    /// Where the vertices were in the stretched plane, and how it was stretched, when contacts were last searched for.
    searched: Option<(CoarseDeformation, Vec<[f64; 3]>)>,
    /// How far apart in periods the farthest contact pair is.
    farthest: [i32; 2],
}

/// Distance beyond the reach of contacts within which pairs are kept, in reaches.
const MARGIN: f64 = 0.25;

impl TileSystem {
    /// `anchor` \[N/m\] holds every vertex.
    ///
    /// # Errors
    /// If the system is too large.
    pub fn new(
        tile: &YarnTile,
        material: &RodMaterial,
        anchor: f64,
        free_compression: bool,
    ) -> Result<Self, CholeskyError> {
        let constraints = Constraints::new(tile);
        let pattern = Arc::new(BlockPattern::from_pairs(tile.vertex_count(), []));
        let second = Self::matrix(pattern, &constraints, free_compression)?;
        Ok(Self {
            followers: Followers::new(tile, std::f64::consts::PI * tile.radius),
            tile: tile.clone(),
            deformation: CoarseDeformation::REST,
            elements: TileElements::new(tile, material),
            second,
            gradient: vec![0.0; SLOTS * tile.vertex_count()],
            compression_gradient: 0.0,
            anchor,
            anchors: Self::anchors(tile, anchor),
            material: *material,
            free_compression,
            searched: None,
            farthest: [0, 0],
            constraints,
        })
    }

    fn matrix(
        pattern: Arc<BlockPattern>,
        constraints: &Constraints,
        free_compression: bool,
    ) -> Result<ConstrainedSystem, CholeskyError> {
        let free: Vec<bool> = (0..SLOTS * pattern.rows()).map(|slot| slot % SLOTS < 3).collect();
        let border = usize::from(free_compression);
        ConstrainedSystem::new(pattern, &free, constraints.rows.clone(), constraints.pins.clone(), border)
    }

    /// Where the vertices are.
    pub fn frame<'a>(&'a self, displacement: &'a [f64]) -> Frame<'a> {
        Frame { tile: &self.tile, deformation: &self.deformation, displacement }
    }

    /// Where they are in the stretched plane \[m\].
    fn flat(&self, displacement: &[f64]) -> Vec<[f64; 3]> {
        let frame = self.frame(displacement);
        (0..self.tile.vertex_count() as u32).map(|vertex| frame.flat(Image { vertex, shift: [0, 0] })).collect()
    }

    /// Searches for contacts anew if anything has moved too far since; whether it did, and the second derivatives are lost.
    ///
    /// # Errors
    /// If the system is too large.
    pub fn refresh_contacts(&mut self, displacement: &[f64]) -> Result<bool, CholeskyError> {
        let reach = self.material.reach();
        let flat = self.flat(displacement);
        if let Some((deformation, before)) = &self.searched {
            let moved = flat
                .iter()
                .zip(before)
                .map(|(a, b)| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>())
                .fold(0.0f64, f64::max)
                .sqrt();
            let lattice: f64 = (0..2)
                .map(|axis| {
                    let [a, b] = [0, 1].map(|i| self.deformation.plane[i][axis] - deformation.plane[i][axis]);
                    f64::from(self.farthest[axis]) * self.tile.periods[axis] * a.hypot(b)
                })
                .sum();
            let bent = self.deformation.curvature == deformation.curvature;
            if bent && 2.0 * moved + lattice <= MARGIN * reach {
                return Ok(false);
            }
        }
        // On a cylinder, what lies above its middle comes nearer.
        let height = flat.iter().fold(0.0f64, |m, x| m.max(x[2].abs()));
        let nearer = 1.0 - (self.deformation.curvature.abs() * (height + reach)).min(0.75);
        let within = (1.0 + MARGIN) * reach / nearer;
        let pairs = near_pairs(&self.tile, &self.deformation, &flat, &self.followers, within);
        self.farthest = [1, 1];
        for pair in &pairs {
            for axis in 0..2 {
                self.farthest[axis] = self.farthest[axis].max(pair.shift[axis].abs() + 1);
            }
        }
        self.elements.touch(&self.tile, &self.material, &pairs);
        let pattern = Arc::clone(self.second.matrix.pattern());
        if !self.place(&pattern) {
            let couples = self.elements.kinds().into_iter().flat_map(ElementKind::couples);
            let pattern = Arc::new(BlockPattern::from_pairs(self.tile.vertex_count(), couples));
            let found = self.place(&pattern);
            assert!(found, "the pattern was made of these couples");
            self.second = Self::matrix(pattern, &self.constraints, self.free_compression)?;
        }
        self.searched = Some((self.deformation, flat));
        Ok(true)
    }

    fn place(&mut self, pattern: &Arc<BlockPattern>) -> bool {
        self.elements.kinds_mut().into_iter().all(|kind| kind.place(pattern))
    }

    /// Energy of the tile \[J\].
    pub fn energy(&self, displacement: &[f64]) -> f64 {
        let frame = self.frame(displacement);
        let energy: f64 = self.elements.kinds().iter().map(|kind| kind.energy(&frame)).sum();
        energy + self.energy_of_anchors(displacement)
    }

    fn energy_of_anchors(&self, displacement: &[f64]) -> f64 {
        0.5 * self.anchors.iter().zip(displacement).map(|(k, u)| k * u * u).sum::<f64>()
    }

    /// Stiffness \[N/m\] of each slot's spring.
    fn anchors(tile: &YarnTile, each: f64) -> Vec<f64> {
        (0..SLOTS * tile.vertex_count()).map(|slot| if slot % SLOTS < 3 { each } else { 0.0 }).collect()
    }

    /// Energy \[J\]; finds the gradient, and second derivatives between the exact (`convexity = 0`) and positive semi-definite
    /// ones (`convexity = 1`).
    pub fn linearise(&mut self, displacement: &[f64], convexity: f64) -> f64 {
        self.gradient.fill(0.0);
        self.compression_gradient = 0.0;
        self.second.clear();
        let Self { tile, deformation, elements, second, gradient, compression_gradient, free_compression, .. } = self;
        let frame = Frame { tile, deformation, displacement };
        let rate = free_compression.then(|| frame.deformation.compression_rate());
        let mut energy = 0.0;
        for kind in elements.kinds() {
            energy += kind.linearise(&frame, convexity, &mut |element| {
                add_blocks(element, gradient, &mut second.matrix.values);
                let Some(rate) = &rate else { return };
                let mut moves = [[0.0; 2]; MOST_VERTICES];
                let moves = &mut moves[..element.stencil.len()];
                moves.iter_mut().zip(element.stencil).for_each(|(m, &image)| *m = frame.carried(rate, image));
                for (a, image) in element.stencil.iter().enumerate() {
                    for i in 0..3 {
                        let column = element.hessian_along(3 * a + i, moves);
                        second.border[0][SLOTS * image.vertex as usize + i] += column;
                        if i < 2 {
                            second.corner[0] += moves[a][i] * column;
                            *compression_gradient += moves[a][i] * element.gradient[3 * a + i];
                        }
                    }
                }
            });
        }
        self.gradient.iter_mut().zip(&self.anchors).zip(displacement).for_each(|((g, k), u)| *g += k * u);
        self.second.add_diagonal(&self.anchors);
        energy + self.energy_of_anchors(displacement)
    }

    /// Forces `∂W/∂x` on the vertices of every element, pulled back to the stretched plane.
    pub fn for_each_force(&self, displacement: &[f64], mut visit: impl FnMut(&[Image], &[f64])) {
        let frame = self.frame(displacement);
        for kind in self.elements.kinds() {
            kind.forces(&frame, &mut visit);
        }
    }

    /// The longest part of a step in which no vertex moves further than `most` \[m\] and no two centrelines come nearer than half
    /// their distance.
    pub fn longest_step(&self, displacement: &[f64], direction: &[f64], compression: f64, most: f64) -> f64 {
        let mut rate = self.deformation.compression_rate();
        rate.iter_mut().flatten().for_each(|r| *r *= compression);
        let frame = self.frame(displacement);
        let change = |image: Image| {
            let [a, b] = frame.carried(&rate, image);
            let d = &direction[SLOTS * image.vertex as usize..];
            [a + d[0], b + d[1], d[2]]
        };
        let length = |d: [f64; 3]| (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        let largest = (0..self.tile.vertex_count() as u32)
            .map(|vertex| length(change(Image { vertex, shift: [0, 0] })))
            .fold(0.0f64, f64::max);
        let mut longest = (most / largest.max(f64::MIN_POSITIVE)).min(1.0);
        for stencil in &self.elements.contact.stencils {
            let moves = stencil.map(change);
            let mut towards = 0.0f64;
            for a in 0..2 {
                for b in 2..4 {
                    towards = towards.max(length(std::array::from_fn(|i| moves[a][i] - moves[b][i])));
                }
            }
            let [a, b, c, d] = stencil.map(|image| self.deformation.onto_cylinder(frame.flat(image)));
            let nearest = segment_distance([a, b], [c, d]);
            if 0.5 * nearest < longest * towards {
                longest = 0.5 * nearest / towards;
            }
        }
        longest
    }
}

/// Adds an element's derivatives to the gradient and to the matrix.
fn add_blocks(element: &Linearised<'_>, gradient: &mut [f64], values: &mut [f64]) {
    let vertices = element.stencil.len();
    for (a, image) in element.stencil.iter().enumerate() {
        let start = SLOTS * image.vertex as usize;
        for i in 0..3 {
            gradient[start + i] += element.gradient[3 * a + i];
        }
        for (b, &place) in element.places[vertices * a..][..vertices].iter().enumerate() {
            if place == NOWHERE {
                continue;
            }
            let block = &mut values[place as usize..place as usize + BLOCK];
            for j in 0..3 {
                for i in 0..3 {
                    block[SLOTS * j + i] += element.hessian(3 * a + i, 3 * b + j);
                }
            }
        }
    }
}
