//! Directories of complementarity problems: what is read, and random damage to every file, which ends with an answer or
//! with one sentence.
#![expect(clippy::disallowed_methods, reason = "a panic is a finding")]

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use signorini::lcp::{Error, Lcp, solve_lcp};
use signorini::{Failure, Settings};
use support::draws::Draws;
use support::fuzz::damage::damaged;
use support::program::says;
use support::{cases, seed};

fn write(desk: &Path, files: &[(&str, String)]) {
    for name in ["M.mtx", "q.mtx", "lower.mtx", "upper.mtx"] {
        let _ = fs::remove_file(desk.join(name));
    }
    files.iter().for_each(|(name, text)| fs::write(desk.join(name), text).unwrap());
}

fn array(columns: usize, values: &[String]) -> String {
    let rows = values.len() / columns.max(1);
    format!("%%MatrixMarket matrix array real general\n{rows} {columns}\n{}\n", values.join("\n"))
}

#[test]
fn a_symmetric_file_has_both_triangles_and_bounds_from_1e20_on_are_none() {
    let desk = tempfile::tempdir().unwrap();
    let symmetric = "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 2\n2 1 -1\n2 2 2\n";
    let words = |words: &[&str]| array(1, &words.iter().map(ToString::to_string).collect::<Vec<_>>());
    let bounds = [("lower.mtx", words(&["-inf", "-1e20"])), ("upper.mtx", words(&["1e30", "3"]))];
    let files = [("M.mtx", symmetric.to_string()), ("q.mtx", words(&["-1", "3"]))];
    write(desk.path(), &files);
    let lcp = Lcp::read(desk.path()).unwrap();
    assert_eq!(lcp.matrix().triplets().collect::<Vec<_>>(), [(0, 0, 2.0), (1, 0, -1.0), (0, 1, -1.0), (1, 1, 2.0)]);
    assert_eq!((lcp.lower(), lcp.upper()), (&[0.0; 2][..], &[f64::INFINITY; 2][..]));
    write(desk.path(), &[files, bounds].concat());
    let lcp = Lcp::read(desk.path()).unwrap();
    assert_eq!((lcp.lower(), lcp.upper()), (&[f64::NEG_INFINITY; 2][..], &[f64::INFINITY, 3.0][..]));
}

#[test]
fn wrong_files_are_refused_with_the_fault() {
    let desk = tempfile::tempdir().unwrap();
    let unit = "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 1\n2 2 1\n".to_string();
    let words = |words: &[&str]| array(1, &words.iter().map(ToString::to_string).collect::<Vec<_>>());
    let (m, q) = (("M.mtx", unit), ("q.mtx", words(&["-1", "1"])));
    let wide = ("M.mtx", "%%MatrixMarket matrix coordinate real general\n2 3 1\n1 1 1\n".to_string());
    let huge = ("M.mtx", "%%MatrixMarket matrix coordinate real general\n99999999 99999999 1\n1 1 1\n".to_string());
    let twice = "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 1e308\n1 1 1e308\n";
    for (files, phrases) in [
        (vec![q.clone()], &["cannot read", "M.mtx"][..]),
        (vec![m.clone()], &["cannot read", "q.mtx"]),
        (vec![wide, q.clone()], &["matrix M of the LCP"]),
        (vec![huge, q.clone()], &["M.mtx", "almost empty"]),
        (vec![("M.mtx", twice.to_string()), q.clone()], &["M"]),
        (vec![m.clone(), ("q.mtx", words(&["-1"]))], &["matrix M of the LCP"]),
        (vec![m.clone(), ("q.mtx", words(&["-1", "inf"]))], &["q.mtx:4", "inf", "finite"]),
        (vec![m.clone(), q.clone(), ("lower.mtx", words(&["0"]))], &["lower bound has length 1"]),
        (vec![m.clone(), q.clone(), ("upper.mtx", words(&["1", "nan"]))], &["upper.mtx:4", "NaN"]),
        (vec![m.clone(), q.clone(), ("upper.mtx", words(&["1", "-1"]))], &["unknown 1", "0e0 and -1e0"]),
        (vec![m.clone(), q.clone(), ("lower.mtx", words(&["inf", "0"]))], &["unknown 0", "inf"]),
    ] {
        write(desk.path(), &files);
        let error = Lcp::read(desk.path()).unwrap_err();
        assert_eq!(error.failure(), Failure::BadInput);
        says(&error.to_string(), phrases);
    }
}

