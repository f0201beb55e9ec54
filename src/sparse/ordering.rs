//! Orderings for the Cholesky factorisation: approximate minimum degree on the graph of alike columns, chosen columns
//! last, postordered so that columns of one supernode are neighbours.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use super::{FactorError, SparseMatrix};

/// Where a column has no parent in the elimination tree.
const NONE: usize = usize::MAX;

/// A fill-reducing order of the columns of a symmetric matrix, given by its lower triangle: `order[i]` is the column
/// that is eliminated as the i-th. The columns of `last` come last, as they are given.
///
/// Columns with the same neighbours (the dofs of a node) are ordered as one, which is faster and fills in less.
///
/// # Errors
/// [`FactorError::Failed`] when memory or the index range does not suffice.
pub(super) fn order(lower: &SparseMatrix, last: &[usize]) -> Result<Vec<usize>, FactorError> {
    let groups = Groups::of(lower);
    let mut is_last = vec![false; lower.columns()];
    last.iter().for_each(|&column| is_last[column] = true);
    let free: Vec<usize> = groups
        .order(lower)?
        .into_iter()
        .flat_map(|group| groups.members(group).to_vec())
        .filter(|&column| !is_last[column])
        .collect();
    let mut order = postorder(&elimination_tree(lower, &free), &free);
    order.extend_from_slice(last);
    Ok(order)
}

/// Columns with the same neighbours.
struct Groups {
    /// Group of each column.
    of_column: Vec<usize>,
    starts: Vec<usize>,
    columns: Vec<usize>,
}

impl Groups {
    fn of(lower: &SparseMatrix) -> Self {
        let dim = lower.columns();
        // A sum of scrambled indices stands for the set of neighbours; a collision costs fill, not correctness.
        let mut signature: Vec<(u64, usize)> = (0..dim).map(|column| (scramble(column), column)).collect();
        for (row, column, _) in lower.triplets().filter(|entry| entry.0 != entry.1) {
            signature[column].0 = signature[column].0.wrapping_add(scramble(row));
            signature[row].0 = signature[row].0.wrapping_add(scramble(column));
        }
        signature.sort_unstable();
        let mut first_of = vec![0; dim];
        let mut run = 0;
        for place in 0..dim {
            if signature[place].0 != signature[run].0 {
                run = place;
            }
            first_of[signature[place].1] = signature[run].1;
        }
        // Groups are numbered by their first column, so that the order does not depend on the signatures.
        let mut of_column = vec![NONE; dim];
        let mut count = 0;
        for column in 0..dim {
            let first = first_of[column];
            if of_column[first] == NONE {
                of_column[first] = count;
                count += 1;
            }
            of_column[column] = of_column[first];
        }
        let mut starts = vec![0; count + 1];
        of_column.iter().for_each(|&group| starts[group + 1] += 1);
        (0..count).for_each(|group| starts[group + 1] += starts[group]);
        let mut place = starts.clone();
        let mut columns = vec![0; dim];
        for (column, &group) in of_column.iter().enumerate() {
            columns[place[group]] = column;
            place[group] += 1;
        }
        Groups { of_column, starts, columns }
    }

    fn count(&self) -> usize {
        self.starts.len() - 1
    }

    fn members(&self, group: usize) -> &[usize] {
        &self.columns[self.starts[group]..self.starts[group + 1]]
    }

    /// Approximate minimum degree on the graph of the groups.
    fn order(&self, lower: &SparseMatrix) -> Result<Vec<usize>, FactorError> {
        let count = self.count();
        let mut starts = vec![0];
        let mut rows: Vec<usize> = Vec::new();
        let mut seen = vec![NONE; count];
        for group in 0..count {
            // One member stands for all; its neighbours above the diagonal come from their own columns.
            for (row, _) in lower.column(self.members(group)[0]) {
                let neighbour = self.of_column[row];
                if neighbour != group && seen[neighbour] != group {
                    seen[neighbour] = group;
                    rows.push(neighbour);
                }
            }
            starts.push(rows.len());
        }
        let graph = SymbolicSparseColMatRef::new_unsorted_checked(count, count, &starts, None, &rows);
        let request = amd::order_maybe_unsorted_scratch::<usize>(count, rows.len());
        let mut buffer = MemBuffer::try_new(request).map_err(|_| FactorError::Failed("out of memory".into()))?;
        let (mut order, mut place) = (vec![0; count], vec![0; count]);
        let stack = MemStack::new(&mut buffer);
        amd::order_maybe_unsorted(&mut order, &mut place, graph, amd::Control::default(), stack)?;
        Ok(order)
    }
}

fn scramble(index: usize) -> u64 {
    let mut z = (index as u64).wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The parent of each of the `order`ed columns in the elimination tree of their block, by position.
///
/// # Source
/// J. W. H. Liu, *The role of elimination trees in sparse factorization*, SIAM J. Matrix Anal. Appl. 11 (1990), 134-172.
fn elimination_tree(lower: &SparseMatrix, order: &[usize]) -> Vec<usize> {
    let mut place = vec![NONE; lower.columns()];
    order.iter().enumerate().for_each(|(position, &column)| place[column] = position);
    let ordered = || {
        lower.triplets().filter_map(|(row, column, _)| {
            let (a, b) = (place[row], place[column]);
            (a != b && a != NONE && b != NONE).then(|| (a.min(b), a.max(b)))
        })
    };
    let mut starts = vec![0_usize; order.len() + 1];
    ordered().for_each(|(_, later)| starts[later + 1] += 1);
    (0..order.len()).for_each(|position| starts[position + 1] += starts[position]);
    let mut next = starts.clone();
    let mut earlier_of = vec![0_usize; starts[order.len()]];
    for (earlier, later) in ordered() {
        earlier_of[next[later]] = earlier;
        next[later] += 1;
    }
    let (mut parent, mut ancestor) = (vec![NONE; order.len()], vec![NONE; order.len()]);
    for position in 0..order.len() {
        for &earlier in &earlier_of[starts[position]..starts[position + 1]] {
            let mut at = earlier;
            while at != NONE && at != position {
                let above = std::mem::replace(&mut ancestor[at], position);
                if above == NONE {
                    parent[at] = position;
                }
                at = above;
            }
        }
    }
    parent
}

/// The columns of `order` with every column behind all of its descendants and these next to each other.
fn postorder(parent: &[usize], order: &[usize]) -> Vec<usize> {
    let (mut first_child, mut sibling) = (vec![NONE; parent.len()], vec![NONE; parent.len()]);
    let mut first_root = NONE;
    for position in (0..parent.len()).rev() {
        let list = match parent[position] {
            NONE => &mut first_root,
            above => &mut first_child[above],
        };
        sibling[position] = std::mem::replace(list, position);
    }
    let mut ordered = Vec::with_capacity(order.len());
    let mut stack = Vec::new();
    let mut root = first_root;
    while root != NONE {
        stack.push(root);
        while let Some(&top) = stack.last() {
            match std::mem::replace(&mut first_child[top], NONE) {
                NONE => {
                    ordered.push(order[top]);
                    stack.pop();
                }
                child => {
                    // All children wait on the stack, the first on top.
                    let from = stack.len();
                    let mut next = child;
                    while next != NONE {
                        stack.push(next);
                        next = sibling[next];
                    }
                    stack[from..].reverse();
                }
            }
        }
        root = sibling[root];
    }
    ordered
}
