//! Which rows of a contact set are beyond doubt, from the bound on the energy norm of the error.
//!
//! With `|u - u*|_K <= E` and the compliance `G = B K^-1 B'` of the rows:
//!
//! * `|B_i (u - u*)| <= sqrt(G_ii) E`: a row whose distance is larger is open in the exact answer too.
//! * Let C be all other rows, `r = f + B_C' lambda_C - K u`, and w a motion with `B_i w = 1` that no other row of C feels.
//!   From `B_C' (lambda - lambda*)_C = r + K (u - u*)`: `|lambda_i - lambda*_i| <= |w|_K (|r|_{K^-1} + E)`. A row whose
//!   force is larger is closed in the exact answer too. The cheapest such motion has `|w|_K^2 = (G_CC^-1)_ii`.

use super::EnergyNorm;
use super::bound::Answer;
use super::energy_norm::ROUNDED_BOUND;
use crate::error::Error;
use crate::qp::linear::{Dependence, SparseMatrix, dot, inverse_lengths, ldexp};
use crate::qp::problem::ContactProblem;
use crate::solution::{ContactSet, ProvenSet};

/// Multiplications that the compliance of the rows in question may cost; beyond, one dof of each row is moved alone.
const MOST_WORK: f64 = 2e9;

impl ContactProblem {
    /// The rows of which an answer proves, by its distance and force, that the exact answer has them open or closed;
    /// `None` where K is not positive definite by itself and no bound is known.
    ///
    /// # Errors
    /// As [`ContactProblem::certify`].
    pub fn prove(&self, displacement: &[f64], multiplier: &[f64]) -> Result<Option<ProvenSet>, Error> {
        self.check_answer(displacement, multiplier)?;
        let norm = EnergyNorm::of(&self.stiffness, &self.contact)?;
        Ok(norm.and_then(|norm| self.prove_in(&norm, displacement, multiplier)))
    }

    /// As [`ContactProblem::prove`], in an energy norm that is at hand, for vectors that fit.
    pub(crate) fn prove_in(&self, norm: &EnergyNorm, displacement: &[f64], multiplier: &[f64]) -> Option<ProvenSet> {
        if let Some(units) = self.far_units(displacement) {
            let problem = self.in_units(&units).ok()?;
            return problem.prove_in(&units.norm(norm), &units.displacement(displacement), &units.force(multiplier));
        }
        let rows = self.rows();
        let violation = self.accurate_violation(displacement);
        let residual = self.accurate_residual(displacement, multiplier);
        let answer = Answer { displacement, multiplier, residual, violation: &violation };
        let error = ROUNDED_BOUND * self.energy_error_bound(norm, &answer).whole;
        if !error.is_finite() {
            return None;
        }
        let halves = Halves::of(self, norm);
        let negligible = self.negligible(displacement);
        let is_open = |row: usize| {
            let distance = -violation[row] - negligible[row];
            distance > 0.0 && (distance.is_infinite() || distance > norm.widening() * halves.reach(row) * error)
        };
        let open = ContactSet::from_fn(rows, is_open);

        let in_question: Vec<usize> = (0..rows).filter(|&row| !open.contains(row)).collect();
        let dropped: Vec<f64> = (0..rows).map(|row| if open.contains(row) { -multiplier[row] } else { 0.0 }).collect();
        let force: Vec<f64> =
            answer.residual.iter().zip(self.contact.mul_transposed(&dropped)).map(|(r, part)| r + part).collect();
        let imbalance = ROUNDED_BOUND * norm.widening() * norm.of_force(&force) + error;
        let mut closed = ContactSet::open(rows);
        let alone = self.moved_alone(&in_question);
        let proven = |row: usize, length: f64| -multiplier[row] > norm.widening() * length * imbalance;
        let mut doubtful = false;
        for (&row, &length) in in_question.iter().zip(&alone) {
            closed.set(row, proven(row, length));
            doubtful |= multiplier[row] < 0.0 && !closed.contains(row);
        }
        if doubtful && halves.work(in_question.len()) <= MOST_WORK {
            for (&row, length) in in_question.iter().zip(halves.moved_together(&self.contact, &in_question)) {
                closed.set(row, closed.contains(row) || proven(row, length));
            }
        }
        Some(ProvenSet { open, closed })
    }

