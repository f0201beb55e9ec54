//! A phase: what the elements of one material in a body share.

use crate::error::Error;
use crate::fem::formulation::Formulation;
use crate::fem::material::{Law, Material};

/// A material and its law in the formulation of the body.
#[derive(Clone, Debug, PartialEq)]
pub struct Phase {
    material: Material,
    law: Law,
}

impl Phase {
    /// # Errors
    /// As [`Material::law`].
    pub(super) fn new(material: Material, formulation: &Formulation) -> Result<Self, Error> {
        Ok(Phase { material, law: material.law(formulation)? })
    }

    /// The material.
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// Its law.
    #[inline]
    pub fn law(&self) -> &Law {
        &self.law
    }
}
