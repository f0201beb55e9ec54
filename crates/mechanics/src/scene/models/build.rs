//! From a scene to a model: every value is checked at its use, and errors name it by its JSON path.

use std::path::Path;
use std::sync::Arc;

use super::elastic::{locking, stiffness_jumps, unit_of_young};
use super::model::Model;
use super::parts::{Origin, Parts};
use super::unknowns::Unknowns;
use crate::error::Error;
use crate::fem::{DofMap, ElasticBody};
use crate::scene::input::entry::wrong;
use crate::scene::input::files::Files;
use crate::scene::input::obstacle::{Obstacle, PlacedObstacle, SideOrder};
use crate::scene::input::schema::{ContactSpec, Scene};

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
