//! The structured rectangle: the product of two graded axes.

use super::{Boundary, ElementKind, Mesh, check_lines, fail};
use crate::error::Error;

/// No node stands here: the middle of a Q8 cell.
const NO_NODE: usize = usize::MAX;

/// The mesh of the lines `x` and `y` (coordinates, strictly increasing, at least two each), of T3, T6, Q4 or Q8.
///
/// Nodes are numbered along x first; those of quadratic elements stand at mid-sides. Triangles come from cutting each
/// cell from its lower left to its upper right corner. The boundaries are `left`, `right`, `bottom` and `top`, their
/// edges in the direction of growing coordinates.
///
/// # Errors
/// [`Error::Mesh`] for an element that is not plane, fewer than two lines, lines that do not increase, or more than
/// `MAX_NODES` nodes.
pub fn rectangle(x: &[f64], y: &[f64], kind: ElementKind) -> Result<Mesh, Error> {
    if kind.dimension() != 2 {
        return fail(format!("a rectangle is no mesh of {}", kind.name()));
    }
    let step = if kind.is_quadratic() { 2 } else { 1 };
    check_lines(&[("x", x), ("y", y)], step)?;
    let (columns, rows) = (x.len() - 1, y.len() - 1);
    let (fine_x, fine_y) = (with_midpoints(x, step), with_midpoints(y, step));
    // The grid of lines and mid-lines; the middles of Q8 cells are left out.
    let mut number = vec![NO_NODE; fine_x.len() * fine_y.len()];
    let mut nodes = Vec::with_capacity(number.len());
    for (j, &y) in fine_y.iter().enumerate() {
        for (i, &x) in fine_x.iter().enumerate() {
            if kind != ElementKind::Q8 || i % 2 == 0 || j % 2 == 0 {
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

/// The lines, and half way between each two of them where `step` is 2.
fn with_midpoints(lines: &[f64], step: usize) -> Vec<f64> {
    let mut fine = Vec::with_capacity(lines.len() * step);
    for (index, &line) in lines.iter().enumerate() {
        if step == 2 && index > 0 {
            let before = lines[index - 1];
            fine.push(before + (line - before) / 2.0);
        }
        fine.push(line);
    }
    fine
}
