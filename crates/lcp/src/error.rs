//! The errors of complementarity problems: each states what is wrong, where, which value, and what is allowed.

use signorini_qp::memory::in_words as memory;
use signorini_qp::{Failure, LinearError};

use crate::answer::LcpSolution;

/// All errors between M, q, l and u and a verified answer. Each has a [`code`](Self::code), and one sentence for a
/// reader.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An error of the quadratic program, of an array or of a setting, with the same sentence and the same code.
    #[error(transparent)]
    Qp(#[from] signorini_qp::Error),
    /// Bounds between which no unknown lies.
    #[error(
        "the bounds of unknown {index} (indices from 0) are {lower:e} and {upper:e}; the lower one must be at most the upper one, below \
         1e20, and the upper one above -1e20"
    )]
    Bounds {
        /// The unknown, counted from 0.
        index: usize,
        /// The bound from below, in the unit of z.
        lower: f64,
        /// The bound from above, in the unit of z.
        upper: f64,
    },
    /// Inequalities that no point meets, so that there is no solution.
    #[error(
        "infeasible: no z between its bounds has w = M z + q of the required signs: the rows, weighted with the ray y (y.mtx of \
         an output), demand {needed:.3e} of a sum that is at most zero"
    )]
    Infeasible {
        /// The ray y, one entry per row, in units of z, largest entry from 1 to 2: `y_i >= 0` if only the lower bound
        /// is finite, `<= 0` if only the upper one is, 0 if both are. Without any rounding, with c = M'y, `c_i <= 0`
        /// if the upper bound is infinite and `c_i >= 0` if the lower one is (for z >= 0: y >= 0, M'y <= 0, q'y < 0).
        ray: Vec<f64>,
        /// The positive number -(q'y + sum of c_i u_i over c_i > 0 and of c_i l_i over c_i < 0), in units of q times y.
        needed: f64,
    },
    /// No point was found, and none is shown to be impossible.
    #[error("no solution was found, which proves nothing: {reason}")]
    NotFound {
        /// The methods that were tried, and how they ended, in words.
        reason: String,
    },
    /// A point was found, but its residual exceeds the tolerance.
    #[error(
        "not certified: the residual of unknown {index} (indices from 0) is {residual:.3e} of its terms, above the tolerance {tolerance:.1e}"
    )]
    NotCertified {
        /// The best point, with its certificate.
        solution: Box<LcpSolution>,
        /// The unknown with the largest residual, from 0.
        index: usize,
        /// This residual, dimensionless.
        residual: f64,
        /// The largest that the settings allow, dimensionless.
        tolerance: f64,
    },
    /// A matrix that is too large for the only method that fits its class.
    #[error(
        "the matrix is not symmetric, and pivoting on its {unknowns} unknowns needs about {} of memory, but {} are allowed",
        memory(*bytes),
        memory(*allowed)
    )]
    TooLarge {
        /// Number of unknowns, with those that bounds add.
        unknowns: usize,
        /// Memory of the dense matrices, in bytes.
        bytes: f64,
        /// Bytes that they may take.
        allowed: f64,
    },
}

impl From<LinearError> for Error {
    fn from(error: LinearError) -> Self {
        Error::Qp(error.into())
    }
}

impl Error {
    /// The name of the kind of error, the same in every version.
    pub fn code(&self) -> &'static str {
        self.class().0
    }

    /// The `status` of a report that ends with the error, such as `not_found`.
    pub fn status(&self) -> &'static str {
        self.class().1
    }

    /// The statement of the error about the problem, which decides the exit code.
    pub fn failure(&self) -> Failure {
        self.class().2
    }

    fn class(&self) -> (&'static str, &'static str, Failure) {
        match self {
            Error::Qp(error) => (error.code(), error.status(), error.failure()),
            Error::Bounds { .. } => ("bounds", "bad_input", Failure::BadInput),
            Error::Infeasible { .. } => ("infeasible", "infeasible", Failure::NoSolution),
            Error::NotFound { .. } => ("not-found", "not_found", Failure::NotCertified),
            Error::NotCertified { .. } => ("not-certified", "not_certified", Failure::NotCertified),
            Error::TooLarge { .. } => ("too-large", "bad_input", Failure::BadInput),
        }
    }
}
