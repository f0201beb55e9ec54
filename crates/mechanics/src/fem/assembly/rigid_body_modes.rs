//! The rigid-body modes of a body at its free dofs: motions without strain energy, apart from the supports.

use super::DofMap;
use crate::fem::body::ElasticBody;

/// The rigid-body modes at the free dofs, one vector each, one entry per free dof: the translations, then the rotations
/// about the centre of the mesh, divided by half its size so that all are dimensionless and of order one.
///
/// A body of revolution is treated as its half plane: the distance from the axis is ignored.
pub fn rigid_body_modes(body: &ElasticBody, dofs: &DofMap) -> Vec<Vec<f64>> {
    let (mesh, dimension) = (body.mesh(), body.dimension());
    let (least, most) = mesh.extent();
    let size = mesh.size();
    let rotations: &[[usize; 2]] = match dimension {
        1 => &[],
        2 => &[[0, 1]],
        _ => &[[1, 2], [2, 0], [0, 1]],
    };
    let mut motions = vec![Vec::with_capacity(dofs.free().len()); dimension + rotations.len()];
    for &dof in dofs.free() {
        let (node, axis) = (dof / dimension, dof % dimension);
        let direction = dofs.axes(node)[axis];
        let place = dofs.basis.place(mesh.nodes(), node);
        let from_middle = [0, 1, 2].map(|i| (2.0 * place[i] - least[i] - most[i]) / size);
        for (translation, motion) in motions[..dimension].iter_mut().enumerate() {
            motion.push(direction[translation]);
        }
        for (&[first, second], motion) in rotations.iter().zip(&mut motions[dimension..]) {
            motion.push(from_middle[first] * direction[second] - from_middle[second] * direction[first]);
        }
    }
    motions
}
