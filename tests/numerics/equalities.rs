//! GOAL: equality rows are held, have multipliers of either sign, and make no answer worse.
//!
//! CONDITIONS: integers, from which the answer is built first; a stiffness of low rank, which only the rows make
//! definite; equalities that follow from others; equalities given as they are and as pairs of rows. The oracle is the
//! answer from which a problem was built.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use signorini::qp::{ContactSet, Watch};
use signorini::{
    ContactProblem, Error, Method, Prepared, Settings, SparseMatrix, SymmetricMatrix, qp, solve, solve_qp,
};
use support::draws::Draws;
use support::problems::of_entries;
use support::program::{Desk, matrix, vector};

/// Rounding of an answer of order one with at most a dozen unknowns, for the conditions of these problems.
const ROUNDING: f64 = 1e-9;

/// A dense matrix, row by row.
type Rows = Vec<Vec<f64>>;

/// A problem with its answer.
struct Built {
    stiffness: Rows,
    load: Vec<f64>,
    rows: Rows,
    gap: Vec<f64>,
    equalities: Rows,
    values: Vec<f64>,
    u: Vec<f64>,
    lambda: Vec<f64>,
    mu: Vec<f64>,
}

fn times(rows: &Rows, x: &[f64]) -> Vec<f64> {
    rows.iter().map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum()).collect()
}

fn sparse(rows: &Rows, columns: usize) -> SparseMatrix {
    let entries: Vec<(usize, usize, f64)> = (rows.iter().enumerate())
        .flat_map(|(row, of_row)| of_row.iter().enumerate().map(move |(column, &value)| (row, column, value)))
        .filter(|entry| entry.2 != 0.0)
        .collect();
    SparseMatrix::from_triplets(rows.len(), columns, &entries).unwrap()
}

/// The pivots of an elimination with the largest pivots: their number, and the least.
fn pivots(mut rows: Rows) -> (usize, f64) {
    let (mut count, mut least) = (0, f64::INFINITY);
    let columns = rows.first().map_or(0, Vec::len);
    for column in 0..columns {
        let Some(best) = (count..rows.len()).max_by(|&a, &b| rows[a][column].abs().total_cmp(&rows[b][column].abs()))
        else {
            break;
        };
        if rows[best][column].abs() < 1e-9 {
            continue;
        }
        rows.swap(count, best);
        least = least.min(rows[count][column].abs());
        let above = rows[count].clone();
        for row in rows.iter_mut().skip(count + 1) {
            let share = row[column] / above[column];
            row.iter_mut().zip(&above).for_each(|(value, above)| *value -= share * above);
        }
        count += 1;
    }
    (count, least)
}

impl Built {
    /// A problem with a singular stiffness that closed rows and equalities make definite; `None` if a draw is none.
    fn draw(draws: &mut Draws) -> Option<Self> {
        let integer = |draws: &mut Draws, most: usize| draws.below(2 * most + 1) as f64 - most as f64;
        let n = 3 + draws.below(8);
        let table = |draws: &mut Draws, count: usize| -> Rows {
            (0..count).map(|_| (0..n).map(|_| integer(draws, 2)).collect()).collect()
        };
        let (rank, p, m) = (1 + draws.below(n - 1), 1 + draws.below(n / 2), 1 + draws.below(2 * n));
        let [factor, equalities, rows] = [rank, p, m].map(|count| table(draws, count));
        let of = |i: usize, j: usize| factor.iter().map(|row| row[i] * row[j]).sum::<f64>();
        let stiffness: Rows = (0..n).map(|i| (0..n).map(|j| of(i, j)).collect()).collect();
        let closed = draws.below(m.min(n - p) + 1);
        let active: Rows = equalities.iter().chain(&rows[..closed]).cloned().collect();
        // Independent rows, and a stiffness that is definite where they leave room: together they have full rank.
        let all: Rows = active.iter().chain(&factor).cloned().collect();
        let (of_active, of_all) = (pivots(active.clone()), pivots(all));
        if of_active.0 < active.len()
            || of_all.0 < n
            || of_active.1.min(of_all.1) < 0.1
            || pivots(stiffness.clone()).0 == n
        {
            return None;
        }
        let u: Vec<f64> = (0..n).map(|_| integer(draws, 3)).collect();
        let lambda: Vec<f64> =
            (0..m).map(|row| if row < closed { -1.0 - draws.below(4) as f64 } else { 0.0 }).collect();
        let mu: Vec<f64> = (0..p).map(|_| integer(draws, 3)).collect();
        let open = |row: usize, draws: &mut Draws| if row < closed { 0.0 } else { 1.0 + draws.below(4) as f64 };
        let gap = times(&rows, &u).into_iter().enumerate().map(|(row, at)| at + open(row, draws)).collect();
        let elastic = times(&stiffness, &u);
        let pulled = |dof: usize| {
            let of =
                |rows: &Rows, forces: &[f64]| rows.iter().zip(forces).map(|(row, force)| row[dof] * force).sum::<f64>();
            of(&rows, &lambda) + of(&equalities, &mu)
        };
        let load = (0..n).map(|dof| elastic[dof] - pulled(dof)).collect();
        let values = times(&equalities, &u);
        Some(Built { stiffness, load, rows, gap, equalities, values, u, lambda, mu })
    }

