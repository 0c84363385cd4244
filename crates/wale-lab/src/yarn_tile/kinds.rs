//! Elements of one kind over vertices of a tile and their images, and what a tile asks of every kind.

use std::fmt::Debug;

use wale_numerics::block_matrix::{BLOCK, SLOTS};
use wale_numerics::block_pattern::BlockPattern;
use wale_numerics::check::Local;

use super::coarse::{CoarseDeformation, times};
use super::material::RodMaterial;
use super::parameters::{OfMaterial, RodParameter};
use super::tile::YarnTile;

/// A vertex, or a copy of it some periods away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Image {
    pub vertex: u32,
    pub shift: [i32; 2],
}

impl From<(u32, [i32; 2])> for Image {
    fn from((vertex, shift): (u32, [i32; 2])) -> Self {
        Self { vertex, shift }
    }
}

/// Where the vertices of a tile are: in the stretched plane, and rolled up with it.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    pub tile: &'a YarnTile,
    pub deformation: &'a CoarseDeformation,
    pub displacement: &'a [f64],
}

impl Frame<'_> {
    /// In the stretched plane \[m\], `F (X + kP) + ũ`.
    #[inline]
    pub fn flat(&self, image: Image) -> [f64; 3] {
        let [x, y, z] = self.tile.image(image.vertex, image.shift);
        let [x, y] = times(&self.deformation.plane, [x, y]);
        let u = &self.displacement[SLOTS * image.vertex as usize..];
        [x + u[0], y + u[1], z + u[2]]
    }

    /// Positions in space of an element's vertices, one after the other, from those in the stretched plane \[m\].
    #[inline]
    pub fn space<const K: usize, const N: usize>(&self, flat: &[[f64; 3]; K]) -> [f64; N] {
        let mut q = [0.0; N];
        for (x, &y) in q.as_chunks_mut::<3>().0.iter_mut().zip(flat) {
            *x = self.deformation.onto_cylinder(y);
        }
        q
    }

    /// The same from the vertices themselves.
    pub fn positions<const K: usize, const N: usize>(&self, stencil: &[Image; K]) -> [f64; N] {
        self.space(&stencil.map(|image| self.flat(image)))
    }

    /// How fast a vertex moves where the plane changes at this rate and nothing is displaced.
    #[inline]
    pub fn carried(&self, rate: &[[f64; 2]; 2], image: Image) -> [f64; 2] {
        let x = self.tile.image(image.vertex, image.shift);
        times(rate, [x[0], x[1]])
    }
}

/// An element that acts: the vertices it reads, where its blocks go, and its derivatives by their places in the stretched plane.
#[derive(Clone, Copy, Debug)]
pub struct Linearised<'a> {
    pub stencil: &'a [Image],
    /// By rows; [`NOWHERE`] below the diagonal.
    pub places: &'a [u32],
    pub gradient: &'a [f64],
    hessian: &'a [f64],
}

impl Linearised<'_> {
    /// Second derivative by coordinate `i` and coordinate `j`.
    #[inline]
    pub fn hessian(&self, i: usize, j: usize) -> f64 {
        self.hessian[self.gradient.len() * i + j]
    }

    /// Second derivatives by coordinate `i` and along a motion of the vertices in as many directions as it names.
    #[inline]
    pub fn hessian_along<const D: usize>(&self, i: usize, moves: &[[f64; D]]) -> f64 {
        let of_vertex = |(b, m): (usize, &[f64; D])| (0..D).map(|j| self.hessian(i, 3 * b + j) * m[j]).sum::<f64>();
        moves.iter().enumerate().map(of_vertex).sum()
    }
}

/// What is done with a number of the material: what it is, the vertices of an element, and the element's energy \[J\] and
/// gradient by that number.
pub type ByParameter<'a> = dyn FnMut(RodParameter, &[Image], f64, &[f64]) + 'a;

/// Elements of some kind, as a tile sees them.
pub trait ElementKind: Debug {
    /// Pairs of blocks that meet.
    fn couples(&self) -> Vec<(u32, u32)>;
    /// Looks up the places of all blocks; whether the pattern has them all.
    fn place(&mut self, pattern: &BlockPattern) -> bool;
    /// Energy \[J\].
    fn energy(&self, frame: &Frame<'_>) -> f64;
    /// Visits every element that acts and returns the energy \[J\]; second derivatives are between the exact (`convexity = 0`) and
    /// positive semi-definite ones (`convexity = 1`).
    fn linearise(&self, frame: &Frame<'_>, convexity: f64, visit: &mut dyn FnMut(&Linearised<'_>)) -> f64;
    /// Gradients of all elements by the places of their vertices in the stretched plane.
    fn forces(&self, frame: &Frame<'_>, visit: &mut dyn FnMut(&[Image], &[f64]));
    /// How every element that acts changes with each number of the material, the vertices held.
    fn by_parameters(&self, frame: &Frame<'_>, material: &RodMaterial, visit: &mut ByParameter<'_>);
}

/// Elements of one kind, the `K` vertices each reads, and where in the matrix its blocks go.
#[derive(Clone, Debug)]
pub struct Kind<E, const K: usize, const N: usize> {
    pub elements: Vec<E>,
    pub stencils: Vec<[Image; K]>,
    places: Vec<[[u32; K]; K]>,
}

/// A block below the diagonal, which nobody reads.
pub const NOWHERE: u32 = u32::MAX;

impl<E, const K: usize, const N: usize> Kind<E, K, N> {
    pub fn new(items: impl Iterator<Item = (E, [Image; K])>) -> Self {
        let (elements, stencils) = items.unzip();
        Self { elements, stencils, places: Vec::new() }
    }
}

impl<E: OfMaterial<N> + Debug, const K: usize, const N: usize> ElementKind for Kind<E, K, N> {
    fn couples(&self) -> Vec<(u32, u32)> {
        let of_element = |s: &[Image; K]| {
            let blocks = s.map(|image| image.vertex);
            blocks.into_iter().flat_map(move |a| blocks.into_iter().map(move |b| (a, b)))
        };
        self.stencils.iter().flat_map(of_element).collect()
    }

