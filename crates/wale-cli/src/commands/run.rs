//! `wale run`: a scene into a run folder.

use std::path::{Path, PathBuf};

use wale::record::{Checkpoints, Environment, Frames, RunFolder, RunStart};

use crate::arguments::Run;
use crate::exit::Failure;
use crate::opened::OpenedScene;
use crate::run_loop::RunLoop;
use crate::signals::Signals;
use crate::{observe, output};

/// Runs it.
pub fn run(arguments: &Run) -> Result<(), Failure> {
    let mut scene = OpenedScene::read(&arguments.scene)?;
    if let Some(duration) = arguments.duration {
        scene.scene.plan.simulation.duration = duration;
    }
    scene.check_memory(arguments.limits.max_memory)?;
    let threads = scene.use_threads(arguments.manner.threads)?;
    let signals = Signals::listen().map_err(|error| Failure::io(&arguments.scene, "listen to signals", error))?;
    let out = arguments.out.clone().unwrap_or_else(|| default_folder(&arguments.scene));
    let mut simulation = scene.simulation();
    let columns = observe::columns(&simulation.standing());
    let mut environment = Environment::here(threads);
    environment.seeds.insert("layout".to_owned(), scene.scene.plan.simulation.seed);
    let network = simulation.network();
    let run = RunFolder::create(
        &out,
        &RunStart {
            scene: &scene.resolved()?,
            inputs: &scene.inputs,
            environment: &environment,
            columns: &columns,
            frame_bytes: Frames::byte_count(network.node_count(), network.pass_count()),
            checkpoint_bytes: Checkpoints::byte_count(simulation.state()),
        },
        arguments.force,
    )?;
    if !arguments.manner.quiet {
        output::note(&format!(
            "{}: {} nodes on {threads} threads, into {}",
            arguments.scene.display(),
            output::grouped(network.node_count() as u64),
            out.display()
        ));
        for (line, what) in scene.scene.structure.remarks() {
            output::note(&format!("  line {line:<4} {what}"));
        }
    }
    let (yarns, card) = (scene.scene.yarns, scene.scene.fabric);
    RunLoop { simulation, run, yarns, card, signals, quiet: arguments.manner.quiet }.go()
}

/// `scenes/swatch.toml` runs into `swatch.run` where the program was called.
fn default_folder(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().unwrap_or(scene.as_os_str());
    PathBuf::from(format!("{}.run", stem.to_string_lossy()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_folder_is_named_after_the_scene() {
        assert_eq!(default_folder(Path::new("scenes/swatch.toml")), Path::new("swatch.run"));
        assert_eq!(default_folder(Path::new("a.b")), Path::new("a.run"));
        assert_eq!(default_folder(Path::new("a.b.toml")), Path::new("a.b.run"));
    }
}
