//! Scenes and runs opened for a command.

use std::ops::Range;
use std::path::{Path, PathBuf};

use wale::geometry::{Curve, CurveSettings, Solid, curves, solid_at};
use wale::model::{Frame, Network};
use wale::record::{RecordError, RunReader};
use wale::scene::{ErrorClass, Scene, SceneError, SceneFile, is_bare, read_bare};
use wale::simulation::{Simulation, Start};

use crate::arguments::{FrameChoice, Preset};
use crate::estimate::Estimate;
use crate::exit::{Code, Failure};
use crate::machine;

/// A scene that has been read and found sound.
pub struct OpenedScene {
    /// The scene.
    pub scene: Scene,
    /// The files it was read from.
    pub inputs: Vec<PathBuf>,
    /// The yarn that was assumed for a chart or a draft without a scene.
    pub assumed: Option<Preset>,
}

impl OpenedScene {
    /// Reads a scene file.
    ///
    /// # Errors
    /// What is wrong with it, with the place underlined.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        if is_bare(path) {
            return Err(Failure::new(
                Code::BadInput,
                format_args!(
                    "{}: a chart or a draft is no scene: name it as the file of one (`wale new`); \
                     `check` and `inspect` take it as it is",
                    path.display()
                ),
            ));
        }
        let SceneFile { scene, inputs } = Scene::read_with_inputs(path).map_err(scene_failure)?;
        Ok(Self { scene, inputs, assumed: None })
    }

    /// Reads a scene file, or a chart or a draft without a scene, of a yarn that can be chosen.
    ///
    /// # Errors
    /// What is wrong with it, with the place underlined; a yarn that is chosen for a scene.
    pub fn read_with_yarn(path: &Path, yarn: Option<Preset>) -> Result<Self, Failure> {
        if is_bare(path) {
            let yarn = yarn.unwrap_or(Preset::WorstedWool);
            let SceneFile { scene, inputs } = read_bare(path, yarn.into()).map_err(scene_failure)?;
            return Ok(Self { scene, inputs, assumed: Some(yarn) });
        }
        no_yarn(path, yarn)?;
        Self::read(path)
    }

    /// Rows and columns of the chart.
    #[must_use]
    pub fn chart_size(&self) -> [u64; 2] {
        self.scene.structure.size().map(|n| n as u64)
    }

    /// The scene with every default written out.
    ///
    /// # Errors
    /// Never for a scene that was read from a file.
    pub fn resolved(&self) -> Result<String, Failure> {
        self.scene.resolved_toml().map_err(scene_failure)
    }

    /// Refuses a scene that takes more memory than `limit`, or than is free.
    ///
    /// # Errors
    /// With the estimate and its largest item.
    pub fn check_memory(&self, limit: Option<u64>) -> Result<(), Failure> {
        self.estimate().check(limit.or_else(machine::available_memory))
    }

    /// What a run of it will take.
    #[must_use]
    pub fn estimate(&self) -> Estimate {
        Estimate::of(&self.scene)
    }

    /// The fabric as its chart lays it out, without compensation: quick.
    #[must_use]
    pub fn plain_network(&self) -> Network {
        plain_network(&self.scene)
    }

    /// The fabric that is counted and measured before a run: as the run begins, or as its chart lays it out where there is no scene, which
    /// alone asks for the shapes of relaxed loops.
    #[must_use]
    pub fn measured_network(&self) -> Network {
        if self.assumed.is_some() { self.plain_network() } else { self.start().network }
    }

    /// The fabric before it is placed, and what rest-shape compensation did to it.
    #[must_use]
    pub fn start(&self) -> Start {
        let Scene { structure, yarns, fabric, plan, .. } = &self.scene;
        let mut start = Start::new(structure, yarns, fabric, plan.simulation.rest_shape_compensation);
        self.scene.color_yarns(&mut start.network);
        start
    }

    /// Sets up the simulation.
    #[must_use]
    pub fn simulation(&self) -> Simulation {
        Simulation::new(self.start().network, &self.scene.yarns, &self.scene.fabric, self.scene.plan.clone())
    }

    /// Starts as many threads as the command line or else the scene asks for, and says how many there are.
    ///
    /// # Errors
    /// When they cannot be started.
    pub fn use_threads(&self, asked: Option<u16>) -> Result<usize, Failure> {
        machine::use_threads(asked.map(usize::from).or(self.scene.plan.simulation.threads))
    }
}

