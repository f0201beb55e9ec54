//! Sparse Cholesky factorisation A = L L' on faer: analysed once, factorised as often as the values change.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::solvers::LltError;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{self as fc, supernodal};
use faer::sparse::{FaerError, SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use super::{Equilibration, SparseMatrix, SymmetricMatrix, dot, ldexp, ordering};
use crate::barrier::guarded;
use crate::error::Error;

/// Fill-reducing ordering and structure of the factor, for all matrices of one sparsity pattern.
#[derive(Clone, Debug)]
pub struct Analysis {
    symbolic: Arc<fc::SymbolicCholesky<usize>>,
    trailing: usize,
    threads: usize,
}

/// The factor L of a positive definite matrix.
#[derive(Clone, Debug)]
pub struct Cholesky {
    analysis: Analysis,
    /// Shared, because a factor is the largest thing there is.
    values: Arc<Vec<f64>>,
    smallest_pivot: f64,
}

/// Why a factorisation did not end with a factor.
#[derive(Clone, Debug, PartialEq)]
pub enum FactorError {
    /// A pivot was not positive: the matrix is not positive definite.
    NotPositiveDefinite,
    /// Memory or index range was not enough, or the analysis failed.
    Failed(String),
}

impl From<FactorError> for Error {
    fn from(error: FactorError) -> Self {
        match error {
            FactorError::NotPositiveDefinite => {
                Error::NotConvex { evidence: "a Cholesky pivot is not positive".into() }
            }
            FactorError::Failed(reason) => Error::Numerical { step: "sparse Cholesky factorisation", reason },
        }
    }
}

impl From<FaerError> for FactorError {
    fn from(error: FaerError) -> Self {
        FactorError::Failed(format!("{error:?}"))
    }
}

fn structure(matrix: &SparseMatrix) -> SymbolicSparseColMatRef<'_, usize> {
    SymbolicSparseColMatRef::new_checked(
        matrix.rows(),
        matrix.columns(),
        matrix.column_starts(),
        None,
        matrix.row_indices(),
    )
}

/// A call of faer: a panic in it is a failure like any other.
fn call<T>(work: impl FnOnce() -> Result<T, FactorError>) -> Result<T, FactorError> {
    guarded(work).map_err(FactorError::Failed)?
}

