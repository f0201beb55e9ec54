//! The nodes of surfaces: their own alone among those of a mesh; and at corners, where facets turn away from each
//! other, one for each side, with a normal and a row of its own.

use super::data::Found;
use super::facet::{Facet, SurfaceMesh};
use crate::fem::element::FacetKind;

/// A surface with nodes of its own.
pub(super) struct Sided {
    nodes: Vec<[f64; 3]>,
    facets: Vec<usize>,
    /// The node of the surface that each of its nodes is.
    pub node: Vec<usize>,
}

impl Sided {
    /// A surface with those of its nodes that facets have, in their order.
    pub fn alone(surface: &SurfaceMesh) -> Self {
        let mut node = surface.facets.to_vec();
        node.sort_unstable();
        node.dedup();
        let place = |one: &usize| node.partition_point(|other| other < one);
        let facets = surface.facets.iter().map(place).collect();
        Sided { nodes: node.iter().map(|&node| surface.nodes[node]).collect(), facets, node }
    }

    /// A surface in which a node at a corner is several nodes at one place, one for each side.
    pub fn of(surface: &SurfaceMesh) -> Self {
        let count = surface.kind.nodes();
        let facets: Vec<Facet> = surface.facets.chunks_exact(count).map(|nodes| Facet::new(surface, nodes)).collect();
        let mut around: Vec<Vec<usize>> = vec![Vec::new(); surface.nodes.len()];
        for (number, facet) in facets.iter().enumerate() {
            facet.nodes.iter().for_each(|&node| around[node].push(number));
        }
        let node = (0..surface.nodes.len()).collect();
        let mut sided = Sided { nodes: surface.nodes.to_vec(), facets: surface.facets.to_vec(), node };
        for (node, mut left) in around.into_iter().enumerate() {
            let mut is_first = true;
            while let Some(first) = left.pop() {
                // All facets that are alike, one to the next, are one side.
                let mut side = vec![first];
                let mut next = 0;
                while let Some(&one) = side.get(next) {
                    next += 1;
                    let (alike, others) = left.into_iter().partition(|&other| facets[one].is_alike(&facets[other]));
                    side.extend::<Vec<usize>>(alike);
                    left = others;
                }
                if !is_first {
                    for facet in side {
                        let own = &mut sided.facets[count * facet..count * (facet + 1)];
                        own.iter_mut().filter(|own| **own == node).for_each(|own| *own = sided.nodes.len());
                    }
                    sided.nodes.push(surface.nodes[node]);
                    sided.node.push(node);
                }
                is_first = false;
            }
        }
        sided
    }

    pub fn has_corners(&self) -> bool {
        self.node.last().is_some_and(|&last| last + 1 < self.node.len())
    }

    /// The surface with these nodes.
    pub fn surface(&self, kind: FacetKind) -> SurfaceMesh<'_> {
        SurfaceMesh { nodes: &self.nodes, kind, facets: &self.facets }
    }
}

/// The same with the nodes of both surfaces.
pub(super) fn named(mut found: Found, [slave, master]: [&[usize]; 2]) -> Found {
    let renamed = |list: &mut Vec<(usize, f64)>, nodes: &[usize]| {
        let mut sums: Vec<(usize, f64)> = Vec::with_capacity(list.len());
        for (node, share) in list.drain(..) {
            match sums.iter_mut().find(|sum| sum.0 == nodes[node]) {
                Some(sum) => sum.1 += share,
                None => sums.push((nodes[node], share)),
            }
        }
        *list = sums;
    };
    for row in &mut found.rows {
        row.node = slave[row.node];
        renamed(&mut row.slave, slave);
        renamed(&mut row.master, master);
    }
    for (nodes, _) in &mut found.facets {
        nodes.iter_mut().for_each(|node| *node = slave[*node]);
        nodes.sort_unstable();
    }
    for seen in &mut found.opposite {
        seen.node = master[seen.node];
        renamed(&mut seen.slave, slave);
    }
    found
}
