//! GOAL: every form of the mass matrix has the mass and the centre of mass of the body.
//!
//! REFERENCE: volume and moments by the quadrature of body forces; the kinetic energy of a linear velocity, which the
//! shape functions represent exactly.

use signorini::fem::{
    DofMap, ElasticBody, ElementKind, Formulation, Frame, MassForm, Material, add_body_force_field, mass,
};
use signorini::qp::{Cholesky, dot};
use signorini::scene::{bar, cuboid};
use signorini::{fem::Error, qp};
use support::bodies::{distort, distorted, nodal_of};

/// Rounding of sums over a mesh with two quadratures.
const SAME: f64 = 1e-12;

const DENSITY: f64 = 3.0;

const LINES: [f64; 6] = [0.0, 0.2, 0.4, 0.7, 0.9, 1.2];

/// A distorted body of every element in a suitable formulation, and the side that is its contact boundary.
fn bodies() -> Vec<(ElasticBody, &'static str)> {
    let material = Material::new(7.0, 0.3).unwrap().with_density(DENSITY).unwrap();
    let mut bodies = Vec::new();
    for kind in [ElementKind::T3, ElementKind::T6, ElementKind::Q4, ElementKind::Q8] {
        for formulation in [Formulation::PlaneStrain { thickness: 0.5 }, Formulation::Axisymmetric] {
            bodies.push((ElasticBody::new(distorted(kind), material, formulation).unwrap(), "bottom"));
        }
    }
    for kind in [ElementKind::Tet4, ElementKind::Hex8] {
        let mesh = distort(&cuboid(&LINES, &LINES, &LINES, kind).unwrap(), [0.03, 0.02, 0.03]);
        bodies.push((ElasticBody::new(mesh, material, Formulation::Space).unwrap(), "front"));
    }
    bodies.push((ElasticBody::new(bar(&LINES).unwrap(), material, Formulation::Bar { area: 2.0 }).unwrap(), "right"));
    bodies
}

fn contact_nodes(body: &ElasticBody, side: &str) -> Vec<usize> {
    body.mesh().boundary(side).unwrap().nodes()
}

fn all_free(body: &ElasticBody) -> DofMap {
    DofMap::new(vec![None; body.nodal_dofs()]).unwrap()
}

/// Density times the integral of `field`, by the quadrature of body forces.
fn integral(body: &ElasticBody, field: impl Fn([f64; 3]) -> f64) -> f64 {
    let mut load = vec![0.0; body.nodal_dofs()];
    add_body_force_field(body, |at| [DENSITY * field(at), 0.0, 0.0], &mut load);
    load.iter().sum()
}

#[test]
fn every_form_of_the_mass_matrix_has_the_mass_and_centre_of_the_body() {
    for (body, side) in bodies() {
        for form in [MassForm::Consistent, MassForm::Lumped, MassForm::Redistributed] {
            let matrix = mass(&body, &all_free(&body), form, &contact_nodes(&body, side)).unwrap();
            let what = format!("{form:?}, {}, {}", body.mesh().kind_of(0).name(), body.formulation().name());
            let along = nodal_of(body.mesh(), |_| [1.0, 0.0, 0.0]);
            let (size, total) = (body.mesh().size(), integral(&body, |_| 1.0));
            assert!((dot(&along, &matrix.mul(&along)) - total).abs() <= SAME * total, "{what}: mass");
            // The diagonally scaled mass of quadratic elements has the right centre only if the elements are straight.
            if form == MassForm::Lumped && body.mesh().kind_of(0).is_quadratic() {
                continue;
            }
            for axis in 0..body.dimension() {
                let places = nodal_of(body.mesh(), |at| [at[axis], 0.0, 0.0]);
                let (moment, exact) = (dot(&along, &matrix.mul(&places)), integral(&body, |at| at[axis]));
                assert!((moment - exact).abs() <= 1e-11 * total * size, "{what}: {moment} and {exact} along {axis}");
            }
        }
    }
}

#[test]
fn the_consistent_mass_has_the_kinetic_energy_of_a_linear_velocity() {
    for (body, _) in bodies() {
        let matrix = mass(&body, &all_free(&body), MassForm::Consistent, &[]).unwrap();
        let velocity = nodal_of(body.mesh(), |at| [1.0 + at[0] - 2.0 * at[1] + at[2], 0.0, 0.0]);
        let exact = integral(&body, |at| (1.0 + at[0] - 2.0 * at[1] + at[2]).powi(2));
        let energy = dot(&velocity, &matrix.mul(&velocity));
        assert!((energy - exact).abs() <= SAME * exact, "{}: {energy} and {exact}", body.mesh().kind_of(0).name());
    }
}

