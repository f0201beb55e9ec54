//! Two elastic bodies in contact node to node, compared with the equivalent rigid obstacle, closed forms and Hertz.

use serde_json::{Value, json};
use signorini::{Error, Model, Scene, Solution, qp, solve_qp};
use support::closed_forms::LineContact;
use support::scenes::{build, built};

/// Two solves of one problem in different unknowns differ by rounding times the condition number of these meshes.
const ROUNDING: f64 = 1e-10;

fn solved(value: &Value) -> (Model, Solution) {
    let model = built(value);
    let solution = solve_qp(model.problem()).map_err(|error| model.explain(error)).unwrap();
    let balance = model.force_balance(&solution.displacement, &solution.multiplier).unwrap();
    assert!(balance < 1e-12, "{balance:e}");
    (model, solution)
}

fn refused(value: &Value, place: &str, phrases: &[&str]) {
    let built = build(value);
    match built.unwrap_err() {
        Error::Scene { path, message } | Error::Refused { path, message, .. } => {
            assert_eq!(path, place, "{message}");
            phrases.iter().for_each(|phrase| assert!(message.contains(phrase), "{message}"));
        }
        other => panic!("{other:?}"),
    }
}

fn half_disc(half: &str, element: &str) -> Value {
    let centre = if half == "lower" { 1.0 } else { -1.0 };
    let zone = json!({"width": 0.16, "divisions": 16, "growth": 1.3});
    json!({"half-disc": {"half": half, "centre": [0, centre], "radius": 1, "zone": zone, "symmetric": true,
                         "element": element, "integration": "standard"}})
}

/// Two half cylinders, one above the other; the upper cut moves down by `approach`, the lower cut is fixed.
fn pair_of_discs(moduli: [f64; 2], ratios: [f64; 2], approach: f64, element: &str) -> Value {
    json!({
        "body": half_disc("lower", element), "material": {"young": moduli[0], "poisson": ratios[0]},
        "further-bodies": [{"name": "base", "body": half_disc("upper", element),
                            "material": {"young": moduli[1], "poisson": ratios[1]}}],
        "supports": [{"on": {"boundary": "cut"}, "y": -approach}, {"on": {"boundary": "symmetry-x"}, "x": 0},
                     {"on": {"boundary": "base.cut"}, "y": 0},
                     {"on": {"boundary": "base.symmetry-x"}, "x": 0}],
        "obstacles": [{"boundary": "arc", "approach": "-y", "shape": {"body": {"boundary": "base.arc"}}}],
    })
}

/// GOAL: contact of two equal bodies.
/// CONDITIONS: two half cylinders that approach by 0.01, against one on a rigid plane that approaches by half of it.
/// REFERENCE: symmetry: the same rows, forces and displacements.
#[test]
fn two_equal_bodies_have_the_answer_of_one_body_on_a_rigid_plane_at_half_the_approach() {
    for element in ["t3", "q4", "t6", "q8"] {
        let (pair, of_pair) = solved(&pair_of_discs([1.0, 1.0], [0.3, 0.3], 0.01, element));
        let rigid = json!({
            "body": half_disc("lower", element), "material": {"young": 1, "poisson": 0.3},
            "supports": [{"on": {"boundary": "cut"}, "y": -0.005}, {"on": {"boundary": "symmetry-x"}, "x": 0}],
            "obstacles": [{"boundary": "arc", "approach": "-y",
                           "shape": {"plane": {"point": [0, 0], "normal": [0, -1]}}}],
        });
        let (one, of_one) = solved(&rigid);
        assert_eq!(of_pair.contact_set, of_one.contact_set, "{element}");
        assert!(of_one.contact_set.count() > 5);
        let largest = of_one.multiplier.iter().fold(0.0_f64, |largest, lambda| largest.max(lambda.abs()));
        for (ours, theirs) in of_pair.multiplier.iter().zip(&of_one.multiplier) {
            assert!((ours - theirs).abs() < ROUNDING * largest, "{element}: {ours} {theirs}");
        }
        // The lower body is the mirror image of the upper one, moved by half the approach.
        let nodal = pair.nodal_displacement(&of_pair.displacement).unwrap();
        let single = one.nodal_displacement(&of_one.displacement).unwrap();
        let nodes = one.mesh().nodes().len();
        for node in 0..nodes {
            let [x, y] = [single[2 * node], single[2 * node + 1]];
            // Both displacements relative to the motion of the middle plane.
            let upper = [nodal[2 * node], nodal[2 * node + 1] + 0.005];
            let lower = [nodal[2 * (nodes + node)], -(nodal[2 * (nodes + node) + 1] + 0.005)];
            for found in [upper, lower] {
                let away = (found[0] - x).abs().max((found[1] - y).abs());
                assert!(away < ROUNDING * 0.01, "{element}, node {node}: {found:?} instead of {:?}", [x, y]);
            }
        }
    }
}

