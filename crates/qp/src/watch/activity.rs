//! What running work does at present.

use std::fmt;
use std::time::{Duration, Instant};

/// The work that a command does at the moment: its part, its step and its iteration.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Activity {
    /// The part of the work if there are several, such as one gap of a sweep.
    pub part: Option<Part>,
    /// The step of the work, such as `factorisation`; empty before the first.
    pub step: &'static str,
    /// The iteration of the step, from 1; 0 if the step has no iterations.
    pub iteration: usize,
    /// Start and expected duration of the current work, if it is [timed](crate::Watch::timed).
    pub timed: Option<(Instant, Duration)>,
}

/// One of several parts of a longer work, such as a point of a sweep.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Name of the parts, such as `gap`.
    pub name: &'static str,
    /// Number of this part, from 1.
    pub number: usize,
    /// The number of all parts together.
    pub of: usize,
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} of {}", self.name, self.number, self.of)
    }
}

impl fmt::Display for Activity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let part = self.part.as_ref().map(Part::to_string);
        let step = match self.iteration {
            _ if self.step.is_empty() => None,
            0 => Some(self.step.to_string()),
            iteration => Some(format!("{}, iteration {iteration}", self.step)),
        };
        f.write_str(&part.into_iter().chain(step).collect::<Vec<_>>().join(": "))
    }
}
