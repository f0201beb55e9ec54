//! Compares the program's answers and claims with the exact ones.

use signorini::qp::{Error, LinearError};
use signorini::{Certificate, ContactProblem, Goal, ProvenSet, Solution};

use nalgebra::DMatrix;

use super::case::Case;
use super::dyadic::{Dyadic, dot, ratio};
use super::evidence;
use super::measure::{Errors, Relative};
use super::problem::Exact;
use super::solve::{Answer, Outcome};

/// A contradiction, a drive or an eigenvalue below this share decides nothing: it may be within the tolerance of a
/// certificate.
const BORDERLINE: f64 = 1e-8;

/// Below this distance from linear dependence, rounding has destroyed all but the last digits of the difference between
/// rows.
const DEPENDENT: f64 = 1e-13;

/// A change of a gap by this share of the terms of its row, `|g| + |B| |u|`, counts as rounding of the data.
const OF_DATA: f64 = 1e-15;

/// A bound that is too small by at most this factor is wrong by its own rounding, as far as the bound exceeds rounding
/// itself.
const OF_THE_BOUND: f64 = 1.001;

/// The program must certify a unique answer if the equilibrated stiffness has a condition below this.
pub const CONDITIONED: f64 = 1e10;

/// Sorts of faults, the most serious first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Sort {
    /// A bound on the error that lies below the error.
    Bound,
    /// A bound below the error, but only by rounding of the bound itself or of the exact displacement.
    Rounded,
    /// A row proven open that is closed, or proven closed that is open.
    Proof,
    /// Reported as infeasible, unbounded, not convex or without enough supports, but the problem is not.
    Claim,
    /// The weights or the direction that a claim names do not prove the claim.
    Evidence,
    /// Certified, but with a larger error than certified.
    Certified,
    Panic,
    /// The solve took too many iterations.
    Slow,
    /// Not certified, although the problem has a unique answer and an acceptable condition.
    Refused,
    /// Infeasible, unbounded or without enough supports, but not reported as such.
    Missed,
    /// Not certified; the problem has a unique answer, but its stiffness is singular or in worse condition.
    Hard,
}

impl Sort {
    pub const ALL: [Sort; 11] = [
        Sort::Bound,
        Sort::Rounded,
        Sort::Proof,
        Sort::Claim,
        Sort::Evidence,
        Sort::Certified,
        Sort::Panic,
        Sort::Slow,
        Sort::Refused,
        Sort::Missed,
        Sort::Hard,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Sort::Bound => "bound",
            Sort::Rounded => "rounded",
            Sort::Proof => "proof",
            Sort::Claim => "claim",
            Sort::Evidence => "evidence",
            Sort::Certified => "certified",
            Sort::Panic => "panic",
            Sort::Slow => "slow",
            Sort::Refused => "refused",
            Sort::Missed => "missed",
            Sort::Hard => "hard",
        }
    }

    /// Returns `true` if not one fault of this sort is allowed. A few problems may be refused or missed, and any number
    /// may be hard.
    pub fn is_forbidden(self) -> bool {
        !matches!(self, Sort::Refused | Sort::Missed | Sort::Hard)
    }
}

/// A violation of what the program promises.
#[derive(Clone, Debug)]
pub struct Fault {
    pub sort: Sort,
    /// The question, the program's answer, and the right answer.
    pub detail: String,
    /// Factor by which a bound is too small.
    pub factor: f64,
    /// The faulty answer: u and lambda.
    pub answer: Option<(Vec<f64>, Vec<f64>)>,
}

impl Fault {
    pub fn new(sort: Sort, detail: String) -> Self {
        Fault { sort, detail, factor: 0.0, answer: None }
    }
}

/// A problem with everything that is known exactly about it.
pub struct Judge<'a> {
    pub case: &'a Case,
    pub exact: &'a Exact,
    pub outcome: &'a Outcome,
    /// Condition of the equilibrated stiffness, infinite if it is singular.
    pub condition: f64,
    /// Smallest eigenvalue of the equilibrated stiffness divided by its largest.
    pub lowest: f64,
    /// The smallest singular value of the rows that carry force in the exact answer, each scaled to unit length in
    /// energy. Below rounding, double precision cannot distinguish them from dependent rows, and their last bits decide
    /// the exact answer.
    pub apart: f64,
}

