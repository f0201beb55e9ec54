//! One V-cycle through a hierarchy, or through the hierarchy in a face: the subspace in which single displacements are
//! held, such as those of closed contact rows.
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
//! The degree of a smoother on patches comes from the measured convergence of cycles. The stiffer the volume is, the
//! slower are the motions without change of volume that no aggregate can make. The slowest parts of an error are left
//! after a few cycles: what the next one takes of their energy says how much more smoothing a cycle needs.
//!
//! # Source
//! R. Kornhuber, *Monotone multigrid methods for elliptic variational inequalities I*, Numer. Math. 69 (1994) 167-184:
//! truncated basis functions. B. I. Wohlmuth, R. H. Krause, *Monotone multigrid methods on nonmatching grids for
//! nonlinear multibody contact problems*, SIAM J. Sci. Comput. 25 (2003) 324-347: pivots that follow the other body.

use std::sync::Arc;

use super::blocks::BlockMatrix;
use super::chebyshev::Chebyshev;
use super::hierarchy::{Coarsest, Hierarchy, Level};
use super::operator::{Held, Hold, Operator, ways};
use crate::real::{Real, power_iteration};
use crate::{FactorError, Spare};

/// Cycles of a quick measurement, and of the one that gives the degree.
const CYCLES: (usize, usize) = (5, 10);

/// A cycle is good enough if the last one of a quick measurement takes this share of the energy: 0.75 at nu = 0.3,
/// below 0.2 at nu = 0.499.
const GOOD_SHARE: f64 = 0.4;

/// The degree for the share s of the energy that the last cycle takes, at degree 3, is this number over s^(3/2).
/// Measured: s is about 0.09 at nu = 0.499, where half the degree takes half as many cycles more in about the same
/// time, and 0.03 at nu = 0.4999.
const DEGREE: f64 = 0.35;

/// The largest degree: beyond it a cycle costs more than it saves.
const MOST: usize = 32;

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

impl<T: Real> Hierarchy<T> {
    /// Approximately `A^-1` of a force, by one V-cycle, in the given face; a vector of `work`.
    pub fn cycle(&self, force: &[f64], face: Option<&FaceLevels<T>>, work: &Spare<f64>) -> Vec<f64> {
        let mut rest = self.spare.zeros(self.nodes.size * self.nodes.count);
        let exponent = self.nodes.gather(force, &mut rest);
        if let Some(face) = face {
            face.held.project_force(&mut rest);
        }
        let moved = self.descend(0, rest, face);
        let mut displacement = work.take(force.len());
        self.nodes.scatter(&moved, self.shift - exponent, &mut displacement);
        self.spare.give(moved);
        displacement
    }

    /// The unknowns of a level under the forces `rest`.
    pub(super) fn descend(&self, depth: usize, mut rest: Vec<T>, face: Option<&FaceLevels<T>>) -> Vec<T> {
        let held = face.filter(|_| depth == 0).map(|face| &face.held);
        let Some(level) = self.levels.get(depth) else {
            let force: Vec<f64> = rest.iter().map(|value| value.double()).collect();
            let coarsest = face.map_or(&*self.coarsest, |face| &face.coarsest);
            let mut x: Vec<T> = coarsest.solve(&force).into_iter().map(T::of).collect();
            held.into_iter().for_each(|held| held.project(&mut x));
            return x;
        };
        let operator = Operator {
            matrix: &level.matrix,
            held,
            change: face.and_then(|face| face.changes.get(depth.wrapping_sub(1))),
            threads: self.threads,
            spare: &self.spare,
        };
        let smoother = face.and_then(|face| face.smoothers.get(depth)?.as_ref()).unwrap_or(&level.smoother);
        let mut x = self.spare.zeros(rest.len());
        let step = smoother.smooth(&operator, &mut x, &mut rest);
        operator.add_product(-1.0, &step, &mut rest);
        self.spare.give(step);
        let restricted = level.prolongator.transposed_mul(&rest, self.threads, &self.spare);
        let correction = self.descend(depth + 1, restricted, face);
        let mut moved = self.spare.zeros(rest.len());
        level.prolongator.add_product(1.0, &correction, &mut moved, self.threads);
        self.spare.give(correction);
        operator.project(&mut moved);
        operator.add(&moved, &mut x);
        operator.add_product(-1.0, &moved, &mut rest);
        let step = smoother.smooth(&operator, &mut x, &mut rest);
        [moved, rest, step].into_iter().for_each(|vector| self.spare.give(vector));
        x
    }

    /// Returns `true` if the finest smoother works on patches and its cycle is not good enough nevertheless.
    pub(super) fn is_slow(&self) -> bool {
        self.levels.first().is_some_and(|level| level.smoother.has_patches()) && self.share_taken(CYCLES.0) < GOOD_SHARE
    }

    /// Raises the degree of the finest smoother as far as the cycle needs.
    pub(super) fn suit_degree(&mut self) {
        let degree = (DEGREE * self.share_taken(CYCLES.1).powf(-1.5)).ceil().min(MOST as f64) as usize;
        if let Some(level) = self.levels.first_mut().and_then(Arc::get_mut) {
            level.smoother.degree = degree.max(level.smoother.degree);
        }
    }

    /// The share of the energy of an error that the last of `cycles` takes.
    fn share_taken(&self, cycles: usize) -> f64 {
        let Some(level) = self.levels.first() else { return 1.0 };
        let operator = Operator::whole(&level.matrix, self.threads, &self.spare);
        let mut share = 1.0;
        power_iteration(operator.dim(), -0.5, cycles, |error| {
            let found = operator.quotient(error, |force| self.descend(0, self.spare.copy(force), None));
            let (of_taken, mut left) = found?;
            share = of_taken;
            left.iter_mut().zip(error).for_each(|(taken, &error)| *taken = error - *taken);
            Some(left)
        });
        share
    }
}
