//! GOAL: QPs without a mesh, in which the contact rows are a large share of the unknowns.
//!
//! CONDITIONS: a string and a membrane pushed onto a flat obstacle; box-constrained random problems.
//! REFERENCE: closed forms of the free boundary and of the force on the obstacle.

use std::f64::consts::PI;
use support::problems::of_entries;

use signorini::{ContactProblem, Method, Prepared, Settings, solve};
use support::closed_forms::{DiscMembrane, ObstacleString};
use support::oracles::Draws;

const METHODS: [Method; 2] = [Method::qp(), Method::ActiveSet];

/// -u'' = -q on (0, 1), u(0) = u(1) = 0, u >= -g, with `cells` linear elements: rows -u <= g.
fn string(cells: usize, q: f64, g: f64) -> ContactProblem {
    let (n, h) = (cells - 1, 1.0 / cells as f64);
    let mut stiffness = Vec::new();
    for i in 0..n {
        stiffness.push((i, i, 2.0 / h));
        if i + 1 < n {
            stiffness.push((i + 1, i, -1.0 / h));
        }
    }
    let contact: Vec<_> = (0..n).map(|i| (i, i, -1.0)).collect();
    of_entries(&stiffness, vec![-q * h; n], &contact, vec![g; n])
}

/// With linear elements the string is exact at the nodes if the edge of the contact, b = sqrt(2 g / q), is a node.
#[test]
fn string_on_an_obstacle_is_exact_at_the_nodes() {
    let (q, g, cells) = (1.0, 0.08, 200);
    let closed = ObstacleString { load: q, gap: g };
    let string = string(cells, q, g);
    for method in METHODS {
        let solution = solve(&string, &Settings::with_method(method)).unwrap();
        for (i, u) in solution.displacement.iter().enumerate() {
            let x = (i + 1) as f64 / cells as f64;
            let exact = closed.displacement(x);
            // 1e-12: the condition number of the string, 4e4, times rounding.
            assert!((u - exact).abs() < 1e-12 * g, "{method:?}: u({x}) = {u}, exact {exact}");
        }
        let force = solution.contact_force();
        assert!((force - closed.force()).abs() < 1e-11, "{method:?}: force {force}");
        assert_eq!(solution.contact_set.count(), 41, "{method:?}");
    }
}

/// 2000 cells: starting from C = 0 the active-set loop would take 400 iterations, and the interior point alone finds a
/// poor set.
#[test]
fn fine_string_needs_few_iterations_on_every_mesh() {
    let string = string(2000, 1.0, 0.08);
    for method in METHODS {
        let solution = solve(&string, &Settings::with_method(method)).unwrap();
        assert!((solution.contact_force() - 0.2).abs() < 1e-9, "{method:?}: {}", solution.contact_force());
        assert!(solution.history.len() < 250, "{method:?}: {} iterations", solution.history.len());
    }
}

/// -Laplace u = -q on the unit disc, u >= -g, with radial linear elements. The contact is the disc r <= b with
/// q (1 - b^2) / 4 + (q b^2 / 2) ln b = g; its force is q pi b^2.
#[test]
fn membrane_over_a_disc_has_the_force_of_the_closed_form() {
    let (q, g) = (8.0_f64, 0.25);
    let force = DiscMembrane { load: q, gap: g }.force();
    let mut errors = Vec::new();
    for cells in [100, 200, 400, 800] {
        let h = 1.0 / cells as f64;
        let (mut stiffness, mut load) = (Vec::new(), vec![0.0; cells]);
        for cell in 0..cells {
            let (left, right) = (cell as f64 * h, (cell + 1) as f64 * h);
            let k = 2.0 * PI * (left + right) / 2.0 / h;
            // Integrals of 2 pi q r times the two hat functions of a cell.
            let (to_left, to_right) = (2.0 * left + right, left + 2.0 * right);
            stiffness.push((cell, cell, k));
            load[cell] -= 2.0 * PI * q * h * to_left / 6.0;
            if cell + 1 < cells {
                stiffness.extend([(cell + 1, cell, -k), (cell + 1, cell + 1, k)]);
                load[cell + 1] -= 2.0 * PI * q * h * to_right / 6.0;
            }
        }
        let contact: Vec<_> = (0..cells).map(|i| (i, i, -1.0)).collect();
        let membrane = of_entries(&stiffness, load, &contact, vec![g; cells]);
        let found = solve(&membrane, &Settings::default()).unwrap();
        let other = solve(&membrane, &Settings::with_method(Method::ActiveSet)).unwrap();
        assert!((found.contact_force() / other.contact_force() - 1.0).abs() < 1e-11);
        errors.push((found.contact_force() / force - 1.0).abs());
    }
    // The position of the free boundary between two nodes changes with the mesh; on average the error falls with h^2.
    let rate = (errors[0] / errors[3]).log2() / 3.0;
    assert!(errors[3] < 1e-5 && rate > 1.5, "errors {errors:?}, rate {rate}");
}

