//! Obstacles: a surface in a frame, the rule of its contact rows, and the candidates that may touch it.

mod circle;
mod frame;
mod half_space;
mod parabola;
mod plane;
mod polyline;
mod surface;

use std::sync::Arc;

use super::schema::{CircleSpec, ObstacleSpec, PlaneSpec, Rule, ShapeSpec};
use super::{PLACE_TOLERANCE, ROUNDING, finite, finite_pair, number, point, vector, wrong};
use crate::error::Error;
use crate::mesh::Mesh;
use circle::Circle;
use frame::{Frame, Local};
use half_space::HalfSpace;
use parabola::Parabola;
use plane::Plane;
use polyline::Polyline;
use surface::{Foot, Surface};

/// A component of a unit normal below this is rounding of the geometry, not a direction.
const NO_COMPONENT: f64 = 1e-14;

/// The pictured surface goes beyond the body by this part of the body's extent on either side.
const OUTLINE_MARGIN: f64 = 0.3;

/// No picture resolves more pieces of a surface.
const MAX_SEGMENTS: usize = 10_000;

/// The way from a node to an obstacle: `normal . u <= distance`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Approachable {
    /// Unit vector [x, y, z] into the obstacle.
    pub normal: [f64; 3],
    /// Signed distance along it; negative inside.
    pub distance: f64,
}

/// A rigid obstacle of a model.
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
    /// On a line or in space.
    HalfSpace(HalfSpace),
}

/// A surface in the plane, in its frame.
#[derive(Clone, Debug)]
struct Profile {
    frame: Frame,
    origin: Local,
    surface: Arc<dyn Surface>,
    /// Extent of the body along the surface.
    extent: (f64, f64),
    rounding: f64,
}

