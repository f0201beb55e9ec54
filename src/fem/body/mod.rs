//! The elastic body: a mesh, its elements, a material, a formulation; strains and stresses in it.

mod point;
mod region;

pub use point::Symmetric;
pub(crate) use point::{LocalPoint, trace};
pub use region::Region;

use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::fem::element::{Cell, ElementKind, MAX_NODES, PerNode, Rule, Tabulated, TabulatedPoint};
use crate::fem::formulation::Formulation;
use crate::fem::material::{Lame, Material};
use crate::fem::mesh::{Boundary, Mesh};

/// Radii of a body of revolution above minus this times its size are rounding of zero.
const ON_THE_AXIS: f64 = 1e-12;

/// How the stiffness of an element is integrated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema), schemars(rename = "IntegrationSpec"))]
#[serde(rename_all = "kebab-case")]
pub enum Integration {
    /// All of it at all quadrature points.
    #[default]
    Standard,
    /// The dilatation is replaced by its mean over the element: for `q4` and `hex8`, which then do not lock as
    /// Poisson's ratio nears 0.5.
    MeanDilatation,
}

/// A homogeneous elastic body, or several that only contact joins, checked once, when it is built.
#[derive(Clone, Debug, PartialEq)]
pub struct ElasticBody {
    mesh: Mesh,
    formulation: Formulation,
    integration: Integration,
    /// In the order of their nodes and elements; one where there is one body.
    regions: Vec<Region>,
}

