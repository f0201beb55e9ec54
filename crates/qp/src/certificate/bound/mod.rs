//! An upper bound on the energy norm of an answer's error, for the whole and for each part.
//!
//! For a feasible v and multipliers mu <= 0 with r = f + B' mu - K v,
//!
//! ```text
//! 1/2 |v - u*|_K^2 <= J(v) - D(mu) = 1/2 r' K^-1 r + mu' (B v - g)
//! ```
//!
//! so that `|u - u*|_K <= |u - v|_K + sqrt(r' K^-1 r + 2 mu' (B v - g))`. The pair (v, mu) is the answer repaired: the
//! rows that look closed are put exactly at their gaps and no other row carries a force, so that the product vanishes.
//! A row that follows from others is at its gap by rounding only: it passes its force on to them, and the force that it
//! keeps, times that rounding, is a part of the product.
//!
//! If K is singular, the norm is that of `K_D = K + B_C' D B_C` with rows C that press, which equals the norm of K on
//! shifts that do not move these rows. With s = g - B u* on C and a = |r| in the dual norm of K_D,
//!
//! ```text
//! |v - u*|_K^2 + sum |mu_i| s_i <= a |v - u*|_{K_D},     |v - u*|_{K_D}^2 = |v - u*|_K^2 + sum D_i s_i^2
//! ```
//!
//! and therefore `|v - u*|_K <= a` as long as a is below every `|mu_i| / sqrt(D_i)`; [`Springs::hold`] asks for half of
//! that.

mod boundary;
mod closed_rows;
mod cycles;
mod repair;
mod row_by_row;
mod triangle;
mod witness;

use std::sync::Arc;

use super::EnergyNorm;
use super::energy_norm::{Loose, Springs};
use crate::error::Error;
use crate::linear::SparseMatrix;
use crate::problem::{ContactProblem, Parts};

/// An answer (u, lambda) and what its certificate has computed for it.
pub(super) struct Answer<'a> {
    pub displacement: &'a [f64],
    pub multiplier: &'a [f64],
    /// f + B' lambda - K u.
    pub residual: Vec<f64>,
    /// B u - g.
    pub violation: Vec<f64>,
    /// What rounding the displacement to doubles does to its energy norm; a bound below that needs no repair.
    pub rounding: f64,
}

/// Numbers that cycles have measured for a bound.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured {
    /// An upper bound on the dual norm of the residual.
    pub of_residual: f64,
    /// The least Ritz value of K with the cycle.
    pub ritz: f64,
}

/// Upper bounds on the energy norm of the error.
#[derive(Clone, Debug)]
pub(super) struct ErrorBound {
    /// `|u - u*|_K`.
    pub whole: f64,
    /// The same for each part, if there are several.
    pub of_parts: Option<Vec<f64>>,
}

impl ErrorBound {
    pub fn none() -> Self {
        ErrorBound { whole: f64::INFINITY, of_parts: None }
    }

    /// The number by which two bounds are compared; NaN counts as larger than anything.
    fn size(&self) -> f64 {
        let size = self.of_parts.as_ref().map_or(self.whole, |parts| parts.iter().sum());
        if size.is_nan() { f64::INFINITY } else { size }
    }

    fn smaller(self, other: Self) -> Self {
        if self.size() <= other.size() { self } else { other }
    }

    /// The bound on the error of an answer that differs by `step` from the answer of this bound.
    fn farther(mut self, problem: &ContactProblem, step: &[f64]) -> Self {
        self.whole += problem.length(step);
        if let Some(parts) = &mut self.of_parts {
            problem.add_sizes(problem.parts(), step, parts);
        }
        self
    }

    fn widened(mut self, factor: f64) -> Self {
        self.whole *= factor;
        self.of_parts.iter_mut().flatten().for_each(|bound| *bound *= factor);
        self
    }
}

/// The square of a number below this share of another one underflows beside it.
const LOST: f64 = 1e-140;

/// Rounding of a sum in twice the working precision, in units of its terms.
const OF_SUMS: f64 = 4.0 * f64::EPSILON * f64::EPSILON;

