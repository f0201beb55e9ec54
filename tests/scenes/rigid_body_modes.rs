//! Rigid-body modes: every body without enough supports is refused before it is built, with its motion by name, and no
//! other body is refused. Rows that contradict each other are named with their Farkas weights, which are checked here
//! by independent arithmetic.

use serde_json::{Value, json};
use signorini::{Error, Model, Scene, qp, solve_qp};
use support::draws::Draws;
use support::oracles::Dense;
use support::scenes::build;
use support::{cases, seed};

/// Rounding of K d for a null vector d, relative to its terms.
const NULL: f64 = 1e-9;

fn axis(length: f64) -> Value {
    json!({"points": [0, length], "divisions": [2]})
}

/// The bodies of each model, of size 1, with a load that presses them onto the floor.
fn body(model: &str) -> Value {
    match model {
        "bar" => json!({"bar": {"x": axis(1.0)}}),
        "space" => json!({"box": {"x": axis(1.0), "y": axis(1.0), "z": axis(1.0)}}),
        _ => json!({"rectangle": {"x": axis(1.0), "y": axis(1.0)}}),
    }
}

fn scene(model: &str, supports: &Value, obstacles: &Value) -> Value {
    let down = match model {
        "bar" => json!([-1]),
        "space" => json!([0, 0, -1]),
        _ => json!([0, -1]),
    };
    json!({
        "model": model, "body": body(model), "material": {"young": 1000, "poisson": 0.3},
        "supports": supports, "obstacles": obstacles, "loads": [{"body-force": down}]
    })
}

fn boundary(name: &str, held: Value) -> Value {
    let mut support = held;
    support["on"] = json!({"boundary": name});
    support
}

fn point(at: Value, held: Value) -> Value {
    let mut support = held;
    support["on"] = json!({"point": at});
    support
}

fn floor(model: &str) -> Value {
    let (side, approach, at, normal) = match model {
        "bar" => ("left", "-x", json!([0]), json!([-1])),
        "space" => ("bottom", "-z", json!([0, 0, 0]), json!([0, 0, -1])),
        _ => ("bottom", "-y", json!([0, 0]), json!([0, -1])),
    };
    json!({"boundary": side, "approach": approach, "shape": {"plane": {"point": at, "normal": normal}}})
}

/// Supports, obstacles and the words that name a motion, or `None` if the body has enough supports.
type Case = (&'static str, Vec<Value>, bool, Option<&'static str>);

