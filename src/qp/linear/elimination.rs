//! Results of an order of elimination: the elimination tree and the work of the factorisation.

use super::quotient::Quotient;

/// Marks a group without a parent in the elimination tree.
const NONE: u32 = u32::MAX;

/// The elimination of the groups of a quotient graph in some order.
pub(super) struct Elimination {
    order: Vec<u32>,
    /// Position of each group in the order; `NONE` for those left out.
    place: Vec<u32>,
    /// Parent of each group in the elimination tree, both by position in the order.
    parent: Vec<u32>,
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
        let (mut parent, mut ancestor) = (vec![NONE; order.len()], vec![NONE; order.len()]);
        for (position, &group) in order.iter().enumerate() {
            let row = position as u32;
            for &neighbour in quotient.neighbours(group) {
                let mut at = place[neighbour as usize];
                while at < row {
                    let above = std::mem::replace(&mut ancestor[at as usize], row);
                    if above == NONE {
                        parent[at as usize] = row;
                    }
                    at = above;
                }
            }
        }
        Elimination { order, place, parent }
    }

    /// Multiplications of the factorisation, approximately. The rows of the factor are followed through the tree, which takes
    /// one step for each entry of the factor of the quotient graph.
    pub fn multiplications(&self, quotient: &Quotient) -> f64 {
        let mut walked = vec![NONE; self.order.len()];
        let mut below = vec![0_u32; self.order.len()];
        for (position, &group) in self.order.iter().enumerate() {
            let (row, size) = (position as u32, quotient.members(group).len() as u32);
            for &neighbour in quotient.neighbours(group) {
                let mut at = self.place[neighbour as usize];
                while at < row && walked[at as usize] != row {
                    below[at as usize] += size;
                    walked[at as usize] = row;
                    at = self.parent[at as usize];
                }
            }
        }
        let work = |(&group, &below): (&u32, &u32)| {
            let size = quotient.members(group).len() as f64;
            size * (f64::from(below) + size / 2.0).powi(2) / 2.0
        };
        self.order.iter().zip(&below).map(work).sum()
    }

    /// The groups in postorder: each after all of its descendants, and these next to each other.
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
