//! Named parts of a mesh's surface.

use crate::fem::element::FacetKind;

/// A named part of the mesh's surface: the ends of a bar, edges of a plane mesh, faces of a mesh in space.
#[derive(Clone, Debug, PartialEq)]
pub struct Boundary {
    /// Its name in scenes, as `top`; no two boundaries of a mesh share one.
    pub name: String,
    /// The element that each of its facets is, as `Line2` for straight edges.
    pub kind: FacetKind,
    /// The nodes of facet 0, then of facet 1, ..., each in the order of its reference cell; edges are in their order
    /// along the boundary if they form a line.
    pub connectivity: Vec<usize>,
}

impl Boundary {
    /// The boundary called `name` of facets of one kind: `connectivity` lists the nodes of facet 0, then of facet 1,
    /// ..., indices from 0.
    pub fn new(name: impl Into<String>, kind: FacetKind, connectivity: Vec<usize>) -> Self {
        Boundary { name: name.into(), kind, connectivity }
    }

    /// Number of facets: the length of `connectivity` over the nodes of a facet.
    pub fn facet_count(&self) -> usize {
        self.connectivity.len() / self.kind.nodes()
    }

    /// The node indices of each facet, from 0, in the order of `connectivity`.
    pub fn facets(&self) -> impl Iterator<Item = &[usize]> + '_ {
        self.connectivity.chunks_exact(self.kind.nodes())
    }

    /// The node indices of a facet, by its number.
    pub(crate) fn facet(&self, number: usize) -> &[usize] {
        let count = self.kind.nodes();
        &self.connectivity[number * count..(number + 1) * count]
    }

    /// The node indices, each once, from 0, in the order of their first appearance along the facets.
    pub fn nodes(&self) -> Vec<usize> {
        let along = self.kind.reference().along;
        let mut seen = vec![false; self.connectivity.iter().max().map_or(0, |&last| last + 1)];
        let in_order = self.facets().flat_map(|facet| along.iter().map(|&local| facet[local]));
        in_order.filter(|&node| !std::mem::replace(&mut seen[node], true)).collect()
    }
}
