//! Scenes and problems that are probably mistakes: each is refused, or answered with a warning that has a code, numbers
//! and a remedy.

use crate::verify::verify;
use serde_json::{Value, json};
use support::cases;
use support::program::{Desk, Problem, Run, examples, scene, vector};

/// The report of `solve` for a scene, which must end with exit code 0.
fn solved(scene: &Value) -> (Value, String) {
    let desk = Desk::new();
    desk.write("scene.json", scene.to_string());
    let report = desk.run(&["solve", "scene.json", "--format", "json"]).ends_with(0).json();
    (report, desk.run(&["solve", "scene.json"]).ends_with(0).stdout)
}

fn refused(scene: &Value, files: &[(&str, &str)]) -> (Run, String) {
    let desk = Desk::new();
    desk.write("scene.json", scene.to_string());
    files.iter().for_each(|(name, text)| desk.write(name, text));
    let code = desk.run(&["solve", "scene.json", "--format", "json"]).ends_with(1).json()["code"].to_string();
    (desk.run(&["solve", "scene.json"]).ends_with(1), code)
}

/// The message of the only warning, which must have the code `code`; the text report must contain it too.
#[track_caller]
fn warned((report, text): &(Value, String), code: &str) -> String {
    let warnings = report["warnings"].as_array().expect("warnings");
    let warning = warnings.iter().find(|warning| warning["code"] == code).unwrap_or_else(|| panic!("{warnings:?}"));
    let message = warning["message"].as_str().unwrap();
    let one_line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(one_line.contains(message), "{one_line} does not contain {message}");
    message.to_string()
}

/// A negative gap prescribes an indentation: the report names its depth and place, but warns of nothing.
#[test]
fn an_overlap_before_contact_is_named_with_its_depth_and_place() {
    let mut scene = scene();
    scene["loads"] = json!([]);
    let overlap = |scene: &Value| {
        let (report, text) = solved(scene);
        let line = text.lines().find(|line| line.contains("before contact node ")).map(|line| line.trim().to_string());
        (report["warnings"].to_string().contains("before contact"), line)
    };
    scene["gap"] = json!(0.25);
    assert_eq!(overlap(&scene), (false, None));
    scene["gap"] = json!(-0.01);
    let (is_warning, line) = overlap(&scene);
    let line = line.expect("a line on the overlap");
    assert!(!is_warning && line.ends_with("lies 1.000e-2 m inside obstacles[0]"), "{line}");
}

/// A deck with reduced integration: the report names the line.
#[test]
fn a_deck_that_is_answered_in_another_way_is_named_with_its_line() {
    let desk = Desk::new();
    let deck = std::fs::read_to_string(support::root().join("tests/faults/stack.inp")).unwrap();
    desk.write("stack.inp", deck.replace("C3D8I", "C3D8R"));
    let report = desk.run(&["solve", "stack.inp", "--format", "json"]).ends_with(0).json();
    let text = desk.run(&["solve", "stack.inp"]).ends_with(0).stdout;
    let message = warned(&(report, text), "deck");
    assert!(message.contains("stack.inp:23: C3D8R is answered by Hex8"), "{message}");
}

/// A cube whose node 7 is pushed in: its Jacobian is negative there, and positive at all points of integration.
#[test]
fn an_element_that_is_folded_at_a_corner_alone_is_solved_and_named() {
    let desk = Desk::new();
    desk.write(
        "cube.inp",
        "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, .6, .6, .6\n8, 0, 1, 1\n\
         *ELEMENT, TYPE=C3D8, ELSET=E\n31, 1, 2, 3, 4, 5, 6, 7, 8\n*MATERIAL, NAME=M\n*ELASTIC\n200., 0.3\n\
         *SOLID SECTION, ELSET=E, MATERIAL=M\n*BOUNDARY\n1, 1, 3\n2, 1, 3\n3, 1, 3\n4, 1, 3\n\
         *STEP\n*STATIC\n*DLOAD\nE, P2, 1.\n*END STEP\n",
    );
    let report = desk.run(&["solve", "cube.inp", "--format", "json"]).ends_with(0).json();
    let text = desk.run(&["solve", "cube.inp"]).ends_with(0).stdout;
    let message = warned(&(report, text), "folded-corner");
    assert!(
        message.contains("the Jacobian determinant of element 31 is -2.50e-2 at its node at [0.6, 0.6, 0.6]"),
        "{message}"
    );
}

