//! GOAL: contact answers of scenes, compared with closed forms, invariants, other units and stored independent answers.
//!
//! REFERENCE: bar against a wall and contact patch in closed form; `reference/results.json` (cvxpy with Clarabel and
//! OSQP, polished by sparse LU; versions in the file).

use signorini::{Method, Model, Scene, Settings, solve, solve_qp};
use std::path::PathBuf;
use support::bodies::largest;
use support::endings::answer_by;
use support::scenes::built;

use serde_json::{Value, json};
use signorini::study::compare;
use support::closed_forms::{Bar, ContactPatch, Sides};

const EXACT: [Method; 2] = [Method::qp(), Method::ActiveSet];

/// Rounding times the condition number of the stiffness, below 1e4 here; both closed forms must agree to this.
const CLOSED_FORM: f64 = 1e-11;

fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn indentation() -> Value {
    serde_json::from_str(&std::fs::read_to_string(file("examples/indentation.json")).unwrap()).unwrap()
}

#[track_caller]
fn close(found: f64, expected: f64, scale: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() <= tolerance * scale, "{what}: {found:e}, expected {expected:e}");
}

/// A bar of length 2 along x, one row of elements, nu = 0; the wall is at x = 2 + gap.
fn bar(element: &str, loads: Value, gap: f64) -> Value {
    json!({
        "model": "plane-stress",
        "body": {"rectangle": {
            "x": {"points": [0, 0.7, 2], "divisions": [5, 8], "ratios": [1.5, 0.8]},
            "y": {"points": [0, 0.1], "divisions": [1]},
            "element": element,
        }},
        "material": {"young": 1e3, "poisson": 0.0},
        "supports": [{"on": {"boundary": "left"}, "x": 0, "y": 0}],
        "loads": loads,
        "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [2, 0], "normal": [1, 0]}}}],
        "gap": gap,
    })
}

/// GOAL: an elastic bar against a wall.
/// CONDITIONS: a strip in plane stress with nu = 0, under an end force and under a load per length; gaps that close,
/// just close, stay open, and are negative.
/// REFERENCE: `closed_forms::Bar`, exact at the nodes: the wall takes max(0, F - EA g/L) of an end force.
#[test]
fn bar_against_a_wall_is_exact_at_the_nodes() {
    let closed = |gap| Bar { length: 2.0, axial_stiffness: 1e3 * 0.1, gap };
    for element in ["t3", "q4"] {
        // F = 4, or q = 4 per length: the free end would move by 0.08 in both cases. The gaps are negative, larger than
        // 0.08, and exactly 0.08.
        for gap in [0.03, 0.5, 0.08, -0.01] {
            let end_force = json!([{"traction": {"boundary": "right", "value": [4.0 / 0.1, 0]}}]);
            let distributed = json!([{"body-force": [4.0 / 0.1, 0]}]);
            // Triangles distribute a line load unevenly between the two rows of nodes, so that they are not exact at
            // the nodes.
            let cases = [(end_force, true), (distributed, false)];
            for (loads, by_end) in cases.into_iter().filter(|case| case.1 || element == "q4") {
                let model = built(&bar(element, loads, gap));
                let closed = closed(gap);
                let reaction =
                    if by_end { closed.reaction_to_end_force(4.0) } else { closed.reaction_to_distributed_load(4.0) };
                for method in EXACT {
                    let solution = solve(model.problem(), &Settings::with_method(method)).unwrap();
                    let what = format!("{element}, gap {gap}, end force {by_end}, {method:?}");
                    close(solution.contact_force(), reaction, 4.0, CLOSED_FORM, &format!("{what}: R"));
                    let nodal = model.nodal_displacement(&solution.displacement).unwrap();
                    for (node, &[x, ..]) in model.mesh().nodes().iter().enumerate() {
                        let u = if by_end {
                            closed.displacement_under_end_force(4.0, x)
                        } else {
                            closed.displacement_under_distributed_load(4.0, x)
                        };
                        close(nodal[2 * node], u, 0.08, CLOSED_FORM, &format!("{what}: u({x})"));
                    }
                }
            }
        }
    }
}

