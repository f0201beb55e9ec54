//! Rows that are left out, because they depend on those of other bounds: which ones, and what follows if an answer
//! violates them.
//!
//! Most are far away, such as those of all obstacles of a node but the nearest. Their multipliers are zero in the
//! answer, which the certificate checks against all rows. A row that is violated enters. Where a node has no room for
//! it, it takes the force of the rows on which it depends, until one of them has none left: that one leaves. So each
//! exchange raises the least energy, and none comes twice.
//!
//! # Source
//! D. Goldfarb, A. Idnani, *A numerically stable dual method for solving strictly convex quadratic programs*, Math.
//! Program. 27 (1983) 1-33: the ratio test.

use std::collections::{HashMap, HashSet};

use crate::linear::largest;
use crate::method::bounds::{Bounds, LeftOut};
use crate::method::{Ending, Outcome, Start};
use crate::problem::ContactProblem;

/// The rows that enter, and the force at which each row under pressure leaves.
pub struct Exchange {
    entering: Vec<usize>,
    leaving: HashMap<usize, f64>,
    /// The ending of the loop if no displacement meets some rows together.
    pub contradiction: Option<Ending>,
}

impl Exchange {
    /// The exchange after an answer; `None` if it violates no row that was left out by more than this share of its
    /// largest entry.
    pub fn of(problem: &ContactProblem, bounds: &Bounds, answer: &Outcome, share: f64) -> Option<Self> {
        if bounds.left_out.is_empty() {
            return None;
        }
        let (room, least) = (room(problem, Some(&answer.displacement)), -share * largest(&answer.displacement));
        let mut violated: Vec<&LeftOut> = bounds.left_out.iter().filter(|left| room[left.row] < least).collect();
        violated.sort_by(|a, b| room[a.row].total_cmp(&room[b.row]));
        let (mut entering, mut leaving, mut met) = (Vec::new(), HashMap::new(), HashSet::new());
        let mut contradiction = None;
        for left in violated {
            // One at a time on the same bounds.
            if left.shares.iter().all(|entry| !met.contains(&entry.0)) {
                met.extend(left.shares.iter().map(|entry| entry.0));
                entering.push(left.row);
                leaving.extend(bounds.relieved(left, &answer.multiplier));
                if let Some(all) = bounds.contradicting(left, &answer.multiplier).filter(|_| contradiction.is_none()) {
                    let (rows, weights): (Vec<usize>, Vec<f64>) = all.into_iter().unzip();
                    let is_proven = problem.overlap(&rows, &weights).is_some();
                    contradiction = is_proven.then_some(Ending::Infeasible { rows, weights });
                }
            }
        }
        (!entering.is_empty()).then_some(Exchange { entering, leaving, contradiction })
    }

    /// The start from the answer, with the rows that enter closed.
    pub fn start(&self, answer: &Outcome) -> Start {
        let mut closed = answer.contact_set.clone();
        self.entering.iter().for_each(|&row| closed.insert(row));
        Start { displacement: Some(answer.displacement.clone()), contact_set: Some(closed) }
    }
}

/// The order of all rows: those that enter, those that the start closes, then the nearest of the others; and the number
/// of the first two, which are needed.
pub fn order(problem: &ContactProblem, start: &Start, exchange: Option<&Exchange>) -> (Vec<usize>, usize) {
    let mut preference: Vec<(u8, f64)> =
        room(problem, start.displacement.as_deref()).into_iter().map(|room| (2, room)).collect();
    for row in start.contact_set.iter().flat_map(|closed| closed.iter()) {
        let leaves = exchange.and_then(|exchange| exchange.leaving.get(&row));
        preference[row] = (1, leaves.copied().unwrap_or(f64::NEG_INFINITY));
    }
    for &row in exchange.iter().flat_map(|exchange| &exchange.entering) {
        preference[row].0 = 0;
    }
    let needed = preference.iter().filter(|of_row| of_row.0 < 2).count();
    let mut rows: Vec<usize> = (0..problem.rows()).collect();
    rows.sort_by(|&a, &b| preference[a].0.cmp(&preference[b].0).then(preference[a].1.total_cmp(&preference[b].1)));
    (rows, needed)
}

/// The distance to the bound of each row at a displacement or at rest, divided by the length of the row.
fn room(problem: &ContactProblem, displacement: Option<&[f64]>) -> Vec<f64> {
    let mut lengths = vec![0.0_f64; problem.rows()];
    problem.contact().triplets().for_each(|(row, _, b)| lengths[row] = lengths[row].hypot(b));
    let room = match displacement {
        Some(displacement) => problem.violation(displacement).iter().map(|violation| -violation).collect(),
        None => problem.gap().to_vec(),
    };
    room.iter().zip(&lengths).map(|(room, length)| room / length).collect()
}
