//! An answer with the data of its model and of each obstacle, serialised as the JSON that the command line prints.

use super::warnings::{lost_digits, opposite_sign};
use serde::Serialize;
use signorini_fem::geometry::length;
use signorini_mechanics::scene::models::resultants;
use signorini_mechanics::scene::{Answer, ContactExtent, Resultant, Segment, Warning};
use signorini_qp::{Certificate, ContactProblem, Goal, Seconds, Solution};

/// The judgement of an answer against its goal, and of a motion by its energy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// The answer meets its goal.
    Certified,
    /// The answer does not meet its goal.
    NotCertified,
    /// A motion with an energy growth that its loads do not explain: not reliable, even if every single step is
    /// accurate.
    Unstable,
    /// The answer solves the equations of small displacements, which do not describe it.
    #[serde(rename = "beyond-small-displacements")]
    BeyondSmallDisplacements,
}

impl Status {
    /// The status in words, for text reports.
    pub fn words(self) -> &'static str {
        match self {
            Status::Certified => "certified",
            Status::NotCertified => "not certified",
            Status::Unstable => "unstable: do not trust this motion",
            Status::BeyondSmallDisplacements => "beyond small displacements: do not use this answer",
        }
    }
}

/// Certified if all are.
impl FromIterator<Status> for Status {
    fn from_iter<I: IntoIterator<Item = Status>>(all: I) -> Self {
        all.into_iter().find(|&status| status != Status::Certified).unwrap_or(Status::Certified)
    }
}

/// An answer with its judgement and the numbers that its model adds: everything that a report prints.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// The judgement against the goal.
    pub status: Status,
    /// The goal against which the certificate was judged.
    #[serde(flatten)]
    pub goal: Goal,
    /// The certified or best answer of the solver, without the meaning of its rows.
    #[serde(flatten)]
    pub solution: Solution,
    /// Warnings about the numbers of this answer.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<Warning>,
    /// Closed rows and forces.
    pub contact: ContactSummary,
    /// Forces, moments and centres of obstacles, supports and loads; only in a scene.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub resultants: Vec<Resultant>,
    /// The contact segments; only in a scene.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub segments: Vec<Segment>,
    /// The reference of all forces, as `per metre`; left out if they are those of the whole body.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub force_basis: String,
    /// Number of meshed parts in the whole body; only with planes of symmetry.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub parts_of_whole: Option<usize>,
    /// The names of these entries of the meshed part, with a point between a name and that of its owner; empty without
    /// planes of symmetry.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    pub of_meshed_part: &'static [&'static str],
    /// The deepest overlap of the undeformed body with an obstacle, in words, for the text of a report; `None` without
    /// an overlap.
    #[serde(skip)]
    pub initial_overlap: Option<String>,
    /// The estimated discretisation error, relative in energy; only in a scene, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub discretisation_error: Option<f64>,
    /// The strain energy of the body, in force times length; only in a scene, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strain_energy: Option<f64>,
    /// The largest component of the displacement; only in a scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_displacement: Option<LargestDisplacement>,
    /// Number of unknowns, rows and matrix entries, and the mesh of a scene.
    pub model: ModelSize,
    /// Its cost in time.
    pub seconds: RunSeconds,
}

/// The entries of a summary that planes of symmetry leave of the meshed part. All other numbers are of the whole body.
pub const OF_MESHED_PART: [&str; 15] = [
    "certificate",
    "contact.count",
    "contact.force_balance",
    "contact.obstacles.count",
    "history",
    "iterations",
    "largest_displacement.node",
    "largest_displacement.place",
    "met_tolerance",
    "model",
    "proven",
    "refinements",
    "seconds",
    "segments",
    "why",
];

/// The component of a displacement with the largest magnitude of all nodes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LargestDisplacement {
    /// The component, in length, with its sign.
    pub value: f64,
    /// Its axis, 0 for x.
    pub axis: usize,
    pub node: usize,
    /// The undeformed place of the node, a coordinate for each axis, in length.
    pub place: Vec<f64>,
}

