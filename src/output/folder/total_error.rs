//! An answer with its guaranteed error: report, fields, meshes.

use std::path::Path;

use super::gallery::{Pictures, Wanted};
use super::msh::msh;
use super::vtu::{Array, Unstructured};
use crate::continuum::{PlaneAnswer, Triangulation};
use crate::error::Error;
use crate::fem::Mesh;
use crate::output::draw::drawing::Drawing;
use crate::output::file::{write_files, write_picture};
use crate::output::picture::mesh_series::{MeshPanel, mesh_series};
use crate::output::plots::plot::line_plots_for;
use crate::output::reports::report::{
    columns, comma_separated, entries, entry, plural, quantity, solve_text, table, warnings_text, wrapped,
};
use crate::output::text::printable;
use crate::output::view::curves::guaranteed_plot;
use crate::scene::Units;
use crate::study::Summary;
use crate::study::total_error::{Domain, Ended, TotalError, TotalErrorLevel, half_width};

/// The report: the bounds, the refinement of the mesh, then the answer on the last mesh.
pub(crate) fn total_error_text(title: &str, found: &TotalError, answer: Option<&Summary>, units: &Units) -> String {
    let mut text = format!("{}\n", printable(title));
    let (bound, goal) = (found.total_error.bound, found.goal);
    text +=
        &entry("total error", &format!("guaranteed at most {}, {}", percent(bound), verdict(bound, goal.total_error)));
    text += &entry("", "of the displacement, against the continuum, in the energy norm");
    text += &entry("", &format!("guaranteed at most {} for the mean stress", percent(found.mean_stress_error.bound)));
    text += &entries("contact force", force_lines(found, units));
    if let Some(wanted) = goal.force_error {
        let half = found.levels.last().and_then(half_width).unwrap_or(f64::INFINITY);
        text += &entry("", &verdict(half, wanted));
    }
    if let Some(last) = found.levels.last() {
        let meshes = plural(found.levels.len(), "mesh").replace("meshs", "meshes");
        let sizes =
            format!("{} triangles, {} unknowns, and {} of the stress", last.triangles, last.dofs, last.stress_dofs);
        text += &entry("mesh", &format!("{meshes}; the last: {sizes}"));
    }
    if let Some(own) = found.own_mesh {
        let bound = percent(own.total_error.bound);
        text += &entry("own mesh", &format!("{} of {} unknowns: guaranteed at most {bound}", own.element, own.dofs));
        text += &entry("", &format!("(estimated {})", percent(own.estimated)));
    }
    match (found.last_mesh, &found.last) {
        (Some(last), Ok(_)) => {
            let bound = percent(last.total_error.bound);
            text += &entry(
                "last mesh",
                &format!("its answer, below, of {} unknowns: guaranteed at most {bound}", last.dofs),
            );
            text += &entry("", &format!("(estimated {})", percent(last.estimated)));
        }
        (_, Err(reason)) => {
            text += &entries("last mesh", wrapped(&format!("no answer on it: {reason}")));
        }
        _ => {}
    }
    text += &entry("check", &format!("balance, signs, distances and energies agree to {:.1e}", found.defect));
    let domain = match found.domain {
        Domain::FirstPolygon => "the polygon of the first mesh: a curved side is that of its straight edges",
        Domain::LastPolygon => "the polygon of the last mesh: new nodes lie on the circles of the body",
    };
    text += &entry("domain", domain);
    let next =
        found.next_triangles.map_or(String::new(), |count| format!(" a mesh of {count} triangles would come next;"));
    let short = match found.ended {
        Ended::Goal | Ended::Mesh => None,
        Ended::Time => Some("the time is up"),
        Ended::Memory => Some("memory does not suffice"),
    };
    if let Some(short) = short {
        let bounds: Vec<[f64; 2]> = found.levels.iter().map(|level| [level.dofs as f64, level.bound]).collect();
        text += &entry("ended", &format!("{short};{next} {}", needed(&bounds, goal.total_error)));
    }
    text += &warnings_text(&found.warnings);
    let levels = table(
        &found.levels,
        &[
            ("triangles", &|level| level.triangles.to_string()),
            ("unknowns", &|level| level.dofs.to_string()),
            ("of the stress", &|level| level.stress_dofs.to_string()),
            ("total error", &|level| format!("{:.2e}", level.bound)),
            ("mean stress", &|level| format!("{:.2e}", level.mean_stress_bound)),
            ("force", &|level| format!("{:.6e}", level.contact_force)),
            ("half width", &|level| half_width(level).map_or("-".into(), |half| format!("{half:.1e}"))),
            ("seconds", &|level| format!("{:.3}", level.seconds)),
        ],
    );
    text += &search_text(found.seconds, &levels);
    text + &answer.map_or_else(String::new, |answer| of_last_mesh(title, answer, units))
}

/// The seconds of a search, and the table of its levels.
pub(crate) fn search_text(seconds: f64, levels: &[Vec<String>]) -> String {
    let lines: String = columns(levels).lines().map(|line| format!("  {line}\n")).collect();
    entry("seconds", &format!("{seconds:.3}")) + "\n" + &lines
}

