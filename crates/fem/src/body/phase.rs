//! A phase: the material and the stress without strain that a set of elements shares. A region: one of the bodies of a
//! model. The phases of the elements of a body.

use std::ops::Range;

use super::ElasticBody;
use super::point::Integration;
use crate::error::Error;
use crate::formulation::Formulation;
use crate::geometry::{Symmetric, dot};
use crate::material::{Law, Material, back, local};
use crate::mesh::{Mesh, fail};
use signorini_linear as linear;

/// A material and its law in the formulation of the body, and its stress without strain.
#[derive(Clone, Debug, PartialEq)]
pub struct Phase {
    material: Material,
    pub law: Law,
    /// The integration of the stiffness of the elements of this phase.
    pub integration: Integration,
    /// The stress without strain, if there is one.
    pub own: Option<OwnStress>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PhaseNumber {
    Young,
    /// Poisson's ratio of the material.
    Poisson,
    /// The temperature at the origin.
    Temperature,
    /// None: the derivative is zero.
    Nothing,
}

/// The temperature above the stress-free one, linear in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Temperature {
    /// At the origin, in degrees.
    pub value: f64,
    /// In degrees per length.
    pub gradient: [f64; 3],
}

impl Temperature {
    #[inline]
    fn at(&self, place: [f64; 3]) -> f64 {
        self.value + dot(self.gradient, place)
    }
}

/// The stress without strain: `sigma_0 - C alpha T(x)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnStress {
    initial: Symmetric,
    /// `- C alpha`, the stress per degree, along the axes of the law.
    per_degree: Symmetric,
    temperature: Temperature,
}

impl OwnStress {
    const NONE: OwnStress = OwnStress {
        initial: [0.0; 6],
        per_degree: [0.0; 6],
        temperature: Temperature { value: 0.0, gradient: [0.0; 3] },
    };

    /// The change of its work, per volume, on an engineering strain with the place along each axis, for a law along x,
    /// y and z.
    #[inline]
    pub fn work_by_place(&self, strain: &Symmetric) -> [f64; 3] {
        let per_degree: f64 = self.per_degree.iter().zip(strain).map(|(stress, strain)| stress * strain).sum();
        self.temperature.gradient.map(|slope| slope * per_degree)
    }

    /// The stress at a place, where the law has these axes.
    #[inline]
    fn at(&self, place: [f64; 3], axes: &Option<[[f64; 3]; 3]>) -> Symmetric {
        let (warmer, per_degree) = (self.temperature.at(place), back(self.per_degree, axes));
        [0, 1, 2, 3, 4, 5].map(|component| self.initial[component] + warmer * per_degree[component])
    }
}

impl Phase {
    pub(super) fn new(material: Material, formulation: &Formulation) -> Result<Self, Error> {
        Ok(Phase { material, law: material.law(formulation)?, integration: Integration::Standard, own: None })
    }

    /// The same state of another material.
    pub(super) fn of(&self, material: Material, formulation: &Formulation) -> Result<Self, Error> {
        let phase = Phase { integration: self.integration, ..Self::new(material, formulation)? };
        let Some(own) = self.own else { return Ok(phase) };
        let phase = Phase { own: Some(OwnStress { initial: own.initial, ..OwnStress::NONE }), ..phase };
        match own.temperature == OwnStress::NONE.temperature {
            true => Ok(phase),
            false => phase.with_temperature(own.temperature),
        }
    }

    pub(super) fn with_temperature(self, temperature: Temperature) -> Result<Self, Error> {
        let [x, y, z] = temperature.gradient;
        if let Some(&value) = [temperature.value, x, y, z].iter().find(|value| !value.is_finite()) {
            return Err(linear::Error::Setting { name: "temperature", value, allowed: "finite" }.into());
        }
        let missing = linear::Error::Setting { name: "expansion", value: f64::NAN, allowed: "finite" };
        let per_degree = self.law.holding(&self.material.expansion().ok_or(missing)?);
        let own = self.own.unwrap_or(OwnStress::NONE);
        Ok(Phase { own: Some(OwnStress { per_degree, temperature, ..own }), ..self })
    }

