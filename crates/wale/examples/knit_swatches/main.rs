//! Relaxed sizes of real swatches, predicted with one card: width and height of knit-and-purl patterns relative to stockinette,
//! found on periodic tiles without friction.
//!
//! `cargo run --release -p wale --example knit_swatches -- SWATCHES.json [point|thick] [NAME=VALUE …] [--least-loops N] [--most-loops N]
//! [--fit ROUNDS] [--fitted NAME,…] [--chart WORD] [--lace] [--shaken] [--off-needles PITCH,PULL,FRICTION] [--plot FILE]` prints predicted against measured sizes, of the charts that the card was fitted to and of all others apart.
//! `--chart` predicts only those charts whose names have a word in them; `--fit` first fits the card again, from the numbers that it has or is given; `--fitted` names the charts that
//! this is done with, by the ends of their names, stockinette among them, where they are not those of `swatches.rs`;
//! `--lace` adds the charts of lace, with the same card, `--lace-only` leaves the others out; `--shaken` shakes each repeat of at most 200 loops at rest, which finds lower equilibria
//! (a fit is made without); `--off-needles` takes each repeat from its needles against friction instead, as `wale::dynamics::off_needles` says; `--plot` draws all of it. Measured: KnitDB [Hofmann et al. 2019], 60 × 60 stitches of one yarn on one machine; `swatches.rs` says which are
//! left out.

mod fit;
mod plot;
mod repeat;
mod sizes;
mod swatches;

use std::path::PathBuf;
use std::process::ExitCode;

use rayon::prelude::*;
use wale::dynamics::off_needles::OffNeedles;
use wale::model::LoopProportions;

use fit::{Fit, numbers};
use sizes::{Model, STOCKINETTE, spacing};
use swatches::{Kind, Swatch, read};

/// A predicted size, relative to stockinette as the measured one is.
struct Predicted<'a> {
    swatch: &'a Swatch,
    size: [f64; 2],
    iterations: usize,
    converged: bool,
    seconds: f64,
}

impl Predicted<'_> {
    /// Predicted against measured sizes, the errors, and what it took.
    fn line(&self) -> String {
        let ([w, h], [mw, mh]) = (self.size, self.measured());
        let repeat = format!("{}x{}", self.swatch.repeat.column_count(), self.swatch.repeat.row_count());
        format!(
            "  {:<29} {repeat:>6}  {w:.3} {h:.3} against {mw:.3} {mh:.3}  {:+3.0} {:+3.0} %  {:>4} iterations{} {:>6.1} s",
            self.swatch.name,
            100.0 * (w / mw - 1.0),
            100.0 * (h / mh - 1.0),
            self.iterations,
            if self.converged { "" } else { " NOT AT REST" },
            self.seconds,
        )
    }

    fn measured(&self) -> [f64; 2] {
        [self.swatch.width / STOCKINETTE[0], self.swatch.height / STOCKINETTE[1]]
    }
}

fn predict<'a>(swatches: &[&'a Swatch], model: &Model) -> Vec<Predicted<'a>> {
    let stockinette = spacing(&model.relaxed(&wale::pattern::Chart::stockinette()));
    let of = |swatch: &&'a Swatch| {
        let clock = std::time::Instant::now();
        let found = model.relaxed(&swatch.repeat);
        let spacing = spacing(&found);
        let size = [0, 1].map(|k| (spacing[k] - stockinette[k]).exp());
        let (iterations, converged) = (found[0].iterations, found[0].converged);
        let predicted = Predicted { swatch, size, iterations, converged, seconds: clock.elapsed().as_secs_f64() };
        // As soon as it is known: large repeats take minutes.
        eprintln!("{} loops{}", swatch.repeat.loop_count(), predicted.line());
        predicted
    };
    swatches.par_iter().with_max_len(1).map(of).collect()
}

