//! Checkpoints: the whole state of a run, two generations of it, and a pointer that is written last.
//!
//! `checkpoints/step_00000120.ckpt` holds a [`State`] to the bit, the hash of the scene that it belongs to, and how
//! long the other files of the run were; `checkpoints/LATEST` names the newest. Whatever moment a process is killed
//! at, the latest or the one before it can be read.

use std::fs;
use std::path::{Path, PathBuf};

use super::atomic_file::{sync_folder, write_atomically, write_bytes_atomically};
use super::binary::{BinaryError, BinaryReader, BinaryWriter};
use super::error::{RecordError, reading};
use super::read_file;
use crate::dynamics::State;

const MAGIC: [u8; 8] = *b"WALECKPT";
const VERSION: u32 = 1;
const LATEST: &str = "LATEST";
/// How many checkpoints are kept.
const GENERATIONS: usize = 2;
/// Slots of a node's block in the coordinates.
const BLOCK: usize = 5;

/// SHA-256 of a resolved scene.
pub type SceneHash = [u8; 32];

/// How far the other files of a run had come when a checkpoint was taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Marks {
    /// Frames written.
    pub frames: u64,
    /// Length of the metrics table \[bytes\].
    pub metrics: u64,
    /// Length of the step log \[bytes\].
    pub log: u64,
}

/// What a checkpoint holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// The state.
    pub state: State,
    /// The scene that it is a state of.
    pub scene: SceneHash,
    /// How far the other files had come.
    pub marks: Marks,
}

/// A checkpoint that could be read, and what was found on the way to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The checkpoint.
    pub checkpoint: Checkpoint,
    /// Its file.
    pub path: PathBuf,
    /// Newer checkpoints that had to be passed over, one sentence each.
    pub passed_over: Vec<String>,
}

/// The folder of a run's checkpoints.
#[derive(Clone, Debug)]
pub struct Checkpoints {
    folder: PathBuf,
}

impl Checkpoints {
    /// The checkpoints in a folder (which need not exist yet).
    #[must_use]
    pub fn new(folder: PathBuf) -> Self {
        Self { folder }
    }

    /// Length of the checkpoint of a state \[bytes\].
    #[must_use]
    pub fn byte_count(state: &State) -> u64 {
        with_writer(state, &[0; 32], Marks::default(), |writer| writer.byte_count())
    }

    /// About the length of a checkpoint of a fabric of so many nodes and passes \[bytes\].
    #[must_use]
    pub fn byte_count_of(node_count: usize, pass_count: usize) -> u64 {
        // Coordinates and velocities of a block each, an anchor a pass.
        (2 * BLOCK * node_count + pass_count) as u64 * 8
    }

    /// Saves a state, points `LATEST` to it, and drops all but two generations.
    ///
    /// # Errors
    /// A full disk and other failures to write; the older checkpoints are then still there.
    pub fn save(&self, state: &State, scene: &SceneHash, marks: Marks) -> Result<PathBuf, RecordError> {
        let name = format!("step_{:08}.ckpt", state.step);
        let path = self.folder.join(&name);
        with_writer(state, scene, marks, |writer| write_atomically(&path, |out| writer.write_to(out)))?;
        write_bytes_atomically(&self.folder.join(LATEST), format!("{name}\n").as_bytes())?;
        let mut others = self.list()?;
        others.retain(|(step, _)| *step != state.step);
        for (_, old) in others.iter().skip(GENERATIONS - 1) {
            fs::remove_file(old).map_err(|error| RecordError::from_io(old, "remove", error))?;
        }
        Ok(path)
    }

    /// Reads the newest checkpoint that is whole and that `fits` the rest of the run; older ones stand in for
    /// damaged ones, and the answer says so.
    ///
    /// `scene` is the hash that it must carry; `None` takes any.
    ///
    /// # Errors
    /// [`RecordError::Damaged`] when none can be read, [`RecordError::OtherVersion`] and
    /// [`RecordError::OtherScene`] as soon as one is met.
    pub fn load(
        &self,
        scene: Option<&SceneHash>,
        fits: impl Fn(&Checkpoint) -> Result<(), String>,
    ) -> Result<Found, RecordError> {
        let mut candidates: Vec<PathBuf> = self.list()?.into_iter().map(|(_, path)| path).collect();
        // A checkpoint that is newer than the pointer was whole before the pointer could follow: order by step is
        // enough, and the pointer tells when the newest file itself has gone.
        let mut passed_over = Vec::new();
        if let Some(latest) = self.latest()
            && !candidates.contains(&latest)
        {
            passed_over.push(format!("{}: named by LATEST and gone", latest.display()));
        }
        for path in candidates.drain(..) {
            match read(&path).and_then(|checkpoint| {
                fits(&checkpoint).map_err(|reason| RecordError::Damaged { path: path.clone(), reason })?;
                Ok(checkpoint)
            }) {
                Ok(checkpoint) => {
                    if scene.is_some_and(|scene| *scene != checkpoint.scene) {
                        return Err(RecordError::OtherScene { path });
                    }
                    return Ok(Found { checkpoint, path, passed_over });
                }
                Err(error @ RecordError::Damaged { .. }) => passed_over.push(error.to_string()),
                Err(error) => return Err(error),
            }
        }
        Err(RecordError::Damaged {
            path: self.folder.clone(),
            reason: if passed_over.is_empty() {
                "holds no checkpoint: begin the run anew with --force".to_owned()
            } else {
                format!(
                    "holds no checkpoint that can be read ({}): begin the run anew with --force",
                    passed_over.join("; ")
                )
            },
        })
    }

