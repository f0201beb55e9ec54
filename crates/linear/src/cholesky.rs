//! Sparse Cholesky factorisation A = L L' on faer: one analysis, and one factorisation for each change of the values.

use std::sync::Arc;

use faer::Side;
use faer::perm::PermRef;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{self as fc, supernodal};

use super::columns::{group_starts, places};
use super::factor::{self, Factor, FactorError, Permuted, call};
use super::{Equilibration, LowerTriangle, SparseMatrix, SymmetricMatrix, dot, ldexp, ordering};
use crate::error::Error;

/// From this share of all entries on, a lower triangle is dense: no order saves anything.
const DENSE: f64 = 0.6;

/// Smaller matrices keep the sparse factor: its one block column is a whole triangle as well, and no time is gained.
const LEAST_DENSE: usize = 8;

/// Fill-reducing ordering and structure of the factor, for all matrices of one sparsity pattern.
#[derive(Clone, Debug)]
pub struct Analysis {
    structure: Structure,
    trailing: usize,
    threads: usize,
}

#[derive(Clone, Debug)]
enum Structure {
    /// Block columns.
    Sparse(Arc<fc::SymbolicCholesky<usize>>),
    /// A whole triangle, with the columns in the order of elimination.
    Dense(Arc<Vec<usize>>),
}

/// The factor L of a symmetric positive definite matrix K = L L', sparse, its unknowns in an order with little fill-in.
#[derive(Clone, Debug)]
pub struct Cholesky {
    analysis: Analysis,
    /// Of a whole triangle or of block columns; shared, because a factor is the largest object in memory.
    values: Arc<Vec<f64>>,
    smallest_pivot: f64,
}

impl Analysis {
    /// Orders and analyses the pattern of `matrix`.
    pub fn of(matrix: &SymmetricMatrix) -> Result<Self, FactorError> {
        Self::with_last(matrix, &[])
    }

    /// As [`Analysis::of`], with the columns of `last` eliminated last, in the order given: the trailing block of the
    /// factor is then that of their Schur complement.
    pub fn with_last(matrix: &SymmetricMatrix, last: &[usize]) -> Result<Self, FactorError> {
        if !Self::is_dense_for(matrix) {
            return Self::sparse_with_last(matrix, last);
        }
        let mut comes_last = vec![false; matrix.dim()];
        last.iter().for_each(|&column| comes_last[column] = true);
        let before = (0..matrix.dim()).filter(|&column| !comes_last[column]);
        let order = before.chain(last.iter().copied()).collect();
        Ok(Analysis { structure: Structure::Dense(Arc::new(order)), trailing: last.len(), threads: 1 })
    }

    /// Returns `true` if the factor of `matrix` is stored as a whole triangle.
    pub fn is_dense_for(matrix: &SymmetricMatrix) -> bool {
        let dim = matrix.dim() as f64;
        matrix.dim() >= LEAST_DENSE && matrix.lower().entries() as f64 >= DENSE * dim * (dim + 1.0) / 2.0
    }

    /// As [`Analysis::with_last`], for a factor in block columns.
    pub fn sparse_with_last(matrix: &SymmetricMatrix, last: &[usize]) -> Result<Self, FactorError> {
        let lower = matrix.lower();
        let order = call(|| ordering::order(lower, last))?;
        let place = places(&order);
        let params = fc::CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let symbolic = call(|| {
            let order = fc::SymmetricOrdering::Custom(PermRef::new_checked(&order, &place, order.len()));
            let rows: Vec<usize> = lower.row_indices().map(|row| row as usize).collect();
            let (dim, starts) = (lower.columns(), lower.column_starts());
            let structure = SymbolicSparseColMatRef::new_checked(dim, dim, starts, None, &rows);
            Ok(fc::factorize_symbolic_cholesky(structure, Side::Lower, order, params)?)
        })?;
        Ok(Analysis { structure: Structure::Sparse(Arc::new(symbolic)), trailing: last.len(), threads: 1 })
    }

    /// The same with factors on so many threads.
    pub fn with_threads(self, threads: usize) -> Self {
        Analysis { threads, ..self }
    }

    /// Returns `true` if the factor is stored as a whole triangle.
    pub fn is_dense(&self) -> bool {
        matches!(self.structure, Structure::Dense(_))
    }

    /// Number of values that a factor with this analysis has, zeros inside supernodes included.
    pub fn factor_entries(&self) -> usize {
        match &self.structure {
            Structure::Sparse(symbolic) => symbolic.len_val(),
            Structure::Dense(order) => order.len() * order.len(),
        }
    }

    /// Number of multiplications of a factorisation, counted as if each column were eliminated by itself.
    pub fn multiplications(&self) -> f64 {
        if let Structure::Dense(order) = &self.structure {
            let dim = order.len() as f64;
            return dim * (dim + 1.0) * (2.0 * dim + 1.0) / 12.0;
        }
        let Some(nodes) = self.supernodes() else { return 0.0 };
        let (starts, below) = (nodes.supernode_begin(), nodes.col_ptr_for_row_idx());
        (0..nodes.n_supernodes())
            .map(|node| {
                let (columns, rows) = (nodes.supernode_end()[node] - starts[node], below[node + 1] - below[node]);
                (0..columns).map(|column| ((columns - column + rows) as f64).powi(2) / 2.0).sum::<f64>()
            })
            .sum()
    }

