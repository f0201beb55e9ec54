//! Homogeneous linear elasticity: materials, isotropic or orthotropic, with density and thermal expansion.

mod law;

use super::formulation::{Formulation, positive};
use super::geometry::Symmetric;
use crate::error::Error;
use law::Orthotropic;
pub use law::{Cylinder, Lame, Law, Matrices, Matrix, Stiffness, back, engineering, local};
use signorini_linear as linear;

/// A linear elastic material, checked once, when it is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    elasticity: Elasticity,
    density: Option<f64>,
    /// Along x, y and z, or along the axes of the material.
    expansion: Option<[f64; 3]>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Elasticity {
    Isotropic { young: f64, poisson: f64 },
    Orthotropic(Orthotropic),
}

impl Material {
    /// The isotropic material of Young's modulus (force per area) and Poisson's ratio.
    ///
    /// # Errors
    /// [`linear::Error::Setting`] for a modulus that is not positive and finite, or a ratio outside -1 < nu <= 0.5.
    pub fn new(young: f64, poisson: f64) -> Result<Self, Error> {
        positive("young", young)?;
        if !(poisson > -1.0 && poisson <= 0.5) {
            return Err(linear::Error::Setting {
                name: "poisson",
                value: poisson,
                allowed: "above -1 and at most 0.5",
            }
            .into());
        }
        Ok(Material { elasticity: Elasticity::Isotropic { young, poisson }, density: None, expansion: None })
    }

    /// The orthotropic material of Young's moduli `[E1, E2, E3]` (force per area), Poisson's ratios
    /// `[nu12, nu23, nu13]` and shear moduli `[G12, G23, G13]` (force per area) along the coordinate axes.
    ///
    /// Tension along i contracts the material along j by nu_ij times its extension, and `nu_ij / E_i = nu_ji / E_j`.
    pub fn orthotropic(young: [f64; 3], poisson: [f64; 3], shear: [f64; 3]) -> Result<Self, Error> {
        let elasticity = Elasticity::Orthotropic(Orthotropic::new(young, poisson, shear)?);
        Ok(Material { elasticity, density: None, expansion: None })
    }

    /// The same material with its first axis along a vector, and its second one in the plane of both vectors and at
    /// right angles to the first. The vectors have the order [x, y, z], no unit, and any length but zero. An isotropic
    /// material has no axes, and stays as it is.
    pub fn along(self, first: [f64; 3], second: [f64; 3]) -> Result<Self, Error> {
        let elasticity = match self.elasticity {
            Elasticity::Orthotropic(own) => Elasticity::Orthotropic(own.along(first, second)?),
            isotropic => isotropic,
        };
        Ok(Material { elasticity, ..self })
    }

    /// The same material with axes that turn around a line: axis 1 leads away from it, 2 around it, 3 along it. `point`
    /// [x, y, z] is on the line, in length, and `along` a vector of any length but zero. An isotropic material has no
    /// axes, and stays as it is.
    pub fn around(self, point: [f64; 3], along: [f64; 3]) -> Result<Self, Error> {
        let (name, allowed) = ("orthotropic.around", "finite, with a direction that has a length");
        if let Some(&value) = point.iter().chain(&along).find(|part| !part.is_finite()) {
            return Err(linear::Error::Setting { name, value, allowed }.into());
        }
        let line = Cylinder::new(point, along).ok_or(linear::Error::Setting { name, value: 0.0, allowed })?;
        let elasticity = match self.elasticity {
            Elasticity::Orthotropic(own) => Elasticity::Orthotropic(own.around(line)),
            isotropic => isotropic,
        };
        Ok(Material { elasticity, ..self })
    }

    /// The same material with a density (mass per volume), which motions and inertia forces need.
    pub fn with_density(self, density: f64) -> Result<Self, Error> {
        positive("density", density)?;
        Ok(Material { density: Some(density), ..self })
    }

    /// The same material with three coefficients of thermal expansion, in strain per degree, along its axes, for an
    /// isotropic material along x, y and z; temperatures need them.
    pub fn with_expansion(self, along: [f64; 3]) -> Result<Self, Error> {
        match along.iter().find(|value| !value.is_finite()) {
            Some(&value) => Err(linear::Error::Setting { name: "expansion", value, allowed: "finite" }.into()),
            None => Ok(Material { expansion: Some(along), ..self }),
        }
    }

    /// The strain of a body that is one degree warmer, if the material has coefficients of expansion; along its axes if
    /// these turn around a line.
    #[doc(hidden)]
    pub fn expansion(&self) -> Option<Symmetric> {
        let along = self.expansion?;
        Some(match &self.elasticity {
            Elasticity::Isotropic { .. } => [along[0], along[1], along[2], 0.0, 0.0, 0.0],
            Elasticity::Orthotropic(own) => own.tensor(along),
        })
    }

