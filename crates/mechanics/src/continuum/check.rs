//! The check of a bracket: balance, signs, distances and energies, from the stresses and displacements only.

use super::bound::Bracket;
use super::johnson_mercier::{part, traction};
use super::triangulation::{CENTRE, outward, twice_area};
use crate::error::Error;
use signorini_qp as qp;

/// Rounding of jumps of tractions over the largest stress, and of forces of the wrong sign over the largest force: fifty times the value
/// measured on meshes of 1e5 unknowns at a Poisson's ratio of 0.4999.
const OUT_OF_BALANCE: f64 = 1e-8;

/// Depth in an obstacle over the largest displacement that counts as rounding.
const PENETRATION: f64 = 1e-12;

/// The share of J - D by which the energies may differ from it, beyond their own rounding.
const LOST: f64 = 1e-2;

/// Rounding of a sum of many energies, over the sum of their sizes.
const ENERGY_ROUNDING: f64 = 1e-10;

/// Places along an edge at which a displacement is compared with the obstacle: ends, middle, and between.
const SAMPLES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// The relative defect of a property, and the value up to which it is rounding.
#[derive(Clone, Copy, Debug)]
struct Defect {
    what: &'static str,
    size: f64,
    allowed: f64,
}

impl Bracket<'_> {
    /// Refuses a bracket without the required properties; returns the largest defect otherwise.
    ///
    /// # Errors
    /// [`qp::Error::Numerical`].
    pub(super) fn check(&self) -> Result<f64, Error> {
        let defects = self.defects();
        match defects.iter().find(|defect| defect.size.is_nan() || defect.size > defect.allowed) {
            None => Ok(defects.iter().fold(0.0, |worst, defect| f64::max(worst, defect.size))),
            Some(Defect { what, size, allowed }) => {
                let reason = format!(
                    "{what} by {size:.1e}, but at most {allowed:.0e} is allowed as rounding; nothing is guaranteed"
                );
                Err(qp::Error::Numerical { step: "the guaranteed bound", reason }.into())
            }
        }
    }

    /// The relative defect of each property, from the stresses and displacements only.
    fn defects(&self) -> [Defect; 4] {
        // At rest all forces are rounding.
        let strained = |defect: fn(&Self) -> f64| if self.is_at_rest() { 0.0 } else { defect(self) };
        let defect = |what, size, allowed| Defect { what, size, allowed };
        [
            defect("the stress is out of balance", strained(Self::imbalance), OUT_OF_BALANCE),
            defect("the obstacle pulls", strained(Self::adhesion), OUT_OF_BALANCE),
            defect("the displacement goes into an obstacle", self.penetration(), PENETRATION),
            defect("J - D differs from the sum of its shares", strained(Self::lost), LOST),
        ]
    }

    /// The largest stress, in balance or of the displacement: the former is rounding if nothing touches yet.
    fn largest_stress(&self) -> f64 {
        let strain = |triangle: usize| self.displacements.strain(&self.primal.values, triangle, CENTRE);
        let of_displacement = (0..self.stress.len()).map(|triangle| self.problem.stress(strain(triangle)));
        let in_balance = self.stress.iter().flatten().flatten().copied();
        of_displacement.chain(in_balance).flatten().fold(0.0, |largest: f64, entry| largest.max(entry.abs()))
    }

    /// The largest jump of a traction between triangles, difference of traction and load, and sum of divergence and body force times
    /// length, over the largest stress.
    fn imbalance(&self) -> f64 {
        let mut left = self.jumps(&self.stress);
        let mut worst =
            (0..self.mesh.triangles.len()).fold(0.0, |worst: f64, triangle| worst.max(self.divergence(triangle)));
        for (triangle, local, edge, condition) in self.mesh.outline() {
            let condition = &self.problem.conditions[condition];
            let pull = condition.pull(outward(self.mesh.corners(triangle), local).0);
            for axis in 0..2 {
                let free = condition.held[axis].is_none();
                left[edge].iter_mut().for_each(|end| end[axis] = if free { end[axis] - pull[axis] } else { 0.0 });
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

    /// The largest sum of divergence and body force on a triangle, times its size.
    fn divergence(&self, triangle: usize) -> f64 {
        let mut worst: f64 = 0.0;
        for k in 0..3 {
            let corners = part(self.mesh.corners(triangle), k);
            let mut force = [0.0; 2];
            let mut size: f64 = 0.0;
            for corner in 0..3 {
                let (normal, length) = outward(corners, corner);
                let pull = traction(self.stress[triangle][k][corner], normal);
                // The slope of a barycentric coordinate is minus the normal over the height.
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

    /// The largest force of the wrong sign, over the largest force.
    fn adhesion(&self) -> f64 {
        let multiplier = &self.dual.solution.multiplier;
        let wrong = multiplier.iter().fold(0.0, |worst: f64, force| worst.max(*force));
        over(wrong, multiplier.iter().fold(0.0, |largest: f64, force| largest.max(force.abs())))
    }

    /// The largest depth of the displacement in an obstacle, over the largest displacement.
    fn penetration(&self) -> f64 {
        let (mut deepest, values) = (0.0_f64, &self.primal.values);
        let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        for (edge, [from, to], obstacle) in self.problem.facing(self.mesh) {
            let facing = &self.problem.obstacles[obstacle];
            let [first, middle, last] = self.displacements.on_edge(edge, facing.axis).map(|function| values[function]);
            for s in SAMPLES {
                let place = [0, 1].map(|axis| from[axis] + s * (to[axis] - from[axis]));
                let moved = (1.0 - s).powi(2) * first + 2.0 * s * (1.0 - s) * middle + s * s * last;
                if let Some(gap) = facing.surface.gap(place, place) {
                    deepest = deepest.max(facing.sense * moved - gap.values[0]);
                }
            }
        }
        over(deepest, largest)
    }

    /// Difference of J - D, from the energies, and the sum of the shares, over that sum. It leaves out the rounding of the energies and
    /// the work of forces that rounding leaves unbalanced, which grows with the rigid motion of a body.
    fn lost(&self) -> f64 {
        let [high, low] = [self.energy_of_displacement(), self.energy_of_stress()];
        let works = [self.work_of_loads(), self.work_on_supports(&self.stress), self.work_on_obstacles()];
        let size = works.iter().fold(self.energy, |sum, work| sum + work.abs());
        let rounding = (ENERGY_ROUNDING + self.imbalance()) * size;
        over(((high - low - self.distance()).abs() - rounding).max(0.0), self.distance())
    }
}

/// A ratio; 0/0 gives zero.
fn over(value: f64, size: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value / size }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;
    use std::sync::Arc;

    use super::super::bound::Side;
    use super::super::displacement::Displacements;
    use super::super::problem::{Condition, Distance, Enclosure, Facing, PlaneProblem, Tensor, work};
    use super::super::system::Row;
    use super::super::triangulation::{Point, Triangulation};
    use super::*;
    use crate::fem::geometry::minus;
    use crate::fem::material::Lame;
    use signorini_qp::{Method, Settings};

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

    /// A square on a clamped side, with a traction on the right, a body force, and a bowl above.
    fn square() -> (PlaneProblem, Triangulation) {
        let side = |held: [Option<f64>; 2], traction: Point, obstacles: Vec<usize>| Condition {
            held,
            traction,
            obstacles,
            ..Condition::default()
        };
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
            boundaries: Vec::new(),
        };
        let outline = HashMap::from([([0, 1], 0), ([1, 2], 1), ([2, 3], 2), ([0, 3], 3)]);
        let nodes = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let mut mesh = Triangulation::new(nodes, vec![[0, 1, 2], [0, 2, 3]], vec![0, 0], &outline).unwrap();
        for _ in 0..2 {
            mesh = problem.refined(&mesh, &vec![true; mesh.triangles.len()]);
        }
        (problem, mesh)
    }

    fn settings() -> Settings {
        Settings::with_method(Method::ActiveSet)
    }

    /// The message of the check of a bracket.
    fn refusal(bracket: &Bracket) -> String {
        bracket.check().unwrap_err().to_string()
    }

    #[test]
    fn a_right_bracket_passes_the_check_and_touches() {
        let (problem, mesh) = square();
        let bracket = Bracket::new(&problem, &mesh, None, &settings()).unwrap();
        assert!(bracket.defect < 1e-12, "{}", bracket.defect);
        assert!(bracket.force() > 0.0 && bracket.contact_share > 0.0);
        assert!(bracket.energy_of_stress() < bracket.energy_of_displacement());
    }

    /// A displacement of one strain everywhere, judged by the ball, has the distances that integrals by another rule give.
    #[test]
    fn a_displacement_is_judged_by_its_distance_from_the_centre_and_the_radius() {
        let (problem, mesh) = square();
        let bracket = Bracket::new(&problem, &mesh, None, &settings()).unwrap();
        let own = [0.01, -0.02, 0.005];
        let size = |strain: Tensor| work(problem.stress(strain), strain);
        let length = |square: &dyn Fn(Tensor, Tensor) -> f64| {
            (0..mesh.triangles.len()).map(|triangle| bracket.integral(triangle, square)).sum::<f64>().sqrt()
        };
        let from_centre = length(&|strain, stress| {
            let balanced = problem.compliance(stress);
            size(minus(own, [0, 1, 2].map(|entry| (strain[entry] + balanced[entry]) / 2.0)))
        });
        let judged = bracket.judged(|_| move |_: Point| own);
        // The square has the area one.
        let exact = [
            (judged.norm, (problem.thickness * size(own)).sqrt()),
            (judged.from_displacement, length(&|strain, _| size(minus(own, strain)))),
            (judged.bound, from_centre + bracket.square_of_radius().sqrt()),
        ];
        for (found, exact) in exact {
            assert!(exact > 0.0 && (found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
        }
    }

    #[test]
    fn a_lost_traction_is_refused() {
        let (problem, mesh) = square();
        let mut without = problem.clone();
        without.conditions[1].traction = [0.0; 2];
        let mut bracket = Bracket::new(&without, &mesh, None, &settings()).unwrap();
        bracket.problem = &problem;
        assert!(refusal(&bracket).contains("the stress is out of balance"));
    }

    #[test]
    fn a_missed_body_force_is_refused() {
        let (problem, mesh) = square();
        let weightless = PlaneProblem { body_force: [0.0; 2], ..problem.clone() };
        let mut bracket = Bracket::new(&weightless, &mesh, None, &settings()).unwrap();
        bracket.problem = &problem;
        assert!(refusal(&bracket).contains("the stress is out of balance"));
    }

    #[test]
    fn a_wrong_sign_on_a_candidate_edge_is_refused() {
        let (problem, mesh) = square();
        let mut bracket = Bracket::new(&problem, &mesh, None, &settings()).unwrap();
        let pressed = bracket.dual.solution.multiplier.iter().position(|force| *force < 0.0).unwrap();
        bracket.dual.solution.multiplier[pressed] *= -1.0;
        assert!(!refusal(&bracket).is_empty());
        assert!(bracket.adhesion() > 0.01, "{}", bracket.adhesion());
    }

    /// Rows at the places of the nodes bound the values there, but not between.
    #[test]
    fn rows_at_nodes_instead_of_coefficients_are_refused() {
        let (problem, mesh) = square();
        let mut bracket = Bracket::new(&problem, &mesh, None, &settings()).unwrap();
        let displacements = Displacements::new(&problem, &mesh);
        let unknowns = displacements.unknowns();
        let corners_only = 2 * mesh.nodes.len();
        let rows: Vec<Row> =
            displacements.rows(&unknowns).unwrap().into_iter().filter(|row| row.unknown < corners_only).collect();
        let posed = unknowns.problem(displacements.blocks(), &displacements.load(), &rows).unwrap();
        bracket.primal = Side::solved(unknowns, rows, &posed, None, &settings()).unwrap();
        bracket.measure();
        assert!(refusal(&bracket).contains("the displacement goes into an obstacle"));
    }
}
