//! The structured rectangle: the product of two graded axes.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::shape::{About, Block, BodyShape, Site};
use crate::error::Error;
use crate::fem::mesh::lattice::half_steps;
use crate::fem::mesh::{Boundary, ElementKind, Mesh, check_lines, fail};
use crate::fem::{Axis, Integration};
use crate::scene::input::files::Files;
use crate::scene::input::schema::cells::ElementSpec;

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

pub(super) const ABOUT: About = About { name: "rectangle", dimensions: &[2] };

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
/// [`Error::Mesh`] for an element that is not plane, fewer than two lines, lines that do not increase, or more than
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
    Mesh::new(nodes, kind, connectivity, boundaries)
}
