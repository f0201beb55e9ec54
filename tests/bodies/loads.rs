//! Consistent loads: nodal shares, totals, tributary areas.

use signorini::fem::{ElementKind, Formulation, Material, add_body_force, add_traction, tributary_areas};
use signorini::scene::rectangle;
use support::bodies::{VARIANTS, distorted_body};

const ROUNDING: f64 = 1e-14;

fn one_edge_body(kind: ElementKind) -> signorini::fem::ElasticBody {
    let mesh = rectangle(&[0.0, 2.0], &[0.0, 1.0], kind).unwrap();
    let formulation = Formulation::PlaneStress { thickness: 0.25 };
    signorini::fem::ElasticBody::new(mesh, Material::new(1.0, 0.0).unwrap(), formulation).unwrap()
}

#[test]
fn each_node_of_a_loaded_edge_gets_one_half() {
    for kind in [ElementKind::T3, ElementKind::Q4] {
        let body = one_edge_body(kind);
        let mut load = vec![0.0; 8];
        add_traction(&body, body.mesh().boundary("top").unwrap(), [3.0, -8.0, 0.0], &mut load);
        // The edge has length 2, the thickness is 1/4: the total is (1.5, -4); the top nodes are 2 and 3.
        assert_eq!(load, [0.0, 0.0, 0.0, 0.0, 0.75, -2.0, 0.75, -2.0]);
    }
}

#[test]
fn a_body_force_gives_a_quarter_to_each_corner_of_a_q4_and_a_third_of_a_t3() {
    for (kind, shares) in [
        (ElementKind::Q4, [0.25, 0.25, 0.25, 0.25]),
        // Both triangles contain the nodes 0 and 3 of the grid; each has half the area.
        (ElementKind::T3, [1.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0, 1.0 / 3.0]),
    ] {
        let body = one_edge_body(kind);
        let mut load = vec![0.0; 8];
        add_body_force(&body, [0.0, -10.0, 0.0], &mut load);
        for (node, share) in shares.iter().enumerate() {
            assert_eq!(load[2 * node], 0.0);
            assert!((load[2 * node + 1] + 10.0 * 2.0 * 0.25 * share).abs() < ROUNDING, "{kind:?} {load:?}");
        }
    }
}

#[test]
fn total_forces_do_not_depend_on_the_mesh() {
    for (kind, state) in VARIANTS {
        let body = distorted_body(kind, state);
        let mut load = vec![0.0; 2 * body.mesh().nodes().len()];
        add_traction(&body, body.mesh().boundary("right").unwrap(), [2.0, 1.0, 0.0], &mut load);
        add_body_force(&body, [0.5, -3.0, 0.0], &mut load);
        let total = |axis: usize| load.iter().skip(axis).step_by(2).sum::<f64>();
        // The area of the side is 1 x 0.5, the volume 2 x 1 x 0.5.
        assert!((total(0) - (2.0 * 0.5 + 0.5)).abs() < ROUNDING, "{kind:?}");
        assert!((total(1) - (0.5 - 3.0)).abs() < ROUNDING, "{kind:?}");
    }
}

#[test]
fn tributary_areas_are_half_the_neighbouring_edges_and_sum_to_the_boundary() {
    let mesh = rectangle(&[0.0, 1.0, 4.0, 6.0], &[0.0, 1.0], ElementKind::Q4).unwrap();
    let formulation = Formulation::PlaneStress { thickness: 2.0 };
    let body = signorini::fem::ElasticBody::new(mesh, Material::new(1.0, 0.0).unwrap(), formulation).unwrap();
    let areas = tributary_areas(&body, body.mesh().boundary("top").unwrap());
    assert_eq!(areas, [(4, 1.0), (5, 4.0), (6, 5.0), (7, 2.0)]);
    assert_eq!(areas.iter().map(|area| area.1).sum::<f64>(), 12.0);
}
