//! The printed schema of a scene: every example conforms to it, and the program refuses every scene that the schema
//! refuses.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use signorini::Scene;
use support::program::{Desk, example, examples, says, scene};

/// Returns an error if `value` does not have the form of `schema`. Supports the keywords that the schema of a scene
/// uses.
fn conforms(value: &Value, schema: &Value, root: &Value) -> Result<(), String> {
    let keys = |value: &Value| value.as_object().map(|map| map.keys().cloned().collect::<Vec<_>>()).unwrap_or_default();
    for word in keys(schema) {
        let known = [
            "$defs",
            "$id",
            "$ref",
            "$schema",
            "title",
            "description",
            "default",
            "format",
            "minimum",
            "exclusiveMinimum",
            "maximum",
            "minLength",
            "type",
            "const",
            "enum",
            "oneOf",
            "anyOf",
            "items",
            "minItems",
            "maxItems",
            "properties",
            "required",
            "additionalProperties",
        ];
        assert!(known.contains(&word.as_str()), "the test does not know the word `{word}`");
    }
    if let Some(reference) = schema["$ref"].as_str() {
        let target = root.pointer(reference.trim_start_matches('#')).ok_or("a reference to nothing")?;
        conforms(value, target, root)?;
    }
    if let Some(kinds) = schema.get("type") {
        let is = |kind: &Value| match kind.as_str() {
            Some("object") => value.is_object(),
            Some("array") => value.is_array(),
            Some("string") => value.is_string(),
            Some("number") => value.is_number(),
            Some("integer") => value.is_u64(),
            Some("null") => value.is_null(),
            _ => false,
        };
        if !kinds.as_array().map_or_else(|| is(kinds), |kinds| kinds.iter().any(is)) {
            return Err(format!("{value} is not of type {kinds}"));
        }
    }
    if let Some(number) = value.as_f64() {
        let bound = |word: &str| schema[word].as_f64();
        let is_within = bound("minimum").is_none_or(|least| number >= least)
            && bound("exclusiveMinimum").is_none_or(|least| number > least)
            && bound("maximum").is_none_or(|most| number <= most);
        if !is_within {
            return Err(format!("{number} is out of its range"));
        }
    }
    if value.as_str().is_some_and(|text| (text.len() as u64) < schema["minLength"].as_u64().unwrap_or(0)) {
        return Err("the text is too short".into());
    }
    if schema.get("const").is_some_and(|constant| constant != value) {
        return Err(format!("{value} is not {}", schema["const"]));
    }
    if schema["enum"].as_array().is_some_and(|choices| !choices.contains(value)) {
        return Err(format!("{value} is not one of {}", schema["enum"]));
    }
    for (word, allowed) in [("oneOf", 1..=1), ("anyOf", 1..=usize::MAX)] {
        if let Some(choices) = schema[word].as_array() {
            let fitting = choices.iter().filter(|choice| conforms(value, choice, root).is_ok()).count();
            if !allowed.contains(&fitting) {
                return Err(format!("{value} fits {fitting} of {word}"));
            }
        }
    }
    if let (Some(items), Some(of)) = (value.as_array(), schema.get("items")) {
        items.iter().try_for_each(|item| conforms(item, of, root))?;
        let bounds = [schema["minItems"].as_u64().unwrap_or(0), schema["maxItems"].as_u64().unwrap_or(u64::MAX)];
        if !(bounds[0]..=bounds[1]).contains(&(items.len() as u64)) {
            return Err(format!("{value} has {} items", items.len()));
        }
    }
    let mut required = schema["required"].as_array().filter(|_| value.is_object()).into_iter().flatten();
    if let Some(missing) = required.find(|key| value.get(key.as_str().unwrap()).is_none()) {
        return Err(format!("{missing} is missing"));
    }
    for key in keys(value) {
        match schema["properties"].get(&key) {
            Some(of) => conforms(&value[&key], of, root).map_err(|error| format!("{key}: {error}"))?,
            None if schema["additionalProperties"] == false => return Err(format!("unknown {key}")),
            None => {}
        }
    }
    Ok(())
}

