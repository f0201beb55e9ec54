//! Reference points of scenes: couplings, equations and springs at points, compared with rigid faces and closed forms.

use serde_json::{Value, json};
use signorini::scene::{Answer, Resultant};
use signorini::{Error, qp};
use support::scenes::{answer, build};

/// Rounding of a solve with some hundred unknowns, relative to the largest displacement or force.
const ROUNDING: f64 = 1e-9;

fn resultant<'a>(answer: &'a Answer, of: &str) -> &'a Resultant {
    answer.resultants().unwrap().iter().find(|one| one.of == of).unwrap()
}

/// The displacements of a point, followed by its rotations.
fn motion(answer: &Answer, point: usize) -> Vec<f64> {
    let motion = resultant(answer, &format!("points[{point}]")).motion.clone().unwrap();
    [motion.displacement, motion.rotation].concat()
}

#[track_caller]
fn near(ours: &[f64], exact: &[f64], scale: f64) {
    let is_near = |(ours, exact): (&f64, &f64)| (ours - exact).abs() <= ROUNDING * scale;
    assert!(ours.len() == exact.len() && ours.iter().zip(exact).all(is_near), "{ours:?}, not {exact:?}");
}

/// A bar [0, 5] x [-1/2, 1/2] (x [-1/2, 1/2]) with E = 1000, clamped on the left.
fn bar(element: &str, poisson: f64) -> Value {
    let across = json!({"points": [-0.5, 0.5], "divisions": [2]});
    let along = json!({"points": [0, 5], "divisions": [4]});
    let (model, body, held) = match element.len() > 2 {
        true => {
            let body = json!({"box": {"x": along, "y": across, "z": across, "element": element}});
            ("space", body, json!({"on": {"boundary": "left"}, "x": 0, "y": 0, "z": 0}))
        }
        false => {
            let body = json!({"rectangle": {"x": along, "y": across, "element": element}});
            ("plane-stress", body, json!({"on": {"boundary": "left"}, "x": 0, "y": 0}))
        }
    };
    json!({"model": model, "body": body, "material": {"young": 1000, "poisson": poisson}, "supports": [held]})
}

/// A point at the place of the end plate or beside it, with more keys.
fn point(name: &str, element: &str, keys: Value) -> Value {
    let mut point = json!({"name": name, "at": if element.len() > 2 { vec![5.5, 1.0, 2.0] } else { vec![5.5, 1.0] }});
    keys.as_object().unwrap().iter().for_each(|(key, value)| point[key] = value.clone());
    point
}

/// GOAL: a rigid coupling is a rigid face about its point.
/// CONDITIONS: a force and a moment at a point beside the end of a bar, then the motion that they cause prescribed.
/// REFERENCE: the rigid face with the same centre, force and moment; the force that holds is the force that acts.
#[test]
fn a_coupled_boundary_moves_as_a_rigid_face_about_the_point() {
    for element in ["t3", "q8", "hex8", "tet10"] {
        let (force, moment) = match element.len() > 2 {
            true => (vec![3.0, -1.0, 0.5], vec![0.3, -0.2, 0.7]),
            false => (vec![3.0, -1.0], vec![0.7]),
        };
        let mut scene = bar(element, 0.3);
        let mut plate = point("plate", element, json!({"force": force, "moment": moment}));
        scene["points"] = json!([plate]);
        scene["ties"] = json!([{"coupling": {"point": "plate", "boundary": "right"}}]);
        let coupled = answer(&scene);
        let mut with_face = bar(element, 0.3);
        with_face["rigid-faces"] =
            json!([{"boundary": "right", "centre": plate["at"], "force": force, "moment": moment}]);
        let with_face = answer(&with_face);
        let face = resultant(&with_face, "rigid-faces[0]");
        let moved = face.motion.clone().unwrap();
        let largest = coupled.displacement().iter().fold(0.0, |largest: f64, u| largest.max(u.abs()));
        near(coupled.displacement(), with_face.displacement(), largest);
        near(&motion(&coupled, 0), &[moved.displacement, moved.rotation].concat(), largest);
        let loaded = resultant(&coupled, "points[0]").clone();
        near(&loaded.force, &face.force, 3.0);
        near(&loaded.moment, &face.moment, 30.0);
        assert!(coupled.forces().unwrap().balance < ROUNDING && loaded.on.as_deref() == Some("`plate`"));
        // Prescribing the same motion needs the same force.
        let (moves, turns) = (motion(&coupled, 0), if element.len() > 2 { vec!["x", "y", "z"] } else { vec!["z"] });
        plate = point("plate", element, json!({}));
        let dimension = force.len();
        ["x", "y", "z"].iter().zip(&moves[..dimension]).for_each(|(axis, value)| plate[axis] = json!(value));
        turns.iter().zip(&moves[dimension..]).for_each(|(axis, value)| plate["rotation"][axis] = json!(value));
        scene["points"] = json!([plate]);
        let held = answer(&scene);
        near(&resultant(&held, "points[0]").force, &loaded.force, 3.0);
        near(&resultant(&held, "points[0]").moment, &loaded.moment, 30.0);
    }
}

