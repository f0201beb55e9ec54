//! GOAL: with the default scheme the peak of the contact force converges for every step, and the energy never grows.
//!
//! CONDITIONS: bars that are thrown and dropped, blocks, random motions; steps from 0.3 to 1.5 of the time of a wave
//! through a cell.
//!
//! REFERENCE: waves in bars (`closed_forms::ImpactingBar`); the first force of a block, `rho c v` on its whole side;
//! fine meshes.

use serde_json::json;
use signorini::motion::SchemeSpec;
use signorini::motion::{DynamicProblem, Integrator, Scheme, TimeFunction};
use signorini::study::{MotionError, MotionSummary};
use signorini::{ContactProblem, Scene, Settings, SparseMatrix, SymmetricMatrix};
use support::impact::cases::cases;
use support::impact::measure::{moved, run, scene_of, set_up};
use support::program::Desk;

/// Rounding over 1,800 steps of a bar.
const EXACT: f64 = 1e-9;

/// The contact time, relative: it is found from the forces of its first and last steps.
const CONTACT_TIME: f64 = 1e-6;

/// The peak of a block on 20 and 40 cells, relative.
const PEAK: [f64; 2] = [0.04, 0.02];

/// Growth of the energy, relative to the energy: rounding.
const GROWTH: f64 = 1e-9;

/// The fourth bounce on 100 cells, relative to its time.
const BOUNCE: f64 = 3e-3;

#[test]
fn a_bar_moves_exactly_whatever_step_is_asked_for() {
    let case = &cases()[0];
    let [begin, end] = case.contact;
    for cells in [100, 400] {
        for courant in [0.3, 0.5, 0.9, 1.5] {
            let run = run(case, SchemeSpec::FoxGoodwin, courant, cells).unwrap();
            let two_cells = 2.0 * (end - begin) / (2 * cells) as f64;
            for seen in &run.history[1..] {
                let at = (seen.acting[0] + seen.acting[1]) / 2.0;
                if [begin, end].iter().all(|jump| (at - jump).abs() > two_cells) {
                    let exact = if (begin..end).contains(&at) { case.pressure } else { 0.0 };
                    assert!((seen.force - exact).abs() <= EXACT * case.pressure, "{cells}, {courant}, {at}: {seen:?}");
                }
            }
            assert!((run.impulse / 200.0 - 1.0).abs() <= EXACT, "{cells}: {}", run.impulse);
            assert!((run.duration / (end - begin) - 1.0).abs() <= CONTACT_TIME, "{cells}: {}", run.duration);
            assert!((run.rebound / 10.0 - 1.0).abs() <= EXACT && run.displacement_error <= EXACT, "{cells}");
            assert!(run.energy.iter().all(|energy| (energy - 1.0).abs() <= EXACT), "{cells}: {:?}", run.energy);
            assert!((run.peaks[2] / case.pressure - 1.0).abs() <= EXACT, "{cells}: {:?}", run.peaks);
        }
    }
}

