//! Natural vibrations of matrices, beside a dense solver.

use signorini::qp::{Watch, dot};
use signorini::{ContactProblem, SparseMatrix, SymmetricMatrix};
use support::oracles::modes::eigenvalues;

fn symmetric(dim: usize, entries: &[(usize, usize, f64)]) -> SymmetricMatrix {
    SymmetricMatrix::from_lower(SparseMatrix::from_triplets(dim, dim, entries).unwrap()).unwrap()
}

/// A problem without rows and loads.
fn problem([stiffness, _]: &[SymmetricMatrix; 2]) -> ContactProblem {
    let no_rows = SparseMatrix::from_triplets(0, stiffness.dim(), &[]).unwrap();
    ContactProblem::new(stiffness.clone(), vec![0.0; stiffness.dim()], no_rows, Vec::new()).unwrap()
}

/// Chains of `length` masses of linear elements each, held at one end by a spring of stiffness `held`.
fn chains(number: usize, length: usize, held: f64) -> [SymmetricMatrix; 2] {
    let (mut stiffness, mut mass) = (Vec::new(), Vec::new());
    for first in (0..number).map(|chain| chain * length) {
        stiffness.push((first, first, held));
        for node in first..first + length - 1 {
            stiffness.extend([(node, node, 1.0), (node + 1, node, -1.0), (node + 1, node + 1, 1.0)]);
            mass.extend([(node, node, 1.0 / 3.0), (node + 1, node, 1.0 / 6.0), (node + 1, node + 1, 1.0 / 3.0)]);
        }
    }
    [stiffness, mass].map(|entries| symmetric(number * length, &entries))
}

fn check(matrices: &[SymmetricMatrix; 2], count: usize) -> Vec<f64> {
    let [stiffness, mass] = matrices;
    let problem = problem(matrices);
    let found = problem.modes(mass, (&[], &[]), count, 2, &Watch::default()).unwrap();
    let no_rows = SparseMatrix::from_triplets(0, mass.dim(), &[]).unwrap();
    let exact = eigenvalues(stiffness, mass, (&no_rows, &[]), count);
    assert_eq!(found.values.len(), count.min(exact.len()));
    assert!(found.is_complete);
    // The dense solver rounds with the largest eigenvalue.
    let rounding = 1e-13 * exact.last().unwrap();
    for ((value, exact), residual) in found.values.iter().zip(&exact).zip(&found.residuals) {
        assert!((value - exact).abs() <= 1e-10 * exact.abs() + rounding, "{value} {exact}");
        assert!(*residual < 1e-6, "{residual}");
    }
    for (i, one) in found.vectors.iter().enumerate() {
        for (j, other) in found.vectors.iter().enumerate() {
            let product = dot(one, &mass.mul(other));
            assert!((product - f64::from(u8::from(i == j))).abs() < 1e-8, "{i} {j} {product}");
        }
    }
    found.values
}

#[test]
fn values_are_those_of_a_dense_solver() {
    for (length, count) in [(2, 1), (2, 2), (3, 5), (40, 1), (40, 7), (40, 40), (150, 12)] {
        check(&chains(1, length, 1.0), count);
    }
}

/// `K x - w M x = B' lambda` with lambda on the held rows alone, `B x = 0` there, and `x'M x = 1`, in any unit of K.
#[test]
fn held_rows_carry_what_is_left_and_each_vector_has_mass_one() {
    let [_, mass] = chains(1, 9, 1.0);
    let entries = [(0, 0, 1.0), (0, 3, -0.7), (1, 3, 0.4), (1, 8, 1.3), (2, 5, 2.0), (3, 1, 1.0)];
    let rows = SparseMatrix::from_triplets(4, 9, &entries).unwrap();
    for unit in [1.0, 2.0, 3e-7, 6e-7, 4e11] {
        let [stiffness, _] = chains(1, 9, 1.0);
        let scaled: Vec<_> = stiffness.lower().triplets().map(|(i, j, value)| (i, j, unit * value)).collect();
        let stiffness = symmetric(9, &scaled);
        let problem = ContactProblem::new(stiffness.clone(), vec![0.0; 9], rows.clone(), vec![0.0; 4]).unwrap();
        let found = problem.modes(&mass, (&[0, 1, 3], &[]), 4, 1, &Watch::default()).unwrap();
        let exact = eigenvalues(&stiffness, &mass, (&rows, &[0, 1, 3]), 4);
        assert_eq!(found.values.len(), 4);
        let pairs = found.values.iter().zip(&found.vectors).zip(&found.multipliers).zip(&exact);
        for (((&value, x), lambda), exact) in pairs {
            assert!((value / exact - 1.0).abs() < 1e-12, "{value} {exact}");
            assert!((dot(x, &mass.mul(x)) - 1.0).abs() < 1e-12);
            assert!(lambda[2] == 0.0 && lambda[0] != 0.0 && lambda[1] != 0.0 && lambda[3] != 0.0, "{lambda:?}");
            let moved = rows.mul(x);
            assert!([0, 1, 3].iter().all(|&row| moved[row].abs() < 1e-12), "{moved:?}");
            let forces = rows.mul_transposed(lambda).into_iter().zip(stiffness.mul(x)).zip(mass.mul(x));
            // Terms of order of the unit.
            let left = forces.map(|((force, k), m)| (k - value * m - force).abs()).fold(0.0, f64::max);
            assert!(left < 1e-10 * unit, "{left}");
        }
    }
}

#[test]
fn equal_bodies_have_equal_values_and_none_is_missed() {
    // Twelve of each value: more than the width of a block.
    for count in [1, 5, 12, 13, 24] {
        let found = check(&chains(12, 40, 1.0), count);
        assert!(found.iter().take(12).all(|value| (value / found[0] - 1.0).abs() < 1e-10));
    }
}

#[test]
fn free_bodies_have_zeros_and_soft_springs_have_none() {
    let found = check(&chains(3, 60, 0.0), 7);
    assert_eq!(found[..3], [0.0; 3]);
    assert!(found[3] > 0.0);
    // A body on a spring of 1e-9: its mass is 59.
    let found = check(&chains(1, 60, 1e-9), 6);
    assert!((found[0] / (1e-9 / 59.0) - 1.0).abs() < 1e-4, "{found:?}");
}

#[test]
fn unknowns_without_mass_have_no_modes() {
    let [stiffness, mass] = chains(1, 6, 1.0);
    let entries: Vec<_> = mass.lower().triplets().filter(|entry| entry.0 < 4 && entry.1 < 4).collect();
    let mass = symmetric(6, &entries);
    let problem = problem(&[stiffness, mass.clone()]);
    let found = problem.modes(&mass, (&[], &[]), 6, 1, &Watch::default()).unwrap();
    assert_eq!(found.values.len(), 4);
}

/// A spring whose only row is closed.
#[test]
fn unknowns_that_held_rows_leave_no_freedom_have_no_modes() {
    let one = symmetric(1, &[(0, 0, 2.0)]);
    let row = SparseMatrix::from_triplets(1, 1, &[(0, 0, 1.0)]).unwrap();
    let problem = ContactProblem::new(one.clone(), vec![0.0], row, vec![0.0]).unwrap();
    let found = problem.modes(&one, (&[0], &[]), 1, 1, &Watch::default()).unwrap();
    assert!(found.values.is_empty() && found.vectors.is_empty(), "{found:?}");
}
