//! The rows of blocks of a symmetric matrix, node by node.

use std::ops::Range;

use super::blocks::BlockMatrix;
use super::repeated::RowByRow;
use crate::quotient::{Firsts, Quotient};
use crate::real::Real;
use crate::threads::in_order;
use crate::{SymmetricMatrix, ldexp};

/// Groups of dofs whose rows are made at a time.
const GROUPS: usize = 2048;

/// Largest number of words that describe the different kinds of nodes: beyond it too few are alike.
const MOST_WORDS: usize = 1 << 19;

/// A matrix whose dofs are put into nodes.
pub struct Filling<'a> {
    pub matrix: &'a SymmetricMatrix,
    /// Groups of dofs with the same neighbours.
    pub graph: &'a Quotient,
    /// The first node of each group, and the number of nodes at the end.
    pub first_node: &'a [u32],
    /// Number of places of a node, filled or not.
    pub size: usize,
    /// The exponent of the unit of each node, and that of the whole matrix.
    pub exponents: &'a [i32],
    pub shift: i32,
}

/// Some rows of blocks, one after another.
#[derive(Default)]
struct BlockRows {
    /// The blocks of each row.
    lengths: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f64>,
}

impl Filling<'_> {
    /// The matrix in blocks, where places that nothing touches get the diagonal entry one, and, if nearly all rows
    /// repeat, the matrix as it is, without these entries and not rounded.
    pub fn blocks<T: Real>(&self, threads: usize) -> (BlockMatrix<T>, Option<BlockMatrix<f64>>) {
        let (groups, block) = (self.graph.count(), self.size * self.size);
        let mut matrix = RowByRow::new(self.size, self.exponents.len());
        let mut exact = Some(RowByRow::new(self.size, self.exponents.len()));
        let (mut rounded, mut node) = (Vec::new(), 0);
        let first = self.first_alike();
        let mut cursors = vec![vec![0; self.matrix.dim()]; threads.min(groups.div_ceil(GROUPS))];
        let starts: Vec<usize> = (0..groups).step_by(GROUPS).collect();
        for starts in starts.chunks(threads) {
            let part = |&start: &usize| start..groups.min(start + GROUPS);
            let parts: Vec<(Range<usize>, &mut Vec<u32>)> = starts.iter().map(part).zip(&mut cursors).collect();
            for rows in in_order(parts, |(groups, cursors)| self.rows(groups, cursors, &first)) {
                let mut start = 0;
                for length in rows.lengths {
                    let (of_first, end) = (first[node] as usize, start + length);
                    node += 1;
                    if of_first + 1 < node {
                        matrix.repeat(of_first);
                        exact.iter_mut().for_each(|exact| exact.repeat(of_first));
                        continue;
                    }
                    let (columns, values) = (&rows.columns[start..end], &rows.values[start * block..end * block]);
                    rounded.clear();
                    rounded.extend(values.iter().map(|&value| T::of(value)));
                    fill_empty_diagonal_of(of_first as u32, columns, self.size, &mut rounded);
                    matrix.push(columns, &rounded);
                    exact.iter_mut().for_each(|exact| exact.push(columns, values));
                    exact = exact.filter(RowByRow::has_few_rows);
                    start = end;
                }
            }
        }
        (matrix.finished(), exact.map(RowByRow::finished).filter(BlockMatrix::is_shared))
    }

    /// For each node the first one whose row has the same blocks: the nodes around have the same columns of the lower
    /// triangle, and lie alike. Where few are alike, each is the first.
    fn first_alike(&self) -> Vec<u32> {
        let mut key = Vec::new();
        let mut of_nodes = |keys: &dyn Fn(u32, u32, &mut Vec<u32>)| -> Option<Vec<u32>> {
            let (mut kinds, mut firsts) = (Firsts::default(), Vec::with_capacity(self.exponents.len()));
            for group in 0..self.graph.count() as u32 {
                for node in self.nodes(group) {
                    key.clear();
                    keys(node, group, &mut key);
                    firsts.push(kinds.of(&key, node as usize));
                }
                if kinds.size > MOST_WORDS {
                    return None;
                }
            }
            Some(firsts)
        };
        let by_columns = of_nodes(&|node, group, key| {
            let dofs = self.dofs(node, group);
            key.push(self.exponents[node as usize] as u32);
            for &dof in dofs {
                let (rows, values) = self.matrix.lower().column_slices(dof);
                key.extend([dof - dofs[0], rows.len()].map(|count| count as u32));
                key.extend(rows.iter().map(|&row| row.wrapping_sub(dofs[0] as u32)));
                let halves = |value: &f64| [value.to_bits() as u32, (value.to_bits() >> 32) as u32];
                key.extend(values.iter().flat_map(halves));
            }
        });
        let by_neighbours = by_columns.and_then(|kinds| {
            of_nodes(&|node, group, key| {
                for of_other in [&[group], self.graph.neighbours(group)].into_iter().flatten() {
                    for other in self.nodes(*of_other) {
                        let dof = |node: u32, group: u32| self.dofs(node, group)[0] as u32;
                        let apart = dof(other, *of_other).wrapping_sub(dof(node, group));
                        key.extend([other.wrapping_sub(node), apart, kinds[other as usize]]);
                    }
                }
            })
        });
        by_neighbours.unwrap_or_else(|| (0..self.exponents.len() as u32).collect())
    }

    /// The rows of the nodes of some groups, those alone that are the `first` of their kind. `next` is for each column,
    /// how far its next entry is thought to lie from its first.
    fn rows(&self, groups: Range<usize>, next: &mut [u32], first: &[u32]) -> BlockRows {
        let (size, mut met, mut rows) = (self.size, Vec::new(), BlockRows::default());
        for group in groups.start as u32..groups.end as u32 {
            for node in self.nodes(group) {
                let before = rows.columns.len();
                if first[node as usize] != node {
                    rows.lengths.push(0);
                    continue;
                }
                met.clear();
                met.push(group);
                met.extend_from_slice(self.graph.neighbours(group));
                met.sort_unstable();
                // Groups with dofs that do not follow each other meet from both sides.
                met.dedup();
                for &of_other in &met {
                    for other in self.nodes(of_other) {
                        let first = rows.values.len();
                        rows.columns.push(other);
                        rows.values.resize(first + size * size, 0.0);
                        let exponent = self.shift + self.exponents[node as usize] + self.exponents[other as usize];
                        for (i, &row) in self.dofs(node, group).iter().enumerate() {
                            for (j, &column) in self.dofs(other, of_other).iter().enumerate() {
                                if let Some(value) = self.entry(row, column, next) {
                                    rows.values[first + i * size + j] = ldexp(value, exponent);
                                }
                            }
                        }
                    }
                }
                rows.lengths.push(rows.columns.len() - before);
            }
        }
        rows
    }

    fn nodes(&self, group: u32) -> Range<u32> {
        self.first_node[group as usize]..self.first_node[group as usize + 1]
    }

    fn dofs(&self, node: u32, group: u32) -> &[usize] {
        let members = self.graph.members(group);
        let first = (node - self.first_node[group as usize]) as usize * self.size;
        &members[first..members.len().min(first + self.size)]
    }

    /// The entry of a row and a column, if there is one; the next one is found at once.
    #[inline]
    fn entry(&self, row: usize, column: usize, next: &mut [u32]) -> Option<f64> {
        let (row, column) = (row.max(column) as u32, row.min(column));
        let lower = self.matrix.lower();
        let (rows, values) = lower.column_slices(column);
        let mut place = next[column] as usize;
        if rows.get(place) != Some(&row) {
            place = rows.binary_search(&row).ok()?;
        }
        next[column] = place as u32 + 1;
        Some(values[place])
    }
}

/// Places that nothing touches get the diagonal entry one.
pub fn fill_empty_diagonal<T: Real>(blocks: &mut BlockMatrix<T>) {
    for node in 0..blocks.rows() {
        let range = blocks.starts[node]..blocks.starts[node + 1];
        let size = blocks.height;
        let values = &mut blocks.values[range.start * size * size..range.end * size * size];
        fill_empty_diagonal_of(node as u32, &blocks.indices[range], size, values);
    }
}

/// The same in the row of one node.
fn fill_empty_diagonal_of<T: Real>(node: u32, columns: &[u32], size: usize, values: &mut [T]) {
    let Ok(place) = columns.binary_search(&node) else { return };
    for i in 0..size {
        let entry = &mut values[place * size * size + i * size + i];
        if *entry == T::default() {
            *entry = T::of(1.0);
        }
    }
}
