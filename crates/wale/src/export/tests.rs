//! Tests across formats: what is written holds what was given, and impossible things are refused.

use std::fs;
use std::path::Path;

use glam::DVec3;

use super::*;
use crate::geometry::sample_fabric::plain_weave;
use crate::geometry::{Curve, CurveSettings};
use crate::model::{Frame, Network};

/// A weave that lifts at one corner, frame by frame.
fn lifted(network: &Network, time: f64) -> Frame {
    Frame {
        time,
        positions: network.position.iter().map(|x| *x + DVec3::Z * (x.x * x.y * 40.0 * time)).collect(),
        sliding: network.arc_length.clone(),
    }
}

fn run(frames: usize) -> Vec<Snapshot> {
    let network = plain_weave(5, 4, 2e-3);
    (0..frames)
        .map(|k| {
            let frame = lifted(&network, k as f64 / 24.0);
            Snapshot::of(&network, &frame, &CurveSettings::new(0.4e-3))
        })
        .collect()
}

fn point_count(snapshot: &Snapshot) -> usize {
    snapshot.curves.iter().map(|c| c.points.len()).sum()
}

fn written(write: impl FnOnce(&mut Vec<u8>) -> Result<(), ExportError>) -> Vec<u8> {
    let mut out = Vec::new();
    write(&mut out).expect("it is written");
    out
}

#[test]
fn usda_has_every_point_of_every_frame_and_true_stage_units() {
    let mut snapshots = run(3);
    let n = point_count(&snapshots[0]);
    let bytes = written(|out| write_usda(out, &mut snapshots, &Settings::default()));
    let text = String::from_utf8(bytes).unwrap();
    for line in [
        "    metersPerUnit = 1",
        "    upAxis = \"Z\"",
        "    timeCodesPerSecond = 24",
        "    startTimeCode = 0",
        "    endTimeCode = 2",
        "    defaultPrim = \"Fabric\"",
        "        float[] widths = [0.0008] (",
    ] {
        assert!(text.lines().any(|l| l == line), "{line}");
    }
    let samples: Vec<&str> = text
        .split("point3f[] points.timeSamples = {")
        .nth(1)
        .and_then(|rest| rest.split('}').next())
        .map(|block| block.lines().filter(|l| l.contains('[')).collect())
        .unwrap();
    assert_eq!(samples.len(), 3);
    for (line, time) in samples.iter().zip([0, 1, 2]) {
        assert!(line.trim_start().starts_with(&format!("{time}: [(")));
        assert_eq!(line.matches('(').count(), n);
    }
    let last = snapshots[2].curves.last().unwrap().points.last().unwrap();
    let end = format!("({:?}, {:?}, {:?})],", last.x as f32, last.y as f32, last.z as f32);
    assert!(samples[2].ends_with(&end), "{end}");
}

#[test]
fn usda_refuses_frames_that_do_not_belong_together() {
    let write = |mut snapshots: Vec<Snapshot>| write_usda(&mut Vec::new(), &mut snapshots, &Settings::default());
    let mut other = run(2);
    other[1].curves.pop();
    assert!(matches!(write(other), Err(ExportError::Changed { index: 1 })));
    let mut backwards = run(3);
    backwards.swap(0, 1);
    assert!(matches!(write(backwards), Err(ExportError::Order { index: 1 })));
    assert!(matches!(write(vec![]), Err(ExportError::NoFrames)));
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let settings = Settings { frames_per_second: rate, ..Settings::default() };
        assert!(write_usda(&mut Vec::new(), &mut run(1), &settings).is_err());
    }
}

#[test]
fn vtp_offsets_meet_the_arrays_they_name() {
    let snapshot = run(1).remove(0);
    let bytes = written(|out| write_vtp(out, &snapshot, &Settings::default()));
    let mark = bytes.windows(2).position(|w| w == b"\n_").unwrap() + 2;
    let xml = String::from_utf8(bytes[..mark].to_vec()).unwrap();
    let n = point_count(&snapshot);
    assert!(xml.contains(&format!("NumberOfPoints=\"{n}\"")));
    assert!(xml.contains("NumberOfLines=\"9\""));
    let mut names = Vec::new();
    let mut end = mark;
    for line in xml.lines().filter(|l| l.contains("format=\"appended\"")) {
        let value = |key: &str| line.split(&format!("{key}=\"")).nth(1).unwrap().split('"').next();
        let at = mark + value("offset").unwrap().parse::<usize>().unwrap();
        assert_eq!(at, end, "arrays lie one after the other");
        let length = u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize;
        let name = value("Name").unwrap();
        let expected = match name {
            "Points" => 12 * n,
            "connectivity" => 8 * n,
            "offsets" => 8 * 9,
            "yarn" => 4 * 9,
            "color" => 3 * 9,
            _ => 4 * n,
        };
        assert_eq!(length, expected, "{name}");
        names.push(name.to_owned());
        end = at + 8 + length;
    }
    assert!(bytes[end..].starts_with(b"\n  </AppendedData>"));
    assert!(names.iter().any(|n| n == "stretch"));
}

