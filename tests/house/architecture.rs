//! The order of the modules: a module names only modules of lower floors.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use crate::imports::House;

/// The rooms of each floor, from the lowest up. `qp` alone is the public part of the rooms in it. `lib` only re-exports
/// and `main` only calls; they are on no floor.
const FLOORS: [&[&str]; 18] = [
    &["solution", "watch", "memory"],
    &["error"],
    &["file", "qp/panics", "fem/formulation", "fem/geometry"],
    &["qp/linear", "fem/element", "fem/material", "fem/surface"],
    &["qp/problem", "fem/mesh"],
    &["qp/certificate", "qp/transform", "qp/method", "fem/body"],
    &["qp/settings", "qp/matrix_market", "qp/petsc", "fem/assembly", "fem/recovery", "fem/norms"],
    &["qp/cost", "qp/directory"],
    &["qp/plan", "qp/existence"],
    &["qp/engine"],
    &["qp/run"],
    &["qp/prepared"],
    &["qp"],
    &["motion", "continuum"],
    &["scene"],
    &["study"],
    &["output"],
    &["cli"],
];

fn floor(room: &str) -> usize {
    let found = FLOORS.iter().position(|rooms| rooms.contains(&room));
    found.unwrap_or_else(|| panic!("`{room}` is not a room of the house"))
}

/// The room of a module: a folder or file of `qp` or `fem`, or of `src/`.
fn room(module: &[String]) -> Option<String> {
    match module {
        [] => None,
        [name] if name == "lib" || name == "main" || name == "fem" => None,
        [wing, name, ..] if wing == "qp" || wing == "fem" => Some(format!("{wing}/{name}")),
        [name, ..] => Some(name.clone()),
    }
}

fn sources() -> Vec<(String, PathBuf, String)> {
    let of_file = |(module, source): (Vec<String>, crate::imports::Source)| {
        (room(&module).unwrap_or_default(), source.path, source.text)
    };
    House::read().files.into_iter().map(of_file).collect()
}

#[test]
fn a_module_names_only_modules_of_lower_floors() {
    let house = House::read();
    let mut arrows = BTreeSet::new();
    for (module, source) in &house.files {
        let Some(own) = room(module) else { continue };
        for other in house.taken_from(module) {
            let Some(other) = room(&other).filter(|other| *other != own) else { continue };
            let file = source.path.display();
            assert!(floor(&other) < floor(&own), "{file} (floor {}) names `{other}` ({})", floor(&own), floor(&other));
            arrows.insert((own.clone(), other));
        }
    }
    // Too few pairs of rooms would mean that the imports are not parsed correctly.
    assert!(arrows.len() > 60, "{} arrows between rooms", arrows.len());
}

/// The rooms of a floor with many files, in the order in which data flow through them.
const WINGS: [(&str, &[&str]); 2] = [
    ("scene", &["input", "models", "motions", "answers"]),
    ("output", &["text", "json", "draw", "file", "plots", "view", "picture", "reports", "page", "folder"]),
];

#[test]
fn a_room_of_a_wing_names_only_rooms_before_it() {
    let house = House::read();
    for (wing, rooms) in WINGS {
        let place = |module: &[String]| match module {
            [first, inner, ..] if first == wing => rooms.iter().position(|room| room == inner),
            _ => None,
        };
        for (module, source) in house.files.iter().filter(|(module, _)| module.len() > 1 && module[0] == wing) {
            let own = place(module).unwrap_or_else(|| panic!("{} is in no room", source.path.display()));
            for other in house.taken_from(module).iter().filter(|other| other[0] == wing) {
                let is_before = place(other).is_some_and(|other| other <= own);
                assert!(is_before, "{} names `{}`", source.path.display(), other.join("::"));
            }
        }
        let architecture = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("ARCHITECTURE.md")).unwrap();
        let row = architecture.lines().find(|line| line.contains(&format!("| `{wing}` |"))).unwrap();
        let said: Vec<&str> = row.split('`').skip(3).step_by(2).filter(|name| rooms.contains(name)).collect();
        assert_eq!(said, rooms, "ARCHITECTURE.md");
    }
}

