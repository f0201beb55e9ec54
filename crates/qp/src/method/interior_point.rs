//! The QP by Clarabel's interior-point method. The only module that uses clarabel, and the sign z = -lambda.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverError, SolverStatus, SupportedConeT};

use super::{Ending, Outcome, ScaledProblem};
use crate::error::{LinearError, Result};
use crate::linear::guarded;
use crate::linear::watch::Watch;
use crate::linear::{SparseMatrix, exponent, largest, ldexp};
use crate::problem::ContactProblem;
use crate::solution::{ContactSet, Iteration};

/// A gap this many times the displacement is out of reach: the row is left out, because it would only spoil the scale.
const OUT_OF_REACH: f64 = 1e12;

/// The answer is computed again in other units while the exponent of its size is off by more than this.
const UNIT_EXPONENT: i32 = 6;

/// A displacement below 2 to minus this power is only the tolerance.
const NOTHING_EXPONENT: i32 = 60;

const UNIT_CORRECTIONS: usize = 4;

/// After these steps more do not help: on ill-conditioned data the residuals stall while the barrier falls.
const MAX_STEPS: u32 = 50;

/// Options of [`Method::Qp`](crate::Method::Qp): its tolerance, and whether the active-set loop settles its contact
/// set.
///
/// ```
/// use signorini_qp::{InteriorPoint, Method, Settings};
///
/// let loose = InteriorPoint { polish: false, tolerance: 1e-4 };
/// let settings = Settings::with_method(Method::Qp(loose)).with_tolerance(1e-3);
/// assert_eq!(settings.method.name(), "qp");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InteriorPoint {
    /// `true` to settle the contact set by the active-set loop: the multipliers become those of a linear solve.
    pub polish: bool,
    /// Tolerance of the interior-point method, on data of order one.
    pub tolerance: f64,
}

impl InteriorPoint {
    /// Polished, to 1e-9.
    pub(crate) const DEFAULT: InteriorPoint = InteriorPoint { polish: true, tolerance: 1e-9 };
}

impl Default for InteriorPoint {
    fn default() -> Self {
        InteriorPoint::DEFAULT
    }
}

/// Solves the QP of a scaled problem to a tolerance that is relative to data of order one. The contact set is that of
/// the rows with `z / z_scale > s / s_scale`, and `iterations` counts the steps over all units that were tried.
///
/// Clarabel's claims of unbounded or infeasible problems are not believed: the outcome is then unsettled.
pub fn solve(scaled: &ScaledProblem, tolerance: f64) -> Result<Outcome> {
    let (problem, watch) = (scaled.problem, &scaled.watch);
    if problem.rows() == 0 {
        return Ok(unpolished(Outcome::at_rest(problem, Ending::Settled)));
    }
    // Units in which the answer is of order one, as exponents of two: if a fine grid makes the stiffness large beside
    // the forces, multipliers of order one in the scaled problem would need a displacement far beyond the gap.
    let mut units = [0, exponent(largest(problem.load()))];
    let (mut iterations, mut corrections) = (0, 0);
    loop {
        let found = solve_in_units(problem, tolerance, units, watch)?;
        iterations += found.iterations;
        let size = largest(&found.displacement);
        let next = [exponent(size), exponent(largest(&found.multiplier).max(largest(problem.load())))];
        let [displacement, force] = [next[0] - units[0], next[1] - units[1]];
        let fits = displacement.abs().max(force.abs()) <= UNIT_EXPONENT || size == 0.0;
        if fits || watch.is_over() || displacement < -NOTHING_EXPONENT || corrections == UNIT_CORRECTIONS {
            return Ok(Outcome { iterations, ..found });
        }
        units = next;
        corrections += 1;
    }
}

/// The answer of the interior-point method without polish, with its set as its history.
fn unpolished(outcome: Outcome) -> Outcome {
    let history = vec![Iteration { contact_set: outcome.contact_set.clone(), penalty: 0.0 }];
    Outcome { history, variant: "-unpolished", ..outcome }
}

/// Solves the QP of the rows within reach in these units of displacement and force.
fn solve_in_units(problem: &ContactProblem, tolerance: f64, units: [i32; 2], watch: &Watch) -> Result<Outcome> {
    let [length, force] = units;
    let gap: Vec<f64> = problem.gap().iter().map(|&g| ldexp(g, -length)).collect();
    let rows: Vec<usize> = (0..gap.len()).filter(|&row| gap[row] < OUT_OF_REACH).collect();
    let near_gap: Vec<f64> = rows.iter().map(|&row| gap[row]).collect();
    let q: Vec<f64> = problem.load().iter().map(|&f| -ldexp(f, -force)).collect();
    let settings = DefaultSettings::<f64> {
        verbose: false,
        tol_gap_abs: tolerance,
        tol_gap_rel: tolerance,
        tol_feas: tolerance,
        max_iter: MAX_STEPS,
        max_threads: 1,
        ..DefaultSettings::default()
    };
    let cones = [SupportedConeT::NonnegativeConeT(rows.len())];
    let (mut p, a) = (csc(&problem.stiffness().upper()), csc(&problem.contact().select_rows(&rows)));
    p.nzval.iter_mut().for_each(|value| *value = ldexp(*value, length - force));
    let watch = watch.clone();
    let solved = guarded(|| {
        let mut solver = DefaultSolver::new(&p, &q, &a, &near_gap, &cones, settings)?;
        solver.set_termination_callback(move |info| {
            watch.step("interior point", info.iterations as usize);
            watch.is_over()
        });
        solver.solve();
        Ok(solver.solution)
    });
    let failed = |reason: String| LinearError::Numerical { step: "Clarabel", reason };
    let answer = solved.map_err(failed)?.map_err(|error: SolverError| failed(error.to_string()))?;
    let iterations = answer.iterations as usize;
    let displacement: Vec<f64> = answer.x.iter().map(|&x| ldexp(x, length)).collect();
    let mut multiplier = vec![0.0; problem.rows()];
    let mut contact_set = ContactSet::open(problem.rows());
    let (z_scale, s_scale) = (largest(&answer.z), largest(&answer.s).min(1.0));
    for (near, &row) in rows.iter().enumerate() {
        let (z, s) = (answer.z[near], answer.s[near]);
        multiplier[row] = -ldexp(z.max(0.0), force);
        if z * s_scale > s * z_scale {
            contact_set.insert(row);
        }
    }
    let is_finite = displacement.iter().chain(&multiplier).all(|value| value.is_finite());
    let ending = Ending::of(matches!(answer.status, SolverStatus::Solved | SolverStatus::AlmostSolved));
    let is_claim = matches!(
        answer.status,
        SolverStatus::PrimalInfeasible
            | SolverStatus::AlmostPrimalInfeasible
            | SolverStatus::DualInfeasible
            | SolverStatus::AlmostDualInfeasible
    );
    let at_rest = Outcome { iterations, ..Outcome::at_rest(problem, Ending::Unsettled) };
    Ok(unpolished(match is_finite && !is_claim {
        true => Outcome { displacement, multiplier, contact_set, ending, ..at_rest },
        false => at_rest,
    }))
}

fn csc(matrix: &SparseMatrix) -> CscMatrix<f64> {
    CscMatrix::new(
        matrix.rows(),
        matrix.columns(),
        matrix.column_starts().to_vec(),
        matrix.row_indices().map(|row| row as usize).collect(),
        matrix.values().to_vec(),
    )
}
