//! Obstacles: a surface in a frame, the rule of its contact rows, and the candidates that may touch it.

mod circle;
mod frame;
mod parabola;
mod plane;
mod polyline;
mod surface;

use std::sync::Arc;

use super::schema::{CircleSpec, ObstacleSpec, Rule, ShapeSpec};
use super::{PLACE_TOLERANCE, ROUNDING, finite, finite_pair, number, point, wrong};
use crate::error::Error;
use crate::mesh::Mesh;
use circle::Circle;
use frame::{Frame, Local};
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
    /// Unit vector [x, y] into the obstacle.
    pub normal: [f64; 2],
    /// Signed distance along it; negative inside.
    pub distance: f64,
}

/// A rigid obstacle of a model.
#[derive(Clone, Debug)]
pub struct Obstacle {
    boundary: String,
    candidates: Vec<(usize, f64)>,
    rule: Rule,
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
        let frame = Frame::of(spec.approach);
        let (low, high) = mesh.extent();
        let axis = frame.along_axis();
        let size = mesh.size();
        let (origin, surface) = surface_of(&spec.shape, &format!("{path}.shape"), frame, size)?;
        let obstacle = Obstacle {
            boundary: spec.boundary.clone(),
            candidates,
            rule: spec.rule,
            frame,
            origin,
            surface,
            extent: (low[axis], high[axis]),
            rounding: ROUNDING * size,
        };
        if let ShapeSpec::Table(_) = spec.shape {
            obstacle.check_reach(&format!("{path}.shape.table.points"), mesh)?;
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

    /// The approach direction [x, y], of length 1: from the body to the obstacle.
    pub fn approach(&self) -> [f64; 2] {
        self.frame.global([0.0, 1.0])
    }

    /// The candidate nodes, in the order of the boundary, each with its tributary area.
    pub fn candidates(&self) -> &[(usize, f64)] {
        &self.candidates
    }

    /// The surface as a polyline [x, y] for pictures: over the body's extent and a little more, shifted by `gap`
    /// along the approach direction, in `segments` pieces (10,000 at most), corners met exactly. The obstacle lies on
    /// the side that [`approach`](Self::approach) points to. Empty where the surface does not reach over the body.
    pub fn outline(&self, gap: f64, segments: usize) -> Vec<[f64; 2]> {
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

    /// The way from `node` to the surface shifted by `gap`, or `None` where it is out of reach.
    ///
    /// # Errors
    /// A predicate of the node, where it lies so deep that the rule makes no sense.
    pub(super) fn row(&self, node: [f64; 2], gap: f64) -> Result<Option<Approachable>, &'static str> {
        let local = self.frame.local(node);
        let offset = [local[0] - self.origin[0], local[1] - self.origin[1] - gap];
        let foot = match self.rule {
            Rule::Approach => {
                self.surface.height(offset[0]).map(|height| Foot { normal: [0.0, 1.0], distance: height - offset[1] })
            }
            Rule::ClosestPoint => self.surface.closest(offset, self.rounding)?,
        };
        match foot {
            Some(foot) if foot.distance.is_nan() => Err("has no distance that could be computed"),
            Some(foot) if foot.distance.is_finite() => {
                let normal = self.frame.global(foot.normal.map(|c| if c.abs() < NO_COMPONENT { 0.0 } else { c }));
                Ok(Some(Approachable { normal, distance: foot.distance }))
            }
            _ => Ok(None),
        }
    }

    /// Every candidate must lie over the surface: a table says nothing beyond its ends.
    fn check_reach(&self, path: &str, mesh: &Mesh) -> Result<(), Error> {
        let axis = ["x", "y"][self.frame.along_axis()];
        let (first, last) = self.surface.range();
        for &(node, _) in &self.candidates {
            let at = mesh.nodes()[node];
            let along = self.frame.local(at)[0];
            if !(first..=last).contains(&along) {
                let corners = self.surface.corners();
                let ends = corners.first().zip(corners.last());
                let reach =
                    ends.map_or(String::new(), |(a, b)| format!(" from {axis} = {} to {}", number(*a), number(*b)));
                let message = format!(
                    "the table reaches{reach}, but candidate node {node} at {} needs it at {axis} = {}",
                    point(at),
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
            let path = format!("{path}.plane");
            finite_pair(&format!("{path}.point"), spec.point)?;
            finite_pair(&format!("{path}.normal"), spec.normal)?;
            let length = spec.normal[0].hypot(spec.normal[1]);
            if length == 0.0 {
                return Err(wrong(format!("{path}.normal"), "(0, 0) has no direction; the normal needs a length"));
            }
            let normal = frame.local(spec.normal.map(|component| component / length));
            if !(normal[1] > 0.0 && normal[1].is_finite()) {
                let message = format!(
                    "{} must point into the obstacle: to the side of the approach direction {}",
                    point(spec.normal),
                    point(frame.global([0.0, 1.0]))
                );
                return Err(wrong(format!("{path}.normal"), message));
            }
            (frame.local(spec.point), Arc::new(Plane { normal }))
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
