//! Obstacles: a surface in a frame, the rule of its contact rows, and the candidates that may touch it.

mod circle;
mod facing;
mod frame;
mod half_space;
mod height_map;
mod parabola;
mod patch;
mod plane;
mod polyline;
mod profile;
mod solid;
mod surface;

use super::schema::{ObstacleSpec, PlaneSpec, Rule, ShapeSpec};
use super::{finite, number, point, vector, wrong};
use crate::error::Error;
use crate::fem::body::ElasticBody;
use facing::Facing;
use frame::Frame;
use half_space::HalfSpace;
use profile::Profile;
use solid::Solid;

/// A component of a unit normal below this is rounding of the geometry, not a direction.
const NO_COMPONENT: f64 = 1e-14;

/// The way from a node to an obstacle: `normal . u <= distance`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Approachable {
    /// Unit vector [x, y, z] into the obstacle.
    pub normal: [f64; 3],
    /// Signed distance along it; negative inside.
    pub distance: f64,
}

/// An obstacle of a model: rigid, or the surface of another body.
#[derive(Clone, Debug)]
pub struct Obstacle {
    boundary: String,
    candidates: Vec<(usize, f64)>,
    rule: Rule,
    approach: [f64; 3],
    geometry: Geometry,
}

/// What an obstacle looks like.
#[derive(Clone, Debug)]
enum Geometry {
    /// In the plane: a graph over the coordinate across the approach direction.
    Profile(Profile),
    /// On a line or in space: a plane.
    HalfSpace(HalfSpace),
    /// In space: a graph over the two coordinates across the approach direction.
    Solid(Solid),
    /// The nodes of another body.
    Facing(Facing),
}

impl Obstacle {
    /// Checks the obstacle at JSON path `path`; `candidates` are the nodes of its boundary with their tributary areas.
    pub(super) fn new(
        spec: &ObstacleSpec,
        path: &str,
        body: &ElasticBody,
        candidates: Vec<(usize, f64)>,
    ) -> Result<Self, Error> {
        let mesh = body.mesh();
        let dimension = mesh.dimension();
        let (axis, sense) = spec.approach.axis();
        if axis >= dimension {
            let names = ["x", "x and y", "x, y and z"][dimension - 1];
            let message = format!("`{}` is no direction of this model, which has {names}", spec.approach.name());
            return Err(wrong(format!("{path}.approach"), message));
        }
        let mut approach = [0.0; 3];
        approach[axis] = sense;
        let shape_path = format!("{path}.shape");
        let geometry = match (&spec.shape, Frame::of(spec.approach).filter(|_| dimension == 2)) {
            (shape, _) if !fits(shape, dimension) => return Err(misfit(shape, shape_path, dimension)),
            (ShapeSpec::Body(facing), _) => {
                Geometry::Facing(Facing::new(facing, spec, path, body, approach, &candidates)?)
            }
            (_, Some(frame)) => Geometry::Profile(Profile::new(spec, &shape_path, mesh, frame)?),
            (ShapeSpec::Plane(plane), None) => {
                let (point, normal) = plane_of(plane, &format!("{shape_path}.plane"), dimension, approach)?;
                Geometry::HalfSpace(HalfSpace { point, normal })
            }
            (shape, None) => Geometry::Solid(Solid::new(shape, &shape_path, spec.approach, mesh.size())?),
        };
        let obstacle = Obstacle { boundary: spec.boundary.clone(), candidates, rule: spec.rule, approach, geometry };
        match (&spec.shape, &obstacle.geometry) {
            (ShapeSpec::Table(_), Geometry::Profile(profile)) => {
                profile.check_reach(&format!("{shape_path}.table.points"), mesh, &obstacle.candidates)?;
            }
            (ShapeSpec::HeightMap(_), Geometry::Solid(solid)) => {
                solid.check_reach(&format!("{shape_path}.height-map"), mesh, &obstacle.candidates)?;
            }
            _ => {}
        }
        Ok(obstacle)
    }

    /// Name of the boundary whose nodes are its candidates.
    pub fn boundary(&self) -> &str {
        &self.boundary
    }

    /// Is it no body of its own?
    pub fn is_rigid(&self) -> bool {
        !matches!(self.geometry, Geometry::Facing(_))
    }

    /// How its contact rows are made.
    pub fn rule(&self) -> Rule {
        self.rule
    }

    /// The approach direction [x, y, z], of length 1: from the body to the obstacle.
    pub fn approach(&self) -> [f64; 3] {
        self.approach
    }

    /// The candidate nodes, in the order of the boundary, each with its tributary area.
    pub fn candidates(&self) -> &[(usize, f64)] {
        &self.candidates
    }

