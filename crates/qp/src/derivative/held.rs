//! The linear system of the held rows, solved to the digits of doubles.

use super::Derivatives;
use crate::certificate::{Bounding, Examination};
use crate::error::Error;
use crate::linear::largest;
use crate::solution::ContactSet;

/// Corrections of a solution by its own residual, at most.
const MOST_CORRECTIONS: usize = 8;

/// A correction below this, relative, is the last: the next one would be about its square.
const ENOUGH: f64 = 1e-9;

pub(super) struct HeldSolution {
    pub displacement: Vec<f64>,
    /// One entry for each row of the problem.
    pub multiplier: Vec<f64>,
    /// As [`Adjoint::error`](super::Adjoint::error).
    pub error: f64,
}

impl Derivatives {
    /// `K x - B_C' y = force`, `B_C x = distances` on the rows of `closed`: with a factor, corrected by residuals in
    /// twice the precision. `None` if the rows do not hold the body, or follow from each other.
    pub(super) fn held(
        &self,
        closed: &ContactSet,
        force: &[f64],
        distances: &[f64],
    ) -> Result<Option<HeldSolution>, Error> {
        let watch = &self.settings.watch;
        let is_exact = self.engine.hierarchy().is_none();
        // Open rows have no part in the system; their distances only must fit the pattern of infinite gaps.
        let distance = |row: usize| if closed.contains(row) { distances[row] } else { 0.0 };
        let gap: Vec<f64> = (0..self.problem.rows()).map(distance).collect();
        let linear = self.problem.with(force.to_vec(), gap)?;
        let Some([mut x, mut y]) = self.engine.held(closed, linear.load(), linear.gap(), watch)? else {
            return Ok(None);
        };
        let mut error = f64::INFINITY;
        for _ in 0..if is_exact { MOST_CORRECTIONS } else { 0 } {
            if watch.is_over() {
                return Err(Error::Interrupted);
            }
            let rest = linear.accurate_residual(&x, &y);
            let missing: Vec<f64> = linear.accurate_violation(&x).iter().map(|violation| -violation).collect();
            let Some([dx, dy]) = self.engine.held(closed, &rest, &missing, watch)? else { return Ok(None) };
            let step = relative(&dx, &x).max(relative(&dy, &y));
            if step > 0.5 * error {
                break;
            }
            x.iter_mut().zip(dx).for_each(|(x, dx)| *x += dx);
            y.iter_mut().zip(dy).for_each(|(y, dy)| *y += dy);
            error = step;
            if step <= ENOUGH {
                break;
            }
        }
        if !is_exact {
            error = self.bound_of(closed, force, distances, [&x, &y])?;
        }
        Ok(Some(HeldSolution { displacement: x, multiplier: y, error }))
    }

    /// The relative bound on the error in the energy norm by the hierarchy.
    fn bound_of(
        &self,
        closed: &ContactSet,
        force: &[f64],
        distances: &[f64],
        [x, y]: [&[f64]; 2],
    ) -> Result<f64, Error> {
        let rows: Vec<usize> = closed.iter().collect();
        let pick = |values: &[f64]| rows.iter().map(|&row| values[row]).collect::<Vec<f64>>();
        let linear = self.problem.without_rows()?.with_load(force.to_vec())?;
        let linear = linear.with_all_equalities(&self.problem.contact().select_rows(&rows), pick(distances))?;
        let by: Bounding = self.engine.bounding(&self.settings.watch);
        Ok(Examination::of(&linear, [x, &pick(y)], &by)?.certificate()?.certificate.energy_error_bound)
    }
}

fn relative(step: &[f64], of: &[f64]) -> f64 {
    let (step, size) = (largest(step), largest(of));
    if step == 0.0 { 0.0 } else { step / size }
}
