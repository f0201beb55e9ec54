//! The seconds of all problems as a table, and as a plot over the number of unknowns for problems of one kind.

use signorini::output::{Drawing, Plot, Quantity, Scale, Series, line_plots};

use crate::table::table;

/// The seconds of each solver on one problem.
pub struct Times {
    pub kind: String,
    pub unknowns: usize,
    pub rows: usize,
    /// The choice of `auto`; empty if `auto` was not run or found no answer.
    pub way_of_auto: String,
    pub of_solvers: Vec<(String, f64)>,
}

impl Times {
    fn seconds(&self, solver: &str) -> Option<f64> {
        self.of_solvers.iter().find(|(name, _)| name == solver).map(|entry| entry.1)
    }
}

/// Returns choice and time of `auto` beside the fastest method, for all problems that `auto` solved. The seconds
/// include certificate and proof.
pub fn markdown(times: &[Times]) -> String {
    let row = |times: &Times| {
        let (best, least) = times.of_solvers.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let auto = times.seconds("auto")?;
        let best = if best == "auto" { &times.way_of_auto } else { best };
        let Times { kind, unknowns, rows, way_of_auto, .. } = times;
        let ratio = auto / least;
        Some(format!("{kind} | {unknowns} | {rows} | {auto:.2} | {way_of_auto} | {least:.2} | {best} | {ratio:.2}"))
    };
    let rows: Vec<String> = times.iter().filter_map(row).collect();
    table("problem | dofs | rows | `auto`, s | by | fastest, s | by | ratio", &rows)
}

/// Draws one curve per solver over all problems whose name begins with `kind`.
pub fn plot(kind: &str, times: &[Times]) -> Drawing {
    let of_kind: Vec<&Times> = times.iter().filter(|times| times.kind.starts_with(kind)).collect();
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in of_kind.iter().flat_map(|times| &times.of_solvers) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    let series = |name: &&str| {
        let points = of_kind.iter().filter_map(|times| Some([times.unknowns as f64, times.seconds(name)?]));
        Series::new(*name, points.collect())
    };
    let curves = names.iter().map(series).collect();
    let plot = Plot::new(Quantity::new("unknowns", ""), Quantity::new("time", "s"), curves);
    let plot = Plot { title: "certified and proven; PETSc: solved".into(), scales: [Scale::Logarithmic; 2], ..plot };
    line_plots(&format!("A {kind} over an obstacle, a row for every unknown"), &[plot])
}
