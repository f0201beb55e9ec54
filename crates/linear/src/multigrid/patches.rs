//! Overlapping patches of nodes, and the sum of the inverses of a matrix on them.
//!
//! A stiff volume couples a node with those around it so strongly that no node can move alone: a motion that keeps the
//! volume moves several nodes at once. With quadratic elements the smallest of these motions belong to the corners of
//! elements: a corner moves with the middles of its edges. These are found from the pattern alone: the middle of an
//! edge is connected only with nodes to which both corners of that edge are connected as well.
//!
//! # Source
//! J. Schöberl, *Multigrid methods for a parameter dependent problem in primal variables*, Numer. Math. 84 (1999)
//! 97-119: local solves on patches that contain the local motions without change of volume.

use super::blocks::BlockMatrix;
use crate::columns::grouped;
use crate::real::Real;
use crate::threads::SharedRows;

/// No place.
const NONE: u32 = u32::MAX;

/// Sets of nodes that may overlap; every node is in at least one.
#[derive(Clone, Debug)]
pub struct Patches {
    /// Start of each patch in `members`, length patches + 1.
    starts: Vec<usize>,
    /// The nodes of one patch after another, each patch in increasing order.
    members: Vec<u32>,
}

impl Patches {
    /// The patches of the pattern of `matrix`. The centre of a patch is a node whose neighbours are not all neighbours
    /// of another node that has more of them; the other nodes of the patch have no neighbour that the centre lacks. A
    /// patch with more than `most_unknowns` consists of its centre alone, and each node that is then in no patch is one
    /// by itself.
    pub fn of<T: Real>(matrix: &BlockMatrix<T>, most_unknowns: usize) -> Self {
        let rows = matrix.rows();
        let around = |node: usize| matrix.columns_of(node);
        let mut mark = vec![NONE; rows];
        let mut is_inner = vec![false; rows];
        let mut inner: Vec<(u32, u32)> = Vec::new();
        for node in 0..rows {
            around(node).for_each(|other| mark[other as usize] = node as u32);
            for other in around(node).filter(|&other| other as usize != node) {
                let mut of_other = around(other as usize);
                if of_other.len() < around(node).len() && of_other.all(|k| mark[k as usize] == node as u32) {
                    is_inner[other as usize] = true;
                    inner.push((node as u32, other));
                }
            }
        }
        let mut patches = Patches { starts: vec![0], members: Vec::new() };
        let mut is_in_one = vec![false; rows];
        let mut found = inner.chunk_by(|a, b| a.0 == b.0).peekable();
        for (centre, &is_inner) in is_inner.iter().enumerate() {
            let own = found.next_if(|own| own[0].0 as usize == centre).unwrap_or_default();
            if is_inner {
                continue;
            }
            let fits = (own.len() + 1) * matrix.height <= most_unknowns;
            let mut members: Vec<u32> = own.iter().filter(|_| fits).map(|pair| pair.1).collect();
            members.push(centre as u32);
            members.sort_unstable();
            members.iter().for_each(|&node| is_in_one[node as usize] = true);
            patches.push(&members);
        }
        (0..rows).filter(|&node| !is_in_one[node]).for_each(|node| patches.push(&[node as u32]));
        patches
    }

    fn push(&mut self, members: &[u32]) {
        self.members.extend_from_slice(members);
        self.starts.push(self.members.len());
    }

    pub fn count(&self) -> usize {
        self.starts.len() - 1
    }

    fn members(&self, patch: usize) -> &[u32] {
        &self.members[self.starts[patch]..self.starts[patch + 1]]
    }

    /// The patches in which `change` has a diagonal block.
    pub fn touched_by<T: Real>(&self, change: &BlockMatrix<T>) -> Self {
        let is_touched = |members: &[u32]| members.iter().any(|&node| change.diagonal_place(node as usize).is_some());
        let mut touched = Patches { starts: vec![0], members: Vec::new() };
        let all = (0..self.count()).map(|patch| self.members(patch));
        all.filter(|members| is_touched(members)).for_each(|members| touched.push(members));
        touched
    }

