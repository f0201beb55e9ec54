//! The reference cells of all elements and facets: a point, lines, triangles, quadrilaterals, tetrahedra, hexahedra.

use super::functions::{linear, linear_slopes, multilinear, multilinear_slopes, quadratic, quadratic_slopes};
use super::quadrature::{
    CUBE_2X2X2, CUBE_3X3X3, INTERVAL_1, INTERVAL_2, INTERVAL_3, POINT, SQUARE_2X2, SQUARE_3X3, TETRAHEDRON_1,
    TETRAHEDRON_4, TETRAHEDRON_8, TRIANGLE_1, TRIANGLE_3, TRIANGLE_6,
};
use super::reference::{
    CalculixCell, LatticeCounts, MAX_NODES, PerNode, ReferenceElement, Shape, padded, with_middles,
};

/// The cells of meshes and the facets of their boundaries, by the number of their nodes: a letter for the shape and the
/// count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElementKind {
    /// The end of a bar.
    Point1,
    /// Bar or straight edge of two nodes.
    Line2,
    /// Quadratic edge: two ends, then the mid-side.
    Line3,
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
    /// The elements of which a mesh can consist.
    pub const ALL: [ElementKind; 9] = {
        use ElementKind::{Hex8, Hex20, Line2, Q4, Q8, T3, T6, Tet4, Tet10};
        [Line2, T3, T6, Q4, Q8, Tet4, Hex8, Tet10, Hex20]
    };

    /// The reference cell: its nodes, faces, shape functions and quadrature.
    pub fn reference(self) -> &'static ReferenceElement {
        match self {
            ElementKind::Point1 => &POINT1,
            ElementKind::Line2 => &LINE2,
            ElementKind::Line3 => &LINE3,
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

    /// The kind of each face; all faces of one element are alike. Points and lines have ends.
    pub fn facet(self) -> ElementKind {
        match self {
            ElementKind::Point1 | ElementKind::Line2 | ElementKind::Line3 => ElementKind::Point1,
            ElementKind::T3 | ElementKind::Q4 => ElementKind::Line2,
            ElementKind::T6 | ElementKind::Q8 => ElementKind::Line3,
            ElementKind::Tet4 => ElementKind::T3,
            ElementKind::Tet10 => ElementKind::T6,
            ElementKind::Hex8 => ElementKind::Q4,
            ElementKind::Hex20 => ElementKind::Q8,
        }
    }
}

/// Point1, the end of a bar: N = 1.
static POINT1: ReferenceElement = ReferenceElement {
    name: "Point1",
    form: Shape::Simplex,
    dimension: 0,
    nodes: &[[0.0; 3]],
    corners: 1,
    mid_sides: &[],
    faces: &[],
    straight: &[&[0]],
    shape: |_| padded([1.0]),
    derivative: |_| [[0.0; 3]; MAX_NODES],
    quadrature: &POINT,
    quadrature_revolved: &POINT,
    gmsh: 15,
    gmsh_order: &[0],
    vtk: 1,
    calculix: CalculixCell { number: 0, order: &[0], points: &POINT, layers: 1 },
    counts: LatticeCounts::NONE,
};

const ENDS: &[[f64; 3]] = &[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]];

/// Line2, the bar or straight edge of two nodes: N = (1 - xi, 1 + xi)/2.
static LINE2: ReferenceElement = ReferenceElement {
    name: "Line2",
    form: Shape::Product,
    dimension: 1,
    nodes: ENDS,
    corners: 2,
    mid_sides: &[],
    faces: &[&[0], &[1]],
    straight: &[&[0, 1]],
    shape: |at| multilinear(ENDS, at),
    derivative: |at| multilinear_slopes(ENDS, at),
    quadrature: &INTERVAL_1,
    quadrature_revolved: &INTERVAL_2,
    gmsh: 1,
    gmsh_order: &[0, 1],
    vtk: 3,
    calculix: CalculixCell { number: 11, order: &[0, 1], points: &INTERVAL_2, layers: 1 },
    counts: LatticeCounts { nodes: 1.0, line: 1.0, connections: 2.0, neighbours: 3.0 },
};

