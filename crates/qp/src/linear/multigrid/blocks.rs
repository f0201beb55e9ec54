//! Sparse matrices of small dense blocks in compressed rows.

use std::ops::Range;

use crate::linear::factor::Real;
use crate::linear::grouped::group_starts;
use crate::linear::threads::SharedRows;

/// A sparse matrix of blocks of `height` x `width` values, row by row, each block row by row.
#[derive(Clone, Debug)]
pub struct BlockMatrix<T> {
    /// Rows of a block.
    pub height: usize,
    /// Columns of a block.
    pub width: usize,
    /// Number of block columns.
    pub columns: usize,
    /// Start of each block row in `indices`, length block rows + 1.
    pub starts: Vec<usize>,
    /// Block column of each block, increasing within a row.
    pub indices: Vec<u32>,
    /// Values, `height * width` for each block.
    pub values: Vec<T>,
}

/// Calls a function with the block size as constants if it is one of the sizes of bodies.
macro_rules! with_block_size {
    ($function:ident, $size:expr, $arguments:tt) => {
        match $size {
            (1, 1) => $function::<T, 1, 1> $arguments,
            (2, 2) => $function::<T, 2, 2> $arguments,
            (2, 3) => $function::<T, 2, 3> $arguments,
            (3, 2) => $function::<T, 3, 2> $arguments,
            (3, 3) => $function::<T, 3, 3> $arguments,
            (3, 6) => $function::<T, 3, 6> $arguments,
            (6, 3) => $function::<T, 6, 3> $arguments,
            (6, 6) => $function::<T, 6, 6> $arguments,
            _ => $function::<T, 0, 0> $arguments,
        }
    };
}

impl<T: Real> BlockMatrix<T> {
    /// Number of block rows.
    pub fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of values of a block.
    pub fn block_size(&self) -> usize {
        self.height * self.width
    }

    /// The values of block `place`, row by row.
    #[inline]
    pub fn block(&self, place: usize) -> &[T] {
        &self.values[place * self.block_size()..(place + 1) * self.block_size()]
    }