fn print(title: &str, all: &[Predicted<'_>]) {
    if all.is_empty() {
        return;
    }
    println!("{title}");
    all.iter().for_each(|one| println!("{}", one.line()));
    let error = |k: usize| {
        let sum: f64 = all.iter().map(|one| (one.size[k] / one.measured()[k]).ln().powi(2)).sum();
        (sum / all.len() as f64).sqrt()
    };
    let rank = |k: usize| {
        let (a, b): (Vec<f64>, Vec<f64>) = all.iter().map(|one| (one.size[k], one.measured()[k])).unzip();
        correlation(&ranks(&a), &ranks(&b))
    };
    let met = |met: bool| if met { "met" } else { "NOT met" };
    println!("  rms of the logarithms: width {:.3}, height {:.3}", error(0), error(1));
    println!("    {} in both: {}", BARS.rms, met([0, 1].iter().all(|&k| error(k) <= BARS.rms)));
    println!("  rank correlation: width {:.3}, height {:.3}", rank(0), rank(1));
    println!(
        "    {} and {}: {} and {}",
        BARS.ranks[0],
        BARS.ranks[1],
        met(rank(0) >= BARS.ranks[0]),
        met(rank(1) >= BARS.ranks[1])
    );
    let [(width, wide), (height, high)] = [0, 1].map(|k| {
        let again = again(&all.iter().map(|one| one.measured()[k]).collect::<Vec<_>>(), REPEAT_NOISE[k]);
        let reach = again.iter().filter(|rank| **rank >= BARS.ranks[k]).count();
        (again.iter().sum::<f64>() / SETS as f64, 100 * reach / SETS)
    });
    println!("  of swatches knitted again: width {width:.2} and height {height:.2} on average");
    println!("    met by {wide} and {high} % of them");
}

/// What is asked for of charts that the card was not fitted to.
struct Bars {
    /// Root mean square of the logarithms, at most.
    rms: f64,
    /// Rank correlations of width and height, at least.
    ranks: [f64; 2],
}

const BARS: Bars = Bars { rms: 0.07, ranks: [0.8, 0.9] };

/// Standard deviation of the logarithms of width and height among swatches of one chart: stockinette (four), seed (three) and
/// moss (two).
const REPEAT_NOISE: [f64; 2] = [0.027, 0.034];

/// Sets of swatches that are knitted again.
const SETS: usize = 2000;

/// Rank correlations of measured sizes with those of other sets of the same swatches, knitted and measured as exactly: what no
/// prediction can be expected to exceed.
fn again(measured: &[f64], noise: f64) -> Vec<f64> {
    let mut state = 1_u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut normal = || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
    let mut again = || {
        let second: Vec<f64> = measured.iter().map(|size| size * (noise * normal()).exp()).collect();
        correlation(&ranks(&second), &ranks(measured))
    };
    (0..SETS).map(|_| again()).collect()
}

/// Ranks, equal values at their mean.
fn ranks(values: &[f64]) -> Vec<f64> {
    let below = |x: f64| values.iter().filter(|y| **y < x).count() as f64;
    let equal = |x: f64| values.iter().filter(|y| **y == x).count() as f64;
    values.iter().map(|&x| below(x) + 0.5 * (equal(x) - 1.0)).collect()
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let (ma, mb) = (mean(a), mean(b));
    let product =
        |a: &[f64], ma: f64, b: &[f64], mb: f64| a.iter().zip(b).map(|(a, b)| (a - ma) * (b - mb)).sum::<f64>();
    product(a, ma, b, mb) / (product(a, ma, a, ma) * product(b, mb, b, mb)).sqrt()
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

/// Gives a number of the card another value.
fn set(card: &mut LoopProportions, name: &str, value: &str) -> Result<(), String> {
    let known = numbers(card).iter().find(|number| number.name == name);
    let number = known.ok_or_else(|| format!("{name}: no number of this card"))?;
    *(number.place)(card) = value.parse().map_err(|error| format!("{name}={value}: {error}"))?;
    Ok(())
}

/// Pitch in loop lengths, pull and friction in `k_b/ℓ²`.
fn off_needles(text: &str) -> Result<OffNeedles, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(str::parse).collect();
    match numbers.as_deref() {
        Ok(&[pitch, take_down, friction]) => Ok(OffNeedles { pitch, take_down, friction }),
        _ => Err(format!("--off-needles {text}: three numbers, as in 0.35,30,inf")),
    }
}

/// Takes the named charts for those that the card is fitted to, and no others.
fn fit_others(all: &mut [Swatch], names: &str) -> Result<(), String> {
    all.iter_mut().for_each(|swatch| swatch.fitted = false);
    for name in names.split(',') {
        let named = all.iter_mut().find(|swatch| swatch.name.ends_with(name));
        named.ok_or(format!("--fitted {name}: no chart of knits and purls has such a name"))?.fitted = true;
    }
    // Sizes are relative to that of stockinette, which is the first.
    if all.first().is_some_and(|swatch| swatch.fitted) { Ok(()) } else { Err("--fitted: without stockinette".into()) }
}

fn run() -> Result<(), String> {
    let mut path = None;
    let (mut card, mut least, mut most, mut rounds) = (LoopProportions::thick(), 0, usize::MAX, 0);
    let (mut plain, mut lace, mut shaken) = (true, false, false);
    let (mut word, mut names, mut picture, mut needles) = (None, None, None, None);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut text = || arguments.next().ok_or(format!("{argument} without a value"));
        let mut number = || {
            let text = text()?;
            text.parse::<usize>().map_err(|error| format!("{argument} {text}: {error}"))
        };
        match argument.as_str() {
            "point" => card = LoopProportions::default(),
            "thick" => card = LoopProportions::thick(),
            "--least-loops" => least = number()?,
            "--most-loops" => most = number()?,
            "--lace" => lace = true,
            "--lace-only" => (lace, plain) = (true, false),
            "--shaken" => shaken = true,
            "--off-needles" => needles = Some(off_needles(&text()?)?),
            "--plot" => picture = Some(PathBuf::from(text()?)),
            "--chart" => word = Some(text()?),
            "--fit" => rounds = number()?,
            "--fitted" => names = Some(text()?),
            _ => match argument.split_once('=') {
                Some((name, value)) => set(&mut card, name, value)?,
                None => path = Some(argument),
            },
        }
    }
    let path = path.ok_or("which file? knit_swatches SWATCHES.json")?;
    let mut all = read(&path, Kind::KnitAndPurl)?;
    if let Some(names) = names {
        fit_others(&mut all, &names)?;
    }
    let known: Vec<&Swatch> = all.iter().filter(|swatch| swatch.fitted).collect();
    if rounds > 0 {
        let (found, error) = Fit::new(&known, Model { needles, ..Model::new(card) }).run(rounds);
        card = found;
        println!("fitted to {:.4}:", error);
        for number in numbers(&card) {
            println!("  {} = {:.4}", number.name, *(number.place)(&mut card.clone()));
        }
    }
    let asked = |swatch: &&Swatch| {
        (least..=most).contains(&swatch.repeat.loop_count())
            && word.as_ref().is_none_or(|word| swatch.name.contains(word))
    };
    let model = Model { shaken, needles, ..Model::new(card) };
    let [wale, course] = spacing(&model.relaxed(&wale::pattern::Chart::stockinette())).map(f64::exp);
    println!("stockinette: wale {wale:.4}, course {course:.4} of the length of a loop");
    let (fitted, others): (Vec<&Swatch>, Vec<&Swatch>) =
        all.iter().filter(|_| plain).filter(asked).partition(|swatch| swatch.fitted);
    let fitted = predict(&fitted, &model);
    print("fitted charts", &fitted);
    let others = predict(&others, &model);
    print("other charts", &others);
    let of_lace = if lace { read(&path, Kind::Lace)? } else { Vec::new() };
    let of_lace = predict(&of_lace.iter().filter(asked).collect::<Vec<_>>(), &model);
    print("charts of lace", &of_lace);
    match picture {
        Some(picture) => {
            plot::write(&picture, &[("fitted charts", &fitted), ("other charts", &others), ("lace", &of_lace)])
        }
        None => Ok(()),
    }
}
