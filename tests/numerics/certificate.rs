//! GOAL: the numbers of a certificate alone distinguish a wrong answer from a right one.
//! CONDITIONS: the exact answer of a small problem, with one planted fault at a time.

use signorini::qp::Error;
use signorini::{Certificate, ContactProblem, Method, Settings, SparseMatrix, SymmetricMatrix, solve, solve_qp};
use support::oracles::{Dense, Draws, random};
use support::problems::of_entries;

const TOLERANCE: f64 = 1e-9;

fn two_springs() -> (ContactProblem, Vec<f64>, Vec<f64>) {
    let dense = Dense::new(&[&[3.0, -1.0], &[-1.0, 1.0]], &[0.5, 3.0], &[&[0.0, 1.0], &[1.0, 0.0]], &[1.0, 2.0]);
    (dense.problem().unwrap(), vec![0.5, 1.0], vec![-2.5, 0.0])
}

fn certify(u: &[f64], lambda: &[f64]) -> Certificate {
    two_springs().0.certify(u, lambda).unwrap()
}

#[test]
fn exact_answer_is_certified() {
    let (problem, u, lambda) = two_springs();
    let certificate = problem.certify(&u, &lambda).unwrap();
    assert!(certificate.meets(1e-14), "{certificate:?}");
    assert!(certificate.energy_error_bound < 1e-15);
}

#[test]
fn flipped_sign_of_the_contact_force_is_adhesion_and_imbalance() {
    let certificate = certify(&[0.5, 1.0], &[2.5, 0.0]);
    // The row is on the second dof: 2.5 of the 0.5 + 1 of K u, the 2.5 of the row and the 3 of the load.
    assert!((certificate.adhesion - 2.5 / 7.0).abs() < 1e-15, "{certificate:?}");
    assert!(certificate.imbalance > 0.5 && certificate.stationarity > 0.5 && !certificate.meets(1.0));
}

#[test]
fn wrong_signed_force_in_balance_with_a_wrong_load_is_caught_by_its_sign_alone() {
    // u_2 = 4 balances lambda = 0.5: K u = f + B' lambda, and the row is closed at gap 4. Only the sign is wrong.
    let dense = Dense::new(&[&[3.0, -1.0], &[-1.0, 1.0]], &[0.5, 3.0], &[&[0.0, 1.0]], &[2.25 + 3.0]);
    let problem = dense.problem().unwrap();
    let u = [5.75 / 3.0, 5.25];
    let lambda = [-u[0] + u[1] - 3.0];
    let certificate = problem.certify(&u, &lambda).unwrap();
    assert!(certificate.stationarity < 1e-15 && certificate.penetration == 0.0, "{certificate:?}");
    assert!(certificate.complementarity < 1e-15, "{certificate:?}");
    // A force of a third in terms of 4 that cancel down to it.
    assert!(certificate.adhesion > 0.01 && !certificate.meets(1e9), "{certificate:?}");
}

#[test]
fn a_lost_factor_of_two_is_caught() {
    for (u, lambda) in [([0.5, 1.0], [-5.0, 0.0]), ([0.25, 0.5], [-2.5, 0.0]), ([1.0, 2.0], [-2.5, 0.0])] {
        let certificate = certify(&u, &lambda);
        assert!(!certificate.meets(1e-2), "{u:?} {lambda:?}: {certificate:?}");
        // The bound is one on the displacement, which is right in the first case.
        assert!((certificate.energy_error_bound > 0.1) == (u != [0.5, 1.0]), "{certificate:?}");
    }
}

#[test]
fn swapped_rows_are_caught() {
    let certificate = certify(&[0.5, 1.0], &[0.0, -2.5]);
    assert!(certificate.complementarity > 0.5 && certificate.stationarity > 0.5, "{certificate:?}");
}

#[test]
fn penetration_is_measured_relative_to_the_displacement() {
    let certificate = certify(&[0.5, 1.001], &[-2.5, 0.0]);
    assert!((certificate.penetration / (0.001 / 1.001) - 1.0).abs() < 1e-9, "{certificate:?}");
}

#[test]
fn force_over_an_open_gap_is_complementarity() {
    // The row is open by 0.5 and carries the force that balances u = (1/3, 0.5).
    let certificate = certify(&[1.0 / 3.0, 0.5], &[-(3.0 + 1.0 / 3.0 - 0.5), 0.0]);
    assert!(certificate.stationarity < 1e-15 && certificate.adhesion == 0.0, "{certificate:?}");
    assert!(certificate.complementarity > 0.4, "{certificate:?}");
}

