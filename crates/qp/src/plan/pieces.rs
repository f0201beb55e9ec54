//! The pieces of a problem that are solved separately.

use crate::problem::ContactProblem;
use crate::settings::{Method, Settings};
use crate::transform::Pieces;

/// A piece has at least this number of unknowns, if all parts together have twice as many: smaller parts are solved
/// faster together.
const PIECE: usize = 2000;

/// The pieces to solve separately; `None` if the problem is solved as one.
pub(super) fn pieces_of(problem: &ContactProblem, settings: &Settings) -> Option<Pieces> {
    let is_free = matches!(settings.method, Method::Auto | Method::ActiveSet);
    let parts = problem.parts();
    if !is_free || parts.count() == 1 || problem.dofs() < 2 * PIECE || !parts.are_apart(problem.stiffness()) {
        return None;
    }
    let (mut of_part, mut count, mut dofs) = (Vec::with_capacity(parts.count()), 0, 0);
    let mut left = problem.dofs();
    for of_this in parts.sums(|_| 1.0) {
        of_part.push(count);
        (dofs, left) = (dofs + of_this as usize, left - of_this as usize);
        if dofs >= PIECE && left >= PIECE {
            (count, dofs) = (count + 1, 0);
        }
    }
    let of_dof = parts.of_dofs().iter().map(|&part| of_part[part]).collect();
    (count > 0).then(|| Pieces::of(problem, of_dof, count + 1))
}

#[cfg(test)]
mod tests {
    use super::{PIECE, pieces_of};
    use crate::problem::ContactProblem;
    use crate::settings::{Method, Settings};

    /// Chains of springs, of these lengths.
    fn chains(lengths: &[usize]) -> ContactProblem {
        let mut entries = Vec::new();
        let mut first = 0;
        for length in lengths {
            entries.extend((first..first + length).map(|dof| (dof, dof, 2.0)));
            entries.extend((first + 1..first + length).map(|dof| (dof, dof - 1, -1.0)));
            first += length;
        }
        ContactProblem::of_entries(&entries, &vec![1.0; first], &[(0, 0, 1.0)], &[1.0])
    }

    #[test]
    fn small_parts_make_a_piece_together_and_no_part_is_cut() {
        let count = |lengths: &[usize], method| {
            let pieces = pieces_of(&chains(lengths), &Settings::with_method(method));
            pieces.map_or(1, |pieces| pieces.count())
        };
        assert_eq!(count(&[PIECE, PIECE, 1], Method::Auto), 2, "the last is too small for itself");
        assert_eq!(count(&[10 * PIECE], Method::Auto), 1);
        assert_eq!(count(&[3 * PIECE, 10], Method::Auto), 1);
        assert_eq!(count(&[10; 1000], Method::ActiveSet), 10_000 / PIECE);
        assert_eq!(count(&[PIECE, PIECE], Method::Mprgp), 1, "a hierarchy keeps parts apart by itself");
    }
}
