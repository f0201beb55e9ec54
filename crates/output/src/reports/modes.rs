//! Natural vibrations as a text.

use super::report::{columns, plural};
use crate::text::printable;
use signorini_mechanics::scene::{ModalAnalysis, Units};

/// Names of the coordinate axes.
pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];

/// The modes in words, and a line for each.
pub(crate) fn modes_text(title: &str, found: &ModalAnalysis, units: &Units) -> String {
    let (model, modes) = (found.answer.model(), &found.modes);
    let (all, closed) = (model.rows().len(), found.closed.len());
    let mut text = match found.solution {
        Some(_) => String::new(),
        None => format!("{}\nNothing holds the body: the modes are those of the free body.\n", printable(title)),
    };
    let what = format!("{} with {closed} of {} closed", plural(modes.len(), "mode"), plural(all, "contact row"));
    text += &match (found.undecided.len(), &found.unproven) {
        _ if all == 0 => format!("{}\n", plural(modes.len(), "mode")),
        (0, None) => format!("{what}, which is proven\n"),
        (_, Some(why)) => format!("{what} as in the answer, without a proof: {}\n", printable(why)),
        (some, None) => format!("{what}; {some} of them may be open: each frequency lies between both columns\n"),
    };
    text += match found.is_complete {
        true => "no frequency below the last one is missed: the negative pivots of K - w M count as many\n",
        false => "NOT COMPLETE: the count of negative pivots does not confirm that no frequency is missed\n",
    };
    if !found.rigid_motions.is_empty() {
        text += &format!("motions without energy: {}\n", printable(&found.rigid_motions.join("; ")));
    }
    if model.parts_of_whole() > 1.0 {
        text += "only modes that are symmetric to the planes of symmetry are found\n";
    }
    if model.body().formulation().is_axisymmetric() {
        text += "only modes without a change around the axis are found\n";
    }
    text += "\n";
    let per_time = if units.time().is_empty() { "1/time".to_string() } else { format!("1/{}", units.time()) };
    let (named, opened) = (format!("frequency [{per_time}]"), format!("undecided open [{per_time}]"));
    let [opens, closes] = ["opens", "closes"].map(|what| format!("{what} at [{}]", printable(&units.length)));
    let axes: Vec<String> = AXES[..model.body().dimension()].iter().map(|axis| format!("{axis} mass %")).collect();
    let mut rows = vec![vec!["mode".to_string(), named]];
    let (is_bracket, touches) = (modes.iter().any(|mode| mode.frequency_open.is_some()), all > 0);
    rows[0].extend(is_bracket.then_some(opened));
    rows[0].push("residual".to_string());
    rows[0].extend(axes);
    rows[0].extend([opens, closes].into_iter().filter(|_| touches));
    for (number, mode) in modes.iter().enumerate() {
        let mut row = vec![(number + 1).to_string(), format!("{:.6e}", mode.frequency)];
        let open = mode.frequency_open.map_or_else(String::new, |value| format!("{value:.6e}"));
        row.extend(is_bracket.then_some(open));
        row.push(format!("{:.1e}", mode.residual));
        row.extend(mode.effective_mass.iter().map(|mass| format!("{:.2}", 100.0 * mass / found.mass)));
        let limits = [mode.opens, mode.closes].into_iter().filter(|_| touches);
        row.extend(limits.map(|limit| limit.map_or_else(|| "-".into(), |limit| format!("{:.3e}", limit.amplitude))));
        rows.push(row);
    }
    text += &columns(&rows);
    if all > 0 {
        text += "opens, closes: the largest displacement of the mode at which the first closed row opens, and the first open row closes\n";
    }
    text
}
