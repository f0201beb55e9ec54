//! Closed rows together: the shift that puts them at their gaps, and the forces on them that balance the body.
//!
//! With the closed rows C, D the diagonal of K and `S = B_C D^-1 B_C'`, the shift of least energy in D that moves the
//! rows by s is `D^-1 B_C' S^-1 s`, and `S^-1 B_C D^-1 r` are the forces that leave least of a force r. If no two rows
//! share a dof, S is diagonal and one step of the iteration is exact.

use crate::linear::watch::Watch;
use crate::linear::{SparseMatrix, dot, largest, norm};
use crate::problem::{ContactProblem, Distances};

/// Exchanges of the set of rows: violated rows join, rows that follow from tighter ones leave.
const EXCHANGES: usize = 10;

/// Shifts of one set; each gains the digits of a solve.
const MOST_SHIFTS: usize = 12;

/// Another shift gains something if the distances that the last one left are below this share of those before.
const LEAST_GAIN: f64 = 0.5;

/// Rounding of a shift that is a sum of shifts, as a share of their magnitudes.
const OF_SHIFT: f64 = 8.0 * f64::EPSILON;

/// A solve ends if the square of what it has left is below this share of the first.
const SOLVED: f64 = 1e-24;

/// Steps of a solve for each row: rounding may need more than one.
const STEPS_FOR_A_ROW: usize = 4;

/// Steps of a solve that are taken although the time is over: rows with few dofs in common need no more.
const STEPS_WHEN_OVER: usize = 50;

/// A row is at its gap if its distance is below this share of the terms, far above the rounding of the sums.
const AT_GAP: f64 = 1e-26;

/// The contact rows, each a column, with the compliance `D^-1` of each dof alone, and the watch over the work on them.
pub struct WatchedRows<'a> {
    problem: &'a ContactProblem,
    pub by_row: SparseMatrix,
    compliance: Vec<f64>,
    watch: &'a Watch,
}

/// A displacement at which the closed rows are at their gaps and no other row is violated.
pub struct Placed {
    /// The shift d, rounded.
    pub shift: Vec<f64>,
    /// An upper bound on the energy norm, in each part, of what is missing in d: its rounding, and the end of the way.
    pub rest: Vec<f64>,
    /// The rows that are exactly at their gaps after both.
    pub closed: Vec<bool>,
}

struct ClosedRows<'a> {
    all: &'a WatchedRows<'a>,
    rows: Vec<usize>,
    /// `1 / sqrt(S_ii)`: with it the diagonal of S is one.
    scale: Vec<f64>,
}

impl<'a> ClosedRows<'a> {
    /// `None` if a row has no dofs.
    fn new(all: &'a WatchedRows, closed: &[bool]) -> Option<Self> {
        let rows: Vec<usize> = (0..closed.len()).filter(|&row| closed[row]).collect();
        let own = |&row: &usize| all.by_row.column(row).map(|(dof, b)| b * b * all.compliance[dof]).sum::<f64>();
        let scale: Vec<f64> = rows.iter().map(|row| 1.0 / own(row).sqrt()).collect();
        scale.iter().all(|scale| scale.is_finite()).then_some(ClosedRows { all, rows, scale })
    }

    /// `B_C v` of a displacement, rows scaled.
    fn along(&self, v: &[f64]) -> Vec<f64> {
        let product = |row: usize| self.all.by_row.column(row).map(|(dof, b)| b * v[dof]).sum::<f64>();
        self.rows.iter().zip(&self.scale).map(|(&row, scale)| scale * product(row)).collect()
    }

