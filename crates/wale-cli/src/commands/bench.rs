//! `wale bench`: speed and memory on this machine, beside its memory bandwidth.

use serde_json::json;
use wale::model::LinearSolver;

use crate::arguments::{Bench, Subject};
use crate::bench::layout::{BAR, LOOPS, LaidOut, all};
use crate::bench::patterns::compare;
use crate::bench::swatch::{Measured, measure};
use crate::bench::triad;
use crate::exit::Failure;
use crate::output::{bytes, grouped, note, span};
use crate::{machine, output, say};

/// Sizes, as parts of the largest.
const PARTS: [u32; 3] = [10, 3, 1];
/// Steps that a swatch is measured for.
const STEPS: usize = 60;
/// Steps that a solver is measured for.
const SOLVER_STEPS: usize = 20;

/// Patterns that are compared with the first: plain, yarn-overs and decreases (half of all stitches, and fewer), tucks, increases
/// and deep stacks, several yarns.
const PATTERNS: [&str; 7] =
    ["stockinette", "garter", "mesh", "feather and fan", "fisherman's rib", "bramble", "stranded check"];

/// Sizes around which conjugate gradients take over from factors \[nodes\].
const SOLVER_NODES: [u32; 4] = [1000, 2000, 4000, 8000];

/// Measures.
pub fn bench(arguments: &Bench) -> Result<(), Failure> {
    let threads = machine::use_threads(arguments.manner.threads.map(usize::from))?;
    match arguments.subject {
        Subject::Swatch => swatch(arguments, threads),
        Subject::Patterns => patterns(arguments, threads),
        Subject::Layout => layout(arguments, threads),
        Subject::Solver => solver(arguments, threads),
    }
}

fn swatch(arguments: &Bench, threads: usize) -> Result<(), Failure> {
    let before = triad();
    let mut measured: Vec<Measured> = Vec::new();
    for part in PARTS {
        measured.push(told(arguments, "garter", arguments.nodes / part, STEPS, LinearSolver::Automatic)?);
    }
    let bandwidth = before.max(triad());
    let exponent = exponent(&measured);
    if arguments.json {
        return output::json(&json!({
            "threads": threads,
            "triad_bytes_per_s": bandwidth,
            "swatches": measured,
            "step_cost_exponent": exponent,
        }));
    }
    say!("memory triad on {threads} threads: {:.1} GB/s", 1e-9 * bandwidth)?;
    say!("garter swatch falling on a sphere, steps of 1 ms:")?;
    say!("    nodes   node·steps/s   Newton   linear   frame of 1/30 s   product/triad   peak memory   a node")?;
    for swatch in &measured {
        say!(
            "{:>9} {:>14} {:>8.1} {:>8.1} {:>17} {:>13.0} % {:>13} {:>8}",
            grouped(swatch.nodes as u64),
            grouped(swatch.node_steps_per_s as u64),
            swatch.newton_iterations,
            swatch.linear_iterations,
            span(swatch.frame_s),
            100.0 * swatch.product_bytes_per_s / bandwidth,
            swatch.peak_memory_bytes.map_or_else(|| "?".to_owned(), bytes),
            swatch.peak_memory_bytes.map_or_else(|| "?".to_owned(), |peak| bytes(peak / swatch.nodes as u64))
        )?;
    }
    say!("the cost of a step grows as n^{exponent:.2}")
}

fn patterns(arguments: &Bench, threads: usize) -> Result<(), Failure> {
    tell(arguments, &format!("{} swatches falling on spheres, a step of each in turn …", PATTERNS.len()));
    let compared = compare(&PATTERNS, arguments.nodes / 3, STEPS)?;
    if arguments.json {
        return output::json(&json!({ "threads": threads, "patterns": compared }));
    }
    say!(
        "swatches falling on spheres, a step of 1 ms of each in turn, on {threads} threads; a stitch and a loop against one of {}:",
        PATTERNS[0]
    )?;
    say!(
        "                       stitches    loops    nodes  node·steps/s  Newton  linear  a step for  a step for      of them   one of    an iteration"
    )?;
    say!(
        "  pattern                                                                        a stitch    a loop      yo, dec, …  these costs   for a stitch"
    )?;
    for swatch in &compared {
        say!(
            "  {:<20} {:>8} {:>8} {:>8} {:>13} {:>7.1} {:>7.1} {:>11.2} {:>11.2} {:>10.0} % {:>12} {:>14.2}",
            swatch.pattern,
            grouped(swatch.stitches as u64),
            grouped(swatch.loops as u64),
            grouped(swatch.nodes as u64),
            grouped(swatch.node_steps_per_s as u64),
            swatch.newton_iterations,
            swatch.linear_iterations,
            swatch.stitch_cost,
            swatch.loop_cost,
            100.0 * swatch.special_part,
            swatch.special_cost.map_or_else(|| "–".to_owned(), |cost| format!("{cost:.2}")),
            swatch.iteration_cost,
        )?;
    }
    Ok(())
}