/// The bound is never below the true error, and it decreases with the error, for perturbed answers of random problems.
#[test]
fn energy_bound_holds_for_perturbed_answers() {
    let mut draws = Draws::new(4);
    for case in 0..300 {
        let dense = random(&mut draws, 5, 4);
        let problem = dense.problem().unwrap();
        let exact = solve_qp(&problem).unwrap();
        let reference = dense.enumerate().displacement;
        let norm = |v: &nalgebra::DVector<f64>| v.dot(&(&dense.stiffness * v)).max(0.0).sqrt();
        let size = 10.0_f64.powi(-(case % 8));
        let shaken = |values: &[f64], draws: &mut Draws| -> Vec<f64> {
            values.iter().map(|value| value + size * draws.signed()).collect()
        };
        let (u, lambda) = (shaken(&exact.displacement, &mut draws), shaken(&exact.multiplier, &mut draws));
        let bound = problem.certify(&u, &lambda).unwrap().energy_error_bound;
        let u = nalgebra::DVector::from_row_slice(&u);
        let error = norm(&(&u - &reference)) / norm(&u);
        assert!(error <= bound * (1.0 + 1e-6) + 1e-13, "case {case}: error {error:e} is above the bound {bound:e}");
    }
}

#[test]
fn answer_moved_by_ten_tolerances_is_refused() {
    let (problem, u, lambda) = two_springs();
    for entry in 0..2 {
        let mut moved = u.clone();
        moved[entry] *= 1.0 + 10.0 * TOLERANCE;
        assert!(!problem.certify(&moved, &lambda).unwrap().meets(TOLERANCE), "u[{entry}]");
    }
    assert!(!problem.certify(&u, &[lambda[0] * (1.0 + 10.0 * TOLERANCE), 0.0]).unwrap().meets(TOLERANCE));
}

#[test]
fn answers_that_are_not_certified_are_returned_with_their_numbers() {
    let loose = signorini::InteriorPoint { polish: false, tolerance: 1e-2 };
    let settings = Settings::with_method(Method::Qp(loose));
    match solve(&two_springs().0, &settings) {
        Err(Error::NotCertified { solution, value, tolerance, .. }) => {
            assert_eq!(solution.method, "qp-unpolished");
            assert!(value > tolerance && (solution.displacement[1] - 1.0).abs() < 0.1);
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn vectors_of_wrong_length_or_with_values_that_are_not_finite_are_refused_in_one_sentence() {
    let (problem, u, lambda) = two_springs();
    let message = |result: Result<Certificate, Error>| result.unwrap_err().to_string();
    assert_eq!(message(problem.certify(&u[1..], &lambda)), "displacement has length 1, but there are 2 dofs");
    assert_eq!(message(problem.certify(&u, &[])), "multiplier has length 0, but there are 2 contact rows");
    assert!(!problem.certify(&[f64::NAN, 1.0], &lambda).unwrap().meets(TOLERANCE));
    assert!(!problem.certify(&u, &[f64::NAN, 0.0]).unwrap().meets(TOLERANCE));
    assert!(!problem.certify(&u, &[f64::NEG_INFINITY, 0.0]).unwrap().meets(TOLERANCE));
}

#[test]
fn problems_whose_sizes_do_not_match_are_refused_in_one_sentence() {
    let stiffness =
        || SymmetricMatrix::from_lower(SparseMatrix::from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0)]).unwrap());
    let contact = |columns| SparseMatrix::from_triplets(1, columns, &[(0, 0, 1.0)]).unwrap();
    let message = |load: Vec<f64>, columns, gap: Vec<f64>| {
        ContactProblem::new(stiffness().unwrap(), load, contact(columns), gap).unwrap_err().to_string()
    };
    assert_eq!(message(vec![0.0; 3], 2, vec![0.0]), "load vector has length 3, but there are 2 dofs");
    assert_eq!(message(vec![0.0; 2], 3, vec![0.0]), "contact matrix is 1 x 3, but it must be 1 x 2");
    assert_eq!(message(vec![0.0; 2], 2, vec![0.0; 7]), "gap vector has length 7, but there are 1 contact rows");
    assert!(message(vec![0.0, f64::NAN], 2, vec![0.0]).contains("load vector has the value NaN at entry 1"));
    assert!(message(vec![0.0; 2], 2, vec![f64::NEG_INFINITY]).contains("gap vector has the value -inf at entry 0"));
    let one_triangle = SparseMatrix::from_triplets(2, 2, &[(0, 0, 2.0), (1, 0, 1.0), (1, 1, 2.0)]).unwrap();
    let message = SymmetricMatrix::from_full(&one_triangle).unwrap_err().to_string();
    assert!(message.contains("entry (1, 0) is 1e0, entry (0, 1) is 0e0"), "{message}");
    let outside = SparseMatrix::from_triplets(2, 2, &[(2, 0, 1.0)]).unwrap_err().to_string();
    assert!(outside.contains("entry (2, 0) lies outside a matrix of 2 rows"), "{outside}");
}

