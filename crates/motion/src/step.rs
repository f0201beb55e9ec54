//! Common parts of all schemes: their description, states and their balance, the trait of their steps, the prepared
//! contact problem of a step, sums of vectors.

use std::fmt;

use super::DynamicProblem;
use serde::{Deserialize, Serialize};
use signorini_fem::assembly::MassForm;
use signorini_qp::Error;
use signorini_qp::{ContactProblem, ContactSet, Prepared, Settings, SymmetricMatrix, dot};

/// The description of a scheme.
pub struct Facts {
    /// Its name in scenes and reports.
    pub name: &'static str,
    /// Its parameter, if it has one.
    pub parameter: Option<Parameter>,
    /// The forms of the mass that it can use; the first one is preferred.
    pub masses: &'static [MassForm],
    /// `true` if it can gain energy at an impact.
    pub gains_energy: bool,
    /// `true` if closed rows are springs.
    pub penetrates: bool,
    /// `true` if its step is limited.
    pub is_explicit: bool,
    /// The times in a step at which it evaluates the loads, from 0 to 1, with equal weights; the work of the loads is
    /// measured at these times.
    pub load_times: &'static [f64],
    /// `true` if it uses a bound on the largest frequency of the mesh.
    pub uses_frequency: bool,
    /// `true` if it follows obstacles that move.
    pub follows_obstacles: bool,
    /// `true` if it moves a bar exactly in steps of the time of a wave through a cell.
    pub is_exact_in_bars: bool,
    /// The forms of the mass with which its energy grows whenever bodies touch.
    pub unstable_in_contact: &'static [MassForm],
    pub(super) prepare: Prepare,
}

/// Prepares the steps of a scheme: the motion, the step, the parameter, the settings of the contact problem of a step.
pub(super) type Prepare = fn(&DynamicProblem, f64, f64, &Settings) -> Result<Box<dyn Advance>, Error>;

/// The parameter of a scheme: its name, its range, and the value that a scene may leave out.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// The field of a scene that holds the value, as `alpha`.
    pub name: &'static str,
    /// The value if a scene leaves it out, dimensionless.
    pub default: f64,
    /// Returns `true` if a value is in its range.
    pub allows: fn(f64) -> bool,
    /// The range in words, for messages.
    pub range: &'static str,
}

/// A scheme with everything prepared that stays the same from step to step.
pub(super) trait Advance: fmt::Debug + Send + Sync {
    fn start(&self, problem: &DynamicProblem, step: f64, state: State) -> Result<State, Error>;
    fn advance(&self, problem: &DynamicProblem, step: f64, state: &State) -> Result<State, Error>;
    /// The balance of forces that the step from `before` to `after` solved, with the multiplier of `after`, at some
    /// dofs.
    fn balance(&self, step: f64, before: &State, after: &State, at: &[usize]) -> Balance;
    /// The middle of the last step, if a scheme measures its energy there and not at the end.
    fn half_step(&self, _: &DynamicProblem, _step: f64, _: &State) -> Option<HalfStep> {
        None
    }
    /// The times between which the contact forces of step number `steps` act, counted from 1.
    fn acting(&self, step: f64, steps: usize) -> [f64; 2] {
        [(steps as f64 - 1.0) * step, steps as f64 * step]
    }
}

/// Displacement and kinetic energy in the middle of a step.
pub(super) struct HalfStep {
    /// Displacement, one entry per dof, in length.
    pub displacement: Vec<f64>,
    /// Its elastic forces, one entry per dof, in force.
    pub elastic: Vec<f64>,
    /// Kinetic energy, in force times length.
    pub kinetic: f64,
}

/// The middle of the last step of length `step` (zero before the first), in which the dofs moved with `velocity`, of
/// this momentum M v and this rate K v of the elastic forces; the mass of the scheme is `M + scaling K`.
///
/// The energy there, with the kinetic part `v'(M + scaling K - step^2/4 K) v/2`, is the one that leapfrog preserves.
pub(super) fn halfway(
    step: f64,
    scaling: f64,
    state: &State,
    (velocity, momentum): (&[f64], &[f64]),
    rate: &[f64],
) -> HalfStep {
    HalfStep {
        displacement: plus(&state.displacement, -step / 2.0, velocity),
        elastic: plus(&state.elastic, -step / 2.0, rate),
        kinetic: dot(velocity, momentum) / 2.0 + (scaling / 2.0 - step * step / 8.0) * dot(velocity, rate),
    }
}

/// A prepared matrix for a sequence of contact problems on the rows of a motion.
#[derive(Debug)]
pub(super) struct Stepping {
    prepared: Prepared,
    /// Of the matrix.
    diagonal: Vec<f64>,
}

/// The result of a step: change of the displacement, multipliers, closed rows.
pub(super) struct Moved {
    pub change: Vec<f64>,
    pub multiplier: Vec<f64>,
    pub contact_set: ContactSet,
}

impl Stepping {
    /// Factorises a matrix (n x n) for the contact rows of a motion.
    pub fn of(problem: &DynamicProblem, matrix: SymmetricMatrix, settings: &Settings) -> Result<Self, Error> {
        let statics = problem.statics();
        let (contact, gap) = (statics.contact().clone(), statics.gap().to_vec());
        Self::new(&ContactProblem::new(matrix, vec![0.0; statics.dofs()], contact, gap)?, settings)
    }

    /// Factorises the matrix of `problem`; its load and gaps only determine which rows exist.
    pub fn new(problem: &ContactProblem, settings: &Settings) -> Result<Self, Error> {
        let diagonal = problem.stiffness().diagonal();
        Stepping { prepared: Prepared::new(problem, settings)?, diagonal }.under(settings)
    }

