//! Temperatures and initial stresses: the effects in free and in supported bodies.

use crate::elements::all;
use signorini::fem::{self, DofMap, ElasticBody, ElementKind, Formulation, Material, Stress};
use signorini::scene::rectangle;
use support::bodies::{difference, distorted, largest, nodal, nodal_of};

const ROUNDING: f64 = 1e-12;
const EXPANSION: f64 = 1e-3;
const STRESS: Formulation = Formulation::PlaneStress { thickness: 0.5 };

fn components(stress: &Stress) -> [f64; 6] {
    [stress.sigma_xx, stress.sigma_yy, stress.sigma_zz, stress.sigma_xy, stress.sigma_yz, stress.sigma_zx]
}

fn everywhere(body: &ElasticBody) -> Vec<usize> {
    (0..body.mesh().element_count()).collect()
}

/// GOAL: free thermal expansion.
/// CONDITIONS: 20 degrees warmer, with E = 7 and nu = 0.3, on distorted meshes of every element and integration.
/// REFERENCE: the strain alpha T without force; in plane strain the stress across the plane is -E alpha T, and the
/// expansion in the plane is larger by nu times alpha T.
#[test]
fn a_uniformly_warmed_free_body_has_no_stress_on_any_mesh() {
    for (name, body) in all() {
        let elements = everywhere(&body);
        let expanding = Material::new(7.0, 0.3).unwrap().with_expansion([EXPANSION; 3]).unwrap();
        let cold = vec![0.0; body.nodal_dofs()];
        let warm =
            body.with_material(&elements, expanding).unwrap().with_temperature(&elements, 20.0, [0.0; 3]).unwrap();
        let (stretch, across) = match warm.formulation() {
            Formulation::PlaneStrain { .. } => (1.3 * 20.0 * EXPANSION, -7.0 * 20.0 * EXPANSION),
            _ => (20.0 * EXPANSION, 0.0),
        };
        let field = nodal_of(warm.mesh(), |at| at.map(|coordinate| stretch * coordinate));
        let held = largest(&fem::internal_force(&warm, &cold).unwrap());
        let free = largest(&fem::internal_force(&warm, &field).unwrap());
        assert!(held > 1e-3 && free < ROUNDING * held, "{name}: {free:e} of {held:e}");
        let stress = fem::stress(&warm, &field).unwrap();
        for stress in stress.elements.iter().chain(&stress.nodes) {
            let away = difference(&components(stress), &[0.0, 0.0, across, 0.0, 0.0, 0.0]);
            assert!(away < ROUNDING, "{name}: {stress:?}");
        }
        if across == 0.0 {
            assert_eq!(fem::discretisation_error(&warm, &field, &stress).unwrap(), 0.0, "{name}");
        }
        // The load of the free dofs is not zero although no displacement is prescribed.
        let dofs = DofMap::new(vec![None; cold.len()]).unwrap();
        let load = fem::free_load(&warm, &dofs, &cold).unwrap();
        let product = fem::stiffness(&warm, &dofs).unwrap().mul(&field);
        assert!(difference(&product, &load) < ROUNDING * held, "{name}");
    }
}

/// GOAL: thermal bending without stress.
/// CONDITIONS: a thin sheet with T = 5 + 3 x - 2 y; quadratic elements.
/// REFERENCE: u_x = a (5 x + 3 (x^2 - y^2)/2 - 2 x y), u_y = a (5 y - (y^2 - x^2) + 3 x y).
#[test]
fn a_linear_temperature_bends_a_thin_sheet_without_stress() {
    // Only rectangular quadrilaterals represent all quadratic functions.
    let straight = rectangle(&[0.0, 0.3, 2.0], &[0.0, 0.6, 1.0], ElementKind::Q8).unwrap();
    for mesh in [distorted(ElementKind::T6), straight] {
        let material = Material::new(7.0, 0.3).unwrap().with_expansion([EXPANSION; 3]).unwrap();
        let (kind, body) = (mesh.kind_of(0), ElasticBody::new(mesh, material, STRESS).unwrap());
        let elements = everywhere(&body);
        let body = body.with_temperature(&elements, 5.0, [3.0, -2.0, 0.0]).unwrap();
        let field = nodal(body.mesh(), |[x, y]| {
            let (xx, yy) = (5.0 * x + 1.5 * (x * x - y * y) - 2.0 * x * y, 5.0 * y - (y * y - x * x) + 3.0 * x * y);
            [EXPANSION * xx, EXPANSION * yy]
        });
        for stress in fem::stress(&body, &field).unwrap().nodes {
            assert!(largest(&components(&stress)) < ROUNDING, "{kind:?} {stress:?}");
        }
    }
}

