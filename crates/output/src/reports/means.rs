//! The sentence about rows between meshes that do not match: they hold means, not the gaps of nodes.

use crate::text::printable;
use signorini_study::{ContactSummary, ObstacleContact};

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

/// The two surfaces of a contact between bodies whose meshes do not match, with lengths in words; `None` for another
/// contact.
pub(super) fn between_text(one: &ObstacleContact, length: impl Fn(f64) -> String) -> Option<String> {
    let between = one.between.as_ref()?;
    let [share, of_other] = between.covered?;
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let of_defect = |defect: f64| format!("; moments on both balance to {defect:.1e} of force times size");
    Some(format!(
        "{}: rows are means over the nodes of `{}`; {} of its area and {} of the nodes of `{}` face each other; single nodes go up to \
         {} through{}",
        one.of,
        printable(&between.boundary),
        percent(share),
        percent(of_other),
        printable(&between.other),
        length(between.penetration.unwrap_or(0.0)),
        between.moment_defect.map(of_defect).unwrap_or_default()
    ))
}
