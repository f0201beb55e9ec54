//! What a search for a total error is given and finds, its goal, its continuation and its end.

use std::sync::Arc;
use std::time::Instant;

use crate::{ModelSize, Status};
use serde::Serialize;
use signorini_fem::ElementKind;
use signorini_guarantee::ContinuumAnswer;
use signorini_mechanics::Error;
use signorini_mechanics::scene::{Answer, Model, Scene, Warning};
use signorini_qp as qp;
use signorini_qp::{Settings, Solution};

/// A relative error against the continuum, as reports give it, with the statement of how much it may be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bound {
    /// Upper bound of |u - v| / |v|; an approximate value if that is not guaranteed.
    pub bound: f64,
    /// `true` if it is proven, not estimated.
    pub guaranteed: bool,
}

/// The numbers of one mesh on the way to a total error that is small enough.
#[derive(Clone, Debug, Serialize)]
pub struct Level {
    /// Its elements: triangles or tetrahedra if the error is guaranteed.
    pub elements: usize,
    /// Unknowns of the displacement.
    pub dofs: usize,
    /// |u - v| / |v|: the bound, or the estimate.
    pub total_error: f64,
    /// The sum of the contact forces of v on this mesh, in force.
    pub contact_force: f64,
    /// The numbers that only a bound has, or only an estimate.
    #[serde(flatten)]
    pub kind: LevelKind,
    /// Seconds from the start of the search to the end of this mesh.
    pub seconds: f64,
}

/// The numbers of one mesh that only a proven bound has, or only an estimate.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum LevelKind {
    /// A proven bound.
    Guaranteed {
        /// Unknowns of the stress in balance.
        stress_dofs: usize,
        /// The bound on the error of the mean stress, over |v|.
        mean_stress_error: f64,
        /// The interval `[low, high]` that contains the exact contact force, in force, if it was requested.
        #[serde(skip_serializing_if = "Option::is_none")]
        force_interval: Option<[f64; 2]>,
        /// Seconds for the displacement on this mesh.
        displacement_seconds: f64,
        /// Seconds to find its stress in balance with the loads.
        stress_seconds: f64,
    },
    /// From the stresses that the answer recovers; not proven.
    Estimated {
        /// Number of candidate rows of the contact problem.
        contact_rows: usize,
        /// The method for the contact problem.
        method: String,
        /// The estimated discretisation error, relative in energy.
        discretisation_error: f64,
        /// The bound on the algebraic error, relative in energy.
        energy_error_bound: f64,
        /// The largest depth in an obstacle between nodes, over the displacement that the obstacles impose.
        depth_between_nodes: f64,
    },
}

impl TotalError {
    /// The plural of its elements in a sentence: triangles or tetrahedra if the error is guaranteed.
    pub fn name_of_elements(&self) -> &'static str {
        match self.guarantee.as_ref().map(|guarantee| guarantee.answer.dimension()) {
            Some(2) => "triangles",
            Some(_) => "tetrahedra",
            None => "elements",
        }
    }
}

impl Level {
    /// Half the width of the interval of the force, over the force; `None` without an interval.
    pub fn half_width(&self) -> Option<f64> {
        let [low, high] = self.force_interval()?;
        Some(if high > low { (high - low) / 2.0 / self.contact_force.abs() } else { 0.0 })
    }

    /// The interval `[low, high]` that contains the exact contact force, in force, if it is known.
    pub fn force_interval(&self) -> Option<[f64; 2]> {
        match self.kind {
            LevelKind::Guaranteed { force_interval, .. } => force_interval,
            LevelKind::Estimated { .. } => None,
        }
    }

    /// The largest depth between nodes, relative; none where the rows hold between the nodes too.
    pub fn depth_between_nodes(&self) -> Option<f64> {
        match self.kind {
            LevelKind::Estimated { depth_between_nodes, .. } => Some(depth_between_nodes),
            LevelKind::Guaranteed { .. } => None,
        }
    }

    /// If a mesh misses the tip of an obstacle between its nodes, the stresses do not show that error.
    pub(super) fn meets(&self, goal: TotalErrorGoal) -> bool {
        let force_met = goal.force_error.is_none_or(|wanted| self.half_width().is_some_and(|half| half <= wanted));
        self.total_error.max(self.depth_between_nodes().unwrap_or(0.0)) <= goal.total_error && force_met
    }
}

