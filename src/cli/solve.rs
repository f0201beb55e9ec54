//! `signorini solve`: one answer.

use crate::output::{About, Along, InWords, Pictures, Wanted, remove_files, why_text, write_files};
use std::path::Path;

use super::about::about;
use super::along;
use super::complementarity;
use super::dynamic;
use super::input::{Input, Source, add_error_and_energy};
use super::interrupt::Kept;
use super::modes;
use super::options::{Accuracy, Solve};
use super::outcome::{Outcome, Report, unfit, warn};
use super::settings::settings;
use super::total_error;
use crate::Error;
use crate::lcp::Lcp;
use crate::qp;
use crate::qp::{Goal, Method, Settings, Solution, Start, Watch, read_vector};
use crate::scene::{Answer, Scene};
use crate::study::TotalErrorGoal;

/// Assembly that takes at most this many seconds is done even if no time is left: the report can then state the time
/// that the rest needs.
const AT_ONCE: f64 = 1e-3;

/// A report sums the assembled data: it takes this share of the assembly time.
const REPORT: f64 = 0.5;

pub(super) fn run(options: &Solve, watch: &Watch, kept: &Kept) -> Result<Outcome, Error> {
    // Reading and assembly count too.
    let watch = &options.time.map_or_else(|| watch.clone(), |time| watch.within(time));
    if Lcp::is_directory(&options.input)? {
        return complementarity::solve(options, watch);
    }
    let source = Source::read(&options.input, &options.common.limits)?;
    let mut report_seconds = 0.0;
    check_options(options, if let Source::Scene(scene, _) = &source { Some(scene) } else { None })?;
    if let Source::Scene(scene, read_seconds) = &source {
        report_seconds = REPORT * assembly_seconds(scene, options, watch)?;
        if scene.dynamic().is_some() {
            return dynamic::run(options, scene, watch);
        }
        if scene.modes().is_some() {
            return modes::run(options, scene, *read_seconds, watch);
        }
    }
    if let Some(bound) = options.total_error {
        let Source::Scene(scene, _) = &source else {
            let name = options.input.display();
            let message =
                format!("{name} is a problem directory, which has no mesh to refine; a total error needs a scene");
            return unfit("--total-error", message);
        };
        let goal = TotalErrorGoal { total_error: bound, force_error: options.force_error };
        return total_error::run(options, scene, goal, watch, kept);
    }
    let input = match source {
        Source::Scene(scene, read_seconds) => {
            Input::of_scene(&scene, &options.input, &options.common.limits, read_seconds)?
        }
        Source::Directory(input) => *input,
    };
    along::check(&options.along, &input)?;
    warn(&input.warnings());
    let mut settings = settings(options.method, &options.common, &watch.keeping(report_seconds));
    settings.prove = !options.no_proof;
    match options.accuracy {
        Some(Accuracy::Within(accuracy)) => settings.accuracy = Some(accuracy),
        Some(Accuracy::Exact) if settings.method == Method::Auto => settings = settings.exactly(),
        Some(Accuracy::Exact) => {
            let method = settings.method.name();
            warn(&format!(
                "warning: --accuracy exact changes nothing: the method is {method}; it needs --method auto\n"
            ));
        }
        None => {}
    }
    let start = options.start.as_deref().map_or_else(|| Ok(Start::default()), earlier)?;
    if options.plan {
        let plan = input.problem().plan(&start, &settings).map_err(|error| input.explain(error))?;
        return Ok(Outcome::done(plan));
    }
    let about = about(&input.title, "solve", &options.input, options.common.out.as_ref(), options.common.threads);
    let (solution, why) = best_of(&input, &start, &settings)?;
    let answer = input.answer(&solution)?;
    Ok(reported(&input, (solution, answer), settings.goal(), (about, options), watch)?.because(why))
}

