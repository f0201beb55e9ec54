//! The entries of `A^-1` in the pattern of the factor, at the cost of about two factorisations.
//!
//! With a block column (L_JJ, L_RJ) of the factor and `Y = L_RJ L_JJ^-1`, from the last block column to the first,
//!
//! ```text
//! Z_RJ = -Z_RR Y,     Z_JJ = (L_JJ L_JJ')^-1 - Y' Z_RJ
//! ```
//!
//! Z_RR is known by then: for every column in R, the rows of R after it are part of its pattern.
//!
//! # Source
//! K. Takahashi, J. Fagan, M.-S. Chin, *Formation of a sparse bus impedance matrix and its application to short circuit
//! study*, PICA (1973) 63-69; Y. E. Campbell, T. A. Davis, *Computing the sparse inverse subset*, Tech. Rep. TR-95-021,
//! University of Florida (1995).

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use faer::{Accum, Mat, MatMut, Par};

use super::Cholesky;
use super::columns::places;
use super::factor::{FactorError, call, zeros};

/// Number of factorisations that take as many multiplications.
pub const FACTORISATIONS: f64 = 2.0;

/// Entries of the inverse of a factorised matrix.
#[derive(Debug)]
pub struct SelectedInverse<'a> {
    nodes: &'a SymbolicSupernodalCholesky<usize>,
    /// Block columns as in the factor.
    values: Vec<f64>,
    /// The place of each column in the order of elimination.
    place: Vec<usize>,
    /// The block column of each place.
    node_of: Vec<usize>,
}

impl Cholesky {
    /// The entries of the inverse in the pattern of the factor; `None` if memory does not suffice.
    pub fn selected_inverse(&self) -> Option<SelectedInverse<'_>> {
        let nodes = self.supernodes()?;
        let values = zeros(self.entries()).ok()?;
        let mut node_of = vec![0; self.dim()];
        for node in 0..nodes.n_supernodes() {
            node_of[nodes.supernode_begin()[node]..nodes.supernode_end()[node]].fill(node);
        }
        let mut inverse = SelectedInverse { nodes, values, place: places(self.order()), node_of };
        call(|| {
            (0..nodes.n_supernodes()).rev().for_each(|node| inverse.find(node, self.block_column(node)));
            Ok::<(), FactorError>(())
        })
        .ok()?;
        Some(inverse)
    }
}

