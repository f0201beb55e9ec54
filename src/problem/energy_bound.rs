//! An upper bound on the energy norm of an answer's error.
//!
//! For a feasible v and multipliers mu <= 0 with r = f + B' mu - K v,
//!
//! ```text
//! 1/2 |v - u*|_K^2 <= J(v) - D(mu) = 1/2 r' K^-1 r + mu' (B v - g)
//! ```
//!
//! so that `|u - u*|_K <= |u - v|_K + sqrt(r' K^-1 r + 2 mu' (B v - g))`. The pair (v, mu) is the answer repaired: the rows
//! that look closed are put exactly at their gaps and no other row carries a force, so that the product vanishes. On a
//! contact boundary that the energy norm knows, v is the equilibrium of these rows and r vanishes too where all pull the
//! right way: the bound is then the error itself.

use super::energy_norm::Boundary;
use super::{ContactProblem, EnergyNorm};
use crate::sparse::{SparseMatrix, dot, ldexp};

/// Rounding a sum leaves about this much of its terms.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Sweeps over the rows when a displacement is repaired row by row.
const REPAIR_SWEEPS: usize = 50;

/// Steps in which the rest of the body follows rows that were put at their gaps; each costs a product with K.
const RELAXATIONS: usize = 20;

/// Times that the rows which look closed are corrected on the boundary; from then on rows are only added.
const EXCHANGES: usize = 10;

/// Pivots below this share of their row's own compliance belong to rows that follow from others.
const DEPENDENT: f64 = 1e-12;

/// An answer (u, lambda) and what its certificate has computed of it.
pub(super) struct Answer<'a> {
    pub displacement: &'a [f64],
    pub multiplier: &'a [f64],
    /// f + B' lambda - K u.
    pub residual: Vec<f64>,
    /// B u - g.
    pub violation: &'a [f64],
}

impl ContactProblem {
    /// An upper bound on `|u - u*|_K`.
    pub(super) fn energy_error_bound(&self, norm: &EnergyNorm, answer: &Answer) -> f64 {
        let closed = self.rows_that_look_closed(answer);
        let on_boundary = norm.boundary().and_then(|boundary| self.bound_on_boundary(norm, boundary, answer, &closed));
        on_boundary.unwrap_or_else(|| {
            let as_it_stands = self.bound_row_by_row(norm, answer, None);
            self.bound_row_by_row(norm, answer, Some(&closed)).min(as_it_stands)
        })
    }

    /// Rows whose force, times their compliance if all else stood still, exceeds their distance.
    fn rows_that_look_closed(&self, answer: &Answer) -> Vec<bool> {
        let diagonal = self.stiffness.diagonal();
        let mut compliance = vec![0.0; self.rows()];
        for (dof, &stiffness) in diagonal.iter().enumerate() {
            self.contact.column(dof).for_each(|(row, b)| compliance[row] += b * b / stiffness);
        }
        let looks = |row: usize| -answer.multiplier[row] * compliance[row] > -answer.violation[row];
        (0..self.rows()).map(|row| self.gap[row].is_finite() && looks(row)).collect()
    }

    /// What B u - g may be off by rounding, row by row.
    pub(super) fn negligible(&self, displacement: &[f64]) -> Vec<f64> {
        let magnitude: Vec<f64> = displacement.iter().map(|value| ROUNDING * value.abs()).collect();
        self.contact.abs().mul(&magnitude)
    }

