//! A point in an element: gradients, hoop terms, weight; the strain of a displacement there.

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
    /// Quadrature weight times determinant times area, thickness or circumference; the determinant in powers of the
    /// unit.
    pub weight: f64,
}

/// The deformation at a point of a displaced element.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Displaced {
    /// `[i][k]`: the derivative of component i along axis k.
    pub slope: [[f64; 3]; 3],
    /// Radial displacement over radius; zero except in bodies of revolution.
    pub hoop: f64,
    /// As that of a [`LocalPoint`].
    pub weight: f64,
}

impl Displaced {
    /// The strain at the point.
    #[inline]
    pub fn strain(&self) -> Symmetric {
        let slope = &self.slope;
        let shear = |i: usize, j: usize| (slope[i][j] + slope[j][i]) / 2.0;
        [slope[0][0], slope[1][1], slope[2][2] + self.hoop, shear(0, 1), shear(1, 2), shear(2, 0)]
    }

    /// The rotation at the point about x, y and z, in radians if it is small.
    pub fn rotation(&self) -> [f64; 3] {
        [(1, 2), (2, 0), (0, 1)].map(|(i, j)| (self.slope[j][i] - self.slope[i][j]) / 2.0)
    }
}
