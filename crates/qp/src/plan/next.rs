//! The step that follows after what was found.

use super::attempt::{Attempt, From, Limits, Means, Next, PATIENCE, Place, Rung, Step, When};
use super::history::{Answered, Ended, History, Record};
use super::ladder::Ladder;
use crate::error::Error;
use crate::linear::watch::Watch;
use crate::method::interior_point::InteriorPoint;
use crate::settings::Method;
use crate::solution::Certificate;

/// Refinements of an answer, one after the other: each gains as many digits as the factor has left.
const MOST_REFINEMENTS: usize = 6;

/// Repairs of an answer, one after the other: the second removes the rounding of the first.
const MOST_REPAIRS: usize = 8;

/// If the certificate is not met, MPRGP continues to this share of the residual that it reached.
const NEXT: f64 = 0.01;

/// If the bound exceeds the accuracy, MPRGP next aims at this share of the accuracy.
const AIM: f64 = 0.3;

/// A relative imbalance of forces below this is rounding.
const IMBALANCE_ROUNDING: f64 = 1e-15;

/// An answer shows which rows press only if its conditions hold to this, for every requested tolerance.
const SURE_CONDITIONS: f64 = 1e-9;

impl Ladder {
    /// The tolerance to which the conditions of an answer must hold if its rows are to tell whether it is the only one.
    pub fn sure_tolerance(&self) -> f64 {
        self.settings.goal().tolerance.min(SURE_CONDITIONS)
    }

    /// The next step; `None` if the goal is met and nothing more is to be gained, if nothing is left, if an error is
    /// decided, or if the watch is over.
    pub fn next(&self, history: &History, watch: &Watch) -> Option<Next> {
        let Some(last) = history.records.last() else { return Some(self.start_of(history.first)) };
        if matches!(last.ended, Ended::Decided(_)) || watch.is_over() {
            return None;
        }
        if let Some(limits) = self.again(last, history) {
            return Some(Next { place: last.place, start: From::Best, limits });
        }
        let has_ended = matches!((&last.ended, last.step), (Ended::Refused(_) | Ended::Failed(_), Step::Method));
        // A method that fails leaves its data to the next steps.
        let is_prepared = (!has_ended || last.tried.is_some()) && !self.is_outrun(history);
        let rest = if is_prepared { self.attempts[last.place.attempt].steps.len() } else { 0 };
        let here = (last.place.rung + 1..rest).map(|rung| Place { attempt: last.place.attempt, rung });
        let later = (last.place.attempt + 1..self.attempts.len())
            .filter(|&attempt| self.is_due(&self.attempts[attempt], history, watch))
            .flat_map(|attempt| (0..self.attempts[attempt].steps.len()).map(move |rung| Place { attempt, rung }));
        let place = here.chain(later).find(|place| self.holds(*place, history))?;
        match place.rung {
            0 => Some(self.start_of(place.attempt)),
            _ => {
                let limits = self.attempts[place.attempt].limits;
                let most_seconds = limits.most_seconds - Self::spent(history, place.attempt);
                Some(Next { place, start: From::Best, limits: Limits { most_seconds, ..limits } })
            }
        }
    }

    fn start_of(&self, attempt: usize) -> Next {
        let Attempt { start, limits, .. } = self.attempts[attempt];
        Next { place: Place { attempt, rung: 0 }, start, limits }
    }

    /// The limits of the last step if it is made again.
    fn again(&self, last: &Record, history: &History) -> Option<Limits> {
        let Ended::Answered(answered) = &last.ended else { return None };
        let in_a_row = history.records.iter().rev().take_while(|record| record.place == last.place).count();
        let asks = history.best.as_ref()?.solution.certificate.asks_for_more(history.goal);
        match last.step {
            Step::Refinement => (answered.gains && asks && in_a_row < MOST_REFINEMENTS).then_some(last.limits),
            Step::Repair => (answered.is_best && asks && in_a_row < MOST_REPAIRS).then_some(last.limits),
            Step::Method if self.attempts[last.place.attempt].means == Means::Multigrid => {
                self.tighter(last, answered, history)
            }
            _ => None,
        }
    }

