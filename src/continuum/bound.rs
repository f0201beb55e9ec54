//! The guaranteed bound: a displacement that keeps off the obstacles and a stress in balance hold the exact answer between them.
//!
//! With `v` such a displacement of energy J(v), and `tau` such a stress of complementary energy -D(tau),
//!
//! ```text
//! 1/2 |u - v|^2  <=  J(v) - D(tau)  =  1/2 |eps(v) - C^-1 tau|^2  +  integral of (-p) (g - v_n)
//! ```
//!
//! for the exact displacement u, in the norms of energy; p is the pressure of tau on the obstacle, `p <= 0`. No constant is in it.

use super::displacement::Displacements;
use super::johnson_mercier::{PartStress, at, mean_over_parts, part, traction};
use super::problem::{PlaneProblem, Tensor, work};
use super::stress::{Place, Stresses};
use super::system::{Row, Unknowns};
use super::triangulation::{Triangulation, outward, twice_area};
use crate::error::Error;
use crate::fem::material::Lame;
use crate::qp::problem::ContactProblem;
use crate::qp::{Settings, solve};
use crate::solution::Solution;

/// Rounding that a stress in balance and a displacement off the obstacles may show, relative to the largest stress and length: some
/// thousand times what is measured on meshes of 1e5 unknowns at a ratio of Poisson of 0.4999.
const ROUNDING: f64 = 1e-7;

/// Energies below this share of what a strain of one over the whole body would take, for its largest displacement, are rounding: the
/// body moves as a rigid one.
const REST: f64 = 1e-20;

/// Places along an edge at which a displacement is held against the obstacle: ends, middle, and between.
const SAMPLES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// A displacement and a stress that hold the exact answer between them.
#[derive(Debug)]
pub struct Bracket<'a> {
    pub problem: &'a PlaneProblem,
    pub mesh: &'a Triangulation,
    pub displacements: Displacements<'a>,
    pub stresses: Stresses<'a>,
    /// The side of the displacement, and that of the stress.
    pub primal: Side,
    pub dual: Side,
    /// Where the rows of the stress act.
    pub places: Vec<Place>,
    /// The stress on each triangle.
    pub stress: Vec<PartStress>,
    /// What each triangle adds to J - D.
    pub shares: Vec<f64>,
    /// The part of J - D that lies in contact.
    pub contact_share: f64,
    /// The square of the energy norm of the displacement.
    pub energy: f64,
    /// The largest relative defect that the check of balance, sign and distance found.
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
    /// What it took, in seconds, assembly included.
    pub seconds: f64,
}

impl Side {
    fn solved(
        unknowns: Unknowns,
        rows: Vec<Row>,
        problem: &ContactProblem,
        settings: &Settings,
    ) -> Result<Self, Error> {
        let solution = match solve(problem, settings) {
            // The check of the bracket judges both answers.
            Err(Error::NotCertified { solution, .. }) => *solution,
            other => other?,
        };
        let values = unknowns.expanded(&solution.displacement);
        Ok(Side { unknowns, rows, solution, values, seconds: 0.0 })
    }
}

impl<'a> Bracket<'a> {
    /// Solves both problems on a mesh, and checks what they promise.
    ///
    /// # Errors
    /// Those of [`solve`]; [`Error::Numerical`] if the check finds a defect beyond rounding: then nothing is guaranteed.
    pub fn new(problem: &'a PlaneProblem, mesh: &'a Triangulation, settings: &Settings) -> Result<Self, Error> {
        let clock = std::time::Instant::now();
        let displacements = Displacements::new(problem, mesh);
        let unknowns = displacements.unknowns();
        let rows = displacements.rows(&unknowns)?;
        let posed = unknowns.problem(displacements.blocks(), &displacements.load(), &rows)?;
        let mut primal = Side::solved(unknowns, rows, &posed, settings)?;
        primal.seconds = clock.elapsed().as_secs_f64();
        let stresses = Stresses::new(problem, mesh);
        let unknowns = stresses.unknowns();
        let (rows, places) = stresses.rows(&unknowns);
        let posed = unknowns.problem(stresses.blocks(), &stresses.load(), &rows)?;
        let mut dual = Side::solved(unknowns, rows, &posed, settings)?;
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
        bracket.defect = bracket.defects().into_iter().fold(0.0, |worst, (_, defect)| f64::max(worst, defect));
        bracket.check()?;
        Ok(bracket)
    }

    /// Volume of a triangle.
    pub fn volume(&self, triangle: usize) -> f64 {
        self.problem.thickness * twice_area(self.mesh.corners(triangle)) / 2.0
    }

