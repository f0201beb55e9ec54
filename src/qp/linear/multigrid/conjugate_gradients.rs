//! The method of conjugate gradients, preconditioned by a hierarchy.

use super::Multigrid;
use crate::error::Error;
use crate::qp::linear::{SymmetricMatrix, dot, generic};
use crate::watch::Watch;

/// The answer of a linear solve.
#[derive(Clone, Debug, PartialEq)]
pub struct ConjugateGradients {
    /// The solution x.
    pub solution: Vec<f64>,
    /// Number of cycles of the hierarchy.
    pub cycles: usize,
    /// `|b - A x| / |b|`, for the residual that the iteration updates.
    pub residual: f64,
}

/// Solves A x = b to `|b - A x| <= tolerance |b|` in the Euclidean norm, in at most `most_cycles` cycles.
///
/// The tolerance was met if `residual` is at most `tolerance`.
///
/// # Errors
/// [`Error::NotConvex`] if a search direction has negative energy.
pub fn conjugate_gradients(
    matrix: &SymmetricMatrix,
    b: &[f64],
    multigrid: &Multigrid,
    tolerance: f64,
    most_cycles: usize,
) -> Result<ConjugateGradients, Error> {
    let size = dot(b, b).sqrt();
    let mut x = vec![0.0; b.len()];
    let mut rest = b.to_vec();
    let mut residual = if size > 0.0 { 1.0 } else { 0.0 };
    let mut direction: Vec<f64> = Vec::new();
    let mut moved: Vec<f64> = Vec::new();
    let mut energy = 0.0;
    let mut cycles = 0;
    while residual > tolerance && cycles < most_cycles {
        let step = multigrid.cycle(&rest);
        cycles += 1;
        if direction.is_empty() {
            direction = step;
        } else {
            // Made conjugate to the last direction itself, so that rounding of the cycle to single precision does no harm.
            let share = dot(&step, &moved) / energy;
            direction.iter_mut().zip(&step).for_each(|(d, z)| *d = z - share * *d);
        }
        moved = matrix.mul_on(multigrid.threads(), &direction);
        energy = dot(&direction, &moved);
        if energy <= 0.0 {
            let evidence = format!("a search direction p has p'Kp = {energy:e}");
            return Err(Error::NotConvex { evidence });
        }
        let length = dot(&direction, &rest) / energy;
        x.iter_mut().zip(&direction).for_each(|(x, d)| *x += length * d);
        rest.iter_mut().zip(&moved).for_each(|(rest, moved)| *rest -= length * moved);
        residual = dot(&rest, &rest).sqrt() / size;
    }
    Ok(ConjugateGradients { solution: x, cycles, residual })
}

/// Number of cycles within which conjugate gradients from a generic force meet a direction of negative energy, if there is one.
const LOOKED: usize = 25;

/// A direction without positive energy. Conjugate gradients from a generic force meet it if the matrix has a negative
/// eigenvalue that its hierarchy does not hide; rounding may give one for a semidefinite matrix. `None` if no direction is met,
/// or if `watch` is over.
pub fn negative_direction(matrix: &SymmetricMatrix, multigrid: &Multigrid, watch: &Watch) -> Option<Vec<f64>> {
    let mut rest = generic(matrix.dim(), 0);
    let (mut direction, mut moved, mut energy) = (vec![0.0; rest.len()], vec![0.0; rest.len()], 1.0);
    for _ in 0..LOOKED {
        if watch.is_over() {
            return None;
        }
        let step = multigrid.cycle(&rest);
        let share = dot(&step, &moved) / energy;
        direction.iter_mut().zip(&step).for_each(|(d, z)| *d = z - share * *d);
        moved = matrix.mul_on(multigrid.threads(), &direction);
        energy = dot(&direction, &moved);
        if energy <= 0.0 {
            return Some(direction);
        }
        let length = dot(&direction, &rest) / energy;
        rest.iter_mut().zip(&moved).for_each(|(rest, moved)| *rest -= length * moved);
    }
    None
}
