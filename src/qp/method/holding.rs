//! Checks whether a set of closed rows holds the body; if not, finds the direction along which it is free, and whether the
//! load drives it.

use super::scaled::{Outcome, ScaledProblem, multiplier_rounding};
use crate::error::Error;
use crate::qp::linear::{Cholesky, FactorError, largest};
use crate::solution::ContactSet;

/// Shifts that make a singular matrix definite, smallest first.
const SHIFTS: [f64; 3] = [1e-12, 1e-10, 1e-8];

/// Projections of the load: each gains several digits, since eigenvalues differ by many orders of magnitude.
const STEPS: usize = 5;

/// Work of the load on a free mode, and other sums over a mode, are rounding below this share of their own terms.
pub(crate) const WORK_TOLERANCE: f64 = 1e-9;

/// A row this close to the obstacle, for displacements of order one, has no play.
pub(super) const PLAY: f64 = 1e-9;

/// Entries of a null vector with largest entry one, and forces on a diagonal of order one, below this are rounding.
const NOISE: f64 = 1e-13;

/// The vector with largest entry one and without the entries that are rounding.
fn normalised(mut direction: Vec<f64>) -> Vec<f64> {
    let size = largest(&direction);
    direction.iter_mut().for_each(|value| *value = if value.abs() > NOISE * size { *value / size } else { 0.0 });
    direction
}

/// States whether the closed rows hold the body.
#[derive(Debug)]
pub enum Holding {
    /// They do; the factorisation of K + w B_C'B_C.
    Held(Cholesky),
    /// They do not.
    Free(FreeMode),
}

/// A direction d with K d = 0 and B_C d = 0, largest entry one.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeMode {
    /// The direction, one entry per dof.
    pub direction: Vec<f64>,
    /// `true` if the load does work on it: `f'd > 0`.
    pub driven: bool,
}

impl FreeMode {
    /// The error for this mode if no row stops it.
    pub fn into_error(self) -> Error {
        let mode = where_largest(&self.direction);
        match self.driven {
            true => Error::Unbounded { mode, direction: self.direction },
            false => Error::UnderHeld { mode, direction: self.direction },
        }
    }
}

/// The places of the largest entries of a direction, in words.
pub(super) fn where_largest(direction: &[f64]) -> String {
    let mut entries: Vec<(usize, f64)> = direction.iter().copied().enumerate().collect();
    entries.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let named: Vec<String> = entries.iter().take(3).filter(|e| e.1 != 0.0).map(|e| e.0.to_string()).collect();
    format!("mainly at dof {} (indices from 0)", named.join(", "))
}

