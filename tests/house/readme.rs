//! README says what the program does: its code is the doctest, its table of signs is the one of the library, its
//! commands exist.

use std::fs;
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
    let inside = text.split_once(start).unwrap_or_else(|| panic!("no block {start:?}")).1;
    inside.split_once("```").unwrap().0.trim()
}

#[test]
fn library_example_is_the_doctest() {
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
            assert!(text.contains(line), "{file} lacks {line:?}");
        }
    }
}

#[test]
fn every_command_of_the_readme_is_one_of_the_program() {
    let readme = read("README.md");
    let mut found = 0;
    for line in readme.lines().filter_map(|line| line.strip_prefix("| `signorini ")) {
        let name = line.split([' ', '`']).next().unwrap();
        let help = Command::new(env!("CARGO_BIN_EXE_signorini")).args([name, "--help"]).output().unwrap();
        assert!(help.status.success(), "signorini {name} --help");
        found += 1;
    }
    assert_eq!(found, 7);
}

#[test]
fn output_in_the_readme_is_what_the_command_prints() {
    let readme = read("README.md");
    let shown = block(&readme, "```text\n");
    let output = Command::new(env!("CARGO_BIN_EXE_signorini"))
        .args(["compare", "examples/indentation.json"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(output.status.success());
    let printed = String::from_utf8(output.stdout).unwrap();
    // Method, iterations, contact nodes and force to nine digits; times and roundings differ from machine to machine.
    let facts = |text: &str| -> Vec<String> {
        let rows =
            text.lines().filter(|line| ["qp ", "active-set ", "penalty "].iter().any(|name| line.starts_with(name)));
        rows.take(3).map(|row| row.split_whitespace().take(4).collect::<Vec<_>>().join(" ")).collect()
    };
    assert_eq!(facts(shown), facts(&printed));
    assert_eq!(facts(shown).len(), 3);
}
