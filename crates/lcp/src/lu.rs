//! Gaussian elimination on sparse matrices without symmetry, row by row.

use signorini_qp::SparseMatrix;

/// A pivot below this share of the largest term of its row, for each row, is rounding.
const SINGULAR: f64 = f64::EPSILON;

/// The diagonal entry is the pivot if it is at least this share of the largest entry that is left: so bands stay.
const DIAGONAL: f64 = 0.1;

/// A row: its multipliers of earlier rows, its pivot and the column of that, and what is left beside it.
struct Row {
    before: Vec<(usize, f64)>,
    column: usize,
    pivot: f64,
    after: Vec<(usize, f64)>,
}

/// The factors of a square matrix.
pub struct Lu {
    rows: Vec<Row>,
}

impl Lu {
    /// Factorises the matrix whose rows are the columns of this one; `None` if it is singular to rounding, or if the
    /// factors have more entries than `most`.
    pub fn of_transposed(matrix: &SparseMatrix, most: f64) -> Option<Self> {
        let n = matrix.columns();
        let (mut place, mut x, mut rows, mut entries) = (vec![n; n], vec![0.0; n], Vec::<Row>::with_capacity(n), 0);
        for i in 0..n {
            let mut touched: Vec<usize> = matrix.column(i).map(|entry| entry.0).collect();
            matrix.column(i).for_each(|(j, value)| x[j] = value);
            let mut largest = matrix.column(i).map(|entry| entry.1.abs()).fold(0.0, f64::max);
            let mut before = Vec::new();
            let first = touched.iter().map(|&j| place[j]).min().unwrap_or(n);
            for (k, row) in rows.iter().enumerate().skip(first) {
                let factor = std::mem::take(&mut x[row.column]) / row.pivot;
                if factor != 0.0 {
                    before.push((k, factor));
                    for &(j, value) in &row.after {
                        if x[j] == 0.0 {
                            touched.push(j);
                        }
                        x[j] -= factor * value;
                        largest = largest.max((factor * value).abs());
                    }
                }
            }
            let mut after: Vec<(usize, f64)> =
                touched.into_iter().map(|j| (j, std::mem::take(&mut x[j]))).filter(|entry| entry.1 != 0.0).collect();
            let size = |at: usize| after[at].1.abs();
            let best = (0..after.len()).max_by(|&a, &b| size(a).total_cmp(&size(b)))?;
            let own = after.iter().position(|entry| entry.0 == i).filter(|&own| size(own) >= DIAGONAL * size(best));
            let (column, pivot) = after.swap_remove(own.unwrap_or(best));
            entries += before.len() + after.len();
            // NaN is refused as well.
            if !(pivot.abs() > n as f64 * SINGULAR * largest && pivot.is_finite() && entries as f64 <= most) {
                return None;
            }
            place[column] = i;
            rows.push(Row { before, column, pivot, after });
        }
        Some(Lu { rows })
    }

    /// The solution for a right side of as many entries.
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        let sum = |entries: &[(usize, f64)], x: &[f64]| entries.iter().map(|&(k, value)| value * x[k]).sum::<f64>();
        let (mut y, mut x) = (b.to_vec(), vec![0.0; b.len()]);
        for (i, row) in self.rows.iter().enumerate() {
            y[i] -= sum(&row.before, &y);
        }
        for (row, y) in self.rows.iter().zip(y).rev() {
            x[row.column] = (y - sum(&row.after, &x)) / row.pivot;
        }
        x
    }
}
