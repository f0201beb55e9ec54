//! The dual active-set method for strictly convex problems: the last resort, slow and robust.
//!
//! It starts from the free point and repeatedly closes the row that is violated most. A row closes by a step in its
//! pressure; closed rows with a pressure that falls to zero in the step open. In every set the rows are independent and
//! all push, so that equal or dependent rows, and rows that are nearly parallel in energy, do no harm, and the dual
//! energy grows from set to set.
//!
//! ```text
//! base (u, y) = 0
//! repeat   pass: from the base to the nearest point of the polyhedron
//!          corrections of (u, y) on the set found, with accurate residuals
//! until all rows are met, by their accurate distances
//! ```
//!
//! A proximal term makes a semidefinite K definite. Corrections and passes remove it: they start from the last answer.
//!
//! # Source
//! D. Goldfarb and A. Idnani, 1983, "A numerically stable dual method for solving strictly convex quadratic programs",
//! Mathematical Programming 27, pp. 1-33.

mod polyhedron;

use std::collections::HashSet;

use super::{Ending, Outcome, ScaledProblem};
use crate::error::{Error, Result};
use crate::linear::watch::Watch;
use crate::linear::{Augmented, dot, largest, norm};
use crate::problem::ContactProblem;
use crate::solution::Iteration;
use polyhedron::{Basis, DEPENDENT_ROW, Polyhedron};

/// Largest number of passes: the second corrects what rounding hid in the first if dofs differ much in scale.
const MOST_PASSES: usize = 10;

/// Least number of corrections of one set. The first gains all digits except the last, unless a part is so soft that
/// its energy is below the rounding of the others.
const CORRECTIONS: usize = 3;

/// Largest number of corrections of one set: a proximal term may need more.
const MOST_CORRECTIONS: usize = 30;

/// Another correction is worth its time if this one is below this share of the one before.
const SHRINKS: f64 = 0.5;

/// A change below this share of the free point is negligible, even if the answer is zero.
const NO_CHANGE: f64 = f64::EPSILON * f64::EPSILON;

/// A set with a last correction above this share of the answer has not converged.
const CONVERGED: f64 = 1e-10;

/// Rows are met to this number of units in the last place of their terms.
const ROW_MET: f64 = 4.0 * f64::EPSILON;

/// A violation below this number of units in the last place of the terms is rounding. The next pass, with accurate
/// distances, makes any value up to 1e-4 give the same sets.
const VIOLATED: f64 = 16.0 * f64::EPSILON;

/// A contradiction counts if a point that meets the rows would be this many times farther away than the rows and the
/// free point are. Rows that depend on each other except for the rounding of their entries are met 1e16 times as far
/// away.
const FAR_MEETING: f64 = 1e22;

/// Corrected weights below this share of the largest are zero except for rounding.
const NO_WEIGHT: f64 = 1e-24;

/// Corrections of the weights: the first gains all digits except the last, the second and the third as many again.
const WEIGHT_CORRECTIONS: usize = 3;

/// As [`ContactProblem::dual_active_set`].
pub fn dual_active_set(problem: &ContactProblem, is_definite: bool) -> Result<Outcome> {
    let (augmented, compliance) = (&Augmented::new(problem.stiffness(), problem.contact(), None, 1), None);
    let (swept_load, factor_seconds, watch) = Default::default();
    let scaled = ScaledProblem { problem, is_definite, augmented, compliance, swept_load, factor_seconds, watch };
    solve(&scaled)?.ok_or(Error::NotCondensed { step: "the dual active set" })
}

