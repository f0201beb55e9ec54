//! The model: a discretised scene, its contact problem, and the meaning of its rows and dofs.

use std::sync::Arc;

use super::parts::Parts;
use super::rigid_body_modes::RigidBodyModes;
use super::rows::{self, ContactRow};
use super::suspect::suspect_rows;
use crate::error::Error;
use crate::fem::geometry::distance;
use crate::fem::{DofMap, ElasticBody, Mesh, free_load, rigid_body_modes, stiffness};
use crate::motion::Observation;
use crate::scene::input::entry::{finite, wrong};
use crate::scene::input::obstacle::PlacedObstacle;
use crate::scene::{Units, Warning};
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
    pub(crate) parts: Arc<Parts>,
    gap: f64,
    /// How far each obstacle has moved along its approach direction in a motion, in length; empty if none has.
    moved: Vec<f64>,
    rows: Vec<ContactRow>,
    across: Vec<ContactRow>,
    warnings: Vec<Warning>,
    problem: ContactProblem,
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
    let dofs = &parts.conditions.dofs;
    let of_body = stiffness(&parts.body, dofs).map_err(Error::from);
    let of_free = of_body.and_then(|of_body| parts.on_springs(of_body)).map_err(|error| match error {
        Error::Linear(qp::LinearError::NotFinite { .. }) => {
            let message = "the stiffness that it makes with body and thickness overflows; choose other units";
            wrong("material", message)
        }
        other => other,
    })?;
    let force = |obstacle: usize| parts.share_of(obstacle, parts.obstacles[obstacle].force().unwrap_or(0.0));
    let load = free_load(&parts.body, dofs, &parts.acting_load()?)?;
    let load = parts.unknowns.load(load, &of_free, force);
    let stiffness = parts.unknowns.congruent(of_free)?;
    let modes = rigid_body_modes(&parts.body, dofs).into_iter();
    let modes = modes.map(|mode| parts.unknowns.of_motion(mode, |_| 0.0)).collect();
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

impl Model {
    /// The same scene with another scene-wide gap: only the contact rows are built again.
    ///
    /// # Errors
    /// [`Error::Scene`] for a gap that is not finite or puts a node so deep that it has no closest point,
    /// [`qp::Error::UnderHeld`] if the new rows leave a rigid-body mode free.
    pub fn with_gap(&self, gap: f64) -> Result<Self, Error> {
        let built = rows::build(&self.parts, gap)?;
        if !self.parts.moves() {
            RigidBodyModes::of_parts(&self.parts).check_held(&self.parts, &built.rows)?;
        }
        let (stiffness, load) = (self.problem.stiffness().clone(), self.problem.load().to_vec());
        let near_null = self.problem.near_null().cloned();
        assembled(self.parts.clone(), gap, built, (stiffness, load, near_null))
    }

    /// The same with obstacles that have moved along their approach directions, one entry per obstacle, in length: rows
    /// keep the normals that they have.
    pub fn with_moved_obstacles(&self, moved: &[f64]) -> Result<Self, Error> {
        let mut model = Model { moved: moved.to_vec(), ..self.clone() };
        let mut gap = self.problem.gap().to_vec();
        for (obstacle, by) in moved.iter().enumerate() {
            let shifts = self.row_shifts(obstacle, *by);
            gap.iter_mut().zip(&shifts).for_each(|(gap, shift)| *gap += shift);
            model.rows.iter_mut().zip(&shifts).for_each(|(row, shift)| row.gap += shift);
        }
        model.problem = self.problem.with_gap(gap)?;
        Ok(model)
    }

    /// The displacements of the obstacles along their approach directions in a motion, one entry per obstacle, in
    /// length, positive away from the body; empty if none moves.
    pub fn moved_obstacles(&self) -> &[f64] {
        &self.moved
    }

    /// The changes of the gaps of all rows if an obstacle moves by `by` along its approach direction.
    pub(crate) fn row_shifts(&self, obstacle: usize, by: f64) -> Vec<f64> {
        let approach = self.obstacles()[obstacle].approach();
        let of_row = |row: &ContactRow| if row.obstacle == obstacle { by * dot(&row.normal, &approach) } else { 0.0 };
        self.rows.iter().map(of_row).collect()
    }

