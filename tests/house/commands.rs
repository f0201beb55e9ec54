//! Commands in documents and in comments can be run: the targets, scripts, options and files that they name exist, and
//! each filter of `cargo test` selects a test.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::dependencies::metadata;
use crate::documents::{FOLDERS, Part, documents, files, parts, read, root};
use crate::imports::rust_files;

/// What has the form of a command and is none: lines of the table of `reference/validate.py`, and a link.
const NO_COMMANDS: [&str; 5] = [
    "signorini qp",
    "signorini active-set",
    "signorini penalty",
    "signorini scene, .vtu",
    "signorini <https://pypi.org/project/signorini/>",
];

/// Names of the program in documents.
const PROGRAM: [&str; 4] = ["signorini", "PROGRAM", "target/release/signorini", "target/debug/signorini"];

/// Options of cargo that take a value.
const WITH_VALUE: [&str; 8] =
    ["--package", "-p", "--test", "--example", "--bin", "--bench", "--features", "--message-format"];

/// A target of cargo.
struct Target {
    package: String,
    kind: String,
    name: String,
    file: PathBuf,
    is_tested: bool,
}

impl Target {
    /// The files from which it is compiled.
    fn files(&self) -> Vec<PathBuf> {
        match self.file.ends_with("main.rs") || self.file.ends_with("lib.rs") {
            true => rust_files(self.file.parent().unwrap()),
            false => vec![self.file.clone()],
        }
    }

    /// The names of its tests as filters see them, each with whether it is ignored.
    fn tests(&self) -> Vec<(String, bool)> {
        let folder = self.file.parent().unwrap();
        let of_file = |file: PathBuf| {
            let path = file.strip_prefix(folder).unwrap().with_extension("");
            let mut module: Vec<&str> = path.iter().map(|name| name.to_str().unwrap()).collect();
            module.pop_if(|name| ["main", "lib", "mod"].contains(name));
            tests(&module, &fs::read_to_string(&file).unwrap())
        };
        self.files().into_iter().flat_map(of_file).collect()
    }
}

/// The tests in the text of a module. It must have the form that rustfmt gives it.
fn tests(module: &[&str], text: &str) -> Vec<(String, bool)> {
    let mut found = Vec::new();
    let mut modules: Vec<(usize, &str)> = Vec::new();
    let (mut is_test, mut is_ignored) = (false, false);
    for line in text.lines() {
        let code = line.trim_start();
        let indent = line.len() - code.len();
        if code == "}" {
            modules.retain(|(outer, _)| *outer < indent);
        }
        if let Some(name) = code.strip_prefix("mod ").and_then(|rest| rest.strip_suffix(" {")) {
            modules.push((indent, name));
        }
        is_test |= code == "#[test]";
        is_ignored |= code.starts_with("#[ignore");
        if let Some(name) = code.strip_prefix("fn ") {
            let inside = modules.iter().map(|(_, name)| *name).chain(name.split('(').take(1));
            let names: Vec<&str> = module.iter().copied().chain(inside).collect();
            found.extend(is_test.then(|| (names.join("::"), is_ignored)));
            (is_test, is_ignored) = (false, false);
        }
    }
    found
}

/// The words of a command: quotes hold a word together, square brackets around what may be left out are dropped.
fn words(command: &str) -> Vec<String> {
    let (mut words, mut quote, mut is_open) = (Vec::<String>::new(), None, false);
    for letter in command.chars() {
        match (letter, quote) {
            ('"' | '\'', None) => quote = Some(letter),
            (_, Some(end)) if letter == end => quote = None,
            (_, None) if letter.is_whitespace() => is_open = false,
            _ => {
                if !is_open {
                    words.push(String::new());
                    is_open = true;
                }
                words.last_mut().unwrap().push(letter);
            }
        }
    }
    words.iter().map(|word| word.trim_start_matches('[').trim_end_matches(']').to_string()).collect()
}

/// Returns `true` for `NAME` and the like, which stands for what a reader puts there.
fn is_open(word: &str) -> bool {
    word.contains(|letter: char| letter.is_uppercase()) && !word.contains(|letter: char| letter.is_lowercase())
}

/// What a command of cargo says before `--`.
#[derive(Default)]
struct Said<'a> {
    package: Option<&'a str>,
    workspace: bool,
    /// The kinds of targets that it names, with their names.
    targets: Vec<(&'a str, Option<&'a str>)>,
    /// What is no option.
    filters: Vec<&'a str>,
}

