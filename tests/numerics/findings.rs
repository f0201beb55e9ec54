//! GOAL: small problems that once broke a promise of the program, each with its exact answer and the properties that
//! must hold.
//!
//! A folder of `tests/corpus/findings` is a problem directory, sometimes with an answer to verify, or a scene. Its
//! `exact.json` is the output of `fuzz exact --answer`. CONDITIONS, for every method: no claim about the problem is
//! false, no bound is below the error, no proof is wrong, and no answer is certified with a larger error than its
//! bound.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use signorini::qp::{Error, read_problem, read_vector};
use signorini::{ContactProblem, Method, Settings, Solution, solve};
use support::oracles::exact::case::Case;
use support::oracles::exact::judge::{Fault, Judge};
use support::oracles::exact::measure::Errors;
use support::oracles::exact::problem::Exact;
use support::oracles::exact::solve::{Answer, Outcome};
use support::problems::of_entries;
use support::program::{Desk, Run};

const ALL: [Method; 5] = [Method::Auto, Method::qp(), Method::ActiveSet, Method::penalty(), Method::Mprgp];

/// An answer is exact to rounding if its relative error in energy is below this, or if the rounding of u explains the
/// error.
const ROUNDING: f64 = 1e-13;

/// The best penalty is 1e8; its error is at most a hundred times 1e-8.
const OF_A_PENALTY: f64 = 1e-6;

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus/findings").join(name)
}

/// A kept problem with its stored exact answer.
struct Finding {
    name: &'static str,
    problem: ContactProblem,
    case: Case,
    exact: Exact,
    outcome: Outcome,
}

impl Finding {
    fn read(name: &'static str) -> Self {
        let problem = read_problem(&folder(name)).unwrap();
        let case = Case::of(&problem);
        let exact = Exact::new(&case);
        let kept: Value = serde_json::from_str(&fs::read_to_string(folder(name).join("exact.json")).unwrap()).unwrap();
        assert_eq!(exact.json(&case), kept, "{name}");
        Finding { name, problem, outcome: exact.outcome(), case, exact }
    }

    /// The exact answer of a problem that has one.
    fn solved(&self) -> &Answer {
        let Outcome::Solved(answer) = &self.outcome else { panic!("{} has no answer", self.name) };
        answer
    }

    fn judge(&self) -> Judge<'_> {
        Judge::new(&self.case, &self.exact, &self.outcome)
    }

    fn is_faultless(&self, faults: &[Fault]) {
        let details: Vec<&str> = faults.iter().map(|fault| fault.detail.as_str()).collect();
        assert!(details.is_empty(), "{}: {details:#?}", self.name);
    }

    /// Solves with a method, and judges the ending.
    fn solve(&self, method: Method) -> Result<Solution, Error> {
        let mut settings = Settings::with_method(method);
        settings.prove = true;
        let ending = solve(&self.problem, &settings);
        self.is_faultless(&self.judge().ending(method.name(), settings.goal(), &ending, false));
        ending
    }

    /// Asserts that the methods certify the answer, and that it is exact to rounding; the answer of MPRGP only to its
    /// tolerance.
    fn is_certified_by(&self, methods: &[Method]) {
        for &method in methods {
            let ending = self.solve(method);
            // A penalty answer has an error by design, and its certificate states it.
            if let (Method::Penalty(_), Err(Error::NotCertified { solution, .. })) = (method, &ending) {
                assert!(
                    solution.certificate.energy_error_bound <= OF_A_PENALTY,
                    "{}: {:?}",
                    self.name,
                    solution.certificate
                );
                continue;
            }
            let solution = ending.unwrap_or_else(|error| panic!("{} by {}: {error}", self.name, method.name()));
            let errors = Errors { case: &self.case, exact: &self.exact, answer: self.solved() };
            let error = errors.whole(&solution.displacement);
            let allowed = if method == Method::Mprgp { 1e-9 } else { ROUNDING.max(error.explained) };
            assert!(error.is_within(allowed), "{} by {}: {:.3e}", self.name, method.name(), error.value());
        }
    }

    /// `signorini solve` with some arguments.
    fn command(&self, arguments: &[&str]) -> Run {
        let folder = folder(self.name);
        Desk::new().run(&[&["solve", folder.to_str().unwrap()], arguments].concat())
    }

    /// Asserts that `verify` does not certify the answer in the folder, and that all its statements about it are true.
    fn is_not_verified(&self) {
        let folder = folder(self.name);
        let files = ["u.mtx", "lambda.mtx"].map(|file| folder.join(file));
        let [u, lambda] = files.each_ref().map(|file| read_vector(file).unwrap());
        self.is_faultless(&self.judge().verified("verify", &self.problem, &u, &lambda));
        let [u, lambda] = files.each_ref().map(|file| file.to_str().unwrap());
        let arguments = ["verify", folder.to_str().unwrap(), "--displacement", u, "--multiplier", lambda];
        Desk::new().run(&arguments).ends_with(4);
    }
}

