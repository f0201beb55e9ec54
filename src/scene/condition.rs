//! Supports and loads of a scene, at the nodes.

use super::schema::{LoadSpec, Place, Scene};
use super::{PLACE_TOLERANCE, finite, number, point, vector, wrong};
use crate::assembly::{DofMap, add_body_force, add_pressure, add_traction};
use crate::body::ElasticBody;
use crate::error::Error;
use crate::mesh::{Boundary, Mesh};

/// Radii below this times the body's size lie on the axis of revolution.
const ON_THE_AXIS: f64 = 1e-12;

/// Prescribed displacements, and what prescribes each.
struct Held {
    prescribed: Vec<Option<f64>>,
    by: Vec<Holder>,
}

#[derive(Clone, Copy)]
enum Holder {
    Nothing,
    /// On the axis of revolution nothing moves radially.
    Axis,
    Support(usize),
}

impl Scene {
    pub(super) fn dofs(&self, body: &ElasticBody) -> Result<DofMap, Error> {
        let (mesh, dimension) = (body.mesh(), body.dimension());
        let mut held = Held { prescribed: vec![None; body.nodal_dofs()], by: vec![Holder::Nothing; body.nodal_dofs()] };
        if body.formulation().is_axisymmetric() {
            let near = ON_THE_AXIS * mesh.size();
            for node in (0..mesh.nodes().len()).filter(|&node| mesh.nodes()[node][0] <= near) {
                (held.prescribed[2 * node], held.by[2 * node]) = (Some(0.0), Holder::Axis);
            }
        }
        for (index, support) in self.supports.iter().enumerate() {
            let path = format!("supports[{index}]");
            let components = [("x", support.x), ("y", support.y), ("z", support.z)];
            if components.iter().all(|component| component.1.is_none()) {
                let names = ["x", "x or y, or both", "x, y or z, or several of them"][dimension - 1];
                return Err(wrong(path, format!("holds nothing; give {names}")));
            }
            let nodes = match &support.on {
                Place::Boundary(name) => boundary(mesh, name, &format!("{path}.on.boundary"))?.nodes(),
                Place::Point(at) => vec![node_at(mesh, at, &format!("{path}.on.point"))?],
            };
            for (axis, (name, value)) in components.into_iter().enumerate() {
                let Some(value) = value else { continue };
                let path = format!("{path}.{name}");
                if axis >= dimension {
                    return Err(wrong(path, format!("the model `{}` has no {name}", self.model.name())));
                }
                finite(path.as_str(), value)?;
                for &node in &nodes {
                    held.hold(dimension * node + axis, value, index).map_err(|other| {
                        let at = point(&mesh.nodes()[node][..dimension]);
                        wrong(path.as_str(), format!("{} contradicts {other} node {node} at {at}", number(value)))
                    })?;
                }
            }
        }
        if held.prescribed.iter().all(Option::is_some) {
            return Err(wrong("supports", "every node is held in all directions: nothing is left to solve for"));
        }
        DofMap::new(held.prescribed)
    }

    pub(super) fn load(&self, body: &ElasticBody) -> Result<Vec<f64>, Error> {
        let (mesh, dimension) = (body.mesh(), body.dimension());
        let mut load = vec![0.0; body.nodal_dofs()];
        for (index, spec) in self.loads.iter().enumerate() {
            let path = format!("loads[{index}]");
            match spec {
                LoadSpec::Traction(spec) => {
                    let boundary = boundary(mesh, &spec.boundary, &format!("{path}.traction.boundary"))?;
                    let traction = vector(&format!("{path}.traction.value"), &spec.value, dimension)?;
                    add_traction(body, boundary, traction, &mut load);
                }
                LoadSpec::Pressure(spec) => {
                    let boundary = boundary(mesh, &spec.boundary, &format!("{path}.pressure.boundary"))?;
                    finite(format!("{path}.pressure.value"), spec.value)?;
                    add_pressure(body, boundary, spec.value, &mut load);
                }
                LoadSpec::Force(spec) => {
                    let node = node_at(mesh, &spec.at, &format!("{path}.force.at"))?;
                    let force = vector(&format!("{path}.force.value"), &spec.value, dimension)?;
                    let entries = &mut load[dimension * node..dimension * (node + 1)];
                    entries.iter_mut().zip(force).for_each(|(entry, component)| *entry += component);
                }
                LoadSpec::BodyForce(value) => {
                    add_body_force(body, vector(&format!("{path}.body-force"), value, dimension)?, &mut load);
                }
            }
        }
        match load.iter().all(|value| value.is_finite()) {
            true => Ok(load),
            false => Err(wrong("loads", "the loads add up to a force that is not finite")),
        }
    }
}

impl Held {
    /// Prescribes `value` at a dof by support `support`.
    ///
    /// # Errors
    /// What holds the dof at another value, in words.
    fn hold(&mut self, dof: usize, value: f64, support: usize) -> Result<(), String> {
        match (self.prescribed[dof], self.by[dof]) {
            (Some(other), holder) if other != value => Err(match holder {
                Holder::Support(other_support) => {
                    format!("the {} that supports[{other_support}] prescribes for", number(other))
                }
                _ => "the axis of revolution, where nothing moves radially, at".into(),
            }),
            (Some(_), Holder::Axis) => Ok(()),
            _ => {
                (self.prescribed[dof], self.by[dof]) = (Some(value), Holder::Support(support));
                Ok(())
            }
        }
    }
}

pub(super) fn boundary<'a>(mesh: &'a Mesh, name: &str, path: &str) -> Result<&'a Boundary, Error> {
    mesh.boundary(name).ok_or_else(|| {
        let names: Vec<&str> = mesh.boundaries().iter().map(|boundary| boundary.name.as_str()).collect();
        wrong(path, format!("there is no boundary `{name}`; there are {}", names.join(", ")))
    })
}

fn node_at(mesh: &Mesh, at: &[f64], path: &str) -> Result<usize, Error> {
    let dimension = mesh.dimension();
    let place = vector(path, at, dimension)?;
    let away = |node: &[f64; 3]| (node[0] - place[0]).hypot(node[1] - place[1]).hypot(node[2] - place[2]);
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
