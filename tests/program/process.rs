//! A process that is killed, interrupted, out of disk space or run again leaves only complete files.
//!
//! The tests read no clock: a test waits for output of the program, a line of `--progress` or a file, and then acts on
//! work that is far from its end. If a run ends before the test can act, it is repeated.
#![cfg(unix)]

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use support::cases;
use support::program::{Desk, Run, example, scene};

/// Start of the name of a file that is complete before it is renamed to its place.
const WAITING: &str = ".signorini-";

/// Largest number of repetitions: a run may end before the test can act on it, but not this often in a row, even on a
/// busy machine.
const TRIES: usize = 50;

/// The characters that erase the progress line.
const ERASED: &str = "\r\x1b[K";

/// Asserts that every file in its place is complete, and returns the number of files.
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
            _ => panic!("{name} has an unknown kind"),
        }
    }
    count
}

#[test]
fn a_kill_at_any_moment_leaves_no_broken_file() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    let there = || fs::read_dir(desk.path("o")).map_or(0, Iterator::count);
    // Pictures take long, so only a few runs draw them.
    let runs: [(&[&str], usize); 2] =
        [(&["export", "block.json", "o"], cases(5, 40)), (&["solve", "block.json", "--out", "o"], cases(1, 6))];
    for (arguments, kills) in runs {
        fs::remove_dir_all(desk.path("o")).unwrap_or(());
        desk.run(arguments).ends_with(0);
        let all = whole(&desk.path("o"));
        // The same number of kills at each number of files, including temporary files that are not yet renamed.
        for files in 0..=all {
            let mut killed = 0;
            for _ in 0..TRIES * kills {
                fs::remove_dir_all(desk.path("o")).unwrap_or(());
                let mut child = desk.command(arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
                while there() < files && child.try_wait().unwrap().is_none() {
                    std::thread::yield_now();
                }
                // Ends the program by SIGKILL.
                child.kill().unwrap();
                let is_early = !child.wait().unwrap().success();
                // When the last file exists, the program may have finished.
                killed += usize::from(is_early || files == all);
                whole(&desk.path("o"));
                if killed == kills {
                    break;
                }
            }
            assert_eq!(killed, kills, "{arguments:?} ended too often before it could be killed at {files} files");
        }
    }
}

