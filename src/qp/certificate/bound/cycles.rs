//! The bound on the energy norm of an answer's error where K has a hierarchy and no factor.
//!
//! As in the bound with a factor, for a feasible v and multipliers mu <= 0 that push only where v touches,
//!
//! ```text
//! |u - u*|_K <= |u - v|_K + |f + B' mu - K v|_{K^-1}
//! ```
//!
//! v is the answer with each row that touches or penetrates moved to its gap along itself; for an answer of MPRGP, whose rows
//! are bounds that it keeps, that is rounding. The dual norm comes from the cycles of the hierarchy.

use super::{Answer, ErrorBound};
use crate::qp::certificate::energy_norm::ROUNDED_BOUND;
use crate::qp::linear::multigrid::{Multigrid, dual_norm_within};
use crate::qp::problem::ContactProblem;
use crate::watch::Watch;

impl ContactProblem {
    /// An upper bound on `|u - u*|_K`, as far as [`dual_norm_within`] finds the least eigenvalue; infinite where it finds none. A
    /// stiffness that the hierarchy has found singular gets springs on the rows that press. Infinite too where `watch` is over
    /// before that.
    pub(in super::super) fn energy_error_bound_by(
        &self,
        multigrid: &Multigrid,
        answer: &Answer,
        watch: &Watch,
    ) -> ErrorBound {
        let mut residual = answer.residual.clone();
        if answer.multiplier.iter().any(|&lambda| lambda > 0.0) {
            let pulled: Vec<f64> = answer.multiplier.iter().map(|lambda| lambda.max(0.0)).collect();
            residual.iter_mut().zip(self.contact.mul_transposed(&pulled)).for_each(|(r, force)| *r -= force);
        }
        let springs = multigrid.is_shifted().then(|| self.springs(answer.displacement, answer.multiplier));
        let dual = match &springs {
            None => dual_norm_within(&self.stiffness, multigrid, &residual, watch),
            Some(springs) => springs
                .added_to(&self.stiffness, &self.contact)
                .ok()
                .flatten()
                .and_then(|stiffness| dual_norm_within(&stiffness, multigrid, &residual, watch)),
        };
        let Some(dual) = dual else { return ErrorBound::none() };
        // Every row that presses is put at its gap below.
        let at_gap = vec![true; self.rows()];
        if springs.is_some_and(|springs| !springs.hold(answer.multiplier, &at_gap, ROUNDED_BOUND * dual.most)) {
            return ErrorBound::none();
        }
        let moved: f64 = (self.lengths_along_rows().iter().zip(answer.violation).zip(answer.multiplier))
            .filter(|((_, violation), lambda)| **violation > 0.0 || **lambda < 0.0)
            .map(|((length, violation), _)| if *violation == 0.0 { 0.0 } else { length * violation.abs() })
            .sum();
        // What moves the answer moves its residual too, by K times that.
        ErrorBound { whole: ROUNDED_BOUND * (2.0 * moved + dual.most), of_parts: None }
    }
}