fn single_bodies() -> Vec<Case> {
    let mut cases: Vec<Case> = Vec::new();
    let mut add = |model, supports: Vec<Value>, on_floor, motion| cases.push((model, supports, on_floor, motion));
    // A bar can only translate.
    add("bar", vec![], false, Some("translation along x"));
    add("bar", vec![], true, None);
    add("bar", vec![boundary("left", json!({"x": 0}))], false, None);
    add("bar", vec![boundary("right", json!({"x": 0.1}))], false, None);
    add("bar", vec![point(json!([0.5]), json!({"x": 0}))], true, None);
    for held in [0.0, 0.1, 0.2] {
        add("bar", vec![boundary("left", json!({"x": held}))], true, None);
        add("bar", vec![boundary("left", json!({"x": 0})), boundary("right", json!({"x": held}))], false, None);
    }
    // A body of revolution can only translate along its axis.
    for (side, held, motion) in [
        ("bottom", json!({"y": 0}), None),
        ("top", json!({"y": 0.1}), None),
        ("right", json!({"y": 0}), None),
        ("right", json!({"x": 0}), Some("translation along y")),
        ("bottom", json!({"x": 0}), Some("translation along y")),
        ("right", json!({"x": 0, "y": 0}), None),
        ("right", json!({"normal": [1, 1]}), None),
    ] {
        add("axisymmetric", vec![boundary(side, held.clone())], false, motion);
        add("axisymmetric", vec![boundary(side, held)], true, None);
    }
    add("axisymmetric", vec![], false, Some("translation along y"));
    add("axisymmetric", vec![], true, None);
    // In the plane.
    for model in ["plane-strain", "plane-stress"] {
        let p = |x: f64, y: f64, held: Value| point(json!([x, y]), held);
        add(model, vec![], false, Some("translation along x, translation along y, rotation"));
        add(model, vec![], true, Some("translation along x"));
        for (side, held, free, on_floor) in [
            ("bottom", json!({"x": 0, "y": 0}), None, None),
            ("bottom", json!({"y": 0}), Some("translation along x"), Some("translation along x")),
            // A line of nodes supported along the line can still rotate about its points, but not translate along the
            // line.
            ("bottom", json!({"x": 0}), Some("translation along y"), None),
            ("left", json!({"x": 0}), Some("translation along y"), None),
            ("right", json!({"y": 0}), Some("translation along x"), Some("translation along x")),
            ("top", json!({"x": 0.1, "y": 0.1}), None, None),
            ("bottom", json!({"normal": [1, 1]}), Some("translation along (0.707, -0.707)"), None),
            ("left", json!({"normal": [1, 2]}), Some("translation along"), None),
        ] {
            add(model, vec![boundary(side, held.clone())], false, free);
            add(model, vec![boundary(side, held)], true, on_floor);
        }
        add(model, vec![p(0.0, 0.0, json!({"x": 0, "y": 0}))], false, Some("rotation about z through (0, 0)"));
        add(model, vec![p(1.0, 1.0, json!({"x": 0, "y": 0}))], false, Some("rotation about z through (1, 1)"));
        add(model, vec![p(0.5, 0.5, json!({"x": 0, "y": 0}))], true, None);
        add(model, vec![p(0.5, 0.5, json!({"x": 0}))], true, None);
        add(model, vec![p(0.5, 0.5, json!({"y": 0}))], true, Some("translation along x"));
        let two = |a: Value, b: Value| vec![p(0.0, 0.0, a), p(1.0, 0.0, b)];
        add(model, two(json!({"x": 0, "y": 0}), json!({"y": 0})), false, None);
        add(model, two(json!({"x": 0, "y": 0}), json!({"x": 0})), false, Some("rotation about z through (0, 0)"));
        add(model, two(json!({"y": 0}), json!({"y": 0})), false, Some("translation along x"));
        add(model, two(json!({"x": 0}), json!({"x": 0})), true, None);
        add(
            model,
            two(json!({"normal": [1, 1]}), json!({"normal": [-1, 1]})),
            false,
            Some("rotation about z through (0.5, 0.5)"),
        );
        add(model, two(json!({"normal": [1, 1]}), json!({"normal": [-1, 1]})), true, None);
    }
    // In space.
    for (supports, free, on_floor) in [
        (
            vec![],
            Some("translation along x, translation along y, translation along z, rotation"),
            Some("translation along x"),
        ),
        (vec![boundary("bottom", json!({"x": 0, "y": 0, "z": 0}))], None, None),
        (
            vec![boundary("bottom", json!({"z": 0}))],
            Some("translation along x, translation along y, rotation about z"),
            Some("translation along x"),
        ),
        (
            vec![boundary("left", json!({"x": 0}))],
            Some("translation along y, translation along z, rotation about x"),
            Some("translation along y"),
        ),
        (
            vec![boundary("left", json!({"x": 0})), boundary("front", json!({"y": 0}))],
            Some("translation along z"),
            None,
        ),
        (
            vec![
                boundary("left", json!({"x": 0})),
                boundary("front", json!({"y": 0})),
                boundary("bottom", json!({"z": 0})),
            ],
            None,
            None,
        ),
        (vec![boundary("left", json!({"x": 0, "y": 0}))], Some("translation along z"), None),
        (vec![boundary("left", json!({"x": 0, "z": 0}))], Some("translation along y"), Some("translation along y")),
        (vec![boundary("left", json!({"y": 0, "z": 0}))], Some("translation along x"), Some("translation along x")),
        (
            vec![point(json!([0, 0, 0]), json!({"x": 0, "y": 0, "z": 0}))],
            Some("through (0, 0, 0)"),
            Some("rotation about z"),
        ),
        (
            vec![
                point(json!([0, 0, 0]), json!({"x": 0, "y": 0, "z": 0})),
                point(json!([1, 0, 0]), json!({"y": 0, "z": 0})),
            ],
            Some("rotation about x"),
            None,
        ),
        (
            vec![
                point(json!([0, 0, 0]), json!({"x": 0, "y": 0, "z": 0})),
                point(json!([1, 0, 0]), json!({"y": 0, "z": 0})),
                point(json!([0, 1, 0]), json!({"z": 0})),
            ],
            None,
            None,
        ),
        (
            vec![point(json!([0, 0, 0]), json!({"x": 0, "y": 0})), point(json!([1, 0, 0]), json!({"y": 0}))],
            Some("translation along z"),
            None,
        ),
        (
            vec![boundary("bottom", json!({"normal": [0, 1, 1]}))],
            Some("translation along x"),
            Some("translation along x"),
        ),
        (vec![boundary("top", json!({"x": 0}))], Some("translation along y"), Some("translation along y")),
        (vec![boundary("back", json!({"x": 0, "y": 0, "z": 0.1}))], None, None),
    ] {
        add("space", supports.clone(), false, free);
        add("space", supports, true, on_floor);
    }
    cases
}

