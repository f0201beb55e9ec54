//! One entry of the table: a problem with a known solution, and the result of each method.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use signorini::qp::Error;
use signorini::{Condense, ContactProblem, Method, Penalty, Settings, SparseMatrix, solve};

/// Rounding error of the entries of a stiffness, relative to its diagonal.
const OF_ENTRIES: f64 = 512.0 * f64::EPSILON;

/// A certified answer counts as wrong if its error exceeds its own bound and this multiple of its tolerance.
const WRONG: f64 = 1e3;

/// Allowed error of a force, as a multiple of the bound on the error of the displacement in energy.
const OF_BOUND: f64 = 2.0;

/// Above this number of dofs only condensed problems are solved, because the others would take minutes.
const LARGE: usize = 100_000;

/// Tolerance of a penalty answer. Its error is the compliance of the penalty springs, 1e-8 of the local compliance.
const PENALTY_TOLERANCE: f64 = 1e-6;

/// The known part of the solution.
#[derive(Clone, Copy, Debug)]
pub enum Truth {
    /// The total contact force.
    Force(f64),
    /// The largest displacement of a problem without contact.
    Reach(f64),
    /// The problem has no solution.
    None,
}

/// A problem with the known part of its solution.
pub struct Entry {
    pub group: &'static str,
    pub label: String,
    pub problem: ContactProblem,
    pub truth: Truth,
    /// The penalty in multiples of the stiffness, if only the penalty method is run.
    pub penalty: Option<f64>,
}

/// The columns of the table of extremes: paths through the program.
pub const COLUMNS: [&str; 7] = ["QP raw", "QP", "QP full", "active set", "active set full", "penalty", "penalty full"];

/// The result of one method.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cell {
    /// The answer is certified (by the raw method: called solved) and has this number of right digits.
    Digits(u32),
    /// The answer is certified, or called solved, and wrong.
    Wrong,
    /// The problem is refused with this error code.
    Refused(String),
    /// The method was not run.
    Absent,
}

impl std::fmt::Display for Cell {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Cell::Digits(digits) => write!(f, "{digits}"),
            Cell::Wrong => f.write_str("wrong"),
            Cell::Refused(code) => f.write_str(code),
            Cell::Absent => f.write_str("-"),
        }
    }
}

impl Entry {
    pub fn new(group: &'static str, label: impl Into<String>, problem: ContactProblem, truth: Truth) -> Self {
        Entry { group, label: label.into(), problem, truth, penalty: None }
    }

    /// Runs all methods and returns one cell for each of [`COLUMNS`].
    pub fn row(&self) -> Vec<Cell> {
        let solved = |method, condense| {
            let mut settings = Settings::with_method(method);
            settings.condense = condense;
            if method == Method::penalty() {
                settings.tolerance = Some(PENALTY_TOLERANCE);
                if let Some(penalty) = self.penalty {
                    let one = Penalty { first: penalty, last: penalty, ..Penalty::default() };
                    settings.method = Method::Penalty(one);
                }
            }
            match solve(&self.problem, &settings) {
                Ok(solution) => {
                    let bound = Some(solution.certificate.energy_error_bound).filter(|bound| bound.is_finite());
                    // The stiffness of a scene is rounded itself; the effect grows as its smallest pivot decreases.
                    let of_entries = solution.lost_pivot().map_or(0.0, |pivot| OF_ENTRIES / pivot);
                    let tolerance =
                        (WRONG * settings.goal().tolerance).max(OF_BOUND * bound.unwrap_or(0.0)).max(of_entries);
                    self.judge(&solution.displacement, &solution.multiplier, tolerance)
                }
                Err(Error::NotCertified { .. }) => Cell::Refused("not certified".into()),
                Err(error) => Cell::Refused(error.code().replace('-', " ")),
            }
        };
        let is_large = self.problem.dofs() > LARGE;
        let (mut cells, methods) = (Vec::new(), [Method::qp(), Method::ActiveSet, Method::penalty()]);
        let only_penalty = self.penalty.is_some();
        cells.push(if only_penalty || is_large { Cell::Absent } else { self.raw() });
        for method in methods {
            for condense in [Condense::Auto, Condense::Never] {
                let runs = (!only_penalty || method == Method::penalty()) && (!is_large || condense == Condense::Auto);
                cells.push(if runs { solved(method, condense) } else { Cell::Absent });
            }
        }
        cells
    }

    fn judge(&self, displacement: &[f64], multiplier: &[f64], tolerance: f64) -> Cell {
        let largest = |values: &[f64]| values.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
        let (found, truth) = match self.truth {
            Truth::Force(force) => (-multiplier.iter().sum::<f64>(), force),
            Truth::Reach(reach) => (largest(displacement), reach),
            Truth::None => return Cell::Wrong,
        };
        let error = if found == truth { 0.0 } else { ((found - truth) / truth).abs() };
        let right = error <= tolerance;
        if right { Cell::Digits((-error.max(1e-15).log10()).round() as u32) } else { Cell::Wrong }
    }

    /// Runs Clarabel with its defaults on the unscaled data, which shows why this library scales them.
    fn raw(&self) -> Cell {
        let matrix = |matrix: &SparseMatrix| {
            let (starts, rows) =
                (matrix.column_starts().to_vec(), matrix.row_indices().map(|row| row as usize).collect());
            CscMatrix::new(matrix.rows(), matrix.columns(), starts, rows, matrix.values().to_vec())
        };
        if self.problem.dofs() == 0 {
            return Cell::Absent;
        }
        let (p, a) = (matrix(&self.problem.stiffness().upper()), matrix(self.problem.contact()));
        let q: Vec<f64> = self.problem.load().iter().map(|force| -force).collect();
        let cones = [SupportedConeT::NonnegativeConeT(self.problem.rows())];
        let settings = DefaultSettings::<f64> { verbose: false, max_threads: 1, ..DefaultSettings::default() };
        let Ok(mut solver) = DefaultSolver::new(&p, &q, &a, self.problem.gap(), &cones, settings) else {
            return Cell::Refused("set-up".into());
        };
        solver.solve();
        match solver.solution.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => {
                let multiplier: Vec<f64> = solver.solution.z.iter().map(|z| -z).collect();
                self.judge(&solver.solution.x, &multiplier, WRONG * PENALTY_TOLERANCE)
            }
            status => Cell::Refused(status.to_string().to_lowercase()),
        }
    }
}