impl Obstacle {
    /// Checks the obstacle at JSON path `path`; `candidates` are the nodes of its boundary with their tributary areas.
    pub(super) fn new(
        spec: &ObstacleSpec,
        path: &str,
        mesh: &Mesh,
        candidates: Vec<(usize, f64)>,
    ) -> Result<Self, Error> {
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
            (_, Some(frame)) => Geometry::Profile(Profile::new(spec, &shape_path, mesh, frame)?),
            (ShapeSpec::Plane(plane), None) => {
                let (point, normal) = plane_of(plane, &format!("{shape_path}.plane"), dimension, approach)?;
                Geometry::HalfSpace(HalfSpace { point, normal })
            }
            (shape, None) => {
                let (name, space) = (shape.name(), ["on a line", "in the plane", "in space"][dimension - 1]);
                let message = format!("`{name}` is a shape of the plane; {space} there is `plane`");
                return Err(wrong(shape_path, message));
            }
        };
        let obstacle = Obstacle { boundary: spec.boundary.clone(), candidates, rule: spec.rule, approach, geometry };
        if let (ShapeSpec::Table(_), Geometry::Profile(profile)) = (&spec.shape, &obstacle.geometry) {
            profile.check_reach(&format!("{shape_path}.table.points"), mesh, &obstacle.candidates)?;
        }
        Ok(obstacle)
    }

    /// Name of the boundary whose nodes are its candidates.
    pub fn boundary(&self) -> &str {
        &self.boundary
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
    /// the side that [`approach`](Self::approach) points to. Empty where the surface does not reach over the body, and
    /// outside the plane.
    pub fn outline(&self, gap: f64, segments: usize) -> Vec<[f64; 2]> {
        match &self.geometry {
            Geometry::Profile(profile) => profile.outline(gap, segments),
            Geometry::HalfSpace(_) => Vec::new(),
        }
    }

    /// The way from `node` to the surface shifted by `gap`, or `None` where it is out of reach.
    ///
    /// # Errors
    /// A predicate of the node, where it lies so deep that the rule makes no sense.
    pub(super) fn row(&self, node: [f64; 3], gap: f64) -> Result<Option<Approachable>, &'static str> {
        let way = match &self.geometry {
            Geometry::Profile(profile) => profile.row(node, gap, self.rule)?,
            Geometry::HalfSpace(half_space) => Some(half_space.row(node, gap, self.approach, self.rule)),
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

impl Profile {
    fn new(spec: &ObstacleSpec, path: &str, mesh: &Mesh, frame: Frame) -> Result<Self, Error> {
        let (low, high) = mesh.extent();
        let axis = frame.along_axis();
        let size = mesh.size();
        let (origin, surface) = surface_of(&spec.shape, path, frame, size)?;
        Ok(Profile { frame, origin, surface, extent: (low[axis], high[axis]), rounding: ROUNDING * size })
    }

    fn outline(&self, gap: f64, segments: usize) -> Vec<[f64; 2]> {
        let (low, high) = self.extent;
        let margin = OUTLINE_MARGIN * (high - low);
        let range = self.surface.range();
        let first = (low - margin - self.origin[0]).max(range.0);
        let last = (high + margin - self.origin[0]).min(range.1);
        if first >= last {
            return Vec::new();
        }
        let segments = segments.clamp(1, MAX_SEGMENTS);
        let sample = |i: usize| if i == segments { last } else { first + (last - first) * i as f64 / segments as f64 };
        let mut along: Vec<f64> = (0..=segments).map(sample).collect();
        along.extend(self.surface.corners().into_iter().filter(|&corner| corner > first && corner < last));
        along.sort_by(f64::total_cmp);
        along.dedup();
        let place = |along: f64| {
            let height = self.surface.height(along)?;
            Some(self.frame.global([self.origin[0] + along, self.origin[1] + height + gap]))
        };
        along.into_iter().filter_map(place).collect()
    }

    fn row(&self, [x, y, _]: [f64; 3], gap: f64, rule: Rule) -> Result<Option<Approachable>, &'static str> {
        let local = self.frame.local([x, y]);
        let offset = [local[0] - self.origin[0], local[1] - self.origin[1] - gap];
        let foot = match rule {
            Rule::Approach => {
                self.surface.height(offset[0]).map(|height| Foot { normal: [0.0, 1.0], distance: height - offset[1] })
            }
            Rule::ClosestPoint => self.surface.closest(offset, self.rounding)?,
        };
        Ok(foot.map(|foot| {
            let [x, y] = self.frame.global(foot.normal);
            Approachable { normal: [x, y, 0.0], distance: foot.distance }
        }))
    }

    /// Every candidate must lie over the surface: a table says nothing beyond its ends.
    fn check_reach(&self, path: &str, mesh: &Mesh, candidates: &[(usize, f64)]) -> Result<(), Error> {
        let axis = ["x", "y"][self.frame.along_axis()];
        let (first, last) = self.surface.range();
        for &(node, _) in candidates {
            let [x, y, _] = mesh.nodes()[node];
            let at = [x, y];
            let along = self.frame.local(at)[0];
            if !(first..=last).contains(&along) {
                let corners = self.surface.corners();
                let ends = corners.first().zip(corners.last());
                let reach =
                    ends.map_or(String::new(), |(a, b)| format!(" from {axis} = {} to {}", number(*a), number(*b)));
                let message = format!(
                    "the table reaches{reach}, but candidate node {node} at {} needs it at {axis} = {}",
                    point(&at),
                    number(along)
                );
                return Err(wrong(path, message));
            }
        }
        Ok(())
    }
}

/// The origin of the surface in the frame, and the surface relative to it.
fn surface_of(shape: &ShapeSpec, path: &str, frame: Frame, size: f64) -> Result<(Local, Arc<dyn Surface>), Error> {
    Ok(match shape {
        ShapeSpec::Plane(spec) => {
            let [x, y] = frame.global([0.0, 1.0]);
            let ([px, py, _], [nx, ny, _]) = plane_of(spec, &format!("{path}.plane"), 2, [x, y, 0.0])?;
            (frame.local([px, py]), Arc::new(Plane { normal: frame.local([nx, ny]) }))
        }
        ShapeSpec::Parabola(spec) => {
            finite_pair(&format!("{path}.parabola.apex"), spec.apex)?;
            let radius = positive(format!("{path}.parabola.radius"), spec.radius)?;
            (frame.local(spec.apex), Arc::new(Parabola { radius }))
        }
        ShapeSpec::Circle(spec) => {
            let path = format!("{path}.circle");
            let radius = positive(format!("{path}.radius"), spec.radius)?;
            (apex_of_circle(spec, &path, frame)?, Arc::new(Circle { radius }))
        }
        ShapeSpec::Wedge(spec) => {
            finite_pair(&format!("{path}.wedge.apex"), spec.apex)?;
            let slope = positive(format!("{path}.wedge.slope"), spec.slope)?;
            (frame.local(spec.apex), Arc::new(Polyline::wedge(slope)))
        }
        ShapeSpec::Table(spec) => {
            let path = format!("{path}.table.points");
            let axis = ["x", "y"][frame.along_axis()];
            let mut knots: Vec<Local> = Vec::with_capacity(spec.points.len());
            for (index, &at) in spec.points.iter().enumerate() {
                finite_pair(&format!("{path}[{index}]"), at)?;
                let knot = frame.local(at);
                if let Some(last) = knots.last().filter(|last| knot[0] <= last[0]) {
                    let (this, before) = (number(knot[0]), number(last[0]));
                    let message = format!(
                        "{axis} = {this} does not lie beyond {before}, the one before; the {axis} must increase"
                    );
                    return Err(wrong(format!("{path}[{index}]"), message));
                }
                knots.push(knot);
            }
            let found = knots.len();
            let table = Polyline::table(knots, PLACE_TOLERANCE * size)
                .ok_or_else(|| wrong(path, format!("a table needs at least two points, but there are {found}")))?;
            ([0.0, 0.0], Arc::new(table))
        }
    })
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

fn apex_of_circle(spec: &CircleSpec, path: &str, frame: Frame) -> Result<Local, Error> {
    match (spec.centre, spec.apex) {
        (None, Some(apex)) => {
            finite_pair(&format!("{path}.apex"), apex)?;
            Ok(frame.local(apex))
        }
        (Some(centre), None) => {
            finite_pair(&format!("{path}.centre"), centre)?;
            let centre = frame.local(centre);
            Ok([centre[0], centre[1] - spec.radius])
        }
        (Some(_), Some(_)) => Err(wrong(path, "gives both centre and apex; give one of them")),
        (None, None) => Err(wrong(path, "gives neither centre nor apex; give one of them")),
    }
}

fn positive(path: String, value: f64) -> Result<f64, Error> {
    finite(path.as_str(), value)?;
    if value > 0.0 {
        Ok(value)
    } else {
        Err(wrong(path, format!("{} is not allowed: it must be positive", number(value))))
    }
}
