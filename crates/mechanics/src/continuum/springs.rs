//! Springs that are spread over facets: a part of the body without volume, whose strain is the displacement of the
//! facet.

use super::bound::Bracket;
use super::displacement::on_facet;
use super::integration::{Sample, samples_on_facet};
use super::problem::Foundation;
use super::simplex::Point;
use crate::fem::geometry::{dot, minus};

/// A point of a facet on springs under a displacement and a stress.
pub struct OnSprings {
    /// The point of integration.
    pub at: Sample,
    /// The simplex of the facet.
    pub cell: usize,
    /// The displacement.
    pub moved: Point,
    /// The displacement whose forces the springs have in balance with the stress.
    pub balanced: Point,
    springs: Foundation,
    normal: Point,
}

impl OnSprings {
    /// The product of the forces of the springs under one displacement with another one, per area.
    pub fn product(&self, one: Point, other: Point) -> f64 {
        dot(self.springs.resistance(self.normal, one), other)
    }

    /// The square of the difference of both displacements, times the area, with what the polynomial for 1/r adds.
    pub fn square_of_rest(&self) -> f64 {
        let rest = minus(self.moved, self.balanced);
        self.at.weight * self.product(rest, rest) + self.at.extra * self.product(self.balanced, self.balanced)
    }
}

impl Bracket<'_> {
    /// The points of all facets on springs, under a displacement and under the stress of these unknowns.
    pub fn on_springs<'a>(
        &'a self,
        displacement: &'a [f64],
        of_stress: &'a [f64],
    ) -> impl Iterator<Item = OnSprings> + 'a {
        let (problem, dimension) = (self.problem, self.mesh.dimension);
        self.stresses.on_springs().flat_map(move |outer| {
            let (normal, _) = self.mesh.simplex(outer.cell).outward(outer.local);
            let functions = self.displacements.on_facet(&outer);
            let of_corners = self.stresses.displacement_at_corners(of_stress, &outer);
            let samples = samples_on_facet(problem, &self.mesh.corners_of_facet(outer.facet));
            samples.into_iter().map(move |at| {
                let (mut moved, mut balanced) = ([0.0; 3], [0.0; 3]);
                for (function, value) in functions.iter().zip(on_facet(dimension, at.weights)) {
                    (0..dimension).for_each(|axis| moved[axis] += value * displacement[dimension * function + axis]);
                }
                for (corner, weight) in of_corners.iter().zip(at.weights) {
                    (0..3).for_each(|axis| balanced[axis] += weight * corner[axis] / problem.radius(at.place));
                }
                OnSprings { at, cell: outer.cell, moved, balanced, springs: problem.springs(&outer), normal }
            })
        })
    }
}