/// GOAL: the contact of two elastic cylinders.
/// CONDITIONS: plane strain; equal radii of 1, E = 1 and 3, nu = 0.3 and 0.2; the cuts approach by 0.012.
/// REFERENCE: Hertz with 1/E* = 1/E1' + 1/E2' and R = 1/2; each half is compressed by F/(pi E') (2 ln(4R/a) - 1).
#[test]
fn cylinders_of_two_materials_have_the_force_and_pressure_of_hertz() {
    let (moduli, ratios, approach) = ([1.0, 3.0], [0.3, 0.2], 0.012);
    let plane = [0, 1].map(|body: usize| moduli[body] / (1.0 - ratios[body] * ratios[body]));
    let contact = LineContact { modulus: 1.0 / (1.0 / plane[0] + 1.0 / plane[1]), radius: 0.5 };
    // Each half cylinder is compressed by F/(pi E*) (2 ln(4R/a) - 1), with its own modulus and radius, and with the
    // common a.
    let sum = |force: f64| {
        let logarithm = 2.0 * (4.0 / contact.half_width(force)).ln() - 1.0;
        plane.iter().map(|modulus| force / (std::f64::consts::PI * modulus) * logarithm).sum::<f64>()
    };
    let mut force = 1e-3;
    for _ in 0..100 {
        force *= approach / sum(force);
    }
    assert!((sum(force) / approach - 1.0).abs() < 1e-12);
    // The linear elements of this mesh resolve the edge of the contact to one cell, a tenth of the half-width.
    for (element, of_force, of_pressure) in [("t6", 2e-3, 1e-2), ("q8", 2e-3, 1e-2), ("q4", 1e-2, 2e-2)] {
        let (model, solution) = solved(&pair_of_discs(moduli, ratios, approach, element));
        let found = -2.0 * solution.multiplier.iter().sum::<f64>();
        assert!((found / force - 1.0).abs() < of_force, "{element}: force {found} instead of {force}");
        let pressure = model.pressure(&solution.multiplier).unwrap();
        let exact = contact.peak_pressure(force);
        let peak = pressure.iter().copied().fold(0.0, f64::max);
        assert!((peak / exact - 1.0).abs() < of_pressure, "{element}: pressure {peak} instead of {exact}");
    }
}

