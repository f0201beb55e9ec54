//! A circle: from outside, the half that faces the body, h(s) = R - sqrt(R^2 - s^2); or from inside, h(s) = sqrt(R^2 -
//! s^2) - R.

use super::shape::{Geometry, ObstacleShape, ObstacleSite, Side};
use super::swept::{Curve, CurveFoot, Local, Sweep, Swept};
use crate::error::Error;
use crate::fem::geometry::dot;
use crate::scene::input::entry::{point, wrong};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A node inside and behind the centre lies beside it if it is farther than this share of the radius from the axis
/// through the centre.
pub(super) const BESIDE: f64 = 0.5;

/// A circle, given by its centre or by its apex.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CircleSpec {
    /// The centre of the circle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub centre: Option<[f64; 2]>,
    /// The point of the circle nearest to the body: the centre minus the radius along the approach direction; from
    /// inside, the centre plus the radius.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub apex: Option<[f64; 2]>,
    /// Radius of the circle, positive. Nodes beyond its reach have no contact row.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
    /// The side of the circle on which the body is: `outside`, or `inside`, as a pin in a hole, with the obstacle all
    /// around.
    #[serde(default, skip_serializing_if = "Side::is_outside")]
    pub side: Side,
}

impl ObstacleShape for CircleSpec {
    fn place(&self, site: &ObstacleSite) -> Result<Geometry, Error> {
        let radius = site.positive("radius", self.radius)?;
        let apex = site.apex(self.centre, self.apex, self.side.signed(radius))?;
        Ok(Sweep::DrawnOut.place(RoundCurve { radius, side: self.side }, site, apex))
    }

    fn radius(&self) -> f64 {
        self.radius
    }
}

/// A circle with its apex at the origin and its centre at (0, R); from inside its mirror image as a graph, with the
/// centre at (0, -R).
#[derive(Debug)]
pub(super) struct RoundCurve {
    pub radius: f64,
    pub side: Side,
}

impl RoundCurve {
    /// `R^2 - s^2`, the squared distance from the axis through the centre, at least 0.
    fn rest(&self, along: f64) -> f64 {
        ((self.radius - along) * (self.radius + along)).max(0.0)
    }

    /// The error of the interpolation at both ends and in the middle of a stretch of half length k: at most
    /// `|h'''| k^3/(9 sqrt 3)`.
    fn remainder(&self, from: f64, to: f64) -> f64 {
        let (furthest, half) = (from.abs().max(to.abs()), (to - from).abs() / 2.0);
        let third = 3.0 * self.radius.powi(2) * furthest / self.rest(furthest).powf(2.5);
        if half == 0.0 { 0.0 } else { third * half.powi(3) / (9.0 * 3.0_f64.sqrt()) }
    }

    /// The tangent of the convex circle in the middle of a stretch with these heights, at its ends and there, and the
    /// largest height above it: the circle lies above each tangent, and farthest from it at an end.
    fn tangent(&self, [first, middle, last]: [f64; 3], from: f64, to: f64) -> ([f64; 3], f64) {
        let place = (from + to) / 2.0;
        let slope = place / ((self.radius - place) * (self.radius + place)).sqrt();
        let [start, end] = [from, to].map(|along| middle + slope * (along - place));
        ([start, middle, end], (first - start).max(last - end).max(0.0))
    }
}

impl Curve for RoundCurve {
    fn height(&self, along: f64) -> Option<f64> {
        // s^2/(R + sqrt(R^2 - s^2)) is R - sqrt(R^2 - s^2) without the cancellation.
        let height = along * (along / (self.radius + self.rest(along).sqrt()));
        (along.abs() <= self.radius).then_some(if self.side.is_outside() { height } else { 0.0 - height })
    }

    /// The quadratic function through both ends and the middle, or the tangent in the middle if that is closer: towards
    /// a vertical side the derivatives grow without limit. From inside the chord takes the place of the tangent, with
    /// the same distance: it lies below the surface, and the surface below the tangent.
    fn enclosed(&self, from: f64, to: f64) -> Option<([f64; 3], [f64; 2])> {
        let (heights, remainder) = (self.heights(from, to)?, self.remainder(from, to));
        let [first, _, last] = heights;
        let (tangent, spread) = self.tangent(heights.map(|height| self.side.signed(height)), from, to);
        if spread < 2.0 * remainder {
            let chord = [first, (first + last) / 2.0, last];
            return Some((if self.side.is_outside() { tangent } else { chord }, [0.0, spread]));
        }
        // Heights lie between 0 and R, and so the quadratic function between -R and 2 R.
        Some((heights, [remainder.min(2.0 * self.radius); 2]))
    }

    /// The chord: the height is convex in the squared distance. In `w = sqrt(R^2 - s^2)`, which falls from `w0` to
    /// `w1`, the chord lies `(w0 - w)(w - w1)/(w0 + w1)` above the circle, most in the middle of both.
    fn enclosed_turned(&self, near: f64, far: f64) -> Option<([f64; 2], [f64; 2])> {
        let sum = self.rest(near).sqrt() + self.rest(far).sqrt();
        // (far^2 - near^2)/(w0 + w1) is w0 - w1 without the cancellation.
        let off = if sum > 0.0 { ((far - near) * ((far + near) / sum)).powi(2) / (4.0 * sum) } else { 0.0 };
        let off = if self.side.is_outside() { [off, 0.0] } else { [0.0, off] };
        Some(([self.height(near)?, self.height(far)?], off))
    }

