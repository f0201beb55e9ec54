//! One element in place: x = sum N_a x_a, K = t sum_q B'D B det(J) w, eps = B u.

use nalgebra::{Matrix2, Matrix3, Matrix3x2, SMatrix, Vector2, Vector3};

use super::{MAX_NODES, PerNode, ReferenceElement};

/// The stiffness of one element, order `[x_0, y_0, x_1, y_1, ...]`; rows and columns beyond its nodes are zero.
pub type ElementMatrix = SMatrix<f64, { 2 * MAX_NODES }, { 2 * MAX_NODES }>;

/// The Jacobian of an element that is turned inside out or has no area.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the Jacobian determinant is {value:e} at its local node or quadrature point {point}; it must be positive")]
pub struct NonPositiveJacobian {
    /// The smallest determinant, relative to the square of the element's size.
    pub value: f64,
    /// Where: local nodes first, then quadrature points, from 0.
    pub point: usize,
}

/// Determinants below this, relative to the square of the element's size, are rounding: the element has no area.
const NO_AREA: f64 = 1e-14;

/// An element with its coordinates.
///
/// The coordinates are kept relative to the first node and in a unit that is the power of two next to the element's
/// size: the stiffness of a plane element does not depend on its size, and no size overflows on the way to it.
#[derive(Clone, Debug)]
pub struct Cell {
    reference: &'static ReferenceElement,
    coordinates: PerNode<[f64; 2]>,
    unit: f64,
}

/// The map from the reference cell at one point: shape function gradients and determinant, in the unit of the cell.
struct Mapping {
    gradients: PerNode<[f64; 2]>,
    determinant: f64,
}

impl Cell {
    /// The element of kind `reference` at `coordinates` (x, y of its nodes, counterclockwise).
    pub fn new(reference: &'static ReferenceElement, coordinates: PerNode<[f64; 2]>) -> Self {
        let nodes = reference.nodes.len();
        let mut relative = [[0.0; 2]; MAX_NODES];
        let mut size: f64 = 0.0;
        for (node, at) in relative.iter_mut().enumerate().take(nodes) {
            *at = [0, 1].map(|axis| coordinates[node][axis] - coordinates[0][axis]);
            size = size.max(at[0].abs()).max(at[1].abs());
        }
        // The exponent bits alone are the power of two at or below the size.
        let power = f64::from_bits(size.to_bits() & (0x7ff << 52));
        let unit = if power.is_normal() { power } else { 1.0 };
        Cell { reference, coordinates: relative.map(|at| at.map(|value| value / unit)), unit }
    }

    /// Checks that the determinant of the Jacobian is positive at the nodes and the quadrature points.
    ///
    /// # Errors
    /// [`NonPositiveJacobian`] with the worst place.
    pub fn check(&self) -> Result<(), NonPositiveJacobian> {
        let at_nodes = self.reference.nodes.iter().copied();
        let points = at_nodes.chain(self.reference.quadrature.iter().map(|point| point.at));
        let worst = points
            .map(|at| self.map(at).determinant)
            .enumerate()
            .map(|(point, value)| NonPositiveJacobian { value, point })
            .min_by(|a, b| a.value.total_cmp(&b.value));
        match worst {
            // A determinant that is not a number is not positive either.
            Some(worst) if worst.value.is_nan() || worst.value <= NO_AREA => Err(worst),
            _ => Ok(()),
        }
    }

    /// The stiffness `t sum_q B'D B det(J) w` for the constitutive matrix D and the thickness t, in force per length.
    pub fn stiffness(&self, constitutive: &Matrix3<f64>, thickness: f64) -> ElementMatrix {
        let nodes = self.reference.nodes.len();
        let mut stiffness = ElementMatrix::zeros();
        for point in self.reference.quadrature {
            let map = self.map(point.at);
            let weight = map.determinant * point.weight * thickness;
            for b in 0..nodes {
                let stress = constitutive * strain_matrix(map.gradients[b]) * weight;
                for a in b..nodes {
                    let block = strain_matrix(map.gradients[a]).transpose() * stress;
                    for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                        stiffness[(2 * a + i, 2 * b + j)] += block[(i, j)];
                    }
                }
            }
        }
        // One triangle was summed; the other is its mirror, to the last bit.
        stiffness.fill_upper_triangle_with_lower_triangle();
        stiffness
    }

    /// The strain `(eps_xx, eps_yy, gamma_xy)` at a reference point, from the displacement of the nodes.
    pub fn strain(&self, at: [f64; 2], displacement: &PerNode<[f64; 2]>) -> Vector3<f64> {
        let map = self.map(at);
        let mut strain = Vector3::zeros();
        for node in 1..self.reference.nodes.len() {
            // Relative to the first node: a translation strains nothing, to the last bit.
            let relative = [0, 1].map(|axis| displacement[node][axis] - displacement[0][axis]);
            strain += strain_matrix(map.gradients[node]) * Vector2::from(relative);
        }
        strain / self.unit
    }

    /// The nodal forces `t sum_q B' stress det(J) w` that the stress in the element asks for; the stress is
    /// `(sigma_xx, sigma_yy, sigma_xy)` at each quadrature point.
    pub fn internal_force(&self, stress: impl Fn([f64; 2]) -> Vector3<f64>, thickness: f64) -> PerNode<[f64; 2]> {
        let mut force = [[0.0; 2]; MAX_NODES];
        for point in self.reference.quadrature {
            let map = self.map(point.at);
            let weighted = stress(point.at) * (map.determinant * point.weight * thickness * self.unit);
            for (gradient, of_node) in map.gradients.iter().zip(&mut force).take(self.reference.nodes.len()) {
                let share = strain_matrix(*gradient).transpose() * weighted;
                of_node[0] += share.x;
                of_node[1] += share.y;
            }
        }
        force
    }

    /// The integral of each shape function over the element, in area.
    pub fn shape_integrals(&self) -> PerNode<f64> {
        let mut integrals = [0.0; MAX_NODES];
        for point in self.reference.quadrature {
            let weight = self.map(point.at).determinant * point.weight * self.unit * self.unit;
            let shape = (self.reference.shape)(point.at);
            for (integral, value) in integrals.iter_mut().zip(shape) {
                *integral += weight * value;
            }
        }
        integrals
    }

    fn map(&self, at: [f64; 2]) -> Mapping {
        let derivative = (self.reference.derivative)(at);
        let mut jacobian = Matrix2::zeros();
        for (slope, x) in derivative.iter().zip(&self.coordinates) {
            jacobian += Vector2::from(*slope) * Vector2::from(*x).transpose();
        }
        let determinant = jacobian[(0, 0)] * jacobian[(1, 1)] - jacobian[(0, 1)] * jacobian[(1, 0)];
        let gradients = derivative.map(|[xi, eta]| {
            let x = jacobian[(1, 1)] * xi - jacobian[(0, 1)] * eta;
            let y = jacobian[(0, 0)] * eta - jacobian[(1, 0)] * xi;
            [x / determinant, y / determinant]
        });
        Mapping { gradients, determinant }
    }
}

/// The columns of B that belong to one node: (eps_xx, eps_yy, gamma_xy) from (u_x, u_y).
fn strain_matrix([x, y]: [f64; 2]) -> Matrix3x2<f64> {
    Matrix3x2::new(x, 0.0, 0.0, y, y, x)
}

/// The integral of each shape function along a straight edge of two nodes, in length: one half of it each.
pub fn edge_integrals(start: [f64; 2], end: [f64; 2]) -> [f64; 2] {
    let length = (end[0] - start[0]).hypot(end[1] - start[1]);
    [length / 2.0; 2]
}
