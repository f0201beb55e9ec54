//! Checks whether a set of closed rows holds the body; if not, finds the direction along which it is free, and whether
//! the load drives it.

use super::scaled::{Ending, ScaledProblem};
use crate::error::Error;
use crate::linear::{Cholesky, largest};
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

impl ScaledProblem<'_> {
    /// The start of a loop: C = 0 if K is definite; otherwise all rows are replaced by springs, which hold the body,
    /// and those in compression are closed. `None` if not even all rows together hold the body, or if K is not positive
    /// semidefinite to the largest of the shifts.
    pub fn start(&self) -> Result<Option<ContactSet>, Error> {
        let (rows, nothing_closed) = (self.problem.rows(), ContactSet::open(self.problem.rows()));
        if self.is_definite {
            return Ok(Some(nothing_closed));
        }
        if self.factor(self.matrix(&nothing_closed, 0.0, SHIFTS[SHIFTS.len() - 1])?)?.is_none() {
            return Ok(None);
        }
        let Some(cholesky) = self.hold(&ContactSet::closed(rows), 1.0)? else { return Ok(None) };
        let pull = self.problem.contact().mul_transposed(self.problem.gap());
        let force: Vec<f64> = self.problem.load().iter().zip(&pull).map(|(f, g)| f + g).collect();
        let violation = self.problem.violation(&cholesky.solve(&force));
        Ok(Some(ContactSet::from_fn(rows, |row| violation[row] > 0.0)))
    }

    /// The factor of K + weight B_C'B_C; `None` if the rows of C do not hold the body.
    pub fn hold(&self, closed: &ContactSet, weight: f64) -> Result<Option<Cholesky>, Error> {
        let matrix = self.matrix(closed, weight, 0.0)?;
        // If K is definite by itself, this is not checked again.
        let looked_at = (!self.is_definite).then(|| matrix.clone());
        let holds = |cholesky: &Cholesky| looked_at.is_none_or(|matrix| cholesky.is_definite(&matrix));
        Ok(self.factor(matrix)?.filter(holds))
    }

    /// The same, once those rows have joined C that stop its free modes from `displacement`. The ending of a loop if
    /// there is no factor: no row stops a mode, the energy is negative along some direction, or time is over.
    pub fn hold_with_more(
        &self,
        closed: &mut ContactSet,
        weight: f64,
        displacement: &[f64],
    ) -> Result<Result<Cholesky, Ending>, Error> {
        loop {
            if let Some(cholesky) = self.hold(closed, weight)? {
                return Ok(Ok(cholesky));
            }
            let mode = self.free_mode(closed, weight)?;
            if !mode.is_some_and(|(mode, is_driven)| self.stop(&mode, is_driven, displacement, closed)) {
                return Ok(Err(Ending::Unheld));
            }
            if self.watch.is_over() {
                return Ok(Err(Ending::Unsettled));
            }
        }
    }

    /// A direction d with K d = 0 and B_C d = 0, largest entry one, and whether the load does work on it, `f'd > 0`:
    /// the projection of the load onto the null space or, if the load does no work there, any null vector. `None` if no
    /// shift makes the matrix definite.
    fn free_mode(&self, closed: &ContactSet, weight: f64) -> Result<Option<(Vec<f64>, bool)>, Error> {
        // A weight does not change the null vectors, and a large one hides the shift in its rounding.
        let weight = weight.min(1.0);
        for shift in SHIFTS {
            let Some(cholesky) = self.factor(self.matrix(closed, weight, shift)?)? else { continue };
            let mut projected = self.problem.load().to_vec();
            for _ in 0..STEPS {
                projected = cholesky.solve(&projected);
                projected.iter_mut().for_each(|value| *value *= shift);
            }
            let projected = normalised(projected);
            let still = self.matrix(closed, weight, 0.0)?.mul(&projected);
            let is_driven = largest(&still) <= NOISE && self.problem.share_of_work(&projected) > WORK_TOLERANCE;
            let direction = if is_driven { projected } else { normalised(cholesky.softest_vector()) };
            return Ok(Some((direction, is_driven)));
        }
        Ok(None)
    }

    /// Closes the open rows that stop a mode first, if it starts from `displacement`; a mode that the load does not
    /// drive may go either way. Returns `false` if no row stops it.
    fn stop(&self, mode: &[f64], is_driven: bool, displacement: &[f64], closed: &mut ContactSet) -> bool {
        let (contact, violation) = (self.problem.contact(), self.problem.violation(displacement));
        let (speed, terms) = (contact.mul(mode), contact.mul_abs(mode));
        for way in if is_driven { &[1.0][..] } else { &[1.0, -1.0] } {
            // A speed within the rounding of its own terms is zero.
            let is_stopped_by =
                |row: &usize| speed[*row] * way > WORK_TOLERANCE * terms[*row] && !closed.contains(*row);
            let time = |row: usize| (row, (-violation[row]).max(0.0) / speed[row].abs());
            let times: Vec<(usize, f64)> = (0..violation.len()).filter(is_stopped_by).map(time).collect();
            let first = times.iter().fold(f64::INFINITY, |first, entry| entry.1.min(first));
            if first.is_finite() {
                let is_first = |entry: &&(usize, f64)| entry.1 <= first * (1.0 + WORK_TOLERANCE);
                times.iter().filter(is_first).for_each(|entry| closed.insert(entry.0));
                return true;
            }
        }
        false
    }
}
