//! The elastic body: a mesh, its elements, their materials, a formulation; strains and stresses in it.

mod phase;
mod phases;
mod point;

pub use phase::{Phase, PhaseNumber, Region};
pub use point::{Displaced, Integration, LocalPoint};

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use signorini_linear as linear;

use crate::dense::DenseMatrix;
use crate::element::{
    Cell, ElementKind, MAX_NODES, PerKind, PerNode, QuadratureRule, ReferenceElement, Tabulated, TabulatedPoint,
};
use crate::error::Error;
use crate::formulation::Formulation;
use crate::geometry::{Symmetric, trace};
use crate::material::{Material, Stiffness};
use crate::mesh::{Boundary, Mesh, fail};
use crate::mortar::Skin;
use crate::threads::in_order;

/// Radii of a body of revolution below this times its size, of either sign, are rounding of zero: on its axis.
pub const ON_THE_AXIS: f64 = 1e-12;

/// An elastic body of one material or several, or several bodies that only contact couples; checked once, when it is
/// built.
#[derive(Clone, Debug, PartialEq)]
pub struct ElasticBody {
    mesh: Mesh,
    formulation: Formulation,
    /// In the order of their nodes and elements; one region for one body.
    regions: Vec<Region>,
    /// The phases of a region are consecutive; each has an element.
    phases: Vec<Phase>,
    of_elements: Vec<u32>,
    /// Elements whose Jacobian is negative at a node alone: element, local node and determinant, relative to the size
    /// of the element to the power of its dimension.
    folded: Vec<(usize, usize, f64)>,
    skins: Skins,
}

/// The skins of all regions, made when they are needed first.
#[derive(Clone, Debug, Default)]
struct Skins(OnceLock<Arc<[Skin]>>);

impl PartialEq for Skins {
    /// They follow from the rest of a body.
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// An element with the coordinates of its nodes.
#[derive(Clone, Copy, Debug)]
pub struct BodyElement<'a> {
    /// Its nodes, in the order of its kind.
    pub nodes: &'a [usize],
    pub kind: ElementKind,
    pub cell: Cell,
    /// Its material and its stress without strain.
    pub phase: &'a Phase,
    pub phase_number: u32,
}

