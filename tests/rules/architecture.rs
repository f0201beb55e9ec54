//! What the compiler and clippy do not hold: the order of the modules inside a crate, and what stays in one file. The
//! arrows between crates are in their manifests.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::PathBuf;

use crate::sources::{Module, Sources, circles, crates, files_below, root};

/// The lists of modules in the table of ARCHITECTURE.md, in order, each by the module that holds them.
fn listed() -> Vec<(Module, Vec<String>)> {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let table = text.lines().skip_while(|line| !line.starts_with("| crate or wing |")).skip(2);
    let words = |cell: &str| cell.split('`').skip(1).step_by(2).map(str::to_string).collect::<Vec<_>>();
    let mut lists: Vec<(Module, Vec<String>)> = Vec::new();
    for row in table.take_while(|line| line.starts_with('|')) {
        let cells: Vec<&str> = row.split('|').collect();
        let name = words(cells[1]).swap_remove(0);
        let holder = match crates().into_iter().find(|(_, folder)| folder.starts_with(root().join(&name))) {
            Some((of_crate, _)) => vec![of_crate],
            None => vec![lists.last().unwrap().0[0].clone(), name],
        };
        lists.push((holder, words(cells[3])));
    }
    lists
}

#[test]
fn a_module_names_only_modules_before_it_in_the_list_of_architecture() {
    let (sources, lists) = (Sources::of(&crates()), listed());
    let unlisted = crates().into_iter().find(|(name, _)| !lists.iter().any(|(holder, _)| *holder == [name.clone()]));
    assert_eq!(unlisted, None, "ARCHITECTURE.md does not list the modules of a crate");
    let (mut arrows, mut seen) = (BTreeSet::new(), BTreeSet::new());
    for (module, source) in &sources.files {
        for (holder, list) in &lists {
            let place = |module: &Module| {
                let name = module.strip_prefix(holder.as_slice())?.first()?;
                let place = list.iter().position(|listed| listed == name);
                Some(place.unwrap_or_else(|| panic!("ARCHITECTURE.md does not list `{name}` of {holder:?}")))
            };
            let Some(own) = place(module) else { continue };
            seen.insert((holder, own));
            for other in sources.taken_from(module).iter().filter_map(place) {
                assert!(other <= own, "{} names `{}`", source.path.display(), list[other]);
                arrows.insert((holder, own, other));
            }
        }
    }
    assert_eq!(
        seen.len(),
        lists.iter().map(|(_, list)| list.len()).sum::<usize>(),
        "ARCHITECTURE.md lists what does not exist"
    );
    // Too few would mean that the imports are not read correctly.
    assert!(arrows.len() > 150, "{} arrows between modules", arrows.len());
}

#[test]
fn no_two_files_import_each_other() {
    let folders = fs::read_dir(root().join("tests")).unwrap().map(|entry| entry.unwrap().path());
    let programs = folders.filter(|path| ["main.rs", "lib.rs"].iter().any(|root| path.join(root).exists()));
    let programs = programs.chain(["python/src", "studies"].map(|folder| root().join(folder)));
    let mut files = 0;
    for group in programs.map(|folder| vec![("program".to_string(), folder)]).chain([crates()]) {
        let sources = Sources::of(&group);
        let circles = sources.circles();
        assert!(circles.is_empty(), "these files are in circular imports: {circles:#?}");
        files += sources.files.len();
    }
    assert!(files > 700, "{files} files");
}

