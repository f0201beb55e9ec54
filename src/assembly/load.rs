//! Consistent nodal loads: f_a = integral of N_a times the force.

use crate::body::ElasticBody;
use crate::element::edge_integrals;
use crate::mesh::Boundary;

/// The nodes of a boundary in its order, each with its tributary area: the integral of its shape function along the
/// boundary times the thickness. The areas add up to the area of the boundary.
pub fn tributary_areas(body: &ElasticBody, boundary: &Boundary) -> Vec<(usize, f64)> {
    let nodes = body.mesh().nodes();
    let mut areas: Vec<(usize, f64)> = boundary.nodes().into_iter().map(|node| (node, 0.0)).collect();
    let mut first = 0;
    for &[start, end] in &boundary.edges {
        let Some((at_start, at_end)) = nodes.get(start).zip(nodes.get(end)) else { continue };
        // The nodes stand in the order of the edges: each edge is found from where the last one was.
        let Some(place) = areas[first..].iter().position(|entry| entry.0 == start) else { continue };
        first += place;
        let shares = edge_integrals(*at_start, *at_end);
        for (entry, share) in areas[first..].iter_mut().zip(shares) {
            entry.1 += share * body.thickness();
        }
    }
    areas
}

/// Adds to the nodal load (length `2 * n_nodes`) a constant traction (x, y; force per area) on a boundary.
pub fn add_traction(body: &ElasticBody, boundary: &Boundary, traction: [f64; 2], load: &mut [f64]) {
    for (node, area) in tributary_areas(body, boundary) {
        for (axis, value) in traction.iter().enumerate() {
            if let Some(entry) = load.get_mut(2 * node + axis) {
                *entry += value * area;
            }
        }
    }
}

/// Adds to the nodal load (length `2 * n_nodes`) a constant body force (x, y; force per volume).
pub fn add_body_force(body: &ElasticBody, force: [f64; 2], load: &mut [f64]) {
    for (nodes, cell) in body.cells() {
        for (&node, integral) in nodes.iter().zip(cell.shape_integrals()) {
            for (axis, value) in force.iter().enumerate() {
                if let Some(entry) = load.get_mut(2 * node + axis) {
                    *entry += value * integral * body.thickness();
                }
            }
        }
    }
}
