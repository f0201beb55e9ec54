//! GOAL: linear complementarity problems of the literature are solved, with bounds where the theory has them.
//!
//! CONDITIONS: the families of Murty and of Fathi, on which pivoting in a fixed order takes exponentially many steps;
//! an obstacle below a membrane; a journal bearing with cavitation; a market of 50 goods; the impulses in a stack of
//! rigid blocks. REFERENCE: closed forms, and the conditions themselves in plain sums.

use signorini::lcp::{Error, Lcp, LcpSolution, solve_lcp};
use signorini::qp::Cholesky;
use signorini::{ContactSet, Settings, SparseMatrix, SymmetricMatrix};
use support::cases;
use support::draws::Draws;

type Entries = Vec<(usize, usize, f64)>;

fn solved(entries: &Entries, offset: Vec<f64>) -> (Lcp, LcpSolution) {
    let n = offset.len();
    let lcp = Lcp::nonnegative(SparseMatrix::from_triplets(n, n, entries).unwrap(), offset).unwrap();
    let solution = solve_lcp(&lcp, &Settings::default()).map_err(|error| error.to_string()).unwrap();
    let (w, terms) = (lcp.matrix().mul(&solution.z), lcp.matrix().mul_abs(&solution.z));
    for i in 0..n {
        let (z, allowed) = (solution.z[i], 1e-12 * (terms[i] + lcp.offset()[i].abs()));
        let w = w[i] + lcp.offset()[i];
        assert!(z >= 0.0 && w >= -allowed && (z == 0.0 || w <= allowed), "{i}: {z:e} and {w:e} of {allowed:e}");
    }
    (lcp, solution)
}

/// M of Murty: ones on the diagonal, twos above it. With q = -e the last unknown alone is positive.
fn murty(n: usize) -> (Entries, Vec<f64>) {
    let entry = |i: usize, j: usize| (i, j, if i == j { 1.0 } else { 2.0 });
    ((0..n).flat_map(|i| (i..n).map(move |j| entry(i, j))).collect(), vec![-1.0; n])
}

#[test]
fn the_problem_of_murty_has_its_solution() {
    let (entries, offset) = murty(100);
    let (_, solution) = solved(&entries, offset);
    let expected: Vec<f64> = (0..100).map(|i| f64::from(u8::from(i == 99))).collect();
    assert_eq!((solution.z, solution.class, solution.is_unique), (expected, "h-matrix", Some(true)));
    assert!(solution.iterations <= 200, "{} steps", solution.iterations);
}

/// # Source
/// Y. Fathi, *Computational complexity of LCPs associated with positive definite symmetric matrices*, Math. Program. 17
/// (1979) 335-344: M = L'L with L of Murty. The first unknown alone is positive.
#[test]
fn the_problem_of_fathi_has_its_solution() {
    let n = 100;
    let entry = |i: usize, j: usize| (i, j, if i == j { 1.0 + 4.0 * i as f64 } else { 2.0 + 4.0 * i.min(j) as f64 });
    let entries = (0..n).flat_map(|i| (0..n).map(move |j| entry(i, j))).collect();
    let (_, solution) = solved(&entries, vec![-1.0; n]);
    let expected: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i == 0))).collect();
    assert_eq!((&solution.z, solution.class, solution.is_unique), (&expected, "symmetric", Some(true)));
    assert!(solution.proven.iter().map(ContactSet::count).sum::<usize>() == n, "{:?}", solution.proven);
}

/// Five-point differences of `-(k u')'` on a grid with zero values around it; `k` between two points.
fn differences(columns: usize, rows: usize, k: impl Fn(f64, f64) -> f64) -> Entries {
    let mut entries = Vec::new();
    for (i, j) in (0..columns * rows).map(|point| (point % columns, point / columns)) {
        let own = j * columns + i;
        for (di, dj) in [(1_isize, 0_isize), (-1, 0), (0, 1), (0, -1)] {
            let k = k(i as f64 + 0.5 * di as f64, j as f64 + 0.5 * dj as f64);
            entries.push((own, own, k));
            let (i, j) = (i as isize + di, j as isize + dj);
            if (0..columns as isize).contains(&i) && (0..rows as isize).contains(&j) {
                entries.push((own, j as usize * columns + i as usize, -k));
            }
        }
    }
    entries
}

