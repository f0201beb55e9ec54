//! A first scene for a mesh: the content of the file, and a scene that runs and can be changed.

use std::fmt::Write;
use std::path::Path;

use super::elastic::STEEL;
use crate::error::Error;
use crate::fem::geometry::along_axis;
use crate::fem::mesh::{Mesh, extent};
use crate::fem::{ElasticBody, Formulation, GmshFile, Material, tributary_areas};
use crate::scene::input::absent::absent;
use crate::scene::input::entry::number;
use crate::scene::input::roles::{Chosen, Roles, roles};
use crate::scene::input::schema::{PartSpec, Scene};

/// A body larger than this is assumed to be given in millimetres: few parts are larger in metres.
const LARGEST_IN_METRES: f64 = 5.0;

/// The approximate strain under the force: far from large, far above rounding.
const STRAIN: f64 = 1e-4;

impl Scene {
    /// The sentence about a thing that is not modelled, if it has this name in other programs.
    pub fn not_modelled(name: &str) -> Option<&'static str> {
        absent(name)
    }

    /// The text of a scene for the mesh `file`, with comment lines; `named` is the name of the file in the scene. The scene is built before it is
    /// returned, so that it is not refused later.
    ///
    /// # Errors
    /// As [`GmshFile::read`] and [`GmshFile::mesh`]; [`Error::Mesh`] for a mesh of which no boundary can be held while another is pressed.
    pub fn start(file: &Path, named: &str) -> Result<String, Error> {
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
        let elastic = ElasticBody::new(mesh, Material::new(young, 0.3)?, formulation)?;
        let mut reason = String::from("no side faces up while another, which holds all pieces of the mesh, faces down");
        for roles in roles(&elastic) {
            let mut text = head(named, &elastic, &groups, millimetres);
            body(&mut text, named, elastic.mesh(), group, (young, millimetres));
            rest(&mut text, elastic.mesh(), &roles, young);
            match Scene::from_json(&text, named)?.build_of(vec![elastic.clone()], &[]) {
                Ok(_) => return Ok(text),
                Err(error) => reason = error.to_string(),
            }
        }
        let message = format!("no first scene holds one boundary of this mesh and presses another: {reason}");
        Err(Error::Mesh { message })
    }
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
fn head(named: &str, body: &ElasticBody, groups: &[String], millimetres: bool) -> String {
    let mesh = body.mesh();
    let (dimension, (low, high)) = (mesh.dimension(), mesh.extent());
    let size: Vec<f64> = (0..dimension).map(|axis| high[axis] - low[axis]).collect();
    let mut text = format!(
        "// A first scene for {named}: {} nodes, {} elements {}, size {}.\n// Lines that begin with // are comments.\n",
        mesh.nodes().len(),
        mesh.element_count(),
        mesh.kind_of(0).name(),
        shown(&size)
    );
    let unit = if millimetres { "millimetres: moduli are in N/mm2" } else { "metres" };
    let _ = writeln!(text, "// By its size the mesh is taken to be in {unit}. `scale` multiplies its coordinates.");
    if groups.len() > 1 {
        let _ = writeln!(text, "// Groups of elements, of which the first is the body here: {}.", groups.join(", "));
    }
    for boundary in mesh.boundaries() {
        let area: f64 = tributary_areas(body, boundary).iter().map(|(_, area)| area).sum();
        let nodes: Vec<[f64; 3]> = boundary.nodes().into_iter().map(|node| mesh.nodes()[node]).collect();
        let (low, high) = extent(&nodes);
        let (low, high) = (shown(&low[..dimension]), shown(&high[..dimension]));
        let (name, facets) = (quoted(&boundary.name), boundary.facet_count());
        let _ = writeln!(text, "// boundary {name}: {facets} facets, area {area:.4e}, from {low} to {high}");
    }
    if mesh.boundaries().is_empty() {
        text += "// It names no boundary (physical groups in Gmsh); `parts` finds a side to be held and one to be pressed.\n";
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

/// The name of what is held or pressed. Facets that face a direction are added to `parts`, with a name that no boundary has.
fn named(chosen: &Chosen, name: &str, mesh: &Mesh, parts: &mut Vec<PartSpec>) -> String {
    let (way, of) = match chosen {
        Chosen::Boundary(name) => return name.clone(),
        Chosen::Facing(way, of) => (*way, of.clone()),
    };
    let mut name = name.to_string();
    while mesh.boundary(&name).is_some() {
        name += "-part";
    }
    parts.push(PartSpec { name: name.clone(), ..Chosen::spec(way, of, mesh.dimension()) });
    name
}

/// A part as it is written in a scene.
fn written(part: &PartSpec) -> String {
    let of = part.of.as_ref().map_or_else(String::new, |of| format!("\"of\": {}, ", quoted(of)));
    let normal = part.normal.as_ref().map_or_else(String::new, |normal| {
        format!("{{\"direction\": {}, \"within\": {}}}", vector(&normal.direction), number(normal.within))
    });
    format!("    {{\"name\": {}, {of}\"normal\": {normal}}}", quoted(&part.name))
}

/// Parts, supports, and an obstacle that a force presses.
fn rest(text: &mut String, mesh: &Mesh, roles: &Roles, young: f64) {
    let (dimension, (axis, sense), (low, high)) = (mesh.dimension(), roles.way, roles.extent);
    let mut parts = Vec::new();
    let held = named(&roles.held, "held", mesh, &mut parts);
    let pressed = named(&roles.pressed, "pressed", mesh, &mut parts);
    if !parts.is_empty() {
        let _ = write!(text, "  \"parts\": [\n{}\n  ],\n", parts.iter().map(written).collect::<Vec<_>>().join(",\n"));
    }
    let components: Vec<String> = ["x", "y", "z"][..dimension].iter().map(|name| format!("\"{name}\": 0")).collect();
    let size = mesh.size();
    // The position of the point within the plane is free: six digits of the size of the body are enough.
    let rounded = |value: f64| (value / size * 1e6).round() / 1e6 * size;
    let mut point = [0, 1, 2].map(|other| rounded((low[other] + high[other]) / 2.0));
    point[axis] = if sense > 0.0 { high[axis] } else { low[axis] };
    let across = (0..dimension).filter(|&other| other != axis);
    let area: f64 = across.map(|other| high[other] - low[other]).product();
    // One significant digit is enough.
    let force: f64 = format!("{:.0e}", STRAIN * young * area).parse().unwrap_or(1.0);
    let approach = format!("{}{}", if sense > 0.0 { "+" } else { "-" }, ["x", "y", "z"][axis]);
    let _ = write!(
        text,
        "  \"supports\": [{{\"on\": {{\"boundary\": {}}}, {}}}],\n  // A plate comes along its approach direction, and presses with a \
         force; `gap` instead moves it.\n  \"obstacles\": [\n    {{\"boundary\": {}, \"approach\": \"{approach}\", \"force\": {},\n     \
         \"shape\": {{\"plane\": {{\"point\": {}, \"normal\": {}}}}}}}\n  ]\n}}\n",
        quoted(&held),
        components.join(", "),
        quoted(&pressed),
        number(force),
        vector(&point[..dimension]),
        vector(&along_axis(axis, sense)[..dimension])
    );
}
