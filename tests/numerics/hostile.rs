//! Hostile contact problems: each ends with a certified answer, which is checked here again by independent arithmetic,
//! or with a typed error.

use nalgebra::{DMatrix, DVector};
use signorini::qp::{Error, NearNullSpace};
use signorini::{Condense, ContactSet, Method, Prepared, Settings, Solution, Start, solve};
use support::oracles::{Dense, Draws, random};

/// The expected ending.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Ending {
    /// A certified answer.
    Certified,
    /// An error with this code.
    Refused(&'static str),
    /// A certified answer or any error, but no wrong answer: the data contradict each other by about the tolerance.
    Either,
}
use Ending::{Certified, Either, Refused};

/// Largest relative error of a certified answer in the check below: ten times its tolerance.
const CHECKED: f64 = 1e-8;

fn springs(n: usize, stiffness: f64) -> DMatrix<f64> {
    DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => 2.0 * stiffness,
        1 => -stiffness,
        _ => 0.0,
    })
}

fn problem(stiffness: DMatrix<f64>, load: &[f64], contact: &[&[f64]], gap: &[f64]) -> Dense {
    let mut dense = Dense::new(&[], &[], &[], &[]);
    dense.contact =
        DMatrix::from_row_iterator(gap.len(), load.len(), contact.iter().flat_map(|row| row.iter().copied()));
    (dense.stiffness, dense.load, dense.gap) = (stiffness, DVector::from_row_slice(load), DVector::from_row_slice(gap));
    dense
}

/// Two dofs in units of stiffness `k` and length `u`: load k u (1, 0.3), gaps u / 2 on both dofs.
fn in_units(k: [f64; 2], u: f64) -> Dense {
    let load = [k[0] * u, 0.3 * k[1] * u];
    problem(
        DMatrix::from_diagonal(&DVector::from_row_slice(&k)),
        &load,
        &[&[1.0, 0.0], &[0.0, 1.0]],
        &[0.5 * u, 0.5 * u],
    )
}

fn one(k: f64, f: f64, b: f64, g: f64) -> Dense {
    problem(DMatrix::from_element(1, 1, k), &[f], &[&[b]], &[g])
}

/// A node in the plane, held by two springs of stiffness 1, between rows with the given normals and gaps.
fn node(load: [f64; 2], rows: &[([f64; 2], f64)]) -> Dense {
    let contact: Vec<&[f64]> = rows.iter().map(|row| &row.0[..]).collect();
    let gap: Vec<f64> = rows.iter().map(|row| row.1).collect();
    problem(DMatrix::identity(2, 2), &load, &contact, &gap)
}

