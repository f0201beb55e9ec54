//! How far a displacement of unit energy norm moves a row: upper bounds on `sqrt(G_ii)`, `G = B K^-1 B'`, cheap ones first.
//!
//! If no entry of K off its diagonal is positive and some w > 0 has `K w >= kappa s` with kappa, s > 0, then K is an M-matrix, no
//! entry of its inverse is negative, and
//!
//! ```text
//! (K^-1)_ii s_i <= (K^-1 s)_i <= w_i / kappa
//! ```
//!
//! One solve `K w = s`, of any accuracy, serves all rows. Rows for which that is not enough are swept through the factor one
//! by one, or, if they are many, read off the selected inverse.
//!
//! # Source
//! A. Berman, R. J. Plemmons, *Nonnegative Matrices in the Mathematical Sciences*, SIAM (1994), theorem 6.2.3: condition I27 of
//! an M-matrix.

use super::EnergyNorm;
use super::proof::Halves;
use crate::qp::linear::multigrid::{Multigrid, dual_norm_within};
use crate::qp::linear::{dot, largest, ldexp};
use crate::qp::problem::ContactProblem;
use crate::watch::Watch;

/// Steps of power iteration for the largest eigenvalue of M D.
const POWER_STEPS: usize = 6;

/// What the quotient of two measured eigenvalues may be off by.
const SAFETY: f64 = 4.0;

/// Rounding of an entry of K w, relative to the sum of its terms.
const PRODUCT_ROUNDING: f64 = 1e-13;

/// Multiplications of a blocked factorisation that take the time of one in a sweep.
const BLOCKED: f64 = 4.0;

/// The selected inverse costs so many factorisations.
const SELECTED: f64 = 2.0;

impl ContactProblem {
    /// Upper bounds on `sqrt(G_ii)` of every row, from one solve: `solve(s)` returns about `K^-1 s`. `None` if that does not show
    /// that K is an M-matrix.
    pub(super) fn monotone_reach(&self, solve: impl FnOnce(&[f64]) -> Option<Vec<f64>>) -> Option<Vec<f64>> {
        if self.stiffness().lower().triplets().any(|(row, column, value)| row != column && value > 0.0) {
            return None;
        }
        // On a unit diagonal the right-hand side is one everywhere.
        let load: Vec<f64> = self.stiffness().diagonal().iter().map(|value| value.sqrt()).collect();
        let w = solve(&load)?;
        if load.iter().chain(&w).any(|&value| !(value > 0.0 && value.is_finite())) {
            return None;
        }
        let terms = self.stiffness().mul_abs(&w);
        let sure = self.stiffness().mul(&w).into_iter().zip(terms).map(|(sum, terms)| sum - PRODUCT_ROUNDING * terms);
        let kappa = sure.zip(&load).map(|(sum, s)| sum / s).fold(f64::INFINITY, f64::min);
        if kappa.is_nan() || kappa <= 0.0 {
            return None;
        }
        let roots: Vec<f64> = w.iter().zip(&load).map(|(w, s)| (w / (s * kappa)).sqrt()).collect();
        Some(self.contact().mul_abs(&roots))
    }

    /// Upper bounds on `sqrt(G_ii)` of every row from two measured eigenvalues: with the cycle M and `D = diag K`,
    ///
    /// ```text
    /// K^-1 <= M / least(M K),     M <= largest(M D) D^-1
    /// ```
    ///
    /// The second comes from power iteration, begun at the smooth `displacement`. `None` if the cycles do not settle.
    pub(super) fn measured_reach(
        &self,
        multigrid: &Multigrid,
        displacement: &[f64],
        watch: &Watch,
    ) -> Option<Vec<f64>> {
        let diagonal = self.stiffness().diagonal();
        if diagonal.iter().any(|&value| value <= 0.0) {
            return None;
        }
        let mut x = displacement.to_vec();
        let mut largest_value = 0.0_f64;
        for _ in 0..POWER_STEPS {
            let size = largest(&x);
            if size == 0.0 || !size.is_finite() || watch.is_over() {
                return None;
            }
            x.iter_mut().for_each(|value| *value /= size);
            let force: Vec<f64> = x.iter().zip(&diagonal).map(|(x, d)| x * d).collect();
            let moved = multigrid.cycle(&force);
            largest_value = largest_value.max(dot(&force, &moved) / dot(&force, &x));
            x = moved;
        }
        let force: Vec<f64> = x.iter().zip(&diagonal).map(|(x, d)| x * d).collect();
        let least = dual_norm_within(self.stiffness(), multigrid, &force, watch)?.ritz;
        let mu = least / (SAFETY * largest_value);
        let mut squares = vec![0.0; self.rows()];
        for (dof, d) in diagonal.iter().enumerate() {
            self.contact().column(dof).for_each(|(row, b)| squares[row] += b * b / d);
        }
        Some(squares.into_iter().map(|square| (square / mu).sqrt()).collect())
    }

    /// Which of `rows` have a `sqrt(G_ii)` below their limit, by sweeps or by the selected inverse, whichever costs less.
    pub(super) fn within_reach(&self, norm: &EnergyNorm, halves: &Halves, rows: &[(usize, f64)]) -> Vec<usize> {
        let by_sweeps = rows.len() as f64 * halves.sweep();
        let at_once = SELECTED * norm.multiplications() / BLOCKED;
        let one_by_one = |row: usize| halves.reach(row);
        let chosen = |reach: &dyn Fn(usize) -> f64| {
            rows.iter().filter(|&&(row, limit)| reach(row) < limit).map(|&(row, _)| row).collect()
        };
        if by_sweeps <= at_once || norm.is_over() {
            return chosen(&one_by_one);
        }
        let Some(inverse) = norm.selected_inverse() else { return chosen(&one_by_one) };
        let entries = norm.rows_in_body(self.contact());
        chosen(&|row| match inverse.product(&entries[row]) {
            Some(square) => ldexp(norm.rounding() * square.max(0.0), norm.factor()).sqrt(),
            None => halves.reach(row),
        })
    }
}
