//! The stiffness of one element, block by block, and changes of its shape functions.

/// A block for a pair of nodes: row axis, column axis.
pub(super) type Block = [[f64; 3]; 3];

/// The stiffness of one element, in force per length: a block for every pair of its nodes.
#[derive(Clone, Debug)]
pub struct ElementStiffness {
    blocks: Vec<Block>,
}

impl ElementStiffness {
    /// From the blocks of nodes a >= b, pair by pair.
    pub(super) fn of(blocks: Vec<Block>) -> Self {
        ElementStiffness { blocks }
    }

    /// The block of local nodes `a >= b`: entry `[i][j]` is the force on `a` along axis i per displacement of `b` along
    /// axis j. The block of (b, a) is its transpose.
    #[inline]
    pub fn block(&self, a: usize, b: usize) -> &Block {
        &self.blocks[pair(a, b)]
    }

    /// Adds `factor` times the function of local node `other` to that of `node`, in rows and columns of the stiffness.
    pub(super) fn add_function(&mut self, node: usize, other: usize, factor: f64) {
        let nodes = (0..).take_while(|&count| pair(count, 0) < self.blocks.len()).count();
        let of = |blocks: &[Block], a: usize, b: usize| match a >= b {
            true => blocks[pair(a, b)],
            false => transposed(&blocks[pair(b, a)]),
        };
        let own = of(&self.blocks, node, node);
        let (across, beyond) = (of(&self.blocks, node, other), of(&self.blocks, other, other));
        for third in (0..nodes).filter(|&third| third != node) {
            let (mut sum, part) = (of(&self.blocks, node, third), of(&self.blocks, other, third));
            each(&mut sum, |i, j, entry| *entry += factor * part[i][j]);
            match node >= third {
                true => self.blocks[pair(node, third)] = sum,
                false => self.blocks[pair(third, node)] = transposed(&sum),
            }
        }
        let mut sum = own;
        each(&mut sum, |i, j, entry| *entry += factor * (across[i][j] + across[j][i] + factor * beyond[i][j]));
        self.blocks[pair(node, node)] = sum;
    }

    /// Multiplies the function of a local node.
    pub(super) fn scale_function(&mut self, node: usize, factor: f64) {
        let nodes = (0..).take_while(|&count| pair(count, 0) < self.blocks.len()).count();
        for other in 0..nodes {
            let square = if other == node { factor } else { 1.0 };
            each(&mut self.blocks[pair(node.max(other), node.min(other))], |_, _, entry| *entry *= factor * square);
        }
    }
}

fn transposed(block: &Block) -> Block {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| block[j][i]))
}

/// Changes every entry of a block, given with its row and its column.
fn each(block: &mut Block, mut change: impl FnMut(usize, usize, &mut f64)) {
    for (i, row) in block.iter_mut().enumerate() {
        row.iter_mut().enumerate().for_each(|(j, entry)| change(i, j, entry));
    }
}

/// The index of nodes a >= b among the pairs of an element.
#[inline]
pub(super) fn pair(a: usize, b: usize) -> usize {
    a * (a + 1) / 2 + b
}