/// A block of 1 x 0.8, pressed by p onto the plane below it, with one corner guided, on a graded mesh.
fn patch(element: &str, state: &str, loads: Value, supports: Value, gap: f64) -> Value {
    json!({
        "model": state,
        "body": {"rectangle": {
            "x": {"points": [0, 0.3, 1], "divisions": [3, 4], "ratios": [2.0, 0.7]},
            "y": {"points": [0, 0.8], "divisions": [5], "ratios": [0.4]},
            "element": element,
        }},
        "material": {"young": 2e5, "poisson": 0.3},
        "supports": supports,
        "loads": loads,
        "obstacles": [{"boundary": "bottom", "approach": "-y", "shape": {"plane": {"point": [0, 0], "normal": [0, -1]}}}],
        "gap": gap,
    })
}

/// GOAL: the contact patch test.
/// CONDITIONS: a block on a plane under a uniform load, graded meshes of T3 and Q4, plane strain and plane stress;
/// every exact method.
/// REFERENCE: `closed_forms::ContactPatch`: a uniform pressure, and the strains -p/E' and across it.
#[test]
fn uniform_pressure_on_a_plane_is_exact_on_every_mesh() {
    let p = 3e2;
    for element in ["t3", "q4"] {
        for (state, sides) in [("plane-strain", Sides::PlaneStrain), ("plane-stress", Sides::PlaneStress)] {
            let closed = ContactPatch { young: 2e5, poisson: 0.3, sides };
            let (eps_xx, eps_yy) = closed.strains(p);
            let loads = json!([{"traction": {"boundary": "top", "value": [0, -p]}}]);
            let model = built(&patch(element, state, loads, json!([{"on": {"boundary": "left"}, "x": 0}]), 0.0));
            for method in EXACT {
                let solution = solve(model.problem(), &Settings::with_method(method)).unwrap();
                let what = format!("{element}, {state}, {method:?}");
                for pressure in model.pressure(&solution.multiplier).unwrap() {
                    close(pressure, p, p, CLOSED_FORM, &format!("{what}: pressure"));
                }
                let nodal = model.nodal_displacement(&solution.displacement).unwrap();
                for (node, &[x, y, _]) in model.mesh().nodes().iter().enumerate() {
                    close(nodal[2 * node], eps_xx * x, eps_yy.abs(), CLOSED_FORM, &format!("{what}: u_x"));
                    close(nodal[2 * node + 1], eps_yy * y, eps_yy.abs(), CLOSED_FORM, &format!("{what}: u_y"));
                }
                for stress in model.stress(&solution.displacement).unwrap().nodes {
                    close(stress.sigma_2, -p, p, CLOSED_FORM, &format!("{what}: sigma_2"));
                    close(stress.sigma_1, 0.0, p, CLOSED_FORM, &format!("{what}: sigma_1"));
                }
                let balance = model.force_balance(&solution.displacement, &solution.multiplier).unwrap();
                assert!(balance < 1e-12, "{what}: balance {balance:e}");
            }
        }
    }
}

/// GOAL: the contact patch test with a prescribed displacement.
/// CONDITIONS: the top of a block moves down by 0.01; free and confined sides; gaps from -0.002 to 0.02.
/// REFERENCE: `closed_forms::ContactPatch`: p = E' (0.01 - g)/0.8, zero while the gap is open.
#[test]
fn block_pressed_by_a_prescribed_displacement_has_the_pressure_of_the_closed_form() {
    for (supports, sides) in [
        (json!([{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "top"}, "y": -0.01}]), Sides::PlaneStrain),
        (
            json!([{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "right"}, "x": 0},
                   {"on": {"boundary": "top"}, "y": -0.01}]),
            Sides::Confined,
        ),
    ] {
        let closed = ContactPatch { young: 2e5, poisson: 0.3, sides };
        for gap in [0.004, 0.0, -0.002, 0.01, 0.02] {
            let model = built(&patch("q4", "plane-strain", json!([]), supports.clone(), gap));
            let p = closed.pressure(0.8, 0.01, gap);
            let solution = solve_qp(model.problem()).unwrap();
            for pressure in model.pressure(&solution.multiplier).unwrap() {
                close(pressure, p, 2e5 * 0.01, CLOSED_FORM, &format!("gap {gap}: pressure"));
            }
        }
    }
}