    /// `B_C' x` of forces on scaled rows.
    fn forces(&self, x: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; self.all.compliance.len()];
        for ((&row, scale), x) in self.rows.iter().zip(&self.scale).zip(x).filter(|entry| *entry.1 != 0.0) {
            self.all.by_row.column(row).for_each(|(dof, b)| forces[dof] += scale * x * b);
        }
        forces
    }

    /// `D^-1` times forces.
    fn shift(&self, mut forces: Vec<f64>) -> Vec<f64> {
        forces.iter_mut().zip(&self.all.compliance).for_each(|(force, compliance)| *force *= compliance);
        forces
    }

    /// `S^-1 b` for scaled rows: by conjugate residuals, which end with the least residual if rows follow from others.
    ///
    /// # Source
    /// E. Stiefel, *Relaxationsmethoden bester Strategie zur Lösung linearer Gleichungssysteme*, Comment. Math. Helv.
    /// 29 (1955) 157-179.
    fn solve(&self, b: Vec<f64>) -> Vec<f64> {
        let product = |x: &[f64]| self.along(&self.shift(self.forces(x)));
        let (mut x, mut rest) = (vec![0.0; b.len()], b);
        let mut of_rest = product(&rest);
        let (mut direction, mut of_direction) = (rest.clone(), of_rest.clone());
        let (mut work, least) = (dot(&rest, &of_rest), SOLVED * dot(&rest, &rest));
        for taken in 0..STEPS_FOR_A_ROW * self.rows.len() + STEPS_FOR_A_ROW {
            let step = work / dot(&of_direction, &of_direction);
            if !(step.is_finite() && work > 0.0) || (taken >= STEPS_WHEN_OVER && self.all.watch.is_over()) {
                break;
            }
            x.iter_mut().zip(&direction).for_each(|(x, d)| *x += step * d);
            rest.iter_mut().zip(&of_direction).for_each(|(r, d)| *r -= step * d);
            if dot(&rest, &rest) <= least {
                break;
            }
            of_rest = product(&rest);
            let next = dot(&rest, &of_rest);
            let share = next / work;
            direction.iter_mut().zip(&rest).for_each(|(d, r)| *d = r + share * *d);
            of_direction.iter_mut().zip(&of_rest).for_each(|(d, r)| *d = r + share * *d);
            work = next;
        }
        x
    }
}

pub fn watched_rows<'a>(problem: &'a ContactProblem, watch: &'a Watch) -> WatchedRows<'a> {
    let own = |&stiffness: &f64| if stiffness > 0.0 { 1.0 / stiffness } else { 0.0 };
    let mut compliance: Vec<f64> = problem.diagonal().values.iter().map(own).collect();
    // A dof without stiffness moves at no cost.
    let loose = Some(largest(&compliance)).filter(|&most| most > 0.0).unwrap_or(1.0);
    compliance.iter_mut().filter(|value| **value == 0.0).for_each(|value| *value = loose);
    WatchedRows { problem, by_row: problem.contact.transposed(), compliance, watch }
}

/// A shift of u that puts rows at their gaps, and all others within theirs. Of closed rows that follow from others only
/// the tightest stay closed. `None` if rows contradict each other, or if the time ends before long chains are solved.
pub fn placed(watched: &WatchedRows, displacement: &[f64], mut closed: Vec<bool>) -> Option<Placed> {
    let problem = watched.problem;
    let terms = problem.contact.mul_abs(displacement);
    for _ in 0..EXCHANGES {
        let [shift, rest, distance, moved] = moved_to_gaps(&ClosedRows::new(watched, &closed)?, displacement);
        let terms = |row: usize| terms[row] + problem.gap[row].abs() + moved[row];
        let is_off = |row: usize| distance[row].abs() > AT_GAP * terms(row);
        let violated: Vec<usize> =
            (0..problem.rows()).filter(|&row| !closed[row] && distance[row] > 0.0 && is_off(row)).collect();
        let off: Vec<usize> = (0..problem.rows()).filter(|&row| closed[row] && is_off(row)).collect();
        if violated.is_empty() && off.is_empty() {
            return Some(Placed { shift, rest, closed });
        }
        let looser: Vec<usize> = off.iter().copied().filter(|&row| distance[row] < 0.0).collect();
        // An equality that follows from other rows contradicts them if it is missed.
        if (!off.is_empty() && looser.is_empty()) || looser.iter().any(|&row| problem.is_two_sided(row)) {
            return None;
        }
        looser.iter().for_each(|&row| closed[row] = false);
        violated.iter().for_each(|&row| closed[row] = true);
    }
    None
}

/// The forces on the closed rows that leave least of `residual`, each in its dofs alone.
pub fn balancing(watched: &WatchedRows, closed: &[bool], residual: &[f64]) -> Option<Vec<f64>> {
    let rows = ClosedRows::new(watched, closed)?;
    let found = rows.solve(rows.along(&rows.shift(residual.to_vec())));
    let mut forces = vec![0.0; closed.len()];
    for ((&row, scale), x) in rows.rows.iter().zip(&rows.scale).zip(found) {
        forces[row] = -scale * x;
    }
    Some(forces)
}

