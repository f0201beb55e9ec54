//! Sparse matrices of small dense blocks in compressed rows.

use std::ops::Range;

use crate::Spare;
use crate::columns::group_starts;
use crate::quotient::Firsts;
use crate::real::Real;
use crate::threads::{SharedRows, add_parts};

/// Largest number of parts of a product with the transposed matrix: each has its own vector.
const MOST_PARTS: usize = 8;

/// A sparse matrix of blocks of `height` x `width` values, row by row, each block row by row.
///
/// Rows may be shared, where those of a lattice repeat: see [`BlockMatrix::shared_rows`].
#[derive(Clone, Debug)]
pub struct BlockMatrix<T> {
    pub height: usize,
    pub width: usize,
    pub columns: usize,
    /// Start of each block row in `indices`, length block rows + 1; if rows are shared, only the differences count.
    pub starts: Vec<usize>,
    /// Block column of each block, increasing within a row; if rows are shared, how far it lies after the shift of its
    /// row, modulo 2^32.
    pub indices: Vec<u32>,
    /// Values, `height * width` for each block.
    pub values: Vec<T>,
    /// The first block of each row among `indices`, if rows are shared: several rows then have the same. Empty
    /// otherwise.
    pub shared_rows: Vec<u32>,
    /// The shift of each row, if rows are shared; empty if it is the number of the row.
    pub shifts: Vec<u32>,
    /// `true` if only the blocks up to the diagonal of a symmetric matrix are stored: see [`BlockMatrix::keep_half`].
    pub is_half: bool,
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

pub(super) use with_block_size;

impl<T: Real> BlockMatrix<T> {
    pub fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    pub fn block_size(&self) -> usize {
        self.height * self.width
    }

    #[inline]
    pub fn block(&self, place: usize) -> &[T] {
        &self.values[place * self.block_size()..(place + 1) * self.block_size()]
    }

    /// The places of the blocks of a row, and what their indices lack.
    #[inline]
    pub(super) fn places(&self, row: usize) -> (Range<usize>, u32) {
        match self.shared_rows.get(row) {
            None => (self.starts[row]..self.starts[row + 1], 0),
            Some(&first) => {
                let (first, shift) = (first as usize, self.shifts.get(row).copied().unwrap_or(row as u32));
                (first..first + self.starts[row + 1] - self.starts[row], shift)
            }
        }
    }

    pub fn is_shared(&self) -> bool {
        !self.shared_rows.is_empty()
    }

    #[inline]
    pub fn columns_of(&self, row: usize) -> impl ExactSizeIterator<Item = u32> + '_ {
        let (places, shift) = self.places(row);
        self.indices[places].iter().map(move |index| index.wrapping_add(shift))
    }

