//! The unknowns of quadratic faces in space that may touch something: coefficients of shape functions with positive
//! integrals.
//!
//! A contact row holds one coefficient, so that rows stay bounds. On triangles, coefficients below their gaps keep the
//! whole face below the gap function that these gaps define.

use std::collections::BTreeMap;

use crate::element::{POSITIVE_SHARE as WEIGHT, ReferenceElement, positive_coefficient};
use crate::mesh::Boundary;

/// The facets of a boundary in space, each with its reference cell; none if it has edges or points.
fn of_boundary(boundary: &Boundary) -> impl Iterator<Item = (&'static ReferenceElement, &[usize])> {
    let facet = boundary.kind.reference();
    boundary.facets().filter(|_| facet.dimension == 2).map(move |nodes| (facet, nodes))
}

/// The change from nodal values to coefficients at mid-side nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PositiveBasis {
    /// The ends of the edge of each mid-side node that has a coefficient.
    ends: BTreeMap<usize, [usize; 2]>,
}

impl PositiveBasis {
    /// The basis of the mid-side nodes of quadratic faces in space; for all other boundaries nothing changes.
    pub fn on<'a>(boundaries: impl IntoIterator<Item = &'a Boundary>) -> Self {
        let mut basis = PositiveBasis::default();
        for (facet, nodes) in boundaries.into_iter().flat_map(of_boundary) {
            for (&middle, ends) in nodes[facet.corners..].iter().zip(facet.mid_sides) {
                basis.ends.insert(middle, ends.map(|corner| nodes[corner]));
            }
        }
        basis
    }

    /// Keeps the nodes for which `keep` returns `true`, given the node and the ends of its edge.
    pub fn retain(&mut self, keep: impl Fn(usize, [usize; 2]) -> bool) {
        self.ends.retain(|&middle, ends| keep(middle, *ends));
    }

    /// Returns `true` if no node has a coefficient other than its value.
    pub fn is_nodal(&self) -> bool {
        self.ends.is_empty()
    }

    /// The ends of the edge of a mid-side node that has a coefficient.
    #[inline]
    pub fn ends(&self, node: usize) -> Option<[usize; 2]> {
        self.ends.get(&node).copied()
    }

    /// The coefficients that make up the value at a node, each with its share.
    pub fn values(&self, node: usize) -> impl Iterator<Item = (usize, f64)> {
        let ends = self.ends(node);
        let own = if ends.is_some() { 1.0 - 2.0 * WEIGHT } else { 1.0 };
        std::iter::once((node, own)).chain(ends.into_iter().flatten().map(|end| (end, WEIGHT)))
    }

    pub fn coefficient(&self, node: usize, value: impl Fn(usize) -> f64) -> f64 {
        match self.ends(node) {
            Some(ends) => positive_coefficient(value(node), ends.map(value)),
            None => value(node),
        }
    }

    /// The nodes whose values make up the coefficient at a node, each with its share.
    pub fn shares(&self, node: usize) -> impl Iterator<Item = (usize, f64)> {
        let nodes = std::iter::once(node).chain(self.ends(node).into_iter().flatten());
        nodes.map(move |of| (of, self.coefficient(node, |node| f64::from(u8::from(node == of)))))
    }

    /// The coefficient of the position: the point at which a force on a coefficient acts, for its moment.
    pub fn place(&self, nodes: &[[f64; 3]], node: usize) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.coefficient(node, |node| nodes[node][axis]))
    }

    /// Replaces coefficients (`dimension` per node) by the values at the nodes.
    pub fn evaluate(&self, coefficients: &mut [f64], dimension: usize) {
        for (&middle, &ends) in &self.ends {
            for axis in 0..dimension {
                let sum: f64 = ends.iter().map(|end| coefficients[dimension * end + axis]).sum();
                let own = &mut coefficients[dimension * middle + axis];
                *own = (1.0 - 2.0 * WEIGHT) * *own + WEIGHT * sum;
            }
        }
    }

    /// Replaces the integrals of the nodal shape functions of some nodes by those of the positive functions; all ends
    /// must be among the nodes.
    pub fn gather_areas(&self, areas: &mut BTreeMap<usize, f64>) {
        for (middle, ends) in &self.ends {
            let Some(own) = areas.get_mut(middle) else { continue };
            let area = std::mem::replace(own, (1.0 - 2.0 * WEIGHT) * *own);
            for end in ends {
                if let Some(of_end) = areas.get_mut(end) {
                    *of_end += WEIGHT * area;
                }
            }
        }
    }

    /// Replaces forces on the nodes (`dimension` per node) by forces on the coefficients.
    pub fn gather(&self, forces: &mut [f64], dimension: usize) {
        for (&middle, &ends) in &self.ends {
            for axis in 0..dimension {
                let force = forces[dimension * middle + axis];
                ends.iter().for_each(|end| forces[dimension * end + axis] += WEIGHT * force);
                forces[dimension * middle + axis] = (1.0 - 2.0 * WEIGHT) * force;
            }
        }
    }

    /// Replaces forces on the coefficients by forces on the nodes.
    pub fn scatter(&self, forces: &mut [f64], dimension: usize) {
        for (&middle, &ends) in &self.ends {
            for axis in 0..dimension {
                let force = forces[dimension * middle + axis] / (1.0 - 2.0 * WEIGHT);
                ends.iter().for_each(|end| forces[dimension * end + axis] -= WEIGHT * force);
                forces[dimension * middle + axis] = force;
            }
        }
    }
}
