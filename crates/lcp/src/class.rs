//! The class of M, and what its claims rest on. Every decision about a method follows from it.

use signorini_qp::{Cholesky, LinearError, SparseMatrix, SymmetricMatrix, dot};

use crate::answer::Class;
use crate::error::Error;
use crate::exact::is_definite;
use crate::lu::Lu;
use crate::problem::Lcp;
use crate::scaled::{Scaled, diagonal, shares};

/// On a diagonal of order one, a negative eigenvalue above this is rounding of the entries and of the factor.
const LEAST_NEGATIVE: f64 = 1e-12;

/// Largest number of unknowns of which all principal minors are computed.
const MINORS: usize = 16;

/// What the terms of `<A> d` leave, at least, as a share of them.
const MARGIN: f64 = 1e-9;

/// Largest matrix that is tried in integers.
pub const SMALL: usize = 64;

/// Most entries of the factors of a comparison matrix that is not symmetric.
const ENTRIES: f64 = 4e6;

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
    /// Where the comparison matrix of A is taken, if in other units.
    compared: Option<Scaled>,
}

impl Known {
    /// Finds the class of the matrix.
    ///
    /// # Errors
    /// Those of a factorisation for lack of memory.
    pub fn of(lcp: &Lcp) -> Result<Self, Error> {
        let (n, matrix) = (lcp.unknowns(), lcp.matrix());
        let mut monotone = None;
        for is_shared in [false, true] {
            let share = if is_shared { shares(matrix) } else { vec![1.0; n] };
            let scaled = Scaled::by_diagonal(lcp, &share);
            if (scaled.is_alike || monotone.is_none())
                && let Some((factor, least)) = semidefinite(&scaled)?
            {
                let is_unique = if least.is_some() { Some(true) } else { proven(&scaled, &factor) };
                if scaled.is_alike {
                    let compared = (!scaled.is_symmetric).then(|| Scaled::by_entries(lcp));
                    let is_unique = is_unique.filter(|&one| one || scaled.is_symmetric);
                    let is_given = scaled.is_symmetric && !is_shared;
                    let class = if is_given { Class::Symmetric } else { Class::Symmetrizable };
                    return Ok(Known { scaled, class, is_unique, least, factor: Some(factor), compared });
                }
                monotone = Some((scaled, is_unique, Some(factor), least));
            }
        }
        let by_entries = Scaled::by_entries(lcp);
        let class = if comparison_solution(&by_entries.matrix, by_entries.is_alike, &vec![1.0; n]).is_some() {
            Class::H
        } else if monotone.is_some() {
            Class::Monotone
        } else if n <= MINORS && has_positive_minors(&by_entries.matrix) {
            Class::P
        } else {
            Class::General
        };
        let is_p = [Class::H, Class::P].contains(&class) || monotone.as_ref().is_some_and(|one| one.1 == Some(true));
        let (is_unique, compared) = (is_p.then_some(true), monotone.is_some().then(|| by_entries.clone()));
        let (scaled, _, factor, least) = monotone.unwrap_or((by_entries, None, None, None));
        Ok(Known { scaled, class, is_unique, least, factor, compared })
    }

    /// Where bounds by the comparison matrix are computed.
    pub fn units(&self) -> &Scaled {
        self.compared.as_ref().unwrap_or(&self.scaled)
    }

    /// Vectors d and `<A> d` of positive entries, rounding taken off, the second about as large as `right` if possible;
    /// both in these units.
    pub fn comparison(&self, right: &[f64]) -> Option<[Vec<f64>; 2]> {
        let solution = |right: &[f64]| comparison_solution(&self.units().matrix, self.units().is_alike, right);
        solution(right).or_else(|| solution(&vec![1.0; right.len()]))
    }
}