    /// Distance to the centre minus the radius; from inside, in all directions, the radius minus it. A node outside and
    /// behind the centre has no closest point on the facing half; only if it lies inside and far from the axis, as a
    /// node at the rim of a cup, it is moved out to its side.
    fn closest(&self, [along, towards]: Local, tolerance: f64) -> Result<Option<CurveFoot>, &'static str> {
        let (sense, r) = (self.side.signed(1.0), self.side.signed(self.radius));
        let rest = r - towards;
        let to_centre = along.hypot(rest);
        let is_outside = self.side.is_outside();
        if is_outside && rest <= 0.0 && to_centre >= r {
            return Ok(None);
        }
        let aside = if is_outside { along.abs() } else { to_centre };
        if aside <= tolerance {
            return Ok(Some(CurveFoot { normal: [0.0, 1.0], distance: -towards }));
        }
        // A node level with the centre has a closest point; rounding must not remove it.
        if is_outside && rest < -tolerance && along.abs() <= BESIDE * r {
            return Err("lies deeper in the circle than its centre");
        }
        // (s^2 + q^2 - 2 R q)/(d + R) is d - R without the cancellation.
        let distance = sense * (along * along + towards * towards - 2.0 * r * towards) / (to_centre + self.radius);
        Ok(Some(CurveFoot { normal: [-sense * along / to_centre, sense * rest / to_centre], distance }))
    }

    fn range(&self) -> (f64, f64) {
        (-self.radius, self.radius)
    }
}

/// A sphere, given by its centre or by its apex.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SphereSpec {
    /// The centre of the sphere that the body may touch.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub centre: Option<[f64; 3]>,
    /// The point of the sphere nearest to the body: the centre minus the radius along the approach direction; from
    /// inside, the centre plus the radius.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub apex: Option<[f64; 3]>,
    /// Radius of the sphere, positive. Nodes beyond its reach have no contact row.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
    /// The side of the body: `outside`, or `inside`, as a ball in a cup, with the obstacle all around.
    #[serde(default, skip_serializing_if = "Side::is_outside")]
    pub side: Side,
}

impl ObstacleShape for SphereSpec {
    fn place(&self, site: &ObstacleSite) -> Result<Geometry, Error> {
        let radius = site.positive("radius", self.radius)?;
        let apex = site.apex(self.centre, self.apex, self.side.signed(radius))?;
        Ok(Sweep::Turned.place(RoundCurve { radius, side: self.side }, site, apex))
    }

    fn radius(&self) -> f64 {
        self.radius
    }
}

/// Deviation of a cylinder's axis from the right angle that is rounding of its written components.
const PERPENDICULAR: f64 = 1e-9;

/// A cylinder without ends, given by a point of its axis or of its apex line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CylinderSpec {
    /// Any point of the axis.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub centre: Option<[f64; 3]>,
    /// Any point of the axis minus the radius along the approach direction, on the line nearest to the body; from
    /// inside, plus the radius.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub apex: Option<[f64; 3]>,
    /// Direction of the axis, perpendicular to the approach direction, of any length except zero.
    pub axis: [f64; 3],
    /// Radius of the cylinder, positive. Nodes beyond its reach have no contact row.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
    /// The side of the cylinder on which the body is: `outside`, or `inside`, as a pin in a hole, with the obstacle all
    /// around.
    #[serde(default, skip_serializing_if = "Side::is_outside")]
    pub side: Side,
}

impl ObstacleShape for CylinderSpec {
    fn place(&self, site: &ObstacleSite) -> Result<Geometry, Error> {
        let radius = site.positive("radius", self.radius)?;
        let apex = site.apex(self.centre, self.apex, self.side.signed(radius))?;
        let axis = axis_across(&self.axis, site)?;
        let curve = RoundCurve { radius, side: self.side };
        Ok(Geometry::rigid(site, Swept::new(curve, Sweep::DrawnOut, site, apex).along(axis)))
    }
}

/// The unit direction of a cylinder's axis.
fn axis_across(written: &[f64; 3], site: &ObstacleSite) -> Result<[f64; 3], Error> {
    let (axis, approach) = (site.axis("axis", written)?, site.direction());
    let lean = dot(axis, approach);
    if lean.abs() > PERPENDICULAR {
        let message =
            format!("{} must be perpendicular to the approach direction {}", point(written), point(&approach));
        return Err(wrong(site.field("axis"), message));
    }
    let level = [0, 1, 2].map(|i| axis[i] - lean * approach[i]);
    let length = dot(level, level).sqrt();
    Ok(level.map(|part| part / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stretches at the apex, beside it and up to the vertical side.
    #[test]
    fn both_enclosures_hold_and_are_narrow_up_to_the_vertical_side() {
        let radius = 2.0;
        for side in [Side::Outside, Side::Inside] {
            let surface = RoundCurve { radius, side };
            for (from, to) in [(-0.1, 0.1), (1.0, 1.1), (1.9, 1.99), (1.9, 2.0), (-2.0, -1.5), (1.999999, 2.0)] {
                let ([first, middle, last], [below, above]) = surface.enclosed(from, to).unwrap();
                let fall = (surface.height(from).unwrap() - surface.height(to).unwrap()).abs();
                assert!(below.max(above) <= fall.max(1e-4), "{from} {to}: {below} {above}");
                for step in 0..=100 {
                    let s = f64::from(step) / 100.0;
                    let height = surface.height((from + s * (to - from)).clamp(-radius, radius)).unwrap();
                    let [a, b, c] = [(1.0 - s) * (1.0 - 2.0 * s), 4.0 * s * (1.0 - s), s * (2.0 * s - 1.0)];
                    let off = height - (a * first + b * middle + c * last);
                    assert!(-below - 1e-12 <= off && off <= above + 1e-12, "{from} {to} at {s}: {off}");
                }
            }
        }
    }
}
