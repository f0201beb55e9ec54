//! A first scene for a mesh: the content of the file, and a scene that runs and can be changed.

use std::fmt::Write;
use std::path::Path;

use super::entry::number;
use crate::error::Error;
use crate::fem::assembly::{node_normals, tributary_areas};
use crate::fem::body::ElasticBody;
use crate::fem::formulation::Formulation;
use crate::fem::geometry::length;
use crate::fem::material::Material;
use crate::fem::mesh::gmsh::GmshFile;
use crate::fem::mesh::{Boundary, Mesh};

/// A body larger than this is assumed to be given in millimetres: few parts are larger in metres.
const LARGEST_IN_METRES: f64 = 5.0;

/// Young's modulus of steel in pascals.
const STEEL: f64 = 2.1e11;

/// The approximate strain under the force: far from large, far above rounding.
const STRAIN: f64 = 1e-4;

/// Words in the name of a boundary that is held, and of a boundary that is pressed.
const HELD: [&str; 9] = ["fix", "clamp", "support", "held", "base", "bottom", "root", "cut", "ground"];
const PRESSED: [&str; 8] = ["contact", "touch", "press", "top", "upper", "seat", "round", "arc"];

/// A mean normal shorter than this belongs to a boundary that faces all directions.
const FACING: f64 = 0.5;

/// A boundary in the list.
struct Listed {
    name: String,
    facets: usize,
    area: f64,
    /// The mean of the outward normals; short if they cancel.
    normal: [f64; 3],
    low: [f64; 3],
    high: [f64; 3],
}

/// The text of a scene for the mesh `file`, with comment lines; `named` is the name of the file in the scene.
///
/// # Errors
/// As [`GmshFile::read`] and [`GmshFile::mesh`].
pub(crate) fn start_scene(file: &Path, named: &str) -> Result<String, Error> {
    let content = GmshFile::read(file)?;
    let groups = content.bodies();
    let group = groups.first().filter(|_| groups.len() > 1);
    let mesh = content.mesh(group.map(String::as_str), 1.0)?;
    let millimetres = mesh.size() > LARGEST_IN_METRES;
    let young = if millimetres { STEEL / 1e6 } else { STEEL };
    let formulation = match mesh.dimension() {
        1 => Formulation::Bar { area: 1.0 },
        2 => Formulation::PlaneStrain { thickness: 1.0 },
        _ => Formulation::Space,
    };
    let mut listed = listed(mesh.clone(), formulation)?;
    let named_in_file = listed.len();
    let whole = listed.pop_if(|last| last.name.is_empty() && named_in_file > 2);
    let axis = mesh.dimension() - 1;
    let mut text = head(named, &mesh, &listed, &groups, millimetres);
    // Without two names, take the sides that face up and down.
    let by_sides = listed.iter().filter(|boundary| !boundary.name.is_empty()).count() < 2;
    let (held, pressed) = match by_sides {
        true => (String::from("lower"), String::from("upper")),
        false => {
            let [held, pressed] = roles(&listed);
            (held.to_string(), pressed.to_string())
        }
    };
    let of_pressed = listed.iter().find(|boundary| boundary.name == pressed).or(whole.as_ref()).or(listed.last());
    let Some(of_pressed) = of_pressed else { return Ok(text) };
    let (axis, sense) = match by_sides {
        true => (axis, 1.0),
        false => facing(of_pressed.normal, axis),
    };
    body(&mut text, named, &mesh, group, (young, millimetres));
    if by_sides {
        sides(&mut text, mesh.dimension());
    }
    rest(&mut text, &mesh, (&held, &pressed), of_pressed, (axis, sense, young));
    Ok(text)
}

