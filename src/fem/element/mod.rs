//! Reference cells, their quadrature, and their map into space.
//!
//! An element is a [`ReferenceElement`] in a file of its own and one line in [`ElementKind`]; everything else works on
//! any of them. Reference coordinates are `[xi, eta, zeta]`; those beyond the dimension of the cell are zero.

mod cell;
mod hex8;
mod kind;
mod line2;
mod line3;
mod point1;
mod q4;
mod q8;
mod quadrature;
mod t3;
mod t6;
mod tabulated;
mod tet4;

pub use cell::Cell;
pub use kind::{ElementKind, FacetKind};
pub use quadrature::{Part, QuadraturePoint};
pub use tabulated::{Tabulated, TabulatedPoint};

/// The largest number of nodes that an element here has.
pub const MAX_NODES: usize = 8;

/// One value per node of an element; entries beyond its nodes are zero.
pub type PerNode<T> = [T; MAX_NODES];

/// What a reference cell is the product or the hull of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A simplex: origin and unit vectors; linear functions have total degree one.
    Simplex,
    /// A product of intervals [-1, 1]; linear functions have degree one in each coordinate.
    Product,
}

/// An element on its reference cell.
#[derive(Debug)]
pub struct ReferenceElement {
    /// Short name, as `Q4`.
    pub name: &'static str,
    /// Simplex or product of intervals.
    pub form: Shape,
    /// Dimension of the cell, 0 to 3.
    pub dimension: usize,
    /// Reference coordinates of the nodes; the corners come first.
    pub nodes: &'static [[f64; 3]],
    /// Number of corners.
    pub corners: usize,
    /// Local nodes of every face, in the order of the facet's own reference cell, seen from outside counterclockwise.
    pub faces: &'static [&'static [usize]],
    /// Local nodes in the order along the cell; the own order where the cell is no line.
    pub along: &'static [usize],
    /// Values of the shape functions at a reference point.
    pub shape: fn([f64; 3]) -> PerNode<f64>,
    /// Derivatives of the shape functions with respect to the reference coordinates, at a reference point.
    pub derivative: fn([f64; 3]) -> PerNode<[f64; 3]>,
    /// Quadrature that integrates stiffness and constant loads of an undistorted cell exactly.
    pub quadrature: &'static [QuadraturePoint],
    /// The same for a cell that is revolved about an axis: the radius is one degree more.
    pub quadrature_revolved: &'static [QuadraturePoint],
    /// Reference coordinates of the centroid.
    pub centroid: [f64; 3],
}

impl ReferenceElement {
    /// The local nodes in the order that a mirrored element has: that of the cell with xi and eta exchanged, or, on a
    /// line, with xi reversed.
    pub fn mirrored(&self) -> Vec<usize> {
        let mirror = |[xi, eta, zeta]: [f64; 3]| match self.dimension {
            1 => [-xi, eta, zeta],
            _ => [eta, xi, zeta],
        };
        let place = |at: [f64; 3]| self.nodes.iter().position(|&node| node == at);
        self.nodes.iter().enumerate().map(|(local, &at)| place(mirror(at)).unwrap_or(local)).collect()
    }
}
