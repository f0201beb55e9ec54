//! An answer for a singular stiffness, by steps with a regular one.

use super::cone::Solve;
use crate::error::Error;
use crate::linear::{SparseMatrix, SymmetricMatrix, ldexp};
use crate::problem::ContactProblem;
use crate::settings::{Method, Precision, Settings};
use crate::solution::{Solution, Why};
use crate::transform::Scaling;

/// Exponent of rho: on a diagonal of order one, far above rounding and far below all eigenvalues except zero.
const STEP: i32 = -20;

/// The rounding of a step with the added diagonal is below this share of its terms.
const OF_STEP: f64 = 1e-14;

/// A step gains something if the square of its length is below this share of that of the previous one.
const SHORTER: f64 = 1e-2;

/// After this number of steps, one that gains nothing is the last: the first finds a place, the second its forces.
const FEWEST_STEPS: usize = 3;

/// Largest number of steps with `K + rho E`; each multiplies the error by `rho / eigenvalue`.
const MOST_STEPS: usize = 12;

/// The diagonal of `rho E`.
fn added(scaling: &Scaling) -> Vec<f64> {
    let equilibration = scaling.equilibration();
    equilibration.diagonal.iter().map(|d| ldexp(1.0, STEP - equilibration.factor - 2 * d)).collect()
}

/// Answers by steps with `K + rho E`, E the diagonal that the scaling makes the identity: minimise the energy plus
/// `rho/2` times the squared distance, in E, from the last answer. Those of the last two steps are returned, without a
/// certificate for the problem itself, each also without the rounding of its step.
///
/// # Errors
/// [`Error::Infeasible`] for contact rows that contradict each other.
///
/// # Source
/// R. T. Rockafellar, *Monotone operators and the proximal point algorithm*, SIAM J. Control Optim. 14 (1976) 877-898.
pub(super) fn answers(
    scaling: &Scaling,
    problem: &ContactProblem,
    settings: &Settings,
    solve: Solve,
) -> Result<Vec<Solution>, Error> {
    let added = added(scaling);
    let stiffness = with_diagonal(problem.stiffness(), &added)?;
    let dofs = problem.dofs();
    let settings_of_step = settings_of_step(settings);
    let (mut last, mut answers) = (Vec::new(), Vec::new());
    let (mut centre, mut before_last) = (vec![0.0; dofs], f64::INFINITY);
    for step in 1..=MOST_STEPS {
        let load = (problem.load().iter().zip(&added).zip(&centre)).map(|((f, e), u)| f + e * u).collect();
        let of_step =
            ContactProblem::computed(stiffness.clone(), load, problem.contact().clone(), problem.gap().to_vec())?;
        let found = match solve(&of_step, &settings_of_step) {
            Ok(solution) => solution,
            Err(Error::NotCertified { solution, .. }) => *solution,
            Err(infeasible @ Error::Infeasible { .. }) => return Err(infeasible),
            Err(_) => break,
        };
        let moved = (0..dofs).map(|dof| added[dof] * (found.displacement[dof] - centre[dof]).powi(2)).sum::<f64>();
        centre.clone_from(&found.displacement);
        // The steps become shorter until they are rounding.
        let is_shorter = moved < SHORTER * before_last;
        before_last = moved;
        let reason = format!("by {step} steps with K + rho E, since the stiffness is singular");
        let found = Solution { reason, why: Why::default(), attempts: Vec::new(), ..found };
        let each = without_rounding(problem, &added, &centre, &found.multiplier).into_iter();
        let each = each.map(|(displacement, multiplier)| Solution { displacement, multiplier, ..found.clone() });
        answers = std::mem::replace(&mut last, each.collect());
        if settings.watch.is_over() || step >= FEWEST_STEPS && !is_shorter {
            break;
        }
    }
    answers.append(&mut last);
    Ok(answers)
}

