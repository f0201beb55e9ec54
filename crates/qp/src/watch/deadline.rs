//! A deadline, and the first work that it cut short.

use std::fmt;
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use super::activity::Activity;

/// Finishing an answer, for example its certificate, may take this share of the time beyond the deadline.
const FINISHING: f64 = 0.1;

/// A moment at which work must end.
#[derive(Clone, Debug)]
pub(super) struct Deadline {
    at: Instant,
    /// Time from setting the deadline to the deadline.
    span: Duration,
    /// What the deadline cut short first.
    cut: Arc<OnceLock<Cut>>,
}

/// Work that a deadline cut short or left out.
#[derive(Clone, Debug)]
struct Cut {
    activity: Activity,
    refused: Option<Refused>,
}

/// Seconds of work that did not begin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Refused {
    /// Seconds that the work needed.
    pub needed: f64,
    /// Seconds that were left.
    pub left: f64,
}

impl Deadline {
    /// The deadline `seconds` from now; `None` if no clock can represent it.
    pub fn within(seconds: f64) -> Option<Self> {
        let span = Duration::try_from_secs_f64(seconds).ok()?;
        Some(Deadline { at: Instant::now().checked_add(span)?, span, cut: Arc::default() })
    }

    /// This deadline, or `other` if that is sooner.
    pub fn or_sooner(&self, other: Deadline) -> Self {
        if other.at < self.at { other } else { self.clone() }
    }

    /// This deadline, sooner by `seconds`; what it cuts short, this deadline cut short.
    pub fn sooner(&self, seconds: f64) -> Self {
        let left = self.left();
        let sooner =
            Self::within(left - seconds.min(left)).map_or_else(|| self.clone(), |sooner| self.or_sooner(sooner));
        Deadline { cut: self.cut.clone(), ..sooner }
    }

    /// The deadline for finishing an answer: later by a share of the time.
    pub fn finishing(&self) -> Option<Self> {
        Some(Deadline { at: self.at.checked_add(self.span.mul_f64(FINISHING))?, ..self.clone() })
    }

    /// Seconds until the deadline, 0 after it.
    pub fn left(&self) -> f64 {
        self.at.saturating_duration_since(Instant::now()).as_secs_f64()
    }

    /// Takes down that the deadline ended this activity, or `refused` to begin the next; only the first is kept.
    pub fn note(&self, activity: Activity, refused: Option<Refused>) {
        self.cut.get_or_init(|| Cut { activity, refused });
    }

    /// What the deadline cut short or left out first, in words; `None` if nothing.
    pub fn cut(&self) -> Option<String> {
        self.cut.get().map(Cut::to_string)
    }
}

impl fmt::Display for Cut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let activity = self.activity.to_string();
        let step = if activity.is_empty() { String::new() } else { format!(" the step `{activity}`") };
        match self.refused {
            Some(Refused { needed, left }) => {
                let after = if step.is_empty() { "" } else { " after" };
                let words = "the next step takes about";
                write!(f, "the time does not suffice{after}{step}: {words} {needed:.1e} s, and {left:.1e} s are left")
            }
            None if step.is_empty() => write!(f, "the time ended before the first step"),
            None => write!(f, "the time ended in{step}"),
        }
    }
}