    /// `|w|_K` of the motion of a single dof that only this one of `rows` feels; infinite where there is none.
    fn moved_alone(&self, rows: &[usize]) -> Vec<f64> {
        let mut place = vec![usize::MAX; self.rows()];
        rows.iter().enumerate().for_each(|(index, &row)| place[row] = index);
        let mut lengths = vec![f64::INFINITY; rows.len()];
        for (dof, &stiffness) in self.diagonal().values.iter().enumerate() {
            let mut felt = self.contact.column(dof).filter(|&(row, b)| b != 0.0 && place[row] != usize::MAX);
            if let (Some((row, b)), None) = (felt.next(), felt.next()) {
                let length = &mut lengths[place[row]];
                *length = length.min(stiffness.sqrt() / b.abs());
            }
        }
        lengths
    }
}

/// The columns of `L^-1 B'`, whose products are the compliance of the rows.
struct Halves<'a> {
    norm: &'a EnergyNorm,
    /// The entries of each row, where they are swept: on the boundary, or in the whole body.
    rows: Vec<Vec<(usize, f64)>>,
    on_boundary: bool,
}

impl<'a> Halves<'a> {
    fn of(problem: &ContactProblem, norm: &'a EnergyNorm) -> Self {
        let on_boundary = norm.boundary().and_then(|boundary| norm.rows_on(boundary, &problem.contact, |_| true));
        match on_boundary {
            Some(rows) => Halves { norm, rows, on_boundary: true },
            None => Halves { norm, rows: norm.rows_in_body(&problem.contact), on_boundary: false },
        }
    }

    fn half(&self, row: usize) -> Vec<f64> {
        let boundary = self.norm.boundary().filter(|_| self.on_boundary);
        let mut column = vec![0.0; boundary.map_or(self.norm.dofs(), |boundary| boundary.len())];
        self.rows[row].iter().for_each(|&(place, b)| column[place] += b);
        match boundary {
            Some(boundary) => boundary.forward(column),
            None => self.norm.forward(&column),
        }
    }

    /// `sqrt(G_ii)`: how far a displacement of unit energy norm moves the row.
    fn reach(&self, row: usize) -> f64 {
        if self.norm.is_over() {
            return f64::INFINITY;
        }
        let half = self.half(row);
        ldexp(dot(&half, &half), self.norm.factor()).sqrt()
    }

    /// Multiplications of the compliance of so many rows.
    fn work(&self, rows: usize) -> f64 {
        let length =
            self.norm.boundary().filter(|_| self.on_boundary).map_or(self.norm.dofs(), |boundary| boundary.len());
        (rows * rows) as f64 * (length + rows) as f64
    }

    /// `sqrt((G_CC^-1)_ii)` of the rows C of `contact`; infinite for those with a share in a dependence.
    fn moved_together(&self, contact: &SparseMatrix, rows: &[usize]) -> Vec<f64> {
        let none = || vec![f64::INFINITY; rows.len()];
        let Some(Dependence { independent, takes_part }) = Dependence::of(contact, rows, || self.norm.is_over()) else {
            return none();
        };
        let basis: Vec<usize> = (0..rows.len()).filter(|&index| independent[index]).collect();
        let in_time = |&index: &usize| if self.norm.is_over() { None } else { Some(self.half(rows[index])) };
        let Some(halves) = basis.iter().map(in_time).collect::<Option<Vec<_>>>() else { return none() };
        let Some(reciprocals) = inverse_lengths(halves, || self.norm.is_over()) else { return none() };
        let mut lengths = none();
        for (&index, reciprocal) in basis.iter().zip(reciprocals).filter(|entry| !takes_part[*entry.0]) {
            lengths[index] = ldexp_root(reciprocal, -self.norm.factor());
        }
        lengths
    }
}

/// `sqrt(2^e) x`
fn ldexp_root(x: f64, e: i32) -> f64 {
    ldexp(if e.rem_euclid(2) == 1 { x * std::f64::consts::SQRT_2 } else { x }, e.div_euclid(2))
}
