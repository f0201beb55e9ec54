//! Homogeneous isotropic linear elasticity: sigma = lambda tr(eps) I + 2 mu eps.

use crate::error::Error;
use crate::fem::formulation::Formulation;

/// An isotropic linear elastic material, checked once, when it is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    young: f64,
    poisson: f64,
    density: Option<f64>,
}

/// The Lamé constants of a material in a formulation, in force per area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lame {
    /// lambda, for the trace of the strains that the formulation has.
    pub lambda: f64,
    /// mu, the shear modulus; half of Young's modulus in a bar, which has no shear.
    pub mu: f64,
}

impl Material {
    /// Young's modulus (force per area), Poisson's ratio.
    ///
    /// # Errors
    /// [`Error::Setting`] for a modulus that is not positive and finite, or a ratio outside -1 < nu <= 0.5.
    pub fn new(young: f64, poisson: f64) -> Result<Self, Error> {
        if !(young.is_normal() && young > 0.0) {
            return Err(Error::Setting { name: "young", value: young, allowed: "positive and finite" });
        }
        if !(poisson > -1.0 && poisson <= 0.5) {
            return Err(Error::Setting { name: "poisson", value: poisson, allowed: "above -1 and at most 0.5" });
        }
        Ok(Material { young, poisson, density: None })
    }

    /// The same material with a density (mass per volume), which motions and forces of inertia ask for.
    ///
    /// # Errors
    /// [`Error::Setting`] for a density that is not positive and finite.
    pub fn with_density(self, density: f64) -> Result<Self, Error> {
        if !(density.is_normal() && density > 0.0) {
            return Err(Error::Setting { name: "density", value: density, allowed: "positive and finite" });
        }
        Ok(Material { density: Some(density), ..self })
    }

    /// The density, in mass per volume, where there is one.
    pub fn density(&self) -> Option<f64> {
        self.density
    }

    /// Young's modulus E.
    pub fn young(&self) -> f64 {
        self.young
    }

    /// Poisson's ratio nu.
    pub fn poisson(&self) -> f64 {
        self.poisson
    }

    /// The Lamé constants in `formulation`.
    ///
    /// In plane stress lambda is E nu/(1 - nu^2), for the trace of the strains in the plane; in a bar lambda is 0 and
    /// mu is E/2, so that sigma = E eps.
    ///
    /// # Errors
    /// [`Error::Setting`] for nu = 0.5 where the volume would be kept: in plane strain, axisymmetric bodies and space.
    pub fn lame(&self, formulation: &Formulation) -> Result<Lame, Error> {
        let (young, nu) = (self.young, self.poisson);
        let mu = young / (1.0 + nu) / 2.0;
        let volumetric = |allowed| match nu < 0.5 {
            true => Ok(Lame { lambda: young * nu / (1.0 + nu) / (1.0 - 2.0 * nu), mu }),
            false => Err(Error::Setting { name: "poisson", value: nu, allowed }),
        };
        match formulation {
            Formulation::Bar { .. } => Ok(Lame { lambda: 0.0, mu: young / 2.0 }),
            Formulation::PlaneStress { .. } => Ok(Lame { lambda: young * nu / ((1.0 - nu) * (1.0 + nu)), mu }),
            Formulation::PlaneStrain { .. } => volumetric("above -1 and below 0.5 in plane strain"),
            Formulation::Axisymmetric => volumetric("above -1 and below 0.5 in an axisymmetric body"),
            Formulation::Space => volumetric("above -1 and below 0.5 in space"),
        }
    }
}
