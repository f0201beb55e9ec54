//! Stresses in exact balance from facet displacements that nearly solve the stress problem.
//!
//! The tractions on both sides of a facet are replaced by their mean, those on the surface by the loads and the given
//! contact forces. What each simplex then lacks in force and moment is carried along a tree of simplices to its root,
//! and there the supports take it. Tractions that balance a simplex determine its stress.

use std::collections::BTreeMap;

use super::johnson_mercier::StressElement;
use super::mesh::{OuterFacet, SimplexMesh};
use super::normal::{Lower, add};
use super::part_stress::PartStress;
use super::simplex::Point;
use super::stress::{Place, Stresses};
use super::system::Affine;
use signorini_fem::geometry::{COORDINATES, minus};
use signorini_qp::dot;

/// Rounds of balancing: the later ones take the rounding of the first.
const ROUNDS: usize = 2;

/// The facets through which forces are carried, simplex by simplex from the roots on.
#[derive(Debug)]
struct CellTree {
    /// The one or two simplices at each facet of the mesh, one entry per facet.
    cells_at: Vec<[Option<usize>; 2]>,
    /// The simplices, each after the one towards its root.
    order: Vec<usize>,
    /// The facet of each simplex towards its root; `None` for a root.
    towards_root: Vec<Option<usize>>,
    roots: Vec<usize>,
}

impl CellTree {
    fn of(mesh: &SimplexMesh) -> Self {
        let cells_at = mesh.cells_at();
        let (mut order, mut towards_root) = (Vec::with_capacity(mesh.count()), vec![None; mesh.count()]);
        let mut roots = vec![usize::MAX; mesh.count()];
        for root in 0..mesh.count() {
            if roots[root] != usize::MAX {
                continue;
            }
            roots[root] = root;
            let mut next = order.len();
            order.push(root);
            while let Some(&cell) = order.get(next) {
                next += 1;
                for &facet in mesh.sides(cell) {
                    let beyond = cells_at[facet].into_iter().flatten().find(|&other| roots[other] == usize::MAX);
                    if let Some(other) = beyond {
                        (roots[other], towards_root[other]) = (root, Some(facet));
                        order.push(other);
                    }
                }
            }
        }
        CellTree { cells_at, order, towards_root, roots }
    }

    /// Returns `true` for a facet between two simplices.
    fn is_inside(&self, facet: usize) -> bool {
        self.cells_at[facet][1].is_some()
    }

    /// 1 for the first simplex at a facet, -1 for the other one.
    fn sign(&self, cell: usize, facet: usize) -> f64 {
        if self.cells_at[facet][0] == Some(cell) { 1.0 } else { -1.0 }
    }
}

/// Forces of unknowns, and their resultants about a centre.
struct Levers<'a> {
    dimension: usize,
    places: &'a [Point],
    centre: Point,
    /// The unit of length.
    size: f64,
}

/// Force and moment: the components that the dimension has, then zeros.
type Resultant = [f64; 6];

impl Levers<'_> {
    fn at(&self, place: usize, force: Point) -> Resultant {
        let ([x, y, z], [along_x, along_y, along_z]) =
            (minus(self.places[place], self.centre).map(|part| part / self.size), force);
        let about_z = x * along_y - y * along_x;
        match self.dimension {
            2 => [along_x, along_y, about_z, 0.0, 0.0, 0.0],
            _ => [along_x, along_y, along_z, about_z, y * along_z - z * along_y, z * along_x - x * along_z],
        }
    }

    /// The force and the moment of a force of one along an unknown.
    fn of(&self, unknown: usize) -> Resultant {
        self.at(unknown / self.dimension, COORDINATES[unknown % self.dimension])
    }

    fn resultants(&self, forces: impl Iterator<Item = (usize, f64)>) -> Resultant {
        let mut sum = Resultant::default();
        forces.for_each(|(unknown, force)| add(&mut sum, force, &self.of(unknown)));
        sum
    }

    /// The smallest amounts of the forces with these levers that have these resultants; `None` if there are none.
    fn amounts(&self, levers: &[Resultant], resultants: &Resultant) -> Option<Vec<f64>> {
        let mut motion = *resultants;
        let count = if self.dimension == 2 { 3 } else { 6 };
        Lower::of_squares(count, levers)?.solve(&mut motion);
        Some(levers.iter().map(|lever| dot(lever, &motion)).collect())
    }
}

/// The levers of forces of one at places along axes.
fn levers(about: &Levers, held: &[(usize, Point)]) -> Vec<Resultant> {
    held.iter().map(|&(place, axis)| about.at(place, axis)).collect()
}

/// How forces are carried to the supports of a mesh.
#[derive(Debug)]
pub struct ForcePaths {
    tree: CellTree,
    /// The places of the stress problem that supports hold, with the axes along which they do, by the root of their
    /// simplex.
    held: Vec<(usize, Vec<(usize, Point)>)>,
    places: Vec<Point>,
}