fn cases() -> Vec<(String, Dense, Ending)> {
    let mut cases: Vec<(String, Dense, Ending)> = Vec::new();
    let mut add = |name: &str, dense: Dense, ending| cases.push((name.to_string(), dense, ending));

    // Units in which an unscaled interior-point method reports wrong answers as solved.
    add("micrometres", in_units([1.0, 1.0], 1e-6), Certified);
    add("steel in nanometres", in_units([2.1e11, 2.1e11], 1e-9), Certified);
    for ratio in [1e9, 1e12, 1e15] {
        add(&format!("contrast {ratio:e}"), in_units([1.0, ratio], 1.0), Certified);
    }
    for exponent in [-300, -150, 150, 300] {
        add(&format!("length 1e{exponent}"), in_units([1.0, 1.0], 10.0_f64.powi(exponent)), Certified);
        add(&format!("stiffness 1e{exponent}"), in_units([10.0_f64.powi(exponent); 2], 1.0), Certified);
    }
    // Infinite, huge and vanishing gaps: an interior-point method drops rows beyond 1e20.
    add("no obstacle", one(1.0, 2.0, 1.0, f64::INFINITY), Certified);
    for gap in [1e19, 1e20, 1e21, 1e300, 1e-19, 1e-300, 5e-324, 0.0, -0.0, -1e-300, -1.0] {
        add(&format!("gap {gap:e}"), one(1.0, 2.0, 1.0, gap), Certified);
    }
    let far = problem(springs(2, 1.0), &[0.0, 3.0], &[&[0.0, 1.0], &[1.0, 0.0]], &[1.0, 1e200]);
    add("one gap out of all reach", far, Certified);
    // Problems that are not convex; an interior-point method does not check this.
    add(
        "saddle in a box",
        {
            let rows: [&[f64]; 4] = [&[1.0, 0.0], &[-1.0, 0.0], &[0.0, 1.0], &[0.0, -1.0]];
            problem(DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 1.0]), &[0.0, 1.0], &rows, &[1.0; 4])
        },
        Refused("not-convex"),
    );
    add(
        "zero diagonal beside a coupling",
        problem(DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 1.0, 1.0]), &[0.0, 1.0], &[&[1.0, 0.0]], &[1.0]),
        Refused("not-convex"),
    );
    add(
        "slightly indefinite",
        problem(DMatrix::from_row_slice(2, 2, &[1.0, 1.0001, 1.0001, 1.0]), &[0.0, 1.0], &[&[1.0, 0.0]], &[1.0]),
        Refused("not-convex"),
    );
    // Crossing bounds: other solvers report slightly infeasible problems as solved.
    for overlap in [1e-2, 1e-6, 1e-9, 1e-12, 1e-14] {
        let dense = node([1.0, 0.0], &[([1.0, 0.0], 1.0), ([-1.0, 0.0], -1.0 - overlap)]);
        add(&format!("bounds that cross by {overlap:e}"), dense, Refused("infeasible"));
        let dense = node([1.0, 0.0], &[([1.0, 0.0], 1.0), ([-3.0, 0.0], -3.0 * (1.0 + overlap))]);
        add(&format!("scaled bounds that cross by {overlap:e}"), dense, Refused("infeasible"));
    }
    add("bounds that meet", node([1.0, 0.0], &[([1.0, 0.0], 1.0), ([-1.0, 0.0], -1.0)]), Certified);
    for overlap in [1e-2, 1e-4] {
        let rows = [([0.0, 1.0], -0.5 - overlap), ([0.8, -0.6], 0.3), ([-0.8, -0.6], 0.3)];
        add(
            &format!("three rows that contradict each other by {overlap:e}"),
            node([0.3, 1.0], &rows),
            Refused("infeasible"),
        );
    }
    for overlap in [1e-8, 1e-10, 1e-13] {
        let rows = [([0.0, 1.0], -0.5 - overlap), ([0.8, -0.6], 0.3), ([-0.8, -0.6], 0.3)];
        add(&format!("three rows that hardly contradict each other, by {overlap:e}"), node([0.3, 1.0], &rows), Either);
    }
    // Redundant and nearly parallel rows.
    for copies in [2, 10, 100] {
        add(&format!("{copies} equal rows"), node([3.0, 1.0], &vec![([1.0, 0.0], 0.5); copies]), Certified);
    }
    for angle in [1e-1, 1e-3, 1e-6, 1e-9, 1e-12, 1e-15] {
        let angle: f64 = angle;
        let rows = [([1.0, 0.0], 0.5), ([angle.cos(), angle.sin()], 0.5)];
        // If the directions differ by about the tolerance, both rows look closed at once; the answer has an error of
        // that size, and its certificate says so.
        let ending = if angle == 1e-9 { Either } else { Certified };
        add(&format!("rows {angle:e} apart"), node([3.0, 1.0], &rows), ending);
    }
    add("a row of zeros", node([3.0, 1.0], &[([1.0, 0.0], 0.5), ([0.0, 0.0], 0.0)]), Certified);
    add("a row of zeros with a negative gap", node([3.0, 1.0], &[([0.0, 0.0], -1e-300)]), Refused("infeasible"));
    add(
        "rows of very different lengths",
        node([3.0, 2.0], &[([1e150, 0.0], 0.5e150), ([0.0, 1e-150], 0.5e-150)]),
        Certified,
    );
    add(
        "weakly active everywhere",
        problem(springs(5, 1.0), &[0.0; 5], &[&[1.0, 0.0, 0.0, 0.0, 0.0], &[0.0, 0.0, 1.0, 0.0, 0.0]], &[0.0, 0.0]),
        Certified,
    );
    // Bodies without support, held by contact alone, or pulled away.
    add("no support and no load", problem(DMatrix::zeros(2, 2), &[0.0, 0.0], &[], &[]), Refused("under-held"));
    add("no support and a load", problem(DMatrix::zeros(2, 2), &[0.0, 1.0], &[], &[]), Refused("unbounded"));
    add("a free point pressed on a wall", one(0.0, 1.0, 1.0, 0.5), Certified);
    add("a free point pulled off a wall", one(0.0, -1.0, 1.0, 0.5), Refused("unbounded"));
    add("a free point before a wall", one(0.0, 0.0, 1.0, 0.5), Refused("under-held"));
    add(
        "a free point between walls that meet",
        problem(DMatrix::zeros(1, 1), &[1.0], &[&[1.0], &[-1.0]], &[0.5, -0.5]),
        Certified,
    );
    let rod = DMatrix::from_row_slice(2, 2, &[1.0, -1.0, -1.0, 1.0]);
    add("a rod pressed on a wall", problem(rod.clone(), &[1.0, 0.5], &[&[0.0, 1.0]], &[0.5]), Certified);
    add("a rod pulled off a wall", problem(rod.clone(), &[-1.0, 0.5], &[&[0.0, 1.0]], &[0.5]), Refused("unbounded"));
    add("a rod in balance before a wall", problem(rod, &[1.0, -1.0], &[&[0.0, 1.0]], &[5.0]), Refused("under-held"));
    // Degenerate sizes.
    add("no dofs, no rows", problem(DMatrix::zeros(0, 0), &[], &[], &[]), Certified);
    add("no dofs, a row", problem(DMatrix::zeros(0, 0), &[], &[&[]], &[1.0]), Certified);
    add(
        "no dofs, a row with a negative gap",
        problem(DMatrix::zeros(0, 0), &[], &[&[]], &[-1.0]),
        Refused("infeasible"),
    );
    add(
        "all rows closed, no load",
        problem(springs(3, 1.0), &[0.0; 3], &[&[1.0, 0.0, 0.0], &[0.0, 1.0, 0.0], &[0.0, 0.0, 1.0]], &[0.0; 3]),
        Certified,
    );
    add(
        "more rows than dofs",
        node(
            [1.0, 1.0],
            &[([1.0, 0.0], 0.1), ([0.0, 1.0], 0.1), ([1.0, 1.0], 0.15), ([1.0, -1.0], 0.2), ([-1.0, 1.0], 0.2)],
        ),
        Certified,
    );
    // Numbers at the ends of double precision.
    add("denormal stiffness", one(5e-324, 5e-324, 1.0, 0.5), Either);
    add("denormal load", one(1.0, 5e-324, 1.0, 0.5), Certified);
    add("stiffness near overflow", one(1e308, 1e307, 1.0, 0.05), Certified);
    add("load near overflow", one(1.0, 1e308, 1.0, 1.0), Certified);
    add("displacement beyond double precision", one(1e-300, 1e300, 1.0, f64::INFINITY), Either);
    add("load and gap at opposite ends", one(1.0, 1e-300, 1.0, -1e300), Certified);
    // Examples of cycling from the literature.
    add(
        "cycle of order three",
        Dense::lcp(&[&[4.0, 5.0, -5.0], &[5.0, 9.0, -5.0], &[-5.0, -5.0, 7.0]], &[2.0, 1.0, -3.0]),
        Certified,
    );
    add(
        "another cycle of order three",
        Dense::lcp(&[&[5.0, -2.0, -4.0], &[-2.0, 2.0, 3.0], &[-4.0, 3.0, 5.0]], &[4.0, -1.0, -3.0]),
        Certified,
    );
    add(
        "two-cycle by rounding",
        Dense::lcp(&[&[12.0, -2.0, -2.0], &[-2.0, 1.0, 1.0], &[-2.0, 1.0, 3.0]], &[0.0, -4.0, -4.0]),
        Certified,
    );
    // The Hilbert matrix is positive definite, and from order 13 on singular in double precision.
    for order in [6, 10, 14] {
        let hilbert = DMatrix::from_fn(order, order, |i, j| 1.0 / (i + j + 1) as f64);
        let mut row = vec![0.0; order];
        row[0] = 1.0;
        let ending = if order < 10 { Certified } else { Either };
        add(&format!("Hilbert matrix of order {order}"), problem(hilbert, &vec![1.0; order], &[&row], &[0.1]), ending);
    }
    cases
}

