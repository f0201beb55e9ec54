//! The README agrees with the program: its first screen names the command that solves and the one that tests, its code
//! is the doctest, its table of signs is that of the library, and its commands exist.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

fn read(name: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).unwrap()
}

/// The front page of the library without the comment marks and without hidden lines.
fn front_page() -> String {
    let lines = read("src/lib.rs");
    let page =
        lines.lines().filter_map(|line| line.strip_prefix("//!")).map(|line| line.strip_prefix(' ').unwrap_or(line));
    page.filter(|line| !line.starts_with("# Ok")).map(|line| format!("{line}\n")).collect()
}

fn block<'a>(text: &'a str, start: &str) -> &'a str {
    let inside = text.split_once(start).unwrap_or_else(|| panic!("there is no block {start:?}")).1;
    inside.split_once("```").unwrap().0.trim()
}

/// The lines that a reader sees first.
const FIRST_SCREEN: usize = 40;

const SOLVES: &str = "cargo run --release -- solve examples/indentation.json --out answer";

#[test]
fn the_first_screen_names_one_command_that_solves_and_one_that_tests() {
    let readme = read("README.md");
    let lines: Vec<&str> = readme.lines().take(FIRST_SCREEN).collect();
    let screen = lines.join("\n");
    assert_eq!(screen.matches("```sh\n").count(), 1, "{screen}");
    assert_eq!(block(&screen, "```sh\n"), [SOLVES, "./test.sh"].join("\n"));
    assert!(read(".gitignore").lines().any(|line| line == "/answer"), "git sees what the first command leaves");
    let minutes = ["about five minutes", "6 minutes on two cores", "18 minutes the first time"];
    assert!(minutes.iter().all(|minutes| screen.contains(minutes)), "{screen}");
}

#[test]
fn the_first_command_leaves_the_files_that_the_readme_names() {
    let readme = read("README.md");
    let sentence = readme.split("it leaves ").nth(1).unwrap().split(". ").next().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("answer");
    let arguments = SOLVES.strip_prefix("cargo run --release -- ").unwrap().strip_suffix("answer").unwrap();
    let run = Command::new(env!("CARGO_BIN_EXE_signorini"))
        .args(arguments.split_whitespace())
        .arg(&out)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(run.status.success(), "{run:?}");
    let names: Vec<&str> = sentence.split('`').skip(1).step_by(2).collect();
    assert_eq!(names.len(), 3, "{sentence}");
    for name in names {
        assert!(out.join(name).is_file(), "there is no {name}");
    }
}

/// Runs `./test.sh needs`, which installs nothing, as a user who is not root, where no programs exist but those given,
/// by their name and exit code. Returns whether it succeeds, and its lines.
fn needs(programs: &[(&str, i32)], variables: &[(&str, &str)]) -> (bool, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let found =
        |name: &str| ["/bin", "/usr/bin"].map(|at| Path::new(at).join(name)).into_iter().find(|file| file.exists());
    for name in ["bash", "dirname", "grep", "mkdir"] {
        std::os::unix::fs::symlink(found(name).unwrap(), folder.path().join(name)).unwrap();
    }
    for (name, code) in programs.iter().chain(&[("id", 0)]) {
        let file = folder.path().join(name);
        let prints = if *name == "id" { "echo 1000" } else { "" };
        fs::write(&file, format!("#!/bin/sh\n{prints}\nexit {code}\n")).unwrap();
        fs::set_permissions(&file, fs::Permissions::from_mode(0o755)).unwrap();
    }
    let output = Command::new(Path::new(env!("CARGO_MANIFEST_DIR")).join("test.sh"))
        .arg("needs")
        .env_clear()
        .env("PATH", folder.path())
        .env("CARGO_TARGET_DIR", folder.path().join("target"))
        .envs(variables.iter().copied())
        .output()
        .unwrap();
    let text = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
    (output.status.success(), text.lines().map(String::from).collect())
}