#[test]
fn every_example_conforms_to_the_printed_schema_and_a_misspelt_one_does_not() {
    let schema = Desk::new().run(&["schema"]).ends_with(0).json();
    for name in examples() {
        let scene: Value = serde_json::from_str(&fs::read_to_string(example(&name)).unwrap()).unwrap();
        conforms(&scene, &schema, &schema).unwrap_or_else(|error| panic!("{name}: {error}"));
    }
    conforms(&scene(), &schema, &schema).unwrap();
    for (pointer, value) in [
        ("/material", json!({"young": 1e7, "nu": 0.3})),
        ("/body", json!({"blob": {}})),
        ("/supports/0/on", json!("bottom")),
        ("/obstacles/0/approach", json!("up")),
        ("/loads/0", json!({"traction": {"boundary": "top"}})),
        ("/gap", json!("0")),
    ] {
        let mut wrong = scene();
        *wrong.pointer_mut(pointer).unwrap() = value;
        assert!(conforms(&wrong, &schema, &schema).is_err(), "{pointer}");
    }
}

/// The scenes of `tests/wrong_scenes.json`: a description of the fault, and the scene.
fn wrong_scenes() -> Vec<(String, Value)> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/wrong_scenes.json");
    let file: Value = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
    let change = |change: &Value| {
        let mut scene = file["base"].clone();
        let (place, key) = change["at"].as_str().unwrap().rsplit_once('/').unwrap();
        let place = scene.pointer_mut(place).unwrap();
        match (place, change.get("value")) {
            (Value::Array(items), Some(value)) => items[key.parse::<usize>().unwrap()] = value.clone(),
            (Value::Object(fields), Some(value)) => drop(fields.insert(key.to_string(), value.clone())),
            (Value::Object(fields), None) => drop(fields.remove(key).unwrap()),
            (place, _) => panic!("{place} has no {key}"),
        }
        (change["wrong"].as_str().unwrap().to_string(), scene)
    };
    file["changes"].as_array().unwrap().iter().map(change).collect()
}

#[test]
fn the_program_refuses_every_scene_that_the_schema_refuses() {
    let desk = Desk::new();
    let schema = desk.run(&["schema"]).ends_with(0).json();
    let file = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/wrong_scenes.json")).unwrap();
    let base = &serde_json::from_str::<Value>(&file).unwrap()["base"];
    conforms(base, &schema, &schema).unwrap();
    desk.write("base.json", base.to_string());
    desk.run(&["solve", "base.json"]).ends_with(0);
    let wrong = wrong_scenes();
    assert!(wrong.len() >= 20, "{}", wrong.len());
    for (what, scene) in wrong {
        assert!(conforms(&scene, &schema, &schema).is_err(), "the schema accepts {what}");
        desk.write("wrong.json", scene.to_string());
        let run = desk.run(&["solve", "wrong.json"]);
        assert_eq!(run.code, 1, "the program accepts {what}: {}{}", run.stdout, run.stderr);
    }
}

#[test]
fn the_schema_has_a_name_and_no_null() {
    let schema = Desk::new().run(&["schema"]).ends_with(0).json();
    assert_eq!(schema["$id"], format!("urn:signorini:scene:{}", env!("CARGO_PKG_VERSION")));
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    assert!(schema["properties"]["$schema"]["description"].as_str().unwrap().contains("for editors"));
    assert!(!schema.to_string().contains("null"));
}

/// The places of all integers in `schema`, as pointers.
fn integers(schema: &Value, place: &str, found: &mut BTreeSet<String>) {
    match schema {
        Value::Object(map) => {
            if map.get("type").is_some_and(|kind| kind == "integer") {
                found.insert(place.to_string());
            }
            map.iter().for_each(|(key, of)| integers(of, &format!("{place}/{key}"), found));
        }
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(index, of)| integers(of, &format!("{place}/{index}"), found));
        }
        _ => {}
    }
}

