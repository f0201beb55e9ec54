//! The certificate of an answer, and the goal that it is held against.

use std::ops::Not;

use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

/// Significant digits that a double holds.
const DIGITS_OF_DOUBLES: f64 = 16.0;

/// What can be said of an answer (u, lambda), recomputed from the original problem by
/// [`ContactProblem::certify`](crate::ContactProblem::certify), independently of the method.
///
/// Every measure is taken in its own scale, and no force is in the scale of the error. A *part* is a connected component of K
/// and B, without couplings below 1e-6 of `sqrt(K_ii K_jj)`; with `p` the part of a dof or row,
///
/// * `N_p = sqrt(u_p' K_pp u_p)` is its energy norm, N that of the whole;
/// * `E_p` is an upper bound on `norm_K(u_p - u_p*)`, E that of the whole;
/// * `b_i` is the largest `|B_ij| / sqrt(K_jj)` of row i;
/// * `t = |K||u| + |B|'|lambda| + |f|` are the terms that balance at each dof.
///
/// Residuals `r = f + B' lambda - K u` and distances `B u - g` are summed with twice the working precision.
///
/// An answer is certified to a tolerance T if no row pulls, `penetration <= T`, and for the whole and every part that moves
/// `E_p <= T N_p`, or E_p is no more than rounding u to doubles does: `eps sqrt(|u_p|'|K||u_p|)`. A part *rests* if its
/// displacement is zero: no relative error exists then, and E_p must be rounding of the forces that are in balance on it.
///
/// | field | formula, the largest over all dofs, rows or parts | decides |
/// |---|---|---|
/// | `energy_error` | E, infinite if no bound is known | |
/// | `energy_error_bound` | `E / N` | yes |
/// | `part_error_bound` | `E_p / N_p` of the whole and of each part that moves | yes |
/// | `penetration` | `(B u - g)_i+ / max(abs(B_i) abs(u), abs(g_i), b_i N_p)` | yes |
/// | `adhesion` | `abs(B_ij) (lambda_i)_+ / t_j` | yes: it must be zero |
/// | `stationarity` | `abs(r_j) / t_j` | no |
/// | `complementarity` | `abs(lambda_i (B u - g)_i) / N^2` | no |
/// | `duality_gap` | `abs(u'Ku - f'u - lambda'g) / N^2` | no |
/// | `backward_error` | largest of stationarity, penetration, adhesion, and a force that acts over an open distance | no |
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Certificate {
    /// Imbalance of forces, as a share of its terms. It explains an error and does not bound it.
    pub stationarity: f64,
    /// Relative penetration into the obstacle.
    pub penetration: f64,
    /// Relative wrong-signed multiplier: an obstacle that pulls.
    pub adhesion: f64,
    /// Work of the forces over open distances, relative to twice the strain energy; infinite for a body at rest.
    pub complementarity: f64,
    /// Difference of the primal and the dual energy, relative to twice the strain energy; infinite for a body at rest.
    pub duality_gap: f64,
    /// The answer is exact for data that are changed by about this share, entry by entry. It does not bound the error.
    #[serde(skip)]
    pub backward_error: f64,
    /// Upper bound E on the error of the displacement in the energy norm, in the square root of the problem's unit of energy;
    /// infinite if none is known.
    pub energy_error: f64,
    /// Upper bound on the relative error of the displacement in the energy norm; infinite if none is known, or if a body rests
    /// and the bound is not zero.
    pub energy_error_bound: f64,
    /// The largest such bound over the whole and each part that moves.
    pub part_error_bound: f64,
    /// The same over the bounds that exceed the possible effect of rounding the displacement to double precision.
    pub energy_error_excess: f64,
    /// The tolerance that the answer meets without the excuse of rounding or, if none is, with it; infinite if it meets none.
    pub met_tolerance: f64,
    /// The way in which it meets the goal that it was judged by; `None` if it does not, or was not judged yet.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub met: Option<Met>,
    /// `true` if all parts with a stiffness rest: no relative error exists.
    pub at_rest: bool,
    /// Number of connected components of K and B, of which each has its own scale.
    pub parts: usize,
    /// Number of parts that rest.
    pub parts_at_rest: usize,
    /// The largest `E_p / F_p` over the parts that rest; F_p is the largest `|F_i| / sqrt(K_ii)` over the loads, contact forces
    /// and couplings on the part: the energy norm that they could give a single dof.
    pub rest_error: f64,
    /// The dof at which most digits cancel in the balance of forces.
    #[serde(flatten)]
    pub cancellation: Cancellation,
    /// `true` if the bound uses a measured eigenvalue, because K was not factorised: half the least Ritz value of K with its
    /// multigrid cycle.
    #[serde(skip_serializing_if = "Not::not")]
    pub bound_is_measured: bool,
}

/// The way in which an answer meets its goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Met {
    /// Its error is at most the tolerance.
    Tolerance,
    /// Its error is at most what rounding the displacement to doubles does, which is more than the tolerance.
    Rounding,
}