impl ForcePaths {
    /// `None` if the supports alone cannot carry every force and moment.
    pub fn of(stresses: &Stresses, unknowns: &Affine) -> Option<Self> {
        let (mesh, problem) = (stresses.mesh, stresses.problem);
        // What springs and rigid faces take, and where loads enter inside, follows from the solution.
        let is_plain =
            !problem.is_axisymmetric && problem.loads_of_motions().is_empty() && problem.rigid_faces.is_empty();
        let tree = CellTree::of(mesh);
        let acts_inside = |outer: OuterFacet| tree.is_inside(outer.facet) && problem.conditions[outer.condition].acts();
        if !is_plain || mesh.surface().any(acts_inside) || stresses.on_springs().next().is_some() {
            return None;
        }
        let mut held: BTreeMap<usize, Vec<(usize, Point)>> =
            tree.roots.iter().map(|&root| (root, Vec::new())).collect();
        for outer in mesh.surface() {
            let at_root = held.entry(tree.roots[outer.cell]).or_default();
            for place in stresses.on_facet(&outer) {
                at_root.extend(unknowns.supports.get(&place).into_iter().flatten().map(|&axis| (place, axis)));
            }
        }
        let balance = ForcePaths { tree, held: held.into_iter().collect(), places: stresses.places() };
        let carries = |(_, held): &(usize, Vec<_>)| {
            let of_body = balance.of_body(mesh);
            of_body.amounts(&levers(&of_body, held), &Resultant::default()).is_some()
        };
        balance.held.iter().all(carries).then_some(balance)
    }