/// Columns of width 1 and height 2 from x = 0 and x = 3, with E = 1000 and 3000, of stiffness 500 and 1500; their heads
/// follow the point `head` at (2, 2).
fn columns(head: Value, floor: bool) -> Value {
    let column = |x: f64| json!({"rectangle": {"x": {"points": [x, x + 1.0], "divisions": [2]}, "y": {"points": [0, 2], "divisions": [3]}}});
    let mut head = head;
    (head["name"], head["at"]) = (json!("head"), json!([2, 2]));
    let mut scene = json!({
        "model": "plane-stress", "material": {"young": 1000, "poisson": 0}, "body": column(0.0),
        "further-bodies": [{"name": "second", "material": {"young": 3000, "poisson": 0}, "body": column(3.0)}],
        "points": [head],
        "ties": [{"coupling": {"point": "head", "boundary": "top"}}, {"coupling": {"point": "head", "boundary": "second.top"}}],
    });
    let feet = ["bottom", "second.bottom"];
    match floor {
        false => {
            scene["supports"] =
                feet.map(|foot| json!({"on": {"boundary": foot}, "x": 0, "y": 0})).into_iter().collect();
        }
        true => {
            let plane = json!({"plane": {"point": [0, 0], "normal": [0, -1]}});
            let floor = |foot| json!({"boundary": foot, "approach": "-y", "shape": plane});
            scene["obstacles"] = feet.map(floor).into_iter().collect();
        }
    }
    scene
}

/// GOAL: one rigid body over two elastic ones, held or on a floor.
/// REFERENCE: statics: the columns carry 1/4 and 3/4 of the force; the moment about the point that keeps the head level
/// is 3/4 F (7/2 - 2) - 1/4 F (2 - 1/2).
#[test]
fn a_rigid_head_presses_two_columns_by_their_stiffnesses() {
    for floor in [false, true] {
        let head = json!({"x": 0, "rotation": {"z": 0}, "force": [0, -6]});
        let pressed = answer(&columns(head, floor));
        near(&motion(&pressed, 0), &[0.0, -6.0 / 2000.0, 0.0], 6.0 / 2000.0);
        let head = resultant(&pressed, "points[0]");
        near(&head.force, &[0.0, -6.0], 6.0);
        near(&head.moment, &[-12.0 - 4.5], 16.5);
        near(&["ties[0]", "ties[1]"].map(|tie| resultant(&pressed, tie).force[1]), &[-1.5, -4.5], 6.0);
        let moments = ["ties[0]", "ties[1]"].map(|tie| resultant(&pressed, tie).moment[0]);
        near(&moments, &[-1.5 * 0.5, -4.5 * 3.5], 16.5);
        assert!(pressed.resultants().unwrap().iter().all(|one| one.of != "loads"));
        let feet = if floor { ["obstacles[0]", "obstacles[1]"] } else { ["supports[0]", "supports[1]"] };
        let carried = feet.map(|foot| resultant(&pressed, foot).force[1]);
        near(&carried, &[1.5, 4.5], 6.0);
    }
    // Nothing holds down what is lifted; nothing stops what slides.
    for (head, named) in [
        (json!({"x": 0, "rotation": {"z": 0}, "force": [0, 6]}), "translation along y"),
        (json!({"rotation": {"z": 0}, "force": [1, -6]}), "translation along x"),
    ] {
        let ended = build(&columns(head, true)).err();
        let Some(Error::Qp(qp::Error::Unbounded { mode, .. } | qp::Error::UnderHeld { mode, .. })) = ended else {
            panic!("{named}: {ended:?}")
        };
        assert!(mode.contains(named), "{mode}, not {named}");
    }
}

