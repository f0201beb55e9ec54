//! The trapezoidal rule with the classical penalty loop in every step: springs ten times stiffer, until nothing
//! penetrates.
//!
//! ```text
//! for eps = 1, 10, 100, ... times the local stiffness of a step:
//!     repeat: (K_eff + eps C) u = f_eff + eps C g,  C <- heaviside(u - g)     until C repeats
//!     stop when norm[C (u - g)] < threshold times the largest displacement of the body
//! ```
//!
//! The contact set of a penalty starts from that of the penalty before, the first from that of the last step.

use super::newmark::{self, Newmark};
use crate::error::Error;
use crate::motion::step::{About, Advance, Parameter, Stepping};
use crate::motion::{Balance, DynamicProblem, State};
use signorini_qp as qp;
use signorini_qp::{Method, Penalty, Settings, largest};

/// Number of penalties, each ten times the one before, from the local stiffness on. At the last one, 1e8, the rounding
/// of double precision and the remaining penetration are equally large; larger penalties would only add noise.
const PENALTIES: i32 = 9;

pub(super) static PENALTY_LOOP: About = About {
    name: "penalty-loop",
    parameter: Some(Parameter {
        name: "threshold",
        default: 1e-6,
        allows: |threshold| threshold > 0.0 && threshold <= 0.1,
        range: "positive and at most 0.1",
    }),
    penetrates: true,
    prepare: |problem, step, threshold, settings| {
        let newmark = Newmark::new(problem, step, 0.0, &springs(settings, 1.0), settings)?;
        let stiffer = (1..PENALTIES).map(|power| newmark.stepping.under(&springs(settings, 10.0_f64.powi(power))));
        let stiffer = stiffer.collect::<Result<Vec<_>, Error>>()?;
        Ok(Box::new(PenaltyLoop { threshold, newmark, stiffer }))
    },
    ..newmark::TRAPEZOIDAL
};

#[derive(Debug)]
struct PenaltyLoop {
    threshold: f64,
    /// The rule with the first penalty.
    newmark: Newmark,
    /// The larger penalties, with the same factor.
    stiffer: Vec<Stepping>,
}

impl Advance for PenaltyLoop {
    fn start(&self, problem: &DynamicProblem, step: f64, state: State) -> Result<State, Error> {
        self.newmark.start(problem, step, state)
    }

    fn advance(&self, problem: &DynamicProblem, step: f64, state: &State) -> Result<State, Error> {
        let predicted = self.newmark.predict(problem, step, state);
        let mut closed = state.contact_set.clone();
        let mut left = f64::INFINITY;
        for (index, penalty) in std::iter::once(&self.newmark.stepping).chain(&self.stiffer).enumerate() {
            let found = penalty.solve(predicted.force.clone(), predicted.gap.clone(), &closed)?;
            closed = found.contact_set.clone();
            let next = self.newmark.arrive(problem, step, state, &predicted, found);
            let scale = largest(&next.displacement).max(largest(&predicted.displacement));
            let inside = problem.remaining_gap(&next.displacement).into_iter().filter(|&gap| gap < 0.0);
            let norm = inside.map(|gap| gap * gap).sum::<f64>().sqrt();
            if norm <= self.threshold * scale {
                return Ok(State { penalties: index + 1, ..next });
            }
            left = norm / scale;
        }
        let reason = format!(
            "in step {} the last of {PENALTIES} penalties leaves a penetration of {left:.1e} of the largest \
             displacement, above the threshold {:e}; take a larger threshold",
            state.steps + 1,
            self.threshold
        );
        Err(qp::LinearError::Numerical { step: "penalty loop", reason }.into())
    }

    fn balance(&self, step: f64, before: &State, after: &State, at: &[usize]) -> Balance {
        self.newmark.balance(step, before, after, at)
    }
}

// The trapezoidal rule with springs of `penalty` times the local stiffness instead of closed rows.

pub(super) static PENALTY: About = About {
    name: "penalty",
    parameter: Some(Parameter {
        name: "penalty",
        default: 10.0,
        allows: |penalty| penalty.is_finite() && penalty > 0.0,
        range: "positive and finite",
    }),
    penetrates: true,
    prepare: |problem, step, penalty, settings| {
        Ok(Box::new(Newmark::new(problem, step, 0.0, &springs(settings, penalty), settings)?))
    },
    ..newmark::TRAPEZOIDAL
};

/// The settings with springs of one penalty, in multiples of the local stiffness, instead of closed rows.
pub(super) fn springs(settings: &Settings, penalty: f64) -> Settings {
    let one = Penalty { first: penalty, last: penalty, penetration_threshold: 0.0 };
    // Springs yield, so that no certificate of rigid contact is possible.
    settings.clone().by(Method::Penalty(one)).without_tolerance()
}
