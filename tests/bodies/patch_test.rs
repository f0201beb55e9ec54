//! GOAL: linear displacement fields and their stresses are exact on any mesh, for every element and plane state.
//!
//! MESH: a 2 x 1 rectangle of 4 x 3 cells; inner nodes are moved by up to a fifth of a cell; E = 7, nu = 0.3, thickness
//! 0.5.
//!
//! REFERENCE: the prescribed field itself, and its stress by Hooke's law, written out in three dimensions.

use signorini::fem::{self, Formulation, Stress};
use support::bodies::{VARIANTS, difference, distorted_body, largest, nodal, solve_held};

/// Rounding of a few hundred operations on numbers of order one.
const ROUNDING: f64 = 1e-13;

fn linear([x, y]: [f64; 2]) -> [f64; 2] {
    [0.1 + 0.02 * x - 0.03 * y, -0.2 + 0.05 * x + 0.04 * y]
}

/// Stress of the field above by Hooke's law written out in three dimensions.
fn hooke(formulation: Formulation) -> (f64, f64, f64, f64) {
    let (e, nu, exx, eyy, gxy) = (7.0, 0.3, 0.02, 0.04, 0.02);
    let (lambda, mu) = (e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), e / (2.0 * (1.0 + nu)));
    let ezz = match formulation {
        Formulation::PlaneStrain { .. } => 0.0,
        _ => -lambda * (exx + eyy) / (lambda + 2.0 * mu),
    };
    let trace = lambda * (exx + eyy + ezz);
    (trace + 2.0 * mu * exx, trace + 2.0 * mu * eyy, mu * gxy, trace + 2.0 * mu * ezz)
}

#[test]
fn inner_nodes_follow_a_linear_field_that_is_prescribed_on_the_outline() {
    for (kind, state) in VARIANTS {
        let body = distorted_body(kind, state);
        let field = nodal(body.mesh(), linear);
        let on_outline = |dof: usize| {
            let [x, y, _] = body.mesh().nodes()[dof / 2];
            x == 0.0 || x == 2.0 || y == 0.0 || y == 1.0
        };
        let solved = solve_held(&body, &field, on_outline, &vec![0.0; field.len()]);
        let error = difference(&solved, &field);
        assert!(error < ROUNDING, "{kind:?} {state:?}: {error:e}");
    }
}

#[test]
fn stress_of_a_linear_field_is_exact_in_elements_and_at_nodes() {
    for (kind, state) in VARIANTS {
        let body = distorted_body(kind, state);
        let field = fem::stress(&body, &nodal(body.mesh(), linear)).unwrap();
        let (xx, yy, xy, zz) = hooke(state);
        assert_eq!(field.elements.len(), body.mesh().element_count());
        assert_eq!(field.nodes.len(), body.mesh().nodes().len());
        for stress in field.elements.iter().chain(&field.nodes) {
            let found = [stress.sigma_xx, stress.sigma_yy, stress.sigma_xy, stress.sigma_zz];
            assert!(difference(&found, &[xx, yy, xy, zz]) < ROUNDING, "{kind:?} {state:?}: {stress:?}");
        }
    }
}

#[test]
fn stress_that_is_linear_in_a_rectangle_is_exact_at_its_nodes() {
    // u_x = x y is bilinear: eps_xx = y, gamma_xy = x, everywhere in rectangular Q4 cells of any size.
    use signorini::fem::ElementKind;
    use signorini::scene::rectangle;
    let mesh = rectangle(&[0.0, 0.2, 1.0], &[0.0, 0.7, 1.0], ElementKind::Q4).unwrap();
    let material = signorini::fem::Material::new(8.0, 0.25).unwrap();
    let formulation = Formulation::PlaneStress { thickness: 1.0 };
    let body = signorini::fem::ElasticBody::new(mesh, material, formulation).unwrap();
    let field = fem::stress(&body, &nodal(body.mesh(), |[x, y]| [x * y, 0.0])).unwrap();
    let (along, shear) = (8.0 / (1.0 - 0.0625), 8.0 / 2.5);
    for (stress, [x, y]) in field.nodes.iter().zip(body.mesh().nodes().iter().map(|&[x, y, _]| [x, y])) {
        let found = [stress.sigma_xx, stress.sigma_yy, stress.sigma_xy];
        assert!(difference(&found, &[along * y, 0.25 * along * y, shear * x]) < ROUNDING, "{stress:?} at {x}, {y}");
    }
}

#[test]
fn principal_and_von_mises_stress_agree_with_their_definitions() {
    // Uniaxial stress, pure shear and equal pressure in all directions, computed by hand.
    let uniaxial = Stress::new(-3.0, 0.0, 0.0, 0.0);
    assert_eq!((uniaxial.sigma_1, uniaxial.sigma_2, uniaxial.von_mises.round()), (0.0, -3.0, 3.0));
    let shear = Stress::new(0.0, 0.0, 2.0, 0.0);
    assert_eq!((shear.sigma_1, shear.sigma_2), (2.0, -2.0));
    assert!((shear.von_mises - 12_f64.sqrt()).abs() < 1e-15);
    assert_eq!(Stress::new(-5.0, -5.0, 0.0, -5.0).von_mises, 0.0);
    // The formula in components, including the stress across the plane.
    let (x, y, z, t) = (1.3, -0.4, 0.7, 0.9);
    let expected: f64 = 0.5 * ((x - y) * (x - y) + (y - z) * (y - z) + (z - x) * (z - x)) + 3.0 * t * t;
    assert!((Stress::new(x, y, t, z).von_mises - expected.sqrt()).abs() < 1e-15);
}