    /// The first problems of a seed.
    fn several(seed: u64, count: usize) -> Vec<Self> {
        let mut draws = Draws(seed);
        std::iter::repeat_with(|| Built::draw(&mut draws)).flatten().take(count).collect()
    }

    fn without_equalities(&self) -> ContactProblem {
        let n = self.u.len();
        let stiffness = SymmetricMatrix::from_full(&sparse(&self.stiffness, n)).unwrap();
        ContactProblem::new(stiffness, self.load.clone(), sparse(&self.rows, n), self.gap.clone()).unwrap()
    }

    fn problem(&self) -> ContactProblem {
        self.without_equalities().with_equalities(&sparse(&self.equalities, self.u.len()), self.values.clone()).unwrap()
    }

    /// With two more equalities, which follow from the others.
    fn redundant(&self) -> ContactProblem {
        let sum = |columns: usize| {
            (0..columns).map(|at| self.equalities.iter().map(|row| row[at]).sum()).collect::<Vec<f64>>()
        };
        let twice: Vec<f64> = self.equalities[0].iter().map(|value| -2.0 * value).collect();
        let rows: Rows = self.equalities.iter().cloned().chain([sum(self.u.len()), twice]).collect();
        let values = times(&rows, &self.u);
        self.without_equalities().with_equalities(&sparse(&rows, self.u.len()), values).unwrap()
    }

    /// With each equality as two rows, the second three times as large.
    fn pairs(&self) -> ContactProblem {
        let scaled = |rows: &Rows, by: f64| -> Rows {
            rows.iter().map(|row| row.iter().map(|value| by * value).collect()).collect()
        };
        let rows: Rows =
            self.rows.iter().chain(&self.equalities).cloned().chain(scaled(&self.equalities, -3.0)).collect();
        let gap =
            self.gap.iter().chain(&self.values).copied().chain(self.values.iter().map(|value| -3.0 * value)).collect();
        let plain = self.without_equalities();
        ContactProblem::new(plain.stiffness().clone(), self.load.clone(), sparse(&rows, self.u.len()), gap).unwrap()
    }
}

fn is_near(found: &[f64], exact: &[f64]) -> bool {
    found.len() == exact.len() && found.iter().zip(exact).all(|(a, b)| (a - b).abs() < ROUNDING)
}