#[test]
fn tests_need_the_named_tools_and_skip_the_rest_by_name() {
    let readme = read("README.md");
    let (is_fine, lines) = needs(&[("python3", 1), ("cargo", 0)], &[]);
    assert!(!is_fine && lines == ["test.sh needs python3, version 3.11 or later"], "{lines:?}");
    let (is_fine, lines) = needs(&[("cargo", 1), ("python3", 0)], &[]);
    assert!(!is_fine && lines.len() == 1 && lines[0].starts_with("test.sh needs cargo"), "{lines:?}");
    let script = read("test.sh");
    let needed = script.lines().filter_map(|line| line.strip_prefix("need \""));
    let needed: Vec<&str> = needed.map(|line| line.split([' ', ',', ':']).next().unwrap()).collect();
    assert_eq!(needed, ["cargo", "rustfmt", "clippy", "python3", "venv"]);
    let sentence = readme.split("It needs ").nth(1).unwrap().split(". ").next().unwrap();
    assert!(needed.iter().all(|tool| sentence.contains(tool)), "{sentence}");
    // Where everything but mpirun is found, exactly the step that needs it is named. Every step is chosen, because
    // there is no history.
    const UNKNOWN: &str = "== no commit of this history is known at which all steps passed";
    let found = [("cargo", 0), ("python3", 0), ("valgrind", 0)];
    let (is_fine, lines) = needs(&found, &[]);
    assert!(is_fine && lines[0] == "== skipped: distributed: there is no mpirun", "{lines:?}");
    assert!(lines[1].contains("INSTALL=1") && lines[1].ends_with(": openmpi-bin"), "{lines:?}");
    assert!(lines[2..] == [UNKNOWN], "{lines:?}");
    let (is_fine, lines) = needs(&found, &[("SKIP", "never")]);
    assert!(!is_fine && lines.last().unwrap().contains("SKIP=never"), "{lines:?}");
    let all = [&found[..], &[("mpirun", 0)]].concat();
    assert_eq!(needs(&all, &[("SKIP", "never")]), (true, vec![UNKNOWN.to_string()]));
    // It says what it installs before it does.
    let with_apt = [&found[..], &[("apt-get", 1)]].concat();
    let (is_fine, lines) = needs(&with_apt, &[("INSTALL", "1")]);
    assert!(is_fine && lines == ["== test.sh installs by apt-get: openmpi-bin"], "{lines:?}");
}

/// The rows of the table of steps: class, lane, name, command, files.
fn rows(script: &str) -> Vec<Vec<String>> {
    let table = script.split("\ntable=\"\n").nth(1).unwrap().split("\n\"\n").next().unwrap();
    table.lines().map(|row| row.split('|').map(|cell| cell.trim().to_string()).collect()).collect()
}

#[test]
fn every_long_step_names_files_that_exist() {
    let rows = rows(&read("test.sh"));
    let of_class =
        |class: &str| rows.iter().filter(|row| row[0] == class).map(|row| row[2].as_str()).collect::<Vec<_>>();
    assert_eq!(of_class("every"), ["format", "lints and build"]);
    assert_eq!(of_class("code"), ["tests", "lessons", "Python", "validation", "ledger"]);
    assert_eq!(of_class("long").len(), rows.len() - 8);
    for row in rows.iter().filter(|row| row[0] == "long") {
        assert!(!row[4].is_empty(), "{row:?}");
        let list = ["-c", &format!("ls -d {}", row[4])];
        let listed = Command::new("sh").args(list).current_dir(env!("CARGO_MANIFEST_DIR")).output().unwrap();
        assert!(listed.status.success(), "{row:?}: {}", String::from_utf8_lossy(&listed.stderr));
    }
}

/// A history whose last full pass is its first commit, with a file of each kind.
fn history() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for file in [
        "README.md",
        "docs/scenes.md",
        "crates/qp/src/lib.rs",
        "crates/qp/src/cone.rs",
        "studies/main.rs",
        "tests/full-pass.txt",
    ] {
        let file = folder.path().join(file);
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(file, "").unwrap();
    }
    fs::copy(Path::new(env!("CARGO_MANIFEST_DIR")).join("test.sh"), folder.path().join("test.sh")).unwrap();
    let commit = "git init -q && git add . && git -c user.name=a -c user.email=a@b commit -qm a && git rev-parse HEAD >tests/full-pass.txt";
    assert!(Command::new("sh").args(["-c", commit]).current_dir(&folder).status().unwrap().success());
    folder
}