/// Closed rows and forces of an answer, and in a scene its pressures, widths and areas.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ContactSummary {
    /// Number of closed rows of the answer.
    pub count: usize,
    /// Total contact force `-sum(lambda)` of the answer, in force, `>= 0`.
    pub force: f64,
    /// Largest contact pressure, in force per area, `>= 0`; only in a scene, because only a scene has areas.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_max: Option<f64>,
    /// Length of the boundary that belongs to closed rows, in length; only in a scene in plane strain or plane stress.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width: Option<f64>,
    /// Area of the boundary that belongs to closed rows, in area; only in a scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area: Option<f64>,
    /// Estimates between the nodes; only in a scene with a contact of some extent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub estimate: Option<ContactExtent>,
    /// The contact of each obstacle and pair of bodies; only in a scene.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub obstacles: Vec<ObstacleContact>,
    /// Imbalance of loads, reactions and contact forces, relative; only in a scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_balance: Option<f64>,
}

impl ContactSummary {
    /// Number of obstacles in the whole body, mirror images included.
    pub fn obstacles_of_whole(&self) -> usize {
        self.obstacles.iter().map(|one| one.copies).sum()
    }

    /// Returns `true` if the sums over all obstacles are those of several.
    pub fn is_of_several(&self) -> bool {
        self.obstacles_of_whole() > 1
    }
}

/// The two surfaces of a contact between bodies.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BetweenBodies {
    /// Name of the boundary with a row for each node.
    pub boundary: String,
    /// Name of the boundary of the other body that these rows keep out.
    pub other: String,
    /// `pairs` of nodes, or `mortar`: means over the areas of the nodes of the carrying boundary.
    pub rows: &'static str,
    /// The covered share of the area of `boundary`, and the share of the nodes of `other` that face it, from 0 to 1;
    /// `None` for pairs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub covered: Option<[f64; 2]>,
    /// The moment about the origin of the contact forces on the other body, in force times length, as
    /// [`Resultant::moment`]: beside the opposite moment on this body, it differs by the moment of the forces over the
    /// gap.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub moment_on_other: Vec<f64>,
    /// The moment of the contact forces on both bodies together, over the sum of these forces and the size of the mesh,
    /// `>= 0`: 0 if they balance. `None` for pairs, and about an axis.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moment_defect: Option<f64>,
    /// The deepest place at which a node of the other boundary lies inside this body, in length, `>= 0`: means are kept
    /// apart, single nodes may be not. `None` for pairs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub penetration: Option<f64>,
}

/// The contact of one obstacle or pair of bodies, in the whole body. A plane of symmetry normal to its approach
/// direction gives an obstacle a mirror image, which does not count here; in all other planes the contact is of the
/// whole.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ObstacleContact {
    /// Its name, as in [`Resultant::of`].
    pub of: String,
    /// The body on which it presses, if there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub on: Option<String>,
    /// The two surfaces, if it is a contact between bodies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub between: Option<BetweenBodies>,
    /// Number of mirror images with the same numbers, itself included.
    pub copies: usize,
    /// Number of closed rows, in the meshed part.
    pub count: usize,
    /// Magnitude of the resultant force, in force, `>= 0`; 0 if the forces cancel, as around a shaft.
    pub force: f64,
    /// The sum `-sum(lambda)` of its rows, in force, `>= 0`.
    pub sum_of_multipliers: f64,
    /// Displacement against the approach direction, in length, if a force presses it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub travel: Option<f64>,
    /// Largest contact pressure on this obstacle or pair, in force per area, `>= 0`.
    pub pressure_max: f64,
    /// The sum of multipliers over the estimated area, in force per area; `None` without an area.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_mean: Option<f64>,
    /// Number of separate places of contact.
    pub contacts: usize,
    /// Area and width of all places together, estimated between the nodes; `None` without contact.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub estimate: Option<ContactExtent>,
}

