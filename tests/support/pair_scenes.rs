//! Random scenes of two to four bodies in the plane and about an axis, with meshes that do not match; some bodies are
//! tied.

use serde_json::{Value, json};
use signorini::Scene;

use super::brackets::{Column, Draws, of_pressed_column};
use super::plane_scenes::ELEMENTS;

/// The models, and whether their bodies are blocks only.
const MODELS: [(&str, bool); 3] = [("plane-strain", false), ("plane-stress", false), ("axisymmetric", true)];

/// A body on a wider block, in one of five scenes a third one under both, and in some a cap that is tied to a block
/// above; with the name of the element of the first.
pub fn scene(seed: u64) -> (Scene, &'static str) {
    let mut draws = Draws::new(seed);
    let (model, has_blocks_only) = *draws.of(&MODELS);
    let (width, height, thickness) = (draws.between(0.4, 1.5), draws.between(0.3, 1.0), draws.between(0.3, 1.0));
    let young = 10_f64.powf(draws.between(3.0, 11.0));
    let element = *draws.of(&ELEMENTS);
    let depth = height * 10_f64.powf(draws.between(-3.0, -1.3));
    let size = young * depth / height;
    let base = if model == "axisymmetric" { 0.0 } else { -draws.between(0.05, 0.5) };
    let material =
        |draws: &mut Draws, young: f64| json!({"young": young, "poisson": draws.of(&[0.0, 0.3, 0.45, 0.499])});
    let of_base = young * 10_f64.powf(draws.between(-1.0, 1.5));
    let of_base = material(&mut draws, of_base);
    let wide = width - base + draws.between(0.0, 0.4);
    let mut further = vec![json!({
        "name": "base",
        "material": of_base,
        "body": {"rectangle": {"x": moved(draws.lines(wide), base), "y": moved(draws.lines(thickness), -thickness),
            "element": draws.of(&ELEMENTS)}},
    })];
    let is_round = !has_blocks_only && draws.next() < 0.5;
    let body = match is_round {
        true => json!({"half-disc": {"half": "lower", "centre": [width / 2.0, width / 2.0], "radius": width / 2.0,
            "element": element, "zone": {"width": 0.2 * width, "divisions": 2 + (draws.next() * 3.0) as usize, "growth": 1.5}}}),
        false => json!({"rectangle": {"x": draws.lines(width), "y": draws.lines(height), "element": element}}),
    };
    let (top, bottom) = if is_round { ("cut", "arc") } else { ("top", "bottom") };
    let mut supports = vec![json!({"on": {"boundary": "base.bottom"}, "x": 0, "y": 0})];
    let mut loads = Vec::new();
    match (draws.next() * 3.0) as usize {
        // Contact alone carries what presses the block.
        0 if !is_round => {
            loads.push(json!({"pressure": {"boundary": top, "value": size * draws.between(0.1, 1.0)}}));
            if model != "axisymmetric" {
                supports.push(json!({"on": {"boundary": "left"}, "x": 0}));
            }
        }
        1 => supports.push(json!({"on": {"boundary": top}, "x": 0, "y": -depth})),
        _ => supports.push(json!({"on": {"boundary": top}, "y": -depth})),
    }
    if supports.len() == 2 && loads.is_empty() && supports[1].get("x").is_none() && model != "axisymmetric" && !is_round
    {
        supports.push(json!({"on": {"boundary": "left"}, "x": 0}));
    }
    if supports.len() == 2 && supports[1].get("x").is_none() && is_round {
        supports[1]["x"] = json!(0);
    }
    if draws.next() < 0.3 {
        loads.push(json!({"traction": {"boundary": "base.right", "value": [size * draws.between(-0.1, 0.1), 0]}}));
    }
    let mut shape = json!({"boundary": "base.top"});
    if draws.next() < 0.5 {
        shape["rows"] = json!("mortar");
        shape["side"] = json!(draws.of(&["this", "other"]));
    }
    if !is_round && draws.next() < 0.3 {
        shape["fit"] = json!({"interference": depth * draws.between(0.0, 1.0)});
    }
    let mut obstacle = json!({"boundary": bottom, "approach": "-y", "shape": {"body": shape}});
    if !is_round && draws.next() < 0.3 {
        obstacle["rule"] = json!("closest-point");
    }
    let mut obstacles = vec![obstacle];
    if draws.next() < 0.2 {
        further.push(json!({
            "name": "floor",
            "material": material(&mut draws, young),
            "body": {"rectangle": {"x": moved(draws.lines(width - 2.0 * base), 2.0 * base),
                "y": moved(draws.lines(thickness), -2.0 * thickness), "element": draws.of(&ELEMENTS)}},
        }));
        supports[0] = json!({"on": {"boundary": "floor.bottom"}, "x": 0, "y": 0});
        if model != "axisymmetric" {
            supports.push(json!({"on": {"boundary": "base.left"}, "x": 0}));
        }
        obstacles
            .push(json!({"boundary": "base.bottom", "approach": "-y", "shape": {"body": {"boundary": "floor.top"}}}));
    }
    let material_of_body = material(&mut draws, young);
    let mut ties = Vec::new();
    if !is_round && draws.next() < 0.3 {
        let wide = width * draws.of(&[0.7, 1.0]);
        let of_cap = young * 10_f64.powf(draws.between(-1.0, 1.0));
        further.push(json!({
            "name": "cap",
            "material": material(&mut draws, of_cap),
            "body": {"rectangle": {"x": draws.lines(wide), "y": moved(draws.lines(thickness), height),
                "element": draws.of(&ELEMENTS)}},
        }));
        ties.push(json!({"surfaces": {"boundary": "cap.bottom", "to": top}}));
        // What acts above acts on the cap.
        let places = supports.iter_mut().map(|support| &mut support["on"]["boundary"]);
        let pressures = loads.iter_mut().filter_map(|load| load.pointer_mut("/pressure/boundary"));
        places.chain(pressures).filter(|name| *name == top).for_each(|name| *name = json!("cap.top"));
    }
    let scene = json!({
        "model": model,
        "body": body,
        "material": material_of_body,
        "further-bodies": further,
        "supports": supports,
        "loads": loads,
        "obstacles": obstacles,
        "ties": ties,
    });
    (Scene::from_json(&scene.to_string(), "scene").unwrap_or_else(|error| panic!("{error}: {scene}")), element)
}

