//! GOAL: in a problem of separate parts, each part gets the answer that it has alone, in terms of the whole problem.
//!
//! CONDITIONS: 44 strings over obstacles, of 99 dofs each, with stiffness over four decades. The dofs of the strings
//! alternate, so that no part is a range of dofs. Together the strings are large enough to be solved in pieces.
//! REFERENCE: the closed form, which is exact at the nodes; `certify`, which factorises the whole problem.

use signorini::qp::{Error, InteriorPoint};
use signorini::{ContactProblem, Method, Settings, Solution, solve};
use support::closed_forms::ObstacleString;
use support::problems::of_entries;

const STRINGS: usize = 44;
const CELLS: usize = 100;
const DOFS: usize = CELLS - 1;

/// Load and gap of a string of unit stiffness whose contact begins at a node, a different node for each string.
fn closed_form(string: usize) -> ObstacleString {
    let (gap, edge) = (0.08, (5 + string) as f64 / CELLS as f64);
    ObstacleString { load: 2.0 * gap / (edge * edge), gap }
}

fn stiffness_of(string: usize) -> f64 {
    10.0_f64.powf(4.0 * string as f64 / STRINGS as f64)
}

fn dof(string: usize, place: usize) -> usize {
    place * STRINGS + string
}

/// Entries of K, load, entries of B, and gaps of the strings; a test may change them.
type Parts = (Vec<(usize, usize, f64)>, Vec<f64>, Vec<(usize, usize, f64)>, Vec<f64>);

fn strings(change: impl FnOnce(&mut Parts)) -> ContactProblem {
    let (dofs, h) = (STRINGS * DOFS, 1.0 / CELLS as f64);
    let mut parts: Parts = (Vec::new(), vec![0.0; dofs], Vec::new(), Vec::new());
    let (entries, load, contact, gap) = &mut parts;
    for string in 0..STRINGS {
        let (stiffness, form) = (stiffness_of(string), closed_form(string));
        for place in 0..DOFS {
            let own = dof(string, place);
            entries.push((own, own, 2.0 * stiffness / h));
            if place + 1 < DOFS {
                entries.push((dof(string, place + 1), own, -stiffness / h));
            }
            load[own] = -stiffness * form.load * h;
            contact.push((gap.len(), own, -1.0));
            gap.push(form.gap);
        }
    }
    change(&mut parts);
    let (entries, load, contact, gap) = parts;
    of_entries(&entries, load, &contact, gap)
}

fn check(problem: &ContactProblem, solution: &Solution) {
    for string in 0..STRINGS {
        let form = closed_form(string);
        for place in 0..DOFS {
            let exact = form.displacement((place + 1) as f64 / CELLS as f64);
            let found = solution.displacement[dof(string, place)];
            // 1e-11: the condition number of a string, 4e3, times rounding, with a margin.
            assert!((found - exact).abs() < 1e-11 * form.gap, "string {string}, place {place}: {found}, exact {exact}");
        }
        let force = -solution.multiplier[string * DOFS..(string + 1) * DOFS].iter().sum::<f64>() / stiffness_of(string);
        assert!((force - form.force()).abs() < 1e-9, "string {string}: force {force}, exact {}", form.force());
    }
    assert_eq!(solution.attempts, [], "the first attempt is certified");
    let whole = problem.certify(&solution.displacement, &solution.multiplier).unwrap();
    assert_eq!((whole.parts, solution.certificate.parts), (STRINGS, STRINGS));
    assert_eq!(whole.conditions(), solution.certificate.conditions());
    // Both are upper bounds on the same error, one from the factor of the whole and one from the factors of the pieces.
    for (of_whole, of_pieces) in [
        (whole.energy_error_bound, solution.certificate.energy_error_bound),
        (whole.part_error_bound, solution.certificate.part_error_bound),
    ] {
        assert!(of_pieces < 1e-9 && of_pieces > 0.1 * of_whole, "{of_pieces:e} for {of_whole:e}");
    }
}

#[test]
fn strings_side_by_side_are_each_exact_at_their_nodes() {
    let problem = strings(|_| ());
    for method in [Method::Auto, Method::ActiveSet, Method::qp(), Method::Mprgp] {
        let mut solution = solve(&problem, &Settings::with_method(method).with_proof()).unwrap();
        if method == Method::Mprgp {
            // The bound of MPRGP is about 1e-10; so only the bound is checked here, not the closed form.
            assert!(solution.certificate.energy_error_bound < 1e-9);
            continue;
        }
        let proven = solution.proven.take().unwrap();
        // The row at the edge of the contact has neither force nor distance: it stays undecided, or rounding decides
        // it.
        assert!(proven.undecided().count() <= 2 * STRINGS, "{method:?}: {} undecided", proven.undecided().count());
        assert!(proven.closed.iter().all(|row| solution.contact_set.contains(row)));
        check(&problem, &solution);
    }
}