#[test]
fn no_two_python_files_import_each_other() {
    let mut arrows = 0;
    for folder in
        ["python/package/signorini", "python/tests", "python/examples", "reference", "distributed", "distributed/tests"]
    {
        let of_folder = |path: &PathBuf| path.parent() == Some(&root().join(folder));
        let files = [".py", ".pyi"].iter().flat_map(|ending| files_below(folder, ending)).filter(of_folder);
        let files: Vec<(String, String)> = files
            .map(|path| (path.file_stem().unwrap().to_str().unwrap().to_string(), fs::read_to_string(path).unwrap()))
            .collect();
        let mut taken: BTreeMap<Module, BTreeSet<Module>> = BTreeMap::new();
        // A package imports its own modules by its name, or as names of it.
        let package = if folder.ends_with("signorini") { "signorini." } else { "" };
        for (name, text) in &files {
            let imports = |line: &str, other: &str| match line.trim().split_once("import ") {
                Some(("", names)) => names.split(',').any(|name| name.trim().strip_prefix(package) == Some(other)),
                Some((from, names)) => {
                    let from = from.trim_start_matches("from ").trim();
                    from.strip_prefix(package).or(from.strip_prefix('.')) == Some(other)
                        || package.strip_suffix('.') == Some(from) && names == other
                }
                None => false,
            };
            let others = files.iter().filter(|(other, _)| text.lines().any(|line| imports(line, other)));
            let others: Vec<Module> = others.map(|(other, _)| vec![other.clone()]).collect();
            arrows += others.len();
            taken.entry(vec![name.clone()]).or_default().extend(others);
        }
        let circles = circles(&taken);
        assert!(circles.is_empty(), "{folder} has circular imports: {circles:#?}");
    }
    assert!(arrows > 40, "{arrows} arrows");
}

/// Other crates, each with the files that may name it.
const FOREIGN: [(&str, &[&str]); 6] = [
    ("clarabel", &["crates/qp/src/method/interior_point.rs"]),
    (
        "faer",
        &[
            "crates/linear/src/cholesky.rs",
            "crates/linear/src/eigen.rs",
            "crates/linear/src/factor.rs",
            "crates/linear/src/foreign.rs",
            "crates/linear/src/ordering.rs",
            "crates/linear/src/selected_inverse.rs",
        ],
    ),
    ("feral_metis", &["crates/linear/src/ordering.rs"]),
    ("nalgebra", &[]),
    ("nalgebra_sparse", &["crates/linear/src/foreign.rs"]),
    ("rayon", &["crates/linear/src/threads.rs", "crates/fem/src/threads.rs"]),
];

#[test]
fn libraries_stay_in_their_files() {
    let sources = Sources::of(&crates());
    for (library, allowed) in FOREIGN {
        let named = sources.files.values().filter(|source| source.foreign.contains(library));
        let named: Vec<_> = named.map(|source| &source.path).collect();
        let wrong = named.iter().find(|path| !allowed.iter().any(|allowed| path.starts_with(allowed)));
        assert!(wrong.is_none(), "{wrong:?} names {library}");
        let unused = allowed.iter().find(|allowed| !named.iter().any(|path| path.starts_with(allowed)));
        assert!(unused.is_none(), "{unused:?} does not name {library}");
    }
}

#[test]
fn only_the_ending_of_a_run_constructs_the_error_of_an_answer_that_is_not_certified() {
    let files = Sources::of(&crates()).files.into_values();
    let files = files.filter(|source| source.constructs.iter().any(|path| path.ends_with("NotCertified")));
    let files: Vec<_> = files.map(|source| source.path).collect();
    assert_eq!(files, ["crates/lcp/src/run.rs", "crates/qp/src/run/ending.rs"].map(PathBuf::from));
}

