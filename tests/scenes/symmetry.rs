//! Planes of symmetry: a quarter, a half and the whole have the same answer.

use serde_json::{Value, json};
use support::scenes::{answer, build};

use support::program::Desk;

/// Difference of answers to the same problem on the same mesh: rounding times a condition number of 1e3.
const SAME: f64 = 1e-10;

/// A block [-1, 1]^2 x [0, 1], or the part that planes of symmetry define, on a spring and a support, under a ball
/// pressed by a force.
fn block(element: &str, planes: &[&str]) -> Value {
    let across = |name: &str| match planes.contains(&name) {
        true => json!({"points": [0, 1], "divisions": [2]}),
        false => json!({"points": [-1, 1], "divisions": [4]}),
    };
    let mut supports = vec![json!({"on": {"boundary": "bottom"}, "z": 0})];
    // The whole body needs these supports; for a part, the planes of symmetry replace them.
    for (axis, point) in [("x", [0, 1, 0]), ("y", [1, 0, 0])] {
        if !planes.contains(&axis) {
            supports.push(json!({"on": {"point": point}, axis: 0}));
            if axis == "x" {
                supports.push(json!({"on": {"point": [0, 1, 1]}, axis: 0}));
            }
        }
    }
    if planes.is_empty() {
        supports.push(json!({"on": {"point": [0, -1, 0]}, "x": 0}));
    }
    json!({
        "model": "space",
        "body": {"box": {"x": across("x"), "y": across("y"), "z": {"points": [0, 1], "divisions": [2]}, "element": element}},
        "material": {"young": 1000, "poisson": 0.3},
        "symmetry": planes,
        "supports": supports,
        "obstacles": [{"boundary": "top", "approach": "+z", "force": 40,
                       "shape": {"sphere": {"apex": [0, 0, 1], "radius": 5}}}],
    })
}

#[test]
fn a_quarter_and_a_half_have_the_answer_of_the_whole() {
    for element in ["hex8", "hex20"] {
        let whole = answer(&block(element, &[]));
        let travel = whole.travel(0).unwrap();
        assert!(travel > 0.0);
        for planes in [&["x"][..], &["y"], &["x", "y"]] {
            let part = answer(&block(element, planes));
            assert!((part.travel(0).unwrap() / travel - 1.0).abs() < SAME, "{element} {planes:?}");
            let (of_part, of_whole) = (part.resultants().unwrap(), whole.resultants().unwrap());
            for (ours, exact) in of_part[0].force.iter().zip(&of_whole[0].force) {
                assert!((ours - exact).abs() < SAME * 40.0, "{element} {planes:?}: {:?}", of_part[0]);
            }
            assert!((of_part[1].force[2] - 40.0).abs() < SAME * 40.0, "{:?}", of_part[1]);
            let nodes = whole.model().mesh().nodes();
            for (node, at) in part.model().mesh().nodes().iter().enumerate() {
                let same = (0..nodes.len()).find(|&other| nodes[other] == *at).unwrap();
                for axis in 0..3 {
                    let off = part.displacement()[3 * node + axis] - whole.displacement()[3 * same + axis];
                    assert!(off.abs() < SAME * travel, "{element} {planes:?}: {off:e} at {at:?}");
                }
            }
        }
    }
}

/// On a clamped bottom, each part has a horizontal force that its mirror image balances: in the whole, the forces
/// across the planes are zero.
#[test]
fn forces_across_the_planes_cancel_and_forces_along_them_add_up() {
    let mut scene = block("hex8", &["x", "y"]);
    scene["supports"][0] = json!({"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": 0});
    scene["loads"] = json!([{"traction": {"boundary": "right", "value": [5, 0, 7]}}]);
    let answer = answer(&scene);
    let all = answer.resultants().unwrap();
    let [support, loads] = ["supports[0]", "loads"].map(|of| all.iter().find(|resultant| resultant.of == of).unwrap());
    // The side of the quarter has the area 1: the whole has four such areas, two on each side.
    for (axis, expected) in [0.0, 0.0, 28.0].into_iter().enumerate() {
        assert!((loads.force[axis] - expected).abs() < SAME * 28.0, "{loads:?}");
    }
    for (axis, expected) in [0.0, 0.0, 40.0 - 28.0].into_iter().enumerate() {
        assert!((support.force[axis] - expected).abs() < SAME * 40.0, "{support:?}");
    }
    assert!(support.moment.iter().all(|moment| moment.abs() < SAME * 40.0), "{support:?}");
}

#[test]
fn the_report_names_the_whole_as_the_basis_of_forces() {
    let desk = Desk::new();
    desk.write("scene.json", block("hex8", &["x", "y"]).to_string());
    let report = desk.run(&["solve", "scene.json", "--format", "json"]).ends_with(0).json();
    assert_eq!(report["force_basis"], "of the whole body, 4 times the meshed part");
    assert!((report["contact"]["force"].as_f64().unwrap() - 40.0).abs() < 1e-8);
    // The mesh is coarse, which is warned of; cuts without supports cause no warning.
    let codes: Vec<_> = report["warnings"].as_array().unwrap().iter().map(|warning| warning["code"].clone()).collect();
    assert_eq!(codes, ["mesh-dependent"]);
}

#[test]
fn planes_of_symmetry_on_which_the_body_does_not_end_are_refused() {
    let refused = |change: &dyn Fn(&mut Value), phrases: &[&str]| {
        let mut scene = block("hex8", &["x"]);
        change(&mut scene);
        let error = build(&scene).unwrap_err().to_string();
        phrases.iter().for_each(|phrase| assert!(error.contains(phrase), "{error}"));
    };
    refused(
        &|scene| scene["body"]["box"]["x"]["points"] = json!([2, 3]),
        &["symmetry[0]", "x = 2 and x = 3", "plane of symmetry lies at 0"],
    );
    refused(&|scene| scene["symmetry"] = json!(["x", "x"]), &["symmetry[1]", "named twice"]);
    let disc = json!({
        "body": {"disc": {"radius": 1, "zone": {"width": 0.2, "divisions": 2}}},
        "material": {"young": 1, "poisson": 0}, "symmetry": ["x"],
    });
    let error = build(&disc).unwrap_err().to_string();
    assert!(error.contains("symmetry[0]") && error.contains("does not end flat at x = -1"), "{error}");
}
