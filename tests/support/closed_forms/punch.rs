//! Rigid punches on an elastic half space, in terms of the contact modulus E* = E/(1-nu^2).
//!
//! In the plane the approach is not compared, because it depends on the whole body.

use std::f64::consts::PI;

/// A flat strip of half width a: `p = P/(pi sqrt(a^2 - x^2))`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatStrip {
    /// Half width a.
    pub half_width: f64,
}

impl FlatStrip {
    /// The pressure at |x| < a under the force P per length.
    pub fn pressure(&self, force: f64, x: f64) -> f64 {
        force / (PI * (self.half_width * self.half_width - x * x).sqrt())
    }
}

/// A flat disc of radius a: `p = P/(2 pi a sqrt(a^2 - r^2))`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatDisc {
    /// Radius a.
    pub radius: f64,
    /// Contact modulus E* of the half space under the disc, in force per area.
    pub modulus: f64,
}

impl FlatDisc {
    /// The pressure at r < a under the force P.
    pub fn pressure(&self, force: f64, r: f64) -> f64 {
        force / (2.0 * PI * self.radius * (self.radius * self.radius - r * r).sqrt())
    }

    /// The force of the approach delta, `P = 2 a E* delta`.
    pub fn force(&self, approach: f64) -> f64 {
        2.0 * self.radius * self.modulus * approach
    }
}

/// A wedge whose flanks rise with slope t: `p = (E* t/pi) arccosh(a/|x|)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wedge {
    /// Slope t of the flanks.
    pub slope: f64,
    /// Contact modulus E* of the half space under the wedge, in force per area.
    pub modulus: f64,
}

impl Wedge {
    /// Half the width of the contact under the force P per length: `P = E* a t`.
    pub fn half_width(&self, force: f64) -> f64 {
        force / (self.modulus * self.slope)
    }

    /// The pressure at x under the force P per length; 0 beyond the contact.
    pub fn pressure(&self, force: f64, x: f64) -> f64 {
        self.modulus * self.slope / PI * (self.half_width(force) / x.abs()).max(1.0).acosh()
    }
}

/// A cone whose flank rises with slope t: `p = (E* t/2) arccosh(a/r)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Slope t of the flank.
    pub slope: f64,
    /// Contact modulus E* of the half space under the cone, in force per area.
    pub modulus: f64,
}

impl Cone {
    /// The radius of the contact under the force P: `P = pi a^2 E* t/2`.
    pub fn contact_radius(&self, force: f64) -> f64 {
        (2.0 * force / (PI * self.modulus * self.slope)).sqrt()
    }

    /// The force of the approach `delta = pi a t/2`.
    pub fn force(&self, approach: f64) -> f64 {
        let radius = 2.0 * approach / (PI * self.slope);
        PI * radius * radius * self.modulus * self.slope / 2.0
    }

    /// The pressure at the radius r under the force P; 0 beyond the contact.
    pub fn pressure(&self, force: f64, r: f64) -> f64 {
        self.modulus * self.slope / 2.0 * (self.contact_radius(force) / r).max(1.0).acosh()
    }
}