impl<'a> Said<'a> {
    fn of(words: &'a [String]) -> Said<'a> {
        let mut said = Said::default();
        let mut words = words.iter().map(String::as_str);
        while let Some(word) = words.next() {
            let value = WITH_VALUE.contains(&word).then(|| words.next().unwrap_or_default());
            match word {
                "--package" | "-p" => said.package = value,
                "--workspace" => said.workspace = true,
                "--lib" => said.targets.push(("lib", None)),
                "--test" | "--example" | "--bin" | "--bench" => said.targets.push((&word[2..], value)),
                _ if !word.starts_with('-') => said.filters.push(word),
                _ => {}
            }
        }
        said
    }
}

/// What commands may name.
struct Known {
    targets: Vec<Target>,
    /// The help of each command of the program.
    helps: BTreeMap<String, String>,
}

impl Known {
    fn read() -> Known {
        let (mut targets, packages) = (Vec::new(), metadata(&["--no-deps"]));
        for package in packages["packages"].as_array().unwrap() {
            for target in package["targets"].as_array().unwrap() {
                let text = |value: &serde_json::Value| value.as_str().unwrap().to_string();
                targets.push(Target {
                    package: text(&package["name"]),
                    kind: text(&target["kind"][0]),
                    name: text(&target["name"]),
                    file: text(&target["src_path"]).into(),
                    is_tested: target["test"].as_bool().unwrap(),
                });
            }
        }
        let help = |arguments: &[&str]| {
            let output = Command::new(env!("CARGO_BIN_EXE_signorini")).args(arguments).output().unwrap();
            String::from_utf8(output.stdout).unwrap()
        };
        let all = help(&["--help"]);
        let commands = all.split("Commands:\n").nth(1).unwrap().split("\n\n").next().unwrap();
        let names = commands.lines().filter_map(|line| line.split_whitespace().next());
        let helps = names.map(|name| (name.to_string(), help(&[name, "--help"]))).collect();
        Known { targets, helps }
    }

    /// What is wrong with a command, in words.
    fn check(&self, command: &str) -> Result<(), String> {
        let words = words(command.split(" #").next().unwrap());
        let ends = |word: &String| ["&&", "||", "|", ";", ">"].contains(&word.as_str());
        words.split(ends).try_for_each(|words| {
            let is_setting = |word: &&String| word.split_once('=').is_some_and(|(name, _)| is_open(name));
            self.check_one(&words[words.iter().take_while(is_setting).count()..])
        })
    }

    fn check_one(&self, words: &[String]) -> Result<(), String> {
        let Some((first, rest)) = words.split_first() else { return Ok(()) };
        let name = first.rsplit('/').next().unwrap();
        let is_script = |word: &String| [".py", ".sh"].iter().any(|end| word.ends_with(end));
        match first.as_str() {
            "cargo" => self.check_cargo(rest)?,
            "pip" => {
                let files = rest.iter().filter(|word| word.starts_with("./") || word.ends_with(".txt"));
                files.map(|word| word.split('[').next().unwrap()).try_for_each(exists)?;
            }
            program if PROGRAM.contains(&program) => self.check_program(rest)?,
            _ if ["python", "python3"].contains(&name) => {
                let own = rest.iter().take_while(|word| word.starts_with('-') && *word != "-m").count();
                match rest[own..].split_first() {
                    Some((script, rest)) if is_script(script) => check_script(script, rest)?,
                    _ => return Ok(()),
                }
            }
            // A script without arguments is only named; `documents.rs` looks for it.
            _ if is_script(first) && first.contains('/') && !rest.is_empty() => check_script(first, rest)?,
            _ => return Ok(()),
        }
        let of_repository = |word: &&String| {
            FOLDERS.iter().any(|folder| word.starts_with(&format!("{folder}/"))) && !word.contains(['*', ','])
        };
        words.iter().filter(of_repository).try_for_each(exists)
    }

