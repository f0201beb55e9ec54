//! The guaranteed bound: an admissible displacement and a stress in balance enclose the exact answer.
//!
//! Let `v` be such a displacement of energy J(v), and `tau` such a stress of complementary energy -D(tau). Then
//!
//! ```text
//! 1/2 |u - v|^2  <=  J(v) - D(tau)  =  1/2 |eps(v) - C^-1 tau|^2  +  integral of (-p) (g - v_n)
//! ```
//!
//! for the exact displacement u, in the norms of energy; p is the pressure of tau on the obstacle, `p <= 0`. The bound
//! contains no unknown constant.
//!
//! A stress without strain is subtracted from tau in these energies, and does the opposite of its work with eps(v) as a
//! load. Springs on the surface are a part of the body: w is the displacement of a facet with which their forces are in
//! balance, and they add half of the work of their forces under `v - w` with it.

use super::balance::ForcePaths;
use super::displacement::{Displacements, values_of_functions};
use super::integration::{Sample, samples, samples_on_facet};
use super::mesh::SimplexMesh;
use super::part_stress::PartStress;
use super::problem::{ContinuumProblem, ElasticLaw, Foundation};
use super::simplex::{Point, Simplex, Tensor, Weights, corners_of_side, less, traction, work};
use super::stress::{Place, Stresses};
use super::system::{Affine, Row};
use crate::error::Error;
use signorini_fem::geometry::{dot, length, minus};
use signorini_fem::threads::each;
use signorini_qp as qp;
use signorini_qp::{ContactProblem, ContactSet, Prepared, Settings, Solution, solve};

/// The strain from the rounding of a displacement of one on a simplex of size one: some hundred units in the last
/// place.
const NOISE: f64 = 100.0 * f64::EPSILON;

/// A displacement and a stress that enclose the exact answer.
#[derive(Debug)]
pub struct Bracket<'a> {
    pub problem: &'a ContinuumProblem,
    pub mesh: &'a SimplexMesh,
    pub displacements: Displacements<'a>,
    pub stresses: Stresses<'a>,
    /// The displacement problem and the stress problem, each with its answer.
    pub primal: Half,
    /// Rows of the displacement that supports hold.
    pub held_rows: Vec<Row>,
    pub dual: Half,
    /// The places at which the rows of the stress act.
    pub places: Vec<Place>,
    pub settings: Settings,
    /// How forces are carried to the supports; `None` if these cannot carry every force.
    pub balance: Option<ForcePaths>,
    pub stress: Vec<PartStress>,
    /// The force of each row of the stress along its obstacle, `<= 0`.
    pub pulls: Vec<f64>,
    /// The contribution of each simplex to J - D.
    pub shares: Vec<f64>,
    /// The part of J - D from contact.
    pub contact_share: f64,
    /// The square of the energy norm of the displacement.
    pub energy: f64,
    /// By as much the polynomial for a power of a radius makes this square too large in J.
    pub rounded_up: f64,
    /// The largest relative defect found by the check of balance, signs and distances.
    pub defect: f64,
}

/// One of the two problems with its answer.
#[derive(Debug)]
pub struct Half {
    pub unknowns: Affine,
    pub rows: Vec<Row>,
    pub solution: Solution,
    /// The problem, prepared for other gaps and loads, if it serves for the pairs of the force.
    pub prepared: Option<Prepared>,
    /// The value of every unknown of this problem, free or prescribed.
    pub values: Vec<f64>,
    /// Seconds, including assembly.
    pub seconds: f64,
}

impl Half {
    pub(super) fn solved(
        unknowns: Affine,
        rows: Vec<Row>,
        problem: &ContactProblem,
        start: Option<ContactSet>,
        settings: &Settings,
    ) -> Result<Self, Error> {
        let is_later_mesh = start.is_some();
        let mut prepared = None;
        let from_start = start.map(|closed| {
            let own = prepared.insert(Prepared::for_gaps(problem, 1, settings)?.starting_from(closed));
            own.solve(problem.gap())
        });
        let solution = match from_start {
            Some(Ok(solution)) => solution,
            // If the start makes the solve fail, it is repeated without a start.
            Some(Err(_)) | None => match solve(problem, settings) {
                // The answer of the previous mesh is better than an interrupted one.
                Err(qp::Error::NotCertified { .. }) if is_later_mesh && settings.watch.is_over() => {
                    return Err(qp::Error::Interrupted.into());
                }
                // The check of the bracket judges both answers.
                Err(qp::Error::NotCertified { solution, .. }) => *solution,
                other => other?,
            },
        };
        let values = unknowns.expanded(&solution.displacement);
        Ok(Half { unknowns, rows, solution, prepared, values, seconds: 0.0 })
    }