/// At forces and energies beyond the ends of double precision, the numbers are bit by bit those in units of order one.
#[test]
fn certificate_and_proof_do_not_depend_on_the_units() {
    let (problem, u, lambda) = two_springs();
    let near = [0.5 + 1e-4, 1.0];
    let (certificate, proven) = (problem.certify(&near, &lambda).unwrap(), problem.prove(&u, &lambda).unwrap());
    assert_eq!(proven.as_ref().map(|set| (set.closed.count(), set.open.count())), Some((1, 1)));
    for (stiffness, length) in [(900, 0), (-900, 0), (0, 450), (0, -450), (600, 300), (-450, -450)] {
        let (k, l) = (2_f64.powi(stiffness), 2_f64.powi(length));
        let scaled = |values: &[f64], by: f64| values.iter().map(|value| value * by).collect::<Vec<f64>>();
        let dense = Dense::new(
            &[&[3.0 * k, -k], &[-k, k]],
            &scaled(&[0.5, 3.0], k * l),
            &[&[0.0, 1.0], &[1.0, 0.0]],
            &scaled(&[1.0, 2.0], l),
        );
        let far = dense.problem().unwrap();
        let force = scaled(&lambda, k * l);
        let found = far.certify(&scaled(&near, l), &force).unwrap();
        // The square root of an odd power of two is rounded.
        let bound = found.energy_error_bound / certificate.energy_error_bound;
        assert!((bound - 1.0).abs() < 1e-14, "2^{stiffness}, 2^{length}: {bound}");
        let error = found.energy_error / (certificate.energy_error * k.sqrt() * l);
        assert!((error - 1.0).abs() < 1e-14, "2^{stiffness}, 2^{length}: {error}");
        assert_eq!((found.worst_dof(), found.digits_left()), (certificate.worst_dof(), certificate.digits_left()));
        let of = |certificate: &Certificate| {
            let [stationarity, penetration, adhesion, complementarity, gap] =
                certificate.conditions().map(|(_, value)| value);
            [stationarity, penetration, adhesion, complementarity, gap, certificate.open_force]
        };
        assert_eq!(of(&found), of(&certificate), "2^{stiffness}, 2^{length}");
        assert!((found.imbalance / certificate.imbalance - 1.0).abs() < 1e-14, "2^{stiffness}, 2^{length}");
        assert_eq!(far.prove(&scaled(&u, l), &force).unwrap(), proven, "2^{stiffness}, 2^{length}");
    }
}

#[test]
fn nothing_is_proven_from_values_that_are_not_finite_or_for_a_body_without_an_energy_norm() {
    let (problem, u, lambda) = two_springs();
    assert!(problem.prove(&u, &lambda).unwrap().is_some());
    assert!(problem.prove(&[f64::NAN, 1.0], &lambda).unwrap().is_none());
    assert!(problem.prove(&u, &[f64::NAN, 0.0]).unwrap().is_none());
    // A rod that only its wall holds, a rod without any support, and a dof without stiffness.
    let rod: &[&[f64]] = &[&[1.0, -1.0], &[-1.0, 1.0]];
    for (stiffness, is_bounded) in
        [(rod, false), (&[&[0.0, 0.0], &[0.0, 0.0]], true), (&[&[1.0, 0.0], &[0.0, 0.0]], true)]
    {
        let floating = Dense::new(stiffness, &[0.0, 0.0], &[&[0.0, 1.0]], &[0.0]).problem().unwrap();
        let certificate = floating.certify(&[0.0; 2], &[0.0]).unwrap();
        // The energy does not see a dof without stiffness, but it sees a rod that moves as a whole only up to rounding.
        assert!(certificate.conditions_hold(0.0), "{certificate:?}");
        assert_eq!(
            (certificate.has_bound(), certificate.meets(TOLERANCE)),
            (is_bounded, is_bounded),
            "{certificate:?}"
        );
        assert!(floating.prove(&[0.0; 2], &[0.0]).unwrap().is_none());
        assert!(matches!(solve(&floating, &Settings::default()), Err(Error::UnderHeld { .. })));
    }
}

