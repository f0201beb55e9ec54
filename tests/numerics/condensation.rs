//! GOAL: a problem condensed onto its contact dofs has the same answer, and the next gap or load needs no
//! factorisation.
//!
//! CONDITIONS: every example scene, the reference gaps, a body in space, inclined and two-sided rows, bodies held only
//! by their rows, redundant rows; one thread and two.

use signorini::{
    Condense, ContactProblem, Method, Penalty, Prepared, Scene, Settings, Solution, SparseMatrix, SymmetricMatrix,
    solve,
};
use std::path::Path;
use support::problems::of_entries;
use support::scenes::{built, built_example};

use serde_json::json;
use signorini::qp::{Cholesky, Error, LinearError};
use support::oracles::{Draws, random};

/// Condensed and full answers differ by rounding times the condition number of the stiffness.
const SAME: f64 = 1e-11;

const EXACT: [Method; 2] = [Method::qp(), Method::ActiveSet];

fn settings(method: Method, condense: Condense) -> Settings {
    let mut settings = Settings::with_method(method);
    settings.condense = condense;
    settings
}

fn answer(problem: &ContactProblem, settings: &Settings) -> Solution {
    solve(problem, settings).unwrap_or_else(|error| panic!("{error}"))
}

#[track_caller]
fn same(a: &[f64], b: &[f64], what: &str) {
    let largest = b.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    for (a, b) in a.iter().zip(b) {
        assert!((a - b).abs() <= SAME * largest, "{what}: {a:e} and {b:e} of {largest:e}");
    }
}

fn example(name: &str) -> ContactProblem {
    built_example(name).problem().clone()
}

/// Compares condensed and full answers and, for the active set, the sequence of contact sets.
#[track_caller]
fn check_both_ways(problem: &ContactProblem, name: &str) {
    for method in EXACT {
        let full = answer(problem, &settings(method, Condense::Never));
        let condensed = answer(problem, &settings(method, Condense::Auto));
        let what = format!("{name}, {method:?}");
        assert!(condensed.condensed_dofs < problem.dofs() / 4, "{what}: {} dofs", condensed.condensed_dofs);
        assert_eq!(full.condensed_dofs, problem.dofs());
        same(&condensed.displacement, &full.displacement, &what);
        same(&condensed.multiplier, &full.multiplier, &what);
        assert_eq!(condensed.contact_set, full.contact_set, "{what}");
        if method == Method::ActiveSet {
            let sets =
                |solution: &Solution| solution.history.iter().map(|step| step.contact_set.clone()).collect::<Vec<_>>();
            // A body held only by its rows starts with springs, whose size comes from the condensed stiffness in a
            // condensed solve.
            if full.certificate.energy_error_bound.is_finite() {
                assert_eq!(sets(&condensed), sets(&full), "{what}: history");
            }
        }
    }
}

#[test]
fn every_example_scene_has_the_same_answer_and_the_same_search() {
    let folder = std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples")).unwrap();
    let mut count = 0;
    for entry in folder {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "json") {
            let model = Scene::read(&path).unwrap().build().unwrap();
            if model.problem().dofs() > support::cases(5_000, usize::MAX) {
                continue;
            }
            check_both_ways(model.problem(), &path.display().to_string());
            count += 1;
        }
    }
    assert!(count >= 6);
}

#[test]
fn the_gaps_of_the_reference_have_the_same_answer_and_the_same_search() {
    let problem = example("indentation");
    for step in 0..10 {
        let gap = problem.gap().iter().map(|gap| gap - 0.01 * f64::from(step)).collect();
        check_both_ways(&problem.with_gap(gap).unwrap(), &format!("step {step}"));
    }
}

