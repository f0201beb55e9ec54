//! The same scene on a finer mesh.

use super::entry::wrong;
use super::schema::Scene;
use crate::error::Error;

impl Scene {
    /// The scene with every cell of its bodies cut into `times` parts along each edge; graded meshes are nested.
    ///
    /// # Errors
    /// [`Error::Scene`] for `times` 0, and for a body from a mesh file, which cannot be refined.
    pub fn refined(&self, times: usize) -> Result<Scene, Error> {
        if times == 0 {
            return Err(wrong("body", "each edge of the cells must be divided into at least 1 part, not 0"));
        }
        let mut scene = self.clone();
        if times == 1 {
            return Ok(scene);
        }
        let further = scene.further_bodies.iter_mut().map(|further| &mut further.body);
        for body in std::iter::once(&mut scene.body).chain(further) {
            body.shape_mut().refine(times)?;
        }
        Ok(scene)
    }

    /// Returns `true` if a body has sides that approximate known circles or spheres, to which finer meshes come nearer.
    pub(crate) fn is_round(&self) -> bool {
        let further = self.further_bodies.iter().map(|further| &further.body);
        std::iter::once(&self.body).chain(further).any(|body| body.shape().is_round())
    }
}
