//! A swatch that falls on a sphere, and how fast it does.

use std::time::Instant;

use serde::Serialize;
use wale::model::LinearSolver;
use wale::pattern::named::named_pattern;
use wale::pattern::{Chart, Stitch};
use wale::scene::Scene;
use wale::simulation::{Simulation, Start};
use wale_numerics::block_matrix::BlockMatrix;

use crate::exit::{Code, Failure};

/// Step that speeds are measured at \[s\].
const STEP: f64 = 1e-3;
/// Longest step before the measurement \[s\].
const WARM_UP_STEP: f64 = 2e-3;
/// Simulated time before the measurement \[s\]: edges settle from the layout of the fabric's repeat, in free fall.
const WARM_UP: f64 = 0.06;
/// Height over the sphere \[m\]: it is met half way through the measurement.
const HEIGHT: f64 = 0.036;

/// What one swatch took.
#[derive(Clone, Debug, Serialize)]
pub struct Measured {
    /// Nodes.
    pub nodes: usize,
    /// Steps measured.
    pub steps: usize,
    /// Wall time to set it up \[s\].
    pub set_up_s: f64,
    /// Wall time a step \[s\].
    pub step_s: f64,
    /// Nodes times steps a second.
    pub node_steps_per_s: f64,
    /// Newton iterations a step.
    pub newton_iterations: f64,
    /// Iterations of the linear solver a step.
    pub linear_iterations: f64,
    /// Wall time for a frame of 1/30 s at the steps that the controller chooses \[s\].
    pub frame_s: f64,
    /// Bandwidth of the product of the block matrix and a vector \[bytes/s\].
    pub product_bytes_per_s: f64,
    /// Largest memory of the process so far \[bytes\], where the operating system says.
    pub peak_memory_bytes: Option<u64>,
}

/// Runs a square swatch of a pattern and about so many nodes for so many steps, half of them before it meets the sphere.
///
/// # Errors
/// When a step fails.
pub fn measure(pattern: &str, nodes: u32, steps: usize, solver: LinearSolver) -> Result<Measured, Failure> {
    let Falling { mut scene, mut simulation, set_up_s } = falling(pattern, nodes, solver)?;
    let node_count = simulation.network().node_count();
    let (mut newton, mut linear) = (0, 0);
    let began = Instant::now();
    for _ in 0..steps {
        let report = step(&mut simulation)?;
        newton += report.newton_iterations;
        linear += report.linear_iterations;
    }
    let step_s = began.elapsed().as_secs_f64() / steps as f64;
    scene.plan.simulation.largest_step = 5.0 * STEP;
    scene.plan.simulation.frame_rate = 30.0;
    simulation = going_on(&scene, simulation);
    let frame_s = frame(&mut simulation)?;
    // The product has a matrix of its own.
    let peak_memory_bytes = peak_memory();
    Ok(Measured {
        nodes: node_count,
        steps,
        set_up_s,
        step_s,
        node_steps_per_s: node_count as f64 / step_s,
        newton_iterations: newton as f64 / steps as f64,
        linear_iterations: linear as f64 / steps as f64,
        frame_s,
        product_bytes_per_s: product(&simulation),
        peak_memory_bytes,
    })
}

/// A swatch in free fall whose edges have settled.
pub struct Falling {
    scene: Scene,
    simulation: Simulation,
    set_up_s: f64,
}

/// Lets a swatch fall until its edges have settled, and a step of those that are measured.
///
/// # Errors
/// When there is no such pattern, or a step fails.
pub fn falling(pattern: &str, nodes: u32, solver: LinearSolver) -> Result<Falling, Failure> {
    let mut scene = scene(pattern, nodes)?;
    scene.plan.simulation.linear_solver = solver;
    scene.plan.simulation.largest_step = WARM_UP_STEP;
    let began = Instant::now();
    let mut simulation = simulation(&scene);
    let set_up_s = began.elapsed().as_secs_f64();
    while simulation.state().time < WARM_UP {
        step(&mut simulation)?;
    }
    scene.plan.simulation.largest_step = STEP;
    simulation = going_on(&scene, simulation);
    step(&mut simulation)?;
    Ok(Falling { scene, simulation, set_up_s })
}

impl Falling {
    /// Nodes.
    pub fn nodes(&self) -> usize {
        self.simulation.network().node_count()
    }

    /// Loops that stitches made.
    pub fn loops(&self) -> usize {
        self.simulation.network().loops.len()
    }