/// The block lies below its obstacle, but the scene says that the obstacle approaches from above: its closed nodes
/// would be in tension.
#[test]
fn an_obstacle_that_pulls_is_refused() {
    let mut scene = scene();
    scene["obstacles"][0] =
        json!({"boundary": "top", "approach": "-y", "shape": {"plane": {"point": [0, 0.49], "normal": [0, -1]}}});
    scene["gap"] = json!(-0.02);
    scene["loads"] = json!([]);
    let (run, code) = refused(&scene, &[]);
    assert_eq!(code, "\"approach-away\"");
    run.fails_with(1, &["`obstacles[0].approach`", "pulls the body", "node ", "180 degrees", "turn `approach` around"]);
    // The same obstacle with the right approach direction.
    scene["obstacles"][0] =
        json!({"boundary": "top", "approach": "+y", "shape": {"plane": {"point": [0, 0.49], "normal": [0, 1]}}});
    assert!(solved(&scene).0["contact"]["force"].as_f64() > Some(0.0));
}

#[test]
fn a_body_without_contact_is_warned_of_with_its_smallest_remaining_gap() {
    let mut scene = scene();
    scene["gap"] = json!(0.25);
    scene["loads"] = json!([]);
    let message = warned(&solved(&scene), "nothing-touches");
    assert_eq!(message, "nothing touches; the smallest remaining gap is 0.25 m at node 12 at (0.5, 0.5)");
    scene["obstacles"] = json!([]);
    assert_eq!(warned(&solved(&scene), "nothing-touches"), "nothing touches: the scene has no obstacle");
}

/// Without a force of contact nothing pulls, so that the scene is not refused.
#[test]
fn an_open_obstacle_behind_the_boundary_is_warned_of() {
    let mut scene = scene();
    scene["loads"] = json!([]);
    scene["gap"] = json!(0.25);
    for (approach, normal, is_behind) in [("+y", 1, false), ("-y", -1, true)] {
        scene["obstacles"][0] = json!({"boundary": "top", "approach": approach, "shape": {"plane": {"point": [0, 0.5], "normal": [0, normal]}}});
        let message = warned(&solved(&scene), "nothing-touches");
        assert!(message.contains("the smallest remaining gap is 0.25 m at node 10 at (0, 0.5)"), "{message}");
        let words = ["points into the body", "obstacles[0] ", "lies behind `top`", "turn `approach` around"];
        assert!(words.iter().all(|words| message.contains(words) == is_behind), "{approach}: {message}");
    }
}

#[test]
fn a_body_compressed_by_a_third_is_warned_of_with_its_strain() {
    let mut scene = scene();
    scene["gap"] = json!(-0.15);
    let message = warned(&solved(&scene), "large-strain");
    assert!(message.contains("the largest strain is ") && message.contains(" %, in element "), "{message}");
    scene["gap"] = json!(-0.01);
    let others = solved(&scene).0;
    assert!(!others.to_string().contains("large-strain"), "{others}");
}

/// A half disc in a cup of the same radius: the surface normal deviates by up to 45 degrees from the approach
/// direction.
fn cup(rule: &str) -> Value {
    let mut points: Vec<[f64; 2]> = (-10..=10)
        .map(|step| {
            let angle = f64::from(step) * std::f64::consts::FRAC_PI_4 / 10.0;
            [angle.sin(), -angle.cos()]
        })
        .collect();
    // The rim of the cup is horizontal.
    points.insert(0, [-2.0, points[0][1]]);
    points.push([2.0, points[0][1]]);
    json!({
        "body": {"half-disc": {"radius": 1, "zone": {"width": 0.7, "divisions": 8}}},
        "material": {"young": 1e4, "poisson": 0.3},
        "supports": [{"on": {"boundary": "cut"}, "x": 0, "y": -0.02}],
        "obstacles": [{"boundary": "arc", "approach": "-y", "rule": rule, "shape": {"table": {"points": points}}}]
    })
}

