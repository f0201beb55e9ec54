//! Obstacles in space: a graph over two coordinates, most of them a curve of the plane turned or drawn out.

use std::sync::Arc;

use super::circle::Circle;
use super::height_map::{HeightMap, Reach};
use super::polyline::Polyline;
use super::shape::{misfit, positive};
use super::surface::Surface;
use super::way::Approachable;
use crate::error::Error;
use crate::fem::geometry::{cross, dot};
use crate::fem::mesh::Mesh;
use crate::scene::entry::{ROUNDING, number, point, vector, wrong};
use crate::scene::schema::{Approach, Rule, ShapeSpec};

/// An axis of a cylinder may lean by the rounding of its written components.
const PERPENDICULAR: f64 = 1e-9;

/// A surface in space, in its frame.
#[derive(Clone, Debug)]
pub(super) struct Solid {
    /// Orthonormal: two across the approach direction, and the approach direction.
    axes: [[f64; 3]; 3],
    origin: [f64; 3],
    form: Form,
    rounding: f64,
}

/// How the surface is made.
#[derive(Clone, Debug)]
enum Form {
    /// A curve symmetric to its axis, turned about it: towards = h(hypot(t1, t2)).
    Turned(Arc<dyn Surface>),
    /// A curve drawn out along the second axis: towards = h(t1).
    DrawnOut(Arc<dyn Surface>),
    /// A grid: towards = h(t1, t2).
    Grid(Arc<HeightMap>),
}

impl Solid {
    /// Checks the shape at JSON path `path`; `size` is the body's.
    pub fn new(shape: &ShapeSpec, path: &str, approach: Approach, size: f64) -> Result<Self, Error> {
        let (axis, sense) = approach.axis();
        let across = across(axis);
        let mut axes = [[0.0; 3]; 3];
        (axes[0][across[0]], axes[1][across[1]], axes[2][axis]) = (1.0, 1.0, sense);
        let rounding = ROUNDING * size;
        let path = format!("{path}.{}", shape.name());
        let (origin, form) = match shape {
            ShapeSpec::Sphere(spec) => {
                let radius = positive(format!("{path}.radius"), spec.radius)?;
                (apex(spec.centre, spec.apex, radius, &path, axes[2])?, Form::Turned(Arc::new(Circle { radius })))
            }
            ShapeSpec::Cylinder(spec) => {
                let radius = positive(format!("{path}.radius"), spec.radius)?;
                let origin = apex(spec.centre, spec.apex, radius, &path, axes[2])?;
                axes[1] = axis_across(spec.axis, &format!("{path}.axis"), axes[2])?;
                axes[0] = cross(axes[1], axes[2]);
                (origin, Form::DrawnOut(Arc::new(Circle { radius })))
            }
            ShapeSpec::Cone(spec) => {
                let origin = vector(&format!("{path}.apex"), &spec.apex, 3)?;
                let slope = positive(format!("{path}.slope"), spec.slope)?;
                (origin, Form::Turned(Arc::new(Polyline::wedge(slope))))
            }
            ShapeSpec::HeightMap(spec) => {
                let names = across.map(|axis| ["x", "y", "z"][axis]);
                let map = HeightMap::new(spec, &path, names, sense, size)?;
                ([0.0; 3], Form::Grid(Arc::new(map)))
            }
            shape => return Err(misfit(shape, path, 3)),
        };
        Ok(Solid { axes, origin, form, rounding })
    }

