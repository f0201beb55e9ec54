//! From a scene to a model: every value is checked where it is used, and named by its JSON path.

use super::model::{Model, Parts};
use super::schema::{AxisSpec, BodySpec, ElementSpec, LoadSpec, Place, PlaneModel, Scene};
use super::{Obstacle, PLACE_TOLERANCE, Warning, finite, finite_pair, number, point, wrong};
use crate::assembly::{DofMap, add_body_force, add_traction, tributary_areas};
use crate::body::ElasticBody;
use crate::error::Error;
use crate::material::{Material, PlaneState};
use crate::mesh::{self, Axis, Boundary, ElementKind, Mesh};

/// Above this ratio linear elements in plane strain are known to lock noticeably.
const LOCKING_POISSON: f64 = 0.49;

impl Scene {
    /// Discretises the scene and poses its contact problem.
    ///
    /// # Errors
    /// [`Error::Scene`] for a value that describes no problem, [`Error::UnderHeld`] for a rigid motion that neither
    /// supports nor obstacles resist.
    pub fn build(&self) -> Result<Model, Error> {
        let material = self.material()?;
        let body = self.body(material)?;
        let dofs = self.dofs(body.mesh())?;
        let load = self.load(&body)?;
        let mut obstacles = Vec::with_capacity(self.obstacles.len());
        for (index, spec) in self.obstacles.iter().enumerate() {
            let path = format!("obstacles[{index}]");
            let boundary = boundary(body.mesh(), &spec.boundary, &format!("{path}.boundary"))?;
            obstacles.push(Obstacle::new(spec, &path, body.mesh(), tributary_areas(&body, boundary))?);
        }
        let mut warnings = Vec::new();
        if material.state() == PlaneState::PlaneStrain && material.poisson() > LOCKING_POISSON {
            warnings.push(Warning::NearlyIncompressible { poisson: material.poisson() });
        }
        let (title, units) = (self.title.clone(), self.units.clone());
        Model::new(Parts { title, units, body, dofs, load, obstacles, warnings }, self.gap)
    }

    fn material(&self) -> Result<Material, Error> {
        let state = match self.model {
            PlaneModel::PlaneStrain => PlaneState::PlaneStrain,
            PlaneModel::PlaneStress => PlaneState::PlaneStress,
        };
        Material::new(self.material.young, self.material.poisson, state).map_err(|error| located(error, "material."))
    }

    fn body(&self, material: Material) -> Result<ElasticBody, Error> {
        let BodySpec::Rectangle(spec) = &self.body;
        let kind = match spec.element {
            ElementSpec::T3 => ElementKind::T3,
            ElementSpec::Q4 => ElementKind::Q4,
        };
        let lines = |spec: &AxisSpec, name: &str| {
            let axis =
                Axis { points: spec.points.clone(), divisions: spec.divisions.clone(), ratios: spec.ratios.clone() };
            axis.coordinates().map_err(|error| wrong(format!("body.rectangle.{name}.{}", error.field), error.message))
        };
        let (x, y) = (lines(&spec.x, "x")?, lines(&spec.y, "y")?);
        let mesh = mesh::rectangle(&x, &y, kind).map_err(|error| located(error, ""))?;
        ElasticBody::new(mesh, material, self.thickness).map_err(|error| located(error, ""))
    }

    fn dofs(&self, mesh: &Mesh) -> Result<DofMap, Error> {
        let mut prescribed: Vec<Option<f64>> = vec![None; 2 * mesh.nodes().len()];
        let mut support_of: Vec<usize> = vec![0; prescribed.len()];
        for (index, support) in self.supports.iter().enumerate() {
            let path = format!("supports[{index}]");
            if support.x.is_none() && support.y.is_none() {
                return Err(wrong(path, "holds nothing; give x or y, or both"));
            }
            let nodes = match &support.on {
                Place::Boundary(name) => boundary(mesh, name, &format!("{path}.on.boundary"))?.nodes(),
                Place::Point(at) => vec![node_at(mesh, *at, &format!("{path}.on.point"))?],
            };
            for (axis, (name, value)) in [("x", support.x), ("y", support.y)].into_iter().enumerate() {
                let Some(value) = value else { continue };
                finite(format!("{path}.{name}"), value)?;
                for &node in &nodes {
                    let dof = 2 * node + axis;
                    match prescribed[dof] {
                        Some(other) if other != value => {
                            let message = format!(
                                "{} contradicts the {} that supports[{}] prescribes for node {node} at {}",
                                number(value),
                                number(other),
                                support_of[dof],
                                point(mesh.nodes()[node])
                            );
                            return Err(wrong(format!("{path}.{name}"), message));
                        }
                        _ => (prescribed[dof], support_of[dof]) = (Some(value), index),
                    }
                }
            }
        }
        if prescribed.iter().all(Option::is_some) {
            return Err(wrong("supports", "every node is held in both directions: nothing is left to solve for"));
        }
        DofMap::new(prescribed)
    }

    fn load(&self, body: &ElasticBody) -> Result<Vec<f64>, Error> {
        let mut load = vec![0.0; 2 * body.mesh().nodes().len()];
        for (index, spec) in self.loads.iter().enumerate() {
            let path = format!("loads[{index}]");
            match spec {
                LoadSpec::Traction(spec) => {
                    let boundary = boundary(body.mesh(), &spec.boundary, &format!("{path}.traction.boundary"))?;
                    finite_pair(&format!("{path}.traction.value"), spec.value)?;
                    add_traction(body, boundary, spec.value, &mut load);
                }
                LoadSpec::Force(spec) => {
                    let node = node_at(body.mesh(), spec.at, &format!("{path}.force.at"))?;
                    finite_pair(&format!("{path}.force.value"), spec.value)?;
                    load[2 * node] += spec.value[0];
                    load[2 * node + 1] += spec.value[1];
                }
                LoadSpec::BodyForce(value) => {
                    finite_pair(&format!("{path}.body-force"), *value)?;
                    add_body_force(body, *value, &mut load);
                }
            }
        }
        match load.iter().all(|value| value.is_finite()) {
            true => Ok(load),
            false => Err(wrong("loads", "the loads add up to a force that is not finite")),
        }
    }
}

/// An error of a lower module at its place in the scene.
fn located(error: Error, prefix: &str) -> Error {
    match error {
        Error::Setting { name, value, allowed } => {
            wrong(format!("{prefix}{name}"), format!("{} is not allowed: it must be {allowed}", number(value)))
        }
        Error::Mesh { message } => wrong("body.rectangle", message),
        other => other,
    }
}

fn boundary<'a>(mesh: &'a Mesh, name: &str, path: &str) -> Result<&'a Boundary, Error> {
    mesh.boundary(name).ok_or_else(|| {
        let names: Vec<&str> = mesh.boundaries().iter().map(|boundary| boundary.name.as_str()).collect();
        wrong(path, format!("there is no boundary `{name}`; there are {}", names.join(", ")))
    })
}

fn node_at(mesh: &Mesh, at: [f64; 2], path: &str) -> Result<usize, Error> {
    finite_pair(path, at)?;
    match mesh.nearest_node(at) {
        Some((node, distance)) if distance <= PLACE_TOLERANCE * mesh.size() => Ok(node),
        Some((node, _)) => {
            let nearest = point(mesh.nodes()[node]);
            Err(wrong(path, format!("there is no node at {}; the nearest is node {node} at {nearest}", point(at))))
        }
        None => Err(wrong(path, "the mesh has no nodes")),
    }
}
