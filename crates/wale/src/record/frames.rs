//! Frames: one file each, with positions and sliding coordinates to the bit.
//!
//! `frames/frame_00000.wale`. Both are kept in double precision: 24 bytes a node and 8 a pass, so that whatever is
//! measured from a frame is what would have been measured in the run.

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::atomic_file::{sync_folder, write_atomically};
use super::binary::{BinaryError, BinaryReader, BinaryWriter};
use super::error::{RecordError, reading};
use super::read_file;
use crate::model::Frame;

const MAGIC: [u8; 8] = *b"WALEFRAM";
const VERSION: u32 = 1;

/// The folder of a run's frames.
#[derive(Clone, Debug)]
pub struct Frames {
    folder: PathBuf,
}

impl Frames {
    /// The frames in a folder (which need not exist yet).
    #[must_use]
    pub fn new(folder: PathBuf) -> Self {
        Self { folder }
    }

    /// The file of a frame.
    #[must_use]
    pub fn path(&self, index: u64) -> PathBuf {
        self.folder.join(format!("frame_{index:05}.wale"))
    }

    /// Length of a frame's file \[bytes\].
    #[must_use]
    pub fn byte_count(node_count: usize, pass_count: usize) -> u64 {
        // Header, three entries of the table and the checksum: 24 + 3·40 + 8 + 4.
        156 + 24 * node_count as u64 + 8 * pass_count as u64
    }

    /// Writes a frame.
    ///
    /// # Errors
    /// A full disk and other failures to write.
    pub fn write(&self, index: u64, frame: &Frame) -> Result<(), RecordError> {
        let positions: Vec<f64> = frame.positions.iter().flat_map(DVec3::to_array).collect();
        let time = [frame.time];
        let writer = BinaryWriter::new(MAGIC, VERSION)
            .floats("time", &time)
            .floats("positions", &positions)
            .floats("sliding", &frame.sliding);
        write_atomically(&self.path(index), |out| writer.write_to(out))
    }

    /// Reads a frame.
    ///
    /// # Errors
    /// [`RecordError::Missing`], [`RecordError::Damaged`], [`RecordError::OtherVersion`].
    pub fn read(&self, index: u64) -> Result<Frame, RecordError> {
        read(&self.path(index))
    }

    /// Reads a range of frames, one after the other.
    pub fn read_range(&self, range: Range<u64>) -> impl Iterator<Item = Result<Frame, RecordError>> + '_ {
        range.map(|index| self.read(index))
    }

    /// How many frames there are, from the first without a gap.
    ///
    /// # Errors
    /// When the folder cannot be read.
    pub fn count(&self) -> Result<u64, RecordError> {
        let indices = self.indices()?;
        let gap = indices.iter().zip(0..).position(|(&index, k)| index != k);
        Ok(gap.unwrap_or(indices.len()) as u64)
    }

    /// Removes the frames from `first` on.
    ///
    /// # Errors
    /// When one cannot be removed.
    pub fn remove_from(&self, first: u64) -> Result<(), RecordError> {
        // The last first: killed midway, there is still no gap.
        for index in self.indices()?.into_iter().rev() {
            if index >= first {
                let path = self.path(index);
                fs::remove_file(&path).map_err(|error| RecordError::from_io(&path, "remove", error))?;
            }
        }
        sync_folder(&self.folder).map_err(|error| RecordError::from_io(&self.folder, "sync", error))
    }

    fn indices(&self) -> Result<Vec<u64>, RecordError> {
        let mut indices = Vec::new();
        for entry in fs::read_dir(&self.folder).map_err(|error| reading(&self.folder, error))? {
            let entry = entry.map_err(|error| reading(&self.folder, error))?;
            let name = entry.file_name();
            let index = name
                .to_str()
                .and_then(|name| name.strip_prefix("frame_")?.strip_suffix(".wale"))
                .and_then(|digits| digits.parse().ok());
            // Only names that this program gives: `path` must lead back to the file.
            indices.extend(index.filter(|&index| self.path(index) == entry.path()));
        }
        indices.sort_unstable();
        Ok(indices)
    }
}

