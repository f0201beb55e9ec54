//! Microseconds of a solve with certificate and proof of small problems, least of many, the making of the problem not
//! included, and the seconds of many of them at once.

use signorini::qp::solve_many;
use signorini::{ContactProblem, Error, Settings, SparseMatrix, solve};
use support::floors::problem;
use support::oracles::Draws;

use crate::clock::{fastest, timed};
use crate::process::Failure;

/// Problems of each kind, each with numbers of its own.
const PROBLEMS: u64 = 5;

/// Dense problems that are solved at once.
const MANY: u64 = 10_000;

/// Solves of each problem: fewer of large ones.
fn runs(dofs: usize) -> usize {
    (20_000 / dofs).clamp(20, 500)
}

/// A number with the normal distribution, approximately.
fn normal(draws: &mut Draws) -> f64 {
    (0..12).map(|_| draws.uniform()).sum::<f64>() - 6.0
}

/// The lower triangle of `A A' / n + 0.1 I`, rows and columns multiplied by `size`.
fn random_stiffness(draws: &mut Draws, n: usize, size: impl Fn(usize) -> f64) -> Vec<(usize, usize, f64)> {
    let a: Vec<f64> = (0..n * n).map(|_| normal(draws)).collect();
    let row = |i: usize| &a[i * n..(i + 1) * n];
    let entry = |i: usize, j: usize| row(i).iter().zip(row(j)).map(|(a, b)| a * b).sum::<f64>() / n as f64;
    let lower = (0..n).flat_map(|j| (j..n).map(move |i| (i, j)));
    lower.map(|(i, j)| (i, j, (entry(i, j) + if i == j { 0.1 } else { 0.0 }) * size(i) * size(j))).collect()
}

/// Dense stiffness and n / 2 dense rows.
fn dense(n: usize, seed: u64) -> Result<ContactProblem, Error> {
    scaled(n, seed, |_| 1.0)
}

/// The same, with dofs of sizes from 1e-4 to 1e4.
fn contrasts(n: usize, seed: u64) -> Result<ContactProblem, Error> {
    scaled(n, seed, |dof| 10_f64.powi(dof as i32 % 9 - 4))
}

fn scaled(n: usize, seed: u64, size: impl Fn(usize) -> f64) -> Result<ContactProblem, Error> {
    let draws = &mut Draws::new(seed);
    let stiffness = random_stiffness(draws, n, &size);
    let load = (0..n).map(|dof| normal(draws) * size(dof)).collect();
    let rows: Vec<_> = (0..n / 2).flat_map(|row| (0..n).map(move |dof| (row, dof))).collect();
    let rows: Vec<_> = rows.into_iter().map(|(row, dof)| (row, dof, normal(draws) * size(dof))).collect();
    let gap = (0..n / 2).map(|_| 0.1 + 0.5 * draws.uniform()).collect();
    problem(n, &stiffness, load, (SparseMatrix::from_triplets(n / 2, n, &rows)?, gap))
}

/// The same as `dense`, with n / 4 equality rows.
fn equalities(n: usize, seed: u64) -> Result<ContactProblem, Error> {
    let draws = &mut Draws::new(seed ^ 1 << 32);
    let rows: Vec<_> = (0..n / 4).flat_map(|row| (0..n).map(move |dof| (row, dof))).collect();
    let rows: Vec<_> = rows.into_iter().map(|(row, dof)| (row, dof, normal(draws))).collect();
    let values = (0..n / 4).map(|_| 0.1 * normal(draws)).collect();
    Ok(dense(n, seed)?.with_equalities(&SparseMatrix::from_triplets(n / 4, n, &rows)?, values)?)
}

/// A stiffness with five diagonals, and a row for each dof.
fn chain(n: usize, seed: u64) -> Result<ContactProblem, Error> {
    let draws = &mut Draws::new(seed);
    let diagonals = [(0, 6.1), (1, -4.0), (2, 1.0)];
    let entries = (0..n).flat_map(|dof| diagonals.map(|(below, value)| (dof + below, dof, value)));
    let stiffness: Vec<_> = entries.filter(|entry| entry.0 < n).collect();
    let load = (0..n).map(|_| 0.1 * normal(draws)).collect();
    let rows: Vec<_> = (0..n).map(|dof| (dof, dof, 1.0)).collect();
    problem(n, &stiffness, load, (SparseMatrix::from_triplets(n, n, &rows)?, vec![0.05; n]))
}

type Make = fn(usize, u64) -> Result<ContactProblem, Error>;

/// The mean over problems of the least microseconds of many solves.
fn measure(make: Make, n: usize) -> Result<f64, Error> {
    let settings = Settings::default().with_proof();
    let mut sum = 0.0;
    for seed in 0..PROBLEMS {
        let problem = make(n, seed)?;
        sum += fastest(runs(n), || solve(&problem, &settings))?.1;
    }
    Ok(1e6 * sum / PROBLEMS as f64)
}

pub fn run() -> Result<(), Failure> {
    let kinds: [(&str, Make, &[usize]); 4] = [
        ("dense K, n / 2 dense rows", dense, &[10, 30, 100, 200]),
        ("sizes from 1e-4 to 1e4", contrasts, &[10, 30, 100]),
        ("n / 4 equality rows", equalities, &[12, 32, 100]),
        ("five diagonals, n rows", chain, &[10, 100, 1000]),
    ];
    println!("{:28} {:>6} {:>14}", "problem", "n", "microseconds");
    for (name, make, sizes) in kinds {
        for &n in sizes {
            println!("{name:28} {n:6} {:14.1}", measure(make, n)?);
        }
    }
    let problems: Vec<_> = (0..MANY).map(|seed| dense(30, seed)).collect::<Result<_, _>>()?;
    for threads in [1, 2] {
        let mut settings = Settings::default().with_proof();
        settings.threads = Some(threads);
        let (answers, seconds) = timed(|| solve_many(&problems, &settings));
        let certified = answers.iter().filter(|answer| answer.is_ok()).count();
        println!("{MANY} dense problems of 30 dofs, {threads} threads: {seconds:.2} s, {certified} certified");
    }
    Ok(())
}
