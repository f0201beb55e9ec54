//! The structured bar, rectangle and box: products of graded axes.

use super::shape::{Block, BodyShape, Site};
use crate::error::Error;
use crate::fem::mesh::axis::half_steps;
use crate::fem::mesh::pieces::OF_HEXAHEDRON;
use crate::fem::mesh::{Boundary, ElementKind, FacetKind, Mesh, check_lines, fail};
use crate::fem::{Axis, Integration};
use crate::scene::input::entry::Files;
use crate::scene::input::schema::model::{ElementSpec, SolidElementSpec};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Marks a place without a node: the middle of a quadratic quadrilateral.
const NO_NODE: usize = usize::MAX;

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
    fn integration(&self) -> Integration {
        self.integration
    }

    fn mesh(&self, site: &Site) -> Result<Mesh, Error> {
        site.check_product(&[&self.x, &self.y])?;
        rectangle(&site.lines(&self.x, "x")?, &site.lines(&self.y, "y")?, self.element.kind())
    }

    fn block(&self, _: Option<Files>) -> Block {
        Block::product(&[&self.x, &self.y], self.element.kind())
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
    let step = if kind.is_quadratic() { 2 } else { 1 };
    check_lines(&[("x", x), ("y", y)], step)?;
    let (columns, rows) = (x.len() - 1, y.len() - 1);
    let fine = |lines: &[f64]| if step == 2 { half_steps(lines) } else { lines.to_vec() };
    let (fine_x, fine_y) = (fine(x), fine(y));
    // The grid of lines and mid-lines; a quadratic quadrilateral has no node in its middle.
    let hollow = step == 2 && kind.corners() == 4;
    let mut number = vec![NO_NODE; fine_x.len() * fine_y.len()];
    let mut nodes = Vec::with_capacity(number.len());
    for (j, &y) in fine_y.iter().enumerate() {
        for (i, &x) in fine_x.iter().enumerate() {
            if !hollow || i % 2 == 0 || j % 2 == 0 {
                number[j * fine_x.len() + i] = nodes.len();
                nodes.push([x, y, 0.0]);
            }
        }
    }
    let node = |i: usize, j: usize| number[j * fine_x.len() + i];
    // A simplex or quadrilateral of grid points, its mid-sides between them.
    let element = |corners: &[[usize; 2]], connectivity: &mut Vec<usize>| {
        connectivity.extend(corners.iter().map(|&[i, j]| node(i, j)));
        if step == 2 {
            let next = corners.iter().cycle().skip(1);
            connectivity.extend(corners.iter().zip(next).map(|(a, b)| node((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)));
        }
    };
    let mut connectivity = Vec::with_capacity(columns * rows * kind.nodes() * 2);
    for j in (0..rows).map(|j| j * step) {
        for i in (0..columns).map(|i| i * step) {
            let (right, top) = (i + step, j + step);
            if kind.corners() == 4 {
                element(&[[i, j], [right, j], [right, top], [i, top]], &mut connectivity);
            } else {
                element(&[[i, j], [right, j], [right, top]], &mut connectivity);
                element(&[[i, j], [right, top], [i, top]], &mut connectivity);
            }
        }
    }
    connectivity.shrink_to_fit();
    let side = |name: &str, cells: usize, at: &dyn Fn(usize) -> usize| {
        // Ends first, then the mid-side.
        let edge = |cell: usize| [at(step * cell), at(step * (cell + 1)), at(step * cell + 1)];
        let connectivity = (0..cells).flat_map(|cell| edge(cell).into_iter().take(step + 1)).collect();
        Boundary::new(name, kind.facet(), connectivity)
    };
    let (last_x, last_y) = (fine_x.len() - 1, fine_y.len() - 1);
    let boundaries = vec![
        side("left", rows, &|j| node(0, j)),
        side("right", rows, &|j| node(last_x, j)),
        side("bottom", columns, &|i| node(i, 0)),
        side("top", columns, &|i| node(i, last_y)),
    ];
    Ok(Mesh::new(nodes, kind, connectivity, boundaries)?)
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
    fn integration(&self) -> Integration {
        Integration::Standard
    }

    fn area(&self) -> f64 {
        self.area
    }

    fn mesh(&self, site: &Site) -> Result<Mesh, Error> {
        bar(&site.lines(&self.x, "x")?)
    }

    fn block(&self, _: Option<Files>) -> Block {
        Block::product(&[&self.x], ElementKind::Line2)
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
    let cells = x.len() - 1;
    let end = |name: &str, node| Boundary::new(name, FacetKind::Point1, vec![node]);
    let mesh = Mesh::new(
        x.iter().map(|&x| [x, 0.0, 0.0]).collect(),
        ElementKind::Line2,
        (0..cells).flat_map(|cell| [cell, cell + 1]).collect(),
        vec![end("left", 0), end("right", cells)],
    );
    Ok(mesh?)
}

/// The corners of a cell, in steps along x, y and z, in the order of a brick.
const CORNERS: [[usize; 3]; 8] =
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];

/// The sides: name, axis normal to the side, upper end or not, and the corners of a cell's face seen from outside
/// counterclockwise, the first one being the lowest or the highest of the face.
const SIDES: [(&str, usize, bool, [usize; 4]); 6] = [
    ("left", 0, false, [0, 4, 7, 3]),
    ("right", 0, true, [1, 2, 6, 5]),
    ("front", 1, false, [0, 1, 5, 4]),
    ("back", 1, true, [3, 7, 6, 2]),
    ("bottom", 2, false, [0, 3, 2, 1]),
    ("top", 2, true, [4, 5, 6, 7]),
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
    fn integration(&self) -> Integration {
        self.integration
    }

    fn mesh(&self, site: &Site) -> Result<Mesh, Error> {
        site.check_product(&[&self.x, &self.y, &self.z])?;
        cuboid(&site.lines(&self.x, "x")?, &site.lines(&self.y, "y")?, &site.lines(&self.z, "z")?, self.element.kind())
    }

    fn block(&self, _: Option<Files>) -> Block {
        Block::product(&[&self.x, &self.y, &self.z], self.element.kind())
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
    let count = [x.len() - 1, y.len() - 1, z.len() - 1];
    let nodes = z.iter().flat_map(|&z| y.iter().flat_map(move |&y| x.iter().map(move |&x| [x, y, z]))).collect();
    let corner = |cell: [usize; 3], local: usize| {
        let at = [0, 1, 2].map(|axis| cell[axis] + CORNERS[local][axis]);
        (at[2] * y.len() + at[1]) * x.len() + at[0]
    };
    let cells = |low: [usize; 3], high: [usize; 3]| {
        (low[2]..high[2])
            .flat_map(move |k| (low[1]..high[1]).flat_map(move |j| (low[0]..high[0]).map(move |i| [i, j, k])))
    };
    let of_bricks = kind.is_product();
    let mut connectivity = Vec::with_capacity(count.iter().product::<usize>() * if of_bricks { 8 } else { 24 });
    for cell in cells([0; 3], count) {
        if of_bricks {
            connectivity.extend((0..8).map(|local| corner(cell, local)));
        } else {
            connectivity.extend(OF_HEXAHEDRON.as_flattened().iter().map(|&local| corner(cell, local)));
        }
    }
    let side = |(name, axis, upper, face): (&str, usize, bool, [usize; 4])| {
        let (mut low, mut high) = ([0; 3], count);
        if upper {
            low[axis] = count[axis] - 1
        } else {
            high[axis] = 1
        }
        let mut facets = Vec::new();
        for cell in cells(low, high) {
            let nodes = face.map(|local| corner(cell, local));
            if of_bricks {
                facets.extend(nodes);
            } else {
                // Cut along the diagonal from the lowest to the highest node of the face.
                let first = (0..4).min_by_key(|&place| nodes[place]).unwrap_or(0);
                facets.extend([0, 1, 2, 0, 2, 3].map(|step| nodes[(first + step) % 4]));
            }
        }
        Boundary::new(name, kind.facet(), facets)
    };
    Ok(Mesh::new(nodes, kind, connectivity, SIDES.map(side).to_vec())?)
}