/// A sweep of `x` through a factor of `dim` columns. Should it fail, or `x` not fit, then nothing in it is a number, which
/// no certificate accepts.
fn swept(mut x: Vec<f64>, dim: usize, sweep: impl FnOnce(MatMut<'_, f64>) -> Result<(), FactorError>) -> Vec<f64> {
    let rows = x.len();
    if rows != dim || call(|| sweep(MatMut::from_column_major_slice_mut(&mut x, rows, 1))).is_err() {
        x.fill(f64::NAN);
    }
    x
}

fn memory(request: faer::dyn_stack::StackReq) -> Result<MemBuffer, FactorError> {
    MemBuffer::try_new(request).map_err(|_| FactorError::Failed("out of memory".into()))
}

impl Analysis {
    /// Orders and analyses the pattern of `matrix`.
    ///
    /// # Errors
    /// [`FactorError::Failed`] when memory or the index range does not suffice.
    pub fn of(matrix: &SymmetricMatrix) -> Result<Self, FactorError> {
        Self::with_last(matrix, &[])
    }

    /// As [`Analysis::of`], with the columns of `last` eliminated last, in the order given: the trailing block of the
    /// factor is then that of their Schur complement.
    ///
    /// # Errors
    /// As [`Analysis::of`].
    pub fn with_last(matrix: &SymmetricMatrix, last: &[usize]) -> Result<Self, FactorError> {
        let lower = matrix.lower();
        let order = call(|| ordering::order(lower, last))?;
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(position, &column)| place[column] = position);
        let params = fc::CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let symbolic = call(|| {
            let order = fc::SymmetricOrdering::Custom(PermRef::new_checked(&order, &place, order.len()));
            Ok(fc::factorize_symbolic_cholesky(structure(lower), Side::Lower, order, params)?)
        })?;
        Ok(Analysis { symbolic: Arc::new(symbolic), trailing: last.len(), threads: 1 })
    }

    /// The same analysis, whose factorisations use so many threads.
    pub fn with_threads(self, threads: usize) -> Self {
        Analysis { threads, ..self }
    }

    /// Number of values of the factor, zeros inside supernodes included.
    pub fn factor_entries(&self) -> usize {
        self.symbolic.len_val()
    }

    /// Factorises `matrix`, whose pattern must be the analysed one.
    ///
    /// # Errors
    /// [`FactorError::NotPositiveDefinite`] for a pivot that is not positive.
    pub fn factor(&self, matrix: &SymmetricMatrix) -> Result<Cholesky, FactorError> {
        self.factor_entries_of(matrix, |_, _, value| value)
    }

    /// Factorises the equilibrated `c D A D` of `matrix` without building it.
    ///
    /// # Errors
    /// As [`Analysis::factor`].
    pub fn factor_equilibrated(
        &self,
        matrix: &SymmetricMatrix,
        equilibration: &Equilibration,
    ) -> Result<Cholesky, FactorError> {
        let scale = &equilibration.diagonal;
        let entry = |row: usize, column: usize, value| ldexp(value, equilibration.factor + scale[row] + scale[column]);
        self.factor_entries_of(matrix, entry)
    }

    fn factor_entries_of(
        &self,
        matrix: &SymmetricMatrix,
        entry: impl Fn(usize, usize, f64) -> f64,
    ) -> Result<Cholesky, FactorError> {
        let size = self.symbolic.len_val();
        // Asked for first, because a vector of zeros would end the program; the zeros come untouched from the system.
        let request = Vec::<f64>::new().try_reserve_exact(size);
        request.map_err(|_| FactorError::Failed("out of memory".into()))?;
        let mut values = vec![0.0; size];
        let par = if self.threads > 1 { Par::rayon(self.threads) } else { Par::Seq };
        let Some(supernodes) = self.supernodes() else {
            // Only a matrix without columns has none.
            return Ok(Cholesky { analysis: self.clone(), values: Arc::new(values), smallest_pivot: f64::INFINITY });
        };
        let permuted = self.permuted(matrix.lower(), entry);
        call(|| {
            let scratch = supernodal::factorize_supernodal_numeric_llt_scratch::<usize, f64>;
            let mut buffer = memory(scratch(supernodes, par, Default::default()))?;
            // faer takes columns in any order of their rows.
            let structure = SymbolicSparseColMatRef::new_unsorted_checked(
                permuted.rows(),
                permuted.columns(),
                permuted.column_starts(),
                None,
                permuted.row_indices(),
            );
            let numeric = supernodal::factorize_supernodal_numeric_llt(
                &mut values,
                SparseColMatRef::new(structure, permuted.values()),
                Default::default(),
                supernodes,
                par,
                MemStack::new(&mut buffer),
                Default::default(),
            );
            numeric.map(drop).map_err(|LltError::NonPositivePivot { .. }| FactorError::NotPositiveDefinite)
        })?;
        let (smallest_pivot, finite) = pivots(supernodes, &values);
        if finite {
            Ok(Cholesky { analysis: self.clone(), values: Arc::new(values), smallest_pivot })
        } else {
            Err(FactorError::NotPositiveDefinite)
        }
    }

    /// The lower triangle of P A P', rows in no order, each entry as `entry(row, column, value)` makes it.
    fn permuted(&self, lower: &SparseMatrix, entry: impl Fn(usize, usize, f64) -> f64) -> SparseMatrix {
        let place = self.symbolic.perm().map_or(&[][..], |perm| perm.arrays().1);
        let mut starts = vec![0_usize; lower.columns() + 1];
        for (column, &to) in place.iter().enumerate() {
            lower.column(column).for_each(|(row, _)| starts[to.min(place[row]) + 1] += 1);
        }
        (0..lower.columns()).for_each(|column| starts[column + 1] += starts[column]);
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
        SparseMatrix::from_parts(lower.rows(), starts, rows, values)
    }

    fn supernodes(&self) -> Option<&supernodal::SymbolicSupernodalCholesky<usize>> {
        match self.symbolic.raw() {
            fc::SymbolicCholeskyRaw::Supernodal(inner) => Some(inner),
            fc::SymbolicCholeskyRaw::Simplicial(_) => None,
        }
    }
}

impl Cholesky {
    /// Analyses and factorises `matrix`.
    ///
    /// # Errors
    /// As [`Analysis::of`] and [`Analysis::factor`].
    pub fn of(matrix: &SymmetricMatrix) -> Result<Self, FactorError> {
        Analysis::of(matrix)?.factor(matrix)
    }

    /// Number of rows and of columns.
    pub fn dim(&self) -> usize {
        self.analysis.symbolic.nrows()
    }

