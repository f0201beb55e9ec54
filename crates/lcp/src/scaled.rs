//! Rows and unknowns in units of their own: A = R M C with diagonal R and C. A row may be multiplied by any positive
//! number, because only the sign of w matters; so M need not keep its symmetry by chance of its units.

use signorini_qp::{LinearError, SparseMatrix, SymmetricMatrix};

use crate::problem::Lcp;

/// Sweeps of the fit of scales to the logarithms of the entries.
const SWEEPS: usize = 150;

/// Mirrored entries that differ by less than this share count as equal for a method, though not for a claim.
const ALIKE: f64 = 1e-12;

/// A problem in scaled units: z = C x, R w = A x + R q.
#[derive(Clone, Debug)]
pub struct Scaled {
    pub matrix: SparseMatrix,
    pub offset: Vec<f64>,
    pub lower: Vec<f64>,
    pub upper: Vec<f64>,
    /// The diagonals of R and C; those of C are powers of two.
    pub row: Vec<f64>,
    pub column: Vec<f64>,
    /// The unknowns that are multipliers, if the problem is that of a quadratic program: those without a diagonal
    /// entry, if A is symmetric to rounding once their rows change sign.
    pub multipliers: Option<Vec<bool>>,
    /// `true` if A is symmetric to rounding.
    pub is_alike: bool,
    /// `true` if all scales are powers of two: then A has no rounding.
    pub is_exact: bool,
    /// `true` if it is so, and A is symmetric.
    pub is_symmetric: bool,
}

/// The power of two that is nearest to 2^exponent, far within the range of doubles.
fn power(exponent: f64) -> f64 {
    exponent.round().clamp(-300.0, 300.0).exp2()
}

/// The diagonal of a square matrix.
pub fn diagonal(matrix: &SparseMatrix) -> Vec<f64> {
    let mut diagonal = vec![0.0; matrix.columns()];
    matrix.triplets().filter(|entry| entry.0 == entry.1).for_each(|(i, _, value)| diagonal[i] = value);
    diagonal
}

/// The largest share by which mirrored entries differ once the rows of multipliers change sign; infinite if one of them
/// is zero, or not finite, or couples two multipliers.
fn apart(matrix: &SparseMatrix, is_multiplier: &[bool]) -> f64 {
    let mirrored = matrix.transposed();
    let entries = matrix.triplets().filter(|entry| entry.2 != 0.0);
    let pairs = entries.zip(mirrored.triplets().filter(|entry| entry.2 != 0.0));
    let share = |((i, j, a), (k, l, b)): ((usize, usize, f64), (usize, usize, f64))| {
        let b = if is_multiplier[i] == is_multiplier[j] { b } else { -b };
        let is_pair = (i, j) == (k, l) && a.is_finite() && !(is_multiplier[i] && is_multiplier[j]);
        if is_pair { (a - b).abs() / a.abs() } else { f64::INFINITY }
    };
    pairs.map(share).fold(0.0, f64::max)
}

fn is_power(value: f64) -> bool {
    value.to_bits() & ((1 << 52) - 1) == 0
}

