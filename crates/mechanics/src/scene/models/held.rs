//! Prescribed components of nodal displacements, combined in one frame per node, from the supports of a scene.

use std::collections::BTreeMap;

use crate::error::Error;
use crate::fem::assembly::{DofMap, Frame, node_normals, perpendicular};
use crate::fem::body::{ElasticBody, ON_THE_AXIS};
use crate::fem::geometry::{COORDINATES, dot, minus};
use crate::fem::mesh::Mesh;
use crate::scene::input::entry::{boundary, finite, node_at, nodes_named_once, number, point, vector, wrong};
use crate::scene::input::profile::Profile;
use crate::scene::input::schema::{PlaceSpec, Scene, SupportSpec};

/// A normal depends on the earlier ones if the sine of its angle to their span is below this: the rounding of written
/// components.
const DEPENDENT_NORMAL: f64 = 1e-9;

/// Dependent normals must agree in their values to within this, relative to the largest value.
const AGREEING: f64 = 1e-9;

/// A component of a unit normal below this is rounding.
const NO_COMPONENT: f64 = 1e-14;

/// The source of a prescribed component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Holder {
    /// The axis of revolution: there the radial displacement is zero.
    Axis,
    /// A plane of symmetry.
    Symmetry,
    /// A field of a support.
    Support { index: usize, field: &'static str },
}

impl Holder {
    /// Its name in messages.
    pub fn name(self) -> String {
        match self {
            Holder::Axis => "the axis of revolution".into(),
            Holder::Symmetry => "a plane of symmetry".into(),
            Holder::Support { index, .. } => format!("supports[{index}]"),
        }
    }
}

/// A prescribed component of a displacement: `direction . u = value`.
#[derive(Clone, Copy, Debug)]
pub struct Component {
    /// The direction of the prescribed component, [x, y, z], of length 1.
    pub direction: [f64; 3],
    /// The prescribed displacement, in length.
    pub value: f64,
    pub by: Holder,
}

/// The space spanned by the directions of a node's components.
#[derive(Debug, Default)]
struct Span {
    /// Orthonormal.
    axes: Vec<[f64; 3]>,
    /// The displacement along each.
    values: Vec<f64>,
}

/// A support of the scene, checked.
#[derive(Debug)]
pub struct Support {
    /// The name of its boundary; `None` if it holds single nodes.
    pub boundary: Option<String>,
    /// What it prescribes, where its profile is 1.
    pub components: Vec<Component>,
    pub profile: Option<Profile>,
}

/// The prescribed components of all nodes; a node without one is absent.
#[derive(Debug, Default)]
pub struct Held {
    nodes: BTreeMap<usize, Vec<Component>>,
    /// In the order of the scene.
    pub supports: Vec<Support>,
}

impl Held {
    pub fn prescribe(&mut self, node: usize, component: Component) {
        self.nodes.entry(node).or_default().push(component);
    }

    /// Removes the prescribed components of a node, and returns them.
    pub fn release(&mut self, node: usize) -> Vec<Component> {
        self.nodes.remove(&node).unwrap_or_default()
    }

    /// The dofs of `mesh`: a node that is held along coordinate axes only, or fully, needs no frame.
    pub fn dofs(&self, mesh: &Mesh) -> Result<DofMap, Error> {
        let dimension = mesh.dimension();
        let mut prescribed = vec![None; dimension * mesh.nodes().len()];
        let mut frames = BTreeMap::new();
        for (&node, components) in &self.nodes {
            let span = Span::of(components.clone()).map_err(|(by, message)| {
                let path = match by {
                    Holder::Axis => "supports".into(),
                    Holder::Symmetry => "symmetry".into(),
                    Holder::Support { index, field } => format!("supports[{index}].{field}"),
                };
                wrong(path, format!("{message} node {node} at {}", point(&mesh.nodes()[node][..dimension])))
            })?;
            let own = &mut prescribed[dimension * node..dimension * (node + 1)];
            let coordinates: Option<Vec<usize>> = span.axes.iter().map(|&axis| coordinate_of(axis)).collect();
            if let Some(coordinates) = coordinates {
                coordinates.into_iter().zip(span.values).for_each(|(coordinate, value)| own[coordinate] = Some(value));
            } else if span.axes.len() == dimension {
                own.iter_mut().zip(COORDINATES).for_each(|(place, axis)| *place = Some(span.along(axis)));
            } else {
                own.iter_mut().zip(span.values).for_each(|(place, value)| *place = Some(value));
                frames.insert(node, Frame::completing(&span.axes, dimension)?);
            }
        }
        if prescribed.iter().all(Option::is_some) {
            return Err(wrong("supports", "every node is held in all directions: nothing is left to solve for"));
        }
        Ok(DofMap::with_frames(prescribed, dimension, frames)?)
    }

