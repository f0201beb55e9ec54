//! Problem directories: written files are read back bit by bit, and every fault of a file is reported with its line.

use std::fs;
use std::path::Path;

use signorini::{qp, solve_qp};
use support::oracles::{Draws, random};

fn write(folder: &Path, files: &[(&str, String)]) {
    files.iter().for_each(|(name, text)| fs::write(folder.join(name), text).unwrap());
}

#[test]
fn written_problems_and_answers_are_read_back_bit_by_bit() {
    let mut draws = Draws::new(6);
    for _ in 0..20 {
        let folder = tempfile::tempdir().unwrap();
        let mut dense = random(&mut draws, 5, 4);
        dense.gap[2] = f64::INFINITY;
        dense.load[0] = 1e-310;
        let problem = dense.problem().unwrap();
        let texts: Vec<_> = problem.files().iter().map(|file| (file.name, file.text())).collect();
        write(folder.path(), &texts);
        assert_eq!(qp::read_problem(folder.path()).unwrap(), problem);
        let solution = solve_qp(&problem).unwrap();
        write(folder.path(), &solution.files());
        assert_eq!(qp::read_vector(&folder.path().join("u.mtx")).unwrap(), solution.displacement);
        assert_eq!(qp::read_vector(&folder.path().join("lambda.mtx")).unwrap(), solution.multiplier);
    }
}

#[test]
fn files_of_other_programs_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let files = [
        // Both triangles, capitals, comments, blank lines, trailing spaces, integers, a plus sign.
        (
            "K.mtx",
            "%%MatrixMarket MATRIX Coordinate Real General\n% a comment\n\n2 2 4\n1 1 3\n2 1 -1 \n1 2 -1e0\n2 2 +1.0\n",
        ),
        ("f.mtx", "%%MatrixMarket matrix coordinate integer general\n2 1 1\n2 1 3\n"),
        ("B.mtx", "%%MatrixMarket matrix array real general\n1 2\n0\n1\n"),
        ("g.mtx", "%%MatrixMarket matrix array real general\n1 1\nInfinity\n"),
    ];
    write(folder.path(), &files.map(|(name, text)| (name, text.to_string())));
    let problem = qp::read_problem(folder.path()).unwrap();
    assert_eq!((problem.load(), problem.gap()), (&[0.0, 3.0][..], &[f64::INFINITY][..]));
    assert_eq!(problem.stiffness().mul(&[1.0, 1.0]), [2.0, 0.0]);
}

#[test]
fn faults_are_reported_with_their_line_and_what_is_allowed() {
    let symmetric = "%%MatrixMarket matrix coordinate real symmetric\n";
    let cases = [
        ("", 1, "the file is empty"),
        ("hello\n", 1, "the first line is `hello`"),
        ("%%MatrixMarket matrix coordinate complex general\n1 1 0\n", 1, "the field is `complex`"),
        ("%%MatrixMarket matrix coordinate real hermitian\n1 1 0\n", 1, "the symmetry is `hermitian`"),
        ("%%MatrixMarket matrix dense real general\n1 1 0\n", 1, "the layout is `dense`"),
        (symmetric, 1, "the line with the sizes is missing"),
        (&format!("{symmetric}2 2\n"), 2, "3 whole numbers"),
        (&format!("{symmetric}2 -2 1\n"), 2, "the sizes are `2 -2 1`"),
        (&format!("{symmetric}2 3 0\n"), 2, "must be square, not 2 x 3"),
        (&format!("{symmetric}1000000000000 1000000000000 0\n"), 2, "is too large"),
        (&format!("{symmetric}% c\n2 2 1\n3 1 1.0\n"), 4, "entry (3, 1) lies outside 2 x 2"),
        (&format!("{symmetric}2 2 1\n0 1 1.0\n"), 3, "indices from 1"),
        (&format!("{symmetric}2 2 1\n1 2 1.0\n"), 3, "lies above the diagonal"),
        (&format!("{symmetric}2 2 1\n1 1 one\n"), 3, "`1 1 one` is not an entry"),
        (&format!("{symmetric}2 2 1\n1 1\n"), 3, "it must be `row column value`"),
        (&format!("{symmetric}2 2 3\n1 1 1.0\n2 2 1.0\n"), 4, "ends after 2 of 3 entries"),
        (&format!("{symmetric}2 2 99999999999999\n1 1 1.0\n"), 3, "ends after 1 of 99999999999999 entries"),
        (&format!("{symmetric}2 2 1\n1 1 1.0\n2 2 1.0\n"), 4, "more entries than the 1 announced"),
        ("%%MatrixMarket matrix array real general\n2 1\n1.0\n", 3, "before the value of (2, 1)"),
        ("%%MatrixMarket matrix array real general\n1 1\n1.0\n2.0\n", 4, "more values than the 1 x 1 announced"),
    ];
    for (text, expected_line, phrase) in cases {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), &[("K.mtx", text.to_string())]);
        match qp::read_problem(folder.path()) {
            Err(qp::Error::Linear(qp::LinearError::FileSyntax { line, message, .. })) => {
                assert!(line == expected_line && message.contains(phrase), "{text:?}: line {line}: {message}");
            }
            other => panic!("{text:?}: {other:?}"),
        }
    }
}

#[test]
fn a_missing_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let message = qp::read_problem(folder.path()).unwrap_err().to_string();
    assert!(message.starts_with("cannot read ") && message.contains("neither K.mtx nor K.petsc"), "{message}");
}
