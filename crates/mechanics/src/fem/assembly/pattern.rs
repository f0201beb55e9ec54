//! The sparsity pattern of the lower triangle: two dofs are coupled if their nodes share an element.

use super::DofMap;
use crate::fem::geometry::Around;
use crate::fem::mesh::Mesh;

/// No column has visited this node yet.
const NEVER: u32 = u32::MAX;

/// Column starts and sorted rows of the lower triangle in the free dofs.
///
/// A mesh has at most 5,000,000 nodes: numbers of nodes, and of elements around them, fit 32 bits.
pub(super) fn lower_pattern(mesh: &Mesh, dofs: &DofMap) -> (Vec<usize>, Vec<usize>) {
    let dimension = mesh.dimension();
    let of_elements = (0..mesh.element_count()).map(|element| mesh.element(element).iter().copied());
    let around = Around::new(mesh.nodes().len(), of_elements);
    let mut seen = vec![NEVER; mesh.nodes().len()];
    let mut neighbours: Vec<usize> = Vec::new();
    // The neighbours of a node with the same or a larger number, unsorted.
    let mut collect = |node: usize, round: u32, neighbours: &mut Vec<usize>| {
        neighbours.clear();
        for &element in around.at(node) {
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