impl Scaled {
    pub fn new(lcp: &Lcp, row: Vec<f64>, column: Vec<f64>) -> Self {
        let matrix = lcp.matrix().scaled(&row, &column);
        let is_empty = |j: usize| matrix.column(j).all(|entry| entry.1 == 0.0);
        let own = diagonal(&matrix);
        let is_multiplier: Vec<bool> = (0..own.len()).map(|j| own[j] == 0.0 && !is_empty(j)).collect();
        let apart = apart(&matrix, &is_multiplier);
        let is_plain =
            |i: usize| lcp.upper()[i].is_infinite() && (lcp.lower()[i] == 0.0 || lcp.lower()[i].is_infinite());
        let is_program = apart <= ALIKE && (0..own.len()).all(|i| !is_multiplier[i] || is_plain(i));
        let is_kept = |(a, m): (&f64, &f64)| *m == 0.0 || a.is_normal();
        let is_exact = row.iter().chain(&column).all(|&scale| is_power(scale))
            && matrix.values().iter().zip(lcp.matrix().values()).all(is_kept);
        let is_alike = apart <= ALIKE && !is_multiplier.contains(&true);
        let (is_symmetric, multipliers) = (is_alike && is_exact && apart == 0.0, is_program.then_some(is_multiplier));
        let times = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).collect();
        let over = |bounds: &[f64]| bounds.iter().zip(&column).map(|(bound, unit)| bound / unit).collect();
        let (offset, lower, upper) = (times(lcp.offset(), &row), over(lcp.lower()), over(lcp.upper()));
        Scaled { matrix, offset, lower, upper, row, column, multipliers, is_alike, is_exact, is_symmetric }
    }

    /// Unit diagonals after each row was multiplied by its share.
    pub fn by_diagonal(lcp: &Lcp, share: &[f64]) -> Self {
        let matrix = lcp.matrix();
        let of_own =
            |own: f64, share: f64| if own == 0.0 { 0.0 } else { power(-0.5 * (share.log2() + own.abs().log2())) };
        let mut unit: Vec<f64> = diagonal(matrix).iter().zip(share).map(|(own, share)| of_own(*own, *share)).collect();
        if unit.contains(&0.0) {
            let [row, column] = fit(matrix, share);
            let means = row.iter().zip(&column).map(|(row, column)| power(0.5 * (row + column)));
            unit.iter_mut().zip(means).filter(|entry| *entry.0 == 0.0).for_each(|(unit, mean)| *unit = mean);
        }
        let row = unit.iter().zip(share).map(|(unit, share)| unit * share).collect();
        Scaled::new(lcp, row, unit)
    }

    /// Entries of order one in all rows and columns.
    pub fn by_entries(lcp: &Lcp) -> Self {
        let powers = |exponents: Vec<f64>| exponents.into_iter().map(power).collect();
        let [row, column] = fit(lcp.matrix(), &vec![1.0; lcp.unknowns()]).map(powers);
        Scaled::new(lcp, row, column)
    }

    /// The symmetric part (A + A') / 2, with this number added to its diagonal.
    pub fn symmetric_part(&self, shift: f64) -> Result<SymmetricMatrix, LinearError> {
        let n = self.offset.len();
        let half = |(i, j, value): (usize, usize, f64)| (i.max(j), i.min(j), if i == j { value } else { 0.5 * value });
        let mut entries: Vec<_> = match self.is_symmetric {
            true => self.matrix.triplets().filter(|entry| entry.0 >= entry.1).collect(),
            false => self.matrix.triplets().map(half).collect(),
        };
        if shift != 0.0 {
            entries.extend((0..n).map(|i| (i, i, shift)));
        }
        SymmetricMatrix::from_lower(SparseMatrix::from_triplets(n, n, &entries)?)
    }
}

/// Exponents of rows and columns for entries of order one, after each row was multiplied by its share: the least
/// squares of their logarithms, nearly.
///
/// # Source
/// A. R. Curtis, J. K. Reid, *On the automatic scaling of matrices for Gaussian elimination*, IMA J. Appl. Math. 10
/// (1972) 118-124.
fn fit(matrix: &SparseMatrix, share: &[f64]) -> [Vec<f64>; 2] {
    let entries = matrix.triplets().filter(|entry| entry.2 != 0.0);
    let sizes: Vec<_> = entries.map(|(i, j, value)| (i, j, share[i].log2() + value.abs().log2())).collect();
    let (mut row, mut column) = (vec![0.0; share.len()], vec![0.0; share.len()]);
    for _ in 0..SWEEPS {
        let mut means = vec![[(0.0, 0.0); 2]; share.len()];
        for &(i, j, size) in &sizes {
            means[i][0] = (means[i][0].0 - size - column[j], means[i][0].1 + 1.0);
            means[j][1] = (means[j][1].0 - size - row[i], means[j][1].1 + 1.0);
        }
        let halfway = |old: f64, (sum, count): (f64, f64)| if count > 0.0 { 0.5 * (old + sum / count) } else { old };
        for (i, [of_row, of_column]) in means.into_iter().enumerate() {
            (row[i], column[i]) = (halfway(row[i], of_row), halfway(column[i], of_column));
        }
    }
    [row, column]
}

/// Shares of the rows of M that make mirrored entries equal in magnitude, as far as one walk over its graph finds them:
/// of M = D S with a symmetric S the inverse of D, up to a factor for each component.
pub fn shares(matrix: &SparseMatrix) -> Vec<f64> {
    let mirrored = matrix.transposed();
    let mut share = vec![0.0; matrix.columns()];
    for root in 0..share.len() {
        if share[root] != 0.0 {
            continue;
        }
        share[root] = 1.0;
        let mut found = vec![root];
        while let Some(j) = found.pop() {
            let mut row = mirrored.column(j).peekable();
            for (i, below) in matrix.column(j).filter(|entry| entry.1 != 0.0) {
                while row.next_if(|entry| entry.0 < i).is_some() {}
                let Some(&(_, beside)) = row.peek().filter(|entry| entry.0 == i && entry.1 != 0.0) else { continue };
                let of_other = share[j] * (beside / below).abs();
                if share[i] == 0.0 && of_other.is_normal() {
                    share[i] = of_other;
                    found.push(i);
                }
            }
        }
    }
    share
}
