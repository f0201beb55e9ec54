//! One problem solved by three methods, and the agreement of their answers.

use serde::Serialize;
use signorini_qp as qp;

use super::summary::Status;
use super::tradeoff::{energy_norm, relative};
use signorini_mechanics::Error;
use signorini_qp::{ContactProblem, Method, Settings, Solution, largest, solve};

/// Two exact methods must agree in the displacement to this share of its largest entry: both end with a linear solve,
/// and the condition number of the stiffness may amplify its rounding a millionfold.
pub const DISPLACEMENT_AGREEMENT: f64 = 1e-8;

/// As [`DISPLACEMENT_AGREEMENT`], for the multipliers, which are differences of larger forces.
pub const MULTIPLIER_AGREEMENT: f64 = 1e-7;

/// Rows whose multiplier and distance are both below this, relative, are weakly active: both sets may contain them or
/// not.
pub const WEAKLY_ACTIVE: f64 = 1e-9;

/// Rounding of an energy norm that is recomputed.
const NORM_ROUNDING: f64 = 1e-12;

/// The answer of one of the three methods of a comparison, whether or not it meets the tolerance.
#[derive(Clone, Debug)]
pub struct MethodAnswer {
    /// The answer of the method, certified or not.
    pub solution: Solution,
    /// `true` if it meets the tolerance of the comparison.
    pub certified: bool,
}

/// The difference of an answer from that of the QP, in displacements, multipliers, closed rows and energy.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Largest difference of displacements, relative to the largest displacement.
    pub displacement: f64,
    /// Largest difference of multipliers, relative to the largest multiplier.
    pub multiplier: f64,
    /// Rows that one answer closes and the other does not, weakly active ones left out.
    pub rows: usize,
    /// Energy norm of the difference of displacements, relative to that of the answer.
    pub energy: f64,
}

/// The agreement of the methods of a comparison: whether two exact methods give one answer, and the penalty loop one
/// within its own bound.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Agreement {
    /// QP and active set: certified both, same contact set, displacement to 1e-8, multiplier to 1e-7.
    pub exact_methods: bool,
    /// `true` if the penalty answer is as close to the QP answer as its own certificate states.
    pub penalty_within_its_bound: bool,
    /// Active set against QP.
    pub active_set: Difference,
    /// Penalty against QP.
    pub penalty: Difference,
}

impl Agreement {
    /// Certified if the exact methods agree.
    pub fn status(&self) -> Status {
        if self.exact_methods { Status::Certified } else { Status::NotCertified }
    }
}

/// Answers of the QP, the active-set loop and the penalty loop to one problem, in this order, and their agreement.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The answers of the QP, the active-set loop and the penalty loop, in this order.
    pub answers: [MethodAnswer; 3],
    /// The differences between the three, and the verdict.
    pub agreement: Agreement,
}

/// Solves `problem` by the QP, the active-set loop and the penalty loop, and compares their answers.
///
/// # Errors
/// As [`solve`], but an answer that is not certified is an answer here; [`qp::Error::Interrupted`] if not all three
/// answers were computed.
pub fn compare(problem: &ContactProblem, settings: &Settings) -> Result<Comparison, Error> {
    let mut number = 0;
    let mut answer = |method| {
        number += 1;
        settings.watch.part("method", number, 3);
        match solve(problem, &settings.clone().by(method)) {
            Ok(solution) => Ok(MethodAnswer { solution, certified: true }),
            Err(_) if settings.watch.acknowledge() => Err(qp::Error::Interrupted),
            Err(qp::Error::NotCertified { solution, .. }) => Ok(MethodAnswer { solution: *solution, certified: false }),
            Err(error) => Err(error),
        }
    };
    let [qp, active_set, penalty] = [answer(Method::qp())?, answer(Method::ActiveSet)?, answer(Method::penalty())?];
    let to_active_set = difference(problem, &active_set.solution, &qp.solution);
    let to_penalty = difference(problem, &penalty.solution, &qp.solution);
    let agreement = Agreement {
        exact_methods: qp.certified
            && active_set.certified
            && to_active_set.rows == 0
            && to_active_set.displacement <= DISPLACEMENT_AGREEMENT
            && to_active_set.multiplier <= MULTIPLIER_AGREEMENT,
        penalty_within_its_bound: to_penalty.energy
            <= penalty.solution.certificate.energy_error_bound
                + qp.solution.certificate.energy_error_bound
                + NORM_ROUNDING,
        active_set: to_active_set,
        penalty: to_penalty,
    };
    Ok(Comparison { answers: [qp, active_set, penalty], agreement })
}

fn difference(problem: &ContactProblem, answer: &Solution, reference: &Solution) -> Difference {
    let minus = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
    let (u, lambda) = (&reference.displacement, &reference.multiplier);
    let moved = minus(&answer.displacement, u);
    let violation = problem.violation(u);
    let (reach, strongest) = (largest(&problem.contact().mul(u)), largest(lambda));
    let is_weak =
        |row: usize| lambda[row].abs() <= WEAKLY_ACTIVE * strongest && violation[row].abs() <= WEAKLY_ACTIVE * reach;
    let differs = |row: usize| answer.contact_set.contains(row) != reference.contact_set.contains(row);
    Difference {
        displacement: relative(largest(&moved), largest(u)),
        multiplier: relative(largest(&minus(&answer.multiplier, lambda)), strongest),
        rows: (0..problem.rows()).filter(|&row| differs(row) && !is_weak(row)).count(),
        energy: relative(energy_norm(problem, &moved), energy_norm(problem, &answer.displacement)),
    }
}
