//! The active-set loop with Lagrange multipliers.
//!
//! ```text
//! C <- 0; repeat: solve  [ K  -C ] [u]   [ f   ]
//!                        [ C  I-C] [l] = [ C g ]      C <- diag heaviside( (I-C)(u-g) - C l )     until C is settled
//! ```
//!
//! A primal-dual active set, or semismooth Newton, method: from most starts it ends in a few steps. It can cycle. When
//! a set returns, the loop goes on by block principal pivoting, with single pivots (largest row first) if a block
//! exchange does not reduce the number of violations: finite for every P-matrix. The loop ends unsettled if closed rows
//! contradict each other, or if a set returns under pivoting too.
//!
//! # Source
//! J. J. Júdice and F. M. Pires, *A block principal pivoting algorithm for large-scale strictly monotone linear
//! complementarity problems*, Computers & Operations Research 21 (1994) 587-596.

use std::cell::{Cell, LazyCell};
use std::collections::HashSet;

use super::{Ending, Outcome, SIGN_TOLERANCE, ScaledProblem};
use crate::error::Result;
use crate::linear::{Cholesky, largest};
use crate::problem::ContactProblem;
use crate::solution::{ContactSet, Iteration};

/// Rounding of a multiplier, in units of the last place of the forces that balance it.
const FORCE_ROUNDING: f64 = 4.0 * f64::EPSILON;

/// No diagonal entry of a scaled stiffness is larger.
const MOST_ENTRY: f64 = 4.0;

/// No entry of a scaled row is larger.
const MOST_OF_ROW: f64 = 2.0;

/// A row that is wrong by this share of the largest displacement or multiplier is wrong whatever corrections follow.
const CLEARLY: f64 = 1e-6;

/// Number of block exchanges that may fail to reduce the number of violations before a single pivot.
const PATIENCE: usize = 3;

/// Weight of the closed rows in K + w B_C'B_C, on a diagonal of order one: every correction of the multipliers gains
/// about four digits, and the factorisation loses as many.
const WEIGHT: f64 = 65536.0;

/// Corrections of the multipliers; four or five suffice if the closed rows are consistent.
const CORRECTIONS: usize = 25;

/// A correction by the compliance below this is the last: the next one would be its square, or less.
const SQUARED: f64 = 1e-9;

/// Closed rows that still miss their gap by this, relative to the displacement, contradict each other.
const CONTRADICTION: f64 = 1e-9;

/// Runs the loop from the contact set `closed`, over at most `most_iterations` sets, each with a factorisation.
pub fn solve(scaled: &ScaledProblem, mut closed: ContactSet, most_iterations: usize) -> Result<Outcome> {
    let (mut displacement, mut multiplier) = (vec![0.0; scaled.problem.dofs()], vec![0.0; scaled.problem.rows()]);
    let (mut history, mut seen) = (Vec::new(), HashSet::new());
    let (mut rule, mut ending) = (Rule::Exchange, Ending::Unsettled);
    let is_over = |done: usize| done > 0 && scaled.watch.is_over();
    while ending == Ending::Unsettled && history.len() < most_iterations && !is_over(history.len()) {
        scaled.watch.step("active set", history.len() + 1);
        let is_near = |balance: &Equilibrium| wrong_rows(scaled, balance, &closed, CLEARLY).next().is_none();
        let balance = match by_compliance(scaled, &closed, is_near) {
            Some(balance) => balance,
            // The rows that hold the body join the set.
            None => match scaled.hold_with_more(&mut closed, WEIGHT, &displacement)? {
                Ok(factor) => equilibrium(scaled.problem, &factor, &closed),
                Err(without) => {
                    ending = without;
                    break;
                }
            },
        };
        history.push(Iteration { contact_set: closed.clone(), penalty: 0.0 });
        if !balance.consistent {
            break;
        }
        let wrong: Vec<usize> = wrong_rows(scaled, &balance, &closed, SIGN_TOLERANCE).collect();
        (displacement, multiplier) = (balance.displacement, balance.multiplier);
        if wrong.is_empty() {
            ending = Ending::Settled;
        } else {
            if !seen.insert((closed.clone(), rule)) {
                if matches!(rule, Rule::Pivoting { .. }) {
                    // Pivoting returns to a set if rounding decides signs: it would then repeat without end.
                    break;
                }
                rule = Rule::Pivoting { fewest: wrong.len(), patience: 0, single: false };
            }
            rule.choose(&wrong).iter().for_each(|&row| closed.toggle(row));
        }
    }
    multiplier.iter_mut().for_each(|value| *value = value.min(0.0));
    let variant = match rule {
        _ if ending != Ending::Settled => "-unsettled",
        Rule::Exchange => "",
        Rule::Pivoting { single: false, .. } => "-block-pivoting",
        Rule::Pivoting { single: true, .. } => "-single-pivoting",
    };
    let iterations = history.len();
    Ok(Outcome { displacement, multiplier, contact_set: closed, iterations, history, ending, variant })
}