    /// Number of values of the factor, zeros inside supernodes included.
    pub fn entries(&self) -> usize {
        self.values.len()
    }

    /// The solution x of A x = b, length `dim`.
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        let symbolic = &*self.analysis.symbolic;
        swept(b.to_vec(), self.dim(), |x| {
            let mut buffer = memory(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq))?;
            let stack = MemStack::new(&mut buffer);
            fc::LltRef::new(symbolic, &self.values).solve_in_place_with_conj(Conj::No, x, Par::Seq, stack);
            Ok(())
        })
    }

    /// `b' A^-1 b`: the squared length of L^-1 P b, by one sweep where a solution takes two.
    pub fn inverse_product(&self, b: &[f64]) -> f64 {
        match self.supernodes() {
            Some(_) => {
                let y = self.forward(b);
                dot(&y, &y)
            }
            None => dot(b, &self.solve(b)),
        }
    }

    /// The sweep L y = P b through the factor, in the order of elimination; its last entries belong to the columns that
    /// were put last.
    pub fn forward(&self, b: &[f64]) -> Vec<f64> {
        let Some(factor) = self.supernodes() else { return Vec::new() };
        swept(self.order().iter().map(|&column| b[column]).collect(), self.dim(), |y| {
            let mut buffer = memory(factor.symbolic().solve_in_place_scratch::<f64>(1, Par::Seq))?;
            factor.l_solve_with_conj(Conj::No, y, Par::Seq, MemStack::new(&mut buffer));
            Ok(())
        })
    }

    /// The sweep L' P x = y, `y` in the order of elimination, `x` in that of the matrix.
    pub fn backward(&self, y: &[f64]) -> Vec<f64> {
        let Some(factor) = self.supernodes() else { return Vec::new() };
        let ordered = swept(y.to_vec(), self.dim(), |x| {
            let mut buffer = memory(factor.symbolic().solve_in_place_scratch::<f64>(1, Par::Seq))?;
            factor.l_transpose_solve_with_conj(Conj::No, x, Par::Seq, MemStack::new(&mut buffer));
            Ok(())
        });
        let mut x = vec![0.0; ordered.len()];
        self.order().iter().zip(&ordered).for_each(|(&column, &value)| x[column] = value);
        x
    }

    /// The trailing block of L that belongs to the columns put last: m x m, lower triangle, column by column with zeros
    /// above the diagonal. Its product with its transpose is their Schur complement.
    pub fn trailing_block(&self) -> Vec<f64> {
        let (size, dim) = (self.analysis.trailing, self.analysis.symbolic.nrows());
        let first = dim - size;
        let mut block = vec![0.0; size * size];
        let Some(factor) = self.supernodes() else { return block };
        for node in 0..factor.symbolic().n_supernodes() {
            let node = factor.supernode(node);
            let (start, values) = (node.start(), node.val());
            for j in first.saturating_sub(start)..values.ncols() {
                let column = start + j - first;
                for i in j..values.ncols() {
                    block[column * size + start + i - first] = values[(i, j)];
                }
                for (i, &row) in node.pattern().iter().enumerate() {
                    block[column * size + row - first] = values[(values.ncols() + i, j)];
                }
            }
        }
        block
    }

    fn order(&self) -> &[usize] {
        self.analysis.symbolic.perm().map_or(&[], |perm| perm.arrays().0)
    }

    fn supernodes(&self) -> Option<supernodal::SupernodalLltRef<'_, usize, f64>> {
        self.analysis.supernodes().map(|inner| supernodal::SupernodalLltRef::new(inner, &self.values))
    }

    /// The smallest pivot, min over j of L_jj^2: small against the diagonal of A when A is close to singular.
    pub fn smallest_pivot(&self) -> f64 {
        self.smallest_pivot
    }
}

/// The smallest pivot, and are all entries finite? Every entry enters the pivot of its row, which tells.
fn pivots(supernodes: &supernodal::SymbolicSupernodalCholesky<usize>, values: &[f64]) -> (f64, bool) {
    let (mut smallest, mut finite) = (f64::INFINITY, true);
    let factor = supernodal::SupernodalLltRef::new(supernodes, values);
    for node in 0..supernodes.n_supernodes() {
        let block = factor.supernode(node).val();
        for j in 0..block.ncols() {
            let entry: f64 = block[(j, j)];
            smallest = smallest.min(entry * entry);
            finite &= entry.is_finite();
        }
    }
    (smallest, finite)
}