/// `Some(true)` if A + A' is shown to be definite, `Some(false)` if semidefinite, without any rounding: in integers, or
/// by the comparison matrix of what is left of a symmetric A without the copies of its columns.
fn proven(scaled: &Scaled, factor: &Cholesky) -> Option<bool> {
    let (n, matrix) = (scaled.offset.len(), &scaled.matrix);
    if !scaled.is_exact {
        return None;
    }
    let in_integers = if n <= SMALL { is_definite(&dense(matrix)) } else { None };
    if in_integers.is_some() || !scaled.is_symmetric {
        return in_integers;
    }
    let own = diagonal(matrix);
    let is_like = |i: usize, j: usize| own[i] == own[j] && matrix.column(i).eq(matrix.column(j));
    let first = |j: usize| matrix.column(j).find(|&(i, value)| i >= j || (value == own[j] && is_like(i, j)));
    let first: Vec<usize> = (0..n).map(|j| first(j).map_or(j, |entry| entry.0.min(j))).collect();
    let mut d: Vec<f64> = first.iter().enumerate().map(|(j, &first)| if first == j { 0.0 } else { 1.0 }).collect();
    first.iter().zip(factor.solve(&vec![1.0; n])).for_each(|(&first, x)| d[first] += x);
    let left = matrix.triplets().filter(|&(i, j, _)| i == j || (first[i] == i && first[j] == j));
    comparison_bounds(left, &d).map(|_| first.into_iter().eq(0..n))
}

/// The rows of a small matrix.
pub fn dense(matrix: &SparseMatrix) -> Vec<Vec<f64>> {
    let mut rows = vec![vec![0.0; matrix.columns()]; matrix.rows()];
    matrix.triplets().for_each(|(i, j, value)| rows[i][j] = value);
    rows
}

/// `None` if (A + A') / 2 is not positive semidefinite to rounding.
///
/// # Source
/// S. M. Rump, *Verification of positive definiteness*, BIT 46 (2006) 433-452: a Cholesky factorisation that ends shows
/// that the least eigenvalue is above -(n + 1) eps trace.
fn semidefinite(scaled: &Scaled) -> Result<Option<(Cholesky, Option<f64>)>, Error> {
    let (diagonal, ones) = (diagonal(&scaled.matrix), vec![1.0; scaled.offset.len()]);
    let n = diagonal.len() as f64;
    // Beside a zero on its diagonal, a semidefinite matrix has zeros.
    let has_none = |i: usize| diagonal[i] == 0.0;
    let is_coupled = |(i, j, value): (usize, usize, f64)| value != 0.0 && i != j && (has_none(i) || has_none(j));
    if diagonal.iter().any(|&value| value < 0.0)
        || scaled.matrix.values().iter().any(|value| !value.is_finite())
        || (diagonal.contains(&0.0) && scaled.symmetric_part(0.0)?.lower().triplets().any(is_coupled))
    {
        return Ok(None);
    }
    let shift = LEAST_NEGATIVE.max(2.0 * f64::EPSILON * n);
    let Some(factor) = if_definite(&scaled.symmetric_part(shift)?)? else { return Ok(None) };
    // Rounding of the factorisation, and of the scaled entries and their means.
    let largest = |sums: Vec<f64>| sums.into_iter().fold(0.0, f64::max);
    let size = (largest(scaled.matrix.mul_abs(&ones)) * largest(scaled.matrix.mul_abs_transposed(&ones))).sqrt();
    let rounding = 1.01 * f64::EPSILON * ((n + 20.0) * diagonal.iter().sum::<f64>() + 4.0 * size);
    // No pivot lies below the least eigenvalue.
    if factor.smallest_pivot() > 2.0 * rounding {
        let softest = factor.softest_vector();
        let estimate = dot(&softest, &scaled.matrix.mul(&softest)) / dot(&softest, &softest);
        for least in [0.5 * estimate, 0.05 * estimate] {
            if least > 2.0 * rounding && if_definite(&scaled.symmetric_part(-least)?)?.is_some() {
                return Ok(Some((factor, Some(least - rounding))));
            }
        }
    }
    Ok(Some((factor, None)))
}

/// The factor of a matrix; `None` if it is not positive definite.
///
/// # Errors
/// Those of a factorisation for lack of memory.
pub fn if_definite(matrix: &SymmetricMatrix) -> Result<Option<Cholesky>, Error> {
    match Cholesky::of(matrix) {
        Err(LinearError::NotConvex { .. }) => Ok(None),
        factor => Ok(Some(factor?)),
    }
}

