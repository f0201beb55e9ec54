//! The structured bar, rectangle and box: products of graded axes.

use super::lattice::{Side, product, steps};
use super::shape::{BodyShape, BodySite, CellBlock};
use crate::error::Error;
use crate::fem::mesh::{ElementKind, Mesh, check_lines, fail};
use crate::fem::{Axis, Integration};
use crate::scene::input::entry::Files;
use crate::scene::input::schema::model::{ElementSpec, SolidElementSpec};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Its edges run in the direction of growing coordinates.
const SIDES_OF_RECTANGLE: [Side; 4] = [("left", &[0, 3]), ("right", &[1, 2]), ("bottom", &[0, 1]), ("top", &[3, 2])];

/// A rectangle: the product of two divided axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RectangleSpec {
    /// The axis of the rectangle along x, with its cells.
    pub x: Axis,
    /// The axis of the rectangle along y, with its cells.
    pub y: Axis,
    /// The element of the rectangle.
    #[serde(default)]
    pub element: ElementSpec,
    /// The integration of the stiffness of the rectangle.
    #[serde(default)]
    pub integration: Integration,
}

impl BodyShape for RectangleSpec {
    fn mesh(&self, site: &BodySite) -> Result<Mesh, Error> {
        let [x, y] = site.lines([("x", &self.x), ("y", &self.y)])?;
        rectangle(&x, &y, self.element.kind())
    }

    fn block(&self, _: Option<Files>) -> CellBlock {
        CellBlock::product(&[&self.x, &self.y], self.element.kind())
    }

    fn refine(&mut self, times: usize) -> Result<(), Error> {
        [&mut self.x, &mut self.y].into_iter().for_each(|axis| axis.refine(times));
        Ok(())
    }
}

/// The mesh of the lines `x` and `y` (coordinates, in length, strictly increasing, at least two each), of a plane
/// element.
///
/// Nodes are numbered along x first; quadratic elements have nodes at mid-sides too. Triangles come from cutting each
/// cell from its lower left to its upper right corner. The boundaries are `left`, `right`, `bottom` and `top`, their
/// edges in the direction of growing coordinates.
///
/// # Errors
/// [`Error::Fem`] for an element that is not plane, fewer than two lines, lines that do not increase, or more than
/// `MAX_NODES` nodes.
pub fn rectangle(x: &[f64], y: &[f64], kind: ElementKind) -> Result<Mesh, Error> {
    if kind.dimension() != 2 {
        return fail(format!("a rectangle cannot have a mesh of {}", kind.name()));
    }
    check_lines(&[("x", x), ("y", y)], steps(kind.reference()))?;
    product(&[x, y], kind, &SIDES_OF_RECTANGLE)
}

/// A bar along x.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BarSpec {
    /// The axis of the bar along x, with its cells.
    pub x: Axis,
    /// Cross-section, positive.
    #[serde(default = "crate::scene::input::schema::model::one")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub area: f64,
}

impl BodyShape for BarSpec {
    fn area(&self) -> f64 {
        self.area
    }

    fn mesh(&self, site: &BodySite) -> Result<Mesh, Error> {
        let [x] = site.lines([("x", &self.x)])?;
        bar(&x)
    }

    fn block(&self, _: Option<Files>) -> CellBlock {
        CellBlock::product(&[&self.x], ElementKind::Line2)
    }

    fn refine(&mut self, times: usize) -> Result<(), Error> {
        self.x.refine(times);
        Ok(())
    }
}

/// The bar with nodes at `x` (coordinates, in length, strictly increasing, at least two); its boundaries are `left` and
/// `right`.
///
/// # Errors
/// [`Error::Fem`] for fewer than two nodes, coordinates that do not increase, or more than
/// `MAX_NODES`.
pub fn bar(x: &[f64]) -> Result<Mesh, Error> {
    check_lines(&[("x", x)], 1)?;
    product(&[x], ElementKind::Line2, &[("left", &[0]), ("right", &[1])])
}

/// The corners of its faces are counterclockwise seen from outside.
const SIDES_OF_BOX: [Side; 6] = [
    ("left", &[0, 4, 7, 3]),
    ("right", &[1, 2, 6, 5]),
    ("front", &[0, 1, 5, 4]),
    ("back", &[3, 7, 6, 2]),
    ("bottom", &[0, 3, 2, 1]),
    ("top", &[4, 5, 6, 7]),
];

/// A box: the product of three divided axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxSpec {
    /// The axis of the box along x, with its cells.
    pub x: Axis,
    /// The axis of the box along y, with its cells.
    pub y: Axis,
    /// The axis along z.
    pub z: Axis,
    /// The element of the box.
    #[serde(default)]
    pub element: SolidElementSpec,
    /// The integration of the stiffness of the box.
    #[serde(default)]
    pub integration: Integration,
}

impl BodyShape for BoxSpec {
    fn mesh(&self, site: &BodySite) -> Result<Mesh, Error> {
        let [x, y, z] = site.lines([("x", &self.x), ("y", &self.y), ("z", &self.z)])?;
        cuboid(&x, &y, &z, self.element.kind())
    }

    fn block(&self, _: Option<Files>) -> CellBlock {
        CellBlock::product(&[&self.x, &self.y, &self.z], self.element.kind())
    }

    fn refine(&mut self, times: usize) -> Result<(), Error> {
        [&mut self.x, &mut self.y, &mut self.z].into_iter().for_each(|axis| axis.refine(times));
        Ok(())
    }
}

/// The mesh of the lines `x`, `y`, `z` (coordinates, in length, strictly increasing, at least two each), of an element
/// in space.
///
/// Nodes are numbered along x first, then along y. Each cell is one brick or six tetrahedra; nodes in the middle of
/// edges follow the others. The boundaries are `left`,
/// `right` (along x), `front`, `back` (along y), `bottom` and `top` (along z), their facets counterclockwise seen from
/// outside.
///
/// # Errors
/// [`Error::Fem`] for an element of lower dimension, fewer than two lines, lines that do not increase, or more than
/// `MAX_NODES` nodes.
pub fn cuboid(x: &[f64], y: &[f64], z: &[f64], kind: ElementKind) -> Result<Mesh, Error> {
    if kind.dimension() != 3 {
        return fail(format!("a box cannot have a mesh of {}", kind.name()));
    }
    if kind.is_quadratic() {
        return Ok(cuboid(x, y, z, kind.linear())?.elevated(kind)?);
    }
    check_lines(&[("x", x), ("y", y), ("z", z)], 1)?;
    product(&[x, y, z], kind, &SIDES_OF_BOX)
}
