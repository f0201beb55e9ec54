//! Springs that are spread over facets: a part of the body without volume, whose strain is the displacement of the facet.

use super::bound::Bracket;
use super::displacement::on_facet;
use super::integration::samples_on_facet;
use super::mesh::OuterFacet;
use super::sample::Sample;
use super::simplex::Point;
use crate::fem::geometry::{dot, minus};

/// A point of a facet on springs.
pub struct OnSprings {
    /// The point of integration.
    pub at: Sample,
    /// The simplex of the facet.
    pub cell: usize,
    outer: OuterFacet,
    normal: Point,
}

impl Bracket<'_> {
    /// The points of all facets on springs.
    pub fn on_springs(&self) -> impl Iterator<Item = OnSprings> + '_ {
        self.stresses.on_springs().flat_map(|outer| {
            let (normal, _) = self.mesh.simplex(outer.cell).outward(outer.local);
            let samples = samples_on_facet(self.problem, &self.mesh.corners_of_facet(outer.facet));
            samples.into_iter().map(move |at| OnSprings { at, cell: outer.cell, outer, normal })
        })
    }

    /// The values there of a displacement, and of the displacement whose forces the springs have in balance by unknowns of the stress.
    pub fn moved(&self, on: &OnSprings, displacement: &[f64], facets: &[f64]) -> [Point; 2] {
        let dimension = self.mesh.dimension;
        let (mut moved, mut balanced) = ([0.0; 3], [0.0; 3]);
        for (function, value) in
            self.displacements.on_facet(&on.outer).into_iter().zip(on_facet(dimension, on.at.weights))
        {
            (0..dimension).for_each(|axis| moved[axis] += value * displacement[dimension * function + axis]);
        }
        let radius = self.problem.radius(on.at.place);
        let of_corners = self.stresses.displacement_at_corners(facets, &on.outer);
        for (corner, weight) in of_corners.into_iter().zip(on.at.weights) {
            (0..dimension).for_each(|axis| balanced[axis] += weight * corner[axis] / radius);
        }
        [moved, balanced]
    }

    /// The product there of the forces of the springs under one displacement with another one, per area.
    pub fn product_of_springs(&self, on: &OnSprings, one: Point, other: Point) -> f64 {
        dot(self.problem.springs(&on.outer).resistance(on.normal, one), other)
    }

    /// The square there of the difference of a displacement and one in balance, with what the polynomial for 1/r makes it too large.
    pub fn square_on_springs(&self, on: &OnSprings, [moved, balanced]: [Point; 2]) -> f64 {
        let rest = minus(moved, balanced);
        on.at.weight * self.product_of_springs(on, rest, rest)
            + on.at.extra * self.product_of_springs(on, balanced, balanced)
    }
}
