//! The README and the program agree: the first command, the library's example and table of signs, the commands. And
//! `test.sh` runs the steps that a change may break.

use std::fs;
use std::process::Command;

use crate::documents::read;
use crate::sources::root;

/// The front page of the library without the comment marks and without hidden lines.
fn front_page() -> String {
    let lines = read("src/lib.rs");
    let page = lines.lines().filter_map(|line| line.strip_prefix("//!"));
    let page = page.map(|line| line.strip_prefix(' ').unwrap_or(line)).filter(|line| !line.starts_with("# Ok"));
    page.map(|line| format!("{line}\n")).collect()
}

fn block<'a>(text: &'a str, start: &str) -> &'a str {
    let inside = text.split_once(start).unwrap_or_else(|| panic!("there is no block {start:?}")).1;
    inside.split_once("```").unwrap().0.trim()
}

/// Runs the program in the folder of the workspace.
fn printed(arguments: &[&str]) -> String {
    let mut program = Command::new(env!("CARGO_BIN_EXE_signorini"));
    let output = program.args(arguments).current_dir(root()).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {output:?}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn the_first_command_leaves_the_files_that_the_readme_names() {
    let readme = read("README.md");
    let (solves, tests) = block(&readme, "```sh\n").split_once('\n').unwrap();
    assert_eq!(tests, "./test.sh");
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("answer");
    let arguments = solves.strip_prefix("cargo run --release -- ").unwrap().strip_suffix(" answer").unwrap();
    printed(&[arguments.split(' ').collect(), vec![out.to_str().unwrap()]].concat());
    assert!(read(".gitignore").lines().any(|line| line == "/answer"), "git sees what the first command leaves");
    let sentence = readme.split("it leaves ").nth(1).unwrap().split(". ").next().unwrap();
    let names: Vec<&str> = sentence.split('`').skip(1).step_by(2).collect();
    assert_eq!(names.len(), 3, "{sentence}");
    names.iter().for_each(|name| assert!(out.join(name).is_file(), "there is no {name}"));
}

#[test]
fn library_example_of_the_readme_is_the_doctest() {
    let (readme, page) = (read("README.md"), front_page());
    assert!(page.contains(block(&readme, "```rust\n")), "README's example differs from that in src/lib.rs");
}

#[test]
fn table_of_signs_is_the_same_in_library_readme_and_reference() {
    let page = front_page();
    let table = page.lines().skip_while(|line| !line.starts_with("| symbol"));
    let table: Vec<&str> = table.take_while(|line| line.starts_with('|')).collect();
    assert_eq!(table.len(), 10);
    for file in ["README.md", "reference/README.md"] {
        let text = read(file);
        table.iter().for_each(|line| assert!(text.contains(line), "{file} does not contain {line:?}"));
    }
}

#[test]
fn the_commands_of_the_readme_are_those_of_the_program() {
    let readme = read("README.md");
    let rows = readme.lines().filter(|line| line.starts_with("| `signorini "));
    let named = rows.flat_map(|row| row.split('|').nth(1).unwrap().split("`signorini ").skip(1));
    let mut named: Vec<&str> = named.map(|rest| rest.split([' ', '`']).next().unwrap()).chain(["help"]).collect();
    let help = printed(&["--help"]);
    let of_program = help.split("Commands:\n").nth(1).unwrap().split("\n\n").next().unwrap();
    let mut of_program: Vec<&str> = of_program.lines().filter_map(|line| line.split_whitespace().next()).collect();
    named.sort_unstable();
    of_program.sort_unstable();
    assert_eq!(named, of_program, "the commands of README.md differ from those of the program");
}

#[test]
fn three_methods_print_the_shown_comparison() {
    let page = read("docs/methods.md");
    let shown = block(&page, "`signorini compare examples/indentation.json` solves by three methods:\n\n```text\n");
    // Method, iterations, contact nodes and force to nine digits; times and rounding differ from machine to machine.
    let facts = |text: &str| -> Vec<Vec<String>> {
        let is_method = |line: &&str| ["qp ", "active-set ", "penalty "].iter().any(|name| line.starts_with(name));
        let rows = text.lines().filter(is_method).take(3);
        rows.map(|row| row.split_whitespace().take(4).map(str::to_string).collect()).collect()
    };
    assert_eq!(facts(shown), facts(&printed(&["compare", "examples/indentation.json"])));
    assert_eq!(facts(shown).len(), 3);
}

/// The rows of the table of steps: class, lane, name, command, files.
fn rows() -> Vec<Vec<String>> {
    let script = read("test.sh");
    let table = script.split("\ntable=\"\n").nth(1).unwrap().split("\n\"\n").next().unwrap();
    table.lines().map(|row| row.split('|').map(|cell| cell.trim().to_string()).collect()).collect()
}

#[test]
fn every_long_step_names_files_that_exist() {
    for row in rows().iter().filter(|row| row[0] == "long") {
        assert!(!row[4].is_empty(), "{row:?}");
        let list = ["-c", &format!("ls -d {}", row[4])];
        let listed = Command::new("sh").args(list).current_dir(root()).output().unwrap();
        assert!(listed.status.success(), "{row:?}: {}", String::from_utf8_lossy(&listed.stderr));
    }
}

/// The steps that `./test.sh needs` leaves out in a history whose last full pass is its first commit, or is unknown, if
/// these files change after it.
fn left_out(files: &[&str], is_known: bool) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let sh = |script: &str| {
        let target = folder.path().join(".git/target");
        let mut sh = Command::new("sh");
        let output =
            sh.args(["-e", "-c", script]).current_dir(&folder).env("CARGO_TARGET_DIR", target).output().unwrap();
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    fs::copy(root().join("test.sh"), folder.path().join("test.sh")).unwrap();
    sh("mkdir -p docs crates/qp/src studies tests && git init -q
        touch README.md docs/scenes.md crates/qp/src/lib.rs crates/qp/src/cone.rs studies/main.rs tests/full-pass.txt
        git add . && git -c user.name=a -c user.email=a@b commit -qm a && git rev-parse HEAD >tests/full-pass.txt");
    if !is_known {
        sh("printf 0123456789012345678901234567890123456789 >tests/full-pass.txt");
    }
    files.iter().for_each(|file| fs::write(folder.path().join(file), "changed").unwrap());
    let said = sh("./test.sh needs");
    let names =
        said.lines().find(|line| line.starts_with("== left out, ")).map(|line| line.split_once(": ").unwrap().1);
    names.into_iter().flat_map(|names| names.split(", ")).map(str::to_string).collect()
}

#[test]
fn a_change_chooses_the_steps_that_it_may_break() {
    let rows = rows();
    for (files, classes, chosen) in [
        (&[][..], &["long"][..], &[][..]),
        (&["README.md", "docs/new.md"], &["long", "code"], &["site"]),
        (&["README.md", "crates/qp/src/cone.rs"], &["long"], &["site"]),
        (&["crates/qp/src/lib.rs"], &["long"], &["documentation", "features"]),
        (&["studies/new.rs"], &["long"], &["studies"]),
    ] {
        let left = rows.iter().filter(|row| classes.contains(&&*row[0]) && !chosen.contains(&&*row[2]));
        assert_eq!(left_out(files, true), left.map(|row| &*row[2]).collect::<Vec<_>>(), "{files:?}");
    }
    assert!(left_out(&["docs/scenes.md"], false).is_empty());
}

#[test]
fn the_checks_of_a_change_allow_no_skipped_step() {
    assert!(read(".ci/run").trim_end().ends_with("SKIP=never exec ./test.sh"));
}
