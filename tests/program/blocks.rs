//! Scenes of a few hundred to some ten thousand dofs for the tests of memory and time limits.
#![cfg(target_os = "linux")]

use serde_json::{Value, json};

/// A block of `cells` cells along x and y, one unit high, under a parabola.
pub fn block(cells: [usize; 2], element: &str) -> Value {
    let width = cells[0] as f64 / cells[1] as f64;
    let axis = |length: f64, cells: usize| json!({"points": [0, length], "divisions": [cells]});
    json!({
        "body": {"rectangle": {"x": axis(width, cells[0]), "y": axis(1.0, cells[1]), "element": element}},
        "material": {"young": 1000, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "obstacles": [{"boundary": "top", "approach": "+y",
            "shape": {"parabola": {"apex": [width / 2.0, 1], "radius": 1}}}],
        "gap": -0.01
    })
}

pub fn cube(cells: usize, element: &str) -> Value {
    let axis = json!({"points": [0, 1], "divisions": [cells]});
    json!({
        "model": "space",
        "body": {"box": {"x": axis, "y": axis, "z": axis, "element": element}},
        "material": {"young": 1000, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": 0}],
        "obstacles": [{"boundary": "top", "approach": "+z",
            "shape": {"sphere": {"apex": [0.5, 0.5, 1], "radius": 1}}}],
        "gap": -0.01
    })
}

/// The scene with a force that presses its obstacle, instead of a gap.
pub fn pressed(mut scene: Value, force: f64) -> Value {
    scene["gap"] = json!(0);
    scene["obstacles"][0]["force"] = json!(force);
    scene
}

/// A block of `cells` cells that contact alone holds along y: pressed from above, on a plane below.
pub fn pressed_on_a_plane(cells: [usize; 2]) -> Value {
    let mut scene = pressed(block(cells, "q4"), 20.0);
    scene["supports"] = json!([{"on": {"boundary": "left"}, "x": 0}]);
    scene["obstacles"].as_array_mut().unwrap().push(json!({"boundary": "bottom", "approach": "-y",
        "shape": {"plane": {"point": [0, 0], "normal": [0, -1]}}}));
    scene
}

/// A thin strip of stretched cells.
pub fn strip(cells: usize) -> Value {
    let mut strip = block([cells, 20], "q4");
    let width = cells as f64 / 2000.0;
    strip["body"]["rectangle"]["x"]["points"] = json!([0, width]);
    strip["body"]["rectangle"]["y"]["points"] = json!([0, 0.5]);
    strip["obstacles"][0]["shape"]["parabola"]["apex"] = json!([width / 2.0, 0.5]);
    strip
}

/// The same strip of a nearly incompressible material: iterations on a multigrid hierarchy stagnate.
pub fn stiff_in_volume(cells: usize) -> Value {
    let mut strip = strip(cells);
    strip["material"]["poisson"] = json!(0.49999);
    strip
}
