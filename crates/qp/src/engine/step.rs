//! The steps of an attempt on a scaled problem: each by one method, or by one that starts another.

use crate::error::Error;
use crate::method::active_set::ActiveSet;
use crate::method::dual_active_set::DualActiveSet;
use crate::method::interior_point::{Barrier, InteriorPoint};
use crate::method::penalty::{self, Penalty, PenaltyLoop};
use crate::method::{Ending, Outcome, ScaledProblem, Solver, Start};
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
            Step::Dual => DualActiveSet::of(self.scaled)?.map(|method| method.solve(Start::default())).transpose(),
            _ => Ok(None),
        }
    }

    fn by_method(self) -> Result<Outcome, Error> {
        let ScaledStep { scaled, start, method, accuracy, most_iterations, bound } = self;
        let Some(cold) = scaled.start()? else { return Ok(Outcome::at_rest(scaled.problem, Ending::Unheld)) };
        let by_sets = |start: ContactSet| {
            ActiveSet { scaled, most_iterations: most_iterations.min(PATIENCE) }.solve(start.into())
        };
        match method {
            ByFactor::Qp(InteriorPoint { polish: true, tolerance }) => match start {
                Some(start) => {
                    let outcome = by_sets(start)?;
                    Ok(Outcome { variant: if outcome.is_settled() { "-warm" } else { outcome.variant }, ..outcome })
                }
                None => {
                    let found = Barrier { scaled, tolerance }.solve(Start::default())?;
                    // The multipliers become those of a linear solve.
                    Ok(Outcome { iterations: found.iterations, ..by_sets(found.contact_set)? })
                }
            },
            ByFactor::Qp(InteriorPoint { polish: false, tolerance }) => {
                Barrier { scaled, tolerance }.solve(Start::default())
            }
            ByFactor::Penalty(ladder) => {
                let goal = accuracy.map(|accuracy| penalty::AccuracyGoal { accuracy, bound });
                let climb = PenaltyLoop { scaled, ladder, goal, most_iterations };
                climb.solve(start.unwrap_or(cold).into())
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
        let climb = PenaltyLoop { scaled, ladder, goal: None, most_iterations: most_on_ladder };
        let approach = climb.solve(start.into())?;
        if scaled.watch().is_over() {
            return Ok(Outcome { ending: Ending::Unsettled, variant: "-unsettled", ..approach });
        }
        let most_iterations = most_iterations.saturating_sub(approach.iterations).max(1);
        let second = ActiveSet { scaled, most_iterations }.solve(approach.contact_set.clone().into())?;
        let variant = if second.is_settled() { "-continuation" } else { second.variant };
        Ok(Outcome { variant, ..second.after(approach) })
    }
}
