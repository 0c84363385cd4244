//! The plan of a run: settings, obstacles and grips as plain SI numbers, whatever file they came from.

use glam::{DQuat, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Motion, Selection};

/// Everything that happens to a fabric, beside what it is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Where the fabric lies at first.
    pub placement: Placement,
    /// Time, forces from outside, and the solver's settings.
    pub simulation: Simulation,
    /// Rigid things that the fabric touches.
    pub obstacles: Vec<Obstacle>,
    /// What holds or pulls the fabric.
    pub grips: Vec<Grip>,
    /// What is written.
    pub output: Output,
}

/// Where the fabric lies at first: the middle of the initial layout's bounding box goes to `center`.
///
/// The layout has x along the course, y along the wale and z to the front; `rotation` turns it into the world, whose
/// z is up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// World position of the middle of the fabric \[m\].
    pub center: DVec3,
    /// World from layout, a unit quaternion.
    pub rotation: DQuat,
}

impl Default for Placement {
    /// Lying, front up, its middle at the origin.
    fn default() -> Self {
        Self { center: DVec3::ZERO, rotation: DQuat::IDENTITY }
    }
}

/// Time, forces from outside, and the solver's settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulation {
    /// Simulated time of the run \[s\], not negative.
    pub duration: f64,
    /// Frames written per simulated second \[1/s\], positive.
    pub frame_rate: f64,
    /// Acceleration of gravity \[m/s²\].
    pub gravity: DVec3,
    /// Drag of still air: force per length of yarn and speed \[N·s/m² = Pa·s\], not negative.
    pub air_drag: f64,
    /// Whether the fabric is relaxed without friction, gravity, obstacles and grips before time starts, and the
    /// friction anchors set anew there.
    pub relax_first: bool,
    /// Whether a small patch is relaxed first and its loop shapes become the rest shapes of the whole fabric
    /// [Cirio2017, section 4.1].
    pub rest_shape_compensation: bool,
    /// Whether yarns rub on each other while they slide.
    pub friction: bool,
    /// Whether parts of the fabric that are not knitted together keep out of each other.
    pub self_contact: bool,
    /// Whether strands of a knit that share no contact keep out of each other, be they neighbours or not.
    pub strand_contact: bool,
    /// Time in which yarn comes to its full stretch stiffness \[s\], so that a stretched layout does not snap; zero for at once.
    pub soft_start: f64,
    /// Seed of the small disturbance of the initial layout; the same seed gives the same run.
    pub seed: u64,
    /// Longest time step \[s\].
    pub largest_step: f64,
    /// Shortest time step \[s\]; a run that needs a shorter one has not converged.
    pub smallest_step: f64,
    /// Most Newton iterations of a time step.
    pub newton_iterations: u32,
    /// Newton stops when nodes are expected to move no further than this, root mean square, as a fraction of the yarn
    /// radius \[–\].
    pub newton_tolerance: f64,
    /// Which linear solver.
    pub linear_solver: LinearSolver,
    /// Relative preconditioned residual at which conjugate gradients stop \[–\].
    pub linear_tolerance: f64,
    /// Threads; `None` takes all processors. Results do not depend on it.
    pub threads: Option<usize>,
}

/// Which linear solver works inside Newton's method.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LinearSolver {
    /// The one that is the faster for the fabric's size.
    #[default]
    Automatic,
    /// Sparse Cholesky factors, symbolic part kept.
    Cholesky,
    /// Preconditioned conjugate gradients on the block-sparse matrix.
    ConjugateGradient,
}

/// A rigid thing that yarns cannot enter.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// Name for reports.
    pub name: String,
    /// Its shape at its initial place.
    pub shape: Shape,
    /// How it moves; world from initial place.
    pub motion: Motion,
    /// Coefficient of friction between it and yarn \[–\], not negative.
    pub friction_coefficient: f64,
}

/// A rigid shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Half of space; solid on the side that `normal` points away from.
    Plane {
        /// A point of the surface \[m\].
        point: DVec3,
        /// Outward unit normal.
        normal: DVec3,
    },
    /// A ball.
    Sphere {
        /// Centre \[m\].
        center: DVec3,
        /// Radius \[m\], positive.
        radius: f64,
    },
    /// All points within `radius` of the line from `a` to `b`.
    Capsule {
        /// One end of the core line \[m\].
        a: DVec3,
        /// The other end \[m\].
        b: DVec3,
        /// Radius \[m\], positive.
        radius: f64,
    },
    /// A box.
    Block {
        /// Centre \[m\].
        center: DVec3,
        /// Half of the edge lengths \[m\], positive.
        half_size: DVec3,
        /// World from box axes, a unit quaternion.
        rotation: DQuat,
    },
}

/// Something that holds nodes of the fabric for a while.
#[derive(Clone, Debug, PartialEq)]
pub struct Grip {
    /// Name for reports and metrics.
    pub name: String,
    /// What it holds.
    pub nodes: Selection,
    /// Which of the world's axes x, y, z it holds; along the others the nodes are free. All three for a motion that
    /// turns.
    pub axes: [bool; 3],
    /// What it does with them.
    pub drive: Drive,
    /// When it takes hold \[s\].
    pub from: f64,
    /// When it lets go \[s\]; never if `None`.
    pub until: Option<f64>,
}

impl Grip {
    /// Whether the grip holds at a time \[s\].
    #[must_use]
    pub fn holds(&self, time: f64) -> bool {
        time >= self.from && self.until.is_none_or(|until| time < until)
    }
}

/// What a grip does with its nodes.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// Carries each node by the motion's pose, applied to where the node was when the grip took hold; key times are
    /// simulated time, and the first key, at `from` or later, is the pose of rest.
    Follow(Motion),
    /// Pulls with a force, shared equally by the nodes and rising linearly from zero.
    Force {
        /// Full force on all nodes together \[N\].
        force: DVec3,
        /// Time from `from` to the full force \[s\], not negative.
        ramp: f64,
    },
}

/// What a run writes.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Whether pictures of the frames are drawn: the last one only, or a sequence.
    pub pictures: Pictures,
    /// Whether a page to turn in the hand is written.
    pub view: bool,
    /// Formats that frames are exported to at the end of the run.
    pub exports: Vec<ExportFormat>,
    /// Simulated time between checkpoints \[s\], positive.
    pub checkpoint_every: f64,
}

/// Which frames are drawn.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Pictures {
    /// None.
    None,
    /// The last frame.
    #[default]
    Last,
    /// Every frame.
    All,
}

/// A format that other programs read.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ExportFormat {
    /// USD BasisCurves with time samples (`.usda`).
    Usd,
    /// VTK polydata, a file a frame, and their ParaView collection (`.vtp`, `.pvd`).
    Vtk,
    /// Binary curve collection (`.bcc`).
    Bcc,
    /// Tubes as Wavefront OBJ.
    Obj,
    /// Tubes as PLY.
    Ply,
    /// Metrics as comma-separated values.
    Csv,
}
