//! GOAL: every claim about a problem without a unique answer is true, and all methods make the same claim.
//!
//! CONDITIONS: a stiffness that resists no motion, or not every motion; loads in balance and not in balance; rows that
//! stop the motion in one direction, in both or in none. REFERENCE: the answers follow directly from the data.

use signorini::qp::{Error, LinearError, NearNullSpace};
use signorini::{ContactProblem, Method, Settings, Solution, solve};
use support::endings::best;
use support::problems::of_entries;

const ALL: [Method; 5] = [Method::Auto, Method::qp(), Method::ActiveSet, Method::penalty(), Method::Mprgp];

/// A problem from its entries: K by its lower triangle, f, B by rows, g.
fn problem(stiffness: &[(usize, usize, f64)], load: &[f64], rows: &[&[f64]], gap: &[f64]) -> ContactProblem {
    let entries: Vec<(usize, usize, f64)> = (rows.iter().enumerate())
        .flat_map(|(row, of_row)| of_row.iter().enumerate().map(move |(dof, &b)| (row, dof, b)))
        .filter(|entry| entry.2 != 0.0)
        .collect();
    of_entries(stiffness, load.to_vec(), &entries, gap.to_vec())
}

/// Two masses joined by a spring, without supports.
const SPRING: [(usize, usize, f64); 3] = [(0, 0, 1.0), (1, 0, -1.0), (1, 1, 1.0)];

