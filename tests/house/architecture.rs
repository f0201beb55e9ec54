//! The house of the modules: a module names only modules of lower floors.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The rooms of each floor, from the ground up. `lib` re-exports and `main` calls: they stand on the roof.
const FLOORS: [&[&str]; 12] = [
    &["analytical", "barrier", "memory", "solution", "watch"],
    &["error"],
    &["file", "sparse", "element", "formulation"],
    &["mesh", "material"],
    &["problem", "body"],
    &["transform", "method", "assembly", "recovery", "norm"],
    &["solve"],
    &["dynamic"],
    &["scene", "matrix_market"],
    &["study"],
    &["output"],
    &["cli"],
];

fn floor(room: &str) -> Option<usize> {
    FLOORS.iter().position(|rooms| rooms.contains(&room))
}

fn sources() -> Vec<(String, PathBuf, String)> {
    let mut found = Vec::new();
    let mut folders = vec![PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("src")];
    let root = folders[0].clone();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let inside = path.strip_prefix(&root).unwrap();
                let room = inside.components().next().unwrap().as_os_str().to_str().unwrap();
                let text = fs::read_to_string(&path).unwrap();
                found.push((room.trim_end_matches(".rs").to_string(), inside.to_path_buf(), text));
            }
        }
    }
    found.sort();
    found
}

/// The rooms that a source names: `crate::room`, also in the braces of `crate::{a, b::c}`.
fn rooms_named(text: &str) -> BTreeSet<String> {
    let code: String = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n");
    let mut named = BTreeSet::new();
    let word = |rest: &str| rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    for (place, _) in code.match_indices("crate::") {
        let rest = &code[place + "crate::".len()..];
        if let Some(list) = rest.strip_prefix('{') {
            let mut depth = 0;
            let mut item = String::new();
            for c in list.chars() {
                match c {
                    '{' => depth += 1,
                    '}' if depth == 0 => break,
                    '}' => depth -= 1,
                    ',' if depth == 0 => {
                        named.insert(word(item.trim()));
                        item.clear();
                        continue;
                    }
                    _ => {}
                }
                item.push(c);
            }
            named.insert(word(item.trim()));
        } else {
            named.insert(word(rest));
        }
    }
    named
}

#[test]
fn a_module_names_only_modules_of_lower_floors() {
    for (room, file, text) in sources() {
        if room == "lib" || room == "main" {
            continue;
        }
        let own = floor(&room).unwrap_or_else(|| panic!("{} is in no room of the house", file.display()));
        for other in rooms_named(&text) {
            if other == room || other.is_empty() {
                continue;
            }
            let below = floor(&other).unwrap_or_else(|| panic!("{} names `{other}`, which is no room", file.display()));
            assert!(below < own, "{} (floor {own}) names `{other}` (floor {below})", file.display());
        }
    }
}

#[test]
fn every_room_of_the_house_exists() {
    let rooms: BTreeSet<String> = sources().into_iter().map(|(room, _, _)| room).collect();
    for room in FLOORS.concat() {
        assert!(rooms.contains(room), "the house has a room `{room}` that src/ has not");
    }
}

#[test]
fn front_page_and_architecture_show_the_house_as_it_is() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |name: &str| fs::read_to_string(root.join(name)).unwrap();
    let (page, architecture) = (read("src/lib.rs"), read("ARCHITECTURE.md"));
    for (number, rooms) in FLOORS.iter().enumerate() {
        for room in *rooms {
            let start = format!("//! | {number} |");
            let line = page.lines().find(|line| line.starts_with(&start)).unwrap_or_default();
            assert!(line.contains(&format!("[`{room}`]")) || line.contains(&format!("@{room}`]")), "lib.rs: {room}");
            let start = format!("| {number} |");
            let mut lines = architecture.lines().filter(|line| line.starts_with(&start));
            assert!(lines.any(|line| line.contains(&format!("`{room}`"))), "ARCHITECTURE.md: {room}");
        }
    }
}

#[test]
fn libraries_stay_in_their_rooms() {
    let rules: [(&str, &[&str]); 10] = [
        // What it sets holds for the whole process.
        ("set_infinity", &[]),
        ("ctrlc::", &["cli"]),
        ("signal_hook::", &["cli"]),
        ("catch_unwind", &["barrier.rs"]),
        ("clarabel::", &["method/interior_point.rs"]),
        ("faer::", &["sparse/cholesky.rs", "sparse/factor.rs", "sparse/ordering.rs"]),
        ("feral_metis::", &["sparse/ordering.rs"]),
        ("clap::", &["cli"]),
        ("resvg::", &["output"]),
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
fn methods_speak_no_mechanics_and_do_not_call_each_other() {
    let words = ["mesh", "element", "node", "stress", "young", "poisson", "obstacle"];
    for (room, file, text) in sources().into_iter().filter(|source| source.0 == "method") {
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
fn files_stay_readable() {
    for (_, file, text) in sources() {
        let lines = text.lines().count();
        assert!(lines <= 600, "{} has {lines} lines: split it", file.display());
    }
}

/// Each binary is linked on its own, with all dependencies: many would cost more time than the tests in them.
#[test]
fn tests_are_modules_of_at_most_eight_binaries() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let entries: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    let groups: Vec<&PathBuf> = entries.iter().filter(|path| path.join("main.rs").exists()).collect();
    assert!(groups.len() <= 8, "{groups:?}");
    for path in &entries {
        assert!(path.extension().is_none_or(|extension| extension != "rs"), "{} belongs in a group", path.display());
    }
    for group in groups {
        let main = fs::read_to_string(group.join("main.rs")).unwrap();
        for entry in fs::read_dir(group).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_stem().unwrap().to_str().unwrap();
            let is_named = name == "main" || main.contains(&format!("\nmod {name};"));
            assert!(is_named, "{} is compiled into no binary", path.display());
        }
    }
}
