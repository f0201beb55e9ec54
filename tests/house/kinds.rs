//! Each kind has one place: a new element, body shape, obstacle shape, time scheme or error changes few files.
//!
//! The files that name a kind are counted; names in comments and string literals do not count.

use std::collections::BTreeSet;
use std::path::PathBuf;

use signorini::fem::ElementKind;

use crate::imports::House;

/// The code of every file of `src/`.
fn sources() -> Vec<(PathBuf, String)> {
    House::read().files.into_values().map(|source| (source.path, code(&source.text))).collect()
}

/// The code of a text, without comments and string literals.
fn code(text: &str) -> String {
    let mut code = String::new();
    let mut is_quoted = false;
    for line in text.lines() {
        let line = if is_quoted { line } else { line.split("//").next().unwrap_or_default() };
        let mut before = ' ';
        for character in line.chars() {
            match character {
                '"' if before != '\\' && before != '\'' => is_quoted = !is_quoted,
                _ if is_quoted => {}
                _ => code.push(character),
            }
            before = character;
        }
        code.push('\n');
    }
    code
}

/// Returns `true` if `code` contains the name as a whole word.
fn names(code: &str, name: &str) -> bool {
    let continues = |character: Option<char>| character.is_some_and(|c| c.is_alphanumeric() || c == '_');
    code.match_indices(name)
        .any(|(at, _)| !continues(code[..at].chars().next_back()) && !continues(code[at + name.len()..].chars().next()))
}

/// Asserts that a kind is named in these files and in no other.
fn assert_named_in(names_of_kind: &[String], expected: &[&str]) {
    let named = |(path, code): &(PathBuf, String)| {
        names_of_kind.iter().any(|name| names(code, name)).then(|| path.to_str().unwrap().to_string())
    };
    let found: BTreeSet<String> = sources().iter().filter_map(named).collect();
    let expected: BTreeSet<String> = expected.iter().map(|path| (*path).to_string()).collect();
    assert_eq!(found, expected, "files that name {names_of_kind:?}");
}

#[test]
fn an_element_is_named_in_three_files() {
    let (all, scene) = ("fem/element/mod.rs", "scene/input/schema/cells.rs");
    // Bodies that consist of one kind of element also name it, and the estimate for a mesh file assumes triangles.
    let elements = [
        ("Line2", "fem/element/line2.rs", &["scene/input/body/bar.rs"][..]),
        ("T3", "fem/element/t3.rs", &[scene, "scene/input/body/gmsh.rs"]),
        ("T6", "fem/element/t6.rs", &[scene]),
        ("Q4", "fem/element/q4.rs", &[scene]),
        ("Q8", "fem/element/q8.rs", &[scene]),
        ("Tet4", "fem/element/tet4.rs", &[scene]),
        ("Hex8", "fem/element/hex8.rs", &[scene, "scene/input/body/half_ball.rs"]),
        ("Tet10", "fem/element/tet10.rs", &[scene]),
        ("Hex20", "fem/element/hex20.rs", &[scene]),
    ];
    assert_eq!(elements.map(|element| element.0), ElementKind::ALL.map(ElementKind::name));
    for (element, file, others) in elements {
        let of_kinds = ["ElementKind", "ElementSpec", "SolidElementSpec"].map(|kinds| format!("{kinds}::{element}"));
        assert_named_in(&of_kinds, &[&[all], others].concat());
        let own = format!("static {}:", element.to_uppercase());
        assert!(sources().iter().any(|(path, code)| path.to_str() == Some(file) && code.contains(&own)), "{file}");
    }
}

#[test]
fn a_body_shape_is_named_in_two_files() {
    for (shape, spec, file) in [
        ("Rectangle", "RectangleSpec", "rectangle"),
        ("Bar", "BarSpec", "bar"),
        ("Box", "BoxSpec", "cuboid"),
        ("Disc", "DiscSpec", "disc"),
        ("HalfDisc", "HalfDiscSpec", "half_disc"),
        ("HalfBall", "HalfBallSpec", "half_ball"),
        ("Ring", "RingSpec", "ring"),
        ("Gmsh", "GmshSpec", "gmsh"),
        ("Deck", "DeckSpec", "deck"),
    ] {
        let file = format!("scene/input/body/{file}.rs");
        assert_named_in(&[spec.into(), format!("BodySpec::{shape}")], &["scene/input/body/mod.rs", &file]);
    }
}

#[test]
fn an_obstacle_shape_is_named_in_two_files() {
    for (shape, spec, file) in [
        ("Plane", "PlaneSpec", "plane"),
        ("Parabola", "ParabolaSpec", "parabola"),
        ("Circle", "CircleSpec", "circle"),
        ("Wedge", "WedgeSpec", "wedge"),
        ("Table", "TableSpec", "table"),
        ("Sphere", "SphereSpec", "sphere"),
        ("Cylinder", "CylinderSpec", "cylinder"),
        ("Cone", "ConeSpec", "cone"),
        ("HeightMap", "HeightMapSpec", "height_map"),
        ("Torus", "TorusSpec", "torus"),
        ("Surface", "SurfaceSpec", "triangulated"),
        ("Body", "FacingSpec", "facing"),
    ] {
        let file = format!("scene/input/obstacle/{file}.rs");
        assert_named_in(&[spec.into(), format!("ShapeSpec::{shape}")], &["scene/input/obstacle/mod.rs", &file]);
    }
}

#[test]
fn a_time_scheme_is_named_in_two_files() {
    for (scheme, file) in [
        ("FoxGoodwin", "fox_goodwin"),
        ("Midpoint", "midpoint"),
        ("Trapezoidal", "trapezoidal"),
        ("ContactStabilised", "contact_stabilised"),
        ("Hht", "hht"),
        ("Penalty", "penalty"),
        ("PenaltyLoop", "penalty_loop"),
        ("CentralDifference", "central_difference"),
    ] {
        let of_enums = ["Scheme", "SchemeSpec"].map(|kinds| format!("{kinds}::{scheme}"));
        assert_named_in(&of_enums, &["motion/scheme/mod.rs"]);
        let file = format!("motion/scheme/{file}.rs");
        let has_about =
            |(path, code): &(PathBuf, String)| path.to_str() == Some(&file) && code.contains("ABOUT: About");
        assert!(sources().iter().any(has_about), "{file}");
    }
}

/// Code, status and exit code of an error are defined in the two files of errors; no other file contains a status.
#[test]
fn no_error_is_classified_outside_its_own_file() {
    let words = ["bad_input", "under_held", "not_convex", "out_of_time", "infeasible", "unbounded"];
    for (_, source) in House::read().files.into_iter().filter(|(_, source)| !source.path.ends_with("error.rs")) {
        for word in words {
            let quoted = format!("\"{word}\"");
            assert!(!source.text.contains(&quoted), "{} names the status {quoted}", source.path.display());
        }
    }
}
