//! The stress of quadratic tetrahedra recovered by patches: quadratic functions that fit the stresses of the elements
//! around each corner. The estimated discretisation error.

use super::StressField;
use crate::body::{BodyElement, ElasticBody};
use crate::dense::DenseMatrix;
use crate::element::{ElementKind, MAX_NODES, PerNode, QuadratureRule, Tabulated, TabulatedPoint};
use crate::error::Error;
use crate::geometry::{Around, Symmetric, distance, minus};
use crate::threads::each;
use signorini_linear as linear;

/// The coefficients of a quadratic function in space, and the fewest elements of a patch: near edges of the body it
/// takes further elements from around its own.
const TERMS: usize = 10;

/// What the squares of the coefficients add to the squares of the misfit: points on a surface of second degree
/// determine no fit alone.
const RIDGE: f64 = 1e-8;

/// A quadratic function for each corner of a quadratic tetrahedron and each phase there.
///
/// Averages at the nodes, which suffice for linear elements, contain the error of the elements: on both sides of a node
/// the derivatives of quadratic functions miss that of a cubic one by the same amount.
///
/// # Source
/// O. C. Zienkiewicz, J. Z. Zhu, "The superconvergent patch recovery and a posteriori error estimates", *Int. J. Numer.
/// Methods Eng.* 33 (1992) 1331-1364.
pub(super) struct Patches(Vec<Vec<(u32, Quadratic)>>);

/// A point of an element, and the stress there.
type Sample = ([f64; 3], Symmetric);

impl Patches {
    /// Returns `true` if the stress in elements of this kind is recovered by patches.
    pub fn are_for(kind: ElementKind) -> bool {
        kind == ElementKind::QUADRATIC_TETRAHEDRON
    }

    /// The patches of a displaced body; `displacement` has `dim` entries per node.
    pub fn of(body: &ElasticBody, displacement: &[f64]) -> Self {
        let (mesh, tables) = (body.mesh(), body.tabulated());
        if !mesh.kinds().any(Self::are_for) {
            return Patches(Vec::new());
        }
        let samples: Vec<Vec<Sample>> = each(mesh.element_count(), |index| {
            let Some(element) = body.element(index).filter(|element| Self::are_for(element.kind)) else {
                return Vec::new();
            };
            let strained = body.strained(&tables, displacement, &element);
            let sample = |at: &TabulatedPoint| (element.cell.place(&at.shape), strained.at(at).1);
            tables.at(element.kind).points.iter().map(sample).collect()
        });
        let corners = |index: usize| {
            let kind = mesh.kind_of(index);
            let count = if Self::are_for(kind) { kind.corners() } else { 0 };
            mesh.element(index)[..count].iter().copied()
        };
        let around = Around::new(mesh.nodes().len(), (0..mesh.element_count()).map(corners));
        let near = |node: usize, phase: u32| {
            around.at(node).iter().map(|&index| index as usize).filter(move |&index| body.phase_number(index) == phase)
        };
        let unique = |mut numbers: Vec<usize>| {
            numbers.sort_unstable();
            numbers.dedup();
            numbers
        };
        let patch = |node: usize, phase: u32| {
            let mut patch: Vec<usize> = near(node, phase).collect();
            while patch.len() < TERMS {
                let wider =
                    unique(patch.iter().flat_map(|&index| corners(index)).flat_map(|node| near(node, phase)).collect());
                if wider.len() == patch.len() {
                    break;
                }
                patch = wider;
            }
            patch
        };
        Patches(each(mesh.nodes().len(), |node| {
            let phases =
                unique(around.at(node).iter().map(|&index| body.phase_number(index as usize) as usize).collect());
            let fitted = phases.into_iter().map(|phase| {
                let of_patch: Vec<&Sample> =
                    patch(node, phase as u32).into_iter().flat_map(|index| &samples[index]).collect();
                (phase as u32, Quadratic::fit(mesh.nodes()[node], &of_patch))
            });
            fitted.collect()
        }))
    }

    /// The recovered stress at a tabulated point of a quadratic tetrahedron: the mean of the functions of its corners,
    /// weighted by the barycentric coordinates of the point, so that it is continuous.
    pub fn stress(&self, element: &BodyElement, at: &TabulatedPoint) -> Symmetric {
        let (reference, place) = (element.kind.reference(), element.cell.place(&at.shape));
        let (of_corners, of_middles) = at.shape.split_at(reference.corners);
        let mut stress = [0.0; 6];
        for (corner, (node, own)) in element.nodes.iter().zip(of_corners).enumerate() {
            let middles = reference.mid_sides.iter().zip(of_middles).filter(|(ends, _)| ends.contains(&corner));
            let weight = own + middles.map(|(_, value)| value / 2.0).sum::<f64>();
            let of_phase = self.0[*node].iter().find(|(phase, _)| *phase == element.phase_number);
            if let Some((_, function)) = of_phase {
                stress.iter_mut().zip(function.at(place)).for_each(|(sum, value)| *sum += weight * value);
            }
        }
        stress
    }
}

