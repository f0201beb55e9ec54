//! Hertz contacts of a rigid paraboloid on an elastic half space, in terms of the contact modulus E* = E/(1-nu^2).

use std::f64::consts::PI;

/// A rigid cylinder of radius R on an elastic half space: `p = p0 sqrt(1 - x^2/a^2)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineContact {
    /// Contact modulus E*, in force per area: E/(1-nu^2) in plane strain, E in plane stress.
    pub modulus: f64,
    /// Radius R of the cylinder.
    pub radius: f64,
}

impl LineContact {
    /// Half the width of the contact under the force F per length: `a^2 = 4 F R/(pi E*)`.
    pub fn half_width(&self, force: f64) -> f64 {
        (4.0 * force * self.radius / (PI * self.modulus)).sqrt()
    }

    /// The largest pressure under the force F per length: `p0 = a E*/(2 R)`.
    pub fn peak_pressure(&self, force: f64) -> f64 {
        self.half_width(force) * self.modulus / (2.0 * self.radius)
    }

    /// The pressure at x under the force F per length, `p0 sqrt(1 - x^2/a^2)`.
    pub fn pressure(&self, force: f64, x: f64) -> f64 {
        self.peak_pressure(force) * (1.0 - (x / self.half_width(force)).powi(2)).max(0.0).sqrt()
    }
}

/// A rigid sphere of radius R on an elastic half space: `p = p0 sqrt(1 - r^2/a^2)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointContact {
    /// Contact modulus E* = E/(1-nu^2), in force per area.
    pub modulus: f64,
    /// Radius R of the sphere.
    pub radius: f64,
}

impl PointContact {
    /// The force of the approach delta: `F = 4/3 E* sqrt(R) delta^1.5`.
    pub fn force(&self, approach: f64) -> f64 {
        4.0 / 3.0 * self.modulus * self.radius.sqrt() * approach.powf(1.5)
    }

    /// The radius of the contact under the force F: `a^3 = 3 F R/(4 E*)`.
    pub fn contact_radius(&self, force: f64) -> f64 {
        (3.0 * force * self.radius / (4.0 * self.modulus)).cbrt()
    }

    /// The largest pressure under the force F: `p0 = 2 E* a/(pi R)`.
    pub fn peak_pressure(&self, force: f64) -> f64 {
        2.0 * self.modulus * self.contact_radius(force) / (PI * self.radius)
    }

    /// The pressure at the radius r under the force F, `p0 sqrt(1 - r^2/a^2)`.
    pub fn pressure(&self, force: f64, r: f64) -> f64 {
        self.peak_pressure(force) * (1.0 - (r / self.contact_radius(force)).powi(2)).max(0.0).sqrt()
    }
}
