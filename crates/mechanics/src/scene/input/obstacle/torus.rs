//! A torus: the points at the distance `minor` from a ring of radius `major`.

use super::circle::BESIDE;
use super::row::ObstacleRow;
use super::shape::{Geometry, ObstacleShape, ObstacleSite};
use super::surface::Surface;
use crate::error::Error;
use crate::fem::geometry::{dot, minus, unit};
use crate::scene::input::entry::{number, point, wrong};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Deviation of an axis that is rounding of its written components.
const ALIGNED: f64 = 1e-9;

/// A torus, a ring of circular section.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TorusSpec {
    /// The centre of the torus.
    pub centre: [f64; 3],
    /// Direction of the axis, along the approach direction (the ring lies flat in front of the body) or perpendicular
    /// to it (the ring stands upright), of any length except zero.
    pub axis: [f64; 3],
    /// Radius of the ring in the middle of the tube.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub major: f64,
    /// Radius of the tube, positive and less than `major`.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub minor: f64,
}

impl ObstacleShape for TorusSpec {
    fn place(&self, site: &ObstacleSite) -> Result<Geometry, Error> {
        let centre = site.point("centre", &self.centre)?;
        let (axis, approach) = (unit(site.axis("axis", &self.axis)?), site.direction());
        let lean = dot(axis, approach);
        let (major, minor) = (site.positive("major", self.major)?, site.positive("minor", self.minor)?);
        if minor >= major {
            let message = format!(
                "{} is not allowed: it must be less than `major`, {}, or else the tube meets itself in the middle of the ring",
                number(minor),
                number(major)
            );
            return Err(wrong(site.field("minor"), message));
        }
        let (axis, is_flat) = if lean.abs() <= ALIGNED {
            (unit(minus(axis, approach.map(|part| lean * part))), false)
        } else if 1.0 - lean.abs() <= ALIGNED {
            (approach, true)
        } else {
            let (axis, approach) = (point(&self.axis), point(&approach));
            let message = format!("{axis} must be parallel or perpendicular to the approach direction {approach}");
            return Err(wrong(site.field("axis"), message));
        };
        let rounding = site.rounding();
        Ok(Geometry::rigid(site, Torus { centre, axis, approach, is_flat, major, minor, rounding }))
    }

    fn radius(&self) -> f64 {
        self.major + self.minor
    }
}

#[derive(Clone, Copy, Debug)]
struct Torus {
    centre: [f64; 3],
    axis: [f64; 3],
    approach: [f64; 3],
    /// The axis is along the approach direction; else the ring stands upright, with its axis perpendicular to it.
    is_flat: bool,
    major: f64,
    minor: f64,
    rounding: f64,
}

impl Torus {
    /// A node from the centre, with the torus moved by `shift`.
    fn seen_from_centre(&self, node: [f64; 3], shift: f64) -> [f64; 3] {
        [0, 1, 2].map(|axis| node[axis] - self.centre[axis] - shift * self.approach[axis])
    }
}

impl Surface for Torus {
    /// To the outside that faces the body.
    fn gap(&self, node: [f64; 3], shift: f64) -> Option<f64> {
        let from_centre = self.seen_from_centre(node, shift);
        let over = dot(from_centre, self.approach);
        let across = minus(from_centre, self.approach.map(|part| over * part));
        // The height of a circle over a place, or `None` beyond it.
        let half = |radius: f64, at: f64| (at.abs() <= radius).then(|| ((radius - at) * (radius + at)).sqrt());
        let height = if self.is_flat {
            half(self.minor, dot(across, across).sqrt() - self.major)
        } else {
            let along = dot(across, self.axis);
            let aside = minus(across, self.axis.map(|part| along * part));
            // The section perpendicular to the axis is a ring; its outer circle faces the body.
            half(self.minor, along).and_then(|tube| half(self.major + tube, dot(aside, aside).sqrt()))
        };
        Some(-height? - over)
    }

    fn closest(&self, node: [f64; 3], shift: f64) -> Result<Option<ObstacleRow>, String> {
        let from_centre = self.seen_from_centre(node, shift);
        let along = dot(from_centre, self.axis);
        let aside = minus(from_centre, self.axis.map(|part| along * part));
        let radius = dot(aside, aside).sqrt();
        let to_ring = (radius - self.major).hypot(along);
        if to_ring <= self.rounding {
            return Err("lies in the middle of the tube of the torus".into());
        }
        let distance = to_ring - self.minor;
        if radius <= self.rounding && self.is_flat {
            // On the axis the ring is equally close all around: go straight on to the point where the planes through
            // the closest points meet.
            let row = ObstacleRow { normal: self.approach, gap: distance * to_ring / -along };
            return Ok((along < -self.rounding).then_some(row));
        }
        // On the axis of an upright ring the closest point lies straight ahead.
        let outwards = if radius <= self.rounding { self.approach } else { aside.map(|part| part / radius) };
        let part = |axis: usize| (radius - self.major) / to_ring * outwards[axis] + along / to_ring * self.axis[axis];
        let normal = [0, 1, 2].map(|axis| -part(axis));
        let facing = dot(normal, self.approach);
        // A node level with the ring has a closest point, which rounding must not remove; so has one at the side of the
        // tube, as of a circle.
        let is_level = -facing * to_ring <= self.rounding;
        let is_beside = || (1.0 - facing * facing).sqrt() * to_ring > BESIDE * self.minor;
        match distance >= 0.0 {
            _ if facing > 0.0 => Ok(Some(ObstacleRow { normal, gap: distance })),
            true => Ok(None),
            false if is_level || is_beside() => Ok(Some(ObstacleRow { normal, gap: distance })),
            false => Err("lies deeper in the torus than the middle of its tube".into()),
        }
    }
}
