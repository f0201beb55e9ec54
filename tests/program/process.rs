//! The process: killed, interrupted, out of space or run again, it leaves whole files or none.
#![cfg(unix)]

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::program::{Desk, Run, example, scene};
use serde_json::Value;

/// How a file that waits to take its place is called.
const WAITING: &str = ".signorini-";

/// A sweep that takes some seconds; without optimisation a gap takes ten times as long.
const LONG_SWEEP: &str = if cfg!(debug_assertions) { "0:-0.1:400" } else { "0:-0.1:4000" };

/// An interrupt ends the program within this.
const AT_ONCE: Duration = Duration::from_secs(1);

/// A second interrupt ends it within this, less than what it waits after the first.
const UNPATIENT: Duration = Duration::from_millis(700);

/// What was found is certified and printed within this, on a machine that does other things too.
const WITH_ANSWER: Duration = Duration::from_secs(5);

/// How the line of progress is taken back.
const ERASED: &str = "\r\x1b[K";

/// Asserts that every file in its place is whole, and tells how many there are.
fn whole(folder: &Path) -> usize {
    let Ok(entries) = fs::read_dir(folder) else { return 0 };
    let mut count = 0;
    for path in entries.map(|entry| entry.unwrap().path()) {
        let name = path.file_name().unwrap().to_str().unwrap().to_string();
        if name.starts_with(WAITING) {
            continue;
        }
        count += 1;
        let bytes = fs::read(&path).unwrap();
        let ends = |end: &str| assert!(bytes.trim_ascii_end().ends_with(end.as_bytes()), "{name} is broken");
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("svg") => ends("</svg>"),
            Some("vtu") => ends("</VTKFile>"),
            Some("json") => assert!(serde_json::from_slice::<Value>(&bytes).is_ok(), "{name} is broken"),
            Some("png") => assert!(bytes.ends_with(b"IEND\xaeB`\x82"), "{name} is broken"),
            Some("mtx") if name != "K.mtx" && name != "B.mtx" => {
                let text = String::from_utf8(bytes).unwrap();
                let size: Vec<usize> =
                    text.lines().nth(1).unwrap().split(' ').map(|count| count.parse().unwrap()).collect();
                assert!(
                    text.lines().count() == size.iter().product::<usize>() + 2 && text.ends_with('\n'),
                    "{name} is broken"
                );
            }
            Some("mtx") => {
                let text = String::from_utf8(bytes).unwrap();
                let entries: usize = text.lines().nth(1).unwrap().split(' ').nth(2).unwrap().parse().unwrap();
                assert!(text.lines().count() == entries + 2 && text.ends_with('\n'), "{name} is broken");
            }
            _ => panic!("what is {name}?"),
        }
    }
    count
}

#[test]
fn a_kill_at_any_moment_leaves_no_broken_file() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    let commands = [&["export", "block.json", "o"][..], &["solve", "block.json", "--out", "o"]];
    let lasts = commands.map(|arguments| {
        let clock = Instant::now();
        desk.run(arguments).ends_with(0);
        clock.elapsed()
    });
    let kills = if cfg!(debug_assertions) { 40 } else { 300 };
    let mut early = 0;
    for kill in 0..kills {
        // Pictures take their time: one run in five draws them.
        let which = usize::from(kill % 5 == 0);
        let (arguments, all) = (commands[which], lasts[which]);
        let mut child = desk.command(arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        // Moments spread evenly over a run and a little more.
        std::thread::sleep(all.mul_f64(1.1 * f64::from(kill) / f64::from(kills)));
        // Killed by SIGKILL.
        child.kill().unwrap();
        early += usize::from(!child.wait().unwrap().success());
        whole(&desk.path("o"));
        if kill % 3 == 0 {
            fs::remove_dir_all(desk.path("o")).unwrap_or(());
        }
    }
    assert!(early > 10, "only {early} of {kills} runs were killed before their end");
}

