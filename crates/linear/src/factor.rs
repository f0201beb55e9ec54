//! The values of a Cholesky factor, and the sweeps through them.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::solvers::LltError;
use faer::sparse::linalg::cholesky::supernodal;
use faer::sparse::{FaerError, SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Mat, MatMut, Par};

use crate::error::Error;
use crate::panics::guarded;

/// Reason why a factorisation did not end with a factor.
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

/// The factor of a matrix that may not be positive definite; `None` if it is not.
pub fn if_definite<T>(factor: Result<T, FactorError>) -> Result<Option<T>, Error> {
    match factor {
        Err(FactorError::NotPositiveDefinite) => Ok(None),
        factor => Ok(Some(factor?)),
    }
}

impl From<FaerError> for FactorError {
    fn from(error: FaerError) -> Self {
        FactorError::Failed(format!("{error:?}"))
    }
}

/// Calls faer; a panic in the call is a failure like any other.
pub fn call<T>(work: impl FnOnce() -> Result<T, FactorError>) -> Result<T, FactorError> {
    guarded(work).map_err(FactorError::Failed)?
}

pub(super) fn memory(request: StackReq) -> Result<MemBuffer, FactorError> {
    MemBuffer::try_new(request).map_err(|_| FactorError::Failed("out of memory".into()))
}

/// Zeros, which come untouched from the system. Memory is requested first, because a vector of zeros ends the program
/// if memory is short.
pub(super) fn zeros(count: usize) -> Result<Vec<f64>, FactorError> {
    let request = Vec::<f64>::new().try_reserve_exact(count);
    request.map_err(|_| FactorError::Failed("out of memory".into()))?;
    Ok(vec![0.0; count])
}

pub(super) type Factor<'a> = supernodal::SupernodalLltRef<'a, usize, f64>;

/// The lower triangle of a matrix in compressed columns, in the order of elimination; the rows of a column are in any
/// order.
pub(crate) struct Permuted {
    pub starts: Vec<usize>,
    pub rows: Vec<usize>,
    pub values: Vec<f64>,
}

pub(super) fn factorise(
    supernodes: &supernodal::SymbolicSupernodalCholesky<usize>,
    permuted: &Permuted,
    par: Par,
) -> Result<(Vec<f64>, f64), FactorError> {
    let mut values = zeros(supernodes.len_val())?;
    let scratch =
        supernodal::factorize_supernodal_numeric_llt_scratch::<usize, f64>(supernodes, par, Default::default());
    let mut buffer = memory(scratch)?;
    // faer takes columns in any order of their rows.
    let Permuted { starts, rows, values: entries } = permuted;
    let dim = starts.len() - 1;
    let structure = SymbolicSparseColMatRef::new_unsorted_checked(dim, dim, starts, None, rows);
    supernodal::factorize_supernodal_numeric_llt(
        &mut values,
        SparseColMatRef::new(structure, entries),
        Default::default(),
        supernodes,
        par,
        MemStack::new(&mut buffer),
        Default::default(),
    )
    .map_err(|LltError::NonPositivePivot { .. }| FactorError::NotPositiveDefinite)?;
    let of_node = |node: usize| {
        let block = Factor::new(supernodes, &values).supernode(node).val();
        (0..block.ncols()).map(move |j| block[(j, j)])
    };
    let smallest_pivot = smallest_pivot((0..supernodes.n_supernodes()).flat_map(of_node))?;
    Ok((values, smallest_pivot))
}

/// The smallest pivot, from the diagonal of the factor; an error unless all its entries are finite: every entry of the
/// factor enters the pivot of its row.
pub(super) fn smallest_pivot(mut diagonal: impl Iterator<Item = f64>) -> Result<f64, FactorError> {
    let smallest = diagonal.try_fold(f64::INFINITY, |least, entry| entry.is_finite().then(|| least.min(entry * entry)));
    smallest.ok_or(FactorError::NotPositiveDefinite)
}

/// Columns swept through a factor. If the sweep fails, every entry is NaN.
fn swept(factor: Factor, mut columns: Vec<f64>, sweep: impl FnOnce(MatMut<f64>, &mut MemStack)) -> Vec<f64> {
    let dim = factor.symbolic().nrows();
    let count = columns.len() / dim;
    let scratch = factor.symbolic().solve_in_place_scratch::<f64>(count, Par::Seq);
    let done = call(|| {
        let mut buffer = memory(scratch)?;
        sweep(MatMut::from_column_major_slice_mut(&mut columns, dim, count), MemStack::new(&mut buffer));
        Ok(())
    });
    if done.is_err() {
        columns.fill(f64::NAN);
    }
    columns
}

/// The solutions of L Y = B, both in the order of elimination.
pub(super) fn forward(factor: Factor, b: Vec<f64>) -> Vec<f64> {
    swept(factor, b, |y, stack| factor.l_solve_with_conj(Conj::No, y, Par::Seq, stack))
}

/// The solutions of L' X = Y, both in the order of elimination.
pub(super) fn backward(factor: Factor, y: Vec<f64>) -> Vec<f64> {
    swept(factor, y, |x, stack| factor.l_transpose_solve_with_conj(Conj::No, x, Par::Seq, stack))
}

/// The last `size` rows and columns of L, column by column with zeros above the diagonal.
pub(super) fn trailing_block(factor: Factor, size: usize) -> Vec<f64> {
    let first = factor.symbolic().nrows() - size;
    let mut block = vec![0.0; size * size];
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

/// The values of block column `node`.
pub(super) fn block_column(factor: Factor, node: usize) -> Mat<f64> {
    let block = factor.supernode(node).val();
    Mat::from_fn(block.nrows(), block.ncols(), |i, j| block[(i, j)])
}
