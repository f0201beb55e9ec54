//! The stress of quadratic tetrahedra recovered by patches: quadratic functions that fit the stresses of the elements
//! around each corner.

use crate::fem::body::{BodyElement, ElasticBody};
use crate::fem::dense::DenseMatrix;
use crate::fem::element::{ElementKind, TabulatedPoint};
use crate::fem::geometry::{Around, Symmetric, distance, minus};
use crate::fem::threads::each;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::formulation::Formulation;
    use crate::fem::material::Material;
    use crate::fem::mesh::bisection::Tetrahedra;
    use crate::fem::mesh::gmsh::GmshFile;

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
