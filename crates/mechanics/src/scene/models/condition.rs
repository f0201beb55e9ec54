//! Supports of a scene, at the nodes.

use super::held::{Component, Held, Holder, unit_normal};
use crate::error::Error;
use crate::fem::assembly::node_normals;
use crate::fem::body::ElasticBody;
use crate::fem::geometry::{COORDINATES, dot};
use crate::scene::input::entry::{boundary, finite, node_at, nodes_named_once, point, vector, wrong};
use crate::scene::input::profile::Profile;
use crate::scene::input::schema::{Place, Scene, SupportSpec};

/// Radii below this times the body's size lie on the axis of revolution.
pub(crate) const ON_THE_AXIS: f64 = 1e-12;

/// The normals of a flat boundary have one direction up to the rounding of coordinates: one minus the cosine of their
/// angle.
const FLAT: f64 = 1e-9;

impl Scene {
    /// The components of the displacement that the supports and the axis of revolution prescribe, node by node.
    pub(crate) fn held(&self, body: &ElasticBody) -> Result<Held, Error> {
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
                Place::Nodes(names) => nodes_named_once(mesh, names, &format!("{path}.on.nodes"))?,
            };
            let profile = support.profile.as_ref();
            let profile = profile.map(|spec| Profile::of(spec, &format!("{path}.profile"), body.dimension()));
            let profile = profile.transpose()?;
            for node in nodes {
                let factor = profile.as_ref().map_or(1.0, |profile| profile.at(mesh.nodes()[node]));
                for component in &components {
                    held.prescribe(node, Component { value: factor * component.value, ..*component });
                }
            }
        }
        Ok(held)
    }

    /// Returns `true` if a support lets a flat boundary slide along itself and prescribes nothing else: it may be a
    /// plane of symmetry.
    pub(crate) fn may_be_part(&self, body: &ElasticBody) -> Result<bool, Error> {
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

    /// The components prescribed by support number `index`.
    pub(crate) fn components(&self, index: usize, support: &SupportSpec) -> Result<Vec<Component>, Error> {
        let path = format!("supports[{index}]");
        let by = |field| Holder::Support { index, field };
        let dimension = self.model.dimension();
        let mut components = Vec::new();
        for (axis, (field, value)) in [("x", support.x), ("y", support.y), ("z", support.z)].into_iter().enumerate() {
            let Some(value) = value else { continue };
            if axis >= dimension {
                let message = format!("the model `{}` has no {field}", self.model.name());
                return Err(wrong(format!("{path}.{field}"), message));
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
                let message = "`value` is the displacement along `normal`; give `normal` too, or x, y or z instead";
                return Err(wrong(format!("{path}.value"), message));
            }
            (None, None) => {}
        }
        if components.is_empty() {
            let names =
                ["x", "at least one of x and y, or a normal", "at least one of x, y and z, or a normal"][dimension - 1];
            return Err(wrong(path, format!("holds nothing; give {names}")));
        }
        Ok(components)
    }
}
