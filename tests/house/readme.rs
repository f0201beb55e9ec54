//! The README agrees with the program: its code is the doctest, its table of signs is that of the library, and its
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
    let inside = text.split_once(start).unwrap_or_else(|| panic!("there is no block {start:?}")).1;
    inside.split_once("```").unwrap().0.trim()
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
fn the_command_in_the_readme_prints_the_shown_output() {
    let readme = read("README.md");
    let shown = block(&readme, "`signorini compare examples/indentation.json` solves by three methods:\n```text\n");
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
