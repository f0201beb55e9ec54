//! Stresses in balance: the stress element of every simplex, coupled by displacements of the facets.
//!
//! The displacements of the facets are the unknowns. On each facet they are coefficients of functions that are dual to a linear traction:
//! each acts on one corner only. So a row of the balance contains the tractions at that corner, and a contact row bounds one unknown.

use super::johnson_mercier::{Element, PartStress};
use super::mesh::{OuterFacet, SimplexMesh};
use super::problem::ContinuumProblem;
use super::system::{Block, Numbers, Row, Unknowns};

/// Stresses on a mesh.
#[derive(Debug)]
pub struct Stresses<'a> {
    problem: &'a ContinuumProblem,
    mesh: &'a SimplexMesh,
    /// The unknowns of each simplex: of its sides, of their corners, along the axes.
    pub numbers: Numbers,
}

/// The place at which a contact row of the stress acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The facet.
    pub on: OuterFacet,
    /// The number of its corner.
    pub corner: usize,
    /// The obstacle.
    pub obstacle: usize,
}

impl<'a> Stresses<'a> {
    pub fn new(problem: &'a ContinuumProblem, mesh: &'a SimplexMesh) -> Self {
        let dimension = mesh.dimension;
        let of_facet = dimension * dimension;
        // The corners of a side have the order of the nodes of the facet: both increase.
        let of_side = |&facet: &usize| of_facet * facet..of_facet * (facet + 1);
        let numbers = (0..mesh.count()).flat_map(|cell| mesh.sides(cell).iter().flat_map(of_side)).collect();
        Stresses { problem, mesh, numbers: Numbers::new((dimension + 1) * of_facet, numbers) }
    }

    /// The number of the unknown of a facet at a corner, along an axis.
    pub fn unknown(&self, facet: usize, corner: usize, axis: usize) -> usize {
        (facet * self.mesh.dimension + corner) * self.mesh.dimension + axis
    }

    /// Number of unknowns, free or held.
    fn count(&self) -> usize {
        self.unknown(self.mesh.facet_count(), 0, 0)
    }

    /// The unknowns; those on held facets are prescribed.
    pub fn unknowns(&self) -> Unknowns {
        let mut held = vec![None; self.count()];
        for outer in self.mesh.surface() {
            for (axis, value) in self.problem.held(&outer) {
                let corners = 0..self.mesh.dimension;
                corners.for_each(|corner| held[self.unknown(outer.facet, corner, axis)] = Some(value));
            }
        }
        Unknowns::new(held)
    }

    /// The contact rows, one for each corner of a facet and obstacle, and their places. The gaps are upper bounds on the weighted means of
    /// the distance. A row that `may_touch` does not hold for, given its place and gap, is left out: there the stress has no pressure,
    /// which keeps it in balance.
    pub fn rows(&self, unknowns: &Unknowns, may_touch: impl Fn(&Place, f64) -> bool) -> (Vec<Row>, Vec<Place>) {
        let (mut rows, mut places) = (Vec::new(), Vec::new());
        for (on, obstacle) in self.problem.facing(self.mesh) {
            let facing = &self.problem.obstacles[obstacle];
            let gap = facing.surface.gap(&self.mesh.corners_of_facet(on.facet));
            let Some(gap) = gap.filter(|gap| gap.above.is_finite()) else { continue };
            for (corner, gap) in gap.upper_means(self.mesh.dimension).into_iter().enumerate() {
                let (unknown, place) = (self.unknown(on.facet, corner, facing.axis), Place { on, corner, obstacle });
                if unknowns.is_free(unknown) && may_touch(&place, gap) {
                    rows.push(Row { unknown, sense: facing.sense, gap });
                    places.push(place);
                }
            }
        }
        (rows, places)
    }

    fn elements(&self) -> impl Iterator<Item = Element> + '_ {
        (0..self.mesh.count()).map(|cell| Element::new(self.problem, &self.mesh.simplex(cell)))
    }

    /// The unknowns of each simplex, with its stiffness.
    pub fn blocks(&self) -> impl Iterator<Item = (&[usize], Block)> + '_ {
        self.numbers.iter().zip(self.elements().map(|element| element.block()))
    }

    /// The work of tractions and body force with the unknowns.
    pub fn load(&self) -> Vec<f64> {
        let (problem, mesh) = (self.problem, self.mesh);
        let mut load = vec![0.0; self.count()];
        if problem.body_force != [0.0; 3] {
            for (numbers, element) in self.numbers.iter().zip(self.elements()) {
                numbers.iter().zip(element.load()).for_each(|(&number, part)| load[number] += part);
            }
        }
        for outer in mesh.surface() {
            let (normal, size) = mesh.simplex(outer.cell).outward(outer.local);
            let (traction, share) = (problem.conditions[outer.condition].pull(normal), problem.share_of_corner(size));
            for corner in 0..mesh.dimension {
                for (axis, part) in traction.into_iter().enumerate().take(mesh.dimension) {
                    load[self.unknown(outer.facet, corner, axis)] += share * part;
                }
            }
        }
        load
    }

    /// The stress of each simplex under displacements of the facets.
    pub fn stresses(&self, displacement: &[f64]) -> Vec<PartStress> {
        let stress = |(numbers, element): (&[usize], Element)| {
            element.stress(&numbers.iter().map(|&number| displacement[number]).collect::<Vec<_>>())
        };
        self.numbers.iter().zip(self.elements()).map(stress).collect()
    }
}

impl Place {
    /// The node at which the row acts.
    pub fn node(&self, mesh: &SimplexMesh) -> usize {
        mesh.facet(self.on.facet)[self.corner]
    }
}