fn layout(arguments: &Bench, threads: usize) -> Result<(), Failure> {
    tell(arguments, &format!("fabrics of {} loops, one after the other …", grouped(u64::from(LOOPS))));
    let before = triad();
    let mut fabrics = all(LOOPS)?;
    let bandwidth = before.max(triad());
    fabrics.sort_by(|a, b| b.for_loops().total_cmp(&a.for_loops()));
    let longest = fabrics.first().map_or(f64::NAN, LaidOut::for_loops);
    if arguments.json {
        return output::json(&json!({
            "threads": threads,
            "triad_bytes_per_s": bandwidth,
            "bar_s": BAR,
            "longest_s": longest,
            "fabrics": fabrics,
        }));
    }
    say!("memory triad on {threads} threads: {:.1} GB/s", 1e-9 * bandwidth)?;
    say!("from what a fabric is given as to its network, the longest first:")?;
    say!("  fabric                       loops    nodes   reading   network   both for {}", grouped(u64::from(LOOPS)))?;
    for fabric in &fabrics {
        say!(
            "  {:<25} {:>8} {:>8} {:>9} {:>9} {:>18}",
            fabric.fabric,
            grouped(fabric.loops as u64),
            grouped(fabric.nodes as u64),
            fabric.read_s.map_or_else(|| "–".to_owned(), seconds),
            seconds(fabric.network_s),
            seconds(fabric.for_loops()),
        )?;
    }
    let met = if longest < BAR { "met" } else { "NOT met" };
    say!("under {} for {} loops of any: {met}", span(BAR), grouped(u64::from(LOOPS)))
}

fn seconds(seconds: f64) -> String {
    format!("{seconds:.2} s")
}

fn solver(arguments: &Bench, threads: usize) -> Result<(), Failure> {
    let mut measured = Vec::new();
    for nodes in SOLVER_NODES {
        let direct = told(arguments, "garter", nodes, SOLVER_STEPS, LinearSolver::Cholesky)?;
        measured.push([direct, told(arguments, "garter", nodes, SOLVER_STEPS, LinearSolver::ConjugateGradient)?]);
    }
    if arguments.json {
        let sizes: Vec<_> = measured.iter().map(|[a, b]| json!({"cholesky": a, "conjugate_gradient": b})).collect();
        return output::json(&json!({ "threads": threads, "sizes": sizes }));
    }
    say!("a step of 1 ms on {threads} threads:")?;
    say!("    nodes   sparse Cholesky   conjugate gradients   iterations a solve")?;
    for [direct, iterative] in &measured {
        say!(
            "{:>9} {:>14.1} ms {:>18.1} ms {:>20.1}",
            grouped(direct.nodes as u64),
            1e3 * direct.step_s,
            1e3 * iterative.step_s,
            iterative.linear_iterations / iterative.newton_iterations
        )?;
    }
    Ok(())
}

/// Says what is going on, unless that is unwanted.
fn tell(arguments: &Bench, what: &str) {
    if !arguments.manner.quiet {
        note(what);
    }
}

/// Measures a size, and says so.
fn told(arguments: &Bench, pattern: &str, nodes: u32, steps: usize, solver: LinearSolver) -> Result<Measured, Failure> {
    tell(arguments, &format!("{pattern} of {} nodes falling on a sphere …", grouped(u64::from(nodes))));
    measure(pattern, nodes, steps, solver)
}

/// Slope of the logarithm of the cost over that of the size, from the smallest to the largest.
fn exponent(measured: &[Measured]) -> f64 {
    match (measured.first(), measured.last()) {
        (Some(first), Some(last)) if last.nodes > first.nodes => {
            (last.step_s / first.step_s).ln() / (last.nodes as f64 / first.nodes as f64).ln()
        }
        _ => f64::NAN,
    }
}