#[test]
fn bcc_reads_back_as_written() {
    let mut snapshot = run(1).remove(0);
    let ring: Vec<DVec3> = [0.0, 1.0, 2.0, 0.0].map(|t: f64| DVec3::new(t.cos(), t.sin(), 0.0)).to_vec();
    snapshot.curves.push(Curve {
        arc_length: vec![0.0; 4],
        pass: vec![0; 4],
        points: ring,
        radius: 1e-3,
        color: [0; 3],
    });
    let settings = Settings {
        title: "seed stitch, metres, and a text that is far too long".into(),
        up: UpAxis::Y,
        ..Settings::default()
    };
    let bytes = written(|out| write_bcc(out, &snapshot, &settings));
    assert_eq!(&bytes[..8], b"BCC\x44C0\x03\x01");
    let file = read_bcc(&mut bytes.as_slice()).unwrap();
    assert_eq!(file.up, UpAxis::Y);
    assert!(settings.title.starts_with(&file.info) && file.info.len() == 40);
    assert_eq!(file.curves.len(), 10);
    for (read, curve) in file.curves.iter().zip(&snapshot.curves) {
        let closed = curve.points.first() == curve.points.last();
        assert_eq!(read.closed, closed);
        assert_eq!(read.points.len(), curve.points.len() - usize::from(closed));
        for (a, b) in read.points.iter().zip(&curve.points) {
            assert_eq!(*a, settings.up.turn(*b).as_vec3());
        }
    }
}

#[test]
fn bcc_reader_refuses_lies_without_believing_their_size() {
    let snapshot = run(1).remove(0);
    let good = written(|out| write_bcc(out, &snapshot, &Settings::default()));
    let with = |at: usize, bytes: &[u8]| {
        let mut file = good.clone();
        file[at..at + bytes.len()].copy_from_slice(bytes);
        file
    };
    let lies = [
        with(0, b"BCD"),
        with(3, &[0x48]),
        with(4, b"C1"),
        with(6, &[2]),
        with(7, &[3]),
        with(8, &u64::MAX.to_le_bytes()),
        with(16, &u64::MAX.to_le_bytes()),
        with(16, &0u64.to_le_bytes()),
        with(64, &i32::MIN.to_le_bytes()),
        with(64, &i32::MAX.to_le_bytes()),
        with(68, &f32::NAN.to_le_bytes()),
    ];
    for (k, lie) in lies.iter().enumerate() {
        let read = read_bcc(&mut lie.as_slice());
        assert!(matches!(read, Err(ExportError::Malformed { .. })), "lie {k}");
    }
    for cut in 0..good.len() {
        assert!(read_bcc(&mut &good[..cut]).is_err(), "cut at {cut}");
    }
}

#[test]
fn obj_and_ply_hold_the_same_closed_tubes() {
    let snapshot = run(1).remove(0);
    let settings = Settings { sides: 5, plies: 2, twist: 300.0, ..Settings::default() };
    let obj = String::from_utf8(written(|out| write_obj(out, &snapshot, &settings))).unwrap();
    let count = |start: &str| obj.lines().filter(|l| l.starts_with(start)).count();
    let (vertices, faces) = (count("v "), count("f "));
    assert_eq!(count("vn "), vertices);
    assert_eq!(count("o "), 9);
    let largest = obj
        .lines()
        .filter_map(|l| l.strip_prefix("f "))
        .flat_map(|l| l.split([' ', '/']))
        .filter_map(|i| i.parse::<usize>().ok())
        .max();
    assert_eq!(largest, Some(vertices));

    let ply = written(|out| write_ply(out, &snapshot, &settings));
    let end = ply.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let header = String::from_utf8(ply[..end].to_vec()).unwrap();
    assert!(header.contains(&format!("element vertex {vertices}\n")));
    assert!(header.contains(&format!("element face {faces}\n")));
    // Six floats, three bytes, yarn, arc length and stretch; a count and three indices.
    assert_eq!(ply.len() - end, vertices * (24 + 3 + 4 + 4 + 4) + faces * 13);
    // Closed tubes that face outwards have positive volume.
    let at = |i: usize| {
        let b = &ply[end + i * 39..];
        let x = |k: usize| f64::from(f32::from_le_bytes(b[k..k + 4].try_into().unwrap()));
        DVec3::new(x(0), x(4), x(8))
    };
    let volume: f64 = (0..faces)
        .map(|f| {
            let b = &ply[end + vertices * 39 + f * 13 + 1..];
            let i = |k: usize| u32::from_le_bytes(b[k..k + 4].try_into().unwrap()) as usize;
            at(i(0)).dot(at(i(4)).cross(at(i(8)))) / 6.0
        })
        .sum();
    // Two plies of half the radius; a pentagon fills 0.757 of its circle. Yarns are longer than straight ones.
    let length = 4.0 * 10e-3 + 5.0 * 8e-3;
    let expected = length * 2.0 * std::f64::consts::PI * 0.2e-3f64.powi(2) * 0.757;
    assert!(volume > expected && volume < 1.5 * expected, "{volume} {expected}");
}

