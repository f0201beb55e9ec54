//! Files: `.vtu` text, and writing that never produces incomplete files.

use signorini_qp as qp;
use std::path::Path;

use super::Indented;
use crate::Array;
use crate::Drawing;
use crate::Unstructured;
use crate::write_atomically;
use resvg::usvg::roxmltree::Document;
use signorini_mechanics::Error;
use signorini_mechanics::fem::ElementKind;

fn numbers(document: &Document, name: &str) -> Vec<f64> {
    let array = document.descendants().find(|node| node.attribute("Name") == Some(name)).expect(name);
    array.text().unwrap_or_default().split_whitespace().map(|word| word.parse().expect("a number")).collect()
}

#[test]
fn vtu_files_contain_mesh_and_data_bit_by_bit() {
    let body = Indented::new([1.0, 0.5], [2, 1]);
    let mut elements = body.elements.clone();
    elements[1] = vec![1, 2, 5];
    let closed = vec![false, false, false, true, true, false];
    let thirds: Vec<f64> = (0..6).map(|k| f64::from(k) / 3.0 * 1e-7).collect();
    let areas = [0.25, 0.125];
    let space: Vec<[f64; 3]> = body.nodes.iter().map(|&[x, y]| [x, y, x - y]).collect();
    let moved: Vec<f64> = body.displacement.chunks(2).flat_map(|pair| [pair[0], pair[1], -pair[0]]).collect();
    let vtu = Unstructured {
        nodes: &space,
        elements: &elements,
        cell_types: &[ElementKind::Q4, ElementKind::T3],
        point_data: &[
            Array::Vectors("displacement", &moved),
            Array::Scalars("pressure <&>", &thirds),
            Array::Flags("contact", &closed),
        ],
        cell_data: &[Array::Scalars("area", &areas)],
    }
    .to_vtu()
    .unwrap();
    let document = Document::parse(&vtu).expect("well-formed XML");
    let piece = document.descendants().find(|node| node.has_tag_name("Piece")).expect("a piece");
    assert_eq!((piece.attribute("NumberOfPoints"), piece.attribute("NumberOfCells")), (Some("6"), Some("2")));
    assert_eq!(numbers(&document, "connectivity"), [0.0, 1.0, 4.0, 3.0, 1.0, 2.0, 5.0]);
    assert_eq!(numbers(&document, "offsets"), [4.0, 7.0]);
    assert_eq!(numbers(&document, "types"), [9.0, 5.0]);
    assert_eq!(numbers(&document, "pressure <&>"), thirds);
    assert_eq!(numbers(&document, "contact"), [0.0, 0.0, 0.0, 1.0, 1.0, 0.0]);
    assert_eq!(numbers(&document, "area"), areas);
    for (name, expected) in [("Points", space.as_flattened()), ("displacement", &moved)] {
        assert_eq!(numbers(&document, name), expected);
    }
}

#[test]
fn vtu_files_that_readers_would_misread_are_refused() {
    let body = Indented::new([1.0, 0.5], [1, 1]);
    let nodes: Vec<[f64; 3]> = body.nodes.iter().map(|&[x, y]| [x, y, 0.0]).collect();
    let cell_types = &[ElementKind::Q4];
    let good = Unstructured { nodes: &nodes, elements: &body.elements, cell_types, point_data: &[], cell_data: &[] };
    assert!(good.to_vtu().is_ok());
    let values = [1.0, f64::NAN, 0.0, 0.0];
    let sentence =
        Unstructured { point_data: &[Array::Scalars("gap", &values)], ..good }.to_vtu().unwrap_err().to_string();
    assert!(sentence.contains("entry 1 of `gap`") && sentence.contains("NaN"), "{sentence}");
    let short = Unstructured { point_data: &[Array::Vectors("u", &values)], ..good };
    assert!(matches!(short.to_vtu(), Err(Error::Linear(qp::LinearError::Length { found: 4, expected: 12, .. }))));
    let short = Unstructured { cell_data: &[Array::Flags("dead", &[])], ..good };
    assert!(matches!(short.to_vtu(), Err(Error::Linear(qp::LinearError::Length { found: 0, expected: 1, .. }))));
    for (elements, value) in [([vec![0, 1, 2, 3, 0]], 5.0), ([vec![0, 1]], 2.0), ([vec![0, 1, 4, 3]], 4.0)] {
        match (Unstructured { elements: &elements, ..good }).to_vtu() {
            Err(Error::Linear(qp::LinearError::Setting { value: found, .. })) => assert_eq!(found, value),
            other => panic!("{elements:?} gave {other:?}"),
        }
    }
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = entries.collect();
    names.sort();
    names
}

#[test]
fn a_picture_is_written_as_svg_and_png_into_a_new_folder_without_other_files() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("a/b");
    let drawing = Drawing::new(30.0, 20.0);
    let [svg, png] = drawing.write(&folder, "gap 1").unwrap();
    assert_eq!(names(&folder), ["gap 1.png", "gap 1.svg"]);
    assert_eq!(std::fs::read_to_string(svg).unwrap(), drawing.svg());
    assert_eq!(std::fs::read(png).unwrap(), drawing.png(1.0).unwrap());
    drawing.write(&folder, "gap 1").unwrap();
    assert_eq!(names(&folder).len(), 2);
}

#[test]
fn a_written_file_replaces_an_older_one_completely() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("result.vtu");
    write_atomically(&path, &[b'x'; 100_000]).unwrap();
    write_atomically(&path, b"short").unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), b"short");
    assert_eq!(names(folder.path()), ["result.vtu"]);
}

#[cfg(unix)]
#[test]
fn written_files_have_the_permissions_of_ordinary_files() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let [plain, ours] = ["plain", "ours"].map(|name| folder.path().join(name));
    std::fs::write(&plain, b"").unwrap();
    write_atomically(&ours, b"").unwrap();
    let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&ours), mode(&plain));
}

#[test]
fn a_failed_write_is_reported_with_its_path_and_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let occupied = folder.path().join("file");
    std::fs::write(&occupied, b"kept").unwrap();
    // A file where a folder should be, and a folder where a file should be; both are refused even for an administrator.
    let refused = |path: &Path, sentence: String| {
        let error = write_atomically(path, b"lost").unwrap_err();
        assert!(
            matches!(error, Error::Linear(qp::LinearError::File { .. })) && error.to_string().starts_with(&sentence),
            "{error}"
        );
    };
    refused(&occupied.join("picture.svg"), format!("cannot make the folder {}: there is a file", occupied.display()));
    refused(folder.path(), format!("cannot write {}: ", folder.path().display()));
    assert_eq!(std::fs::read(&occupied).unwrap(), b"kept");
    assert_eq!(names(folder.path()), ["file"]);
    assert!(Drawing::new(3.0, 3.0).write(&occupied, "picture").is_err());
}
