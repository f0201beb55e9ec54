//! An answer where the stiffness is singular, by steps with a stiffness that is not.

use crate::error::Error;
use crate::qp::attempts;
use crate::qp::judged::not_decided;
use crate::qp::linear::{SparseMatrix, SymmetricMatrix, ldexp};
use crate::qp::problem::ContactProblem;
use crate::qp::settings::{Method, Precision, Settings};
use crate::qp::transform::Scaling;
use crate::solution::Solution;

/// Exponent of rho: on a diagonal of order one, far above rounding and far below what resists.
const STEP: i32 = -20;

/// What a step with the added diagonal makes of rounding is below this share of its terms.
const OF_STEP: f64 = 1e-14;

/// A step gains something if the square of its length is below this share of that of the one before.
const SHORTER: f64 = 1e-2;

/// Steps after which one that gains nothing is the last: the first finds a place, the second its forces.
const FEWEST_STEPS: usize = 3;

/// Steps with `K + rho E`, each of which takes a factor `rho / eigenvalue` off the error.
const MOST_STEPS: usize = 12;

/// The diagonal of `rho E`.
fn added(scaling: &Scaling) -> Vec<f64> {
    let equilibration = scaling.equilibration();
    equilibration.diagonal.iter().map(|d| ldexp(1.0, STEP - equilibration.factor - 2 * d)).collect()
}

/// An answer by steps with `K + rho E`, E the diagonal that the scaling makes the identity: minimise the energy plus
/// `rho/2` times the squared distance, in E, from the last answer.
///
/// # Errors
/// Those of the solves, with [`Error::Infeasible`] for contact rows that contradict each other.
///
/// # Source
/// R. T. Rockafellar, *Monotone operators and the proximal point algorithm*, SIAM J. Control Optim. 14 (1976) 877-898.
pub(super) fn answer(
    problem: &ContactProblem,
    scaling: &Scaling,
    settings: &Settings,
    before: Error,
) -> Result<Solution, Error> {
    let added = added(scaling);
    let stiffness = with_diagonal(problem.stiffness(), &added)?;
    let dofs = problem.dofs();
    let settings_of_step = Settings {
        method: Method::ActiveSet,
        precision: Precision::Double,
        accuracy: None,
        prove: false,
        ..settings.clone()
    };
    // The pivot of K itself, not of the steps.
    let lost_pivot = match &before {
        Error::NotCertified { solution, .. } => solution.lost_pivot,
        _ => None,
    };
    let mut best: Option<Solution> = None;
    let (mut centre, mut before_last) = (vec![0.0; dofs], f64::INFINITY);
    for step in 1..=MOST_STEPS {
        let load = (problem.load().iter().zip(&added).zip(&centre)).map(|((f, e), u)| f + e * u).collect();
        let of_step = ContactProblem::new(stiffness.clone(), load, problem.contact().clone(), problem.gap().to_vec())?;
        let found = match attempts::solved(&of_step, &settings_of_step) {
            Ok(solution) => solution,
            Err(Error::NotCertified { solution, .. }) => *solution,
            Err(infeasible @ Error::Infeasible { .. }) => return Err(infeasible),
            Err(_) => break,
        };
        let moved = (0..dofs).map(|dof| added[dof] * (found.displacement[dof] - centre[dof]).powi(2)).sum::<f64>();
        centre.clone_from(&found.displacement);
        // The steps become shorter until they are rounding, also where the conditions cannot tell.
        let mut is_better = moved < SHORTER * before_last;
        before_last = moved;
        for (displacement, multiplier) in without_rounding(problem, &added, &centre, &found.multiplier) {
            let certificate = problem.certify(&displacement, &multiplier)?;
            if best.as_ref().is_none_or(|best| certificate.worst().1 < 0.5 * best.certificate.worst().1) {
                let reason = Some(format!("by {step} steps with K + rho E, since the stiffness is singular: {before}"));
                let answer = Solution { displacement, multiplier, certificate, reason, lost_pivot, ..found.clone() };
                best = Some(answer);
                is_better = true;
            }
        }
        if settings.watch.is_over() || step >= FEWEST_STEPS && !is_better {
            break;
        }
    }
    match best {
        Some(solution) => Ok(solution),
        None => Err(not_decided(problem, before)?),
    }
}

fn with_diagonal(stiffness: &SymmetricMatrix, added: &[f64]) -> Result<SymmetricMatrix, Error> {
    let diagonal = added.iter().enumerate().map(|(dof, &value)| (dof, dof, value));
    let entries: Vec<(usize, usize, f64)> = stiffness.lower().triplets().chain(diagonal).collect();
    SymmetricMatrix::from_lower(SparseMatrix::from_triplets(added.len(), added.len(), &entries)?)
}

/// An answer of a step as it is, without the forces that the added diagonal makes of the rounding of the displacement, and
/// also without the displacements that such forces make.
fn without_rounding(problem: &ContactProblem, added: &[f64], u: &[f64], lambda: &[f64]) -> [(Vec<f64>, Vec<f64>); 3] {
    let mut rounding = vec![0.0_f64; problem.rows()];
    for (row, dof, b) in problem.contact().triplets().filter(|entry| entry.2 != 0.0) {
        rounding[row] = rounding[row].max(OF_STEP * (added[dof] * u[dof] / b).abs());
    }
    let counts = |(&force, least): (&f64, &f64)| if force.abs() > *least { force } else { 0.0 };
    let pressing: Vec<f64> = lambda.iter().zip(&rounding).map(counts).collect();
    let forces = problem.contact().mul_abs_transposed(&absolute(&pressing));
    let left = problem.contact().mul_abs_transposed(&rounding);
    let alone = problem.stiffness().diagonal();
    let moved = |dof: usize| {
        let least = left[dof] + OF_STEP * (forces[dof] + problem.load()[dof].abs());
        if (alone[dof] + added[dof]) * u[dof].abs() > least { u[dof] } else { 0.0 }
    };
    [(u.to_vec(), lambda.to_vec()), (u.to_vec(), pressing.clone()), ((0..u.len()).map(moved).collect(), pressing)]
}

fn absolute(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| value.abs()).collect()
}
