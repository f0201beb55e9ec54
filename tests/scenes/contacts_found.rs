//! GOAL: `"contact": "auto"` finds the contacts between bodies, what it takes is reported, and bodies that go through
//! each other are named.

use std::sync::Arc;

use serde_json::{Value, json};
use signorini::scene::Answer;
use signorini::study::Summary;
use signorini::{Model, Scene, solve_qp};
use support::scenes::{answer, build, built};

/// Two solves of one contact problem from rows that differ by rounding, relative.
const SAME: f64 = 1e-9;

fn block(x: [f64; 2], y: [f64; 2], cells: [usize; 2]) -> Value {
    json!({"rectangle": {"x": {"points": x, "divisions": [cells[0]]}, "y": {"points": y, "divisions": [cells[1]]}}})
}

/// A block on another one that lies on a third, pressed by a pressure of 0.01 on 1.
fn stack() -> Value {
    json!({
        "contact": "auto",
        "body": block([0.0, 1.0], [2.0, 3.0], [7, 4]), "material": {"young": 1, "poisson": 0.3},
        "further-bodies": [
            {"name": "middle", "body": block([-0.2, 1.3], [1.0, 2.0], [5, 3]), "material": {"young": 1, "poisson": 0.2}},
            {"name": "base", "body": block([-1.0, 2.0], [0.0, 1.0], [11, 4]), "material": {"young": 10, "poisson": 0.3}}],
        "supports": [{"on": {"boundary": "base.bottom"}, "x": 0, "y": 0}, {"on": {"boundary": "middle.left"}, "x": 0},
                     {"on": {"boundary": "left"}, "x": 0}],
        "loads": [{"pressure": {"boundary": "top", "value": 0.01}}],
    })
}

fn report(scene: &Value) -> Value {
    let model = built(scene);
    let solution = solve_qp(model.problem()).unwrap();
    let answer = Answer::of(Arc::new(model), &solution).unwrap();
    serde_json::to_value(Summary::of_answer(&answer, solution, 1e-9, 0.0).unwrap()).unwrap()
}

#[test]
fn a_stack_of_three_bodies_passes_its_load_down_through_two_contacts() {
    let answer = answer(&stack());
    let model = answer.model();
    let names: Vec<(&str, Option<&str>)> =
        model.obstacles().iter().map(|one| (one.boundary(), one.other_body().map(|other| other.0))).collect();
    // The finer mesh carries the rows of bodies that are as soft, and the softer body those of others.
    assert_eq!(names, [("body-at-middle", Some("middle-at-body")), ("middle-at-base", Some("base-at-middle"))]);
    for force in model.obstacle_forces(answer.multiplier()) {
        assert!((force / 0.01 - 1.0).abs() < SAME, "{force:e}");
    }
    // The face of the middle, 1.5 wide, is covered over the width of the upper body.
    let covered: Vec<[f64; 2]> = model.obstacles().iter().filter_map(|one| one.other_body()?.1).collect();
    for ([own, other], exact) in covered.into_iter().zip([1.0 / 1.5, 1.5 / 3.0]) {
        assert!((own - 1.0).abs() < SAME && (other - 1.0).abs() > 0.0 && other >= exact - SAME, "{own} {other}");
    }
}

#[test]
fn what_auto_finds_is_what_a_user_would_write() {
    let mut by_hand = stack();
    by_hand["contact"].take();
    by_hand.as_object_mut().unwrap().remove("contact");
    by_hand["obstacles"] = json!([
        {"boundary": "bottom", "rule": "closest-point", "shape": {"body": {"boundary": "middle.top"}}},
        {"boundary": "middle.bottom", "approach": "-y", "shape": {"body": {"boundary": "base.top"}}}]);
    let [auto, hand] = [answer(&stack()), answer(&by_hand)];
    let largest = hand.displacement().iter().fold(0.0_f64, |largest, part| largest.max(part.abs()));
    for (auto, hand) in auto.displacement().iter().zip(hand.displacement()) {
        assert!((auto - hand).abs() < SAME * largest, "{auto:e} {hand:e}");
    }
}