impl ElasticBody {
    /// The body of `mesh` and `material` in `formulation`, with [`Integration::Standard`].
    ///
    /// # Errors
    /// [`linear::Error::Setting`] for an area or thickness that is not positive and finite, or a Poisson's ratio that
    /// the formulation does not allow; [`Error::Mesh`] for a mesh of another dimension, an element whose Jacobian is
    /// not positive, a node of a body of revolution at a negative radius.
    pub fn new(mesh: Mesh, material: Material, formulation: Formulation) -> Result<Self, Error> {
        formulation.check()?;
        let phase = Phase::new(material, &formulation)?;
        if mesh.dimension() != formulation.dimension() {
            let (element, name) = (mesh.kind_of(0).name(), formulation.name());
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
        let (phases, skins) = (vec![phase], Skins::default());
        let mut body = ElasticBody { mesh, formulation, regions, phases, of_elements, folded: Vec::new(), skins };
        let tables = body.tabulated();
        let judged = |mut run: Range<usize>| {
            let mut folded = Vec::new();
            let fault = run.find_map(|index| {
                let BodyElement { nodes, kind, cell, .. } = body.element(index)?;
                let found = cell.check(tables.at(kind));
                folded.extend(found.as_ref().ok().copied().flatten().map(|one| (index, one.point, one.value)));
                found.err().map(|reason| format!("element {index} (nodes {nodes:?}, from 0): {reason}"))
            });
            (fault, folded)
        };
        let (mut first, mut folded) = (None, Vec::new());
        in_order(body.mesh.element_count(), judged, |(fault, own)| {
            first = first.take().or(fault);
            folded.extend(own);
        });
        body.folded = folded;
        first.map_or(Ok(body), fail)
    }

    /// The same body with another integration of its stiffness.
    ///
    /// # Errors
    /// [`Error::Mesh`] for mean dilatation with an element that does not [allow
    /// it](ElementKind::takes_mean_dilatation), or in plane stress.
    pub fn with_integration(mut self, integration: Integration) -> Result<Self, Error> {
        if integration == Integration::MeanDilatation {
            if let Some(element) = self.mesh.kinds().find(|kind| !kind.takes_mean_dilatation()) {
                let (those, name) = (ElementKind::of_mean_dilatation("and"), element.name());
                return fail(format!("mean dilatation is for {those} elements, not for {name}"));
            }
            if !self.formulation.can_lock() {
                return fail(
                    "mean dilatation has no effect in plane stress, because no element locks; take `standard`".into(),
                );
            }
        }
        self.phases.iter_mut().for_each(|phase| phase.integration = integration);
        self.check_integration()?;
        Ok(self)
    }

    /// Mean dilatation is defined for the isotropic law only.
    fn check_integration(&self) -> Result<(), Error> {
        let is_wrong = |phase: &Phase| {
            phase.integration == Integration::MeanDilatation && matches!(phase.law.stiffness, Stiffness::General(_))
        };
        match self.phases.iter().any(is_wrong) {
            true => fail("mean dilatation is for isotropic materials only".into()),
            false => Ok(()),
        }
    }

    /// This body and `other` in one: no element joins the two bodies, so that only contact can couple them.
    ///
    /// Nodes and elements of `other` follow those of this body; its boundaries are called `name.boundary`.
    ///
    /// # Errors
    /// [`Error::Mesh`] if the formulations of the two differ, or a boundary of that name exists.
    pub fn beside(mut self, other: &ElasticBody, name: &str) -> Result<Self, Error> {
        if self.formulation != other.formulation {
            let (one, two) = (self.formulation.name(), other.formulation.name());
            return fail(format!(
                "all bodies of a model must have the same formulation and cross-section; here they have {one} and \
                 {two}"
            ));
        }
        let (nodes, elements) = (self.mesh.nodes().len(), self.mesh.element_count());
        self.mesh = self.mesh.beside(&other.mesh, name)?;
        self.skins = Skins::default();
        self.regions.extend(other.regions.iter().map(|region| region.shifted(name, nodes, elements)));
        let phases = self.phases.len() as u32;
        self.phases.extend_from_slice(&other.phases);
        self.of_elements.extend(other.of_elements.iter().map(|phase| phases + phase));
        self.folded.extend(other.folded.iter().map(|&(element, node, value)| (elements + element, node, value)));
        Ok(self)
    }

    /// The same body on a mesh of parts of its elements, region by region, with [`Integration::Standard`]; the second
    /// argument gives, for each element of that mesh, the element that it is a part of.
    #[doc(hidden)]
    pub fn on(&self, mesh: Mesh, parents: &[usize]) -> Result<Self, Error> {
        let regions = Region::on(&self.regions, &mesh, parents);
        let body = Self::new(mesh, *self.phases[0].material(), self.formulation)?;
        let of_elements = parents.iter().map(|&parent| self.of_elements[parent]).collect();
        let phases = self.phases.clone();
        ElasticBody { phases, of_elements, regions, ..body }.with_integration(Integration::Standard)
    }

    /// The same body with another named boundary.
    #[doc(hidden)]
    pub fn with_boundary(mut self, boundary: Boundary) -> Result<Self, Error> {
        self.mesh = self.mesh.with_boundary(boundary)?;
        Ok(self)
    }

    /// The same body with one of its nodal coordinates changed.
    #[doc(hidden)]
    pub fn moved(&self, dof: usize, by: f64) -> Self {
        let mut body = self.clone();
        body.skins = Skins::default();
        body.mesh = body.mesh.moved(dof / self.dimension(), dof % self.dimension(), by);
        body
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

    /// The elements whose Jacobian is negative at a node, although it is positive where they are integrated: element,
    /// local node and determinant, relative to the size of the element to the power of its dimension.
    #[doc(hidden)]
    pub fn folded(&self) -> &[(usize, usize, f64)] {
        &self.folded
    }

    /// The skin of each body, in their order; none in one dimension.
    #[doc(hidden)]
    pub fn skins(&self) -> &Arc<[Skin]> {
        self.skins.0.get_or_init(|| {
            let regions = self.regions.iter().filter(|_| self.dimension() > 1);
            regions.map(|region| Skin::new(self.mesh.surface(region.elements()), self.mesh.nodes())).collect()
        })
    }

    /// The skin of those elements of a body that meet a box: within the box it is the skin of the body.
    #[doc(hidden)]
    pub fn skin_within(&self, region: &Region, [low, high]: [[f64; 3]; 2]) -> Skin {
        let meets = |&element: &usize| {
            let nodes = self.mesh.element(element).iter().map(|&node| self.mesh.nodes()[node]);
            let some = |is_within: &dyn Fn([f64; 3]) -> bool| nodes.clone().any(is_within);
            (0..3).all(|axis| some(&|at| at[axis] <= high[axis]) && some(&|at| at[axis] >= low[axis]))
        };
        Skin::new(self.mesh.surface(region.elements().filter(meets)), self.mesh.nodes())
    }

    /// The number of the body that a node belongs to, both from 0; `None` without such a node.
    pub fn region_at(&self, node: usize) -> Option<usize> {
        self.regions.iter().position(|region| region.nodes().contains(&node))
    }

    /// The number of the body that a boundary belongs to; `None` for a boundary without facets.
    #[doc(hidden)]
    pub fn region_of(&self, boundary: &Boundary) -> Option<usize> {
        self.region_at(*boundary.connectivity.first()?)
    }

    /// The dimension of the model and its assumption across the plane or the bar.
    pub fn formulation(&self) -> &Formulation {
        &self.formulation
    }

    /// Number of coordinates of the body, and of dofs of each of its nodes.
    pub fn dimension(&self) -> usize {
        self.formulation.dimension()
    }

    /// The axes about which a rigid part of the body turns, in increasing order: at most three, 0 for x.
    pub fn turns(&self) -> &'static [usize] {
        match self.dimension() {
            2 if !self.formulation.is_axisymmetric() => &[2],
            3 => &[0, 1, 2],
            _ => &[],
        }
    }

    /// Number of nodal dofs, `dimension * n_nodes`.
    pub fn nodal_dofs(&self) -> usize {
        self.dimension() * self.mesh.nodes().len()
    }

    /// The shape functions of each kind of element, tabulated at the quadrature points of the formulation.
    #[doc(hidden)]
    pub fn tabulated(&self) -> PerKind<Tabulated> {
        self.per_kind(|reference| Tabulated::new(reference, self.rule()))
    }

    /// The same at five points in each direction.
    pub(crate) fn finely_tabulated(&self) -> PerKind<Tabulated> {
        self.per_kind(Tabulated::fine)
    }

    /// The [weights](Tabulated::extrapolation) that carry values at these points to the nodes.
    pub(crate) fn extrapolations(&self) -> PerKind<DenseMatrix> {
        self.per_kind(|reference| Tabulated::new(reference, self.rule()).extrapolation())
    }

    pub(crate) fn per_kind<T>(&self, make: impl Fn(&'static ReferenceElement) -> T) -> PerKind<T> {
        PerKind::of(self.mesh.kinds(), |kind| make(kind.reference()))
    }

    /// The quadrature of the formulation.
    pub(crate) fn rule(&self) -> QuadratureRule {
        if self.formulation.is_axisymmetric() { QuadratureRule::Revolved } else { QuadratureRule::Straight }
    }

    /// Every element with its coordinates, region by region.
    pub fn elements(&self) -> impl Iterator<Item = BodyElement<'_>> + '_ {
        let all = self.mesh.elements().zip(&self.of_elements).enumerate();
        all.map(|(element, (nodes, &phase_number))| self.with_coordinates(element, nodes, phase_number))
    }

    /// One element with its coordinates; `None` if there is no such element.
    #[doc(hidden)]
    pub fn element(&self, element: usize) -> Option<BodyElement<'_>> {
        let phase_number = *self.of_elements.get(element)?;
        Some(self.with_coordinates(element, self.mesh.element(element), phase_number))
    }

    fn with_coordinates<'a>(&'a self, element: usize, nodes: &'a [usize], phase_number: u32) -> BodyElement<'a> {
        let kind = self.mesh.kind_of(element);
        let cell = Cell::at(kind.reference(), |local| self.mesh.nodes()[nodes[local]]);
        BodyElement { nodes, kind, cell, phase: &self.phases[phase_number as usize], phase_number }
    }

    /// The material and the stress without strain of an element.
    #[doc(hidden)]
    pub fn phase_of(&self, element: usize) -> &Phase {
        &self.phases[self.of_elements[element] as usize]
    }

    pub(crate) fn phase_number(&self, element: usize) -> u32 {
        self.of_elements[element]
    }

    /// The entries of a nodal vector (`dimension` per node) that belong to the nodes of an element.
    #[doc(hidden)]
    pub fn gather(&self, nodal: &[f64], nodes: &[usize]) -> PerNode<[f64; 3]> {
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
            weight: map.determinant * at.weight * self.formulation().measure(radius),
        }
    }

