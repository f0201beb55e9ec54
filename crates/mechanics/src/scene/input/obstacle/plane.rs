//! A plane: a line in the plane, n . x = 0 in the frame of its point; a half space behind a plane elsewhere.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::graph::{Form, Graph};
use super::row::ObstacleRow;
use super::ruled::RigidSurface;
use super::shape::{About, Geometry, ObstacleShape, Site};
use super::surface::{Foot, Local, Surface};
use super::triangle::linear;
use crate::error::Error;
use crate::fem::geometry::{dot, length, minus};
use crate::scene::input::entry::{point, vector, wrong};
use crate::scene::input::schema::approach::Rule;

/// A plane as an obstacle, given by a point and its normal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneSpec {
    /// A point of the plane.
    pub point: Vec<f64>,
    /// Its normal, which points into the obstacle, to the side of the approach direction; of any length except zero.
    pub normal: Vec<f64>,
}

pub(super) const ABOUT: About = About { name: "plane", dimensions: &[1, 2, 3] };

impl PlaneSpec {
    /// Its point and its unit normal.
    fn checked(&self, site: &Site) -> Result<([f64; 3], [f64; 3]), Error> {
        let (dimension, approach) = (site.body.dimension(), site.direction());
        let at = vector(&site.field("point"), &self.point, dimension)?;
        let normal = vector(&site.field("normal"), &self.normal, dimension)?;
        let length = length(normal);
        if length == 0.0 {
            let zero = point(&normal[..dimension]);
            return Err(wrong(site.field("normal"), format!("{zero} has no direction; the normal needs a length")));
        }
        let normal = normal.map(|component| component / length);
        let towards = dot(normal, approach);
        if !(towards > 0.0 && towards.is_finite()) {
            let message = format!(
                "{} must point into the obstacle: to the side of the approach direction {}",
                point(&self.normal),
                point(&approach[..dimension])
            );
            return Err(wrong(site.field("normal"), message));
        }
        Ok((at, normal))
    }
}

impl ObstacleShape for PlaneSpec {
    fn place(&self, site: &Site) -> Result<Geometry, Error> {
        let (point, normal) = self.checked(site)?;
        if site.body.dimension() == 2 {
            let line = Line { normal: site.local(normal) };
            return Ok(Geometry::rigid(site, Graph::new(site, point, Form::DrawnOut(Arc::new(line)))));
        }
        Ok(Geometry::rigid(site, HalfSpace { point, normal, approach: site.direction() }))
    }
}

/// A line through the origin with a unit normal into the obstacle.
#[derive(Debug)]
struct Line {
    normal: Local,
}

impl Surface for Line {
    fn height(&self, along: f64) -> Option<f64> {
        // A product with a zero from a division may be a negative zero; the sum removes its sign.
        Some(0.0 - self.normal[0] / self.normal[1] * along)
    }

    fn closest(&self, [along, towards]: Local, _: f64) -> Result<Option<Foot>, &'static str> {
        let distance = -(self.normal[0] * along + self.normal[1] * towards);
        Ok(Some(Foot { normal: self.normal, distance }))
    }
}

/// A plane through `point` with a unit `normal` into the obstacle.
#[derive(Clone, Copy, Debug)]
struct HalfSpace {
    point: [f64; 3],
    normal: [f64; 3],
    approach: [f64; 3],
}

impl HalfSpace {
    /// The distance of a node from the plane along its normal, and the cosine between the normal and the approach
    /// direction.
    fn facing(&self, node: [f64; 3]) -> [f64; 2] {
        [dot(self.normal, minus(self.point, node)), dot(self.normal, self.approach)]
    }
}

impl RigidSurface for HalfSpace {
    fn row_by(&self, rule: Rule, node: [f64; 3], shift: f64) -> Result<Option<ObstacleRow>, String> {
        let [to_plane, lean] = self.facing(node);
        Ok(Some(match rule {
            Rule::Approach => ObstacleRow { normal: self.approach, gap: to_plane / lean + shift },
            Rule::ClosestPoint => ObstacleRow { normal: self.normal, gap: to_plane + shift * lean },
        }))
    }

    fn gap_over(&self, corners: [[f64; 3]; 3], shift: f64) -> Option<([f64; 6], [f64; 2])> {
        let gaps = corners.map(|corner| {
            let [to_plane, lean] = self.facing(corner);
            to_plane / lean + shift
        });
        Some((linear(gaps), [0.0; 2]))
    }
}

#[cfg(test)]
mod tests {
    use super::super::oracle::{Random, checked, triangles};
    use super::super::row::Obstacle;
    use super::super::ruled::Ruled;
    use super::super::triangle::NOT_ENCLOSED;
    use super::*;

    const SLOPE: HalfSpace =
        HalfSpace { point: [0.1, 0.2, 1.0], normal: [0.48, -0.6, 0.64], approach: [0.0, 0.0, 1.0] };

    #[test]
    fn the_gap_to_a_plane_over_a_triangle_is_exact() {
        let mut random = Random(1);
        for corners in triangles(&mut random) {
            assert_eq!(checked(&SLOPE, corners, -0.3, &mut random), Some([0.0; 2]));
        }
    }

    #[test]
    fn rows_along_normals_have_no_enclosure() {
        let by = |rule| Ruled { surface: SLOPE, rule, approach: SLOPE.approach };
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(by(Rule::ClosestPoint).gap_over(corners, 0.0), Some(NOT_ENCLOSED));
        let (coefficients, off) = by(Rule::Approach).gap_over(corners, 0.5).unwrap();
        // Over the origin the height is 1 + (0.48 * 0.1 - 0.6 * 0.2)/0.64 = 0.8875; its slopes are -0.75 and 0.9375.
        let exact = [1.3875, 0.6375, 2.325, 1.0125, 1.85625, 1.48125];
        assert!(coefficients.iter().zip(exact).all(|(found, exact)| (found - exact).abs() < 1e-14), "{coefficients:?}");
        assert_eq!(off, [0.0; 2]);
    }
}
