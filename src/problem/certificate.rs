//! The certificate: every condition of the solution recomputed from the original problem.

use super::energy_bound::Answer;
use super::{ContactProblem, EnergyNorm};
use crate::error::Error;
use crate::solution::Certificate;
use crate::sparse::multigrid::Multigrid;
use crate::sparse::{Accumulator, dot};

/// Rounding u to double precision and summing a sparse row leaves a residual of about this many units in the last
/// place of its largest term; below it a residual says nothing about the answer.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// One unit in the last place, as a share of [`ROUNDING`].
const UNIT_ROUNDING: f64 = 1.0 / 8.0;

/// Rounding excuses no more of an imbalance than this share of the forces: where the displacement is so large, or the
/// stiffness so uneven, that it would explain more, the multipliers have lost as many digits.
const EXCUSED: f64 = 1e-7;

/// A displacement below this share of force over stiffness is zero but for rounding.
const NOTHING: f64 = 1e-3;

/// What bounds the error in energy.
#[derive(Clone, Copy)]
enum Bounding<'a> {
    Factor(&'a EnergyNorm),
    Cycles(&'a Multigrid),
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |largest: f64, value| if value.abs() > largest { value.abs() } else { largest })
}

/// `f + B' lambda - K u` with what rounding may have hidden of it: an error of one unit in the last place of each sum's
/// terms, of one sign or the other by turns.
fn with_rounding(residual: &[f64], rounding: &[f64]) -> Vec<f64> {
    let sign = |dof: usize| if dof.wrapping_mul(0x9e37_79b9) >> 16 & 1 == 0 { 1.0 } else { -1.0 };
    residual.iter().zip(rounding).enumerate().map(|(dof, (r, limit))| sign(dof) * limit * UNIT_ROUNDING - r).collect()
}

/// `value / scale`, where nothing over nothing is nothing.
fn relative(value: f64, scale: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value / scale }
}

impl ContactProblem {
    /// The certificate of an answer (u, lambda), with the energy bound where K is positive definite.
    ///
    /// # Errors
    /// [`Error::Length`] for vectors that do not fit, [`Error::Numerical`] when the factorisation of K fails for want
    /// of memory.
    pub fn certify(&self, displacement: &[f64], multiplier: &[f64]) -> Result<Certificate, Error> {
        self.certify_in(EnergyNorm::of(&self.stiffness, &self.contact)?.as_ref(), displacement, multiplier)
    }

    /// As [`ContactProblem::certify`], in an energy norm that is at hand.
    ///
    /// # Errors
    /// [`Error::Length`] for vectors that do not fit.
    pub fn certify_in(
        &self,
        norm: Option<&EnergyNorm>,
        displacement: &[f64],
        multiplier: &[f64],
    ) -> Result<Certificate, Error> {
        self.check_answer(displacement, multiplier)?;
        let Some(units) = self.far_units(displacement) else {
            return Ok(self.recomputed(norm.map(Bounding::Factor), displacement, multiplier));
        };
        let (norm, problem) = (norm.map(|norm| units.norm(norm)), self.in_units(&units)?);
        let bounding = norm.as_ref().map(Bounding::Factor);
        Ok(problem.recomputed(bounding, &units.displacement(displacement), &units.force(multiplier)))
    }

    /// As [`ContactProblem::certify`], with the energy bound by the cycles of the hierarchy of K, which needs no factor and
    /// rests on a measured eigenvalue; without a bound where K is singular to the precision of its levels.
    ///
    /// # Errors
    /// [`Error::Length`] for vectors that do not fit.
    pub(crate) fn certify_by_cycles(
        &self,
        multigrid: &Multigrid,
        displacement: &[f64],
        multiplier: &[f64],
    ) -> Result<Certificate, Error> {
        self.check_answer(displacement, multiplier)?;
        if self.far_units(displacement).is_some() {
            return self.certify_in(None, displacement, multiplier);
        }
        Ok(self.recomputed(Some(Bounding::Cycles(multigrid)), displacement, multiplier))
    }