/// Checks the conditions of the solution in dense arithmetic that shares no code with the crate. Data at the ends of
/// double precision are first scaled to order one by powers of two.
fn check(name: &str, dense: &Dense, solution: &Solution) {
    let size = |values: &[f64]| values.iter().filter(|v| v.is_finite()).fold(0.0, |size: f64, v| size.max(v.abs()));
    let (k, moved) = (size(dense.stiffness.as_slice()), size(&solution.displacement));
    if k == 0.0 || dense.load.is_empty() {
        return;
    }
    // A body at rest has the displacement that its loads would cause as its scale.
    let length = if moved > 0.0 { moved } else { (size(dense.load.as_slice()) / k).max(f64::MIN_POSITIVE) };
    let to_one =
        |value: f64| if value == 0.0 { 1.0 } else { 2.0_f64.powi(value.log2().floor().clamp(-1000.0, 1000.0) as i32) };
    let (k, length) = (to_one(k), to_one(length));
    let u = DVector::from_row_slice(&solution.displacement) / length;
    let lambda = DVector::from_row_slice(&solution.multiplier) / k / length;
    let (stiffness, load) = (&dense.stiffness / k, &dense.load / k / length);
    let terms = stiffness.abs() * u.abs() + load.abs() + dense.contact.transpose().abs() * lambda.abs();
    let residual = &stiffness * &u - &load - dense.contact.transpose() * &lambda;
    let scale = size(load.as_slice()).max(size((dense.contact.transpose() * &lambda).as_slice()));
    for dof in 0..u.len() {
        assert!(
            residual[dof].abs() <= CHECKED * scale + 1e-14 * terms[dof],
            "{name}: force {} at dof {dof}",
            residual[dof]
        );
    }
    let reach = size((&dense.contact * &u).as_slice());
    for row in 0..lambda.len() {
        let distance = (dense.contact.row(row) * &u)[0] - dense.gap[row] / length;
        let near = reach.max(if lambda[row] == 0.0 { 0.0 } else { dense.gap[row].abs() / length }).max(1e-3 * scale);
        assert!(distance <= CHECKED * near, "{name}: row {row} penetrates by {distance:e}");
        assert!(lambda[row] <= 0.0, "{name}: row {row} has a tensile force");
        assert!(
            (lambda[row] * distance).abs() <= CHECKED * size(lambda.as_slice()) * near || lambda[row] == 0.0,
            "{name}: row {row}"
        );
    }
}

