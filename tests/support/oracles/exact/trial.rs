//! One random problem, the questions to the program, and every fault of its answers.
#![expect(clippy::disallowed_methods, reason = "a panic is a finding")]

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use signorini::qp::Error;
use signorini::{Condense, ContactProblem, Method, Settings, solve};

use super::Draws;
use super::case::{Case, is_length};
use super::judge::{Fault, Judge, Sort};
use super::loads::load;
use super::problem::Exact;
use super::rows::{ROWS, Rows};
use super::solve::Outcome;
use super::stiffness::KINDS;

/// Most iterations of a solve: problems of this size take fewer than half.
const LONG: usize = 400;

/// Number of wrong answers of a problem that are verified.
const VERIFIED: usize = 4;

/// A problem of some kind, and the state of its random numbers.
pub struct Trial {
    pub kind: &'static str,
    pub rows: &'static str,
    pub case: Case,
    draws: Draws,
}

/// The findings of a trial.
#[derive(Clone, Debug)]
pub struct Report {
    /// The name of the exact outcome of the trial.
    pub verdict: &'static str,
    /// `true` if the program had to certify the problem.
    pub is_fair: bool,
    /// `true` if rounding of the data decides how the problem ends.
    pub is_borderline: bool,
    pub faults: Vec<Fault>,
    /// The longest solve, in seconds.
    pub longest: f64,
    pub exact_seconds: f64,
}

/// Problem `number` of a seed; if `kind` is `None`, the number determines the kind of stiffness.
pub fn draw(seed: u64, number: u64, kind: Option<&str>) -> Trial {
    let mut draws = Draws::of(seed, number);
    let named = KINDS.iter().position(|entry| Some(entry.0) == kind);
    let (kind, make) = KINDS[named.unwrap_or(number as usize % KINDS.len())];
    let (rows_kind, make_rows) = ROWS[draws.below(ROWS.len())];
    let stiffness = make(&mut draws);
    let n = stiffness.len();
    let point: Vec<f64> = match draws.below(3) {
        0 => vec![0.0; n],
        1 => (0..n).map(|_| f64::from(draws.between(-4, 4)) / 2.0).collect(),
        _ => (0..n).map(|_| draws.signed()).collect(),
    };
    // A point with few bits gives gaps without rounding, so that rows meet in it exactly.
    let at_vertex = rows_kind == "vertex";
    let point = if at_vertex { point.iter().map(|x| (4.0 * x).round() / 4.0).collect() } else { point };
    let mut rows = make_rows(&mut draws, &point);
    shuffle(&mut draws, &mut rows);
    let load = load(&mut draws, &stiffness, &rows, &point, at_vertex);
    let mut case = Case { stiffness, load, contact: rows.contact, gap: rows.gap };
    if kind == "scaled-dofs" {
        scale_dofs(&mut draws, &mut case);
    }
    if draws.one_in(4) {
        scale_rows(&mut draws, &mut case);
    }
    if draws.one_in(8) {
        change_units(&mut draws, &mut case);
    }
    Trial { kind, rows: rows_kind, case, draws }
}

fn shuffle(draws: &mut Draws, rows: &mut Rows) {
    for row in (1..rows.gap.len()).rev() {
        let other = draws.below(row + 1);
        rows.contact.swap(row, other);
        rows.gap.swap(row, other);
    }
}

/// Scales dofs by 2^-27 to 2^27, and most rows to match.
fn scale_dofs(draws: &mut Draws, case: &mut Case) {
    let unit: Vec<f64> = (0..case.dofs()).map(|_| 2.0_f64.powi(draws.between(-27, 27))).collect();
    for i in 0..unit.len() {
        (0..unit.len()).for_each(|j| case.stiffness[i][j] *= unit[i] * unit[j]);
        case.load[i] *= unit[i];
    }
    case.contact.iter_mut().for_each(|row| row.iter_mut().zip(&unit).for_each(|(b, unit)| *b *= unit));
    if draws.one_in(4) {
        return;
    }
    for (row, gap) in case.contact.iter_mut().zip(&mut case.gap).filter(|entry| entry.0.iter().any(|&b| b != 0.0)) {
        let largest = row.iter().fold(0.0_f64, |largest, b| largest.max(b.abs()));
        scale_row(row, gap, 2.0_f64.powf(-largest.log2().round()));
    }
}

