//! GOAL: dense problems, which are solved by the compliance of their rows, have the answers of every enumerated set and
//! of exact arithmetic.
//!
//! CONDITIONS: what is certified is within its bound, no proof is wrong, and degenerate, dependent, contradictory and
//! badly scaled rows end as they do without the compliance.

use nalgebra::{DMatrix, DVector};
use signorini::qp::{Error, solve_many};
use signorini::{Method, Settings, Solution, solve};
use support::oracles::exact::case::Case;
use support::oracles::exact::judge::Judge;
use support::oracles::exact::problem::Exact;
use support::oracles::{Dense, Draws};

/// Rounding of an enumerated answer, whose systems have condition numbers of some thousand.
const ROUNDING: f64 = 1e-9;

/// A problem with every entry of K and B drawn.
fn dense(draws: &mut Draws, n: usize, m: usize) -> Dense {
    let a = DMatrix::from_fn(n, n, |_, _| draws.signed());
    let stiffness = &a * a.transpose() / n as f64 + DMatrix::identity(n, n) * 0.1;
    let stiffness = (&stiffness + stiffness.transpose()) / 2.0;
    let contact = DMatrix::from_fn(m, n, |_, _| draws.signed());
    let gap = DVector::from_fn(m, |_, _| 0.3 * draws.signed() + 0.1);
    Dense { stiffness, load: DVector::from_fn(n, |_, _| draws.signed()), contact, gap }
}

fn proven() -> Settings {
    Settings::default().with_proof()
}

/// Judges the ending of a problem by exact arithmetic, for every method; returns that of the method that the program
/// chooses.
fn judged(dense: &Dense, name: &str) -> Result<Solution, Error> {
    let problem = dense.problem().unwrap();
    let case = Case::of(&problem);
    let exact = Exact::new(&case);
    let outcome = exact.outcome();
    let judge = Judge::new(&case, &exact, &outcome);
    let mut endings = Vec::new();
    for method in [Method::Auto, Method::ActiveSet, Method::qp(), Method::penalty()] {
        let settings = Settings::with_method(method).with_proof();
        let ending = solve(&problem, &settings);
        let faults = judge.ending(method.name(), settings.goal(), &ending, false);
        let forbidden: Vec<&str> =
            faults.iter().filter(|fault| fault.sort.is_forbidden()).map(|fault| fault.detail.as_str()).collect();
        assert!(forbidden.is_empty(), "{name}: {forbidden:#?}");
        endings.push(ending);
    }
    endings.swap_remove(0)
}

#[test]
fn every_set_is_tried_and_none_is_better() {
    let mut draws = Draws::new(31);
    for n in [1, 2, 3, 5, 8, 12, 20, 40] {
        for m in [1, 2, 5, 8].into_iter().filter(|&m| m <= n) {
            let dense = dense(&mut draws, n, m);
            let (exact, found) = (dense.enumerate(), solve(&dense.problem().unwrap(), &proven()).unwrap());
            let u = DVector::from_column_slice(&found.displacement);
            let off = (&u - &exact.displacement).amax() / exact.displacement.amax();
            assert!(off <= ROUNDING, "{n} {m}: {off:e}");
            assert_eq!(found.contact_set.iter().collect::<Vec<_>>(), exact.closed, "{n} {m}");
            // Every row is proven, because none is near a change of sides.
            let sets = found.proven.unwrap();
            assert_eq!(sets.closed.iter().collect::<Vec<_>>(), exact.closed, "{n} {m}");
            assert_eq!(sets.open.count() + exact.closed.len(), m, "{n} {m}");
            assert!(found.certificate.energy_error_bound <= 1e-12, "{n} {m}: {:?}", found.certificate);
        }
    }
}

#[test]
fn rows_that_are_equal_dependent_nearly_parallel_or_just_touch_are_judged_rightly() {
    let mut draws = Draws::new(7);
    for round in 0..8 {
        let plain = dense(&mut draws, 6, 5);
        let mut equal = plain.clone();
        let copied = equal.contact.row(0) * 2.0;
        equal.contact.set_row(1, &copied);
        equal.gap[1] = 2.0 * equal.gap[0];
        judged(&equal, &format!("{round} equal")).unwrap();

        let mut sum = plain.clone();
        let added = sum.contact.row(0) + sum.contact.row(1);
        sum.contact.set_row(2, &added);
        sum.gap[2] = sum.gap[0] + sum.gap[1];
        judged(&sum, &format!("{round} sum")).unwrap();

        for angle in [1e-3, 1e-6, 1e-9, 1e-12] {
            let mut near = plain.clone();
            let turned = near.contact.row(0) + near.contact.row(3) * angle;
            near.contact.set_row(1, &turned);
            near.gap[1] = near.gap[0];
            judged(&near, &format!("{round} at an angle of {angle}")).unwrap();
        }

        // The free body just touches every row.
        let mut touching = plain.clone();
        let free = touching.stiffness.clone().cholesky().unwrap().solve(&touching.load);
        touching.gap = &touching.contact * free;
        judged(&touching, &format!("{round} touching")).unwrap();
    }
}

#[test]
fn rows_that_contradict_each_other_are_infeasible_and_a_singular_stiffness_is_judged_as_before() {
    let mut draws = Draws::new(11);
    for round in 0..8 {
        let plain = dense(&mut draws, 6, 4);
        let mut against = plain.clone();
        let opposed = -(against.contact.row(0) + against.contact.row(1));
        against.contact.set_row(2, &opposed);
        against.gap[2] = -(against.gap[0] + against.gap[1]) - 1.0;
        let ending = judged(&against, &format!("{round} against"));
        assert!(matches!(ending, Err(Error::Infeasible { .. })), "{round}: {ending:?}");

        let mut singular = plain;
        let half = DMatrix::from_fn(6, 3, |_, _| (64.0 * draws.signed()).round());
        singular.stiffness = &half * half.transpose();
        let _ = judged(&singular, &format!("{round} singular"));
    }
}