#[test]
fn three_methods_agree_at_ten_gaps_and_with_the_stored_independent_answers() {
    let reference: Value =
        serde_json::from_str(&std::fs::read_to_string(file("reference/results.json")).unwrap()).unwrap();
    let base = built(&indentation());
    for step in 1..=10 {
        let gap = -0.01 * f64::from(step);
        let model = base.with_gap(gap).unwrap();
        let comparison = compare(model.problem(), &Settings::default()).unwrap();
        let agreement = &comparison.agreement;
        assert!(agreement.exact_methods && agreement.penalty_within_its_bound, "gap {gap}: {agreement:?}");

        let stored = &reference["cases"][format!("indentation {gap:.2}")];
        let solution = &comparison.answers[0].solution;
        let force = stored["force"].as_f64().unwrap();
        close(solution.contact_force(), force, force, 1e-9, "force");
        // The stored answers agree with each other to 1e-8 in u and 1e-7 in lambda.
        for (name, values, tolerance) in
            [("displacement", &solution.displacement, 1e-8), ("multiplier", &solution.multiplier, 1e-7)]
        {
            let list = |key: &str| stored[name][key].as_array().unwrap().clone();
            assert_eq!(values.len() as u64, stored[name]["length"].as_u64().unwrap());
            for (index, value) in list("index").iter().zip(list("value")) {
                let found = values[index.as_u64().unwrap() as usize];
                close(found, value.as_f64().unwrap(), largest(values), tolerance, &format!("gap {gap}: {name}"));
            }
        }
        let runs = stored["closed_rows"].as_array().unwrap();
        let closed: Vec<usize> =
            runs.iter().flat_map(|run| run[0].as_u64().unwrap() as usize..=run[1].as_u64().unwrap() as usize).collect();
        assert_eq!(solution.contact_set.iter().collect::<Vec<_>>(), closed, "gap {gap}");
    }
}

/// The indentation with lengths times `length` and the modulus `young`.
fn in_units(length: f64, young: f64) -> Model {
    let mut scene = indentation();
    let scaled = |value: f64| value * length;
    scene["body"]["rectangle"]["x"]["points"] = json!([0.0, scaled(1.0)]);
    scene["body"]["rectangle"]["y"]["points"] = json!([0.0, scaled(0.5)]);
    scene["obstacles"][0]["shape"]["parabola"] = json!({"apex": [scaled(0.5), scaled(0.5)], "radius": scaled(1.0)});
    scene["material"]["young"] = json!(young);
    scene["gap"] = json!(scaled(-0.01));
    built(&scene)
}

#[test]
fn the_same_scene_in_other_units_has_the_same_dimensionless_answer() {
    for method in [Method::qp(), Method::ActiveSet, Method::penalty()] {
        let reference = answer_by(method, in_units(1.0, 1e7).problem());
        // m and Pa; mm and MPa; micrometres and N per square micrometre; steel; a metre of jelly; kilometres of rock.
        for (length, young) in [(1e3, 10.0), (1e6, 1e-5), (1.0, 2.1e11), (1.0, 1e-2), (1e3, 5e10), (1e-9, 1e12)] {
            let solution = answer_by(method, in_units(length, young).problem());
            assert_eq!(solution.contact_set, reference.contact_set, "{method:?}, {length:e}, {young:e}");
            let (u, lambda) = (largest(&reference.displacement), largest(&reference.multiplier));
            for (a, b) in solution.displacement.iter().zip(&reference.displacement) {
                close(a / length, *b, u, 1e-9, &format!("{method:?}, {length:e}, {young:e}: u"));
            }
            // Forces per metre of thickness are scaled by modulus times length.
            for (a, b) in solution.multiplier.iter().zip(&reference.multiplier) {
                close(
                    a / length * (1e7 / young),
                    *b,
                    lambda,
                    1e-9,
                    &format!("{method:?}, {length:e}, {young:e}: lambda"),
                );
            }
        }
    }
}

