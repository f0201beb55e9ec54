//! The values of a Cholesky factor, in double or in single precision, and the sweeps through them.
//!
//! Loads and answers are doubles. For a factor in single precision a load is scaled by a power of two to order one, so
//! that it neither under- nor overflows, and rounded.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::solvers::LltError;
use faer::sparse::linalg::cholesky::{self as fc, supernodal};
use faer::sparse::{FaerError, SparseColMatRef, SymbolicSparseColMatRef};
use faer::traits::RealField;
use faer::{Conj, MatMut, Par};

use super::{SparseMatrix, exponent, largest, ldexp};
use crate::error::Error;
use crate::qp::panics::guarded;

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
///
/// # Errors
/// [`Error::Numerical`] if the factorisation fails for another reason, such as memory.
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
pub(super) fn call<T>(work: impl FnOnce() -> Result<T, FactorError>) -> Result<T, FactorError> {
    guarded(work).map_err(FactorError::Failed)?
}

/// Precision of the values of a factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// Double.
    Double,
    /// Single: half the memory, about seven digits of each value.
    Single,
}

impl Width {
    /// Bytes of a value.
    pub fn bytes(self) -> usize {
        match self {
            Width::Double => size_of::<f64>(),
            Width::Single => size_of::<f32>(),
        }
    }
}

/// `f64` or `f32`.
pub(super) trait Real: RealField + Copy + Into<f64> {
    /// The nearest value.
    fn rounded(value: f64) -> Self;

    /// A load, scaled by a power of two and rounded, and the exponent of its unit; doubles are taken as they are.
    fn scaled(load: Vec<f64>) -> (Vec<Self>, i32);

    /// The answer to a load of that unit.
    fn unscaled(answer: Vec<Self>, unit: i32) -> Vec<f64>;
}

impl Real for f64 {
    fn rounded(value: f64) -> Self {
        value
    }

    fn scaled(load: Vec<f64>) -> (Vec<f64>, i32) {
        (load, 0)
    }

    fn unscaled(answer: Vec<f64>, _: i32) -> Vec<f64> {
        answer
    }
}

impl Real for f32 {
    fn rounded(value: f64) -> Self {
        value as f32
    }

    fn scaled(load: Vec<f64>) -> (Vec<f32>, i32) {
        let unit = exponent(largest(&load));
        (load.into_iter().map(|value| ldexp(value, -unit) as f32).collect(), unit)
    }

    fn unscaled(answer: Vec<f32>, unit: i32) -> Vec<f64> {
        answer.into_iter().map(|value| ldexp(value.into(), unit)).collect()
    }
}

/// Factorises the lower triangle with the structure of `permuted` and these `entries`, rows in any order.
///
/// # Errors
/// [`FactorError::NotPositiveDefinite`] for a pivot that is not positive, [`FactorError::Failed`] for lack of memory.
pub(super) fn factorise<T: Real>(
    supernodes: &supernodal::SymbolicSupernodalCholesky<usize>,
    permuted: &SparseMatrix,
    entries: &[T],
    par: Par,
) -> Result<(Vec<T>, f64), FactorError> {
    let size = supernodes.len_val();
    // Memory is requested first, because a vector of zeros ends the program if memory is short; the zeros come untouched
    // from the system.
    let request = Vec::<T>::new().try_reserve_exact(size);
    request.map_err(|_| FactorError::Failed("out of memory".into()))?;
    let mut values = vec![T::rounded(0.0); size];
    let scratch = supernodal::factorize_supernodal_numeric_llt_scratch::<usize, T>(supernodes, par, Default::default());
    let mut buffer = MemBuffer::try_new(scratch).map_err(|_| FactorError::Failed("out of memory".into()))?;
    // faer takes columns in any order of their rows.
    let structure = SymbolicSparseColMatRef::new_unsorted_checked(
        permuted.rows(),
        permuted.columns(),
        permuted.column_starts(),
        None,
        permuted.row_indices(),
    );
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
    let (smallest_pivot, finite) = pivots(supernodes, &values);
    if finite { Ok((values, smallest_pivot)) } else { Err(FactorError::NotPositiveDefinite) }
}

