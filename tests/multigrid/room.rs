//! GOAL: the choice between a factor and multigrid respects the memory limit, and the answer gives its reason.
//!
//! CONDITIONS: a block with memory for factor and multigrid, for one of the two, for neither; a requested accuracy, no
//! near-null space, a fixed method.

use serde_json::{Value, json};
use signorini::qp::{Error, Estimate};
use signorini::study::{ModelSize, Summary};
use signorini::{ContactProblem, Method, Prepared, Settings, solve};
use support::bodies::clamped_block;
use support::scenes::built;

fn within(memory: f64) -> Settings {
    let mut settings = Settings::default();
    settings.memory = Some(memory);
    settings
}

fn block() -> (ContactProblem, Estimate) {
    let problem = built(&clamped_block(8, -0.01)).problem().clone();
    let estimate = Estimate::of(&problem);
    (problem, estimate)
}

#[test]
fn a_factor_is_chosen_if_it_fits() {
    let (problem, estimate) = block();
    assert!(estimate.direct_bytes > estimate.multigrid_bytes && !estimate.prefers_multigrid(estimate.direct_bytes));
    // The estimate is right up to a factor of two.
    for settings in [Settings::default(), within(2.0 * estimate.direct_bytes)] {
        let found = solve(&problem, &settings).unwrap();
        assert!(found.method.starts_with("active-set") && found.reason.is_empty(), "{}", found.method);
    }
}

#[test]
fn multigrid_is_chosen_with_the_reason_if_only_multigrid_fits() {
    let (problem, estimate) = block();
    // The memory does not suffice even for one factor at a time.
    let between = within(1.05 * estimate.multigrid_bytes);
    let exact = solve(&problem, &Settings::with_method(Method::ActiveSet)).unwrap();
    let mut with_accuracy = between.clone();
    with_accuracy.accuracy = Some(1e-8);
    for settings in [between, with_accuracy] {
        let found = solve(&problem, &settings).unwrap();
        let reason = found.reason.clone();
        assert_eq!((found.method.as_str(), &found.contact_set), ("mprgp", &exact.contact_set));
        assert!(reason.starts_with("by multigrid, of about ") && reason.contains("with a factor"), "{reason}");
        let summary = Summary::new(found.clone(), ModelSize::of(&problem), settings.goal(), 0.0);
        assert_eq!(json!(summary)["reason"], json!(reason));
        assert!(found.certificate.energy_error_bound <= settings.accuracy.unwrap_or(1e-4));
    }
    // Without a near-null space, constants are used.
    let (stiffness, contact) = (problem.stiffness().clone(), problem.contact().clone());
    let raw = ContactProblem::new(stiffness, problem.load().to_vec(), contact, problem.gap().to_vec()).unwrap();
    let raw_estimate = Estimate::of(&raw);
    let found = solve(&raw, &within(1.05 * raw_estimate.multigrid_bytes)).unwrap();
    assert_eq!((found.method.as_str(), found.contact_set), ("mprgp", exact.contact_set));
}

#[test]
fn a_problem_too_large_for_factor_and_multigrid_is_refused_with_both_estimates() {
    let (problem, estimate) = block();
    let refused = solve(&problem, &within(0.5 * estimate.multigrid_bytes)).unwrap_err();
    assert_eq!(refused.code(), "too-large");
    let sentence = refused.to_string();
    let megabytes = |bytes: f64| format!("about {:.0} MB", bytes / 1e6);
    for bytes in [estimate.direct_bytes, estimate.multigrid_bytes] {
        assert!(sentence.contains(&megabytes(bytes)), "{sentence}");
    }
    assert!(sentence.starts_with("the problem does not fit into "), "{sentence}");
    assert!(matches!(refused, Error::NoRoom { allowed, .. } if allowed == 0.5 * estimate.multigrid_bytes));
    let negative = solve(&problem, &within(-1.0)).unwrap_err().to_string();
    assert_eq!(negative, "memory is -1; it must be positive");
    // A requested method is used, or refused with the memory that it needs.
    let mut named = within(0.5 * estimate.multigrid_bytes);
    named.method = Method::ActiveSet;
    assert!(matches!(solve(&problem, &named), Err(Error::TooLarge { .. })));
}

/// Compares `auto`, a `Prepared` without a known number of gaps, and one for many gaps.
#[test]
fn a_preparation_for_many_gaps_chooses_the_factor() {
    let problem = built(&clamped_block(22, -0.01)).problem().clone();
    let by_auto = solve(&problem, &Settings::default()).unwrap();
    assert_eq!(by_auto.method, "mprgp");
    let of = |prepared: Prepared| prepared.solve(problem.gap()).unwrap();
    let once = of(Prepared::for_gaps(&problem, 1, &Settings::default()).unwrap());
    let many = of(Prepared::for_gaps(&problem, 1000, &Settings::default()).unwrap());
    let unknown = of(Prepared::new(&problem, &Settings::default()).unwrap());
    assert_eq!([once.method.as_str(), &many.method, &unknown.method], ["mprgp", "active-set", "active-set"]);
    assert_eq!([&once.contact_set, &many.contact_set], [&by_auto.contact_set; 2]);
}

/// GOAL: bodies with a slow smoother, and slender bodies with a small factor, use the direct path.
///
/// CONDITIONS: beams of quadratic bricks, and of linear ones with about as many unknowns, clamped at one end; a cube of
/// linear bricks. The measured times behind the choice: 0.135 s and 0.173 s, 0.20 s and 0.12 s, 0.18 s and 0.08 s.
#[test]
fn quadratic_and_slender_bodies_prefer_the_factor() {
    let beam = |length: usize, width: usize, element: &str| -> Value {
        let side = |cells: usize| json!({"points": [0, cells as f64 / length as f64], "divisions": [cells]});
        let mut scene = clamped_block(2, -0.01);
        scene["body"]["box"] = json!({"x": side(length), "y": side(width), "z": side(width), "element": element});
        scene["supports"][0]["on"]["boundary"] = json!(if length > width { "left" } else { "bottom" });
        scene
    };
    let prefers_multigrid = |length: usize, width: usize, element: &str| {
        Estimate::of(built(&beam(length, width, element)).problem()).prefers_multigrid(f64::INFINITY)
    };
    assert!(!prefers_multigrid(40, 4, "hex20"));
    assert!(prefers_multigrid(64, 8, "hex8"));
    assert!(prefers_multigrid(16, 16, "hex8"));
    assert!(!prefers_multigrid(8, 8, "hex20"));
}
