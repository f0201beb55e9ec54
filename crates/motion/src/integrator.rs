//! The loop over steps: prepare once, advance many times.

use std::time::Instant;

use super::step::{Advance, HalfStep, plus};
use super::{Balance, DynamicProblem, Observation, Scheme, State};
use signorini_fem::assembly::MassForm;
use signorini_qp as qp;
use signorini_qp::Error;
use signorini_qp::{ContactSet, Method, Settings, Watch, dot, largest};

/// Rounding of the displacement and the gaps, relative to the largest entry: below this there is no penetration at the
/// start.
const GAP_ROUNDING: f64 = 1e-12;

/// A motion with its scheme and its step.
///
/// Bytes of an unknown, and of an entry of the stiffness, both triangles, that a motion takes beside the solve of a
/// step: its mass, the matrix of a step, its states and their frames.
const OF_MOTION: [f64; 2] = [400.0, 40.0];

/// Bytes that a motion takes beside the solve of a step.
#[doc(hidden)]
pub fn bytes_of_motion(dofs: f64, entries: f64) -> f64 {
    OF_MOTION[0] * dofs + OF_MOTION[1] * entries
}

/// The matrix of the steps is factorised when the integrator is made, and never again.
#[derive(Debug)]
pub struct Integrator {
    problem: DynamicProblem,
    step: f64,
    scheme: Box<dyn Advance>,
    /// The times at which the loads of a step are evaluated, as shares of the step from 0 to 1.
    load_times: &'static [f64],
    state: State,
    /// The state one step earlier; `None` before the first step of this integrator, or of the first after a resume.
    before: Option<State>,
    watch: Watch,
    /// Seconds of the longest step so far.
    longest: f64,
}

impl Integrator {
    /// Prepares the motion of `problem` in steps of `step`; `settings` choose the method for the contact problem of a
    /// step.
    pub fn new(problem: DynamicProblem, scheme: Scheme, step: f64, settings: &Settings) -> Result<Self, Error> {
        if !(step.is_finite() && step > 0.0) {
            return Err(qp::LinearError::Setting { name: "step", value: step, allowed: "positive and finite" }.into());
        }
        scheme.check()?;
        let reach = largest(problem.displacement())
            .max(problem.statics().gap().iter().filter(|gap| gap.is_finite()).fold(0.0, |max, gap| gap.abs().max(max)));
        let penetration = problem.penetration(problem.displacement(), 0.0);
        if penetration > GAP_ROUNDING * reach {
            let allowed = "zero: no contact row may be violated at the start";
            return Err(qp::LinearError::Setting { name: "initial penetration", value: penetration, allowed }.into());
        }
        let shift = problem.largest_shift();
        if shift > 0.0 && !scheme.about().follows_obstacles {
            let allowed = "zero: the scheme has obstacles at rest only";
            return Err(qp::LinearError::Setting { name: "shift of a contact row", value: shift, allowed }.into());
        }
        if !scheme.allows(MassForm::Redistributed) && !problem.massless().is_empty() {
            let allowed = "positive: dofs without mass are for the midpoint rule";
            return Err(qp::LinearError::Setting { name: "mass of a dof", value: 0.0, allowed }.into());
        }
        let mut settings = settings.started()?.exactly();
        if matches!(settings.method, Method::Penalty(_)) {
            // Penalty answers are never exact, so no tolerance is enforced.
            settings.tolerance = None;
        }
        // The matrices of the motion leave less to the solve of a step.
        let statics = problem.statics();
        let beside = bytes_of_motion(statics.dofs() as f64, statics.stiffness().entries() as f64);
        settings.memory = settings.memory.map(|most| (most - beside).max(1.0));
        let watch = settings.watch.clone();
        let prepared =
            (scheme.about().prepare)(&problem, step, scheme.value(), &settings).map_err(|error| match error {
                qp::Error::TooLarge { dofs, stiffness_entries, factor_entries, bytes, allowed } => {
                    let [bytes, allowed] = [bytes, allowed].map(|taken| taken + beside);
                    qp::Error::TooLarge { dofs, stiffness_entries, factor_entries, bytes, allowed }
                }
                qp::Error::NoRoom { factor, multigrid, allowed, ended } => {
                    let [factor, multigrid, allowed] = [factor, multigrid, allowed].map(|taken| taken + beside);
                    qp::Error::NoRoom { factor, multigrid, allowed, ended }
                }
                error => error,
            })?;
        let violation = problem.statics().violation(problem.displacement());
        let rows = problem.statics().rows();
        let state = State {
            displacement: problem.displacement().to_vec(),
            velocity: problem.velocity().to_vec(),
            acceleration: vec![0.0; problem.statics().dofs()],
            multiplier: vec![0.0; rows],
            contact_set: ContactSet::from_fn(rows, |row| violation[row] >= -GAP_ROUNDING * reach),
            ..State::default()
        };
        let state = prepared.start(&problem, step, state.with_forces(&problem))?;
        if watch.is_over() {
            return Err(qp::Error::Interrupted);
        }
        let load_times = scheme.about().load_times;
        Ok(Integrator { problem, step, scheme: prepared, load_times, state, before: None, watch, longest: 0.0 })
    }