/// Reads one frame's file.
///
/// # Errors
/// [`RecordError::Missing`], [`RecordError::Damaged`], [`RecordError::OtherVersion`].
pub fn read(path: &Path) -> Result<Frame, RecordError> {
    parse(&read_file(path)?).map_err(|error| match error {
        BinaryError::Version { found, expected } => RecordError::OtherVersion {
            path: path.to_path_buf(),
            found: format!("frame format {found}"),
            expected: format!("frame format {expected}"),
        },
        error => RecordError::Damaged { path: path.to_path_buf(), reason: error.to_string() },
    })
}

/// Reads a frame from bytes; no bytes make it panic.
///
/// # Errors
/// What is wrong with them.
pub fn parse(bytes: &[u8]) -> Result<Frame, BinaryError> {
    let reader = BinaryReader::parse(bytes, "wale frame", MAGIC, VERSION)?;
    let [time] = reader.float_array("time")?;
    let positions = reader.floats("positions")?;
    let sliding = reader.floats("sliding")?;
    if !positions.len().is_multiple_of(3) {
        return Err(BinaryError::Table("positions that are no triples"));
    }
    if !positions.iter().chain(&sliding).all(|v| v.is_finite()) || !time.is_finite() {
        return Err(BinaryError::Table("numbers that are not finite"));
    }
    Ok(Frame { time, positions: positions.chunks_exact(3).map(DVec3::from_slice).collect(), sliding })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(index: u64) -> Frame {
        let time = index as f64 / 30.0;
        Frame {
            time,
            positions: vec![DVec3::new(0.1 + time, -2e-9, 1.0 / 3.0), DVec3::ONE],
            sliding: vec![time / 7.0, 0.2, 0.3],
        }
    }

    #[test]
    fn frames_come_back_to_the_bit_and_in_ranges() {
        let folder = tempfile::tempdir().unwrap();
        let frames = Frames::new(folder.path().to_path_buf());
        for index in 0..12 {
            frames.write(index, &frame(index)).unwrap();
        }
        assert_eq!(frames.count().unwrap(), 12);
        let some: Vec<Frame> = frames.read_range(3..6).map(Result::unwrap).collect();
        assert_eq!(some, [frame(3), frame(4), frame(5)]);
        let length = fs::metadata(frames.path(3)).unwrap().len();
        assert_eq!(length, Frames::byte_count(2, 3));

        frames.remove_from(5).unwrap();
        assert_eq!(frames.count().unwrap(), 5);
        assert!(matches!(frames.read(5), Err(RecordError::Missing { .. })));
        frames.write(100_000, &frame(7)).unwrap();
        assert_eq!(frames.count().unwrap(), 5, "a gap ends the count");
        assert_eq!(frames.read(100_000).unwrap(), frame(7));
    }

    #[test]
    fn foreign_names_are_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let frames = Frames::new(folder.path().to_path_buf());
        for name in ["frame_0.wale", "frame_00000.png", "frame_+0001.wale", "notes"] {
            fs::write(folder.path().join(name), "x").unwrap();
        }
        assert_eq!(frames.count().unwrap(), 0);
        frames.remove_from(0).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 4);
    }

    #[test]
    fn a_cut_frame_is_damaged() {
        let folder = tempfile::tempdir().unwrap();
        let frames = Frames::new(folder.path().to_path_buf());
        frames.write(0, &frame(0)).unwrap();
        let whole = fs::read(frames.path(0)).unwrap();
        for length in (0..whole.len()).step_by(7) {
            fs::write(frames.path(0), &whole[..length]).unwrap();
            assert!(matches!(frames.read(0), Err(RecordError::Damaged { .. })));
        }
    }

    proptest::proptest! {
        #[test]
        fn hostile_bytes_never_panic(bytes in proptest::collection::vec(proptest::num::u8::ANY, 0..400)) {
            let mut hostile = MAGIC.to_vec();
            hostile.extend(VERSION.to_le_bytes());
            hostile.extend(bytes);
            proptest::prop_assert!(parse(&hostile).is_err());
        }
    }
}
