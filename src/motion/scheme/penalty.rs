//! The trapezoidal rule with springs of `penalty` times the local stiffness in place of closed rows.

use super::newmark::{MASSES, Newmark};
use crate::motion::step::{About, Parameter};
use crate::qp::{Method, Penalty};

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
        let one = Penalty { first: penalty, last: penalty, penetration_threshold: 0.0, ..Penalty::default() };
        springs.method = Method::Penalty(one);
        // Springs give; no certificate of rigid contact can be asked of them.
        springs.tolerance = f64::MAX;
        Ok(Box::new(Newmark::new(problem, step, 0.0, &springs, settings)?))
    },
};
