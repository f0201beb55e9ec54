//! The trapezoidal rule: Newmark's with beta = 1/4 and gamma = 1/2.

use super::newmark::Newmark;
use crate::fem::assembly::MassForm;
use crate::motion::step::About;

/// The other rules of its kind name only what differs.
pub(super) const ABOUT: About = About {
    name: "trapezoidal",
    parameter: None,
    masses: &[MassForm::Consistent, MassForm::Lumped],
    gains_energy: true,
    penetrates: false,
    is_explicit: false,
    uses_frequency: false,
    follows_obstacles: false,
    is_exact_in_bars: false,
    load_times: &[0.0, 1.0],
    unstable_in_contact: &[],
    prepare: |problem, step, _, settings| Ok(Box::new(Newmark::new(problem, step, 0.0, settings, settings)?)),
};