#[test]
fn equalities_are_held_whatever_holds_the_stiffness() {
    for (number, built) in Built::several(1, 100).into_iter().enumerate() {
        for method in [Method::Auto, Method::qp(), Method::ActiveSet] {
            let name = format!("{number} by {}", method.name());
            let solution = solve(&built.problem(), &Settings::with_method(method))
                .unwrap_or_else(|error| panic!("{name}: {error}"));
            // Another way would hide a fault of the elimination.
            assert!(solution.method.contains("eliminated"), "{name}: {}", solution.method);
            assert!(is_near(&solution.displacement, &built.u), "{name}: {:?}", solution.displacement);
            assert!(is_near(&solution.multiplier, &built.lambda), "{name}: {:?}", solution.multiplier);
            assert!(is_near(&solution.equality_multiplier, &built.mu), "{name}: {:?}", solution.equality_multiplier);
        }
        for problem in [built.redundant(), built.pairs()] {
            let solution = solve_qp(&problem).unwrap_or_else(|error| panic!("{number}: {error}"));
            assert!(is_near(&solution.displacement, &built.u), "{number}: {:?}", solution.displacement);
        }
    }
}

#[test]
fn an_answer_with_equalities_is_certified_and_a_changed_one_is_not() {
    for (number, built) in Built::several(2, 40).into_iter().enumerate() {
        let problem = built.problem();
        let multiplier: Vec<f64> = built.lambda.iter().chain(&built.mu).copied().collect();
        let certificate = problem.certify(&built.u, &multiplier).unwrap();
        assert!(certificate.meets(ROUNDING) && certificate.has_bound(), "{number}: {certificate:?}");
        for entry in 0..multiplier.len() {
            let mut changed = multiplier.clone();
            changed[entry] -= 1e-3;
            let is_felt = problem.certify(&built.u, &changed).unwrap();
            assert!(!is_felt.meets(1e-7), "{number}, multiplier {entry}: {is_felt:?}");
        }
        // A displacement that violates an equality by a thousandth, from either side.
        for sign in [1.0, -1.0] {
            let dof = built.equalities[0].iter().position(|&value| value != 0.0).unwrap();
            let mut moved = built.u.clone();
            moved[dof] += sign * 1e-3;
            assert!(!problem.certify(&moved, &multiplier).unwrap().meets(1e-7), "{number}");
        }
    }
}

/// GOAL: an equality over all unknowns fills no matrix.
/// CONDITIONS: a floating grid of springs, 40 x 40, with a mean value, with a moment as well, and with walls at every
/// 40th dof of which every other one is touched.
/// REFERENCE: the answer from which the loads are built.
#[test]
fn equalities_over_all_unknowns_are_held_without_filling_the_stiffness() {
    let (side, mut draws) = (40, Draws(5));
    let n = side * side;
    let springs = (0..n).flat_map(|at| {
        let right = (at % side + 1 < side).then_some((at, at + 1));
        right.into_iter().chain((at + side < n).then_some((at, at + side)))
    });
    let lower = springs.flat_map(|(a, b)| [(a, a, 1.0), (b, b, 1.0), (b, a, -1.0)]).collect::<Vec<_>>();
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(n, n, &lower).unwrap()).unwrap();
    let rows: Vec<(usize, usize, f64)> = (0..side).map(|row| (row, side * row + row, 1.0)).collect();
    let contact = SparseMatrix::from_triplets(side, n, &rows).unwrap();
    let moment = |row: usize, dof: usize| [1.0, (dof % side) as f64 - 7.3][row];
    for count in [1, 2] {
        let u: Vec<f64> = (0..n).map(|_| draws.signed()).collect();
        let lambda: Vec<f64> =
            (0..side).map(|row| if row % 2 == 0 { -0.5 - draws.signed().abs() } else { 0.0 }).collect();
        let mu: Vec<f64> = (0..count).map(|_| draws.signed()).collect();
        let moments: Vec<(usize, usize, f64)> =
            (0..count).flat_map(|row| (0..n).map(move |dof| (row, dof, moment(row, dof)))).collect();
        let equalities = SparseMatrix::from_triplets(count, n, &moments).unwrap();
        let (pressed, held) = (contact.mul_transposed(&lambda), equalities.mul_transposed(&mu));
        let load = stiffness.mul(&u).iter().zip(pressed.iter().zip(held)).map(|(k, (b, e))| k - b - e).collect();
        let gap = contact.mul(&u).iter().zip(&lambda).map(|(at, force)| at + f64::from(*force == 0.0)).collect();
        let problem = ContactProblem::new(stiffness.clone(), load, contact.clone(), gap).unwrap();
        let solution = solve_qp(&problem.with_equalities(&equalities, equalities.mul(&u)).unwrap()).unwrap();
        assert!(solution.method.ends_with("-eliminated"), "{}", solution.method);
        // The bound is relative to the energy of a displacement of the order of one at each of n dofs.
        let farthest =
            solution.displacement.iter().zip(&u).map(|(ours, exact)| (ours - exact).abs()).fold(0.0, f64::max);
        assert!(farthest < n as f64 * ROUNDING && solution.certificate.has_bound(), "{farthest}");
        let off = |ours: &[f64], exact: &[f64]| ours.iter().zip(exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off(&solution.multiplier, &lambda) < n as f64 * ROUNDING, "{:?}", solution.multiplier);
        assert!(off(&solution.equality_multiplier, &mu) < n as f64 * ROUNDING, "{:?}", solution.equality_multiplier);
    }
}