/// Line3, the quadratic edge: N = (xi (xi - 1)/2, xi (xi + 1)/2, 1 - xi^2), ends first.
static LINE3: ReferenceElement = ReferenceElement {
    name: "Line3",
    form: Shape::Product,
    dimension: 1,
    nodes: &[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
    corners: 2,
    mid_sides: &[[0, 1]],
    faces: &[&[0], &[1]],
    straight: &[&[0, 2], &[2, 1]],
    shape: shape_of_line3,
    derivative: derivative_of_line3,
    quadrature: &INTERVAL_3,
    quadrature_revolved: &INTERVAL_3,
    gmsh: 8,
    gmsh_order: &[0, 1, 2],
    vtk: 21,
    calculix: CalculixCell { number: 12, order: &[0, 2, 1], points: &INTERVAL_3, layers: 1 },
    counts: LatticeCounts::NONE,
};

fn shape_of_line3([xi, ..]: [f64; 3]) -> PerNode<f64> {
    padded([xi * (xi - 1.0) / 2.0, xi * (xi + 1.0) / 2.0, (1.0 - xi) * (1.0 + xi)])
}

fn derivative_of_line3([xi, ..]: [f64; 3]) -> PerNode<[f64; 3]> {
    padded([xi - 0.5, xi + 0.5, -2.0 * xi].map(|slope| [slope, 0.0, 0.0]))
}

/// T3, the linear triangle: N = (1 - xi - eta, xi, eta); strain and stress are constant in the plane.
///
/// In a body of revolution it takes three points: with one point, a rotation about the centroid would have no strain
/// energy.
static T3: ReferenceElement = ReferenceElement {
    name: "T3",
    form: Shape::Simplex,
    dimension: 2,
    nodes: &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    corners: 3,
    mid_sides: &[],
    faces: &[&[0, 1], &[1, 2], &[2, 0]],
    straight: &[&[0, 1, 2]],
    shape: |at| linear(3, at),
    derivative: |_| linear_slopes(3),
    quadrature: &TRIANGLE_1,
    quadrature_revolved: &TRIANGLE_3,
    gmsh: 2,
    gmsh_order: &[0, 1, 2],
    vtk: 5,
    calculix: CalculixCell { number: 7, order: &[0, 1, 2], points: &TRIANGLE_1, layers: 2 },
    counts: LatticeCounts { nodes: 1.0, line: 1.0, connections: 6.0, neighbours: 7.0 },
};

/// The two corners of each of the 4 sides, in the order of the mid-side nodes.
const SIDES_OF_SQUARE: [[usize; 2]; 4] = [[0, 1], [1, 2], [2, 3], [3, 0]];

/// The corners, which are those of the bilinear quadrilateral too.
const SQUARE: [[f64; 3]; 4] = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];

/// Coordinates of the 4 corners, then of the 4 mid-side nodes.
const NODES_OF_Q8: [[f64; 3]; 8] = with_middles(SQUARE, SIDES_OF_SQUARE);

/// Q8, the serendipity quadrilateral, integrated with 3 x 3 Gauss points: N = (1 + xi_a xi)(1 + eta_a eta)(xi_a xi +
/// eta_a eta - 1)/4 at corners, (1 - xi^2)(1 + eta_a eta)/2 or (1 + xi_a xi)(1 - eta^2)/2 at the mid-sides.
static Q8: ReferenceElement = ReferenceElement {
    name: "Q8",
    form: Shape::Product,
    dimension: 2,
    nodes: &NODES_OF_Q8,
    corners: 4,
    mid_sides: &SIDES_OF_SQUARE,
    faces: &[&[0, 1, 4], &[1, 2, 5], &[2, 3, 6], &[3, 0, 7]],
    straight: &[&[0, 4, 7], &[4, 1, 5], &[5, 2, 6], &[6, 3, 7], &[4, 5, 6, 7]],
    shape: shape_of_q8,
    derivative: derivative_of_q8,
    quadrature: &SQUARE_3X3,
    quadrature_revolved: &SQUARE_3X3,
    gmsh: 16,
    gmsh_order: &[0, 1, 2, 3, 4, 5, 6, 7],
    vtk: 23,
    calculix: CalculixCell { number: 10, order: &[0, 1, 2, 3, 4, 5, 6, 7], points: &SQUARE_3X3, layers: 3 },
    counts: LatticeCounts { nodes: 3.0, line: 2.0, connections: 8.0, neighbours: 15.5 },
};

fn shape_of_q8([xi, eta, _]: [f64; 3]) -> PerNode<f64> {
    padded(NODES_OF_Q8.map(|[a, b, _]| {
        if a == 0.0 {
            (1.0 - xi) * (1.0 + xi) * (1.0 + b * eta) / 2.0
        } else if b == 0.0 {
            (1.0 + a * xi) * (1.0 - eta) * (1.0 + eta) / 2.0
        } else {
            (1.0 + a * xi) * (1.0 + b * eta) * (a * xi + b * eta - 1.0) / 4.0
        }
    }))
}

