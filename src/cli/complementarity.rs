//! `solve`, `compare` and `verify` for the directory of a complementarity problem.

use std::path::Path;
use std::time::Instant;

use serde_json::{Value, json};

use super::failure::{ended, sentence};
use super::options::{Common, Compare, Format, Solve, Verify};
use super::outcome::{Outcome, Report, unfit};
use super::settings::settings;
use crate::Error;
use crate::lcp::{Error as LcpError, Lcp, LcpSolution, solve_lcp};
use crate::output::{listed, printable, remove_files, write_files};
use crate::qp::{self, ContactSet, Method, Watch, format_vector, read_vector};
use crate::study::Status;

/// Two certified answers must agree to this share of the largest entry, or within their bounds, as those of contact
/// problems.
const AGREEMENT: f64 = 1e-8;

/// A problem that was read, with its title, the seconds of reading and the tolerance of its answers.
struct Case {
    lcp: Lcp,
    title: String,
    read_seconds: f64,
    tolerance: f64,
}

impl Case {
    fn read(directory: &Path, tolerance: f64) -> Result<Self, LcpError> {
        let clock = Instant::now();
        let (lcp, title) = (Lcp::read(directory)?, format!("Complementarity problem {}", directory.display()));
        Ok(Case { lcp, title, read_seconds: clock.elapsed().as_secs_f64(), tolerance })
    }

    fn status(&self, solution: &LcpSolution) -> Status {
        if solution.worst().1 <= self.tolerance { Status::Certified } else { Status::NotCertified }
    }

    /// Numbers of unknowns at the lower bound, at the upper bound, and between.
    fn places(&self, solution: &LcpSolution) -> [usize; 3] {
        let mut places = [0; 3];
        for (i, &z) in solution.z.iter().enumerate() {
            places[if z <= self.lcp.lower()[i] { 0 } else { 1 + usize::from(z < self.lcp.upper()[i]) }] += 1;
        }
        places
    }

    fn json(&self, solution: &LcpSolution) -> Value {
        let ((unknown, residual), [lower, upper, between]) = (solution.worst(), self.places(solution));
        let (of_z, of_w) = (Bound::of(&solution.error), Bound::of(&solution.image_error));
        let proven = solution.proven.each_ref().map(ContactSet::count);
        json!({
            "status": self.status(solution), "tolerance": self.tolerance, "method": solution.method,
            "iterations": solution.iterations, "class": solution.class, "unique": unique(solution),
            "residual": residual, "worst_unknown": unknown,
            "error_bound": of_z.largest(), "error_bound_w": of_w.largest(),
            "no_error_bound": of_z.reason(), "no_error_bound_w": of_w.reason(),
            "places": { "lower": lower, "upper": upper, "between": between },
            "proven": {
                "lower": proven[0], "between": proven[1], "upper": proven[2],
                "undecided": self.lcp.unknowns() - proven.iter().sum::<usize>(),
            },
            "model": { "unknowns": self.lcp.unknowns(), "entries": self.lcp.matrix().entries() },
            "seconds": {
                "assemble": self.read_seconds, "solve": solution.seconds, "total": self.read_seconds + solution.seconds,
            },
        })
    }

    fn text(&self, solution: &LcpSolution) -> String {
        let (unknowns, entries) = (self.lcp.unknowns(), self.lcp.matrix().entries());
        let ((unknown, residual), [lower, upper, between]) = (solution.worst(), self.places(solution));
        let proven: usize = solution.proven.iter().map(ContactSet::count).sum();
        let verdict = match self.status(solution) {
            Status::Certified => format!("certified to {:.1e}", self.tolerance),
            _ => format!("NOT certified to {:.1e}", self.tolerance),
        };
        let seconds = format!("read {:.3}, solve {:.3}", self.read_seconds, solution.seconds);
        let lines = [
            ("model", vec![format!("n = {unknowns}, {entries} entries of M")]),
            ("class", vec![class_in_words(solution).into()]),
            ("method", vec![format!("{}, iterations: {}", solution.method, solution.iterations)]),
            (
                "solution",
                vec![
                    format!("at the lower bound {lower}, at the upper bound {upper}, between {between}"),
                    format!("proven places {proven}, undecided {}", unknowns - proven),
                    uniqueness_in_words(solution).into(),
                ],
            ),
            (
                "certificate",
                vec![
                    verdict,
                    format!(
                        "residual z - mid(l, z - w, u)   {residual:.1e} of its terms, at unknown {unknown}, counted from 0"
                    ),
                    format!("error |z - z*|   {}", Bound::of(&solution.error).in_words()),
                    format!("error |w - w*|   {}", Bound::of(&solution.image_error).in_words()),
                ],
            ),
            ("seconds", vec![seconds]),
        ];
        let lines = lines.into_iter().map(|(name, sentences)| listed(name, sentences));
        format!("{}\n{}", printable(&self.title), lines.collect::<String>())
    }

