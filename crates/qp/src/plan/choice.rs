//! Factor or multigrid, by the estimates of seconds and bytes.

use crate::cost::{Estimate, Smooth};
use crate::error::{Error, Result};
use crate::linear::memory::in_words as written;
use crate::problem::ContactProblem;
use crate::settings::{Method, Settings};
use crate::solution::{Expected, Why};

/// The direct path is exact, its bound proven: multigrid replaces it only if it takes this many times as long.
const CLEARLY: f64 = 1.15;

/// The name of the methods with a factor in the comparison with multigrid.
const WITH_FACTOR: &str = "factor";

/// Digits of an answer to rounding, and those whose cycles a start takes: a face is found first. Measured: 18 to 21
/// cycles for 2.3 digits of answers that take 45, 7 of answers that take 16.
const ALL_DIGITS: f64 = 9.0;
const FIRST_DIGITS: f64 = 1.5;

/// An estimate may be too large by this factor.
const UNSURE: f64 = 2.0;

/// Cycles of multigrid, or sets on all dofs, may cost this many times what the other way is expected to cost.
const OUTRUN: f64 = 2.0;

/// The chosen path, with the reason.
#[derive(Clone, Debug, PartialEq)]
pub enum Choice {
    /// The direct path: a factorisation of the stiffness, unless its sets take more seconds than this.
    Factor { reason: String, most_seconds: f64 },
    /// Multigrid: it is much faster, unless it takes more cycles than this, or nothing else fits into the memory.
    Multigrid { reason: String, most_cycles: usize },
}

impl Estimate {
    /// Returns `true` if multigrid is chosen: much faster, or the only path within `most_bytes`.
    pub fn prefers_multigrid(&self, most_bytes: f64) -> bool {
        !matches!(self.choose(most_bytes), Ok(Choice::Factor { .. }) | Err(_))
    }

    /// The path within `most_bytes`. If a factor is not clearly too large, its analysis decides whether it fits.
    pub(super) fn choose(&self, most_bytes: f64) -> Result<Choice> {
        let ratio = self.direct_seconds / self.multigrid_seconds;
        let fits = self.direct_bytes <= most_bytes;
        // For a body, constants alone give a poor hierarchy.
        let may_iterate = self.has_bound || !fits;
        if ratio > CLEARLY && may_iterate && self.smooth != Smooth::Unknown && self.multigrid_bytes <= most_bytes {
            let reason = format!("by multigrid: a factorisation would take about {ratio:.1} times as long");
            let of_cycles = OUTRUN * self.direct_seconds - self.hierarchy_seconds;
            let cycle_seconds = (self.multigrid_seconds - self.hierarchy_seconds) / self.cycles;
            let most_cycles = if fits { (of_cycles / cycle_seconds) as usize } else { usize::MAX };
            return Ok(Choice::Multigrid { reason, most_cycles });
        }
        if self.direct_bytes > UNSURE * most_bytes {
            let reason = self.without_factor(self.direct_bytes, most_bytes)?;
            return Ok(Choice::Multigrid { reason, most_cycles: usize::MAX });
        }
        let slower = 1.0 / ratio;
        let reason = match self.smooth {
            _ if self.multigrid_bytes.is_infinite() => {
                "with a factor: multigrid cannot take dofs that contact alone holds".to_string()
            }
            Smooth::Unknown => {
                "with a factor: multigrid has no near-null space, which names the motions of almost no energy"
                    .to_string()
            }
            _ if self.multigrid_bytes > most_bytes => {
                let [of_multigrid, allowed] = [self.multigrid_bytes, most_bytes].map(written);
                format!("with a factor: multigrid would take about {of_multigrid}, {allowed} are allowed")
            }
            _ if !self.has_bound => {
                "with a factor: cycles do not bound the error of so many bodies that only contact holds".to_string()
            }
            _ if slower > 1.0 => format!("with a factor: multigrid would take about {slower:.1} times as long"),
            _ => format!("with a factor: its bound is proven, and multigrid is not {CLEARLY} times as fast"),
        };
        let takes_both = self.has_bound && self.smooth != Smooth::Unknown && self.multigrid_bytes <= most_bytes;
        let most_seconds = if takes_both { OUTRUN * self.multigrid_seconds } else { f64::INFINITY };
        Ok(Choice::Factor { reason, most_seconds })
    }

    /// The estimates behind a choice, and its reason.
    pub(super) fn why(&self, choice: &Choice) -> Why {
        let mprgp = Method::Mprgp.name();
        let (chosen, reason) = match choice {
            Choice::Factor { reason, .. } => (WITH_FACTOR, reason),
            Choice::Multigrid { reason, .. } => (mprgp, reason),
        };
        let expected = |method: &str, seconds, bytes| Expected { method: method.to_string(), seconds, bytes };
        let considered = vec![
            expected(WITH_FACTOR, self.direct_seconds, self.direct_bytes),
            expected(mprgp, self.multigrid_seconds, self.multigrid_bytes),
        ];
        Why { chosen: chosen.to_string(), reason: reason.clone(), considered }
    }

    /// The same for an answer to this relative error in the energy norm; without one, to rounding.
    pub(super) fn for_accuracy(self, accuracy: Option<f64>) -> Self {
        let digits = accuracy.map_or(ALL_DIGITS, |error| -error.log10());
        let share = ((digits + FIRST_DIGITS) / (ALL_DIGITS + FIRST_DIGITS)).clamp(0.0, 1.0);
        let of_cycles = self.multigrid_seconds - self.hierarchy_seconds;
        let multigrid_seconds = self.hierarchy_seconds + share * of_cycles;
        Estimate { multigrid_seconds, cycles: share * self.cycles, ..self }
    }

    /// The same for each of many gaps; all gaps share the first factor, and the hierarchy.
    pub(super) fn of_many(self, gaps: usize) -> Self {
        let rest = 1.0 - 1.0 / gaps.max(1) as f64;
        Estimate {
            direct_seconds: self.direct_seconds - rest * self.shared_seconds,
            multigrid_seconds: self.multigrid_seconds - rest * self.hierarchy_seconds,
            ..self
        }
    }

    /// The reason for multigrid if a solve with a factor takes `factor` bytes, which is too much.
    pub(super) fn without_factor(&self, factor: f64, most_bytes: f64) -> Result<String> {
        let multigrid = self.multigrid_bytes;
        if multigrid > most_bytes {
            return Err(Error::NoRoom { factor, multigrid, allowed: most_bytes, ended: None });
        }
        Ok(self.less_than_factor(factor, most_bytes))
    }

    /// The same, in words alone.
    pub(super) fn less_than_factor(&self, factor: f64, most_bytes: f64) -> String {
        let [multigrid, factor, allowed] = [self.multigrid_bytes, factor, most_bytes].map(written);
        format!("by multigrid, of about {multigrid}: with a factor it would take about {factor}, {allowed} are allowed")
    }
}

/// Returns `true` if the energy bound of an answer from elsewhere comes from a factor of the stiffness, `false` if from
/// multigrid. A factor gives a proven bound; it is taken if it fits and takes at most these seconds.
pub fn is_bounded_by_factor(problem: &ContactProblem, seconds: f64, settings: &Settings) -> Result<bool> {
    let (estimate, memory) = (Estimate::of(problem), settings.memory.unwrap_or(f64::INFINITY));
    if estimate.direct_bytes > memory {
        return estimate.without_factor(estimate.direct_bytes, memory).map(|_| false);
    }
    Ok(estimate.shared_seconds <= seconds || estimate.multigrid_bytes > memory)
}
