//! An answer with its error against the continuum, guaranteed or estimated: report, fields, meshes.

use std::path::Path;

use super::gallery::{Pictures, Wanted};
use super::msh::msh;
use super::vtu::{Array, Unstructured};
use crate::file::write_files;
use crate::picture::mesh_series::meshes_picture;
use crate::plots::plot::line_plots_for;
use crate::reports::in_words::InWords;
use crate::reports::report::{
    Column, columns, comma_separated, entries, entry, of_part, plural, quantity, solve_text, table, warnings_text,
    wrapped,
};
use crate::text::printable;
use crate::view::curves::error_plot;
use signorini_mechanics::Error;
use signorini_mechanics::fem::{ElasticBody, ElementKind, Mesh};
use signorini_mechanics::scene::Units;
use signorini_study::{ContinuumAnswer, Domain, Ended, Guarantee, Level, LevelKind, Summary, TotalError};

/// The report: the error, the refinement of the mesh, then the answer on the last mesh.
fn total_error_text(title: &str, found: &TotalError, answer: Option<&Summary>, units: &Units) -> String {
    let mut text = format!("{}\n", printable(title));
    let (bound, goal) = (found.total_error.bound, found.goal.total_error);
    let depth = found.levels.last().and_then(Level::depth_between_nodes);
    let words = if found.total_error.guaranteed { "guaranteed at most" } else { "estimated" };
    let verdict_on_error = verdict(bound.max(depth.unwrap_or(0.0)), goal);
    text += &entry("total error", &format!("{words} {}, {verdict_on_error}", percent(bound)));
    text += &entry("", "of the displacement, against the continuum, in the energy norm");
    if let Some(guarantee) = &found.guarantee {
        text += &entry(
            "",
            &format!("guaranteed at most {} for the mean stress", percent(guarantee.mean_stress_error.bound)),
        );
        text +=
            &entries("contact force", force_lines(guarantee, found.levels.last().and_then(Level::half_width), units));
        if let Some(wanted) = found.goal.force_error {
            let half = found.levels.last().and_then(Level::half_width).unwrap_or(f64::INFINITY);
            text += &entry("", &verdict(half, wanted));
        }
    }
    if let Some(depth) = depth {
        let deepest =
            format!("the deepest place between nodes lies {} of the indentation inside an obstacle", percent(depth));
        text += &entry("", &deepest);
    }
    for (number, line) in found.reason.iter().flat_map(|reason| wrapped(&format!("no guarantee: {reason}"))).enumerate()
    {
        text += &entry("", if number == 0 { line.clone() } else { format!("  {line}") }.as_str());
    }
    if let Some(last) = found.levels.last() {
        let meshes = plural(found.levels.len(), "mesh").replace("meshs", "meshes");
        let elements = found.name_of_elements();
        let of_stress = match last.kind {
            LevelKind::Guaranteed { stress_dofs, .. } => format!(", and {stress_dofs} of the stress"),
            LevelKind::Estimated { .. } => String::new(),
        };
        let of_part = answer.map_or("", of_part);
        let sizes = format!("{} {elements}, {} unknowns{of_stress}{of_part}", last.elements, last.dofs);
        text += &entry("mesh", &format!("{meshes}; the last: {sizes}"));
    }
    if let Some(guarantee) = &found.guarantee {
        text += &of_meshes(guarantee, found.last.as_ref().err());
    }
    text += &ended_text(found);
    if let Some(guarantee) = &found.guarantee {
        text += &warnings_text(&guarantee.warnings);
    }
    let lines: String = columns(&levels_table(found)).lines().map(|line| format!("  {line}\n")).collect();
    text += &(entry("seconds", &format!("{:.3}", found.seconds)) + "\n" + &lines);
    let Some(answer) = answer else { return text };
    if answer.parts_of_whole.is_some() {
        text += "  total error and force are of the whole body, all other columns of the meshed part\n";
    }
    text + "\n" + &solve_text(&format!("The answer on the last mesh: {title}"), answer, units)
}

