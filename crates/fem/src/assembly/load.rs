//! Consistent nodal loads: f_a = integral of N_a times the force; the areas and normals of nodes.

use std::borrow::Cow;

use super::{DofMap, internal_force};
use crate::body::{BodyElement, ElasticBody};
use crate::element::{Cell, PerKind, PerNode, QuadraturePoint, Tabulated, between_levels};
use crate::error::Error;
use crate::geometry::{cross, dot, inertia, length, minus, principal, shifted, unit};
use crate::mesh::{Boundary, Mesh};

/// A moment of inertia of a boundary below this times the largest is rounding: the boundary is a straight line about
/// that axis.
const NO_INERTIA: f64 = 1e-12;

/// Adds to the nodal load (length `dim * n_nodes`) a constant traction (x, y, z; force per area) on a boundary.
pub fn add_traction(body: &ElasticBody, boundary: &Boundary, traction: [f64; 3], load: &mut [f64]) {
    for_each_point(body, boundary, &mut |point| add_share(body, point, traction, load));
}

/// Adds to the nodal load (length `dim * n_nodes`) a pressure (force per area) on a boundary: a positive pressure acts
/// against the outward normal.
pub fn add_pressure(body: &ElasticBody, boundary: &Boundary, pressure: f64, load: &mut [f64]) {
    let visit = &mut |point: &FacetPoint| {
        add_share(body, point, point.normal.map(|component| -pressure * component), load);
    };
    for_each_point(body, boundary, visit);
}

/// Adds to the nodal load (length `dim * n_nodes`) the traction `field(point, outward unit normal)` (force per area) on
/// a boundary, by five quadrature points in each direction of a facet.
pub fn add_traction_field(
    body: &ElasticBody,
    boundary: &Boundary,
    field: impl Fn([f64; 3], [f64; 3]) -> [f64; 3],
    load: &mut [f64],
) {
    add_traction_with_kinks(body, boundary, Kinks::NONE, field, load);
}

/// Planes normal to a unit vector, at these coordinates along it, increasing.
#[derive(Clone, Copy, Debug)]
pub struct Kinks<'a> {
    pub along: [f64; 3],
    pub at: &'a [f64],
}

impl Kinks<'_> {
    /// No kinks.
    pub const NONE: Kinks<'static> = Kinks { along: [0.0; 3], at: &[] };
}

/// The same for a field with kinks: facets are cut at the kinks, and every piece has five quadrature points in each
/// direction.
pub fn add_traction_with_kinks(
    body: &ElasticBody,
    boundary: &Boundary,
    kinks: Kinks,
    field: impl Fn([f64; 3], [f64; 3]) -> [f64; 3],
    load: &mut [f64],
) {
    let visit = &mut |point: &FacetPoint| add_share(body, point, field(point.at, point.normal), load);
    for_each_fine_point(body, boundary, kinks, visit);
}

/// Calls `visit` for five points in each direction of every facet, or of every piece of it between kinks.
pub(super) fn for_each_fine_point(
    body: &ElasticBody,
    boundary: &Boundary,
    kinks: Kinks,
    visit: &mut dyn FnMut(&FacetPoint),
) {
    let (reference, nodes) = (boundary.kind.reference(), body.mesh().nodes());
    let whole = Tabulated::fine(reference);
    let table_of = |facet: &[usize]| {
        let along: Vec<f64> = facet[..reference.corners].iter().map(|&node| dot(nodes[node], kinks.along)).collect();
        let [low, high] = [f64::min, f64::max].map(|of| along.iter().copied().reduce(of).unwrap_or_default());
        let (from, to) = (kinks.at.partition_point(|&at| at <= low), kinks.at.partition_point(|&at| at < high));
        match kinks.at.get(from..to) {
            Some(levels @ [_, ..]) => {
                Cow::Owned(Tabulated::with_rule(reference, between_levels(reference, &along, levels)))
            }
            _ => Cow::Borrowed(&whole),
        }
    };
    for_each_point_of(body, boundary, &table_of, visit);
}

