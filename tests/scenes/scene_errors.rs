//! Malformed scenes: each is refused in one sentence that names the place, the fault, and what is allowed.

use serde_json::{Value, json};
use signorini::{Error, Scene, qp};
use support::scenes::built;

/// A valid scene; each entry of the tables below changes one field.
fn right() -> Value {
    json!({
        "title": "right",
        "units": {"length": "m", "force": "N"},
        "model": "plane-strain",
        "thickness": 1,
        "body": {"rectangle": {
            "x": {"points": [0, 0.5, 1], "divisions": [2, 2], "ratios": [1, 2]},
            "y": {"points": [0, 1], "divisions": [4]},
            "element": "q4"
        }},
        "material": {"young": 1000, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "loads": [
            {"traction": {"boundary": "right", "value": [0, 1]}},
            {"force": {"at": [1, 1], "value": [0, 1]}},
            {"body-force": [0, -1]}
        ],
        "obstacles": [
            {"boundary": "top", "approach": "+y", "rule": "approach", "shape": {"circle": {"apex": [0, 1], "radius": 3}}}
        ],
        "gap": 0.0
    })
}

fn with(pointer: &str, value: Value) -> String {
    let mut scene = right();
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    let parent = scene.pointer_mut(parent).unwrap_or_else(|| panic!("no {parent}"));
    match parent {
        Value::Array(items) => items[key.parse::<usize>().unwrap()] = value,
        object => object[key] = value,
    }
    scene.to_string()
}

fn shape(shape: Value) -> String {
    with("/obstacles/0/shape", shape)
}

#[test]
fn the_scene_that_the_tables_change_is_valid() {
    built(&right());
}

#[test]
fn invalid_values_are_refused_at_their_path() {
    let x = "/body/rectangle/x";
    let table = |points: Value| shape(json!({"table": {"points": points}}));
    let plane = |normal: Value| shape(json!({"plane": {"point": [0, 1], "normal": normal}}));
    let circle = |fields: Value| shape(json!({"circle": fields}));
    let held = |supports: Value| with("/supports", supports);
    let at_corner = json!({"on": {"point": [0, 0]}, "x": 0.1});
    let cases = [
        (with("/thickness", json!(0)), "thickness", "must be positive"),
        (with("/thickness", json!(-1)), "thickness", "-1 is not allowed"),
        (with("/material/young", json!(0)), "material.young", "positive"),
        (with("/material/young", json!(-2e11)), "material.young", "-2e11"),
        (with("/material/poisson", json!(0.5)), "material.poisson", "below 0.5 in plane strain"),
        (with("/material/poisson", json!(-1)), "material.poisson", "above -1"),
        (with(&format!("{x}/points"), json!([0])), "body.rectangle.x.points", "at least two"),
        (with(&format!("{x}/points"), json!([0, 2, 1])), "body.rectangle.x.points[2]", "must increase"),
        (with(&format!("{x}/points"), json!([0, 1])), "body.rectangle.x.divisions", "length 2, but must have 1"),
        (with(&format!("{x}/divisions"), json!([0, 2])), "body.rectangle.x.divisions[0]", "at least 1"),
        (with(&format!("{x}/divisions"), json!([2, 1_000_000_000])), "body.rectangle.x.divisions[1]", "5000000 lines"),
        (with(&format!("{x}/divisions"), json!([9, u64::MAX])), "body.rectangle.x.divisions[1]", "lines"),
        (
            with(&format!("{x}/divisions"), json!([9, 6_000_000])),
            "body.rectangle.x.divisions[1]",
            "lines that an axis may",
        ),
        (with(&format!("{x}/ratios"), json!([1, -1])), "body.rectangle.x.ratios[1]", "positive"),
        (with(&format!("{x}/ratios"), json!([1])), "body.rectangle.x.ratios", "length 1, but must have 2"),
        (with("/supports/0/on/boundary", json!("floor")), "supports[0].on.boundary", "left, right, bottom, top"),
        (held(json!([{"on": {"boundary": "bottom"}}])), "supports[0]", "holds nothing"),
        (held(json!([{"on": {"point": [0.3, 0]}, "x": 0}])), "supports[0].on.point", "no node at (0.3, 0)"),
        (held(json!([right()["supports"][0], at_corner])), "supports[1].x", "contradicts the 0 that supports[0]"),
        (with("/loads/0/traction/boundary", json!("roof")), "loads[0].traction.boundary", "no boundary `roof`"),
        (with("/loads/1/force/at", json!([2, 2])), "loads[1].force.at", "nearest is node 24 at (1, 1)"),
        (with("/obstacles/0/boundary", json!("roof")), "obstacles[0].boundary", "no boundary `roof`"),
        (circle(json!({"apex": [0, 1], "radius": 0})), "obstacles[0].shape.circle.radius", "must be positive"),
        (circle(json!({"apex": [0, 1], "radius": -2})), "obstacles[0].shape.circle.radius", "-2"),
        (circle(json!({"radius": 1})), "obstacles[0].shape.circle", "neither `centre` nor `apex`"),
        (
            circle(json!({"radius": 1, "apex": [0, 0], "centre": [0, 1]})),
            "obstacles[0].shape.circle",
            "both `centre` and `apex`",
        ),
        (
            shape(json!({"parabola": {"apex": [0, 1], "radius": -1}})),
            "obstacles[0].shape.parabola.radius",
            "must be positive",
        ),
        (shape(json!({"wedge": {"apex": [0, 1], "slope": 0}})), "obstacles[0].shape.wedge.slope", "must be positive"),
        (plane(json!([0, 0])), "obstacles[0].shape.plane.normal", "no direction"),
        (plane(json!([0, -1])), "obstacles[0].shape.plane.normal", "into the obstacle"),
        (plane(json!([1, 0])), "obstacles[0].shape.plane.normal", "approach direction (0, 1)"),
        (table(json!([[0, 1]])), "obstacles[0].shape.table.points", "at least two points"),
        (table(json!([[0, 1], [2, 1], [1, 1]])), "obstacles[0].shape.table.points[2]", "x must increase"),
        (table(json!([[0, 1], [0, 2]])), "obstacles[0].shape.table.points[1]", "does not lie beyond"),
        (table(json!([[0, 1], [0.8, 1]])), "obstacles[0].shape.table.points", "needs it at x = 1"),
        (table(json!([[0.1, 1], [1, 1]])), "obstacles[0].shape.table.points", "from x = 0.1 to 1"),
    ];
    assert!(cases.len() >= 30);
    for (text, path, phrase) in cases {
        let error = Scene::from_json(&text, "scene").unwrap().build().unwrap_err();
        let Error::Scene { path: found, message } = &error else { panic!("{path}: {error}") };
        assert_eq!(found, path, "{error}");
        assert!(message.contains(phrase), "{error}\n  lacks: {phrase}");
        assert!(!error.to_string().contains('\n'), "the error is not one sentence: {error}");
    }
}

#[test]
fn a_scene_without_free_dofs_is_refused() {
    let mut scene = right();
    scene["body"]["rectangle"]["y"] = json!({"points": [0, 1], "divisions": [1]});
    scene["supports"] =
        json!([{"on": {"boundary": "bottom"}, "x": 0, "y": 0}, {"on": {"boundary": "top"}, "x": 0, "y": 0}]);
    let error = Scene::from_json(&scene.to_string(), "scene").unwrap().build().unwrap_err();
    assert!(matches!(&error, Error::Scene { path, .. } if path == "supports"), "{error}");
}

#[test]
fn plane_stress_accepts_a_ratio_of_one_half() {
    let mut scene = right();
    scene["model"] = json!("plane-stress");
    scene["material"]["poisson"] = json!(0.5);
    assert!(Scene::from_json(&scene.to_string(), "scene").unwrap().build().is_ok());
}

#[test]
fn invalid_scene_texts_are_refused_with_path_line_and_column() {
    let text = right().to_string();
    let without = |key: &str| {
        let mut scene = right();
        scene.as_object_mut().unwrap().remove(key);
        scene.to_string()
    };
    let raw = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    };
    let cases = [
        (with("/thicknes", json!(1)), "thicknes", "unknown key `thicknes`"),
        (
            with("/material/yuong", json!(1)),
            "material.yuong",
            "expected one of `young`, `poisson`, `orthotropic`, `expansion`, `density`",
        ),
        (with("/material/young", json!("1000")), "material.young", "must be a number"),
        (with("/material/young", json!(null)), "material.young", "must be a number"),
        (with("/model", json!("plain-strain")), "model", "expected one of `bar`, `plane-strain`, `plane-stress`"),
        (
            with("/body/rectangle/element", json!("q9")),
            "body.rectangle.element",
            "expected one of `t3`, `t6`, `q4`, `q8`",
        ),
        (with("/body/rectangle/x/divisions", json!([-3, 2])), "body.rectangle.x.divisions[0]", "not negative"),
        (with("/body/rectangle/x/divisions", json!([1.5, 2])), "body.rectangle.x.divisions[0]", "whole number"),
        (
            with("/body/rectangle/x/points", json!(3)),
            "body.rectangle.x.points",
            "must be an array of coordinates that increase, such as [0, 1]",
        ),
        (
            with("/body", json!({"blob": {}})),
            "body.blob",
            "unknown choice `blob`, expected one of `rectangle`, `bar`, `box`",
        ),
        (with("/obstacles/0/approach", json!("up")), "obstacles[0].approach", "`+x`, `-x`, `+y`, `-y`"),
        (with("/obstacles/0/rule", json!("closest")), "obstacles[0].rule", "`closest-point`"),
        (shape(json!({"helix": {}})), "obstacles[0].shape.helix", "`plane`"),
        (
            shape(json!({"circle": {"apex": [0, 1, 2], "radius": 1}})),
            "obstacles[0].shape.circle.apex",
            "so that it must have 2: [x, y]",
        ),
        (
            shape(json!({"circle": {"apex": [0], "radius": 1}})),
            "obstacles[0].shape.circle.apex",
            "the array has 1 entry; `circle` is a shape of the plane",
        ),
        (shape(json!({"wedge": {"apex": [0, 1]}})), "obstacles[0].shape.wedge", "the key `slope` is missing"),
        (without("body"), ".", "the key `body` is missing"),
        (
            with("/loads/0", json!({"traction": {"boundary": "top", "value": [0, 1]}, "body-force": [0, 1]})),
            "loads[0]",
            "single key",
        ),
        (with("/loads/0", json!({"stress": 1})), "loads[0].stress", "unknown choice `stress`"),
        (with("/loads/0", json!({"pressure": 1})), "loads[0].pressure", "must be an object"),
        (with("/supports/0/x", json!(null)), "supports[0].x", "null is not a number"),
        (with("/body", json!({})), "body", "a single key, but is empty"),
        (with("/body", json!([])), "body", "must be an object with a single key, but is an array"),
        (with("/supports/0/on", json!("bottom")), "supports[0].on", "must be an object with a single key"),
        (with("/model", json!(5)), "model", "must be a string, but is the number 5"),
        (with("/obstacles/0/rule", json!(["approach"])), "obstacles[0].rule", "must be a string, but is an array"),
        (with("/supports/0/on", json!({"edge": "top"})), "supports[0].on.edge", "one of `boundary`, `point`, `nodes`"),
        (with("/gap", json!([0])), "gap", "must be a number"),
        // An array in place of an object: serde alone would fill the fields in order.
        (with("/material", json!([1000, 0.3])), "material", "must be an object"),
        (with("/units", json!(["m", "N"])), "units", "must be an object"),
        (with("/body/rectangle/x", json!([[0, 1], [4]])), "body.rectangle.x", "must be an object"),
        (with("/supports/0", json!([{"boundary": "top"}, 0, 0])), "supports[0]", "must be an object"),
        (with("/loads/0/traction", json!(["top", [0, 1]])), "loads[0].traction", "must be an object"),
        (with("/obstacles", json!({})), "obstacles", "must be an array of objects"),
        ("[]".into(), ".", "must be an object"),
        // Text that is not JSON.
        (raw("\"gap\":0.0", "\"gap\":NaN"), "gap", "expected"),
        (raw("\"gap\":0.0", "\"gap\":1e999"), "gap", "number out of range"),
        (raw("\"x\":0,\"y\":0", "\"normal\":[1,1e999]"), "supports[0].normal[1]", "number out of range"),
        (raw("\"gap\":0.0", "\"gap\":0.0,\"gap\":1"), "gap", "the key `gap` stands twice"),
        (raw("\"young\":1000", "\"young\":1000,\"young\":1"), "material.young", "the key `young` stands twice"),
        (format!("{text} x"), ".", "more text after the end of the scene"),
        (text[..text.len() / 2].into(), "", "text ends"),
        (String::new(), ".", "text ends"),
    ];
    assert!(cases.len() >= 30);
    for (text, path, phrase) in cases {
        let error = Scene::from_json(&text, "the scene").unwrap_err();
        let Error::SceneSyntax { source_name, line, path: found, message, .. } = &error else { panic!("{error}") };
        assert_eq!((source_name.as_str(), *line > 0), ("the scene", true), "{error}");
        assert!(path.is_empty() || found == path, "{error}\n  path should be: {path}");
        assert!(message.contains(phrase), "{error}\n  lacks: {phrase}");
        assert!(
            !message.contains("line") && !message.contains("variant"),
            "the message repeats the position or contains words of Rust: {error}"
        );
    }
}