    pub fn under(&self, settings: &Settings) -> Result<Self, Error> {
        // A step is completed or not done at all: there is no partial step.
        let mut unhurried = settings.clone().watched(&settings.watch.unhurried());
        unhurried.time = None;
        Ok(Stepping { prepared: self.prepared.with_settings(&unhurried)?, diagonal: self.diagonal.clone() })
    }

    /// Solves with a force and gaps, from the set of the last step.
    ///
    /// A gap that is the rounding of the change is none: a part of the body that had to follow it would move by
    /// rounding alone, which no certificate can judge.
    pub fn solve(&self, force: Vec<f64>, mut gap: Vec<f64>, start: &ContactSet) -> Result<Moved, Error> {
        let changes = force.iter().zip(&self.diagonal).map(|(force, diagonal)| (force / diagonal).abs());
        let rounding = f64::EPSILON * changes.filter(|change| change.is_finite()).fold(0.0, f64::max);
        gap.iter_mut().filter(|gap| gap.abs() <= rounding).for_each(|gap| *gap = 0.0);
        let boundary = self.prepared.with_load(force)?.starting_from(start).step(&gap)?;
        let change = boundary.displacement();
        Ok(Moved { change, multiplier: boundary.multiplier, contact_set: boundary.contact_set })
    }

    /// The smallest change in the norm of the matrix with these gaps; `None`, without a solve, if that is zero.
    pub fn smallest(&self, gap: Vec<f64>, start: &ContactSet) -> Result<Option<Moved>, Error> {
        if gap.iter().all(|&gap| gap >= 0.0) {
            return Ok(None);
        }
        let closed = ContactSet::from_fn(start.rows(), |row| gap[row] < 0.0);
        self.solve(vec![0.0; self.prepared.dofs()], gap, &closed).map(Some)
    }

    /// The change under a force alone, as if no row were closed; `None` without a factor of the matrix.
    pub fn response(&self, force: Vec<f64>) -> Result<Option<Vec<f64>>, Error> {
        Ok(self.prepared.with_load(force)?.response())
    }

    /// The change of the displacement alone; it is certified only if the method did not settle on a set.
    pub fn change(&self, force: Vec<f64>, gap: Vec<f64>, start: &ContactSet) -> Result<Vec<f64>, Error> {
        let at_step = self.prepared.with_load(force)?.starting_from(start);
        match at_step.settled(&gap)? {
            Some(change) => Ok(change),
            None => Ok(at_step.step(&gap)?.displacement()),
        }
    }
}

/// The state one step after `before`, with its acceleration: a displacement, a velocity, and the contact forces of the
/// step.
pub(super) fn next(
    problem: &DynamicProblem,
    before: &State,
    [displacement, velocity]: [Vec<f64>; 2],
    (multiplier, contact_set): (Vec<f64>, ContactSet),
) -> State {
    State {
        steps: before.steps + 1,
        acceleration: before.acceleration.clone(),
        work: before.work,
        damped: before.damped,
        displacement,
        velocity,
        multiplier,
        contact_set,
        ..State::default()
    }
    .with_forces(problem)
}

/// `a + factor b`, entry by entry.
pub(super) fn plus(a: &[f64], factor: f64, b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + factor * b).collect()
}

/// The balance of forces that a step solved, with the contact forces of the state after it:
///
/// ```text
/// M a + C v + K u = w_0 f(t_0) + w_1 f(t_1) + B' lambda
/// ```
///
/// Each scheme evaluates u, v, a and the times at which it balances the forces: at the middle of a step, at its end, or
/// between.
#[derive(Clone, Debug, PartialEq)]
pub struct Balance {
    /// Displacement u, one entry for each requested dof, in length.
    pub displacement: Vec<f64>,
    /// Velocity v, one entry for each requested dof, in length over time.
    pub velocity: Vec<f64>,
    /// Acceleration a, one entry for each requested dof, in length over time squared; it has no meaning for a dof
    /// without mass.
    pub acceleration: Vec<f64>,
    /// Times t of the loads with their weights w, which add up to one.
    pub loads: [(f64, f64); 2],
}

impl Balance {
    /// At some dofs. Displacement and velocity are `share` times their values after a step of `step` plus `1 - share`
    /// times those before it; the loads are weighted likewise. The acceleration is the mean of the step.
    pub(super) fn between(step: f64, before: &State, after: &State, share: f64, at: &[usize]) -> Self {
        let mix = |before: &[f64], after: &[f64]| -> Vec<f64> {
            at.iter().map(|&dof| (1.0 - share) * before[dof] + share * after[dof]).collect()
        };
        let times = [before, after].map(|state| state.steps as f64 * step);
        Balance {
            displacement: mix(&before.displacement, &after.displacement),
            velocity: mix(&before.velocity, &after.velocity),
            acceleration: at.iter().map(|&dof| (after.velocity[dof] - before.velocity[dof]) / step).collect(),
            loads: [(times[0], 1.0 - share), (times[1], share)],
        }
    }

    /// The balance at the middle of a step of `step` at some dofs: the means of both ends, and the load of the middle.
    pub(super) fn of_middle(step: f64, before: &State, after: &State, at: &[usize]) -> Self {
        let middle = (before.steps as f64 + 0.5) * step;
        Balance { loads: [(middle, 1.0), (middle, 0.0)], ..Self::between(step, before, after, 0.5, at) }
    }
}

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
