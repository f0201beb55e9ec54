//! Limits are kept: of time, of memory, of what is read, and how a run ends that is asked to.
#![cfg(target_os = "linux")]

mod program;

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use program::{Desk, Problem, scene};
use serde_json::{Value, json};

/// A bar of 20 cells that flies against a wall, 120 steps a unit of time.
fn bar(duration: f64, frames: usize) -> Value {
    json!({
        "model": "bar",
        "body": {"bar": {"x": {"points": [0, 10], "divisions": [20]}}},
        "material": {"young": 900, "poisson": 0, "density": 1},
        "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [15], "normal": [1]}}}],
        "analysis": {"dynamic": {
            "duration": duration, "frames": frames, "initial": [{"velocity": {"value": [10]}}]
        }}
    })
}

/// What a folder of a motion says of its end: the whole history and the last state.
fn end(desk: &Desk, folder: &str) -> (String, Value) {
    let text = |name: &str| fs::read_to_string(desk.path(folder).join(name)).unwrap();
    let mut checkpoint: Value = serde_json::from_str(&text("checkpoint.json")).unwrap();
    for field in ["scene", "frame_times"] {
        checkpoint.as_object_mut().unwrap().remove(field);
    }
    (text("history.csv"), checkpoint)
}

#[test]
fn a_resumed_motion_goes_on_to_a_longer_duration_bit_for_bit() {
    let desk = Desk::new();
    // Neither duration is a whole number of steps, and only in the second the bar touches the wall.
    for (name, duration, frames) in [("short", 0.4012, 5), ("long", 1.7034, 12)] {
        desk.write(&format!("{name}.json"), bar(duration, frames).to_string());
    }
    desk.run(&["solve", "long.json", "--out", "whole"]).ends_with(0);
    desk.run(&["solve", "short.json", "--out", "parts"]).ends_with(0);
    assert!(end(&desk, "parts") != end(&desk, "whole"));
    let run = desk.run(&["solve", "long.json", "--out", "parts", "--resume", "--format", "json"]).ends_with(0);
    assert!(run.json()["contact"]["impulse"].as_f64().unwrap() > 0.0);
    assert_eq!(end(&desk, "parts"), end(&desk, "whole"));
    // Neither back in time, nor to another scene.
    let back = desk.run(&["solve", "short.json", "--out", "parts", "--resume"]);
    back.fails_with(1, &["at `analysis.dynamic.duration`", "step 205 already"]);
    let mut other = bar(1.7034, 12);
    other["material"]["young"] = json!(901);
    desk.write("other.json", other.to_string());
    desk.run(&["solve", "other.json", "--out", "parts", "--resume"]).fails_with(1, &["belongs to another scene"]);
    assert_eq!(end(&desk, "parts"), end(&desk, "whole"));
}

#[test]
fn a_request_to_terminate_ends_a_run_as_an_interrupt_does() {
    let desk = Desk::new();
    desk.write("bar.json", bar(2000.0, 10_000).to_string());
    let arguments = ["solve", "bar.json", "--out", "o", "--format", "json"];
    let mut child = desk.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    while !desk.path("o/series-00003.vtu").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it could be terminated");
        std::thread::yield_now();
    }
    assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(said.starts_with("interrupted in step "), "{said}");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(report["steps"].as_u64().unwrap() > 0, "{report}");
}

#[test]
fn a_named_pipe_is_refused_instead_of_waited_for() {
    let desk = Desk::new();
    desk.problem("p", &Problem::right());
    fs::remove_file(desk.path("p/g.mtx")).unwrap();
    for pipe in ["pipe", "p/g.mtx", "mesh.msh"] {
        assert!(Command::new("mkfifo").arg(desk.path(pipe)).status().unwrap().success());
    }
    let mut meshed = scene();
    meshed["body"] = json!({"gmsh": {"file": "mesh.msh"}});
    desk.write("scene.json", meshed.to_string());
    for (input, named) in [("pipe", "pipe"), ("p", "p/g.mtx"), ("scene.json", "mesh.msh")] {
        desk.run(&["solve", input]).fails_with(1, &[&format!("cannot read {named}"), "it is a named pipe"]);
    }
}

fn mesh(name: &str) -> Vec<u8> {
    fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name)).unwrap()
}

/// A scene whose body is a mesh file.
fn with_mesh(file: &str) -> String {
    json!({
        "model": "plane-strain",
        "body": {"gmsh": {"file": file}},
        "material": {"young": 1000, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}]
    })
    .to_string()
}

#[test]
fn a_mesh_file_outside_the_folder_of_the_scene_is_read_only_where_that_is_allowed() {
    let desk = Desk::new();
    desk.write("outside.msh", mesh("block-t3.msh"));
    desk.write("s/below/inside.msh", mesh("block-t3.msh"));
    std::os::unix::fs::symlink("../outside.msh", desk.path("s/link.msh")).unwrap();
    std::os::unix::fs::symlink("below/inside.msh", desk.path("s/inner.msh")).unwrap();
    let absolute = desk.path("outside.msh");
    let (absolute, within) = (absolute.to_str().unwrap(), desk.path("s/inner.msh"));
    for file in ["below/inside.msh", "./below/../below/inside.msh", "inner.msh", within.to_str().unwrap()] {
        desk.write("s/scene.json", with_mesh(file));
        desk.run(&["solve", "s/scene.json"]).ends_with(0);
    }
    for file in ["../outside.msh", "below/../../outside.msh", "link.msh", absolute] {
        desk.write("s/scene.json", with_mesh(file));
        for command in [&["solve", "s/scene.json"][..], &["compare", "s/scene.json"], &["export", "s/scene.json", "e"]]
        {
            let phrases = ["at `body.gmsh.file`", "outside the folder of the scene", "--allow-outside"];
            desk.run(command).fails_with(1, &phrases);
            desk.run(&[command, &["--allow-outside"]].concat()).ends_with(0);
        }
    }
}

#[test]
fn no_error_quotes_a_file_that_is_no_mesh() {
    let desk = Desk::new();
    let secrets = ["hunter2:x:0\n", "$hunter2\n", "$Comments\nold\n$EndComments\nhunter2\n", "\n\n hunter2"];
    for secret in secrets {
        desk.write("secret", secret);
        desk.write("scene.json", with_mesh("secret"));
        let run = desk.run(&["solve", "scene.json"]).fails_with(1, &["secret:", "it is no mesh of Gmsh"]);
        assert!(!run.stderr.contains("hunter2"), "{}", run.stderr);
    }
}