/// What is proven on the scene's own mesh and on the last, with the check and the body for which it holds.
fn of_meshes(guarantee: &Guarantee, no_answer: Option<&String>) -> String {
    let mut text = String::new();
    if let Some(own) = &guarantee.own_mesh {
        let bound = percent(own.total_error.bound);
        text += &entry("own mesh", &format!("{} of {} unknowns: guaranteed at most {bound}", own.element, own.dofs));
        text += &entry("", &format!("(estimated {})", percent(own.estimated)));
    }
    match (&guarantee.last_mesh, no_answer) {
        (Some(last), _) => {
            let bound = percent(last.total_error.bound);
            text += &entry(
                "last mesh",
                &format!("its answer, below, of {} unknowns: guaranteed at most {bound}", last.dofs),
            );
            text += &entry("", &format!("(estimated {})", percent(last.estimated)));
        }
        (None, Some(reason)) => text += &entries("last mesh", wrapped(&format!("no answer on it: {reason}"))),
        (None, None) => {}
    }
    text += &entry("check", &format!("balance, signs, distances and energies agree to {:.1e}", guarantee.defect));
    let domain = match guarantee.domain {
        Domain::FirstPolygon => "the polygon of the first mesh: a curved side is that of its straight edges",
        Domain::LastPolygon => "the polygon of the last mesh: new nodes lie on the circles of the body",
        Domain::FirstPolyhedron => "the polyhedron of the first mesh, whose edges are straight",
    };
    text += &entry("domain", domain);
    text + &entry("not bounded", "peak pressure, width, and stresses at a place")
}

/// Why no finer mesh was made, and what the goal would need.
fn ended_text(found: &TotalError) -> String {
    let short = match found.ended {
        Ended::Goal => return String::new(),
        Ended::Mesh => {
            return entry("ended", "a mesh from a file cannot be refined here; mesh the body with smaller cells");
        }
        Ended::Time => "no time for a finer mesh",
        Ended::Memory => "no memory for a finer mesh",
    };
    let next = found.guarantee.as_ref().and_then(|guarantee| guarantee.next_elements);
    let next = next.map_or(String::new(), |count| format!(", of {count} {}", found.name_of_elements()));
    let errors: Vec<[f64; 2]> = found.levels.iter().map(|level| [level.dofs as f64, level.total_error]).collect();
    entry("ended", &format!("{short}{next}; {}", needed(&errors, found.goal.total_error)))
}

/// Unknowns of the stress, and the error of the mean stress.
fn of_bound(level: &Level) -> (usize, f64) {
    match level.kind {
        LevelKind::Guaranteed { stress_dofs, mean_stress_error, .. } => (stress_dofs, mean_stress_error),
        LevelKind::Estimated { .. } => (0, f64::NAN),
    }
}

/// Contact rows, method, the error of the mesh and that of the algebra.
fn of_estimate(level: &Level) -> (usize, &str, [f64; 2]) {
    match &level.kind {
        LevelKind::Estimated { contact_rows, method, discretisation_error, energy_error_bound, .. } => {
            (*contact_rows, method, [*discretisation_error, *energy_error_bound])
        }
        LevelKind::Guaranteed { .. } => (0, "", [f64::NAN; 2]),
    }
}

/// The numbers of each mesh for reading.
fn levels_table(found: &TotalError) -> Vec<Vec<String>> {
    let elements: Column<Level> = (found.name_of_elements(), &|level| level.elements.to_string());
    let unknowns: Column<Level> = ("unknowns", &|level| level.dofs.to_string());
    let error: Column<Level> = ("total error", &|level| format!("{:.2e}", level.total_error));
    let force: Column<Level> = ("force", &|level| format!("{:.6e}", level.contact_force));
    let seconds: Column<Level> = ("seconds", &|level| format!("{:.3}", level.seconds));
    let columns: &[Column<Level>] = match found.total_error.guaranteed {
        true => &[
            elements,
            unknowns,
            ("of the stress", &|level| of_bound(level).0.to_string()),
            error,
            ("mean stress", &|level| format!("{:.2e}", of_bound(level).1)),
            force,
            ("force within", &|level| level.half_width().map_or("-".into(), |half| format!("{half:.1e}"))),
            seconds,
        ],
        false => &[
            elements,
            unknowns,
            ("rows", &|level| of_estimate(level).0.to_string()),
            ("method", &|level| of_estimate(level).1.to_string()),
            error,
            ("of the algebra", &|level| format!("{:.1e}", of_estimate(level).2[1])),
            ("depth", &|level| format!("{:.1e}", level.depth_between_nodes().unwrap_or(0.0))),
            force,
            seconds,
        ],
    };
    table(&found.levels, columns)
}

