//! Products of block matrices.

use std::ops::Range;

use super::blocks::{BlockMatrix, with_block_size};
use crate::quotient::Firsts;
use crate::real::Real;
use crate::threads::SharedRows;

/// Least number of blocks of a matrix in a slab of a Galerkin product.
const SLAB: usize = 500_000;

/// Largest number of slabs: the sum of the products of all slabs is copied with each.
const MOST_SLABS: usize = 16;

impl<T: Real> BlockMatrix<T> {
    /// The product P' M of this matrix P; rows of M may be empty.
    pub fn transposed_product(&self, other: &Self, threads: usize) -> Self {
        self.transposed_rows(other.filled_rows()).product(other, threads)
    }

    /// The product P' A P of this matrix P and a symmetric one, `A = H + H'` with half of the diagonal blocks in H:
    /// `P' H P` and its transposed. By slabs of rows, so that H P is never there as a whole.
    pub fn galerkin_product(&self, matrix: &Self, threads: usize) -> Self {
        let most = if matrix.is_shared() && self.is_shared() { 1 } else { MOST_SLABS };
        let slabs = SharedRows { starts: &matrix.starts, threads: most }.runs_of(SLAB);
        let mut sum: Option<Self> = None;
        for rows in slabs {
            let mut moved = matrix.product_rows(true, self, rows.clone(), threads);
            // Rows before and after the slab are empty.
            let (before, last) = (rows.start, moved.starts[rows.len()]);
            moved.starts.splice(0..0, vec![0; before]);
            moved.starts.resize(matrix.rows() + 1, last);
            let part = self.transposed_rows(rows).product(&moved, threads);
            sum = Some(match sum {
                None => part,
                Some(sum) => sum.plus(1.0, &part),
            });
        }
        match sum {
            Some(sum) => sum.plus(1.0, &sum.transposed()),
            None => Self::empty(self.columns, self.columns, (self.width, self.width)),
        }
    }

    /// The product A B, row by row: a row of the product is a sum of rows of B, one for each entry in the row of A.
    pub fn product(&self, other: &Self, threads: usize) -> Self {
        self.product_rows(false, other, 0..self.rows(), threads)
    }

    /// Some rows of the product A B, numbered from 0; `by_half` takes of A the blocks before the diagonal and half of
    /// those on it.
    fn product_rows(&self, by_half: bool, other: &Self, rows: Range<usize>, threads: usize) -> Self {
        if self.is_shared() && other.is_shared() && rows.len() == self.rows() {
            return self.shared_product(by_half, other);
        }
        let starts = &self.starts[rows.start..=rows.end];
        let parts = SharedRows { starts, threads }.map(|part| {
            let rows = rows.start + part.start..rows.start + part.end;
            with_block_size!(product_rows, (self.height, self.width), ((self, by_half), other, rows))
        });
        let mut product = Self::empty(0, other.columns, (self.height, other.width));
        for (starts, indices, values) in parts {
            let before = product.indices.len();
            product.starts.extend(starts.iter().map(|start| before + start));
            if before == 0 {
                (product.indices, product.values) = (indices, values);
                continue;
            }
            product.indices.extend(indices);
            product.values.extend(values);
        }
        product
    }

    /// The product if rows of both are shared: a row of it is that of an earlier one if all rows that make it are.
    fn shared_product(&self, by_half: bool, other: &Self) -> Self {
        let (mut firsts, mut key, mut distinct) = (Firsts::default(), Vec::new(), Vec::new());
        let mut product = Self::empty(0, other.columns, (self.height, other.width));
        let mut first_of_rows = Vec::with_capacity(self.rows());
        for row in 0..self.rows() {
            let (places, _) = self.places(row);
            key.clear();
            key.extend([places.start as u32, places.len() as u32]);
            let mut shift = None;
            for k in self.columns_of(row).map(|k| k as usize).filter(|&k| !by_half || k <= row) {
                let (places, of_row) = other.places(k);
                let shift = *shift.get_or_insert(of_row);
                key.extend([places.start as u32, places.len() as u32, of_row.wrapping_sub(shift)]);
            }
            first_of_rows.push(firsts.of(&key, row) as usize);
            product.shifts.push(shift.unwrap_or(0));
            if first_of_rows[row] == row {
                distinct.push(row);
            }
        }
        let rows = distinct.iter().copied();
        let (ends, indices, values) =
            with_block_size!(product_rows, (self.height, self.width), ((self, by_half), other, rows));
        (product.indices, product.values) = (indices, values);
        let (mut stored, mut start) = (vec![0..0; self.rows()], 0);
        for (&row, &end) in distinct.iter().zip(&ends) {
            let shift = product.shifts[row];
            product.indices[start..end].iter_mut().for_each(|column| *column = column.wrapping_sub(shift));
            (stored[row], start) = (start..end, end);
        }
        for (row, first) in first_of_rows.into_iter().enumerate() {
            product.shared_rows.push(stored[first].start as u32);
            product.starts.push(product.starts[row] + stored[first].len());
        }
        product
    }
}