/// Sizes of the model that was solved: unknowns, contact rows, entries of the matrix, and the mesh if there is one.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ModelSize {
    /// Number of unknown displacements n, before the problem is condensed.
    pub dofs: usize,
    /// Number m of rows of B, those that can never close included.
    pub contact_rows: usize,
    /// Number p of equality rows; left out without such rows.
    #[serde(skip_serializing_if = "is_zero")]
    pub equality_rows: usize,
    /// Number of unknowns of the method: fewer than `dofs` if the problem was condensed.
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

/// Wall-clock seconds from the file to the answer, by stages that do not overlap, and their sum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RunSeconds {
    /// Seconds of reading, meshing and assembly.
    pub assemble: f64,
    /// Factorisations, including the analysis of the pattern; in a motion those before its first step.
    pub factor: f64,
    /// The solve without its factorisations and its proof, including the certificate; in a motion all steps, including
    /// writing.
    pub solve: f64,
    /// The part of `solve` that recomputes the conditions and the bound.
    pub certificate: f64,
    /// The proof of the rows that are open and closed, outside `solve`.
    pub proof: f64,
    /// The sum of `assemble`, `factor`, `solve` and `proof`.
    pub total: f64,
}

impl RunSeconds {
    /// The seconds of an answer whose model took `assemble` seconds.
    pub fn of(assemble: f64, solution: Seconds) -> Self {
        let Seconds { factor, certificate, proof, solve } = solution;
        RunSeconds { certificate, proof, ..RunSeconds::new(assemble, factor, (solve - factor - proof).max(0.0)) }
            .summed()
    }

    /// The seconds of the three stages of an answer without a proof, with their sum.
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
            contact_rows: problem.inequalities(),
            equality_rows: problem.equality_rows(),
            condensed_dofs: problem.dofs(),
            stiffness_entries: problem.stiffness().entries(),
            ..ModelSize::default()
        }
    }

    /// The number of rows of each kind, in words: such as `3 contact rows, 1 equality row`.
    pub fn rows_in_words(&self) -> String {
        let rows = |count: usize, kind: &str| format!("{count} {kind} row{}", if count == 1 { "" } else { "s" });
        let contact = rows(self.contact_rows, "contact");
        match self.equality_rows {
            0 => contact,
            count => format!("{contact}, {}", rows(count, "equality")),
        }
    }
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}

impl Summary {
    /// The report of `solution` to a raw problem; a scene adds its data to `contact` and `model`.
    pub fn new(solution: Solution, model: ModelSize, goal: impl Into<Goal>, assemble_seconds: f64) -> Self {
        let goal = goal.into();
        let mut solution = solution;
        solution.certificate = solution.certificate.judged(goal);
        let is_met = solution.certificate.met.is_some();
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
            parts_of_whole: None,
            of_meshed_part: &[],
            initial_overlap: None,
            discretisation_error: None,
            strain_energy: None,
            largest_displacement: None,
            model: ModelSize { condensed_dofs: solution.condensed_dofs, ..model },
            seconds: RunSeconds::of(assemble_seconds, solution.seconds),
            solution,
        }
    }

    /// Returns `true` if the answer meets its goal.
    pub fn is_certified(&self) -> bool {
        self.solution.certificate.met.is_some()
    }
}

/// The certificate of an answer from another source, recomputed from the problem and judged by a tolerance.
#[derive(Clone, Debug, Serialize)]
pub struct Verification {
    /// The judgement against the tolerance.
    pub status: Status,
    /// Relative tolerance of the judgement.
    pub tolerance: f64,
    /// The total force; a row counts as closed if its multiplier is not zero.
    pub contact: ContactSummary,
    /// The recomputed conditions.
    pub certificate: Certificate,
    /// Number of unknowns, rows and matrix entries of the problem.
    pub model: ModelSize,
    /// Warnings about the recomputed numbers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<Warning>,
}

