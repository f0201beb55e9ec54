//! GOAL: rows of one node with any angles between them are solved by multigrid, and those that are left out because
//! they are too many are exchanged until the answer meets all.
//!
//! CONDITIONS: three rows on each node of a block, all closed, some closed, none; more rows than a node has dofs;
//! random rows.

use std::f64::consts::TAU;

use signorini::{ContactProblem, Method, Settings, Solution, SparseMatrix, solve};

use support::bodies::{clamped_block, difference, largest};
use support::oracles::{Dense, Draws, random};
use support::scenes::built;

/// Difference of two answers with oblique rows: both are certified to 1e-9, and the condition numbers are at most 1e3.
const SAME: f64 = 1e-6;

/// Rounding of random problems with condition numbers below 1e4.
const SAME_AS_ENUMERATED: f64 = 1e-7;

/// A block under a sphere, the row of each top node replaced by rows whose normals lean by `lean` (radians) towards
/// `count` directions. Their gaps are those of the sphere plus `beyond(row of the node)`.
fn with_normals(n: usize, count: usize, lean: f64, beyond: impl Fn(usize) -> f64) -> ContactProblem {
    let block = built(&clamped_block(n, -0.02)).problem().clone();
    let (mut entries, mut gap) = (Vec::new(), Vec::new());
    for (node, up, _) in block.contact().triplets() {
        for index in 0..count {
            let angle = TAU * (index as f64 + 0.1) / count as f64;
            let normal = [lean.sin() * angle.cos(), lean.sin() * angle.sin(), lean.cos()];
            // The dofs of a free node follow each other.
            entries.extend((0..3).map(|axis| (gap.len(), up + axis - 2, normal[axis])));
            gap.push(block.gap()[node] + beyond(index));
        }
    }
    let contact = SparseMatrix::from_triplets(gap.len(), block.dofs(), &entries).unwrap();
    let near_null = block.near_null().unwrap().clone();
    let problem = ContactProblem::new(block.stiffness().clone(), block.load().to_vec(), contact, gap).unwrap();
    problem.with_near_null(near_null).unwrap()
}

#[track_caller]
fn agrees_with_the_direct_path(problem: &ContactProblem, what: &str) -> Solution {
    let direct = solve(problem, &Settings::with_method(Method::ActiveSet)).unwrap();
    let found = solve(problem, &Settings::with_method(Method::Mprgp)).unwrap_or_else(|error| panic!("{what}: {error}"));
    println!("{what}: {} cycles, {} of {} closed", found.iterations, found.contact_set.count(), problem.rows());
    assert!(found.certificate.meets(1e-9) && found.method == "mprgp", "{what}: {}", found.method);
    assert_eq!(found.contact_set, direct.contact_set, "{what}");
    for (found, direct) in [(&found.displacement, &direct.displacement), (&found.multiplier, &direct.multiplier)] {
        assert!(difference(found, direct) <= SAME * largest(direct), "{what}: {:e}", difference(found, direct));
    }
    found
}

#[test]
fn three_oblique_rows_of_a_node_are_bounds_at_once() {
    for lean in [0.1, 0.5, 1.2] {
        let found = agrees_with_the_direct_path(&with_normals(8, 3, lean, |_| 0.0), &format!("lean {lean}"));
        assert!(found.contact_set.count() > 10 && found.iterations <= 40, "{} cycles", found.iterations);
    }
}

#[test]
fn rows_that_are_left_out_cost_nothing_while_they_are_far() {
    let one = agrees_with_the_direct_path(&with_normals(8, 1, 0.3, |_| 0.0), "one row");
    let far = agrees_with_the_direct_path(&with_normals(8, 6, 0.3, |index| 0.1 * index.min(1) as f64), "five far rows");
    assert!(far.iterations <= one.iterations + 4, "{} cycles, {} with one row", far.iterations, one.iterations);
}

#[test]
fn rows_that_are_left_out_are_exchanged_if_they_are_violated() {
    // At rest the last rows are the nearest by a little; the answer closes others.
    for count in [4, 5, 8] {
        let problem = with_normals(8, count, 0.8, |index| 1e-3 * (count - index) as f64);
        agrees_with_the_direct_path(&problem, &format!("{count} rows on a node"));
    }
}

#[test]
fn random_problems_with_more_rows_than_dofs_agree_with_the_enumeration_of_all_sets() {
    let mut draws = Draws::new(5);
    for (case, rows) in (0..90).map(|case| (case, [3, 6, 9][case % 3])) {
        let dense: Dense = random(&mut draws, 5, rows);
        let exact = dense.enumerate();
        let found = solve(&dense.problem().unwrap(), &Settings::with_method(Method::Mprgp))
            .unwrap_or_else(|error| panic!("case {case}: {error}"));
        let error = difference(&found.displacement, exact.displacement.as_slice());
        assert!(error <= SAME_AS_ENUMERATED * largest(exact.displacement.as_slice()), "case {case}: off by {error:e}");
    }
}
