//! Four columns at once: sweeps through a factor, and products, in which each entry is fetched once for all four.

use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use pulp::{Arch, Simd, WithSimd};

use super::super::{Cholesky, SymmetricMatrix};

/// Columns that are treated together.
pub const LANES: usize = 4;

/// Sums of a product that run beside each other.
const SUMS: usize = 4;

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

    /// The columns, one after the other.
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
    pub fn forward(mut self, factor: &Cholesky) -> Self {
        if let Some((nodes, values)) = factor.block_columns() {
            Arch::new().dispatch(Forward(Sweep { nodes, values, x: &mut self.rows }));
        }
        self
    }

    /// The solution Y of L' Y = X, in the order of elimination.
    pub fn backward(mut self, factor: &Cholesky) -> Self {
        if let Some((nodes, values)) = factor.block_columns() {
            Arch::new().dispatch(Backward(Sweep { nodes, values, x: &mut self.rows }));
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

struct Sweep<'a> {
    nodes: &'a SymbolicSupernodalCholesky<usize>,
    values: &'a [f64],
    x: &'a mut [Lane],
}

/// A block column of a factor.
struct Block<'a> {
    /// Its first column.
    start: usize,
    width: usize,
    /// Its entries, column by column: the rows of its own columns, then those below.
    values: &'a [f64],
    /// The rows below.
    below: &'a [usize],
}

impl<'a> Sweep<'a> {
    #[inline(always)]
    fn block(&self, node: usize) -> Block<'a> {
        let nodes = self.nodes;
        let (start, end) = (nodes.supernode_begin()[node], nodes.supernode_end()[node]);
        let places = nodes.col_ptr_for_val();
        let values = &self.values[places[node]..places[node + 1]];
        let below = values.len() / (end - start) - (end - start);
        let first = nodes.col_ptr_for_row_idx()[node];
        Block { start, width: end - start, values, below: &nodes.row_idx()[first..first + below] }
    }
}

struct Forward<'a>(Sweep<'a>);

impl WithSimd for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let sweep = self.0;
        let mut sums: Vec<Lane> = Vec::new();
        for node in 0..sweep.nodes.n_supernodes() {
            let Block { start, width, values, below } = sweep.block(node);
            sums.clear();
            sums.resize(below.len(), [0.0; LANES]);
            let own = &mut sweep.x[start..start + width];
            for (j, column) in values.chunks_exact(width + below.len()).enumerate() {
                let (beside, under) = column.split_at(width);
                let entry = own[j].map(|value| value / beside[j]);
                own[j] = entry;
                own[j + 1..].iter_mut().zip(&beside[j + 1..]).for_each(|(value, &l)| subtract(value, l, &entry));
                sums.iter_mut().zip(under).for_each(|(sum, &l)| subtract(sum, -l, &entry));
            }
            below.iter().zip(&sums).for_each(|(&row, sum)| subtract(&mut sweep.x[row], 1.0, sum));
        }
    }
}

struct Backward<'a>(Sweep<'a>);

impl WithSimd for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let sweep = self.0;
        let mut known: Vec<Lane> = Vec::new();
        for node in (0..sweep.nodes.n_supernodes()).rev() {
            let Block { start, width, values, below } = sweep.block(node);
            known.clear();
            known.extend(below.iter().map(|&row| sweep.x[row]));
            let own = &mut sweep.x[start..start + width];
            for (j, column) in values.chunks_exact(width + below.len()).enumerate().rev() {
                let (beside, under) = column.split_at(width);
                let mut entry = own[j];
                own[j + 1..].iter().zip(&beside[j + 1..]).for_each(|(value, &l)| subtract(&mut entry, l, value));
                // Several sums, so that no term waits for the one before it.
                let mut sums = [[0.0; LANES]; SUMS];
                let ((fours, rest), (below, last)) = (known.as_chunks::<SUMS>(), under.as_chunks::<SUMS>());
                for (values, entries) in fours.iter().zip(below) {
                    for k in 0..SUMS {
                        subtract(&mut sums[k], -entries[k], &values[k]);
                    }
                }
                rest.iter().zip(last).for_each(|(value, &l)| subtract(&mut entry, l, value));
                sums.iter().for_each(|sum| subtract(&mut entry, 1.0, sum));
                own[j] = entry.map(|value| value / beside[j]);
            }
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
        let ordered = matrix.ordered(factor.order());
        let solved = lanes().times(&ordered).forward(&factor).backward(&factor);
        close(&solved.into_columns(), &columns);
        let product: Vec<f64> = columns.chunks(side * side).flat_map(|column| matrix.mul(column)).collect();
        close(&lanes().times(&matrix).into_columns(), &product);
    }
}
