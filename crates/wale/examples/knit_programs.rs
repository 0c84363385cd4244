//! Knits programs in knitout and prints what they become, or why they cannot be knitted.
//!
//! `cargo run --example knit_programs -- FOLDER_OR_FILES`
#![allow(clippy::print_stdout)]

use std::path::PathBuf;
use std::time::Instant;

use wale::pattern::knit;
use wale::pattern::knitout::read_knitout;
use wale::scene::Scene;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The fabric of the default yarn.
    let scene = "schema = 1\n[fabric.chart]\npattern = \"garter\"\ncolumns = 1\nrows = 1\n";
    let card = Scene::from_text(scene, "default")?.fabric;
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
                let network = knit::network(&knitted.graph, card.knit().expect("a knit has the card of a knit"));
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
