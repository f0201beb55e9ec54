//! The trapezoidal rule with springs of `penalty` times the local stiffness instead of closed rows.

use super::newmark::Newmark;
use super::trapezoidal;
use crate::motion::step::{About, Parameter};
use signorini_qp::{Method, Penalty, Settings};

pub(super) static ABOUT: About = About {
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
    ..trapezoidal::ABOUT
};

/// The settings with springs of one penalty, in multiples of the local stiffness, instead of closed rows.
pub(super) fn springs(settings: &Settings, penalty: f64) -> Settings {
    let one = Penalty { first: penalty, last: penalty, penetration_threshold: 0.0 };
    // Springs yield, so that no certificate of rigid contact is possible.
    settings.clone().by(Method::Penalty(one)).without_tolerance()
}
