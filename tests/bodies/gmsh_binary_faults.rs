//! Malformed binary mesh files: each error is one sentence with the line of the section and the byte of the record.

use signorini::{fem::Error, qp};
use std::path::Path;

use signorini::fem::{GmshFile, Mesh};

use super::gmsh_forms::{plane, space};
use support::gmsh_forms::{FORMS, Form};

fn read(content: &[u8]) -> Result<Mesh, Error> {
    GmshFile::parse(content, "body.msh").and_then(|file| file.mesh(&[], 1.0))
}

/// A kept file in binary form: the unit square of `gmsh_faults.rs`.
fn square(name: &str) -> Vec<u8> {
    std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/faults").join(name)).unwrap()
}

/// The first byte after the line `$name`, and the number of that line.
fn section(content: &[u8], name: &str) -> (usize, usize) {
    let head = format!("${name}\n");
    let begin = content.windows(head.len()).position(|window| window == head.as_bytes()).unwrap();
    (begin + head.len(), 1 + content[..begin].iter().filter(|&&byte| byte == b'\n').count())
}

/// Replaces bytes at the offset `at` after the line `$name`. The error must name the record at the offset `record`.
fn check(file: &str, name: &str, (record, at): (usize, usize), bytes: &[u8], phrase: &str) {
    let mut content = square(file);
    let (begin, line) = section(&content, name);
    content.splice(begin + at..begin + at + bytes.len(), bytes.iter().copied());
    let expected = format!("body.msh:{line}: at byte {}: {phrase}", begin + record);
    let found = read(&content).unwrap_err().to_string();
    assert!(found.starts_with(&expected), "{found}\ndoes not start with {expected}");
}

#[test]
fn faults_of_version_4_have_the_byte_of_their_record() {
    let check = |name, places, bytes: &[u8], phrase| check("square4b.msh", name, places, bytes, phrase);
    let (many, nan) = (u64::MAX.to_le_bytes(), f64::NAN.to_le_bytes());
    check("Entities", (0, 8), &many, "18446744073709551615 curves are announced, but at most");
    check("Entities", (32, 36), &nan, "a coordinate of an entity is NaN");
    check("Nodes", (0, 0), &many, "18446744073709551615 blocks are announced, but at most 1000000000 are allowed");
    check("Nodes", (0, 8), &[5], "5 nodes are announced, but the blocks hold 4");
    check("Nodes", (32, 32), &[7], "the dimension of the entity is 7; it must be at most 3");
    check("Nodes", (32, 32), &[255; 4], "the dimension of the entity is `-1`; it must be a whole number that is not");
    check("Nodes", (32, 40), &[2], "the sign for parametric coordinates is 2; it must be 0 or 1");
    check("Nodes", (32, 44), &many, "18446744073709551615 nodes in the block are announced");
    check("Nodes", (60, 60), &nan, "x is NaN; it must be finite");
    check("Nodes", (60, 76), &f64::NEG_INFINITY.to_le_bytes(), "z is -inf; it must be finite");
    check("Nodes", (112, 104), &[10], "node 10 is given twice");
    check("Elements", (0, 8), &[4], "4 elements are announced, but the blocks hold 3");
    check("Elements", (32, 36), &[9], "there is no entity 9 of dimension 1 in `$Entities`");
    check("Elements", (32, 40), &[93], "the element type 93 is not supported");
    check("Elements", (32, 40), &[255; 4], "the type of the elements is `-1`");
    check("Elements", (52, 60), &[99], "element 2 names node 99, which does not exist");
    check("Elements", (52, 60), &many, "element 2 names node 18446744073709551615, which does not exist");
}