/// Squares of numbers below this underflow, or lose digits.
const LEAST: f64 = 1e-145;

impl ContactProblem {
    /// The answer (u, lambda), any bound of which may need repair.
    pub(super) fn answer<'a>(&self, displacement: &'a [f64], multiplier: &'a [f64]) -> Answer<'a> {
        let residual = self.accurate_residual(displacement, multiplier);
        Answer { displacement, multiplier, residual, violation: self.accurate_violation(displacement), rounding: 0.0 }
    }

    /// An upper bound on `|u - u*|_K`.
    pub(super) fn energy_error_bound(&self, norm: &EnergyNorm, answer: &Answer) -> ErrorBound {
        let closed = self.rows_that_look_closed(answer);
        let on_boundary = self.bound_on_boundary(norm, answer, &closed);
        // A bound that was cut short is not used.
        let on_boundary = on_boundary.filter(|bound| bound.whole.is_finite() || !norm.is_over());
        let bound = on_boundary.unwrap_or_else(|| {
            self.bound_row_by_row(norm, answer, Some(closed)).smaller(self.bound_row_by_row(norm, answer, None))
        });
        let (underflow, rounding) = (self.underflow(answer), self.rounding_of_residual(answer));
        let bound = bound.widened(norm.rounding());
        let with_lost = |bound: f64, rounding: f64| bound + underflow + norm.loss() * rounding;
        let of_part = |(bound, rounding): (f64, &f64)| with_lost(bound, *rounding);
        ErrorBound {
            whole: with_lost(bound.whole, rounding.iter().sum()),
            of_parts: bound.of_parts.map(|parts| parts.into_iter().zip(&rounding).map(of_part).collect()),
        }
    }

    /// Rounding, in twice the working precision, of loads and contact forces that cancel each other: by parts, in the
    /// energy norm of dofs that stand alone.
    fn rounding_of_residual(&self, answer: &Answer) -> Vec<f64> {
        let roots = &self.diagonal().roots;
        let contact = self.contact.mul_abs_transposed(answer.multiplier);
        self.parts().sums(|dof| match roots[dof] {
            root if root > 0.0 => OF_SUMS * (self.load[dof].abs() + contact[dof]) / root,
            _ => 0.0,
        })
    }

    /// The energy of displacements that are too small for their squares to be kept in double precision, or beside the
    /// forces; 0 if no displacement is so small.
    fn underflow(&self, answer: &Answer) -> f64 {
        let roots = &self.diagonal().roots;
        let contact = self.contact.mul_transposed(answer.multiplier);
        let force = |dof: usize| self.load[dof].abs() + contact[dof].abs();
        let loaded = (0..self.dofs()).filter(|&dof| force(dof) > 0.0 && roots[dof] > 0.0);
        let least = loaded.map(|dof| LOST * force(dof) / roots[dof]).fold(LEAST, f64::max);
        let is_lost = |dof: usize| {
            let size = answer.displacement[dof].abs();
            size > 0.0 && roots[dof] > 0.0 && size * roots[dof] < least
        };
        (0..self.dofs()).filter(|&dof| is_lost(dof)).count() as f64 * 2.0 * least
    }

    /// The rows that look closed: their force, times their compliance if all else stood still, exceeds their distance.
    fn rows_that_look_closed(&self, answer: &Answer) -> Vec<bool> {
        let compliance = self.compliance_of_rows(|square, stiffness| square / stiffness);
        let looks = |row: usize| -answer.multiplier[row] * compliance[row] > -answer.violation[row];
        let is_closed = |row: usize| self.is_two_sided(row) || (self.gap[row].is_finite() && looks(row));
        (0..self.rows()).map(is_closed).collect()
    }

    /// A multiplier as its row allows it: no row but an equality pulls.
    fn allowed(&self, row: usize, multiplier: f64) -> f64 {
        if self.is_two_sided(row) { multiplier } else { multiplier.min(0.0) }
    }

    /// An upper bound on the energy norm of a shift, with the rounding of its sum.
    fn length(&self, shift: &[f64]) -> f64 {
        upper_bounds(self.rounded_energies(|_| 0, 1, shift)).sum::<f64>().sqrt()
    }