/// The steps that `./test.sh needs` leaves out if these files of a [`history`] change.
fn left_out(files: &[&str], folder: &Path) -> Vec<String> {
    for file in files {
        fs::write(folder.join(file), "changed").unwrap();
    }
    let target = folder.join(".git/target");
    let output = Command::new(folder.join("test.sh")).arg("needs").env("CARGO_TARGET_DIR", target).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix("== left out, because their files are as at the last full pass: "));
    line.map_or(Vec::new(), |names| names.split(", ").map(String::from).collect())
}

#[test]
fn a_change_chooses_the_steps_that_it_may_break() {
    let rows = rows(&read("test.sh"));
    let of_class =
        |class: &str| rows.iter().filter(|row| row[0] == class).map(|row| row[2].clone()).collect::<Vec<_>>();
    let all_but = |chosen: &[&str], classes: &[&str]| {
        let names = rows.iter().filter(|row| classes.contains(&row[0].as_str())).map(|row| row[2].clone());
        names.filter(|name| !chosen.contains(&name.as_str())).collect::<Vec<_>>()
    };
    assert_eq!(of_class("pages").len(), 1);
    for (files, left) in [
        (&[][..], all_but(&[], &["long"])),
        (&["docs/scenes.md"], all_but(&["site"], &["long", "code"])),
        (&["README.md", "docs/new.md"], all_but(&["site"], &["long", "code"])),
        (&["README.md", "crates/qp/src/cone.rs"], all_but(&["site"], &["long"])),
        (&["crates/qp/src/lib.rs"], all_but(&["documentation", "features"], &["long"])),
        (&["studies/new.rs"], all_but(&["studies"], &["long"])),
    ] {
        assert_eq!(left_out(files, history().path()), left, "{files:?}");
    }
    let lost = history();
    fs::write(lost.path().join("tests/full-pass.txt"), "0123456789012345678901234567890123456789").unwrap();
    assert_eq!(left_out(&["docs/scenes.md"], lost.path()), Vec::<String>::new());
}

#[test]
fn the_checks_of_a_change_allow_no_skipped_step() {
    let check = read(".ci/run");
    assert!(check.lines().last().unwrap().ends_with("SKIP=never exec ./test.sh"), "{check}");
}

#[test]
fn library_example_of_the_readme_is_the_doctest() {
    let (readme, page) = (read("README.md"), front_page());
    assert!(page.contains(block(&readme, "```rust\n")), "README's example differs from that in src/lib.rs");
}

#[test]
fn table_of_signs_is_the_same_in_library_readme_and_reference() {
    let page = front_page();
    let table: Vec<&str> =
        page.lines().skip_while(|line| !line.starts_with("| symbol")).take_while(|l| l.starts_with('|')).collect();
    assert_eq!(table.len(), 10);
    for file in ["README.md", "reference/README.md"] {
        let text = read(file);
        for line in &table {
            assert!(text.contains(line), "{file} does not contain {line:?}");
        }
    }
}

#[test]
fn the_readme_has_at_most_five_tables_and_names_its_limits_before_line_70() {
    let readme = read("README.md");
    let lines: Vec<&str> = readme.lines().collect();
    let tables = lines.iter().filter(|line| line.starts_with("|--") || line.starts_with("| --")).count();
    assert!((3..=5).contains(&tables), "{tables} tables");
    let limits = lines.iter().position(|line| line.starts_with("## Who it is for, and who should")).unwrap();
    let first_scene = lines.iter().position(|line| line.starts_with("## Your first scene")).unwrap();
    let symbols = lines.iter().position(|line| line.starts_with("| symbol")).unwrap();
    assert!(limits < first_scene && first_scene < 70 && first_scene < symbols, "{limits} {first_scene} {symbols}");
}

