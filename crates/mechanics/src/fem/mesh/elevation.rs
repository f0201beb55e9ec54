//! From linear elements to quadratic elements: a node in the middle of every edge.

use std::collections::HashMap;

use super::{Boundary, ElementKind, MAX_NODES, Mesh, fail};
use crate::error::Error;
use crate::fem::geometry::{key, length, minus};

impl Mesh {
    /// The same mesh of a quadratic `kind`, whose corners are the nodes of its elements; edges stay straight. The new
    /// nodes follow the old ones.
    pub(crate) fn elevated(&self, kind: ElementKind) -> Result<Mesh, Error> {
        let own = self.kind_of(0);
        if (own.nodes(), own.dimension()) != (kind.corners(), kind.dimension()) {
            return fail(format!("a mesh of {} cannot become one of {}", own.name(), kind.name()));
        }
        let mut middles = Middles { nodes: self.nodes().to_vec(), of: HashMap::new() };
        let mut connectivity = Vec::with_capacity(self.element_count() * kind.nodes());
        for element in self.elements() {
            middles.extend(element, kind.reference().mid_sides, &mut connectivity);
        }
        if middles.nodes.len() > MAX_NODES {
            let count = middles.nodes.len();
            return fail(format!("{count} nodes are more than the {MAX_NODES} that are allowed"));
        }
        let facet = kind.facet();
        let mut boundaries = Vec::with_capacity(self.boundaries().len());
        for boundary in self.boundaries() {
            let mut facets = Vec::with_capacity(boundary.facet_count() * facet.nodes());
            for corners in boundary.facets() {
                middles.extend(corners, facet.reference().mid_sides, &mut facets);
            }
            boundaries.push(Boundary::new(boundary.name.as_str(), facet, facets));
        }
        Ok(Mesh::new(middles.nodes, kind, connectivity, boundaries)?.with_groups(self.groups().to_vec()))
    }

    /// The same with the nodes of a boundary moved along their radius onto a sphere.
    pub(crate) fn onto_sphere(mut self, boundary: &str, centre: [f64; 3], radius: f64) -> Self {
        for node in self.boundary(boundary).map_or_else(Vec::new, |boundary| boundary.nodes()) {
            let away = minus(self.nodes[node], centre);
            let stretch = radius / length(away);
            self.nodes[node] = [0, 1, 2].map(|axis| centre[axis] + stretch * away[axis]);
        }
        self
    }
}

/// The nodes so far, and the mid-edge nodes by the ends of their edges.
struct Middles {
    nodes: Vec<[f64; 3]>,
    of: HashMap<[usize; 2], usize>,
}

impl Middles {
    /// Adds the corners of a cell and the middles of its edges, in this order, to `connectivity`.
    fn extend(&mut self, corners: &[usize], edges: &[[usize; 2]], connectivity: &mut Vec<usize>) {
        connectivity.extend(corners);
        for edge in edges {
            let [a, b] = edge.map(|local| corners[local]);
            let middle = *self.of.entry(key(a, b)).or_insert_with(|| {
                let (one, other) = (self.nodes[a], self.nodes[b]);
                self.nodes.push([0, 1, 2].map(|axis| one[axis] + (other[axis] - one[axis]) / 2.0));
                self.nodes.len() - 1
            });
            connectivity.push(middle);
        }
    }
}
