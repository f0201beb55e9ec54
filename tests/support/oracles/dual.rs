//! A slow and simple solver for hundreds of rows: the dual problem `w = A x + q`, `w >= 0`, `x >= 0`, `w'x = 0` in the
//! multipliers `x = -lambda`, with `A = B K^-1 B'` and `q = g - B K^-1 f` as full matrices.

use nalgebra::{DMatrix, DVector};

use super::{Dense, Enumerated};

/// Number of sweeps of projected Gauss-Seidel in which the set of pressing rows must not change.
const STAYS: usize = 20;

/// Largest number of sweeps; exchanges of single rows correct the set that they reach.
const MOST_SWEEPS: usize = 400;

/// A wrong sign of a smaller value, relative to the largest, is rounding; exchanging its row could go on without end.
const ROUNDING: f64 = 1e-13;

impl Dense {
    /// Displacement and multipliers of a problem with definite stiffness and linearly independent rows.
    ///
    /// Projected Gauss-Seidel guesses the set. Then the first row whose sign is wrong changes sides, one row at a time;
    /// this ends for every P-matrix (K. G. Murty, *Note on a Bard-type scheme for solving the complementarity problem*,
    /// 1974).
    pub fn dual(&self) -> Enumerated {
        let m = self.gap.len();
        let rows: Vec<Vec<(usize, f64)>> = (0..m)
            .map(|row| self.contact.row(row).iter().copied().enumerate().filter(|entry| entry.1 != 0.0).collect())
            .collect();
        let apply = |row: usize, u: &[f64]| rows[row].iter().map(|&(dof, value)| value * u[dof]).sum::<f64>();
        let factor = Envelope::factor(&self.stiffness);
        let free = factor.solve(self.load.as_slice().to_vec());
        let motions: Vec<Vec<f64>> =
            (0..m).map(|row| factor.solve(self.contact.row(row).iter().copied().collect())).collect();
        let matrix = DMatrix::from_fn(m, m, |row, column| apply(row, &motions[column]));
        let q = DVector::from_fn(m, |row, _| self.gap[row] - apply(row, &free));
        let closed = exchange(&matrix, &q, guess(&matrix, &q));
        let x = forces(&matrix, &q, &closed);
        let mut displacement = DVector::from_vec(free);
        for &row in &closed {
            displacement.axpy(-x[row], &DVector::from_column_slice(&motions[row]), 1.0);
        }
        Enumerated { displacement, multiplier: -x, closed }
    }
}

/// The rows with a force after projected Gauss-Seidel.
fn guess(matrix: &DMatrix<f64>, q: &DVector<f64>) -> Vec<usize> {
    let m = q.len();
    let (mut x, mut closed, mut stayed) = (DVector::zeros(m), Vec::new(), 0);
    for _ in 0..MOST_SWEEPS {
        for row in 0..m {
            let distance: f64 = q[row] + matrix.column(row).dot(&x);
            x[row] = f64::max(0.0, x[row] - distance / matrix[(row, row)]);
        }
        let pressing: Vec<usize> = (0..m).filter(|&row| x[row] > 0.0).collect();
        stayed = if pressing == closed { stayed + 1 } else { 0 };
        closed = pressing;
        if stayed == STAYS {
            break;
        }
    }
    closed
}

/// The closed set for which all signs are right.
fn exchange(matrix: &DMatrix<f64>, q: &DVector<f64>, mut closed: Vec<usize>) -> Vec<usize> {
    loop {
        let x = forces(matrix, q, &closed);
        let w = matrix * &x + q;
        let (strongest, farthest) = (x.amax(), q.amax());
        let wrong = (0..q.len()).find(|row| match closed.contains(row) {
            true => x[*row] < -ROUNDING * strongest,
            false => w[*row] < -ROUNDING * farthest,
        });
        let Some(wrong) = wrong else { return closed };
        match closed.binary_search(&wrong) {
            Ok(place) => drop(closed.remove(place)),
            Err(place) => closed.insert(place, wrong),
        }
    }
}

/// The unknowns x, with the rows of `closed` at their gaps and zero for all other rows.
fn forces(matrix: &DMatrix<f64>, q: &DVector<f64>, closed: &[usize]) -> DVector<f64> {
    let inner = matrix.select_rows(closed).select_columns(closed);
    let right = -q.select_rows(closed);
    let mut x = DVector::zeros(q.len());
    let found = inner.cholesky().expect("rows are independent").solve(&right);
    closed.iter().zip(found.iter()).for_each(|(&row, value)| x[row] = *value);
    x
}

/// `K = L L'` row by row; each row is stored from the first nonzero entry of the row of K.
struct Envelope {
    first: Vec<usize>,
    rows: Vec<Vec<f64>>,
}

impl Envelope {
    fn factor(matrix: &DMatrix<f64>) -> Self {
        let n = matrix.nrows();
        let first: Vec<usize> = (0..n).map(|i| (0..i).find(|&j| matrix[(i, j)] != 0.0).unwrap_or(i)).collect();
        let mut rows: Vec<Vec<f64>> = Vec::new();
        for i in 0..n {
            let mut row: Vec<f64> = Vec::new();
            for j in first[i]..=i {
                let from = first[i].max(first[j]);
                let above = if j == i { &row } else { &rows[j] };
                let done: f64 = (from..j).map(|k| row[k - first[i]] * above[k - first[j]]).sum();
                let left = matrix[(i, j)] - done;
                row.push(if j == i { left.sqrt() } else { left / above[j - first[j]] });
            }
            rows.push(row);
        }
        Envelope { first, rows }
    }

    /// `K^-1 x`.
    fn solve(&self, mut x: Vec<f64>) -> Vec<f64> {
        for (i, row) in self.rows.iter().enumerate() {
            let (pivot, before) = (row[row.len() - 1], &row[..row.len() - 1]);
            let done: f64 = before.iter().zip(&x[self.first[i]..i]).map(|(a, b)| a * b).sum();
            x[i] = (x[i] - done) / pivot;
        }
        for (i, row) in self.rows.iter().enumerate().rev() {
            x[i] /= row[row.len() - 1];
            let value = x[i];
            row[..row.len() - 1].iter().zip(&mut x[self.first[i]..i]).for_each(|(a, b)| *b -= a * value);
        }
        x
    }
}
