//! What the compiler does not hold: the order of the rooms inside a crate, and what stays in one room. The arrows
//! between crates are in their manifests.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::imports::{CRATES, House, rust_files};

/// The rooms of each wing, by the names before those of its rooms: a room names only rooms before it.
const WINGS: [(&[&str], &[&str]); 6] = [
    (
        &["qp"],
        &[
            "solution",
            "watch",
            "memory",
            "error",
            "file",
            "panics",
            "linear",
            "problem",
            "certificate",
            "transform",
            "method",
            "settings",
            "matrix_market",
            "petsc",
            "cost",
            "directory",
            "plan",
            "existence",
            "engine",
            "run",
            "prepared",
            "derivative",
            "modes",
        ],
    ),
    (
        &["lcp"],
        &[
            "answer",
            "error",
            "problem",
            "files",
            "scaled",
            "dense",
            "class",
            "basis",
            "certificate",
            "pivoting",
            "lemke",
            "quadratic",
            "run",
        ],
    ),
    (&[], &["error", "bytes", "fem", "motion", "continuum", "scene", "study"]),
    (
        &["fem"],
        &[
            "threads",
            "formulation",
            "geometry",
            "dense",
            "element",
            "surface",
            "material",
            "mesh",
            "mortar",
            "body",
            "assembly",
            "recovery",
            "norms",
        ],
    ),
    (&["scene"], &["input", "models", "motions", "answers", "derivatives", "modes"]),
    (&["output"], &["text", "json", "draw", "file", "plots", "view", "picture", "reports", "page", "folder"]),
];

/// What is no room of the mechanics, whose modules have no name before theirs: the other crates.
const BESIDE: [&str; 6] = ["qp", "lcp", "output", "lib", "main", "cli"];

#[test]
fn a_room_names_only_rooms_before_it() {
    let house = House::read();
    let mut arrows = BTreeSet::new();
    for (wing, rooms) in WINGS {
        // The name of a room of this wing; what is no room of it, such as another crate, has none.
        let room = |module: &[String]| -> Option<String> {
            let wing: Vec<String> = wing.iter().map(|name| (*name).to_string()).collect();
            let name = module.strip_prefix(wing.as_slice())?.first()?;
            (!wing.is_empty() || !BESIDE.contains(&name.as_str())).then(|| name.clone())
        };
        let place = |name: String| rooms.iter().position(|room| *room == name);
        for (module, source) in &house.files {
            let Some(name) = room(module) else { continue };
            let own = place(name).unwrap_or_else(|| panic!("{} is in no room of {wing:?}", source.path.display()));
            for other in house.taken_from(module) {
                let Some(other) = room(&other).and_then(place).filter(|other| *other != own) else { continue };
                assert!(other < own, "{} names `{}`", source.path.display(), rooms[other]);
                arrows.insert((wing, own, other));
            }
        }
        for name in rooms {
            let exists = house.files.keys().any(|module| room(module).as_deref() == Some(*name));
            assert!(exists, "the wing {wing:?} has no room `{name}`");
        }
    }
    // Too few pairs of rooms would mean that the imports are not parsed correctly.
    assert!(arrows.len() > 100, "{} arrows between rooms", arrows.len());
}

/// The table of a crate names its rooms in this order.
#[test]
fn the_code_map_of_architecture_lists_the_rooms_of_each_wing_in_order() {
    let architecture = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("ARCHITECTURE.md")).unwrap();
    for (wing, rooms) in WINGS {
        let named = |line: &&str| rooms.iter().all(|room| line.contains(&format!("`{room}`")));
        let row = architecture.lines().find(named).unwrap_or_else(|| panic!("no line has all rooms of {wing:?}"));
        let said: Vec<&str> = row.split('`').skip(1).step_by(2).filter(|name| rooms.contains(name)).collect();
        assert_eq!(said, rooms, "{wing:?}");
    }
}

#[test]
fn no_two_files_import_each_other() {
    let circles = House::read().circles();
    assert!(circles.is_empty(), "these files are in circular imports: {circles:#?}");
}

#[test]
fn bodies_do_not_name_contact_problems() {
    for (module, source) in
        House::read().files.into_iter().filter(|(module, _)| module.first().is_some_and(|name| name == "fem"))
    {
        for word in ["ContactProblem", "ContactSet", "Solution"] {
            let code = source.text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<String>();
            assert!(!code.contains(word), "{module:?} names `{word}`");
        }
    }
}

#[test]
fn only_the_ending_of_a_run_constructs_the_error_of_an_answer_that_is_not_certified() {
    let name = "Error::NotCertified {";
    let constructs = |text: &str| {
        // A pattern omits fields by `..`; a construction names all fields.
        text.match_indices(name).any(|(at, _)| !text[at..].split('}').next().unwrap().contains(".."))
    };
    let files = House::read().files.into_values().filter(|source| constructs(&source.text));
    assert_eq!(
        files.map(|source| source.path).collect::<Vec<_>>(),
        [Path::new("lcp/run.rs"), Path::new("qp/run/ending.rs")]
    );
}