#[test]
fn the_door_names_files_and_links_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let settings = Settings::default();
    for format in Format::ALL {
        let single = path("one").with_extension(format.extension());
        let files = write(&single, format, &mut run(1), &settings).unwrap();
        assert_eq!(files.last().unwrap(), &single);
        let several = path("two").with_extension(format.extension());
        let files = write(&several, format, &mut run(2), &settings).unwrap();
        assert!(files.iter().all(|f| f.is_file()), "{files:?}");
    }
    let collection = fs::read_to_string(path("two.pvd")).unwrap();
    assert!(collection.contains("timestep=\"0.0\""));
    assert!(collection.contains("file=\"two.0001.vtp\""));
    assert!(path("two.0001.obj").is_file());
    let left: Vec<_> = fs::read_dir(folder.path())
        .unwrap()
        .filter(|f| f.as_ref().is_ok_and(|f| f.path().extension().is_some_and(|e| e == "part")))
        .collect();
    assert!(left.is_empty());
}

#[test]
fn formats_are_known_by_their_extension() {
    for format in Format::ALL {
        let name = format!("run.v2.{}", format.extension().to_uppercase());
        assert_eq!(Format::of_path(Path::new(&name)), Ok(format));
    }
    let error = Format::of_path(Path::new("a.fbx")).unwrap_err();
    assert_eq!(error.to_string(), "`fbx` is no export format; there are usda, vtp, pvd, bcc, obj, ply");
    assert!(Format::of_path(Path::new("usda")).is_err());
}

#[test]
fn numbers_that_are_none_are_refused_by_every_format() {
    let folder = tempfile::tempdir().unwrap();
    for spoil in [
        |s: &mut Snapshot| s.curves[3].points[2].y = f64::NAN,
        |s: &mut Snapshot| s.curves[3].points[2].y = 1e300,
        |s: &mut Snapshot| s.curves[0].arc_length[1] = f64::INFINITY,
        |s: &mut Snapshot| s.curves[0].radius = 0.0,
        |s: &mut Snapshot| s.fields[0].values[1] = f64::NAN,
        |s: &mut Snapshot| s.fields[0].values.truncate(1),
        |s: &mut Snapshot| s.time = f64::NAN,
        |s: &mut Snapshot| s.curves[0].pass.truncate(1),
    ] {
        for format in Format::ALL {
            let mut snapshots = run(2);
            spoil(&mut snapshots[1]);
            let path = folder.path().join("a").with_extension(format.extension());
            assert!(write(&path, format, &mut snapshots, &Settings::default()).is_err());
            assert!(!path.exists());
        }
    }
}

#[test]
fn a_stream_that_fails_is_an_error() {
    struct Full;
    impl std::io::Write for Full {
        fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
            Err(std::io::ErrorKind::StorageFull.into())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let mut snapshots = run(1);
    let settings = Settings::default();
    let usda = write_usda(&mut Full, &mut snapshots, &settings);
    assert!(matches!(usda, Err(ExportError::Stream(_))));
    let results = [
        write_vtp(&mut Full, &snapshots[0], &settings),
        write_bcc(&mut Full, &snapshots[0], &settings),
        write_obj(&mut Full, &snapshots[0], &settings),
        write_ply(&mut Full, &snapshots[0], &settings),
    ];
    assert!(results.iter().all(|result| matches!(result, Err(ExportError::Stream(_)))));
}

#[test]
fn frames_of_another_fabric_are_refused() {
    let network = plain_weave(3, 3, 1e-3);
    let mut frames = FrameSnapshots {
        network: &network,
        settings: CurveSettings::new(1e-4),
        count: 1,
        read: |_| Ok(Frame::default()),
    };
    let result = write_usda(&mut Vec::new(), &mut frames, &Settings::default());
    assert!(matches!(result, Err(ExportError::Frame { index: 0, .. })));
}
