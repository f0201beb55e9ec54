//! The method with a factor.

use super::attempt::WithFactor;
use crate::method::interior_point::InteriorPoint;
use crate::problem::ContactProblem;
use crate::settings::ByFactor;

/// A factor with fewer multiplications for each row belongs to a chain. Along a chain of more than [`LONG`] rows a
/// front of closed rows takes hundreds of sets; the interior point takes some twenty steps.
const CHAIN: f64 = 200.0;

/// Rows of a long chain.
const LONG: usize = 1000;

/// Rows with more entries than this in the mean are no rows of contact, which join a node to the few that face it.
const LONG_ROWS: usize = 8;

/// The size of a factor, as the rules measure it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size {
    /// `true` if the stiffness is condensed onto the contact dofs.
    pub is_condensed: bool,
    pub multiplications: f64,
    pub rows: usize,
    /// `true` if most sets of rows that may be closed are dependent: the loop of the active set wanders among them.
    pub is_crowded: bool,
}

/// Returns `true` if a problem has more long rows than dofs in them, or if most of its dofs have no stiffness, as in a
/// linear program. Equalities are closed in every answer, and do not count.
pub(super) fn is_crowded(problem: &ContactProblem) -> bool {
    let mut bounded: Vec<bool> = problem.gap().iter().map(|gap| gap.is_finite()).collect();
    problem.equalities().iter().flat_map(|pair| [pair.row, pair.opposed]).for_each(|row| bounded[row] = false);
    let of_dof = |dof: usize| problem.contact().column(dof).filter(|&(row, b)| b != 0.0 && bounded[row]);
    let dofs = (0..problem.dofs()).filter(|&dof| of_dof(dof).next().is_some()).count();
    let rows = bounded.iter().filter(|bounded| **bounded).count();
    let has_long_rows = rows > dofs && (0..problem.dofs()).flat_map(of_dof).count() > LONG_ROWS * rows;
    has_long_rows || (rows > 0 && 2 * problem.without_stiffness().len() > problem.dofs())
}

impl WithFactor {
    /// The method for a factor of this size, if none is given: the active set, but where its sets are many.
    pub fn chosen(&self, of: Size) -> ByFactor {
        let is_long_chain = !of.is_condensed && of.rows > LONG && of.multiplications < CHAIN * of.rows as f64;
        let by_rules =
            || if of.is_crowded || is_long_chain { ByFactor::Qp(InteriorPoint::DEFAULT) } else { ByFactor::ActiveSet };
        self.method.unwrap_or_else(by_rules)
    }
}