    /// The stitches that are worked: all, and those of them that are no knits and no purls.
    pub fn stitches(&self) -> [usize; 2] {
        let rows = self.scene.structure.chart().map_or(&[][..], Chart::rows);
        let all = rows.iter().map(Vec::len).sum();
        let plain = |stitch: &&Stitch| matches!(stitch, Stitch::Knit | Stitch::Purl);
        [all, all - rows.iter().flatten().filter(plain).count()]
    }

    /// Wall time of the next step \[s\], its Newton iterations, and those of the linear solver.
    ///
    /// # Errors
    /// When it fails.
    pub fn timed_step(&mut self) -> Result<(f64, [usize; 2]), Failure> {
        let began = Instant::now();
        let report = step(&mut self.simulation)?;
        Ok((began.elapsed().as_secs_f64(), [report.newton_iterations, report.linear_iterations]))
    }
}

/// A simulation with another plan that goes on where one stands; never two at a time.
fn going_on(scene: &Scene, before: Simulation) -> Simulation {
    let state = before.state().clone();
    drop(before);
    let mut after = simulation(scene);
    assert!(after.restore(state), "the same fabric has the same sizes");
    after
}

/// Wall time of 1/30 s at free steps, from one frame to the next.
fn frame(simulation: &mut Simulation) -> Result<f64, Failure> {
    let mut next = || -> Result<(), Failure> {
        step(simulation)?;
        while simulation.frame_due().is_none() {
            step(simulation)?;
        }
        Ok(())
    };
    next()?;
    let began = Instant::now();
    next()?;
    Ok(began.elapsed().as_secs_f64())
}

/// The scene: about as many rows as columns, four nodes a loop, over a sphere half as wide as itself.
///
/// # Errors
/// When there is no such pattern.
pub(super) fn scene(pattern: &str, nodes: u32) -> Result<Scene, Failure> {
    let side = (f64::from(nodes) / 4.0).sqrt().round().max(4.0);
    let width = side * 5e-3;
    let repeat = named_pattern(pattern).map_err(|error| Failure::new(Code::Usage, error))?;
    let whole = |of: usize| (side / of as f64).round().max(1.0) * of as f64;
    let (columns, rows) = (whole(repeat.cast_on()), whole(repeat.row_count()));
    let text = format!(
        "schema = 1\n[yarn]\npreset = \"worsted-wool\"\n[fabric]\ncenter = [0, 0, {center}]\n\
         [fabric.chart]\npattern = \"{pattern}\"\ncolumns = {columns}\nrows = {rows}\n\
         [simulation]\nduration = 100\nrelax_first = false\n\
         [[obstacle]]\nsphere = {{ center = [0, 0, 0], radius = {radius} }}\n",
        radius = 0.25 * width,
        center = 0.25 * width + HEIGHT,
    );
    Scene::from_text(&text, "bench").map_err(|error| Failure::new(Code::Bug, error))
}

fn simulation(scene: &Scene) -> Simulation {
    let start = Start::new(&scene.structure, &scene.yarns, &scene.fabric, true);
    Simulation::new(start.network, &scene.yarns, &scene.fabric, scene.plan.clone())
}

fn step(simulation: &mut Simulation) -> Result<wale::simulation::StepReport, Failure> {
    simulation.step().map_err(|error| Failure::new(Code::NotConverged, error))
}

fn product(simulation: &Simulation) -> f64 {
    const REPEATS: usize = 20;
    let mut matrix: BlockMatrix<f32> = BlockMatrix::zeros(simulation.system().pattern().clone());
    // Memory that was never written is not read from memory either.
    matrix.values.fill(1.0);
    let x = vec![1.0; matrix.dimension()];
    let mut rounded = vec![[0.0; 8]; matrix.rows()];
    let mut out = vec![0.0; matrix.dimension()];
    let bytes = size_of_val(&matrix.values[..])
        + size_of_val(matrix.pattern().columns())
        + size_of_val(&x[..])
        + size_of_val(&out[..]);
    let mut best = f64::INFINITY;
    for repeat in 0..=REPEATS {
        let began = Instant::now();
        matrix.multiply_rounded(std::hint::black_box(&x), &mut rounded, &mut out);
        std::hint::black_box(&mut out);
        if repeat > 0 {
            best = best.min(began.elapsed().as_secs_f64());
        }
    }
    bytes as f64 / best
}

fn peak_memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}