#[test]
fn a_named_contact_is_not_found_again() {
    let mut scene = stack();
    scene["obstacles"] =
        json!([{"boundary": "bottom", "approach": "-y", "shape": {"body": {"boundary": "middle.top"}}}]);
    let model = built(&scene);
    let boundaries: Vec<&str> = model.obstacles().iter().map(|one| one.boundary()).collect();
    assert_eq!(boundaries, ["bottom", "middle-at-base"]);
}

/// Without a gap the forces on both sides have opposite moments.
#[test]
fn the_moment_on_the_other_body_is_opposite() {
    let report = report(&stack());
    for index in 0..2 {
        let own = report["resultants"][index]["moment"][0].as_f64().unwrap();
        let other = report["contact"]["obstacles"][index]["between"]["moment_on_other"][0].as_f64().unwrap();
        assert!(own > 1e-3 && (own + other).abs() < SAME * own, "{own:e} {other:e}");
    }
}

/// A ring of three discs, each of which touches both others, in three directions.
#[test]
fn three_discs_that_touch_each_other_are_in_equilibrium() {
    let disc = |x: f64, y: f64, count: usize| {
        json!({"ring": {"centre": [x, y], "radius": {"points": [0.3, 1.0], "divisions": [4]},
                        "angle": {"points": [0, 360], "divisions": [count]}, "element": "q8"}})
    };
    let material = json!({"young": 1, "poisson": 0.3});
    let height = 3.0_f64.sqrt();
    let scene = json!({
        "contact": "auto",
        "body": disc(0.0, height, 48), "material": material,
        "further-bodies": [{"name": "left", "body": disc(-1.0, 0.0, 60), "material": material},
                           {"name": "right", "body": disc(1.0, 0.0, 72), "material": material}],
        "supports": [{"on": {"boundary": "left.inner"}, "x": 0, "y": 0}, {"on": {"boundary": "right.inner"}, "x": -0.01, "y": 0},
                     {"on": {"boundary": "inner"}, "x": 0, "y": -0.01}],
    });
    let answer = answer(&scene);
    let forces = answer.model().obstacle_forces(answer.multiplier());
    assert_eq!(forces.len(), 3);
    assert!(forces.iter().all(|&force| force > 1e-4), "{forces:?}");
    assert!(answer.forces().unwrap().balance < 1e-10);
    // Means are kept apart: some nodes between them go through, by far less than the travel of 0.01.
    let deepest = answer.across().iter().fold(0.0_f64, |deepest, [_, gap]| deepest.max(-gap));
    assert!(deepest > 1e-8 && deepest < 1e-4, "{deepest:e}");
    let report = report(&scene);
    let obstacles = report["contact"]["obstacles"].as_array().unwrap();
    let reported = obstacles.iter().filter_map(|one| one["between"]["penetration"].as_f64()).fold(0.0, f64::max);
    assert_eq!(reported, deepest);
    assert!(answer.model().warnings().is_empty(), "{:?}", answer.model().warnings());
}

/// A cantilever that a load bends through a block below it, farther away than a facet is long.
#[test]
fn bodies_that_go_through_each_other_without_rows_are_named_and_auto_keeps_them_apart() {
    let mut scene = json!({
        "body": block([0.0, 4.0], [0.2, 0.5], [40, 4]), "material": {"young": 1, "poisson": 0.3},
        "further-bodies": [{"name": "base", "body": block([2.0, 3.0], [-1.0, 0.05], [8, 8]),
                            "material": {"young": 10, "poisson": 0.3}}],
        "supports": [{"on": {"boundary": "base.bottom"}, "x": 0, "y": 0}, {"on": {"boundary": "left"}, "x": 0, "y": 0}],
        "loads": [{"pressure": {"boundary": "top", "value": 0.0001}}],
    });
    let codes = |report: &Value| -> Vec<String> {
        let warnings = report["warnings"].as_array().cloned().unwrap_or_default();
        warnings.iter().map(|warning| warning["code"].as_str().unwrap().to_string()).collect()
    };
    assert!(codes(&report(&scene)).contains(&"bodies-overlap".to_string()));
    scene["contact"] = json!("auto");
    let apart = report(&scene);
    assert!(!codes(&apart).contains(&"bodies-overlap".to_string()), "{apart}");
    let between = &apart["contact"]["obstacles"][0]["between"];
    assert_eq!((&between["rows"], &between["other"]), (&json!("mortar"), &json!("base-at-body")));
    assert!(between["penetration"].as_f64().unwrap() >= 0.0 && between["covered"][0].as_f64().unwrap() > 0.1);
    assert!(apart["contact"]["force"].as_f64().unwrap() > 0.0);
}

