//! Dependencies: `deny.toml` allows all their licences, and all come from the registry.

use std::path::Path;
use std::process::Command;
use std::{env, fs};

use serde_json::Value;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The licences that `deny.toml` allows.
fn allowed() -> Vec<String> {
    let text = fs::read_to_string(root().join("deny.toml")).unwrap();
    let list = text.split_once("\nallow = [").unwrap().1.split_once(']').unwrap().0;
    list.split('"').skip(1).step_by(2).map(str::to_string).collect()
}

/// What cargo says of the workspace.
pub fn metadata(arguments: &[&str]) -> Value {
    let mut cargo = Command::new(env::var("CARGO").unwrap_or_else(|_| "cargo".into()));
    cargo
        .args(["metadata", "--format-version", "1", "--locked", "--manifest-path"])
        .arg(root().join("Cargo.toml"))
        .args(arguments);
    let found = cargo.output().unwrap();
    assert!(found.status.success(), "{}", String::from_utf8_lossy(&found.stderr));
    serde_json::from_slice(&found.stdout).unwrap()
}

/// The packages that the lock file names.
fn packages() -> Vec<Value> {
    metadata(&[])["packages"].as_array().unwrap().clone()
}

/// Returns `true` if one of the choices of an expression such as `(MIT OR Apache-2.0) AND Unicode-3.0` is allowed.
fn is_allowed(expression: &str, allowed: &[String]) -> bool {
    let parts = |text: &str, by: &str| -> Vec<String> {
        let (mut parts, mut depth) = (vec![Vec::new()], 0);
        for word in text.split_whitespace() {
            if depth == 0 && word == by {
                parts.push(Vec::new());
                continue;
            }
            depth += word.matches('(').count();
            depth -= word.matches(')').count();
            parts.last_mut().unwrap().push(word);
        }
        parts.into_iter().map(|part| part.join(" ")).collect()
    };
    // In the older form a slash separates choices.
    let expression = expression.replace('/', " OR ");
    let whole = expression.trim();
    let inner =
        whole.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')).filter(|inner| !inner.contains(['(', ')']));
    let whole = inner.unwrap_or(whole).trim();
    let (choices, demands) = (parts(whole, "OR"), parts(whole, "AND"));
    match (choices.len() > 1, demands.len() > 1) {
        (true, _) => choices.iter().any(|choice| is_allowed(choice, allowed)),
        (false, true) => demands.iter().all(|demand| is_allowed(demand, allowed)),
        (false, false) => allowed.iter().any(|licence| licence == whole),
    }
}

#[test]
fn licences_of_all_dependencies_are_allowed_and_all_come_from_the_registry() {
    let allowed = allowed();
    assert!(allowed.len() > 4, "{allowed:?}");
    let packages = packages();
    assert!(packages.len() > 100, "{} packages", packages.len());
    // The crate of the Python package is one of the workspace.
    assert!(packages.iter().any(|package| package["name"] == "pyo3"));
    for package in packages {
        let (name, licence) = (package["name"].as_str().unwrap(), package["license"].as_str().unwrap_or("none"));
        assert!(is_allowed(licence, &allowed), "{name} has the licence {licence}, which deny.toml does not allow");
        let source = package["source"].as_str();
        let is_ours = name.starts_with("signorini");
        let is_registered = source.is_some_and(|source| source.starts_with("registry+"));
        assert!(is_ours || is_registered, "{name} comes from {source:?}");
    }
}

#[test]
fn every_exception_for_an_advisory_names_a_crate_that_is_still_locked() {
    let text = fs::read_to_string(root().join("deny.toml")).unwrap();
    let exceptions: Vec<&str> = text.lines().filter(|line| line.contains("\"RUSTSEC-")).collect();
    assert!(!exceptions.is_empty());
    let locked = fs::read_to_string(root().join("Cargo.lock")).unwrap();
    for exception in exceptions {
        let reason = exception.split_once("reason = \"").unwrap_or_else(|| panic!("no reason in {exception}")).1;
        let name = format!("\nname = \"{}\"\n", reason.split(' ').next().unwrap());
        assert!(locked.contains(&name), "the lock file does not have the crate of {exception}");
    }
}

