//! Fill-reducing orderings for the Cholesky factorisation: minimum degree or nested dissection on the graph of alike
//! columns, chosen columns last, postordered so that columns of one supernode are neighbours.

use faer::dyn_stack::MemStack;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;
use faer::sparse::linalg::cholesky::simplicial::prefactorize_symbolic_cholesky;
use faer::sparse::linalg::qr::{postorder, postorder_scratch};
use feral_metis::{CscPattern, metis_order};

use super::factor::{call, memory};
use super::quotient::Quotient;
use super::{FactorError, SparseMatrix, SymmetricMatrix};

/// Nested dissection takes about as long as this many multiplications of the factorisation for each edge of the graph;
/// it is tried if minimum degree leaves a factorisation that costs several times as much.
const WORTH_DISSECTING: f64 = 50_000.0;

/// Diagonals for which minimum degree gets memory: more than it needs.
const DIAGONALS: usize = 4;

/// The cost of a factorisation with columns eliminated by minimum degree.
#[derive(Clone, Copy, Debug)]
pub struct Fill {
    /// Multiplications, approximately.
    pub multiplications: f64,
    /// Values of the factor, approximately.
    pub entries: f64,
    /// `true` if the factorisation costs so much that `order` tries nested dissection as well.
    pub is_dissected: bool,
}

impl Fill {
    /// The fill of the factor of `matrix`, found without a factorisation.
    pub fn by_minimum_degree(matrix: &SymmetricMatrix) -> Result<Self, FactorError> {
        call(|| Ok(minimum_degree(&Quotient::of(matrix.lower()))?.1))
    }
}

/// A fill-reducing order of the columns of a symmetric matrix, given by its lower triangle: `order[i]` is the column
/// that is eliminated as the i-th. The columns of `last` come last, as they are given.
///
/// Columns with the same neighbours (the dofs of a node) are ordered as one, which is faster and gives less fill. The
/// order is that of minimum degree, or of nested dissection if that is worth its time and needs fewer multiplications.
pub(super) fn order(lower: &SparseMatrix, last: &[usize]) -> Result<Vec<usize>, FactorError> {
    let mut quotient = Quotient::of(lower);
    let (by_degree, fill) = minimum_degree(&quotient)?;
    quotient.remove(last);
    let (mut order, multiplications) = postordered(&quotient, by_degree)?;
    if fill.is_dissected {
        let dissected = postordered(&quotient, nested_dissection(&quotient)?)?;
        if dissected.1 < multiplications {
            order = dissected.0;
        }
    }
    let mut columns = Vec::with_capacity(lower.columns());
    order.into_iter().for_each(|group| columns.extend_from_slice(quotient.members(group)));
    columns.extend_from_slice(last);
    Ok(columns)
}

/// Approximate minimum degree, with the approximate fill for groups of average size.
fn minimum_degree(quotient: &Quotient) -> Result<(Vec<u32>, Fill), FactorError> {
    let count = quotient.count();
    let graph =
        SymbolicSparseColMatRef::new_unsorted_checked(count, count, &quotient.starts, None, &quotient.all_neighbours);
    // The memory request assumes stored diagonals, and falls short without them.
    let entries = quotient.all_neighbours.len() + DIAGONALS * count;
    let request = amd::order_maybe_unsorted_scratch::<u32>(count, entries);
    let mut buffer = memory(request)?;
    let (mut order, mut place) = (vec![0; count], vec![0; count]);
    let stack = MemStack::new(&mut buffer);
    let work = amd::order_maybe_unsorted(&mut order, &mut place, graph, amd::Control::default(), stack)?;
    let size = quotient.mean_size();
    let multiplications = work.n_mult_subs_ldl * size.powi(3);
    let entries = work.n_div * size.powi(2) + count as f64 * size * (size + 1.0) / 2.0;
    let is_dissected = multiplications > WORTH_DISSECTING * quotient.edges() as f64;
    Ok((order, Fill { multiplications, entries, is_dissected }))
}

fn nested_dissection(quotient: &Quotient) -> Result<Vec<u32>, FactorError> {
    let signed = |values: &[u32]| values.iter().map(|&value| value as i32).collect::<Vec<_>>();
    let failed = || FactorError::Failed("nested dissection".into());
    let (starts, mut neighbours) = (signed(&quotient.starts), signed(&quotient.all_neighbours));
    starts.windows(2).for_each(|pair| neighbours[pair[0] as usize..pair[1] as usize].sort_unstable());
    let graph = CscPattern::new(quotient.count(), &starts, &neighbours).ok_or_else(failed)?;
    let order = metis_order(&graph).map_err(|_| failed())?;
    Ok(order.into_iter().map(|group| group as u32).collect())
}

