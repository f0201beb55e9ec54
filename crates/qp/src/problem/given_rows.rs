//! The rows as they were given: those of B, and equality rows, each of which is a pair of rows inside. Rows that
//! contradict each other are the evidence of an infeasible problem.

use std::borrow::Cow;

use super::ContactProblem;
use super::structure::largest_finite;
use crate::error::{Error, LinearError, Result};
use crate::linear::equations::{FOLLOWS, Following};
use crate::linear::{Accumulator, SparseMatrix, check_finite, largest};
use crate::solution::{ContactSet, Iteration, ProvenSet, Solution};

/// Terms of sums by which rows are looked for that follow from others: a fraction of a second.
const MOST_TERMS: usize = 5_000_000;

/// Rows must overlap by this share of their weighted gaps, beyond the rounding of the gaps themselves.
const OVERLAP: f64 = 4.0 * f64::EPSILON;

/// Weights that do not cancel exactly prove nothing about a displacement that is large enough. A contradiction counts
/// if such a displacement would have to be this many times larger than the gaps.
const FAR: f64 = 1e8;

impl ContactProblem {
    /// The same problem with the equality rows `E u = e`: E is p x n, dimensionless, and e has length p, in m. They may
    /// follow from each other; a row that does so except for the rounding of its numbers is left out, see
    /// [`warnings`](Self::warnings). Then
    ///
    /// ```text
    /// K u - f - B' lambda - E' mu = 0,   E u = e,   mu of either sign
    /// ```
    ///
    /// Each counts as two rows after those of B: first all of `E u <= e`, then all of `-E u <= -e`.
    ///
    /// ```
    /// use signorini_qp::{ContactProblem, SparseMatrix, SymmetricMatrix, solve_qp};
    ///
    /// // Two springs of stiffness 1, pushed with 3 and 1, whose ends move together: both by 2, and the tie takes 1.
    /// let stiffness = SparseMatrix::from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0)])?;
    /// let none = SparseMatrix::from_triplets(0, 2, &[])?;
    /// let tie = SparseMatrix::from_triplets(1, 2, &[(0, 0, 1.0), (0, 1, -1.0)])?;
    /// let problem = ContactProblem::new(SymmetricMatrix::from_lower(stiffness)?, vec![3.0, 1.0], none, vec![])?;
    /// let solution = solve_qp(&problem.with_equalities(&tie, vec![0.0])?)?;
    /// assert_eq!((solution.displacement, solution.equality_multiplier), (vec![2.0, 2.0], vec![-1.0]));
    /// # Ok::<(), signorini_qp::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`LinearError::Shape`], [`LinearError::Length`], [`LinearError::NotFinite`] for numbers that do not fit.
    pub fn with_equalities(&self, rows: &SparseMatrix, values: Vec<f64>) -> Result<Self, Error> {
        let mut problem = self.with_all_equalities(rows, values.clone())?;
        let mut following = rows.following_rows(&values, FOLLOWS, MOST_TERMS);
        following.retain(|following| !following.is_exact);
        let first = problem.inequalities();
        for row in following.iter().map(|following| first + following.row) {
            (problem.gap[row], problem.gap[row + rows.rows()]) = (f64::INFINITY, f64::INFINITY);
        }
        let with_value = |following: Following| (values[following.row], following);
        problem.following = following.into_iter().map(with_value).collect();
        Ok(problem)
    }

    /// The same with all rows, whether they follow from each other or not.
    pub(crate) fn with_all_equalities(&self, rows: &SparseMatrix, values: Vec<f64>) -> Result<Self> {
        if rows.columns() != self.dofs() {
            let (found, expected) = ((rows.rows(), rows.columns()), (rows.rows(), self.dofs()));
            return Err(LinearError::Shape { name: "equality matrix", found, expected }.into());
        }
        check_finite("equality vector", &values, (rows.rows(), "equality rows"))?;
        let (inequalities, count) = (self.inequalities(), rows.rows());
        let own = self.contact.triplets().filter(|entry| entry.0 < inequalities);
        let sides = |first: usize, sign: f64| rows.triplets().map(move |(row, dof, b)| (first + row, dof, sign * b));
        let entries: Vec<(usize, usize, f64)> =
            own.chain(sides(inequalities, 1.0)).chain(sides(inequalities + count, -1.0)).collect();
        let contact = SparseMatrix::from_triplets(inequalities + 2 * count, self.dofs(), &entries)?;
        let mut gap = self.gap[..inequalities].to_vec();
        gap.extend(&values);
        gap.extend(values.iter().map(|value| -value));
        let problem = ContactProblem::new(self.stiffness.clone(), self.load.clone(), contact, gap)?;
        Ok(ContactProblem { near_null: self.near_null.clone(), equality_rows: count, ..problem })
    }

