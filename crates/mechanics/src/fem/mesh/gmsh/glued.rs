//! Groups of elements that share nodes: glued, they are one body.

use signorini_linear::Forest;

use super::file::GmshFile;

/// Groups of elements of the highest dimension that share nodes with each other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Glued {
    /// Their names, in the order of the file.
    pub groups: Vec<String>,
    /// The pairs of groups that share nodes, by their places in `groups`, with the number of these nodes.
    pub shared: Vec<(usize, usize, usize)>,
}

impl GmshFile {
    /// The groups of elements of the highest dimension, those that share nodes together: each set is a body. Empty
    /// without groups.
    pub(crate) fn glued(&self) -> Vec<Glued> {
        let names = self.bodies();
        let Some(highest) = self.blocks.iter().map(|block| block.cell.dimension).max() else { return Vec::new() };
        let mut used = vec![vec![false; self.nodes.len()]; names.len()];
        for block in self.blocks.iter().filter(|block| block.cell.dimension == highest) {
            for name in block.groups.iter().map(|&tag| self.name_of(highest, tag)) {
                if let Some(group) = names.iter().position(|other| *other == name) {
                    block.nodes.iter().for_each(|&node| used[group][node] = true);
                }
            }
        }
        let shared = |one: usize, two: usize| used[one].iter().zip(&used[two]).filter(|(a, b)| **a && **b).count();
        let mut forest = Forest::new(names.len());
        let mut pairs = Vec::new();
        for two in 1..names.len() {
            for one in (0..two).filter(|&one| shared(one, two) > 0) {
                pairs.push((one, two, shared(one, two)));
                forest.join(one, two);
            }
        }
        let (sets, count) = forest.into_trees();
        let set = |set: usize| {
            let members: Vec<usize> = (0..names.len()).filter(|&group| sets[group] == set).collect();
            let place = |group: usize| members.iter().position(|&member| member == group);
            let own = pairs.iter().filter_map(|&(one, two, nodes)| Some((place(one)?, place(two)?, nodes)));
            Glued { shared: own.collect(), groups: members.iter().map(|&group| names[group].clone()).collect() }
        };
        (0..count).map(set).collect()
    }
}
