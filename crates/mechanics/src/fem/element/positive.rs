//! Shape functions of quadratic faces with positive integrals, so that a uniform pressure pushes at every node.
//!
//! On a quadratic face the integral of a corner's shape function is zero (T6) or negative (Q8): a uniform pressure
//! pulls at the corners. With `N'_corner = N_corner + w (sum of N_mid around it)`, `N'_mid = (1 - 2 w) N_mid` and w =
//! 1/4 all integrals are positive: 1/6 of a triangle each; 1/12 of a quadrilateral at corners and 1/6 at mid-sides. On
//! edges and on triangles these are the Bernstein polynomials, which are nowhere negative; inside quadrilaterals their
//! minimum is -0.04. They span the same space, so that nothing is lost: the value at a mid-side node is
//! `u_mid = (1 - 2 w) c_mid + w (c_a + c_b)`; the value at a corner is its coefficient.
//!
//! # Source
//! A. Popp, B. I. Wohlmuth, M. W. Gee, W. A. Wall, *Dual quadratic mortar finite element methods for 3D finite
//! deformation contact*, SIAM J. Sci. Comput. 34 (2012) B421-B446: the change of basis, with another weight.

use super::reference::{PerNode, ReferenceElement};

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
