//! Compares the bound of the certificate with the true error: for every method, it is never below the error, and close
//! to it.

use signorini::qp::{Condense, Method, Settings};
use signorini::{ContactProblem, InteriorPoint, Penalty, SparseMatrix, SymmetricMatrix, solve};
use support::endings::best;
use support::program::examples;
use support::random::{springs, stacked};
use support::scenes::built_example;
use support::{cases, seed};

/// Smaller errors may be errors of the reference, a solve in double precision on matrices of condition 1e4.
const OF_THE_REFERENCE: f64 = 1e-12;

/// The bound may be below an error by the rounding of bound and error.
const ROUNDING: f64 = 1e-6;

/// Largest ratio of the bound to the error.
const LOOSEST: f64 = 10.0;

/// Number of random problems with rows between dofs.
const STACKED: u64 = 60;

/// Largest median of these ratios.
const MEDIAN: f64 = 3.0;

fn energy(problem: &ContactProblem, u: &[f64]) -> f64 {
    u.iter().zip(problem.stiffness().mul(u)).map(|(u, force)| u * force).sum::<f64>().max(0.0).sqrt()
}

/// Every method, at several accuracies.
fn ways() -> Vec<(String, Settings)> {
    let mut ways = Vec::new();
    for condense in [Condense::Auto, Condense::Never] {
        let base = |method| {
            let mut settings = Settings::with_method(method);
            settings.condense = condense;
            settings
        };
        for tolerance in [1e-2, 1e-4, 1e-6, 1e-8] {
            let settings = base(Method::Qp(InteriorPoint { polish: false, tolerance }));
            ways.push((format!("qp {tolerance:e} {condense:?}"), settings));
        }
        for last in [1e1, 1e3, 1e5, 1e8] {
            let ladder = Penalty { last, penetration_threshold: 0.0, ..Penalty::default() };
            let settings = base(Method::Penalty(ladder));
            ways.push((format!("penalty {last:e} {condense:?}"), settings));
        }
        ways.push((format!("active-set {condense:?}"), base(Method::ActiveSet)));
    }
    ways
}

/// Ratio of bound to error for each way out of `of` ways whose error exceeds that of the reference; asserts that no
/// bound is below its error.
fn ratios(name: &str, problem: &ContactProblem, of: usize) -> Vec<(f64, String)> {
    let exact = solve(problem, &Settings::with_method(Method::ActiveSet)).unwrap();
    let mut ratios = Vec::new();
    if exact.certificate.energy_error_bound.is_infinite() {
        // A stiffness that is positive definite only together with its rows has no energy norm.
        return ratios;
    }
    for (way, settings) in ways().into_iter().step_by(of) {
        let found = best(solve(problem, &settings));
        let away: Vec<f64> = found.displacement.iter().zip(&exact.displacement).map(|(u, v)| u - v).collect();
        let error = energy(problem, &away) / energy(problem, &found.displacement);
        let bound = found.certificate.energy_error_bound;
        let what = format!("{name}, {way}: error {error:.3e}, bound {bound:.3e}");
        assert!(error <= bound * (1.0 + ROUNDING) + OF_THE_REFERENCE, "{what}");
        if error > OF_THE_REFERENCE {
            ratios.push((bound / error, what));
        }
    }
    ratios
}

fn check(mut ratios: Vec<(f64, String)>) {
    assert!(ratios.len() > 10);
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    let median = ratios[ratios.len() / 2].0;
    let (worst, what) = &ratios[ratios.len() - 1];
    println!("{} answers, median {median:.3}, worst {worst:.3}: {what}", ratios.len());
    assert!(*worst <= LOOSEST, "{worst}: {what}");
    assert!(median <= MEDIAN, "{median}");
}

#[test]
fn the_bound_is_near_the_error_on_every_example() {
    let mut all = Vec::new();
    for name in examples() {
        let model = built_example(&name);
        // On all dofs of the larger scenes the interior point takes long.
        if model.problem().dofs() < 5000 {
            // Every fourth way has every method.
            all.extend(ratios(&name, model.problem(), cases(4, 1)));
        }
    }
    check(all);
}