#[test]
fn an_exact_answer_at_a_degenerate_vertex_has_a_small_bound() {
    let finding = Finding::read("bound_too_large_degenerate_vertex");
    finding.is_certified_by(&ALL);
    let run = finding.command(&["--format", "json"]).ends_with(0);
    assert!(run.json()["certificate"]["energy_error_bound"].as_f64().unwrap() <= 1e-9);
}

#[test]
fn two_rows_that_share_a_soft_dof_are_certified() {
    let finding = Finding::read("contrast_2dof");
    finding.is_certified_by(&ALL);
    finding.command(&[]).ends_with(0);
}

#[test]
fn a_gap_of_1e20_does_not_bound_its_row() {
    let finding = Finding::read("gap_1e20");
    for method in ALL {
        assert!(matches!(finding.solve(method), Err(Error::Unbounded { .. })), "{}", method.name());
        finding.command(&["--method", method.name()]).ends_with(3);
    }
}

#[test]
fn rows_that_contradict_each_other_by_order_one_are_infeasible() {
    let finding = Finding::read("infeasible_not_found");
    for method in ALL {
        let Err(Error::Infeasible { rows, weights, .. }) = finding.solve(method) else { panic!("{}", method.name()) };
        // Row 1, row 2 and twice row 3 cancel, and demand 0 <= -4.
        assert_eq!(rows, [1, 2, 3], "{}", method.name());
        let (largest, ratios) = (weights.iter().copied().fold(0.0, f64::max), [0.5, 0.5, 1.0]);
        let agree = ratios.iter().zip(&weights).all(|(ratio, weight)| (ratio - weight / largest).abs() < 1e-12);
        assert!(agree, "{}: {weights:?}", method.name());
        finding.command(&["--method", method.name()]).ends_with(3);
    }
}

#[test]
fn a_free_dof_that_contact_holds_is_convex() {
    let finding = Finding::read("mprgp_zero_diagonal_not_convex");
    finding.is_certified_by(&ALL);
    finding.command(&["--method", "mprgp"]).ends_with(0);
}

#[test]
fn a_row_behind_its_scaled_copy_is_not_proven_closed() {
    let finding = Finding::read("solve_wrong_proof_parallel_rows");
    finding.is_certified_by(&ALL);
    for method in ALL {
        let mut settings = Settings::with_method(method);
        (settings.accuracy, settings.prove) = (Some(1e-2), true);
        let ending = solve(&finding.problem, &settings);
        finding.is_faultless(&finding.judge().ending(method.name(), settings.goal(), &ending, true));
    }
    finding.command(&["--accuracy", "1e-2"]).ends_with(0);
}

/// The limit is too small for a factor; multigrid with coarsening along the strip stays below it.
#[test]
fn a_stretched_strip_is_certified_within_a_limit_of_memory() {
    let (desk, scene) = (Desk::new(), folder("strip_max_memory").join("scene.json"));
    let solve = ["solve", scene.to_str().unwrap(), "--max-memory", "100MB"];
    let found = desk.run(&[&solve[..], &["--format", "json"]].concat()).ends_with(0).json();
    assert_eq!((&found["method"], &found["status"]), (&json!("mprgp"), &json!("certified")));
    assert!(desk.peak(&solve) < 100e6);
}

#[test]
fn rounding_of_a_large_displacement_is_accounted_for() {
    let finding = Finding::read("unconstrained_stationarity");
    finding.is_certified_by(&[Method::Auto, Method::qp(), Method::ActiveSet, Method::penalty()]);
    finding.command(&[]).ends_with(0);
}