    /// The bound from the equilibrium of the rows in `closed`; `None` where these contradict each other.
    ///
    /// All on the boundary: with Z = L_tt^-1 B_t' the displacement that multipliers eta add has the sweep Z eta and moves
    /// the rows by c Z' Z eta.
    fn bound_on_boundary(
        &self,
        norm: &EnergyNorm,
        boundary: &Boundary,
        answer: &Answer,
        closed: &[bool],
    ) -> Option<f64> {
        let rows = norm.rows_on(boundary, &self.contact)?;
        let negligible = self.negligible(answer.displacement);
        let (interior, swept) = norm.sweep(&answer.residual);
        let unit = norm.factor();
        let spread = |weights: &[f64]| {
            let mut sum = vec![0.0; boundary.len()];
            for (row, &weight) in rows.iter().zip(weights).filter(|entry| *entry.1 != 0.0) {
                row.iter().for_each(|&(place, b)| sum[place] += weight * b);
            }
            boundary.forward(sum)
        };
        let mut halves: Vec<Option<Vec<f64>>> = vec![None; self.rows()];
        let mut closed = closed.to_vec();
        for exchange in 0..=self.rows() {
            // The deepest first: of two rows that contradict each other as equalities the tighter one is kept.
            let mut set: Vec<usize> = (0..self.rows()).filter(|&row| closed[row]).collect();
            set.sort_by(|&a, &b| answer.violation[b].total_cmp(&answer.violation[a]));
            // The sweep of what is left when only closed rows carry their force.
            let dropped: Vec<f64> =
                (0..self.rows()).map(|row| if closed[row] { 0.0 } else { -answer.multiplier[row] }).collect();
            let mut sweep = swept.clone();
            sweep.iter_mut().zip(spread(&dropped)).for_each(|(entry, part)| *entry += part);
            for &row in &set {
                halves[row].get_or_insert_with(|| {
                    let mut column = vec![0.0; boundary.len()];
                    rows[row].iter().for_each(|&(place, b)| column[place] += b);
                    boundary.forward(column)
                });
            }
            let half: Vec<&[f64]> = set.iter().map(|&row| halves[row].as_deref().unwrap_or(&[])).collect();
            let open: Vec<f64> = set
                .iter()
                .zip(&half)
                .map(|(&row, half)| -ldexp(answer.violation[row], -unit) - dot(half, &sweep))
                .collect();
            let (change, contradicting) = solve_gram(&half, open);
            if !contradicting.is_empty() {
                contradicting.iter().for_each(|&place| closed[set[place]] = false);
                continue;
            }
            let mut multiplier = vec![0.0; self.rows()];
            for (&row, (half, change)) in set.iter().zip(half.iter().zip(&change)) {
                multiplier[row] = answer.multiplier[row] + change;
                sweep.iter_mut().zip(*half).for_each(|(entry, part)| *entry += change * part);
            }
            let moved = boundary.backward(sweep.clone());
            let violation = |row: usize| {
                answer.violation[row] + ldexp(rows[row].iter().map(|&(place, b)| b * moved[place]).sum(), unit)
            };
            let violated: Vec<usize> =
                (0..self.rows()).filter(|&row| !closed[row] && violation(row) > negligible[row]).collect();
            let pulling: Vec<usize> = set.iter().copied().filter(|&row| multiplier[row] > 0.0).collect();
            if violated.is_empty() && (pulling.is_empty() || exchange >= EXCHANGES) {
                let excess: Vec<f64> = multiplier.iter().map(|value| value.max(0.0)).collect();
                let imbalance = spread(&excess);
                let length = |square: f64| ldexp(square, unit).sqrt();
                return Some(length(interior + dot(&sweep, &sweep)) + length(dot(&imbalance, &imbalance)));
            }
            violated.iter().for_each(|&row| closed[row] = true);
            if exchange < EXCHANGES {
                pulling.iter().for_each(|&row| closed[row] = false);
            }
        }
        None
    }

    /// The bound from the displacement whose rows are moved one after the other, each by its own dofs: those of `closed`
    /// to their gaps, all others out of their obstacles. Without `closed` every row keeps its force.
    fn bound_row_by_row(&self, norm: &EnergyNorm, answer: &Answer, closed: Option<&[bool]>) -> f64 {
        let by_row = self.contact.transposed();
        let is_closed = |row: usize| closed.is_some_and(|closed| closed[row]);
        let Some(mut repair) = self.repair(&by_row, answer, is_closed) else { return f64::INFINITY };
        let is_moved = repair.iter().any(|&change| change != 0.0);
        let mut elastic = if is_moved { self.stiffness.mul(&repair) } else { repair.clone() };
        let mut multiplier: Vec<f64> = (0..self.rows())
            .map(|row| if closed.is_none() || is_closed(row) { answer.multiplier[row].min(0.0) } else { 0.0 })
            .collect();
        let dropped: Vec<f64> = multiplier.iter().zip(answer.multiplier).map(|(mu, lambda)| mu - lambda).collect();
        let mut residual = answer.residual.clone();
        for (entry, (elastic, force)) in
            residual.iter_mut().zip(elastic.iter().zip(self.contact.mul_transposed(&dropped)))
        {
            *entry += force - elastic;
        }
        if closed.is_some() && is_moved {
            let mut held = vec![false; self.dofs()];
            for row in (0..self.rows()).filter(|&row| is_closed(row)) {
                by_row.column(row).filter(|entry| entry.1 != 0.0).for_each(|(dof, _)| held[dof] = true);
            }
            let (follow, force) = self.relaxed(&residual, &held);
            let both: Vec<f64> = repair.iter().zip(&follow).map(|(a, b)| a + b).collect();
            let (moved_by, negligible) = (self.contact.mul(&both), self.negligible(answer.displacement));
            let is_feasible = |row: usize| is_closed(row) || answer.violation[row] + moved_by[row] <= negligible[row];
            if (0..self.rows()).all(is_feasible) {
                repair = both;
                residual.iter_mut().zip(&force).for_each(|(entry, force)| *entry -= force);
                elastic.iter_mut().zip(&force).for_each(|(entry, force)| *entry += force);
            }
        }
        // A row on a single dof takes what is out of balance there, as far as it may push.
        for row in (0..self.rows()).filter(|&row| is_closed(row)) {
            let mut entries = by_row.column(row).filter(|entry| entry.1 != 0.0);
            if let (Some((dof, b)), None) = (entries.next(), entries.next()) {
                let pushed = (multiplier[row] - residual[dof] / b).min(0.0);
                residual[dof] += b * (pushed - multiplier[row]);
                multiplier[row] = pushed;
            }
        }
        let moved_by = self.contact.mul(&repair);
        let slack_work: f64 = (0..self.rows())
            .filter(|&row| multiplier[row] != 0.0)
            .map(|row| (answer.violation[row] + moved_by[row]).min(0.0) * multiplier[row])
            .filter(|work| work.is_finite())
            .sum();
        let distance = (norm.of_force(&residual).powi(2) + 2.0 * slack_work).sqrt();
        distance + dot(&repair, &elastic).max(0.0).sqrt()
    }

