//! Stresses in balance: the stress element of every simplex, coupled by displacements of the facets.
//!
//! The displacements of the facets are the unknowns. On each facet they are coefficients of functions that are dual to
//! a linear traction: each acts on one corner only. So a row of the balance contains the tractions at that corner, and
//! a contact row bounds one unknown.

use std::collections::HashMap;
use std::sync::Arc;

use super::integration::samples_on_facet;
use super::johnson_mercier::StressElement;
use super::mesh::{OuterFacet, SimplexMesh};
use super::part_stress::PartStress;
use super::problem::{ContinuumProblem, Medium};
use super::simplex::{MOST_CORNERS, Point};
use super::system::{Affine, Block, CellNumbers, Row, add_springs};
use crate::error::Error;
use signorini_fem::geometry::COORDINATES;
use signorini_fem::threads::each;
use signorini_qp as qp;

#[derive(Debug)]
pub struct Stresses<'a> {
    pub problem: &'a ContinuumProblem,
    pub mesh: &'a SimplexMesh,
    /// The unknowns of each simplex: of its sides, of their corners, along the axes.
    pub numbers: CellNumbers,
    /// The element of each simplex; congruent simplices have one together.
    elements: Vec<Arc<StressElement>>,
}

/// The place at which a contact row of the stress acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    pub on: OuterFacet,
    /// The number of its corner.
    pub corner: usize,
    pub obstacle: usize,
}

/// The edges of a simplex, its medium, and its place if its stress depends on that, bit by bit: congruent simplices
/// have the same.
type Congruence = ([[u64; 3]; MOST_CORNERS - 1], usize, Option<[u64; 3]>);

impl<'a> Stresses<'a> {
    pub fn new(problem: &'a ContinuumProblem, mesh: &'a SimplexMesh) -> Result<Self, Error> {
        let dimension = mesh.dimension;
        let of_facet = dimension * dimension;
        // The corners of a side have the order of the nodes of the facet: both increase.
        let of_side = |&facet: &usize| of_facet * facet..of_facet * (facet + 1);
        let numbers = (0..mesh.count()).flat_map(|cell| mesh.sides(cell).iter().flat_map(of_side)).collect();
        let numbers = CellNumbers { of_cell: (dimension + 1) * of_facet, numbers };
        let mut known: HashMap<Congruence, Arc<StressElement>> = HashMap::new();
        let element = |cell: usize| {
            let simplex = mesh.simplex(cell);
            let (origin, bits) = (mesh.origins[cell], |point: Point| point.map(f64::to_bits));
            let medium = problem.medium(origin);
            let depends = problem.is_axisymmetric || medium.own_stress.is_some();
            let place = depends.then(|| bits(simplex.corners()[0]));
            let congruence = (simplex.edges().map(bits), problem.medium_of[origin], place);
            if let Some(element) = known.get(&congruence) {
                return Some(element.clone());
            }
            let element = Arc::new(StressElement::new(problem, origin, &simplex)?);
            known.insert(congruence, element.clone());
            Some(element)
        };
        let elements: Option<Vec<_>> = (0..mesh.count()).map(element).collect();
        let reason = || "a simplex of the mesh is flat".to_string();
        let elements =
            elements.ok_or_else(|| qp::LinearError::Numerical { step: "the guaranteed bound", reason: reason() })?;
        Ok(Stresses { problem, mesh, numbers, elements })
    }

