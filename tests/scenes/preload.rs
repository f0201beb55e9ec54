//! Preloads of bolts, compared with bars and springs in closed form.

use std::sync::Arc;

use serde_json::{Value, json};
use signorini::scene::{Answer, Resultant};
use signorini::study::Summary;
use signorini::{Error, solve_qp};
use support::draws::Draws;
use support::scenes::{answer, build};
use support::{cases, seed};

/// Rounding of a solve with some hundred unknowns, relative to the largest value.
const ROUNDING: f64 = 1e-11;

/// As [`ROUNDING`], where surfaces with other meshes are integrated.
const INTEGRATED: f64 = 1e-9;

const YOUNG: f64 = 200.0;

fn cells(from: f64, to: f64, count: usize) -> Value {
    json!({"points": [from, to], "divisions": [count]})
}

fn tie(answer: &Answer) -> Resultant {
    answer.resultants().unwrap().iter().find(|one| one.of == "ties[0]").unwrap().clone()
}

/// A bar of length 5 along the last axis, cut at 2, held at both ends; its cross-section is 1 x 1.
fn bar(element: &str, counts: [usize; 2], poisson: f64, preload: &Value) -> Value {
    let body = |[from, to]: [f64; 2], count: usize| match element.len() {
        2 => json!({"rectangle": {"x": cells(0.0, 1.0, count), "y": cells(from, to, 3), "element": element}}),
        _ => {
            json!({"box": {"x": cells(0.0, 1.0, count), "y": cells(0.0, 1.0, 2), "z": cells(from, to, 2), "element": element}})
        }
    };
    let (model, held) = if element.len() == 2 {
        ("plane-stress", json!({"x": 0, "y": 0}))
    } else {
        ("space", json!({"x": 0, "y": 0, "z": 0}))
    };
    let material = json!({"young": YOUNG, "poisson": poisson});
    let support = |name: &str| {
        let mut support = held.clone();
        support["on"] = json!({"boundary": name});
        support
    };
    json!({
        "model": model, "body": body([0.0, 2.0], counts[0]), "material": material,
        "further-bodies": [{"name": "far", "body": body([2.0, 5.0], counts[1]), "material": material}],
        "supports": [support("bottom"), support("far.top")],
        "ties": [{"preload": preload}], "loads": [],
    })
}

fn preload(key: &str, value: f64) -> Value {
    json!({"boundary": "top", "to": "far.bottom", key: value})
}

/// GOAL: a bolt between fixed walls.
/// CONDITIONS: a bar of length 2 + 3 with nu = 0, cut at 2; a tension of 3, or its shortening; all elements, meshes
/// that match and do not.
/// REFERENCE: the uniform strain 3/E: the cut is drawn together by 3 (2 + 3)/E.
#[test]
fn a_bar_between_walls_has_the_tension_and_the_shortening_of_closed_form() {
    let elements = ["t3", "q4", "t6", "q8", "tet4", "hex8", "tet10", "hex20"];
    for (element, counts) in elements.into_iter().flat_map(|element| [(element, [2, 2]), (element, [2, 3])]) {
        // A tension of 3 draws 2 + 3 together by 3 (2 + 3) / E.
        let exact = 3.0 * 5.0 / YOUNG;
        for (key, value) in [("force", 3.0), ("shortening", exact)] {
            let answer = answer(&bar(element, counts, 0.0, &preload(key, value)));
            let (mesh, far) = (answer.model().mesh(), answer.model().body().regions()[1].nodes().start);
            let dimension = mesh.dimension();
            for (node, at) in mesh.nodes().iter().enumerate() {
                let along = if node < far { at[dimension - 1] } else { at[dimension - 1] - 5.0 };
                for axis in 0..dimension {
                    let value = if axis + 1 == dimension { 3.0 / YOUNG * along } else { 0.0 };
                    let away = (answer.displacement()[dimension * node + axis] - value).abs();
                    assert!(away < INTEGRATED * exact, "{element} {counts:?} {key}: {away:e} at {at:?}");
                }
            }
            let tie = tie(&answer);
            assert!((tie.shortening.unwrap() - exact).abs() < INTEGRATED * exact, "{element} {counts:?}: {tie:?}");
            // The force on the side that takes the means leads to the other side.
            let sense = if tie.on.as_deref() == Some("far") { -1.0 } else { 1.0 };
            assert!((tie.force[dimension - 1] - sense * 3.0).abs() < 3.0 * INTEGRATED, "{element} {counts:?}: {tie:?}");
            assert!(answer.forces().unwrap().balance < INTEGRATED);
        }
    }
}

