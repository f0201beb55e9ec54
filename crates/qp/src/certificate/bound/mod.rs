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

pub(super) mod boundary;
mod closed_rows;
pub(super) mod general;
mod repair;
mod witness;

use super::energy_norm::EnergyNorm;
use super::scales::{compliance_of_rows, energies};
use crate::problem::ContactProblem;

/// An answer (u, lambda) and what its certificate has computed for it.
pub struct Answer<'a> {
    pub problem: &'a ContactProblem,
    pub displacement: &'a [f64],
    pub multiplier: &'a [f64],
    /// f + B' lambda - K u.
    pub residual: Vec<f64>,
    /// B u - g.
    pub violation: Vec<f64>,
    /// What rounding the displacement to doubles does to its energy norm; a bound below that needs no repair.
    pub rounding: f64,
}

impl<'a> Answer<'a> {
    /// The answer (u, lambda), any bound of which may need repair.
    pub fn of(problem: &'a ContactProblem, displacement: &'a [f64], multiplier: &'a [f64]) -> Self {
        let residual = problem.accurate_residual(displacement, multiplier);
        let violation = problem.accurate_violation(displacement);
        Answer { problem, displacement, multiplier, residual, violation, rounding: 0.0 }
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// An upper bound on the dual norm of the residual.
    pub of_residual: f64,
    /// The least Ritz value of K with the cycle.
    pub ritz: f64,
}

#[derive(Clone, Debug)]
pub struct ErrorBound {
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
        self.whole += shift_length(problem, step);
        if let Some(parts) = &mut self.of_parts {
            add_sizes(problem, step, parts);
        }
        self
    }
}

/// The square of a number below this share of another one underflows beside it.
const LOST: f64 = 1e-140;

/// Rounding of a sum in twice the working precision, in units of its terms.
const OF_SUMS: f64 = 4.0 * f64::EPSILON * f64::EPSILON;

/// Squares of numbers below this underflow, or lose digits.
const LEAST: f64 = 1e-145;

/// Rounding of loads and contact forces that cancel: by parts, in the energy norm of dofs that stand alone.
fn rounding_of_residual(answer: &Answer) -> Vec<f64> {
    let problem = answer.problem;
    let roots = &problem.diagonal().roots;
    let contact = problem.contact.mul_abs_transposed(answer.multiplier);
    problem.parts().sums(|dof| match roots[dof] {
        root if root > 0.0 => OF_SUMS * (problem.load[dof].abs() + contact[dof]) / root,
        _ => 0.0,
    })
}

/// The energy of displacements whose squares double precision does not keep, or not beside the forces.
fn underflow(answer: &Answer) -> f64 {
    let problem = answer.problem;
    let roots = &problem.diagonal().roots;
    let contact = problem.contact.mul_transposed(answer.multiplier);
    let force = |dof: usize| problem.load[dof].abs() + contact[dof].abs();
    let loaded = (0..problem.dofs()).filter(|&dof| force(dof) > 0.0 && roots[dof] > 0.0);
    let least = loaded.map(|dof| LOST * force(dof) / roots[dof]).fold(LEAST, f64::max);
    let is_lost = |dof: usize| {
        let size = answer.displacement[dof].abs();
        size > 0.0 && roots[dof] > 0.0 && size * roots[dof] < least
    };
    (0..problem.dofs()).filter(|&dof| is_lost(dof)).count() as f64 * 2.0 * least
}

/// The rows that look closed: their force, times their compliance if all else stood still, exceeds their distance.
fn rows_that_look_closed(answer: &Answer) -> Vec<bool> {
    let problem = answer.problem;
    let compliance = compliance_of_rows(problem, |square, stiffness| square / stiffness);
    let looks = |row: usize| -answer.multiplier[row] * compliance[row] > -answer.violation[row];
    let is_closed = |row: usize| problem.is_two_sided(row) || (problem.gap[row].is_finite() && looks(row));
    (0..problem.rows()).map(is_closed).collect()
}

/// A multiplier as its row allows it: no row but an equality pulls.
fn allowed(problem: &ContactProblem, row: usize, multiplier: f64) -> f64 {
    if problem.is_two_sided(row) { multiplier } else { multiplier.min(0.0) }
}

/// An upper bound on the energy norm of a shift, with the rounding of its sum.
fn shift_length(problem: &ContactProblem, shift: &[f64]) -> f64 {
    squares(problem, false, shift).sum::<f64>().sqrt()
}

/// Upper bounds on the squares of the energy norms of a shift by parts, or as a whole. A body that travels far may bend
/// so little that even energies in twice the working precision leave only the rounding of their terms.
fn squares(problem: &ContactProblem, by_parts: bool, shift: &[f64]) -> impl Iterator<Item = f64> + use<> {
    let (energies, terms) = energies(problem, by_parts, shift);
    energies.into_iter().zip(terms).map(|(energy, terms)| energy.max(0.0) + OF_SUMS * terms)
}

