//! GOAL: in every step of a motion, the support reactions balance the other forces and the inertia, including supported
//! dofs.
//!
//! CONDITIONS: a block with rollers and contact rows on supported dofs; a bar with a clamp.
//!
//! REFERENCE: the momentum of the whole body with the mass of all nodes, supported or free; the static answer; a bar
//! that is clamped at one end and suddenly pulled at the other, whose clamp carries twice the force (K. F. Graff, *Wave
//! Motion in Elastic Solids*, Oxford, 1975, section 2.4).

use std::fs;
use std::sync::Arc;
use support::scenes::built;

use serde_json::{Value, json};
use signorini::fem::{DofMap, MassForm, add_body_force, add_traction, mass};
use signorini::motion::{Integrator, Scheme, State};
use signorini::scene::{Answer, Dynamics, Resultant};
use signorini::{Model, Scene, Settings, SymmetricMatrix, solve_qp};
use support::program::Desk;

/// Rounding of a balance relative to its largest term: the solve of a step has an error below 1e-13 at each of 35
/// nodes.
const BALANCED: f64 = 1e-11;

/// A motion that starts at the static answer stays there up to the error of the solves.
const AT_REST: f64 = 1e-10;

/// Central differences in steps of one cell solve the wave equation exactly, up to the rounding of sums over 400 steps.
const EXACT: f64 = 1e-11;

/// Error of the mean over the middle of a plateau; the wave front is smeared over some cells and oscillates behind.
const SMEARED: f64 = 2e-3;

/// A block that slides along its left side, with a corner on an inclined roller, above an inclined plane: contact rows
/// act on supported dofs. The weight varies as a sine; the traction acts on both upper corners.
fn block() -> Value {
    let divisions = |length: f64, cells: usize| json!({"points": [0, length], "divisions": [cells]});
    json!({
        "model": "plane-strain",
        "body": {"rectangle": {"x": divisions(1.0, 6), "y": divisions(0.6, 4)}},
        "material": {"young": 1000, "poisson": 0.3, "density": 1},
        "supports": [
            {"on": {"boundary": "left"}, "x": 0.001},
            {"on": {"point": [1, 0.6]}, "normal": [2, 1], "value": 0.0005}
        ],
        "loads": [{"body-force": [5, -20]}, {"traction": {"boundary": "top", "value": [1, -3]}}],
        "obstacles": [{
            "boundary": "bottom", "approach": "-y", "rule": "closest-point",
            "shape": {"plane": {"point": [0, -0.001], "normal": [-0.02, -1]}}
        }],
        "analysis": {"dynamic": {"duration": 1}}
    })
}

/// The factor of the weight over time.
fn factor(t: f64) -> f64 {
    (std::f64::consts::TAU * 3.0 * t + 0.4).sin()
}

fn parts(scene: &Value) -> (Model, Dynamics) {
    let scene = Scene::from_json(&scene.to_string(), "scene").unwrap();
    let model = scene.build().unwrap();
    let dynamics = scene.dynamics(&model).unwrap().unwrap();
    (model, dynamics)
}

fn integrator(dynamics: &Dynamics) -> Integrator {
    Integrator::new(dynamics.problem.clone(), dynamics.scheme, dynamics.step, &Settings::default()).unwrap()
}

/// The mass of all nodal dofs, as if there were no supports.
fn whole_mass(model: &Model, form: MassForm) -> SymmetricMatrix {
    let all = DofMap::new(vec![None; model.dofs().nodal_count()]).unwrap();
    let contact: Vec<usize> = model.rows().iter().map(|row| row.node).collect();
    mass(model.body(), &all, form, &contact).unwrap()
}

/// The sum along each axis of the plane of a nodal vector, and its moment about the origin.
fn sums(model: &Model, nodal: &[f64]) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for (of_node, at) in nodal.chunks(2).zip(model.mesh().nodes()) {
        let terms = [of_node[0], of_node[1], at[0] * of_node[1] - at[1] * of_node[0]];
        sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
    }
    sums
}

