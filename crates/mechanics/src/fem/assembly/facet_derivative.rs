//! Derivatives of integrals over boundaries with respect to the places of all nodes.

use super::load::{Kinks, for_each_fine_point};
use super::shape_derivative::add;
use super::surface::{FacetPoint, for_each_point};
use crate::fem::body::ElasticBody;
use crate::fem::geometry::dot;
use crate::fem::mesh::Boundary;

/// A density over a boundary at one of its points, per area, and its change at the same reference coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Density {
    pub value: f64,
    /// With the place of the point, per length.
    pub by_place: [f64; 3],
    /// With the outward unit normal there; the part along the normal does not count.
    pub by_normal: [f64; 3],
}

/// The points at which a boundary is integrated.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Points<'a> {
    /// Those of constant tractions, of areas and of foundations.
    Own,
    /// Those of fields: five in each direction of every piece of a facet between kinks.
    Fine(Kinks<'a>),
}

impl Points<'_> {
    fn visit(self, body: &ElasticBody, boundary: &Boundary, visit: &mut dyn FnMut(&FacetPoint)) {
        match self {
            Points::Own => for_each_point(body, boundary, visit),
            Points::Fine(kinks) => for_each_fine_point(body, boundary, kinks, visit),
        }
    }
}

/// The area of a boundary, and the integral of `value` over it.
pub(crate) fn area_and_integral(
    body: &ElasticBody,
    boundary: &Boundary,
    points: Points,
    value: impl Fn(&FacetPoint) -> f64,
) -> [f64; 2] {
    let mut sums = [0.0; 2];
    points.visit(body, boundary, &mut |point| {
        sums[0] += point.area;
        sums[1] += point.area * value(point);
    });
    sums
}

/// Adds to `gradient` (length `dim * n_nodes`, order `[x_0, y_0, x_1, ...]`) the change of the integral of a density
/// over a boundary with each coordinate of the nodes, in length.
///
/// It is the derivative of the sum over the points. A density with kinks must be continuous there: a facet is then cut
/// at other reference coordinates when its nodes move, which changes the integral by nothing as long as the pieces are
/// integrated exactly, as those of straight edges, plane triangles and parallelograms are; on other facets it changes
/// it by less than the error of the integral.
pub(crate) fn integral_by_places(
    body: &ElasticBody,
    boundary: &Boundary,
    points: Points,
    density: impl Fn(&FacetPoint) -> Density,
    gradient: &mut [f64],
) {
    let by_radius = body.formulation().measure_by_x();
    points.visit(body, boundary, &mut |point| {
        let Density { value, by_place, by_normal } = density(point);
        let (cell, normal) = (point.cell, point.normal);
        let vector = cell.area_vector(point.derivative);
        // The area vector may point inwards.
        let size = dot(vector, normal);
        let (turning, factor) = (value - dot(by_normal, normal), point.area / (size * cell.unit()));
        let along = [0, 1, 2].map(|axis| factor * (by_normal[axis] + turning * normal[axis]));
        let mut of_nodes = cell.area_vector_by_places(point.derivative, along);
        for (of_node, share) in of_nodes.iter_mut().zip(point.shape) {
            of_node.iter_mut().zip(by_place).for_each(|(sum, slope)| *sum += share * point.area * slope);
            of_node[0] += share * point.extent * value * by_radius;
        }
        add(body, point.nodes, &of_nodes, gradient);
    });
}
