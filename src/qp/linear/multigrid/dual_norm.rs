//! The energy of a force, `r' A^-1 r`, from above, without a factor of A.
//!
//! For any z with the rest s = r - A z,
//!
//! ```text
//! r' A^-1 r = z' (r + s) + s' A^-1 s,     s' A^-1 s <= s' M s / mu,     mu <= the least eigenvalue of M A
//! ```
//!
//! with the cycle M of the hierarchy. Conjugate gradients make z, and few of them: the first part is then most of the sum.
//! Both lines are exact. That mu is below the least eigenvalue is measured, not proven: the Lanczos coefficients of the same
//! conjugate gradients give the least Ritz value, which comes down to the eigenvalue from above; mu is a share of it.
//!
//! # Source
//! G. H. Golub, G. Meurant, *Matrices, Moments and Quadrature with Applications*, Princeton (2010), chapter 12;
//! G. Meurant, P. Tichý, *Approximating the extreme Ritz values and upper bounds for the A-norm of the error in CG*,
//! Numer. Algorithms 82 (2019) 937-968.

use super::{Multigrid, to_order_one};
use crate::qp::linear::{SymmetricMatrix, dot, ldexp};
use crate::watch::Watch;

/// What is taken of the least Ritz value: the least eigenvalue may be so much smaller.
const SAFETY: f64 = 0.5;

/// The rest is bounded, not known: it ends as this share of the whole.
const SHARE: f64 = 0.1;

/// The Ritz value has settled where one step more takes no more than this share of it.
const SETTLED: f64 = 0.15;

/// A hierarchy that needs more cycles than this is none to bound by.
const MOST_CYCLES: usize = 60;

/// Halvings of the interval in which a Ritz value is.
const HALVINGS: usize = 40;

/// The energy of a force between two bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DualNorm {
    /// A lower bound on `sqrt(r' A^-1 r)`.
    pub least: f64,
    /// An upper bound, as far as the Ritz value has found the least eigenvalue of M A.
    pub most: f64,
    /// The least Ritz value of M A.
    pub ritz: f64,
    /// Cycles that it took.
    pub cycles: usize,
}

/// Bounds `sqrt(r' A^-1 r)` by conjugate gradients with one cycle of `multigrid`, the hierarchy of `matrix` A or of A without
/// terms of low rank; `None` where the cycles do not settle. A must be definite.
pub fn dual_norm(matrix: &SymmetricMatrix, multigrid: &Multigrid, force: &[f64]) -> Option<DualNorm> {
    dual_norm_within(matrix, multigrid, force, &Watch::default())
}

/// The same; `None` too where `watch` is over before the cycles settle.
pub fn dual_norm_within(
    matrix: &SymmetricMatrix,
    multigrid: &Multigrid,
    force: &[f64],
    watch: &Watch,
) -> Option<DualNorm> {
    let unit = to_order_one(force);
    let force: Vec<f64> = force.iter().map(|&value| ldexp(value, unit)).collect();
    if dot(&force, &force) == 0.0 {
        return Some(DualNorm { least: 0.0, most: 0.0, ritz: 1.0, cycles: 0 });
    }
    let mut rest = force.clone();
    let mut solution = vec![0.0; force.len()];
    let mut last: Option<(Vec<f64>, Vec<f64>, f64)> = None;
    let (mut lengths, mut shares): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    let mut ritz = f64::INFINITY;
    for cycles in 1..=MOST_CYCLES {
        if watch.is_over() {
            return None;
        }
        let mut direction = multigrid.cycle(&rest);
        let in_cycle = dot(&rest, &direction);
        if let Some((before, moved, energy)) = &last {
            let earlier = ritz;
            ritz = least_eigenvalue(&lengths, &shares);
            let known: f64 = solution.iter().zip(force.iter().zip(&rest)).map(|(z, (r, s))| z * (r + s)).sum();
            let unknown = in_cycle / (SAFETY * ritz);
            if unknown <= SHARE * known && ritz >= (1.0 - SETTLED) * earlier {
                let norm = |square: f64| ldexp(square.max(0.0).sqrt(), -unit);
                return Some(DualNorm { least: norm(known), most: norm(known + unknown), ritz, cycles });
            }
            let share = -dot(&direction, moved) / energy;
            direction.iter_mut().zip(before).for_each(|(d, before)| *d += share * before);
            shares.push(share);
        }
        let moved = matrix.mul_on(multigrid.threads(), &direction);
        let energy = dot(&direction, &moved);
        let length = dot(&direction, &rest) / energy;
        if energy.is_nan() || energy <= 0.0 || !length.is_finite() || length <= 0.0 {
            return None;
        }
        solution.iter_mut().zip(&direction).for_each(|(z, d)| *z += length * d);
        rest.iter_mut().zip(&moved).for_each(|(rest, moved)| *rest -= length * moved);
        if rest.iter().all(|&value| value == 0.0) {
            let known: f64 = solution.iter().zip(&force).map(|(z, r)| z * r).sum();
            let norm = ldexp(known.max(0.0).sqrt(), -unit);
            return Some(DualNorm { least: norm, most: norm, ritz: 1.0, cycles });
        }
        lengths.push(length);
        last = Some((direction, moved, energy));
    }
    None
}

/// The least eigenvalue of the Lanczos matrix of conjugate gradients with these step lengths and shares of the direction
/// before, by counting signs.
fn least_eigenvalue(lengths: &[f64], shares: &[f64]) -> f64 {
    let entries = || {
        (0..lengths.len()).map(|k| {
            let (share, before) = if k == 0 { (0.0, 1.0) } else { (shares[k - 1].max(0.0), lengths[k - 1]) };
            (1.0 / lengths[k] + share / before, share / (before * before))
        })
    };
    // Is the matrix less `shift` positive definite?
    let is_below = |shift: f64| {
        let mut pivot = f64::INFINITY;
        entries().all(|(diagonal, square)| {
            pivot = diagonal - shift - square / pivot;
            pivot > 0.0
        })
    };
    let (mut low, mut high) = (0.0, entries().map(|entry| entry.0).fold(f64::INFINITY, f64::min));
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if is_below(middle) { low = middle } else { high = middle }
    }
    low
}
