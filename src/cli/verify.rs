//! `signorini verify`: the certificate of an answer that came from elsewhere.

use super::options::Verify;
use super::outcome::{Outcome, Report};
use crate::error::Error;
use crate::output::verify_text;
use crate::qp::{read_problem, read_vector};
use crate::study::{ModelSize, Verification};

pub(super) fn run(options: &Verify) -> Result<Outcome, Error> {
    let problem = read_problem(&options.directory)?;
    let displacement = read_vector(&options.displacement)?;
    let multiplier = read_vector(&options.multiplier)?;
    let certificate = problem.certify(&displacement, &multiplier)?;
    let verification = Verification::new(certificate, &multiplier, ModelSize::of(&problem), options.tolerance);
    let text = verify_text(&format!("Problem directory {}", options.directory.display()), &verification);
    Ok(Report::new(&verification, text)?.outcome(options.format, verification.status))
}