fn scale_row(row: &mut [f64], gap: &mut f64, unit: f64) {
    row.iter_mut().for_each(|b| *b *= unit);
    // An infinite gap stays infinite, and a finite gap stays finite.
    let scaled = *gap * unit;
    if is_length(*gap) && is_length(scaled) {
        *gap = scaled;
    }
}

fn scale_rows(draws: &mut Draws, case: &mut Case) {
    for (row, gap) in case.contact.iter_mut().zip(&mut case.gap) {
        scale_row(row, gap, 2.0_f64.powi(draws.between(-20, 20)));
    }
}

/// Changes the units of length and force.
fn change_units(draws: &mut Draws, case: &mut Case) {
    let (length, force) = (draws.between(-40, 40), draws.between(-40, 40));
    case.stiffness.iter_mut().flatten().for_each(|value| *value *= 2.0_f64.powi(force - length));
    case.load.iter_mut().for_each(|value| *value *= 2.0_f64.powi(force));
    // An infinite gap stays infinite, and a finite gap stays finite.
    case.gap.iter_mut().filter(|gap| is_length(**gap)).for_each(|gap| *gap *= 2.0_f64.powi(length));
}

impl Trial {
    /// Solves the problem exactly, asks the program, and judges all its answers.
    pub fn run(&self) -> Report {
        let mut draws = self.draws.clone();
        let start = Instant::now();
        let exact = Exact::new(&self.case);
        let outcome = exact.outcome();
        let exact_seconds = start.elapsed().as_secs_f64();
        let judge = Judge::new(&self.case, &exact, &outcome);
        let mut report = Report {
            verdict: judge.verdict(),
            is_fair: judge.is_fair(),
            is_borderline: judge.is_borderline(),
            faults: Vec::new(),
            longest: 0.0,
            exact_seconds,
        };
        let problem = match self.case.problem() {
            Ok(problem) => problem,
            Err(error) if matches!(outcome, Outcome::Indefinite { .. }) => {
                drop(error);
                return report;
            }
            Err(error) => {
                report.faults.push(Fault::new(Sort::Claim, format!("the problem is refused: {error}")));
                return report;
            }
        };
        let mut auto = Settings::default();
        auto.prove = true;
        self.ask(&judge, &problem, &auto, true, &mut report);
        let other = settings(&mut draws);
        self.ask(&judge, &problem, &other, false, &mut report);
        for _ in 0..VERIFIED {
            let (name, u, lambda) = self.wrong(&mut draws, &exact, &outcome);
            let start = Instant::now();
            let asked = format!("verify {name}");
            let faults = catch_unwind(AssertUnwindSafe(|| judge.verified(&asked, &problem, &u, &lambda)));
            report.longest = report.longest.max(start.elapsed().as_secs_f64());
            report.faults.extend(faults.unwrap_or_else(|_| vec![Fault::new(Sort::Panic, asked)]));
        }
        report
    }

    fn ask(&self, judge: &Judge, problem: &ContactProblem, settings: &Settings, must_end: bool, report: &mut Report) {
        let (start, asked) = (Instant::now(), words(settings));
        let ending = catch_unwind(AssertUnwindSafe(|| solve(problem, settings)));
        report.longest = report.longest.max(start.elapsed().as_secs_f64());
        let iterations = match &ending {
            Ok(Ok(solution)) => solution.iterations,
            Ok(Err(Error::NotCertified { solution, .. })) => solution.iterations,
            _ => 0,
        };
        if iterations > LONG {
            report.faults.push(Fault::new(Sort::Slow, format!("{asked}: {iterations} iterations")));
        }
        match ending {
            Ok(ending) => report.faults.extend(judge.ending(&asked, settings.goal(), &ending, must_end)),
            Err(_) => report.faults.push(Fault::new(Sort::Panic, asked)),
        }
    }