fn endings(problem: &ContactProblem) -> impl Iterator<Item = (&'static str, Result<Solution, Error>)> + '_ {
    ALL.into_iter().map(|method| (method.name(), solve(problem, &Settings::with_method(method))))
}

/// Whether numbers of order one are those of the exact answer: the best penalty is 1e8 times the stiffness.
fn is_near(values: &[f64], exact: &[f64]) -> bool {
    values.len() == exact.len() && values.iter().zip(exact).all(|(value, exact)| (value - exact).abs() < 1e-7)
}

#[test]
fn a_stiffness_of_zero_without_load_is_under_held() {
    let problem = problem(&[], &[0.0, 0.0], &[&[1.0, 0.0]], &[1.0]);
    for (method, ending) in endings(&problem) {
        assert!(matches!(ending, Err(Error::UnderHeld { .. })), "{method}: {ending:?}");
    }
}

#[test]
fn a_loaded_dof_held_by_a_row_alone_is_at_its_gap() {
    let problem = problem(&[(0, 0, 2.0)], &[2.0, 3.0], &[&[0.0, 1.0]], &[0.5]);
    for (method, ending) in endings(&problem) {
        // The certificate decides whether there is a bound on the error; no claim about the problem is allowed.
        let solution = best(ending);
        assert!(is_near(&solution.displacement, &[1.0, 0.5]), "{method}: {solution:?}");
        assert!(is_near(&solution.multiplier, &[-3.0]), "{method}: {solution:?}");
    }
}

#[test]
fn a_load_away_from_the_only_row_is_unbounded_along_the_translation() {
    let problem = problem(&SPRING, &[0.0, -1.0], &[&[1.0, 0.0]], &[1.0]);
    for (method, ending) in endings(&problem) {
        let Err(Error::Unbounded { direction, .. }) = ending else { panic!("{method}: {ending:?}") };
        assert_eq!(direction, [-1.0, -1.0], "{method}");
    }
}

#[test]
fn a_body_with_a_load_in_balance_is_under_held_and_not_unbounded() {
    let problem = problem(&SPRING, &[0.25, -0.25], &[&[1.0, 0.0]], &[1.0]);
    for (method, ending) in endings(&problem) {
        let Err(Error::UnderHeld { direction, .. }) = ending else { panic!("{method}: {ending:?}") };
        assert_eq!(direction[0], direction[1], "{method}");
    }
}

#[test]
fn a_body_whose_row_touches_with_the_force_of_rounding_is_under_held() {
    // A spring to the ground, and three masses that springs join to each other alone; the row touches wherever a method
    // puts them, but nothing presses it.
    let ends = [(0, 0, 1.625), (1, 1, 0.1953125), (2, 1, -0.09375), (3, 1, -0.1015625)];
    let stiffness = [&ends[..], &[(2, 2, 7.59375), (3, 2, -7.5), (3, 3, 7.6015625)]].concat();
    let rows: [&[f64]; 2] = [&[-1.0, 1.0, 1.0, -1.0], &[0.0, 0.0, 0.0, -1.0]];
    let problem = problem(&stiffness, &[0.0; 4], &rows, &[0.05152083095163107, 1e-3]);
    for (method, ending) in endings(&problem) {
        assert!(matches!(ending, Err(Error::UnderHeld { .. })), "{method}: {ending:?}");
    }
}

#[test]
fn a_body_that_slides_between_two_walls_it_does_not_touch_is_under_held() {
    // A floor carries the load of 3; two walls at a distance of 5 allow the body to slide.
    let rows: [&[f64]; 3] = [&[0.0, 1.0], &[1.0, 0.0], &[-1.0, 0.0]];
    let problem = problem(&[], &[0.0, 3.0], &rows, &[0.0, 5.0, 5.0]);
    for (method, ending) in endings(&problem) {
        let Err(Error::UnderHeld { direction, .. }) = ending else { panic!("{method}: {ending:?}") };
        assert_eq!((direction[0].abs(), direction[1]), (1.0, 0.0), "{method}");
    }
}

#[test]
fn a_dof_without_support_is_named_although_one_row_carries_only_the_last_bit_of_a_load() {
    // The load on the last dof differs from that on the second only in its last bit. The second row carries this bit,
    // which is too little to show that the row has a force. The first dof is free, wherever the others are.
    let rows: [&[f64]; 2] = [&[0.0, 1.0, 1.0], &[0.0, 0.0, 1.0]];
    let problem = problem(&[], &[0.0, 1.0, 1.0 + f64::EPSILON], &rows, &[0.0, 0.0]);
    for (method, ending) in endings(&problem) {
        let Err(Error::UnderHeld { direction, .. }) = ending else { panic!("{method}: {ending:?}") };
        assert_eq!((direction[0].abs(), direction[1], direction[2]), (1.0, 0.0, 0.0), "{method}");
    }
}

#[test]
fn rows_that_stop_a_motion_in_both_directions_without_play_support_it() {
    // The first mass is held at 1; the spring under its load of 1/4 is shorter by 1/4.
    let problem = problem(&SPRING, &[0.25, -0.25], &[&[1.0, 0.0], &[-1.0, 0.0]], &[1.0, -1.0]);
    for (method, ending) in endings(&problem) {
        // The certificate decides whether there is a bound on the error; no claim about the problem is allowed.
        let solution = best(ending);
        assert!(is_near(&solution.displacement, &[1.0, 0.75]), "{method}: {solution:?}");
        // Both rows together carry no force.
        let carried = solution.multiplier[0] - solution.multiplier[1];
        assert!(is_near(&[carried], &[0.0]) && solution.multiplier.iter().all(|l| *l <= 0.0), "{method}: {solution:?}");
    }
}

#[test]
fn a_negative_eigenvalue_is_named_with_the_tolerance_of_its_recheck() {
    let problem = problem(&[(0, 0, 1.0), (1, 0, 2.0), (1, 1, 1.0)], &[1.0, 0.0], &[&[1.0, 0.0]], &[1.0]);
    for (method, ending) in endings(&problem) {
        let Err(Error::Linear(LinearError::NotConvex { evidence })) = ending else { panic!("{method}: {ending:?}") };
        assert!(evidence.contains("beyond 1e-12 of its terms"), "{method}: {evidence}");
    }
}

#[test]
fn rows_that_contradict_each_other_are_infeasible_although_the_load_drives_a_motion_that_none_stops() {
    // Two masses that float under a load, and a third dof that is to be below -1 and above 1. A fourth dof above zero
    // takes part in the second row by 1e-13: no two rows oppose each other.
    let stiffness = [&SPRING[..], &[(2, 2, 1.0), (3, 2, -1.0), (3, 3, 2.0)]].concat();
    let rows: [&[f64]; 3] = [&[0.0, 0.0, 1.0, 0.0], &[0.0, 0.0, -1.0, 1e-13], &[0.0, 0.0, 0.0, -1.0]];
    let problem = problem(&stiffness, &[1.0, 1.0, 0.0, 0.0], &rows, &[-1.0, -1.0, 0.0]);
    for (method, ending) in endings(&problem) {
        let Err(Error::Infeasible { mut rows, overlap, .. }) = ending else { panic!("{method}: {ending:?}") };
        rows.sort_unstable();
        assert!(
            rows.contains(&0) && rows.contains(&1) && (overlap - 2.0).abs() < 1e-9,
            "{method}: {rows:?}, {overlap}"
        );
    }
}

#[test]
fn a_body_whose_rounded_stiffness_is_definite_floats_only_if_its_rigid_motion_is_declared() {
    // Springs of 0.1 and 0.2: the doubles next to 0.1, 0.2 and 0.3 leave 2.8e-17 on the second mass.
    let stiffness = [(0, 0, 0.1), (1, 0, -0.1), (1, 1, 0.1 + 0.2), (2, 1, -0.2), (2, 2, 0.2)];
    for (load, is_driven) in [([0.0, 0.0, -1.0], true), ([0.0; 3], false)] {
        let problem = problem(&stiffness, &load, &[&[1.0, 0.0, 0.0]], &[1e9]);
        for (method, ending) in endings(&problem) {
            let is_claim = matches!(ending, Err(Error::Unbounded { .. } | Error::UnderHeld { .. }));
            assert!(!is_claim, "{method}: {ending:?}");
        }
        let declared = problem.with_near_null(NearNullSpace::new(vec![vec![1.0; 3]], 3).unwrap()).unwrap();
        for (method, ending) in endings(&declared) {
            let direction = match ending {
                Err(Error::Unbounded { direction, .. }) if is_driven => direction,
                Err(Error::UnderHeld { direction, .. }) if !is_driven => direction,
                other => panic!("{method}, {load:?}: {other:?}"),
            };
            assert!(direction.iter().all(|d| (d.abs() - 1.0).abs() < 1e-9), "{method}: {direction:?}");
        }
    }
}
