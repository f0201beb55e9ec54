//! Closed forms against differences of fourth order, on distorted elements of every kind in every formulation.

use super::*;
use crate::assembly::{
    Density, FacetPoint, Kinks, Points, add_body_force, add_centrifugal, add_gravity, area_and_integral,
    integral_by_places, internal_force, outward, own_energy, own_energy_change,
};
use crate::body::PhaseNumber;
use crate::element::ElementKind;
use crate::formulation::Formulation;
use crate::geometry::length;
use crate::material::Material;
use crate::mesh::{Boundary, Mesh};
use signorini_linear::dot as product;

/// Derivatives agree with differences to within this, relative to the largest entry: rounding over the step.
const CLOSE: f64 = 1e-9;

/// Step of the differences; elements are of size 1 or 2.
const STEP: f64 = 5e-4;

/// A sequence of reproducible numbers from -1 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        // The multiplier is that of D. E. Knuth's generator MMIX.
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        2.0 * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64) - 1.0
    }

    fn vector(&mut self, length: usize) -> Vec<f64> {
        (0..length).map(|_| self.next()).collect()
    }

    fn place(&mut self) -> [f64; 3] {
        [0; 3].map(|_| self.next())
    }
}

fn formulations(kind: ElementKind) -> Vec<Formulation> {
    match kind.dimension() {
        1 => vec![Formulation::Bar { area: 0.7 }],
        2 => vec![
            Formulation::PlaneStrain { thickness: 0.3 },
            Formulation::PlaneStress { thickness: 0.3 },
            Formulation::Axisymmetric,
        ],
        _ => vec![Formulation::Space],
    }
}

fn isotropic() -> Material {
    Material::new(2.0, 0.3).unwrap().with_density(1.7).unwrap().with_expansion([0.2; 3]).unwrap()
}

fn orthotropic(formulation: &Formulation) -> Material {
    let material = Material::orthotropic([3.0, 1.0, 2.0], [0.2, 0.3, 0.1], [0.6, 0.5, 0.4]).unwrap();
    let second = if formulation.dimension() == 3 { [-0.3, 0.8, 0.4] } else { [-0.3, 0.8, 0.0] };
    let turned = material.along([0.8, 0.3, 0.0], second).unwrap();
    turned.with_density(1.7).unwrap().with_expansion([0.3, 0.1, 0.2]).unwrap()
}

/// One distorted element away from the origin and from an axis of revolution, with its first and last faces as
/// boundaries.
fn distorted(kind: ElementKind, formulation: Formulation, material: Material, random: &mut Random) -> ElasticBody {
    let (reference, dimension) = (kind.reference(), kind.dimension());
    let nodes = reference.nodes.iter().map(|node| {
        let off = random.place();
        [0, 1, 2].map(|axis| if axis < dimension { 3.0 + node[axis] + 0.1 * off[axis] } else { 0.0 })
    });
    let nodes: Vec<[f64; 3]> = nodes.collect();
    let side = |name: &str, face: &[usize]| Boundary::new(name, kind.facet(), face.to_vec());
    let sides = vec![side("first", reference.faces[0]), side("last", reference.faces[reference.faces.len() - 1])];
    let mesh = Mesh::new(nodes, kind, (0..kind.nodes()).collect(), sides).unwrap();
    ElasticBody::new(mesh, material, formulation).unwrap()
}

/// The derivative of `value` with respect to every coordinate, by differences of fourth order.
fn differences(body: &ElasticBody, value: impl Fn(&ElasticBody) -> f64) -> Vec<f64> {
    let along = |dof: usize| {
        let at = |steps: f64| value(&body.moved(dof, steps * STEP));
        (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * STEP)
    };
    (0..body.nodal_dofs()).map(along).collect()
}

fn assert_close(found: &[f64], expected: &[f64], case: &str) {
    let largest = expected.iter().fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
    assert!(largest > 1e-3, "{case}: nothing depends on the places");
    for (dof, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!((found - expected).abs() <= CLOSE * largest, "{case}, dof {dof}: {found} is not {expected}");
    }
}

fn check_internal(body: &ElasticBody, random: &mut Random, case: &str) {
    let [u, w] = [0; 2].map(|_| random.vector(body.nodal_dofs()));
    let mut found = vec![0.0; u.len()];
    internal_work_by_places(body, &u, &w, &mut found).unwrap();
    assert_close(&found, &differences(body, |body| product(&w, &internal_force(body, &u).unwrap())), case);
    // Nothing changes if all nodes move together, except the radius of a body of revolution.
    let largest = found.iter().fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
    let (dimension, is_warm) = (body.dimension(), body.has_own_stress());
    for axis in usize::from(body.formulation().is_axisymmetric())..if is_warm { 0 } else { dimension } {
        let sum: f64 = found.iter().skip(axis).step_by(dimension).sum();
        assert!(sum.abs() <= 1e-13 * largest, "{case}: a translation changes the work by {sum}");
    }
}

