//! Line2, the bar or straight edge of two nodes: N = (1 - xi, 1 + xi)/2.

use super::quadrature::{INTERVAL_1, INTERVAL_2};
use super::reference::{FacetKind, LatticeCounts, MAX_NODES, PerNode, ReferenceElement, Shape};

/// The linear line.
pub(super) static LINE2: ReferenceElement = ReferenceElement {
    name: "Line2",
    form: Shape::Product,
    dimension: 1,
    nodes: &[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]],
    corners: 2,
    mid_sides: &[],
    faces: &[&[0], &[1]],
    along: &[0, 1],
    shape,
    derivative,
    quadrature: &INTERVAL_1,
    quadrature_revolved: &INTERVAL_2,
    centroid: [0.0; 3],
    facet: FacetKind::Point1,
    gmsh: 1,
    gmsh_order: &[0, 1],
    vtk: 3,
    counts: LatticeCounts { nodes: 1.0, line: 1.0, connections: 2.0, neighbours: 3.0 },
};

fn shape([xi, ..]: [f64; 3]) -> PerNode<f64> {
    let mut values = [0.0; MAX_NODES];
    values[..2].copy_from_slice(&[(1.0 - xi) / 2.0, (1.0 + xi) / 2.0]);
    values
}

fn derivative(_: [f64; 3]) -> PerNode<[f64; 3]> {
    let mut slopes = [[0.0; 3]; MAX_NODES];
    slopes[..2].copy_from_slice(&[[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]);
    slopes
}
