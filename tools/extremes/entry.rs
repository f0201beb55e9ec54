//! One entry of the table: a problem whose answer is known, and how each method ends on it.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use signorini::Penalty;
use signorini::{Condense, ContactProblem, Error, Method, Settings, SparseMatrix, solve};

/// Rounding of the entries of a stiffness, as a share of its diagonal.
const OF_ENTRIES: f64 = 512.0 * f64::EPSILON;

/// A certified answer that is off by more than this times its tolerance, and by more than its own bound, is wrong.
const WRONG: f64 = 1e3;

/// The energy bound limits the error of the displacement; a force may miss by as much in its own measure.
const OF_BOUND: f64 = 2.0;

/// Beyond so many dofs only condensed problems are solved: the others would take minutes.
const LARGE: usize = 100_000;

/// What a penalty answer is held to: its error is the compliance of its springs, 1e-8 of the local one.
const PENALTY_TOLERANCE: f64 = 1e-6;

/// What is known of the answer.
#[derive(Clone, Copy, Debug)]
pub enum Truth {
    /// The total contact force.
    Force(f64),
    /// The largest displacement, where nothing touches.
    Reach(f64),
    /// There is no answer.
    None,
}

/// A problem with what is known of its answer.
pub struct Entry {
    pub group: &'static str,
    pub label: String,
    pub problem: ContactProblem,
    pub truth: Truth,
    /// The penalty in multiples of the stiffness, where only that is asked.
    pub penalty: Option<f64>,
}

/// The columns of the table.
pub const COLUMNS: [&str; 7] = ["QP raw", "QP", "QP full", "active set", "active set full", "penalty", "penalty full"];

/// How one method ends.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cell {
    /// Certified, with so many right digits; of the raw method: called solved.
    Digits(u32),
    /// Certified, or called solved, and wrong.
    Wrong,
    /// Refused, with this code.
    Refused(String),
    /// Not run.
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

    /// One cell for each of [`COLUMNS`].
    pub fn row(&self) -> Vec<Cell> {
        let solved = |method, condense| {
            let mut settings = Settings::with_method(method);
            settings.condense = condense;
            if method == Method::penalty() {
                settings.tolerance = PENALTY_TOLERANCE;
                if let Some(penalty) = self.penalty {
                    let one = Penalty { first: penalty, last: penalty, ..Penalty::default() };
                    settings.method = Method::Penalty(one);
                }
            }
            match solve(&self.problem, &settings) {
                Ok(solution) => {
                    let bound = Some(solution.certificate.energy_error_bound).filter(|bound| bound.is_finite());
                    // The stiffness of a scene is rounded itself; what that does grows as its smallest pivot falls.
                    let of_entries = solution.lost_pivot.map_or(0.0, |pivot| OF_ENTRIES / pivot);
                    let tolerance = (WRONG * settings.tolerance).max(OF_BOUND * bound.unwrap_or(0.0)).max(of_entries);
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

    /// Clarabel with its defaults, on the data as they are: why scaling is there.
    fn raw(&self) -> Cell {
        let matrix = |matrix: &SparseMatrix| {
            let (starts, rows) = (matrix.column_starts().to_vec(), matrix.row_indices().to_vec());
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
