//! A point in an element: gradients, hoop terms, weight; the strain of a displacement there; how elements are
//! integrated.

use crate::element::{InverseMap, PerNode, TabulatedPoint};
use crate::geometry::{Symmetric, dot};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
pub struct Displaced {
    /// `[i][k]`: the derivative of component i along axis k.
    pub slope: [[f64; 3]; 3],
    /// Radial displacement over radius; zero except in bodies of revolution.
    pub hoop: f64,
    /// As that of a [`LocalPoint`].
    pub weight: f64,
    pub inverse: InverseMap,
    /// The unit of the cell over the radius; zero except in bodies of revolution.
    pub per_radius: f64,
}

impl Displaced {
    #[inline]
    pub fn strain(&self) -> Symmetric {
        let slope = &self.slope;
        let shear = |i: usize, j: usize| (slope[i][j] + slope[j][i]) / 2.0;
        [slope[0][0], slope[1][1], slope[2][2] + self.hoop, shear(0, 1), shear(1, 2), shear(2, 0)]
    }

    /// Adds the force of `stress` on each of some nodes, in powers of the unit of the cell.
    #[inline]
    pub fn add_forces(&self, at: &TabulatedPoint, stress: &Symmetric, forces: &mut [[f64; 3]]) {
        let InverseMap { cofactors, determinant } = self.inverse;
        let per_length = self.weight / determinant;
        let [xx, yy, zz, xy, yz, zx] = *stress;
        let on_cofactors = |row: [f64; 3]| cofactors.map(|column| per_length * dot(row, column));
        let along = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]].map(on_cofactors);
        let hoop = self.weight * zz * self.per_radius;
        for ((force, slope), share) in forces.iter_mut().zip(&at.derivative).zip(&at.shape) {
            force.iter_mut().zip(along).for_each(|(force, along)| *force += dot(along, *slope));
            force[0] += hoop * share;
        }
    }

    /// The rotation at the point about x, y and z, in radians if it is small.
    pub fn rotation(&self) -> [f64; 3] {
        [(1, 2), (2, 0), (0, 1)].map(|(i, j)| (self.slope[j][i] - self.slope[i][j]) / 2.0)
    }
}

/// The integration of the stiffness of an element: in full, or with a dilatation that cannot lock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "IntegrationSpec")]
#[serde(rename_all = "kebab-case")]
pub enum Integration {
    /// The full strain at all quadrature points.
    #[default]
    Standard,
    /// The dilatation is replaced by its mean over the element: for `q4` and `hex8`, which then do not lock if
    /// Poisson's ratio is near 0.5.
    MeanDilatation,
}