    pub fn place(&self, facet: usize, corner: usize) -> usize {
        facet * self.mesh.dimension + corner
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

    /// The places at the corners of a facet.
    pub fn on_facet(&self, outer: &OuterFacet) -> Vec<usize> {
        (0..self.mesh.dimension).map(|corner| self.place(outer.facet, corner)).collect()
    }

    /// The unknown displacements of facets: those on the axis of revolution are held.
    pub fn unknowns(&self) -> Affine {
        // On the axis a stress times its radius does no work.
        let corners = (0..self.mesh.facet_count()).flat_map(|facet| {
            let corners = self.mesh.corners_of_facet(facet).into_iter().enumerate();
            corners.map(move |(corner, at)| (self.place(facet, corner), at))
        });
        let on_axis = corners.filter(|&(_, at)| self.problem.is_on_axis(at));
        let held = on_axis.flat_map(|(place, _)| [0, 1].map(|axis| (place, COORDINATES[axis])));
        Affine::new(self.problem, self.mesh, &self.places(), held, |outer| self.on_facet(outer))
    }

    /// Number of places on all facets.
    pub fn place_count(&self) -> usize {
        self.place(self.mesh.facet_count(), 0)
    }

    /// The contact rows, one for each corner of a facet and obstacle, and their places. The gaps are upper bounds on
    /// the weighted means of the distance. A row that `may_touch` does not hold for, given its place and gap, is left
    /// out: there the stress has no pressure, which keeps it in balance.
    pub fn rows(&self, unknowns: &Affine, may_touch: impl Fn(&Place, f64) -> bool) -> (Vec<Row>, Vec<Place>) {
        let (mut rows, mut places) = (Vec::new(), Vec::new());
        for (on, obstacle) in self.problem.facing(self.mesh) {
            let facing = &self.problem.obstacles[obstacle];
            let gap = self.problem.gap(self.mesh, on.facet, obstacle);
            let Some(gap) = gap.filter(|gap| gap.above.is_finite()) else { continue };
            let corners = self.mesh.corners_of_facet(on.facet);
            // On an axis the pressure times the radius is zero.
            let means = gap.upper_means(self.mesh.dimension).into_iter().enumerate();
            for (corner, gap) in means.filter(|&(corner, _)| !self.problem.is_on_axis(corners[corner])) {
                let at = self.place(on.facet, corner);
                let place = Place { on, corner, obstacle };
                let other = self.opposite(&place).map(|(on, corner)| self.place(on.facet, corner));
                let travel = self.problem.travel(obstacle, self.place_count());
                let row = Row::new((at, other), self.mesh.dimension, facing.normal, travel, gap);
                if !unknowns.of_terms(&row.terms).0.is_empty() && may_touch(&place, gap) {
                    rows.push(row);
                    places.push(place);
                }
            }
        }
        (rows, places)
    }

    /// The facet of another body, and its corner, opposite to a place; `None` at a rigid obstacle.
    fn opposite(&self, place: &Place) -> Option<(OuterFacet, usize)> {
        let partner = self.mesh.partner(place.on.facet, place.obstacle)?;
        Some((partner.on, partner.corners[place.corner]))
    }

    pub fn with_elements(&self) -> impl Iterator<Item = (&[usize], &StressElement)> + '_ {
        self.numbers.iter().zip(&self.elements).map(|(numbers, element)| (numbers, &**element))
    }

    /// The stiffness of each simplex, with that of springs.
    pub fn blocks(&self) -> Vec<Block> {
        let mut blocks = each(self.mesh.count(), |cell| self.elements[cell].block());
        let dimension = self.mesh.dimension;
        for outer in self.on_springs() {
            let (normal, size) = self.mesh.simplex(outer.cell).outward(outer.local);
            let local: Vec<usize> = (0..dimension).map(|corner| dimension * outer.local + corner).collect();
            let mut share = self.corners_by_unknowns(&outer);
            share.iter_mut().flatten().for_each(|part| *part *= self.problem.share_of_corner(size));
            let springs = self.problem.springs(&outer);
            add_springs(&mut blocks[outer.cell], dimension, (&springs, normal), &local, &share);
        }
        blocks
    }

    /// The work of loads and of the stress without strain with the unknowns.
    pub fn load(&self) -> Vec<f64> {
        let mut load = vec![0.0; self.mesh.dimension * self.place_count()];
        let has_load = |medium: &Medium| medium.own_stress.is_some() || medium.body_force != [0.0; 3];
        if self.problem.media.iter().any(has_load) {
            for (numbers, element) in self.with_elements() {
                numbers.iter().zip(element.load()).for_each(|(&number, part)| load[number] += part);
            }
        }
        self.tractions().for_each(|(unknown, part)| load[unknown] += part);
        load.extend(self.problem.loads_of_motions());
        load
    }

    /// The work of the tractions on facets with the unknowns.
    fn tractions(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let (problem, mesh) = (self.problem, self.mesh);
        mesh.surface().flat_map(move |outer| {
            let (normal, size) = mesh.simplex(outer.cell).outward(outer.local);
            let share = problem.share_of_corner(size);
            let corners = mesh.corners_of_facet(outer.facet).into_iter().enumerate();
            corners.flat_map(move |(corner, at)| {
                self.at_corner(&outer, corner, problem.pull(outer.condition, normal, at), share)
            })
        })
    }

    /// The unknowns of a corner of a facet with a share of a vector.
    fn at_corner(
        &self,
        outer: &OuterFacet,
        corner: usize,
        vector: Point,
        share: f64,
    ) -> impl Iterator<Item = (usize, f64)> + use<> {
        let (dimension, place) = (self.mesh.dimension, self.place(outer.facet, corner));
        (0..dimension).map(move |axis| (dimension * place + axis, share * vector[axis]))
    }

