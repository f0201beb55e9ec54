//! One page for each command that answers a scene.

use std::path::Path;

use serde::Serialize;
use serde_json::{Value, json};

use super::about::About;
use super::along::AlongShown;
use super::body::Shape;
use super::html::write_page;
use super::model::Page;
use super::motion::{MotionFrames, MotionShown};
use super::packed::Packer;
use super::plots::PlotShown;
use super::rows::Contact;
use super::search::Search;
use super::state::State;
use super::sweep::SweepShown;
use crate::error::Error;
use crate::output::draw::drawing::Drawing;
use crate::output::picture::plane_scene::PlaneScene;
use crate::output::plots::plot::Plot;
use crate::output::reports::certificate::CertificateWords;
use crate::output::reports::report::proven_text;
use crate::output::view::along::Along;
use crate::output::view::curves::{history_plots, sweep_plots};
use crate::scene::{Answer, Model, Units};
use crate::solution::Iteration;
use crate::study::{Agreement, Summary, Sweep};

/// The page of one answer to a scene, with the answer along lines.
///
/// # Errors
/// [`Error::File`], and those of the recovery of stresses.
pub(crate) fn write_answer_page(
    folder: &Path,
    about: &About,
    (answer, along): (&Answer, &[Along]),
    summary: &Summary,
) -> Result<(), Error> {
    let (mut packer, shape) = (Packer::default(), Shape::with_inside(answer.model()));
    let page = of_answer(about, answer, summary, &summary.solution.history, (&shape, &mut packer))?;
    let along = along.iter().map(|along| AlongShown::of(along, answer.model(), &mut packer)).collect();
    let page = Page { report: timeless(value(summary)?), along, ..page };
    write_page(folder, &page, packer, still(answer)?.as_ref())
}

/// The page of an answer to a problem directory, which has no body to draw.
///
/// # Errors
/// [`Error::File`].
pub(crate) fn write_problem_page(folder: &Path, about: &About, summary: &Summary) -> Result<(), Error> {
    let page = Page { report: timeless(value(summary)?), ..judged(Page::new(about, &Units::unnamed()), summary) };
    write_page(folder, &page, Packer::default(), None)
}

/// The page of three methods: the answer of the QP, the search of the active set, the pressures of all.
///
/// # Errors
/// As [`write_answer_page`].
pub(crate) fn write_comparison_page(
    folder: &Path,
    about: &About,
    answers: &[Answer; 3],
    summaries: &[Summary; 3],
    agreement: &Agreement,
) -> Result<(), Error> {
    let (mut packer, shape) = (Packer::default(), Shape::of(answers[0].model()));
    let history = &summaries[1].solution.history;
    let page = of_answer(about, &answers[0], &summaries[0], history, (&shape, &mut packer))?;
    let pressures = answers.iter().map(|answer| packer.exact(answer.pressure(), 1)).collect();
    let report = json!({ "methods": timeless(value(summaries)?), "agreement": value(agreement)? });
    write_page(folder, &Page { report, pressures, ..page }, packer, still(&answers[0])?.as_ref())
}

/// The page of a sweep; if the exact path is known, it shows every gap between the first and the last.
///
/// # Errors
/// As [`write_answer_page`], and those of the solves at the corners of the path.
pub(crate) fn write_sweep_page(folder: &Path, about: &About, sweep: &Sweep) -> Result<(), Error> {
    let Some(first) = sweep.points.first() else { return Ok(()) };
    let (mut packer, shape) = (Packer::default(), Shape::of(first.answer.model()));
    let page = Page::of_model(about, first.answer.model(), &shape, &mut packer);
    let (shown, states) = SweepShown::of(sweep, &shape, &mut packer)?;
    let plots = sweep_plots(sweep).iter().map(|plot| PlotShown::of(plot, &mut packer)).collect();
    write_page(folder, &Page { sweep: Some(shown), states, plots, ..page }, packer, still(&first.answer)?.as_ref())
}

