//! The law of stress and strain in a formulation: sigma = lambda tr(eps) I + 2 mu eps, or sigma = C eps; axes around a
//! line.

use crate::fem::formulation::Formulation;
use crate::fem::geometry::{Symmetric, across, cross, dot, length, minus, trace, turned, unit};

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
    pub(crate) fn nothing(&self) -> Self {
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
        let radial = [0, 1, 2].map(|axis| away[axis] - height * self.along[axis]);
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