/// An answer with its error against the continuum: u is the exact displacement, v the answer.
#[derive(Clone, Debug, Serialize)]
pub struct TotalError {
    /// Whether the goal was reached.
    pub status: Status,
    /// The errors that were asked for.
    pub goal: TotalErrorGoal,
    /// The reason for which the search ended.
    pub ended: Ended,
    /// |u - v| / |v| in the energy norm.
    pub total_error: Bound,
    /// If the error is estimated: that of the scene which has no guaranteed bound, and what would have one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// If the error is guaranteed: all that is proven beside the bound.
    #[serde(flatten)]
    pub guarantee: Option<Guarantee>,
    /// The meshes, from the first to the last.
    pub levels: Vec<Level>,
    /// The size of the problem on the last mesh; on the scene's own mesh if the last has no answer.
    pub model: ModelSize,
    /// Wall-clock time of the whole search, in seconds.
    pub seconds: f64,
    /// The cells of each mesh, by the places of their corners, in length: in space the facets that may touch, along the
    /// approach direction; without cells for a bar.
    #[serde(skip)]
    pub meshes: Vec<Vec<Vec<[f64; 2]>>>,
    /// The answer of `solve` on the last mesh, or the reason for which there is none. With a guarantee its rows are at
    /// nodes, while those of the bound hold between them as well.
    #[serde(skip)]
    pub last: Result<Box<(Answer, Solution)>, String>,
}

/// All that is proven beside the bound of a guaranteed error, and the displacement that it bounds.
#[derive(Clone, Debug, Serialize)]
pub struct Guarantee {
    /// The body for which the bounds hold.
    pub domain: Domain,
    /// A bound on the distance between the exact displacement and that of the bound in the norm of energy, the root of
    /// force times length.
    pub distance: f64,
    /// |sigma - tau_m| / |v|: tau_m the mean of the stress of v and of the stress in balance.
    pub mean_stress_error: Bound,
    /// The interval that contains the exact potential energy: D(tau) and J(v), in force times length.
    pub potential_energy: [f64; 2],
    /// The sum of the contact forces of the displacement v of the bound, in force.
    pub contact_force: f64,
    /// The part of the body that carries the force, as "per metre".
    pub force_basis: String,
    /// The interval `[low, high]` that contains the exact contact force, in force; `None` if obstacles come from
    /// several directions.
    pub force_interval: Option<[f64; 2]>,
    /// The largest relative defect found by the check of balance, signs and distances: rounding.
    pub defect: f64,
    /// The result on the scene's own mesh; `None` if that has no answer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub own_mesh: Option<JudgedMesh>,
    /// The judgement of the answer on the last mesh; `None` without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub last_mesh: Option<JudgedMesh>,
    /// Warnings about the answer on the scene's own mesh that no finer mesh settles.
    pub warnings: Vec<Warning>,
    /// Triangles or tetrahedra of the next mesh, if it was not made.
    #[serde(rename = "next_triangles", skip_serializing_if = "Option::is_none")]
    pub next_elements: Option<usize>,
    /// The displacement and the stresses.
    #[serde(skip)]
    pub answer: ContinuumAnswer,
}

/// The size of the problem on one mesh, and how far its answer is from the continuum at most.
#[derive(Clone, Debug, Serialize)]
pub struct JudgedMesh {
    /// The kinds of its elements by name, as `Q4` or `T3 and Q8`.
    pub element: String,
    /// Number of unknowns of its displacement.
    pub dofs: usize,
    /// The bound on |u - w| / |w|, w its displacement.
    pub total_error: Bound,
    /// The error by recovered stresses: an estimate.
    pub estimated: f64,
}

impl JudgedMesh {
    /// The judgement of an answer of this norm, which is at most `distance` from the continuum.
    pub(super) fn of(answer: &Answer, distance: f64, norm: f64) -> Result<Self, Error> {
        let model = answer.model();
        let bound = if distance == 0.0 { 0.0 } else { distance / norm };
        Ok(JudgedMesh {
            element: model.mesh().kinds().map(ElementKind::name).collect::<Vec<_>>().join(" and "),
            dofs: model.problem().dofs(),
            total_error: Bound { bound, guaranteed: true },
            estimated: answer.discretisation_error()?,
        })
    }
}

