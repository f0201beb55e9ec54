//! Strain and stress at given points of elements, strain at the nodes, volume and energy of elements.

use super::{add, carried_to_nodes};
use crate::error::Error;
use crate::fem::body::{ElasticBody, Phase};
use crate::fem::element::TabulatedPoint;
use crate::fem::formulation::Formulation;
use crate::fem::geometry::Symmetric;
use crate::fem::material::Law;
use crate::fem::threads::each;
use signorini_linear as linear;

/// The strain at each node, of all elements around it: recovered as the stress of [`super::StressField`].
pub(crate) fn nodal_strain(body: &ElasticBody, displacement: &[f64]) -> Result<Vec<Symmetric>, Error> {
    body.check_nodal("nodal displacement", displacement.len())?;
    let (tables, extrapolations) = (body.tabulated(), body.extrapolations());
    let mut sums: Vec<(Symmetric, usize)> = vec![([0.0; 6], 0); body.mesh().nodes().len()];
    for element in body.elements() {
        let strained = body.strained(&tables, displacement, &element);
        let strain = |at: &TabulatedPoint| strained.strain_and_stress(at)[0];
        let of_nodes = carried_to_nodes(tables.at(element.kind), extrapolations.at(element.kind), strain);
        element.nodes.iter().zip(&of_nodes).for_each(|(&node, strain)| add(&mut sums[node], strain));
    }
    Ok(sums.into_iter().map(|(sum, count)| sum.map(|component| component / count as f64)).collect())
}

/// Strain and stress in some elements at the points of CalculiX, layer by layer.
pub(crate) fn at_points(
    body: &ElasticBody,
    displacement: &[f64],
    elements: &[usize],
) -> Result<Vec<Vec<[Symmetric; 2]>>, Error> {
    body.check_nodal("nodal displacement", displacement.len())?;
    let tables = body.tabulated();
    let points = body.per_kind(|reference| -> Vec<TabulatedPoint> {
        reference.calculix.points.iter().map(|point| TabulatedPoint::new(reference, point.at, point.weight)).collect()
    });
    let values = |&index: &usize| {
        let allowed = "smaller than the number of elements (indices from 0)";
        let missing = linear::Error::Setting { name: "element", value: index as f64, allowed };
        let element = body.element(index).ok_or(missing)?;
        let strained = body.strained(&tables, displacement, &element);
        let layer: Vec<[Symmetric; 2]> =
            points.at(element.kind).iter().map(|at| strained.strain_and_stress(at)).collect();
        Ok(layer.repeat(element.kind.reference().calculix.layers))
    };
    elements.iter().map(values).collect()
}

/// The volume of each element, and its energy `1/2 sigma : C^-1 : sigma` with the law in space: in the plane, stress
/// and strain across it do work as well.
pub(crate) fn volume_and_energy(body: &ElasticBody, displacement: &[f64]) -> Result<Vec<[f64; 2]>, Error> {
    body.check_nodal("nodal displacement", displacement.len())?;
    let tables = body.tabulated();
    // An incompressible material has a law in plane stress only, and no stress works across its plane.
    let in_space = |phase: &Phase| phase.material().law(&Formulation::Space).unwrap_or_else(|_| phase.law.clone());
    let laws: Vec<Law> = body.phases().iter().map(in_space).collect();
    let of_element = |index: usize| {
        let Some(element) = body.element(index) else { return [0.0; 2] };
        let strained = body.strained(&tables, displacement, &element);
        let (mut volume, mut energy) = (0.0, 0.0);
        for at in &tables.at(element.kind).points {
            let (weight, stress) = strained.at(at);
            volume += weight;
            let law = &laws[element.phase_number as usize];
            energy += weight * law.complementary_energy(&stress, || element.cell.place(&at.shape)) / 2.0;
        }
        let scale = element.cell.unit().powi(body.dimension() as i32);
        [scale * volume, scale * energy]
    };
    Ok(each(body.mesh().element_count(), of_element))
}
