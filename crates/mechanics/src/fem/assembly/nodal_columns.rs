//! Columns of stiffness and mass at some nodes: their transpose maps a motion of all nodes to the forces on these
//! nodes.

use super::element_stiffness;
use crate::error::Error;
use crate::fem::body::ElasticBody;
use signorini_linear::SparseMatrix;

/// Marks a node that is not among the requested ones.
const OTHER: usize = usize::MAX;

/// The columns of the stiffness at `nodes`, in force per length: `nodal dofs x (dim * nodes.len())`, free and supported
/// dofs, along the coordinate axes. Only elements around these nodes are computed.
pub(crate) fn stiffness_columns(body: &ElasticBody, nodes: &[usize]) -> Result<SparseMatrix, Error> {
    let dimension = body.dimension();
    let place = places(body, nodes);
    let tables = body.tabulated();
    let mut entries = Vec::new();
    for placed in body.elements() {
        let around = placed.nodes;
        if around.iter().all(|&node| place[node] == OTHER) {
            continue;
        }
        let element = element_stiffness(body, &placed, tables.at(placed.kind));
        for (b, &column) in around.iter().enumerate().filter(|(_, column)| place[**column] != OTHER) {
            for (a, &row) in around.iter().enumerate() {
                let block = element.block(a.max(b), a.min(b));
                for (of_later, values) in block.iter().enumerate().take(dimension) {
                    for (of_earlier, &value) in values.iter().enumerate().take(dimension) {
                        let (i, j) = if a >= b { (of_later, of_earlier) } else { (of_earlier, of_later) };
                        entries.push((dimension * row + i, dimension * place[column] + j, value));
                    }
                }
            }
        }
    }
    Ok(SparseMatrix::from_triplets(body.nodal_dofs(), dimension * nodes.len(), &entries)?)
}

/// The columns at `nodes` of a nodal mass, given by its lower triangle (`n_nodes x n_nodes`): `n_nodes x nodes.len()`,
/// the same for each axis.
pub(crate) fn mass_columns(body: &ElasticBody, nodes: &[usize], mass: &SparseMatrix) -> Result<SparseMatrix, Error> {
    let place = places(body, nodes);
    let mut entries = Vec::new();
    for (row, column, value) in mass.triplets() {
        if place[column] != OTHER {
            entries.push((row, place[column], value));
        }
        if row != column && place[row] != OTHER {
            entries.push((column, place[row], value));
        }
    }
    Ok(SparseMatrix::from_triplets(body.mesh().nodes().len(), nodes.len(), &entries)?)
}

/// The place of each node of the body among `nodes`, or [`OTHER`].
fn places(body: &ElasticBody, nodes: &[usize]) -> Vec<usize> {
    let mut place = vec![OTHER; body.mesh().nodes().len()];
    nodes.iter().enumerate().for_each(|(index, &node)| place[node] = index);
    place
}
