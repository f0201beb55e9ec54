//! GOAL: normals and coordinates that are prescribed at one node form one frame or are refused; rigid-body modes along
//! rollers are named; the dof map transforms vectors in both directions.

use signorini::{Error, Scene, fem, qp, solve_qp};
use std::collections::BTreeMap;

use serde_json::{Value, json};
use signorini::fem::{DofMap, Frame};
use support::bodies::difference;
use support::rollers::{ROUNDING, check, cube, dot, lines, square};
use support::scenes::built;

#[test]
fn a_normal_along_an_axis_of_either_sign_equals_a_support_along_that_axis() {
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
fn parallel_normals_with_consistent_values_are_one_support() {
    let once =
        json!([{"on": {"boundary": "bottom"}, "normal": [1, -2], "value": 0.01}, {"on": {"boundary": "left"}, "x": 0}]);
    let mut twice = once.clone();
    twice.as_array_mut().unwrap().push(json!({"on": {"boundary": "bottom"}, "normal": [-3, 6], "value": -0.01}));
    let (once, twice) = (square("plane-strain", "q4", once), square("plane-strain", "q4", twice));
    assert_eq!(built(&once).dofs(), built(&twice).dofs());
}

#[test]
fn nearly_parallel_normals_are_solved_without_loss_of_the_frame() {
    // Two normals in space that differ by 1e-6: the second axis is the remainder of a difference.
    let mut scene = cube("hex8", json!([{"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": 0}]));
    for normal in [[1.0, 1.0, 0.5], [1.0, 1.0, 0.5 + 1e-6]] {
        let support = json!({"on": {"point": [1, 1, 1]}, "normal": normal});
        scene["supports"].as_array_mut().unwrap().push(support);
    }
    let model = built(&scene);
    let solution = solve_qp(model.problem()).unwrap();
    let nodal = model.nodal_displacement(&solution.displacement).unwrap();
    // The normals span the plane of (1, 1, 0) and z: only (1, -1, 0) is free.
    let [x, y, z] = [78, 79, 80].map(|dof: usize| nodal[dof]);
    // The direction of the second axis has the rounding of the first divided by 1e-6.
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
    // The coordinate is applied first; then the two oblique normals contradict it.
    assert!(
        path == "supports[1].normal" && message.contains("supports[0] and supports[2] prescribe"),
        "{path}: {message}"
    );
}

fn under_held(scene: &Value) -> (String, Vec<f64>) {
    match Scene::from_json(&scene.to_string(), "scene").unwrap().build() {
        Err(Error::Qp(qp::Error::UnderHeld { mode, direction })) => (mode, direction),
        other => panic!("{other:?}"),
    }
}

#[test]
fn rigid_body_modes_along_rollers_are_found_and_named() {
    let rollers = |rollers: &[([f64; 2], [f64; 2])]| {
        let supports: Vec<Value> =
            rollers.iter().map(|(at, normal)| json!({"on": {"point": at}, "normal": normal})).collect();
        let mut scene = square("plane-strain", "q4", json!(supports));
        scene["obstacles"] = json!([]);
        scene
    };
    // Two parallel rollers: the body slides along both; the direction has unit length at each of its 20 nodes.
    let (mode, direction) = under_held(&rollers(&[([0.0, 0.0], [3.0, 4.0]), ([1.0, 0.0], [-3.0, -4.0])]));
    assert!(mode.contains("translation along") && mode.contains("0.800") && mode.contains("0.600"), "{mode}");
    assert!((dot(&direction, &direction) - 20.0).abs() < 1e-9, "{direction:?}");
    // Two other rollers: the body rotates about the point at which the normals meet, (0.5, 0.5); three rollers through
    // one point allow the same rotation.
    let cross = [([0.0, 0.0], [1.0, 1.0]), ([1.0, 0.0], [-1.0, 1.0]), ([0.5, 0.0], [0.0, 1.0])];
    for count in [2, 3] {
        let (motion, _) = under_held(&rollers(&cross[..count]));
        assert!(motion.contains("rotation about z through (0.5, 0.5)"), "{motion}");
    }
    // A third roller whose normal does not pass through that point prevents the rotation.
    check(&rollers(&[cross[0], cross[1], ([0.75, 0.0], [0.0, 1.0])]));
    // In space, three motions are free on an inclined plane.
    let mut scene = cube("hex8", json!([{"on": {"boundary": "bottom"}, "normal": [0, 0.6, -0.8]}]));
    scene["obstacles"] = json!([]);
    let (motion, _) = under_held(&scene);
    assert_eq!(motion.matches("translation along").count(), 2, "{motion}");
    assert!(motion.contains("translation along x") && motion.contains("rotation about ("), "{motion}");
}

#[test]
fn an_unbounded_translation_along_rollers_is_named() {
    // Two parallel rollers and a wall that stops the body in one direction; the load acts in the other direction.
    let mut scene = square("plane-strain", "q4", json!([{"on": {"boundary": "bottom"}, "normal": [3, 4]}]));
    scene["obstacles"] =
        json!([{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [1, 0], "normal": [1, 0]}}}]);
    scene["loads"] = json!([{"body-force": [-1, 0]}]);
    let model = built(&scene);
    let error = model.explain(solve_qp(model.problem()).unwrap_err());
    let Error::Qp(qp::Error::Unbounded { mode, .. }) = &error else { panic!("{error}") };
    assert_eq!(mode, "translation along (-0.800, 0.600)");
    scene["loads"] = json!([{"body-force": [1, 0]}]);
    check(&scene);
}

#[test]
fn frames_transform_vectors_in_both_directions() {
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

    // Restricting is the transpose of expanding: f . (expand u) = (restrict f) . u if no value is prescribed.
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
    assert!(dofs.along(1, &[0.6, 0.8]).free.is_empty(), "a component of the size of rounding is kept");
    assert!(difference(&dofs.supported_part(&force).unwrap(), &[0.0, 0.0, -0.84, -1.12, 0.25, 0.0]) < ROUNDING);

    for given in [&[[1.0, 1.0, 0.0]][..], &[[1.0, 0.0, 0.0], [0.6, 0.8, 0.0]], &[[0.0, 0.0, 1.0]], &[[f64::NAN; 3]]] {
        assert!(
            matches!(
                Frame::completing(given, 2),
                Err(fem::Error::Linear(qp::LinearError::Setting { name: "frame", .. }))
            ),
            "{given:?}"
        );
    }
    assert!(Frame::completing(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], 2).is_err());
    let outside = DofMap::with_frames(vec![None; 4], 2, BTreeMap::from([(2, plane)]));
    assert!(matches!(outside, Err(fem::Error::Mesh { .. })));
    assert!(DofMap::with_frames(vec![None; 4], 0, BTreeMap::from([(0, plane)])).is_err());
}
