//! A plot of seconds over the number of unknowns for problems of one kind.

use signorini::output::{Drawing, Plot, Quantity, Scale, Series, line_plots};

/// The seconds of each solver on one problem.
pub struct Times {
    pub kind: String,
    pub unknowns: usize,
    pub rows: usize,
    /// The choice of `auto`; empty if `auto` was not run or found no answer.
    pub way_of_auto: String,
    pub of_solvers: Vec<(String, f64)>,
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
        let seconds = |times: &Times| times.of_solvers.iter().find(|solver| solver.0 == **name).map(|solver| solver.1);
        let points = of_kind.iter().filter_map(|times| Some([times.unknowns as f64, seconds(times)?]));
        Series::new(*name, points.collect())
    };
    let curves = names.iter().map(series).collect();
    let plot = Plot::new(Quantity::new("unknowns", ""), Quantity::new("time", "s"), curves);
    let plot = Plot { title: "certified and proven; PETSc: solved".into(), scales: [Scale::Logarithmic; 2], ..plot };
    line_plots(&format!("A {kind} over an obstacle, a row for every unknown"), &[plot])
}
