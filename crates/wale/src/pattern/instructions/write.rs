//! A chart written out as row instructions.

use std::fmt::Write;

use crate::pattern::chart::Chart;
use crate::pattern::stitch::Stitch;
use crate::pattern::working::{Side, Working};

/// Row instructions that give a chart again, a line a row.
#[must_use]
pub fn write_instructions(chart: &Chart, working: Working) -> String {
    let mut text = format!("Cast on {}\n", chart.cast_on());
    let name = |yarn: u8| char::from(b'A' + yarn % 26);
    let yarns = chart.yarn_count();
    if yarns > 1 {
        let names: Vec<String> = (0..yarns as u8).map(|yarn| name(yarn).to_string()).collect();
        let _ = writeln!(text, "Yarns {}", names.join(", "));
    }
    let mut in_hand = 0;
    for (index, row) in chart.rows().iter().enumerate() {
        let row = row.iter().enumerate().map(|(at, stitch)| (*stitch, chart.yarn(index, at)));
        let side = working.side(index);
        let worked: Vec<(Stitch, u8)> = match side {
            Side::RightSide => row.rev().collect(),
            Side::WrongSide => row.map(|(stitch, yarn)| (stitch.from_behind(), yarn)).collect(),
        };
        let head = match (working, side) {
            (Working::Round, _) => format!("Rnd {}", index + 1),
            (_, Side::RightSide) => format!("Row {} (RS)", index + 1),
            (_, Side::WrongSide) => format!("Row {} (WS)", index + 1),
        };
        text.push_str(&head);
        let mut separator = ": ";
        for run in worked.chunk_by(|a, b| a == b) {
            let (stitch, yarn) = run[0];
            // Writing to a string cannot fail.
            if yarn != in_hand {
                let _ = write!(text, "{separator}with {}", name(yarn));
                separator = ", ";
                in_hand = yarn;
            }
            let _ = match (stitch, run.len()) {
                (Stitch::Knit | Stitch::Purl | Stitch::Slip { in_front: false }, count) => {
                    write!(text, "{separator}{stitch}{count}")
                }
                (stitch, 1) => write!(text, "{separator}{stitch}"),
                (stitch, count) => write!(text, "{separator}{stitch} {count} times"),
            };
            separator = ", ";
        }
        text.push('\n');
    }
    text.push_str("Bind off\n");
    text
}
