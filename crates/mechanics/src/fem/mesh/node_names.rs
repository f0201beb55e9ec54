//! Names of nodes: the node sets and the numbers of a mesh file.

use std::collections::{BTreeMap, HashMap};

/// The nodes of a mesh by the names of their file: sets of nodes, and single nodes by their numbers. Those of a further
/// body begin with its name and a point.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct NodeNames {
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
