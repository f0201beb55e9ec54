//! The QP by Clarabel's interior-point method. The only place that names clarabel, and that knows z = -lambda.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverError, SolverStatus, SupportedConeT};

use super::ScaledProblem;
use crate::error::Error;
use crate::qp::barrier::guarded;
use crate::qp::linear::{SparseMatrix, exponent, largest, ldexp};
use crate::qp::problem::ContactProblem;
use crate::solution::ContactSet;
use crate::watch::Watch;

/// A gap this many times the displacement is out of reach: the row is left out, where it would only spoil the scale.
const OUT_OF_REACH: f64 = 1e12;

/// The answer is computed again in other units while its size is off by more than 2 to this power.
const UNIT_EXPONENT: i32 = 6;

/// Below 2 to minus this power a displacement is nothing but the tolerance.
const NOTHING_EXPONENT: i32 = 60;

/// Times that the unit is corrected.
const UNIT_CORRECTIONS: usize = 4;

/// Steps after which more do not help: on ill-conditioned data the residuals stall, and the barrier falls on.
const MAX_STEPS: u32 = 50;

/// What the interior-point method ended with.
#[derive(Clone, Debug)]
pub struct InteriorPoint {
    /// Displacement v, one entry per dof.
    pub displacement: Vec<f64>,
    /// Multiplier -z, one entry per row, `<= 0`.
    pub multiplier: Vec<f64>,
    /// Rows with `z / z_scale > s / s_scale`.
    pub contact_set: ContactSet,
    /// Interior-point steps, over all units that were tried.
    pub iterations: usize,
}

impl InteriorPoint {
    /// No displacement and no closed row: what there is to say where nothing was found or no row is there to close.
    pub fn nothing_found(problem: &ContactProblem) -> Self {
        InteriorPoint {
            displacement: vec![0.0; problem.dofs()],
            multiplier: vec![0.0; problem.rows()],
            contact_set: ContactSet::open(problem.rows()),
            iterations: 0,
        }
    }
}

/// Solves the QP to `tolerance`, relative to data of order one.
///
/// An ending without full accuracy is no error here: the set is settled and the answer certified later. A problem that
/// is reported as unbounded or infeasible returns with no closed row, for others to find the motion or the rows.
///
/// # Errors
/// [`Error::Numerical`] if the solver refuses its input.
pub fn solve(scaled: &ScaledProblem, tolerance: f64) -> Result<InteriorPoint, Error> {
    let problem = scaled.problem;
    let mut unit = Unit { displacement: 0, force: exponent(largest(problem.load())) };
    let mut iterations = 0;
    let mut corrections = 0;
    loop {
        let mut found = solve_in_unit(problem, tolerance, unit, scaled.watch())?;
        iterations += found.iterations;
        found.iterations = iterations;
        let size = largest(&found.displacement);
        let displacement = exponent(size) - unit.displacement;
        let force = exponent(largest(&found.multiplier).max(largest(problem.load()))) - unit.force;
        let fits = displacement.abs().max(force.abs()) <= UNIT_EXPONENT;
        if fits
            || size == 0.0
            || scaled.watch().is_over()
            || displacement < -NOTHING_EXPONENT
            || corrections == UNIT_CORRECTIONS
        {
            return Ok(found);
        }
        unit = Unit { displacement: unit.displacement + displacement, force: unit.force + force };
        corrections += 1;
    }
}

/// Units in which the answer is of order one, as exponents of two: where a fine mesh makes the stiffness large beside
/// the forces, multipliers of order one in the scaled problem would need a displacement far beyond the gap.
#[derive(Clone, Copy, Debug)]
struct Unit {
    displacement: i32,
    force: i32,
}

fn solve_in_unit(problem: &ContactProblem, tolerance: f64, unit: Unit, watch: &Watch) -> Result<InteriorPoint, Error> {
    let gap: Vec<f64> = problem.gap().iter().map(|&g| ldexp(g, -unit.displacement)).collect();
    let rows: Vec<usize> = (0..gap.len()).filter(|&row| gap[row] < OUT_OF_REACH).collect();
    let near_gap: Vec<f64> = rows.iter().map(|&row| gap[row]).collect();
    let q: Vec<f64> = problem.load().iter().map(|&f| -ldexp(f, -unit.force)).collect();
    let near_rows = problem.contact().select_rows(&rows);

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
    let (mut p, a) = (csc(&problem.stiffness().upper()), csc(&near_rows));
    p.nzval.iter_mut().for_each(|value| *value = ldexp(*value, unit.displacement - unit.force));
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
    let failed = |reason: String| Error::Numerical { step: "Clarabel", reason };
    let answer = solved.map_err(failed)?.map_err(|error: SolverError| failed(error.to_string()))?;
    let iterations = answer.iterations as usize;

    match answer.status {
        SolverStatus::PrimalInfeasible
        | SolverStatus::AlmostPrimalInfeasible
        | SolverStatus::DualInfeasible
        | SolverStatus::AlmostDualInfeasible => {}
        _ => {
            let mut multiplier = vec![0.0; problem.rows()];
            let mut contact_set = ContactSet::open(problem.rows());
            let (z_scale, s_scale) = (largest(&answer.z), largest(&answer.s).min(1.0));
            for (near, &row) in rows.iter().enumerate() {
                let (z, s) = (answer.z[near], answer.s[near]);
                multiplier[row] = -ldexp(z.max(0.0), unit.force);
                contact_set.set(row, z * s_scale > s * z_scale);
            }
            let displacement = answer.x.iter().map(|&x| ldexp(x, unit.displacement)).collect::<Vec<_>>();
            if displacement.iter().chain(&multiplier).all(|value| value.is_finite()) {
                return Ok(InteriorPoint { displacement, multiplier, contact_set, iterations });
            }
        }
    }
    Ok(InteriorPoint { iterations, ..InteriorPoint::nothing_found(problem) })
}

fn csc(matrix: &SparseMatrix) -> CscMatrix<f64> {
    CscMatrix::new(
        matrix.rows(),
        matrix.columns(),
        matrix.column_starts().to_vec(),
        matrix.row_indices().to_vec(),
        matrix.values().to_vec(),
    )
}
