//! Springs between nodes and the ground: K_ab = integral over a boundary of k N_a N_b n n', or k n n' at a node.

use super::DofMap;
use super::element_blocks::Block;
use super::surface::for_each_point;
use crate::error::Error;
use crate::fem::body::ElasticBody;
use crate::fem::geometry::COORDINATES;
use crate::fem::mesh::Boundary;
use signorini_qp as qp;
use signorini_qp::{SparseMatrix, SymmetricMatrix};

/// Springs to the ground, in force per length.
#[derive(Clone, Debug, Default)]
pub(crate) struct Springs {
    /// The force on the first node against the displacement of the second node; every pair in both orders.
    pairs: Vec<(usize, usize, Block)>,
}

impl Springs {
    /// Springs at a node, a stiffness along each axis.
    pub fn at_node(node: usize, along: [f64; 3]) -> Self {
        Springs { pairs: vec![(node, node, diagonal(along))] }
    }

    /// A foundation under a boundary: the stiffness (per area) along each axis and along the normal.
    pub fn under(body: &ElasticBody, boundary: &Boundary, along: [f64; 3], normal: f64) -> Self {
        let mut pairs = Vec::new();
        for_each_point(body, boundary, &mut |point| {
            let mut block = diagonal(along);
            for (row, i) in block.iter_mut().zip(point.normal) {
                row.iter_mut().zip(point.normal).for_each(|(entry, j)| *entry += normal * i * j);
            }
            for (&a, of_a) in point.nodes.iter().zip(point.shape) {
                for (&b, of_b) in point.nodes.iter().zip(point.shape) {
                    let weight = point.area * of_a * of_b;
                    pairs.push((a, b, block.map(|row| row.map(|entry| weight * entry))));
                }
            }
        });
        Springs { pairs }
    }

    /// The forces of the springs on the nodes (length `dim * n_nodes`) at a nodal displacement.
    pub fn forces(&self, displacement: &[f64], dimension: usize) -> Vec<f64> {
        let mut forces = vec![0.0; displacement.len()];
        for (a, b, block) in &self.pairs {
            for i in 0..dimension {
                let along: f64 = (0..dimension).map(|j| block[i][j] * displacement[dimension * b + j]).sum();
                forces[dimension * a + i] -= along;
            }
        }
        forces
    }

    /// The directions in which nodes are held, as unit vectors, each with its node.
    pub fn held(&self) -> impl Iterator<Item = (usize, [f64; 3])> + '_ {
        let own = self.pairs.iter().filter(|(a, b, _)| a == b);
        own.flat_map(|(node, _, block)| block.iter().map(move |row| (*node, *row))).filter_map(|(node, row)| {
            let length = row.iter().fold(0.0, |length: f64, part| length.hypot(*part));
            (length > 0.0).then(|| (node, row.map(|part| part / length)))
        })
    }

    /// The stiffness of the free dofs with the springs added.
    ///
    /// # Errors
    /// [`qp::Error::NotFinite`] if it overflows.
    pub fn added_to(
        &self,
        stiffness: &SymmetricMatrix,
        dofs: &DofMap,
        dimension: usize,
    ) -> Result<SymmetricMatrix, Error> {
        let mut entries: Vec<(usize, usize, f64)> = stiffness.lower().triplets().collect();
        let along = |node: usize, axis: usize| dofs.displacement_along(node, &COORDINATES[axis][..dimension]).free;
        for (a, b, block) in &self.pairs {
            for (i, of_row) in block.iter().enumerate().take(dimension) {
                for (j, &stiffness) in of_row.iter().enumerate().take(dimension).filter(|entry| *entry.1 != 0.0) {
                    let of_b = along(*b, j);
                    for (row, one) in along(*a, i) {
                        let product = |&(column, other): &(usize, f64)| (row, column, stiffness * one * other);
                        entries.extend(of_b.iter().filter(|entry| entry.0 <= row).map(product));
                    }
                }
            }
        }
        if let Some((row, _, value)) = entries.iter().find(|entry| !entry.2.is_finite()) {
            let at = format!("row {row}");
            return Err(qp::Error::NotFinite { name: "stiffness", at, value: *value, allowed: "finite" }.into());
        }
        Ok(SymmetricMatrix::from_lower(SparseMatrix::from_triplets(stiffness.dim(), stiffness.dim(), &entries)?)?)
    }
}

fn diagonal(along: [f64; 3]) -> Block {
    let mut block = [[0.0; 3]; 3];
    (0..3).for_each(|axis| block[axis][axis] = along[axis]);
    block
}