/// Adds to the nodal load (length `dim * n_nodes`) the traction `omega x (x - c)` on a boundary, c its centre of area,
/// which has the given moment (force times length) and zero force. `None` for a moment that no such traction has.
pub fn add_moment(body: &ElasticBody, boundary: &Boundary, moment: [f64; 3], load: &mut [f64]) -> Option<()> {
    let (omega, centre) = turning_traction(body, boundary, moment)?;
    let table = Tabulated::fine(boundary.kind.reference());
    for_each_point_of(body, boundary, &|_| Cow::Borrowed(&table), &mut |point| {
        add_share(body, point, cross(omega, minus(point.at, centre)), load);
    });
    Some(())
}

/// The vector omega and the centre c of the traction `omega x (x - c)` on a boundary that has this moment (force times
/// length) and no force; `None` if there is no such traction.
pub fn turning_traction(body: &ElasticBody, boundary: &Boundary, moment: [f64; 3]) -> Option<([f64; 3], [f64; 3])> {
    let table = Tabulated::fine(boundary.kind.reference());
    let visit = |visit: &mut dyn FnMut(&FacetPoint)| {
        for_each_point_of(body, boundary, &|_| Cow::Borrowed(&table), visit);
    };
    // From the first node, so that a boundary far from the origin loses no digits.
    let first = body.mesh().nodes()[*boundary.connectivity.first()?];
    let (mut area, mut sum) = (0.0, [0.0; 3]);
    visit(&mut |point| {
        area += point.area;
        sum = shifted(sum, point.area, minus(point.at, first));
    });
    let centre = [0, 1, 2].map(|axis| first[axis] + sum[axis] / area);
    let mut of_area = [0.0; 6];
    visit(&mut |point| {
        let of_point = inertia(minus(point.at, centre));
        of_area.iter_mut().zip(of_point).for_each(|(sum, part)| *sum += point.area * part);
    });
    let principal = principal(&of_area)?;
    let mut omega = [0.0; 3];
    for (about, axis) in principal {
        let part = dot(axis, moment);
        if about > NO_INERTIA * principal[0].0 {
            omega.iter_mut().zip(axis).for_each(|(sum, component)| *sum += part / about * component);
        } else if part.abs() > NO_INERTIA * length(moment) {
            return None;
        }
    }
    Some((omega, centre))
}

/// Adds the force of a traction on the area of a quadrature point.
fn add_share(body: &ElasticBody, point: &FacetPoint, traction: [f64; 3], load: &mut [f64]) {
    for (&node, share) in point.nodes.iter().zip(point.shape) {
        add_at(body, node, traction, share * point.area, load);
    }
}

/// Adds to the nodal load (length `dim * n_nodes`) a constant body force (x, y, z; force per volume).
pub fn add_body_force(body: &ElasticBody, force: [f64; 3], load: &mut [f64]) {
    add_force_at(body, &body.tabulated(), |_, _| force, load);
}

/// Adds to the nodal load (length `dim * n_nodes`) the body force `field(point)` (force per volume), by five quadrature
/// points in each direction of an element.
pub fn add_body_force_field(body: &ElasticBody, field: impl Fn([f64; 3]) -> [f64; 3], load: &mut [f64]) {
    add_force_at(body, &body.finely_tabulated(), |_, at| field(at), load);
}

/// Adds to the nodal load (length `dim * n_nodes`) the densities of the materials times a constant acceleration (length
/// per time squared).
pub fn add_gravity(body: &ElasticBody, acceleration: [f64; 3], load: &mut [f64]) -> Result<(), Error> {
    let densities = body.densities()?;
    let force = |element: usize, _| acceleration.map(|component| densities[element] * component);
    add_force_at(body, &body.tabulated(), force, load);
    Ok(())
}

