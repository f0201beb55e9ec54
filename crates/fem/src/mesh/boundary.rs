//! Named parts of a mesh: boundaries of its surface, groups of elements, sets of nodes.

use std::collections::{BTreeMap, HashMap};

use crate::element::FacetKind;

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
    #[doc(hidden)]
    pub fn facet(&self, number: usize) -> &[usize] {
        let count = self.kind.nodes();
        &self.connectivity[number * count..(number + 1) * count]
    }

    /// The node indices, each once, from 0, in the order of their first appearance along the facets.
    pub fn nodes(&self) -> Vec<usize> {
        let reference = self.kind.reference();
        let along: Vec<usize> = match reference.dimension {
            1 => reference.straight.concat(),
            _ => (0..self.kind.nodes()).collect(),
        };
        let mut seen = vec![false; self.connectivity.iter().max().map_or(0, |&last| last + 1)];
        let in_order = self.facets().flat_map(|facet| along.iter().map(|&local| facet[local]));
        in_order.filter(|&node| !std::mem::replace(&mut seen[node], true)).collect()
    }
}

/// Elements with a name; an element may be in several groups, or in none.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementGroup {
    pub name: String,
    /// From 0, increasing.
    pub elements: Vec<usize>,
}

/// The nodes of a mesh by the names of their file: sets of nodes, and single nodes by their numbers. Those of a further
/// body begin with its name and a point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NodeNames {
    sets: BTreeMap<String, Vec<usize>>,
    /// For each body of a file the prefix of its names, its first node, and the number of each of its nodes.
    numbers: Vec<(String, usize, HashMap<usize, usize>)>,
}

impl NodeNames {
    /// Sets of nodes from 0, increasing, and the number of each node.
    pub fn new(sets: impl Iterator<Item = (String, Vec<usize>)>, numbers: Vec<usize>) -> Self {
        let numbers = numbers.into_iter().enumerate().map(|(node, number)| (number, node)).collect();
        NodeNames { sets: sets.collect(), numbers: vec![(String::new(), 0, numbers)] }
    }

    /// The nodes of a name, from 0: a set, or the number of a node.
    pub fn nodes(&self, name: &str) -> Option<Vec<usize>> {
        if let Some(set) = self.sets.get(name) {
            return Some(set.clone());
        }
        self.numbers.iter().find_map(|(prefix, first, numbers)| {
            let number: usize = name.strip_prefix(prefix.as_str())?.parse().ok()?;
            Some(vec![first + numbers.get(&number)?])
        })
    }

    /// The number of each of `count` nodes; `None` if some have none.
    pub fn numbers(&self, count: usize) -> Option<Vec<usize>> {
        let mut all = vec![None; count];
        for (_, first, numbers) in &self.numbers {
            numbers.iter().for_each(|(&number, &node)| all[first + node] = Some(number));
        }
        all.into_iter().collect()
    }

    pub fn sets(&self) -> impl Iterator<Item = &str> {
        self.sets.keys().map(String::as_str)
    }

    pub fn has_numbers(&self) -> bool {
        !self.numbers.is_empty()
    }

    /// Adds the names of a further body, whose first node is number `first`.
    pub fn extend(&mut self, other: &NodeNames, name: &str, first: usize) {
        for (set, nodes) in &other.sets {
            self.sets.insert(format!("{name}.{set}"), nodes.iter().map(|node| first + node).collect());
        }
        for (prefix, own, numbers) in &other.numbers {
            self.numbers.push((format!("{name}.{prefix}"), first + own, numbers.clone()));
        }
    }
}
