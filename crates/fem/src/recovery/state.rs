//! What one pass over the elements of a displaced body gives: stresses, the forces that hold it, its largest strain;
//! strain and stress at points of elements.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::{Stress, StressField, add, carried_to_nodes, carry, finished};
use crate::assembly::{add_to_nodes, of_cell};
use crate::body::{ElasticBody, Phase};
use crate::element::TabulatedPoint;
use crate::error::Error;
use crate::formulation::Formulation;
use crate::geometry::{Symmetric, length};
use crate::material::Law;
use crate::threads::{each, in_order};
use signorini_linear as linear;

/// The stress in `body` (force per area, tension positive) at the nodal displacement `displacement` (length
/// `dim * n_nodes`, order `[u_x0, u_y0, u_x1, ...]`, in length).
///
/// Exact where the displacement is linear. In each element the nodes take the linear function (multilinear in
/// quadrilaterals and hexahedra) that fits the stresses at the quadrature points by least squares.
pub fn stress(body: &ElasticBody, displacement: &[f64]) -> Result<StressField, Error> {
    Ok(DisplacedState::of(body, displacement)?.stress)
}

#[derive(Clone, Debug)]
pub struct DisplacedState {
    pub stress: StressField,
    /// As [`internal_force`](crate::assembly::internal_force).
    pub force: Vec<f64>,
    /// `None` without elements.
    pub deformation: Option<Deformation>,
}

/// The largest deformation at the centres of elements.
#[derive(Clone, Copy, Debug)]
pub struct Deformation {
    /// The largest component of a strain, by magnitude, and its element.
    pub strain: (f64, usize),
    /// The largest rotation, in radians if it is small, and its element.
    pub rotation: (f64, usize),
    /// The strain or rotation beyond which no body has more than `SINGULAR` of its volume, or of its energy; zero if
    /// it is below `SMALL`.
    pub widespread: f64,
}

/// About a singular point, such as a clamped corner, strain and rotation grow with every refinement. If they are large
/// on no more than this share of the volume and of the energy, the answer hardly depends on it.
const SINGULAR: f64 = 1e-3;

/// No limit judges a strain or rotation below this: such elements are not told apart.
const SMALL: f64 = 0.05;

/// What the centre of an element tells.
#[derive(Clone, Copy)]
struct AtCentre {
    strain: f64,
    rotation: f64,
    volume: f64,
    /// By the stress, without a common factor.
    energy: f64,
}

impl Deformation {
    fn of(body: &ElasticBody, centres: &[AtCentre]) -> Option<Self> {
        let largest = |part: fn(&AtCentre) -> f64| {
            let parts = centres.iter().map(part).enumerate();
            parts.fold((0.0, 0), |largest, (index, value)| if value > largest.0 { (value, index) } else { largest })
        };
        let (strain, rotation) = (largest(|centre| centre.strain), largest(|centre| centre.rotation));
        let of_regions = body.regions().iter().map(|region| widespread(&centres[region.elements()]));
        let widespread = of_regions.fold(0.0, f64::max);
        (!centres.is_empty()).then_some(Deformation { strain, rotation, widespread })
    }
}

/// The strain or rotation that a body, given by its elements, exceeds on no more than [`SINGULAR`] of it.
fn widespread(centres: &[AtCentre]) -> f64 {
    let shares = |centre: &AtCentre| [centre.volume, centre.energy];
    let size = |centre: &AtCentre| centre.strain.max(centre.rotation);
    let mut large: Vec<&AtCentre> = centres.iter().filter(|centre| size(centre) > SMALL).collect();
    large.sort_unstable_by(|one, other| size(other).total_cmp(&size(one)));
    let mut left = [0, 1].map(|which| SINGULAR * centres.iter().map(|centre| shares(centre)[which]).sum::<f64>());
    let is_beyond = |centre: &&&AtCentre| {
        left.iter_mut().zip(shares(centre)).for_each(|(left, share)| *left -= share);
        left.iter().any(|&left| left < 0.0 || left.is_nan())
    };
    large.iter().find(is_beyond).map_or(0.0, |centre| size(centre))
}

impl std::fmt::Display for Deformation {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let [strain, rotation] = [self.strain.0, self.rotation.0].map(|part| 100.0 * part);
        let degrees = self.rotation.0.to_degrees();
        write!(
            f,
            "at the centres of elements the largest strain is {strain:.2} %, the largest rotation {rotation:.2} % ({degrees:.2} degrees)"
        )
    }
}

/// The same of some elements, and the shares of their nodes, one element after another.
#[derive(Default)]
struct Run {
    stresses: Vec<Stress>,
    of_nodes: Vec<Symmetric>,
    forces: Vec<[f64; 3]>,
    centres: Vec<AtCentre>,
}