/// A body of height 1 on another of height 2, pressed together by 0.01 between rollers.
fn stack(model: &str, bodies: [Value; 2], sides: &[(&str, &str)]) -> Value {
    let (up, top, bottom) = match model {
        "bar" => ("x", "right", "left"),
        "space" => ("z", "top", "bottom"),
        _ => ("y", "top", "bottom"),
    };
    let [upper, lower] = bodies;
    let mut supports =
        vec![json!({"on": {"boundary": top}, up: -0.01}), json!({"on": {"boundary": format!("base.{bottom}")}, up: 0})];
    for (side, axis) in sides {
        supports.push(json!({"on": {"boundary": side}, *axis: 0}));
        supports.push(json!({"on": {"boundary": format!("base.{side}")}, *axis: 0}));
    }
    json!({
        "model": model, "body": upper, "material": {"young": 2.0, "poisson": 0.25},
        "further-bodies": [{"name": "base", "body": lower, "material": {"young": 5.0, "poisson": 0.4}}],
        "supports": supports,
        "obstacles": [{"boundary": bottom, "approach": format!("-{up}"),
                       "shape": {"body": {"boundary": format!("base.{top}")}}}],
    })
}

/// GOAL: the contact patch test of two bodies node to node.
/// CONDITIONS: stacks of two blocks, discs or bars of two materials with one mesh along their contact, compressed;
/// every dimension and element.
/// REFERENCE: columns in series: the same uniform pressure everywhere.
#[test]
fn two_bodies_pressed_together_have_the_exact_uniform_pressure() {
    let axis = |points: [f64; 2], divisions: usize| json!({"points": points, "divisions": [divisions]});
    let across = || json!({"points": [0, 0.4, 1.5], "divisions": [2, 1]});
    let mut cases = Vec::new();
    for element in ["t3", "q4", "t6", "q8"] {
        let body = |y: [f64; 2]| json!({"rectangle": {"x": across(), "y": axis(y, 3), "element": element}});
        let bodies = || [body([2.0, 3.0]), body([0.0, 2.0])];
        cases.push((stack("plane-strain", bodies(), &[("left", "x")]), true, 1.5));
        cases.push((stack("plane-stress", bodies(), &[("left", "x")]), false, 1.5));
        cases.push((stack("axisymmetric", bodies(), &[]), false, std::f64::consts::PI * 2.25));
    }
    for element in ["tet4", "hex8"] {
        let body = |z: [f64; 2]| json!({"box": {"x": across(), "y": across(), "z": axis(z, 2), "element": element}});
        cases.push((
            stack("space", [body([2.0, 3.0]), body([0.0, 2.0])], &[("left", "x"), ("front", "y")]),
            false,
            2.25,
        ));
    }
    let bar = |x: [f64; 2]| json!({"bar": {"x": axis(x, 4), "area": 0.5}});
    cases.push((stack("bar", [bar([2.0, 3.0]), bar([0.0, 2.0])], &[]), false, 0.5));
    for (value, confined, area) in cases {
        let (model, solution) = solved(&value);
        let modulus = |young: f64, poisson: f64| if confined { young / (1.0 - poisson * poisson) } else { young };
        let expected = 0.01 / (1.0 / modulus(2.0, 0.25) + 2.0 / modulus(5.0, 0.4));
        for pressure in model.pressure(&solution.multiplier).unwrap() {
            assert!((pressure / expected - 1.0).abs() < ROUNDING, "{value}: {pressure} instead of {expected}");
        }
        let force = -solution.multiplier.iter().sum::<f64>();
        assert!((force / (expected * area) - 1.0).abs() < ROUNDING, "{value}: {force}");
        for stress in model.stress(&solution.displacement).unwrap().nodes {
            let along =
                if model.mesh().dimension() == 1 { stress.sigma_xx } else { stress.sigma_2.min(stress.sigma_3) };
            assert!((along / expected + 1.0).abs() < 1e-8, "{value}: {stress:?}");
        }
    }
}

