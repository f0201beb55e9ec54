//! Questions that were not asked: each is refused, or warned of, with its code, its numbers and its remedy.

use crate::program::{Desk, Run, examples, scene};
use crate::verify::verify;
use serde_json::{Value, json};

/// The report of `solve` of a scene, which ends with exit code 0.
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

/// The message of the only warning, whose code is `code`; the text says the same, in its own lines.
#[track_caller]
fn warned((report, text): &(Value, String), code: &str) -> String {
    let warnings = report["warnings"].as_array().expect("warnings");
    let warning = warnings.iter().find(|warning| warning["code"] == code).unwrap_or_else(|| panic!("{warnings:?}"));
    let message = warning["message"].as_str().unwrap();
    let one_line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(one_line.contains(message), "{one_line} lacks {message}");
    message.to_string()
}

/// The block lies below its obstacle, which is said to come from above: at its closed nodes it would pull.
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
    // The same obstacle from the other side.
    scene["obstacles"][0] =
        json!({"boundary": "top", "approach": "+y", "shape": {"plane": {"point": [0, 0.49], "normal": [0, 1]}}});
    assert!(solved(&scene).0["contact"]["force"].as_f64() > Some(0.0));
}

#[test]
fn a_body_that_touches_nothing_is_told_its_smallest_remaining_gap() {
    let mut scene = scene();
    scene["gap"] = json!(0.25);
    scene["loads"] = json!([]);
    let message = warned(&solved(&scene), "nothing-touches");
    assert_eq!(message, "nothing touches; the smallest remaining gap is 0.25 m at node 12");
    scene["obstacles"] = json!([]);
    assert_eq!(warned(&solved(&scene), "nothing-touches"), "nothing touches: the scene has no obstacle");
}

#[test]
fn a_body_pressed_together_by_half_is_told_its_strain() {
    let mut scene = scene();
    scene["gap"] = json!(-0.25);
    let message = warned(&solved(&scene), "large-strain");
    assert!(message.contains("the largest strain is ") && message.contains(" %, in element "), "{message}");
    scene["gap"] = json!(-0.01);
    assert_eq!(solved(&scene).0.get("warnings"), None);
}

/// Two triangles, each in a volume group of its own.
const TWO_GROUPS: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 3 \"base\"\n2 1 \"steel\"\n2 2 \"rubber\"\n$EndPhysicalNames\n\
     $Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n\
     $Elements\n3\n1 1 2 3 1 1 2\n2 2 2 1 1 1 2 3\n3 2 2 2 2 1 3 4\n$EndElements\n";

#[test]
fn a_mesh_of_several_groups_is_not_taken_for_one_material() {
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
fn a_tolerance_that_says_nothing_is_a_usage_error() {
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
        desk.write("p/lambda.mtx", crate::program::vector(&words.iter().map(String::as_str).collect::<Vec<_>>()));
    };
    write(&lambda.iter().map(|value| -value).collect::<Vec<_>>());
    let (report, text) = (verify(&desk, "json").ends_with(4).json(), verify(&desk, "text").ends_with(4).stdout);
    let message = warned(&(report, text), "opposite-sign");
    assert!(message.contains("change the sign of lambda"), "{message}");
    write(&lambda);
    assert_eq!(verify(&desk, "json").ends_with(0).json().get("warnings"), None);
}

#[test]
fn no_example_is_warned_of() {
    let desk = Desk::new();
    for name in examples() {
        let report = desk.run(&["solve", &crate::program::example(&name), "--format", "json"]).ends_with(0).json();
        assert_eq!(report.get("warnings"), None, "{name}");
    }
}
