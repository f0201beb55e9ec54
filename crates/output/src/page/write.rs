//! One page for each command that answers a scene.

use std::path::Path;

use serde::Serialize;
use serde_json::{Value, json};
use signorini_qp as qp;

use super::about::About;
use super::along::AlongShown;
use super::body::Shape;
use super::html::write_page;
use super::model::Page;
use super::modes::modes_shown;
use super::motion::{MotionFrames, MotionShown};
use super::packed::Packer;
use super::plots::PlotShown;
use super::rows::Contact;
use super::search::Search;
use super::state::State;
use super::sweep::SweepShown;
use crate::draw::drawing::Drawing;
use crate::picture::mesh_series::meshes_picture;
use crate::picture::plane_scene::PlaneScene;
use crate::reports::certificate::CertificateWords;
use crate::reports::means::means_text;
use crate::reports::report::proven_text;
use crate::view::along::Along;
use crate::view::curves::{error_plot, history_plots, sweep_plots};
use signorini_mechanics::Error;
use signorini_mechanics::scene::{Answer, ModalAnalysis, Model, Units};
use signorini_qp::Iteration;
use signorini_study::{Agreement, Summary, Sweep, TotalError};

impl About {
    /// The page of one answer to a scene, with the answer along lines.
    ///
    /// # Errors
    /// [`qp::LinearError::File`], and those of the recovery of stresses.
    pub fn write_answer(
        &self,
        folder: &Path,
        (answer, along): (&Answer, &[Along]),
        summary: &Summary,
    ) -> Result<(), Error> {
        let (mut packer, shape) = (Packer::default(), Shape::with_inside(answer.model()));
        let page = of_answer(self, answer, summary, &summary.solution.history, (&shape, &mut packer))?;
        let along = along.iter().map(|along| AlongShown::of(along, answer.model(), &mut packer)).collect();
        let page = Page { report: timeless(value(summary)?), along, ..page };
        write_page(folder, &page, packer, still(answer)?.as_ref())
    }

    /// The page of an answer to a problem directory, which has no body to draw.
    ///
    /// # Errors
    /// [`qp::LinearError::File`].
    pub fn write_problem(&self, folder: &Path, summary: &Summary) -> Result<(), Error> {
        let page = Page { report: timeless(value(summary)?), ..judged(Page::new(self, &Units::unnamed()), summary) };
        write_page(folder, &page, Packer::default(), None)
    }

    /// The page of three methods: the answer of the QP, the search of the active set, the pressures of all.
    ///
    /// # Errors
    /// As [`write_answer`](Self::write_answer).
    pub fn write_comparison(
        &self,
        folder: &Path,
        answers: &[Answer; 3],
        summaries: &[Summary; 3],
        agreement: &Agreement,
    ) -> Result<(), Error> {
        let (mut packer, shape) = (Packer::default(), Shape::of(answers[0].model()));
        let history = &summaries[1].solution.history;
        let page = of_answer(self, &answers[0], &summaries[0], history, (&shape, &mut packer))?;
        let pressures = answers.iter().map(|answer| packer.exact(answer.pressure(), 1)).collect();
        let report = json!({ "methods": timeless(value(summaries)?), "agreement": value(agreement)? });
        write_page(folder, &Page { report, pressures, ..page }, packer, still(&answers[0])?.as_ref())
    }

    /// The page of a sweep; if the exact path is known, it shows every gap between the first and the last.
    ///
    /// # Errors
    /// As [`write_answer`](Self::write_answer), and those of the solves at the corners of the path.
    pub fn write_sweep(&self, folder: &Path, sweep: &Sweep) -> Result<(), Error> {
        let Some(first) = sweep.points.first() else { return Ok(()) };
        let (mut packer, shape) = (Packer::default(), Shape::of(first.answer.model()));
        let page = Page::of_model(self, first.answer.model(), &shape, &mut packer);
        let (shown, states) = SweepShown::of(sweep, &shape, &mut packer)?;
        let plots = sweep_plots(sweep).iter().map(|plot| PlotShown::of(plot, &mut packer)).collect();
        write_page(folder, &Page { sweep: Some(shown), states, plots, ..page }, packer, still(&first.answer)?.as_ref())
    }

