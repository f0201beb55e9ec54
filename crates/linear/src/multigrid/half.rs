//! Symmetric matrices of which the blocks up to the diagonal alone are stored: half the memory, and half of what a
//! product reads.

use std::borrow::Cow;
use std::ops::Range;

use super::blocks::BlockMatrix;
use crate::Spare;
use crate::real::Real;
use crate::threads::add_parts;

/// Largest number of parts of a product: each has its own vector.
const MOST_PARTS: usize = 4;

impl<T: Real> BlockMatrix<T> {
    /// Keeps the blocks up to the diagonal of a symmetric matrix alone.
    pub fn keep_half(&mut self) {
        let (size, mut kept, mut start) = (self.block_size(), 0, 0);
        for row in 0..self.rows() {
            let columns = &self.indices[start..self.starts[row + 1]];
            let count = columns.partition_point(|&column| column as usize <= row);
            self.indices.copy_within(start..start + count, kept);
            self.values.copy_within(start * size..(start + count) * size, kept * size);
            kept += count;
            start = std::mem::replace(&mut self.starts[row + 1], kept);
        }
        self.indices.truncate(kept);
        self.values.truncate(kept * size);
        self.indices.shrink_to_fit();
        self.values.shrink_to_fit();
        self.is_half = true;
    }

