//! Every variant of the one error is provoked, with its code and one sentence.

use signorini::{
    Condense, ContactProblem, Error, Method, Penalty, Prepared, Scene, Settings, SparseMatrix, SymmetricMatrix, lcp,
    solve, solve_qp,
};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use signorini::fem::{ClosedSurface, GmshFile};
use signorini::qp::{self, read_problem};
use signorini::scene::Answer;
use signorini::study::Sweep;
use support::oracles::Dense;

use crate::documents::read;
use crate::sources::root;

/// A spring of this stiffness under a load of 2, with walls at these distances in the directions of `rows`.
fn spring(stiffness: f64, rows: &[f64], gap: &[f64]) -> Result<ContactProblem, qp::Error> {
    let rows: Vec<&[f64]> = rows.iter().map(std::slice::from_ref).collect();
    Dense::new(&[&[stiffness]], &[2.0], &rows, gap).problem()
}

/// Three hundred unknowns with an upper limit each, of which one has stiffness.
fn linear_program() -> Result<ContactProblem, qp::Error> {
    let limits: Vec<(usize, usize, f64)> = (0..300).map(|dof| (dof, dof, 1.0)).collect();
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(300, 300, &[(0, 0, 1.0)])?)?;
    ContactProblem::new(stiffness, vec![1.0; 300], SparseMatrix::from_triplets(300, 300, &limits)?, vec![1.0; 300])
}

fn settings(change: impl Fn(&mut Settings)) -> Settings {
    let mut settings = Settings::default();
    change(&mut settings);
    settings
}

fn scene(change: (&str, &str)) -> Result<Scene, Error> {
    let text = read("tests/faults/plane.json");
    assert!(text.contains(change.0));
    Scene::from_json(&text.replacen(change.0, change.1, 1), "plane.json")
}

