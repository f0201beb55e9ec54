//! GOAL: hammers, obstacles that move in time, springs and rigid faces in motions.
//!
//! CONDITIONS: bars and blocks under hammers of a given mass or force, beside moving walls, on springs and behind rigid
//! faces.
//!
//! REFERENCE: waves in bars, an oscillator of one dof, and the same motion described in another way.

use serde_json::{Value, json};
use signorini::motion::{Integrator, Observation};
use signorini::study::MotionSummary;
use support::impact::measure::set_up;
use support::program::Desk;

/// Rounding over some hundred steps, relative to the largest force or displacement.
const ROUNDING: f64 = 1e-9;

/// The force of a hammer over the first one, from its second step on 100 cells: the step is a fifth of the time in
/// which it decays, and the error is that of central differences.
const HAMMER: f64 = 0.01;

/// The energy of a damped motion at the start, relative: its first half step is of second order.
const FIRST_STEP: f64 = 1e-4;

/// The impulse of a rigid face, relative: its last step.
const RELEASE: f64 = 0.02;

struct Run {
    seen: Vec<Observation>,
    summary: MotionSummary,
    /// Displacement of all nodes at the end.
    displacement: Vec<f64>,
    peak_window: f64,
}

fn run(scene: &Value) -> Run {
    let (model, dynamics, mut integrator) = set_up(scene).unwrap();
    let mut summary = MotionSummary::starting(&integrator.observe(), 0, dynamics.windows, dynamics.step);
    let mut seen = Vec::new();
    for _ in 0..dynamics.steps {
        integrator.advance().unwrap();
        let now = model.of_whole(integrator.observe());
        summary.add(&now, &[]);
        seen.push(now);
    }
    let displacement = model.nodal_displacement(&integrator.state().displacement).unwrap();
    let peak_window = summary.peak_steps() as f64 * dynamics.step;
    Run { seen, summary, displacement, peak_window }
}

