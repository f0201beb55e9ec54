//! Dependencies: each has its reason, `deny.toml` allows all their licences, and all come from the registry.

use std::process::Command;
use std::{env, fs};

use serde_json::Value;

use crate::sources::root;

/// Licences without a choice that are allowed as a whole.
const BOTH: [&str; 1] = ["(MIT OR Apache-2.0) AND Unicode-3.0"];

/// What cargo says of the workspace.
pub fn metadata(argument: &str) -> Value {
    let mut cargo = Command::new(env::var("CARGO").unwrap_or_else(|_| "cargo".into()));
    cargo.args(["metadata", "--format-version", "1", "--locked", argument]).current_dir(root());
    let found = cargo.output().unwrap();
    assert!(found.status.success(), "{}", String::from_utf8_lossy(&found.stderr));
    serde_json::from_slice(&found.stdout).unwrap()
}

#[test]
fn dependencies_have_allowed_licences_come_from_the_registry_and_need_no_newer_compiler() {
    let text = fs::read_to_string(root().join("deny.toml")).unwrap();
    let list = text.split_once("\nallow = [").unwrap().1.split_once(']').unwrap().0;
    let allowed: Vec<&str> = list.split('"').skip(1).step_by(2).chain(BOTH).collect();
    let found = metadata("--all-features");
    let packages = found["packages"].as_array().unwrap();
    assert!(packages.len() > 100, "{} packages", packages.len());
    let version = |package: &Value| -> Option<Vec<u32>> {
        let parts = package["rust_version"].as_str()?.split('.').take(2);
        Some(parts.map(|part| part.parse().unwrap()).collect())
    };
    let of_ours = packages.iter().find(|package| package["name"] == "signorini").and_then(version);
    let (outside, ours): (Vec<&Value>, Vec<&Value>) = packages.iter().partition(|package| !package["source"].is_null());
    assert!(ours.iter().all(|package| package["name"].as_str().unwrap().starts_with("signorini")), "{ours:?}");
    for package in &outside {
        let (name, licence) = (&package["name"], package["license"].as_str().unwrap_or("none"));
        // In the older form a slash separates choices.
        let choices = licence.replace('/', " OR ");
        let mut choices = choices.split(" OR ").map(str::trim).chain([licence]);
        assert!(choices.any(|one| allowed.contains(&one)), "deny.toml does not allow {licence} of {name}");
        assert!(package["source"].as_str().unwrap().starts_with("registry+"), "{name}: {}", package["source"]);
    }
    assert_eq!(outside.into_iter().filter_map(version).max(), of_ours, "the newest compiler that one of them asks for");
}

#[test]
fn each_dependency_stands_once_in_the_workspace_with_its_reason_above_it() {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let list = manifest.split_once("[workspace.dependencies]\n").unwrap().1.split("\n[").next().unwrap().trim_end();
    let lines: Vec<&str> = list.lines().filter(|line| !line.starts_with("signorini")).collect();
    assert!(lines.len() > 40);
    for pair in lines.windows(2).filter(|pair| !pair[1].starts_with('#')) {
        assert!(pair[0].starts_with("# "), "{} has no reason", pair[1]);
    }
    for folder in [
        ".",
        "crates/linear",
        "crates/qp",
        "crates/lcp",
        "crates/deck",
        "crates/fem",
        "crates/guarantee",
        "crates/mechanics",
        "crates/motion",
        "crates/study",
        "crates/output",
        "python",
        "tests/support",
    ] {
        let manifest = fs::read_to_string(root().join(folder).join("Cargo.toml")).unwrap();
        let tables = manifest.split("\n[").filter(|table| table.split(']').next().unwrap().ends_with("dependencies"));
        for line in tables.filter(|table| !table.starts_with("workspace")).flat_map(|table| table.lines().skip(1)) {
            let is_one = line.contains('=') && !line.starts_with('#') && !line.starts_with("signorini");
            assert!(!is_one || line.contains("workspace = true"), "{folder}: {line}");
        }
    }
}