/// The quantities in the balance of a scheme: acceleration, velocity, factor of the weight.
fn taken(scheme: Scheme, step: f64, [before, after]: [&State; 2]) -> (Vec<f64>, Vec<f64>, f64) {
    let mix = |a: &[f64], b: &[f64], share: f64| -> Vec<f64> {
        a.iter().zip(b).map(|(a, b)| (1.0 - share) * a + share * b).collect()
    };
    let mean_rate = || before.velocity.iter().zip(&after.velocity).map(|(a, b)| (b - a) / step).collect::<Vec<f64>>();
    let [from, to] = [before, after].map(|state| state.steps as f64 * step);
    // The damping of central differences uses the velocity half a step earlier.
    let half = |state: &State| shifted(state, if state.steps == 0 { 0.0 } else { -step / 2.0 });
    match scheme {
        Scheme::FoxGoodwin => {
            let share = if before.steps == 0 { 2.0 } else { 1.0 };
            let rate = mean_rate().iter().map(|rate| share * rate).collect();
            let velocity =
                if before.steps == 0 { after.velocity.clone() } else { mix(&before.velocity, &after.velocity, 0.5) };
            (rate, velocity, factor(from))
        }
        Scheme::Midpoint | Scheme::ContactStabilised => {
            (mean_rate(), mix(&before.velocity, &after.velocity, 0.5), factor((from + to) / 2.0))
        }
        Scheme::CentralDifference { .. } => {
            (mean_rate(), mix(&half(before), &half(after), 0.5), (factor(from) + factor(to)) / 2.0)
        }
        Scheme::Hht { alpha } => (
            after.acceleration.clone(),
            mix(&before.velocity, &after.velocity, 1.0 + alpha),
            (1.0 + alpha) * factor(to) - alpha * factor(from),
        ),
        _ => (after.acceleration.clone(), after.velocity.clone(), factor(to)),
    }
}

/// The velocity of a state plus `time` times its acceleration.
fn shifted(state: &State, time: f64) -> Vec<f64> {
    state.velocity.iter().zip(&state.acceleration).map(|(v, a)| v + time * a).collect()
}

/// The largest imbalance of 60 steps relative to the largest force, the number of steps with contact on a supported
/// dof, and the largest reaction.
fn imbalance(scene: &Value, form: MassForm, drag: f64) -> (f64, usize, f64) {
    let (model, dynamics) = parts(scene);
    let mut integrator = integrator(&dynamics);
    let mass = whole_mass(&model, form);
    let (mut weight, mut traction) = (vec![0.0; mass.dim()], vec![0.0; mass.dim()]);
    add_body_force(model.body(), [5.0, -20.0, 0.0], &mut weight);
    add_traction(model.body(), model.mesh().boundary("top").unwrap(), [1.0, -3.0, 0.0], &mut traction);
    let momentum = |of: &[f64]| sums(&model, &mass.mul(&model.dofs().expand_motion(of).unwrap()));
    let (mut worst, mut scale, mut touching, mut largest) = (0.0_f64, 0.0_f64, 0, 0.0_f64);
    let corner = model.rows().iter().position(|row| row.node == 0);
    for _ in 0..60 {
        let before = integrator.state().clone();
        let after = integrator.advance().unwrap().clone();
        let all = dynamics.resultants(&model, &integrator).unwrap();
        let (acceleration, velocity, factor) = taken(dynamics.scheme, dynamics.step, [&before, &after]);
        let [rate, lost] = [momentum(&acceleration), momentum(&velocity)];
        let [weight, traction] = [sums(&model, &weight), sums(&model, &traction)];
        let part = |of: &Resultant, axis: usize| if axis < 2 { of.force[axis] } else { of.moment[0] };
        for axis in 0..3 {
            let forces: f64 = all.iter().map(|of| part(of, axis)).sum();
            let off = forces + factor * weight[axis] + traction[axis] - drag * lost[axis] - rate[axis];
            worst = worst.max(off.abs());
            scale = all.iter().map(|of| part(of, axis).abs()).fold(scale.max(rate[axis].abs()), f64::max);
            let supports = all.iter().filter(|of| of.of.starts_with("supports"));
            largest = supports.map(|of| part(of, axis).abs()).fold(largest, f64::max);
        }
        touching += usize::from(corner.is_some_and(|corner| after.multiplier[corner] < 0.0));
    }
    (worst / scale, touching, largest)
}