/// The page of a motion; `report` is the object of `report.json`.
///
/// # Errors
/// As [`write_answer_page`], and those of reading frames.
pub(crate) fn write_motion_page(
    folder: &Path,
    about: &About,
    model: &Model,
    report: Value,
    frames: &MotionFrames,
) -> Result<(), Error> {
    let (mut packer, shape) = (Packer::default(), Shape::of(model));
    let page = Page::of_model(about, model, &shape, &mut packer);
    let (motion, states) = MotionShown::of(frames, &shape, model.mesh().dimension(), &mut packer)?;
    let plots = history_plots(model, frames.history).iter().map(|plot| PlotShown::of(plot, &mut packer)).collect();
    write_page(folder, &Page { report: timeless(report), motion: Some(motion), states, plots, ..page }, packer, None)
}

/// The page of a trade-off with its pictures.
///
/// # Errors
/// [`Error::File`].
pub(crate) fn write_tradeoff_page<'a>(
    folder: &Path,
    about: &About,
    measured: &impl Serialize,
    stills: impl IntoIterator<Item = &'a Drawing>,
) -> Result<(), Error> {
    let page = Page { report: value(measured)?, ..Page::new(about, &Units::unnamed()) };
    write_page(folder, &page, Packer::default(), stills)
}

/// The page of an error against the continuum: the question, the answer on the last mesh if there is one, and the decrease of the error
/// from mesh to mesh as a plot, with the picture of the meshes.
///
/// # Errors
/// As [`write_answer_page`].
pub(crate) fn write_total_error_page(
    folder: &Path,
    about: &About,
    (first, answer): (&Model, Option<&(Answer, Summary)>),
    report: Value,
    (plot, meshes): (&Plot, Option<&Drawing>),
) -> Result<(), Error> {
    let mut packer = Packer::default();
    let page = match answer {
        Some((answer, summary)) => {
            let shape = Shape::of(answer.model());
            of_answer(about, answer, summary, &summary.solution.history, (&shape, &mut packer))?
        }
        None => Page::of_model(about, first, &Shape::of(first), &mut packer),
    };
    let plots = vec![PlotShown::of(plot, &mut packer)];
    write_page(folder, &Page { report: timeless(report), plots, ..page }, packer, meshes)
}

/// The common content of all pages of one answer.
fn of_answer<'a>(
    about: &'a About,
    answer: &Answer,
    summary: &Summary,
    history: &[Iteration],
    (shape, packer): (&Shape, &mut Packer),
) -> Result<Page<'a>, Error> {
    let page = Page::of_model(about, answer.model(), shape, packer);
    let states = vec![State::of(answer, answer.model().gap(), shape, packer)?];
    let contact = Some(Contact::of(answer, summary.solution.proven.as_ref(), packer));
    let search = Some(Search::of(answer, history, shape, packer)?).filter(|_| history.len() > 1);
    Ok(judged(Page { states, contact, search, ..page }, summary))
}

/// The page with the certificate in words.
fn judged<'a>(page: Page<'a>, summary: &Summary) -> Page<'a> {
    let certificate = Some(CertificateWords::of(&summary.solution.certificate, summary.goal));
    Page { certificate, proven: summary.solution.proven.as_ref().map(proven_text), ..page }
}

/// The picture of an answer in the plane, for browsers that cannot draw.
fn still(answer: &Answer) -> Result<Option<Drawing>, Error> {
    if answer.model().mesh().dimension() != 2 {
        return Ok(None);
    }
    PlaneScene::new(answer, answer.model().title().to_string())?.draw().map(Some)
}

/// A report without its seconds: the same question makes the same page, byte by byte.
fn timeless(mut report: Value) -> Value {
    match &mut report {
        Value::Object(fields) => {
            fields.remove("seconds");
            fields.values_mut().for_each(|value| *value = timeless(value.take()));
        }
        Value::Array(values) => values.iter_mut().for_each(|value| *value = timeless(value.take())),
        _ => {}
    }
    report
}

fn value(of: &(impl Serialize + ?Sized)) -> Result<Value, Error> {
    let failed = |error: serde_json::Error| Error::Numerical { step: "writing JSON", reason: error.to_string() };
    serde_json::to_value(of).map_err(failed)
}
