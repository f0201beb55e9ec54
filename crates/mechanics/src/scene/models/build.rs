//! From a scene to a model: every value is checked at its use, and errors name it by its JSON path. Errors of the
//! solvers in the words of the scene.

use std::path::Path;
use std::sync::Arc;

use super::elastic::{locking, stiffness_jumps, unit_of_young};
use super::model::Model;
use super::parts::{Origin, Parts};
use super::rigid_body_modes::RigidBodyModes;
use super::rigid_body_modes::soft::SoftMotion;
use super::rows::ContactRow;
use super::unknowns::Unknowns;
use crate::error::Error;
use crate::fem::assembly::DofMap;
use crate::fem::body::ElasticBody;
use crate::scene::input::entry::{COORDINATE_ROUNDING, Files, number, point, six_digits, wrong};
use crate::scene::input::obstacle::{Obstacle, PlacedObstacle, SideOrder};
use crate::scene::input::schema::{ContactSpec, Scene};
use signorini_qp as qp;

impl Scene {
    /// Discretises the scene and sets up its contact problem.
    ///
    /// # Errors
    /// [`Error::Scene`] for a value that describes no problem; of a deck
    /// [`qp::LinearError::FileSyntax`](signorini_qp::LinearError::FileSyntax) with its line;
    /// [`qp::Error::UnderHeld`](signorini_qp::Error::UnderHeld) for a rigid-body mode that neither supports nor
    /// obstacles resist.
    pub fn build(&self) -> Result<Model, Error> {
        self.build_with(&[])
    }

    /// The same with user-defined obstacles after those of the scene, each with the name of the boundary that may touch
    /// it.
    ///
    /// # Errors
    /// As [`Scene::build`]; [`Error::Scene`] for a boundary that does not exist, and for a direction or a normal that
    /// is not of unit length or leads out of the model.
    pub fn build_with(&self, further: &[(&str, Arc<dyn Obstacle>)]) -> Result<Model, Error> {
        self.bodies().and_then(|bodies| self.build_of(bodies, further)).map_err(|error| self.with_line(error))
    }

    /// As [`Scene::build`], for a scene that may take at most `most` bytes.
    ///
    /// # Errors
    /// As [`Scene::build`]; [`qp::Error::TooLarge`](signorini_qp::Error::TooLarge) before the assembly of bodies that
    /// are too large.
    pub fn build_within(&self, most: f64) -> Result<Model, Error> {
        let within = |bodies: Vec<_>| Scene::check_bodies(&bodies, most).and_then(|()| self.build_of(bodies, &[]));
        self.bodies().and_then(within).map_err(|error| self.with_line(error))
    }

