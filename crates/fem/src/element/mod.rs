//! Reference cells, their quadrature, and their map into space.
//!
//! An element is a [`ReferenceElement`] and a line in [`ElementKind`], which is defined here; all other
//! code works for any element. Reference coordinates are `[xi, eta, zeta]`; those beyond the dimension of the cell are
//! zero.

mod cell;
mod functions;
mod quadrature;
mod reference;
mod shapes;

pub use cell::{Cell, Inverse, NonPositiveJacobian};
pub use functions::{POSITIVE_SHARE, positive_coefficient, positive_functions};
pub use functions::{Rule, Tabulated, TabulatedPoint};
pub use quadrature::{Part, between_levels, gauss_legendre};
pub use reference::{FacetKind, LatticeCounts, MAX_NODES, PerNode, QuadraturePoint, ReferenceElement, Shape};

use shapes::{HEX8, HEX20, LINE2, LINE3, POINT1, Q4, Q8, T3, T6, TET4, TET10};

/// The elements of which a mesh can consist, by the number of their nodes: a letter for the shape and the count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElementKind {
    /// Bar of two nodes.
    Line2,
    /// Linear triangle, three nodes counterclockwise.
    T3,
    /// Quadratic triangle: three corners counterclockwise, then the mid-sides (0,1), (1,2), (2,0).
    T6,
    /// Bilinear quadrilateral, four nodes counterclockwise.
    Q4,
    /// Serendipity quadrilateral: four corners counterclockwise, then the mid-sides (0,1), (1,2), (2,3), (3,0).
    Q8,
    /// Linear tetrahedron: the first three nodes are counterclockwise seen from the fourth.
    Tet4,
    /// Trilinear hexahedron: the lower face counterclockwise seen from above, then the upper one (VTK order).
    Hex8,
    /// Quadratic tetrahedron: four corners as those of `Tet4`, then the mid-sides (0,1), (1,2), (2,0), (0,3), (1,3),
    /// (2,3) (VTK order).
    Tet10,
    /// Serendipity hexahedron: eight corners as those of `Hex8`, then the mid-sides of the lower face, of the upper
    /// one, and of the edges between them (VTK order).
    Hex20,
}

impl ElementKind {
    /// The triangle with a linear displacement.
    pub const LINEAR_TRIANGLE: ElementKind = ElementKind::T3;

    /// The triangle with a quadratic displacement.
    pub const QUADRATIC_TRIANGLE: ElementKind = ElementKind::T6;

    /// The tetrahedron with a linear displacement, which bisection refines in space.
    pub const LINEAR_TETRAHEDRON: ElementKind = ElementKind::Tet4;

    /// The tetrahedron with a quadratic displacement.
    pub const QUADRATIC_TETRAHEDRON: ElementKind = ElementKind::Tet10;

    /// All nine elements, in the order of the variants.
    pub const ALL: [ElementKind; 9] = [
        ElementKind::Line2,
        ElementKind::T3,
        ElementKind::T6,
        ElementKind::Q4,
        ElementKind::Q8,
        ElementKind::Tet4,
        ElementKind::Hex8,
        ElementKind::Tet10,
        ElementKind::Hex20,
    ];

    /// The reference cell: its nodes, faces, shape functions and quadrature.
    pub fn reference(self) -> &'static ReferenceElement {
        match self {
            ElementKind::Line2 => &LINE2,
            ElementKind::T3 => &T3,
            ElementKind::T6 => &T6,
            ElementKind::Q4 => &Q4,
            ElementKind::Q8 => &Q8,
            ElementKind::Tet4 => &TET4,
            ElementKind::Hex8 => &HEX8,
            ElementKind::Tet10 => &TET10,
            ElementKind::Hex20 => &HEX20,
        }
    }

    /// The kind of each face; all faces of one element are alike.
    pub fn facet(self) -> FacetKind {
        self.reference().facet
    }

    /// Short name of the element type, as `Q4`.
    pub fn name(self) -> &'static str {
        self.reference().name
    }

    /// Number of nodes of one element, corners and mid-sides.
    pub fn nodes(self) -> usize {
        self.reference().nodes.len()
    }

    /// Number of corners of one element; they are its first nodes.
    pub fn corners(self) -> usize {
        self.reference().corners
    }

    /// Dimension of the element: 1, 2 or 3.
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

impl FacetKind {
    /// The straight cells of a facet with these nodes, in the order of its reference cell: the nodes around each cell.
    pub fn straight_cells(self, facet: &[usize]) -> Vec<Vec<usize>> {
        // A quadratic triangle is cut into four: the corners and the middle. A quadratic quadrilateral is cut into four
        // corners and the middle.
        const QUARTERS: [[usize; 3]; 4] = [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]];
        const CORNERS_AND_MIDDLE: [&[usize]; 5] = [&[0, 4, 7], &[4, 1, 5], &[5, 2, 6], &[6, 3, 7], &[4, 5, 6, 7]];
        let of_facet = |cell: &[usize]| cell.iter().map(|&local| facet[local]).collect();
        match self {
            FacetKind::Point1 | FacetKind::T3 | FacetKind::Q4 => vec![facet.to_vec()],
            FacetKind::Line2 | FacetKind::Line3 => {
                let along: Vec<usize> = self.reference().along.iter().map(|&local| facet[local]).collect();
                along.windows(2).map(<[usize]>::to_vec).collect()
            }
            FacetKind::T6 => QUARTERS.iter().map(|cell| of_facet(cell)).collect(),
            FacetKind::Q8 => CORNERS_AND_MIDDLE.iter().map(|cell| of_facet(cell)).collect(),
        }
    }

    /// The reference cell: its nodes, shape functions and quadrature.
    pub fn reference(self) -> &'static ReferenceElement {
        match self {
            FacetKind::Point1 => &POINT1,
            FacetKind::Line2 => &LINE2,
            FacetKind::Line3 => &LINE3,
            FacetKind::T3 => &T3,
            FacetKind::Q4 => &Q4,
            FacetKind::T6 => &T6,
            FacetKind::Q8 => &Q8,
        }
    }

    /// Number of nodes of one facet, corners and mid-sides.
    pub fn nodes(self) -> usize {
        self.reference().nodes.len()
    }
}