#[test]
fn virtual_work_and_the_balance_of_forces_hold_in_every_example() {
    for name in ["indentation", "inclined", "between", "block", "bar", "circle"] {
        let model = Scene::read(file(&format!("examples/{name}.json"))).unwrap().build().unwrap();
        for method in EXACT {
            let solution = answer_by(method, model.problem());
            let (problem, u, lambda) = (model.problem(), &solution.displacement, &solution.multiplier);
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
            let (strain, load, gap) =
                (dot(u, &problem.stiffness().mul(u)), dot(problem.load(), u), dot(problem.gap(), lambda));
            let scale = strain.abs().max(load.abs()).max(gap.abs());
            close(strain, load + gap, scale, 1e-12, &format!("{name}, {method:?}: u'Ku = f'u + g'lambda"));
            let balance = model.force_balance(u, lambda).unwrap();
            assert!(balance < 1e-12, "{name}, {method:?}: {balance:e}");
        }
    }
}

#[test]
fn without_a_gap_the_answer_is_proportional_to_the_load() {
    let scene = |force: f64| {
        let mut scene = indentation();
        scene["gap"] = json!(0.0);
        scene["obstacles"][0]["shape"] = json!({"plane": {"point": [0, 0.5], "normal": [0, 1]}});
        scene["loads"] = json!([{"body-force": [3.0 * force, force]}]);
        built(&scene)
    };
    let reference = solve_qp(scene(1e4).problem()).unwrap();
    assert!((1..41).contains(&reference.contact_set.count()), "{}", reference.contact_set.count());
    for factor in [1e-6, 0.3, 7.0, 1e8] {
        let solution = solve_qp(scene(1e4 * factor).problem()).unwrap();
        assert_eq!(solution.contact_set, reference.contact_set, "factor {factor:e}");
        for (a, b) in solution.displacement.iter().zip(&reference.displacement) {
            close(a / factor, *b, largest(&reference.displacement), 1e-11, "u");
        }
    }
}

#[test]
fn an_obstacle_out_of_reach_has_no_contact_row_closed() {
    let mut scene = indentation();
    scene["gap"] = json!(0.5);
    scene["loads"] = json!([{"traction": {"boundary": "right", "value": [1e3, 0]}}]);
    let model = built(&scene);
    for method in [Method::qp(), Method::ActiveSet, Method::penalty()] {
        let solution = solve(model.problem(), &Settings::with_method(method)).unwrap();
        assert!(solution.contact_set.count() == 0 && solution.multiplier.iter().all(|&lambda| lambda == 0.0));
        assert!(solution.certificate.meets(1e-12) && solution.displacement.iter().any(|&u| u != 0.0));
    }
}

/// The first iteration uses C = 0, the last the set of the answer; each set differs from the one before.
#[test]
fn the_history_of_the_active_set_begins_with_the_empty_set_and_ends_with_the_answer() {
    let solution = answer_by(Method::ActiveSet, built(&indentation()).problem());
    let history: Vec<_> = solution.history.iter().map(|step| &step.contact_set).collect();
    assert_eq!(history[0].count(), 0);
    assert_eq!(*history[history.len() - 1], solution.contact_set);
    assert!(history.windows(2).all(|pair| pair[0] != pair[1]));
    assert_eq!(history.len(), solution.iterations);
}

