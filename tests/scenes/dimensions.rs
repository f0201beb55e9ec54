//! GOAL: contact scenes on a line, about an axis and in space, compared with closed forms, and the scenes that are
//! refused there.

use serde_json::{Value, json};
use signorini::{Error, Model, qp, solve_qp};
use support::bodies::largest;
use support::closed_forms::Bar;
use support::scenes::{build, built};

/// Rounding times the condition number of the stiffness, below 1e4 here; closed forms must agree to this.
const CLOSED_FORM: f64 = 1e-11;

#[track_caller]
fn close(found: f64, expected: f64, scale: f64, what: &str) {
    assert!((found - expected).abs() <= CLOSED_FORM * scale, "{what}: {found:e}, expected {expected:e}");
}

fn bar(gap: f64, loads: Value) -> Value {
    json!({
        "model": "bar",
        "body": {"bar": {"x": {"points": [0, 0.7, 2], "divisions": [5, 8], "ratios": [1.5, 0.8]}, "area": 0.1}},
        "material": {"young": 1e3, "poisson": 0.3},
        "supports": [{"on": {"boundary": "left"}, "x": 0}],
        "loads": loads,
        "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [2], "normal": [1]}}}],
        "gap": gap
    })
}

/// GOAL: an elastic bar against a wall, as a model on a line.
/// CONDITIONS: an end force as force, traction and pressure, and a load per length; gaps that close, just close, stay
/// open, and are negative.
/// REFERENCE: `closed_forms::Bar`, exact at the nodes.
#[test]
fn a_bar_against_a_wall_is_exact_at_its_nodes() {
    for gap in [0.03, 0.5, 0.08, -0.01] {
        let closed = Bar { length: 2.0, axial_stiffness: 100.0, gap };
        for (loads, by_end) in [
            (json!([{"force": {"at": [2], "value": [4]}}]), true),
            (json!([{"traction": {"boundary": "right", "value": [40]}}]), true),
            (json!([{"pressure": {"boundary": "right", "value": -40}}]), true),
            (json!([{"body-force": [40]}]), false),
        ] {
            let model = built(&bar(gap, loads));
            let solution = solve_qp(model.problem()).unwrap();
            let reaction =
                if by_end { closed.reaction_to_end_force(4.0) } else { closed.reaction_to_distributed_load(4.0) };
            close(solution.contact_force(), reaction, 4.0, "R");
            close(model.pressure(&solution.multiplier).unwrap()[0], reaction / 0.1, 40.0, "p");
            let nodal = model.nodal_displacement(&solution.displacement).unwrap();
            for (u, &[x, ..]) in nodal.iter().zip(model.mesh().nodes()) {
                let expected = if by_end {
                    closed.displacement_under_end_force(4.0, x)
                } else {
                    closed.displacement_under_distributed_load(4.0, x)
                };
                close(*u, expected, 0.08, "u");
            }
            assert!(model.force_balance(&solution.displacement, &solution.multiplier).unwrap() < 1e-12);
        }
    }
}

/// A block of 1 x 0.8 x 0.6, pressed onto the plane below it and guided at two sides, on a graded mesh.
fn block(element: &str, integration: &str) -> Value {
    json!({
        "model": "space",
        "body": {"box": {
            "x": {"points": [0, 0.3, 1], "divisions": [2, 2], "ratios": [2.0, 0.7]},
            "y": {"points": [0, 0.8], "divisions": [3], "ratios": [0.4]},
            "z": {"points": [0, 0.6], "divisions": [3], "ratios": [1.7]},
            "element": element,
            "integration": integration
        }},
        "material": {"young": 2e5, "poisson": 0.3},
        "supports": [{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "front"}, "y": 0}],
        "loads": [{"pressure": {"boundary": "top", "value": 300}}],
        "obstacles": [{"boundary": "bottom", "approach": "-z", "rule": "closest-point",
            "shape": {"plane": {"point": [7, 7, 0], "normal": [0, 0, -2]}}}]
    })
}

