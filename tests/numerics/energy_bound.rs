//! Compares the bound of the certificate with the true error: for every method, it is never below the error, and close
//! to it.

use crate::program::examples;
use crate::random::springs;
use signorini::qp::{Condense, Method, Settings};
use signorini::{ContactProblem, Error, Scene, Solution, SparseMatrix, SymmetricMatrix, solve};
use signorini::{InteriorPoint, Penalty};

/// Smaller errors may be errors of the reference, a solve in double precision on matrices of condition 1e4.
const OF_THE_REFERENCE: f64 = 1e-12;

/// The bound may be below an error by the rounding of bound and error.
const ROUNDING: f64 = 1e-6;

/// Largest ratio of the bound to the error.
const LOOSEST: f64 = 10.0;

/// Largest median of these ratios.
const MEDIAN: f64 = 3.0;

fn energy(problem: &ContactProblem, u: &[f64]) -> f64 {
    u.iter().zip(problem.stiffness().mul(u)).map(|(u, force)| u * force).sum::<f64>().max(0.0).sqrt()
}

/// An answer, certified or not.
fn answer(problem: &ContactProblem, settings: &Settings) -> Solution {
    match solve(problem, settings) {
        Ok(solution) => solution,
        Err(Error::NotCertified { solution, .. }) => *solution,
        Err(error) => panic!("{error}"),
    }
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

/// Ratio of bound to error for every setting whose error exceeds that of the reference; asserts that no bound is below
/// its error.
fn ratios(name: &str, problem: &ContactProblem) -> Vec<(f64, String)> {
    let exact = solve(problem, &Settings::with_method(Method::ActiveSet)).unwrap();
    let mut ratios = Vec::new();
    if exact.certificate.energy_error_bound.is_infinite() {
        // A stiffness that is positive definite only together with its rows has no energy norm.
        return ratios;
    }
    for (way, settings) in ways() {
        let found = answer(problem, &settings);
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
        let path = format!("{}/examples/{name}.json", env!("CARGO_MANIFEST_DIR"));
        let model = Scene::read(path).unwrap().build().unwrap();
        // On all dofs of the larger scenes the interior point takes long.
        if model.problem().dofs() < 5000 {
            all.extend(ratios(&name, model.problem()));
        }
    }
    check(all);
}

#[test]
fn the_bound_is_near_the_error_on_a_thousand_random_problems() {
    check(
        (if std::env::var("ONE").is_ok() { 135..136 } else { 0..1000 })
            .flat_map(|seed| ratios(&format!("random {seed}"), &springs(seed)))
            .collect(),
    );
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
    check(ratios("string", &problem));
}
