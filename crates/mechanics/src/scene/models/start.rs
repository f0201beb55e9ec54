//! A first scene for a mesh: the content of the file, and a scene that runs and can be changed.

use std::fmt::Write;
use std::path::Path;

use super::build::model_of;
use super::elastic::STEEL;
use crate::error::Error;
use crate::fem::geometry::{along_axis, distance};
use crate::fem::mesh::gmsh::Glued;
use crate::fem::mesh::{Mesh, extent, fail};
use crate::fem::{ElasticBody, Formulation, GmshFile, Material, tributary_areas};
use crate::scene::input::entry::number;
use crate::scene::input::roles::{Chosen, Roles, roles};
use crate::scene::input::schema::{PartSpec, Scene};

pub(crate) fn first_scene(file: &Path, named: &str) -> Result<String, Error> {
    let bodies = Bodies::of(&GmshFile::read(file)?)?;
    let comments = head(named, &bodies);
    let mut reason = String::from("no side faces up while another, which holds all pieces of the mesh, faces down");
    for roles in roles(&bodies.joined) {
        let text = comments.clone() + &scene(named, &bodies, &roles);
        match model_of(&Scene::from_json(&text, named)?, bodies.separate.clone(), &[]) {
            Ok(_) => return Ok(text),
            Err(error) => reason = error.to_string(),
        }
    }
    let message = format!("no first scene holds one boundary of this mesh and presses another: {reason}");
    fail(message)
}

/// The approximate strain under the force: far from large, far above rounding.
const STRAIN: f64 = 1e-4;

/// The stiffness of the springs of a body over that of a cube of its material: they take next to nothing of the force.
const WEAK: f64 = 1e-5;

pub(crate) fn quoted(name: &str) -> String {
    serde_json::Value::from(name).to_string()
}

/// A vector as it is written in a scene: with all digits, because a plane must touch the body.
fn vector(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|&value| number(value + 0.0)).collect();
    format!("[{}]", values.join(", "))
}

/// A vector for the reader, in six digits.
pub(crate) fn shown(values: &[f64]) -> String {
    vector(&values.iter().map(|value| format!("{value:.5e}").parse().unwrap_or(*value)).collect::<Vec<f64>>())
}

/// A number with one significant digit, which is enough for forces and springs.
fn one_digit(value: f64) -> String {
    number(format!("{value:.0e}").parse().unwrap_or(1.0))
}

/// A direction of the model for each of its coordinates, with the same value.
fn along_all(dimension: usize, value: &str) -> String {
    let entries: Vec<String> = ["x", "y", "z"][..dimension].iter().map(|name| format!("\"{name}\": {value}")).collect();
    entries.join(", ")
}

/// The scene without comments on the file.
pub(crate) fn scene(named: &str, bodies: &Bodies, roles: &Roles) -> String {
    let mut text = described(named, bodies);
    let mesh = bodies.joined.mesh();
    let mut parts = Vec::new();
    let mut held = vec![named_side(&roles.held, "held", mesh, &mut parts)];
    for chosen in &roles.also_held {
        let name = format!("held of {}", chosen.of().unwrap_or("body"));
        held.push(named_side(chosen, &name, mesh, &mut parts));
    }
    let pressed = named_side(&roles.pressed, "pressed", mesh, &mut parts);
    let loose: Vec<String> = roles.loose.iter().map(|&body| surface(body, bodies, &mut parts)).collect();
    if !parts.is_empty() {
        let _ = write!(text, "  \"parts\": [\n{}\n  ],\n", parts.iter().map(written).collect::<Vec<_>>().join(",\n"));
    }
    let support =
        |name: &String| format!("{{\"on\": {{\"boundary\": {}}}, {}}}", quoted(name), along_all(mesh.dimension(), "0"));
    let supports: Vec<String> = held.iter().map(support).collect();
    let _ = writeln!(text, "  \"supports\": [{}],", supports.join(",\n               "));
    if !loose.is_empty() {
        text += &springs(&loose, mesh, bodies.young);
    }
    text += &plate(&pressed, roles, mesh, bodies.young);
    text
}

/// Units, model, bodies, material.
fn described(named: &str, bodies: &Bodies) -> String {
    let model = ["bar", "plane-strain", "space"][bodies.joined.dimension() - 1];
    let unit = if bodies.are_in_millimetres { "mm" } else { "m" };
    let material = format!("\"material\": {{\"young\": {}, \"poisson\": 0.3}}", number(bodies.young));
    let body = |groups: &[String]| {
        let names: Vec<String> = groups.iter().map(|name| quoted(name)).collect();
        let group = match &names[..] {
            [] => String::new(),
            [name] => format!(", \"group\": {name}"),
            _ => format!(", \"group\": [{}]", names.join(", ")),
        };
        format!("\"body\": {{\"gmsh\": {{\"file\": {}, \"scale\": 1{group}}}}}", quoted(named))
    };
    let mut text = format!(
        "{{\n  \"format\": 1,\n  \"title\": {},\n  \"units\": {{\"length\": \"{unit}\", \"force\": \"N\"}},\n  \"model\": \"{model}\",\n",
        quoted(&format!("{named}, pressed")),
    );
    let further = bodies.sets.iter().zip(&bodies.names).skip(1);
    let further = further
        .map(|(set, name)| format!("    {{\"name\": {}, {},\n     {material}}}", quoted(name), body(&set.groups)));
    let further: Vec<String> = further.collect();
    let first = bodies.sets.first().map_or(&[][..], |set| &set.groups);
    let _ = write!(text, "  {},\n  // Steel.\n  {material},\n", body(first));
    if !further.is_empty() {
        let _ = write!(text, "  \"further-bodies\": [\n{}\n  ],\n  \"contact\": \"auto\",\n", further.join(",\n"));
    }
    text
}

