//! The steps of an attempt on a scaled problem: each by one method, or by one that starts another.

use crate::error::Error;
use crate::method::interior_point::{self, InteriorPoint};
use crate::method::penalty::{self, Penalty};
use crate::method::{Ending, Outcome, ScaledProblem, active_set, dual_active_set};
use crate::plan::{PATIENCE, Step};
use crate::settings::ByFactor;
use crate::solution::ContactSet;

pub(super) struct ScaledStep<'a> {
    pub scaled: &'a ScaledProblem<'a>,
    pub start: Option<ContactSet>,
    pub method: ByFactor,
    /// The relative accuracy that is good enough.
    pub accuracy: Option<f64>,
    pub most_iterations: usize,
    /// The bound on the energy error of an answer (displacement, multiplier) to the scaled problem.
    pub bound: &'a dyn Fn(&[f64], &[f64]) -> f64,
}

impl ScaledStep<'_> {
    /// The outcome of `step`; `None` if the step has no means here.
    pub fn outcome(self, step: Step) -> Result<Option<Outcome>, Error> {
        match step {
            Step::Method => self.by_method().map(Some),
            Step::InteriorPoint => {
                let method = ByFactor::Qp(InteriorPoint::DEFAULT);
                let found = ScaledStep { start: None, method, ..self }.by_method()?;
                let variant = if found.is_settled() { "-interior-point" } else { found.variant };
                Ok(Some(Outcome { variant, ..found }))
            }
            Step::Continuation => self.continued().map(Some),
            Step::Dual => dual_active_set::solve(self.scaled),
            _ => Ok(None),
        }
    }

    fn by_method(self) -> Result<Outcome, Error> {
        let ScaledStep { scaled, start, method, accuracy, most_iterations, bound } = self;
        let Some(cold) = scaled.start()? else { return Ok(Outcome::at_rest(scaled.problem, Ending::Unheld)) };
        let by_sets = |start: ContactSet| active_set::solve(scaled, start, most_iterations.min(PATIENCE));
        match method {
            ByFactor::Qp(InteriorPoint { polish: true, tolerance }) => match start {
                Some(start) => {
                    let outcome = by_sets(start)?;
                    Ok(Outcome { variant: if outcome.is_settled() { "-warm" } else { outcome.variant }, ..outcome })
                }
                None => {
                    let found = interior_point::solve(scaled, tolerance)?;
                    // The multipliers become those of a linear solve.
                    Ok(Outcome { iterations: found.iterations, ..by_sets(found.contact_set)? })
                }
            },
            ByFactor::Qp(InteriorPoint { polish: false, tolerance }) => interior_point::solve(scaled, tolerance),
            ByFactor::Penalty(ladder) => {
                penalty::solve(scaled, ladder, start.unwrap_or(cold), most_iterations, accuracy, bound)
            }
            ByFactor::ActiveSet => by_sets(start.unwrap_or(cold)),
        }
    }

    /// The active-set loop, started again from the set that the penalty ladder reaches.
    ///
    /// On fine meshes a contact zone that starts too wide shrinks by one row an iteration. A penalty that grows from
    /// the stiffness to its best value reaches the zone in few iterations on every mesh. Along a chain of m rows the
    /// ladder takes nearly `3 sqrt(m)` sets; one that takes more wanders, and ends where it is.
    ///
    /// # Source
    /// K. Ito and K. Kunisch, *Semi-smooth Newton methods for variational inequalities of the first kind*, ESAIM: M2AN
    /// 37 (2003) 41-62.
    fn continued(self) -> Result<Outcome, Error> {
        let (scaled, most_iterations) = (self.scaled, self.most_iterations);
        let ladder = Penalty { penetration_threshold: 0.0, ..Penalty::default() };
        let start = self.start.unwrap_or_else(|| ContactSet::open(scaled.problem.rows()));
        let most_on_ladder = most_iterations.min(PATIENCE.max(3 * scaled.problem.rows().isqrt()));
        let approach = penalty::solve(scaled, ladder, start, most_on_ladder, None, self.bound)?;
        if scaled.watch.is_over() {
            return Ok(Outcome { ending: Ending::Unsettled, variant: "-unsettled", ..approach });
        }
        let most_iterations = most_iterations.saturating_sub(approach.iterations).max(1);
        let second = active_set::solve(scaled, approach.contact_set.clone(), most_iterations)?;
        let variant = if second.is_settled() { "-continuation" } else { second.variant };
        Ok(Outcome { variant, ..second.after(approach) })
    }
}
