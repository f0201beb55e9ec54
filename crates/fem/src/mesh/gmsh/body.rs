//! The elements of the body: their selection, kind, plane, orientation, boundaries; groups that are glued by shared
//! nodes.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::content::{CellType, Element, ElementBlock, GmshFile};
use crate::element::ElementKind;
use crate::error::{Error, nearly};
use crate::mesh::file::{FileBody, Misfit, Numbers, boundary};
use crate::mesh::{Boundary, ElementGroup, Mesh, fail};
use signorini_linear::Forest;

/// The mesh of the elements of the groups of these names, or, without a name, of the highest dimension, and the number
/// in it of every node of the file; without boundaries.
pub(super) fn mesh(file: &GmshFile, domain: &[&str], scale: f64) -> Result<(Mesh, Numbers), Error> {
    let dimension = dimension(file, domain)?;
    let is_named = |tag: &u64| domain.contains(&file.name_of(dimension, *tag).as_str());
    let chosen = |groups: &[u64]| domain.is_empty() || groups.iter().any(is_named);
    let mut elements = Vec::new();
    // Version 2.2 writes an element once for each of its groups.
    let mut known: HashMap<&[usize], usize> = HashMap::new();
    for element in file.blocks_of(dimension).filter(|block| chosen(&block.groups)).flat_map(ElementBlock::elements) {
        known.entry(element.nodes).or_insert_with(|| {
            elements.push(element);
            elements.len() - 1
        });
    }
    let mut groups: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for block in file.blocks_of(dimension) {
        for tag in &block.groups {
            let within = block.elements().filter_map(|element| known.get(element.nodes));
            groups.entry(*tag).or_default().extend(within);
        }
    }
    let group = |(tag, mut elements): (u64, Vec<usize>)| {
        elements.sort_unstable();
        elements.dedup();
        ElementGroup { name: file.name_of(dimension, tag), elements }
    };
    let groups = groups.into_iter().filter(|(_, elements)| !elements.is_empty()).map(group).collect();
    let kind = kind(file, &elements)?;
    let order = kind.reference().gmsh_order;
    let connectivity = elements.iter().flat_map(|element| order.iter().map(|&place| element.nodes[place])).collect();
    let body = FileBody { kind, places: &file.nodes, connectivity, groups, turns: true };
    body.into_mesh(scale, |misfit| match misfit {
        Misfit::OffPlane([first, place], axis) => {
            let (tag, name) = (file.node_tags[place], ["x", "y", "z"][axis]);
            let [others, found] = [first, place].map(|place| file.nodes[place][axis]);
            let space = if dimension == 1 { "a bar lies along x" } else { "a plane body lies in z = const" };
            let message = format!("node {tag} has {name} = {found}, but the first node has {others}; {space}");
            file.fault(file.node_lines[place], message)
        }
        Misfit::Element(element, reason) => {
            let Element { line, tag, .. } = elements[element];
            file.fault(line, format!("element {tag}: {reason}"))
        }
    })
}

/// The one dimension of the groups of these names, or, without a name, the highest of the file.
fn dimension(file: &GmshFile, domain: &[&str]) -> Result<usize, Error> {
    let Some(first) = domain.first() else {
        let missing = || file.fault(file.last_line, "there are no elements beyond points; a body needs at least one");
        return file.highest().filter(|&dimension| dimension > 0).ok_or_else(missing);
    };
    let names: Vec<(usize, String)> = file.names_in_use().into_iter().filter(|(own, _)| *own > 0).collect();
    let of = |name: &str| names.iter().rev().find(|(_, other)| other == name).map(|(dimension, _)| *dimension);
    for name in domain {
        match (of(name), of(first)) {
            (None, _) if names.is_empty() => {
                return fail(format!("there is no physical group `{name}`; the file has none"));
            }
            (None, _) => {
                let names: Vec<&str> = names.iter().map(|(_, name)| name.as_str()).collect();
                let (there, meant) = (names.join(", "), nearly(name, names.iter().copied()));
                return fail(format!("there is no physical group `{name}` of elements; there are {there}{meant}"));
            }
            (own, first_own) if own != first_own => {
                return fail(format!("the elements of `{first}` and `{name}` have different dimensions"));
            }
            _ => {}
        }
    }
    Ok(of(first).unwrap_or_default())
}