/// A number in the words of a file: small, extreme, or not finite.
fn number(draws: &mut Draws) -> String {
    const WORDS: [&str; 12] = [
        "0",
        "-0",
        "1e300",
        "-1e300",
        "5e-324",
        "1e20",
        "-1e20",
        "1e-20",
        "1.7976931348623157e308",
        "inf",
        "nan",
        "1e999",
    ];
    match draws.below(400) {
        word if word < WORDS.len() => WORDS[word].to_string(),
        exponent if exponent < 32 => format!("{:e}", draws.signed() * 10_f64.powi(3 * exponent as i32 - 48)),
        _ => (draws.below(9) as f64 - 4.0).to_string(),
    }
}

/// Random files of at most six unknowns, most of them of fitting sizes; then perhaps changed in some bytes.
fn files(draws: &mut Draws) -> Vec<(&'static str, String)> {
    let n = draws.below(7);
    let size = |draws: &mut Draws| if draws.below(25) == 0 { draws.below(8) } else { n };
    let numbers = |draws: &mut Draws, count: usize| (0..count).map(|_| number(draws)).collect::<Vec<_>>();
    let (rows, columns) = (size(draws), size(draws));
    let kind = if draws.below(3) == 0 { "symmetric" } else { "general" };
    let entries: Vec<(usize, usize)> = (0..columns).flat_map(|j| (0..rows).map(move |i| (i, j))).collect();
    let entries: Vec<_> = entries.into_iter().filter(|(i, j)| kind == "general" || i >= j).collect();
    let kept: Vec<_> = entries.into_iter().filter(|(i, j)| i == j || draws.below(3) > 0).collect();
    let lines: Vec<String> = kept.iter().map(|(i, j)| format!("{} {} {}\n", i + 1, j + 1, number(draws))).collect();
    let matrix =
        format!("%%MatrixMarket matrix coordinate real {kind}\n{rows} {columns} {}\n{}", lines.len(), lines.concat());
    let mut files = vec![("M.mtx", matrix)];
    for name in ["q.mtx", "lower.mtx", "upper.mtx"] {
        if name == "q.mtx" || draws.below(3) == 0 {
            let length = size(draws);
            files.push((name, array(1, &numbers(draws, length))));
        }
    }
    if draws.below(3) == 0 {
        let file = draws.below(files.len());
        files[file].1 = String::from_utf8_lossy(&damaged(draws, files[file].1.as_bytes())).into_owned();
    }
    files
}

#[test]
fn hostile_files_end_with_an_answer_or_with_one_sentence() {
    let desk = tempfile::tempdir().unwrap();
    let mut draws = Draws(seed(76));
    let mut ends = std::collections::BTreeMap::<&str, usize>::new();
    let (count, mut slowest) = (cases(400, 10_000), 0.0_f64);
    for number in 0..count {
        let before = draws.0;
        let files = files(&mut draws);
        write(desk.path(), &files);
        let clock = std::time::Instant::now();
        let solved = catch_unwind(AssertUnwindSafe(|| {
            Lcp::read(desk.path()).and_then(|lcp| solve_lcp(&lcp, &Settings::default()).map(|found| (lcp, found)))
        }));
        slowest = slowest.max(clock.elapsed().as_secs_f64());
        let place = format!("case {number}, the first of seed {before}: {files:?}");
        let end = match solved.unwrap_or_else(|_| panic!("a panic: {place}")) {
            Ok((lcp, found)) => {
                let inside = |i: usize| lcp.lower()[i] <= found.z[i] && found.z[i] <= lcp.upper()[i];
                assert!(found.worst().1 <= 1e-9 && (0..lcp.unknowns()).all(inside), "{found:?}, {place}");
                "certified"
            }
            Err(error) => {
                let sentence = signorini::output::printable(&error.to_string());
                let is_one = sentence.len() > 10 && sentence.len() < 2000 && !sentence.chars().any(char::is_control);
                assert!(is_one, "{sentence:?}, {place}");
                if let Error::NotCertified { solution, .. } = &error {
                    assert!(solution.worst().1 > 1e-9, "{place}");
                }
                error.code()
            }
        };
        *ends.entry(end).or_default() += 1;
    }
    println!("{count} directories, the slowest {slowest:.3} s: {ends:?}");
    assert!(ends["certified"] * 10 > count && ends.contains_key("file-syntax") && ends.contains_key("infeasible"));
}