/// Checks a uniform pressure p: the strain is -p/E along the axis `down`, and nu p/E perpendicular to it.
fn check_patch(model: &Model, down: usize, what: &str) {
    let (young, nu, p) = (2e5, 0.3, 300.0);
    let solution = solve_qp(model.problem()).unwrap();
    for pressure in model.pressure(&solution.multiplier).unwrap() {
        close(pressure, p, p, &format!("{what}: pressure"));
    }
    let dimension = model.mesh().dimension();
    let nodal = model.nodal_displacement(&solution.displacement).unwrap();
    for (node, at) in model.mesh().nodes().iter().enumerate() {
        for axis in 0..dimension {
            let strain = if axis == down { -p / young } else { nu * p / young };
            close(nodal[dimension * node + axis], strain * at[axis], p / young, &format!("{what}: u"));
        }
    }
    for stress in model.stress(&solution.displacement).unwrap().nodes {
        let normal = [stress.sigma_xx, stress.sigma_yy, stress.sigma_zz];
        for (axis, value) in normal.into_iter().enumerate() {
            close(value, if axis == down { -p } else { 0.0 }, p, &format!("{what}: sigma"));
        }
        close(stress.von_mises, p, p, &format!("{what}: von Mises"));
    }
    let balance = model.force_balance(&solution.displacement, &solution.multiplier).unwrap();
    assert!(balance < 1e-12, "{what}: balance {balance:e}");
}

/// GOAL: the contact patch test in space.
/// CONDITIONS: a block on a plane under a uniform load; Hex8, also with mean dilatation, and Tet4.
/// REFERENCE: uniaxial stress: u_z = -p z/E, and nu p/E across it.
#[test]
fn uniform_pressure_in_space_is_exact_on_every_mesh() {
    for (element, integration) in [("hex8", "standard"), ("hex8", "mean-dilatation"), ("tet4", "standard")] {
        let model = built(&block(element, integration));
        assert!(model.rows().iter().all(|row| row.normal == [0.0, 0.0, -1.0] && row.tributary_area > 0.0));
        check_patch(&model, 2, &format!("{element} {integration}"));
    }
}

fn disc(element: &str, integration: &str) -> Value {
    json!({
        "model": "axisymmetric",
        "body": {"rectangle": {
            "x": {"points": [0, 0.3, 1], "divisions": [3, 4], "ratios": [2.0, 0.7]},
            "y": {"points": [0, 0.8], "divisions": [5], "ratios": [0.4]},
            "element": element,
            "integration": integration
        }},
        "material": {"young": 2e5, "poisson": 0.3},
        "loads": [{"traction": {"boundary": "top", "value": [0, -300]}}],
        "obstacles": [{"boundary": "bottom", "approach": "-y",
            "shape": {"plane": {"point": [0, 0], "normal": [0, -1]}}}]
    })
}

/// GOAL: the contact patch test about an axis.
/// CONDITIONS: a disc on a plane under a uniform load, without a support; every element of the plane.
/// REFERENCE: uniaxial stress: u_y = -p y/E, u_r = nu p r/E.
#[test]
fn uniform_pressure_on_a_disc_is_exact_on_every_mesh_and_needs_no_support() {
    for (element, integration) in
        [("t3", "standard"), ("t6", "standard"), ("q4", "standard"), ("q4", "mean-dilatation"), ("q8", "standard")]
    {
        let model = built(&disc(element, integration));
        check_patch_of_disc(&model, &format!("{element} {integration}"));
    }
}