/// GOAL: two bars in series against a wall.
/// CONDITIONS: ratios of their stiffnesses from 1e-12 to 1e12; the force is twice the one that closes the gap.
/// REFERENCE: u_1 = k2 g / (k1 + k2), lambda = -F/2.
#[test]
fn bars_in_series_keep_their_digits_over_twelve_decades_of_stiffness() {
    use signorini::{ContactProblem, SparseMatrix, SymmetricMatrix};
    for ratio in [1e-12, 1e-6, 1.0, 1e6, 1e12] {
        let (k1, k2, gap) = (1.0, ratio, 0.3);
        let force = 2.0 * gap * k1 * k2 / (k1 + k2);
        let stiffness = SparseMatrix::from_triplets(2, 2, &[(0, 0, k1 + k2), (1, 0, -k2), (1, 1, k2)]).unwrap();
        let problem = ContactProblem::new(
            SymmetricMatrix::from_lower(stiffness).unwrap(),
            vec![0.0, force],
            SparseMatrix::from_triplets(1, 2, &[(0, 1, 1.0)]).unwrap(),
            vec![gap],
        )
        .unwrap();
        for method in EXACT {
            let solution = solve(&problem, &Settings::with_method(method)).unwrap();
            let what = format!("ratio {ratio:e}, {method:?}");
            close(solution.displacement[1], gap, gap, 1e-12, &what);
            // The entry k1 + k2 of K is rounded: with k2 = 1e12 this rounding, 1e-4 of k1, is an error of the data, not
            // of the solver.
            let data = f64::EPSILON * (1.0 + k2 / k1);
            close(solution.displacement[0], gap * k2 / (k1 + k2), gap, 1e-12 + data, &what);
            close(solution.multiplier[0], -force / 2.0, force, 1e-12 + data, &what);
        }
    }
}

/// A sphere of radius 1 on a block of revolution of quadratic elements: the node on the axis has no tributary area.
#[test]
fn pressure_on_the_axis_of_revolution_is_finite_and_near_the_largest() {
    let scene = |element: &str| {
        built(&json!({
            "model": "axisymmetric",
            "body": {"rectangle": {
                "x": {"points": [0, 0.3, 2], "divisions": [12, 10], "ratios": [1, 10]},
                "y": {"points": [-2, -0.3, 0], "divisions": [10, 10], "ratios": [0.1, 0.6]},
                "element": element,
            }},
            "material": {"young": 1.0, "poisson": 0.3},
            "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}, {"on": {"boundary": "left"}, "x": 0}],
            "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"circle": {"apex": [0, 0], "radius": 1}}}],
            "gap": -0.01,
        }))
    };
    let peaks = ["q4", "q8", "t6"].map(|element| {
        let model = scene(element);
        let solution = answer_by(Method::qp(), model.problem());
        let pressure = model.pressure(&solution.multiplier).unwrap();
        let axis = model.rows().iter().position(|row| model.mesh().nodes()[row.node][0] == 0.0).unwrap();
        let peak = pressure.iter().copied().fold(0.0, f64::max);
        assert!(pressure[axis] > 0.9 * peak, "{element}: {} of {peak}", pressure[axis]);
        peak
    });
    // Hertz: p0 = 2 E* a / (pi R) = 0.07 with a = 0.1; the coarse mesh and the finite block cause an error of a few per
    // cent.
    assert!(peaks.iter().all(|peak| (peak / 0.07 - 1.0).abs() < 0.1), "{peaks:?}");
}

/// GOAL: a half cylinder on a rigid plane.
/// CONDITIONS: plane strain, radius 1, E = 1, nu = 0.3; the cut moves rigidly by delta = 0.01 and can expand sideways.
/// REFERENCE: Hertz: delta = F/(pi E*) (2 ln(4R/a) - 1) and p0 = a E*/(2R) give F = 4.983922e-3, p0 = 0.041753222.
#[test]
fn a_half_cylinder_of_quadratic_elements_has_the_force_and_the_pressure_of_hertz() {
    for element in ["q8", "t6"] {
        let model = built(&json!({
            "body": {"half-disc": {"radius": 1, "zone": {"width": 0.1, "divisions": 8}, "element": element}},
            "material": {"young": 1.0, "poisson": 0.3},
            "supports": [{"on": {"boundary": "cut"}, "y": -0.01}, {"on": {"point": [0, 0]}, "x": 0}],
            "obstacles":
                [{"boundary": "arc", "approach": "-y", "shape": {"plane": {"point": [0, -1], "normal": [0, -1]}}}],
        }));
        let solution = answer_by(Method::qp(), model.problem());
        let peak = model.pressure(&solution.multiplier).unwrap().into_iter().fold(0.0, f64::max);
        // The theory assumes a half space and a small contact: 0.1 % in the force, 1 % in the pressure.
        close(solution.contact_force(), 4.983922e-3, 4.983922e-3, 1e-3, &format!("{element}: F"));
        close(peak, 0.041753222, 0.041753222, 1e-2, &format!("{element}: p0"));
    }
}