/// Distance of the rows that carry force from linear dependence; 1 if no row carries force.
fn apart(case: &Case, exact: &Exact, outcome: &Outcome) -> f64 {
    let Outcome::Solved(answer) = outcome else { return 1.0 };
    let pressing = exact.rows.iter().zip(&answer.force).filter(|(_, force)| !force.is_zero());
    let rows: Vec<Vec<f64>> = pressing
        .map(|(&row, _)| {
            let soft = |dof: usize| match case.stiffness[dof][dof] {
                stiffness if stiffness > 0.0 => 1.0 / stiffness.sqrt(),
                _ => 1.0,
            };
            let entries: Vec<f64> = (0..case.dofs()).map(|dof| case.contact[row][dof] * soft(dof)).collect();
            let length = entries.iter().fold(0.0_f64, |length, entry| length.hypot(*entry));
            entries.iter().map(|entry| entry / length).collect()
        })
        .collect();
    if rows.is_empty() {
        return 1.0;
    }
    let matrix = DMatrix::from_fn(rows.len(), case.dofs(), |row, dof| rows[row][dof]);
    matrix.singular_values().min()
}

impl<'a> Judge<'a> {
    pub fn new(case: &'a Case, exact: &'a Exact, outcome: &'a Outcome) -> Self {
        let (low, high) = case.equilibrated_spectrum();
        let lowest = if high > 0.0 { low / high } else { 0.0 };
        let condition = if lowest > 0.0 { 1.0 / lowest } else { f64::INFINITY };
        Judge { case, exact, outcome, condition, lowest, apart: apart(case, exact, outcome) }
    }

