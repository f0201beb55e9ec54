//! Four columns at once: sweeps through a factor, and products, in which each entry is fetched once for all four.

use std::ops::Range;

use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use pulp::{Arch, Scalar, Simd, WithSimd};

use super::super::{Cholesky, SymmetricMatrix};

/// Columns that are treated together.
pub const LANES: usize = 4;

/// Columns of a block that a sweep treats together: each row is then fetched once for all of them.
const TOGETHER: usize = 4;

/// The entries of all columns in one row.
type Lane = [f64; LANES];

/// Columns of one length, row by row.
pub struct Lanes {
    rows: Vec<Lane>,
    columns: usize,
}

impl Lanes {
    /// Columns of length `dim`, one after the other, at most [`LANES`].
    pub fn of(columns: &[f64], dim: usize) -> Self {
        let mut rows = vec![[0.0; LANES]; dim];
        for (lane, column) in columns.chunks(dim.max(1)).enumerate() {
            rows.iter_mut().zip(column).for_each(|(row, &value)| row[lane] = value);
        }
        Lanes { rows, columns: columns.len() / dim.max(1) }
    }

    pub fn into_columns(self) -> Vec<f64> {
        (0..self.columns).flat_map(|lane| self.rows.iter().map(move |row| row[lane])).collect()
    }

    /// The product A X.
    pub fn times(self, matrix: &SymmetricMatrix) -> Self {
        let mut product = vec![[0.0; LANES]; self.rows.len()];
        Arch::new().dispatch(Times { matrix, x: &self.rows, y: &mut product });
        Lanes { rows: product, ..self }
    }

    /// The solution Y of L Y = X, in the order of elimination.
    pub fn forward(self, factor: &Cholesky) -> Self {
        self.swept(factor, Direction::Forward)
    }

    /// The solution Y of L' Y = X, in the order of elimination.
    pub fn backward(self, factor: &Cholesky) -> Self {
        self.swept(factor, Direction::Backward)
    }

    fn swept(mut self, factor: &Cholesky, direction: Direction) -> Self {
        match factor.block_columns() {
            Some((nodes, values)) => Arch::new().dispatch(LaneSweep { nodes, values, x: &mut self.rows, direction }),
            // Nothing passes for a solution.
            None => self.rows.fill([f64::NAN; LANES]),
        }
        self
    }
}

#[inline(always)]
fn subtract(target: &mut Lane, factor: f64, other: &Lane) {
    for lane in 0..LANES {
        target[lane] -= factor * other[lane];
    }
}

struct Times<'a> {
    matrix: &'a SymmetricMatrix,
    x: &'a [Lane],
    y: &'a mut [Lane],
}

impl WithSimd for Times<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Times { matrix, x, y } = self;
        for (column, at_column) in x.iter().enumerate() {
            let mut sum = [0.0; LANES];
            for (row, value) in matrix.lower().column(column) {
                subtract(&mut sum, -value, &x[row]);
                if row != column {
                    subtract(&mut y[row], -value, at_column);
                }
            }
            subtract(&mut y[column], -1.0, &sum);
        }
    }
}

/// A block column of a factor.
struct Block<'a> {
    /// Its columns in the factor.
    own: Range<usize>,
    /// Its entries, column by column: the rows of its own columns, then those below.
    values: &'a [f64],
    below: &'a [usize],
}

impl<'a> Block<'a> {
    #[inline(always)]
    fn of(nodes: &'a SymbolicSupernodalCholesky<usize>, values: &'a [f64], node: usize) -> Self {
        let own = nodes.supernode_begin()[node]..nodes.supernode_end()[node];
        let places = nodes.col_ptr_for_val();
        let values = &values[places[node]..places[node + 1]];
        let first = nodes.col_ptr_for_row_idx()[node];
        let below = &nodes.row_idx()[first..first + values.len() / own.len() - own.len()];
        Block { own, values, below }
    }

    #[inline(always)]
    fn column(&self, j: usize) -> &'a [f64] {
        let height = self.own.len() + self.below.len();
        &self.values[j * height..(j + 1) * height]
    }

    /// The entries of N columns from the first one, below these.
    #[inline(always)]
    fn columns<const N: usize>(&self, first: usize) -> [&'a [f64]; N] {
        std::array::from_fn(|k| &self.column(first + k)[first + N..])
    }

    /// Solves for N unknowns from the first one, and takes their share out of the rows after them. A row has P vectors.
    #[inline(always)]
    fn forward<S: Simd, const P: usize, const N: usize>(&self, simd: S, first: usize, rows: &mut [[S::f64s; P]]) {
        let (own, after) = rows.split_at_mut(first + N);
        for j in first..first + N {
            let column = self.column(j);
            let known = divided(simd, own[j], column[j]);
            own[j] = known;
            for i in j + 1..first + N {
                own[i] = without(simd, own[i], column[i], known);
            }
        }
        let known: [[S::f64s; P]; N] = std::array::from_fn(|k| own[first + k]);
        let columns = self.columns::<N>(first).map(|column| &column[..after.len()]);
        for (i, row) in after.iter_mut().enumerate() {
            for k in 0..N {
                *row = without(simd, *row, columns[k][i], known[k]);
            }
        }
    }

    /// Solves for the N unknowns from the first one, with the rows after them known.
    #[inline(always)]
    fn backward<S: Simd, const P: usize, const N: usize>(&self, simd: S, first: usize, rows: &mut [[S::f64s; P]]) {
        let (own, after) = rows.split_at_mut(first + N);
        let columns = self.columns::<N>(first).map(|column| &column[..after.len()]);
        let mut left: [[S::f64s; P]; N] = std::array::from_fn(|k| own[first + k]);
        for (i, row) in after.iter().enumerate() {
            for k in 0..N {
                left[k] = without(simd, left[k], columns[k][i], *row);
            }
        }
        for k in (0..N).rev() {
            let column = self.column(first + k);
            for i in k + 1..N {
                left[k] = without(simd, left[k], column[first + i], own[first + i]);
            }
            own[first + k] = divided(simd, left[k], column[first + k]);
        }
    }
}

