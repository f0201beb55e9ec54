//! The numbers of one answer, named as in the JSON that the command line prints.

use serde::Serialize;

use crate::qp::problem::ContactProblem;
use crate::solution::{Attempt, Certificate, Goal, Iteration, Solution};

/// One answer in numbers.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// `certified` or `not_certified`.
    pub status: &'static str,
    /// Relative tolerance that the certificate was held against.
    pub tolerance: f64,
    /// Relative energy error that was asked for, which the bound is held against instead.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<f64>,
    /// `qp`, `active-set`, `penalty` or `mprgp`, with a suffix where a variant ran.
    pub method: String,
    /// Iterations of the method.
    pub iterations: usize,
    /// Steps of refinement, where the factor was in single precision.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refinements: Option<usize>,
    /// Why no factor was taken, where the program decided that.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// What else was tried, in order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub attempts: Vec<AttemptSummary>,
    /// What may mislead in the numbers below.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<AnswerWarning>,
    /// Closed rows and forces.
    pub contact: ContactSummary,
    /// Rows whose contact is beyond doubt, where they were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub proven: Option<ProvenSummary>,
    /// The recomputed conditions.
    pub certificate: CertificateSummary,
    /// The error of the mesh, estimated, relative in energy; only in a scene, where it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub discretisation_error: Option<f64>,
    /// Sizes of the model.
    pub model: ModelSize,
    /// What it cost.
    pub seconds: SecondsSummary,
    /// Iteration by iteration: number of closed rows, and the penalty where there is one.
    pub history: Vec<HistoryEntry>,
}

/// A way that was tried beside the one that gave the answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AttemptSummary {
    /// The method.
    pub method: String,
    /// Wall-clock seconds that it took.
    pub seconds: f64,
    /// Why its end was not the end.
    pub reason: String,
}

/// Something about an answer that its reader should know, certified or not.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct AnswerWarning {
    /// The name of the kind of warning, the same in every version.
    pub code: &'static str,
    /// What it is, with numbers, its likely cause, and what helps.
    pub message: String,
}

/// One iteration in numbers.
#[derive(Clone, Debug, Serialize)]
pub struct HistoryEntry {
    /// Closed rows.
    pub closed: usize,
    /// Penalty in multiples of the local stiffness.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub penalty: Option<f64>,
}

/// Closed rows and forces of an answer.
#[derive(Clone, Debug, Serialize)]
pub struct ContactSummary {
    /// Number of closed rows.
    pub count: usize,
    /// Total contact force `-sum(lambda)`.
    pub force: f64,
    /// Largest contact pressure; only a scene has areas to divide by.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_max: Option<f64>,
    /// Length of the boundary that closed rows stand for; only in a scene in plane strain or plane stress.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width: Option<f64>,
    /// Area of the boundary that closed rows stand for; only in a scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area: Option<f64>,
    /// Imbalance of loads, reactions and contact forces, relative; only in a scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_balance: Option<f64>,
}

/// How much of a contact set is proven.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProvenSummary {
    /// Rows proven open.
    pub open: usize,
    /// Rows proven closed.
    pub closed: usize,
    /// All other rows, from 0.
    pub undecided: Vec<usize>,
}

/// A certificate; a bound that is not known is null.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs)]
pub struct CertificateSummary {
    pub stationarity: f64,
    pub stationarity_excess: f64,
    pub penetration: f64,
    pub adhesion: f64,
    pub complementarity: f64,
    pub duality_gap: f64,
    pub energy_error_bound: f64,
    pub part_error_bound: f64,
    pub energy_error_excess: f64,
    pub parts: usize,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub bound_is_measured: bool,
}

/// Sizes of the model that was solved.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ModelSize {
    /// Unknown displacements.
    pub dofs: usize,
    /// Contact rows.
    pub contact_rows: usize,
    /// Unknowns that the method worked on.
    pub condensed_dofs: usize,
    /// Entries of the stiffness, both triangles.
    pub stiffness_entries: usize,
    /// Nodes of the mesh; only in a scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nodes: Option<usize>,
    /// Elements of the mesh; only in a scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elements: Option<usize>,
}

/// Wall-clock seconds.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct SecondsSummary {
    /// Reading, meshing and assembly.
    pub assemble: f64,
    /// Factorisations, the analysis of the pattern included.
    pub factor: f64,
    /// The solve without its factorisations.
    pub solve: f64,
    /// All of it.
    pub total: f64,
}

impl ModelSize {
    /// Sizes of a problem without a mesh.
    pub fn of(problem: &ContactProblem) -> Self {
        ModelSize {
            dofs: problem.dofs(),
            contact_rows: problem.rows(),
            condensed_dofs: problem.dofs(),
            stiffness_entries: 2 * problem.stiffness().lower().entries() - problem.dofs(),
            ..ModelSize::default()
        }
    }
}

