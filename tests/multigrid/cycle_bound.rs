//! GOAL: without a factor the bound on the energy error is above the true error, and nearly as small.
//!
//! CONDITIONS: bodies in space, in the plane, thin, nearly incompressible, two that touch, with springs for supports; random
//! gaps; answers from a few cycles to the last digit; small random problems. The true error is that against the direct path.

use crate::bodies::{built, clamped_block, clamped_square};
use crate::oracles::{Draws, random};
use serde_json::{Value, json};
use signorini::internals::Cholesky;
use signorini::internals::multigrid::{Multigrid, NearNullSpace, dual_norm};
use signorini::{ContactProblem, Error, Method, Prepared, Settings, Solution, SymmetricMatrix, solve};

/// The bound is of the exact answer; the reference has an error of its own, of rounding. Relative energy norm.
const OF_REFERENCE: f64 = 1e-11;

/// Bound over true error, in the middle of all cases.
const MEDIAN: f64 = 1.3;

/// Gaps of each body.
const GAPS: usize = 4;

/// Cycles that the bound takes on a body without thin parts.
const FEW_CYCLES: usize = 6;

fn mprgp() -> Settings {
    Settings::with_method(Method::Mprgp)
}

fn energy(problem: &ContactProblem, u: &[f64]) -> f64 {
    u.iter().zip(problem.stiffness().mul(u)).map(|(u, f)| u * f).sum::<f64>().max(0.0).sqrt()
}

/// The answer, certified or not.
fn answer(found: Result<Solution, Error>) -> Option<Solution> {
    match found {
        Ok(solution) => Some(solution),
        Err(Error::NotCertified { solution, .. }) => Some(*solution),
        Err(_) => None,
    }
}

/// Bound over true error of an answer; `None` where the true error drowns in that of the reference.
fn overestimate(problem: &ContactProblem, found: &Solution, exact: &[f64], what: &str) -> Option<f64> {
    let difference: Vec<f64> = found.displacement.iter().zip(exact).map(|(a, b)| a - b).collect();
    let size = energy(problem, &found.displacement);
    let error = if size > 0.0 { energy(problem, &difference) / size } else { return None };
    let bound = found.certificate.energy_error_bound;
    assert!(bound.is_finite(), "{what}: {:?}", found.certificate);
    assert!(error <= bound + OF_REFERENCE, "{what}: an error of {error:e} above its bound {bound:e}");
    (error > 10.0 * OF_REFERENCE).then_some(bound / error)
}

fn box_under_sphere(lengths: [f64; 3], cells: [usize; 3], poisson: f64, held: &str, gap: f64) -> Value {
    let axis = |i: usize| json!({"points": [0, lengths[i]], "divisions": [cells[i]]});
    json!({
        "model": "space", "body": {"box": {"x": axis(0), "y": axis(1), "z": axis(2), "element": "hex8"}},
        "material": {"young": 1e7, "poisson": poisson},
        "supports": [{"on": {"boundary": held}, "x": 0, "y": 0, "z": 0}],
        "obstacles": [{"boundary": "top", "approach": "+z", "rule": "approach",
                       "shape": {"sphere": {"apex": [lengths[0] / 2.0, lengths[1] / 2.0, lengths[2]], "radius": 2}}}],
        "gap": gap,
    })
}

fn half_ball(half: Option<&str>, centre: f64) -> Value {
    let mut ball = json!({"half-ball": {"centre": [0, 0, centre], "radius": 1,
                                        "zone": {"width": 0.3, "divisions": 3, "growth": 1.4}}});
    if let Some(half) = half {
        ball["half-ball"]["half"] = json!(half);
    }
    ball
}

fn scenes() -> Vec<(&'static str, Value, f64)> {
    let held = |boundary: &str, z: f64| json!({"on": {"boundary": boundary}, "x": 0, "y": 0, "z": z});
    let two = json!({
        "model": "space", "body": half_ball(Some("lower"), 1.0), "material": {"young": 2e7, "poisson": 0.3},
        "further-bodies": [{"name": "base", "body": half_ball(Some("upper"), -1.0),
                            "material": {"young": 1e7, "poisson": 0.2}}],
        "supports": [held("cut", -0.004), held("base.cut", 0.0)],
        "obstacles": [{"boundary": "round", "approach": "-z", "shape": {"body": {"boundary": "base.round"}}}],
    });
    let parabola = json!({"parabola": {"apex": [0.5, 1], "radius": 2}});
    let square = json!([{"boundary": "top", "approach": "+y", "rule": "approach", "shape": parabola}]);
    vec![
        ("block", clamped_block(9, -0.01), 0.01),
        ("square", clamped_square(34, square, -0.01), 0.01),
        ("nearly incompressible", box_under_sphere([1.0; 3], [9; 3], 0.49, "bottom", -0.01), 0.01),
        ("plate on its face", box_under_sphere([1.0, 1.0, 0.02], [18, 18, 2], 0.3, "bottom", -0.0005), 5e-4),
        ("plate on an edge", box_under_sphere([1.0, 1.0, 0.02], [18, 18, 2], 0.3, "left", -0.0005), 5e-4),
        ("two half balls", two, 1e-3),
    ]
}

