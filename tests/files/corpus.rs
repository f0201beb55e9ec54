//! Inputs that random damage has found, one for every ending that `tests/faults` does not cover; each is run again.
//!
//! `cargo run --release --example studies -- fuzz TARGET INPUTS SEED --keep` adds to `tests/corpus`. The name of a file
//! consists of the name of the right file that was damaged and the code of its error; `problems` has a line for each
//! contact problem, with its seed and its ending.

use signorini::{ContactProblem, InteriorPoint, Method, Penalty, Prepared, Settings, Solution, qp, solve};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use signorini::qp::read_problem;
use support::draws::Draws;
use support::fuzz::damage::{damaged, damaged_deck, fault, faults, read};
use support::fuzz::problem;
use support::{cases, seed};

fn corpus() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus")
}

/// A folder with the valid files of a problem.
fn desk() -> tempfile::TempDir {
    let desk = tempfile::tempdir().unwrap();
    for name in ["K.mtx", "f.mtx", "B.mtx", "g.mtx"] {
        fs::copy(faults(name), desk.path().join(name)).unwrap();
    }
    desk
}

#[test]
fn kept_files_are_refused_with_their_code() {
    let (mut files, mut faults) = (0, BTreeSet::new());
    for file in fs::read_dir(corpus()).unwrap() {
        let file = file.unwrap().path();
        let Some(extension) = file.extension().and_then(|extension| extension.to_str()) else { continue };
        let (stem, rest) = file.file_stem().unwrap().to_str().unwrap().split_once('-').unwrap();
        let (code, _) = rest.rsplit_once('-').unwrap();
        let error = read(&format!("{stem}.{extension}"), &fs::read(&file).unwrap(), desk().path()).unwrap_err();
        assert_eq!(error.code(), code, "{}: {error}", file.display());
        faults.insert(fault(&error));
        files += 1;
    }
    assert!(files >= 40);
    assert_eq!(faults.len(), files, "two kept files have the same ending");
}

#[test]
fn kept_problems_end_as_recorded() {
    let kept = fs::read_to_string(corpus().join("problems")).unwrap();
    assert!(kept.lines().count() >= 10);
    // Rounding may change the method that succeeds and the last digit of its answer, but not the reason why a problem
    // has no answer.
    let sort = |ending: &str| if ending.starts_with("qp") { "not-certified".to_string() } else { ending.to_string() };
    for line in kept.lines() {
        let (seed, ending) = line.split_once(' ').unwrap();
        let found = problem::ending(&mut Draws(seed.parse().unwrap()));
        assert_eq!(found.map(|found| sort(&found)), Ok(sort(ending)), "{line}");
    }
}

/// Six rows have 64 sets, and the rules of the loop meet each set only a few times; if rounding decides, the loop gives
/// up.
#[test]
fn the_active_set_loop_ends_on_every_kept_problem() {
    const LONGEST: usize = 400;
    let kept = fs::read_to_string(corpus().join("problems")).unwrap();
    let mut longest = 0;
    for line in kept.lines() {
        let seed = line.split_once(' ').unwrap().0.parse().unwrap();
        let Ok(problem) = problem::problem(&mut Draws(seed)) else { continue };
        let found = match solve(&problem, &Settings::with_method(Method::ActiveSet)) {
            Ok(solution) => solution,
            Err(qp::Error::NotCertified { solution, .. }) => *solution,
            Err(_) => continue,
        };
        longest = longest.max(found.history.len());
    }
    println!("{longest} iterations");
    assert!(longest <= LONGEST, "{longest} iterations");
}

/// A short form of the fuzz program.
#[test]
fn damaged_files_and_random_problems_cause_no_panic() {
    let (inputs, desk) = (2000, desk());
    let mut draws = Draws(5);
    for name in [
        "plane.json",
        "space.json",
        "round.json",
        "square2.msh",
        "square4.msh",
        "square2b.msh",
        "square4b.msh",
        "K.mtx",
        "B.mtx",
    ] {
        let text = fs::read(faults(name)).unwrap();
        let accepted = (0..inputs).filter(|_| read(name, &damaged(&mut draws, &text), desk.path()).is_ok()).count();
        assert!(accepted > 0 && accepted < inputs, "{name}: {accepted} of {inputs}");
        if name.ends_with(".mtx") {
            fs::write(desk.path().join(name), text).unwrap();
        }
    }
    for seed in 0..inputs as u64 / 4 {
        problem::ending(&mut Draws(1000 * seed)).unwrap_or_else(|fault| panic!("{seed}: {fault}"));
    }
}

