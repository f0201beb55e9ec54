//! The shape functions of simplices by the barycentric coordinates L, one for each corner: L itself on linear
//! simplices; on quadratic ones L_a (2 L_a - 1) at corners and 4 L_a L_b at the mid-sides.

use super::reference::{MAX_NODES, PerNode, ReferenceElement};
use super::{QuadraturePoint, Shape, quadrature};
use crate::dense::DenseMatrix;

/// The coordinates L at a reference point; a simplex in the plane has the first three.
fn barycentric([xi, eta, zeta]: [f64; 3]) -> [f64; 4] {
    [1.0 - xi - eta - zeta, xi, eta, zeta]
}

/// The slope of a coordinate L of a simplex with this number of corners; zero beyond its dimension.
fn slope(corners: usize, corner: usize) -> [f64; 3] {
    let along = |axis: usize| if corner == 0 { -1.0 } else { f64::from(u8::from(corner == axis + 1)) };
    [0, 1, 2].map(|axis| if axis + 1 < corners { along(axis) } else { 0.0 })
}

/// The values of the linear functions.
pub(super) fn linear(corners: usize, at: [f64; 3]) -> PerNode<f64> {
    let mut values = [0.0; MAX_NODES];
    values[..corners].copy_from_slice(&barycentric(at)[..corners]);
    values
}

/// The derivatives of the linear functions, which are constant.
pub(super) fn linear_slopes(corners: usize) -> PerNode<[f64; 3]> {
    std::array::from_fn(|corner| if corner < corners { slope(corners, corner) } else { [0.0; 3] })
}

/// The values of the quadratic functions; a mid-side node lies between the two corners of each edge.
pub(super) fn quadratic(corners: usize, edges: &[[usize; 2]], at: [f64; 3]) -> PerNode<f64> {
    let l = barycentric(at);
    let mut values = [0.0; MAX_NODES];
    for corner in 0..corners {
        values[corner] = l[corner] * (2.0 * l[corner] - 1.0);
    }
    for (value, &[a, b]) in values[corners..].iter_mut().zip(edges) {
        *value = 4.0 * l[a] * l[b];
    }
    values
}

/// The derivatives of the quadratic functions.
pub(super) fn quadratic_slopes(corners: usize, edges: &[[usize; 2]], at: [f64; 3]) -> PerNode<[f64; 3]> {
    let (l, linear) = (barycentric(at), linear_slopes(corners));
    let mut slopes = [[0.0; 3]; MAX_NODES];
    for corner in 0..corners {
        slopes[corner] = linear[corner].map(|slope| (4.0 * l[corner] - 1.0) * slope);
    }
    for (slope, &[a, b]) in slopes[corners..].iter_mut().zip(edges) {
        *slope = [0, 1, 2].map(|axis| 4.0 * (linear[a][axis] * l[b] + l[a] * linear[b][axis]));
    }
    slopes
}

// The multilinear shape functions of Line2, Q4 and Hex8: N_a = (1 + xi_a xi)(1 + eta_a eta)(1 + zeta_a zeta) over the
// number of corners; the coordinates beyond the dimension are zero.

/// The values at a reference point.
pub(super) fn multilinear(corners: &[[f64; 3]], at: [f64; 3]) -> PerNode<f64> {
    let mut values = [0.0; MAX_NODES];
    for (value, corner) in values.iter_mut().zip(corners) {
        *value = (0..3).map(|axis| 1.0 + corner[axis] * at[axis]).product::<f64>() / corners.len() as f64;
    }
    values
}

/// The derivatives at a reference point.
pub(super) fn multilinear_slopes(corners: &[[f64; 3]], at: [f64; 3]) -> PerNode<[f64; 3]> {
    let mut slopes = [[0.0; 3]; MAX_NODES];
    for (slope, corner) in slopes.iter_mut().zip(corners) {
        *slope = [0, 1, 2].map(|by| {
            let factor = |axis: usize| if axis == by { corner[axis] } else { 1.0 + corner[axis] * at[axis] };
            (0..3).map(factor).product::<f64>() / corners.len() as f64
        });
    }
    slopes
}

// Shape functions of quadratic faces with positive integrals, so that a uniform pressure pushes at every node.
//
// On a quadratic face the integral of a corner's shape function is zero (T6) or negative (Q8): a uniform pressure
// pulls at the corners. With `N'_corner = N_corner + w (sum of N_mid around it)`, `N'_mid = (1 - 2 w) N_mid` and w =
// 1/4 all integrals are positive: 1/6 of a triangle each; 1/12 of a quadrilateral at corners and 1/6 at mid-sides. On
// edges and on triangles these are the Bernstein polynomials, which are nowhere negative; inside quadrilaterals their
// minimum is -0.04. They span the same space, so that nothing is lost: the value at a mid-side node is
// `u_mid = (1 - 2 w) c_mid + w (c_a + c_b)`; the value at a corner is its coefficient.
//
// # Source
// A. Popp, B. I. Wohlmuth, M. W. Gee, W. A. Wall, *Dual quadratic mortar finite element methods for 3D finite
// deformation contact*, SIAM J. Sci. Comput. 34 (2012) B421-B446: the change of basis, with another weight.

