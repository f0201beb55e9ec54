//! Random problems of springs and dense matrices. K is definite and u = 0 meets every row, so that each has one answer.

use signorini::qp::Error;
use signorini::{ContactProblem, SparseMatrix, SymmetricMatrix};

use super::exact::case::Case;
use crate::draws::Draws;

/// Units of stiffness, in powers of ten.
const STIFFNESS: [i32; 6] = [0, 3, 3, 5, 9, 11];

/// Units of gaps, in powers of ten.
const LENGTHS: [i32; 6] = [-6, -6, -3, 0, -9, -12];

/// Decades between the weakest and the strongest spring.
const CONTRASTS: [f64; 5] = [0.0, 0.0, 1.0, 3.0, 6.0];

/// Loads on contact rows, in units of stiffness times length.
const PRESSED: [f64; 7] = [1.0, 1.0, 1e3, 1e4, 1e7, 1e9, 1e12];

/// Loads on the dofs of a chain, and decades between its weakest and its strongest spring; springs are of order one.
const DRIVEN: [f64; 4] = [1.0, 1.0, 10.0, 1e3];
const UNEVEN: [f64; 3] = [1.0, 2.0, 4.0];

/// Springs to the ground and gaps of a chain.
const HELD: [f64; 3] = [1.0, 1e-3, 1e-6];
const APART: [f64; 3] = [0.1, 1e-3, 1e-6];

