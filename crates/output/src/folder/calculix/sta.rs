//! `NAME.sta`: the one increment of the one step.

use std::io::{self, Write};

use super::numbers;

/// Writes the file of a step that ends at a time.
pub(super) fn write(out: &mut dyn Write, time: f64) -> io::Result<()> {
    let time = numbers::time(time, 6);
    writeln!(out, "SUMMARY OF JOB INFORMATION")?;
    writeln!(out, "  STEP      INC     ATT  ITRS     TOT TIME     STEP TIME      INC TIME")?;
    writeln!(out, "{:>6}{:>11}{:>6}{:>6}  {time}  {time}  {time}", 1, 1, 1, 1)
}