/// The numbers of each mesh for programs, under the names of the report in JSON.
fn csv(found: &TotalError) -> String {
    let end = |level: &Level, end: usize| level.force_interval().map_or_else(String::new, |ends| ends[end].to_string());
    let elements: Column<Level> = ("elements", &|level| level.elements.to_string());
    let dofs: Column<Level> = ("dofs", &|level| level.dofs.to_string());
    let error: Column<Level> = ("total_error", &|level| level.total_error.to_string());
    let force: Column<Level> = ("contact_force", &|level| level.contact_force.to_string());
    let seconds: Column<Level> = ("seconds", &|level| level.seconds.to_string());
    let (low, high) = (|level: &Level| end(level, 0), |level: &Level| end(level, 1));
    let columns: &[Column<Level>] = match found.total_error.guaranteed {
        true => &[
            elements,
            dofs,
            error,
            force,
            ("stress_dofs", &|level| of_bound(level).0.to_string()),
            ("mean_stress_error", &|level| of_bound(level).1.to_string()),
            ("force_low", &low),
            ("force_high", &high),
            seconds,
        ],
        false => &[
            elements,
            dofs,
            error,
            force,
            ("contact_rows", &|level| of_estimate(level).0.to_string()),
            ("method", &|level| of_estimate(level).1.to_string()),
            ("discretisation_error", &|level| of_estimate(level).2[0].to_string()),
            ("energy_error_bound", &|level| of_estimate(level).2[1].to_string()),
            ("depth_between_nodes", &|level| level.depth_between_nodes().unwrap_or(0.0).to_string()),
            seconds,
        ],
    };
    comma_separated(&table(&found.levels, columns))
}

fn percent(share: f64) -> String {
    format!("{:.2e} %", 100.0 * share)
}

/// The statement that an error meets its goal or not.
fn verdict(error: f64, goal: f64) -> String {
    let is_met = if error <= goal { "within the goal" } else { "ABOVE the goal" };
    format!("{is_met} of {}", percent(goal))
}

/// The force and what carries it, then its interval.
fn force_lines(found: &Guarantee, half_width: Option<f64>, units: &Units) -> [String; 2] {
    if found.contact_force == 0.0 {
        return [
            "0: nothing touches".into(),
            "`signorini solve` without --total-error reports the smallest gap".into(),
        ];
    }
    let force = format!("{} {}", quantity(found.contact_force, &units.force), found.force_basis);
    [force.trim_end().into(), interval(found.force_interval, half_width)]
}

/// What is guaranteed about the force, given half the width of its interval over the force.
fn interval(interval: Option<[f64; 2]>, half_width: Option<f64>) -> String {
    match (interval, half_width) {
        (Some([low, high]), Some(half)) if half > 0.5 => {
            format!("the guaranteed interval, from {low:.0e} to {high:.0e}, is wider than the force: it tells nothing")
        }
        (Some([low, high]), Some(half)) => {
            format!("guaranteed between {low:.7e} and {high:.7e}: within {:.1e} %", 100.0 * half)
        }
        _ => "no guaranteed interval".into(),
    }
}

/// The unknowns that a goal would need, if the error falls with a power of the unknowns: from unknowns and error of
/// each level.
fn needed(levels: &[[f64; 2]], goal: f64) -> String {
    let [.., [dofs_before, before], [dofs, last]] = levels else {
        return "a second mesh is needed to estimate the unknowns for the goal".into();
    };
    let rate = (before / last).ln() / (dofs / dofs_before).ln();
    let more = (last / goal).powf(1.0 / rate);
    match rate > 0.0 && more.is_finite() {
        true => format!("the goal needs about {:.1e} unknowns", more.max(1.0) * dofs),
        false => "the last meshes do not give an estimate of the unknowns for the goal".into(),
    }
}

