//! Factors of loads over time, from a scene.

use super::entry::{finite, located, wrong};
use super::schema::{FactorSpec, LoadInTimeSpec};
use crate::error::Error;
use crate::motion::TimeFunction;

impl LoadInTimeSpec {
    /// The factor, checked; `path` is its JSON path, `loads` how many loads there are.
    pub(super) fn function(&self, path: &str, loads: usize) -> Result<TimeFunction, Error> {
        if self.load >= loads {
            let message = format!("there is no loads[{}]; the scene has {loads} loads, counted from 0", self.load);
            return Err(wrong(format!("{path}.load"), message));
        }
        let (name, function) = match &self.factor {
            FactorSpec::Table(table) => {
                let path = format!("{path}.factor.table");
                let (times, factors) = (&table.times, &table.factors);
                if times.len() != factors.len() || times.is_empty() {
                    let message =
                        format!("{} times and {} factors; give as many, at least one", times.len(), factors.len());
                    return Err(wrong(path, message));
                }
                for (index, &time) in times.iter().enumerate() {
                    finite(format!("{path}.times[{index}]"), time)?;
                    if index > 0 && time <= times[index - 1] {
                        let message =
                            format!("{time:?} does not lie beyond {:?}; times must increase", times[index - 1]);
                        return Err(wrong(format!("{path}.times[{index}]"), message));
                    }
                    finite(format!("{path}.factors[{index}]"), factors[index])?;
                }
                ("table", TimeFunction::Table(times.iter().copied().zip(factors.iter().copied()).collect()))
            }
            FactorSpec::Sine(sine) => ("sine", TimeFunction::Sine { frequency: sine.frequency, phase: sine.phase }),
            FactorSpec::Ramp(ramp) => ("ramp", TimeFunction::Ramp { start: ramp.start, end: ramp.end }),
            FactorSpec::Pulse(pulse) => ("pulse", TimeFunction::Pulse { start: pulse.start, end: pulse.end }),
        };
        function.check().map_err(|error| located(error, &format!("{path}.factor.{name}.")))?;
        Ok(function)
    }
}
