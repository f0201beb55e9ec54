//! The exact path of a contact problem with gaps or a load that move along a line.
//!
//! With the compliance G = B K^-1 B' of the contact rows and the violation b of the free body, the problem is
//!
//! ```text
//! d = b + G l,   d <= 0,   l <= 0,   d'l = 0,        b(t) = b_0 + t b_1
//! ```
//!
//! Its solution is piecewise linear in t. The walk follows one piece to the first t at which an open row touches or a
//! closed row loses its pressure, changes that row, and goes on: every such t is found exactly. If several rows change
//! at once, the next set is the one with slopes of the right signs.
//!
//! # Source
//! R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem*, section 4.5 (parametric principal
//! pivoting).

use super::SIGN_TOLERANCE;
use crate::error::{Error, LinearError, Result};
use crate::linear::watch::Watch;
use crate::linear::{UpperTriangle, dot, largest, subtract};
use crate::solution::ContactSet;

/// A row depends on the rows before it if its compliance with those rows held is this small, relative.
const DEPENDENT_COMPLIANCE: f64 = 1e-10;

/// A path is given up after this number of changes for each row.
const CHANGES_PER_ROW: usize = 50;

/// The compliance of the contact rows, with the violation of the free body as a function of t.
#[derive(Clone, Debug)]
pub struct ParametricLcp {
    /// G (m x m), column by column.
    pub matrix: Vec<f64>,
    /// b(t) = `constant` + t `slope`.
    pub constant: Vec<f64>,
    pub slope: Vec<f64>,
}

/// A row that changes sides on the way between two gaps: it touches, or it releases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Its place t on the path, from 0 to 1.
    pub at: f64,
    /// Index of the row that changes sides in the problem, from 0.
    pub row: usize,
    /// `true` if the row touches at this place, `false` if it releases.
    pub touches: bool,
}

/// A stretch of the path on which the contact set does not change.
#[derive(Clone, Debug)]
pub struct Piece {
    /// The t at its beginning.
    pub from: f64,
    /// The t at its end.
    pub to: f64,
    /// The rows that are closed on it.
    pub contact_set: ContactSet,
    line: Linear,
}

impl Piece {
    /// The multiplier of every row at `t`.
    pub fn multiplier(&self, t: f64) -> Vec<f64> {
        let of_row = |row: usize| if self.contact_set.contains(row) { self.line.at(row, t).min(0.0) } else { 0.0 };
        (0..self.contact_set.rows()).map(of_row).collect()
    }
}

impl ParametricLcp {
    /// The violation of every row for a unit multiplier of one row.
    fn column(&self, row: usize) -> &[f64] {
        &self.matrix[row * self.rows()..][..self.rows()]
    }

    fn rows(&self) -> usize {
        self.constant.len()
    }

    /// The rows of `closed`, and the Cholesky factor R of their block of G, without those that depend on others before
    /// them, which hold them already. On the walk a dependent row does not join, because its violation does not grow.
    fn independent(&self, closed: &ContactSet) -> (Vec<usize>, UpperTriangle) {
        let (mut kept, mut triangle) = (Vec::<usize>::new(), UpperTriangle::default());
        for row in closed.iter() {
            let column = self.column(row);
            let above = triangle.solve_lower(kept.iter().map(|&other| column[other]).collect());
            let pivot = column[row] - dot(&above, &above);
            if pivot > DEPENDENT_COMPLIANCE * column[row] {
                triangle.push(above, pivot.sqrt());
                kept.push(row);
            }
        }
        (kept, triangle)
    }

    /// Multipliers of the set `closed`, and violations of all other rows, as linear functions of t.
    fn respond(&self, closed: &ContactSet) -> Result<Linear> {
        let (list, factor) = self.independent(closed);
        if list.len() < closed.count() {
            return Err(LinearError::Numerical {
                step: "the exact path",
                reason: format!("the {} rows that would be closed together depend on each other", closed.count()),
            }
            .into());
        }
        let part = |b: &[f64]| self.part(&factor, &list, b);
        Ok(Linear { closed: closed.clone(), constant: part(&self.constant), slope: part(&self.slope) })
    }