    fn place(&mut self, pattern: &BlockPattern) -> bool {
        self.places.clear();
        for stencil in &self.stencils {
            let mut places = [[NOWHERE; K]; K];
            for (row, a) in places.iter_mut().zip(stencil) {
                for (place, b) in row.iter_mut().zip(stencil) {
                    if a.vertex <= b.vertex {
                        let Some(found) = pattern.position(a.vertex as usize, b.vertex as usize) else { return false };
                        *place = (found * BLOCK) as u32;
                    }
                }
            }
            self.places.push(places);
        }
        true
    }

    fn energy(&self, frame: &Frame<'_>) -> f64 {
        let mut sum = 0.0;
        for (element, stencil) in self.elements.iter().zip(&self.stencils) {
            let q = frame.positions(stencil);
            if element.acts(&q) {
                sum += element.gradient(&q).0;
            }
        }
        sum
    }

    fn linearise(&self, frame: &Frame<'_>, convexity: f64, visit: &mut dyn FnMut(&Linearised<'_>)) -> f64 {
        let mut energy = 0.0;
        for ((element, stencil), places) in self.elements.iter().zip(&self.stencils).zip(&self.places) {
            let flat = stencil.map(|image| frame.flat(image));
            let q: [f64; N] = frame.space(&flat);
            if !element.acts(&q) {
                continue;
            }
            let mut local = Local::zero();
            element.add_blended(&q, convexity, &mut local);
            if frame.deformation.curvature != 0.0 {
                pull_back(frame.deformation, &flat, convexity, &mut local);
            }
            energy += local.energy;
            visit(&Linearised {
                stencil,
                places: places.as_flattened(),
                gradient: &local.gradient,
                hessian: local.hessian.as_flattened(),
            });
        }
        energy
    }

    fn forces(&self, frame: &Frame<'_>, visit: &mut dyn FnMut(&[Image], &[f64])) {
        for (element, stencil) in self.elements.iter().zip(&self.stencils) {
            let flat = stencil.map(|image| frame.flat(image));
            let (_, mut gradient) = element.gradient(&frame.space(&flat));
            if frame.deformation.curvature != 0.0 {
                for (a, &y) in flat.iter().enumerate() {
                    let jacobian = frame.deformation.jacobian(y);
                    let g: [f64; 3] = std::array::from_fn(|i| gradient[3 * a + i]);
                    for j in 0..3 {
                        gradient[3 * a + j] = (0..3).map(|i| jacobian[i][j] * g[i]).sum();
                    }
                }
            }
            visit(stencil, &gradient);
        }
    }

    fn by_parameters(&self, frame: &Frame<'_>, material: &RodMaterial, visit: &mut ByParameter<'_>) {
        for (element, stencil) in self.elements.iter().zip(&self.stencils) {
            let q = frame.positions(stencil);
            if element.acts(&q) {
                element.by_parameters(&q, material, &mut |number, energy, gradient| {
                    visit(number, stencil, energy, gradient);
                });
            }
        }
    }
}

/// Derivatives by positions in space become ones by positions in the stretched plane.
fn pull_back<const K: usize, const N: usize>(
    deformation: &CoarseDeformation,
    flat: &[[f64; 3]; K],
    convexity: f64,
    local: &mut Local<N>,
) {
    let jacobians = flat.map(|y| deformation.jacobian(y));
    let world = *local;
    for a in 0..K {
        for j in 0..3 {
            local.gradient[3 * a + j] = (0..3).map(|i| jacobians[a][i][j] * world.gradient[3 * a + i]).sum();
        }
        for b in 0..K {
            let half: [[f64; 3]; 3] = std::array::from_fn(|i| {
                std::array::from_fn(|l| (0..3).map(|k| world.hessian[3 * a + i][3 * b + k] * jacobians[b][k][l]).sum())
            });
            for j in 0..3 {
                for l in 0..3 {
                    local.hessian[3 * a + j][3 * b + l] = (0..3).map(|i| jacobians[a][i][j] * half[i][l]).sum();
                }
            }
        }
        // What the cylinder itself bends is of either sign.
        let g: [f64; 3] = std::array::from_fn(|i| world.gradient[3 * a + i]);
        let second = deformation.second(flat[a], g);
        for j in 0..3 {
            for l in 0..3 {
                local.hessian[3 * a + j][3 * a + l] += (1.0 - convexity) * second[j][l];
            }
        }
    }
}