#[test]
fn rows_that_deviate_from_the_normals_of_their_surface_are_warned_of() {
    let along_approach = solved(&cup("approach"));
    let message = warned(&along_approach, "leaning-normals");
    assert!(message.starts_with("the surface of obstacles[0] leans by 3"), "{message}");
    assert!(message.contains("Take rule `closest-point`"), "{message}");
    let along_normals = solved(&cup("closest-point"));
    let others = along_normals.0["warnings"].to_string();
    assert!(!others.contains("leaning-normals"), "{others}");
    // The report always names the rule.
    for ((report, text), rule) in [(&along_approach, "approach"), (&along_normals, "closest-point")] {
        assert_eq!(report["resultants"][0]["rule"], rule);
        assert!(text.contains(&format!("obstacles[0] (rule {rule}): force")), "{text}");
    }
}

#[test]
fn a_contact_of_one_node_is_warned_of_as_mesh_dependent() {
    let mut scene = scene();
    let top = 0.5;
    scene["obstacles"][0] =
        json!({"boundary": "top", "approach": "+y", "shape": {"wedge": {"apex": [0.5, top], "slope": 1}}});
    scene["gap"] = json!(-0.001);
    scene["loads"] = json!([]);
    let message = warned(&solved(&scene), "mesh-dependent");
    assert!(message.starts_with("a contact of obstacles[0] closes only node "), "{message}");
    assert!(message.contains("refine it near the contact and compare"), "{message}");
}

/// A flat punch on a wider block: the pressure at the edges of the punch is singular.
#[test]
fn a_peak_pressure_at_the_edge_of_a_punch_is_warned_of_as_mesh_dependent() {
    let mut scene = scene();
    scene["body"]["rectangle"]["x"]["divisions"] = json!([20]);
    scene["body"]["rectangle"]["y"]["divisions"] = json!([10]);
    scene["obstacles"][0]["shape"] =
        json!({"table": {"points": [[0.0, 1.0], [0.299, 1.0], [0.3, 0.5], [0.7, 0.5], [0.701, 1.0], [1.0, 1.0]]}});
    scene["loads"] = json!([]);
    let message = warned(&solved(&scene), "mesh-dependent");
    assert!(message.contains("the peak pressure stands at the edge of the contact, node "), "{message}");
}

/// A hub covers a part of a shaft, and its boundary ends with the contact: no candidate beyond is open.
#[test]
fn a_peak_pressure_at_the_end_of_a_seat_is_warned_of_as_mesh_dependent() {
    let mut scene = scene();
    scene["body"]["rectangle"]["x"]["divisions"] = json!([20]);
    scene["body"]["rectangle"]["y"]["divisions"] = json!([10]);
    scene["parts"] = json!([{"name": "seat", "of": "top", "box": {"min": [0.3, 0.5], "max": [0.7, 0.5]}}]);
    scene["obstacles"][0] =
        json!({"boundary": "seat", "approach": "+y", "shape": {"plane": {"point": [0.5, 0.5], "normal": [0, 1]}}});
    scene["gap"] = json!(-0.01);
    scene["loads"] = json!([]);
    let run = solved(&scene);
    let message = warned(&run, "mesh-dependent");
    assert!(message.contains("the peak pressure stands at the edge of the contact, node "), "{message}");
    assert!(message.contains("grows with every refinement, and has no uncertainty"), "{message}");
}

