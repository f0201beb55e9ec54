//! Small dense matrices: elimination, and singular values by rotations of columns.

use std::ops::{Index, IndexMut};

use super::geometry::rotation;
use signorini_linear::dot;

/// Most sweeps over all pairs of columns; thirty columns take ten.
const MOST_SWEEPS: usize = 40;

/// A matrix of a few rows or columns, with all of its entries.
#[derive(Clone, Debug, PartialEq)]
pub struct DenseMatrix {
    rows: usize,
    columns: usize,
    /// Column by column.
    values: Vec<f64>,
}

impl DenseMatrix {
    pub fn zeros(rows: usize, columns: usize) -> Self {
        DenseMatrix { rows, columns, values: vec![0.0; rows * columns] }
    }

    /// The matrix with the entry of each row and column.
    pub fn from_fn(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> f64) -> Self {
        let entry = &entry;
        let values = (0..columns).flat_map(|column| (0..rows).map(move |row| entry(row, column))).collect();
        DenseMatrix { rows, columns, values }
    }

    pub fn identity(size: usize) -> Self {
        Self::from_fn(size, size, |row, column| f64::from(row == column))
    }

    pub fn column(&self, column: usize) -> &[f64] {
        &self.values[column * self.rows..(column + 1) * self.rows]
    }

    pub fn columns(&self) -> impl Iterator<Item = &[f64]> {
        (0..self.columns).map(|column| self.column(column))
    }

    /// The columns, each of which has a row at least.
    pub fn columns_mut(&mut self) -> impl Iterator<Item = &mut [f64]> {
        self.values.chunks_exact_mut(self.rows.max(1))
    }

    /// `A x`.
    pub fn mul(&self, x: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; self.rows];
        for (column, x) in self.columns().zip(x) {
            product.iter_mut().zip(column).for_each(|(sum, entry)| *sum += entry * x);
        }
        product
    }

    /// `A^-1 B` by elimination with pivots from the rows; `None` if A, which is square, is singular.
    pub fn solve(mut self, mut right: DenseMatrix) -> Option<DenseMatrix> {
        let size = self.rows;
        for k in 0..size {
            let (first, later) = self.values.split_at_mut((k + 1) * size);
            let pivots = &mut first[k * size..];
            let pivot = (k..size).max_by(|&a, &b| pivots[a].abs().total_cmp(&pivots[b].abs()))?;
            pivots.swap(k, pivot);
            if pivots[k] == 0.0 || !pivots[k].is_finite() {
                return None;
            }
            for column in later.chunks_exact_mut(size).chain(right.columns_mut()) {
                column.swap(k, pivot);
                let share = column[k] / pivots[k];
                subtract(&mut column[k + 1..], share, &pivots[k + 1..]);
            }
        }
        for column in right.columns_mut() {
            for k in (0..size).rev() {
                column[k] /= self[(k, k)];
                let known = column[k];
                subtract(&mut column[..k], known, self.column(k));
            }
        }
        Some(right)
    }

    /// R of `A = Q R`, by reflections: it has the singular values of A, and no more rows than columns.
    pub fn triangle(mut self) -> Self {
        let size = self.rows.min(self.columns);
        for k in 0..size {
            let (first, later) = self.values.split_at_mut((k + 1) * self.rows);
            let across = &mut first[k * self.rows + k..];
            let length = dot(across, across).sqrt();
            if length == 0.0 {
                continue;
            }
            let onto = -length.copysign(across[0]);
            across[0] -= onto;
            let half = length * across[0].abs();
            for column in later.chunks_exact_mut(self.rows) {
                let share = dot(across, &column[k..]) / half;
                subtract(&mut column[k..], share, across);
            }
            across.fill(0.0);
            across[0] = onto;
        }
        Self::from_fn(size, self.columns, |row, column| self[(row, column)])
    }

    /// The singular values: rotations V make the columns orthogonal, `A V = U S`.
    ///
    /// # Source
    /// M. R. Hestenes, *Inversion of matrices by biorthogonalization and related results*, J. SIAM 6 (1958) 51-90.
    pub fn singular_values(mut self) -> SingularValues {
        let mut right = Self::identity(self.columns);
        let rounding = f64::EPSILON * self.rows as f64;
        // Shorter columns are rounding of zero, and have no direction.
        let least = rounding * dot(&self.values, &self.values).sqrt();
        for _ in 0..MOST_SWEEPS {
            let mut is_orthogonal = true;
            for (first, second) in (1..self.columns).flat_map(|second| (0..second).map(move |first| (first, second))) {
                let (one, other) = (self.column(first), self.column(second));
                let [a, b, both] = [dot(one, one), dot(other, other), dot(one, other)];
                let lengths = [a.sqrt(), b.sqrt()];
                if lengths[0].min(lengths[1]) > least && both.abs() > rounding * lengths[0] * lengths[1] {
                    is_orthogonal = false;
                    let turn = rotation(a, b, both);
                    self.turn(first, second, turn);
                    right.turn(first, second, turn);
                }
            }
            if is_orthogonal {
                break;
            }
        }
        let lengths: Vec<f64> = self.columns().map(|column| dot(column, column).sqrt()).collect();
        let mut order: Vec<usize> = (0..self.columns).collect();
        order.sort_by(|&a, &b| lengths[b].total_cmp(&lengths[a]));
        let ordered = |of: &Self| Self::from_fn(of.rows, of.columns, |row, place| of[(row, order[place])]);
        SingularValues {
            images: ordered(&self),
            right: ordered(&right),
            values: order.iter().map(|&at| lengths[at]).collect(),
        }
    }

    /// Turns two columns, the first of which comes first.
    fn turn(&mut self, first: usize, second: usize, (cosine, sine): (f64, f64)) {
        let (before, after) = self.values.split_at_mut(second * self.rows);
        for (x, y) in before[first * self.rows..].iter_mut().zip(&mut after[..self.rows]).take(self.rows) {
            (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
        }
    }
}