/// Each damaged deck is refused with one sentence that has a line of a file, or it is built as it stands.
#[test]
fn damaged_decks_have_a_sentence_with_a_line_or_a_model() {
    let (inputs, desk) = (2000, desk());
    let mut draws = Draws(7);
    let text = fs::read_to_string(faults("stack.inp")).unwrap();
    let mut accepted = 0;
    for _ in 0..inputs {
        let deck = damaged_deck(&mut draws, &text, "stack.inp");
        match read("stack.inp", deck.as_bytes(), desk.path()) {
            Ok(()) => accepted += 1,
            Err(error) => {
                let sentence = error.to_string();
                let line = sentence.split("stack.inp:").nth(1).and_then(|rest| rest.split(':').next());
                let has_line = line.is_some_and(|line| line.parse::<usize>().is_ok());
                let is_of_model = error.status() == "under_held";
                assert!((has_line || is_of_model) && !sentence.contains('\n'), "{sentence}\n{deck}");
            }
        }
    }
    assert!(accepted > inputs / 50 && accepted < inputs, "{accepted} of {inputs}");
}

/// The methods by name and by choice; an unpolished QP and a soft penalty are returned as they are.
fn methods() -> Vec<Method> {
    let unpolished = Method::Qp(InteriorPoint { polish: false, tolerance: 1e-9 });
    let soft = Method::Penalty(Penalty { last: 10.0, ..Penalty::default() });
    vec![Method::Auto, Method::qp(), Method::ActiveSet, Method::penalty(), Method::Mprgp, unpolished, soft]
}

/// The codes of `solve`, of data prepared for one gap, and of data prepared at other gaps for many.
fn codes(problem: &ContactProblem, settings: &Settings) -> [&'static str; 3] {
    let code = |solved: Result<Solution, qp::Error>| solved.map_or_else(|error| error.code(), |_| "solved");
    let elsewhere = problem.gap().iter().map(|gap| gap.abs() + 1.0).collect();
    let of_one = Prepared::for_gaps(problem, 1, settings).and_then(|prepared| prepared.solve(problem.gap()));
    let of_many = (problem.with_gap(elsewhere))
        .and_then(|elsewhere| Prepared::new(&elsewhere, settings))
        .and_then(|prepared| prepared.solve(problem.gap()));
    [solve(problem, settings), of_one, of_many].map(code)
}

/// GOAL: the ending does not depend on the door, for every method, on random problems and on every kept finding.
#[test]
fn one_solve_and_prepared_data_end_in_the_same_way() {
    let first = seed(900_000);
    let random = (first..first + cases(200, 2000)).filter_map(|seed| problem::problem(&mut Draws(seed)).ok());
    let kept = fs::read_dir(corpus().join("findings")).unwrap();
    let kept = kept.map(|finding| finding.unwrap().path()).filter(|folder| folder.join("K.mtx").exists());
    let kept = kept.map(|folder| read_problem(&folder).unwrap());
    let (mut differ, mut endings) = (Vec::new(), BTreeSet::new());
    for (number, problem) in random.chain(kept).enumerate() {
        for method in methods() {
            let found = codes(&problem, &Settings::with_method(method));
            endings.insert(found[0]);
            if found.iter().any(|code| *code != found[0]) {
                differ.push((number, method.name(), found));
            }
        }
    }
    assert!(differ.is_empty(), "{} differ: {differ:?}", differ.len());
    for ending in ["solved", "infeasible", "unbounded", "under-held", "not-certified"] {
        assert!(endings.contains(ending), "no problem is {ending}");
    }
}
