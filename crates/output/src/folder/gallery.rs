//! The output of `--out` in a folder: answers, fields and pictures of a scene.

use std::path::Path;

use super::fields::fields;
use super::tables;
use crate::file::{write_atomically, write_files, write_streamed};
use crate::picture::plane_scene::{PlaneScene, draw_series};
use crate::picture::space_scene::{SpaceScene, draw_space_series};
use crate::plots::medium::Medium;
use crate::plots::plot::line_plots_for;
use crate::reports::report::plural;
use crate::view::curves::sweep_plots;
use crate::view::field::Source;
use crate::view::iterations::iterations;
use crate::view::pressure::pressure_plots;
use crate::view::words::headline;
use signorini_mechanics::Error;
use signorini_mechanics::scene::{Answer, Model};
use signorini_qp::{ContactSet, Iteration, Solution};
use signorini_study::{Summary, Sweep, SweepPoint};

/// The pictures that a command draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pictures {
    /// No picture.
    None,
    /// The picture of the answer: one for each command.
    Answer,
    /// The pictures of iterations and gaps as well.
    All,
}

impl Pictures {
    /// The default pictures of a comparison or a sweep of a model: all pictures in the plane, and one in space, because
    /// there each step takes its own solve.
    pub fn usual_of_series(model: &Model) -> Self {
        if model.mesh().dimension() == 3 { Pictures::Answer } else { Pictures::All }
    }
}

/// The pictures that a command draws, and their medium.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// Which pictures.
    pub pictures: Pictures,
    /// Their file format.
    pub medium: Medium,
}

/// Bytes of an unknown in the picture of an answer, beside the answer: its nodal stresses and its displaced cells.
const OF_PICTURE: f64 = 150.0;

impl Wanted {
    /// Bytes of `count` pictures with common colours, which are drawn together, of answers with `dofs` unknowns each.
    pub fn bytes(count: f64, dofs: f64) -> f64 {
        OF_PICTURE * count * dofs
    }
}

/// Draws answers of one mesh, each with its name and title, with the colours and the scale of the first `leading`
/// answers.
fn draw_answers(
    folder: &Path,
    shown: Vec<(String, &Answer, String)>,
    leading: usize,
    medium: Medium,
) -> Result<(), Error> {
    match shown.first().map(|(_, answer, _)| answer.model().mesh().dimension()) {
        Some(2) => {
            let scenes = shown.into_iter().map(|(name, answer, title)| Ok((name, PlaneScene::new(answer, title)?)));
            draw_series(folder, &scenes.collect::<Result<Vec<_>, Error>>()?, leading, medium)
        }
        Some(3) => {
            let scenes = shown.into_iter().map(|(name, answer, title)| Ok((name, SpaceScene::new(answer, title)?)));
            draw_space_series(folder, &scenes.collect::<Result<Vec<_>, Error>>()?, leading, medium)
        }
        _ => Ok(()),
    }
}

/// The title: the scene, its state, the content of the picture unless it is the answer, and the number of closed nodes.
fn title(answer: &Answer, what: &str) -> String {
    let model = answer.model();
    let parts = [headline(model), what.to_string(), closed_nodes(model, answer.contact_set())];
    parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ")
}

/// The number of closed nodes in the legend: a node between two obstacles counts once.
fn closed_nodes(model: &Model, set: &ContactSet) -> String {
    let mut nodes: Vec<usize> = set.iter().map(|row| model.rows()[row].node).collect();
    nodes.sort_unstable();
    nodes.dedup();
    plural(nodes.len(), "closed node") + model.of_part()
}

impl Wanted {
    /// Writes the fields of an answer (`solution.vtu`) and its picture (`contact`); with all pictures also one for each
    /// iteration (`iteration-1`, ...) or each penalty (`rung-1`, ...), at most twelve. A bar has no picture.
    ///
    /// # Errors
    /// [`qp::LinearError::File`](signorini_qp::LinearError::File), and those of the recovery of stresses.
    pub fn write_solve(self, folder: &Path, answer: &Answer, history: &[Iteration]) -> Result<(), Error> {
        write_atomically(&folder.join("solution.vtu"), fields(&Source { answer, velocity: None })?.as_bytes())?;
        let (model, Wanted { pictures, medium }) = (answer.model(), self);
        if pictures == Pictures::None {
            return Ok(());
        }
        let steps = if pictures == Pictures::All { iterations(model, history)? } else { Vec::new() };
        let mut shown = vec![("contact".to_string(), answer, title(answer, ""))];
        shown.extend(steps.iter().map(|step| (step.name.clone(), &step.answer, title(&step.answer, &step.what))));
        draw_answers(folder, shown, 1, medium)
    }
}

impl Wanted {
    /// Draws the answer of the QP as [`write_solve`](Self::write_solve) does, with the iterations of the active-set
    /// loop, and the pressure of the three methods over the boundary (`pressure`).
    ///
    /// # Errors
    /// As [`write_solve`](Self::write_solve).
    pub fn write_compare(self, folder: &Path, answers: &[Answer; 3], summaries: &[Summary; 3]) -> Result<(), Error> {
        let [_, active_set, _] = summaries;
        self.write_solve(folder, &answers[0], &active_set.solution.history)?;
        let model = answers[0].model();
        if model.mesh().dimension() != 2 || self.pictures == Pictures::None {
            return Ok(());
        }
        let plots = pressure_plots(answers, summaries);
        if !plots.is_empty() {
            let title = format!("{}, contact pressure of three methods", headline(model));
            line_plots_for(self.medium, &title, &plots).write(folder, "pressure")?;
        }
        Ok(())
    }
}

impl Wanted {
    /// Writes `u.mtx` and `lambda.mtx`; for a scene also the meaning of their entries (`dofs.csv`, `rows.csv`) and the
    /// state of each contact row (`contact.csv`).
    ///
    /// # Errors
    /// [`qp::LinearError::File`](signorini_qp::LinearError::File).
    pub fn write_answer(folder: &Path, solution: &Solution, answer: Option<&Answer>) -> Result<(), Error> {
        write_files(folder, &solution.files())?;
        let Some(answer) = answer else { return Ok(()) };
        write_streamed(folder, &tables::of_model(answer.model()))?;
        write_files(folder, &[("contact.csv", tables::contact(answer))])
    }
}

impl Wanted {
    /// Writes one picture for each gap (`gap-01`, ...), with common colours and scale, and force, contact width
    /// (outside plane strain and plane stress, area) and peak pressure over the gap (`force-width`); of each obstacle,
    /// if there are several.
    ///
    /// # Errors
    /// As [`write_solve`](Self::write_solve).
    pub fn write_sweep(self, folder: &Path, sweep: &Sweep) -> Result<(), Error> {
        let Wanted { pictures, medium } = self;
        let points = &sweep.points;
        if pictures == Pictures::None {
            return Ok(());
        }
        let drawn = if pictures == Pictures::All { &points[..] } else { &[] };
        let name = |(index, point): (usize, &SweepPoint)| {
            format!("{}-{:02}", if point.force.is_some() { "force" } else { "gap" }, index + 1)
        };
        let shown: Vec<(String, &Answer, String)> =
            drawn.iter().enumerate().map(|of| (name(of), &of.1.answer, title(&of.1.answer, ""))).collect();
        draw_answers(folder, shown, drawn.len(), medium)?;
        let Some(first) = points.first() else { return Ok(()) };
        let plots = sweep_plots(sweep);
        line_plots_for(medium, first.answer.model().title(), &plots).write(folder, "force-width").map(drop)
    }
}
