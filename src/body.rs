//! The elastic body: a mesh, its elements, a material, a thickness.

use crate::element::{Cell, MAX_NODES, PerNode, Q4, ReferenceElement, T3};
use crate::error::Error;
use crate::material::Material;
use crate::mesh::{ElementKind, Mesh};

/// A homogeneous elastic body in the plane, checked once, when it is built.
#[derive(Clone, Debug, PartialEq)]
pub struct ElasticBody {
    mesh: Mesh,
    material: Material,
    thickness: f64,
}

impl ElasticBody {
    /// The body of `mesh` and `material`; `thickness` is its depth across the plane.
    ///
    /// # Errors
    /// [`Error::Setting`] for a thickness that is not positive and finite, [`Error::Mesh`] for an element whose
    /// Jacobian is not positive.
    pub fn new(mesh: Mesh, material: Material, thickness: f64) -> Result<Self, Error> {
        if !(thickness.is_normal() && thickness > 0.0) {
            return Err(Error::Setting { name: "thickness", value: thickness, allowed: "positive and finite" });
        }
        let body = ElasticBody { mesh, material, thickness };
        for (index, (nodes, cell)) in body.cells().enumerate() {
            if let Err(reason) = cell.check() {
                let message = format!("element {index} (nodes {nodes:?}, from 0): {reason}");
                return Err(Error::Mesh { message });
            }
        }
        Ok(body)
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The material.
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// Depth across the plane, in the unit of length.
    pub fn thickness(&self) -> f64 {
        self.thickness
    }

    /// The reference element of the mesh.
    pub fn reference(&self) -> &'static ReferenceElement {
        match self.mesh.kind() {
            ElementKind::T3 => &T3,
            ElementKind::Q4 => &Q4,
        }
    }

    /// Every element: its nodes, and the element in place.
    pub fn cells(&self) -> impl Iterator<Item = (&[usize], Cell)> + '_ {
        let reference = self.reference();
        self.mesh.elements().map(move |nodes| {
            let mut coordinates: PerNode<[f64; 2]> = [[0.0; 2]; MAX_NODES];
            for (at, &node) in coordinates.iter_mut().zip(nodes) {
                *at = self.mesh.nodes()[node];
            }
            (nodes, Cell::new(reference, coordinates))
        })
    }
}

/// The entries of a nodal vector (order `[x_0, y_0, x_1, ...]`) that belong to the nodes of an element.
pub(crate) fn gather(nodal: &[f64], nodes: &[usize]) -> PerNode<[f64; 2]> {
    let mut values = [[0.0; 2]; MAX_NODES];
    for (value, &node) in values.iter_mut().zip(nodes) {
        *value = [nodal[2 * node], nodal[2 * node + 1]];
    }
    values
}