#[test]
fn faults_of_version_2_have_the_byte_of_their_record() {
    let check = |name, places, bytes: &[u8], phrase| check("square2b.msh", name, places, bytes, phrase);
    check("Nodes", (0, 0), b"x", "the number of nodes is `x`; it must be a whole number that is not negative");
    check("Nodes", (2, 2), &[255; 4], "the tag of a node is `-1`; it must be a whole number that is not negative");
    check("Nodes", (2, 14), &f64::NAN.to_le_bytes(), "y is NaN; it must be finite");
    check("Nodes", (30, 30), &[1], "node 1 is given twice");
    check("Elements", (2, 6), &[0], "the number of elements of one type is 0; it must be 1 to 3, which are left");
    check("Elements", (2, 6), &[255, 255, 255, 127], "the number of elements of one type is 2147483647; it must be 1");
    check("Elements", (14, 2), &[93], "the element type 93 is not supported");
    check("Elements", (14, 10), &[255, 255, 255, 127], "the file ends where a tag of an element should stand");
    check("Elements", (14, 26), &[99], "element 1 names node 99, which does not exist");
}

#[test]
fn a_section_without_its_end_is_a_located_fault() {
    for file in ["square2b.msh", "square4b.msh"] {
        let content = square(file);
        let (nodes, line) = section(&content, "Nodes");
        let text = |content: &[u8], from: &str, to: &str| {
            let at = content.windows(from.len()).position(|window| window == from.as_bytes()).unwrap();
            [&content[..at], to.as_bytes(), &content[at + from.len()..]].concat()
        };
        let found = read(&text(&content, "$EndNodes", "")).unwrap_err().to_string();
        assert!(found.contains("`$Elements` stands where") || found.contains("more in the section"), "{found}");
        assert!(found.starts_with(&format!("body.msh:{line}: at byte ")), "{found}");
        let found = read(&text(&content, "$Nodes", "$Knots")).unwrap_err().to_string();
        let expected = format!("body.msh:{line}: at byte {}: the file ends before `$EndKnots`", nodes - 7);
        assert!(found.starts_with(&expected), "{found}");
    }
}

/// Asserts that an error names a byte of the file, and the line in which a section begins or should begin.
fn assert_located(content: &[u8], error: &Error) {
    let Error::Linear(qp::LinearError::FileSyntax { line, message, .. }) = error else { panic!("{error}") };
    let text = content.split(|&byte| byte == b'\n').nth(line - 1).unwrap_or_else(|| panic!("{error}"));
    assert!(message.len() < 400 && !message.contains(char::is_control), "the error is not one sentence: {error}");
    let Some((byte, _)) = message.strip_prefix("at byte ").and_then(|rest| rest.split_once(": ")) else {
        return assert!(*line <= 3, "{error}");
    };
    let byte: usize = byte.parse().unwrap();
    assert!(byte <= content.len(), "{error}");
    let before = content[..byte].iter().filter(|&&byte| byte == b'\n').count();
    let is_heading = text.trim_ascii_start().starts_with(b"$");
    assert!(before + 1 >= *line && (is_heading || message.contains("should begin")), "{error}");
}

#[test]
fn a_binary_file_cut_at_any_byte_is_a_located_fault() {
    for form in FORMS.into_iter().filter(|(_, form)| *form != Form::Ascii) {
        for whole in [plane(1).written(form), space(1).written(form)] {
            let end = whole.windows(12).rposition(|window| window == b"$EndElements").unwrap();
            for cut in 0..end + 12 {
                let error =
                    read(&whole[..cut]).err().unwrap_or_else(|| panic!("{form:?}, cut at {cut}: the file is accepted"));
                assert_located(&whole[..cut], &error);
            }
        }
    }
}

#[test]
fn a_binary_file_with_a_changed_byte_is_a_mesh_or_a_located_fault() {
    let mut state = 1_u64;
    let mut draw = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for form in FORMS.into_iter().filter(|(_, form)| *form != Form::Ascii) {
        let whole = plane(2).written(form);
        let inputs = 2 * whole.len();
        let mut refused = 0;
        for input in 0..inputs {
            let mut changed = whole.clone();
            changed[input % whole.len()] = draw(256) as u8;
            if let Err(error) = read(&changed) {
                assert_located(&changed, &error);
                refused += 1;
            }
        }
        assert!(refused > inputs / 10 && refused < inputs, "{form:?}: {refused} of {inputs}");
    }
}
