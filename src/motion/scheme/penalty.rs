//! The trapezoidal rule with springs of `penalty` times the local stiffness in place of closed rows.

use super::newmark::{MASSES, Newmark};
use crate::motion::step::{About, Parameter};
use crate::qp::Method;

pub(super) static ABOUT: About = About {
    name: "penalty",
    parameter: Some(Parameter {
        name: "penalty",
        default: 10.0,
        allows: |penalty| penalty.is_finite() && penalty > 0.0,
        range: "positive and finite",
    }),
    masses: MASSES,
    gains_energy: true,
    penetrates: true,
    is_explicit: false,
    prepare: |problem, step, penalty, settings| {
        let mut springs = settings.clone();
        springs.method = Method::Penalty;
        (springs.first_penalty, springs.last_penalty, springs.penetration_threshold) = (penalty, penalty, 0.0);
        // Springs give; no certificate of rigid contact can be asked of them.
        springs.tolerance = f64::MAX;
        Ok(Box::new(Newmark::new(problem, step, 0.0, &springs, settings)?))
    },
};
