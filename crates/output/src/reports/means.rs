//! The sentence about rows between meshes that do not match: they hold means, not the gaps of nodes.

use crate::text::printable;
use signorini_mechanics::study::ContactSummary;

/// What closed and open, computed or proven, mean for rows of means; `None` without such rows.
pub(crate) fn means_text(contact: &ContactSummary) -> Option<String> {
    let pairs = contact.obstacles.iter().filter_map(|one| one.between.as_ref());
    // Only rows of means have a covered share.
    let of_means = pairs.filter(|between| between.covered.is_some());
    let names: Vec<String> =
        of_means.map(|one| format!("of `{}` and `{}`", printable(&one.boundary), printable(&one.other))).collect();
    let between = names.join(", and ");
    (!names.is_empty()).then(|| {
        format!(
            "Rows between the meshes {between} hold means: closed and open belong to the mean gap over the area of a node, \
             not to the gap at the node."
        )
    })
}