/// The size of files is limited to `blocks` blocks: the first write beyond the limit fails.
#[test]
fn a_failed_write_is_named_and_leaves_only_complete_files() {
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

/// A block of `x` by `y` cells.
fn block(x: usize, y: usize) -> Value {
    let mut block = scene();
    for (axis, cells) in [("x", x), ("y", y)] {
        block["body"]["rectangle"][axis]["divisions"] = serde_json::json!([cells]);
    }
    block
}

/// A block of `x` by `x / 2` cells, in the long form of a million dofs.
fn large(x: usize) -> Value {
    let x = cases(x, 1000);
    block(x, x / 2)
}

/// The first run that is interrupted after `event` and that `cut` accepts as interrupted early. The folder `o` holds
/// its files.
fn interrupted(desk: &Desk, arguments: &[&str], event: &str, cut: impl Fn(&Run) -> bool) -> Run {
    let mut runs = (0..TRIES).map(|_| {
        fs::remove_dir_all(desk.path("o")).unwrap_or(());
        let mut run = desk.start(arguments);
        assert!(run.waits_for(event), "{arguments:?} did not show {event:?}");
        run.interrupt();
        run.ends(true)
    });
    runs.find(|run| run.code == 130 && cut(run)).expect("no run was interrupted early")
}

/// It depends on the machine whether the program notices the interrupt after the factorisation or is ended during it.
#[test]
fn an_interrupt_of_a_factorisation_ends_the_program_without_an_answer() {
    let desk = Desk::new();
    desk.write("large.json", large(600).to_string());
    let solve = ["solve", "large.json", "--method", "active-set", "--out", "o"];
    let run = interrupted(&desk, &solve, "factorisation", |_| true);
    assert!(run.stdout.is_empty() && run.stderr.lines().count() == 1, "{}{}", run.stdout, run.stderr);
    assert!(run.stderr.contains("interrupted"), "{}", run.stderr);
    assert_eq!(whole(&desk.path("o")), 0);
}

/// While the program waits for the reader of its report, it does not check for requests to stop.
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

/// The first interrupt is noticed, and leads to a report that nobody reads.
#[test]
fn a_second_interrupt_ends_the_program_at_once() {
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

/// The ladder of penalties on all dofs: every iteration is a factorisation and yields an answer. On a slow machine, the
/// iterations of a small body end soon enough after the interrupt; on a fast machine, a large body runs long enough.
#[test]
fn an_interrupted_solve_reports_its_best_answer() {
    let desk = Desk::new();
    let arguments = ["solve", "block.json", "--method", "penalty", "--no-condense", "--format", "json", "--out", "o"];
    let mut runs = [100, 50, 150].into_iter().cycle().take(TRIES).map(|cells| {
        desk.write("block.json", block(cells, cells).to_string());
        interrupted(&desk, &arguments, "penalty loop, iteration 2", |_| true)
    });
    let has_answer = |run: &Run| !run.stdout.is_empty() && run.json()["status"] == "not_certified";
    let run = runs.find(has_answer).expect("no interrupted run reported an answer");
    let report = run.json();
    assert!(report["certificate"]["energy_error_bound"].as_f64().is_some_and(|bound| bound > 0.0), "{report}");
    assert!(report["contact"]["force"].as_f64().is_some_and(|force| force > 0.0), "{report}");
    assert!(run.stderr.ends_with("interrupted: the report has the results up to there\n"), "{}", run.stderr);
    // The answer with its tables, and the report; pictures would take too long.
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
    assert!(run.stderr.ends_with("interrupted: the report has the results up to there\n"), "{}", run.stderr);
}

#[test]
fn an_interrupted_sweep_reports_the_gaps_solved_so_far() {
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
fn an_interrupted_tradeoff_reports_the_points_measured_so_far() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    let arguments = ["tradeoff", "block.json", "--runs", "1000", "--format", "json"];
    // By then every method has run once on the first mesh.
    let run = interrupted(&desk, &arguments, "run 101 of ", |run| {
        !run.stdout.is_empty() && run.json()["points"].as_array().unwrap().iter().all(|point| point["mesh"] == 0)
    });
    assert!(!run.json()["points"].as_array().unwrap().is_empty(), "{}", run.stdout);
    assert!(run.stderr.starts_with("interrupted in run "), "{}", run.stderr);
}

/// A bar that flies against a wall and back, for the given duration.
fn bar(duration: f64) -> Value {
    serde_json::json!({
        "model": "bar",
        "body": {"bar": {"x": {"points": [0, 10], "divisions": [20]}}},
        "material": {"young": 900, "poisson": 0, "density": 1},
        "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [15], "normal": [1]}}}],
        "analysis": {"dynamic": {"duration": duration, "initial": [{"velocity": {"value": [10]}}], "frames": 60}}
    })
}

/// A duration that no test waits for: sixty million steps.
const ENDLESS: f64 = 1e6;

#[test]
fn an_interrupted_motion_keeps_its_frames_and_is_resumed_bit_for_bit() {
    let desk = Desk::new();
    desk.write("bar.json", bar(40.0).to_string());
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
    let run = runs
        .find(|run| run.stderr.starts_with("error: out of time after step "))
        .expect("no motion began before its time limit");
    assert_eq!(run.json()["status"], "not_certified");
}

/// Ten runs, or three in the short form, write the same bytes, except the seconds in the report.
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
    for run in 0..cases(3, 10) {
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

/// The work lasts longer than a second on every machine; a terminal shows nothing during the first second.
#[test]
fn no_progress_is_shown_without_a_terminal() {
    let desk = Desk::new();
    desk.write("bar.json", bar(ENDLESS).to_string());
    let run = desk.run(&["solve", "bar.json", "--time-limit", "1.5"]).ends_with(4);
    // The message says only that the time is over.
    assert!(run.stderr.lines().count() == 1 && !run.stderr.contains('\r'), "{:?}", run.stderr);
}

#[test]
fn the_option_progress_prints_a_line_for_each_step() {
    let desk = Desk::new();
    let run = desk.run(&["solve", &example("indentation"), "--out", "o", "--progress"]).ends_with(0);
    let steps: Vec<&str> = run.stderr.lines().map(|line| line.strip_prefix("progress: ").unwrap()).collect();
    let places =
        ["assembly", "ordering", "factorisation", "active set, iteration 1", "certificate", "report", "pictures"]
            .map(|step| steps.iter().position(|line| *line == step).unwrap_or_else(|| panic!("{step}: {steps:?}")));
    assert!(places.is_sorted(), "{steps:?}");
    let run = desk.run(&["--progress", "sweep", &example("bar"), "--gaps", "0:-0.5:3"]).ends_with(0);
    assert!(run.stderr.contains("progress: gap 3 of 3\n"), "{}", run.stderr);
}

/// Runs the program with standard error on a terminal and returns what it drew there. As soon as all of `awaited` is
/// drawn, the program is interrupted and must end with 130; if `awaited` is empty, it must end with 0.
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

/// The text that remains on a terminal which erases its last line at each `ERASED`, and all texts that it showed.
fn left_and_shown(drawn: &str) -> (&str, Vec<&str>) {
    let mut lines: Vec<&str> = drawn.split(ERASED).collect();
    let left = lines.pop().unwrap();
    lines.retain(|line| !line.is_empty());
    (left, lines)
}

#[test]
fn long_work_shows_its_progress_on_a_terminal_and_erases_it() {
    let desk = Desk::new();
    desk.write("block.json", block(100, 100).to_string());
    let awaited = ["\\] [0-9]+ % gap [0-9]+ of 4000, ", " s left: "];
    let drawn_by_sweep = drawn(&desk, &["sweep", "block.json", "--gaps", "0:-0.1:4000"], &awaited);
    let (left, shown) = left_and_shown(&drawn_by_sweep);
    assert!(!shown.is_empty() && shown.iter().all(|line| line.chars().count() < 80), "{shown:?}");
    assert!(left.starts_with("interrupted in gap ") && left.lines().count() == 1, "{left:?}");

    desk.write("large.json", large(600).to_string());
    // The step that runs after the first second depends on the machine.
    let awaited = ["[0-9] s (passed|left of this): (ordering|factorisation|certificate|report)"];
    let drawn_by_solve = drawn(&desk, &["solve", "large.json", "--method", "active-set"], &awaited);
    let (left, _) = left_and_shown(&drawn_by_solve);
    assert!(left.contains("interrupted") && left.lines().count() == 1, "{drawn_by_solve:?}");
}

/// This work is short except on a very slow machine; during the first second nothing is shown on any machine.
#[test]
fn short_work_shows_no_progress_on_a_terminal() {
    let drawn = drawn(&Desk::new(), &["solve", &example("bar")], &[]);
    let (left, shown) = left_and_shown(&drawn);
    assert!(left.is_empty() && shown.iter().all(|line| !line.starts_with("0 s passed")), "{drawn:?}");
}