    /// The deformation at a tabulated point of an element with these displacements of its nodes.
    #[inline]
    pub(crate) fn displaced(&self, cell: &Cell, at: &TabulatedPoint, displacement: &PerNode<[f64; 3]>) -> Displaced {
        let (mut slope, inverse) = cell.slope(&at.derivative, displacement);
        slope.iter_mut().flatten().for_each(|entry| *entry /= cell.unit());
        let (mut hoop, mut radius, mut per_radius) = (0.0, 0.0, 0.0);
        if self.formulation().is_axisymmetric() {
            radius = cell.place(&at.shape)[0];
            per_radius = cell.unit() / radius;
            let radial = at.shape.iter().zip(displacement).take(cell.nodes()).map(|(share, moved)| share * moved[0]);
            hoop = radial.sum::<f64>() / radius;
        }
        Displaced {
            slope,
            hoop,
            weight: inverse.determinant * at.weight * self.formulation().measure(radius),
            inverse,
            per_radius,
        }
    }

    /// Returns `true` for a linear quadrilateral whose opposite sides are parallel, to the last bit: there strains are
    /// linear in the place.
    #[doc(hidden)]
    pub fn is_parallelogram(&self, element: usize) -> bool {
        let nodes = self.mesh.element(element);
        let at = |local: usize, axis: usize| self.mesh.nodes()[nodes[local]][axis];
        let is_parallel = |axis: usize| at(0, axis) - at(1, axis) == at(3, axis) - at(2, axis);
        let ReferenceElement { dimension, corners, mid_sides, .. } = self.mesh.kind_of(element).reference();
        (*dimension, *corners) == (2, 4) && mid_sides.is_empty() && is_parallel(0) && is_parallel(1)
    }

