//! Small dense matrices: factors by Cholesky's method, and null spaces.

use signorini_qp::dot;

/// A pivot below this share of its entry is rounding. Those of the stresses of a triangle fall as the fourth power of
/// its height over its length: 1e-10 at three thousandths.
const SINGULAR_PIVOT: f64 = 1e-12;

/// Coefficients of conditions below this are rounding; theirs are of order one.
const DEPENDENT: f64 = 1e-9;

/// The lower factor L of a definite matrix `L L'`, row by row.
#[derive(Clone, Debug)]
pub struct Lower(Vec<Vec<f64>>);

impl Lower {
    /// The factor of a matrix of which the lower triangle is given, row by row; `None` if it is singular.
    pub fn of(mut matrix: Vec<Vec<f64>>) -> Option<Self> {
        for k in 0..matrix.len() {
            let (above, rest) = matrix.split_at_mut(k);
            let own = &mut rest[0];
            for (j, before) in above.iter().enumerate() {
                own[j] = (own[j] - dot(&own[..j], &before[..j])) / before[j];
            }
            let pivot = own[k] - dot(&own[..k], &own[..k]);
            if pivot.is_nan() || pivot <= SINGULAR_PIVOT * own[k] {
                return None;
            }
            own[k] = pivot.sqrt();
        }
        Some(Lower(matrix))
    }

    /// The factor of `A'A` for the rows of A, each of this length.
    pub fn of_squares(length: usize, rows: &[impl AsRef<[f64]>]) -> Option<Self> {
        let mut matrix: Vec<Vec<f64>> = (0..length).map(|i| vec![0.0; i + 1]).collect();
        for row in rows.iter().map(AsRef::as_ref) {
            matrix.iter_mut().zip(row).for_each(|(line, &factor)| add(line, factor, row));
        }
        Self::of(matrix)
    }

    /// Replaces b by `L^-1 b`.
    pub fn forward(&self, b: &mut [f64]) {
        for (k, line) in self.0.iter().enumerate() {
            b[k] = (b[k] - dot(&line[..k], &b[..k])) / line[k];
        }
    }

    /// `L'^-1 b`, in place.
    pub fn backward(&self, b: &mut [f64]) {
        for (k, line) in self.0.iter().enumerate().rev() {
            b[k] /= line[k];
            let (before, own) = b.split_at_mut(k);
            add(before, -own[0], line);
        }
    }

    /// `(L L')^-1 b`, in place.
    pub fn solve(&self, b: &mut [f64]) {
        self.forward(b);
        self.backward(b);
    }
}

/// Adds `factor` times another vector.
pub fn add(sum: &mut [f64], factor: f64, other: &[f64]) {
    sum.iter_mut().zip(other).for_each(|(sum, part)| *sum += factor * part);
}

/// A basis of the null space of all rows, by elimination.
pub fn null_space(mut rows: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let count = rows.first().map_or(0, Vec::len);
    let mut pivots: Vec<(usize, usize)> = Vec::with_capacity(rows.len());
    let largest_in = |row: &[f64]| {
        let largest = (0..count).max_by(|&a, &b| row[a].abs().total_cmp(&row[b].abs())).unwrap_or(0);
        (row[largest].abs(), largest)
    };
    // Of the rows without a pivot.
    let mut largest: Vec<Option<(f64, usize)>> = rows.iter().map(|row| Some(largest_in(row))).collect();
    loop {
        let left = largest.iter().enumerate().filter_map(|(row, largest)| Some(((*largest)?, row)));
        let next = left.max_by(|a, b| a.0.0.total_cmp(&b.0.0));
        // What is left of a row that depends on others is rounding.
        let Some(((_, column), index)) = next.filter(|((size, _), _)| *size > DEPENDENT) else { break };
        largest[index] = None;
        let scale = rows[index][column];
        rows[index].iter_mut().for_each(|value| *value /= scale);
        let row = rows[index].clone();
        for other in (0..rows.len()).filter(|&other| other != index) {
            let share = rows[other][column];
            if share != 0.0 {
                add(&mut rows[other], -share, &row);
                largest[other] = largest[other].map(|_| largest_in(&rows[other]));
            }
        }
        pivots.push((index, column));
    }
    let vector = |column: usize| {
        let mut vector = vec![0.0; count];
        vector[column] = 1.0;
        pivots.iter().for_each(|&(row, pivot)| vector[pivot] = -rows[row][column]);
        vector
    };
    (0..count).filter(|column| pivots.iter().all(|pivot| pivot.1 != *column)).map(vector).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn consistent_equations_are_solved_and_a_singular_matrix_is_refused() {
        let rows = [vec![1.0, 2.0], vec![0.5, -1.0], vec![3.0, 0.25]];
        let mut y = vec![0.0; 2];
        rows.iter().for_each(|row| add(&mut y, dot(row, &[2.0, -3.0]), row));
        Lower::of_squares(2, &rows).unwrap().solve(&mut y);
        assert!((y[0] - 2.0).abs() < 1e-14 && (y[1] + 3.0).abs() < 1e-14);
        assert!(Lower::of_squares(2, &[vec![1.0, 2.0], vec![2.0, 4.0]]).is_none());
        // L = [2 0; 1 3].
        let factor = Lower::of(vec![vec![4.0], vec![2.0, 10.0]]).unwrap();
        let mut b = [4.0, 11.0];
        factor.forward(&mut b);
        assert_eq!(b, [2.0, 3.0]);
    }
}
