//! The process: killed, interrupted, out of space or run again, it leaves whole files or none.
//!
//! No clock: a test waits for what the program shows, a line of `--progress` or a file, and then acts on work that is far
//! from its end. A run that ended all the same before the test could act is repeated.
#![cfg(unix)]

use crate::program::{Desk, Run, example, scene};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

/// How a file that waits to take its place is called.
const WAITING: &str = ".signorini-";

/// A run may end before the test can act on it, but not so often in a row, however busy the machine is.
const TRIES: usize = 50;

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
            Some("html") => ends("</html>"),
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
            Some("csv") => {
                let text = String::from_utf8(bytes).unwrap();
                let cells = |line: &str| line.split(',').count();
                let first = text.lines().next().map_or(0, cells);
                assert!(text.ends_with('\n') && text.lines().all(|line| cells(line) == first), "{name} is broken");
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
    let there = || fs::read_dir(desk.path("o")).map_or(0, Iterator::count);
    // Pictures take their time: few runs draw them.
    let runs: [(&[&str], usize); 2] =
        [(&["export", "block.json", "o"], 40), (&["solve", "block.json", "--out", "o"], 6)];
    for (arguments, kills) in runs {
        fs::remove_dir_all(desk.path("o")).unwrap_or(());
        desk.run(arguments).ends_with(0);
        let all = whole(&desk.path("o"));
        // As many kills at each number of files, those counted that wait to take their place.
        for files in 0..=all {
            let mut killed = 0;
            for _ in 0..TRIES * kills {
                fs::remove_dir_all(desk.path("o")).unwrap_or(());
                let mut child = desk.command(arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
                while there() < files && child.try_wait().unwrap().is_none() {
                    std::thread::yield_now();
                }
                // By SIGKILL.
                child.kill().unwrap();
                let is_early = !child.wait().unwrap().success();
                // With the last file there may be nothing left to do.
                killed += usize::from(is_early || files == all);
                whole(&desk.path("o"));
                if killed == kills {
                    break;
                }
            }
            assert_eq!(killed, kills, "{arguments:?} always ended before it could be killed at {files} files");
        }
    }
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
                    let faults: Vec<&str> = said.lines().filter(|line| !line.starts_with("writing ")).collect();
                    assert!(faults.len() == 1 && faults[0].starts_with("error: cannot write o/"), "{said}");
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

/// The first run that `event` shows to be under way, that is then interrupted, and that was `cut` short by it. The folder
/// `o` holds what it left.
fn interrupted(desk: &Desk, arguments: &[&str], event: &str, cut: impl Fn(&Run) -> bool) -> Run {
    let mut runs = (0..TRIES).map(|_| {
        fs::remove_dir_all(desk.path("o")).unwrap_or(());
        let mut run = desk.start(arguments);
        assert!(run.waits_for(event), "{arguments:?} never came to {event:?}");
        run.interrupt();
        run.ends(true)
    });
    runs.find(|run| run.code == 130 && cut(run)).expect("a run that was cut short")
}

/// Whether it notices the interrupt behind the factorisation or is ended in it depends on the machine.
#[test]
fn an_interrupt_of_a_factorisation_ends_the_program_without_an_answer() {
    let desk = Desk::new();
    desk.write("large.json", block(1000, 500).to_string());
    let solve = ["solve", "large.json", "--method", "active-set", "--out", "o"];
    let run = interrupted(&desk, &solve, "factorisation", |_| true);
    assert!(run.stdout.is_empty() && run.stderr.lines().count() == 1, "{}{}", run.stdout, run.stderr);
    assert!(run.stderr.contains("interrupted"), "{}", run.stderr);
    assert_eq!(whole(&desk.path("o")), 0);
}

/// A program that waits for the reader of its report looks no more whether it should end.
#[test]
fn an_interrupt_that_is_not_noticed_ends_the_program() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    let mut run = desk.start(&["sweep", "block.json", "--gaps", "0:-0.1:1000", "--format", "json"]);
    run.waits_for_report();
    run.interrupt();
    let run = run.ends(false).ends_with(130);
    assert_eq!(run.stderr, "interrupted\n");
}

/// The first is noticed, and leads to a report that nobody reads.
#[test]
fn a_second_interrupt_does_not_wait() {
    let desk = Desk::new();
    desk.write("block.json", block(40, 20).to_string());
    let mut run = desk.start(&["sweep", "block.json", "--gaps", "0:-0.1:10000", "--format", "json"]);
    assert!(run.waits_for("gap 1000 of 10000"));
    run.interrupt();
    assert!(run.waits_for("interrupted in gap "));
    run.waits_for_report();
    run.interrupt();
    let run = run.ends(false).ends_with(130);
    let said: Vec<&str> = run.stderr.lines().collect();
    assert!(said.len() == 2 && said[1] == "interrupted", "{said:?}");
}

/// The ladder of penalties on all dofs: a factorisation for each of its iterations, each with an answer. On a slow machine
/// a small body has iterations that end soon enough after the interrupt, on a fast one a large body has enough to do.
#[test]
fn an_interrupted_solve_tells_the_best_answer_that_it_has() {
    let desk = Desk::new();
    let arguments = ["solve", "block.json", "--method", "penalty", "--no-condense", "--format", "json", "--out", "o"];
    let mut runs = [100, 50, 150].into_iter().cycle().take(TRIES).map(|cells| {
        desk.write("block.json", block(cells, cells).to_string());
        interrupted(&desk, &arguments, "penalty loop, iteration 2", |_| true)
    });
    let has_answer = |run: &Run| !run.stdout.is_empty() && run.json()["status"] == "not_certified";
    let run = runs.find(has_answer).expect("a run that was interrupted with an answer");
    let report = run.json();
    assert!(report["certificate"]["energy_error_bound"].as_f64().is_some_and(|bound| bound > 0.0), "{report}");
    assert!(report["contact"]["force"].as_f64().is_some_and(|force| force > 0.0), "{report}");
    assert!(run.stderr.ends_with("interrupted: the report is of what was found until then\n"), "{}", run.stderr);
    // Answer with its tables, and report; pictures would take too long.
    assert_eq!(whole(&desk.path("o")), 6);
}

/// A mesh of the search takes longer than an interrupt waits: the report of the mesh before is kept.
#[test]
fn an_interrupted_total_error_tells_the_best_bound() {
    let desk = Desk::new();
    desk.write("block.json", block(200, 100).to_string());
    let arguments = ["solve", "block.json", "--total-error", "1e-9", "--format", "json"];
    let run = interrupted(&desk, &arguments, "mesh, iteration 2", |_| true);
    let report = run.json();
    assert!(report["status"] == "not_certified" && report["ended"] == "time", "{report}");
    assert!(report["levels"].as_array().unwrap().len() >= 2, "{report}");
    assert!(report["total_error"]["bound"].as_f64().is_some_and(|bound| bound < 0.5), "{report}");
    assert!(run.stderr.ends_with("interrupted: the report is of what was found until then\n"), "{}", run.stderr);
}

#[test]
fn an_interrupted_sweep_tells_the_gaps_that_were_done() {
    let desk = Desk::new();
    desk.write("block.json", block(40, 20).to_string());
    let arguments = ["sweep", "block.json", "--gaps", "0:-0.1:10000", "--format", "json", "--out", "o"];
    let points = |run: &Run| run.json()["points"].as_array().unwrap().len();
    let run = interrupted(&desk, &arguments, "gap 5 of 10000", |run| !run.stdout.is_empty() && points(run) < 10_000);
    assert!(points(&run) >= 4, "{}", points(&run));
    assert!(run.stderr.starts_with("interrupted in gap ") && run.stderr.contains(" of 10000: "), "{}", run.stderr);
    assert_eq!(whole(&desk.path("o")), 1);
}

#[test]
fn an_interrupted_tradeoff_tells_the_points_that_were_measured() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    let arguments = ["tradeoff", "block.json", "--runs", "1000", "--format", "json"];
    // Every way has been run once by then, on the first mesh.
    let run = interrupted(&desk, &arguments, "run 101 of ", |run| {
        !run.stdout.is_empty() && run.json()["points"].as_array().unwrap().iter().all(|point| point["mesh"] == 0)
    });
    assert!(!run.json()["points"].as_array().unwrap().is_empty(), "{}", run.stdout);
    assert!(run.stderr.starts_with("interrupted in run "), "{}", run.stderr);
}

