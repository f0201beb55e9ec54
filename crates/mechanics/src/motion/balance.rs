//! The balance of forces of a step, including the reactions of the supports at their dofs.

use super::State;

/// The balance of forces that a step solved, with the contact forces of the state after it:
///
/// ```text
/// M a + C v + K u = w_0 f(t_0) + w_1 f(t_1) + B' lambda
/// ```
///
/// Each scheme evaluates u, v, a and the times at which it balances the forces: at the middle of a step, at its end, or
/// between.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Balance {
    /// Displacement u, one entry for each requested dof, in length.
    pub displacement: Vec<f64>,
    /// Velocity v, one entry for each requested dof, in length over time.
    pub velocity: Vec<f64>,
    /// Acceleration a, one entry for each requested dof, in length over time squared; it has no meaning for a dof
    /// without mass.
    pub acceleration: Vec<f64>,
    /// Times t of the loads with their weights w, which add up to one.
    pub loads: [(f64, f64); 2],
}

impl Balance {
    /// At some dofs. Displacement and velocity are `share` times their values after a step of `step` plus `1 - share`
    /// times those before it; the loads are weighted likewise. The acceleration is the mean of the step.
    pub(super) fn between(step: f64, before: &State, after: &State, share: f64, at: &[usize]) -> Self {
        let mix = |before: &[f64], after: &[f64]| -> Vec<f64> {
            at.iter().map(|&dof| (1.0 - share) * before[dof] + share * after[dof]).collect()
        };
        let times = [before, after].map(|state| state.steps as f64 * step);
        Balance {
            displacement: mix(&before.displacement, &after.displacement),
            velocity: mix(&before.velocity, &after.velocity),
            acceleration: at.iter().map(|&dof| (after.velocity[dof] - before.velocity[dof]) / step).collect(),
            loads: [(times[0], 1.0 - share), (times[1], share)],
        }
    }

    /// The balance at the middle of a step of `step` at some dofs: the means of both ends, and the load of the middle.
    pub(super) fn of_middle(step: f64, before: &State, after: &State, at: &[usize]) -> Self {
        let middle = (before.steps as f64 + 0.5) * step;
        Balance { loads: [(middle, 1.0), (middle, 0.0)], ..Self::between(step, before, after, 0.5, at) }
    }
}
