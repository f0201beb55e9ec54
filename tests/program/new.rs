//! The command `new` writes a first scene for a mesh, which runs without changes.

use std::fs;
use std::path::Path;
use std::process::Command;

use support::program::Desk;

/// Mesh files from Gmsh: of every element, and of parts without an obvious side to hold or to press.
fn meshes() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes");
    let of = |part: &str| -> Vec<String> {
        let names = fs::read_dir(folder.join(part)).unwrap();
        let names = names.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.filter(|name| name.ends_with(".msh")).map(|name| format!("{part}{name}")).collect()
    };
    let mut names = [of(""), of("parts/")].concat();
    names.sort();
    names
}

fn copied(desk: &Desk, name: &str) {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name);
    desk.write(name, fs::read(from).unwrap());
}

/// The first scene of a mesh of this name, beside it.
fn first_scene(desk: &Desk, name: &str) -> String {
    copied(desk, name);
    let file = name.replace(".msh", ".json");
    let run = desk.run(&["new", name, "--out", &file]).ends_with(0);
    assert!(run.stdout.contains(&file), "{}", run.stdout);
    fs::read_to_string(desk.path(&file)).unwrap()
}

#[test]
fn the_first_scene_of_every_mesh_is_certified_without_changes() {
    let names = meshes();
    assert!(names.len() >= 25, "{names:?}");
    for name in names {
        let desk = Desk::new();
        let text = first_scene(&desk, &name);
        let file = name.rsplit('/').next().unwrap();
        assert!(text.starts_with(&format!("// A first scene for {file}")), "{text}");
        let scene = name.replace(".msh", ".json");
        let run = desk.run(&["solve", &scene, "--format", "json"]);
        assert_eq!(run.code, 0, "{name}: {}{text}", run.stderr);
        let report = run.json();
        assert_eq!(report["status"], "certified", "{name}");
        // The plate presses the body: it has a travel, and the sum of its forces is the force in the scene.
        assert!(report["resultants"][0]["travel"].as_f64().unwrap() > 0.0, "{name}: {}", report["resultants"]);
    }
}

/// The normals of a bore along the way of the plate are all perpendicular to it; those of a whole bore face all directions.
#[test]
fn a_bore_is_pressed_only_where_it_faces_the_plate() {
    let desk = Desk::new();
    let upright = first_scene(&desk, "parts/bored-block.msh");
    assert!(!upright.contains("\"boundary\": \"bore\"") && !upright.contains("\"of\": \"bore\""), "{upright}");
    assert!(first_scene(&desk, "parts/plate-with-hole.msh").contains("\"boundary\": \"right\", \"approach\": \"+x\""));
    let across = first_scene(&desk, "parts/bored-across.msh");
    assert!(across.contains("\"of\": \"contact\", \"normal\": {\"direction\": [0, 0, 1], \"within\": 45}"), "{across}");
}

/// Two boxes in one group: a boundary of one of them would leave the other without a support.
#[test]
fn every_piece_of_a_mesh_is_held() {
    let desk = Desk::new();
    let text = first_scene(&desk, "parts/two-boxes.msh");
    assert!(text.contains("\"name\": \"held\", \"normal\": {\"direction\": [0, 0, -1]"), "{text}");
}

#[test]
fn two_commands_lead_from_a_mesh_to_an_answer() {
    let desk = Desk::new();
    copied(&desk, "box-tet10.msh");
    let program = env!("CARGO_BIN_EXE_signorini");
    let script = format!("'{program}' new box-tet10.msh | '{program}' solve - --format json");
    let output = Command::new("sh").args(["-c", &script]).current_dir(desk.path(".")).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["status"], "certified");
}

#[test]
fn a_first_scene_lists_the_groups_of_the_file_and_guesses_its_unit() {
    let desk = Desk::new();
    copied(&desk, "two-parts-q8.msh");
    let metres = desk.run(&["new", "two-parts-q8.msh"]).ends_with(0).stdout;
    for phrase in ["first, second", "boundary \"interface\"", "in metres", "\"length\": \"m\"", "\"young\": 2.1e11"] {
        assert!(metres.contains(phrase), "{phrase}: {metres}");
    }
    desk.write("empty.msh", "");
    desk.run(&["new", "empty.msh"]).fails_with(1, &["empty.msh"]);
    desk.run(&["new", "none.msh"]).fails_with(1, &["none.msh"]);
    desk.run(&["new"]).ends_with(2);
}

#[test]
fn comment_lines_do_not_change_the_line_numbers_of_errors() {
    let desk = Desk::new();
    desk.write("scene.json", "// a comment\n{\n  // another\n  \"Gap\": 1\n}\n");
    desk.run(&["solve", "scene.json"]).fails_with(1, &["scene.json:4:", "unknown key `Gap`"]);
}
