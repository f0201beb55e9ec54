//! The dofs of a matrix in groups, one for each node, and the matrix in blocks of these.

use super::super::quotient::Quotient;
use super::super::{SymmetricMatrix, exponent, ldexp};
use super::blocks::BlockMatrix;
use crate::linear::factor::Real;

/// Largest number of dofs of a node; if more have the same neighbours, they count as dofs of several nodes.
const MOST_DOFS: usize = 3;

/// The node of each dof. Nodes with fewer dofs than others, such as nodes at a roller, are filled up with dofs that nothing
/// touches.
#[derive(Clone, Debug)]
pub struct Nodes {
    /// Places of a node.
    pub size: usize,
    /// Number of nodes.
    pub count: usize,
    /// The place `size * node + component` of each dof.
    pub place: Vec<u32>,
    /// The exponent of the unit of each node, `>= 0`: its displacement is `2^exponent` times the unknown of the hierarchy. With these
    /// units, nodes of stiff and of soft bodies have diagonal entries of the same order. Those of the stiffest nodes are zero.
    exponents: Vec<i32>,
}

/// The group of each dof, which is its node, and the exponent of its unit: `u = 2^exponent v`. All dofs of a node have the same one.
///
/// In the unknowns v, nodes of stiff and of soft bodies have diagonal entries of the same order. A projection that is orthogonal
/// in v then moves soft and stiff nodes of a row by what their stiffness allows; one that is orthogonal in u does not, and the
/// smoother diverges.
#[derive(Clone, Debug)]
pub struct Units {
    pub groups: Vec<u32>,
    pub exponents: Vec<i32>,
}

impl Units {
    /// The nodes by the pattern of `matrix` alone, all with one unit.
    pub fn by_pattern(matrix: &SymmetricMatrix) -> Self {
        let graph = Quotient::of(matrix.lower());
        let (size, mut groups, mut count) = (usual_dofs(&graph), vec![0; matrix.dim()], 0);
        for group in 0..graph.count() as u32 {
            for part in graph.members(group).chunks(size) {
                part.iter().for_each(|&dof| groups[dof] = count);
                count += 1;
            }
        }
        Units { groups, exponents: vec![0; matrix.dim()] }
    }

    /// One unit for all dofs, as if they were those of one node.
    pub fn alone(dofs: usize) -> Self {
        Units { groups: vec![0; dofs], exponents: vec![0; dofs] }
    }
}

impl Nodes {
    /// Groups dofs with the same neighbours, and writes the matrix in blocks of these groups, in the unit of each node, times
    /// `2^exponent` so that its diagonal is of order one.
    pub fn of<T: Real>(matrix: &SymmetricMatrix) -> (Self, BlockMatrix<T>, i32) {
        let graph = Quotient::of(matrix.lower());
        let groups = graph.count() as u32;
        let size = usual_dofs(&graph);
        let mut first_node = Vec::with_capacity(groups as usize + 1);
        let mut place = vec![0; matrix.dim()];
        let mut count = 0;
        for group in 0..groups {
            first_node.push(count as u32);
            for part in graph.members(group).chunks(size) {
                part.iter().enumerate().for_each(|(component, &dof)| place[dof] = (size * count + component) as u32);
                count += 1;
            }
        }
        first_node.push(count as u32);
        let (mut starts, mut indices) = (Vec::with_capacity(count + 1), Vec::new());
        starts.push(0);
        let mut groups_met = Vec::new();
        for group in 0..groups {
            groups_met.clear();
            groups_met.push(group);
            groups_met.extend_from_slice(graph.neighbours(group));
            groups_met.sort_unstable();
            // Groups with dofs that do not follow each other meet from both sides.
            groups_met.dedup();
            for _ in first_node[group as usize]..first_node[group as usize + 1] {
                for &other in &groups_met {
                    indices.extend(first_node[other as usize]..first_node[other as usize + 1]);
                }
                starts.push(indices.len());
            }
        }
        drop(graph);
        let values = vec![T::default(); indices.len() * size * size];
        let mut blocks = BlockMatrix { height: size, width: size, columns: count, starts, indices, values };
        let (exponents, shift) = units(&matrix.diagonal(), |dof| place[dof] as usize / size, count);
        let nodes = Nodes { size, count, place, exponents };
        nodes.fill(matrix, shift, &mut blocks);
        fill_empty_diagonal(&mut blocks);
        (nodes, blocks, shift)
    }

    /// `count` nodes of `size` dofs each, one after another.
    pub fn in_order(size: usize, count: usize) -> Self {
        Nodes { size, count, place: (0..(size * count) as u32).collect(), exponents: vec![0; count] }
    }

    /// Number of dofs of a node, and the component of each dof.
    pub fn components(matrix: &SymmetricMatrix) -> (usize, Vec<usize>) {
        let graph = Quotient::of(matrix.lower());
        let mut components = vec![0; matrix.dim()];
        let size = usual_dofs(&graph);
        for group in 0..graph.count() as u32 {
            graph.members(group).iter().enumerate().for_each(|(place, &dof)| components[dof] = place % size);
        }
        (size, components)
    }

