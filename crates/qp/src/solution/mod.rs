//! The parts of an answer: plain data, no logic of the solvers.
//!
//! Every type serialises as it appears in a report; a number that is not finite is null there.

mod certificate;

pub(crate) use certificate::Cancellation;
pub use certificate::{Certificate, Goal, Met};

use std::fmt;

use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

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

    /// Number of closed rows in the set.
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
        let flags: Vec<bool> = closed.into_iter().collect();
        Self::from_fn(flags.len(), |row| flags[row])
    }
}

/// The closed rows, as [`ContactSet::iter`].
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

/// Rounding of the entries of an assembled stiffness, as a share of its diagonal.
const ROUNDED_ENTRIES: f64 = 512.0 * f64::EPSILON;

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
    /// Everything from the checked problem to the certified answer, factorisations, certificate, proof and earlier
    /// attempts included.
    pub solve: f64,
}

/// One iteration of a method: the contact set that it tried, and the penalty of its springs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Iteration {
    /// The closed rows in this iteration; a report has their number.
    #[serde(rename = "closed", serialize_with = "count")]
    pub contact_set: ContactSet,
    /// The penalty, in multiples of the local stiffness; zero if the method has none.
    #[serde(skip_serializing_if = "certificate::is_nothing")]
    pub penalty: f64,
}

/// Serialises a contact set as the number of its closed rows.
fn count<S: Serializer>(set: &ContactSet, serializer: S) -> Result<S::Ok, S::Error> {
    set.count().serialize(serializer)
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

impl Why {
    /// Returns `true` if nothing was decided.
    pub fn is_empty(&self) -> bool {
        self.reason.is_empty()
    }
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
    /// Multiplier mu of the equality rows, one entry each, in the problem's unit of force, of either sign; empty
    /// without such rows.
    #[serde(skip)]
    pub equality_multiplier: Vec<f64>,
    /// The contact rows that are closed in the answer.
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
    /// The rows with proven contact or gap, if [`Settings::prove`](crate::Settings::prove) asks for them and an energy
    /// bound is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub proven: Option<ProvenSet>,
    /// The limit that ended the search before its end, in words; `None` if it ended by itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cut_short: Option<String>,
    /// Steps of refinement, each the answer for the residual of the answer before.
    #[serde(skip_serializing_if = "certificate::is_nothing")]
    pub refinements: usize,
    /// Reason why no factor was taken, in words, if [`Method::Auto`](crate::Method::Auto) decided that; otherwise
    /// empty.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub reason: String,
    /// The ways that were compared before, and the decision; empty if no method was chosen for this answer.
    #[serde(skip_serializing_if = "Why::is_empty")]
    pub why: Why,
    /// Other attempts, in order; their time is in `seconds`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub attempts: Vec<Attempt>,
    /// See [`Solution::lost_pivot`].
    #[serde(skip)]
    pub(crate) lost_pivot: Option<f64>,
    /// Unknowns that the method worked on; fewer than all if the problem was condensed.
    #[serde(skip)]
    pub condensed_dofs: usize,
    /// Time spent on it.
    #[serde(skip)]
    pub seconds: Seconds,
}

impl Solution {
    /// The smallest pivot of the stiffness, for a diagonal of order one, if it is so close to rounding that digits are
    /// lost; 0 if a pivot was not positive.
    pub fn lost_pivot(&self) -> Option<f64> {
        self.lost_pivot
    }

    /// Digits of the displacement that the entries of the stiffness determine, approximately, if they are few: each
    /// entry is rounded to double precision, and the softest motion amplifies that by one over the smallest pivot. The
    /// certificate takes the entries as exact. A dof without stiffness has no digits to lose.
    pub fn digits_of_stiffness(&self) -> Option<u32> {
        let pivot = self.lost_pivot.filter(|&pivot| pivot > 0.0 || self.certificate.loose_dofs == 0);
        pivot.map(|pivot| (pivot / ROUNDED_ENTRIES).log10().round().max(0.0) as u32)
    }

    /// Total contact force `-sum(lambda)`, `>= 0`, in the problem's unit of force.
    pub fn contact_force(&self) -> f64 {
        self.multiplier.iter().fold(0.0, |force, lambda| force - lambda)
    }
}
