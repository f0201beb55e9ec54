//! Reference cells, their quadrature, and their map into space.
//!
//! An element is a [`ReferenceElement`] and a variant of [`ElementKind`], both in `shapes.rs`; all other code works for
//! any element. Reference coordinates are `[xi, eta, zeta]`; those beyond the dimension of the cell are zero.

mod cell;
mod functions;
mod quadrature;
mod reference;
mod shapes;

pub use cell::{Cell, InverseMap, NonPositiveJacobian};
pub use functions::{POSITIVE_SHARE, positive_coefficient, positive_functions};
pub use functions::{QuadratureRule, Tabulated, TabulatedPoint};
pub use quadrature::{between_levels, gauss_legendre};
pub use reference::{LatticeCounts, MAX_NODES, PerNode, QuadraturePoint, ReferenceElement, Shape};
pub use shapes::{ElementKind, ElementKind as FacetKind};

impl ElementKind {
    /// The triangle with a linear displacement.
    pub const LINEAR_TRIANGLE: ElementKind = ElementKind::T3;

    /// The triangle with a quadratic displacement.
    pub const QUADRATIC_TRIANGLE: ElementKind = ElementKind::T6;

    /// The tetrahedron with a linear displacement, which bisection refines in space.
    pub const LINEAR_TETRAHEDRON: ElementKind = ElementKind::Tet4;

    /// The tetrahedron with a quadratic displacement.
    pub const QUADRATIC_TETRAHEDRON: ElementKind = ElementKind::Tet10;

    /// Short name of the element type, as `Q4`.
    pub fn name(self) -> &'static str {
        self.reference().name
    }

    /// Number of nodes of one element or facet, corners and mid-sides.
    pub fn nodes(self) -> usize {
        self.reference().nodes.len()
    }

    /// Number of corners of one element; they are its first nodes.
    pub fn corners(self) -> usize {
        self.reference().corners
    }

    /// Dimension of the element: 1, 2 or 3; of the end of a bar 0.
    pub fn dimension(self) -> usize {
        self.reference().dimension
    }

    /// The element of the corners alone.
    #[doc(hidden)]
    pub fn linear(self) -> ElementKind {
        let is_linear = |other: &ElementKind| {
            let (own, other) = (self.reference(), other.reference());
            other.nodes.len() == own.corners && (own.form, own.dimension) == (other.form, other.dimension)
        };
        Self::ALL.into_iter().find(is_linear).unwrap_or(self)
    }

    /// Returns `true` if linear functions have degree one in each coordinate: a quadrilateral, a brick.
    pub fn is_product(self) -> bool {
        self.reference().form == Shape::Product
    }

    /// Returns `true` if the mean of the dilatation over the element can replace the dilatation: the linear products in
    /// the plane and in space.
    pub fn takes_mean_dilatation(self) -> bool {
        self.is_product() && !self.is_quadratic() && self.dimension() > 1
    }

    /// The names of the elements that allow mean dilatation, as `Q4 and Hex8` with the word `and`.
    pub fn of_mean_dilatation(join: &str) -> String {
        let names = Self::ALL.into_iter().filter(|kind| kind.takes_mean_dilatation()).map(Self::name);
        names.collect::<Vec<_>>().join(&format!(" {join} "))
    }

    /// The straight cells of a facet with these nodes, in the order of its reference cell: the nodes around each cell.
    pub fn straight_cells(self, facet: &[usize]) -> Vec<Vec<usize>> {
        let of_facet = |cell: &&[usize]| cell.iter().map(|&local| facet[local]).collect();
        self.reference().straight.iter().map(of_facet).collect()
    }

    /// Returns `true` if the shape functions have degree two.
    pub fn is_quadratic(self) -> bool {
        self.nodes() > self.corners()
    }
}

#[derive(Clone, Debug)]
pub struct PerKind<T>(Vec<(ElementKind, T)>);

impl<T> PerKind<T> {
    /// The values that `make` gives for the kinds of a mesh, of which there is at least one.
    pub fn of(kinds: impl Iterator<Item = ElementKind>, make: impl Fn(ElementKind) -> T) -> Self {
        PerKind(kinds.map(|kind| (kind, make(kind))).collect())
    }

    #[inline]
    pub fn at(&self, kind: ElementKind) -> &T {
        &self.0[self.0.iter().position(|entry| entry.0 == kind).unwrap_or(0)].1
    }
}