/// Floating bodies in exact balance end certified or as under-held, but not as unbounded.
#[test]
fn a_load_in_exact_balance_is_not_unbounded() {
    let finding = Finding::read("under_held_called_unbounded");
    assert_eq!(finding.outcome.verdict(), "under-held");
    is_certified_or_under_held(&finding);
}

#[test]
fn zero_stiffness_is_under_held_and_convex() {
    let finding = Finding::read("zero_stiffness_not_convex");
    is_certified_or_under_held(&finding);
}

fn is_certified_or_under_held(finding: &Finding) {
    for method in ALL {
        let ending = finding.solve(method);
        assert!(matches!(ending, Ok(_) | Err(Error::UnderHeld { .. })), "{}: {ending:?}", method.name());
        for all_dofs in [&[][..], &["--no-condense"]] {
            let run = finding.command(&[&["--method", method.name()], all_dofs].concat());
            assert!([0, 3].contains(&run.code), "{} {all_dofs:?}: {}", method.name(), run.stderr);
            assert!(!run.stderr.contains("unbounded"), "{}", run.stderr);
        }
    }
}

#[test]
fn a_violated_row_that_depends_on_others_is_not_certified() {
    Finding::read("verify_bound_fooled_dependent_row").is_not_verified();
}

/// Rows in opposed pairs hold dofs without stiffness at others: a repair moves them, and their forces balance nowhere.
#[test]
fn rows_on_dofs_without_stiffness_carry_no_force_in_a_bound() {
    let finding = Finding::read("rows_in_pairs_on_loose_dofs");
    let [u, lambda] = ["u.mtx", "lambda.mtx"].map(|file| read_vector(&folder(finding.name).join(file)).unwrap());
    finding.is_faultless(&finding.judge().verified("verify", &finding.problem, &u, &lambda));
    assert!(finding.problem.certify(&u, &lambda).unwrap().meets(1e-9));
}

/// Only a travel moves such a row. Its gap is a place of the travel, and not rounding beside gaps that are 1e16 times
/// as large: the nearest row was taken for open. Rows that are opposite in the body alone were taken for an equality.
#[test]
fn the_nearest_row_of_a_travel_is_not_proven_open_if_its_gap_is_tiny() {
    for name in ["pressed_row_with_a_tiny_gap", "row_of_a_travel_beside_a_body"] {
        Finding::read(name).is_certified_by(&[Method::Auto, Method::qp(), Method::ActiveSet]);
    }
}

/// Forces of 1e32 lock three rows of which one follows from the others; without them the answer moves by 1e15.
#[test]
fn locked_forces_times_the_rounding_of_their_distances_are_in_the_bound() {
    Finding::read("verify_locked_forces").is_not_verified();
}

/// A travel of 1e-11 whose bending is the rounding of its doubles; the sum of its energy rounds as much, even in twice
/// the working precision.
#[test]
fn a_travel_that_hardly_bends_has_a_bound_above_the_rounding_of_its_energy() {
    Finding::read("verify_travel_that_hardly_bends").is_not_verified();
}

#[test]
fn a_soft_floating_body_at_the_wrong_place_is_not_certified() {
    Finding::read("verify_soft_floating_body").is_not_verified();
}

#[test]
fn a_soft_part_at_the_wrong_place_is_not_certified() {
    Finding::read("verify_soft_part_definite").is_not_verified();
}

#[test]
fn a_weakly_held_part_between_difference_rows_is_certified() {
    let finding = Finding::read("weakly_held_part_difference_rows");
    finding.is_certified_by(&[Method::Auto, Method::qp(), Method::ActiveSet, Method::penalty()]);
    finding.command(&[]).ends_with(0);
}

#[test]
fn copies_of_a_row_in_other_scales_have_a_bound() {
    Finding::read("scaled_duplicates_no_bound").is_certified_by(&ALL);
}