/// A bar that flies against a wall and back for so long.
fn bar(duration: f64) -> Value {
    serde_json::json!({
        "model": "bar",
        "body": {"bar": {"x": {"points": [0, 10], "divisions": [20]}}},
        "material": {"young": 900, "poisson": 0, "density": 1},
        "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [15], "normal": [1]}}}],
        "analysis": {"dynamic": {"duration": duration, "initial": [{"velocity": {"value": [10]}}], "frames": 60}}
    })
}

/// Longer than anybody waits: a hundred million steps and more.
const ENDLESS: f64 = 1e6;

#[test]
fn an_interrupted_motion_leaves_its_frames_and_is_resumed_bit_for_bit() {
    let desk = Desk::new();
    desk.write("bar.json", bar(20.0).to_string());
    desk.run(&["solve", "bar.json", "--out", "all"]).ends_with(0);
    let arguments = ["solve", "bar.json", "--out", "o", "--format", "json"];
    let steps = |run: &Run| run.json()["steps"].as_u64().unwrap();
    let is_cut = |run: &Run| !run.stdout.is_empty() && steps(run) < 2400;
    let run = interrupted(&desk, &arguments, "step 401 of 2400", is_cut);
    assert!(run.stderr.starts_with("interrupted in step ") && run.stderr.contains(" of 2400: "), "{}", run.stderr);
    assert!(run.json()["status"] == "not_certified" && steps(&run) >= 400, "{}", run.stdout);
    assert!(!desk.path("o/series-00060.vtu").exists() && !desk.path("o/history.png").exists());
    desk.run(&["solve", "bar.json", "--out", "o", "--resume"]).ends_with(0);
    let history = |folder: &str| fs::read(desk.path(folder).join("history.csv")).unwrap();
    assert!(history("o") == history("all"));
}