/// A vector d of positive entries with `<A> d` of about `right`, and positive lower bounds on `<A> d`, rounding taken
/// off: they show that A is an H-matrix with positive diagonal. `None` if none was found. The diagonal is lowered a
/// little, so that `<A> d` stays above the rounding of its terms.
fn comparison_solution(matrix: &SparseMatrix, is_alike: bool, right: &[f64]) -> Option<[Vec<f64>; 2]> {
    let n = right.len();
    let entry = |i: usize, j: usize, value: f64| if i == j { (1.0 - MARGIN) * value } else { -value.abs() };
    let d = if is_alike {
        let below = matrix.triplets().filter(|&(i, j, _)| i >= j).map(|(i, j, value)| (i, j, entry(i, j, value)));
        let below = SparseMatrix::from_triplets(n, n, &below.collect::<Vec<_>>()).ok()?;
        Cholesky::of(&SymmetricMatrix::from_lower(below).ok()?).ok()?.solve(right)
    } else {
        let entries: Vec<_> = matrix.triplets().map(|(i, j, value)| (j, i, entry(i, j, value))).collect();
        Lu::of_transposed(&SparseMatrix::from_triplets(n, n, &entries).ok()?, ENTRIES)?.solve(right)
    };
    comparison_bounds(matrix.triplets(), &d).map(|bounds| [d, bounds])
}

/// Positive lower bounds on `<A> d`, rounding taken off, if d is positive and there are such.
fn comparison_bounds(entries: impl Iterator<Item = (usize, usize, f64)>, d: &[f64]) -> Option<Vec<f64>> {
    let mut sums = vec![[0.0; 2]; d.len()];
    entries.for_each(|(i, j, value)| sums[i][usize::from(i != j)] += if i == j { value } else { value.abs() } * d[j]);
    let rounding = (d.len() + 8) as f64 * f64::EPSILON;
    let bound = |[own, others]: [f64; 2]| own - others - rounding * (own + others) - f64::MIN_POSITIVE;
    let bounds: Vec<f64> = sums.into_iter().map(bound).collect();
    let is_positive = |value: &f64| *value > 0.0 && value.is_finite();
    (d.iter().all(is_positive) && bounds.iter().all(is_positive)).then_some(bounds)
}

/// Returns `true` if all principal minors are positive, with bounds on all rounding.
///
/// # Source
/// M. J. Tsatsomeros, L. Li, *A recursive test for P-matrices*, BIT 40 (2000) 410-414: A is P if its first entry is
/// positive, and both the rest of A and its Schur complement are P.
fn has_positive_minors(matrix: &SparseMatrix) -> bool {
    let n = matrix.columns();
    let mut rows = vec![vec![(0.0, 0.0); n]; n];
    matrix.triplets().for_each(|(i, j, value)| rows[i][j] = (value, 0.0));
    is_p(rows)
}

/// The same of entries with bounds on their errors.
fn is_p(mut rows: Vec<Vec<(f64, f64)>>) -> bool {
    let Some(first) = rows.pop() else { return true };
    let last = rows.len();
    let (pivot, off) = first[last];
    let least = pivot - off;
    // NaN is refused as well.
    if !(least > 0.0 && pivot.is_finite()) {
        return false;
    }
    let complement = rows.iter().map(|row| {
        let entry = |j: usize| {
            let ((a, of_a), (b, of_b), (c, of_c)) = (row[j], row[last], first[j]);
            let share = b * c / pivot;
            let moved = b.abs() * of_c + (c.abs() + of_c) * of_b + share.abs() * off + f64::MIN_POSITIVE;
            let rounding = 4.0 * f64::EPSILON * (a.abs() + share.abs());
            (a - share, (of_a + moved / least + rounding) * (1.0 + 1e-12))
        };
        (0..last).map(entry).collect()
    });
    let complement = complement.collect();
    rows.iter_mut().for_each(|row| row.truncate(last));
    is_p(rows) && is_p(complement)
}
