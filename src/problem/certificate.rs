//! The certificate: every condition of the solution recomputed from the original problem.

use super::ContactProblem;
use crate::error::Error;
use crate::solution::Certificate;
use crate::sparse::{Cholesky, Equilibration, FactorError, SymmetricMatrix, dot, ldexp};

/// Rounding u to double precision and summing a sparse row leaves a residual of about this many units in the last
/// place of its largest term; below it a residual says nothing about the answer.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Sweeps over the violated rows when a displacement is repaired to a feasible one.
const REPAIR_SWEEPS: usize = 50;

/// A displacement below this share of force over stiffness is zero but for rounding.
const NOTHING: f64 = 1e-3;

/// The energy norm of a positive definite stiffness and its dual, from one factorisation of K with a diagonal near one.
#[derive(Clone, Debug)]
pub struct EnergyNorm {
    cholesky: Cholesky,
    equilibration: Equilibration,
}

impl EnergyNorm {
    /// The energy norm of `stiffness`, or `None` where it is not positive definite to working precision.
    ///
    /// # Errors
    /// [`Error::Numerical`] when the factorisation fails for another reason, as memory.
    pub fn of(stiffness: &SymmetricMatrix) -> Result<Option<Self>, Error> {
        if stiffness.diagonal().iter().any(|&value| value <= 0.0) {
            return Ok(None);
        }
        let equilibration = Equilibration::of(stiffness);
        let scaled = equilibration.apply(stiffness);
        match Cholesky::of(&scaled) {
            Ok(cholesky) if cholesky.is_definite(&scaled) => Ok(Some(Self { cholesky, equilibration })),
            Ok(_) | Err(FactorError::NotPositiveDefinite) => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    /// The energy norm from a factor of the equilibrated stiffness `c D K D` that is at hand.
    pub fn new(cholesky: Cholesky, equilibration: Equilibration) -> Self {
        EnergyNorm { cholesky, equilibration }
    }

    /// The displacement of the equilibrated stiffness under an equilibrated load.
    pub fn scaled_displacement(&self, load: &[f64]) -> Vec<f64> {
        self.cholesky.solve(load)
    }

    /// `sqrt(r' K^-1 r)`: the energy norm of the displacement that the force r causes.
    fn of_force(&self, residual: &[f64]) -> f64 {
        // K^-1 = c D (c D K D)^-1 D
        let scaled: Vec<f64> = residual.iter().zip(&self.equilibration.diagonal).map(|(&r, &d)| ldexp(r, d)).collect();
        ldexp(self.cholesky.inverse_product(&scaled), self.equilibration.factor).max(0.0).sqrt()
    }
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |largest: f64, value| if value.abs() > largest { value.abs() } else { largest })
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
        self.certify_in(EnergyNorm::of(&self.stiffness)?.as_ref(), displacement, multiplier)
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
        let length = |name, found: usize, expected, of| {
            if found == expected { Ok(()) } else { Err(Error::Length { name, found, expected, of }) }
        };
        length("displacement", displacement.len(), self.dofs(), "dofs")?;
        length("multiplier", multiplier.len(), self.rows(), "contact rows")?;
        let (u, lambda) = (displacement, multiplier);

        let elastic = self.stiffness.mul(u);
        let contact = self.contact.mul_transposed(lambda);
        let rounding = self.rounding(u, lambda);
        let residual: Vec<f64> = (0..self.dofs()).map(|dof| elastic[dof] - self.load[dof] - contact[dof]).collect();
        let excess: Vec<f64> =
            residual.iter().zip(&rounding).map(|(&r, &limit)| if r.abs() <= limit { 0.0 } else { r }).collect();
        let violation = self.violation(u);
        let bound_rows = || (0..self.rows()).filter(|&row| self.gap[row].is_finite());
        // lambda (B u - g) = lambda B u - lambda g; a row without obstacle carries no multiplier.
        let products: Vec<f64> =
            (0..self.rows()).map(|row| if lambda[row] == 0.0 { 0.0 } else { lambda[row] * violation[row] }).collect();

        let force_scale = largest(self.load.iter().copied()).max(largest(contact.iter().copied()));
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

        Ok(Certificate {
            stationarity: relative(largest(residual), force_scale),
            stationarity_excess: relative(largest(excess), force_scale),
            penetration: relative(largest(violation.iter().map(|value| value.max(0.0))), length_scale),
            adhesion: relative(largest(lambda.iter().map(|value| value.max(0.0))), multiplier_scale),
            complementarity: relative(largest(products.iter().copied()), multiplier_scale * length_scale),
            duality_gap: relative(gap_of_energies.abs(), energy_scale),
            energy_error_bound: match norm {
                Some(norm) => {
                    relative(self.energy_error_bound(norm, u, lambda, &elastic), (2.0 * strain_energy).sqrt())
                }
                None => f64::INFINITY,
            },
        })
    }