/// Words of code, the folders or files where they must not stand, and the exceptions there. A word in small letters
/// counts in any letters.
const WORDS: [(&[&str], &[&str], &[&str]); 8] = [
    // Bodies do not know contact problems.
    (&["ContactProblem", "ContactSet", "Solution"], &["crates/fem/src"], &[]),
    // Methods speak no mechanics, and do not call each other.
    (&["mesh", "element", "node", "stress", "young", "poisson", "obstacle"], &["crates/qp/src/method"], &[]),
    (&["active_set::"], &["crates/qp/src/method/penalty.rs", "crates/qp/src/method/interior_point.rs"], &[]),
    (&["penalty::"], &["crates/qp/src/method/active_set.rs"], &[]),
    // Fallbacks stand in the plan alone: the history compares answers, existence says that there is none, and a step
    // takes the settings that it is given.
    (&[".gains_on(", ".improves_on("], &["crates/qp"], &["crates/qp/src/plan/history.rs", "crates/qp/src/solution"]),
    (&["Err(Error::Unbounded", "Err(Error::UnderHeld"], &["crates/qp"], &["crates/qp/src/existence/mod.rs"]),
    (
        &["Settings { method", "Settings { precision", "Settings { condense", "engine_of(", "Ladder"],
        &["crates/qp/src/engine", "crates/qp/src/method", "crates/qp/src/transform"],
        &[],
    ),
    // The results of a thread that panicked would be lost without a word.
    (&["join().ok()"], &["crates", "src"], &[]),
];

#[test]
fn words_stay_in_their_files() {
    let sources = Sources::of(&crates());
    for (words, folders, except) in WORDS {
        let below =
            |source: &&crate::sources::Source, folders: &[&str]| folders.iter().any(|at| source.path.starts_with(at));
        let checked: Vec<_> = sources.files.values().filter(|source| below(source, folders)).collect();
        assert!(!checked.is_empty(), "there is no file in {folders:?}");
        for source in checked.iter().filter(|source| !below(source, except)) {
            let small = source.code.to_lowercase();
            let word = words.iter().find(|word| source.code.contains(**word) || small.contains(**word));
            assert!(word.is_none(), "{} says {word:?}", source.path.display());
        }
    }
}

/// Lines of code, formulas and tables in a comment may be longer: they have no place to break.
#[test]
fn source_files_have_at_most_600_lines_and_lines_of_comments_120_letters() {
    let folders = ["crates", "src", "tests", "studies", "python", "examples"];
    for path in folders.iter().flat_map(|folder| files_below(folder, ".rs")) {
        let text = fs::read_to_string(&path).unwrap();
        let most = if crates().iter().any(|(_, folder)| path.starts_with(folder)) { 600 } else { usize::MAX };
        assert!(text.lines().count() <= most, "{} has more than {most} lines: split it", path.display());
        let mut is_code = false;
        for (number, line) in text.lines().enumerate() {
            let comment = line.trim_start().strip_prefix("//").map(|rest| rest.trim_start_matches(['/', '!']).trim());
            is_code = comment.is_some_and(|comment| is_code ^ comment.starts_with("```"));
            let is_free = is_code || comment.is_none_or(|comment| comment.starts_with('|'));
            assert!(is_free || line.chars().count() <= 120, "{}:{} is longer", path.display(), number + 1);
        }
    }
}

/// Each binary is linked separately, with all dependencies: many binaries would take longer than the tests in them.
#[test]
fn tests_are_modules_of_at_most_eight_binaries() {
    let entries: Vec<PathBuf> =
        fs::read_dir(root().join("tests")).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert!(entries.iter().filter(|path| path.join("main.rs").exists()).count() <= 8);
    let alone = entries.iter().find(|path| path.extension().is_some_and(|extension| extension == "rs"));
    assert!(alone.is_none(), "{alone:?} is not in a folder of tests");
}

#[test]
fn every_crate_forbids_unsafe_code_and_prints_and_begins_with_an_example() {
    for (name, folder) in crates() {
        let text = fs::read_to_string(folder.join("lib.rs")).unwrap();
        let lints = "\n#![forbid(unsafe_code)]\n#![deny(missing_docs, clippy::print_stdout, clippy::print_stderr)]\n";
        assert!(text.contains(lints), "{name}");
        let mut page = text.lines().take_while(|line| line.starts_with("//!"));
        assert!(page.any(|line| line.starts_with("//! ```")), "{name}");
    }
}
