//! The elastic body: a mesh, its elements, a material, a formulation; strains and stresses in it.

mod point;

pub(crate) use point::trace;
pub use point::{LocalPoint, Symmetric};

use crate::element::{Cell, ElementKind, MAX_NODES, PerNode, Tabulated};
use crate::error::Error;
use crate::formulation::Formulation;
use crate::material::{Lame, Material};
use crate::mesh::Mesh;

/// Radii of a body of revolution above minus this times its size are rounding of zero.
const ON_THE_AXIS: f64 = 1e-12;

/// How the stiffness of an element is integrated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integration {
    /// All of it at all quadrature points.
    #[default]
    Standard,
    /// The dilatation is replaced by its mean over the element (B-bar): no locking as Poisson's ratio nears 0.5.
    MeanDilatation,
}

/// A homogeneous elastic body, checked once, when it is built.
#[derive(Clone, Debug, PartialEq)]
pub struct ElasticBody {
    mesh: Mesh,
    material: Material,
    formulation: Formulation,
    integration: Integration,
    lame: Lame,
}

impl ElasticBody {
    /// The body of `mesh` and `material` in `formulation`, with [`Integration::Standard`].
    ///
    /// # Errors
    /// [`Error::Setting`] for an area or thickness that is not positive and finite, or a Poisson's ratio that the
    /// formulation does not allow; [`Error::Mesh`] for a mesh of another dimension, an element whose Jacobian is not
    /// positive, a node of a body of revolution at a negative radius.
    pub fn new(mesh: Mesh, material: Material, formulation: Formulation) -> Result<Self, Error> {
        formulation.check()?;
        let lame = material.lame(&formulation)?;
        let fail = |message| Err(Error::Mesh { message });
        if mesh.dimension() != formulation.dimension() {
            let (element, name) = (mesh.kind().name(), formulation.name());
            return fail(format!("a mesh of {element} does not fit {name}"));
        }
        if formulation.is_axisymmetric() {
            let least = -ON_THE_AXIS * mesh.size();
            if let Some(node) = mesh.nodes().iter().position(|at| at[0] < least) {
                let radius = mesh.nodes()[node][0];
                return fail(format!("node {node} lies at the radius x = {radius:e}; about the y axis x must be >= 0"));
            }
        }
        let body = ElasticBody { mesh, material, formulation, integration: Integration::Standard, lame };
        let table = body.tabulated();
        for (index, (nodes, cell)) in body.cells().enumerate() {
            if let Err(reason) = cell.check(&table) {
                return fail(format!("element {index} (nodes {nodes:?}, from 0): {reason}"));
            }
        }
        Ok(body)
    }

    /// The same body with another integration of its stiffness.
    ///
    /// # Errors
    /// [`Error::Mesh`] for mean dilatation with other elements than Q4 and Hex8, or in plane stress.
    pub fn with_integration(mut self, integration: Integration) -> Result<Self, Error> {
        if integration == Integration::MeanDilatation {
            let element = self.mesh.kind();
            if !matches!(element, ElementKind::Q4 | ElementKind::Hex8) {
                let name = element.name();
                let message = format!("mean dilatation is for Q4 and Hex8 elements, not for {name}");
                return Err(Error::Mesh { message });
            }
            if !self.formulation.can_lock() {
                let message = "mean dilatation does nothing in plane stress, where no element locks".into();
                return Err(Error::Mesh { message });
            }
        }
        self.integration = integration;
        Ok(self)
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The material.
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// The formulation.
    pub fn formulation(&self) -> &Formulation {
        &self.formulation
    }

    /// How the stiffness is integrated.
    pub fn integration(&self) -> Integration {
        self.integration
    }

    /// The Lamé constants in the formulation.
    pub fn lame(&self) -> Lame {
        self.lame
    }

    /// Number of coordinates, and of dofs per node.
    pub fn dimension(&self) -> usize {
        self.formulation.dimension()
    }

    /// Number of nodal dofs, `dimension * n_nodes`.
    pub fn nodal_dofs(&self) -> usize {
        self.dimension() * self.mesh.nodes().len()
    }

    /// The shape functions of the element, tabulated at the quadrature points that the formulation asks for.
    pub fn tabulated(&self) -> Tabulated {
        Tabulated::new(self.mesh.kind().reference(), self.formulation.is_axisymmetric())
    }

    /// Every element: its nodes, and the element in place.
    pub fn cells(&self) -> impl Iterator<Item = (&[usize], Cell)> + '_ {
        let reference = self.mesh.kind().reference();
        self.mesh.elements().map(move |nodes| (nodes, Cell::new(reference, &self.coordinates(nodes))))
    }

    /// The coordinates of up to [`MAX_NODES`] nodes.
    pub(crate) fn coordinates(&self, nodes: &[usize]) -> PerNode<[f64; 3]> {
        let mut coordinates = [[0.0; 3]; MAX_NODES];
        for (at, &node) in coordinates.iter_mut().zip(nodes) {
            *at = self.mesh.nodes()[node];
        }
        coordinates
    }

    /// The entries of a nodal vector (`dimension` per node) that belong to the nodes of an element.
    pub(crate) fn gather(&self, nodal: &[f64], nodes: &[usize]) -> PerNode<[f64; 3]> {
        let dimension = self.dimension();
        let mut values = [[0.0; 3]; MAX_NODES];
        for (value, &node) in values.iter_mut().zip(nodes) {
            value[..dimension].copy_from_slice(&nodal[dimension * node..dimension * (node + 1)]);
        }
        values
    }

    /// The stress of a strain; `dilatation` stands for its trace, which a mean over the element may replace.
    pub fn stress(&self, strain: &Symmetric, dilatation: f64) -> Symmetric {
        let Lame { lambda, mu } = self.lame;
        let mut stress = strain.map(|component| 2.0 * mu * component);
        stress[..3].iter_mut().for_each(|normal| *normal += lambda * dilatation);
        if let Formulation::PlaneStress { .. } = self.formulation {
            stress[2] = 0.0;
        }
        stress
    }

    /// Checks that a nodal vector has `dimension` entries per node.
    ///
    /// # Errors
    /// [`Error::Length`] where it has not.
    pub(crate) fn check_nodal(&self, name: &'static str, found: usize) -> Result<(), Error> {
        let expected = self.nodal_dofs();
        if found != expected {
            return Err(Error::Length { name, found, expected, of: "nodal dofs" });
        }
        Ok(())
    }
}
