//! Orthotropic materials and bodies of several materials: closed forms along and off the axes, layers, refused input.

use signorini::fem::{self, DofMap, ElasticBody, ElementKind, Formulation, MassForm, Material};
use signorini::scene::{cuboid, rectangle};
use signorini::{fem::Error, qp};
use support::bodies::{difference, distorted, largest, nodal, solve_held};

const STRESS: Formulation = Formulation::PlaneStress { thickness: 0.5 };
const STRAIN: Formulation = Formulation::PlaneStrain { thickness: 0.5 };
const ROUNDING: f64 = 1e-12;

/// Carbon fibres in epoxy, in GPa; typical values of data sheets.
const YOUNG: [f64; 3] = [140.0, 10.0, 9.0];
const RATIOS: [f64; 3] = [0.3, 0.4, 0.28];
const SHEAR: [f64; 3] = [5.0, 3.6, 4.5];

fn carbon(degrees: f64) -> Material {
    let (sine, cosine) = f64::to_radians(degrees).sin_cos();
    let material = Material::orthotropic(YOUNG, RATIOS, SHEAR).unwrap();
    material.along([cosine, sine, 0.0], [-sine, cosine, 0.0]).unwrap()
}

/// The compliance in the plane off the axes, by textbook formulas: strains [xx, yy, 2 xy] for the stress [xx, yy, xy].
///
/// # Source
/// R. M. Jones, *Mechanics of Composite Materials*, 2nd ed. 1999, equation 2.88.
fn off_axis(degrees: f64) -> [[f64; 3]; 3] {
    let (s, c) = f64::to_radians(degrees).sin_cos();
    let ([e1, e2, _], [nu, ..], [g, ..]) = (YOUNG, RATIOS, SHEAR);
    let (s11, s12, s22, s66) = (1.0 / e1, -nu / e1, 1.0 / e2, 1.0 / g);
    let (c2, s2, mixed) = (c * c, s * s, 2.0 * s12 + s66);
    let xx = s11 * c2 * c2 + mixed * s2 * c2 + s22 * s2 * s2;
    let yy = s11 * s2 * s2 + mixed * s2 * c2 + s22 * c2 * c2;
    let xy = s12 * (c2 * c2 + s2 * s2) + (s11 + s22 - s66) * s2 * c2;
    let of = |one: f64, other: f64| (2.0 * s11 - mixed) * one - (2.0 * s22 - mixed) * other;
    let (xs, ys) = (of(s * c * c2, s * c * s2), of(s * c * s2, s * c * c2));
    let shear = 2.0 * (2.0 * s11 + 2.0 * s22 - 4.0 * s12 - s66) * s2 * c2 + s66 * (c2 * c2 + s2 * s2);
    [[xx, xy, xs], [xy, yy, ys], [xs, ys, shear]]
}

/// GOAL: an orthotropic sheet under uniform stress, along and off its axes.
/// CONDITIONS: plane stress, a distorted mesh; axes turned by five angles, one stress component at a time.
/// REFERENCE: R. M. Jones, *Mechanics of Composite Materials*, 2nd ed. 1999, equation 2.88, in `off_axis`.
#[test]
fn a_thin_sheet_has_the_strains_of_the_textbook_along_and_off_the_axes() {
    for degrees in [0.0, 30.0, 45.0, 90.0, -70.0] {
        let compliance = off_axis(degrees);
        for stress in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            let [xx, yy, xy] = compliance.map(|row| (0..3).map(|i| row[i] * stress[i]).sum::<f64>());
            let body = ElasticBody::new(distorted(ElementKind::Q8), carbon(degrees), STRESS).unwrap();
            let field = nodal(body.mesh(), |[x, y]| [xx * x + xy * y, yy * y]);
            for found in fem::stress(&body, &field).unwrap().nodes {
                let away = difference(&[found.sigma_xx, found.sigma_yy, found.sigma_xy], &stress);
                assert!(away < ROUNDING && found.sigma_zz == 0.0, "{degrees}: {stress:?} {found:?}");
            }
        }
    }
}

