//! GOAL: every element passes these tests in every formulation that it fits: patch tests on distorted meshes,
//! rigid-body modes, stiffness against internal force, mean dilatation.
//!
//! MESH: a bar of 5 cells, a 2 x 1 rectangle of 4 x 3 cells, a 2 x 1 x 1.5 box of 3 x 3 x 2 cells; inner nodes are
//! moved by up to a fifth of a cell; E = 7, nu = 0.3.
//!
//! REFERENCE: the prescribed field itself, and its stress by Hooke's law.

use signorini::fem::{self, DofMap, ElasticBody, ElementKind, Formulation, Integration, Material, Mesh, Stress};
use signorini::scene::{bar, cuboid, rectangle};
use support::bodies::{difference, distort, distorted, largest, nodal_of, solve_held};
use support::norms::{ExactState, error_norms};

/// Rounding of a few thousand operations on numbers of order one.
const ROUNDING: f64 = 1e-12;

const STRAIN: Formulation = Formulation::PlaneStrain { thickness: 0.5 };
const STRESS: Formulation = Formulation::PlaneStress { thickness: 0.5 };
const BAR: Formulation = Formulation::Bar { area: 0.25 };

fn mesh(kind: ElementKind) -> Mesh {
    match kind.dimension() {
        1 => distort(&bar(&[0.0, 0.4, 0.8, 1.2, 1.6, 2.0]).unwrap(), [0.08, 0.0, 0.0]),
        2 => distorted(kind),
        _ => {
            // Quadratic meshes have fewer cells; their nodes make the curved edges that the test needs.
            let along: &[f64] = if kind.is_quadratic() { &[0.0, 0.9, 2.0] } else { &[0.0, 0.7, 1.4, 2.0] };
            let regular = cuboid(along, &[0.0, 0.3, 0.7, 1.0], &[0.0, 0.5, 1.0, 1.5], kind).unwrap();
            let reach = [0.1, 0.05, 0.08];
            distort(&regular, if kind.is_quadratic() { reach.map(|length| length / 4.0) } else { reach })
        }
    }
}

/// The orthotropic material with the constants of E = 7, nu = 0.3; the direction of its axes has no effect.
fn twin(formulation: &Formulation) -> Material {
    let material = Material::orthotropic([7.0; 3], [0.3; 3], [7.0 / 2.6; 3]).unwrap();
    let (first, second) = match formulation {
        Formulation::Space => ([1.0, 2.0, -1.0], [0.3, 1.0, 2.0]),
        _ => ([0.8, 0.6, 0.0], [-0.6, 0.8, 0.0]),
    };
    material.along(first, second).unwrap()
}

/// The formulations that an element fits. A new element does not compile here until it is tested in one, nor in
/// `degree` below until its rate is stated.
fn formulations(kind: ElementKind) -> &'static [Formulation] {
    match kind.dimension() {
        1 => &[BAR],
        2 => &[STRAIN, STRESS, Formulation::Axisymmetric],
        _ => &[Formulation::Space],
    }
}

/// The degree of the polynomials that an element has in full: the rate of its error in energy.
fn degree(kind: ElementKind) -> f64 {
    if kind.is_quadratic() { 2.0 } else { 1.0 }
}

/// Every element in every formulation, with an isotropic and an orthotropic material, and with mean dilatation if the
/// element has it.
pub fn all() -> Vec<(String, ElasticBody)> {
    let cases = ElementKind::ALL.into_iter().flat_map(|kind| formulations(kind).iter().map(move |&of| (kind, of)));
    let mut found = Vec::new();
    for (kind, formulation) in cases {
        let body = ElasticBody::new(mesh(kind), Material::new(7.0, 0.3).unwrap(), formulation).unwrap();
        if let Ok(mean) = body.clone().with_integration(Integration::MeanDilatation) {
            found.push((format!("{kind:?} {formulation:?} mean dilatation"), mean));
        }
        let everywhere: Vec<usize> = (0..body.mesh().element_count()).collect();
        let turned = body.clone().with_material(&everywhere, twin(&formulation)).unwrap();
        found.push((format!("{kind:?} {formulation:?} orthotropic"), turned));
        found.push((format!("{kind:?} {formulation:?}"), body));
    }
    assert_eq!(found.len(), 37);
    found
}