#[test]
fn rigid_body_modes_cause_no_force() {
    for (kind, state) in VARIANTS {
        let body = distorted_body(kind, state);
        for (motion, allowed) in
            [((|_| [3.0, 0.0]) as fn([f64; 2]) -> [f64; 2], 0.0), (|_| [0.0, -2.0], 0.0), (|[x, y]| [-y, x], ROUNDING)]
        {
            let displacement = nodal(body.mesh(), motion);
            let force = fem::internal_force(&body, &displacement).unwrap();
            assert!(largest(&force) <= allowed, "{kind:?} {state:?}: {:e}", largest(&force));
        }
    }
}

#[test]
fn assembled_stiffness_and_internal_force_agree() {
    for (kind, state) in VARIANTS {
        let body = distorted_body(kind, state);
        let displacement = nodal(body.mesh(), |[x, y]| [(3.0 * x + y).sin(), (x - 2.0 * y).cos()]);
        let dofs = fem::DofMap::new(vec![None; displacement.len()]).unwrap();
        let product = fem::stiffness(&body, &dofs).unwrap().mul(&displacement);
        let force = fem::internal_force(&body, &displacement).unwrap();
        assert!(difference(&product, &force) < ROUNDING * largest(&force) * 10.0, "{kind:?} {state:?}");
    }
}

#[test]
fn stiffness_of_a_square_element_has_its_known_entries() {
    // Q4, plane stress, nu = 0, E = t = 1, unit square: by hand K_xx = 1/3 + 1/6, K_xy = 1/8.
    let mesh = signorini::scene::rectangle(&[0.0, 1.0], &[0.0, 1.0], signorini::fem::ElementKind::Q4).unwrap();
    let material = signorini::fem::Material::new(1.0, 0.0).unwrap();
    let formulation = Formulation::PlaneStress { thickness: 1.0 };
    let body = signorini::fem::ElasticBody::new(mesh, material, formulation).unwrap();
    let dofs = fem::DofMap::new(vec![None; 8]).unwrap();
    let stiffness = fem::stiffness(&body, &dofs).unwrap();
    let first: Vec<f64> = stiffness.lower().column(0).map(|entry| entry.1).collect();
    assert!((first[0] - 0.5).abs() < 1e-15 && (first[1] - 0.125).abs() < 1e-15, "{first:?}");
}

#[test]
fn stiffness_does_not_change_with_the_unit_of_length() {
    for scale in [2_f64.powi(-400), 2_f64.powi(-20), 2_f64.powi(400)] {
        let of = |scale: f64| {
            let lines = |lines: &[f64]| lines.iter().map(|x| x * scale).collect::<Vec<f64>>();
            let (x, y) = (lines(&[0.0, 0.4, 1.0]), lines(&[0.0, 0.7]));
            let mesh = signorini::scene::rectangle(&x, &y, signorini::fem::ElementKind::Q4).unwrap();
            let material = signorini::fem::Material::new(7.0, 0.3).unwrap();
            let formulation = Formulation::PlaneStrain { thickness: 1.0 };
            let body = signorini::fem::ElasticBody::new(mesh, material, formulation).unwrap();
            fem::stiffness(&body, &fem::DofMap::new(vec![None; 12]).unwrap()).unwrap()
        };
        assert_eq!(of(scale), of(1.0), "scale {scale:e}");
    }
}

#[test]
fn a_material_with_invalid_constants_is_refused() {
    use signorini::fem::Material;
    let strain = Formulation::PlaneStrain { thickness: 1.0 };
    let stress = Formulation::PlaneStress { thickness: 1.0 };
    for (young, poisson, formulation, fits) in [
        (1.0, 0.499999, strain, true),
        (1.0, 0.5, strain, false),
        (1.0, 0.5, Formulation::Axisymmetric, false),
        (1.0, 0.5, Formulation::Space, false),
        (1.0, 0.5, Formulation::Bar { area: 1.0 }, true),
        (1.0, 0.5, stress, true),
        (1.0, 0.500001, stress, false),
        (1.0, -0.999, stress, true),
        (1.0, -1.0, strain, false),
        (1.0, f64::NAN, strain, false),
        (0.0, 0.3, strain, false),
        (-1.0, 0.3, stress, false),
        (f64::INFINITY, 0.3, stress, false),
        (f64::NAN, 0.3, stress, false),
    ] {
        let found = Material::new(young, poisson).and_then(|material| material.law(&formulation)).is_ok();
        assert_eq!(found, fits, "{young} {poisson} {formulation:?}");
    }
}
