//! What every reader owes to any bytes: an answer, or an error with a place inside the text. Called by the tests of the corpus
//! and by the fuzz targets.
#![allow(dead_code, reason = "a fuzz target asks one reader")]

use wale::model::FabricCard;
use wale::pattern::image::read_pixels;
use wale::pattern::instructions::{LARGEST_TEXT, read_instructions, write_instructions};
use wale::pattern::knit;
use wale::pattern::knitout::read_knitout;
use wale::pattern::symbols::{default_legend, read_symbols, write_symbols};
use wale::pattern::weave::{Woven, read_draft, read_wif};
use wale::pattern::{Chart, Structure};
use wale::record::{checkpoint, frames};
use wale::scene::Scene;

/// Loops and crossings up to which a fabric is laid out, too: what was read must also be possible.
const SMALL: usize = 2000;

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Whether a piece of a text can be underlined.
fn is_inside(text: &str, span: &std::ops::Range<usize>) -> bool {
    text.get(span.clone()).is_some()
}

fn line_exists(text: &str, line: usize) -> bool {
    (1..=text.split('\n').count()).contains(&line)
}

/// A message is a sentence or two, whatever stands in the file.
fn is_short(message: &str) {
    assert!(!message.is_empty() && message.len() < 4000, "{} bytes: {message:.200}", message.len());
}

/// Whether it was read, as of all readers here.
pub fn scene(bytes: &[u8]) -> bool {
    let text = text(bytes);
    match Scene::from_text(&text, "scene.toml") {
        Ok(scene) => {
            let [rows, columns] = scene.structure.size();
            if rows.saturating_mul(columns) <= SMALL {
                assert!(lays_out(&scene.structure, &scene.fabric));
                let resolved = scene.resolved_toml().unwrap_or_else(|error| panic!("{error}"));
                let again =
                    Scene::from_text(&resolved, "resolved").unwrap_or_else(|error| panic!("{error}\n{resolved}"));
                assert_eq!(again, scene, "what is resolved is the same scene");
            }
            true
        }
        Err(error) => {
            is_short(error.what());
            if let Some((line, _)) = error.line_and_column() {
                assert!(line_exists(&text, line));
            }
            let _ = (error.underlined(), error.to_string());
            false
        }
    }
}

/// Whether a network of finite places comes out.
fn lays_out(structure: &Structure, card: &FabricCard) -> bool {
    let network = structure.network(card);
    network.position.iter().all(|x| x.is_finite()) && network.arc_length.iter().all(|arc| arc.is_finite())
}

fn knit_card() -> FabricCard {
    let text = "schema = 1\n[fabric.chart]\npattern = \"garter\"\ncolumns = 2\nrows = 2\n";
    Scene::from_text(text, "card").unwrap().fabric
}

fn chart_lays_out(chart: &Chart, structure: &Structure) {
    let loops: usize = chart.rows().iter().map(Vec::len).sum();
    if loops <= SMALL {
        assert!(lays_out(structure, &knit_card()));
    }
}

pub fn instructions(bytes: &[u8]) -> bool {
    let text = text(bytes);
    match read_instructions(&text, Some(8)) {
        Ok(read) => {
            chart_lays_out(&read.chart, &Structure::Chart { chart: read.chart.clone(), working: read.working });
            let loops: usize = read.chart.rows().iter().map(Vec::len).sum();
            if loops <= SMALL {
                let written = write_instructions(&read.chart, read.working);
                assert!(written.len() <= LARGEST_TEXT);
            }
            true
        }
        Err(error) => {
            assert!(is_inside(&text, &error.span), "{error}");
            is_short(&error.to_string());
            false
        }
    }
}

pub fn symbols(bytes: &[u8]) -> bool {
    let text = text(bytes);
    let lines: Vec<&str> = text.lines().collect();
    let owned: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
    match read_draft(&owned) {
        Ok(draft) => assert_eq!(read_draft(&draft.lines()).as_ref(), Ok(&draft)),
        Err(error) => is_short(&error.to_string()),
    }
    match read_symbols(&lines, &default_legend()) {
        Ok(chart) => {
            chart_lays_out(&chart, &Structure::flat(chart.clone()));
            let again = read_symbols(&write_symbols(&chart), &default_legend());
            assert_eq!(again.as_ref(), Ok(&chart), "what is written is read");
            true
        }
        Err(error) => {
            if let Some(bytes) = &error.bytes {
                assert!(is_inside(lines[error.line], bytes), "{error}");
            }
            is_short(&error.to_string());
            false
        }
    }
}

