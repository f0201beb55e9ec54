//! Nodes of structured meshes by their position in a lattice, and cells cut into elements.
//!
//! Keys count half steps, so that mid-sides have keys too; only nodes that an element uses are made.

use std::collections::HashMap;
use std::hash::Hash;

use super::{Boundary, ElementKind, MAX_NODES, Mesh, Zone, fail};
use crate::error::Error;
use crate::fem::geometry::{key, length, minus};

/// The nodes made so far.
pub(crate) struct Lattice<K> {
    numbers: HashMap<K, usize>,
    /// The keys in the order of the nodes.
    pub keys: Vec<K>,
}

impl<K: Copy + Eq + Hash> Lattice<K> {
    pub fn new() -> Self {
        Lattice { numbers: HashMap::new(), keys: Vec::new() }
    }

    pub fn node(&mut self, key: K) -> usize {
        *self.numbers.entry(key).or_insert_with(|| {
            self.keys.push(key);
            self.keys.len() - 1
        })
    }

    /// Adds the elements of a plane cell. `key` gives the key at half steps 0, 1, 2 in the two directions of the
    /// cell, which turn counterclockwise; triangles are cut from (0, 0) to (2, 2).
    pub fn add_cell(&mut self, kind: ElementKind, key: impl Fn(usize, usize) -> K, connectivity: &mut Vec<usize>) {
        const QUADRILATERAL: [&[[usize; 2]]; 1] = [&[[0, 0], [2, 0], [2, 2], [0, 2]]];
        const TRIANGLES: [&[[usize; 2]]; 2] = [&[[0, 0], [2, 0], [2, 2]], &[[0, 0], [2, 2], [0, 2]]];
        let parts: &[&[[usize; 2]]] = if kind.corners() == 4 { &QUADRILATERAL } else { &TRIANGLES };
        for corners in parts {
            connectivity.extend(corners.iter().map(|&[a, b]| self.node(key(a, b))));
            if kind.is_quadratic() {
                let next = corners.iter().cycle().skip(1);
                let middles = corners.iter().zip(next).map(|(p, q)| [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2]);
                connectivity.extend(middles.map(|[a, b]| self.node(key(a, b))));
            }
        }
    }
}

/// The lines of an axis at half steps: the mean of each two lines is inserted between them.
pub(crate) fn half_steps(lines: &[f64]) -> Vec<f64> {
    let mut fine = Vec::with_capacity(2 * lines.len());
    for (index, &line) in lines.iter().enumerate() {
        if index > 0 {
            let before = lines[index - 1];
            fine.push(before + (line - before) / 2.0);
        }
        fine.push(line);
    }
    fine
}

impl Mesh {
    /// The same mesh of a quadratic `kind`, whose corners are the nodes of its elements; edges stay straight. The new
    /// nodes follow the old ones.
    pub(crate) fn elevated(&self, kind: ElementKind) -> Result<Mesh, Error> {
        let own = self.kind_of(0);
        if (own.nodes(), own.dimension()) != (kind.corners(), kind.dimension()) {
            return fail(format!("a mesh of {} cannot become one of {}", own.name(), kind.name()));
        }
        let mut middles = Middles { nodes: self.nodes().to_vec(), of: HashMap::new() };
        let mut connectivity = Vec::with_capacity(self.element_count() * kind.nodes());
        for element in self.elements() {
            middles.extend(element, kind.reference().mid_sides, &mut connectivity);
        }
        if middles.nodes.len() > MAX_NODES {
            let count = middles.nodes.len();
            return fail(format!("{count} nodes are more than the {MAX_NODES} that are allowed"));
        }
        let facet = kind.facet();
        let mut boundaries = Vec::with_capacity(self.boundaries().len());
        for boundary in self.boundaries() {
            let mut facets = Vec::with_capacity(boundary.facet_count() * facet.nodes());
            for corners in boundary.facets() {
                middles.extend(corners, facet.reference().mid_sides, &mut facets);
            }
            boundaries.push(Boundary::new(boundary.name.as_str(), facet, facets));
        }
        Ok(Mesh::new(middles.nodes, kind, connectivity, boundaries)?.with_groups(self.groups().to_vec()))
    }

    /// The same with the nodes of a boundary moved along their radius onto a sphere.
    pub(crate) fn onto_sphere(mut self, boundary: &str, centre: [f64; 3], radius: f64) -> Self {
        for node in self.boundary(boundary).map_or_else(Vec::new, |boundary| boundary.nodes()) {
            let away = minus(self.nodes[node], centre);
            let stretch = radius / length(away);
            self.nodes[node] = [0, 1, 2].map(|axis| centre[axis] + stretch * away[axis]);
        }
        self
    }
}

/// The nodes so far, and the mid-edge nodes by the ends of their edges.
struct Middles {
    nodes: Vec<[f64; 3]>,
    of: HashMap<[usize; 2], usize>,
}

impl Middles {
    /// Adds the corners of a cell and the middles of its edges, in this order, to `connectivity`.
    fn extend(&mut self, corners: &[usize], edges: &[[usize; 2]], connectivity: &mut Vec<usize>) {
        connectivity.extend(corners);
        for edge in edges {
            let [a, b] = edge.map(|local| corners[local]);
            let middle = *self.of.entry(key(a, b)).or_insert_with(|| {
                let (one, other) = (self.nodes[a], self.nodes[b]);
                self.nodes.push([0, 1, 2].map(|axis| one[axis] + (other[axis] - one[axis]) / 2.0));
                self.nodes.len() - 1
            });
            connectivity.push(middle);
        }
    }
}

/// Half the width of the core divided by the radius: cells are neither flat at its corners nor small in its middle.
const CORE: f64 = 0.4;

/// The lines of a round body around its core.
pub(crate) struct Grading {
    radius: f64,
    /// Arc lengths from the lowest point to the corner of the core, fine at 0.
    pub aside: Vec<f64>,
    /// Arc lengths from the cut to the corner of the core.
    pub down: Vec<f64>,
    /// The positions of the shells, from 0 at the core to 1 at the surface, fine at 1.
    pub shells: Vec<f64>,
}

impl Grading {
    pub fn new(radius: f64, zone: &Zone) -> Result<Self, Error> {
        zone.check(radius)?;
        let quarter = radius * std::f64::consts::FRAC_PI_4;
        let aside = zone.lines(quarter)?;
        // About as wide as the last cell next to them.
        let last = quarter - aside[aside.len() - 2];
        let rows = (quarter / last).round().max(2.0);
        let down = (0..=rows as usize).map(|row| quarter * row as f64 / rows).collect();
        let depth = radius * (1.0 - CORE);
        let mut shells: Vec<f64> = zone.lines(depth)?.iter().map(|line| 1.0 - line / depth).collect();
        shells.reverse();
        Ok(Grading { radius, aside, down, shells })
    }

    /// The tangent of the angle of an arc length from an axis; exact at the corner of the core, where it is 1.
    pub fn tangent(&self, arc: f64) -> f64 {
        let angle = arc / self.radius;
        if angle.abs() >= std::f64::consts::FRAC_PI_4 { angle.signum() } else { angle.tan() }
    }

    /// The position, relative to the centre, of a point of the core (given in halves of the core's width) that is moved
    /// along its ray by `outward`: from the core (0) to the surface (1).
    pub fn place(&self, core: [f64; 3], outward: f64) -> [f64; 3] {
        if outward == 0.0 {
            return core.map(|value| value * CORE * self.radius);
        }
        let stretch = (1.0 - outward) * CORE + outward / length(core);
        core.map(|value| value * stretch * self.radius)
    }
}
