//! Matrices to try solvers on: small random ones, and one shaped like a knitted swatch.
#![allow(dead_code, missing_docs)]

use std::sync::Arc;
use wale_numerics::block_matrix::{BLOCK, BlockMatrix, SLOTS};
use wale_numerics::block_pattern::BlockPattern;

/// The same sequence in every run (splitmix64).
pub struct Sequence(pub u64);

impl Sequence {
    pub fn integer(&mut self, below: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as usize % below
    }
    /// In (-1, 1).
    pub fn number(&mut self) -> f64 {
        self.integer(1 << 40) as f64 / (1u64 << 39) as f64 - 1.0
    }
    pub fn vector(&mut self, length: usize) -> Vec<f64> {
        (0..length).map(|_| self.number()).collect()
    }
}

/// Adds `stiffness g gᵀ` over the two blocks of a pair.
fn add_spring(matrix: &mut BlockMatrix, pair: [usize; 2], stiffness: f64, g: &[f64; 2 * SLOTS]) {
    for (a, &row) in pair.iter().enumerate() {
        for (b, &column) in pair.iter().enumerate() {
            let block = matrix.block_mut(row, column).unwrap();
            for r in 0..SLOTS {
                for c in 0..SLOTS {
                    block[c * SLOTS + r] += stiffness * g[a * SLOTS + r] * g[b * SLOTS + c];
                }
            }
        }
    }
}

/// A random symmetric positive definite matrix, with about `degree` neighbours a row.
pub fn random_matrix(rows: usize, degree: usize, seed: u64) -> BlockMatrix {
    let mut sequence = Sequence(seed);
    let pairs: Vec<(u32, u32)> =
        (0..rows * degree / 2).map(|_| (sequence.integer(rows) as u32, sequence.integer(rows) as u32)).collect();
    let mut matrix = BlockMatrix::zeros(Arc::new(BlockPattern::from_pairs(rows, pairs.iter().copied())));
    for &(i, j) in pairs.iter().filter(|(i, j)| i != j) {
        let g = std::array::from_fn(|_| sequence.number());
        add_spring(&mut matrix, [i as usize, j as usize], 1.0, &g);
    }
    let diagonal: Vec<f64> = (0..rows * SLOTS).map(|_| 0.2 + 0.1 * sequence.number()).collect();
    matrix.add_diagonal(&diagonal, 1.0);
    matrix
}

/// A matrix with the bands and the contrast of a garter swatch of `wales × courses` loops, four
/// nodes a loop, numbered along the courses: stiff along the yarn, soft in bending and stitches.
pub struct Swatch {
    pub matrix: BlockMatrix,
    /// Wale and course of each node, in loops.
    pub coordinates: Vec<[f64; 2]>,
    pub free: Vec<bool>,
}

pub fn swatch(wales: usize, courses: usize) -> Swatch {
    let width = 4 * wales;
    let rows = width * courses;
    let mut coordinates = vec![[0.0; 2]; rows];
    let mut position = vec![[0.0; 3]; rows];
    for course in 0..courses {
        for along in 0..width {
            let place = if course % 2 == 0 { along } else { width - 1 - along };
            let node = course * width + along;
            let (wale, phase) = (place / 4, place % 4);
            let up = [0.1, 0.9, 0.9, 0.1][phase] + course as f64;
            let across = wale as f64 + [0.3, 0.15, 0.85, 0.7][phase];
            coordinates[node] = [across, up];
            position[node] = [across, up, 0.2 * (phase as f64 - 1.5)];
        }
    }
    // Node of the next course that lies over the same place.
    let above = |node: usize| (node / width + 1) * width + (width - 1 - node % width);
    let mut springs: Vec<(usize, usize, f64)> = Vec::new();
    for node in 0..rows {
        if node + 1 < rows {
            springs.push((node, node + 1, 1e4));
        }
        if node + 2 < rows {
            springs.push((node, node + 2, 1.0));
        }
        for shift in [0, 1, 3] {
            if node + width < rows && above(node) + shift < rows {
                springs.push((node, above(node) + shift, 0.5));
            }
        }
    }
    let pairs = springs.iter().map(|&(i, j, _)| (i as u32, j as u32));
    let mut matrix = BlockMatrix::zeros(Arc::new(BlockPattern::from_pairs(rows, pairs)));
    let mut sequence = Sequence(7);
    for &(i, j, stiffness) in &springs {
        let mut d: [f64; 3] = std::array::from_fn(|k| position[j][k] - position[i][k]);
        let length = d.iter().map(|v| v * v).sum::<f64>().sqrt();
        d.iter_mut().for_each(|v| *v /= length);
        // Sliding shortens one side and lengthens the other: the last slots take part a little.
        let slide = 0.3;
        let g = [-d[0], -d[1], -d[2], slide, 0.0, d[0], d[1], d[2], -slide, 0.0];
        add_spring(&mut matrix, [i, j], stiffness, &g);
        for _ in 0..2 {
            let mut g = [0.0; 10];
            for k in 0..SLOTS {
                g[k] = sequence.number();
                g[SLOTS + k] = -g[k];
            }
            add_spring(&mut matrix, [i, j], 0.3, &g);
        }
    }
    matrix.add_diagonal(&vec![0.05; rows * SLOTS], 1.0);
    // The first course is pinned, and a node in seven has one arc length only.
    let free: Vec<bool> = (0..rows * SLOTS)
        .map(|slot| {
            let (node, s) = (slot / SLOTS, slot % SLOTS);
            node >= width && !(s == 4 && node % 7 == 0)
        })
        .collect();
    matrix.fix_slots(&free, 1.0);
    Swatch { matrix, coordinates, free }
}

/// The matrix in full, row-major.
pub fn dense(matrix: &BlockMatrix) -> Vec<Vec<f64>> {
    let mut full = vec![vec![0.0; matrix.dimension()]; matrix.dimension()];
    for row in 0..matrix.rows() {
        for &column in matrix.pattern().row(row) {
            let block: &[f64; BLOCK] = matrix.block(row, column as usize).unwrap();
            for r in 0..SLOTS {
                for c in 0..SLOTS {
                    full[row * SLOTS + r][column as usize * SLOTS + c] = block[c * SLOTS + r];
                }
            }
        }
    }
    full
}

pub fn dense_times(matrix: &[Vec<f64>], x: &[f64]) -> Vec<f64> {
    let dot = |row: &Vec<f64>| row.iter().zip(x).map(|(a, b)| a * b).sum();
    matrix.iter().map(dot).collect()
}

pub fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

pub fn largest(a: &[f64]) -> f64 {
    a.iter().map(|v| v.abs()).fold(0.0, f64::max)
}

/// The outcome on one, two and four threads.
pub fn on_threads<T: Send>(run: impl Fn() -> T + Sync + Send) -> [T; 3] {
    [1, 2, 4].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(&run)
    })
}
