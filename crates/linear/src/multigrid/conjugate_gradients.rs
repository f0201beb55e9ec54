//! The method of conjugate gradients, preconditioned by a hierarchy, and an upper bound on the energy of a force,
//! `r' A^-1 r`, without a factor of A.
//!
//! For any z with the residual s = r - A z,
//!
//! ```text
//! r' A^-1 r = z' (r + s) + s' A^-1 s,     s' A^-1 s <= s' M s / mu,     mu <= the least eigenvalue of M A
//! ```
//!
//! with the cycle M of the hierarchy. A few steps of conjugate gradients give z: the first part is then most of the
//! sum. Both lines are exact. It is measured, not proven, that mu is below the least eigenvalue: the Lanczos
//! coefficients of the same conjugate gradients give the least Ritz value, which approaches the eigenvalue from above;
//! mu is a share of that value.
//!
//! # Source
//! G. H. Golub, G. Meurant, *Matrices, Moments and Quadrature with Applications*, Princeton (2010), chapter 12;
//! G. Meurant, P. Tichý, *Approximating the extreme Ritz values and upper bounds for the A-norm of the error in CG*,
//! Numer. Algorithms 82 (2019) 937-968.

use super::Multigrid;
use crate::error::Error;
use crate::watch::Watch;
use crate::{Blocks, Iterate, SymmetricMatrix, exponent, generic, ldexp, norm};

/// A matrix A with the hierarchy that preconditions it: its own, or that of A without terms of low rank.
#[derive(Clone, Copy)]
pub struct Preconditioned<'a> {
    matrix: &'a SymmetricMatrix,
    pub(super) multigrid: &'a Multigrid,
}

impl Multigrid {
    /// A `matrix` with this hierarchy.
    pub fn preconditioning<'a>(&'a self, matrix: &'a SymmetricMatrix) -> Preconditioned<'a> {
        Preconditioned { matrix, multigrid: self }
    }
}

/// The answer of a linear solve.
#[derive(Clone, Debug, PartialEq)]
pub struct ConjugateGradients {
    /// The solution x, one entry per dof.
    pub solution: Vec<f64>,
    pub cycles: usize,
    /// `|b - A x| / |b|`, for the residual that the iteration updates.
    pub residual: f64,
}

/// Number of cycles within which conjugate gradients from a generic force meet a direction of negative energy, if there
/// is one.
const LOOKED: usize = 25;

impl Preconditioned<'_> {
    /// `A p`.
    pub(super) fn product(&self, p: &[f64]) -> Vec<f64> {
        self.multigrid.product(self.matrix, p)
    }

    /// Solves A x = b to `|b - A x| <= tolerance |b|` in the Euclidean norm, in at most `most_cycles` cycles.
    ///
    /// The tolerance was met if `residual` is at most `tolerance`.
    pub fn solve(&self, b: &[f64], tolerance: f64, most_cycles: usize) -> Result<ConjugateGradients, Error> {
        let size = norm(b);
        let mut iterate = Iterate::new(vec![0.0; b.len()], b.to_vec(), Blocks::ONE);
        let mut residual = if size > 0.0 { 1.0 } else { 0.0 };
        let mut cycles = 0;
        while residual > tolerance && cycles < most_cycles {
            cycles += 1;
            if !iterate.step(self.multigrid.cycle(&iterate.rest), |p| self.product(p)) {
                let evidence = format!("a search direction p has p'Kp = {:e}", iterate.energies[0]);
                return Err(Error::NotConvex { evidence });
            }
            residual = norm(&iterate.rest) / size;
        }
        Ok(ConjugateGradients { solution: iterate.solution, cycles, residual })
    }

    /// A direction (length n) without positive energy. Conjugate gradients from a generic force meet it if the matrix
    /// has a negative eigenvalue that its hierarchy does not hide; rounding may give one for a semidefinite matrix.
    /// `None` if no direction is met, or if `watch` is over.
    pub fn negative_direction(&self, watch: &Watch) -> Option<Vec<f64>> {
        let force = generic(self.matrix.dim(), 0);
        let mut iterate = Iterate::new(vec![0.0; force.len()], force, Blocks::ONE);
        let mut steps = (0..LOOKED).take_while(|_| !watch.is_over());
        let ends = steps.any(|_| !iterate.step(self.multigrid.cycle(&iterate.rest), |p| self.product(p)));
        ends.then_some(iterate.direction)
    }
}

/// Factor on the least Ritz value, because the least eigenvalue may be smaller.
const SAFETY: f64 = 0.5;

/// The second part is a bound only: the iteration ends when it is at most this share of the first.
const REST_SHARE: f64 = 0.1;

/// The Ritz value has settled if one more step reduces it by no more than this share.
const SETTLED_RITZ: f64 = 0.15;

/// With the hierarchy of A itself, hardly an eigenvalue of M A is above one. Springs that no level knows enlarge some
/// of them and leave the others. A least Ritz value above one has therefore met only the springs so far.
const MOST_RITZ: f64 = 1.0;

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