/// `u_0 = 1/4`, `u_1 = 1/2` and `u_0 + u_1 = 1`; then the row `u_0 <= 1/2` before `u_0 + u_2 = 2` and `u_2 = 1/2`.
#[test]
fn equalities_that_contradict_each_other_or_a_row_are_refused_with_their_weights() {
    let unit =
        SymmetricMatrix::from_lower(sparse(&vec![vec![1.0, 0.0, 0.0], vec![0.0, 1.0, 0.0], vec![0.0, 0.0, 1.0]], 3))
            .unwrap();
    let row = sparse(&vec![vec![1.0, 0.0, 0.0]], 3);
    let plain = ContactProblem::new(unit, vec![0.0; 3], row, vec![0.5]).unwrap();
    let cases: [(Rows, Vec<f64>, &[f64; 4], f64); 2] = [
        (
            vec![vec![1.0, 0.0, 0.0], vec![0.0, 1.0, 0.0], vec![1.0, 1.0, 0.0]],
            vec![0.25, 0.5, 1.0],
            &[0.0, 1.0, 1.0, -1.0],
            0.25,
        ),
        (vec![vec![1.0, 0.0, 1.0], vec![0.0, 0.0, 1.0]], vec![2.0, 0.5], &[1.0, -1.0, 1.0, 0.0], 1.0),
    ];
    for (equalities, values, exact, distance) in cases {
        let problem = plain.with_equalities(&sparse(&equalities, 3), values).unwrap();
        let Err(qp::Error::Infeasible { rows, weights, overlap, reason }) = solve(&problem, &Settings::default())
        else {
            panic!("it is solved")
        };
        let mut all = [0.0; 4];
        rows.iter().zip(&weights).for_each(|(&row, weight)| all[row] += weight);
        assert!(is_near(&all, exact) && (overlap - distance).abs() < ROUNDING, "{all:?} {overlap}");
        assert!(reason.contains("equality rows"), "{reason}");
    }
    let none = plain.with_equalities(&sparse(&vec![vec![0.0; 3]], 3), vec![2.0]).unwrap();
    assert!(matches!(solve(&none, &Settings::default()), Err(qp::Error::Infeasible { .. })));
}

