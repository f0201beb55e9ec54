//! Gaussian elimination on small dense matrices.

/// A pivot below this share of the largest entry of its column, for each row, is rounding.
const SINGULAR: f64 = f64::EPSILON;

/// The factors of a dense matrix whose rows are exchanged for the largest pivot.
pub struct Lu {
    rows: Vec<Vec<f64>>,
    order: Vec<usize>,
}

impl Lu {
    /// Factorises a square matrix, row by row; `None` if it is singular to rounding.
    pub fn of(mut rows: Vec<Vec<f64>>) -> Option<Self> {
        let n = rows.len();
        let mut largest = vec![0.0_f64; n];
        rows.iter().for_each(|row| row.iter().zip(&mut largest).for_each(|(a, l)| *l = l.max(a.abs())));
        let mut order: Vec<usize> = (0..n).collect();
        for k in 0..n {
            let pivot = (k..n).max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs()))?;
            // NaN is refused as well.
            if !(rows[pivot][k].abs() > n as f64 * SINGULAR * largest[k] && rows[pivot][k].is_finite()) {
                return None;
            }
            rows.swap(k, pivot);
            order.swap(k, pivot);
            let (above, below) = rows.split_at_mut(k + 1);
            let of_pivot = &above[k];
            for row in below.iter_mut().filter(|row| row[k] != 0.0) {
                let factor = row[k] / of_pivot[k];
                row[k] = factor;
                row[k + 1..].iter_mut().zip(&of_pivot[k + 1..]).for_each(|(a, p)| *a -= factor * p);
            }
        }
        Some(Lu { rows, order })
    }

    /// The solution for a right side of as many entries.
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        let mut x: Vec<f64> = self.order.iter().map(|&row| b[row]).collect();
        let sum = |row: &[f64], x: &[f64]| row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>();
        for k in 0..x.len() {
            x[k] -= sum(&self.rows[k][..k], &x[..k]);
        }
        for k in (0..x.len()).rev() {
            x[k] = (x[k] - sum(&self.rows[k][k + 1..], &x[k + 1..])) / self.rows[k][k];
        }
        x
    }
}
