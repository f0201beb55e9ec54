//! Common parts of all schemes: their description, the trait of their steps, the prepared contact problem of a step,
//! sums of vectors.

use std::fmt;

use super::{Balance, DynamicProblem, State};
use crate::error::Error;
use crate::fem::assembly::MassForm;
use signorini_qp::{ContactProblem, ContactSet, Prepared, Settings, SymmetricMatrix, dot};

/// The description of a scheme.
pub struct About {
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
    /// Prepares a motion in steps of one length, with the value of the parameter.
    pub prepare: Prepare,
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
pub(super) struct Found {
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

    /// Factorises the mass of a motion, for initial accelerations, projected predictions and impulses.
    pub fn of_mass(problem: &DynamicProblem, settings: &Settings) -> Result<Self, Error> {
        Self::of(problem, problem.mass().clone(), settings)
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
    pub fn solve(&self, force: Vec<f64>, mut gap: Vec<f64>, start: &ContactSet) -> Result<Found, Error> {
        let changes = force.iter().zip(&self.diagonal).map(|(force, diagonal)| (force / diagonal).abs());
        let rounding = f64::EPSILON * changes.filter(|change| change.is_finite()).fold(0.0, f64::max);
        gap.iter_mut().filter(|gap| gap.abs() <= rounding).for_each(|gap| *gap = 0.0);
        let boundary = self.prepared.with_load(force)?.starting_from(start).step(&gap)?;
        let change = boundary.displacement();
        Ok(Found { change, multiplier: boundary.multiplier, contact_set: boundary.contact_set })
    }

    /// The smallest change in the norm of the matrix with these gaps; `None`, without a solve, if that is zero.
    pub fn smallest(&self, gap: Vec<f64>, start: &ContactSet) -> Result<Option<Found>, Error> {
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
