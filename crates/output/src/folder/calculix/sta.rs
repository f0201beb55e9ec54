//! `NAME.sta`: the one increment of each step.

use std::io::{self, Write};

use super::numbers;
use signorini_mechanics::scene::Requests;

pub(super) fn write<'a>(out: &mut dyn Write, steps: impl Iterator<Item = &'a Requests>) -> io::Result<()> {
    writeln!(out, "SUMMARY OF JOB INFORMATION")?;
    writeln!(out, "  STEP      INC     ATT  ITRS     TOT TIME     STEP TIME      INC TIME")?;
    for of in steps {
        let [total, period] = [of.time, of.period].map(|time| numbers::time(time, 6));
        writeln!(out, "{:>6}{:>11}{:>6}{:>6}  {total}  {period}  {period}", of.step, 1, 1, 1)?;
    }
    Ok(())
}
