//! The energy of a tile by its displacements and its compression, with second derivatives.

use std::sync::Arc;

use wale::energy::{Element, RodBending, RodContact, RodStick, RodStretch};
use wale_numerics::block_matrix::{BLOCK, SLOTS};
use wale_numerics::block_pattern::BlockPattern;
use wale_numerics::check::Local;
use wale_numerics::constrained::ConstrainedSystem;
use wale_numerics::sparse_cholesky::CholeskyError;

use super::closest::segment_distance;
use super::coarse::{CoarseDeformation, times};
use super::constraints::Constraints;
use super::kinds::{Image, Kind, NOWHERE, pull_back};
use super::material::RodMaterial;
use super::neighbours::{Followers, near_pairs};
use super::sticks::sticks;
use super::tile::YarnTile;

/// A tile's elements over its unknowns: displacements `ũ` in blocks of five slots, of which three are used, and the compression.
#[derive(Debug)]
pub struct TileSystem {
    pub tile: YarnTile,
    pub deformation: CoarseDeformation,
    pub constraints: Constraints,
    pub stretch: Kind<RodStretch, 2>,
    pub bending: Kind<RodBending, 4>,
    pub contact: Kind<RodContact, 4>,
    /// Yarns that touch at rest and stick.
    pub stick: Kind<RodStick, 4>,
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
        let constraints = Constraints::new(tile);
        let pattern = Arc::new(BlockPattern::from_pairs(tile.vertex_count(), []));
        let second = Self::matrix(pattern, &constraints, free_compression)?;
        Ok(Self {
            followers: Followers::new(tile, std::f64::consts::PI * tile.radius),
            tile: tile.clone(),
            deformation: CoarseDeformation::REST,
            stretch,
            bending,
            contact: Kind::new(std::iter::empty()),
            stick: sticks(tile, material),
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

    /// Where the vertices are in the stretched plane \[m\].
    pub fn flat(&self, displacement: &[f64]) -> Vec<[f64; 3]> {
        (0..self.tile.vertex_count() as u32)
            .map(|v| self.flat_image(Image { vertex: v, shift: [0, 0] }, displacement))
            .collect()
    }

    /// `F (X + kP) + ũ`.
    #[inline]
    fn flat_image(&self, image: Image, displacement: &[f64]) -> [f64; 3] {
        let [x, y, z] = self.tile.image(image.vertex, image.shift);
        let [x, y] = times(&self.deformation.plane, [x, y]);
        let u = &displacement[SLOTS * image.vertex as usize..];
        [x + u[0], y + u[1], z + u[2]]
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
        let tile = &self.tile;
        let (phases, reading) = (self.material.contact, self.material.reading);
        self.contact = Kind::new(pairs.iter().map(|pair| {
            let [a, b] = tile.ends(pair.first, [0, 0]).map(Image::from);
            let [c, d] = tile.ends(pair.second, pair.shift).map(Image::from);
            let rest_area = tile.rest.lengths[pair.first as usize] * tile.rest.lengths[pair.second as usize];
            (RodContact { phases, reading, rest_area }, [a, b, c, d])
        }));
        let pattern = Arc::clone(self.second.matrix.pattern());
        let placed = self.place(&pattern);
        if !placed {
            let of_yarn = self.stretch.couples().chain(self.bending.couples());
            let couples = of_yarn.chain(self.contact.couples()).chain(self.stick.couples());
            let pattern = Arc::new(BlockPattern::from_pairs(self.tile.vertex_count(), couples));
            let found = self.place(&pattern);
            assert!(found, "the pattern was made of these couples");
            self.second = Self::matrix(pattern, &self.constraints, self.free_compression)?;
        }
        self.searched = Some((self.deformation, flat));
        Ok(true)
    }

    fn place(&mut self, pattern: &Arc<BlockPattern>) -> bool {
        self.stretch.place(pattern)
            && self.bending.place(pattern)
            && self.contact.place(pattern)
            && self.stick.place(pattern)
    }

    /// Energy of the tile \[J\].
    pub fn energy(&self, displacement: &[f64]) -> f64 {
        self.energy_of(&self.stretch, displacement)
            + self.energy_of(&self.bending, displacement)
            + self.energy_of(&self.contact, displacement)
            + self.energy_of(&self.stick, displacement)
            + self.energy_of_anchors(displacement)
    }

    fn energy_of_anchors(&self, displacement: &[f64]) -> f64 {
        0.5 * self.anchors.iter().zip(displacement).map(|(k, u)| k * u * u).sum::<f64>()
    }

    /// Stiffness \[N/m\] of each slot's spring.
    fn anchors(tile: &YarnTile, each: f64) -> Vec<f64> {
        (0..SLOTS * tile.vertex_count()).map(|slot| if slot % SLOTS < 3 { each } else { 0.0 }).collect()
    }

    fn energy_of<E: Element<N>, const N: usize, const K: usize>(&self, kind: &Kind<E, K>, displacement: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (element, stencil) in kind.elements.iter().zip(&kind.stencils) {
            let flat = stencil.map(|image| self.flat_image(image, displacement));
            let q = self.world(&flat);
            if element.acts(&q) {
                sum += element.gradient(&q).0;
            }
        }
        sum
    }

    /// Positions of an element's vertices in space, one after the other.
    pub fn positions<const K: usize, const N: usize>(&self, stencil: &[Image; K], displacement: &[f64]) -> [f64; N] {
        self.world(&stencil.map(|image| self.flat_image(image, displacement)))
    }

    /// The same of positions in the stretched plane.
    #[inline]
    fn world<const K: usize, const N: usize>(&self, flat: &[[f64; 3]; K]) -> [f64; N] {
        let mut q = [0.0; N];
        for (x, &y) in q.as_chunks_mut::<3>().0.iter_mut().zip(flat) {
            *x = self.deformation.onto_cylinder(y);
        }
        q
    }

    /// Energy \[J\]; finds the gradient, and second derivatives between the exact (`convexity = 0`) and positive semi-definite
    /// ones (`convexity = 1`).
    pub fn linearise(&mut self, displacement: &[f64], convexity: f64) -> f64 {
        self.gradient.fill(0.0);
        self.compression_gradient = 0.0;
        self.second.clear();
        let (stretch, bending, contact, stick) = self.take();
        let energy = self.add_kind(&stretch, displacement, convexity)
            + self.add_kind(&bending, displacement, convexity)
            + self.add_kind(&contact, displacement, convexity)
            + self.add_kind(&stick, displacement, convexity);
        (self.stretch, self.bending, self.contact, self.stick) = (stretch, bending, contact, stick);
        self.gradient.iter_mut().zip(&self.anchors).zip(displacement).for_each(|((g, k), u)| *g += k * u);
        self.second.add_diagonal(&self.anchors);
        energy + self.energy_of_anchors(displacement)
    }

    /// The elements, moved out while the rest of the system is written to.
    fn take(&mut self) -> (Kind<RodStretch, 2>, Kind<RodBending, 4>, Kind<RodContact, 4>, Kind<RodStick, 4>) {
        (
            std::mem::replace(&mut self.stretch, Kind::new(std::iter::empty())),
            std::mem::replace(&mut self.bending, Kind::new(std::iter::empty())),
            std::mem::replace(&mut self.contact, Kind::new(std::iter::empty())),
            std::mem::replace(&mut self.stick, Kind::new(std::iter::empty())),
        )
    }

    fn add_kind<E: Element<N>, const N: usize, const K: usize>(
        &mut self,
        kind: &Kind<E, K>,
        displacement: &[f64],
        convexity: f64,
    ) -> f64 {
        let mut energy = 0.0;
        let rate = self.deformation.compression_rate();
        for ((element, stencil), places) in kind.elements.iter().zip(&kind.stencils).zip(&kind.places) {
            let flat = stencil.map(|image| self.flat_image(image, displacement));
            let q: [f64; N] = self.world(&flat);
            if !element.acts(&q) {
                continue;
            }
            let mut local = Local::zero();
            element.add_blended(&q, convexity, &mut local);
            if self.deformation.curvature != 0.0 {
                pull_back(&self.deformation, &flat, convexity, &mut local);
            }
            energy += local.energy;
            for (a, (image, row)) in stencil.iter().zip(places).enumerate() {
                let start = SLOTS * image.vertex as usize;
                for i in 0..3 {
                    self.gradient[start + i] += local.gradient[3 * a + i];
                }
                for (b, &place) in row.iter().enumerate() {
                    if place == NOWHERE {
                        continue;
                    }
                    let block = &mut self.second.matrix.values[place as usize..place as usize + BLOCK];
                    for j in 0..3 {
                        for i in 0..3 {
                            block[SLOTS * j + i] += local.hessian[3 * a + i][3 * b + j];
                        }
                    }
                }
            }
            if self.free_compression {
                let moves: [[f64; 2]; K] = stencil.map(|image| {
                    let x = self.tile.image(image.vertex, image.shift);
                    times(&rate, [x[0], x[1]])
                });
                for (a, image) in stencil.iter().enumerate() {
                    for i in 0..3 {
                        let column: f64 = (0..K)
                            .map(|b| (0..2).map(|j| local.hessian[3 * a + i][3 * b + j] * moves[b][j]).sum::<f64>())
                            .sum();
                        self.second.border[0][SLOTS * image.vertex as usize + i] += column;
                        if i < 2 {
                            self.second.corner[0] += moves[a][i] * column;
                            self.compression_gradient += moves[a][i] * local.gradient[3 * a + i];
                        }
                    }
                }
            }
        }
        energy
    }

    /// Forces `∂W/∂x` on the vertices of every element, pulled back to the stretched plane.
    pub fn for_each_force(&self, displacement: &[f64], mut visit: impl FnMut(&[Image], &[f64])) {
        self.forces_of(&self.stretch, displacement, &mut visit);
        self.forces_of(&self.bending, displacement, &mut visit);
        self.forces_of(&self.contact, displacement, &mut visit);
        self.forces_of(&self.stick, displacement, &mut visit);
    }

    fn forces_of<E: Element<N>, const N: usize, const K: usize>(
        &self,
        kind: &Kind<E, K>,
        displacement: &[f64],
        visit: &mut impl FnMut(&[Image], &[f64]),
    ) {
        for (element, stencil) in kind.elements.iter().zip(&kind.stencils) {
            let flat = stencil.map(|image| self.flat_image(image, displacement));
            let (_, mut gradient) = element.gradient(&self.world(&flat));
            if self.deformation.curvature != 0.0 {
                for (a, &y) in flat.iter().enumerate() {
                    let jacobian = self.deformation.jacobian(y);
                    let g: [f64; 3] = std::array::from_fn(|i| gradient[3 * a + i]);
                    for j in 0..3 {
                        gradient[3 * a + j] = (0..3).map(|i| jacobian[i][j] * g[i]).sum();
                    }
                }
            }
            visit(stencil, &gradient);
        }
    }

    /// The longest part of a step in which no vertex moves further than `most` \[m\] and no two centrelines come nearer than half
    /// their distance.
    pub fn longest_step(&self, displacement: &[f64], direction: &[f64], compression: f64, most: f64) -> f64 {
        let mut rate = self.deformation.compression_rate();
        rate.iter_mut().flatten().for_each(|r| *r *= compression);
        let change = |image: Image| {
            let x = self.tile.image(image.vertex, image.shift);
            let [a, b] = times(&rate, [x[0], x[1]]);
            let d = &direction[SLOTS * image.vertex as usize..];
            [a + d[0], b + d[1], d[2]]
        };
        let length = |d: [f64; 3]| (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        let largest = (0..self.tile.vertex_count() as u32)
            .map(|vertex| length(change(Image { vertex, shift: [0, 0] })))
            .fold(0.0f64, f64::max);
        let mut longest = (most / largest.max(f64::MIN_POSITIVE)).min(1.0);
        for stencil in &self.contact.stencils {
            let moves = stencil.map(change);
            let mut towards = 0.0f64;
            for a in 0..2 {
                for b in 2..4 {
                    towards = towards.max(length(std::array::from_fn(|i| moves[a][i] - moves[b][i])));
                }
            }
            let [a, b, c, d] =
                stencil.map(|image| self.deformation.onto_cylinder(self.flat_image(image, displacement)));
            let nearest = segment_distance([a, b], [c, d]);
            if 0.5 * nearest < longest * towards {
                longest = 0.5 * nearest / towards;
            }
        }
        longest
    }
}
