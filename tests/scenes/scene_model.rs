//! Models of scenes: supports, gaps, forces, balance, and motions in words.

use serde_json::{Value, json};
use signorini::qp::Cholesky;
use signorini::scene::Warning;
use signorini::{Error, Model, Scene, qp};
use support::bodies::{clamped_square, difference, largest, solve_with_closed_rows};
use support::scenes::built;

const ROUNDING: f64 = 1e-14;

/// Rounding of the forces of a body with a few hundred unknowns, relative to the sum of all forces.
const BALANCED: f64 = 1e-12;

fn plane_above(gap: f64) -> Value {
    clamped_square(
        4,
        json!([{"boundary": "top", "approach": "+y", "shape": {"plane": {"point": [0, 1], "normal": [0, 1]}}}]),
        gap,
    )
}

/// A clamped square under all kinds of loads, between an inclined plane above and a parabola at its right.
fn loaded(gap: f64) -> Value {
    let mut scene = clamped_square(
        5,
        json!([
            {"boundary": "top", "approach": "+y", "rule": "closest-point",
             "shape": {"plane": {"point": [0.5, 1], "normal": [0.2, 1]}}},
            {"boundary": "right", "approach": "+x", "rule": "closest-point",
             "shape": {"parabola": {"apex": [1, 0.4], "radius": 2}}}
        ]),
        gap,
    );
    scene["thickness"] = json!(0.3);
    scene["supports"] =
        json!([{"on": {"boundary": "bottom"}, "x": 0.01, "y": -0.02}, {"on": {"point": [0, 1]}, "x": 0}]);
    scene["loads"] = json!([
        {"traction": {"boundary": "left", "value": [3, -1]}},
        {"force": {"at": [0.4, 1], "value": [1, 5]}},
        {"body-force": [0, -7]}
    ]);
    scene
}

#[test]
fn a_model_with_another_gap_equals_the_model_of_a_scene_with_that_gap() {
    for scene in [plane_above(-0.1), loaded(-0.1)] {
        let mut other = scene.clone();
        other["gap"] = json!(-0.03);
        let (moved, rebuilt) = (built(&scene).with_gap(-0.03).unwrap(), built(&other));
        assert_eq!(moved.problem(), rebuilt.problem());
        assert_eq!(moved.rows(), rebuilt.rows());
        assert_eq!((moved.gap(), moved.warnings()), (rebuilt.gap(), rebuilt.warnings()));
    }
}

#[test]
fn a_gap_that_is_not_finite_is_refused() {
    let model = built(&plane_above(0.0));
    for gap in [f64::NAN, f64::INFINITY] {
        assert!(matches!(model.with_gap(gap), Err(Error::Scene { path, .. }) if path == "gap"));
    }
}

#[test]
fn loads_reactions_and_contact_forces_balance() {
    let model = built(&loaded(0.05));
    for closed in [vec![], vec![1, 2, 3], (0..model.rows().len()).step_by(2).collect()] {
        let (u, lambda) = solve_with_closed_rows(model.problem(), &closed);
        let balance = model.force_balance(&u, &lambda).unwrap();
        assert!(balance < BALANCED, "{closed:?}: {balance:e}");
        if !closed.is_empty() {
            let wrong: Vec<f64> = lambda.iter().map(|value| -value).collect();
            assert!(model.force_balance(&u, &wrong).unwrap() > 1e-3, "a wrong sign of the forces still balances");
        }
    }
}

#[test]
fn reactions_of_a_free_body_carry_its_loads() {
    let mut scene = plane_above(1.0);
    scene["loads"] = json!([{"traction": {"boundary": "top", "value": [2, 3]}}]);
    let model = built(&scene);
    let u = Cholesky::of(model.problem().stiffness()).unwrap().solve(model.problem().load());
    let reactions = model.reactions(&u, &vec![0.0; model.rows().len()]).unwrap();
    let total = |axis: usize| reactions.iter().skip(axis).step_by(2).sum::<f64>();
    assert!((total(0) + 2.0).abs() < BALANCED && (total(1) + 3.0).abs() < BALANCED);
    let free = |dof: &usize| model.mesh().nodes()[dof / 2][1] > 0.0;
    assert!((0..reactions.len()).filter(free).all(|dof| reactions[dof] == 0.0));
}

