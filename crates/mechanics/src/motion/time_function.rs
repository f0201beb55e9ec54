//! Factors over time: the change of loads.

use std::f64::consts::{PI, TAU};

use crate::error::Error;
use signorini_qp as qp;

/// A factor, without a unit, that changes with time and multiplies one load of a motion.
#[derive(Clone, Debug, PartialEq)]
pub enum TimeFunction {
    /// Straight lines between points `(time, factor)`, times strictly increasing; constant before the first and after
    /// the last.
    Table(Vec<(f64, f64)>),
    /// `sin(2 pi frequency t + phase)`, between -1 and 1.
    Sine {
        /// Number of periods in a unit of time.
        frequency: f64,
        /// Angle at time 0, in radians.
        phase: f64,
    },
    /// 0 until `start`, a straight line to 1 at `end`, 1 from there on.
    Ramp {
        /// Time up to which the factor is 0.
        start: f64,
        /// Time from which the factor is 1.
        end: f64,
    },
    /// Half a sine wave from `start` to `end`, 0 before and after.
    Pulse {
        /// Time at which the half wave begins.
        start: f64,
        /// Time at which the half wave is over.
        end: f64,
    },
}

impl TimeFunction {
    /// Checks that the numbers are finite and the times in order.
    ///
    /// # Errors
    /// [`qp::LinearError::Setting`] for the first number that is not.
    pub fn check(&self) -> Result<(), Error> {
        let fail = |name, value, allowed| Err(qp::LinearError::Setting { name, value, allowed }.into());
        match self {
            TimeFunction::Table(points) => {
                if points.is_empty() {
                    return fail("number of times", 0.0, "at least 1");
                }
                for (index, &(time, factor)) in points.iter().enumerate() {
                    if !time.is_finite() || index > 0 && time <= points[index - 1].0 {
                        return fail("time of a table", time, "finite and later than the one before it");
                    }
                    if !factor.is_finite() {
                        return fail("factor of a table", factor, "finite");
                    }
                }
            }
            &TimeFunction::Sine { frequency, phase } => {
                if !(frequency.is_finite() && frequency > 0.0) {
                    return fail("frequency", frequency, "positive and finite");
                }
                if !phase.is_finite() {
                    return fail("phase", phase, "finite");
                }
            }
            &TimeFunction::Ramp { start, end } | &TimeFunction::Pulse { start, end } => {
                if !start.is_finite() {
                    return fail("start", start, "finite");
                }
                if !(end.is_finite() && end > start) {
                    return fail("end", end, "finite and later than the start");
                }
            }
        }
        Ok(())
    }

    /// The factor at time `t`.
    ///
    /// ```
    /// use signorini_mechanics::motion::TimeFunction;
    /// let table = TimeFunction::Table(vec![(0.0, 1.0), (2.0, 5.0)]);
    /// assert_eq!([-1.0, 0.5, 3.0].map(|t| table.at(t)), [1.0, 2.0, 5.0]);
    /// ```
    pub fn at(&self, t: f64) -> f64 {
        let share = |start: f64, end: f64| ((t - start) / (end - start)).clamp(0.0, 1.0);
        match *self {
            TimeFunction::Table(ref points) => between(points, t),
            TimeFunction::Sine { frequency, phase } => (TAU * frequency * t + phase).sin(),
            TimeFunction::Ramp { start, end } => share(start, end),
            TimeFunction::Pulse { start, end } => match share(start, end) {
                outside if outside <= 0.0 || outside >= 1.0 => 0.0,
                inside => (PI * inside).sin(),
            },
        }
    }
}

/// The value at `t` of straight lines between points `(t, value)`, t increasing; constant before the first and after
/// the last, 1 without points.
pub(crate) fn between(points: &[(f64, f64)], t: f64) -> f64 {
    let after = points.partition_point(|&(at, _)| at <= t);
    match (after.checked_sub(1).and_then(|before| points.get(before)), points.get(after)) {
        (Some(&(from, first)), Some(&(to, last))) => first + (last - first) * (t - from) / (to - from),
        (Some(&(_, value)), None) | (None, Some(&(_, value))) => value,
        (None, None) => 1.0,
    }
}
