//! The documents agree with the program: their commands run and print the shown output, every key of a scene has an
//! example that builds, the index names every page, links lead to headings, and the long documents stay within their
//! limits.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

use serde_json::{Map, Value};
use signorini::Scene;
use support::cases;
use tempfile::TempDir;

use crate::imports::rust_files;

/// Shown commands that are not run here: the beginning of their line, and the reason. `commands.rs` checks what they
/// name.
const NOT_RUN: [(&str, &str); 5] = [
    ("cargo ", "builds, or measures for minutes; `test.sh` runs the short forms"),
    ("pip ", "installs packages"),
    ("python", "needs packages that are no part of the tests; `test.sh` runs what the project needs"),
    ("./test.sh", "runs this test"),
    ("signorini tradeoff examples/indentation.json", "measures for a minute"),
];

/// Pages whose commands are left to others: those of the first, nearly all of them solves that other tests make too, to
/// the long form of this test; those of the second to another test.
const RUN_ELSEWHERE: [&str; 2] = ["docs/gallery.md", "docs/first-part.md"];

/// Smaller numbers are rounding, and differ from machine to machine.
const ROUNDING: f64 = 1e-9;

/// Folders whose files documents name.
pub const FOLDERS: [&str; 8] = ["crates", "src", "tests", "studies", "examples", "python", "reference", "distributed"];

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