    /// Factorises `matrix`, which must have the analysed pattern.
    pub fn factor(&self, matrix: &SymmetricMatrix) -> Result<Cholesky, FactorError> {
        self.factor_last(matrix.clone())
    }

    /// As [`Analysis::factor`], for a matrix that is no longer needed: its values are freed before those of the factor
    /// are made.
    pub fn factor_last(&self, matrix: SymmetricMatrix) -> Result<Cholesky, FactorError> {
        if let Structure::Dense(order) = &self.structure {
            return self.factorised_densely(order, matrix.lower());
        }
        let permuted = self.permuted(matrix.lower(), |_, _, value| value);
        drop(matrix);
        self.factorised(permuted)
    }

    /// Factorises the equilibrated `c D A D` of `matrix`, which is not built for a factor in block columns.
    pub fn factor_equilibrated(
        &self,
        matrix: &SymmetricMatrix,
        equilibration: &Equilibration,
    ) -> Result<Cholesky, FactorError> {
        if self.is_dense() {
            return self.factor(&equilibration.apply(matrix));
        }
        let scale = &equilibration.diagonal;
        let entry = |row: usize, column: usize, value| ldexp(value, equilibration.factor + scale[row] + scale[column]);
        self.factorised(self.permuted(matrix.lower(), entry))
    }

    fn factorised_densely(&self, order: &[usize], lower: &SparseMatrix) -> Result<Cholesky, FactorError> {
        let (dim, place) = (order.len(), places(order));
        let is_in_order = place.is_sorted();
        let mut values = factor::zeros(dim * dim)?;
        for (column, &to) in place.iter().enumerate() {
            let (rows, own) = lower.column_slices(column);
            if is_in_order && rows.len() + column == dim {
                values[column * dim + column..][..own.len()].copy_from_slice(own);
                continue;
            }
            for (&row, &value) in rows.iter().zip(own) {
                let row = place[row as usize];
                values[to.min(row) * dim + to.max(row)] = value;
            }
        }
        let triangle = factor::factorised_densely(dim, values, self.threads)?;
        let smallest_pivot = factor::smallest_pivot((0..dim).map(|column| triangle.diagonal(column)))?;
        Ok(Cholesky { analysis: self.clone(), values: triangle.values().clone(), smallest_pivot })
    }

    fn factorised(&self, permuted: Permuted) -> Result<Cholesky, FactorError> {
        let (values, smallest_pivot) = match self.supernodes() {
            Some(supernodes) => call(|| factor::factorise(supernodes, &permuted, factor::par(self.threads)))?,
            // Only a matrix without columns has no supernodes.
            None => (Vec::new(), f64::INFINITY),
        };
        Ok(Cholesky { analysis: self.clone(), values: Arc::new(values), smallest_pivot })
    }

    /// The structure of the lower triangle of P A P', rows in no order, and its entries as `entry(row, column, value)`
    /// makes them.
    pub(crate) fn permuted(&self, lower: &SparseMatrix, entry: impl Fn(usize, usize, f64) -> f64) -> Permuted {
        let place = places(self.order());
        let first = |(row, column, _): (usize, usize, f64)| place[column].min(place[row]);
        let starts = group_starts(lower.columns(), lower.triplets().map(first));
        let mut next = starts.clone();
        let (mut rows, mut values) = (vec![0; lower.entries()], vec![0.0; lower.entries()]);
        for (column, &to) in place.iter().enumerate() {
            for (row, value) in lower.column(column) {
                let (first, second) = (to.min(place[row]), to.max(place[row]));
                rows[next[first]] = second;
                values[next[first]] = entry(row, column, value);
                next[first] += 1;
            }
        }
        Permuted { starts, rows, values }
    }

    /// The columns of the matrix in the order in which the analysis eliminates them.
    pub fn order(&self) -> &[usize] {
        match &self.structure {
            Structure::Sparse(symbolic) => symbolic.perm().map_or(&[], |perm| perm.arrays().0),
            Structure::Dense(order) => order,
        }
    }

    /// The block columns; `None` for a whole triangle, and for a matrix without columns.
    pub(crate) fn supernodes(&self) -> Option<&supernodal::SymbolicSupernodalCholesky<usize>> {
        let Structure::Sparse(symbolic) = &self.structure else { return None };
        match symbolic.raw() {
            fc::SymbolicCholeskyRaw::Supernodal(inner) => Some(inner),
            fc::SymbolicCholeskyRaw::Simplicial(_) => None,
        }
    }
}

