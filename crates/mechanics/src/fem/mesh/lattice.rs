//! Nodes of structured meshes by their position in a lattice, and cells cut into elements.
//!
//! Keys count half steps, so that mid-sides have keys too; only nodes that an element uses are made.

use std::collections::HashMap;
use std::hash::Hash;

use super::ElementKind;

/// The nodes made so far.
pub(crate) struct Lattice<K> {
    numbers: HashMap<K, usize>,
    /// The keys in the order of the nodes.
    pub keys: Vec<K>,
}

impl<K: Copy + Eq + Hash> Lattice<K> {
    pub fn new() -> Self {
        Lattice { numbers: HashMap::new(), keys: Vec::new() }
    }

    pub fn node(&mut self, key: K) -> usize {
        *self.numbers.entry(key).or_insert_with(|| {
            self.keys.push(key);
            self.keys.len() - 1
        })
    }

    /// Adds the elements of a plane cell. `key` gives the key at half steps 0, 1, 2 in the two directions of the
    /// cell, which turn counterclockwise; triangles are cut from (0, 0) to (2, 2).
    pub fn add_cell(&mut self, kind: ElementKind, key: impl Fn(usize, usize) -> K, connectivity: &mut Vec<usize>) {
        const QUADRILATERAL: [&[[usize; 2]]; 1] = [&[[0, 0], [2, 0], [2, 2], [0, 2]]];
        const TRIANGLES: [&[[usize; 2]]; 2] = [&[[0, 0], [2, 0], [2, 2]], &[[0, 0], [2, 2], [0, 2]]];
        let parts: &[&[[usize; 2]]] = if kind.corners() == 4 { &QUADRILATERAL } else { &TRIANGLES };
        for corners in parts {
            connectivity.extend(corners.iter().map(|&[a, b]| self.node(key(a, b))));
            if kind.is_quadratic() {
                let next = corners.iter().cycle().skip(1);
                let middles = corners.iter().zip(next).map(|(p, q)| [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2]);
                connectivity.extend(middles.map(|[a, b]| self.node(key(a, b))));
            }
        }
    }
}

/// The lines of an axis at half steps: the mean of each two lines is inserted between them.
pub(crate) fn half_steps(lines: &[f64]) -> Vec<f64> {
    let mut fine = Vec::with_capacity(2 * lines.len());
    for (index, &line) in lines.iter().enumerate() {
        if index > 0 {
            let before = lines[index - 1];
            fine.push(before + (line - before) / 2.0);
        }
        fine.push(line);
    }
    fine
}