/// Refuses options that have no effect on what is solved for.
fn check_options(options: &Solve, scene: Option<&Scene>) -> Result<(), Error> {
    let of_one_answer = [
        ("--total-error", options.total_error.is_some()),
        ("--accuracy", options.accuracy.is_some()),
        ("--precision", options.precision.is_some()),
        ("--no-proof", options.no_proof),
        ("--explain", options.explain),
        ("--plan", options.plan),
        ("--start", options.start.is_some()),
        ("--along", !options.along.is_empty()),
    ];
    let of_a_motion = [("refine", "--refine-in-time", options.refine_in_time), ("resume", "--resume", options.resume)];
    let is_motion = scene.is_some_and(|scene| scene.dynamic().is_some());
    if scene.is_some_and(|scene| scene.analysis.is_some())
        && let Some((option, _)) = of_one_answer.into_iter().find(|(_, is_given)| *is_given)
    {
        let what = if is_motion { "motion" } else { "modes" };
        let hint = match option {
            "--start" if is_motion => "; a motion starts from its `initial` state, and --resume continues one",
            _ => "",
        };
        let message = format!(
            "the scene asks for its {what}, on which this option has no effect; leave the option or `analysis` out{hint}"
        );
        return unfit(option, message);
    }
    match of_a_motion.into_iter().find(|(.., is_given)| *is_given && !is_motion) {
        Some((verb, option, _)) => unfit(option, format!("there is no motion to {verb}; leave {option} out")),
        None => Ok(()),
    }
}

/// The answer of an earlier run in a folder, as a start.
fn earlier(folder: &Path) -> Result<Start, Error> {
    let [displacement, multiplier] = ["u.mtx", "lambda.mtx"].map(|name| read_vector(&folder.join(name)));
    Ok(Start::earlier(displacement?, &multiplier?))
}

/// Refuses a scene that does not fit into memory or time; returns the estimated seconds of its assembly.
pub(super) fn assembly_seconds(scene: &Scene, options: &Solve, watch: &Watch) -> Result<f64, Error> {
    let most_memory = options.common.limits.most_memory();
    let needs_factor = !matches!(options.method, Method::Auto | Method::Mprgp);
    if needs_factor || scene.analysis.is_some() {
        scene.check_size(most_memory)?;
    } else {
        scene.check_size_without_factor(most_memory)?;
    }
    let needed = scene.size().assembly_seconds();
    match watch.time_left().filter(|_| needed > AT_ONCE && !watch.allows(needed)) {
        Some(time) => Err(qp::Error::OutOfTime { needed, time }.into()),
        None => Ok(needed),
    }
}

/// The answer, certified or not, and why it is not.
fn best_of(input: &Input, start: &Start, settings: &Settings) -> Result<(Solution, Option<String>), Error> {
    match input.problem().solve_from(start, settings) {
        Err(error @ qp::Error::NotCertified { .. }) => {
            let why = error.to_string();
            let qp::Error::NotCertified { solution, .. } = error else { return Err(error.into()) };
            Ok((*solution, Some(why)))
        }
        solved => solved.map(|solution| (solution, None)).map_err(|error| input.explain(error)),
    }
}

/// Reports an answer, and writes the output of `--out`.
pub(super) fn reported(
    input: &Input,
    (solution, answer): (Solution, Option<Answer>),
    goal: Goal,
    (about, options): (About, &Solve),
    watch: &Watch,
) -> Result<Outcome, Error> {
    let common = &options.common;
    watch.step("report", 0);
    let mut summary = input.summary(solution, answer.as_ref(), goal)?;
    if let Some(answer) = &answer
        && !watch.is_over()
    {
        add_error_and_energy(&mut summary, answer)?;
    }
    let mut text = summary.text(&input.title, &input.units);
    if options.explain {
        text += &why_text(&summary.solution.why);
    }
    let report = Report::new(&summary, text)?;
    let status = summary.status;
    let Some(folder) = common.out.clone() else { return Ok(report.outcome(common.format, status)) };
    Wanted::write_answer(&folder, &summary.solution, answer.as_ref())?;
    // Lines and ties of an earlier run would not belong to this answer.
    let is_tied = !summary.solution.equality_multiplier.is_empty();
    remove_files(&folder, if is_tied { &["along.csv"] } else { &["along.csv", "mu.mtx"] })?;
    report.write(&folder)?;
    let outcome = report.outcome(common.format, status);
    if watch.is_over() && !watch.is_stopped() {
        warn("warning: no fields and no pictures are written: the time of --time is over\n");
        return Ok(outcome);
    }
    let Some(answer) = answer else {
        about.write_problem(&folder, &summary)?;
        return Ok(outcome);
    };
    let wanted = common.wanted(Pictures::Answer);
    let along = along::along(&options.along, &answer)?;
    if !along.is_empty() {
        write_files(&folder, &[("along.csv", Along::table(&along))])?;
    }
    Ok(outcome.with_pictures(move || {
        about.write_answer(&folder, (&answer, &along), &summary)?;
        wanted.write_solve(&folder, &answer, &summary.solution.history)
    }))
}
