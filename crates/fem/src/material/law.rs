//! The law of stress and strain in a formulation: sigma = lambda tr(eps) I + 2 mu eps, or sigma = C eps; axes around a
//! line.

use crate::dense::DenseMatrix;
use crate::error::Error;
use crate::formulation::{Formulation, positive};
use crate::geometry::{COORDINATES, Symmetric, across, cross, dot, length, minus, shifted, trace, turned, unit};
use signorini_linear as linear;

/// A matrix between components `[xx, yy, zz, xy, yz, zx]` of stress and of engineering strain.
pub type Matrix = [[f64; 6]; 6];

/// The Lamé constants of a material in a formulation, in force per area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lame {
    /// lambda, which multiplies the trace of the strains of the formulation.
    pub lambda: f64,
    /// mu, the shear modulus; half of Young's modulus in a bar, which has no shear.
    pub mu: f64,
}

/// The stiffness of a material in a formulation.
#[derive(Clone, Debug, PartialEq)]
pub enum Stiffness {
    /// Of an isotropic material.
    Isotropic(Lame),
    /// Of any other material.
    General(Box<Matrices>),
}

/// A stiffness without symmetries, and its inverse.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrices {
    /// From engineering strain to stress, in force per area: zero for components that the formulation leaves out.
    pub stiffness: Matrix,
    /// From stress to engineering strain, for the components whose strain the formulation has; zero elsewhere.
    pub compliance: Matrix,
    /// The line around which the axes of both turn; `None` for x, y and z.
    pub around: Option<Cylinder>,
}

impl Matrices {
    /// The axes of the matrices at a place, if they turn.
    #[inline]
    pub fn axes(&self, place: impl Fn() -> [f64; 3]) -> Option<[[f64; 3]; 3]> {
        self.around.map(|line| line.axes_or_any(place()))
    }
}

/// The law of a material in a formulation.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    pub stiffness: Stiffness,
    formulation: Formulation,
}

impl Law {
    pub(super) fn new(stiffness: Stiffness, formulation: Formulation) -> Self {
        Law { stiffness, formulation }
    }

    /// The stress of a strain at a place. In an isotropic material `dilatation` replaces the trace; it may be a mean
    /// over the element.
    #[inline]
    pub fn stress(&self, strain: &Symmetric, dilatation: f64, place: impl Fn() -> [f64; 3]) -> Symmetric {
        let axes = self.axes(place);
        back(self.local_stress(&local(strain, &axes), dilatation), &axes)
    }

    /// The axes of the law at a place; `None` for x, y and z.
    #[inline]
    pub fn axes(&self, place: impl Fn() -> [f64; 3]) -> Option<[[f64; 3]; 3]> {
        match &self.stiffness {
            Stiffness::Isotropic(_) => None,
            Stiffness::General(matrices) => matrices.axes(place),
        }
    }

    /// The law without any stress.
    pub fn nothing(&self) -> Self {
        let stiffness = Stiffness::Isotropic(Lame { lambda: 0.0, mu: 0.0 });
        match &self.stiffness {
            Stiffness::Isotropic(_) => Law { stiffness, ..self.clone() },
            // The axes of stresses without strain stay.
            Stiffness::General(matrices) => {
                let none = Matrices { stiffness: [[0.0; 6]; 6], ..(**matrices).clone() };
                Law { stiffness: Stiffness::General(Box::new(none)), ..self.clone() }
            }
        }
    }

    /// The law of other constants.
    pub(super) fn with_lame(&self, lame: Lame) -> Self {
        Law { stiffness: Stiffness::Isotropic(lame), ..self.clone() }
    }

    /// The formulation in which the law holds.
    pub(super) fn formulation(&self) -> &Formulation {
        &self.formulation
    }

    /// Returns `true` if the axes of the law are others at other places.
    pub fn turns(&self) -> bool {
        matches!(&self.stiffness, Stiffness::General(matrices) if matrices.around.is_some())
    }

    /// The stress of a strain, both along the axes of the law.
    #[inline]
    fn local_stress(&self, strain: &Symmetric, dilatation: f64) -> Symmetric {
        match &self.stiffness {
            Stiffness::Isotropic(Lame { lambda, mu }) => {
                let mut stress = strain.map(|component| 2.0 * mu * component);
                stress[..3].iter_mut().for_each(|normal| *normal += lambda * dilatation);
                if let Formulation::PlaneStress { .. } = self.formulation {
                    stress[2] = 0.0;
                }
                stress
            }
            Stiffness::General(matrices) => product(&matrices.stiffness, &engineering(strain)),
        }
    }

    /// The stress that suppresses a free strain, both along the axes of the law: minus the stress of that strain,
    /// without the components that the formulation leaves free.
    pub fn holding(&self, free: &Symmetric) -> Symmetric {
        let mut held = [0.0; 6];
        self.formulation.stresses().iter().for_each(|&component| held[component] = free[component]);
        self.local_stress(&held, trace(&held)).map(|component| -component)
    }