    /// The same body under another load, with the rows `open` and with those `held` as equalities, at distances of all.
    pub(crate) fn with_held(&self, load: Vec<f64>, [open, held]: [&[usize]; 2], distances: &[f64]) -> Result<Self> {
        let pick = |rows: &[usize]| (self.contact.select_rows(rows), rows.iter().map(|&row| distances[row]).collect());
        let ((open, gap), (held, values)) = (pick(open), pick(held));
        let problem = ContactProblem::computed(self.stiffness.clone(), load, open, gap)?;
        ContactProblem { near_null: self.near_null.clone(), ..problem }.with_all_equalities(&held, values)
    }

    /// Number m of rows of B.
    pub fn inequalities(&self) -> usize {
        self.rows() - 2 * self.equality_rows
    }

    /// Number p of equality rows.
    pub fn equality_rows(&self) -> usize {
        self.equality_rows
    }

    /// The matrix E (p x n, dimensionless) and the values e (length p, in m) of the equality rows.
    pub fn equalities_given(&self) -> (SparseMatrix, Vec<f64>) {
        let rows: Vec<usize> = (self.inequalities()..self.inequalities() + self.equality_rows).collect();
        let mut values = self.gap[self.inequalities()..][..self.equality_rows].to_vec();
        self.following.iter().for_each(|(value, following)| values[following.row] = *value);
        (self.contact.select_rows(&rows), values)
    }

    /// The matrix B (m x n, dimensionless) and the gaps g (length m, in m, negative inside the body), without the
    /// equality rows.
    pub fn inequalities_given(&self) -> (Cow<'_, SparseMatrix>, &[f64]) {
        let count = self.inequalities();
        let rows = || self.contact.select_rows(&(0..count).collect::<Vec<usize>>());
        let contact = if self.equality_rows == 0 { Cow::Borrowed(&self.contact) } else { Cow::Owned(rows()) };
        (contact, &self.gap[..count])
    }

    /// Codes and sentences: `empty-row` for each row without entries whose gap was rounding beside the largest gap, and
    /// counts as zero; `redundant-row` for the equality rows that follow from others except for rounding, and are left
    /// out.
    pub fn warnings(&self) -> Vec<(&'static str, String)> {
        let (inequalities, size) = (self.inequalities(), largest_finite(&self.gap));
        let first_of_pair = self.rounded.iter().filter(|entry| entry.0 < inequalities + self.equality_rows);
        let in_words = |&(row, gap): &(usize, f64)| {
            let row = match row.checked_sub(inequalities) {
                None => format!("contact row {row}"),
                Some(row) => format!("equality row {row}"),
            };
            let sentence = format!(
                "{row} (from 0) has no entry, and the gap {gap:e}, which is rounding beside the largest, {size:e}: it counts as 0, and the \
                 certificate is that of the changed problem"
            );
            ("empty-row", sentence)
        };
        first_of_pair.map(in_words).chain(self.left_out()).collect()
    }

    /// The warning of the equality rows that are left out.
    fn left_out(&self) -> Option<(&'static str, String)> {
        let first = self.following.iter().map(|(_, following)| following.row).min()?;
        let more = self.following.len().saturating_sub(1);
        let are = if more == 0 { " is".to_string() } else { format!(" and {more} more are") };
        let sentence = format!(
            "equality row {first} (from 0){are} left out, with multiplier 0: the others say the same, except for rounding of the numbers; the \
             certificate is that of the changed problem"
        );
        Some(("redundant-row", sentence))
    }