/// A chain of springs whose tenth and fortieth nodes stay half a length apart, before three walls that move.
#[test]
fn a_path_has_the_answers_of_each_gap_with_equalities_too() {
    let n = 60;
    let entries: Vec<(usize, usize, f64)> =
        (0..n).map(|dof| (dof, dof, 2.0)).chain((1..n).map(|dof| (dof, dof - 1, -1.0))).collect();
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(n, n, &entries).unwrap()).unwrap();
    let walls = SparseMatrix::from_triplets(3, n, &[(0, 20, 1.0), (1, 30, 1.0), (2, 50, 1.0)]).unwrap();
    let tie = SparseMatrix::from_triplets(1, n, &[(0, 10, 1.0), (0, 40, -1.0)]).unwrap();
    let plain = ContactProblem::new(stiffness, vec![0.1; n], walls, vec![50.0; 3]).unwrap();
    let problem = plain.with_equalities(&tie, vec![0.5]).unwrap();
    let mut settings = Settings::default();
    settings.prove = true;
    let prepared = Prepared::new(&problem, &settings).unwrap();
    let path = prepared.path(&[50.0; 3], &[1.0, 2.0, 3.0]).unwrap();
    assert_eq!(path.events().iter().map(|event| event.row).collect::<Vec<_>>(), [0, 1, 2]);
    for t in [0.0, 0.17, 0.5, 0.9, 1.0] {
        let answer = prepared.solve(&path.gap(t)).unwrap();
        assert!(is_near(&path.multiplier(t), &answer.multiplier), "{t}");
        assert!(is_near(&path.equality_multiplier(t), &answer.equality_multiplier), "{t}");
        assert_eq!(path.gap(t).len(), 3);
        assert!(answer.equality_multiplier[0].abs() > 1e-3 && path.contact_set(t) == answer.contact_set, "{t}");
        // Every row is proven, and the tie takes no part in the count.
        let proven = answer.proven.unwrap();
        assert_eq!((proven.open.count() + proven.closed.count(), proven.open.rows()), (3, 3), "{t}");
    }
    let start = ContactSet::closed(3);
    assert!(is_near(&problem.solve_from(&start.into(), &Settings::default()).unwrap().multiplier, &[0.0; 3]));
}

/// An empty row beside gaps of order one: -7e-18 is rounding, -7e-3 is not.
/// A chain of `count` dofs and springs of stiffness one, the first to the ground; that in the middle is replaced by an
/// equality of both ends. The last dof is pushed with 1 towards a wall.
fn tied_chain(count: usize) -> ContactProblem {
    let springs = (1..count).filter(|&dof| dof != count / 2);
    let spring = |dof: usize| [(dof, dof, 1.0), (dof - 1, dof - 1, 1.0), (dof, dof - 1, -1.0)];
    let entries: Vec<_> = std::iter::once((0, 0, 1.0)).chain(springs.flat_map(spring)).collect();
    let load = (0..count).map(|dof| if dof + 1 == count { 1.0 } else { 0.0 }).collect();
    let tie = SparseMatrix::from_triplets(1, count, &[(0, count / 2, 1.0), (0, count / 2 - 1, -1.0)]).unwrap();
    of_entries(&entries, load, &[(0, count - 1, 1.0)], vec![1.0]).with_equalities(&tie, vec![0.0]).unwrap()
}

#[test]
fn many_gaps_of_a_problem_with_equalities_share_a_factor() {
    let factors = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&factors);
    let watch = Watch::observed(move |watch| {
        counted.fetch_add(usize::from(watch.activity().step == "factorisation"), Ordering::SeqCst);
    });
    let mut settings = Settings::default();
    settings.watch = watch;
    let prepared = Prepared::new(&tied_chain(40), &settings).unwrap();
    let twice = prepared.with_load(tied_chain(40).load().iter().map(|f| 2.0 * f).collect()).unwrap();
    for gap in (1..=20).map(|step| 2.0 * f64::from(step)) {
        for (prepared, load) in [(&prepared, 1.0), (&twice, 2.0)] {
            // 39 springs carry the end to 39 times the load; the wall takes what they do not.
            let (solution, force) = (prepared.solve(&[gap]).unwrap(), (load - gap / 39.0_f64).max(0.0));
            assert!(is_near(&solution.multiplier, &[-force]), "{gap}: {:?}", solution.multiplier);
            assert!(is_near(&solution.equality_multiplier, &[force - load]), "{gap}");
            assert!(solution.certificate.meets(ROUNDING), "{gap}: {:?}", solution.certificate);
        }
    }
    // That of the whole, and that of the rest.
    assert!(factors.load(Ordering::SeqCst) <= 2, "{factors:?}");
}

