//! The body of a scene: mesh, material, formulation.

use super::schema::{AxisSpec, BodySpec, ElementSpec, IntegrationSpec, ModelSpec, Scene, SolidElementSpec};
use super::{Warning, located, wrong};
use crate::body::{ElasticBody, Integration};
use crate::error::Error;
use crate::formulation::Formulation;
use crate::material::Material;
use crate::mesh::{self, Axis, ElementKind};

/// Above this ratio linear elements are known to lock noticeably; measured, quadratic ones do above the second.
const LOCKING_POISSON: [f64; 2] = [0.49, 0.499];

impl BodySpec {
    /// As it is written.
    fn name(&self) -> &'static str {
        match self {
            BodySpec::Rectangle(_) => "rectangle",
            BodySpec::Bar(_) => "bar",
            BodySpec::Box(_) => "box",
        }
    }
}

impl Scene {
    fn formulation(&self) -> Result<Formulation, Error> {
        let thickness = self.thickness;
        let formulation = match (self.model, &self.body) {
            (ModelSpec::Bar, BodySpec::Bar(spec)) => Formulation::Bar { area: spec.area },
            (ModelSpec::PlaneStrain, BodySpec::Rectangle(_)) => Formulation::PlaneStrain { thickness },
            (ModelSpec::PlaneStress, BodySpec::Rectangle(_)) => Formulation::PlaneStress { thickness },
            (ModelSpec::Axisymmetric, BodySpec::Rectangle(_)) => Formulation::Axisymmetric,
            (ModelSpec::Space, BodySpec::Box(_)) => Formulation::Space,
            (model, body) => {
                let fitting = match model {
                    ModelSpec::Bar => "bar",
                    ModelSpec::Space => "box",
                    _ => "rectangle",
                };
                let (body, model) = (body.name(), model.name());
                let message = format!("a {body} is no body of the model `{model}`; there it is a {fitting}");
                return Err(wrong(format!("body.{body}"), message));
            }
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
        let name = self.body.name();
        let lines = |spec: &AxisSpec, axis: &str| {
            let of =
                Axis { points: spec.points.clone(), divisions: spec.divisions.clone(), ratios: spec.ratios.clone() };
            of.coordinates().map_err(|error| wrong(format!("body.{name}.{axis}.{}", error.field), error.message))
        };
        let (mesh, integration) = match &self.body {
            BodySpec::Bar(spec) => (mesh::bar(&lines(&spec.x, "x")?), IntegrationSpec::Standard),
            BodySpec::Rectangle(spec) => {
                let kind = match spec.element {
                    ElementSpec::T3 => ElementKind::T3,
                    ElementSpec::T6 => ElementKind::T6,
                    ElementSpec::Q4 => ElementKind::Q4,
                    ElementSpec::Q8 => ElementKind::Q8,
                };
                (mesh::rectangle(&lines(&spec.x, "x")?, &lines(&spec.y, "y")?, kind), spec.integration)
            }
            BodySpec::Box(spec) => {
                let kind = match spec.element {
                    SolidElementSpec::Tet4 => ElementKind::Tet4,
                    SolidElementSpec::Hex8 => ElementKind::Hex8,
                };
                let (x, y, z) = (lines(&spec.x, "x")?, lines(&spec.y, "y")?, lines(&spec.z, "z")?);
                (mesh::cuboid(&x, &y, &z, kind), spec.integration)
            }
        };
        let at_body = |error| match error {
            Error::Mesh { message } => wrong(format!("body.{name}"), message),
            other => located(other, ""),
        };
        let body = ElasticBody::new(mesh.map_err(at_body)?, material, formulation).map_err(at_body)?;
        match integration {
            IntegrationSpec::Standard => Ok(body),
            IntegrationSpec::MeanDilatation => {
                body.with_integration(Integration::MeanDilatation).map_err(|error| match error {
                    Error::Mesh { message } => wrong(format!("body.{name}.integration"), message),
                    other => other,
                })
            }
        }
    }

    /// An error of the material at its place; the allowed range is that of the model.
    fn in_material(&self, error: Error) -> Error {
        let keeps_volume = !matches!(self.model, ModelSpec::Bar | ModelSpec::PlaneStress);
        match error {
            Error::Setting { name: "poisson", value, .. } if keeps_volume => {
                let allowed = match self.model {
                    ModelSpec::PlaneStrain => "above -1 and below 0.5 in plane strain",
                    ModelSpec::Axisymmetric => "above -1 and below 0.5 in an axisymmetric body",
                    _ => "above -1 and below 0.5 in space",
                };
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