    /// Whether no checkpoint was ever taken here.
    ///
    /// # Errors
    /// When the folder cannot be read.
    pub fn is_untouched(&self) -> Result<bool, RecordError> {
        Ok(self.list()?.is_empty() && !self.folder.join(LATEST).exists())
    }

    /// Removes checkpoints of later steps: damaged ones that were passed over.
    ///
    /// # Errors
    /// When one cannot be removed.
    pub fn remove_after(&self, step: u64) -> Result<(), RecordError> {
        for (later, path) in self.list()? {
            if later > step {
                fs::remove_file(&path).map_err(|error| RecordError::from_io(&path, "remove", error))?;
            }
        }
        sync_folder(&self.folder).map_err(|error| RecordError::from_io(&self.folder, "sync", error))
    }

    /// Steps and files, newest first.
    ///
    /// # Errors
    /// When the folder cannot be read.
    pub fn list(&self) -> Result<Vec<(u64, PathBuf)>, RecordError> {
        let mut list = Vec::new();
        for entry in fs::read_dir(&self.folder).map_err(|error| reading(&self.folder, error))? {
            let entry = entry.map_err(|error| reading(&self.folder, error))?;
            let name = entry.file_name();
            let step = name
                .to_str()
                .and_then(|name| name.strip_prefix("step_")?.strip_suffix(".ckpt"))
                .filter(|digits| digits.bytes().all(|b| b.is_ascii_digit()))
                .and_then(|digits| digits.parse().ok());
            if let Some(step) = step {
                list.push((step, entry.path()));
            }
        }
        list.sort_unstable_by(|a, b| b.cmp(a));
        Ok(list)
    }

    fn latest(&self) -> Option<PathBuf> {
        let name = fs::read_to_string(self.folder.join(LATEST)).ok()?;
        let name = name.trim();
        (name.starts_with("step_") && !name.contains(['/', '\\'])).then(|| self.folder.join(name))
    }
}

/// Reads one checkpoint.
///
/// # Errors
/// [`RecordError::Damaged`], [`RecordError::OtherVersion`], or that of the file system.
pub fn read(path: &Path) -> Result<Checkpoint, RecordError> {
    parse(&read_file(path)?).map_err(|error| match error {
        BinaryError::Version { found, expected } => RecordError::OtherVersion {
            path: path.to_path_buf(),
            found: format!("checkpoint format {found}"),
            expected: format!("checkpoint format {expected}"),
        },
        error => RecordError::Damaged { path: path.to_path_buf(), reason: error.to_string() },
    })
}

/// Reads a checkpoint from bytes; no bytes make it panic.
///
/// # Errors
/// What is wrong with them.
pub fn parse(bytes: &[u8]) -> Result<Checkpoint, BinaryError> {
    let reader = BinaryReader::parse(bytes, "wale checkpoint", MAGIC, VERSION)?;
    let [step, frames, metrics, log] = reader.integer_array("counters")?;
    let [time, next_step_size] = reader.float_array("clock")?;
    let state = State {
        time,
        step,
        next_step_size,
        coordinates: reader.floats("coordinates")?,
        velocities: reader.floats("velocities")?,
        anchors: reader.floats("anchors")?,
        obstacle_anchors: reader.floats("obstacle_anchors")?,
        grip_memory: reader.floats("grip_memory")?,
    };
    if state.coordinates.len() != state.velocities.len()
        || !state.coordinates.len().is_multiple_of(BLOCK)
        || !state.obstacle_anchors.len().is_multiple_of(5)
    {
        return Err(BinaryError::Table("lengths of the state's parts disagree"));
    }
    let finite = [&state.coordinates, &state.velocities, &state.anchors, &state.obstacle_anchors, &state.grip_memory]
        .into_iter()
        .flatten()
        .chain([&time, &next_step_size])
        .all(|value| value.is_finite());
    if !finite {
        return Err(BinaryError::Table("numbers that are not finite"));
    }
    let scene =
        reader.bytes("scene_sha256")?.try_into().map_err(|_| BinaryError::Section("scene_sha256".to_owned()))?;
    Ok(Checkpoint { state, scene, marks: Marks { frames, metrics, log } })
}

fn with_writer<T>(state: &State, scene: &SceneHash, marks: Marks, then: impl FnOnce(BinaryWriter<'_>) -> T) -> T {
    // Taken apart by name, so that a field added to the state cannot be forgotten here.
    let State { time, step, next_step_size, coordinates, velocities, anchors, obstacle_anchors, grip_memory } = state;
    let counters = [*step, marks.frames, marks.metrics, marks.log];
    let clock = [*time, *next_step_size];
    then(
        BinaryWriter::new(MAGIC, VERSION)
            .integers("counters", &counters)
            .floats("clock", &clock)
            .floats("coordinates", coordinates)
            .floats("velocities", velocities)
            .floats("anchors", anchors)
            .floats("obstacle_anchors", obstacle_anchors)
            .floats("grip_memory", grip_memory)
            .bytes("scene_sha256", scene),
    )
}

#[cfg(test)]
mod tests;