/// The corner of a quadratic element on the axis has no tributary area, but it has a pressure.
fn check_patch_of_disc(model: &Model, what: &str) {
    let solution = solve_qp(model.problem()).unwrap();
    close(solution.contact_force(), 300.0 * std::f64::consts::PI, 1e3, &format!("{what}: full circle"));
    let young = 2e5;
    for (row, (lambda, pressure)) in
        model.rows().iter().zip(solution.multiplier.iter().zip(model.pressure(&solution.multiplier).unwrap()))
    {
        close(-lambda, 300.0 * row.tributary_area, 1e3, &format!("{what}: multiplier"));
        close(pressure, 300.0, 300.0, &format!("{what}: pressure of {row:?}"));
    }
    let nodal = model.nodal_displacement(&solution.displacement).unwrap();
    for (node, &[r, y, _]) in model.mesh().nodes().iter().enumerate() {
        close(nodal[2 * node], 0.3 * 300.0 / young * r, 300.0 / young, &format!("{what}: u_r"));
        close(nodal[2 * node + 1], -300.0 / young * y, 300.0 / young, &format!("{what}: u_y"));
    }
    for stress in model.stress(&solution.displacement).unwrap().elements {
        close(stress.sigma_yy, -300.0, 300.0, &format!("{what}: sigma_yy"));
        close(stress.sigma_zz, 0.0, 300.0, &format!("{what}: hoop"));
    }
    let balance = model.force_balance(&solution.displacement, &solution.multiplier).unwrap();
    assert!(balance < 1e-12, "{what}: balance {balance:e}");
}

fn refused(scene: &Value) -> Error {
    match build(scene) {
        Err(error) => error,
        Ok(_) => panic!("accepted: {scene}"),
    }
}

#[test]
fn rigid_body_motions_without_support_are_named_in_every_dimension() {
    let mut floating = block("hex8", "standard");
    floating["supports"] = json!([]);
    let mut wall = bar(0.0, json!([]));
    wall["supports"] = json!([]);
    wall["obstacles"] = json!([]);
    let mut ring = disc("q4", "standard");
    ring["obstacles"] = json!([]);
    let mut pinned = block("hex8", "standard");
    pinned["obstacles"] = json!([]);
    pinned["supports"] = json!([{"on": {"point": [0, 0, 0]}, "x": 0, "y": 0, "z": 0},
        {"on": {"point": [0, 0, 0.6]}, "x": 0, "y": 0}]);
    for (scene, motion) in [
        (
            floating,
            "translation along x, translation along y, rotation about z through (0.5, 0.4, 0.3): a frictionless",
        ),
        (wall, "translation along x: add a support"),
        (ring, "translation along y: add a support"),
        (pinned, "rotation about z through (0, 0, 0.3): add a support"),
    ] {
        match refused(&scene) {
            Error::Qp(qp::Error::UnderHeld { mode: found, direction }) => {
                assert!(found.starts_with(motion), "{found}");
                assert!(largest(&direction) > 0.1);
            }
            other => panic!("{other}"),
        }
    }
}

