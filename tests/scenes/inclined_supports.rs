//! GOAL: rollers on inclined planes, compared with Lagrange multipliers in the coordinate axes: displacement, contact
//! forces, reactions along the normals, balance.

use signorini::{Error, qp, solve_qp};
use std::collections::BTreeMap;

use serde_json::{Value, json};
use support::rollers::{ROUNDING, check, cube, square};
use support::scenes::built;

#[test]
fn rollers_in_the_plane_agree_with_lagrange_multipliers() {
    // Two rollers that share a corner: their two oblique normals fix it completely.
    let supports = json!([
        {"on": {"boundary": "bottom"}, "normal": [3, -4], "value": 0.01},
        {"on": {"boundary": "left"}, "normal": [-2, -0.3], "value": -0.02},
    ]);
    for element in ["t3", "t6", "q4", "q8"] {
        for model in ["plane-strain", "plane-stress"] {
            let model = check(&square(model, element, supports.clone()));
            let corner = (0..2).filter(|&dof| model.dofs().number(dof).is_some()).count();
            assert_eq!((corner, model.dofs().frame(0)), (0, None), "the corner is fixed completely, without a frame");
        }
    }
}

#[test]
fn a_normal_combines_with_coordinates_in_one_support_and_at_one_node() {
    check(&square(
        "plane-strain",
        "q4",
        json!([
            {"on": {"boundary": "bottom"}, "normal": [1, -1]},
            {"on": {"point": [1, 0]}, "x": 0.013},
            {"on": {"point": [0, 1]}, "y": -0.01, "normal": [1, 0.2], "value": 0.02},
            {"on": {"point": [0, 0]}, "x": 0, "y": 0},
        ]),
    ));
    check(&cube(
        "hex8",
        json!([
            {"on": {"boundary": "bottom"}, "normal": [0.1, -0.2, -1], "value": 0.01},
            {"on": {"boundary": "front"}, "y": 0.002},
            {"on": {"point": [0, 1, 1]}, "x": 0, "normal": [-1, 0.4, 0.2], "value": 0.003},
            {"on": {"point": [0, 0, 1]}, "normal": [-1, 0.4, 0.2], "value": 0.003},
        ]),
    ));
}

#[test]
fn rollers_in_space_agree_with_lagrange_multipliers() {
    // Edges have two oblique normals, the corner at the origin has three.
    let supports = json!([
        {"on": {"boundary": "bottom"}, "normal": [0.2, -0.3, -1], "value": 0.01},
        {"on": {"boundary": "left"}, "normal": [-1, 0.4, 0.1], "value": 0.02},
        {"on": {"boundary": "front"}, "normal": [0.1, -1, 0.3]},
    ]);
    for element in ["tet4", "hex8"] {
        let model = check(&cube(element, supports.clone()));
        let free_at = |node: usize| (3 * node..3 * node + 3).filter(|&dof| model.dofs().number(dof).is_some()).count();
        let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
        (0..27).for_each(|node| *counts.entry(free_at(node)).or_default() += 1);
        assert_eq!(counts, BTreeMap::from([(0, 1), (1, 6), (2, 12), (3, 8)]), "{element}");
    }
}

#[test]
fn a_body_of_revolution_in_a_conical_support_agrees_with_lagrange_multipliers() {
    for element in ["q4", "t6"] {
        let mut scene = square("axisymmetric", element, json!([{"on": {"boundary": "bottom"}, "normal": [1, -2]}]));
        scene["loads"] = json!([{"pressure": {"boundary": "right", "value": 0.02}}, {"body-force": [0, -0.01]}]);
        check(&scene);
        // On the axis the cone fixes the node completely: u_x = 0 and (1, -2) . u = 0.02 sqrt(5).
        scene["supports"][0]["value"] = json!(0.02);
        let model = check(&scene);
        let nodal = model.nodal_displacement(&vec![0.0; model.problem().dofs()]).unwrap();
        assert_eq!(nodal[0], 0.0);
        assert!((nodal[1] + 0.01 * 5_f64.sqrt()).abs() < ROUNDING, "{}", nodal[1]);
    }
}

#[test]
fn a_node_may_have_a_roller_and_a_contact_row() {
    // The nodes of the top are on a roller and under the parabola, with oblique rows.
    let mut scene = square(
        "plane-strain",
        "q4",
        json!([
            {"on": {"boundary": "left"}, "x": 0},
            {"on": {"boundary": "bottom"}, "normal": [0.3, -1], "value": -0.03},
            {"on": {"point": [0.75, 1]}, "normal": [1, 0.5], "value": 0.001},
            {"on": {"point": [0.5, 1]}, "normal": [1, -0.2], "value": -0.002},
        ]),
    );
    scene["obstacles"][0]["shape"]["parabola"]["apex"] = json!([0.6, 0.98]);
    let model = check(&scene);
    let pressed = solve_qp(model.problem()).unwrap();
    for x in [0.5, 0.75] {
        let row = model.rows().iter().position(|row| model.mesh().nodes()[row.node] == [x, 1.0, 0.0]).unwrap();
        assert!(pressed.multiplier[row] < 0.0, "the row of the roller at x = {x} is open");
        assert_eq!(
            model.problem().contact().transposed().column(row).count(),
            1,
            "the row has entries at one free dof"
        );
    }
}

/// The top of the square is on a roller with the normal (3, 4), under a plane with the same normal at a distance.
fn parallel(distance: f64, value: f64) -> Value {
    let mut scene = square(
        "plane-strain",
        "q4",
        json!([
            {"on": {"boundary": "bottom"}, "x": 0, "y": 0},
            {"on": {"boundary": "top"}, "normal": [3, 4], "value": value},
        ]),
    );
    let point = [1.0 + 0.6 * distance, 1.0 + 0.8 * distance];
    scene["obstacles"][0]["shape"] = json!({"plane": {"point": point, "normal": [6, 8]}});
    scene
}

#[test]
fn a_row_along_the_normal_of_a_roller_is_dropped_or_infeasible() {
    // The plane is nearest to the corner (1, 1), at a distance of 0.05; the roller moves the top by 0.04 towards it.
    assert_eq!(check(&parallel(0.05, 0.04)).rows().len(), 0);
    let model = built(&parallel(0.05, 0.06));
    assert_eq!(model.rows().len(), 1, "only the corner penetrates");
    let error = model.explain(solve_qp(model.problem()).unwrap_err());
    let Error::Qp(qp::Error::Infeasible { reason, .. }) = &error else { panic!("{error}") };
    assert!(reason.contains("at (1, 1)") && reason.contains("obstacles[0]"), "{reason}");
}
