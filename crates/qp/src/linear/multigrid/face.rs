//! The hierarchy in a face: the subspace in which single displacements are held, such as those of closed contact rows.
//!
//! With Q the projection onto the held directions, the first prolongator becomes (I - Q) P. Every coarse matrix A changes by a
//! matrix C, only near the held dofs: nothing else is built again.
//!
//! ```text
//! A_1 - C_1 = P' (I - Q) A (I - Q) P,     C_1 = S + S' - P' (Q A Q) P  with S = P' (Q A) P,     C_k+1 = P' C_k P
//! ```
//!
//! From the face of Q to that of Q + D, C_1 grows by `S + S' - P' (D A D) P` with `S = P' D A (I - Q) P`: the work depends on
//! the change, not on the number of held directions.
//!
//! # Source
//! R. Kornhuber, *Monotone multigrid methods for elliptic variational inequalities I*, Numer. Math. 69 (1994) 167-184:
//! truncated basis functions.

use super::blocks::BlockMatrix;
use super::chebyshev::Chebyshev;
use super::coarsest::Coarsest;
use super::hierarchy::Hierarchy;
use crate::linear::FactorError;
use crate::linear::factor::Real;

/// A unit vector along which nothing moves: dofs and coefficients, in the units of the nodes. The directions of one face are orthogonal.
pub type Direction = Vec<(usize, f64)>;

/// The data of a face on the levels of a hierarchy.
#[derive(Debug)]
pub struct FaceLevels<T> {
    /// Q.
    pub held: BlockMatrix<T>,
    /// C of each level except the finest.
    pub changes: Vec<BlockMatrix<T>>,
    /// Smoothers of each level except the finest and the coarsest.
    pub smoothers: Vec<Chebyshev<T>>,
    /// The factor of the coarsest matrix.
    pub coarsest: Coarsest,
}

impl<T: Real> FaceLevels<T> {
    /// The hierarchy if nothing moves along `directions`: built from the `last` face if less changes from there.
    ///
    /// # Errors
    /// As [`Hierarchy::new`].
    pub fn new(
        hierarchy: &Hierarchy<T>,
        directions: &[Direction],
        last: Option<&FaceLevels<T>>,
    ) -> Result<Self, FactorError> {
        let held = projection(hierarchy, directions);
        let from_last = last.map(|last| (last, held.plus(-1.0, &last.held).without_zeros()));
        let near = from_last.filter(|(_, change)| change.indices.len() < held.indices.len());
        let changes = match &near {
            Some((last, newly_held)) => changes(hierarchy, newly_held, Some(last)),
            None => changes(hierarchy, &held, None),
        };
        let matrices = || hierarchy.matrices().skip(1).zip(&changes);
        let smoothers = (hierarchy.levels.iter().skip(1).zip(matrices()))
            .map(|(level, (matrix, change))| level.smoother.changed(matrix, change))
            .collect();
        let coarsest = match matrices().last() {
            Some((matrix, change)) => Coarsest::in_face(matrix, change)?,
            None => Coarsest::of(&held_matrix(&hierarchy.coarsest_matrix, &held))?,
        };
        Ok(FaceLevels { held, changes, smoothers, coarsest })
    }
}

/// C of each level except the finest; D is `newly_held`, beyond Q, which the face `last` holds.
fn changes<T: Real>(
    hierarchy: &Hierarchy<T>,
    newly_held: &BlockMatrix<T>,
    last: Option<&FaceLevels<T>>,
) -> Vec<BlockMatrix<T>> {
    let threads = hierarchy.threads;
    let (mut of_levels, mut steps): (Vec<BlockMatrix<T>>, Vec<BlockMatrix<T>>) = (Vec::new(), Vec::new());
    for level in &hierarchy.levels {
        let through =
            |inner: &BlockMatrix<T>| level.restriction.product(&inner.product(&level.prolongator, 1), threads);
        let step = match steps.last() {
            None => {
                let rows = newly_held.product(&level.matrix, 1);
                let one_side = match last {
                    Some(last) => through(&rows.plus(-1.0, &rows.product(&last.held, 1))),
                    None => through(&rows),
                };
                one_side.plus(1.0, &one_side.transposed()).plus(-1.0, &through(&rows.product(newly_held, 1)))
            }
            Some(above) => through(above),
        };
        let before = last.and_then(|last| last.changes.get(of_levels.len()));
        of_levels.push(before.map_or_else(|| step.clone(), |before| before.plus(1.0, &step)));
        steps.push(step);
    }
    of_levels
}

/// `(I - Q) A (I - Q) + Q`, for a hierarchy of one level.
fn held_matrix<T: Real>(matrix: &BlockMatrix<T>, held: &BlockMatrix<T>) -> BlockMatrix<T> {
    let rows = held.product(matrix, 1);
    let both = rows.product(held, 1);
    matrix.plus(-1.0, &rows).plus(-1.0, &rows.transposed()).plus(1.0, &both).plus(1.0, held)
}

/// Q = sum of q q' over the directions.
fn projection<T: Real>(hierarchy: &Hierarchy<T>, directions: &[Direction]) -> BlockMatrix<T> {
    let (size, count) = (hierarchy.nodes.size, hierarchy.nodes.count);
    let mut entries: Vec<(u32, u32, f64)> = Vec::new();
    for direction in directions {
        for &(first, a) in direction {
            for &(second, b) in direction {
                entries.push((hierarchy.nodes.place[first], hierarchy.nodes.place[second], a * b));
            }
        }
    }
    let node = |place: u32| place as usize / size;
    entries.sort_unstable_by_key(|&(row, column, _)| (node(row), node(column)));
    let mut held = BlockMatrix::empty(0, count, (size, size));
    for block in entries.chunk_by(|a, b| (node(a.0), node(a.1)) == (node(b.0), node(b.1))) {
        held.starts.resize(node(block[0].0) + 1, held.indices.len());
        held.indices.push(node(block[0].1) as u32);
        let start = held.values.len();
        held.values.resize(start + size * size, T::default());
        for &(row, column, value) in block {
            held.values[start + row as usize % size * size + column as usize % size] += T::of(value);
        }
    }
    held.starts.resize(count + 1, held.indices.len());
    held
}