/// GOAL: a point that follows the mean motion of an end.
/// CONDITIONS: a bar that widens at its end under a force through its axis; every element.
/// REFERENCE: the uniform traction of the same force; the work of the force is twice the energy.
#[test]
fn a_mean_coupling_spreads_a_force_over_the_area() {
    for element in ["t3", "q4", "t6", "q8", "hex8", "tet4"] {
        let (force, traction) = match element.len() > 2 {
            true => (json!([3, 0, 0]), json!([3, 0, 0])),
            false => (json!([3, 0]), json!([3, 0])),
        };
        let mut scene = bar(element, 0.3);
        scene["points"] = json!([point("end", element, json!({"force": force}))]);
        scene["points"][0]["at"] = if element.len() > 2 { json!([5, 0, 0]) } else { json!([5, 0]) };
        scene["ties"] = json!([{"coupling": {"point": "end", "boundary": "right", "mean": true}}]);
        let coupled = answer(&scene);
        let mut pulled = bar(element, 0.3);
        pulled["loads"] = json!([{"traction": {"boundary": "right", "value": traction}}]);
        near(coupled.displacement(), answer(&pulled).displacement(), 0.015);
        let work = 3.0 * motion(&coupled, 0)[0];
        near(&[work], &[2.0 * coupled.error_and_energy().unwrap().1], work);
    }
}

/// GOAL: springs and equations between points.
/// REFERENCE: a bar of stiffness 200 in series with a spring of 50, whose other end moves by 1; a lever that turns by
/// 0.05 and moves the end by -2 of it.
#[test]
fn springs_and_levers_at_points_move_a_bar_as_in_closed_form() {
    for element in ["q4", "hex8"] {
        let fixed =
            if element.len() > 2 { json!({"y": 0, "z": 0, "rotation": {"x": 0, "y": 0}}) } else { json!({"y": 0}) };
        let other = |keys: Value| {
            let mut all = fixed.clone();
            keys.as_object().unwrap().iter().for_each(|(key, value)| match key.as_str() {
                "z-turn" => all["rotation"]["z"] = value.clone(),
                key => all[key] = value.clone(),
            });
            point("other", element, all)
        };
        let mut scene = bar(element, 0.0);
        scene["ties"] = json!([{"coupling": {"point": "end", "boundary": "right"}}]);
        scene["points"] = json!([point("end", element, json!({})), other(json!({"x": 1, "z-turn": 0}))]);
        let mut on_axis = scene.clone();
        on_axis["points"][0]["at"] = if element.len() > 2 { json!([5, 0, 0]) } else { json!([5, 0]) };
        let terms = json!([{"on": {"reference": "other"}, "x": 1}, {"on": {"reference": "end"}, "x": -1}]);
        on_axis["springs"] = json!([{"terms": terms, "along": 50}]);
        let pulled = answer(&on_axis);
        near(&motion(&pulled, 0)[..2], &[0.2, 0.0], 1.0);
        near(&resultant(&pulled, "points[1]").force[..2], &[40.0, 0.0], 40.0);
        near(&resultant(&pulled, "points[0]").force[..2], &[0.0, 0.0], 40.0);
        near(&resultant(&pulled, "springs[0]").force[..2], &[40.0, 0.0], 40.0);
        on_axis["springs"] = json!([]);
        let terms = json!([{"on": {"reference": "end"}, "x": 1}, {"on": {"reference": "other"}, "rotation": {"z": 2}}]);
        on_axis["ties"].as_array_mut().unwrap().push(json!({"equation": {"terms": terms}}));
        on_axis["points"][1] = other(json!({"x": 0, "z-turn": 0.05}));
        let turned = answer(&on_axis);
        near(&motion(&turned, 0)[..2], &[-0.1, 0.0], 0.1);
        // The bar pulls the end with 20; the lever of 2 needs the moment 40.
        near(&[*resultant(&turned, "points[1]").moment.last().unwrap()], &[40.0], 40.0);
        for tie in ["ties[0]", "ties[1]"] {
            near(&resultant(&turned, tie).force[..2], &[-20.0, 0.0], 20.0);
        }
    }
}

