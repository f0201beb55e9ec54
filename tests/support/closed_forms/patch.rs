//! The contact patch test.

/// Boundary conditions on the sides of the block of the contact patch test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// Free sides in plane strain: no strain across the plane.
    PlaneStrain,
    /// Free sides in plane stress: no stress across the plane.
    PlaneStress,
    /// Sides that cannot move outwards: only the vertical strain is not zero.
    Confined,
}

/// The contact patch test: a block on a frictionless plane below, uniformly compressed from above along y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPatch {
    /// Young's modulus E.
    pub young: f64,
    /// Poisson's ratio nu.
    pub poisson: f64,
    /// Boundary conditions on the sides.
    pub sides: Sides,
}

impl ContactPatch {
    /// The modulus E' in `eps_yy = -p/E'`: E/(1-nu^2), E, or E(1-nu)/((1+nu)(1-2nu)).
    pub fn modulus(&self) -> f64 {
        let (e, nu) = (self.young, self.poisson);
        match self.sides {
            Sides::PlaneStrain => e / (1.0 - nu * nu),
            Sides::PlaneStress => e,
            Sides::Confined => e * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        }
    }

    /// The strains (eps_xx, eps_yy) under a pressure p `>= 0`.
    pub fn strains(&self, pressure: f64) -> (f64, f64) {
        let (e, nu) = (self.young, self.poisson);
        let across = match self.sides {
            Sides::PlaneStrain => nu * (1.0 + nu) * pressure / e,
            Sides::PlaneStress => nu * pressure / e,
            Sides::Confined => 0.0,
        };
        (across, -pressure / self.modulus())
    }

    /// The pressure if the top of a block of `height` is pressed down by `displacement` and the plane starts at the
    /// distance `gap` below the block: `p = max(0, E' (d - g)/H)`.
    pub fn pressure(&self, height: f64, displacement: f64, gap: f64) -> f64 {
        (self.modulus() * (displacement - gap) / height).max(0.0)
    }
}