fn derivative_of_q8([xi, eta, _]: [f64; 3]) -> PerNode<[f64; 3]> {
    padded(NODES_OF_Q8.map(|[a, b, _]| {
        if a == 0.0 {
            [-xi * (1.0 + b * eta), b * (1.0 - xi) * (1.0 + xi) / 2.0, 0.0]
        } else if b == 0.0 {
            [a * (1.0 - eta) * (1.0 + eta) / 2.0, -eta * (1.0 + a * xi), 0.0]
        } else {
            let (along_xi, along_eta) = (2.0 * a * xi + b * eta, a * xi + 2.0 * b * eta);
            [a * (1.0 + b * eta) * along_xi / 4.0, b * (1.0 + a * xi) * along_eta / 4.0, 0.0]
        }
    }))
}

/// Q4, the bilinear quadrilateral: N_a = (1 + xi_a xi)(1 + eta_a eta)/4, integrated with 2 x 2 Gauss points.
static Q4: ReferenceElement = ReferenceElement {
    name: "Q4",
    form: Shape::Product,
    dimension: 2,
    nodes: &SQUARE,
    corners: 4,
    mid_sides: &[],
    faces: &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]],
    straight: &[&[0, 1, 2, 3]],
    shape: |at| multilinear(&SQUARE, at),
    derivative: |at| multilinear_slopes(&SQUARE, at),
    quadrature: &SQUARE_2X2,
    quadrature_revolved: &SQUARE_2X2,
    gmsh: 3,
    gmsh_order: &[0, 1, 2, 3],
    vtk: 9,
    calculix: CalculixCell { number: 9, order: &[0, 1, 2, 3], points: &SQUARE_2X2, layers: 2 },
    counts: LatticeCounts { nodes: 1.0, line: 1.0, connections: 4.0, neighbours: 9.0 },
};

/// The sides, each with the corners between which its mid-side node lies.
const SIDES_OF_TRIANGLE: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// T6, the quadratic triangle: N = L_a (2 L_a - 1) at corners, 4 L_a L_b at the mid-sides, L = (1 - xi - eta, xi, eta).
/// Its rule integrates the stiffness exactly if the sides are straight, in bodies of revolution too, except the hoop
/// terms.
static T6: ReferenceElement = ReferenceElement {
    name: "T6",
    form: Shape::Simplex,
    dimension: 2,
    nodes: &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 0.5, 0.0]],
    corners: 3,
    mid_sides: &SIDES_OF_TRIANGLE,
    faces: &[&[0, 1, 3], &[1, 2, 4], &[2, 0, 5]],
    straight: &[&[0, 3, 5], &[3, 1, 4], &[5, 4, 2], &[3, 4, 5]],
    shape: |at| quadratic(3, &SIDES_OF_TRIANGLE, at),
    derivative: |at| quadratic_slopes(3, &SIDES_OF_TRIANGLE, at),
    quadrature: &TRIANGLE_6,
    quadrature_revolved: &TRIANGLE_6,
    gmsh: 9,
    gmsh_order: &[0, 1, 2, 3, 4, 5],
    vtk: 22,
    calculix: CalculixCell { number: 8, order: &[0, 1, 2, 3, 4, 5], points: &TRIANGLE_3, layers: 3 },
    counts: LatticeCounts { nodes: 4.0, line: 2.0, connections: 12.0, neighbours: 11.5 },
};

/// The corners, which are those of the quadratic tetrahedron too.
const TETRAHEDRON: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Tet4, the linear tetrahedron: N = (1 - xi - eta - zeta, xi, eta, zeta); strain and stress are constant.
static TET4: ReferenceElement = ReferenceElement {
    name: "Tet4",
    form: Shape::Simplex,
    dimension: 3,
    nodes: &TETRAHEDRON,
    corners: 4,
    mid_sides: &[],
    faces: &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]],
    straight: &[],
    shape: |at| linear(4, at),
    derivative: |_| linear_slopes(4),
    quadrature: &TETRAHEDRON_1,
    quadrature_revolved: &TETRAHEDRON_1,
    gmsh: 4,
    gmsh_order: &[0, 1, 2, 3],
    vtk: 10,
    calculix: CalculixCell { number: 3, order: &[0, 1, 2, 3], points: &TETRAHEDRON_1, layers: 1 },
    counts: LatticeCounts { nodes: 1.0, line: 1.0, connections: 24.0, neighbours: 15.0 },
};

/// The two corners of each of the 6 edges, in the order of the mid-side nodes.
const EDGES_OF_TETRAHEDRON: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

const NODES_OF_TET10: [[f64; 3]; 10] = with_middles(TETRAHEDRON, EDGES_OF_TETRAHEDRON);

