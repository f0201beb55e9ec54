//! Bodies from mesh files: what files of Gmsh and decks have alike.

use super::faces::chained;
use super::{Boundary, ElementGroup, Mesh};
use crate::element::{Cell, ElementKind, NonPositiveJacobian, QuadratureRule, Tabulated};
use crate::error::Error;

/// The number in the mesh of each node of the file, if it is in the body.
pub(super) type Numbers = Vec<Option<usize>>;

/// The elements of a body in its file.
pub(super) struct FileBody<'a> {
    pub kind: ElementKind,
    /// The places of all nodes of the file.
    pub places: &'a [[f64; 3]],
    /// The nodes of its elements, in the order of the reference cell, numbered as in the file from 0.
    pub connectivity: Vec<usize>,
    pub groups: Vec<ElementGroup>,
    /// `true` if elements that run clockwise are turned, if all do.
    pub turns: bool,
}

/// Why the elements of a file are no body.
pub(super) enum Misfit {
    /// The first node of the body and the one that lies elsewhere along an axis that the body does not have.
    OffPlane([usize; 2], usize),
    /// The first element that is inverted or without volume.
    Element(usize, NonPositiveJacobian),
}

impl FileBody<'_> {
    /// The mesh without boundaries, with coordinates multiplied by `scale`. Nodes of other elements are left out; the
    /// others keep the order of the file.
    pub fn into_mesh(self, scale: f64, fault: impl Fn(Misfit) -> Error) -> Result<(Mesh, Numbers), Error> {
        let FileBody { kind, places, mut connectivity, groups, turns } = self;
        let (mut numbers, mut nodes): (Numbers, Vec<[f64; 3]>) = (vec![None; places.len()], Vec::new());
        connectivity.iter().for_each(|&node| numbers[node] = Some(0));
        for (number, at) in numbers.iter_mut().zip(places).filter(|(number, _)| number.is_some()) {
            *number = Some(nodes.len());
            nodes.push(at.map(|value| value * scale));
        }
        flatten(kind.dimension(), &mut nodes).map_err(|(node, axis)| {
            let place_of = |node: usize| numbers.iter().position(|number| *number == Some(node)).unwrap_or(0);
            fault(Misfit::OffPlane([0, node].map(place_of), axis))
        })?;
        connectivity.iter_mut().for_each(|node| *node = numbers[*node].unwrap_or_default());
        if turns && kind.dimension() < 3 {
            turn_if_clockwise(kind, &nodes, &mut connectivity);
        }
        if let Some((element, reason)) = unfit(kind, &nodes, &connectivity) {
            return Err(fault(Misfit::Element(element, reason)));
        }
        Ok((Mesh::new(nodes, kind, connectivity, Vec::new())?.with_groups(groups), numbers))
    }
}

/// The boundary of these facets; `None` without one.
pub(super) fn boundary(mesh: &Mesh, name: &str, connectivity: Vec<usize>) -> Option<Boundary> {
    let kind = mesh.kind_of(0).facet();
    (!connectivity.is_empty()).then(|| Boundary::new(name, kind, chained(kind, connectivity)))
}

/// A node of a mesh file is outside the plane if it is farther from it than this times the size of the body: far above
/// the rounding of a mesh generator and far below the size of any cell.
const FLAT: f64 = 1e-9;

/// Puts nodes that lie in a plane z = const, or on a line along x, at 0 there; the first that does not, and the axis.
fn flatten(dimension: usize, nodes: &mut [[f64; 3]]) -> Result<(), (usize, usize)> {
    let Some(&first) = nodes.first() else { return Ok(()) };
    let away = |at: &[f64; 3], axis: usize| (at[axis] - first[axis]).abs();
    let size = nodes.iter().flat_map(|at| [0, 1, 2].map(|axis| away(at, axis))).fold(0.0, f64::max);
    for (node, at) in nodes.iter_mut().enumerate() {
        for axis in dimension..3 {
            if away(at, axis) > FLAT * size {
                return Err((node, axis));
            }
            at[axis] = 0.0;
        }
    }
    Ok(())
}

/// The first element that is inverted or without volume, and why.
fn unfit(kind: ElementKind, nodes: &[[f64; 3]], connectivity: &[usize]) -> Option<(usize, NonPositiveJacobian)> {
    let table = Tabulated::new(kind.reference(), QuadratureRule::Straight);
    connectivity.chunks_exact(kind.nodes()).enumerate().find_map(|(element, own)| {
        let cell = Cell::at(kind.reference(), |local| nodes[own[local]]);
        Some((element, cell.check(&table).err()?))
    })
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
