//! Supports and loads of a scene, at the nodes.

use super::entry::{PLACE_TOLERANCE, boundary, finite, point, vector, wrong};
use super::held::{COORDINATES, Component, Held, Holder, unit_normal};
use super::schema::{LoadSpec, Place, Scene, SupportSpec};
use crate::error::Error;
use crate::fem::assembly::{add_body_force, add_pressure, add_traction, node_normals};
use crate::fem::body::ElasticBody;
use crate::fem::geometry::{distance, dot};
use crate::fem::mesh::Mesh;

/// Radii below this times the body's size lie on the axis of revolution.
const ON_THE_AXIS: f64 = 1e-12;

/// The normals of a flat boundary are one direction but for the rounding of coordinates: one less the cosine of their angle.
const FLAT: f64 = 1e-9;

impl Scene {
    /// What holds the nodes.
    pub(super) fn held(&self, body: &ElasticBody) -> Result<Held, Error> {
        let mesh = body.mesh();
        let mut held = Held::default();
        if body.formulation().is_axisymmetric() {
            let near = ON_THE_AXIS * mesh.size();
            for node in (0..mesh.nodes().len()).filter(|&node| mesh.nodes()[node][0] <= near) {
                held.prescribe(node, Component { direction: COORDINATES[0], value: 0.0, by: Holder::Axis });
            }
        }
        for (index, support) in self.supports.iter().enumerate() {
            let path = format!("supports[{index}]");
            let components = self.components(index, support)?;
            let nodes = match &support.on {
                Place::Boundary(name) => boundary(mesh, name, &format!("{path}.on.boundary"))?.nodes(),
                Place::Point(at) => vec![node_at(mesh, at, &format!("{path}.on.point"))?],
            };
            for component in components {
                nodes.iter().for_each(|&node| held.prescribe(node, component));
            }
        }
        Ok(held)
    }

    /// Does a support let a flat boundary slide along itself, and nothing else? That may be a plane of symmetry.
    pub(super) fn may_be_part(&self, body: &ElasticBody) -> Result<bool, Error> {
        if body.dimension() == 1 {
            return Ok(false);
        }
        for (index, support) in self.supports.iter().enumerate() {
            let (Place::Boundary(name), [only]) = (&support.on, &self.components(index, support)?[..]) else {
                continue;
            };
            let boundary = boundary(body.mesh(), name, &format!("supports[{index}].on.boundary"))?;
            let slides = |(_, normal): &(usize, [f64; 3])| dot(*normal, only.direction).abs() > 1.0 - FLAT;
            if only.value == 0.0 && node_normals(body, boundary).iter().all(slides) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The components that support number `index` prescribes.
    pub(super) fn components(&self, index: usize, support: &SupportSpec) -> Result<Vec<Component>, Error> {
        let path = format!("supports[{index}]");
        let by = |field| Holder::Support { index, field };
        let dimension = self.model.dimension();
        let mut components = Vec::new();
        for (axis, (field, value)) in [("x", support.x), ("y", support.y), ("z", support.z)].into_iter().enumerate() {
            let Some(value) = value else { continue };
            if axis >= dimension {
                return Err(wrong(
                    format!("{path}.{field}"),
                    format!("the model `{}` has no {field}", self.model.name()),
                ));
            }
            finite(format!("{path}.{field}"), value)?;
            components.push(Component { direction: COORDINATES[axis], value, by: by(field) });
        }
        match (&support.normal, support.value) {
            (Some(normal), value) => {
                let field = format!("{path}.normal");
                let direction = unit_normal(vector(&field, normal, dimension)?).ok_or_else(|| {
                    wrong(field, format!("{} has no direction; the normal needs a length", point(normal)))
                })?;
                let value = value.unwrap_or(0.0);
                finite(format!("{path}.value"), value)?;
                components.push(Component { direction, value, by: by("normal") });
            }
            (None, Some(_)) => {
                let message = "a value is that along a normal; give the normal too, or x, y or z instead";
                return Err(wrong(format!("{path}.value"), message));
            }
            (None, None) => {}
        }
        if components.is_empty() {
            let names =
                ["x", "x or y, or both, or a normal", "x, y or z, or several of them, or a normal"][dimension - 1];
            return Err(wrong(path, format!("holds nothing; give {names}")));
        }
        Ok(components)
    }

    pub(super) fn load(&self, body: &ElasticBody) -> Result<Vec<f64>, Error> {
        let mut load = vec![0.0; body.nodal_dofs()];
        for index in 0..self.loads.len() {
            self.add_load(body, index, &mut load)?;
        }
        match load.iter().all(|value| value.is_finite()) {
            true => Ok(load),
            false => Err(wrong("loads", "the loads add up to a force that is not finite")),
        }
    }

    /// Adds load number `index` to the nodal load.
    pub(super) fn add_load(&self, body: &ElasticBody, index: usize, load: &mut [f64]) -> Result<(), Error> {
        let (mesh, dimension) = (body.mesh(), body.dimension());
        let path = format!("loads[{index}]");
        match &self.loads[index] {
            LoadSpec::Traction(spec) => {
                let boundary = boundary(mesh, &spec.boundary, &format!("{path}.traction.boundary"))?;
                let traction = vector(&format!("{path}.traction.value"), &spec.value, dimension)?;
                add_traction(body, boundary, traction, load);
            }
            LoadSpec::Pressure(spec) => {
                let boundary = boundary(mesh, &spec.boundary, &format!("{path}.pressure.boundary"))?;
                finite(format!("{path}.pressure.value"), spec.value)?;
                add_pressure(body, boundary, spec.value, load);
            }
            LoadSpec::Force(spec) => {
                let node = node_at(mesh, &spec.at, &format!("{path}.force.at"))?;
                let force = vector(&format!("{path}.force.value"), &spec.value, dimension)?;
                let entries = &mut load[dimension * node..dimension * (node + 1)];
                entries.iter_mut().zip(force).for_each(|(entry, component)| *entry += component);
            }
            LoadSpec::BodyForce(value) => {
                add_body_force(body, vector(&format!("{path}.body-force"), value, dimension)?, load);
            }
        }
        Ok(())
    }
}

fn node_at(mesh: &Mesh, at: &[f64], path: &str) -> Result<usize, Error> {
    let dimension = mesh.dimension();
    let place = vector(path, at, dimension)?;
    let away = |node: &[f64; 3]| distance(*node, place);
    let tolerance = PLACE_TOLERANCE * mesh.size();
    let there: Vec<usize> = (0..mesh.nodes().len()).filter(|&node| away(&mesh.nodes()[node]) <= tolerance).collect();
    match (&there[..], mesh.nearest_node(place)) {
        ([node], _) => Ok(*node),
        ([one, other, ..], _) => {
            let message =
                format!("nodes {one} and {other} of two bodies lie at {}; name a boundary instead", point(at));
            Err(wrong(path, message))
        }
        ([], Some((node, _))) => {
            let nearest = point(&mesh.nodes()[node][..dimension]);
            Err(wrong(path, format!("there is no node at {}; the nearest is node {node} at {nearest}", point(at))))
        }
        ([], None) => Err(wrong(path, "the mesh has no nodes")),
    }
}
