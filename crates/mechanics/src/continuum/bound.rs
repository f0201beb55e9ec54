//! The guaranteed bound: an admissible displacement and a stress in balance enclose the exact answer.
//!
//! Let `v` be such a displacement of energy J(v), and `tau` such a stress of complementary energy -D(tau). Then
//!
//! ```text
//! 1/2 |u - v|^2  <=  J(v) - D(tau)  =  1/2 |eps(v) - C^-1 tau|^2  +  integral of (-p) (g - v_n)
//! ```
//!
//! for the exact displacement u, in the norms of energy; p is the pressure of tau on the obstacle, `p <= 0`. The bound contains no
//! unknown constant.

use super::displacement::Displacements;
use super::johnson_mercier::{PartStress, at, mean_over_parts, traction};
use super::problem::{PlaneProblem, Tensor, work};
use super::stress::{Place, Stresses};
use super::system::{Row, Unknowns};
use super::triangulation::{Point, Triangulation, outward, twice_area};
use crate::error::Error;
use crate::fem::geometry::minus;
use crate::fem::material::Lame;
use signorini_qp as qp;
use signorini_qp::{ContactProblem, ContactSet, Prepared, Settings, Solution, solve};

/// The strain from the rounding of a displacement of one on a triangle of size one: some hundred units in the last place.
const NOISE: f64 = 100.0 * f64::EPSILON;

/// A displacement and a stress that enclose the exact answer.
#[derive(Debug)]
pub struct Bracket<'a> {
    pub problem: &'a PlaneProblem,
    pub mesh: &'a Triangulation,
    pub displacements: Displacements<'a>,
    pub stresses: Stresses<'a>,
    /// The displacement problem and the stress problem, each with its answer.
    pub primal: Side,
    pub dual: Side,
    /// The places at which the rows of the stress act.
    pub places: Vec<Place>,
    /// The stress on each triangle.
    pub stress: Vec<PartStress>,
    /// The contribution of each triangle to J - D.
    pub shares: Vec<f64>,
    /// The part of J - D from contact.
    pub contact_share: f64,
    /// The square of the energy norm of the displacement.
    pub energy: f64,
    /// The largest relative defect found by the check of balance, signs and distances.
    pub defect: f64,
}

/// One of the two problems with its answer.
#[derive(Debug)]
pub struct Side {
    pub unknowns: Unknowns,
    pub rows: Vec<Row>,
    pub solution: Solution,
    /// The values of all unknowns.
    pub values: Vec<f64>,
    /// Seconds, including assembly.
    pub seconds: f64,
}