    /// Upper bounds on the squares of the energy norms of a shift by parts.
    fn squares(&self, parts: &Parts, shift: &[f64]) -> impl Iterator<Item = f64> + use<> {
        upper_bounds(self.rounded_energies(|dof| parts.of_dof(dof), parts.count(), shift))
    }

    /// Upper bounds on the energy norms of a shift by parts, added to `sizes`.
    fn add_sizes(&self, parts: &Parts, shift: &[f64], sizes: &mut [f64]) {
        sizes.iter_mut().zip(self.squares(parts, shift)).for_each(|(size, square)| *size += square.sqrt());
    }
}

/// Upper bounds on energies that were summed in twice the working precision, with the magnitudes of their terms. A body
/// that travels far may bend so little that even this precision leaves only rounding.
fn upper_bounds((energies, terms): (Vec<f64>, Vec<f64>)) -> impl Iterator<Item = f64> {
    energies.into_iter().zip(terms).map(|(energy, terms)| energy.max(0.0) + OF_SUMS * terms)
}

/// A row presses if its force could do more than this share of the energy norm of its part.
const PRESSING: f64 = 1e-8;

impl ContactProblem {
    /// The energy norm of K; if K is semidefinite, that of K with springs on the rows that press, without the dofs that
    /// have neither stiffness nor a force. `None` if the springs do not hold the body, or if K has a negative
    /// eigenvalue, which springs would hide.
    pub(super) fn energy_norm(&self, displacement: &[f64], multiplier: &[f64]) -> Result<Option<EnergyNorm>, Error> {
        if let Some(norm) = EnergyNorm::of(&self.stiffness, &self.contact)? {
            return Ok(Some(norm));
        }
        let (mut stiffness, mut loose) = (self.stiffness.clone(), None);
        if let Some(found) = self.loose_dofs(multiplier) {
            let entries: Vec<_> = found.dofs.iter().enumerate().map(|(row, &dof)| (row, dof, 1.0)).collect();
            let rows = SparseMatrix::from_triplets(entries.len(), self.dofs(), &entries)?;
            stiffness = stiffness.plus_squares(&rows, &vec![1.0; entries.len()])?;
            loose = Some(Arc::new(found));
            if let Some(norm) = EnergyNorm::of(&stiffness, &self.contact)? {
                return Ok(Some(EnergyNorm { loose, ..norm }));
            }
        }
        let springs = self.springs(displacement, multiplier);
        let Some(held) = springs.added_to(&stiffness, &self.contact)? else { return Ok(None) };
        let Some(norm) = EnergyNorm::of(&held, &self.contact)? else { return Ok(None) };
        let springs = Some(Arc::new(springs));
        Ok(self.is_semidefinite()?.then_some(EnergyNorm { springs, loose, ..norm }))
    }

    /// The energy norm of a stiffness that is definite by itself, or with springs on equalities alone: it serves every
    /// answer. `None` if there is none.
    pub(crate) fn norm_on_equalities(&self) -> Result<Option<EnergyNorm>, Error> {
        let (at_rest, forces) = (vec![0.0; self.dofs()], vec![0.0; self.rows()]);
        let norm = self.two_sided(&forces).0.energy_norm(&at_rest, &forces)?;
        Ok(norm.filter(|norm| norm.loose_dofs() == 0))
    }

    /// The dofs without stiffness on which neither a load nor a row acts, if there are some.
    fn loose_dofs(&self, multiplier: &[f64]) -> Option<Loose> {
        let mut is_loose: Vec<bool> = self
            .diagonal()
            .values
            .iter()
            .zip(&self.load)
            .map(|(&stiffness, &f)| stiffness == 0.0 && f == 0.0)
            .collect();
        // A coupling on a diagonal of zero has negative energy.
        for (row, column, _) in self.stiffness.lower().triplets().filter(|entry| entry.2 != 0.0) {
            (is_loose[row], is_loose[column]) = (false, false);
        }
        let acts = |row: usize| multiplier[row] != 0.0 || self.is_two_sided(row);
        let acting = self.contact.triplets().filter(|&(row, _, b)| b != 0.0 && acts(row));
        acting.for_each(|(_, dof, _)| is_loose[dof] = false);
        let dofs: Vec<usize> = (0..self.dofs()).filter(|&dof| is_loose[dof]).collect();
        let mut rows = vec![false; self.rows()];
        self.contact.triplets().filter(|&(_, dof, b)| b != 0.0 && is_loose[dof]).for_each(|(row, ..)| rows[row] = true);
        (!dofs.is_empty()).then_some(Loose { dofs, rows })
    }

