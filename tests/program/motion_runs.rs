//! A run of a motion is resumed from its files alone, and ends on request.
#![cfg(target_os = "linux")]

use std::fs;
use std::process::{Command, Stdio};

use serde_json::{Value, json};
use support::program::Desk;

/// A bar of 20 cells that flies against a wall, with 60 steps per unit of time.
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

/// The end of a motion in its output folder: the whole history and the last state.
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
    // Neither duration is a whole number of steps, and the bar touches the wall only in the second.
    for (name, duration, frames) in [("short", 0.4012, 5), ("long", 1.7034, 12)] {
        desk.write(&format!("{name}.json"), bar(duration, frames).to_string());
    }
    desk.run(&["solve", "long.json", "--out", "whole", "--pictures", "none"]).ends_with(0);
    desk.run(&["solve", "short.json", "--out", "parts", "--pictures", "none"]).ends_with(0);
    assert!(end(&desk, "parts") != end(&desk, "whole"));
    let run = desk
        .run(&["solve", "long.json", "--out", "parts", "--resume", "--format", "json", "--pictures", "none"])
        .ends_with(0);
    assert!(run.json()["contact"]["impulse"].as_f64().unwrap() > 0.0);
    assert_eq!(end(&desk, "parts"), end(&desk, "whole"));
    // A motion is resumed neither to an earlier time nor with another scene.
    let back = desk.run(&["solve", "short.json", "--out", "parts", "--resume"]);
    back.fails_with(1, &["at `analysis.dynamic.duration`", "already reached step 103"]);
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
        assert!(child.try_wait().unwrap().is_none(), "the run ended before it could be terminated");
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

/// A run is resumed only from its own files: the content of other files is neither quoted, waited for, nor cut off.
#[test]
fn a_motion_is_resumed_only_from_files_that_it_wrote() {
    let desk = Desk::new();
    desk.write("bar.json", bar(0.1, 4).to_string());
    let begun = |desk: &Desk| desk.run(&["solve", "bar.json", "--out", "run", "--pictures", "none"]).ends_with(0);
    let resumed = |desk: &Desk| desk.run(&["solve", "bar.json", "--out", "run", "--resume", "--pictures", "none"]);
    begun(&desk);
    for secret in ["\"hunter2\"", "{\"scene\": \"hunter2\", \"steps\": \"hunter2\"}", "hunter2"] {
        desk.write("secret", secret);
        fs::remove_file(desk.path("run/checkpoint.json")).unwrap();
        std::os::unix::fs::symlink("../secret", desk.path("run/checkpoint.json")).unwrap();
        let run = resumed(&desk).fails_with(1, &["checkpoint.json:1", "it is not a checkpoint of a motion"]);
        assert!(!run.stderr.contains("hunter2"), "{}", run.stderr);
    }
    let history = desk.path("run/history.csv");
    fs::remove_file(desk.path("run/checkpoint.json")).unwrap();
    begun(&desk);
    let foreign = "hunter2\n".repeat(10_000);
    let refused = |phrase: &str| drop(resumed(&desk).fails_with(1, &["cannot resume", "history.csv", phrase]));
    fs::write(desk.path("foreign.csv"), &foreign).unwrap();
    fs::remove_file(&history).unwrap();
    std::os::unix::fs::symlink("../foreign.csv", &history).unwrap();
    refused("it is not a regular file");
    assert_eq!(fs::read_to_string(desk.path("foreign.csv")).unwrap(), foreign);
    fs::remove_file(&history).unwrap();
    fs::write(&history, &foreign).unwrap();
    refused("it is not a history of a motion");
    assert_eq!(fs::read_to_string(&history).unwrap(), foreign);
    fs::remove_file(&history).unwrap();
    assert!(Command::new("mkfifo").arg(&history).status().unwrap().success());
    refused("it is not a regular file");
}
