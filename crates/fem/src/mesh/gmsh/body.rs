//! The elements of the body: their selection, kind, plane, orientation, boundaries; groups that are glued by shared
//! nodes.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::content::{CellType, Element, GmshFile};
use crate::element::ElementKind;
use crate::error::{Error, nearly};
use crate::mesh::faces::chained;
use crate::mesh::{Boundary, ElementGroup, Mesh, fail, flatten, unfit};
use signorini_linear::Forest;

/// The number in the mesh of each node of the file, if it is in the body.
pub(super) type Numbers = Vec<Option<usize>>;

pub(super) struct Body<'a> {
    kind: ElementKind,
    elements: Vec<Element<'a>>,
    groups: Vec<ElementGroup>,
}

impl<'a> Body<'a> {
    /// The elements of the groups of these names, or, without a name, of the highest dimension.
    pub fn select(file: &'a GmshFile, domain: &[&str]) -> Result<Self, Error> {
        let dimension = dimension(file, domain)?;
        let is_named = |tag: &u64| domain.contains(&file.name_of(dimension, *tag).as_str());
        let chosen = |groups: &[u64]| domain.is_empty() || groups.iter().any(is_named);
        let mut elements = Vec::new();
        // Version 2.2 writes an element once for each of its groups.
        let mut known: HashMap<&[usize], usize> = HashMap::new();
        let own = || file.blocks.iter().filter(|block| block.cell.dimension == dimension);
        for element in own().filter(|block| chosen(&block.groups)).flat_map(|block| file.elements_of(block)) {
            known.entry(element.nodes).or_insert_with(|| {
                elements.push(element);
                elements.len() - 1
            });
        }
        let mut groups: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
        for block in own() {
            for tag in &block.groups {
                let within = file.elements_of(block).filter_map(|element| known.get(element.nodes));
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
        Ok(Body { kind, elements, groups })
    }

    /// The mesh without boundaries, and the number in it of every node of the file.
    pub fn mesh(&self, file: &GmshFile, scale: f64) -> Result<(Mesh, Numbers), Error> {
        let mut used = vec![false; file.nodes.len()];
        self.elements.iter().flat_map(|element| element.nodes).for_each(|&node| used[node] = true);
        let (mut nodes, mut numbers): (Vec<[f64; 3]>, Numbers) = (Vec::new(), vec![None; used.len()]);
        for (place, at) in file.nodes.iter().enumerate().filter(|&(place, _)| used[place]) {
            numbers[place] = Some(nodes.len());
            nodes.push(at.map(|value| value * scale));
        }
        let dimension = self.kind.dimension();
        flatten(dimension, &mut nodes).map_err(|(node, axis)| {
            let place_of = |node: usize| numbers.iter().position(|number| *number == Some(node)).unwrap_or(0);
            let [first, place] = [0, node].map(place_of);
            let (tag, name) = (file.node_tags[place], ["x", "y", "z"][axis]);
            let [others, found] = [first, place].map(|place| file.nodes[place][axis]);
            let space = if dimension == 1 { "a bar lies along x" } else { "a plane body lies in z = const" };
            let message = format!("node {tag} has {name} = {found}, but the first node has {others}; {space}");
            file.fault(file.node_lines[place], message)
        })?;
        let mut connectivity = Vec::with_capacity(self.elements.len() * self.kind.nodes());
        let order = self.kind.reference().gmsh_order;
        for element in &self.elements {
            connectivity.extend(order.iter().filter_map(|&place| numbers[element.nodes[place]]));
        }
        if dimension < 3 {
            turn_if_clockwise(self.kind, &nodes, &mut connectivity);
        }
        if let Some((element, reason)) = unfit(self.kind, &nodes, &connectivity) {
            let Element { line, tag, .. } = self.elements[element];
            return Err(file.fault(line, format!("element {tag}: {reason}")));
        }
        Ok((Mesh::new(nodes, self.kind, connectivity, Vec::new())?.with_groups(self.groups.clone()), numbers))
    }
}

/// The one dimension of the groups of these names, or, without a name, the highest of the file.
fn dimension(file: &GmshFile, domain: &[&str]) -> Result<usize, Error> {
    let Some(first) = domain.first() else {
        let highest = file.blocks.iter().map(|block| block.cell.dimension).max();
        let missing = || file.fault(file.last_line, "there are no elements beyond points; a body needs at least one");
        return highest.filter(|&dimension| dimension > 0).ok_or_else(missing);
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

/// Reverses every element if all have the wrong orientation; the right one is along x in a bar, counterclockwise in the
/// plane.
fn turn_if_clockwise(kind: ElementKind, nodes: &[[f64; 3]], connectivity: &mut [usize]) {
    let corners = kind.corners();
    let runs_wrong = |element: &[usize]| {
        let start = nodes[element[0]];
        let arm = |corner: usize| [0, 1].map(|axis| nodes[element[corner]][axis] - start[axis]);
        if corners == 2 {
            return arm(1)[0] < 0.0;
        }
        let doubled: f64 =
            (2..corners).map(|corner| (arm(corner - 1), arm(corner))).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum();
        doubled < 0.0
    };
    if !connectivity.chunks_exact(kind.nodes()).all(runs_wrong) {
        return;
    }
    for element in connectivity.chunks_exact_mut(kind.nodes()) {
        // The first corner stays; mid-side k, between corners k and k + 1, becomes the last but k.
        let start = if corners == 2 { 0 } else { 1 };
        element[start..corners].reverse();
        element[corners..].reverse();
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
        let Some(highest) = self.blocks.iter().map(|block| block.cell.dimension).max() else { return Vec::new() };
        let mut used = vec![vec![false; self.nodes.len()]; names.len()];
        for block in self.blocks.iter().filter(|block| block.cell.dimension == highest) {
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
