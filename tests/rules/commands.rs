//! Commands in documents and in comments can be run: the targets, scripts, options and files that they name exist, and
//! each filter of `cargo test` selects a test.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;
use syn::Item;

use crate::dependencies::metadata;
use crate::documents::{FOLDERS, Part, documents, parts, read};
use crate::sources::{files_below, has, root};

/// What has the form of a command and is none: lines of the table of `reference/validate.py`, and a link.
const NO_COMMANDS: [&str; 5] = [
    "signorini qp",
    "signorini active-set",
    "signorini penalty",
    "signorini scene, .vtu",
    "signorini <https://pypi.org/project/signorini/>",
];

/// Options of cargo that take a value.
const WITH_VALUE: [&str; 8] =
    ["--package", "-p", "--test", "--example", "--bin", "--bench", "--features", "--message-format"];

/// A target of cargo.
struct Target {
    package: String,
    kind: String,
    name: String,
    text: String,
    /// The names of its tests as filters see them, each with whether it is ignored.
    tests: Vec<(String, bool)>,
}

impl Target {
    fn read(package: &Value, target: &Value) -> Target {
        let text = |value: &Value| value.as_str().unwrap().to_string();
        let file = PathBuf::from(text(&target["src_path"]));
        let folder = file.parent().unwrap();
        let is_folder = file.ends_with("main.rs") || file.ends_with("lib.rs");
        let files = if is_folder { files_below(folder, ".rs") } else { vec![file.clone()] };
        let texts: Vec<String> = files.iter().map(|file| fs::read_to_string(file).unwrap()).collect();
        let of_file = |(file, text): (&PathBuf, &String)| {
            let path = file.strip_prefix(folder).unwrap().with_extension("");
            let mut module: Vec<String> = path.iter().map(|name| name.to_str().unwrap().to_string()).collect();
            module.pop_if(|name| ["main", "lib", "mod"].contains(&name.as_str()));
            tests(&module, &syn::parse_file(text).unwrap().items)
        };
        let tested = files.iter().zip(&texts).filter(|_| target["test"] == true);
        Target {
            package: text(&package["name"]),
            kind: text(&target["kind"][0]),
            name: text(&target["name"]),
            tests: tested.flat_map(of_file).collect(),
            text: texts.concat(),
        }
    }
}

/// The tests among the items of a module.
fn tests(module: &[String], items: &[Item]) -> Vec<(String, bool)> {
    let inside = |name: &syn::Ident| [module, &[name.to_string()]].concat();
    let of_item = |item: &Item| match item {
        Item::Fn(one) if has(&one.attrs, "test") => {
            vec![(inside(&one.sig.ident).join("::"), has(&one.attrs, "ignore"))]
        }
        Item::Mod(one) => one.content.iter().flat_map(|(_, items)| tests(&inside(&one.ident), items)).collect(),
        _ => Vec::new(),
    };
    items.iter().flat_map(of_item).collect()
}

/// Returns `true` for `NAME` and the like, which stands for what a reader puts there.
fn is_open(word: &str) -> bool {
    word.contains(|letter: char| letter.is_uppercase()) && !word.contains(|letter: char| letter.is_lowercase())
}

