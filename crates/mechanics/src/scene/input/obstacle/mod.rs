//! Obstacles: each gives a row for every point. A shape is named only in its file and here.

mod circle;
mod facing;
mod height_map;
pub(crate) mod mortar;
#[cfg(test)]
mod oracle;
pub(crate) mod order;
mod patch;
mod placed;
mod plane;
mod polyline;
mod row;
mod shape;
mod surface;
mod swept;
mod torus;
mod triangulated;

pub(crate) use facing::shortest_edges;
pub use order::Between;
pub(crate) use order::SideOrder;
pub use placed::{Inertia, PlacedObstacle};
pub use row::{Obstacle, ObstacleRow};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::input::body::About;
use shape::ObstacleShape;

/// Makes the enumeration of the shapes: each with its numbers, its name, and the dimensions of models that allow it.
macro_rules! shapes {
    ($($(#[$text:meta])* $kind:ident($file:ident::$spec:ident) = $name:literal in $dimensions:expr;)*) => {
        /// The surface of an obstacle, over the coordinates perpendicular to the approach direction.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(rename_all = "kebab-case")]
        pub enum ShapeSpec {
            $($(#[$text])* $kind($file::$spec),)*
        }

        /// All shapes, in the order of messages.
        const ALL: &[About] = &[$(About { name: $name, dimensions: &$dimensions }),*];

        impl ShapeSpec {
            /// Its name with the models that allow it, and its numbers.
            fn described(&self) -> (About, &dyn ObstacleShape) {
                match self {
                    $(ShapeSpec::$kind(spec) => (About { name: $name, dimensions: &$dimensions }, spec),)*
                }
            }
        }
    };
}

shapes! {
    /// A plane, or in the plane a straight line.
    Plane(plane::PlaneSpec) = "plane" in [1, 2, 3];
    /// A parabola t^2/(2 radius) that bulges towards the body.
    Parabola(polyline::ParabolaSpec) = "parabola" in [2];
    /// A circle, seen from outside or inside.
    Circle(circle::CircleSpec) = "circle" in [2];
    /// A wedge slope |t| that points at the body.
    Wedge(plane::WedgeSpec) = "wedge" in [2];
    /// A polyline.
    Table(plane::TableSpec) = "table" in [2];
    /// In space: a sphere, seen from outside or inside.
    Sphere(circle::SphereSpec) = "sphere" in [3];
    /// In space: a cylinder, seen from outside or inside, with its axis perpendicular to the approach direction.
    Cylinder(circle::CylinderSpec) = "cylinder" in [3];
    /// In space: a cone that points at the body, with its axis along the approach direction.
    Cone(plane::ConeSpec) = "cone" in [3];
    /// In space: heights on a grid, bilinear in between.
    HeightMap(height_map::HeightMapSpec) = "height-map" in [3];
    /// In space: a torus, with its axis along the approach direction or perpendicular to it.
    Torus(torus::TorusSpec) = "torus" in [3];
    /// In space: a closed surface of triangles from a file.
    Surface(triangulated::SurfaceSpec) = "surface" in [3];
    /// The surface of another elastic body.
    Body(facing::FacingSpec) = "body" in [1, 2, 3];
}

impl ShapeSpec {
    /// The surface `boundary` of another body as an obstacle within reach.
    pub(crate) fn other_body(boundary: String, reach: f64) -> Self {
        ShapeSpec::Body(facing::FacingSpec::of(boundary, reach))
    }

    /// The numbers of the obstacle shape, of whatever kind it is.
    pub(crate) fn shape(&self) -> &dyn ObstacleShape {
        self.described().1
    }

    /// The name of the shape and its numbers.
    ///
    /// # Errors
    /// A message with the allowed shapes, if a model of `dimension` coordinates does not allow this one.
    fn in_model(&self, dimension: usize) -> Result<(&'static str, &dyn ObstacleShape), String> {
        let (about, shape) = self.described();
        if about.dimensions.contains(&dimension) {
            return Ok((about.name, shape));
        }
        let of = if about.dimensions.contains(&2) { "the plane" } else { "space" };
        let there = ALL.iter().filter(|other| other.dimensions.contains(&dimension));
        let there: Vec<String> = there.map(|other| format!("`{}`", other.name)).collect();
        let (last, others) = there.split_last().map_or(("", &[][..]), |(last, others)| (last, others));
        let there = format!("{} and {last}", others.join(", "));
        Err(format!("`{}` is a shape of {of}; {} there are {there}", about.name, PLACES[dimension - 1]))
    }
}

/// The space of a model of one, two and three coordinates.
const PLACES: [&str; 3] = ["on a line", "in the plane", "in space"];