    /// The limits with which MPRGP goes on from a settled answer that falls short.
    fn tighter(&self, last: &Record, answered: &Answered, history: &History) -> Option<Limits> {
        let bound = history.best.as_ref()?.solution.certificate.energy_error_bound;
        let share = match self.settings.accuracy {
            Some(accuracy) if bound.is_finite() && bound > 0.0 => (AIM * accuracy / bound).clamp(NEXT, AIM),
            _ => NEXT,
        };
        let tolerance = last.limits.tolerance * share;
        let most_cycles = self.settings.max_iterations.saturating_sub(answered.iterations);
        let goes_on =
            answered.is_settled && !history.is_certified() && tolerance >= IMBALANCE_ROUNDING && most_cycles > 0;
        goes_on.then_some(Limits { tolerance, most_cycles, ..last.limits })
    }

    fn is_due(&self, attempt: &Attempt, history: &History, watch: &Watch) -> bool {
        let certified = history.is_certified();
        let last = history.records.last().map(|record| &record.ended);
        match attempt.when {
            When::Always => true,
            When::Short => !certified || self.is_unbalanced(history),
            When::ShortOfMultigrid => {
                let is_of_multigrid = |record: &Record| self.attempts[record.place.attempt].means == Means::Multigrid;
                !certified && history.records.iter().any(is_of_multigrid)
            }
            When::ShortOfUnsettled => !certified && history.last_answer().is_some_and(|answer| !answer.is_settled),
            When::ShortOfShortcut => !certified && history.last_tried().is_some_and(|tried| tried.is_shortcut),
            When::ShortOnCondensed => {
                let gains = |certificate: &Certificate| !self.is_exact(certificate);
                let best = history.best.as_ref().map(|best| &best.solution.certificate);
                let is_condensed = history.last_tried().is_some_and(|tried| {
                    tried.condensed_dofs.is_some() && tried.method.allows_last_resort(miss(best, history))
                });
                !certified && is_condensed && best.is_none_or(gains)
            }
            When::Refused => match last {
                Some(Ended::Refused(Error::OutOfTime { .. })) => {
                    self.multigrid_fits()
                        && self.choice.as_ref().is_some_and(|(e, _)| watch.allows(e.hierarchy_seconds))
                }
                Some(Ended::Refused(_)) => self.multigrid_fits(),
                _ => self.multigrid_fits() && self.is_outrun(history),
            },
            _ => false,
        }
    }

    /// Estimated seconds of the sets of an attempt so far, each with a factor of its own.
    fn spent(history: &History, attempt: usize) -> f64 {
        let seconds = |record: &Record| match (&record.ended, record.tried) {
            (Ended::Answered(answered), Some(tried)) => answered.iterations as f64 * tried.set_seconds,
            _ => 0.0,
        };
        history.records.iter().filter(|record| record.place.attempt == attempt).map(seconds).sum()
    }

    /// Returns `true` if the last attempt did not settle, and one more set would cost more than the other way.
    fn is_outrun(&self, history: &History) -> bool {
        let Some(last) = history.records.last() else { return false };
        let attempt = last.place.attempt;
        let is_unsettled = matches!(last.ended, Ended::Answered(Answered { is_settled: false, is_unheld: false, .. }));
        let next = last.tried.map_or(0.0, |tried| tried.set_seconds);
        is_unsettled && Self::spent(history, attempt) + next > self.attempts[attempt].limits.most_seconds
    }

    /// Returns `true` if the last step eliminated equalities and left forces out of balance at a dof: an elimination
    /// has no refinement of its own.
    fn is_unbalanced(&self, history: &History) -> bool {
        let is_last = history.records.last().is_some_and(|record| record.step == Step::Elimination);
        let required = history.goal.required();
        is_last && history.best.as_ref().is_some_and(|best| best.solution.certificate.stationarity > required)
    }

    /// Returns `true` if sets of this method that do not settle wander on a dense stiffness: the interior point follows
    /// at once, so that a bound of where they ended is not worth its time.
    pub fn wanders_by(&self, method: Method) -> bool {
        self.is_dense && method == Method::ActiveSet
    }

