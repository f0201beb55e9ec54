//! A polyline over the coordinate along it, extended by a ray at each end: wedge and table; a parabola.

use std::iter;

use super::shape::{Geometry, ObstacleShape, ObstacleSite};
use super::swept::{Curve, CurveFoot, Local, Sweep};
use crate::error::Error;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Knots increasing along the surface, and the slopes of the rays before the first and after the last.
#[derive(Debug)]
pub(super) struct Polyline {
    knots: Vec<Local>,
    end_slopes: [f64; 2],
    range: (f64, f64),
}

/// The closest point of one piece.
struct Candidate {
    distance: f64,
    normal: Local,
    anchor: Local,
    /// The closest knot, if it is an end of the piece.
    knot: Option<usize>,
}

impl Polyline {
    /// Two rays of slope `slope` away from the origin.
    pub fn wedge(slope: f64) -> Self {
        Polyline { knots: vec![[0.0, 0.0]], end_slopes: [-slope, slope], range: (f64::NEG_INFINITY, f64::INFINITY) }
    }

    /// The polyline through `knots` (at least two, increasing); it reaches from the first to the last, or `beyond`.
    pub fn table(knots: Vec<Local>, beyond: f64) -> Option<Self> {
        let ([first, second, ..], [.., last_but_one, last]) = (knots.as_slice(), knots.as_slice()) else {
            return None;
        };
        let slope = |a: &Local, b: &Local| (b[1] - a[1]) / (b[0] - a[0]);
        let end_slopes = [slope(first, second), slope(last_but_one, last)];
        let range = (first[0] - beyond, last[0] + beyond);
        Some(Polyline { knots, end_slopes, range })
    }

    /// Pieces from left to right: ray, segments, ray. Each has an anchor, a unit tangent and the extent along it.
    fn pieces(&self) -> impl Iterator<Item = (Local, Local, f64, f64)> + '_ {
        let tangent = |step: Local| {
            let length = step[0].hypot(step[1]);
            ([step[0] / length, step[1] / length], length)
        };
        let rays = move |knot: Option<&Local>, slope: f64, low: f64, high: f64| {
            knot.map(|&knot| (knot, tangent([1.0, slope]).0, low, high))
        };
        let segments = self.knots.windows(2).map(move |ends| {
            let (direction, length) = tangent([ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]]);
            (ends[0], direction, 0.0, length)
        });
        let before = rays(self.knots.first(), self.end_slopes[0], f64::NEG_INFINITY, 0.0);
        let after = rays(self.knots.last(), self.end_slopes[1], 0.0, f64::INFINITY);
        before.into_iter().chain(segments).chain(after)
    }
}

impl Curve for Polyline {
    fn height(&self, along: f64) -> Option<f64> {
        if !(self.range.0..=self.range.1).contains(&along) {
            return None;
        }
        let after = self.knots.partition_point(|knot| knot[0] <= along);
        let ray = |knot: &Local, slope: f64| knot[1] + slope * (along - knot[0]);
        match (after.checked_sub(1).and_then(|before| self.knots.get(before)), self.knots.get(after)) {
            (Some(left), Some(right)) => {
                let fraction = (along - left[0]) / (right[0] - left[0]);
                Some(left[1] + fraction * (right[1] - left[1]))
            }
            (Some(last), None) if along == last[0] => Some(last[1]),
            (Some(last), None) => Some(ray(last, self.end_slopes[1])),
            (None, Some(first)) => Some(ray(first, self.end_slopes[0])),
            (None, None) => None,
        }
    }

    /// The chord, and the largest distances of the knots on the stretch from it.
    fn enclosed(&self, from: f64, to: f64) -> Option<([f64; 3], [f64; 2])> {
        let [first, _, last] = self.heights(from, to)?;
        let mut off = [0.0_f64; 2];
        for &[along, height] in self.knots.iter().filter(|knot| from.min(to) < knot[0] && knot[0] < from.max(to)) {
            let chord = first + (last - first) * ((along - from) / (to - from));
            off = [off[0].max(chord - height), off[1].max(height - chord)];
        }
        Some(([first, (first + last) / 2.0, last], off))
    }

    /// The chord, and the largest distances of the pieces from it: each is farthest at an end, or where its slope is
    /// that of the chord.
    fn enclosed_turned(&self, near: f64, far: f64) -> Option<([f64; 2], [f64; 2])> {
        let [first, last] = [self.height(near)?, self.height(far)?];
        let chord =
            |along: f64| first + (last - first) * ((along - near) / (far - near) * ((along + near) / (far + near)));
        let knots = self.knots.iter().copied().filter(|knot| near < knot[0] && knot[0] < far);
        let ends: Vec<Local> = iter::once([near, first]).chain(knots).chain([[far, last]]).collect();
        let mut off = [0.0_f64; 2];
        for piece in ends.windows(2) {
            let ([from, start], [to, end]) = (piece[0], piece[1]);
            let slope = (end - start) / (to - from);
            let parallel = (near + far) / 2.0 * (slope * (far - near) / (last - first));
            // A place that is not a number, as on a stretch without length, adds nothing.
            for along in [to, parallel.clamp(from, to)] {
                let above = start + slope * (along - from) - chord(along);
                off = [off[0].max(-above), off[1].max(above)];
            }
        }
        Some(([first, last], off))
    }

