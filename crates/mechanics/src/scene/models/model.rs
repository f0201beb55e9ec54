//! The model: a discretised scene, its contact problem, and the meaning of its rows and dofs.

use std::sync::Arc;

use super::parts::{Conditions, Parts};
use super::rigid_body_modes::RigidBodyModes;
use super::rows::{self, ContactRow};
use super::suspect::suspect_rows;
use crate::error::Error;
use crate::fem::assembly::{free_load, rigid_motions, stiffness_on};
use crate::fem::geometry::distance;
use crate::motion::Observation;
use crate::scene::Warning;
use crate::scene::input::entry::{finite, wrong};
use signorini_qp as qp;
use signorini_qp::{ContactProblem, NearNullSpace, Settings, Solution, SymmetricMatrix, dot, solve};

/// Tributary areas below this, relative to the largest, are rounding of zero; radii, relative to the size of the body.
const NO_AREA: f64 = 1e-12;

/// A discretised scene: mesh, contact problem, and the meaning of its rows and dofs.
///
/// Nodal vectors have length `dim * n_nodes` and the order `[x_0, y_0, x_1, ...]` (with z in space). `displacement`
/// arguments are those of a solution: one entry per free dof, then the travel of each obstacle that a force presses.
///
/// ```
/// use signorini_mechanics::Scene;
/// use signorini_qp::solve_qp;
///
/// // A bar of 2 m and 0.1 m x 0.1 m with Young's modulus 1e6 Pa is a spring of 1e6 x 0.01 / 2 = 5000 N/m. Pulled with
/// // 2000 Pa x 0.01 m2 = 20 N towards a wall at 0.001 m, it presses against the wall with 20 - 5000 x 0.001 = 15 N.
/// let scene = r#"{
///     "model": "plane-stress", "thickness": 0.1, "gap": 0.001,
///     "body": {"rectangle": {"x": {"points": [0, 2], "divisions": [20]}, "y": {"points": [0, 0.1], "divisions": [1]}}},
///     "material": {"young": 1e6, "poisson": 0},
///     "supports": [{"on": {"boundary": "left"}, "x": 0}, {"on": {"point": [0, 0]}, "y": 0}],
///     "loads": [{"traction": {"boundary": "right", "value": [2000, 0]}}],
///     "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [2, 0], "normal": [1, 0]}}}]
/// }"#;
/// let model = Scene::from_json(scene, "bar")?.build()?;
/// let solution = solve_qp(model.problem())?;
/// assert!((solution.contact_force() - 15.0).abs() < 1e-9);
/// # Ok::<(), signorini_mechanics::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Model {
    #[doc(hidden)]
    pub parts: Arc<Parts>,
    pub(crate) gap: f64,
    /// How far each obstacle has moved along its approach direction in a motion, in length; empty if none has.
    pub(crate) moved: Vec<f64>,
    pub(crate) rows: Vec<ContactRow>,
    pub(crate) across: Vec<ContactRow>,
    pub(crate) warnings: Vec<Warning>,
    pub(crate) problem: ContactProblem,
}

/// Rows come first: they decide whether the body is held, before anything expensive is built.
pub(crate) fn check_held(parts: &Parts, built: &rows::Rows) -> Result<(), Error> {
    match parts.moves() || parts.scene.modes().is_some() && built.rows.is_empty() {
        true => Ok(()),
        false => RigidBodyModes::of_parts(parts).check_held(parts, &built.rows),
    }
}

/// Stiffness, load and near null space in the unknowns.
type Matrices = (SymmetricMatrix, Vec<f64>, Option<Arc<NearNullSpace>>);

pub(crate) fn matrices(parts: &Parts) -> Result<Matrices, Error> {
    let Conditions { dofs, springs, .. } = &parts.conditions;
    let stiffness = stiffness_on(&parts.body, dofs, springs).map_err(|error| match error.into() {
        Error::Linear(qp::LinearError::NotFinite { .. }) => {
            let message = "the stiffness that it makes with body and thickness overflows; choose other units";
            wrong("material", message)
        }
        other => other,
    })?;
    let load = parts.load(free_load(&parts.body, dofs, &parts.acting_load()?)?);
    let (count, motion) = rigid_motions(&parts.body);
    let nodes = parts.body.mesh().nodes();
    let places: Vec<[f64; 3]> = (0..nodes.len()).map(|node| dofs.basis.place(nodes, node)).collect();
    let modes = (0..count).map(|mode| parts.nearest(|node| motion(mode, places[node]), |_| 0.0)).collect();
    Ok((stiffness, load, NearNullSpace::of_modes(modes).map(Arc::new)))
}

