//! Kept malformed files: each changes one place of a valid file of `tests/faults`, and is refused with the code and the
//! sentence kept in `cases.jsonl`; the sentence has the JSON path, line and column of a scene, or the line of a table.
//!
//! A line is `[file, replaced text, replacement, code, sentence]`. `BLESS=1 cargo test --test files faults` writes
//! codes and sentences again; read them before you keep them.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use signorini::fem::GmshFile;
use signorini::qp::read_problem;
use signorini::{Error, Scene, solve_qp};

/// Largest number of letters of an error message.
const LONGEST: usize = 400;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/faults")
}

/// Reads, builds and solves the file `name` in `desk`. Returns `None` if there is no error.
fn refused(desk: &Path, name: &str) -> Option<Error> {
    let file = desk.join(name);
    let solved = |problem: &signorini::ContactProblem| solve_qp(problem).map(drop);
    match file.extension().and_then(|extension| extension.to_str()) {
        Some("json") => {
            let built =
                Scene::read(&file).and_then(|scene| scene.build()).map_err(|error| Scene::located(error, &file));
            built.and_then(|model| solved(model.problem()).map_err(|error| model.explain(error))).err()
        }
        Some("msh") => GmshFile::read(&file).and_then(|mesh| mesh.mesh(&[], 1.0)).err().map(Error::from),
        _ => read_problem(desk).and_then(|problem| solved(&problem)).err().map(Error::from),
    }
}

#[test]
fn every_malformed_file_is_refused_with_its_code_and_its_sentence() {
    let kept = fs::read_to_string(folder().join("cases.jsonl")).unwrap();
    let desk = tempfile::tempdir().unwrap();
    let (mut blessed, mut wrong) = (String::new(), String::new());
    let mut known = std::collections::BTreeSet::new();
    for (number, line) in kept.lines().enumerate() {
        let case: Vec<Value> = serde_json::from_str(line).unwrap();
        let word = |index: usize| case.get(index).and_then(Value::as_str).unwrap_or_default();
        let (name, from, to) = (word(0), word(1), word(2));
        assert!(known.insert((name.to_string(), from.to_string(), to.to_string())), "line {} occurs twice", number + 1);
        for file in fs::read_dir(folder()).unwrap() {
            let file = file.unwrap().path();
            fs::copy(&file, desk.path().join(file.file_name().unwrap())).unwrap();
        }
        let right = fs::read_to_string(folder().join(name)).unwrap();
        assert!(right.contains(from), "line {}: {name} does not contain {from:?}", number + 1);
        fs::write(desk.path().join(name), right.replacen(from, to, 1)).unwrap();
        let Some(error) = refused(desk.path(), name) else {
            let _ = writeln!(wrong, "line {}: {line} is accepted", number + 1);
            continue;
        };
        let place = desk.path().display().to_string();
        let sentence = error.to_string().replace(&format!("{place}/"), "").replace(&place, ".");
        let found = (error.code().to_string(), sentence);
        if (word(3), word(4)) != (found.0.as_str(), found.1.as_str()) {
            let _ = writeln!(wrong, "line {}: {found:?}\n   kept: {:?}", number + 1, (word(3), word(4)));
        }
        assert!(found.1.chars().count() < LONGEST, "line {}: {}", number + 1, found.1);
        if name.ends_with(".json") && found.0 == "scene" {
            let place: Vec<&str> = found.1.splitn(4, ':').collect();
            assert!(place[1].parse::<usize>().is_ok() && place[2].parse::<usize>().is_ok(), "{}", found.1);
            let is_placed = place[3].starts_with(" at `") || place[3].starts_with(" at the top level");
            assert!(is_placed, "{}", found.1);
        }
        blessed += &serde_json::to_string(&[name, from, to, &found.0, &found.1]).unwrap();
        blessed.push('\n');
    }
    assert!(known.len() >= 200);
    if std::env::var_os("BLESS").is_some() {
        fs::write(folder().join("cases.jsonl"), blessed).unwrap();
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn the_files_that_the_cases_change_are_valid() {
    for name in [
        "plane.json",
        "space.json",
        "round.json",
        "square2.msh",
        "square4.msh",
        "square2b.msh",
        "square4b.msh",
        "K.mtx",
    ] {
        let error = refused(&folder(), name);
        assert!(error.is_none(), "{name}: {}", error.unwrap());
    }
}

/// Found by random damage: unbounded sizes made the estimate recurse without end.
#[test]
fn the_estimate_of_unbounded_sizes_ends() {
    let text = fs::read_to_string(folder().join("round.json")).unwrap();
    for (from, to) in [
        ("\"width\": 0.2", "\"width\": 0"),
        ("\"radius\": 1,", "\"radius\": 1e308,"),
        ("\"divisions\": 2", "\"divisions\": 0"),
    ] {
        let scene = Scene::from_json(&text.replacen(from, to, 1), "scene").unwrap();
        assert!(scene.size().bytes > 0.0 || scene.size().bytes.is_nan(), "{to}");
        assert!(scene.build().is_err() || to.contains("1e308"), "{to}");
    }
}