    /// The sum of the inverses of `matrix`, minus `change` if there is one, on the patches.
    pub fn inverse<T: Real>(
        &self,
        matrix: &BlockMatrix<T>,
        change: Option<&BlockMatrix<T>>,
        threads: usize,
    ) -> BlockMatrix<T> {
        let matrix = &matrix.with_rows(self.members.iter().map(|&node| node as usize));
        // The start of the inverse of each patch, in blocks.
        let mut starts = vec![0];
        (0..self.count()).for_each(|patch| starts.push(starts[patch] + self.members(patch).len().pow(2)));
        let of_patches = SharedRows { starts: &starts, threads }.map(|patches| {
            let mut places = vec![NONE; matrix.rows()];
            let inverses = patches.map(|patch| inverse_on(self.members(patch), matrix, change, &mut places));
            inverses.collect::<Vec<_>>().concat()
        });
        self.sum(&starts, &of_patches.concat(), matrix.rows(), matrix.height)
    }

    /// The sum of dense matrices on the patches, as a matrix of `rows` nodes with `size` unknowns each; `starts` are
    /// their starts in `values`, in blocks.
    fn sum<T: Real>(&self, starts: &[usize], values: &[T], rows: usize, size: usize) -> BlockMatrix<T> {
        let (first, places) = grouped(rows, &self.members);
        let patch_of = |&at: &usize| self.starts.partition_point(|&start| start <= at) - 1;
        let mut sum = BlockMatrix::empty(0, rows, (size, size));
        let (mut columns, mut place_of) = (Vec::new(), vec![0; rows]);
        for node in 0..rows {
            let of_node = &places[first[node]..first[node + 1]];
            columns.clear();
            of_node.iter().for_each(|at| columns.extend_from_slice(self.members(patch_of(at))));
            columns.sort_unstable();
            columns.dedup();
            let start = sum.values.len();
            sum.values.resize(start + columns.len() * size * size, T::default());
            columns.iter().enumerate().for_each(|(place, &column)| place_of[column as usize] = place);
            for at in of_node {
                let patch = patch_of(at);
                let (members, own) = (self.members(patch), at - self.starts[patch]);
                let width = members.len() * size;
                let lines = &values[starts[patch] * size * size + own * size * width..][..size * width];
                for (i, line) in lines.chunks_exact(width).enumerate() {
                    for (&column, part) in members.iter().zip(line.chunks_exact(size)) {
                        let target = &mut sum.values[start + (place_of[column as usize] * size + i) * size..][..size];
                        target.iter_mut().zip(part).for_each(|(sum, &value)| *sum += value);
                    }
                }
            }
            sum.indices.extend_from_slice(&columns);
            sum.starts.push(sum.indices.len());
        }
        sum
    }
}

/// The inverse of `matrix`, minus `change` if there is one, on the nodes `members`, row by row. `places` is all
/// [`NONE`] before and after.
fn inverse_on<T: Real>(
    members: &[u32],
    matrix: &BlockMatrix<T>,
    change: Option<&BlockMatrix<T>>,
    places: &mut [u32],
) -> Vec<T> {
    let (size, width) = (matrix.height, members.len() * matrix.height);
    let (mut work, mut result) = (vec![0.0; width * width], vec![0.0; width * width]);
    members.iter().zip(0..).for_each(|(&node, place)| places[node as usize] = place);
    for (own, &node) in members.iter().enumerate() {
        for (part, sign) in [(Some(matrix), 1.0), (change, -1.0)] {
            let blocks = part.into_iter().flat_map(|part| part.row(node as usize));
            for (other, block) in blocks.filter(|entry| places[entry.0] != NONE) {
                for (i, line) in block.chunks_exact(size).enumerate() {
                    let target = &mut work[(own * size + i) * width + places[other] as usize * size..][..size];
                    target.iter_mut().zip(line).for_each(|(sum, value)| *sum += sign * value.double());
                }
            }
        }
    }
    members.iter().for_each(|&node| places[node as usize] = NONE);
    invert(&mut work, width, &mut result);
    // Rounding of the elimination would leave the smoother unsymmetric.
    let symmetric = |place: usize| 0.5 * (result[place] + result[place % width * width + place / width]);
    (0..width * width).map(|place| T::of(symmetric(place))).collect()
}

/// A pivot of a diagonal block below this share of its entry is rounding: such a direction is not smoothed.
const SINGULAR_PIVOT: f64 = 1e-6;

