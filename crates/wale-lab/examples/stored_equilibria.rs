//! Compares equilibria of yarn tiles with those that an independent full-contact simulator stored [Sperl2021].
//!
//! ```text
//! cargo run --release -p wale-lab --example stored_equilibria -- [FOLDER [EVERY]]
//! ```
//!
//! FOLDER has `NAME.pyp` and `model_*/axes.txt`, `model_*/data.npy`; EVERY takes one strain in so many along each axis.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use wale::energy::ContactReading;
use wale_lab::yarn_tile::{
    CoarseDeformation, EquilibriumSettings, RodMaterial, TileEquilibrium, TileSolver, YarnTile, read_pattern,
};

type Failure = Box<dyn std::error::Error + Send + Sync>;

const MODELS: [(&str, &str); 3] =
    [("stocktiny.pyp", "model_stocktiny"), ("stockinette.pyp", "model_stock_9"), ("basket.pyp", "model_basket_9")];

/// Young's modulus \[Pa\], documented for `stocktiny`, taken over for the others.
const YOUNG: f64 = 1e6;

/// Readings of contact with their stiffness \[J/m²\]: the documented number as it stands, and what comes nearest to the barrier of
/// the other simulator, `x⁻² + x² − 2` [Kaldor2008], which at `x = 0.8` is 23 times `f`.
const CONTACTS: [(ContactReading, f64); 2] = [(ContactReading::SquareOfBarrier, 1e2), (ContactReading::Barrier, 2.3e3)];

/// Displacements over a grid of strains.
struct Stored {
    axes: [Vec<f64>; 3],
    values: Vec<f32>,
}

impl Stored {
    fn read(folder: &Path) -> Result<Self, Failure> {
        let text = std::fs::read_to_string(folder.join("axes.txt"))?;
        let numbers = |line: &str| line.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>();
        let axes: Vec<Vec<f64>> = text.lines().map(numbers).collect::<Result<_, _>>()?;
        let axes = axes.try_into().map_err(|_| "axes.txt has not three lines")?;
        Ok(Self { axes, values: read_npy(&folder.join("data.npy"))? })
    }

    fn strains(&self) -> usize {
        self.axes.iter().map(Vec::len).product()
    }

    /// Displacements \[m\] at a strain; vertices are the slow axis.
    fn displacement(&self, [i, j, k]: [usize; 3], vertices: usize) -> Vec<[f64; 3]> {
        let strain = i + self.axes[0].len() * (j + self.axes[1].len() * k);
        let at = |vertex: usize| 4 * (vertex * self.strains() + strain);
        (0..vertices).map(|v| std::array::from_fn(|axis| f64::from(self.values[at(v) + axis]))).collect()
    }
}

/// The numbers of a little-endian 32-bit NPY file.
fn read_npy(path: &Path) -> Result<Vec<f32>, Failure> {
    let bytes = std::fs::read(path)?;
    let header = bytes.get(..10).filter(|b| b.starts_with(b"\x93NUMPY\x01")).ok_or("not an NPY file of version 1")?;
    let start = 10 + usize::from(u16::from_le_bytes([header[8], header[9]]));
    let described = std::str::from_utf8(bytes.get(10..start).ok_or("a cut header")?)?;
    if !described.contains("'<f4'") || !described.contains("'fortran_order': False") {
        return Err(format!("{}: not 32-bit little-endian rows: {described}", path.display()).into());
    }
    Ok(bytes[start..].as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect())
}

/// The symmetric deformation with these stretches along both periods and this sine of shear.
fn deformation([sx, sa, sy]: [f64; 3]) -> Option<CoarseDeformation> {
    let (a, b) = (1.0 + sx, 1.0 + sy);
    let metric = [[a * a, a * b * sa], [a * b * sa, b * b]];
    let root = (metric[0][0] * metric[1][1] - metric[0][1] * metric[0][1]).sqrt();
    let trace = (metric[0][0] + metric[1][1] + 2.0 * root).sqrt();
    let plane: [[f64; 2]; 2] =
        std::array::from_fn(|i| std::array::from_fn(|j| (metric[i][j] + if i == j { root } else { 0.0 }) / trace));
    root.is_finite().then_some(CoarseDeformation { plane, ..CoarseDeformation::REST })
}

