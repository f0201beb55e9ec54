//! The nodes of a surface of a deck, and their areas.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use super::content::Deck;
use super::surfaces::Surface;
use crate::fem::element::{Cell, MAX_NODES, Tabulated};
use crate::fem::geometry::length;

impl Deck {
    /// The nodes of a surface, by their places, increasing.
    pub fn nodes_of_surface(&self, surface: &Surface) -> Vec<usize> {
        let of_faces = surface.faces.iter().flat_map(|&face| self.nodes_of_face(face));
        of_faces.chain(surface.bare.iter().copied()).collect::<BTreeSet<_>>().into_iter().collect()
    }

    /// The nodes of faces, each with the integrals of its shape function and of that times the outward normal: an area,
    /// a length in the plane, that of the full circle in an axisymmetric model. At a corner of a quadratic face it may
    /// be zero or negative.
    pub fn areas(&self, faces: &[(usize, usize)]) -> BTreeMap<usize, (f64, [f64; 3])> {
        let mut areas: BTreeMap<usize, (f64, [f64; 3])> = BTreeMap::new();
        for &face in faces {
            let reference = self.element_list[face.0].kind.facet().reference();
            let nodes: Vec<usize> = self.nodes_of_face(face).collect();
            let mut coordinates = [[0.0; 3]; MAX_NODES];
            coordinates.iter_mut().zip(&nodes).for_each(|(at, &node)| *at = self.at[node]);
            let cell = Cell::new(reference, &coordinates);
            let unit = cell.unit().powi(reference.dimension as i32);
            let revolved = self.is_axisymmetric();
            let rule = if revolved { reference.quadrature_revolved } else { reference.quadrature };
            for point in &Tabulated::with_rule(reference, rule.to_vec()).points {
                let radius: f64 = nodes.iter().zip(point.shape).map(|(&node, share)| share * self.at[node][0]).sum();
                let around = if revolved { TAU * radius } else { 1.0 };
                let vector = cell.area_vector(&point.derivative).map(|part| around * part * point.weight * unit);
                for (&node, share) in nodes.iter().zip(point.shape) {
                    let (area, outward) = areas.entry(node).or_default();
                    *area += share * length(vector);
                    outward.iter_mut().zip(vector).for_each(|(sum, part)| *sum += share * part);
                }
            }
        }
        areas
    }
}
