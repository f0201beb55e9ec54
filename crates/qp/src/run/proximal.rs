//! An answer for a singular stiffness, by steps with a regular one.

use std::sync::Arc;

use super::{Run, Workbench, answered};
use crate::certificate::Bounding;
use crate::engine::Load;
use crate::error::{Error, Result};
use crate::linear::SymmetricMatrix;
use crate::method::Start;
use crate::plan::{Answered, Best, Ended, Ladder, Record};
use crate::problem::ContactProblem;
use crate::settings::Settings;
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

impl Run<'_> {
    pub fn by_proximal_steps(&mut self, record: &mut Record) -> Result<Ended> {
        let Some(existence) = &self.existence else { return Ok(Ended::Empty) };
        let before = self.history.records.iter().rev().find(|record| record.answer.is_some());
        let because = before.map_or_else(String::new, |record| record.shortfall(self.settings.goal()));
        let lost_pivot = self.history.best.as_ref().and_then(|best| best.solution.lost_pivot);
        let found = answers(&existence.scaling, self.problem, self.settings)?;
        let mut all: Option<Answered> = None;
        for solution in found {
            let asks = |best: &Best| best.solution.certificate.asks_for_more(self.settings.goal());
            if all.is_some() && self.history.best.as_ref().is_some_and(|best| !asks(best)) {
                break;
            }
            let reason = format!("{}: {because}", solution.reason);
            let solution = Solution { reason, lost_pivot, ..solution };
            let answer = Best::of(solution, record.attempt);
            let answered = self.judged(answer, &Bounding::OwnFactor, record)?;
            all = Some(all.map_or(answered, |all| all.or(answered)));
        }
        Ok(all.map_or(Ended::Empty, Ended::Answered))
    }
}

/// Answers by steps with `K + rho E`, E the diagonal that the scaling makes the identity: minimise the energy plus
/// `rho/2` times the squared distance, in E, from the last answer. The steps share a factor, and each starts from the
/// set of the last. The answers of the last two are returned, the last first, without a certificate for the problem
/// itself; each also without the rounding of its step, which comes before the answer as it is.
///
/// # Source
/// R. T. Rockafellar, *Monotone operators and the proximal point algorithm*, SIAM J. Control Optim. 14 (1976) 877-898.
fn answers(scaling: &Scaling, problem: &ContactProblem, settings: &Settings) -> Result<Vec<Solution>> {
    let added = scaling.identity(STEP);
    let (load, gap) = (problem.load(), problem.gap().to_vec());
    let stiffness = problem.stiffness().combined(1.0, 1.0, &SymmetricMatrix::of_diagonal(added.clone()))?;
    let mut of_step = ContactProblem::computed(stiffness, load.to_vec(), problem.contact().clone(), gap)?;
    let settings = &settings.of_question();
    let ladder = Ladder::of(&of_step, MOST_STEPS, true, settings)?.without_existence();
    let (mut start, mut kept): (Start, Option<Workbench>) = (Start::default(), None);
    let (mut last, mut before): (Vec<Solution>, Vec<Solution>) = (Vec::new(), Vec::new());
    let (mut centre, mut before_last) = (vec![0.0; problem.dofs()], f64::INFINITY);
    for step in 1..=MOST_STEPS {
        let mut run = Run::new(&of_step, &ladder, &start, settings);
        run.made = kept.take();
        let found = answered(&mut run);
        kept = run.made;
        let found = match found {
            Ok(solution) => solution,
            Err(Error::NotCertified { solution, .. }) => *solution,
            Err(infeasible @ Error::Infeasible { .. }) => return Err(infeasible),
            Err(_) => break,
        };
        let lengths = added.iter().zip(found.displacement.iter().zip(&centre));
        let moved = lengths.map(|(e, (u, centre))| e * (u - centre).powi(2)).sum::<f64>();
        // The steps become shorter until they are rounding.
        let is_shorter = moved < SHORTER * before_last;
        (before_last, start) = (moved, Start::from(&found.contact_set));
        centre.clone_from(&found.displacement);
        let reason = format!("by {step} steps with K + rho E, since the stiffness is singular");
        let found = Solution { reason, why: Why::default(), attempts: Vec::new(), ..found };
        let each = without_rounding(problem, &added, &centre, &found.multiplier).into_iter().rev();
        let each = each.map(|(displacement, multiplier)| Solution { displacement, multiplier, ..found.clone() });
        before = std::mem::replace(&mut last, each.collect());
        if settings.watch.is_over() || step >= FEWEST_STEPS && !is_shorter {
            break;
        }
        let load: Vec<f64> = load.iter().zip(&added).zip(&centre).map(|((f, e), u)| f + e * u).collect();
        of_step = of_step.with_load(load.clone())?;
        kept = kept.map(|bench| Workbench { load: Arc::new(Load::new(load)), ..bench });
    }
    last.append(&mut before);
    Ok(last)
}

