//! Orthotropic elasticity: three planes of symmetry, eps = S sigma along the axes of the material.

use super::law::{Cylinder, Matrices, Matrix};
use crate::error::Error;
use crate::fem::dense::DenseMatrix;
use crate::fem::formulation::{Formulation, positive};
use crate::fem::geometry::{COORDINATES, Symmetric, cross, dot, length, turned, unit};
use signorini_linear as linear;

/// Axes that deviate by less than this, as a sine, deviate by rounding.
const SAME_DIRECTION: f64 = 1e-9;

/// The allowed determinant of Poisson's ratios.
const DEFINITE: &str = "such that the stiffness is positive definite";

/// Moduli and ratios along the axes of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Orthotropic {
    /// E1, E2, E3, in force per area.
    young: [f64; 3],
    /// nu12, nu23, nu13.
    poisson: [f64; 3],
    /// G12, G23, G13, in force per area.
    shear: [f64; 3],
    /// The axes of the material: unit vectors at right angles.
    axes: [[f64; 3]; 3],
    /// The line around which they turn instead.
    around: Option<Cylinder>,
}

impl Orthotropic {
    pub fn new(young: [f64; 3], poisson: [f64; 3], shear: [f64; 3]) -> Result<Self, Error> {
        let names = [
            ("orthotropic.young[0]", young[0]),
            ("orthotropic.young[1]", young[1]),
            ("orthotropic.young[2]", young[2]),
            ("orthotropic.shear[0]", shear[0]),
            ("orthotropic.shear[1]", shear[1]),
            ("orthotropic.shear[2]", shear[2]),
        ];
        names.into_iter().try_for_each(|(name, value)| positive(name, value))?;
        // The other ratio of each pair: nu_ji = nu_ij E_j / E_i.
        let [nu12, nu23, nu13] = poisson;
        let [nu21, nu32, nu31] = [nu12 * young[1] / young[0], nu23 * young[2] / young[1], nu13 * young[2] / young[0]];
        let pairs = [
            ("orthotropic.poisson[0]", nu12, nu21),
            ("orthotropic.poisson[1]", nu23, nu32),
            ("orthotropic.poisson[2]", nu13, nu31),
        ];
        let is_small = |one: f64, other: f64| one * other < 1.0;
        if let Some(&(name, value, _)) = pairs.iter().find(|&&(_, one, other)| !is_small(one, other)) {
            let allowed = "of a square below the ratio of the two Young's moduli, nu_ij^2 < E_i/E_j: the stiffness is not positive \
                           definite";
            return Err(linear::Error::Setting { name, value, allowed }.into());
        }
        let determinant = 1.0 - nu12 * nu21 - nu23 * nu32 - nu13 * nu31 - 2.0 * nu21 * nu32 * nu13;
        if determinant.is_nan() || determinant <= 0.0 {
            return Err(
                linear::Error::Setting { name: "orthotropic.poisson", value: determinant, allowed: DEFINITE }.into()
            );
        }
        Ok(Orthotropic { young, poisson, shear, axes: COORDINATES, around: None })
    }

    /// The same with its first axis along a vector, and its second one in the plane of both and at right angles to it.
    pub fn along(self, first: [f64; 3], second: [f64; 3]) -> Result<Self, Error> {
        let (first, second) = (unit(first), unit(second));
        let across = cross(first, second);
        let sine = length(across);
        if sine.is_nan() || sine <= SAME_DIRECTION {
            let allowed = "above 1e-9, which is the sine between the two axes: they must span a plane";
            return Err(linear::Error::Setting { name: "orthotropic.axes", value: sine, allowed }.into());
        }
        let third = unit(across);
        Ok(Orthotropic { axes: [first, cross(third, first), third], around: None, ..self })
    }

    /// The same with axes that turn around a line.
    pub fn around(self, line: Cylinder) -> Self {
        Orthotropic { axes: COORDINATES, around: Some(line), ..self }
    }

    pub fn young_range(&self) -> [f64; 2] {
        let range = |of: fn(f64, f64) -> f64| self.young.iter().copied().reduce(of).unwrap_or(f64::NAN);
        [range(f64::min), range(f64::max)]
    }

