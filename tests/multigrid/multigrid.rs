//! GOAL: the multigrid hierarchy gives the answer of the Cholesky factor, in a number of cycles that hardly grows.
//!
//! CONDITIONS: blocks in space clamped at the bottom, a plane body with rollers, a scalar problem, single and double
//! precision, one thread and two; near-null spaces that do not match the problem.

use serde_json::json;
use signorini::qp::{Cholesky, LinearError, Multigrid, NearNullSpace, Width};
use signorini::{ContactProblem, SparseMatrix, SymmetricMatrix};
use support::bodies::{clamped_block, clamped_square, largest};
use support::oracles::Draws;
use support::scenes::built;

/// Relative residual at which the iteration ends.
const TOLERANCE: f64 = 1e-10;

/// The error of the displacement is the residual times the condition number, 1e3 for these blocks.
const SAME: f64 = 1e-7;

/// The cycle is symmetric up to the rounding of single precision.
const SYMMETRIC: f64 = 1e-5;

/// Measured: 9 to 12 cycles to 1e-10, from 5,000 to 100,000 dofs; a reference hierarchy takes about 12.
const MOST_CYCLES: usize = 14;

/// A block of `cells` cells along each side, clamped at the bottom, under a sphere.
fn block(cells: usize) -> ContactProblem {
    built(&clamped_block(cells, -0.01)).problem().clone()
}

/// A square on rollers at its sides, clamped at the bottom.
fn square_on_rollers(cells: usize) -> ContactProblem {
    let mut scene = clamped_square(
        cells,
        json!([{"boundary": "top", "approach": "+y", "shape": {"plane": {"point": [0, 1], "normal": [0, 1]}}}]),
        0.0,
    );
    let sides = json!({"on": {"boundary": "left"}, "x": 0});
    scene["supports"].as_array_mut().unwrap().push(sides);
    built(&scene).problem().clone()
}

fn hierarchy(problem: &ContactProblem, precision: Width, threads: usize) -> Multigrid {
    let near_null = problem.near_null().expect("a body has rigid-body modes");
    Multigrid::with_precision(problem.stiffness(), near_null, threads, precision).unwrap()
}

fn pressed(problem: &ContactProblem) -> Vec<f64> {
    problem.contact().mul_transposed(&vec![-1.0; problem.rows()])
}

#[test]
fn conjugate_gradients_with_one_cycle_agree_with_the_cholesky_factor() {
    for problem in [block(10), square_on_rollers(40)] {
        let load = pressed(&problem);
        let exact = Cholesky::of(problem.stiffness()).unwrap().solve(&load);
        let multigrid = hierarchy(&problem, Width::Single, 1);
        let found = multigrid.preconditioning(problem.stiffness()).solve(&load, TOLERANCE, 50).unwrap();
        assert!(multigrid.unknowns().len() > 1, "there is no coarse level");
        assert!(found.residual <= TOLERANCE && found.cycles <= MOST_CYCLES, "{} cycles", found.cycles);
        let error = exact.iter().zip(&found.solution).fold(0.0, |error: f64, (a, b)| error.max((a - b).abs()));
        assert!(error <= SAME * largest(&exact), "{error:e} of {:e}", largest(&exact));
    }
}

#[test]
fn cycles_hardly_grow_with_the_number_of_unknowns() {
    let cycles = [8, 16, 24].map(|cells| {
        let problem = block(cells);
        let multigrid = hierarchy(&problem, Width::Single, 1);
        multigrid.preconditioning(problem.stiffness()).solve(&pressed(&problem), TOLERANCE, 50).unwrap().cycles
    });
    assert!(cycles[2] <= MOST_CYCLES && cycles[2] <= cycles[0] + 4, "{cycles:?} cycles");
}

#[test]
fn single_and_double_precision_need_the_same_number_of_cycles() {
    let problem = block(10);
    let cycles = [Width::Single, Width::Double].map(|precision| {
        let multigrid = hierarchy(&problem, precision, 1);
        multigrid.preconditioning(problem.stiffness()).solve(&pressed(&problem), TOLERANCE, 50).unwrap().cycles
    });
    assert!(cycles[0].abs_diff(cycles[1]) <= 1, "{cycles:?}");
}

