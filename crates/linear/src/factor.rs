//! The values of a Cholesky factor, sparse or dense, and the sweeps through them, on faer.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::solvers::LltError;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::sparse::linalg::cholesky::supernodal;
use faer::sparse::{FaerError, SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Accum, Conj, MatMut, MatRef, Par};

use super::dense::{LowerTriangle, subtract, wide_dot};
use crate::error::{Error, guarded};
use crate::real::for_processor;

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
pub fn if_definite<T>(factor: Result<T, FactorError>) -> Result<Option<T>, FactorError> {
    match factor {
        Err(FactorError::NotPositiveDefinite) => Ok(None),
        factor => factor.map(Some),
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

/// What `work` makes of values in place; every one is NaN if it fails.
fn in_place(mut values: Vec<f64>, work: impl FnOnce(&mut [f64]) -> Result<(), FactorError>) -> Vec<f64> {
    if call(|| work(&mut values)).is_err() {
        values.fill(f64::NAN);
    }
    values
}

/// Columns swept through a factor, `L^-1 B` or `L'^-1 Y`, in the order of elimination; NaN if the sweep fails.
pub(super) fn swept(factor: Factor, columns: Vec<f64>, is_backward: bool) -> Vec<f64> {
    let dim = factor.symbolic().nrows();
    let count = columns.len() / dim;
    let scratch = factor.symbolic().solve_in_place_scratch::<f64>(count, Par::Seq);
    in_place(columns, |columns| {
        let mut buffer = memory(scratch)?;
        let (columns, stack) = (MatMut::from_column_major_slice_mut(columns, dim, count), MemStack::new(&mut buffer));
        match is_backward {
            true => factor.l_transpose_solve_with_conj(Conj::No, columns, Par::Seq, stack),
            false => factor.l_solve_with_conj(Conj::No, columns, Par::Seq, stack),
        }
        Ok(())
    })
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

/// Columns that are swept one by one: a block of so few gains nothing.
const FEW_COLUMNS: usize = 4;

/// Up to this size a factorisation in blocks gains nothing.
const SMALL: usize = 32;

/// Factorises the symmetric matrix with this lower triangle (n x n, column by column; the entries above are not read)
/// on this number of threads.
pub(super) fn factorised_densely(
    size: usize,
    mut values: Vec<f64>,
    threads: usize,
) -> Result<LowerTriangle, FactorError> {
    if size <= SMALL {
        column_by_column(size, &mut values)?;
    } else {
        let par = par(threads);
        call(|| {
            let mut buffer = memory(cholesky_in_place_scratch::<f64>(size, par, Default::default()))?;
            let matrix = MatMut::from_column_major_slice_mut(&mut values, size, size);
            let stack = MemStack::new(&mut buffer);
            let done = cholesky_in_place(matrix, Default::default(), par, stack, Default::default());
            done.map(|_| ()).map_err(|_| FactorError::NotPositiveDefinite)
        })?;
    }
    Ok(LowerTriangle::new(size, values))
}

/// The way of faer to work on this number of threads.
pub fn par(threads: usize) -> Par {
    if threads > 1 { Par::rayon(threads) } else { Par::Seq }
}

for_processor! {
    /// The factor in place of the matrix, by pairs of columns: all others are fetched half as often.
    fn column_by_column['a](size: usize, values: &'a mut [f64]) -> Result<(), FactorError> {
        for j in (0..size).step_by(2) {
            let (left, right) = values.split_at_mut((j + 2).min(size) * size);
            let (first, second) = left[j * size..].split_at_mut(size);
            divide_by_pivot(&mut first[j..])?;
            if second.is_empty() {
                break;
            }
            subtract(&mut second[j + 1..], first[j + 1], &first[j + 1..]);
            divide_by_pivot(&mut second[j + 1..])?;
            for (k, target) in (j + 2..).zip(right.chunks_mut(size)) {
                let (first, second) = (&first[k..], &second[k..]);
                let (of_first, of_second) = (first[0], second[0]);
                let both = first.iter().zip(second).map(|(a, b)| of_first * a + of_second * b);
                target[k..].iter_mut().zip(both).for_each(|(entry, both)| *entry -= both);
            }
        }
        Ok(())
    }
}

/// Divides a column of the factor, from its diagonal entry down, by the root of that.
#[inline(always)]
fn divide_by_pivot(column: &mut [f64]) -> Result<(), FactorError> {
    let root = column[0].sqrt();
    if root.is_nan() || root == 0.0 {
        return Err(FactorError::NotPositiveDefinite);
    }
    column.iter_mut().for_each(|entry| *entry /= root);
    Ok(())
}

/// `L^-1 Z` of columns Z (n x m, column by column); every entry is NaN if faer fails.
pub fn forward_all(triangle: &LowerTriangle, mut columns: Vec<f64>) -> Vec<f64> {
    let size = triangle.size();
    let count = columns.len().checked_div(size).unwrap_or(0);
    if count <= FEW_COLUMNS {
        columns.chunks_mut(size.max(1)).for_each(|column| triangle.sweep(column, false));
        return columns;
    }
    in_place(columns, |columns| {
        let l = MatRef::from_column_major_slice(triangle.values(), size, size);
        solve_lower_triangular_in_place(l, MatMut::from_column_major_slice_mut(columns, size, count), Par::Seq);
        Ok(())
    })
}

/// The lower triangle of `Z'Z` (m x m, column by column) of columns Z (n x m, column by column), zeros above; every
/// entry is NaN if faer fails.
pub fn products(size: usize, columns: &[f64]) -> Vec<f64> {
    let count = columns.len().checked_div(size).unwrap_or(0);
    let mut products = vec![0.0; count * count];
    if count <= FEW_COLUMNS {
        for (j, column) in columns.chunks(size.max(1)).enumerate() {
            let below = columns[j * size..].chunks(size.max(1)).enumerate();
            below.for_each(|(i, other)| products[j * count + j + i] = wide_dot(column, other));
        }
        return products;
    }
    in_place(products, |products| {
        let z = MatRef::from_column_major_slice(columns, size, count);
        let whole = BlockStructure::Rectangular;
        let target = MatMut::from_column_major_slice_mut(products, count, count);
        let (below, replace) = (BlockStructure::TriangularLower, Accum::Replace);
        matmul(target, below, replace, z.transpose(), whole, z, whole, 1.0, Par::Seq);
        Ok(())
    })
}
