//! Obstacles: each gives a row for every point. Each shape has its own file and is named only there and here.

mod circle;
mod cone;
mod cylinder;
mod facing;
mod graph;
mod height_map;
pub(crate) mod mortar;
#[cfg(test)]
mod oracle;
pub(crate) mod order;
mod pairs;
mod parabola;
mod patch;
mod placed;
mod plane;
mod polyline;
mod row;
mod ruled;
mod shape;
mod sphere;
mod surface;
mod table;
mod torus;
mod triangle;
mod triangulated;
mod wedge;

pub use circle::CircleSpec;
pub use cone::ConeSpec;
pub use cylinder::CylinderSpec;
pub use facing::FacingSpec;
pub(crate) use facing::shortest_edges;
pub use height_map::HeightMapSpec;
pub(crate) use order::SideOrder;
pub(crate) use pairs::Between;
pub use parabola::ParabolaSpec;
pub use placed::{Inertia, PlacedObstacle};
pub use plane::PlaneSpec;
pub use row::{Obstacle, ObstacleRow};
pub use sphere::SphereSpec;
pub use table::TableSpec;
pub use torus::TorusSpec;
pub use triangulated::SurfaceSpec;
pub use wedge::WedgeSpec;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use shape::{About, ObstacleShape};

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

/// The names of all shapes, in the order of messages.
const ALL: [About; 12] = [
    plane::ABOUT,
    parabola::ABOUT,
    circle::ABOUT,
    wedge::ABOUT,
    table::ABOUT,
    sphere::ABOUT,
    cylinder::ABOUT,
    cone::ABOUT,
    height_map::ABOUT,
    torus::ABOUT,
    triangulated::ABOUT,
    facing::ABOUT,
];

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
            ShapeSpec::Plane(spec) => (plane::ABOUT, spec),
            ShapeSpec::Parabola(spec) => (parabola::ABOUT, spec),
            ShapeSpec::Circle(spec) => (circle::ABOUT, spec),
            ShapeSpec::Wedge(spec) => (wedge::ABOUT, spec),
            ShapeSpec::Table(spec) => (table::ABOUT, spec),
            ShapeSpec::Sphere(spec) => (sphere::ABOUT, spec),
            ShapeSpec::Cylinder(spec) => (cylinder::ABOUT, spec),
            ShapeSpec::Cone(spec) => (cone::ABOUT, spec),
            ShapeSpec::HeightMap(spec) => (height_map::ABOUT, spec),
            ShapeSpec::Torus(spec) => (torus::ABOUT, spec),
            ShapeSpec::Surface(spec) => (triangulated::ABOUT, spec),
            ShapeSpec::Body(spec) => (facing::ABOUT, spec),
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
