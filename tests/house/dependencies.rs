//! Dependencies: their licences are those that `deny.toml` allows, all of them come from the registry, and none was yanked there.

use std::path::{Path, PathBuf};
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

/// The packages that a lock file names.
fn packages(manifest: &str) -> Vec<Value> {
    let mut cargo = Command::new(env::var("CARGO").unwrap_or_else(|_| "cargo".into()));
    cargo.args(["metadata", "--format-version", "1", "--locked", "--manifest-path"]).arg(root().join(manifest));
    let found = cargo.output().unwrap();
    assert!(found.status.success(), "{}", String::from_utf8_lossy(&found.stderr));
    let metadata: Value = serde_json::from_slice(&found.stdout).unwrap();
    metadata["packages"].as_array().unwrap().clone()
}

/// Returns `true` if one of the choices of an expression as `(MIT OR Apache-2.0) AND Unicode-3.0` is allowed.
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
    // In the older form a stroke separates choices.
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
    for manifest in ["Cargo.toml", "python/Cargo.toml"] {
        let packages = packages(manifest);
        assert!(packages.len() > 100, "{manifest}: {} packages", packages.len());
        for package in packages {
            let (name, licence) = (package["name"].as_str().unwrap(), package["license"].as_str().unwrap_or("none"));
            assert!(
                is_allowed(licence, &allowed),
                "{manifest}: {name} has the licence {licence}, which deny.toml does not allow"
            );
            let source = package["source"].as_str();
            let is_ours = name.starts_with("signorini");
            assert!(
                is_ours || source.is_some_and(|source| source.starts_with("registry+")),
                "{manifest}: {name} comes from {source:?}"
            );
        }
    }
}

#[test]
fn every_exception_for_an_advisory_names_a_crate_that_is_still_locked() {
    let text = fs::read_to_string(root().join("deny.toml")).unwrap();
    let exceptions: Vec<&str> = text.lines().filter(|line| line.contains("\"RUSTSEC-")).collect();
    assert!(!exceptions.is_empty());
    let locked: Vec<String> =
        ["Cargo.lock", "python/Cargo.lock"].map(|name| fs::read_to_string(root().join(name)).unwrap()).into();
    for exception in exceptions {
        let reason = exception.split_once("reason = \"").unwrap_or_else(|| panic!("no reason in {exception}")).1;
        let name = format!("\nname = \"{}\"\n", reason.split(' ').next().unwrap());
        assert!(locked.iter().any(|lock| lock.contains(&name)), "no lock file has the crate of {exception}");
    }
}

/// The warnings of cargo about locked versions of a package that were yanked; `None` if the index of the registry is out of reach.
fn yanked(folder: &Path) -> Option<Vec<String>> {
    let mut cargo = Command::new(env::var("CARGO").unwrap_or_else(|_| "cargo".into()));
    cargo.args(["package", "--no-verify", "--allow-dirty", "--color", "never", "--target-dir"]);
    cargo.arg(Path::new(env!("CARGO_TARGET_TMPDIR")).join("yanked")).current_dir(folder).env("CARGO_NET_RETRY", "0");
    let output = cargo.output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        // Only a network that fails is an excuse.
        assert!(text.contains("failed to download") || text.contains("Unable to update"), "{text}");
        return None;
    }
    Some(text.lines().filter(|line| line.contains("is yanked in registry")).map(str::to_string).collect())
}

/// A package with the dependencies of `python/` from the registry and its lock file, without code: as it stands, `python/` cannot be
/// packed, because it names this crate by its path.
fn python_without_this_crate() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("python");
    fs::create_dir_all(folder.join("src")).unwrap();
    let manifest = fs::read_to_string(root().join("python/Cargo.toml")).unwrap();
    let kept: String =
        manifest.lines().filter(|line| !line.starts_with("signorini = ")).map(|line| format!("{line}\n")).collect();
    fs::write(folder.join("Cargo.toml"), kept).unwrap();
    fs::copy(root().join("python/Cargo.lock"), folder.join("Cargo.lock")).unwrap();
    fs::write(folder.join("src/lib.rs"), "").unwrap();
    folder
}

#[test]
fn no_locked_version_was_yanked_from_the_registry() {
    for folder in [root().to_path_buf(), python_without_this_crate()] {
        match yanked(&folder) {
            Some(warnings) => assert!(warnings.is_empty(), "{}", warnings.join("\n")),
            None => eprintln!(
                "skipped: the index of the registry cannot be reached, so yanked versions were not looked for"
            ),
        }
    }
}

#[test]
fn an_expression_of_licences_is_read_as_it_is_meant() {
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