    /// The surface as a polyline [x, y] for pictures: over the body's extent and a little more, shifted by `gap`
    /// along the approach direction, in `segments` pieces (10,000 at most), corners met exactly. The obstacle lies on
    /// the side that [`approach`](Self::approach) points to. Empty where the surface does not reach over the body, for
    /// another body, and outside the plane.
    pub fn outline(&self, gap: f64, segments: usize) -> Vec<[f64; 2]> {
        match &self.geometry {
            Geometry::Profile(profile) => profile.outline(gap, segments),
            Geometry::HalfSpace(_) | Geometry::Solid(_) | Geometry::Facing(_) => Vec::new(),
        }
    }

    /// The node of another body across the candidate of this index; `None` where the obstacle is rigid.
    pub(super) fn partner(&self, candidate: usize) -> Option<usize> {
        match &self.geometry {
            Geometry::Facing(facing) => facing.partner(candidate),
            _ => None,
        }
    }

    /// The way from the candidate of this index, which lies at `node`, to the surface shifted by `gap`, or `None` where
    /// it is out of reach.
    ///
    /// # Errors
    /// A predicate of the node, where it lies so deep that the rule makes no sense.
    pub(super) fn row(&self, candidate: usize, node: [f64; 3], gap: f64) -> Result<Option<Approachable>, &'static str> {
        let way = match &self.geometry {
            Geometry::Profile(profile) => profile.row(node, gap, self.rule)?,
            Geometry::HalfSpace(half_space) => Some(half_space.row(node, gap, self.approach, self.rule)),
            Geometry::Solid(solid) => solid.row(node, gap, self.rule)?,
            Geometry::Facing(facing) => facing.row(candidate, gap, self.approach),
        };
        match way {
            Some(way) if way.distance.is_nan() => Err("has no distance that could be computed"),
            Some(way) if way.distance.is_finite() => {
                let normal = way.normal.map(|c| if c.abs() < NO_COMPONENT { 0.0 } else { c });
                Ok(Some(Approachable { normal, ..way }))
            }
            _ => Ok(None),
        }
    }
}

/// Whether a model of `dimension` coordinates has the shape.
fn fits(shape: &ShapeSpec, dimension: usize) -> bool {
    match shape {
        ShapeSpec::Plane(_) | ShapeSpec::Body(_) => true,
        ShapeSpec::Parabola(_) | ShapeSpec::Circle(_) | ShapeSpec::Wedge(_) | ShapeSpec::Table(_) => dimension == 2,
        ShapeSpec::Sphere(_) | ShapeSpec::Cylinder(_) | ShapeSpec::Cone(_) | ShapeSpec::HeightMap(_) => dimension == 3,
    }
}

/// The refusal of a shape that does not fit: where it belongs, and what there is instead.
fn misfit(shape: &ShapeSpec, path: String, dimension: usize) -> Error {
    let of = if fits(shape, 2) { "the plane" } else { "space" };
    let there = [
        "on a line there are `plane` and `body`",
        "in the plane there are `plane`, `parabola`, `circle`, `wedge`, `table` and `body`",
        "in space there are `plane`, `sphere`, `cylinder`, `cone`, `height-map` and `body`",
    ][dimension - 1];
    wrong(path, format!("`{}` is a shape of {of}; {there}", shape.name()))
}

/// Point and unit normal of a plane in `dimension` coordinates.
fn plane_of(spec: &PlaneSpec, path: &str, dimension: usize, approach: [f64; 3]) -> Result<([f64; 3], [f64; 3]), Error> {
    let at = vector(&format!("{path}.point"), &spec.point, dimension)?;
    let normal = vector(&format!("{path}.normal"), &spec.normal, dimension)?;
    let length = normal[0].hypot(normal[1]).hypot(normal[2]);
    if length == 0.0 {
        let zero = point(&normal[..dimension]);
        return Err(wrong(format!("{path}.normal"), format!("{zero} has no direction; the normal needs a length")));
    }
    let normal = normal.map(|component| component / length);
    let towards = normal[0] * approach[0] + normal[1] * approach[1] + normal[2] * approach[2];
    if !(towards > 0.0 && towards.is_finite()) {
        let message = format!(
            "{} must point into the obstacle: to the side of the approach direction {}",
            point(&spec.normal),
            point(&approach[..dimension])
        );
        return Err(wrong(format!("{path}.normal"), message));
    }
    Ok((at, normal))
}

fn positive(path: String, value: f64) -> Result<f64, Error> {
    finite(path.as_str(), value)?;
    if value > 0.0 {
        Ok(value)
    } else {
        Err(wrong(path, format!("{} is not allowed: it must be positive", number(value))))
    }
}