    /// How the linear displacement of a facet on springs, times the radius about an axis, follows at each corner from
    /// the unknowns there: its products with linear tractions are theirs.
    fn corners_by_unknowns(&self, outer: &OuterFacet) -> Vec<Vec<f64>> {
        let (dimension, corners) = (self.mesh.dimension, self.mesh.corners_of_facet(outer.facet));
        let share = self.problem.share_of_corner(self.mesh.simplex(outer.cell).outward(outer.local).1);
        if !self.problem.is_axisymmetric {
            // The functions that are dual to the barycentric coordinates l are (dimension + 1) l - 1.
            let entry = |i: usize, j: usize| if i == j { dimension as f64 } else { -1.0 };
            return (0..dimension).map(|i| (0..dimension).map(|j| entry(i, j)).collect()).collect();
        }
        // The integrals of products of coordinates over the radius; on the axis itself a stress times the radius is
        // zero.
        let is_free: Vec<bool> = corners.iter().map(|&corner| !self.problem.is_on_axis(corner)).collect();
        let mut products = [[0.0; 2]; 2];
        for at in samples_on_facet(self.problem, &corners) {
            let weight = (at.weight + at.extra) / at.place[0].powi(2);
            for (i, line) in products.iter_mut().enumerate() {
                line.iter_mut().zip(at.weights).for_each(|(sum, other)| *sum += weight * at.weights[i] * other);
            }
        }
        let [[one, both], [_, other]] = products;
        let inverse = match is_free[..] {
            [true, true] => {
                let determinant = one * other - both * both;
                [[other / determinant, -both / determinant], [-both / determinant, one / determinant]]
            }
            [true, false] => [[1.0 / one, 0.0], [0.0; 2]],
            [false, true] => [[0.0; 2], [0.0, 1.0 / other]],
            _ => [[0.0; 2]; 2],
        };
        inverse.map(|line| line.map(|part| share * part).to_vec()).to_vec()
    }

    /// The linear displacement of a facet on springs at its corners, times the radius about an axis, whose forces the
    /// springs have in balance.
    pub fn displacement_at_corners(&self, values: &[f64], outer: &OuterFacet) -> Vec<Point> {
        let dimension = self.mesh.dimension;
        let value = |place: usize, axis: usize| if axis < dimension { values[dimension * place + axis] } else { 0.0 };
        let own: Vec<Point> =
            self.on_facet(outer).iter().map(|&place| [0, 1, 2].map(|axis| value(place, axis))).collect();
        let along = |line: &[f64], axis: usize| line.iter().zip(&own).map(|(part, own)| part * own[axis]).sum();
        self.corners_by_unknowns(outer).iter().map(|line| [0, 1, 2].map(|axis| along(line, axis))).collect()
    }

    pub fn on_springs(&self) -> impl Iterator<Item = OuterFacet> + '_ {
        self.mesh.surface().filter(|outer| self.problem.springs(outer).is_there())
    }

    /// The forces along the unknowns from outside under displacements of the facets: of tractions, springs, and contact
    /// forces at places. What supports take is not among them.
    pub fn given_forces(&self, displacement: &[f64], places: &[Place], pulls: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; displacement.len()];
        let mut add = |(unknown, force): (usize, f64)| forces[unknown] += force;
        self.tractions().for_each(&mut add);
        for outer in self.on_springs() {
            let (normal, size) = self.mesh.simplex(outer.cell).outward(outer.local);
            for (corner, moved) in self.displacement_at_corners(displacement, &outer).into_iter().enumerate() {
                let resistance = self.problem.springs(&outer).resistance(normal, moved);
                self.at_corner(&outer, corner, resistance, -self.problem.share_of_corner(size)).for_each(&mut add);
            }
        }
        for (place, &pull) in places.iter().zip(pulls) {
            let normal = self.problem.obstacles[place.obstacle].normal;
            self.at_corner(&place.on, place.corner, normal, pull).for_each(&mut add);
            if let Some((other, corner)) = self.opposite(place) {
                self.at_corner(&other, corner, normal, -pull).for_each(&mut add);
            }
        }
        forces
    }

    /// The stress of each simplex under displacements of the facets.
    pub fn stresses(&self, displacement: &[f64]) -> Vec<PartStress> {
        let stress = |(numbers, element): (&[usize], &StressElement)| {
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
