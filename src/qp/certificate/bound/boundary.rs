//! The bound where the energy norm knows the contact boundary: repaired in energy, all rows together.
//!
//! A force `alpha r + B' x` has its sweep through the factor on the boundary alone but for that of r, which is made once.
//! With Z = L_tt^-1 B_t' multipliers eta move the rows by c Z'Z eta. Two repairs are tried:
//!
//! * v is the equilibrium of the rows that look closed. Where all of them push, v is the exact answer, and the bound is the
//!   error itself;
//! * the rows that look closed are put at their gaps by the smallest motion, and keep the forces of the answer.

use std::cell::OnceCell;

use super::super::energy_norm::Boundary;
use super::triangle::{Triangle, triangle_of};
use super::{Answer, EnergyNorm, ErrorBound};
use crate::qp::linear::{UpperTriangle, dot, exponent, ldexp};
use crate::qp::problem::ContactProblem;

/// Times that the rows which look closed are corrected; from then on rows are only added.
const EXCHANGES: usize = 10;

/// Corrections of the multipliers that put rows at their gaps; each gains the digits that the dependence of rows leaves.
const CORRECTIONS: usize = 4;

/// Rounding of a sum of forces, in units of its terms; a factor multiplies it by its [loss](EnergyNorm::loss).
const CANCELLED: f64 = 4.0 * f64::EPSILON;

/// Forces that cancel each other do no harm where their rounding is below this share of the bound.
const SMALL: f64 = 1e-3;

/// With springs, a factor that loses more than this is not enough for the energy of a motion.
const LOST_WITH_SPRINGS: f64 = 1e4;

/// The way of rows to their gaps counts as motion of the answer, as the residual that this makes, and once for the rounding of
/// its length.
const COUNTS: f64 = 3.0;

/// Rows that others follow from are off by their own rounding after a fit, and by that of their distances.
const FOLLOWS: f64 = 2.0;

/// Rounding of a row's distance after a motion, in units of its terms.
const DISTANCE_ROUNDING: f64 = 16.0 * f64::EPSILON;

impl ContactProblem {
    /// The bound from the repair on the boundary; `None` where the rows that look closed cannot be met together.
    pub(super) fn bound_on_boundary(
        &self,
        norm: &EnergyNorm,
        boundary: &Boundary,
        answer: &Answer,
        closed: &[bool],
    ) -> Option<ErrorBound> {
        let residual = |answer: &Answer| match norm.springs() {
            Some(springs) => springs.residual(&self.contact, &answer.residual, answer.violation),
            None => answer.residual.clone(),
        };
        let first = Answer { residual: residual(answer), ..*answer };
        let repair = Repair::new(self, norm, boundary, &first)?;
        let witness = repair.best_witness(closed)?;
        let bound = repair.bound(&witness);
        // With springs the motion is large and bends little, which a factor that loses digits leaves to rounding.
        let is_precise = norm.springs().is_none() || norm.loss() <= LOST_WITH_SPRINGS;
        let is_exact = norm.widening() == 1.0 && !witness.has_dependent && is_precise;
        if is_exact && repair.cancelled(&witness) <= SMALL * bound.whole {
            return Some(bound);
        }
        // Rows that follow from others: what is rounding of a large motion may be a large distance between them. Forces that
        // cancel each other leave what the factor has rounded. The same again from the witness itself, whose motions, forces
        // and changes of force are small; how far the answer is from there needs no factor.
        let (moved, multiplier) = repair.answer(&witness);
        let [first, change] = [&witness.first, &witness.change].map(|part| repair.expanded(part));
        let violation = self.accurate_violation(&moved);
        let near = Answer {
            displacement: &moved,
            multiplier: &multiplier,
            residual: self.accurate_residual_of(&moved, &[&first, &change]),
            violation: &violation,
        };
        let near = Answer { residual: residual(&near), ..near };
        let repair = Repair::new(self, norm, boundary, &near)?;
        let of_near = repair.bound(&repair.best_witness(&witness.closed)?);
        let step: Vec<f64> = moved.iter().zip(answer.displacement).map(|(v, u)| v - u).collect();
        Some(of_near.farther(self, &step))
    }