    pub(super) fn with_initial_stress(self, initial: Symmetric, formulation: &Formulation) -> Result<Self, Error> {
        let has = |component: usize| formulation.stresses().contains(&component);
        for (component, value) in initial.into_iter().enumerate() {
            if !value.is_finite() {
                return Err(linear::Error::Setting { name: "initial stress", value, allowed: "finite" }.into());
            }
            if value != 0.0 && !has(component) {
                let allowed = "zero in a component that the formulation does not have";
                return Err(linear::Error::Setting { name: "initial stress", value, allowed }.into());
            }
        }
        Ok(Phase { own: Some(OwnStress { initial, ..self.own.unwrap_or(OwnStress::NONE) }), ..self })
    }

    /// The derivative of the phase: stresses of its strains are the derivatives of the stresses, at the same strain.
    /// `None` for a modulus of an orthotropic material.
    pub(super) fn derivative(&self, by: PhaseNumber) -> Option<Phase> {
        let law = match by {
            PhaseNumber::Young => self.material.by_young(&self.law)?,
            PhaseNumber::Poisson => self.material.by_poisson(&self.law)?,
            PhaseNumber::Temperature | PhaseNumber::Nothing => self.law.nothing(),
        };
        let own = self.own.filter(|_| by != PhaseNumber::Nothing).map(|own| match by {
            PhaseNumber::Temperature => {
                let temperature = Temperature { value: 1.0, gradient: [0.0; 3] };
                OwnStress { initial: [0.0; 6], temperature, ..own }
            }
            _ => {
                let per_degree = self.material.expansion().map_or([0.0; 6], |free| law.holding(&free));
                OwnStress { initial: [0.0; 6], per_degree, ..own }
            }
        });
        Some(Phase { law, own, ..self.clone() })
    }

    /// The stress at a place without any strain, if there is one.
    #[inline]
    pub fn own_stress(&self, place: [f64; 3]) -> Option<Symmetric> {
        self.own.as_ref().map(|own| own.at(place, &self.law.axes(|| place)))
    }

    /// The strain along z that a stress at a place causes, with that of the temperature there.
    pub fn strain_across(&self, stress: &Symmetric, place: [f64; 3]) -> f64 {
        let own = self.own.unwrap_or(OwnStress::NONE);
        let mut elastic = *stress;
        elastic.iter_mut().zip(own.initial).for_each(|(stress, initial)| *stress -= initial);
        let expansion = self.material.expansion().map_or(0.0, |per_degree| per_degree[2]);
        self.material.strain_across(&local(&elastic, &self.law.axes(|| place))) + own.temperature.at(place) * expansion
    }

    pub fn material(&self) -> &Material {
        &self.material
    }
}

/// One of the bodies that an [`ElasticBody`] is made of; it shares no node with another.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    name: String,
    nodes: Range<usize>,
    elements: Range<usize>,
}

impl Region {
    pub(super) fn whole(mesh: &Mesh) -> Self {
        let (nodes, elements) = (0..mesh.nodes().len(), 0..mesh.element_count());
        Region { name: String::new(), nodes, elements }
    }

    /// The same region called `name`, after `nodes` nodes and `elements` elements of other regions.
    pub(super) fn shifted(&self, name: &str, nodes: usize, elements: usize) -> Self {
        let behind = |range: &Range<usize>, count: usize| range.start + count..range.end + count;
        let (nodes, elements) = (behind(&self.nodes, nodes), behind(&self.elements, elements));
        Region { name: name.into(), nodes, elements }
    }

    /// Regions on a mesh of parts of their elements, region by region, given the element that each is a part of.
    pub(super) fn on(regions: &[Self], mesh: &Mesh, parents: &[usize]) -> Vec<Self> {
        let (mut first_node, mut first_element) = (0, 0);
        let mut next = |region: &Region| {
            let parts = parents[first_element..].iter().take_while(|&parent| region.elements.contains(parent)).count();
            let elements = first_element..first_element + parts;
            let last_node = elements.clone().flat_map(|element| mesh.element(element)).max();
            let nodes = first_node..last_node.map_or(first_node, |node| node + 1);
            (first_node, first_element) = (nodes.end, elements.end);
            Region { name: region.name.clone(), nodes, elements }
        };
        regions.iter().map(&mut next).collect()
    }

