//! The formulation of a model: the smallest space that contains its physics.

use std::f64::consts::TAU;

use crate::error::Error;
use signorini_linear as linear;

/// Checks that a setting is positive and finite; a subnormal number counts as zero.
pub fn positive(name: &'static str, value: f64) -> Result<(), Error> {
    match value.is_normal() && value > 0.0 {
        true => Ok(()),
        false => Err(linear::Error::Setting { name, value, allowed: "positive and finite" }.into()),
    }
}

/// The dimension of a model and the assumption for the directions that it leaves out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Formulation {
    /// A bar along x, with no stress across its axis.
    Bar {
        /// Cross-section, positive, in area.
        area: f64,
    },
    /// Plane strain: no strain across the plane, as in a long body.
    PlaneStrain {
        /// Depth of the long body across the plane, positive, in length.
        thickness: f64,
    },
    /// Plane stress: no stress across the plane, as in a thin body.
    PlaneStress {
        /// Depth of the thin body across the plane, positive, in length.
        thickness: f64,
    },
    /// A body of revolution about the y axis, x being the radius, `x >= 0`, without twist.
    ///
    /// Loads, forces, stiffness and areas are those of the full circle: integrals carry the factor `2 pi x`.
    Axisymmetric,
    /// A body in space, with no assumption.
    Space,
}

impl Formulation {
    /// Checks area or thickness.
    pub fn check(&self) -> Result<(), Error> {
        let (name, value) = match *self {
            Formulation::Bar { area } => ("area", area),
            Formulation::PlaneStrain { thickness } | Formulation::PlaneStress { thickness } => ("thickness", thickness),
            Formulation::Axisymmetric | Formulation::Space => return Ok(()),
        };
        positive(name, value)
    }

    /// The components of `[xx, yy, zz, xy, yz, zx]` in which there may be stress.
    #[doc(hidden)]
    pub fn stresses(&self) -> &'static [usize] {
        match self {
            Formulation::Bar { .. } => &[0],
            Formulation::PlaneStress { .. } => &[0, 1, 3],
            Formulation::PlaneStrain { .. } | Formulation::Axisymmetric => &[0, 1, 2, 3],
            Formulation::Space => &[0, 1, 2, 3, 4, 5],
        }
    }

    /// Number of coordinates of the model, and of dofs of each node.
    pub fn dimension(&self) -> usize {
        match self {
            Formulation::Bar { .. } => 1,
            Formulation::PlaneStrain { .. } | Formulation::PlaneStress { .. } | Formulation::Axisymmetric => 2,
            Formulation::Space => 3,
        }
    }

    /// In words, as `plane strain`.
    pub fn name(&self) -> &'static str {
        match self {
            Formulation::Bar { .. } => "a bar",
            Formulation::PlaneStrain { .. } => "plane strain",
            Formulation::PlaneStress { .. } => "plane stress",
            Formulation::Axisymmetric => "an axisymmetric body",
            Formulation::Space => "space",
        }
    }

    /// Returns `true` for the formulation of a body of revolution.
    pub fn is_axisymmetric(&self) -> bool {
        matches!(self, Formulation::Axisymmetric)
    }

    /// The cross-section, thickness, circumference `2 pi x`, or 1, by which a length, area or volume of the model is
    /// multiplied at the coordinate `x`.
    #[inline]
    pub fn measure(&self, x: f64) -> f64 {
        match *self {
            Formulation::Bar { area } => area,
            Formulation::PlaneStrain { thickness } | Formulation::PlaneStress { thickness } => thickness,
            Formulation::Axisymmetric => TAU * x,
            Formulation::Space => 1.0,
        }
    }

    /// The change of the [measure](Self::measure) with the coordinate x.
    #[doc(hidden)]
    pub fn measure_by_x(&self) -> f64 {
        if self.is_axisymmetric() { TAU } else { 0.0 }
    }

    /// Returns `true` if elements can lock near incompressibility. They cannot if the body is free to strain across the
    /// plane or the bar.
    pub fn can_lock(&self) -> bool {
        !matches!(self, Formulation::Bar { .. } | Formulation::PlaneStress { .. })
    }
}