/// GOAL: springs, couplings and equations at points each report their own force, where they act.
/// CONDITIONS: a bar of stiffness 200 with a guided point beside its end: pulled by a spring of 50 whose other end
/// moves by 1; pulled by 30 against such a spring to the ground; pulled by 30 on another point that follows by an
/// equation, or that follows a node.
/// REFERENCE: statics; loads, supports, points and springs balance.
#[test]
fn forces_at_points_act_where_the_scene_has_them() {
    for element in ["q4", "hex8"] {
        let in_space = element.len() > 2;
        // A force along x at (5.5, 1, 2), and its moment about the origin.
        let force = |x: f64| if in_space { vec![x, 0.0, 0.0] } else { vec![x, 0.0] };
        let moment = |x: f64| if in_space { vec![0.0, 2.0 * x, -x] } else { vec![-x] };
        let guide = |name: &str, keys: Value| {
            let rotation = if in_space { json!({"x": 0, "y": 0, "z": 0}) } else { json!({"z": 0}) };
            let mut all = if in_space { json!({"y": 0, "z": 0}) } else { json!({"y": 0}) };
            all["rotation"] = rotation;
            keys.as_object().unwrap().iter().for_each(|(key, value)| all[key] = value.clone());
            point(name, element, all)
        };
        let check = |answer: &Answer, of: &str, along: f64, moment: &[f64]| {
            near(&resultant(answer, of).force, &force(along), 40.0);
            near(&resultant(answer, of).moment, moment, 100.0);
        };
        let in_balance = |answer: &Answer| {
            let counted = ["supports[0]", "springs[0]", "points[0]", "points[1]"];
            let all = || answer.resultants().unwrap().iter().filter(|one| counted.contains(&&*one.of));
            let sum = |of: fn(&Resultant) -> &Vec<f64>, axis: usize| all().map(|one| of(one)[axis]).sum::<f64>();
            let forces: Vec<f64> = (0..force(0.0).len()).map(|axis| sum(|one| &one.force, axis)).collect();
            let moments: Vec<f64> = (0..moment(0.0).len()).map(|axis| sum(|one| &one.moment, axis)).collect();
            near(&[forces, moments].concat(), &vec![0.0; force(0.0).len() + moment(0.0).len()], 100.0);
        };
        let mut scene = bar(element, 0.0);
        scene["ties"] = json!([{"coupling": {"point": "end", "boundary": "right"}}]);
        let (none, terms) = (moment(0.0), |other: Value| json!([{"terms": other, "along": 50}]));
        scene["points"] = json!([guide("end", json!({})), guide("other", json!({"x": 1}))]);
        scene["springs"] =
            terms(json!([{"on": {"reference": "end"}, "x": 1}, {"on": {"reference": "other"}, "x": -1}]));
        let pulled = answer(&scene);
        check(&pulled, "springs[0]", 40.0, &moment(40.0));
        check(&pulled, "ties[0]", 40.0, &none);
        check(&pulled, "points[0]", 0.0, &moment(-40.0));
        check(&pulled, "supports[0]", -40.0, &none);
        scene["points"] = json!([guide("end", json!({"force": force(30.0)}))]);
        scene["springs"] = terms(json!([{"on": {"reference": "end"}, "x": 1}]));
        let against = answer(&scene);
        check(&against, "springs[0]", -6.0, &moment(-6.0));
        check(&against, "ties[0]", 24.0, &none);
        in_balance(&against);
        scene["springs"] = json!([]);
        scene["points"] = json!([guide("end", json!({})), guide("other", json!({"force": force(30.0)}))]);
        let equal = |first: Value| json!({"equation": {"terms": [{"on": first, "x": 1}, {"on": {"reference": "other"}, "x": -1}]}});
        scene["ties"].as_array_mut().unwrap().push(equal(json!({"reference": "end"})));
        let followed = answer(&scene);
        check(&followed, "ties[0]", 30.0, &none);
        check(&followed, "ties[1]", 30.0, &moment(30.0));
        assert_eq!(resultant(&followed, "ties[1]").on.as_deref(), Some("`end`"));
        in_balance(&followed);
        let corner = if in_space { json!([5, 0.5, 0.5]) } else { json!([5, 0.5]) };
        // A force on a corner bends the bar.
        scene["material"]["young"] = 1e5.into();
        scene["ties"] = json!([equal(json!({"point": corner}))]);
        scene["points"] = json!([guide("other", json!({"force": force(30.0)}))]);
        let of_node = answer(&scene);
        let about = if in_space { vec![0.0, 15.0, -15.0] } else { vec![-15.0] };
        check(&of_node, "ties[0]", 30.0, &about);
        check(&of_node, "supports[0]", -30.0, &about.iter().map(|part| -part).collect::<Vec<_>>());
    }
}

