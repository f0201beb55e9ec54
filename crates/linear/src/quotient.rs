//! What belongs together: alike columns of a symmetric matrix, with the graph of these groups, which for a stiffness is
//! that of its nodes; the first of things that are alike; connected components.

use std::collections::HashMap;

use super::SparseMatrix;
use super::columns::grouped;
use super::real::scramble;

/// No group has this number.
const NONE: u32 = u32::MAX;

/// Groups of columns with the same neighbours, and the pairs of groups that meet.
pub(super) struct Quotient {
    of_column: Vec<u32>,
    /// Members of a group follow each other.
    member_starts: Vec<usize>,
    columns: Vec<usize>,
    /// The start of the neighbours of each group.
    pub starts: Vec<u32>,
    /// The neighbours of all groups, on both sides, in any order.
    pub all_neighbours: Vec<u32>,
}

impl Quotient {
    pub fn of(lower: &SparseMatrix) -> Self {
        let (of_column, count) = groups(lower);
        let (member_starts, columns) = grouped(count, &of_column);
        // One member represents its group; neighbours above the diagonal come from their own columns.
        let (mut below_starts, mut below) = (vec![0], Vec::new());
        let mut seen = vec![NONE; count];
        let mut starts = vec![0_u32; count + 1];
        for group in 0..count as u32 {
            for (row, _) in lower.column(columns[member_starts[group as usize]]) {
                let neighbour = of_column[row];
                if neighbour != group && seen[neighbour as usize] != group {
                    seen[neighbour as usize] = group;
                    below.push(neighbour);
                    starts[neighbour as usize + 1] += 1;
                    starts[group as usize + 1] += 1;
                }
            }
            below_starts.push(below.len());
        }
        (0..count).for_each(|group| starts[group + 1] += starts[group]);
        let mut place = starts.clone();
        let mut all_neighbours = vec![0; 2 * below.len()];
        let mut put = |at: u32, neighbour: u32| {
            all_neighbours[place[at as usize] as usize] = neighbour;
            place[at as usize] += 1;
        };
        for group in 0..count {
            for &neighbour in &below[below_starts[group]..below_starts[group + 1]] {
                put(group as u32, neighbour);
                put(neighbour, group as u32);
            }
        }
        Quotient { of_column, member_starts, columns, starts, all_neighbours }
    }

    pub fn count(&self) -> usize {
        self.member_starts.len() - 1
    }

    /// Number of pairs of groups that meet.
    pub fn edges(&self) -> usize {
        self.all_neighbours.len() / 2
    }

    /// Columns of a group, on average.
    pub fn mean_size(&self) -> f64 {
        self.columns.len() as f64 / self.count().max(1) as f64
    }

    pub fn members(&self, group: u32) -> &[usize] {
        &self.columns[self.member_starts[group as usize]..self.member_starts[group as usize + 1]]
    }

    pub fn neighbours(&self, group: u32) -> &[u32] {
        &self.all_neighbours[self.starts[group as usize] as usize..self.starts[group as usize + 1] as usize]
    }

    /// Removes columns from their groups, which may become empty; the graph stays.
    pub fn remove(&mut self, columns: &[usize]) {
        let mut is_kept = vec![true; self.of_column.len()];
        columns.iter().for_each(|&column| is_kept[column] = false);
        let mut kept = Vec::with_capacity(self.columns.len());
        for group in 0..self.count() {
            let members = self.member_starts[group]..self.member_starts[group + 1];
            self.member_starts[group] = kept.len();
            kept.extend(self.columns[members].iter().copied().filter(|&column| is_kept[column]));
        }
        let count = self.count();
        self.member_starts[count] = kept.len();
        self.columns = kept;
    }
}