/// The same for the integers of `value`, at `at`, by the places of the schema that they conform to.
fn integers_of(value: &Value, at: &str, place: &str, root: &Value, found: &mut BTreeMap<String, String>) {
    let schema = root.pointer(place).unwrap();
    if let Some(reference) = schema["$ref"].as_str() {
        integers_of(value, at, reference.trim_start_matches('#'), root, found);
    }
    if schema["type"] == "integer" {
        found.entry(place.to_string()).or_insert(at.to_string());
    }
    for word in ["oneOf", "anyOf"] {
        for (index, choice) in schema[word].as_array().into_iter().flatten().enumerate() {
            if conforms(value, choice, root).is_ok() {
                integers_of(value, at, &format!("{place}/{word}/{index}"), root, found);
            }
        }
    }
    if schema.get("items").is_some() {
        for (index, item) in value.as_array().into_iter().flatten().enumerate() {
            integers_of(item, &format!("{at}/{index}"), &format!("{place}/items"), root, found);
        }
    }
    for (key, item) in value.as_object().into_iter().flatten() {
        if schema["properties"].get(key).is_some() {
            integers_of(item, &format!("{at}/{key}"), &format!("{place}/properties/{key}"), root, found);
        }
    }
}

/// The place of a value as messages name it: `/body/x/0` is `body.x[0]`.
fn named(at: &str) -> String {
    let parts = at.split('/').skip(1).map(|part| match part.parse::<usize>() {
        Ok(index) => format!("[{index}]"),
        Err(_) => format!(".{part}"),
    });
    parts.collect::<String>().trim_start_matches('.').to_string()
}

#[test]
fn every_integer_of_the_schema_refuses_all_that_is_no_whole_number_in_digits() {
    let schema = Desk::new().run(&["schema"]).ends_with(0).json();
    let mut all = BTreeSet::new();
    integers(&schema, "", &mut all);
    let mut moving = scene();
    moving["format"] = json!(1);
    moving["analysis"] = json!({"dynamic": {
        "duration": 1e-3, "frames": 2, "watch": [{"node": 0}], "loads-in-time": [{"load": 0, "factor": {"ramp": {"end": 1}}}],
        "obstacles-in-time": [{"obstacle": 0, "shift": 0.1, "factor": {"ramp": {"end": 1}}}]
    }});
    let mut vibrating = scene();
    vibrating["analysis"] = json!({"modes": {"count": 3}});
    let mut stepped = scene();
    stepped["body"] = json!({"deck": {"file": "part.inp", "step": 1}});
    let examples = examples().into_iter().map(|name| fs::read_to_string(example(&name)).unwrap());
    let mut kept: BTreeMap<String, (String, Value)> = BTreeMap::new();
    for scene in examples.map(|text| serde_json::from_str(&text).unwrap()).chain([moving, vibrating, stepped]) {
        conforms(&scene, &schema, &schema).unwrap();
        let mut found = BTreeMap::new();
        integers_of(&scene, "", "", &schema, &mut found);
        for (place, at) in found {
            kept.entry(place).or_insert((at, scene.clone()));
        }
    }
    assert_eq!(kept.keys().cloned().collect::<BTreeSet<_>>(), all, "no scene has some of the integers");
    let wrong = [json!(1.5), json!(2.0), json!(0.5), json!(1e300), json!(-1), json!("2"), json!(true), json!([1])];
    for (place, (at, scene)) in kept {
        for value in &wrong {
            let mut wrong = scene.clone();
            *wrong.pointer_mut(&at).unwrap() = value.clone();
            assert!(conforms(&wrong, &schema, &schema).is_err(), "the schema accepts {value} at {place}");
            let expected =
                format!("at `{}`: must be a whole number that is not negative, in digits alone, but is ", named(&at));
            says(&Scene::from_json(&wrong.to_string(), "wrong.json").unwrap_err().to_string(), &[&expected]);
        }
    }
}
