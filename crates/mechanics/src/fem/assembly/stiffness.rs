//! K = sum of the element stiffnesses, in the free dofs, assembled directly into the lower triangle in compressed
//! columns.

use std::ops::Range;

use super::congruent::Congruent;
use super::element_blocks::{Block, ElementStiffness};
use super::pattern::lower_pattern;
use super::{DofMap, Frame, element_stiffness};
use crate::error::Error;
use crate::fem::body::ElasticBody;
use crate::fem::element::MAX_NODES;
use crate::fem::threads::{on_parts, parts};
use signorini_linear as linear;
use signorini_linear::{SparseMatrix, SymmetricMatrix};

/// The free dofs of one node: the number of the first, how many there are, and the axis of each: of the frame if the
/// node has one.
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
/// [`linear::Error::Length`] if `dofs` does not belong to the mesh, [`linear::Error::NotFinite`] if the stiffness
/// overflows.
pub fn stiffness(body: &ElasticBody, dofs: &DofMap) -> Result<SymmetricMatrix, Error> {
    body.check_nodal("dof map", dofs.nodal_count())?;
    let (starts, rows) = lower_pattern(body.mesh(), dofs);
    let mut values = vec![0.0; rows.len()];
    let parts = parts(body.mesh().element_count());
    // A part has the columns of whole nodes.
    let first_node = |part: usize| match part == parts {
        true => body.mesh().nodes().len(),
        false => {
            let column = starts.partition_point(|&start| start < rows.len() / parts * part);
            dofs.free().get(column).map_or(0, |dof| dof / body.dimension())
        }
    };
    let nodes: Vec<usize> = (0..=parts).map(first_node).collect();
    let first_column = |&node: &usize| dofs.free().partition_point(|&dof| dof < node * body.dimension());
    let bounds: Vec<usize> = nodes.iter().map(|node| starts[first_column(node)]).collect();
    let congruent = Congruent::of(body);
    on_parts(&mut values, &bounds, |part, values| {
        let columns =
            Columns { starts: &starts, rows: &rows, nodes: nodes[part]..nodes[part + 1], first: bounds[part] };
        columns.add_elements(body, dofs, &congruent, values);
    });
    if let Some(entry) = values.iter().position(|value| !value.is_finite()) {
        let at = format!("row {}", rows[entry]);
        return Err(linear::Error::NotFinite { name: "stiffness", at, value: values[entry], allowed: "finite" }.into());
    }
    Ok(SymmetricMatrix::from_lower(SparseMatrix::from_parts(dofs.free().len(), starts, rows, values))?)
}

/// The columns of some nodes that follow each other.
struct Columns<'a> {
    starts: &'a [usize],
    rows: &'a [u32],
    nodes: Range<usize>,
    /// The place of their first entry.
    first: usize,
}

impl Columns<'_> {
    /// Adds the elements around these nodes, in their order.
    fn add_elements(&self, body: &ElasticBody, dofs: &DofMap, congruent: &Congruent, values: &mut [f64]) {
        let tables = body.tabulated();
        let mut last: Option<(u32, ElementStiffness)> = None;
        for (element, nodes) in body.mesh().elements().enumerate() {
            if !nodes.iter().any(|node| self.nodes.contains(node)) {
                continue;
            }
            let representative = congruent.representative(element);
            let stiffness = match last.take() {
                Some((of, stiffness)) if of == representative => stiffness,
                _ => {
                    let Some(placed) = body.element(representative as usize) else { continue };
                    element_stiffness(body, &placed, tables.at(placed.kind))
                }
            };
            match dofs.basis.is_nodal() {
                true => self.add_element(nodes, dofs, body.dimension(), &stiffness, values),
                false => {
                    let mut changed = stiffness.clone();
                    dofs.basis.change(nodes, &mut changed);
                    self.add_element(nodes, dofs, body.dimension(), &changed, values);
                }
            }
            last = Some((representative, stiffness));
        }
    }

    fn add_element(
        &self,
        nodes: &[usize],
        dofs: &DofMap,
        dimension: usize,
        element: &ElementStiffness,
        values: &mut [f64],
    ) {
        let Columns { starts, rows, first, .. } = *self;
        let mut free = [FreeAxes::default(); MAX_NODES];
        for (of_node, &node) in free.iter_mut().zip(nodes) {
            *of_node = FreeAxes::of(node, dimension, dofs);
        }
        for a in 0..nodes.len() {
            for b in 0..=a {
                // The lower triangle has the later node as its row; free dofs are numbered in the order of the nodes.
                let mirrored = nodes[a] < nodes[b];
                let (row, column) = if mirrored { (&free[b], &free[a]) } else { (&free[a], &free[b]) };
                if row.count == 0 || column.count == 0 || !self.nodes.contains(&nodes[a].min(nodes[b])) {
                    continue;
                }
                let of_first = &rows[starts[column.first]..starts[column.first + 1]];
                let Ok(place) = of_first.binary_search(&(row.first as u32)) else { continue };
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
                    let start = starts[column.first + j] - first + place;
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