    /// A displacement d that follows the force `residual` where nothing is `held`, by a few steps of conjugate gradients,
    /// and K d.
    fn relaxed(&self, residual: &[f64], held: &[bool]) -> (Vec<f64>, Vec<f64>) {
        let diagonal = self.stiffness.diagonal();
        let free = |values: Vec<f64>| -> Vec<f64> {
            values.into_iter().zip(held).map(|(value, &held)| if held { 0.0 } else { value }).collect()
        };
        let scaled = |rest: &[f64]| -> Vec<f64> { rest.iter().zip(&diagonal).map(|(r, d)| r / d).collect() };
        let (mut moved, mut force) = (vec![0.0; self.dofs()], vec![0.0; self.dofs()]);
        let mut rest = free(residual.to_vec());
        let mut preconditioned = scaled(&rest);
        let mut direction = preconditioned.clone();
        let mut work = dot(&rest, &preconditioned);
        for _ in 0..RELAXATIONS {
            let elastic = self.stiffness.mul(&direction);
            let step = work / dot(&direction, &elastic);
            if !step.is_finite() {
                break;
            }
            moved.iter_mut().zip(&direction).for_each(|(entry, d)| *entry += step * d);
            force.iter_mut().zip(&elastic).for_each(|(entry, k)| *entry += step * k);
            let change = free(elastic);
            rest.iter_mut().zip(&change).for_each(|(entry, k)| *entry -= step * k);
            preconditioned = scaled(&rest);
            let next = dot(&rest, &preconditioned);
            let share = next / work;
            direction.iter_mut().zip(&preconditioned).for_each(|(d, z)| *d = z + share * *d);
            work = next;
        }
        (moved, force)
    }

    /// A change of u that puts the closed rows at their gaps and removes all penetration, by projections row after
    /// row; `None` where rows contradict.
    fn repair(&self, by_row: &SparseMatrix, answer: &Answer, is_closed: impl Fn(usize) -> bool) -> Option<Vec<f64>> {
        let mut change = vec![0.0; self.dofs()];
        let negligible = self.negligible(answer.displacement);
        for sweep in 0..REPAIR_SWEEPS {
            let mut clean = true;
            for (row, &negligible) in negligible.iter().enumerate() {
                let moved = by_row.column(row).map(|(dof, b)| b * change[dof]).sum::<f64>();
                let excess = answer.violation[row] + moved;
                // Rows that contradict a closed one as an equality may still be met as what they are.
                let open = excess < 0.0 && (!is_closed(row) || sweep > REPAIR_SWEEPS / 2);
                if excess.abs() <= negligible || open {
                    continue;
                }
                let square: f64 = by_row.column(row).map(|(_, b)| b * b).sum();
                if square == 0.0 {
                    return None;
                }
                clean = false;
                for (dof, b) in by_row.column(row) {
                    change[dof] -= excess / square * b;
                }
            }
            if clean {
                return Some(change);
            }
        }
        None
    }
}

/// Solves `Z' Z x = b` by Cholesky, leaving out columns that follow from those before them: x is 0 there, and those
/// whose b contradicts that they do are named.
fn solve_gram(columns: &[&[f64]], b: Vec<f64>) -> (Vec<f64>, Vec<usize>) {
    let size = columns.len();
    let mut factor = vec![0.0; size * size];
    let mut x = b;
    let (mut kept, mut contradicting) = (vec![true; size], Vec::new());
    let scale = x.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    for i in 0..size {
        let own = dot(columns[i], columns[i]);
        let (before, row) = factor.split_at_mut(i * size);
        for j in (0..i).filter(|&j| kept[j]) {
            let known = dot(&before[j * size..j * size + j], &row[..j]);
            row[j] = (dot(columns[i], columns[j]) - known) / before[j * size + j];
        }
        let pivot = own - dot(&row[..i], &row[..i]);
        kept[i] = pivot > DEPENDENT * own;
        x[i] -= dot(&row[..i], &x[..i]);
        if kept[i] {
            row[i] = pivot.sqrt();
            x[i] /= row[i];
        } else {
            if x[i].abs() > DEPENDENT.sqrt() * scale {
                contradicting.push(i);
            }
            x[i] = 0.0;
        }
    }
    for i in (0..size).rev().filter(|&i| kept[i]) {
        let known: f64 = (i + 1..size).map(|j| factor[j * size + i] * x[j]).sum();
        x[i] = (x[i] - known) / factor[i * size + i];
    }
    (x, contradicting)
}
