//! The fit: for each class and accuracy the pair of ways, and the size between them, whose worst loss against the best
//! way is least; and the cost of a factorisation by least squares.

use serde_json::{Value, json};

use super::measure::{ACCURACIES, Point};

/// The way that wins ties: exact, and without a second thought.
const FIRST: &str = "active-set";

pub fn fitted(points: &[Point]) -> String {
    let mut rules = Vec::new();
    for condensed in [true, false] {
        for accuracy in ACCURACIES {
            let of_class: Vec<&Point> =
                points.iter().filter(|point| point.condensed == condensed && point.accuracy == accuracy).collect();
            rules.push(rule(&of_class, condensed, accuracy));
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
    let fitted = json!({ "rules": rules, "double": cost(FIRST), "single": cost("active-set-mixed") });
    format!("{fitted:#}\n")
}

/// A problem in one class: its size, and the loss of each way against the best.
struct Losses<'a> {
    multiplications: f64,
    of: Vec<(&'a str, f64)>,
}

fn rule(points: &[&Point], condensed: bool, accuracy: f64) -> Value {
    let mut problems: Vec<&str> = points.iter().map(|point| point.problem.as_str()).collect();
    problems.dedup();
    let mut losses: Vec<Losses> = problems
        .iter()
        .map(|problem| {
            let own: Vec<&&Point> = points.iter().filter(|point| point.problem == *problem).collect();
            let best = own.iter().map(|point| point.seconds).fold(f64::INFINITY, f64::min);
            Losses {
                multiplications: own[0].multiplications,
                of: own.iter().map(|point| (point.way.as_str(), point.seconds / best)).collect(),
            }
        })
        .collect();
    losses.sort_by(|a, b| a.multiplications.total_cmp(&b.multiplications));
    let ways: Vec<&str> = losses.first().map_or(Vec::new(), |first| first.of.iter().map(|(way, _)| *way).collect());
    let loss =
        |losses: &Losses, way: &str| losses.of.iter().find(|(name, _)| *name == way).map_or(f64::INFINITY, |l| l.1);
    // The worst loss decides, then the mean; both to a percent, so that a split has to be worth something.
    let mut best = (f64::INFINITY, f64::INFINITY, FIRST, 0.0, FIRST);
    for split in 0..losses.len().max(1) {
        for &small in &ways {
            for &large in &ways {
                if (split == 0) != (small == large) {
                    continue;
                }
                let of = |(index, entry): (usize, &Losses)| loss(entry, if index < split { small } else { large });
                let all: Vec<f64> = losses.iter().enumerate().map(of).collect();
                let worst = (100.0 * all.iter().copied().fold(0.0, f64::max)).round();
                let mean = (100.0 * all.iter().sum::<f64>() / all.len() as f64).round();
                let simpler = small == FIRST && large == FIRST;
                if (worst, mean) < (best.0, best.1) || ((worst, mean) == (best.0, best.1) && simpler) {
                    let between = match split {
                        0 => 0.0,
                        _ => (losses[split - 1].multiplications * losses[split].multiplications).sqrt(),
                    };
                    best = (worst, mean, small, between, large);
                }
            }
        }
    }
    let (worst, mean, small, multiplications, large) = best;
    println!(
        "condensed {condensed}, accuracy {accuracy:.0e}, {} problems: {small} up to {multiplications:.1e} multiplications, \
         then {large}; at most {:.2}, in the mean {:.2} times the best",
        losses.len(),
        worst / 100.0,
        mean / 100.0
    );
    json!({
        "condensed": condensed,
        "accuracy": accuracy,
        "small": small,
        "multiplications": multiplications,
        "large": large,
    })
}

/// Seconds as a constant and a share of multiplications and values: least squares of the relative error, no term below
/// zero.
fn cost(points: &[&Point]) -> Value {
    let terms = |point: &Point| [1.0, point.multiplications, point.values].map(|term| term / point.seconds);
    let mut cost = [0.0_f64; 3];
    // Coordinate descent, which keeps every term at or above zero.
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
    json!({ "constant": cost[0], "per_multiplication": cost[1], "per_value": cost[2] })
}