/// GOAL: an orthotropic body in plane strain.
/// CONDITIONS: a uniform stress along the axes of the material, on a distorted mesh.
/// REFERENCE: Hooke's law: E2 and nu12 are replaced by 1/E2' = (1 - nu23 nu32)/E2 and so on; the stress across the
/// plane is nu31 s1 + nu32 s2.
#[test]
fn plane_strain_has_the_reduced_moduli_and_the_stress_across_the_plane() {
    let body = ElasticBody::new(distorted(ElementKind::T6), carbon(0.0), STRAIN).unwrap();
    let ([e1, e2, e3], [nu12, nu23, nu13]) = (YOUNG, RATIOS);
    let (s1, s2) = (3.0, -2.0);
    let s3 = nu13 * e3 / e1 * s1 + nu23 * e3 / e2 * s2;
    let (xx, yy) = ((s1 - nu12 * s2 - nu13 * s3) / e1, s2 / e2 - nu12 / e1 * s1 - nu23 / e2 * s3);
    for found in fem::stress(&body, &nodal(body.mesh(), |[x, y]| [xx * x, yy * y])).unwrap().elements {
        let away = difference(&[found.sigma_xx, found.sigma_yy, found.sigma_zz], &[s1, s2, s3]);
        assert!(away < ROUNDING, "{found:?}");
    }
}

#[test]
fn turned_material_axes_give_the_stiffness_of_permuted_moduli() {
    // Axis 1 is along y, axis 2 along z, axis 3 along x: the moduli are permuted.
    let mesh = || cuboid(&[0.0, 0.6, 1.0], &[0.0, 1.0], &[0.0, 0.4, 2.0], ElementKind::Hex8).unwrap();
    let turned = Material::orthotropic(YOUNG, RATIOS, SHEAR).unwrap().along([0.0, 2.0, 0.0], [0.0, 1.0, 3.0]).unwrap();
    let ([e1, e2, e3], [nu12, nu23, nu13], [g12, g23, g13]) = (YOUNG, RATIOS, SHEAR);
    let written = Material::orthotropic([e3, e1, e2], [nu13 * e3 / e1, nu12, nu23 * e3 / e2], [g13, g12, g23]).unwrap();
    let [one, other] = [turned, written].map(|material| {
        let body = ElasticBody::new(mesh(), material, Formulation::Space).unwrap();
        let dofs = DofMap::new(vec![None; body.nodal_dofs()]).unwrap();
        fem::stiffness(&body, &dofs).unwrap().lower().triplets().map(|entry| entry.2).collect::<Vec<_>>()
    });
    assert!(difference(&one, &other) < ROUNDING * largest(&one), "{:e}", difference(&one, &other));
}

