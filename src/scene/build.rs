//! From a scene to a model: every value is checked where it is used, and named by its JSON path.

use std::path::Path;
use std::sync::Arc;

use super::elastic::locking;
use super::files::Files;
use super::model::Model;
use super::obstacle::{Obstacle, PlacedObstacle};
use super::parts::Parts;
use super::schema::Scene;
use crate::error::Error;
use crate::fem::body::ElasticBody;

impl Scene {
    /// Discretises the scene and poses its contact problem.
    ///
    /// # Errors
    /// [`Error::Scene`] for a value that describes no problem, [`Error::UnderHeld`] for a rigid-body mode that neither
    /// supports nor obstacles resist.
    pub fn build(&self) -> Result<Model, Error> {
        self.build_with(&[])
    }

    /// The same with obstacles of a user's own behind those of the scene, each with the name of the boundary whose nodes
    /// may touch it.
    ///
    /// # Errors
    /// As [`Scene::build`]; [`Error::Scene`] for a boundary that does not exist, and for a direction or a normal that is
    /// not of unit length or leads out of the model.
    pub fn build_with(&self, further: &[(&str, Arc<dyn Obstacle>)]) -> Result<Model, Error> {
        self.build_of(self.bodies()?, further)
    }

    /// The files that the scene names.
    pub(super) fn files(&self) -> Files<'_> {
        Files { folder: self.folder.as_deref().unwrap_or(Path::new("")), reads_outside: self.reads_outside }
    }

    /// The same of bodies that stand for those of the scene, in their order: on other meshes.
    pub(crate) fn build_of(
        &self,
        bodies: Vec<ElasticBody>,
        further: &[(&str, Arc<dyn Obstacle>)],
    ) -> Result<Model, Error> {
        let body = self.joined(bodies)?;
        let held = self.held(&body)?;
        let dofs = held.dofs(body.mesh())?;
        let (supports, is_part) = (self.supports.len(), self.may_be_part(&body)?);
        let load = self.load(&body)?;
        let path = |index: usize| format!("obstacles[{index}]");
        let mut obstacles = Vec::with_capacity(self.obstacles.len() + further.len());
        for (index, spec) in self.obstacles.iter().enumerate() {
            obstacles.push(PlacedObstacle::of_scene(spec, &path(index), &body, self.files())?);
        }
        for (boundary, obstacle) in further {
            let path = path(obstacles.len());
            obstacles.push(PlacedObstacle::of_user(boundary, obstacle.clone(), &path, &body)?);
        }
        let mut warnings: Vec<_> = locking(&body).into_iter().collect();
        warnings.extend(self.suspect(&body, &dofs)?);
        let (title, units) = (self.title.clone(), self.units.clone());
        let moves = self.analysis.is_some();
        Model::new(
            Parts { title, units, body, dofs, held, supports, is_part, load, obstacles, warnings, moves },
            self.gap,
        )
    }
}
