//! Balance of forces with the rows of a contact set held at their gaps.

use std::cell::Cell;

use super::ScaledProblem;
use crate::linear::{Cholesky, largest};
use crate::problem::ContactProblem;
use crate::solution::ContactSet;

/// Weight of the closed rows in K + w B_C'B_C, on a diagonal of order one: every correction of the multipliers gains
/// about four digits, and the factorisation loses as many.
pub const WEIGHT: f64 = 65536.0;

/// Corrections of the multipliers; four or five suffice if the closed rows are consistent.
const CORRECTIONS: usize = 25;

/// A correction by the compliance below this is the last: a factor that is safely definite makes the next one its
/// square, or less.
const SQUARED: f64 = 1e-9;

/// Closed rows that still miss their gap by this, relative to the displacement, contradict each other.
const CONTRADICTION: f64 = 1e-9;

/// Balance of forces with the rows of a set closed.
#[derive(Clone, Debug)]
pub struct Equilibrium {
    /// Displacement, one entry per dof.
    pub displacement: Vec<f64>,
    /// Multiplier, one entry per row, zero on open rows, of either sign on closed ones.
    pub multiplier: Vec<f64>,
    /// The displacement of each row, `B u`.
    pub along_rows: Vec<f64>,
    /// `true` if all rows of the set could be closed together.
    pub consistent: bool,
}

/// The size of the displacements that matter: those of the contact rows or, if all of these are zero except for
/// rounding, the displacement by the load of a stiffness of order one. `along_rows` is the displacement of the rows.
pub fn reach(problem: &ContactProblem, along_rows: &[f64]) -> f64 {
    largest(along_rows).max(largest(problem.load()))
}

/// Solves the saddle-point system of the closed rows by corrections with the factorised K + w B_C'B_C:
///
/// ```text
/// (K + w B_C'B_C) du = f + B_C'l - K u + w B_C'(g - B u),     dl = w (g - B u - B du)  on C
/// ```
///
/// The residuals are those of the exact system, so that neither the weight nor redundant rows reduce the accuracy.
pub fn equilibrium(problem: &ContactProblem, cholesky: &Cholesky, closed: &ContactSet) -> Equilibrium {
    let contact = problem.contact();
    let correct = |force: &[f64], distance: &[f64]| {
        let du = cholesky.solve(force);
        let along = contact.mul(&du);
        let on_row = |row: usize| if closed.contains(row) { WEIGHT * (distance[row] - along[row]) } else { 0.0 };
        let dl = (0..distance.len()).map(on_row).collect();
        (du, dl)
    };
    corrected(problem, closed, [WEIGHT, f64::EPSILON], correct, |_| true)
}

/// The same by the compliance of the rows, which solves the saddle-point system itself; `None` if closed rows follow
/// from others. A balance that is not the one sought, because it `is_near` no answer, is left as it is after the first
/// correction.
pub fn by_compliance(
    scaled: &ScaledProblem,
    closed: &ContactSet,
    is_near: impl Fn(&Equilibrium) -> bool,
) -> Option<Equilibrium> {
    let compliance = scaled.compliance?;
    let held = compliance.held(closed.iter().collect())?;
    // The first force is the load.
    let first = Cell::new(Some(scaled.swept_load(compliance)));
    let correct =
        |force: &[f64], distance: &[f64]| held.solve(first.take().unwrap_or_else(|| compliance.swept(force)), distance);
    let balance = corrected(scaled.problem, closed, [0.0, SQUARED], correct, is_near);
    balance.consistent.then_some(balance)
}

/// The balance of the closed rows. `correct` gives the correction of displacement and multiplier for a force that is
/// left, which contains the distances of the closed rows by their `weight`, and for these distances. A correction that
/// is small `enough`, or rounding, is the last, and so is one to a balance that `is_near` no answer.
fn corrected(
    problem: &ContactProblem,
    closed: &ContactSet,
    [weight, enough]: [f64; 2],
    correct: impl Fn(&[f64], &[f64]) -> (Vec<f64>, Vec<f64>),
    is_near: impl Fn(&Equilibrium) -> bool,
) -> Equilibrium {
    let (contact, gap) = (problem.contact(), problem.gap());
    let (mut unbalanced, displacement) = (problem.load().to_vec(), vec![0.0; problem.dofs()]);
    let [multiplier, along_rows] = [(); 2].map(|()| vec![0.0; problem.rows()]);
    let mut balance = Equilibrium { displacement, multiplier, along_rows, consistent: true };
    let missing = |along: &[f64]| -> Vec<f64> {
        let of_row = |(row, (b, g)): (usize, (&f64, &f64))| if closed.contains(row) { g - b } else { 0.0 };
        along.iter().zip(gap).enumerate().map(of_row).collect()
    };
    let load = largest(problem.load());
    let mut last_step = f64::INFINITY;
    for _ in 0..CORRECTIONS {
        let distance = missing(&balance.along_rows);
        if weight > 0.0 || largest(&balance.multiplier) > 0.0 {
            let push: Vec<f64> = balance.multiplier.iter().zip(&distance).map(|(l, d)| l + weight * d).collect();
            unbalanced.iter_mut().zip(contact.mul_transposed(&push)).for_each(|(force, push)| *force += push);
        }
        let (du, dl) = correct(&unbalanced, &distance);
        let Equilibrium { displacement: u, multiplier, along_rows, .. } = &mut balance;
        u.iter_mut().zip(&du).for_each(|(u, du)| *u += du);
        multiplier.iter_mut().zip(&dl).for_each(|(l, dl)| *l += dl);
        *along_rows = contact.mul(u);
        let step = relative_size(&du, largest(u).max(load)) + relative_size(&dl, largest(multiplier).max(load));
        if step <= enough || step > 0.5 * last_step || !is_near(&balance) {
            break;
        }
        last_step = step;
        unbalanced = problem.stiffness().mul(&balance.displacement);
        unbalanced.iter_mut().zip(problem.load()).for_each(|(force, load)| *force = load - *force);
    }
    let reach = closed.iter().fold(reach(problem, &balance.along_rows), |most, row| gap[row].abs().max(most));
    let consistent = largest(&missing(&balance.along_rows)) <= CONTRADICTION * reach;
    Equilibrium { consistent, ..balance }
}

fn relative_size(step: &[f64], size: f64) -> f64 {
    if size == 0.0 { 0.0 } else { largest(step) / size }
}