#[test]
fn points_that_cannot_be_read_are_refused_with_their_place() {
    let with = |points: Value, ties: Value, springs: Value| {
        let mut scene = bar("q4", 0.0);
        (scene["points"], scene["ties"], scene["springs"]) = (points, ties, springs);
        scene
    };
    let (end, none) = (json!([{"name": "end", "at": [5, 0]}]), json!([]));
    let coupled = json!([{"coupling": {"point": "end", "boundary": "right"}}]);
    let moved = |keys: Value| json!([point("end", "q4", keys)]);
    let equation = |term: Value| json!([{"equation": {"terms": [term]}}]);
    let two = json!([{"name": "end", "at": [5, 0], "force": [1, 0]}, {"name": "loose", "at": [6, 0]}]);
    let between = json!([{"on": {"reference": "end"}, "x": 1}, {"on": {"reference": "loose"}, "x": -1}]);
    for (scene, path, phrase) in [
        (with(json!([{"name": "", "at": [5, 0]}]), none.clone(), none.clone()), "points[0].name", "a name of its own"),
        (with(json!([{"name": "end", "at": [5]}]), none.clone(), none.clone()), "points[0].at", "has 1 entry"),
        (
            with(end.clone(), json!([{"coupling": {"point": "ent", "boundary": "right"}}]), none.clone()),
            "ties[0].coupling.point",
            "did you mean `end`?",
        ),
        (
            with(end.clone(), json!([{"coupling": {"point": "end"}}]), none.clone()),
            "ties[0].coupling",
            "needs either a `boundary` or `nodes`",
        ),
        (
            with(moved(json!({"x": 1, "force": [1, 0]})), coupled.clone(), none.clone()),
            "points[0].x",
            "a force along it does nothing",
        ),
        (with(moved(json!({"force": [1, 0]})), none.clone(), none.clone()), "points[0]", "nothing follows it"),
        (
            with(two.clone(), equation(json!({"on": {"reference": "end"}, "rotation": {"x": 1}})), none.clone()),
            "ties[0].equation.terms[0].rotation.x",
            "does not turn about x",
        ),
        (
            with(end.clone(), equation(json!({"on": {"point": [5, -0.5]}, "rotation": {"z": 1}})), none.clone()),
            "ties[0].equation.terms[0].rotation.z",
            "a node has no rotation",
        ),
        (
            with(two, json!([{"equation": {"terms": between}}]), none.clone()),
            "points[1]",
            "the reference point `loose` is free in `x`",
        ),
        (
            with(end.clone(), none.clone(), json!([{"terms": [{"on": {"reference": "end"}, "x": 1}], "along": 5}])),
            "springs[0]",
            "nothing but springs holds it",
        ),
        (
            with(
                end.clone(),
                coupled.clone(),
                json!([{"on": {"boundary": "top"}, "terms": [{"on": {"reference": "end"}, "x": 1}], "along": 5}]),
            ),
            "springs[0]",
            "has both a place `on` and `terms`",
        ),
        (
            with(moved(json!({"x": 0.5})), equation(json!({"on": {"reference": "end"}, "x": 1})), none.clone()),
            "ties[0]",
            "contradict this equation",
        ),
    ] {
        let Err(Error::Scene { path: at, message }) = build(&scene) else { panic!("{path}: there is a model") };
        assert!(at.starts_with(path) && message.contains(phrase), "{at}: {message}, not {path}: {phrase}");
    }
}

