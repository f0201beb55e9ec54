//! Stresses in balance: the stress element of every triangle, coupled by displacements of the edges.
//!
//! The displacements of the edges are the unknowns. On each edge they are coefficients of functions that are dual to a linear traction:
//! each acts on one end only. So a row of the balance contains the tractions at that end, and a contact row bounds one unknown.

use super::johnson_mercier::{Element, PartStress};
use super::problem::PlaneProblem;
use super::system::{Block, LOCAL, Row, Unknowns};
use super::triangulation::{Triangulation, distance, outward};

/// Stresses on a mesh.
#[derive(Debug)]
pub struct Stresses<'a> {
    problem: &'a PlaneProblem,
    mesh: &'a Triangulation,
    elements: Vec<Element>,
    /// The unknowns of each triangle.
    pub numbers: Vec<[usize; LOCAL]>,
}

/// The place at which a contact row of the stress acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The edge.
    pub edge: usize,
    /// Its end, 0 or 1.
    pub end: usize,
    /// The obstacle.
    pub obstacle: usize,
}

impl<'a> Stresses<'a> {
    pub fn new(problem: &'a PlaneProblem, mesh: &'a Triangulation) -> Self {
        let count = mesh.triangles.len();
        let numbers = (0..count).map(|triangle| {
            let mut numbers = [0; LOCAL];
            for side in 0..3 {
                let edge = mesh.sides[triangle][side];
                for end in 0..2 {
                    let of_edge = mesh.end_at(triangle, side, 1 + end);
                    for axis in 0..2 {
                        numbers[4 * side + 2 * end + axis] = unknown(edge, of_edge, axis);
                    }
                }
            }
            numbers
        });
        Stresses {
            problem,
            mesh,
            numbers: numbers.collect(),
            elements: (0..count).map(|triangle| Element::new(problem, mesh.corners(triangle))).collect(),
        }
    }

    /// The unknowns; those on held sides are prescribed.
    pub fn unknowns(&self) -> Unknowns {
        let mut held = vec![None; 4 * self.mesh.edges.len()];
        for (_, _, edge, condition) in self.mesh.outline() {
            for (axis, value) in self.problem.conditions[condition].held.into_iter().enumerate() {
                (0..2).for_each(|end| held[unknown(edge, end, axis)] = value);
            }
        }
        Unknowns::new(held)
    }

    /// The contact rows, two for each side and obstacle, and their places. The gaps are upper bounds on the weighted means of the
    /// distance.
    pub fn rows(&self, unknowns: &Unknowns) -> (Vec<Row>, Vec<Place>) {
        let (mut rows, mut places) = (Vec::new(), Vec::new());
        for (edge, [from, to], obstacle) in self.problem.facing(self.mesh) {
            let facing = &self.problem.obstacles[obstacle];
            let Some(gap) = facing.surface.gap(from, to).filter(|gap| gap.above.is_finite()) else { continue };
            for (end, gap) in gap.upper_means().into_iter().enumerate() {
                let unknown = unknown(edge, end, facing.axis);
                if unknowns.is_free(unknown) {
                    rows.push(Row { unknown, sense: facing.sense, gap });
                    places.push(Place { edge, end, obstacle });
                }
            }
        }
        (rows, places)
    }

    /// The unknowns of each triangle, with its stiffness.
    pub fn blocks(&self) -> impl Iterator<Item = (&[usize; LOCAL], Block)> + '_ {
        self.numbers.iter().zip(self.elements.iter().map(Element::block))
    }

    /// The work of tractions and body force with the unknowns.
    pub fn load(&self) -> Vec<f64> {
        let (problem, mesh) = (self.problem, self.mesh);
        let mut load = vec![0.0; 4 * mesh.edges.len()];
        for (numbers, element) in self.numbers.iter().zip(&self.elements) {
            numbers.iter().zip(element.load()).for_each(|(&number, part)| load[number] += part);
        }
        for (triangle, local, edge, condition) in mesh.outline() {
            let traction = problem.conditions[condition].pull(outward(mesh.corners(triangle), local).0);
            let share = self.half_area(edge);
            for axis in 0..2 {
                (0..2).for_each(|end| load[unknown(edge, end, axis)] += share * traction[axis]);
            }
        }
        load
    }

    /// Half the area of an edge: the factor of a traction at an end.
    pub fn half_area(&self, edge: usize) -> f64 {
        let [from, to] = self.mesh.edges[edge].map(|node| self.mesh.nodes[node]);
        self.problem.thickness * distance(from, to) / 2.0
    }

    /// The stress of each triangle under displacements of the edges.
    pub fn stresses(&self, displacement: &[f64]) -> Vec<PartStress> {
        let stress = |(numbers, element): (&[usize; LOCAL], &Element)| {
            element.stress(numbers.map(|number| displacement[number]))
        };
        self.numbers.iter().zip(&self.elements).map(stress).collect()
    }
}

/// The number of the unknown of an edge at its end 0 or 1, along an axis.
pub fn unknown(edge: usize, end: usize, axis: usize) -> usize {
    4 * edge + 2 * end + axis
}