#[test]
fn reactions_contact_forces_and_loads_sum_to_the_change_of_momentum_at_every_step() {
    let forms = [
        ("consistent", MassForm::Consistent),
        ("lumped", MassForm::Lumped),
        ("redistributed", MassForm::Redistributed),
    ];
    for scheme in [
        "fox-goodwin",
        "midpoint",
        "contact-stabilised",
        "hht",
        "trapezoidal",
        "penalty",
        "penalty-loop",
        "central-difference",
    ] {
        for (name, form) in forms {
            let fits = match scheme {
                "midpoint" => true,
                "central-difference" => form == MassForm::Lumped,
                _ => form != MassForm::Redistributed,
            };
            // The midpoint rule allows mass on contact nodes only without contact.
            let alone = scheme == "midpoint" && form != MassForm::Redistributed;
            for (drag, viscous) in [(0.0, 0.0), (2.0, 1e-4)].into_iter().filter(|_| fits) {
                let mut scene = block();
                let dynamic = &mut scene["analysis"]["dynamic"];
                dynamic["scheme"] = json!(scheme);
                dynamic["mass"] = json!(name);
                dynamic["damping"] = json!({"mass": drag, "stiffness": viscous});
                let swing = json!({"sine": {"frequency": 3, "phase": 0.4}});
                dynamic["loads-in-time"] = json!([{"load": 0, "factor": swing}]);
                if alone {
                    scene["obstacles"] = json!([]);
                }
                let (off, touching, largest) = imbalance(&scene, form, drag);
                println!(
                    "{scheme}, {name}, {drag}, {viscous}: {off:.1e}, {touching} steps touch, reactions {largest:.1}"
                );
                assert!(off < BALANCED && largest > 1.0, "{scheme}, {name}, {drag}: {off:e} of {largest}");
                assert!(alone || touching > 5, "{scheme}, {name}: {touching}");
            }
        }
    }
}