#[test]
fn no_two_files_import_each_other() {
    let house = House::read();
    let taken: BTreeMap<_, _> = house.files.keys().map(|module| (module, house.taken_from(module))).collect();
    let mut circles = BTreeSet::new();
    for start in house.files.keys() {
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
    assert!(circles.is_empty(), "these files are in circular imports: {circles:#?}");
}

#[test]
fn bodies_do_not_name_contact_problems() {
    let house = House::read();
    for module in house.files.keys().filter(|module| module.first().is_some_and(|name| name == "fem")) {
        for other in house.taken_from(module).iter().filter_map(|other| room(other)) {
            let allowed =
                other.starts_with("fem/") || ["qp/linear", "error", "file", "solution"].contains(&other.as_str());
            assert!(allowed, "{module:?} names `{other}`");
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
    assert_eq!(files.map(|source| source.path).collect::<Vec<_>>(), [Path::new("qp/run/ending.rs")]);
}

/// Fallbacks stand in the plan alone: the history compares answers, and existence alone says that there is no answer.
#[test]
fn only_the_history_compares_answers_and_only_existence_makes_claims() {
    let files_with = |words: &[&str]| -> BTreeSet<PathBuf> {
        let files = House::read().files.into_values();
        let has = |text: &str| words.iter().any(|word| text.contains(word));
        files.filter(|source| source.path.starts_with("qp") && has(&source.text)).map(|source| source.path).collect()
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

#[test]
fn every_room_of_the_house_exists() {
    let rooms: BTreeSet<String> = sources().into_iter().map(|(room, _, _)| room).collect();
    for room in FLOORS.concat() {
        assert!(rooms.contains(room), "the house has a room `{room}` that src/ does not have");
    }
}

#[test]
fn the_code_map_of_architecture_lists_every_room_on_its_floor() {
    let architecture = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("ARCHITECTURE.md")).unwrap();
    for (number, rooms) in FLOORS.iter().enumerate() {
        for room in *rooms {
            let start = format!("| {number} |");
            let mut lines = architecture.lines().filter(|line| line.starts_with(&start));
            assert!(lines.any(|line| line.contains(&format!("`{room}`"))), "ARCHITECTURE.md: {room}");
        }
    }
}

#[test]
fn libraries_stay_in_their_rooms() {
    let rules: [(&str, &[&str]); 16] = [
        // The settings of this library apply to the whole process.
        ("set_infinity", &[]),
        ("ctrlc::", &["cli"]),
        ("signal_hook::", &["cli"]),
        ("catch_unwind", &["qp/panics.rs"]),
        ("clarabel::", &["qp/method/interior_point.rs"]),
        (
            "faer::",
            &[
                "qp/linear/cholesky.rs",
                "qp/linear/factor.rs",
                "qp/linear/of_faer.rs",
                "qp/linear/ordering.rs",
                "qp/linear/selected_inverse.rs",
            ],
        ),
        ("rayon::", &["qp/linear/threads.rs"]),
        // The results of a thread that panicked would be lost without a word.
        ("join().ok()", &[]),
        ("nalgebra_sparse::", &["qp/linear/of_nalgebra.rs"]),
        ("feral_metis::", &["qp/linear/ordering.rs"]),
        ("clap::", &["cli"]),
        ("clap_complete::", &["cli"]),
        ("clap_mangen::", &["cli"]),
        ("strsim::", &["error.rs"]),
        ("tiny_skia::", &["output"]),
        ("println!", &["cli", "main.rs"]),
    ];
    for (_, file, text) in sources() {
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
    for (room, file, text) in sources().into_iter().filter(|source| source.0 == "qp/method") {
        let code: String = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
        for word in words {
            assert!(!code.to_lowercase().contains(word), "{} of `{room}` says `{word}`", file.display());
        }
        for (method, other) in [("active_set", "penalty"), ("penalty", "active_set"), ("interior_point", "active_set")]
        {
            let calls = code.contains(&format!("{other}::"));
            assert!(!file.ends_with(format!("{method}.rs")) || !calls, "{} calls {other}", file.display());
        }
    }
}

#[test]
fn no_source_file_has_more_than_600_lines() {
    for (_, file, text) in sources() {
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