/// GOAL: uniform stretch of a bar.
/// CONDITIONS: plane stress; both ends are prescribed.
/// REFERENCE: uniaxial stress: u_x = 0.01 x, sigma_xx = E 0.01, and -nu times the strain across it.
#[test]
fn prescribed_displacements_at_both_ends_stretch_a_bar_uniformly() {
    // Uniform stretch of a bar in plane stress with both ends prescribed: u_x = 0.01 x, sigma_xx = E 0.01.
    let scene = json!({
        "model": "plane-stress",
        "body": {"rectangle": {"x": {"points": [0, 3], "divisions": [6]}, "y": {"points": [0, 1], "divisions": [2]}}},
        "material": {"young": 500, "poisson": 0.25},
        "supports": [
            {"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "right"}, "x": 0.03}, {"on": {"point": [0, 0]}, "y": 0}]
    });
    let model = built(&scene);
    let u = Cholesky::of(model.problem().stiffness()).unwrap().solve(model.problem().load());
    let nodal = model.nodal_displacement(&u).unwrap();
    for (node, &[x, y, _]) in model.mesh().nodes().iter().enumerate() {
        assert!((nodal[2 * node] - 0.01 * x).abs() < ROUNDING);
        assert!((nodal[2 * node + 1] + 0.25 * 0.01 * y).abs() < ROUNDING);
    }
    assert!(
        model.stress(&u).unwrap().nodes.iter().all(|s| (s.sigma_xx - 5.0).abs() < 1e-11 && s.sigma_yy.abs() < 1e-11)
    );
    assert!(model.force_balance(&u, &[]).unwrap() < BALANCED);
}

#[test]
fn rows_at_supported_dofs_keep_only_their_free_part() {
    // The upper left corner is supported along x at 0.1, and is a candidate for an inclined plane.
    let mut scene = clamped_square(
        2,
        json!([{"boundary": "top", "approach": "+y", "rule": "closest-point",
            "shape": {"plane": {"point": [0, 1], "normal": [0.6, 0.8]}}}]),
        0.5,
    );
    scene["supports"].as_array_mut().unwrap().push(json!({"on": {"point": [0, 1]}, "x": 0.1}));
    let model = built(&scene);
    let row = model.rows().iter().position(|row| model.mesh().nodes()[row.node] == [0.0, 1.0, 0.0]).unwrap();
    let entries: Vec<f64> = model.problem().contact().transposed().column(row).map(|entry| entry.1).collect();
    assert_eq!(entries.len(), 1);
    assert!((entries[0] - 0.8).abs() < ROUNDING);
    // The plane is shifted by 0.5 along y, that is by 0.4 along the normal; the support takes 0.06.
    assert!((model.rows()[row].gap - 0.4).abs() < ROUNDING);
    assert!((model.problem().gap()[row] - 0.34).abs() < ROUNDING);
}

#[test]
fn a_row_on_supported_dofs_is_dropped_if_it_holds_and_kept_empty_if_it_fails() {
    let side = |gap: f64| {
        built(&clamped_square(
            4,
            json!([{"boundary": "left", "approach": "-x", "shape": {"plane": {"point": [0, 0], "normal": [-1, 0]}}}]),
            gap,
        ))
    };
    // The lowest of five candidates is clamped.
    assert_eq!((side(0.0).rows().len(), side(0.1).rows().len()), (4, 4));
    let inside = side(-0.1);
    assert_eq!((inside.rows().len(), inside.rows()[0].node), (5, 0));
    assert_eq!(inside.problem().contact().transposed().column(0).count(), 0);
    assert_eq!(inside.problem().gap()[0], -0.1);
    let explained = inside.explain(Error::Qp(qp::Error::Infeasible {
        reason: "row 0".into(),
        rows: vec![0],
        weights: vec![1.0],
        overlap: 0.0,
    }));
    let text = explained.to_string();
    assert!(text.contains("node 0 at (0, 0) is supported inside obstacles[0] (gap -0.1)"), "{text}");
}

#[test]
fn a_node_between_two_obstacles_has_a_row_and_a_pressure_for_each() {
    let wall = |approach: &str, x: f64, n: f64| json!({"boundary": "right", "approach": approach, "shape": {"plane": {"point": [x, 0], "normal": [n, 0]}}});
    let model = built(&clamped_square(2, json!([wall("+x", 1.1, 1.0), wall("-x", 0.8, -1.0)]), 0.0));
    // Each obstacle has two free candidates; the third is clamped and touches neither wall.
    let rows: Vec<(usize, usize)> = model.rows().iter().map(|row| (row.node, row.obstacle)).collect();
    assert_eq!(rows, [(5, 0), (8, 0), (5, 1), (8, 1)]);
    let areas: Vec<f64> = model.rows().iter().map(|row| row.tributary_area).collect();
    assert_eq!(areas, [0.5, 0.25, 0.5, 0.25]);
    assert_eq!(model.pressure(&[-2.0, -2.0, -1.0, 0.0]).unwrap(), [4.0, 8.0, 2.0, 0.0]);
    let explained = model
        .explain(Error::Qp(qp::Error::Infeasible {
            reason: "rows 1, 3".into(),
            rows: vec![1, 3],
            weights: vec![1.0; 2],
            overlap: 0.5,
        }))
        .to_string();
    assert!(explained.contains("node 8 at (1, 1) has no room between obstacles[0]"), "{explained}");
}

#[test]
fn vectors_of_wrong_length_are_refused_by_a_model() {
    let model = built(&plane_above(0.0));
    let (u, lambda) = (vec![0.0; model.problem().dofs()], vec![0.0; model.rows().len()]);
    assert!(matches!(model.nodal_displacement(&u[1..]), Err(Error::Linear(qp::LinearError::Length { .. }))));
    assert!(matches!(model.pressure(&lambda[1..]), Err(Error::Linear(qp::LinearError::Length { .. }))));
    assert!(matches!(model.reactions(&u[1..], &lambda), Err(Error::Linear(qp::LinearError::Length { .. }))));
    assert!(matches!(model.force_balance(&u, &lambda[1..]), Err(Error::Linear(qp::LinearError::Length { .. }))));
    assert!(matches!(model.stress(&u[1..]), Err(Error::Linear(qp::LinearError::Length { .. }))));
}

fn under_held(scene: &Value) -> (String, Vec<f64>) {
    match Scene::from_json(&scene.to_string(), "scene").unwrap().build() {
        Err(Error::Qp(qp::Error::UnderHeld { mode, direction })) => (mode, direction),
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("the body is not refused"),
    }
}

#[test]
fn an_unsupported_rigid_body_mode_is_named_before_the_solve() {
    let on_plane = |supports: Value| {
        let mut scene = plane_above(0.0);
        scene["supports"] = supports;
        scene
    };
    let free = |supports: Value| {
        let mut scene = on_plane(supports);
        scene["obstacles"] = json!([]);
        scene
    };
    let corner = |x: Value, y: Value| json!([{"on": {"point": [1, 0]}, "x": x, "y": y}]);
    let y_only = json!([{"on": {"point": [0.5, 0]}, "y": 0}]);
    for (scene, motion) in [
        (on_plane(json!([])), "translation along x: a frictionless obstacle does not hold it, add a guide"),
        (on_plane(y_only.clone()), "translation along x: a frictionless obstacle"),
        (
            free(json!([])),
            "translation along x, translation along y, rotation about z through (0.5, 0.5): add a support",
        ),
        (free(corner(json!(0), json!(0))), "rotation about z through (1, 0): add a support"),
        (free(json!([{"on": {"boundary": "left"}, "x": 0}])), "translation along y: add a support"),
        (free(y_only), "translation along x, rotation about z through (0.5, 0.5)"),
    ] {
        let (found, direction) = under_held(&scene);
        assert!(found.starts_with(motion), "{found}");
        assert!(largest(&direction) > 0.1, "{found}");
    }
    // One guide is sufficient on a flat obstacle.
    let mut guided = on_plane(json!([{"on": {"point": [0.5, 0]}, "x": 0}]));
    assert!(Scene::from_json(&guided.to_string(), "scene").unwrap().build().is_ok());
    // A parabola with normals at the closest points resists the sideways motion to first order.
    guided["supports"] = json!([]);
    guided["obstacles"][0]["rule"] = json!("closest-point");
    guided["obstacles"][0]["shape"] = json!({"parabola": {"apex": [0.5, 1], "radius": 1}});
    assert!(Scene::from_json(&guided.to_string(), "scene").unwrap().build().is_ok());
}

#[test]
fn an_unsupported_motion_has_no_elastic_energy() {
    // With one corner pinned, the direction must be the rotation about this corner.
    let mut scene = plane_above(0.0);
    scene["obstacles"] = json!([]);
    scene["supports"] = json!([{"on": {"point": [1, 0]}, "x": 0, "y": 0}]);
    let (_, direction) = under_held(&scene);
    scene["supports"] = json!([{"on": {"boundary": "bottom"}, "x": 0, "y": 0}]);
    let held = built(&scene);
    // Entries are in the order of the nodes; the pinned node, number 4, has no entry in the direction.
    let mut nodal = direction.clone();
    nodal.splice(8..8, [0.0, 0.0]);
    let force = signorini::fem::internal_force(held.body(), &nodal).unwrap();
    assert!(largest(&force) < 1e-11, "{:e}", largest(&force));
}

#[test]
fn unbounded_motions_are_explained_in_words() {
    let mut scene = plane_above(0.0);
    scene["supports"] = json!([{"on": {"boundary": "left"}, "x": 0}]);
    let model = built(&scene);
    let nodes = model.mesh().nodes().to_vec();
    let restricted = |field: &dyn Fn([f64; 2]) -> [f64; 2]| -> Vec<f64> {
        let nodal: Vec<f64> = nodes.iter().flat_map(|&[x, y, _]| field([x, y])).collect();
        model.dofs().restrict(&nodal).unwrap()
    };
    let explained = |direction: Vec<f64>| match model
        .explain(Error::Qp(qp::Error::Unbounded { mode: "column 3".into(), direction }))
    {
        Error::Qp(qp::Error::Unbounded { mode, .. }) => mode,
        other => other.to_string(),
    };
    assert_eq!(explained(restricted(&|_| [0.0, -3.0])), "translation along -y");
    assert_eq!(explained(restricted(&|[x, y]| [0.0, x * y])), "column 3", "this field is not a rigid-body mode");
    assert_eq!(explained(vec![1.0]), "column 3", "the direction has the wrong length");
    assert_eq!(explained(vec![f64::NAN; model.problem().dofs()]), "column 3");
    let free_of_supports = |field: &dyn Fn([f64; 2]) -> [f64; 2]| {
        // Rows at supported nodes do not count: here the only support is at one point, the centre of the rotation.
        let mut scene = plane_above(0.0);
        scene["supports"] = json!([{"on": {"point": [0.25, 0]}, "x": 0, "y": 0}]);
        let model = built(&scene);
        let nodal: Vec<f64> = model.mesh().nodes().iter().flat_map(|&[x, y, _]| field([x, y])).collect();
        let direction = model.dofs().restrict(&nodal).unwrap();
        match model.explain(Error::Qp(qp::Error::UnderHeld { mode: "?".into(), direction })) {
            Error::Qp(qp::Error::UnderHeld { mode, .. }) => mode,
            other => other.to_string(),
        }
    };
    let mode = free_of_supports(&|[x, y]| [-y, x - 0.25]);
    let expected = "rotation about z through (0.25, 0): a frictionless obstacle does not hold it, add a guide, such as \
                    {\"on\": {\"boundary\": \"left\"}, \"x\": 0, \"y\": 0} in `supports`";
    assert_eq!(mode, expected);
}

#[test]
fn near_incompressibility_and_missing_rows_are_warned_of() {
    let mut scene = plane_above(0.0);
    assert_eq!(built(&scene).warnings(), []);
    scene["material"]["poisson"] = json!(0.495);
    let model = built(&scene);
    assert!(matches!(model.warnings(), [Warning { code: "nearly-incompressible", .. }]), "{:?}", model.warnings());
    assert!(model.warnings()[0].message.starts_with("Poisson's ratio 0.495 locks Q4 elements"));
    assert!(model.warnings()[0].message.contains("finer mesh"));
    scene["model"] = json!("plane-stress");
    assert_eq!(built(&scene).warnings(), []);
    scene["obstacles"][0]["shape"] = json!({"circle": {"apex": [9, 1], "radius": 1}});
    assert!(matches!(built(&scene).warnings(), [Warning { code: "no-contact-row", .. }]));
    assert_eq!(built(&scene).problem().rows(), 0);
}

#[test]
fn a_change_of_units_by_powers_of_two_changes_the_problem_bit_by_bit() {
    // Lengths times b, stress times a: then K times a (per thickness), gap times b, load times a b.
    let (a, b) = (2_f64.powi(17), 2_f64.powi(-10));
    let scaled = |a: f64, b: f64| -> Model {
        let mut scene = loaded(-0.05 * b);
        scene["body"]["rectangle"]["x"]["points"] = json!([0.0, b]);
        scene["body"]["rectangle"]["y"]["points"] = json!([0.0, b]);
        scene["material"]["young"] = json!(1000.0 * a);
        scene["supports"][0]["x"] = json!(0.01 * b);
        scene["supports"][0]["y"] = json!(-0.02 * b);
        scene["supports"][1]["on"]["point"] = json!([0.0, b]);
        scene["loads"] = json!([{"traction": {"boundary": "left", "value": [3.0 * a, -a]}}]);
        scene["obstacles"][0]["shape"]["plane"]["point"] = json!([0.5 * b, b]);
        scene["obstacles"][1]["shape"]["parabola"] = json!({"apex": [b, 0.4 * b], "radius": 2.0 * b});
        built(&scene)
    };
    let (reference, other) = (scaled(1.0, 1.0), scaled(a, b));
    let times = |values: &[f64], factor: f64| values.iter().map(|value| value * factor).collect::<Vec<f64>>();
    let (k, k_other) = (reference.problem().stiffness().lower(), other.problem().stiffness().lower());
    assert_eq!(times(k.values(), a), k_other.values());
    assert_eq!(times(reference.problem().load(), a * b), other.problem().load());
    assert_eq!(times(reference.problem().gap(), b), other.problem().gap());
    assert_eq!(reference.problem().contact(), other.problem().contact());
}

#[test]
fn scenes_in_extreme_units_are_refused_or_built_with_finite_numbers() {
    for (length, young) in [(1e-150, 1e300), (1e-150, 1e-300), (1e150, 1e7), (1e-9, 1e-300), (1e300, 1e7), (1.0, 1e308)]
    {
        let mut scene = plane_above(-0.01 * length);
        scene["body"]["rectangle"]["x"]["points"] = json!([0.0, length]);
        scene["body"]["rectangle"]["y"]["points"] = json!([0.0, length]);
        scene["obstacles"][0]["shape"]["plane"]["point"] = json!([0.0, length]);
        scene["material"]["young"] = json!(young);
        match Scene::from_json(&scene.to_string(), "scene").unwrap().build() {
            Ok(model) => {
                let k = model.problem().stiffness().lower().values();
                assert!(k.iter().all(|value| value.is_finite()) && largest(k) > 0.1 * young, "{length:e} {young:e}");
                let gap = vec![-0.01 * length; 5];
                assert!(difference(model.problem().gap(), &gap) <= 1e-14 * length, "{length:e} {young:e}");
            }
            Err(error) => assert!(young == 1e308 || length == 1e300, "{length:e} {young:e}: {error}"),
        }
    }
}

/// A number is read as the nearest double.
#[test]
fn numbers_of_a_scene_are_read_to_the_last_bit() {
    for digits in 1..400_u32 {
        // Numbers of seventeen digits between 1e-20 and 1e20.
        let gap = f64::from(digits).sqrt() * 10_f64.powi(digits as i32 % 41 - 20);
        let text = plane_above(-1.0).to_string().replace("\"gap\":-1.0", &format!("\"gap\":-{gap:.17e}"));
        assert_eq!(Scene::from_json(&text, "scene").unwrap().gap, -gap, "{gap:.17e}");
    }
}
