//! The body of a scene: mesh, material, formulation.

use super::schema::{BodySpec, IntegrationSpec, ModelSpec, Scene};
use super::{Warning, located, wrong};
use crate::body::{ElasticBody, Integration};
use crate::error::Error;
use crate::formulation::Formulation;
use crate::material::Material;

/// Above this ratio linear elements are known to lock noticeably; measured, quadratic ones do above the second.
const LOCKING_POISSON: [f64; 2] = [0.49, 0.499];

impl Scene {
    fn formulation(&self) -> Result<Formulation, Error> {
        let thickness = self.thickness;
        if self.body.dimension().is_some_and(|dimension| dimension != self.model.dimension()) {
            let fitting =
                ["bar", "rectangle, half-disc, ring or gmsh", "box, half-ball or gmsh"][self.model.dimension() - 1];
            let (body, model) = (self.body.name(), self.model.name());
            let message = format!("a {body} is no body of the model `{model}`; there it is a {fitting}");
            return Err(wrong(format!("body.{body}"), message));
        }
        let formulation = match (self.model, &self.body) {
            (ModelSpec::Bar, BodySpec::Bar(spec)) => Formulation::Bar { area: spec.area },
            // A mesh file says nothing of the cross-section.
            (ModelSpec::Bar, _) => Formulation::Bar { area: 1.0 },
            (ModelSpec::PlaneStrain, _) => Formulation::PlaneStrain { thickness },
            (ModelSpec::PlaneStress, _) => Formulation::PlaneStress { thickness },
            (ModelSpec::Axisymmetric, _) => Formulation::Axisymmetric,
            (ModelSpec::Space, _) => Formulation::Space,
        };
        let plane = matches!(formulation, Formulation::PlaneStrain { .. } | Formulation::PlaneStress { .. });
        if !plane && thickness != 1.0 {
            let message = format!("the model `{}` has no thickness; leave it out", self.model.name());
            return Err(wrong("thickness", message));
        }
        let prefix = if self.model == ModelSpec::Bar { "body.bar." } else { "" };
        formulation.check().map_err(|error| located(error, prefix))?;
        Ok(formulation)
    }

    pub(super) fn elastic_body(&self) -> Result<ElasticBody, Error> {
        let material = Material::new(self.material.young, self.material.poisson);
        let material = material.map_err(|error| self.in_material(error))?;
        let formulation = self.formulation()?;
        material.lame(&formulation).map_err(|error| self.in_material(error))?;
        let at_body = |error| match error {
            // A setting that stands beside the body: the thickness.
            Error::Setting { .. } => located(error, ""),
            other => self.at_body(other),
        };
        let body = ElasticBody::new(self.mesh()?, material, formulation).map_err(at_body)?;
        match self.body.integration() {
            IntegrationSpec::Standard => Ok(body),
            IntegrationSpec::MeanDilatation => {
                body.with_integration(Integration::MeanDilatation).map_err(|error| match error {
                    Error::Mesh { message } => wrong(format!("body.{}.integration", self.body.name()), message),
                    other => other,
                })
            }
        }
    }

    /// An error of the material at its place; the allowed range is that of the model.
    fn in_material(&self, error: Error) -> Error {
        let allowed = match self.model {
            ModelSpec::Bar => "above -1 and at most 0.5 in a bar",
            ModelSpec::PlaneStrain => "above -1 and below 0.5 in plane strain",
            ModelSpec::PlaneStress => "above -1 and at most 0.5 in plane stress",
            ModelSpec::Axisymmetric => "above -1 and below 0.5 in an axisymmetric body",
            ModelSpec::Space => "above -1 and below 0.5 in space",
        };
        match error {
            Error::Setting { name: "poisson", value, .. } => {
                located(Error::Setting { name: "poisson", value, allowed }, "material.")
            }
            other => located(other, "material."),
        }
    }
}

/// The warning of a body whose elements lock.
pub(super) fn locking(body: &ElasticBody) -> Option<Warning> {
    let (kind, poisson) = (body.mesh().kind(), body.material().poisson());
    let limit = LOCKING_POISSON[usize::from(kind.is_quadratic())];
    let locks = body.formulation().can_lock() && body.integration() == Integration::Standard && poisson > limit;
    locks.then(|| Warning::NearlyIncompressible { poisson, element: kind.name() })
}
