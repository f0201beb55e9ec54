//! Rows of blocks that repeat, as those of a lattice do: each is stored once, and nodes with the same row that follow
//! each other are multiplied together.

use std::collections::HashMap;
use std::ops::Range;

use super::blocks::BlockMatrix;
use crate::Spare;
use crate::real::{Real, for_processor};

/// Nodes that are multiplied together.
const TILE: usize = 16;

/// Rows after which it is known whether they repeat.
const ENOUGH_ROWS: usize = 4096;

/// Rows are shared if at most this share of their blocks is stored.
const SHARED: f64 = 0.5;

/// Rows are few if at most this share of their blocks is stored.
const FEW: f64 = 1.0 / 16.0;

/// A matrix of square blocks under construction, row by row.
pub struct RowByRow<T> {
    matrix: BlockMatrix<T>,
    /// The first block of the rows with a hash.
    known: HashMap<u64, Vec<u32>>,
}

impl<T: Real> RowByRow<T> {
    /// Before the first row of a matrix of `count` rows of blocks of this size.
    pub fn new(size: usize, count: usize) -> Self {
        let mut matrix = BlockMatrix::empty(0, count, (size, size));
        matrix.starts.reserve_exact(count);
        matrix.shared_rows.reserve_exact(count);
        RowByRow { matrix, known: HashMap::new() }
    }

    /// Takes the next row: its block columns, increasing, and the values of its blocks.
    pub fn push(&mut self, columns: &[u32], values: &[T]) {
        if self.matrix.shared_rows.len() < self.matrix.rows() {
            self.matrix.indices.extend_from_slice(columns);
            self.matrix.values.extend_from_slice(values);
        } else {
            let first = self.stored(columns, values);
            self.matrix.shared_rows.push(first);
        }
        self.end_row(columns.len());
    }

    /// Takes an earlier row once more: the blocks of the next one are the same.
    pub fn repeat(&mut self, row: usize) {
        let length = self.matrix.starts[row + 1] - self.matrix.starts[row];
        if let Some(&first) = self.matrix.shared_rows.get(row) {
            self.matrix.shared_rows.push(first);
            return self.end_row(length);
        }
        let (next, start) = (self.matrix.rows(), self.matrix.starts[row]);
        let columns: Vec<u32> = self.matrix.columns_of(row).map(|column| column + (next - row) as u32).collect();
        let size = self.matrix.block_size();
        let values = self.matrix.values[start * size..(start + length) * size].to_vec();
        self.push(&columns, &values);
    }

    fn end_row(&mut self, blocks: usize) {
        let row = self.matrix.rows();
        self.matrix.starts.push(self.matrix.starts[row] + blocks);
        if row == ENOUGH_ROWS {
            self.share_or_not();
        }
    }

    /// Returns `false` once it is known that the matrix has more than a few different rows.
    pub fn has_few_rows(&self) -> bool {
        let (rows, stored) = (self.matrix.rows(), self.matrix.indices.len() as f64);
        rows < ENOUGH_ROWS || stored <= FEW * self.matrix.starts[rows] as f64
    }

    /// The matrix of all rows, with equal rows stored once if they are few.
    pub fn finished(mut self) -> BlockMatrix<T> {
        self.share_or_not();
        self.matrix
    }

    /// The first block of a row, which is stored if it is new.
    fn stored(&mut self, columns: &[u32], values: &[T]) -> u32 {
        let matrix = &mut self.matrix;
        let row = matrix.rows() as u32;
        let relative = || columns.iter().map(|&column| column.wrapping_sub(row));
        let is_same = |first: u32| {
            let first = first as usize;
            let places = first..first + columns.len();
            let size = matrix.block_size();
            matrix.indices.get(places.clone()).is_some_and(|indices| indices.iter().copied().eq(relative()))
                && matrix.values[places.start * size..places.end * size] == *values
        };
        if let Some(&last) = matrix.shared_rows.last().filter(|&&last| is_same(last)) {
            return last;
        }
        let words = relative().map(u64::from).chain(values.iter().map(|value| value.double().to_bits()));
        let mixed = |hash: u64, word: u64| (hash.rotate_left(5) ^ word).wrapping_mul(0x517c_c1b7_2722_0a95);
        let alike = self.known.entry(words.fold(0, mixed)).or_default();
        if let Some(&first) = alike.iter().find(|&&first| is_same(first)) {
            return first;
        }
        let first = matrix.indices.len() as u32;
        alike.push(first);
        matrix.indices.extend(columns.iter().map(|&column| column.wrapping_sub(row)));
        matrix.values.extend_from_slice(values);
        first
    }

