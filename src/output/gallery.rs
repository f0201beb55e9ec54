//! What `--out` leaves in a folder: answers, fields and pictures of a scene.

use std::path::Path;
use std::sync::Arc;

use super::fields::fields;
use super::iterations::iterations;
use super::tables;
use super::{
    ContactPicture, ObstacleLine, Plot, Quantity, Series, common_limits, common_window, line_plots, ticks::brief,
    write_atomically, write_files, write_picture,
};
use crate::error::Error;
use crate::qp::matrix_market::solution_files;
use crate::scene::{Answer, Model};
use crate::solution::{ContactSet, Iteration, Solution};
use crate::study::{Summary, Sweep, SweepCorner, SweepPoint};

/// Pieces of the line of an obstacle.
const OUTLINE_SEGMENTS: usize = 200;

/// Writes `u.mtx` and `lambda.mtx`; of a scene what their entries are those of, and what happens at each row (`dofs.csv`, `rows.csv`,
/// `contact.csv`).
///
/// # Errors
/// [`Error::File`].
pub fn write_answer(folder: &Path, solution: &Solution, answer: Option<&Answer>) -> Result<(), Error> {
    write_files(folder, &solution_files(solution))?;
    let Some(answer) = answer else { return Ok(()) };
    write_files(folder, &tables::of_model(answer.model()))?;
    write_files(folder, &[("contact.csv", tables::contact(answer))])
}

/// Writes the fields of an answer (`solution.vtu`), its picture (`contact`) and one picture for each iteration
/// (`iteration-1`, ...), as long as these are no more than twelve. A bar and a body in space have no pictures.
///
/// # Errors
/// [`Error::File`], and those of the recovery of stresses.
pub fn write_solve(folder: &Path, answer: &Answer, history: &[Iteration]) -> Result<(), Error> {
    write_atomically(&folder.join("solution.vtu"), fields(answer, None)?.as_bytes())?;
    let model = answer.model();
    if !is_plane(model) {
        return Ok(());
    }
    let title = format!("{}, {}", headline(model, "the answer"), closed_nodes(answer.contact_set()));
    draw_series(folder, &[("contact".to_string(), Scene::new(answer, title)?)])?;
    write_iterations(folder, model, history)
}

/// Returns `true` if the model has a picture in the plane.
fn is_plane(model: &Model) -> bool {
    model.mesh().dimension() == 2
}

/// One picture for each set of the history, the displacement being that with the rows of the set held at their gaps.
fn write_iterations(folder: &Path, model: &Arc<Model>, history: &[Iteration]) -> Result<(), Error> {
    let mut series = Vec::new();
    for (number, shown) in iterations(model, history)? {
        let what = format!("search for contact segments, iteration {number}");
        let title = format!("{}, {}", headline(model, &what), closed_nodes(shown.contact_set()));
        series.push((format!("iteration-{number}"), Scene::new(&shown, title)?));
    }
    draw_series(folder, &series)
}

/// Draws the answer of the QP as [`write_solve`] does, with the iterations of the active-set loop, and the pressure of
/// the three methods over the boundary (`pressure`).
///
/// # Errors
/// As [`write_solve`].
pub fn write_compare(folder: &Path, answers: &[Answer; 3], summaries: &[Summary; 3]) -> Result<(), Error> {
    let [_, active_set, _] = summaries;
    write_solve(folder, &answers[0], &active_set.solution.history)?;
    let model = answers[0].model();
    if !is_plane(model) {
        return Ok(());
    }
    let mut plots = Vec::new();
    for obstacle in 0..model.obstacles().len() {
        let mut series = Vec::new();
        for (answer, Summary { solution, .. }) in answers.iter().zip(summaries) {
            series.push(Series::new(solution.method.clone(), pressure_line(answer, obstacle)));
        }
        if series[0].points.is_empty() {
            continue;
        }
        let units = model.units();
        let along = ["x", "y"][along_axis(model, obstacle)];
        let pressure = Quantity::new("contact pressure p", units.pressure());
        let mut plot = Plot::new(Quantity::new(along, &units.length), pressure, series);
        plot.nested = true;
        if model.obstacles().len() > 1 {
            plot.title = format!("obstacle {} on {}", obstacle + 1, model.obstacles()[obstacle].boundary());
        }
        plots.push(plot);
    }
    if !plots.is_empty() {
        write_picture(folder, "pressure", &line_plots(&headline(model, "three methods"), &plots))?;
    }
    Ok(())
}