/// Solves a scaled problem, or finds a contradiction. `None` without a factor, or if a dense basis would be too large.
///
/// The answer is not settled if the method was cut short, or its corrections do not converge: it makes no claim.
pub fn solve(scaled: &ScaledProblem) -> Result<Option<Outcome>> {
    let Some(polyhedron) = Polyhedron::of(scaled)? else { return Ok(None) };
    let [pressures, rests, carried, distances] = [(); 4].map(|()| vec![0.0; scaled.problem.rows()]);
    let [displacement, point, target, change] = [(); 4].map(|()| vec![0.0; scaled.problem.dofs()]);
    let mut search = Search {
        polyhedron: &polyhedron,
        basis: Basis::default(),
        history: Vec::new(),
        given_up: HashSet::new(),
        pressures,
        rests,
        carried,
        distances,
        displacement,
        point,
        target,
        change,
    };
    let (mut seen, mut ending) = (HashSet::new(), Ending::Unsettled);
    for _ in 0..MOST_PASSES {
        let is_met = match search.pass(&scaled.watch) {
            Ok(is_met) => is_met,
            Err(contradiction) => {
                ending = contradiction;
                break;
            }
        };
        let converged = search.correct();
        ending = Ending::of(!search.violates() && is_met && converged);
        let pulls = search.pressures.iter().any(|&pressure| pressure < 0.0);
        // A set that returns once would return in every further pass.
        let is_last = ending == Ending::Settled && !pulls || scaled.watch.is_over();
        if is_last || !seen.insert(search.basis.set(scaled.problem.rows())) {
            break;
        }
    }
    let Search { basis, pressures, history, displacement, .. } = search;
    let (displacement, multiplier) = polyhedron.expand(&displacement, &pressures);
    let (contact_set, iterations) = (basis.set(scaled.problem.rows()), history.len());
    let variant = if ending == Ending::Settled { "-dual" } else { "-dual-unsettled" };
    Ok(Some(Outcome { displacement, multiplier, contact_set, iterations, history, ending, variant }))
}

/// The best answer so far, in the units of the polyhedron, with the pass from there to the nearest point.
struct Search<'a> {
    polyhedron: &'a Polyhedron,
    basis: Basis,
    /// The sets of all passes so far.
    history: Vec<Iteration>,
    /// Rows that depend on closed ones and cannot be met, but do not prove a contradiction.
    given_up: HashSet<usize>,
    /// The pressures y = -lambda of all rows, as sums of two numbers: positive on closed rows, zero on open ones.
    pressures: Vec<f64>,
    /// The parts of the pressures of closed rows beyond double precision: if large pressures cancel on a soft dof,
    /// their rounding would exceed all other forces there. A pass does not change them.
    rests: Vec<f64>,
    /// The pressures of the base of a pass, which its target does not contain.
    carried: Vec<f64>,
    /// Distances of the base from all rows.
    distances: Vec<f64>,
    displacement: Vec<f64>,
    /// L' u.
    point: Vec<f64>,
    /// The free point, minus the closed rows under their pressures at the base.
    target: Vec<f64>,
    /// The change w of the point in a pass.
    change: Vec<f64>,
}