#[test]
fn the_gap_of_an_empty_row_counts_as_zero_if_it_is_rounding() {
    let problem = |gap: f64| {
        let unit = SymmetricMatrix::from_lower(sparse(&vec![vec![1.0, 0.0], vec![0.0, 1.0]], 2)).unwrap();
        let rows = sparse(&vec![vec![0.0, 0.0], vec![1.0, 1.0]], 2);
        ContactProblem::new(unit, vec![3.0, 3.0], rows, vec![gap, 1.0]).unwrap()
    };
    let settled = problem(-7e-18);
    assert!(
        settled.warnings()[0].1.contains("contact row 0") && settled.warnings()[0].1.contains("-7e-18"),
        "{:?}",
        settled.warnings()
    );
    assert!(is_near(&solve_qp(&settled).unwrap().displacement, &[0.5, 0.5]));
    let empty = problem(-7e-3);
    assert!(empty.warnings().is_empty() && matches!(solve_qp(&empty), Err(qp::Error::Infeasible { .. })));
    assert!(matches!(solve_qp(&settled.with_gap(vec![-7e-3, 1.0]).unwrap()), Err(qp::Error::Infeasible { .. })));
}

/// K = I, and a second equality that is a tenth of the first; then sums of equalities with weights that are no binary
/// fractions.
#[test]
fn rows_that_follow_except_for_rounding_are_left_out_with_a_warning() {
    let unit = SymmetricMatrix::from_lower(sparse(&vec![vec![1.0, 0.0], vec![0.0, 1.0]], 2)).unwrap();
    let plain = ContactProblem::new(unit, vec![0.0; 2], sparse(&vec![vec![0.0, 1.0]], 2), vec![5.0]).unwrap();
    let rows = sparse(&vec![vec![1.0, 2.0], vec![0.1, 0.2]], 2);
    let problem = plain.with_equalities(&rows, vec![7.0, 0.7]).unwrap();
    let (code, sentence) = problem.warnings().remove(0);
    assert!(code == "redundant-row" && sentence.contains("equality row 1 (from 0) is left out"), "{code}: {sentence}");
    let solution = solve_qp(&problem).unwrap();
    assert!(is_near(&solution.displacement, &[1.4, 2.8]) && is_near(&solution.equality_multiplier, &[1.4, 0.0]));
    // The same force on the row that is left out, and what was given comes back.
    assert!(problem.certify(&[1.4, 2.8], &[0.0, 0.0, 14.0]).unwrap().meets(1e-9));
    assert_eq!(problem.equalities_given(), (rows.clone(), vec![7.0, 0.7]));
    // Beyond rounding there is no answer.
    let contradicts = plain.with_equalities(&rows, vec![7.0, 0.7 + 1e-12]).unwrap();
    assert!(contradicts.warnings().is_empty() && solve_qp(&contradicts).is_err());
    for (number, built) in Built::several(7, 60).into_iter().enumerate() {
        let weights = |row: usize| move |of: usize| 0.1 + 0.7 * of as f64 - 0.3 * row as f64;
        let sum = |weight: &dyn Fn(usize) -> f64, of: &dyn Fn(usize) -> f64| {
            (0..built.equalities.len()).map(|row| weight(row) * of(row)).sum::<f64>()
        };
        let (mut rows, mut values) = (built.equalities.clone(), built.values.clone());
        for row in 0..3 {
            let weight = weights(row);
            rows.push((0..built.u.len()).map(|dof| sum(&weight, &|of| built.equalities[of][dof])).collect());
            values.push(sum(&weight, &|of| built.values[of]));
        }
        let problem = built.without_equalities().with_equalities(&sparse(&rows, built.u.len()), values).unwrap();
        let solution = solve_qp(&problem).unwrap_or_else(|error| panic!("{number}: {error}"));
        assert!(is_near(&solution.displacement, &built.u), "{number}: {:?}", solution.displacement);
        assert!(is_near(&solution.multiplier, &built.lambda), "{number}: {:?}", solution.multiplier);
    }
}