/// A string of 400 springs of stiffness 1 with a load on each node. Every node is in front of a wall at distance 1: too
/// many rows for a dense boundary. The last row has no entries; its gap is `gap_of_nothing`.
fn string(load: f64, gap_of_nothing: f64) -> ContactProblem {
    let nodes = 400;
    let springs: Vec<_> =
        (0..nodes).map(|node| (node, node, 2.0)).chain((1..nodes).map(|j| (j, j - 1, -1.0))).collect();
    let rows: Vec<_> = (0..nodes).map(|node| (node, node, 1.0)).collect();
    let stiffness = SparseMatrix::from_triplets(nodes, nodes, &springs).unwrap();
    let contact = SparseMatrix::from_triplets(nodes + 1, nodes, &rows).unwrap();
    let gap = [vec![1.0; nodes], vec![gap_of_nothing]].concat();
    ContactProblem::new(SymmetricMatrix::from_lower(stiffness).unwrap(), vec![load; nodes], contact, gap).unwrap()
}

#[test]
fn bound_without_a_dense_boundary_is_near_the_error_of_a_uniform_penetration() {
    let problem = string(3.0, 1.0);
    let mut lambda: Vec<f64> = problem.stiffness().mul(&[1.0; 400]).iter().map(|force| force - 3.0).collect();
    lambda.push(0.0);
    assert!(problem.certify(&[1.0; 400], &lambda).unwrap().meets(TOLERANCE));
    // The energy of a uniform displacement is that of the two springs at the ends; answer and error are uniform.
    for depth in [1e-6, 1e-10] {
        let bound = problem.certify(&[1.0 + depth; 400], &lambda).unwrap().energy_error_bound;
        assert!((depth * (1.0 - 2e-6)..3.0 * depth).contains(&bound), "{depth:e}: {bound:e}");
    }
    let proven = problem.prove(&[1.0; 400], &lambda).unwrap().unwrap();
    assert_eq!((proven.closed.count(), proven.open.count()), (400, 1));
}

/// A string of 401 nodes, each held by a ground spring of stiffness 1/2, is pressed against a wall at its middle; the
/// other walls are far. The bound moves the middle node to its wall, lets the body follow, and takes the force of the
/// wall into account; this keeps the bound near the error.
#[test]
fn bound_of_a_string_pressed_into_a_wall_at_its_middle_is_near_the_error() {
    const NODES: usize = 401;
    const DEPTH: f64 = 1e-6;
    /// The body follows in a limited number of steps, which costs the bound a few hundredths.
    const LOOSE: f64 = 1.05;
    let middle = NODES / 2;
    let springs: Vec<_> =
        (0..NODES).map(|node| (node, node, 2.5)).chain((1..NODES).map(|j| (j, j - 1, -1.0))).collect();
    let rows: Vec<_> = (0..NODES).map(|node| (node, node, 1.0)).collect();
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(NODES, NODES, &springs).unwrap()).unwrap();
    let contact = SparseMatrix::from_triplets(NODES, NODES, &rows).unwrap();
    let at_middle = |value: f64, elsewhere: f64| -> Vec<f64> {
        (0..NODES).map(|node| if node == middle { value } else { elsewhere }).collect()
    };
    // With the ground springs, the displacement halves from node to node; so the force is 5/2 - 2/2 at the middle, and
    // zero elsewhere.
    let problem = ContactProblem::new(stiffness, at_middle(4.5, 0.0), contact, at_middle(1.0, 10.0)).unwrap();
    let pressed = |depth: f64| -> Vec<f64> {
        (0..NODES).map(|node| (1.0 + depth) * 0.5_f64.powi(node.abs_diff(middle) as i32)).collect()
    };
    let lambda = at_middle(-3.0, 0.0);
    assert!(problem.certify(&pressed(0.0), &lambda).unwrap().meets(TOLERANCE));
    // A wrong contact force is no error of the displacement: the wall carries the imbalance.
    for (depth, force) in [(DEPTH, -3.0), (-DEPTH, -3.0), (DEPTH, -3.001), (DEPTH, -2.999)] {
        let lambda = at_middle(force, 0.0);
        let bound = problem.certify(&pressed(depth), &lambda).unwrap().energy_error_bound / DEPTH;
        assert!((1.0 - 2.0 * DEPTH..LOOSE).contains(&bound), "{depth:e}, {force}: {bound}");
    }
}

#[test]
fn a_string_held_by_its_walls_alone_has_a_bound() {
    // Free at both ends: a uniform displacement has no energy.
    const NODES: usize = 400;
    let end = |node: usize| if node == 0 || node == NODES - 1 { 1.0 } else { 2.0 };
    let springs: Vec<_> =
        (0..NODES).map(|node| (node, node, end(node))).chain((1..NODES).map(|j| (j, j - 1, -1.0))).collect();
    let rows: Vec<_> = (0..NODES).map(|node| (node, node, 1.0)).collect();
    let problem = of_entries(&springs, vec![3.0; NODES], &rows, vec![1.0; NODES]);
    let certificate = problem.certify(&[1.0; NODES], &[-3.0; NODES]).unwrap();
    assert!(certificate.meets(TOLERANCE), "{certificate:?}");
}

