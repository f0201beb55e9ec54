//! A plane; a polyline through points, undefined beyond its ends; a wedge h(s) = slope |s|, and a cone, which is a
//! wedge rotated about the approach direction.

use super::patch::linear;
use super::polyline::Polyline;
use super::row::ObstacleRow;
use super::shape::{Geometry, ObstacleShape, ObstacleSite};
use super::surface::Surface;
use super::swept::{Curve, CurveFoot, Local, Sweep};
use crate::error::Error;
use crate::fem::geometry::{dot, length, minus};
use crate::scene::input::entry::{PLACE_TOLERANCE, finite, number, point, vector, wrong};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A plane as an obstacle, given by a point and its normal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneSpec {
    /// A point of the plane.
    pub point: Vec<f64>,
    /// Its normal, which points into the obstacle, to the side of the approach direction; of any length except zero.
    pub normal: Vec<f64>,
}

impl PlaneSpec {
    /// Its point and its unit normal.
    fn checked(&self, site: &ObstacleSite) -> Result<([f64; 3], [f64; 3]), Error> {
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
    fn place(&self, site: &ObstacleSite) -> Result<Geometry, Error> {
        let (point, normal) = self.checked(site)?;
        if site.body.dimension() == 2 {
            return Ok(Sweep::DrawnOut.place(StraightCurve { normal: site.local(normal) }, site, point));
        }
        Ok(Geometry::rigid(site, HalfSpace { point, normal, approach: site.direction() }))
    }
}

/// A line through the origin with a unit normal into the obstacle.
#[derive(Debug)]
struct StraightCurve {
    normal: Local,
}

impl Curve for StraightCurve {
    fn height(&self, along: f64) -> Option<f64> {
        // A product with a zero from a division may be a negative zero; the sum removes its sign.
        Some(0.0 - self.normal[0] / self.normal[1] * along)
    }

    fn closest(&self, [along, towards]: Local, _: f64) -> Result<Option<CurveFoot>, &'static str> {
        let distance = -(self.normal[0] * along + self.normal[1] * towards);
        Ok(Some(CurveFoot { normal: self.normal, distance }))
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

impl Surface for HalfSpace {
    fn gap(&self, node: [f64; 3], shift: f64) -> Option<f64> {
        let [to_plane, lean] = self.facing(node);
        Some(to_plane / lean + shift)
    }

    fn closest(&self, node: [f64; 3], shift: f64) -> Result<Option<ObstacleRow>, String> {
        let [to_plane, lean] = self.facing(node);
        Ok(Some(ObstacleRow { normal: self.normal, gap: to_plane + shift * lean }))
    }

    fn gap_over(&self, corners: [[f64; 3]; 3], shift: f64) -> Option<([f64; 6], [f64; 2])> {
        let [first, second, third] = corners.map(|corner| self.gap(corner, shift));
        Some((linear([first?, second?, third?]), [0.0; 2]))
    }
}

/// A polyline through points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TableSpec {
    /// At least two points [x, y], increasing in the coordinate perpendicular to the approach direction, from the first
    /// candidate to the last or beyond.
    #[schemars(extend("minItems" = 2))]
    pub points: Vec<[f64; 2]>,
}

impl TableSpec {
    fn polyline(&self, site: &ObstacleSite) -> Result<Polyline, Error> {
        let path = site.field("points");
        let axis = site.name_along();
        let mut knots: Vec<Local> = Vec::with_capacity(self.points.len());
        for (index, &at) in self.points.iter().enumerate() {
            for (axis, coordinate) in at.into_iter().enumerate() {
                finite(format!("{path}[{index}][{axis}]"), coordinate)?;
            }
            let knot = site.local([at[0], at[1], 0.0]);
            if let Some(last) = knots.last().filter(|last| knot[0] <= last[0]) {
                let (this, before) = (number(knot[0]), number(last[0]));
                let message =
                    format!("{axis} = {this} does not lie beyond {before}, the one before; the {axis} must increase");
                return Err(wrong(format!("{path}[{index}]"), message));
            }
            knots.push(knot);
        }
        let found = knots.len();
        Polyline::table(knots, PLACE_TOLERANCE * site.body.mesh().size())
            .ok_or_else(|| wrong(path.as_str(), format!("a table needs at least two points, but there are {found}")))
    }
}

impl ObstacleShape for TableSpec {
    fn place(&self, site: &ObstacleSite) -> Result<Geometry, Error> {
        let table = self.polyline(site)?;
        if let [first, .., last] = table.corners()[..] {
            site.check_reach("table", &[("points", 1 - site.approach.axis().0, (first, last))])?;
        }
        Ok(Sweep::DrawnOut.place(table, site, [0.0; 3]))
    }
}

/// A cone that opens along the approach direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConeSpec {
    /// The tip of the cone, its point nearest to the body.
    pub apex: [f64; 3],
    /// Slope of the flank away from the body, positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub slope: f64,
}

impl ObstacleShape for ConeSpec {
    fn place(&self, site: &ObstacleSite) -> Result<Geometry, Error> {
        let apex = site.point("apex", &self.apex)?;
        let slope = site.positive("slope", self.slope)?;
        Ok(Sweep::Turned.place(Polyline::wedge(slope), site, apex))
    }
}

/// A wedge.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WedgeSpec {
    /// The tip of the wedge, its point nearest to the body.
    pub apex: [f64; 2],
    /// Slope of both flanks away from the body, positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub slope: f64,
}

impl ObstacleShape for WedgeSpec {
    fn place(&self, site: &ObstacleSite) -> Result<Geometry, Error> {
        let apex = site.point("apex", &self.apex)?;
        let slope = site.positive("slope", self.slope)?;
        Ok(Sweep::DrawnOut.place(Polyline::wedge(slope), site, apex))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::input::obstacle::oracle::{Random, checked, triangles};
    use crate::scene::input::obstacle::patch::NOT_ENCLOSED;
    use crate::scene::input::obstacle::row::Obstacle;
    use crate::scene::input::obstacle::surface::Placed;
    use crate::scene::input::schema::model::Rule;

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
        let by = |rule| Placed { surface: SLOPE, rule, approach: SLOPE.approach };
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(by(Rule::ClosestPoint).gap_over(corners, 0.0), Some(NOT_ENCLOSED));
        let (coefficients, off) = by(Rule::Approach).gap_over(corners, 0.5).unwrap();
        // Over the origin the height is 1 + (0.48 * 0.1 - 0.6 * 0.2)/0.64 = 0.8875; its slopes are -0.75 and 0.9375.
        let exact = [1.3875, 0.6375, 2.325, 1.0125, 1.85625, 1.48125];
        assert!(coefficients.iter().zip(exact).all(|(found, exact)| (found - exact).abs() < 1e-14), "{coefficients:?}");
        assert_eq!(off, [0.0; 2]);
    }
}
