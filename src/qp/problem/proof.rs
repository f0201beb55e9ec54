//! Which rows of a contact set are beyond doubt, from the bound on the energy norm of the error.
//!
//! With `|u - u*|_K <= E` and the compliance `G = B K^-1 B'` of the rows:
//!
//! * `|B_i (u - u*)| <= sqrt(G_ii) E`: a row whose distance is larger is open in the exact answer too.
//! * Let C be all other rows, `r = f + B_C' lambda_C - K u`, and w a motion with `B_i w = 1` that no other row of C feels.
//!   From `B_C' (lambda - lambda*)_C = r + K (u - u*)`: `|lambda_i - lambda*_i| <= |w|_K (|r|_{K^-1} + E)`. A row whose
//!   force is larger is closed in the exact answer too. The cheapest such motion has `|w|_K^2 = (G_CC^-1)_ii`.

use super::energy_bound::Answer;
use super::{ContactProblem, EnergyNorm};
use crate::error::Error;
use crate::qp::linear::{dot, ldexp};
use crate::solution::{ContactSet, ProvenSet};

/// Multiplications that the compliance of the rows in question may cost; beyond, one dof of each row is moved alone.
const MOST_WORK: f64 = 2e9;

/// The bound can be the error itself; by this much it and all that is computed from it may be rounded.
const ROUNDED: f64 = 1.0 + 1e-6;

/// Pivots below this share of their row's own compliance belong to rows that follow from others, or nearly so.
const DEPENDENT: f64 = 1e-8;

/// A row takes part in a dependence where its share of the motion is above this share of the dependent row: more than what
/// rounding leaves. The share of a row on a stiff part is small beside one on a soft part.
const TAKES_PART: f64 = 1e-12;

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
        let error = ROUNDED * self.energy_error_bound(norm, &answer).whole;
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
        let imbalance = ROUNDED * norm.widening() * norm.of_force(&force) + error;
        let mut closed = ContactSet::open(rows);
        let alone = self.moved_alone(&in_question);
        let proven = |row: usize, length: f64| -multiplier[row] > norm.widening() * length * imbalance;
        let mut doubtful = false;
        for (&row, &length) in in_question.iter().zip(&alone) {
            closed.set(row, proven(row, length));
            doubtful |= multiplier[row] < 0.0 && !closed.contains(row);
        }
        if doubtful && halves.work(in_question.len()) <= MOST_WORK {
            for (&row, length) in in_question.iter().zip(halves.moved_together(&in_question)) {
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
        let on_boundary = norm.boundary().and_then(|boundary| norm.rows_on(boundary, &problem.contact));
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

    /// `sqrt((G_CC^-1)_ii)` of the rows C; infinite for those that follow from others.
    fn moved_together(&self, rows: &[usize]) -> Vec<f64> {
        let size = rows.len();
        let in_time = |&row: &usize| if self.norm.is_over() { None } else { Some(self.half(row)) };
        let Some(halves) = rows.iter().map(in_time).collect::<Option<Vec<_>>>() else {
            return vec![f64::INFINITY; size];
        };
        // L of G_CC row by row; a row that follows from those before it has none.
        let mut factor = vec![0.0; size * size];
        let mut kept = vec![true; size];
        let mut dependent = vec![false; size];
        let owns: Vec<f64> = halves.iter().map(|half| dot(half, half)).collect();
        for i in 0..size {
            if self.norm.is_over() {
                return vec![f64::INFINITY; size];
            }
            let own = owns[i];
            let (before, row) = factor.split_at_mut(i * size);
            for j in (0..i).filter(|&j| kept[j]) {
                let known = dot(&before[j * size..j * size + j], &row[..j]);
                row[j] = (dot(&halves[i], &halves[j]) - known) / before[j * size + j];
            }
            let pivot = own - dot(&row[..i], &row[..i]);
            kept[i] = pivot > DEPENDENT * own;
            if kept[i] {
                row[i] = pivot.sqrt();
                continue;
            }
            dependent[i] = true;
            let mut share = row[..i].to_vec();
            backward(before, size, &kept, &mut share);
            let takes_part = |share: f64, other: f64| share.abs() * other.sqrt() > TAKES_PART * own.sqrt();
            let others = share.iter().zip(&owns);
            others.zip(&mut dependent).for_each(|((&share, &other), flag)| *flag |= takes_part(share, other));
            row[..i].fill(0.0);
        }
        (0..size)
            .map(|i| {
                if dependent[i] {
                    return f64::INFINITY;
                }
                // (G^-1)_ii is the squared length of L^-1 e_i.
                let mut x = vec![0.0; size];
                for j in (i..size).filter(|&j| kept[j]) {
                    let row = &factor[j * size..(j + 1) * size];
                    let load = if j == i { 1.0 } else { 0.0 };
                    x[j] = (load - dot(&row[i..j], &x[i..j])) / row[j];
                }
                ldexp(dot(&x, &x), -self.norm.factor()).sqrt()
            })
            .collect()
    }
}

/// Solves `L' x = b` for the rows of L so far, which `factor` holds row by row.
fn backward(factor: &[f64], size: usize, kept: &[bool], b: &mut [f64]) {
    for j in (0..b.len()).rev() {
        if !kept[j] {
            b[j] = 0.0;
            continue;
        }
        b[j] /= factor[j * size + j];
        let value = b[j];
        (0..j).for_each(|k| b[k] -= factor[j * size + k] * value);
    }
}