/// All boundaries, followed by the whole surface, which has no name.
fn listed(mesh: Mesh, formulation: Formulation) -> Result<Vec<Listed>, Error> {
    let body = ElasticBody::new(mesh, Material::new(1.0, 0.3)?, formulation)?;
    let mesh = body.mesh();
    let surface = Boundary { name: String::new(), ..mesh.surface(0..mesh.element_count()) };
    let of = |boundary: &Boundary| {
        let areas = tributary_areas(&body, boundary);
        let area: f64 = areas.iter().map(|(_, area)| area).sum();
        let mut normal = [0.0; 3];
        for ((_, of_node), (_, own)) in areas.iter().zip(node_normals(&body, boundary)) {
            (0..3).for_each(|axis| normal[axis] += of_node / area * own[axis]);
        }
        let nodes: Vec<[f64; 3]> = boundary.nodes().into_iter().map(|node| mesh.nodes()[node]).collect();
        let (low, high) = crate::fem::mesh::extent(&nodes);
        Listed { name: boundary.name.clone(), facets: boundary.facet_count(), area, normal, low, high }
    };
    Ok(mesh.boundaries().iter().chain([&surface]).map(of).collect())
}

/// The boundaries that are held and pressed, from at least two: by their names, or else the last one is pressed and the first one is
/// held.
fn roles(listed: &[Listed]) -> [&str; 2] {
    let names: Vec<&str> =
        listed.iter().map(|boundary| boundary.name.as_str()).filter(|name| !name.is_empty()).collect();
    let by_word = |words: &[&str], other: Option<&str>| {
        let has = |name: &&str| words.iter().any(|word| name.to_lowercase().contains(word)) && Some(*name) != other;
        names.iter().copied().find(has)
    };
    let held = by_word(&HELD, None);
    let last = names.iter().copied().rfind(|name| Some(*name) != held);
    let pressed = by_word(&PRESSED, held).or(last).unwrap_or_default();
    let first = names.iter().copied().find(|name| *name != pressed);
    [held.or(first).unwrap_or_default(), pressed]
}

/// A component within this share of the largest one counts as equal: the boundary faces several axes alike.
const ALIKE: f64 = 0.99;

/// The axis and the sense of a boundary's normal; the vertical axis if the normal is as close to it as to another, and up if the boundary
/// faces all directions.
fn facing(normal: [f64; 3], up: usize) -> (usize, f64) {
    if length(normal) < FACING {
        return (up, 1.0);
    }
    let largest = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(up);
    let axis = if normal[up].abs() > ALIKE * normal[largest].abs() { up } else { largest };
    (axis, normal[axis].signum())
}

fn quoted(name: &str) -> String {
    serde_json::Value::from(name).to_string()
}

/// A vector as it is written in a scene: with all digits, because a plane must touch the body.
fn vector(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|&value| number(value + 0.0)).collect();
    format!("[{}]", values.join(", "))
}

/// A vector for the reader, in six digits.
fn shown(values: &[f64]) -> String {
    vector(&values.iter().map(|value| format!("{value:.5e}").parse().unwrap_or(*value)).collect::<Vec<f64>>())
}

/// Comments on the content of the file.
fn head(named: &str, mesh: &Mesh, listed: &[Listed], groups: &[String], millimetres: bool) -> String {
    let (dimension, (low, high)) = (mesh.dimension(), mesh.extent());
    let size: Vec<f64> = (0..dimension).map(|axis| high[axis] - low[axis]).collect();
    let mut text = format!(
        "// A first scene for {named}: {} nodes, {} elements {}, size {}.\n// Lines that begin with // are comments.\n",
        mesh.nodes().len(),
        mesh.element_count(),
        mesh.kind().name(),
        shown(&size)
    );
    let unit = if millimetres { "millimetres: moduli are in N/mm2" } else { "metres" };
    let _ = writeln!(text, "// By its size the mesh is taken to be in {unit}. `scale` multiplies its coordinates.");
    if groups.len() > 1 {
        let _ = writeln!(text, "// Groups of elements, of which the first is the body here: {}.", groups.join(", "));
    }
    for boundary in listed.iter().filter(|boundary| !boundary.name.is_empty()) {
        let Listed { name, facets, area, low, high, .. } = boundary;
        let (low, high) = (shown(&low[..dimension]), shown(&high[..dimension]));
        let _ = writeln!(text, "// boundary {}: {facets} facets, area {area:.4e}, from {low} to {high}", quoted(name));
    }
    if listed.iter().all(|boundary| boundary.name.is_empty()) {
        text += "// It names no boundary (physical groups in Gmsh); `parts` finds its lower and upper sides.\n";
    }
    text
}