pub fn read(name: &str) -> String {
    fs::read_to_string(root().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The pages of `docs/`.
fn pages() -> Vec<String> {
    let files = fs::read_dir(root().join("docs")).unwrap();
    let names = files.map(|entry| format!("docs/{}", entry.unwrap().file_name().to_str().unwrap()));
    let mut names: Vec<String> = names.filter(|name| name.ends_with(".md")).collect();
    names.sort();
    names
}

/// The pages of `docs/`, and the other documents.
pub fn documents() -> Vec<String> {
    let others = ["README.md", "ARCHITECTURE.md", "CHANGELOG.md", "CONTRIBUTING.md"];
    let of_folders = ["distributed/README.md", "python/README.md", "reference/README.md"];
    others.into_iter().chain(of_folders).map(String::from).chain(pages()).collect()
}

/// The parts of a document other than its running text.
pub enum Part {
    Heading,
    Block {
        kind: String,
        text: String,
        line: usize,
    },
    /// Code in running text: between backticks, or a line that is indented by four spaces.
    Code {
        text: String,
        line: usize,
    },
}

/// The code in a paragraph that ends before the line `end`.
fn code(paragraph: &str, end: usize) -> Vec<Part> {
    let mut line = end - paragraph.lines().count();
    let indented = paragraph.lines().enumerate().filter_map(|(at, text)| Some((at, text.strip_prefix("    ")?)));
    let mut found: Vec<Part> =
        indented.map(|(at, text)| Part::Code { text: text.trim().to_string(), line: line + at }).collect();
    for (at, text) in paragraph.split('`').enumerate() {
        if at % 2 == 1 {
            found.push(Part::Code { text: text.split_whitespace().collect::<Vec<_>>().join(" "), line });
        }
        line += text.matches('\n').count();
    }
    found
}

pub fn parts(document: &str) -> Vec<Part> {
    let mut parts = Vec::new();
    let mut open: Option<(String, String, usize)> = None;
    let mut paragraph = String::new();
    // An empty line ends the last paragraph.
    for (number, line) in document.lines().chain([""]).enumerate() {
        let is_text = open.is_none() && !line.is_empty() && !line.starts_with("```") && !line.starts_with('#');
        match is_text {
            true => paragraph += &format!("{line}\n"),
            false => parts.extend(code(&std::mem::take(&mut paragraph), number + 1)),
        }
        match (line.strip_prefix("```"), &mut open) {
            (Some(_), Some(_)) => {
                let (kind, text, line) = open.take().unwrap();
                parts.push(Part::Block { kind, text, line });
            }
            (Some(kind), None) => open = Some((kind.into(), String::new(), number + 1)),
            (None, Some((_, text, _))) => *text += &format!("{line}\n"),
            (None, None) if line.starts_with('#') => parts.push(Part::Heading),
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "a block has no end");
    parts
}

/// A folder with the scenes of this repository, in which the commands of a page run.
fn desk() -> TempDir {
    let desk = tempfile::tempdir().unwrap();
    for folder in ["examples", "studies"] {
        std::os::unix::fs::symlink(root().join(folder), desk.path().join(folder)).unwrap();
    }
    desk
}

/// The output of a block of commands on standard output and error. Returns `None` if no line is run, and an error if a
/// command fails.
fn printed(desk: &Path, commands: &str) -> Option<Result<String, String>> {
    let is_run = |line: &&str| !NOT_RUN.iter().any(|(start, _)| line.starts_with(start));
    // The program is built already.
    let commands = commands.replace("cargo run --release -- ", "signorini ");
    let script: Vec<&str> = commands.lines().filter(is_run).collect();
    if script.iter().all(|line| line.trim().is_empty()) {
        return None;
    }
    let program = Path::new(env!("CARGO_BIN_EXE_signorini")).parent().unwrap();
    let paths = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    let shell = ["-e", "-c", &script.join("\n")];
    let output = Command::new("sh").args(shell).current_dir(desk).env("PATH", paths).output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    Some(if output.status.success() { Ok(out + &err) } else { Err(format!("{}\n{out}{err}", output.status)) })
}

/// The words of a text, separated by single spaces; a number that is only rounding becomes `~`.
fn words(text: &str) -> String {
    let word = |word: &str| match word.parse::<f64>() {
        Ok(number) if number != 0.0 && number.abs() < ROUNDING => "~".to_string(),
        _ => word.to_string(),
    };
    text.split_whitespace().map(word).collect::<Vec<_>>().join(" ")
}

/// Returns `true` for a command of the program in running text that can run as it stands: an input follows its name, no
/// word is a name in capitals but that of a folder to be written, and its files are on the desk.
fn is_complete(desk: &Path, command: &str) -> bool {
    let words: Vec<&str> = command.split(' ').collect();
    let ["signorini", _, input, ..] = words[..] else { return false };
    let is_there = |word: &str| {
        let is_file = [".json", ".msh", ".inp", ".mtx"].iter().any(|ending| word.ends_with(ending));
        !word.contains(|letter: char| letter.is_uppercase()) && (!is_file || desk.join(word).exists())
    };
    !input.starts_with('-') && words.windows(2).all(|pair| pair[0] == "--out" || is_there(pair[1]))
}

/// Result of running the commands of a document.
#[derive(Default)]
struct Followed {
    /// Number of blocks, and of commands in running text, that ran.
    ran: usize,
    /// Number of lines of output that were compared.
    compared: usize,
    /// Failed commands, and lines that a command did not print.
    wrong: Vec<String>,
}

fn follow(name: &str) -> Followed {
    let (desk, text) = (desk(), read(name));
    let (mut shown, mut found) = (None, Followed::default());
    for part in parts(&text) {
        let (kind, text, line) = match part {
            Part::Block { kind, text, line } => (kind, text, line),
            Part::Heading => {
                shown = None;
                continue;
            }
            Part::Code { text, line } => {
                if is_complete(desk.path(), &text) {
                    let run = printed(desk.path(), &text);
                    found.ran += usize::from(run.is_some());
                    found
                        .wrong
                        .extend(run.and_then(Result::err).map(|error| format!("{name}:{line}: {text}: {error}")));
                }
                continue;
            }
        };
        let place = format!("{name}:{line}");
        match kind.as_str() {
            "json" => {
                let file =
                    text.lines().next().and_then(|line| line.strip_prefix("// ")).filter(|f| f.ends_with(".json"));
                file.into_iter().for_each(|file| fs::write(desk.path().join(file), &text).unwrap());
            }
            "sh" => {
                let run = printed(desk.path(), &text);
                found.ran += usize::from(run.is_some());
                shown = run.and_then(|run| run.map_err(|error| found.wrong.push(format!("{place}: {error}"))).ok());
                shown = shown.map(|text| words(&text));
            }
            "text" => {
                for line in text.lines().filter(|line| line.trim() != "...") {
                    let Some(shown) = &shown else { break };
                    if !shown.contains(&words(line)) {
                        found.wrong.push(format!("{place}: {line:?} is not printed:\n{shown}"));
                    }
                    found.compared += 1;
                }
            }
            _ => {}
        }
    }
    found
}

#[test]
fn commands_of_the_documents_run_and_print_what_is_shown() {
    let mut names = pages();
    let left_out = cases(&RUN_ELSEWHERE[..], &RUN_ELSEWHERE[1..]);
    names.retain(|name| !left_out.contains(&name.as_str()));
    names.extend(["README.md", "CONTRIBUTING.md"].map(String::from));
    let queue = Mutex::new(names.iter());
    let follow_some = || -> Vec<Followed> {
        let next = || queue.lock().unwrap().next();
        std::iter::from_fn(next).map(|name| follow(name)).collect()
    };
    // A test machine has at least two cores.
    let halves =
        std::thread::scope(|scope| [(); 2].map(|()| scope.spawn(follow_some)).map(|half| half.join().unwrap()));
    let followed: Vec<Followed> = halves.into_iter().flatten().collect();
    let wrong: Vec<&str> = followed.iter().flat_map(|page| &page.wrong).map(String::as_str).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let ran: usize = followed.iter().map(|page| page.ran).sum();
    let compared: usize = followed.iter().map(|page| page.compared).sum();
    assert!(ran > 50 && compared > 40, "{ran} blocks and commands ran, {compared} lines were compared");
}

/// The names in a schema: the keys of its objects, and the choices among words.
#[derive(Default)]
struct Names {
    keys: BTreeSet<String>,
    choices: BTreeSet<String>,
}

impl Names {
    fn read(&mut self, schema: &Value) {
        match schema {
            Value::Object(fields) => {
                if let Some(Value::Object(properties)) = fields.get("properties") {
                    self.keys.extend(properties.keys().cloned());
                }
                let choices = fields.get("enum").and_then(Value::as_array).into_iter().flatten();
                self.choices.extend(choices.chain(fields.get("const")).filter_map(Value::as_str).map(String::from));
                fields.values().for_each(|value| self.read(value));
            }
            Value::Array(values) => values.iter().for_each(|value| self.read(value)),
            _ => {}
        }
    }
}

/// The keys of an example, and its values that are words.
fn words_of(example: &Value, found: &mut BTreeSet<String>) {
    match example {
        Value::Object(fields) => {
            found.extend(fields.keys().cloned());
            fields.values().for_each(|value| words_of(value, found));
        }
        Value::Array(values) => values.iter().for_each(|value| words_of(value, found)),
        Value::String(word) => drop(found.insert(word.clone())),
        _ => {}
    }
}

/// A small scene; an example of `docs/scenes.md` replaces some of its fields.
fn small_scene() -> Map<String, Value> {
    let scene = serde_json::json!({
        "title": "A small block",
        "body": {"rectangle": {
            "x": {"points": [0, 1], "divisions": [4]}, "y": {"points": [0, 0.5], "divisions": [2]}
        }},
        "material": {"young": 1e7, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "obstacles": [{
            "boundary": "top", "approach": "+y", "shape": {"parabola": {"apex": [0.5, 0.5], "radius": 1}}
        }],
        "gap": -0.01
    });
    scene.as_object().unwrap().clone()
}

/// No test runs Gmsh: the script has made the meshes beside it, and the page shows its lines.
#[test]
fn the_page_on_assemblies_shows_lines_of_its_script_and_keys_of_its_scenes() {
    let (page, script) = (read("docs/assemblies.md"), read("examples/assembly/assembly.py"));
    let code: Vec<&str> = page.lines().filter_map(|line| line.strip_prefix("    ")).collect();
    assert!(code.len() > 5, "{code:?}");
    code.iter().for_each(|line| assert!(script.contains(line), "{line:?} is no line of the script"));
    let scenes = ["bush", "pads"]
        .map(|name| -> Value { serde_json::from_str(&read(&format!("examples/assembly/{name}.json"))).unwrap() });
    let blocks = parts(&page).into_iter().filter_map(|part| match part {
        Part::Block { kind, text, .. } if kind == "json" => Some(text),
        _ => None,
    });
    let blocks: Vec<Value> = blocks.map(|text| serde_json::from_str(&text).unwrap()).collect();
    assert_eq!(blocks.len(), scenes.len());
    for (block, scene) in blocks.iter().zip(&scenes) {
        block.as_object().unwrap().iter().for_each(|(key, value)| assert_eq!(&scene[key], value, "{key}"));
    }
}

/// The script has made the meshes beside it here too.
#[test]
fn the_page_on_two_parts_shows_lines_of_its_script_and_its_scene() {
    let (page, script) = (read("docs/two-parts.md"), read("examples/two-parts/parts.py"));
    let code: Vec<&str> = page.lines().filter_map(|line| line.strip_prefix("    ")).collect();
    let meshes: Vec<&&str> = code.iter().filter(|line| line.starts_with("mesh(")).collect();
    assert_eq!(meshes.len(), 2, "{code:?}");
    meshes.iter().for_each(|line| assert!(script.contains(**line), "{line:?} is no line of the script"));
    assert!(page.contains(&format!("```json\n{}```", read("examples/two-parts/press.json"))), "the scene differs");
}

#[test]
fn every_key_of_a_scene_has_an_example_that_builds() {
    let page = read("docs/scenes.md");
    let desk = desk();
    fs::copy(root().join("examples/first-part/foot.msh"), desk.path().join("foot.msh")).unwrap();
    fs::copy(root().join("tests/faults/stack.inp"), desk.path().join("stack.inp")).unwrap();
    let mut found = BTreeSet::new();
    let mut built = 0;
    for part in parts(&page) {
        let Part::Block { kind, text, line } = part else { continue };
        if kind != "json" {
            continue;
        }
        let example: Value =
            serde_json::from_str(&text).unwrap_or_else(|error| panic!("docs/scenes.md:{line}: {error}"));
        words_of(&example, &mut found);
        let mut scene = small_scene();
        scene.extend(example.as_object().unwrap().clone());
        scene.retain(|_, value| !value.is_null());
        let (file, scene) = (desk.path().join("scene.json"), Value::Object(scene).to_string());
        fs::write(&file, &scene).unwrap();
        let scene = Scene::read(&file).unwrap_or_else(|error| panic!("docs/scenes.md:{line}: {error}"));
        if !text.contains("die.stl") {
            let model = scene.build().unwrap_or_else(|error| panic!("docs/scenes.md:{line}: {error}"));
            assert!(!model.rows().is_empty(), "docs/scenes.md:{line} has no contact row");
            built += 1;
        }
    }
    assert!(built > 20, "{built} examples were built");
    let schema = Command::new(env!("CARGO_BIN_EXE_signorini")).arg("schema").output().unwrap();
    let mut names = Names::default();
    names.read(&serde_json::from_slice(&schema.stdout).unwrap());
    assert!(names.keys.len() > 100 && names.choices.len() > 30, "{} and {}", names.keys.len(), names.choices.len());
    // `$schema` is for editors. A choice may occur only in the text.
    let in_text = |choice: &String| page.contains(&format!("`{choice}`"));
    let keys = names.keys.iter().filter(|key| !found.contains(*key) && *key != "$schema");
    let choices = names.choices.iter().filter(|choice| !found.contains(*choice) && !in_text(choice));
    let missing: Vec<&String> = keys.chain(choices).collect();
    assert!(missing.is_empty(), "docs/scenes.md has no example of {missing:?}");
}

#[test]
fn the_index_names_every_page() {
    let index = read("docs/README.md");
    for page in pages().iter().filter(|page| *page != "docs/README.md") {
        let name = page.strip_prefix("docs/").unwrap();
        assert!(index.contains(&format!("]({name})")), "docs/README.md does not name {name}");
    }
    assert!(pages().len() > 14);
}

#[test]
fn every_page_opens_with_a_title_and_prose() {
    for page in pages() {
        let text = read(&page);
        let mut lines = text.lines();
        let title = lines.next().unwrap();
        let first = lines.find(|line| !line.is_empty()).unwrap();
        let is_prose = first.chars().next().is_some_and(char::is_alphanumeric) && first.len() > 30;
        assert!(title.starts_with("# ") && is_prose, "{page} opens with {first:?}");
    }
}

/// The name by which a page can link to a heading, as GitHub makes it.
fn anchor(heading: &str) -> String {
    let kept = heading.trim_start_matches('#').trim().to_lowercase();
    kept.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c)).collect::<String>().replace(' ', "-")
}

#[test]
fn every_link_to_a_heading_leads_to_an_existing_heading() {
    let mut links = 0;
    for name in pages().into_iter().chain(["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].map(String::from)) {
        let text = read(&name);
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let Some((file, heading)) = link.split_once('#').filter(|_| !link.starts_with("http")) else { continue };
            let own = root().join(&name);
            let file: PathBuf = if file.is_empty() { own } else { own.parent().unwrap().join(file) };
            let target = fs::read_to_string(&file).unwrap_or_else(|error| panic!("{name} links to {link}: {error}"));
            let has = target.lines().any(|line| line.starts_with('#') && anchor(line) == heading);
            assert!(has, "{name} links to {link}, but there is no such heading");
            links += 1;
        }
    }
    assert!(links > 3, "only {links} links to headings");
}

#[test]
fn long_documents_stay_within_their_limits() {
    for (name, most_lines, most_letters) in
        [("README.md", 140, 120), ("ARCHITECTURE.md", 120, 140), ("CHANGELOG.md", 200, 140)]
    {
        let text = read(name);
        let lines = text.lines().count();
        assert!(lines <= most_lines, "{name} has {lines} lines; {most_lines} are allowed");
        let long = text.lines().find(|line| !line.starts_with('|') && line.chars().count() > most_letters);
        assert!(long.is_none(), "{name} has a line of more than {most_letters} letters: {long:?}");
    }
}

/// The files in these folders.
pub fn files() -> Vec<PathBuf> {
    let mut left: Vec<PathBuf> = FOLDERS.iter().map(|folder| root().join(folder)).collect();
    let mut files = Vec::new();
    while let Some(path) = left.pop() {
        match path.is_dir() {
            true => left.extend(fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path())),
            false => files.push(path),
        }
    }
    files
}

/// Files of other projects that a document names.
const FOREIGN: [&str; 2] = ["qpsolvers/", "qpbenchmark/"];

/// A document may leave out `crates/` and `src/`, which every path has, and the crate.
#[test]
fn every_source_file_that_a_document_names_exists() {
    let short = |path: &str| path.replace("crates/", "").replace("src/", "");
    let name = |file: &PathBuf| format!("/{}", short(file.strip_prefix(root()).unwrap().to_str().unwrap()));
    let files: Vec<String> = files().iter().map(name).collect();
    let mut named = 0;
    for page in pages().into_iter().chain(["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].map(String::from)) {
        let text = read(&page);
        let words = text.split('`').flat_map(str::split_whitespace);
        let is_source = |word: &&str| [".rs", ".py", ".sh"].iter().any(|end| word.ends_with(end)) && word.contains('/');
        let is_own = |word: &&str| {
            !word.contains("NAME") && !word.contains("://") && !FOREIGN.iter().any(|start| word.starts_with(start))
        };
        for word in words.filter(is_source).filter(is_own) {
            let end = format!("/{}", short(word.trim_start_matches("./")));
            assert!(files.iter().any(|file| file.ends_with(&end)), "{page} names {word}, which does not exist");
            named += 1;
        }
    }
    assert!(named > 60, "{named} files");
}

/// The text of all tests.
fn tests() -> String {
    rust_files(&root().join("tests")).iter().map(|file| fs::read_to_string(file).unwrap()).collect()
}

#[test]
fn every_invariant_of_the_architecture_names_a_test_that_exists() {
    let text = read("ARCHITECTURE.md");
    let section = text.split("## Invariants\n").nth(1).unwrap().split("\n## ").next().unwrap();
    let mut invariants: Vec<String> = Vec::new();
    for line in section.lines().filter(|line| !line.is_empty()) {
        if line.starts_with(|first: char| first.is_ascii_digit()) {
            invariants.push(String::new());
        }
        *invariants.last_mut().unwrap() += line;
    }
    assert!((4..=8).contains(&invariants.len()), "{} invariants", invariants.len());
    let tests = tests();
    for invariant in invariants {
        // The names of tests are sentences, with at least a few words; names of files and items are shorter.
        let names = invariant.split('`').skip(1).step_by(2).filter(|name| name.matches('_').count() > 3);
        let names: Vec<&str> = names.collect();
        assert!(!names.is_empty(), "this invariant names no test: {invariant}");
        for name in names {
            assert!(tests.contains(&format!("fn {name}()")), "there is no test {name}");
        }
    }
}