    /// `sigma : C^-1 : sigma` at a place, twice the density of the complementary energy, of the components whose strain
    /// the formulation has.
    pub fn complementary_energy(&self, stress: &Symmetric, place: impl Fn() -> [f64; 3]) -> f64 {
        let stress = local(stress, &self.axes(place));
        self.local_strain(&stress).iter().zip(stress).map(|(strain, stress)| strain * stress).sum()
    }

    /// The strain `C^-1 sigma` of a stress at a place, of the components that the formulation has.
    pub fn strain(&self, stress: &Symmetric, place: impl Fn() -> [f64; 3]) -> Symmetric {
        let axes = self.axes(place);
        let [xx, yy, zz, xy, yz, zx] = self.local_strain(&local(stress, &axes));
        back([xx, yy, zz, xy / 2.0, yz / 2.0, zx / 2.0], &axes)
    }

    /// The engineering strain of a stress, both along the axes of the law.
    ///
    /// In an isotropic material the strain is (s - lambda/(2 mu + n lambda) tr s I)/(2 mu), with n normal components.
    fn local_strain(&self, stress: &Symmetric) -> Symmetric {
        let &Lame { lambda, mu } = match &self.stiffness {
            Stiffness::Isotropic(lame) => lame,
            Stiffness::General(matrices) => return product(&matrices.compliance, stress),
        };
        let normals = match self.formulation {
            Formulation::Bar { .. } => 1,
            Formulation::PlaneStrain { .. } | Formulation::PlaneStress { .. } => 2,
            Formulation::Axisymmetric | Formulation::Space => 3,
        };
        let trace: f64 = stress[..normals].iter().sum();
        let across = lambda / (2.0 * mu + normals as f64 * lambda) * trace;
        let mut strain = stress.map(|component| component / mu);
        strain[..normals].iter_mut().zip(stress).for_each(|(strain, own)| *strain = (own - across) / (2.0 * mu));
        strain[normals..3].fill(0.0);
        strain
    }

    /// The stiffness against a strain along one direction alone, which gives the speed of pressure waves; in an
    /// orthotropic material the largest along a coordinate axis.
    pub fn wave_modulus(&self) -> f64 {
        match &self.stiffness {
            Stiffness::Isotropic(lame) => lame.lambda + 2.0 * lame.mu,
            Stiffness::General(matrices) => (0..3).map(|axis| matrices.stiffness[axis][axis]).fold(0.0, f64::max),
        }
    }
}

/// A tensor along axes.
#[inline]
pub fn local(tensor: &Symmetric, axes: &Option<[[f64; 3]; 3]>) -> Symmetric {
    axes.as_ref().map_or(*tensor, |axes| turned(*tensor, axes))
}

/// A tensor along x, y and z, from one along axes.
#[inline]
pub fn back(tensor: Symmetric, axes: &Option<[[f64; 3]; 3]>) -> Symmetric {
    axes.as_ref().map_or(tensor, |axes| turned(tensor, &[0, 1, 2].map(|i| axes.map(|axis| axis[i]))))
}

/// Engineering strains: twice the shear components of the tensor.
#[inline]
pub fn engineering([xx, yy, zz, xy, yz, zx]: &Symmetric) -> Symmetric {
    [*xx, *yy, *zz, 2.0 * xy, 2.0 * yz, 2.0 * zx]
}

#[inline]
fn product(matrix: &Matrix, vector: &Symmetric) -> Symmetric {
    matrix.map(|row| row.iter().zip(vector).map(|(entry, component)| entry * component).sum())
}

/// Distances from the line below this share of the distance from its point are rounding.
const ON_LINE: f64 = 1e-9;

/// A line through a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    point: [f64; 3],
    /// The direction of the line, of length 1.
    along: [f64; 3],
}

impl Cylinder {
    /// The line along a vector of any length; `None` for a vector without a length.
    pub fn new(point: [f64; 3], along: [f64; 3]) -> Option<Self> {
        let along = unit(along);
        (length(along) > 0.0).then_some(Cylinder { point, along })
    }

    /// The direction of the line, of unit length.
    pub fn along(&self) -> [f64; 3] {
        self.along
    }

    /// A point of the line.
    pub fn point(&self) -> [f64; 3] {
        self.point
    }

    /// The axes at a place, of unit length; `None` on the line, where no direction leads away from it.
    pub fn axes(&self, place: [f64; 3]) -> Option<[[f64; 3]; 3]> {
        let away = minus(place, self.point);
        let height = dot(away, self.along);
        let radial = shifted(away, -height, self.along);
        (length(radial) > ON_LINE * length(away)).then(|| self.with_first(unit(radial)))
    }

    /// The axes at a place; on the line any of those at right angles to it.
    pub fn axes_or_any(&self, place: [f64; 3]) -> [[f64; 3]; 3] {
        self.axes(place).unwrap_or_else(|| self.with_first(across(self.along)))
    }

    fn with_first(&self, first: [f64; 3]) -> [[f64; 3]; 3] {
        [first, cross(self.along, first), self.along]
    }
}

// Orthotropic elasticity: three planes of symmetry, eps = S sigma along the axes of the material.

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
