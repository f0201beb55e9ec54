//! The bodies that one model holds: consecutive nodes and elements.

use std::ops::Range;

use crate::fem::mesh::Mesh;

/// One of the bodies that an [`ElasticBody`](super::ElasticBody) is made of; it shares no node with another.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    name: String,
    nodes: Range<usize>,
    elements: Range<usize>,
}

impl Region {
    pub(super) fn whole(mesh: &Mesh) -> Self {
        let (nodes, elements) = (0..mesh.nodes().len(), 0..mesh.element_count());
        Region { name: String::new(), nodes, elements }
    }

    /// The same region called `name`, after `nodes` nodes and `elements` elements of other regions.
    pub(super) fn shifted(&self, name: &str, nodes: usize, elements: usize) -> Self {
        let behind = |range: &Range<usize>, count: usize| range.start + count..range.end + count;
        let (nodes, elements) = (behind(&self.nodes, nodes), behind(&self.elements, elements));
        Region { name: name.into(), nodes, elements }
    }

    /// Regions on a mesh of parts of their elements, region by region, given the element that each is a part of.
    pub(super) fn on(regions: &[Self], mesh: &Mesh, parents: &[usize]) -> Vec<Self> {
        let (mut first_node, mut first_element) = (0, 0);
        let mut next = |region: &Region| {
            let parts = parents[first_element..].iter().take_while(|&parent| region.elements.contains(parent)).count();
            let elements = first_element..first_element + parts;
            let last_node = elements.clone().flat_map(|element| mesh.element(element)).max();
            let nodes = first_node..last_node.map_or(first_node, |node| node + 1);
            (first_node, first_element) = (nodes.end, elements.end);
            Region { name: region.name.clone(), nodes, elements }
        };
        regions.iter().map(&mut next).collect()
    }

    /// Its name, the prefix of its boundaries; empty for the first.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Indices of its nodes in the mesh of the body, from 0, without gaps.
    pub fn nodes(&self) -> Range<usize> {
        self.nodes.clone()
    }

    /// Indices of its elements in the mesh of the body, from 0, without gaps.
    pub fn elements(&self) -> Range<usize> {
        self.elements.clone()
    }
}
