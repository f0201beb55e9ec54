//! The documents agree with the program: their commands run and print the shown output, every key of a scene has an
//! example that builds, the index names every page, and links lead to what exists.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::Mutex;

use serde_json::{Map, Value};
use signorini::Scene;
use support::cases;
use tempfile::TempDir;

use crate::sources::{files_below, root};

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

/// The parts of a document other than its running text. Code in running text stands between backticks, or in a line
/// that is indented by four spaces.
#[rustfmt::skip]
pub enum Part {
    Heading,
    Block { kind: String, text: String, line: usize },
    Code { text: String, line: usize },
}

/// The code in a paragraph that begins at `line`.
fn code(paragraph: &str, line: usize) -> Vec<Part> {
    let joined = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let indented = paragraph.lines().filter_map(|text| text.strip_prefix("    "));
    let all = indented.chain(paragraph.split('`').skip(1).step_by(2));
    all.map(|text| Part::Code { text: joined(text), line }).collect()
}

pub fn parts(document: &str) -> Vec<Part> {
    let (mut parts, mut paragraph, mut open) = (Vec::new(), (0, String::new()), None::<(String, String, usize)>);
    // An empty line ends the last paragraph.
    for (line, text) in document.lines().chain([""]).enumerate() {
        let is_text = open.is_none() && !text.is_empty() && !text.starts_with("```") && !text.starts_with('#');
        if !is_text {
            let (first, text) = std::mem::take(&mut paragraph);
            parts.extend(code(&text, first));
        } else {
            paragraph.0 = if paragraph.1.is_empty() { line + 1 } else { paragraph.0 };
            paragraph.1 += &format!("{text}\n");
        }
        match (text.strip_prefix("```"), open.take()) {
            (Some(_), Some((kind, text, line))) => parts.push(Part::Block { kind, text, line }),
            (Some(kind), None) => open = Some((kind.into(), String::new(), line + 1)),
            (None, Some((kind, before, line))) => open = Some((kind, format!("{before}{text}\n"), line)),
            (None, None) if text.starts_with('#') => parts.push(Part::Heading),
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

/// What the commands of some documents did.
#[derive(Default)]
struct Followed {
    /// Blocks, and commands in running text, that ran.
    ran: usize,
    /// Lines of output that were compared.
    compared: usize,
    /// Failed commands, and lines that a command did not print.
    wrong: Vec<String>,
}

impl Followed {
    fn run(&mut self, desk: &Path, place: &str, commands: &str) -> Option<String> {
        let run = printed(desk, commands)?;
        self.ran += 1;
        run.map_err(|error| self.wrong.push(format!("{place}: {commands}: {error}"))).ok().map(|text| words(&text))
    }

    fn follow(&mut self, name: &str) {
        let (desk, mut shown) = (desk(), None);
        for part in parts(&read(name)) {
            match part {
                Part::Heading => shown = None,
                Part::Code { text, line } if is_complete(desk.path(), &text) => {
                    self.run(desk.path(), &format!("{name}:{line}"), &text);
                }
                Part::Block { kind, text, .. } if kind == "json" => {
                    let file = text.lines().next().and_then(|line| line.strip_prefix("// "));
                    if let Some(file) = file.filter(|file| file.ends_with(".json")) {
                        fs::write(desk.path().join(file), &text).unwrap();
                    }
                }
                Part::Block { kind, text, line } if kind == "sh" => {
                    shown = self.run(desk.path(), &format!("{name}:{line}"), &text);
                }
                Part::Block { kind, text, line } if kind == "text" => {
                    let Some(shown) = &shown else { continue };
                    let lines: Vec<&str> = text.lines().filter(|line| line.trim() != "...").collect();
                    let missing = lines.iter().filter(|line| !shown.contains(&words(line)));
                    self.wrong.extend(missing.map(|text| format!("{name}:{line}: {text:?} is not printed:\n{shown}")));
                    self.compared += lines.len();
                }
                _ => {}
            }
        }
    }
}

#[test]
fn commands_of_the_documents_run_and_print_what_is_shown() {
    let left_out = cases(&RUN_ELSEWHERE[..], &RUN_ELSEWHERE[1..]);
    let names = pages().into_iter().chain(["README.md", "CONTRIBUTING.md"].map(String::from));
    let queue = Mutex::new(names.filter(|name| !left_out.contains(&name.as_str())));
    let follow_some = || {
        let next = || queue.lock().unwrap().next();
        let mut followed = Followed::default();
        std::iter::from_fn(next).for_each(|name| followed.follow(&name));
        followed
    };
    // A test machine has at least two cores.
    let [one, other] =
        std::thread::scope(|scope| [(); 2].map(|()| scope.spawn(follow_some)).map(|half| half.join().unwrap()));
    let wrong = [one.wrong, other.wrong].concat();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let (ran, compared) = (one.ran + other.ran, one.compared + other.compared);
    assert!(ran > 50 && compared > 40, "{ran} blocks and commands ran, {compared} lines were compared");
}

/// Visits a value and all that is in it.
fn each(value: &Value, visit: &mut dyn FnMut(&Value)) {
    visit(value);
    match value {
        Value::Object(fields) => fields.values().for_each(|value| each(value, visit)),
        Value::Array(values) => values.iter().for_each(|value| each(value, visit)),
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

/// No test runs Gmsh: the scripts have made the meshes beside them, and the pages show their lines and scenes.
#[test]
fn pages_on_scripts_show_their_lines_and_scenes() {
    for (page, folder, script, start, scenes) in [
        ("docs/assemblies.md", "examples/assembly", "assembly.py", "", &["bush.json", "pads.json"][..]),
        ("docs/two-parts.md", "examples/two-parts", "parts.py", "mesh(", &["press.json"]),
    ] {
        let (text, script) = (read(page), read(&format!("{folder}/{script}")));
        let code = text.lines().filter_map(|line| line.strip_prefix("    ")).filter(|line| line.starts_with(start));
        let code: Vec<&str> = code.collect();
        assert!(code.len() > 1 && code.iter().all(|line| script.contains(line)), "{page}: {code:?}");
        let blocks = parts(&text).into_iter().filter_map(|part| match part {
            Part::Block { kind, text, .. } if kind == "json" => Some(text),
            _ => None,
        });
        let blocks: Vec<String> = blocks.collect();
        assert_eq!(blocks.len(), scenes.len(), "{page}");
        for (block, scene) in blocks.iter().zip(scenes) {
            let scene = read(&format!("{folder}/{scene}"));
            // A page may show some keys only.
            if *block != scene {
                let [block, scene] = [block, &scene].map(|text| serde_json::from_str::<Value>(text).unwrap());
                block.as_object().unwrap().iter().for_each(|(key, value)| assert_eq!(&scene[key], value, "{key}"));
            }
        }
    }
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
        each(&example, &mut |value| match value {
            Value::Object(fields) => found.extend(fields.keys().cloned()),
            Value::String(word) => found.extend([word.clone()]),
            _ => {}
        });
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
    let (mut keys, mut choices) = (BTreeSet::new(), BTreeSet::new());
    each(&serde_json::from_slice(&schema.stdout).unwrap(), &mut |value| {
        keys.extend(
            value.get("properties").and_then(Value::as_object).into_iter().flat_map(|fields| fields.keys().cloned()),
        );
        let listed = value.get("enum").and_then(Value::as_array).into_iter().flatten();
        choices.extend(listed.chain(value.get("const")).filter_map(Value::as_str).map(String::from));
    });
    assert!(keys.len() > 100 && choices.len() > 30, "{} and {}", keys.len(), choices.len());
    // `$schema` is for editors. A choice may occur only in the text.
    keys.remove("$schema");
    choices.retain(|choice| !page.contains(&format!("`{choice}`")));
    let missing: Vec<&String> = keys.iter().chain(&choices).filter(|name| !found.contains(*name)).collect();
    assert!(missing.is_empty(), "docs/scenes.md has no example of {missing:?}");
}

#[test]
fn the_index_names_every_page_and_the_readme_has_at_most_140_lines() {
    let index = read("docs/README.md");
    for page in pages().iter().filter(|page| *page != "docs/README.md") {
        let name = page.strip_prefix("docs/").unwrap();
        assert!(index.contains(&format!("]({name})")), "docs/README.md does not name {name}");
    }
    assert!(read("README.md").lines().count() <= 140);
}

/// The name by which a page can link to a heading, as GitHub makes it.
fn anchor(heading: &str) -> String {
    let kept = heading.trim_start_matches('#').trim().to_lowercase();
    kept.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c)).collect::<String>().replace(' ', "-")
}

#[test]
fn every_link_and_every_named_source_file_exists() {
    // A document may leave out `crates/` and `src/`, which every path has, and the crate.
    let short = |path: &str| path.replace("crates/", "").replace("src/", "");
    let files = FOLDERS.iter().flat_map(|folder| files_below(folder, ""));
    let files: Vec<String> = files.map(|file| short(file.to_str().unwrap())).collect();
    let (mut links, mut named) = (0, 0);
    for page in documents() {
        let text = read(&page);
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            if file.starts_with("http") {
                continue;
            }
            let own = root().join(&page);
            let file = if file.is_empty() { own } else { own.parent().unwrap().join(file) };
            assert!(file.exists(), "{page} links to {link}");
            let is_it = |line: &str| line.starts_with('#') && anchor(line) == heading;
            let has = heading.is_empty() || fs::read_to_string(file).unwrap().lines().any(is_it);
            assert!(has, "{page} links to {link}, but there is no such heading");
            links += 1;
        }
        let words = text.split('`').flat_map(str::split_whitespace).filter(|word| word.contains('/'));
        let is_source = |word: &&str| [".rs", ".py", ".sh"].iter().any(|end| word.ends_with(end));
        let is_other =
            |word: &str| ["NAME", "://", "qpsolvers/", "qpbenchmark/"].iter().any(|part| word.contains(part));
        for word in words.filter(is_source).filter(|word| !is_other(word) && page != "CHANGELOG.md") {
            let end = format!("/{}", short(word.trim_start_matches("./")));
            assert!(files.iter().any(|file| file.ends_with(&end)), "{page} names {word}, which does not exist");
            named += 1;
        }
    }
    assert!(links > 100 && named > 60, "{links} links, {named} files");
}

#[test]
fn the_flows_to_a_model_and_of_a_solve_are_the_functions_that_the_architecture_prints() {
    let page = read("ARCHITECTURE.md");
    let printed = page.split("```rust\n").skip(1).map(|rest| rest.split_once("```").unwrap().0);
    let files = ["crates/mechanics/src/scene/models/build.rs", "crates/qp/src/run/mod.rs"].map(read);
    assert!(printed.clone().count() == files.len());
    for (printed, file) in printed.zip(files) {
        assert!(file.contains(printed) && printed.lines().count() <= 20, "{printed}");
    }
}

#[test]
fn every_invariant_of_the_architecture_names_a_test_that_exists() {
    let tests: String = files_below("tests", ".rs").iter().map(|file| fs::read_to_string(file).unwrap()).collect();
    let text = read("ARCHITECTURE.md");
    let section = text.split("## Invariants\n").nth(1).unwrap().split("\n## ").next().unwrap();
    // The names of tests are sentences, with at least a few words; names of files and items are shorter.
    let names = |part: &str| -> Vec<String> {
        let names = part.split('`').skip(1).step_by(2).filter(|name| name.matches('_').count() > 3);
        names.map(str::to_string).collect()
    };
    for number in 1.. {
        let Some((_, invariant)) = section.split_once(&format!("{number}. **")) else {
            assert!(number > 4, "{number} invariants");
            break;
        };
        let names = names(invariant.split(&format!("\n{}. **", number + 1)).next().unwrap());
        assert!(!names.is_empty(), "invariant {number} names no test");
        names.iter().for_each(|name| assert!(tests.contains(&format!("fn {name}()")), "there is no test {name}"));
    }
}
