//! Kept malformed PETSc files: each damages one file of the exported scene `tests/faults/plane.json`, and is refused
//! with the code and the sentence kept in `tests/faults/petsc.jsonl`; the sentence has file and byte.
//!
//! A line is `[file, damage, code, sentence]`. A damage is `put BYTE HEX` (replaces bytes from there on), `cut BYTES`
//! (keeps this number of bytes), `add HEX` (appends bytes), `make HEX` (replaces the whole content) or `take away`.
//! Files with the coordinates of nodes are damaged in a directory without `near_null.petsc`.
//!
//! `BLESS=1 cargo test --test files petsc_faults` writes codes and sentences again; read them before you keep them.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use serde_json::Value;
use signorini::qp::read_problem;
use support::program::Desk;

/// Largest number of letters of an error message about a PETSc file.
const LONGEST: usize = 300;

/// Files that are read only if there is no `near_null.petsc`.
const OF_NODES: [&str; 2] = ["coordinates.petsc", "K.petsc.info"];

fn bytes(hex: &str) -> Vec<u8> {
    (0..hex.len()).step_by(2).map(|at| u8::from_str_radix(&hex[at..at + 2], 16).unwrap()).collect()
}

/// The bytes of a damaged file; `None` if the file is removed.
fn damaged(right: &[u8], damage: &str) -> Option<Vec<u8>> {
    let mut contents = right.to_vec();
    let words: Vec<&str> = damage.split(' ').collect();
    match words[..] {
        ["put", byte, hex] => {
            let (byte, new) = (byte.parse::<usize>().unwrap(), bytes(hex));
            contents[byte..byte + new.len()].copy_from_slice(&new);
        }
        ["cut", left] => contents.truncate(left.parse().unwrap()),
        ["add", hex] => contents.extend(bytes(hex)),
        ["make", hex] => contents = bytes(hex),
        ["take", "away"] => return None,
        _ => panic!("{damage} is an unknown damage"),
    }
    Some(contents)
}

#[test]
fn every_damaged_file_is_refused_with_its_code_and_its_sentence() {
    let faults = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/faults");
    let kept = fs::read_to_string(faults.join("petsc.jsonl")).unwrap();
    let desk = Desk::new();
    let scene = faults.join("plane.json");
    desk.run(&["export", scene.to_str().unwrap(), "right", "--format", "petsc"]).ends_with(0);
    let right = desk.path("right");
    assert!(read_problem(&right).is_ok());
    let (mut blessed, mut wrong) = (String::new(), String::new());
    for (number, line) in kept.lines().enumerate() {
        let case: [String; 4] = serde_json::from_str(line).unwrap();
        let [name, damage, code, sentence] = &case;
        let folder = desk.path("p");
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir(&folder).unwrap();
        for file in fs::read_dir(&right).unwrap() {
            let file = file.unwrap().path();
            fs::copy(&file, folder.join(file.file_name().unwrap())).unwrap();
        }
        if OF_NODES.contains(&name.as_str()) {
            fs::remove_file(folder.join("near_null.petsc")).unwrap();
        }
        let file = folder.join(name);
        match damaged(&fs::read(&file).unwrap(), damage) {
            Some(contents) => fs::write(&file, contents).unwrap(),
            None => fs::remove_file(&file).unwrap(),
        }
        let error = match read_problem(&folder) {
            Err(error) => error,
            Ok(_) => {
                let _ = writeln!(wrong, "line {}: {line} is accepted", number + 1);
                continue;
            }
        };
        let found = [error.code().to_string(), error.to_string().replace(&format!("{}/", folder.display()), "")];
        if [code, sentence] != [&found[0], &found[1]] {
            let _ = writeln!(wrong, "line {}: {found:?}\n   kept: {:?}", number + 1, (code, sentence));
        }
        assert!(found[1].chars().count() < LONGEST && found[1].contains(name.as_str()), "{}", found[1]);
        blessed += &serde_json::to_string(&[name, damage, &found[0], &found[1]]).unwrap();
        blessed.push('\n');
    }
    assert!(kept.lines().count() >= 90);
    if std::env::var_os("BLESS").is_some() {
        fs::write(faults.join("petsc.jsonl"), blessed).unwrap();
    }
    assert!(wrong.is_empty(), "{wrong}");
}

/// The program ends as for other invalid files.
#[test]
fn the_program_names_the_byte_of_a_damaged_petsc_file() {
    let desk = Desk::new();
    let scene: Value = support::program::scene();
    desk.write("scene.json", scene.to_string());
    desk.run(&["export", "scene.json", "p", "--format", "petsc"]).ends_with(0);
    let right = fs::read(desk.path("p/K.petsc")).unwrap();
    fs::write(desk.path("p/K.petsc"), &right[..right.len() - 3]).unwrap();
    let phrases = &["p/K.petsc, byte ", "the file ends here", "bytes; a matrix of ", " rows and "];
    desk.run(&["solve", "p"]).fails_with(1, phrases);
    desk.run(&["compare", "p"]).fails_with(1, phrases);
    fs::remove_file(desk.path("p/K.petsc")).unwrap();
    fs::create_dir(desk.path("p/K.petsc")).unwrap();
    desk.run(&["solve", "p"]).fails_with(1, &["cannot read p/K.petsc: it is not a regular file"]);
}