/// The share w that each end of an edge takes of the function of its mid-side node. Measured on quadrilaterals: 3/8,
/// with which no function is negative anywhere, has up to 1.8 times the error in energy.
pub const POSITIVE_SHARE: f64 = 0.25;

/// Turns the values of the shape functions of a face into those of the positive functions, at the mid-side nodes that
/// have one, by their local number.
pub fn positive_functions(face: &ReferenceElement, has: impl Fn(usize) -> bool, values: &mut PerNode<f64>) {
    for (side, corners) in face.mid_sides.iter().enumerate() {
        let middle = face.corners + side;
        if has(middle) {
            let value = values[middle];
            corners.iter().for_each(|&corner| values[corner] += POSITIVE_SHARE * value);
            values[middle] = (1.0 - 2.0 * POSITIVE_SHARE) * value;
        }
    }
}

/// The coefficient of a mid-side node from the values there and at the ends of its edge.
pub fn positive_coefficient(middle: f64, ends: [f64; 2]) -> f64 {
    (middle - POSITIVE_SHARE * (ends[0] + ends[1])) / (1.0 - 2.0 * POSITIVE_SHARE)
}

/// The shape functions at one reference point.
#[derive(Clone, Copy, Debug)]
pub struct TabulatedPoint {
    /// Quadrature weight; zero if the point belongs to no rule.
    pub weight: f64,
    pub shape: PerNode<f64>,
    /// Derivatives with respect to the reference coordinates.
    pub derivative: PerNode<[f64; 3]>,
}

impl TabulatedPoint {
    pub fn new(reference: &ReferenceElement, at: [f64; 3], weight: f64) -> Self {
        TabulatedPoint { weight, shape: (reference.shape)(at), derivative: (reference.derivative)(at) }
    }
}

/// The quadrature of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuadratureRule {
    /// The rule for bars, plane models and space.
    Straight,
    /// The rule for bodies of revolution: the radius adds one degree.
    Revolved,
}

/// The shape functions of an element at the points of a quadrature rule, at its nodes and its centroid.
#[derive(Clone, Debug)]
pub struct Tabulated {
    /// The element whose shape functions are tabulated.
    pub reference: &'static ReferenceElement,
    /// At the quadrature points.
    pub points: Vec<TabulatedPoint>,
    pub nodes: Vec<TabulatedPoint>,
    /// At the centroid, with the weight of the whole element.
    pub centroid: TabulatedPoint,
    rule: Vec<QuadraturePoint>,
}

impl Tabulated {
    /// Tabulates `reference` at the points of its quadrature.
    pub fn new(reference: &'static ReferenceElement, rule: QuadratureRule) -> Self {
        let rule = match rule {
            QuadratureRule::Straight => reference.quadrature,
            QuadratureRule::Revolved => reference.quadrature_revolved,
        };
        Self::with_rule(reference, rule.to_vec())
    }

    /// Tabulates `reference` at five points in each direction, for functions that are not polynomials of the element.
    pub fn fine(reference: &'static ReferenceElement) -> Self {
        Self::with_rule(reference, quadrature::fine(reference.form, reference.dimension))
    }

    /// Tabulates `reference` at the points of a quadrature rule for it.
    pub fn with_rule(reference: &'static ReferenceElement, rule: Vec<QuadraturePoint>) -> Self {
        let at = |at: [f64; 3], weight| TabulatedPoint::new(reference, at, weight);
        Tabulated {
            reference,
            points: rule.iter().map(|point| at(point.at, point.weight)).collect(),
            nodes: reference.nodes.iter().map(|&node| at(node, 0.0)).collect(),
            centroid: at(reference.centroid(), rule.iter().map(|point| point.weight).sum()),
            rule,
        }
    }

    /// The weights that carry values at the quadrature points to the nodes, n_nodes x n_points: the least-squares fit
    /// of a linear function (multilinear on a product of intervals; a constant if there is only one point).
    pub fn extrapolation(&self) -> DenseMatrix {
        let basis = |at: [f64; 3]| -> Vec<f64> {
            let dimension = self.reference.dimension;
            match self.reference.form {
                _ if self.rule.len() <= dimension => vec![1.0],
                Shape::Simplex => [1.0].into_iter().chain(at.into_iter().take(dimension)).collect(),
                Shape::Product => (0..1_usize << dimension)
                    .map(|choice| (0..dimension).filter(|axis| choice >> axis & 1 == 1).map(|axis| at[axis]).product())
                    .collect(),
            }
        };
        let rows = |points: Vec<[f64; 3]>| {
            let rows: Vec<Vec<f64>> = points.into_iter().map(basis).collect();
            DenseMatrix::from_fn(rows.len(), rows.first().map_or(0, Vec::len), |i, j| rows[i][j])
        };
        let at_points = rows(self.rule.iter().map(|point| point.at).collect());
        let at_nodes = rows(self.reference.nodes.to_vec());
        let (points, fit) = (self.rule.len(), at_points.singular_values());
        let of_point = |point: usize| {
            let mut one = vec![0.0; points];
            one[point] = 1.0;
            at_nodes.mul(&fit.solve(&one, f64::EPSILON))
        };
        let weights: Vec<Vec<f64>> = (0..points).map(of_point).collect();
        DenseMatrix::from_fn(self.reference.nodes.len(), points, |node, point| weights[point][node])
    }
}