#[test]
fn a_motion_ends_at_its_time_limit() {
    let desk = Desk::new();
    desk.write("bar.json", bar(ENDLESS).to_string());
    // On a slow machine the time may be over before the first step.
    let mut runs = ["0.5", "5", "50"]
        .iter()
        .map(|limit| desk.run(&["solve", "bar.json", "--time-limit", limit, "--format", "json"]).ends_with(4));
    let run = runs.find(|run| run.stderr.starts_with("out of time after step ")).expect("a motion that began");
    assert_eq!(run.json()["status"], "not_certified");
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

/// Work that lasts longer than a second on every machine: a second is what passes before a terminal shows anything.
#[test]
fn no_progress_is_shown_where_nobody_watches() {
    let desk = Desk::new();
    desk.write("bar.json", bar(ENDLESS).to_string());
    let run = desk.run(&["solve", "bar.json", "--time-limit", "1.5"]).ends_with(4);
    // That its time is over, and nothing else.
    assert!(run.stderr.lines().count() == 1 && !run.stderr.contains('\r'), "{:?}", run.stderr);
}

#[test]
fn each_step_is_a_line_where_progress_is_asked_for() {
    let desk = Desk::new();
    let run = desk.run(&["solve", &example("indentation"), "--out", "o", "--progress"]).ends_with(0);
    let steps: Vec<&str> = run.stderr.lines().map(|line| line.strip_prefix("progress: ").unwrap()).collect();
    let places =
        ["assembly", "ordering", "factorisation", "active set, iteration 1", "certificate", "report", "pictures"]
            .map(|step| steps.iter().position(|line| *line == step).unwrap_or_else(|| panic!("{step}: {steps:?}")));
    assert!(places.is_sorted(), "{steps:?}");
    let run = desk.run(&["--progress", "sweep", &example("bar"), "--gaps", "0:-1:3"]).ends_with(0);
    assert!(run.stderr.contains("progress: gap 3 of 3\n"), "{}", run.stderr);
}

/// Runs the program with standard error on a terminal and tells what it drew there; it is interrupted as soon as it has
/// drawn all of `awaited`, and then must end with 130, else with 0.
fn drawn(desk: &Desk, arguments: &[&str], awaited: &[&str]) -> String {
    let script = "import os, pty, re, signal, sys
program, count, *rest = sys.argv[1:]
awaited, arguments = rest[:int(count)], rest[int(count):]
master, slave = pty.openpty()
child = os.fork()
if child == 0:
    os.close(master)
    os.dup2(slave, 2)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    os.execv(program, [program, *arguments])
os.close(slave)
drawn, is_awaited = b'', bool(awaited)
try:
    while piece := os.read(master, 4096):
        drawn += piece
        if is_awaited and all(re.search(pattern.encode(), drawn) for pattern in awaited):
            is_awaited = False
            os.kill(child, signal.SIGINT)
except OSError:
    pass
sys.stdout.buffer.write(drawn)
sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))";
    let mut python = desk.by_python(script);
    let output = python.arg(awaited.len().to_string()).args(awaited).args(arguments).output().unwrap();
    let code = if awaited.is_empty() { 0 } else { 130 };
    assert_eq!(output.status.code(), Some(code), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// What is left on a terminal that erases its last line at each `ERASED`, and all that it showed.
fn left_and_shown(drawn: &str) -> (&str, Vec<&str>) {
    let mut lines: Vec<&str> = drawn.split(ERASED).collect();
    let left = lines.pop().unwrap();
    lines.retain(|line| !line.is_empty());
    (left, lines)
}

#[test]
fn on_a_terminal_long_work_shows_what_it_does_and_leaves_nothing_of_it() {
    let desk = Desk::new();
    desk.write("block.json", block(100, 100).to_string());
    let awaited = ["\\] [0-9]+ % gap [0-9]+ of 10000, ", " s left: "];
    let drawn_by_sweep = drawn(&desk, &["sweep", "block.json", "--gaps", "0:-0.1:10000"], &awaited);
    let (left, shown) = left_and_shown(&drawn_by_sweep);
    assert!(!shown.is_empty() && shown.iter().all(|line| line.chars().count() < 80), "{shown:?}");
    assert!(left.starts_with("interrupted in gap ") && left.lines().count() == 1, "{left:?}");

    desk.write("large.json", block(1000, 500).to_string());
    // What is done in the second that has begun depends on the machine.
    let awaited = ["[0-9] s (passed|left of this): (ordering|factorisation|certificate|report)"];
    let drawn_by_solve = drawn(&desk, &["solve", "large.json", "--method", "active-set"], &awaited);
    let (left, _) = left_and_shown(&drawn_by_solve);
    assert!(left.contains("interrupted") && left.lines().count() == 1, "{drawn_by_solve:?}");
}

/// It is short where the machine is not very slow; the first second shows nothing anywhere.
#[test]
fn on_a_terminal_short_work_shows_nothing() {
    let drawn = drawn(&Desk::new(), &["solve", &example("bar")], &[]);
    let (left, shown) = left_and_shown(&drawn);
    assert!(left.is_empty() && shown.iter().all(|line| !line.starts_with("0 s passed")), "{drawn:?}");
}
