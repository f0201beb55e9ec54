//! Where the iteration starts.

use crate::solution::ContactSet;

/// What is known beforehand.
#[derive(Clone, Copy, Debug, Default)]
pub struct Start<'a> {
    /// A displacement near the answer, one entry per dof.
    pub displacement: Option<&'a [f64]>,
    /// A contact set near that of the answer.
    pub contact_set: Option<&'a ContactSet>,
}

impl Start<'_> {
    /// Returns `true` if nothing is known.
    pub(super) fn is_unknown(&self) -> bool {
        self.displacement.is_none() && self.contact_set.is_none()
    }
}