    fn recomputed(&self, bounding: Option<Bounding>, u: &[f64], lambda: &[f64]) -> Certificate {
        let elastic = self.stiffness.mul(u);
        let contact = self.contact.mul_transposed(lambda);
        let rounding = self.rounding(u, lambda);
        let residual: Vec<f64> = (0..self.dofs()).map(|dof| elastic[dof] - self.load[dof] - contact[dof]).collect();
        let violation = self.violation(u);
        let bound_rows = || (0..self.rows()).filter(|&row| self.gap[row].is_finite());
        // lambda (B u - g) = lambda B u - lambda g; a row without obstacle carries no multiplier.
        let products: Vec<f64> =
            (0..self.rows()).map(|row| if lambda[row] == 0.0 { 0.0 } else { lambda[row] * violation[row] }).collect();

        let force_scale = largest(self.load.iter().copied()).max(largest(contact.iter().copied()));
        let explained = |r: f64, limit: f64| r.abs() <= limit.min(EXCUSED * force_scale);
        let excess: Vec<f64> =
            residual.iter().zip(&rounding).map(|(&r, &limit)| if explained(r, limit) { 0.0 } else { r }).collect();
        let closed_gaps = bound_rows().filter(|&row| lambda[row] != 0.0 || violation[row] > 0.0);
        // Where the displacement is zero but for rounding, errors are measured by what the forces do to the largest
        // stiffness of the body.
        let stiffness_scale = largest(self.stiffness.diagonal());
        let static_reach = if stiffness_scale > 0.0 { NOTHING * force_scale / stiffness_scale } else { 0.0 };
        let length_scale =
            largest(self.contact.mul(u)).max(largest(closed_gaps.map(|row| self.gap[row]))).max(static_reach);
        let multiplier_scale = largest(lambda.iter().copied());
        let work_of_gap: f64 = bound_rows().map(|row| self.gap[row] * lambda[row]).sum();
        let static_energy = NOTHING * force_scale * static_reach / 2.0;
        let strain_energy = (dot(u, &elastic) / 2.0).max(static_energy);
        let energy_scale = strain_energy.max(dot(&self.load, u).abs()).max(work_of_gap.abs());
        let gap_of_energies = dot(u, &excess) + products.iter().sum::<f64>();

        Certificate {
            stationarity: relative(largest(residual.iter().copied()), force_scale),
            stationarity_excess: relative(largest(excess.iter().copied()), force_scale),
            penetration: relative(largest(violation.iter().map(|value| value.max(0.0))), length_scale),
            adhesion: relative(largest(lambda.iter().map(|value| value.max(0.0))), multiplier_scale),
            complementarity: relative(largest(products.iter().copied()), multiplier_scale * length_scale),
            duality_gap: relative(gap_of_energies.abs(), energy_scale),
            energy_error_bound: match bounding {
                Some(bounding) => {
                    let is_rounding = excess.iter().all(|&value| value == 0.0);
                    let residual = if is_rounding {
                        self.accurate_residual(u, lambda)
                    } else {
                        with_rounding(&residual, &rounding)
                    };
                    let answer = Answer { displacement: u, multiplier: lambda, residual, violation: &violation };
                    let bound = match bounding {
                        Bounding::Factor(norm) => self.energy_error_bound(norm, &answer),
                        Bounding::Cycles(multigrid) => self.energy_error_bound_by(multigrid, &answer),
                    };
                    relative(bound, (2.0 * strain_energy).sqrt())
                }
                None => f64::INFINITY,
            },
            bound_is_measured: matches!(bounding, Some(Bounding::Cycles(_))),
        }
    }

    /// Do the vectors of an answer fit?
    pub(super) fn check_answer(&self, displacement: &[f64], multiplier: &[f64]) -> Result<(), Error> {
        let length = |name, found: usize, expected, of| {
            if found == expected { Ok(()) } else { Err(Error::Length { name, found, expected, of }) }
        };
        length("displacement", displacement.len(), self.dofs(), "dofs")?;
        length("multiplier", multiplier.len(), self.rows(), "contact rows")
    }

    /// `f + B' lambda - K u` of the given doubles, with twice the working precision.
    pub(crate) fn accurate_residual(&self, u: &[f64], lambda: &[f64]) -> Vec<f64> {
        let mut sums = Accumulator::new(&self.load);
        for (column, &at_column) in u.iter().enumerate() {
            for (row, value) in self.stiffness.lower().column(column) {
                sums.add_product(row, -value, at_column);
                if row != column {
                    sums.add_product(column, -value, u[row]);
                }
            }
            self.contact.column(column).for_each(|(row, b)| sums.add_product(column, b, lambda[row]));
        }
        sums.into_sums()
    }

    /// What rounding alone can leave of each entry of `K u - f - B' lambda`.
    fn rounding(&self, u: &[f64], lambda: &[f64]) -> Vec<f64> {
        let elastic = self.stiffness.mul_abs(u);
        let magnitude: Vec<f64> = lambda.iter().map(|value| value.abs()).collect();
        let contact = self.contact.abs().mul_transposed(&magnitude);
        (0..self.dofs()).map(|dof| ROUNDING * (elastic[dof] + self.load[dof].abs() + contact[dof])).collect()
    }
}
