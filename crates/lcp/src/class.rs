//! The class of M, and what its claims rest on. Every decision about a method follows from it.

use std::array::from_fn;

use signorini_qp::{Cholesky, Error as QpError, SparseMatrix, SymmetricMatrix, dot};

use crate::answer::Class;
use crate::dense::Lu;
use crate::error::Error;
use crate::problem::Lcp;
use crate::scaled::{Scaled, diagonal, shares};

/// On a diagonal of order one, a negative eigenvalue above this is rounding of the entries and of the factor.
const LEAST_NEGATIVE: f64 = 1e-12;

/// Largest number of unknowns of which all principal minors are computed.
const MINORS: usize = 16;

/// What the terms of `<A> d` leave, at least, as a share of them.
const MARGIN: f64 = 1e-9;

/// Largest dense comparison matrix, and the multiplications that sweeps over a larger one may take.
const DENSE: usize = 600;
const SWEEPING: usize = 200_000_000;

/// What is known of a matrix.
#[derive(Clone, Debug)]
pub struct Known {
    pub scaled: Scaled,
    pub class: Class,
    /// See the field of the answer.
    pub is_unique: Option<bool>,
    /// A lower bound on the least eigenvalue of (A + A') / 2, if it is positive.
    pub least: Option<f64>,
    /// The factor of (A + A') / 2 with a little more on its diagonal, if that is semidefinite.
    pub factor: Option<Cholesky>,
}

/// A semidefinite matrix: its factor, and a lower bound on its least eigenvalue if it is positive.
struct Semidefinite {
    factor: Cholesky,
    least: Option<f64>,
}

impl Known {
    /// Finds the class of the matrix.
    ///
    /// # Errors
    /// Those of a factorisation for lack of memory.
    pub fn of(lcp: &Lcp) -> Result<Self, Error> {
        let (n, matrix) = (lcp.unknowns(), lcp.matrix());
        let known = |scaled: Scaled, class: Class, found: Option<Semidefinite>| {
            let (factor, least) = found.map_or((None, None), |found| (Some(found.factor), found.least));
            let is_unique = match class {
                _ if least.is_some() => Some(true),
                Class::H | Class::P => Some(true),
                Class::Symmetric if scaled.is_symmetric => Some(false),
                _ => None,
            };
            Known { scaled, class, is_unique, least, factor }
        };
        let mut monotone = None;
        for share in [vec![1.0; n], shares(matrix)] {
            let scaled = Scaled::by_diagonal(lcp, &share);
            if matrix_is_finite(&scaled.matrix) && (scaled.is_alike || monotone.is_none()) {
                match semidefinite(&scaled)? {
                    Some(found) if scaled.is_alike => return Ok(known(scaled, Class::Symmetric, Some(found))),
                    Some(found) => monotone = Some((scaled, Some(found))),
                    None => {}
                }
            }
        }
        let by_entries = Scaled::by_entries(lcp);
        if is_h(&by_entries.matrix) {
            let (scaled, found) = monotone.unwrap_or((by_entries, None));
            return Ok(known(scaled, Class::H, found));
        }
        if let Some((scaled, found)) = monotone {
            return Ok(known(scaled, Class::Monotone, found));
        }
        let class = if n <= MINORS && has_positive_minors(&by_entries.matrix) { Class::P } else { Class::General };
        Ok(known(by_entries, class, None))
    }
}

fn matrix_is_finite(matrix: &SparseMatrix) -> bool {
    matrix.values().iter().all(|value| value.is_finite())
}

/// `None` if (A + A') / 2 is not positive semidefinite to rounding.
///
/// # Source
/// S. M. Rump, *Verification of positive definiteness*, BIT 46 (2006) 433-452: a Cholesky factorisation that ends shows
/// that the least eigenvalue is above -(n + 1) eps trace.
fn semidefinite(scaled: &Scaled) -> Result<Option<Semidefinite>, Error> {
    let (diagonal, ones) = (diagonal(&scaled.matrix), vec![1.0; scaled.offset.len()]);
    let n = diagonal.len() as f64;
    // Beside a zero on its diagonal, a semidefinite matrix has zeros.
    let has_none = |i: usize| diagonal[i] == 0.0;
    let is_coupled = |(i, j, value): (usize, usize, f64)| value != 0.0 && i != j && (has_none(i) || has_none(j));
    if diagonal.iter().any(|&value| value < 0.0)
        || (diagonal.contains(&0.0) && scaled.symmetric_part(0.0)?.lower().triplets().any(is_coupled))
    {
        return Ok(None);
    }
    let Some(factor) = if_definite(&scaled.symmetric_part(LEAST_NEGATIVE.max(8.0 * f64::EPSILON * n))?)? else {
        return Ok(None);
    };
    // Rounding of the factorisation, and of the scaled entries and their means.
    let largest = |sums: Vec<f64>| sums.into_iter().fold(0.0, f64::max);
    let size = (largest(scaled.matrix.mul_abs(&ones)) * largest(scaled.matrix.mul_abs_transposed(&ones))).sqrt();
    let rounding = 1.01 * f64::EPSILON * ((n + 20.0) * diagonal.iter().sum::<f64>() + 4.0 * size);
    let softest = factor.softest_vector();
    let estimate = dot(&softest, &scaled.matrix.mul(&softest)) / dot(&softest, &softest);
    for share in [0.5, 0.05] {
        let least = share * estimate;
        if least > 2.0 * rounding && if_definite(&scaled.symmetric_part(-least)?)?.is_some() {
            return Ok(Some(Semidefinite { factor, least: Some(least - rounding) }));
        }
    }
    Ok(Some(Semidefinite { factor, least: None }))
}

