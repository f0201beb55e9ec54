//! An upper bound on the energy of a force, `r' A^-1 r`, without a factor of A.
//!
//! For any z with the residual s = r - A z,
//!
//! ```text
//! r' A^-1 r = z' (r + s) + s' A^-1 s,     s' A^-1 s <= s' M s / mu,     mu <= the least eigenvalue of M A
//! ```
//!
//! with the cycle M of the hierarchy. A few steps of conjugate gradients give z: the first part is then most of the sum. Both
//! lines are exact. It is measured, not proven, that mu is below the least eigenvalue: the Lanczos coefficients of the same
//! conjugate gradients give the least Ritz value, which approaches the eigenvalue from above; mu is a share of that value.
//!
//! # Source
//! G. H. Golub, G. Meurant, *Matrices, Moments and Quadrature with Applications*, Princeton (2010), chapter 12;
//! G. Meurant, P. Tichý, *Approximating the extreme Ritz values and upper bounds for the A-norm of the error in CG*,
//! Numer. Algorithms 82 (2019) 937-968.

use super::Multigrid;
use crate::qp::linear::{SymmetricMatrix, exponent, ldexp};
use crate::watch::Watch;

/// Factor on the least Ritz value, because the least eigenvalue may be smaller.
const SAFETY: f64 = 0.5;

/// The second part is a bound only: the iteration ends when it is at most this share of the first.
const REST_SHARE: f64 = 0.1;

/// The Ritz value has settled if one more step reduces it by no more than this share.
const SETTLED_RITZ: f64 = 0.15;

/// A hierarchy that needs more cycles than this gives no bound.
const MOST_CYCLES: usize = 60;

/// Halvings of the interval that contains a Ritz value.
const HALVINGS: usize = 40;

/// A lower and an upper bound on the dual norm of a force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DualNorm {
    /// A lower bound on `sqrt(r' A^-1 r)`.
    pub least: f64,
    /// An upper bound, as far as the Ritz value has found the least eigenvalue of M A.
    pub most: f64,
    /// The least Ritz value of M A.
    pub ritz: f64,
    /// Number of cycles used.
    pub cycles: usize,
}

/// Groups of unknowns that share no energy: the blocks of a block-diagonal matrix.
#[derive(Clone, Copy, Debug)]
pub struct Blocks<'a> {
    /// The block of each unknown.
    pub of_unknown: &'a [usize],
    /// Number of blocks.
    pub count: usize,
}

impl Blocks<'_> {
    /// The sum of `term(i)` over the unknowns i of each block.
    fn sums(&self, term: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut sums = vec![0.0; self.count];
        self.of_unknown.iter().enumerate().for_each(|(i, &block)| sums[block] += term(i));
        sums
    }
}

/// Bounds `sqrt(r' A^-1 r)` by conjugate gradients with one cycle of `multigrid`, the hierarchy of `matrix` A or of A without
/// terms of low rank; `None` if the cycles do not settle. A must be definite.
pub fn dual_norm(matrix: &SymmetricMatrix, multigrid: &Multigrid, force: &[f64]) -> Option<DualNorm> {
    dual_norm_within(matrix, multigrid, force, &Watch::default())
}

/// The same; `None` also if `watch` is over before the cycles settle.
pub fn dual_norm_within(
    matrix: &SymmetricMatrix,
    multigrid: &Multigrid,
    force: &[f64],
    watch: &Watch,
) -> Option<DualNorm> {
    let blocks = Blocks { of_unknown: &vec![0; force.len()], count: 1 };
    dual_norms_within(matrix, multigrid, force, blocks, watch)?.pop()
}

