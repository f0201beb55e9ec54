//! GOAL: no answer and no claim about a linear complementarity problem contradicts exact arithmetic.
//!
//! CONDITIONS: random problems of 1 to 8 unknowns from families whose class is known, with bounds on some unknowns,
//! with ties, and without solutions; and the same with rows and unknowns scaled by 1e-12 to 1e12. REFERENCE: Lemke's
//! method in integers for any matrix, principal minors, and the exact search for a point that meets the inequalities.
//! The long form has 5,000 problems and 1,000 scaled ones.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use signorini::Settings;
use signorini::lcp::{Error, LcpSolution, solve_lcp};
use support::draws::Draws;
use support::oracles::exact::complementarity::{ExactPoint, LcpCase};
use support::oracles::exact::dyadic::{Dyadic, dot};
use support::{cases, seed};

type Matrix = Vec<Vec<f64>>;
type Make = fn(&mut Draws, usize) -> Matrix;

/// The classes of the theory: which matrices have a solution whenever the inequalities can be met.
const FAMILIES: [(&str, Make); 8] = [
    ("definite", definite),
    ("semidefinite", semidefinite),
    ("monotone", monotone),
    ("skew", skew),
    ("h-matrix", h_matrix),
    ("p-matrix", p_matrix),
    ("triangular", triangular),
    ("general", general),
];

fn whole(draws: &mut Draws, n: usize, size: i32) -> Matrix {
    (0..n).map(|_| (0..n).map(|_| f64::from(draws.between(-size, size))).collect()).collect()
}

/// A A' of `rank` columns, in whole numbers, plus `shift`.
fn gram(draws: &mut Draws, n: usize, rank: usize, shift: f64) -> Matrix {
    let a = whole(draws, n, 3);
    let entry = |i: usize, j: usize| (0..rank).map(|k| a[i][k] * a[j][k]).sum::<f64>();
    (0..n).map(|i| (0..n).map(|j| entry(i, j) + if i == j { shift } else { 0.0 }).collect()).collect()
}

fn square(n: usize, entry: impl FnMut((usize, usize)) -> f64) -> Matrix {
    let all: Vec<f64> = (0..n * n).map(|k| (k / n, k % n)).map(entry).collect();
    all.chunks(n).map(<[f64]>::to_vec).collect()
}

/// A random matrix whose mirrored entries are the same, or of the other sign.
fn mirrored(draws: &mut Draws, n: usize, sign: f64, mut entry: impl FnMut(&mut Draws) -> f64) -> Matrix {
    let lower = square(n, |(i, j)| if i > j { entry(draws) } else { 0.0 });
    square(n, |(i, j)| if i > j { lower[i][j] } else { sign * lower[j][i] })
}

fn sum(a: &Matrix, b: &Matrix) -> Matrix {
    square(a.len(), |(i, j)| a[i][j] + b[i][j])
}

fn definite(draws: &mut Draws, n: usize) -> Matrix {
    let shift = draws.pick(&[1.0, 0.125, 7.0]);
    let matrix = gram(draws, n, n, shift);
    let size = draws.pick(&[0.0, 0.01 / n as f64]);
    sum(&matrix, &mirrored(draws, n, 1.0, |draws| size * draws.signed()))
}

fn semidefinite(draws: &mut Draws, n: usize) -> Matrix {
    let rank = draws.below(n);
    gram(draws, n, rank, 0.0)
}

fn skew(draws: &mut Draws, n: usize) -> Matrix {
    mirrored(draws, n, -1.0, |draws| f64::from(draws.between(-4, 4)))
}

fn monotone(draws: &mut Draws, n: usize) -> Matrix {
    let (rank, shift) = (draws.below(n + 1), draws.pick(&[0.0, 1.0]));
    sum(&gram(draws, n, rank, shift), &skew(draws, n))
}

