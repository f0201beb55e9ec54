//! The check of a bracket: balance, signs, distances and energies, from the stresses and displacements only.

use super::bound::{Bracket, steepest};
use super::problem::Surface;
use super::simplex::{mixed, pairs, traction, weights_of_centre};
use crate::error::Error;
use signorini_fem::geometry::plus;
use signorini_qp as qp;

/// Rounding of jumps of tractions over the largest stress, and of forces of the wrong sign over the largest force:
/// fifty times the value measured on meshes of 1e5 unknowns at a Poisson's ratio of 0.4999.
const OUT_OF_BALANCE: f64 = 1e-8;

/// Depth in an obstacle over the largest displacement that counts as rounding.
const PENETRATION: f64 = 1e-12;

/// The same over the largest coordinate: both a place and the height of an obstacle there are rounded.
const OF_PLACES: f64 = 4.0 * f64::EPSILON;

/// The share of J - D by which the energies may differ from it, beyond their own rounding.
const LOST: f64 = 1e-2;

/// Rounding of a sum of many energies, over the sum of their sizes.
const ENERGY_ROUNDING: f64 = 1e-10;

/// The places at which a displacement is compared with the obstacle divide each edge of a facet into this number of
/// parts.
const PARTS: usize = 4;

impl Bracket<'_> {
    /// Refuses a bracket without the required properties; returns the largest defect otherwise.
    pub(super) fn check(&self) -> Result<f64, Error> {
        // At rest all forces are rounding.
        let strained = |defect: fn(&Self) -> f64| if self.is_at_rest() { 0.0 } else { defect(self) };
        // The relative defect of each property, from the stresses and displacements only, and what is rounding.
        let defects = [
            ("the stress is out of balance", strained(Self::imbalance), OUT_OF_BALANCE),
            ("the obstacle pulls", strained(Self::adhesion), OUT_OF_BALANCE),
            ("the displacement goes into an obstacle", self.penetration(), self.allowed_penetration()),
            ("J - D differs from the sum of its shares", strained(Self::lost), LOST),
        ];
        let Some((what, size, allowed)) = defects.iter().find(|(_, size, allowed)| size.is_nan() || size > allowed)
        else {
            return Ok(defects.iter().fold(0.0, |worst, defect| f64::max(worst, defect.1)));
        };
        let reason =
            format!("{what} by {size:.1e}, but at most {allowed:.0e} is allowed as rounding; nothing is guaranteed");
        Err(qp::LinearError::Numerical { step: "the guaranteed bound", reason }.into())
    }

    /// The largest stress, in balance or of the displacement: the former is rounding if nothing touches yet.
    fn largest_stress(&self) -> f64 {
        let (corners, centre) = (self.mesh.dimension + 1, weights_of_centre(self.mesh.dimension));
        let strain = |cell: usize| self.displacements.strain(&self.primal.values, cell, centre);
        let of_displacement = (0..self.stress.len()).map(|cell| self.law(cell).stress(strain(cell)));
        let in_balance = (0..self.stress.len())
            .flat_map(|cell| (0..corners).map(move |k| self.stress_of(&self.stress, cell, k, centre)));
        of_displacement.chain(in_balance).flatten().fold(0.0, |largest: f64, entry| largest.max(entry.abs()))
    }

    /// The largest difference of a traction from what loads, springs and obstacles give, between simplices and on the
    /// surface, and the largest sum of divergence and body force times length, over the largest stress. Where supports
    /// or rigid faces leave free motions, it is the sum along each.
    fn imbalance(&self) -> f64 {
        let [mut left, mut shares] = self.forces_on_facets(&self.stress);
        let given = self.stresses.given_forces(&self.dual.values, &self.places, &self.pulls);
        left.iter_mut().zip(given).for_each(|(left, given)| *left -= given);
        // The forces along the motions of rigid faces and along travels.
        let loads = self.problem.loads_of_motions();
        let first = left.len() - loads.len();
        left[first..].iter_mut().zip(loads).for_each(|(left, load)| *left = -load);
        for (place, pull) in self.places.iter().zip(&self.pulls) {
            if let Some((travel, share)) = self.problem.travel(place.obstacle, self.stresses.place_count()) {
                left[travel] -= share * pull;
                shares[travel] +=
                    self.problem.share_of_corner(self.mesh.simplex(place.on.cell).outward(place.on.local).1);
            }
        }
        let unknowns = &self.dual.unknowns;
        let per_area = unknowns.gathered(&left).into_iter().zip(unknowns.gathered_by(&shares, f64::abs));
        let worst = (0..self.mesh.count()).fold(0.0, |worst: f64, cell| worst.max(self.divergence(cell)));
        let worst = per_area.fold(worst, |worst, (force, area)| worst.max(over(force.abs(), area)));
        over(worst, self.largest_stress())
    }

    /// The largest sum of divergence and body force on a simplex, times its smallest height.
    fn divergence(&self, cell: usize) -> f64 {
        let (simplex, corners) = (self.mesh.simplex(cell), self.mesh.dimension + 1);
        let mut worst: f64 = 0.0;
        for k in 0..corners {
            let part = simplex.part(k);
            for corner in 0..corners {
                let body_force = self.problem.medium(self.mesh.origins[cell]).body_force;
                let mut sum = body_force.map(|force| self.problem.radius(part.corners()[corner]) * force);
                for (axis, slope) in part.slopes().into_iter().enumerate().take(corners) {
                    sum = plus(sum, traction(self.stress[cell].slope(k, corner, axis), slope));
                }
                // About an axis the radial balance gives the hoop stress.
                let balances = sum.iter().skip(usize::from(self.problem.is_axisymmetric));
                worst = balances.fold(worst, |worst, part_of| worst.max(part_of.abs() / steepest(&part)));
            }
        }
        worst
    }

    /// The largest force of the wrong sign, over the largest force.
    fn adhesion(&self) -> f64 {
        let wrong = self.pulls.iter().fold(0.0, |worst: f64, force| worst.max(*force));
        over(wrong, qp::largest(&self.pulls))
    }

    /// The largest depth of the displacement in an obstacle, over the largest displacement.
    fn penetration(&self) -> f64 {
        let (mut deepest, values) = (0.0_f64, &self.primal.values);
        let largest = self.displacements.largest(values);
        let dimension = self.mesh.dimension;
        for (outer, obstacle) in self.problem.facing(self.mesh) {
            let corners = self.mesh.corners_of_facet(outer.facet);
            let coefficients = self.displacements.towards(values, &outer, obstacle);
            for weights in samples(dimension) {
                let of_pair = |[i, j]: [usize; 2]| weights[i] * weights[j] * if i == j { 1.0 } else { 2.0 };
                let at = |coefficients: &[f64]| -> f64 {
                    pairs(dimension).zip(coefficients).map(|(pair, coefficient)| of_pair(pair) * coefficient).sum()
                };
                let gap = match &self.problem.obstacles[obstacle].surface {
                    Surface::Rigid(distance) => {
                        let place = mixed(&corners, &weights);
                        distance.gap(&vec![place; dimension]).map(|gap| gap.coefficients[0])
                    }
                    Surface::Body { .. } => {
                        self.problem.gap(self.mesh, outer.facet, obstacle).map(|gap| at(&gap.coefficients))
                    }
                };
                if let Some(gap) = gap {
                    deepest = deepest.max(at(&coefficients) - gap);
                }
            }
        }
        over(deepest, largest)
    }

    /// The penetration up to which it is rounding: of the displacement, or of the places of nodes and obstacle.
    fn allowed_penetration(&self) -> f64 {
        let farthest = qp::largest(self.mesh.nodes.as_flattened());
        PENETRATION.max(over(OF_PLACES * farthest, self.displacements.largest(&self.primal.values)))
    }

    /// Difference of J - D, from the energies, and the sum of the shares, over that sum. It leaves out the rounding of
    /// the energies and the work of forces that rounding leaves unbalanced, which grows with the rigid motion of a
    /// body.
    fn lost(&self) -> f64 {
        let [high, low] = [self.energy_of_displacement(), self.energy_of_stress()];
        let works = [self.work_of_loads(), self.work_on_supports(), self.work_on_obstacles()];
        let size = works.iter().fold(self.energy, |sum, work| sum + work.abs());
        let rounding = (ENERGY_ROUNDING + self.imbalance()) * size;
        over(((high - low - self.distance()).abs() - rounding).max(0.0), self.distance())
    }
}

