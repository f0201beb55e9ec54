//! The state before and after a step.

use serde::{Deserialize, Serialize};

use super::DynamicProblem;
use signorini_qp::ContactSet;

/// The state of a body after some steps: all data that the next step depends on.
///
/// The forces that follow from it, K u and M v, are computed by the integrator that goes on from it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Number of steps from the start of the motion to this state.
    pub steps: usize,
    /// Displacement u, one entry per dof, in length, along the positive axes.
    pub displacement: Vec<f64>,
    /// Velocity v, one entry per dof, in length over time; for a dof without mass, the mean over the last step.
    pub velocity: Vec<f64>,
    /// Acceleration a, one entry per dof, in length over time squared; only schemes of Newmark's kind and central
    /// differences store it.
    pub acceleration: Vec<f64>,
    /// Work of loads and of obstacles that move since the start, in force times length; forces that hold prescribed
    /// displacements do none.
    pub work: f64,
    /// Energy that damping took from the start to this state, in force times length.
    #[serde(default)]
    pub damped: f64,
    /// Number of penalties that the step to this state tried; 0 in schemes without a loop over penalties.
    pub penalties: usize,
    /// Contact multiplier of the last step, one entry per contact row, in force, `<= 0`.
    pub multiplier: Vec<f64>,
    /// Energy that each contact row took from its node when the node stopped, in force times length; only `fox-goodwin`
    /// stores it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub kept: Vec<f64>,
    /// K v, one entry per dof, in force over time; empty in schemes that do not need it, and before the first step.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rate: Vec<f64>,
    /// Rows that were closed in the last step: the start of the search in the next step. Code that writes a state lists
    /// them itself.
    #[serde(skip)]
    pub contact_set: ContactSet,
    /// Displacement at the middle of the last step, one entry per dof, in length, if that is not the mean of both ends;
    /// otherwise empty. No later step depends on it.
    #[serde(skip)]
    pub(super) middle: Vec<f64>,
    /// Elastic forces K u, one entry per dof, in force.
    #[serde(skip)]
    pub(super) elastic: Vec<f64>,
    /// Momentum M v, one entry per dof, in mass times length over time.
    #[serde(skip)]
    pub(super) momentum: Vec<f64>,
}

impl State {
    /// The same with the elastic forces and the momentum of its displacement and velocity.
    pub(super) fn with_forces(self, problem: &DynamicProblem) -> Self {
        let elastic = problem.statics().stiffness().mul(&self.displacement);
        let momentum = problem.mass().mul(&self.velocity);
        State { elastic, momentum, ..self }
    }
}

/// The numbers of a state: force, penetration and energies, as a line of a history shows them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Observation {
    /// Time of this state since the start of the motion: the number of steps times their length.
    pub time: f64,
    /// Total contact force of the last step, `-sum(lambda)`, in force, `>= 0`.
    pub force: f64,
    /// Closed rows of the last step.
    pub closed: usize,
    /// Deepest penetration of a row in this state, in length.
    pub penetration: f64,
    /// Kinetic energy, `v'M v / 2`, in force times length.
    pub kinetic: f64,
    /// Strain energy, `u'K u / 2` if nothing but zero is prescribed, in force times length.
    pub strain: f64,
    /// Potential of the loads, `-f'u`, in force times length.
    pub potential: f64,
    /// Work of loads and moving obstacles from the start to the time of this line, in force times length.
    pub work: f64,
    /// Energy that damping took from the start to the time of this line, in force times length.
    pub damped: f64,
    /// Number of penalties that the last step before this line tried; 0 in schemes without a loop over penalties.
    pub penalties: usize,
    /// Between which times the force acted, `[from, to]`, in time, since the start of the motion.
    pub acting: [f64; 2],
}

impl Observation {
    /// The sum of the three energies, in force times length: constant if the loads are constant and there is no
    /// damping.
    pub fn energy(&self) -> f64 {
        self.kinetic + self.strain + self.potential
    }
}
