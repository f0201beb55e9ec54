//! The table of `docs/accuracy.md` of what a scene may contain, as the program answers.

use crate::total_error::{block, classical};
use serde_json::{Value, json};
use signorini::Scene;
use signorini::study::{Status, total_error};

/// A ring about an axis.
fn ring() -> Value {
    let mut scene = classical(0.3);
    scene["model"] = json!("axisymmetric");
    scene["body"]["rectangle"]["x"] = json!({"points": [0.25, 1.25], "divisions": [8]});
    scene
}

/// What a scene has, with the keys that this changes in the plane and in space.
fn kinds() -> Vec<(&'static str, [Value; 2])> {
    let orthotropic = json!({"young": [1e7, 3e6, 3e6], "poisson": [0.3, 0.3, 0.3], "shear": [2e6, 1e6, 2e6]});
    let around = |line: Value| {
        let mut material = orthotropic.clone();
        material["around"] = line;
        json!({"material": {"orthotropic": material}})
    };
    let both = |changes: Value| [changes.clone(), changes];
    let on_left = |key: &str, entry: Value| both(json!({key: [entry]}));
    let profile = |kink: f64, axes: usize| {
        let mut along = vec![0.0; axes];
        along[axes - 1] = 1.0;
        json!({"loads": [{"pressure": {"boundary": "left", "value": 1e4,
            "profile": {"along": along, "places": [0, kink, 0.5], "factors": [1, 0, 0]}}}]})
    };
    let supported = |entry: [Value; 2]| {
        [("classical", entry[0].clone()), ("block", entry[1].clone())].map(|(which, entry)| {
            let scene = if which == "classical" { classical(0.3) } else { block(2) };
            let mut supports = scene["supports"].as_array().unwrap().clone();
            supports.push(entry);
            json!({"supports": supports})
        })
    };
    let obstacle = |key: &str, value: Value| {
        [classical(0.3), block(2)].map(|scene| {
            let mut obstacles = scene["obstacles"].clone();
            obstacles[0][key] = value.clone();
            json!({"obstacles": obstacles})
        })
    };
    let planes = [
        json!({"plane": {"point": [0.5, 0.499], "normal": [0.1, 1]}}),
        json!({"plane": {"point": [0.5, 0.5, 0.499], "normal": [0.1, 0, 1]}}),
    ];
    let on_plane = [classical(0.3), block(2)].into_iter().zip(planes).map(|(scene, plane)| {
        let mut obstacles = scene["obstacles"].clone();
        (obstacles[0]["shape"], obstacles[0]["rule"]) = (plane, json!("closest-point"));
        json!({"obstacles": obstacles})
    });
    let on_plane: Vec<Value> = on_plane.collect();
    let lowered = |axes: usize| {
        let last = ["y", "z"][axes - 2];
        let line = |from: f64, to: f64, cells: usize| json!({"points": [from, to], "divisions": [cells]});
        let mut support = json!({"on": {"boundary": "cap.top"}, "x": 0, "y": 0});
        support[last] = json!(-0.01);
        let body = match axes {
            2 => json!({"rectangle": {"x": line(0.3, 0.7, 5), "y": line(0.5, 0.7, 2)}}),
            _ => {
                json!({"box": {"x": line(0.3, 0.7, 2), "y": line(0.3, 0.7, 2), "z": line(0.5, 0.7, 1), "element": "tet4"}})
            }
        };
        let scene = if axes == 2 { classical(0.3) } else { block(2) };
        let mut supports = scene["supports"].as_array().unwrap().clone();
        supports.push(support);
        json!({"further-bodies": [{"name": "cap", "body": body, "material": {"young": 3e6, "poisson": 0.3}}], "supports": supports,
            "obstacles": [{"boundary": "top", "approach": format!("+{last}"), "shape": {"body": {"boundary": "cap.bottom"}}}]})
    };
    let tied = [2, 3].map(|axes| {
        let mut scene = lowered(axes);
        if axes == 3 {
            // The faces of both bodies are the same.
            for axis in ["x", "y"] {
                scene["further-bodies"][0]["body"]["box"][axis] = json!({"points": [0.25, 0.75], "divisions": [2]});
            }
        }
        scene["ties"] = json!([{"surfaces": {"boundary": "cap.bottom", "to": "top"}}]);
        scene["obstacles"][0] = json!({"boundary": "right", "approach": "+x",
            "shape": {"plane": {"point": ([1.26, 0.0, 0.0][..axes]), "normal": ([1, 0, 0][..axes])}}});
        scene
    });
    vec![
        ("one material, supports along axes, constant loads", both(json!({}))),
        ("several materials", [[[0.0, 0.0, 0.0], [0.5, 0.25, 0.0]], [[0.0; 3], [0.5, 1.0, 0.25]]].map(|[min, max]| {
            let axes = if max[2] == 0.0 { 2 } else { 3 };
            json!({"materials": [{"box": {"min": min[..axes], "max": max[..axes]}, "material": {"young": 3e6, "poisson": 0.2}}]})
        })),
        ("an orthotropic material", both(json!({"material": {"orthotropic": orthotropic}}))),
        ("`temperature`, `initial-stress`", both(json!({"temperature": [{"value": 10}], "initial-stress": [{"xx": 100.0}],
            "material": {"young": 1e7, "poisson": 0.3, "expansion": 1e-5}}))),
        ("`springs` under a boundary", on_left("springs", json!({"on": {"boundary": "left"}, "normal": 1e6}))),
        ("`rigid-faces`", both(json!({"supports": [], "springs": [{"on": {"boundary": "bottom"}, "normal": 1e8, "x": 1e8, "y": 1e8}],
            "rigid-faces": [{"boundary": "right"}]}))),
        ("an inclined support", supported([json!({"on": {"boundary": "left"}, "normal": [1, 1]}),
            json!({"on": {"boundary": "left"}, "normal": [1, 0, 1]})])),
        ("an obstacle that a `force` presses", obstacle("force", json!(100.0))),
        ("`moment`", [json!([1e3]), json!([0, 1e2, 0])].map(|value| json!({"loads": [{"moment": {"boundary": "left", "value": value}}]}))),
        ("`profile` with kinks at nodes", [profile(0.25, 2), profile(0.25, 3)]),
        ("rows along the normal of a plane", [on_plane[0].clone(), on_plane[1].clone()]),
        ("several bodies, rows along one direction", [lowered(2), lowered(3)]),
        ("tied `surfaces`, with the same faces in space", tied),
        ("`profile` with a kink inside an edge", [profile(0.3, 2), profile(0.3, 3)]),
        ("rows along normals that change", obstacle("rule", json!("closest-point"))),
        ("a support at a point", supported([json!({"on": {"point": [1, 0.5]}, "x": 0}), json!({"on": {"point": [0, 0, 0.5]}, "x": 0})])),
        ("a spring at a point", [[1.0, 0.5, 0.0], [0.0, 0.0, 0.5]].into_iter().zip([2, 3]).map(|(at, axes)|
            json!({"springs": [{"on": {"point": at[..axes]}, "x": 1e3}]})).collect::<Vec<_>>().try_into().unwrap()),
        ("`centrifugal` loads", [json!({"omega": 10}), json!({"omega": 10, "axis": [0, 0, 1]})].map(|spec| {
            json!({"material": {"young": 1e7, "poisson": 0.3, "density": 1}, "loads": [{"centrifugal": spec}]})
        })),
        ("orthotropy around a line", [around(json!({"point": [0.5, -2]})), around(json!({"point": [0.5, -2, 0], "along": [0, 0, 1]}))]),
    ]
}