/// A cube under a sphere. From 14 divisions on, minimum degree costs so much that nested dissection is tried.
fn cube(divisions: usize) -> ContactProblem {
    let axis = serde_json::json!({"points": [0, 1], "divisions": [divisions]});
    let scene = serde_json::json!({
        "model": "space",
        "body": {"box": {"x": axis, "y": axis, "z": axis, "element": "hex8"}},
        "material": {"young": 1e7, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": 0}],
        "obstacles": [{"boundary": "top", "approach": "+z", "shape": {"sphere": {"apex": [0.5, 0.5, 1], "radius": 1}}}],
        "gap": -0.01,
    });
    built(&scene).problem().clone()
}

#[test]
fn body_in_space_has_the_same_answer_and_the_same_search() {
    check_both_ways(&cube(5), "cube");
    let dissected = cube(14);
    let full = answer(&dissected, &settings(Method::ActiveSet, Condense::Never));
    let condensed = answer(&dissected, &settings(Method::ActiveSet, Condense::Auto));
    assert_eq!(condensed.condensed_dofs, 15 * 15);
    same(&condensed.displacement, &full.displacement, "u of the large cube");
    same(&condensed.multiplier, &full.multiplier, "lambda of the large cube");
    assert_eq!(condensed.contact_set, full.contact_set);
}

/// Threads divide the columns of a block among themselves, not the terms of a sum.
#[test]
fn two_threads_give_the_answer_of_one_bit_by_bit() {
    let mut settings = settings(Method::ActiveSet, Condense::Auto);
    for problem in [cube(14), example("indentation")] {
        settings.threads = Some(1);
        let one = answer(&problem, &settings);
        settings.threads = Some(2);
        let two = answer(&problem, &settings);
        assert_eq!(one.displacement, two.displacement);
        assert_eq!(one.multiplier, two.multiplier);
        assert_eq!(one.certificate, two.certificate);
    }
    settings.threads = Some(0);
    assert!(matches!(
        solve(&example("block"), &settings),
        Err(Error::Linear(LinearError::Setting { name: "threads", .. }))
    ));
}

#[test]
fn boundary_alone_agrees_with_the_whole_answer() {
    let problem = example("indentation");
    let prepared = Prepared::new(&problem, &Settings::default()).unwrap();
    for method in EXACT {
        let prepared = prepared.with_settings(&settings(method, Condense::Auto)).unwrap();
        let warm = prepared.starting_from(prepared.solve(problem.gap()).unwrap().contact_set);
        let gap: Vec<f64> = problem.gap().iter().map(|gap| gap - 0.02).collect();
        let whole = warm.solve(&gap).unwrap();
        let boundary = warm.boundary(&gap).unwrap();
        assert_eq!(boundary.multiplier, whole.multiplier);
        assert_eq!(boundary.contact_set, whole.contact_set);
        assert_eq!(boundary.contact_force(), whole.contact_force());
        assert_eq!(boundary.displacement(), whole.displacement);
        assert!(boundary.condensed_certificate.meets(1e-12), "{:?}", boundary.condensed_certificate);
        assert!(boundary.condensed_certificate.energy_error_bound < 1e-12);
        assert_eq!(boundary.solution().unwrap().certificate, whole.certificate);

        let load: Vec<f64> = (0..problem.dofs()).map(|dof| if dof % 2 == 1 { 30.0 } else { 5.0 }).collect();
        let whole = prepared.solve_load(load.clone()).unwrap();
        let boundary = prepared.with_load(load).unwrap().boundary(problem.gap()).unwrap();
        assert_eq!(boundary.multiplier, whole.multiplier);
        assert_eq!(boundary.displacement(), whole.displacement);
    }
    let message = prepared.boundary(&[f64::NAN; 41]).unwrap_err().to_string();
    assert!(message.contains("gap vector has the value NaN at entry 0"), "{message}");
}

/// An answer that is not exact enough is refused on the boundary as on all dofs.
#[test]
fn boundary_of_a_poor_answer_is_not_certified() {
    let problem = example("indentation");
    let ladder = Penalty { last: 1e3, ..Penalty::default() };
    let prepared = Prepared::new(&problem, &settings(Method::Penalty(ladder), Condense::Auto)).unwrap();
    let refused = prepared.boundary(problem.gap());
    assert!(matches!(refused, Err(Error::NotCertified { .. })), "{refused:?}");
}

/// The orderings work for a diagonal, a chain and a full matrix.
#[test]
fn matrices_with_no_coupling_and_with_full_coupling_are_factorised() {
    for n in [1, 2, 3, 7, 64, 1000] {
        let reach = if n < 100 { n } else { 3 };
        for width in [1, 2, reach] {
            let entries: Vec<_> = (0..n)
                .flat_map(|i| (i..n.min(i + width)).map(move |j| (j, i, if i == j { n as f64 } else { -0.5 })))
                .collect();
            let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(n, n, &entries).unwrap()).unwrap();
            let x: Vec<f64> = (0..n).map(|i| 1.0 + i as f64 / n as f64).collect();
            let solved = Cholesky::of(&stiffness).unwrap().solve(&stiffness.mul(&x));
            same(&solved, &x, &format!("n = {n}, width {width}"));
        }
    }
}

