//! A closed surface of triangles from a file: the outside of a solid, or the inside of a hole.

use super::row::ObstacleRow;
use super::shape::{Geometry, ObstacleShape, ObstacleSite, Side};
use super::surface::Surface;
use crate::error::Error;
use crate::fem::geometry::shifted;
use crate::fem::surface::{ClosedSurface, Crossing};
use crate::scene::input::entry::{Files, located};
use crate::scene::input::schema::model::Approach;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Approximate bytes of memory for a byte of the file: 2.5 for a binary STL, the densest form.
const OF_FILE: f64 = 3.0;

/// A closed surface of triangles from an STL file, binary or ASCII, or an OBJ file; flat triangles, never smoothed.
///
/// Every edge must join two triangles. The order of its corners gives the outside of a triangle: counterclockwise seen
/// from outside; if all run clockwise, all are reversed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SurfaceSpec {
    /// The file, `.stl` or `.obj`, inside the folder of the scene unless reading outside is allowed; a relative name
    /// starts in that folder.
    pub file: String,
    /// Factor of the coordinates of the triangles, positive.
    #[serde(default = "crate::scene::input::schema::model::one")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub scale: f64,
    /// The position of the origin of the file.
    #[serde(default, skip_serializing_if = "is_origin")]
    pub origin: [f64; 3],
    /// The side of the body: `outside` of a solid, or `inside` a hole, with the obstacle all around.
    #[serde(default, skip_serializing_if = "Side::is_outside")]
    pub side: Side,
}

fn is_origin(at: &[f64; 3]) -> bool {
    *at == [0.0; 3]
}

impl ObstacleShape for SurfaceSpec {
    fn place(&self, site: &ObstacleSite) -> Result<Geometry, Error> {
        let origin = site.point("origin", &self.origin)?;
        let file = site.files.named(&self.file, site.field("file"))?;
        let surface =
            ClosedSurface::read(&file, self.scale, origin).map_err(|error| located(error, &site.field("")))?;
        let (approach, direction, rounding) = (site.approach, site.direction(), site.rounding());
        Ok(Geometry::rigid(site, Triangulated { surface, side: self.side, approach, direction, rounding }))
    }

    fn bytes(&self, files: Files) -> f64 {
        OF_FILE * files.length(&self.file)
    }
}

/// A surface as an obstacle.
#[derive(Debug)]
struct Triangulated {
    surface: ClosedSurface,
    side: Side,
    approach: Approach,
    direction: [f64; 3],
    rounding: f64,
}

impl Surface for Triangulated {
    /// To the entry into the obstacle: the first entry ahead, or the last one behind for a node in the obstacle; `None`
    /// if no entry exists.
    fn gap(&self, node: [f64; 3], shift: f64) -> Option<f64> {
        let node = shifted(node, -shift, self.direction);
        let (axis, sense) = self.approach.axis();
        let mut crossings: Vec<Crossing> = self.surface.crossings(axis, node);
        if sense < 0.0 {
            crossings.reverse();
        }
        let is_obstacle = |solids: i32| (solids > 0) == self.side.is_outside();
        let (mut solids, mut entry) = (0, None);
        for crossing in crossings {
            let before = is_obstacle(solids);
            solids += if sense < 0.0 { -crossing.turns } else { crossing.turns };
            let way = sense * (crossing.at - node[axis]);
            match (before, is_obstacle(solids)) {
                (false, true) if way >= 0.0 => return Some(way),
                (false, true) => entry = Some(way),
                (true, false) if way > 0.0 && entry.is_some() => return entry,
                (true, false) => entry = None,
                _ => {}
            }
        }
        entry
    }

    fn closest(&self, node: [f64; 3], shift: f64) -> Result<Option<ObstacleRow>, String> {
        let (node, sign) = (shifted(node, -shift, self.direction), self.side.signed(1.0));
        let closest = self.surface.closest(node, self.rounding, self.direction.map(|part| sign * part));
        Ok(Some(ObstacleRow { normal: closest.outward.map(|part| -sign * part), gap: sign * closest.height }))
    }
}