impl Preconditioned<'_> {
    /// Bounds `sqrt(r' A^-1 r)` of a force r (length n) for a definite A, by conjugate gradients; `None` if the cycles
    /// do not settle, or if `watch` is over before they do.
    pub fn dual_norm(&self, force: &[f64], watch: &Watch) -> Option<DualNorm> {
        self.dual_norms(force, &[], 1, watch)?.pop()
    }

    /// The same for the force on each of the blocks of A.
    ///
    /// One cycle serves all blocks, but each block has its own conjugate gradients. So a soft block is not lost beside
    /// a stiff one.
    pub fn dual_norms(
        &self,
        force: &[f64],
        of_unknown: &[usize],
        count: usize,
        watch: &Watch,
    ) -> Option<Vec<DualNorm>> {
        let blocks = Blocks { of_unknown, count };
        let largest = |values: &[f64]| {
            let mut most = vec![0.0_f64; blocks.count];
            values.iter().enumerate().for_each(|(i, value)| most[blocks.of(i)] = most[blocks.of(i)].max(value.abs()));
            most
        };
        let units: Vec<i32> = largest(force).into_iter().map(|largest| -exponent(largest)).collect();
        let force: Vec<f64> = force.iter().enumerate().map(|(i, &value)| ldexp(value, units[blocks.of(i)])).collect();
        let mut iterate = Iterate::new(vec![0.0; force.len()], force.clone(), blocks);
        let mut lanczos = vec![Lanczos::default(); blocks.count];
        for cycles in 1..=MOST_CYCLES {
            if watch.is_over() {
                return None;
            }
            let both: Vec<f64> = force.iter().zip(&iterate.rest).map(|(force, rest)| force + rest).collect();
            let known = blocks.dots(&iterate.solution, &both);
            let rest = largest(&iterate.rest);
            let mut step = self.multigrid.cycle(&iterate.rest);
            let in_cycle = blocks.dots(&iterate.rest, &step);
            for (index, lanczos) in lanczos.iter_mut().enumerate().filter(|entry| entry.1.found.is_none()) {
                match rest[index] > 0.0 {
                    true => lanczos.turn(known[index], in_cycle[index], cycles),
                    false => lanczos.end(known[index], 0.0, 1.0, cycles - 1),
                }
            }
            if lanczos.iter().all(|lanczos| lanczos.found.is_some()) {
                let in_unit = |(found, &unit): (DualNorm, &i32)| DualNorm {
                    least: ldexp(found.least, -unit),
                    most: ldexp(found.most, -unit),
                    ..found
                };
                return Some(lanczos.iter().filter_map(|lanczos| lanczos.found).zip(&units).map(in_unit).collect());
            }
            let is_found = |i: usize| lanczos[blocks.of(i)].found.is_some();
            step.iter_mut().enumerate().filter(|entry| is_found(entry.0)).for_each(|(_, entry)| *entry = 0.0);
            if !iterate.step(step, |p| self.product(p)) {
                return None;
            }
            for (index, lanczos) in lanczos.iter_mut().enumerate().filter(|entry| entry.1.found.is_none()) {
                lanczos.shares.push(iterate.shares[index]);
                lanczos.lengths.push(Some(iterate.lengths[index]).filter(|&length| length > 0.0)?);
            }
        }
        None
    }
}

/// The Lanczos coefficients of the conjugate gradients of one block.
#[derive(Clone, Debug, Default)]
struct Lanczos {
    lengths: Vec<f64>,
    /// The coefficient of the previous direction in each direction.
    shares: Vec<f64>,
    ritz: Option<f64>,
    found: Option<DualNorm>,
}

impl Lanczos {
    fn end(&mut self, known: f64, unknown: f64, ritz: f64, cycles: usize) {
        let norm = |square: f64| square.max(0.0).sqrt();
        self.found = Some(DualNorm { least: norm(known), most: norm(known + unknown), ritz, cycles });
    }

    /// Ends if the effect of a cycle on the residual shows that little of the energy is unknown.
    fn turn(&mut self, known: f64, in_cycle: f64, cycles: usize) {
        if self.lengths.is_empty() {
            return;
        }
        let ritz = least_eigenvalue(&self.lengths, &self.shares).min(MOST_RITZ);
        let earlier = self.ritz.replace(ritz).unwrap_or(f64::INFINITY);
        let unknown = in_cycle / (SAFETY * ritz);
        if unknown <= REST_SHARE * known && ritz >= (1.0 - SETTLED_RITZ) * earlier {
            self.end(known, unknown, ritz, cycles);
        }
    }
}

/// The least eigenvalue of the Lanczos matrix of conjugate gradients with these step lengths and these coefficients of
/// the previous directions, by counting signs.
fn least_eigenvalue(lengths: &[f64], shares: &[f64]) -> f64 {
    let entries = || {
        (0..lengths.len()).map(|k| {
            let (share, before) = if k == 0 { (0.0, 1.0) } else { (shares[k].max(0.0), lengths[k - 1]) };
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
