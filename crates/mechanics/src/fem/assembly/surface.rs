//! Integrals over boundaries: the areas and normals of nodes.

use std::borrow::Cow;

use crate::fem::body::ElasticBody;
use crate::fem::element::{Cell, PerNode, QuadraturePoint, Tabulated};
use crate::fem::geometry::{length, unit};
use crate::fem::mesh::{Boundary, FacetKind, Mesh};

/// A quadrature point of a facet.
pub(crate) struct FacetPoint<'a> {
    pub nodes: &'a [usize],
    /// Values of its shape functions, node by node.
    pub shape: PerNode<f64>,
    /// Coordinates.
    pub at: [f64; 3],
    /// Outward unit normal; of either sense if the boundary is not a face of the mesh.
    pub normal: [f64; 3],
    /// Share of the length of a line, or of the area of a face, that the point stands for.
    pub extent: f64,
    /// The same as an area; thickness, cross-section or circumference included.
    pub area: f64,
    /// The facet in place.
    pub cell: &'a Cell,
    /// Derivatives of its shape functions, node by node.
    pub derivative: &'a PerNode<[f64; 3]>,
}

/// Calls `visit` for every quadrature point of a boundary, facet by facet.
pub(super) fn for_each_point(body: &ElasticBody, boundary: &Boundary, visit: &mut dyn FnMut(&FacetPoint)) {
    let table = Tabulated::new(boundary.kind.reference(), body.rule());
    for_each_point_of(body, boundary, &|_| Cow::Borrowed(&table), visit);
}

/// The same with the quadrature points that `table_of` gives for the nodes of a facet.
pub(super) fn for_each_point_of<'a>(
    body: &ElasticBody,
    boundary: &Boundary,
    table_of: &dyn Fn(&[usize]) -> Cow<'a, Tabulated>,
    visit: &mut dyn FnMut(&FacetPoint),
) {
    let mesh = body.mesh();
    let reference = boundary.kind.reference();
    let owners = mesh.faces_of(boundary);
    for (facet, owner) in boundary.facets().zip(owners) {
        if facet.iter().any(|&node| node >= mesh.nodes().len()) {
            continue;
        }
        let cell = Cell::new(reference, &body.coordinates(facet));
        let sense = owner.map_or(1.0, |owner| sense(mesh, facet, owner));
        for at in &table_of(facet).points {
            let vector = cell.area_vector(&at.derivative);
            let size = length(vector);
            let place = cell.place(&at.shape);
            let extent = size * at.weight * cell.unit().powi(reference.dimension as i32);
            visit(&FacetPoint {
                nodes: facet,
                shape: at.shape,
                at: place,
                normal: vector.map(|component| sense * component / size),
                extent,
                area: extent * body.formulation().measure(place[0]),
                cell: &cell,
                derivative: &at.derivative,
            });
        }
    }
}

/// The boundary with the nodes of each facet in an order from which its area vector points outwards.
pub(crate) fn outward(body: &ElasticBody, boundary: &Boundary) -> Boundary {
    let (mesh, mirrored) = (body.mesh(), boundary.kind.reference().mirrored());
    let oriented = |(facet, owner): (&[usize], Option<(usize, usize)>)| -> Vec<usize> {
        let sense = owner.map_or(1.0, |owner| sense(mesh, facet, owner));
        match sense > 0.0 {
            true => facet.to_vec(),
            false => mirrored.iter().map(|&local| facet[local]).collect(),
        }
    };
    let connectivity = boundary.facets().zip(mesh.faces_of(boundary)).flat_map(oriented).collect();
    Boundary { connectivity, ..boundary.clone() }
}

/// 1 if the nodes of a facet run as those of the face of the element, whose area vector points outwards, else -1.
fn sense(mesh: &Mesh, facet: &[usize], (element, number): (usize, usize)) -> f64 {
    let (kind, nodes) = (mesh.kind_of(element), mesh.element(element));
    let face: Vec<usize> = kind.reference().faces[number].iter().map(|&local| nodes[local]).collect();
    let alike = match kind.facet() {
        // The end of a bar has no order: the normal of its first face is -x.
        FacetKind::Point1 => number > 0,
        FacetKind::Line2 | FacetKind::Line3 => facet.first() == face.first(),
        FacetKind::T3 | FacetKind::Q4 | FacetKind::T6 | FacetKind::Q8 => {
            let corners = kind.facet().reference().corners;
            let place = face[..corners].iter().position(|node| Some(node) == facet.first()).unwrap_or(0);
            facet.get(1) == face.get((place + 1) % corners)
        }
    };
    if alike { 1.0 } else { -1.0 }
}

/// The nodes of a boundary in its order, each as `(node, area)` with its tributary area: the integral of its shape
/// function over the boundary, in area, thickness, cross-section or circumference included. The areas add up to the
/// area of the boundary.
pub fn tributary_areas(body: &ElasticBody, boundary: &Boundary) -> Vec<(usize, f64)> {
    let nodes = boundary.nodes();
    let mut area = vec![0.0; body.mesh().nodes().len()];
    for_each_point(body, boundary, &mut |point| {
        for (&node, share) in point.nodes.iter().zip(point.shape) {
            area[node] += share * point.area;
        }
    });
    nodes.into_iter().map(|node| (node, area.get(node).copied().unwrap_or(0.0))).collect()
}

/// Each facet of a boundary in its order as `(extent, area)`: its length or area, and its area with thickness,
/// cross-section or circumference. The areas add up to those of [`tributary_areas`].
pub(crate) fn facet_sizes(body: &ElasticBody, boundary: &Boundary) -> Vec<(f64, f64)> {
    let mut of_points = Vec::new();
    for_each_point(body, boundary, &mut |point| of_points.push((point.extent, point.area)));
    let points = Tabulated::new(boundary.kind.reference(), body.rule()).points.len();
    let sum = |of_facet: &[(f64, f64)]| of_facet.iter().fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
    of_points.chunks(points.max(1)).map(sum).collect()
}

/// The nodes of a boundary in its order, each with its outward unit normal: the mean over the facets around the node.
/// Zero if these cancel.
pub fn node_normals(body: &ElasticBody, boundary: &Boundary) -> Vec<(usize, [f64; 3])> {
    let sums = normal_sums(body, boundary);
    boundary.nodes().into_iter().map(|node| (node, unit(sums.get(node).copied().unwrap_or_default()))).collect()
}

/// For each node of the mesh the integral of the square of its shape function times the outward normal of a boundary,
/// in area.
pub(crate) fn normal_sums(body: &ElasticBody, boundary: &Boundary) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; body.mesh().nodes().len()];
    for_each_point(body, boundary, &mut |point| {
        for (&node, share) in point.nodes.iter().zip(point.shape) {
            // The square, because the shape functions of the ends of a quadratic edge change sign.
            let weight = share * share * point.area;
            sums[node].iter_mut().zip(point.normal).for_each(|(sum, component)| *sum += weight * component);
        }
    });
    sums
}

/// The centre of each facet of a boundary, with the outward unit normal there.
pub(crate) fn facet_centres(body: &ElasticBody, boundary: &Boundary) -> Vec<([f64; 3], [f64; 3])> {
    let reference = boundary.kind.reference();
    let table = Tabulated::with_rule(reference, vec![QuadraturePoint { at: reference.centroid(), weight: 1.0 }]);
    let mut centres = Vec::with_capacity(boundary.facet_count());
    for_each_point_of(body, boundary, &|_| Cow::Borrowed(&table), &mut |point| centres.push((point.at, point.normal)));
    centres
}