/// Rows on a tenth of the dofs, some inclined, some twice; K is a chain of blocks A A'.
fn chain(draws: &mut Draws) -> ContactProblem {
    let (blocks, size) = (20, 6);
    let n = blocks * size;
    let mut entries = Vec::new();
    for block in 0..blocks {
        let dense = random(draws, size, 1).stiffness;
        for i in 0..size {
            for j in 0..=i {
                entries.push((block * size + i, block * size + j, dense[(i, j)]));
            }
        }
        if block > 0 {
            let (a, b) = ((block - 1) * size + 2, block * size);
            entries.extend([(a, a, 1.0), (b, b, 1.0), (b, a, -1.0)]);
        }
    }
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(n, n, &entries).unwrap()).unwrap();
    let mut rows = Vec::new();
    let mut gap = Vec::new();
    for _ in 0..10 {
        let dof = draws.below(n / 2);
        let row = gap.len();
        rows.push((row, dof, 1.0));
        if draws.uniform() < 0.3 {
            rows.push((row, (dof + 1) % n, draws.signed()));
        }
        gap.push(0.2 * draws.uniform());
        if draws.uniform() < 0.3 {
            rows.push((row + 1, dof, -1.0));
            gap.push(0.2 * draws.uniform());
        }
    }
    let load = (0..n).map(|_| draws.signed()).collect();
    ContactProblem::new(stiffness, load, SparseMatrix::from_triplets(gap.len(), n, &rows).unwrap(), gap).unwrap()
}

#[test]
fn inclined_two_sided_and_redundant_rows_condense() {
    let mut draws = Draws::new(7);
    let mut condensed_cases = 0;
    for case in 0..60 {
        let problem = chain(&mut draws);
        for method in EXACT {
            let full = answer(&problem, &settings(method, Condense::Never));
            let condensed = answer(&problem, &settings(method, Condense::Auto));
            condensed_cases += usize::from(condensed.condensed_dofs < problem.dofs());
            same(&condensed.displacement, &full.displacement, &format!("case {case}, {method:?}"));
            // The multipliers of redundant rows are not unique, but their effect on the body is.
            let force = |solution: &Solution| problem.contact().mul_transposed(&solution.multiplier);
            same(&force(&condensed), &force(&full), &format!("case {case}, {method:?}: B' lambda"));
        }
    }
    assert!(condensed_cases > 100, "only {condensed_cases} cases were condensed");
}

