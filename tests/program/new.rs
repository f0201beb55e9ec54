//! The command `new` writes a first scene for a mesh, which runs without changes.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::program::Desk;

/// Mesh files from Gmsh, of every element.
fn meshes() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes");
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter(|name| name.ends_with(".msh")).collect();
    names.sort();
    names
}

fn copied(desk: &Desk, name: &str) {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name);
    desk.write(name, fs::read(from).unwrap());
}

#[test]
fn the_first_scene_of_every_mesh_is_certified_without_changes() {
    let names = meshes();
    assert!(names.len() >= 8, "{names:?}");
    for name in names {
        let desk = Desk::new();
        copied(&desk, &name);
        let scene = desk.run(&["new", &name, "--out", "scene.json"]).ends_with(0);
        assert!(scene.stdout.contains("scene.json"), "{}", scene.stdout);
        let text = fs::read_to_string(desk.path("scene.json")).unwrap();
        assert!(text.starts_with(&format!("// A first scene for {name}")), "{text}");
        let report = desk.run(&["solve", "scene.json", "--format", "json"]).ends_with(0).json();
        assert_eq!(report["status"], "certified", "{name}");
        // The plate presses the body: it has a travel, and the sum of its forces is the force in the scene.
        assert!(report["resultants"][0]["travel"].as_f64().unwrap() > 0.0, "{name}: {}", report["resultants"]);
    }
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