/// What this changes about an axis, if that is not as in the plane; `None` where it does not exist.
fn about_axis(name: &str, in_plane: &Value) -> Option<Value> {
    match name {
        "`moment`" | "orthotropy around a line" => None,
        "`rigid-faces`" => {
            Some(json!({"supports": [{"on": {"boundary": "left"}, "y": 0}], "rigid-faces": [{"boundary": "right"}]}))
        }
        _ => Some(in_plane.clone()),
    }
}

#[test]
fn the_table_of_guarantees_is_what_the_program_answers() {
    let mut table = String::new();
    for (name, [in_plane, in_space]) in kinds() {
        let around = about_axis(name, &in_plane);
        let scenes = [(classical(0.3), Some(in_plane)), (ring(), around), (block(2), Some(in_space))];
        let words = scenes.into_iter().map(|(mut scene, changes)| {
            let Some(changes) = changes else { return "-" };
            for (key, value) in changes.as_object().unwrap() {
                scene[key] = value.clone();
            }
            let scene = Scene::from_json(&scene.to_string(), name).unwrap();
            let found = total_error(&scene, 0.9).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(found.status, Status::Certified, "{name}");
            let is_guaranteed = found.total_error.guaranteed;
            let reason = found.reason.unwrap_or_default();
            assert!(is_guaranteed || reason.contains("no guaranteed bound"), "{name}: {reason}");
            if is_guaranteed { "guaranteed" } else { "estimated" }
        });
        table += &format!("| {name} | {} |\n", words.collect::<Vec<_>>().join(" | "));
    }
    let document = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/accuracy.md")).unwrap();
    assert!(document.contains(&table), "docs/accuracy.md must contain\n{table}");
}