    /// The force that presses an obstacle, on the whole body; `None` if none does.
    pub fn pressing_force_on(&self, obstacle: usize) -> Option<f64> {
        let parts = self.parts.parts_of_obstacle(obstacle);
        let force = self.parts.unknowns.travel(obstacle).map(|unknown| parts * self.problem.load()[unknown]);
        force.filter(|&force| force > 0.0)
    }

    /// The force on each obstacle that a force presses, in their order, in force.
    pub fn pressing_forces(&self) -> Vec<f64> {
        self.parts.unknowns.pressed.iter().filter_map(|&obstacle| self.pressing_force_on(obstacle)).collect()
    }

    /// The same scene with another force on the one obstacle that a force presses.
    pub(crate) fn pressed_by(&self, force: f64) -> Result<Self, Error> {
        let parts = &self.parts;
        let &[obstacle] = parts.unknowns.pressed.as_slice() else {
            let message = match parts.unknowns.pressed.len() {
                0 => "no obstacle is pressed by a force; a sweep over forces needs the key `force` in one obstacle, such as \
                      \"force\": 100"
                    .to_string(),
                count => format!("{count} obstacles have the key `force`; a sweep over forces needs exactly one"),
            };
            return Err(wrong("obstacles", message));
        };
        let path = || format!("obstacles[{obstacle}].force");
        finite(path(), force)?;
        if force < 0.0 {
            return Err(wrong(path(), format!("{force} would pull the obstacle away: forces are 0 or positive")));
        }
        let load = self.problem.load().to_vec();
        let load = parts.unknowns.pressed_by(load, |obstacle| parts.share_of(obstacle, force));
        let problem = self.problem.with_load(load)?;
        Ok(Model { problem, ..self.clone() })
    }

    /// The solution with pressed obstacles at their first contact with the body, without a force.
    pub(crate) fn touched(&self, settings: &Settings) -> Result<Solution, Error> {
        let (parts, problem) = (&self.parts, &self.problem);
        let is_pressed = |row: usize| parts.unknowns.travel(self.rows[row].obstacle).is_some();
        // The obstacles are out of reach, on springs that nothing stretches.
        let away = |(row, &gap): (usize, &f64)| if is_pressed(row) { f64::INFINITY } else { gap };
        let (contact, gap) = problem.inequalities_given();
        let gap = gap.iter().enumerate().map(away).collect();
        let load = parts.unknowns.pressed_by(problem.load().to_vec(), |_| 0.0);
        let stiffness = parts.unknowns.on_springs(problem.stiffness())?;
        let away = parts.tied(ContactProblem::new(stiffness, load, contact.into_owned(), gap)?)?;
        let mut solution = solve(&away, settings)?;
        let left = problem.violation(&solution.displacement);
        for &obstacle in &parts.unknowns.pressed {
            let Some(travel) = parts.unknowns.travel(obstacle) else { continue };
            let rows = problem.contact().column(travel);
            // Adding zero removes the sign of a zero.
            solution.displacement[travel] =
                0.0 + rows.map(|(row, lean)| -left[row] / lean).fold(f64::INFINITY, f64::min);
        }
        Ok(solution)
    }

