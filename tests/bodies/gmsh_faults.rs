//! Malformed mesh files: each error is one sentence with file and line.

use signorini::fem::GmshFile;
use signorini::{fem::Error, qp};

/// A unit square of two triangles in version 2.2; a test may replace any line.
const V2: [&str; 24] = [
    "$MeshFormat",
    "2.2 0 8",
    "$EndMeshFormat",
    "$PhysicalNames",
    "2",
    "1 1 \"floor\"",
    "2 2 \"body\"",
    "$EndPhysicalNames",
    "$Nodes",
    "4",
    "10 0 0 0",
    "40 0 1 0",
    "20 1 0 0",
    "30 1 1 0",
    "$EndNodes",
    "$Elements",
    "5",
    "1 15 2 0 1 10",
    "2 1 2 1 1 10 20",
    "3 1 2 0 2 20 30",
    "4 2 2 2 1 10 20 30",
    "5 2 2 2 1 10 30 40",
    "$EndElements",
    "",
];

/// The same square in version 4.1.
const V4: [&str; 36] = [
    "$MeshFormat",
    "4.1 0 8",
    "$EndMeshFormat",
    "$PhysicalNames",
    "2",
    "1 1 \"floor\"",
    "2 2 \"body\"",
    "$EndPhysicalNames",
    "$Entities",
    "0 1 1 0",
    "7 0 0 0 1 0 0 1 1 0 ",
    "8 0 0 0 1 1 0 1 2 1 7 ",
    "$EndEntities",
    "$Nodes",
    "2 4 10 40",
    "1 7 0 2",
    "10",
    "20",
    "0 0 0",
    "1 0 0",
    "2 8 0 2",
    "40",
    "30",
    "0 1 0",
    "1 1 0",
    "$EndNodes",
    "$Elements",
    "2 3 1 3",
    "1 7 1 1",
    "1 10 20 ",
    "2 8 2 2",
    "2 10 20 30 ",
    "3 10 30 40 ",
    "$EndElements",
    "$NodeData",
    "$EndNodeData",
];

fn text(lines: &[&str]) -> String {
    lines.join("\n")
}

/// The lines with one replaced; lines are counted from 1.
fn with(lines: &[&str], line: usize, replacement: &str) -> String {
    let mut lines = lines.to_vec();
    lines[line - 1] = replacement;
    text(&lines)
}

fn read(text: &str) -> Result<signorini::fem::Mesh, Error> {
    GmshFile::parse(text, "folder/body.msh").and_then(|file| file.mesh(&[], 1.0))
}

fn check(text: &str, expected_line: usize, phrase: &str) {
    match read(text) {
        Err(Error::Linear(qp::LinearError::FileSyntax { file, line, message })) => {
            assert_eq!(file.to_str(), Some("folder/body.msh"));
            assert!(line == expected_line && message.contains(phrase), "{phrase}: line {line}: {message}");
            assert!(!message.contains('\n'), "the error is not one sentence: {message}");
        }
        other => panic!("{phrase}: {other:?}"),
    }
}