impl DisplacedState {
    /// The state at the nodal displacement `displacement` (length `dim * n_nodes`, in length).
    pub fn of(body: &ElasticBody, displacement: &[f64]) -> Result<Self, Error> {
        body.check_nodal("nodal displacement", displacement.len())?;
        let (tables, extrapolations) = (body.tabulated(), body.extrapolations());
        let of_run = |run: Range<usize>| {
            let mut all = Run::default();
            for element in run.clone().filter_map(|index| body.element(index)) {
                let strained = body.strained(&tables, displacement, &element);
                let table = tables.at(element.kind);
                let mut weights = extrapolations.at(element.kind).columns();
                let first = all.forces.len();
                all.of_nodes.resize(first + element.nodes.len(), [0.0; 6]);
                all.forces.resize(first + element.nodes.len(), [0.0; 3]);
                let of_nodes = &mut all.of_nodes[first..];
                of_cell(&strained, table, &mut all.forces[first..], |stress| {
                    carry(stress, weights.next().unwrap_or_default(), of_nodes);
                });
                let centre = strained.displaced(&table.centroid);
                let strain = centre.strain().iter().fold(0.0, |largest: f64, component| largest.max(component.abs()));
                let stress = strained.stress(&table.centroid, &centre);
                let volume = centre.weight * element.cell.unit().powi(body.dimension() as i32);
                let place = || element.cell.place(&table.centroid.shape);
                let energy = volume * element.phase.law.complementary_energy(&stress, place);
                all.centres.push(AtCentre { strain, rotation: length(centre.rotation()), volume, energy });
                all.stresses.push(finished(body, stress));
            }
            (run.start, all)
        };

        let (mesh, interfaces) = (body.mesh(), interfaces(body));
        let mut elements = Vec::with_capacity(mesh.element_count());
        let mut sums: Vec<(Symmetric, usize)> = vec![([0.0; 6], 0); mesh.nodes().len()];
        let mut sides = BTreeMap::<(usize, u32), (Symmetric, usize)>::new();
        let mut force = vec![0.0; displacement.len()];
        let mut centres = Vec::with_capacity(mesh.element_count());
        in_order(mesh.element_count(), of_run, |(first, run)| {
            let numbers = first..first + run.stresses.len();
            add_to_nodes(body, numbers.clone(), &run.forces, &mut force);
            let nodes = numbers.flat_map(|index| mesh.element(index).iter().map(move |&node| (index, node)));
            for ((index, node), stress) in nodes.zip(&run.of_nodes) {
                add(&mut sums[node], stress);
                if interfaces.contains(&node) {
                    add(sides.entry((node, body.phase_number(index))).or_default(), stress);
                }
            }
            elements.extend(run.stresses);
            centres.extend(run.centres);
        });
        let deformation = Deformation::of(body, &centres);
        let average =
            |(sum, count): &(Symmetric, usize)| finished(body, sum.map(|component| component / *count as f64));
        let nodes = each(mesh.nodes().len(), |node| average(&sums[node]));
        let sides = sides.iter().map(|(&side, sum)| (side, average(sum))).collect();
        Ok(DisplacedState { stress: StressField { elements, nodes, sides }, force, deformation })
    }
}

/// The nodes at which elements of several phases meet.
fn interfaces(body: &ElasticBody) -> BTreeSet<usize> {
    let mut found = BTreeSet::new();
    if body.phases().len() > 1 {
        let mut first = vec![None; body.mesh().nodes().len()];
        for element in body.elements() {
            let meets = |&&node: &&usize| *first[node].get_or_insert(element.phase_number) != element.phase_number;
            found.extend(element.nodes.iter().filter(meets));
        }
    }
    found
}

/// The strain at each node, of all elements around it: recovered as the stress of [`super::StressField`].
pub fn nodal_strain(body: &ElasticBody, displacement: &[f64]) -> Result<Vec<Symmetric>, Error> {
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
pub fn at_points(
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
pub fn volume_and_energy(body: &ElasticBody, displacement: &[f64]) -> Result<Vec<[f64; 2]>, Error> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_thousandth_of_a_body_exceeds_is_not_widespread() {
        let found = |volume: f64, energy: f64| {
            let small = AtCentre { strain: 0.1, rotation: 0.2, volume: 1.0 - volume, energy: 1.0 - energy };
            widespread(&[small, AtCentre { strain: 0.4, rotation: 0.9, volume, energy }])
        };
        assert_eq!([found(0.9e-3, 0.9e-3), found(1.1e-3, 0.0), found(0.0, 1.1e-3)], [0.2, 0.9, 0.9]);
    }
}
