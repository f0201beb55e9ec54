//! Springs between nodes and the ground: K_ab = integral over a boundary of k N_a N_b n n', or k n n' at a node; and
//! between nodes: with the elongation e = sum of c_a . u_a, K_ab = k c_a c_b'.

use std::collections::BTreeMap;

use super::DofMap;
use super::element_stiffness::Block;
use super::load::for_each_point;
use crate::body::ElasticBody;
use crate::geometry::{length, unit};
use crate::mesh::Boundary;
use crate::sum::LinearForm;

/// Forces on some nodes, in force.
pub type NodalForces = BTreeMap<usize, [f64; 3]>;

/// Springs, in force per length.
#[derive(Clone, Debug, Default)]
pub struct Springs {
    /// The force on the first node against the displacement of the second node; every pair in both orders.
    pub(super) pairs: Vec<(usize, usize, Block)>,
    /// The elongation of a spring between nodes; without terms for springs to the ground.
    elongation: LinearForm,
    /// Of a foundation the stiffness along each axis and along the normal, in force per volume.
    pub per_area: Option<([f64; 3], f64)>,
    /// The forces on nodes that do not move.
    strained: Vec<(usize, [f64; 3])>,
}

impl Springs {
    /// Springs at a node, a stiffness along each axis.
    pub fn at_node(node: usize, along: [f64; 3]) -> Self {
        Springs { pairs: vec![(node, node, diagonal(along))], ..Springs::default() }
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
        Springs { pairs, per_area: Some((along, normal)), ..Springs::default() }
    }

    /// A spring along an elongation: a form in the displacements of nodes, and a length.
    pub fn between(elongation: LinearForm, longer: f64, stiffness: f64) -> Self {
        let terms = &elongation.terms;
        let mut pairs = Vec::with_capacity(terms.len() * terms.len());
        for (a, of_a) in terms {
            for (b, of_b) in terms {
                pairs.push((*a, *b, of_a.map(|i| of_b.map(|j| stiffness * i * j))));
            }
        }
        let force = |vector: [f64; 3]| vector.map(|part| 0.0 - stiffness * longer * part);
        let strained = terms.iter().map(|&(node, vector)| (node, force(vector))).collect();
        Springs { pairs, elongation, strained, per_area: None }
    }

    /// The forces of the springs on their nodes at a nodal displacement.
    pub fn forces(&self, displacement: &[f64], dimension: usize) -> NodalForces {
        let mut forces = NodalForces::new();
        for (a, b, block) in &self.pairs {
            let force = forces.entry(*a).or_default();
            for i in 0..dimension {
                let along: f64 = (0..dimension).map(|j| block[i][j] * displacement[dimension * b + j]).sum();
                force[i] -= along;
            }
        }
        for (node, force) in &self.strained {
            forces.entry(*node).or_default().iter_mut().zip(force).for_each(|(sum, part)| *sum += part);
        }
        forces
    }

    /// The force that holds the nodes for which `place` gives a number against the displacement of all nodes: entries
    /// `(nodal dof of the displacement, dimension * number + axis of the force, force per length)`.
    pub fn columns(&self, place: impl Fn(usize) -> Option<usize>, dimension: usize) -> Vec<(usize, usize, f64)> {
        let mut entries = Vec::new();
        for (a, b, block) in &self.pairs {
            let Some(place) = place(*a) else { continue };
            for (i, of_row) in block.iter().enumerate().take(dimension) {
                let of_force = dimension * place + i;
                let nonzero = of_row.iter().enumerate().take(dimension).filter(|entry| *entry.1 != 0.0);
                entries.extend(nonzero.map(|(j, &value)| (dimension * b + j, of_force, value)));
            }
        }
        entries
    }

    /// The motions that the springs resist: sums of displacements of nodes along vectors, of which the longest is a
    /// unit vector.
    pub fn resisted(&self) -> Vec<Vec<(usize, [f64; 3])>> {
        let terms = &self.elongation.terms;
        if !terms.is_empty() {
            let longest = terms.iter().fold(0.0, |longest: f64, (_, vector)| longest.max(length(*vector)));
            return vec![terms.iter().map(|(node, vector)| (*node, vector.map(|part| part / longest))).collect()];
        }
        let own = self.pairs.iter().filter(|(a, b, _)| a == b);
        let rows = own.flat_map(|(node, _, block)| block.iter().map(move |row| (*node, *row)));
        let directions = rows.map(|(node, row)| (node, unit(row))).filter(|(_, direction)| *direction != [0.0; 3]);
        directions.map(|held| vec![held]).collect()
    }

    /// The nodes whose unknowns a spring between nodes couples.
    pub(super) fn coupled(&self, dofs: &DofMap) -> Vec<usize> {
        self.elongation.terms.iter().flat_map(|&(node, _)| dofs.basis.values(node).map(|(of, _)| of)).collect()
    }
}

fn diagonal(along: [f64; 3]) -> Block {
    let mut block = [[0.0; 3]; 3];
    (0..3).for_each(|axis| block[axis][axis] = along[axis]);
    block
}