/// A sleeve is pressed on a longer shaft, both elastic. The peak at the end of the sleeve grows with every refinement:
/// no mesh has an uncertainty of it, and each is warned of.
#[test]
fn the_end_of_a_sleeve_on_a_shaft_is_warned_of_on_every_mesh() {
    let steel = json!({"young": 210e3, "poisson": 0.3});
    let press_fit = |divisions: usize| {
        let cells = |points: Value| {
            let pieces = points.as_array().unwrap().len() - 1;
            json!({"points": points, "divisions": vec![divisions; pieces]})
        };
        let body = |x: Value, y: Value| json!({"rectangle": {"x": cells(x), "y": cells(y), "element": "t3"}});
        let scene = json!({
            "model": "axisymmetric", "units": {"length": "mm", "force": "N"}, "material": steel,
            "body": body(json!([20, 40]), json!([20, 40])),
            "further-bodies": [{"name": "shaft", "material": steel, "body": body(json!([0, 20]), json!([0, 20, 40, 60]))}],
            "parts": [{"name": "seat", "of": "shaft.right", "box": {"min": [20, 20], "max": [20, 40]}}],
            "supports": [{"on": {"point": [40, 20]}, "y": 0}, {"on": {"boundary": "shaft.bottom"}, "y": 0}],
            "obstacles": [{"boundary": "left", "approach": "-x", "shape": {"body": {"boundary": "seat"}}}],
            "gap": -0.01
        });
        let run = solved(&scene);
        let message = warned(&run, "mesh-dependent");
        assert!(message.contains("grows with every refinement, and has no uncertainty"), "{divisions}: {message}");
        let contact = &run.0["contact"];
        assert_eq!(contact["estimate"].get("pressure_uncertainty"), None, "{divisions}: {contact}");
        contact["pressure_max"].as_f64().unwrap()
    };
    let peaks = [5, 10, 20].map(press_fit);
    assert!(peaks.windows(2).all(|pair| pair[1] > 1.1 * pair[0]), "{peaks:?}");
}

/// Two triangles in two groups of elements.
const TWO_GROUPS: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 3 \"base\"\n2 1 \"steel\"\n2 2 \"rubber\"\n$EndPhysicalNames\n\
     $Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n\
     $Elements\n3\n1 1 2 3 1 1 2\n2 2 2 1 1 1 2 3\n3 2 2 2 2 1 3 4\n$EndElements\n";

#[test]
fn a_mesh_of_several_groups_is_not_given_one_material() {
    let mut scene = scene();
    scene["body"] = json!({"gmsh": {"file": "two.msh"}});
    scene["supports"] = json!([{"on": {"boundary": "base"}, "x": 0, "y": 0}]);
    scene["loads"] = json!([]);
    scene["obstacles"] = json!([]);
    let (run, code) = refused(&scene, &[("two.msh", TWO_GROUPS)]);
    assert_eq!(code, "\"several-groups\"");
    run.fails_with(1, &["2 groups", "`steel`", "`rubber`", "`body.gmsh.group`"]);
    scene["body"]["gmsh"]["group"] = json!("steel");
    let desk = Desk::new();
    desk.write("two.msh", TWO_GROUPS);
    desk.write("scene.json", scene.to_string());
    desk.run(&["solve", "scene.json"]).ends_with(0);
}

#[test]
fn a_tolerance_that_is_too_large_is_a_usage_error() {
    let desk = Desk::new();
    desk.write("scene.json", scene().to_string());
    for option in ["--tolerance", "--accuracy"] {
        for value in ["0.11", "1", "1e300", "inf", "0"] {
            let run = desk.run(&["solve", "scene.json", option, value]).ends_with(2);
            assert!(run.stderr.contains("at most 0.1"), "{option} {value}: {}", run.stderr);
        }
        desk.run(&["solve", "scene.json", option, "0.1"]).ends_with(0);
    }
    desk.run(&["solve", "scene.json", "--time", "5"]).ends_with(0);
}

