//! The outline of a mesh: faces found by their nodes, edges sorted into chains.

use std::collections::{HashMap, HashSet};

use super::{Boundary, FacetKind, Mesh};

impl Mesh {
    /// The mesh with these boundaries alone, each with all faces that have only marked nodes; a boundary without a face
    /// is left out.
    pub(crate) fn with_sides(mut self, sides: &[(&str, &dyn Fn(usize) -> bool)]) -> Self {
        self.boundaries = sides.iter().filter_map(|(name, marked)| self.boundary_where(name, marked)).collect();
        self
    }

    /// The boundary of all faces that have only marked nodes, in a mesh of one kind, seen from outside; edges in the
    /// order in which they follow each other. `None` if there is no such face.
    fn boundary_where(&self, name: &str, marked: impl Fn(usize) -> bool) -> Option<Boundary> {
        let reference = self.kind_of(0).reference();
        let mut connectivity = Vec::new();
        for nodes in self.elements() {
            for face in reference.faces.iter().filter(|face| face.iter().all(|&local| marked(nodes[local]))) {
                connectivity.extend(face.iter().map(|&local| nodes[local]));
            }
        }
        let kind = reference.facet;
        (!connectivity.is_empty()).then(|| Boundary::new(name, kind, chained(kind, connectivity)))
    }
}

impl Boundary {
    /// The facets that are kept, by their numbers, under another name.
    pub(crate) fn part(&self, name: &str, is_kept: impl Fn(usize) -> bool) -> Boundary {
        let kept = self.facets().enumerate().filter(|&(index, _)| is_kept(index));
        let connectivity = kept.flat_map(|(_, facet)| facet).copied().collect();
        Boundary::new(name, self.kind, chained(self.kind, connectivity))
    }
}

/// Edges in the order in which they follow each other; other facets unchanged.
pub(super) fn chained(kind: FacetKind, connectivity: Vec<usize>) -> Vec<usize> {
    if kind.reference().dimension != 1 {
        return connectivity;
    }
    let edges: Vec<&[usize]> = connectivity.chunks_exact(kind.nodes()).collect();
    let starting: HashMap<usize, usize> =
        edges.iter().enumerate().rev().map(|(index, edge)| (edge[0], index)).collect();
    let ends: HashSet<usize> = edges.iter().map(|edge| edge[1]).collect();
    let mut waiting = vec![true; edges.len()];
    let mut ordered = Vec::with_capacity(connectivity.len());
    // Open lines from their start, then closed lines from any edge.
    let beginnings = (0..edges.len()).filter(|&index| !ends.contains(&edges[index][0]));
    for first in beginnings.chain(0..edges.len()) {
        let mut next = Some(first);
        while let Some(index) = next.filter(|&index| std::mem::replace(&mut waiting[index], false)) {
            ordered.extend_from_slice(edges[index]);
            next = starting.get(&edges[index][1]).copied();
        }
    }
    ordered
}
