//! The process: killed, interrupted, out of space or run again, it leaves whole files or none.
#![cfg(unix)]

mod program;

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use program::{Desk, example, scene};
use serde_json::Value;

/// How a file that waits to take its place is called.
const WAITING: &str = ".signorini-";

/// An interrupt ends the program within this.
const AT_ONCE: Duration = Duration::from_secs(1);

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

#[test]
fn an_interrupt_ends_the_program_at_once_with_its_exit_code() {
    let desk = Desk::new();
    let mut large = scene();
    for (axis, cells) in [("x", 1000), ("y", 500)] {
        large["body"]["rectangle"][axis]["divisions"] = serde_json::json!([cells]);
    }
    desk.write("large.json", large.to_string());
    let mut child = desk.command(&["solve", "large.json", "--out", "o"]).stdout(Stdio::null()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(200));
    assert!(child.try_wait().unwrap().is_none(), "it ended before it could be interrupted");
    let clock = Instant::now();
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(clock.elapsed() < AT_ONCE, "{:?}", clock.elapsed());
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
}
