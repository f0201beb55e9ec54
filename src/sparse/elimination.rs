//! What an order of elimination brings with it: the elimination tree and the work of the factorisation.

use super::quotient::Quotient;

/// Where a group has no parent in the elimination tree.
const NONE: u32 = u32::MAX;

/// The elimination of the groups of a quotient graph in some order.
pub(super) struct Elimination {
    order: Vec<u32>,
    /// Parent of each group in the elimination tree, both by position in the order.
    parent: Vec<u32>,
    /// Multiplications of the factorisation, about.
    pub multiplications: f64,
}

impl Elimination {
    /// Eliminates the groups in the given order; those without columns are left out.
    ///
    /// # Source
    /// J. W. H. Liu, *The role of elimination trees in sparse factorization*, SIAM J. Matrix Anal. Appl. 11 (1990),
    /// 134-172.
    pub fn of(quotient: &Quotient, mut order: Vec<u32>) -> Self {
        order.retain(|&group| !quotient.members(group).is_empty());
        let mut place = vec![NONE; quotient.count()];
        order.iter().enumerate().for_each(|(position, &group)| place[group as usize] = position as u32);
        let mut parent = vec![NONE; order.len()];
        let mut walked = vec![NONE; order.len()];
        // Columns below each group in the factor, counted as the rows of the factor are walked through the tree.
        let mut height = vec![0_u32; order.len()];
        for (position, &group) in order.iter().enumerate() {
            let (row, size) = (position as u32, quotient.members(group).len() as u32);
            walked[position] = row;
            for &neighbour in quotient.neighbours(group) {
                let mut at = place[neighbour as usize];
                while at < row && walked[at as usize] != row {
                    if parent[at as usize] == NONE {
                        parent[at as usize] = row;
                    }
                    height[at as usize] += size;
                    walked[at as usize] = row;
                    at = parent[at as usize];
                }
            }
        }
        let work = |(position, &group): (usize, &u32)| {
            let (size, below) = (quotient.members(group).len() as f64, f64::from(height[position]));
            size * (below + size / 2.0) * (below + size / 2.0) / 2.0
        };
        let multiplications = order.iter().enumerate().map(work).sum();
        Elimination { order, parent, multiplications }
    }

    /// The groups with every one behind all of its descendants and these next to each other.
    pub fn postorder(&self) -> Vec<u32> {
        let count = self.parent.len();
        let (mut first_child, mut sibling) = (vec![NONE; count], vec![NONE; count]);
        let mut first_root = NONE;
        for position in (0..count).rev() {
            let list = match self.parent[position] {
                NONE => &mut first_root,
                above => &mut first_child[above as usize],
            };
            sibling[position] = std::mem::replace(list, position as u32);
        }
        let mut ordered = Vec::with_capacity(count);
        let mut stack = Vec::new();
        let mut root = first_root;
        while root != NONE {
            stack.push(root);
            while let Some(&top) = stack.last() {
                match std::mem::replace(&mut first_child[top as usize], NONE) {
                    NONE => {
                        ordered.push(self.order[top as usize]);
                        stack.pop();
                    }
                    child => {
                        // All children wait on the stack, the first on top.
                        let from = stack.len();
                        let mut next = child;
                        while next != NONE {
                            stack.push(next);
                            next = sibling[next as usize];
                        }
                        stack[from..].reverse();
                    }
                }
            }
            root = sibling[root as usize];
        }
        ordered
    }
}