pub(crate) fn assembled(
    parts: Arc<Parts>,
    gap: f64,
    built: rows::Rows,
    (stiffness, load, near_null): Matrices,
) -> Result<Model, Error> {
    let mut problem = ContactProblem::new(stiffness, load, built.contact, built.gap)?;
    if let Some(near_null) = near_null {
        problem = problem.with_near_null(near_null)?;
    }
    let problem = parts.tied(problem)?;
    // A solver finds the motions of single bodies by itself.
    if !(parts.moves() || parts.ties.rows.is_empty()) {
        RigidBodyModes::of_parts(&parts).check_bounded(&parts, &problem)?;
    }
    let suspect = suspect_rows(&parts, &built.rows);
    let warnings = parts.warnings.iter().chain(&parts.ties.warnings).cloned();
    let warnings = warnings.chain(built.warnings).chain(suspect).collect();
    Ok(Model { parts, gap, moved: Vec::new(), rows: built.rows, across: built.across, warnings, problem })
}

pub(crate) fn with_gap(model: &Model, gap: f64) -> Result<Model, Error> {
    let built = rows::build(&model.parts, gap)?;
    if !model.parts.moves() {
        RigidBodyModes::of_parts(&model.parts).check_held(&model.parts, &built.rows)?;
    }
    let (stiffness, load) = (model.problem.stiffness().clone(), model.problem.load().to_vec());
    let near_null = model.problem.near_null().cloned();
    assembled(model.parts.clone(), gap, built, (stiffness, load, near_null))
}

pub(crate) fn with_moved_obstacles(model: &Model, moved: &[f64]) -> Result<Model, Error> {
    let mut model = Model { moved: moved.to_vec(), ..model.clone() };
    let mut gap = model.problem.gap().to_vec();
    for (obstacle, by) in moved.iter().enumerate() {
        let shifts = row_shifts(&model, obstacle, *by);
        gap.iter_mut().zip(&shifts).for_each(|(gap, shift)| *gap += shift);
        model.rows.iter_mut().zip(&shifts).for_each(|(row, shift)| row.gap += shift);
    }
    model.problem = model.problem.with_gap(gap)?;
    Ok(model)
}

/// The changes of the gaps of all rows if an obstacle moves by `by` along its approach direction.
pub(crate) fn row_shifts(model: &Model, obstacle: usize, by: f64) -> Vec<f64> {
    let approach = model.obstacles()[obstacle].approach();
    let of_row = |row: &ContactRow| if row.obstacle == obstacle { by * dot(&row.normal, &approach) } else { 0.0 };
    model.rows.iter().map(of_row).collect()
}

/// The same scene with another force on the one obstacle that a force presses.
pub fn pressed_by(model: &Model, force: f64) -> Result<Model, Error> {
    let parts = &model.parts;
    let &[obstacle] = parts.pressed.as_slice() else {
        let message = match parts.pressed.len() {
            0 => {
                "no obstacle is pressed by a force; a sweep over forces needs the key `force` in one obstacle, such as \
                  \"force\": 100"
                    .to_string()
            }
            count => format!("{count} obstacles have the key `force`; a sweep over forces needs exactly one"),
        };
        return Err(wrong("obstacles", message));
    };
    let path = || format!("obstacles[{obstacle}].force");
    finite(path(), force)?;
    if force < 0.0 {
        return Err(wrong(path(), format!("{force} would pull the obstacle away: forces are 0 or positive")));
    }
    let load = model.problem.load().to_vec();
    let load = parts.pressed_by(load, |obstacle| parts.share_of(obstacle, force));
    let problem = model.problem.with_load(load)?;
    Ok(Model { problem, ..model.clone() })
}

/// The solution with pressed obstacles at their first contact with the body, without a force.
pub fn touched(model: &Model, settings: &Settings) -> Result<Solution, Error> {
    let (parts, problem) = (&model.parts, &model.problem);
    let is_pressed = |row: usize| parts.travel(model.rows[row].obstacle).is_some();
    // The obstacles are out of reach, on springs that nothing stretches.
    let away = |(row, &gap): (usize, &f64)| if is_pressed(row) { f64::INFINITY } else { gap };
    let (contact, gap) = problem.inequalities_given();
    let gap = gap.iter().enumerate().map(away).collect();
    let load = parts.pressed_by(problem.load().to_vec(), |_| 0.0);
    let stiffness = parts.on_springs(problem.stiffness())?;
    let away = parts.tied(ContactProblem::new(stiffness, load, contact.into_owned(), gap)?)?;
    let mut solution = solve(&away, settings)?;
    let left = problem.violation(&solution.displacement);
    for &obstacle in &parts.pressed {
        let Some(travel) = parts.travel(obstacle) else { continue };
        let rows = problem.contact().column(travel);
        // Adding zero removes the sign of a zero.
        solution.displacement[travel] = 0.0 + rows.map(|(row, lean)| -left[row] / lean).fold(f64::INFINITY, f64::min);
    }
    Ok(solution)
}