/// The block on springs instead of its support, so soft that contact changes everything.
fn on_springs() -> ContactProblem {
    let mut scene = clamped_block(9, -0.01);
    scene["supports"] = json!([{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "front"}, "y": 0}]);
    scene["loads"] = json!([{"traction": {"boundary": "bottom", "value": [0, 0, 1e4]}}]);
    let problem = built(&scene).problem().clone();
    let lower = problem.stiffness().lower();
    let spring = 0.01 * crate::bodies::largest(&problem.stiffness().diagonal());
    let entries: Vec<_> = (lower.triplets())
        .map(|(row, column, value)| (row, column, value + if row == column && row < 300 { spring } else { 0.0 }))
        .collect();
    let dofs = problem.dofs();
    let lower = signorini::SparseMatrix::from_triplets(dofs, dofs, &entries).unwrap();
    let stiffness = SymmetricMatrix::from_lower(lower).unwrap();
    let near_null = problem.near_null().unwrap().clone();
    ContactProblem::new(stiffness, problem.load().to_vec(), problem.contact().clone(), problem.gap().to_vec())
        .and_then(|held| held.with_near_null(near_null))
        .unwrap()
}

/// Answers at several gaps and after several numbers of cycles, and their overestimates.
fn of_body(problem: &ContactProblem, name: &str, reach: f64, draws: &mut Draws, ratios: &mut Vec<f64>) {
    let direct = Prepared::new(problem, &Settings::with_method(Method::ActiveSet)).unwrap();
    let iterative = Prepared::new(problem, &mprgp()).unwrap();
    let first = ratios.len();
    for _ in 0..GAPS {
        let shift = reach * draws.signed();
        let gap: Vec<f64> = problem.gap().iter().map(|gap| gap + shift * (1.0 + 0.2 * draws.signed())).collect();
        let at_gap = problem.with_gap(gap.clone()).unwrap();
        let Ok(exact) = direct.solve(&gap) else { continue };
        for stop in [(1e-9, 2), (1e-9, 5), (1e-2, 500), (1e-3, 500), (1e-4, 500), (1e-6, 500), (1e-8, 500)] {
            let mut settings = mprgp();
            (settings.tolerance, settings.max_iterations) = stop;
            let Some(found) = answer(iterative.with_settings(&settings).unwrap().solve(&gap)) else { continue };
            let what = format!("{name}, gaps moved by {shift:.1e}, {stop:?}");
            assert!(found.certificate.bound_is_measured, "{what}");
            ratios.extend(overestimate(&at_gap, &found, &exact.displacement, &what));
        }
    }
    let mut of_body = ratios[first..].to_vec();
    of_body.sort_by(f64::total_cmp);
    let (count, last) = (of_body.len(), of_body.last().copied().unwrap_or(f64::NAN));
    println!("{name}: {count} cases, median {:.3}, largest {last:.3}", of_body.get(count / 2).unwrap_or(&f64::NAN));
}

#[test]
fn the_bound_of_the_cycles_is_above_the_error_and_near_it() {
    let (mut draws, mut ratios) = (Draws::new(5), Vec::new());
    for (name, scene, reach) in scenes() {
        of_body(built(&scene).problem(), name, reach, &mut draws, &mut ratios);
    }
    of_body(&on_springs(), "on springs", 0.01, &mut draws, &mut ratios);
    let first = ratios.len();
    for _ in 0..1000 {
        let dense = random(&mut draws, 6, 3);
        let problem = dense.problem().unwrap();
        let mut settings = mprgp();
        settings.max_iterations = 1 + (4.0 * draws.signed().abs()) as usize;
        settings.tolerance = 10.0_f64.powf(-6.0 * draws.signed().abs());
        if let Some(found) = answer(solve(&problem, &settings)) {
            let exact = dense.enumerate();
            // A hierarchy of one level is a factor.
            assert!(!found.certificate.bound_is_measured);
            ratios.extend(overestimate(&problem, &found, exact.displacement.as_slice(), "random"));
        }
    }
    println!("random: {} cases", ratios.len() - first);
    ratios.sort_by(f64::total_cmp);
    let (count, median) = (ratios.len(), ratios[ratios.len() / 2]);
    println!("{count} cases, median {median:.4}, largest {:.3}", ratios[count - 1]);
    assert!(count >= 300, "{count} cases");
    assert!(median <= MEDIAN, "median {median}");
}