#[test]
fn exactly_the_bodies_without_enough_supports_are_refused_with_their_motion() {
    let (mut caught, mut held, mut wrong) = (0, 0, Vec::new());
    for (model, supports, on_floor, motion) in single_bodies() {
        let obstacles = if on_floor { json!([floor(model)]) } else { json!([]) };
        let text = scene(model, &json!(supports), &obstacles).to_string();
        let built = Scene::from_json(&text, "scene").unwrap().build();
        let named = format!("{model} {} floor {on_floor}", json!(supports));
        match (built, motion) {
            (Err(Error::Qp(qp::Error::UnderHeld { mode: found, direction })), Some(motion)) => {
                caught += 1;
                // A floor that touches only supported nodes has no rows, and supports nothing.
                let guided = on_floor && found.contains("a frictionless obstacle does not hold it, add a guide");
                if !found.contains(motion) || !(guided || found.contains("add a support")) {
                    wrong.push(format!("{named}: {found}, not {motion}"));
                }
                assert!(direction.iter().any(|&value| value != 0.0), "{named}");
            }
            (Ok(model), None) => {
                held += 1;
                // The body is supported and pressed onto the floor, so that it has an answer.
                if let Err(error) = solve_qp(model.problem()) {
                    wrong.push(format!("{named}: {}", model.explain(error)));
                }
            }
            (Ok(_), Some(motion)) => wrong.push(format!("{named}: accepted, but it has the {motion}")),
            (Err(error), _) => wrong.push(format!("{named}: {error}")),
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
    assert!(caught >= 40 && held >= 60, "{caught} caught, {held} held");
}

/// Without a mesh the null vector comes from the factorisation: K d = 0, B d = 0, and f'd > 0 if the problem is
/// unbounded.
#[test]
fn problems_without_a_mesh_return_the_null_vector() {
    for springs in 2..30 {
        for (force, gap) in [(0.0, 0.5), (-1.0, 0.5), (-1.0, f64::INFINITY), (1.0, f64::INFINITY)] {
            let mut dense = Dense::new(&[], &[], &[], &[]);
            dense.stiffness = nalgebra::DMatrix::from_fn(springs, springs, |i, j| match i.abs_diff(j) {
                0 if i == 0 || i == springs - 1 => 1.0,
                0 => 2.0,
                1 => -1.0,
                _ => 0.0,
            });
            dense.load = nalgebra::DVector::zeros(springs);
            dense.load[0] = force;
            dense.contact = nalgebra::DMatrix::zeros(1, springs);
            dense.contact[(0, springs - 1)] = 1.0;
            dense.gap = nalgebra::DVector::from_element(1, gap);
            let error = solve_qp(&dense.problem().unwrap()).unwrap_err();
            let (qp::Error::Unbounded { direction, .. } | qp::Error::UnderHeld { direction, .. }) = &error else {
                panic!("{error}")
            };
            let direction = nalgebra::DVector::from_row_slice(direction);
            assert!((&dense.stiffness * &direction).amax() <= NULL * direction.amax(), "{springs}: {error}");
            assert!((direction.amax() - 1.0).abs() < NULL);
            if let qp::Error::Unbounded { .. } = error {
                assert!(dense.load.dot(&direction) > 0.0, "{springs}: the load does no work");
                assert!(
                    gap.is_infinite() || (&dense.contact * &direction)[0] <= NULL,
                    "{springs}: the row stops the motion"
                );
                assert!(force != 0.0);
            } else {
                assert!(force == 0.0, "{springs}: {error}");
            }
        }
    }
}

/// Triangles of rows, with any orientation and any lengths, that contradict each other by the given share of their
/// size.
#[test]
fn contradicting_rows_have_farkas_weights_and_an_overlap() {
    for case in 0..40 {
        let turn = 0.37 * f64::from(case);
        let overlap = 10.0_f64.powi(-(case % 5));
        let lengths = [1.0, 2.0_f64.powi(case % 7), 0.3];
        let mut dense = Dense::new(&[&[2.0, 0.3], &[0.3, 1.0]], &[0.3, 1.0], &[], &[]);
        dense.contact = nalgebra::DMatrix::from_fn(3, 2, |row, column| {
            let angle = turn + 2.0 * std::f64::consts::PI / 3.0 * row as f64;
            lengths[row] * if column == 0 { angle.cos() } else { angle.sin() }
        });
        // Three unit normals at 120 degrees sum to zero, but their gaps are negative.
        dense.gap = nalgebra::DVector::from_fn(3, |row, _| -overlap / 3.0 * lengths[row]);
        let problem = dense.problem().unwrap();
        let error = solve_qp(&problem).unwrap_err();
        let qp::Error::Infeasible { rows, weights, overlap: found, reason } = &error else {
            panic!("case {case}: {error}")
        };
        assert_eq!(rows, &[0, 1, 2], "case {case}");
        let y = nalgebra::DVector::from_row_slice(weights);
        assert!(y.min() >= 0.0 && (dense.contact.transpose() * &y).amax() < 1e-6 * y.amax(), "case {case}: {y}");
        assert!(dense.gap.dot(&y) < 0.0, "case {case}");
        assert_eq!(problem.overlap(rows, weights), Some(*found));
        let exact = -dense.gap.dot(&y) / y.amax();
        assert!((found / exact - 1.0).abs() < 1e-9 && reason.contains("overlap by"), "case {case}: {error}");
    }
    let dense = Dense::new(&[&[1.0]], &[0.0], &[&[1.0], &[-1.0]], &[1.0, -0.5]);
    let problem = dense.problem().unwrap();
    assert_eq!(problem.overlap(&[0, 1], &[1.0, 1.0]), None, "the rows do not contradict each other");
    assert_eq!(problem.overlap(&[0, 1], &[1.0, 0.5]), None, "the rows do not cancel");
    assert_eq!(problem.overlap(&[0, 1], &[1.0, -1.0]), None, "a weight is negative");
    assert_eq!(problem.overlap(&[0, 2], &[1.0, 1.0]), None, "there is no row 2");
    assert_eq!(problem.overlap(&[], &[]), None);
}

/// GOAL: bodies that ties or bolts join move together, and what the load drives off is named on every mesh.
///
/// CONDITIONS: two or three columns on a floor, tied to a cap, all with meshes that do not match; they are lifted,
/// pressed, or tipped over; then two halves of a bolt, of which a tension draws the upper one in, or a shortening.
#[test]
fn joined_bodies_that_the_load_drives_off_are_named_and_others_are_answered() {
    let mut draws = Draws(seed(17));
    for case in 0..cases(6, 60) {
        let mut count = || 1 + draws.below(3);
        let (columns, width, height) = (2 + count() / 3, [1.0, 0.33, 7.1][count() - 1], [2.0, 3.17][count() / 3]);
        let mut solid = |x: [f64; 2], z: [f64; 2]| {
            let mut axis = |ends: [f64; 2]| json!({"points": ends, "divisions": [count()]});
            json!({"box": {"x": axis(x), "y": axis([0.0, width]), "z": axis(z)}})
        };
        let material = json!({"young": 2.1e5, "poisson": 0.3});
        let end = 2.0 * columns as f64 * width;
        let standing: Vec<Value> = (0..columns)
            .map(|column| {
                let from = 2.0 * column as f64 * width;
                json!({"name": format!("c{column}"), "material": material, "body": solid([from, from + width], [0.0, height])})
            })
            .collect();
        let names = || standing.iter().map(|body| body["name"].as_str().unwrap());
        let mut scene = json!({
            "model": "space", "material": material, "body": solid([0.0, end], [height, height + width]),
            "further-bodies": standing,
            "ties": names().map(|name| json!({"surfaces": {"boundary": format!("{name}.top"), "to": "bottom"}})).collect::<Vec<_>>(),
            "obstacles": names().map(|name| {
                let mut floor = floor("space");
                floor["boundary"] = json!(format!("{name}.bottom"));
                floor
            }).collect::<Vec<_>>(),
        });
        let held =
            |at: [f64; 3], free: &str| json!([boundary("front", json!({"y": 0})), point(json!(at), json!({free: 0}))]);
        let guides = json!([boundary("front", json!({"y": 0})), boundary("left", json!({"x": 0}))]);
        let hinge = held([0.0, 0.0, height + width], "x");
        let pressed = |by: f64| json!({"pressure": {"boundary": "top", "value": by}});
        let tipped = json!({"moment": {"boundary": "top", "value": [0, 9.0 * end * end * width, 0]}});
        for (supports, loads, named) in [
            (&guides, json!([pressed(1.0)]), None),
            (&guides, json!([pressed(-1.0)]), Some("translation along z")),
            (&hinge, json!([pressed(1.0)]), None),
            (&hinge, json!([pressed(1.0), tipped]), Some("rotation about y")),
        ] {
            (scene["supports"], scene["loads"]) = (supports.clone(), loads);
            ends(&scene, named, &format!("case {case}"));
        }
        scene = json!({
            "model": "space", "material": material, "body": solid([0.0, width], [0.0, height]),
            "further-bodies": [{"name": "up", "material": material, "body": solid([0.0, width], [height, 2.0 * height])}],
            "supports": [boundary("bottom", json!({"x": 0, "y": 0, "z": 0}))],
            "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [2.0 * width, 0, 0], "normal": [1, 0, 0]}}}],
            "loads": [],
        });
        for (key, named) in [("force", Some("translation along z of `up`")), ("shortening", None)] {
            scene["ties"] = json!([{"preload": {"boundary": "top", "to": "up.bottom", key: 1e-3}}]);
            ends(&scene, named, &format!("case {case}, {key}"));
        }
    }
}

/// Checks that the load drives this motion, named or not, or that there is an answer.
#[track_caller]
fn ends(scene: &Value, named: Option<&str>, case: &str) {
    let solved = |model: Model| solve_qp(model.problem()).map(drop).map_err(|error| model.explain(error));
    match (build(scene).and_then(solved), named) {
        (Ok(()), None) => {}
        (Err(Error::Qp(qp::Error::Unbounded { mode, .. } | qp::Error::UnderHeld { mode, .. })), Some(named)) => {
            assert!(mode.contains(named), "{case}: {mode}, not {named}");
        }
        (ended, _) => panic!("{case}: {ended:?}, not {named:?}"),
    }
}

/// Frictionless walls on both sides and a floor leave the way up: a load that lifts drives it, and none lets it be.
#[test]
fn a_body_between_walls_may_leave_upwards() {
    for (element, lift) in ["t3", "q4", "t6", "q8"].into_iter().flat_map(|element| [(element, 0.0), (element, 1e3)]) {
        let axis = |to: f64, divisions: usize| json!({"points": [0, to], "divisions": [divisions]});
        let wall = |boundary: &str, approach: &str, point: [f64; 2], normal: [f64; 2]| json!({"boundary": boundary, "approach": approach, "shape": {"plane": {"point": point, "normal": normal}}});
        let scene = json!({
            "model": "plane-strain", "material": {"young": 1e7, "poisson": 0.3},
            "body": {"rectangle": {"x": axis(1.0, 13), "y": axis(0.5, 7), "element": element}},
            "loads": [{"force": {"boundary": "top", "value": [0, lift]}}],
            "obstacles": [
                wall("bottom", "-y", [0.0, 0.0], [0.0, -1.0]),
                wall("left", "-x", [0.0, 0.0], [-1.0, 0.0]),
                wall("right", "+x", [1.0, 0.0], [1.0, 0.0])
            ]
        });
        let error = solve_qp(build(&scene).unwrap().problem()).unwrap_err();
        let (is_driven, direction) = match &error {
            qp::Error::Unbounded { direction, .. } => (true, direction),
            qp::Error::UnderHeld { direction, .. } => (false, direction),
            _ => panic!("{element}: {error:.300}"),
        };
        assert_eq!(is_driven, lift > 0.0, "{element}");
        assert!(direction.chunks(2).all(|of_node| of_node[0] == 0.0 && of_node[1] > 0.99), "{element}: {error:.300}");
    }
}
