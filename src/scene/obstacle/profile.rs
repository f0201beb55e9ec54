//! Obstacles in the plane: a curve in a frame.

use std::sync::Arc;

use super::circle::Circle;
use super::frame::{Frame, Local};
use super::parabola::Parabola;
use super::plane::Plane;
use super::polyline::Polyline;
use super::shape::{misfit, plane_of, positive};
use super::surface::{Foot, Surface};
use super::way::Approachable;
use crate::error::Error;
use crate::fem::mesh::Mesh;
use crate::scene::entry::{PLACE_TOLERANCE, ROUNDING, finite_pair, number, point, wrong};
use crate::scene::schema::{CircleSpec, ObstacleSpec, Rule, ShapeSpec};

/// The pictured surface goes beyond the body by this part of the body's extent on either side.
const OUTLINE_MARGIN: f64 = 0.3;

/// No picture resolves more pieces of a surface.
const MAX_SEGMENTS: usize = 10_000;

/// A surface in the plane, in its frame.
#[derive(Clone, Debug)]
pub(super) struct Profile {
    frame: Frame,
    origin: Local,
    surface: Arc<dyn Surface>,
    /// Extent of the body along the surface.
    extent: (f64, f64),
    rounding: f64,
}

impl Profile {
    pub fn new(spec: &ObstacleSpec, path: &str, mesh: &Mesh, frame: Frame) -> Result<Self, Error> {
        let (low, high) = mesh.extent();
        let axis = frame.along_axis();
        let size = mesh.size();
        let (origin, surface) = surface_of(&spec.shape, path, frame, size)?;
        Ok(Profile { frame, origin, surface, extent: (low[axis], high[axis]), rounding: ROUNDING * size })
    }

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

    pub fn row(&self, [x, y, _]: [f64; 3], gap: f64, rule: Rule) -> Result<Option<Approachable>, &'static str> {
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
    pub fn check_reach(&self, path: &str, mesh: &Mesh, candidates: &[(usize, f64)]) -> Result<(), Error> {
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
        ShapeSpec::Sphere(_)
        | ShapeSpec::Cylinder(_)
        | ShapeSpec::Cone(_)
        | ShapeSpec::HeightMap(_)
        | ShapeSpec::Body(_) => {
            return Err(misfit(shape, path.into(), 2));
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