#[test]
fn multipliers_of_the_opposite_sign_are_named() {
    let desk = Desk::new();
    desk.write("scene.json", scene().to_string());
    desk.run(&["export", "scene.json", "p"]).ends_with(0);
    desk.run(&["solve", "p", "--out", "p"]).ends_with(0);
    let lambda = crate::promised::vectors(&desk, "p").1;
    let write = |values: &[f64]| {
        let words: Vec<String> = values.iter().map(f64::to_string).collect();
        desk.write("p/lambda.mtx", support::program::vector(&words.iter().map(String::as_str).collect::<Vec<_>>()));
    };
    write(&lambda.iter().map(|value| -value).collect::<Vec<_>>());
    let (report, text) = (verify(&desk, "json").ends_with(4).json(), verify(&desk, "text").ends_with(4).stdout);
    let message = warned(&(report, text), "opposite-sign");
    assert!(message.contains("change the sign of lambda"), "{message}");
    write(&lambda);
    assert_eq!(verify(&desk, "json").ends_with(0).json().get("warnings"), None);
}

#[test]
fn the_examples_cause_no_warning() {
    let desk = Desk::new();
    for name in examples() {
        let report = desk.run(&["solve", &support::program::example(&name), "--format", "json"]).ends_with(0).json();
        assert_eq!(report.get("warnings"), None, "{name}");
    }
}

/// The small block, clamped at its bottom and pressed on a plane, with a change. Each test below plants one mistake in
/// it.
fn pressed(change: impl Fn(&mut Value)) -> Value {
    let mut scene = scene();
    scene["loads"] = json!([]);
    scene["obstacles"][0]["shape"] = json!({"plane": {"point": [0, 0.5], "normal": [0, 1]}});
    change(&mut scene);
    scene
}

#[test]
fn the_block_without_a_planted_mistake_causes_no_warning() {
    assert_eq!(solved(&pressed(|_| {})).0.get("warnings"), None);
}

#[test]
fn an_obstacle_on_a_clamped_boundary_is_warned_of() {
    let held = pressed(|scene| {
        scene["supports"] = json!([{"on": {"boundary": "top"}, "x": 0, "y": -0.02}]);
        scene["obstacles"].as_array_mut().unwrap().push(
            json!({"boundary": "bottom", "approach": "-y", "shape": {"plane": {"point": [0, 0], "normal": [0, -1]}}}),
        );
    });
    let message = warned(&solved(&held), "held-candidates");
    assert!(message.starts_with("5 of 5 nodes that may touch obstacles[0] are held in all directions"), "{message}");
}

#[test]
fn a_load_on_a_supported_boundary_is_warned_of() {
    let loaded = pressed(|scene| scene["loads"] = json!([{"traction": {"boundary": "bottom", "value": [0, 5]}}]));
    let message = warned(&solved(&loaded), "load-on-support");
    assert!(message.starts_with("loads[0] acts only on nodes that supports hold"), "{message}");
}

#[test]
fn forces_and_supports_on_a_single_node_are_warned_of() {
    let loaded = pressed(|scene| scene["loads"] = json!([{"force": {"at": [1, 0.25], "value": [10, 0]}}]));
    let message = warned(&solved(&loaded), "point-load");
    assert!(message.starts_with("loads[0] is a force on a single node"), "{message}");
    let supports = |x: f64| json!([{"on": {"boundary": "bottom"}, "y": 0}, {"on": {"point": [0, 0]}, "x": x}]);
    let pulled = pressed(|scene| {
        scene["supports"] = supports(0.0);
        scene["loads"] = json!([{"traction": {"boundary": "right", "value": [1e4, 0]}}]);
    });
    let message = warned(&solved(&pulled), "point-support");
    assert!(message.starts_with("supports[1] holds a single node with a force of 5"), "{message}");
    // A support at one node that only fixes the position of the body carries no force.
    let kept = pressed(|scene| scene["supports"] = supports(0.0));
    assert_eq!(solved(&kept).0.get("warnings"), None);
}

#[test]
fn an_obstacle_that_is_given_twice_is_warned_of() {
    let doubled = pressed(|scene| {
        let first = scene["obstacles"][0].clone();
        scene["obstacles"].as_array_mut().unwrap().push(first);
    });
    let message = warned(&solved(&doubled), "doubled-obstacle");
    assert!(message.starts_with("obstacles[0] and obstacles[1] make the same rows"), "{message}");
}

