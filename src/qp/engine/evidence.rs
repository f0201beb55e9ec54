//! The claims of a method on the scaled problem, in the terms of the original problem.

use super::factored::Factored;
use crate::error::Error;
use crate::qp::linear::largest;
use crate::qp::method::WORK_TOLERANCE;

impl Factored {
    /// Rows and directions of an error in the terms of the original problem.
    pub(super) fn expand_error(&self, error: Error, load: &[f64], gap: &[f64]) -> Error {
        let Ok(problem) = self.problem.with(load.to_vec(), gap.to_vec()) else { return error };
        let normalised = |direction: Vec<f64>| {
            let whole = match &self.reduction.condensation {
                // A free mode moves the interior along without force.
                Some(condensed) => condensed.expand(&vec![0.0; self.problem.dofs()], &direction),
                None => direction,
            };
            let mut direction = self.reduction.scaling.expand_displacement(&whole, 0);
            let size = largest(&direction);
            direction.iter_mut().for_each(|value| *value /= size);
            direction
        };
        match error {
            Error::Unbounded { mode, direction } => {
                let direction = normalised(direction);
                // If the load is in balance, condensing leaves its rounding, which is then all that drives the boundary.
                match problem.share_of_work(&direction) > WORK_TOLERANCE {
                    true => Error::Unbounded { mode, direction },
                    false => Error::UnderHeld { mode, direction },
                }
            }
            Error::UnderHeld { mode, direction } => Error::UnderHeld { mode, direction: normalised(direction) },
            Error::Infeasible { rows, weights, .. } => {
                let mut scaled = vec![0.0; self.reduction.selection.kept().len()];
                rows.iter().zip(&weights).for_each(|(&row, &weight)| scaled[row] = weight);
                let rows: Vec<usize> = rows.into_iter().map(|row| self.reduction.selection.kept()[row]).collect();
                // Rows are scaled like multipliers; the unit of weights is free.
                let all = self.expand_multiplier(&scaled, self.reduction.scaling.equilibration().factor);
                let weights: Vec<f64> =
                    if weights.is_empty() { weights } else { rows.iter().map(|&row| all[row]).collect() };
                let overlap = problem.overlap(&rows, &weights).unwrap_or(0.0);
                let by = if overlap > 0.0 { format!(": they overlap by {overlap:.3e}") } else { String::new() };
                let reason =
                    format!("no displacement satisfies the contact rows {rows:?} together{by} (indices from 0)");
                Error::Infeasible { reason, rows, weights, overlap }
            }
            other => other,
        }
    }
}