#[test]
fn a_directory_with_equality_rows_is_solved_and_verified_and_half_of_one_is_refused() {
    let desk = Desk::new();
    std::fs::create_dir(desk.path("p")).unwrap();
    desk.write("p/K.mtx", matrix("symmetric", "2 2", &["1 1 1", "2 2 1"]));
    desk.write("p/f.mtx", vector(&["3", "1"]));
    desk.write("p/B.mtx", matrix("general", "1 2", &["1 1 1"]));
    desk.write("p/g.mtx", vector(&["1.5"]));
    desk.write("p/E.mtx", matrix("general", "1 2", &["1 1 1", "1 2 -1"]));
    desk.run(&["solve", "p"]).fails_with(1, &["e.mtx", "it is missing, but there is E.mtx"]);
    desk.write("p/e.mtx", vector(&["0"]));
    let run = desk.run(&["solve", "p", "--out", "o", "--format", "json"]).ends_with(0);
    assert_eq!((&run.json()["model"]["contact_rows"], &run.json()["model"]["equality_rows"]), (&1.into(), &1.into()));
    // Both at 3/2: the wall takes 1 and the tie -1/2 in its own direction.
    let read = |name: &str| qp::read_vector(&desk.path(name)).unwrap();
    assert!(is_near(&read("o/u.mtx"), &[1.5, 1.5]) && is_near(&read("o/lambda.mtx"), &[-1.0]));
    assert!(is_near(&read("o/mu.mtx"), &[-0.5]));
    let answer = ["verify", "p", "--displacement", "o/u.mtx", "--multiplier", "o/lambda.mtx"];
    desk.run(&answer).fails_with(1, &["--equality-multiplier"]);
    let with_mu = [&answer[..], &["--equality-multiplier", "o/mu.mtx"]].concat();
    assert!(desk.run(&with_mu).ends_with(0).stdout.contains("1 equality row"));
    desk.write("o/mu.mtx", vector(&["0.5"]));
    desk.run(&with_mu).ends_with(4);
    // What the library writes is what it reads.
    let problem = qp::read_problem(&desk.path("p")).unwrap();
    std::fs::create_dir(desk.path("q")).unwrap();
    problem.files().iter().for_each(|file| desk.write(&format!("q/{}", file.name), file.text()));
    assert_eq!(qp::read_problem(&desk.path("q")).unwrap(), problem);
}

#[test]
fn equality_rows_that_do_not_fit_are_refused_in_one_sentence() {
    let plain = Built::several(3, 1).remove(0).without_equalities();
    let n = plain.dofs();
    let refusals = [
        plain.with_equalities(&sparse(&vec![vec![1.0; n + 1]], n + 1), vec![0.0]),
        plain.with_equalities(&sparse(&vec![vec![1.0; n]], n), vec![0.0, 1.0]),
        plain.with_equalities(&sparse(&vec![vec![1.0; n]], n), vec![f64::NAN]),
    ];
    let names = ["equality matrix", "equality vector", "equality vector"];
    for (refusal, name) in refusals.into_iter().zip(names) {
        let sentence = Error::from(refusal.unwrap_err()).to_string();
        assert!(sentence.contains(name) && sentence.lines().count() == 1, "{sentence}");
    }
}

/// Two opposed rows give the first dof from the second, which moves so far that its rounding decides the force on the
/// first.
#[test]
fn a_dof_that_an_elimination_leaves_out_of_balance_is_balanced_on_all_dofs() {
    let springs = [(0, 0, 0.1), (1, 1, 0.34135404109002565), (2, 1, -0.39365787731135926), (3, 1, 0.3786695077194752)];
    let others = [(2, 2, 0.5446726798475009), (3, 2, -0.3994573562711211), (3, 3, 0.43534963831812534)];
    let (a, b, gap) = (0.7493838835507631, 0.9585916716605425, 973515309393.4059);
    let load = vec![0.9811543170362711, 0.953706294298172, -0.957955826073885, -0.6146638002246618];
    let rows = [(0, 0, -a), (0, 1, -b), (1, 0, a), (1, 1, b)];
    let solution = solve_qp(&of_entries(&[&springs[..], &others].concat(), load, &rows, vec![gap, -gap])).unwrap();
    assert!(solution.certificate.stationarity < ROUNDING, "{:?}", solution.certificate);
}
