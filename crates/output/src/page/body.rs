//! The drawn shape of a body: its cells in the plane, its surface in space, a strip for a bar.

use serde::Serialize;

use super::packed::{Packed, Packer};
use crate::view::limits::singular;
use signorini_mechanics::fem::{Boundary, ElementKind, FacetKind};
use signorini_mechanics::scene::Model;

/// Half of the height of the strip that stands for a bar, over its length.
const HALF_STRIP: f64 = 0.04;

/// The inside of a mesh with more nodes than this is left out of a page.
const MOST_INSIDE: usize = 60_000;

/// Six tetrahedra around a diagonal fill a brick.
const BRICK: [[usize; 4]; 6] = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]];

/// The cells that are drawn, and the nodes at their vertices.
pub(super) struct Shape {
    pub nodes: Vec<usize>,
    pub places: Vec<[f64; 3]>,
    cells: Vec<Cells>,
    /// A vertex of each node; none inside a body in space.
    pub vertex_of: Vec<Option<usize>>,
    /// The vertices of tetrahedra that fill the body, for sections; empty if they are not known.
    solids: Vec<usize>,
}

struct Cells {
    /// The vertices of each cell, corners first.
    vertices: Vec<usize>,
    corners: usize,
    /// The corners between which the other vertices of a cell lie.
    mids: Vec<[usize; 2]>,
}

/// The same as they stand in a page.
#[derive(Debug, Serialize)]
struct PackedCells {
    vertices: Packed,
    corners: usize,
    mids: Vec<[usize; 2]>,
}

/// The body as it stands in a page: its mesh in packed arrays.
#[derive(Debug, Serialize)]
pub(super) struct Body {
    /// Coordinates of the model: 1, 2 or 3.
    dimension: usize,
    /// `true` if x is a radius.
    axisymmetric: bool,
    nodes: Packed,
    places: Packed,
    cells: Vec<PackedCells>,
    /// Number of vertices on the surface; those inside follow.
    surface: usize,
    solids: Packed,
    /// The names of the bodies, and the body of each vertex.
    regions: Vec<String>,
    region_of: Packed,
    /// 1 for each vertex whose stress does not set the range of colours.
    singular: Packed,
}

impl Shape {
    pub fn of(model: &Model) -> Self {
        let mesh = model.mesh();
        match mesh.dimension() {
            1 => strip(model),
            2 => {
                let nodes: Vec<usize> = (0..mesh.nodes().len()).collect();
                let of_kind = |kind: ElementKind| {
                    let elements = mesh.elements().enumerate().filter(|entry| mesh.kind_of(entry.0) == kind);
                    let vertices = elements.flat_map(|entry| entry.1).copied().collect();
                    Cells { vertices, corners: kind.corners(), mids: kind.reference().mid_sides.to_vec() }
                };
                let cells = mesh.kinds().map(of_kind).collect();
                let vertex_of = nodes.iter().copied().map(Some).collect();
                Shape { places: mesh.nodes().to_vec(), nodes, cells, vertex_of, solids: Vec::new() }
            }
            _ => surface(model),
        }
    }

    /// The same with the inside of a body in space, if its mesh is not too large, so that a page can show sections.
    pub fn with_inside(model: &Model) -> Self {
        let (mesh, mut shape) = (model.mesh(), Shape::of(model));
        if mesh.dimension() != 3 || mesh.nodes().len() > MOST_INSIDE {
            return shape;
        }
        let mut vertices = shape.vertex_of.clone();
        for (node, vertex) in vertices.iter_mut().enumerate().filter(|(_, vertex)| vertex.is_none()) {
            *vertex = Some(shape.nodes.len());
            shape.nodes.push(node);
            shape.places.push(mesh.nodes()[node]);
        }
        for (element, nodes) in mesh.elements().enumerate() {
            let corners: &[[usize; 4]] = if mesh.kind_of(element).corners() == 8 { &BRICK } else { &[[0, 1, 2, 3]] };
            shape.solids.extend(corners.iter().flatten().filter_map(|&corner| vertices[nodes[corner]]));
        }
        shape
    }

