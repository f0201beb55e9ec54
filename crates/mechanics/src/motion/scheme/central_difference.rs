//! Central differences with a diagonal mass; a node that would cross the obstacle gets an impulse.
//!
//! ```text
//! v* = v + dt a/2,   v~ = argmin norm_M(v~ - v*) with B v~ <= bound,   u+ = u + dt v~
//! M a+ = f+ - K u+ - C v~,   v+ = v~ + dt a+/2,   lambda = M (v~ - v*)/dt
//! ```
//!
//! The bound lets an open row reach the obstacle but not cross it; with a restitution e > 0 a row that would cross it
//! leaves with `-e` times its velocity.
//!
//! A restitution above 0 makes the mesh oscillate: with e = 0.5 the energy of a bar stays within 1 % at 0.3 of the
//! stable step, and grows by 10 % at 0.5 and by 500 % at 0.9. With e = 0 it never grows: see `fox_goodwin.rs`, of which
//! this is the rule with beta = 0.
//!
//! # Source
//! J. J. Moreau, *Numerical aspects of the sweeping process*, Comput. Methods Appl. Mech. Eng. 177 (1999) 329-349: the
//! impact law.

use super::stable_step::check_step;
use crate::error::Error;
use crate::fem::assembly::MassForm;
use crate::motion::step::{About, Advance, HalfStep, Parameter, Stepping, halfway, next, plus};
use crate::motion::{Balance, DynamicProblem, State};
use signorini_qp::ContactSet;

pub(super) static ABOUT: About = About {
    name: "central-difference",
    parameter: Some(Parameter {
        name: "restitution",
        default: 0.0,
        allows: |restitution| (0.0..=1.0).contains(&restitution),
        range: "from 0 to 1",
    }),
    // The scheme divides by the mass.
    masses: &[MassForm::Lumped],
    gains_energy: false,
    penetrates: false,
    is_explicit: true,
    uses_frequency: false,
    follows_obstacles: false,
    is_exact_in_bars: false,
    load_times: &[0.0],
    unstable_in_contact: &[],
    prepare: |problem, step, restitution, settings| {
        check_step(problem, step)?;
        let mass = Stepping::of_mass(problem, settings)?;
        Ok(Box::new(CentralDifference { restitution, mass, diagonal: problem.mass().diagonal() }))
    },
};

#[derive(Debug)]
struct CentralDifference {
    restitution: f64,
    mass: Stepping,
    diagonal: Vec<f64>,
}

impl CentralDifference {
    /// The acceleration without contact.
    fn acceleration(&self, problem: &DynamicProblem, t: f64, elastic: &[f64], velocity: &[f64]) -> Vec<f64> {
        let mut force = plus(&problem.load_at(t), -1.0, elastic);
        problem.damp(1.0, velocity, &mut force);
        force.iter().zip(&self.diagonal).map(|(f, m)| f / m).collect()
    }
}

impl Advance for CentralDifference {
    fn start(&self, problem: &DynamicProblem, _: f64, state: State) -> Result<State, Error> {
        let acceleration = self.acceleration(problem, 0.0, &state.elastic, &state.velocity);
        Ok(State { acceleration, ..state })
    }

    fn advance(&self, problem: &DynamicProblem, step: f64, state: &State) -> Result<State, Error> {
        let statics = problem.statics();
        let mut velocity = plus(&state.velocity, step / 2.0, &state.acceleration);
        let approach = statics.contact().mul(&velocity);
        let room = problem.remaining_gap(&state.displacement);
        let bound = room.iter().zip(&approach).map(|(room, &approach)| {
            let crosses = step * approach > *room && approach > 0.0;
            let allowed = if crosses && self.restitution > 0.0 { -self.restitution * approach } else { room / step };
            allowed - approach
        });
        let (mut multiplier, mut contact_set) = (vec![0.0; statics.rows()], ContactSet::open(statics.rows()));
        if let Some(blow) = self.mass.smallest(bound.collect(), &state.contact_set)? {
            velocity = plus(&velocity, 1.0, &blow.change);
            multiplier = blow.multiplier.iter().map(|impulse| impulse / step).collect();
            contact_set = blow.contact_set;
        }
        let displacement = plus(&state.displacement, step, &velocity);
        let mut end = next(problem, state, [displacement, velocity], (multiplier, contact_set));
        end.rate = end.elastic.iter().zip(&state.elastic).map(|(after, before)| (after - before) / step).collect();
        end.acceleration = self.acceleration(problem, end.steps as f64 * step, &end.elastic, &end.velocity);
        end.velocity = plus(&end.velocity, step / 2.0, &end.acceleration);
        Ok(end.with_forces(problem))
    }

    /// Leapfrog preserves its energy halfway between two displacements.
    fn half_step(&self, problem: &DynamicProblem, step: f64, state: &State) -> Option<HalfStep> {
        let back = if state.steps == 0 { 0.0 } else { step };
        let velocity = plus(&state.velocity, -back / 2.0, &state.acceleration);
        let momentum = problem.mass().mul(&velocity);
        let rate = match state.rate.is_empty() {
            true => problem.statics().stiffness().mul(&velocity),
            false => state.rate.clone(),
        };
        Some(halfway(back, 0.0, state, (&velocity, &momentum), &rate))
    }

    /// The mean of both ends: the impulse of the contact forces changes the momentum over this interval. Dampers act
    /// with the velocities `v~` that led to both ends; at the start there is only v.
    fn balance(&self, step: f64, before: &State, after: &State, at: &[usize]) -> Balance {
        let back = |state: &State| if state.steps == 0 { 0.0 } else { step / 2.0 };
        let damped = |state: &State, dof: usize| state.velocity[dof] - back(state) * state.acceleration[dof];
        let velocity = at.iter().map(|&dof| (damped(before, dof) + damped(after, dof)) / 2.0).collect();
        Balance { velocity, ..Balance::between(step, before, after, 0.5, at) }
    }
}
