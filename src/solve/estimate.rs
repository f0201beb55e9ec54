//! What the direct and the iterative path will cost, from the size of a problem alone.

use crate::problem::ContactProblem;

/// Rigid motions of a body in space: its factor grows faster than that of a plane body.
const MOTIONS_IN_SPACE: usize = 6;

/// Estimated time and memory of the two paths.
///
/// Calibrated on blocks of Q4 and Hex8 (`cargo run --release --example multigrid`); good to a factor of two or so, since
/// the shape of a body and the degree of its mesh count as well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Bytes of the Cholesky factor.
    pub direct_bytes: f64,
    /// Seconds of the factorisation on one processor of 2024.
    pub direct_seconds: f64,
    /// Bytes of the multigrid hierarchy.
    pub multigrid_bytes: f64,
    /// Seconds of hierarchy and iteration.
    pub multigrid_seconds: f64,
}

impl Estimate {
    /// The estimate for `problem`; its near-null space tells whether it is a body in space.
    pub fn of(problem: &ContactProblem) -> Self {
        let dofs = problem.dofs() as f64;
        let entries = problem.stiffness().lower().entries() as f64;
        let in_space = problem.near_null().is_some_and(|near_null| near_null.count() >= MOTIONS_IN_SPACE);
        let (factor, seconds) = match in_space {
            true => (23.0 * dofs.powf(4.0 / 3.0), 6.5e-10 * dofs.powi(2)),
            false => (6.0 * dofs * dofs.max(2.0).log2(), 3.7e-9 * dofs.powf(1.5)),
        };
        Estimate {
            direct_bytes: 8.0 * factor,
            direct_seconds: seconds,
            multigrid_bytes: 16.0 * entries,
            multigrid_seconds: 1.3e-7 * entries,
        }
    }

    /// Is the iterative path the better one: much the faster, or the only one within `most_bytes`?
    pub fn prefers_multigrid(&self, most_bytes: f64) -> bool {
        // The direct path bounds the error in energy; in space it is preferred up to some 160,000 dofs.
        const CLEARLY: f64 = 20.0;
        self.direct_seconds > CLEARLY * self.multigrid_seconds
            || (self.direct_bytes > most_bytes && self.multigrid_bytes <= most_bytes)
    }
}