/// The dof at which loads and contact forces cancel most digits of what is left for the elastic force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cancellation {
    /// The dof, from 0.
    pub dof: usize,
    /// `(|B|'|lambda| + |f|)_i`, the forces that cancel, in the problem's unit of force.
    pub forces: f64,
    /// `|K u|_i`, the elastic force that is left, in the same unit.
    pub left: f64,
}

impl Cancellation {
    /// Digits of the elastic force that doubles can hold, from 0 to 16.
    pub fn digits_left(&self) -> f64 {
        let lost = if self.forces > self.left { (self.forces / self.left).log10() } else { 0.0 };
        (DIGITS_OF_DOUBLES - lost).max(0.0)
    }
}

/// The dof and the digits that are left there.
impl Serialize for Cancellation {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut object = serializer.serialize_struct("Cancellation", 2)?;
        object.serialize_field("worst_dof", &self.dof)?;
        object.serialize_field("digits_left", &self.digits_left())?;
        object.end()
    }
}

impl Certificate {
    /// The conditions with their names, in the order of the fields.
    pub fn conditions(&self) -> [(&'static str, f64); 5] {
        [
            ("stationarity", self.stationarity),
            ("penetration", self.penetration),
            ("adhesion", self.adhesion),
            ("complementarity", self.complementarity),
            ("duality_gap", self.duality_gap),
        ]
    }

    /// Returns `true` if an upper bound on the error is known.
    pub fn has_bound(&self) -> bool {
        self.energy_error.is_finite()
    }

    /// Returns `true` if the answer is exact for data that are changed by the share `tolerance`, entry by entry. This says
    /// nothing about the error of the displacement.
    pub fn conditions_hold(&self, tolerance: f64) -> bool {
        self.backward_error <= tolerance
    }

    /// Returns `true` if the answer is certified to `tolerance`: no row pulls, no row is violated by more than `tolerance`, and
    /// the error of the whole and of every part that moves is at most `tolerance`, or explained by rounding the displacement to
    /// double precision.
    pub fn meets(&self, tolerance: f64) -> bool {
        self.adhesion == 0.0
            && self.penetration <= tolerance
            && self.has_bound()
            && self.energy_error_excess <= tolerance
    }

    /// The condition that decides whether the answer is certified, its value, and the value allowed for it.
    pub fn decisive(&self, tolerance: f64) -> (&'static str, f64, f64) {
        let excess = self.energy_error_excess;
        match self.part_error_bound > self.energy_error_bound {
            _ if self.adhesion != 0.0 => ("adhesion", self.adhesion, 0.0),
            _ if !self.has_bound() => ("energy_error_bound, of which none is known,", f64::INFINITY, tolerance),
            _ if self.penetration.is_nan() || self.penetration > excess => {
                ("penetration", self.penetration, tolerance)
            }
            true => ("energy_error_bound of a part", excess, tolerance),
            false => ("energy_error_bound", excess, tolerance),
        }
    }

    /// The smallest tolerance to which the answer is certified; infinite if there is none.
    pub fn reached(&self) -> f64 {
        let reached = self.penetration.max(self.energy_error_excess);
        if self.meets(reached) { reached } else { f64::INFINITY }
    }

    /// Returns `true` if this certificate falls short by less than `share` of what `before` falls short by. One with a bound is
    /// better than one without; without a bound, the backward error is compared.
    pub(crate) fn improves_on(&self, before: &Certificate, share: f64) -> bool {
        match (self.has_bound(), before.has_bound()) {
            (true, true) => self.shortfall() < share * before.shortfall(),
            (false, false) => self.backward_error < share * before.backward_error,
            (has_bound, _) => has_bound,
        }
    }

    /// The largest of the numbers that decide.
    fn shortfall(&self) -> f64 {
        self.penetration.max(self.adhesion).max(self.energy_error_excess)
    }

    /// The certificate judged by `goal`.
    pub(crate) fn judged(mut self, goal: Goal) -> Self {
        let tolerance = goal.required();
        self.met = self.meets(tolerance).then_some(match self.part_error_bound <= tolerance {
            true => Met::Tolerance,
            false => Met::Rounding,
        });
        self
    }
}

/// The goal that an answer must meet: a tolerance, or an accuracy in its place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Goal {
    /// Relative tolerance of an answer as exact as its method makes it.
    pub tolerance: f64,
    /// Relative error in the energy norm that is good enough; if one is named, it replaces the tolerance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<f64>,
}

impl From<f64> for Goal {
    fn from(tolerance: f64) -> Self {
        Goal { tolerance, accuracy: None }
    }
}

impl Goal {
    /// The tolerance to which an answer must be certified.
    pub fn required(&self) -> f64 {
        self.accuracy.unwrap_or(self.tolerance)
    }

    /// Returns `true` if an answer with this certificate reaches the goal.
    pub fn is_met_by(&self, certificate: &Certificate) -> bool {
        certificate.meets(self.required())
    }
}