#[test]
fn the_work_of_stresses_changes_as_differences_say_for_all_elements_and_formulations() {
    let mut random = Random(1);
    for kind in ElementKind::ALL {
        for formulation in formulations(kind) {
            for (name, material) in [("isotropic", isotropic()), ("orthotropic", orthotropic(&formulation))] {
                let case = format!("{} {} {name}", kind.name(), formulation.name());
                let body = distorted(kind, formulation, material, &mut random);
                check_internal(&body, &mut random, &case);
                let (mut stress, gradient) = ([0.0; 6], [0.3, -0.2, 0.5]);
                formulation.stresses().iter().for_each(|&component| stress[component] = random.next());
                let mut slope = gradient;
                slope[kind.dimension()..].fill(0.0);
                let warm = body.with_temperature(&[0], 0.4, slope).unwrap().with_initial_stress(&[0], stress).unwrap();
                check_internal(&warm, &mut random, &format!("{case} warm"));
            }
        }
    }
}

/// GOAL: the energy of temperatures and initial stresses, and its derivatives by places, by moduli and by the
/// temperature. CONDITIONS: every element in every formulation. REFERENCE: differences, and the work that the stress of
/// the strain `C^-1 sigma_0` does on it.
#[test]
fn the_energy_of_own_stress_changes_as_differences_say() {
    let mut random = Random(6);
    for kind in ElementKind::ALL {
        for formulation in formulations(kind) {
            let mut stress = [0.0; 6];
            formulation.stresses().iter().for_each(|&component| stress[component] = random.next());
            let mut slope = [0.3, -0.2, 0.5];
            slope[kind.dimension()..].fill(0.0);
            let warmed = |body: ElasticBody, temperature: f64| {
                let warm = body.with_temperature(&[0], temperature, slope).unwrap();
                warm.with_initial_stress(&[0], stress).unwrap()
            };
            for (name, material) in [("isotropic", isotropic()), ("orthotropic", orthotropic(&formulation))] {
                let case = format!("{} {} {name}", kind.name(), formulation.name());
                let body = warmed(distorted(kind, formulation, material, &mut random), 0.4);
                let mut found = vec![0.0; body.nodal_dofs()];
                own_energy_by_places(&body, &mut found);
                assert_close(&found, &differences(&body, own_energy), &case);
            }
            let mesh = distorted(kind, formulation, isotropic(), &mut random).mesh().clone();
            let of = |[young, poisson, temperature]: [f64; 3]| {
                let material = Material::new(young, poisson).unwrap().with_expansion([0.2; 3]).unwrap();
                warmed(ElasticBody::new(mesh.clone(), material, formulation).unwrap(), temperature)
            };
            let numbers = [2.0, 0.3, 0.4];
            for (index, by) in
                [PhaseNumber::Young, PhaseNumber::Poisson, PhaseNumber::Temperature].into_iter().enumerate()
            {
                let at = |steps: f64| {
                    let mut varied = numbers;
                    varied[index] += steps * STEP;
                    own_energy(&of(varied))
                };
                let expected = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * STEP);
                let body = of(numbers);
                let found = own_energy_change(&body, &body.derivative(&[by]).unwrap());
                let (scale, case) = (own_energy(&body), format!("{} {} {by:?}", kind.name(), formulation.name()));
                assert!(
                    (found - expected).abs() <= CLOSE * scale.max(expected.abs()),
                    "{case}: {found} is not {expected}"
                );
            }
        }
    }
}

#[test]
fn the_work_of_stresses_with_mean_dilatation_changes_as_differences_say() {
    let mut random = Random(2);
    let takes = ElementKind::ALL.into_iter().filter(|kind| kind.takes_mean_dilatation());
    for kind in takes {
        for formulation in formulations(kind).into_iter().filter(Formulation::can_lock) {
            let case = format!("{} {}", kind.name(), formulation.name());
            let body = distorted(kind, formulation, isotropic(), &mut random);
            let mean = |body: ElasticBody| body.with_integration(Integration::MeanDilatation).unwrap();
            check_internal(&mean(body.clone()), &mut random, &case);
            let warm = body.with_temperature(&[0], 0.4, [0.3, -0.2, 0.0]).unwrap();
            check_internal(&mean(warm), &mut random, &format!("{case} warm"));
        }
    }
}

#[test]
fn axes_that_turn_are_refused() {
    let material = orthotropic(&Formulation::Space).around([0.0; 3], [0.0, 0.0, 1.0]).unwrap();
    let body = distorted(ElementKind::Hex8, Formulation::Space, material, &mut Random(3));
    let zero = vec![0.0; body.nodal_dofs()];
    let reason = internal_work_by_places(&body, &zero, &zero, &mut zero.clone()).unwrap_err();
    assert!(reason.contains("turn around a line"), "{reason}");
}

