//! The second level of a hierarchy as a separate problem, for unknowns that have bounds.
//!
//! The weights of the bounds and the share of closed parents were chosen by measurement on obstacle problems:
//! unweighted means cost a few cycles more, and every share from 0.5 to 0.99 works.

use super::hierarchy::{Hierarchy, Level, lower_part};
use super::{Levels, Multigrid};
use crate::real::Real;
use crate::{Spare, SparseMatrix, SymmetricMatrix, ldexp};

/// An unknown starts at its bound if more than this share of the unknowns that it is interpolated from is at their
/// bounds.
const CLOSED_SHARE: f64 = 0.7;

/// Lower and upper bound of an unknown, infinite without a bound.
pub type Interval = [f64; 2];

/// The second level of a hierarchy with one unknown for each node: matrix, hierarchy, and the transfer from and to the
/// first, by the first prolongator P.
#[derive(Debug)]
pub struct Coarser {
    /// The Galerkin matrix.
    pub matrix: SymmetricMatrix,
    /// Its hierarchy: the levels below the first.
    pub multigrid: Multigrid,
    place: Vec<u32>,
    /// The exponent of the load: the matrix of the hierarchy is `2^shift` times that of the problem.
    shift: i32,
    /// P by its rows, each a column, in double precision.
    by_row: SparseMatrix,
    /// The near-null vector that P carries.
    near_null: Vec<f64>,
}

impl Multigrid {
    /// The second level as a separate problem; `None` if no second level exists, or if its unknowns are no nodal
    /// values, such as the rigid-body modes of a body's aggregates.
    pub fn coarser(&self) -> Option<Coarser> {
        match &self.levels {
            Levels::Single(hierarchy) => coarser_of(hierarchy, Levels::Single),
            Levels::Double(hierarchy) => coarser_of(hierarchy, Levels::Double),
        }
    }
}

fn coarser_of<T: Real>(hierarchy: &Hierarchy<T>, levels: fn(Hierarchy<T>) -> Levels) -> Option<Coarser> {
    let below = hierarchy.below()?;
    let first: &Level<T> = hierarchy.levels.first()?;
    if first.prolongator.block_size() != 1 {
        return None;
    }
    let matrix = below.levels.first().map_or(&*below.coarsest_matrix, |level| &level.matrix);
    let matrix = lower_part(matrix, false);
    let prolongator = first.prolongator.unshared();
    let values = prolongator.values.iter().map(|value| value.double()).collect();
    Some(Coarser {
        matrix: matrix.clone(),
        multigrid: Multigrid { matrix, levels: levels(below), work: Spare::default() },
        place: hierarchy.nodes.place.clone(),
        shift: hierarchy.shift,
        by_row: SparseMatrix::from_parts(prolongator.columns, prolongator.starts, prolongator.indices, values),
        near_null: first.near_null.values.clone(),
    })
}

impl Coarser {
    /// The load of the second level, `P' f`; here and below, the values of the first are in the units of the nodes.
    pub fn load(&self, load: &[f64]) -> Vec<f64> {
        let mut coarse = vec![0.0; self.near_null.len()];
        for (&place, &value) in self.place.iter().zip(load) {
            let value = ldexp(value, self.shift);
            self.by_row.column(place as usize).for_each(|(column, weight)| coarse[column] += weight * value);
        }
        coarse
    }

    /// The bounds of the second level: for each unknown the mean of the bounds of the first-level unknowns that it
    /// reaches, weighted by the fourth power of P, relative to the near-null vector.
    pub fn bounds(&self, bounds: &[Interval]) -> Vec<Interval> {
        let count = self.near_null.len();
        let (mut sums, mut bounded, mut all) = (vec![[0.0; 2]; count], vec![[0.0; 2]; count], vec![0.0; count]);
        for (&place, interval) in self.place.iter().zip(bounds) {
            let carried: f64 =
                self.by_row.column(place as usize).map(|(column, weight)| weight * self.near_null[column]).sum();
            for (column, weight) in self.by_row.column(place as usize) {
                let weight = weight.powi(4);
                all[column] += weight;
                for side in 0..2 {
                    let value = interval[side] / carried;
                    if value.is_finite() {
                        sums[column][side] += weight * value;
                        bounded[column][side] += weight;
                    }
                }
            }
        }
        let of_column = |column: usize| {
            let near_null = self.near_null[column];
            let side = |side: usize, none: f64| match 2.0 * bounded[column][side] > all[column] && near_null > 0.0 {
                true => near_null * sums[column][side] / bounded[column][side],
                false => none,
            };
            let [lower, upper] = [side(0, f64::NEG_INFINITY), side(1, f64::INFINITY)];
            [lower.min(upper), upper]
        };
        (0..count).map(of_column).collect()
    }

    /// The values of the first level, put within `bounds`; a value is put at its bound if most of the values that it is
    /// interpolated from are at theirs.
    pub fn interpolated(&self, coarse: &[f64], coarse_bounds: &[Interval], bounds: &[Interval]) -> Vec<f64> {
        let value_of = |(&place, &[lower, upper]): (&u32, &Interval)| {
            let (mut value, mut all, mut at) = (0.0, 0.0, [0.0; 2]);
            for (column, weight) in self.by_row.column(place as usize) {
                value += weight * coarse[column];
                all += weight.abs();
                for (at, &bound) in at.iter_mut().zip(&coarse_bounds[column]) {
                    *at += if coarse[column] == bound { weight.abs() } else { 0.0 };
                }
            }
            match at.map(|at| at > CLOSED_SHARE * all) {
                [true, _] if lower.is_finite() => lower,
                [_, true] if upper.is_finite() => upper,
                _ => value.min(upper).max(lower),
            }
        };
        self.place.iter().zip(bounds).map(value_of).collect()
    }
}
