//! `signorini solve`: one answer.

use super::dynamic;
use super::input::{Content, Input, Source};
use super::options::{Format, Solve};
use super::outcome::{Outcome, warn};
use super::settings::settings;
use crate::error::Error;
use crate::output::{gallery, solve_json, solve_text, write_files};
use crate::qp::{Method, solve};
use crate::study::discretisation_error;
use crate::watch::Watch;

/// Assembly that takes so many seconds at the most is done without time too: the report then says what the rest needs.
const AT_ONCE: f64 = 1e-3;

/// A report adds up what was assembled: it takes this share of the time.
const REPORT: f64 = 0.5;

pub(super) fn run(options: &Solve, watch: &Watch) -> Result<Outcome, Error> {
    let common = &options.common;
    // Reading and assembly count too.
    let watch = &options.time.map_or_else(|| watch.clone(), |time| watch.within(time));
    let source = Source::read(&options.input, &common.limits)?;
    let mut report_seconds = 0.0;
    if let Source::Scene(scene, _) = &source {
        let needs_factor = !matches!(options.method.method(), Method::Auto | Method::Mprgp);
        if needs_factor || scene.analysis.is_some() {
            scene.check_size(common.limits.most_memory())?;
        } else {
            scene.check_size_without_factor(common.limits.most_memory())?;
        }
        let needed = scene.size().assembly_seconds();
        report_seconds = REPORT * needed;
        if let Some(time) = watch.time_left().filter(|_| needed > AT_ONCE && !watch.allows(needed)) {
            return Err(Error::OutOfTime { needed, time });
        }
        if scene.analysis.is_some() {
            return dynamic::run(options, scene, watch);
        }
    }
    if options.resume {
        let path = "analysis".into();
        return Err(Error::Scene { path, message: "nothing moves here, so that there is nothing to resume".into() });
    }
    let input = match source {
        Source::Scene(scene, read_seconds) => Input::of_scene(&scene, &options.input, read_seconds)?,
        Source::Directory(input) => *input,
    };
    warn(&input.warnings());
    let mut settings = settings(options.method.method(), common, &watch.keeping(report_seconds));
    settings.prove = true;
    settings.accuracy = options.accuracy;
    settings.precision = options.precision.precision();
    if let Method::Penalty(ladder) = &mut settings.method {
        ladder.extrapolate = options.extrapolate;
    }
    let solution = match solve(input.problem(), &settings) {
        Ok(solution) => solution,
        Err(error @ Error::NotCertified { .. }) => {
            warn(&format!("error: {error}\n"));
            let Error::NotCertified { solution, .. } = error else { return Err(error) };
            *solution
        }
        Err(error) => return Err(input.explain(error)),
    };
    if options.extrapolate && !matches!(settings.method, Method::Penalty(_)) {
        let method = &solution.method;
        warn(&format!(
            "warning: --extrapolate changes nothing: the method is {method}; it goes with --method penalty\n"
        ));
    }
    watch.step("report", 0);
    let mut summary = input.summary(&solution, settings.goal())?;
    if let Content::Scene(model) = &input.content
        && !watch.is_over()
    {
        summary.discretisation_error = Some(discretisation_error(model, &solution)?);
    }
    let text = match common.format {
        Format::Text => solve_text(&input.title, &summary, &input.units),
        Format::Json => format!("{:#}\n", solve_json(&summary)),
    };
    let outcome = Outcome::judged(text, summary.is_certified());
    let Some(folder) = common.out.clone() else { return Ok(outcome) };
    gallery::write_answer(&folder, &solution)?;
    write_files(&folder, &[("report.json", format!("{:#}\n", solve_json(&summary)))])?;
    if watch.is_over() && !watch.is_stopped() {
        warn("warning: no fields and no pictures: the time is over\n");
        return Ok(outcome);
    }
    Ok(match input.content {
        Content::Scene(model) => outcome.with_pictures(move || gallery::write_solve(&folder, &model, &solution)),
        Content::Directory(_) => outcome,
    })
}
