//! A watch: if another thread asks to stop, every computation ends and returns what it has.

use serde_json::{Value, json};
use signorini::motion::Integrator;
use signorini::qp::{Error, LinearError};
use signorini::study::{MotionTradeoff, Sweep, Tradeoff, TradeoffGrid, compare};
use signorini::{Condense, InteriorPoint, Method, Prepared, Scene, Settings, Watch, solve};
use support::endings::best;
use support::program::scene;
use support::scenes::built;

/// A block of `cells` x `cells` cells under a parabola.
fn block(cells: usize) -> Value {
    let mut block = scene();
    for axis in ["x", "y"] {
        block["body"]["rectangle"][axis]["divisions"] = json!([cells]);
    }
    block
}

/// A watch that stops the work when a given iteration or part of a step begins.
fn stopping_at(step: &'static str, number: usize) -> Watch {
    Watch::observed(move |watch| {
        let now = watch.activity();
        let part = now.part.filter(|part| part.name == step).map_or(0, |part| part.number);
        if (now.step == step && now.iteration == number) || part == number {
            watch.stop();
        }
    })
}

#[test]
fn clones_share_the_request_and_the_activity_but_not_the_deadline() {
    let watch = Watch::default();
    let (clone, limited) = (watch.clone(), watch.within(0.0));
    assert!(limited.is_over() && !watch.is_over() && watch.time_left().is_none());
    // The earlier deadline counts.
    assert!(limited.within(1e3).is_over() && watch.within(1e3).time_left().unwrap() > 1.0);
    // No clock can represent this time; there is no deadline then.
    assert!(watch.within(f64::MAX).time_left().is_none());
    clone.part("gap", 2, 3);
    limited.step("factorisation", 1);
    let activity = watch.activity();
    assert_eq!((activity.step, activity.iteration), ("factorisation", 1));
    assert_eq!(activity.part.unwrap().to_string(), "gap 2 of 3");
    limited.stop();
    // Another thread that asks, such as a line of progress, is not the work that notices the request.
    assert!(watch.is_stopped() && !watch.is_noticed());
    assert!(clone.is_over() && watch.is_noticed() && watch.within(1e3).is_stopped());
}

#[test]
fn work_that_is_stopped_before_it_begins_is_interrupted_by_every_method() {
    let model = built(&block(8));
    for method in [Method::Auto, Method::qp(), Method::ActiveSet, Method::penalty(), Method::Mprgp] {
        let settings = Settings::with_method(method);
        settings.watch.stop();
        assert!(matches!(solve(model.problem(), &settings), Err(Error::Interrupted)), "{method:?}");
        assert!(matches!(Prepared::new(model.problem(), &settings), Err(Error::Interrupted)));
        assert!(settings.watch.is_noticed());
        assert!(matches!(compare(model.problem(), &settings), Err(signorini::Error::Qp(Error::Interrupted))));
        assert!(matches!(
            Sweep::over_gaps(&model, &Sweep::even_gaps(0.0, -0.01, 3), &settings),
            Err(signorini::Error::Qp(Error::Interrupted))
        ));
    }
    let settings = Settings::default();
    settings.watch.stop();
    let scene = Scene::from_json(&scene().to_string(), "scene").unwrap();
    assert!(matches!(
        Tradeoff::of_scene(&scene, &TradeoffGrid::default(), &settings.watch),
        Err(signorini::Error::Qp(Error::Interrupted))
    ));
}

#[test]
fn a_stopped_loop_returns_its_iterations_so_far_with_a_bound() {
    let model = built(&block(60));
    // On all dofs every iteration needs a factorisation.
    let prepared = Prepared::new(model.problem(), &Settings::default().with_condensation(Condense::Never)).unwrap();
    let solved = |settings: &Settings| prepared.with_settings(settings).unwrap().solve(model.problem().gap());
    let mut settings = Settings::with_method(Method::penalty());
    let whole = best(solved(&settings));
    settings.watch = stopping_at("penalty loop", 3);
    let Err(Error::NotCertified { solution, .. }) = solved(&settings) else { panic!("the loop was not stopped") };
    let iterations = solution.iterations;
    assert!((3..whole.iterations).contains(&iterations), "{iterations} of {}", whole.iterations);
    assert_eq!(solution.history, whole.history[..iterations]);
    // The answer is not final, but its error has a bound.
    let bound = solution.certificate.energy_error_bound;
    assert!(bound.is_finite() && bound > whole.certificate.energy_error_bound, "{bound}");

    for method in [Method::ActiveSet, Method::penalty()] {
        let settings = Settings::with_method(method);
        settings.watch.stop();
        let Err(Error::NotCertified { solution, .. }) = solved(&settings) else { panic!("{method:?}") };
        assert_eq!(solution.iterations, 1, "{method:?}");
    }
}

#[test]
fn interior_point_and_multigrid_end_early_on_request() {
    let model = built(&block(40));
    let prepared = Prepared::new(model.problem(), &Settings::default().with_condensation(Condense::Never)).unwrap();
    let solved = |settings: &Settings| prepared.with_settings(settings).unwrap().solve(model.problem().gap());
    let unpolished = InteriorPoint { polish: false, ..InteriorPoint::default() };
    let mut settings = Settings::with_method(Method::Qp(unpolished));
    let whole = best(solved(&settings));
    settings.watch = stopping_at("interior point", 2);
    let Err(Error::NotCertified { solution, .. }) = solved(&settings) else { panic!("the solve was not stopped") };
    assert!(solution.iterations < whole.iterations, "{} of {}", solution.iterations, whole.iterations);

    let settings = Settings::with_method(Method::Mprgp);
    let prepared = Prepared::new(model.problem(), &settings).unwrap();
    settings.watch.stop();
    let Err(Error::NotCertified { solution, .. }) = prepared.solve(model.problem().gap()) else { panic!() };
    assert_eq!((solution.iterations, solution.displacement.len()), (0, model.problem().dofs()));
}

