//! `--along`: an answer along lines.

use super::input::{Content, Input};
use super::line::Line;
use super::outcome::{unfit, warn};
use crate::Error;
use crate::output::Along;
use crate::scene::Answer;

/// Refuses lines that do not fit the input.
pub(super) fn check(lines: &[Line], input: &Input) -> Result<(), Error> {
    let Some(first) = lines.first() else { return Ok(()) };
    let Content::Scene(model) = &input.content else {
        return unfit(
            "--along",
            format!("`{}` needs a body, but the input is a problem directory, which has none", first.text),
        );
    };
    let expected = model.mesh().dimension();
    match lines.iter().find(|line| line.ends[0].len() != expected) {
        None => Ok(()),
        Some(Line { text, ends: [found, _] }) => {
            let found = found.len();
            let message =
                format!("each end of `{text}` needs the {expected} coordinates of a point of the scene, not {found}");
            unfit("--along", message)
        }
    }
}

/// The answer along the lines; warns of a line that meets no body.
pub(super) fn along(lines: &[Line], answer: &Answer) -> Result<Vec<Along>, Error> {
    let (low, high) = answer.model().mesh().extent();
    let mut all = Vec::new();
    for Line { text, ends } in lines {
        let dimension = ends[0].len();
        let in_space = |end: &Vec<f64>| [0, 1, 2].map(|axis| end.get(axis).copied().unwrap_or(0.0));
        let along = Along::of(answer, [in_space(&ends[0]), in_space(&ends[1])])?;
        if along.pieces.is_empty() {
            let (low, high) = (&low[..dimension], &high[..dimension]);
            warn(&format!("warning: --along {text} meets no body; the mesh reaches from {low:?} to {high:?}\n"));
        }
        all.push(along);
    }
    Ok(all)
}
