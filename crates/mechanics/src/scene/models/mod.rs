//! A discretised scene: mesh and materials, supports, loads and springs, contact rows, and the problem that they make.

pub mod build;
pub mod elastic;
mod facing;
pub mod held;
pub mod load;
mod materials;
pub mod model;
pub mod overlap;
mod part;
pub mod parts;
pub mod points;
mod preload;
pub mod resultants;
pub mod rigid_body_modes;
pub mod rigid_face;
pub mod rows;
pub mod set_up;
mod springs;
pub mod start;
mod suspect;
mod symmetry;
mod ties;
pub mod unknowns;

use crate::error::Error;
use crate::fem::recovery::StressField;
use crate::fem::{DofMap, ElasticBody, MassForm, Mesh};
use crate::motion::Observation;
use crate::scene::input::obstacle::PlacedObstacle;
use crate::scene::{Units, Warning};
use build::explain;
use model::Model;
use resultants::Resultant;
use rows::ContactRow;
use set_up::{HeldNode, forces_at, held_nodes, mass_of_nodes, mass_of_unknowns, state};
use signorini_qp as qp;
use signorini_qp::{ContactProblem, SymmetricMatrix};
use unknowns::Meaning;

impl Model {
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

    /// The meaning of each unknown of the problem, in order.
    pub fn meanings(&self) -> impl Iterator<Item = Meaning> + '_ {
        self.parts.meanings()
    }

    /// Number of copies of the modelled part in the whole, by planes of symmetry.
    pub fn parts_of_whole(&self) -> f64 {
        self.parts.conditions.symmetry.parts()
    }

    /// The words behind numbers of the meshed part; empty without planes of symmetry.
    pub fn of_part(&self) -> &'static str {
        if self.parts_of_whole() > 1.0 { " of the meshed part" } else { "" }
    }

    /// The reference of the forces in a report, as `per metre, of the whole body, 2 times the meshed part`; empty if
    /// they are those of the whole body.
    ///
    /// With planes of symmetry the report gives the forces of the whole, a multiple of the modelled part. Without them
    /// the body counts as a part if a support lets a flat boundary slide along itself and prescribes nothing else: that
    /// may be a plane of symmetry.
    pub fn basis_of_forces(&self) -> String {
        resultants::basis_of_forces(self)
    }

    /// The names of the obstacles in reports: `obstacles[i]`, and `pair[k]` for the k-th obstacle that is another body.
    pub fn obstacle_names(&self) -> Vec<String> {
        resultants::obstacle_names(self)
    }

    /// The names of the supports in reports: `supports[i]`.
    pub fn support_names(&self) -> impl Iterator<Item = String> {
        (0..self.parts.scene.supports.len()).map(|index| format!("supports[{index}]"))
    }

    /// The names of the springs in reports: `springs[i]`.
    pub fn spring_names(&self) -> impl Iterator<Item = String> {
        (0..self.parts.conditions.springs.len()).map(|index| format!("springs[{index}]"))
    }

    /// The same scene with another scene-wide gap: only the contact rows are built again.
    ///
    /// # Errors
    /// [`Error::Scene`] for a gap that is not finite or puts a node so deep that it has no closest point,
    /// [`qp::Error::UnderHeld`] if the new rows leave a rigid-body mode free.
    pub fn with_gap(&self, gap: f64) -> Result<Self, Error> {
        model::with_gap(self, gap)
    }

    /// The same with obstacles that have moved along their approach directions, one entry per obstacle, in length: rows
    /// keep the normals that they have.
    pub fn with_moved_obstacles(&self, moved: &[f64]) -> Result<Self, Error> {
        model::with_moved_obstacles(self, moved)
    }

    /// The displacements of the obstacles along their approach directions in a motion, one entry per obstacle, in
    /// length, positive away from the body; empty if none moves.
    pub fn moved_obstacles(&self) -> &[f64] {
        &self.moved
    }

    /// The force that presses an obstacle, on the whole body; `None` if none does.
    pub fn pressing_force_on(&self, obstacle: usize) -> Option<f64> {
        let parts = self.parts.parts_of_obstacle(obstacle);
        let force = self.parts.travel(obstacle).map(|unknown| parts * self.problem.load()[unknown]);
        force.filter(|&force| force > 0.0)
    }

    /// The force on each obstacle that a force presses, in their order, in force.
    pub fn pressing_forces(&self) -> Vec<f64> {
        self.parts.pressed.iter().filter_map(|&obstacle| self.pressing_force_on(obstacle)).collect()
    }

    /// The held nodes: supports first, then springs, then rigid faces.
    pub fn held_nodes(&self) -> Vec<HeldNode> {
        held_nodes(self)
    }

    /// The loaded nodes, each with its force, in force: a component for each coordinate, in their order.
    pub fn loaded_nodes(&self) -> impl Iterator<Item = (usize, &[f64])> {
        let nodal = self.nodal_load().chunks_exact(self.mesh().dimension()).enumerate();
        nodal.filter(|(_, force)| force.iter().any(|&part| part != 0.0))
    }

    /// External loads at all nodes, length `dim * n_nodes`, order `[f_x0, f_y0, f_x1, ...]`, in force, along the
    /// positive axes.
    pub fn nodal_load(&self) -> &[f64] {
        &self.parts.conditions.load
    }

    /// The mass M (n x n) of the unknowns of the [problem](Model::problem), in one of its forms, in mass.
    ///
    /// # Errors
    /// [`Error::Scene`] for a material without density, and for a mesh too coarse to redistribute its mass.
    pub fn mass(&self, form: MassForm) -> Result<SymmetricMatrix, Error> {
        mass_of_unknowns(self, &mass_of_nodes(self, form)?)
    }

    /// Rewrites an error of a solver into the words of this scene; other errors are returned unchanged.
    ///
    /// [`Unbounded`](signorini_qp::Error::Unbounded) and [`UnderHeld`](signorini_qp::Error::UnderHeld) name the
    /// rigid-body mode; [`Infeasible`](signorini_qp::Error::Infeasible) names nodes, coordinates and obstacles.
    pub fn explain(&self, error: impl Into<Error>) -> Error {
        explain(self, error.into())
    }

    /// Nodal displacements, length `dim * n_nodes`, in length, from those of the free dofs; supports have their
    /// prescribed values.
    pub fn nodal_displacement(&self, displacement: &[f64]) -> Result<Vec<f64>, Error> {
        Ok(self.parts.conditions.dofs.expand(displacement)?)
    }

    /// Nodal velocities, length `dim * n_nodes`, in length over time, from those of the unknowns; supports stand still.
    pub fn nodal_velocity(&self, velocity: &[f64]) -> Result<Vec<f64>, Error> {
        Ok(self.parts.conditions.dofs.expand_motion(velocity)?)
    }

    /// Travel of an obstacle that a force presses, against its approach direction, in length, in a solution with these
    /// `displacement`s; `None` for an obstacle at rest.
    pub fn travel(&self, displacement: &[f64], obstacle: usize) -> Result<Option<f64>, Error> {
        qp::LinearError::check_length("displacement", displacement.len(), self.problem.dofs(), "unknowns")?;
        Ok(self.parts.travel(obstacle).map(|unknown| displacement[unknown]))
    }

    /// Contact pressure of each row, `-lambda` over the tributary area projected along the row, in force per area,
    /// `>= 0` in compression. `multiplier` has one entry per contact row, in force.
    ///
    /// The end of a quadratic edge on an axis of revolution has no tributary area, or next to none if the edge is
    /// curved; it shows the pressure of the candidate next to it.
    pub fn pressure(&self, multiplier: &[f64]) -> Result<Vec<f64>, Error> {
        model::pressure(self, multiplier)
    }

    /// Nodal contact forces on the body, `lambda n`, length `dim * n_nodes`, in force, along the positive axes; with
    /// two bodies the opposite forces on the other body. `multiplier` has one entry per contact row, in force, `<= 0`.
    /// On quadratic faces in space they are those of the shape functions: zero or negative at corners under a uniform
    /// pressure.
    pub fn contact_forces(&self, multiplier: &[f64]) -> Result<Vec<f64>, Error> {
        model::contact_forces(self, multiplier)
    }

    /// The sum of the contact forces on each obstacle and pair of bodies, one entry per obstacle in the order of the
    /// scene, in force, `>= 0`, for the multipliers of the rows (in force, `<= 0`); with planes of symmetry that of the
    /// whole body.
    pub fn obstacle_forces(&self, multiplier: &[f64]) -> Vec<f64> {
        model::obstacle_forces(self, multiplier)
    }

    /// The number of rows of each obstacle and pair of bodies with a force, in the order of the scene, for the
    /// multipliers of the rows (in force, `<= 0`).
    pub fn pressing_rows(&self, multiplier: &[f64]) -> Vec<usize> {
        model::pressing_rows(self, multiplier)
    }

    /// The resultants of the contact forces, obstacle by obstacle, from the multipliers of all rows (one entry per
    /// contact row, in force, `<= 0`).
    pub fn contact_resultants(&self, multiplier: &[f64]) -> Result<Vec<Resultant>, Error> {
        resultants::contact_resultants(self, multiplier)
    }

    /// Nodal support reactions on the body, length `dim * n_nodes`, in force, along the positive axes; zero along free
    /// dofs, so that a roller pushes along its normal. `multiplier` has one entry per contact row, in force, `<= 0`,
    /// then one per equation of a tie.
    ///
    /// They are the internal forces at the supported dofs, minus load and contact force there. The multiplier enters
    /// because a contact row may press on a supported dof.
    pub fn reactions(&self, displacement: &[f64], multiplier: &[f64]) -> Result<Vec<f64>, Error> {
        Ok(forces_at(self, displacement, multiplier)?.reactions)
    }

    /// The imbalance of loads, support reactions and contact forces on each body: the largest of the virtual works on
    /// its unit rigid-body modes (the resultant forces, and the resultant moments over half its size), relative to the
    /// sum of all force magnitudes. A body of revolution has one rigid-body mode, and its forces count along the axis.
    /// `multiplier` is that of [`Model::reactions`].
    pub fn force_balance(&self, displacement: &[f64], multiplier: &[f64]) -> Result<f64, Error> {
        Ok(forces_at(self, displacement, multiplier)?.balance)
    }

    /// The stress in the displaced body, per element and per node, in force per area, tension positive.
    pub fn stress(&self, displacement: &[f64]) -> Result<StressField, Error> {
        Ok(state(self, &self.nodal_displacement(displacement)?)?.stress)
    }

    /// The numbers of a motion of the whole body, from those of the meshed part: its force and its energies.
    pub fn of_whole(&self, seen: Observation) -> Observation {
        model::of_whole(self, seen)
    }
}