/// A bar of length L that falls on a wall with the velocity v presses with `rho c v + rho g c t` for the time 2 L/c:
/// 300, rising to 500.
#[test]
fn a_falling_bar_presses_as_wave_and_weight_say() {
    for (cells, close) in [(100, 0.03), (400, 0.015)] {
        for courant in [0.3, 1.5] {
            let mut scene = scene_of("falling_bar", cells);
            scene["analysis"]["dynamic"]["courant"] = json!(courant);
            let scene: Scene = serde_json::from_value(scene).unwrap();
            let dynamics = scene.dynamics(&scene.build().unwrap()).unwrap().unwrap();
            let mut integrator =
                Integrator::new(dynamics.problem, dynamics.scheme, dynamics.step, &Settings::default()).unwrap();
            let mut summary = MotionSummary::starting(&integrator.observe(), 0, dynamics.windows, dynamics.step);
            for _ in 0..dynamics.steps {
                integrator.advance().unwrap();
                let seen = integrator.observe();
                let at = (seen.acting[0] + seen.acting[1]) / 2.0 - 1.0;
                // Farther from both jumps than two cells.
                let (two_cells, end) = (20.0 / (30.0 * cells as f64), 2.0 / 3.0);
                if at.abs() > two_cells && (at - end).abs() > two_cells {
                    let exact = if (0.0..end).contains(&at) { 300.0 + 300.0 * at } else { 0.0 };
                    assert!((seen.force - exact).abs() <= close * 500.0, "{cells}, {courant}, {at}: {}", seen.force);
                }
                summary.add(&seen, &[]);
            }
            let peak = summary.contact.peak_force() / 500.0;
            assert!((peak - 1.0).abs() <= close, "{cells}, {courant}: {peak}");
            assert!((summary.contact.impulse / (800.0 / 3.0) - 1.0).abs() <= 5e-4, "{}", summary.contact.impulse);
            assert!((summary.contact.duration * 1.5 - 1.0).abs() <= 2e-3, "{}", summary.contact.duration);
        }
    }
}

#[test]
fn the_peak_of_a_block_converges_for_every_step() {
    let speed = (900.0_f64 * 0.7 / (1.3 * 0.4)).sqrt();
    for (cells, most) in [20, 40].into_iter().zip(PEAK) {
        for courant in [0.3, 0.5, 0.9, 1.5] {
            let summary = moved(&scene_of("block", cells), SchemeSpec::FoxGoodwin, courant).unwrap().summary;
            let off = summary.contact.peak_force() / (10.0 * speed) - 1.0;
            eprintln!("{cells}, {courant}: {off:.4}, growth {:.1e}", summary.growth());
            assert!(off.abs() <= most, "{cells}, {courant}: {off}");
            assert!(summary.growth() <= GROWTH, "{cells}, {courant}: {}", summary.growth());
        }
    }
}

/// Bodies of a few dofs with random stiffness, mass, loads and obstacles, at random steps; every second one by central
/// differences as well.
#[test]
fn the_energy_of_random_motions_never_grows() {
    let mut state = support::seed(7);
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    for number in 0..support::cases(250, 1000) {
        let dofs = 2 + number % 7;
        // K = F'F, with a free motion in every third body; M is diagonal, or F'F plus a diagonal.
        let mut squares = |diagonal: f64, kept: usize| {
            let factor: Vec<Vec<f64>> = (0..kept).map(|_| (0..dofs).map(|_| 2.0 * random() - 1.0).collect()).collect();
            let entry = |i: usize, j: usize| factor.iter().map(|row| row[i] * row[j]).sum::<f64>();
            let mut entries = Vec::new();
            for i in 0..dofs {
                (0..i).for_each(|j| entries.push((i, j, entry(i, j))));
                entries.push((i, i, entry(i, i) + diagonal));
            }
            SymmetricMatrix::from_lower(SparseMatrix::from_triplets(dofs, dofs, &entries).unwrap()).unwrap()
        };
        let stiffness = squares(0.0, dofs - usize::from(number % 3 == 0));
        let mass = if number % 2 == 0 { squares(0.5, 0) } else { squares(0.3, 2) };
        let rows: Vec<_> = (0..dofs).map(|dof| (dof, dof, if random() < 0.5 { 1.0 } else { -1.0 })).collect();
        let contact = SparseMatrix::from_triplets(dofs, dofs, &rows).unwrap();
        let load: Vec<f64> = (0..dofs).map(|_| if number % 4 == 0 { random() - 0.5 } else { 0.0 }).collect();
        let gap = (0..dofs).map(|_| random()).collect();
        let statics = ContactProblem::new(stiffness, load, contact, gap).unwrap();
        let velocity = (0..dofs).map(|_| 4.0 * random() - 2.0).collect();
        let problem = DynamicProblem::new(statics, mass).unwrap().starting_from(vec![0.0; dofs], velocity).unwrap();
        let shift: Vec<f64> = (0..dofs).map(|_| random() - 0.5).collect();
        let mut runs = vec![(Scheme::FoxGoodwin, 10.0_f64.powf(2.0 * random() - 1.5))];
        if number % 2 == 0 {
            let explicit = Scheme::CentralDifference { restitution: 0.0 };
            runs.push((explicit, (0.1 + 0.89 * random()) * problem.stable_step().unwrap()));
        }
        for (scheme, step) in runs {
            let mut problem = problem.clone();
            if scheme == Scheme::FoxGoodwin && number % 5 == 0 {
                let factor = TimeFunction::Sine { frequency: 0.3 / step * random(), phase: random() };
                problem = problem.with_moving_gaps(factor, shift.clone()).unwrap();
            }
            let mut integrator = Integrator::new(problem, scheme, step, &Settings::default()).unwrap();
            let mut summary = MotionSummary::starting(&integrator.observe(), 0, [step; 2], step);
            for _ in 0..40 {
                integrator.advance().unwrap();
                summary.add(&integrator.observe(), &[]);
            }
            assert!(summary.growth() <= GROWTH, "{scheme:?}, motion {number}, step {step}: {}", summary.growth());
            assert!(summary.penetration_max <= 1e-9, "motion {number}: {}", summary.penetration_max);
        }
    }
}