    /// Returns `true` if a step of an attempt that is due holds.
    fn holds(&self, place: Place, history: &History) -> bool {
        let Rung { step, when, .. } = self.attempts[place.attempt].steps[place.rung];
        let certified = history.is_certified();
        let best = history.best.as_ref();
        let certificate = best.map(|best| &best.solution.certificate);
        let method = history.last_tried().map_or(self.settings.method, |tried| tried.method);
        let in_attempt = || history.records.iter().filter(|record| record.place.attempt == place.attempt);
        let was_made = |step: Step| in_attempt().any(|record| record.step == step);
        let answer = history.last_answer();
        let is_unheld = answer.is_some_and(|answer| answer.is_unheld);
        match (when, step) {
            (When::Always, _) => true,
            (When::Unheld, _) => !certified && is_unheld && !history.was_in_doubt(),
            (When::UnsettledOnDense, _) => {
                let is_unsettled = answer.is_some_and(|answer| !answer.is_settled && !answer.is_unheld);
                !certified && is_unsettled && self.wanders_by(method)
            }
            (When::Unsettled, Step::Continuation) => {
                let is_by_sets =
                    matches!(method, Method::Auto | Method::ActiveSet | Method::Qp(InteriorPoint { polish: true, .. }));
                let is_slow = answer.is_some_and(|answer| !answer.is_settled && !answer.is_unheld);
                !certified && is_slow && is_by_sets && self.settings.max_iterations > PATIENCE
            }
            (When::Unsettled, _) => {
                let is_unsettled = answer.is_some_and(|answer| !answer.is_settled);
                !certified && is_unsettled && method.allows_last_resort(f64::INFINITY)
            }
            (When::Improvable, _) => {
                // A repair follows a refinement also if that gained nothing.
                let is_new = |record: &Record| match (&record.ended, record.step) {
                    (Ended::Answered(_) | Ended::Empty, Step::Refinement) if step == Step::Repair => true,
                    (Ended::Answered(answered), _) => answered.is_best,
                    _ => false,
                };
                let last = in_attempt().rfind(|record| record.step != Step::Existence);
                let asks = certificate.is_some_and(|certificate| certificate.asks_for_more(history.goal));
                asks && last.is_some_and(is_new) && method.wants_best()
            }
            (When::Short, Step::Dual) => {
                let may_gain = method.allows_last_resort(miss(certificate, history));
                !certified && may_gain && !was_made(Step::Dual)
            }
            (When::Doubtful, _) => !history.was_in_doubt() && self.is_doubtful(history),
            (When::Exists, _) => {
                let holds = certificate.is_some_and(|certificate| certificate.conditions_hold(self.sure_tolerance()));
                may_exist(history) && !holds && method.allows_last_resort(miss(certificate, history))
            }
            (When::WasDoubtful, _) => {
                let is_sure = |certificate: &Certificate| certificate.has_bound() && certificate.loose_dofs == 0;
                may_exist(history) && !certificate.is_some_and(is_sure)
            }
            _ => false,
        }
    }

    /// Returns `true` if it is open whether an answer exists, or whether it is the only one. An answer without a bound
    /// leaves it open if its conditions hold, or if the stiffness is known to be singular; the bound itself does not
    /// see dofs without stiffness.
    fn is_doubtful(&self, history: &History) -> bool {
        let failed = |record: &Record| matches!(&record.ended, Ended::Failed(error) if error.leaves_existence_open());
        let is_unheld = history.last_answer().is_some_and(|answer| answer.is_unheld);
        let Some(best) = &history.best else { return history.records.iter().any(failed) };
        let certificate = &best.solution.certificate;
        match certificate.has_bound() {
            true => certificate.loose_dofs > 0,
            false => {
                let is_singular = best.tried.is_some_and(|tried| tried.is_singular);
                is_unheld || is_singular || certificate.conditions_hold(self.settings.goal().tolerance)
            }
        }
    }

    /// Returns `true` if the conditions hold and no error bound exceeds the effect of rounding the displacement: the
    /// answer can only miss an accuracy beyond that.
    fn is_exact(&self, certificate: &Certificate) -> bool {
        certificate.conditions_hold(self.settings.goal().tolerance) && certificate.energy_error_excess == 0.0
    }

    /// Returns `true` if multigrid was compared, and fits into the memory.
    pub(super) fn multigrid_fits(&self) -> bool {
        let allowed = self.settings.memory.unwrap_or(f64::INFINITY);
        let fits = |bytes: f64| bytes.is_finite() && bytes <= allowed;
        self.choice.as_ref().is_some_and(|(estimate, _)| fits(estimate.multigrid_bytes))
    }
}

/// The value by which the best answer misses the goal; infinite without one.
fn miss(best: Option<&Certificate>, history: &History) -> f64 {
    let value = best.map_or(f64::INFINITY, |certificate| certificate.decisive(history.goal.required()).1);
    if value.is_nan() { f64::INFINITY } else { value }
}

fn may_exist(history: &History) -> bool {
    history.records.iter().any(|record| matches!(record.ended, Ended::MayExist))
}
