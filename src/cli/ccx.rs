//! `signorini ccx`, or the program under the name `ccx`: a deck in, the files of CalculiX out.
//!
//! What a program reads that calls it stands on standard output: CalculiX writes its warnings and errors there, and
//! FreeCAD takes any text on standard error for a failure.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::about::about;
use super::failure::{failed, sentence};
use super::input::Input;
use super::options::{Ccx, Format};
use super::outcome::{Ending, Outcome, unfit};
use super::settings::settings;
use super::solve::{assembly_seconds, reported};
use crate::Error;
use crate::output::{CalculixFiles, remove_files};
use crate::qp::{Start, Watch};
use crate::scene::{Answer, Requests, Scene};

/// Programs take the first number for the version of CalculiX.
const VERSION: &str = concat!(
    "\nThis is Version 2.20 of the decks and result files of CalculiX, which signorini ",
    env!("CARGO_PKG_VERSION"),
    " reads and writes\n\n"
);

/// Answers a call without a deck; programs look for the name of CalculiX.
const USAGE: &str = "Usage: ccx -i NAME\n\nsignorini solves the deck NAME.inp of CalculiX and writes NAME.frd.\n";

/// The arguments with the command `ccx`, if the program is called by that name. FreeCAD passes `-i` with a blank behind
/// it.
pub(super) fn named(given: Vec<OsString>) -> Vec<OsString> {
    let stem = given.first().and_then(|program| Path::new(program).file_stem()).unwrap_or_default();
    if !stem.to_string_lossy().to_ascii_lowercase().starts_with("ccx") {
        return given;
    }
    let trimmed = |word: OsString| if word == "-i " { OsString::from("-i") } else { word };
    let own = ["signorini", "ccx"].map(OsString::from);
    own.into_iter().chain(given.into_iter().skip(1).map(trimmed)).collect()
}

pub(super) fn run(options: &Ccx, watch: &Watch) -> Outcome {
    if options.version {
        return Outcome::done(VERSION.to_string());
    }
    let Some(name) = options.job.as_ref().or(options.deck.as_ref()) else {
        return Outcome { ending: Ending::BadInput, ..Outcome::done(USAGE.to_string()) };
    };
    let mut said = Said::default();
    let ending = answered(options, named_files(name), watch, &mut said);
    let Said { mut text, step } = said;
    let ending = ending.unwrap_or_else(|error| {
        let step = step.map_or_else(String::new, |step| format!("step {step}: "));
        text += &format!(" *ERROR: {step}{}\n", sentence(&error));
        failed(&error, Format::Text).ending
    });
    Outcome { ending, ..Outcome::done(text) }
}

/// Warnings and reports, and the step that is being solved, if there are several.
#[derive(Default)]
struct Said {
    text: String,
    step: Option<usize>,
}

/// The file of a deck, and its name without the ending.
fn named_files(name: &Path) -> [PathBuf; 2] {
    match Scene::is_deck(name) {
        true => [name.to_path_buf(), name.with_extension("")],
        false => [with_ending(name, ".inp"), name.to_path_buf()],
    }
}

/// The name with an ending.
fn with_ending(stem: &Path, ending: &str) -> PathBuf {
    let mut name = OsString::from(stem);
    name.push(ending);
    name.into()
}

/// Solves the steps of the deck in `file` and writes the files of its name `stem`.
/// The files of an earlier run are gone from the start, and fields are written last, of certified answers only.
fn answered(options: &Ccx, [file, stem]: [PathBuf; 2], watch: &Watch, said: &mut Said) -> Result<Ending, Error> {
    let folder = with_ending(&stem, ".signorini");
    CalculixFiles::remove(&stem)?;
    let of_steps = (1..).map(|step| folder.join(format!("step-{step}"))).take_while(|folder| folder.exists());
    std::iter::once(folder.clone())
        .chain(of_steps)
        .try_for_each(|folder| remove_files(&folder, &["report.html", "report.json"]))?;
    let mut answers: Vec<(Answer, Requests)> = Vec::new();
    let ending = steps_solved(options, [&file, &folder], watch, said, &mut answers);
    // A step without an answer leaves those of the steps before it.
    if !answers.is_empty() {
        CalculixFiles::new(&answers)?.write(&stem)?;
    }
    ending
}

/// Solves the steps of a deck in turn, up to the first without an answer that is certified.
fn steps_solved(
    options: &Ccx,
    [file, folder]: [&Path; 2],
    watch: &Watch,
    said: &mut Said,
    answers: &mut Vec<(Answer, Requests)>,
) -> Result<Ending, Error> {
    let deck = &options.limits.deck;
    let (mut step, mut earlier) = (deck.step.unwrap_or(1), Vec::new());
    loop {
        let read = Scene::read_step(file, &deck.permits(), step, &earlier);
        said.step = Some(step).filter(|_| step > 1 || read.as_ref().is_ok_and(|(_, requests)| requests.steps > 1));
        let (scene, requests) = read?;
        let scene = Scene { is_linear: deck.linear, ..scene };
        let of_step =
            if requests.steps > 1 && deck.step.is_none() { folder.join(format!("step-{step}")) } else { folder.into() };
        let mut options = options.clone();
        options.limits.deck.step = Some(step);
        let (ending, answer) = solved(&options, file, of_step, (scene, &requests), watch, &mut said.text)?;
        if ending != Ending::Certified || watch.is_stopped() {
            return Ok(ending);
        }
        earlier.push(answer.displacements_of_deck(&requests)?);
        let is_last = deck.step.is_some() || step >= requests.steps;
        answers.push((answer, requests));
        if is_last {
            return Ok(Ending::Certified);
        }
        step += 1;
    }
}

/// Solves one step of a deck, and writes page and report into a folder.
fn solved(
    options: &Ccx,
    file: &Path,
    folder: PathBuf,
    (scene, requests): (Scene, &Requests),
    watch: &Watch,
    text: &mut String,
) -> Result<(Ending, Answer), Error> {
    let (clock, limits) = (Instant::now(), &options.limits);
    let Some(solve) = options.solve(file.to_path_buf(), folder) else { return unfit("ccx", "no options of `solve`") };
    assembly_seconds(&scene, &solve, watch)?;
    let input = Input::of_scene(&scene, file, limits, clock.elapsed().as_secs_f64())?;
    if requests.steps > 1 {
        *text += &format!("Step {} of {}\n", requests.step, requests.steps);
    }
    *text += &input.warnings().replace("warning: ", " *WARNING: ");
    let missing = CalculixFiles::not_given(requests);
    if !missing.is_empty() {
        *text += &format!(" *WARNING: these results are not written: {}\n", missing.join(", "));
    }
    let settings = settings(solve.method, &solve.common, watch);
    let about = about(&input.title, "solve", file, solve.common.out.as_ref(), solve.common.threads);
    let solved = input.problem().solve_from(&Start::default(), &settings).map_err(|error| input.explain(error))?;
    let Some(answer) = input.answer(&solved)? else { return unfit("ccx", "the deck has no mesh") };
    // The stress is part of all files: it is computed once.
    answer.stress()?;
    let outcome = reported(&input, (solved, Some(answer.clone())), settings.goal(), (about, &solve), watch)?;
    outcome.pictures.map_or(Ok(()), |pictures| pictures())?;
    *text += &outcome.text;
    *text += &outcome.error.map_or_else(String::new, |error| format!(" *ERROR: {error}\n"));
    Ok((outcome.ending, answer))
}
