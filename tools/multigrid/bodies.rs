//! Bodies other than the block, for some of which the number of cycles grows.

use serde_json::{Value, json};

fn axis(length: f64, cells: usize) -> Value {
    json!({"points": [0, length], "divisions": [cells]})
}

fn clamped(side: &str) -> Value {
    json!([{"on": {"boundary": side}, "x": 0, "y": 0, "z": 0}])
}

/// A box under a sphere of radius 2 m above the centre of its top.
fn under_sphere(lengths: [f64; 3], cells: [usize; 3], element: &str, poisson: f64) -> Value {
    let [x, y, z] = [0, 1, 2].map(|i| axis(lengths[i], cells[i]));
    json!({
        "model": "space",
        "body": {"box": {"x": x, "y": y, "z": z, "element": element}},
        "material": {"young": 1e7, "poisson": poisson},
        "supports": clamped("bottom"),
        "obstacles": [{"boundary": "top", "approach": "+z", "rule": "approach",
                       "shape": {"sphere": {"apex": [lengths[0] / 2.0, lengths[1] / 2.0, lengths[2]], "radius": 2}}}],
        "gap": -0.01,
    })
}

fn plate(support: &str) -> Value {
    let mut scene = under_sphere([1.0, 1.0, 0.02], [100, 100, 6], "hex8", 0.3);
    scene["supports"] = clamped(support);
    scene["gap"] = json!(-0.0005);
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
    let mut floating = under_sphere([1.0; 3], [24; 3], "hex8", 0.3);
    floating["supports"] = json!([{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "front"}, "y": 0}]);
    floating["loads"] = json!([{"traction": {"boundary": "bottom", "value": [0, 0, 1e5]}}]);
    floating["gap"] = json!(0);
    let plane = json!({
        "model": "plane-strain",
        "body": {"rectangle": {"x": axis(1.0, 700), "y": axis(1.0, 700), "element": "q4"}},
        "material": {"young": 1e7, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "obstacles": [{"boundary": "top", "approach": "+y", "rule": "approach",
                       "shape": {"parabola": {"apex": [0.5, 1], "radius": 2}}}],
        "gap": -0.01,
    });
    let quadratic = |element: &str, poisson: f64| {
        let cells = if element == "tet10" { 9 } else { 11 };
        under_sphere([1.0; 3], [cells; 3], element, poisson)
    };
    vec![
        ("block of Tet10, nu = 0.3", quadratic("tet10", 0.3)),
        ("block of Tet10, nu = 0.499", quadratic("tet10", 0.499)),
        ("block of Tet10, nu = 0.4999", quadratic("tet10", 0.4999)),
        ("block of Hex20, nu = 0.3", quadratic("hex20", 0.3)),
        ("block of Hex20, nu = 0.499", quadratic("hex20", 0.499)),
        ("block of Hex20, nu = 0.4999", quadratic("hex20", 0.4999)),
        ("block, nu = 0.49", under_sphere([1.0; 3], [32; 3], "hex8", 0.49)),
        ("block of Tet4", under_sphere([1.0; 3], [32; 3], "tet4", 0.3)),
        ("plate 1:50, on its face", plate("bottom")),
        ("plate 1:50, on one edge", plate("left")),
        ("half ball on a plane, graded", ball),
        ("two half balls, graded", two),
        ("block that only contact holds along z", floating),
        ("square of Q4, plane strain", plane),
    ]
}
