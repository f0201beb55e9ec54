//! Random scenes in space that have a guaranteed bound.

use serde_json::json;
use signorini::Scene;

use super::brackets::{Column, Draws};

/// Elements of the scene's own mesh.
pub const ELEMENTS: [&str; 4] = ["tet4", "tet10", "hex8", "hex20"];

/// Poisson's ratios.
const RATIOS: [f64; 7] = [0.0, 0.2, 0.3, 0.45, 0.49, 0.499, 0.4999];

/// The error of a mesh is known to about seven percent if the bound of the last mesh is this many times smaller.
pub const CLEAR: f64 = 4.0;

/// A block under a rigid obstacle, and the name of its element.
///
/// # Panics
/// Never: the scene is valid.
pub fn scene(seed: u64) -> (Scene, &'static str) {
    let mut draws = Draws::new(seed);
    let [width, length, height] = [0.5, 0.5, 0.3].map(|least| draws.between(least, 3.0 * least));
    let young = 10_f64.powf(draws.between(3.0, 11.0));
    let element = *draws.of(&ELEMENTS);
    let depth = height * 10_f64.powf(draws.between(-3.0, -1.0));
    let apex = [width * draws.between(0.1, 0.9), length * draws.between(0.1, 0.9), height - depth];
    let radius = draws.between(0.3, 3.0);
    let shape = match (draws.next() * 6.0) as usize {
        0 => json!({"plane": {"point": apex, "normal": [draws.between(-0.2, 0.2), draws.between(-0.2, 0.2), 1.0]}}),
        1 => json!({"cylinder": {"apex": apex, "axis": draws.of(&[[0, 1, 0], [1, 0, 0]]), "radius": radius}}),
        2 => json!({"cone": {"apex": apex, "slope": draws.between(0.02, 0.5)}}),
        3 => {
            let heights: Vec<Vec<f64>> =
                (0..3).map(|_| (0..3).map(|_| height - depth * draws.between(-1.0, 1.0)).collect()).collect();
            let [x, y] = [0, 1].map(|axis| [-0.1, apex[axis], [width, length][axis] + 0.1]);
            json!({"height-map": {"x": x, "y": y, "heights": heights}})
        }
        _ => json!({"sphere": {"apex": apex, "radius": radius}}),
    };
    let mut obstacles = vec![json!({"boundary": "top", "approach": "+z", "shape": shape})];
    let (mut loads, size) = (Vec::new(), young * depth / height);
    if draws.next() < 0.4 {
        let traction = [0.3, 0.3, 0.2].map(|share| size * draws.between(-share, share));
        loads.push(json!({"traction": {"boundary": "left", "value": traction}}));
    }
    if draws.next() < 0.4 {
        let force = [0.3, 0.3, 0.6].map(|share| size / height * draws.between(-0.3, share));
        loads.push(json!({"body-force": force}));
    }
    let supports = match (draws.next() * 3.0) as usize {
        0 => vec![json!({"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": 0})],
        1 => vec![
            json!({"on": {"boundary": "bottom"}, "z": 0}),
            json!({"on": {"boundary": "left"}, "x": 0}),
            json!({"on": {"boundary": "front"}, "y": 0}),
        ],
        _ => vec![json!({"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": depth * draws.between(-0.5, 0.5)})],
    };
    if draws.next() < 0.3 {
        loads.push(json!({"pressure": {"boundary": "right", "value": size * draws.between(-0.2, 0.2)}}));
    } else if draws.next() < 0.2 {
        let point = [width + depth * draws.between(0.0, 0.5), 0.0, 0.0];
        obstacles.push(
            json!({"boundary": "right", "approach": "+x", "shape": {"plane": {"point": point, "normal": [1, 0, 0]}}}),
        );
    }
    let scene = json!({
        "model": "space",
        "body": {"box": {
            "x": draws.few_lines(width), "y": draws.few_lines(length), "z": draws.few_lines(height), "element": element
        }},
        "material": {"young": young, "poisson": draws.of(&RATIOS)},
        "supports": supports,
        "loads": loads,
        "obstacles": obstacles,
    });
    (Scene::from_json(&scene.to_string(), "scene").unwrap(), element)
}

/// A column between rollers under a body force b, up or down, its head against a plane, as
/// [`column`](super::plane_scenes::column) in the plane.
///
/// # Panics
/// Never: the scene is valid.
pub fn column(seed: u64) -> Column {
    let mut draws = Draws::new(seed);
    let [width, length, height] = [0.5, 0.5, 0.3].map(|least| draws.between(least, 3.0 * least));
    let (young, poisson) = (10_f64.powf(draws.between(3.0, 11.0)), *draws.of(&[0.0, 0.2, 0.3, 0.45, 0.49]));
    let element = *draws.of(&ELEMENTS);
    let modulus = young * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    let gap = height * 1e-3 * draws.between(-1.0, 1.0);
    let force = 2.0 * modulus / (height * height) * (gap + height * 1e-3 * draws.between(0.01, 2.0));
    let rollers = [("bottom", "z"), ("left", "x"), ("right", "x"), ("front", "y"), ("back", "y")];
    let supports: Vec<_> = rollers.iter().map(|&(on, axis)| json!({"on": {"boundary": on}, axis: 0})).collect();
    let plane = json!({"plane": {"point": [0, 0, height + gap], "normal": [0, 0, 1]}});
    let scene = json!({
        "model": "space",
        "body": {"box": {
            "x": draws.few_lines(width), "y": draws.few_lines(length), "z": draws.few_lines(height), "element": element
        }},
        "material": {"young": young, "poisson": poisson},
        "supports": supports,
        "loads": [{"body-force": [0, 0, force]}],
        "obstacles": [{"boundary": "top", "approach": "+z", "shape": plane}],
    });
    let exact = super::brackets::of_pressed_column([height, gap, force], modulus, width * length);
    (Scene::from_json(&scene.to_string(), "scene").unwrap(), element, exact)
}