/// The name of what is held or pressed. Facets that face a direction are added to `parts`, with a name that no boundary
/// has.
fn named_side(chosen: &Chosen, name: &str, mesh: &Mesh, parts: &mut Vec<PartSpec>) -> String {
    let (way, of) = match chosen {
        Chosen::Boundary(name) => return name.clone(),
        Chosen::Facing(way, of) => (*way, of.clone()),
    };
    let name = free_name(name, mesh);
    parts.push(PartSpec { name: name.clone(), ..Chosen::spec(way, of, mesh.dimension()) });
    name
}

/// The name of the whole surface of a body, which is added to `parts`.
fn surface(body: usize, bodies: &Bodies, parts: &mut Vec<PartSpec>) -> String {
    let of = (body > 0).then(|| bodies.names[body].clone());
    let name = free_name(&format!("surface of {}", of.as_deref().unwrap_or("body")), bodies.joined.mesh());
    parts.push(PartSpec { name: name.clone(), of, cuboid: None, sphere: None, normal: None });
    name
}

/// The name, or a longer one that no boundary has.
fn free_name(name: &str, mesh: &Mesh) -> String {
    let mut name = name.to_string();
    while mesh.boundary(&name).is_some() {
        name += "-part";
    }
    name
}

/// A part as it is written in a scene.
fn written(part: &PartSpec) -> String {
    let of = part.of.as_ref().map_or_else(String::new, |of| format!(", \"of\": {}", quoted(of)));
    let normal = part.normal.as_ref().map_or_else(String::new, |normal| {
        let direction = vector(&normal.direction);
        format!(", \"normal\": {{\"direction\": {direction}, \"within\": {}}}", number(normal.within))
    });
    format!("    {{\"name\": {}{of}{normal}}}", quoted(&part.name))
}

/// Weak springs on the bodies that nothing else holds.
fn springs(surfaces: &[String], mesh: &Mesh, young: f64) -> String {
    let dimension = mesh.dimension();
    let stiffness = one_digit(WEAK * young * mesh.size().powi(dimension as i32 - 2));
    let spring = |name: &String| {
        format!("    {{\"on\": {{\"boundary\": {}}}, {}}}", quoted(name), along_all(dimension, &stiffness))
    };
    let springs: Vec<String> = surfaces.iter().map(spring).collect();
    format!(
        "  // No support holds these bodies, and contact holds them only where it presses: weak springs, which take next to nothing of the \
         force,\n  // keep them from drifting away. Put supports in their place where the real bodies have some.\n  \
         \"springs\": [\n{}\n  ],\n",
        springs.join(",\n")
    )
}

/// The text of an obstacle that a force presses onto the body.
fn plate(pressed: &str, roles: &Roles, mesh: &Mesh, young: f64) -> String {
    let (dimension, (axis, sense), (low, high)) = (mesh.dimension(), roles.way, roles.extent);
    let size = mesh.size();
    // The position of the point within the plane is free: six digits of the size of the body are enough.
    let rounded = |value: f64| (value / size * 1e6).round() / 1e6 * size;
    let mut point = [0, 1, 2].map(|other| rounded((low[other] + high[other]) / 2.0));
    point[axis] = if sense > 0.0 { high[axis] } else { low[axis] };
    let across = (0..dimension).filter(|&other| other != axis);
    let area: f64 = across.map(|other| high[other] - low[other]).product();
    let approach = format!("{}{}", if sense > 0.0 { "+" } else { "-" }, ["x", "y", "z"][axis]);
    format!(
        "  // A plate comes along its approach direction, and presses with a force; `gap` instead moves it.\n  \"obstacles\": [\n    \
         {{\"boundary\": {}, \"approach\": \"{approach}\", \"force\": {},\n     \"shape\": {{\"plane\": {{\"point\": {}, \"normal\": \
         {}}}}}}}\n  ]\n}}\n",
        quoted(pressed),
        one_digit(STRAIN * young * area),
        vector(&point[..dimension]),
        vector(&along_axis(axis, sense)[..dimension])
    )
}

/// A body larger than this is assumed to be given in millimetres: few parts are larger in metres.
const LARGEST_IN_METRES: f64 = 5.0;