    /// The meaning of each unknown of the problem, in order.
    pub fn meanings(&self) -> impl Iterator<Item = crate::scene::Meaning> + '_ {
        let parts = &self.parts;
        parts.unknowns.meanings(&parts.conditions.dofs, parts.body.dimension(), &parts.conditions.rigid_faces)
    }

    /// Number of copies of the modelled part in the whole, by planes of symmetry.
    pub fn parts_of_whole(&self) -> f64 {
        self.parts.conditions.symmetry.parts()
    }

    /// The sum of the contact forces on each obstacle and pair of bodies, one entry per obstacle in the order of the
    /// scene, in force, `>= 0`, for the multipliers of the rows (in force, `<= 0`); with planes of symmetry that of the
    /// whole body.
    pub fn obstacle_forces(&self, multiplier: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; self.obstacles().len()];
        for (row, lambda) in self.rows().iter().zip(multiplier) {
            forces[row.obstacle] -= self.parts.parts_of_obstacle(row.obstacle) * lambda;
        }
        forces
    }

    /// The number of rows of each obstacle and pair of bodies with a force, in the order of the scene, for the
    /// multipliers of the rows (in force, `<= 0`).
    pub fn pressing_rows(&self, multiplier: &[f64]) -> Vec<usize> {
        let mut count = vec![0; self.obstacles().len()];
        let pressing = self.rows().iter().zip(multiplier).filter(|(_, lambda)| **lambda < 0.0);
        pressing.for_each(|(row, _)| count[row.obstacle] += 1);
        count
    }

    /// The numbers of a motion of the whole body, from those of the meshed part: its force and its energies.
    pub fn of_whole(&self, seen: Observation) -> Observation {
        let whole = |of_part: f64| self.parts_of_whole() * of_part;
        let [force, kinetic, strain] = [seen.force, seen.kinetic, seen.strain].map(whole);
        Observation {
            force,
            kinetic,
            strain,
            potential: whole(seen.potential),
            work: whole(seen.work),
            damped: whole(seen.damped),
            ..seen
        }
    }

    /// The title of the scene, as reports and pictures print it.
    pub fn title(&self) -> &str {
        &self.parts.scene.title
    }

    /// The names of the units of length and force that the scene gives to tables and pictures.
    pub fn units(&self) -> &Units {
        &self.parts.scene.units
    }

    /// The scene-wide gap, in length: the shift of every obstacle along its approach direction; negative into the body.
    pub fn gap(&self) -> f64 {
        self.gap
    }

    /// The body, or all bodies in one: mesh, materials, thickness.
    pub fn body(&self) -> &ElasticBody {
        &self.parts.body
    }

    /// The mesh of all bodies, further bodies after the first.
    pub fn mesh(&self) -> &Mesh {
        self.parts.body.mesh()
    }

    /// Free and supported dofs.
    pub fn dofs(&self) -> &DofMap {
        &self.parts.conditions.dofs
    }

    /// The obstacles in the order of the scene, then those of a user.
    pub fn obstacles(&self) -> &[PlacedObstacle] {
        &self.parts.obstacles
    }

    /// The surface of obstacle `obstacle` at this model's gap as a polyline [x, y], in length, as
    /// [`PlacedObstacle::outline`]; empty if there is no such obstacle.
    pub fn obstacle_outline(&self, obstacle: usize, segments: usize) -> Vec<[f64; 2]> {
        self.obstacles().get(obstacle).map_or_else(Vec::new, |one| one.outline(one.shift(self.gap), segments))
    }

    /// The contact rows, in the order of the rows of [`problem`](Self::problem): obstacle by obstacle, each in the
    /// order of its boundary.
    pub fn rows(&self) -> &[ContactRow] {
        &self.rows
    }

    /// The contact seen from the nodes of the other side, where rows are means over meshes that do not match: each as a
    /// row from that node to the place that it faces, with the tributary area 0. They are no rows of the problem, and
    /// may be violated between the nodes of the carrying side by as much as the meshes differ.
    pub fn rows_across(&self) -> &[ContactRow] {
        &self.across
    }

    /// Warnings about the scene, found when the model was built.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// The contact problem in the free dofs.
    pub fn problem(&self) -> &ContactProblem {
        &self.problem
    }

    /// Nodal displacements, length `dim * n_nodes`, in length, from those of the free dofs; supports have their
    /// prescribed values.
    pub fn nodal_displacement(&self, displacement: &[f64]) -> Result<Vec<f64>, Error> {
        Ok(self.parts.conditions.dofs.expand(&self.parts.unknowns.displacement(displacement)?)?)
    }

    /// Nodal velocities, length `dim * n_nodes`, in length over time, from those of the unknowns; supports stand still.
    pub fn nodal_velocity(&self, velocity: &[f64]) -> Result<Vec<f64>, Error> {
        Ok(self.parts.conditions.dofs.expand_motion(&self.parts.unknowns.motion(velocity)?)?)
    }

    /// Travel of an obstacle that a force presses, against its approach direction, in length, in a solution with these
    /// `displacement`s; `None` for an obstacle at rest.
    pub fn travel(&self, displacement: &[f64], obstacle: usize) -> Result<Option<f64>, Error> {
        self.parts.unknowns.motion(displacement)?;
        Ok(self.parts.unknowns.travel(obstacle).map(|unknown| displacement[unknown]))
    }

    /// Contact pressure of each row, `-lambda` over the tributary area projected along the row, in force per area,
    /// `>= 0` in compression. `multiplier` has one entry per contact row, in force.
    ///
    /// The end of a quadratic edge on an axis of revolution has no tributary area, or next to none if the edge is
    /// curved; it shows the pressure of the candidate next to it.
    pub fn pressure(&self, multiplier: &[f64]) -> Result<Vec<f64>, Error> {
        self.check_multiplier(multiplier)?;
        let largest = self.rows.iter().fold(0.0, |largest: f64, row| largest.max(row.tributary_area));
        let (mesh, nodes) = (self.mesh(), self.mesh().nodes());
        let is_axisymmetric = self.body().formulation().is_axisymmetric();
        let is_quadratic = |row: &ContactRow| {
            let boundary = mesh.boundary(self.obstacles()[row.obstacle].boundary());
            boundary.is_some_and(|boundary| !boundary.kind.reference().mid_sides.is_empty())
        };
        let reach = NO_AREA * mesh.size();
        let has_area = |row: &ContactRow| {
            let is_on_axis = || is_axisymmetric && nodes[row.node][0].abs() <= reach;
            row.tributary_area > NO_AREA * largest && !(is_on_axis() && is_quadratic(row))
        };
        let of_row = |index: usize| -multiplier[index] / self.rows[index].projected_area();
        let pressure = |(index, row): (usize, &ContactRow)| {
            if has_area(row) {
                return of_row(index);
            }
            let away = |other: &ContactRow| distance(nodes[row.node], nodes[other.node]);
            let others = self.rows.iter().enumerate().filter(|(_, other)| other.obstacle == row.obstacle);
            let with_area = others.filter(|(_, other)| has_area(other));
            with_area.min_by(|a, b| away(a.1).total_cmp(&away(b.1))).map_or(0.0, |(next, _)| of_row(next))
        };
        Ok(self.rows.iter().enumerate().map(pressure).collect())
    }

    /// Nodal contact forces on the body, `lambda n`, length `dim * n_nodes`, in force, along the positive axes; with
    /// two bodies the opposite forces on the other body. `multiplier` has one entry per contact row, in force, `<= 0`.
    /// On quadratic faces in space they are those of the shape functions: zero or negative at corners under a uniform
    /// pressure.
    pub fn contact_forces(&self, multiplier: &[f64]) -> Result<Vec<f64>, Error> {
        self.check_multiplier(multiplier)?;
        let dimension = self.body().dimension();
        let mut forces = vec![0.0; self.parts.conditions.dofs.nodal_count()];
        for (row, lambda) in self.rows.iter().zip(multiplier) {
            for &(node, share) in &row.ends {
                let entries = &mut forces[dimension * node..dimension * (node + 1)];
                entries.iter_mut().zip(row.normal).for_each(|(entry, component)| *entry += share * lambda * component);
            }
        }
        self.parts.conditions.dofs.basis.scatter(&mut forces, dimension);
        Ok(forces)
    }

    /// External loads at all nodes, length `dim * n_nodes`, order `[f_x0, f_y0, f_x1, ...]`, in force, along the
    /// positive axes.
    pub fn nodal_load(&self) -> &[f64] {
        &self.parts.conditions.load
    }

    /// The point of application of the force of a row for moments: the node, or, in the middle of a curved edge, its
    /// coefficient.
    pub(crate) fn place(&self, node: usize) -> [f64; 3] {
        self.parts.conditions.dofs.basis.place(self.mesh().nodes(), node)
    }

    /// Multipliers of contact rows, followed by those of the equations of ties.
    pub(crate) fn split<'a>(&self, multiplier: &'a [f64]) -> Result<(&'a [f64], &'a [f64]), Error> {
        let (rows, ties) = (self.rows.len(), self.parts.ties.rows.len());
        let of = if ties == 0 { "contact rows" } else { "contact rows and equations of ties" };
        qp::LinearError::check_length("multiplier", multiplier.len(), rows + ties, of)?;
        Ok(multiplier.split_at(rows))
    }

    pub(crate) fn check_multiplier(&self, multiplier: &[f64]) -> Result<(), Error> {
        Ok(qp::LinearError::check_length("multiplier", multiplier.len(), self.rows.len(), "contact rows")?)
    }
}
