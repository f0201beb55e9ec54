//! Measures the time of every method and setting ("way") that solves a problem.

use signorini::{ContactProblem, Error, InteriorPoint, Penalty, Solution, solve};
use support::clock::processor_seconds;

use signorini::qp::{Condense, Method, Precision, Prepared, Settings};

/// The accuracies for which rules are fitted. Zero stands for the full accuracy of double precision.
pub const ACCURACIES: [f64; 4] = [1e-2, 1e-4, 1e-8, 0.0];

pub const HEADING: &str = "problem,dofs,rows,condensed,multiplications,values,accuracy,way,seconds\n";

/// Each measurement takes at least this total time and number of runs.
const LEAST_SECONDS: f64 = 0.05;
const LEAST_RUNS: usize = 5;
const MOST_RUNS: usize = 200;

/// One measured time.
pub struct Point {
    pub problem: String,
    pub rows: f64,
    pub condensed: bool,
    pub multiplications: f64,
    pub values: f64,
    pub accuracy: f64,
    pub way: String,
    /// Seconds of the fastest run; infinite if the accuracy is not reached.
    pub seconds: f64,
}

/// Returns the ways that a rule can choose for an accuracy.
pub fn ways(accuracy: f64) -> Vec<(&'static str, Settings)> {
    let base = |method, precision| {
        let mut settings = Settings::with_method(method);
        (settings.precision, settings.accuracy) = (precision, (accuracy > 0.0).then_some(accuracy));
        settings
    };
    let loose = InteriorPoint { polish: false, tolerance: 0.1 * accuracy };
    let unpolished = base(Method::Qp(loose), Precision::Double);
    let mut ways = vec![
        ("active-set", base(Method::ActiveSet, Precision::Double)),
        ("active-set-mixed", base(Method::ActiveSet, Precision::Mixed)),
        ("qp", base(Method::qp(), Precision::Double)),
    ];
    if accuracy > 0.0 {
        let penalty = base(Method::penalty(), Precision::Double);
        let rung = base(one_rung(100.0 / accuracy), Precision::Double);
        ways.extend([("qp-unpolished", unpolished), ("penalty", penalty), ("penalty-rung", rung)]);
    }
    ways
}

/// Returns the seconds of the fastest run of each way. The ways are run alternately, so that other work of the machine
/// affects all in the same way. The time is infinite if a way misses its accuracy, or if another method found the
/// answer.
fn timed(problem: &ContactProblem, ways: &[Settings]) -> Vec<(f64, String)> {
    let mut least: Vec<(f64, String)> = vec![(f64::INFINITY, String::new()); ways.len()];
    let mut spent = vec![0.0; ways.len()];
    for run in 0..MOST_RUNS {
        let mut ran = false;
        for (way, (settings, (least, method))) in ways.iter().zip(&mut least).enumerate() {
            if run >= LEAST_RUNS && spent[way] > LEAST_SECONDS {
                continue;
            }
            ran = true;
            let start = processor_seconds();
            let answer = solve(problem, settings);
            let seconds = processor_seconds() - start;
            spent[way] += seconds;
            if let Ok(solution) = answer
                && came_as_told(&solution, settings)
            {
                *least = least.min(seconds);
                *method = solution.method + if solution.single_precision { ", mixed" } else { "" };
            }
        }
        if !ran {
            break;
        }
    }
    least
}

fn came_as_told(solution: &Solution, settings: &Settings) -> bool {
    settings.precision != Precision::Mixed || solution.single_precision
}

/// Measures all ways of a problem, and returns one line for each.
pub fn measured(name: &str, problem: &ContactProblem) -> Result<String, Error> {
    let prepared = Prepared::new(problem, &Settings::with_method(Method::ActiveSet))?;
    let condensed = prepared.condensed_dofs() < problem.dofs();
    let (multiplications, values) = (prepared.multiplications(), prepared.factor_entries());
    drop(prepared);
    let mut lines = String::new();
    for accuracy in ACCURACIES {
        let (names, settings): (Vec<_>, Vec<_>) = ways(accuracy).into_iter().unzip();
        for (way, (seconds, _)) in names.iter().zip(timed(problem, &settings)) {
            lines += &format!(
                "{name},{},{},{},{multiplications:e},{values},{accuracy:e},{way},{seconds:.7}\n",
                problem.dofs(),
                problem.rows(),
                u8::from(condensed)
            );
        }
    }
    Ok(lines)
}

pub fn read(table: &str) -> Result<Vec<Point>, Box<dyn std::error::Error>> {
    let point = |line: &str| -> Result<Point, Box<dyn std::error::Error>> {
        let fields: Vec<&str> = line.split(',').collect();
        let [problem, _, rows, condensed, multiplications, values, accuracy, way, seconds] = fields[..] else {
            return Err(format!("`{line}` has not nine fields").into());
        };
        Ok(Point {
            problem: problem.to_string(),
            rows: rows.parse()?,
            condensed: condensed == "1",
            multiplications: multiplications.parse()?,
            values: values.parse()?,
            accuracy: accuracy.parse()?,
            way: way.to_string(),
            seconds: seconds.parse()?,
        })
    };
    table.lines().skip(1).map(point).collect()
}

/// The largest problem that is solved on all dofs by every way.
const MOST_FULL_DOFS: usize = 10_000;

/// Returns the fastest way to an accuracy, condensed or not, with the accuracy as a setting or with the parameters of
/// the trade-off, and the choice of the rules. All ways are run alternately.
pub fn best_and_auto(problem: &ContactProblem, accuracy: f64) -> [(String, f64); 2] {
    let mut grid: Vec<(String, Settings)> = Vec::new();
    for condense in [Condense::Auto, Condense::Never] {
        if condense == Condense::Never && problem.dofs() > MOST_FULL_DOFS {
            continue;
        }
        for (name, mut settings) in ways(accuracy) {
            settings.condense = condense;
            grid.push((
                format!("{name}{}", if condense == Condense::Never { ", all dofs" } else { "" }),
                settings.clone(),
            ));
            if name == "penalty" {
                // Only the last penalty, for which the penalty error is probably below the accuracy.
                for rung in [1.0, 10.0, 100.0] {
                    settings.method = one_rung(rung / accuracy);
                    grid.push((format!("penalty {:.0e}", rung / accuracy), settings.clone()));
                }
            }
            if name == "qp-unpolished" {
                for tolerance in [1.0, 1e-2] {
                    settings.method = Method::Qp(InteriorPoint { polish: false, tolerance: tolerance * accuracy });
                    grid.push((format!("qp to {:.0e}", tolerance * accuracy), settings.clone()));
                }
            }
        }
    }
    let (names, mut settings): (Vec<_>, Vec<_>) = grid.into_iter().unzip();
    let auto = settings.len();
    settings.push(if accuracy > 0.0 { Settings::for_accuracy(accuracy) } else { Settings::default() });
    let times = timed(problem, &settings);
    let fastest = (0..auto).min_by(|&a, &b| times[a].0.total_cmp(&times[b].0)).unwrap_or(0);
    [(names[fastest].clone(), times[fastest].0), (times[auto].1.clone(), times[auto].0)]
}

/// The penalty method with one penalty instead of an increasing sequence.
fn one_rung(penalty: f64) -> Method {
    Method::Penalty(Penalty { first: penalty, last: penalty, ..Penalty::default() })
}
