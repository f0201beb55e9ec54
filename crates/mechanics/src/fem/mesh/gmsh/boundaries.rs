//! Physical groups one dimension below the body: its boundaries.

use std::collections::HashSet;

use super::body::Numbers;
use super::file::{Element, GmshFile};
use crate::error::Error;
use crate::fem::mesh::outline::chained;
use crate::fem::mesh::{Boundary, Mesh};

/// The boundaries of `mesh`, in the order of the file. Facets of a group that are not faces of the body are left out if
/// the body is a part of the file, and else an error of the file.
pub(super) fn of(file: &GmshFile, mesh: &Mesh, numbers: &Numbers, is_part: bool) -> Result<Vec<Boundary>, Error> {
    let dimension = mesh.dimension() - 1;
    let mut boundaries = Vec::new();
    for (_, name) in file.names_in_use().into_iter().filter(|(other, _)| *other == dimension) {
        let mut connectivity = Vec::new();
        let mut known = HashSet::new();
        let mut facets = facets(file, dimension, &name);
        if is_part {
            // Bodies of one file may have faces of different kinds.
            facets.retain(|facet| facet.nodes.iter().all(|&node| numbers[node].is_some()));
        }
        let placed = Boundary::new(name.as_str(), mesh.kind_of(0).facet(), in_mesh(file, mesh, &facets, numbers)?);
        let faces = mesh.faces_of(&placed);
        for (facet, face) in facets.iter().zip(faces) {
            match face {
                // Version 2.2 writes an element once for each of its groups.
                Some(face) if known.insert(face) => connectivity.extend(nodes_of(mesh, face)),
                None if !is_part => {
                    let message =
                        format!("element {} of the physical group `{name}` is not a face of the body", facet.tag);
                    return Err(file.fault(facet.line, message));
                }
                _ => {}
            }
        }
        if !connectivity.is_empty() {
            let kind = mesh.kind_of(0).facet();
            boundaries.push(Boundary::new(name, kind, chained(kind, connectivity)));
        }
    }
    Ok(boundaries)
}

/// The elements of all groups of this dimension and name.
fn facets<'a>(file: &'a GmshFile, dimension: usize, name: &str) -> Vec<Element<'a>> {
    let blocks = file.blocks.iter().filter(|block| block.cell.dimension == dimension);
    let named = blocks.filter(|block| block.groups.iter().any(|&tag| file.name_of(dimension, tag) == name));
    named.flat_map(|block| file.elements_of(block)).collect()
}

/// The nodes of facets in the numbers of the mesh; a node outside the body gets a number larger than the last.
fn in_mesh(file: &GmshFile, mesh: &Mesh, facets: &[Element], numbers: &Numbers) -> Result<Vec<usize>, Error> {
    let wanted = mesh.kind_of(0).facet().nodes();
    let mut nodes = Vec::with_capacity(facets.len() * wanted);
    for facet in facets {
        if facet.nodes.len() != wanted {
            let message = format!(
                "element {} is one of {}, but the faces of {} have {wanted} nodes",
                facet.tag,
                facet.cell.plural,
                mesh.kind_of(0).name()
            );
            return Err(file.fault(facet.line, message));
        }
        nodes.extend(facet.nodes.iter().map(|&node| numbers[node].unwrap_or(usize::MAX - 1)));
    }
    Ok(nodes)
}

/// The nodes of a face in the order of its element: the outside is on the right of an edge.
fn nodes_of(mesh: &Mesh, (element, face): (usize, usize)) -> Vec<usize> {
    let nodes = mesh.elements().nth(element).unwrap_or_default();
    mesh.kind_of(0).reference().faces[face].iter().map(|&local| nodes[local]).collect()
}
