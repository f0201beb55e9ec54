//! Other units for data at the ends of double precision: powers of two, so that only the range changes.

use crate::error::Error;
use crate::linear::{SymmetricMatrix, exponent, largest, ldexp};
use crate::problem::ContactProblem;
use crate::solution::{Cancellation, Certificate};

/// Forces and energies beyond 2 to plus or minus this power are near the ends of double precision.
const FAR: i32 = 800;

/// A displacement below 2 to this power of what the load could do is negligible beside it, and sets no unit.
const NOTHING: i32 = -200;

/// Units of stiffness and of length, as exponents of two.
#[derive(Clone, Copy, Debug)]
pub(super) struct UnitExponents {
    pub stiffness: i32,
    pub length: i32,
}

impl UnitExponents {
    pub fn displacement(&self, displacement: &[f64]) -> Vec<f64> {
        displacement.iter().map(|&value| ldexp(value, -self.length)).collect()
    }

    pub fn force(&self, force: &[f64]) -> Vec<f64> {
        force.iter().map(|&value| ldexp(value, -self.stiffness - self.length)).collect()
    }

    /// A certificate that was computed in these units, in those of the problem.
    pub fn in_own(&self, certificate: Certificate) -> Certificate {
        // An energy norm has the unit of sqrt(stiffness) times length.
        let norm = |value: f64| ldexp_root(value, self.stiffness, self.length);
        let force = |value: f64| ldexp(value, self.stiffness + self.length);
        let Cancellation { dof, forces, left } = certificate.cancellation;
        Certificate {
            energy_error: norm(certificate.energy_error),
            cancellation: Cancellation { dof, forces: force(forces), left: force(left) },
            ..certificate
        }
    }
}

/// `2^length sqrt(2^stiffness) x`
pub fn ldexp_root(x: f64, stiffness: i32, length: i32) -> f64 {
    let root = if stiffness % 2 == 0 { 1.0 } else { std::f64::consts::SQRT_2 };
    ldexp(root * x, stiffness.div_euclid(2) + length)
}

/// The units in which an answer is of order one, if forces or energies would over- or underflow in its own units.
pub fn far_units(problem: &ContactProblem, displacement: &[f64]) -> Option<UnitExponents> {
    let stiffness = exponent(largest(&problem.diagonal().values));
    let (moved, load) = (largest(displacement), largest(&problem.load));
    let statics = exponent(load) - stiffness;
    let length = match (moved > 0.0, load > 0.0) {
        (true, true) => exponent(moved).max(statics + NOTHING),
        (true, false) => exponent(moved),
        (false, _) => statics,
    };
    let is_far = |power: i32| power.abs() > FAR;
    // A force, of the power stiffness + length, is far only if the stiffness or an energy is.
    let far = is_far(stiffness) || is_far(length) || is_far(stiffness + 2 * length);
    far.then_some(UnitExponents { stiffness, length })
}

pub fn in_units(problem: &ContactProblem, units: &UnitExponents) -> Result<ContactProblem, Error> {
    let lower = problem.stiffness.lower();
    let values = lower.values().iter().map(|&value| ldexp(value, -units.stiffness)).collect();
    let stiffness = SymmetricMatrix::from_lower(lower.with_values(values))?;
    ContactProblem::computed(
        stiffness,
        units.force(&problem.load),
        problem.contact.clone(),
        units.displacement(&problem.gap),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_that_is_1e20_in_other_units_stays_a_gap() {
        let problem = ContactProblem::of_entries(&[(0, 0, 1.0)], &[1.0], &[(0, 0, 1.0)], &[ldexp(1e20, 900)]);
        assert_eq!(in_units(&problem, &UnitExponents { stiffness: 0, length: 900 }).unwrap().gap(), [1e20]);
    }
}