/// Fallbacks stand in the plan alone: the history compares answers, and existence alone says that there is no answer.
#[test]
fn only_the_history_compares_answers_and_only_existence_makes_claims() {
    let files_with = |words: &[&str]| -> BTreeSet<PathBuf> {
        let files = House::read().files.into_values();
        let has = |text: &str| words.iter().any(|word| text.contains(word));
        files
            .filter(|source| {
                source.path.starts_with("qp") && !source.path.starts_with("qp/solution") && has(&source.text)
            })
            .map(|source| source.path)
            .collect()
    };
    assert_eq!(files_with(&[".gains_on(", ".improves_on("]), BTreeSet::from(["qp/plan/history.rs".into()]));
    assert_eq!(files_with(&["Err(Error::Unbounded", "Err(Error::UnderHeld"]), ["qp/existence/mod.rs".into()].into());
    // A step takes the settings that it is given.
    let house = House::read();
    let steps = house
        .files
        .values()
        .filter(|source| ["qp/engine", "qp/method", "qp/transform"].iter().any(|room| source.path.starts_with(room)));
    for source in steps {
        for word in ["Settings { method", "Settings { precision", "Settings { condense", "engine_of(", "Ladder"] {
            assert!(!source.text.contains(word), "{}: {word}", source.path.display());
        }
    }
}

fn sources() -> Vec<(PathBuf, String)> {
    House::read().files.into_values().map(|source| (source.path, source.text)).collect()
}

#[test]
fn libraries_stay_in_their_rooms() {
    let rules: [(&str, &[&str]); 10] = [
        // The settings of this library apply to the whole process.
        ("set_infinity", &[]),
        ("catch_unwind", &["qp/panics.rs"]),
        ("clarabel::", &["qp/method/interior_point.rs"]),
        (
            "faer::",
            &[
                "qp/linear/cholesky.rs",
                "qp/linear/dense_factor.rs",
                "qp/linear/eigen",
                "qp/linear/factor.rs",
                "qp/linear/of_faer.rs",
                "qp/linear/ordering.rs",
                "qp/linear/selected_inverse.rs",
            ],
        ),
        ("rayon::", &["qp/linear/threads.rs", "fem/threads.rs"]),
        // The results of a thread that panicked would be lost without a word.
        ("join().ok()", &[]),
        ("nalgebra::", &[]),
        ("nalgebra_sparse::", &["qp/linear/of_nalgebra.rs"]),
        ("feral_metis::", &["qp/linear/ordering.rs"]),
        ("println!", &["cli", "main.rs"]),
    ];
    for (file, text) in sources() {
        let code: String = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
        for (library, rooms) in rules {
            let allowed = rooms.iter().any(|room| file.starts_with(Path::new(room)));
            assert!(allowed || !code.contains(library), "{} names {library}", file.display());
        }
    }
}

#[test]
fn methods_use_no_word_of_mechanics_and_do_not_call_each_other() {
    let words = ["mesh", "element", "node", "stress", "young", "poisson", "obstacle"];
    for (file, text) in sources().into_iter().filter(|source| source.0.starts_with("qp/method")) {
        let code: String = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
        for word in words {
            assert!(!code.to_lowercase().contains(word), "{} says `{word}`", file.display());
        }
        for (method, other) in [("active_set", "penalty"), ("penalty", "active_set"), ("interior_point", "active_set")]
        {
            let calls = code.contains(&format!("{other}::"));
            assert!(!file.ends_with(format!("{method}.rs")) || !calls, "{} calls {other}", file.display());
        }
    }
}

/// A function ends at the first line that is as far to the right as its first line and ends with a bracket or, if it is
/// only declared, with a semicolon.
#[test]
fn no_function_has_more_than_90_lines() {
    let mut functions = 0;
    for file in CRATES.iter().flat_map(|of_crate| rust_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join(of_crate.0))) {
        let text = fs::read_to_string(&file).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let indent = |line: &str| line.len() - line.trim_start().len();
        for (first, line) in lines.iter().enumerate() {
            let is_function = line.split('(').next().unwrap().split_whitespace().any(|word| word == "fn");
            if line.trim_start().starts_with("//") || !is_function {
                continue;
            }
            let is_end = |other: &&&str| indent(other) == indent(line) && other.ends_with(['}', ';']);
            let length = lines[first..].iter().take_while(|other| !is_end(other)).count() + 1;
            assert!(length <= 90, "{}:{}: {length} lines", file.display(), first + 1);
            functions += 1;
        }
    }
    assert!(functions > 3000, "{functions} functions");
}

#[test]
fn no_source_file_has_more_than_600_lines() {
    for (file, text) in sources() {
        let lines = text.lines().count();
        assert!(lines <= 600, "{} has {lines} lines: split it", file.display());
    }
}

/// Each binary is linked separately, with all dependencies: many binaries would take longer than the tests in them.
#[test]
fn tests_are_modules_of_at_most_eight_binaries() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let entries: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    let groups: Vec<&PathBuf> = entries.iter().filter(|path| path.join("main.rs").exists()).collect();
    assert!(groups.len() <= 8, "{groups:?}");
    for path in &entries {
        assert!(
            path.extension().is_none_or(|extension| extension != "rs"),
            "{} is not in a folder of tests",
            path.display()
        );
    }
    for group in groups {
        let main = fs::read_to_string(group.join("main.rs")).unwrap();
        for entry in fs::read_dir(group).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_stem().unwrap().to_str().unwrap();
            let is_named = name == "main" || main.contains(&format!("\nmod {name};"));
            assert!(is_named, "{} is not compiled into any binary", path.display());
        }
    }
}