    fn of_body(&self, mesh: &SimplexMesh) -> Levers<'_> {
        let volume: f64 = (0..mesh.count()).map(|cell| mesh.simplex(cell).size()).sum();
        Levers { size: volume.powf(1.0 / mesh.dimension as f64), ..self.of_cell(mesh, 0) }
    }

    fn of_cell(&self, mesh: &SimplexMesh, cell: usize) -> Levers<'_> {
        let (simplex, dimension) = (mesh.simplex(cell), mesh.dimension);
        let size = simplex.size().powf(1.0 / dimension as f64);
        Levers { dimension, places: &self.places, centre: simplex.centre(), size }
    }

    /// The stress of each simplex, in balance with the loads and with these forces at the places, near that of the
    /// displacements of the facets of an answer; `None` for a flat simplex.
    pub fn stress(
        &self,
        stresses: &Stresses,
        (unknowns, displacement): (&Affine, &[f64]),
        places: &[Place],
        pulls: &[f64],
    ) -> Option<Vec<PartStress>> {
        let (mesh, tree) = (stresses.mesh, &self.tree);
        let (dimension, of_facet) = (mesh.dimension, mesh.dimension * mesh.dimension);
        let sign = |cell: usize, unknown: usize| tree.sign(cell, unknown / of_facet);
        let elements: Vec<(&[usize], &StressElement)> = stresses.with_elements().collect();
        // The forces at the unknowns are those on the first simplex of their facet.
        let mut forces = vec![0.0; displacement.len()];
        for (cell, &(numbers, element)) in elements.iter().enumerate() {
            let own: Vec<f64> = numbers.iter().map(|&number| displacement[number]).collect();
            for (&number, work) in numbers.iter().zip(element.works(&own)) {
                let share = if tree.is_inside(number / of_facet) { 0.5 } else { 1.0 };
                forces[number] += share * sign(cell, number) * work;
            }
        }
        // On the surface only the part along supports is free.
        let given = stresses.given_forces(displacement, places, pulls);
        let outside = mesh.surface().filter(|outer| !tree.is_inside(outer.facet));
        for place in outside.flat_map(|outer| stresses.on_facet(&outer)) {
            let own = dimension * place..dimension * (place + 1);
            let rest: Vec<f64> = own.clone().map(|unknown| forces[unknown] - given[unknown]).collect();
            forces[own.clone()].copy_from_slice(&given[own.clone()]);
            for axis in unknowns.supports.get(&place).into_iter().flatten() {
                let taken = dot(&rest, &axis[..dimension]);
                own.clone().zip(axis).for_each(|(unknown, part)| forces[unknown] += taken * part);
            }
        }
        // What a simplex has too much.
        let too_much = |cell: usize, levers: &Levers, forces: &[f64]| {
            let of_unknown =
                |(&unknown, other): (&usize, &f64)| (unknown, sign(cell, unknown) * forces[unknown] - other);
            let (numbers, element) = elements[cell];
            levers.resultants(numbers.iter().zip(&element.particular_tractions).map(of_unknown))
        };
        for _ in 0..ROUNDS {
            let of_body = self.of_body(mesh);
            for (root, held) in &self.held {
                let mut sum = Resultant::default();
                let of_root = (0..mesh.count()).filter(|&cell| tree.roots[cell] == *root);
                of_root.for_each(|cell| add(&mut sum, 1.0, &too_much(cell, &of_body, &forces)));
                for (&(place, axis), taken) in held.iter().zip(of_body.amounts(&levers(&of_body, held), &sum)?) {
                    (0..dimension).for_each(|along| forces[dimension * place + along] -= taken * axis[along]);
                }
            }
            for &cell in tree.order.iter().rev() {
                let Some(facet) = tree.towards_root[cell] else { continue };
                let (levers, sign) = (self.of_cell(mesh, cell), tree.sign(cell, facet));
                let of_side: Vec<usize> = (of_facet * facet..of_facet * (facet + 1)).collect();
                let of_unknowns: Vec<Resultant> = of_side.iter().map(|&unknown| levers.of(unknown)).collect();
                let taken = levers.amounts(&of_unknowns, &too_much(cell, &levers, &forces))?;
                of_side.iter().zip(taken).for_each(|(&unknown, taken)| forces[unknown] -= sign * taken);
            }
        }
        let stress = |(cell, &(numbers, element)): (usize, &(&[usize], &StressElement))| {
            element.stress_with(&numbers.iter().map(|&number| sign(cell, number) * forces[number]).collect::<Vec<_>>())
        };
        elements.iter().enumerate().map(stress).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::bodies::{body, solved};
    use super::super::bound::Bracket;
    use super::super::problem::{ContinuumProblem, Held, Linear};
    use super::*;
    use signorini_qp::{Method, Penalty, Settings};

    /// Displacements that are disturbed by a part in a thousand, and pressures that are a tenth too small.
    #[test]
    fn a_disturbed_stress_is_out_of_balance_and_is_brought_back_with_a_weaker_bound() {
        for (problem, mesh) in [body(2), body(3)] {
            let mut bracket = solved(&problem, &mesh);
            let exact = bracket.distance();
            let largest = signorini_qp::largest(&bracket.dual.values);
            let disturbed: Vec<f64> = (bracket.dual.values.iter().enumerate())
                .map(|(unknown, value)| value + 1e-3 * largest * (unknown as f64).sin())
                .collect();
            bracket.pulls.iter_mut().for_each(|pull| *pull *= 0.9);
            bracket.stress = bracket.stresses.stresses(&disturbed);
            bracket.measure();
            assert!(bracket.check().unwrap_err().to_string().contains("out of balance"));
            bracket.dual.values = disturbed;
            let balance = bracket.balance.as_ref().unwrap();
            let answer = (&bracket.dual.unknowns, &bracket.dual.values[..]);
            bracket.stress = balance.stress(&bracket.stresses, answer, &bracket.places, &bracket.pulls).unwrap();
            bracket.measure();
            // The check compares J - D with the sum of the shares too.
            assert!(bracket.check().unwrap() < 1e-11);
            assert!(bracket.distance() > exact && bracket.distance() < 1e3 * exact, "{}", bracket.distance() / exact);
        }
    }

    /// The displacement of a penalty method goes into the obstacle, and its forces balance nothing exactly.
    #[test]
    fn the_answers_of_a_penalty_method_are_made_admissible() {
        for (problem, mesh) in [body(2), body(3)] {
            let exact = solved(&problem, &mesh).distance();
            let rough = Settings::with_method(Method::Penalty(Penalty { last: 1e3, ..Penalty::default() }));
            let bracket = Bracket::new(&problem, &mesh, None, &rough).unwrap();
            assert!(bracket.defect < 1e-11, "{}", bracket.defect);
            assert!((bracket.distance() / exact - 1.0).abs() < 0.01, "{} {exact}", bracket.distance());
        }
    }

    #[test]
    fn guides_along_all_axes_carry_every_force_and_a_roller_does_not() {
        for (mut problem, mesh) in [body(2), body(3)] {
            let held = |axis: usize| Held { direction: COORDINATES[axis], value: Linear::default() };
            let carries = |problem: &ContinuumProblem| {
                let stresses = Stresses::new(problem, &mesh).unwrap();
                ForcePaths::of(&stresses, &stresses.unknowns()).is_some()
            };
            problem.conditions[0].held = vec![held(problem.dimension - 1)];
            assert!(!carries(&problem));
            problem.conditions[1].held = vec![held(0)];
            if problem.dimension == 3 {
                assert!(!carries(&problem));
                problem.conditions[3].held = vec![held(1)];
            }
            let bracket = solved(&problem, &mesh);
            assert!(bracket.balance.is_some() && bracket.defect < 1e-10, "{}", bracket.defect);
        }
    }
}
