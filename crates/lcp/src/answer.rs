//! The parts of an answer: plain data.

use signorini_qp::ContactSet;

/// The class of M that decides the methods, as [`LcpSolution::class`] says: the first that M belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    Symmetric,
    Symmetrizable,
    H,
    Monotone,
    P,
    General,
}

impl Class {
    /// Returns `true` if M is that of a quadratic program, to rounding and with its rows in suitable units.
    pub fn is_alike(self) -> bool {
        [Class::Symmetric, Class::Symmetrizable].contains(&self)
    }

    pub fn name(self) -> &'static str {
        match self {
            Class::Symmetric => "symmetric",
            Class::Symmetrizable => "symmetrizable",
            Class::H => "h-matrix",
            Class::Monotone => "monotone",
            Class::P => "p-matrix",
            Class::General => "general",
        }
    }
}

/// Where an unknown lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// At its lower bound, with `w >= 0`.
    Lower,
    /// Between its bounds or at one of them, with w = 0.
    Between,
    /// At its upper bound, with `w <= 0`.
    Upper,
}

/// A point with its certificate, recomputed from M, q, l and u.
#[derive(Clone, Debug, PartialEq)]
pub struct LcpSolution {
    /// The unknowns z, length n, in their units.
    pub z: Vec<f64>,
    /// w = M z + q, length n, in units of q; summed with twice the working precision.
    pub w: Vec<f64>,
    /// The class of M, which decides the methods: `symmetric` and positive semidefinite; `symmetrizable` if it is so
    /// after its rows were multiplied by positive numbers; an `h-matrix` with positive diagonal (a vector d > 0 with
    /// `<M> d > 0` was found, `<M>` the comparison matrix); `monotone` (M + M' semidefinite, likewise); a `p-matrix`
    /// (decided for at most 16 unknowns); or `general`. Whether a matrix is semidefinite or symmetrizable is judged to
    /// rounding, and proves nothing: what is proven about solutions is `is_unique`.
    pub class: &'static str,
    /// `Some(true)` if there is proven to be one solution for every q, because M is a P-matrix; `Some(false)` if M, its
    /// rows multiplied by positive numbers, is proven to be symmetric and semidefinite: all solutions then share w, and
    /// whether there are several z is open; `None` if nothing is proven.
    pub is_unique: Option<bool>,
    /// Upper bounds on `|z_i - z_i*|` of the only solution z*, one entry per unknown, in units of z; or the reason why
    /// none is known. The rounding of its computation is included.
    pub error: Result<Vec<f64>, String>,
    /// Upper bounds on `|w_i - w_i*|` for every solution w*, one entry per row, in units of w; or the reason why none
    /// is known.
    pub image_error: Result<Vec<f64>, String>,
    /// The unknowns whose places the bounds prove: of every solution those with `w_i* > 0`, of the only one those
    /// strictly between their bounds, and those with `w_i* < 0`.
    pub proven: [ContactSet; 3],
    /// The residual `z - mid(l, z - w, u)`, one entry per unknown, relative, each side in its own scale: the least over
    /// the three places of what is missing there. What w misses is relative to `t_i = |q_i| + sum |M_ij z_j|`, a
    /// distance to a bound is taken as what it moves in any row k, relative to t_k.
    pub residual: Vec<f64>,
    /// `quadratic-program`, `gap-program`, `principal-pivoting`, `lemke` or `given`.
    pub method: &'static str,
    /// Iterations of this method: pivots, or those of the quadratic program.
    pub iterations: usize,
    /// Wall-clock seconds of all methods that were tried and of the certificate.
    pub seconds: f64,
}

impl LcpSolution {
    /// The unknown with the largest residual, and this residual.
    pub fn worst(&self) -> (usize, f64) {
        worst(&self.residual)
    }
}

/// The largest residual and its unknown; one that is not a number counts as infinite.
pub fn worst(residual: &[f64]) -> (usize, f64) {
    let rank = |value: f64| if value.is_nan() { f64::INFINITY } else { value };
    let worst = residual.iter().copied().map(rank).enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    worst.unwrap_or((0, 0.0))
}

/// The end of a method.
pub enum Found {
    /// A point, in units of z, perhaps a rough one.
    Point { z: Vec<f64>, iterations: usize },
    /// A ray in scaled units that may show that there is no solution.
    Ray(Vec<f64>),
    /// Nothing, for this reason.
    Nothing(String),
}