/// The lower triangle of the 5-point Laplacian on a square.
fn five_points(side: usize) -> Vec<(usize, usize, f64)> {
    let mut entries = Vec::new();
    for dof in 0..side * side {
        entries.push((dof, dof, 4.0));
        if dof % side + 1 < side {
            entries.push((dof + 1, dof, -1.0));
        }
        if dof + side < side * side {
            entries.push((dof + side, dof, -1.0));
        }
    }
    entries
}

/// 5-point Laplacian on a square between two flat obstacles: 2 rows for each of 2500 unknowns.
#[test]
fn membrane_between_two_obstacles_is_certified() {
    let side = 50;
    let n = side * side;
    let (stiffness, mut load) = (five_points(side), vec![0.0; n]);
    for i in 0..side {
        for j in 0..side {
            let dof = i * side + j;
            load[dof] = 0.02 * (6.0 * i as f64 / side as f64).sin() * (5.0 * j as f64 / side as f64).cos();
        }
    }
    let contact: Vec<_> = (0..n).flat_map(|i| [(i, i, 1.0), (n + i, i, -1.0)]).collect();
    let membrane = of_entries(&stiffness, load, &contact, [vec![0.3; n], vec![0.2; n]].concat());
    let answers = METHODS.map(|method| solve(&membrane, &Settings::with_method(method)).unwrap());
    let count = |low, high| answers[0].contact_set.iter().filter(|row| (low..high).contains(row)).count();
    assert!(count(0, n) > 20 && count(n, 2 * n) > 20, "both obstacles are touched");
    for (a, b) in answers[0].displacement.iter().zip(&answers[1].displacement) {
        assert!((a - b).abs() < 1e-11, "{a} {b}");
    }
}

/// A membrane over one obstacle on a finer square: a few cycles of multigrid give the first set; one or two
/// more sets follow, which reuse its factor.
#[test]
fn the_direct_path_takes_few_sets_if_every_dof_is_a_candidate() {
    let side = 90;
    let n = side * side;
    let (stiffness, mut gap) = (five_points(side), Vec::new());
    for i in 0..side {
        for j in 0..side {
            let (x, y) = (i as f64 / side as f64, j as f64 / side as f64);
            gap.push(0.04 + 0.02 * (9.0 * x).sin() * (7.0 * y).cos());
        }
    }
    let contact: Vec<_> = (0..n).map(|i| (i, i, -1.0)).collect();
    let membrane = of_entries(&stiffness, vec![-2e-4; n], &contact, gap);
    let exact = solve(&membrane, &Settings::with_method(Method::ActiveSet)).unwrap();
    assert!(exact.contact_set.count() > n / 20 && exact.iterations <= 4, "{} sets", exact.iterations);
    // Starting from the empty set, each set moves the front by one row of nodes.
    let prepared = Prepared::new(&membrane, &Settings::with_method(Method::ActiveSet)).unwrap();
    let cold = prepared.solve(membrane.gap()).unwrap();
    assert_eq!(cold.contact_set, exact.contact_set);
    assert!(cold.iterations > 2 * exact.iterations, "{} and {} sets", cold.iterations, exact.iterations);
    for (a, b) in cold.displacement.iter().zip(&exact.displacement) {
        assert!((a - b).abs() < 1e-11, "{a} {b}");
    }
}

#[test]
fn random_box_constrained_problems_are_certified_by_every_exact_method() {
    let mut draws = Draws::new(5);
    for case in 0..20 {
        let n = 100 + draws.below(200);
        // A sum of squares of random pairs and a small diagonal: sparse, positive definite, without structure.
        let mut stiffness: Vec<_> = (0..n).map(|i| (i, i, 1e-2)).collect();
        for _ in 0..3 * n {
            let (i, j, a, b) = (draws.below(n), draws.below(n), draws.signed(), draws.signed());
            if i != j {
                stiffness.extend([(i, i, a * a), (j, j, b * b), (i.max(j), i.min(j), a * b)]);
            }
        }
        let load = (0..n).map(|_| draws.signed()).collect();
        let contact: Vec<_> = (0..n).flat_map(|i| [(i, i, 1.0), (n + i, i, -1.0)]).collect();
        let gap = (0..2 * n).map(|_| draws.uniform()).collect();
        let boxed = of_entries(&stiffness, load, &contact, gap);
        let answers = METHODS.map(|method| {
            solve(&boxed, &Settings::with_method(method)).unwrap_or_else(|error| panic!("case {case}: {error}"))
        });
        for (a, b) in answers[0].displacement.iter().zip(&answers[1].displacement) {
            assert!((a - b).abs() < 1e-10, "case {case}: {a} {b}");
        }
    }
}