/// A displacement of constant strain; in an axisymmetric body radius and height are stretched without shear.
fn linear(formulation: &Formulation) -> fn([f64; 3]) -> [f64; 3] {
    match formulation {
        Formulation::Axisymmetric => |[x, y, _]| [0.03 * x, 0.1 - 0.05 * y, 0.0],
        Formulation::Space => |[x, y, z]| {
            [
                0.1 + 0.02 * x - 0.03 * y + 0.01 * z,
                0.05 * x + 0.04 * y - 0.02 * z,
                -0.2 + 0.01 * x + 0.03 * y - 0.06 * z,
            ]
        },
        _ => |[x, y, _]| [0.1 + 0.02 * x - 0.03 * y, -0.2 + 0.05 * x + 0.04 * y, 0.0],
    }
}

/// `[xx, yy, zz, xy, yz, zx]` of the field above by Hooke's law in three dimensions.
fn hooke(formulation: &Formulation) -> [f64; 6] {
    let (e, nu) = (7.0, 0.3);
    let (lambda, mu) = (e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), e / (2.0 * (1.0 + nu)));
    let strain = match formulation {
        Formulation::Bar { .. } => [0.02, -nu * 0.02, -nu * 0.02, 0.0, 0.0, 0.0],
        Formulation::PlaneStrain { .. } => [0.02, 0.04, 0.0, 0.01, 0.0, 0.0],
        Formulation::PlaneStress { .. } => [0.02, 0.04, -lambda * 0.06 / (lambda + 2.0 * mu), 0.01, 0.0, 0.0],
        Formulation::Axisymmetric => [0.03, -0.05, 0.03, 0.0, 0.0, 0.0],
        Formulation::Space => [0.02, 0.04, -0.06, 0.01, 0.005, 0.01],
    };
    let trace = strain[0] + strain[1] + strain[2];
    [0, 1, 2, 3, 4, 5].map(|i| 2.0 * mu * strain[i] + if i < 3 { lambda * trace } else { 0.0 })
}

fn components(stress: &Stress) -> [f64; 6] {
    [stress.sigma_xx, stress.sigma_yy, stress.sigma_zz, stress.sigma_xy, stress.sigma_yz, stress.sigma_zx]
}

/// The gradient of the harmonic function x^3 y - x y^3: neither a volume nor a body force changes, so that it is in
/// balance in any material and any model without an axis. In a bar the displacement is x^2.
fn harmonic([x, y, _]: [f64; 3], dimension: usize) -> ExactState {
    if dimension == 1 {
        return ExactState { displacement: [x * x, 0.0, 0.0], strain: [2.0 * x, 0.0, 0.0, 0.0, 0.0, 0.0] };
    }
    let displacement = [3.0 * x * x * y - y * y * y, x * x * x - 3.0 * x * y * y, 0.0];
    ExactState { displacement, strain: [6.0 * x * y, -6.0 * x * y, 0.0, 3.0 * (x * x - y * y), 0.0, 0.0] }
}

/// The error in energy on `cells` cells along each side of a unit cube, with the exact displacement on its surface. The
/// answer of a bar is exact at its nodes.
fn error_in_energy(kind: ElementKind, formulation: Formulation, cells: usize) -> f64 {
    let along: Vec<f64> = (0..=cells).map(|line| line as f64 / cells as f64).collect();
    let mesh = match kind.dimension() {
        1 => bar(&along),
        2 => rectangle(&along, &along, kind),
        _ => cuboid(&along, &along, &along, kind),
    };
    let body = ElasticBody::new(mesh.unwrap(), Material::new(7.0, 0.3).unwrap(), formulation).unwrap();
    let dimension = kind.dimension();
    let exact = |at: [f64; 3]| harmonic(at, dimension);
    let field = nodal_of(body.mesh(), |at| exact(at).displacement);
    let on_surface = |dof: usize| {
        let at = body.mesh().nodes()[dof / dimension];
        dimension == 1 || at[..dimension].iter().any(|&coordinate| coordinate == 0.0 || coordinate == 1.0)
    };
    let solved = solve_held(&body, &field, on_surface, &vec![0.0; field.len()]);
    error_norms(&body, &solved, exact).energy
}

/// A wrong shape function, quadrature or numbering costs an order.
#[test]
fn the_error_in_energy_of_every_element_falls_with_the_degree_of_its_polynomials() {
    // Measured on these meshes: at most 0.008.
    const OFF: f64 = 0.05;
    for kind in ElementKind::ALL {
        for &formulation in formulations(kind).iter().filter(|of| !of.is_axisymmetric()) {
            let cells = if kind.dimension() == 3 { 3 } else { 6 };
            let [coarse, fine] = [cells, 2 * cells].map(|cells| error_in_energy(kind, formulation, cells));
            let rate = (coarse / fine).log2();
            assert!((rate - degree(kind)).abs() < OFF, "{kind:?} {formulation:?}: {coarse:e} {fine:e}, rate {rate}");
        }
    }
}