/// The group of each column and the number of groups. Groups are numbered by their first column.
fn groups(lower: &SparseMatrix) -> (Vec<u32>, usize) {
    let dim = lower.columns();
    // A sum of scrambled indices represents the set of neighbours; a collision costs fill, not correctness.
    let mut signature: Vec<u64> = (0..dim).map(|column| scramble(column as u64)).collect();
    for column in 0..dim {
        let own = scramble(column as u64);
        let mut sum = signature[column];
        for (row, _) in lower.column(column).filter(|entry| entry.0 != column) {
            sum = sum.wrapping_add(scramble(row as u64));
            signature[row] = signature[row].wrapping_add(own);
        }
        signature[column] = sum;
    }
    // Alike columns mostly follow each other, so runs are sorted, which are fewer than columns.
    let mut runs: Vec<(u64, u32)> = Vec::new();
    for (column, &of_column) in signature.iter().enumerate() {
        if column == 0 || signature[column - 1] != of_column {
            runs.push((of_column, column as u32));
        }
    }
    runs.sort_unstable();
    let mut first_of = vec![NONE; dim];
    for alike in runs.chunk_by(|a, b| a.0 == b.0) {
        alike.iter().for_each(|run| first_of[run.1 as usize] = alike[0].1);
    }
    let mut of_column = vec![NONE; dim];
    let mut count = 0;
    for column in 0..dim {
        of_column[column] = match first_of[column] {
            NONE => of_column[column - 1],
            first if first as usize == column => {
                count += 1;
                count - 1
            }
            first => of_column[first as usize],
        };
    }
    (of_column, count as usize)
}

/// Keys of what was met, each with the number of its first owner.
#[derive(Default)]
pub struct Firsts {
    last: (Vec<u32>, u32),
    known: HashMap<Vec<u32>, u32>,
    /// Length of all keys.
    pub size: usize,
}

impl Firsts {
    /// The first number that came with this key; `number` if the key is new.
    pub fn of(&mut self, key: &[u32], number: usize) -> u32 {
        // Along a line of a lattice most have the key of the one before.
        if self.last.0 != key || self.known.is_empty() {
            let first = match self.known.get(key) {
                Some(&first) => first,
                None => {
                    self.size += key.len();
                    self.known.insert(key.to_vec(), number as u32);
                    number as u32
                }
            };
            self.last.0.clear();
            self.last.0.extend_from_slice(key);
            self.last.1 = first;
        }
        self.last.1
    }
}

/// Connected components by union and find: each unknown points towards the first of its tree. For the crates of this
/// workspace.
#[derive(Clone)]
pub struct Forest {
    parent: Vec<usize>,
    trees: usize,
}

impl Forest {
    /// A tree for each unknown.
    pub fn new(unknowns: usize) -> Self {
        Forest { parent: (0..unknowns).collect(), trees: unknowns }
    }

    /// Returns `true` if nothing is left to join.
    pub fn is_one_tree(&self) -> bool {
        self.trees <= 1
    }

    fn root(&mut self, mut unknown: usize) -> usize {
        while self.parent[unknown] != unknown {
            self.parent[unknown] = self.parent[self.parent[unknown]];
            unknown = self.parent[unknown];
        }
        unknown
    }

    /// Joins the trees of two unknowns into one.
    pub fn join(&mut self, a: usize, b: usize) {
        if self.parent[a] == self.parent[b] {
            return;
        }
        let (a, b) = (self.root(a), self.root(b));
        self.trees -= usize::from(a != b);
        self.parent[a.max(b)] = a.min(b);
    }

    /// The number of the tree of each unknown, in the order of their first unknowns, and the number of trees.
    pub fn into_trees(mut self) -> (Vec<usize>, usize) {
        let (mut tree, mut count) = (Vec::with_capacity(self.parent.len()), 0);
        for unknown in 0..self.parent.len() {
            // A root comes before the rest of its tree.
            let root = self.root(unknown);
            tree.push(if root == unknown { count } else { tree[root] });
            count += usize::from(root == unknown);
        }
        (tree, count)
    }
}
