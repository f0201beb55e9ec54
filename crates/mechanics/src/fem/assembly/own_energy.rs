//! The energy of the stress without strain: `1/2` of the integral of `sigma_0 : C^-1 : sigma_0`.

use super::shape_derivative::work;
use crate::fem::body::{BodyElement, ElasticBody};
use crate::fem::element::TabulatedPoint;
use crate::fem::geometry::trace;

/// The energy that a body held in its undeformed shape has by its temperatures and initial stresses, in force times
/// length.
pub(crate) fn own_energy(body: &ElasticBody) -> f64 {
    sum_over_points(body, |_, element, at| {
        element.own_strain(at).map_or(0.0, |[stress, strain]| work(&stress, &strain) / 2.0)
    })
}

/// The change of [`own_energy`] with a parameter; `derivative` is the body of the derivatives of stresses with respect
/// to it.
///
/// With the strain `e = C^-1 sigma_0` it is the integral of `e : d sigma_0 - e : dC : e / 2`.
pub(crate) fn own_energy_change(body: &ElasticBody, derivative: &ElasticBody) -> f64 {
    sum_over_points(body, |index, element, at| {
        let (Some([_, strain]), Some(change)) = (element.own_strain(at), derivative.element(index)) else { return 0.0 };
        let of_own = change.own_stress(at).map_or(0.0, |own| work(&own, &strain));
        let stiffer = change.phase.law.stress(&strain, trace(&strain), || element.cell.place(&at.shape));
        of_own - work(&stiffer, &strain) / 2.0
    })
}

/// The integral of a density over the body; zero without own stress.
fn sum_over_points(body: &ElasticBody, density: impl Fn(usize, &BodyElement, &TabulatedPoint) -> f64) -> f64 {
    if !body.has_own_stress() {
        return 0.0;
    }
    let tables = body.tabulated();
    let of_element = |(index, element): (usize, BodyElement)| {
        let points = tables.at(element.kind).points.iter();
        let sum: f64 = points.map(|at| body.point(&element.cell, at).weight * density(index, &element, at)).sum();
        sum * element.cell.unit().powi(body.dimension() as i32)
    };
    body.elements().enumerate().map(of_element).sum()
}
