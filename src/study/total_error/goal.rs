//! What is asked of a total error, and how a search for it goes on and ends.

use serde::Serialize;

use crate::error::Error;

/// The share of the square of the error that the refined elements make together.
///
/// # Source
/// W. Doerfler, "A convergent adaptive algorithm for Poisson's equation", SIAM J. Numer. Anal. 33 (1996) 1106-1124.
const MARKED: f64 = 0.5;

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct TotalErrorGoal {
    /// The most that |u - v| / |v| may be, in the energy norm.
    pub total_error: f64,
    /// The most that the force may be off, as half the width of its interval over the force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_error: Option<f64>,
}

/// Why no finer mesh was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Ended {
    /// The goal is met.
    Goal,
    /// The next mesh would have taken more time than was left.
    Time,
    /// The next mesh would have taken more memory than there is.
    Memory,
    /// There is no finer mesh: that of a file, of elements that are not bisected.
    Mesh,
}

/// The total error in reports.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Bound {
    /// At least |u - v| / |v|; only about so much if that is not guaranteed.
    pub bound: f64,
    /// Whether it is proven, and not estimated.
    pub guaranteed: bool,
}

/// What an error says is short.
pub(super) fn shortage(error: &Error) -> Option<Ended> {
    match error {
        Error::OutOfTime { .. } | Error::Interrupted => Some(Ended::Time),
        Error::NoRoom { .. } | Error::TooLarge { .. } => Some(Ended::Memory),
        _ => None,
    }
}

/// The fewest elements whose shares make [`MARKED`] of the whole.
pub(super) fn marked(shares: &[f64]) -> Vec<bool> {
    let mut order: Vec<usize> = (0..shares.len()).collect();
    order.sort_by(|&a, &b| shares[b].total_cmp(&shares[a]));
    let wanted = MARKED * shares.iter().sum::<f64>();
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
    fn the_fewest_elements_make_half_of_the_whole() {
        assert_eq!(marked(&[1.0, 4.0, 2.0, 1.0]), [false, true, false, false]);
        assert_eq!(marked(&[1.0, 3.0, 3.0, 2.0]), [false, true, true, false]);
        assert_eq!(marked(&[0.0, 0.0]), [false, false]);
    }
}