    /// Its name, the prefix of its boundaries; empty for the first.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Indices of its nodes in the mesh of the body, from 0, without gaps.
    pub fn nodes(&self) -> Range<usize> {
        self.nodes.clone()
    }

    /// Indices of its elements in the mesh of the body, from 0, without gaps.
    pub fn elements(&self) -> Range<usize> {
        self.elements.clone()
    }
}

impl ElasticBody {
    /// The same body with another material in some `elements`: their indices, from 0, in any order.
    ///
    /// # Errors
    /// As [`ElasticBody::new`] for the material; [`Error::Mesh`] for an element that does not exist, for a body of
    /// several regions, for an orthotropic material with mean dilatation.
    pub fn with_material(self, elements: &[usize], material: Material) -> Result<Self, Error> {
        let formulation = self.formulation;
        let body = self.with_phase(elements, |phase| phase.of(material, &formulation))?;
        body.check_integration()?;
        Ok(body)
    }

    /// The same body with some `elements` (indices from 0, in any order) warmer than the stress-free state: by `value`
    /// at the origin (degrees) and `gradient` (x, y, z; degrees per length) from there. It replaces an earlier
    /// temperature of an element.
    ///
    /// # Errors
    /// [`linear::Error::Setting`] for a material without coefficients of expansion, or numbers that are not finite;
    /// [`Error::Mesh`] as [`with_material`](Self::with_material).
    pub fn with_temperature(self, elements: &[usize], value: f64, gradient: [f64; 3]) -> Result<Self, Error> {
        let temperature = Temperature { value, gradient };
        self.with_phase(elements, |phase| phase.clone().with_temperature(temperature))
    }

    /// The same body with a stress `[xx, yy, zz, xy, yz, zx]` (force per area, tension positive) in some `elements`
    /// (indices from 0, in any order) that acts without strain. It replaces an earlier initial stress of an element.
    ///
    /// # Errors
    /// [`linear::Error::Setting`] for a component that is not finite, or that the formulation does not have;
    /// [`Error::Mesh`] as [`with_material`](Self::with_material).
    pub fn with_initial_stress(self, elements: &[usize], stress: Symmetric) -> Result<Self, Error> {
        let formulation = self.formulation;
        self.with_phase(elements, |phase| phase.clone().with_initial_stress(stress, &formulation))
    }

    /// Returns `true` if there is stress without strain.
    #[doc(hidden)]
    pub fn has_own_stress(&self) -> bool {
        self.phases.iter().any(|phase| phase.own.is_some())
    }

    /// The same with another phase in some elements, made from their present phase.
    fn with_phase(mut self, elements: &[usize], make: impl Fn(&Phase) -> Result<Phase, Error>) -> Result<Self, Error> {
        if self.regions.len() > 1 {
            return fail("bodies have their materials before they are joined".into());
        }
        let mut made: Vec<Option<u32>> = vec![None; self.phases.len()];
        for &element in elements {
            let count = self.of_elements.len();
            let Some(own) = self.of_elements.get_mut(element) else {
                return fail(format!("there is no element {element}; the mesh has {count}, from 0"));
            };
            // An element that is named twice already has its new phase.
            let Some(place) = made.get_mut(*own as usize) else { continue };
            if place.is_none() {
                *place = Some(self.phases.len() as u32);
                self.phases.push(make(&self.phases[*own as usize])?);
            }
            *own = place.unwrap_or(*own);
        }
        self.leave_out_empty_phases();
        Ok(self)
    }

    fn leave_out_empty_phases(&mut self) {
        let mut number = vec![None; self.phases.len()];
        self.of_elements.iter().for_each(|&phase| number[phase as usize] = Some(0));
        let mut next = 0..;
        number.iter_mut().flatten().for_each(|number| *number = next.next().unwrap_or_default());
        let mut is_used = number.iter().map(Option::is_some);
        self.phases.retain(|_| is_used.next().unwrap_or_default());
        self.of_elements.iter_mut().for_each(|phase| *phase = number[*phase as usize].unwrap_or_default());
    }