/// The mesh of all bodies, each by its name.
fn bodies(body: &ElasticBody) -> String {
    let named: Vec<_> = body
        .regions()
        .iter()
        .map(|region| (if region.name().is_empty() { "body" } else { region.name() }, region.elements()))
        .collect();
    msh(body.mesh(), &named)
}

/// The fields for ParaView: the displacement at the nodes, mean stress and share of the bound on elements.
fn fields(mesh: &Mesh, answer: &ContinuumAnswer) -> Result<String, Error> {
    let elements: Vec<Vec<usize>> = mesh.elements().map(<[usize]>::to_vec).collect();
    let kinds: Vec<ElementKind> = (0..elements.len()).map(|element| mesh.kind_of(element)).collect();
    let entry = |place: usize| -> Vec<f64> { answer.stress.iter().map(|stress| stress[place]).collect() };
    let [xx, yy, zz, xy, yz, zx] = [0, 1, 2, 3, 4, 5].map(entry);
    let mut of_cells = vec![Array::Scalars("mean_stress_xx", &xx), Array::Scalars("mean_stress_yy", &yy)];
    if mesh.dimension() == 3 {
        of_cells.push(Array::Scalars("mean_stress_zz", &zz));
    }
    of_cells.push(Array::Scalars("mean_stress_xy", &xy));
    if mesh.dimension() == 3 {
        of_cells.extend([Array::Scalars("mean_stress_yz", &yz), Array::Scalars("mean_stress_zx", &zx)]);
    }
    of_cells.push(Array::Scalars("share_of_bound", &answer.shares));
    let data = Unstructured {
        nodes: mesh.nodes(),
        elements: &elements,
        cell_types: &kinds,
        point_data: &[Array::Vectors("displacement", answer.displacement.as_flattened())],
        cell_data: &of_cells,
    };
    data.to_vtu()
}

impl Wanted {
    /// Writes the last mesh, the table of meshes and two pictures into a folder; with a guarantee also its fields.
    ///
    /// # Errors
    /// Files that cannot be written, and those of the rasteriser.
    pub fn write_total_error(self, folder: &Path, title: &str, found: &TotalError, units: &Units) -> Result<(), Error> {
        let last = |guarantee: &Guarantee| -> Result<_, Error> {
            let mesh = guarantee.answer.mesh()?;
            let fields = fields(&mesh, &guarantee.answer)?;
            Ok((msh(&mesh, &[("body", 0..mesh.element_count())]), Some(fields)))
        };
        let (mesh, fields) = match (&found.guarantee, &found.last) {
            (Some(guarantee), _) => last(guarantee)?,
            (None, Ok(last)) => (bodies(last.0.model().body()), None),
            (None, Err(_)) => (String::new(), None),
        };
        let csv = csv(found);
        let files =
            [Some(("mesh.msh", &mesh)), Some(("meshes.csv", &csv)), fields.as_ref().map(|all| ("answer.vtu", all))];
        write_files(folder, &files.into_iter().flatten().collect::<Vec<_>>())?;
        if self.pictures == Pictures::None {
            return Ok(());
        }
        line_plots_for(self.medium, title, &[error_plot(found)]).write(folder, "total-error")?;
        match meshes_picture(title, found, units) {
            Some(meshes) => meshes.write(folder, "meshes").map(drop),
            None => Ok(()),
        }
    }
}

impl InWords for (&TotalError, Option<&Summary>) {
    fn text(&self, title: &str, units: &Units) -> String {
        total_error_text(title, self.0, self.1, units)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_that_is_wider_than_the_force_is_no_result() {
        let about = |half: f64| interval(Some([1.0 - half, 1.0 + half]), Some(half));
        assert!(about(0.4).contains("within 4.0e1 %") && about(0.6).contains("it tells nothing"), "{}", about(0.6));
    }
}