/// Two quarter rings, the outer one shrunk onto the inner one by `interference`.
fn shrink_fit(candidates: &str, other: &str, interference: f64, element: &str) -> Value {
    let ring = |from: f64, to: f64| {
        json!({"ring": {"radius": {"points": [from, to], "divisions": [6]}, "element": element,
                        "angle": {"points": [0, 90], "divisions": [16]}}})
    };
    let supports: Vec<Value> = [("start", "y"), ("end", "x"), ("sleeve.start", "y"), ("sleeve.end", "x")]
        .iter()
        .map(|(side, axis)| json!({"on": {"boundary": side}, *axis: 0}))
        .collect();
    json!({
        "body": ring(1.0, 2.0), "material": {"young": 2.0, "poisson": 0.3},
        "further-bodies": [{"name": "sleeve", "body": ring(2.0 - interference, 3.0),
                            "material": {"young": 1.0, "poisson": 0.2}}],
        "supports": supports,
        "obstacles": [{"boundary": candidates, "approach": "+x", "rule": "closest-point",
                       "shape": {"body": {"boundary": other}}}],
    })
}

/// GOAL: a sleeve shrunk onto a ring.
/// CONDITIONS: plane strain; radii 1, 2, 3 and the interference 1e-4; the rows on either body.
/// REFERENCE: Lamé: p = delta/b over the sum of the radial compliances of both rings.
#[test]
fn a_shrink_fit_has_the_pressure_of_lame() {
    let (a, b, c, interference): (f64, f64, f64, f64) = (1.0, 2.0, 3.0, 1e-4);
    // Radial compliance of a ring under a pressure at b in plane strain: E' = E/(1 - nu^2), nu' = nu/(1 - nu).
    let compliance = |young: f64, poisson: f64, other: f64, sign: f64| {
        let (modulus, ratio) = (young / (1.0 - poisson * poisson), poisson / (1.0 - poisson));
        ((b * b + other * other) / (other * other - b * b).abs() + sign * ratio) / modulus
    };
    let exact = interference / b / (compliance(2.0, 0.3, a, -1.0) + compliance(1.0, 0.2, c, 1.0));
    let (model, solution) = solved(&shrink_fit("outer", "sleeve.inner", interference, "q8"));
    assert_eq!(solution.contact_set.count(), model.rows().len());
    for pressure in model.pressure(&solution.multiplier).unwrap() {
        // Quadratic elements of 6 degrees; the overlap changes the geometry by about the interference.
        assert!((pressure / exact - 1.0).abs() < 1e-3, "{pressure} instead of {exact}");
    }
    // The same rows with the roles of the bodies exchanged.
    let (_, reversed) = solved(&shrink_fit("sleeve.inner", "outer", interference, "q8"));
    let largest = solution.displacement.iter().fold(0.0_f64, |largest, u| largest.max(u.abs()));
    for (ours, theirs) in solution.displacement.iter().zip(&reversed.displacement) {
        assert!((ours - theirs).abs() < ROUNDING * largest);
    }
}

#[test]
fn bodies_without_contact_or_load_do_not_move() {
    let mut value = pair_of_discs([1.0, 1.0], [0.3, 0.3], 0.0, "q4");
    value["gap"] = json!(0.1);
    let (_, solution) = solved(&value);
    assert!(solution.displacement.iter().all(|&u| u == 0.0) && solution.contact_set.count() == 0);
}

