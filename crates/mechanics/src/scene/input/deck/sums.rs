//! Sums of components of nodes, which equations set to zero and springs resist.

use std::collections::BTreeMap;

use crate::fem::mesh::deck::Place;

/// A component of a node: the place of the node in the deck, then 0 to 2 for its displacements along x, y, z and 3 to 5
/// for its rotations about them. A node without elements has its displacements along its local axes.
pub(super) type Component = (usize, usize);

/// A coefficient that a difference leaves below this share of its parts is rounding.
const CANCELLED: f64 = 1e-13;

/// A sum of components with coefficients and of a constant.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Sum {
    pub terms: BTreeMap<Component, f64>,
    /// The components that are replaced by their values, with their coefficients.
    pub replaced: BTreeMap<Component, f64>,
    pub constant: f64,
    /// The largest part of the constant.
    pub scale: f64,
}

impl Sum {
    /// Adds a component with a coefficient; coefficients of one component add up.
    pub fn add(&mut self, component: Component, coefficient: f64) {
        let old = self.terms.get(&component).copied().unwrap_or(0.0);
        let sum = old + coefficient;
        match sum.abs() <= CANCELLED * old.abs().max(coefficient.abs()) {
            true => _ = self.terms.remove(&component),
            false => _ = self.terms.insert(component, sum),
        }
    }

    /// Adds a displacement of a node along a vector.
    pub fn add_along(&mut self, node: usize, vector: [f64; 3]) {
        vector.into_iter().enumerate().for_each(|(axis, part)| self.add((node, axis), part));
    }

    /// Calls a component by another name.
    pub fn rename(&mut self, component: Component, name: Component) {
        if let Some(coefficient) = self.terms.remove(&component) {
            self.add(name, coefficient);
        }
    }

    /// Replaces a component by its value.
    pub fn insert(&mut self, component: Component, value: f64) {
        if let Some(coefficient) = self.terms.remove(&component) {
            self.replaced.insert(component, coefficient);
            self.constant += coefficient * value;
            self.scale = self.scale.max((coefficient * value).abs());
        }
    }

    /// Replaces a component by the one with which another sum, which has it, is zero.
    pub fn eliminate(&mut self, component: Component, zero: &Sum) {
        if let Some(coefficient) = self.terms.get(&component) {
            self.add_multiple(-coefficient / zero.terms[&component], zero);
            self.terms.remove(&component);
        }
    }

    /// Adds a multiple of another sum.
    pub fn add_multiple(&mut self, factor: f64, other: &Sum) {
        other.terms.iter().for_each(|(component, coefficient)| self.add(*component, factor * coefficient));
        for (component, coefficient) in &other.replaced {
            *self.replaced.entry(*component).or_default() += factor * coefficient;
        }
        self.constant += factor * other.constant;
        self.scale = self.scale.max((factor * other.scale).abs());
    }

    /// The coefficient of a component over the largest of all; 0 if it does not occur.
    pub fn share(&self, component: Component) -> f64 {
        let Some(own) = self.terms.get(&component) else { return 0.0 };
        own.abs() / self.terms.values().fold(0.0, |largest: f64, coefficient| largest.max(coefficient.abs()))
    }

    /// Its nodes, each with the vector of its displacement.
    pub fn vectors(&self) -> BTreeMap<usize, [f64; 3]> {
        let mut vectors: BTreeMap<usize, [f64; 3]> = BTreeMap::new();
        for (&(node, axis), coefficient) in self.terms.iter().filter(|(component, _)| component.1 < 3) {
            vectors.entry(node).or_default()[axis] = *coefficient;
        }
        vectors
    }
}

/// A sum that is zero.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Equation {
    pub sum: Sum,
    pub place: Place,
}
