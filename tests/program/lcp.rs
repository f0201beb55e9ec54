//! `solve`, `compare` and `verify` on the directories of complementarity problems: reports, exit codes, refusals.

use crate::promised::has;
use serde_json::Value;
use support::draws::Draws;
use support::program::{Desk, Problem, matrix, vector};

/// Writes the directory of a problem: rows of M, q, and bounds by their names.
fn lcp(desk: &Desk, name: &str, rows: &[&[&str]], q: &[&str], bounds: &[(&str, &[&str])]) {
    let entries: Vec<String> = rows
        .iter()
        .enumerate()
        .flat_map(|(i, row)| row.iter().enumerate().map(move |(j, value)| format!("{} {} {value}\n", i + 1, j + 1)))
        .collect();
    let size = rows.len();
    let text =
        format!("%%MatrixMarket matrix coordinate real general\n{size} {size} {}\n{}", entries.len(), entries.concat());
    desk.write(&format!("{name}/M.mtx"), text);
    desk.write(&format!("{name}/q.mtx"), vector(q));
    bounds.iter().for_each(|(file, values)| desk.write(&format!("{name}/{file}.mtx"), vector(values)));
}

/// Problems by the class of M, each with its only or its first solution.
fn classes(desk: &Desk) {
    lcp(desk, "symmetric", &[&["2", "-1"], &["-1", "2"]], &["-1", "3"], &[]);
    lcp(desk, "semidefinite", &[&["1", "-1"], &["-1", "1"]], &["1", "1"], &[]);
    lcp(desk, "h-matrix", &[&["2", "-1"], &["0", "1"]], &["-1", "-1"], &[("upper", &["1", "inf"])]);
    lcp(desk, "monotone", &[&["0", "1"], &["-1", "0"]], &["-1", "2"], &[]);
    lcp(desk, "p-matrix", &[&["1", "3", "0"], &["0", "1", "3"], &["3", "0", "1"]], &["-1", "-1", "-1"], &[]);
    lcp(desk, "general", &[&["1", "2"], &["2", "1"]], &["-1", "-1"], &[]);
}

const KEYS: [(&str, &str); 8] = [
    ("status", "string"),
    ("method", "string"),
    ("iterations", "count"),
    ("class", "string"),
    ("unique", "string"),
    ("residual", "number"),
    ("tolerance", "number"),
    ("worst_unknown", "count"),
];

#[test]
fn every_class_is_solved_compared_and_verified() {
    let desk = Desk::new();
    classes(&desk);
    for (name, class, unique, method) in [
        ("symmetric", "symmetric", "one", "quadratic-program"),
        ("semidefinite", "symmetric", "several", ""),
        ("h-matrix", "h-matrix", "one", "principal-pivoting"),
        ("monotone", "monotone", "unknown", "gap-program"),
        ("p-matrix", "p-matrix", "one", "principal-pivoting"),
        ("general", "general", "unknown", "lemke"),
    ] {
        let report = desk.run(&["solve", name, "--out", name, "--format", "json"]).ends_with(0).json();
        has(&report, &KEYS);
        let proven = [("lower", "count"), ("between", "count"), ("upper", "count"), ("undecided", "count")];
        has(&report["proven"], &proven);
        has(&report["seconds"], &[("assemble", "number"), ("solve", "number"), ("total", "number")]);
        assert_eq!((&report["class"], &report["unique"]), (&class.into(), &unique.into()), "{report}");
        assert!(method.is_empty() || report["method"] == method, "{report}");
        // A bound, or the reason why there is none.
        assert!(report["error_bound"].is_number() != report["no_error_bound"].is_string(), "{report}");
        assert_eq!(
            serde_json::from_slice::<Value>(&std::fs::read(desk.path(&format!("{name}/report.json"))).unwrap())
                .unwrap(),
            report
        );
        assert!(desk.path(&format!("{name}/w.mtx")).exists());
        let text = desk.run(&["solve", name]).ends_with(0).stdout;
        assert!(text.contains("certified to 1.0e-9") && text.contains("residual z - mid(l, z - w, u)"), "{text}");

        let z = format!("{name}/z.mtx");
        let checked = desk.run(&["verify", name, "--z", &z, "--format", "json"]).ends_with(0).json();
        assert_eq!((&checked["status"], &checked["method"]), (&"certified".into(), &"given".into()));
        desk.write(&format!("{name}/far.mtx"), vector(&vec!["7"; if name == "p-matrix" { 3 } else { 2 }]));
        let far = format!("{name}/far.mtx");
        let text = desk.run(&["verify", name, "--z", &far]).ends_with(4).stdout;
        assert!(text.contains("NOT certified"), "{text}");

        let compared = desk.run(&["compare", name, "--format", "json"]).ends_with(0).json();
        let by: Vec<&Value> = compared["methods"].as_array().unwrap().iter().map(|method| &method["by"]).collect();
        assert_eq!(by, ["interior-point", "pivoting", "penalty"]);
        assert_eq!(compared["agreement"]["certified_answers"], true, "{compared}");
        for method in compared["methods"].as_array().unwrap() {
            assert!(method["status"] == "certified" || method["reason"].is_string(), "{compared}");
        }
        assert_eq!(compared["methods"][1]["status"], "certified", "{compared}");
        let has_program = ["symmetric", "semidefinite", "h-matrix", "monotone"].contains(&name);
        assert_eq!(compared["methods"][0]["status"] == "certified", has_program, "{compared}");
        assert!(desk.run(&["compare", name]).ends_with(0).stdout.contains("agreement"));
    }
}

