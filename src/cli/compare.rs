//! `signorini compare`: three methods, one problem.

use crate::output::{InWords, Pictures, Wanted};
use serde_json::json;

use super::about::about;
use super::complementarity;
use super::input::Input;
use super::options::Compare;
use super::outcome::{OfPart, Outcome, Report, warn};
use super::settings::settings;
use crate::Error;
use crate::lcp::Lcp;
use crate::qp::{Method, Watch};
use crate::scene::Answer;
use crate::study::{Comparison, Summary, compare};

pub(super) fn run(options: &Compare, watch: &Watch) -> Result<Outcome, Error> {
    if Lcp::is_directory(&options.input)? {
        return complementarity::compare(options, watch);
    }
    let common = &options.common;
    let input = Input::read(&options.input, &common.limits)?;
    warn(&input.warnings());
    let about = about(&input.title, "compare", &options.input, common.out.as_ref(), common.threads);
    let settings = settings(Method::Auto, common, watch);
    let Comparison { answers, agreement } =
        compare(input.problem(), &settings).map_err(|error| input.explain(error))?;
    watch.step("report", 0);
    let [qp, active_set, penalty] = answers.map(|by_method| -> Result<(Option<Answer>, Summary), Error> {
        let answer = input.answer(&by_method.solution)?;
        let summary = input.summary(by_method.solution, answer.as_ref(), common.tolerance)?;
        Ok((answer, summary))
    });
    let ((qp, of_qp), (active_set, of_active_set), (penalty, of_penalty)) = (qp?, active_set?, penalty?);
    let summaries = [of_qp, of_active_set, of_penalty];
    // A certified answer of the QP may still be one that small displacements do not describe.
    let status = [agreement.status(), summaries[0].status].into_iter().collect();
    let text = (&summaries, &agreement).text(&input.title, &input.units);
    let is_part = summaries[0].parts_of_whole.is_some();
    let methods = json!({ "methods": summaries, "agreement": agreement });
    let report = Report::new(&OfPart::new(methods, is_part, &["agreement"]), text)?;
    let Some(folder) = common.out.clone() else { return Ok(report.outcome(common.format, status)) };
    Wanted::write_answer(&folder, &summaries[0].solution, qp.as_ref())?;
    report.write(&folder)?;
    let outcome = report.outcome(common.format, status);
    let (Some(qp), Some(active_set), Some(penalty)) = (qp, active_set, penalty) else { return Ok(outcome) };
    let answers = [qp, active_set, penalty];
    let wanted = common.wanted(Pictures::usual_of_series(answers[0].model()));
    Ok(outcome.with_pictures(move || {
        about.write_comparison(&folder, &answers, &summaries, &agreement)?;
        wanted.write_compare(&folder, &answers, &summaries)
    }))
}