impl Cholesky {
    /// Analyses and factorises `matrix`.
    ///
    /// # Errors
    /// [`Error::NotConvex`] for a matrix that is not positive definite, [`Error::Numerical`] for a lack of memory.
    pub fn of(matrix: &SymmetricMatrix) -> Result<Self, Error> {
        Self::on(matrix, 1)
    }

    /// The same with this number of threads.
    ///
    /// # Errors
    /// As [`Cholesky::of`].
    pub fn on(matrix: &SymmetricMatrix, threads: usize) -> Result<Self, Error> {
        Ok(Analysis::of(matrix)?.with_threads(threads).factor(matrix)?)
    }

    /// Number of rows and columns of the factorised matrix.
    pub fn dim(&self) -> usize {
        self.order().len()
    }

    /// Returns `true` if it is stored as a whole triangle.
    pub fn is_dense(&self) -> bool {
        self.analysis.is_dense()
    }

    /// Number of values of this factor, zeros inside supernodes included.
    pub fn entries(&self) -> usize {
        self.analysis.factor_entries()
    }

    /// The solution x of A x = b, length `dim`. If faer fails or b does not fit, every entry of x is NaN, which no
    /// certificate accepts.
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        if b.len() == self.dim() { self.backward(self.forward(b)) } else { vec![f64::NAN; b.len()] }
    }

    /// `b' A^-1 b`: the squared length of L^-1 P b, by one sweep; a solution takes two.
    pub fn inverse_product(&self, b: &[f64]) -> f64 {
        let y = self.forward(b);
        dot(&y, &y)
    }

    /// The sweep L y = P b through the factor, in the order of elimination; its last entries belong to the columns that
    /// were put last.
    pub fn forward(&self, b: &[f64]) -> Vec<f64> {
        let fits = b.len() == self.dim();
        let entry = |&column: &usize| if fits { b[column] } else { f64::NAN };
        self.forward_all(self.order().iter().map(entry).collect())
    }

    /// The sweep L' P x = y, `y` in the order of elimination, `x` in that of the matrix.
    pub fn backward(&self, y: Vec<f64>) -> Vec<f64> {
        let ordered = self.backward_all(if y.len() == self.dim() { y } else { vec![f64::NAN; self.dim()] });
        if self.order().is_sorted() {
            return ordered;
        }
        let mut x = vec![0.0; ordered.len()];
        self.order().iter().zip(&ordered).for_each(|(&column, &value)| x[column] = value);
        x
    }

    /// L^-1 X of columns X, one after the other, both in the order of elimination.
    pub fn forward_all(&self, columns: Vec<f64>) -> Vec<f64> {
        match self.triangle() {
            Some(triangle) => factor::forward_all(&triangle, columns),
            None => self.in_columns().map_or_else(Vec::new, |own| factor::swept(own, columns, false)),
        }
    }

    /// L'^-1 X of columns X, one after the other, both in the order of elimination.
    pub fn backward_all(&self, mut columns: Vec<f64>) -> Vec<f64> {
        let Some(triangle) = self.triangle() else {
            return self.in_columns().map_or_else(Vec::new, |own| factor::swept(own, columns, true));
        };
        columns.chunks_mut(self.dim()).for_each(|column| triangle.sweep(column, true));
        columns
    }

    /// The trailing block of L that belongs to the columns put last, m x m. Its product with its transpose is their
    /// Schur complement.
    pub fn trailing_block(&self) -> LowerTriangle {
        let size = self.analysis.trailing;
        let of_columns = || self.in_columns().map_or_else(Vec::new, |own| factor::trailing_block(own, size));
        self.triangle().map_or_else(|| LowerTriangle::new(size, of_columns()), |triangle| triangle.last(size))
    }

    /// The factor as a whole triangle, if it is stored so.
    fn triangle(&self) -> Option<LowerTriangle> {
        self.is_dense().then(|| LowerTriangle::new(self.dim(), self.values.clone()))
    }

    /// The factor in block columns; `None` for a whole triangle, and for a matrix without columns.
    fn in_columns(&self) -> Option<Factor<'_>> {
        Some(Factor::new(self.supernodes()?, &self.values))
    }

    pub(crate) fn supernodes(&self) -> Option<&supernodal::SymbolicSupernodalCholesky<usize>> {
        self.analysis.supernodes()
    }

    /// The values of block column `node`: the rows of its own columns, then those below.
    pub(super) fn block_column(&self, node: usize) -> faer::Mat<f64> {
        self.in_columns().map_or_else(faer::Mat::new, |own| own.supernode(node).val().to_owned())
    }

    /// Number of multiplications of its factorisation, counted as if each column were eliminated by itself.
    pub fn multiplications(&self) -> f64 {
        self.analysis.multiplications()
    }

    /// The columns of the matrix in the order in which they were eliminated.
    pub fn order(&self) -> &[usize] {
        self.analysis.order()
    }

    /// The smallest pivot, min over j of L_jj^2: small relative to the diagonal of A if A is close to singular.
    pub fn smallest_pivot(&self) -> f64 {
        self.smallest_pivot
    }
}
