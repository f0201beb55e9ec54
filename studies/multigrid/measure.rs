//! The measurements, each of which runs in a process of its own.

use signorini::{Error, Method, Model, Prepared, Settings, qp};
use std::time::Instant;

use serde_json::{Value, json};
use signorini::qp::Multigrid;

use crate::clock::timed;
use crate::process::peak_bytes;

/// Relative residual of the linear solve, and tolerance of the contact solve.
const TOLERANCE: f64 = 1e-8;

const MOST_CYCLES: usize = 2000;

/// Returns the processor seconds of all threads of this process, or wall-clock seconds if the system does not report
/// them.
fn processor_seconds(start: Instant) -> f64 {
    let from_system = || -> Option<f64> {
        let mut sum = 0.0;
        for thread in std::fs::read_dir("/proc/self/task").ok()? {
            let text = std::fs::read_to_string(thread.ok()?.path().join("schedstat")).ok()?;
            sum += 1e-9 * text.split_whitespace().next()?.parse::<f64>().ok()?;
        }
        Some(sum)
    };
    std::thread::yield_now();
    from_system().unwrap_or_else(|| start.elapsed().as_secs_f64())
}

/// Measures hierarchy, linear solve and contact solve of a model on the given number of threads.
pub fn iterative(model: &Model, threads: usize) -> Result<Value, Error> {
    let (problem, clock) = (model.problem(), Instant::now());
    let start = processor_seconds(clock);
    let since = |from: f64| processor_seconds(clock) - from;
    let settings = Settings::with_method(Method::Mprgp).with_tolerance(TOLERANCE).with_threads(threads);
    let prepared = Prepared::new(problem, &settings)?;
    let (set_up, set_up_clock) = (since(start), clock.elapsed().as_secs_f64());
    let multigrid: &Multigrid = prepared.hierarchy().ok_or(qp::Error::Interrupted)?;
    let load = problem.contact().mul_transposed(&vec![-1.0; problem.rows()]);
    let (from, from_clock) = (processor_seconds(clock), clock.elapsed().as_secs_f64());
    // A body that is supported by contact only has a singular stiffness, so that no linear solve is measured.
    let linear = match multigrid.is_shifted() {
        true => None,
        false => Some(multigrid.preconditioning(problem.stiffness()).solve(&load, TOLERANCE, MOST_CYCLES)?.cycles),
    };
    let (linear_seconds, linear_clock) = (since(from), clock.elapsed().as_secs_f64() - from_clock);
    let (from, from_clock) = (processor_seconds(clock), clock.elapsed().as_secs_f64());
    let contact = prepared.solve(problem.gap())?;
    let (contact_seconds, contact_clock) = (since(from), clock.elapsed().as_secs_f64() - from_clock);
    let worst = contact.certificate.conditions().iter().fold(0.0, |worst: f64, entry| worst.max(entry.1));
    Ok(json!({
        "dofs": problem.dofs(), "rows": problem.rows(), "unknowns": multigrid.unknowns(), "bytes": multigrid.bytes(),
        "set_up": set_up, "linear_cycles": linear, "linear": linear_seconds,
        "contact_cycles": contact.iterations, "contact": contact_seconds, "sets": contact.history.len(),
        "closed": contact.contact_set.count(), "certificate": worst,
        "energy_error_bound": contact.certificate.energy_error_bound,
        "closed_rows": contact.contact_set.iter().collect::<Vec<_>>(),
        "wall": {"set_up": set_up_clock, "linear": linear_clock, "contact": contact_clock},
        "peak_bytes": peak_bytes(),
    }))
}

/// Runs set-up and contact solve on one thread and on two threads alternately in this process. Returns the smallest
/// wall-clock seconds of each, and whether both answers are equal bit by bit.
pub fn threads(model: &Model, runs: usize) -> Result<Value, Error> {
    let problem = model.problem();
    let settings = Settings::with_method(Method::Mprgp).with_tolerance(TOLERANCE);
    let mut least = [[f64::INFINITY; 2]; 2];
    let mut answers: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
    for _ in 0..runs {
        for threads in [1, 2] {
            let [set_up, contact] = &mut least[threads - 1];
            let (prepared, seconds) = timed(|| Prepared::new(problem, &settings.clone().with_threads(threads)));
            *set_up = set_up.min(seconds);
            let prepared = prepared?;
            let (solution, seconds) = timed(|| prepared.solve(problem.gap()));
            *contact = contact.min(seconds);
            answers[threads - 1] = solution?.displacement;
        }
    }
    let [one, two] = least;
    Ok(json!({
        "dofs": problem.dofs(), "one": one, "two": two, "ratio_set_up": two[0] / one[0], "ratio_contact": two[1] / one[1],
        "ratio": (two[0] + two[1]) / (one[0] + one[1]), "same": answers[0] == answers[1],
    }))
}

/// Measures one factorisation and the contact solve by the active-set method.
pub fn direct(model: &Model) -> Result<Value, Error> {
    let clock = Instant::now();
    let start = processor_seconds(clock);
    let prepared = Prepared::new(model.problem(), &Settings::with_method(Method::ActiveSet))?;
    let contact = prepared.solve(model.problem().gap())?;
    Ok(json!({
        "dofs": model.problem().dofs(), "contact": processor_seconds(clock) - start,
        "closed_rows": contact.contact_set.iter().collect::<Vec<_>>(), "peak_bytes": peak_bytes(),
    }))
}