/// A membrane under its weight above a flat obstacle: z is its distance.
#[test]
fn a_membrane_on_an_obstacle_of_a_grid_has_a_bound_at_each_point() {
    let size = cases(30, 60);
    let h = 1.0 / (size + 1) as f64;
    let entries = differences(size, size, |_, _| 1.0);
    // The edge is 0.02 above the obstacle.
    let edges = |i: usize| [0, size - 1].into_iter().filter(|&edge| i == edge).count() as f64;
    let offset = (0..size * size).map(|p| h * h - 0.02 * (edges(p % size) + edges(p / size))).collect();
    let (_, solution) = solved(&entries, offset);
    let touching = solution.z.iter().filter(|&&z| z == 0.0).count();
    assert!(touching > size * size / 10 && touching < size * size / 2, "{touching}");
    assert_eq!((solution.class, solution.is_unique), ("symmetric", Some(true)));
    let (error, image) = (solution.error.unwrap(), solution.image_error.unwrap());
    assert!(error.iter().all(|&error| error < 1e-10) && image.iter().all(|&error| error < 1e-13));
    assert!(solution.proven.iter().map(ContactSet::count).sum::<usize>() > 9 * size * size / 10);
}

/// Reynolds' equation of a journal bearing of eccentricity 0.8, with pressures that are not negative. Its rows in other
/// units are no longer symmetric, and have the same pressure.
#[test]
fn a_journal_bearing_cavitates_also_with_rows_in_other_units() {
    let (columns, rows, eccentricity) = (40, cases(8, 20), 0.8);
    let angle = |i: f64| std::f64::consts::TAU * (i + 1.0) / (columns + 1) as f64;
    let film = |i: f64| 1.0 + eccentricity * angle(i).cos();
    let entries = differences(columns, rows, |i, _| film(i).powi(3));
    let step = |p: usize| film((p % columns) as f64 + 0.5) - film((p % columns) as f64 - 0.5);
    let offset: Vec<f64> = (0..columns * rows).map(step).collect();
    let (_, solution) = solved(&entries, offset.clone());
    // The film opens behind its narrowest place, and the pressure ends there.
    let middle = &solution.z[rows / 2 * columns..][..columns];
    let end = middle.iter().rposition(|&p| p > 0.0).unwrap();
    assert!(angle(end as f64) > std::f64::consts::PI && angle(end as f64) < 1.4 * std::f64::consts::PI, "{end}");
    assert!(middle[..=end].iter().all(|&p| p > 0.0));
    let mut draws = Draws(3);
    let unit: Vec<f64> = offset.iter().map(|_| draws.decades(1e-12, 1e12)).collect();
    let rescaled = entries.iter().map(|&(i, j, value)| (i, j, value * unit[i])).collect();
    let (_, other) = solved(&rescaled, offset.iter().zip(&unit).map(|(q, unit)| q * unit).collect());
    assert_eq!(other.is_unique, Some(true));
    let (error, of_other) = (solution.error.unwrap(), other.error.unwrap());
    for (i, (z, again)) in solution.z.iter().zip(&other.z).enumerate() {
        // Rounding of the rescaled entries counts as well: 1e-12 of the largest pressure, about 10.
        assert!((z - again).abs() <= error[i] + of_other[i] + 1e-11, "{i}: {z:e} {again:e}");
    }
}

