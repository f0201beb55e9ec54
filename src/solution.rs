//! The parts of an answer: plain data, no logic of the solvers.
//!
//! Every type serialises as it appears in a report; a number that is not finite is null there.

use std::fmt;
use std::ops::Not;

use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

/// Rounding of the entries of an assembled stiffness, as a share of its diagonal.
const ROUNDED_ENTRIES: f64 = 512.0 * f64::EPSILON;

/// The contact indicator C of the formulation: the closed rows of `rows` contact rows.
///
/// Stored as bits, so that a method can keep its whole history of sets.
#[derive(Clone, PartialEq, Eq, Hash, Default)]
pub struct ContactSet {
    rows: usize,
    bits: Vec<u64>,
}

impl ContactSet {
    /// The set of `rows` rows, all open.
    pub fn open(rows: usize) -> Self {
        ContactSet { rows, bits: vec![0; rows.div_ceil(64)] }
    }

    /// The set of `rows` rows, all closed.
    pub fn closed(rows: usize) -> Self {
        Self::from_fn(rows, |_| true)
    }

    /// The set of `rows` rows in which row `i` is closed if `closed(i)` is `true`.
    pub fn from_fn(rows: usize, mut closed: impl FnMut(usize) -> bool) -> Self {
        let mut set = Self::open(rows);
        (0..rows).filter(|&row| closed(row)).for_each(|row| set.insert(row));
        set
    }

    /// Number of contact rows, closed or open.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of closed rows.
    pub fn count(&self) -> usize {
        self.bits.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Returns `true` if row `row` is closed. Rows beyond the last are open.
    pub fn contains(&self, row: usize) -> bool {
        row < self.rows && self.bits[row / 64] >> (row % 64) & 1 == 1
    }

    /// Closes row `row`; a row beyond the last is ignored.
    pub fn insert(&mut self, row: usize) {
        if row < self.rows {
            self.bits[row / 64] |= 1 << (row % 64);
        }
    }

    /// Opens row `row`; a row beyond the last is ignored.
    pub fn remove(&mut self, row: usize) {
        if row < self.rows {
            self.bits[row / 64] &= !(1 << (row % 64));
        }
    }

    /// Closes row `row` if it is open, and opens it if it is closed; a row beyond the last is ignored.
    pub fn toggle(&mut self, row: usize) {
        if row < self.rows {
            self.bits[row / 64] ^= 1 << (row % 64);
        }
    }

    /// The closed rows in increasing order.
    pub fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.rows).filter(|&row| self.contains(row))
    }
}

/// One flag for each row: `true` if it is closed.
impl FromIterator<bool> for ContactSet {
    fn from_iter<I: IntoIterator<Item = bool>>(closed: I) -> Self {
        let mut set = Self::default();
        for is_closed in closed {
            if set.rows.is_multiple_of(64) {
                set.bits.push(0);
            }
            set.rows += 1;
            if is_closed {
                set.insert(set.rows - 1);
            }
        }
        set
    }
}

/// The closed rows in increasing order.
impl<'a> IntoIterator for &'a ContactSet {
    type Item = usize;
    type IntoIter = Box<dyn Iterator<Item = usize> + 'a>;

    fn into_iter(self) -> Self::IntoIter {
        Box::new(self.iter())
    }
}

impl fmt::Debug for ContactSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} of {}", self.iter().collect::<Vec<_>>(), self.rows)
    }
}

