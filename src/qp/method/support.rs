//! Checks whether a set of closed rows holds the body; if not, finds the direction along which it is free, and whether the
//! load drives it.

use super::scaled::ScaledProblem;
use crate::error::Error;
use crate::qp::linear::{Cholesky, FactorError, largest};
use crate::solution::ContactSet;

/// Shifts that make a singular matrix definite, smallest first.
const SHIFTS: [f64; 3] = [1e-12, 1e-10, 1e-8];

/// Projections of the load: each gains several digits, since eigenvalues differ by many orders of magnitude.
const STEPS: usize = 5;

/// Work of the load on a free mode, and other sums over a mode, are rounding below this share of their own terms.
const WORK_TOLERANCE: f64 = 1e-9;

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
pub enum Support {
    /// They do; the factorisation of K + w B_C'B_C.
    Held(Cholesky),
    /// They do not.
    Free(FreeMode),
    /// The energy is negative along some direction.
    Indefinite,
}

/// A direction d with K d = 0 and B_C d = 0, largest entry one.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeMode {
    /// The direction, one entry per dof.
    pub direction: Vec<f64>,
    /// `true` if the load does work on it: `f'd > 0`.
    pub driven: bool,
}

impl ScaledProblem<'_> {
    /// The start of a loop: C = 0 if K is definite; otherwise all rows are replaced by springs, which hold the body, and those
    /// in compression are closed. `None` if not even all rows together hold the body, or if K is not positive semidefinite to
    /// the largest of the shifts.
    ///
    /// # Errors
    /// [`Error::Numerical`] for lack of memory.
    pub fn start(&self) -> Result<Option<ContactSet>, Error> {
        let (rows, nothing_closed) = (self.problem.rows(), ContactSet::open(self.problem.rows()));
        if self.is_definite() {
            return Ok(Some(nothing_closed));
        }
        match self.factor(self.matrix(&nothing_closed, 0.0, SHIFTS[SHIFTS.len() - 1])) {
            Ok(_) => {}
            Err(FactorError::NotPositiveDefinite) => return Ok(None),
            Err(error) => return Err(error.into()),
        }
        Ok(match self.hold(&ContactSet::closed(rows), 1.0)? {
            Support::Held(cholesky) => {
                let pull = self.problem.contact().mul_transposed(self.problem.gap());
                let force: Vec<f64> = self.problem.load().iter().zip(&pull).map(|(f, g)| f + g).collect();
                let violation = self.problem.violation(&cholesky.solve(&force));
                Some(ContactSet::from_fn(rows, |row| violation[row] > 0.0))
            }
            Support::Free(_) | Support::Indefinite => None,
        })
    }

    /// Factorises K + weight B_C'B_C and checks whether it is definite.
    ///
    /// # Errors
    /// [`Error::Numerical`] for lack of memory.
    pub fn hold(&self, closed: &ContactSet, weight: f64) -> Result<Support, Error> {
        let matrix = self.matrix(closed, weight, 0.0);
        // If K is definite by itself, this is not checked again.
        let looked_at = (!self.is_definite()).then(|| matrix.clone());
        match self.factor(matrix) {
            Ok(cholesky) if looked_at.is_none_or(|matrix| cholesky.is_definite(&matrix)) => Ok(Support::Held(cholesky)),
            Ok(_) | Err(FactorError::NotPositiveDefinite) => {
                Ok(self.free_mode(closed, weight)?.map_or(Support::Indefinite, Support::Free))
            }
            Err(error) => Err(error.into()),
        }
    }

    /// The projection of the load onto the null space or, if the load does no work there, any null vector; `None` if no shift makes
    /// the matrix definite.
    fn free_mode(&self, closed: &ContactSet, weight: f64) -> Result<Option<FreeMode>, Error> {
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
            return Ok(Some(FreeMode { direction, driven }));
        }
        Ok(None)
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
    fn approach(&self, direction: &[f64]) -> Vec<f64> {
        let terms = self.problem.contact().mul_abs(direction);
        let speed = self.problem.contact().mul(direction);
        speed.iter().zip(&terms).map(|(&v, term)| if v.abs() > WORK_TOLERANCE * term { v } else { 0.0 }).collect()
    }
}