/// A row minus a factor times another one.
#[inline(always)]
fn without<S: Simd, const P: usize>(simd: S, mut row: [S::f64s; P], factor: f64, other: [S::f64s; P]) -> [S::f64s; P] {
    let factor = simd.splat_f64s(factor);
    for (vector, other) in row.iter_mut().zip(other) {
        *vector = simd.negate_mul_add_e_f64s(factor, other, *vector);
    }
    row
}

#[inline(always)]
fn divided<S: Simd, const P: usize>(simd: S, mut row: [S::f64s; P], by: f64) -> [S::f64s; P] {
    let by = simd.splat_f64s(by);
    for vector in &mut row {
        *vector = simd.div_f64s(*vector, by);
    }
    row
}

/// A sweep through the block columns of a factor.
struct LaneSweep<'a> {
    nodes: &'a SymbolicSupernodalCholesky<usize>,
    values: &'a [f64],
    x: &'a mut [Lane],
    direction: Direction,
}

#[derive(Clone, Copy)]
enum Direction {
    Forward,
    Backward,
}

impl WithSimd for LaneSweep<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        match LANES / S::F64_LANES {
            1 => self.run::<S, 1>(simd),
            2 => self.run::<S, 2>(simd),
            _ => self.run::<Scalar, LANES>(Scalar),
        }
    }
}

impl LaneSweep<'_> {
    /// Runs with P vectors for each row.
    #[inline(always)]
    fn run<S: Simd, const P: usize>(self, simd: S) {
        let LaneSweep { nodes, values, x, direction } = self;
        let mut buffer: Vec<f64> = Vec::new();
        let count = nodes.n_supernodes();
        for step in 0..count {
            let block = match direction {
                Direction::Forward => Block::of(nodes, values, step),
                Direction::Backward => Block::of(nodes, values, count - 1 - step),
            };
            let width = block.own.len();
            buffer.clear();
            buffer.extend_from_slice(x[block.own.clone()].as_flattened());
            match direction {
                Direction::Forward => buffer.resize(LANES * (width + block.below.len()), 0.0),
                Direction::Backward => block.below.iter().for_each(|&row| buffer.extend_from_slice(&x[row])),
            }
            let rows = S::as_mut_simd_f64s(&mut buffer).0.as_chunks_mut::<P>().0;
            let single = width - width % TOGETHER;
            match direction {
                Direction::Forward => {
                    for first in (0..single).step_by(TOGETHER) {
                        block.forward::<S, P, TOGETHER>(simd, first, rows);
                    }
                    for first in single..width {
                        block.forward::<S, P, 1>(simd, first, rows);
                    }
                }
                Direction::Backward => {
                    for first in (single..width).rev() {
                        block.backward::<S, P, 1>(simd, first, rows);
                    }
                    for first in (0..single).step_by(TOGETHER).rev() {
                        block.backward::<S, P, TOGETHER>(simd, first, rows);
                    }
                }
            }
            let (own, below) = buffer.as_chunks::<LANES>().0.split_at(width);
            if let Direction::Forward = direction {
                block.below.iter().zip(below).for_each(|(&row, share)| subtract(&mut x[row], -1.0, share));
            }
            x[block.own].copy_from_slice(own);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::SparseMatrix;
    use crate::linear::{Analysis, dot};

    #[test]
    fn sweeps_and_products_are_those_of_single_columns() {
        // A grid of springs, with a factor that has blocks.
        let (side, mut entries) = (9, Vec::new());
        for node in 0..side * side {
            entries.push((node, node, 4.5));
            for other in [node + 1, node + side].into_iter().filter(|other| *other < side * side) {
                entries.push((other, node, -1.0));
            }
        }
        let lower = SparseMatrix::from_triplets(side * side, side * side, &entries).unwrap();
        let matrix = SymmetricMatrix::from_lower(lower).unwrap();
        let factor = Analysis::sparse_with_last(&matrix, &[]).unwrap().factor(&matrix).unwrap();
        let columns: Vec<f64> = (0..3 * side * side).map(|i| ((i * i) % 17) as f64 - 8.0).collect();
        let lanes = || Lanes::of(&columns, side * side);
        let close = |one: &[f64], other: &[f64]| {
            let off: Vec<f64> = one.iter().zip(other).map(|(a, b)| a - b).collect();
            assert!(dot(&off, &off) <= 1e-26 * dot(one, one));
        };
        close(&lanes().into_columns(), &columns);
        let ordered = matrix.ordered(factor.order()).unwrap();
        let solved = lanes().times(&ordered).forward(&factor).backward(&factor);
        close(&solved.into_columns(), &columns);
        let product: Vec<f64> = columns.chunks(side * side).flat_map(|column| matrix.mul(column)).collect();
        close(&lanes().times(&matrix).into_columns(), &product);
    }
}