    /// Stores each row by itself if too few repeat.
    fn share_or_not(&mut self) {
        let matrix = &mut self.matrix;
        let rows = matrix.rows();
        if matrix.shared_rows.len() < rows || matrix.indices.len() as f64 <= SHARED * matrix.starts[rows] as f64 {
            return;
        }
        let whole = matrix.unshared();
        (matrix.indices, matrix.values, matrix.shared_rows) = (whole.indices, whole.values, whole.shared_rows);
        self.known.clear();
    }
}

impl<T: Real> BlockMatrix<T> {
    /// `y += sign A x` for a matrix with shared rows.
    pub fn add_by_kinds<const H: usize>(&self, sign: T, x: &[T], y: &mut [T], (threads, spare): (usize, &Spare<T>)) {
        let nodes = self.columns;
        // The components one after another, so that those of neighbours follow each other.
        let mut by_component = spare.take(x.len());
        for (node, of_node) in x.as_chunks::<H>().0.iter().enumerate() {
            of_node.iter().enumerate().for_each(|(component, &value)| by_component[component * nodes + node] = value);
        }
        let components: [&[T]; H] = std::array::from_fn(|component| &by_component[component * nodes..][..nodes]);
        self.shared(threads).with_vectors(H, [y], |rows, [part]| {
            let (mut rest, mut row) = (part.as_chunks_mut::<H>().0, rows.start);
            while row < rows.end {
                let of_row = |row: usize| (self.shared_rows[row], self.starts[row + 1] - self.starts[row]);
                let run = row..row + (row..rows.end).take_while(|&other| of_row(other) == of_row(row)).count();
                let sums = rest.split_off_mut(..run.len()).unwrap_or_default();
                row = run.end;
                if run.len() >= TILE {
                    add_repeated(self, components, run, sums, sign);
                    continue;
                }
                for (row, y) in run.zip(sums) {
                    let sums = self.row_product::<H, H>(row, x);
                    (0..H).for_each(|i| y[i] += sign * sums[i]);
                }
            }
        });
        spare.give(by_component);
    }
}