impl Index<(usize, usize)> for DenseMatrix {
    type Output = f64;

    fn index(&self, (row, column): (usize, usize)) -> &f64 {
        &self.values[column * self.rows + row]
    }
}

impl IndexMut<(usize, usize)> for DenseMatrix {
    fn index_mut(&mut self, (row, column): (usize, usize)) -> &mut f64 {
        &mut self.values[column * self.rows + row]
    }
}

/// The singular values of a matrix, decreasing, with their vectors.
#[derive(Clone, Debug)]
pub struct SingularValues {
    pub values: Vec<f64>,
    /// The right vectors, in columns of length one.
    pub right: DenseMatrix,
    /// A times each right vector.
    images: DenseMatrix,
}

impl SingularValues {
    /// The shortest x with the least `|A x - b|`; singular values up to `cut` times the largest count as zero.
    pub fn solve(&self, b: &[f64], cut: f64) -> Vec<f64> {
        let least = cut * self.values.first().copied().unwrap_or(0.0);
        let share = |(image, &value): (&[f64], &f64)| if value > least { dot(image, b) / value / value } else { 0.0 };
        self.right.mul(&self.images.columns().zip(&self.values).map(share).collect::<Vec<_>>())
    }
}

/// Subtracts `share y` from x.
fn subtract(x: &mut [f64], share: f64, y: &[f64]) {
    x.iter_mut().zip(y).for_each(|(x, y)| *x -= share * y);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of entries of order one.
    const ROUNDING: f64 = 1e-14;

    /// Entries of both signs that follow no pattern.
    fn matrix(rows: usize, columns: usize) -> DenseMatrix {
        DenseMatrix::from_fn(rows, columns, |row, column| ((7 * row + 3 * column * column + 1) as f64).sin())
    }

    fn is_near(a: &[f64], b: &[f64]) -> bool {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < ROUNDING)
    }

    #[test]
    fn elimination_exchanges_rows_and_refuses_what_is_singular() {
        let mut a = matrix(5, 5);
        a[(0, 0)] = 0.0;
        let x = a.clone().solve(matrix(5, 2)).unwrap();
        x.columns().zip(matrix(5, 2).columns()).for_each(|(x, b)| assert!(is_near(&a.mul(x), b)));
        assert_eq!(DenseMatrix::from_fn(2, 2, |row, _| row as f64).solve(DenseMatrix::identity(2)), None);
        assert_eq!(DenseMatrix::from_fn(2, 2, |_, _| f64::NAN).solve(DenseMatrix::identity(2)), None);
        assert_eq!(DenseMatrix::zeros(0, 0).solve(DenseMatrix::zeros(0, 0)), Some(DenseMatrix::zeros(0, 0)));
    }

    #[test]
    fn a_triangle_keeps_the_products_of_all_columns() {
        for (rows, columns) in [(7, 4), (4, 4), (2, 4)] {
            let (a, r) = (matrix(rows, columns), matrix(rows, columns).triangle());
            assert_eq!(r.rows, rows.min(columns));
            for (one, of_r) in a.columns().zip(r.columns()) {
                let products =
                    |of: &DenseMatrix, one: &[f64]| of.columns().map(|other| dot(one, other)).collect::<Vec<_>>();
                assert!(is_near(&products(&a, one), &products(&r, of_r)));
            }
            assert!((0..columns).all(|column| r.column(column).iter().skip(column + 1).all(|below| *below == 0.0)));
        }
    }

    /// With the third column the sum of the first two, (1, 1, -1) has no image.
    #[test]
    fn singular_values_find_the_null_space_and_the_shortest_solution() {
        let mut a = matrix(6, 3);
        (0..6).for_each(|row| a[(row, 2)] = a[(row, 0)] + a[(row, 1)]);
        for of in [a.clone(), a.clone().triangle()] {
            let svd = of.clone().singular_values();
            assert!(svd.values.is_sorted_by(|a, b| a >= b) && svd.values[1] > 0.1 && svd.values[2] < ROUNDING);
            let null = svd.right.column(2);
            assert!(is_near(&null.iter().map(|part| part / null[0]).collect::<Vec<_>>(), &[1.0, 1.0, -1.0]));
            let shortest = svd.solve(&of.mul(&[3.0, 0.0, 0.0]), 1e-12);
            assert!(is_near(&shortest, &[2.0, -1.0, 1.0]), "{shortest:?}");
        }
        let wide = DenseMatrix::from_fn(2, 4, |row, column| f64::from(row == column % 2)).singular_values();
        assert!(is_near(&wide.values, &[2.0_f64.sqrt(), 2.0_f64.sqrt(), 0.0, 0.0]), "{:?}", wide.values);
        // What lies across the columns has no share in the solution.
        let tall = DenseMatrix::from_fn(3, 1, |row, _| [2.0, 0.0, 1.0][row]);
        assert!(is_near(&tall.singular_values().solve(&[5.0, 9.0, 5.0], 1e-12), &[3.0]));
        let broken = DenseMatrix::from_fn(3, 2, |_, _| f64::NAN).singular_values();
        assert!(broken.values[0].is_nan() && broken.solve(&[1.0; 3], 1e-12) == [0.0; 2]);
        assert!(DenseMatrix::zeros(3, 2).singular_values().solve(&[1.0; 3], 1e-12) == [0.0; 2]);
    }
}