#[test]
fn inner_nodes_follow_a_field_of_constant_strain_that_is_prescribed_on_the_surface() {
    for (name, body) in all() {
        let field = nodal_of(body.mesh(), linear(body.formulation()));
        let (low, high) = body.mesh().extent();
        let on_surface = |dof: usize| {
            let at = body.mesh().nodes()[dof / body.dimension()];
            (0..body.dimension()).any(|axis| at[axis] == low[axis] || at[axis] == high[axis])
        };
        let free = (0..field.len()).filter(|&dof| !on_surface(dof)).count();
        let solved = solve_held(&body, &field, on_surface, &vec![0.0; field.len()]);
        let error = difference(&solved, &field);
        assert!(free >= 4 && error < ROUNDING, "{name}: {error:e}");
    }
}

#[test]
fn stress_of_constant_strain_is_exact_in_elements_and_at_nodes() {
    for (name, body) in all() {
        let displacement = nodal_of(body.mesh(), linear(body.formulation()));
        let field = fem::stress(&body, &displacement).unwrap();
        let expected = hooke(body.formulation());
        for stress in field.elements.iter().chain(&field.nodes) {
            let error = difference(&components(stress), &expected);
            assert!(error < ROUNDING, "{name}: {error:e} {stress:?}");
        }
    }
}

#[test]
fn stress_that_is_linear_is_exact_at_the_nodes_of_quadratic_elements() {
    // u_x = x^2/2: eps_xx = x.
    let formulation = Formulation::PlaneStress { thickness: 1.0 };
    for kind in [ElementKind::T6, ElementKind::Q8] {
        let mesh = rectangle(&[0.0, 0.2, 1.0], &[0.0, 0.7, 1.0], kind).unwrap();
        let body = ElasticBody::new(mesh, Material::new(8.0, 0.25).unwrap(), formulation).unwrap();
        let displacement = nodal_of(body.mesh(), |[x, ..]| [x * x / 2.0, 0.0, 0.0]);
        let along = 8.0 / (1.0 - 0.0625);
        for (stress, [x, ..]) in fem::stress(&body, &displacement).unwrap().nodes.iter().zip(body.mesh().nodes()) {
            let expected = [along * x, 0.25 * along * x, 0.0, 0.0, 0.0, 0.0];
            assert!(difference(&components(stress), &expected) < ROUNDING, "{kind:?} {stress:?}");
        }
    }
}

#[test]
fn rigid_body_modes_cause_no_force_and_a_radial_motion_does() {
    for (name, body) in all() {
        type Motion = (fn([f64; 3]) -> [f64; 3], f64);
        let motions: &[Motion] = match body.formulation() {
            Formulation::Bar { .. } => &[(|_| [3.0, 0.0, 0.0], 0.0)],
            Formulation::Axisymmetric => &[(|_| [0.0, -2.0, 0.0], 0.0)],
            Formulation::Space => &[
                (|_| [3.0, 0.0, 0.0], 0.0),
                (|_| [0.0, -2.0, 1.0], 0.0),
                (|[_, y, z]| [0.0, -z, y], ROUNDING),
                (|[x, _, z]| [z, 0.0, -x], ROUNDING),
                (|[x, y, _]| [-y, x, 0.0], ROUNDING),
            ],
            _ => &[(|_| [3.0, -2.0, 0.0], 0.0), (|[x, y, _]| [-y, x, 0.0], ROUNDING)],
        };
        for (motion, allowed) in motions {
            let force = fem::internal_force(&body, &nodal_of(body.mesh(), motion)).unwrap();
            assert!(largest(&force) <= *allowed, "{name}: {:e}", largest(&force));
        }
        if body.formulation().is_axisymmetric() {
            let force = fem::internal_force(&body, &nodal_of(body.mesh(), |_| [1.0, 0.0, 0.0])).unwrap();
            assert!(largest(&force) > 1.0, "{name}");
        }
    }
}

#[test]
fn assembled_stiffness_and_internal_force_agree() {
    for (name, body) in all() {
        let field = |[x, y, z]: [f64; 3]| [(3.0 * x + y).sin(), (x - 2.0 * y + z).cos(), (x + y * z).sin()];
        let displacement = nodal_of(body.mesh(), field);
        let dofs = DofMap::new(vec![None; displacement.len()]).unwrap();
        let product = fem::stiffness(&body, &dofs).unwrap().mul(&displacement);
        let force = fem::internal_force(&body, &displacement).unwrap();
        let error = difference(&product, &force);
        assert!(error < ROUNDING * largest(&force), "{name}: {error:e}");
    }
}

