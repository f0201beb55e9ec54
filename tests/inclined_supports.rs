//! GOAL: rollers on inclined planes, against Lagrange multipliers in the coordinate axes: a dense linear solve of
//! `K u - N'r - B_c'lambda = f, N u = v, B_c u = g_c` over all dofs, which knows no frame.

mod bodies;

use std::collections::BTreeMap;

use bodies::{built, difference, largest};
use nalgebra::{DMatrix, DVector};
use serde_json::{Value, json};
use signorini::assembly::{DofMap, Frame, stiffness};
use signorini::{Error, Model, Scene, solve_qp};

/// Rounding enlarged by the condition of the dense saddle-point system, below 1e5 here, and a margin.
const DENSE: f64 = 1e-10;

/// A few operations on numbers of order one.
const ROUNDING: f64 = 1e-14;

/// A prescribed component `normal . u = value` of a node.
struct Component {
    node: usize,
    normal: Vec<f64>,
    value: f64,
}

fn norm(vector: &[f64]) -> f64 {
    vector.iter().map(|part| part * part).sum::<f64>().sqrt()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// What a scene prescribes, read from its JSON; components of a node that depend on earlier ones are left out.
fn components(scene: &Value, model: &Model) -> Vec<Component> {
    let (mesh, dimension) = (model.mesh(), model.mesh().dimension());
    let mut all: Vec<Component> = Vec::new();
    let mut add = |node: usize, normal: Vec<f64>, value: f64| {
        let mut rows: Vec<f64> = all.iter().filter(|other| other.node == node).flat_map(|c| c.normal.clone()).collect();
        rows.extend(&normal);
        let count = rows.len() / dimension;
        if DMatrix::from_row_slice(count, dimension, &rows).rank(1e-8) == count {
            all.push(Component { node, normal, value });
        }
    };
    let unit = |axis: usize| (0..dimension).map(|other| f64::from(u8::from(other == axis))).collect::<Vec<f64>>();
    if scene["model"] == "axisymmetric" {
        (0..mesh.nodes().len()).filter(|&n| mesh.nodes()[n][0] == 0.0).for_each(|node| add(node, unit(0), 0.0));
    }
    for support in scene["supports"].as_array().unwrap() {
        let nodes = match (&support["on"]["boundary"], &support["on"]["point"]) {
            (Value::String(name), _) => mesh.boundary(name).unwrap().nodes(),
            (_, at) => {
                let at: Vec<f64> = at.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect();
                vec![mesh.nodes().iter().position(|node| difference(&node[..dimension], &at) < 1e-12).unwrap()]
            }
        };
        for node in nodes {
            for (axis, name) in ["x", "y", "z"].iter().enumerate() {
                if let Some(value) = support[*name].as_f64() {
                    add(node, unit(axis), value);
                }
            }
            if let Some(normal) = support["normal"].as_array() {
                let normal: Vec<f64> = normal.iter().map(|part| part.as_f64().unwrap()).collect();
                let length = norm(&normal);
                add(node, normal.iter().map(|part| part / length).collect(), support["value"].as_f64().unwrap_or(0.0));
            }
        }
    }
    all
}

/// Solves a scene and the same problem with Lagrange multipliers; compares displacement, contact forces, reactions.
#[track_caller]
fn check(scene: &Value) -> Model {
    let model = built(scene);
    let solution = solve_qp(model.problem()).unwrap();
    let held = components(scene, &model);
    let (dimension, count) = (model.mesh().dimension(), model.nodal_load().len());
    let closed: Vec<usize> = (0..model.rows().len()).filter(|&row| solution.multiplier[row] < 0.0).collect();
    let size = count + held.len() + closed.len();
    let (mut matrix, mut right) = (DMatrix::zeros(size, size), DVector::zeros(size));
    let all = DofMap::new(vec![None; count]).unwrap();
    for (row, column, value) in stiffness(model.body(), &all).unwrap().lower().triplets() {
        (matrix[(row, column)], matrix[(column, row)]) = (value, value);
    }
    right.rows_mut(0, count).copy_from_slice(model.nodal_load());
    let of_supports = held.iter().map(|c| (c.node, c.normal.clone(), c.value));
    let of_rows = closed.iter().map(|&row| model.rows()[row]);
    let of_rows = of_rows.map(|row| (row.node, row.normal[..dimension].to_vec(), row.gap));
    for (place, (node, normal, value)) in of_supports.chain(of_rows).enumerate() {
        for (axis, part) in normal.iter().enumerate() {
            matrix[(count + place, dimension * node + axis)] = *part;
            matrix[(dimension * node + axis, count + place)] = -part;
        }
        right[count + place] = value;
    }
    let expected = matrix.full_piv_lu().solve(&right).unwrap();

    let nodal = model.nodal_displacement(&solution.displacement).unwrap();
    let off = difference(&nodal, expected.rows(0, count).as_slice());
    assert!(off < DENSE * largest(&nodal), "displacement: {off:e} of {:e}", largest(&nodal));
    let mut reactions = vec![0.0; count];
    for (place, component) in held.iter().enumerate() {
        for (axis, part) in component.normal.iter().enumerate() {
            reactions[dimension * component.node + axis] += part * expected[count + place];
        }
        let own = &nodal[dimension * component.node..dimension * (component.node + 1)];
        let off = dot(own, &component.normal) - component.value;
        assert!(off.abs() < ROUNDING, "node {} is off its plane by {off:e}", component.node);
    }
    let found = model.reactions(&solution.displacement, &solution.multiplier).unwrap();
    let scale = largest(&reactions);
    assert!(difference(&found, &reactions) < DENSE * scale, "reactions: {:e}", difference(&found, &reactions));
    for node in 0..model.mesh().nodes().len() {
        let normals: Vec<&Component> = held.iter().filter(|component| component.node == node).collect();
        let reaction = &found[dimension * node..dimension * (node + 1)];
        if let [one] = normals[..] {
            let along = dot(reaction, &one.normal);
            let across: Vec<f64> = reaction.iter().zip(&one.normal).map(|(part, n)| part - along * n).collect();
            assert!(norm(&across) < ROUNDING * scale, "the reaction of node {node} is not along its normal");
        }
    }
    for (place, &row) in closed.iter().enumerate() {
        let off = solution.multiplier[row] - expected[count + held.len() + place];
        assert!(off.abs() < DENSE * largest(&solution.multiplier), "row {row}: {off:e}");
    }
    let balance = model.force_balance(&solution.displacement, &solution.multiplier).unwrap();
    assert!(balance < 1e-12, "balance {balance:e}");
    model
}

fn lines(divisions: usize) -> Value {
    json!({"points": [0, 1], "divisions": [divisions]})
}

fn square(model: &str, element: &str, supports: Value) -> Value {
    json!({
        "model": model,
        "body": {"rectangle": {"x": lines(4), "y": lines(3), "element": element}},
        "material": {"young": 1, "poisson": 0.3},
        "supports": supports,
        "loads": [{"traction": {"boundary": "right", "value": [0.02, 0.01]}}, {"body-force": [0.01, 0.03]}],
        "obstacles": [{"boundary": "top", "approach": "+y", "rule": "closest-point",
                       "shape": {"parabola": {"apex": [0.6, 0.99], "radius": 2}}}],
    })
}

fn cube(element: &str, supports: Value) -> Value {
    json!({
        "model": "space",
        "body": {"box": {"x": lines(2), "y": lines(2), "z": lines(2), "element": element}},
        "material": {"young": 1, "poisson": 0.3},
        "supports": supports,
        "loads": [{"traction": {"boundary": "right", "value": [0.02, 0.01, 0.01]}}],
        "obstacles": [{"boundary": "top", "approach": "+z", "rule": "closest-point",
                       "shape": {"sphere": {"apex": [0.6, 0.4, 0.98], "radius": 2}}}],
    })
}

#[test]
fn rollers_in_the_plane_hold_as_lagrange_multipliers_do() {
    // Side by side at the corner: two oblique normals hold it fully.
    let supports = json!([
        {"on": {"boundary": "bottom"}, "normal": [3, -4], "value": 0.01},
        {"on": {"boundary": "left"}, "normal": [-2, -0.3], "value": -0.02},
    ]);
    for element in ["t3", "t6", "q4", "q8"] {
        for model in ["plane-strain", "plane-stress"] {
            let model = check(&square(model, element, supports.clone()));
            let corner = (0..2).filter(|&dof| model.dofs().number(dof).is_some()).count();
            assert_eq!((corner, model.dofs().frame(0)), (0, None), "the corner is held fully, without a frame");
        }
    }
}

#[test]
fn a_normal_joins_coordinates_in_one_support_and_at_one_node() {
    check(&square(
        "plane-strain",
        "q4",
        json!([
            {"on": {"boundary": "bottom"}, "normal": [1, -1]},
            {"on": {"point": [1, 0]}, "x": 0.013},
            {"on": {"point": [0, 1]}, "y": -0.01, "normal": [1, 0.2], "value": 0.02},
            {"on": {"point": [0, 0]}, "x": 0, "y": 0},
        ]),
    ));
    check(&cube(
        "hex8",
        json!([
            {"on": {"boundary": "bottom"}, "normal": [0.1, -0.2, -1], "value": 0.01},
            {"on": {"boundary": "front"}, "y": 0.002},
            {"on": {"point": [0, 1, 1]}, "x": 0, "normal": [-1, 0.4, 0.2], "value": 0.003},
            {"on": {"point": [0, 0, 1]}, "normal": [-1, 0.4, 0.2], "value": 0.003},
        ]),
    ));
}

#[test]
fn rollers_in_space_hold_as_lagrange_multipliers_do() {
    // Edges have two oblique normals, the corner at the origin three.
    let supports = json!([
        {"on": {"boundary": "bottom"}, "normal": [0.2, -0.3, -1], "value": 0.01},
        {"on": {"boundary": "left"}, "normal": [-1, 0.4, 0.1], "value": 0.02},
        {"on": {"boundary": "front"}, "normal": [0.1, -1, 0.3]},
    ]);
    for element in ["tet4", "hex8"] {
        let model = check(&cube(element, supports.clone()));
        let free_at = |node: usize| (3 * node..3 * node + 3).filter(|&dof| model.dofs().number(dof).is_some()).count();
        let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
        (0..27).for_each(|node| *counts.entry(free_at(node)).or_default() += 1);
        assert_eq!(counts, BTreeMap::from([(0, 1), (1, 6), (2, 12), (3, 8)]), "{element}");
    }
}

#[test]
fn a_body_of_revolution_rests_in_a_cone() {
    for element in ["q4", "t6"] {
        let mut scene = square("axisymmetric", element, json!([{"on": {"boundary": "bottom"}, "normal": [1, -2]}]));
        scene["loads"] = json!([{"pressure": {"boundary": "right", "value": 0.02}}, {"body-force": [0, -0.01]}]);
        check(&scene);
        // On the axis the cone holds the node fully: u_x = 0 and (1, -2) . u = 0.02 sqrt(5).
        scene["supports"][0]["value"] = json!(0.02);
        let model = check(&scene);
        let nodal = model.nodal_displacement(&vec![0.0; model.problem().dofs()]).unwrap();
        assert_eq!(nodal[0], 0.0);
        assert!((nodal[1] + 0.01 * 5_f64.sqrt()).abs() < ROUNDING, "{}", nodal[1]);
    }
}

#[test]
fn a_contact_row_may_meet_a_roller_at_its_node() {
    // Nodes of the top on a roller and under the parabola at once, with oblique rows.
    let mut scene = square(
        "plane-strain",
        "q4",
        json!([
            {"on": {"boundary": "left"}, "x": 0},
            {"on": {"boundary": "bottom"}, "normal": [0.3, -1], "value": -0.03},
            {"on": {"point": [0.75, 1]}, "normal": [1, 0.5], "value": 0.001},
            {"on": {"point": [0.5, 1]}, "normal": [1, -0.2], "value": -0.002},
        ]),
    );
    scene["obstacles"][0]["shape"]["parabola"]["apex"] = json!([0.6, 0.98]);
    let model = check(&scene);
    let pressed = solve_qp(model.problem()).unwrap();
    for x in [0.5, 0.75] {
        let row = model.rows().iter().position(|row| model.mesh().nodes()[row.node] == [x, 1.0, 0.0]).unwrap();
        assert!(pressed.multiplier[row] < 0.0, "the row of the roller at x = {x} is closed");
        assert_eq!(model.problem().contact().transposed().column(row).count(), 1, "one free dof");
    }
}

/// The top of the square on a roller of the normal (3, 4), under a plane of the same normal at a distance.
fn parallel(distance: f64, value: f64) -> Value {
    let mut scene = square(
        "plane-strain",
        "q4",
        json!([
            {"on": {"boundary": "bottom"}, "x": 0, "y": 0},
            {"on": {"boundary": "top"}, "normal": [3, 4], "value": value},
        ]),
    );
    let point = [1.0 + 0.6 * distance, 1.0 + 0.8 * distance];
    scene["obstacles"][0]["shape"] = json!({"plane": {"point": point, "normal": [6, 8]}});
    scene
}

#[test]
fn a_row_along_the_normal_of_a_roller_holds_or_fails_by_itself() {
    // The plane is nearest to the corner (1, 1), 0.05 from it; the roller moves the top by 0.04 towards it.
    assert_eq!(check(&parallel(0.05, 0.04)).rows().len(), 0);
    let model = built(&parallel(0.05, 0.06));
    assert_eq!(model.rows().len(), 1, "the corner alone is pushed through");
    let error = model.explain(solve_qp(model.problem()).unwrap_err());
    let Error::Infeasible { reason, .. } = &error else { panic!("{error}") };
    assert!(reason.contains("at (1, 1)") && reason.contains("obstacles[0]"), "{reason}");
}

#[test]
fn an_axis_parallel_normal_is_the_plain_support_of_either_sense() {
    let plain = json!([{"on": {"boundary": "bottom"}, "y": -0.01}, {"on": {"boundary": "left"}, "x": 0}]);
    let expected = built(&square("plane-strain", "q4", plain));
    for (normal, value) in [([0.0, 7.0], -0.01), ([0.0, -1e-3], 0.01), ([0.0, 1e300], -0.01)] {
        let supports = json!([
            {"on": {"boundary": "bottom"}, "normal": normal, "value": value},
            {"on": {"boundary": "left"}, "normal": [-1, 0]},
        ]);
        let model = built(&square("plane-strain", "q4", supports));
        assert_eq!(model.dofs(), expected.dofs(), "{normal:?}");
        assert_eq!(model.problem(), expected.problem(), "{normal:?}");
    }
    let bar = |support: Value| {
        built(&json!({
            "model": "bar", "body": {"bar": {"x": lines(4), "area": 1}}, "material": {"young": 1, "poisson": 0},
            "supports": [support], "loads": [{"body-force": [1]}],
        }))
    };
    let on = json!({"boundary": "left"});
    let (plain, normal) = (bar(json!({"on": on, "x": 0.5})), bar(json!({"on": on, "normal": [-3], "value": -0.5})));
    assert_eq!(plain.dofs(), normal.dofs());
}

#[test]
fn parallel_normals_that_agree_are_one_support() {
    let once =
        json!([{"on": {"boundary": "bottom"}, "normal": [1, -2], "value": 0.01}, {"on": {"boundary": "left"}, "x": 0}]);
    let mut twice = once.clone();
    twice.as_array_mut().unwrap().push(json!({"on": {"boundary": "bottom"}, "normal": [-3, 6], "value": -0.01}));
    let (once, twice) = (square("plane-strain", "q4", once), square("plane-strain", "q4", twice));
    assert_eq!(built(&once).dofs(), built(&twice).dofs());
}

#[test]
fn nearly_parallel_normals_are_solved_without_loss_of_the_frame() {
    // Normals 1e-6 apart in space: the second axis is what is left of a difference.
    let mut scene = cube("hex8", json!([{"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": 0}]));
    for normal in [[1.0, 1.0, 0.5], [1.0, 1.0, 0.5 + 1e-6]] {
        let support = json!({"on": {"point": [1, 1, 1]}, "normal": normal});
        scene["supports"].as_array_mut().unwrap().push(support);
    }
    let model = built(&scene);
    let solution = solve_qp(model.problem()).unwrap();
    let nodal = model.nodal_displacement(&solution.displacement).unwrap();
    // They span the plane of (1, 1, 0) and z: what is left free is along (1, -1, 0).
    let [x, y, z] = [78, 79, 80].map(|dof: usize| nodal[dof]);
    // The second normal knows its direction to the rounding of the first over 1e-6.
    assert!(z.abs() < 1e-9 * x.abs() && (x + y).abs() < 1e-9 * x.abs() && x != 0.0, "{x} {y} {z}");
    let balance = model.force_balance(&solution.displacement, &solution.multiplier).unwrap();
    assert!(balance < 1e-12, "{balance:e}");
}

fn refused(scene: &Value) -> (String, String) {
    match Scene::from_json(&scene.to_string(), "scene").unwrap().build() {
        Err(Error::Scene { path, message }) => (path, message),
        other => panic!("{other:?}"),
    }
}

#[test]
fn supports_that_contradict_each_other_are_refused_by_name_and_place() {
    let on = |point: [f64; 2]| json!({"point": point});
    for (supports, path, words) in [
        (
            json!([{"on": on([0.0, 0.0]), "normal": [1, 2], "value": 0.1}, {"on": on([0.0, 0.0]), "normal": [2, 4]}]),
            "supports[1].normal",
            "0 contradicts the 0.1 that supports[0] prescribes for node 0 at (0, 0)",
        ),
        (
            json!([{"on": on([1.0, 0.0]), "y": 0.5}, {"on": on([1.0, 0.0]), "normal": [0, -2], "value": 0.5}]),
            "supports[1].normal",
            "0.5 contradicts the -0.5 that supports[0] prescribes for node 4 at (1, 0)",
        ),
        (
            json!([
                {"on": on([0.0, 1.0]), "normal": [4, 3], "value": 1}, {"on": on([0.0, 1.0]), "x": 0.5},
                {"on": on([0.0, 1.0]), "normal": [1, 0.0001]}, {"on": on([1.0, 1.0]), "x": 0}
            ]),
            "supports[2].normal",
            "that supports[0] and supports[1] prescribe for node 15 at (0, 1)",
        ),
    ] {
        let (found, message) = refused(&square("plane-strain", "q4", supports));
        assert!(found == path && message.contains(words), "{found}: {message}");
    }
    let cone = json!([{"on": {"point": [0, 0]}, "normal": [1, 0], "value": 0.1}]);
    let (path, message) = refused(&square("axisymmetric", "q4", cone));
    assert_eq!(path, "supports[0].normal");
    assert_eq!(message, "0.1 contradicts the 0 that the axis of revolution prescribes for node 0 at (0, 0)");
    let flat = json!([{"on": {"boundary": "bottom"}, "normal": [1, 2], "value": 0.1},
                      {"on": {"boundary": "bottom"}, "normal": [1, -2], "value": 0.1},
                      {"on": {"boundary": "bottom"}, "normal": [1, 0], "value": 0.1}]);
    let (path, message) = refused(&square("plane-strain", "q4", flat));
    // The coordinate goes first, and the two oblique normals then contradict it.
    assert!(
        path == "supports[1].normal" && message.contains("supports[0] and supports[2] prescribe"),
        "{path}: {message}"
    );
}

fn under_held(scene: &Value) -> (String, Vec<f64>) {
    match Scene::from_json(&scene.to_string(), "scene").unwrap().build() {
        Err(Error::UnderHeld { motion, direction }) => (motion, direction),
        other => panic!("{other:?}"),
    }
}

#[test]
fn rigid_motions_along_rollers_are_found_and_named() {
    let rollers = |rollers: &[([f64; 2], [f64; 2])]| {
        let supports: Vec<Value> =
            rollers.iter().map(|(at, normal)| json!({"on": {"point": at}, "normal": normal})).collect();
        let mut scene = square("plane-strain", "q4", json!(supports));
        scene["obstacles"] = json!([]);
        scene
    };
    // Two parallel rollers: the body slides along both; unit length at each of its 20 nodes.
    let (motion, direction) = under_held(&rollers(&[([0.0, 0.0], [3.0, 4.0]), ([1.0, 0.0], [-3.0, -4.0])]));
    assert!(motion.contains("translation along") && motion.contains("0.800") && motion.contains("0.600"), "{motion}");
    assert!((dot(&direction, &direction) - 20.0).abs() < 1e-9, "{direction:?}");
    // Two others: the body turns about the point where the normals meet, (0.5, 0.5); so do three through one point.
    let cross = [([0.0, 0.0], [1.0, 1.0]), ([1.0, 0.0], [-1.0, 1.0]), ([0.5, 0.0], [0.0, 1.0])];
    for count in [2, 3] {
        let (motion, _) = under_held(&rollers(&cross[..count]));
        assert!(motion.contains("rotation about z through (0.5, 0.5)"), "{motion}");
    }
    // A third that passes the point by holds the body.
    check(&rollers(&[cross[0], cross[1], ([0.75, 0.0], [0.0, 1.0])]));
    // In space: on one inclined plane three motions are left.
    let mut scene = cube("hex8", json!([{"on": {"boundary": "bottom"}, "normal": [0, 0.6, -0.8]}]));
    scene["obstacles"] = json!([]);
    let (motion, _) = under_held(&scene);
    assert_eq!(motion.matches("translation along").count(), 2, "{motion}");
    assert!(motion.contains("translation along x") && motion.contains("rotation about ("), "{motion}");
}

#[test]
fn an_escape_along_rollers_is_named() {
    // Two parallel rollers and a flank that stops the slide one way; the load drives the other way.
    let mut scene = square("plane-strain", "q4", json!([{"on": {"boundary": "bottom"}, "normal": [3, 4]}]));
    scene["obstacles"] =
        json!([{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [1, 0], "normal": [1, 0]}}}]);
    scene["loads"] = json!([{"body-force": [-1, 0]}]);
    let model = built(&scene);
    let error = model.explain(solve_qp(model.problem()).unwrap_err());
    let Error::Unbounded { motion, .. } = &error else { panic!("{error}") };
    assert_eq!(motion, "translation along (-0.800, 0.600)");
    scene["loads"] = json!([{"body-force": [1, 0]}]);
    check(&scene);
}

