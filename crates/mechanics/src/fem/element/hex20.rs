//! Hex20, the serendipity hexahedron, integrated with 3 x 3 x 3 Gauss points: with s = 1 + xi_a xi and so on, N = s_1
//! s_2 s_3 (xi_a xi + eta_a eta + zeta_a zeta - 2)/8 at corners, (1 - xi^2) s_2 s_3/4 and so on at the mid-sides.

use super::quadrature::CUBE_3X3X3;
use super::reference::{CalculixCell, FacetKind, LatticeCounts, PerNode, ReferenceElement, Shape, with_middles};

/// The two corners of each of the 12 edges, in the order of the mid-side nodes.
const EDGES: [[usize; 2]; 12] =
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

/// The corners, which are those of the trilinear hexahedron too.
pub(super) const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// Coordinates of the 8 corners, then of the 12 mid-side nodes.
const NODES: [[f64; 3]; 20] = with_middles(CORNERS, EDGES);

/// The serendipity hexahedron.
pub(super) static HEX20: ReferenceElement = ReferenceElement {
    name: "Hex20",
    form: Shape::Product,
    dimension: 3,
    nodes: &NODES,
    corners: 8,
    mid_sides: &EDGES,
    faces: &[
        &[0, 3, 2, 1, 11, 10, 9, 8],
        &[4, 5, 6, 7, 12, 13, 14, 15],
        &[0, 1, 5, 4, 8, 17, 12, 16],
        &[1, 2, 6, 5, 9, 18, 13, 17],
        &[2, 3, 7, 6, 10, 19, 14, 18],
        &[3, 0, 4, 7, 11, 16, 15, 19],
    ],
    along: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19],
    shape,
    derivative,
    quadrature: &CUBE_3X3X3,
    quadrature_revolved: &CUBE_3X3X3,
    facet: FacetKind::Q8,
    gmsh: 17,
    gmsh_order: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15],
    vtk: 25,
    calculix: CalculixCell {
        number: 4,
        order: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 19, 12, 13, 14, 15],
        points: &CUBE_3X3X3,
        layers: 1,
    },
    counts: LatticeCounts { nodes: 4.0, line: 2.0, connections: 20.0, neighbours: 58.5 },
};

fn shape(at: [f64; 3]) -> PerNode<f64> {
    NODES.map(|node| {
        let s = [0, 1, 2].map(|axis| 1.0 + node[axis] * at[axis]);
        match middle(node) {
            Some(axis) => (1.0 - at[axis]) * (1.0 + at[axis]) * s[(axis + 1) % 3] * s[(axis + 2) % 3] / 4.0,
            None => s[0] * s[1] * s[2] * (s[0] + s[1] + s[2] - 5.0) / 8.0,
        }
    })
}

fn derivative(at: [f64; 3]) -> PerNode<[f64; 3]> {
    NODES.map(|node| {
        let s = [0, 1, 2].map(|axis| 1.0 + node[axis] * at[axis]);
        [0, 1, 2].map(|by| {
            let (one, two) = ((by + 1) % 3, (by + 2) % 3);
            match middle(node) {
                Some(axis) if axis == by => -at[by] * s[one] * s[two] / 2.0,
                Some(axis) => {
                    let other = 3 - axis - by;
                    (1.0 - at[axis]) * (1.0 + at[axis]) * node[by] * s[other] / 4.0
                }
                None => node[by] * s[one] * s[two] * (2.0 * s[by] + s[one] + s[two] - 5.0) / 8.0,
            }
        })
    })
}

/// The axis along which a mid-side node lies between its corners.
fn middle(node: [f64; 3]) -> Option<usize> {
    node.iter().position(|&coordinate| coordinate == 0.0)
}