#[test]
fn scales_of_any_size_change_no_bit_and_contrasts_are_judged_rightly() {
    let mut draws = Draws::new(5);
    for round in 0..6 {
        let plain = dense(&mut draws, 7, 4);
        let found = solve(&plain.problem().unwrap(), &proven()).unwrap();
        for [stiffness, length] in
            [[600, -300], [-700, 200], [40, 900]].map(|powers| powers.map(|power| 2_f64.powi(power)))
        {
            let mut scaled = plain.clone();
            (scaled.stiffness, scaled.gap) = (&plain.stiffness * stiffness, &plain.gap * length);
            scaled.load = &plain.load * stiffness * length;
            let Ok(answer) = solve(&scaled.problem().unwrap(), &proven()) else {
                panic!("{round} {stiffness:e} {length:e}")
            };
            let expected: Vec<f64> = found.displacement.iter().map(|u| u * length).collect();
            assert_eq!(answer.displacement, expected, "{round} {stiffness:e} {length:e}");
        }
        // Dofs and rows of very different sizes.
        let mut contrast = plain;
        let size = |place: usize| 10_f64.powi(5 * (place as i32 % 3 - 1));
        contrast.stiffness = DMatrix::from_fn(7, 7, |i, j| contrast.stiffness[(i, j)] * size(i) * size(j));
        contrast.load = DVector::from_fn(7, |i, _| contrast.load[i] * size(i));
        contrast.contact = DMatrix::from_fn(4, 7, |i, j| contrast.contact[(i, j)] * size(j) * size(i + 1));
        contrast.gap = DVector::from_fn(4, |i, _| contrast.gap[i] * size(i + 1));
        judged(&contrast, &format!("{round} contrast")).unwrap();
    }
}

#[test]
fn many_problems_have_the_answers_of_each_in_their_order_on_any_number_of_threads() {
    let mut draws = Draws::new(3);
    let mut problems: Vec<_> =
        (0..23).map(|number| dense(&mut draws, 5 + number % 9, number % 5).problem().unwrap()).collect();
    // One of them has no answer.
    let contradictory = Dense::new(&[&[1.0]], &[0.0], &[&[1.0], &[-1.0]], &[-1.0, -1.0]);
    problems[17] = contradictory.problem().unwrap();
    let bits = |answer: &Result<Solution, Error>| match answer {
        Ok(solution) => Ok((solution.displacement.clone(), solution.multiplier.clone(), solution.proven.clone())),
        Err(error) => Err(error.to_string()),
    };
    let alone: Vec<_> = problems.iter().map(|problem| bits(&solve(problem, &proven()))).collect();
    assert!(alone[17].is_err() && alone.iter().filter(|answer| answer.is_err()).count() == 1);
    for threads in [1, 2, 5, 64] {
        let mut settings = proven();
        settings.threads = Some(threads);
        let together: Vec<_> = solve_many(&problems, &settings).iter().map(bits).collect();
        assert_eq!(together, alone, "{threads} threads");
    }
    assert!(solve_many(&[], &proven()).is_empty());
}

#[test]
fn two_threads_give_the_answer_of_one_bit_by_bit() {
    let problem = dense(&mut Draws::new(13), 300, 60).problem().unwrap();
    let [one, two] = [1, 2].map(|threads| {
        let mut settings = proven();
        settings.threads = Some(threads);
        solve(&problem, &settings).unwrap()
    });
    assert_eq!((one.displacement, one.multiplier, one.proven), (two.displacement, two.multiplier, two.proven));
}

#[test]
fn sets_that_wander_on_a_nearly_singular_stiffness_give_way_to_the_interior_point() {
    // A wide Gaussian kernel between points on a line: most of its eigenvalues are the 1e-6 that is added.
    let (n, mut draws) = (80, Draws::new(5));
    let kernel = |i: usize, j: usize| (-((i as f64 - j as f64) / 16.0).powi(2)).exp() + if i == j { 1e-6 } else { 0.0 };
    let sides = |row: usize, dof: usize| if row % n == dof { if row < n { -1.0 } else { 1.0 } } else { 0.0 };
    let problem = Dense {
        stiffness: DMatrix::from_fn(n, n, kernel),
        load: DVector::from_fn(n, |i, _| (9.0 * i as f64 / n as f64).sin() + 0.2 * draws.signed()),
        contact: DMatrix::from_fn(2 * n, n, sides),
        gap: DVector::from_fn(2 * n, |row, _| if row < n { 0.0 } else { 2.0 }),
    };
    let problem = problem.problem().unwrap();
    let [chosen, by_program] = [Method::Auto, Method::qp()]
        .map(|method| solve(&problem, &Settings::with_method(method).with_proof()).unwrap());
    // Sixteen sets, and the steps of the interior point. The dual method takes hundreds.
    assert!(
        chosen.method.contains("interior-point") && chosen.iterations < 60,
        "{} {}",
        chosen.method,
        chosen.iterations
    );
    assert_eq!((&chosen.contact_set, &chosen.proven), (&by_program.contact_set, &by_program.proven));
    assert_eq!(chosen.displacement, by_program.displacement);
}