    /// Moves values beyond the bounds of rows, as those of a penalty method, to the bounds: the displacement stays out
    /// of the obstacles.
    fn keep_out(&mut self) {
        for row in self.rows.iter().filter(|row| row.value(&self.values) > row.gap).cloned().collect::<Vec<_>>() {
            self.unknowns.move_to(&mut self.values, &row, row.gap);
        }
    }
}

impl<'a> Bracket<'a> {
    /// Solves both problems on a mesh, and checks their properties. Both start from the given touching nodes.
    pub fn new(
        problem: &'a ContinuumProblem,
        mesh: &'a SimplexMesh,
        touching: Option<&[bool]>,
        settings: &Settings,
    ) -> Result<Self, Error> {
        let clock = std::time::Instant::now();
        let stresses = Stresses::new(problem, mesh)?;
        let of_stress = stresses.unknowns();
        let balance = ForcePaths::of(&stresses, &of_stress);
        // Without a balance, a stress needs a linear solve with a settled contact set.
        let settings = &if balance.is_some() { settings.clone() } else { settings.clone().exactly() };
        let displacements = Displacements::new(problem, mesh);
        let unknowns = displacements.unknowns();
        let [rows, held_rows] = displacements.rows(&unknowns)?;
        let posed = unknowns.problem(
            mesh.dimension,
            &displacements.numbers,
            &displacements.blocks(),
            &displacements.load(),
            &rows,
            &displacements.places(),
        )?;
        let start = touching.map(|nodes| {
            let (count, edges) = (mesh.nodes.len(), &mesh.edges);
            ContactSet::from_fn(rows.len(), |row| match rows[row].place(mesh.dimension) {
                node if node < count => nodes[node],
                edge => edges[edge - count].iter().all(|&end| nodes[end]),
            })
        });
        let mut primal = Half::solved(unknowns, rows, &posed, start, settings)?;
        // Without a balance a pair needs its rows held exactly; in the plane its factor costs little, and the memory
        // counts.
        let serves = balance.is_some() && mesh.dimension == 3;
        primal.prepared.take_if(|_| !serves);
        primal.keep_out();
        primal.seconds = clock.elapsed().as_secs_f64();
        let largest = displacements.largest(&primal.values);
        let (rows, places) = stresses.rows(&of_stress, |place, gap| {
            // What presses must touch, however far it is from a coarse facet.
            problem.obstacles[place.obstacle].pressed.is_some()
                || gap - displacements.mean_towards(&primal.values, place) <= largest
        });
        let posed = of_stress.problem(
            mesh.dimension,
            &stresses.numbers,
            &stresses.blocks(),
            &stresses.load(),
            &rows,
            &stresses.places(),
        )?;
        let start = touching.map(|nodes| ContactSet::from_fn(rows.len(), |row| nodes[places[row].node(mesh)]));
        let mut dual = Half::solved(of_stress, rows, &posed, start, settings)?;
        dual.prepared.take_if(|_| !serves);
        let pulls: Vec<f64> = dual.solution.multiplier.iter().map(|force| force.min(0.0)).collect();
        let balanced = balance
            .as_ref()
            .and_then(|balance| balance.stress(&stresses, (&dual.unknowns, &dual.values), &places, &pulls));
        let stress = balanced.unwrap_or_else(|| stresses.stresses(&dual.values));
        dual.seconds = clock.elapsed().as_secs_f64() - primal.seconds;
        let mut bracket = Bracket {
            problem,
            mesh,
            displacements,
            stresses,
            primal,
            held_rows,
            dual,
            places,
            settings: settings.clone(),
            balance,
            stress,
            pulls,
            shares: Vec::new(),
            contact_share: 0.0,
            energy: 0.0,
            rounded_up: 0.0,
            defect: 0.0,
        };
        bracket.measure();
        // An interrupted solve may leave too little for a bound.
        let judge = |error| if settings.watch.is_over() { qp::Error::Interrupted.into() } else { error };
        bracket.defect = bracket.check().map_err(judge)?;
        Ok(bracket)
    }