/// The code of each variant, the name of the variant, and such an error.
fn provoked() -> Result<BTreeMap<&'static str, (&'static str, Error)>, Error> {
    let spring_and_wall = spring(1.0, &[1.0], &[0.5])?;
    let matrix = |entries: &[(usize, usize, f64)]| SparseMatrix::from_triplets(2, 2, entries);
    let not_square = SparseMatrix::from_triplets(1, 2, &[]);
    let nowhere = Path::new("nowhere");
    let unprepared = Prepared::new(&spring_and_wall, &Settings::default().with_condensation(Condense::Never))?;
    // Oblique rows that share many dofs are not turned into bounds.
    let unit: Vec<Vec<f64>> = (0..30).map(|i| (0..30).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    let unit: Vec<&[f64]> = unit.iter().map(|row| &row[..]).collect();
    let numbers: Vec<f64> = (1..=30).map(f64::from).collect();
    let squares: Vec<f64> = numbers.iter().map(|number| number * number).collect();
    let oblique = Dense::new(&unit, &[2.0; 30], &[&[1.0; 30], &numbers, &squares], &[0.5; 3]).problem()?;
    // The last bit of one entry holds a motion that the load drives.
    let soft: [&[f64]; 2] = [&[1.0, -1.0], &[-1.0, 1.0 + f64::EPSILON]];
    let held_within_rounding = Dense::new(&soft, &[1.0, 1.0], &[&[0.0, -1.0]], &[0.5]).problem()?;
    let plane = scene(("[4]", "[4]"))?.build()?;
    let soft = Arc::new(scene(("\"young\": 1000", "\"young\": 1"))?.build()?);
    let beyond = Answer::of(soft.clone(), &solve_qp(soft.problem())?);
    let refused = solve(plane.problem(), &Settings::default().with_memory(1.0)).unwrap_err();
    let qp::Error::NoRoom { factor, .. } = refused else { panic!("{refused}") };
    // One solve has room, a thousand answers have none.
    let for_one = Settings::default().with_memory(factor + 1e5);
    let still = unprepared.path(&[0.5], &[0.4]);
    let hasty = Prepared::new(&spring_and_wall, &Settings::default().with_time(Duration::ZERO));
    let stopped = Settings::default();
    stopped.watch.stop();
    let never = Settings::with_method(Method::Penalty(Penalty { last: 1.0, ..Penalty::default() }));
    Ok(BTreeMap::from([
        ("Length", ("length", spring_and_wall.with_load(vec![1.0, 2.0]).unwrap_err().into())),
        ("Shape", ("shape", SymmetricMatrix::from_full(&not_square?).unwrap_err().into())),
        ("IndexOutOfRange", ("index-out-of-range", matrix(&[(2, 0, 1.0)]).unwrap_err().into())),
        ("Pattern", ("pattern", SparseMatrix::from_csc(2, vec![0, 2], vec![1, 0], vec![1.0, 1.0]).unwrap_err().into())),
        ("NotFinite", ("not-finite", spring(1.0, &[1.0], &[f64::NAN]).unwrap_err().into())),
        ("NotSymmetric", ("not-symmetric", SymmetricMatrix::from_full(&matrix(&[(0, 1, 1.0)])?).unwrap_err().into())),
        ("NotConvex", ("not-convex", spring(-1.0, &[1.0], &[0.5]).unwrap_err().into())),
        ("Infeasible", ("infeasible", solve_qp(&spring(1.0, &[1.0, -1.0], &[0.5, -0.6])?).unwrap_err().into())),
        ("Unbounded", ("unbounded", solve_qp(&spring(0.0, &[-1.0], &[0.5])?).unwrap_err().into())),
        (
            "UnderHeld",
            ("under-held", solve_qp(&spring(0.0, &[1.0], &[0.5])?.with_load(vec![0.0])?).unwrap_err().into()),
        ),
        ("NearlyLinear", ("nearly-linear", solve_qp(&linear_program()?).unwrap_err().into())),
        ("Undecided", ("undecided", solve_qp(&held_within_rounding).unwrap_err().into())),
        ("OutOfTime", ("out-of-time", hasty.map(drop).unwrap_err().into())),
        ("NotCertified", ("not-certified", solve(&spring_and_wall, &never).unwrap_err().into())),
        ("Interrupted", ("interrupted", solve(&spring_and_wall, &stopped).unwrap_err().into())),
        ("NoRoom", ("too-large", solve(&spring_and_wall, &Settings::default().with_memory(1.0)).unwrap_err().into())),
        (
            "Setting",
            ("setting", solve(&spring_and_wall, &settings(|settings| settings.threads = Some(0))).unwrap_err().into()),
        ),
        ("NotCondensed", ("not-condensed", still.map(drop).unwrap_err().into())),
        ("BeyondSmallDisplacements", ("beyond-small-displacements", beyond.map(drop).unwrap_err())),
        ("TooLarge", ("too-large", scene(("[4]", "[4000]"))?.check_size(1e3).unwrap_err())),
        ("TooManyAnswers", ("too-large", Sweep::over_gaps(&plane, &[0.0; 1000], &for_one).unwrap_err())),
        ("Numerical", ("numerical", solve(&oblique, &Settings::with_method(Method::Mprgp)).unwrap_err().into())),
        ("Mesh", ("mesh", gmsh_of_another_body())),
        ("SceneSyntax", ("scene", Scene::from_json("{", "plane.json").map(drop).unwrap_err())),
        ("Scene", ("scene", scene(("\"bottom\"", "\"below\""))?.build().map(drop).unwrap_err())),
        ("FileSyntax", ("file-syntax", GmshFile::parse("", "square.msh").map(drop).unwrap_err().into())),
        ("FileBytes", ("file-syntax", empty_surface())),
        ("File", ("file", read_problem(nowhere).unwrap_err().into())),
    ]))
}

/// The error of a surface file without triangles.
fn empty_surface() -> Error {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("die.stl");
    fs::write(&file, "").unwrap();
    ClosedSurface::read(&file, 1.0, [0.0; 3]).map(drop).unwrap_err().into()
}

/// The error of a mesh file without the requested group.
fn gmsh_of_another_body() -> Error {
    GmshFile::read(root().join("tests/faults/square4.msh"))
        .and_then(|file| file.mesh(&["another"], 1.0))
        .map(drop)
        .unwrap_err()
        .into()
}

/// The variants with their codes, as the table of `Error::code` lists them.
fn variants() -> BTreeMap<String, String> {
    let text = ["linear", "qp", "fem", "mechanics"].map(|name| read(&format!("crates/{name}/src/error.rs"))).concat();
    let arms = text.lines().filter(|line| line.trim().starts_with("Error::"));
    let arms = arms.filter_map(|line| {
        let (patterns, class) = line.trim().split_once(" => ")?;
        // The code is the first string literal.
        Some((patterns, class.split('"').nth(1)?))
    });
    arms.flat_map(|(patterns, code)| patterns.split(" | ").map(move |pattern| (pattern, code)))
        .map(|(pattern, code)| (pattern.trim_start_matches("Error::").trim_end_matches(" { .. }"), code))
        .map(|(variant, code)| (variant.to_string(), code.to_string()))
        .collect()
}

#[test]
fn every_variant_is_provoked_with_its_code_and_one_sentence() {
    let (variants, provoked) = (variants(), provoked().unwrap());
    assert!(variants.len() >= 22);
    let known: BTreeSet<&str> = variants.keys().map(String::as_str).collect();
    assert_eq!(known, provoked.keys().copied().collect(), "a variant is not provoked, or does not exist");
    for (variant, (code, error)) in provoked {
        // The errors of other crates come in their wrapping.
        let named = format!("{error:?}");
        assert_eq!(
            named
                .trim_start_matches("Qp(")
                .trim_start_matches("Fem(")
                .trim_start_matches("Linear(")
                .split([' ', ')'])
                .next(),
            Some(variant),
            "{error:?}"
        );
        assert_eq!((error.code(), variants[variant].as_str()), (code, code), "{error}");
        let sentence = error.to_string();
        assert!(sentence.len() > 20 && sentence.lines().count() == 1 && !sentence.contains("  "), "{sentence:?}");
    }
}

/// The errors of complementarity problems, which `signorini::lcp` has beside those of the quadratic program.
#[test]
fn every_error_of_a_complementarity_problem_has_its_code_and_one_sentence() {
    let problem = |entries: &[(usize, usize, f64)], offset: &[f64]| {
        let matrix = SparseMatrix::from_triplets(offset.len(), offset.len(), entries)?;
        lcp::Lcp::nonnegative(matrix, offset.to_vec())
    };
    let solve = |entries: &[(usize, usize, f64)], offset: &[f64], change: &dyn Fn(&mut Settings)| {
        let mut settings = Settings::default();
        change(&mut settings);
        lcp::solve_lcp(&problem(entries, offset)?, &settings)
    };
    // Met by z = (1, 1), which has z'w > 0; no pivot may lead there.
    let open = [(0, 0, -1.0), (0, 1, 2.0), (1, 0, 2.0), (1, 1, -1.0)];
    let lost = [(0, 0, -2.0), (0, 1, 1.0), (1, 1, 1.0)];
    let thirds = [(0, 0, 3.0), (0, 1, 0.1), (1, 0, 0.7), (1, 1, 0.3)];
    let text = read("crates/lcp/src/error.rs");
    for (variant, code, error) in [
        ("Qp", "length", problem(&[], &[]).and_then(|empty| empty.certify(&[0.0])).unwrap_err()),
        ("Bounds", "bounds", {
            let unit = SparseMatrix::from_triplets(1, 1, &[(0, 0, 1.0)]).unwrap();
            lcp::Lcp::new(unit, vec![0.0], vec![1.0], vec![0.0]).unwrap_err()
        }),
        ("Infeasible", "infeasible", solve(&[(0, 0, -1.0)], &[-1.0], &|_| {}).unwrap_err()),
        ("NotFound", "not-found", solve(&lost, &[-1.0, 1.0], &|_| {}).unwrap_err()),
        ("NotCertified", "not-certified", {
            solve(&thirds, &[-0.1, -0.7], &|settings| settings.tolerance = Some(1e-40)).unwrap_err()
        }),
        ("TooLarge", "too-large", solve(&open, &[-1.0, -1.0], &|settings| settings.memory = Some(1.0)).unwrap_err()),
    ] {
        assert!(text.contains(&format!("Error::{variant}")), "{variant}");
        assert!(format!("{error:?}").starts_with(variant) && error.code() == code, "{variant}: {error:?}");
        let sentence = error.to_string();
        assert!(sentence.len() > 20 && sentence.lines().count() == 1 && !sentence.contains("  "), "{sentence:?}");
    }
}