/// An element in place.
#[derive(Clone, Copy, Debug)]
pub struct BodyElement<'a> {
    /// Its nodes, in the order of its kind.
    pub nodes: &'a [usize],
    /// The element in place.
    pub cell: Cell,
    /// The Lamé constants of its material in the formulation.
    pub lame: Lame,
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
        let regions = vec![Region::whole(&mesh, material, lame)];
        let body = ElasticBody { mesh, formulation, integration: Integration::Standard, regions };
        let table = body.tabulated();
        for (index, BodyElement { nodes, cell, .. }) in body.elements().enumerate() {
            if let Err(reason) = cell.check(&table) {
                return fail(format!("element {index} (nodes {nodes:?}, from 0): {reason}"));
            }
        }
        Ok(body)
    }

    /// The same body with another integration of its stiffness.
    ///
    /// # Errors
    /// [`Error::Mesh`] for mean dilatation with an element that does not [take it](ElementKind::takes_mean_dilatation), or in
    /// plane stress.
    pub fn with_integration(mut self, integration: Integration) -> Result<Self, Error> {
        if integration == Integration::MeanDilatation {
            let element = self.mesh.kind();
            if !element.takes_mean_dilatation() {
                let (those, name) = (ElementKind::of_mean_dilatation("and"), element.name());
                let message = format!("mean dilatation is for {those} elements, not for {name}");
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

    /// This body and `other` in one: two bodies that no element joins, so that nothing but contact can.
    ///
    /// Nodes and elements of `other` follow those of this body; its boundaries are called `name.boundary`.
    ///
    /// # Errors
    /// [`Error::Mesh`] where formulation, element or integration of the two differ, or a boundary of that name exists.
    pub fn beside(mut self, other: &ElasticBody, name: &str) -> Result<Self, Error> {
        let fail = |message| Err(Error::Mesh { message });
        if self.formulation != other.formulation {
            let (one, two) = (self.formulation.name(), other.formulation.name());
            return fail(format!("bodies of one model have one formulation and cross-section; here {one} and {two}"));
        }
        let (kind, other_kind) = (self.mesh.kind(), other.mesh.kind());
        if kind != other_kind {
            let (one, two) = (kind.name(), other_kind.name());
            return fail(format!("bodies of one model have one kind of element; here {one} and {two}"));
        }
        if self.integration != other.integration {
            return fail("bodies of one model have one integration".into());
        }
        let (nodes, elements) = (self.mesh.nodes().len(), self.mesh.element_count());
        self.mesh = self.mesh.beside(&other.mesh, name)?;
        self.regions.extend(other.regions.iter().map(|region| region.shifted(name, nodes, elements)));
        Ok(self)
    }

    /// The same single body on another mesh of its elements.
    ///
    /// # Errors
    /// As [`ElasticBody::new`].
    #[cfg(feature = "cli")]
    pub(crate) fn on(&self, mesh: Mesh) -> Result<Self, Error> {
        let material = *self.regions[0].material();
        Self::new(mesh, material, self.formulation)?.with_integration(self.integration)
    }

    /// The same body with another named boundary.
    ///
    /// # Errors
    /// As [`Mesh::with_boundary`].
    pub(crate) fn with_boundary(mut self, boundary: Boundary) -> Result<Self, Error> {
        self.mesh = self.mesh.with_boundary(boundary)?;
        Ok(self)
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The bodies that it is made of: one, but for [`ElasticBody::beside`].
    pub fn regions(&self) -> &[Region] {
        &self.regions
    }

    /// The formulation.
    pub fn formulation(&self) -> &Formulation {
        &self.formulation
    }

    /// How the stiffness is integrated.
    pub fn integration(&self) -> Integration {
        self.integration
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
        Tabulated::new(self.mesh.kind().reference(), self.rule())
    }

    /// The quadrature that the formulation asks for.
    pub(crate) fn rule(&self) -> Rule {
        if self.formulation.is_axisymmetric() { Rule::Revolved } else { Rule::Straight }
    }

    /// Every element in place, region by region.
    pub fn elements(&self) -> impl Iterator<Item = BodyElement<'_>> + '_ {
        let reference = self.mesh.kind().reference();
        let materials =
            self.regions.iter().flat_map(|region| std::iter::repeat_n(region.lame(), region.elements().len()));
        self.mesh.elements().zip(materials).map(move |(nodes, lame)| {
            let cell = Cell::new(reference, &self.coordinates(nodes));
            BodyElement { nodes, cell, lame }
        })
    }

    /// The density of the material of every element, in the order of [`elements`](Self::elements).
    ///
    /// # Errors
    /// [`Error::Setting`] for a material without density.
    pub(crate) fn densities(&self) -> Result<Vec<f64>, Error> {
        let mut densities = Vec::with_capacity(self.mesh.element_count());
        for region in &self.regions {
            let missing = Error::Setting { name: "density", value: f64::NAN, allowed: "positive and finite" };
            densities.extend(std::iter::repeat_n(region.material().density().ok_or(missing)?, region.elements().len()));
        }
        Ok(densities)
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

    /// The point of an element at a tabulated point.
    #[inline]
    pub fn point(&self, cell: &Cell, at: &TabulatedPoint) -> LocalPoint {
        let map = cell.map(&at.derivative);
        let mut hoop = [0.0; MAX_NODES];
        let mut radius = 0.0;
        if self.formulation().is_axisymmetric() {
            radius = cell.place(&at.shape)[0];
            let per_radius = cell.unit() / radius;
            hoop = at.shape.map(|value| value * per_radius);
        }
        LocalPoint {
            gradients: map.gradients,
            hoop,
            nodes: cell.nodes(),
            weight: map.determinant * at.weight * self.formulation().measure(radius),
        }
    }

    /// The strain of a nodal displacement in an element, at points in place; of a body that is not one of revolution.
    #[cfg(feature = "cli")]
    pub(crate) fn strain_in(&self, displacement: &[f64], element: usize) -> impl Fn([f64; 3]) -> Symmetric {
        let (reference, nodes) = (self.mesh.kind().reference(), self.mesh.element(element));
        let cell = Cell::new(reference, &self.coordinates(nodes));
        let own = self.gather(displacement, nodes);
        move |at| {
            let gradients = cell.map(&(reference.derivative)(cell.reference_coordinates(at))).gradients;
            let point = LocalPoint { gradients, hoop: [0.0; MAX_NODES], nodes: nodes.len(), weight: 0.0 };
            point.strain(&own, cell.unit())
        }
    }

    /// The mean dilatation of an element where its integration asks for it, per length; `None` where it does not.
    pub(crate) fn mean_dilatation(
        &self,
        cell: &Cell,
        table: &Tabulated,
        displacement: &PerNode<[f64; 3]>,
    ) -> Option<f64> {
        if self.integration() != Integration::MeanDilatation {
            return None;
        }
        let (mut integral, mut volume) = (0.0, 0.0);
        for at in &table.points {
            let point = self.point(cell, at);
            integral += point.weight * trace(&point.strain(displacement, cell.unit()));
            volume += point.weight;
        }
        Some(integral / volume)
    }
    /// The stress of a strain in a material; `dilatation` stands for its trace, which a mean over the element may
    /// replace.
    pub fn stress(&self, Lame { lambda, mu }: Lame, strain: &Symmetric, dilatation: f64) -> Symmetric {
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
