//! A repaired answer on the contact boundary: its shifts, forces and bound.

use super::super::energy_norm::{Boundary, RowsOnBoundary};
use super::{Answer, EnergyNorm, ErrorBound, add_sizes, shift_length};
use crate::linear::{AT_ONCE, SparseMatrix, dot, ldexp};

/// Rounding of a sum of forces, in units of its terms; a factor multiplies it by its [loss](EnergyNorm::loss).
const CANCELLED: f64 = 4.0 * f64::EPSILON;

/// The way of rows to their gaps counts as a shift, as the residual of that shift, and for the rounding of its length.
const COUNTS: f64 = 3.0;

/// The force `alpha r + B' x`, x in the units of normalised rows.
pub struct Force {
    pub alpha: f64,
    pub rows: Vec<f64>,
    /// Magnitudes of the terms of x, the scale of rounding of their sum.
    pub terms: Vec<f64>,
}

impl Force {
    pub fn new(alpha: f64, rows: Vec<f64>) -> Self {
        let terms = rows.iter().map(|x| x.abs()).collect();
        Force { alpha, rows, terms }
    }

    /// The force with more of each row, added up from steps of the magnitudes `steps`.
    pub fn plus(&self, more: &[f64], steps: &[f64]) -> Self {
        let rows = self.rows.iter().zip(more).map(|(a, b)| a + b).collect();
        let terms = self.terms.iter().zip(steps).map(|(a, b)| a + b).collect();
        Force { alpha: self.alpha, rows, terms }
    }
}

/// A feasible v and multipliers mu: `v - u = K^-1 error`, and the forces left out of balance at (v, mu).
pub struct Witness {
    pub error: Force,
    pub left: Force,
    /// The multipliers mu, rounded: those of the answer, if they push, plus the change.
    pub multiplier: Vec<f64>,
    /// What is added to the multipliers of the answer; of a row that passes forces on or takes them, mu itself.
    pub change: Vec<f64>,
    pub passes: Vec<bool>,
    pub closed: Vec<bool>,
    /// For each closed row an upper bound on the energy norm of the shift that puts it exactly at its gap and leaves
    /// the other closed rows there.
    pub rest: Vec<f64>,
    /// For each row that follows from others an upper bound on its force times its distance to its gap.
    pub slack: Vec<f64>,
    /// `true` if (v, mu) is the equilibrium of the closed rows, none of them pulls, and none is on a loose dof.
    pub is_equilibrium: bool,
    /// `true` if a row counts as met by rounding: a closed row that follows from others, or an open one at its gap.
    pub is_rounded: bool,
}

/// An answer on the contact boundary, in equilibrated units, rows normalised by powers of two.
pub struct Repair<'a> {
    pub norm: &'a EnergyNorm,
    pub boundary: &'a Boundary,
    pub answer: &'a Answer<'a>,
    rows: RowsOnBoundary,
    pub violation: Vec<f64>,
    /// g of each row, in the units of `violation`; infinite without an obstacle.
    pub gap: Vec<f64>,
    pub multiplier: Vec<f64>,
    /// The sweep of the residual: squares of the interior, and the boundary.
    interior: f64,
    swept: Vec<f64>,
}

impl<'a> Repair<'a> {
    /// `None` if the boundary is not known, or if a row reaches beyond it.
    pub fn new(norm: &'a EnergyNorm, answer: &'a Answer<'a>) -> Option<Self> {
        let boundary = norm.boundary.as_deref()?;
        // A row without obstacle and without force may reach beyond the boundary.
        let counts = |row: usize| answer.problem.gap[row].is_finite() || answer.multiplier[row] != 0.0;
        let rows = norm.rows_on_boundary(&answer.problem.contact, counts)?;
        let scaled = |values: &[f64], sign: i32, unit: i32| -> Vec<f64> {
            values.iter().zip(&rows.shift).map(|(&value, &shift)| ldexp(value, sign * shift - unit)).collect()
        };
        let unit = norm.equilibration.factor;
        let (violation, multiplier) = (scaled(&answer.violation, 1, unit), scaled(answer.multiplier, -1, 0));
        let gap = scaled(&answer.problem.gap, 1, unit);
        let (interior, swept) = norm.sweep(&answer.residual);
        Some(Repair { norm, boundary, answer, rows, violation, gap, multiplier, interior, swept })
    }

    pub fn count(&self) -> usize {
        self.rows.shift.len()
    }

    /// The rows on the contact boundary, each a column.
    pub fn by_row(&self) -> &SparseMatrix {
        self.rows.compliance.by_row()
    }