/// Units, model, body, material.
fn body(text: &mut String, named: &str, mesh: &Mesh, group: Option<&String>, (young, millimetres): (f64, bool)) {
    let model = ["bar", "plane-strain", "space"][mesh.dimension() - 1];
    let unit = if millimetres { "mm" } else { "m" };
    let group = group.map_or_else(String::new, |group| format!(", \"group\": {}", quoted(group)));
    let _ = write!(
        text,
        "{{\n  \"format\": 1,\n  \"title\": {},\n  \"units\": {{\"length\": \"{unit}\", \"force\": \"N\"}},\n  \"model\": \"{model}\",\n  \
         \"body\": {{\"gmsh\": {{\"file\": {}, \"scale\": 1{group}}}}},\n  // Steel.\n  \"material\": {{\"young\": {}, \"poisson\": \
         0.3}},\n",
        quoted(&format!("{named}, pressed")),
        quoted(named),
        number(young)
    );
}

/// Parts that face down and up.
fn sides(text: &mut String, dimension: usize) {
    let direction = |sense: f64| {
        let mut direction = vec![0.0; dimension];
        direction[dimension - 1] = sense;
        vector(&direction)
    };
    let _ = write!(
        text,
        "  \"parts\": [\n    {{\"name\": \"lower\", \"normal\": {{\"direction\": {}, \"within\": 45}}}},\n    \
         {{\"name\": \"upper\", \"normal\": {{\"direction\": {}, \"within\": 45}}}}\n  ],\n",
        direction(-1.0),
        direction(1.0)
    );
}

/// Supports, and an obstacle that a force presses.
fn rest(
    text: &mut String,
    mesh: &Mesh,
    (held, pressed): (&str, &str),
    of_pressed: &Listed,
    (axis, sense, young): (usize, f64, f64),
) {
    let dimension = mesh.dimension();
    let components: Vec<String> = ["x", "y", "z"][..dimension].iter().map(|name| format!("\"{name}\": 0")).collect();
    let at = if sense > 0.0 { of_pressed.high } else { of_pressed.low };
    let size = mesh.size();
    // The position of the point within the plane is free: six digits of the size of the body are enough.
    let rounded = |value: f64| (value / size * 1e6).round() / 1e6 * size;
    let mut point = [0, 1, 2].map(|other| rounded((of_pressed.low[other] + of_pressed.high[other]) / 2.0));
    point[axis] = at[axis];
    let mut normal = [0.0; 3];
    normal[axis] = sense;
    let across = (0..dimension).filter(|&other| other != axis);
    let area: f64 = across.map(|other| of_pressed.high[other] - of_pressed.low[other]).product();
    // One significant digit is enough.
    let force: f64 = format!("{:.0e}", STRAIN * young * area).parse().unwrap_or(1.0);
    let approach = format!("{}{}", if sense > 0.0 { "+" } else { "-" }, ["x", "y", "z"][axis]);
    let _ = write!(
        text,
        "  \"supports\": [{{\"on\": {{\"boundary\": {}}}, {}}}],\n  // A plate comes along its approach direction, and presses with a \
         force; `gap` instead moves it.\n  \"obstacles\": [\n    {{\"boundary\": {}, \"approach\": \"{approach}\", \"force\": {},\n     \
         \"shape\": {{\"plane\": {{\"point\": {}, \"normal\": {}}}}}}}\n  ]\n}}\n",
        quoted(held),
        components.join(", "),
        quoted(pressed),
        number(force),
        vector(&point[..dimension]),
        vector(&normal[..dimension])
    );
}
