//! Limits of memory and of files: input that is too large is refused by name before it is built or read.
#![cfg(target_os = "linux")]

use std::fs;
use std::process::Command;

use serde_json::{Value, json};
use signorini::qp::Cholesky;
use signorini::{Scene, SparseMatrix, SymmetricMatrix};
use support::program::{Desk, Problem, Run, matrix, vector};

/// The estimate and the measured peak may differ by this factor.
const WITHIN: f64 = 2.0;

/// The address space, in kB, that the program takes to refuse a scene of 1e12 elements, beside that in which it tells
/// its version: most of both is its own code.
const REFUSAL_KILOBYTES: u32 = 1_000;

/// The address space, in kB, in which hostile files are refused; one announces rows of 800 MB.
const FILE_KILOBYTES: u32 = 400_000;

/// The address space, in kB, that matrix products reserve: twice the third-level cache, if the machine reports its
/// size.
fn packed_kilobytes() -> u32 {
    let size = fs::read_to_string("/sys/devices/system/cpu/cpu0/cache/index3/size").unwrap_or_default();
    2 * size.trim().trim_end_matches('K').parse().unwrap_or(0)
}

/// Seconds of processor time for a refusal. It takes milliseconds; a loop over 1e12 elements would take minutes.
const REFUSAL_SECONDS: u32 = 10;