/// The beginnings of the contacts of a bar of length 10 that falls 2 by a weight of 20 on a wall, with their largest
/// forces.
fn bounces(cells: usize) -> Vec<[f64; 2]> {
    let scene = json!({
        "model": "bar", "body": {"bar": {"x": {"points": [0, 10], "divisions": [cells]}}},
        "material": {"young": 900, "poisson": 0, "density": 1}, "loads": [{"body-force": [20]}],
        "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [12], "normal": [1]}}}],
        "analysis": {"dynamic": {"duration": 6.5, "initial": []}}
    });
    let scene = Scene::from_json(&scene.to_string(), "scene").unwrap();
    let dynamics = scene.dynamics(&scene.build().unwrap()).unwrap().unwrap();
    let mut integrator =
        Integrator::new(dynamics.problem, dynamics.scheme, dynamics.step, &Settings::default()).unwrap();
    let (mut found, mut last): (Vec<[f64; 2]>, f64) = (Vec::new(), -1.0);
    for _ in 0..dynamics.steps {
        integrator.advance().unwrap();
        let seen = integrator.observe();
        let at = (seen.acting[0] + seen.acting[1]) / 2.0;
        if seen.force > 0.0 {
            if at - last > 0.3 {
                found.push([at, 0.0]);
            }
            last = at;
            let most = found.last_mut().unwrap();
            most[1] = most[1].max(seen.force);
        }
    }
    found
}

#[test]
fn a_bouncing_bar_keeps_its_times_and_its_peaks() {
    let (coarse, fine) = (bounces(100), bounces(support::cases(400, 800)));
    assert_eq!((coarse.len(), fine.len()), (4, 4), "{coarse:?}, {fine:?}");
    for (coarse, fine) in coarse.iter().zip(&fine) {
        eprintln!("{coarse:?} {fine:?}");
        assert!((coarse[0] / fine[0] - 1.0).abs() <= 6.0 * BOUNCE, "{coarse:?}, {fine:?}");
        assert!((coarse[1] / fine[1] - 1.0).abs() <= 0.01, "{coarse:?}, {fine:?}");
    }
    assert!((coarse[3][0] / fine[3][0] - 1.0).abs() <= BOUNCE, "{coarse:?}, {fine:?}");
}

