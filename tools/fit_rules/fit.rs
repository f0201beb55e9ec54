//! The fit. For each class and accuracy it finds the methods, by problem size, with the smallest loss against the
//! fastest method. It fits the cost of a factorisation by least squares.

use super::measure::{ACCURACIES, Point};

/// The method that is chosen if several are equally fast: it is exact and needs no parameter.
const FIRST: &str = "active-set";

/// The method that is allowed only if the user names an accuracy.
const MIXED: &str = "active-set-mixed";

/// The method that is never chosen on all dofs. On bodies in space with many rows, its own elimination order causes so
/// much fill-in that it takes twenty times as long as ours (`kinds -- --only slab`); elsewhere it is at most a tenth
/// faster.
const INTERIOR_POINT: &str = "qp";

/// Percent of loss that one more step must save.
const PRICE_OF_A_STEP: f64 = 5.0;

const HEADING: &str = "
/// The fitted steps: for each layout, from the lowest accuracy and the smallest size on.
pub(in crate::qp) static STEPS: &[Step] = &[
";

/// The constants of `crates/qp/src/cost/fitted.rs`.
pub fn fitted(points: &[Point]) -> String {
    let mut fitted = HEADING.to_string();
    for condensed in [true, false] {
        for accuracy in ACCURACIES {
            let of_class: Vec<&Point> = points
                .iter()
                .filter(|point| point.condensed == condensed && point.accuracy == accuracy)
                // A user who names no accuracy may solve for further gaps, for which a factor in double precision costs
                // less.
                .filter(|point| accuracy > 0.0 || point.way != MIXED)
                .filter(|point| condensed || point.way != INTERIOR_POINT)
                .collect();
            for (up_to, way) in steps(&of_class, condensed, accuracy) {
                let up_to = if up_to < f64::INFINITY { format!("{up_to:?}") } else { "f64::INFINITY".to_string() };
                let way = variant(way);
                let step = format!("condensed: {condensed}, accuracy: {accuracy:?}, up_to: {up_to}, way: Way::{way}");
                fitted += &format!("    Step {{ {step} }},\n");
            }
        }
    }
    let cost = |way: &str| {
        let accuracy = if way == FIRST { 0.0 } else { 1e-2 };
        let times: Vec<&Point> = points
            .iter()
            .filter(|point| point.condensed && point.way == way && point.accuracy == accuracy)
            .filter(|point| point.seconds.is_finite())
            .collect();
        cost(&times)
    };
    fitted += "];\n";
    for (precision, way) in [("double", FIRST), ("single", MIXED)] {
        let name = precision.to_uppercase();
        fitted +=
            &format!("\n/// The cost in {precision} precision.\npub(in crate::qp) const {name}: Cost = Cost {{\n");
        for (term, value) in ["constant", "per_multiplication", "per_value"].into_iter().zip(cost(way)) {
            fitted += &format!("    {term}: {value:?},\n");
        }
        fitted += "};\n";
    }
    fitted
}

/// The variant of a way with this name in the table: `ActiveSet` of `active-set`.
fn variant(way: &str) -> String {
    way.split('-').map(|word| word[..1].to_uppercase() + &word[1..]).collect()
}

/// A problem of one class: its size, and the loss of each method against the fastest.
struct Losses<'a> {
    size: f64,
    of: Vec<(&'a str, f64)>,
}

impl Losses<'_> {
    fn of(&self, way: &str) -> f64 {
        self.of.iter().find(|(name, _)| *name == way).map_or(f64::INFINITY, |entry| entry.1)
    }
}

/// Methods in the order of problem size. Each is used from the given size up to the size of the next one.
type Steps<'a> = Vec<(usize, &'a str)>;

