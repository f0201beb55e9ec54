//! The elements and facets by name.

use super::ReferenceElement;
use super::hex8::HEX8;
use super::line2::LINE2;
use super::line3::LINE3;
use super::point1::POINT1;
use super::q4::Q4;
use super::q8::Q8;
use super::t3::T3;
use super::t6::T6;
use super::tet4::TET4;

/// The elements that a mesh can be made of.
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
}

impl ElementKind {
    /// The reference cell.
    pub fn reference(self) -> &'static ReferenceElement {
        match self {
            ElementKind::Line2 => &LINE2,
            ElementKind::T3 => &T3,
            ElementKind::T6 => &T6,
            ElementKind::Q4 => &Q4,
            ElementKind::Q8 => &Q8,
            ElementKind::Tet4 => &TET4,
            ElementKind::Hex8 => &HEX8,
        }
    }

    /// What a face of the element is.
    pub fn facet(self) -> FacetKind {
        match self {
            ElementKind::Line2 => FacetKind::Point1,
            ElementKind::T3 | ElementKind::Q4 => FacetKind::Line2,
            ElementKind::T6 | ElementKind::Q8 => FacetKind::Line3,
            ElementKind::Tet4 => FacetKind::T3,
            ElementKind::Hex8 => FacetKind::Q4,
        }
    }

    /// Short name, as `Q4`.
    pub fn name(self) -> &'static str {
        self.reference().name
    }

    /// Number of nodes of one element.
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

    /// Has the element shape functions of degree two?
    pub fn is_quadratic(self) -> bool {
        self.nodes() > self.corners()
    }
}

/// The faces of elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FacetKind {
    /// The end of a bar.
    Point1,
    /// Straight edge of two nodes.
    Line2,
    /// Quadratic edge: two ends, then the mid-side.
    Line3,
    /// Triangle of three nodes.
    T3,
    /// Quadrilateral of four nodes, in order around it.
    Q4,
}

impl FacetKind {
    /// The reference cell.
    pub fn reference(self) -> &'static ReferenceElement {
        match self {
            FacetKind::Point1 => &POINT1,
            FacetKind::Line2 => &LINE2,
            FacetKind::Line3 => &LINE3,
            FacetKind::T3 => &T3,
            FacetKind::Q4 => &Q4,
        }
    }

    /// Number of nodes of one facet.
    pub fn nodes(self) -> usize {
        self.reference().nodes.len()
    }
}
