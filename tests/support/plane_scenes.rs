//! Random scenes in the plane that have a guaranteed bound.

use serde_json::json;
use signorini::Scene;

use super::brackets::{Column, Draws, of_pressed_column};

/// Elements of the meshes of scenes in the plane.
pub const ELEMENTS: [&str; 4] = ["t3", "t6", "q4", "q8"];

/// The error of a mesh is known to a few percent if the bound of the last mesh is this many times smaller.
pub const CLEAR: f64 = 20.0;

/// A random block in the plane under a rigid obstacle, and the name of its element.
pub fn scene(seed: u64) -> (Scene, &'static str) {
    let mut draws = Draws::new(seed);
    let (width, height) = (draws.between(0.5, 2.0), draws.between(0.3, 1.2));
    let young = 10_f64.powf(draws.between(3.0, 11.0));
    let element = *draws.of(&ELEMENTS);
    let depth = height * 10_f64.powf(draws.between(-3.5, -1.0));
    let apex = [width * draws.between(0.1, 0.9), height - depth];
    let shape = match (draws.next() * 5.0) as usize {
        0 => json!({"plane": {"point": apex, "normal": [draws.between(-0.2, 0.2), 1.0]}}),
        1 => json!({"wedge": {"apex": apex, "slope": draws.between(0.02, 0.5)}}),
        2 => json!({"circle": {"apex": apex, "radius": draws.between(0.3, 3.0)}}),
        3 => json!({"table": {"points": [
            [-1.0, height + 0.5], [apex[0] - 0.1 * width, apex[1]], [apex[0] + 0.1 * width, apex[1]], [4.0, height + 0.5]
        ]}}),
        _ => json!({"parabola": {"apex": apex, "radius": draws.between(0.3, 3.0)}}),
    };
    let mut obstacles = vec![json!({"boundary": "top", "approach": "+y", "shape": shape})];
    let mut loads = Vec::new();
    let size = young * depth / height;
    if draws.next() < 0.4 {
        let push = size * draws.between(-0.3, 0.3);
        loads.push(json!({"traction": {"boundary": "left", "value": [push, size * draws.between(-0.2, 0.2)]}}));
    }
    if draws.next() < 0.4 {
        let force = size / height;
        loads.push(json!({"body-force": [force * draws.between(-0.3, 0.3), force * draws.between(-0.3, 0.6)]}));
    }
    let supports = match (draws.next() * 3.0) as usize {
        0 => vec![json!({"on": {"boundary": "bottom"}, "x": 0, "y": 0})],
        1 => vec![json!({"on": {"boundary": "bottom"}, "y": 0}), json!({"on": {"boundary": "left"}, "x": 0})],
        _ => vec![json!({"on": {"boundary": "bottom"}, "x": 0, "y": depth * draws.between(-0.5, 0.5)})],
    };
    if draws.next() < 0.3 {
        loads.push(json!({"pressure": {"boundary": "right", "value": size * draws.between(-0.2, 0.2)}}));
    } else if draws.next() < 0.2 {
        let point = [width + depth * draws.between(0.0, 0.5), 0.0];
        obstacles.push(
            json!({"boundary": "right", "approach": "+x", "shape": {"plane": {"point": point, "normal": [1, 0]}}}),
        );
    }
    let scene = json!({
        "model": draws.of(&["plane-strain", "plane-stress"]),
        "thickness": draws.between(0.1, 2.0),
        "body": {"rectangle": {"x": draws.lines(width), "y": draws.lines(height), "element": element}},
        "material": {"young": young, "poisson": draws.of(&[0.0, 0.2, 0.3, 0.45, 0.49, 0.499, 0.4999, 0.49999])},
        "supports": supports,
        "loads": loads,
        "obstacles": obstacles,
    });
    (Scene::from_json(&scene.to_string(), "scene").unwrap(), element)
}

/// A column between rollers under a body force b, up or down, its head against a plane: its displacement is quadratic.
pub fn column(seed: u64) -> Column {
    let mut draws = Draws::new(seed);
    let (width, height, thickness) = (draws.between(0.5, 2.0), draws.between(0.3, 1.2), draws.between(0.1, 2.0));
    let (young, poisson) = (10_f64.powf(draws.between(3.0, 11.0)), *draws.of(&[0.0, 0.2, 0.3, 0.45, 0.49, 0.499]));
    let (model, element) = (*draws.of(&["plane-strain", "plane-stress"]), *draws.of(&ELEMENTS));
    let modulus = match model {
        "plane-strain" => young * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson)),
        _ => young / (1.0 - poisson * poisson),
    };
    let gap = height * 1e-3 * draws.between(-1.0, 1.0);
    // The head hardly touches, or is pressed with up to many times the force, or anything between.
    let force = 2.0 * modulus / (height * height) * (gap + height * 1e-3 * draws.between(0.01, 2.0));
    let scene = json!({
        "model": model,
        "thickness": thickness,
        "body": {"rectangle": {"x": draws.lines(width), "y": draws.lines(height), "element": element}},
        "material": {"young": young, "poisson": poisson},
        "supports": [
            {"on": {"boundary": "bottom"}, "y": 0}, {"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "right"}, "x": 0}
        ],
        "loads": [{"body-force": [0, force]}],
        "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"plane": {"point": [0, height + gap], "normal": [0, 1]}}}],
    });
    let exact = of_pressed_column([height, gap, force], modulus, width * thickness);
    (Scene::from_json(&scene.to_string(), "scene").unwrap(), element, exact)
}