for_processor! {
    /// Adds the products of rows that all have the blocks of the first, at least [`TILE`] of them.
    fn add_repeated['a, T: Real, const H: usize](
        matrix: &'a BlockMatrix<T>, components: [&'a [T]; H], rows: Range<usize>, sums: &'a mut [[T; H]], sign: T
    ) -> () {
        let first = matrix.shared_rows[rows.start] as usize;
        let places = first..first + matrix.starts[rows.start + 1] - matrix.starts[rows.start];
        let blocks = matrix.values[places.start * H * H..places.end * H * H].as_chunks::<H>().0;
        let indices = &matrix.indices[places];
        let (mut start, mut done) = (rows.start, rows.start);
        loop {
            let mut of_tile = [[T::default(); TILE]; H];
            for (&index, block) in indices.iter().zip(blocks.chunks_exact(H)) {
                let from = index.wrapping_add(start as u32) as usize;
                for (j, component) in components.iter().enumerate() {
                    let Some(x) = component.get(from..).and_then(|rest| rest.first_chunk::<TILE>()) else { continue };
                    for i in 0..H {
                        let a = block[i][j];
                        for (sum, &x) in of_tile[i].iter_mut().zip(x) {
                            *sum += a * x;
                        }
                    }
                }
            }
            of_tile.as_flattened_mut().iter_mut().for_each(|sum| *sum = sign * *sum);
            let of_nodes: [[T; H]; TILE] = std::array::from_fn(|node| std::array::from_fn(|i| of_tile[i][node]));
            for (y, of_node) in sums[start - rows.start..][..TILE].iter_mut().zip(&of_nodes).skip(done - start) {
                (0..H).for_each(|i| y[i] += of_node[i]);
            }
            if start + TILE == rows.end {
                return;
            }
            // The last tile may overlap the one before.
            done = start + TILE;
            start = (start + TILE).min(rows.end - TILE);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rows of a lattice of `lines` lines of `length` nodes: each node is coupled with those beside it and with
    /// those on the lines beside its own. `blocks(a, b)` are the values of a block.
    fn lattice(length: usize, lines: usize, blocks: impl Fn(usize, usize) -> [f32; 9]) -> Vec<(Vec<u32>, Vec<f32>)> {
        let is_near = |a: usize, b: usize| a.abs_diff(b) <= 1;
        let row = |node: usize| {
            let near = (0..length * lines)
                .filter(|other| is_near(node % length, other % length) && is_near(node / length, other / length));
            let columns: Vec<u32> = near.map(|other| other as u32).collect();
            let values = columns.iter().flat_map(|&other| blocks(node, other as usize)).collect();
            (columns, values)
        };
        (0..length * lines).map(row).collect()
    }

    fn check(rows: &[(Vec<u32>, Vec<f32>)], is_shared: bool) {
        let mut shared = RowByRow::new(3, rows.len());
        rows.iter().for_each(|(columns, values)| shared.push(columns, values));
        let blocks = |(columns, values): &(Vec<u32>, Vec<f32>)| -> Vec<(usize, Vec<f32>)> {
            columns.iter().zip(values.chunks(9)).map(|(&column, block)| (column as usize, block.to_vec())).collect()
        };
        // The same with each row stored by itself.
        let plain = BlockMatrix::of_rows(rows.len(), (3, 3), rows.iter().map(blocks));
        let found = shared.finished();
        assert_eq!(!found.shared_rows.is_empty(), is_shared);
        for row in 0..rows.len() {
            assert!(found.row(row).eq(plain.row(row)), "row {row}");
            assert_eq!(found.diagonal_place(row).is_some(), plain.diagonal_place(row).is_some());
        }
        let x: Vec<f32> = (0..3 * rows.len()).map(|index| (index as f32 * 0.37).sin()).collect();
        let mut expected = vec![0.0; x.len()];
        plain.add_product(1.0, &x, &mut expected, 1);
        for threads in [1, 2, 3] {
            let mut y = vec![0.0; x.len()];
            let add = |sign, y: &mut [f32]| match is_shared {
                true => found.add_by_kinds::<3>(sign, &x, y, (threads, &Spare::default())),
                false => found.add_product(sign.into(), &x, y, threads),
            };
            add(1.0, &mut y);
            assert_eq!(y, expected, "{threads} threads");
            add(-1.0, &mut y);
            assert!(y.iter().all(|&rest| rest == 0.0), "{threads} threads");
        }
    }

    #[test]
    fn rows_of_a_lattice_are_shared_and_multiplied_bit_by_bit_as_single_rows_are() {
        let block = |a: usize, b: usize| {
            let step = (b as f32 - a as f32).rem_euclid(7.0);
            std::array::from_fn(|entry| (step + 1.3 * entry as f32).sin())
        };
        // Lines as long as a tile, between two tiles, and shorter than one; enough rows for a second thread.
        for (length, lines) in [(TILE + 2, 9), (2 * TILE + 7, 160), (5, 40)] {
            check(&lattice(length, lines, block), true);
        }
    }

    #[test]
    fn rows_that_differ_are_stored_one_by_one() {
        let block = |a: usize, b: usize| std::array::from_fn(|entry| ((a * 31 + b * 17 + entry) as f32).sin());
        check(&lattice(9, 6, block), false);
        // More rows than are waited for.
        check(&lattice(5, ENOUGH_ROWS / 4, block), false);
    }

    #[test]
    fn a_row_that_begins_as_a_longer_one_has_its_own_length() {
        let block = |_: usize, b: usize| if b == 0 { [2.0; 9] } else { [1.0; 9] };
        // The last node of a line alone has the first blocks of the nodes before it.
        check(&lattice(40, 1, |a, b| block(a, usize::from(a != b))), true);
    }
}
