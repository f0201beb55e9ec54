//! A polyline through points; it is undefined beyond its ends.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::graph::{Form, Graph};
use super::polyline::Polyline;
use super::shape::{About, Geometry, ObstacleShape, Site};
use super::surface::{Local, Surface};
use crate::error::Error;
use crate::scene::input::entry::{PLACE_TOLERANCE, finite, number, point, wrong};

/// A polyline through points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TableSpec {
    /// At least two points [x, y], increasing in the coordinate perpendicular to the approach direction, from the first
    /// candidate to the last or beyond.
    #[schemars(extend("minItems" = 2))]
    pub points: Vec<[f64; 2]>,
}

pub(super) const ABOUT: About = About { name: "table", dimensions: &[2] };

impl TableSpec {
    fn polyline(&self, site: &Site) -> Result<Polyline, Error> {
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
    fn place(&self, site: &Site) -> Result<Geometry, Error> {
        let table = self.polyline(site)?;
        check_reach(&table, site)?;
        Ok(Geometry::rigid(site, Graph::new(site, [0.0; 3], Form::DrawnOut(Arc::new(table)))))
    }
}

/// Checks that every candidate lies over the surface.
fn check_reach(table: &Polyline, site: &Site) -> Result<(), Error> {
    let (axis, path) = (site.name_along(), site.field("points"));
    let (first, last) = table.range();
    for &(node, _) in site.candidates {
        let at = site.body.mesh().nodes()[node];
        let along = site.local(at)[0];
        if !(first..=last).contains(&along) {
            let corners = table.corners();
            let ends = corners.first().zip(corners.last());
            let reach = ends.map_or(String::new(), |(a, b)| format!(" from {axis} = {} to {}", number(*a), number(*b)));
            let message = format!(
                "the table reaches{reach}, but candidate node {node} at {} needs it at {axis} = {}",
                point(&at[..2]),
                number(along)
            );
            return Err(wrong(path.as_str(), message));
        }
    }
    Ok(())
}