/// Refuses a yarn that is chosen for what has one.
///
/// # Errors
/// If one is.
pub fn no_yarn(path: &Path, yarn: Option<Preset>) -> Result<(), Failure> {
    match yarn {
        None => Ok(()),
        Some(_) => Err(Failure::new(
            Code::Usage,
            format_args!("{}: --yarn is for charts and drafts; a scene says its yarn itself", path.display()),
        )),
    }
}

/// The fabric of a scene as its chart lays it out, in its colour.
fn plain_network(scene: &Scene) -> Network {
    let mut network = scene.structure.network(&scene.fabric);
    scene.color_yarns(&mut network);
    network
}

/// An error in a scene, with the code of its class.
pub fn scene_failure(error: SceneError) -> Failure {
    let code = match error.class() {
        ErrorClass::BadInput => Code::BadInput,
        ErrorClass::ResourceLimit => Code::ResourceLimit,
        ErrorClass::InputOutput => Code::Io,
    };
    Failure::report(code, &miette::Report::new(error))
}

/// A run that has been opened to be shown, and the frames chosen of it.
pub struct OpenedRun {
    /// The run folder.
    pub reader: RunReader,
    /// Its scene.
    pub scene: Scene,
    /// Its fabric; arc lengths are those of the first frame, from which sliding counts.
    pub network: Network,
    /// The chosen frames.
    pub frames: Range<u64>,
}

impl OpenedRun {
    /// Opens a run folder.
    ///
    /// # Errors
    /// When it is none, or has not the frames that are asked for.
    pub fn open(folder: &Path, choice: FrameChoice) -> Result<Self, Failure> {
        let reader = RunReader::open(folder)?;
        let scene = Scene::read(&reader.scene_path()).map_err(scene_failure)?;
        // The scene of a folder is a file that may have been edited.
        Estimate::of(&scene).laid_out().check(machine::available_memory())?;
        let count = reader.frames().count()?;
        let frames = choice.among(count).ok_or_else(|| {
            Failure::new(Code::Usage, format_args!("{}: there are {count} frames, from 0 on", folder.display()))
        })?;
        let mut run = Self { network: plain_network(&scene), reader, scene, frames };
        run.network.arc_length = run.frame(0)?.sliding;
        Ok(run)
    }

    /// A frame, checked to be one of this fabric.
    ///
    /// # Errors
    /// When it is damaged or belongs to another fabric.
    pub fn frame(&self, index: u64) -> Result<Frame, RecordError> {
        let frame = self.reader.frames().read(index)?;
        let fits =
            frame.positions.len() == self.network.node_count() && frame.sliding.len() == self.network.pass_count();
        if fits {
            Ok(frame)
        } else {
            Err(RecordError::Damaged {
                path: self.reader.frames().path(index),
                reason: "it belongs to another fabric".to_owned(),
            })
        }
    }

    /// How the yarns are drawn.
    #[must_use]
    pub fn curve_settings(&self) -> CurveSettings {
        CurveSettings::of(&self.scene.yarns, &self.scene.fabric)
    }

    /// The yarns of a frame.
    #[must_use]
    pub fn curves(&self, frame: &Frame) -> Vec<Curve> {
        curves(&self.network, frame, &self.curve_settings())
    }

    /// The obstacles at the time of a frame.
    #[must_use]
    pub fn solids(&self, frame: &Frame) -> Vec<Solid> {
        self.scene.plan.obstacles.iter().map(|obstacle| solid_at(obstacle, frame.time)).collect()
    }

    /// Where a product of this run goes if nothing else is said: into its folder `results`.
    ///
    /// # Errors
    /// When that cannot be made.
    pub fn results(&self, out: Option<&PathBuf>, name: &str) -> Result<PathBuf, Failure> {
        let path = out.cloned().unwrap_or_else(|| self.reader.path().join("results").join(name));
        if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            std::fs::create_dir_all(folder).map_err(|error| Failure::io(folder, "create", error))?;
        }
        Ok(path)
    }
}