    /// Values of the vertices from nodal ones with `stride` components a node.
    pub fn at_vertices(&self, nodal: &[f64], stride: usize) -> Vec<f64> {
        let of_node = |&node: &usize| nodal[stride * node..stride * (node + 1)].iter().copied();
        self.nodes.iter().flat_map(of_node).collect()
    }

    pub fn packed(&self, model: &Model, packer: &mut Packer) -> Body {
        let dimension = model.mesh().dimension();
        let shown = dimension.max(2);
        let (regions, singular) = (model.body().regions(), singular(model));
        let region_of = |node: &usize| model.body().region_at(*node).unwrap_or(0) as u8;
        let places: Vec<f64> = self.places.iter().flat_map(|at| at[..shown].iter().copied()).collect();
        Body {
            dimension,
            axisymmetric: model.body().formulation().is_axisymmetric(),
            nodes: packer.whole(&self.nodes, 1),
            places: packer.quantised(&places, shown),
            cells: self.cells.iter().map(|cells| cells.packed(packer)).collect(),
            surface: self.vertex_of.iter().flatten().max().map_or(0, |last| last + 1),
            solids: packer.whole(&self.solids, 4),
            regions: regions.iter().map(|region| region.name().to_string()).collect(),
            singular: packer.bytes(self.nodes.iter().map(|&node| u8::from(singular[node]))),
            region_of: packer.bytes(self.nodes.iter().map(region_of)),
        }
    }
}

impl Cells {
    fn packed(&self, packer: &mut Packer) -> PackedCells {
        let vertices = packer.whole(&self.vertices, self.corners + self.mids.len());
        PackedCells { vertices, corners: self.corners, mids: self.mids.clone() }
    }
}

/// A bar as a strip along x: two vertices for each node, the lower one first.
fn strip(model: &Model) -> Shape {
    let mesh = model.mesh();
    let half = HALF_STRIP * mesh.size();
    let nodes: Vec<usize> = (0..mesh.nodes().len()).flat_map(|node| [node, node]).collect();
    let places = mesh.nodes().iter().flat_map(|at| [[at[0], -half, 0.0], [at[0], half, 0.0]]).collect();
    let vertices =
        mesh.elements().flat_map(|ends| [2 * ends[0], 2 * ends[1], 2 * ends[1] + 1, 2 * ends[0] + 1]).collect();
    let cells = vec![Cells { vertices, corners: 4, mids: Vec::new() }];
    let vertex_of = (0..mesh.nodes().len()).map(|node| Some(2 * node)).collect();
    Shape { nodes, places, cells, vertex_of, solids: Vec::new() }
}

/// The surface of bodies in space.
fn surface(model: &Model) -> Shape {
    let mesh = model.mesh();
    let surfaces: Vec<Boundary> = model.body().regions().iter().map(|region| mesh.surface(region.elements())).collect();
    let mut vertex_of = vec![None; mesh.nodes().len()];
    surfaces.iter().flat_map(|surface| &surface.connectivity).for_each(|&node| vertex_of[node] = Some(0));
    let nodes: Vec<usize> = (0..vertex_of.len()).filter(|&node| vertex_of[node].is_some()).collect();
    nodes.iter().enumerate().for_each(|(vertex, &node)| vertex_of[node] = Some(vertex));
    let of_kind = |kind: FacetKind| {
        let alike = surfaces.iter().filter(|surface| surface.kind == kind);
        let vertices = alike.flat_map(|surface| &surface.connectivity).filter_map(|&node| vertex_of[node]).collect();
        Cells { vertices, corners: kind.reference().corners, mids: kind.reference().mid_sides.to_vec() }
    };
    let mut kinds: Vec<FacetKind> = mesh.kinds().map(ElementKind::facet).collect();
    kinds.dedup();
    Shape {
        places: nodes.iter().map(|&node| mesh.nodes()[node]).collect(),
        cells: kinds.into_iter().map(of_kind).collect(),
        nodes,
        vertex_of,
        solids: Vec::new(),
    }
}