#[test]
fn next_gap_and_next_load_agree_with_independent_solves() {
    let problem = example("indentation");
    let default = Settings::with_method(Method::qp());
    let prepared = Prepared::new(&problem, &default).unwrap();
    let mut last = prepared.solve(problem.gap()).unwrap();
    for step in 1..8 {
        let gap: Vec<f64> = problem.gap().iter().map(|gap| gap - 0.006 * f64::from(step)).collect();
        let cold = answer(&problem.with_gap(gap.clone()).unwrap(), &default);
        let next = prepared.starting_from(&last.contact_set).solve(&gap).unwrap();
        assert_eq!(next.method, "qp-warm");
        same(&next.displacement, &cold.displacement, "u");
        same(&next.multiplier, &cold.multiplier, "lambda");
        last = next;
    }
    let load: Vec<f64> = (0..problem.dofs()).map(|dof| if dof % 2 == 1 { -40.0 } else { 15.0 }).collect();
    let cold = answer(&problem.with_load(load.clone()).unwrap(), &default);
    let next = prepared.solve_load(load).unwrap();
    same(&next.displacement, &cold.displacement, "u under load");
    same(&next.multiplier, &cold.multiplier, "lambda under load");
}

#[test]
fn gaps_that_do_not_fit_a_prepared_problem_are_refused() {
    let problem = example("indentation");
    let prepared = Prepared::new(&problem, &Settings::default()).unwrap();
    let message = prepared.solve(&[0.0; 3]).unwrap_err().to_string();
    assert_eq!(message, "gap vector has length 3, but there are 41 contact rows");
    let mut gap = problem.gap().to_vec();
    gap[5] = f64::INFINITY;
    let message = prepared.solve(&gap).unwrap_err().to_string();
    assert!(message.contains("gap vector has the value inf at entry 5"), "{message}");
}

#[test]
fn rows_on_most_dofs_are_not_condensed() {
    let n = 300;
    let entries: Vec<_> =
        (0..n).flat_map(|i| [(i, i, 2.0), ((i + 1).min(n - 1), i, if i + 1 < n { -1.0 } else { 0.0 })]).collect();
    let rows: Vec<_> = (0..n).map(|i| (i, i, -1.0)).collect();
    let problem = of_entries(&entries, vec![-1e-4; n], &rows, vec![0.5; n]);
    assert_eq!(answer(&problem, &Settings::default()).condensed_dofs, n);
}

/// A block held along y only by its contact rows, with many more dofs than its boundary: if it is pressed it is solved,
/// and if it is pulled it is unbounded.
#[test]
fn floating_body_is_solved_condensed_if_pressed_and_moves_as_a_whole_if_pulled() {
    let block = |traction: f64| {
        let scene = serde_json::json!({
            "body": {"rectangle": {"x": {"points": [0, 1], "divisions": [8]}, "y": {"points": [0, 1], "divisions": [16]}}},
            "material": {"young": 1e5, "poisson": 0.3},
            "supports": [{"on": {"boundary": "left"}, "x": 0}],
            "loads": [{"traction": {"boundary": "top", "value": [0, traction]}}],
            "obstacles":
                [{"boundary": "bottom", "approach": "-y", "shape": {"plane": {"point": [0, 0], "normal": [0, -1]}}}],
            "gap": 0.01,
        });
        built(&scene)
    };
    for method in EXACT {
        let pressed = block(-100.0);
        let condensed = answer(pressed.problem(), &settings(method, Condense::Auto));
        let full = answer(pressed.problem(), &settings(method, Condense::Never));
        assert!(condensed.condensed_dofs == 9 && (condensed.contact_force() - 100.0).abs() < 1e-9);
        same(&condensed.displacement, &full.displacement, "pressed");
        match solve(block(100.0).problem(), &settings(method, Condense::Auto)) {
            Err(Error::Unbounded { direction, .. }) => {
                let lifted = direction.iter().filter(|d| (*d - 1.0).abs() < 1e-8).count();
                let still = direction.iter().filter(|d| d.abs() < 1e-8).count();
                assert_eq!((lifted, lifted + still), (9 * 17, direction.len()), "{method:?}");
            }
            other => panic!("{method:?}: {other:?}"),
        }
    }
}

