//! Springs that are spread over facets: a part of the body without volume, whose strain is the displacement of the facet.

use super::bound::Bracket;
use super::displacement::{OnFacet, mean_of_product};
use super::mesh::OuterFacet;
use super::simplex::{Point, pairs};
use crate::fem::geometry::dot;

impl Bracket<'_> {
    /// The facets on springs, with the displacement of each, and the one that has the forces of the springs in balance.
    pub fn on_springs(&self) -> impl Iterator<Item = (OuterFacet, [OnFacet; 2])> + '_ {
        self.stresses.on_springs().map(|outer| {
            let of_bracket =
                [self.of_displacement(&self.primal.values, &outer), self.of_stress(&self.dual.values, &outer)];
            (outer, of_bracket)
        })
    }

    /// A displacement on a facet.
    pub fn of_displacement(&self, values: &[f64], outer: &OuterFacet) -> OnFacet {
        let dimension = self.mesh.dimension;
        let component = |function: usize, axis: usize| match axis {
            _ if axis < dimension => values[dimension * function + axis],
            _ => 0.0,
        };
        let functions = self.displacements.on_facet(outer).into_iter();
        functions.map(|function| [0, 1, 2].map(|axis| component(function, axis))).collect()
    }

    /// The linear displacement of a facet by unknowns of the stress.
    pub fn of_stress(&self, values: &[f64], outer: &OuterFacet) -> OnFacet {
        let corners = self.stresses.displacement_at_corners(values, outer);
        let middle = |[i, j]: [usize; 2]| [0, 1, 2].map(|axis| (corners[i][axis] + corners[j][axis]) / 2.0);
        pairs(self.mesh.dimension).map(middle).collect()
    }

    /// The work of the forces of the springs on a facet under one displacement with another one.
    pub fn work_of_springs(&self, outer: &OuterFacet, one: &[Point], other: &[Point]) -> f64 {
        let (normal, size) = self.mesh.simplex(outer.cell).outward(outer.local);
        let springs = self.problem.springs(outer);
        let mut mean = 0.0;
        for (i, &own) in one.iter().enumerate() {
            let resistance = springs.resistance(normal, own);
            for (j, &moved) in other.iter().enumerate() {
                mean += mean_of_product(self.mesh.dimension, i, j) * dot(resistance, moved);
            }
        }
        self.problem.thickness * size * mean
    }
}