#[test]
fn rows_of_two_nodes_that_miss_their_gaps_by_rounding_have_a_bound() {
    const NODES: usize = 400;
    const DEPTH: f64 = 1e-6;
    const GAP: f64 = 0.123;
    let springs: Vec<_> =
        (0..NODES).map(|node| (node, node, 2.0)).chain((1..NODES).map(|j| (j, j - 1, -1.0))).collect();
    let rows: Vec<_> = (0..NODES - 1).flat_map(|row| [(row, row, 0.7), (row, row + 1, 0.3)]).collect();
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(NODES, NODES, &springs).unwrap()).unwrap();
    let contact = SparseMatrix::from_triplets(NODES - 1, NODES, &rows).unwrap();
    // The load under which all rows carry a force of three at a uniform displacement.
    let forces = contact.mul_transposed(&[3.0; NODES - 1]);
    let load = stiffness.mul(&[GAP; NODES]).iter().zip(forces).map(|(elastic, force)| elastic + force).collect();
    let problem = ContactProblem::new(stiffness, load, contact, vec![GAP; NODES - 1]).unwrap();
    let bound = problem.certify(&[GAP + DEPTH; NODES], &[-3.0; NODES - 1]).unwrap().energy_error_bound;
    // All energy is in the springs at the ends, for the answer and for the error.
    assert!(bound.is_finite() && bound >= DEPTH / (GAP + DEPTH) * (1.0 - 1e-6), "{bound:e}");
}

#[test]
fn a_row_of_zeros_with_a_negative_gap_has_no_bound() {
    let problem = string(0.0, -1.0);
    let certificate = problem.certify(&[0.0; 400], &[0.0; 401]).unwrap();
    assert!(certificate.energy_error_bound.is_infinite() && !certificate.meets(TOLERANCE), "{certificate:?}");
    assert!(problem.prove(&[0.0; 400], &[0.0; 401]).unwrap().is_none());
}

#[test]
fn contact_forces_without_bound_do_not_excuse_an_open_wall() {
    // The last wall asks for u_2 <= -21.5, and the others then for u_0 >= 3e13, by forces of 1e26 that nearly cancel.
    // A fourth dof, which is a part of its own, has a load that is no excuse for the others.
    let stiffness: [&[f64]; 4] =
        [&[1.0, 0.1, 0.1, 0.0], &[0.1, 1.0, 0.99999, 0.0], &[0.1, 0.99999, 1.0, 0.0], &[0.0, 0.0, 0.0, 1.0]];
    let rows: [&[f64]; 3] = [&[0.0, -0.41, -0.52, 0.0], &[-3.7e-13, 0.0, 0.71, 0.0], &[0.0, 0.043, 0.0, 0.0]];
    let pressed = [-1e26, -0.52 / 0.71 * 1e26, -0.41 / 0.043 * 1e26];
    for apart in [0.0, 2.0_f64.powi(100)] {
        let problem = Dense::new(&stiffness, &[0.0, -8.1e11, 0.0, apart], &rows, &[0.0, 1.0, -0.93]).problem().unwrap();
        let certificate = problem.certify(&[0.0, 0.0, 0.0, apart], &pressed).unwrap();
        assert!(certificate.penetration == 1.0 && !certificate.meets(1e-2), "{certificate:?}");
    }
}

#[test]
fn an_answer_that_is_right_in_energy_closes_the_rows_that_press() {
    // Two rows move by 6.5e11 of a dof that nothing else holds: an error of 1e-14 there has no energy and opens them by
    // 0.01.
    let dense = Dense::new(
        &[&[0.1, 0.0], &[0.0, 0.5234632063150445]],
        &[0.883138868957758, -0.46733904257416725],
        &[
            &[-0.03806643933057785, 647482397034.7643],
            &[0.6917880158871412, -653640644624.8293],
            &[0.903928542509675, 0.4953599702566862],
            &[0.6005235258489847, 0.0],
        ],
        &[-4.4719095528125764e-13, -0.22527733072638512, 0.19200889579951763, 0.3770189620554447],
    );
    let problem = dense.problem().unwrap();
    for solution in [solve_qp(&problem), solve(&problem, &Settings::default())] {
        let solution = solution.unwrap();
        assert!(solution.certificate.complementarity < 1e-7, "{solution:?}");
    }
}
