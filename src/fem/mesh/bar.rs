//! The structured bar along x.

use super::{Boundary, ElementKind, FacetKind, Mesh, check_lines};
use crate::error::Error;

/// The bar with nodes at `x` (coordinates, strictly increasing, at least two); its boundaries are `left` and `right`.
///
/// # Errors
/// [`Error::Mesh`] for fewer than two nodes, coordinates that do not increase, or more than
/// `MAX_NODES`.
pub fn bar(x: &[f64]) -> Result<Mesh, Error> {
    check_lines(&[("x", x)], 1)?;
    let cells = x.len() - 1;
    let end = |name: &str, node| Boundary::new(name, FacetKind::Point1, vec![node]);
    Mesh::new(
        x.iter().map(|&x| [x, 0.0, 0.0]).collect(),
        ElementKind::Line2,
        (0..cells).flat_map(|cell| [cell, cell + 1]).collect(),
        vec![end("left", 0), end("right", cells)],
    )
}