/// Violation, by an answer (u, lambda), of the conditions that define the solution, each relative and dimensionless.
///
/// Recomputed from the original problem by [`ContactProblem::certify`](crate::ContactProblem::certify), independently of the
/// method. Every measure is taken in its own scale. A *part* is a connected component of K and B, without couplings below 1e-6
/// of `sqrt(K_ii K_jj)`; with `p` the part of a dof or row,
///
/// * `N_p = sqrt(u_p' K_pp u_p)` is its energy norm and `F_p` the largest `|F_i| / sqrt(K_ii)` of its loads and contact forces;
///   if the part is at rest, a millionth of `F_p` replaces `N_p`;
/// * `E_p` is the largest of `N_p^2 / 2`, `|f' u|_p`, `|g' lambda|_p` and a millionth of `F_p^2 / 2`;
/// * `b_i` is the largest `|B_ij| / sqrt(K_jj)` of row i.
///
/// Residuals `r = f + B' lambda - K u` and distances `B u - g` are summed with twice the working precision.
///
/// | field | formula, the largest over all dofs, rows or parts |
/// |---|---|
/// | `stationarity` | `abs(r_i) / sqrt(K_ii) / F_p` |
/// | `stationarity_excess` | the same, unless it is explained by rounding u and lambda to double precision |
/// | `penetration` | `(B u - g)_i+ / max(abs(B_i) abs(u), abs(g_i), b_i N_p)` |
/// | `adhesion` | `(lambda_i)_+ b_i / F_p` |
/// | `complementarity` | `abs(lambda_i (B u - g)_i) / E_p`, unless the distance is explained by rounding u |
/// | `duality_gap` | `abs(u'Ku - f'u - lambda'g)_p / E_p`, the part above rounding |
/// | `energy_error_bound` | an upper bound on `norm_K(u - u*) / norm_K(u)`, infinite if none is known |
/// | `part_error_bound` | the largest of this bound and those of the parts |
/// | `energy_error_excess` | the same, unless it is explained by rounding u to double precision |
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Certificate {
    /// Relative imbalance of forces.
    pub stationarity: f64,
    /// Relative imbalance of forces, if it is more than rounding.
    pub stationarity_excess: f64,
    /// Relative penetration into the obstacle.
    pub penetration: f64,
    /// Relative wrong-signed multiplier: an obstacle that pulls.
    pub adhesion: f64,
    /// Relative product of force and open distance.
    pub complementarity: f64,
    /// Relative difference of the primal and the dual energy.
    pub duality_gap: f64,
    /// Upper bound on the relative error of the displacement in the energy norm; infinite if none is known.
    pub energy_error_bound: f64,
    /// The largest such bound over the whole and each part; that of the whole if K was not factorised.
    pub part_error_bound: f64,
    /// The same over the bounds that exceed the possible effect of rounding the displacement to double precision.
    pub energy_error_excess: f64,
    /// Number of connected components of K and B, of which each has its own scale.
    pub parts: usize,
    /// `true` if the bound uses a measured eigenvalue, because K was not factorised: half the least Ritz value of K with its
    /// multigrid cycle.
    #[serde(skip_serializing_if = "Not::not")]
    pub bound_is_measured: bool,
}

impl Certificate {
    /// The conditions with their names, in the order of the fields: they must meet a tolerance, beside the bound.
    pub fn conditions(&self) -> [(&'static str, f64); 5] {
        [
            ("stationarity", self.stationarity_excess),
            ("penetration", self.penetration),
            ("adhesion", self.adhesion),
            ("complementarity", self.complementarity),
            ("duality_gap", self.duality_gap),
        ]
    }

    /// Returns the worst condition and its value; NaN is the worst of all.
    ///
    /// The energy bound is compared with the conditions, if there is one and it is more than rounding.
    pub fn worst(&self) -> (&'static str, f64) {
        let rank = |value: f64| if value.is_nan() { f64::INFINITY } else { value };
        let bound = self.has_bound().then_some((self.bound_name(), self.energy_error_excess));
        bound
            .into_iter()
            .chain(self.conditions())
            .max_by(|a, b| rank(a.1).total_cmp(&rank(b.1)))
            .unwrap_or(("stationarity", 0.0))
    }

    fn bound_name(&self) -> &'static str {
        if self.part_error_bound > self.energy_error_bound {
            "energy_error_bound of a part"
        } else {
            "energy_error_bound"
        }
    }

    /// Returns `true` if an upper bound on the error is known.
    pub fn has_bound(&self) -> bool {
        !self.energy_error_bound.is_infinite()
    }

