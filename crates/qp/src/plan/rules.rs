//! The method and the precision with a factor, by rules that were fitted to measured times.

use super::attempt::WithFactor;
pub(crate) use crate::cost::fitted::Way;
use crate::cost::fitted::{STEPS, Step};
use crate::method::interior_point::InteriorPoint;
use crate::method::penalty::Penalty;
use crate::problem::ContactProblem;
use crate::settings::{ByFactor, Precision};

/// The interior point aims at this share of the requested accuracy.
const INTERIOR_POINT_SHARE: f64 = 0.1;

/// A factor with fewer multiplications for each row belongs to a chain. Along a chain of more than [`LONG`] rows a
/// front of closed rows takes hundreds of sets; the interior point takes some twenty steps.
const CHAIN: f64 = 200.0;

/// Rows of a long chain.
const LONG: usize = 1000;

/// The penalty of the single rung that should reach an accuracy: this number divided by the accuracy.
const PENALTY_OVER_ACCURACY: f64 = 100.0;

/// Rows with more entries than this in the mean are no rows of contact, which join a node to the few that face it.
const LONG_ROWS: usize = 8;

/// The size of a factor, as the rules measure it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size {
    /// `true` if the stiffness is condensed onto the contact dofs.
    pub is_condensed: bool,
    pub multiplications: f64,
    /// Contact rows of the problem.
    pub rows: usize,
    /// `true` if most sets of rows that may be closed are dependent: the loop of the active set wanders among them.
    pub is_crowded: bool,
}

/// Returns `true` if a problem has more long rows than dofs in them, or if most of its dofs have no stiffness, as in a
/// linear program. Equalities are closed in every answer, and do not count.
pub(super) fn is_crowded(problem: &ContactProblem) -> bool {
    let mut bounded: Vec<bool> = problem.gap().iter().map(|gap| gap.is_finite()).collect();
    problem.equalities().iter().flat_map(|pair| [pair.row, pair.opposed]).for_each(|row| bounded[row] = false);
    let (mut entries, mut dofs) = (0, 0);
    for dof in 0..problem.dofs() {
        let own = problem.contact().column(dof).filter(|&(row, b)| b != 0.0 && bounded[row]).count();
        (entries, dofs) = (entries + own, dofs + usize::from(own > 0));
    }
    let rows = bounded.into_iter().filter(|&bounded| bounded).count();
    let has_long_rows = rows > dofs && entries > LONG_ROWS * rows;
    has_long_rows || (rows > 0 && 2 * problem.without_stiffness().len() > problem.dofs())
}

impl WithFactor {
    /// The way for a factor of this size and a relative accuracy that is good enough; `None` if the method is given.
    pub fn way(&self, accuracy: Option<f64>, of: Size) -> Option<Way> {
        if self.method.is_some() {
            return None;
        }
        let accuracy = accuracy.unwrap_or(0.0);
        let size = if of.is_condensed { of.multiplications } else { of.multiplications / of.rows.max(1) as f64 };
        let covers =
            |step: &&Step| step.condensed == of.is_condensed && step.accuracy <= accuracy && size <= step.up_to;
        let nearest = |a: &&Step, b: &&Step| b.accuracy.total_cmp(&a.accuracy).then(a.up_to.total_cmp(&b.up_to));
        let step = STEPS.iter().filter(covers).min_by(nearest);
        let is_long_chain = !of.is_condensed && of.rows > LONG && size < CHAIN;
        let way = match step.map_or(Way::ActiveSet, |step| step.way) {
            Way::ActiveSet | Way::ActiveSetMixed if of.is_crowded => Way::Qp,
            Way::ActiveSet if is_long_chain => Way::Qp,
            way => way,
        };
        Some(match (way, self.precision) {
            (Way::ActiveSetMixed, Precision::Double) => Way::ActiveSet,
            (Way::ActiveSet, Precision::Mixed) => Way::ActiveSetMixed,
            _ => way,
        })
    }
}

impl Way {
    /// The method, for a relative accuracy that is good enough.
    pub fn method(self, accuracy: Option<f64>) -> ByFactor {
        match (self, accuracy) {
            (Way::ActiveSet | Way::ActiveSetMixed, _) => ByFactor::ActiveSet,
            (Way::QpUnpolished, Some(accuracy)) => {
                ByFactor::Qp(InteriorPoint { polish: false, tolerance: INTERIOR_POINT_SHARE * accuracy })
            }
            (Way::Qp | Way::QpUnpolished, _) => ByFactor::Qp(InteriorPoint::DEFAULT),
            (Way::PenaltyRung, Some(accuracy)) => {
                let rung = PENALTY_OVER_ACCURACY / accuracy;
                ByFactor::Penalty(Penalty { first: rung, last: rung, ..Penalty::DEFAULT })
            }
            (Way::Penalty | Way::PenaltyRung, _) => ByFactor::Penalty(Penalty::DEFAULT),
        }
    }

    /// The precision, if `given` leaves it to the way.
    pub fn precision(self, given: Precision) -> Precision {
        match self {
            Way::ActiveSet => Precision::Double,
            Way::ActiveSetMixed => Precision::Mixed,
            Way::Qp | Way::QpUnpolished | Way::Penalty | Way::PenaltyRung => given,
        }
    }
}
