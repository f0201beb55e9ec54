//! What a solve may be told.

use crate::error::Error;

/// The method that finds the contact set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// The program chooses; today the QP.
    #[default]
    Auto,
    /// Convex QP by Clarabel, its contact set settled by the active-set loop.
    Qp,
    /// Active-set loop with Lagrange multipliers, from C = 0.
    ActiveSet,
    /// Penalty loop with a growing penalty.
    Penalty,
}

impl Method {
    /// The name in reports: `qp`, `active-set` or `penalty`.
    pub fn name(self) -> &'static str {
        match self {
            Method::Auto | Method::Qp => "qp",
            Method::ActiveSet => "active-set",
            Method::Penalty => "penalty",
        }
    }
}

/// Is the problem condensed onto the dofs of its contact rows?
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Condense {
    /// Where an estimate of work and memory says that it pays.
    #[default]
    Auto,
    /// Never: the methods work on all dofs.
    Never,
}

/// Settings of a solve; start from [`Settings::default`] or [`Settings::with_method`] and change fields.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// The method.
    pub method: Method,
    /// Is the problem condensed onto its contact dofs?
    pub condense: Condense,
    /// Threads of the sparse factorisations, at least 1.
    pub threads: usize,
    /// Tolerance of the certificate, relative: what `Ok` promises.
    pub tolerance: f64,
    /// Are the rows named whose contact is beyond doubt?
    pub prove: bool,
    /// Is the contact set of the QP settled by the active-set loop?
    pub polish: bool,
    /// Tolerance of the interior-point method, on data of order one.
    pub interior_point_tolerance: f64,
    /// Most iterations of a loop.
    pub max_iterations: usize,
    /// First penalty, in multiples of the local stiffness.
    pub first_penalty: f64,
    /// Last penalty, in multiples of the local stiffness; 1e8 balances penetration and rounding.
    pub last_penalty: f64,
    /// Penetration at which the penalty loop stops, relative to the largest displacement of a contact row.
    pub penetration_threshold: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            method: Method::Auto,
            condense: Condense::Auto,
            threads: 1,
            tolerance: 1e-9,
            prove: false,
            polish: true,
            interior_point_tolerance: 1e-9,
            max_iterations: 20_000,
            first_penalty: 1.0,
            last_penalty: 1e8,
            penetration_threshold: 1e-10,
        }
    }
}

impl Settings {
    /// The defaults with another method.
    pub fn with_method(method: Method) -> Self {
        Settings { method, ..Settings::default() }
    }

    /// Are all settings in their ranges?
    ///
    /// # Errors
    /// [`Error::Setting`] for the first that is not.
    pub(super) fn check(&self) -> Result<(), Error> {
        let positive = |name, value: f64| match value.is_finite() && value > 0.0 {
            true => Ok(()),
            false => Err(Error::Setting { name, value, allowed: "positive and finite" }),
        };
        positive("tolerance", self.tolerance)?;
        positive("interior_point_tolerance", self.interior_point_tolerance)?;
        positive("first_penalty", self.first_penalty)?;
        positive("last_penalty", self.last_penalty)?;
        if self.first_penalty > self.last_penalty {
            let value = self.first_penalty;
            return Err(Error::Setting { name: "first_penalty", value, allowed: "at most last_penalty" });
        }
        if self.penetration_threshold.is_nan() || self.penetration_threshold < 0.0 {
            let value = self.penetration_threshold;
            return Err(Error::Setting { name: "penetration_threshold", value, allowed: "zero or positive" });
        }
        if self.threads == 0 {
            return Err(Error::Setting { name: "threads", value: 0.0, allowed: "at least 1" });
        }
        if self.max_iterations == 0 {
            return Err(Error::Setting { name: "max_iterations", value: 0.0, allowed: "at least 1" });
        }
        Ok(())
    }
}