    /// The held nodes with the directions along which they are held, each once.
    pub fn directions(&self) -> impl Iterator<Item = (usize, Vec<[f64; 3]>)> {
        self.nodes.iter().map(|(&node, components)| {
            let mut directions: Vec<[f64; 3]> = Vec::new();
            for component in components {
                let is_new = |known: &[f64; 3]| dot(*known, component.direction).abs() < 1.0 - DEPENDENT_NORMAL;
                if directions.iter().all(is_new) {
                    directions.push(component.direction);
                }
            }
            (node, directions)
        })
    }

    /// The force at each held node, shared among its holders: each gets the part along its own direction; if several
    /// have the same direction, the first gets it.
    pub fn shares(&self, force: impl Fn(usize) -> [f64; 3]) -> impl Iterator<Item = (usize, Vec<(Holder, [f64; 3])>)> {
        self.nodes.iter().map(move |(&node, components)| (node, shared(components, force(node))))
    }
}

/// A force in the span of the directions of some components, as a sum of forces along these directions.
fn shared(components: &[Component], force: [f64; 3]) -> Vec<(Holder, [f64; 3])> {
    let mut independent: Vec<(Component, [f64; 3])> = Vec::new();
    for component in components {
        let axes: Vec<[f64; 3]> = independent.iter().map(|entry| entry.1).collect();
        let rest = perpendicular(component.direction, &axes);
        if let Some(axis) = unit_normal(rest).filter(|_| dot(rest, rest).sqrt() > DEPENDENT_NORMAL) {
            independent.push((*component, axis));
        }
    }
    // Only the last direction has a component along its own axis.
    let mut left = force;
    let mut shares = Vec::with_capacity(independent.len());
    for (component, axis) in independent.iter().rev() {
        let amount = dot(left, *axis) / dot(component.direction, *axis);
        let share = component.direction.map(|part| amount * part);
        left = minus(left, share);
        shares.push((component.by, share));
    }
    shares
}

/// The unit vector of a normal; a normal along a coordinate axis gives exactly that axis, or its opposite. `None` for
/// zero.
pub(crate) fn unit_normal(normal: [f64; 3]) -> Option<[f64; 3]> {
    let largest = normal.iter().fold(0.0_f64, |largest, part| largest.max(part.abs()));
    let scaled = normal.map(|part| part / largest);
    let length = dot(scaled, scaled).sqrt();
    let unit = scaled.map(|part| if part.abs() < NO_COMPONENT * length { 0.0 } else { part / length });
    (largest > 0.0).then_some(unit)
}

impl Span {
    /// The span of some components. The coordinate axes go first: the values along them stay as they were written.
    ///
    /// # Errors
    /// The component that contradicts others, and the contradiction in words, without the node.
    fn of(mut components: Vec<Component>) -> Result<Self, (Holder, String)> {
        components.sort_by_key(|component| coordinate_of(component.direction).is_none());
        let mut span = Span::default();
        for (index, component) in components.iter().enumerate() {
            let implied = span.along(component.direction);
            let rest = perpendicular(component.direction, &span.axes);
            if dot(rest, rest).sqrt() > DEPENDENT_NORMAL {
                span.extend(component, implied, rest);
                continue;
            }
            let largest = span.values.iter().fold(component.value.abs(), |largest, value| largest.max(value.abs()));
            if (component.value - implied).abs() > AGREEING * largest {
                return Err((component.by, contradiction(component, implied, &components[..index])));
            }
        }
        Ok(span)
    }

    /// The displacement along a vector of the span.
    fn along(&self, vector: [f64; 3]) -> f64 {
        self.axes.iter().zip(&self.values).map(|(axis, value)| dot(vector, *axis) * value).sum()
    }

    /// Adds the axis along `rest`, the part of the component's direction at right angles to the span.
    fn extend(&mut self, component: &Component, implied: f64, rest: [f64; 3]) {
        // Once more: if a direction is close to the others, its rest is only roughly perpendicular to them.
        let Some(axis) = unit_normal(rest).and_then(|rest| unit_normal(perpendicular(rest, &self.axes))) else {
            return;
        };
        let axis = coordinate_of(axis).map_or(axis, |coordinate| COORDINATES[coordinate]);
        self.values.push((component.value - implied) / dot(component.direction, axis));
        self.axes.push(axis);
    }
}