/// The text in which the options of a command must stand, and its arguments; none for a command that has none here.
type Called<'a> = Option<(String, &'a [&'a str])>;

/// What commands may name.
struct Known {
    targets: Vec<Target>,
    /// The help of each command of the program.
    helps: BTreeMap<String, String>,
}

impl Known {
    fn read() -> Known {
        let found = metadata("--no-deps");
        let packages = found["packages"].as_array().unwrap().iter();
        let read = |package: &Value| -> Vec<Target> {
            package["targets"].as_array().unwrap().iter().map(|target| Target::read(package, target)).collect()
        };
        let help = |arguments: &[&str]| {
            let output = Command::new(env!("CARGO_BIN_EXE_signorini")).args(arguments).output().unwrap();
            String::from_utf8(output.stdout).unwrap()
        };
        let all = help(&["--help"]);
        let commands = all.split("Commands:\n").nth(1).unwrap().split("\n\n").next().unwrap();
        let names = commands.lines().filter_map(|line| line.split_whitespace().next());
        let helps = names.map(|name| (name.to_string(), help(&[name, "--help"]))).collect();
        Known { targets: packages.flat_map(read).collect(), helps }
    }

    /// What is wrong with a command, in words.
    fn check(&self, command: &str) -> Result<(), String> {
        let words = command.split(" #").next().unwrap().split_whitespace();
        let words: Vec<&str> = words.map(|word| word.trim_matches(['\'', '"', '[', ']'])).collect();
        words.split(|word| ["&&", "||", "|", ";", ">"].contains(word)).try_for_each(|words| {
            let is_setting = |word: &&&str| word.split_once('=').is_some_and(|(name, _)| is_open(name));
            self.check_one(&words[words.iter().take_while(is_setting).count()..])
        })
    }

    fn check_one(&self, words: &[&str]) -> Result<(), String> {
        let Some((first, rest)) = words.split_first() else { return Ok(()) };
        let script = words.iter().position(|word| word.ends_with(".py") || word.ends_with(".sh"));
        let called = match (first.rsplit('/').next().unwrap(), script) {
            ("cargo", _) => self.of_cargo(rest)?,
            ("pip", _) => None,
            ("signorini" | "PROGRAM", _) => self.of_program(rest)?,
            // A script without arguments is only named; `documents.rs` looks for it.
            ("python" | "python3", Some(at)) => Some((text_of_script(words[at])?, &words[at + 1..])),
            (_, Some(0)) if first.contains('/') && !rest.is_empty() => Some((text_of_script(first)?, rest)),
            _ => return Ok(()),
        };
        if let Some((text, arguments)) = called {
            for option in arguments.iter().filter(|word| word.len() > 2 && word.starts_with("--")) {
                let option = option.split('=').next().unwrap();
                // It stands in the text of a program or of its help, or is a field of its arguments there.
                let field = format!(" {}: ", option[2..].replace('-', "_"));
                if !text.contains(option) && !text.contains(&field) {
                    return Err(format!("there is no option {option}"));
                }
            }
        }
        let is_ours = |word: &&str| {
            let is_below = FOLDERS.iter().any(|folder| word.starts_with(&format!("{folder}/")));
            (is_below || *first == "pip" && word.starts_with("./")) && !word.contains(['*', ','])
        };
        let files = words.iter().copied().filter(is_ours).map(|word| word.split('[').next().unwrap());
        match files.into_iter().find(|file| !root().join(file).exists()) {
            Some(file) => Err(format!("there is no file {file}")),
            None => Ok(()),
        }
    }

    fn of_program<'a>(&self, words: &'a [&'a str]) -> Result<Called<'a>, String> {
        let Some((name, rest)) = words.split_first().filter(|(name, _)| !name.starts_with('-')) else {
            return Ok(None);
        };
        let help = self.helps.get(*name).ok_or_else(|| format!("there is no command {name}"))?;
        Ok(Some((help.clone(), rest)))
    }

    fn of_cargo<'a>(&self, words: &'a [&'a str]) -> Result<Called<'a>, String> {
        let end = words.iter().position(|word| *word == "--").unwrap_or(words.len());
        let (own, after) = (&words[..end], words.get(end + 1..).unwrap_or_default());
        let value = |at: usize| own.get(at + 1).copied().unwrap_or_default();
        let package = own.iter().position(|word| ["--package", "-p"].contains(word)).map_or("signorini", value);
        if is_open(package) {
            return Ok(None);
        }
        let of_package = self.targets.iter().filter(|one| own.contains(&"--workspace") || one.package == package);
        let of_package: Vec<&Target> = of_package.collect();
        if of_package.is_empty() {
            return Err(format!("there is no package {package}"));
        }
        let mut chosen: Vec<&Target> = Vec::new();
        let kinds = own.iter().enumerate().filter_map(|(at, word)| Some((at, word.strip_prefix("--")?)));
        for (at, kind) in kinds.filter(|(_, kind)| ["lib", "test", "example", "bin", "bench"].contains(kind)) {
            let is_it = |one: &&&Target| one.kind == kind && (kind == "lib" || one.name == value(at));
            let before = chosen.len();
            chosen.extend(of_package.iter().filter(is_it));
            if chosen.len() == before && !is_open(value(at)) {
                return Err(format!("there is no {kind} {}", value(at)));
            }
        }
        match (own.first(), chosen.first()) {
            (Some(&"test"), _) => {
                let is_free = |at: &usize| !own[*at].starts_with('-') && !WITH_VALUE.contains(&own[at - 1]);
                let filters = (1..own.len()).filter(is_free).map(|at| own[at]);
                let filters = filters.chain(after.iter().copied().filter(|word| !word.starts_with('-')));
                check_filters(if chosen.is_empty() { &of_package } else { &chosen }, filters, after).map(|()| None)
            }
            (Some(&"run"), None) if !own.contains(&"--example") => self.of_program(after),
            (Some(&"run"), Some(target)) => {
                // The first argument may be the name of a part.
                let plain = |text: &str| text.to_lowercase().replace(['-', '_'], "");
                let is_word = |word: &&&str| word.chars().all(|letter| letter.is_ascii_lowercase() || letter == '-');
                match after.first().filter(is_word).filter(|word| !plain(&target.text).contains(&plain(word))) {
                    Some(word) => Err(format!("there is no {word}")),
                    None => Ok(Some((target.text.clone(), after))),
                }
            }
            _ => Ok(None),
        }
    }
}

/// Each filter must select a test of these targets.
fn check_filters<'a>(
    targets: &[&Target],
    mut filters: impl Iterator<Item = &'a str>,
    after: &[&str],
) -> Result<(), String> {
    let (only_ignored, all) = (after.contains(&"--ignored"), after.contains(&"--include-ignored"));
    let tests = targets.iter().flat_map(|target| &target.tests).filter(|(_, ignored)| all || *ignored == only_ignored);
    let tests: Vec<&String> = tests.map(|(name, _)| name).collect();
    match filters.find(|filter| !tests.iter().any(|name| name.contains(filter))) {
        Some(filter) => Err(format!("{filter} selects no test of {}", tests.len())),
        None if tests.is_empty() => Err("there is no test".to_string()),
        None => Ok(()),
    }
}

/// The text of a script, after those of the modules beside it that it imports.
fn text_of_script(script: &str) -> Result<String, String> {
    let mut file = root().join(script);
    if !script.contains('/') {
        // A script of an example, in the folder of which its reader is.
        let scripts = ["examples", "python/examples"].iter().flat_map(|folder| files_below(folder, ".py"));
        file = scripts.into_iter().find(|file| file.ends_with(script)).unwrap_or(file);
    }
    let text = fs::read_to_string(&file).map_err(|_| format!("there is no {script}"))?;
    let imported = text.lines().filter_map(|line| line.strip_prefix("import ").or(line.strip_prefix("from ")));
    let beside = imported.filter_map(|line| line.split_whitespace().next());
    let beside = beside.filter_map(|name| fs::read_to_string(file.with_file_name(format!("{name}.py"))).ok());
    Ok(beside.collect::<String>() + &text)
}

/// The comments of a source file as text, with an empty line for each line of code; in Python the whole text.
fn comments(file: &Path) -> String {
    let is_rust = file.extension().is_some_and(|extension| extension == "rs");
    let comment = |line: &str| {
        let line = line.trim_start();
        let ignored = line.strip_prefix("#[ignore = \"").and_then(|reason| reason.split(": ").nth(1));
        match (is_rust, ignored) {
            (true, Some(command)) => format!("    {}\n", command.trim_end_matches("\"]")),
            (true, None) => {
                let text = line.strip_prefix("//").unwrap_or_default().trim_start_matches(['/', '!']);
                text.strip_prefix(' ').unwrap_or_default().to_string() + "\n"
            }
            (false, _) => line.trim_start_matches("# ").to_string() + "\n",
        }
    };
    fs::read_to_string(file).unwrap().lines().map(comment).collect()
}

/// The commands of a document, each with its line: those in running text, and the lines of its blocks.
fn commands(text: &str) -> Vec<(usize, String)> {
    let of_part = |part: Part| match part {
        Part::Code { text, line } => vec![(line, text)],
        Part::Block { kind, text, line } if kind == "sh" => {
            text.lines().enumerate().map(|(at, text)| (line + 1 + at, text.to_string())).collect()
        }
        _ => Vec::new(),
    };
    let all = parts(text).into_iter().flat_map(of_part);
    all.filter(|(_, command)| !NO_COMMANDS.contains(&command.as_str())).collect()
}

#[test]
fn every_command_of_documents_and_comments_names_what_exists() {
    let known = Known::read();
    let pages = documents().into_iter().map(|name| (read(&name), name));
    let name = |file: &PathBuf| file.strip_prefix(root()).unwrap().display().to_string();
    let endings = [".rs", ".py", ".sh", ".toml"].into_iter();
    let files = endings.flat_map(|ending| FOLDERS.iter().flat_map(move |folder| files_below(folder, ending)));
    let (mut wrong, mut checked) = (Vec::new(), 0);
    for (text, name) in pages.chain(files.map(|file| (comments(&file), name(&file)))) {
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
        ("cargo test --package signorini-guarantee --lib keys", "cargo test --lib keys"),
        ("cargo test --test rules a_wrong_command", "cargo test --test rules a_right_command"),
        ("cargo test --test rules", "cargo test --test rule"),
        (
            "cargo test --package signorini-guarantee blocks_of_many_cells -- --ignored",
            "cargo test --package signorini-guarantee blocks_of_many_cells",
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
    let own = known.targets.iter().find(|target| target.name == "rules").unwrap();
    let mut read: Vec<&str> = own.tests.iter().map(|(name, _)| name.as_str()).collect();
    listed.sort_unstable();
    read.sort_unstable();
    assert_eq!(read, listed);
}