/// The shift d that moves the rows to their gaps, what is missing in it, `B (u + d) - g`, d not rounded, and `|B| |d|`.
fn moved_to_gaps(rows: &ClosedRows, u: &[f64]) -> [Vec<f64>; 4] {
    let problem = rows.all.problem;
    let mut distances = Distances::of(problem);
    let mut distance = distances.moved(u);
    let zeros = || vec![0.0; problem.dofs()];
    let (mut shift, mut magnitude, mut last) = (zeros(), zeros(), zeros());
    let (mut before, mut gain) = (f64::INFINITY, 0.0);
    for _ in 0..MOST_SHIFTS {
        let off: Vec<f64> = rows.rows.iter().zip(&rows.scale).map(|(&row, scale)| -scale * distance[row]).collect();
        let size = norm(&off);
        gain = size / before;
        // What rows that follow from others are off, no shift takes away.
        if size == 0.0 || gain >= LEAST_GAIN {
            break;
        }
        before = size;
        last = rows.shift(rows.forces(&rows.solve(off)));
        distance = distances.moved(&last);
        for ((sum, most), step) in shift.iter_mut().zip(&mut magnitude).zip(&last) {
            *sum += step;
            *most += step.abs();
        }
    }
    let roots = &problem.diagonal().roots;
    // Each of the shifts that would follow is at most half as long as the one before.
    let follow = 2.0 * gain.min(1.0);
    let rest = problem.parts().sums(|dof| roots[dof] * (OF_SHIFT * magnitude[dof] + follow * last[dof].abs()));
    [shift, rest, distance, problem.contact.mul_abs(&magnitude)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::SymmetricMatrix;

    /// Rounding of a sum over a few dofs.
    const ROUNDING: f64 = 1e-14;

    /// Dofs of these stiffnesses, which nothing couples, and rows with gaps.
    fn problem(stiffness: &[f64], rows: &[&[f64]], gap: &[f64]) -> ContactProblem {
        let contact = SparseMatrix::from_table(rows.len(), stiffness.len(), &rows.concat()).unwrap();
        let (stiffness, load) = (SymmetricMatrix::of_diagonal(stiffness.to_vec()), vec![0.0; stiffness.len()]);
        ContactProblem::new(stiffness, load, contact, gap.to_vec()).unwrap()
    }

    fn placed(problem: &ContactProblem, u: &[f64], closed: &[bool]) -> Option<Placed> {
        super::placed(&watched_rows(problem, &Watch::default()), u, closed.to_vec())
    }

    #[test]
    fn a_dof_without_stiffness_moves_as_easily_as_the_softest() {
        for (stiffness, compliance) in [([4.0, 0.0, 2.0], [0.25, 0.5, 0.5]), ([0.0; 3], [1.0; 3])] {
            let problem = problem(&stiffness, &[&[1.0; 3]], &[1.0]);
            assert_eq!(watched_rows(&problem, &Watch::default()).compliance, compliance);
        }
    }

    #[test]
    fn a_closed_row_is_put_at_its_gap_by_the_shift_of_least_energy_in_any_unit() {
        for unit in [1e-12, 1.0, 1e12] {
            let problem = problem(&[4.0, 16.0], &[&[3.0, 4.0], &[0.0, 1.0]], &[25.0 * unit, 9.0 * unit]);
            let Placed { shift, rest, closed } = placed(&problem, &[0.0; 2], &[true, false]).unwrap();
            // K^-1 b is (3/4, 4/16), and b moves by 9/4 + 16/16 then.
            let scale = 25.0 * unit / (9.0 / 4.0 + 1.0);
            let exact = [0.75 * scale, 0.25 * scale];
            assert!(shift.iter().zip(exact).all(|(d, exact)| (d - exact).abs() < ROUNDING * scale), "{shift:?}");
            assert_eq!(closed, [true, false]);
            // Rounding of both dofs, against roots of stiffness of 2 and 4.
            let rounding = OF_SHIFT * (2.0 * exact[0] + 4.0 * exact[1]);
            let rest: f64 = rest.iter().sum();
            assert!(rest >= rounding && rest < 2.0 * rounding, "{rest:e} {rounding:e}");
        }
    }

    #[test]
    fn an_open_row_stays_where_it_is_unless_a_shift_violates_it() {
        let of_walls = |gap: f64| problem(&[1.0, 1.0], &[&[1.0, 1.0], &[1.0, 0.0]], &[2.0, gap]);
        let put = |gap: f64| placed(&of_walls(gap), &[0.0; 2], &[true, false]).unwrap();
        // Both dofs move by one to close the first row. That is beyond the wall of the first dof at 1/2.
        let free = put(1.5);
        assert_eq!((free.shift, free.closed), (vec![1.0, 1.0], vec![true, false]));
        let walled = put(0.5);
        assert_eq!(walled.closed, [true, true]);
        assert!((walled.shift[0] - 0.5).abs() < ROUNDING && (walled.shift[1] - 1.5).abs() < ROUNDING);
        // A penetration is taken back, and nothing else happens.
        let back = placed(&of_walls(0.5), &[0.75, 0.0], &[false, false]).unwrap();
        assert_eq!((back.shift, back.closed), (vec![-0.25, 0.0], vec![false, true]));
    }

    #[test]
    fn a_chain_of_rows_of_any_length_is_put_at_its_gaps_together() {
        // u_i - u_(i+1) <= 1: the shift of equal stiffnesses is the mean, (n - 1) / 2 - i.
        for dofs in [2_usize, 7, 300] {
            let rows: Vec<Vec<f64>> = (0..dofs - 1)
                .map(|row| (0..dofs).map(|dof| f64::from(dof == row) - f64::from(dof == row + 1)).collect())
                .collect();
            let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
            let chain = problem(&vec![1.0; dofs], &rows, &vec![1.0; dofs - 1]);
            let Placed { shift, rest, .. } = placed(&chain, &vec![0.0; dofs], &vec![true; dofs - 1]).unwrap();
            let exact = |dof: usize| (dofs - 1) as f64 / 2.0 - dof as f64;
            let off = (0..dofs).map(|dof| (shift[dof] - exact(dof)).abs()).fold(0.0, f64::max);
            assert!(off <= ROUNDING * dofs as f64, "{dofs}: {off:e}");
            assert!(rest.iter().sum::<f64>() <= ROUNDING * (dofs * dofs) as f64, "{dofs}: {rest:?}");
        }
    }

    #[test]
    fn of_rows_that_follow_from_each_other_the_tightest_stay_closed_and_opposed_ones_that_overlap_have_no_place() {
        let between = |gap: [f64; 2], side: f64| problem(&[1.0], &[&[1.0], &[side]], &gap);
        let put = |gap: [f64; 2], side: f64| placed(&between(gap, side), &[0.0], &[true, true]);
        // 1 and the next double below; the same in another scale, far away; and rows that meet exactly.
        let next = 1.0 - f64::EPSILON / 2.0;
        for (gap, side, closed) in [([1.0, next], 1.0, [false, true]), ([1.0, 3.0], 2.0, [true, false])] {
            assert_eq!(put(gap, side).unwrap().closed, closed, "{gap:?}");
        }
        assert_eq!(put([1.0, -1.0], -1.0).unwrap().closed, [true, true]);
        assert!(put([1.0, -1.0 - f64::EPSILON], -1.0).is_none());
        // A displacement far away is not forgiven more.
        let far = placed(&between([1.0, -1.0 - 1e-6], -1.0), &[1e12], &[true, true]);
        assert!(far.is_none());
        // A row without dofs has no place of its own.
        assert!(placed(&problem(&[1.0], &[&[0.0]], &[1.0]), &[0.0], &[true]).is_none());
    }

    #[test]
    fn closed_rows_take_the_force_that_is_out_of_balance_on_their_dofs() {
        // Forces of 3 and 5 on two dofs; the row of the first takes 3 / 2, one across both their mean.
        let balancing = |rows: &[&[f64]]| {
            let problem = problem(&[1.0, 1.0], rows, &vec![1.0; rows.len()]);
            let closed = vec![true; rows.len()];
            balancing(&watched_rows(&problem, &Watch::default()), &closed, &[3.0, 5.0]).unwrap()
        };
        assert_eq!(balancing(&[&[2.0, 0.0]]), [-1.5]);
        assert!((balancing(&[&[1.0, 1.0]])[0] + 4.0).abs() < ROUNDING);
        let both = balancing(&[&[1.0, 0.0], &[1.0, 1.0]]);
        assert!((both[0] - 2.0).abs() < ROUNDING && (both[1] + 5.0).abs() < ROUNDING, "{both:?}");
    }
}
