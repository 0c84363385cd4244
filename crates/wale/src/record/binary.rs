//! A small binary container: named sections of numbers behind a magic, a version, lengths and a checksum.
//!
//! ```text
//! magic [8 bytes] · version u32 · sections u32 · file length u64
//! per section: name [24 bytes, zero padded] · kind u32 · zero u32 · count u64
//! payloads one after the other, in that order
//! crc32 of all before, u32
//! ```
//! All numbers are little endian. A reader checks every declared length against the bytes at hand before it
//! allocates, and answers hostile bytes with a [`BinaryError`].

use std::io::{self, Write};

use thiserror::Error;

const HEADER: usize = 24;
const ENTRY: usize = 40;
const NAME: usize = 24;
const CHECKSUM: usize = 4;

/// What is wrong with a container.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum BinaryError {
    /// The first bytes are those of another kind of file.
    #[error("not a {0} file")]
    Magic(String),
    /// The file was written in another version of the format.
    #[error("format version {found}, this program reads {expected}")]
    Version {
        /// The file's version.
        found: u32,
        /// The version that is understood.
        expected: u32,
    },
    /// The file ends too early or goes on too long.
    #[error("{found} bytes long where {expected} were declared")]
    Length {
        /// Bytes at hand.
        found: u64,
        /// Bytes that are needed or declared.
        expected: u64,
    },
    /// The checksum disagrees with the bytes.
    #[error("the checksum does not match")]
    Checksum,
    /// The table of sections contradicts itself.
    #[error("the table of sections is not sound: {0}")]
    Table(&'static str),
    /// A section that is needed is absent or of another kind.
    #[error("no section `{0}` of the expected kind")]
    Section(String),
}

#[derive(Clone, Copy, Debug)]
enum Payload<'a> {
    Floats(&'a [f64]),
    Integers(&'a [u64]),
    Bytes(&'a [u8]),
}

impl Payload<'_> {
    fn kind(self) -> u32 {
        match self {
            Self::Floats(_) => 1,
            Self::Integers(_) => 2,
            Self::Bytes(_) => 3,
        }
    }
    fn count(self) -> usize {
        match self {
            Self::Floats(values) => values.len(),
            Self::Integers(values) => values.len(),
            Self::Bytes(values) => values.len(),
        }
    }
    fn byte_count(self) -> usize {
        match self {
            Self::Bytes(values) => values.len(),
            _ => self.count() * 8,
        }
    }
}

/// Collects borrowed sections and writes them as one container.
#[derive(Debug)]
pub struct BinaryWriter<'a> {
    magic: [u8; 8],
    version: u32,
    sections: Vec<(&'static str, Payload<'a>)>,
}

impl<'a> BinaryWriter<'a> {
    /// An empty container of a kind of file.
    #[must_use]
    pub fn new(magic: [u8; 8], version: u32) -> Self {
        Self { magic, version, sections: Vec::new() }
    }
    /// Adds a section of floats, kept to the bit.
    ///
    /// # Panics
    /// Here and in its siblings: if the name is longer than 24 bytes, which is a bug of the caller.
    #[must_use]
    pub fn floats(self, name: &'static str, values: &'a [f64]) -> Self {
        self.section(name, Payload::Floats(values))
    }
    /// Adds a section of integers.
    #[must_use]
    pub fn integers(self, name: &'static str, values: &'a [u64]) -> Self {
        self.section(name, Payload::Integers(values))
    }
    /// Adds a section of bytes.
    #[must_use]
    pub fn bytes(self, name: &'static str, values: &'a [u8]) -> Self {
        self.section(name, Payload::Bytes(values))
    }

    fn section(mut self, name: &'static str, payload: Payload<'a>) -> Self {
        assert!(name.len() <= NAME, "section name `{name}` is too long");
        self.sections.push((name, payload));
        self
    }

    /// Length of the container \[bytes\].
    #[must_use]
    pub fn byte_count(&self) -> u64 {
        let payload: usize = self.sections.iter().map(|(_, p)| p.byte_count()).sum();
        (HEADER + ENTRY * self.sections.len() + payload + CHECKSUM) as u64
    }

    /// Writes the container.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_to(&self, out: &mut dyn Write) -> io::Result<()> {
        let mut out = Summed { out, sum: crc32fast::Hasher::new() };
        out.put(&self.magic)?;
        out.put(&self.version.to_le_bytes())?;
        let sections = u32::try_from(self.sections.len()).map_err(io::Error::other)?;
        out.put(&sections.to_le_bytes())?;
        out.put(&self.byte_count().to_le_bytes())?;
        for (name, payload) in &self.sections {
            let mut padded = [0; NAME];
            padded[..name.len()].copy_from_slice(name.as_bytes());
            out.put(&padded)?;
            out.put(&payload.kind().to_le_bytes())?;
            out.put(&[0; 4])?;
            out.put(&(payload.count() as u64).to_le_bytes())?;
        }
        for (_, payload) in &self.sections {
            match payload {
                Payload::Floats(values) => out.put_words(values, |value| value.to_le_bytes())?,
                Payload::Integers(values) => out.put_words(values, |value| value.to_le_bytes())?,
                Payload::Bytes(values) => out.put(values)?,
            }
        }
        let Summed { out, sum } = out;
        out.write_all(&sum.finalize().to_le_bytes())
    }
}

struct Summed<'w> {
    out: &'w mut dyn Write,
    sum: crc32fast::Hasher,
}