#[test]
fn line_and_column_are_those_of_the_value() {
    let text = "{\n  \"body\": 3\n}";
    let Err(Error::SceneSyntax { line, column, .. }) = Scene::from_json(text, "scene") else { panic!() };
    assert_eq!((line, column > 8), (2, true));
}

#[test]
fn an_array_in_place_of_an_object_is_refused_everywhere() {
    fn objects(value: &Value, at: String, found: &mut Vec<String>) {
        match value {
            Value::Object(fields) => {
                found.push(at.clone());
                fields.iter().for_each(|(key, value)| objects(value, format!("{at}/{key}"), found));
            }
            Value::Array(items) => {
                items.iter().enumerate().for_each(|(i, value)| objects(value, format!("{at}/{i}"), found));
            }
            _ => {}
        }
    }
    let mut found = Vec::new();
    objects(&right(), String::new(), &mut found);
    assert!(found.len() > 12, "{found:?}");
    for pointer in found {
        let mut scene = right();
        let place = scene.pointer_mut(&pointer).unwrap();
        *place = Value::Array(place.as_object().unwrap().values().cloned().collect());
        assert!(Scene::from_json(&scene.to_string(), "scene").is_err(), "an array is accepted at {pointer}");
    }
}

#[test]
fn a_schema_address_and_a_byte_order_mark_are_accepted() {
    let text = format!("\u{feff}{}", with("/$schema", json!("https://example.org/scene.json")));
    assert!(Scene::from_json(&text, "scene").is_ok());
}

