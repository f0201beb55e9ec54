//! The sparsity pattern of the lower triangle: two dofs are coupled if their nodes share an element.

use super::DofMap;
use crate::fem::geometry::Around;
use crate::fem::mesh::Mesh;
use crate::fem::threads::{on_parts, parts};

/// No node has visited this one yet.
const NEVER: u32 = u32::MAX;

/// The nodes around one node after another.
struct Neighbours<'a> {
    mesh: &'a Mesh,
    around: &'a Around,
    /// The node that has visited each node last.
    seen: Vec<u32>,
    found: Vec<usize>,
}

impl Neighbours<'_> {
    /// The nodes with the same or a larger number that share an element with a node, unsorted.
    fn of(&mut self, node: usize) -> &mut [usize] {
        self.found.clear();
        for &element in self.around.at(node) {
            for &other in self.mesh.element(element as usize) {
                if other >= node && self.seen[other] != node as u32 {
                    self.seen[other] = node as u32;
                    self.found.push(other);
                }
            }
        }
        &mut self.found
    }
}

/// Column starts and sorted rows of the lower triangle in the free dofs.
///
/// A mesh has so few nodes that their numbers, and those of the elements around them, fit 32 bits.
pub(super) fn lower_pattern(mesh: &Mesh, dofs: &DofMap) -> (Vec<usize>, Vec<u32>) {
    let (dimension, count) = (mesh.dimension(), mesh.nodes().len());
    let of_elements = (0..mesh.element_count()).map(|element| mesh.element(element).iter().copied());
    let around = Around::new(count, of_elements);
    let neighbours = || Neighbours { mesh, around: &around, seen: vec![NEVER; count], found: Vec::new() };
    let free_axes = |node: usize| (dimension * node..dimension * (node + 1)).filter_map(|dof| dofs.number(dof));
    let parts = parts(count);
    let nodes: Vec<usize> = (0..=parts).map(|part| count * part / parts).collect();
    // The entries of the first column of each node.
    let mut lengths = vec![0_u32; count];
    on_parts(&mut lengths, &nodes, |part, lengths| {
        let mut neighbours = neighbours();
        for (node, length) in (nodes[part]..).zip(lengths) {
            if free_axes(node).next().is_some() {
                *length = neighbours.of(node).iter().map(|&other| free_axes(other).count() as u32).sum();
            }
        }
    });
    let (mut starts, mut entries, mut bounds) = (Vec::with_capacity(dofs.free().len() + 1), 0, Vec::new());
    starts.push(0);
    for (node, &length) in lengths.iter().enumerate() {
        if nodes.get(bounds.len()) == Some(&node) {
            bounds.push(entries);
        }
        for column in 0..free_axes(node).count() {
            entries += length as usize - column;
            starts.push(entries);
        }
    }
    bounds.push(entries);
    let mut rows = vec![0_u32; entries];
    on_parts(&mut rows, &bounds, |part, rows| {
        let (mut neighbours, mut rest) = (neighbours(), rows.iter_mut());
        for node in nodes[part]..nodes[part + 1] {
            let own = free_axes(node).count();
            if own > 0 {
                let around = neighbours.of(node);
                around.sort_unstable();
                for column in 0..own {
                    let of_column = around.iter().flat_map(|&other| free_axes(other)).skip(column);
                    of_column.zip(rest.by_ref()).for_each(|(row, place)| *place = row as u32);
                }
            }
        }
    });
    (starts, rows)
}
