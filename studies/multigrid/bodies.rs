//! Bodies other than the block, for some of which the number of cycles grows.

use serde_json::{Value, json};

use crate::block::block;

fn clamped(side: &str) -> Value {
    json!([{"on": {"boundary": side}, "x": 0, "y": 0, "z": 0}])
}

/// A cube under a sphere.
fn cube(cells: usize, element: &str, poisson: f64) -> Value {
    let mut scene = block([1.0; 3], [cells; 3], element, 2.0, -0.01);
    scene["material"]["poisson"] = json!(poisson);
    scene
}

fn plate(support: &str) -> Value {
    let mut scene = block([1.0, 1.0, 0.02], [100, 100, 6], "hex8", 2.0, -0.0005);
    scene["supports"] = clamped(support);
    scene
}

fn half_ball(half: Option<&str>, centre: f64) -> Value {
    let zone = json!({"width": 0.1, "divisions": 8, "growth": 1.25});
    let mut ball = json!({"half-ball": {"centre": [0, 0, centre], "radius": 1, "zone": zone}});
    if let Some(half) = half {
        ball["half-ball"]["half"] = json!(half);
    }
    ball
}

/// Returns the names and scenes of all bodies.
pub fn bodies() -> Vec<(&'static str, Value)> {
    let held = |boundary: &str, z: f64| json!({"on": {"boundary": boundary}, "x": 0, "y": 0, "z": z});
    let ball = json!({
        "model": "space", "body": half_ball(None, 1.0), "material": {"young": 1e7, "poisson": 0.3},
        "supports": [held("cut", -0.002)],
        "obstacles": [{"boundary": "round", "approach": "-z",
                       "shape": {"plane": {"point": [0, 0, 0], "normal": [0, 0, -1]}}}],
    });
    let two = json!({
        "model": "space", "body": half_ball(Some("lower"), 1.0), "material": {"young": 2e7, "poisson": 0.3},
        "further-bodies": [{"name": "base", "body": half_ball(Some("upper"), -1.0),
                            "material": {"young": 1e7, "poisson": 0.2}}],
        "supports": [held("cut", -0.004), held("base.cut", 0.0)],
        "obstacles": [{"boundary": "round", "approach": "-z", "shape": {"body": {"boundary": "base.round"}}}],
    });
    let mut floating = cube(24, "hex8", 0.3);
    floating["supports"] = json!([{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "front"}, "y": 0}]);
    floating["loads"] = json!([{"traction": {"boundary": "bottom", "value": [0, 0, 1e5]}}]);
    floating["gap"] = json!(0);
    vec![
        ("block of Tet10, nu = 0.3", cube(9, "tet10", 0.3)),
        ("block of Tet10, nu = 0.499", cube(9, "tet10", 0.499)),
        ("block of Tet10, nu = 0.4999", cube(9, "tet10", 0.4999)),
        ("block of Hex20, nu = 0.3", cube(11, "hex20", 0.3)),
        ("block of Hex20, nu = 0.499", cube(11, "hex20", 0.499)),
        ("block of Hex20, nu = 0.4999", cube(11, "hex20", 0.4999)),
        ("block, nu = 0.49", cube(32, "hex8", 0.49)),
        ("block of Tet4", cube(32, "tet4", 0.3)),
        ("plate 1:50, on its face", plate("bottom")),
        ("plate 1:50, on one edge", plate("left")),
        ("half ball on a plane, graded", ball),
        ("two half balls, graded", two),
        ("block that only contact holds along z", floating),
        ("square of Q4, plane strain", block([1.0; 2], [700; 2], "q4", 2.0, -0.01)),
    ]
}