/// A bar of length 10, wave impedance 30 and wave speed 30, in front of a plane.
fn bar(cells: usize, obstacle: Value, dynamic: Value) -> Value {
    let mut plane = json!({"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [10], "normal": [1]}}});
    plane.as_object_mut().unwrap().extend(obstacle.as_object().unwrap().clone());
    json!({
        "model": "bar", "body": {"bar": {"x": {"points": [0, 10], "divisions": [cells]}}},
        "material": {"young": 900, "poisson": 0, "density": 1},
        "obstacles": [plane], "analysis": {"dynamic": dynamic}
    })
}

/// A hammer with a twentieth of the mass of the bar: until the wave is back the force is `30 v exp(-30 t/m)`.
fn hammer(cells: usize, duration: f64) -> Run {
    run(&bar(cells, json!({"mass": 0.5, "speed": 10}), json!({"duration": duration})))
}

#[test]
fn a_light_hammer_presses_as_the_wave_in_the_bar_says() {
    let (first, rate) = (300.0, 60.0);
    for cells in [100, 400] {
        let run = hammer(cells, 0.7);
        for seen in &run.seen[1..] {
            let at = (seen.acting[0] + seen.acting[1]) / 2.0;
            if at < 0.65 {
                let exact = first * (-rate * at).exp();
                assert!((seen.force - exact).abs() <= HAMMER * first, "{cells}, {at}: {} {exact}", seen.force);
            }
        }
        // The peak is the mean over a window, which shrinks with the cells.
        let over = rate * run.peak_window;
        let mean = first * (1.0 - (-over).exp()) / over;
        let peak = run.summary.contact.peak_force();
        assert!((peak / mean - 1.0).abs() <= HAMMER, "{cells}: {peak} {mean}");
        assert!((run.summary.contact.impulse / 5.0 - 1.0).abs() <= 5e-4, "{cells}: {}", run.summary.contact.impulse);
        assert!(run.summary.growth() <= ROUNDING, "{cells}: {}", run.summary.growth());
    }
    // The peak itself, where the window is short beside the time in which the force decays.
    let peak = hammer(5000, 0.01).summary.contact.peak_force();
    assert!((peak / first - 1.0).abs() <= 0.01, "{peak}");
}

/// A hammer that falls by its force F through the gap g hits with the speed `v = sqrt(2 F g/m)`; then the force
/// approaches F: `F - (F - 30 v) exp(-30 t/m)`.
#[test]
fn a_hammer_falls_by_its_force_until_it_hits() {
    let scene = bar(200, json!({"mass": 50, "force": 400, "gap": 1}), json!({"duration": 0.6}));
    let run = run(&scene);
    let (time, speed) = (0.5, 4.0);
    let contact = &run.summary.contact;
    assert!((contact.first.unwrap() / time - 1.0).abs() < 5e-3, "{:?}", contact.first);
    for seen in run.seen.iter().filter(|seen| seen.time > time + 0.01) {
        let at = (seen.acting[0] + seen.acting[1]) / 2.0 - time;
        let exact = 400.0 - (400.0 - 30.0 * speed) * (-0.6 * at).exp();
        assert!((seen.force / exact - 1.0).abs() < 0.01, "{}: {} {exact}", seen.time, seen.force);
    }
    assert!(run.summary.growth() <= ROUNDING);
}

/// The half of a block under the half of a hammer.
#[test]
fn the_part_of_a_block_and_its_hammer_moves_as_the_whole() {
    let block = |is_whole: bool| {
        let (left, cells) = if is_whole { (-1, 8) } else { (0, 4) };
        json!({
            "model": "plane-strain",
            "body": {"rectangle": {"x": {"points": [left, 1], "divisions": [cells]}, "y": {"points": [0, 1], "divisions": [4]}}},
            "material": {"young": 1000, "poisson": 0.3, "density": 1},
            "symmetry": if is_whole { json!([]) } else { json!(["x"]) },
            "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
            "obstacles": [{"boundary": "top", "approach": "+y", "mass": 3, "speed": 2, "gap": 0.01,
                "shape": {"parabola": {"apex": [0, 1], "radius": 3}}}],
            "analysis": {"dynamic": {"duration": 0.3}}
        })
    };
    let (whole, half) = (run(&block(true)), run(&block(false)));
    let most = whole.summary.contact.force_max;
    assert!(most > 1.0);
    for (a, b) in whole.seen.iter().zip(&half.seen) {
        assert!((a.force - b.force).abs() <= ROUNDING * most, "{}: {} {}", a.time, a.force, b.force);
        assert!((a.energy() - b.energy()).abs() <= ROUNDING * whole.summary.energy_scale);
    }
}

/// A wall that moves with a constant velocity hits a bar at rest as a bar with that velocity hits a wall at rest.
#[test]
fn a_wall_that_moves_hits_as_a_bar_that_is_thrown() {
    let thrown = run(&bar(50, json!({"gap": 2}), json!({"duration": 1.5, "initial": [{"velocity": {"value": [10]}}]})));
    let table = json!({"table": {"times": [0, 2], "factors": [0, 20]}});
    let moving = json!({"duration": 1.5, "obstacles-in-time": [{"obstacle": 0, "shift": -1, "factor": table}]});
    let hit = run(&bar(50, json!({"gap": 2}), moving));
    for (a, b) in thrown.seen.iter().zip(&hit.seen) {
        assert!((a.force - b.force).abs() <= ROUNDING * 300.0, "{}: {} {}", a.time, a.force, b.force);
        assert!(b.penetration <= ROUNDING * 10.0);
    }
    // The bar is twice as fast as the wall in the end, by the work of the wall alone: 10 . 20^2/2.
    let last = hit.seen.last().unwrap();
    assert!((last.work / 2000.0 - 1.0).abs() <= ROUNDING, "{}", last.work);
    assert!((last.kinetic + last.strain - last.work).abs() <= ROUNDING * 2000.0, "{last:?}");
    assert!(hit.summary.growth() <= ROUNDING, "{}", hit.summary.growth());
}

/// A shaker lets a bar jump; energy comes from its work alone.
#[test]
fn a_shaker_puts_in_what_the_bar_gets() {
    let mut scene = bar(
        40,
        json!({}),
        json!({"duration": 8, "obstacles-in-time": [{"obstacle": 0, "shift": 0.4, "factor": {"sine": {"frequency": 1}}}]}),
    );
    scene["loads"] = json!([{"body-force": [10]}]);
    let run = run(&scene);
    let contact = &run.summary.contact;
    assert!(contact.impulse > 500.0 && contact.duration < 7.0, "{contact:?}");
    assert!(run.summary.growth() <= ROUNDING, "{}", run.summary.growth());
    assert!(run.summary.penetration_max <= ROUNDING);
}

/// A stiff bar on a soft spring is an oscillator; after half a period it is on the other side.
#[test]
fn a_bar_on_a_spring_is_an_oscillator() {
    let (mass, spring) = (10.0_f64, 0.5_f64);
    // The spring moves the end of an elastic bar: with L k/(E A) = q the frequency is `sqrt(k/m) (1 - q/6)`.
    let q = 10.0 * spring / 9e4;
    let half = std::f64::consts::PI / ((spring / mass).sqrt() * (1.0 - q / 6.0));
    let mut scene =
        bar(20, json!({"gap": 1}), json!({"duration": half, "initial": [{"displacement": {"value": [0.5]}}]}));
    scene["material"]["young"] = json!(9e4);
    scene["springs"] = json!([{"on": {"boundary": "left"}, "x": spring}]);
    let run = run(&scene);
    let [first, last] = [run.displacement[0], *run.displacement.last().unwrap()];
    assert!((first + 0.5).abs() < 1e-3 && (last + 0.5).abs() < 1e-3, "{first} {last}");
    assert!(run.summary.growth() <= ROUNDING);
}

/// A strip that hits a wall, on springs at a support, with a rigid face; without lateral strain nothing bends.
fn strip(rest: Value) -> Value {
    let mut scene = json!({
        "model": "plane-stress",
        "body": {"rectangle": {"x": {"points": [0, 4], "divisions": [16]}, "y": {"points": [0, 1], "divisions": [2]}}},
        "material": {"young": 900, "poisson": 0, "density": 1},
        "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [4.1, 0], "normal": [1, 0]}}}],
        "analysis": {"dynamic": {"duration": 0.6, "initial": [{"velocity": {"value": [5, 0]}}]}}
    });
    scene.as_object_mut().unwrap().extend(rest.as_object().unwrap().clone());
    scene
}

#[test]
fn a_rigid_face_moves_as_the_plane_face_that_it_is() {
    let free = run(&strip(json!({})));
    let rigid = run(&strip(json!({"rigid-faces": [{"boundary": "right"}]})));
    assert!(free.summary.contact.force_max > 100.0);
    for (a, b) in free.seen.iter().zip(&rigid.seen).filter(|pair| pair.0.time < 0.285) {
        assert!((a.force - b.force).abs() <= ROUNDING * 200.0, "{}: {} {}", a.time, a.force, b.force);
        assert!((a.energy() - b.energy()).abs() <= ROUNDING * 50.0);
    }
    // The shares of the rows of a rigid face in its force are not unique, nor is what each gives back at release.
    let [a, b] = [&free, &rigid].map(|run| run.summary.contact.impulse);
    assert!((a / b - 1.0).abs() < RELEASE && rigid.summary.growth() <= ROUNDING, "{a} {b}");
    // A face that cannot move is a support.
    let initial = json!({"dynamic": {"duration": 0.6, "initial": [{"velocity": {"value": [5, 0], "gradient": [[0, 0], [1, 0]]}}]}});
    let held = |rest: Value| {
        let mut scene = strip(rest);
        scene["analysis"] = initial.clone();
        scene["material"]["poisson"] = json!(0.3);
        run(&scene)
    };
    let support = held(json!({"supports": [{"on": {"boundary": "left"}, "x": 0.01, "y": 0}]}));
    let face = held(json!({"rigid-faces": [{"boundary": "left", "x": 0.01, "y": 0, "rotation": {"z": 0}}]}));
    for (a, b) in support.seen.iter().zip(&face.seen) {
        assert!((a.force - b.force).abs() <= ROUNDING * 200.0, "{}: {} {}", a.time, a.force, b.force);
        assert!((a.strain - b.strain).abs() <= ROUNDING * 50.0, "{}: {} {}", a.time, a.strain, b.strain);
    }
}

/// The forces of contact, supports and springs add up to the change of momentum.
#[test]
fn the_forces_of_springs_are_in_the_balance() {
    let scene = strip(json!({
        "supports": [{"on": {"boundary": "left"}, "x": 0}],
        "springs": [{"on": {"boundary": "left"}, "y": 30}, {"on": {"boundary": "top"}, "x": 20, "normal": 10}]
    }));
    let (model, dynamics, mut integrator) = set_up(&scene).unwrap();
    // The mass of all nodes, those at the support included.
    let mut free = scene.clone();
    free.as_object_mut().unwrap().remove("supports");
    let of_free = set_up(&free).unwrap().1.problem;
    let momentum = |integrator: &Integrator| {
        let nodal = of_free.mass().mul(&model.nodal_velocity(&integrator.state().velocity).unwrap());
        [0, 1].map(|axis| nodal.iter().skip(axis).step_by(2).sum::<f64>())
    };
    let mut before = momentum(&integrator);
    for number in 0..dynamics.steps {
        integrator.advance().unwrap();
        let now = momentum(&integrator);
        let of_all = dynamics.resultants(&model, &integrator).unwrap();
        assert_eq!(of_all.len(), 4);
        if number > 0 {
            for axis in 0..2 {
                let force: f64 = of_all.iter().map(|one| one.force[axis]).sum();
                let change = (now[axis] - before[axis]) / dynamics.step;
                assert!((force - change).abs() <= 1e-8 * 200.0, "{number}, {axis}: {force} {change}");
            }
        }
        before = now;
    }
}

/// GOAL: what is lost is split into what damping and what the scheme took.
/// CONDITIONS: a bar that swings freely, damped by its mass, by its stiffness, and by both.
/// REFERENCE: it loses energy by damping alone.
#[test]
fn the_energy_that_damping_takes_is_not_that_of_the_scheme() {
    let swinging = |damping: Value| {
        let initial = json!([{"velocity": {"value": [-30], "gradient": [[6]]}}]);
        run(&bar(40, json!({"gap": 100}), json!({"duration": 2, "damping": damping, "initial": initial})))
    };
    for damping in [json!({"mass": 0.3}), json!({"stiffness": 2e-3}), json!({"mass": 0.2, "stiffness": 1e-3})] {
        let summary = swinging(damping.clone()).summary;
        let [of_damping, of_scheme] =
            [summary.damped, summary.taken_by_scheme()].map(|energy| energy / summary.initial_energy());
        assert!(of_damping > 0.05 && of_scheme.abs() < FIRST_STEP, "{damping}: {of_damping} {of_scheme}");
    }
    // A damping c M leaves `exp(-2 c t)` of the energy of a body that moves as a whole.
    let whole = run(&bar(
        40,
        json!({"gap": 100}),
        json!({"duration": 2, "damping": {"mass": 0.3}, "initial": [{"velocity": {"value": [5]}}]}),
    ));
    let left = 1.0 - whole.summary.damped / whole.summary.initial_energy();
    assert!((left / (-2.0 * 0.3 * 2.0_f64).exp() - 1.0).abs() < 0.02, "{left}");
    // A hammer loses energy to the node that it meets, and not by damping.
    let hit = hammer(100, 0.7).summary;
    assert!(hit.damped == 0.0 && (hit.taken_by_scheme() / hit.initial_energy() - 1.0 / 11.0).abs() < 1e-6);
}

#[test]
fn obstacles_that_cannot_move_so_are_refused() {
    let desk = Desk::new();
    let moving = |rest: Value| {
        let mut of = json!({"obstacle": 0, "shift": -1, "factor": {"ramp": {"end": 1}}});
        of.as_object_mut().unwrap().extend(rest.as_object().unwrap().clone());
        json!({"duration": 1, "obstacles-in-time": [of]})
    };
    let mut midpoint = moving(json!({}));
    midpoint["scheme"] = json!("midpoint");
    let mut equilibrium = bar(4, json!({"mass": 1}), json!({"duration": 1}));
    equilibrium.as_object_mut().unwrap().remove("analysis");
    let cases = [
        (bar(4, json!({"mass": 0}), json!({"duration": 1})), "obstacles[0].mass"),
        (bar(4, json!({"speed": 1}), json!({"duration": 1})), "only an obstacle with a `mass` has a speed"),
        (bar(4, json!({"force": 1}), json!({"duration": 1})), "needs its `mass`"),
        (equilibrium, "only motions and modes have masses"),
        (bar(4, json!({}), moving(json!({"obstacle": 1}))), "there is no obstacles[1]"),
        (bar(4, json!({"mass": 1}), moving(json!({}))), "by its own inertia"),
        (bar(4, json!({}), midpoint), "take `fox-goodwin`"),
        (
            bar(4, json!({}), moving(json!({"factor": {"ramp": {"start": 1, "end": 0}}}))),
            "obstacles-in-time[0].factor.ramp",
        ),
    ];
    for (scene, said) in cases {
        desk.write("scene.json", scene.to_string());
        let run = desk.run(&["solve", "scene.json"]).ends_with(1);
        assert!(run.stderr.contains(said), "{said}: {}", run.stderr);
    }
}
