//! Balance of forces with the rows of a contact set held at their gaps.

use crate::linear::{Cholesky, largest};
use crate::problem::ContactProblem;
use crate::solution::ContactSet;

/// Weight of the closed rows in K + w B_C'B_C, on a diagonal of order one: every correction of the multipliers gains about four
/// digits, and the factorisation loses as many.
pub const WEIGHT: f64 = 65536.0;

/// Corrections of the multipliers; four or five suffice if the closed rows are consistent.
const CORRECTIONS: usize = 25;

/// Closed rows that still miss their gap by this, relative to the displacement, contradict each other.
const CONTRADICTION: f64 = 1e-9;

/// Balance of forces with the rows of a set closed.
#[derive(Clone, Debug)]
pub struct Equilibrium {
    /// Displacement, one entry per dof.
    pub displacement: Vec<f64>,
    /// Multiplier, one entry per row, zero on open rows, of either sign on closed ones.
    pub multiplier: Vec<f64>,
    /// `true` if all rows of the set could be closed together.
    pub consistent: bool,
}

/// The size of the displacements that matter: those of the contact rows or, if all of these are zero except for rounding, the
/// displacement by the load of a stiffness of order one.
pub fn reach(problem: &ContactProblem, u: &[f64]) -> f64 {
    largest(&problem.contact().mul(u)).max(largest(problem.load()))
}

/// Solves the saddle-point system of the closed rows by corrections with the factorised K + w B_C'B_C:
///
/// ```text
/// (K + w B_C'B_C) du = f + B_C'l - K u + w B_C'(g - B u),     dl = w (g - B u - B du)  on C
/// ```
///
/// The residuals are those of the exact system, so that neither the weight nor redundant rows reduce the accuracy.
pub fn equilibrium(problem: &ContactProblem, cholesky: &Cholesky, closed: &ContactSet) -> Equilibrium {
    let (rows, contact, gap) = (problem.rows(), problem.contact(), problem.gap());
    let mut u = vec![0.0; problem.dofs()];
    let mut multiplier = vec![0.0; rows];
    let on_closed = |values: Vec<f64>| -> Vec<f64> {
        values.into_iter().enumerate().map(|(row, value)| if closed.contains(row) { value } else { 0.0 }).collect()
    };
    let missing = |u: &[f64]| on_closed(contact.mul(u).iter().zip(gap).map(|(b, g)| g - b).collect());
    let load = largest(problem.load());
    let mut last_step = f64::INFINITY;
    for _ in 0..CORRECTIONS {
        let distance = missing(&u);
        let push: Vec<f64> = multiplier.iter().zip(&distance).map(|(l, d)| l + WEIGHT * d).collect();
        let (elastic, contact_force) = (problem.stiffness().mul(&u), contact.mul_transposed(&push));
        let force: Vec<f64> = (0..u.len()).map(|dof| problem.load()[dof] - elastic[dof] + contact_force[dof]).collect();
        let du = cholesky.solve(&force);
        let dl: Vec<f64> = on_closed(contact.mul(&du).iter().zip(&distance).map(|(b, d)| WEIGHT * (d - b)).collect());
        u.iter_mut().zip(&du).for_each(|(u, du)| *u += du);
        multiplier.iter_mut().zip(&dl).for_each(|(l, dl)| *l += dl);
        let step = relative_size(&du, largest(&u).max(load)) + relative_size(&dl, largest(&multiplier).max(load));
        if step <= f64::EPSILON || step > 0.5 * last_step {
            break;
        }
        last_step = step;
    }
    let reach = reach(problem, &u).max(largest(&on_closed(gap.to_vec())));
    let consistent = largest(&missing(&u)) <= CONTRADICTION * reach;
    Equilibrium { displacement: u, multiplier, consistent }
}

fn relative_size(step: &[f64], size: f64) -> f64 {
    if size == 0.0 { 0.0 } else { largest(step) / size }
}