#[test]
fn a_motion_from_the_static_answer_has_its_reactions() {
    let mut still = block();
    still.as_object_mut().unwrap().remove("analysis");
    let still = built(&still);
    let answer = solve_qp(still.problem()).unwrap();
    let reactions = still.reactions(&answer.displacement, &answer.multiplier).unwrap();
    let total = sums(&still, &reactions);
    assert!(answer.contact_force() > 1.0 && total[0].abs() > 1.0, "{total:?} {answer:?}");
    for scheme in ["fox-goodwin", "midpoint", "contact-stabilised", "hht", "trapezoidal", "central-difference"] {
        let mut scene = block();
        scene["analysis"]["dynamic"]["scheme"] = json!(scheme);
        let (model, mut dynamics) = parts(&scene);
        let rest = vec![0.0; answer.displacement.len()];
        dynamics.problem = dynamics.problem.starting_from(answer.displacement.clone(), rest).unwrap();
        let mut integrator = integrator(&dynamics);
        assert_eq!(
            dynamics.resultants(&model, &integrator).unwrap().len(),
            1,
            "there are reactions before the first step"
        );
        for _ in 0..5 {
            integrator.advance().unwrap();
        }
        let all = dynamics.resultants(&model, &integrator).unwrap();
        let expected = resultants(&still, &answer.displacement, &answer.multiplier);
        for (found, expected) in all.iter().zip(&expected) {
            assert_eq!((&found.of, found.nodes), (&expected.of, expected.nodes));
            let values = |of: &Resultant| [of.force.clone(), of.moment.clone(), of.centre.clone().unwrap()].concat();
            let off = values(found).iter().zip(values(expected)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            println!("{scheme}, {}: {off:.1e} of {:?}", found.of, expected.force);
            assert!(off < AT_REST, "{scheme}: {found:?}, expected {expected:?}");
        }
        assert_eq!(all.len(), 3);
    }
}

/// The resultants of a static answer, without the loads.
fn resultants(model: &Model, displacement: &[f64], multiplier: &[f64]) -> Vec<Resultant> {
    let closed = multiplier.iter().map(|&lambda| lambda < 0.0).collect();
    let answer = Answer::new(Arc::new(model.clone()), displacement, multiplier, &closed).unwrap();
    answer.resultants().unwrap().iter().filter(|of| of.of != "loads").cloned().collect()
}

/// A bar of 100 cells, clamped at the left; from the start a force of 3 pulls its right end. A wave takes 1/2 through
/// it.
fn pulled(scheme: &str, step: f64) -> Value {
    json!({
        "model": "bar",
        "body": {"bar": {"x": {"points": [0, 10], "divisions": [100]}}},
        "material": {"young": 800, "poisson": 0, "density": 2},
        "supports": [{"on": {"boundary": "left"}, "x": 0}],
        "loads": [{"force": {"at": [10], "value": [3]}}],
        "analysis": {"dynamic": {"scheme": scheme, "step": step, "duration": 2, "frames": 4}}
    })
}

#[test]
fn the_clamp_of_a_suddenly_pulled_bar_carries_twice_the_force_until_the_wave_returns() {
    let cell = 0.1 / 20.0;
    for (scheme, step, margin, tolerance) in [
        ("central-difference", cell, cell, EXACT),
        ("fox-goodwin", cell, cell, EXACT),
        ("midpoint", cell / 4.0, 0.1, SMEARED),
        ("hht", cell / 4.0, 0.1, SMEARED),
    ] {
        let (model, dynamics) = parts(&pulled(scheme, step));
        let mut integrator = integrator(&dynamics);
        // Reactions before 1/2, until 3/2, and after that: their sum, their number, and the largest error.
        let mut plateaus = [(0.0, 0.0, 0.0_f64); 3];
        for _ in 0..dynamics.steps {
            integrator.advance().unwrap();
            let force = dynamics.resultants(&model, &integrator).unwrap()[0].force[0];
            let middle = integrator.time() - step / 2.0;
            let plateau = usize::from(middle > 0.5) + usize::from(middle > 1.5);
            if [0.5, 1.5].iter().all(|front| (middle - front).abs() > margin) {
                let (sum, count, farthest) = &mut plateaus[plateau];
                (*sum, *count) = (*sum + force, *count + 1.0);
                *farthest = farthest.max((force - [0.0, -6.0, 0.0][plateau]).abs());
            }
        }
        for ((sum, count, farthest), exact) in plateaus.into_iter().zip([0.0, -6.0, 0.0]) {
            println!("{scheme}: mean {:.6} of {count} steps for {exact}, farthest {farthest:.1e}", sum / count);
            assert!(
                count > 50.0 && (sum / count - exact).abs() < 6.0 * tolerance,
                "{scheme}: {}, expected {exact}",
                sum / count
            );
            assert!(scheme != "central-difference" || farthest < 6.0 * EXACT, "{farthest:e}");
        }
    }
}

#[test]
fn the_table_of_resultants_contains_the_supports_and_is_resumed_bit_for_bit() {
    let mut scene = block();
    scene["loads"][0] = json!({"body-force": [5, -20]});
    scene["analysis"]["dynamic"] = json!({
        "duration": 0.6, "frames": 6, "damping": {"mass": 0.5, "stiffness": 1e-4},
        "loads-in-time": [{"load": 0, "factor": {"ramp": {"end": 0.1}}}]
    });
    let desk = Desk::new();
    desk.write("long.json", scene.to_string());
    scene["analysis"]["dynamic"]["duration"] = json!(0.3);
    scene["analysis"]["dynamic"]["frames"] = json!(3);
    desk.write("short.json", scene.to_string());
    desk.run(&["solve", "long.json", "--out", "whole", "--pictures", "none"]).ends_with(0);
    desk.run(&["solve", "short.json", "--out", "parts", "--pictures", "none"]).ends_with(0);
    desk.run(&["solve", "long.json", "--out", "parts", "--resume", "--pictures", "none"]).ends_with(0);
    let [whole, parts] =
        ["whole", "parts"].map(|run| fs::read_to_string(desk.path(&format!("{run}/resultants.csv"))).unwrap());
    assert!(whole == parts, "resultants.csv differs after the resumption");
    let mut lines = whole.lines();
    let columns = ["obstacles[0]", "supports[0]", "supports[1]"]
        .map(|name| ["f_x", "f_y", "m_z", "c_x", "c_y"].map(|of| format!("{name} {of}")));
    assert_eq!(lines.next().unwrap(), format!("time,{}", columns.concat().join(",")));
    // No step leads to the first line, so that it has no support reactions.
    assert_eq!(lines.next(), Some("0e0,0e0,0e0,0e0,,,,,,,,,,,,"));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert!(rows.len() > 100 && rows.iter().all(|row| row.len() == 16));
    let force = |row: &[&str], column: usize| row[column].parse::<f64>().unwrap();
    // The forces of the rollers have the direction of their normals and act at the supports: the left side, and the
    // corner.
    for row in &rows {
        assert_eq!(force(row, 7), 0.0, "{row:?}");
        assert!((force(row, 11) - 2.0 * force(row, 12)).abs() < BALANCED * force(row, 11).abs(), "{row:?}");
        assert!(force(row, 9).abs() < BALANCED && (force(row, 14) - 1.0).abs() < BALANCED, "{row:?}");
    }
}
