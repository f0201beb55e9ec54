//! The complementarity problem, checked once.

use signorini_qp::{LinearError, SparseMatrix};

use crate::error::Error;

/// Bounds from this magnitude on are infinite, as gaps are.
const INFINITE: f64 = 1e20;

/// A linear complementarity problem with bounds: find z between l and u so that w = M z + q has `w_i >= 0` if
/// `z_i = l_i`, `w_i <= 0` if `z_i = u_i`, and `w_i = 0` between them.
///
/// ```
/// use signorini_lcp::{Lcp, solve_lcp};
/// use signorini_qp::{Settings, SparseMatrix};
///
/// // z >= 0, w = [2 1; 1 2] z + (-4, 1) >= 0, z'w = 0.
/// let matrix = SparseMatrix::from_triplets(2, 2, &[(0, 0, 2.0), (0, 1, 1.0), (1, 0, 1.0), (1, 1, 2.0)])?;
/// let solution = solve_lcp(&Lcp::nonnegative(matrix, vec![-4.0, 1.0])?, &Settings::default())?;
/// assert_eq!((solution.z, solution.w), (vec![2.0, 0.0], vec![0.0, 3.0]));
/// # Ok::<(), signorini_lcp::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Lcp {
    matrix: SparseMatrix,
    offset: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
}

impl Lcp {
    /// The problem of M (n x n, any real matrix, both triangles), q (length n, in units of w), and bounds l and u
    /// (length n, in units of z); a bound of magnitude 1e20 or more is infinite.
    ///
    /// # Errors
    /// [`Error::Qp`] with `Shape` or `Length` for sizes that do not fit and `NotFinite` for a matrix or an offset that
    /// is not finite or a bound that is NaN; [`Error::Bounds`] for l > u, `l = +inf` or `u = -inf`.
    pub fn new(matrix: SparseMatrix, offset: Vec<f64>, lower: Vec<f64>, upper: Vec<f64>) -> Result<Self, Error> {
        let n = offset.len();
        if (matrix.rows(), matrix.columns()) != (n, n) {
            let found = (matrix.rows(), matrix.columns());
            return Err(LinearError::Shape { name: "matrix M of the LCP", found, expected: (n, n) }.into());
        }
        if let Some((i, j, value)) = matrix.triplets().find(|entry| !entry.2.is_finite()) {
            let (name, at, allowed) = ("matrix M of the LCP", format!("({i}, {j})"), "finite");
            return Err(LinearError::NotFinite { name, at, value, allowed }.into());
        }
        let check = |name, values: &[f64], is_allowed: fn(f64) -> bool, allowed| -> Result<(), LinearError> {
            LinearError::check_length(name, values.len(), n, "rows of M")?;
            let wrong = values.iter().enumerate().find(|entry| !is_allowed(*entry.1));
            wrong
                .map_or(Ok(()), |(at, &value)| Err(LinearError::NotFinite { name, at: at.to_string(), value, allowed }))
        };
        check("offset q", &offset, f64::is_finite, "finite")?;
        check("lower bound", &lower, |value| !value.is_nan(), "a number or infinite")?;
        check("upper bound", &upper, |value| !value.is_nan(), "a number or infinite")?;
        if let Some(index) = (0..n).find(|&i| lower[i] > upper[i] || lower[i] >= INFINITE || upper[i] <= -INFINITE) {
            return Err(Error::Bounds { index, lower: lower[index], upper: upper[index] });
        }
        let bound = |values: Vec<f64>| -> Vec<f64> {
            let infinite = |value: f64| if value.abs() >= INFINITE { f64::INFINITY.copysign(value) } else { value };
            values.into_iter().map(infinite).collect()
        };
        Ok(Lcp { matrix, offset, lower: bound(lower), upper: bound(upper) })
    }

    /// The problem without upper bounds: `z >= 0`, `w = M z + q >= 0`, `z'w = 0`, with q of length n in units of w.
    ///
    /// # Errors
    /// As [`Lcp::new`].
    pub fn nonnegative(matrix: SparseMatrix, offset: Vec<f64>) -> Result<Self, Error> {
        let n = offset.len();
        Self::new(matrix, offset, vec![0.0; n], vec![f64::INFINITY; n])
    }

    /// Number of unknowns n.
    pub fn unknowns(&self) -> usize {
        self.offset.len()
    }

    /// The matrix M, n x n.
    pub fn matrix(&self) -> &SparseMatrix {
        &self.matrix
    }

    /// The offset q, length n, in units of w.
    pub fn offset(&self) -> &[f64] {
        &self.offset
    }

    /// The lower bounds l, length n, in units of z; `-inf` if there is none.
    pub fn lower(&self) -> &[f64] {
        &self.lower
    }

    /// The upper bounds u, length n, in units of z; `+inf` if there is none.
    pub fn upper(&self) -> &[f64] {
        &self.upper
    }

    /// w = M z + q, summed with twice the working precision, its terms t = |q| + |M| |z|, and a bound on the rounding
    /// of each entry of w.
    pub(crate) fn image(&self, z: &[f64]) -> [Vec<f64>; 3] {
        let w = self.matrix.mul_added(z, &self.offset);
        let mut terms = self.matrix.mul_abs(z);
        terms.iter_mut().zip(&self.offset).for_each(|(terms, q)| *terms += q.abs());
        // Ogita, Rump, Oishi (2005), Proposition 4.5; products that underflow lose less than the smallest double each.
        let many = (self.unknowns() + 4) as f64;
        let share = (many * f64::EPSILON).powi(2);
        let bound =
            |(w, terms): (&f64, &f64)| 2.0 * (f64::EPSILON * w.abs() + share * terms + many * f64::MIN_POSITIVE);
        let rounding = w.iter().zip(&terms).map(bound).collect();
        [w, terms, rounding]
    }
}