/// The barycentric coordinates of places on a facet.
fn samples(corners: usize) -> impl Iterator<Item = [f64; 3]> {
    let share = |parts: usize| parts as f64 / PARTS as f64;
    (0..=PARTS).flat_map(move |first| {
        let left = PARTS - first;
        let seconds = if corners == 2 { left..=left } else { 0..=left };
        seconds.map(move |second| [share(first), share(second), share(left - second)])
    })
}

/// A ratio; 0/0 gives zero.
fn over(value: f64, size: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value / size }
}

#[cfg(test)]
mod tests {
    use super::super::bodies::{body, settings, solved};
    use super::super::bound::Half;
    use super::super::displacement::Displacements;
    use super::super::problem::ContinuumProblem;
    use super::super::simplex::{Point, Tensor, less, middle};
    use super::super::system::Row;
    use super::*;
    use crate::answer::Strain;

    /// The message of the check of a bracket.
    fn refusal(bracket: &Bracket) -> String {
        bracket.check().unwrap_err().to_string()
    }

    #[test]
    fn a_right_bracket_passes_the_check_and_touches() {
        for (problem, mesh) in [body(2), body(3)] {
            let bracket = solved(&problem, &mesh);
            assert!(bracket.defect < 1e-11, "{}", bracket.defect);
            assert!(bracket.force() > 0.0 && bracket.contact_share > 0.0);
            // In a coarse mesh only middles of edges may touch.
            let is_on_top = |(node, touches): (&Point, bool)| !touches || node[mesh.dimension - 1] == 1.0;
            assert!(mesh.nodes.iter().zip(bracket.touching()).all(is_on_top));
            let volume: f64 = (0..mesh.count()).map(|cell| bracket.volume(cell)).sum();
            assert!((volume - problem.thickness).abs() < 1e-14, "{volume}");
            assert!(bracket.energy_of_stress() < bracket.energy_of_displacement());
        }
    }