    /// The way from `node` to the surface shifted by `gap`, or `None` where it is out of reach.
    ///
    /// # Errors
    /// A predicate of the node, where it lies so deep that the rule makes no sense.
    pub fn row(&self, node: [f64; 3], gap: f64, rule: Rule) -> Result<Option<Approachable>, &'static str> {
        let from_origin = [0, 1, 2].map(|axis| node[axis] - self.origin[axis]);
        let [t1, t2, towards] = self.axes.map(|axis| dot(axis, from_origin));
        let towards = towards - gap;
        let along_approach = |height: Option<f64>| height.map(|height| ([0.0, 0.0, 1.0], height - towards));
        let way = match (&self.form, rule) {
            (Form::Turned(curve), Rule::Approach) => along_approach(curve.height(t1.hypot(t2))),
            (Form::DrawnOut(curve), Rule::Approach) => along_approach(curve.height(t1)),
            (Form::Grid(map), Rule::Approach) => along_approach(map.height([t1, t2])),
            (Form::Turned(curve), Rule::ClosestPoint) => {
                let radius = t1.hypot(t2);
                // The closest point lies in the half plane of the node; on the axis the normal has no part across it.
                let outwards = if radius > 0.0 { [t1 / radius, t2 / radius] } else { [0.0; 2] };
                let foot = curve.closest([radius, towards], self.rounding)?;
                foot.map(|foot| {
                    let [across, along] = foot.normal;
                    ([across * outwards[0], across * outwards[1], along], foot.distance)
                })
            }
            (Form::DrawnOut(curve), Rule::ClosestPoint) => {
                let foot = curve.closest([t1, towards], self.rounding)?;
                foot.map(|foot| ([foot.normal[0], 0.0, foot.normal[1]], foot.distance))
            }
            (Form::Grid(map), Rule::ClosestPoint) => map.closest([t1, t2, towards], self.rounding),
        };
        Ok(way.map(|(local, distance)| {
            let normal = [0, 1, 2].map(|i| (0..3).map(|axis| local[axis] * self.axes[axis][i]).sum());
            Approachable { normal, distance }
        }))
    }

    /// Every candidate must lie over the grid: a height map says nothing beyond its rim.
    pub fn check_reach(&self, path: &str, mesh: &Mesh, candidates: &[(usize, f64)]) -> Result<(), Error> {
        let Form::Grid(map) = &self.form else { return Ok(()) };
        for &(node, _) in candidates {
            let at = mesh.nodes()[node];
            let Some(Reach { field, name, range: (first, last), needed }) =
                map.beyond([dot(self.axes[0], at), dot(self.axes[1], at)])
            else {
                continue;
            };
            let (first, last, needed) = (number(first), number(last), number(needed));
            let message = format!(
                "the height map reaches from {name} = {first} to {last}, but candidate node {node} at {} needs it at \
                 {name} = {needed}",
                point(&at)
            );
            return Err(wrong(format!("{path}.{field}"), message));
        }
        Ok(())
    }
}

/// The two other axes, increasing.
fn across(axis: usize) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][axis]
}

fn apex(
    centre: Option<[f64; 3]>,
    apex: Option<[f64; 3]>,
    radius: f64,
    path: &str,
    approach: [f64; 3],
) -> Result<[f64; 3], Error> {
    match (centre, apex) {
        (None, Some(apex)) => vector(&format!("{path}.apex"), &apex, 3),
        (Some(centre), None) => {
            let centre = vector(&format!("{path}.centre"), &centre, 3)?;
            Ok([0, 1, 2].map(|axis| centre[axis] - radius * approach[axis]))
        }
        (Some(_), Some(_)) => Err(wrong(path, "gives both centre and apex; give one of them")),
        (None, None) => Err(wrong(path, "gives neither centre nor apex; give one of them")),
    }
}

/// The unit direction of a cylinder's axis.
fn axis_across(axis: [f64; 3], path: &str, approach: [f64; 3]) -> Result<[f64; 3], Error> {
    let axis = vector(path, &axis, 3)?;
    let largest = axis.iter().fold(0.0_f64, |largest, part| largest.max(part.abs()));
    if largest == 0.0 {
        return Err(wrong(path, "(0, 0, 0) has no direction; the axis needs a length"));
    }
    let scaled = axis.map(|part| part / largest);
    let lean = dot(scaled, approach);
    if lean.abs() > PERPENDICULAR {
        let message = format!("{} must be perpendicular to the approach direction {}", point(&axis), point(&approach));
        return Err(wrong(path, message));
    }
    let level = [0, 1, 2].map(|i| scaled[i] - lean * approach[i]);
    let length = dot(level, level).sqrt();
    Ok(level.map(|part| part / length))
}
