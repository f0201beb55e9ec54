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
mod shape;
mod solid;
mod surface;
mod way;

use super::entry::wrong;
use super::schema::{ObstacleSpec, Rule, ShapeSpec};
use crate::error::Error;
use crate::fem::body::ElasticBody;
use facing::Facing;
use frame::Frame;
use half_space::HalfSpace;
use profile::Profile;
use shape::{fits, misfit, plane_of};
use solid::Solid;
use way::Approachable;

/// A component of a unit normal below this is rounding of the geometry, not a direction.
const NO_COMPONENT: f64 = 1e-14;

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