impl Summed<'_> {
    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.sum.update(bytes);
        self.out.write_all(bytes)
    }
    fn put_words<T: Copy>(&mut self, values: &[T], bytes: impl Fn(T) -> [u8; 8]) -> io::Result<()> {
        // In pieces, so that a large state is not copied whole.
        let mut piece = Vec::with_capacity(8 * 1024);
        for chunk in values.chunks(1024) {
            piece.clear();
            piece.extend(chunk.iter().flat_map(|&value| bytes(value)));
            self.put(&piece)?;
        }
        Ok(())
    }
}

/// A container that has passed all checks, over borrowed bytes.
#[derive(Debug)]
pub struct BinaryReader<'a> {
    sections: Vec<(&'a [u8], u32, &'a [u8])>,
}

impl<'a> BinaryReader<'a> {
    /// Checks the container and finds its sections; allocates only the table.
    ///
    /// `what` names the kind of file in errors.
    ///
    /// # Errors
    /// A [`BinaryError`] for anything but a whole, unchanged container of this magic and version.
    pub fn parse(bytes: &'a [u8], what: &str, magic: [u8; 8], version: u32) -> Result<Self, BinaryError> {
        let length = bytes.len() as u64;
        if bytes.get(..8).is_none_or(|first| first != magic) {
            return Err(BinaryError::Magic(what.to_owned()));
        }
        if bytes.len() < HEADER + CHECKSUM {
            return Err(BinaryError::Length { found: length, expected: (HEADER + CHECKSUM) as u64 });
        }
        // The version is told before the checksum is asked: another version may sum otherwise.
        let found = word32(&bytes[8..]);
        if found != version {
            return Err(BinaryError::Version { found, expected: version });
        }
        let declared = word64(&bytes[16..]);
        if declared != length {
            return Err(BinaryError::Length { found: length, expected: declared });
        }
        let (body, sum) = bytes.split_at(bytes.len() - CHECKSUM);
        if crc32fast::hash(body) != word32(sum) {
            return Err(BinaryError::Checksum);
        }
        // From here on only a wrong writer or a forger can fail, and must still not hurt.
        let section_count = word32(&bytes[12..]) as usize;
        let rest = &body[HEADER..];
        let table_length = section_count
            .checked_mul(ENTRY)
            .filter(|&table| table <= rest.len())
            .ok_or(BinaryError::Table("more sections than bytes"))?;
        let (table, mut payloads) = rest.split_at(table_length);
        let mut sections = Vec::with_capacity(section_count);
        for entry in table.chunks_exact(ENTRY) {
            let name = &entry[..NAME];
            let name = &name[..name.iter().position(|&b| b == 0).unwrap_or(NAME)];
            let kind = word32(&entry[NAME..]);
            let width = match kind {
                1 | 2 => 8,
                3 => 1,
                _ => return Err(BinaryError::Table("a section of unknown kind")),
            };
            let byte_count = usize::try_from(word64(&entry[NAME + 8..]))
                .ok()
                .and_then(|count| count.checked_mul(width))
                .filter(|&count| count <= payloads.len())
                .ok_or(BinaryError::Table("a section longer than the file"))?;
            let (payload, after) = payloads.split_at(byte_count);
            payloads = after;
            sections.push((name, kind, payload));
        }
        if payloads.is_empty() {
            Ok(Self { sections })
        } else {
            Err(BinaryError::Table("bytes that belong to no section"))
        }
    }

    /// The floats of a section, to the bit.
    ///
    /// # Errors
    /// [`BinaryError::Section`], as in its siblings.
    pub fn floats(&self, name: &str) -> Result<Vec<f64>, BinaryError> {
        Ok(words(self.payload(name, 1)?).map(f64::from_bits).collect())
    }
    /// The integers of a section.
    ///
    /// # Errors
    /// [`BinaryError::Section`].
    pub fn integers(&self, name: &str) -> Result<Vec<u64>, BinaryError> {
        Ok(words(self.payload(name, 2)?).collect())
    }
    /// Exactly so many integers of a section.
    ///
    /// # Errors
    /// [`BinaryError::Section`], also for another count.
    pub fn integer_array<const N: usize>(&self, name: &str) -> Result<[u64; N], BinaryError> {
        self.integers(name)?.try_into().map_err(|_| BinaryError::Section(name.to_owned()))
    }
    /// Exactly so many floats of a section.
    ///
    /// # Errors
    /// [`BinaryError::Section`], also for another count.
    pub fn float_array<const N: usize>(&self, name: &str) -> Result<[f64; N], BinaryError> {
        self.floats(name)?.try_into().map_err(|_| BinaryError::Section(name.to_owned()))
    }
    /// The bytes of a section.
    ///
    /// # Errors
    /// [`BinaryError::Section`].
    pub fn bytes(&self, name: &str) -> Result<&'a [u8], BinaryError> {
        self.payload(name, 3)
    }

    fn payload(&self, name: &str, kind: u32) -> Result<&'a [u8], BinaryError> {
        self.sections
            .iter()
            .find(|section| section.0 == name.as_bytes() && section.1 == kind)
            .map(|section| section.2)
            .ok_or_else(|| BinaryError::Section(name.to_owned()))
    }
}

fn words(bytes: &[u8]) -> impl Iterator<Item = u64> {
    bytes.chunks_exact(8).map(word64)
}

fn word32(bytes: &[u8]) -> u32 {
    u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])
}

fn word64(bytes: &[u8]) -> u64 {
    u64::from(word32(bytes)) | u64::from(word32(&bytes[4..])) << 32
}

#[cfg(test)]
mod tests;