#[test]
fn the_work_of_body_forces_changes_as_differences_say() {
    let mut random = Random(4);
    for kind in ElementKind::ALL {
        for formulation in formulations(kind) {
            let body = distorted(kind, formulation, isotropic(), &mut random);
            let (w, force) = (random.vector(body.nodal_dofs()), random.place());
            let about = if kind.dimension() == 3 { [0.48, 0.6, 0.64] } else { [0.0, 0.0, 1.0] };
            let axis =
                if formulation.is_axisymmetric() { ([0.0, 1.0, 0.0], [0.0; 3]) } else { (about, random.place()) };
            type Load<'a> = &'a dyn Fn(&ElasticBody, &mut [f64]);
            let check = |name: &str, load: Load, by_places: Load| {
                let of_body = |body: &ElasticBody| {
                    let mut nodal = vec![0.0; w.len()];
                    load(body, &mut nodal);
                    product(&w, &nodal)
                };
                let mut found = vec![0.0; w.len()];
                by_places(&body, &mut found);
                let case = format!("{} {} {name}", kind.name(), formulation.name());
                assert_close(&found, &differences(&body, of_body), &case);
            };
            check("body force", &|body, load| add_body_force(body, force, load), &|body, found| {
                body_force_by_places(body, force, &w, found);
            });
            check("gravity", &|body, load| add_gravity(body, force, load).unwrap(), &|body, found| {
                gravity_by_places(body, force, &w, found).unwrap();
            });
            check("rotation", &|body, load| add_centrifugal(body, 1.3, axis, load).unwrap(), &|body, found| {
                centrifugal_by_places(body, 1.3, axis, &w, found).unwrap();
            });
        }
    }
}

/// The density (1 + (a.x)^2 + (b.n)^2 (c.x)) times a nodal field.
#[test]
fn integrals_over_boundaries_change_as_differences_say_for_all_facets() {
    let mut random = Random(5);
    for kind in ElementKind::ALL {
        for formulation in formulations(kind) {
            let body = distorted(kind, formulation, isotropic(), &mut random);
            let (field, [a, b, c]) = (random.vector(body.mesh().nodes().len()), [0; 3].map(|_| random.place()));
            let density = |point: &FacetPoint| {
                let at_node: f64 = point.nodes.iter().zip(point.shape).map(|(&node, share)| share * field[node]).sum();
                let [of_a, of_b, of_c] = [dot(a, point.at), dot(b, point.normal), dot(c, point.at)];
                let by_place = |k: usize| at_node * (2.0 * of_a * a[k] + of_b * of_b * c[k]);
                Density {
                    value: at_node * (1.0 + of_a * of_a + of_b * of_b * of_c),
                    by_place: [0, 1, 2].map(by_place),
                    by_normal: b.map(|part| at_node * 2.0 * of_b * of_c * part),
                }
            };
            for name in ["first", "last"] {
                for points in [Points::Own, Points::Fine(Kinks::NONE)] {
                    let boundary = body.mesh().boundary(name).unwrap();
                    let value =
                        |body: &ElasticBody| area_and_integral(body, boundary, points, |point| density(point).value)[1];
                    let mut found = vec![0.0; body.nodal_dofs()];
                    integral_by_places(&body, boundary, points, density, &mut found);
                    let case = format!("{} {} {name} {points:?}", kind.name(), formulation.name());
                    assert_close(&found, &differences(&body, value), &case);
                }
            }
        }
    }
}

/// A straight edge or a plane triangle, with a field that has two kinks on it.
#[test]
fn integrals_of_fields_with_kinks_change_as_differences_say() {
    let mut random = Random(6);
    for kind in [ElementKind::T3, ElementKind::Q4, ElementKind::Tet4] {
        for formulation in formulations(kind) {
            let body = distorted(kind, formulation, isotropic(), &mut random);
            let boundary = &outward(&body, body.mesh().boundary("first").unwrap());
            let ends: Vec<[f64; 3]> = boundary.facet(0).iter().map(|&node| body.mesh().nodes()[node]).collect();
            let way = minus(ends[1], ends[0]);
            let along = way.map(|part| part / length(way));
            let levels = [0.35, 0.6].map(|share| dot(along, ends[0]) + share * length(way));
            let density = |point: &FacetPoint| {
                let place = dot(along, point.at);
                let over = |level: f64| if place > level { 1.0 } else { 0.0 };
                let value = 0.3 + levels.iter().map(|&level| over(level) * (place - level)).sum::<f64>();
                let slope = levels.iter().map(|&level| over(level)).sum::<f64>();
                Density { value, by_place: along.map(|part| slope * part), by_normal: [0.0; 3] }
            };
            let points = Points::Fine(Kinks { along, at: &levels });
            let value = |body: &ElasticBody| area_and_integral(body, boundary, points, |point| density(point).value)[1];
            let mut found = vec![0.0; body.nodal_dofs()];
            integral_by_places(&body, boundary, points, density, &mut found);
            let case = format!("{} {}", kind.name(), formulation.name());
            assert_close(&found, &differences(&body, value), &case);
        }
    }
}