    /// Springs on the rows that press and on equalities, each as stiff as the row itself if only its own dofs move.
    pub(super) fn springs(&self, displacement: &[f64], multiplier: &[f64]) -> Springs {
        let parts = self.parts();
        let of_stiff = |square: f64, stiffness: f64| if stiffness > 0.0 { square / stiffness } else { 0.0 };
        let compliance = self.compliance_of_rows(of_stiff);
        let sizes: Vec<f64> = self.energies(parts, displacement).iter().map(|energy| energy.max(0.0).sqrt()).collect();
        let violation = self.accurate_violation(displacement);
        let spring = |row: usize| {
            let (force, size) = (-multiplier[row], sizes[parts.of_row(row)]);
            // A row that acts only on dofs without stiffness has no stiffness of its own: its force sets the scale.
            let stiffness = match compliance[row] {
                0.0 if size > 0.0 && force != 0.0 => (force / size).powi(2),
                0.0 => 1.0,
                compliance => 1.0 / compliance,
            };
            if self.is_two_sided(row) {
                return stiffness;
            }
            let presses = force > PRESSING * stiffness.sqrt() * size && force * compliance[row] >= -violation[row];
            if presses { stiffness } else { 0.0 }
        };
        let has_one = |row: usize| multiplier[row] < 0.0 || self.is_two_sided(row);
        Springs {
            stiffness: (0..self.rows()).map(|row| if has_one(row) { spring(row) } else { 0.0 }).collect(),
            are_equalities: (0..self.rows()).map(|row| self.is_two_sided(row)).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two dofs of stiffness 4 and 16 that nothing couples, and one without stiffness; a row `3 u_0 + 5 u_1 <= 1` and
    /// one of zeros.
    fn apart() -> ContactProblem {
        let (stiffness, contact) = ([(0, 0, 4.0), (1, 1, 16.0)], [(0, 0, 3.0), (0, 1, 5.0)]);
        ContactProblem::of_entries(&stiffness, &[8.0, 0.0, 7.0], &contact, &[1.0, 1.0])
    }

    fn answer<'a>(displacement: &'a [f64], multiplier: &'a [f64]) -> Answer<'a> {
        Answer { displacement, multiplier, residual: vec![0.0; 3], violation: vec![-1.0; 2], rounding: 0.0 }
    }

    #[test]
    fn rounding_of_a_residual_is_a_share_of_the_forces_on_each_dof() {
        // On the first dof 8 + 3 * 2, over sqrt(4); on the second 5 * 2, over sqrt(16); the third has no stiffness.
        let rounding: f64 = apart().rounding_of_residual(&answer(&[0.0; 3], &[-2.0, 0.0])).iter().sum();
        assert_eq!(rounding / OF_SUMS, 7.0 + 2.5);
    }

    #[test]
    fn a_body_that_travels_and_hardly_bends_is_as_long_as_the_rounding_of_its_energy() {
        // A spring between two dofs: a travel of 1e16 has no energy, but its terms are 4e32.
        let spring = ContactProblem::of_entries(&[(0, 0, 1.0), (1, 0, -1.0), (1, 1, 1.0)], &[0.0; 2], &[], &[]);
        assert_eq!(spring.length(&[1e16, 1e16]), (OF_SUMS * 4e32).sqrt());
        assert_eq!(spring.length(&[1.0, 4.0]), 3.0);
        let mut sizes = vec![1.0];
        spring.add_sizes(spring.parts(), &[1e16, 1e16], &mut sizes);
        assert_eq!(sizes, [1.0 + (OF_SUMS * 4e32).sqrt()]);
    }

    #[test]
    fn every_displacement_that_underflows_counts_twice_the_least_length() {
        // Without a multiplier only the first dof is loaded: a share LOST of 8 / sqrt(4).
        let least = LOST * 4.0;
        let underflow = |u: &[f64]| apart().underflow(&answer(u, &[0.0, 0.0])) / least;
        for (u, lost) in [([0.0; 3], 0.0), ([1.0, 1.0, 1e-200], 0.0), ([1e-145, 1.0, 0.0], 2.0)] {
            assert_eq!(underflow(&u), lost, "{u:?}");
        }
        assert_eq!(underflow(&[-1e-145, 1e-145, 0.0]), 4.0);
        // Without any force it is the limit below which squares underflow by themselves.
        let free = apart().with_load(vec![0.0; 3]).unwrap();
        assert_eq!(free.underflow(&answer(&[1e-150, 1.0, 0.0], &[0.0, 0.0])), 2.0 * LEAST);
    }

    #[test]
    fn springs_stand_on_rows_that_press_and_are_as_stiff_as_these() {
        // The compliance of the row is 9 / 4 + 25 / 16, the energy norm of u is 2.
        let stiffness = 1.0 / (9.0 / 4.0 + 25.0 / 16.0);
        let springs = |force: f64, u: f64| apart().springs(&[u, 0.0, 0.0], &[-force, 0.0]).stiffness;
        assert_eq!(springs(10.0, 1.0), [stiffness, 0.0]);
        assert_eq!(springs(-10.0, 1.0), [0.0, 0.0]);
        // A force below the share that presses, and one that does not cross the gap of a body at rest.
        let least = PRESSING * stiffness.sqrt() * 2.0;
        assert_eq!(springs(0.9 * least, 1.0), [0.0, 0.0]);
        assert_eq!(springs(1.1 * least, 1.0), [stiffness, 0.0]);
        assert_eq!(springs(0.9 * stiffness, 0.0), [0.0, 0.0]);
        assert_eq!(springs(1.1 * stiffness, 0.0), [stiffness, 0.0]);
    }

    #[test]
    fn a_row_on_dofs_without_stiffness_has_a_spring_that_its_force_stretches_by_the_energy_norm() {
        // A row joins the first dof, of stiffness 4, to the third, of stiffness 0. The second row acts on the third
        // alone.
        let rows = SparseMatrix::from_triplets(2, 3, &[(0, 0, 3.0), (0, 2, 5.0), (1, 2, 1.0)]).unwrap();
        let apart = apart();
        let problem = ContactProblem::new(apart.stiffness, apart.load, rows, vec![9.0, 1.0]).unwrap();
        // The energy norm of u_0 is 2 u_0; the second row is at its gap.
        let spring = |u: f64| problem.springs(&[u, 0.0, 1.0], &[0.0, -10.0]).stiffness;
        assert_eq!(spring(1.0), [0.0, (10.0_f64 / 2.0).powi(2)]);
        assert_eq!(spring(-0.25), [0.0, (10.0_f64 / 0.5).powi(2)]);
        // Without energy there is no scale.
        assert_eq!(spring(0.0), [0.0, 1.0]);
    }

    #[test]
    fn rows_look_closed_if_their_force_reaches_over_their_distance() {
        let stiff = 1.0 / (9.0 / 4.0 + 25.0 / 16.0);
        for (share, looks) in [(0.9, false), (1.1, true)] {
            // The distance of both rows is one; a row of zeros has no compliance.
            let problem = apart();
            assert_eq!(problem.rows_that_look_closed(&answer(&[0.0; 3], &[-share * stiff, -1.0])), [looks, false]);
        }
        let unbounded = apart().with_gap(vec![f64::INFINITY, 1.0]).unwrap();
        assert_eq!(unbounded.rows_that_look_closed(&answer(&[0.0; 3], &[-9.0, 0.0])), [false, false]);
    }
}