type Rows<T> = (Vec<usize>, Vec<u32>, Vec<T>);

/// The rows of a product: the ends of the rows, columns and values.
fn product_rows<T: Real, const H: usize, const W: usize>(
    (left, by_half): (&BlockMatrix<T>, bool),
    right: &BlockMatrix<T>,
    rows: impl ExactSizeIterator<Item = usize>,
) -> Rows<T> {
    let (height, inner, width) = (left.height, left.width, right.width);
    let size = height * width;
    let (mut ends, mut indices, mut values) = (Vec::with_capacity(rows.len()), Vec::new(), Vec::new());
    let mut place_of = vec![u32::MAX; right.columns];
    let (mut found, mut sums): (Vec<u32>, Vec<T>) = (Vec::new(), Vec::new());
    let (mut order, mut half): (Vec<u32>, Vec<T>) = (Vec::new(), Vec::new());
    for row in rows {
        found.clear();
        sums.clear();
        for (k, mut a) in left.row(row) {
            if by_half && k > row {
                break;
            }
            if by_half && k == row {
                half.clear();
                half.extend(a.iter().map(|&value| T::of(0.5) * value));
                a = &half;
            }
            for (column, b) in right.row(k) {
                let mut place = place_of[column] as usize;
                if place == u32::MAX as usize {
                    place = found.len();
                    place_of[column] = place as u32;
                    found.push(column as u32);
                    sums.resize(sums.len() + size, T::default());
                }
                let sum = &mut sums[place * size..(place + 1) * size];
                match width {
                    1 => add_product::<T, H, W, 1>(a, b, sum, (height, inner, width)),
                    2 => add_product::<T, H, W, 2>(a, b, sum, (height, inner, width)),
                    3 => add_product::<T, H, W, 3>(a, b, sum, (height, inner, width)),
                    6 => add_product::<T, H, W, 6>(a, b, sum, (height, inner, width)),
                    _ => add_product::<T, 0, 0, 0>(a, b, sum, (height, inner, width)),
                }
            }
        }
        order.clear();
        order.extend_from_slice(&found);
        order.sort_unstable();
        for &column in &order {
            let place = place_of[column as usize] as usize;
            indices.push(column);
            values.extend_from_slice(&sums[place * size..(place + 1) * size]);
        }
        found.iter().for_each(|&column| place_of[column as usize] = u32::MAX);
        ends.push(indices.len());
    }
    (ends, indices, values)
}

#[inline]
fn add_product<T: Real, const H: usize, const W: usize, const C: usize>(
    a: &[T],
    b: &[T],
    sum: &mut [T],
    (height, inner, width): (usize, usize, usize),
) {
    if H == 0 || C == 0 {
        for i in 0..height {
            for k in 0..inner {
                for j in 0..width {
                    sum[i * width + j] += a[i * inner + k] * b[k * width + j];
                }
            }
        }
        return;
    }
    let (a, b, sum) = (a.as_chunks::<W>().0, b.as_chunks::<C>().0, sum.as_chunks_mut::<C>().0);
    let (Some(a), Some(b), Some(sum)) = (a.first_chunk::<H>(), b.first_chunk::<W>(), sum.first_chunk_mut::<H>()) else {
        return;
    };
    for i in 0..H {
        let mut of_row = sum[i];
        for k in 0..W {
            for j in 0..C {
                of_row[j] += a[i][k] * b[k][j];
            }
        }
        sum[i] = of_row;
    }
}