/// The factor of a matrix; `None` if it is not positive definite.
fn if_definite(matrix: &SymmetricMatrix) -> Result<Option<Cholesky>, Error> {
    match Cholesky::of(matrix) {
        Err(QpError::NotConvex { .. }) => Ok(None),
        factor => Ok(Some(factor?)),
    }
}

/// Lower bounds on `<A> d` for the comparison matrix of A, with the rounding of A and of the sums taken off.
pub fn compared(matrix: &SparseMatrix, d: &[f64]) -> Vec<f64> {
    let (mut own, mut others) = (vec![0.0; d.len()], vec![0.0; d.len()]);
    for (i, j, value) in matrix.triplets() {
        let sums = if i == j { &mut own } else { &mut others };
        sums[i] += if i == j { value * d[j] } else { value.abs() * d[j] };
    }
    let rounding = (d.len() + 8) as f64 * f64::EPSILON;
    own.iter().zip(&others).map(|(own, others)| own - others - rounding * (own + others) - f64::MIN_POSITIVE).collect()
}

/// A vector d of positive entries, for which `<A> d` is at least about `right`; `None` if none was found. Only
/// [`compared`] shows that A is an H-matrix. The diagonal is lowered a little, so that `<A> d` stays above the rounding
/// of its terms.
pub fn comparison_solution(matrix: &SparseMatrix, right: &[f64]) -> Option<Vec<f64>> {
    let n = right.len();
    let diagonal: Vec<f64> = diagonal(matrix).iter().map(|value| (1.0 - MARGIN) * value).collect();
    if !matrix_is_finite(matrix) || diagonal.iter().any(|&value| value <= 0.0) {
        return None;
    }
    let is_positive = |d: &[f64]| d.iter().all(|&d| d > 0.0 && d.is_finite());
    if n <= DENSE {
        let mut rows = vec![vec![0.0; n]; n];
        matrix.triplets().for_each(|(i, j, value)| rows[i][j] = if i == j { diagonal[i] } else { -value.abs() });
        return Some(Lu::of(rows)?.solve(right)).filter(|d| is_positive(d));
    }
    let rows = matrix.transposed();
    let mut d = vec![0.0; n];
    for sweep in 0..SWEEPING / matrix.entries().max(1) {
        for i in 0..n {
            let others: f64 = rows.column(i).filter(|entry| entry.0 != i).map(|(j, value)| value.abs() * d[j]).sum();
            d[i] = (right[i] + others) / diagonal[i];
        }
        if !is_positive(&d) {
            return None;
        }
        if sweep % 64 == 0 && compared(matrix, &d).iter().zip(right).all(|(value, right)| *value > 0.5 * right) {
            return Some(d);
        }
    }
    None
}

/// Returns `true` if a vector d > 0 shows that A is an H-matrix with positive diagonal.
fn is_h(matrix: &SparseMatrix) -> bool {
    let found = comparison_solution(matrix, &vec![1.0; matrix.columns()]);
    found.is_some_and(|d| compared(matrix, &d).iter().all(|&value| value > 0.0))
}

/// Returns `true` if all principal minors are positive, in intervals that contain all rounding.
///
/// # Source
/// M. J. Tsatsomeros, L. Li, *A recursive test for P-matrices*, BIT 40 (2000) 410-414: A is P if its first entry is
/// positive, and both the rest of A and its Schur complement are P.
fn has_positive_minors(matrix: &SparseMatrix) -> bool {
    let n = matrix.columns();
    let mut rows = vec![vec![[0.0; 2]; n]; n];
    matrix.triplets().for_each(|(i, j, value)| rows[i][j] = [value; 2]);
    is_p(rows)
}

type Interval = [f64; 2];

fn is_p(mut rows: Vec<Vec<Interval>>) -> bool {
    let Some(first) = rows.pop() else { return true };
    let last = rows.len();
    let pivot = first[last];
    // NaN is refused as well.
    if !(pivot[0] > 0.0 && pivot[1].is_finite()) {
        return false;
    }
    let complement = rows.iter().map(|row| {
        let entry = |j: usize| minus(row[j], over(times(row[last], first[j]), pivot));
        (0..last).map(entry).collect()
    });
    let complement = complement.collect();
    rows.iter_mut().for_each(|row| row.truncate(last));
    is_p(rows) && is_p(complement)
}

fn outward(ends: Interval) -> Interval {
    [ends[0].next_down(), ends[1].next_up()]
}

fn minus(a: Interval, b: Interval) -> Interval {
    if b == [0.0; 2] { a } else { outward([a[0] - b[1], a[1] - b[0]]) }
}

fn times(a: Interval, b: Interval) -> Interval {
    let products: [f64; 4] = from_fn(|k| a[k / 2] * b[k % 2]);
    let ends = products.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |ends, &p| [ends[0].min(p), ends[1].max(p)]);
    match products.iter().any(|product| product.is_nan()) {
        true => [f64::NEG_INFINITY, f64::INFINITY],
        false if a == [0.0; 2] || b == [0.0; 2] => [0.0; 2],
        false => outward(ends),
    }
}

/// The quotient by an interval of positive numbers.
fn over(a: Interval, b: Interval) -> Interval {
    let low = if a[0] < 0.0 { a[0] / b[0] } else { a[0] / b[1] };
    let high = if a[1] < 0.0 { a[1] / b[1] } else { a[1] / b[0] };
    if a == [0.0; 2] { a } else { outward([low, high]) }
}
