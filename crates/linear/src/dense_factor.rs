//! The Cholesky factor of a dense matrix, and many columns at once, on faer: sweeps through a triangle, and their
//! products.

use faer::dyn_stack::MemStack;
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};

use super::dense::{LowerTriangle, subtract, wide_dot};
use super::factor::{FactorError, call, memory};
use super::real::for_processor;

/// Columns that are swept one by one: a block of so few gains nothing.
const FEW_COLUMNS: usize = 4;

/// Up to this size a factorisation in blocks gains nothing.
const SMALL: usize = 32;

/// Factorises the symmetric matrix with this lower triangle (n x n, column by column; the entries above are not read)
/// on this number of threads.
pub(super) fn factorise(size: usize, mut values: Vec<f64>, threads: usize) -> Result<LowerTriangle, FactorError> {
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
    let done = call(|| {
        let l = MatRef::from_column_major_slice(triangle.values(), size, size);
        solve_lower_triangular_in_place(l, MatMut::from_column_major_slice_mut(&mut columns, size, count), Par::Seq);
        Ok(())
    });
    if done.is_err() {
        columns.fill(f64::NAN);
    }
    columns
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
    let done = call(|| {
        let z = MatRef::from_column_major_slice(columns, size, count);
        let whole = BlockStructure::Rectangular;
        let target = MatMut::from_column_major_slice_mut(&mut products, count, count);
        let (below, replace) = (BlockStructure::TriangularLower, Accum::Replace);
        matmul(target, below, replace, z.transpose(), whole, z, whole, 1.0, Par::Seq);
        Ok(())
    });
    if done.is_err() {
        products.fill(f64::NAN);
    }
    products
}
