//! The element types of Gmsh by number.
//!
//! # Source
//! C. Geuzaine, J.-F. Remacle, *Gmsh Reference Manual*, chapter "Gmsh file formats", MSH file format, `elm-type`.

/// An element type of the format.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct CellType {
    /// Its number in the file.
    pub number: usize,
    /// Its name, in the plural.
    pub plural: &'static str,
    /// Dimension, 0 to 3.
    pub dimension: usize,
    pub nodes: usize,
}

const fn cell(number: usize, plural: &'static str, dimension: usize, nodes: usize) -> CellType {
    CellType { number, plural, dimension, nodes }
}

/// Every type of first and second order; types of higher order are not read.
static TYPES: [CellType; 19] = [
    cell(1, "two-node lines", 1, 2),
    cell(2, "three-node triangles", 2, 3),
    cell(3, "four-node quadrilaterals", 2, 4),
    cell(4, "four-node tetrahedra", 3, 4),
    cell(5, "eight-node bricks", 3, 8),
    cell(6, "six-node prisms", 3, 6),
    cell(7, "five-node pyramids", 3, 5),
    cell(8, "three-node lines", 1, 3),
    cell(9, "six-node triangles", 2, 6),
    cell(10, "nine-node quadrilaterals", 2, 9),
    cell(11, "ten-node tetrahedra", 3, 10),
    cell(12, "27-node bricks", 3, 27),
    cell(13, "18-node prisms", 3, 18),
    cell(14, "14-node pyramids", 3, 14),
    cell(15, "points", 0, 1),
    cell(16, "eight-node quadrilaterals", 2, 8),
    cell(17, "20-node bricks", 3, 20),
    cell(18, "15-node prisms", 3, 15),
    cell(19, "13-node pyramids", 3, 13),
];

/// The type of this number, if it is of first or second order.
pub(super) fn cell_type(number: usize) -> Option<&'static CellType> {
    TYPES.iter().find(|cell| cell.number == number)
}