/// The smallest pivot, and `true` if all entries are finite: every entry enters the pivot of its row.
fn pivots<T: Real>(supernodes: &supernodal::SymbolicSupernodalCholesky<usize>, values: &[T]) -> (f64, bool) {
    let (mut smallest, mut finite) = (f64::INFINITY, true);
    let factor = supernodal::SupernodalLltRef::new(supernodes, values);
    for node in 0..supernodes.n_supernodes() {
        let block = factor.supernode(node).val();
        for j in 0..block.ncols() {
            let entry: f64 = block[(j, j)].into();
            smallest = smallest.min(entry * entry);
            finite &= entry.is_finite();
        }
    }
    (smallest, finite)
}

/// A vector swept through a factor of `dim` columns: scaled and rounded before, converted back to doubles after. If the sweep
/// fails or the vector does not fit, every entry is NaN.
fn swept<T: Real>(
    load: Vec<f64>,
    dim: usize,
    scratch: faer::dyn_stack::StackReq,
    sweep: impl FnOnce(MatMut<T>, &mut MemStack),
) -> Vec<f64> {
    let (mut x, unit) = T::scaled(load);
    let rows = x.len();
    if rows != dim {
        return vec![f64::NAN; rows];
    }
    let done = call(|| {
        let mut buffer = MemBuffer::try_new(scratch).map_err(|_| FactorError::Failed("out of memory".into()))?;
        sweep(MatMut::from_column_major_slice_mut(&mut x, rows, 1), MemStack::new(&mut buffer));
        Ok(())
    });
    if done.is_err() {
        return vec![f64::NAN; rows];
    }
    T::unscaled(x, unit)
}

/// The solution of L L' x = b, both in the order of the matrix.
pub(super) fn solve<T: Real>(symbolic: &fc::SymbolicCholesky<usize>, values: &[T], b: Vec<f64>) -> Vec<f64> {
    swept::<T>(b, symbolic.nrows(), symbolic.solve_in_place_scratch::<T>(1, Par::Seq), |x, stack| {
        fc::LltRef::new(symbolic, values).solve_in_place_with_conj(Conj::No, x, Par::Seq, stack);
    })
}

/// The solution of L y = b, both in the order of elimination.
pub(super) fn forward<T: Real>(
    nodes: &supernodal::SymbolicSupernodalCholesky<usize>,
    values: &[T],
    b: Vec<f64>,
) -> Vec<f64> {
    swept::<T>(b, nodes.nrows(), nodes.solve_in_place_scratch::<T>(1, Par::Seq), |y, stack| {
        supernodal::SupernodalLltRef::new(nodes, values).l_solve_with_conj(Conj::No, y, Par::Seq, stack);
    })
}

/// The solution of L' x = y, both in the order of elimination.
pub(super) fn backward<T: Real>(
    nodes: &supernodal::SymbolicSupernodalCholesky<usize>,
    values: &[T],
    y: Vec<f64>,
) -> Vec<f64> {
    swept::<T>(y, nodes.nrows(), nodes.solve_in_place_scratch::<T>(1, Par::Seq), |x, stack| {
        supernodal::SupernodalLltRef::new(nodes, values).l_transpose_solve_with_conj(Conj::No, x, Par::Seq, stack);
    })
}

/// The last `size` rows and columns of L, column by column with zeros above the diagonal.
pub(super) fn trailing_block<T: Real>(
    nodes: &supernodal::SymbolicSupernodalCholesky<usize>,
    values: &[T],
    first: usize,
    size: usize,
) -> Vec<f64> {
    let mut block = vec![0.0; size * size];
    let factor = supernodal::SupernodalLltRef::new(nodes, values);
    for node in 0..nodes.n_supernodes() {
        let node = factor.supernode(node);
        let (start, values) = (node.start(), node.val());
        for j in first.saturating_sub(start)..values.ncols() {
            let column = start + j - first;
            for i in j..values.ncols() {
                block[column * size + start + i - first] = values[(i, j)].into();
            }
            for (i, &row) in node.pattern().iter().enumerate() {
                block[column * size + row - first] = values[(values.ncols() + i, j)].into();
            }
        }
    }
    block
}

/// The values of block column `node`, as doubles.
pub(super) fn block_column<T: Real>(
    nodes: &supernodal::SymbolicSupernodalCholesky<usize>,
    values: &[T],
    node: usize,
) -> faer::Mat<f64> {
    let block = supernodal::SupernodalLltRef::new(nodes, values).supernode(node).val();
    faer::Mat::from_fn(block.nrows(), block.ncols(), |i, j| block[(i, j)].into())
}