/// Two columns in a smooth tube, the upper one lowered onto the lower one: as one column of two materials.
pub fn column(seed: u64) -> Column {
    let mut draws = Draws::new(seed);
    let (width, height) = (draws.between(0.5, 2.0), draws.between(0.3, 1.2));
    let young = 10_f64.powf(draws.between(3.0, 11.0));
    let element = *draws.of(&ELEMENTS);
    let lowered = height * 1e-3 * draws.between(0.01, 1.0);
    let poisson = *draws.of(&[0.0, 0.2, 0.3, 0.45, 0.49]);
    let modulus = |young: f64| young * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    let (thickness, other) = (draws.between(0.3, 1.0), young * 10_f64.powf(draws.between(-1.0, 1.0)));
    let block = |draws: &mut Draws, high: f64, at: f64, element: &str| json!({"rectangle": {"x": draws.lines(width), "y": moved(draws.lines(high), at), "element": element}});
    let sides = ["left", "right", "base.left", "base.right"];
    let mut supports: Vec<Value> = sides.iter().map(|side| json!({"on": {"boundary": side}, "x": 0})).collect();
    supports.push(json!({"on": {"boundary": "base.bottom"}, "y": 0}));
    supports.push(json!({"on": {"boundary": "top"}, "y": -lowered}));
    let of_base = *draws.of(&ELEMENTS);
    let scene = json!({
        "model": "plane-strain",
        "body": block(&mut draws, height, 0.0, element),
        "material": {"young": young, "poisson": poisson},
        "further-bodies": [{"name": "base", "material": {"young": other, "poisson": poisson},
            "body": block(&mut draws, thickness, -thickness, of_base)}],
        "supports": supports,
        "obstacles": [{"boundary": "bottom", "approach": "-y", "shape": {"body": {"boundary": "base.top", "rows": "mortar"}}}],
    });
    // The modulus of both columns together over their whole height.
    let whole = height + thickness;
    let mean = whole / (height / modulus(young) + thickness / modulus(other));
    let exact = of_pressed_column([whole, -lowered, 0.0], mean, width);
    (Scene::from_json(&scene.to_string(), "scene").unwrap_or_else(|error| panic!("{error}: {scene}")), element, exact)
}

/// Lines from another start on.
fn moved(mut lines: Value, by: f64) -> Value {
    let points: Vec<f64> = lines["points"].as_array().unwrap().iter().map(|at| by + at.as_f64().unwrap()).collect();
    lines["points"] = json!(points);
    lines
}