    /// What rounding alone can leave of each entry of `K u - f - B' lambda`.
    fn rounding(&self, u: &[f64], lambda: &[f64]) -> Vec<f64> {
        let elastic = self.stiffness.mul_abs(u);
        let magnitude: Vec<f64> = lambda.iter().map(|value| value.abs()).collect();
        let contact = self.contact.abs().mul_transposed(&magnitude);
        (0..self.dofs()).map(|dof| ROUNDING * (elastic[dof] + self.load[dof].abs() + contact[dof])).collect()
    }

    /// An upper bound on `norm_K(u - u*)`.
    ///
    /// With v feasible, mu <= 0 and r = f + B' mu - K v: `J(v) - D(mu) = 1/2 r'K^-1 r + mu'(B v - g)`, and the left side
    /// is at least `1/2 norm_K(v - u*)^2`. The pair (v, mu) is the answer repaired: penetrating rows pushed back,
    /// wrong-signed multipliers dropped.
    fn energy_error_bound(&self, norm: &EnergyNorm, u: &[f64], lambda: &[f64], elastic: &[f64]) -> f64 {
        let mu: Vec<f64> =
            (0..self.rows()).map(|row| if self.gap[row].is_finite() { lambda[row].min(0.0) } else { 0.0 }).collect();
        let Some(repair) = self.repair(u) else { return f64::INFINITY };
        let is_feasible = repair.iter().all(|&change| change == 0.0);
        let elastic_repair = if is_feasible { repair.clone() } else { self.stiffness.mul(&repair) };
        let contact = self.contact.mul_transposed(&mu);
        let residual: Vec<f64> =
            (0..self.dofs()).map(|dof| self.load[dof] + contact[dof] - elastic[dof] - elastic_repair[dof]).collect();
        let repaired: Vec<f64> = u.iter().zip(&repair).map(|(a, b)| a + b).collect();
        let slack_work: f64 = self
            .violation(&repaired)
            .iter()
            .zip(&mu)
            .filter(|pair| *pair.1 != 0.0)
            .map(|(violation, mu)| violation.min(0.0) * mu)
            .sum();
        let distance = (norm.of_force(&residual).powi(2) + 2.0 * slack_work).sqrt();
        let moved = dot(&repair, &elastic_repair).max(0.0).sqrt();
        distance + moved
    }

    /// A change of u that removes all penetration, by projections row after row; `None` where rows contradict.
    fn repair(&self, u: &[f64]) -> Option<Vec<f64>> {
        let mut change = vec![0.0; self.dofs()];
        let violation = self.violation(u);
        if violation.iter().all(|&value| value <= 0.0) {
            return Some(change);
        }
        let by_row = self.contact.transposed();
        let negligible: Vec<f64> = (0..self.rows())
            .map(|row| ROUNDING * by_row.column(row).map(|(dof, b)| (b * u[dof]).abs()).sum::<f64>())
            .collect();
        for _ in 0..REPAIR_SWEEPS {
            let mut clean = true;
            for row in 0..self.rows() {
                let excess = violation[row] + by_row.column(row).map(|(dof, b)| b * change[dof]).sum::<f64>();
                let square: f64 = by_row.column(row).map(|(_, b)| b * b).sum();
                if excess > negligible[row] && square > 0.0 {
                    clean = false;
                    for (dof, b) in by_row.column(row) {
                        change[dof] -= excess / square * b;
                    }
                } else if excess > negligible[row] {
                    return None;
                }
            }
            if clean {
                return Some(change);
            }
        }
        None
    }
}