    /// The strain of a nodal displacement in an element, at points given in coordinates off an axis of revolution.
    #[doc(hidden)]
    pub fn strain_in(&self, displacement: &[f64], element: usize) -> impl Fn([f64; 3]) -> Symmetric {
        let (reference, nodes) = (self.mesh.kind_of(element).reference(), self.mesh.element(element));
        let cell = Cell::at(reference, |local| self.mesh.nodes()[nodes[local]]);
        let own = self.gather(displacement, nodes);
        move |at| {
            let at = TabulatedPoint::new(reference, cell.reference_coordinates(at), 0.0);
            self.displaced(&cell, &at, &own).strain()
        }
    }

    /// An element under the nodal displacement of the body; `tables` are the body's [`tabulated`](Self::tabulated)
    /// elements.
    #[doc(hidden)]
    pub fn strained<'a>(
        &'a self,
        tables: &PerKind<Tabulated>,
        displacement: &[f64],
        element: &'a BodyElement<'a>,
    ) -> Strained<'a> {
        let local = self.gather(displacement, element.nodes);
        let mean_dilatation = self.mean_dilatation(element, tables.at(element.kind), &local);
        Strained { body: self, element, local, mean_dilatation }
    }

    /// The mean dilatation of an element, per length, if its integration needs it; `None` otherwise.
    fn mean_dilatation(
        &self,
        element: &BodyElement,
        table: &Tabulated,
        displacement: &PerNode<[f64; 3]>,
    ) -> Option<f64> {
        if element.phase.integration != Integration::MeanDilatation {
            return None;
        }
        let (mut integral, mut volume) = (0.0, 0.0);
        for at in &table.points {
            let point = self.displaced(&element.cell, at, displacement);
            integral += point.weight * trace(&point.strain());
            volume += point.weight;
        }
        Some(integral / volume)
    }

    /// Checks that a nodal vector has `dimension` entries per node.
    pub(crate) fn check_nodal(&self, name: &'static str, found: usize) -> Result<(), Error> {
        Ok(linear::Error::check_length(name, found, self.nodal_dofs(), "nodal dofs")?)
    }
}

