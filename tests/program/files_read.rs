//! The files that the program reads, and what its messages reveal: no named pipes, no files outside the folder of the
//! scene, no content of other files.
#![cfg(target_os = "linux")]

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::json;
use support::program::{Desk, Problem, scene};

#[test]
fn a_named_pipe_is_refused_without_waiting() {
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
fn a_mesh_file_outside_the_folder_of_the_scene_is_read_only_if_that_is_allowed() {
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
fn no_error_quotes_a_file_that_is_not_a_mesh() {
    let desk = Desk::new();
    let secrets = ["hunter2:x:0\n", "$hunter2\n", "$Comments\nold\n$EndComments\nhunter2\n", "\n\n hunter2"];
    for secret in secrets {
        desk.write("secret", secret);
        desk.write("scene.json", with_mesh("secret"));
        let run = desk.run(&["solve", "scene.json"]).fails_with(1, &["secret:", "this is not a mesh of Gmsh"]);
        assert!(!run.stderr.contains("hunter2"), "{}", run.stderr);
    }
}

#[test]
fn no_error_quotes_a_file_outside_the_folder_that_a_link_points_to() {
    let secrets = [
        "hunter2:x:0\n",
        "%%MatrixMarket matrix hunter2 real general\n",
        "%%MatrixMarket matrix coordinate hunter2 general\n",
        "%%MatrixMarket matrix coordinate real hunter2\n",
        "%%MatrixMarket matrix coordinate real general\nhunter2\n",
        "%%MatrixMarket matrix coordinate real general\n2 2 1\n1 1 hunter2\n",
        "%%MatrixMarket matrix array real general\n1 1\nhunter2\n",
    ];
    let desk = Desk::new();
    for secret in secrets {
        desk.write("secret", secret);
        for name in ["K", "f", "B", "g"] {
            desk.problem("p", &Problem::right());
            let file = desk.path(&format!("p/{name}.mtx"));
            fs::remove_file(&file).unwrap();
            std::os::unix::fs::symlink("../secret", &file).unwrap();
            for format in ["text", "json"] {
                let run = desk.run(&["solve", "p", "--format", format]).fails_with(1, &[&format!("p/{name}.mtx:")]);
                assert!(!run.stderr.contains("hunter2") && !run.stdout.contains("hunter2"), "{}", run.stderr);
            }
            // For a file inside the folder, the error quotes the faulty text.
            fs::remove_file(&file).unwrap();
            fs::write(&file, secret).unwrap();
            desk.run(&["solve", "p"]).fails_with(1, &["hunter2"]);
        }
    }
}