/// Files may grow to so many blocks only: the k-th write that needs more fails.
#[test]
fn a_write_that_fails_is_named_and_leaves_only_whole_files() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    let (mut failed, mut passed) = (0, 0);
    for blocks in [0, 1, 2, 4, 8, 16, 32, 64, 128, 256, 4096] {
        for command in ["solve block.json --out o", "compare block.json --out o", "export block.json o"] {
            let program = env!("CARGO_BIN_EXE_signorini");
            let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec '{program}' {command}");
            let output = Command::new("sh").args(["-c", &script]).current_dir(desk.path(".")).output().unwrap();
            let said = String::from_utf8(output.stderr).unwrap();
            match output.status.code() {
                Some(0) => passed += 1,
                Some(1) => {
                    failed += 1;
                    assert!(said.starts_with("error: cannot write o/") && said.lines().count() == 1, "{said}");
                }
                other => panic!("{command}, {blocks} blocks: {other:?}, {said}"),
            }
            whole(&desk.path("o"));
            let left = fs::read_dir(desk.path("o")).into_iter().flatten();
            let waiting =
                left.filter(|entry| entry.as_ref().unwrap().file_name().to_str().unwrap().starts_with(WAITING));
            assert_eq!(waiting.count(), 0, "{command}, {blocks} blocks");
            fs::remove_dir_all(desk.path("o")).unwrap_or(());
        }
    }
    assert!(failed >= 6 && passed >= 3, "{failed} failed, {passed} passed");
}

/// A block of so many by so many cells.
fn block(x: usize, y: usize) -> Value {
    let mut block = scene();
    for (axis, cells) in [("x", x), ("y", y)] {
        block["body"]["rectangle"][axis]["divisions"] = serde_json::json!([cells]);
    }
    block
}

/// A run that is interrupted after each of `delays`, its exit code and what it said; it must be under way until then.
fn interrupted(desk: &Desk, arguments: &[&str], delays: &[Duration]) -> (Run, Duration) {
    let mut child = desk.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut clock = Instant::now();
    for (number, delay) in delays.iter().enumerate() {
        std::thread::sleep(*delay);
        assert!(child.try_wait().unwrap().is_none(), "{arguments:?} ended before it could be interrupted");
        if number == 0 {
            clock = Instant::now();
        }
        assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    }
    let output = child.wait_with_output().unwrap();
    let taken = clock.elapsed();
    let run = Run {
        code: output.status.code().expect("an exit code, not a signal"),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    };
    (run.ends_with(130), taken)
}

#[test]
fn an_interrupt_of_what_cannot_stop_ends_the_program_at_once() {
    let desk = Desk::new();
    desk.write("large.json", block(1000, 500).to_string());
    let arguments = ["solve", "large.json", "--out", "o"];
    let (run, taken) = interrupted(&desk, &arguments, &[Duration::from_millis(200)]);
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", "interrupted\n"));
    assert!(taken < AT_ONCE, "{taken:?}");
    assert_eq!(whole(&desk.path("o")), 0);
}

#[test]
fn a_second_interrupt_does_not_wait() {
    let desk = Desk::new();
    desk.write("large.json", block(1000, 500).to_string());
    let delays = [Duration::from_millis(200), Duration::from_millis(50)];
    let fastest = (0..3).map(|_| {
        let (run, taken) = interrupted(&desk, &["solve", "large.json"], &delays);
        assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", "interrupted\n"));
        taken
    });
    let fastest = fastest.min().unwrap();
    assert!(fastest < UNPATIENT, "{fastest:?}");
}

/// The ladder of penalties on all dofs: a factorisation for each of its iterations, each with an answer.
#[test]
fn an_interrupted_solve_tells_the_best_answer_that_it_has() {
    let desk = Desk::new();
    desk.write("block.json", block(150, 150).to_string());
    let arguments = ["solve", "block.json", "--method", "penalty", "--no-condense", "--format", "json", "--out", "o"];
    let mut delay = Duration::from_millis(100);
    let run = loop {
        let (run, taken) = interrupted(&desk, &arguments, &[delay]);
        assert!(taken < WITH_ANSWER, "{taken:?}");
        if !run.stdout.is_empty() && run.json()["status"] != "interrupted" {
            break run;
        }
        // Nothing was found so far; half as long again is still far from the end.
        delay = delay.mul_f64(1.5);
    };
    let report = run.json();
    assert_eq!(report["status"], "not_certified");
    assert!(report["certificate"]["energy_error_bound"].as_f64().is_some_and(|bound| bound > 0.0), "{report}");
    assert!(report["contact"]["force"].as_f64().is_some_and(|force| force > 0.0), "{report}");
    assert!(run.stderr.ends_with("interrupted: the report is of what was found until then\n"), "{}", run.stderr);
    // Answer and report; pictures would take too long.
    assert_eq!(whole(&desk.path("o")), 3);
}

