//! Homogeneous isotropic linear elasticity in the plane: sigma = D eps.

use nalgebra::{Matrix3, Vector3};

use crate::error::Error;

/// What happens across the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaneState {
    /// No strain across the plane: a long body.
    PlaneStrain,
    /// No stress across the plane: a thin body.
    PlaneStress,
}

/// An isotropic linear elastic material in a plane state, checked once, when it is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    young: f64,
    poisson: f64,
    state: PlaneState,
}

impl Material {
    /// Young's modulus (force per area), Poisson's ratio, plane state.
    ///
    /// # Errors
    /// [`Error::Setting`] for a modulus that is not positive and finite, or a ratio outside -1 < nu < 0.5 (plane
    /// strain) or -1 < nu <= 0.5 (plane stress).
    pub fn new(young: f64, poisson: f64, state: PlaneState) -> Result<Self, Error> {
        if !(young.is_normal() && young > 0.0) {
            return Err(Error::Setting { name: "young", value: young, allowed: "positive and finite" });
        }
        let (fits, allowed) = match state {
            PlaneState::PlaneStrain => (poisson > -1.0 && poisson < 0.5, "above -1 and below 0.5 in plane strain"),
            PlaneState::PlaneStress => (poisson > -1.0 && poisson <= 0.5, "above -1 and at most 0.5 in plane stress"),
        };
        if !fits {
            return Err(Error::Setting { name: "poisson", value: poisson, allowed });
        }
        Ok(Material { young, poisson, state })
    }

    /// Young's modulus E.
    pub fn young(&self) -> f64 {
        self.young
    }

    /// Poisson's ratio nu.
    pub fn poisson(&self) -> f64 {
        self.poisson
    }

    /// The plane state.
    pub fn state(&self) -> PlaneState {
        self.state
    }

    /// The constitutive matrix D: (sigma_xx, sigma_yy, sigma_xy) = D (eps_xx, eps_yy, gamma_xy).
    pub fn constitutive(&self) -> Matrix3<f64> {
        let nu = self.poisson;
        let shear = self.young / (1.0 + nu) / 2.0;
        let (along, across) = match self.state {
            PlaneState::PlaneStrain => {
                let factor = self.young / (1.0 + nu) / (1.0 - 2.0 * nu);
                (factor * (1.0 - nu), factor * nu)
            }
            PlaneState::PlaneStress => {
                let factor = self.young / ((1.0 - nu) * (1.0 + nu));
                (factor, factor * nu)
            }
        };
        Matrix3::new(along, across, 0.0, across, along, 0.0, 0.0, 0.0, shear)
    }

    /// The stress sigma_zz across the plane: nu (sigma_xx + sigma_yy) in plane strain, 0 in plane stress.
    pub fn out_of_plane_stress(&self, stress: &Vector3<f64>) -> f64 {
        match self.state {
            PlaneState::PlaneStrain => self.poisson * (stress.x + stress.y),
            PlaneState::PlaneStress => 0.0,
        }
    }
}