    /// Returns `true` if all conditions hold to `tolerance`. This says nothing about the error of the displacement.
    pub fn conditions_hold(&self, tolerance: f64) -> bool {
        self.conditions().iter().all(|&(_, value)| value <= tolerance)
    }

    /// Returns `true` if all conditions hold to `tolerance`, and the energy bound, for the whole and for every part, is at most
    /// `tolerance` or explained by rounding the displacement to double precision.
    pub fn meets(&self, tolerance: f64) -> bool {
        self.conditions_hold(tolerance) && self.has_bound() && self.energy_error_excess <= tolerance
    }
}

/// The goal that an answer must meet: a tolerance of all conditions, or an accuracy in energy instead.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Goal {
    /// Relative tolerance of the conditions.
    pub tolerance: f64,
    /// Relative error in the energy norm that is good enough; if one is named and a bound is known, the bound alone decides.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<f64>,
}

impl From<f64> for Goal {
    fn from(tolerance: f64) -> Self {
        Goal { tolerance, accuracy: None }
    }
}

impl Goal {
    /// The accuracy, if `certificate` has a bound to compare it with.
    fn accuracy_for(&self, certificate: &Certificate) -> Option<f64> {
        self.accuracy.filter(|_| !certificate.energy_error_bound.is_infinite())
    }

    /// Returns `true` if an answer with this certificate reaches the goal.
    pub fn is_met_by(&self, certificate: &Certificate) -> bool {
        match self.accuracy_for(certificate) {
            Some(accuracy) => certificate.part_error_bound <= accuracy,
            None => certificate.meets(self.tolerance),
        }
    }

    /// The decisive condition, its value, and the allowed value.
    pub fn decisive(&self, certificate: &Certificate) -> (&'static str, f64, f64) {
        match self.accuracy_for(certificate) {
            Some(accuracy) => ("reachable energy_error_bound", certificate.part_error_bound, accuracy),
            None if certificate.conditions_hold(self.tolerance) && !certificate.has_bound() => {
                ("energy_error_bound, of which none is known,", f64::INFINITY, self.tolerance)
            }
            None => {
                let (condition, value) = certificate.worst();
                (condition, value, self.tolerance)
            }
        }
    }
}

/// Rows that an answer proves to be open or closed in the exact answer of the same problem.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProvenSet {
    /// Rows with a distance that exceeds its own error bound.
    pub open: ContactSet,
    /// Rows with a force that exceeds its own error bound.
    pub closed: ContactSet,
}

impl ProvenSet {
    /// The rows that are proven neither open nor closed, in increasing order.
    pub fn undecided(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.open.rows()).filter(|&row| !self.open.contains(row) && !self.closed.contains(row))
    }
}

/// The numbers of open and of closed rows, and the undecided ones from 0.
impl Serialize for ProvenSet {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut object = serializer.serialize_struct("ProvenSet", 3)?;
        object.serialize_field("open", &self.open.count())?;
        object.serialize_field("closed", &self.closed.count())?;
        object.serialize_field("undecided", &self.undecided().collect::<Vec<_>>())?;
        object.end()
    }
}

/// Wall-clock seconds spent on an answer, by stage; the stages are parts of `solve`, and do not add up to it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seconds {
    /// Symbolic and numeric factorisations.
    pub factor: f64,
    /// Recomputation of the conditions and bound on the error.
    pub certificate: f64,
    /// Proof of the rows that are open and closed.
    pub proof: f64,
    /// Everything from the checked problem to the certified answer, factorisations, certificate, proof and earlier attempts included.
    pub solve: f64,
}

/// One iteration of a method: the contact set that it tried, and the penalty of its springs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Iteration {
    /// The closed rows in this iteration; a report has their number.
    #[serde(rename = "closed", serialize_with = "count")]
    pub contact_set: ContactSet,
    /// The penalty, in multiples of the local stiffness; zero if the method has none.
    #[serde(skip_serializing_if = "is_zero")]
    pub penalty: f64,
}