    /// The density, in mass per volume, if there is one.
    pub fn density(&self) -> Option<f64> {
        self.density
    }

    /// The smallest and the largest Young's modulus, in this order, in force per area; they are equal in an isotropic
    /// material.
    pub fn young(&self) -> [f64; 2] {
        match &self.elasticity {
            Elasticity::Isotropic { young, .. } => [*young; 2],
            Elasticity::Orthotropic(own) => own.young_range(),
        }
    }

    /// Poisson's ratio of an isotropic material.
    pub fn poisson(&self) -> Option<f64> {
        match self.elasticity {
            Elasticity::Isotropic { poisson, .. } => Some(poisson),
            Elasticity::Orthotropic(_) => None,
        }
    }

    /// The strain along z of a stress `[xx, yy, zz, xy, yz, zx]`; of one along its axes if these turn around a line
    /// along z.
    pub(crate) fn strain_across(&self, stress: &Symmetric) -> f64 {
        match &self.elasticity {
            Elasticity::Isotropic { young, poisson } => (stress[2] - poisson * (stress[0] + stress[1])) / young,
            Elasticity::Orthotropic(own) => own.strain_across(stress),
        }
    }

    /// The law of stress and strain in `formulation`.
    ///
    /// # Errors
    /// [`linear::Error::Setting`] for nu = 0.5 if the formulation would preserve the volume: plane strain, axisymmetric
    /// bodies and space; for orthotropic axes out of the plane of a plane model; for an orthotropic stiffness that
    /// overflows.
    pub fn law(&self, formulation: &Formulation) -> Result<Law, Error> {
        let stiffness = match &self.elasticity {
            &Elasticity::Isotropic { young, poisson } => Stiffness::Isotropic(lame(young, poisson, formulation)?),
            Elasticity::Orthotropic(own) => Stiffness::General(Box::new(own.matrices(formulation)?)),
        };
        Ok(Law::new(stiffness, *formulation))
    }
}

/// The laws that are the derivatives of the law of an isotropic material; `None` for an orthotropic one.
impl Material {
    /// With respect to Young's modulus, to which all stresses are proportional.
    pub(crate) fn by_young(&self, law: &Law) -> Option<Law> {
        let Elasticity::Isotropic { young, .. } = self.elasticity else { return None };
        let Stiffness::Isotropic(Lame { lambda, mu }) = law.stiffness else { return None };
        Some(law.with_lame(Lame { lambda: lambda / young, mu: mu / young }))
    }

    /// With respect to Poisson's ratio.
    pub(crate) fn by_poisson(&self, law: &Law) -> Option<Law> {
        let Elasticity::Isotropic { young, poisson: nu } = self.elasticity else { return None };
        let of_shear = -young / (1.0 + nu).powi(2) / 2.0;
        let lame = match law.formulation() {
            Formulation::Bar { .. } => Lame { lambda: 0.0, mu: 0.0 },
            Formulation::PlaneStress { .. } => {
                let square = ((1.0 - nu) * (1.0 + nu)).powi(2);
                Lame { lambda: young * (1.0 + nu * nu) / square, mu: of_shear }
            }
            Formulation::PlaneStrain { .. } | Formulation::Axisymmetric | Formulation::Space => {
                let square = ((1.0 + nu) * (1.0 - 2.0 * nu)).powi(2);
                Lame { lambda: young * (1.0 + 2.0 * nu * nu) / square, mu: of_shear }
            }
        };
        Some(law.with_lame(lame))
    }
}

/// The Lamé constants in `formulation`.
///
/// In plane stress lambda is E nu/(1 - nu^2), for the trace of the strains in the plane; in a bar lambda is 0 and mu is
/// E/2, so that sigma = E eps.
fn lame(young: f64, nu: f64, formulation: &Formulation) -> Result<Lame, Error> {
    let mu = young / (1.0 + nu) / 2.0;
    let volumetric = |allowed| match nu < 0.5 {
        true => Ok(Lame { lambda: young * nu / (1.0 + nu) / (1.0 - 2.0 * nu), mu }),
        false => Err(linear::Error::Setting { name: "poisson", value: nu, allowed }.into()),
    };
    match formulation {
        Formulation::Bar { .. } => Ok(Lame { lambda: 0.0, mu: young / 2.0 }),
        Formulation::PlaneStress { .. } => Ok(Lame { lambda: young * nu / ((1.0 - nu) * (1.0 + nu)), mu }),
        Formulation::PlaneStrain { .. } => volumetric("above -1 and below 0.5 in plane strain"),
        Formulation::Axisymmetric => volumetric("above -1 and below 0.5 in an axisymmetric body"),
        Formulation::Space => volumetric("above -1 and below 0.5 in space"),
    }
}