    /// The sweep of forces along the rows, on the boundary.
    pub fn spread(&self, weights: &[f64]) -> Vec<f64> {
        if weights.iter().all(|&weight| weight == 0.0) {
            return vec![0.0; self.boundary.block.size()];
        }
        self.boundary.block.forward(self.by_row().mul(weights))
    }

    pub fn product(&self, a: usize, b: usize) -> f64 {
        self.rows.compliance.product(a, b)
    }

    /// The columns of W of these rows; `None` if there is no time.
    pub fn halves(&self, rows: &[usize]) -> Option<Vec<&[f64]>> {
        for some in rows.chunks(AT_ONCE) {
            if self.norm.is_over() {
                return None;
            }
            self.rows.compliance.find(some);
        }
        Some(rows.iter().map(|&row| self.rows.compliance.half(row)).collect())
    }

    pub fn sweep(&self, force: &Force) -> Vec<f64> {
        let mut sweep = self.spread(&force.rows);
        sweep.iter_mut().zip(&self.swept).for_each(|(entry, swept)| *entry += force.alpha * swept);
        sweep
    }

    /// The energy norm of the shift that a force causes.
    fn length(&self, force: &Force) -> f64 {
        let sweep = self.sweep(force);
        self.norm.length(force.alpha * force.alpha * self.interior + dot(&sweep, &sweep))
    }

    /// The energy norm of the shift that a unit force along a row causes.
    fn reach(&self, row: usize) -> f64 {
        if self.norm.is_over() {
            return f64::INFINITY;
        }
        self.norm.length(self.product(row, row))
    }

    fn shift(&self, force: &Force) -> Vec<f64> {
        let contact = self.answer.problem.contact.mul_transposed(&self.expanded(&force.rows));
        let total: Vec<f64> = self.answer.residual.iter().zip(contact).map(|(r, b)| force.alpha * r + b).collect();
        self.norm.displacement(&total)
    }

    /// The displacements and multipliers of a witness, in the units of the problem.
    pub fn answer(&self, witness: &Witness) -> (Vec<f64>, Vec<f64>) {
        let shift = self.shift(&witness.error);
        let moved = self.answer.displacement.iter().zip(shift).map(|(u, d)| u + d).collect();
        (moved, self.expanded(&witness.multiplier))
    }

    pub fn bound(&self, witness: &Witness) -> ErrorBound {
        let Witness { error, left, multiplier, closed, rest, .. } = witness;
        let of_left = self.length(left);
        let springs = self.norm.springs.as_deref();
        let cancelled = if springs.is_some() { self.cancelled(witness) } else { 0.0 };
        // A force that is the rounding of changes of the answer's force holds nothing.
        let terms = |row: usize| self.multiplier[row].abs() + error.terms[row] + left.terms[row];
        let force = |row: usize| if closed[row] { -multiplier[row] - CANCELLED * terms(row) } else { 0.0 };
        let force = self.expanded(&(0..rest.len()).map(force).collect::<Vec<_>>());
        // Neither does one that what is out of balance, springs included, is rounded by.
        if springs.is_some_and(|springs| !springs.hold(closed, |row| force[row], |_| of_left + cancelled)) {
            return ErrorBound::none();
        }
        // Closed rows are put exactly at their gaps, which moves the answer; forces that cancel leave rounding.
        let put: Vec<f64> =
            (0..rest.len()).map(|row| self.way_on(witness, row) + self.cancelled_on(witness, row)).collect();
        let of_error = match springs {
            // The energy of the springs is no error, but it adds rounding.
            Some(_) => {
                shift_length(self.answer.problem, &self.shift(error))
                    + (self.norm.rounding() - 1.0) * self.length(error)
            }
            None => self.length(error),
        };
        let whole = of_error + of_left + put.iter().sum::<f64>();
        let parts = self.answer.problem.parts();
        let of_parts = (parts.count() > 1).then(|| {
            let mut sizes = vec![0.0; parts.count()];
            put.iter().enumerate().for_each(|(row, put)| sizes[parts.of_row[row]] += put);
            [error, left].iter().for_each(|force| add_sizes(self.answer.problem, &self.shift(force), &mut sizes));
            sizes
        });
        ErrorBound { whole, of_parts }
    }

    /// Upper bound, in energy norm, of what the way of a row to its gap adds, put there or following from others.
    fn way_on(&self, witness: &Witness, row: usize) -> f64 {
        COUNTS * witness.rest[row] + self.norm.length(2.0 * witness.slack[row])
    }

    /// Upper bound, in energy norm, of the rounding of forces that cancel each other on this row.
    fn cancelled_on(&self, witness: &Witness, row: usize) -> f64 {
        let terms = witness.error.terms[row] + witness.left.terms[row];
        if terms > 0.0 { CANCELLED * self.norm.loss() * terms * self.reach(row) } else { 0.0 }
    }

