//! Linear complementarity problems with bounds, solved by a quadratic program or by pivoting, and certified: find z
//! between l and u so that w = M z + q has `w_i >= 0` where `z_i = l_i`, `w_i <= 0` where `z_i = u_i`, and `w_i = 0`
//! between them.
//!
//! ```
//! use signorini_lcp::{Lcp, solve_lcp};
//! use signorini_qp::{Settings, SparseMatrix};
//! // A plane that is pressed onto two supports with z >= 0: w = [2 -1; -1 2] z + (-1, 3).
//! let matrix = SparseMatrix::from_triplets(2, 2, &[(0, 0, 2.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 2.0)])?;
//! let solution = solve_lcp(&Lcp::nonnegative(matrix, vec![-1.0, 3.0])?, &Settings::default())?;
//! assert_eq!((&solution.z[..], &solution.w[..]), (&[0.5, 0.0][..], &[0.0, 2.5][..]));
//! assert_eq!((solution.class, solution.is_unique), ("symmetric", Some(true)));
//! assert!(solution.error.unwrap().iter().all(|&error| error < 1e-14));
//! # Ok::<(), signorini_lcp::Error>(())
//! ```
//!
//! A front on [`signorini_qp`]: M is scaled, its class is found, and the class alone decides the methods.
//!
//! ```text
//! Lcp -> scaled -> class -> QP | gap program | principal pivoting | Lemke -> basis settled -> certificate
//! ```
//!
//! | class of M | methods in order |
//! |---|---|
//! | symmetric, semidefinite | principal pivoting and Lemke if it is singular; the QP min 1/2 z'Mz + q'z; Lemke |
//! | M + M' semidefinite | the convex gap program, or the QP whose multipliers are unknowns as well; Lemke |
//! | H-matrix with positive diagonal, P-matrix (n <= 16), M + M' definite | block principal pivoting before the others |
//! | any other | Lemke |
//!
//! A point is answered if its residual, recomputed from M, q, l and u, meets the tolerance, whatever it comes from.

#![forbid(unsafe_code)]
#![deny(missing_docs, clippy::print_stdout, clippy::print_stderr)]

mod answer;
mod basis;
mod certificate;
mod class;
mod error;
mod exact;
mod files;
mod lemke;
mod lu;
mod pivoting;
mod problem;
mod quadratic;
mod run;
mod scaled;

pub use answer::LcpSolution;
pub use error::Error;
pub use problem::Lcp;

use signorini_qp::{LinearError, Settings};

/// Solves a linear complementarity problem; `Ok` means that the residual of every unknown meets the tolerance of the
/// settings. Their method is that of the quadratic programs; iterations, memory and watch hold for pivoting as well.
///
/// # Errors
/// * [`Error::Infeasible`] with the ray y for inequalities that no point meets; a symmetric problem is never unbounded,
/// * [`Error::NotFound`] if no method found a point and there is no such ray: nothing is claimed,
/// * [`Error::NotCertified`] with the best point, if its residual exceeds the tolerance,
/// * [`Error::TooLarge`] if M has no method that takes sparse matrices, and is too large for a dense one,
/// * [`Error::Qp`] with `Setting`, `Interrupted`, `OutOfTime`, `NoRoom` or `Numerical`.
pub fn solve_lcp(lcp: &Lcp, settings: &Settings) -> Result<LcpSolution, Error> {
    run::solved(lcp, settings)
}

impl Lcp {
    /// The certificate of a point z of length n, in its units, that came from elsewhere: the same as that of
    /// [`solve_lcp`], with the method `given`.
    ///
    /// # Errors
    /// [`Error::Qp`] with `Length` or `NotFinite` for a wrong z, and `Numerical` if memory does not suffice for a
    /// factor.
    pub fn certify(&self, z: &[f64]) -> Result<LcpSolution, Error> {
        LinearError::check_length("unknowns z", z.len(), self.unknowns(), "rows of M")?;
        if let Some((at, &value)) = z.iter().enumerate().find(|entry| !entry.1.is_finite()) {
            let (name, at, allowed) = ("unknowns z", at.to_string(), "finite");
            return Err(LinearError::NotFinite { name, at, value, allowed }.into());
        }
        let start = std::time::Instant::now();
        let solution = certificate::examined(self, &class::Known::of(self)?, certificate::placed(self, z.to_vec()));
        Ok(LcpSolution { seconds: start.elapsed().as_secs_f64(), ..solution })
    }
}
