//! Scenes of the gallery, run to their ends.

use std::path::Path;

use wale::measure::Shape;
use wale::model::Frame;
use wale::scene::Scene;
use wale::simulation::{Simulation, Start, StepReport};

/// A scene from its first to its last step.
pub struct Played {
    pub scene: Scene,
    pub start: Start,
    pub first: Shape,
    pub last: Shape,
    pub steps: Vec<StepReport>,
    /// Every frame that is due.
    pub frames: Vec<Frame>,
    pub simulation: Simulation,
    /// Speed of the nodes at the end, root mean square \[m/s\].
    pub speed: f64,
}

/// Runs a scene of the folder `scenes` on one processor, beside those of other tests: small fabrics gain little from several,
/// and move alike on any number.
pub fn play_beside_others(name: &str) -> Played {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| to_its_end(name))
}

fn to_its_end(name: &str) -> Played {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name);
    let scene = Scene::read(&path).unwrap();
    let compensate = scene.plan.simulation.rest_shape_compensation;
    let start = Start::new(&scene.structure, &scene.yarns, &scene.fabric, compensate);
    let mut simulation = Simulation::new(start.network.clone(), &scene.yarns, &scene.fabric, scene.plan.clone());
    let first = Shape::of(simulation.network(), &simulation.frame());
    let mut steps = Vec::new();
    let mut frames = vec![simulation.frame()];
    while !simulation.finished() {
        steps.push(simulation.step().unwrap());
        frames.extend(simulation.frame_due().map(|_| simulation.frame()));
    }
    let nodes = simulation.network().node_count();
    let velocities = &simulation.state().velocities[..5 * nodes];
    let squares: f64 = velocities.chunks_exact(5).map(|v| v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sum();
    Played {
        first,
        last: Shape::of(simulation.network(), &simulation.frame()),
        start,
        steps,
        frames,
        speed: (squares / nodes as f64).sqrt(),
        simulation,
        scene,
    }
}

impl Played {
    /// The last frame.
    pub fn frame(&self) -> Frame {
        self.simulation.frame()
    }
    /// The step that ends nearest to a time.
    pub fn step_at(&self, time: f64) -> &StepReport {
        let near = |step: &&StepReport| (step.time - time).abs();
        self.steps.iter().min_by(|a, b| near(a).total_cmp(&near(b))).unwrap()
    }
    /// Force of a grip along x at the step that ends nearest to a time.
    pub fn force_at(&self, grip: usize, time: f64) -> f64 {
        self.step_at(time).grips[grip].force.x
    }
}
