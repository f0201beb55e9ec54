//! The curves for which straight facets stand: cubic, through the nodes, along the normals there.
//!
//! # Source
//! A. Vlachos, J. Peters, C. Boyd, J. L. Mitchell, *Curved PN triangles*, Symposium on Interactive 3D Graphics (2001)
//! 159-166; here the control points are those with which an edge between two points of a circle meets the circle in its
//! middle.

use std::collections::HashMap;

use super::facet::{Facet, SurfaceMesh};
use crate::fem::element::PerNode;
use crate::fem::geometry::{dot, key, minus};

/// A facet whose normal turns from that at a node by more than this many degrees has a corner there.
const CORNER: f64 = 20.0;

pub(super) struct Curve<'a> {
    normals: &'a [[f64; 3]],
    /// The nodes at the rim: normals there are those of one side alone.
    is_rim: Vec<bool>,
}

impl<'a> Curve<'a> {
    /// Through the nodes of a surface, with its `normals` at the nodes.
    pub fn of(surface: &SurfaceMesh, facets: &[Facet], normals: &'a [[f64; 3]]) -> Self {
        let mut is_rim = vec![false; surface.nodes.len()];
        let mut sides: HashMap<[usize; 2], usize> = HashMap::new();
        for facet in facets {
            let corners = &facet.nodes[..facet.reference().corners];
            // An edge in the plane has its ends as sides.
            let sides_of = (0..corners.len()).map(|at| match corners.len() {
                2 => [corners[at]; 2],
                count => key(corners[at], corners[(at + 1) % count]),
            });
            sides_of.for_each(|side| *sides.entry(side).or_default() += 1);
        }
        let single = sides.into_iter().filter(|entry| entry.1 == 1).map(|entry| entry.0);
        single.flatten().for_each(|node| is_rim[node] = true);
        Curve { normals, is_rim }
    }

    /// How far the curve lies beyond a point of a straight facet, along the normal of the facet, in length; the point
    /// is given by the `shape` functions there. Zero at nodes, and for a curved facet, which is its own curve.
    pub fn beyond(&self, facet: &Facet, shape: &PerNode<f64>) -> f64 {
        if !facet.reference().mid_sides.is_empty() {
            return 0.0;
        }
        let count = facet.nodes.len();
        let along = |i: usize, j: usize, [a, b]: [f64; 2]| {
            a * a * b * self.control(facet, i, j) + b * b * a * self.control(facet, j, i)
        };
        let next = |at: usize| (at + 1) % count;
        match count {
            2 => 3.0 * along(0, 1, [shape[0], shape[1]]),
            3 => {
                let edges = (0..3).map(|i| along(i, next(i), [shape[i], shape[next(i)]])).sum::<f64>();
                let all =
                    (0..3).map(|i| self.control(facet, i, next(i)) + self.control(facet, next(i), i)).sum::<f64>();
                3.0 * edges + 1.5 * shape[0] * shape[1] * shape[2] * all
            }
            _ => {
                // Each side with its weight, which falls to zero at the opposite side.
                let side = |i: usize| {
                    let (j, before, after) = (next(i), (i + count - 1) % count, next(next(i)));
                    (shape[i] + shape[j]) * along(i, j, [shape[i] + shape[before], shape[j] + shape[after]])
                };
                3.0 * (0..count).map(side).sum::<f64>()
            }
        }
    }

    /// The control point beside node i on the way to node j, beyond the facet. At a corner or at a rim, where the
    /// normal is not that of the curve, the curve turns as at the other end.
    fn control(&self, facet: &Facet, i: usize, j: usize) -> f64 {
        let is_corner = |at: usize| dot(self.normals[facet.nodes[at]], facet.normal) < CORNER.to_radians().cos();
        let is_rim = |at: usize| self.is_rim[facet.nodes[at]];
        let (from, to) = match (is_corner(i), is_corner(j)) {
            (true, true) => return 0.0,
            (true, false) => (j, i),
            (false, false) if is_rim(i) && !is_rim(j) => (j, i),
            _ => (i, j),
        };
        let normal = self.normals[facet.nodes[from]];
        let way = minus(facet.places()[to], facet.places()[from]);
        // The arc of a circle with this tangent lies as far beyond the middle of the edge.
        -dot(way, normal) * 2.0 / (3.0 * (1.0 + dot(normal, facet.normal)))
    }
}
