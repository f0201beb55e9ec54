//! A point in an element: gradients, hoop terms, weight; the strain there.

use crate::fem::element::PerNode;
use crate::fem::geometry::Symmetric;

/// The shape functions at a point of an element with coordinates, in the unit of the cell.
#[derive(Clone, Copy, Debug)]
pub struct LocalPoint {
    /// Gradients, per unit.
    pub gradients: PerNode<[f64; 3]>,
    /// Shape function over radius, per unit: the hoop strain of a unit radial displacement. Zero except in bodies of
    /// revolution.
    pub hoop: PerNode<f64>,
    /// Number of nodes of the element.
    pub nodes: usize,
    /// Quadrature weight times determinant times area, thickness or circumference; the determinant in powers of the
    /// unit.
    pub weight: f64,
}

impl LocalPoint {
    /// The strain at the point of an element with the given `unit`, from the displacement of its nodes.
    #[inline]
    pub fn strain(&self, displacement: &PerNode<[f64; 3]>, unit: f64) -> Symmetric {
        let slope = self.slope(displacement);
        let hoop = (1..self.nodes)
            .fold(self.hoop[0] * displacement[0][0], |sum, node| sum + self.hoop[node] * displacement[node][0]);
        let shear = |i: usize, j: usize| (slope[i][j] + slope[j][i]) / 2.0;
        [slope[0][0], slope[1][1], slope[2][2] + hoop, shear(0, 1), shear(1, 2), shear(2, 0)]
            .map(|component| component / unit)
    }

    /// The rotation at the point about x, y and z, in radians if it is small.
    pub fn rotation(&self, displacement: &PerNode<[f64; 3]>, unit: f64) -> [f64; 3] {
        let slope = self.slope(displacement);
        [(1, 2), (2, 0), (0, 1)].map(|(i, j)| (slope[j][i] - slope[i][j]) / (2.0 * unit))
    }

    /// The derivative of each component of the displacement along each axis, per unit.
    #[inline]
    pub fn slope(&self, displacement: &PerNode<[f64; 3]>) -> [[f64; 3]; 3] {
        let mut slope = [[0.0; 3]; 3];
        for node in 1..self.nodes {
            // Relative to the first node: a translation then gives exactly zero strain.
            for (axis, row) in slope.iter_mut().enumerate() {
                let relative = displacement[node][axis] - displacement[0][axis];
                for (entry, gradient) in row.iter_mut().zip(&self.gradients[node]) {
                    *entry += relative * gradient;
                }
            }
        }
        slope
    }
}