    /// The page of the derivatives of outputs: `report` is the object of `report.json`.
    ///
    /// # Errors
    /// As [`write_answer`](Self::write_answer).
    pub fn write_sensitivity(
        &self,
        folder: &Path,
        (answer, summary): (&Answer, &Summary),
        report: &impl Serialize,
    ) -> Result<(), Error> {
        let (mut packer, shape) = (Packer::default(), Shape::with_inside(answer.model()));
        let page = of_answer(self, answer, summary, &summary.solution.history, (&shape, &mut packer))?;
        write_page(folder, &Page { report: timeless(value(report)?), ..page }, packer, still(answer)?.as_ref())
    }

    /// The page of natural vibrations about an equilibrium: `report` is the object of `report.json`.
    ///
    /// # Errors
    /// As [`write_answer`](Self::write_answer).
    pub fn write_modes(
        &self,
        folder: &Path,
        (found, summary): (&ModalAnalysis, Option<&Summary>),
        report: &impl Serialize,
    ) -> Result<(), Error> {
        let (mut packer, shape, answer) = (Packer::default(), Shape::of(found.answer.model()), &found.answer);
        let page = match summary {
            Some(summary) => of_answer(self, answer, summary, &summary.solution.history, (&shape, &mut packer))?,
            None => Page::of_model(self, answer.model(), &shape, &mut packer),
        };
        let modes = modes_shown(found, &shape, &mut packer)?;
        write_page(folder, &Page { report: timeless(value(report)?), modes, ..page }, packer, still(answer)?.as_ref())
    }

    /// The page of a trade-off with its pictures.
    ///
    /// # Errors
    /// [`qp::LinearError::File`].
    pub fn write_tradeoff<'a>(
        &self,
        folder: &Path,
        measured: &impl Serialize,
        stills: impl IntoIterator<Item = &'a Drawing>,
    ) -> Result<(), Error> {
        let page = Page { report: value(measured)?, ..Page::new(self, &Units::unnamed()) };
        write_page(folder, &page, Packer::default(), stills)
    }

    /// The page of an error against the continuum: the question, the answer on the last mesh if there is one, and the
    /// decrease of the error from mesh to mesh as a plot, with the picture of the meshes.
    ///
    /// # Errors
    /// As [`write_answer`](Self::write_answer).
    pub fn write_total_error(
        &self,
        folder: &Path,
        (first, answer): (&Model, Option<&(Answer, Summary)>),
        report: &impl Serialize,
        found: &TotalError,
    ) -> Result<(), Error> {
        let mut packer = Packer::default();
        let page = match answer {
            Some((answer, summary)) => {
                let shape = Shape::of(answer.model());
                of_answer(self, answer, summary, &summary.solution.history, (&shape, &mut packer))?
            }
            None => Page::of_model(self, first, &Shape::of(first), &mut packer),
        };
        let plots = vec![PlotShown::of(&error_plot(found), &mut packer)];
        let meshes = meshes_picture(first.title(), found, first.units());
        write_page(folder, &Page { report: timeless(value(report)?), plots, ..page }, packer, meshes.as_ref())
    }
}

/// The page of a motion; `report` is the object of `report.json`.
pub(crate) fn write_motion_page(
    folder: &Path,
    about: &About,
    model: &Model,
    report: &impl Serialize,
    frames: &MotionFrames,
) -> Result<(), Error> {
    let (mut packer, shape) = (Packer::default(), Shape::of(model));
    let page = Page::of_model(about, model, &shape, &mut packer);
    let (motion, states) = MotionShown::of(frames, &shape, model.mesh().dimension(), &mut packer)?;
    let plots = history_plots(model, frames.history).iter().map(|plot| PlotShown::of(plot, &mut packer)).collect();
    write_page(
        folder,
        &Page { report: timeless(value(report)?), motion: Some(motion), states, plots, ..page },
        packer,
        None,
    )
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
    let proven = summary.solution.proven.as_ref().map(proven_text);
    Page { certificate, proven, means: means_text(&summary.contact), ..page }
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
    let failed =
        |error: serde_json::Error| qp::LinearError::Numerical { step: "writing JSON", reason: error.to_string() };
    Ok(serde_json::to_value(of).map_err(failed)?)
}