fn h_matrix(draws: &mut Draws, n: usize) -> Matrix {
    let matrix = whole(draws, n, 5);
    let unit: Vec<f64> = (0..n).map(|_| 2.0_f64.powi(draws.between(-6, 6))).collect();
    let others = |i: usize| (0..n).filter(|&j| j != i).map(|j| matrix[i][j].abs()).sum::<f64>();
    square(n, |(i, j)| unit[j] * if i == j { others(i) + draws.pick(&[1.0, 0.01, 10.0]) } else { matrix[i][j] })
}

fn p_matrix(draws: &mut Draws, n: usize) -> Matrix {
    loop {
        let others = whole(draws, n, 3);
        let matrix = square(n, |(i, j)| if i == j { f64::from(draws.between(1, 6)) } else { others[i][j] });
        let zeros = vec![0.0; n];
        let case = LcpCase { matrix, offset: zeros.clone(), lower: zeros.clone(), upper: zeros };
        if case.is_p() {
            return case.matrix;
        }
    }
}

fn triangular(draws: &mut Draws, n: usize) -> Matrix {
    let others = whole(draws, n, 4);
    square(n, |(i, j)| match i.cmp(&j) {
        Ordering::Less => 0.0,
        Ordering::Equal => f64::from(draws.between(1, 3)),
        Ordering::Greater => others[i][j],
    })
}

fn general(draws: &mut Draws, n: usize) -> Matrix {
    whole(draws, n, 4)
}

struct Trial {
    family: &'static str,
    case: LcpCase,
    /// `true` if M is of a class for which a ray of Lemke's method shows that there is no solution.
    is_decided: bool,
    /// `false` if the entries were rounded, or M is nearly singular: that no point meets the inequalities is then open.
    is_exact: bool,
}

fn draw(seed: u64, number: u64) -> Trial {
    let (family, make) = FAMILIES[number as usize % FAMILIES.len()];
    of_family(family, make, Draws::of(seed, number))
}

/// A problem whose matrix is nearly one of a class: some entries of one of that class, perhaps singular, are changed by
/// 2^-20 to 2^-45.
fn near(seed: u64, number: u64) -> Trial {
    let (family, make) = NEAR[number as usize % NEAR.len()];
    Trial { is_decided: false, is_exact: false, ..of_family(family, make, Draws::of(seed, number)) }
}

const NEAR: [(&str, Make); 4] = [
    ("near symmetric", |draws, n| changed(draws, n, semidefinite, true)),
    ("near monotone", |draws, n| changed(draws, n, monotone, false)),
    ("near h-matrix", |draws, n| changed(draws, n, balanced, false)),
    ("near p-matrix", |draws, n| changed(draws, n, dependent, false)),
];

fn changed(draws: &mut Draws, n: usize, make: Make, is_symmetric: bool) -> Matrix {
    let mut matrix = make(draws, n);
    for _ in 0..1 + draws.below(2) {
        let (i, j) = (draws.below(n), draws.below(n));
        let change = draws.pick(&[-1.0, 1.0]) * 2.0_f64.powi(-draws.between(20, 45));
        matrix[i][j] += change;
        if is_symmetric && i != j {
            matrix[j][i] += change;
        }
    }
    matrix
}

/// A comparison matrix whose rows sum to zero.
fn balanced(draws: &mut Draws, n: usize) -> Matrix {
    let others = whole(draws, n, 3);
    let sum = |i: usize| (0..n).filter(|&j| j != i).map(|j| others[i][j].abs()).sum::<f64>();
    square(n, |(i, j)| if i == j { sum(i) } else { others[i][j] })
}

/// A P-matrix but for its last row, which depends on the others.
fn dependent(draws: &mut Draws, n: usize) -> Matrix {
    let mut matrix = p_matrix(draws, n);
    let shares: Vec<f64> = (1..n).map(|_| f64::from(draws.between(-1, 1))).collect();
    let last = (0..n).map(|j| shares.iter().zip(&matrix).map(|(share, row)| share * row[j]).sum()).collect();
    matrix[n - 1] = last;
    matrix
}

