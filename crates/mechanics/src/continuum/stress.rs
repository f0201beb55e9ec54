//! Stresses in balance: the stress element of every simplex, coupled by displacements of the facets.
//!
//! The displacements of the facets are the unknowns. On each facet they are coefficients of functions that are dual to a linear traction:
//! each acts on one corner only. So a row of the balance contains the tractions at that corner, and a contact row bounds one unknown.

use std::collections::HashMap;
use std::sync::Arc;

use super::johnson_mercier::{Element, PartStress};
use super::mesh::{OuterFacet, SimplexMesh};
use super::problem::ContinuumProblem;
use super::simplex::{MOST_CORNERS, Point};
use super::system::{Block, Numbers, Row, Unknowns};
use crate::error::Error;
use crate::fem::threads::each;
use signorini_qp as qp;

/// Stresses on a mesh.
#[derive(Debug)]
pub struct Stresses<'a> {
    pub problem: &'a ContinuumProblem,
    pub mesh: &'a SimplexMesh,
    /// The unknowns of each simplex: of its sides, of their corners, along the axes.
    pub numbers: Numbers,
    /// The element of each simplex; congruent simplices have one together.
    elements: Vec<Arc<Element>>,
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
    /// # Errors
    /// [`qp::Error::Numerical`] for a flat simplex.
    pub fn new(problem: &'a ContinuumProblem, mesh: &'a SimplexMesh) -> Result<Self, Error> {
        let dimension = mesh.dimension;
        let of_facet = dimension * dimension;
        // The corners of a side have the order of the nodes of the facet: both increase.
        let of_side = |&facet: &usize| of_facet * facet..of_facet * (facet + 1);
        let numbers = (0..mesh.count()).flat_map(|cell| mesh.sides(cell).iter().flat_map(of_side)).collect();
        let numbers = Numbers::new((dimension + 1) * of_facet, numbers);
        let mut known: HashMap<[[u64; 3]; MOST_CORNERS - 1], Arc<Element>> = HashMap::new();
        let element = |cell: usize| {
            let simplex = mesh.simplex(cell);
            let edges = simplex.edges().map(|edge| edge.map(f64::to_bits));
            if let Some(element) = known.get(&edges) {
                return Some(element.clone());
            }
            let element = Arc::new(Element::new(problem, &simplex)?);
            known.insert(edges, element.clone());
            Some(element)
        };
        let elements: Option<Vec<_>> = (0..mesh.count()).map(element).collect();
        let reason = || "a simplex of the mesh is flat".to_string();
        let elements =
            elements.ok_or_else(|| qp::Error::Numerical { step: "the guaranteed bound", reason: reason() })?;
        Ok(Stresses { problem, mesh, numbers, elements })
    }

    /// The number of the unknown of a facet at a corner, along an axis.
    pub fn unknown(&self, facet: usize, corner: usize, axis: usize) -> usize {
        (facet * self.mesh.dimension + corner) * self.mesh.dimension + axis
    }

    /// The places of the unknowns of the facets: a linear displacement has its values there as unknowns.
    pub fn places(&self) -> Vec<Point> {
        let share = 1.0 / (self.mesh.dimension + 1) as f64;
        let of_facet = |facet: usize| {
            let corners = self.mesh.corners_of_facet(facet);
            let sum = [0, 1, 2].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<f64>());
            corners.into_iter().map(move |corner| [0, 1, 2].map(|axis| share * (corner[axis] + sum[axis])))
        };
        (0..self.mesh.facet_count()).flat_map(of_facet).collect()
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

    /// The unknowns of each simplex, with its element.
    pub fn with_elements(&self) -> impl Iterator<Item = (&[usize], &Element)> + '_ {
        self.numbers.iter().zip(&self.elements).map(|(numbers, element)| (numbers, &**element))
    }

    /// The stiffness of each simplex.
    pub fn blocks(&self) -> Vec<Block> {
        each(self.mesh.count(), |cell| self.elements[cell].block())
    }

    /// The work of tractions and body force with the unknowns.
    pub fn load(&self) -> Vec<f64> {
        let mut load = vec![0.0; self.count()];
        if self.problem.body_force != [0.0; 3] {
            for (numbers, element) in self.with_elements() {
                numbers.iter().zip(element.load()).for_each(|(&number, part)| load[number] += part);
            }
        }
        self.loads().for_each(|(unknown, part)| load[unknown] += part);
        load
    }

    /// The work of the tractions with the free unknowns of the surface.
    pub fn loads(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let (problem, mesh) = (self.problem, self.mesh);
        mesh.surface().flat_map(move |outer| {
            let (normal, size) = mesh.simplex(outer.cell).outward(outer.local);
            let condition = &problem.conditions[outer.condition];
            let (pull, share) = (condition.pull(normal), problem.share_of_corner(size));
            let free = (0..mesh.dimension).filter(|&axis| condition.held[axis].is_none());
            free.flat_map(move |axis| {
                (0..mesh.dimension).map(move |corner| (self.unknown(outer.facet, corner, axis), share * pull[axis]))
            })
        })
    }

    /// The stress of each simplex under displacements of the facets.
    pub fn stresses(&self, displacement: &[f64]) -> Vec<PartStress> {
        let stress = |(numbers, element): (&[usize], &Element)| {
            element.stress(&numbers.iter().map(|&number| displacement[number]).collect::<Vec<_>>())
        };
        self.with_elements().map(stress).collect()
    }
}

impl Place {
    /// The node at which the row acts.
    pub fn node(&self, mesh: &SimplexMesh) -> usize {
        mesh.facet(self.on.facet)[self.corner]
    }
}