/// Local axes at some nodes change the components of a velocity, but not its energy.
#[test]
fn kinetic_energy_does_not_depend_on_the_frames_of_nodes() {
    for (body, side) in bodies().into_iter().filter(|(body, _)| body.dimension() > 1) {
        let dimension = body.dimension();
        let inclined: &[[f64; 3]] =
            if dimension == 2 { &[[0.6, 0.8, 0.0]] } else { &[[0.6, 0.8, 0.0], [0.0, 0.0, 1.0]] };
        // Two of three nodes have local axes, of two kinds, so that all combinations of neighbours occur.
        let nodes = (0..body.mesh().nodes().len()).filter(|node| node % 3 != 0);
        let frames =
            nodes.map(|node| (node, Frame::completing(&inclined[..node % 3 % inclined.len() + 1], dimension).unwrap()));
        let turned = DofMap::with_frames(vec![None; body.nodal_dofs()], dimension, frames.collect()).unwrap();
        let velocity = nodal_of(body.mesh(), |at| [1.0 + at[1], at[0] - at[1] * at[2], 2.0 * at[0] * at[1]]);
        let local = turned.restrict(&velocity).unwrap();
        for form in [MassForm::Consistent, MassForm::Lumped, MassForm::Redistributed] {
            let of = |dofs: &DofMap| mass(&body, dofs, form, &contact_nodes(&body, side)).unwrap();
            let energy = dot(&velocity, &of(&all_free(&body)).mul(&velocity));
            let in_frames = dot(&local, &of(&turned).mul(&local));
            assert!((in_frames - energy).abs() <= SAME * energy, "{form:?}: {in_frames} and {energy}");
        }
    }
}

#[test]
fn redistributed_mass_is_zero_at_contact_nodes_and_definite_at_the_others() {
    for (body, side) in bodies() {
        let nodes = contact_nodes(&body, side);
        let matrix = mass(&body, &all_free(&body), MassForm::Redistributed, &nodes).unwrap();
        let dimension = body.dimension();
        for (dof, value) in matrix.diagonal().into_iter().enumerate() {
            assert_eq!(value == 0.0, nodes.contains(&(dof / dimension)), "dof {dof} has {value}");
        }
        let prescribed = (0..body.nodal_dofs()).map(|dof| nodes.contains(&(dof / dimension)).then_some(0.0));
        let others = DofMap::new(prescribed.collect()).unwrap();
        let inside = mass(&body, &others, MassForm::Redistributed, &nodes).unwrap();
        assert!(Cholesky::of(&inside).is_ok(), "{}", body.mesh().kind_of(0).name());
    }
}

/// Neither the density nor the unit of mass decides which mesh is too coarse: this body is as light as 1e-20 of the one
/// above.
#[test]
fn redistributed_mass_scales_bit_for_bit_with_the_density() {
    let of = |body: &ElasticBody, side| {
        mass(body, &all_free(body), MassForm::Redistributed, &contact_nodes(body, side)).unwrap()
    };
    let scale = 2.0_f64.powi(-66);
    let light = Material::new(7.0, 0.3).unwrap().with_density(scale * DENSITY).unwrap();
    for (body, side) in bodies() {
        let same = ElasticBody::new(body.mesh().clone(), light, *body.formulation()).unwrap();
        let expected =
            of(&body, side).lower().triplets().map(|(i, j, value)| (i, j, scale * value)).collect::<Vec<_>>();
        assert!(of(&same, side).lower().triplets().eq(expected), "{}", body.mesh().kind_of(0).name());
    }
}

#[test]
fn lumped_mass_is_diagonal_and_positive() {
    for (body, _) in bodies() {
        let matrix = mass(&body, &all_free(&body), MassForm::Lumped, &[]).unwrap();
        assert!(matrix.diagonal().iter().all(|&value| value > 0.0), "{}", body.mesh().kind_of(0).name());
        assert!(matrix.lower().triplets().all(|(row, column, _)| row == column));
    }
}

#[test]
fn a_mesh_too_coarse_and_a_material_without_density_are_refused() {
    let material = Material::new(1.0, 0.0).unwrap();
    let body = |material, lines: &[f64]| {
        ElasticBody::new(bar(lines).unwrap(), material, Formulation::Bar { area: 1.0 }).unwrap()
    };
    let refused = |body: &ElasticBody| {
        mass(body, &all_free(body), MassForm::Redistributed, &contact_nodes(body, "right")).unwrap_err()
    };
    assert!(matches!(
        refused(&body(material, &LINES)),
        Error::Linear(qp::LinearError::Setting { name: "density", .. })
    ));
    let heavy = material.with_density(1.0).unwrap();
    let everywhere = body(heavy, &LINES);
    let all: Vec<usize> = (0..LINES.len()).collect();
    let none_left = mass(&everywhere, &all_free(&everywhere), MassForm::Redistributed, &all).unwrap_err();
    assert!(none_left.to_string().contains("every node of a body is a contact node"), "{none_left}");
    assert!(refused(&body(heavy, &[0.0, 1.0])).to_string().contains("too coarse"));
    for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            material.with_density(wrong),
            Err(Error::Linear(qp::LinearError::Setting { name: "density", .. }))
        ));
    }
}