    fn closest(&self, node: Local, tolerance: f64) -> Result<Option<CurveFoot>, &'static str> {
        let candidates: Vec<Candidate> = self
            .pieces()
            .enumerate()
            .map(|(piece, (anchor, tangent, low, high))| {
                let to_node = [node[0] - anchor[0], node[1] - anchor[1]];
                let free = to_node[0] * tangent[0] + to_node[1] * tangent[1];
                let at = free.clamp(low, high);
                let distance = (to_node[0] - at * tangent[0]).hypot(to_node[1] - at * tangent[1]);
                // Piece i ends at knot i and starts at knot i - 1.
                let knot = if at == high { Some(piece) } else { piece.checked_sub(1).filter(|_| at == low) };
                Candidate { distance, normal: [-tangent[1], tangent[0]], anchor, knot }
            })
            .collect();
        let Some(nearest) = candidates.iter().min_by(|a, b| a.distance.total_cmp(&b.distance)) else {
            return Ok(None);
        };
        let along_normal = |normal: Local, to: Local| normal[0] * (to[0] - node[0]) + normal[1] * (to[1] - node[1]);
        let bisector = |normals: &mut dyn Iterator<Item = Local>| {
            let sum = normals.fold([0.0; 2], |sum: Local, normal| [sum[0] + normal[0], sum[1] + normal[1]]);
            let length = sum[0].hypot(sum[1]);
            [sum[0] / length, sum[1] / length]
        };
        if let Some((knot, index)) = nearest.knot.and_then(|index| Some((*self.knots.get(index)?, index))) {
            // The pieces on both sides of a knot have the numbers `index` and `index + 1`.
            if nearest.distance <= tolerance {
                let normal = bisector(&mut candidates.iter().skip(index).take(2).map(|piece| piece.normal));
                return Ok(Some(CurveFoot { normal, distance: along_normal(normal, knot) }));
            }
            let inside = self.height(node[0].clamp(self.range.0, self.range.1)).is_some_and(|h| node[1] > h);
            let sense = if inside { -1.0 } else { 1.0 };
            let normal = [0, 1].map(|axis| sense * (knot[axis] - node[axis]) / nearest.distance);
            return Ok(Some(CurveFoot { normal, distance: sense * nearest.distance }));
        }
        let distance = along_normal(nearest.normal, nearest.anchor);
        let mut ties = candidates
            .iter()
            .filter(|other| other.knot.is_none() && other.distance - nearest.distance <= tolerance)
            .map(|other| other.normal);
        let normal = bisector(&mut ties);
        let cosine = normal[0] * nearest.normal[0] + normal[1] * nearest.normal[1];
        Ok(Some(CurveFoot { normal, distance: distance / cosine }))
    }

    fn range(&self) -> (f64, f64) {
        self.range
    }

    fn corners(&self) -> Vec<f64> {
        self.knots.iter().map(|knot| knot[0]).collect()
    }
}

/// Newton's method from the right of the root of a convex cubic converges monotonically; it never needs as many steps.
const NEWTON_STEPS: usize = 200;

/// A parabola.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ParabolaSpec {
    /// The apex of the parabola, its point nearest to the body.
    pub apex: [f64; 2],
    /// Radius of curvature at the apex, positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
}

impl ObstacleShape for ParabolaSpec {
    fn place(&self, site: &ObstacleSite) -> Result<Geometry, Error> {
        let apex = site.point("apex", &self.apex)?;
        let radius = site.positive("radius", self.radius)?;
        Ok(Sweep::DrawnOut.place(Parabola { radius }, site, apex))
    }
}

/// A parabola with its apex at the origin and the radius of curvature R there.
#[derive(Debug)]
pub(super) struct Parabola {
    pub radius: f64,
}

impl Curve for Parabola {
    fn height(&self, along: f64) -> Option<f64> {
        Some(along * (along / self.radius) / 2.0)
    }

    /// The foot s of the closest point to (p, q) solves `s^3/(2R^2) + s(1 - q/R) - p = 0`, with the sign of p.
    fn closest(&self, [along, towards]: Local, tolerance: f64) -> Result<Option<CurveFoot>, &'static str> {
        let stiffness = 1.0 - towards / self.radius;
        if along.abs() <= tolerance && stiffness < 0.0 {
            // On the axis beyond the centre of curvature both sides are equally close: take the direction of the axis.
            return Ok(Some(CurveFoot { normal: [0.0, 1.0], distance: -towards }));
        }
        let slope = positive_root(stiffness, along.abs() / self.radius).copysign(along);
        let length = slope.hypot(1.0);
        let normal = [-slope / length, 1.0 / length];
        let foot = [self.radius * slope, self.radius * slope * slope / 2.0];
        let distance = normal[0] * (foot[0] - along) + normal[1] * (foot[1] - towards);
        Ok(Some(CurveFoot { normal, distance }))
    }
}

/// The largest root x >= 0 of `x^3/2 + c x - p`, for p >= 0.
fn positive_root(c: f64, p: f64) -> f64 {
    if p == 0.0 && c >= 0.0 {
        return 0.0;
    }
    // Upper bounds: the values at which one of the two growing terms alone outweighs the rest.
    let mut x = if c > 0.0 { (p / c).min((2.0 * p).cbrt()) } else { (4.0 * p).cbrt().max(2.0 * (-c).sqrt()) };
    for _ in 0..NEWTON_STEPS {
        let next = x - (x * x * x / 2.0 + c * x - p) / (1.5 * x * x + c);
        // Iterate until rounding stops the descent.
        if next.is_nan() || next >= x {
            break;
        }
        x = next;
    }
    x
}