/// The bound of a loose answer is far above rounding: the bound of the pieces equals that of the whole, and is not
/// below the error.
#[test]
fn the_bound_of_the_pieces_of_a_loose_answer_equals_that_of_the_whole() {
    let problem = strings(|_| ());
    let exact = solve(&problem, &Settings::default()).unwrap();
    let loose = Method::Qp(InteriorPoint { polish: false, tolerance: 1e-3 });
    let settings = Settings::with_method(loose).with_accuracy(0.5);
    let solution = solve(&problem, &settings).unwrap();
    let whole = problem.certify(&solution.displacement, &solution.multiplier).unwrap().energy_error_bound;
    let bound = solution.certificate.energy_error_bound;
    // Both sum the squared errors of the strings, which are far above rounding.
    assert!(bound > 1e-4 && (bound / whole - 1.0).abs() < 1e-6, "{bound:e} by pieces, {whole:e} as a whole");
    let moved: Vec<f64> = solution.displacement.iter().zip(&exact.displacement).map(|(u, exact)| u - exact).collect();
    let energy = |v: &[f64]| v.iter().zip(problem.stiffness().mul(v)).map(|(v, force)| v * force).sum::<f64>().sqrt();
    assert!(energy(&moved) <= bound * energy(&solution.displacement));
}

#[test]
fn the_history_shows_the_sets_of_all_parts() {
    let solution = solve(&strings(|_| ()), &Settings::with_method(Method::ActiveSet)).unwrap();
    let last = &solution.history.last().unwrap().contact_set;
    assert_eq!((last, solution.iterations), (&solution.contact_set, solution.history.len()));
    assert!(solution.history.iter().all(|step| step.contact_set.rows() == STRINGS * DOFS));
}

/// A row without obstacle does not join its strings into one part.
#[test]
fn a_row_without_obstacle_changes_nothing() {
    let problem = strings(|(_, _, contact, gap)| {
        (0..STRINGS).for_each(|string| contact.push((gap.len(), dof(string, 7), 1.0)));
        gap.push(f64::INFINITY);
    });
    let solution = solve(&problem, &Settings::default()).unwrap();
    assert_eq!(solution.multiplier.last(), Some(&0.0));
    check(&problem, &solution);
}

/// The last string has no supports, and its load pulls it off its obstacle.
#[test]
fn the_motion_of_an_unbounded_part_is_given_in_dofs_of_the_whole() {
    let (loose, h) = (STRINGS - 1, 1.0 / CELLS as f64);
    let problem = strings(|(entries, load, ..)| {
        for end in [0, DOFS - 1] {
            entries.push((dof(loose, end), dof(loose, end), -stiffness_of(loose) / h));
        }
        (0..DOFS).for_each(|place| load[dof(loose, place)] *= -1.0);
    });
    let Err(Error::Unbounded { direction, .. }) = solve(&problem, &Settings::default()) else { panic!() };
    assert_eq!(direction.len(), STRINGS * DOFS);
    let moves = |dof: &usize| direction[*dof].abs() > 1e-6;
    assert!((0..direction.len()).filter(moves).eq((0..DOFS).map(|place| dof(loose, place))));
}

/// Two rows demand that the last string is above 0.1 and below 0 at one place.
#[test]
fn contradicting_rows_are_given_as_rows_of_the_whole() {
    let problem = strings(|(_, _, contact, gap)| {
        let own = dof(STRINGS - 1, 50);
        contact.extend([(gap.len(), own, 1.0), (gap.len() + 1, own, -1.0)]);
        gap.extend([0.0, -0.1]);
    });
    let first = STRINGS * DOFS;
    let Err(Error::Infeasible { rows, .. }) = solve(&problem, &Settings::default()) else { panic!() };
    assert_eq!(rows, [first, first + 1]);
}

#[test]
fn a_solve_without_time_left_returns_an_answer_of_the_whole() {
    let settings = Settings::default().with_time(std::time::Duration::ZERO);
    let Err(Error::NotCertified { solution, .. }) = solve(&strings(|_| ()), &settings) else { panic!() };
    assert_eq!((solution.displacement.len(), solution.multiplier.len()), (STRINGS * DOFS, STRINGS * DOFS));
}