    /// The matrix with all blocks of these rows; if only half of them is stored, its other rows are empty.
    pub fn with_rows(&self, rows: impl Iterator<Item = usize>) -> Cow<'_, Self> {
        if !self.is_half {
            return Cow::Borrowed(self);
        }
        let mut is_asked = vec![false; self.rows()];
        rows.for_each(|row| is_asked[row] = true);
        // The blocks of the rows, and where they are stored; those after the diagonal follow those up to it, in
        // increasing columns.
        let mut found: Vec<(u32, u32, usize)> = Vec::new();
        for row in 0..self.rows() {
            for place in self.starts[row]..self.starts[row + 1] {
                let column = self.indices[place];
                if is_asked[row] {
                    found.push((row as u32, column, place));
                }
                if is_asked[column as usize] && column as usize != row {
                    found.push((column, row as u32, place));
                }
            }
        }
        found.sort_unstable();
        let (height, mut whole) = (self.height, Self::empty(0, self.columns, (self.height, self.width)));
        for (row, column, place) in found {
            whole.starts.resize(row as usize + 1, whole.indices.len());
            whole.indices.push(column);
            let block = self.block(place);
            match column <= row {
                true => whole.values.extend_from_slice(block),
                false => (0..height).for_each(|i| whole.values.extend(block.iter().skip(i).step_by(height))),
            }
        }
        whole.starts.resize(self.rows() + 1, whole.indices.len());
        Cow::Owned(whole)
    }

    /// `y += sign A x` for a matrix of which half is stored.
    pub fn add_by_half<const H: usize>(&self, sign: T, x: &[T], y: &mut [T], work: (usize, &Spare<T>)) {
        let mut parts = self.shared(MOST_PARTS).runs();
        // What a part adds ends with its last row: that of all rows comes first.
        parts.rotate_right(1);
        let end = |rows: &Range<usize>| rows.end * H;
        add_parts(&parts, y, work, end, |rows, sums| self.add_rows_by_half::<H>(rows, sign, x, sums));
    }

    /// Adds what the stored blocks of some rows, and those that mirror them, add to `sign A x`.
    fn add_rows_by_half<const H: usize>(&self, rows: Range<usize>, sign: T, x: &[T], sums: &mut [T]) {
        let (x, sums) = (x.as_chunks::<H>().0, sums.as_chunks_mut::<H>().0);
        for row in rows {
            let places = self.starts[row]..self.starts[row + 1];
            let blocks = self.values[places.start * H * H..places.end * H * H].as_chunks::<H>().0;
            let (of_row, mut own) = (x[row].map(|x| sign * x), [T::default(); H]);
            for (&column, block) in self.indices[places].iter().zip(blocks.chunks_exact(H)) {
                let column = column as usize;
                let of_column = x[column];
                for i in 0..H {
                    for j in 0..H {
                        own[i] += block[i][j] * of_column[j];
                    }
                }
                if column < row {
                    let mut mirrored = sums[column];
                    for i in 0..H {
                        for j in 0..H {
                            mirrored[j] += block[i][j] * of_row[i];
                        }
                    }
                    sums[column] = mirrored;
                }
            }
            for i in 0..H {
                sums[row][i] += sign * own[i];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A symmetric matrix of `count` nodes, each coupled with itself, with some around it, and with one far away.
    fn symmetric<const H: usize>(count: usize) -> BlockMatrix<f64> {
        let far = |row: usize| row + 7 * (count / 9) < count && row.is_multiple_of(5);
        let rows = (0..count).map(|row| {
            let mut columns: Vec<usize> = (row.saturating_sub(3)..(row + 4).min(count)).collect();
            columns.extend(far(row).then_some(row + 7 * (count / 9)));
            columns.extend(row.checked_sub(7 * (count / 9)).filter(|&other| far(other)));
            columns.sort_unstable();
            columns.dedup();
            columns.into_iter().map(move |column| {
                let entry = move |i: usize, j: usize| {
                    let (low, high) = ((row, i).min((column, j)), (row, i).max((column, j)));
                    ((low.0 * 31 + low.1 * 7 + high.0 * 17 + high.1) as f64).sin()
                };
                (column, (0..H * H).map(move |place| entry(place / H, place % H)))
            })
        });
        BlockMatrix::of_rows(count, (H, H), rows)
    }

    fn check<const H: usize>(count: usize) {
        let whole = symmetric::<H>(count);
        let mut half = whole.clone();
        half.keep_half();
        assert!(half.values.len() < whole.values.len() * 2 / 3);
        let x: Vec<f64> = (0..H * count).map(|index| (index as f64 * 0.37).sin()).collect();
        let mut expected = vec![0.0; x.len()];
        whole.add_product(1.0, &x, &mut expected, 1);
        // Rows have at most nine blocks, of entries and unknowns up to one.
        let rounding = 4.0 * f64::EPSILON * (9 * H) as f64;
        let product = |threads: usize| {
            let mut y = vec![0.0; x.len()];
            half.add_by_half::<H>(1.0, &x, &mut y, (threads, &Spare::default()));
            // What is subtracted from itself leaves the rounding of as many terms.
            let mut rest = y.clone();
            half.add_by_half::<H>(-1.0, &x, &mut rest, (threads, &Spare::default()));
            assert!(rest.iter().all(|rest| rest.abs() <= rounding));
            y
        };
        let found = product(1);
        assert!(found.iter().zip(&expected).all(|(found, expected)| (found - expected).abs() <= rounding));
        for threads in 2..=5 {
            assert_eq!(product(threads), found, "{threads} threads");
        }
        let asked = [0, 1, count / 2, count - 1];
        let rows = half.with_rows(asked.into_iter());
        for row in 0..count {
            match asked.contains(&row) {
                true => assert!(rows.row(row).eq(whole.row(row)), "row {row}"),
                false => assert_eq!(rows.row(row).count(), 0),
            }
        }
    }

    #[test]
    fn half_of_a_matrix_gives_the_products_and_the_rows_of_the_whole_on_any_number_of_threads() {
        check::<1>(100);
        check::<2>(1000);
        // Enough blocks for all parts.
        check::<3>(30_000);
    }

    #[test]
    fn a_galerkin_product_is_that_of_the_whole_matrix() {
        let matrix = symmetric::<2>(300);
        let mut half = matrix.clone();
        half.keep_half();
        let value = |row: usize, column: usize, place: usize| ((row * 13 + column * 5 + place) as f64).sin();
        let rows = (0..300).map(|row| {
            let columns = [row / 8, row / 8 + 1];
            columns.map(|column| (column, (0..6).map(move |place| value(row, column, place))))
        });
        let prolongator = BlockMatrix::of_rows(40, (2, 3), rows);
        let expected = prolongator.transposed().product(&matrix.product(&prolongator, 1), 1);
        for stored in [&matrix, &half] {
            let found = prolongator.galerkin_product(stored, 2);
            assert_eq!((&found.starts, &found.indices), (&expected.starts, &expected.indices));
            let largest = expected.values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
            let difference = |(found, expected): (&f64, &f64)| (found - expected).abs() <= 1e-13 * largest;
            assert!(found.values.iter().zip(&expected.values).all(difference));
        }
    }
}