#[test]
fn the_bound_is_near_the_error_on_a_thousand_random_problems() {
    let first = seed(0);
    let seeds = first..first + cases(100, 1000);
    check(seeds.flat_map(|seed| ratios(&format!("random {seed}"), &springs(seed), 1)).collect());
}

/// A string over an obstacle. Every node is a candidate: too many for a dense boundary, so that rows are repaired one
/// after the other.
#[test]
fn the_bound_is_near_the_error_if_every_dof_is_a_candidate() {
    let nodes = 400;
    let h = 1.0 / (nodes + 1) as f64;
    let stiffness: Vec<_> = (0..nodes)
        .flat_map(|node| [(node, node, 2.0 / h), (node, node + 1, -1.0 / h)])
        .filter(|entry| entry.1 < nodes)
        .map(|(row, column, value)| (column, row, value))
        .collect();
    let contact: Vec<_> = (0..nodes).map(|node| (node, node, -1.0)).collect();
    let problem = ContactProblem::new(
        SymmetricMatrix::from_lower(SparseMatrix::from_triplets(nodes, nodes, &stiffness).unwrap()).unwrap(),
        vec![-h; nodes],
        SparseMatrix::from_triplets(nodes, nodes, &contact).unwrap(),
        vec![0.08; nodes],
    )
    .unwrap();
    check(ratios("string", &problem, 1));
}

#[test]
fn every_answer_with_rows_between_dofs_has_a_bound_that_certifies_it() {
    for seed in 0..STACKED {
        let problem = stacked(seed);
        let solution = solve(&problem, &Settings::default());
        let solution = solution.unwrap_or_else(|error| panic!("seed {seed}, {} dofs: {error}", problem.dofs()));
        let closed = solution.contact_set.iter().count();
        assert!(closed > 0, "seed {seed}");
        // An answer that is moved has a bound above the way, and within the usual ratio.
        let moved: Vec<f64> = solution.displacement.iter().map(|u| u * (1.0 + 1e-6)).collect();
        let certificate = problem.certify(&moved, &solution.multiplier).unwrap();
        let way: Vec<f64> = moved.iter().zip(&solution.displacement).map(|(a, b)| a - b).collect();
        let error = energy(&problem, &way) / energy(&problem, &moved);
        let ratio = certificate.energy_error_bound / error;
        assert!(
            (1.0 - ROUNDING..LOOSEST).contains(&ratio),
            "seed {seed}, {} dofs, {closed} closed: {ratio}",
            problem.dofs()
        );
    }
}

#[test]
fn rows_that_contradict_each_other_leave_no_bound_however_far_off_the_answer_is() {
    // u_0 <= 0, u_1 <= 0 and u_0 + u_1 >= 1e-6.
    let matrix = |rows, entries: &[_]| SparseMatrix::from_triplets(rows, 2, entries).unwrap();
    let stiffness = SymmetricMatrix::from_lower(matrix(2, &[(0, 0, 2.0), (1, 0, -1.0), (1, 1, 2.0)])).unwrap();
    let contact = matrix(3, &[(0, 0, 1.0), (1, 1, 1.0), (2, 0, -1.0), (2, 1, -1.0)]);
    let problem = ContactProblem::new(stiffness, vec![1.0; 2], contact, vec![0.0, 0.0, -1e-6]).unwrap();
    for exponent in 0..14 {
        for u in [10_f64.powi(exponent), -10_f64.powi(exponent), 3.7 * 10_f64.powi(exponent)] {
            let force = -u.abs();
            let certificate = problem.certify(&[u, u], &[3.0 * force, 3.0 * force, force]).unwrap();
            assert!(!certificate.has_bound(), "{u:e}: {certificate:?}");
        }
    }
}