    /// A displacement of one strain everywhere, judged by the ball, has the distances that integrals by another rule
    /// give.
    #[test]
    fn a_displacement_is_judged_by_its_distance_from_the_centre_and_the_radius() {
        for (problem, mesh) in [body(2), body(3)] {
            let bracket = solved(&problem, &mesh);
            let own = if mesh.dimension == 2 {
                [0.01, -0.02, 0.0, 0.005, 0.0, 0.0]
            } else {
                [0.01, -0.02, 0.01, 0.005, 0.01, 0.02]
            };
            let law = problem.law(0);
            let size = |strain: Tensor| law.square(strain);
            let of_cell = |cell: usize, square: &dyn Fn(Tensor, Tensor) -> f64| {
                bracket.sum(cell, |k, at| {
                    let strain = bracket.strain(&bracket.primal.values, cell, k, at.weights);
                    at.weight * square(strain, bracket.elastic_stress(cell, k, at.weights))
                })
            };
            let length = |square: &dyn Fn(Tensor, Tensor) -> f64| {
                (0..mesh.count()).map(|cell| of_cell(cell, square)).sum::<f64>().sqrt()
            };
            let from_centre = length(&|strain, stress| size(less(own, middle(strain, law.compliance(stress)))));
            let varying = bracket.judged(|_| Strain::Varying(move |_: Point| own));
            let constant = bracket.judged(|_| Strain::<fn(Point) -> Tensor>::Constant(own));
            for judged in [varying, constant] {
                // The body has the size one.
                let exact = [
                    (judged.norm, (problem.thickness * size(own)).sqrt()),
                    (judged.from_displacement, length(&|strain, _| size(less(own, strain)))),
                    (judged.bound, from_centre + bracket.square_of_radius().sqrt()),
                ];
                for (found, exact) in exact {
                    assert!(exact > 0.0 && (found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
                }
            }
        }
    }

    /// A body at rest under a stress in balance: that stress is the largest.
    #[test]
    fn the_largest_stress_may_be_that_in_balance() {
        for (problem, mesh) in [body(2), body(3)] {
            let mut bracket = solved(&problem, &mesh);
            bracket.primal.values.fill(0.0);
            let (corners, centre) = (mesh.dimension + 1, weights_of_centre(mesh.dimension));
            let at_centres = (0..mesh.count()).flat_map(|cell| (0..corners).map(move |k| (cell, k)));
            let entries = at_centres.flat_map(|(cell, k)| bracket.elastic_stress(cell, k, centre));
            let largest = entries.fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
            assert!(largest > 0.0 && bracket.largest_stress() == largest, "{largest} {}", bracket.largest_stress());
        }
    }

    #[test]
    fn a_lost_traction_and_a_missed_body_force_are_refused() {
        let lost: [fn(&mut ContinuumProblem); 2] = [
            |problem| problem.conditions[1].traction = Default::default(),
            |problem| problem.media[0].body_force = [0.0; 3],
        ];
        for (problem, mesh) in [body(2), body(3)] {
            for lose in lost {
                let mut without = problem.clone();
                lose(&mut without);
                let mut bracket = solved(&without, &mesh);
                (bracket.problem, bracket.stresses.problem) = (&problem, &problem);
                assert!(refusal(&bracket).contains("the stress is out of balance"));
            }
        }
    }

    #[test]
    fn a_wrong_sign_on_a_candidate_facet_is_refused() {
        for (problem, mesh) in [body(2), body(3)] {
            let mut bracket = solved(&problem, &mesh);
            let pressed = bracket.pulls.iter().position(|force| *force < 0.0).unwrap();
            bracket.pulls[pressed] *= -1.0;
            assert!(!refusal(&bracket).is_empty());
            assert!(bracket.adhesion() > 0.01, "{}", bracket.adhesion());
        }
    }

    /// Rows at the places of the nodes bound the values there, but not between.
    #[test]
    fn rows_at_nodes_instead_of_coefficients_are_refused() {
        for (problem, mesh) in [body(2), body(3)] {
            let mut bracket = solved(&problem, &mesh);
            let displacements = Displacements::new(&problem, &mesh);
            let unknowns = displacements.unknowns();
            let corners_only = mesh.nodes.len();
            let [rows, _] = displacements.rows(&unknowns).unwrap();
            let rows: Vec<Row> = rows.into_iter().filter(|row| row.place(mesh.dimension) < corners_only).collect();
            let (blocks, load, places) = (displacements.blocks(), displacements.load(), displacements.places());
            let posed =
                unknowns.problem(mesh.dimension, &displacements.numbers, &blocks, &load, &rows, &places).unwrap();
            bracket.primal = Half::solved(unknowns, rows, &posed, None, &settings()).unwrap();
            bracket.measure();
            assert!(refusal(&bracket).contains("the displacement goes into an obstacle"));
        }
    }
}
