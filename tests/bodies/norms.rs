//! Norms of errors, compared with integrals by hand.
//!
//! GOAL        the norms are right to four digits if the exact strain has a kink or a root inside a cell
//! MESH        two cells along each axis of the unit interval, square or cube, every element
//! CONDITIONS  u_x = (x - x0)_+^1.5, compared with c x; nu = 0, so that the energy is E eps_xx^2
//! REFERENCE   integral of (eps - c)^2 = 9/8 (1-x0)^2 - 2 c (1-x0)^1.5 + c^2, of eps^2 = 9/8 (1-x0)^2;
//!             of (u - c x)^2 = (1-x0)^4/4 - 2 c ((1-x0)^3.5/3.5 + x0 (1-x0)^2.5/2.5) + c^2/3, of u^2 = (1-x0)^4/4

use signorini::fem::{ElasticBody, ElementKind, Formulation, Material};
use signorini::scene::{cuboid, rectangle};
use support::norms::{ExactState, error_norms};

/// The norms are accurate to four digits.
const FOUR_DIGITS: f64 = 1e-4;

const ROOT: f64 = 0.37;
const SLOPE: f64 = 0.8;

fn exact([x, ..]: [f64; 3]) -> ExactState {
    let beyond = (x - ROOT).max(0.0);
    let strain = [1.5 * beyond.sqrt(), 0.0, 0.0, 0.0, 0.0, 0.0];
    ExactState { displacement: [beyond.powf(1.5), 0.0, 0.0], strain }
}

#[test]
fn a_strain_with_a_root_inside_a_cell_is_integrated_to_four_digits() {
    let lines = [0.0, 0.5, 1.0];
    let material = Material::new(3.0, 0.0).unwrap();
    let left = 1.0 - ROOT;
    let [whole, whole_l2] = [1.125 * left.powi(2), left.powi(4) / 4.0];
    let energy = whole - 2.0 * SLOPE * left.powf(1.5) + SLOPE * SLOPE;
    let moment = left.powf(3.5) / 3.5 + ROOT * left.powf(2.5) / 2.5;
    let l2 = whole_l2 - 2.0 * SLOPE * moment + SLOPE * SLOPE / 3.0;
    for kind in
        [ElementKind::T3, ElementKind::Q4, ElementKind::T6, ElementKind::Q8, ElementKind::Tet4, ElementKind::Hex8]
    {
        let (mesh, formulation) = match kind.dimension() {
            2 => (rectangle(&lines, &lines, kind).unwrap(), Formulation::PlaneStrain { thickness: 0.5 }),
            _ => (cuboid(&lines, &lines, &lines, kind).unwrap(), Formulation::Space),
        };
        let dimension = mesh.dimension();
        let linear = |at: &[f64; 3]| [SLOPE * at[0], 0.0, 0.0].into_iter().take(dimension);
        let displacement: Vec<f64> = mesh.nodes().iter().flat_map(linear).collect();
        let body = ElasticBody::new(mesh, material, formulation).unwrap();
        let errors = error_norms(&body, &displacement, exact);
        for (name, ours, square) in [("energy", errors.energy, energy / whole), ("L2", errors.l2, l2 / whole_l2)] {
            assert!((ours / square.sqrt() - 1.0).abs() < FOUR_DIGITS, "{kind:?}, {name}: {ours}, {}", square.sqrt());
        }
    }
}
