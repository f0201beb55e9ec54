//! The trait of every obstacle shape: the models that allow it, and its surface in a model.

use std::sync::Arc;

use super::order::{Between, SideOrder};
use super::row::Obstacle;
use super::surface::{Placed, Surface};
use crate::error::Error;
use crate::fem::assembly::DofMap;
use crate::fem::body::ElasticBody;
use crate::fem::geometry::{along_axis, shifted};
use crate::scene::input::entry::{COORDINATE_ROUNDING, Files, PLACE_TOLERANCE, number, point, positive, vector, wrong};
use crate::scene::input::schema::model::{Approach, Rule};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An obstacle shape with its numbers.
pub(crate) trait ObstacleShape {
    /// Checks the numbers, and places the surface.
    fn place(&self, site: &ObstacleSite) -> Result<Geometry, Error>;

    /// The boundary that forms the surface, if it is the surface of another body.
    fn other_boundary(&self) -> Option<&str> {
        None
    }

    /// A length beyond which the surface cannot be touched.
    fn radius(&self) -> f64 {
        f64::INFINITY
    }

    /// Estimated memory in addition to its rows, in bytes.
    fn bytes(&self, _files: Files) -> f64 {
        0.0
    }
}

/// The geometry of an obstacle in a model.
#[derive(Clone, Debug)]
pub(crate) enum Geometry {
    /// A rigid surface.
    Rigid(Arc<dyn Obstacle>),
    /// Another body.
    Body(Box<Between>),
}

impl Geometry {
    /// A rigid surface; the rule of the site makes its rows.
    pub(super) fn rigid(site: &ObstacleSite, surface: impl Surface + 'static) -> Self {
        Geometry::Rigid(Arc::new(Placed { surface, rule: site.rule, approach: site.direction() }))
    }
}

/// The place of an obstacle in a scene.
pub(crate) struct ObstacleSite<'a> {
    /// JSON path of the obstacle, as `obstacles[0]`.
    pub obstacle: &'a str,
    /// JSON path of its shape, as `obstacles[0].shape.plane`.
    pub path: String,
    /// The boundary that contains the candidates.
    pub boundary: &'a str,
    pub approach: Approach,
    pub rule: Rule,
    pub body: &'a ElasticBody,
    pub dofs: &'a DofMap,
    /// The candidate nodes with their tributary areas.
    pub candidates: &'a [(usize, f64)],
    /// The order in which bodies carry rows against each other.
    pub order: &'a SideOrder,
    pub files: Files<'a>,
}

/// The side of the body relative to a round or closed surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// The body lies outside; the obstacle is enclosed by the surface.
    #[default]
    Outside,
    /// The body lies inside, as a ball in a cup or a pin in a hole; the obstacle is all around it.
    Inside,
}

impl Side {
    pub(super) fn is_outside(&self) -> bool {
        *self == Side::Outside
    }

    /// A radius, signed along the approach direction from the apex to the centre.
    pub(super) fn signed(self, radius: f64) -> f64 {
        match self {
            Side::Outside => radius,
            Side::Inside => -radius,
        }
    }
}

impl ObstacleSite<'_> {
    /// The JSON path of a field of the shape.
    pub fn field(&self, name: &str) -> String {
        format!("{}.{name}", self.path)
    }

    /// The approach direction [x, y, z] as a dimensionless vector of length 1.
    pub fn direction(&self) -> [f64; 3] {
        let (axis, sense) = self.approach.axis();
        along_axis(axis, sense)
    }

    /// A point or a direction of the plane in the axes of the obstacle: along its surface, and towards it.
    pub fn local(&self, global: [f64; 3]) -> [f64; 2] {
        let (axis, sense) = self.approach.axis();
        [global[1 - axis], sense * global[axis]]
    }

    /// The name of the coordinate along an obstacle in the plane.
    pub fn name_along(&self) -> &'static str {
        ["y", "x"][self.approach.axis().0]
    }

    /// A length below this is rounding of the coordinates of the body.
    pub fn rounding(&self) -> f64 {
        COORDINATE_ROUNDING * self.body.mesh().size()
    }

    /// Checks that every candidate lies over a surface: `what` reaches over each range of an axis, which a field of the
    /// shape gives.
    pub fn check_reach(&self, what: &str, ranges: &[(&str, usize, (f64, f64))]) -> Result<(), Error> {
        let (mesh, rim) = (self.body.mesh(), PLACE_TOLERANCE * self.body.mesh().size());
        for &(node, _) in self.candidates {
            let at = mesh.nodes()[node];
            for &(field, axis, (first, last)) in ranges {
                if (first - rim..=last + rim).contains(&at[axis]) {
                    continue;
                }
                let (name, place) = (["x", "y", "z"][axis], point(&at[..mesh.dimension()]));
                let (first, last, needed) = (number(first), number(last), number(at[axis]));
                let message = format!(
                    "the {what} reaches from {name} = {first} to {last}, but candidate node {node} at {place} needs it at \
                     {name} = {needed}"
                );
                return Err(wrong(self.field(field), message));
            }
        }
        Ok(())
    }

    /// A field that is a point.
    pub fn point(&self, name: &str, entries: &[f64]) -> Result<[f64; 3], Error> {
        vector(&self.field(name), entries, entries.len())
    }

    /// A field that is a direction of any length except zero, its largest component scaled to 1.
    pub fn axis(&self, name: &str, entries: &[f64; 3]) -> Result<[f64; 3], Error> {
        let path = self.field(name);
        let axis = vector(&path, entries, 3)?;
        let largest = axis.iter().fold(0.0_f64, |largest, part| largest.max(part.abs()));
        if largest == 0.0 {
            return Err(wrong(path, "(0, 0, 0) has no direction; the axis needs a length"));
        }
        Ok(axis.map(|part| part / largest))
    }

    /// A field that is positive.
    pub fn positive(&self, name: &str, value: f64) -> Result<f64, Error> {
        positive(&self.field(name), value)
    }

    /// The apex of a round shape, given directly or by its centre, which lies `radius` further along the approach
    /// direction.
    pub fn apex<const N: usize>(
        &self,
        centre: Option<[f64; N]>,
        apex: Option<[f64; N]>,
        radius: f64,
    ) -> Result<[f64; 3], Error> {
        match (centre, apex) {
            (None, Some(apex)) => self.point("apex", &apex),
            (Some(centre), None) => {
                let (centre, approach) = (self.point("centre", &centre)?, self.direction());
                Ok(shifted(centre, -radius, approach))
            }
            (Some(_), Some(_)) => Err(wrong(self.path.as_str(), "has both `centre` and `apex`; give only one")),
            (None, None) => Err(wrong(self.path.as_str(), "has neither `centre` nor `apex`; give one")),
        }
    }
}
