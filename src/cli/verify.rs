//! `signorini verify`: the certificate of an answer that came from elsewhere.

use super::options::{Verify, most_memory};
use super::outcome::{Outcome, Report};
use crate::error::Error;
use crate::output::verify_text;
use crate::qp::{Settings, certify_within, read_problem, read_vector};
use crate::study::{ModelSize, Verification};
use crate::watch::Watch;

pub(super) fn run(options: &Verify, watch: &Watch) -> Result<Outcome, Error> {
    // The available memory is asked for before the problem takes its own.
    let memory = Some(most_memory(options.max_memory));
    let displacement = read_vector(&options.displacement)?;
    let multiplier = read_vector(&options.multiplier)?;
    let problem = read_problem(&options.directory)?;
    let (threads, tolerance) = (options.threads, Some(options.tolerance));
    let settings = Settings { memory, threads, tolerance, watch: watch.clone(), ..Settings::default() };
    let certificate = certify_within(&problem, options.factor_time, (&displacement, &multiplier), &settings)?;
    let verification = Verification::new(certificate, &multiplier, ModelSize::of(&problem), options.tolerance);
    let text = verify_text(&format!("Problem directory {}", options.directory.display()), &verification);
    Ok(Report::new(&verification, text)?.outcome(options.format, verification.status))
}