fn of_family(family: &'static str, make: Make, mut draws: Draws) -> Trial {
    let n = 1 + draws.below(8);
    let matrix = make(&mut draws, n);
    let (mut lower, mut upper) = (vec![0.0; n], vec![f64::INFINITY; n]);
    if draws.one_in(2) {
        for i in 0..n {
            let (low, high) = (f64::from(draws.between(-3, 1)), f64::from(draws.between(1, 4)));
            (lower[i], upper[i]) = match draws.below(6) {
                0 => (low, high),
                1 => (f64::NEG_INFINITY, high),
                2 if draws.one_in(2) => (f64::NEG_INFINITY, 1e20),
                3 if draws.one_in(3) => (low, low),
                _ => (low, f64::INFINITY),
            };
        }
    }
    let mut offset: Vec<f64> = match draws.below(3) {
        0 => (0..n).map(|_| f64::from(draws.between(-4, 4))).collect(),
        1 => (0..n).map(|_| 5.0 * draws.signed()).collect(),
        _ => {
            // A solution with ties: w and the distance from the bound vanish together.
            let z: Vec<f64> = (0..n)
                .map(|i| match (lower[i].is_finite(), upper[i].is_finite() && upper[i] < 1e20) {
                    (true, _) => (lower[i] + f64::from(draws.between(0, 2).max(0))).min(upper[i]),
                    (false, true) => upper[i] - f64::from(draws.between(0, 2)),
                    _ => f64::from(draws.between(-2, 2)),
                })
                .collect();
            let w = |i: usize, draws: &mut Draws| match (z[i] == lower[i], z[i] == upper[i]) {
                (true, _) => f64::from(draws.between(0, 2)),
                (false, true) => -f64::from(draws.between(0, 2)),
                _ => 0.0,
            };
            (0..n).map(|i| w(i, &mut draws) - (0..n).map(|j| matrix[i][j] * z[j]).sum::<f64>()).collect()
        }
    };
    if draws.one_in(8) {
        offset.iter_mut().for_each(|q| *q = -q.abs());
    }
    let is_decided = family != "general";
    Trial { family, case: LcpCase { matrix, offset, lower, upper }, is_decided, is_exact: true }
}

/// The same with rows and unknowns in other units, by powers of two or by any numbers.
fn scaled(seed: u64, number: u64) -> Trial {
    let Trial { family, mut case, mut is_decided, .. } = draw(seed, number);
    let mut draws = Draws::of(seed ^ 0x5ca1ed, number);
    let is_by_powers = draws.one_in(2);
    let n = case.unknowns();
    let mut units = || -> Vec<f64> {
        let unit = |draws: &mut Draws| match is_by_powers {
            true => 2.0_f64.powi(draws.between(-40, 40)),
            false => draws.decades(1e-12, 1e12),
        };
        (0..n).map(|_| unit(&mut draws)).collect()
    };
    let (row, column) = (units(), units());
    for i in 0..n {
        (0..n).for_each(|j| case.matrix[i][j] *= row[i] * column[j]);
        case.offset[i] *= row[i];
        for bound in [&mut case.lower[i], &mut case.upper[i]].into_iter().filter(|bound| bound.abs() < 1e20) {
            *bound /= column[i];
        }
    }
    // Rounding of the entries takes a semidefinite matrix out of its class.
    is_decided &= is_by_powers || ["definite", "h-matrix", "triangular"].contains(&family);
    Trial { family, case, is_decided, is_exact: is_by_powers }
}

/// Returns `true` if `|a - b| <= bound`, b over a denominator, without any rounding.
fn is_within(a: f64, b: &Dyadic, denominator: &Dyadic, bound: f64) -> bool {
    let difference = &(&Dyadic::from(a) * denominator) - b;
    bound == f64::INFINITY || difference.abs() <= &Dyadic::from(bound) * denominator
}