    /// The agreement of two answers in the part that all solutions share.
    fn agreement(&self, one: &LcpSolution, other: &LcpSolution) -> Agreement {
        let (of, [a, b], errors) = match one.is_unique {
            Some(true) => ("z", [&one.z, &other.z], [&one.error, &other.error]),
            Some(false) => ("w", [&one.w, &other.w], [&one.image_error, &other.image_error]),
            None => return Agreement { of: "neither", difference: None, holds: true },
        };
        let apart: Vec<f64> = a.iter().zip(b).map(|(a, b)| (a - b).abs()).collect();
        // What cancels in w is rounded in the size of its terms.
        let scale = match of {
            "z" => qp::largest(a),
            _ => qp::largest(&self.lcp.matrix().mul_abs(&one.z)).max(qp::largest(self.lcp.offset())),
        };
        let difference = if qp::largest(&apart) == 0.0 { 0.0 } else { qp::largest(&apart) / scale };
        let is_bounded = match errors {
            [Ok(a), Ok(b)] => apart.iter().zip(a.iter().zip(b)).all(|(apart, (a, b))| *apart <= a + b),
            _ => false,
        };
        Agreement { of, difference: Some(difference), holds: is_bounded || difference <= AGREEMENT }
    }

    /// The table of a comparison.
    fn table(&self, ends: &[End; 3], agreements: &[Option<Agreement>], status: Status) -> String {
        let head = format!(
            "  {:<16}{:<20}{:>9}{:>12}{:>11}{:>11}{:>11}\n",
            "", "method", "seconds", "iterations", "residual", "bound", "difference"
        );
        let lines = BY.iter().zip(ends).zip(agreements).map(|(((by, _), end), agreement)| match end {
            Ok(solution) => {
                let number = |value: Option<f64>| value.map_or_else(|| "-".to_string(), |value| format!("{value:.1e}"));
                format!(
                    "  {by:<16}{:<20}{:>9.3}{:>12}{:>11}{:>11}{:>11}\n",
                    solution.method,
                    solution.seconds,
                    solution.iterations,
                    number(Some(solution.worst().1)),
                    number(Bound::of(&solution.error).largest()),
                    number(agreement.and_then(|agreement| agreement.difference)),
                )
            }
            Err((_, reason)) => format!("  {by:<16}none\n{}", listed("", vec![reason.clone()])),
        });
        let of = agreements.iter().flatten().next().map_or("neither", |agreement| agreement.of);
        let verdict = match (status, of) {
            (Status::Certified, "neither") => {
                "all certified answers solve the problem; they need not be the same".to_string()
            }
            (Status::Certified, of) => format!("the certified answers agree in {of}"),
            (_, "neither") => "no method has a certified answer".to_string(),
            (_, of) => format!("the certified answers differ in {of}"),
        };
        format!("{}\n{head}{}{}", printable(&self.title), lines.collect::<String>(), listed("agreement", vec![verdict]))
    }
}

/// The agreement of an answer with the first certified one: of z, of w, or of neither.
#[derive(Clone, Copy)]
struct Agreement {
    of: &'static str,
    /// The largest difference, relative.
    difference: Option<f64>,
    /// `true` if it lies within the bounds of both, or is rounding.
    holds: bool,
}

/// The bound on the error of a point, or the reason why there is none.
struct Bound<'a>(Result<(usize, f64), &'a str>);

impl<'a> Bound<'a> {
    fn of(errors: &'a Result<Vec<f64>, String>) -> Self {
        let largest = |errors: &Vec<f64>| errors.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        Bound(errors.as_ref().map(|errors| largest(errors).unwrap_or_default()).map_err(String::as_str))
    }