/// Adds to the nodal load (length `dim * n_nodes`) the force of a rotation by `omega` (radians per time) about the axis
/// through `point` along the unit vector `axis`: the density times omega squared times the vector from the axis to the
/// point.
pub fn add_centrifugal(
    body: &ElasticBody,
    omega: f64,
    (axis, point): ([f64; 3], [f64; 3]),
    load: &mut [f64],
) -> Result<(), Error> {
    let densities = body.densities()?;
    let force = |element: usize, at: [f64; 3]| {
        let away = minus(at, point);
        let along = dot(away, axis);
        [0, 1, 2].map(|k| densities[element] * omega * omega * (away[k] - along * axis[k]))
    };
    add_force_at(body, &body.finely_tabulated(), force, load);
    Ok(())
}

/// Adds the body force `field(element, point)`.
fn add_force_at(
    body: &ElasticBody,
    tables: &PerKind<Tabulated>,
    field: impl Fn(usize, [f64; 3]) -> [f64; 3],
    load: &mut [f64],
) {
    for (element, BodyElement { nodes, kind, cell, .. }) in body.elements().enumerate() {
        let scale = cell.unit().powi(body.dimension() as i32);
        for at in &tables.at(kind).points {
            let volume = body.point(&cell, at).weight * scale;
            let force = field(element, cell.place(&at.shape));
            for (&node, share) in nodes.iter().zip(at.shape) {
                add_at(body, node, force, share * volume, load);
            }
        }
    }
}

/// The load of the unknowns, one entry each, in force: the nodal load (`nodal`, length `dim * n_nodes`, in force) along
/// them, minus the internal forces of the prescribed displacements, temperatures and initial stresses.
pub fn free_load(body: &ElasticBody, dofs: &DofMap, nodal: &[f64]) -> Result<Vec<f64>, Error> {
    let mut load = nodal.to_vec();
    if body.has_own_stress() || dofs.is_moved() {
        let lifted = dofs.expand(&vec![0.0; dofs.count()])?;
        let forces = internal_force(body, &lifted)?;
        load.iter_mut().zip(forces).for_each(|(load, force)| *load -= force);
    }
    dofs.restrict(&load)
}

/// Adds `force` times `factor` at a node; axes beyond the dimension of the body are left out.
fn add_at(body: &ElasticBody, node: usize, force: [f64; 3], factor: f64, load: &mut [f64]) {
    let dimension = body.dimension();
    for (axis, component) in force.iter().enumerate().take(dimension) {
        if let Some(entry) = load.get_mut(dimension * node + axis) {
            *entry += component * factor;
        }
    }
}

/// A quadrature point of a facet.
pub struct FacetPoint<'a> {
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
        let cell = Cell::at(reference, |local| mesh.nodes()[facet[local]]);
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
pub fn outward(body: &ElasticBody, boundary: &Boundary) -> Boundary {
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
    let alike = match kind.facet().dimension() {
        // The end of a bar has no order: the normal of its first face is -x.
        0 => number > 0,
        1 => facet.first() == face.first(),
        _ => {
            let corners = kind.facet().corners();
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
pub fn facet_sizes(body: &ElasticBody, boundary: &Boundary) -> Vec<(f64, f64)> {
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
pub fn normal_sums(body: &ElasticBody, boundary: &Boundary) -> Vec<[f64; 3]> {
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
pub fn facet_centres(body: &ElasticBody, boundary: &Boundary) -> Vec<([f64; 3], [f64; 3])> {
    let reference = boundary.kind.reference();
    let table = Tabulated::with_rule(reference, vec![QuadraturePoint { at: reference.centroid(), weight: 1.0 }]);
    let mut centres = Vec::with_capacity(boundary.facet_count());
    for_each_point_of(body, boundary, &|_| Cow::Borrowed(&table), &mut |point| centres.push((point.at, point.normal)));
    centres
}