    /// The sum of `cancelled_on` over all rows and the residual.
    fn cancelled(&self, witness: &Witness) -> f64 {
        let alpha = witness.error.alpha.abs() + witness.left.alpha.abs();
        let residual = self.length(&Force::new(alpha, vec![0.0; self.count()]));
        let of_residual = CANCELLED * self.norm.loss() * residual;
        (0..self.count()).map(|row| self.cancelled_on(witness, row)).fold(of_residual, |sum, of_row| sum + of_row)
    }

    /// What another repair can make smaller in a bound: rounding of forces that cancel, and of the way to the gaps.
    pub fn vague(&self, witness: &Witness) -> f64 {
        self.cancelled(witness) + (0..self.count()).map(|row| self.way_on(witness, row)).sum::<f64>()
    }

    /// Forces on the rows in the units of the problem.
    pub fn expanded(&self, multiplier: &[f64]) -> Vec<f64> {
        multiplier.iter().zip(&self.rows.shift).map(|(&mu, &shift)| ldexp(mu, shift)).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::certificate::energy_norm::Springs;
    use crate::problem::ContactProblem;

    /// Rounding of a repair of one or two dofs.
    const ROUNDING: f64 = 1e-12;

    #[test]
    fn a_spring_behind_its_wall_is_repaired_by_its_penetration() {
        // K = 4, f = 8, g = 1; u = 3/2 under a force of 3 leaves -1 out of balance. The repair is u = 1 under 4.
        let problem = ContactProblem::of_entries(&[(0, 0, 4.0)], &[8.0], &[(0, 0, 1.0)], &[1.0]);
        let norm = EnergyNorm::of(problem.stiffness(), problem.contact()).unwrap().unwrap();
        let answer = Answer::of(&problem, &[1.5], &[-3.0]);
        assert_eq!((&answer.residual[..], &answer.violation[..]), (&[-1.0][..], &[0.5][..]));
        let repair = Repair::new(&norm, &answer).unwrap();
        let witness = repair.best_witness(&[true]).unwrap();
        let (moved, multiplier) = repair.answer(&witness);
        assert!((moved[0] - 1.0).abs() < ROUNDING, "{moved:?}");
        let change = repair.expanded(&witness.change);
        assert!((multiplier[0] + 3.0).abs() < ROUNDING || (multiplier[0] + 4.0).abs() < ROUNDING, "{multiplier:?}");
        assert!((change[0] + 1.0).abs() < ROUNDING, "{change:?}");
        // A way of 1/2 against a stiffness of 4.
        assert!((repair.bound(&witness).whole - 1.0).abs() < ROUNDING, "{:?}", repair.bound(&witness));
        // The residual and the change of the force, one each, move the spring by 1/2 in energy norm each.
        assert!((repair.cancelled(&witness) / CANCELLED - 1.0).abs() < ROUNDING, "{:e}", repair.cancelled(&witness));
        assert!(repair.vague(&witness) < ROUNDING && !witness.is_rounded, "{:e}", repair.vague(&witness));
        // A distance that is left to the gap counts for the answer, for its residual and for its rounding.
        let open = Witness { rest: vec![0.25], ..witness };
        assert!((repair.bound(&open).whole - (1.0 + 3.0 * 0.25)).abs() < ROUNDING, "{:?}", repair.bound(&open));
        // If the force stays 3, a force of 1 is left at the gap; it moves the spring by 1/4, 1/2 in energy norm.
        let kept = repair.settle(&[true], false).unwrap();
        assert!((repair.bound(&kept).whole - 1.5).abs() < ROUNDING, "{:?}", repair.bound(&kept));
    }

    #[test]
    fn a_residual_loses_the_digits_that_a_factor_loses() {
        // Two dofs coupled by nearly their stiffness, out of balance by one each: K (1, 1) = (1, 1) slack.
        let slack = 1e-3;
        let stiffness = [(0, 0, 1.0), (1, 0, slack - 1.0), (1, 1, 1.0)];
        let problem = ContactProblem::of_entries(&stiffness, &[1.0, 1.0], &[(0, 0, 1.0), (1, 1, 1.0)], &[9e9, 9e9]);
        let norm = EnergyNorm::of(problem.stiffness(), problem.contact()).unwrap().unwrap();
        let answer = Answer::of(&problem, &[0.0; 2], &[0.0; 2]);
        let repair = Repair::new(&norm, &answer).unwrap();
        let cancelled = repair.cancelled(&repair.settle(&[false; 2], true).unwrap());
        let length = (2.0 / slack).sqrt();
        assert!((cancelled / (CANCELLED * norm.loss() * length) - 1.0).abs() < 1e-9 && norm.loss() > 100.0);
    }

    #[test]
    fn a_row_with_a_spring_holds_by_the_force_that_is_no_rounding_of_its_terms() {
        let problem = ContactProblem::of_entries(&[(0, 0, 4.0)], &[8.0], &[(0, 0, 1.0)], &[1.0]);
        let springs = Springs { stiffness: vec![1.0], are_equalities: vec![false] };
        let mut norm = EnergyNorm::of(problem.stiffness(), problem.contact()).unwrap().unwrap();
        norm.springs = Some(Arc::new(springs));
        let answer = Answer::of(&problem, &[1.0], &[-4.0]);
        let repair = Repair::new(&norm, &answer).unwrap();
        let holds = |terms: [f64; 2]| {
            let mut witness = repair.settle(&[true], true).unwrap();
            [witness.error.terms[0], witness.left.terms[0]] = terms;
            repair.bound(&witness).whole.is_finite()
        };
        // The terms of both forces add up; a force of 4 beside terms of 1e16 is rounding, beside 1e15 it is not.
        assert!(holds([0.0, 0.0]) && holds([5e14, 5e14]));
        for terms in [[1e16, 0.0], [0.0, 1e16], [1e16, 1e16]] {
            assert!(!holds(terms), "{terms:?}");
        }
    }

    #[test]
    fn rows_that_contradict_each_other_have_no_witness_however_far_the_answer_has_travelled() {
        // At 1e15 a distance is rounded by more than 0.1; u <= 1 and -2 u <= -2 meet there, u <= 1 and -2 u <= -2.1 do
        // not. The order of the rows and their units do not matter.
        for (unit, rows) in [(1.0, [0, 1]), (1e9, [0, 1]), (1.0, [1, 0])] {
            let is_met = |second: f64| {
                let mut gaps = [0.0; 2];
                (gaps[rows[0]], gaps[rows[1]]) = (unit, -2.0 * unit * second);
                let problem = ContactProblem::of_entries(
                    &[(0, 0, 4.0)],
                    &[8.0],
                    &[(rows[0], 0, unit), (rows[1], 0, -2.0 * unit)],
                    &gaps,
                );
                let norm = EnergyNorm::of(problem.stiffness(), problem.contact()).unwrap().unwrap();
                let answer = Answer::of(&problem, &[1e15], &[-1.0; 2]);
                let repair = Repair::new(&norm, &answer).unwrap();
                repair.settle(&[true, true], false).is_some()
            };
            assert!(is_met(1.0) && !is_met(1.05) && !is_met(1.0001), "{unit}, {rows:?}");
        }
    }

    #[test]
    fn a_row_that_follows_from_another_passes_its_force_on_as_far_as_the_other_pushes() {
        // A spring of stiffness 4 under a force of 8, 1000 behind a wall at 1. The second row, -2 times the first, has
        // its gap a rounding error away, so that both rows can be closed and lock forces of any size between them.
        let gap = -2.0 * (1.0 - f64::EPSILON);
        let problem = ContactProblem::of_entries(&[(0, 0, 4.0)], &[8.0], &[(0, 0, 1.0), (1, 0, -2.0)], &[1.0, gap]);
        let norm = EnergyNorm::of(problem.stiffness(), problem.contact()).unwrap().unwrap();
        // A force of 4 beside locked forces of 2e6 and 1e6, which go. If the first row does not push enough for that,
        // half of the force of the second stays; all of it does if the first row does not push at all.
        let cases = [([-4.0 - 2e6, -1e6], [-4.0, 0.0]), ([-1e6, -1e6], [0.0, -5e5]), ([5.0, -1e6], [0.0, -1e6])];
        for (multiplier, left) in cases {
            let answer = Answer::of(&problem, &[1001.0], &multiplier);
            let repair = Repair::new(&norm, &answer).unwrap();
            let witness = repair.settle(&[true, true], false).unwrap();
            assert_eq!(repair.expanded(&witness.multiplier), left, "{multiplier:?}");
            // What is passed stands alone, so that the answer of the witness and the sum of its parts are the same.
            assert_eq!(repair.expanded(&witness.change), if witness.passes[1] { left } else { [0.0; 2] });
            // What stays times the rounding of a way of 1000 is slack, and the bound has it.
            let (slack, rounding) = (norm.length(witness.slack[1]).powi(2), 2e3 * f64::EPSILON * left[1].abs());
            assert!(rounding <= slack && slack <= 100.0 * rounding, "{slack:e}, {rounding:e}");
            let (with, none) = (repair.bound(&witness).whole, Witness { slack: vec![0.0; 2], ..witness });
            assert!((with - repair.bound(&none).whole - (2.0 * slack).sqrt()).abs() < ROUNDING * with, "{slack:e}");
        }
    }
}
