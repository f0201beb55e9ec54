//! The elements of the body: their selection, kind, plane and orientation.

use std::collections::{BTreeMap, HashMap};

use super::cells::CellType;
use super::file::{Element, GmshFile};
use crate::error::{Error, nearly};
use crate::fem::element::{Cell, ElementKind, MAX_NODES, Rule, Tabulated};
use crate::fem::mesh::{ElementGroup, Mesh, fail};

/// A node of a mesh file is outside the plane if it is farther from it than this times the size of the body: far above
/// the rounding of Gmsh and far below the size of any cell.
const FLAT: f64 = 1e-9;

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
        let mut nodes = Vec::new();
        let mut numbers: Numbers = vec![None; used.len()];
        for (place, at) in file.nodes.iter().enumerate().filter(|&(place, _)| used[place]) {
            numbers[place] = Some(nodes.len());
            nodes.push(at.map(|value| value * scale));
        }
        self.flatten(file, &used, &mut nodes)?;
        let mut connectivity = Vec::with_capacity(self.elements.len() * self.kind.nodes());
        let order = self.kind.reference().gmsh_order;
        for element in &self.elements {
            connectivity.extend(order.iter().filter_map(|&place| numbers[element.nodes[place]]));
        }
        if self.kind.dimension() < 3 {
            turn_if_clockwise(self.kind, &nodes, &mut connectivity);
        }
        self.check(file, &nodes, &connectivity)?;
        Ok((Mesh::new(nodes, self.kind, connectivity, Vec::new())?.with_groups(self.groups.clone()), numbers))
    }

    /// Checks that the nodes lie in a plane z = const, or on a line along x, and puts them at 0 there.
    fn flatten(&self, file: &GmshFile, used: &[bool], nodes: &mut [[f64; 3]]) -> Result<(), Error> {
        let dimension = self.kind.dimension();
        let Some(&first) = nodes.first() else { return Ok(()) };
        let away = |at: &[f64; 3], axis: usize| (at[axis] - first[axis]).abs();
        let size = nodes.iter().flat_map(|at| [0, 1, 2].map(|axis| away(at, axis))).fold(0.0, f64::max);
        let places = (0..used.len()).filter(|&place| used[place]);
        for (at, place) in nodes.iter_mut().zip(places) {
            for axis in dimension..3 {
                if away(at, axis) > FLAT * size {
                    let (tag, found, name) = (file.node_tags[place], file.nodes[place][axis], ["x", "y", "z"][axis]);
                    let others = used.iter().position(|used| *used).map_or(0.0, |first| file.nodes[first][axis]);
                    let space = if dimension == 1 { "a bar lies along x" } else { "a plane body lies in z = const" };
                    let message = format!("node {tag} has {name} = {found}, but the first node has {others}; {space}");
                    return Err(file.fault(file.node_lines[place], message));
                }
                at[axis] = 0.0;
            }
        }
        Ok(())
    }

    /// Checks that no element of the body in the file is inverted or without volume.
    fn check(&self, file: &GmshFile, nodes: &[[f64; 3]], connectivity: &[usize]) -> Result<(), Error> {
        let table = Tabulated::new(self.kind.reference(), Rule::Straight);
        for (element, places) in self.elements.iter().zip(connectivity.chunks_exact(self.kind.nodes())) {
            let mut coordinates = [[0.0; 3]; MAX_NODES];
            for (at, &place) in coordinates.iter_mut().zip(places) {
                *at = nodes[place];
            }
            if let Err(reason) = Cell::new(self.kind.reference(), &coordinates).check(&table) {
                return Err(file.fault(element.line, format!("element {}: {reason}", element.tag)));
            }
        }
        Ok(())
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