#[test]
fn bodies_of_any_two_elements_and_integrations_side_by_side_keep_their_forces_and_stresses() {
    let all = all();
    let pairs = (1..all.len()).flat_map(|second| (0..second).map(move |first| (first, second)));
    let mut count = 0;
    for ((name, own), (of_other, other)) in pairs.map(|(first, second)| (&all[first], &all[second])) {
        if own.formulation() != other.formulation() {
            continue;
        }
        count += 1;
        let both = own.clone().beside(other, "other").unwrap();
        let field = |[x, y, z]: [f64; 3]| [(3.0 * x + y).sin(), (x - 2.0 * y + z).cos(), (x + y * z).sin()];
        let [of_own, of_other_body, of_both] = [own, other, &both].map(|body| {
            let displacement = nodal_of(body.mesh(), field);
            let dofs = DofMap::new(vec![None; displacement.len()]).unwrap();
            // Entry by entry: the sums of a product of a dense matrix have an order of their own.
            let mut product = vec![0.0; displacement.len()];
            for (row, column, value) in fem::stiffness(body, &dofs).unwrap().lower().triplets() {
                product[row] += value * displacement[column];
            }
            let stress = fem::stress(body, &displacement).unwrap();
            (fem::internal_force(body, &displacement).unwrap(), product, stress.elements, stress.nodes)
        });
        // Bit by bit.
        let name = format!("{name} and {of_other}");
        assert_eq!(of_both.0, [of_own.0, of_other_body.0].concat(), "{name}");
        assert_eq!(of_both.1, [of_own.1, of_other_body.1].concat(), "{name}");
        assert_eq!(of_both.2, [of_own.2, of_other_body.2].concat(), "{name}");
        assert_eq!(of_both.3, [of_own.3, of_other_body.3].concat(), "{name}");
    }
    assert!(count > 100, "{count}");
}

#[test]
fn stiffness_with_supports_is_the_submatrix_of_the_free_dofs() {
    for (name, body) in all() {
        let count = body.nodal_dofs();
        let full = fem::stiffness(&body, &DofMap::new(vec![None; count]).unwrap()).unwrap();
        let held = |dof: usize| dof % 7 == 3 || dof.is_multiple_of(5);
        let dofs = DofMap::new((0..count).map(|dof| held(dof).then_some(0.1)).collect()).unwrap();
        let part = fem::stiffness(&body, &dofs).unwrap();
        let of_free = |(row, column, value)| Some((dofs.number(row)?, dofs.number(column)?, value));
        let expected: Vec<_> = full.lower().triplets().filter_map(of_free).collect();
        assert_eq!(part.lower().triplets().collect::<Vec<_>>(), expected, "{name}");
    }
}

#[test]
fn only_rigid_body_modes_have_zero_energy() {
    for (name, body) in all() {
        let dofs = DofMap::new(vec![None; body.nodal_dofs()]).unwrap();
        let stiffness = fem::stiffness(&body, &dofs).unwrap();
        let mut dense = nalgebra::DMatrix::zeros(body.nodal_dofs(), body.nodal_dofs());
        for (row, column, value) in stiffness.lower().triplets() {
            (dense[(row, column)], dense[(column, row)]) = (value, value);
        }
        let energies = dense.symmetric_eigenvalues();
        let free = energies.iter().filter(|&&energy| energy.abs() < 1e-9 * energies.max()).count();
        let rigid = match body.formulation() {
            Formulation::Bar { .. } | Formulation::Axisymmetric => 1,
            Formulation::Space => 6,
            _ => 3,
        };
        assert!(free == rigid && energies.min() > -1e-9, "{name}: {free} motions without energy");
    }
}

#[test]
fn mean_dilatation_is_refused_by_name_for_elements_without_it() {
    for (kind, formulation, phrase) in [
        (ElementKind::T3, STRAIN, "not for T3"),
        (ElementKind::Q8, STRAIN, "not for Q8"),
        (ElementKind::Tet4, Formulation::Space, "not for Tet4"),
        (ElementKind::Q4, STRESS, "plane stress"),
    ] {
        let body = ElasticBody::new(mesh(kind), Material::new(1.0, 0.3).unwrap(), formulation).unwrap();
        let error = body.with_integration(Integration::MeanDilatation).unwrap_err().to_string();
        assert!(error.contains(phrase), "{error}");
    }
}