/// The answer on the last mesh, as `solve` reports it.
pub(crate) fn of_last_mesh(title: &str, answer: &Summary, units: &Units) -> String {
    format!("\n{}", solve_text(&format!("The answer on the last mesh: {title}"), answer, units))
}

pub(crate) fn percent(share: f64) -> String {
    format!("{:.2e} %", 100.0 * share)
}

/// The statement that an error meets its goal or not.
pub(crate) fn verdict(error: f64, goal: f64) -> String {
    let is_met = if error <= goal { "within the goal" } else { "ABOVE the goal" };
    format!("{is_met} of {}", percent(goal))
}

/// The force and what carries it, then its interval.
fn force_lines(found: &TotalError, units: &Units) -> [String; 2] {
    if found.contact_force == 0.0 {
        return [
            "0: nothing touches".into(),
            "`signorini solve` without --total-error reports the smallest gap".into(),
        ];
    }
    let force = format!("{} {}", quantity(found.contact_force, &units.force), found.force_basis);
    let interval = match (found.force_interval, found.levels.last().and_then(half_width)) {
        (Some([low, high]), Some(half)) => {
            format!("guaranteed between {low:.7e} and {high:.7e}: within {:.1e} %", 100.0 * half)
        }
        _ => "no guaranteed interval".into(),
    };
    [force.trim_end().into(), interval]
}

/// The unknowns that a goal would need, if the error falls with a power of the unknowns: from unknowns and error of each level.
pub(crate) fn needed(levels: &[[f64; 2]], goal: f64) -> String {
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

/// Writes the fields, the last mesh, the table of meshes and two pictures into a folder.
pub(crate) fn write_total_error(
    folder: &Path,
    title: &str,
    found: &TotalError,
    units: &Units,
    wanted: Wanted,
) -> Result<(), Error> {
    let mesh = found.answer.mesh()?;
    let msh = msh(&mesh, &[("body", 0..mesh.element_count())]);
    write_files(
        folder,
        &[("answer.vtu", &fields(&mesh, &found.answer)?), ("mesh.msh", &msh), ("meshes.csv", &csv(found))],
    )?;
    if wanted.pictures == Pictures::None {
        return Ok(());
    }
    write_picture(folder, "total-error", &line_plots_for(wanted.medium, title, &[guaranteed_plot(found)]))?;
    write_picture(folder, "meshes", &meshes_picture(title, found, units)).map(drop)
}

/// The meshes of the levels.
pub(crate) fn meshes_picture(title: &str, found: &TotalError, units: &Units) -> Drawing {
    let panel = |(mesh, level): (&Triangulation, &TotalErrorLevel)| MeshPanel {
        heading: format!("{} triangles, guaranteed {:.2} %", level.triangles, 100.0 * level.bound),
        cells: (0..mesh.triangles.len()).map(|triangle| mesh.corners(triangle).to_vec()).collect(),
    };
    let panels: Vec<MeshPanel> = found.meshes.iter().zip(&found.levels).map(panel).collect();
    mesh_series(title, &panels, &units.length)
}

fn csv(found: &TotalError) -> String {
    let end = |level: &TotalErrorLevel, end: usize| {
        level.force_interval.map_or_else(String::new, |ends| ends[end].to_string())
    };
    comma_separated(&table(
        &found.levels,
        &[
            ("triangles", &|level| level.triangles.to_string()),
            ("dofs", &|level| level.dofs.to_string()),
            ("stress_dofs", &|level| level.stress_dofs.to_string()),
            ("bound", &|level| level.bound.to_string()),
            ("mean_stress_bound", &|level| level.mean_stress_bound.to_string()),
            ("contact_force", &|level| level.contact_force.to_string()),
            ("force_low", &|level| end(level, 0)),
            ("force_high", &|level| end(level, 1)),
            ("seconds", &|level| level.seconds.to_string()),
        ],
    ))
}

/// The fields for ParaView: the displacement at the nodes, mean stress and share of the bound on triangles.
fn fields(mesh: &Mesh, answer: &PlaneAnswer) -> Result<String, Error> {
    let elements: Vec<Vec<usize>> = mesh.elements().map(<[usize]>::to_vec).collect();
    let kinds = vec![mesh.kind(); elements.len()];
    let moved: Vec<f64> = answer.displacement.iter().flat_map(|&[x, y]| [x, y, 0.0]).collect();
    let entry = |place: usize| -> Vec<f64> { answer.stress.iter().map(|stress| stress[place]).collect() };
    let [xx, yy, xy] = [0, 1, 2].map(entry);
    let data = Unstructured {
        nodes: mesh.nodes(),
        elements: &elements,
        cell_types: &kinds,
        point_data: &[Array::Vectors("displacement", &moved)],
        cell_data: &[
            Array::Scalars("mean_stress_xx", &xx),
            Array::Scalars("mean_stress_yy", &yy),
            Array::Scalars("mean_stress_xy", &xy),
            Array::Scalars("share_of_bound", &answer.shares),
        ],
    };
    data.to_vtu()
}
