//! Obstacles: each gives a row for every point. A shape is named only in its file and here.

mod circle;
mod facing;
mod graph;
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
mod torus;
mod triangulated;

pub use circle::{CircleSpec, CylinderSpec, SphereSpec};
pub use facing::FacingSpec;
pub(crate) use facing::shortest_edges;
pub use height_map::HeightMapSpec;
pub(crate) use order::{Between, SideOrder};
pub use placed::{Inertia, PlacedObstacle};
pub use plane::{ConeSpec, PlaneSpec, TableSpec, WedgeSpec};
pub use polyline::ParabolaSpec;
pub use row::{Obstacle, ObstacleRow};
pub use torus::TorusSpec;
pub use triangulated::SurfaceSpec;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::input::body::About;
use shape::ObstacleShape;

/// The surface of an obstacle, over the coordinates perpendicular to the approach direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ShapeSpec {
    /// A plane, or in the plane a straight line.
    Plane(PlaneSpec),
    /// A parabola t^2/(2 radius) that bulges towards the body.
    Parabola(ParabolaSpec),
    /// A circle, seen from outside or inside.
    Circle(CircleSpec),
    /// A wedge slope |t| that points at the body.
    Wedge(WedgeSpec),
    /// A polyline.
    Table(TableSpec),
    /// In space: a sphere, seen from outside or inside.
    Sphere(SphereSpec),
    /// In space: a cylinder, seen from outside or inside, with its axis perpendicular to the approach direction.
    Cylinder(CylinderSpec),
    /// In space: a cone that points at the body, with its axis along the approach direction.
    Cone(ConeSpec),
    /// In space: heights on a grid, bilinear in between.
    HeightMap(HeightMapSpec),
    /// In space: a torus, with its axis along the approach direction or perpendicular to it.
    Torus(TorusSpec),
    /// In space: a closed surface of triangles from a file.
    Surface(SurfaceSpec),
    /// The surface of another elastic body.
    Body(FacingSpec),
}

// A shape by its name, with the dimensions of the models that allow it.
const PLANE: About = About { name: "plane", dimensions: &[1, 2, 3] };
const PARABOLA: About = About { name: "parabola", dimensions: &[2] };
const CIRCLE: About = About { name: "circle", dimensions: &[2] };
const WEDGE: About = About { name: "wedge", dimensions: &[2] };
const TABLE: About = About { name: "table", dimensions: &[2] };
const SPHERE: About = About { name: "sphere", dimensions: &[3] };
const CYLINDER: About = About { name: "cylinder", dimensions: &[3] };
const CONE: About = About { name: "cone", dimensions: &[3] };
const HEIGHT_MAP: About = About { name: "height-map", dimensions: &[3] };
const TORUS: About = About { name: "torus", dimensions: &[3] };
const SURFACE: About = About { name: "surface", dimensions: &[3] };
const BODY: About = About { name: "body", dimensions: &[1, 2, 3] };

/// The names of all shapes, in the order of messages.
const ALL: [About; 12] =
    [PLANE, PARABOLA, CIRCLE, WEDGE, TABLE, SPHERE, CYLINDER, CONE, HEIGHT_MAP, TORUS, SURFACE, BODY];

impl ShapeSpec {
    /// The surface `boundary` of another body as an obstacle within reach.
    pub(crate) fn other_body(boundary: String, reach: f64) -> Self {
        ShapeSpec::Body(FacingSpec::of(boundary, reach))
    }

    /// The name of the obstacle shape and the models that allow it.
    fn about(&self) -> About {
        self.described().0
    }

    /// The numbers of the obstacle shape, of whatever kind it is.
    pub(crate) fn shape(&self) -> &dyn ObstacleShape {
        self.described().1
    }

    /// What [`about`](Self::about) and [`shape`](Self::shape) return: the only place that distinguishes the kinds of
    /// obstacles.
    fn described(&self) -> (About, &dyn ObstacleShape) {
        match self {
            ShapeSpec::Plane(spec) => (PLANE, spec),
            ShapeSpec::Parabola(spec) => (PARABOLA, spec),
            ShapeSpec::Circle(spec) => (CIRCLE, spec),
            ShapeSpec::Wedge(spec) => (WEDGE, spec),
            ShapeSpec::Table(spec) => (TABLE, spec),
            ShapeSpec::Sphere(spec) => (SPHERE, spec),
            ShapeSpec::Cylinder(spec) => (CYLINDER, spec),
            ShapeSpec::Cone(spec) => (CONE, spec),
            ShapeSpec::HeightMap(spec) => (HEIGHT_MAP, spec),
            ShapeSpec::Torus(spec) => (TORUS, spec),
            ShapeSpec::Surface(spec) => (SURFACE, spec),
            ShapeSpec::Body(spec) => (BODY, spec),
        }
    }

    /// A message that a model of `dimension` coordinates does not allow the shape, with the allowed shapes; `None` if
    /// it does.
    fn misfit(&self, dimension: usize) -> Option<String> {
        let about = self.about();
        if about.dimensions.contains(&dimension) {
            return None;
        }
        let of = if about.dimensions.contains(&2) { "the plane" } else { "space" };
        let there = ALL.iter().filter(|other| other.dimensions.contains(&dimension));
        let there: Vec<String> = there.map(|other| format!("`{}`", other.name)).collect();
        let (last, others) = there.split_last()?;
        let there = format!("{} there are {} and {last}", PLACES[dimension - 1], others.join(", "));
        Some(format!("`{}` is a shape of {of}; {there}", about.name))
    }
}

/// The space of a model of one, two and three coordinates.
const PLACES: [&str; 3] = ["on a line", "in the plane", "in space"];