    fn largest(&self) -> Option<f64> {
        self.0.ok().map(|(_, error)| error)
    }

    fn reason(&self) -> Option<&str> {
        self.0.err()
    }

    fn in_words(&self) -> String {
        match self.0 {
            Ok((at, error)) => format!("at most {error:.1e} in each entry, absolute, this much at unknown {at}"),
            Err(reason) => format!("no bound: {reason}"),
        }
    }
}

fn class_in_words(solution: &LcpSolution) -> &'static str {
    match (solution.class, solution.is_unique) {
        ("symmetric", Some(_)) => "M is symmetric and positive semidefinite",
        ("symmetric", None) => "M is symmetric and, as far as rounding tells, positive semidefinite",
        ("symmetrizable", Some(_)) => "M with its rows in other units is symmetric to rounding, and semidefinite",
        ("symmetrizable", None) => "M with its rows in other units is symmetric and semidefinite, to rounding",
        ("h-matrix", _) => "M is an H-matrix with positive diagonal",
        ("monotone", Some(_)) => {
            "M is monotone: M + M' is positive definite, perhaps with the rows of M in other units"
        }
        ("monotone", None) => "M is monotone as far as rounding tells: M + M' is positive semidefinite",
        ("p-matrix", _) => "M is a P-matrix: all principal minors are positive",
        _ => "M belongs to no class for which a solution is sure to be found",
    }
}

fn unique(solution: &LcpSolution) -> &'static str {
    match solution.is_unique {
        Some(true) => "one",
        Some(false) => "several",
        None => "unknown",
    }
}

fn uniqueness_in_words(solution: &LcpSolution) -> &'static str {
    match solution.is_unique {
        Some(true) => "there is no other solution",
        Some(false) => "all solutions have the same w; whether there are other z is open",
        None => "nothing is proven about other solutions",
    }
}

/// The end of a command with an error of the complementarity problem.
fn refused(error: LcpError, format: Format) -> Result<Outcome, Error> {
    match error {
        LcpError::Qp(error) => Err(error.into()),
        error => Ok(ended(&sentence(&error), (error.status(), error.code()), error.failure(), format)),
    }
}

/// Refuses options that have no effect on a complementarity problem.
fn check_options(options: &Solve) -> Result<(), Error> {
    let given = [
        ("--accuracy", options.accuracy.is_some()),
        ("--explain", options.explain),
        ("--plan", options.plan),
        ("--start", options.start.is_some()),
        ("--precision", options.precision.is_some()),
        ("--no-proof", options.no_proof),
        ("--total-error", options.total_error.is_some()),
        ("--along", !options.along.is_empty()),
        ("--refine-in-time", options.refine_in_time),
        ("--resume", options.resume),
    ];
    match given.into_iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => unfit(
            option,
            "the directory is that of a complementarity problem (q.mtx), on which this option has no effect",
        ),
        None => Ok(()),
    }
}

pub(super) fn solve(options: &Solve, watch: &Watch) -> Result<Outcome, Error> {
    let common = &options.common;
    check_options(options)?;
    let case = match Case::read(&options.input, common.tolerance) {
        Ok(case) => case,
        Err(error) => return refused(error, common.format),
    };
    watch.step("solve", 0);
    let solution = match solve_lcp(&case.lcp, &settings(options.method, common, watch)) {
        Ok(solution) => solution,
        Err(error @ LcpError::NotCertified { .. }) => {
            let why = sentence(&error);
            let LcpError::NotCertified { solution, .. } = error else { return refused(error, common.format) };
            return Ok(reported(&case, &solution, common)?.because(Some(why)));
        }
        Err(error) => {
            if let (LcpError::Infeasible { ray, .. }, Some(folder)) = (&error, &common.out) {
                write_files(folder, &[("y.mtx", &format_vector(ray))])?;
                remove_files(folder, &["z.mtx", "w.mtx"])?;
            }
            return refused(error, common.format);
        }
    };
    reported(&case, &solution, common)
}

