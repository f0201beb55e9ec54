//! Where an iteration starts.

use crate::solution::{ContactSet, Solution};

/// What is known of the answer beforehand: nothing, a contact set, a displacement, or both.
///
/// It changes the number of iterations, not the answer. The active-set and the penalty loop start from the contact set, MPRGP
/// from either; the interior-point method of Clarabel has no warm start, but its polish starts from the set.
///
/// ```
/// use signorini::{ContactSet, Start};
///
/// let closed = ContactSet::from_fn(3, |row| row == 1);
/// assert_ne!(Start::from(&closed), Start::default());
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Start {
    /// A displacement near the answer, one entry per dof.
    pub(crate) displacement: Option<Vec<f64>>,
    /// A contact set near that of the answer.
    pub(crate) contact_set: Option<ContactSet>,
}

impl Start {
    /// Returns `true` if nothing is known.
    pub(super) fn is_unknown(&self) -> bool {
        self.displacement.is_none() && self.contact_set.is_none()
    }

    /// A displacement near the answer, one entry per dof.
    pub fn near(displacement: Vec<f64>) -> Self {
        Start { displacement: Some(displacement), contact_set: None }
    }

    /// The contact set; that of `rows` open rows if none is known.
    pub(crate) fn into_set(self, rows: usize) -> ContactSet {
        self.contact_set.unwrap_or_else(|| ContactSet::open(rows))
    }
}

impl From<ContactSet> for Start {
    fn from(contact_set: ContactSet) -> Self {
        Start { displacement: None, contact_set: Some(contact_set) }
    }
}

impl From<&ContactSet> for Start {
    fn from(contact_set: &ContactSet) -> Self {
        contact_set.clone().into()
    }
}

impl From<&Solution> for Start {
    fn from(solution: &Solution) -> Self {
        Start { displacement: Some(solution.displacement.clone()), contact_set: Some(solution.contact_set.clone()) }
    }
}
