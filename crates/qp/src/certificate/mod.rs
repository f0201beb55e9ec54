//! The certificate of an answer, recomputed from the problem by code that shares nothing with the methods.
//!
//! It recomputes the conditions of the solution, a bound on the error in energy, and the rows proven open or closed.
//! For a problem without a unique answer it recomputes the modes that nothing holds.

mod bound;
mod conditions;
mod energy_norm;
mod mode;
mod proof;
mod reach;
mod scales;

pub(crate) use bound::boundary::repaired;
pub(crate) use conditions::{Bounding, Evidence, Examined, at_rest, with_rounding};
pub(crate) use energy_norm::{EnergyNorm, norm_on_equalities};
pub(crate) use mode::{NullMode, Rounding, mode_along, motion_along, not_convex_along};

use std::borrow::Cow;

use conditions::{energy_of, examined};
use energy_norm::ldexp_root;
use proof::{proven_by_cycles, proven_in, proven_pressed};

use crate::error::Result;
use crate::linear::{SymmetricMatrix, exponent, largest, ldexp};
use crate::problem::{ContactProblem, Equality};
use crate::solution::{Cancellation, Certificate, ProvenSet};

/// Forces and energies beyond 2 to plus or minus this power are near the ends of double precision.
const FAR: i32 = 800;

/// A displacement below 2 to this power of what the load could do is negligible beside it, and sets no unit.
const NOTHING: i32 = -200;

/// An answer (u, lambda) of a problem, to be examined by these means.
pub struct Examination<'a> {
    problem: &'a ContactProblem,
    displacement: &'a [f64],
    /// Of all rows.
    multiplier: Cow<'a, [f64]>,
    by: &'a Bounding<'a>,
}

impl<'a> Examination<'a> {
    pub fn of(problem: &'a ContactProblem, answer: [&'a [f64]; 2], by: &'a Bounding<'a>) -> Result<Self> {
        let (displacement, multiplier) = (answer[0], problem.of_all_rows(answer[1]));
        problem.check_answer(displacement, &multiplier)?;
        // A hierarchy of one level is a factor already, of so few dofs that another one costs nothing.
        let is_factor = matches!(by, Bounding::Cycles(multigrid, _) if multigrid.unknowns().len() <= 1);
        Ok(Examination { problem, displacement, multiplier, by: if is_factor { &Bounding::OwnFactor } else { by } })
    }

    pub fn certificate(&self) -> Result<Examined> {
        let (u, lambda) = (self.displacement, &*self.multiplier);
        let mut found = match self.in_far_units()? {
            None => examined(self.problem, self.by, [u, lambda])?,
            Some((units, problem, by)) => {
                let found = examined(&problem, &by, [&units.displacement(u), &units.force(lambda)])?;
                Examined { certificate: units.in_own(found.certificate), evidence: None, ..found }
            }
        };
        if let Bounding::Pieces(pieces) = self.by {
            found.certificate = found.certificate.with_bounds_of(pieces, &energy_of(self.problem, u));
        }
        Ok(found)
    }

    /// The rows that the answer proves open or closed, by the evidence of its certificate if any; `None` if K is not
    /// positive definite by itself, except for travels that forces drive against rows, and if no bound is known.
    pub fn proof(&self, evidence: Option<Evidence>) -> Result<Option<ProvenSet>> {
        let mut proven = self.proven(evidence)?;
        // The rows of equalities are closed in every answer.
        for Equality { row, opposed, .. } in self.problem.equalities() {
            proven.iter_mut().for_each(|proven| [row, opposed].into_iter().for_each(|&row| proven.closed.insert(row)));
        }
        Ok(proven)
    }

    fn proven(&self, mut evidence: Option<Evidence>) -> Result<Option<ProvenSet>> {
        let (problem, answer, far) = (self.problem, [self.displacement, &*self.multiplier], self.in_far_units()?);
        let norm = match self.by {
            Bounding::Nothing | Bounding::Pieces(_) => None,
            Bounding::Cycles(multigrid, watch) => {
                return Ok(evidence.and_then(|evidence| proven_by_cycles(problem, multigrid, watch, answer, evidence)));
            }
            Bounding::Factor(norm) => Some(norm.clone()),
            Bounding::OwnFactor => match evidence.as_mut().and_then(|evidence| evidence.norm.take()) {
                None if problem.without_stiffness().is_empty() => EnergyNorm::of(&problem.stiffness, &problem.contact)?,
                None if far.is_none() => {
                    let found = if evidence.is_some() { evidence } else { self.certificate()?.evidence };
                    return Ok(found.map(|found| proven_pressed(problem, answer, found)).transpose()?.flatten());
                }
                norm => norm,
            },
        };
        Ok(norm.and_then(|norm| match far {
            Some((units, problem, _)) => {
                let answer = [&*units.displacement(answer[0]), &*units.force(answer[1])];
                proven_in(&problem, &norm.with_unit(units.stiffness), answer, None)
            }
            None => proven_in(problem, &norm, answer, evidence),
        }))
    }

    /// The units in which the answer is of order one, if its own would over- or underflow, with problem and means in
    /// them.
    fn in_far_units(&self) -> Result<Option<(UnitExponents, ContactProblem, Bounding<'static>)>> {
        let Some(units) = far_units(self.problem, self.displacement) else { return Ok(None) };
        let by = match self.by {
            Bounding::OwnFactor => Bounding::OwnFactor,
            Bounding::Factor(norm) => Bounding::Factor(norm.with_unit(units.stiffness)),
            _ => Bounding::Nothing,
        };
        Ok(Some((units, in_units(self.problem, &units)?, by)))
    }
}

/// Other units of stiffness and length for data at the ends of double precision: exponents of two.
#[derive(Clone, Copy, Debug)]
struct UnitExponents {
    stiffness: i32,
    length: i32,
}

impl UnitExponents {
    fn displacement(&self, displacement: &[f64]) -> Vec<f64> {
        displacement.iter().map(|&value| ldexp(value, -self.length)).collect()
    }

    fn force(&self, force: &[f64]) -> Vec<f64> {
        force.iter().map(|&value| ldexp(value, -self.stiffness - self.length)).collect()
    }

    fn in_own(&self, certificate: Certificate) -> Certificate {
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

fn far_units(problem: &ContactProblem, displacement: &[f64]) -> Option<UnitExponents> {
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

fn in_units(problem: &ContactProblem, units: &UnitExponents) -> Result<ContactProblem> {
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