/// Writes one picture for each gap (`gap-01`, ...), with common colours and scale, and force, contact width (outside
/// plane strain and plane stress, area) and peak pressure over the gap (`force-width`).
///
/// # Errors
/// As [`write_solve`].
pub fn write_sweep(folder: &Path, sweep: &Sweep) -> Result<(), Error> {
    let points = &sweep.points;
    let mut series = Vec::new();
    for (index, SweepPoint { answer, .. }) in
        points.iter().enumerate().filter(|(_, point)| is_plane(point.answer.model()))
    {
        let title = format!("{}, {}", headline(answer.model(), ""), closed_nodes(answer.contact_set()));
        let name = if points[index].force.is_some() { "force" } else { "gap" };
        series.push((format!("{name}-{:02}", index + 1), Scene::new(answer, title)?));
    }
    draw_series(folder, &series)?;
    let Some(first) = points.first() else { return Ok(()) };
    let units = first.answer.model().units();
    let (swept, swept_in) = match first.force {
        Some(_) => ("force F", &units.force),
        None => ("gap g", &units.length),
    };
    let over_gap = |name: &str, unit: &str, at_point: Value<SweepPoint>, at_corner: Value<SweepCorner>| {
        // Beside the exact path the gaps are marks, which no line may join.
        let join = if sweep.corners.is_empty() { None } else { Some([f64::NAN; 2]) };
        let at = |point: &SweepPoint| [point.force.unwrap_or(point.gap), at_point(point)];
        let at_points = points.iter().flat_map(|point| [Some(at(point)), join]).flatten().collect();
        let exact = sweep.corners.iter().map(|corner| [corner.gap, at_corner(corner)]).collect::<Vec<_>>();
        let marks = if first.force.is_some() { "forces of the sweep" } else { "gaps of the sweep" };
        let mut series = vec![Series::new(marks, at_points)];
        if !exact.is_empty() {
            series.insert(0, Series::new("exact path", exact));
        }
        let mut plot = Plot::new(Quantity::new(swept, swept_in), Quantity::new(name, unit), series);
        plot.nested = true;
        plot
    };
    let contact = |point: &SweepPoint| point.summary.contact.clone();
    let extent = if first.summary.contact.width.is_some() {
        let width = |point: &SweepPoint| contact(point).width.unwrap_or(0.0);
        over_gap("contact width", &units.length, &width, &|corner| corner.width.unwrap_or(0.0))
    } else {
        let area = |point: &SweepPoint| contact(point).area.unwrap_or(0.0);
        over_gap("contact area", &format!("{}²", units.length), &area, &|corner| corner.area)
    };
    let force_or_travel = match first.force {
        Some(_) => over_gap("travel d", &units.length, &|point| point.travel().unwrap_or(0.0), &|_| 0.0),
        None => over_gap("sum of multipliers", &units.force, &|point| contact(point).force, &|corner| corner.force),
    };
    let plots = [
        force_or_travel,
        extent,
        over_gap("peak pressure", &units.pressure(), &|p| contact(p).pressure_max.unwrap_or(0.0), &|c| c.pressure_max),
    ];
    write_picture(folder, "force-width", &line_plots(first.answer.model().title(), &plots))?;
    Ok(())
}

/// A number of something that is plotted.
type Value<'a, T> = &'a dyn Fn(&T) -> f64;

fn headline(model: &Model, what: &str) -> String {
    let gap = match model.pressing_force() {
        Some(force) => format!("force {} {}", brief(force), model.units().force),
        None => format!("gap {} {}", brief(model.gap()), model.units().length),
    };
    let parts = [model.title(), gap.trim_end(), what];
    parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ")
}

fn closed_nodes(set: &ContactSet) -> String {
    match set.count() {
        1 => "1 closed node".to_string(),
        count => format!("{count} closed nodes"),
    }
}

/// The axis along which the candidates of an obstacle lie: across its approach direction.
fn along_axis(model: &Model, obstacle: usize) -> usize {
    usize::from(model.obstacles()[obstacle].approach()[0] != 0.0)
}