/// For 20,000 obstacles, one warning for each pair would be 200 million, and one comparison of each pair of rows 200
/// million for each node.
#[test]
fn thousands_of_equal_obstacles_are_warned_of_in_one_sentence() {
    let copies = cases(2_000, 20_000);
    let crowded = pressed(|scene| {
        let first = scene["obstacles"][0].clone();
        scene["loads"] = json!([]);
        scene["supports"] = json!([{"on": {"boundary": "bottom"}, "x": 0, "y": 0}]);
        scene["obstacles"] = vec![first; copies].into();
        scene["gap"] = json!(1e-3);
    });
    let last = copies - 1;
    let expected =
        format!("obstacles[0] and {last} others, from obstacles[1] to obstacles[{last}], make the same rows");
    let message = warned(&solved(&crowded), "doubled-obstacle");
    assert!(message.starts_with(&expected), "{message}");
}

/// Two triangles whose common edge has two nodes at each end, so that they are not connected; each has a support.
const SLIT: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"base\"\n1 2 \"lid\"\n2 3 \"steel\"\n$EndPhysicalNames\n\
     $Nodes\n6\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 0\n6 1 1 0\n$EndNodes\n\
     $Elements\n4\n1 1 2 1 1 1 2\n2 1 2 2 2 4 6\n3 2 2 3 1 1 2 3\n4 2 2 3 1 5 6 4\n$EndElements\n";

#[test]
fn nodes_that_were_not_merged_are_warned_of() {
    let mut scene = scene();
    scene["body"] = json!({"gmsh": {"file": "slit.msh", "group": "steel"}});
    scene["loads"] = json!([]);
    scene["supports"] =
        json!([{"on": {"boundary": "base"}, "x": 0, "y": 0}, {"on": {"boundary": "lid"}, "x": 0, "y": -0.01}]);
    scene["obstacles"] = json!([]);
    let desk = Desk::new();
    desk.write("slit.msh", SLIT);
    desk.write("scene.json", scene.to_string());
    let report = desk.run(&["solve", "scene.json", "--format", "json"]).ends_with(0).json();
    let text = desk.run(&["solve", "scene.json"]).ends_with(0).stdout;
    let message = warned(&(report, text), "coincident-nodes");
    assert!(
        message.starts_with("2 nodes of the mesh have the place of another node, such as nodes 0 and 4 at ["),
        "{message}"
    );
}

#[test]
fn half_a_body_that_is_free_at_its_cut_is_warned_of() {
    let half = |supports: Value| {
        json!({
            "body": {"half-disc": {"radius": 1, "symmetric": true, "zone": {"width": 0.2, "divisions": 6}}},
            "material": {"young": 1e6, "poisson": 0.3},
            "supports": supports,
            "obstacles": [{"boundary": "arc", "approach": "-y", "shape": {"plane": {"point": [0, -0.99], "normal": [0, -1]}}}]
        })
    };
    let free = half(json!([{"on": {"boundary": "cut"}, "x": 0, "y": 0}]));
    let message = warned(&solved(&free), "free-symmetry");
    assert!(message.starts_with("no support holds the boundary `symmetry-x`"), "{message}");
    let held = half(json!([{"on": {"boundary": "cut"}, "x": 0, "y": 0}, {"on": {"boundary": "symmetry-x"}, "x": 0}]));
    assert!(!solved(&held).0.to_string().contains("free-symmetry"));
}

/// The obstacle approaches along +y, but its boundary is the side of the block.
#[test]
fn an_obstacle_perpendicular_to_its_boundary_is_warned_of() {
    let aside = pressed(|scene| scene["obstacles"][0]["boundary"] = json!("right"));
    let message = warned(&solved(&aside), "across-approach");
    assert!(message.contains("make an angle of 90 degrees"), "{message}");
}

