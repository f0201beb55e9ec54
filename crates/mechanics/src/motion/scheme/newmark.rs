//! Newmark's family with the constraint at the end of the step.
//!
//! ```text
//! u^ = u + dt v + dt^2 (1/2 - beta) a,   v^ = v + dt (1 - gamma) a,   u+ = u^ + w,   a+ = w/(beta dt^2),   v+ = v^ + dt gamma a+
//! M a+ + (1 + alpha) (C v+ + K u+ - f+) - alpha (C v + K u - f) = B' lambda+,   B u+ <= g
//! ```
//!
//! # Source
//! H. M. Hilber, T. J. R. Hughes, R. L. Taylor, *Improved numerical dissipation for time integration algorithms in
//! structural dynamics*, Earthq. Eng. Struct. Dyn. 5 (1977) 283-292.

use crate::error::Error;
use crate::motion::step::{Advance, Found, Stepping, next, plus};
use crate::motion::{Balance, DynamicProblem, State};
use signorini_qp::Settings;

#[derive(Debug)]
pub(super) struct Newmark {
    alpha: f64,
    beta: f64,
    gamma: f64,
    pub stepping: Stepping,
    mass: Stepping,
}

/// The start of a step: displacement and velocity as they would be without its acceleration, and the contact problem of
/// the change.
pub(super) struct Predicted {
    pub displacement: Vec<f64>,
    velocity: Vec<f64>,
    pub force: Vec<f64>,
    pub gap: Vec<f64>,
}

impl Newmark {
    /// The rule with parameter alpha; `rigid` are the settings of the contact problems with the mass, `settings` those
    /// of the steps.
    pub fn new(
        problem: &DynamicProblem,
        step: f64,
        alpha: f64,
        settings: &Settings,
        rigid: &Settings,
    ) -> Result<Self, Error> {
        let (beta, gamma) = ((1.0 - alpha).powi(2) / 4.0, 0.5 - alpha);
        let inertia = 1.0 / (beta * step * step);
        let weight = 1.0 + alpha;
        let matrix = problem.combination(inertia, weight * gamma / (beta * step), weight)?;
        let stepping = Stepping::of(problem, matrix, settings)?;
        Ok(Newmark { alpha, beta, gamma, stepping, mass: Stepping::of_mass(problem, rigid)? })
    }

    /// The contact problem of the step from `state`.
    pub fn predict(&self, problem: &DynamicProblem, step: f64, state: &State) -> Predicted {
        let Newmark { alpha, beta, gamma, .. } = *self;
        let time = |steps: usize| steps as f64 * step;
        let coasting = plus(&state.displacement, step, &state.velocity);
        let displacement = plus(&coasting, step * step * (0.5 - beta), &state.acceleration);
        let velocity = plus(&state.velocity, step * (1.0 - gamma), &state.acceleration);
        let elastic = problem.statics().stiffness().mul(&displacement);
        let mut force = plus(&problem.load_at(time(state.steps + 1)), -1.0, &elastic);
        problem.damp(1.0, &velocity, &mut force);
        if alpha != 0.0 {
            let mut before = plus(&problem.load_at(time(state.steps)), -1.0, &state.elastic);
            problem.damp(1.0, &state.velocity, &mut before);
            force.iter_mut().zip(before).for_each(|(f, before)| *f = (1.0 + alpha) * *f - alpha * before);
        }
        let gap = problem.remaining_gap(&displacement);
        Predicted { displacement, velocity, force, gap }
    }

    /// The end of the step from `state` with the given change.
    pub fn arrive(
        &self,
        problem: &DynamicProblem,
        step: f64,
        state: &State,
        predicted: &Predicted,
        found: Found,
    ) -> State {
        let Newmark { beta, gamma, .. } = *self;
        let displacement = plus(&predicted.displacement, 1.0, &found.change);
        let velocity = plus(&predicted.velocity, gamma / (beta * step), &found.change);
        let acceleration = found.change.iter().map(|w| w / (beta * step * step)).collect();
        let contact = (found.multiplier, found.contact_set);
        State { acceleration, ..next(problem, state, [displacement, velocity], contact) }
    }
}

impl Advance for Newmark {
    /// The initial acceleration; contact rows that would be violated within the step act against it.
    fn start(&self, problem: &DynamicProblem, step: f64, state: State) -> Result<State, Error> {
        let mut force = plus(&problem.load_at(0.0), -1.0, &state.elastic);
        problem.damp(1.0, &state.velocity, &mut force);
        let coasting = plus(&state.displacement, step, &state.velocity);
        let room = problem.remaining_gap(&coasting);
        let bound = room.into_iter().map(|gap| 2.0 * gap.max(0.0) / (step * step)).collect();
        let acceleration = self.mass.solve(force, bound, &state.contact_set)?.change;
        Ok(State { acceleration, ..state })
    }

    fn advance(&self, problem: &DynamicProblem, step: f64, state: &State) -> Result<State, Error> {
        let predicted = self.predict(problem, step, state);
        let found = self.stepping.solve(predicted.force.clone(), predicted.gap.clone(), &state.contact_set)?;
        Ok(self.arrive(problem, step, state, &predicted, found))
    }

    /// The balance at the end of the step, or with alpha < 0 earlier by the share `-alpha`; the acceleration is that of
    /// the end.
    fn balance(&self, step: f64, before: &State, after: &State, at: &[usize]) -> Balance {
        let acceleration = at.iter().map(|&dof| after.acceleration[dof]).collect();
        Balance { acceleration, ..Balance::between(step, before, after, 1.0 + self.alpha, at) }
    }
}
