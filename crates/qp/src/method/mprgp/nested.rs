//! A start from the second level of the hierarchy: the same problem is solved there, with means as bounds.
//!
//! From zero, the first step that the bounds cut off leaves jumps with an energy that grows as the mesh is refined: a
//! fine mesh is then closed layer by layer. From the answer of the second level a few steps remain, on any mesh.
//!
//! # Source
//! R. Kornhuber, *Monotone multigrid methods for elliptic variational inequalities I*, Numer. Math. 69 (1994) 167-184,
//! section 5: nested iteration.

use crate::error::Error;
use crate::linear::SparseMatrix;
use crate::linear::multigrid::{Interval, Multigrid};
use crate::method::Outcome;
use crate::method::bounds::Bounds;
use crate::problem::ContactProblem;

/// Tolerance of the problem of the second level, which is only approximate because its bounds are means.
const TOLERANCE: f64 = 1e-3;

/// Largest number of cycles on the second level.
const MOST_CYCLES: usize = 40;

/// The start for `problem` with `bounds` that are unknowns without reflections; `None` if the hierarchy has no second
/// level with nodal values, or if `solve(problem, hierarchy, tolerance, cycles)` finds no answer there.
pub fn nested_start(
    problem: &ContactProblem,
    bounds: &Bounds,
    multigrid: &Multigrid,
    solve: impl Fn(&ContactProblem, &Multigrid, f64, usize) -> Result<Outcome, Error>,
) -> Option<Vec<f64>> {
    if !bounds.is_plain || bounds.bounds.is_empty() {
        return None;
    }
    let coarser = multigrid.coarser()?;
    let mut intervals = vec![[f64::NEG_INFINITY, f64::INFINITY]; problem.dofs()];
    bounds.bounds.iter().for_each(|bound| intervals[bound.unknown] = [bound.lower, bound.upper]);
    let coarse = coarser.bounds(&intervals);
    let (contact, gap) = rows_of(&coarse)?;
    let mut load = problem.load().to_vec();
    bounds.turn_forces(&mut load);
    let below = ContactProblem::computed(coarser.matrix.clone(), coarser.load(&load), contact, gap).ok()?;
    let found = solve(&below, &coarser.multigrid, TOLERANCE, MOST_CYCLES).ok()?;
    let mut displacement = coarser.interpolated(&found.displacement, &coarse, &intervals);
    bounds.turn_back(&mut displacement);
    Some(displacement)
}

/// Rows and gaps of bounds, one row for each side.
fn rows_of(intervals: &[Interval]) -> Option<(SparseMatrix, Vec<f64>)> {
    let sides = |(unknown, &[lower, upper]): (usize, &Interval)| [(unknown, -1.0, -lower), (unknown, 1.0, upper)];
    let rows: Vec<(usize, f64, f64)> =
        intervals.iter().enumerate().flat_map(sides).filter(|side| side.2.is_finite()).collect();
    let entries: Vec<(usize, usize, f64)> =
        rows.iter().enumerate().map(|(row, &(unknown, sign, _))| (row, unknown, sign)).collect();
    let contact = SparseMatrix::from_triplets(rows.len(), intervals.len(), &entries).ok()?;
    Some((contact, rows.into_iter().map(|(_, _, gap)| gap).collect()))
}