#[test]
fn frames_turn_there_and_back() {
    let given = [[0.6, 0.0, 0.8], [0.0, -1.0, 0.0]];
    let frame = Frame::completing(&given, 3).unwrap();
    assert_eq!(frame.axes()[..2], given);
    assert!(
        difference(&frame.axes()[2], &[0.8, 0.0, -0.6]) < ROUNDING
            || difference(&frame.axes()[2], &[-0.8, 0.0, 0.6]) < ROUNDING
    );
    let plane = Frame::completing(&[[0.6, 0.8, 0.0]], 2).unwrap();
    assert_eq!(plane.axes()[2], [0.0, 0.0, 1.0]);
    assert!(dot(&plane.axes()[0], &plane.axes()[1]).abs() < ROUNDING);

    // Restricting is the transpose of expanding: f . (expand u) = (restrict f) . u where nothing is prescribed.
    let prescribed = vec![None, None, Some(0.5), None, Some(-1.0), None];
    let dofs = DofMap::with_frames(prescribed, 2, BTreeMap::from([(1, plane)])).unwrap();
    let (free, force) = ([0.3, -0.2, 0.7, 0.1], [1.0, 2.0, -3.0, 0.5, 0.25, 4.0]);
    let motion = dofs.expand_motion(&free).unwrap();
    assert!((dot(&force, &motion) - dot(&dofs.restrict(&force).unwrap(), &free)).abs() < ROUNDING);
    let nodal = dofs.expand(&free).unwrap();
    assert!((0.6 * nodal[2] + 0.8 * nodal[3] - 0.5).abs() < ROUNDING && nodal[4] == -1.0);
    for (node, vector) in [(0, [0.6, 0.8]), (1, [0.6, 0.8]), (1, [1.0, -2.0]), (2, [1.0, 1.0])] {
        let along = dofs.along(node, &vector);
        let value: f64 = along.free.iter().map(|&(dof, factor)| factor * free[dof]).sum();
        assert!((value + along.prescribed - dot(&nodal[2 * node..2 * node + 2], &vector)).abs() < ROUNDING);
    }
    assert!(dofs.along(1, &[0.6, 0.8]).free.is_empty(), "rounding is no component");
    assert!(difference(&dofs.supported_part(&force).unwrap(), &[0.0, 0.0, -0.84, -1.12, 0.25, 0.0]) < ROUNDING);

    for given in [&[[1.0, 1.0, 0.0]][..], &[[1.0, 0.0, 0.0], [0.6, 0.8, 0.0]], &[[0.0, 0.0, 1.0]], &[[f64::NAN; 3]]] {
        assert!(matches!(Frame::completing(given, 2), Err(Error::Setting { name: "frame", .. })), "{given:?}");
    }
    assert!(Frame::completing(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], 2).is_err());
    let outside = DofMap::with_frames(vec![None; 4], 2, BTreeMap::from([(2, plane)]));
    assert!(matches!(outside, Err(Error::Mesh { .. })));
    assert!(DofMap::with_frames(vec![None; 4], 0, BTreeMap::from([(0, plane)])).is_err());
}