/// What contradicts exact arithmetic in an answer.
fn faults(
    case: &LcpCase,
    exact: Option<&ExactPoint>,
    is_p: bool,
    solution: &LcpSolution,
    tolerance: f64,
) -> Vec<String> {
    let mut faults = Vec::new();
    let n = case.unknowns();
    if solution.is_unique == Some(true) && !is_p {
        faults.push("M is no P-matrix".into());
    }
    if ["h-matrix", "p-matrix"].contains(&solution.class) && !is_p {
        faults.push(format!("M is no {}", solution.class));
    }
    if solution.is_unique == Some(false) && case.is_symmetric() && !case.is_semidefinite() {
        faults.push("M is not semidefinite".into());
    }
    // The residual, from exact w: relative to the terms of its row, or to what a distance moves.
    let one = Dyadic::integer(1);
    let z: Vec<Dyadic> = solution.z.iter().map(|&z| Dyadic::from(z)).collect();
    let w: Vec<f64> = case.image(&z, &one).iter().map(Dyadic::to_f64).collect();
    let terms: Vec<f64> = (0..n)
        .map(|i| case.offset[i].abs() + (0..n).map(|j| (case.matrix[i][j] * solution.z[j]).abs()).sum::<f64>())
        .collect();
    let share = |value: f64, of: f64| if value == 0.0 { 0.0 } else { value / of };
    for i in 0..n {
        let (z, lower, upper) = (solution.z[i], case.lower[i], case.upper[i]);
        let effect = (0..n).map(|k| share(case.matrix[k][i].abs(), terms[k])).fold(0.0, f64::max);
        let off = |bound: f64| {
            let distance = (z - bound).abs();
            let own = share(distance, z.abs().max(bound.abs()));
            if bound.abs() >= 1e20 {
                f64::INFINITY
            } else if effect > 0.0 {
                own.min(distance * effect)
            } else {
                own
            }
        };
        let outside = if z < lower {
            off(lower)
        } else if z > upper {
            off(upper)
        } else {
            0.0
        };
        // What lies below the range of doubles is zero.
        let missing = |value: f64| if value <= 1e-290 { 0.0 } else { value / terms[i] };
        let least =
            off(lower).max(missing(-w[i])).min(off(upper).max(missing(w[i]))).min(outside.max(missing(w[i].abs())));
        if least > (1.0 + 1e-9) * solution.residual[i] + 1e-15 || (least > tolerance) {
            faults.push(format!("residual {i} is {least:e}, not {:e}", solution.residual[i]));
        }
    }
    let Some(exact) = exact else { return faults };
    let d = &exact.denominator;
    for i in 0..n {
        if let Ok(error) = &solution.error
            && !is_within(solution.z[i], &exact.z[i], d, error[i])
        {
            faults.push(format!("the error of z_{i} is above {:e}", error[i]));
        }
        if let Ok(error) = &solution.image_error
            && !is_within(solution.w[i], &exact.w[i], d, error[i])
        {
            faults.push(format!("the error of w_{i} is above {:e}", error[i]));
        }
        let is_at = |bound: f64| bound.is_finite() && exact.z[i] == &Dyadic::from(bound) * d;
        let [lower, between, upper] = &solution.proven;
        let holds = (!lower.contains(i) || exact.w[i].sign() > 0)
            && (!upper.contains(i) || exact.w[i].sign() < 0)
            && (!between.contains(i) || (!is_at(case.lower[i]) && !is_at(case.upper[i])));
        if !holds {
            faults.push(format!("the place of {i} is not proven"));
        }
    }
    faults
}

/// What is wrong with a ray, without any rounding.
fn ray_fault(case: &LcpCase, ray: &[f64]) -> Option<String> {
    let y: Vec<Dyadic> = ray.iter().map(|&y| Dyadic::from(y)).collect();
    let exact = |values: Vec<f64>| values.into_iter().map(Dyadic::from).collect::<Vec<_>>();
    let mut sum = dot(&exact(case.offset.clone()), &y);
    for i in 0..case.unknowns() {
        let (is_below, is_above) = (case.lower[i] <= -1e20, case.upper[i] >= 1e20);
        if (ray[i] > 0.0 && !is_above) || (ray[i] < 0.0 && !is_below) {
            return Some(format!("y_{i} has the wrong sign"));
        }
        let column: Vec<f64> = case.matrix.iter().map(|row| row[i]).collect();
        let c = dot(&exact(column), &y);
        let bound = if c.sign() > 0 { case.upper[i] } else { case.lower[i] };
        if bound.abs() < 1e20 {
            sum = &sum + &(&c * &Dyadic::from(bound));
        } else if c.sign() != 0 {
            return Some(format!("column {i} has the wrong sign along the ray"));
        }
    }
    (sum.sign() >= 0).then(|| "the ray demands nothing".into())
}