#[test]
fn an_under_held_body_is_named() {
    let mut value = stack(
        "plane-strain",
        [2.0, 0.0].map(|y| {
            json!({"rectangle": {"x": {"points": [0, 1], "divisions": [2]}, "y": {"points": [y, y + 1.0], "divisions": [2]}}})
        }),
        &[("left", "x")],
    );
    value["further-bodies"][0]["body"]["rectangle"]["y"]["points"] = json!([1, 2]);
    let supports = value["supports"].as_array().unwrap().clone();
    let without = |name: &str| supports.iter().filter(|support| support["on"]["boundary"] != name).cloned().collect();
    for (missing, named) in
        [("base.left", "translation along x of `base`"), ("left", "translation along x of the first body")]
    {
        let mut scene = value.clone();
        scene["supports"] = Value::Array(without(missing));
        let built = Scene::from_json(&scene.to_string(), "scene").unwrap().build();
        let Err(Error::Qp(qp::Error::UnderHeld { mode, .. })) = built else { panic!("{built:?}") };
        assert!(mode.starts_with(named), "{mode}");
    }
    // The upper body, resting on the base and pressed by a load, only needs a guide.
    let mut scene = value.clone();
    scene["supports"] = Value::Array(without("top"));
    scene["loads"] = json!([{"traction": {"boundary": "top", "value": [0, -0.01]}}]);
    let (model, solution) = solved(&scene);
    for pressure in model.pressure(&solution.multiplier).unwrap() {
        assert!((pressure / 0.01 - 1.0).abs() < ROUNDING);
    }
    // If the load pulls it away, it is unbounded.
    scene["loads"] = json!([{"traction": {"boundary": "top", "value": [0, 0.01]}}]);
    let model = built(&scene);
    let error = model.explain(solve_qp(model.problem()).unwrap_err());
    let Error::Qp(qp::Error::Unbounded { mode, .. }) = &error else { panic!("{error:?}") };
    assert_eq!(mode, "translation along y of the first body");
}

/// Two blocks, one on the other; the upper one has `cells` cells along each side, the lower one `below`.
fn blocks(model: &str, cells: usize, below: usize) -> Value {
    let axis = |from: f64, to: f64, cells: usize| json!({"points": [from, to], "divisions": [cells]});
    let body = |from: f64, cells: usize| match model {
        "space" => {
            json!({"box": {"x": axis(0.0, 1.0, cells), "y": axis(0.0, 1.0, cells), "z": axis(from, from + 1.0, 1)}})
        }
        _ => json!({"rectangle": {"x": axis(0.0, 1.0, cells), "y": axis(from, from + 1.0, 1)}}),
    };
    let down = if model == "space" { "-z" } else { "-y" };
    let held = json!({"x": 0, "y": 0, "z": 0});
    let hold = |boundary: &str| {
        let mut support = held.clone();
        if model != "space" {
            support.as_object_mut().unwrap().remove("z");
        }
        support["on"] = json!({"boundary": boundary});
        support
    };
    json!({
        "model": model,
        "body": body(1.0, cells),
        "further-bodies": [{"name": "base", "body": body(0.0, below), "material": {"young": 1, "poisson": 0.3}}],
        "material": {"young": 1, "poisson": 0.3},
        "supports": [hold("top"), hold("base.bottom")],
        "obstacles": [{"boundary": "bottom", "approach": down, "shape": {"body": {"boundary": "base.top"}}}],
        "gap": -0.01
    })
}

/// On the finer side, nodes between those of the other side have no row and would penetrate.
#[test]
fn surfaces_of_different_meshes_are_refused_for_either_finer_side() {
    for model in ["plane-strain", "space"] {
        solved(&blocks(model, 3, 3));
        for (cells, below) in [(2, 4), (4, 2), (3, 4)] {
            assert!(built(&blocks(model, cells, below)).rows().iter().all(|row| row.is_mean));
            let mut scene = blocks(model, cells, below);
            scene["obstacles"][0]["shape"]["body"]["rows"] = json!("pairs");
            let built = build(&scene);
            let Error::Refused { code, message, .. } = built.unwrap_err() else { panic!("{scene}") };
            assert_eq!(code, "unpaired-nodes");
            assert!(
                message.contains("node ")
                    && message.contains("must pair up, as docs/assemblies.md shows; `mortar` takes any meshes"),
                "{message}"
            );
        }
    }
    // A base that is wider than the body has nodes without a node opposite; this is allowed.
    let mut wide = blocks("plane-strain", 4, 4);
    wide["further-bodies"][0]["body"]["rectangle"]["x"] = json!({"points": [-1, 0, 1, 2], "divisions": [3, 4, 3]});
    solved(&wide);
}

