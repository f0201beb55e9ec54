//! The element that a facet belongs to; the outline of a mesh: faces by their nodes, edges sorted into chains.

use std::collections::{HashMap, HashSet};

use super::{Boundary, FacetKind, Mesh, fail};
use crate::error::Error;

/// The largest number of nodes of a facet.
const MOST_NODES: usize = 8;

/// The nodes of a facet in increasing order, padded at the end: the same for a face of any orientation.
type Key = [usize; MOST_NODES];

fn key(nodes: impl Iterator<Item = usize>) -> Key {
    let mut key = [usize::MAX; MOST_NODES];
    for (place, node) in key.iter_mut().zip(nodes) {
        *place = node;
    }
    key.sort_unstable();
    key
}

impl Mesh {
    /// The element and its local face for each facet of a boundary: the first one if the boundary lies between two
    /// elements, `None` if the facet is not a face of any element.
    pub fn faces_of(&self, boundary: &Boundary) -> Vec<Option<(usize, usize)>> {
        let mut found = vec![None; boundary.facet_count()];
        self.for_faces_of(boundary, |index, face| {
            found[index].get_or_insert(face);
        });
        found
    }

    /// The first facet of a boundary that is a face of two elements.
    pub(super) fn inner_facet(&self, boundary: &Boundary) -> Option<usize> {
        let mut count = vec![0_usize; boundary.facet_count()];
        self.for_faces_of(boundary, |index, _| count[index] += 1);
        count.iter().position(|&count| count > 1)
    }

    /// Calls `visit` with the number of a facet of a boundary, and an element and its local face, for each that there
    /// is.
    fn for_faces_of(&self, boundary: &Boundary, mut visit: impl FnMut(usize, (usize, usize))) {
        let mut places: HashMap<Key, Vec<usize>> = HashMap::with_capacity(boundary.facet_count());
        let mut marked = vec![false; self.nodes().len()];
        for (index, facet) in boundary.facets().enumerate() {
            places.entry(key(facet.iter().copied())).or_default().push(index);
            for &node in facet {
                if let Some(mark) = marked.get_mut(node) {
                    *mark = true;
                }
            }
        }
        for (element, nodes) in self.elements().enumerate() {
            // Most elements do not touch the boundary.
            if !nodes.iter().any(|&node| marked[node]) {
                continue;
            }
            for (face, local) in self.kind_of(element).reference().faces.iter().enumerate() {
                if !local.iter().all(|&place| marked[nodes[place]]) {
                    continue;
                }
                for &index in places.get(&key(local.iter().map(|&place| nodes[place]))).into_iter().flatten() {
                    visit(index, (element, face));
                }
            }
        }
    }

    /// All faces that belong to one of these elements of one kind only, seen from outside; edges in the order in which
    /// they follow each other.
    pub fn surface(&self, elements: impl Iterator<Item = usize> + Clone) -> Boundary {
        let of_elements = self.kind_of(elements.clone().next().unwrap_or(0));
        let (reference, kind) = (of_elements.reference(), of_elements.facet());
        let of_element = |element: usize| {
            let nodes = self.element(element);
            reference.faces.iter().map(move |face| face.iter().map(move |&local| nodes[local]))
        };
        let mut count: HashMap<Key, usize> = HashMap::new();
        for face in elements.clone().flat_map(of_element) {
            *count.entry(key(face)).or_default() += 1;
        }
        let outer = elements.flat_map(of_element).filter(|face| count.get(&key(face.clone())) == Some(&1));
        Boundary::new("surface", kind, chained(kind, outer.flatten().collect()))
    }

    /// The number of the piece of each element: elements of one piece are joined by common faces.
    #[doc(hidden)]
    pub fn pieces(&self) -> Vec<usize> {
        let mut first_at: HashMap<Key, usize> = HashMap::new();
        let mut forest = signorini_linear::Forest::new(self.element_count());
        for (element, nodes) in self.elements().enumerate() {
            for face in self.kind_of(element).reference().faces {
                forest.join(*first_at.entry(key(face.iter().map(|&local| nodes[local]))).or_insert(element), element);
            }
        }
        forest.into_trees().0
    }

    /// Checks that the facets of the boundaries from a number on are faces of elements.
    pub(super) fn check_facets(&self, from: usize) -> Result<(), Error> {
        for boundary in &self.boundaries()[from..] {
            if let Some(index) = self.faces_of(boundary).iter().position(Option::is_none) {
                let facet: Vec<usize> = boundary.facet(index).to_vec();
                return fail(format!(
                    "boundary `{}`: facet {index} (nodes {facet:?}, from 0) is not a face of any element",
                    boundary.name
                ));
            }
        }
        Ok(())
    }
}

impl Mesh {
    /// The mesh with these boundaries alone, each with all faces that have only marked nodes; a boundary without a face
    /// is left out.
    #[doc(hidden)]
    pub fn with_sides<'a>(mut self, sides: impl Iterator<Item = (&'a str, impl Fn(usize) -> bool)>) -> Self {
        self.boundaries = sides.filter_map(|(name, marked)| self.boundary_where(name, marked)).collect();
        self
    }

    /// The boundary of all faces that have only marked nodes, in a mesh of one kind, seen from outside; edges in the
    /// order in which they follow each other. `None` if there is no such face.
    fn boundary_where(&self, name: &str, marked: impl Fn(usize) -> bool) -> Option<Boundary> {
        let (reference, kind) = (self.kind_of(0).reference(), self.kind_of(0).facet());
        let mut connectivity = Vec::new();
        for nodes in self.elements() {
            for face in reference.faces.iter().filter(|face| face.iter().all(|&local| marked(nodes[local]))) {
                connectivity.extend(face.iter().map(|&local| nodes[local]));
            }
        }
        (!connectivity.is_empty()).then(|| Boundary::new(name, kind, chained(kind, connectivity)))
    }
}

impl Boundary {
    /// The facets that are kept, by their numbers, under another name.
    #[doc(hidden)]
    pub fn part(&self, name: &str, is_kept: impl Fn(usize) -> bool) -> Boundary {
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