/// The answer of a step, also without forces that are rounding of it, and without the displacements that they cause.
fn without_rounding(problem: &ContactProblem, added: &[f64], u: &[f64], lambda: &[f64]) -> [(Vec<f64>, Vec<f64>); 3] {
    let mut rounding = vec![0.0_f64; problem.rows()];
    for (row, dof, b) in problem.contact().triplets().filter(|entry| entry.2 != 0.0) {
        rounding[row] = rounding[row].max(OF_STEP * (added[dof] * u[dof] / b).abs());
    }
    let counts = |(&force, least): (&f64, &f64)| if force.abs() > *least { force } else { 0.0 };
    let pressing: Vec<f64> = lambda.iter().zip(&rounding).map(counts).collect();
    let sizes: Vec<f64> = pressing.iter().map(|force| force.abs()).collect();
    let forces = problem.contact().mul_abs_transposed(&sizes);
    let left = problem.contact().mul_abs_transposed(&rounding);
    let alone = problem.stiffness().diagonal();
    let moved = |dof: usize| {
        let least = left[dof] + OF_STEP * (forces[dof] + problem.load()[dof].abs());
        if (alone[dof] + added[dof]) * u[dof].abs() > least { u[dof] } else { 0.0 }
    };
    [(u.to_vec(), lambda.to_vec()), (u.to_vec(), pressing.clone()), ((0..u.len()).map(moved).collect(), pressing)]
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;
    use crate::linear::watch::Watch;

    /// Two dofs, each with its own row: `stiffness` on the diagonal.
    fn two(stiffness: [f64; 2], load: [f64; 2], gap: [f64; 2]) -> ContactProblem {
        let diagonal = |values: [f64; 2]| [(0, 0, values[0]), (1, 1, values[1])];
        ContactProblem::of_entries(&diagonal(stiffness), &load, &diagonal([1.0; 2]), &gap)
    }

    #[test]
    fn steps_end_with_the_answer_when_they_gain_nothing() {
        // A dof of stiffness 2 under a force of 4 before a wall at 3, and one that a force of 3 presses to one at 1/2.
        let problem = two([2.0, 0.0], [4.0, 3.0], [3.0, 0.5]);
        let counts = Arc::new([AtomicUsize::new(0), AtomicUsize::new(0)]);
        let counted = Arc::clone(&counts);
        let watch = Watch::observed(move |watch| {
            for (count, step) in counted.iter().zip(["certificate", "factorisation"]) {
                count.fetch_add(usize::from(watch.activity().step == step), Ordering::SeqCst);
            }
        });
        let settings = Settings { watch, ..Settings::default() };
        let scaling = Scaling::of(problem.stiffness(), problem.contact()).unwrap();
        let found = answers(&scaling, &problem, &settings.started().unwrap()).unwrap();
        assert!(found.iter().all(|found| found.displacement == [2.0, 0.5] && found.multiplier[1] == -3.0));
        // Each step multiplies the error by 2^-20: the third leaves less than the last bit, the fourth is rounding.
        let [solves, factors] = [0, 1].map(|count| counts[count].load(Ordering::SeqCst));
        assert!((FEWEST_STEPS..=5).contains(&solves), "{solves}");
        assert_eq!(factors, 1);
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