    /// An answer repaired, in doubles: displacements at which the rows that look closed are at their gaps, and the multipliers
    /// of their equilibrium; `None` where there is none, or where the boundary is not known.
    pub(crate) fn repaired(&self, norm: &EnergyNorm, u: &[f64], lambda: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
        let violation = self.accurate_violation(u);
        let residual = self.accurate_residual(u, lambda);
        let answer = Answer { displacement: u, multiplier: lambda, residual, violation: &violation };
        let repair = Repair::new(self, norm, norm.boundary()?, &answer)?;
        let witness = repair.settle(&self.rows_that_look_closed(&answer), true)?;
        Some(repair.answer(&witness))
    }
}

/// The force `alpha r + B' x`, x in the units of normalised rows.
struct Force {
    alpha: f64,
    rows: Vec<f64>,
    /// Magnitudes of the terms of x: what rounding of their sum is measured by.
    terms: Vec<f64>,
}

impl Force {
    fn new(alpha: f64, rows: Vec<f64>) -> Self {
        let terms = rows.iter().map(|x| x.abs()).collect();
        Force { alpha, rows, terms }
    }

    /// The force with more of each row, which was added up from steps of the magnitudes `steps`.
    fn plus(&self, more: &[f64], steps: &[f64]) -> Self {
        let rows = self.rows.iter().zip(more).map(|(a, b)| a + b).collect();
        let terms = self.terms.iter().zip(steps).map(|(a, b)| a + b).collect();
        Force { alpha: self.alpha, rows, terms }
    }

    fn is_none(&self) -> bool {
        self.alpha == 0.0 && self.rows.iter().all(|&x| x == 0.0)
    }
}

/// A feasible v and multipliers mu: `v - u = K^-1 error`, and what is left of the forces at (v, mu).
struct Witness {
    error: Force,
    left: Force,
    /// The multipliers mu, rounded: the sum of the next two.
    multiplier: Vec<f64>,
    first: Vec<f64>,
    change: Vec<f64>,
    closed: Vec<bool>,
    /// For each closed row an upper bound on the energy norm of the motion that puts it exactly at its gap, and leaves the others
    /// there.
    rest: Vec<f64>,
    /// Does a closed row follow from others?
    has_dependent: bool,
}

/// An answer on the contact boundary, in equilibrated units, rows normalised by powers of two.
struct Repair<'a> {
    problem: &'a ContactProblem,
    norm: &'a EnergyNorm,
    boundary: &'a Boundary,
    answer: &'a Answer<'a>,
    /// The entries of each row: place on the boundary, coefficient.
    rows: Vec<Vec<(usize, f64)>>,
    /// Exponent by which each row was multiplied.
    shift: Vec<i32>,
    violation: Vec<f64>,
    multiplier: Vec<f64>,
    /// `L_tt^-1 B_i'` of each row that was asked for.
    halves: Vec<OnceCell<Vec<f64>>>,
    /// The sweep of the residual: squares of the interior, and the boundary.
    interior: f64,
    swept: Vec<f64>,
}

impl<'a> Repair<'a> {
    fn new(
        problem: &'a ContactProblem,
        norm: &'a EnergyNorm,
        boundary: &'a Boundary,
        answer: &'a Answer<'a>,
    ) -> Option<Self> {
        // A row without obstacle and without force may reach wherever it likes.
        let counts = |row: usize| problem.gap[row].is_finite() || answer.multiplier[row] != 0.0;
        let mut rows = norm.rows_on(boundary, &problem.contact, counts)?;
        let largest = |row: &Vec<(usize, f64)>| row.iter().fold(0.0, |largest: f64, entry| largest.max(entry.1.abs()));
        let shift: Vec<i32> = rows.iter().map(|row| -exponent(largest(row))).collect();
        for (row, &shift) in rows.iter_mut().zip(&shift) {
            row.iter_mut().for_each(|entry| entry.1 = ldexp(entry.1, shift));
        }
        let scaled = |values: &[f64], sign: i32, unit: i32| -> Vec<f64> {
            values.iter().zip(&shift).map(|(&value, &shift)| ldexp(value, sign * shift - unit)).collect()
        };
        let (violation, multiplier) = (scaled(answer.violation, 1, norm.factor()), scaled(answer.multiplier, -1, 0));
        let (interior, swept) = norm.sweep(&answer.residual);
        let halves = vec![OnceCell::new(); rows.len()];
        Some(Repair { problem, norm, boundary, answer, rows, shift, violation, multiplier, halves, interior, swept })
    }

