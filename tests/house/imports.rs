//! The imports between the files of all crates: the `use` declarations and the paths in the code (`crate::a::b(..)`,
//! `super::c`, `signorini_qp::d`), followed through re-exports to the file that defines the name.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// A module by its names, as a user of `signorini` knows it: `qp::method::start`, `fem::mesh`, `output::page`, `cli`;
/// `[]` is the crate of the mechanics, and `lib` what `signorini` re-exports.
pub type Module = Vec<String>;

/// The sources of a crate, its name in code, and the names that come before those of its modules.
type OfCrate = (&'static str, &'static str, &'static [&'static str]);

/// Each crate that is published.
pub const CRATES: [OfCrate; 5] = [
    ("crates/qp/src", "signorini_qp", &["qp"]),
    ("crates/lcp/src", "signorini_lcp", &["lcp"]),
    ("crates/mechanics/src", "signorini_mechanics", &[]),
    ("crates/output/src", "signorini_output", &["output"]),
    ("src", "signorini", &[]),
];

/// A source file, and the content of its `use` declarations.
pub struct Source {
    /// Its path as that of its module: `qp/method/start.rs`, `fem/mesh/mod.rs`, `output/page/write.rs`, `cli/solve.rs`.
    pub path: PathBuf,
    /// Text of the file.
    pub text: String,
    /// Paths that the file names, from the crate root, without those that it re-exports to every user.
    imports: BTreeSet<Module>,
    /// Names that `use` declarations bring into the file, and their origin.
    names: BTreeMap<String, Module>,
    /// The names that the file exports to every user.
    pub exports: BTreeMap<String, Module>,
}

/// All files of all crates by their modules.
pub struct House {
    pub files: BTreeMap<Module, Source>,
}

/// The files `*.rs` below a folder.
pub fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let (mut files, mut folders) = (Vec::new(), vec![folder.to_path_buf()]);
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                files.push(path);
            }
        }
    }
    files
}

impl House {
    /// Reads the sources of all crates, without files of tests.
    pub fn read() -> Self {
        let mut texts = BTreeMap::new();
        for (folder, _, before) in CRATES {
            let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
            for path in rust_files(&root) {
                let inside = path.strip_prefix(&root).unwrap();
                // What `signorini` re-exports is not the root of the mechanics.
                let name = if folder == "src" { "lib" } else { "" };
                let module = module_of(inside, before, name);
                texts.insert(
                    module,
                    (before.iter().collect::<PathBuf>().join(inside), fs::read_to_string(&path).unwrap()),
                );
            }
        }
        House::of(texts, &CRATES)
    }

    /// Reads the sources of one program, or of a crate that is not published; its root is `[]`.
    pub fn of_folder(folder: &Path) -> Self {
        let module = |path: &Path| match module_of(path, &[], "") {
            module if module == ["main"] => Module::new(),
            module => module,
        };
        let text = |path: PathBuf| {
            let inside = path.strip_prefix(folder).unwrap();
            (module(inside), (path.clone(), fs::read_to_string(&path).unwrap()))
        };
        House::of(rust_files(folder).into_iter().map(text).collect(), &[])
    }

    /// The files with these modules, paths and texts, which name each other's crates as `crates` says.
    fn of(mut texts: BTreeMap<Module, (PathBuf, String)>, crates: &[OfCrate]) -> Self {
        let of_tests = |module: &Module| {
            (1..=module.len()).any(|length| {
                let declared = format!("#[cfg(test)]\nmod {};", module[length - 1]);
                texts.get(&module[..length - 1]).is_some_and(|(_, text): &(PathBuf, String)| text.contains(&declared))
            })
        };
        let of_tests: Vec<Module> = texts.keys().filter(|module| of_tests(module)).cloned().collect();
        of_tests.iter().for_each(|module| drop(texts.remove(module)));
        let known: BTreeSet<Module> = texts.keys().cloned().collect();
        let read = |(module, (path, text)): (Module, (PathBuf, String))| {
            let (declarations, paths) = named(&text);
            let mut source =
                Source { path, text, imports: BTreeSet::new(), names: BTreeMap::new(), exports: BTreeMap::new() };
            for (is_public, name, tree) in declarations {
                let Some(import) = from_root(&tree, &module, &known, crates) else { continue };
                source.names.insert(name.clone(), import.clone());
                if is_public {
                    source.exports.insert(name, import);
                } else {
                    source.imports.insert(import);
                }
            }
            for path in paths {
                // A declaration may have brought in the first name of a path.
                let import = match source.names.get(&path[0]) {
                    Some(import) => Some([import.as_slice(), &path[1..]].concat()),
                    None => from_root(&path, &module, &known, crates),
                };
                source.imports.extend(import);
            }
            (module, source)
        };
        House { files: texts.into_iter().map(read).collect() }
    }

    /// The modules from which `module` takes names, without `module` itself.
    pub fn taken_from(&self, module: &Module) -> BTreeSet<Module> {
        let source = &self.files[module];
        let mut found: BTreeSet<Module> = source.imports.iter().map(|import| self.defining(import, 0)).collect();
        found.remove(module);
        found
    }

