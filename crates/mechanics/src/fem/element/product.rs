//! The multilinear shape functions of Line2, Q4 and Hex8: N_a = (1 + xi_a xi)(1 + eta_a eta)(1 + zeta_a zeta) over the
//! number of corners; the coordinates beyond the dimension are zero.

use super::reference::{MAX_NODES, PerNode};

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
