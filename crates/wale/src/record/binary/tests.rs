//! Arrays as bytes, whole and damaged.

use proptest::prelude::*;

use super::*;

const MAGIC: [u8; 8] = *b"WALETEST";

fn parse(bytes: &[u8]) -> Result<BinaryReader<'_>, BinaryError> {
    BinaryReader::parse(bytes, "test", MAGIC, 1)
}

fn container(floats: &[f64], integers: &[u64], bytes: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    let writer = BinaryWriter::new(MAGIC, 1).floats("f", floats).integers("i", integers).bytes("b", bytes);
    writer.write_to(&mut out).unwrap();
    assert_eq!(writer.byte_count(), out.len() as u64);
    out
}

fn with_right_sum(mut bytes: Vec<u8>) -> Vec<u8> {
    let end = bytes.len() - CHECKSUM;
    let sum = crc32fast::hash(&bytes[..end]).to_le_bytes();
    bytes[end..].copy_from_slice(&sum);
    bytes
}

#[test]
fn a_forged_count_is_refused_before_allocating() {
    for count in [u64::MAX, 1 << 61, 1 << 40, 3] {
        let mut bytes = container(&[1.0, 2.0], &[], &[]);
        bytes[HEADER + NAME + 8..HEADER + NAME + 16].copy_from_slice(&count.to_le_bytes());
        assert_eq!(parse(&with_right_sum(bytes)).unwrap_err(), BinaryError::Table("a section longer than the file"));
    }
    let mut bytes = container(&[1.0], &[], &[]);
    bytes[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_eq!(parse(&with_right_sum(bytes)).unwrap_err(), BinaryError::Table("more sections than bytes"));
}

#[test]
fn other_files_and_versions_are_named() {
    let bytes = container(&[1.0], &[], &[]);
    assert_eq!(BinaryReader::parse(&bytes, "frame", *b"WALEFRAM", 1).unwrap_err(), BinaryError::Magic("frame".into()));
    assert_eq!(
        BinaryReader::parse(&bytes, "test", MAGIC, 2).unwrap_err(),
        BinaryError::Version { found: 1, expected: 2 }
    );
}

#[test]
fn a_section_of_another_kind_is_not_taken() {
    let bytes = container(&[1.0], &[7], &[]);
    let reader = parse(&bytes).unwrap();
    assert_eq!(reader.integers("f"), Err(BinaryError::Section("f".into())));
    assert_eq!(reader.integer_array::<1>("i"), Ok([7]));
    assert!(reader.integer_array::<2>("i").is_err());
    assert!(reader.bytes("absent").is_err());
}

proptest! {
    #[test]
    fn what_is_written_is_read_to_the_bit(
        floats in proptest::collection::vec(any::<u64>(), 0..2500),
        integers in proptest::collection::vec(any::<u64>(), 0..9),
        bytes in proptest::collection::vec(any::<u8>(), 0..99),
    ) {
        let values: Vec<f64> = floats.iter().map(|&bits| f64::from_bits(bits)).collect();
        let written = container(&values, &integers, &bytes);
        let reader = parse(&written).unwrap();
        let read: Vec<u64> = reader.floats("f").unwrap().iter().map(|v| v.to_bits()).collect();
        prop_assert_eq!(read, floats);
        prop_assert_eq!(reader.integers("i").unwrap(), integers);
        prop_assert_eq!(reader.bytes("b").unwrap(), &bytes[..]);
    }

    #[test]
    fn hostile_bytes_are_answered(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(parse(&bytes).is_err());
    }

    #[test]
    fn a_changed_byte_is_noticed(at in 0usize..1000, change in 1u8..=255) {
        let mut bytes = container(&[1.0, -2.5], &[3], b"text");
        let at = at % bytes.len();
        bytes[at] ^= change;
        prop_assert!(parse(&bytes).is_err());
    }

    #[test]
    fn a_cut_file_is_noticed(at in 0usize..1000) {
        let bytes = container(&[1.0, -2.5], &[3], b"text");
        let at = at % bytes.len();
        prop_assert!(parse(&bytes[..at]).is_err());
    }

    #[test]
    fn a_forged_header_with_a_right_sum_does_not_panic(
        at in 8usize..HEADER + 3 * ENTRY, bytes in any::<[u8; 8]>(),
    ) {
        let mut forged = container(&[1.0, -2.5], &[3], b"text");
        forged[at..at + 8].copy_from_slice(&bytes);
        if let Ok(reader) = parse(&with_right_sum(forged)) {
            let _ = (reader.floats("f"), reader.integers("i"), reader.bytes("b"));
        }
    }
}
