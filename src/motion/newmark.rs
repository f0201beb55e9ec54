//! Newmark's family with the constraint at the end of the step: trapezoidal rule, HHT-alpha, penalty springs.
//!
//! ```text
//! u^ = u + dt v + dt^2 (1/2 - beta) a,   v^ = v + dt (1 - gamma) a,   u+ = u^ + w,   a+ = w/(beta dt^2),   v+ = v^ + dt gamma a+
//! M a+ + (1 + alpha) (C v+ + K u+ - f+) - alpha (C v + K u - f) = B' lambda+,   B u+ <= g
//! ```
//!
//! # Source
//! H. M. Hilber, T. J. R. Hughes, R. L. Taylor, *Improved numerical dissipation for time integration algorithms in
//! structural dynamics*, Earthq. Eng. Struct. Dyn. 5 (1977) 283-292.

use super::projection::MassProjection;
use super::step::{Advance, Stepping, plus};
use super::{DynamicProblem, State};
use crate::error::Error;
use crate::qp::Penalty;
use crate::qp::problem::ContactProblem;
use crate::qp::{Method, Settings};

#[derive(Debug)]
pub(super) struct Newmark {
    alpha: f64,
    beta: f64,
    gamma: f64,
    stepping: Stepping,
    mass: MassProjection,
}

impl Newmark {
    /// HHT-alpha; the trapezoidal rule where `alpha` is 0.
    pub fn new(problem: &DynamicProblem, step: f64, alpha: f64, settings: &Settings) -> Result<Self, Error> {
        let (beta, gamma) = ((1.0 - alpha).powi(2) / 4.0, 0.5 - alpha);
        let inertia = 1.0 / (beta * step * step);
        let weight = 1.0 + alpha;
        let matrix = problem.combination(inertia, weight * gamma / (beta * step), weight)?;
        let contact = problem.contact();
        let effective =
            ContactProblem::new(matrix, vec![0.0; contact.dofs()], contact.contact().clone(), contact.gap().to_vec())?;
        let stepping = Stepping::new(&effective, settings)?;
        Ok(Newmark { alpha, beta, gamma, stepping, mass: MassProjection::new(problem, settings)? })
    }

    /// The trapezoidal rule with springs of `penalty` times the local stiffness in place of closed rows.
    pub fn with_penalty(problem: &DynamicProblem, step: f64, penalty: f64, settings: &Settings) -> Result<Self, Error> {
        let mut springs = settings.clone();
        let one = Penalty { first: penalty, last: penalty, penetration_threshold: 0.0, ..Penalty::default() };
        springs.method = Method::Penalty(one);
        // Springs give; no certificate of rigid contact can be asked of them.
        springs.tolerance = f64::MAX;
        let newmark = Self::new(problem, step, 0.0, &springs)?;
        Ok(Newmark { mass: MassProjection::new(problem, settings)?, ..newmark })
    }
}

impl Advance for Newmark {
    /// The acceleration with which the motion starts; rows that would be violated within the step hold against it.
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
        let Newmark { alpha, beta, gamma, .. } = *self;
        let time = |steps: usize| steps as f64 * step;
        let coasting = plus(&state.displacement, step, &state.velocity);
        let predicted = plus(&coasting, step * step * (0.5 - beta), &state.acceleration);
        let predicted_velocity = plus(&state.velocity, step * (1.0 - gamma), &state.acceleration);
        let stiffness = problem.contact().stiffness();
        let mut force = plus(&problem.load_at(time(state.steps + 1)), -1.0, &stiffness.mul(&predicted));
        problem.damp(1.0, &predicted_velocity, &mut force);
        if alpha != 0.0 {
            let mut before = plus(&problem.load_at(time(state.steps)), -1.0, &state.elastic);
            problem.damp(1.0, &state.velocity, &mut before);
            force.iter_mut().zip(before).for_each(|(f, before)| *f = (1.0 + alpha) * *f - alpha * before);
        }
        let gap = problem.remaining_gap(&predicted);
        let found = self.stepping.solve(force, gap, &state.contact_set)?;
        let displacement = plus(&predicted, 1.0, &found.change);
        let velocity = plus(&predicted_velocity, gamma / (beta * step), &found.change);
        Ok(State {
            steps: state.steps + 1,
            momentum: problem.mass().mul(&velocity),
            velocity,
            acceleration: found.change.iter().map(|w| w / (beta * step * step)).collect(),
            elastic: stiffness.mul(&displacement),
            displacement,
            multiplier: found.multiplier,
            contact_set: found.contact_set,
        })
    }
}