impl Side {
    pub(super) fn solved(
        unknowns: Unknowns,
        rows: Vec<Row>,
        problem: &ContactProblem,
        start: Option<ContactSet>,
        settings: &Settings,
    ) -> Result<Self, Error> {
        let is_later_mesh = start.is_some();
        let from_start = start.map(|closed| {
            let prepared = Prepared::for_gaps(problem, 1, settings)?.starting_from(closed);
            prepared.solve(problem.gap())
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
        Ok(Side { unknowns, rows, solution, values, seconds: 0.0 })
    }
}

impl<'a> Bracket<'a> {
    /// Solves both problems on a mesh, and checks their properties. Both start from the given touching nodes.
    ///
    /// # Errors
    /// Those of [`solve`]; [`qp::Error::Interrupted`] if no time is left for a bound; [`qp::Error::Numerical`] if the check finds a defect beyond rounding: then there is no guarantee.
    pub fn new(
        problem: &'a PlaneProblem,
        mesh: &'a Triangulation,
        touching: Option<&[bool]>,
        settings: &Settings,
    ) -> Result<Self, Error> {
        let clock = std::time::Instant::now();
        let displacements = Displacements::new(problem, mesh);
        let unknowns = displacements.unknowns();
        let rows = displacements.rows(&unknowns)?;
        let posed = unknowns.problem(displacements.blocks(), &displacements.load(), &rows)?;
        let start = touching.map(|nodes| {
            let (count, edges) = (mesh.nodes.len(), &mesh.edges);
            ContactSet::from_fn(rows.len(), |row| match rows[row].unknown / 2 {
                node if node < count => nodes[node],
                edge => edges[edge - count].iter().all(|&end| nodes[end]),
            })
        });
        let mut primal = Side::solved(unknowns, rows, &posed, start, settings)?;
        primal.seconds = clock.elapsed().as_secs_f64();
        let stresses = Stresses::new(problem, mesh);
        let unknowns = stresses.unknowns();
        let (rows, places) = stresses.rows(&unknowns);
        let posed = unknowns.problem(stresses.blocks(), &stresses.load(), &rows)?;
        let start = touching
            .map(|nodes| ContactSet::from_fn(rows.len(), |row| nodes[mesh.edges[places[row].edge][places[row].end]]));
        let mut dual = Side::solved(unknowns, rows, &posed, start, settings)?;
        let stress = stresses.stresses(&dual.values);
        dual.seconds = clock.elapsed().as_secs_f64() - primal.seconds;
        let mut bracket = Bracket {
            problem,
            mesh,
            displacements,
            stresses,
            primal,
            dual,
            places,
            stress,
            shares: Vec::new(),
            contact_share: 0.0,
            energy: 0.0,
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
            if let Some(node) = nodes.get_mut(row.unknown / 2) {
                *node |= self.primal.solution.contact_set.contains(index);
            }
        }
        nodes
    }

    /// Volume of a triangle.
    pub fn volume(&self, triangle: usize) -> f64 {
        self.problem.thickness * twice_area(self.mesh.corners(triangle)) / 2.0
    }

    /// The strain of a displacement at a point of part k of a triangle, given by the weights of the part's corners.
    pub fn strain(&self, coefficients: &[f64], triangle: usize, k: usize, weights: [f64; 3]) -> Tensor {
        let mut place = [weights[0] / 3.0; 3];
        place[(k + 1) % 3] += weights[1];
        place[(k + 2) % 3] += weights[2];
        self.displacements.strain(coefficients, triangle, place)
    }

    /// The integral over a triangle of a function of the strain of the displacement and the stress.
    pub fn integral(&self, triangle: usize, product: impl Fn(Tensor, Tensor) -> f64) -> f64 {
        let mean = mean_over_parts(|k, weights| {
            let strain = self.strain(&self.primal.values, triangle, k, weights);
            product(strain, at(&self.stress[triangle], k, weights))
        });
        self.volume(triangle) * mean
    }

    /// Computes energy, shares and the share of contact.
    pub(super) fn measure(&mut self) {
        let size = |strain: Tensor| work(self.problem.stress(strain), strain);
        let triangles = 0..self.mesh.triangles.len();
        let misfit = |strain: Tensor, stress: Tensor| size(minus(strain, self.problem.compliance(stress))) / 2.0;
        let mut shares: Vec<f64> = triangles.clone().map(|triangle| self.integral(triangle, misfit)).collect();
        let energy = triangles.map(|triangle| self.integral(triangle, |strain, _| size(strain))).sum();
        let mut contact_share = 0.0;
        let mut owner = vec![0; self.mesh.edges.len()];
        self.mesh.outline().for_each(|(triangle, _, edge, _)| owner[edge] = triangle);
        for (index, place) in self.places.iter().enumerate() {
            let share = -self.pull(index) * (self.dual.rows[index].gap - self.approached(place));
            shares[owner[place.edge]] += share;
            contact_share += share;
        }
        (self.shares, self.energy, self.contact_share) = (shares, energy, contact_share);
    }

    /// The force of a row of the stress along the obstacle, `<= 0`.
    pub fn pull(&self, row: usize) -> f64 {
        self.dual.solution.multiplier[row].min(0.0)
    }

    /// The weighted mean of the displacement of an edge towards an obstacle, as in a row of the stress.
    fn approached(&self, place: &Place) -> f64 {
        let facing = &self.problem.obstacles[place.obstacle];
        self.mean_on(&self.primal.values, place, facing.axis) * facing.sense
    }

    /// The mean of a displacement along an axis on an edge, with the weight of one end.
    pub fn mean_on(&self, coefficients: &[f64], place: &Place, axis: usize) -> f64 {
        let mut on_edge = self.displacements.on_edge(place.edge, axis).map(|function| coefficients[function]);
        if place.end == 1 {
            on_edge.reverse();
        }
        on_edge[0] / 2.0 + on_edge[1] / 3.0 + on_edge[2] / 6.0
    }

    /// J - D, half the square of the bound, in force times length.
    pub fn distance(&self) -> f64 {
        self.shares.iter().sum()
    }

    /// Returns `true` if the energies of displacement and stress are at most those of the rounding of the displacement, on every
    /// triangle.
    pub fn is_at_rest(&self) -> bool {
        let largest = self.primal.values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let Lame { lambda, mu } = self.problem.lame;
        // The strain on a triangle is the noise over its size, its energy is the square of that times the area: the size cancels.
        let of_triangle = (lambda + 2.0 * mu) * self.problem.thickness * (NOISE * largest).powi(2);
        self.energy.max(self.distance()) <= of_triangle * self.mesh.triangles.len() as f64
    }

    /// The bound on |u - v| / |v|; zero for a body at rest, infinite if only v is at rest.
    pub fn bound(&self) -> f64 {
        self.relative(2.0 * self.distance())
    }

    /// The root of a square of the energy norm over |v|; not below the defect, because a bound does not include that rounding.
    fn relative(&self, square: f64) -> f64 {
        if self.is_at_rest() { 0.0 } else { (square.max(0.0) / self.energy).sqrt().max(self.defect) }
    }

    /// The square of the radius of the ball in the energy norm, about the mean of both stresses, in which the exact stress lies.
    pub fn square_of_radius(&self) -> f64 {
        self.distance() - (self.distance() - self.contact_share) / 2.0
    }

    /// The bound on the error of the mean stress, relative to |v|.
    pub fn bound_of_mean(&self) -> f64 {
        self.relative(self.square_of_radius())
    }

    /// J(v).
    pub fn energy_of_displacement(&self) -> f64 {
        self.energy / 2.0 - self.work_of_loads()
    }

    /// D(tau).
    pub fn energy_of_stress(&self) -> f64 {
        let triangles = 0..self.mesh.triangles.len();
        let stored: f64 = triangles
            .map(|triangle| self.integral(triangle, |_, stress| work(stress, self.problem.compliance(stress))))
            .sum();
        self.work_on_supports(&self.stress) + self.work_on_obstacles() - stored / 2.0
    }

    /// The work of the loads with the displacement.
    pub(super) fn work_of_loads(&self) -> f64 {
        let load = self.displacements.load();
        self.primal.values.iter().zip(&load).map(|(value, load)| value * load).sum()
    }

    /// The work of the pressures of the stress over the distances to the obstacles.
    pub(super) fn work_on_obstacles(&self) -> f64 {
        self.dual.rows.iter().enumerate().map(|(row, of_row)| self.pull(row) * of_row.gap).sum()
    }

    /// The work of the tractions of a stress with the prescribed displacements.
    pub fn work_on_supports(&self, stress: &[PartStress]) -> f64 {
        let at_ends = self.jumps(stress);
        let mut sum = 0.0;
        for (_, _, edge, condition) in self.mesh.outline() {
            let held = self.problem.conditions[condition].held.map(Option::unwrap_or_default);
            for pull in at_ends[edge] {
                sum += self.stresses.half_area(edge) * (pull[0] * held[0] + pull[1] * held[1]);
            }
        }
        sum
    }

    /// The sum of the tractions of a stress on both sides of each edge, at both of its ends: on the outline the traction itself.
    pub(super) fn jumps(&self, stress: &[PartStress]) -> Vec<[Point; 2]> {
        let mut jumps = vec![[[0.0; 2]; 2]; self.mesh.edges.len()];
        for (triangle, sides) in self.mesh.sides.iter().enumerate() {
            for (local, &edge) in sides.iter().enumerate() {
                let (normal, _) = outward(self.mesh.corners(triangle), local);
                for next in 1..3 {
                    let pull = traction(stress[triangle][local][next], normal);
                    let sum = &mut jumps[edge][self.mesh.end_at(triangle, local, next)];
                    (0..2).for_each(|axis| sum[axis] += pull[axis]);
                }
            }
        }
        jumps
    }
}
