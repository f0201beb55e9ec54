//! The mass of a model.

use super::model::Model;
use crate::error::Error;
use crate::fem::MassForm;
use crate::fem::assembly::{free_mass, nodal_mass};
use crate::scene::input::entry::{located, wrong};
use signorini_qp::{SparseMatrix, SymmetricMatrix};

impl Model {
    /// The mass of the nodes, in one of its forms; the lower triangle.
    pub(crate) fn nodal_mass(&self, form: MassForm) -> Result<SparseMatrix, Error> {
        let contact_nodes: Vec<usize> = self.rows().iter().flat_map(|row| row.ends.iter().map(|end| end.0)).collect();
        nodal_mass(self.body(), form, &contact_nodes).map_err(|error| match error {
            Error::Mesh { message } => wrong("body", message),
            other => located(other, "material."),
        })
    }

    /// The mass of the unknowns, from that of the nodes.
    pub(crate) fn mass_of(&self, nodal_mass: &SparseMatrix) -> Result<SymmetricMatrix, Error> {
        let parts = &self.parts;
        let of_body = parts.unknowns.congruent(free_mass(&parts.body, &parts.dofs, nodal_mass)?)?;
        let of_obstacle = |obstacle: usize| {
            parts.share_of(obstacle, parts.obstacles[obstacle].inertia().map_or(0.0, |inertia| inertia.mass))
        };
        parts.unknowns.with_travels(&of_body, of_obstacle)
    }

    /// The mass M (n x n) of the unknowns of the [problem](Model::problem), in one of its forms, in mass.
    ///
    /// # Errors
    /// [`Error::Scene`] for a material without density, and for a mesh too coarse to redistribute its mass.
    pub fn mass(&self, form: MassForm) -> Result<SymmetricMatrix, Error> {
        self.mass_of(&self.nodal_mass(form)?)
    }
}