#[test]
fn an_infeasible_problem_ends_with_3_and_its_ray() {
    let desk = Desk::new();
    for (name, rows) in [("symmetric", [["1", "-1"], ["-1", "1"]]), ("other", [["-1", "-1"], ["0", "-1"]])] {
        lcp(&desk, name, &[&rows[0], &rows[1]], &["-2", "1"], &[]);
        let run =
            desk.run(&["solve", name, "--out", "out", "--format", "json"]).fails_with(3, &["infeasible", "ray y"]);
        assert_eq!(run.json()["status"], "infeasible");
        let text = std::fs::read_to_string(desk.path("out/y.mtx")).unwrap();
        let y: Vec<f64> = text.lines().skip(2).map(|line| line.parse().unwrap()).collect();
        let m: Vec<Vec<f64>> =
            rows.iter().map(|row| row.iter().map(|value| value.parse().unwrap()).collect()).collect();
        let by_columns = [0, 1].map(|j| y[0] * m[0][j] + y[1] * m[1][j]);
        assert!(y.iter().all(|&y| y >= 0.0) && by_columns.iter().all(|&sum| sum <= 1e-15), "{y:?}");
        assert!(-2.0 * y[0] + y[1] < 0.0, "{y:?}");
        desk.run(&["compare", name]).fails_with(3, &["infeasible"]);
    }
}

#[test]
fn what_does_not_fit_a_complementarity_problem_is_refused() {
    let desk = Desk::new();
    classes(&desk);
    desk.problem("both", &Problem::right());
    desk.write("both/q.mtx", vector(&["1"]));
    let both = ["both q.mtx", "stiffness K", "remove the files of one"];
    desk.run(&["solve", "both"]).fails_with(1, &both);
    desk.run(&["compare", "both"]).fails_with(1, &both);
    desk.run(&["verify", "both", "--z", "z.mtx"]).fails_with(1, &both);
    desk.write("both/M.mtx", matrix("general", "1 1", &["1 1 1"]));
    desk.run(&["solve", "both"]).fails_with(1, &both);
    desk.problem("p", &Problem::right());
    desk.run(&["verify", "p", "--z", "z.mtx"]).fails_with(1, &["--z", "no q.mtx"]);
    let z = ["verify", "general", "--displacement", "u", "--multiplier", "l"];
    desk.run(&z).fails_with(1, &["--displacement", "--z z.mtx"]);
    for option in [&["--plan"][..], &["--explain"], &["--no-proof"], &["--accuracy", "1e-3"], &["--total-error", "0.1"]]
    {
        let run = desk.run(&[&["solve", "general"][..], option].concat());
        run.fails_with(1, &[option[0], "complementarity problem", "no effect"]);
    }
    for arguments in [&["sweep", "general", "--points", "3"][..], &["tradeoff", "general"]] {
        desk.run(arguments).fails_with(1, &["complementarity problem", "`solve`, `compare` and `verify`"]);
    }
    desk.run(&["verify", "general"]).ends_with(2);
    desk.run(&["verify", "general", "--z", "z.mtx", "--displacement", "u"]).ends_with(2);
    desk.write("general/upper.mtx", vector(&["1", "-1"]));
    desk.run(&["solve", "general"]).fails_with(1, &["bounds of unknown 1"]);
    let run = desk.run(&["solve", "general", "--format", "json"]).ends_with(1);
    assert_eq!((&run.json()["status"], &run.json()["code"]), (&"bad_input".into(), &"bounds".into()));
}

/// w = (-2 z_0 + z_1 - 1, z_1 + 1) is positive for z = (0, 2), but no complementary z exists: of the four bases z = 0
/// has `w_0 = -1`, and each other one a negative z.
#[test]
fn a_problem_without_a_solution_and_without_a_proof_ends_with_4() {
    let desk = Desk::new();
    lcp(&desk, "lost", &[&["-2", "1"], &["0", "1"]], &["-1", "1"], &[]);
    let run =
        desk.run(&["solve", "lost", "--format", "json"]).fails_with(4, &["no solution was found", "proves nothing"]);
    assert_eq!((&run.json()["status"], &run.json()["code"]), (&"not_found".into(), &"not-found".into()));
    let compared = desk.run(&["compare", "lost", "--format", "json"]).ends_with(4).json();
    assert_eq!(compared["agreement"]["certified_answers"], false, "{compared}");
}

/// With M = 1e300 and q = -1 the solution is 1e-300; w of z = 1e300 is beyond all numbers.
#[test]
fn a_point_whose_w_overflows_is_not_certified() {
    let desk = Desk::new();
    lcp(&desk, "steep", &[&["1e300"]], &["-1"], &[]);
    desk.write("z.mtx", vector(&["1e300"]));
    let report = desk.run(&["verify", "steep", "--z", "z.mtx", "--format", "json"]).ends_with(4).json();
    assert_eq!(report["status"], "not_certified", "{report}");
    assert!(report["error_bound"].as_f64().is_none_or(|bound| bound >= 1e300), "{report}");
    assert_eq!(report["proven"]["undecided"], 1, "{report}");
    desk.run(&["solve", "steep"]).ends_with(0);
}

/// A dense M without a class: each pivot is a step that an interrupt can end.
#[test]
fn an_interrupt_ends_pivoting_with_130() {
    let desk = Desk::new();
    let mut draws = Draws(5);
    let size = 700;
    let numbers: Vec<String> = (0..size * size).map(|_| draws.signed().to_string()).collect();
    let text = format!("%%MatrixMarket matrix array real general\n{size} {size}\n{}\n", numbers.join("\n"));
    desk.write("dense/M.mtx", text);
    desk.write("dense/q.mtx", vector(&vec!["-1"; size]));
    let mut run = desk.start(&["solve", "dense"]);
    assert!(run.waits_for("solve"));
    run.interrupt();
    let run = run.ends(true).ends_with(130);
    assert!(run.stderr.contains("interrupted"), "{}", run.stderr);
}
