//! One pass of the method: from a base point to the nearest point of the polyhedron, row by row.

use std::collections::HashSet;

use super::basis::{Basis, DEPENDENT_ROW};
use super::polyhedron::{Contradiction, Polyhedron};
use crate::linear::watch::Watch;
use crate::linear::{dot, largest, norm};
use crate::solution::Iteration;

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

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Passed {
    /// No row is violated beyond rounding.
    Met,
    /// It was cut short, or it returned to a set because rounding decides.
    Stopped,
}

/// The closed rows with the pressures y = -lambda of all rows, scaled, as sums of two numbers; zero on open rows.
#[derive(Default)]
pub(super) struct Closed {
    pub basis: Basis,
    /// Positive on closed rows.
    pub pressures: Vec<f64>,
    /// The parts of the pressures of closed rows beyond double precision: if large pressures cancel on a soft dof,
    /// their rounding would exceed all other forces there. A pass does not change them.
    pub rests: Vec<f64>,
    /// The sets of all passes so far.
    pub history: Vec<Iteration>,
}

/// The state of a pass: the change w of the point and the pressures y.
pub(super) struct Pass<'a> {
    polyhedron: &'a Polyhedron,
    closed: &'a mut Closed,
    /// The pressures of the base, which the target does not contain.
    carried: Vec<f64>,
    /// The free point, minus the closed rows under their pressures at the base.
    target: Vec<f64>,
    /// Distances of the base from all rows.
    distances: Vec<f64>,
    pub point: Vec<f64>,
    /// Length of the base and of the change, the scale of distances.
    base: f64,
    /// Rows that depend on closed ones and cannot be met, but do not prove a contradiction.
    given_up: HashSet<usize>,
}

impl<'a> Pass<'a> {
    /// A pass from a base of this length with the given imbalance `target` and `distances`, and these rows closed.
    pub fn new(
        polyhedron: &'a Polyhedron,
        closed: &'a mut Closed,
        (target, distances): (Vec<f64>, Vec<f64>),
        base: f64,
    ) -> Self {
        let mut carried = vec![0.0; distances.len()];
        closed.basis.rows().iter().for_each(|&row| carried[row] = closed.pressures[row]);
        let (point, given_up) = (target.clone(), HashSet::new());
        Pass { polyhedron, closed, carried, target, distances, point, base, given_up }
    }

    /// Closes and opens rows until none is violated.
    ///
    /// # Errors
    /// The rows that contradict each other, with verified weights.
    pub fn run(&mut self, watch: &Watch) -> Result<Passed, Contradiction> {
        self.open_pulling();
        let mut seen = HashSet::new();
        while let Some((row, violation)) = self.most_violated() {
            if watch.is_over() || !self.polyhedron.affords(self.closed.basis.rows().len()) {
                return Ok(Passed::Stopped);
            }
            watch.step("dual active set", self.closed.history.len() + 1);
            if self.close(row, violation)? {
                let closed = self.closed.basis.set(self.distances.len());
                self.closed.history.push(Iteration { contact_set: closed.clone(), penalty: 0.0 });
                if !seen.insert(closed) {
                    return Ok(Passed::Stopped);
                }
            } else {
                self.given_up.insert(row);
            }
        }
        Ok(Passed::Met)
    }

    /// Opens rows until all closed ones push: the method needs such a set to start.
    fn open_pulling(&mut self) {
        loop {
            self.balance();
            let rows = self.closed.basis.rows().iter().enumerate();
            let pulling = rows.map(|(place, &row)| (place, self.closed.pressures[row])).filter(|entry| entry.1 < 0.0);
            match pulling.min_by(|a, b| a.1.total_cmp(&b.1)) {
                Some((place, _)) => self.open(place),
                None => return,
            }
        }
    }

    /// Point and pressures of the closed rows, from the data.
    fn balance(&mut self) {
        let distances: Vec<f64> = self.closed.basis.rows().iter().map(|&row| self.distances[row]).collect();
        let (point, change) = self.closed.basis.nearest(&self.target, &distances);
        self.point = point;
        for (&row, change) in self.closed.basis.rows().iter().zip(&change) {
            self.closed.pressures[row] = self.carried[row] + change;
        }
    }

    fn open(&mut self, place: usize) {
        let row = self.closed.basis.rows()[place];
        self.closed.basis.open(place);
        self.closed.pressures[row] = 0.0;
        let carried = [std::mem::take(&mut self.carried[row]), std::mem::take(&mut self.closed.rests[row])];
        if carried != [0.0; 2] {
            let direction = self.polyhedron.row(row);
            let relieved = |c: f64| carried[0] * c + carried[1] * c;
            self.target.iter_mut().zip(&direction).for_each(|(entry, &c)| *entry += relieved(c));
        }
    }