impl AnswerWarning {
    /// That the entries of the stiffness determine few digits of the answer, however good its certificate.
    fn lost_digits(solution: &Solution) -> Option<Self> {
        let (digits, pivot) = (solution.digits_of_stiffness()?, solution.lost_pivot?);
        let digits = match digits {
            0 => "hardly a digit".to_string(),
            1 => "only about 1 digit".to_string(),
            digits => format!("only about {digits} digits"),
        };
        let message = format!(
            "the entries of the stiffness are rounded to double precision, and determine {digits} of the displacement \
             (smallest pivot {pivot:.0e} of the diagonal); the certificate takes them as exact. Likely causes: bending of \
             slender bodies (take fewer elements along the thickness, quadratic elements, or a beam), or contrast of \
             stiff parts on soft ones"
        );
        Some(AnswerWarning { code: "lost-digits", message })
    }
}

impl From<&Attempt> for AttemptSummary {
    fn from(attempt: &Attempt) -> Self {
        let Attempt { method, seconds, reason } = attempt.clone();
        AttemptSummary { method, seconds, reason }
    }
}

impl From<&Certificate> for CertificateSummary {
    fn from(certificate: &Certificate) -> Self {
        CertificateSummary {
            stationarity: certificate.stationarity,
            stationarity_excess: certificate.stationarity_excess,
            penetration: certificate.penetration,
            adhesion: certificate.adhesion,
            complementarity: certificate.complementarity,
            duality_gap: certificate.duality_gap,
            energy_error_bound: certificate.energy_error_bound,
            part_error_bound: certificate.part_error_bound,
            energy_error_excess: certificate.energy_error_excess,
            parts: certificate.parts,
            bound_is_measured: certificate.bound_is_measured,
        }
    }
}

/// `certified` or `not_certified`, as the certificate meets the goal.
pub(crate) fn status(certificate: &Certificate, goal: Goal) -> &'static str {
    if goal.is_met_by(certificate) { "certified" } else { "not_certified" }
}

impl Summary {
    /// The numbers of `solution` to a raw problem; a scene adds what it knows to `contact` and `model`.
    pub fn new(solution: &Solution, model: ModelSize, goal: impl Into<Goal>, assemble_seconds: f64) -> Self {
        let goal = goal.into();
        let model = ModelSize { condensed_dofs: solution.condensed_dofs, ..model };
        let entry = |step: &Iteration| HistoryEntry {
            closed: step.contact_set.count(),
            penalty: (step.penalty > 0.0).then_some(step.penalty),
        };
        let seconds = solution.seconds;
        Summary {
            status: status(&solution.certificate, goal),
            tolerance: goal.tolerance,
            accuracy: goal.accuracy,
            method: solution.method.clone(),
            iterations: solution.iterations,
            refinements: solution.refinements,
            reason: solution.reason.clone(),
            attempts: solution.attempts.iter().map(AttemptSummary::from).collect(),
            warnings: AnswerWarning::lost_digits(solution).into_iter().collect(),
            contact: ContactSummary {
                count: solution.contact_set.count(),
                force: solution.contact_force(),
                pressure_max: None,
                width: None,
                area: None,
                force_balance: None,
            },
            proven: solution.proven.as_ref().map(|proven| ProvenSummary {
                open: proven.open.count(),
                closed: proven.closed.count(),
                undecided: proven.undecided().collect(),
            }),
            certificate: (&solution.certificate).into(),
            discretisation_error: None,
            model,
            seconds: SecondsSummary {
                assemble: assemble_seconds,
                factor: seconds.factor,
                solve: (seconds.solve - seconds.factor).max(0.0),
                total: assemble_seconds + seconds.solve,
            },
            history: solution.history.iter().map(entry).collect(),
        }
    }

    /// Does the answer meet its goal?
    pub fn is_certified(&self) -> bool {
        self.status == "certified"
    }
}

/// The certificate of an answer that came from elsewhere.
#[derive(Clone, Debug, Serialize)]
pub struct Verification {
    /// `certified` or `not_certified`.
    pub status: &'static str,
    /// Relative tolerance that the certificate was held against.
    pub tolerance: f64,
    /// The total force; a row counts as closed where its multiplier is not zero.
    pub contact: ContactSummary,
    /// The recomputed conditions.
    pub certificate: CertificateSummary,
    /// Sizes of the model.
    pub model: ModelSize,
}

impl Verification {
    /// Judges `certificate` by `tolerance`.
    pub fn new(certificate: &Certificate, multiplier: &[f64], model: ModelSize, tolerance: f64) -> Self {
        let force = -multiplier.iter().sum::<f64>();
        let count = multiplier.iter().filter(|&&lambda| lambda != 0.0).count();
        let contact = ContactSummary { count, force, pressure_max: None, width: None, area: None, force_balance: None };
        let status = status(certificate, tolerance.into());
        Verification { status, tolerance, contact, certificate: certificate.into(), model }
    }

    /// Does the answer meet the tolerance?
    pub fn is_certified(&self) -> bool {
        self.status == "certified"
    }
}