impl SelectedInverse<'_> {
    /// Computes block column `node` with the factor `factor`; those after it are known.
    fn find(&mut self, node: usize, factor: Mat<f64>) {
        let columns = factor.ncols();
        let rows = factor.nrows() - columns;
        let (own, below) = factor.as_ref().split_at_row(columns);
        let mut halves = Mat::<f64>::identity(columns, columns);
        solve_lower_triangular_in_place(own, halves.as_mut(), Par::Seq);
        let mut known = Mat::<f64>::zeros(columns, columns);
        matmul(known.as_mut(), Accum::Replace, halves.transpose(), halves.as_ref(), 1.0, Par::Seq);
        let mut beside = Mat::<f64>::zeros(rows, columns);
        if rows > 0 {
            // Y' from L_JJ' Y' = L_RJ'.
            let mut y = below.to_owned();
            solve_upper_triangular_in_place(own.transpose(), y.as_mut().transpose_mut(), Par::Seq);
            let around = self.around(node, rows);
            matmul(beside.as_mut(), Accum::Replace, around.as_ref(), y.as_ref(), -1.0, Par::Seq);
            matmul(known.as_mut(), Accum::Add, y.transpose(), beside.as_ref(), -1.0, Par::Seq);
        }
        let start = self.nodes.col_ptr_for_val()[node];
        let all = columns + rows;
        let target = &mut self.values[start..start + all * columns];
        let (mut own, mut below) = MatMut::from_column_major_slice_mut(target, all, columns).split_at_row_mut(columns);
        own.copy_from(&known);
        below.copy_from(&beside);
    }

    /// Z_RR of the rows R below block column `node`, both triangles.
    fn around(&self, node: usize, size: usize) -> Mat<f64> {
        let rows = self.below(node);
        let mut around = Mat::<f64>::zeros(size, size);
        let mut local: Vec<usize> = Vec::with_capacity(size);
        let mut first = 0;
        while first < size {
            let ancestor = self.node_of[rows[first]];
            let (begin, end) = (self.nodes.supernode_begin()[ancestor], self.nodes.supernode_end()[ancestor]);
            let last = first + rows[first..].iter().take_while(|&&row| row < end).count();
            let (columns, pattern) = (end - begin, self.below(ancestor));
            // Places of the rows from `first` on in the ancestor: within its columns, then in its pattern.
            local.clear();
            local.extend(rows[first..last].iter().map(|row| row - begin));
            let mut next = 0;
            for &row in &rows[last..] {
                next += pattern[next..].iter().take_while(|&&other| other < row).count();
                local.push(columns + next);
            }
            let height = columns + pattern.len();
            let block = &self.values[self.nodes.col_ptr_for_val()[ancestor]..];
            for (offset, &row) in rows[first..last].iter().enumerate() {
                let column = &block[(row - begin) * height..(row - begin + 1) * height];
                let j = first + offset;
                for (i, &place) in (j..size).zip(&local[offset..]) {
                    around[(i, j)] = column[place];
                    around[(j, i)] = column[place];
                }
            }
            first = last;
        }
        around
    }

    /// The rows below block column `node`, increasing, in the order of elimination.
    fn below(&self, node: usize) -> &[usize] {
        let starts = self.nodes.col_ptr_for_row_idx();
        &self.nodes.row_idx()[starts[node]..starts[node + 1]]
    }

    /// The entry of the inverse at two columns of the matrix; `None` outside the pattern of the factor.
    pub fn entry(&self, a: usize, b: usize) -> Option<f64> {
        let (first, second) = (self.place[a].min(self.place[b]), self.place[a].max(self.place[b]));
        let node = self.node_of[first];
        let (begin, end) = (self.nodes.supernode_begin()[node], self.nodes.supernode_end()[node]);
        let below = self.below(node);
        let row = match second < end {
            true => second - begin,
            false => end - begin + below.binary_search(&second).ok()?,
        };
        let height = end - begin + below.len();
        Some(self.values[self.nodes.col_ptr_for_val()[node] + (first - begin) * height + row])
    }

    /// `b' A^-1 b` of a vector b with few entries `(column, value)`; `None` if an entry is outside the pattern.
    pub fn product(&self, entries: &[(usize, f64)]) -> Option<f64> {
        let mut sum = 0.0;
        for &(a, first) in entries {
            for &(b, second) in entries {
                sum += first * second * self.entry(a, b)?;
            }
        }
        Some(sum)
    }
}

#[cfg(test)]
mod tests {
    use crate::{Cholesky, SparseMatrix, SymmetricMatrix};

    /// A lattice with random-looking couplings, compared with solves with unit loads.
    #[test]
    fn selected_entries_are_those_of_the_inverse() {
        let n = 17;
        let noise = |i: usize| ((i as f64 * 0.618_033_988_749_895).fract() - 0.3) * 2.0;
        let mut entries = Vec::new();
        for own in 0..n * n {
            entries.push((own, own, 9.0 + noise(own)));
            for other in [own + 1, own + n, own + n + 1].into_iter().filter(|&other| other < n * n) {
                entries.push((other, own, noise(3 * own + other)));
            }
        }
        let lower = SparseMatrix::from_triplets(n * n, n * n, &entries).unwrap();
        let matrix = SymmetricMatrix::from_lower(lower).unwrap();
        let cholesky = Cholesky::of(&matrix).unwrap();
        let inverse = cholesky.selected_inverse().unwrap();
        let mut seen = 0;
        for a in (0..n * n).step_by(7) {
            let mut unit = vec![0.0; n * n];
            unit[a] = 1.0;
            for (b, &value) in cholesky.solve(&unit).iter().enumerate() {
                if let Some(entry) = inverse.entry(a, b) {
                    seen += 1;
                    assert!((entry - value).abs() < 1e-14, "{a} {b}: {entry} {value}");
                }
            }
        }
        assert!(seen > 1000, "{seen}");
    }
}
