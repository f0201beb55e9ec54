//! Fill-reducing orderings for the Cholesky factorisation: minimum degree or nested dissection on the graph of alike
//! columns, chosen columns last, postordered so that columns of one supernode are neighbours.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;
use feral_metis::{CscPattern, metis_order};

use super::elimination::Elimination;
use super::quotient::Quotient;
use super::{FactorError, SparseMatrix};

/// Nested dissection takes about as long as this many multiplications of the factorisation for each edge of the graph;
/// where minimum degree leaves a factorisation that costs several times as much, it is tried.
const WORTH_DISSECTING: f64 = 50_000.0;

/// Diagonals for which minimum degree gets memory: more than it takes.
const DIAGONALS: usize = 4;

/// A fill-reducing order of the columns of a symmetric matrix, given by its lower triangle: `order[i]` is the column
/// that is eliminated as the i-th. The columns of `last` come last, as they are given.
///
/// Columns with the same neighbours (the dofs of a node) are ordered as one, which is faster and fills in less. The order
/// is that of minimum degree, or of nested dissection where that is worth its time and needs fewer multiplications.
///
/// # Errors
/// [`FactorError::Failed`] when memory or the index range does not suffice.
pub(super) fn order(lower: &SparseMatrix, last: &[usize]) -> Result<Vec<usize>, FactorError> {
    let mut quotient = Quotient::of(lower);
    let (by_degree, multiplications) = minimum_degree(&quotient)?;
    quotient.remove(last);
    let mut elimination = Elimination::of(&quotient, by_degree);
    if multiplications > WORTH_DISSECTING * quotient.edges() as f64 {
        let dissected = Elimination::of(&quotient, nested_dissection(&quotient)?);
        if dissected.multiplications(&quotient) < elimination.multiplications(&quotient) {
            elimination = dissected;
        }
    }
    let mut columns = Vec::with_capacity(lower.columns());
    elimination.postorder().into_iter().for_each(|group| columns.extend_from_slice(quotient.members(group)));
    columns.extend_from_slice(last);
    Ok(columns)
}

/// Approximate minimum degree, with the multiplications of the factorisation, about, for groups of average size.
fn minimum_degree(quotient: &Quotient) -> Result<(Vec<u32>, f64), FactorError> {
    let count = quotient.count();
    let graph =
        SymbolicSparseColMatRef::new_unsorted_checked(count, count, quotient.starts(), None, quotient.all_neighbours());
    // The request counts on stored diagonals, and falls short without them.
    let entries = quotient.all_neighbours().len() + DIAGONALS * count;
    let request = amd::order_maybe_unsorted_scratch::<u32>(count, entries);
    let mut buffer = MemBuffer::try_new(request).map_err(|_| FactorError::Failed("out of memory".into()))?;
    let (mut order, mut place) = (vec![0; count], vec![0; count]);
    let stack = MemStack::new(&mut buffer);
    let work = amd::order_maybe_unsorted(&mut order, &mut place, graph, amd::Control::default(), stack)?;
    Ok((order, work.n_mult_subs_ldl * quotient.mean_size().powi(3)))
}

/// Multilevel nested dissection.
fn nested_dissection(quotient: &Quotient) -> Result<Vec<u32>, FactorError> {
    let signed = |values: &[u32]| values.iter().map(|&value| value as i32).collect::<Vec<_>>();
    let failed = || FactorError::Failed("nested dissection".into());
    let (starts, mut neighbours) = (signed(quotient.starts()), signed(quotient.all_neighbours()));
    starts.windows(2).for_each(|pair| neighbours[pair[0] as usize..pair[1] as usize].sort_unstable());
    let graph = CscPattern::new(quotient.count(), &starts, &neighbours).ok_or_else(failed)?;
    let order = metis_order(&graph).map_err(|_| failed())?;
    Ok(order.into_iter().map(|group| group as u32).collect())
}
