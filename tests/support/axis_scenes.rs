//! Random scenes about an axis that have a guaranteed bound.

use serde_json::{Value, json};
use signorini::Scene;

use super::brackets::{Column, Draws, of_pressed_column};
use super::plane_scenes::ELEMENTS;

/// The energies of a column differ by this share, because a polynomial stands for 1/r.
pub const OF_POLYNOMIAL: f64 = 1e-5;

/// A block about an axis, with or without a hole, under a rigid obstacle, and the name of its element.
pub fn scene(seed: u64) -> (Scene, &'static str) {
    let mut draws = Draws::new(seed);
    let hole = if draws.next() < 0.5 { 0.0 } else { draws.between(0.05, 1.0) };
    let (width, height) = (draws.between(0.4, 1.5), draws.between(0.3, 1.2));
    let young = 10_f64.powf(draws.between(3.0, 11.0));
    let element = *draws.of(&ELEMENTS);
    let depth = height * 10_f64.powf(draws.between(-3.0, -1.0));
    let size = young * depth / height;
    let apex = [0.0, height - depth];
    let shape = match (draws.next() * 3.0) as usize {
        // From the hole on, these are as high as a ring around it.
        0 => json!({"parabola": {"apex": apex, "radius": draws.between(1.0, 3.0) * (1.0 + hole * hole / depth)}}),
        1 => json!({"circle": {"apex": apex, "radius": draws.between(3.0, 6.0) * (1.0 + hole * hole / depth)}}),
        _ => json!({"plane": {"point": apex, "normal": [0, 1]}}),
    };
    let across = from(hole, draws.lines(width));
    let inner = across["points"][1].as_f64().unwrap();
    let mut loads = Vec::new();
    if draws.next() < 0.4 {
        loads.push(json!({"pressure": {"boundary": "right", "value": size * draws.between(-0.2, 0.2)}}));
    }
    if draws.next() < 0.4 {
        let force = size / height;
        loads.push(json!({"body-force": [force * draws.between(-0.3, 0.3), force * draws.between(-0.3, 0.3)]}));
    }
    let supports = match (draws.next() * 3.0) as usize {
        0 => vec![json!({"on": {"boundary": "bottom"}, "x": 0, "y": 0})],
        1 => vec![json!({"on": {"boundary": "bottom"}, "y": 0})],
        _ => vec![json!({"on": {"boundary": "bottom"}, "y": depth * draws.between(-0.5, 0.5)})],
    };
    let mut obstacle = json!({"boundary": "top", "approach": "+y", "shape": shape});
    if draws.next() < 0.2 {
        obstacle["force"] = json!(size * width * width * draws.between(0.05, 1.0));
    }
    let mut scene = json!({
        "model": "axisymmetric",
        "body": {"rectangle": {"x": across, "y": draws.lines(height), "element": element}},
        "material": {"young": young, "poisson": draws.of(&[0.0, 0.3, 0.45, 0.49, 0.499, 0.4999]), "expansion": 1e-5},
        "supports": supports,
        "loads": loads,
        "obstacles": [obstacle],
    });
    let right = json!({"min": [inner, 0], "max": [hole + width, height]});
    if draws.next() < 0.3 {
        let young = young * 10_f64.powf(draws.between(-2.0, 1.0));
        scene["materials"] = json!([{"box": right, "material": {"young": young, "poisson": 0.2, "expansion": 2e-5}}]);
    }
    if draws.next() < 0.3 {
        let warmth = 2e4 * depth / height;
        scene["temperature"] = json!([{"value": warmth, "gradient": [warmth * draws.between(-1.0, 1.0), 0]}]);
    }
    let stiffness = |draws: &mut Draws| young / height * 10_f64.powf(draws.between(-1.0, 1.0));
    let mut springs = Vec::new();
    if draws.next() < 0.3 {
        scene["supports"] = json!([]);
        springs.push(json!({"on": {"boundary": "bottom"}, "y": stiffness(&mut draws), "stiffness": "per-area"}));
    }
    if draws.next() < 0.2 {
        springs.push(json!({"on": {"boundary": "right"}, "normal": stiffness(&mut draws), "stiffness": "per-area"}));
    }
    scene["springs"] = json!(springs);
    (Scene::from_json(&scene.to_string(), "scene").unwrap_or_else(|error| panic!("{error}: {scene}")), element)
}

/// A column in a smooth tube with its head pressed against a plane: r times the stress is linear.
pub fn column(seed: u64) -> Column {
    let mut draws = Draws::new(seed);
    let hole = if draws.next() < 0.5 { 0.0 } else { draws.between(0.05, 1.0) };
    let (width, height) = (draws.between(0.5, 2.0), draws.between(0.3, 1.2));
    let (young, poisson) = (10_f64.powf(draws.between(3.0, 11.0)), *draws.of(&[0.0, 0.2, 0.3, 0.45, 0.49, 0.499]));
    let element = *draws.of(&ELEMENTS);
    let modulus = young * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    let gap = -height * 1e-3 * draws.between(0.01, 1.0);
    let scene = json!({
        "model": "axisymmetric",
        "body": {"rectangle": {"x": from(hole, draws.lines(width)), "y": draws.lines(height), "element": element}},
        "material": {"young": young, "poisson": poisson},
        "supports": [
            {"on": {"boundary": "bottom"}, "y": 0}, {"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "right"}, "x": 0}
        ],
        "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"plane": {"point": [0, height + gap], "normal": [0, 1]}}}],
    });
    let area = std::f64::consts::PI * ((hole + width).powi(2) - hole * hole);
    let exact = of_pressed_column([height, gap, 0.0], modulus, area);
    (Scene::from_json(&scene.to_string(), "scene").unwrap(), element, exact)
}

/// Lines from the radius of a hole on.
fn from(hole: f64, mut lines: Value) -> Value {
    for point in lines["points"].as_array_mut().unwrap() {
        *point = json!(point.as_f64().unwrap() + hole);
    }
    lines
}
