//! How long fabrics of 100,000 loops take to lay out, from what each is given as: every named pattern, written instructions of a shape, a
//! program of a machine, a draft.

use std::hint::black_box;
use std::time::Instant;

use serde::Serialize;
use wale::model::FabricCard;
use wale::pattern::instructions::read_instructions;
use wale::pattern::named::names;
use wale::pattern::{Program, Structure};
use wale::scene::Scene;

use super::swatch;
use crate::exit::{Code, Failure};

/// Loops, or crossings of a weave, that are laid out.
pub const LOOPS: u32 = 100_000;
/// Longest that so many may take \[s\].
pub const BAR: f64 = 2.0;
/// Of so many times the shortest counts: what else the machine does only lengthens them.
const TIMES: usize = 3;

/// A fabric that was laid out.
#[derive(Clone, Debug, Serialize)]
pub struct LaidOut {
    /// Its pattern, or what else it is.
    pub fabric: String,
    /// Loops, or crossings of a weave.
    pub loops: usize,
    /// Nodes.
    pub nodes: usize,
    /// Wall time to read what it is given as \[s\]; none of a pattern by name.
    pub read_s: Option<f64>,
    /// Wall time from stitches to the network \[s\].
    pub network_s: f64,
}

impl LaidOut {
    /// Wall time of both for [`LOOPS`] \[s\].
    pub fn for_loops(&self) -> f64 {
        (self.read_s.unwrap_or(0.0) + self.network_s) * f64::from(LOOPS) / self.loops as f64
    }
}

/// Lays out a fabric of every kind, of about so many loops.
///
/// # Errors
/// When one cannot be read, which would be a bug.
pub fn all(loops: u32) -> Result<Vec<LaidOut>, Failure> {
    let named = names().map(|pattern| named(pattern, loops)).collect::<Result<Vec<_>, _>>()?;
    let card = swatch::scene("stockinette", 4 * loops)?.fabric;
    let others = [
        read("instructions of a triangle", &triangle(loops), &card, |text| {
            let written = read_instructions(text, None).map_err(bug)?;
            Ok(Structure::Chart { chart: written.chart, working: written.working })
        })?,
        read("knitout of a rib", &program(loops), &card, |text| {
            Ok(Structure::Machine(Box::new(Program::new(text.to_owned()).map_err(bug)?)))
        })?,
        woven(loops)?,
    ];
    Ok(named.into_iter().chain(others).collect())
}

/// A square swatch of a named pattern.
///
/// # Errors
/// When there is no such pattern.
fn named(pattern: &str, loops: u32) -> Result<LaidOut, Failure> {
    let scene = swatch::scene(pattern, 4 * loops)?;
    Ok(laid_out(pattern, &scene.structure, &scene.fabric, None))
}

fn bug(error: impl std::fmt::Display) -> Failure {
    Failure::new(Code::Bug, error)
}

/// What a text becomes, read and laid out.
fn read(
    fabric: &str,
    text: &str,
    card: &FabricCard,
    reading: impl Fn(&str) -> Result<Structure, Failure>,
) -> Result<LaidOut, Failure> {
    let (read_s, structure) = shortest(|| reading(black_box(text)));
    Ok(laid_out(fabric, &structure?, card, Some(read_s)))
}

fn laid_out(fabric: &str, structure: &Structure, card: &FabricCard, read_s: Option<f64>) -> LaidOut {
    let (network_s, network) = shortest(|| structure.network(card));
    let (loops, nodes) = (network.loops.len(), network.node_count());
    LaidOut { fabric: fabric.to_owned(), loops, nodes, read_s, network_s }
}

/// The shortest wall time of a few runs \[s\], and what the last one made.
fn shortest<T>(mut run: impl FnMut() -> T) -> (f64, T) {
    let mut timed = || {
        let began = Instant::now();
        let made = black_box(run());
        (began.elapsed().as_secs_f64(), made)
    };
    let first = timed();
    (1..TIMES).fold(first, |(shortest, before), _| {
        drop(before);
        let (time, made) = timed();
        (time.min(shortest), made)
    })
}

/// Instructions of a triangle that grows by two stitches a row, beside eyelets and closed increases in turn, every row written out.
fn triangle(loops: u32) -> String {
    let mut text = String::from("Cast on 3 sts.\n");
    // Rows of 5, 7, 9 … stitches: n (n + 4) of them in n rows.
    let rows = f64::from(loops + 4).sqrt() as u32 - 2;
    for row in 1..=rows {
        let (more, inner) = if row % 2 == 1 { ("yo", "k") } else { ("m1", "p") };
        text += &format!("Row {row}: k1, {more}, {inner} to last st, {more}, k1.\n");
    }
    text
}

/// A program that knits a rib of one and one on both beds.
fn program(loops: u32) -> String {
    let side = f64::from(loops).sqrt().round() as u32;
    let mut text = String::from(";!knitout-2\n;;Carriers: 1 2 3\ninhook 1\n");
    for needle in (1..=side).rev() {
        text += &format!("tuck - {}{needle} 1\n", ["f", "b"][needle as usize % 2]);
    }
    for row in 0..side {
        for at in 1..=side {
            let (way, needle) = if row % 2 == 0 { ('+', at) } else { ('-', side + 1 - at) };
            text += &format!("knit {way} {}{needle} 1\n", ["f", "b"][needle as usize % 2]);
        }
        if row == 2 {
            text += "releasehook 1\n";
        }
    }
    text + "outhook 1\n"
}

/// A twill of as many crossings.
fn woven(crossings: u32) -> Result<LaidOut, Failure> {
    let side = (f64::from(crossings).sqrt() / 4.0).round() as u32 * 4;
    let text = format!(
        "schema = 1\n[yarn]\npreset = \"worsted-wool\"\n[fabric.weave]\npattern = \"twill 2/2\"\nends = {side}\npicks = {side}\n\
         end_spacing = \"3 mm\"\npick_spacing = \"3 mm\"\n"
    );
    let scene = Scene::from_text(&text, "bench").map_err(bug)?;
    Ok(laid_out("twill of 2/2", &scene.structure, &scene.fabric, None))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_fabric_is_laid_out() {
        let all = all(400).unwrap_or_else(|failure| panic!("{failure:?}"));
        assert!(all.len() > 40 + 3);
        for fabric in &all {
            // A pattern has whole repeats, of up to 34 by 40.
            assert!((200..2500).contains(&fabric.loops), "{fabric:?}");
            assert!(fabric.nodes > fabric.loops / 2 && fabric.network_s > 0.0, "{fabric:?}");
        }
        assert_eq!(all.iter().filter(|fabric| fabric.read_s.is_some()).count(), 2);
    }
}