#[test]
fn the_energy_of_a_force_is_between_its_bounds_after_few_cycles() {
    let problem = built(&clamped_block(12, -0.01)).problem().clone();
    let matrix = problem.stiffness();
    let factor = Cholesky::of(matrix).unwrap();
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut draws = Draws::new(3);
    let rough: Vec<f64> = (0..problem.dofs()).map(|_| draws.signed()).collect();
    let smooth = problem.load().iter().zip(factor.solve(&factor.solve(&rough))).map(|(f, u)| f + u).collect();
    let pressed = problem.contact().mul_transposed(&vec![-1.0; problem.rows()]);
    let near_null = problem.near_null().unwrap();
    let constants = NearNullSpace::constants(matrix).unwrap();
    for near_null in [&**near_null, &constants] {
        let multigrid = Multigrid::new(matrix, near_null, 1).unwrap();
        for force in [&rough, &smooth, &pressed] {
            let exact = product(force, &factor.solve(force)).sqrt();
            let found = dual_norm(matrix, &multigrid, force).unwrap();
            assert!(found.least <= exact && exact <= found.most, "{found:?}, {exact:e}");
            assert!(found.most <= 1.05 * exact && found.ritz > 0.1, "{found:?}, {exact:e}");
            assert!(found.cycles <= FEW_CYCLES + 3 * usize::from(near_null.count() == 3), "{found:?}");
        }
    }
    let nothing = dual_norm(matrix, &Multigrid::new(matrix, near_null, 1).unwrap(), &vec![0.0; problem.dofs()]);
    assert_eq!(nothing.map(|found| found.most), Some(0.0));
}

#[test]
fn an_accuracy_that_is_named_ends_the_cycles() {
    let problem = built(&clamped_block(12, -0.01)).problem().clone();
    let exact = solve(&problem, &Settings::with_method(Method::ActiveSet)).unwrap();
    let whole = solve(&problem, &mprgp()).unwrap();
    let mut cycles = vec![whole.iterations];
    for accuracy in [1e-6, 1e-4, 1e-2] {
        let mut settings = mprgp();
        settings.accuracy = Some(accuracy);
        let found = solve(&problem, &settings).unwrap();
        assert!(found.certificate.energy_error_bound <= accuracy, "{:?}", found.certificate);
        overestimate(&problem, &found, &exact.displacement, "accuracy");
        println!(
            "accuracy {accuracy:e}: {} cycles, bound {:e}",
            found.iterations, found.certificate.energy_error_bound
        );
        cycles.push(found.iterations);
    }
    assert!(cycles.windows(2).all(|pair| pair[1] <= pair[0]) && 3 * cycles[3] <= 2 * cycles[0], "{cycles:?}");
}

#[test]
fn a_body_that_only_contact_holds_has_a_bound_with_springs_on_its_rows() {
    let mut scene = clamped_block(6, 0.0);
    scene["supports"] = json!([{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "front"}, "y": 0}]);
    scene["loads"] = json!([{"traction": {"boundary": "bottom", "value": [0, 0, 1e5]}}]);
    let model = built(&scene);
    let exact = solve(model.problem(), &Settings::with_method(Method::ActiveSet)).unwrap();
    for tolerance in [1e-4, 1e-6, 1e-9] {
        let mut settings = mprgp();
        settings.tolerance = tolerance;
        let found = solve(model.problem(), &settings).unwrap();
        let away: Vec<f64> = found.displacement.iter().zip(&exact.displacement).map(|(u, v)| u - v).collect();
        let energy =
            |u: &[f64]| u.iter().zip(model.problem().stiffness().mul(u)).map(|(u, k)| u * k).sum::<f64>().sqrt();
        let (error, bound) = (energy(&away) / energy(&found.displacement), found.certificate.energy_error_bound);
        // The reference is exact to twelve digits; half the least Ritz value and few cycles cost less than a factor of 100.
        assert!(error <= bound + 1e-12 && bound <= tolerance && bound <= 100.0 * error + 1e-12, "{error:e} {bound:e}");
    }
}