/// The edge of a wedge lies between two nodes, so that no contact row reaches it.
#[test]
fn an_edge_between_two_nodes_is_warned_of() {
    let sharp = pressed(|scene| {
        scene["obstacles"][0]["shape"] = json!({"wedge": {"apex": [0.625, 0.5], "slope": 0.1}});
        scene["gap"] = json!(-0.015);
    });
    let message = warned(&solved(&sharp), "between-nodes");
    assert!(
        message.starts_with("between its nodes the body goes 1.") && message.contains("near [0.625, 0.5]"),
        "{message}"
    );
    // A flat foot that stands on the floor as it is: what its nodes move is rounding.
    let cells = |count: usize| json!({"points": [0, 1], "divisions": [count]});
    let standing = json!({
        "model": "axisymmetric", "material": {"young": 1e3, "poisson": 0.3},
        "body": {"rectangle": {"x": cells(4), "y": cells(4)}},
        "points": [{"name": "ram", "at": [0, 1], "force": [0, -10]}],
        "ties": [{"coupling": {"point": "ram", "boundary": "top"}}],
        "obstacles": [{"boundary": "bottom", "approach": "-y", "shape": {"plane": {"point": [0, 0], "normal": [0, -1]}}}]
    });
    assert!(!solved(&standing).0.to_string().contains("between-nodes"));
}

/// A gap with the wrong sign in a problem directory: no row closes, and the answer is that of a free body.
#[test]
fn a_problem_without_closed_rows_is_warned_of() {
    let desk = Desk::new();
    // Without contact both dofs move by 1.
    desk.problem("problem", &Problem { g: vector(&["10"]), ..Problem::right() });
    let report = desk.run(&["solve", "problem", "--format", "json"]).ends_with(0).json();
    let text = desk.run(&["solve", "problem"]).ends_with(0).stdout;
    let message = warned(&(report, text), "nothing-touches");
    assert_eq!(message, "no row is closed; the smallest remaining gap is 9 at row 0");
}

/// 210e9 Pa are 210e3 N/mm2; twice the modulus of diamond, 1.2e6 N/mm2, is asked about.
#[test]
fn a_modulus_in_pascals_beside_millimetres_is_asked_about() {
    let mut scene = scene();
    scene["loads"] = json!([]);
    let stderr = |scene: &Value| {
        let desk = Desk::new();
        desk.write("scene.json", scene.to_string());
        desk.run(&["solve", "scene.json"]).ends_with(0).stderr
    };
    for (length, force, young, meant) in [
        (
            "mm",
            "N",
            210e9,
            Some(
                "2.1e11 is in N/mm2, the units of this scene, 175000 times that of diamond: if it is given in Pa, write 2.1e5;",
            ),
        ),
        ("mm", "N", 2.5e6, Some("write 2.5e0")),
        ("mm", "N", 2.3e6, None),
        ("mm", "N", 210e3, None),
        (
            "mm",
            "kN",
            210e3,
            Some("175 times that of diamond: if it is given in Pa, write 2.1e-4; steel has 2.1e2 kN/mm2"),
        ),
        ("mm", "kN", 210.0, None),
        ("m", "N", 210e9, None),
        ("inch", "lbf", 210e9, None),
    ] {
        scene["units"] = json!({"length": length, "force": force});
        scene["material"]["young"] = json!(young);
        let said = stderr(&scene);
        assert_eq!(said.contains("diamond"), meant.is_some(), "{length} {force} {young}: {said}");
        assert!(meant.is_none_or(|words| said.starts_with("warning: ") && said.contains(words)), "{said}");
    }
}

/// A block of 0.5 x 1 on another one whose mesh does not match. `below` are the ends of the lower block along x,
/// `cells` the numbers of cells of both, and `gap` their distance.
fn blocks(below: [f64; 2], cells: [usize; 2], gap: f64, body: &Value) -> Value {
    let block = |x: [f64; 2], cells: usize, y: [f64; 2]| json!({"rectangle": {"x": {"points": x, "divisions": [cells]}, "y": {"points": y, "divisions": [2]}}});
    let mut shape = json!({"boundary": "base.top"});
    body.as_object().unwrap().iter().for_each(|(key, value)| shape[key] = value.clone());
    json!({
        "body": block([0.0, 0.5], cells[0], [gap, 1.0 + gap]), "material": {"young": 1e4, "poisson": 0.3, "density": 1},
        "further-bodies": [{"name": "base", "body": block(below, cells[1], [-1.0, 0.0]), "material": {"young": 1e4, "poisson": 0.3, "density": 1}}],
        "supports": [{"on": {"boundary": "top"}, "x": 0, "y": -0.01}, {"on": {"boundary": "base.bottom"}, "x": 0, "y": 0}],
        "obstacles": [{"boundary": "bottom", "approach": "-y", "shape": {"body": shape}}]
    })
}

