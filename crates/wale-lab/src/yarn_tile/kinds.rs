//! Elements of one kind over vertices of a tile and their images.

use wale_numerics::block_matrix::BLOCK;
use wale_numerics::block_pattern::BlockPattern;
use wale_numerics::check::Local;

use super::coarse::CoarseDeformation;

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

/// Elements of one kind, the `K` vertices each reads, and where in the matrix its blocks go.
#[derive(Clone, Debug)]
pub struct Kind<E, const K: usize> {
    pub elements: Vec<E>,
    pub stencils: Vec<[Image; K]>,
    pub places: Vec<[[u32; K]; K]>,
}

/// A block below the diagonal, which nobody reads.
pub const NOWHERE: u32 = u32::MAX;

impl<E, const K: usize> Kind<E, K> {
    pub fn new(items: impl Iterator<Item = (E, [Image; K])>) -> Self {
        let (elements, stencils) = items.unzip();
        Self { elements, stencils, places: Vec::new() }
    }

    /// Pairs of blocks that meet.
    pub fn couples(&self) -> impl Iterator<Item = (u32, u32)> {
        self.stencils.iter().flat_map(|s| s.iter().flat_map(move |a| s.iter().map(move |b| (a.vertex, b.vertex))))
    }

    /// Looks up the places of all blocks; whether the pattern has them all.
    pub fn place(&mut self, pattern: &BlockPattern) -> bool {
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
}

/// Derivatives by positions in space become ones by positions in the stretched plane.
pub fn pull_back<const K: usize, const N: usize>(
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
