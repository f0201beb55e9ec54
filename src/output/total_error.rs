//! An answer with its guaranteed error: report, fields, meshes.

use std::fmt::Write as _;
use std::path::Path;

use super::{
    Array, Drawing, Plot, Quantity, Scale, Series, Unstructured,
    gallery::{Pictures, Wanted},
    medium::Medium,
    mesh_series::{MeshPanel, mesh_series},
    msh::msh,
    plot::line_plots_for,
    report::{columns, entry, plural, quantity, solve_text, warnings_text, wrapped},
    text::printable,
    write_files, write_picture,
};
use crate::continuum::{PlaneAnswer, Triangulation};
use crate::error::Error;
use crate::fem::Mesh;
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
    for (line, name) in force_lines(found, units).iter().zip(["contact force", ""]) {
        text += &entry(name, line);
    }
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
            for (number, line) in wrapped(&format!("no answer on it: {reason}")).iter().enumerate() {
                text += &entry(if number == 0 { "last mesh" } else { "" }, line);
            }
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
    match found.ended {
        Ended::Goal | Ended::Mesh => {}
        Ended::Time => text += &entry("ended", &format!("the time is up;{next} {}", needed(found))),
        Ended::Memory => text += &entry("ended", &format!("memory does not suffice;{next} {}", needed(found))),
    }
    text += &warnings_text(&found.warnings);
    text += &entry("seconds", &format!("{:.3}", found.seconds));
    text.push('\n');
    let heading =
        ["triangles", "unknowns", "of the stress", "total error", "mean stress", "force", "half width", "seconds"];
    let mut table = vec![heading.map(String::from).to_vec()];
    table.extend(found.levels.iter().map(row));
    for line in columns(&table).lines() {
        let _ = writeln!(text, "  {line}");
    }
    text + &answer.map_or_else(String::new, |answer| of_last_mesh(title, answer, units))
}

/// The answer on the last mesh, as `solve` reports it.
pub(super) fn of_last_mesh(title: &str, answer: &Summary, units: &Units) -> String {
    format!("\n{}", solve_text(&format!("The answer on the last mesh: {title}"), answer, units))
}

pub(super) fn percent(share: f64) -> String {
    format!("{:.2e} %", 100.0 * share)
}

/// The statement that an error meets its goal or not.
pub(super) fn verdict(error: f64, goal: f64) -> String {
    let is_met = if error <= goal { "within the goal" } else { "ABOVE the goal" };
    format!("{is_met} of {}", percent(goal))
}

fn row(level: &TotalErrorLevel) -> Vec<String> {
    vec![
        level.triangles.to_string(),
        level.dofs.to_string(),
        level.stress_dofs.to_string(),
        format!("{:.2e}", level.bound),
        format!("{:.2e}", level.mean_stress_bound),
        format!("{:.6e}", level.contact_force),
        half_width(level).map_or("-".into(), |half| format!("{half:.1e}")),
        format!("{:.3}", level.seconds),
    ]
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

/// The unknowns that the goal would need, from the rate of the last meshes.
fn needed(found: &TotalError) -> String {
    let [.., before, last] = &found.levels[..] else {
        return "a second mesh is needed to estimate the unknowns for the goal".into();
    };
    let rate = (before.bound / last.bound).ln() / (last.dofs as f64 / before.dofs as f64).ln();
    unknowns_needed(rate, last.bound / found.goal.total_error, last.dofs)
}

/// The unknowns needed for an error smaller by the factor `times`, if the error falls with a power of the unknowns.
pub(super) fn unknowns_needed(rate: f64, times: f64, dofs: usize) -> String {
    let more = times.powf(1.0 / rate);
    match rate > 0.0 && more.is_finite() {
        true => format!("the goal needs about {:.1e} unknowns", more.max(1.0) * dofs as f64),
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
    write_picture(folder, "total-error", &plot(wanted.medium, title, found))?;
    write_picture(folder, "meshes", &meshes_picture(title, found, units))?;
    Ok(())
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
    let mut text =
        String::from("triangles,dofs,stress_dofs,bound,mean_stress_bound,contact_force,force_low,force_high,seconds\n");
    for level in &found.levels {
        let [low, high] =
            level.force_interval.map_or([String::new(), String::new()], |ends| ends.map(|end| end.to_string()));
        let TotalErrorLevel { triangles, dofs, stress_dofs, bound, mean_stress_bound, contact_force, seconds, .. } =
            level;
        let _ = writeln!(
            text,
            "{triangles},{dofs},{stress_dofs},{bound},{mean_stress_bound},{contact_force},{low},{high},{seconds}"
        );
    }
    text
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

/// The bounds over the unknowns.
fn plot(medium: Medium, title: &str, found: &TotalError) -> Drawing {
    let line = |name: &str, value: &dyn Fn(&TotalErrorLevel) -> Option<f64>| {
        let point = |level: &TotalErrorLevel| Some([level.dofs as f64, value(level)?]);
        Series::new(name, found.levels.iter().filter_map(point).collect())
    };
    let goal =
        Series::new("goal", found.levels.iter().map(|level| [level.dofs as f64, found.goal.total_error]).collect());
    let series = vec![
        line("displacement", &|level| Some(level.bound)),
        line("mean stress", &|level| Some(level.mean_stress_bound)),
        line("contact force", &half_width),
        goal,
    ];
    let series = series.into_iter().filter(|series| !series.points.is_empty()).collect();
    let (x, y) = (Quantity::new("unknowns of the displacement", ""), Quantity::new("guaranteed relative error", ""));
    line_plots_for(medium, title, &[Plot { scales: [Scale::Logarithmic; 2], ..Plot::new(x, y, series) }])
}
