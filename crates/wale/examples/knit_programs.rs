//! Knits programs in knitout and prints what they become, or why they cannot be knitted.
//!
//! `cargo run --example knit_programs -- FOLDER_OR_FILES`
#![allow(clippy::print_stdout)]

use std::path::PathBuf;
use std::time::Instant;

use wale::model::{LoopProportions, YarnCard};
use wale::pattern::knit;
use wale::pattern::knitout::read_knitout;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let yarn = YarnCard {
        linear_density: 3e-4,
        radius: 5e-4,
        stretch_stiffness: 0.5,
        bending_stiffness: 8e-10,
        friction_coefficient: 0.3,
        mass_damping: 0.0,
        stiffness_damping: 0.05,
        plies: 2,
        twist: 0.0,
    };
    let card = LoopProportions::default().card(&yarn, 9.5e-3);
    let mut files = Vec::new();
    for argument in std::env::args_os().skip(1).map(PathBuf::from) {
        if argument.is_dir() {
            let inside = std::fs::read_dir(&argument)?.collect::<Result<Vec<_>, _>>()?;
            files.extend(inside.into_iter().map(|entry| entry.path()));
        } else {
            files.push(argument);
        }
    }
    files.retain(|file| file.extension().is_some_and(|kind| kind == "k" || kind == "knitout"));
    files.sort();
    for file in files {
        let text = std::fs::read_to_string(&file)?;
        let start = Instant::now();
        println!("{}", file.display());
        match read_knitout(&text) {
            Err(error) => println!("  {error}"),
            Ok(knitted) => {
                let network = knit::network(&knitted.graph, &card);
                println!(
                    "  {} loops in {} × {}, {} unheld, {} nodes, {} yarns of {:?}, {:.0} ms",
                    knitted.graph.loops.len(),
                    knitted.graph.size[0],
                    knitted.graph.size[1],
                    knitted.graph.unsupported().count(),
                    network.node_count(),
                    network.yarn_count(),
                    knitted.carriers,
                    1e3 * start.elapsed().as_secs_f64()
                );
                for remark in &knitted.remarks {
                    println!("  line {}: {}", remark.line, remark.what);
                }
            }
        }
    }
    Ok(())
}