pub(crate) fn obstacle_forces(model: &Model, multiplier: &[f64]) -> Vec<f64> {
    let mut forces = vec![0.0; model.obstacles().len()];
    for (row, lambda) in model.rows().iter().zip(multiplier) {
        forces[row.obstacle] -= model.parts.parts_of_obstacle(row.obstacle) * lambda;
    }
    forces
}

pub(crate) fn pressing_rows(model: &Model, multiplier: &[f64]) -> Vec<usize> {
    let mut count = vec![0; model.obstacles().len()];
    let pressing = model.rows().iter().zip(multiplier).filter(|(_, lambda)| **lambda < 0.0);
    pressing.for_each(|(row, _)| count[row.obstacle] += 1);
    count
}

pub(crate) fn of_whole(model: &Model, seen: Observation) -> Observation {
    let of_part = [seen.force, seen.kinetic, seen.strain, seen.potential, seen.work, seen.damped];
    let [force, kinetic, strain, potential, work, damped] = of_part.map(|of_part| model.parts_of_whole() * of_part);
    Observation { force, kinetic, strain, potential, work, damped, ..seen }
}

pub(crate) fn pressure(model: &Model, multiplier: &[f64]) -> Result<Vec<f64>, Error> {
    check_multiplier(model, multiplier)?;
    let largest = model.rows.iter().fold(0.0, |largest: f64, row| largest.max(row.tributary_area));
    let (mesh, nodes) = (model.mesh(), model.mesh().nodes());
    let is_axisymmetric = model.body().formulation().is_axisymmetric();
    let is_quadratic = |row: &ContactRow| {
        let boundary = mesh.boundary(model.obstacles()[row.obstacle].boundary());
        boundary.is_some_and(|boundary| !boundary.kind.reference().mid_sides.is_empty())
    };
    let reach = NO_AREA * mesh.size();
    let has_area = |row: &ContactRow| {
        let is_on_axis = || is_axisymmetric && nodes[row.node][0].abs() <= reach;
        row.tributary_area > NO_AREA * largest && !(is_on_axis() && is_quadratic(row))
    };
    let of_row = |index: usize| -multiplier[index] / model.rows[index].projected_area();
    let pressure = |(index, row): (usize, &ContactRow)| {
        if has_area(row) {
            return of_row(index);
        }
        let away = |other: &ContactRow| distance(nodes[row.node], nodes[other.node]);
        let others = model.rows.iter().enumerate().filter(|(_, other)| other.obstacle == row.obstacle);
        let with_area = others.filter(|(_, other)| has_area(other));
        with_area.min_by(|a, b| away(a.1).total_cmp(&away(b.1))).map_or(0.0, |(next, _)| of_row(next))
    };
    Ok(model.rows.iter().enumerate().map(pressure).collect())
}

pub(crate) fn contact_forces(model: &Model, multiplier: &[f64]) -> Result<Vec<f64>, Error> {
    check_multiplier(model, multiplier)?;
    let dimension = model.body().dimension();
    let mut forces = vec![0.0; model.parts.conditions.dofs.nodal_count()];
    for (row, lambda) in model.rows.iter().zip(multiplier) {
        row.form().forces(*lambda, |node, force| {
            let entries = &mut forces[dimension * node..dimension * (node + 1)];
            entries.iter_mut().zip(force).for_each(|(entry, part)| *entry += part);
        });
    }
    model.parts.conditions.dofs.basis.scatter(&mut forces, dimension);
    Ok(forces)
}

/// The point of application of the force of a row for moments: the node, or, in the middle of a curved edge, its
/// coefficient.
pub fn place(model: &Model, node: usize) -> [f64; 3] {
    model.parts.conditions.dofs.basis.place(model.mesh().nodes(), node)
}

/// Multipliers of contact rows, followed by those of the equations of ties.
pub(crate) fn split<'a>(model: &Model, multiplier: &'a [f64]) -> Result<(&'a [f64], &'a [f64]), Error> {
    let (rows, ties) = (model.rows.len(), model.parts.ties.rows.len());
    let of = if ties == 0 { "contact rows" } else { "contact rows and equations of ties" };
    qp::LinearError::check_length("multiplier", multiplier.len(), rows + ties, of)?;
    Ok(multiplier.split_at(rows))
}

pub(crate) fn check_multiplier(model: &Model, multiplier: &[f64]) -> Result<(), Error> {
    Ok(qp::LinearError::check_length("multiplier", multiplier.len(), model.rows.len(), "contact rows")?)
}