#[test]
fn expressions_of_licences_are_evaluated_with_and_or_and_parentheses() {
    let allowed: Vec<String> = ["MIT", "Unicode-3.0"].map(String::from).into();
    for (expression, expected) in [
        ("MIT", true),
        ("GPL-3.0", false),
        ("GPL-3.0 OR MIT", true),
        ("MIT AND GPL-3.0", false),
        ("Unlicense/MIT", true),
        ("(MIT OR Apache-2.0) AND Unicode-3.0", true),
        ("(GPL-3.0 OR Apache-2.0) AND Unicode-3.0", false),
        ("none", false),
    ] {
        assert_eq!(is_allowed(expression, &allowed), expected, "{expression}");
    }
}

/// The crates of the workspace that are published, each with its direct dependencies outside the workspace.
fn published() -> Vec<(String, Value, Vec<String>)> {
    let ours = packages().into_iter().filter(|package| package["source"].is_null());
    let ours = ours.filter(|package| package["publish"].as_array().is_none_or(|registries| !registries.is_empty()));
    let of_package = |package: Value| {
        let names = package["dependencies"].as_array().unwrap().iter();
        let outside = names.filter(|one| one["kind"].is_null() && one["path"].is_null());
        let names = outside.map(|one| one["name"].as_str().unwrap().to_string()).collect();
        (package["name"].as_str().unwrap().to_string(), package, names)
    };
    ours.map(of_package).collect()
}

#[test]
fn each_crate_has_at_most_ten_dependencies_outside_the_workspace_and_that_of_the_qp_eight() {
    let published = published();
    let names: Vec<&str> = published.iter().map(|one| one.0.as_str()).collect();
    assert_eq!(names.len(), 5, "{names:?}");
    for (name, _, outside) in &published {
        let (least, most) = match name.as_str() {
            "signorini-qp" => (4, 8),
            // All else is in the QP.
            "signorini-lcp" => (1, 1),
            _ => (4, 10),
        };
        assert!((least..=most).contains(&outside.len()), "{name}: {outside:?}");
    }
}

/// Cargo refuses an older compiler with a sentence, in place of an error somewhere in a dependency, also one of a
/// feature.
#[test]
fn the_oldest_compiler_is_the_newest_that_a_dependency_asks_for() {
    let version = |package: &Value| -> Option<Vec<u32>> {
        package["rust_version"].as_str().map(|text| text.split('.').map(|part| part.parse().unwrap()).take(2).collect())
    };
    let (ours, all) = (published(), metadata(&["--all-features"]));
    let list = |of: &Value| of.as_array().unwrap().clone();
    let built = |one: &Value| list(&one["dep_kinds"]).iter().any(|kind| kind["kind"].is_null());
    let nodes = list(&all["resolve"]["nodes"]);
    let mut reached: Vec<Value> = ours.iter().map(|(_, package, _)| package["id"].clone()).collect();
    let mut place = 0;
    while place < reached.len() {
        let node = nodes.iter().find(|node| node["id"] == reached[place]).unwrap();
        for one in list(&node["deps"]).into_iter().filter(built) {
            if !reached.contains(&one["pkg"]) {
                reached.push(one["pkg"].clone());
            }
        }
        place += 1;
    }
    let outside = list(&all["packages"]).into_iter().filter(|package| !package["source"].is_null());
    let newest =
        outside.filter(|package| reached.contains(&package["id"])).filter_map(|package| version(&package)).max();
    assert!(reached.len() > 100, "{} packages", reached.len());
    for (_, package, _) in &ours {
        assert_eq!(version(package), newest);
    }
}

#[test]
fn every_crate_forbids_unsafe_code_and_begins_with_an_example() {
    for folder in ["crates/qp/src", "crates/lcp/src", "crates/mechanics/src", "crates/output/src", "src"] {
        let text = fs::read_to_string(root().join(folder).join("lib.rs")).unwrap();
        assert!(text.contains("\n#![forbid(unsafe_code)]\n"), "{folder}");
        let page: Vec<&str> = text.lines().take_while(|line| line.starts_with("//!")).collect();
        assert!(page.iter().any(|line| line.starts_with("//! ```")), "{folder}");
    }
}
