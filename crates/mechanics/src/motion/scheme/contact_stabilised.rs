//! Newmark's rule, contact-stabilised: the prediction is made admissible first, and contact forces are implicit.
//!
//! ```text
//! u^ = argmin norm_M(u^ - u - dt v) with B u^ <= g,   u+ = u^ + w,   v+ = v + 2 w/dt
//! (2/dt^2) M w + C (v + w/dt) + K (u + u+)/2 = f(t + dt/2) + B' lambda,   B u+ <= g
//! ```
//!
//! # Source
//! P. Deuflhard, R. Krause, S. Ertel, *A contact-stabilized Newmark method for dynamical contact problems*, Int. J.
//! Numer. Methods Eng. 73 (2008) 1274-1290.

use super::trapezoidal;
use crate::error::Error;
use crate::motion::step::{About, Advance, Stepping, next, plus};
use crate::motion::{Balance, DynamicProblem, State};

pub(super) static ABOUT: About = About {
    name: "contact-stabilised",
    gains_energy: false,
    load_times: &[0.5],
    prepare: |problem, step, _, settings| {
        // The equation above, multiplied by two.
        let matrix = problem.combination(4.0 / (step * step), 2.0 / step, 1.0)?;
        let stepping = Stepping::of(problem, matrix, settings)?;
        Ok(Box::new(ContactStabilised { stepping, mass: Stepping::of_mass(problem, settings)? }))
    },
    ..trapezoidal::ABOUT
};

#[derive(Debug)]
struct ContactStabilised {
    stepping: Stepping,
    mass: Stepping,
}

impl Advance for ContactStabilised {
    fn start(&self, _: &DynamicProblem, _: f64, state: State) -> Result<State, Error> {
        Ok(state)
    }

    fn advance(&self, problem: &DynamicProblem, step: f64, state: &State) -> Result<State, Error> {
        let mut predicted = plus(&state.displacement, step, &state.velocity);
        let bound = problem.remaining_gap(&predicted);
        if let Some(correction) = self.mass.smallest(bound, &state.contact_set)? {
            predicted = plus(&predicted, 1.0, &correction.change);
        }
        let elastic = plus(&state.elastic, 1.0, &problem.statics().stiffness().mul(&predicted));
        let load = problem.load_at((state.steps as f64 + 0.5) * step);
        let mut force: Vec<f64> = load.iter().zip(&elastic).map(|(f, k)| 2.0 * f - k).collect();
        problem.damp(2.0, &state.velocity, &mut force);
        let gap = problem.remaining_gap(&predicted);
        let found = self.stepping.solve(force, gap, &state.contact_set)?;
        let displacement = plus(&predicted, 1.0, &found.change);
        let velocity = plus(&state.velocity, 2.0 / step, &found.change);
        let multiplier = found.multiplier.iter().map(|lambda| lambda / 2.0).collect();
        Ok(next(problem, state, [displacement, velocity], (multiplier, found.contact_set)))
    }

    fn balance(&self, step: f64, before: &State, after: &State, at: &[usize]) -> Balance {
        Balance::of_middle(step, before, after, at)
    }
}
