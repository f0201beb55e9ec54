//! MPRGP: modified proportioning with reduced gradient projections, preconditioned in the free face.
//!
//! Rows are turned into bounds by reflections. With the gradient g = K u - f, split into the free gradient, of unknowns
//! that may move, and the chopped gradient, of those that want to leave their bound, an iteration is one of
//!
//! ```text
//! proportioning   where the chopped gradient outweighs the free one: a step along it, which opens rows
//! CG step         along conjugate directions of the free face, one cycle of the hierarchy each
//! expansion       where the CG step would cross bounds: its projection, which closes rows; should that raise the energy,
//!                 the step to the first bound and a projected gradient step of fixed length
//! ```
//!
//! The energy falls in every one of them. The hierarchy is built once, for K; a face is a small change of it.
//!
//! # Source
//! Z. Dostál, *Optimal Quadratic Programming Algorithms*, Springer (2009), algorithm 5.8 and section 5.10.

mod iterate;
mod nested;
mod uniqueness;

use super::bounds::Bounds;
use super::{Outcome, Solver, Start};
use crate::error::Error;
use crate::qp::linear::multigrid::{Face, Multigrid};
use crate::qp::problem::ContactProblem;
use crate::watch::Watch;
use iterate::{Conjugate, Iterate};
use nested::nested_start;

/// Iterations without a residual half as large as the best before, after which the loop has stagnated; those in which the
/// face changes count only beyond one for each row.
const PATIENCE: usize = 60;

/// A residual in twice the precision that is above this share of the one before will not come down any more.
const NO_GAIN: f64 = 0.5;

/// When the loop ends.
#[derive(Clone, Copy, Debug)]
pub struct Limits<'a> {
    /// Largest imbalance of forces and largest wrong-signed multiplier, relative to the largest force.
    pub tolerance: f64,
    /// Most cycles of the hierarchy.
    pub most_cycles: usize,
    /// Whether it must end before, with what it has.
    pub watch: &'a Watch,
}

/// MPRGP on a problem as it came, with the hierarchy of its stiffness.
pub struct Mprgp<'a> {
    /// The problem.
    pub problem: &'a ContactProblem,
    /// The hierarchy.
    pub multigrid: &'a Multigrid,
    /// When the loop ends.
    pub limits: Limits<'a>,
}

impl Solver for Mprgp<'_> {
    fn solve(&self, start: Start) -> Result<Outcome, Error> {
        solve(self.problem, self.multigrid, start, self.limits)
    }
}

/// Finds displacement, multipliers and contact set; `iterations` counts the cycles of the hierarchy.
///
/// The loop is finite: it ends at the limits, where only rounding is left, or, as `-stagnated`, where 60 iterations together
/// do not halve the residual; those that change the face count only beyond one for each row.
///
/// # Errors
/// [`Error::Numerical`] for rows that no turning makes bounds of, [`Error::NotConvex`] for a direction of negative energy
/// in a face, [`Error::Unbounded`] for a load that drives a motion which no row stops, [`Error::UnderHeld`] for a motion
/// that the rows under pressure leave free.
fn solve(problem: &ContactProblem, multigrid: &Multigrid, start: Start, limits: Limits) -> Result<Outcome, Error> {
    let bounds = Bounds::of(problem.contact(), problem.gap())?;
    let nested = if start.is_unknown() { nested_start(problem, &bounds, multigrid, limits) } else { None };
    let start = nested.map_or(start, Start::near);
    let mut iterate = Iterate::new(problem, &bounds, start, multigrid.threads());
    let mut history = vec![iterate.step()];
    let mut face: Option<Face> = None;
    let mut face_is_old = false;
    let mut last: Option<Conjugate> = None;
    let (mut cycles, mut settled) = (0, false);
    let (mut best, mut since_best, mut changes, mut is_fresh) = (f64::INFINITY, 0, 0, true);
    let mut last_checked = f64::INFINITY;
    let is_late = || limits.watch.is_over();
    while cycles < limits.most_cycles && since_best < PATIENCE + changes.min(problem.rows()) && !is_late() {
        let residual = iterate.residual();
        if residual <= limits.tolerance {
            if is_fresh {
                settled = true;
                break;
            }
            // What the steps have carried along is checked before it is believed.
            iterate.refresh_gradient_accurately();
            let checked = iterate.residual();
            if checked > NO_GAIN * last_checked {
                // Rounding of the displacement is all that is left.
                settled = true;
                break;
            }
            (is_fresh, last, last_checked) = (true, None, checked);
            continue;
        }
        is_fresh = false;
        since_best += 1;
        if residual < 0.5 * best {
            (best, since_best, changes) = (residual, 0, 0);
        }
        let before = iterate.at.clone();
        if iterate.is_disproportionate() {
            iterate.proportion();
        } else {
            let gradient = iterate.free_gradient();
            let free_face = match face.take() {
                Some(free_face) if !face_is_old => free_face,
                old => multigrid.face(&iterate.held(), old.as_ref())?,
            };
            face_is_old = false;
            let step = iterate.preconditioned(&free_face, &gradient);
            face = Some(free_face);
            cycles += 1;
            limits.watch.step("MPRGP", cycles);
            let direction = Conjugate::of(step, last.take(), &gradient, &iterate);
            if direction.is_free {
                return Err(iterate.free_motion(direction.p));
            }
            if direction.energy < 0.0 {
                return Err(iterate.negative_energy(direction));
            }
            last = iterate.advance(direction);
        }
        if iterate.at != before {
            (face_is_old, last) = (true, None);
            changes += 1;
            history.push(iterate.step());
        }
    }
    match settled {
        true => iterate.check_unique(multigrid)?,
        false => iterate.check_bounded(multigrid)?,
    }
    let (multiplier, contact_set) = bounds.multipliers(|index| iterate.held_gradient(index));
    let mut displacement = iterate.x;
    bounds.turn_back(&mut displacement);
    let variant = match settled {
        true => "",
        false if cycles >= limits.most_cycles || is_late() => "-unsettled",
        false => "-stagnated",
    };
    Ok(Outcome { displacement, multiplier, contact_set, iterations: cycles, history, settled, variant })
}