    /// The arrows that close a circle of imports.
    pub fn circles(&self) -> BTreeSet<String> {
        circles(&self.files.keys().map(|module| (module.clone(), self.taken_from(module))).collect())
    }

    /// The modules that a user sees, of all crates: their roots, and what is public in them.
    pub fn public_modules(&self) -> Vec<Module> {
        let mut found: Vec<Module> = Vec::new();
        let mut next: Vec<Module> =
            CRATES.iter().map(|of_crate| of_crate.2.iter().map(|name| (*name).to_string()).collect()).collect();
        next.push(vec!["lib".to_string()]);
        while let Some(module) = next.pop() {
            let Some(source) = self.files.get(&module).filter(|_| !found.contains(&module)) else { continue };
            let before = if module == ["lib"] { Vec::new() } else { module.clone() };
            let inside = source.text.lines().filter_map(|line| line.strip_prefix("pub mod "));
            next.extend(inside.map(|name| [&before[..], &[name.trim_end_matches(';').to_string()]].concat()));
            found.push(module);
        }
        found
    }

    /// The file that defines what a path from the crate root names.
    pub fn file_of(&self, path: &[String]) -> Module {
        self.defining(path, 0)
    }

    /// The file that defines `name` as a file of `module` means it.
    pub fn origin(&self, module: &Module, name: &str) -> Module {
        self.files[module].names.get(name).map_or_else(|| module.clone(), |path| self.defining(path, 0))
    }

    /// The file that defines what a path names.
    fn defining(&self, path: &[String], followed: usize) -> Module {
        let mut length = path.len();
        while !self.files.contains_key(&path[..length]) {
            length -= 1;
        }
        let (module, rest) = (path[..length].to_vec(), &path[length..]);
        let origin = rest.first().and_then(|name| self.files[&module].names.get(name));
        match origin {
            Some(origin) if origin != path && followed < 9 => {
                self.defining(&[origin.as_slice(), &rest[1..]].concat(), followed + 1)
            }
            _ => module,
        }
    }
}

/// The arrows that close a circle, of the files from which each file takes names.
pub fn circles(taken: &BTreeMap<Module, BTreeSet<Module>>) -> BTreeSet<String> {
    let mut circles = BTreeSet::new();
    for start in taken.keys() {
        // The files that this file reaches by imports; the file itself must not be among these.
        let (mut reached, mut next) = (BTreeSet::new(), vec![start]);
        while let Some(module) = next.pop() {
            for other in &taken[module] {
                if other == start {
                    circles.insert(format!("{} <- {}", start.join("/"), module.join("/")));
                }
                if reached.insert(other) {
                    next.push(other);
                }
            }
        }
    }
    circles
}

/// The module of a file in a crate whose modules stand behind `before`; `root` is the name of the crate's own file.
fn module_of(path: &Path, before: &[&str], root: &str) -> Module {
    let mut names: Module =
        path.with_extension("").components().map(|part| part.as_os_str().to_str().unwrap().to_string()).collect();
    if names.last().is_some_and(|name| name == "mod") || names == ["lib"] && root.is_empty() {
        names.pop();
    }
    before.iter().map(|name| (*name).to_string()).chain(names).collect()
}

/// The names in the code of a file: its `use` declarations, each as public or not, name and path; and its other paths.
type Named = (Vec<(bool, String, Module)>, Vec<Module>);

fn named(text: &str) -> Named {
    let words = words(text.split("#[cfg(test)]\nmod").next().unwrap_or_default());
    let word = |at: usize| words.get(at).map_or("", String::as_str);
    let (mut declarations, mut paths) = (Vec::new(), Vec::new());
    let mut at = 0;
    while at < words.len() {
        if word(at) == "use" {
            let is_public = at > 0 && word(at - 1) == "pub";
            let end = (at..words.len()).find(|&end| word(end) == ";").unwrap_or(words.len());
            let taken = taken_apart(&words[at + 1..end]);
            declarations.extend(taken.into_iter().map(|(name, path)| (is_public, name, path)));
            at = end;
        } else if word(at + 1) == "::" && is_name(word(at)) && begins_path(&words[..at]) {
            let mut path = vec![word(at).to_string()];
            while word(at + 1) == "::" && is_name(word(at + 2)) {
                at += 2;
                path.push(word(at).to_string());
            }
            paths.push(path);
        }
        at += 1;
    }
    (declarations, paths)
}

/// Returns `true` if a path after these words begins there, and is not the scope of `pub(in ..)`.
fn begins_path(before: &[String]) -> bool {
    !before.ends_with(&["::".to_string()]) && !before.ends_with(&["pub", "(", "in"].map(str::to_string))
}

fn is_name(word: &str) -> bool {
    word.starts_with(|first: char| first.is_alphabetic() || first == '_')
}