/// Points [position along the boundary, pressure] of one obstacle.
fn pressure_line(answer: &Answer, obstacle: usize) -> Vec<[f64; 2]> {
    let model = answer.model();
    let axis = along_axis(model, obstacle);
    let rows = model.rows().iter().zip(answer.pressure()).filter(|(row, _)| row.obstacle == obstacle);
    let mut line: Vec<[f64; 2]> =
        rows.map(|(row, &pressure)| [model.mesh().nodes()[row.node][axis], pressure]).collect();
    line.sort_by(|a, b| a[0].total_cmp(&b[0]));
    line
}

/// What one picture shows, as plain data that it owns.
pub(super) struct Scene {
    title: String,
    length_unit: String,
    stress_unit: String,
    nodes: Vec<[f64; 2]>,
    elements: Vec<Vec<usize>>,
    displacement: Vec<f64>,
    field: Vec<f64>,
    outlines: Vec<(Vec<[f64; 2]>, [f64; 2])>,
    candidates: Vec<usize>,
    closed: Vec<bool>,
}

impl Scene {
    pub(super) fn new(answer: &Answer, title: String) -> Result<Self, Error> {
        let (model, set) = (answer.model(), answer.contact_set());
        let candidates: Vec<usize> = {
            let mut nodes: Vec<usize> = model.rows().iter().map(|row| row.node).collect();
            nodes.sort_unstable();
            nodes.dedup();
            nodes
        };
        let closed_nodes: Vec<usize> = set.iter().map(|row| model.rows()[row].node).collect();
        let outline = |i: usize| {
            let [x, y, _] = model.obstacles()[i].approach();
            (model.obstacles()[i].outline(answer.shift(i), OUTLINE_SEGMENTS), [x, y])
        };
        let corners = model.mesh().kind().corners();
        Ok(Scene {
            title,
            length_unit: model.units().length.clone(),
            stress_unit: model.units().pressure(),
            nodes: model.mesh().nodes().iter().map(|&[x, y, _]| [x, y]).collect(),
            elements: model.mesh().elements().map(|nodes| nodes[..corners].to_vec()).collect(),
            displacement: answer.displacement().to_vec(),
            field: answer.stress()?.nodes.iter().map(|stress| stress.sigma_2).collect(),
            outlines: (0..model.obstacles().len())
                .filter(|&i| model.obstacles()[i].rigid().is_some())
                .map(outline)
                .collect(),
            closed: candidates.iter().map(|node| closed_nodes.contains(node)).collect(),
            candidates,
        })
    }

    /// The same with the body where it has moved to in both panels: for one that flies.
    pub(super) fn in_place(mut self) -> Self {
        for (node, moved) in self.nodes.iter_mut().zip(self.displacement.chunks_exact(2)) {
            *node = [node[0] + moved[0], node[1] + moved[1]];
        }
        self.displacement.fill(0.0);
        self
    }

    pub(super) fn field(&self) -> &[f64] {
        &self.field
    }

    pub(super) fn obstacles(&self) -> Vec<ObstacleLine<'_>> {
        self.outlines.iter().map(|(points, inside)| ObstacleLine { points, inside: *inside }).collect()
    }

    pub(super) fn picture<'a>(&'a self, obstacles: &'a [ObstacleLine<'a>]) -> ContactPicture<'a> {
        ContactPicture {
            title: &self.title,
            length_unit: &self.length_unit,
            nodes: &self.nodes,
            elements: &self.elements,
            displacement: &self.displacement,
            magnification: 1.0,
            field: &self.field,
            quantity: Quantity::new("σ₂, second principal stress", &self.stress_unit),
            limits: [f64::NAN; 2],
            obstacles,
            candidates: &self.candidates,
            closed: &self.closed,
            window: None,
        }
    }
}

/// Draws a series with common colour limits and a common window.
fn draw_series(folder: &Path, series: &[(String, Scene)]) -> Result<(), Error> {
    let limits = common_limits(series.iter().map(|(_, scene)| &scene.field[..]));
    let obstacles: Vec<_> = series.iter().map(|(_, scene)| scene.obstacles()).collect();
    let pictures: Vec<_> = series.iter().zip(&obstacles).map(|((_, scene), lines)| scene.picture(lines)).collect();
    let window = common_window(pictures.iter().map(ContactPicture::window));
    for ((stem, _), mut picture) in series.iter().zip(pictures) {
        picture.limits = limits;
        picture.window = Some(window);
        write_picture(folder, stem, &picture.draw()?)?;
    }
    Ok(())
}
