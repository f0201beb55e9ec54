//! An answer with its estimated total error: report, meshes, fields and pictures.

use std::path::Path;

use super::gallery::{Pictures, Wanted};
use super::msh::msh;
use super::total_error::{needed, of_last_mesh, percent, search_text, verdict};
use crate::error::Error;
use crate::output::draw::drawing::Drawing;
use crate::output::file::{write_files, write_picture};
use crate::output::picture::mesh_series::{MeshPanel, mesh_series};
use crate::output::plots::plot::line_plots_for;
use crate::output::reports::report::{comma_separated, entry, of_part, plural, table, wrapped};
use crate::output::text::printable;
use crate::output::view::curves::estimated_plot;
use crate::scene::Units;
use crate::study::Summary;
use crate::study::total_error::{Ended, Estimated, EstimatedLevel};

/// The report: the refinement of the mesh, then the answer on the last mesh.
pub(crate) fn estimated_error_text(title: &str, found: &Estimated, answer: &Summary, units: &Units) -> String {
    let mut text = format!("{}\n", printable(title));
    let (error, goal) = (found.total_error.bound, found.goal.total_error);
    let depth = found.levels.last().map_or(0.0, |last| last.depth_between_nodes);
    text += &entry("total error", &format!("estimated {}, {}", percent(error), verdict(error.max(depth), goal)));
    text += &entry("", "of the displacement, against the continuum, in the energy norm");
    let deepest =
        format!("the deepest place between nodes lies {} of the indentation inside an obstacle", percent(depth));
    text += &entry("", &deepest);
    for (number, line) in wrapped(&format!("no guarantee: {}", found.reason)).iter().enumerate() {
        text += &entry("", if number == 0 { line.clone() } else { format!("  {line}") }.as_str());
    }
    if let Some(last) = found.levels.last() {
        let meshes = plural(found.levels.len(), "mesh").replace("meshs", "meshes");
        text += &entry(
            "mesh",
            &format!("{meshes}; the last: {} elements, {} unknowns{}", last.elements, last.dofs, of_part(answer)),
        );
    }
    let errors: Vec<[f64; 2]> = found.levels.iter().map(|level| [level.dofs as f64, level.total_error]).collect();
    match found.ended {
        Ended::Goal => {}
        Ended::Time => text += &entry("ended", &format!("no time for a finer mesh; {}", needed(&errors, goal))),
        Ended::Memory => text += &entry("ended", &format!("no memory for a finer mesh; {}", needed(&errors, goal))),
        Ended::Mesh => {
            text += &entry("ended", "a mesh from a file cannot be refined here; mesh the body with smaller cells")
        }
    }
    let levels = table(
        &found.levels,
        &[
            ("elements", &|level| level.elements.to_string()),
            ("unknowns", &|level| level.dofs.to_string()),
            ("rows", &|level| level.contact_rows.to_string()),
            ("method", &|level| level.method.clone()),
            ("total error", &|level| format!("{:.2e}", level.total_error)),
            ("of the algebra", &|level| format!("{:.1e}", level.energy_error_bound)),
            ("depth", &|level| format!("{:.1e}", level.depth_between_nodes)),
            ("force", &|level| format!("{:.6e}", level.contact_force)),
            ("seconds", &|level| format!("{:.3}", level.seconds)),
        ],
    );
    text += &search_text(found.seconds, &levels);
    if answer.parts_of_whole.is_some() {
        text += "  total error and force are of the whole body, all other columns of the meshed part\n";
    }
    text + &of_last_mesh(title, answer, units)
}

/// Writes the last mesh, the table of meshes and the plot of the errors into a folder.
pub(crate) fn write_estimated_error(
    folder: &Path,
    title: &str,
    found: &Estimated,
    wanted: Wanted,
) -> Result<(), Error> {
    let body = found.answer.model().body();
    let bodies: Vec<_> = body
        .regions()
        .iter()
        .map(|region| (if region.name().is_empty() { "body" } else { region.name() }, region.elements()))
        .collect();
    write_files(folder, &[("mesh.msh", &msh(body.mesh(), &bodies)), ("meshes.csv", &csv(found))])?;
    if wanted.pictures == Pictures::None {
        return Ok(());
    }
    write_picture(folder, "total-error", &line_plots_for(wanted.medium, title, &[estimated_plot(found)]))?;
    match estimated_meshes_picture(title, found) {
        Some(meshes) => write_picture(folder, "meshes", &meshes).map(drop),
        None => Ok(()),
    }
}

/// The meshes of the levels; `None` for a bar.
pub(crate) fn estimated_meshes_picture(title: &str, found: &Estimated) -> Option<Drawing> {
    let panel = |(cells, level): (&Vec<Vec<[f64; 2]>>, &EstimatedLevel)| MeshPanel {
        heading: format!("{} elements, estimated {:.2} %", level.elements, 100.0 * level.total_error),
        cells: cells.clone(),
    };
    let panels: Vec<MeshPanel> = found.views.iter().zip(&found.levels).map(panel).collect();
    let is_drawn = panels.iter().all(|panel| !panel.cells.is_empty());
    is_drawn.then(|| mesh_series(title, &panels, &found.answer.model().units().length))
}

fn csv(found: &Estimated) -> String {
    comma_separated(&table(
        &found.levels,
        &[
            ("elements", &|level| level.elements.to_string()),
            ("dofs", &|level| level.dofs.to_string()),
            ("contact_rows", &|level| level.contact_rows.to_string()),
            ("method", &|level| level.method.clone()),
            ("discretisation_error", &|level| level.discretisation_error.to_string()),
            ("energy_error_bound", &|level| level.energy_error_bound.to_string()),
            ("total_error", &|level| level.total_error.to_string()),
            ("depth_between_nodes", &|level| level.depth_between_nodes.to_string()),
            ("contact_force", &|level| level.contact_force.to_string()),
            ("seconds", &|level| level.seconds.to_string()),
        ],
    ))
}
