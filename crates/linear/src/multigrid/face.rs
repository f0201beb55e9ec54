//! The hierarchy in a face: the subspace in which single displacements are held, such as those of closed contact rows.
//!
//! With a projection N that takes what is held away, `E = I - N`, the first prolongator becomes E P. Where the held
//! displacements are orthonormal N is a symmetric matrix Q; where a pivot gives way instead, `N = sum of d r'` with the
//! ways d and the rows r, `r'd = 1`, and the pivot follows the other dofs of its row. Every coarse matrix A changes by
//! a matrix C, only near the held dofs: nothing else is built again.
//!
//! ```text
//! A_1 - C_1 = P' E' A E P,     C_1 = S + S' - P' (N' A N) P  with S = P' (N' A) P,     C_k+1 = P' C_k P
//! ```
//!
//! From the face of N to that of N + D, C_1 grows by `S + S' - P' (D' A D) P` with `S = P' D' A (I - N) P`: the work
//! depends on the change, not on the number of held displacements.
//!
//! # Source
//! R. Kornhuber, *Monotone multigrid methods for elliptic variational inequalities I*, Numer. Math. 69 (1994) 167-184:
//! truncated basis functions. B. I. Wohlmuth, R. H. Krause, *Monotone multigrid methods on nonmatching grids for
//! nonlinear multibody contact problems*, SIAM J. Sci. Comput. 25 (2003) 324-347: pivots that follow the other body.

use super::blocks::BlockMatrix;
use super::chebyshev::Chebyshev;
use super::coarsest::Coarsest;
use super::held::{Held, Hold, ways};
use super::hierarchy::{Hierarchy, Level};
use crate::FactorError;
use crate::real::Real;

/// The data of a face on the levels of a hierarchy.
#[derive(Debug)]
pub struct FaceLevels<T> {
    pub held: Held<T>,
    /// C of each level except the finest.
    pub changes: Vec<BlockMatrix<T>>,
    /// The smoother of each level except the coarsest; none of the finest, unless a pivot gives way or it works on
    /// patches: the face does not change it then.
    pub smoothers: Vec<Option<Chebyshev<T>>>,
    pub coarsest: Coarsest,
}

impl<T: Real> FaceLevels<T> {
    /// The hierarchy if the displacements of `holds` are held: built from the `last` face if less changes from there.
    pub fn new(hierarchy: &Hierarchy<T>, holds: &[Hold], last: Option<&FaceLevels<T>>) -> Result<Self, FactorError> {
        let held = Held::of(&hierarchy.nodes, holds);
        let from_last = last.map(|last| (last, held.beyond(&last.held)));
        let near = from_last.filter(|(_, newly)| newly.matrix.indices.len() < held.matrix.indices.len());
        let changes = match &near {
            Some((last, newly_held)) => changes(hierarchy, newly_held, Some(last)),
            None => changes(hierarchy, &held, None),
        };
        // What is only cut hardly changes the eigenvalues of a smoother.
        let gives_way = holds.iter().any(|hold| hold.way != hold.row);
        let smoother = |level: &Level<T>, change: &BlockMatrix<T>| {
            let smoother = level.smoother.changed(&level.matrix, change);
            if gives_way { smoother.measured(&level.matrix, change, hierarchy.threads) } else { smoother }
        };
        let finest = hierarchy.levels.first().filter(|level| gives_way || level.smoother.has_patches());
        let finest = finest.map(|level| {
            let change = held.change(&level.matrix);
            // What is held must not move with the rest of its patch, and needs a stiffness to be left out of it.
            let is_kept = !level.smoother.has_patches();
            smoother(level, &if is_kept { change } else { change.plus(-1.0, &ways(&hierarchy.nodes, holds)) })
        });
        let matrices = || hierarchy.matrices().skip(1).zip(&changes);
        let coarser = hierarchy.levels.iter().skip(1).zip(&changes);
        let smoothers =
            [finest].into_iter().chain(coarser.map(|(level, change)| Some(smoother(level, change)))).collect();
        let coarsest = match matrices().last() {
            Some((matrix, change)) => hierarchy.coarsest.in_face(matrix, change)?,
            None => Coarsest::of(&held.held_matrix(&hierarchy.coarsest_matrix, &hierarchy.nodes, holds), false)?,
        };
        Ok(FaceLevels { held, changes, smoothers, coarsest })
    }
}

/// C of each level except the finest; D is `newly_held`, beyond N, which the face `last` holds.
fn changes<T: Real>(
    hierarchy: &Hierarchy<T>,
    newly_held: &Held<T>,
    last: Option<&FaceLevels<T>>,
) -> Vec<BlockMatrix<T>> {
    let threads = hierarchy.threads;
    let (mut of_levels, mut steps): (Vec<BlockMatrix<T>>, Vec<BlockMatrix<T>>) = (Vec::new(), Vec::new());
    for level in &hierarchy.levels {
        let through = |inner: &BlockMatrix<T>| {
            level.prolongator.transposed_product(&inner.product(&level.prolongator, 1), threads)
        };
        let step = match steps.last() {
            None => {
                let rows = newly_held.forces(&level.matrix);
                let one_side = match last {
                    Some(last) => through(&rows.plus(-1.0, &rows.product(&last.held.matrix, 1))),
                    None => through(&rows),
                };
                one_side.plus(1.0, &one_side.transposed()).plus(-1.0, &through(&rows.product(&newly_held.matrix, 1)))
            }
            Some(above) => through(above),
        };
        let before = last.and_then(|last| last.changes.get(of_levels.len()));
        of_levels.push(before.map_or_else(|| step.clone(), |before| before.plus(1.0, &step)));
        steps.push(step);
    }
    of_levels
}
