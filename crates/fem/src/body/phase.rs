//! A phase: the material and the stress without strain that a set of elements shares. A region: one of the bodies of a
//! model.

use std::ops::Range;

use super::point::Integration;
use crate::error::Error;
use crate::formulation::Formulation;
use crate::geometry::{Symmetric, dot};
use crate::material::{Law, Material, back, local};
use crate::mesh::Mesh;
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

/// One of the bodies that an [`ElasticBody`](super::ElasticBody) is made of; it shares no node with another.
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
