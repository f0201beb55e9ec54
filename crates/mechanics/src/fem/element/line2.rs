//! Line2, the bar or straight edge of two nodes: N = (1 - xi, 1 + xi)/2.

use super::product::{multilinear, multilinear_slopes};
use super::quadrature::{INTERVAL_1, INTERVAL_2};
use super::reference::{CalculixCell, FacetKind, LatticeCounts, ReferenceElement, Shape};

const ENDS: &[[f64; 3]] = &[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]];

/// The linear line.
pub(super) static LINE2: ReferenceElement = ReferenceElement {
    name: "Line2",
    form: Shape::Product,
    dimension: 1,
    nodes: ENDS,
    corners: 2,
    mid_sides: &[],
    faces: &[&[0], &[1]],
    along: &[0, 1],
    shape: |at| multilinear(ENDS, at),
    derivative: |at| multilinear_slopes(ENDS, at),
    quadrature: &INTERVAL_1,
    quadrature_revolved: &INTERVAL_2,
    facet: FacetKind::Point1,
    gmsh: 1,
    gmsh_order: &[0, 1],
    vtk: 3,
    calculix: CalculixCell { number: 11, order: &[0, 1], points: &INTERVAL_2, layers: 1 },
    counts: LatticeCounts { nodes: 1.0, line: 1.0, connections: 2.0, neighbours: 3.0 },
};
