//! Which file of `src/` takes names from which: its `use` declarations, followed through re-exports to the file that defines
//! the name.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// A module by its names from the crate root; `[]` is the crate itself.
type Module = Vec<String>;

/// A source file, and what its `use` declarations say.
pub struct Source {
    /// Its path below `src/`.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// The paths that it imports, from the crate root.
    imports: Vec<Module>,
    /// The names that it exports under its own path, and where they come from.
    pub exports: BTreeMap<String, Module>,
}

/// All files of `src/` by their modules.
pub struct House {
    pub files: BTreeMap<Module, Source>,
}

impl House {
    /// Reads `src/`.
    pub fn read() -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        let mut texts = BTreeMap::new();
        let mut folders = vec![root.clone()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else if path.extension().is_some_and(|extension| extension == "rs") {
                    let inside = path.strip_prefix(&root).unwrap().to_path_buf();
                    texts.insert(module_of(&inside), (inside, fs::read_to_string(&path).unwrap()));
                }
            }
        }
        let known: BTreeSet<Module> = texts.keys().cloned().collect();
        let read = |(module, (path, text)): (Module, (PathBuf, String))| {
            let (mut imports, mut exports) = (Vec::new(), BTreeMap::new());
            for (is_public, import) in declarations(&text)
                .into_iter()
                .filter_map(|(is_public, tree)| from_root(&tree, &module, &known).map(|import| (is_public, import)))
            {
                match (is_public, import.last()) {
                    (true, Some(name)) => drop(exports.insert(name.clone(), import)),
                    _ => imports.push(import),
                }
            }
            (module, Source { path, text, imports, exports })
        };
        House { files: texts.into_iter().map(read).collect() }
    }

    /// The modules that `module` takes names from, itself left out.
    pub fn taken_from(&self, module: &Module) -> BTreeSet<Module> {
        let source = &self.files[module];
        let mut found: BTreeSet<Module> = source.imports.iter().map(|import| self.defining(import, 0)).collect();
        found.remove(module);
        found
    }

    /// The file that defines what a path names.
    fn defining(&self, path: &[String], followed: usize) -> Module {
        let mut length = path.len();
        while !self.files.contains_key(&path[..length]) {
            length -= 1;
        }
        let (module, rest) = (path[..length].to_vec(), &path[length..]);
        let origin = rest.first().and_then(|name| self.files[&module].exports.get(name));
        match origin {
            Some(origin) if origin != path && followed < 9 => {
                self.defining(&[origin.as_slice(), &rest[1..]].concat(), followed + 1)
            }
            _ => module,
        }
    }
}

fn module_of(path: &Path) -> Module {
    let mut names: Module =
        path.with_extension("").components().map(|part| part.as_os_str().to_str().unwrap().to_string()).collect();
    if names.last().is_some_and(|name| name == "mod") || names == ["lib"] {
        names.pop();
    }
    names
}

/// Every imported path with its visibility, braces taken apart; comments and unit tests left out.
fn declarations(text: &str) -> Vec<(bool, Module)> {
    let code: String =
        text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n");
    let code = code.split("#[cfg(test)]\nmod").next().unwrap_or_default().to_string();
    let mut found = Vec::new();
    for statement in code.split(';') {
        let line = statement.rfind("\nuse ").or_else(|| statement.rfind("\npub use ")).or_else(|| {
            let start = statement.trim_start();
            (start.starts_with("use ") || start.starts_with("pub use ")).then(|| statement.len() - start.len())
        });
        let Some(start) = line else { continue };
        let declaration = statement[start..].trim();
        let is_public = declaration.starts_with("pub ");
        let tree = declaration.trim_start_matches("pub ").trim_start_matches("use ");
        found.extend(taken_apart(tree).into_iter().map(|path| (is_public, path)));
    }
    found
}

/// `a::{b, c::d}` as `a::b` and `a::c::d`.
fn taken_apart(tree: &str) -> Vec<Module> {
    let tree = tree.trim();
    let Some((before, inside)) = tree.split_once('{') else {
        let path = tree.split(" as ").next().unwrap_or_default();
        return vec![path.split("::").map(|name| name.trim().to_string()).filter(|name| !name.is_empty()).collect()];
    };
    let prefix: Module =
        before.split("::").map(|name| name.trim().to_string()).filter(|name| !name.is_empty()).collect();
    let (mut items, mut depth, mut item) = (Vec::new(), 0, String::new());
    for character in inside.trim_end().trim_end_matches('}').chars() {
        match character {
            ',' if depth == 0 => items.push(std::mem::take(&mut item)),
            _ => {
                depth += i32::from(character == '{') - i32::from(character == '}');
                item.push(character);
            }
        }
    }
    items.push(item);
    let items = items.iter().filter(|item| !item.trim().is_empty());
    items.flat_map(|item| taken_apart(item)).map(|rest| [prefix.clone(), rest].concat()).collect()
}

/// The path from the crate root, if it stays in the crate.
fn from_root(path: &Module, module: &Module, known: &BTreeSet<Module>) -> Option<Module> {
    let mut here = module.clone();
    let mut rest = path.as_slice();
    match rest.first().map(String::as_str) {
        Some("crate") => {
            here.clear();
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