/// The inverse of a symmetric block, row by row, by elimination; directions without a pivot are left out.
pub(super) fn invert(work: &mut [f64], size: usize, result: &mut [f64]) {
    result.fill(0.0);
    let diagonal: Vec<f64> = (0..size).map(|i| work[i * size + i]).collect();
    let mut kept = vec![true; size];
    (0..size).for_each(|i| result[i * size + i] = 1.0);
    for k in 0..size {
        let pivot = work[k * size + k];
        if pivot.is_nan() || pivot <= SINGULAR_PIVOT * diagonal[k] || pivot <= 0.0 {
            kept[k] = false;
            continue;
        }
        for j in 0..size {
            work[k * size + j] /= pivot;
            result[k * size + j] /= pivot;
        }
        for i in (0..size).filter(|&i| i != k) {
            let factor = work[i * size + k];
            if factor != 0.0 {
                for j in 0..size {
                    work[i * size + j] -= factor * work[k * size + j];
                    result[i * size + j] -= factor * result[k * size + j];
                }
            }
        }
    }
    let is_left_out = |place: usize| !kept[place / size] || !kept[place % size];
    (0..size * size).filter(|&place| is_left_out(place)).for_each(|place| result[place] = 0.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line of quadratic elements, whose corners are the even nodes: each element couples its three nodes. The
    /// diagonal is 4, other entries are -1.
    fn line(elements: usize) -> BlockMatrix<f64> {
        let nodes = 2 * elements + 1;
        let share =
            |a: usize, b: usize| (0..elements).any(|e| [a, b].iter().all(|&k| (2 * e..=2 * e + 2).contains(&k)));
        let value = |row: usize, column: usize| [if row == column { 4.0 } else { -1.0 }];
        let row = |row: usize| {
            (0..nodes).filter(move |&column| share(row, column)).map(move |column| (column, value(row, column)))
        };
        BlockMatrix::of_rows(nodes, (1, 1), (0..nodes).map(row))
    }

    fn all(patches: &Patches) -> Vec<&[u32]> {
        (0..patches.count()).map(|patch| patches.members(patch)).collect()
    }

    #[test]
    fn a_patch_is_a_corner_with_the_middles_of_its_edges_unless_it_is_too_large() {
        let matrix = line(4);
        // The ends have fewer neighbours than the corners beside them, and belong to these.
        assert_eq!(all(&Patches::of(&matrix, 10)), [&[0, 1, 2, 3][..], &[3, 4, 5], &[5, 6, 7, 8]]);
        assert_eq!(all(&Patches::of(&matrix, 3)), [&[2][..], &[3, 4, 5], &[6], &[0], &[1], &[7], &[8]]);
    }

    #[test]
    fn the_sum_of_inverses_is_symmetric_and_follows_a_change() {
        let (matrix, patches) = (line(4), Patches::of(&line(4), 10));
        let inverse = patches.inverse(&matrix, None, 1);
        assert_eq!(inverse.transposed().values, inverse.values);
        // On its own part of the only patch of node 1 the sum is the inverse of [4 -1 -1 0; -1 4 -1 0; -1 -1 4 -1; 0 0
        // -1 4].
        let product: f64 = [(0, 4.0), (1, -1.0), (2, -1.0)]
            .iter()
            .map(|&(k, a)| a * inverse.row(1).find(|entry| entry.0 == k).map_or(0.0, |entry| entry.1[0]))
            .sum();
        assert!(product.abs() < 1e-14, "{product:e}");
        // A change of the diagonal entry of node 4 alone.
        let change = BlockMatrix::of_rows(9, (1, 1), (0..9).map(|row| (row == 4).then_some((4, [1.0]))));
        let touched = patches.touched_by(&change);
        assert_eq!(all(&touched), [&[3, 4, 5][..]]);
        let [old, new] = [None, Some(&change)].map(|change| touched.inverse(&matrix, change, 1));
        let updated = inverse.plus(1.0, &new.plus(-1.0, &old));
        let anew = patches.inverse(&matrix.plus(-1.0, &change), None, 1);
        let difference = updated.plus(-1.0, &anew).values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        assert!(difference < 1e-14, "{difference:e}");
    }
}
