//! HHT-alpha: Newmark's rule with beta = (1 - alpha)^2/4 and gamma = 1/2 - alpha, which damps short waves.

use super::newmark::Newmark;
use super::trapezoidal;
use crate::motion::step::{About, Parameter};

pub(super) static ABOUT: About = About {
    name: "hht",
    parameter: Some(Parameter {
        name: "alpha",
        default: -0.1,
        allows: |alpha| (-1.0 / 3.0..=0.0).contains(&alpha),
        range: "from -1/3 to 0",
    }),
    prepare: |problem, step, alpha, settings| Ok(Box::new(Newmark::new(problem, step, alpha, settings, settings)?)),
    ..trapezoidal::ABOUT
};
