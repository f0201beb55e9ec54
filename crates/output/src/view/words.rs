//! A model in a few words: its title, its gap or its forces.

use crate::plots::ticks::{amount, brief};
use signorini_mechanics::scene::Model;

/// The first line of all pictures of a model.
pub(crate) fn headline(model: &Model) -> String {
    [model.title(), &state(model)].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ")
}

/// The state of the scene: its gap, or the forces that press its obstacles.
pub(crate) fn state(model: &Model) -> String {
    let amounts = pressing_amounts(model);
    match &amounts[..] {
        [] => format!("gap {} {}", brief(model.gap()), model.units().length).trim_end().to_owned(),
        [one] => format!("force {one}"),
        [first, others @ ..] if others.iter().all(|other| other == first) => format!("force {first} each"),
        _ => format!("forces {}", amounts.join(" and ")),
    }
}

/// The forces that press obstacles, in words.
pub(crate) fn pressing_amounts(model: &Model) -> Vec<String> {
    model.pressing_forces().into_iter().map(|force| amount(force, &model.units().force)).collect()
}