    /// The strain of a displacement at weights of the corners of part k of a triangle.
    pub fn strain(&self, coefficients: &[f64], triangle: usize, k: usize, weights: [f64; 3]) -> Tensor {
        let mut place = [weights[0] / 3.0; 3];
        place[(k + 1) % 3] += weights[1];
        place[(k + 2) % 3] += weights[2];
        self.displacements.strain(coefficients, triangle, place)
    }

    /// The integral over a triangle of a product, by strain of the displacement and stress.
    pub fn integral(&self, triangle: usize, product: impl Fn(Tensor, Tensor) -> f64) -> f64 {
        let mean = mean_over_parts(|k, weights| {
            let strain = self.strain(&self.primal.values, triangle, k, weights);
            product(strain, at(&self.stress[triangle], k, weights))
        });
        self.volume(triangle) * mean
    }

    fn measure(&mut self) {
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

    /// The weighted mean of the displacement of an edge towards an obstacle, as a row of the stress feels it.
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

    /// Do displacement and stress take no more energy than rounding makes?
    fn is_at_rest(&self) -> bool {
        let largest = self.primal.values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let Lame { lambda, mu } = self.problem.lame;
        let rounding = REST * (lambda + 2.0 * mu) * self.problem.thickness * largest * largest;
        self.energy.max(self.distance()) <= rounding
    }

    /// The bound on |u - v| / |v|; zero for a body at rest, infinite for one at rest in v alone.
    pub fn bound(&self) -> f64 {
        self.relative(2.0 * self.distance())
    }

    /// The root of a square of the energy norm over |v|.
    fn relative(&self, square: f64) -> f64 {
        if square <= 0.0 || self.is_at_rest() { 0.0 } else { (square / self.energy).sqrt() }
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
        let load = self.displacements.load();
        self.energy / 2.0 - self.primal.values.iter().zip(&load).map(|(value, load)| value * load).sum::<f64>()
    }

    /// D(tau).
    pub fn energy_of_stress(&self) -> f64 {
        let triangles = 0..self.mesh.triangles.len();
        let stored: f64 = triangles
            .map(|triangle| self.integral(triangle, |_, stress| work(stress, self.problem.compliance(stress))))
            .sum();
        let contact: f64 = self.dual.rows.iter().enumerate().map(|(row, of_row)| self.pull(row) * of_row.gap).sum();
        self.work_on_supports(&self.stress) + contact - stored / 2.0
    }

    /// The work of the tractions of a stress with the prescribed displacements.
    pub fn work_on_supports(&self, stress: &[PartStress]) -> f64 {
        let mut sum = 0.0;
        for (triangle, local, edge, condition) in self.mesh.outline() {
            let (normal, _) = outward(self.mesh.corners(triangle), local);
            let held = self.problem.conditions[condition].held;
            for end in 0..2 {
                let pull = traction(stress[triangle][local][1 + end], normal);
                (0..2).for_each(|axis| {
                    sum += self.stresses.half_area(edge) * pull[axis] * held[axis].unwrap_or(0.0);
                });
            }
        }
        sum
    }

    /// Refuses what is not as it was promised.
    fn check(&self) -> Result<(), Error> {
        match self.defects().into_iter().find(|(_, defect)| defect.is_nan() || *defect > ROUNDING) {
            None => Ok(()),
            Some((what, defect)) => {
                let reason = format!(
                    "{what} by {defect:.1e}; at most {ROUNDING:.0e} is rounding, so that nothing is guaranteed"
                );
                Err(Error::Numerical { step: "the guaranteed bound", reason })
            }
        }
    }

    /// How far each promise is missed, relative, found from the stresses and displacements alone.
    fn defects(&self) -> [(&'static str, f64); 4] {
        // At rest all forces are rounding.
        let strained = |defect: fn(&Self) -> f64| if self.is_at_rest() { 0.0 } else { defect(self) };
        [
            ("the stress is out of balance", strained(Self::imbalance)),
            ("the obstacle pulls", strained(Self::adhesion)),
            ("the displacement goes into an obstacle", self.penetration()),
            ("J - D misses the sum of its parts", strained(Self::lost)),
        ]
    }

    /// The largest stress, in balance or of the displacement: the former is rounding where it touches nothing yet.
    fn largest_stress(&self) -> f64 {
        const CENTRE: [f64; 3] = [1.0 / 3.0; 3];
        let strain = |triangle: usize| self.displacements.strain(&self.primal.values, triangle, CENTRE);
        let of_displacement = (0..self.stress.len()).map(|triangle| self.problem.stress(strain(triangle)));
        let in_balance = self.stress.iter().flatten().flatten().copied();
        of_displacement.chain(in_balance).flatten().fold(0.0, |largest: f64, entry| largest.max(entry.abs()))
    }

    /// The largest jump of a traction between triangles, traction that is not the load, and divergence times length that is not
    /// the body force, over the largest stress.
    fn imbalance(&self) -> f64 {
        let mut left = vec![[[0.0; 2]; 2]; self.mesh.edges.len()];
        let mut worst: f64 = 0.0;
        for triangle in 0..self.mesh.triangles.len() {
            let corners = self.mesh.corners(triangle);
            for local in 0..3 {
                let (edge, (normal, _)) = (self.mesh.sides[triangle][local], outward(corners, local));
                for end in 0..2 {
                    let node = self.mesh.triangles[triangle][(local + 1 + end) % 3];
                    let pull = traction(self.stress[triangle][local][1 + end], normal);
                    let sum = &mut left[edge][usize::from(self.mesh.edges[edge][0] != node)];
                    (0..2).for_each(|axis| sum[axis] += pull[axis]);
                }
            }
            worst = worst.max(self.divergence(triangle));
        }
        for (_, _, edge, condition) in self.mesh.outline() {
            let condition = &self.problem.conditions[condition];
            for axis in 0..2 {
                let free = condition.held[axis].is_none();
                left[edge]
                    .iter_mut()
                    .for_each(|end| end[axis] = if free { end[axis] - condition.traction[axis] } else { 0.0 });
            }
        }
        for (row, place) in self.places.iter().enumerate() {
            let facing = &self.problem.obstacles[place.obstacle];
            left[place.edge][place.end][facing.axis] -=
                facing.sense * self.pull(row) / self.stresses.half_area(place.edge);
        }
        worst = left.iter().flatten().flatten().fold(worst, |worst, entry| worst.max(entry.abs()));
        over(worst, self.largest_stress())
    }

    /// The largest part of divergence and body force that do not cancel on a triangle, times its size.
    fn divergence(&self, triangle: usize) -> f64 {
        let mut worst: f64 = 0.0;
        for k in 0..3 {
            let corners = part(self.mesh.corners(triangle), k);
            let mut force = [0.0; 2];
            let mut size: f64 = 0.0;
            for corner in 0..3 {
                let (normal, length) = outward(corners, corner);
                let pull = traction(self.stress[triangle][k][corner], normal);
                // The slope of a barycentric coordinate is the opposite of the normal over the height.
                (0..2).for_each(|axis| force[axis] -= pull[axis] * length);
                size = size.max(length);
            }
            let area = twice_area(corners);
            for (force, of_body) in force.into_iter().zip(self.problem.body_force) {
                worst = worst.max((force / area + of_body).abs() * area / size);
            }
        }
        worst
    }

    /// The largest force of the wrong sign, over the largest one.
    fn adhesion(&self) -> f64 {
        let multiplier = &self.dual.solution.multiplier;
        let wrong = multiplier.iter().fold(0.0, |worst: f64, force| worst.max(*force));
        over(wrong, multiplier.iter().fold(0.0, |largest: f64, force| largest.max(force.abs())))
    }

    /// The deepest place of the displacement in an obstacle, over the largest displacement.
    fn penetration(&self) -> f64 {
        let (mut deepest, values) = (0.0_f64, &self.primal.values);
        let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        for (_, _, edge, condition) in self.mesh.outline() {
            let [from, to] = self.mesh.edges[edge].map(|node| self.mesh.nodes[node]);
            for &obstacle in &self.problem.conditions[condition].obstacles {
                let facing = &self.problem.obstacles[obstacle];
                let [first, middle, last] =
                    self.displacements.on_edge(edge, facing.axis).map(|function| values[function]);
                for s in SAMPLES {
                    let place = [0, 1].map(|axis| from[axis] + s * (to[axis] - from[axis]));
                    let moved = (1.0 - s).powi(2) * first + 2.0 * s * (1.0 - s) * middle + s * s * last;
                    if let Some(gap) = facing.surface.gap(place, place) {
                        deepest = deepest.max(facing.sense * moved - gap.values[0]);
                    }
                }
            }
        }
        over(deepest, largest)
    }

    /// By how much J - D, from the energies, misses the sum of the shares; over the largest of the energies.
    fn lost(&self) -> f64 {
        let [high, low] = [self.energy_of_displacement(), self.energy_of_stress()];
        let size = self.energy.max(high.abs()).max(low.abs());
        over((high - low - self.distance()).abs(), size)
    }
}

/// A ratio, zero for nothing over nothing.
fn over(value: f64, size: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value / size }
}

/// The difference of two tensors.
pub fn minus(a: Tensor, b: Tensor) -> Tensor {
    [0, 1, 2].map(|entry| a[entry] - b[entry])
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;
    use std::sync::Arc;

    use super::super::problem::{Condition, Distance, Enclosure, Facing};
    use super::super::triangulation::Point;
    use super::*;
    use crate::qp::Method;

    /// The surface `y = 1 - 0.02 + (x - 0.4)^2` over a square of side 1.
    #[derive(Debug)]
    struct Bowl;

    impl Distance for Bowl {
        fn gap(&self, from: Point, to: Point) -> Option<Enclosure> {
            let gap = |[x, y]: Point| 0.98 + (x - 0.4) * (x - 0.4) - y;
            let middle = [0, 1].map(|axis| (from[axis] + to[axis]) / 2.0);
            Some(Enclosure { values: [gap(from), gap(middle), gap(to)], below: 0.0, above: 0.0 })
        }
    }

    /// A square on a clamped side, pulled on the right, heavy, under a bowl.
    fn square() -> (PlaneProblem, Triangulation) {
        let side =
            |held: [Option<f64>; 2], traction: Point, obstacles: Vec<usize>| Condition { held, traction, obstacles };
        let problem = PlaneProblem {
            lame: Lame { lambda: 1.5, mu: 1.0 },
            thickness: 0.5,
            body_force: [0.01, -0.02],
            conditions: vec![
                side([Some(0.0); 2], [0.0; 2], vec![]),
                side([None; 2], [0.03, 0.01], vec![]),
                side([None; 2], [0.0; 2], vec![0]),
                side([None; 2], [0.0; 2], vec![]),
            ],
            obstacles: vec![Facing { axis: 1, sense: 1.0, surface: Arc::new(Bowl) }],
        };
        let outline = HashMap::from([([0, 1], 0), ([1, 2], 1), ([2, 3], 2), ([0, 3], 3)]);
        let nodes = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let mut mesh = Triangulation::new(nodes, vec![[0, 1, 2], [0, 2, 3]], vec![0, 0], &outline).unwrap();
        for _ in 0..2 {
            mesh = mesh.refined(&vec![true; mesh.triangles.len()]);
        }
        (problem, mesh)
    }

    fn settings() -> Settings {
        Settings::with_method(Method::ActiveSet)
    }

    /// What the check says of a bracket.
    fn refusal(bracket: &Bracket) -> String {
        bracket.check().unwrap_err().to_string()
    }

    #[test]
    fn a_right_bracket_passes_the_check_and_touches() {
        let (problem, mesh) = square();
        let bracket = Bracket::new(&problem, &mesh, &settings()).unwrap();
        assert!(bracket.defect < 1e-12, "{}", bracket.defect);
        assert!(bracket.force() > 0.0 && bracket.contact_share > 0.0);
        assert!(bracket.energy_of_stress() < bracket.energy_of_displacement());
    }

    #[test]
    fn a_lost_traction_is_refused() {
        let (problem, mesh) = square();
        let mut without = problem.clone();
        without.conditions[1].traction = [0.0; 2];
        let mut bracket = Bracket::new(&without, &mesh, &settings()).unwrap();
        bracket.problem = &problem;
        assert!(refusal(&bracket).contains("the stress is out of balance"));
    }

    #[test]
    fn a_missed_body_force_is_refused() {
        let (problem, mesh) = square();
        let weightless = PlaneProblem { body_force: [0.0; 2], ..problem.clone() };
        let mut bracket = Bracket::new(&weightless, &mesh, &settings()).unwrap();
        bracket.problem = &problem;
        assert!(refusal(&bracket).contains("the stress is out of balance"));
    }

    #[test]
    fn a_wrong_sign_on_a_candidate_edge_is_refused() {
        let (problem, mesh) = square();
        let mut bracket = Bracket::new(&problem, &mesh, &settings()).unwrap();
        let pressed = bracket.dual.solution.multiplier.iter().position(|force| *force < 0.0).unwrap();
        bracket.dual.solution.multiplier[pressed] *= -1.0;
        assert!(!refusal(&bracket).is_empty());
        let signs: Vec<_> = bracket.defects().into_iter().filter(|(what, _)| *what == "the obstacle pulls").collect();
        assert!(signs[0].1 > 0.01, "{signs:?}");
    }

    /// Rows at the places of the nodes bound the values there, and nothing between.
    #[test]
    fn rows_at_nodes_instead_of_coefficients_are_refused() {
        let (problem, mesh) = square();
        let mut bracket = Bracket::new(&problem, &mesh, &settings()).unwrap();
        let displacements = Displacements::new(&problem, &mesh);
        let unknowns = displacements.unknowns();
        let corners_only = 2 * mesh.nodes.len();
        let rows: Vec<Row> =
            displacements.rows(&unknowns).unwrap().into_iter().filter(|row| row.unknown < corners_only).collect();
        let posed = unknowns.problem(displacements.blocks(), &displacements.load(), &rows).unwrap();
        bracket.primal = Side::solved(unknowns, rows, &posed, &settings()).unwrap();
        bracket.measure();
        assert!(refusal(&bracket).contains("the displacement goes into an obstacle"));
    }
}