/// Tet10, the quadratic tetrahedron: N = L_a (2 L_a - 1) at corners, 4 L_a L_b at the mid-sides, L = (1 - xi - eta -
/// zeta, xi, eta, zeta). Its rule integrates a constant stress over curved edges exactly.
static TET10: ReferenceElement = ReferenceElement {
    name: "Tet10",
    form: Shape::Simplex,
    dimension: 3,
    nodes: &NODES_OF_TET10,
    corners: 4,
    mid_sides: &EDGES_OF_TETRAHEDRON,
    faces: &[&[0, 2, 1, 6, 5, 4], &[0, 1, 3, 4, 8, 7], &[1, 2, 3, 5, 9, 8], &[0, 3, 2, 7, 9, 6]],
    straight: &[],
    shape: |at| quadratic(4, &EDGES_OF_TETRAHEDRON, at),
    derivative: |at| quadratic_slopes(4, &EDGES_OF_TETRAHEDRON, at),
    quadrature: &TETRAHEDRON_8,
    quadrature_revolved: &TETRAHEDRON_8,
    gmsh: 11,
    gmsh_order: &[0, 1, 2, 3, 4, 5, 6, 7, 9, 8],
    vtk: 24,
    calculix: CalculixCell { number: 6, order: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9], points: &TETRAHEDRON_4, layers: 1 },
    counts: LatticeCounts { nodes: 8.0, line: 2.0, connections: 60.0, neighbours: 27.0 },
};

/// The two corners of each of the 12 edges, in the order of the mid-side nodes.
const EDGES_OF_CUBE: [[usize; 2]; 12] =
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

/// The corners, which are those of the trilinear hexahedron too.
const CUBE: [[f64; 3]; 8] = [
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
const NODES_OF_HEX20: [[f64; 3]; 20] = with_middles(CUBE, EDGES_OF_CUBE);

/// Hex20, the serendipity hexahedron, integrated with 3 x 3 x 3 Gauss points: with s = 1 + xi_a xi and so on, N = s_1
/// s_2 s_3 (xi_a xi + eta_a eta + zeta_a zeta - 2)/8 at corners, (1 - xi^2) s_2 s_3/4 and so on at the mid-sides.
static HEX20: ReferenceElement = ReferenceElement {
    name: "Hex20",
    form: Shape::Product,
    dimension: 3,
    nodes: &NODES_OF_HEX20,
    corners: 8,
    mid_sides: &EDGES_OF_CUBE,
    faces: &[
        &[0, 3, 2, 1, 11, 10, 9, 8],
        &[4, 5, 6, 7, 12, 13, 14, 15],
        &[0, 1, 5, 4, 8, 17, 12, 16],
        &[1, 2, 6, 5, 9, 18, 13, 17],
        &[2, 3, 7, 6, 10, 19, 14, 18],
        &[3, 0, 4, 7, 11, 16, 15, 19],
    ],
    straight: &[],
    shape: shape_of_hex20,
    derivative: derivative_of_hex20,
    quadrature: &CUBE_3X3X3,
    quadrature_revolved: &CUBE_3X3X3,
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

fn shape_of_hex20(at: [f64; 3]) -> PerNode<f64> {
    NODES_OF_HEX20.map(|node| {
        let s = [0, 1, 2].map(|axis| 1.0 + node[axis] * at[axis]);
        match middle(node) {
            Some(axis) => (1.0 - at[axis]) * (1.0 + at[axis]) * s[(axis + 1) % 3] * s[(axis + 2) % 3] / 4.0,
            None => s[0] * s[1] * s[2] * (s[0] + s[1] + s[2] - 5.0) / 8.0,
        }
    })
}

fn derivative_of_hex20(at: [f64; 3]) -> PerNode<[f64; 3]> {
    NODES_OF_HEX20.map(|node| {
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

/// Hex8, the trilinear hexahedron: N_a = (1 + xi_a xi)(1 + eta_a eta)(1 + zeta_a zeta)/8, 2 x 2 x 2 Gauss points.
static HEX8: ReferenceElement = ReferenceElement {
    name: "Hex8",
    form: Shape::Product,
    dimension: 3,
    nodes: &CUBE,
    corners: 8,
    mid_sides: &[],
    faces: &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]],
    straight: &[],
    shape: |at| multilinear(&CUBE, at),
    derivative: |at| multilinear_slopes(&CUBE, at),
    quadrature: &CUBE_2X2X2,
    quadrature_revolved: &CUBE_2X2X2,
    gmsh: 5,
    gmsh_order: &[0, 1, 2, 3, 4, 5, 6, 7],
    vtk: 12,
    calculix: CalculixCell { number: 1, order: &[0, 1, 2, 3, 4, 5, 6, 7], points: &CUBE_2X2X2, layers: 1 },
    counts: LatticeCounts { nodes: 1.0, line: 1.0, connections: 8.0, neighbours: 27.0 },
};
