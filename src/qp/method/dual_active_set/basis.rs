//! The orthonormal basis of the closed rows: `C_A' = Q R`, updated when a row closes or opens.
//!
//! A row that closes is orthogonalised against Q until it stays the same; a row that opens is taken out by plane
//! rotations. Both cost `O(n k)` for k closed rows.
//!
//! # Source
//! J. W. Daniel, W. B. Gragg, L. Kaufman, G. W. Stewart, 1976, "Reorthogonalization and stable algorithms for updating
//! the Gram-Schmidt QR factorization", Mathematics of Computation 30, pp. 772-795.

use crate::qp::linear::{dot, largest};

/// What is left of a row below this share of it, times the size of its weights, is rounding: the row depends on the
/// closed ones. Any value between 1e-15 and 1e-5 gives the same sets on several thousand random problems.
pub(super) const DEPENDENT: f64 = 64.0 * f64::EPSILON;

/// A remainder that keeps this share of its length is orthogonal to Q to working precision.
const KEPT: f64 = 0.5;

/// Orthogonalisations of one row: two suffice unless the row depends on the others.
const MOST_TURNS: usize = 3;

/// The factors Q (n x k) and R (k x k) of the closed rows, in the order in which they closed.
#[derive(Clone, Debug, Default)]
pub(super) struct Basis {
    rows: Vec<usize>,
    /// The columns of Q.
    directions: Vec<Vec<f64>>,
    /// The columns of R, each down to its diagonal entry.
    triangle: Vec<Vec<f64>>,
}

/// A row c beside a basis: `c = Q along + across`.
#[derive(Clone, Debug)]
pub(super) struct Split {
    along: Vec<f64>,
    /// The part that no closed row has, length n.
    pub across: Vec<f64>,
    /// The weights r of the closed rows for which `C_A' r` is the rest.
    pub weights: Vec<f64>,
    /// Is `across` rounding?
    pub depends: bool,
}

impl Basis {
    /// The closed rows.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// Splits the row `c`, length n.
    pub fn split(&self, c: &[f64]) -> Split {
        let length = norm(c);
        let (mut along, mut across, mut left) = (vec![0.0; self.rows.len()], c.to_vec(), length);
        for _ in 0..MOST_TURNS {
            let turn = self.along(&across);
            self.subtract(&turn, &mut across);
            along.iter_mut().zip(&turn).for_each(|(sum, part)| *sum += part);
            let before = left;
            left = norm(&across);
            if left >= KEPT * before {
                break;
            }
        }
        let weights = self.solve_upper(along.clone());
        let depends = left <= DEPENDENT * (1.0 + largest(&weights)) * length;
        Split { along, across, weights, depends }
    }

    /// Closes `row`, split by this basis.
    pub fn close(&mut self, row: usize, split: Split) {
        let Split { mut along, mut across, .. } = split;
        let length = norm(&across);
        across.iter_mut().for_each(|entry| *entry /= length);
        along.push(length);
        self.rows.push(row);
        self.directions.push(across);
        self.triangle.push(along);
    }

    /// Opens the row at `place` of [`rows`](Self::rows).
    pub fn open(&mut self, place: usize) {
        self.rows.remove(place);
        self.triangle.remove(place);
        // R has one entry below its diagonal from `place` on: each is rotated away.
        for first in place..self.triangle.len() {
            let (a, b) = (self.triangle[first][first], self.triangle[first][first + 1]);
            let length = a.hypot(b);
            let (cosine, sine) = if length > 0.0 { (a / length, b / length) } else { (1.0, 0.0) };
            let turned = |x: f64, y: f64| (cosine * x + sine * y, cosine * y - sine * x);
            for column in &mut self.triangle[first..] {
                (column[first], column[first + 1]) = turned(column[first], column[first + 1]);
            }
            let (left, right) = self.directions.split_at_mut(first + 1);
            for (x, y) in left[first].iter_mut().zip(&mut right[0]) {
                (*x, *y) = turned(*x, *y);
            }
            self.triangle[first].truncate(first + 1);
        }
        self.directions.pop();
    }

    /// The point w (length n) nearest to `target` where each closed row has the value `values`, and the multipliers y of
    /// the closed rows for which `w = target - C_A' y`.
    pub fn nearest(&self, target: &[f64], values: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut excess = self.along(target);
        let wanted = self.solve_lower(values.to_vec());
        excess.iter_mut().zip(&wanted).for_each(|(along, wanted)| *along -= wanted);
        let mut point = target.to_vec();
        self.subtract(&excess, &mut point);
        (point, self.solve_upper(excess))
    }

    /// Q' x.
    pub fn along(&self, x: &[f64]) -> Vec<f64> {
        self.directions.iter().map(|direction| dot(direction, x)).collect()
    }

    fn subtract(&self, shares: &[f64], x: &mut [f64]) {
        for (direction, &share) in self.directions.iter().zip(shares) {
            x.iter_mut().zip(direction).for_each(|(entry, q)| *entry -= share * q);
        }
    }

    /// R^-1 b.
    pub fn solve_upper(&self, mut b: Vec<f64>) -> Vec<f64> {
        for (place, column) in self.triangle.iter().enumerate().rev() {
            b[place] /= column[place];
            let value = b[place];
            b[..place].iter_mut().zip(column).for_each(|(entry, r)| *entry -= r * value);
        }
        b
    }

    /// R'^-1 b.
    fn solve_lower(&self, mut b: Vec<f64>) -> Vec<f64> {
        for (place, column) in self.triangle.iter().enumerate() {
            b[place] = (b[place] - dot(&column[..place], &b[..place])) / column[place];
        }
        b
    }
}

/// The Euclidean length.
pub(super) fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}