#[test]
fn hostile_problems_end_with_a_certified_answer_or_a_typed_error() {
    let cases = cases();
    assert!(cases.len() >= 60, "{}", cases.len());
    let mut wrong = Vec::new();
    for (name, dense, expected) in &cases {
        for method in [Method::qp(), Method::ActiveSet] {
            for condense in [Condense::Auto, Condense::Never] {
                let mut settings = Settings::with_method(method);
                settings.condense = condense;
                let found = dense.problem().and_then(|problem| solve(&problem, &settings));
                let right = match (&found, expected) {
                    (Ok(solution), Certified | Either) => {
                        check(name, dense, solution);
                        true
                    }
                    (Err(error), Refused(code)) => error.code() == *code,
                    (Err(_), Either) => true,
                    _ => false,
                };
                if !right {
                    let said = found.map(|_| "an answer".to_string()).unwrap_or_else(|error| error.to_string());
                    wrong.push(format!("{name} by {method:?}, {condense:?}: {said}, not {expected:?}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// The penalty method returns an answer within its certificate, or an error with the value that is too large.
#[test]
fn hostile_problems_end_with_a_certified_answer_or_an_error_by_the_penalty_method() {
    for (name, dense, _) in cases() {
        match dense.problem().and_then(|problem| solve(&problem, &Settings::with_method(Method::penalty()))) {
            Ok(solution) => check(&name, &dense, &solution),
            Err(Error::NotCertified { value, tolerance, .. }) => {
                assert!(value.is_nan() || value > tolerance, "{name}")
            }
            Err(_) => {}
        }
    }
}

/// Values that are not finite, planted one at a time in a valid problem.
#[test]
fn values_that_are_not_finite_are_refused_except_an_infinite_gap() {
    let mut draws = Draws::new(11);
    for case in 0..60 {
        let mut dense = random(&mut draws, 3, 3);
        let value = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY][case % 3];
        let place = draws.below(3);
        let code = match case / 3 % 4 {
            0 => {
                dense.stiffness[(place, place)] = value;
                "not-finite"
            }
            1 => {
                dense.load[place] = value;
                "not-finite"
            }
            2 => {
                dense.contact[(place, draws.below(3))] = value;
                "not-finite"
            }
            _ => {
                dense.gap[place] = value;
                if value == f64::INFINITY { "" } else { "not-finite" }
            }
        };
        let found = dense.problem().and_then(|problem| signorini::solve_qp(&problem));
        assert_eq!(found.err().map_or("", |error| error.code()), code, "case {case}");
    }
}

/// The sentence names the entry and its value, for the methods that use a start and for those that do not.
#[test]
fn a_start_that_is_not_finite_or_does_not_fit_is_refused_by_every_method() {
    let problem = node([0.3, 0.0], &[([1.0, 0.0], 0.1)]).problem().unwrap();
    for method in [Method::Auto, Method::ActiveSet, Method::Mprgp, Method::penalty()] {
        let prepared = Prepared::new(&problem, &Settings::with_method(method)).unwrap();
        let refused = |start: Start| {
            let started = prepared.starting_from(start);
            let (whole, boundary) = (started.solve(problem.gap()), started.boundary(problem.gap()));
            let sentence = whole.expect_err("a start that does not fit").to_string();
            assert_eq!(boundary.expect_err("a start that does not fit").to_string(), sentence);
            sentence
        };
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let sentence = refused(Start::near(vec![0.0, value]));
            let expected = format!("has the value {value} at entry 1");
            assert!(sentence.contains(&expected), "{method:?}: {sentence}");
        }
        for start in [Start::near(vec![0.0; 3]), ContactSet::open(3).into()] {
            let sentence = refused(start);
            assert!(sentence.contains("to start from has length 3"), "{method:?}: {sentence}");
        }
        match prepared.starting_from(Start::near(vec![0.1, 0.0])).solve(problem.gap()) {
            Ok(_) | Err(Error::NotCertified { .. }) => {}
            Err(error) => panic!("{method:?}: {error}"),
        }
    }
}

/// On a line there is no rotation, so that no coordinate enters the near-null vectors.
#[test]
fn coordinates_that_are_not_finite_are_refused_in_one_two_and_three_dimensions() {
    for dimension in 1..=3 {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut axes = vec![vec![0.0, 1.0, 4.0]; dimension];
            axes[dimension - 1][2] = value;
            let sentence = NearNullSpace::of_nodes(&axes).expect_err("a coordinate that is not finite").to_string();
            let expected = format!("has the value {value} at (2, {})", dimension - 1);
            assert!(sentence.contains("coordinates") && sentence.contains(&expected), "{sentence}");
        }
    }
}
