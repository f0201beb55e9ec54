//! The orthonormal basis of the closed rows: `C_A' = Q R`, updated when a row closes or opens.
//!
//! A row that closes is orthogonalised against Q until it stays the same; a row that opens is removed by plane
//! rotations. Both cost `O(n k)` for k closed rows.
//!
//! # Source
//! J. W. Daniel, W. B. Gragg, L. Kaufman, G. W. Stewart, 1976, "Reorthogonalization and stable algorithms for updating
//! the Gram-Schmidt QR factorization", Mathematics of Computation 30, pp. 772-795.

use crate::linear::{UpperTriangle, dot, largest, norm, subtract, turned};
use crate::solution::ContactSet;

/// A row depends on the closed ones if its remainder is below this share of the row, times the size of its weights: the
/// remainder is then rounding. Any value between 1e-15 and 1e-5 gives the same sets on several thousand random
/// problems.
pub(super) const DEPENDENT_ROW: f64 = 64.0 * f64::EPSILON;

/// A remainder that keeps this share of its length is orthogonal to Q to working precision.
const ORTHOGONAL_SHARE: f64 = 0.5;

/// Largest number of orthogonalisations of one row: two suffice unless the row depends on the others.
const MOST_TURNS: usize = 3;

/// The factors Q (n x k) and R (k x k) of the closed rows, in the order in which they closed.
#[derive(Clone, Debug, Default)]
pub(super) struct Basis {
    rows: Vec<usize>,
    /// The columns of Q.
    directions: Vec<Vec<f64>>,
    /// R.
    triangle: UpperTriangle,
}

/// A row c split by a basis: `c = Q along + across`.
#[derive(Clone, Debug)]
pub(super) struct Split {
    along: Vec<f64>,
    /// The component orthogonal to the closed rows, length n.
    pub across: Vec<f64>,
    /// The weights r of the closed rows that give the rest as `C_A' r`.
    pub weights: Vec<f64>,
    /// `true` if `across` is rounding.
    pub depends: bool,
}

impl Basis {
    /// The closed rows, in the order in which they entered the basis.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// The closed rows as a set, `rows` being the number of all rows.
    pub fn set(&self, rows: usize) -> ContactSet {
        let mut closed = ContactSet::open(rows);
        self.rows.iter().for_each(|&row| closed.insert(row));
        closed
    }

    /// Splits the row `c`, length n.
    pub fn split(&self, c: &[f64]) -> Split {
        let length = norm(c);
        let (mut along, mut across, mut left) = (vec![0.0; self.rows.len()], c.to_vec(), length);
        for _ in 0..MOST_TURNS {
            let turn = self.along(&across);
            self.take_out(&turn, &mut across);
            along.iter_mut().zip(&turn).for_each(|(sum, part)| *sum += part);
            let before = left;
            left = norm(&across);
            if left >= ORTHOGONAL_SHARE * before {
                break;
            }
        }
        let weights = self.triangle.solve_upper(along.clone());
        let depends = left <= DEPENDENT_ROW * (1.0 + largest(&weights)) * length;
        Split { along, across, weights, depends }
    }

    /// Closes `row`, split by this basis.
    pub fn close(&mut self, row: usize, split: Split) {
        let Split { along, mut across, .. } = split;
        let length = norm(&across);
        across.iter_mut().for_each(|entry| *entry /= length);
        self.rows.push(row);
        self.directions.push(across);
        self.triangle.push(along, length);
    }

    /// Opens the row at `place` of [`rows`](Self::rows).
    pub fn open(&mut self, place: usize) {
        self.rows.remove(place);
        let directions = &mut self.directions;
        self.triangle.remove(place, |first, cosine, sine| {
            let (left, right) = directions.split_at_mut(first + 1);
            for (x, y) in left[first].iter_mut().zip(&mut right[0]) {
                (*x, *y) = turned(cosine, sine, *x, *y);
            }
        });
        self.directions.pop();
    }

    /// The point w (length n) nearest to `target` at which each closed row has its value in `values`, and the
    /// multipliers y of the closed rows with `w = target - C_A' y`.
    pub fn nearest(&self, target: &[f64], values: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut excess = self.along(target);
        let wanted = self.triangle.solve_lower(values.to_vec());
        excess.iter_mut().zip(&wanted).for_each(|(along, wanted)| *along -= wanted);
        let mut point = target.to_vec();
        self.take_out(&excess, &mut point);
        (point, self.triangle.solve_upper(excess))
    }

    /// Q' x.
    pub fn along(&self, x: &[f64]) -> Vec<f64> {
        self.directions.iter().map(|direction| dot(direction, x)).collect()
    }

    fn take_out(&self, shares: &[f64], x: &mut [f64]) {
        for (direction, &share) in self.directions.iter().zip(shares) {
            subtract(x, share, direction);
        }
    }

    /// R^-1 b.
    pub fn solve_upper(&self, b: Vec<f64>) -> Vec<f64> {
        self.triangle.solve_upper(b)
    }
}