    pub(crate) fn files(&self) -> Files<'_> {
        Files { folder: self.folder.as_deref().unwrap_or(Path::new("")), reads_outside: self.reads_outside }
    }

    /// The same for other meshes of the bodies, given in the order of the scene.
    pub(crate) fn build_of(
        &self,
        bodies: Vec<ElasticBody>,
        further: &[(&str, Arc<dyn Obstacle>)],
    ) -> Result<Model, Error> {
        let body = self.with_parts(self.joined(bodies)?)?;
        match self.contact {
            Some(ContactSpec::Auto) => {
                let (scene, body) = self.with_contacts(body)?;
                scene.build_joined(body, further)
            }
            None => self.build_joined(body, further),
        }
    }

    /// The model of all bodies in one.
    fn build_joined(&self, body: ElasticBody, further: &[(&str, Arc<dyn Obstacle>)]) -> Result<Model, Error> {
        let (symmetry, points) = (self.planes_of_symmetry(&body)?, self.reference_points(&body)?);
        let springs = self.springs(&body, &points)?;
        let mut held = self.held(&body)?;
        symmetry.hold(&body, &mut held);
        let rigid_faces = self.rigid_faces(&body, &mut held)?;
        let dofs = self.with_contact_faces(held.dofs(body.mesh())?, &body, further);
        let (supports, is_part) = (self.supports.len(), self.may_be_part(&body)?);
        let mut load = self.load(&body)?;
        points.add_load(&mut load, body.dimension());
        let obstacles = self.placed_obstacles(&body, &dofs, further)?;
        let mut warnings = self.noted.clone();
        warnings.extend(locking(&body));
        warnings.extend(stiffness_jumps(&body));
        warnings.extend(unit_of_young(&body, &self.units));
        warnings.extend(self.suspect(&body, &dofs)?);
        let (title, units) = (self.title.clone(), self.units.clone());
        let (moves, vibrates) = (self.dynamic().is_some(), self.modes().is_some());
        let nodes = body.mesh().nodes();
        let unknowns = Unknowns::of(nodes, &dofs, body.dimension(), &rigid_faces, &obstacles)?;
        let ties = self.tied(&body, (&dofs, &unknowns), &points)?;
        warnings.extend(ties.warnings.iter().cloned());
        for &index in &unknowns.pressed {
            let (key, message) = match (moves, obstacles[index].inertia()) {
                (true, None) => (
                    "force",
                    "in a motion an obstacle that a force presses needs its `mass`; give it, or let the obstacle stand",
                ),
                (false, Some(_)) if !vibrates => {
                    ("mass", "only motions and modes have masses; leave it out of an equilibrium, or give `analysis`")
                }
                _ => continue,
            };
            return Err(wrong(format!("obstacles[{index}].{key}"), message));
        }
        Model::new(
            Parts {
                title,
                units,
                body,
                dofs,
                held,
                supports,
                is_part,
                load,
                springs,
                symmetry,
                rigid_faces,
                obstacles,
                unknowns,
                ties,
                points,
                warnings,
                moves,
                vibrates,
                is_linear: self.is_linear,
                origin: match self.contact {
                    _ if !self.lines.is_empty() => Origin::Deck,
                    Some(ContactSpec::Auto) => Origin::WithAuto,
                    None => Origin::Scene,
                },
            },
            self.gap,
        )
    }

    /// The obstacles of the scene, then those of the user.
    fn placed_obstacles(
        &self,
        body: &ElasticBody,
        dofs: &DofMap,
        further: &[(&str, Arc<dyn Obstacle>)],
    ) -> Result<Vec<PlacedObstacle>, Error> {
        let path = |index: usize| format!("obstacles[{index}]");
        let mut obstacles = Vec::with_capacity(self.obstacles.len() + further.len());
        let bodies =
            self.obstacles.iter().filter_map(|spec| Some([&*spec.boundary, spec.shape.shape().other_boundary()?]));
        let order = SideOrder::of(body, bodies.flatten().filter_map(|name| body.mesh().boundary(name)));
        for (index, spec) in self.obstacles.iter().enumerate() {
            obstacles.push(PlacedObstacle::of_scene(spec, &path(index), (body, dofs, &order), self.files())?);
        }
        let rows = obstacles
            .iter()
            .enumerate()
            .flat_map(|(index, obstacle)| obstacle.all_facing().map(move |row| (index, row)));
        if let Some(index) = order.circle(body, rows) {
            let (own, other) = (obstacles[index].boundary(), obstacles[index].other_body().map_or("", |other| other.0));
            let message = format!(
                "the rows of `{own}` lead to nodes of `{other}` that carry rows which lead back, so that a contact would count twice; \
                 leave out `side`, or one of the obstacles"
            );
            return Err(wrong(format!("{}.shape.body.side", path(index)), message));
        }
        for (boundary, obstacle) in further {
            let path = path(obstacles.len());
            obstacles.push(PlacedObstacle::of_user(boundary, obstacle.clone(), &path, body)?);
        }
        Ok(obstacles)
    }

    /// The dofs with coefficients on the quadratic faces that may touch an obstacle or are tied.
    fn with_contact_faces(&self, dofs: DofMap, body: &ElasticBody, further: &[(&str, Arc<dyn Obstacle>)]) -> DofMap {
        let of_scene = self
            .obstacles
            .iter()
            .flat_map(|spec| [Some(spec.boundary.as_str()), spec.shape.shape().other_boundary()].into_iter().flatten());
        let tied = self.tied_surfaces().flatten();
        dofs.with_contact_faces(body, of_scene.chain(tied).chain(further.iter().map(|(boundary, _)| *boundary)))
    }
}

/// More nodes than this are counted, not listed.
const LISTED_NODES: usize = 3;

