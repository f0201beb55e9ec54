//! The shape functions of simplices by the barycentric coordinates L, one for each corner: L itself on linear
//! simplices; on quadratic ones L_a (2 L_a - 1) at corners and 4 L_a L_b at the mid-sides.

use super::reference::{MAX_NODES, PerNode};

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