impl ScaledProblem<'_> {
    /// The start of a loop: C = 0 if K is definite; otherwise all rows are replaced by springs, which hold the body, and those
    /// in compression are closed.
    ///
    /// # Errors
    /// [`Error::Unbounded`] and [`Error::UnderHeld`] for a mode that not even all rows together hold,
    /// [`Error::NotConvex`].
    pub fn start(&self) -> Result<ContactSet, Error> {
        let rows = self.problem.rows();
        if self.is_definite() {
            return Ok(ContactSet::open(rows));
        }
        self.check_convex()?;
        match self.hold(&ContactSet::closed(rows), 1.0)? {
            Holding::Held(cholesky) => {
                let pull = self.problem.contact().mul_transposed(self.problem.gap());
                let force: Vec<f64> = self.problem.load().iter().zip(&pull).map(|(f, g)| f + g).collect();
                let violation = self.problem.violation(&cholesky.solve(&force));
                Ok(ContactSet::from_fn(rows, |row| violation[row] > 0.0))
            }
            Holding::Free(mode) => Err(mode.into_error()),
        }
    }

    /// Checks that the answer is unique. It is if K and the rows under pressure hold the body; if they leave a mode, the open
    /// rows must stop it both ways without play.
    ///
    /// # Errors
    /// [`Error::UnderHeld`] with a mode that changes neither force nor energy.
    pub fn check_unique(&self, outcome: &Outcome) -> Result<(), Error> {
        if self.is_definite() {
            return Ok(());
        }
        let rounding = multiplier_rounding(self.problem, &outcome.displacement, &outcome.multiplier);
        let pressed = ContactSet::from_fn(self.problem.rows(), |row| outcome.multiplier[row] < -rounding[row]);
        match self.hold(&pressed, 1.0)? {
            Holding::Held(_) => Ok(()),
            Holding::Free(mode) if mode.driven => Ok(()),
            Holding::Free(mode) => {
                let violation = self.problem.violation(&outcome.displacement);
                let approach = self.approach(&mode.direction);
                let is_free = self.costs_nothing(&mode.direction) && pressed.iter().all(|row| approach[row] == 0.0);
                let stopped =
                    |way: f64| (0..self.problem.rows()).any(|row| approach[row] * way > 0.0 && violation[row] > -PLAY);
                if !is_free || stopped(1.0) && stopped(-1.0) { Ok(()) } else { Err(mode.into_error()) }
            }
        }
    }

    /// Checks that K is positive semidefinite to the largest of the shifts.
    ///
    /// # Errors
    /// [`Error::NotConvex`] if not, [`Error::Numerical`] for lack of memory.
    pub(super) fn check_convex(&self) -> Result<(), Error> {
        let nothing_closed = ContactSet::open(self.problem.rows());
        self.factor(self.matrix(&nothing_closed, 0.0, SHIFTS[SHIFTS.len() - 1])).map(|_| ()).map_err(Error::from)
    }

    /// Factorises K + weight B_C'B_C and checks whether it is definite.
    ///
    /// # Errors
    /// [`Error::NotConvex`] if K has a negative eigenvalue, [`Error::Numerical`] for lack of memory.
    pub fn hold(&self, closed: &ContactSet, weight: f64) -> Result<Holding, Error> {
        let matrix = self.matrix(closed, weight, 0.0);
        // If K is definite by itself, this is not checked again.
        let looked_at = (!self.is_definite()).then(|| matrix.clone());
        match self.factor(matrix) {
            Ok(cholesky) if looked_at.is_none_or(|matrix| cholesky.is_definite(&matrix)) => Ok(Holding::Held(cholesky)),
            Ok(_) | Err(FactorError::NotPositiveDefinite) => self.free_mode(closed, weight).map(Holding::Free),
            Err(error) => Err(error.into()),
        }
    }

    /// The projection of the load onto the null space or, if the load does no work there, any null vector.
    fn free_mode(&self, closed: &ContactSet, weight: f64) -> Result<FreeMode, Error> {
        // A weight does not change the null vectors, and a large one hides the shift in its rounding.
        let weight = weight.min(1.0);
        for shift in SHIFTS {
            let cholesky = match self.factor(self.matrix(closed, weight, shift)) {
                Ok(cholesky) => cholesky,
                Err(FactorError::NotPositiveDefinite) => continue,
                Err(error) => return Err(error.into()),
            };
            let mut projected = self.problem.load().to_vec();
            for _ in 0..STEPS {
                projected = cholesky.solve(&projected);
                projected.iter_mut().for_each(|value| *value *= shift);
            }
            let projected = normalised(projected);
            let still = self.matrix(closed, weight, 0.0).mul(&projected);
            let driven = largest(&still) <= NOISE && self.problem.share_of_work(&projected) > WORK_TOLERANCE;
            let direction = if driven { projected } else { normalised(cholesky.softest_vector()) };
            return Ok(FreeMode { direction, driven });
        }
        Err(Error::NotConvex { evidence: "a Cholesky pivot is negative".into() })
    }

    /// The open rows that stop a mode first, if it starts from `displacement`; a mode that the load does not drive may go
    /// either way. `None` if no row stops it.
    pub(super) fn stopping_rows(
        &self,
        mode: &FreeMode,
        displacement: &[f64],
        closed: &ContactSet,
    ) -> Option<ContactSet> {
        let approach = self.approach(&mode.direction);
        let violation = self.problem.violation(displacement);
        let ways: &[f64] = if mode.driven { &[1.0] } else { &[1.0, -1.0] };
        for way in ways {
            let time = |row: usize| match approach[row] * way {
                speed if speed > 0.0 && !closed.contains(row) => Some((-violation[row]).max(0.0) / speed),
                _ => None,
            };
            let first = (0..self.problem.rows()).filter_map(time).fold(f64::INFINITY, f64::min);
            if first.is_finite() {
                let mut stopped = closed.clone();
                (0..self.problem.rows())
                    .filter(|&row| time(row).is_some_and(|t| t <= first * (1.0 + WORK_TOLERANCE)))
                    .for_each(|row| stopped.insert(row));
                return Some(stopped);
            }
        }
        None
    }

    /// The rate at which each row closes on a mode: B d, zero if it is rounding of its own terms.
    pub(super) fn approach(&self, direction: &[f64]) -> Vec<f64> {
        let terms = self.problem.contact().mul_abs(direction);
        let speed = self.problem.contact().mul(direction);
        speed.iter().zip(&terms).map(|(&v, term)| if v.abs() > WORK_TOLERANCE * term { v } else { 0.0 }).collect()
    }

    /// Returns `true` if a mode with largest entry one costs no energy: at each dof `K d` is rounding of its own terms, or of
    /// the force that moves this dof alone.
    pub(super) fn costs_nothing(&self, direction: &[f64]) -> bool {
        let stiffness = self.problem.stiffness();
        let (force, terms, alone) = (stiffness.mul(direction), stiffness.mul_abs(direction), stiffness.diagonal());
        (0..force.len()).all(|dof| force[dof].abs() <= WORK_TOLERANCE * terms[dof].max(alone[dof]))
    }

    /// Returns `true` if an error's claim about a mode holds in the terms of each dof and row. The mode was found by sums of
    /// squares, which lose terms that are small beside others.
    pub fn is_true(&self, claim: &Error) -> bool {
        let stops = |direction: &[f64], way: f64| self.approach(direction).iter().any(|&speed| speed * way > 0.0);
        match claim {
            Error::UnderHeld { direction, .. } => {
                self.costs_nothing(direction) && !(stops(direction, 1.0) && stops(direction, -1.0))
            }
            Error::Unbounded { direction, .. } => self.costs_nothing(direction) && !stops(direction, 1.0),
            _ => true,
        }
    }

    /// Returns `true` if a claim needs no further check because the mode opens every row: the rows can then be met together,
    /// and none can balance the load.
    pub fn is_evident(&self, claim: &Error) -> bool {
        let (Error::UnderHeld { direction, .. } | Error::Unbounded { direction, .. }) = claim else { return false };
        let opens = |way: f64| self.approach(direction).iter().all(|&speed| speed * way < 0.0);
        self.is_true(claim) && (opens(1.0) || matches!(claim, Error::UnderHeld { .. }) && opens(-1.0))
    }
}