/// A market of 50 goods and 30 activities: no activity makes a profit, no good is in excess demand, and only what is
/// exactly covered is produced or has a price.
#[test]
fn a_market_of_fifty_goods_clears() {
    let (goods, activities) = (50, 30);
    let (mut draws, mut entries) = (Draws(50), Vec::new());
    let mut offset: Vec<f64> = (0..activities).map(|_| 0.2 + draws.signed().abs()).collect();
    for activity in 0..activities {
        for _ in 0..4 {
            let (good, makes) = (activities + draws.below(goods), 1.0 + draws.signed());
            entries.extend([(activity, good, -makes), (good, activity, makes)]);
        }
    }
    for good in activities..activities + goods {
        // Demand falls with the price of the good, and moves with those of two others, not symmetrically.
        entries.push((good, good, 2.0));
        (0..2).for_each(|_| entries.push((good, activities + draws.below(goods), 0.9 * draws.signed())));
        offset.push(-1.0 - draws.signed().abs());
    }
    let (lcp, solution) = solved(&entries, offset);
    assert_eq!(solution.class, "monotone");
    assert!(solution.z[..activities].iter().any(|&x| x > 0.0) && solution.z[activities..].iter().any(|&p| p > 0.0));
    // Another price is seen by the certificate.
    let mut other = solution.z.clone();
    other[activities] *= 1.0 + 1e-6;
    assert!(lcp.certify(&other).unwrap().worst().1 > 1e-9);
}

/// Impulses in one step of a stack of rigid blocks of random masses that fall at random speeds; each block has two
/// contacts with the next, so that M = B m^-1 B' is singular. The sum of the two impulses is the weight and the
/// momentum of all that lies above, if all contacts close.
#[test]
fn the_impulses_of_a_stack_of_blocks_carry_its_momentum() {
    let blocks: usize = cases(300, 10_000);
    let mut draws = Draws(10);
    let mass: Vec<f64> = (0..blocks).map(|_| 1.0 + 0.5 * draws.signed()).collect();
    // Each block falls faster than the one below it.
    let speed: Vec<f64> = (0..blocks)
        .scan(0.0, |sum, _| {
            *sum += 1.0 + draws.signed();
            Some(-*sum)
        })
        .collect();
    let mut entries = Vec::new();
    for contact in 0..2 * blocks {
        let block: usize = contact / 2;
        for other in 2 * block.saturating_sub(1)..2 * (block + 2).min(blocks) {
            let below = if block > 0 { 1.0 / mass[block - 1] } else { 0.0 };
            entries.push((
                contact,
                other,
                match (other / 2).cmp(&block) {
                    std::cmp::Ordering::Equal => 1.0 / mass[block] + below,
                    std::cmp::Ordering::Less => -below,
                    std::cmp::Ordering::Greater => -1.0 / mass[block],
                },
            ));
        }
    }
    let closing = |contact: usize| speed[contact / 2] - if contact < 2 { 0.0 } else { speed[contact / 2 - 1] };
    let (lcp, solution) = solved(&entries, (0..2 * blocks).map(closing).collect());
    assert_eq!((solution.class, solution.is_unique), ("symmetric", Some(false)));
    // Seconds are printed, and judge nothing: one factorisation of M + 1e-6 beside the solve.
    let shifted: Entries = lcp.matrix().triplets().filter(|&(i, j, _)| i >= j).collect();
    let shifted = [shifted, (0..2 * blocks).map(|i| (i, i, 1e-6)).collect()].concat();
    let start = std::time::Instant::now();
    let lower = SparseMatrix::from_triplets(2 * blocks, 2 * blocks, &shifted).unwrap();
    Cholesky::of(&SymmetricMatrix::from_lower(lower).unwrap()).unwrap();
    let factor = start.elapsed().as_secs_f64();
    let mut momentum = 0.0;
    for block in (0..blocks).rev() {
        momentum -= mass[block] * speed[block];
        let impulse = solution.z[2 * block] + solution.z[2 * block + 1];
        assert!((impulse - momentum).abs() <= 1e-9 * momentum, "{block}: {impulse} {momentum}");
    }
    let ratio = solution.seconds / factor;
    println!("{} in {} steps, {:.4} s, {ratio:.2} factors", solution.method, solution.iterations, solution.seconds);
}