/// The lower block has its nodes at thirds written in seven digits, as an export in single precision has them; with
/// three digits its nodes are a thousandth of a facet aside.
#[test]
fn pairs_with_coordinates_of_seven_digits_have_the_answer_of_exact_pairs() {
    // The strain of a body changes by about the share by which a cell does: 1e-7 times the distance from the origin.
    const SEVEN_DIGITS: f64 = 1e-6;
    for (model, axes) in [("plane-strain", &["x"][..]), ("space", &["x", "y"])] {
        for rule in ["approach", "closest-point"] {
            let rounded = |third: f64, far: f64| {
                let mut scene = blocks(model, 3, 3);
                scene["obstacles"][0]["rule"] = json!(rule);
                let shape = if model == "space" { "box" } else { "rectangle" };
                for axis in axes {
                    scene["body"][shape][axis] =
                        json!({"points": [far, far + 1.0 / 3.0, far + 1.0], "divisions": [1, 2]});
                    scene["further-bodies"][0]["body"][shape][axis] =
                        json!({"points": [far, far + third, far + 1.0], "divisions": [1, 2]});
                }
                scene
            };
            let force = |scene: &Value| -> f64 { solved(scene).1.multiplier.iter().sum() };
            let exact = force(&rounded(1.0 / 3.0, 0.0));
            for (third, far) in [(0.3333333, 0.0), (0.33333, 100.0)] {
                let near = rounded(third, far);
                assert!(built(&near).rows().iter().all(|row| !row.is_mean), "{model} {rule}");
                let off = (force(&near) / exact - 1.0).abs();
                assert!(off < SEVEN_DIGITS * (1.0 + far), "{model} {rule}: {off:e}");
            }
            let mut aside = rounded(0.332, 0.0);
            assert!(built(&aside).rows().iter().all(|row| row.is_mean));
            aside["obstacles"][0]["shape"]["body"]["rows"] = json!("pairs");
            let built = build(&aside);
            assert!(matches!(built, Err(Error::Refused { code: "unpaired-nodes", .. })), "{model} {rule}");
        }
    }
}

#[test]
fn further_bodies_that_do_not_match_are_refused() {
    let discs = || pair_of_discs([1.0, 1.0], [0.3, 0.3], 0.01, "q4");
    let change = |pointer: &str, value: Value| {
        let mut scene = discs();
        scene["obstacles"][0]["shape"]["body"]["rows"] = json!("pairs");
        *scene.pointer_mut(pointer).unwrap() = value;
        scene
    };
    let facing = "obstacles[0].shape.body.boundary";
    let further = "further-bodies[0].body.half-disc";
    refused(&change("/obstacles/0/shape/body/boundary", json!("base.top")), facing, &["`base.top`", "base.arc"]);
    refused(&change("/obstacles/0/shape/body/boundary", json!("cut")), facing, &["belong to one body"]);
    refused(&change("/obstacles/0/approach", json!("+y")), "obstacles[0].approach", &["opposite direction"]);
    refused(
        &change("/further-bodies/0/body/half-disc/zone/divisions", json!(15)),
        facing,
        &["node", "aside", "pair up"],
    );
    refused(&change("/further-bodies/0/body/half-disc/element", json!("t6")), facing, &["pair up"]);
    refused(&change("/further-bodies/0/name", json!("")), "further-bodies[0].name", &["a name"]);
    refused(&change("/further-bodies/0/material/young", json!(-1)), "further-bodies[0].material.young", &["positive"]);
    refused(&change("/further-bodies/0/body/half-disc/radius", json!(0)), &format!("{further}.radius"), &["positive"]);
    let mut twice = discs();
    let base = twice["further-bodies"][0].clone();
    twice["further-bodies"].as_array_mut().unwrap().push(base);
    refused(&twice, "further-bodies[1].name", &["`base`"]);
    let mut point = discs();
    point["supports"][0] = json!({"on": {"point": [0, 0]}, "x": 0});
    refused(&point, "supports[0].on.point", &["two bodies", "(0, 0)"]);
}