/// An element with its displacement.
pub struct Strained<'a> {
    body: &'a ElasticBody,
    element: &'a BodyElement<'a>,
    local: PerNode<[f64; 3]>,
    mean_dilatation: Option<f64>,
}

/// A displacement at a point of an element.
#[derive(Clone, Copy, Debug)]
pub struct ElasticPoint {
    /// As that of [`Displaced`].
    pub slope: [[f64; 3]; 3],
    pub strain: Symmetric,
    /// The stress of the strain, without own stress; with the mean dilatation if the integration takes it.
    pub stress: Symmetric,
}

impl Strained<'_> {
    #[inline]
    pub fn displaced(&self, at: &TabulatedPoint) -> Displaced {
        self.body.displaced(&self.element.cell, at, &self.local)
    }

    /// The weight of a tabulated point, as that of a [`LocalPoint`], and the stress there.
    #[inline]
    pub fn at(&self, at: &TabulatedPoint) -> (f64, Symmetric) {
        let point = self.displaced(at);
        (point.weight, self.stress(at, &point))
    }

    /// The unit of forces on its nodes, by stress and by powers of the unit of its cell.
    pub fn unit_of_force(&self) -> f64 {
        self.element.cell.unit().powi(self.body.dimension() as i32 - 1)
    }

    #[inline]
    pub fn stress(&self, at: &TabulatedPoint, point: &Displaced) -> Symmetric {
        self.element.stress(at, &point.strain(), self.mean_dilatation)
    }

    /// The displacement at a tabulated point: its gradient, its strain, and the stress of this strain alone.
    #[inline]
    pub fn elastic(&self, at: &TabulatedPoint) -> ElasticPoint {
        let (cell, law) = (&self.element.cell, &self.element.phase.law);
        let point = self.displaced(at);
        let strain = point.strain();
        let dilatation = self.mean_dilatation.unwrap_or_else(|| trace(&strain));
        ElasticPoint { slope: point.slope, strain, stress: law.stress(&strain, dilatation, || cell.place(&at.shape)) }
    }

    /// The dilatation that replaces that of every point, if the integration takes its mean.
    pub fn mean_dilatation(&self) -> Option<f64> {
        self.mean_dilatation
    }

    /// The strain at a tabulated point, and the stress there: tensor components `[xx, yy, zz, xy, yz, zx]`. In plane
    /// stress the strain across the plane is that of the stress and the temperature.
    pub fn strain_and_stress(&self, at: &TabulatedPoint) -> [Symmetric; 2] {
        let mut strain = self.displaced(at).strain();
        let stress = self.element.stress(at, &strain, self.mean_dilatation);
        if let Formulation::PlaneStress { .. } = self.body.formulation {
            strain[2] = self.element.phase.strain_across(&stress, self.element.cell.place(&at.shape));
        }
        [strain, stress]
    }
}

impl BodyElement<'_> {
    /// The stress of a strain at a tabulated point: C (eps - alpha T) + sigma_0. A mean `dilatation` replaces the trace
    /// of the strain.
    #[inline]
    pub fn stress(&self, at: &TabulatedPoint, strain: &Symmetric, dilatation: Option<f64>) -> Symmetric {
        let stress =
            self.phase.law.stress(strain, dilatation.unwrap_or_else(|| trace(strain)), || self.cell.place(&at.shape));
        match self.own_stress(at) {
            None => stress,
            Some(own) => [0, 1, 2, 3, 4, 5].map(|component| stress[component] + own[component]),
        }
    }

    /// The stress at a tabulated point without any strain, if there is one.
    #[inline]
    pub fn own_stress(&self, at: &TabulatedPoint) -> Option<Symmetric> {
        self.phase.own_stress(self.cell.place(&at.shape))
    }

    /// The stress at a tabulated point without any strain, and the strain that it would cause if it could, if there is
    /// one.
    pub fn own_strain(&self, at: &TabulatedPoint) -> Option<[Symmetric; 2]> {
        let stress = self.own_stress(at)?;
        Some([stress, self.phase.law.strain(&stress, || self.cell.place(&at.shape))])
    }
}