/// The body for which a bound holds, if curved sides make it differ from mesh to mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Domain {
    /// That of straight edges between the nodes of the first mesh.
    FirstPolygon,
    /// The polygon of the last mesh; its nodes on known circles lie on the circles.
    LastPolygon,
    /// In space, that of flat faces between the nodes of the first mesh.
    FirstPolyhedron,
}

/// What a search for either kind of error is given.
pub(super) struct Asked<'a> {
    pub scene: &'a Scene,
    pub model: &'a Arc<Model>,
    pub goal: TotalErrorGoal,
    pub settings: &'a Settings,
    /// Called with what was found, after each mesh but the last.
    pub keep: &'a dyn Fn(&TotalError),
    pub clock: Instant,
}

impl Asked<'_> {
    /// What is found before the first mesh; an estimate has a `reason`.
    pub fn begun(&self, reason: Option<String>) -> TotalError {
        TotalError {
            status: Status::NotCertified,
            goal: self.goal,
            ended: Ended::Time,
            total_error: Bound { bound: f64::INFINITY, guaranteed: reason.is_none() },
            reason,
            guarantee: None,
            levels: Vec::new(),
            model: ModelSize::of(self.model.problem()),
            seconds: 0.0,
            meshes: Vec::new(),
            last: Err("it is not computed yet".into()),
        }
    }

    /// Seconds since the start of the search.
    pub fn seconds(&self) -> f64 {
        self.clock.elapsed().as_secs_f64()
    }
}

/// The refined elements hold this share of the square of the error.
///
/// # Source
/// W. Doerfler, "A convergent adaptive algorithm for Poisson's equation", SIAM J. Numer. Anal. 33 (1996) 1106-1124.
pub(super) const MARKED: f64 = 0.5;

/// The errors against the continuum at which a search may end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TotalErrorGoal {
    /// The largest allowed |u - v| / |v|, in the energy norm.
    pub total_error: f64,
    /// The largest allowed error of the force: half the width of its interval over the force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_error: Option<f64>,
}

impl TotalErrorGoal {
    /// The errors that may be asked for, in words.
    pub const ALLOWED: &str = "a number above 0 and below 1, such as 1e-2: it is a relative error";

    /// Returns `true` if this error may be asked for.
    pub fn is_allowed(error: f64) -> bool {
        error > 0.0 && error < 1.0
    }

    pub(super) fn check(self) -> Result<(), Error> {
        for (name, value) in [("total_error", Some(self.total_error)), ("force_error", self.force_error)] {
            if let Some(value) = value.filter(|&value| !Self::is_allowed(value)) {
                return Err(qp::LinearError::Setting { name, value, allowed: Self::ALLOWED }.into());
            }
        }
        Ok(())
    }
}

impl From<f64> for TotalErrorGoal {
    fn from(total_error: f64) -> Self {
        TotalErrorGoal { total_error, force_error: None }
    }
}

/// The seconds of a mesh grow with this power of its unknowns.
pub(super) const PER_UNKNOWN: f64 = 1.3;

/// The reason for which no finer mesh was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ended {
    /// All errors that were asked for are reached.
    Goal,
    /// The next mesh would have taken more time than was left.
    Time,
    /// The next mesh would have taken more memory than available.
    Memory,
    /// No finer mesh exists: the mesh is from a file, and its elements are not bisected.
    Mesh,
}

/// The response to a refinement: the share of the square of the error that it removes, over the share that is refined.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answering {
    refined: f64,
    before: Option<f64>,
}

impl Answering {
    pub fn new() -> Self {
        Answering { refined: MARKED, before: None }
    }

    /// The share to refine at this error: [`MARKED`], or the share that by the response of the last step just meets the
    /// goal.
    pub fn share(&mut self, error: f64, goal: f64) -> f64 {
        let removed = |before: f64, after: f64| 1.0 - (after / before).powi(2);
        let wanted = removed(error, AIM * goal);
        let gain = self.before.map(|before| removed(before, error) / self.refined).filter(|&gain| gain > 0.0);
        self.refined = gain.map_or(MARKED, |gain| (wanted / gain).clamp(LEAST, MARKED));
        self.before = Some(error);
        self.refined
    }
}