/// A block of 8 x 8 cells between rollers, pressed by a flat obstacle: uniaxial strain.
fn pressed_block(width: f64, height: f64) -> ContactProblem {
    let axis = |length: f64| json!({"points": [0, length], "divisions": [8]});
    let scene = json!({
        "body": {"rectangle": {"x": axis(width), "y": axis(height), "element": "q4"}},
        "material": {"young": 1, "poisson": 0.3},
        "supports": [
            {"on": {"boundary": "bottom"}, "y": 0},
            {"on": {"boundary": "left"}, "x": 0},
            {"on": {"boundary": "right"}, "x": 0}
        ],
        "obstacles": [{"boundary": "top", "approach": "+y",
                       "shape": {"plane": {"point": [0, height], "normal": [0, 1]}}}],
        "gap": -0.01 * height
    });
    built(&scene).problem().clone()
}

#[test]
fn digits_lost_by_condensation_are_restored_by_a_repair_or_by_a_solve_on_all_dofs() {
    let force = |width: f64| 0.7 / (1.3 * 0.4) * 0.01 * width;
    let wide = pressed_block(1e6, 1.0);
    // The repair of the bound, on all dofs, restores the digits.
    for method in [Method::Auto, Method::qp(), Method::ActiveSet] {
        let solution = answer(&wide, &settings(method, Condense::Auto));
        let error = (solution.contact_force() / force(1e6) - 1.0).abs();
        assert!(error <= 1e-12, "{method:?}: {error:e}");
        assert!(solution.refinements > 0 && solution.condensed_dofs < wide.dofs(), "{method:?}");
    }
    // A penalty answer has no repair: it is the answer of the contact springs.
    let soft = settings(Method::penalty(), Condense::Auto).with_tolerance(1e-6);
    let solution = answer(&wide, &soft);
    assert_eq!(solution.condensed_dofs, wide.dofs());
    let error = (solution.contact_force() / force(1e6) - 1.0).abs();
    assert!(error <= 1e-6, "{error:e}");
    // The solution lists the failed attempt, and its time includes it.
    let [attempt] = &solution.attempts[..] else { panic!("{:?}", solution.attempts) };
    assert!(attempt.reason.contains("condensed dofs") && attempt.reason.contains("above"), "{attempt:?}");
    assert!(attempt.seconds > 0.0 && solution.seconds.solve > attempt.seconds, "{attempt:?}");
    // If the first attempt is certified, there is no second one.
    let held = answer(&pressed_block(1.0, 1.0), &settings(Method::ActiveSet, Condense::Auto));
    assert!(held.attempts.is_empty() && held.condensed_dofs < held.displacement.len(), "{:?}", held.attempts);
}

/// A slender beam between two clamps, pressed by a parabola, takes more than thirty sets. If each has a factor on all
/// dofs, the loop ends once they have cost twice what multigrid is expected to cost.
#[test]
fn sets_on_all_dofs_that_do_not_settle_give_way_to_multigrid() {
    let clamps = ["left", "right"].map(|side| json!({"on": {"boundary": side}, "x": 0, "y": 0}));
    let beam = built(&json!({
        "model": "plane-strain",
        "body": {"rectangle": {"element": "q4", "x": {"points": [0, 4], "divisions": [200]},
            "y": {"points": [0, 0.1], "divisions": [4]}}},
        "material": {"young": 1e7, "poisson": 0.3},
        "supports": clamps,
        "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"parabola": {"apex": [2, 0.1], "radius": 10}}}],
        "gap": -0.1,
    }));
    let problem = beam.problem();
    let long = answer(problem, &settings(Method::ActiveSet, Condense::Never));
    let switched = answer(problem, &settings(Method::Auto, Condense::Never));
    let condensed = answer(problem, &settings(Method::Auto, Condense::Auto));
    assert_eq!((&*switched.method, &*condensed.method), ("mprgp", "active-set-continuation"));
    assert_eq!(switched.attempts[0].method, "active-set-unsettled");
    assert!(switched.why.reason.contains("sets with a factor each cost more"), "{}", switched.why.reason);
    assert!(long.iterations > 30, "{}", long.iterations);
    assert_eq!(switched.contact_set, long.contact_set);
    same(&condensed.displacement, &long.displacement, "on the contact dofs");
}
