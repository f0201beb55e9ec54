//! The table of the documents: choice and time of `auto`, compared with the fastest method.

use crate::growth::Times;

/// Returns the rows of all problems that `auto` solved, in Markdown. The seconds include certificate and proof.
pub fn markdown(times: &[Times]) -> String {
    let mut lines = vec![
        "| problem | dofs | rows | `auto`, s | by | fastest, s | by | ratio |".to_string(),
        "|---|---|---|---|---|---|---|---|".to_string(),
    ];
    for of_kind in times {
        let seconds = |method: &str| of_kind.of_solvers.iter().find(|(name, _)| name == method).map(|entry| entry.1);
        let fastest = of_kind.of_solvers.iter().min_by(|a, b| a.1.total_cmp(&b.1));
        let (Some(auto), Some((best, least))) = (seconds("auto"), fastest) else { continue };
        let best = if best == "auto" { &of_kind.way_of_auto } else { best };
        let Times { kind, unknowns, rows, way_of_auto, .. } = of_kind;
        let ratio = auto / least;
        lines.push(format!(
            "| {kind} | {unknowns} | {rows} | {auto:.2} | {way_of_auto} | {least:.2} | {best} | {ratio:.2} |"
        ));
    }
    lines.join("\n")
}