    /// Stiffness and compliance in a formulation.
    pub fn matrices(&self, formulation: &Formulation) -> Result<Matrices, Error> {
        let is_plane = !matches!(formulation, Formulation::Space | Formulation::Bar { .. });
        let third = self.around.map_or(self.axes[2], |line| line.along());
        let lean = dot(third, third) - third[2].powi(2);
        if is_plane && lean > SAME_DIRECTION * SAME_DIRECTION {
            let allowed = "zero, which is the square of the sine between the third axis and the normal of the plane";
            return Err(linear::Error::Setting { name: "orthotropic.axes", value: lean, allowed }.into());
        }
        let compliance = self.compliance();
        // The compliance of the components with stress is inverted if the other stresses vanish, the stiffness of the
        // rest if the strains do.
        let stressed = formulation.stresses();
        let strained = if let Formulation::PlaneStrain { .. } = formulation { &[0, 1, 3] } else { stressed };
        let stiffness = inverse(&compliance, stressed).ok_or_else(|| self.overflow())?;
        let compliance = inverse(&stiffness, strained).ok_or_else(|| self.overflow())?;
        Ok(Matrices { stiffness, compliance, around: self.around })
    }

    fn overflow(&self) -> Error {
        let allowed = "of a size that leaves the inverse of the stiffness finite";
        linear::Error::Setting { name: "orthotropic.young[0]", value: self.young[0], allowed }.into()
    }

    /// A tensor with these normal components along the axes of the material.
    pub fn tensor(&self, [first, second, third]: [f64; 3]) -> Symmetric {
        turned([first, second, third, 0.0, 0.0, 0.0], &self.back())
    }

    /// The coordinate axes along those of the material.
    fn back(&self) -> [[f64; 3]; 3] {
        [0, 1, 2].map(|i| self.axes.map(|axis| axis[i]))
    }

    /// The strain along z of a stress.
    pub fn strain_across(&self, stress: &Symmetric) -> f64 {
        self.compliance()[2].iter().zip(stress).map(|(entry, component)| entry * component).sum()
    }

    /// From stress to engineering strain, both along the coordinate axes.
    fn compliance(&self) -> Matrix {
        let ([e1, e2, e3], [nu12, nu23, nu13], [g12, g23, g13]) = (self.young, self.poisson, self.shear);
        let back = self.back();
        let mut compliance = [[0.0; 6]; 6];
        for column in 0..6 {
            let mut stress = [0.0; 6];
            stress[column] = 1.0;
            let [s1, s2, s3, s12, s23, s31] = turned(stress, &self.axes);
            // Tensor shear strains are half of the engineering ones.
            let own = [
                s1 / e1 - nu12 / e1 * s2 - nu13 / e1 * s3,
                s2 / e2 - nu12 / e1 * s1 - nu23 / e2 * s3,
                s3 / e3 - nu13 / e1 * s1 - nu23 / e2 * s2,
                s12 / (2.0 * g12),
                s23 / (2.0 * g23),
                s31 / (2.0 * g13),
            ];
            for (row, strain) in turned(own, &back).into_iter().enumerate() {
                compliance[row][column] = if row < 3 { strain } else { 2.0 * strain };
            }
        }
        compliance
    }
}

/// The inverse of a symmetric matrix in some components, symmetric, zero in the others; `None` if it is singular.
fn inverse(of: &Matrix, components: &[usize]) -> Option<Matrix> {
    let count = components.len();
    let own = DenseMatrix::from_fn(count, count, |i, j| of[components[i]][components[j]]);
    let inverse = own.solve(DenseMatrix::identity(count))?;
    if !inverse.columns().flatten().all(|entry| entry.is_finite()) {
        return None;
    }
    let mut all = [[0.0; 6]; 6];
    for (i, &row) in components.iter().enumerate() {
        for (j, &column) in components.iter().enumerate() {
            all[row][column] = (inverse[(i, j)] + inverse[(j, i)]) / 2.0;
        }
    }
    Some(all)
}
