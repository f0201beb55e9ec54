//! The rows of the runs, and plots over time.

use signorini::output::{Drawing, Plot, Quantity, Series, line_plots};
use support::impact::measure::{Case, Moved, Run};

use crate::table::{row, table};

/// The columns after the first two.
const COLUMNS: &str = "displacement error | contact time | pressure | spread | largest force | peak | on the mean | \
                       impulse | rebound | energy at the end | largest energy | penetration";

fn cells(case: &Case, name: &str, courant: &str, run: &Run) -> String {
    let rebound = case.rebound.map_or("-".to_string(), |_| format!("{:.5}", run.rebound));
    let [mean, spread] = run.pressure;
    let [end, most] = run.energy;
    let [largest, averaged, peak] = run.peaks;
    let forces = format!("{mean:.5} | {spread:.1e} | {largest:.1} | {peak:.1} | {averaged:.1} | {:.5}", run.impulse);
    format!(
        "{name} | {courant} | {:.2e} | {:.4} | {forces} | {rebound} | {end:.5} | {most:.5} | {:.1e}",
        run.displacement_error, run.duration, run.penetration
    )
}

/// Returns the table of all schemes and time steps, with the closed form in its first row.
pub fn of_runs(case: &Case, runs: &[Run]) -> String {
    let ([begin, end], pressure) = (case.contact, case.pressure);
    let rebound = case.rebound.map_or("-".to_string(), |speed| format!("{speed:.5}"));
    let window = runs.first().map_or(0.0, |run| run.window);
    let forces = format!("{pressure:.1} | {pressure:.1} | {pressure:.1} | {:.5}", pressure * (end - begin));
    let mut rows =
        vec![format!("exact | | 0 | {:.4} | {pressure:.5} | 0 | {forces} | {rebound} | 1 | 1 | 0", end - begin)];
    for run in runs {
        let penalties = run.history.iter().map(|seen| seen.penalties).max().unwrap_or_default();
        let penalties = if penalties > 0 { format!(", up to {penalties} penalties a step") } else { String::new() };
        let gains = if run.scheme.gains_energy() { ", gains energy" } else { "" };
        let name = format!("{}{gains}{penalties}", run.scheme.name());
        rows.push(cells(case, &name, &format!("{:.1}", run.courant), run));
    }
    let table = table(&format!("scheme | CFL | {COLUMNS}"), &rows);
    format!("{}, 100 cells; the mean is over {window:.4}\n\n{table}\n", case.name)
}

/// Returns the table of the midpoint rule on finer and finer meshes, with the convergence rate of its displacement
/// error.
pub fn of_meshes(case: &Case, courant: f64, meshes: &[usize], runs: &[Run]) -> String {
    let of_mesh = |(index, run): (usize, &Run)| {
        let rate = index.checked_sub(1).map_or(String::new(), |before| {
            let halvings = (meshes[index] as f64 / meshes[before] as f64).log2();
            format!("{:.2}", (runs[before].displacement_error / run.displacement_error).log2() / halvings)
        });
        cells(case, &meshes[index].to_string(), &rate, run)
    };
    let rows: Vec<String> = runs.iter().enumerate().map(of_mesh).collect();
    format!("{}, midpoint, CFL {courant:.1}\n\n{}\n", case.name, table(&format!("cells | rate | {COLUMNS}"), &rows))
}

/// The columns of the table of bodies whose contact is no point.
pub const BODIES: &str = "body | cells | scheme | CFL | step | peak over reference | largest force over reference | \
                          impulse | energy at the end | growth | seconds";

/// A row of that table; `reference` is the peak to compare with.
pub fn of_body(name: &str, cells: usize, moved: &Moved, reference: f64) -> String {
    let summary = &moved.summary;
    let end = summary.over_initial().map_or(f64::NAN, |[end, _]| end);
    row(&format!(
        "{name} | {cells} | {} | {} | {:.3e} | {:.4} | {:.4} | {:.6e} | {end:.5} | {:.1e} | {:.2}",
        moved.scheme,
        moved.courant,
        moved.step,
        summary.contact.peak_force() / reference,
        summary.contact.force_max / reference,
        summary.contact.impulse,
        summary.growth(),
        moved.seconds
    ))
}

/// Draws pressure and energy over time at CFL 1; central differences run at 0.9.
pub fn plots(case: &Case, runs: &[Run]) -> Drawing {
    let at_one = || runs.iter().filter(|run| (0.9..=1.0).contains(&run.courant));
    let [begin, end] = case.contact;
    let last = runs[0].history.last().map_or(end, |seen| seen.time).min(end + (end - begin) / 2.0);
    let first = begin - (end - begin) / 4.0;
    let line = |run: &Run, value: &dyn Fn(&signorini::motion::Observation) -> f64| {
        let shown = run.history.iter().filter(|seen| (first..=last).contains(&seen.time));
        Series::new(run.scheme.name(), shown.map(|seen| [seen.time, value(seen)]).collect())
    };
    // Lines are cut at three times the exact pressure, because larger values show only that they are wrong.
    let cut = |value: f64| value.min(3.0 * case.pressure);
    let exact = vec![[first, 0.0], [begin, 0.0], [begin, case.pressure], [end, case.pressure], [end, 0.0], [last, 0.0]];
    let pressure = |gaining: bool| {
        let chosen = at_one().filter(|run| run.scheme.gains_energy() == gaining);
        let mut lines: Vec<Series> = chosen.map(|run| line(run, &|seen| cut(seen.force))).collect();
        lines.push(Series::new("exact", exact.clone()));
        Plot::new(Quantity::new("time", ""), Quantity::new("pressure", ""), lines)
    };
    let mut energy: Vec<Series> =
        at_one().map(|run| line(run, &|seen| (seen.energy() / run.history[0].energy()).min(4.0))).collect();
    energy.push(Series::new("exact", vec![[first, 1.0], [last, 1.0]]));
    let energy = Plot::new(Quantity::new("time", ""), Quantity::new("energy over that at the start", ""), energy);
    let title =
        format!("{}, CFL 1, central differences 0.9; cut at pressure {} and energy 4", case.name, 3.0 * case.pressure);
    line_plots(&title, &[pressure(false), pressure(true), energy])
}
