//! No circles of imports outside the published crates: in the Python package, in its crate, and in programs and tests.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use crate::imports::{House, Module, circles};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The folders below `folder`.
fn folders(folder: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(root().join(folder)).unwrap();
    entries.map(|entry| entry.unwrap().path()).filter(|path| path.is_dir()).collect()
}

#[test]
fn no_two_rust_files_of_python_studies_or_tests_import_each_other() {
    let roots = |path: &PathBuf| path.join("main.rs").exists() || path.join("lib.rs").exists();
    let programs = folders("tests").into_iter().filter(roots);
    let (mut found, mut files, mut arrows) = (BTreeMap::new(), 0, 0);
    for folder in programs.chain(["python/src", "studies"].map(|folder| root().join(folder))) {
        let house = House::of_folder(&folder);
        files += house.files.len();
        arrows += house.files.keys().map(|module| house.taken_from(module).len()).sum::<usize>();
        found.insert(folder, house.circles());
    }
    found.retain(|_, circles: &mut BTreeSet<String>| !circles.is_empty());
    assert!(found.is_empty(), "these folders have circular imports: {found:#?}");
    // Too few would mean that the imports are not parsed correctly.
    assert!(files > 200 && arrows > 100, "{arrows} arrows between {files} files");
}

/// The modules that the imports of a Python file name, each with the names that it takes from them.
fn python_imports(text: &str) -> Vec<(String, Vec<String>)> {
    // An import in parentheses goes over several lines.
    let mut lines: Vec<String> = Vec::new();
    let mut is_open = false;
    for line in text.lines().map(|line| line.split('#').next().unwrap().trim()) {
        match lines.last_mut().filter(|_| is_open) {
            Some(last) => *last += &format!(" {line}"),
            None => lines.push(line.to_string()),
        }
        is_open =
            lines.last().is_some_and(|line| line.starts_with("from ") && line.contains('(') && !line.contains(')'));
    }
    let names = |list: &str| -> Vec<String> {
        let each = list.trim_matches(['(', ')', ' ']).split(',').filter_map(|name| name.split_whitespace().next());
        each.map(str::to_string).collect()
    };
    let read = |line: &String| match line.split_once("import ") {
        Some(("", modules)) => names(modules).into_iter().map(|module| (module, Vec::new())).collect(),
        Some((from, list)) => match from.strip_prefix("from ") {
            Some(module) => vec![(module.trim().to_string(), names(list))],
            None => Vec::new(),
        },
        None => Vec::new(),
    };
    lines.iter().flat_map(read).collect()
}

/// The files of a folder of Python, each with the files of the folder that it imports; `package` names the folder.
fn python_files(folder: &Path, package: &str) -> BTreeMap<Module, BTreeSet<Module>> {
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_python = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "py" || extension == "pyi");
    let texts: BTreeMap<String, String> = paths
        .filter(is_python)
        .map(|path| (path.file_stem().unwrap().to_str().unwrap().to_string(), fs::read_to_string(path).unwrap()))
        .collect();
    let taken = |text: &str| {
        let mut taken = BTreeSet::new();
        for (module, names) in python_imports(text) {
            // The package has a module for another package of the same name, such as jax.
            let inside = match module.strip_prefix(package) {
                Some(inside) => inside,
                None if module.starts_with('.') => &module,
                None => continue,
            };
            let inside = inside.trim_start_matches('.').split('.').next().unwrap();
            // What the package itself gives is one of its files, or stands in `__init__`.
            let own = names.iter().map(|name| if texts.contains_key(name) { name } else { "__init__" });
            let named: Vec<&str> = if inside.is_empty() { own.collect() } else { vec![inside] };
            taken.extend(named.into_iter().filter(|name| texts.contains_key(*name)).map(|name| vec![name.to_string()]));
        }
        taken
    };
    texts.iter().map(|(name, text)| (vec![name.clone()], taken(text))).collect()
}

#[test]
fn no_two_python_files_import_each_other() {
    let (mut found, mut arrows) = (BTreeMap::new(), 0);
    for (folder, package) in [
        ("python/package/signorini", "signorini"),
        ("python/tests", ""),
        ("python/examples", ""),
        ("reference", ""),
        ("distributed", ""),
        ("distributed/tests", ""),
    ] {
        let taken = python_files(&root().join(folder), package);
        arrows += taken.values().map(BTreeSet::len).sum::<usize>();
        found.insert(folder, circles(&taken));
    }
    found.retain(|_, circles| !circles.is_empty());
    assert!(found.is_empty(), "these folders have circular imports: {found:#?}");
    assert!(arrows > 40, "{arrows} arrows");
}

#[test]
fn imports_of_python_are_read_over_several_lines_and_a_circle_is_found() {
    let text = "import a, b as c  # import d\nfrom p import (\n    e as f,\n    g,\n)\n    from .h import i\n";
    let expected: [(&str, &[&str]); 4] = [("a", &[]), ("b", &[]), ("p", &["e", "g"]), (".h", &["i"])];
    let owned = |names: &[&str]| names.iter().map(|name| (*name).to_string()).collect::<Vec<_>>();
    assert_eq!(python_imports(text), expected.map(|(module, names)| (module.to_string(), owned(names))));
    let arrows = [("a", vec!["b"]), ("b", vec!["c"]), ("c", vec!["b"])];
    let taken = arrows.map(|(name, others)| (owned(&[name]), others.iter().map(|other| owned(&[other])).collect()));
    assert_eq!(circles(&taken.into()), ["b <- c", "c <- b"].map(str::to_string).into());
}