#[derive(Default)]
struct Counts {
    endings: BTreeMap<(&'static str, String), usize>,
    faults: Vec<String>,
}

fn run(counts: &mut Counts, name: &str, trial: &Trial) {
    let Trial { family, case, is_decided, is_exact } = trial;
    let bounded = case.bounded();
    let (exact, is_p, settings) = (bounded.solution(), case.is_p(), Settings::default());
    let lcp = case.problem().unwrap();
    let mut found = Vec::new();
    let ending = match solve_lcp(&lcp, &settings) {
        Ok(solution) => {
            found.extend(faults(&bounded, exact.as_ref(), is_p, &solution, settings.goal().tolerance));
            if exact.is_none() && *is_decided {
                found.push("solved, but there is no solution".into());
            }
            let again = lcp.certify(&solution.z).unwrap();
            if (&again.error, &again.proven, &again.residual) != (&solution.error, &solution.proven, &solution.residual)
            {
                found.push("the certificate of the same point differs".into());
            }
            // Points beside the answer have bounds as well, also far from unknowns that are zero.
            let mut draws = Draws::of(1, counts.endings.values().sum::<usize>() as u64);
            let size = draws.decades(1e-3, 1e3);
            for share in [0.0, size] {
                let moved =
                    |z: &f64| z * (1.0 + draws.decades(1e-14, 1e-1) * draws.signed()) + share * draws.signed().max(0.0);
                let beside = lcp.certify(&solution.z.iter().map(moved).collect::<Vec<_>>()).unwrap();
                let of_beside = faults(&bounded, exact.as_ref(), is_p, &beside, f64::INFINITY);
                found.extend(of_beside.into_iter().map(|fault| format!("beside: {fault}")));
            }
            let bounds = if solution.error.is_ok() {
                "z"
            } else if solution.image_error.is_ok() {
                "w"
            } else {
                "-"
            };
            format!("solved by {} as {}, bounds {bounds}", solution.method, solution.class)
        }
        Err(Error::Infeasible { ray, .. }) => {
            if bounded.is_feasible() {
                found.push("infeasible, but the inequalities can be met".into());
            }
            found.extend(ray_fault(case, &ray));
            "infeasible".to_string()
        }
        Err(error) => {
            if *is_decided {
                found.push(format!("refused: {error}").chars().take(300).collect());
            } else if *is_exact && exact.is_none() && !bounded.is_feasible() {
                found.push(format!("infeasible, but refused: {error}").chars().take(300).collect());
            }
            format!("{}, {}", error.code(), if exact.is_some() { "solvable" } else { "exact ray" })
        }
    };
    *counts.endings.entry((family, ending)).or_default() += 1;
    counts.faults.extend(found.into_iter().map(|fault| format!("{name} ({family}): {fault}")));
}

fn all(count: u64, seed: u64, draw: fn(u64, u64) -> Trial) {
    let mut counts = Counts::default();
    for number in 0..count {
        run(&mut counts, &format!("{number} of seed {seed}"), &draw(seed, number));
    }
    for ((family, ending), count) in &counts.endings {
        println!("{family:14} {ending:60} {count}");
    }
    let shown = &counts.faults[..counts.faults.len().min(12)];
    assert!(counts.faults.is_empty(), "{} faults of {count}: {shown:#?}", counts.faults.len());
}

#[test]
fn no_answer_contradicts_exact_arithmetic() {
    // Beside the answer of number 65 the gap is nearly the energy: a tenth of the bound would be wrong there.
    all(cases(400, 5000), seed(105), draw);
}

#[test]
fn no_claim_near_a_singular_matrix_contradicts_exact_arithmetic() {
    all(cases(200, 4000), seed(76), near);
}

#[test]
fn no_scaled_answer_contradicts_exact_arithmetic() {
    all(cases(160, 1000), seed(77), scaled);
}
