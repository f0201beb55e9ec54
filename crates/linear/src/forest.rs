//! Connected components.

/// Connected components by union and find: each unknown points towards the first of its tree. For the crates of this
/// workspace.
#[derive(Clone)]
pub struct Forest {
    parent: Vec<usize>,
    trees: usize,
}

impl Forest {
    /// A tree for each unknown.
    pub fn new(unknowns: usize) -> Self {
        Forest { parent: (0..unknowns).collect(), trees: unknowns }
    }

    /// Returns `true` if nothing is left to join.
    pub fn is_one_tree(&self) -> bool {
        self.trees <= 1
    }

    fn root(&mut self, mut unknown: usize) -> usize {
        while self.parent[unknown] != unknown {
            self.parent[unknown] = self.parent[self.parent[unknown]];
            unknown = self.parent[unknown];
        }
        unknown
    }

    /// Joins the trees of two unknowns into one.
    pub fn join(&mut self, a: usize, b: usize) {
        if self.parent[a] == self.parent[b] {
            return;
        }
        let (a, b) = (self.root(a), self.root(b));
        self.trees -= usize::from(a != b);
        self.parent[a.max(b)] = a.min(b);
    }

    /// The number of the tree of each unknown, in the order of their first unknowns, and the number of trees.
    pub fn into_trees(mut self) -> (Vec<usize>, usize) {
        let mut tree = Vec::with_capacity(self.parent.len());
        let mut count = 0;
        for unknown in 0..self.parent.len() {
            // A root comes before the rest of its tree.
            let root = self.root(unknown);
            if root == unknown {
                tree.push(count);
                count += 1;
            } else {
                tree.push(tree[root]);
            }
        }
        (tree, count)
    }
}