/// The same for the force on each of the blocks of A.
///
/// One cycle serves all blocks, but each block has its own conjugate gradients: its own scale, step lengths and Ritz value. So
/// a soft block is not lost beside a stiff one.
pub fn dual_norms_within(
    matrix: &SymmetricMatrix,
    multigrid: &Multigrid,
    force: &[f64],
    blocks: Blocks,
    watch: &Watch,
) -> Option<Vec<DualNorm>> {
    let block = |i: usize| blocks.of_unknown[i];
    let mut largest = vec![0.0_f64; blocks.count];
    force.iter().enumerate().for_each(|(i, value)| largest[block(i)] = largest[block(i)].max(value.abs()));
    let units: Vec<i32> = largest.iter().map(|&largest| -exponent(largest)).collect();
    let mut rest: Vec<f64> = force.iter().enumerate().map(|(i, &value)| ldexp(value, units[block(i)])).collect();
    let force = rest.clone();
    let mut solution = vec![0.0; force.len()];
    let mut iterations = vec![Iteration::default(); blocks.count];
    let (mut before, mut moved) = (vec![0.0; force.len()], vec![0.0; force.len()]);
    for cycles in 1..=MOST_CYCLES {
        if watch.is_over() {
            return None;
        }
        let known = blocks.sums(|i| solution[i] * (force[i] + rest[i]));
        let left = blocks.sums(|i| rest[i].abs());
        for ((iteration, known), left) in iterations.iter_mut().zip(&known).zip(&left) {
            iteration.end_without_rest(*known, *left, cycles - 1);
        }
        let mut direction = multigrid.cycle(&rest);
        let in_cycle = blocks.sums(|i| rest[i] * direction[i]);
        let along = blocks.sums(|i| direction[i] * moved[i]);
        for (index, iteration) in iterations.iter_mut().enumerate() {
            iteration.turn(known[index], in_cycle[index], along[index], cycles);
        }
        if iterations.iter().all(|iteration| iteration.found.is_some()) {
            let scaled = iterations.iter().zip(&units).map(|(iteration, &unit)| iteration.found_in_unit(unit));
            return scaled.collect();
        }
        for (i, (entry, before)) in direction.iter_mut().zip(&before).enumerate() {
            let iteration = &iterations[block(i)];
            *entry = if iteration.found.is_some() { 0.0 } else { *entry + iteration.share * before };
        }
        moved = matrix.mul_on(multigrid.threads(), &direction);
        let energies = blocks.sums(|i| direction[i] * moved[i]);
        let works = blocks.sums(|i| direction[i] * rest[i]);
        for ((iteration, energy), work) in iterations.iter_mut().zip(energies).zip(works) {
            iteration.step(energy, work)?;
        }
        for (i, (z, d)) in solution.iter_mut().zip(&direction).enumerate() {
            let iteration = &iterations[block(i)];
            if iteration.found.is_none() {
                *z += iteration.length * d;
                rest[i] -= iteration.length * moved[i];
            }
        }
        before = direction;
    }
    None
}

/// The conjugate gradients of one block.
#[derive(Clone, Debug, Default)]
struct Iteration {
    lengths: Vec<f64>,
    shares: Vec<f64>,
    /// The coefficient of the previous direction in the last one, and the step along it.
    share: f64,
    length: f64,
    energy: f64,
    ritz: Option<f64>,
    found: Option<DualNorm>,
}

impl Iteration {
    /// Ends if nothing is left of the force.
    fn end_without_rest(&mut self, known: f64, left: f64, cycles: usize) {
        if self.found.is_none() && left == 0.0 {
            let norm = known.max(0.0).sqrt();
            self.found = Some(DualNorm { least: norm, most: norm, ritz: 1.0, cycles });
        }
    }

    /// Takes in the effect of a cycle on the residual: the end, or the coefficient of the previous direction in the next one.
    fn turn(&mut self, known: f64, in_cycle: f64, along: f64, cycles: usize) {
        if self.found.is_some() || self.lengths.is_empty() {
            return;
        }
        let earlier = self.ritz.unwrap_or(f64::INFINITY);
        let ritz = least_eigenvalue(&self.lengths, &self.shares);
        self.ritz = Some(ritz);
        let unknown = in_cycle / (SAFETY * ritz);
        if unknown <= REST_SHARE * known && ritz >= (1.0 - SETTLED_RITZ) * earlier {
            let norm = |square: f64| square.max(0.0).sqrt();
            self.found = Some(DualNorm { least: norm(known), most: norm(known + unknown), ritz, cycles });
        }
        self.share = -along / self.energy;
        self.shares.push(self.share);
    }

    /// The step along a direction of this energy, on which the residual does this work; `None` if there is no step.
    fn step(&mut self, energy: f64, work: f64) -> Option<()> {
        if self.found.is_some() {
            return Some(());
        }
        (self.energy, self.length) = (energy, work / energy);
        let is_step = energy > 0.0 && self.length.is_finite() && self.length > 0.0;
        self.lengths.push(self.length);
        is_step.then_some(())
    }

    fn found_in_unit(&self, unit: i32) -> Option<DualNorm> {
        let found = self.found?;
        Some(DualNorm { least: ldexp(found.least, -unit), most: ldexp(found.most, -unit), ..found })
    }
}

/// The least eigenvalue of the Lanczos matrix of conjugate gradients with these step lengths and these coefficients of the
/// previous directions, by counting signs.
fn least_eigenvalue(lengths: &[f64], shares: &[f64]) -> f64 {
    let entries = || {
        (0..lengths.len()).map(|k| {
            let (share, before) = if k == 0 { (0.0, 1.0) } else { (shares[k - 1].max(0.0), lengths[k - 1]) };
            (1.0 / lengths[k] + share / before, share / (before * before))
        })
    };
    // `true` if the matrix minus `shift` is positive definite.
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