    /// Fills the blocks on and above the diagonal, row by row, then copies those below from them: both run through memory in
    /// order. Entries outside the pattern of the graph cost quality, not correctness.
    fn fill<T: Real>(&self, matrix: &SymmetricMatrix, shift: i32, blocks: &mut BlockMatrix<T>) {
        let size = self.size;
        let diagonal: Vec<usize> =
            (0..self.count).map(|node| blocks.diagonal_place(node).unwrap_or(blocks.starts[node])).collect();
        for dof in 0..matrix.dim() {
            let shift = shift + self.exponent(self.place[dof]);
            let (node, j) = (self.place[dof] as usize / size, self.place[dof] as usize % size);
            let mut cursor = diagonal[node];
            for (row, value) in matrix.lower().column(dof) {
                let (other, i) = (self.place[row] as usize / size, self.place[row] as usize % size);
                let (first, second, a, b) = if node <= other { (node, other, j, i) } else { (other, node, i, j) };
                let end = blocks.starts[first + 1];
                if first != node || cursor >= end || blocks.indices[cursor] as usize > second {
                    cursor = diagonal[first];
                }
                let ahead = &blocks.indices[cursor..end];
                let place = cursor + ahead.iter().take_while(|&&column| (column as usize) < second).count();
                if place < end && blocks.indices[place] as usize == second {
                    let block = &mut blocks.values[place * size * size..(place + 1) * size * size];
                    block[a * size + b] = T::of(ldexp(value, shift + self.exponents[other]));
                    if first == second {
                        block[b * size + a] = block[a * size + b];
                    }
                    cursor = if first == node { place } else { diagonal[node] };
                }
            }
        }
        let mut next: Vec<usize> = diagonal.iter().map(|place| place + 1).collect();
        for (node, &own) in diagonal.iter().enumerate() {
            for place in blocks.starts[node]..own {
                let other = blocks.indices[place] as usize;
                let mirrored = next[other];
                if mirrored < blocks.starts[other + 1] && blocks.indices[mirrored] as usize == node {
                    next[other] += 1;
                    for i in 0..size {
                        for j in 0..size {
                            blocks.values[(place * size + i) * size + j] =
                                blocks.values[(mirrored * size + j) * size + i];
                        }
                    }
                }
            }
        }
    }

    /// The node and the unit of each dof.
    pub fn units(&self) -> Units {
        let groups = self.place.iter().map(|&place| place / self.size as u32).collect();
        Units { groups, exponents: self.place.iter().map(|&place| self.exponent(place)).collect() }
    }

    /// The exponent of the unit at a place.
    pub fn exponent(&self, place: u32) -> i32 {
        self.exponents[place as usize / self.size]
    }

    /// The forces on the dofs in the units of the nodes, times `2^exponent`, and that exponent: they are then of order one, because
    /// single precision has a small range.
    pub fn gather<T: Real>(&self, forces: &[f64]) -> (Vec<T>, i32) {
        let exponents = || self.place.iter().map(|&place| self.exponent(place)).zip(forces);
        let largest = exponents().filter(|entry| *entry.1 != 0.0).map(|(unit, &force)| exponent(force) + unit).max();
        let scale = -largest.unwrap_or(0);
        let mut gathered = vec![T::default(); self.size * self.count];
        for (&place, (unit, &force)) in self.place.iter().zip(exponents()) {
            gathered[place as usize] = T::of(ldexp(force, scale + unit));
        }
        (gathered, scale)
    }

    /// The displacements of the dofs, of unknowns in the units of the nodes, times `2^exponent`.
    pub fn scatter<T: Real>(&self, gathered: &[T], exponent: i32) -> Vec<f64> {
        let of_place = |&place: &u32| ldexp(gathered[place as usize].double(), exponent + self.exponent(place));
        self.place.iter().map(of_place).collect()
    }
}

/// The exponent of the unit of each of `count` nodes, from the largest diagonal entry there, and the exponent that then makes all
/// diagonal entries of order one. A node without stiffness has the unit of the stiffest.
fn units(diagonal: &[f64], node_of: impl Fn(usize) -> usize, count: usize) -> (Vec<i32>, i32) {
    let mut of_node = vec![0.0_f64; count];
    diagonal.iter().enumerate().for_each(|(dof, &own)| of_node[node_of(dof)] = of_node[node_of(dof)].max(own));
    let largest = exponent(of_node.iter().copied().fold(0.0, f64::max));
    let unit = |&own: &f64| if own > 0.0 { -(exponent(own) - largest).div_euclid(2) } else { 0 };
    (of_node.iter().map(unit).collect(), -largest)
}

/// Dofs of the nodes of a graph: the number in most groups. Nodes inside an element may share a group.
fn usual_dofs(graph: &Quotient) -> usize {
    let mut with = [0_usize; MOST_DOFS + 1];
    for group in 0..graph.count() as u32 {
        if let Some(count) = with.get_mut(graph.members(group).len()) {
            *count += 1;
        }
    }
    (1..=MOST_DOFS).max_by_key(|&size| (with[size], size)).unwrap_or(1)
}

/// Places that nothing touches get the diagonal entry one.
pub fn fill_empty_diagonal<T: Real>(blocks: &mut BlockMatrix<T>) {
    let size = blocks.height;
    for node in 0..blocks.rows() {
        let Some(place) = blocks.diagonal_place(node) else { continue };
        for i in 0..size {
            let entry = &mut blocks.values[place * size * size + i * size + i];
            if *entry == T::default() {
                *entry = T::of(1.0);
            }
        }
    }
}