/// A bar that may not widen at its ends: nothing is uniform, but the answers to a force and to its shortening are one
/// answer, that depends neither on the order of the sides nor on the length of the direction.
#[test]
fn a_force_and_its_shortening_give_one_answer() {
    for element in ["q8", "hex8", "tet10"] {
        let by_force = answer(&bar(element, [2, 2], 0.3, &preload("force", 3.0)));
        let shortening = tie(&by_force).shortening.unwrap();
        let mut others = vec![preload("shortening", shortening)];
        others.push(json!({"boundary": "far.bottom", "to": "top", "force": 3}));
        let direction = if element == "q8" { json!([0, -7]) } else { json!([0, 0, -7]) };
        others.push(json!({"boundary": "far.bottom", "to": "top", "force": 3, "direction": direction}));
        let largest = by_force.displacement().iter().fold(0.0, |largest: f64, part| largest.max(part.abs()));
        for other in others {
            let answer = answer(&bar(element, [2, 2], 0.3, &other));
            for (one, two) in by_force.displacement().iter().zip(answer.displacement()) {
                assert!((one - two).abs() < ROUNDING * largest, "{element}: {one} and {two}");
            }
            assert!((tie(&answer).shortening.unwrap() - shortening).abs() < ROUNDING * shortening);
        }
    }
}