/// Returns the best steps of at most three methods: those with the smallest worst loss, then with the smallest mean
/// loss, both compared to one percent, then with the fewest steps. Each is a way with the largest size for which it is
/// used.
fn steps<'a>(points: &[&'a Point], condensed: bool, accuracy: f64) -> Vec<(f64, &'a str)> {
    let mut problems: Vec<&str> = points.iter().map(|point| point.problem.as_str()).collect();
    problems.dedup();
    let mut losses: Vec<Losses> = problems
        .iter()
        .map(|problem| {
            let own: Vec<&&Point> = points.iter().filter(|point| point.problem == *problem).collect();
            let best = own.iter().map(|point| point.seconds).fold(f64::INFINITY, f64::min);
            Losses {
                size: own[0].multiplications / if condensed { 1.0 } else { own[0].rows },
                of: own.iter().map(|point| (point.way.as_str(), point.seconds / best)).collect(),
            }
        })
        .collect();
    losses.sort_by(|a, b| a.size.total_cmp(&b.size));
    let ways: Vec<&str> = losses.first().map_or(Vec::new(), |first| first.of.iter().map(|(way, _)| *way).collect());
    let count = losses.len();
    let mut candidates: Vec<Steps> = ways.iter().map(|&way| vec![(0, way)]).collect();
    for first in 1..count {
        for &small in &ways {
            for &large in ways.iter().filter(|&&large| large != small) {
                candidates.push(vec![(0, small), (first, large)]);
                for second in first + 1..count {
                    for &largest in ways.iter().filter(|&&largest| largest != large) {
                        candidates.push(vec![(0, small), (first, large), (second, largest)]);
                    }
                }
            }
        }
    }
    let judged = |steps: &Steps| {
        let way = |index: usize| steps.iter().rfind(|step| step.0 <= index).map_or(FIRST, |step| step.1);
        let all: Vec<f64> = losses.iter().enumerate().map(|(index, entry)| entry.of(way(index))).collect();
        let percent = |loss: f64| (100.0 * loss).round();
        (percent(all.iter().copied().fold(0.0, f64::max)), percent(all.iter().sum::<f64>() / count.max(1) as f64))
    };
    // One more step must gain more than the scatter of the measurements.
    let price = |steps: &Steps| {
        let (worst, mean) = judged(steps);
        worst + mean + PRICE_OF_A_STEP * steps.len() as f64
    };
    let best = candidates.into_iter().min_by(|a, b| price(a).total_cmp(&price(b))).unwrap_or_default();
    let (worst, mean) = judged(&best);
    let between = |index: usize| (losses[index - 1].size * losses[index].size).sqrt();
    let end = |step: usize| best.get(step + 1).map_or(f64::INFINITY, |next| between(next.0));
    let steps: Vec<(f64, &str)> = (0..best.len()).map(|step| (end(step), best[step].1)).collect();
    println!(
        "condensed {condensed}, accuracy {accuracy:.0e}, {count} problems: {}; at most {:.2}, on average {:.2} times the best",
        steps.iter().map(|(up_to, way)| format!("{way} up to {up_to:.3e}")).collect::<Vec<_>>().join(", "),
        worst / 100.0,
        mean / 100.0
    );
    steps
}

/// Fits seconds as a constant plus multiples of multiplications and values, by least squares of the relative error. No
/// coefficient is negative.
fn cost(points: &[&Point]) -> [f64; 3] {
    let terms = |point: &Point| [1.0, point.multiplications, point.values].map(|term| term / point.seconds);
    let mut cost = [0.0_f64; 3];
    // Coordinate descent keeps every coefficient at or above zero.
    for _ in 0..10_000 {
        for term in 0..3 {
            let (mut above, mut below) = (0.0, 0.0);
            for point in points {
                let shares = terms(point);
                let others: f64 = (0..3).filter(|&other| other != term).map(|other| cost[other] * shares[other]).sum();
                above += shares[term] * (1.0 - others);
                below += shares[term] * shares[term];
            }
            cost[term] = if below > 0.0 { (above / below).max(0.0) } else { 0.0 };
        }
    }
    cost
}