/// The bodies of a file, of steel.
pub struct Bodies {
    /// The groups of each body; without a group one body has all elements.
    pub sets: Vec<Glued>,
    /// The name of each body in the scene: that of its first group; empty for the first body.
    pub names: Vec<String>,
    pub separate: Vec<ElasticBody>,
    /// All in one.
    pub joined: ElasticBody,
    /// `true` if the mesh is taken to be in millimetres.
    pub are_in_millimetres: bool,
    /// Young's modulus, in force per area.
    pub young: f64,
}

impl Bodies {
    pub fn of(file: &GmshFile) -> Result<Self, Error> {
        let mut sets = file.glued();
        if let [Glued { groups, .. }] = &mut sets[..]
            && groups.len() == 1
        {
            groups.clear();
        }
        if sets.is_empty() {
            sets.push(Glued::default());
        }
        let mesh = |set: &Glued| file.mesh(&set.groups.iter().map(String::as_str).collect::<Vec<_>>(), 1.0);
        let meshes: Vec<Mesh> = sets.iter().map(mesh).collect::<Result<_, _>>()?;
        let corners: Vec<[f64; 3]> = meshes.iter().map(Mesh::extent).flat_map(|(low, high)| [low, high]).collect();
        let (low, high) = extent(&corners);
        let are_in_millimetres = distance(low, high) > LARGEST_IN_METRES;
        let young = if are_in_millimetres { STEEL / 1e6 } else { STEEL };
        let mut separate = Vec::with_capacity(meshes.len());
        for mesh in meshes {
            let formulation = match mesh.dimension() {
                1 => Formulation::Bar { area: 1.0 },
                2 => Formulation::PlaneStrain { thickness: 1.0 },
                _ => Formulation::Space,
            };
            separate.push(ElasticBody::new(mesh, Material::new(young, 0.3)?, formulation)?);
        }
        let Some(mut joined) = separate.first().cloned() else { return fail("the file has no body".into()) };
        let mut names = vec![String::new()];
        for (body, set) in separate.iter().zip(&sets).skip(1) {
            // A boundary of this name would hide the surface of the body.
            let mut name = set.groups.first().cloned().unwrap_or_default();
            while joined.mesh().boundary(&name).is_some() {
                name += "-body";
            }
            joined = joined.beside(body, &name)?;
            names.push(name);
        }
        Ok(Bodies { sets, names, separate, joined, are_in_millimetres, young })
    }
}

/// The comments that open a first scene: the file, its size and its bodies.
pub(crate) fn head(named: &str, bodies: &Bodies) -> String {
    let mesh = bodies.joined.mesh();
    let (dimension, (low, high)) = (mesh.dimension(), mesh.extent());
    let size: Vec<f64> = (0..dimension).map(|axis| high[axis] - low[axis]).collect();
    let count = bodies.sets.len();
    let kind = if count > 1 { format!("in {count} bodies") } else { mesh.kind_of(0).name().to_string() };
    let mut text = format!(
        "// A first scene for {named}: {} nodes, {} elements {kind}, size {}.\n// Lines that begin with // are comments.\n",
        mesh.nodes().len(),
        mesh.element_count(),
        shown(&size)
    );
    let unit = if bodies.are_in_millimetres { "millimetres: moduli are in N/mm2" } else { "metres" };
    let _ = writeln!(text, "// By its size the mesh is taken to be in {unit}. `scale` multiplies its coordinates.");
    text += &groups(bodies);
    for boundary in mesh.boundaries() {
        let area: f64 = tributary_areas(&bodies.joined, boundary).iter().map(|(_, area)| area).sum();
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

/// Which groups of elements are glued, and which bodies only contact joins; empty for a single group.
fn groups(bodies: &Bodies) -> String {
    let mut text = String::new();
    let mut is_glued = false;
    for (place, (set, body)) in bodies.sets.iter().zip(&bodies.separate).enumerate() {
        if set.groups.is_empty() {
            continue;
        }
        let name =
            if place == 0 { "`body`".to_string() } else { format!("further body {}", quoted(&bodies.names[place])) };
        let names: Vec<String> = set.groups.iter().map(|name| quoted(name)).collect();
        let elements = |mesh: &Mesh| format!("{} elements {}", mesh.element_count(), mesh.kind_of(0).name());
        let glue: Vec<String> = set
            .shared
            .iter()
            .map(|&(one, two, nodes)| format!("{} and {} share {nodes} nodes", names[one], names[two]))
            .collect();
        let words = if names.len() == 1 { "the group " } else { "the groups " };
        is_glued |= !glue.is_empty();
        let glue = if glue.is_empty() { String::new() } else { format!("; glued: {}", glue.join(", ")) };
        let _ = writeln!(text, "// {name}: {words}{}, {}{glue}.", names.join(", "), elements(body.mesh()));
    }
    if is_glued {
        text += "// Glued groups are one body. `materials` gives each a material of its own; as a body of its own, each may slide.\n";
    }
    if bodies.sets.len() > 1 {
        text += "// The bodies share no node: only contact joins them. \"contact\": \"auto\" finds the surfaces that face each other.\n";
    }
    text
}