/// A stiff block of one facet carries the rows; a round bump under it, of radius 0.6, enters it in its middle by 1/24
/// of the square of the facet over the radius, 0.069, less what it yields.
#[test]
fn bodies_that_go_through_each_other_between_rows_are_named() {
    let warnings = |cells: usize| {
        let bump = json!({"radius": {"points": [0.2, 0.6], "divisions": [4]}, "angle": {"points": [20, 160], "divisions": [80]}});
        let scene = json!({
            "body": block([-0.5, 0.5], [0.6, 1.0], [cells, 2]), "material": {"young": 1000, "poisson": 0.3},
            "further-bodies": [{"name": "bump", "body": {"ring": bump}, "material": {"young": 1, "poisson": 0.3}}],
            "supports": [{"on": {"boundary": "bump.inner"}, "x": 0, "y": 0}, {"on": {"boundary": "top"}, "x": 0, "y": -1e-3}],
            "obstacles": [{"boundary": "bottom", "rule": "closest-point", "shape": {"body": {"boundary": "bump.outer", "side": "this"}}}],
        });
        report(&scene)["warnings"].to_string()
    };
    let coarse = warnings(1);
    assert!(coarse.contains("bodies-overlap") && coarse.contains("between contact rows"), "{coarse}");
    let fine = warnings(40);
    assert!(!fine.contains("bodies-overlap"), "{fine}");
}

/// Two blocks, one above the other, with an obstacle that a test changes.
fn two_blocks(upper: Value, lower: Value, body: Value) -> Model {
    let mut shape = body;
    shape["boundary"] = json!("base.top");
    built(&json!({
        "body": upper, "material": {"young": 1, "poisson": 0.3},
        "further-bodies": [{"name": "base", "body": lower, "material": {"young": 1, "poisson": 0.3}}],
        "supports": [{"on": {"boundary": "base.bottom"}, "x": 0, "y": 0}, {"on": {"boundary": "top"}, "x": 0, "y": -0.01}],
        "obstacles": [{"boundary": "bottom", "approach": "-y", "shape": {"body": shape}}],
    }))
}

#[test]
fn each_warning_of_two_surfaces_is_provoked() {
    let code = |model: &Model| -> Vec<&str> { model.warnings().iter().map(|warning| warning.code).collect() };
    let upper = |cells: usize| block([0.0, 1.0], [1.0, 2.0], [cells, 2]);
    let lower = |x: [f64; 2], cells: usize| block(x, [0.0, 1.0], [cells, 2]);
    assert!(code(&two_blocks(upper(3), lower([0.0, 1.0], 4), json!({}))).is_empty());
    let beside = two_blocks(upper(3), lower([2.0, 3.0], 4), json!({"rows": "mortar"}));
    assert!(code(&beside).contains(&"no-facing-facet"), "{:?}", beside.warnings());
    let shifted = two_blocks(upper(3), lower([0.5, 1.5], 4), json!({}));
    assert_eq!(code(&shifted), ["partly-covered"], "{:?}", shifted.warnings());
    let coarse = two_blocks(upper(10), lower([0.0, 1.0], 2), json!({"side": "this"}));
    assert_eq!(code(&coarse), ["coarse-master"], "{:?}", coarse.warnings());
    let fit = two_blocks(upper(3), block([0.0, 1.0], [0.0, 0.9], [4, 2]), json!({"fit": {"clearance": 1e-3}}));
    assert_eq!(code(&fit), ["fit-differs"], "{:?}", fit.warnings());
    assert!(fit.rows().iter().all(|row| row.gap == 1e-3));
    let ring = |radius: [f64; 2], count: usize| json!({"ring": {"radius": {"points": radius, "divisions": [2]}, "angle": {"points": [0, 90], "divisions": [count]}}});
    let material = json!({"young": 1, "poisson": 0.3});
    let sagging = built(&json!({
        "body": ring([0.5, 1.0], 8), "material": material,
        "further-bodies": [{"name": "hub", "body": ring([1.0, 2.0], 11), "material": material}],
        "supports": [{"on": {"boundary": "start"}, "y": 0}, {"on": {"boundary": "end"}, "x": 0},
                     {"on": {"boundary": "hub.start"}, "y": 0}, {"on": {"boundary": "hub.end"}, "x": 0}],
        "obstacles": [{"boundary": "outer", "rule": "closest-point", "shape": {"body": {"boundary": "hub.inner"}}}],
    }));
    assert_eq!(code(&sagging), ["sag"], "{:?}", sagging.warnings());
    // The sag of a chord of 90/8 degrees is 1 - cos(90/16 degrees).
    let sag = 1.0 - (std::f64::consts::PI / 32.0).cos();
    let message = sagging.warnings()[0].to_string();
    assert!(message.contains(&format!("{sag:.1e}")[..3]), "{message}");
}

