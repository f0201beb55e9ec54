//! Random scenes in space that have a guaranteed bound.

use serde_json::{Value, json};
use signorini::Scene;

use super::brackets::{Column, Draws};
use super::gmsh_forms::{Drawing, FORMS, Part};

/// Elements of the meshes of scenes in space.
pub const ELEMENTS: [&str; 4] = ["tet4", "tet10", "hex8", "hex20"];

/// Poisson's ratios.
const RATIOS: [f64; 7] = [0.0, 0.2, 0.3, 0.45, 0.49, 0.499, 0.4999];

/// The error of a mesh is known to about seven percent if the bound of the last mesh is this many times smaller.
pub const CLEAR: f64 = 4.0;

/// The boundaries of a box.
const SIDES: [&str; 6] = ["left", "right", "front", "back", "bottom", "top"];

/// The corners at the ends of each edge of a tetrahedron of ten nodes.
const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

/// Largest move of a node along an axis, over the size of the box; the smallest cells have 0.15 of it.
const MOVED: f64 = 0.04;

/// A random block in space under a rigid obstacle, and the name of its element. The nodes of some meshes of tetrahedra
/// are moved.
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
    let mut scene = json!({
        "model": "space",
        "body": {"box": {
            "x": draws.few_lines(width), "y": draws.few_lines(length), "z": draws.few_lines(height), "element": element
        }},
        "material": {"young": young, "poisson": draws.of(&RATIOS)},
        "supports": supports,
        "loads": loads,
        "obstacles": obstacles,
    });
    if element.starts_with("tet") && draws.next() < 0.6 {
        // The name appears with the whole file: several processes may draw the same scene.
        let file = std::env::temp_dir().join(format!("signorini-moved-nodes-{seed}.msh"));
        let own = file.with_extension(std::process::id().to_string());
        std::fs::write(&own, with_moved_nodes(&scene, &mut draws, [width, length, height])).unwrap();
        std::fs::rename(&own, &file).unwrap();
        scene["body"] = json!({"gmsh": {"file": file}});
    }
    (Scene { reads_outside: true, ..Scene::from_json(&scene.to_string(), "scene").unwrap() }, element)
}

/// The mesh of a box of tetrahedra as a file of Gmsh, with each node moved inside the box, and along the planes on
/// which it lies.
fn with_moved_nodes(scene: &Value, draws: &mut Draws, size: [f64; 3]) -> Vec<u8> {
    let model = Scene::from_json(&scene.to_string(), "scene").unwrap().build().unwrap();
    let mesh = model.mesh();
    let mut moved = |place: f64, size: f64| match place == 0.0 || place == size {
        true => place,
        false => place + size * draws.between(-MOVED, MOVED),
    };
    let mut nodes: Vec<[f64; 3]> =
        mesh.nodes().iter().map(|node| [0, 1, 2].map(|axis| moved(node[axis], size[axis]))).collect();
    for element in (0..mesh.element_count()).map(|index| mesh.element(index)).filter(|element| element.len() == 10) {
        for ([from, to], middle) in EDGES.into_iter().zip(&element[4..]) {
            let [from, to] = [from, to].map(|corner| nodes[element[corner]]);
            nodes[*middle] = [0, 1, 2].map(|axis| (from[axis] + to[axis]) / 2.0);
        }
    }
    let tags = |of: &[usize]| of.iter().map(|&node| node as u64 + 1).collect::<Vec<_>>();
    let of_element = |index: usize| {
        let mut element = tags(mesh.element(index));
        // Gmsh has the last two edges in the other order.
        if element.len() == 10 {
            element.swap(8, 9);
        }
        element
    };
    let is_linear = mesh.element(0).len() == 4;
    let elements = (0..mesh.element_count()).map(of_element).collect();
    let body = Part { dimension: 3, entity: 1, group: 7, number: if is_linear { 4 } else { 11 }, elements };
    let sides = SIDES.into_iter().zip(1..).map(|(name, group)| {
        let facets = mesh.boundary(name).unwrap().facets().map(tags).collect();
        Part { dimension: 2, entity: group, group, number: if is_linear { 2 } else { 9 }, elements: facets }
    });
    let drawing = Drawing {
        names: SIDES.into_iter().zip(1..).map(|(name, group)| (2, group, name)).chain([(3, 7, "body")]).collect(),
        nodes: nodes.into_iter().enumerate().map(|(node, at)| (node as u64 + 1, at)).collect(),
        parts: sides.chain([body]).collect(),
    };
    drawing.written(FORMS[3])
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
