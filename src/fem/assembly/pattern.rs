//! The sparsity pattern of the lower triangle: two dofs are coupled if their nodes share an element.

use super::DofMap;
use crate::fem::mesh::Mesh;

/// No column has visited this node yet.
const NEVER: u32 = u32::MAX;

/// The elements around every node, by one counting sort.
struct Around {
    starts: Vec<u32>,
    elements: Vec<u32>,
}

impl Around {
    fn new(mesh: &Mesh) -> Self {
        let mut starts = vec![0_u32; mesh.nodes().len() + 1];
        mesh.elements().flatten().for_each(|&node| starts[node + 1] += 1);
        for node in 0..mesh.nodes().len() {
            starts[node + 1] += starts[node];
        }
        let mut elements = vec![0; starts[mesh.nodes().len()] as usize];
        // Each start moves to its end while its list is filled, and ends up as the start of the next node.
        for (index, nodes) in mesh.elements().enumerate() {
            for &node in nodes {
                elements[starts[node] as usize] = index as u32;
                starts[node] += 1;
            }
        }
        starts.rotate_right(1);
        starts[0] = 0;
        Around { starts, elements }
    }

    fn of(&self, node: usize) -> &[u32] {
        &self.elements[self.starts[node] as usize..self.starts[node + 1] as usize]
    }
}

/// Column starts and sorted rows of the lower triangle in the free dofs.
///
/// A mesh has at most 5,000,000 nodes: numbers of nodes, and of elements around them, fit 32 bits.
pub(super) fn lower_pattern(mesh: &Mesh, dofs: &DofMap) -> (Vec<usize>, Vec<usize>) {
    let dimension = mesh.dimension();
    let around = Around::new(mesh);
    let mut seen = vec![NEVER; mesh.nodes().len()];
    let mut neighbours: Vec<usize> = Vec::new();
    // The neighbours of a node with the same or a larger number, unsorted.
    let mut collect = |node: usize, round: u32, neighbours: &mut Vec<usize>| {
        neighbours.clear();
        for &element in around.of(node) {
            for &other in mesh.element(element as usize) {
                if other >= node && seen[other] != round {
                    seen[other] = round;
                    neighbours.push(other);
                }
            }
        }
    };
    let free_axes = |node: usize| (dimension * node..dimension * (node + 1)).filter_map(|dof| dofs.number(dof));
    let mut starts = Vec::with_capacity(dofs.free().len() + 1);
    starts.push(0);
    let mut entries = 0;
    for node in 0..mesh.nodes().len() {
        let own = free_axes(node).count();
        if own == 0 {
            continue;
        }
        collect(node, node as u32, &mut neighbours);
        let below: usize = neighbours.iter().map(|&other| free_axes(other).count()).sum();
        for column in 0..own {
            entries += below - column;
            starts.push(entries);
        }
    }
    let mut rows = Vec::with_capacity(entries);
    for node in 0..mesh.nodes().len() {
        let own = free_axes(node).count();
        if own == 0 {
            continue;
        }
        collect(node, mesh.nodes().len() as u32 + node as u32, &mut neighbours);
        neighbours.sort_unstable();
        for column in 0..own {
            rows.extend(neighbours.iter().flat_map(|&other| free_axes(other)).skip(column));
        }
    }
    (starts, rows)
}