    /// A wrong answer, made from the exact one: its name, u and lambda.
    fn wrong(&self, draws: &mut Draws, exact: &Exact, outcome: &Outcome) -> (String, Vec<f64>, Vec<f64>) {
        let (n, m) = (self.case.dofs(), self.case.rows());
        let zero = || ("zero".to_string(), vec![0.0; n], vec![0.0; m]);
        let Outcome::Solved(answer) = outcome else {
            let u = (0..n).map(|_| draws.signed()).collect();
            return if draws.one_in(2) { zero() } else { ("anything".to_string(), u, vec![0.0; m]) };
        };
        let (mut u, mut lambda) = exact.rounded(&self.case, answer);
        let size = draws.decades(1e-16, 1.0);
        match draws.below(8) {
            0 => zero(),
            1 => ("rounded".to_string(), u, lambda),
            2 => {
                u.iter_mut().for_each(|value| *value *= 1.0 + size * draws.signed());
                lambda.iter_mut().for_each(|value| *value *= 1.0 + size * draws.signed());
                ("perturbed".to_string(), u, lambda)
            }
            3 => {
                let dof = draws.below(n);
                u[dof] += size * draws.signed() * u.iter().fold(1e-3, |largest: f64, value| largest.max(value.abs()));
                (format!("perturbed in dof {dof}"), u, lambda)
            }
            4 => {
                let parts = super::measure::parts(&self.case);
                let factor = draws.pick(&[0.0, 0.5, 1.0 + size]);
                draws.pick(&parts).into_iter().for_each(|dof| u[dof] *= factor);
                ("with a part moved".to_string(), u, lambda)
            }
            5 if m > 0 => {
                let (one, other) = (draws.below(m), draws.below(m));
                lambda.swap(one, other);
                ("with swapped forces".to_string(), u, lambda)
            }
            _ if m > 0 => self.of_another(draws, u, lambda),
            _ => zero(),
        }
    }

    /// The exact answer of the same problem with a row left out, or with a row at another gap.
    fn of_another(&self, draws: &mut Draws, u: Vec<f64>, lambda: Vec<f64>) -> (String, Vec<f64>, Vec<f64>) {
        let (row, mut other) = (draws.below(self.case.rows()), self.case.clone());
        let is_dropped = draws.one_in(2);
        if is_dropped {
            other.gap[row] = f64::INFINITY;
        } else if other.is_bounded(row) {
            let off = draws.decades(1e-12, 1.0) * draws.pick(&[1.0, -1.0]);
            other.gap[row] += off * if other.gap[row] == 0.0 { 1.0 } else { other.gap[row].abs() };
        }
        let exact = Exact::new(&other);
        let Outcome::Solved(answer) = exact.outcome() else { return ("rounded".to_string(), u, lambda) };
        let (u, lambda) = exact.rounded(&self.case, &answer);
        (if is_dropped { format!("without row {row}") } else { format!("with row {row} moved") }, u, lambda)
    }
}

/// A method with options.
fn settings(draws: &mut Draws) -> Settings {
    let methods = [Method::Auto, Method::qp(), Method::ActiveSet, Method::penalty(), Method::Mprgp];
    let mut settings = Settings::with_method(draws.pick(&methods));
    if draws.one_in(4) {
        settings.condense = Condense::Never;
    }
    if draws.one_in(4) {
        settings.tolerance = Some(draws.pick(&[1e-4, 1e-6, 1e-8, 1e-11]));
    }
    if draws.one_in(3) {
        settings.accuracy = Some(10.0_f64.powi(-draws.between(2, 10)));
    }
    // The streams of the seeds stay what they were when a precision was drawn here.
    draws.one_in(6);
    if draws.one_in(16) {
        settings.time = Some(std::time::Duration::ZERO);
    }
    let (polish, prove) = (!draws.one_in(6), draws.one_in(2));
    // As above: an extrapolation was drawn here.
    draws.one_in(4);
    settings.prove = prove;
    if let Method::Qp(options) = &mut settings.method {
        options.polish = polish;
    }
    settings
}

/// The settings in words, similar to the command line.
fn words(settings: &Settings) -> String {
    let mut words = vec![settings.method.name().to_string(), format!("tolerance {:e}", settings.goal().tolerance)];
    words.extend(settings.accuracy.map(|accuracy| format!("accuracy {accuracy:e}")));
    let marks = [
        (settings.condense == Condense::Never, "all dofs"),
        (settings.prove, "proving"),
        (matches!(settings.method, Method::Qp(options) if !options.polish), "unpolished"),
        (settings.time.is_some(), "without time"),
    ];
    words.extend(marks.into_iter().filter(|mark| mark.0).map(|mark| mark.1.to_string()));
    words.join(", ")
}
