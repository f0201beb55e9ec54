//! The certificate of an answer, and the goal that it is held against.

use std::ops::Not;

use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

/// Significant digits that a double holds.
const DIGITS_OF_DOUBLES: f64 = 16.0;

/// The conditions of an answer (u, lambda) and a bound on its error, recomputed from the original problem by
/// [`ContactProblem::certify`](crate::ContactProblem::certify), independently of the method.
///
/// Every measure is taken in its own scale, and no force is in the scale of the error. A *part* is a connected
/// component of K and B, without couplings below 1e-6 of `sqrt(K_ii K_jj)`; with `p` the part of a dof or row,
///
/// * `N_p = sqrt(u_p' K_pp u_p)` is its energy norm, N that of the whole;
/// * `E_p` is an upper bound on `norm_K(u_p - u_p*)`, E that of the whole;
/// * `b_i` is the largest `|B_ij| / sqrt(K_jj)` of row i;
/// * `t = |K||u| + |B|'|lambda| + |f|` are the terms that balance at each dof.
///
/// Residuals `r = f + B' lambda - K u` and distances `B u - g` are summed with twice the working precision.
///
/// An answer is certified to a tolerance T if no row pulls, its other conditions hold to T, and for the whole and every
/// part that moves `E_p <= T N_p`, or E_p is no more than rounding u to doubles does: `eps sqrt(|u_p|'|K||u_p|)`. A
/// part *rests* if its displacement is zero: no relative error exists then, and E_p must be rounding of the forces that
/// are in balance on it, without those that cancel to the last bit or that a row on one dof takes.
///
/// | field | formula, the largest over all dofs, rows or parts | decides |
/// |---|---|---|
/// | `energy_error` | E, infinite if no bound is known | |
/// | `energy_error_bound` | `E / N` | of u |
/// | `part_error_bound` | `E_p / N_p` of the whole and of each part that moves | of u |
/// | `penetration` | `(B u - g)_i+ / d_i`, with `d_i = max(abs(B_i) abs(u), abs(g_i), b_i N_p)` | of u |
/// | `adhesion` | `abs(B_ij) (lambda_i)_+ / t_j` | of lambda: it must be zero |
/// | `imbalance` | `abs(r_j) / sqrt(K_jj)` above rounding, relative to the largest `t_k / sqrt(K_kk)` of the part | of lambda |
/// | `open_force` | the smaller of `abs(B_ij lambda_i) / t_j` and `(g - B u)_i+ / d_i` | of lambda |
/// | `stationarity` | `abs(r_j) / t_j` | no |
/// | `complementarity` | `abs(lambda_i (B u - g)_i) / N^2` | no |
/// | `duality_gap` | `abs(u'Ku - f'u - lambda'g) / N^2` | no |
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
    /// Imbalance of forces, relative to the largest force on the part: the error of the multipliers, which E does not
    /// bound.
    pub imbalance: f64,
    /// Relative force over a relative open distance, the smaller of the two: a row that presses without touching.
    pub open_force: f64,
    /// Upper bound E on the error of the displacement in the energy norm, in the square root of the problem's unit of
    /// energy; infinite if none is known.
    pub energy_error: f64,
    /// Upper bound on the relative error of the displacement in the energy norm; infinite if none is known, or if a
    /// body rests and the bound is not zero.
    pub energy_error_bound: f64,
    /// The largest such bound over the whole and each part that moves.
    pub part_error_bound: f64,
    /// The same over the bounds that exceed the possible effect of rounding the displacement to double precision.
    pub energy_error_excess: f64,
    /// The tolerance that the answer meets without the excuse of rounding or, if none is, with it; infinite if it meets
    /// none.
    pub met_tolerance: f64,
    /// The way in which it meets the goal that it was judged by; `None` if it does not, or was not judged yet.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub met: Option<Met>,
    /// `true` if all parts with a stiffness rest: no relative error exists.
    pub at_rest: bool,
    /// Number of connected components of K and B, of which each has its own scale.
    pub parts: usize,
    /// Parts, of all these, without any displacement.
    pub parts_at_rest: usize,
    /// Number of dofs without stiffness, load and contact force: the energy does not see where they are. Only without a
    /// factor of K itself.
    #[serde(skip_serializing_if = "is_nothing")]
    pub loose_dofs: usize,
    /// The largest `E_p / F_p` over the parts that rest; F_p is the largest `|F_i| / sqrt(K_ii)` over the loads,
    /// contact forces and couplings on the part: the energy norm that they could give a single dof.
    pub rest_error: f64,
    /// The place at which most digits cancel in the balance of forces.
    #[serde(flatten)]
    pub(crate) cancellation: Cancellation,
    /// `true` if the bound uses a measured eigenvalue, because K was not factorised: half the least Ritz value of K
    /// with its multigrid cycle.
    #[serde(skip_serializing_if = "Not::not")]
    pub bound_is_measured: bool,
}

/// The reason for which an answer counts as certified: by its tolerance, by its accuracy, or because only rounding is
/// left.
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

/// A number that is zero, or another value that says nothing, is left out of a report.
pub fn is_nothing<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