/// The words of a code: names and numbers, `::`, and each other character; comments and string literals are left out.
fn words(text: &str) -> Vec<String> {
    let signs: Vec<char> = text.chars().collect();
    let sign = |at: usize| signs.get(at).copied().unwrap_or('\n');
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    let mut words: Vec<String> = Vec::new();
    let mut at = 0;
    while at < signs.len() {
        let start = at;
        at += 1;
        match signs[start] {
            '/' if sign(at) == '/' => at = (at..signs.len()).find(|&end| sign(end) == '\n').unwrap_or(signs.len()),
            '"' => {
                // A raw string ends at a quote followed by as many `#` as it began with.
                let hashes = (0..start).rev().take_while(|&before| sign(before) == '#').count();
                let is_raw = start > hashes && sign(start - hashes - 1) == 'r';
                while at < signs.len()
                    && !(sign(at) == '"' && (!is_raw || (1..=hashes).all(|after| sign(at + after) == '#')))
                {
                    at += if sign(at) == '\\' && !is_raw { 2 } else { 1 };
                }
                at += 1;
            }
            // A character literal; a lifetime has no closing quote.
            '\'' if sign(at) == '\\' => {
                at += 2;
                while sign(at) != '\'' {
                    at += 1;
                }
                at += 1;
            }
            '\'' if sign(at + 1) == '\'' => at += 2,
            ':' if sign(at) == ':' => {
                at += 1;
                words.push("::".to_string());
            }
            c if is_part(c) => {
                while is_part(sign(at)) {
                    at += 1;
                }
                words.push(signs[start..at].iter().collect());
            }
            c if c.is_whitespace() => {}
            c => words.push(c.to_string()),
        }
    }
    words
}

/// Splits `a::{b, c::d as e}` into `b` from `a::b` and `e` from `a::c::d`.
fn taken_apart(tree: &[String]) -> Vec<(String, Module)> {
    let Some(open) = tree.iter().position(|word| word == "{") else {
        let mut path: Module = tree.iter().filter(|word| *word != "::").cloned().collect();
        let renamed = path
            .iter()
            .position(|word| word == "as")
            .map(|at| path.split_off(at))
            .and_then(|mut as_name| as_name.pop());
        let own = path.last().cloned();
        return renamed.or(own).map(|name| (name, path)).into_iter().collect();
    };
    let prefix: Module = tree[..open].iter().filter(|word| *word != "::").cloned().collect();
    let (mut items, mut depth) = (vec![Vec::new()], 0);
    for word in &tree[open + 1..tree.len() - 1] {
        match word.as_str() {
            "," if depth == 0 => items.push(Vec::new()),
            _ => {
                depth += i32::from(word == "{") - i32::from(word == "}");
                items.last_mut().unwrap().push(word.clone());
            }
        }
    }
    let whole = |(name, rest): (String, Module)| {
        // `a::{self}` imports `a`.
        let name = if name == "self" { prefix.last().cloned().unwrap_or_default() } else { name };
        (name, [prefix.clone(), rest].concat())
    };
    items.iter().filter(|item| !item.is_empty()).flat_map(|item| taken_apart(item)).map(whole).collect()
}

/// The path as a user knows it, if it stays in these crates.
fn from_root(path: &Module, module: &Module, known: &BTreeSet<Module>, crates: &[OfCrate]) -> Option<Module> {
    let mut here = module.clone();
    let mut rest = path.as_slice();
    match rest.first().map(String::as_str) {
        Some("crate") => {
            // The modules of the mechanics and of the program have no name before theirs.
            let has_one = |of_crate: &OfCrate| module.first().is_some_and(|first| of_crate.2 == [first]);
            here.truncate(usize::from(crates.iter().any(has_one)));
            rest = &rest[1..];
        }
        Some(name) if crates.iter().any(|of_crate| of_crate.1 == name) => {
            let before = crates.iter().find(|of_crate| of_crate.1 == name).map_or(&[][..], |of_crate| of_crate.2);
            here = before.iter().map(|name| (*name).to_string()).collect();
            rest = &rest[1..];
        }
        Some("super") => {
            while rest.first().is_some_and(|name| name == "super") {
                here.pop();
                rest = &rest[1..];
            }
        }
        Some("self") => rest = &rest[1..],
        Some(name) if known.contains(&[module.as_slice(), &[name.to_string()]].concat()) => {}
        _ => return None,
    }
    let whole: Module = [here.as_slice(), rest].concat();
    Some(whole.into_iter().filter(|name| name != "self").collect())
}

#[test]
fn declarations_and_paths_are_read_and_comments_and_strings_are_not() {
    let (declarations, paths) = named(
        r#"
        use crate::a::{self, b::c as d}; // use crate::comment;
        pub(crate) use super::e;
        pub(in crate::scene) fn f<'a>(g: &'a super::h::I) -> char { crate::j::k("crate::text", '"'); '\'' }
        pub use l::M;
        "#,
    );
    let named_by = |path: &str| path.split("::").map(str::to_string).collect::<Module>();
    let expected =
        [(false, "a", "crate::a::self"), (false, "d", "crate::a::b::c"), (false, "e", "super::e"), (true, "M", "l::M")];
    assert_eq!(declarations, expected.map(|(is_public, name, path)| (is_public, name.to_string(), named_by(path))));
    assert_eq!(paths, ["super::h::I", "crate::j::k"].map(named_by));
}
