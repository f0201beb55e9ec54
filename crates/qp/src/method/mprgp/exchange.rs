//! What bounds leave over: rows that depend on others, and travels, unknowns without stiffness.

use std::collections::{HashMap, HashSet};

use super::iterate::{BoundedIterate, Move};
use crate::linear::multigrid::{Face, Units};
use crate::linear::{dot, largest};
use crate::method::bounds::{Bounds, LeftOut};
use crate::method::{Ending, Outcome, Start};
use crate::problem::ContactProblem;

/// The rows that enter, and the force at which each row under pressure leaves.
/// Most are far away, such as those of all obstacles of a node but the nearest. Their multipliers are zero in the
/// answer, which the certificate checks against all rows. A row that is violated enters. Where a node has no room for
/// it, it takes the force of the rows on which it depends, until one of them has none left: that one leaves. So each
/// exchange raises the least energy, and none comes twice.
///
/// # Source
/// D. Goldfarb, A. Idnani, *A numerically stable dual method for solving strictly convex quadratic programs*, Math.
/// Program. 27 (1983) 1-33: the ratio test.
pub struct Exchange {
    entering: Vec<usize>,
    leaving: HashMap<usize, f64>,
    /// The ending of the loop if no displacement meets some rows together.
    pub contradiction: Option<Ending>,
}

impl Exchange {
    /// The exchange after an answer; `None` if it violates no row left out by more than this share of its largest
    /// entry.
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

/// The order of all rows: those that enter, those that the start closes, the others by room; and how many are needed.
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

/// Rows of at most this number of dofs, a travel among them, become bounds whatever their nodes are.
const FEW_DOFS: usize = 7;

/// Returns `true` if each dof without stiffness is a travel: K holds the others, and rows are bounds of one at most.
pub fn takes_travels(problem: &ContactProblem) -> bool {
    let travels = problem.without_stiffness();
    let all: Vec<usize> = (0..problem.rows()).collect();
    let has_row = |&travel: &usize| problem.contact().column(travel).any(|(_, share)| share != 0.0);
    travels.is_empty()
        || (problem.near_null().is_some()
            && travels.iter().all(has_row)
            && problem.free_motions() == 0
            && Bounds::of((problem.contact(), problem.gap()), (&all, 0), &units(problem), travels).is_ok())
}

/// The nodes, if a row has more than [`FEW_DOFS`] dofs; otherwise each dof alone.
fn units(problem: &ContactProblem) -> Units {
    let by_row = problem.contact().transposed();
    let has_long = (0..problem.rows()).any(|row| by_row.column(row).count() > FEW_DOFS);
    if has_long { Units::by_pattern(problem.stiffness()) } else { Units::alone(problem.dofs()) }
}

/// The displacements z of all travels in another face, orthogonal in energy: they start from those of the last one, and
/// one cycle takes them nearer to balance. Without energy, no closed row holds the travel.
pub fn in_face(before: Vec<Move>, iterate: &BoundedIterate, face: &Face) -> Vec<Move> {
    let (mut before, mut moves) = (before.into_iter(), Vec::<Move>::new());
    for &travel in &iterate.bounds.travels {
        let mut way = before.next().map_or_else(|| iterate.alone(travel), |last| last.way);
        iterate.keep_free(&mut way);
        if way[travel] == 0.0 {
            // A bound of its own stops the travel.
            way = vec![0.0; way.len()];
        } else if iterate.is_held(travel) {
            let mut force = iterate.product(&way);
            iterate.keep_free(&mut force);
            let step = iterate.preconditioned(face, &force);
            way.iter_mut().zip(step).for_each(|(way, step)| *way -= step);
        } else {
            way = iterate.alone(travel);
        }
        for other in moves.iter().filter(|other| other.energy > 0.0) {
            let share = dot(&other.force, &way) / other.energy;
            way.iter_mut().zip(&other.way).for_each(|(way, other)| *way -= share * other);
        }
        moves.push(Move::of(way, iterate));
    }
    moves
}

/// M r for the free gradient r; the way of a travel that nothing holds, if a force drives it.
///
/// In a face each travel has a displacement z: it travels by one, the unknowns of its closed rows stay at their bounds,
/// and the body follows nearly in balance. Beside the cycle C, which moves no travel, z is a coarse space of its own:
///
/// ```text
/// M r = z z'r / e + (I - z z'K / e) C (I - K z z' / e) r,     e = z'K z
/// ```
///
/// # Source
/// J. Mandel, *Balancing domain decomposition*, Comm. Numer. Methods Engrg. 9 (1993) 233-241.
pub fn preconditioned(moves: &[Move], iterate: &BoundedIterate, face: &Face, gradient: &[f64]) -> Vec<f64> {
    if let Some(free) = moves.iter().find(|free| free.energy == 0.0 && dot(&free.way, gradient) != 0.0) {
        let work = dot(&free.way, gradient).signum();
        return free.way.iter().map(|way| work * way).collect();
    }
    if moves.is_empty() {
        return iterate.preconditioned(face, gradient);
    }
    let mut rest = iterate.work.copy(gradient);
    let held = || moves.iter().filter(|held| held.energy > 0.0);
    let shares: Vec<f64> = held().map(|held| dot(&held.way, gradient) / held.energy).collect();
    for (held, share) in held().zip(&shares) {
        rest.iter_mut().zip(&held.force).for_each(|(rest, force)| *rest -= share * force);
    }
    iterate.keep_free(&mut rest);
    let mut step = iterate.preconditioned(face, &rest);
    iterate.work.give(rest);
    for (held, share) in held().zip(&shares) {
        let share = share - dot(&held.force, &step) / held.energy;
        step.iter_mut().zip(&held.way).for_each(|(step, way)| *step += share * way);
    }
    step
}