    /// The body whose stresses are the derivatives of the stresses with respect to a number of each phase, at the same
    /// displacement: one number for each phase. `None` for a modulus of an orthotropic material.
    #[doc(hidden)]
    pub fn derivative(&self, by: &[PhaseNumber]) -> Option<Self> {
        let phases = self.phases.iter().zip(by).map(|(phase, &by)| phase.derivative(by)).collect::<Option<_>>()?;
        Some(ElasticBody { phases, ..self.clone() })
    }

    /// All phases, region by region; each has an element.
    #[doc(hidden)]
    pub fn phases(&self) -> &[Phase] {
        &self.phases
    }

    /// The phases of the elements of a region.
    #[doc(hidden)]
    pub fn phases_of(&self, region: &Region) -> &[Phase] {
        let own = &self.of_elements[region.elements()];
        let [first, last] = [own.iter().min(), own.iter().max()].map(|phase| phase.map_or(0, |&phase| phase as usize));
        &self.phases[first..=last]
    }

    /// The materials of the elements of a region: one, unless parts of the region have their own.
    pub fn materials(&self, region: &Region) -> impl Iterator<Item = &Material> {
        self.phases_of(region).iter().map(Phase::material)
    }

    /// The material of an element, numbered from 0.
    #[doc(hidden)]
    pub fn material_of(&self, element: usize) -> &Material {
        self.phases[self.of_elements[element] as usize].material()
    }

    /// The density of the material of every element, in the order of [`elements`](Self::elements).
    pub(crate) fn densities(&self) -> Result<Vec<f64>, Error> {
        let missing = || linear::Error::Setting { name: "density", value: f64::NAN, allowed: "positive and finite" };
        let of_phases: Vec<f64> =
            self.phases.iter().map(|phase| phase.material().density().ok_or_else(missing)).collect::<Result<_, _>>()?;
        Ok(self.of_elements.iter().map(|&phase| of_phases[phase as usize]).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formulation::Formulation;
    use crate::geometry::distance;
    use crate::mesh::bisection::Tetrahedra;
    use crate::mesh::gmsh::GmshFile;

    fn volumes(body: &ElasticBody) -> Vec<f64> {
        let (tables, mut volumes) = (body.tabulated(), vec![0.0; body.phases().len()]);
        for element in body.elements() {
            let scale = element.cell.unit().powi(3);
            let parts = tables.at(element.kind).points.iter().map(|at| scale * body.point(&element.cell, at).weight);
            volumes[element.phase_number as usize] += parts.sum::<f64>();
        }
        volumes
    }

    #[test]
    fn bisection_leaves_every_place_its_material() {
        let mesh = GmshFile::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/meshes/box-tet4.msh"))
            .unwrap()
            .mesh(&[], 1.0)
            .unwrap();
        let [soft, stiff] = [1.0, 2.0].map(|young| Material::new(young, 0.3).unwrap());
        let near: Vec<usize> = (0..mesh.element_count())
            .filter(|&element| mesh.element(element).iter().any(|&node| distance(mesh.nodes()[node], [0.0; 3]) < 0.5))
            .collect();
        let mut cells = Tetrahedra::of(&mesh).unwrap();
        let body = ElasticBody::new(mesh, soft, Formulation::Space).unwrap().with_material(&near, stiff).unwrap();
        let expected = volumes(&body);
        assert!(expected.len() == 2 && expected.iter().all(|volume| *volume > 0.01), "{expected:?}");
        for round in 0..3 {
            let count = cells.parents().len();
            cells.refine(&(0..count).map(|cell| cell % 5 == round).collect::<Vec<_>>(), 2);
            let finer = body.on(cells.mesh().unwrap(), &cells.parents()).unwrap();
            assert!(finer.mesh().element_count() > count && finer.phases() == body.phases());
            for (found, expected) in volumes(&finer).iter().zip(&expected) {
                assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
            }
        }
    }
}