#[test]
fn an_interrupted_sweep_tells_the_gaps_that_were_done() {
    let desk = Desk::new();
    desk.write("block.json", block(40, 20).to_string());
    let arguments = ["sweep", "block.json", "--gaps", "0:-0.1:10000", "--format", "json", "--out", "o"];
    let (run, taken) = interrupted(&desk, &arguments, &[Duration::from_secs(1)]);
    assert!(taken < WITH_ANSWER, "{taken:?}");
    let points = run.json()["points"].as_array().unwrap().len();
    assert!((1..10_000).contains(&points), "{points}");
    assert!(run.stderr.starts_with("interrupted in gap ") && run.stderr.contains(" of 10000: "), "{}", run.stderr);
    assert_eq!(whole(&desk.path("o")), 1);
}

#[test]
fn an_interrupted_tradeoff_tells_the_points_that_were_measured() {
    let desk = Desk::new();
    let arguments = ["tradeoff", &example("indentation"), "--runs", "1000", "--format", "json"];
    let (run, taken) = interrupted(&desk, &arguments, &[Duration::from_secs(2)]);
    assert!(taken < WITH_ANSWER, "{taken:?}");
    let report = run.json();
    let points = report["points"].as_array().unwrap();
    assert!(!points.is_empty() && points.iter().all(|point| point["mesh"] == 0), "{report}");
    assert!(run.stderr.starts_with("interrupted in run "), "{}", run.stderr);
}

#[test]
fn an_interrupted_motion_leaves_its_frames_and_is_resumed_bit_for_bit() {
    let desk = Desk::new();
    let bar = serde_json::json!({
        "model": "bar",
        "body": {"bar": {"x": {"points": [0, 10], "divisions": [20]}}},
        "material": {"young": 900, "poisson": 0, "density": 1},
        "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [15], "normal": [1]}}}],
        "analysis": {"dynamic": {"duration": 2, "initial": [{"velocity": {"value": [10]}}], "frames": 60}}
    });
    desk.write("bar.json", bar.to_string());
    desk.run(&["solve", "bar.json", "--out", "all"]).ends_with(0);
    let arguments = ["solve", "bar.json", "--out", "o", "--format", "json"];
    let child = desk.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let clock = Instant::now();
    while !desk.path("o/series-00010.vtu").exists() && clock.elapsed() < Duration::from_secs(60) {
        std::thread::yield_now();
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.starts_with("interrupted in step ") && said.contains(" of 240: "), "{said}");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let steps = report["steps"].as_u64().unwrap();
    assert!(report["status"] == "not_certified" && (40..240).contains(&steps), "{report}");
    assert!(!desk.path("o/series-00060.vtu").exists() && !desk.path("o/history.png").exists());
    desk.run(&["solve", "bar.json", "--out", "o", "--resume"]).ends_with(0);
    let history = |folder: &str| fs::read(desk.path(folder).join("history.csv")).unwrap();
    assert!(history("o") == history("all"));
}

#[test]
fn a_motion_ends_at_its_time_limit() {
    let desk = Desk::new();
    let bar = serde_json::json!({
        "model": "bar",
        "body": {"bar": {"x": {"points": [0, 10], "divisions": [20]}}},
        "material": {"young": 900, "poisson": 0, "density": 1},
        "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [15], "normal": [1]}}}],
        "analysis": {"dynamic": {"duration": 20_000, "initial": [{"velocity": {"value": [10]}}]}}
    });
    desk.write("bar.json", bar.to_string());
    let run = desk.run(&["solve", "bar.json", "--time-limit", "0.5", "--format", "json"]).ends_with(4);
    assert_eq!(run.json()["status"], "not_certified");
    assert!(run.stderr.starts_with("out of time after step "), "{}", run.stderr);
}