#[test]
fn a_soft_support_is_not_called_none() {
    let finding = Finding::read("soft_support_called_unbounded");
    for method in ALL {
        // The doubles of the problem hold the body; whether an answer is certified is another question.
        if let Err(error) = finding.solve(method) {
            let is_open = matches!(error, Error::NotCertified { .. } | Error::Undecided { .. });
            assert!(is_open, "{}: {error}", method.name());
            assert!(!error.to_string().contains("unbounded"), "{}: {error}", method.name());
        }
    }
    let Run { code, stdout, stderr } = finding.command(&[]);
    let said = (stdout + &stderr).replace(finding.name, "");
    assert!([0, 4].contains(&code) && !said.contains("unbounded"), "{code}: {said}");
}

#[test]
fn a_hundred_blocks_in_contact_with_each_other_have_a_bound() {
    Finding::read("stack_of_blocks_101").is_certified_by(&ALL);
}

/// Asserts that `auto`, the QP and the active set certify the answer, for an accuracy goal as well, and that every
/// error on the way to it that `tradeoff` prints is at most the bound beside it.
#[test]
fn an_answer_whose_forces_cancel_is_repaired_before_it_is_certified() {
    let finding = Finding::read("foam_pair_certified_3e-4");
    finding.is_certified_by(&[Method::Auto, Method::qp(), Method::ActiveSet, Method::penalty()]);
    let folder = folder(finding.name);
    let report = Desk::new().run(&["tradeoff", folder.to_str().unwrap(), "--format", "json"]).ends_with(0).json();
    let points = report["points"].as_array().unwrap().iter();
    let pairs =
        points.filter_map(|point| Some((point["energy_error"].as_f64()?, point["energy_error_bound"].as_f64()?)));
    let pairs: Vec<(f64, f64)> = pairs.collect();
    assert!(!pairs.is_empty() && pairs.iter().all(|(error, bound)| error <= bound), "{pairs:?}");
}

#[test]
fn a_body_at_rest_is_certified_by_a_sentence_of_its_own() {
    for name in ["rest_load_on_wall", "rest_weakly_coupled_part"] {
        let finding = Finding::read(name);
        for method in [Method::Auto, Method::qp(), Method::ActiveSet] {
            let solution = finding.solve(method).unwrap_or_else(|error| panic!("{name} by {}: {error}", method.name()));
            assert!(solution.certificate.at_rest && solution.displacement.iter().all(|&u| u == 0.0), "{name}");
        }
        let run = finding.command(&[]).ends_with(0);
        assert!(run.stdout.contains("certified at rest"), "{}", run.stdout);
    }
}

/// The forces on the second part are 1e20 times those that bend the first one: put at rest, the second part would make
/// the whole wrong by 2e-5.
#[test]
fn a_part_that_looks_at_rest_is_no_excuse_for_the_error_of_the_whole() {
    let finding = Finding::read("rest_that_is_none_beside_a_small_motion");
    finding.is_certified_by(&[Method::Auto, Method::qp(), Method::ActiveSet]);
    finding.command(&[]).ends_with(0);
    let (mut u, lambda) = finding.exact.rounded(&finding.case, finding.solved());
    assert!(finding.problem.certify(&u, &lambda).unwrap().meets(1e-9));
    u[2..].fill(0.0);
    let at_rest = finding.problem.certify(&u, &lambda).unwrap();
    assert!(at_rest.meets(1e-4) && !at_rest.meets(1e-5), "{at_rest:?}");
}

/// Row 3 is nearly 3.7e-4 times the sum of the rows before it: with row 1 closed too, the force of all is off by 14 %.
#[test]
fn no_closed_row_is_proven_open() {
    let finding = Finding::read("closed_row_proven_open");
    for method in [Method::Auto, Method::qp(), Method::ActiveSet] {
        let solution = finding.solve(method).unwrap();
        assert_eq!(solution.contact_set.iter().collect::<Vec<_>>(), [2, 3], "{}", method.name());
        assert!((solution.contact_force() / 4.599345e8 - 1.0).abs() < 1e-6, "{:?}", solution.multiplier);
    }
}

/// A load of 7e19 on the softest of six dofs at its wall hides rows that are violated by order one.
#[test]
fn a_violated_gap_is_no_rounding_of_a_load_on_a_wall() {
    let finding = Finding::read("bounds_mixed_scales");
    let at_rest = finding.problem.certify(&[0.0; 6], &[0.0, 0.0, 0.0, -7.266337913429869e19, 0.0, 0.0]).unwrap();
    assert!(!at_rest.meets(1e-9) && !at_rest.at_rest, "{at_rest:?}");
    finding.is_certified_by(&[Method::Auto, Method::qp(), Method::ActiveSet, Method::penalty()]);
}