/// A column (stiffness 1 x E / 2) stands on the ground and carries a cap, which a bolt beside it (stiffness 1 x E / 2
/// in two halves) draws down; a load pulls the column up. In the plane, without widening.
fn joint(preload: &Value, load: f64) -> Value {
    let body = |x: [f64; 2], y: [f64; 2]| json!({"rectangle": {"x": cells(x[0], x[1], 1), "y": cells(y[0], y[1], 2)}});
    let material = json!({"young": YOUNG, "poisson": 0});
    let level = |x: f64| json!({"equation": {"terms": [{"on": {"point": [x, 2]}, "y": 1}, {"on": {"point": [0, 2]}, "y": -1}]}});
    json!({
        "body": body([0.0, 1.0], [0.0, 2.0]), "material": material,
        "further-bodies": [
            {"name": "low", "body": body([2.0, 3.0], [0.0, 0.5]), "material": material},
            {"name": "high", "body": body([2.0, 3.0], [0.5, 2.0]), "material": material},
        ],
        "supports": [
            {"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "low.bottom"}, "x": 0, "y": 0},
        ],
        "obstacles": [{"boundary": "bottom", "approach": "-y", "shape": {"plane": {"point": [0, 0], "normal": [0, -1]}}}],
        "ties": [{"preload": preload}, level(1.0), level(2.0), level(3.0)],
        "loads": [{"traction": {"boundary": "top", "value": [0, load]}}],
    })
}

/// Half of a bolt at a plane of symmetry has the answer of supports there; a direction with the rounding of an angle is
/// along the axis.
#[test]
fn half_a_bolt_has_the_tension_of_its_half() {
    for direction in [json!([0, 0, 1]), json!([6.123e-17, 0, 1])] {
        let mut half = bar("hex8", [2, 2], 0.0, &preload("force", 3.0));
        half["ties"][0]["preload"]["direction"] = direction;
        half["supports"]
            .as_array_mut()
            .unwrap()
            .extend(["left", "far.left"].map(|name| json!({"on": {"boundary": name}, "x": 0})));
        let mut mirrored = half.clone();
        mirrored["supports"].as_array_mut().unwrap().truncate(2);
        mirrored["symmetry"] = json!(["x"]);
        let [held, mirrored] = [half, mirrored].map(|scene| tie(&answer(&scene)));
        assert!((held.shortening.unwrap() - 3.0 * 5.0 / YOUNG).abs() < INTEGRATED, "{held:?}");
        assert!((mirrored.shortening.unwrap() - held.shortening.unwrap()).abs() < INTEGRATED, "{mirrored:?}");
        // The force on the whole bolt is twice that of the modelled half.
        assert!((mirrored.force[2].abs() - 6.0).abs() < 10.0 * INTEGRATED, "{mirrored:?}");
    }
}

/// GOAL: a preloaded bolted joint under an external load. CONDITIONS: a bolt and a column of the same stiffness; a
/// given tension, or a given shortening; loads up to and beyond the opening of the seat. REFERENCE: two springs in
/// parallel: under a given tension the seat carries 3 - F of a load F, under a given shortening max(0, 3 - F/2), and
/// the bolt the rest.
#[test]
fn a_bolted_joint_carries_a_load_until_its_seat_opens() {
    let (column, bolt) = (YOUNG / 2.0, YOUNG / 2.0);
    let drawn = |key: &str, value: f64| json!({"boundary": "low.top", "to": "high.bottom", key: value});
    let seat =
        |answer: &Answer| answer.resultants().unwrap().iter().find(|one| one.of == "obstacles[0]").unwrap().force[1];
    let near = |one: f64, two: f64| assert!((one - two).abs() < 3.0 * INTEGRATED, "{one} instead of {two}");
    // A tension of 3: the load takes its part of the pressure on the seat.
    for load in [0.0, 1.0, 2.9] {
        let answer = answer(&joint(&drawn("force", 3.0), load));
        near(seat(&answer), 3.0 - load);
        near(tie(&answer).shortening.unwrap(), 3.0 / bolt + (3.0 - load) / column);
    }
    // A shortening that gives 3 without a load: the load is shared until the seat opens, and then the bolt has all of
    // it.
    let shortening = 3.0 / bolt + 3.0 / column;
    for load in [0.0, 2.0, 5.9, 6.5, 9.0] {
        let answer = answer(&joint(&drawn("shortening", shortening), load));
        let on_seat = (3.0 - load * column / (column + bolt)).max(0.0);
        near(seat(&answer), on_seat);
        near(tie(&answer).force[1].abs(), on_seat + load);
    }
}

/// Bolts in directions at random: those that point out of the first part draw together, the others are refused.
#[test]
fn no_bolt_pushes_its_parts_apart() {
    let mut draws = Draws(seed(74));
    let mut drawn = [0, 0];
    for _ in 0..cases(30, 100) {
        let direction = [0, 1, 2].map(|axis| draws.signed() * if axis == 2 { 1.0 } else { 0.3 });
        let sides = if draws.below(2) == 0 { ["top", "far.bottom"] } else { ["far.bottom", "top"] };
        let out = if sides[0] == "top" { direction[2] } else { -direction[2] };
        let preload = json!({"boundary": sides[0], "to": sides[1], "force": 3, "direction": direction});
        match build(&bar("hex8", [1, 1], 0.3, &preload)) {
            Ok(_) => {
                assert!(out > 0.0, "{direction:?}");
                drawn[0] += 1;
            }
            Err(Error::Refused { code: "approach-away", path, .. }) if out < 0.0 => {
                assert_eq!(path, "ties[0].preload.direction");
                drawn[1] += 1;
            }
            // Nearly along the faces.
            Err(error) => assert!(direction[2].abs() < 0.01, "{direction:?}: {error}"),
        }
    }
    assert!(drawn.iter().all(|&count| count > 5), "{drawn:?}");
}

/// The sign of a shortening is that of the motion of the parts, whatever the sign of direction and force.
#[test]
fn a_bolt_that_lengthens_has_a_negative_shortening() {
    for (force, direction, sense) in [(3.0, 1, 1.0), (-3.0, -1, 1.0), (-3.0, 1, -1.0)] {
        let mut preload = preload("force", force);
        preload["direction"] = json!([0, 0, direction]);
        let tie = tie(&answer(&bar("hex8", [2, 3], 0.0, &preload)));
        let exact = sense * 3.0 * 5.0 / YOUNG;
        assert!((tie.shortening.unwrap() - exact).abs() < INTEGRATED, "{force} {direction}: {tie:?}");
        assert!((tie.tension.unwrap() - sense * 3.0).abs() < INTEGRATED, "{force} {direction}: {tie:?}");
    }
}

/// Halves of a bolt go through each other by the shortening, as is meant; without the bolt they are named.
#[test]
fn the_cut_of_a_bolt_is_no_overlap() {
    let warnings = |scene: &Value| {
        let model = build(scene).unwrap();
        let solution = solve_qp(model.problem()).unwrap();
        let answer = Answer::of(Arc::new(model), &solution).unwrap();
        Summary::of_answer(&answer, solution, 1e-9, 0.0).unwrap().warnings
    };
    for element in ["q4", "q8", "hex8"] {
        let mut scene = bar(element, [2, 3], 0.0, &preload("force", 3.0));
        let drawn = warnings(&scene);
        assert!(drawn.iter().all(|one| one.code != "bodies-overlap"), "{element}: {drawn:?}");
        scene["ties"] = json!([]);
        scene["supports"][1][if element.len() > 2 { "z" } else { "y" }] = json!(-0.1);
        let pushed = warnings(&scene);
        assert!(pushed.iter().any(|one| one.code == "bodies-overlap"), "{element}: {pushed:?}");
    }
}

/// GOAL: a point that stands for a bolt. CONDITIONS: a force, or a displacement along x, of the point, with another
/// point that pulls at the bar. REFERENCE: the same tension or shortening of the preload; the point has both.
#[test]
fn a_point_stands_for_a_bolt() {
    let pull = json!({"name": "end", "at": [0.5, 0.5, 2], "force": [0, 0, 1.5]});
    for (key, of_point, value) in [("force", "force", 3.0), ("shortening", "x", 0.07), ("force", "force", -3.0)] {
        let scene = |preload: Value, points: Value| {
            let mut scene = bar("hex8", [2, 3], 0.3, &preload);
            let coupling = json!({"coupling": {"point": "end", "boundary": "left"}});
            scene["ties"].as_array_mut().unwrap().insert(0, coupling);
            scene["points"] = points;
            answer(&scene)
        };
        let mut bolt = json!({"name": "bolt", "at": [9, 9, 9]});
        bolt[of_point] = if of_point == "x" { value.into() } else { json!([value, 0, 0]) };
        let by_point = scene(json!({"boundary": "top", "to": "far.bottom", "point": "bolt"}), json!([pull, bolt]));
        let by_tie = scene(preload(key, value), json!([pull]));
        let largest = by_tie.displacement().iter().fold(0.0, |largest: f64, part| largest.max(part.abs()));
        for (one, two) in by_tie.displacement().iter().zip(by_point.displacement()) {
            assert!((one - two).abs() < ROUNDING * largest, "{key}: {one} and {two}");
        }
        let of = |of: &str| by_point.resultants().unwrap().iter().find(|one| one.of == of).unwrap().clone();
        let (tie, point) = (of("ties[1]"), of("points[1]"));
        assert_eq!(point.on.as_deref(), Some("`bolt`"));
        let near = |one: f64, two: f64| assert!((one - two).abs() < INTEGRATED * value.abs(), "{key}: {one} and {two}");
        near(point.motion.unwrap().displacement[0], tie.shortening.unwrap());
        near(point.force[0], tie.tension.unwrap());
        near(if key == "force" { point.force[0] } else { tie.shortening.unwrap() }, value);
    }
}

#[test]
fn a_point_that_is_no_bolt_is_refused() {
    let bolt = |keys: Value| {
        let mut bolt = json!({"name": "bolt", "at": [0, 0, 0]});
        keys.as_object().unwrap().iter().for_each(|(key, value)| bolt[key] = value.clone());
        bolt
    };
    let preload = |keys: Value| {
        let mut preload = json!({"boundary": "top", "to": "far.bottom", "point": "bolt"});
        keys.as_object().unwrap().iter().for_each(|(key, value)| preload[key] = value.clone());
        json!({"preload": preload})
    };
    let (plain, none) = (bolt(json!({"force": [3, 0, 0]})), json!({}));
    let term = json!({"on": {"reference": "bolt"}, "x": 1});
    for (points, ties, path, phrase) in [
        (json!([bolt(json!({"y": 1}))]), json!([preload(none.clone())]), "points[0].y", "along x alone"),
        (json!([bolt(json!({"force": [3, 1, 0]}))]), json!([preload(none.clone())]), "points[0].y", "along x alone"),
        (
            json!([bolt(json!({"rotation": {"z": 1}}))]),
            json!([preload(none.clone())]),
            "points[0].rotation.z",
            "along x alone",
        ),
        (
            json!([bolt(json!({"force": [3, 0, 0], "x": 1}))]),
            json!([preload(none.clone())]),
            "points[0].x",
            "does nothing",
        ),
        (json!([plain]), json!([preload(json!({"force": 1}))]), "ties[0].preload", "has the point `bolt`"),
        (
            json!([plain]),
            json!([preload(none.clone()), preload(none.clone())]),
            "ties[1].preload.point",
            "stands for the bolt of ties[0]",
        ),
        (
            json!([bolt(none.clone())]),
            json!([preload(json!({"point": "bold"}))]),
            "ties[0].preload.point",
            "did you mean `bolt`?",
        ),
        (
            json!([plain]),
            json!([preload(none.clone()), {"equation": {"terms": [term]}}]),
            "ties[1].equation.terms[0].on.reference",
            "stands for the bolt of ties[0]",
        ),
        (
            json!([plain]),
            json!([preload(none), {"coupling": {"point": "bolt", "boundary": "left"}}]),
            "ties[1].coupling.point",
            "stands for the bolt of ties[0]",
        ),
    ] {
        let mut scene = bar("hex8", [2, 2], 0.3, &json!({}));
        (scene["points"], scene["ties"]) = (points, ties);
        match build(&scene) {
            Err(Error::Scene { path: found, message }) => {
                assert_eq!(found, path, "{message}");
                assert!(message.contains(phrase), "{message}");
            }
            other => panic!("{path}: {other:?}"),
        }
    }
}

#[test]
fn a_preload_that_describes_no_bolt_is_refused() {
    let refused = |preload: &Value, change: &dyn Fn(&mut Value)| {
        let mut scene = bar("hex8", [2, 2], 0.3, preload);
        change(&mut scene);
        match build(&scene) {
            Err(Error::Scene { path, message }) => format!("{path}: {message}"),
            other => panic!("{other:?}"),
        }
    };
    let none = |_: &mut Value| ();
    for (preload, phrase) in [
        (
            json!({"boundary": "top", "to": "far.bottom"}),
            "ties[0].preload: needs one of `force`, `shortening` and `point`",
        ),
        (json!({"boundary": "top", "to": "far.bottom", "force": 1, "shortening": 1}), "needs one of `force`"),
        (json!({"boundary": "top", "to": "far.top", "force": 1}), "no facet of `top` faces `far.top`"),
        (json!({"boundary": "top", "to": "far.bottom", "force": 1, "direction": [1, 0, 0]}), "lies along the faces"),
        (json!({"boundary": "top", "to": "far.bottom", "force": 1, "direction": [0, 1]}), "must have 3"),
    ] {
        let message = refused(&preload, &none);
        assert!(message.contains(phrase), "{message}");
    }
    // The whole cut, or one edge of it, held along the bolt.
    let cut = |scene: &mut Value, names: [&str; 2]| {
        let held = names.map(|name| json!({"on": {"boundary": name}, "z": 0}));
        scene["supports"].as_array_mut().unwrap().extend(held);
    };
    for names in [["top", "far.bottom"], ["left", "far.left"]] {
        let held = refused(&preload("force", 1.0), &|scene| cut(scene, names));
        assert!(held.contains("fix the distance of the faces along the bolt"), "{held}");
        let held = refused(&preload("shortening", 0.1), &|scene| cut(scene, names));
        assert!(held.contains("supports prescribe all its displacements, and miss it by 0.1"), "{held}");
    }
    let mut closed = bar("hex8", [2, 2], 0.3, &preload("shortening", 0.0));
    cut(&mut closed, ["top", "far.bottom"]);
    assert!(tie(&answer(&closed)).shortening.unwrap().abs() < 1e-15);
    // Both parts are held across a tilted bolt, which ties them along it too.
    let mut tilted = preload("force", 1.0);
    tilted["direction"] = json!([0.3, 0, 1]);
    let held = refused(&tilted, &|scene| {
        let sides = ["left", "far.left"].map(|name| json!({"on": {"boundary": name}, "x": 0}));
        scene["supports"].as_array_mut().unwrap().extend(sides);
    });
    assert!(held.contains("fix the distance of the faces along the bolt"), "{held}");
}