/// The coordinate axis of a vector along it, in either sense.
fn coordinate_of(vector: [f64; 3]) -> Option<usize> {
    (0..3).find(|&axis| (0..3).all(|other| (vector[other] != 0.0) == (other == axis)))
}

/// A contradiction in words, without the node.
fn contradiction(component: &Component, implied: f64, before: &[Component]) -> String {
    let parallel = |other: &&Component| {
        let rest = perpendicular(component.direction, &[other.direction]);
        dot(rest, rest).sqrt() <= DEPENDENT_NORMAL
    };
    let prescribing: Vec<&Component> = match before.iter().find(parallel) {
        Some(other) => vec![other],
        None => before.iter().collect(),
    };
    let mut supports: Vec<usize> = Vec::new();
    let mut names: Vec<String> = Vec::new();
    for other in prescribing {
        match other.by {
            Holder::Axis | Holder::Symmetry => names.push(other.by.name()),
            Holder::Support { index, .. } => supports.push(index),
        }
    }
    supports.sort_unstable();
    supports.dedup();
    names.extend(supports.iter().map(|index| format!("supports[{index}]")));
    let verb = if names.len() == 1 { "prescribes" } else { "prescribe" };
    let last = names.pop().unwrap_or_default();
    let names = if names.is_empty() { last } else { format!("{} and {last}", names.join(", ")) };
    let (value, implied) = (number(component.value), number(implied + 0.0));
    format!("{value} contradicts the {implied} that {names} {verb} for")
}

/// The normals of a flat boundary have one direction up to the rounding of coordinates: one minus the cosine of their
/// angle.
const FLAT: f64 = 1e-9;

/// The components of the displacement that the supports and the axis of revolution prescribe, node by node.
pub(crate) fn held(scene: &Scene, body: &ElasticBody) -> Result<Held, Error> {
    let mesh = body.mesh();
    let mut held = Held::default();
    if body.formulation().is_axisymmetric() {
        let near = ON_THE_AXIS * mesh.size();
        for node in (0..mesh.nodes().len()).filter(|&node| mesh.nodes()[node][0] <= near) {
            held.prescribe(node, Component { direction: COORDINATES[0], value: 0.0, by: Holder::Axis });
        }
    }
    for (index, support) in scene.supports.iter().enumerate() {
        let path = format!("supports[{index}]");
        let components = components(scene, index, support)?;
        let nodes = match &support.on {
            PlaceSpec::Boundary(name) => boundary(mesh, name, &format!("{path}.on.boundary"))?.nodes(),
            PlaceSpec::Point(at) => vec![node_at(mesh, at, &format!("{path}.on.point"))?],
            PlaceSpec::Nodes(names) => nodes_named_once(mesh, names, &format!("{path}.on.nodes"))?,
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
        let boundary = if let PlaceSpec::Boundary(name) = &support.on { Some(name.clone()) } else { None };
        held.supports.push(Support { boundary, components, profile });
    }
    Ok(held)
}

/// Returns `true` if a support lets a flat boundary slide along itself and prescribes nothing else: it may be a
/// plane of symmetry.
pub(crate) fn may_be_part(held: &Held, body: &ElasticBody) -> bool {
    let slides = |support: &Support| {
        let boundary = support.boundary.as_ref().and_then(|name| body.mesh().boundary(name));
        let (Some(boundary), [only]) = (boundary, &support.components[..]) else { return false };
        let slides = |(_, normal): &(usize, [f64; 3])| dot(*normal, only.direction).abs() > 1.0 - FLAT;
        only.value == 0.0 && node_normals(body, boundary).iter().all(slides)
    };
    body.dimension() > 1 && held.supports.iter().any(slides)
}

/// The components prescribed by support number `index`.
fn components(scene: &Scene, index: usize, support: &SupportSpec) -> Result<Vec<Component>, Error> {
    let path = format!("supports[{index}]");
    let by = |field| Holder::Support { index, field };
    let dimension = scene.model.dimension();
    let mut components = Vec::new();
    for (axis, (field, value)) in [("x", support.x), ("y", support.y), ("z", support.z)].into_iter().enumerate() {
        let Some(value) = value else { continue };
        if axis >= dimension {
            let message = format!("the model `{}` has no {field}", scene.model.name());
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