    fn check_cargo(&self, words: &[String]) -> Result<(), String> {
        let mut parts = words.splitn(2, |word| word == "--");
        let (own, after) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
        let said = Said::of(own.get(1..).unwrap_or_default());
        let package = said.package.unwrap_or("signorini");
        if is_open(package) || !self.targets.iter().any(|target| target.package == package) {
            return if is_open(package) { Ok(()) } else { Err(format!("there is no package {package}")) };
        }
        let mut chosen = Vec::new();
        let of_package = self.targets.iter().filter(|target| said.workspace || target.package == package);
        let of_package: Vec<&Target> = of_package.collect();
        for (kind, name) in &said.targets {
            let is_it = |target: &&&Target| target.kind == *kind && name.is_none_or(|name| target.name == name);
            let before = chosen.len();
            chosen.extend(of_package.iter().filter(is_it).copied());
            if chosen.len() == before && !name.is_some_and(is_open) {
                return Err(format!("there is no {kind} {}", name.unwrap_or_default()));
            }
        }
        match own.first().map(String::as_str) {
            Some("test") => {
                let chosen = if said.targets.is_empty() { of_package } else { chosen };
                let filters = said.filters.into_iter().chain(after.iter().map(String::as_str));
                check_filters(&chosen, filters.filter(|word| !word.starts_with('-')), after)
            }
            Some("run") => match chosen.first().filter(|target| target.kind != "bin") {
                Some(target) => {
                    let text: String = target.files().iter().map(|file| fs::read_to_string(file).unwrap()).collect();
                    check_part(after, &text)?;
                    check_options(after, &text)
                }
                None if said.targets.is_empty() => self.check_program(after),
                None => Ok(()),
            },
            Some("bench") => match self.targets.iter().any(|target| target.kind == "bench") {
                true => Ok(()),
                false => Err("there is no bench".to_string()),
            },
            _ => Ok(()),
        }
    }

    fn check_program(&self, words: &[String]) -> Result<(), String> {
        let Some((name, rest)) = words.split_first().filter(|(name, _)| !name.starts_with('-')) else { return Ok(()) };
        let help = self.helps.get(name.as_str()).ok_or_else(|| format!("there is no command {name}"))?;
        check_options(rest, help)
    }
}

/// Each filter must select a test of these targets.
fn check_filters<'a>(
    targets: &[&Target],
    filters: impl Iterator<Item = &'a str>,
    after: &[String],
) -> Result<(), String> {
    let says = |option: &str| after.iter().any(|word| word == option);
    let (only_ignored, all) = (says("--ignored"), says("--include-ignored"));
    let tests = targets.iter().filter(|target| target.is_tested).flat_map(|target| target.tests());
    let tests: Vec<String> =
        tests.filter(|(_, is_ignored)| all || *is_ignored == only_ignored).map(|(name, _)| name).collect();
    for filter in filters {
        if !tests.iter().any(|name| name.contains(filter)) {
            return Err(format!("{filter} selects no test of {}", tests.len()));
        }
    }
    if tests.is_empty() { Err("there is no test".to_string()) } else { Ok(()) }
}

/// A script has the options with which it is called, in its text or in that of a module beside it that it imports.
fn check_script(script: &str, words: &[String]) -> Result<(), String> {
    let file = match script.contains('/') {
        true => root().join(script),
        // A script of an example, in the folder of which its reader is.
        false => {
            let folders = fs::read_dir(root().join("examples")).unwrap().map(|entry| entry.unwrap().path());
            let mut folders = folders.chain([root().join("python/examples")]);
            folders.find_map(|folder| Some(folder.join(script)).filter(|file| file.is_file())).unwrap_or_default()
        }
    };
    let text = fs::read_to_string(&file).map_err(|_| format!("there is no {script}"))?;
    let imported = text.lines().filter_map(|line| line.strip_prefix("import ").or(line.strip_prefix("from ")));
    let beside = imported.filter_map(|line| line.split_whitespace().next());
    let beside = beside.filter_map(|name| fs::read_to_string(file.with_file_name(format!("{name}.py"))).ok());
    check_options(words, &(beside.collect::<String>() + &text))
}

/// The first argument stands in the text of a program if it is a word, as the name of one of its parts.
fn check_part(words: &[String], text: &str) -> Result<(), String> {
    let plain = |text: &str| text.to_lowercase().replace(['-', '_'], "");
    let is_word = |word: &&String| word.chars().all(|letter| letter.is_ascii_lowercase() || letter == '-');
    match words.first().filter(is_word).filter(|word| !plain(text).contains(&plain(word))) {
        Some(word) => Err(format!("there is no {word}")),
        None => Ok(()),
    }
}

/// Each option stands in the text of a program or of its help, or is a field of its arguments there.
fn check_options(words: &[String], text: &str) -> Result<(), String> {
    for word in words.iter().filter(|word| word.len() > 2 && word.starts_with("--")) {
        let option = word.split('=').next().unwrap();
        let field = format!(" {}: ", option[2..].replace('-', "_"));
        if !text.contains(option) && !text.contains(&field) {
            return Err(format!("there is no option {option}"));
        }
    }
    Ok(())
}

fn exists(name: impl AsRef<str>) -> Result<(), String> {
    match root().join(name.as_ref()).exists() {
        true => Ok(()),
        false => Err(format!("there is no file {}", name.as_ref())),
    }
}