/// GOAL: thermal expansion of an orthotropic sheet.
/// CONDITIONS: plane stress; the axes of the material are turned by 30 degrees.
/// REFERENCE: the thermal strain, transformed as a tensor; no stress.
#[test]
fn an_orthotropic_sheet_expands_along_the_axes_of_its_material() {
    let (sine, cosine) = f64::to_radians(30.0).sin_cos();
    let material = Material::orthotropic([140.0, 10.0, 9.0], [0.3, 0.4, 0.28], [5.0, 3.6, 4.5]).unwrap();
    let material = material.along([cosine, sine, 0.0], [-sine, cosine, 0.0]).unwrap();
    let material = material.with_expansion([-1e-4, 3e-3, 5e-3]).unwrap();
    let body = ElasticBody::new(distorted(ElementKind::T3), material, STRESS).unwrap();
    let elements = everywhere(&body);
    let body = body.with_temperature(&elements, 2.0, [0.0; 3]).unwrap();
    let along = |one: f64, other: f64| -2e-4 * one + 6e-3 * other;
    let (xx, yy) = (along(cosine * cosine, sine * sine), along(sine * sine, cosine * cosine));
    let xy = along(sine * cosine, -sine * cosine);
    let field = nodal(body.mesh(), |[x, y]| [xx * x + xy * y, xy * x + yy * y]);
    for stress in fem::stress(&body, &field).unwrap().nodes {
        assert!(largest(&components(&stress)) < ROUNDING, "{stress:?}");
    }
}

#[test]
fn an_initial_stress_is_the_stress_without_displacement_for_every_material() {
    let material = Material::new(7.0, 0.3).unwrap();
    let body =
        ElasticBody::new(distorted(ElementKind::Q4), material, Formulation::PlaneStrain { thickness: 1.0 }).unwrap();
    let elements = everywhere(&body);
    let initial = [3.0, -1.0, 0.5, 2.0, 0.0, 0.0];
    let body = body.with_initial_stress(&elements, initial).unwrap();
    let body = body.with_material(&[0, 5], Material::new(70.0, 0.1).unwrap()).unwrap();
    let still = vec![0.0; body.nodal_dofs()];
    let field = fem::stress(&body, &still).unwrap();
    for stress in field.elements.iter().chain(&field.nodes) {
        assert!(difference(&components(stress), &initial) < ROUNDING, "{stress:?}");
    }
}

#[test]
fn temperatures_and_stresses_that_a_body_cannot_have_are_refused() {
    let mesh = || rectangle(&[0.0, 1.0], &[0.0, 1.0], ElementKind::Q4).unwrap();
    let material = Material::new(7.0, 0.3).unwrap();
    let body = ElasticBody::new(mesh(), material, STRESS).unwrap();
    assert!(body.clone().with_temperature(&[0], 1.0, [0.0; 3]).unwrap_err().to_string().contains("expansion"));
    assert!(body.clone().with_initial_stress(&[0], [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]).is_err());
    assert!(body.with_initial_stress(&[1], [0.0; 6]).unwrap_err().to_string().contains("there is no element 1"));
    assert!(material.with_expansion([0.0, f64::NAN, 0.0]).is_err());
    let expanding = material.with_expansion([EXPANSION; 3]).unwrap();
    let body = ElasticBody::new(mesh(), expanding, STRESS).unwrap().with_temperature(&[0], 1.0, [0.0; 3]).unwrap();
    assert!(body.clone().with_temperature(&[0], f64::INFINITY, [0.0; 3]).is_err());
    assert!(
        body.with_material(&[0], material).is_err(),
        "a temperature without a coefficient of expansion is accepted"
    );
}