pub fn knitout(bytes: &[u8]) -> bool {
    let text = text(bytes);
    match read_knitout(&text) {
        Ok(knitted) => {
            assert!(knitted.remarks.iter().all(|remark| line_exists(&text, remark.line)));
            let [rows, columns] = knitted.graph.size.map(|n| n as usize);
            if knitted.graph.loops.len().max(rows.saturating_mul(columns)) <= SMALL
                && let FabricCard::Knit(card) = knit_card()
            {
                let network = knit::network(&knitted.graph, &card);
                assert!(network.position.iter().all(|x| x.is_finite()));
            }
            true
        }
        Err(error) => {
            assert!(line_exists(&text, error.line) && is_inside(&text, &error.span), "{error}");
            is_short(&error.to_string());
            false
        }
    }
}

pub fn wif(bytes: &[u8]) -> bool {
    match read_wif(bytes) {
        Ok(wif) => {
            let text = text(bytes);
            assert!(wif.remarks.iter().all(|remark| line_exists(&text, remark.line)));
            let draft = wif.draft;
            if draft.ends().saturating_mul(draft.picks()) <= SMALL {
                let network = Woven::new(draft.clone(), [1e-3; 2]).network([1e-3; 2]);
                assert!(network.position.iter().all(|x| x.is_finite()));
                let (ends, picks) = (draft.ends(), draft.picks());
                assert_eq!(draft.smallest_repeat().repeat(ends, picks).as_ref(), Ok(&draft));
            }
            true
        }
        Err(error) => {
            let text = text(bytes);
            assert!(line_exists(&text, error.line) && is_inside(&text, &error.span), "{error}");
            is_short(&error.to_string());
            false
        }
    }
}

pub fn image(bytes: &[u8]) -> bool {
    // Checksums keep everything else from being seen.
    let mut read = false;
    for bytes in [bytes.to_vec(), png_with_its_checksums(bytes)] {
        match read_pixels(&bytes) {
            Ok(pixels) => {
                assert_eq!(pixels.colors.len(), pixels.width * pixels.height);
                read = true;
            }
            Err(error) => is_short(&error.to_string()),
        }
    }
    read
}

pub fn saved(bytes: &[u8]) -> bool {
    let mut read = false;
    for bytes in [bytes.to_vec(), container_with_its_checksum(bytes)] {
        match checkpoint::parse(&bytes) {
            Ok(found) => {
                let state = found.state;
                assert!(state.coordinates.iter().chain(&state.velocities).all(|x| x.is_finite()));
                assert_eq!(state.coordinates.len(), state.velocities.len());
                read = true;
            }
            Err(error) => is_short(&error.to_string()),
        }
        match frames::parse(&bytes) {
            Ok(frame) => {
                assert!(frame.positions.iter().all(|x| x.is_finite()));
                read = true;
            }
            Err(error) => is_short(&error.to_string()),
        }
    }
    read
}

/// The bytes of a PNG with the checksum of every chunk made right.
fn png_with_its_checksums(bytes: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let mut at = 8;
    while let Some(length) = bytes.get(at..at + 4) {
        let length = u32::from_be_bytes([length[0], length[1], length[2], length[3]]) as usize;
        let Some(chunk) = bytes.get(at + 4..at + 8 + length) else { break };
        let sum = crc32(chunk);
        let Some(place) = bytes.get_mut(at + 8 + length..at + 12 + length) else { break };
        place.copy_from_slice(&sum.to_be_bytes());
        at += 12 + length;
    }
    bytes
}

/// The bytes of a checkpoint or a frame with its length and its checksum made right.
fn container_with_its_checksum(bytes: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    if bytes.len() < 28 {
        return bytes;
    }
    let length = bytes.len() as u64;
    bytes[16..24].copy_from_slice(&length.to_le_bytes());
    let body = bytes.len() - 4;
    let sum = crc32(&bytes[..body]);
    bytes[body..].copy_from_slice(&sum.to_le_bytes());
    bytes
}

fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| (sum >> 1) ^ if sum & 1 == 1 { 0xedb8_8320 } else { 0 })
    })
}