/// A number with as many digits as people write, or with all.
fn decimal(draws: &mut Draws, value: f64) -> f64 {
    let digits = draws.pick(&[1, 3, 6, 16]);
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

/// A number in [low, high).
fn within(draws: &mut Draws, low: f64, high: f64) -> f64 {
    low + (high - low) * (0.5 + 0.5 * draws.signed())
}

/// Problem `number` of a seed: 1 to 8 dofs, 1 to 6 rows.
pub fn problem(seed: u64, number: u64) -> Case {
    let mut draws = Draws::of(seed, number);
    let n = 1 + draws.below(8);
    let stiff = 10.0_f64.powi(draws.pick(&STIFFNESS));
    let long = 10.0_f64.powi(draws.pick(&LENGTHS));
    let parts = parts(&mut draws, n);
    let all_rest = draws.one_in(8);
    let of_part: Vec<bool> = (0..n).map(|_| all_rest || draws.one_in(3)).collect();
    let rests: Vec<bool> = parts.iter().map(|&part| if parts[n - 1] > 0 { of_part[part] } else { all_rest }).collect();
    let stiffness = stiffness(&mut draws, &parts, stiff);
    let (contact, gap) = rows(&mut draws, &rests, long);
    let load = load(&mut draws, &rests, &contact, stiff * long);
    Case { stiffness, load, contact, gap }
}

/// The part of each dof: one for all, or several with a few neighbours each.
fn parts(draws: &mut Draws, n: usize) -> Vec<usize> {
    let several = draws.one_in(4);
    let mut part = 0;
    let mut next = |dof: usize| {
        part += usize::from(dof > 0 && several && draws.one_in(3));
        part
    };
    (0..n).map(&mut next).collect()
}

/// Springs between neighbours in a part, or between any two dofs, or a dense matrix for each part.
fn stiffness(draws: &mut Draws, parts: &[usize], unit: f64) -> Vec<Vec<f64>> {
    let (n, contrast, family) = (parts.len(), draws.pick(&CONTRASTS), draws.below(5));
    let mut matrix = vec![vec![0.0; n]; n];
    if family == 0 {
        let factor: Vec<f64> = (0..n * n).map(|_| draws.signed()).collect();
        for i in 0..n {
            for j in (0..=i).filter(|&j| parts[i] == parts[j]) {
                let product: f64 = (0..n).map(|k| factor[i * n + k] * factor[j * n + k]).sum();
                matrix[i][j] = unit * product;
                matrix[j][i] = matrix[i][j];
            }
            matrix[i][i] += 0.1 * unit;
        }
        return matrix;
    }
    let mut spring = |draws: &mut Draws, i: usize, other: Option<usize>| {
        let decades = within(draws, 0.0, contrast);
        let strength = decimal(draws, unit * 10.0_f64.powf(decades));
        matrix[i][i] += strength;
        if let Some(j) = other {
            matrix[j][j] += strength;
            matrix[i][j] -= strength;
            matrix[j][i] -= strength;
        }
    };
    for dof in 0..n {
        if dof > 0 && parts[dof] == parts[dof - 1] {
            spring(draws, dof, Some(dof - 1));
        } else {
            spring(draws, dof, None);
        }
    }
    if draws.one_in(2) {
        spring(draws, n - 1, None);
    }
    if family > 1 {
        for dof in 0..n {
            if draws.one_in(2) {
                spring(draws, dof, None);
            }
        }
        for _ in 0..n / 2 {
            let (i, j) = (draws.below(n), draws.below(n));
            if i != j && parts[i] == parts[j] {
                spring(draws, i, Some(j));
            }
        }
    }
    matrix
}

/// Rows on one dof, on the difference of two, on two with decimal entries, and scaled copies of other rows.
fn rows(draws: &mut Draws, rests: &[bool], unit: f64) -> (Vec<Vec<f64>>, Vec<f64>) {
    let n = rests.len();
    let (mut contact, mut gap): (Vec<Vec<f64>>, Vec<f64>) = (Vec::new(), Vec::new());
    for count in 0..1 + draws.below(6) {
        let (i, j, mut row) = (draws.below(n), draws.below(n), vec![0.0; n]);
        let mut copied = None;
        match draws.below(10) {
            0..=4 => row[i] = draws.pick(&[1.0, -1.0, 1.0]),
            5..=7 => {
                row[j] = -1.0;
                row[i] = 1.0;
            }
            8 if count > 0 => {
                let (of, factor) = (draws.below(count), draws.pick(&[1.0, 2.0, 3.0, 1e-3, 1e-8]));
                row = contact[of].iter().map(|b| b * factor).collect();
                copied = draws.one_in(2).then_some(gap[of] * factor);
            }
            _ => {
                let (size, other) = (within(draws, 0.1, 1.0), draws.signed());
                row[i] = decimal(draws, size);
                row[j] += decimal(draws, other);
            }
        }
        if row.iter().all(|&b| b == 0.0) {
            row[i] = 1.0;
        }
        let is_closed = draws.below(20) < 3 || row.iter().zip(rests).any(|(&b, &rests)| b != 0.0 && rests);
        let distance = unit * within(draws, 0.0, 1.0);
        let distance = decimal(draws, distance);
        gap.push(if is_closed { 0.0 } else { copied.unwrap_or(distance) });
        contact.push(row);
    }
    (contact, gap)
}

/// Forces on dofs that move, and forces against rows, which contact takes over.
fn load(draws: &mut Draws, rests: &[bool], contact: &[Vec<f64>], unit: f64) -> Vec<f64> {
    let mut load = vec![0.0; rests.len()];
    let (pressed, presses) = (unit * draws.pick(&PRESSED), draws.one_in(2));
    for row in contact {
        let is_at_rest = row.iter().zip(rests).any(|(&b, &rests)| b != 0.0 && rests);
        if !(presses || is_at_rest) || draws.below(10) < 3 {
            continue;
        }
        let force = pressed * within(draws, 0.1, 1.0);
        let force = if draws.one_in(2) { decimal(draws, force) } else { force };
        load.iter_mut().zip(row).for_each(|(f, b)| *f += force * b);
    }
    for (dof, f) in load.iter_mut().enumerate() {
        if !rests[dof] && draws.below(5) < 2 {
            let force = unit * draws.signed();
            *f += decimal(draws, force);
        }
    }
    load
}

/// Chain `number` of a seed: 30 to 250 springs with springs to the ground, and rows that keep dofs apart, most of them
/// neighbours. With soft ground or small gaps, most of
/// them press.
pub fn chain(seed: u64, number: u64) -> Result<ContactProblem, Error> {
    let mut draws = Draws::of(seed, number);
    let n = 30 + draws.below(221);
    let (contrast, driven) = (draws.pick(&UNEVEN), draws.pick(&DRIVEN));
    let (held, apart) = (draws.pick(&HELD), draws.pick(&APART));
    // Tenths of the rows that keep a dof apart from any other before it.
    let far = draws.below(3);
    let (mut entries, mut contact, mut gap, mut load) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for dof in 0..n {
        let ground = held * within(&mut draws, 1e-3, 1.0);
        entries.push((dof, dof, decimal(&mut draws, ground)));
        let force = within(&mut draws, 0.0, if 2 * dof < n { driven } else { -driven });
        load.push(decimal(&mut draws, force));
        if dof == 0 {
            continue;
        }
        let decades = contrast * (0.5 * draws.signed());
        let spring = decimal(&mut draws, 10.0_f64.powf(decades));
        entries.extend([(dof, dof, spring), (dof - 1, dof - 1, spring), (dof, dof - 1, -spring)]);
        let other = if draws.below(10) < far { draws.below(dof) } else { dof - 1 };
        contact.extend([(dof - 1, other, 1.0), (dof - 1, dof, -1.0)]);
        let distance = within(&mut draws, 0.0, apart);
        gap.push(if draws.below(10) < 3 { 0.0 } else { decimal(&mut draws, distance) });
    }
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(n, n, &entries)?)?;
    ContactProblem::new(stiffness, load, SparseMatrix::from_triplets(n - 1, n, &contact)?, gap)
}
