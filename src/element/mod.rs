//! Plane elements: reference cells, quadrature, and the integrals over one element.
//!
//! An element is a [`ReferenceElement`] in a file of its own; everything else here works on any of them.

mod cell;
mod q4;
mod quadrature;
mod t3;

pub use cell::{Cell, ElementMatrix, NonPositiveJacobian, edge_integrals};
pub use q4::Q4;
pub use quadrature::QuadraturePoint;
pub use t3::T3;

/// The largest number of nodes that an element here has.
pub const MAX_NODES: usize = 4;

/// One value per node of an element; entries beyond its nodes are zero.
pub type PerNode<T> = [T; MAX_NODES];

/// An element on its reference cell.
#[derive(Debug)]
pub struct ReferenceElement {
    /// Short name, as `Q4`.
    pub name: &'static str,
    /// Reference coordinates of the nodes, counterclockwise.
    pub nodes: &'static [[f64; 2]],
    /// Values of the shape functions at a reference point.
    pub shape: fn([f64; 2]) -> PerNode<f64>,
    /// Derivatives of the shape functions with respect to the reference coordinates, at a reference point.
    pub derivative: fn([f64; 2]) -> PerNode<[f64; 2]>,
    /// Quadrature that integrates the stiffness of an undistorted element exactly.
    pub quadrature: &'static [QuadraturePoint],
    /// Reference coordinates of the centroid.
    pub centroid: [f64; 2],
    /// Row by row of nodes, the weights that carry values at the quadrature points to the node.
    pub extrapolation: &'static [&'static [f64]],
}