impl Search<'_> {
    /// The imbalance `L^-1 (f - B'y - K u)`, and the distances of the rows, both from accurate sums.
    fn residuals(&self) -> (Vec<f64>, Vec<f64>) {
        let problem = &self.polyhedron.problem;
        let forces = [negative(&self.pressures), negative(&self.rests)];
        let imbalance = problem.accurate_balance(&self.displacement, &[&forces[0], &forces[1]]).residual;
        (self.polyhedron.factor.forward(&imbalance), negative(&problem.accurate_violation(&self.displacement)))
    }

    /// One pass from the answer so far: `true` if all rows are met, `false` if it was cut short, or returned to a set
    /// because rounding decides; an error for rows that contradict each other, with verified weights. The basis is
    /// computed from the data again, without the errors of its updates.
    fn pass(&mut self, watch: &Watch) -> Result<bool, Ending> {
        (self.target, self.distances) = self.residuals();
        self.carried.fill(0.0);
        self.basis.rows.iter().for_each(|&row| self.carried[row] = self.pressures[row]);
        self.given_up.clear();
        self.open_pulling();
        let is_met = self.close_violated(watch)?;
        self.advance(&self.change.clone());
        self.basis = of_rows(self.polyhedron, &self.basis.rows);
        Ok(is_met)
    }

    fn advance(&mut self, change: &[f64]) {
        self.point.iter_mut().zip(change).for_each(|(entry, change)| *entry += change);
        let moved = self.polyhedron.factor.backward(change.to_vec());
        self.displacement.iter_mut().zip(&moved).for_each(|(u, moved)| *u += moved);
    }

    /// The changes of point and pressures that balance the forces with the closed rows at their gaps.
    fn correction(&self, imbalance: &[f64], distances: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let on_closed: Vec<f64> = self.basis.rows.iter().map(|&row| distances[row]).collect();
        self.basis.nearest(imbalance, &on_closed)
    }

    /// Corrects the answer on its set until another correction gains nothing. Returns `true` if it converges.
    fn correct(&mut self) -> bool {
        let mut last = f64::INFINITY;
        for turn in 0..MOST_CORRECTIONS {
            let (imbalance, distances) = self.residuals();
            let (change, changes) = self.correction(&imbalance, &distances);
            let step = norm(&change);
            if turn >= CORRECTIONS && step > SHRINKS * last {
                break;
            }
            self.advance(&change);
            let Search { basis, pressures, rests, .. } = self;
            for (&row, change) in basis.rows.iter().zip(&changes) {
                let (before, change) = (pressures[row], rests[row] + change);
                pressures[row] = before + change;
                rests[row] = change - (pressures[row] - before);
            }
            last = step;
            if step <= NO_CHANGE * self.polyhedron.reach {
                break;
            }
        }
        last <= CONVERGED * norm(&self.point)
    }

    /// Returns `true` if an open row is violated beyond rounding. A violation within the rounding of the closed rows
    /// does not count: otherwise two rows that differ by their scale only would be exchanged without end.
    fn violates(&self) -> bool {
        let problem = &self.polyhedron.problem;
        let distances = negative(&problem.accurate_violation(&self.displacement));
        let at_rest = vec![0.0; self.displacement.len()];
        let (to_closed, _) = self.correction(&at_rest, &distances);
        let explained = problem.contact().mul(&self.polyhedron.factor.backward(to_closed));
        let terms = problem.contact().mul_abs(&self.displacement);
        let violation = |row: usize| explained[row] - distances[row];
        (0..distances.len()).any(|row| violation(row) > ROW_MET * (terms[row] + problem.gap()[row].abs()))
    }

    /// Opens rows until all closed ones push: the method needs such a set to start.
    fn open_pulling(&mut self) {
        loop {
            self.balance();
            let rows = self.basis.rows.iter().enumerate();
            let pulling = rows.map(|(place, &row)| (place, self.pressures[row])).filter(|entry| entry.1 < 0.0);
            match pulling.min_by(|a, b| a.1.total_cmp(&b.1)) {
                Some((place, _)) => self.open(place),
                None => return,
            }
        }
    }

    /// Closes and opens rows until none is violated.
    fn close_violated(&mut self, watch: &Watch) -> Result<bool, Ending> {
        let mut seen = HashSet::new();
        while let Some((row, violation)) = self.most_violated() {
            if watch.is_over() || !self.polyhedron.affords(self.basis.rows.len()) {
                return Ok(false);
            }
            watch.step("dual active set", self.history.len() + 1);
            if self.close(row, violation)? {
                let closed = self.basis.set(self.distances.len());
                self.history.push(Iteration { contact_set: closed.clone(), penalty: 0.0 });
                if !seen.insert(closed) {
                    return Ok(false);
                }
            } else {
                self.given_up.insert(row);
            }
        }
        Ok(true)
    }

    /// Point and pressures of the closed rows, from the data.
    fn balance(&mut self) {
        let (change, changes) = self.correction(&self.target, &self.distances);
        self.change = change;
        for (&row, change) in self.basis.rows.iter().zip(&changes) {
            self.pressures[row] = self.carried[row] + change;
        }
    }

    fn open(&mut self, place: usize) {
        let row = self.basis.rows[place];
        self.basis.open(place);
        self.pressures[row] = 0.0;
        let carried = [std::mem::take(&mut self.carried[row]), std::mem::take(&mut self.rests[row])];
        if carried != [0.0; 2] {
            let direction = self.polyhedron.row(row);
            let relieved = |c: f64| carried[0] * c + carried[1] * c;
            self.target.iter_mut().zip(&direction).for_each(|(entry, &c)| *entry += relieved(c));
        }
    }

    fn most_violated(&self) -> Option<(usize, f64)> {
        let moved = self.polyhedron.problem.contact().mul(&self.polyhedron.factor.backward(self.change.clone()));
        let size = norm(&self.change) + norm(&self.target);
        let violated = |row: usize| {
            let violation = moved[row] - self.distances[row];
            let rounding = VIOLATED * (self.polyhedron.lengths[row] * size + self.distances[row].abs());
            (violation > rounding && !self.given_up.contains(&row)).then_some((row, violation))
        };
        (0..moved.len()).filter_map(violated).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Closes `row`, and opens rows whose pressure falls to zero. Returns `false` if the row cannot be met.
    fn close(&mut self, row: usize, mut violation: f64) -> Result<bool, Ending> {
        let before = self.basis.rows.to_vec();
        let direction = self.polyhedron.row(row);
        loop {
            let split = self.basis.split(&direction);
            let whole = if split.depends { f64::INFINITY } else { violation / dot(&split.across, &split.across) };
            let (step, first) = self.blocking(&split.weights);
            if whole <= step && whole.is_finite() {
                self.basis.close(row, split);
                self.balance();
                return Ok(true);
            }
            let Some(place) = first else {
                self.check_contradiction(row, &split.weights)?;
                // Back to the set that was closed before.
                self.pressures.fill(0.0);
                self.basis = of_rows(self.polyhedron, &before);
                self.balance();
                return Ok(false);
            };
            for (&closed, weight) in self.basis.rows.iter().zip(&split.weights) {
                self.pressures[closed] = (self.pressures[closed] - step * weight).max(0.0);
            }
            if !split.depends {
                violation -= step * dot(&split.across, &split.across);
            }
            self.open(place);
        }
    }

    /// The largest step before the pressure of a closed row falls to zero, and the place of that row.
    fn blocking(&self, weights: &[f64]) -> (f64, Option<usize>) {
        let rounding = DEPENDENT_ROW * (1.0 + largest(weights));
        let mut first = (f64::INFINITY, None);
        for (place, (&row, &weight)) in self.basis.rows.iter().zip(weights).enumerate() {
            let step = self.pressures[row].max(0.0) / weight;
            if weight > rounding && step < first.0 {
                first = (step, Some(place));
            }
        }
        first
    }

    /// Checks that `row` does not contradict the closed rows. It does if, under the weights y (1 for it, -r for them),
    /// the rows overlap, `-g'y > 0`, and their combination, `delta = |L^-1 B'y|`, is so small that a point which meets
    /// all rows is absurdly far away. Rows that depend on each other except for the rounding of their entries are met
    /// far away, and do not contradict each other: weights in twice the working precision distinguish the two cases.
    fn check_contradiction(&self, row: usize, shares: &[f64]) -> Result<(), Ending> {
        let Polyhedron { problem, lengths, reach, .. } = self.polyhedron;
        let mut weights = vec![0.0; problem.rows()];
        weights[row] = 1.0;
        self.basis.rows.iter().zip(shares).for_each(|(&closed, share)| weights[closed] = (-share).max(0.0));
        let mut rest = vec![0.0; problem.rows()];
        let left =
            |weights: &[f64], rest: &[f64]| self.polyhedron.factor.forward(&self.polyhedron.force(weights, rest));
        for _ in 0..WEIGHT_CORRECTIONS {
            let change = self.basis.triangle.solve_upper(self.basis.along(&left(&weights, &rest)));
            for (&closed, change) in self.basis.rows.iter().zip(&change) {
                let weight = rest[closed] - change;
                let sum = (weights[closed] + weight).max(0.0);
                (rest[closed], weights[closed]) =
                    if sum > 0.0 { (weight - (sum - weights[closed]), sum) } else { (0.0, 0.0) };
            }
        }
        let left = norm(&left(&weights, &rest));
        let tiny = NO_WEIGHT * largest(&weights);
        let (rows, weights): (Vec<usize>, Vec<f64>) =
            weights.into_iter().enumerate().filter(|entry| entry.1 > tiny).unzip();
        // The largest weight is the unit of the overlap.
        let overlap = problem.overlap(&rows, &weights).map_or(0.0, |overlap| overlap * largest(&weights));
        let nearest = rows.iter().map(|&row| problem.gap()[row].abs() / lengths[row]).fold(0.0, f64::max);
        let far = FAR_MEETING * (reach + nearest + norm(&self.point) + norm(&self.change));
        if overlap > 0.0 && overlap > left * far {
            return Err(self.polyhedron.contradiction(rows, &weights));
        }
        Ok(())
    }
}

/// The basis of rows that do not depend on each other, from the data.
fn of_rows(polyhedron: &Polyhedron, rows: &[usize]) -> Basis {
    let mut basis = Basis::default();
    for &row in rows {
        let split = basis.split(&polyhedron.row(row));
        basis.close(row, split);
    }
    basis
}

fn negative(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| -value).collect()
}