/// The groups of a quotient graph, eliminated in some order, in postorder of the elimination tree: each after all its
/// descendants, and these next to each other. Groups without columns are left out. And the multiplications of the
/// factorisation, approximately.
fn postordered(quotient: &Quotient, mut order: Vec<u32>) -> Result<(Vec<u32>, f64), FactorError> {
    order.retain(|&group| !quotient.members(group).is_empty());
    let count = order.len();
    // Groups that are left out come last.
    let mut place = vec![count as u32; quotient.count()];
    order.iter().zip(0..).for_each(|(&group, position)| place[group as usize] = position);
    let (mut starts, mut before) = (vec![0], Vec::with_capacity(quotient.edges()));
    for (&group, position) in order.iter().zip(0..) {
        let places = quotient.neighbours(group).iter().map(|&neighbour| place[neighbour as usize]);
        before.extend(places.filter(|&place| place < position));
        starts.push(before.len() as u32);
    }
    let graph = SymbolicSparseColMatRef::new_unsorted_checked(count, count, &starts, None, &before);
    let (mut parents, mut entries, mut post) = (vec![0; count], vec![0; count], vec![0; count]);
    let mut buffer = memory(postorder_scratch::<u32>(count))?;
    let stack = MemStack::new(&mut buffer);
    let tree = prefactorize_symbolic_cholesky(&mut parents, &mut entries, graph, stack);
    postorder(&mut post, tree, stack);
    let work = |(&group, &entries): (&u32, &u32)| {
        let (size, below) = (quotient.members(group).len() as f64, f64::from(entries - 1));
        size * (below * quotient.mean_size() + size / 2.0).powi(2) / 2.0
    };
    let multiplications = order.iter().zip(&entries).map(work).sum();
    Ok((post.into_iter().map(|position| order[position as usize]).collect(), multiplications))
}

#[cfg(test)]
mod tests {
    use super::{Fill, Quotient, minimum_degree, postordered};
    use crate::{Analysis, SparseMatrix, SymmetricMatrix};

    /// A lattice with this number of nodes along each side, each of three columns that have the same neighbours.
    fn lattice(sides: [usize; 3]) -> SymmetricMatrix {
        let nodes: usize = sides.iter().product();
        let steps = [(0, 1), (1, sides[0]), (2, sides[0] * sides[1])];
        let mut pairs: Vec<_> = (0..nodes).map(|node| (node, node)).collect();
        for (axis, step) in steps {
            let is_inside = |node: &usize| node / step % sides[axis] + 1 < sides[axis];
            pairs.extend((0..nodes).filter(is_inside).map(|node| (node + step, node)));
        }
        let of_pair = |(a, b): (usize, usize)| (0..9).map(move |place| (3 * a + place / 3, 3 * b + place % 3));
        let lower = pairs.into_iter().flat_map(of_pair).filter(|(row, column)| row >= column);
        let entries: Vec<_> =
            lower.map(|(row, column)| (row, column, if row == column { 30.0 } else { -1.0 })).collect();
        let columns = 3 * nodes;
        SymmetricMatrix::from_lower(SparseMatrix::from_triplets(columns, columns, &entries).unwrap()).unwrap()
    }

    #[test]
    fn minimum_degree_tells_the_fill_of_the_factor() {
        for sides in [[40, 40, 1], [400, 4, 1], [60, 6, 6], [10, 10, 10]] {
            let matrix = lattice(sides);
            let (fill, quotient) = (Fill::by_minimum_degree(&matrix).unwrap(), Quotient::of(matrix.lower()));
            let (order, _) = minimum_degree(&quotient).unwrap();
            let ratio = fill.multiplications / postordered(&quotient, order).unwrap().1;
            assert!((0.9..=1.1).contains(&ratio), "{sides:?}: {ratio}");
            // Supernodes add zeros to the factor; for a chain they are as many as its values.
            let entries = fill.entries / Analysis::of(&matrix).unwrap().factor_entries() as f64;
            assert!((0.25..=1.0).contains(&entries), "{sides:?}: {entries}");
        }
    }
}
