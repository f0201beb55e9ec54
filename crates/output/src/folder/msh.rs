//! A mesh as a file of Gmsh, format 2.2, which a scene can name as its body.

use std::fmt::Write as _;
use std::ops::Range;

use signorini_mechanics::fem::Mesh;

/// The file of a mesh with these bodies: a name and a range of elements each; boundaries keep their names.
pub(crate) fn msh(mesh: &Mesh, bodies: &[(&str, Range<usize>)]) -> String {
    let dimension = mesh.dimension();
    let mut text = String::from("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n");
    let _ = writeln!(text, "{}", mesh.boundaries().len() + bodies.len());
    let boundaries = mesh.boundaries().iter().map(|boundary| (dimension - 1, &*boundary.name));
    let groups = boundaries.chain(bodies.iter().map(|&(name, _)| (dimension, name)));
    for (index, (dimension, name)) in groups.enumerate() {
        let _ = writeln!(text, "{dimension} {} \"{name}\"", index + 1);
    }
    let _ = writeln!(text, "$EndPhysicalNames\n$Nodes\n{}", mesh.nodes().len());
    for (number, [x, y, z]) in mesh.nodes().iter().enumerate() {
        let _ = writeln!(text, "{} {x} {y} {z}", number + 1);
    }
    let facets: usize = mesh.boundaries().iter().map(|boundary| boundary.facet_count()).sum();
    let _ = writeln!(text, "$EndNodes\n$Elements\n{}", facets + mesh.element_count());
    let mut number = 0;
    let mut line = |kind: usize, order: &[usize], group: usize, nodes: &[usize]| {
        number += 1;
        let _ = write!(text, "{number} {kind} 2 {group} {group}");
        let mut in_file = vec![0; nodes.len()];
        order.iter().zip(nodes).for_each(|(&place, node)| in_file[place] = node + 1);
        in_file.iter().for_each(|node| {
            let _ = write!(text, " {node}");
        });
        text.push('\n');
    };
    for (index, boundary) in mesh.boundaries().iter().enumerate() {
        let facet = boundary.kind.reference();
        boundary.facets().for_each(|nodes| line(facet.gmsh, facet.gmsh_order, index + 1, nodes));
    }
    for (element, nodes) in mesh.elements().enumerate() {
        let body = bodies.iter().position(|(_, elements)| elements.contains(&element)).unwrap_or(0);
        let cell = mesh.kind_of(element).reference();
        line(cell.gmsh, cell.gmsh_order, mesh.boundaries().len() + 1 + body, nodes);
    }
    text += "$EndElements\n";
    text
}