/// GOAL: two layers in tension.
/// CONDITIONS: plane stress, nu = 0; the load is along the layers. The estimate compares each layer with its nodal
/// stress, so that an exact mesh has no estimated error.
/// REFERENCE: equal strain: each layer has the stress E times the strain.
#[test]
fn layers_in_tension_have_equal_strain_and_no_estimated_error() {
    let mesh = rectangle(&[0.0, 0.7, 2.0], &[0.0, 0.4, 1.0], ElementKind::Q4).unwrap();
    let body = ElasticBody::new(mesh, Material::new(10.0, 0.0).unwrap(), STRESS).unwrap();
    let body = body.with_material(&[2, 3], Material::new(30.0, 0.0).unwrap()).unwrap();
    let field = nodal(body.mesh(), |[x, _]| [0.01 * x, 0.0]);
    let nodes = body.mesh().nodes().to_vec();
    let is_end = |dof: usize| dof % 2 == 1 || nodes[dof / 2][0] == 0.0 || nodes[dof / 2][0] == 2.0;
    let found = solve_held(&body, &field, is_end, &vec![0.0; field.len()]);
    assert!(difference(&found, &field) < ROUNDING);
    let stress = fem::stress(&body, &found).unwrap();
    for (stress, [_, y, _]) in stress.nodes.iter().zip(&nodes) {
        // At the interface the nodal stress is the mean of the two layers.
        let expected = if *y < 0.4 {
            0.1
        } else if *y > 0.4 {
            0.3
        } else {
            0.2
        };
        assert!((stress.sigma_xx - expected).abs() < ROUNDING, "{y} {stress:?}");
    }
    assert!(fem::discretisation_error(&body, &found, &stress).unwrap() < ROUNDING);
    let force = fem::internal_force(&body, &found).unwrap();
    let end: f64 = (0..nodes.len()).filter(|&node| nodes[node][0] == 2.0).map(|node| force[2 * node]).sum();
    assert!((end - 0.01 * 0.5 * (0.4 * 10.0 + 0.6 * 30.0)).abs() < ROUNDING, "{end}");
}

#[test]
fn each_material_contributes_its_density_to_the_mass() {
    let mesh = rectangle(&[0.0, 0.7, 2.0], &[0.0, 0.4, 1.0], ElementKind::Q4).unwrap();
    let [light, heavy] = [2.0, 7.0].map(|density| Material::new(1.0, 0.0).unwrap().with_density(density).unwrap());
    let body = ElasticBody::new(mesh, light, STRESS).unwrap().with_material(&[1, 3], heavy).unwrap();
    let dofs = DofMap::new(vec![None; body.nodal_dofs()]).unwrap();
    let mass = fem::mass(&body, &dofs, MassForm::Consistent, &[]).unwrap();
    let along: Vec<f64> = (0..body.nodal_dofs()).map(|dof| f64::from(u8::from(dof % 2 == 0))).collect();
    let total: f64 = mass.mul(&along).iter().zip(&along).map(|(a, b)| a * b).sum();
    assert!((total - 0.5 * (0.7 * 2.0 + 1.3 * 7.0)).abs() < ROUNDING, "{total}");
}

#[test]
fn constants_without_a_positive_definite_stiffness_are_refused() {
    let refused = |young, ratios, shear, expected: &str| {
        let error = Material::orthotropic(young, ratios, shear).unwrap_err();
        assert!(
            matches!(&error, Error::Linear(qp::LinearError::Setting { name, .. }) if *name == expected),
            "{error:?}"
        );
    };
    refused([140.0, 0.0, 9.0], RATIOS, SHEAR, "orthotropic.young[1]");
    refused(YOUNG, RATIOS, [5.0, 3.6, f64::INFINITY], "orthotropic.shear[2]");
    // 4^2 is larger than 140/10.
    refused(YOUNG, [4.0, 0.4, 0.28], SHEAR, "orthotropic.poisson[0]");
    refused(YOUNG, [0.3, f64::NAN, 0.28], SHEAR, "orthotropic.poisson[1]");
    // 1 - 3 x 0.36 - 2 x 0.216 is negative, although each pair is allowed.
    refused([1.0; 3], [0.6; 3], [1.0; 3], "orthotropic.poisson");
    let material = Material::orthotropic(YOUNG, RATIOS, SHEAR).unwrap();
    assert!(material.along([1.0, 2.0, 0.0], [-2.0, -4.0, 0.0]).is_err());
    let leaning = material.along([1.0, 0.0, 1.0], [0.0, 1.0, 0.0]).unwrap();
    assert!(ElasticBody::new(distorted(ElementKind::Q4), leaning, STRESS).is_err());
    let body = ElasticBody::new(distorted(ElementKind::Q4), material, STRESS).unwrap();
    assert!(body.with_material(&[12], material).unwrap_err().to_string().contains("there is no element 12"));
}