#[test]
fn a_missing_approach_and_a_motion_are_refused_with_the_remedy() {
    let mut scene = stack();
    scene["obstacles"] = json!([{"boundary": "bottom", "shape": {"plane": {"point": [0, 0], "normal": [0, 1]}}}]);
    let refused = build(&scene).unwrap_err().to_string();
    assert!(
        refused.contains("`obstacles[0]`: the key `approach` is missing") && refused.contains("closest-point"),
        "{refused}"
    );
    let mut moving = stack();
    moving["material"]["density"] = json!(1);
    for body in 0..2 {
        moving["further-bodies"][body]["material"]["density"] = json!(1);
    }
    moving["analysis"] = json!({"dynamic": {"step": 0.01, "duration": 0.02}});
    let scene = Scene::from_json(&moving.to_string(), "scene").unwrap();
    let model = scene.build().unwrap();
    let refused = scene.dynamics(&model).unwrap_err().to_string();
    assert!(refused.contains("meshes of the two bodies do not match"), "{refused}");
    assert!(solve_qp(model.problem()).is_ok());
}

/// Three blocks, each of which touches both others. By pairs, the first would carry rows against the third, which is
/// 2.9 times as stiff, the third against the second, and the second against the first, whose facets are larger.
fn three_blocks(sides: [&str; 3]) -> Value {
    let between = |boundary: &str, other: &str, side: &str| json!({"boundary": boundary, "rule": "closest-point", "shape": {"body": {"boundary": other, "rows": "mortar", "side": side, "reach": 0.1}}});
    let further = |name: &str, body: Value, young: f64| json!({"name": name, "body": body, "material": {"young": young, "poisson": 0.3}});
    json!({
        "body": block([0.0, 1.0], [0.0, 1.0], [2, 2]), "material": {"young": 1, "poisson": 0.3},
        "further-bodies": [further("second", block([1.0, 2.0], [0.0, 1.0], [3, 3]), 1.5),
                           further("third", block([0.0, 2.0], [1.0, 2.0], [10, 4]), 2.9)],
        "supports": [{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "bottom"}, "y": 0}, {"on": {"boundary": "second.bottom"}, "y": 0},
                     {"on": {"boundary": "third.left"}, "x": 0}],
        "loads": [{"pressure": {"boundary": "third.top", "value": 0.01}}, {"pressure": {"boundary": "second.right", "value": 0.01}}],
        "obstacles": [between("right", "second.left", sides[0]), between("second.top", "third.bottom", sides[1]),
                      between("third.bottom", "top", sides[2])],
    })
}

#[test]
fn all_bodies_have_one_order_in_which_they_carry_rows() {
    let carrying = |sides| -> Vec<String> {
        built(&three_blocks(sides)).obstacles().iter().map(|one| one.boundary().to_string()).collect()
    };
    assert_eq!(carrying(["auto"; 3]), ["second.left", "second.top", "top"]);
    // Against the order, but in no circle: the nodes at which all meet carry rows of one obstacle alone.
    assert_eq!(carrying(["auto", "auto", "this"]), ["second.left", "second.top", "third.bottom"]);
    let pressed = answer(&three_blocks(["auto"; 3]));
    assert!(pressed.forces().unwrap().balance < 1e-10);
    assert!(pressed.model().obstacle_forces(pressed.multiplier()).iter().all(|&force| force > 1e-4));
}

