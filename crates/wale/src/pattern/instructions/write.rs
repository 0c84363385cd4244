//! A chart written out as row instructions.

use std::fmt::Write;

use crate::pattern::chart::{Chart, Side, Stitch, Working};

/// Row instructions that give a chart again, a line a row.
#[must_use]
pub fn write_instructions(chart: &Chart, working: Working) -> String {
    let mut text = format!("Cast on {}\n", chart.column_count());
    for (index, row) in chart.rows().iter().enumerate() {
        let side = working.side(index);
        let worked: Vec<Stitch> = match side {
            Side::RightSide => row.iter().rev().copied().collect(),
            Side::WrongSide => row.iter().map(|stitch| stitch.from_behind()).collect(),
        };
        let head = match (working, side) {
            (Working::Round, _) => format!("Rnd {}", index + 1),
            (_, Side::RightSide) => format!("Row {} (RS)", index + 1),
            (_, Side::WrongSide) => format!("Row {} (WS)", index + 1),
        };
        text.push_str(&head);
        let mut separator = ": ";
        for run in worked.chunk_by(|a, b| a == b) {
            // Writing to a string cannot fail.
            let _ = write!(text, "{separator}{}{}", run[0].symbol(), run.len());
            separator = ", ";
        }
        text.push('\n');
    }
    text.push_str("Bind off\n");
    text
}
