//! GOAL: if every unknown has a bound, the cycles of MPRGP do not grow with the mesh, and its contact set is proven.
//!
//! CONDITIONS: a loaded membrane over a staircase (deal.II's step-41), bilinear cells on a square of side 2; a clamped
//! plate of thirteen points over a bowl, whose stiffness is not an M-matrix; a block in space under a sphere.
//!
//! REFERENCE: the contact set of the active set, for the answer itself and for perturbed answers.

use signorini::{ContactProblem, ContactSet, Method, ProvenSet, Settings, Start, solve};
use support::bodies::clamped_block;
use support::floors::{membrane, plate};
use support::oracles::Draws;
use support::scenes::built;

/// Measured: 9 cycles on both meshes; from a start of zero 13 and 22.
const CYCLES: usize = 12;

fn exact(problem: &ContactProblem) -> (Vec<f64>, Vec<f64>, ContactSet) {
    let solution = solve(problem, &Settings::with_method(Method::ActiveSet)).unwrap();
    (solution.displacement, solution.multiplier, solution.contact_set)
}

/// The number of proven rows; asserts that each proof is right.
#[track_caller]
fn proven_rightly(proven: &ProvenSet, exact: &ContactSet, what: &str) -> usize {
    for row in 0..exact.rows() {
        assert!(!proven.open.contains(row) || !exact.contains(row), "{what}: row {row} is closed, not open");
        assert!(!proven.closed.contains(row) || exact.contains(row), "{what}: row {row} is open, not closed");
    }
    proven.open.count() + proven.closed.count()
}

#[test]
fn cycles_do_not_grow_with_the_mesh_if_every_unknown_has_a_bound() {
    for n in [63, 127] {
        let problem = membrane(n).unwrap();
        let found = solve(&problem, &Settings::with_method(Method::Mprgp).with_proof()).unwrap();
        assert!(found.iterations <= CYCLES, "{n}: {} cycles", found.iterations);
        let proven = found.proven.unwrap();
        assert_eq!(proven.undecided().count(), 0, "{n}");
        assert_eq!(proven.closed, found.contact_set, "{n}");
        if n == 63 {
            assert_eq!(found.contact_set, exact(&problem).2);
        }
    }
}

#[test]
fn the_start_from_the_second_level_saves_cycles_and_keeps_the_contact_set() {
    let problem = membrane(127).unwrap();
    let settings = Settings::with_method(Method::Mprgp);
    let prepared = signorini::Prepared::new(&problem, &settings).unwrap();
    let nested = prepared.solve(problem.gap()).unwrap();
    let zero = prepared.starting_from(ContactSet::open(problem.rows())).solve(problem.gap()).unwrap();
    assert_eq!(nested.contact_set, zero.contact_set);
    assert!(3 * nested.iterations < 2 * zero.iterations, "{} and {} cycles", nested.iterations, zero.iterations);
}

/// Measured: 22 cycles from zeros before, and more from a displacement that is rough at the contact front.
#[test]
fn a_displacement_to_start_from_is_never_worse_than_none() {
    let problem = membrane(127).unwrap();
    let prepared = signorini::Prepared::new(&problem, &Settings::with_method(Method::Mprgp)).unwrap();
    let none = prepared.solve(problem.gap()).unwrap();
    let size = none.displacement.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
    let mut draws = Draws::new(3);
    let mut of = |scale: f64, noise: f64| -> Vec<f64> {
        none.displacement.iter().map(|u| scale * u + noise * size * draws.signed()).collect()
    };
    let starts = [of(0.0, 0.0), of(1.0, 0.0), of(0.9, 0.0), of(1.5, 0.0), of(1.0, 1e-2), of(0.0, 1.0), of(-1.0, 0.0)];
    let from = |start: &Vec<f64>| prepared.starting_from(Start::near(start.clone())).solve(problem.gap()).unwrap();
    let cycles: Vec<usize> = starts.iter().map(|start| from(start).iterations).collect();
    assert!(cycles.iter().all(|&cycles| cycles <= none.iterations), "{cycles:?}, {} without", none.iterations);
    assert!(cycles[1] < none.iterations / 2, "from the answer: {cycles:?}, {} without", none.iterations);
}

/// A column of ones is what a scalar problem has anyway.
#[test]
fn ones_as_the_near_null_space_of_a_membrane_change_nothing() {
    let problem = membrane(63).unwrap();
    let ones = signorini::qp::NearNullSpace::new(vec![vec![1.0; problem.dofs()]], problem.dofs()).unwrap();
    let with_ones = problem.clone().with_near_null(ones).unwrap();
    let estimate = signorini::qp::Estimate::of;
    assert_eq!(estimate(&with_ones), estimate(&problem));
    let iterated = |problem: &ContactProblem| solve(problem, &Settings::default()).unwrap();
    let (with, without) = (iterated(&with_ones), iterated(&problem));
    assert_eq!((with.method, with.iterations), (without.method, without.iterations));
}

/// The proof uses the selected inverse for the plate, and one solve for the membrane.
#[test]
fn no_row_of_a_perturbed_answer_is_proven_wrongly() {
    for (problem, name) in [(membrane(31).unwrap(), "membrane"), (plate(24).unwrap(), "plate")] {
        let (u, lambda, set) = exact(&problem);
        let size = u.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
        let mut draws = Draws::new(7);
        let mut counts = Vec::new();
        for exponent in [-12, -9, -6, -4, -2, -1] {
            let moved: Vec<f64> = u.iter().map(|u| u + size * 10.0_f64.powi(exponent) * draws.signed()).collect();
            let proven = problem.prove(&moved, &lambda).unwrap().unwrap();
            counts.push(proven_rightly(&proven, &set, &format!("{name}, 1e{exponent}")));
        }
        assert_eq!(counts[0], problem.rows(), "{name}: {counts:?}");
        assert!(counts.windows(2).all(|pair| pair[0] >= pair[1]) && counts[5] < problem.rows(), "{name}: {counts:?}");
    }
}

#[test]
fn a_block_in_space_has_its_contact_set_proven_without_a_factor() {
    let problem = built(&clamped_block(12, -0.01)).problem().clone();
    let set = exact(&problem).2;
    let found = solve(&problem, &Settings::with_method(Method::Mprgp).with_proof()).unwrap();
    let proven = proven_rightly(&found.proven.unwrap(), &set, "block");
    assert!(10 * proven >= 9 * problem.rows(), "{proven} of {} rows", problem.rows());
}