/// GOAL: a body that a coupling moves as a whole is certified though it has no energy; one that it leaves a rotation is
/// refused with that.
/// CONDITIONS: an elastic column behind a point at its foot: the point turns by 0.05; or springs hold all its motions
/// but the rotation about y, without a load and with an obstacle far away.
/// REFERENCE: the motion of a rigid body; the rotation.
#[test]
fn a_column_without_strain_follows_its_point_or_is_free_to_turn_with_it() {
    let column = |element: &str, cells: [usize; 2]| {
        let (across, along) =
            (json!({"points": [0, 10], "divisions": [cells[0]]}), json!({"points": [0, 100], "divisions": [cells[1]]}));
        json!({"model": "space", "body": {"box": {"x": across, "y": across, "z": along, "element": element}},
               "material": {"young": 2e5, "poisson": 0.3}, "ties": [{"coupling": {"point": "foot", "boundary": "bottom"}}]})
    };
    for (element, cells) in [("hex8", [2, 4]), ("hex20", [1, 2]), ("hex20", [2, 10])] {
        let mut scene = column(element, cells);
        let turn = json!({"x": 0, "y": 0.05, "z": 0});
        scene["points"] = json!([{"name": "foot", "at": [5, 5, 0], "x": 0, "y": 0, "z": 0, "rotation": turn}]);
        let turned = answer(&scene);
        let nodes = turned.model().mesh().nodes();
        for ([x, _, z], moved) in nodes.iter().zip(turned.displacement().chunks(3)) {
            near(moved, &[0.05 * z, 0.0, -0.05 * (x - 5.0)], 5.0);
        }
    }
    let mut scene = column("hex8", [2, 2]);
    let spring = |term: Value, along: f64| {
        let mut terms = json!([{"on": {"reference": "foot"}}]);
        term.as_object().unwrap().iter().for_each(|(key, value)| terms[0][key] = value.clone());
        json!({"terms": terms, "along": along})
    };
    scene["points"] = json!([{"name": "foot", "at": [5, 5, 0]}]);
    scene["springs"] = json!([
        spring(json!({"x": 1}), 100.0),
        spring(json!({"y": 1}), 100.0),
        spring(json!({"z": 1}), 100.0),
        spring(json!({"rotation": {"x": 1}}), 1e5),
        spring(json!({"rotation": {"z": 1}}), 1e5)
    ]);
    scene["obstacles"] = json!([{"boundary": "right", "approach": "+x",
        "shape": {"plane": {"point": [600, 0, 0], "normal": [1, 0, 0]}}}]);
    let model = build(&scene).unwrap();
    let error = model.explain(signorini::solve_qp(model.problem()).unwrap_err());
    let Error::Qp(qp::Error::UnderHeld { mode, .. }) = &error else { panic!("{error}") };
    assert!(mode.contains("rotation"), "{mode}");
}