/// A quadratic function in space with the values of a stress.
struct Quadratic {
    centre: [f64; 3],
    /// The unit of length of its coefficients.
    size: f64,
    coefficients: [Symmetric; TERMS],
}

impl Quadratic {
    /// The function with the least squares of the misfit at all samples.
    fn fit(centre: [f64; 3], samples: &[&Sample]) -> Self {
        let size = samples.iter().map(|sample| distance(sample.0, centre)).fold(f64::MIN_POSITIVE, f64::max);
        let (mut squares, mut products) = ([[0.0; TERMS]; TERMS], [[0.0; 6]; TERMS]);
        // The ridge would shrink a uniform stress: only what differs from the first one is fitted.
        let first = samples.first().map_or([0.0; 6], |sample| sample.1);
        for (place, stress) in samples {
            let terms = terms(*place, centre, size);
            for (row, one) in terms.iter().enumerate() {
                squares[row].iter_mut().zip(&terms).for_each(|(sum, other)| *sum += one * other);
                let differences = stress.iter().zip(&first).map(|(value, first)| value - first);
                products[row].iter_mut().zip(differences).for_each(|(sum, value)| *sum += one * value);
            }
        }
        // The first of the squares counts the samples.
        let ridge = RIDGE * squares[0][0];
        let matrix = DenseMatrix::from_fn(TERMS, TERMS, |i, j| squares[i][j] + if i == j { ridge } else { 0.0 });
        let solved = matrix.solve(DenseMatrix::from_fn(TERMS, 6, |term, component| products[term][component]));
        let mut coefficients = [[0.0; 6]; TERMS];
        coefficients[0] = first;
        for (component, column) in solved.iter().flat_map(DenseMatrix::columns).enumerate() {
            column.iter().zip(&mut coefficients).for_each(|(value, of_term)| of_term[component] += *value);
        }
        Quadratic { centre, size, coefficients }
    }

    fn at(&self, place: [f64; 3]) -> Symmetric {
        let mut value = [0.0; 6];
        for (term, of_term) in terms(place, self.centre, self.size).iter().zip(&self.coefficients) {
            value.iter_mut().zip(of_term).for_each(|(sum, coefficient)| *sum += term * coefficient);
        }
        value
    }
}

/// The products of at most two coordinates about a centre.
fn terms(place: [f64; 3], centre: [f64; 3], size: f64) -> [f64; TERMS] {
    let [x, y, z] = minus(place, centre).map(|entry| entry / size);
    [1.0, x, y, z, x * x, y * y, z * z, x * y, y * z, z * x]
}

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
pub fn discretisation_error(body: &ElasticBody, displacement: &[f64], field: &StressField) -> Result<f64, Error> {
    Ok(EstimatedError::of(body, displacement, field)?.relative())
}

/// The estimate as squares of its norms: twice an energy.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimatedError {
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
        let tables = body.per_kind(|reference| Tabulated::new(reference, QuadratureRule::Revolved));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formulation::Formulation;
    use crate::material::Material;
    use crate::mesh::bisection::Tetrahedra;
    use crate::mesh::gmsh::GmshFile;

    /// Linear stresses are recovered up to the ridge, at every corner and inside; uniform ones up to rounding.
    #[test]
    fn a_linear_stress_is_recovered() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/meshes/box-tet4.msh");
        let mesh = Tetrahedra::of(&GmshFile::read(path).unwrap().mesh(&[], 1.0).unwrap()).unwrap().mesh().unwrap();
        let body = ElasticBody::new(mesh, Material::new(7.0, 0.3).unwrap(), Formulation::Space).unwrap();
        let bent: fn([f64; 3]) -> [f64; 3] = |[x, y, z]| [x * y - 0.5 * z * z, 0.25 * x * x + y * z, z * x + y * y];
        let sheared: fn([f64; 3]) -> [f64; 3] = |[x, y, z]| [x + 0.5 * y, 0.25 * y - z, z + 0.75 * x];
        for (field, most) in [(bent, 1e-4), (sheared, 1e-12)] {
            let displacement: Vec<f64> = body.mesh().nodes().iter().flat_map(|&place| field(place)).collect();
            let (patches, tables) = (Patches::of(&body, &displacement), body.tabulated());
            for element in body.elements() {
                let strained = body.strained(&tables, &displacement, &element);
                for at in &tables.at(element.kind).points {
                    let (recovered, own) = (patches.stress(&element, at), strained.at(at).1);
                    for component in 0..6 {
                        assert!((recovered[component] - own[component]).abs() < most, "{recovered:?} {own:?}");
                    }
                }
            }
        }
    }
}