/// The comments of a source file as text, with an empty line for each line of code; in Python the whole text.
fn comments(file: &Path) -> String {
    let text = fs::read_to_string(file).unwrap();
    let is_rust = file.extension().is_some_and(|extension| extension == "rs");
    let comment = |line: &str| {
        let line = line.trim_start();
        let reason = line.strip_prefix("#[ignore = \"").and_then(|reason| reason.split(": ").nth(1));
        match (is_rust, reason) {
            (true, Some(command)) => format!("    {}", command.trim_end_matches("\"]")),
            (true, None) => {
                let text = line.strip_prefix("//").unwrap_or_default();
                text.trim_start_matches(['/', '!']).strip_prefix(' ').unwrap_or_default().to_string()
            }
            (false, _) => line.trim_start_matches("# ").to_string(),
        }
    };
    text.lines().map(|line| comment(line) + "\n").collect()
}

/// The commands of a document, each with its line: those in running text, and the lines of its blocks.
fn commands(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for part in parts(text) {
        match part {
            Part::Code { text, line } => found.push((line, text)),
            Part::Block { kind, text, line } if kind == "sh" => {
                found.extend(text.lines().enumerate().map(|(at, text)| (line + 1 + at, text.to_string())));
            }
            _ => {}
        }
    }
    found.retain(|(_, command)| !NO_COMMANDS.contains(&command.as_str()));
    found
}

#[test]
fn every_command_of_documents_and_comments_names_what_exists() {
    let known = Known::read();
    let pages = documents().into_iter().map(|name| (read(&name), name));
    let name = |file: &PathBuf| file.strip_prefix(root()).unwrap().display().to_string();
    let is_code = |file: &PathBuf| ["rs", "py", "sh", "toml"].iter().any(|end| file.extension() == Some(end.as_ref()));
    let sources = files().into_iter().filter(is_code).map(|file| (comments(&file), name(&file)));
    let (mut wrong, mut checked) = (Vec::new(), 0);
    for (text, name) in pages.chain(sources) {
        for (line, command) in commands(&text) {
            checked += usize::from(command.starts_with("cargo ") || command.contains(".py "));
            wrong.extend(known.check(&command).err().map(|fault| format!("{name}:{line}: {command}: {fault}")));
        }
    }
    assert!(wrong.is_empty(), "{} of {checked} commands:\n{}", wrong.len(), wrong.join("\n"));
    assert!(checked > 150, "{checked} commands");
}

#[test]
fn a_wrong_command_is_found() {
    let known = Known::read();
    for (right, wrong) in [
        ("cargo test --package signorini-mechanics --lib continuum", "cargo test --lib continuum"),
        ("cargo test --test house a_wrong_command", "cargo test --test house a_right_command"),
        ("cargo test --test house", "cargo test --test houses"),
        (
            "cargo test --package signorini-mechanics blocks_of_many_cells -- --ignored",
            "cargo test --package signorini-mechanics blocks_of_many_cells",
        ),
        ("cargo run --release --example two_springs", "cargo run --release --example three_springs"),
        ("cargo run --example studies -- modes scenes 200", "cargo run --example studies -- mods scenes 200"),
        ("cargo run --release -- solve a.json --out b", "cargo run --release -- solve a.json --output b"),
        ("signorini solve examples/indentation.json", "signorini solve examples/indentations.json"),
        ("signorini compare SCENE.json", "signorini compares SCENE.json"),
        ("A=1 python3 -B reference/choice.py P --runs 3", "A=1 python3 -B reference/choice.py P --walks 3"),
        ("python python/measure.py --small | tail", "python python/measures.py --small | tail"),
        ("pip install './python[jax]'", "pip install './pythons[jax]'"),
        ("pip install -r reference/requirements.txt", "pip install -r reference/requirement.txt"),
        ("cargo fmt && reference/parts.py FOLDER", "cargo fmt && reference/part.py FOLDER"),
    ] {
        assert_eq!(known.check(right), Ok(()), "{right}");
        assert!(known.check(wrong).is_err(), "{wrong}");
    }
}

/// The tests of this binary, as it lists them itself.
#[test]
fn tests_are_read_from_their_files() {
    let output = Command::new(std::env::current_exe().unwrap()).arg("--list").output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let mut listed: Vec<&str> = text.lines().filter_map(|line| line.strip_suffix(": test")).collect();
    let known = Known::read();
    let own = known.targets.iter().find(|target| target.name == "house").unwrap().tests();
    let mut read: Vec<&str> = own.iter().map(|(name, _)| name.as_str()).collect();
    listed.sort_unstable();
    read.sort_unstable();
    assert_eq!(read, listed);
}