    /// Multipliers of all rows, from those of the rows of B and then of the equality rows; others stay as they are.
    pub(crate) fn of_all_rows<'a>(&self, multiplier: &'a [f64]) -> Cow<'a, [f64]> {
        let inequalities = self.inequalities();
        if self.equality_rows == 0 || multiplier.len() != inequalities + self.equality_rows {
            return Cow::Borrowed(multiplier);
        }
        let (own, of_equalities) = multiplier.split_at(inequalities);
        // The rows from which a row follows take its force.
        let mut of_equalities = of_equalities.to_vec();
        for (_, Following { row, weights, .. }) in self.following.iter() {
            let force = of_equalities[*row];
            weights.iter().for_each(|&(other, weight)| of_equalities[other] -= weight * force);
            of_equalities[*row] = 0.0;
        }
        let sides = [1.0, -1.0].map(|sign| of_equalities.iter().map(move |mu| (sign * mu).min(0.0)));
        Cow::Owned(own.iter().copied().chain(sides.into_iter().flatten()).collect())
    }

    /// The gaps of all rows, from those of the rows of B; others stay as they are.
    pub(crate) fn gaps_of_all_rows(&self, mut gap: Vec<f64>) -> Vec<f64> {
        if self.equality_rows > 0 && gap.len() == self.inequalities() {
            gap.extend(&self.gap[self.inequalities()..]);
        }
        gap
    }

    /// A set of the rows of B alone.
    pub(crate) fn of_inequalities(&self, set: &ContactSet) -> ContactSet {
        ContactSet::from_fn(self.inequalities(), |row| set.contains(row))
    }

    /// A set of the rows of B, and one row of each equality.
    pub(crate) fn with_equality_rows(&self, set: &ContactSet) -> ContactSet {
        let equalities = self.inequalities()..self.inequalities() + self.equality_rows;
        let is_equality = |row: usize| equalities.contains(&row) && self.gap[row].is_finite();
        ContactSet::from_fn(self.rows(), |row| is_equality(row) || set.contains(row))
    }

    /// The multipliers of the rows of B, and those of the equality rows.
    pub(crate) fn split(&self, mut multiplier: Vec<f64>) -> [Vec<f64>; 2] {
        let pairs = multiplier.split_off(self.inequalities());
        let (sides, opposed) = pairs.split_at(self.equality_rows);
        [multiplier, sides.iter().zip(opposed).map(|(a, b)| a - b).collect()]
    }

    /// An answer in the rows as they were given.
    pub(crate) fn in_given_rows(&self, solution: Solution) -> Solution {
        if self.equality_rows == 0 {
            return solution;
        }
        let of = |set: &ContactSet| self.of_inequalities(set);
        let history = solution.history.into_iter();
        let history = history.map(|step| Iteration { contact_set: of(&step.contact_set), ..step }).collect();
        let proven =
            solution.proven.map(|ProvenSet { open, closed }| ProvenSet { open: of(&open), closed: of(&closed) });
        let contact_set = of(&solution.contact_set);
        let [multiplier, equality_multiplier] = self.split(solution.multiplier);
        Solution { history, proven, contact_set, multiplier, equality_multiplier, ..solution }
    }

    /// Rows with weights, as they were given: an equality row follows those of B, and has a weight of either sign.
    pub(crate) fn weights_of_given(&self, rows: &[usize], weights: &[f64]) -> (Vec<usize>, Vec<f64>) {
        let opposed = self.inequalities() + self.equality_rows;
        let given = |(&row, &weight): (&usize, &f64)| {
            if row < opposed { (row, weight) } else { (row - self.equality_rows, -weight) }
        };
        rows.iter().zip(weights).map(given).unzip()
    }

    /// The error that no displacement satisfies the contact rows `rows` together, by these weights.
    pub(crate) fn infeasible(&self, rows: &[usize], weights: &[f64]) -> Error {
        let overlap = self.overlap(rows, weights).unwrap_or(0.0);
        let by = if overlap > 0.0 { format!(": they overlap by {overlap:.3e}") } else { String::new() };
        let (rows, weights) = self.weights_of_given(rows, weights);
        let (contact, equalities): (Vec<usize>, Vec<usize>) = rows.iter().partition(|&&row| row < self.inequalities());
        let equalities: Vec<usize> = equalities.into_iter().map(|row| row - self.inequalities()).collect();
        let named = match (contact.is_empty(), equalities.is_empty()) {
            (_, true) => format!("the contact rows {contact:?}"),
            (true, false) => format!("the equality rows {equalities:?}"),
            (false, false) => format!("the contact rows {contact:?} and the equality rows {equalities:?}"),
        };
        let reason = format!("no displacement satisfies {named} together{by} (indices from 0)");
        Error::Infeasible { reason, rows, weights, overlap }
    }

    /// The length by which the contact rows `rows` overlap under the weights y, one for each row: `-g'y` if the largest
    /// weight is one. `None` if y proves nothing.
    ///
    /// By Farkas' lemma no displacement satisfies `B u <= g` if and only if there are weights `y >= 0` with `B'y = 0`
    /// and `g'y < 0`: the rows, weighted, would ask for `0 <= g'y`. Doubles may leave a share s of the terms `|B|'y` of
    /// a dof: then a displacement that meets the rows is at least as large as `-g'y / s`, in the same terms, which must
    /// be 1e8 times `|g|'y`. All sums have twice the working precision, and neither scaled rows nor scaled dofs change
    /// the verdict.
    pub fn overlap(&self, rows: &[usize], weights: &[f64]) -> Option<f64> {
        let size = largest(weights);
        let known = rows.iter().all(|&row| row < self.rows()) && rows.len() == weights.len();
        if !(known && size > 0.0 && size.is_finite()) || weights.iter().any(|&weight| weight.is_nan() || weight < 0.0) {
            return None;
        }
        let mut y = vec![0.0; self.rows()];
        rows.iter().zip(weights).for_each(|(&row, &weight)| y[row] += weight / size);
        let mut left = Accumulator::new(&vec![0.0; self.dofs()]);
        self.contact.triplets().for_each(|(row, dof, b)| left.add_product(dof, b, y[row]));
        let terms = self.contact.mul_abs_transposed(&y);
        let left_over = left.into_sums().into_iter().zip(&terms).filter(|entry| *entry.1 > 0.0);
        let share = left_over.fold(0.0, |most: f64, (left, terms)| most.max(left.abs() / terms));
        let mut sum = Accumulator::new(&[0.0]);
        let weighted = || y.iter().zip(&self.gap).filter(|(weight, _)| **weight > 0.0);
        weighted().for_each(|(&weight, &gap)| sum.add_product(0, -weight, gap));
        let overlap = sum.into_sums()[0];
        let doubt = OVERLAP.max(FAR * share) * weighted().map(|(weight, gap)| weight * gap.abs()).sum::<f64>();
        (overlap > doubt).then_some(overlap)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A dof between two rows: `u <= g_0` and `-b u <= g_1`.
    fn between(b: f64, gap: [f64; 2]) -> ContactProblem {
        ContactProblem::of_entries(&[(0, 0, 1.0)], &[0.0], &[(0, 0, 1.0), (1, 0, -b)], &gap)
    }

    #[test]
    fn rows_overlap_by_the_length_that_is_missing_if_weights_cancel_and_gaps_say_more_than_rounding() {
        // u <= -1 and u >= -1/2.
        let walls = between(1.0, [-1.0, 0.5]);
        // Half the weights on the same row twice.
        assert_eq!(walls.overlap(&[0, 1, 1], &[1.0, 0.5, 0.5]), Some(0.5));
        assert_eq!(walls.overlap(&[0], &[1.0, 1.0]), None);
        for (rows, weights, overlap) in [
            ([0, 1], [1.0, 1.0], Some(0.5)),
            ([1, 0], [3.0, 3.0], Some(0.5)),
            // Weights that do not cancel, or are none.
            ([0, 1], [1.0, 0.5], None),
            ([0, 1], [1.0, -1.0], None),
            ([0, 1], [0.0, 0.0], None),
            ([0, 1], [f64::NAN, 1.0], None),
            ([0, 1], [f64::INFINITY, f64::INFINITY], None),
            ([0, 2], [1.0, 1.0], None),
        ] {
            assert_eq!(walls.overlap(&rows, &weights), overlap, "{rows:?} {weights:?}");
        }
        let is_proven = |b: f64, gap: [f64; 2]| between(b, gap).overlap(&[0, 1], &[1.0, 1.0]).is_some();
        assert!(!is_proven(1.0, [1.0, -0.5]));
        // 1 - b of the terms 1 + b is left, a share of 5e-10. A displacement 1e8 times the gaps would need 5 %.
        assert!(!is_proven(1.0 - 1e-9, [-1.0, 0.92]) && is_proven(1.0 - 1e-9, [-1.0, 0.89]));
        // The gaps are 1 and the doubles next below -1; four units in the last place of both together are 8.
        assert!(!is_proven(1.0, [1.0, -1.0 - 7.0 * f64::EPSILON]) && is_proven(1.0, [1.0, -1.0 - 9.0 * f64::EPSILON]));
    }
}
