//! `wale lab`: virtual textile tests of a fabric that was fitted.

mod bending;
mod card;
mod drape;
mod fabric;
mod failure;
mod folder;
mod in_plane;
mod models;
mod question;
mod report;
mod shear;
mod sheet_picture;
mod swatch_picture;
mod tiles;
mod yarns;

use std::path::PathBuf;

use rayon::prelude::*;
use wale::picture::Series;

use crate::arguments::lab::{By, Lab, Test};
use crate::exit::{Code, Failure};
use crate::machine;
use fabric::Fabric;
use failure::TestFailure;
use folder::refuse_taken;
use question::{Found, Question};
use report::{Report, direction_name};

/// Does a test, asks for it, or takes what was found elsewhere.
pub fn lab(arguments: &Lab) -> Result<(), Failure> {
    let Some(test) = &arguments.test else {
        machine::use_threads(arguments.threads.map(usize::from))?;
        return question::answer();
    };
    let common = test.common();
    let by = common.by.unwrap_or_else(|| models::usual(test));
    if let Some(why) = models::cannot(test, by) {
        return Err(Failure::new(Code::Usage, format_args!("{} {why}", test.name())));
    }
    if common.results.out.is_some() && common.fabrics.len() > 1 {
        let what = "--out is the folder of one fabric; leave it out, and each gets its own beside it";
        return Err(Failure::new(Code::Usage, what));
    }
    let mut asked = Vec::new();
    for path in &common.fabrics {
        let fabric = Fabric::read(path, by)?;
        // What is wrong with a fabric is said before anything is tested.
        fabric.specimen(test, by, path)?;
        asked.push(questions(test, by, &fabric)?);
    }
    let ids: Vec<String> = asked.iter().flatten().map(|(id, _)| id.clone()).collect();
    let told = common.tell.as_ref().map(|file| question::answers(file, &ids)).transpose()?;
    if common.ask {
        let open = |id: &String| told.as_ref().is_none_or(|told| !told.contains_key(id));
        let mut printed: Vec<&String> = Vec::new();
        for (id, question) in asked.iter().flatten() {
            // The same card under two names is one question.
            if open(id) && !printed.contains(&id) {
                question::print(question)?;
                printed.push(id);
            }
        }
        return Ok(());
    }
    let extras = match test {
        Test::Drape(_) => &drape::EXTRAS[..],
        Test::Stretch(_) | Test::Strip(_) => &in_plane::EXTRAS[..],
        _ => &[],
    };
    let folder = |path: &PathBuf| common.results.out.clone().unwrap_or_else(|| path.with_extension("lab"));
    for path in &common.fabrics {
        refuse_taken(&folder(path), test.name(), &Report::suffixes(extras), common.results.force)?;
    }
    machine::use_threads(common.results.threads.map(usize::from))?;
    let mut lost = Vec::new();
    for (path, questions) in common.fabrics.iter().zip(&asked) {
        let found: Vec<Option<Found>> = match &told {
            Some(told) => questions.iter().map(|(id, _)| told.get(id).cloned()).collect(),
            None => {
                let found: Vec<_> = questions.par_iter().map(|(_, question)| question.answer(path)).collect();
                found.into_iter().map(|one| one.map(Some)).collect::<Result<_, Failure>>()?
            }
        };
        let Some(found) = found.into_iter().collect::<Option<Vec<_>>>() else {
            lost.push(path.display().to_string());
            continue;
        };
        let reports = found.into_iter().map(|one| match one {
            Found::Report(report) => Ok(report),
            Found::Failure(failure) => Err(failure.of(path)),
        });
        let report = Report::join(reports.collect::<Result<Vec<_>, Failure>>()?);
        let report = report.ok_or_else(|| Failure::new(Code::Bug, "a test without a direction"))?;
        let title = questions[0].1.fabric.title();
        report.deliver(test.name(), by, title, &folder(path), common.results.json)?;
    }
    if lost.is_empty() {
        return Ok(());
    }
    let what = "not all questions are answered, nothing was written of it; add `--ask` to see which are left";
    Err(Failure::new(Code::BadInput, format_args!("{}: {what}", lost.join(", "))))
}

/// The questions of a test of a fabric, with their fingerprints, by direction.
fn questions(test: &Test, by: By, fabric: &Fabric) -> Result<Vec<(String, Question)>, Failure> {
    let usual = models::usual_directions(test, by);
    let mut tests = Vec::new();
    match test.clone().directions().cloned() {
        None => tests.push(test.clone()),
        Some(asked) => {
            for angle in if asked.is_empty() { usual } else { asked } {
                let mut test = test.clone();
                if let Some(directions) = test.directions() {
                    *directions = vec![angle];
                }
                tests.push(test);
            }
        }
    }
    tests
        .into_iter()
        .map(|test| {
            let question = Question::new(test, by, fabric.clone());
            Ok((question.id()?, question))
        })
        .collect()
}

/// A test in several directions at once, in their order.
fn in_directions<T: Send, E: Send + Into<TestFailure>>(
    directions: &[f64],
    run: impl Fn(f64) -> Result<T, E> + Sync,
) -> Result<Vec<(f64, T)>, TestFailure> {
    let found: Vec<Result<(f64, T), E>> = directions.par_iter().map(|&angle| Ok((angle, run(angle)?))).collect();
    // The first that failed, however many there are.
    found.into_iter().map(|one| one.map_err(Into::into)).collect()
}

/// A line of a plot, by direction.
fn line(angle: f64, points: impl Iterator<Item = [f64; 2]>) -> Series {
    let (xs, ys) = points.map(|[x, y]| (x, y)).unzip();
    Series { name: direction_name(angle), xs, ys }
}
