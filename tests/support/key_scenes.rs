//! Random scenes in the plane with the keys beyond one isotropic block on supports: materials, orthotropy, also around
//! a point, temperatures, initial stresses, springs, rigid faces, inclined supports, pressed obstacles, moments,
//! profiles.

use serde_json::{Value, json};
use signorini::Scene;

use super::brackets::Draws;

/// Elements of the meshes of these scenes, as in the plane.
pub const ELEMENTS: [&str; 4] = super::plane_scenes::ELEMENTS;

/// A block under a rigid obstacle with some of the keys, and the name of its element.
pub fn scene(seed: u64) -> (Scene, &'static str) {
    let mut draws = Draws::new(seed);
    let (width, height) = (draws.between(0.5, 2.0), draws.between(0.3, 1.2));
    let young = 10_f64.powf(draws.between(3.0, 11.0));
    let element = *draws.of(&ELEMENTS);
    let depth = height * 10_f64.powf(draws.between(-3.0, -1.0));
    let size = young * depth / height;
    let (across, upwards) = (draws.lines(width), draws.lines(height));
    let [inner_x, inner_y] = [&across, &upwards].map(|lines| lines["points"][1].as_f64().unwrap());
    let mut scene = json!({
        "model": draws.of(&["plane-strain", "plane-stress"]),
        "thickness": draws.between(0.1, 2.0),
        "body": {"rectangle": {"x": across, "y": upwards, "element": element}},
        "material": {"young": young, "poisson": draws.of(&[0.0, 0.3, 0.45, 0.499, 0.4999]), "density": 1, "expansion": 1e-5},
    });
    let below = json!({"min": [0, 0], "max": [width, inner_y]});
    let right = json!({"min": [inner_x, 0], "max": [width, height]});
    let mut materials = Vec::new();
    if draws.next() < 0.4 {
        let young = young * 10_f64.powf(draws.between(-2.0, 1.0));
        materials.push(json!({"box": right, "material": {
            "young": young, "poisson": draws.of(&[0.0, 0.3, 0.49]), "density": 3, "expansion": 3e-5}}));
    }
    if draws.next() < 0.4 {
        let moduli = [0, 1, 2].map(|_| young * 10_f64.powf(draws.between(-0.6, 0.6)));
        materials.push(json!({"box": below, "material": {"density": 2, "orthotropic": {
            "young": moduli, "poisson": [0.1, 0.15, 0.05], "shear": moduli.map(|modulus| 0.4 * modulus),
            "expansion": [1e-5, 0, 4e-5], "angle": draws.between(0.0, 90.0)}}}));
    }
    // A strain of about the depth over the height.
    let warmth = 1e5 * depth / height;
    let mut temperature = Vec::new();
    if draws.next() < 0.4 {
        temperature.push(json!({"value": warmth * draws.between(-0.2, 0.2),
            "gradient": [warmth * draws.between(-0.2, 0.2), warmth * draws.between(-0.2, 0.2)]}));
    }
    if draws.next() < 0.3 {
        temperature.push(json!({"box": right, "value": warmth * draws.between(-0.2, 0.2)}));
    }
    let mut initial = Vec::new();
    if draws.next() < 0.3 {
        initial
            .push(json!({"box": below, "xx": size * draws.between(-0.2, 0.2), "yy": size * draws.between(-0.2, 0.2),
            "xy": size * draws.between(-0.2, 0.2)}));
    }
    let profile = |along: [f64; 2], places: [f64; 3], factors: [f64; 3]| json!({"along": along, "places": places, "factors": factors});
    let across = |factors| profile([1.0, 0.0], [0.0, inner_x, width], factors);
    let upwards = |factors| profile([0.0, 1.0], [0.0, inner_y, height], factors);
    let mut supports = vec![json!({"on": {"boundary": "bottom"}, "x": 0, "y": 0})];
    let mut springs = Vec::new();
    match (draws.next() * 5.0) as usize {
        0 => {
            let lifted = across([draws.between(-1.0, 1.0), draws.between(-1.0, 1.0), 0.0]);
            supports = vec![json!({"on": {"boundary": "bottom"}, "x": 0, "y": 0.3 * depth, "profile": lifted})];
        }
        1 => {
            supports = vec![json!({"on": {"boundary": "bottom"}, "normal": [draws.between(-1.0, 1.0), 1.0],
                "value": depth * draws.between(-0.2, 0.2)})];
            springs.push(json!({"on": {"boundary": "left"}, "normal": young / height, "stiffness": "per-area"}));
        }
        2 => {
            supports = Vec::new();
            let stiffness = young / height * 10_f64.powf(draws.between(-1.0, 1.0));
            springs.push(
                json!({"on": {"boundary": "bottom"}, "x": stiffness, "normal": stiffness, "stiffness": "per-area"}),
            );
        }
        _ => {}
    }
    let mut loads = Vec::new();
    let mut faces: Vec<Value> = Vec::new();
    match (draws.next() * 5.0) as usize {
        0 => {
            faces.push(json!({"boundary": "right", "force": [size * height * draws.between(-0.1, 0.1), 0],
                "moment": [size * height * height * draws.between(-0.05, 0.05)]}));
        }
        1 => faces
            .push(json!({"boundary": "right", "x": depth * draws.between(-0.3, 0.3), "rotation": {"z": 0.1 * depth}})),
        2 => loads.push(
            json!({"moment": {"boundary": "right", "value": [size * height * height * draws.between(-0.1, 0.1)]}}),
        ),
        _ => {}
    }
    // A rigid face shares a corner with the bottom: it must move as the support there holds it.
    if !faces.is_empty() && !supports.is_empty() {
        supports = Vec::new();
        springs = vec![
            json!({"on": {"boundary": "bottom"}, "x": young / height, "y": young / height, "stiffness": "per-area"}),
        ];
    }
    if draws.next() < 0.4 {
        loads.push(json!({"traction": {"boundary": "left", "value": [size * draws.between(-0.2, 0.2), size * 0.1],
            "profile": upwards([draws.between(-1.0, 1.0), draws.between(-1.0, 1.0), draws.between(-1.0, 1.0)])}}));
    }
    if draws.next() < 0.3 {
        loads.push(json!({"pressure": {"boundary": "left", "value": size * draws.between(-0.2, 0.2),
            "profile": upwards([0.0, draws.between(-1.0, 1.0), 1.0])}}));
    }
    if draws.next() < 0.4 {
        loads.push(json!({"gravity": [0, size / height * draws.between(-0.2, 0.2)]}));
    }
    let apex = [width * draws.between(0.1, 0.9), height - depth];
    let shape = match (draws.next() * 3.0) as usize {
        0 => json!({"circle": {"apex": apex, "radius": draws.between(0.3, 3.0)}}),
        1 => json!({"plane": {"point": apex, "normal": [draws.between(-0.1, 0.1), 1.0]}}),
        _ => json!({"wedge": {"apex": apex, "slope": draws.between(0.02, 0.5)}}),
    };
    let shape_is_flat = shape.get("plane").is_some();
    let mut obstacle = json!({"boundary": "top", "approach": "+y", "shape": shape});
    if shape_is_flat && draws.next() < 0.5 {
        obstacle["rule"] = json!("closest-point");
    }
    if draws.next() < 0.3 {
        obstacle["force"] = json!(size * width * draws.between(0.05, 1.0));
    }
    if temperature.is_empty() && initial.is_empty() && draws.next() < 0.5 {
        let moduli = [0, 1, 2].map(|_| young * 10_f64.powf(draws.between(-0.5, 0.5)));
        scene["material"] = json!({"density": 1, "orthotropic": {
            "young": moduli, "poisson": [0.1, 0.15, 0.05], "shear": moduli.map(|modulus| 0.4 * modulus)}});
    }
    let keys = [
        ("materials", materials),
        ("temperature", temperature),
        ("initial-stress", initial),
        ("supports", supports),
        ("springs", springs),
        ("rigid-faces", faces),
        ("loads", loads),
        ("obstacles", vec![obstacle]),
    ];
    for (key, entries) in keys.into_iter().filter(|(_, entries)| !entries.is_empty()) {
        scene[key] = Value::from(entries);
    }
    (Scene::from_json(&scene.to_string(), "scene").unwrap_or_else(|error| panic!("{error}: {scene}")), element)
}