    fn part(&self, factor: &UpperTriangle, list: &[usize], b: &[f64]) -> Vec<f64> {
        let multiplier = factor.solve_normal(list.iter().map(|&row| -b[row]).collect());
        let mut part = b.to_vec();
        for (&row, &value) in list.iter().zip(&multiplier) {
            subtract(&mut part, -value, self.column(row));
        }
        list.iter().zip(multiplier).for_each(|(&row, value)| part[row] = value);
        part
    }

    /// Walks from t = 0 to t = 1, from the set that holds at the beginning.
    pub fn walk(&self, start: &ContactSet, watch: &Watch) -> Result<(Vec<Piece>, Vec<Event>)> {
        let (mut pieces, mut events) = (Vec::new(), Vec::new());
        let mut closed = ContactSet::open(self.rows());
        self.independent(start).0.into_iter().for_each(|row| closed.insert(row));
        let mut now = 0.0;
        let length = largest(&self.constant).max(largest(&self.slope));
        for change in 0..CHANGES_PER_ROW * (self.rows() + 1) {
            if watch.is_over() {
                return Err(Error::Interrupted);
            }
            watch.step("exact path", change + 1);
            let line = self.respond(&closed)?;
            let force =
                closed.iter().map(|row| line.constant[row].abs().max(line.slope[row].abs())).fold(0.0, f64::max);
            let scales = [length, force].map(|scale| SIGN_TOLERANCE * scale);
            let next = (0..self.rows())
                .filter_map(|row| line.change(row, scales).map(|t| (t.max(now), row)))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let end = next.map_or(1.0, |(t, _)| t.min(1.0));
            if end > now || next.is_none_or(|(t, _)| t >= 1.0) {
                pieces.push(Piece { from: now, to: end, contact_set: closed.clone(), line: line.clone() });
            }
            match next {
                Some((t, row)) if t < 1.0 => {
                    now = t;
                    let undecided: Vec<usize> =
                        (0..self.rows()).filter(|&other| other == row || line.is_weak(other, t, scales)).collect();
                    let mut next = closed.clone();
                    next.toggle(row);
                    let after = self.turn(next, &undecided, scales)?;
                    for &row in &undecided {
                        if after.contains(row) != closed.contains(row) {
                            events.push(Event { at: t, row, touches: after.contains(row) });
                        }
                    }
                    closed = after;
                }
                _ => return Ok((pieces, events)),
            }
        }
        let reason = format!("the set still changes at {now} of the way after {} changes", events.len());
        Err(LinearError::Numerical { step: "the exact path", reason }.into())
    }

    /// The set that holds next, with slopes of right signs on `undecided` rows: by block, then by single pivots.
    fn turn(&self, mut next: ContactSet, undecided: &[usize], scales: [f64; 2]) -> Result<ContactSet> {
        let mut fewest = undecided.len() + 1;
        for _ in 0..CHANGES_PER_ROW * undecided.len() {
            let line = self.respond(&next)?;
            let is_wrong = |row: &usize| line.slope[*row] > line.rounding(*row, scales);
            let wrong: Vec<usize> = undecided.iter().copied().filter(is_wrong).collect();
            if wrong.is_empty() {
                break;
            }
            let exchanged = if wrong.len() < fewest { &wrong[..] } else { &wrong[wrong.len() - 1..] };
            fewest = fewest.min(wrong.len());
            exchanged.iter().for_each(|&row| next.toggle(row));
        }
        Ok(next)
    }
}

/// The multiplier of each closed row, and the violation of every other one, as a linear function of t.
#[derive(Clone, Debug)]
struct Linear {
    closed: ContactSet,
    constant: Vec<f64>,
    slope: Vec<f64>,
}

impl Linear {
    fn at(&self, row: usize, t: f64) -> f64 {
        self.constant[row] + t * self.slope[row]
    }

    /// Slopes and values below this are rounding: of these scales of a violation and of a force.
    fn rounding(&self, row: usize, scales: [f64; 2]) -> f64 {
        scales[usize::from(self.closed.contains(row))]
    }

    /// The t at which the row changes sides, if it moves in that direction.
    fn change(&self, row: usize, scales: [f64; 2]) -> Option<f64> {
        (self.slope[row] > self.rounding(row, scales)).then(|| -self.constant[row] / self.slope[row])
    }

    fn is_weak(&self, row: usize, t: f64, scales: [f64; 2]) -> bool {
        self.at(row, t).abs() <= self.rounding(row, scales)
    }
}