#[test]
fn a_stopped_sweep_returns_the_gaps_solved_so_far() {
    let model = built(&block(20));
    let gaps = Sweep::even_gaps(0.0, -0.05, 400);
    let whole = Sweep::over_gaps(&model, &gaps, &Settings::default()).unwrap();
    assert!(whole.points.len() == gaps.len() && !whole.events.is_empty());
    let mut settings = Settings::default();
    settings.watch = stopping_at("gap", 5);
    let part = Sweep::over_gaps(&model, &gaps, &settings).unwrap();
    assert!((4..gaps.len()).contains(&part.points.len()), "{}", part.points.len());
    assert!(part.events.is_empty() && part.corners.is_empty());
    for (point, expected) in part.points.iter().zip(&whole.points) {
        assert!(point.gap == expected.gap && point.summary.is_certified());
        assert_eq!(point.summary.solution.multiplier, expected.summary.solution.multiplier);
    }
}

#[test]
fn a_stopped_tradeoff_returns_the_points_measured_so_far() {
    let scene = Scene::from_json(&block(20).to_string(), "scene").unwrap();
    let watch = stopping_at("run", 4);
    let grid = TradeoffGrid { refinements: 0, runs: 1, ..TradeoffGrid::default() };
    let measured = Tradeoff::of_scene(&scene, &grid, &watch).unwrap();
    let whole = Tradeoff::of_scene(&scene, &grid, &Watch::default()).unwrap();
    assert!((3..whole.points.len()).contains(&measured.points.len()), "{}", measured.points.len());
    for (point, expected) in measured.points.iter().zip(&whole.points) {
        assert_eq!(
            (point.method, point.knob, point.energy_error),
            (expected.method, expected.knob, expected.energy_error)
        );
    }
}

/// A bar that flies against a wall, in 240 steps.
fn bar() -> Scene {
    let scene = json!({
        "model": "bar",
        "body": {"bar": {"x": {"points": [0, 10], "divisions": [20]}}},
        "material": {"young": 900, "poisson": 0, "density": 1},
        "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [15], "normal": [1]}}}],
        "analysis": {"dynamic": {"duration": 2, "initial": [{"velocity": {"value": [10]}}]}}
    });
    Scene::from_json(&scene.to_string(), "scene").unwrap()
}

#[test]
fn a_stopped_motion_keeps_its_last_complete_step_and_resumes_bit_for_bit() {
    let scene = bar();
    let model = scene.build().unwrap();
    let dynamics = scene.dynamics(&model).unwrap().unwrap();
    let begun = |settings: &Settings| {
        Integrator::new(dynamics.problem.clone(), dynamics.scheme, dynamics.step, settings).unwrap()
    };
    let settings = Settings::default();
    let (mut whole, mut stopped) = (begun(&Settings::default()), begun(&settings));
    for _ in 0..150 {
        whole.advance().unwrap();
        stopped.advance().unwrap();
    }
    settings.watch.stop();
    assert!(matches!(stopped.advance(), Err(Error::Interrupted)));
    assert_eq!(stopped.state(), whole.state());
    let mut resumed = begun(&Settings::default());
    resumed.resume(stopped.state().clone()).unwrap();
    for _ in 0..30 {
        whole.advance().unwrap();
        resumed.advance().unwrap();
    }
    assert_eq!(resumed.state(), whole.state());

    assert!(matches!(MotionTradeoff::of(&scene, &settings), Err(signorini::Error::Qp(Error::Interrupted))));
    // On a slow machine the time may be over before the preparation is complete.
    let limited = |seconds: f64| {
        let mut settings = Settings::default();
        settings.watch = Watch::default().within(seconds);
        Some((Integrator::new(dynamics.problem.clone(), dynamics.scheme, dynamics.step, &settings).ok()?, settings))
    };
    let (mut limited, settings) = (-3..).find_map(|power| limited(2.0_f64.powi(power))).unwrap();
    while settings.watch.time_left() != Some(0.0) {
        std::thread::yield_now();
    }
    assert!(matches!(limited.advance(), Err(Error::Interrupted)));
    assert_eq!(limited.state().steps, 0);
}

#[test]
fn memory_that_does_not_suffice_is_refused_before_a_factorisation() {
    let model = built(&block(20));
    for (method, condense) in [
        (Method::ActiveSet, Condense::Auto),
        (Method::ActiveSet, Condense::Never),
        (Method::penalty(), Condense::Auto),
        (Method::Mprgp, Condense::Auto),
    ] {
        let mut settings = Settings::with_method(method);
        settings.condense = condense;
        settings.memory = Some(1e9);
        assert!(!matches!(solve(model.problem(), &settings), Err(Error::TooLarge { .. })), "{method:?}");
        settings.memory = Some(1e6);
        match solve(model.problem(), &settings) {
            Err(Error::TooLarge { dofs, bytes, allowed, .. }) => {
                assert!(dofs == model.problem().dofs() as f64 && bytes > allowed && allowed == 1e6);
            }
            other => panic!("{method:?}: {:?}", other.map(|solution| solution.certificate)),
        }
    }
    let mut settings = Settings::default();
    for wrong in [-1.0, f64::NAN] {
        settings.memory = Some(wrong);
        assert!(
            matches!(
                solve(model.problem(), &settings),
                Err(Error::Linear(LinearError::Setting { name: "memory", .. }))
            ),
            "{wrong}"
        );
    }
}