impl Model {
    /// Rewrites an error of a solver into the words of this scene; other errors are returned unchanged.
    ///
    /// [`qp::Error::Unbounded`] and [`qp::Error::UnderHeld`] name the rigid-body mode; [`qp::Error::Infeasible`] names
    /// nodes, coordinates and obstacles.
    pub fn explain(&self, error: impl Into<Error>) -> Error {
        match error.into() {
            Error::Qp(qp::Error::Unbounded { mode, direction }) => {
                let mode = self.named(&direction).map_or(mode, |(name, _)| name);
                qp::Error::Unbounded { mode, direction }.into()
            }
            Error::Qp(qp::Error::UnderHeld { mode, direction }) => {
                let mode = self.named(&direction).map_or(mode, |(name, advice)| format!("{name}: {advice}"));
                qp::Error::UnderHeld { mode, direction }.into()
            }
            Error::Qp(qp::Error::Infeasible { reason, rows, weights, overlap }) => {
                let length = &self.units().length;
                let by =
                    if overlap > 0.0 { format!("; they overlap by {overlap:.3e} {length}") } else { String::new() };
                let reason = self.describe_rows(&rows).map_or(reason, |rows| format!("{rows}{}", by.trim_end()));
                qp::Error::Infeasible { reason, rows, weights, overlap }.into()
            }
            other => other,
        }
    }

    /// The rigid motions of an answer that contact without friction hardly resists, from its nodal displacement and its
    /// closed rows with their forces.
    pub(crate) fn soft_motions(
        &self,
        displacement: &[f64],
        closed: &[(&ContactRow, f64)],
    ) -> Result<Vec<SoftMotion>, Error> {
        RigidBodyModes::of_parts(&self.parts).soft_motions(&self.parts, closed, displacement)
    }

    /// A node with its coordinates, as `node 5 at (0.25, 1)`.
    pub(crate) fn node_in_words(&self, node: usize) -> String {
        format!("node {node}{} at {}", self.of_part(), self.place_in_words(node))
    }

    /// The words behind numbers of the meshed part; empty without planes of symmetry.
    pub fn of_part(&self) -> &'static str {
        if self.parts_of_whole() > 1.0 { " of the meshed part" } else { "" }
    }

    /// The coordinates of a node to six digits; those of rounding are 0.
    pub(crate) fn place_in_words(&self, node: usize) -> String {
        let rounding = COORDINATE_ROUNDING * self.mesh().size();
        let at = self.mesh().nodes()[node].map(|value| if value.abs() <= rounding { 0.0 } else { six_digits(value) });
        point(&at[..self.mesh().dimension()])
    }

    /// The name of a rigid-body motion, and the advice against it.
    fn named(&self, direction: &[f64]) -> Option<(String, String)> {
        let parts = &self.parts;
        let motion = parts.dofs.expand_motion(&parts.unknowns.motion(direction).ok()?).ok()?;
        let modes = RigidBodyModes::of(&parts.body);
        let amplitudes = modes.closest(parts.body.mesh().nodes(), &motion)?;
        Some((modes.name_of(&amplitudes), modes.advice(parts, self.rows(), &[amplitudes])))
    }

    fn describe_rows(&self, rows: &[usize]) -> Option<String> {
        let mut by_node: Vec<(usize, Vec<usize>)> = Vec::new();
        for &row in rows {
            let node = self.rows().get(row)?.node;
            match by_node.iter_mut().find(|entry| entry.0 == node) {
                Some(entry) => entry.1.push(row),
                None => by_node.push((node, vec![row])),
            }
        }
        let mut parts: Vec<String> =
            by_node.iter().take(LISTED_NODES).map(|(node, rows)| self.describe_node(*node, rows)).collect();
        if by_node.len() > LISTED_NODES {
            parts.push(format!("{} more nodes", by_node.len() - LISTED_NODES));
        }
        (!parts.is_empty()).then(|| parts.join("; "))
    }

    fn describe_node(&self, node: usize, rows: &[usize]) -> String {
        let obstacle = |row: &usize| {
            let row = &self.rows()[*row];
            format!("obstacles[{}] (gap {})", row.obstacle, number(row.gap))
        };
        let dimension = self.mesh().dimension();
        let node_at = self.node_in_words(node);
        let names: Vec<String> = rows.iter().map(obstacle).collect();
        let supported = (0..dimension).all(|axis| self.parts.dofs.number(dimension * node + axis).is_none());
        match names.as_slice() {
            [one] if supported => format!("{node_at} is supported inside {one}"),
            [one] => format!("{node_at} cannot leave {one}"),
            _ => format!("{node_at} has no room between {}", names.join(" and ")),
        }
    }
}