/// Checks that some displacement meets the rows: the nearest to rest, in E.
///
/// # Errors
/// [`Error::Infeasible`] for contact rows that contradict each other; if that is not decided, they count as met.
pub(super) fn check_rows(
    scaling: &Scaling,
    problem: &ContactProblem,
    settings: &Settings,
    solve: Solve,
) -> Result<(), Error> {
    let diagonal: Vec<_> = added(scaling).into_iter().enumerate().map(|(dof, value)| (dof, dof, value)).collect();
    let dofs = problem.dofs();
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(dofs, dofs, &diagonal)?)?;
    let nearest =
        ContactProblem::computed(stiffness, vec![0.0; dofs], problem.contact().clone(), problem.gap().to_vec())?;
    match solve(&nearest, &settings_of_step(settings)) {
        Err(infeasible @ Error::Infeasible { .. }) => Err(infeasible),
        _ => Ok(()),
    }
}

/// The settings of a step.
fn settings_of_step(settings: &Settings) -> Settings {
    let (method, precision) = (Method::ActiveSet, Precision::Double);
    Settings { method, precision, accuracy: None, prove: false, ..settings.clone() }
}

fn with_diagonal(stiffness: &SymmetricMatrix, added: &[f64]) -> Result<SymmetricMatrix, Error> {
    let diagonal = added.iter().enumerate().map(|(dof, &value)| (dof, dof, value));
    let entries: Vec<(usize, usize, f64)> = stiffness.lower().triplets().chain(diagonal).collect();
    SymmetricMatrix::from_lower(SparseMatrix::from_triplets(added.len(), added.len(), &entries)?)
}

/// The answer of a step: unchanged, without forces that come from the added diagonal and the rounding of the
/// displacement, and also without the displacements that such forces cause.
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

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;
    use crate::solve;
    use crate::watch::Watch;

    /// Two dofs, each with its own row: `stiffness` on the diagonal.
    fn two(stiffness: [f64; 2], load: [f64; 2], gap: [f64; 2]) -> ContactProblem {
        let diagonal = |values: [f64; 2]| [(0, 0, values[0]), (1, 1, values[1])];
        ContactProblem::of_entries(&diagonal(stiffness), &load, &diagonal([1.0; 2]), &gap)
    }

    #[test]
    fn steps_end_with_the_answer_when_they_gain_nothing() {
        // A dof of stiffness 2 under a force of 4 before a wall at 3, and one that a force of 3 presses to a wall at
        // 1/2.
        let problem = two([2.0, 0.0], [4.0, 3.0], [3.0, 0.5]);
        let solves = Arc::new(AtomicUsize::new(0));
        let counted = Arc::clone(&solves);
        let watch = Watch::observed(move |watch| {
            counted.fetch_add(usize::from(watch.activity().step == "certificate"), Ordering::SeqCst);
        });
        let settings = Settings { watch, ..Settings::default() };
        let scaling = Scaling::of(problem.stiffness(), problem.contact()).unwrap();
        let found = answers(&scaling, &problem, &settings, solve).unwrap();
        assert!(found.iter().all(|found| found.displacement == [2.0, 0.5] && found.multiplier[1] == -3.0));
        // Each step multiplies the error by about 2^-20: the third leaves less than the last bit, the fourth has the
        // length of rounding, and there is no fifth.
        let solves = solves.load(Ordering::SeqCst);
        assert!((FEWEST_STEPS..=5).contains(&solves), "{solves}");
    }

    #[test]
    fn forces_and_displacements_within_rounding_of_a_step_are_left_out() {
        let problem = two([2.0, 2.0], [4.0, 1.0], [3.0, 3.0]);
        // With the added diagonal of 1/2, a displacement of one has a rounding of OF_STEP / 2.
        let kept_force = |share: f64| {
            let force = -share * OF_STEP / 2.0;
            without_rounding(&problem, &[0.5; 2], &[1.0, 0.0], &[force, 0.0])[1].1[0] / force
        };
        assert_eq!((kept_force(0.9), kept_force(1.1)), (0.0, 1.0));
        // On the second dof a load of one is rounded by OF_STEP, against a stiffness of 2 and the added 1/2. The
        // rounding of its own row is a share of OF_STEP of that.
        let is_kept = |share: f64| {
            let small = share * OF_STEP / 2.5;
            let [.., (u, _)] = without_rounding(&problem, &[0.5; 2], &[1.0, small], &[0.0; 2]);
            assert!(u[0] == 1.0 && (u[1] == small || u[1] == 0.0), "{u:?}");
            u[1] != 0.0
        };
        assert!(is_kept(1.1) && !is_kept(0.9));
    }
}
