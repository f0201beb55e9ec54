//! The elastic body: a mesh, its elements, their materials, a formulation; strains and stresses in it.

mod phase;
mod phases;
mod point;
mod region;

pub use phase::{Phase, Temperature};
pub(crate) use point::LocalPoint;
pub use region::Region;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use signorini_qp as qp;

use crate::error::Error;
use crate::fem::element::{Cell, ElementKind, MAX_NODES, PerNode, Rule, Tabulated, TabulatedPoint};
use crate::fem::formulation::Formulation;
use crate::fem::geometry::{Symmetric, trace};
use crate::fem::material::{Material, Stiffness};
use crate::fem::mesh::{Boundary, Mesh, fail};

/// Radii of a body of revolution that are negative by less than this times its size are rounding of zero.
const ON_THE_AXIS: f64 = 1e-12;

/// The integration of the stiffness of an element: in full, or with a dilatation that cannot lock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "IntegrationSpec")]
#[serde(rename_all = "kebab-case")]
pub enum Integration {
    /// The full strain at all quadrature points.
    #[default]
    Standard,
    /// The dilatation is replaced by its mean over the element: for `q4` and `hex8`, which then do not lock if Poisson's ratio is near
    /// 0.5.
    MeanDilatation,
}

/// An elastic body of one material or several, or several bodies that only contact couples; checked once, when it is built.
#[derive(Clone, Debug, PartialEq)]
pub struct ElasticBody {
    mesh: Mesh,
    formulation: Formulation,
    integration: Integration,
    /// In the order of their nodes and elements; one region for one body.
    regions: Vec<Region>,
    /// The phases of a region are consecutive; each has an element.
    phases: Vec<Phase>,
    /// The phase of each element.
    of_elements: Vec<u32>,
}

/// An element with the coordinates of its nodes.
#[derive(Clone, Copy, Debug)]
pub struct BodyElement<'a> {
    /// Its nodes, in the order of its kind.
    pub nodes: &'a [usize],
    /// The cell with its coordinates.
    pub cell: Cell,
    /// Its material and its stress without strain.
    pub phase: &'a Phase,
    /// The number of the phase among the phases of the body.
    pub phase_number: u32,
}