#[test]
fn a_missing_scene_file_is_named() {
    let error = Scene::read("no/such/scene.json").unwrap_err();
    assert!(matches!(&error, Error::Linear(qp::LinearError::File { action: "read", .. })));
    assert!(error.to_string().contains("no/such/scene.json"), "{error}");
}

#[test]
fn the_schema_names_every_field_of_a_scene() {
    let schema: Value = serde_json::from_str(&Scene::json_schema()).unwrap();
    for key in right().as_object().unwrap().keys().map(String::as_str).chain(["$schema"]) {
        assert!(schema["properties"].get(key).is_some(), "{key}: {schema:#}");
    }
    assert_eq!(schema["additionalProperties"], json!(false));
    assert_eq!(schema["required"], json!(["body"]));
}

#[test]
fn values_that_are_not_finite_are_refused_in_scenes_built_in_rust() {
    let scene = Scene::from_json(&right().to_string(), "scene").unwrap();
    let refused = |change: &dyn Fn(&mut Scene), path: &str| {
        let mut scene = scene.clone();
        change(&mut scene);
        let error = scene.build().unwrap_err();
        assert!(matches!(&error, Error::Scene { path: found, .. } if found == path), "{error}");
    };
    refused(&|scene| scene.gap = f64::NAN, "gap");
    refused(&|scene| scene.thickness = f64::INFINITY, "thickness");
    refused(&|scene| scene.material.as_mut().unwrap().young = Some(f64::NAN), "material.young");
    refused(&|scene| scene.supports[0].x = Some(f64::NAN), "supports[0].x");
    refused(&|scene| scene.supports[0].normal = Some(vec![1.0, f64::INFINITY]), "supports[0].normal[1]");
    let value = |scene: &mut Scene| {
        (scene.supports[0].normal, scene.supports[0].value) = (Some(vec![1.0, 1.0]), Some(f64::NAN));
    };
    refused(&value, "supports[0].value");
}
