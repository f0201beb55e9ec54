//! An answer with what is known of its model, serialised as the JSON that the command line prints.

use serde::Serialize;

use super::warnings::{AnswerWarning, lost_digits, opposite_sign};
use crate::qp::problem::ContactProblem;
use crate::scene::{ContactExtent, Resultant, Segment};
use crate::solution::{Certificate, Goal, Seconds, Solution};

/// How an answer was judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// It meets its goal.
    Certified,
    /// It does not.
    NotCertified,
    /// A motion whose energy grew more than its loads put in: not to be trusted, however good its single steps.
    Unstable,
}

impl Status {
    /// As a report says it in text.
    pub fn words(self) -> &'static str {
        match self {
            Status::Certified => "certified",
            Status::NotCertified => "not certified",
            Status::Unstable => "unstable: do not trust this motion",
        }
    }
}

/// Certified if all are.
impl FromIterator<Status> for Status {
    fn from_iter<I: IntoIterator<Item = Status>>(all: I) -> Self {
        all.into_iter().find(|&status| status != Status::Certified).unwrap_or(Status::Certified)
    }
}

/// An answer, judged, with the numbers that its model adds to it.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Does it meet its goal?
    pub status: Status,
    /// What the certificate was held against.
    #[serde(flatten)]
    pub goal: Goal,
    /// The answer.
    #[serde(flatten)]
    pub solution: Solution,
    /// What may mislead in these numbers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<AnswerWarning>,
    /// Closed rows and forces.
    pub contact: ContactSummary,
    /// Forces, moments and centres of obstacles, supports and loads; only in a scene.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub resultants: Vec<Resultant>,
    /// What is closed, piece by piece; only in a scene.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub segments: Vec<Segment>,
    /// What all forces are those of, as `per metre`; left out if they are those of the whole body.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub force_basis: String,
    /// The error of the mesh, estimated, relative in energy; only in a scene, where it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub discretisation_error: Option<f64>,
    /// The strain energy of the body, in force times length; only in a scene, where it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strain_energy: Option<f64>,
    /// Sizes of the model.
    pub model: ModelSize,
    /// What it cost.
    pub seconds: RunSeconds,
}

/// Closed rows and forces of an answer.
#[derive(Clone, Debug, Default, Serialize)]
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
    /// Estimates between the nodes; only in a scene whose contact has an extent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub estimate: Option<ContactExtent>,
    /// Imbalance of loads, reactions and contact forces, relative; only in a scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_balance: Option<f64>,
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

/// Wall-clock seconds from the file to the answer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RunSeconds {
    /// Reading, meshing and assembly.
    pub assemble: f64,
    /// Factorisations, the analysis of the pattern included; of a motion those before its first step.
    pub factor: f64,
    /// The solve without its factorisations and its proof, the certificate included; of a motion all steps, writing included.
    pub solve: f64,
    /// What of that the certificate took.
    pub certificate: f64,
    /// Proving which rows are open and closed.
    pub proof: f64,
    /// All of it.
    pub total: f64,
}

impl RunSeconds {
    /// The seconds of an answer whose model took `assemble` seconds.
    pub fn of(assemble: f64, solution: Seconds) -> Self {
        let Seconds { factor, certificate, proof, solve } = solution;
        RunSeconds { certificate, proof, ..RunSeconds::new(assemble, factor, (solve - factor - proof).max(0.0)) }
            .summed()
    }

    /// The seconds of the three stages of what is not proven, with their sum.
    pub fn new(assemble: f64, factor: f64, solve: f64) -> Self {
        RunSeconds { assemble, factor, solve, ..RunSeconds::default() }.summed()
    }

    fn summed(self) -> Self {
        RunSeconds { total: self.assemble + self.factor + self.solve + self.proof, ..self }
    }
}

impl ModelSize {
    /// Sizes of a problem without a mesh.
    pub fn of(problem: &ContactProblem) -> Self {
        ModelSize {
            dofs: problem.dofs(),
            contact_rows: problem.rows(),
            condensed_dofs: problem.dofs(),
            stiffness_entries: problem.stiffness().entries(),
            ..ModelSize::default()
        }
    }
}

impl Summary {
    /// The report of `solution` to a raw problem; a scene adds what it knows to `contact` and `model`.
    pub fn new(solution: Solution, model: ModelSize, goal: impl Into<Goal>, assemble_seconds: f64) -> Self {
        let goal = goal.into();
        let is_met = goal.is_met_by(&solution.certificate);
        Summary {
            status: if is_met { Status::Certified } else { Status::NotCertified },
            goal,
            warnings: lost_digits(&solution).into_iter().collect(),
            contact: ContactSummary {
                count: solution.contact_set.count(),
                force: solution.contact_force(),
                ..ContactSummary::default()
            },
            resultants: Vec::new(),
            segments: Vec::new(),
            force_basis: String::new(),
            discretisation_error: None,
            strain_energy: None,
            model: ModelSize { condensed_dofs: solution.condensed_dofs, ..model },
            seconds: RunSeconds::of(assemble_seconds, solution.seconds),
            solution,
        }
    }

    /// Returns `true` if the answer meets its goal.
    pub fn is_certified(&self) -> bool {
        self.status == Status::Certified
    }
}

/// The certificate of an answer that came from elsewhere.
#[derive(Clone, Debug, Serialize)]
pub struct Verification {
    /// Does it meet its goal?
    pub status: Status,
    /// Relative tolerance that the certificate was held against.
    pub tolerance: f64,
    /// The total force; a row counts as closed where its multiplier is not zero.
    pub contact: ContactSummary,
    /// The recomputed conditions.
    pub certificate: Certificate,
    /// Sizes of the model.
    pub model: ModelSize,
    /// What may mislead in these numbers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<AnswerWarning>,
}

impl Verification {
    /// Judges `certificate` by `tolerance`.
    pub fn new(certificate: Certificate, multiplier: &[f64], model: ModelSize, tolerance: f64) -> Self {
        let warnings = opposite_sign(&certificate, multiplier, tolerance).into_iter().collect();
        let force = -multiplier.iter().sum::<f64>();
        let count = multiplier.iter().filter(|&&lambda| lambda != 0.0).count();
        let contact = ContactSummary { count, force, ..ContactSummary::default() };
        let status = if certificate.meets(tolerance) { Status::Certified } else { Status::NotCertified };
        Verification { status, tolerance, contact, certificate, model, warnings }
    }

    /// Returns `true` if the answer meets the tolerance.
    pub fn is_certified(&self) -> bool {
        self.status == Status::Certified
    }
}
