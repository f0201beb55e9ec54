//! The preconditioner of travels: unknowns without stiffness, which only closed rows hold.
//!
//! In a face each travel has a displacement z: it travels by one, the unknowns of its closed rows stay at their bounds,
//! and the body follows nearly in balance. Beside the cycle C, which moves no travel, z is a coarse space of its own:
//!
//! ```text
//! M r = z z'r / e + (I - z z'K / e) C (I - K z z' / e) r,     e = z'K z
//! ```
//!
//! # Source
//! J. Mandel, *Balancing domain decomposition*, Comm. Numer. Methods Engrg. 9 (1993) 233-241.

use super::iterate::{BoundedIterate, Move};
use crate::linear::dot;
use crate::linear::multigrid::{Face, Units};
use crate::method::bounds::Bounds;
use crate::problem::ContactProblem;

/// Rows of at most this number of dofs, a travel among them, become bounds whatever their nodes are.
const FEW_DOFS: usize = 7;

/// Returns `true` if every dof without stiffness is a travel: the stiffness holds all others, and each row becomes a
/// bound with at most one travel.
pub fn takes_travels(problem: &ContactProblem) -> bool {
    let travels = problem.without_stiffness();
    let all: Vec<usize> = (0..problem.rows()).collect();
    let has_row = |&travel: &usize| problem.contact().column(travel).any(|(_, share)| share != 0.0);
    travels.is_empty()
        || (problem.near_null().is_some()
            && travels.iter().all(has_row)
            && !problem.has_free_mode()
            && Bounds::of((problem.contact(), problem.gap()), (&all, 0), &units(problem), travels).is_ok())
}

/// The nodes, if a row has more than [`FEW_DOFS`] dofs; otherwise each dof alone.
fn units(problem: &ContactProblem) -> Units {
    let by_row = problem.contact().transposed();
    match (0..problem.rows()).any(|row| by_row.column(row).count() > FEW_DOFS) {
        true => Units::by_pattern(problem.stiffness()),
        false => Units::alone(problem.dofs()),
    }
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