/// The one kind of all elements.
fn kind(file: &GmshFile, elements: &[Element]) -> Result<ElementKind, Error> {
    let mut counts: Vec<(&CellType, usize, usize)> = Vec::new();
    for element in elements {
        match counts.iter_mut().find(|(cell, ..)| *cell == element.cell) {
            Some((_, count, _)) => *count += 1,
            None => counts.push((element.cell, 1, element.line)),
        }
    }
    match counts[..] {
        [] => Err(file.fault(file.last_line, "there are no elements; a body needs at least one")),
        [(cell, _, line)] => accepted(cell).map_err(|reason| file.fault(line, reason)),
        [_, (.., line), ..] => {
            let found: Vec<String> = counts.iter().map(|(cell, count, _)| format!("{count} {}", cell.plural)).collect();
            let message = format!(
                "the body mixes {}; it must have one kind of element: mesh it again (in Gmsh, `Recombine` all of it, or nothing), or name \
                 a `group` of one kind",
                found.join(", ")
            );
            Err(file.fault(line, message))
        }
    }
}

/// The element of this library for an element type of the file.
fn accepted(cell: &CellType) -> Result<ElementKind, String> {
    let refused = |reason: &str| Err(format!("{} are refused: {reason}", cell.plural));
    if let Some(kind) = ElementKind::ALL.into_iter().find(|kind| kind.reference().gmsh == cell.number) {
        return Ok(kind);
    }
    match cell.number {
        10 => refused("quadratic quadrilaterals must have eight nodes (in Gmsh, `Mesh.SecondOrderIncomplete = 1`)"),
        12 => refused("quadratic bricks must have 20 nodes (in Gmsh, `Mesh.SecondOrderIncomplete = 1`)"),
        8 => refused("a bar element must have two nodes (in Gmsh, `Mesh.ElementOrder = 1`)"),
        _ => refused("bodies in space must consist of tetrahedra (four or ten nodes) or bricks (eight or 20 nodes)"),
    }
}

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
                Some((element, face)) if known.insert((element, face)) => {
                    // In the order of its element: the outside is on the right of an edge.
                    let (nodes, faces) = (mesh.element(element), mesh.kind_of(0).reference().faces);
                    connectivity.extend(faces[face].iter().map(|&local| nodes[local]));
                }
                None if !is_part => {
                    let message =
                        format!("element {} of the physical group `{name}` is not a face of the body", facet.tag);
                    return Err(file.fault(facet.line, message));
                }
                _ => {}
            }
        }
        boundaries.extend(boundary(mesh, &name, connectivity));
    }
    Ok(boundaries)
}

/// The elements of all groups of this dimension and name.
fn facets<'a>(file: &'a GmshFile, dimension: usize, name: &str) -> Vec<Element<'a>> {
    let has_name = |block: &&ElementBlock| block.groups.iter().any(|&tag| file.name_of(dimension, tag) == name);
    file.blocks_of(dimension).filter(has_name).flat_map(ElementBlock::elements).collect()
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

/// Groups of elements of the highest dimension that share nodes with each other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Glued {
    /// Their names, in the order of the file.
    pub groups: Vec<String>,
    /// The pairs of groups that share nodes, by their places in `groups`, with the number of these nodes.
    pub shared: Vec<(usize, usize, usize)>,
}

impl GmshFile {
    /// The groups of elements of the highest dimension, those that share nodes together: each set is a body. Empty
    /// without groups.
    #[doc(hidden)]
    pub fn glued(&self) -> Vec<Glued> {
        let names = self.bodies();
        let Some(highest) = self.highest() else { return Vec::new() };
        let mut used = vec![vec![false; self.nodes.len()]; names.len()];
        for block in self.blocks_of(highest) {
            for name in block.groups.iter().map(|&tag| self.name_of(highest, tag)) {
                if let Some(group) = names.iter().position(|other| *other == name) {
                    block.nodes.iter().for_each(|&node| used[group][node] = true);
                }
            }
        }
        let shared = |one: usize, two: usize| used[one].iter().zip(&used[two]).filter(|(a, b)| **a && **b).count();
        let mut forest = Forest::new(names.len());
        let mut pairs = Vec::new();
        for two in 1..names.len() {
            for one in (0..two).filter(|&one| shared(one, two) > 0) {
                pairs.push((one, two, shared(one, two)));
                forest.join(one, two);
            }
        }
        let (sets, count) = forest.into_trees();
        let set = |set: usize| {
            let members: Vec<usize> = (0..names.len()).filter(|&group| sets[group] == set).collect();
            let place = |group: usize| members.iter().position(|&member| member == group);
            let own = pairs.iter().filter_map(|&(one, two, nodes)| Some((place(one)?, place(two)?, nodes)));
            Glued { shared: own.collect(), groups: members.iter().map(|&group| names[group].clone()).collect() }
        };
        (0..count).map(set).collect()
    }
}
