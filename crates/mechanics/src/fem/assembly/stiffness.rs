//! K = sum of the element stiffnesses, in the free dofs, assembled directly into the lower triangle in compressed columns.

use super::element_blocks::Block;
use super::pattern::lower_pattern;
use super::{DofMap, Frame, element_stiffness};
use crate::error::Error;
use crate::fem::body::ElasticBody;
use crate::fem::element::MAX_NODES;
use signorini_qp as qp;
use signorini_qp::{SparseMatrix, SymmetricMatrix};

/// The free dofs of one node: the number of the first, how many there are, and the axis of each: of the frame if the node has one.
#[derive(Clone, Copy, Default)]
struct FreeAxes<'a> {
    first: usize,
    count: usize,
    axes: [usize; 3],
    frame: Option<&'a Frame>,
}

impl<'a> FreeAxes<'a> {
    fn of(node: usize, dimension: usize, dofs: &'a DofMap) -> Self {
        let mut free = FreeAxes { frame: dofs.frame(node), ..FreeAxes::default() };
        for axis in 0..dimension {
            if let Some(number) = dofs.number(dimension * node + axis) {
                if free.count == 0 {
                    free.first = number;
                }
                free.axes[free.count] = axis;
                free.count += 1;
            }
        }
        free
    }
}

/// The stiffness K of the free dofs (n x n), in force per length; only its lower triangle is ever built.
///
/// # Errors
/// [`qp::Error::Length`] if `dofs` does not belong to the mesh, [`qp::Error::NotFinite`] if the stiffness overflows.
pub fn stiffness(body: &ElasticBody, dofs: &DofMap) -> Result<SymmetricMatrix, Error> {
    body.check_nodal("dof map", dofs.nodal_count())?;
    let dimension = body.dimension();
    let (starts, rows) = lower_pattern(body.mesh(), dofs);
    let mut values = vec![0.0; rows.len()];
    let tables = body.tabulated();
    for placed in body.elements() {
        let nodes = placed.nodes;
        let mut element = element_stiffness(body, &placed, tables.at(placed.kind));
        dofs.basis.change(nodes, &mut element);
        let mut free = [FreeAxes::default(); MAX_NODES];
        for (of_node, &node) in free.iter_mut().zip(nodes) {
            *of_node = FreeAxes::of(node, dimension, dofs);
        }
        for a in 0..nodes.len() {
            for b in 0..=a {
                // The lower triangle has the later node as its row; free dofs are numbered in the order of the nodes.
                let mirrored = nodes[a] < nodes[b];
                let (row, column) = if mirrored { (&free[b], &free[a]) } else { (&free[a], &free[b]) };
                if row.count == 0 || column.count == 0 {
                    continue;
                }
                let of_first = &rows[starts[column.first]..starts[column.first + 1]];
                let Ok(place) = of_first.binary_search(&row.first) else { continue };
                let turned;
                let block = match (free[a].frame, free[b].frame) {
                    (None, None) => element.block(a, b),
                    frames => {
                        turned = turn(element.block(a, b), frames.0, frames.1);
                        &turned
                    }
                };
                for (j, &along) in column.axes[..column.count].iter().enumerate() {
                    // Each column of a node starts one row further down; rows of one node follow each other.
                    let start = starts[column.first + j] + place;
                    let skipped = if a == b { j } else { 0 };
                    for i in skipped..row.count {
                        let axis = row.axes[i];
                        let value = if mirrored { block[along][axis] } else { block[axis][along] };
                        values[start + i - j] += value;
                    }
                }
            }
        }
    }
    if let Some(entry) = values.iter().position(|value| !value.is_finite()) {
        let at = format!("row {}", rows[entry]);
        return Err(qp::Error::NotFinite { name: "stiffness", at, value: values[entry], allowed: "finite" }.into());
    }
    Ok(SymmetricMatrix::from_lower(SparseMatrix::from_parts(dofs.free().len(), starts, rows, values))?)
}

/// T_a K_ab T_b'; the rows of T are the axes of a frame.
fn turn(block: &Block, of_rows: Option<&Frame>, of_columns: Option<&Frame>) -> Block {
    let mut turned = *block;
    if let Some(frame) = of_columns {
        turned.iter_mut().for_each(|row| frame.turn_in(row));
    }
    if let Some(frame) = of_rows {
        for j in 0..3 {
            let mut column = turned.map(|row| row[j]);
            frame.turn_in(&mut column);
            turned.iter_mut().zip(column).for_each(|(row, entry)| row[j] = entry);
        }
    }
    turned
}