#[test]
fn the_cycle_is_symmetric_and_the_same_with_two_threads() {
    let problem = block(16);
    let one = hierarchy(&problem, Width::Single, 1);
    let mut draws = Draws::new(7);
    let [x, y]: [Vec<f64>; 2] = [0, 1].map(|_| (0..problem.dofs()).map(|_| draws.signed()).collect());
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (of_x, of_y) = (one.cycle(&x), one.cycle(&y));
    let size = (product(&x, &of_x) * product(&y, &of_y)).sqrt();
    assert!(product(&x, &of_x) > 0.0);
    assert!((product(&y, &of_x) - product(&x, &of_y)).abs() <= SYMMETRIC * size);
    assert_eq!(hierarchy(&problem, Width::Single, 2).cycle(&x), of_x);
    // The products in double precision are the same as well: their sums are over fixed parts, whichever thread computes
    // them.
    let large = block(20);
    assert!(large.stiffness().lower().entries() > 500_000, "the matrix is too small for several parts");
    let x: Vec<f64> = (0..large.dofs()).map(|_| draws.signed()).collect();
    let products = [1, 2, 3, 8].map(|threads| large.stiffness().mul_on(threads, &x));
    assert!(products.iter().all(|product| *product == products[0]));
    let (whole, terms) = (large.stiffness().mul(&x), large.stiffness().mul_abs(&x));
    assert!((0..x.len()).all(|i| (whole[i] - products[0][i]).abs() <= 1e-14 * terms[i]));
}

#[test]
fn a_scalar_problem_is_solved_with_constants() {
    // The five-point Laplacian of a square of 60 x 60 points with a fixed boundary.
    let points = 60;
    let mut entries = Vec::new();
    for row in 0..points {
        for column in 0..points {
            let at = row * points + column;
            entries.push((at, at, 4.0));
            entries.extend((column + 1 < points).then_some((at + 1, at, -1.0)));
            entries.extend((row + 1 < points).then_some((at + points, at, -1.0)));
        }
    }
    let dim = points * points;
    let matrix = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(dim, dim, &entries).unwrap()).unwrap();
    let constants = NearNullSpace::constants(&matrix).unwrap();
    assert_eq!(constants.count(), 1);
    let multigrid = Multigrid::new(&matrix, &constants, 1).unwrap();
    let load = vec![1.0; dim];
    let found = multigrid.preconditioning(&matrix).solve(&load, TOLERANCE, 50).unwrap();
    let exact = Cholesky::of(&matrix).unwrap().solve(&load);
    assert!(found.cycles <= MOST_CYCLES, "{} cycles", found.cycles);
    let error = exact.iter().zip(&found.solution).fold(0.0, |error: f64, (a, b)| error.max((a - b).abs()));
    assert!(error <= SAME * largest(&exact), "{error:e}");
}

#[test]
fn near_null_spaces_that_do_not_match_the_problem_are_refused_by_name() {
    let problem = block(4);
    let dofs = problem.dofs();
    let short = NearNullSpace::new(vec![vec![1.0; dofs - 1]], dofs);
    let short = short.unwrap_err().to_string();
    assert_eq!(short, format!("near-null vector has length {}, but there are {dofs} dofs", dofs - 1));
    let ramp: Vec<f64> = (0..dofs).map(|dof| dof as f64).collect();
    let twice: Vec<f64> = ramp.iter().map(|value| 2.0 * value).collect();
    let dependent = NearNullSpace::new(vec![vec![1.0; dofs], ramp, twice], dofs).unwrap_err();
    assert!(dependent.to_string().starts_with("the rank of the near-null space is 2; it must be"), "{dependent}");
    assert!(dependent.to_string().contains("linearly independent"), "{dependent}");
    assert!(NearNullSpace::new(Vec::new(), dofs).is_err());
    assert!(matches!(NearNullSpace::new(vec![vec![f64::NAN; dofs]], dofs), Err(LinearError::NotFinite { .. })));
    let other = NearNullSpace::new(vec![vec![1.0; dofs + 1]], dofs + 1).unwrap();
    assert!(matches!(Multigrid::new(problem.stiffness(), &other, 1), Err(LinearError::Length { .. })));
    assert!(problem.with_near_null(other).is_err());
}

#[test]
fn a_matrix_with_a_negative_eigenvalue_is_refused() {
    let problem = block(6);
    let lower = problem.stiffness().lower();
    let shift = 0.2 * largest(&problem.stiffness().diagonal());
    let entries: Vec<_> = lower
        .triplets()
        .map(|(row, column, value)| (row, column, if row == column { value - shift } else { value }))
        .collect();
    let dim = problem.dofs();
    let matrix = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(dim, dim, &entries).unwrap()).unwrap();
    let near_null = problem.near_null().unwrap();
    let refused = match Multigrid::new(&matrix, near_null, 1) {
        Ok(multigrid) => multigrid.preconditioning(&matrix).solve(&pressed(&problem), TOLERANCE, 200).map(|_| ()),
        Err(error) => Err(error),
    };
    assert!(matches!(refused, Err(LinearError::NotConvex { .. })), "{refused:?}");
}