/// The documents for users.
fn documents() -> Vec<String> {
    let docs = fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs")).unwrap();
    let of_docs = docs.map(|entry| format!("docs/{}", entry.unwrap().file_name().to_str().unwrap()));
    ["README.md", "ARCHITECTURE.md", "CHANGELOG.md", "CONTRIBUTING.md", "reference/README.md"]
        .map(String::from)
        .into_iter()
        .chain(of_docs)
        .collect()
}

#[test]
fn all_rows_of_a_table_have_the_same_number_of_cells() {
    // In a table, a bar inside code, as in `|B_i|`, must be escaped.
    let cells = |line: &str| line.replace("\\|", "").trim().trim_matches('|').split('|').count();
    let mut tables = 0;
    for name in documents().into_iter().filter(|name| name.ends_with(".md")) {
        let text = read(&name);
        let lines: Vec<&str> = text.lines().collect();
        for pair in lines.windows(2).filter(|pair| pair[0].starts_with('|') && pair[1].starts_with('|')) {
            assert_eq!(cells(pair[0]), cells(pair[1]), "{name}: {}", pair[1]);
            tables += usize::from(pair[1].starts_with("|--") || pair[1].starts_with("| --"));
        }
    }
    assert!(tables > 10, "{tables} tables");
}

#[test]
fn every_link_to_a_file_leads_to_an_existing_file() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut links = 0;
    for name in documents().into_iter().filter(|name| name.ends_with(".md")) {
        let text = read(&name);
        let folder = root.join(&name).parent().unwrap().to_path_buf();
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            if !link.starts_with("http") && !link.starts_with('#') {
                assert!(folder.join(link.split('#').next().unwrap()).exists(), "{name} links to {link}");
                links += 1;
            }
        }
    }
    assert!(links > 10, "{links} links");
}

#[test]
fn the_commands_of_the_readme_are_those_of_the_program() {
    let readme = read("README.md");
    let program = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_signorini")).args(arguments).output().unwrap();
        (output.status.success(), String::from_utf8(output.stdout).unwrap())
    };
    let rows = readme.lines().filter(|line| line.starts_with("| `signorini "));
    let named = rows.flat_map(|row| row.split('|').nth(1).unwrap().split("`signorini ").skip(1));
    let mut named: Vec<&str> = named.map(|rest| rest.split([' ', '`']).next().unwrap()).collect();
    for name in &named {
        assert!(program(&[name, "--help"]).0, "signorini {name} --help");
    }
    let help = program(&["--help"]).1;
    let of_program = help.split("Commands:\n").nth(1).unwrap().split("\n\n").next().unwrap();
    let mut of_program: Vec<&str> = of_program.lines().filter_map(|line| line.split_whitespace().next()).collect();
    of_program.retain(|name| *name != "help");
    named.sort_unstable();
    of_program.sort_unstable();
    assert_eq!(named, of_program, "the commands of README.md differ from those of the program");
}

#[test]
fn three_methods_print_the_shown_comparison() {
    let page = read("docs/methods.md");
    let shown = block(&page, "`signorini compare examples/indentation.json` solves by three methods:\n\n```text\n");
    let output = Command::new(env!("CARGO_BIN_EXE_signorini"))
        .args(["compare", "examples/indentation.json"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(output.status.success());
    let printed = String::from_utf8(output.stdout).unwrap();
    // Method, iterations, contact nodes and force to nine digits; times and rounding differ from machine to machine.
    let facts = |text: &str| -> Vec<String> {
        let rows =
            text.lines().filter(|line| ["qp ", "active-set ", "penalty "].iter().any(|name| line.starts_with(name)));
        rows.take(3).map(|row| row.split_whitespace().take(4).collect::<Vec<_>>().join(" ")).collect()
    };
    assert_eq!(facts(shown), facts(&printed));
    assert_eq!(facts(shown).len(), 3);
}