/// Problems of any matrix that have a solution: games of two players with their costs, unknowns without bounds, and
/// unknowns between two bounds.
#[test]
fn games_linear_systems_and_boxes_are_solved() {
    let mut draws = Draws(7);
    for number in 0..cases(60, 600) {
        let (half, free) = (1 + draws.below(6), f64::INFINITY);
        let n = 2 * half;
        let (kind, places) = (number % 3, (0..n * n).map(|k| (k / n, k % n)));
        let mut entry = |i: usize, j: usize| match kind {
            0 => f64::from(u8::from((i < half) != (j < half))) * (1.0 + draws.below(9) as f64),
            1 => draws.signed(),
            _ => draws.below(13) as f64 - 6.0,
        };
        let entries: Entries = places.map(|(i, j)| (i, j, entry(i, j))).collect();
        let (lower, upper) = [(0.0, free), (-free, free), (-1.0, 2.0)][kind];
        let offset = (0..n).map(|_| if kind == 0 { -1.0 } else { draws.below(9) as f64 - 4.0 }).collect();
        let matrix = SparseMatrix::from_triplets(n, n, &entries).unwrap();
        let lcp = Lcp::new(matrix, offset, vec![lower; n], vec![upper; n]).unwrap();
        let solution = solve_lcp(&lcp, &Settings::default());
        assert!(solution.is_ok_and(|solution| solution.worst().1 <= 1e-9), "{number}: {lcp:?}");
    }
}

#[test]
fn faulty_problems_are_refused_with_a_sentence() {
    let unit = |n: usize| SparseMatrix::from_triplets(n, n, &(0..n).map(|i| (i, i, 1.0)).collect::<Vec<_>>()).unwrap();
    let (inf, nan) = (f64::INFINITY, f64::NAN);
    for (matrix, offset, lower, upper, words) in [
        (unit(2), vec![0.0; 1], vec![0.0; 1], vec![1.0; 1], "matrix M of the LCP is 2 x 2, but it must be 1 x 1"),
        (unit(2), vec![0.0; 2], vec![0.0; 1], vec![1.0; 2], "lower bound has length 1, but there are 2 rows of M"),
        (unit(1), vec![nan], vec![0.0], vec![1.0], "offset q has the value NaN at 0"),
        (unit(1), vec![-inf], vec![0.0], vec![1.0], "offset q has the value -inf at 0"),
        (unit(1), vec![0.0], vec![nan], vec![1.0], "lower bound has the value NaN at 0"),
        (unit(1), vec![0.0], vec![2.0], vec![1.0], "the bounds of unknown 0 (indices from 0) are 2e0 and 1e0"),
        (unit(1), vec![0.0], vec![1e20], vec![inf], "the bounds of unknown 0 (indices from 0) are 1e20 and inf"),
        (unit(1), vec![0.0], vec![-inf], vec![-1e20], "the bounds of unknown 0"),
    ] {
        let error = Lcp::new(matrix, offset, lower, upper).unwrap_err();
        assert!(error.to_string().contains(words) && error.code() != "infeasible", "{error}");
    }
    let problem = |entries: &[(usize, usize, f64)], offset: &[f64]| {
        let n = offset.len();
        Lcp::nonnegative(SparseMatrix::from_triplets(n, n, entries).unwrap(), offset.to_vec()).unwrap()
    };
    let solve = |lcp: &Lcp| solve_lcp(lcp, &Settings::default());
    // w = -1 for every z; the ray of a symmetric M, which an energy without end would have.
    let none = solve(&problem(&[], &[-1.0])).unwrap_err();
    assert!(matches!(&none, Error::Infeasible { ray, needed } if ray == &[1.0] && *needed == 1.0), "{none}");
    let empty = solve(&problem(&[], &[])).unwrap();
    assert!(empty.z.is_empty() && problem(&[], &[]).certify(&[0.0]).is_err());
    assert_eq!(problem(&[(0, 0, 2.0)], &[-4.0]).certify(&[2.0]).unwrap().proven.map(|set| set.count()), [0, 1, 0]);
    // 30,000 unknowns without structure: two dense matrices of 7.2 GB are refused before they are made.
    let n = 30_000;
    let cycle: Vec<_> = (0..n).map(|i| (i, (i + 1) % n, 1.0)).collect();
    let lcp = problem(&cycle, &vec![-1.0; n]);
    let refused = solve_lcp(&lcp, &Settings::default().with_memory(1e9)).unwrap_err();
    assert_eq!(refused.code(), "too-large", "{refused}");
}