/// Balance of forces with the rows of `closed` held; `None` if they do not hold the body, or contradict each other.
pub fn with_contact_set(scaled: &ScaledProblem, closed: &ContactSet) -> Result<Option<Equilibrium>> {
    let balance = match by_compliance(scaled, closed, |_| true) {
        None => scaled.hold(closed, WEIGHT)?.map(|cholesky| equilibrium(scaled.problem, &cholesky, closed)),
        balance => balance,
    };
    Ok(balance.filter(|balance| balance.consistent))
}

/// The rule by which the misclassified rows of a set give the next set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Rule {
    /// All misclassified rows change sides.
    Exchange,
    /// All misclassified rows while their number falls, otherwise the last one alone.
    Pivoting { fewest: usize, patience: usize, single: bool },
}

impl Rule {
    fn choose<'a>(&mut self, wrong: &'a [usize]) -> &'a [usize] {
        let Rule::Pivoting { fewest, patience, single } = self else { return wrong };
        if wrong.len() < *fewest {
            (*fewest, *patience) = (wrong.len(), PATIENCE);
            wrong
        } else if *patience > 0 {
            *patience -= 1;
            wrong
        } else {
            *single = true;
            &wrong[wrong.len() - 1..]
        }
    }
}

/// The misclassified rows: open and penetrating, or closed and pulling, beyond rounding and a share of the largest.
fn wrong_rows(
    scaled: &ScaledProblem,
    balance: &Equilibrium,
    closed: &ContactSet,
    share: f64,
) -> impl Iterator<Item = usize> {
    let problem = scaled.problem;
    let Equilibrium { displacement: u, multiplier, along_rows: along, .. } = balance;
    let (gap, reach, strongest) = (problem.gap(), reach(problem, along), share * largest(multiplier));
    let forces = LazyCell::new(move || {
        let mut forces = problem.stiffness().mul_abs(u);
        forces.iter_mut().zip(problem.load()).for_each(|(sum, f)| *sum += f.abs());
        problem.contact().mul_abs(&forces)
    });
    // No entry of a definite matrix is larger than its largest diagonal entry. This bounds the forces without a product
    // of K: few rows pull so little that the forces themselves must be known.
    let most = if scaled.is_definite { MOST_ENTRY * sum_of(u) } else { f64::INFINITY };
    let most_on_rows = MOST_OF_ROW * (u.len() as f64 * most + sum_of(problem.load()));
    let pulls = move |row: usize| {
        let is_beyond = |forces: f64| multiplier[row] > strongest + FORCE_ROUNDING * forces;
        is_beyond(most_on_rows) || is_beyond(0.0) && is_beyond(forces[row])
    };
    (0..problem.rows()).filter(move |&row| match closed.contains(row) {
        false => along[row] - gap[row] > share * (reach + gap[row].abs()),
        true => pulls(row),
    })
}

fn sum_of(values: &[f64]) -> f64 {
    values.iter().map(|value| value.abs()).sum()
}

/// Balance of forces with the rows of a set closed.
#[derive(Clone, Debug)]
pub struct Equilibrium {
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
fn reach(problem: &ContactProblem, along_rows: &[f64]) -> f64 {
    largest(along_rows).max(largest(problem.load()))
}

/// Solves the saddle-point system of the closed rows by corrections with the factorised K + w B_C'B_C:
///
/// ```text
/// (K + w B_C'B_C) du = f + B_C'l - K u + w B_C'(g - B u),     dl = w (g - B u - B du)  on C
/// ```
///
/// The residuals are those of the exact system, so that neither the weight nor redundant rows reduce the accuracy.
fn equilibrium(problem: &ContactProblem, cholesky: &Cholesky, closed: &ContactSet) -> Equilibrium {
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
/// from others. A balance that `is_near` no answer is corrected but once.
fn by_compliance(
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
