//! The estimated discretisation error: the stress of the elements against the recovered stress.

use super::StressField;
use super::patches::Patches;
use crate::error::Error;
use crate::fem::body::ElasticBody;
use crate::fem::element::{MAX_NODES, PerNode, Rule, Tabulated, TabulatedPoint};
use crate::fem::geometry::Symmetric;
use crate::fem::threads::each;
use signorini_linear as linear;

/// Estimates the relative error in energy norm of the nodal displacement `displacement` (length `dim * n_nodes`), whose
/// stress is `field`, against the solution of the continuum:
/// `||sigma* - sigma_h|| / sqrt(||sigma_h||^2 + ||sigma* - sigma_h||^2)` in the norm of the complementary energy, where
/// sigma* interpolates the averaged nodal stresses by the shape functions, and in quadratic tetrahedra fits the
/// stresses around each corner by a quadratic function; where materials meet, each has its own. Zero if there is no
/// stress.
///
/// # Source
/// O. C. Zienkiewicz, J. Z. Zhu, 1987, "A simple error estimator and adaptive procedure for practical engineering
/// analysis"; for quadratic tetrahedra their "The superconvergent patch recovery and a posteriori error estimates",
/// 1992.
///
/// # Errors
/// [`linear::Error::Length`] if displacement or field do not belong to the body.
pub fn discretisation_error(body: &ElasticBody, displacement: &[f64], field: &StressField) -> Result<f64, Error> {
    Ok(EstimatedError::of(body, displacement, field)?.relative())
}

/// The estimate as squares of its norms: twice an energy.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct EstimatedError {
    /// `||sigma* - sigma_h||^2` on each element.
    pub of_elements: Vec<f64>,
    /// `||sigma_h||^2`.
    pub whole: f64,
    /// The same of the stress without strain: in a free body it is cancelled except for rounding.
    unstrained: f64,
}

/// Stresses below this times the stress without strain are rounding.
const ROUNDING: f64 = 1e-12;

impl EstimatedError {
    /// As [`discretisation_error`].
    pub fn of(body: &ElasticBody, displacement: &[f64], field: &StressField) -> Result<Self, Error> {
        body.check_nodal("nodal displacement", displacement.len())?;
        linear::Error::check_length("nodal stress", field.nodes.len(), body.mesh().nodes().len(), "nodes")?;
        // The rule for bodies of revolution also integrates the squares of linear differences.
        let tables = body.per_kind(|reference| Tabulated::new(reference, Rule::Revolved));
        let standard = body.tabulated();
        let patches = Patches::of(body, displacement);

        let of_element = |index: usize| {
            let [mut difference, mut whole, mut unstrained] = [0.0; 3];
            let Some(element) = body.element(index) else { return [difference, whole, unstrained] };
            let (nodes, cell, law) = (element.nodes, &element.cell, &element.phase.law);
            let strained = body.strained(&standard, displacement, &element);
            let mut of_nodes: PerNode<Symmetric> = [[0.0; 6]; MAX_NODES];
            for (stress, &node) in of_nodes.iter_mut().zip(nodes) {
                *stress = field.within(node, element.phase_number).components();
            }
            let recovered = |at: &TabulatedPoint| match Patches::are_for(element.kind) {
                true => patches.stress(&element, at),
                false => interpolated(&at.shape, &of_nodes[..nodes.len()]),
            };
            let volume = cell.unit().powi(body.dimension() as i32);
            for at in &tables.at(element.kind).points {
                let (weight, stress) = strained.at(at);
                let weight = volume * weight;
                let place = || cell.place(&at.shape);
                let recovered = recovered(at);
                let away = [0, 1, 2, 3, 4, 5].map(|component| stress[component] - recovered[component]);
                difference += weight * law.complementary_energy(&away, place);
                whole += weight * law.complementary_energy(&stress, place);
                if let Some(own) = element.own_stress(at) {
                    unstrained += weight * law.complementary_energy(&own, place);
                }
            }
            [difference, whole, unstrained]
        };
        let squares = each(body.mesh().element_count(), of_element);
        let sum = |which: usize| squares.iter().map(|of_element| of_element[which]).sum();
        let (whole, unstrained) = (sum(1), sum(2));
        let of_elements = squares.into_iter().map(|[difference, ..]| difference).collect();
        Ok(EstimatedError { of_elements, whole, unstrained })
    }

    /// The strain energy of the displaced body, `1/2 ||sigma_h||^2`, in force times length.
    pub fn strain_energy(&self) -> f64 {
        self.whole / 2.0
    }

    /// The error over the norm of the exact stress, both estimated.
    pub fn relative(&self) -> f64 {
        let difference: f64 = self.of_elements.iter().sum();
        let total = self.whole + difference;
        if total > ROUNDING * ROUNDING * self.unstrained { (difference / total).sqrt() } else { 0.0 }
    }
}

/// The value of the shape functions with these nodal values.
fn interpolated(shape: &PerNode<f64>, of_nodes: &[Symmetric]) -> Symmetric {
    let mut value = [0.0; 6];
    for (share, of_node) in shape.iter().zip(of_nodes) {
        value.iter_mut().zip(of_node).for_each(|(sum, component)| *sum += share * component);
    }
    value
}