/// Two copies of a row differ by rounding, and their forces cancel the load on a part to all but 1e-17 of it.
#[test]
fn copies_of_a_row_do_not_keep_a_part_from_its_repair() {
    let finding = Finding::read("copies_of_a_row_under_forces_that_cancel");
    finding.is_certified_by(&[Method::Auto, Method::qp(), Method::ActiveSet]);
    finding.command(&[]).ends_with(0);
}

#[test]
fn a_loose_part_between_two_walls_hides_no_bound_of_the_others() {
    let finding = Finding::read("loose_part_between_walls");
    finding.is_certified_by(&[Method::Auto]);
    let certificate = &finding.command(&["--format", "json"]).ends_with(0).json()["certificate"];
    // The walls meet: they hold it as an equality does, with no stiffness whose digits could be lost.
    assert!(certificate["loose_dofs"].is_null(), "{certificate}");
    let text = finding.command(&[]).stdout;
    assert!(!text.contains("warning"), "{text}");
}

#[test]
fn a_body_that_a_small_force_drives_away_is_not_certified_to_any_accuracy() {
    let finding = Finding::read("accuracy_certifies_unbounded");
    for method in ALL {
        for accuracy in [None, Some(1e-2)] {
            let mut settings = Settings::with_method(method);
            settings.accuracy = accuracy;
            let ending = solve(&finding.problem, &settings);
            finding.is_faultless(&finding.judge().ending(method.name(), settings.goal(), &ending, false));
            assert!(ending.is_err(), "{} {accuracy:?}", method.name());
        }
    }
    let Run { code, .. } = finding.command(&["--accuracy", "1e-2"]);
    assert!([3, 4].contains(&code), "{code}");
}

#[test]
fn an_answer_that_a_load_on_a_wall_makes_look_small_is_not_verified() {
    let finding = Finding::read("verify_load_on_wall");
    finding.is_not_verified();
    let folder = folder(finding.name);
    let files = ["u.mtx", "lambda.mtx"].map(|file| folder.join(file));
    let [u, lambda] = files.each_ref().map(|file| file.to_str().unwrap());
    let arguments = ["verify", folder.to_str().unwrap(), "--displacement", u, "--multiplier", lambda];
    Desk::new().run(&[&arguments[..], &["--tolerance", "1e-2"]].concat()).ends_with(4);
    // One that is right to the tolerance is certified.
    for method in [Method::Auto, Method::qp(), Method::ActiveSet] {
        finding.solve(method).unwrap_or_else(|error| panic!("{}: {error}", method.name()));
    }
}

/// GOAL: multipliers that cancel each other, of any size, excuse no violated row.
/// CONDITIONS: an equality as two rows, a row that the displacement zero violates by its whole gap, and multipliers of
/// 1e35 and 1e47 whose forces cancel to the last bit; found by `fuzz problem`.
#[test]
fn large_multipliers_of_a_body_at_rest_excuse_no_row() {
    let stiffness = [(0, 0, 0.5074361586147477), (1, 0, -0.030858197349235072), (1, 1, 0.002337122819147528)];
    let (small, large) = (3.4729115292429923e-13, 180465009063.4823);
    let rows = [
        (0, 0, small),
        (1, 0, -small),
        (0, 1, -large),
        (1, 1, large),
        (2, 1, -0.05620849318802357),
        (3, 1, 0.5945215504616499),
    ];
    let load = vec![-0.6757287345826626, 0.34464614279568195];
    let gap = vec![0.7354622408747673, -0.7354622408747673, 0.3724177163094282, -0.4014382716268301];
    let problem = of_entries(&stiffness, load, &rows, gap);
    let certificate = problem.certify(&[0.0; 2], &[-5.126702907171483e35, 0.0, 0.0, -1.5561933556320477e47]).unwrap();
    assert!(!certificate.meets(1e-9) && certificate.penetration > 0.0, "{certificate:?}");
}