/// Serialises a contact set as the number of its closed rows.
fn count<S: Serializer>(set: &ContactSet, serializer: S) -> Result<S::Ok, S::Error> {
    set.count().serialize(serializer)
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// Reason for the way in which an answer was found: the ways that were compared before, and the decision.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Why {
    /// The chosen way: one of those considered, or the method that was requested by name.
    pub chosen: String,
    /// Reason of the decision, in words.
    pub reason: String,
    /// The ways that were compared; empty if a method was requested by name.
    pub considered: Vec<Expected>,
}

/// A way to an answer with its expected cost, before it was taken or left.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Expected {
    /// `factor`, for all methods that factorise (`active-set`, `qp`, `penalty`), or `mprgp`.
    pub method: String,
    /// Seconds from the problem to its answer, on one processor of 2024.
    pub seconds: f64,
    /// Bytes at the peak, the problem itself included.
    pub bytes: f64,
}

/// A way that was tried in addition to the one that gave the answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Attempt {
    /// Name of the method with its variant, as in [`Solution::method`].
    pub method: String,
    /// Wall-clock seconds that it took.
    pub seconds: f64,
    /// Reason why this attempt did not give the answer.
    pub reason: String,
}

/// The answer to a contact problem.
///
/// A report has its numbers without the vectors, which go into their own files.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Solution {
    /// Displacement u, one entry per dof, in the problem's unit of length, along the positive axes.
    #[serde(skip)]
    pub displacement: Vec<f64>,
    /// Contact multiplier lambda, one entry per contact row, in the problem's unit of force, `<= 0` in compression.
    #[serde(skip)]
    pub multiplier: Vec<f64>,
    /// The closed rows.
    #[serde(skip)]
    pub contact_set: ContactSet,
    /// `qp`, `active-set`, `penalty` or `mprgp`, with a suffix if a variant ran.
    pub method: String,
    /// Iterations of the method itself (linear solves of a loop, or interior-point steps).
    pub iterations: usize,
    /// The contact sets on the way, in order; for the QP the sets of its polish.
    pub history: Vec<Iteration>,
    /// The certificate, which measures how far the answer can be trusted.
    pub certificate: Certificate,
    /// The rows with proven contact or gap, if [`Settings::prove`](crate::Settings::prove) asks for them and an energy bound is
    /// known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub proven: Option<ProvenSet>,
    /// Steps of refinement, if the factor was in single precision.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refinements: Option<usize>,
    /// Reason why no factor was taken, in words, if [`Method::Auto`](crate::Method::Auto) decided that.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The ways that were compared before, and the decision; `None` if no method was chosen for this answer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub why: Option<Why>,
    /// Other attempts, in order; their time is in `seconds`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub attempts: Vec<Attempt>,
    /// The smallest pivot of the stiffness, for a diagonal of order one, if it is so close to rounding that digits are lost; 0
    /// if a pivot was not positive.
    #[serde(skip)]
    pub lost_pivot: Option<f64>,
    /// Unknowns that the method worked on; fewer than all if the problem was condensed.
    #[serde(skip)]
    pub condensed_dofs: usize,
    /// Time spent on it.
    #[serde(skip)]
    pub seconds: Seconds,
}

impl Solution {
    /// Digits of the displacement that the entries of the stiffness determine, approximately, if they are few: each entry is
    /// rounded to double precision, and the softest motion amplifies that by one over the smallest pivot. The certificate takes
    /// the entries as exact.
    pub fn digits_of_stiffness(&self) -> Option<u32> {
        self.lost_pivot.map(|pivot| (pivot / ROUNDED_ENTRIES).log10().round().max(0.0) as u32)
    }

    /// Total contact force `-sum(lambda)`, `>= 0`, in the problem's unit of force.
    pub fn contact_force(&self) -> f64 {
        self.multiplier.iter().fold(0.0, |force, lambda| force - lambda)
    }
}