impl Verification {
    /// Judges `certificate` by `tolerance`; the multiplier (one entry per contact row, in force, `<= 0` in compression)
    /// gives the total force.
    pub fn new(certificate: Certificate, multiplier: &[f64], model: ModelSize, tolerance: f64) -> Self {
        let warnings = opposite_sign(&certificate, multiplier, tolerance).into_iter().collect();
        let force = -multiplier.iter().sum::<f64>();
        let count = multiplier.iter().filter(|&&lambda| lambda != 0.0).count();
        let contact = ContactSummary { count, force, ..ContactSummary::default() };
        let certificate = certificate.judged(tolerance.into());
        let status = if certificate.met.is_some() { Status::Certified } else { Status::NotCertified };
        Verification { status, tolerance, contact, certificate, model, warnings }
    }

    /// Returns `true` if the answer meets the tolerance.
    pub fn is_certified(&self) -> bool {
        self.status == Status::Certified
    }
}

/// A resultant below this share of the sum of its forces is rounding.
const CANCELS: f64 = 1e-10;

/// Adds the contact of each obstacle to the numbers of an answer, whose resultants begin with those of the obstacles.
pub(super) fn contact_on_obstacles(answer: &Answer, segments: &[Segment], summary: &mut Summary) {
    let resultants = summary.resultants.iter().take(answer.model().obstacles().len()).enumerate();
    let found = resultants.map(|(index, resultant)| of_obstacle(answer, index, resultant, segments)).collect();
    summary.contact.obstacles = found;
}

/// The two surfaces of an obstacle that is another body.
fn between(answer: &Answer, index: usize) -> Option<BetweenBodies> {
    let model = answer.model();
    let obstacle = &model.obstacles()[index];
    let (other, covered) = obstacle.other_body()?;
    let seen = model.rows_across().iter().zip(answer.across()).filter(|(row, _)| row.obstacle == index);
    let deepest = seen.fold(0.0, |deepest: f64, (_, [_, gap])| deepest.max(-gap));
    Some(BetweenBodies {
        boundary: obstacle.boundary().into(),
        other: other.into(),
        rows: if covered.is_some() { "mortar" } else { "pairs" },
        covered,
        moment_on_other: resultants::moment_on_other(model, index, answer.multiplier()),
        moment_defect: resultants::moment_defect(model, index, answer.multiplier()),
        penetration: covered.map(|_| deepest),
    })
}

fn of_obstacle(answer: &Answer, index: usize, resultant: &Resultant, segments: &[Segment]) -> ObstacleContact {
    let model = answer.model();
    let parts = model.parts.parts_of_obstacle(index);
    let (approach, nodes) = (model.obstacles()[index].approach(), model.mesh().nodes());
    let contacts = |own: &Segment| model.parts.conditions.symmetry.contacts(approach, nodes, &own.nodes);
    let own = segments.iter().filter(|segment| segment.obstacle == index);
    let rows = || model.rows().iter().enumerate().filter(|(_, row)| row.obstacle == index).map(|(row, _)| row);
    let sum_of_multipliers = rows().fold(0.0, |sum, row| sum - answer.multiplier()[row]) * parts;
    let mut force = [0.0; 3];
    force.iter_mut().zip(&resultant.force).for_each(|(part, of_resultant)| *part = *of_resultant);
    let estimate = ContactExtent::of(own.clone()).map(|extent| extent.of_parts(parts));
    let area = estimate.map_or(0.0, |extent| extent.area);
    ObstacleContact {
        of: resultant.of.clone(),
        on: resultant.on.clone(),
        between: between(answer, index),
        copies: (model.parts_of_whole() / parts) as usize,
        count: rows().filter(|&row| answer.contact_set().contains(row)).count(),
        force: if length(force) > CANCELS * sum_of_multipliers { length(force) } else { 0.0 },
        sum_of_multipliers,
        travel: resultant.travel,
        pressure_max: rows().map(|row| answer.pressure()[row]).fold(0.0, f64::max) + 0.0,
        pressure_mean: (area > 0.0).then(|| sum_of_multipliers / area),
        contacts: own.map(contacts).sum(),
        estimate: estimate.filter(|_| model.mesh().dimension() > 1),
    }
}
