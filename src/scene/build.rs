//! From a scene to a model: every value is checked where it is used, and named by its JSON path.

use super::Obstacle;
use super::condition::boundary;
use super::elastic::locking;
use super::model::Model;
use super::parts::Parts;
use super::schema::Scene;
use crate::error::Error;
use crate::fem::assembly::tributary_areas;

impl Scene {
    /// Discretises the scene and poses its contact problem.
    ///
    /// # Errors
    /// [`Error::Scene`] for a value that describes no problem, [`Error::UnderHeld`] for a rigid motion that neither
    /// supports nor obstacles resist.
    pub fn build(&self) -> Result<Model, Error> {
        let body = self.elastic_body()?;
        let dofs = self.dofs(&body)?;
        let load = self.load(&body)?;
        let mut obstacles = Vec::with_capacity(self.obstacles.len());
        for (index, spec) in self.obstacles.iter().enumerate() {
            let path = format!("obstacles[{index}]");
            let boundary = boundary(body.mesh(), &spec.boundary, &format!("{path}.boundary"))?;
            obstacles.push(Obstacle::new(spec, &path, &body, tributary_areas(&body, boundary))?);
        }
        let warnings = locking(&body).into_iter().collect();
        let (title, units) = (self.title.clone(), self.units.clone());
        let moves = self.analysis.is_some();
        Model::new(Parts { title, units, body, dofs, load, obstacles, warnings, moves }, self.gap)
    }
}