#[test]
fn fields_that_do_not_match_the_dimension_are_refused_at_their_path() {
    let with = |mut scene: Value, pointer: &str, value: Value| {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        let place = scene.pointer_mut(parent).unwrap();
        match place {
            Value::Array(items) => items[key.parse::<usize>().unwrap()] = value,
            object => object[key] = value,
        }
        scene
    };
    let (line, ring, space) = (|| bar(0.0, json!([])), || disc("q4", "standard"), || block("hex8", "standard"));
    let circle = json!({"circle": {"apex": [0, 0], "radius": 1}});
    let force = json!([{"force": {"at": [1, 1, 1], "value": [0, 1]}}]);
    for (scene, path, phrase) in [
        (
            with(line(), "/model", json!("space")),
            "body.bar",
            "a bar does not fit the model `space`; a body of this model is a box",
        ),
        (with(space(), "/model", json!("plane-strain")), "body.box", "a body of this model is a rectangle"),
        (with(ring(), "/model", json!("bar")), "body.rectangle", "a body of this model is a bar or gmsh"),
        (with(space(), "/thickness", json!(2)), "thickness", "has no thickness"),
        (with(line(), "/body/bar/area", json!(0)), "body.bar.area", "positive"),
        (with(line(), "/supports/0/y", json!(0)), "supports[0].y", "the model `bar` has no y"),
        (with(ring(), "/supports", json!([{"on": {"boundary": "top"}, "z": 0}])), "supports[0].z", "has no z"),
        (
            with(ring(), "/supports", json!([{"on": {"boundary": "left"}, "x": 1}])),
            "supports[0].x",
            "axis of revolution",
        ),
        (with(ring(), "/body/rectangle/x/points", json!([-1, 0, 1])), "body.rectangle", "radius x = -1e0"),
        (
            with(ring(), "/loads", force.clone()),
            "loads[0].force.at",
            "has 3 entries, but must have 2 in a plane or axisymmetric model: [x, y]",
        ),
        (with(space(), "/loads", json!([{"body-force": [1]}])), "loads[0].body-force", "[x, y, z]"),
        (with(ring(), "/obstacles/0/approach", json!("+z")), "obstacles[0].approach", "which has x and y"),
        (with(space(), "/obstacles/0/shape", circle.clone()), "obstacles[0].shape", "`circle` is a shape of the plane"),
        (with(line(), "/obstacles/0/shape", circle), "obstacles[0].shape", "on a line there are `plane` and `body`"),
        (
            with(space(), "/obstacles/0/shape/plane/normal", json!([0, 1, 0])),
            "obstacles[0].shape.plane.normal",
            "approach direction (0, 0, -1)",
        ),
        (with(space(), "/material/poisson", json!(0.5)), "material.poisson", "below 0.5 in space"),
        (block("tet4", "mean-dilatation"), "body.box.integration", "not for Tet4"),
        (disc("t6", "mean-dilatation"), "body.rectangle.integration", "not for T6"),
    ] {
        let error = refused(&scene);
        let Error::Scene { path: found, message } = &error else { panic!("{path}: {error}") };
        assert_eq!(found, path, "{error}");
        assert!(message.contains(phrase), "{error}\n  lacks: {phrase}");
    }
}

#[test]
fn near_incompressibility_is_warned_of_except_with_mean_dilatation() {
    let warnings = |mut scene: Value, poisson: f64| {
        scene["material"]["poisson"] = json!(poisson);
        built(&scene).warnings().to_vec()
    };
    for (scene, element) in [(block("hex8", "standard"), "Hex8"), (disc("q8", "standard"), "Q8")] {
        let found = warnings(scene, 0.4999);
        assert!(found.len() == 1 && found[0].code == "nearly-incompressible", "{found:?}");
        assert!(found[0].message.contains(&format!("0.4999 locks {element} elements")), "{found:?}");
        assert!(found[0].message.contains("mean-dilatation"), "{found:?}");
    }
    for scene in [block("hex8", "mean-dilatation"), disc("q4", "mean-dilatation"), bar(0.0, json!([]))] {
        assert_eq!(warnings(scene, 0.4999), []);
    }
    assert_eq!(warnings(disc("q8", "standard"), 0.495), []);
}

#[test]
fn the_approach_rule_in_space_measures_the_gap_along_its_axis() {
    let mut scene = block("hex8", "standard");
    scene["obstacles"][0] = json!({"boundary": "bottom", "approach": "-z",
        "shape": {"plane": {"point": [0, 0, -0.1], "normal": [0.3, 0.4, -1]}}});
    scene["gap"] = json!(0.05);
    let model = built(&scene);
    for row in model.rows() {
        // The equation of the plane is 0.3 x + 0.4 y - (z + 0.1) = 0.
        let [x, y, z] = model.mesh().nodes()[row.node];
        let surface = 0.3 * x + 0.4 * y - 0.1;
        assert_eq!(row.normal, [0.0, 0.0, -1.0]);
        assert!((row.gap - (z - surface + 0.05)).abs() < 1e-14, "{row:?}");
    }
}