#[test]
fn both_versions_give_the_same_mesh() {
    let (old, new) = (read(&text(&V2)).unwrap(), read(&text(&V4)).unwrap());
    assert_eq!((old.nodes().len(), old.element_count()), (4, 2));
    // Nodes stay in the order of the file.
    assert_eq!(old.nodes(), [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    assert_eq!(old.boundary("floor").unwrap().nodes(), [0, 2]);
    assert_eq!(new.boundary("floor").unwrap().nodes(), [0, 1]);
    assert_eq!((old.boundaries().len(), new.boundaries().len()), (1, 1));
}

#[test]
fn line_ends_and_blank_lines_do_not_change_the_mesh() {
    assert_eq!(read(&text(&V2).replace('\n', "\r\n")).unwrap(), read(&text(&V2)).unwrap());
    let commented = format!("\u{feff}$Comments\nby hand\n$EndComments\n\n{}\n\n", text(&V4));
    assert_eq!(read(&commented).unwrap(), read(&text(&V4)).unwrap());
}

#[test]
fn faults_of_files_are_reported_with_their_line() {
    let cases = [
        (String::new(), 1, "without a section `$MeshFormat`"),
        ("hello".into(), 1, "this is not a mesh of Gmsh"),
        (text(&V2[8..]), 1, "this is not a mesh of Gmsh"),
        (
            with(&V2, 2, "2.2 1 8"),
            2,
            "the bytes after this line are 24 45 6e 64; in a binary file they must be 01 00 00 00",
        ),
        (with(&V2, 2, "2.2 1 4"), 2, "the data size is 4"),
        (with(&V2, 2, "2.2 2 8"), 2, "the file type is 2; it must be 0 for ASCII or 1 for binary"),
        (text(&["$MeshFormat", "4.1 1 8", "\u{1}"]), 2, "the file ends after this line"),
        (with(&V2, 2, "4 0 8"), 2, "version 4 of the format is not supported; save the mesh in version 4.1 or 2.2"),
        (with(&V2, 2, "3.0 0 8"), 2, "version 3"),
        (with(&V2, 2, "two 0 8"), 2, "is `two`"),
        (with(&V2, 3, "$Nodes"), 3, "`$EndMeshFormat` should stand"),
        (with(&V2, 6, "1 1 floor"), 6, "must stand in quotes"),
        (with(&V2, 6, "1 1 \"\""), 6, "the name of a physical group is empty"),
        (with(&V2, 6, "4 1 \"floor\""), 6, "dimension 4"),
        (with(&V2, 7, "1 1 \"body\""), 7, "named twice"),
        (with(&V2, 6, "1 9 \"floor\""), 6, "`floor` of dimension 1 has no elements"),
        (with(&V2, 7, "3 2 \"body\""), 7, "`body` of dimension 3 has no elements"),
        (with(&V2, 10, "1000000000000"), 10, "1000000000000 nodes are announced"),
        (with(&V2, 10, "5"), 15, "`$EndNodes` stands where node 5 of 5"),
        (with(&V2, 10, "3"), 14, "more in the section than it announces"),
        (with(&V2, 10, "-4"), 10, "the number of nodes is `-4`"),
        (with(&V2, 12, "40 0 nan 0"), 12, "y is NaN; it must be finite"),
        (with(&V2, 12, "40 0 1e999 0"), 12, "y is inf"),
        (with(&V2, 12, "40 0 one 0"), 12, "y is `one`; it must be a number"),
        (with(&V2, 12, "40 0 1"), 12, "the line ends where z should stand"),
        (with(&V2, 12, "40 0 1 0 0"), 12, "one field too many"),
        (with(&V2, 12, "10 0 1 0"), 12, "node 10 is given twice"),
        (with(&V2, 17, "999999999999"), 17, "999999999999 elements are announced"),
        (with(&V2, 17, "6"), 23, "element 6 of 6"),
        (with(&V2, 21, "4 2 2 2 1 10 20 99"), 21, "element 4 names node 99, which does not exist"),
        (with(&V2, 21, "4 2 2 2 1 10 20"), 21, "the line ends where the tag of a node should stand"),
        (with(&V2, 21, "4 2 2 2 1 10 20 30 40"), 21, "`40` is one field too many"),
        (with(&V2, 21, "4 2 99999999999 2 1 10 20 30"), 21, "the line ends where a tag of an element"),
        (with(&V2, 21, "4 93 2 2 1 10 20 30"), 21, "the element type 93 is not supported"),
        (with(&V2, 16, "$Nodes"), 16, "a second section `$Nodes`"),
        (text(&V2[..13]), 13, "the file ends where node 4 of 4"),
        (text(&V2[..15]), 15, "the file ends without a section `$Elements`"),
        (text(&V2[..20]), 20, "the file ends where element 4 of 5"),
        (text(&V2[..22]), 22, "the file ends before `$EndElements`"),
        (text(&V4[..35]), 35, "the file ends before `$EndNodeData`; the section begins in line 35"),
        (with(&V4, 9, "$PartitionedEntities"), 9, "partitioned"),
        (with(&V4, 10, "0 2 1 0"), 13, "number 1 of 1 surfaces"),
        (with(&V4, 12, "7 0 0 0 1 1 0 1 2 0"), 31, "no entity 8 of dimension 2"),
        (with(&V4, 11, "7 0 0 0 1 0 0 99999999999 1 0"), 11, "the line ends where a physical group should stand"),
        (with(&V4, 15, "2 5 10 40"), 15, "5 nodes are announced, but the blocks hold 4"),
        (with(&V4, 15, "1000000000000 4 10 40"), 15, "1000000000000 blocks are announced"),
        (with(&V4, 16, "1 7 0 3"), 19, "`0` is one field too many"),
        (with(&V4, 24, "0 -inf 0"), 24, "y is -inf"),
        (with(&V4, 28, "2 4 1 3"), 28, "4 elements are announced, but the blocks hold 3"),
        (with(&V4, 31, "2 8 2 3"), 34, "element 3 of 3 in the block"),
    ];
    assert!(cases.len() >= 40);
    for (text, line, phrase) in cases {
        check(&text, line, phrase);
    }
}

#[test]
fn a_line_number_counts_blank_lines() {
    check(&format!("\n\n{}", with(&V2, 12, "40 0 one 0")), 14, "`one`");
}

#[test]
fn elements_that_do_not_form_a_body_are_refused_with_their_line() {
    let cases = [
        (with(&V2, 22, "5 3 2 2 1 10 20 30 40"), 22, "mixes 1 three-node triangles, 1 four-node quadrilaterals"),
        (with(&V2, 22, "5 2 2 2 1 10 40 30"), 22, "element 5: the Jacobian determinant is"),
        (with(&V2, 22, "5 2 2 2 1 10 20 10"), 22, "element 5: the Jacobian determinant is 0e0"),
        (with(&V2, 12, "40 0 1 0.5"), 12, "node 40 has z = 0.5"),
        (with(&V2, 19, "2 1 2 1 1 20 40"), 19, "element 2 of the physical group `floor` is not a face of the body"),
        (with(&V2, 19, "2 8 2 1 1 10 20 30"), 19, "one of three-node lines, but the faces of T3 have 2 nodes"),
    ];
    for (text, line, phrase) in cases {
        check(&text, line, phrase);
    }
}

#[test]
fn element_types_that_no_body_supports_are_refused_with_the_reason() {
    let nodes: Vec<String> = (1..=27).map(|tag| format!("{tag} {tag} 0 0")).collect();
    let refused = |number: usize, count: usize, phrase: &str| {
        let element: Vec<String> = (1..=count).map(|tag| tag.to_string()).collect();
        let text = format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n27\n{}\n$EndNodes\n$Elements\n1\n1 {number} 2 0 1 {}\n\
             $EndElements\n",
            nodes.join("\n"),
            element.join(" ")
        );
        check(&text, if number == 15 { 37 } else { 36 }, phrase);
    };
    refused(12, 27, "quadratic bricks must have 20 nodes (in Gmsh, `Mesh.SecondOrderIncomplete = 1`)");
    refused(10, 9, "`Mesh.SecondOrderIncomplete = 1`");
    refused(6, 6, "six-node prisms are refused");
    refused(7, 5, "five-node pyramids are refused");
    refused(8, 3, "a bar element must have two nodes");
    refused(15, 1, "no elements beyond points");
}

#[test]
fn a_mesh_whose_elements_are_all_clockwise_is_reoriented() {
    let turned = with(&V2, 21, "4 2 2 2 1 30 20 10").replace("5 2 2 2 1 10 30 40", "5 2 2 2 1 40 30 10");
    let mesh = read(&turned).unwrap();
    let area = |nodes: &[usize]| {
        let [a, b, c] = [0, 1, 2].map(|corner| mesh.nodes()[nodes[corner]]);
        (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
    };
    assert!(mesh.elements().all(|nodes| area(nodes) == 1.0));
    let quadratic = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n1 0 0 0\n2 0 2 0\n3 2 2 0\n4 2 0 0\n5 0 1 0\n\
                     6 1 2 0\n7 2 1 0\n8 1 0 0\n$EndNodes\n$Elements\n2\n1 16 2 0 1 1 2 3 4 5 6 7 8\n\
                     2 8 2 3 1 1 4 8\n$EndElements\n";
    let mesh = read(quadratic).unwrap();
    assert_eq!(mesh.elements().next().unwrap(), [0, 3, 2, 1, 7, 6, 5, 4]);
    // A group without a name gets its number as name.
    assert_eq!(mesh.boundary("3").unwrap().nodes(), [0, 7, 3]);
}

#[test]
fn a_plane_mesh_may_have_any_height_and_is_scaled() {
    let high = text(&V2).replace(" 0 0 0\n", " 0 0 7\n").replace("0 1 0\n2", "0 1 7\n2");
    let high = high.replace("20 1 0 0", "20 1 0 7").replace("30 1 1 0", "30 1 1 7");
    let mesh = GmshFile::parse(&high, "high.msh").unwrap().mesh(&[], 1e-3).unwrap();
    assert_eq!(mesh.nodes()[3], [1e-3, 1e-3, 0.0]);
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = GmshFile::parse(text(&V2).as_str(), "x").unwrap().mesh(&[], scale).unwrap_err();
        assert!(matches!(error, Error::Linear(qp::LinearError::Setting { name: "scale", .. })), "{error}");
    }
}

#[test]
fn an_unknown_group_is_refused_with_the_names_of_the_existing_ones() {
    let file = GmshFile::parse(text(&V2), "x").unwrap();
    let message = file.mesh(&["bulk"], 1.0).unwrap_err().to_string();
    assert!(message.contains("no physical group `bulk`") && message.contains("floor, body"), "{message}");
    assert_eq!(file.mesh(&["body"], 1.0).unwrap(), file.mesh(&[], 1.0).unwrap());
}

#[test]
fn a_file_cut_at_any_byte_is_an_error_and_never_a_panic() {
    for whole in [text(&V2), text(&V4)] {
        let end = whole.find("$EndElements").unwrap();
        for cut in 0..end {
            assert!(read(&whole[..cut]).is_err(), "cut at {cut}");
        }
        // Replaces every byte: the result is an error or a mesh, never a panic.
        for place in 0..whole.len() {
            for byte in ["0", "$", "-", "\n", "9", "\""] {
                let mut changed = whole.clone();
                changed.replace_range(place..=place, byte);
                let _ = read(&changed);
            }
        }
    }
}