/// Upper bounds on the energy norms of a shift by parts, added to `sizes`.
fn add_sizes(problem: &ContactProblem, shift: &[f64], sizes: &mut [f64]) {
    sizes.iter_mut().zip(squares(problem, true, shift)).for_each(|(size, square)| *size += square.sqrt());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::energy_norm::{PRESSING, springs_on};
    use crate::linear::SparseMatrix;

    /// Uncoupled dofs of stiffness 4 and 16, and one without stiffness; a row `3 u_0 + 5 u_1 <= 1` and one of zeros.
    fn apart() -> ContactProblem {
        let (stiffness, contact) = ([(0, 0, 4.0), (1, 1, 16.0)], [(0, 0, 3.0), (0, 1, 5.0)]);
        ContactProblem::of_entries(&stiffness, &[8.0, 0.0, 7.0], &contact, &[1.0, 1.0])
    }

    fn answer<'a>(problem: &'a ContactProblem, displacement: &'a [f64], multiplier: &'a [f64]) -> Answer<'a> {
        Answer { problem, displacement, multiplier, residual: vec![0.0; 3], violation: vec![-1.0; 2], rounding: 0.0 }
    }

    #[test]
    fn rounding_of_a_residual_is_a_share_of_the_forces_on_each_dof() {
        // On the first dof 8 + 3 * 2, over sqrt(4); on the second 5 * 2, over sqrt(16); the third has no stiffness.
        let rounding: f64 = rounding_of_residual(&answer(&apart(), &[0.0; 3], &[-2.0, 0.0])).iter().sum();
        assert_eq!(rounding / OF_SUMS, 7.0 + 2.5);
    }

    #[test]
    fn a_body_that_travels_and_hardly_bends_is_as_long_as_the_rounding_of_its_energy() {
        // A spring between two dofs: a travel of 1e16 has no energy, but its terms are 4e32.
        let spring = ContactProblem::of_entries(&[(0, 0, 1.0), (1, 0, -1.0), (1, 1, 1.0)], &[0.0; 2], &[], &[]);
        assert_eq!(shift_length(&spring, &[1e16, 1e16]), (OF_SUMS * 4e32).sqrt());
        assert_eq!(shift_length(&spring, &[1.0, 4.0]), 3.0);
        let mut sizes = vec![1.0];
        add_sizes(&spring, &[1e16, 1e16], &mut sizes);
        assert_eq!(sizes, [1.0 + (OF_SUMS * 4e32).sqrt()]);
    }

    #[test]
    fn every_displacement_that_underflows_counts_twice_the_least_length() {
        // Without a multiplier only the first dof is loaded: a share LOST of 8 / sqrt(4).
        let least = LOST * 4.0;
        let tiny = [-1e-145, 1e-145, 0.0];
        for (u, lost) in [([0.0; 3], 0.0), ([1.0, 1.0, 1e-200], 0.0), ([1e-145, 1.0, 0.0], 2.0), (tiny, 4.0)] {
            assert_eq!(underflow(&answer(&apart(), &u, &[0.0, 0.0])) / least, lost, "{u:?}");
        }
        // Without any force it is the limit below which squares underflow by themselves.
        let free = apart().with_load(vec![0.0; 3]).unwrap();
        assert_eq!(underflow(&answer(&free, &[1e-150, 1.0, 0.0], &[0.0, 0.0])), 2.0 * LEAST);
    }

    #[test]
    fn springs_stand_on_rows_that_press_and_are_as_stiff_as_these() {
        // The compliance of the row is 9 / 4 + 25 / 16, the energy norm of u is 2.
        let stiffness = 1.0 / (9.0 / 4.0 + 25.0 / 16.0);
        let springs = |force: f64, u: f64| springs_on(&apart(), &[u, 0.0, 0.0], &[-force, 0.0]).stiffness;
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
        // A row joins the first dof, of stiffness 4, to the third, of stiffness 0; the second row acts on that alone.
        let rows = SparseMatrix::from_triplets(2, 3, &[(0, 0, 3.0), (0, 2, 5.0), (1, 2, 1.0)]).unwrap();
        let apart = apart();
        let problem = ContactProblem::new(apart.stiffness, apart.load, rows, vec![9.0, 1.0]).unwrap();
        // The energy norm of u_0 is 2 u_0; the second row is at its gap.
        let spring = |u: f64| springs_on(&problem, &[u, 0.0, 1.0], &[0.0, -10.0]).stiffness;
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
            assert_eq!(rows_that_look_closed(&answer(&problem, &[0.0; 3], &[-share * stiff, -1.0])), [looks, false]);
        }
        let unbounded = apart().with_gap(vec![f64::INFINITY, 1.0]).unwrap();
        assert_eq!(rows_that_look_closed(&answer(&unbounded, &[0.0; 3], &[-9.0, 0.0])), [false, false]);
    }
}