    /// Advances by one step, and returns the state at its end.
    ///
    /// # Errors
    /// Those of a contact solve; [`qp::LinearError::Numerical`] if the motion grows without bound;
    /// [`qp::Error::Interrupted`] if the watch of the settings ends the run, in the state after the last whole step.
    pub fn advance(&mut self) -> Result<&State, Error> {
        if self.watch.time_left().is_some_and(|left| left <= self.longest) {
            return Err(qp::Error::Interrupted);
        }
        let clock = Instant::now();
        let next = self.scheme.advance(&self.problem, self.step, &self.state);
        self.longest = self.longest.max(clock.elapsed().as_secs_f64());
        if self.watch.acknowledge() {
            // The solves of this step may be incomplete.
            return Err(qp::Error::Interrupted);
        }
        let mut next = next?;
        if let Some(value) = next.displacement.iter().chain(&next.velocity).find(|value| !value.is_finite()) {
            let reason = format!("the motion has the value {value} after step {}", next.steps);
            return Err(qp::LinearError::Numerical { step: "time integration", reason }.into());
        }
        let times = self.load_times.iter().map(|share| (self.state.steps as f64 + share) * self.step);
        let halves = [&self.state, &next].map(|state| self.scheme.half_step(&self.problem, self.step, state));
        let moved = match &halves {
            [Some(from), Some(to)] => [&from.displacement, &to.displacement],
            _ => [&self.state.displacement, &next.displacement],
        };
        next.work += self.problem.work(times, moved);
        let time = |steps: usize| steps as f64 * self.step;
        let (now, then) = (time(self.state.steps), time(next.steps));
        next.work += match &halves {
            // From the middle of one step to that of the next.
            [Some(_), Some(_)] => {
                let before = time(self.state.steps.saturating_sub(1));
                self.problem.work_of_obstacles(&next.multiplier, [before, then]) / 2.0
            }
            _ => self.problem.work_of_obstacles(&next.multiplier, [now, then]),
        };
        if self.problem.damping() != [0.0; 2] {
            let everywhere: Vec<usize> = (0..next.displacement.len()).collect();
            let balance = self.scheme.balance(self.step, &self.state, &next, &everywhere);
            next.damped += self.problem.damping_work(&balance.velocity, &plus(moved[1], -1.0, moved[0]));
        }
        self.before = Some(std::mem::replace(&mut self.state, next));
        Ok(&self.state)
    }

    /// The state after the last whole step, or the initial state.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Continues from a state of an earlier integrator of the same problem, scheme and step.
    pub fn resume(&mut self, state: State) -> Result<(), Error> {
        let (dofs, rows) = (self.problem.statics().dofs(), self.problem.statics().rows());
        let lengths = [
            ("displacement", state.displacement.len(), dofs, "dofs"),
            ("velocity", state.velocity.len(), dofs, "dofs"),
            ("acceleration", state.acceleration.len(), dofs, "dofs"),
            ("multiplier", state.multiplier.len(), rows, "contact rows"),
            ("contact set", state.contact_set.rows(), rows, "contact rows"),
        ];
        // Only some schemes have these.
        let own = [("kept energy", state.kept.len(), rows, "contact rows"), ("rate", state.rate.len(), dofs, "dofs")];
        for (name, found, expected, of) in lengths.into_iter().chain(own.into_iter().filter(|one| one.1 > 0)) {
            qp::LinearError::check_length(name, found, expected, of)?;
        }
        (self.state, self.before) = (state.with_forces(&self.problem), None);
        Ok(())
    }

    /// The balance of forces that the last step solved, at some of the dofs; `None` before the first step, and before
    /// the first step after a resume.
    #[doc(hidden)]
    pub fn balance(&self, at: &[usize]) -> Option<Balance> {
        let before = self.before.as_ref()?;
        Some(self.scheme.balance(self.step, before, &self.state, at))
    }

    /// The current time: the number of steps times the step.
    pub fn time(&self) -> f64 {
        self.state.steps as f64 * self.step
    }

    /// Length of a step of this integrator, in time, positive.
    pub fn step(&self) -> f64 {
        self.step
    }

    /// The motion to be integrated, with its mass, loads and initial state.
    pub fn problem(&self) -> &DynamicProblem {
        &self.problem
    }

    /// The current energies, force and penetration.
    pub fn observe(&self) -> Observation {
        let State { displacement, velocity, elastic, momentum, multiplier, contact_set, .. } = &self.state;
        let half = self.scheme.half_step(&self.problem, self.step, &self.state);
        let (moved, forces, kinetic) = match &half {
            Some(HalfStep { displacement, elastic, kinetic }) => (displacement, elastic, *kinetic),
            None => (displacement, elastic, dot(velocity, momentum) / 2.0),
        };
        let [strain, potential] = self.problem.energies(moved, forces, self.time());
        Observation {
            time: self.time(),
            force: multiplier.iter().fold(0.0, |force, lambda| force - lambda),
            closed: contact_set.count(),
            penetration: self.problem.penetration(displacement, self.time()),
            kinetic,
            strain,
            potential,
            work: self.state.work,
            damped: self.state.damped,
            penalties: self.state.penalties,
            acting: self.scheme.acting(self.step, self.state.steps),
        }
    }
}
