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

use std::cell::LazyCell;
use std::collections::HashSet;

use super::equilibrium::{Equilibrium, WEIGHT, by_compliance, equilibrium, reach};
use super::{Ending, Outcome, SIGN_TOLERANCE, ScaledProblem};
use crate::error::Error;
use crate::linear::largest;
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

/// Runs the loop on a scaled problem from the contact set `closed`, over at most `most_iterations` sets, each with a
/// factorisation.
pub fn solve(scaled: &ScaledProblem, mut closed: ContactSet, most_iterations: usize) -> Result<Outcome, Error> {
    let (mut displacement, mut multiplier) = (vec![0.0; scaled.problem.dofs()], vec![0.0; scaled.problem.rows()]);
    let (mut history, mut seen) = (Vec::new(), HashSet::new());
    let (mut rule, mut ending) = (Rule::Exchange, Ending::Unsettled);
    let is_over = |done: usize| done > 0 && scaled.watch.is_over();
    while ending == Ending::Unsettled && history.len() < most_iterations && !is_over(history.len()) {
        scaled.watch.step("active set", history.len() + 1);
        let balance = match balance(scaled, &mut closed, &displacement)? {
            Ok(balance) => balance,
            Err(without) => {
                ending = without;
                break;
            }
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

/// The balance of `closed`, from a displacement `near` it, once the rows that hold the body have joined the set: by the
/// compliance of the rows if they do not follow from each other, otherwise by a factor of its own. The ending of the
/// loop if there is none.
fn balance(
    scaled: &ScaledProblem,
    closed: &mut ContactSet,
    near: &[f64],
) -> Result<Result<Equilibrium, Ending>, Error> {
    let is_near = |balance: &Equilibrium| wrong_rows(scaled, balance, closed, CLEARLY).next().is_none();
    if let Some(balance) = by_compliance(scaled, closed, is_near) {
        return Ok(Ok(balance));
    }
    let cholesky = scaled.hold_with_more(closed, WEIGHT, near)?;
    Ok(cholesky.map(|cholesky| equilibrium(scaled.problem, &cholesky, closed)))
}

/// Balance of forces with the rows of `closed` held at their gaps, pushing or pulling, and all others free; `None` if
/// they do not hold the body, or contradict each other.
pub fn with_contact_set(scaled: &ScaledProblem, closed: &ContactSet) -> Result<Option<Equilibrium>, Error> {
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

/// The misclassified rows: open and penetrating, or closed and pulling, beyond rounding and beyond a share of the
/// largest displacement or multiplier.
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