impl ElasticBody {
    /// The body of `mesh` and `material` in `formulation`, with [`Integration::Standard`].
    ///
    /// # Errors
    /// [`qp::Error::Setting`] for an area or thickness that is not positive and finite, or a Poisson's ratio that the
    /// formulation does not allow; [`Error::Mesh`] for a mesh of another dimension, an element whose Jacobian is not
    /// positive, a node of a body of revolution at a negative radius.
    pub fn new(mesh: Mesh, material: Material, formulation: Formulation) -> Result<Self, Error> {
        formulation.check()?;
        let phase = Phase::new(material, &formulation)?;
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
        let (regions, of_elements) = (vec![Region::whole(&mesh)], vec![0; mesh.element_count()]);
        let integration = Integration::Standard;
        let body = ElasticBody { mesh, formulation, integration, regions, phases: vec![phase], of_elements };
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
    /// [`Error::Mesh`] for mean dilatation with an element that does not [allow it](ElementKind::takes_mean_dilatation), or in plane
    /// stress.
    pub fn with_integration(mut self, integration: Integration) -> Result<Self, Error> {
        if integration == Integration::MeanDilatation {
            let element = self.mesh.kind();
            if !element.takes_mean_dilatation() {
                let (those, name) = (ElementKind::of_mean_dilatation("and"), element.name());
                return fail(format!("mean dilatation is for {those} elements, not for {name}"));
            }
            if !self.formulation.can_lock() {
                return fail(
                    "mean dilatation has no effect in plane stress, because no element locks; take `standard`".into(),
                );
            }
        }
        self.integration = integration;
        self.check_integration()?;
        Ok(self)
    }

    /// Mean dilatation is defined for the isotropic law only.
    fn check_integration(&self) -> Result<(), Error> {
        let is_general = |phase: &Phase| matches!(phase.law.stiffness, Stiffness::General(_));
        match self.integration == Integration::MeanDilatation && self.phases.iter().any(is_general) {
            true => fail("mean dilatation is for isotropic materials only".into()),
            false => Ok(()),
        }
    }

    /// This body and `other` in one: no element joins the two bodies, so that only contact can couple them.
    ///
    /// Nodes and elements of `other` follow those of this body; its boundaries are called `name.boundary`.
    ///
    /// # Errors
    /// [`Error::Mesh`] if formulation, element or integration of the two differ, or a boundary of that name exists.
    pub fn beside(mut self, other: &ElasticBody, name: &str) -> Result<Self, Error> {
        if self.formulation != other.formulation {
            let (one, two) = (self.formulation.name(), other.formulation.name());
            return fail(format!(
                "all bodies of a model must have the same formulation and cross-section; here they have {one} and \
                 {two}"
            ));
        }
        let (kind, other_kind) = (self.mesh.kind(), other.mesh.kind());
        if kind != other_kind {
            let (one, two) = (kind.name(), other_kind.name());
            return fail(format!(
                "all bodies of a model must have the same kind of element; here they have {one} and {two}"
            ));
        }
        if self.integration != other.integration {
            return fail("all bodies of a model must have the same integration".into());
        }
        let (nodes, elements) = (self.mesh.nodes().len(), self.mesh.element_count());
        self.mesh = self.mesh.beside(&other.mesh, name)?;
        self.regions.extend(other.regions.iter().map(|region| region.shifted(name, nodes, elements)));
        let phases = self.phases.len() as u32;
        self.phases.extend_from_slice(&other.phases);
        self.of_elements.extend(other.of_elements.iter().map(|phase| phases + phase));
        Ok(self)
    }

    /// The same single body on a mesh of parts of its elements; the second argument gives, for each element of that mesh, the element
    /// that it is a part of.
    ///
    /// # Errors
    /// As [`ElasticBody::new`].
    pub(crate) fn on(&self, mesh: Mesh, parents: &[usize]) -> Result<Self, Error> {
        let body = Self::new(mesh, *self.phases[0].material(), self.formulation)?;
        let of_elements = parents.iter().map(|&parent| self.of_elements[parent]).collect();
        ElasticBody { phases: self.phases.clone(), of_elements, ..body }.with_integration(self.integration)
    }

    /// The same body with another named boundary.
    ///
    /// # Errors
    /// As [`Mesh::with_boundary`].
    pub(crate) fn with_boundary(mut self, boundary: Boundary) -> Result<Self, Error> {
        self.mesh = self.mesh.with_boundary(boundary)?;
        Ok(self)
    }

    /// The mesh with the elements of all regions, region by region.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The bodies that it consists of, in the order in which they were joined: one, except after
    /// [`ElasticBody::beside`].
    pub fn regions(&self) -> &[Region] {
        &self.regions
    }

    /// The dimension of the model and its assumption across the plane or the bar.
    pub fn formulation(&self) -> &Formulation {
        &self.formulation
    }

    /// The rule by which the stiffness is integrated over an element.
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

    /// The shape functions of the element, tabulated at the quadrature points of the formulation.
    pub fn tabulated(&self) -> Tabulated {
        Tabulated::new(self.mesh.kind().reference(), self.rule())
    }

    /// The quadrature of the formulation.
    pub(crate) fn rule(&self) -> Rule {
        if self.formulation.is_axisymmetric() { Rule::Revolved } else { Rule::Straight }
    }

    /// Every element with its coordinates, region by region.
    pub fn elements(&self) -> impl Iterator<Item = BodyElement<'_>> + '_ {
        let reference = self.mesh.kind().reference();
        self.mesh.elements().zip(&self.of_elements).map(move |(nodes, &phase_number)| {
            let cell = Cell::new(reference, &self.coordinates(nodes));
            BodyElement { nodes, cell, phase: &self.phases[phase_number as usize], phase_number }
        })
    }

    /// The material and the stress without strain of an element.
    pub(crate) fn phase_of(&self, element: usize) -> &Phase {
        &self.phases[self.of_elements[element] as usize]
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

    /// The strain of a nodal displacement in an element, at points given in coordinates; not for a body of revolution.
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

    /// An element under the nodal displacement of the body; `table` is the body's [`tabulated`](Self::tabulated) element.
    pub(crate) fn strained<'a>(
        &'a self,
        table: &Tabulated,
        displacement: &[f64],
        element: &'a BodyElement<'a>,
    ) -> Strained<'a> {
        let local = self.gather(displacement, element.nodes);
        Strained { body: self, element, local, mean_dilatation: self.mean_dilatation(&element.cell, table, &local) }
    }

    /// The mean dilatation of an element, per length, if its integration needs it; `None` otherwise.
    fn mean_dilatation(&self, cell: &Cell, table: &Tabulated, displacement: &PerNode<[f64; 3]>) -> Option<f64> {
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

    /// Checks that a nodal vector has `dimension` entries per node.
    ///
    /// # Errors
    /// [`qp::Error::Length`] if it has not.
    pub(crate) fn check_nodal(&self, name: &'static str, found: usize) -> Result<(), Error> {
        Ok(qp::Error::check_length(name, found, self.nodal_dofs(), "nodal dofs")?)
    }
}

/// An element with its displacement.
pub(crate) struct Strained<'a> {
    body: &'a ElasticBody,
    element: &'a BodyElement<'a>,
    local: PerNode<[f64; 3]>,
    mean_dilatation: Option<f64>,
}

impl Strained<'_> {
    /// A tabulated point of the element in place, and the stress there.
    #[inline]
    pub fn at(&self, at: &TabulatedPoint) -> (LocalPoint, Symmetric) {
        let cell = &self.element.cell;
        let point = self.body.point(cell, at);
        let stress = self.element.stress(at, &point.strain(&self.local, cell.unit()), self.mean_dilatation);
        (point, stress)
    }
}

impl BodyElement<'_> {
    /// The stress of a strain at a tabulated point: C (eps - alpha T) + sigma_0. A mean `dilatation` replaces the trace of the strain.
    #[inline]
    pub fn stress(&self, at: &TabulatedPoint, strain: &Symmetric, dilatation: Option<f64>) -> Symmetric {
        let stress = self.phase.law.stress(strain, dilatation.unwrap_or_else(|| trace(strain)));
        match self.own_stress(at) {
            None => stress,
            Some(own) => [0, 1, 2, 3, 4, 5].map(|component| stress[component] + own[component]),
        }
    }

    /// The stress at a tabulated point without any strain, if there is one.
    #[inline]
    pub fn own_stress(&self, at: &TabulatedPoint) -> Option<Symmetric> {
        self.phase.own.as_ref().map(|own| own.at(self.cell.place(&at.shape)))
    }
}