/// Ten runs write the same bytes, the seconds in the report apart.
#[test]
fn ten_runs_write_the_same_bytes() {
    let desk = Desk::new();
    let files = |folder: &str| -> Vec<(String, Vec<u8>)> {
        let mut files: Vec<_> = fs::read_dir(desk.path(folder))
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .map(|path| (path.file_name().unwrap().to_str().unwrap().to_string(), fs::read(path).unwrap()))
            .collect();
        for (_, bytes) in files.iter_mut().filter(|(name, _)| name == "report.json") {
            let mut report: Value = serde_json::from_slice(bytes).unwrap();
            without_seconds(&mut report);
            *bytes = report.to_string().into_bytes();
        }
        files.sort();
        files
    };
    for run in 0..10 {
        desk.run(&["solve", &example("indentation"), "--out", &format!("o{run}")]).ends_with(0);
        assert_eq!(files(&format!("o{run}")), files("o0"), "run {run}");
    }
}

fn without_seconds(value: &mut Value) {
    match value {
        Value::Object(fields) => {
            fields.remove("seconds");
            fields.values_mut().for_each(without_seconds);
        }
        Value::Array(items) => items.iter_mut().for_each(without_seconds),
        _ => {}
    }
}

#[test]
fn no_progress_is_shown_where_nobody_watches() {
    let desk = Desk::new();
    let run = desk.run(&["solve", &example("indentation")]).ends_with(0);
    assert_eq!(run.stderr, "");
    desk.write("block.json", block(40, 20).to_string());
    let run = desk.run(&["sweep", "block.json", "--gaps", LONG_SWEEP]).ends_with(0);
    assert_eq!(run.stderr, "");
}

/// Runs the program with standard error on a terminal, and tells what it drew there.
fn drawn(desk: &Desk, arguments: &[&str]) -> String {
    let script = "import os, pty, sys
master, slave = pty.openpty()
child = os.fork()
if child == 0:
    os.close(master)
    os.dup2(slave, 2)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    os.execv(sys.argv[1], sys.argv[1:])
os.close(slave)
try:
    while piece := os.read(master, 4096):
        sys.stdout.buffer.write(piece)
except OSError:
    pass
sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))";
    let mut python = Command::new("python3");
    python.args(["-c", script, env!("CARGO_BIN_EXE_signorini")]).args(arguments).current_dir(desk.path("."));
    let output = python.output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn on_a_terminal_long_work_shows_what_it_does_and_leaves_nothing_of_it() {
    let desk = Desk::new();
    desk.write("block.json", block(40, 20).to_string());
    let drawn_by_sweep = drawn(&desk, &["sweep", "block.json", "--gaps", LONG_SWEEP]);
    let lines: Vec<&str> = drawn_by_sweep.split(ERASED).filter(|line| !line.is_empty()).collect();
    assert!(!lines.is_empty() && lines.iter().all(|line| line.chars().count() < 80), "{lines:?}");
    let (_, gaps) = LONG_SWEEP.rsplit_once(':').unwrap();
    let gap = format!(" of {gaps}, ");
    assert!(lines.iter().any(|line| line.contains("] gap ") && line.contains(&gap)), "{lines:?}");
    assert!(lines.iter().any(|line| line.contains(" s left: ")), "{lines:?}");
    assert!(drawn_by_sweep.ends_with(ERASED), "{drawn_by_sweep:?}");

    desk.write("large.json", block(400, 400).to_string());
    let drawn_by_solve = drawn(&desk, &["solve", "large.json"]);
    // What is done in the second that has begun depends on the machine.
    let steps = ["ordering", "factorisation", "certificate", "report"];
    assert!(steps.iter().any(|step| drawn_by_solve.contains(&format!(" s: {step}"))), "{drawn_by_solve:?}");
    assert!(drawn_by_solve.ends_with(ERASED), "{drawn_by_solve:?}");
}

#[test]
fn on_a_terminal_short_work_shows_nothing() {
    assert_eq!(drawn(&Desk::new(), &["solve", &example("bar")]), "");
}