    /// The name of the outcome that exact arithmetic finds for the problem.
    pub fn verdict(&self) -> &'static str {
        self.outcome.verdict()
    }

    /// Returns `true` if rounding of the data decides how this problem ends.
    pub fn is_borderline(&self) -> bool {
        match self.outcome {
            Outcome::Solved(_) => self.apart < DEPENDENT,
            Outcome::Infeasible { overlap, .. } => *overlap < BORDERLINE,
            Outcome::Unbounded { drive, .. } => *drive < BORDERLINE,
            Outcome::Indefinite { .. } => self.lowest > -BORDERLINE,
        }
    }

    /// Returns `true` if the program must certify this problem.
    pub fn is_fair(&self) -> bool {
        matches!(self.outcome, Outcome::Solved(answer) if answer.is_unique) && self.condition < CONDITIONED
    }

    /// Returns `true` if a displacement u meets every row of an infeasible problem exactly, once each gap is changed by
    /// at most 1e-15 of `|g| + |B| |u|`. Then data that agree with these up to rounding have an answer, even if the
    /// rows overlap by much compared with small gaps: no displacement in doubles meets a row better.
    fn meets_rounded_rows(&self, displacement: &[f64]) -> bool {
        let (u, rounding) = (displacement.iter().map(|&value| Dyadic::from(value)), Dyadic::from(OF_DATA));
        let u: Vec<Dyadic> = u.collect();
        let meets = |(row, gap): (&Vec<Dyadic>, &Dyadic)| {
            let terms = row.iter().zip(&u).fold(gap.abs(), |sum, (b, u)| &sum + &(b * u).abs());
            (&dot(row, &u) - gap) <= &terms * &rounding
        };
        matches!(self.outcome, Outcome::Infeasible { .. }) && self.exact.contact.iter().zip(&self.exact.gap).all(meets)
    }

    /// The faults in the ending of a solve; `must_end` forbids a refusal, because the program chose the settings
    /// itself.
    pub fn ending(&self, asked: &str, goal: Goal, ending: &Result<Solution, Error>, must_end: bool) -> Vec<Fault> {
        let (solution, said) = match ending {
            Ok(solution) => (Some(solution), "certified".to_string()),
            Err(Error::NotCertified { solution, .. }) => (Some(&**solution), "not-certified".to_string()),
            Err(error) => (None, error.code().to_string()),
        };
        let is_certified = ending.is_ok();
        let mut faults = Vec::new();
        if let Some(solution) = solution {
            let (u, lambda) = (&solution.displacement, &solution.multiplier);
            faults = self.answer(
                asked,
                u,
                lambda,
                &solution.certificate,
                solution.proven.as_ref(),
                is_certified.then_some(goal),
            );
        }
        let fault = |sort| Fault::new(sort, format!("{asked}: {said}, but it is {}", self.verdict()));
        let is_false = match ending {
            Err(Error::Infeasible { .. }) => {
                !matches!(self.outcome, Outcome::Infeasible { .. } | Outcome::Indefinite { is_feasible: false })
            }
            Err(Error::Unbounded { .. }) => match self.outcome {
                Outcome::Unbounded { .. } | Outcome::Indefinite { .. } => false,
                Outcome::Infeasible { is_driven, .. } => !is_driven,
                Outcome::Solved(_) => true,
            },
            Err(Error::Linear(LinearError::NotConvex { .. })) => !matches!(self.outcome, Outcome::Indefinite { .. }),
            Err(Error::UnderHeld { .. }) => matches!(self.outcome, Outcome::Solved(answer) if answer.is_unique),
            _ => false,
        };
        if is_false && !self.is_borderline() {
            faults.push(fault(Sort::Claim));
        } else if let Some(evidence) = ending.as_ref().err().and_then(|error| evidence::fault(self.exact, error)) {
            faults.push(Fault::new(Sort::Evidence, format!("{asked}: {said}, but {evidence}")));
        }
        if is_false || self.is_borderline() {
            return faults;
        }
        let is_reported = match self.outcome {
            Outcome::Solved(answer) if answer.is_unique => is_certified,
            Outcome::Solved(_) => is_certified || matches!(ending, Err(Error::UnderHeld { .. })),
            // An answer that meets the rows to a tolerance may meet rows that contradict each other by less.
            Outcome::Infeasible { overlap, .. } if is_certified => {
                *overlap <= goal.tolerance
                    || solution.is_some_and(|answer| self.meets_rounded_rows(&answer.displacement))
            }
            Outcome::Infeasible { .. } => matches!(ending, Err(Error::Infeasible { .. } | Error::Unbounded { .. })),
            Outcome::Unbounded { .. } => matches!(ending, Err(Error::Unbounded { .. })),
            Outcome::Indefinite { .. } => !is_certified,
        };
        if !is_reported && is_certified {
            let answer = solution.map(|solution| (solution.displacement.clone(), solution.multiplier.clone()));
            faults.push(Fault { answer, ..fault(Sort::Certified) });
        } else if !is_reported && must_end {
            let sort = match self.verdict() {
                "solved" if self.is_fair() => Sort::Refused,
                "solved" => Sort::Hard,
                _ => Sort::Missed,
            };
            faults.push(fault(sort));
        }
        faults
    }

    /// The faults of the certificate of any answer, right or wrong.
    pub fn verified(
        &self,
        asked: &str,
        problem: &ContactProblem,
        displacement: &[f64],
        multiplier: &[f64],
    ) -> Vec<Fault> {
        let goal = Goal::from(1e-9);
        let certified = problem.certify(displacement, multiplier);
        let proven = problem.prove(displacement, multiplier);
        match (certified, proven) {
            (Ok(certificate), Ok(proven)) => {
                let met = goal.is_met_by(&certificate).then_some(goal);
                let mut faults = self.answer(asked, displacement, multiplier, &certificate, proven.as_ref(), met);
                let has_answer = matches!(self.outcome, Outcome::Solved(_));
                if met.is_some() && !(has_answer || self.is_borderline() || self.meets_rounded_rows(displacement)) {
                    let detail = format!("{asked}: certified, but it is {}", self.verdict());
                    let answer = Some((displacement.to_vec(), multiplier.to_vec()));
                    faults.push(Fault { answer, ..Fault::new(Sort::Certified, detail) });
                }
                faults
            }
            (Err(error), _) | (_, Err(error)) => vec![Fault::new(Sort::Claim, format!("{asked}: {error}"))],
        }
    }

    fn answer(
        &self,
        asked: &str,
        displacement: &[f64],
        multiplier: &[f64],
        certificate: &Certificate,
        proven: Option<&ProvenSet>,
        certified: Option<Goal>,
    ) -> Vec<Fault> {
        let Outcome::Solved(answer) = self.outcome else { return Vec::new() };
        if self.is_borderline() {
            return Vec::new();
        }
        if displacement.iter().chain(multiplier).any(|value| !value.is_finite()) {
            let detail = format!("{asked}: certified with numbers that are not finite");
            return if certified.is_some() { vec![Fault::new(Sort::Certified, detail)] } else { Vec::new() };
        }
        let errors = Errors { case: self.case, exact: self.exact, answer };
        let mut faults = Vec::new();
        let (whole, bound) = (errors.whole(displacement), certificate.energy_error_bound);
        if certificate.has_bound() && !errors.is_within(displacement, certificate.energy_error) {
            let detail = format!("{asked}: the error exceeds {:.3e}, its bound in energy", certificate.energy_error);
            let is_rounding = errors.is_within(displacement, OF_THE_BOUND * certificate.energy_error);
            faults.push(Fault::new(if is_rounding { Sort::Rounded } else { Sort::Bound }, detail));
        }
        if bound.is_finite() && !whole.is_within(bound) {
            let factor = whole.value() / bound;
            let detail = format!(
                "{asked}: error {:.3e} exceeds its bound {bound:.3e} by a factor of 1 + {:.1e}",
                whole.value(),
                factor - 1.0
            );
            let is_rounding = factor < OF_THE_BOUND || whole.is_within(whole.explained);
            let sort = if is_rounding { Sort::Rounded } else { Sort::Bound };
            faults.push(Fault { factor, ..Fault::new(sort, detail) });
        }
        if let Some(goal) = certified {
            // A tolerance is relative to the answer found; here the larger of the two norms counts.
            let promised = goal.required() / (1.0 - goal.required()).max(f64::MIN_POSITIVE);
            let parts = errors.parts(displacement);
            // A part at rest has no relative error; its bound in energy is compared above.
            let exceeds =
                |relative: &&Relative| !(relative.is_at_rest || relative.is_within(promised + relative.explained));
            if let Some(worst) = parts.iter().find(exceeds) {
                let detail = format!(
                    "{asked}: certified to {promised:.1e}, but a part of {} is off by {:.3e} in energy, of which rounding explains {:.1e}",
                    parts.len(),
                    worst.value(),
                    worst.explained
                );
                faults.push(Fault::new(Sort::Certified, detail));
            }
        }
        faults.extend(
            proven
                .and_then(|proven| self.wrong_proof(answer, proven))
                .map(|row| Fault::new(Sort::Proof, format!("{asked}: {row}"))),
        );
        let at_fault = (displacement.to_vec(), multiplier.to_vec());
        faults.iter_mut().for_each(|fault| fault.answer = Some(at_fault.clone()));
        faults
    }

    /// A row whose proven state is wrong.
    fn wrong_proof(&self, answer: &Answer, proven: &ProvenSet) -> Option<String> {
        let distances = self.exact.distances(answer);
        for (place, &row) in self.exact.rows.iter().enumerate() {
            let distance: &Dyadic = &distances[place];
            let apart = ratio(distance, &answer.denominator);
            if proven.closed.contains(row) && distance.sign() > 0 {
                return Some(format!("row {row} is proven closed, but is open by {apart:.3e}"));
            }
            if proven.open.contains(row) && distance.is_zero() {
                return Some(format!("row {row} is proven open, but is closed"));
            }
        }
        let infinite = (0..self.case.rows()).find(|&row| !self.case.is_bounded(row) && proven.closed.contains(row));
        infinite.map(|row| format!("row {row} is proven closed, but has no bound"))
    }
}