    /// The nodes that the displacement presses against an obstacle.
    pub fn touching(&self) -> Vec<bool> {
        let mut nodes = vec![false; self.mesh.nodes.len()];
        for (index, row) in self.primal.rows.iter().enumerate() {
            if let Some(node) = nodes.get_mut(row.place(self.mesh.dimension)) {
                *node |= self.primal.solution.contact_set.contains(index);
            }
        }
        nodes
    }

    pub fn volume(&self, cell: usize) -> f64 {
        let simplex = self.mesh.simplex(cell);
        self.problem.thickness * simplex.size() * self.problem.radius(simplex.centre())
    }

    /// The strain of a displacement at a point of part k of a simplex, given by the weights of the part's corners.
    pub fn strain(&self, coefficients: &[f64], cell: usize, k: usize, weights: Weights) -> Tensor {
        self.displacements.strain(coefficients, cell, self.mesh.simplex(cell).in_whole(k, weights))
    }

    pub fn law(&self, cell: usize) -> ElasticLaw<'_> {
        self.problem.law(self.mesh.origins[cell])
    }

    /// The stress in balance less that without strain, at a point of part k of a simplex, given by the weights of the
    /// part's corners.
    pub fn elastic_stress(&self, cell: usize, k: usize, weights: Weights) -> Tensor {
        let (stress, medium) =
            (self.stress_of(&self.stress, cell, k, weights), self.problem.medium(self.mesh.origins[cell]));
        match medium.own_stress {
            Some(_) => less(stress, medium.own_stress(self.mesh.simplex(cell).part(k).at(weights))),
            None => stress,
        }
    }

    pub fn stress_of(&self, stress: &[PartStress], cell: usize, k: usize, weights: Weights) -> Tensor {
        let value = stress[cell].at(k, weights);
        if !self.problem.is_axisymmetric {
            return value;
        }
        let radius = self.mesh.simplex(cell).part(k).at(weights)[0];
        value.map(|part| part / radius)
    }

    /// The points of integration on a part of a simplex, at which squares of linear functions are exact.
    pub fn rule(&self) -> impl Fn(&Simplex) -> Vec<Sample> + '_ {
        |part| samples(self.problem, part)
    }

    /// The sums over points on the parts of a simplex.
    pub fn sums<const N: usize>(
        &self,
        cell: usize,
        rule: &impl Fn(&Simplex) -> Vec<Sample>,
        values: impl Fn(usize, &Sample) -> [f64; N],
    ) -> [f64; N] {
        let (simplex, mut sums) = (self.mesh.simplex(cell), [0.0; N]);
        for k in 0..=self.mesh.dimension {
            for at in rule(&simplex.part(k)) {
                sums.iter_mut().zip(values(k, &at)).for_each(|(sum, value)| *sum += value);
            }
        }
        sums
    }

    pub fn sum(&self, cell: usize, value: impl Fn(usize, &Sample) -> f64) -> f64 {
        self.sums(cell, &self.rule(), |k, at| [value(k, at)])[0]
    }

    /// The same of the difference of a strain and that of an elastic stress.
    pub fn square_of_rest(&self, cell: usize, at: &Sample, strain: Tensor, stress: Tensor) -> f64 {
        let law = self.law(cell);
        let of_stress = law.compliance(stress);
        let square = at.weight * law.square(less(strain, of_stress));
        square + self.by_polynomial(cell, at, strain, stress)
    }

    /// The sum of the squares of a strain and of an elastic stress, as far as the polynomial for a power of a radius
    /// makes them too large.
    pub fn by_polynomial(&self, cell: usize, at: &Sample, strain: Tensor, stress: Tensor) -> f64 {
        if at.extra == 0.0 {
            return 0.0;
        }
        let law = self.law(cell);
        at.extra * (law.over_radius(strain, strain) + work(stress, law.compliance(stress)))
    }

    /// Computes energy, shares and the share of contact.
    pub(super) fn measure(&mut self) {
        let values = &self.primal.values;
        // Half the square of the misfit, the energy, and what a polynomial adds to it.
        let of_cell = |cell: usize| {
            self.sums(cell, &self.rule(), |k, at| {
                let strain = self.strain(values, cell, k, at.weights);
                let misfit = self.square_of_rest(cell, at, strain, self.elastic_stress(cell, k, at.weights));
                let energy = at.weight * self.law(cell).square(strain);
                [misfit / 2.0, energy, self.by_polynomial(cell, at, strain, [0.0; 6])]
            })
        };
        let of_cells = each(self.mesh.count(), of_cell);
        let mut shares: Vec<f64> = of_cells.iter().map(|cell| cell[0]).collect();
        let [mut energy, rounded_up] = [1, 2].map(|part| of_cells.iter().map(|cell| cell[part]).sum::<f64>());
        for on in self.on_springs(values, &self.dual.values) {
            shares[on.cell] += on.square_of_rest() / 2.0;
            energy += on.at.weight * on.product(on.moved, on.moved);
        }
        let mut contact_share = 0.0;
        for (index, place) in self.places.iter().enumerate() {
            let moved = self.displacements.mean_towards(&self.primal.values, place);
            let share = -self.pulls[index] * (self.dual.rows[index].gap - moved);
            shares[place.on.cell] += share;
            contact_share += share;
        }
        (self.shares, self.contact_share) = (shares, contact_share);
        (self.energy, self.rounded_up) = (energy, rounded_up);
    }

    /// The points of all facets on springs, under a displacement and under the stress of these unknowns.
    pub fn on_springs<'b>(
        &'b self,
        displacement: &'b [f64],
        of_stress: &'b [f64],
    ) -> impl Iterator<Item = OnSprings> + 'b {
        let (problem, dimension) = (self.problem, self.mesh.dimension);
        self.stresses.on_springs().flat_map(move |outer| {
            let (normal, _) = self.mesh.simplex(outer.cell).outward(outer.local);
            let functions = self.displacements.on_facet(&outer);
            let of_corners = self.stresses.displacement_at_corners(of_stress, &outer);
            let samples = samples_on_facet(problem, &self.mesh.corners_of_facet(outer.facet));
            samples.into_iter().map(move |at| {
                let (mut moved, mut balanced) = ([0.0; 3], [0.0; 3]);
                for (function, value) in functions.iter().zip(values_of_functions(dimension - 1, at.weights)) {
                    (0..dimension).for_each(|axis| moved[axis] += value * displacement[dimension * function + axis]);
                }
                for (corner, weight) in of_corners.iter().zip(at.weights) {
                    (0..3).for_each(|axis| balanced[axis] += weight * corner[axis] / problem.radius(at.place));
                }
                OnSprings { at, cell: outer.cell, moved, balanced, springs: problem.springs(&outer), normal }
            })
        })
    }

    /// J - D, half the square of the bound, in force times length.
    pub fn distance(&self) -> f64 {
        self.shares.iter().sum()
    }

    /// Returns `true` if the energies of displacement and stress are at most those of the rounding of the displacement,
    /// on every simplex.
    pub fn is_at_rest(&self) -> bool {
        let largest = self.displacements.largest(&self.primal.values);
        // The strain on a simplex is the noise over its smallest height.
        let of_cell = |cell: usize| self.volume(cell) * steepest(&self.mesh.simplex(cell)).powi(2);
        let rounding =
            (0..self.mesh.count()).map(of_cell).sum::<f64>() * self.problem.stiffest() * (NOISE * largest).powi(2);
        self.energy.max(self.distance()) <= rounding
    }

    /// The bound on |u - v| / |v|; zero for a body at rest, infinite if only v is at rest.
    pub fn bound(&self) -> f64 {
        self.relative(2.0 * self.distance())
    }

    /// The root of a square of the energy norm over |v|; not below the defect, because a bound does not include that
    /// rounding.
    fn relative(&self, square: f64) -> f64 {
        if self.is_at_rest() { 0.0 } else { (square.max(0.0) / self.energy).sqrt().max(self.defect) }
    }

    /// The square of the radius of the ball in the energy norm, about the mean of both stresses, in which the exact
    /// stress lies.
    pub fn square_of_radius(&self) -> f64 {
        self.distance() - (self.distance() - self.contact_share) / 2.0
    }

    /// The bound on the error of the mean stress, relative to |v|.
    pub fn bound_of_mean(&self) -> f64 {
        self.relative(self.square_of_radius())
    }

    /// J(v).
    pub fn energy_of_displacement(&self) -> f64 {
        (self.energy + self.rounded_up) / 2.0 - self.work_of_loads()
    }

    /// D(tau).
    pub fn energy_of_stress(&self) -> f64 {
        let of_cell = |cell: usize| {
            self.sum(cell, |k, at| self.square_of_rest(cell, at, [0.0; 6], self.elastic_stress(cell, k, at.weights)))
        };
        let mut stored = each(self.mesh.count(), of_cell).iter().sum::<f64>();
        let springs = self.on_springs(&self.primal.values, &self.dual.values);
        stored += springs.map(|on| (on.at.weight + on.at.extra) * on.product(on.balanced, on.balanced)).sum::<f64>();
        self.work_on_supports() + self.work_on_obstacles() - stored / 2.0
    }

    pub(super) fn work_of_loads(&self) -> f64 {
        let load = self.displacements.load();
        self.primal.values.iter().zip(&load).map(|(value, load)| value * load).sum()
    }

    /// The work of the pressures of the stress over the distances to the obstacles.
    pub(super) fn work_on_obstacles(&self) -> f64 {
        self.dual.rows.iter().zip(&self.pulls).map(|(row, pull)| pull * row.gap).sum()
    }

    /// The work of what supports take with the prescribed displacements.
    pub fn work_on_supports(&self) -> f64 {
        let given = self.stresses.given_forces(&self.dual.values, &self.places, &self.pulls);
        self.work_of_reactions(&self.stress, &given)
    }

    /// The work of the forces of a stress on facets that are not given with the prescribed displacements.
    pub(super) fn work_of_reactions(&self, stress: &[PartStress], given: &[f64]) -> f64 {
        let [forces, _] = self.forces_on_facets(stress);
        let reactions = forces.iter().zip(given).map(|(force, given)| force - given);
        reactions.zip(&self.dual.unknowns.prescribed).map(|(reaction, moved)| reaction * moved).sum()
    }

    /// The forces along the unknowns of the tractions of a stress on both sides of each facet: on the surface those
    /// from outside. And the share of the facet that each belongs to.
    pub(super) fn forces_on_facets(&self, stress: &[PartStress]) -> [Vec<f64>; 2] {
        let dimension = self.mesh.dimension;
        let mut forces = vec![0.0; self.dual.unknowns.count()];
        let mut shares = forces.clone();
        for (cell, stress) in stress.iter().enumerate() {
            let simplex = self.mesh.simplex(cell);
            for (local, &facet) in self.mesh.sides(cell).iter().enumerate() {
                let (normal, size) = simplex.outward(local);
                let share = self.problem.share_of_corner(size);
                for (corner, of_corner) in corners_of_side(dimension, local).enumerate() {
                    let first = dimension * self.stresses.place(facet, corner);
                    let pull = traction(stress.corner(local, of_corner), normal);
                    for (axis, part) in pull.iter().enumerate().take(dimension) {
                        forces[first + axis] += share * part;
                        shares[first + axis] = share;
                    }
                }
            }
        }
        [forces, shares]
    }
}

/// A point of a facet on springs under a displacement and a stress: a part of the body without volume, whose strain is
/// the displacement of the facet.
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

/// One over the smallest height of a simplex.
pub(super) fn steepest(simplex: &Simplex) -> f64 {
    simplex.slopes().into_iter().map(length).fold(0.0, f64::max)
}