    /// The blocks `(column, values)` of a row.
    #[inline]
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, &[T])> + '_ {
        let (places, shift) = self.places(row);
        places.map(move |place| (self.indices[place].wrapping_add(shift) as usize, self.block(place)))
    }

    pub fn diagonal_place(&self, row: usize) -> Option<usize> {
        let (places, shift) = self.places(row);
        let found = self.indices[places.clone()].binary_search_by_key(&row, |index| index.wrapping_add(shift) as usize);
        found.ok().map(|place| places.start + place)
    }

    pub fn bytes(&self) -> usize {
        let words = self.indices.len() + self.shared_rows.len() + self.shifts.len();
        size_of_val(&self.starts[..]) + size_of_val(&self.values[..]) + words * size_of::<u32>()
    }

    pub fn shared(&self, threads: usize) -> SharedRows<'_> {
        SharedRows { starts: &self.starts, threads }
    }

    /// `y += sign A x`.
    pub fn add_product(&self, sign: f64, x: &[T], y: &mut [T], threads: usize) {
        self.shared(threads).with_vectors(self.height, [y], |rows, [y]| {
            with_block_size!(add_rows, (self.height, self.width), (self, x, rows, (T::of(sign), y)));
        });
    }

    /// `step = keep step + gain A r`, then `x += step`.
    pub fn step(&self, r: &[T], (keep, gain): (f64, f64), [step, x]: [&mut [T]; 2], threads: usize) {
        let weights = [T::of(keep), T::of(gain)];
        self.shared(threads).with_vectors(self.height, [step, x], |rows, vectors| {
            with_block_size!(step_rows, (self.height, self.width), (self, r, rows, (weights, vectors)));
        });
    }

    /// Gives a row with one block, on the diagonal, other values.
    pub fn replace_diagonal(&mut self, row: usize, values: &[T]) {
        let size = self.block_size();
        match self.shared_rows.get_mut(row) {
            None => self.values[row * size..(row + 1) * size].copy_from_slice(values),
            Some(first) => {
                *first = self.indices.len() as u32;
                self.indices.push(0);
                self.values.extend_from_slice(values);
            }
        }
    }

    pub fn empty(rows: usize, columns: usize, (height, width): (usize, usize)) -> Self {
        let (starts, indices, values) = (vec![0; rows + 1], Vec::new(), Vec::new());
        let (shared_rows, shifts) = (Vec::new(), Vec::new());
        BlockMatrix { height, width, columns, starts, indices, values, shared_rows, shifts, is_half: false }
    }

    /// The matrix of these rows, each with its block columns, increasing, and the values of its blocks.
    pub fn of_rows<R, B>(columns: usize, size: (usize, usize), rows: impl Iterator<Item = R>) -> Self
    where
        R: IntoIterator<Item = (usize, B)>,
        B: IntoIterator<Item = T>,
    {
        let mut matrix = Self::empty(0, columns, size);
        for row in rows {
            for (column, block) in row {
                matrix.indices.push(column as u32);
                matrix.values.extend(block);
            }
            matrix.starts.push(matrix.indices.len());
        }
        matrix
    }

    /// The same matrix with each row stored by itself.
    pub fn unshared(&self) -> Self {
        let (mut whole, size) = (Self::empty(0, self.columns, (self.height, self.width)), self.block_size());
        whole.indices.reserve_exact(self.starts[self.rows()]);
        whole.values.reserve_exact(self.starts[self.rows()] * size);
        for row in 0..self.rows() {
            whole.indices.extend(self.columns_of(row));
            let places = self.places(row).0;
            whole.values.extend_from_slice(&self.values[places.start * size..places.end * size]);
        }
        whole.starts.clone_from(&self.starts);
        whole
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

    /// A row of `A x`, for blocks of H x W.
    #[inline]
    pub(super) fn row_product<const H: usize, const W: usize>(&self, row: usize, x: &[T]) -> [T; H] {
        let (places, shift) = self.places(row);
        let (parts, mut sum) = (x.as_chunks::<W>().0, [T::default(); H]);
        let blocks = self.values[places.start * H * W..places.end * H * W].as_chunks::<W>().0;
        for (index, block) in self.indices[places].iter().zip(blocks.chunks_exact(H)) {
            let part = &parts[index.wrapping_add(shift) as usize];
            for i in 0..H {
                for j in 0..W {
                    sum[i] += block[i][j] * part[j];
                }
            }
        }
        sum
    }

    /// The rows with entries, for a matrix with mostly empty rows.
    pub fn filled_rows(&self) -> impl Iterator<Item = usize> + Clone + '_ {
        (0..self.rows()).filter(|&row| self.starts[row] < self.starts[row + 1])
    }

    /// `y += factor A x`, for a matrix with mostly empty rows.
    pub fn add_few_products(&self, x: &[T], y: &mut [T], factor: f64) {
        let factor = T::of(factor);
        let mut sums = vec![T::default(); self.height];
        for row in self.filled_rows() {
            sums.fill(T::default());
            self.add_row_product(row, x, &mut sums);
            y[row * self.height..][..self.height].iter_mut().zip(&sums).for_each(|(y, &sum)| *y += factor * sum);
        }
    }

    /// `y -= A y`, for a matrix that has entries in some `rows` alone.
    pub fn subtract_from(&self, rows: &[usize], y: &mut [T]) {
        let mut sums = vec![T::default(); rows.len() * self.height];
        for (&row, sums) in rows.iter().zip(sums.chunks_exact_mut(self.height)) {
            self.add_row_product(row, y, sums);
        }
        for (&row, sums) in rows.iter().zip(sums.chunks_exact(self.height)) {
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

    /// The blocks that `is_kept(row, column, values)` returns `true` for.
    pub fn filtered(&self, is_kept: impl Fn(usize, usize, &[T]) -> bool) -> Self {
        let is_kept = &is_kept;
        let rows = (0..self.rows()).map(|row| {
            let blocks = self.row(row).filter(move |&(column, block)| is_kept(row, column, block));
            blocks.map(|(column, block)| (column, block.iter().copied()))
        });
        Self::of_rows(self.columns, (self.height, self.width), rows)
    }

    pub fn transposed(&self) -> Self {
        self.transposed_rows(0..self.rows())
    }

    /// The transposed matrix, of some rows alone. If rows are shared, those of the transposed matrix are too.
    pub(super) fn transposed_rows(&self, rows: impl Iterator<Item = usize> + Clone) -> Self {
        let starts = group_starts(self.columns, rows.clone().flat_map(|row| self.columns_of(row).map(|c| c as usize)));
        let mut next = starts.clone();
        let (mut indices, mut places) = (vec![0; starts[self.columns]], vec![0; starts[self.columns]]);
        for row in rows {
            for (column, place) in self.columns_of(row).zip(self.places(row).0) {
                let target = next[column as usize];
                next[column as usize] += 1;
                (indices[target], places[target]) = (row as u32, place as u32);
            }
        }
        let mut transposed = Self::empty(0, self.rows(), (self.width, self.height));
        transposed.values.reserve_exact(if self.is_shared() { 0 } else { places.len() * self.block_size() });
        let mut stored = |places: &[u32]| {
            for &place in places {
                let block = self.block(place as usize);
                for j in 0..self.width {
                    transposed.values.extend((0..self.height).map(|i| block[i * self.width + j]));
                }
            }
        };
        if !self.is_shared() {
            stored(&places);
            return BlockMatrix { starts, indices, ..transposed };
        }
        let (mut firsts, mut key, mut relative) = (Firsts::default(), Vec::new(), Vec::new());
        let (mut shared_rows, mut shifts) = (Vec::with_capacity(self.columns), Vec::with_capacity(self.columns));
        for (column, pair) in starts.windows(2).enumerate() {
            let rows = &indices[pair[0]..pair[1]];
            let shift = rows.first().copied().unwrap_or(0);
            key.clear();
            key.extend(rows.iter().map(|row| row - shift));
            key.extend_from_slice(&places[pair[0]..pair[1]]);
            let first = firsts.of(&key, column) as usize;
            shifts.push(shift);
            if first == column {
                shared_rows.push(relative.len() as u32);
                relative.extend_from_slice(&key[..rows.len()]);
                stored(&places[pair[0]..pair[1]]);
            } else {
                shared_rows.push(shared_rows[first]);
            }
        }
        BlockMatrix { starts, indices: relative, shared_rows, shifts, ..transposed }
    }

    /// `A' x`.
    pub fn transposed_mul(&self, x: &[T], threads: usize, spare: &Spare<T>) -> Vec<T> {
        let (parts, mut y) = (self.shared(MOST_PARTS).runs(), spare.zeros(self.columns * self.width));
        let length = y.len();
        let add = |rows: Range<usize>, y: &mut [T]| {
            with_block_size!(add_transposed_product, (self.height, self.width), (self, x, rows, y));
        };
        add_parts(&parts, &mut y, (threads, spare), |_| length, add);
        y
    }
}

fn add_rows<T: Real, const H: usize, const W: usize>(
    matrix: &BlockMatrix<T>,
    x: &[T],
    rows: Range<usize>,
    (sign, y): (T, &mut [T]),
) {
    if H == 0 {
        let mut sums = vec![T::default(); matrix.height];
        for (row, y) in rows.zip(y.chunks_exact_mut(matrix.height)) {
            sums.fill(T::default());
            matrix.add_row_product(row, x, &mut sums);
            y.iter_mut().zip(&sums).for_each(|(y, &sum)| *y += sign * sum);
        }
        return;
    }
    for (row, y) in rows.zip(y.as_chunks_mut::<H>().0) {
        let sums = matrix.row_product::<H, W>(row, x);
        (0..H).for_each(|i| y[i] += sign * sums[i]);
    }
}

fn step_rows<T: Real, const H: usize, const W: usize>(
    matrix: &BlockMatrix<T>,
    r: &[T],
    rows: Range<usize>,
    ([keep, gain], [step, x]): ([T; 2], [&mut [T]; 2]),
) {
    let put = |step: &mut T, x: &mut T, sum: T| {
        *step = keep * *step + gain * sum;
        *x += *step;
    };
    if H == 0 {
        let mut sums = vec![T::default(); matrix.height];
        let nodes = step.chunks_exact_mut(matrix.height).zip(x.chunks_exact_mut(matrix.height));
        for (row, (step, x)) in rows.zip(nodes) {
            sums.fill(T::default());
            matrix.add_row_product(row, r, &mut sums);
            step.iter_mut().zip(x).zip(&sums).for_each(|((step, x), &sum)| put(step, x, sum));
        }
        return;
    }
    for (row, (step, x)) in rows.zip(step.as_chunks_mut::<H>().0.iter_mut().zip(x.as_chunks_mut::<H>().0)) {
        let sums = matrix.row_product::<H, W>(row, r);
        (0..H).for_each(|i| put(&mut step[i], &mut x[i], sums[i]));
    }
}

/// Adds the contribution of some rows to `A' x`.
fn add_transposed_product<T: Real, const H: usize, const W: usize>(
    matrix: &BlockMatrix<T>,
    x: &[T],
    rows: Range<usize>,
    y: &mut [T],
) {
    for row in rows {
        let of_row = &x[row * matrix.height..(row + 1) * matrix.height];
        for (column, block) in matrix.row(row) {
            let sums = &mut y[column * matrix.width..(column + 1) * matrix.width];
            if H == 0 {
                for (line, &x) in block.chunks_exact(matrix.width).zip(of_row) {
                    sums.iter_mut().zip(line).for_each(|(sum, &a)| *sum += a * x);
                }
                continue;
            }
            let (Some(sums), lines) = (sums.first_chunk_mut::<W>(), block.as_chunks::<W>().0) else { continue };
            for (line, &x) in lines.iter().zip(of_row) {
                for j in 0..W {
                    sums[j] += line[j] * x;
                }
            }
        }
    }
}