/// Prints the report; its folder gets z, w and the same as JSON.
fn reported(case: &Case, solution: &LcpSolution, common: &Common) -> Result<Outcome, Error> {
    let report = Report::new(&case.json(solution), case.text(solution))?;
    if let Some(folder) = &common.out {
        write_files(folder, &solution.files())?;
        remove_files(folder, &["y.mtx"])?;
        report.write(folder)?;
    }
    Ok(report.outcome(common.format, case.status(solution)))
}

pub(super) fn verify(options: &Verify) -> Result<Outcome, Error> {
    let Some(file) = &options.z else {
        let message = "the directory is that of a complementarity problem (q.mtx), whose answer is given as --z z.mtx";
        return unfit("--displacement", message);
    };
    let z = read_vector(file)?;
    let certified = Case::read(&options.directory, options.tolerance)
        .and_then(|case| case.lcp.certify(&z).map(|solution| (case, solution)));
    match certified {
        Ok((case, solution)) => {
            let report = Report::new(&case.json(&solution), case.text(&solution))?;
            Ok(report.outcome(options.format, case.status(&solution)))
        }
        Err(error) => refused(error, options.format),
    }
}

/// The three methods of a comparison.
const BY: [(&str, Method); 3] =
    [("interior-point", Method::qp()), ("pivoting", Method::ActiveSet), ("penalty", Method::penalty())];

/// What a method of a comparison ended with: a point, or the status and the reason without one.
type End = Result<LcpSolution, (&'static str, String)>;

pub(super) fn compare(options: &Compare, watch: &Watch) -> Result<Outcome, Error> {
    let common = &options.common;
    let compared = Case::read(&options.input, common.tolerance).and_then(|case| {
        let ends = ends(&case, common, watch)?;
        Ok((case, ends))
    });
    let (case, ends) = match compared {
        Ok(compared) => compared,
        Err(error) => return refused(error, common.format),
    };
    watch.step("report", 0);
    let certified = |end: &End| end.as_ref().is_ok_and(|solution| case.status(solution) == Status::Certified);
    let reference = ends.iter().find(|end| certified(end)).and_then(|end| end.as_ref().ok());
    let agreements: Vec<Option<Agreement>> =
        ends.iter().map(|end| Some(case.agreement(reference?, end.as_ref().ok()?))).collect();
    let agree =
        ends.iter().zip(&agreements).all(|(end, agreement)| !certified(end) || agreement.is_none_or(|a| a.holds));
    let status = if agree && reference.is_some() { Status::Certified } else { Status::NotCertified };
    let row = |(by, end): (&str, &End)| match end {
        Ok(solution) => {
            let mut report = case.json(solution);
            report["by"] = by.into();
            report
        }
        Err((status, reason)) => json!({ "by": by, "status": status, "reason": reason }),
    };
    let names = BY.map(|(by, _)| by);
    let difference = |by: &str| {
        let at = names.iter().position(|name| *name == by)?;
        agreements[at].map(|agreement| agreement.difference)
    };
    let report = json!({
        "methods": names.into_iter().zip(&ends).map(row).collect::<Vec<_>>(),
        "agreement": {
            "certified_answers": agree && reference.is_some(), "of": agreements.iter().flatten().next().map(|a| a.of),
            "interior_point": difference("interior-point"), "pivoting": difference("pivoting"),
            "penalty": difference("penalty"),
        },
    });
    let report = Report::new(&report, case.table(&ends, &agreements, status))?;
    if let Some(folder) = &common.out {
        if let Some(solution) = reference {
            write_files(folder, &solution.files())?;
        }
        report.write(folder)?;
    }
    Ok(report.outcome(common.format, status))
}

/// The ends of the three methods.
fn ends(case: &Case, common: &Common, watch: &Watch) -> Result<[End; 3], LcpError> {
    let run = |number: usize| match solve_lcp(&case.lcp, &settings(BY[number].1, common, watch)) {
        Ok(solution) => Ok(Ok(solution)),
        Err(LcpError::NotCertified { solution, .. }) => Ok(Ok(*solution)),
        Err(error @ LcpError::NotFound { .. }) => Ok(Err((error.status(), sentence(&error)))),
        Err(error) => Err(error),
    };
    let run = |number: usize| {
        watch.part("method", number + 1, BY.len());
        run(number)
    };
    Ok([run(0)?, run(1)?, run(2)?])
}