impl Certificate {
    /// The certificate of an answer that was not looked at yet: nothing holds.
    pub(crate) fn unknown() -> Self {
        let nothing = f64::INFINITY;
        Certificate {
            stationarity: nothing,
            penetration: nothing,
            adhesion: nothing,
            complementarity: nothing,
            duality_gap: nothing,
            imbalance: nothing,
            open_force: nothing,
            energy_error: nothing,
            energy_error_bound: nothing,
            part_error_bound: nothing,
            energy_error_excess: nothing,
            met_tolerance: nothing,
            met: None,
            at_rest: false,
            parts: 1,
            parts_at_rest: 0,
            loose_dofs: 0,
            rest_error: 0.0,
            cancellation: Cancellation { dof: 0, forces: 0.0, left: 0.0 },
            bound_is_measured: false,
        }
    }

    /// The dof, from 0, at which loads and contact forces cancel most digits of the elastic force.
    pub fn worst_dof(&self) -> usize {
        self.cancellation.dof
    }

    /// Digits of the elastic force that doubles can hold at that dof, from 0 to 16.
    pub fn digits_left(&self) -> f64 {
        self.cancellation.digits_left()
    }

    /// `tolerance` if the answer meets the goal that it was judged by with its error, `rounding` if its error is more
    /// than that, but no more than rounding the displacement to doubles does; `None` if it does not meet the goal.
    pub fn met(&self) -> Option<&'static str> {
        self.met.map(|met| match met {
            Met::Tolerance => "tolerance",
            Met::Rounding => "rounding",
        })
    }

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

    /// The conditions that decide, beside the bound on the error, with their names.
    fn deciding(&self) -> [(&'static str, f64); 4] {
        [
            ("imbalance", self.imbalance),
            ("penetration", self.penetration),
            ("adhesion", self.adhesion),
            ("open_force", self.open_force),
        ]
    }

    /// Returns the worst of the numbers that decide, with its name; NaN is the worst of all. The bound on the error
    /// counts if there is one and it is more than rounding.
    pub fn worst(&self) -> (&'static str, f64) {
        let rank = |value: f64| if value.is_nan() { f64::INFINITY } else { value };
        let is_of_part = self.part_error_bound > self.energy_error_bound || self.parts_at_rest > 0;
        let name = if is_of_part { "energy_error_bound of a part" } else { "energy_error_bound" };
        let bound = self.has_bound().then_some((name, self.energy_error_excess));
        let all = bound.into_iter().chain(self.deciding());
        all.max_by(|a, b| rank(a.1).total_cmp(&rank(b.1))).unwrap_or(("imbalance", 0.0))
    }

    /// Returns `true` if all conditions hold to `tolerance`. This says nothing about the error of the displacement.
    pub fn conditions_hold(&self, tolerance: f64) -> bool {
        self.deciding().iter().all(|&(_, value)| value <= tolerance)
    }

    /// Returns `true` if the answer is certified to `tolerance`: no row pulls, all conditions hold to `tolerance`, and
    /// the error of the whole and of every part that moves is at most `tolerance`, or explained by rounding the
    /// displacement to double precision.
    pub fn meets(&self, tolerance: f64) -> bool {
        self.adhesion == 0.0
            && self.conditions_hold(tolerance)
            && self.has_bound()
            && self.energy_error_excess <= tolerance
    }

    /// The condition that decides whether the answer is certified, its value, and the value allowed for it.
    pub fn decisive(&self, tolerance: f64) -> (&'static str, f64, f64) {
        match self.worst() {
            _ if self.adhesion != 0.0 => ("adhesion", self.adhesion, 0.0),
            _ if self.conditions_hold(tolerance) && !self.has_bound() => {
                ("energy_error_bound", f64::INFINITY, tolerance)
            }
            (condition, value) => (condition, value, tolerance),
        }
    }

    /// The smallest tolerance to which the answer is certified; infinite if there is none.
    pub fn reached(&self) -> f64 {
        let (_, reached) = self.worst();
        if self.meets(reached) { reached } else { f64::INFINITY }
    }

    /// Returns `true` if this falls short by less than `share` of what `before` does. A bound is better than none.
    pub(crate) fn improves_on(&self, before: &Certificate, share: f64) -> bool {
        if self.has_bound() == before.has_bound() {
            self.worst().1 < share * before.worst().1
        } else {
            self.has_bound()
        }
    }

    /// Returns `true` if another step may still help: the goal is not met, or forces work over open distances, or are
    /// out of balance at a dof. No goal judges these, and the bound does not see them where a part moves far with
    /// little energy.
    pub(crate) fn asks_for_more(&self, goal: Goal) -> bool {
        !goal.is_met_by(self)
            || (self.complementarity.is_finite() && self.complementarity > goal.required())
            || self.stationarity > goal.required()
    }

    /// Returns `true` if this certificate is better than `before` by the factor `share`.
    pub(crate) fn gains_on(&self, before: &Certificate, goal: Goal, share: f64) -> bool {
        if !goal.is_met_by(before) {
            return self.improves_on(before, share);
        }
        let is_balanced = self.stationarity < share * before.stationarity && before.stationarity > goal.required();
        goal.is_met_by(self) && (is_balanced || self.complementarity < share * before.complementarity)
    }

    /// The same numbers, with the statement that they meet `goal`, and in which way.
    pub fn judged(mut self, goal: Goal) -> Self {
        let tolerance = goal.required();
        let met = if self.part_error_bound <= tolerance { Met::Tolerance } else { Met::Rounding };
        self.met = self.meets(tolerance).then_some(met);
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
