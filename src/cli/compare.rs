//! `signorini compare`: three methods, one problem.

use super::input::Input;
use super::options::{Compare, Format};
use super::outcome::{Outcome, warn};
use super::settings::settings;
use crate::error::Error;
use crate::output::{compare_json, compare_text, gallery, write_files};
use crate::qp::Method;
use crate::study::{Summary, compare};
use crate::watch::Watch;

pub(super) fn run(options: &Compare, watch: &Watch) -> Result<Outcome, Error> {
    let common = &options.common;
    let input = Input::read(&options.input, &common.limits)?;
    warn(&input.warnings());
    let settings = settings(Method::Auto, common, watch);
    let comparison = compare(input.problem(), &settings).map_err(|error| input.explain(error))?;
    watch.step("report", 0);
    let [qp, active_set, penalty] = &comparison.answers;
    let solutions = [&qp.solution, &active_set.solution, &penalty.solution];
    let answers = [input.answer(solutions[0])?, input.answer(solutions[1])?, input.answer(solutions[2])?];
    let summary = |index: usize| input.summary(solutions[index], answers[index].as_ref(), common.tolerance);
    let summaries: [Summary; 3] = [summary(0)?, summary(1)?, summary(2)?];
    let json = format!("{:#}\n", compare_json(&summaries, &comparison.agreement));
    let text = match common.format {
        Format::Text => compare_text(&input.title, &summaries, &comparison.agreement, &input.units),
        Format::Json => json.clone(),
    };
    let outcome = Outcome::judged(text, comparison.agreement.exact_methods);
    let Some(folder) = common.out.clone() else { return Ok(outcome) };
    gallery::write_answer(&folder, &qp.solution)?;
    write_files(&folder, &[("report.json", json)])?;
    let [Some(qp), Some(active_set), Some(penalty)] = answers else { return Ok(outcome) };
    let answers = [qp, active_set, penalty];
    Ok(outcome.with_pictures(move || gallery::write_compare(&folder, &answers, &comparison)))
}
