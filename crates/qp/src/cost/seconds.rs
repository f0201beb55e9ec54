//! Seconds of a step of a solve, by counts and the rates of one machine; [`Watch::timed`] measures the ratio of this
//! machine to it.

use std::hint::black_box;

use crate::linear::selected_inverse::FACTORISATIONS;
use crate::linear::watch::Watch;
use crate::linear::{Analysis, SparseMatrix, SymmetricMatrix};
use crate::problem::ContactProblem;

/// Seconds of a factorisation for a multiplication, and for a value of the factor. A multiplication takes what the
/// products of large matrices take on one processor; the rest of a measured time is that of the values.
const MULTIPLICATION: f64 = 3.4e-11;
const VALUE: f64 = 1.46e-8;

/// About as many values stay in the cache of a processor, and take little.
const IN_CACHE: f64 = 5e5;

/// Cells along a side of the lattice; its matrix is factorised to measure the pace.
const LATTICE: usize = 64;

pub fn factor_seconds(multiplications: f64, values: f64) -> f64 {
    MULTIPLICATION * multiplications + VALUE * values * (values / (values + IN_CACHE))
}

/// Seconds of ordering and analysing the stiffness of `problem`, nested dissection included.
pub fn ordering(problem: &ContactProblem) -> f64 {
    1.3e-7 * problem.stiffness().lower().entries() as f64
}

/// The same by minimum degree alone, the order that slender bodies keep.
pub fn minimum_degree(problem: &ContactProblem) -> f64 {
    1.3e-8 * problem.stiffness().lower().entries() as f64
}

/// Seconds of a hierarchy of this number of unknowns and entries of the lower triangle
/// (`cargo run --release --example studies -- kinds`).
pub fn hierarchy(dofs: f64, entries: f64) -> f64 {
    5e-7 * dofs + 5.3e-8 * entries
}

/// Seconds of an iteration with one cycle of that hierarchy.
pub fn cycle(dofs: f64, entries: f64) -> f64 {
    2.3e-7 * dofs + 2.9e-9 * entries
}

/// Seconds of the work after the last step: the certificate, summed in twice the precision, and a report.
pub fn certificate(problem: &ContactProblem) -> f64 {
    1e-7 * problem.stiffness().lower().entries() as f64
}

/// Seconds of one factorisation in double precision.
pub fn factorisation(analysis: &Analysis) -> f64 {
    factor_seconds(analysis.multiplications(), analysis.factor_entries() as f64)
}

/// Seconds of one step of the interior-point method on a matrix with this analysis, with a row for each of its contact
/// dofs.
pub fn interior_point(analysis: &Analysis) -> f64 {
    // Its factor is built entry by entry, and its order needs three times the multiplications of ours.
    3.0 * 1.5e-9 * analysis.multiplications()
}

/// Seconds of the product of a dense triangle with its transpose, and of its use as a matrix.
pub fn dense(size: usize) -> f64 {
    MULTIPLICATION * (size as f64).powi(3)
}

/// Seconds that this number of columns adds to a factorisation if they come last.
pub fn last_block(size: usize) -> f64 {
    MULTIPLICATION * (size as f64).powi(3) / 6.0
}

/// Seconds of `count` sweeps through this number of values of a dense triangle.
pub fn sweeps(count: usize, values: f64) -> f64 {
    4e-10 * count as f64 * values
}

/// Seconds of the entries of the inverse in the pattern of the factor.
pub fn selected_inverse(analysis: &Analysis) -> f64 {
    FACTORISATIONS * factorisation(analysis)
}

/// Learns the pace from a small factorisation, if there is a deadline and nothing was timed before.
pub fn learn(watch: &Watch) {
    if watch.time_left().is_none() || watch.pace().is_some() {
        return;
    }
    let columns = LATTICE * LATTICE;
    let below = |column: usize| {
        let beside = (column % LATTICE + 1 < LATTICE).then_some((column + 1, column, -1.0));
        let above = (column + LATTICE < columns).then_some((column + LATTICE, column, -1.0));
        [Some((column, column, 5.0)), beside, above].into_iter().flatten()
    };
    let entries: Vec<_> = (0..columns).flat_map(below).collect();
    let lattice = SparseMatrix::from_triplets(columns, columns, &entries).and_then(SymmetricMatrix::from_lower);
    let Ok(lattice) = lattice else { return };
    let Ok(analysis) = Analysis::of(&lattice) else { return };
    // The first run is slower, because it fetches code and memory.
    let _ = black_box(analysis.factor(&lattice));
    let _ = black_box(watch.timed(factorisation(&analysis), || analysis.factor(&lattice)));
}