#[test]
fn two_bodies_whose_surfaces_do_not_fit_are_warned_of() {
    let wide = [-0.5, 1.0];
    let fine = solved(&blocks(wide, [3, 7], 0.0, &json!({}))).0;
    assert!(fine["warnings"].as_array().unwrap().iter().all(|warning| warning["code"] == "mesh-dependent"), "{fine}");

    let none = warned(&solved(&blocks(wide, [3, 7], 0.5, &json!({"reach": 0.1}))), "no-facing-facet");
    assert!(none.contains("no facet of `bottom` faces `base.top` within reach"), "{none}");
    let partly = warned(&solved(&blocks([0.3, 0.8], [3, 7], 0.0, &json!({"side": "this"}))), "partly-covered");
    assert!(partly.contains("40.0 % of the area of `bottom` face `base.top`"), "{partly}");
    let coarse = warned(&solved(&blocks(wide, [8, 2], 0.0, &json!({"side": "this"}))), "coarse-master");
    assert!(coarse.contains("the facets of `base.top` are 12.0 times as long as those of `bottom`"), "{coarse}");
    let differs = warned(&solved(&blocks(wide, [3, 7], 0.5, &json!({"fit": {"interference": 0.02}}))), "fit-differs");
    assert!(differs.contains("the meshes lie 5.20e-1 away from the fit -2.00e-2"), "{differs}");
}

/// A shaft in a hub of the same radius: straight edges of 15 and 10 degrees miss the circle by `h angle / 8`.
#[test]
fn straight_edges_of_a_shaft_in_a_hub_are_warned_of_with_their_sag() {
    let ring = |radii: [f64; 2], count: usize| json!({"ring": {"radius": {"points": radii, "divisions": [2]}, "angle": {"points": [0, 360], "divisions": [count]}}});
    let press = |body: Value| {
        json!({
            "body": ring([0.5, 1.0], 24), "material": {"young": 1e4, "poisson": 0.3},
            "further-bodies": [{"name": "hub", "body": ring([1.0, 2.0], 36), "material": {"young": 1e4, "poisson": 0.3}}],
            "supports": [{"on": {"boundary": "inner"}, "x": 0, "y": 0}, {"on": {"boundary": "hub.outer"}, "x": 0, "y": 0}],
            "obstacles": [{"boundary": "outer", "approach": "+x", "rule": "closest-point", "gap": 0, "shape": {"body": body}}]
        })
    };
    let angle = 15_f64.to_radians();
    let sag = 2.0 * (angle / 2.0).sin() * angle / 8.0;
    let message = warned(&solved(&press(json!({"boundary": "hub.inner"}))), "sag");
    assert!(message.contains(&format!("miss them by up to {sag:.2e}")), "{message}");
    let fitted = solved(&press(json!({"boundary": "hub.inner", "fit": {"interference": 0.001}}))).0;
    assert!(!fitted.to_string().contains("\"sag\""), "{fitted}");
}

#[test]
fn a_motion_of_bodies_whose_nodes_do_not_pair_up_is_refused() {
    let mut scene = blocks([0.0, 0.5], [2, 3], 0.5, &json!({}));
    scene["supports"] = json!([{"on": {"boundary": "base.bottom"}, "x": 0, "y": 0}]);
    scene["analysis"] =
        json!({"dynamic": {"duration": 0.01, "step": 0.001, "initial": [{"velocity": {"value": [0, -1]}}]}});
    let (run, code) = refused(&scene, &[]);
    assert_eq!(code, "\"motion-of-means\"");
    run.fails_with(1, &["obstacles[0].shape.body", "hold means over several nodes", "lie opposite each other"]);
}