/// The settlement of the loaded corner of a block under a pressure on the left half of its top; supports hold its
/// bottom, left and right sides; nu = 0.4999.
fn sinking(mesh: Mesh, formulation: Formulation, integration: Integration) -> f64 {
    let material = Material::new(1.0, 0.4999).unwrap();
    let body = ElasticBody::new(mesh, material, formulation).unwrap().with_integration(integration).unwrap();
    let dimension = body.dimension();
    let held = |dof: usize| {
        let (at, axis) = (body.mesh().nodes()[dof / dimension], dof % dimension);
        at[1] == 0.0 || ((at[0] == 0.0 || at[0] == 1.0) && axis == 0) || axis == 2
    };
    let top = if dimension == 2 { "top" } else { "back" };
    let mut load = vec![0.0; body.nodal_dofs()];
    let half = |[x, ..]: [f64; 3], normal: [f64; 3]| normal.map(|n| if x < 0.5 { -n } else { 0.0 });
    fem::add_traction_field(&body, body.mesh().boundary(top).unwrap(), half, &mut load);
    let displacement = solve_held(&body, &vec![0.0; load.len()], held, &load);
    let corner = body.mesh().nearest_node([0.0, 1.0, 0.0]).unwrap().0;
    -displacement[dimension * corner + 1]
}

#[test]
fn mean_dilatation_does_not_lock_and_the_standard_element_does() {
    let lines = |cells: usize| (0..=cells).map(|i| i as f64 / cells as f64).collect::<Vec<f64>>();
    let plane = |cells: usize, kind| rectangle(&lines(cells), &lines(cells), kind).unwrap();
    let formulation = Formulation::PlaneStrain { thickness: 1.0 };
    // The reference has quadratic elements on a mesh four times as fine; the next finer mesh changes it by 0.3 %.
    let exact = sinking(plane(32, ElementKind::Q8), formulation, Integration::Standard);
    let free = sinking(plane(8, ElementKind::Q4), formulation, Integration::MeanDilatation);
    let locked = sinking(plane(8, ElementKind::Q4), formulation, Integration::Standard);
    assert!((free / exact - 1.0).abs() < 0.05, "mean dilatation {free}, reference {exact}");
    assert!(locked / exact < 0.8, "standard {locked}, reference {exact}");
    // A layer of hexahedra between two planes is in plane strain, node by node.
    let layer = cuboid(&lines(8), &lines(8), &[0.0, 1.0], ElementKind::Hex8).unwrap();
    let in_space = sinking(layer, Formulation::Space, Integration::MeanDilatation);
    assert!((in_space / free - 1.0).abs() < 1e-9, "{in_space} and {free}");
}

#[test]
fn revolved_bodies_have_the_volume_of_the_full_circle_and_refuse_negative_radii() {
    for kind in [ElementKind::T3, ElementKind::T6, ElementKind::Q4, ElementKind::Q8] {
        let body = ElasticBody::new(mesh(kind), Material::new(1.0, 0.3).unwrap(), Formulation::Axisymmetric).unwrap();
        let mut load = vec![0.0; body.nodal_dofs()];
        fem::add_body_force(&body, [0.0, 1.0, 0.0], &mut load);
        let volume: f64 = load.iter().sum();
        assert!((volume - std::f64::consts::PI * 4.0).abs() < ROUNDING, "{kind:?}: {volume}");
    }
    let mesh = rectangle(&[-0.5, 1.0], &[0.0, 1.0], ElementKind::Q4).unwrap();
    let error = ElasticBody::new(mesh, Material::new(1.0, 0.3).unwrap(), Formulation::Axisymmetric).unwrap_err();
    assert!(error.to_string().contains("node 0 lies at the radius x = -5e-1"), "{error}");
}

#[test]
fn principal_stresses_in_space_are_ordered_and_agree_with_an_example_by_hand() {
    // [[2, 1, 0], [1, 2, 0], [0, 0, -5]]: 3, 1, -5.
    let stress = Stress::in_space([2.0, 2.0, -5.0, 1.0, 0.0, 0.0]);
    let found = [stress.sigma_1, stress.sigma_2, stress.sigma_3];
    assert!(difference(&found, &[3.0, 1.0, -5.0]) < 1e-14, "{found:?}");
    // von Mises: (2^2 + 6^2 + 8^2)/2 = 52.
    assert!((stress.von_mises - 52_f64.sqrt()).abs() < 1e-14);
}