#[test]
fn rows_that_lead_in_a_circle_are_refused() {
    let mut scene = three_blocks(["auto"; 3]);
    let shape = |boundary: &str, side: &str| json!({"body": {"boundary": boundary, "rows": "mortar", "side": side, "reach": 0.1}});
    scene["obstacles"][2]["shape"] = shape("top", "other");
    scene["obstacles"]
        .as_array_mut()
        .unwrap()
        .push(json!({"boundary": "third.bottom", "rule": "closest-point", "shape": shape("top", "this")}));
    let error = build(&scene).unwrap_err().to_string();
    assert!(error.contains("obstacles[3].shape.body.side") && error.contains("lead back"), "{error}");
}

/// The contact forces around a shaft have no resultant, and supports that fix its position carry none.
#[test]
fn a_press_fit_has_no_force_at_its_supports() {
    let ring = |radii: [f64; 2], count: usize| json!({"ring": {"radius": {"points": radii, "divisions": [2]}, "angle": {"points": [0, 360], "divisions": [count]}, "element": "q8"}});
    let material = json!({"young": 1, "poisson": 0.3});
    let mut scene = json!({
        "body": ring([0.5, 1.0], 24), "material": material,
        "further-bodies": [{"name": "hub", "body": ring([1.0, 2.0], 36), "material": material}],
        "supports": [{"on": {"point": [0.5, 0]}, "y": 0}, {"on": {"point": [-0.5, 0]}, "y": 0}, {"on": {"point": [0, 0.5]}, "x": 0},
                     {"on": {"point": [2, 0]}, "y": 0}, {"on": {"point": [-2, 0]}, "y": 0}, {"on": {"point": [0, 2]}, "x": 0}],
        "obstacles": [{"boundary": "outer", "rule": "closest-point",
                       "shape": {"body": {"boundary": "hub.inner", "fit": {"interference": 1e-3}}}}],
    });
    let warned = |scene: &Value| report(scene).to_string().contains("point-support");
    assert!(!warned(&scene));
    scene["loads"] = json!([{"traction": {"boundary": "hub.outer", "value": [1e-4, 0]}}]);
    assert!(warned(&scene));
}

/// Deeper than any contact is looked for.
#[test]
fn a_body_deep_inside_another_is_named() {
    let scene = json!({
        "contact": "auto",
        "body": block([-0.2, 0.2], [-0.4, 0.5], [4, 9]), "material": {"young": 1, "poisson": 0.3},
        "further-bodies": [{"name": "base", "body": block([-0.5, 0.5], [-0.5, 0.0], [7, 4]), "material": {"young": 1, "poisson": 0.3}}],
        "supports": [{"on": {"boundary": "top"}, "x": 0, "y": 0}, {"on": {"boundary": "base.bottom"}, "x": 0, "y": 0}],
        "loads": [{"traction": {"boundary": "left", "value": [1e-6, 0]}}],
    });
    let warnings = report(&scene)["warnings"].to_string();
    assert!(
        warnings.contains("bodies-overlap") && warnings.contains("go through each other, by 2.500e-1"),
        "{warnings}"
    );
    // The scene has `auto` already.
    assert!(warnings.contains("finds none; name both boundaries") && !warnings.contains("or set"), "{warnings}");
}

/// No node of one bar lies inside the other.
#[test]
fn bars_that_cross_are_named() {
    let scene = json!({
        "body": block([-1.0, 1.0], [-0.05, 0.05], [1, 1]), "material": {"young": 1, "poisson": 0.3},
        "further-bodies": [{"name": "other", "body": block([-0.05, 0.05], [-1.0, 1.0], [1, 1]), "material": {"young": 1, "poisson": 0.3}}],
        "supports": [{"on": {"boundary": "left"}, "x": 0, "y": 0}, {"on": {"boundary": "other.bottom"}, "x": 0, "y": 0}],
        "loads": [{"traction": {"boundary": "right", "value": [1e-6, 0]}}],
    });
    let warnings = report(&scene)["warnings"].to_string();
    assert!(warnings.contains("`other` and `body` go through each other, by 5.0"), "{warnings}");
}
