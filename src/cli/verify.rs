//! `signorini verify`: the certificate of an answer that came from elsewhere.

use super::complementarity;
use super::options::Verify;
use super::outcome::{Outcome, Report, unfit, warn};
use crate::Error;
use crate::lcp::Lcp;
use crate::output::InWords;
use crate::qp::{Settings, Watch, memory, read_problem, read_vector};
use crate::scene::Units;
use crate::study::{ModelSize, Verification};

pub(super) fn run(options: &Verify, watch: &Watch) -> Result<Outcome, Error> {
    if Lcp::is_directory(&options.directory)? {
        return complementarity::verify(options);
    }
    let (Some(displacement), Some(multiplier)) = (&options.displacement, &options.multiplier) else {
        return unfit("--z", "the directory has no q.mtx, of a complementarity problem, to which this option belongs");
    };
    // The available memory is asked for before the problem takes its own.
    let memory = Some(memory::allowed(options.max_memory));
    let displacement = read_vector(displacement)?;
    let multiplier = read_vector(multiplier)?;
    let problem = read_problem(&options.directory)?;
    let (threads, tolerance) = (options.threads, Some(options.tolerance));
    let mut settings = Settings::default().watched(watch);
    settings.threads = threads;
    (settings.memory, settings.tolerance) = (memory, tolerance);
    let mut of_rows = multiplier.clone();
    match &options.equality_multiplier {
        Some(file) => of_rows.extend(read_vector(file)?),
        None if problem.equality_rows() > 0 => {
            let message = "the problem has equality rows (E.mtx); name the file of their multiplier";
            return unfit("--equality-multiplier", message);
        }
        None => {}
    }
    warn(&problem.warnings().iter().map(|(_, warning)| format!("warning: {warning}\n")).collect::<String>());
    let certificate = problem.certify_within(options.factor_time, (&displacement, &of_rows), &settings)?;
    let verification = Verification::new(certificate, &multiplier, ModelSize::of(&problem), options.tolerance);
    let text = verification.text(&format!("Problem directory {}", options.directory.display()), &Units::unnamed());
    Ok(Report::new(&verification, text)?.outcome(options.format, verification.status))
}