/// The resource that an error reports as short.
pub(super) fn shortage(error: &Error) -> Option<Ended> {
    match error {
        Error::Qp(qp::Error::OutOfTime { .. } | qp::Error::Interrupted) => Some(Ended::Time),
        Error::Qp(qp::Error::NoRoom { .. } | qp::Error::TooLarge { .. }) => Some(Ended::Memory),
        _ => None,
    }
}

/// The search aims at the goal times this factor.
const AIM: f64 = 0.95;

/// The smallest share that is refined: a smaller one would take too many meshes.
pub(super) const LEAST: f64 = 0.1;

/// The smallest set of elements whose shares make up `share` of the whole.
pub(super) fn marked(shares: &[f64], share: f64) -> Vec<bool> {
    let mut order: Vec<usize> = (0..shares.len()).collect();
    order.sort_by(|&a, &b| shares[b].total_cmp(&shares[a]));
    let wanted = share * shares.iter().sum::<f64>();
    let (mut sum, mut marked) = (0.0, vec![false; shares.len()]);
    for index in order {
        if sum >= wanted {
            break;
        }
        marked[index] = true;
        sum += shares[index];
    }
    marked
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_of_the_force_is_half_the_width_of_its_interval_over_the_force() {
        let level = |force_interval| Level {
            elements: 2,
            dofs: 4,
            total_error: 0.1,
            contact_force: -10.0,
            kind: LevelKind::Guaranteed {
                stress_dofs: 9,
                mean_stress_error: 0.1,
                force_interval,
                displacement_seconds: 0.0,
                stress_seconds: 0.0,
            },
            seconds: 0.0,
        };
        let wide = level(Some([-12.0, -8.0]));
        assert_eq!(wide.half_width(), Some(0.2));
        assert_eq!((level(Some([-10.0; 2])).half_width(), level(None).half_width()), (Some(0.0), None));
        let goal = |force_error| TotalErrorGoal { total_error: 0.1, force_error };
        assert!(wide.meets(goal(None)) && wide.meets(goal(Some(0.2))) && !wide.meets(goal(Some(0.19))));
        // A goal for the force is not met without an interval.
        assert!(!level(None).meets(goal(Some(0.5))));
    }

    #[test]
    fn an_error_is_asked_for_between_0_and_1() {
        assert!(TotalErrorGoal::from(0.5).check().is_ok());
        for wrong in [0.0, -1.0, 1.0, f64::NAN, f64::INFINITY] {
            assert!(
                matches!(TotalErrorGoal::from(wrong).check(), Err(Error::Linear(qp::LinearError::Setting { .. }))),
                "{wrong}"
            );
            let of_force = TotalErrorGoal { total_error: 0.5, force_error: Some(wrong) };
            assert!(of_force.check().is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_fewest_elements_make_half_of_the_whole() {
        assert_eq!(marked(&[1.0, 4.0, 2.0, 1.0], 0.5), [false, true, false, false]);
        assert_eq!(marked(&[1.0, 3.0, 2.0, 2.0], 0.6), [false, true, true, false]);
        assert_eq!(marked(&[0.0, 0.0], 0.5), [false, false]);
    }

    #[test]
    fn the_last_mesh_is_no_finer_than_the_goal_asks() {
        let mut answering = Answering::new();
        assert_eq!(answering.share(0.4, 0.095), MARKED);
        // Half of the square was refined, and three quarters of the square were removed: to reach 0.1 / 0.95, less than
        // that is needed.
        let goal = 0.1 / AIM;
        let share = answering.share(0.2, goal);
        assert_eq!(share, MARKED);
        let share = answering.share(0.125, goal);
        let gain = (1.0 - (0.125_f64 / 0.2).powi(2)) / MARKED;
        assert!((share - 0.36 / gain).abs() < 1e-12, "{share}");
        // A step without gain gives no information.
        assert_eq!(answering.share(0.125, goal), MARKED);
        assert_eq!(answering.share(0.0951, 0.1), LEAST);
    }
}