    fn spread(&self, weights: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.boundary.len()];
        for (row, &weight) in self.rows.iter().zip(weights).filter(|entry| *entry.1 != 0.0) {
            row.iter().for_each(|&(place, b)| sum[place] += weight * b);
        }
        self.boundary.forward(sum)
    }

    fn half(&self, row: usize) -> &[f64] {
        self.halves[row].get_or_init(|| {
            let mut column = vec![0.0; self.boundary.len()];
            self.rows[row].iter().for_each(|&(place, b)| column[place] += b);
            self.boundary.forward(column)
        })
    }

    /// The sweep of a force on the boundary.
    fn sweep(&self, force: &Force) -> Vec<f64> {
        let mut sweep = self.spread(&force.rows);
        sweep.iter_mut().zip(&self.swept).for_each(|(entry, swept)| *entry += force.alpha * swept);
        sweep
    }

    /// The energy norm of the motion that a force causes.
    fn length(&self, force: &Force) -> f64 {
        let sweep = self.sweep(force);
        ldexp(force.alpha * force.alpha * self.interior + dot(&sweep, &sweep), self.norm.factor()).sqrt()
    }

    /// The energy norm of the motion that a unit force along a row causes.
    fn reach(&self, row: usize) -> f64 {
        if self.norm.is_over() {
            return f64::INFINITY;
        }
        let half = self.half(row);
        ldexp(dot(half, half), self.norm.factor()).sqrt()
    }

    /// The motion of the whole body that a force causes, length n.
    fn motion(&self, force: &Force) -> Vec<f64> {
        let rows: Vec<f64> = force.rows.iter().zip(&self.shift).map(|(&x, &shift)| ldexp(x, shift)).collect();
        let contact = self.problem.contact.mul_transposed(&rows);
        let total: Vec<f64> = self.answer.residual.iter().zip(contact).map(|(r, b)| force.alpha * r + b).collect();
        self.norm.displacement(&total)
    }

    /// The displacements and multipliers of a witness, in the units of the problem.
    fn answer(&self, witness: &Witness) -> (Vec<f64>, Vec<f64>) {
        let motion = self.motion(&witness.error);
        let moved = self.answer.displacement.iter().zip(motion).map(|(u, d)| u + d).collect();
        (moved, self.expanded(&witness.multiplier))
    }

    fn bound(&self, witness: &Witness) -> ErrorBound {
        let Witness { error, left, multiplier, closed, rest, .. } = witness;
        let of_left = self.length(left);
        let springs = self.norm.springs();
        if springs.is_some_and(|springs| !springs.hold(&self.expanded(multiplier), closed, |_| of_left)) {
            return ErrorBound::none();
        }
        // Closed rows are put exactly at their gaps, which moves the answer and its residual; and forces that cancel each other
        // leave their rounding.
        let put: Vec<f64> = (0..rest.len()).map(|row| COUNTS * rest[row] + self.cancelled_on(witness, row)).collect();
        let of_error = match springs {
            // The springs' own energy is no error, but rounding knows them.
            Some(_) => self.problem.length(&self.motion(error)) + (self.norm.rounding() - 1.0) * self.length(error),
            None => self.length(error),
        };
        let whole = of_error + of_left + put.iter().sum::<f64>();
        let parts = self.problem.parts();
        let of_parts = (parts.count() > 1).then(|| {
            let mut sizes = vec![0.0; parts.count()];
            self.problem.parts_of_rows(parts).iter().zip(&put).for_each(|(&part, put)| sizes[part] += put);
            [error, left].iter().for_each(|force| self.problem.add_sizes(parts, &self.motion(force), &mut sizes));
            sizes
        });
        ErrorBound { whole, of_parts }
    }

    /// What rounding of forces that cancel each other may be worth, row by row, in energy norm.
    fn cancelled_on(&self, witness: &Witness, row: usize) -> f64 {
        let terms = witness.error.terms[row] + witness.left.terms[row];
        if terms > 0.0 { CANCELLED * self.norm.loss() * terms * self.reach(row) } else { 0.0 }
    }

    /// The same of all rows and of the residual.
    fn cancelled(&self, witness: &Witness) -> f64 {
        let alpha = witness.error.alpha.abs() + witness.left.alpha.abs();
        let residual = self.length(&Force::new(alpha, vec![0.0; self.rows.len()]));
        let of_residual = CANCELLED * self.norm.loss() * residual;
        (0..self.rows.len()).map(|row| self.cancelled_on(witness, row)).fold(of_residual, |sum, of_row| sum + of_row)
    }

    /// Multipliers in the units of the problem.
    fn expanded(&self, multiplier: &[f64]) -> Vec<f64> {
        multiplier.iter().zip(&self.shift).map(|(&mu, &shift)| ldexp(mu, shift)).collect()
    }

    /// The equilibrium of the rows that look closed where all of them push, or else the better of both repairs.
    fn best_witness(&self, closed: &[bool]) -> Option<Witness> {
        let settled = self.settle(closed, true);
        if settled.as_ref().is_some_and(|witness| witness.left.is_none()) {
            return settled;
        }
        let size = |witness: &Witness| self.bound(witness).size();
        [settled, self.settle(closed, false)].into_iter().flatten().min_by(|a, b| size(a).total_cmp(&size(b)))
    }

    /// A feasible point at which the closed rows are at their gaps: their equilibrium, or with the forces of the answer.
    fn settle(&self, closed: &[bool], in_equilibrium: bool) -> Option<Witness> {
        let rows = self.rows.len();
        let mut closed = closed.to_vec();
        let mut first = vec![false; rows];
        for exchange in 0..=rows {
            // The deepest first: of two rows that contradict each other as equalities the tighter one is kept.
            let mut set: Vec<usize> = (0..rows).filter(|&row| closed[row]).collect();
            set.sort_by(|&a, &b| {
                (first[b], self.violation[b])
                    .partial_cmp(&(first[a], self.violation[a]))
                    .unwrap_or(std::cmp::Ordering::Equal)
            });
            let base = match in_equilibrium {
                // Open rows lose their forces.
                true => {
                    let dropped = |row: usize| if closed[row] { 0.0 } else { -self.multiplier[row] };
                    Force::new(1.0, (0..rows).map(dropped).collect())
                }
                false => Force::new(0.0, vec![0.0; rows]),
            };
            let fitted = self.fit(&set, &base)?;
            let Fitted { change, steps, distance, tolerance, triangle } = &fitted;
            let independent = triangle.independent();
            let violated: Vec<usize> =
                (0..rows).filter(|&row| !closed[row] && distance[row] > tolerance[row]).collect();
            let missed = |row: usize| closed[row] && distance[row].abs() > tolerance[row];
            let follows: Vec<usize> = set
                .iter()
                .zip(independent)
                .filter(|entry| !entry.1 && missed(*entry.0))
                .map(|entry| *entry.0)
                .collect();
            let (deeper, looser): (Vec<usize>, Vec<usize>) = follows.iter().partition(|&&row| distance[row] > 0.0);
            let pulling: Vec<usize> = match in_equilibrium {
                true => set.iter().copied().filter(|&row| self.multiplier[row] + change[row] > 0.0).collect(),
                false => Vec::new(),
            };
            let is_met = violated.is_empty() && deeper.is_empty() && looser.is_empty();
            if is_met && (pulling.is_empty() || exchange >= EXCHANGES) {
                let has_dependent = first.iter().any(|&first| first) || independent.contains(&false);
                let error = base.plus(change, steps);
                return Some(Witness {
                    rest: self.rest(&set, &fitted),
                    has_dependent,
                    ..self.witness(error, change, &closed, in_equilibrium)
                });
            }
            if deeper.iter().any(|&row| first[row]) {
                return None;
            }
            deeper.iter().for_each(|&row| first[row] = true);
            violated.iter().for_each(|&row| closed[row] = true);
            looser.iter().filter(|_| deeper.is_empty()).for_each(|&row| closed[row] = false);
            // The force of a looser row goes to others, which may pull no more then.
            if exchange < EXCHANGES && looser.is_empty() {
                pulling.iter().for_each(|&row| closed[row] = false);
            }
        }
        None
    }

    /// The witness of rows that are at their gaps under the force `error`, a `change` of the multipliers included.
    fn witness(&self, error: Force, change: &[f64], closed: &[bool], in_equilibrium: bool) -> Witness {
        let balanced = |row: usize| self.multiplier[row] + if in_equilibrium { change[row] } else { 0.0 };
        // What pulls is no multiplier.
        let multiplier: Vec<f64> =
            (0..change.len()).map(|row| if closed[row] { balanced(row).min(0.0) } else { 0.0 }).collect();
        let left = |row: usize| match in_equilibrium {
            true if closed[row] => -balanced(row).max(0.0),
            true => 0.0,
            false => multiplier[row] - self.multiplier[row] - change[row],
        };
        let rows = (0..change.len()).map(left).collect();
        let pushes = |row: usize| multiplier[row] < 0.0;
        let change = (0..change.len()).map(|row| if in_equilibrium && pushes(row) { change[row] } else { 0.0 });
        let (change, left, closed) = (change.collect(), Force::new(1.0 - error.alpha, rows), closed.to_vec());
        let first = (0..closed.len()).map(|row| if pushes(row) { self.multiplier[row] } else { 0.0 }).collect();
        let rest = vec![0.0; closed.len()];
        Witness { error, left, multiplier, first, change, closed, rest, has_dependent: false }
    }

    /// For each row an upper bound on the energy norm of the motion that puts it exactly at its gap, from where a fit has left it, and
    /// does not move the others of the set; zero for rows that follow from others.
    ///
    /// The motions of all rows together put every row at its gap, so that their lengths, added up, bound the way to such a point,
    /// whatever the signs of what rounding left of the distances. A row that the triangle keeps stands 64 units in the last place
    /// across those before it: rounding of its column changes the lengths by a small share.
    fn rest(&self, set: &[usize], fitted: &Fitted) -> Vec<f64> {
        let mut rest = vec![0.0; self.rows.len()];
        for (&row, length) in set.iter().zip(fitted.triangle.lengths_of_inverse()) {
            let motion = (fitted.distance[row].abs() + fitted.tolerance[row]) * length;
            rest[row] = ldexp(motion * motion, self.norm.factor()).sqrt();
        }
        rest
    }

    /// The multipliers that put the rows of `set` at their gaps beside the force `base`; `None` where there is no time.
    fn fit(&self, set: &[usize], base: &Force) -> Option<Fitted> {
        let half = |&row: &usize| if self.norm.is_over() { None } else { Some(self.half(row)) };
        let columns: Vec<&[f64]> = set.iter().map(half).collect::<Option<_>>()?;
        let Triangle { r: triangle, weights } = triangle_of(&columns, || self.norm.is_over())?;
        let (mut change, mut steps) = (vec![0.0; self.rows.len()], vec![0.0; self.rows.len()]);
        let mut moved = self.boundary.backward(self.sweep(base));
        let mut correction = 0;
        loop {
            let terms = |row: usize| self.rows[row].iter().map(|&(place, b)| b * moved[place]);
            let distance: Vec<f64> =
                (0..self.rows.len()).map(|row| self.violation[row] + terms(row).sum::<f64>()).collect();
            let rounding = |row: usize| {
                DISTANCE_ROUNDING * terms(row).fold(self.violation[row].abs(), |sum, term| sum + term.abs())
            };
            let mut tolerance: Vec<f64> = (0..self.rows.len()).map(rounding).collect();
            // A row that follows from others is at its gap as far as they are.
            for (&row, weights) in set.iter().zip(&weights) {
                let of_others = weights.iter().zip(set).map(|(weight, &other)| weight.abs() * tolerance[other]);
                tolerance[row] += FOLLOWS * of_others.sum::<f64>();
            }
            let is_met = |(&row, &kept): (&usize, &bool)| !kept || distance[row].abs() <= tolerance[row];
            if set.iter().zip(triangle.independent()).all(is_met) || correction == CORRECTIONS {
                return Some(Fitted { change, steps, distance, tolerance, triangle });
            }
            correction += 1;
            let step = triangle.solve_normal(set.iter().map(|&row| -distance[row]).collect());
            let mut added = vec![0.0; self.rows.len()];
            set.iter().zip(step).for_each(|(&row, step)| added[row] = step);
            change.iter_mut().zip(&added).for_each(|(sum, step)| *sum += step);
            // The motions are those of the forces but for the rounding of each step, however much the steps take from each other.
            steps.iter_mut().zip(&added).for_each(|(sum, step)| *sum += step.abs());
            moved.iter_mut().zip(self.boundary.backward(self.spread(&added))).for_each(|(sum, step)| *sum += step);
        }
    }
}

/// Rows after a fit: the change of each multiplier, distances and what is rounding of them, and the triangle of the rows of the
/// set.
struct Fitted {
    change: Vec<f64>,
    /// The magnitudes of the steps that it was added up from.
    steps: Vec<f64>,
    distance: Vec<f64>,
    tolerance: Vec<f64>,
    triangle: UpperTriangle,
}