#[test]
fn two_more_runs_estimate_the_errors_of_a_motion() {
    let first = 10.0 * (900.0_f64 * 0.7 / (1.3 * 0.4)).sqrt();
    let value = scene_of("block", 10);
    let scene: Scene = serde_json::from_value(value.clone()).unwrap();
    let own = moved(&value, SchemeSpec::FoxGoodwin, 0.5).unwrap();
    let error = MotionError::of(&scene, own.step, &own.summary, &Settings::default()).unwrap();
    let ratio = error.peak_force / (own.summary.contact.peak_force() - first).abs();
    assert!((0.3..3.0).contains(&ratio) && error.resolved, "{ratio}: {error:?}");
    assert!(error.impulse > 0.0 && error.release.is_some_and(|release| release < 2e-3), "{error:?}");
    // Near nu = 0.5 the waves from the sides come in before ten cells show the first force.
    let mut coarse = scene_of("block", 10);
    coarse["material"]["poisson"] = json!(0.47);
    let scene: Scene = serde_json::from_value(coarse.clone()).unwrap();
    let own = moved(&coarse, SchemeSpec::FoxGoodwin, 1.0).unwrap();
    let error = MotionError::of(&scene, own.step, &own.summary, &Settings::default()).unwrap();
    assert!(!error.resolved, "{error:?} of {}", own.summary.contact.peak_force());
}

/// The step of a bar is the time of a wave through a cell: half the step would be the same motion again.
#[test]
fn the_errors_of_a_bar_are_those_of_its_cells_alone() {
    let value = scene_of("bouncing_bar", 20);
    let scene: Scene = serde_json::from_value(value.clone()).unwrap();
    let [own, finer] =
        [20, 40].map(|cells| moved(&scene_of("bouncing_bar", cells), SchemeSpec::FoxGoodwin, 0.5).unwrap());
    assert!((own.step / finer.step - 2.0).abs() < 1e-12, "{} {}", own.step, finer.step);
    let error = MotionError::of(&scene, own.step, &own.summary, &Settings::default()).unwrap();
    let apart = (finer.summary.contact.impulse - own.summary.contact.impulse).abs();
    assert!((error.impulse - apart).abs() <= 1e-12 * own.summary.contact.impulse, "{error:?}, not {apart}");
}

#[test]
fn the_command_prints_the_estimated_errors() {
    let desk = Desk::new();
    desk.write("block.json", scene_of("block", 10).to_string());
    let run = desk.run(&["solve", "block.json", "--refine-in-time", "--format", "json"]).ends_with(0).json();
    let of_peak = &run["contact"]["peak_force"];
    assert!(of_peak["error"].as_f64() > Some(0.0) && of_peak["window"].as_f64() > Some(0.0), "{run}");
    assert_eq!(run["contact"]["estimated_error"]["peak_force"], of_peak["error"]);
    let text = desk.run(&["solve", "block.json", "--refine-in-time"]).ends_with(0).stdout;
    assert!(text.contains("estimated errors: peak force"), "{text}");
    let mut still = scene_of("block", 10);
    still.as_object_mut().unwrap().remove("analysis");
    desk.write("still.json", still.to_string());
    desk.run(&["solve", "still.json", "--refine-in-time"]).fails_with(1, &["no motion to refine"]);
    let plain = desk.run(&["solve", "block.json", "--format", "json"]).ends_with(0).json();
    assert!(plain["contact"]["peak_force"]["error"].is_null() && plain["contact"].get("estimated_error").is_none());
}

/// The bar of period 3: it touches its obstacle from 1 to 2, from 4 to 5, ...
#[test]
fn ten_bounces_of_a_bar_come_when_waves_say() {
    let mut scene = scene_of("bouncing_bar", 100);
    scene["analysis"]["dynamic"]["duration"] = json!(30);
    let (_, dynamics, mut integrator) = set_up(&scene).unwrap();
    for _ in 0..dynamics.steps {
        integrator.advance().unwrap();
        let seen = integrator.observe();
        let at = (seen.acting[0] + seen.acting[1]) / 2.0;
        let exact = if (1.0..2.0).contains(&(at % 3.0)) { 0.5 } else { 0.0 };
        let jump = (at % 3.0 - 1.0).abs().min((at % 3.0 - 2.0).abs());
        assert!(jump < 2.0 / 100.0 || (seen.force - exact).abs() <= EXACT, "{at}: {} {exact}", seen.force);
    }
}