/// Runs the program in an address space of `kilobytes` kB, with the processor time of a refusal.
fn confined(desk: &Desk, kilobytes: u32, arguments: &str) -> Run {
    let script = format!(
        "ulimit -v {kilobytes}; ulimit -t {REFUSAL_SECONDS}; exec '{}' {arguments}",
        env!("CARGO_BIN_EXE_signorini")
    );
    let output = Command::new("sh").args(["-c", &script]).current_dir(desk.path(".")).output().unwrap();
    Run {
        code: output.status.code().expect("the program ends with an exit code, not by a signal"),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

/// The least address space, in kB, in which the program tells its version, to `REFUSAL_KILOBYTES / 8`.
fn least_kilobytes(desk: &Desk) -> u32 {
    let starts = |kilobytes: u32| {
        let script = format!("ulimit -v {kilobytes}; exec '{}' --version", env!("CARGO_BIN_EXE_signorini"));
        let output = Command::new("sh").args(["-c", &script]).current_dir(desk.path(".")).output().unwrap();
        output.status.success()
    };
    let (mut too_few, mut enough) = (0, FILE_KILOBYTES);
    assert!(starts(enough), "the program starts");
    while enough - too_few > REFUSAL_KILOBYTES / 8 {
        let middle = too_few.midpoint(enough);
        *(if starts(middle) { &mut enough } else { &mut too_few }) = middle;
    }
    enough
}

fn rectangle(cells: [usize; 2], element: &str) -> Value {
    let width = cells[0] as f64 / cells[1] as f64;
    let axis = |length: f64, cells: usize| json!({"points": [0, length], "divisions": [cells]});
    let body = json!({"rectangle": {"x": axis(width, cells[0]), "y": axis(1.0, cells[1]), "element": element}});
    let shape = json!({"parabola": {"apex": [width / 2.0, 1], "radius": 1}});
    clamped("plane-strain", body, "bottom", "top", "+y", shape)
}

fn block(cells: [usize; 3], element: &str) -> Value {
    let lengths = cells.map(|count| count as f64 / cells[2] as f64);
    let axis = |axis: usize| json!({"points": [0, lengths[axis]], "divisions": [cells[axis]]});
    let body = json!({"box": {"x": axis(0), "y": axis(1), "z": axis(2), "element": element}});
    let shape = json!({"sphere": {"apex": [lengths[0] / 2.0, lengths[1] / 2.0, 1], "radius": 1}});
    clamped("space", body, "bottom", "top", "+z", shape)
}

fn bar(cells: usize) -> Value {
    json!({
        "model": "bar", "body": {"bar": {"x": {"points": [0, 1], "divisions": [cells]}}},
        "material": {"young": 1000, "poisson": 0.3},
        "supports": [{"on": {"boundary": "left"}, "x": 0}], "loads": [{"body-force": [1]}],
        "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [1], "normal": [1]}}}]
    })
}

fn clamped(model: &str, body: Value, held: &str, pressed: &str, approach: &str, shape: Value) -> Value {
    let mut support = json!({"on": {"boundary": held}, "x": 0, "y": 0});
    if model == "space" {
        support["z"] = json!(0);
    }
    json!({
        "model": model, "body": body, "material": {"young": 1000, "poisson": 0.3}, "supports": [support],
        "obstacles": [{"boundary": pressed, "approach": approach, "shape": shape}], "gap": -0.01
    })
}

#[test]
fn the_estimate_of_memory_is_within_a_factor_of_two_of_the_peak_on_ten_scenes() {
    let zone =
        |width: f64, divisions: usize, growth: f64| json!({"width": width, "divisions": divisions, "growth": growth});
    let plane = |dimension: usize| {
        let mut normal = vec![0.0; dimension];
        normal[dimension - 1] = -1.0;
        json!({"plane": {"point": vec![0.0; dimension], "normal": normal}})
    };
    let disc = json!({"half-disc": {"centre": [0, 1], "radius": 1, "zone": zone(0.1, 40, 1.05)}});
    let ball = json!({"half-ball": {"centre": [0, 0, 1], "radius": 1, "zone": zone(0.2, 4, 1.5)}});
    let scenes = [
        rectangle([80, 80], "q4"),
        rectangle([600, 12], "q4"),
        rectangle([100, 100], "t3"),
        rectangle([50, 50], "q8"),
        rectangle([50, 50], "t6"),
        block([10, 10, 10], "hex8"),
        block([24, 24, 4], "hex8"),
        block([10, 10, 10], "tet4"),
        clamped("plane-strain", disc, "cut", "arc", "-y", plane(2)),
        clamped("space", ball, "cut", "round", "-z", plane(3)),
        bar(50_000),
    ];
    assert!(scenes.len() >= 10);
    let desk = Desk::new();
    for scene in scenes {
        let text = scene.to_string();
        desk.write("scene.json", &text);
        let estimate = Scene::from_json(&text, "scene").unwrap().size().bytes;
        let ratio = estimate / desk.peak(&["solve", "scene.json", "--method", "active-set"]);
        assert!(ratio < WITHIN && ratio > 1.0 / WITHIN, "{ratio:.2} of the peak: {}", scene["body"]);
    }
}

#[test]
fn an_export_takes_the_memory_of_the_model_alone_within_a_factor_of_two() {
    let scenes = [
        rectangle([200, 200], "q4"),
        rectangle([100, 100], "q8"),
        block([20, 20, 20], "hex8"),
        block([10, 10, 10], "tet10"),
        bar(100_000),
    ];
    let desk = Desk::new();
    for scene in scenes {
        desk.write("scene.json", scene.to_string());
        for form in ["matrix-market", "petsc"] {
            let export = ["export", "scene.json", form, "--format", form];
            let estimate = named_memory(&desk.run(&[&export[..], &["--max-memory", "1MB"]].concat()).ends_with(1));
            let peak = desk.peak(&export);
            let ratio = estimate / peak;
            assert!(ratio < WITHIN && ratio > 0.9, "{ratio:.2} of the peak {peak:e}: {form}, {}", scene["body"]);
            fs::remove_dir_all(desk.path(form)).unwrap();
        }
    }
}

/// The memory named in a refusal, in bytes.
fn named_memory(run: &Run) -> f64 {
    let (_, needed) = run.stderr.split_once("needs about ").unwrap_or_else(|| panic!("{}", run.stderr));
    let mut words = needed.split(' ');
    let number: f64 = words.next().unwrap().parse().unwrap();
    number * if words.next() == Some("GB") { 1e9 } else { 1e6 }
}

#[test]
fn the_estimate_of_a_problem_directory_is_within_a_factor_of_two_of_the_peak() {
    let scenes = [
        rectangle([80, 80], "q4"),
        rectangle([300, 12], "q4"),
        rectangle([50, 50], "q8"),
        block([10, 10, 10], "hex8"),
        block([10, 10, 10], "tet4"),
        bar(50_000),
    ];
    let desk = Desk::new();
    for scene in scenes {
        desk.write("scene.json", scene.to_string());
        desk.run(&["export", "scene.json", "p"]).ends_with(0);
        for options in ["--method active-set", "--method active-set --no-condense", "--method mprgp"] {
            let arguments: Vec<&str> = ["solve", "p"].into_iter().chain(options.split(' ')).collect();
            let refused = desk.run(&[&arguments[..], &["--max-memory", "1MB"]].concat());
            let estimate = named_memory(&refused.fails_with(1, &["1 MB are allowed", "of the stiffness"]));
            let ratio = estimate / desk.peak(&arguments);
            assert!(
                ratio < WITHIN && ratio > 1.0 / WITHIN,
                "{ratio:.2} of the peak with {options:?}, {}",
                scene["body"]
            );
        }
        fs::remove_dir_all(desk.path("p")).unwrap();
    }
}

#[test]
fn a_problem_directory_that_needs_too_much_memory_is_refused_before_its_factorisation() {
    let desk = Desk::new();
    desk.write("scene.json", block([20, 20, 20], "hex8").to_string());
    desk.run(&["export", "scene.json", "p"]).ends_with(0);
    for command in [&["compare", "p"][..], &["solve", "p", "--method", "active-set"]] {
        let refused = desk.run(&[command, &["--max-memory", "150MB"]].concat());
        refused.fails_with(1, &["150 MB are allowed", "3e4 dofs", "of its factor"]);
    }
    // Multigrid needs no factor, and is chosen because it is faster.
    for input in ["p", "scene.json"] {
        let run = desk.run(&["solve", input, "--max-memory", "150MB"]).ends_with(0);
        assert!(run.stdout.contains("by multigrid: a factorisation would take about"), "{}", run.stdout);
    }
    desk.run(&["solve", "p", "--max-memory", "20MB"]).fails_with(1, &["the problem does not fit into 20 MB of memory"]);
    desk.run(&["solve", "scene.json", "--max-memory", "20MB"])
        .fails_with(1, &["20 MB are allowed", "3e4 dofs", "its factor not counted"]);
}

#[test]
fn a_scene_of_a_million_million_elements_is_refused_at_once_and_without_memory() {
    let desk = Desk::new();
    let round = |body: &str| json!({body: {"radius": 1, "zone": {"width": 1, "divisions": 1_000_000}}});
    let cases = [
        (rectangle([1_000_000, 1_000_000], "q4"), "`body.rectangle`: 1000000 x 1000000 cells"),
        (block([10_000, 10_000, 10_000], "hex8"), "`body.box`: 10000 x 10000 x 10000 cells"),
        (
            clamped("plane-strain", round("half-disc"), "cut", "arc", "-y", json!({"body": {"boundary": ""}})),
            "cells make more",
        ),
        (
            clamped("space", round("half-ball"), "cut", "round", "-z", json!({"body": {"boundary": ""}})),
            "cells make more",
        ),
    ];
    let kilobytes = least_kilobytes(&desk) + REFUSAL_KILOBYTES;
    for (scene, phrase) in cases {
        desk.write("scene.json", scene.to_string());
        for command in ["solve scene.json", "compare scene.json", "export scene.json p", "tradeoff scene.json"] {
            confined(&desk, kilobytes, command).fails_with(1, &[phrase, "100000000 nodes that are allowed"]);
        }
    }
}

#[test]
fn max_memory_refuses_a_scene_with_its_size_and_accepts_one_that_fits() {
    let desk = Desk::new();
    desk.write("scene.json", rectangle([200, 200], "q4").to_string());
    for command in [&["compare", "scene.json"][..], &["solve", "scene.json", "--method", "qp"]] {
        let run = desk.run(&[command, &["--max-memory", "100MB"]].concat());
        run.fails_with(
            1,
            &[
                "needs about 1",
                " MB of memory, but 100 MB are allowed",
                "8e4 dofs",
                "6e6 of its factor",
                "larger cells",
            ],
        );
    }
    desk.run(&["sweep", "scene.json", "--gaps", "0:-0.01:2", "--max-memory", "0.1GB"]).fails_with(1, &["100 MB"]);
    desk.run(&["export", "scene.json", "p", "--max-memory", "1kB"]).fails_with(1, &["0 MB are allowed"]);
    desk.run(&["export", "scene.json", "p", "--max-memory", "1GB"]).ends_with(0);
    for size in ["100", "MB", "-1GB", "1e999GB", "nanMB", "0kB"] {
        desk.run(&["solve", "scene.json", "--max-memory", size]).ends_with(2);
    }
}

#[test]
fn files_with_fewer_entries_than_announced_are_refused_without_reserving_memory() {
    let desk = Desk::new();
    let right = Problem::right;
    let cases = [
        (Problem { k: matrix("symmetric", "100000000 100000000", &["1 1 1"]), ..right() }, "K.mtx:2"),
        (Problem { f: matrix("general", "100000000 1", &["1 1 1"]), ..right() }, "f.mtx:2"),
        (Problem { b: matrix("general", "1 100000000", &["1 1 1"]), ..right() }, "B.mtx:2"),
        (Problem { b: matrix("general", "100000000 2", &["1 1 1"]), ..right() }, "B.mtx:2"),
        (Problem { g: matrix("general", "100000000 1", &["1 1 1"]), ..right() }, "g.mtx:2"),
    ];
    for (problem, place) in cases {
        desk.problem("p", &problem);
        confined(&desk, FILE_KILOBYTES, "solve p").fails_with(1, &[place, "with 1 entries is almost empty"]);
    }
    let array = "%%MatrixMarket matrix array real general\n100000000 1\n1\n";
    desk.problem("p", &Problem { f: array.into(), ..right() });
    confined(&desk, FILE_KILOBYTES, "solve p").fails_with(1, &["f.mtx:3", "ends before the value of (2, 1)"]);
}

#[test]
fn endless_files_are_read_up_to_a_cap() {
    let desk = Desk::new();
    confined(&desk, FILE_KILOBYTES, "solve /dev/zero").fails_with(1, &["/dev/zero", "longer than 64 MB"]);
    desk.problem("p", &Problem::right());
    fs::remove_file(desk.path("p/K.mtx")).unwrap();
    std::os::unix::fs::symlink("/dev/zero", desk.path("p/K.mtx")).unwrap();
    confined(&desk, FILE_KILOBYTES, "solve p").fails_with(1, &["p/K.mtx", "longer than 64 MB"]);
    desk.write("scene.json", support::program::scene().to_string());
    let body = json!({"gmsh": {"file": "/dev/zero"}});
    desk.write(
        "mesh.json",
        clamped("plane-strain", body, "a", "b", "+y", json!({"body": {"boundary": ""}})).to_string(),
    );
    // A scene is compared with the memory left beside the blocks that matrix products reserve.
    confined(&desk, FILE_KILOBYTES + packed_kilobytes(), "solve mesh.json --allow-outside")
        .fails_with(1, &["/dev/zero", "longer than 64 MB"]);
    // A sparse file of 1 GB occupies no space on the disk.
    fs::File::create(desk.path("long.json")).unwrap().set_len(1 << 30).unwrap();
    confined(&desk, FILE_KILOBYTES, "solve long.json").fails_with(1, &["long.json", "longer than 256 MB"]);
    desk.write("u.mtx", vector(&["1"]));
}

#[test]
fn a_pipe_is_read_like_a_file() {
    let desk = Desk::new();
    desk.write("scene.json", support::program::scene().to_string());
    let script = format!("cat scene.json | '{}' solve /dev/stdin", env!("CARGO_BIN_EXE_signorini"));
    let output = Command::new("sh").args(["-c", &script]).current_dir(desk.path(".")).output().unwrap();
    assert!(output.status.success(), "{output:?}");
}

/// A system that cannot be solved yields NaN, which no certificate accepts.
#[test]
fn a_right_hand_side_of_wrong_length_yields_nan() {
    let matrix = SparseMatrix::from_triplets(2, 2, &[(0, 0, 2.0), (1, 1, 3.0)]).unwrap();
    let cholesky = Cholesky::of(&SymmetricMatrix::from_lower(matrix).unwrap()).unwrap();
    assert!(cholesky.solve(&[2.0, 3.0]).iter().all(|x| (x - 1.0_f64).abs() < 1e-14));
    assert!(cholesky.solve(&[1.0, 2.0, 3.0]).iter().all(|value| value.is_nan()));
    assert!(cholesky.solve(&[1.0]).iter().all(|value| value.is_nan()));
    assert!(cholesky.backward(vec![1.0]).iter().all(|value| value.is_nan()));
}
