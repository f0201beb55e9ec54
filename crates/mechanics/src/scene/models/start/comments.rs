//! The comments of a first scene: the content of the file.

use std::fmt::Write;

use super::bodies::Bodies;
use super::text::{quoted, shown};
use crate::fem::mesh::{Mesh, extent};
use crate::fem::tributary_areas;

/// The comments that open a first scene: the file, its size and its bodies.
pub(super) fn head(named: &str, bodies: &Bodies) -> String {
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
