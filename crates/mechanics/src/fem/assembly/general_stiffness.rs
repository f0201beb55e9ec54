//! The stiffness of one element of any material: `K_ab = sum_q w B_a' C B_b`, B_a the engineering strains of a unit
//! displacement of node a along each axis.

use super::element_blocks::{Block, pair};
use crate::fem::body::{ElasticBody, LocalPoint};
use crate::fem::element::{Cell, Tabulated};
use crate::fem::geometry::{Symmetric, turned};
use crate::fem::material::Matrices;

/// The blocks of all pairs of nodes, for the stiffness C. Where its axes turn, strains are turned into them.
pub(super) fn general_stiffness(body: &ElasticBody, matrices: &Matrices, table: &Tabulated, cell: &Cell) -> Vec<Block> {
    let nodes = table.reference.nodes.len();
    // Gradients are per unit of the cell and determinants in powers of the unit: this is the remaining power.
    let scale = cell.unit().powi(table.reference.dimension as i32 - 2);
    let mut blocks = vec![[[0.0; 3]; 3]; pair(nodes, 0)];
    for at in &table.points {
        let point = body.point(cell, at);
        let weight = point.weight * scale;
        let mut strains: Vec<[Symmetric; 3]> = (0..nodes).map(|node| unit_strains(&point, node)).collect();
        if let Some(axes) = matrices.axes(|| cell.place(&at.shape)) {
            strains.iter_mut().flatten().for_each(|strain| *strain = along(*strain, &axes));
        }
        for (a, of_a) in strains.iter().enumerate() {
            let stresses = of_a.map(|strain| {
                let stress =
                    matrices.stiffness.map(|row| row.iter().zip(strain).map(|(entry, part)| entry * part).sum::<f64>());
                stress.map(|component| weight * component)
            });
            for (b, of_b) in strains.iter().enumerate().take(a + 1) {
                let block = &mut blocks[pair(a, b)];
                for (row, stress) in block.iter_mut().zip(&stresses) {
                    for (entry, strain) in row.iter_mut().zip(of_b) {
                        *entry += stress.iter().zip(strain).map(|(stress, part)| stress * part).sum::<f64>();
                    }
                }
            }
        }
    }
    blocks
}

/// Engineering strains along axes.
fn along([xx, yy, zz, xy, yz, zx]: Symmetric, axes: &[[f64; 3]; 3]) -> Symmetric {
    let [xx, yy, zz, xy, yz, zx] = turned([xx, yy, zz, xy / 2.0, yz / 2.0, zx / 2.0], axes);
    [xx, yy, zz, 2.0 * xy, 2.0 * yz, 2.0 * zx]
}

/// The engineering strains of a unit displacement of a node along x, y and z.
fn unit_strains(point: &LocalPoint, node: usize) -> [Symmetric; 3] {
    let [x, y, z] = point.gradients[node];
    [[x, 0.0, point.hoop[node], y, 0.0, z], [0.0, y, 0.0, x, z, 0.0], [0.0, 0.0, z, 0.0, y, x]]
}
