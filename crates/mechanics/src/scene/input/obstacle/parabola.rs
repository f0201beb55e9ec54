//! A parabola: h(s) = s^2/(2R).

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::graph::{Form, Graph};
use super::shape::{About, Geometry, ObstacleShape, Site};
use super::surface::{Foot, Local, Surface};
use crate::error::Error;

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

pub(super) const ABOUT: About = About { name: "parabola", dimensions: &[2] };

impl ObstacleShape for ParabolaSpec {
    fn place(&self, site: &Site) -> Result<Geometry, Error> {
        let apex = site.point("apex", &self.apex)?;
        let radius = site.positive("radius", self.radius)?;
        Ok(Geometry::rigid(site, Graph::new(site, apex, Form::DrawnOut(Arc::new(Parabola { radius })))))
    }
}

/// A parabola with its apex at the origin and the radius of curvature R there.
#[derive(Debug)]
pub(super) struct Parabola {
    pub radius: f64,
}

impl Surface for Parabola {
    fn height(&self, along: f64) -> Option<f64> {
        Some(along * (along / self.radius) / 2.0)
    }

    /// The foot s of the closest point to (p, q) solves `s^3/(2R^2) + s(1 - q/R) - p = 0`, with the sign of p.
    fn closest(&self, [along, towards]: Local, tolerance: f64) -> Result<Option<Foot>, &'static str> {
        let stiffness = 1.0 - towards / self.radius;
        if along.abs() <= tolerance && stiffness < 0.0 {
            // On the axis beyond the centre of curvature both sides are equally close: take the direction of the axis.
            return Ok(Some(Foot { normal: [0.0, 1.0], distance: -towards }));
        }
        let slope = positive_root(stiffness, along.abs() / self.radius).copysign(along);
        let length = slope.hypot(1.0);
        let normal = [-slope / length, 1.0 / length];
        let foot = [self.radius * slope, self.radius * slope * slope / 2.0];
        let distance = normal[0] * (foot[0] - along) + normal[1] * (foot[1] - towards);
        Ok(Some(Foot { normal, distance }))
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
