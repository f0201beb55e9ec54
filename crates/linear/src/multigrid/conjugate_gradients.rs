//! The method of conjugate gradients, preconditioned by a hierarchy.

use super::Multigrid;
use crate::error::Error;
use crate::watch::Watch;
use crate::{Blocks, Iterate, SymmetricMatrix, generic, norm};

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
        for _ in 0..LOOKED {
            if watch.is_over() {
                return None;
            }
            if !iterate.step(self.multigrid.cycle(&iterate.rest), |p| self.product(p)) {
                return Some(iterate.direction);
            }
        }
        None
    }
}
