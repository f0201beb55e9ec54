//! The goal of a total error, and the continuation and end of the search for it.

use serde::Serialize;
use signorini_qp as qp;

use crate::error::Error;

/// The refined elements hold this share of the square of the error.
///
/// # Source
/// W. Doerfler, "A convergent adaptive algorithm for Poisson's equation", SIAM J. Numer. Anal. 33 (1996) 1106-1124.
pub(super) const MARKED: f64 = 0.5;

/// The errors against the continuum at which a search may end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TotalErrorGoal {
    /// The largest allowed |u - v| / |v|, in the energy norm.
    pub total_error: f64,
    /// The largest allowed error of the force: half the width of its interval over the force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_error: Option<f64>,
}

impl TotalErrorGoal {
    /// The errors that may be asked for, in words.
    pub const ALLOWED: &str = "a number above 0 and below 1, such as 1e-2: it is a relative error";

    /// Returns `true` if this error may be asked for.
    pub fn is_allowed(error: f64) -> bool {
        error > 0.0 && error < 1.0
    }

    pub(super) fn check(self) -> Result<(), Error> {
        for (name, value) in [("total_error", Some(self.total_error)), ("force_error", self.force_error)] {
            if let Some(value) = value.filter(|&value| !Self::is_allowed(value)) {
                return Err(qp::LinearError::Setting { name, value, allowed: Self::ALLOWED }.into());
            }
        }
        Ok(())
    }
}

impl From<f64> for TotalErrorGoal {
    fn from(total_error: f64) -> Self {
        TotalErrorGoal { total_error, force_error: None }
    }
}

/// The seconds of a mesh grow with this power of its unknowns.
pub(super) const PER_UNKNOWN: f64 = 1.3;

/// The reason for which no finer mesh was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ended {
    /// All errors that were asked for are reached.
    Goal,
    /// The next mesh would have taken more time than was left.
    Time,
    /// The next mesh would have taken more memory than available.
    Memory,
    /// No finer mesh exists: the mesh is from a file, and its elements are not bisected.
    Mesh,
}

/// The response to a refinement: the share of the square of the error that it removes, over the share that is refined.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answering {
    refined: f64,
    before: Option<f64>,
}

impl Answering {
    pub fn new() -> Self {
        Answering { refined: MARKED, before: None }
    }

    /// The share to refine at this error: [`MARKED`], or the share that by the response of the last step just meets the
    /// goal.
    pub fn share(&mut self, error: f64, goal: f64) -> f64 {
        let removed = |before: f64, after: f64| 1.0 - (after / before).powi(2);
        let wanted = removed(error, AIM * goal);
        let gain = self.before.map(|before| removed(before, error) / self.refined).filter(|&gain| gain > 0.0);
        self.refined = gain.map_or(MARKED, |gain| (wanted / gain).clamp(LEAST, MARKED));
        self.before = Some(error);
        self.refined
    }
}

/// The resource that an error reports as short.
pub(super) fn shortage(error: &Error) -> Option<Ended> {
    match error {
        Error::Qp(qp::Error::OutOfTime { .. } | qp::Error::Interrupted) => Some(Ended::Time),
        Error::Qp(qp::Error::NoRoom { .. } | qp::Error::TooLarge { .. }) => Some(Ended::Memory),
        _ => None,
    }
}

/// The search aims at the goal times this factor.
const AIM: f64 = 0.95;

/// The smallest share that is refined: a smaller one would take too many meshes.
pub(super) const LEAST: f64 = 0.1;

/// The smallest set of elements whose shares make up `share` of the whole.
pub(super) fn marked(shares: &[f64], share: f64) -> Vec<bool> {
    let mut order: Vec<usize> = (0..shares.len()).collect();
    order.sort_by(|&a, &b| shares[b].total_cmp(&shares[a]));
    let wanted = share * shares.iter().sum::<f64>();
    let (mut sum, mut marked) = (0.0, vec![false; shares.len()]);
    for index in order {
        if sum >= wanted {
            break;
        }
        marked[index] = true;
        sum += shares[index];
    }
    marked
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_asked_for_between_0_and_1() {
        assert!(TotalErrorGoal::from(0.5).check().is_ok());
        for wrong in [0.0, -1.0, 1.0, f64::NAN, f64::INFINITY] {
            assert!(
                matches!(TotalErrorGoal::from(wrong).check(), Err(Error::Linear(qp::LinearError::Setting { .. }))),
                "{wrong}"
            );
            let of_force = TotalErrorGoal { total_error: 0.5, force_error: Some(wrong) };
            assert!(of_force.check().is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_fewest_elements_make_half_of_the_whole() {
        assert_eq!(marked(&[1.0, 4.0, 2.0, 1.0], 0.5), [false, true, false, false]);
        assert_eq!(marked(&[1.0, 3.0, 2.0, 2.0], 0.6), [false, true, true, false]);
        assert_eq!(marked(&[0.0, 0.0], 0.5), [false, false]);
    }

    #[test]
    fn the_last_mesh_is_no_finer_than_the_goal_asks() {
        let mut answering = Answering::new();
        assert_eq!(answering.share(0.4, 0.095), MARKED);
        // Half of the square was refined, and three quarters of the square were removed: to reach 0.1 / 0.95, less than
        // that is needed.
        let goal = 0.1 / AIM;
        let share = answering.share(0.2, goal);
        assert_eq!(share, MARKED);
        let share = answering.share(0.125, goal);
        let gain = (1.0 - (0.125_f64 / 0.2).powi(2)) / MARKED;
        assert!((share - 0.36 / gain).abs() < 1e-12, "{share}");
        // A step without gain gives no information.
        assert_eq!(answering.share(0.125, goal), MARKED);
        assert_eq!(answering.share(0.0951, 0.1), LEAST);
    }
}
