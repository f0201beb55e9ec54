//! K = sum of the element stiffnesses, in the free dofs; and the internal forces sum_e t B' sigma.

use super::DofMap;
use crate::body::{ElasticBody, gather};
use crate::error::Error;
use crate::sparse::{SparseMatrix, SymmetricMatrix};

/// The stiffness K of the free dofs, in force per length; only its lower triangle is ever built.
///
/// # Errors
/// [`Error::Length`] where `dofs` does not belong to the mesh, [`Error::NotFinite`] where the stiffness overflows.
pub fn stiffness(body: &ElasticBody, dofs: &DofMap) -> Result<SymmetricMatrix, Error> {
    check_length("dof map", dofs.nodal_count(), body)?;
    let (starts, rows) = pattern(body, dofs);
    let mut values = vec![0.0; rows.len()];
    let constitutive = body.material().constitutive();
    for (nodes, cell) in body.cells() {
        let element = cell.stiffness(&constitutive, body.thickness());
        let free = || {
            let of_node = |(local, &node): (usize, &usize)| {
                [0, 1].map(|axis| dofs.number(2 * node + axis).map(|number| (2 * local + axis, number)))
            };
            nodes.iter().enumerate().flat_map(of_node).flatten()
        };
        for (j, column) in free() {
            for (i, row) in free().filter(|entry| entry.1 >= column) {
                let range = starts[column]..starts[column + 1];
                if let Ok(place) = rows[range.clone()].binary_search(&row) {
                    values[range.start + place] += element[(i, j)];
                }
            }
        }
    }
    if let Some(entry) = values.iter().position(|value| !value.is_finite()) {
        let at = format!("row {}", rows[entry]);
        return Err(Error::NotFinite { name: "stiffness", at, value: values[entry], allowed: "finite" });
    }
    SymmetricMatrix::from_lower(SparseMatrix::from_parts(dofs.free().len(), starts, rows, values))
}

/// Column starts and sorted rows of the lower triangle: two dofs meet where their nodes share an element.
fn pattern(body: &ElasticBody, dofs: &DofMap) -> (Vec<usize>, Vec<usize>) {
    let mesh = body.mesh();
    let mut starts = vec![0_usize; mesh.nodes().len() + 1];
    mesh.elements().flatten().for_each(|&node| starts[node + 1] += 1);
    for node in 0..mesh.nodes().len() {
        starts[node + 1] += starts[node];
    }
    let mut place = starts.clone();
    let mut around = vec![&[][..]; starts[mesh.nodes().len()]];
    for nodes in mesh.elements() {
        for &node in nodes {
            around[place[node]] = nodes;
            place[node] += 1;
        }
    }
    let (mut column_starts, mut rows) = (Vec::with_capacity(dofs.free().len() + 1), Vec::new());
    column_starts.push(0);
    let mut neighbours: Vec<usize> = Vec::new();
    for &dof in dofs.free() {
        let node = dof / 2;
        neighbours.clear();
        neighbours.extend(around[starts[node]..starts[node + 1]].iter().flat_map(|nodes| nodes.iter().copied()));
        neighbours.sort_unstable();
        neighbours.dedup();
        let nodal = neighbours.iter().flat_map(|&node| [2 * node, 2 * node + 1]);
        rows.extend(nodal.filter(|&other| other >= dof).filter_map(|other| dofs.number(other)));
        column_starts.push(rows.len());
    }
    (column_starts, rows)
}

/// The nodal forces (length `2 * n_nodes`, in force) that hold the body in the nodal displacement `displacement`.
///
/// Computed from the strains, element by element: a rigid translation gives exactly zero.
///
/// # Errors
/// [`Error::Length`] where the displacement does not have two entries per node.
pub fn internal_force(body: &ElasticBody, displacement: &[f64]) -> Result<Vec<f64>, Error> {
    check_length("nodal displacement", displacement.len(), body)?;
    let constitutive = body.material().constitutive();
    let mut force = vec![0.0; displacement.len()];
    for (nodes, cell) in body.cells() {
        let local = gather(displacement, nodes);
        let shares = cell.internal_force(|at| constitutive * cell.strain(at, &local), body.thickness());
        for (&node, share) in nodes.iter().zip(shares) {
            force[2 * node] += share[0];
            force[2 * node + 1] += share[1];
        }
    }
    Ok(force)
}

fn check_length(name: &'static str, found: usize, body: &ElasticBody) -> Result<(), Error> {
    let expected = 2 * body.mesh().nodes().len();
    if found != expected {
        return Err(Error::Length { name, found, expected, of: "nodal dofs" });
    }
    Ok(())
}