/// Distances of vertices in yarn radii, mean and largest, once both have the same mean.
fn distance(tile: &YarnTile, found: &TileEquilibrium, stored: &[[f64; 3]]) -> (f64, f64) {
    let n = stored.len() as f64;
    let mean: [f64; 3] =
        std::array::from_fn(|i| found.displacement.iter().zip(stored).map(|(a, b)| a[i] - b[i]).sum::<f64>() / n);
    let far = found
        .displacement
        .iter()
        .zip(stored)
        .map(|(a, b)| (0..3).map(|i| (a[i] - b[i] - mean[i]).powi(2)).sum::<f64>().sqrt() / tile.radius());
    far.fold((0.0, 0.0f64), |(sum, most), d| (sum + d / n, most.max(d)))
}

/// A strain, mean and largest distance, and whether the equilibrium was reached.
type Row = ([f64; 3], f64, f64, bool);

fn compare(
    tile: &YarnTile,
    stored: &Stored,
    every: usize,
    (reading, contact): (ContactReading, f64),
) -> Result<Vec<Row>, Failure> {
    let material = RodMaterial { reading, ..RodMaterial::solid_rod(tile.radius(), YOUNG, contact) };
    let counts = stored.axes.each_ref().map(Vec::len);
    // No strain is always among them.
    let middle = stored.axes.each_ref().map(|axis| axis.iter().position(|s| *s == 0.0).unwrap_or(0));
    let places: Vec<[usize; 3]> = (0..stored.strains())
        .map(|s| [s % counts[0], s / counts[0] % counts[1], s / counts[0] / counts[1]])
        .filter(|place| (0..3).all(|axis| place[axis] % every == middle[axis] % every))
        .collect();
    let rows: Result<Vec<Option<Row>>, Failure> = places
        .par_iter()
        .map(|&place| {
            let strain = [0, 1, 2].map(|axis| stored.axes[axis][place[axis]]);
            let Some(deformation) = deformation(strain) else { return Ok(None) };
            let displacement = stored.displacement(place, tile.vertex_count());
            let mut solver = TileSolver::new(tile, &material, EquilibriumSettings::default())?;
            solver.place(&deformation, &displacement)?;
            let found = solver.solve(&deformation)?;
            let (mean, most) = distance(tile, &found, &displacement);
            Ok(Some((strain, mean, most, found.converged)))
        })
        .collect();
    Ok(rows?.into_iter().flatten().collect())
}

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let near = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/yarn-tiles-madypg");
    let folder = arguments.next().map_or(near, PathBuf::from);
    let every = arguments.next().map_or(Ok(1), |text| text.parse())?;
    if !folder.is_dir() {
        println!("{} is not there: nothing to compare with", folder.display());
        return Ok(());
    }
    for (pattern, model) in MODELS {
        let tile = read_pattern(pattern, &std::fs::read_to_string(folder.join(pattern))?)?;
        let stored = Stored::read(&folder.join(model))?;
        for contact in CONTACTS {
            let rows = compare(&tile, &stored, every, contact)?;
            let reached = rows.iter().filter(|row| row.3).count();
            println!("{model}, {contact:?}: {} strains, {reached} equilibria reached", rows.len());
            let summary = |name: &str, chosen: &dyn Fn(&[f64; 3]) -> bool| {
                let some: Vec<&Row> = rows.iter().filter(|row| row.3 && chosen(&row.0)).collect();
                let mean = some.iter().map(|row| row.1).sum::<f64>() / some.len().max(1) as f64;
                let most = some.iter().map(|row| row.2).fold(0.0, f64::max);
                let mut middle: Vec<f64> = some.iter().map(|row| row.1).collect();
                middle.sort_by(f64::total_cmp);
                let median = middle.get(middle.len() / 2).copied().unwrap_or(f64::NAN);
                println!(
                    "  {name:<28} {:>5}   mean {mean:.3} R, median {median:.3} R, largest {most:.3} R",
                    some.len()
                );
            };
            summary("all", &|_| true);
            summary("no strain", &|s| s.iter().all(|s| *s == 0.0));
            summary("stretched, not sheared", &|s| s[1] == 0.0 && s[0] >= 0.0 && s[2] >= 0.0);
            summary("compressed, not sheared", &|s| s[1] == 0.0 && (s[0] < 0.0 || s[2] < 0.0));
            summary("sheared", &|s| s[1] != 0.0);
        }
    }
    Ok(())
}