    /// The blocks `(column, values)` of a row.
    #[inline]
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, &[T])> + '_ {
        (self.starts[row]..self.starts[row + 1]).map(|place| (self.indices[place] as usize, self.block(place)))
    }

    /// The place of the diagonal block of a row, if there is one.
    pub fn diagonal_place(&self, row: usize) -> Option<usize> {
        let range = self.starts[row]..self.starts[row + 1];
        self.indices[range.clone()].binary_search(&(row as u32)).ok().map(|place| range.start + place)
    }

    /// Bytes of memory that it holds.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.starts[..]) + size_of_val(&self.indices[..]) + size_of_val(&self.values[..])
    }

    /// The rows, to be shared out among threads.
    pub fn shared(&self, threads: usize) -> SharedRows<'_> {
        SharedRows { starts: &self.starts, threads }
    }

    /// `y = A x`.
    pub fn mul_into(&self, x: &[T], y: &mut [T], threads: usize) {
        self.shared(threads).with_vectors(self.height, [y], |rows, [part]| {
            with_block_size!(multiply_rows, (self.height, self.width), (self, x, rows, part));
        });
    }

    /// A matrix without entries, of `rows` by `columns` blocks.
    pub fn empty(rows: usize, columns: usize, (height, width): (usize, usize)) -> Self {
        BlockMatrix { height, width, columns, starts: vec![0; rows + 1], indices: Vec::new(), values: Vec::new() }
    }

    /// Adds a row of `A x` to `sums`.
    fn add_row_product(&self, row: usize, x: &[T], sums: &mut [T]) {
        for (column, block) in self.row(row) {
            let part = &x[column * self.width..(column + 1) * self.width];
            for (sum, of_row) in sums.iter_mut().zip(block.chunks_exact(self.width)) {
                of_row.iter().zip(part).for_each(|(&a, &x)| *sum += a * x);
            }
        }
    }

    /// The rows with entries, for a matrix with mostly empty rows.
    fn filled_rows(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.rows()).filter(|&row| self.starts[row] < self.starts[row + 1])
    }

    /// `y -= A x`, for a matrix with mostly empty rows.
    pub fn subtract_product(&self, x: &[T], y: &mut [T]) {
        let mut sums = vec![T::default(); self.height];
        for row in self.filled_rows() {
            sums.fill(T::default());
            self.add_row_product(row, x, &mut sums);
            y[row * self.height..][..self.height].iter_mut().zip(&sums).for_each(|(y, &sum)| *y -= sum);
        }
    }

    /// `y -= A y`, for a matrix with mostly empty rows.
    pub fn subtract_from(&self, y: &mut [T]) {
        let mut sums = vec![T::default(); self.filled_rows().count() * self.height];
        for (row, sums) in self.filled_rows().zip(sums.chunks_exact_mut(self.height)) {
            self.add_row_product(row, y, sums);
        }
        for (row, sums) in self.filled_rows().zip(sums.chunks_exact(self.height)) {
            y[row * self.height..][..self.height].iter_mut().zip(sums).for_each(|(y, &sum)| *y -= sum);
        }
    }

    /// The sum `A + factor B` of matrices of one shape.
    pub fn plus(&self, factor: f64, other: &Self) -> Self {
        let factor = T::of(factor);
        let mut sum = Self::empty(0, self.columns, (self.height, self.width));
        for row in 0..self.rows() {
            let (mut left, mut right) = (self.row(row).peekable(), other.row(row).peekable());
            loop {
                let (a, b) = (left.peek().map(|entry| entry.0), right.peek().map(|entry| entry.0));
                let Some(column) = a.into_iter().chain(b).min() else { break };
                sum.indices.push(column as u32);
                let start = sum.values.len();
                match left.next_if(|entry| entry.0 == column) {
                    Some((_, block)) => sum.values.extend_from_slice(block),
                    None => sum.values.resize(start + self.block_size(), T::default()),
                }
                if let Some((_, block)) = right.next_if(|entry| entry.0 == column) {
                    sum.values[start..].iter_mut().zip(block).for_each(|(sum, &b)| *sum += factor * b);
                }
            }
            sum.starts.push(sum.indices.len());
        }
        sum
    }

    /// The same matrix without the blocks of zeros.
    pub fn without_zeros(&self) -> Self {
        let mut kept = Self::empty(0, self.columns, (self.height, self.width));
        for row in 0..self.rows() {
            for (column, block) in self.row(row).filter(|entry| entry.1.iter().any(|&value| value != T::default())) {
                kept.indices.push(column as u32);
                kept.values.extend_from_slice(block);
            }
            kept.starts.push(kept.indices.len());
        }
        kept
    }

    /// The entries between rows in which `other` has entries.
    pub fn within(&self, other: &Self) -> Self {
        let is_filled = |row: usize| other.starts[row] < other.starts[row + 1];
        let mut part = Self::empty(0, self.columns, (self.height, self.width));
        for row in 0..self.rows() {
            for (column, block) in self.row(row).filter(|entry| is_filled(row) && is_filled(entry.0)) {
                part.indices.push(column as u32);
                part.values.extend_from_slice(block);
            }
            part.starts.push(part.indices.len());
        }
        part
    }

    /// The transposed matrix.
    pub fn transposed(&self) -> Self {
        let starts = group_starts(self.columns, self.indices.iter().map(|&column| column as usize));
        let mut next = starts.clone();
        let mut indices = vec![0; self.indices.len()];
        let mut values = vec![T::default(); self.values.len()];
        let size = self.block_size();
        for row in 0..self.rows() {
            for (column, block) in self.row(row) {
                let place = next[column];
                next[column] += 1;
                indices[place] = row as u32;
                let target = &mut values[place * size..(place + 1) * size];
                for i in 0..self.height {
                    for j in 0..self.width {
                        target[j * self.height + i] = block[i * self.width + j];
                    }
                }
            }
        }
        BlockMatrix { height: self.width, width: self.height, columns: self.rows(), starts, indices, values }
    }

    /// The product A B, row by row: a row of the product is a sum of rows of B, one for each entry in the row of A.
    pub fn product(&self, other: &Self, threads: usize) -> Self {
        let parts = self
            .shared(threads)
            .map(|rows| with_block_size!(product_rows, (self.height, self.width), (self, other, rows)));
        let mut product = Self::empty(0, other.columns, (self.height, other.width));
        for (starts, indices, values) in parts {
            let before = product.indices.len();
            product.starts.extend(starts.iter().map(|start| before + start));
            if before == 0 {
                (product.indices, product.values) = (indices, values);
            } else {
                product.indices.extend(indices);
                product.values.extend(values);
            }
        }
        product
    }
}

fn multiply_rows<T: Real, const H: usize, const W: usize>(
    matrix: &BlockMatrix<T>,
    x: &[T],
    rows: Range<usize>,
    y: &mut [T],
) {
    if H == 0 {
        for (row, sums) in rows.zip(y.chunks_exact_mut(matrix.height)) {
            sums.fill(T::default());
            matrix.add_row_product(row, x, sums);
        }
        return;
    }
    let (parts, _) = x.as_chunks::<W>();
    let (sums, _) = y.as_chunks_mut::<H>();
    for (row, of_row) in rows.zip(sums) {
        let mut sum = [T::default(); H];
        let range = matrix.starts[row]..matrix.starts[row + 1];
        let blocks = matrix.values[range.start * H * W..range.end * H * W].as_chunks::<W>().0;
        for (&column, block) in matrix.indices[range].iter().zip(blocks.chunks_exact(H)) {
            let part = &parts[column as usize];
            for i in 0..H {
                for j in 0..W {
                    sum[i] += block[i][j] * part[j];
                }
            }
        }
        *of_row = sum;
    }
}

type Rows<T> = (Vec<usize>, Vec<u32>, Vec<T>);

/// The rows of a product: the ends of the rows, columns and values.
fn product_rows<T: Real, const H: usize, const W: usize>(
    left: &BlockMatrix<T>,
    right: &BlockMatrix<T>,
    rows: Range<usize>,
) -> Rows<T> {
    let (height, inner, width) = (left.height, left.width, right.width);
    let size = height * width;
    let (mut ends, mut indices, mut values) = (Vec::with_capacity(rows.len()), Vec::new(), Vec::new());
    let mut place_of = vec![u32::MAX; right.columns];
    let (mut found, mut sums): (Vec<u32>, Vec<T>) = (Vec::new(), Vec::new());
    let mut order: Vec<u32> = Vec::new();
    for row in rows {
        found.clear();
        sums.clear();
        for (k, a) in left.row(row) {
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