    /// The row that is violated most, and its violation.
    fn most_violated(&self) -> Option<(usize, f64)> {
        let moved = self.polyhedron.problem.contact().mul(&self.polyhedron.displacement(&self.point));
        let size = norm(&self.point) + norm(&self.target);
        let violated = |row: usize| {
            let violation = moved[row] - self.distances[row];
            let rounding = VIOLATED * (self.polyhedron.lengths[row] * size + self.distances[row].abs());
            (violation > rounding && !self.given_up.contains(&row)).then_some((row, violation))
        };
        (0..moved.len()).filter_map(violated).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Closes `row`; opens other rows if their pressure falls to zero in the step. Returns `false` if the row cannot be
    /// met.
    fn close(&mut self, row: usize, mut violation: f64) -> Result<bool, Contradiction> {
        let before = self.closed.basis.rows().to_vec();
        let direction = self.polyhedron.row(row);
        loop {
            let split = self.closed.basis.split(&direction);
            let whole = if split.depends { f64::INFINITY } else { violation / dot(&split.across, &split.across) };
            let (step, first) = self.blocking(&split.weights);
            if whole <= step && whole.is_finite() {
                self.closed.basis.close(row, split);
                self.balance();
                return Ok(true);
            }
            let Some(place) = first else {
                self.check_contradiction(row, &split.weights)?;
                self.restore(&before);
                return Ok(false);
            };
            for (&closed, weight) in self.closed.basis.rows().iter().zip(&split.weights) {
                self.closed.pressures[closed] = (self.closed.pressures[closed] - step * weight).max(0.0);
            }
            if !split.depends {
                violation -= step * dot(&split.across, &split.across);
            }
            self.open(place);
        }
    }

    /// The largest step of the new pressure before the pressure of a closed row falls to zero, and the place of that
    /// row.
    fn blocking(&self, weights: &[f64]) -> (f64, Option<usize>) {
        let rounding = DEPENDENT_ROW * (1.0 + largest(weights));
        let mut first = (f64::INFINITY, None);
        for (place, (&row, &weight)) in self.closed.basis.rows().iter().zip(weights).enumerate() {
            let step = self.closed.pressures[row].max(0.0) / weight;
            if weight > rounding && step < first.0 {
                first = (step, Some(place));
            }
        }
        first
    }

    /// Returns to a set that was closed before.
    fn restore(&mut self, rows: &[usize]) {
        self.closed.pressures.fill(0.0);
        self.closed.basis = of_rows(self.polyhedron, rows);
        self.balance();
    }

    /// Checks that `row` does not contradict the closed rows. It does if, under the weights y (1 for it, -r for them),
    /// the rows overlap, `-g'y > 0`, and their combination, `delta = |L^-1 B'y|`, is so small that a point which meets
    /// all rows is absurdly far away. Rows that depend on each other except for the rounding of their entries are met
    /// far away, and do not contradict each other: weights in twice the working precision distinguish the two cases.
    ///
    /// # Errors
    /// The contradiction, if it does.
    fn check_contradiction(&self, row: usize, shares: &[f64]) -> Result<(), Contradiction> {
        let Polyhedron { problem, lengths, reach, .. } = self.polyhedron;
        let mut weights = vec![0.0; problem.rows()];
        weights[row] = 1.0;
        self.closed.basis.rows().iter().zip(shares).for_each(|(&closed, share)| weights[closed] = (-share).max(0.0));
        let mut rest = vec![0.0; problem.rows()];
        let left = |weights: &[f64], rest: &[f64]| self.polyhedron.of_force(&self.polyhedron.force(weights, rest));
        for _ in 0..WEIGHT_CORRECTIONS {
            let change = self.closed.basis.solve_upper(self.closed.basis.along(&left(&weights, &rest)));
            for (&closed, change) in self.closed.basis.rows().iter().zip(&change) {
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
        let far = FAR_MEETING * (reach + nearest + self.base + norm(&self.point));
        if overlap > 0.0 && overlap > left * far {
            return Err(self.polyhedron.contradiction(rows, &weights));
        }
        Ok(())
    }
}

/// The basis of rows that do not depend on each other, from the data.
pub(super) fn of_rows(polyhedron: &Polyhedron, rows: &[usize]) -> Basis {
    let mut basis = Basis::default();
    for &row in rows {
        let split = basis.split(&polyhedron.row(row));
        basis.close(row, split);
    }
    basis
}
