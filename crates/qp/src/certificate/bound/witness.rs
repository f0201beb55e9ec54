//! The repair itself: which rows are closed, and the forces that put them at their gaps.

use super::allowed;
use super::repair::{Force, Repair, Witness};
use crate::linear::{UpperTriangle, dot, norm, take_out};

/// Number of corrections of the set of rows that look closed; after these, rows are only added.
const EXCHANGES: usize = 10;

/// Corrections of the multipliers that put rows at their gaps; each gains the digits that dependent rows leave.
const CORRECTIONS: usize = 4;

/// After a fit, rows that follow from others are off by their own rounding and by that of their distances.
const FOLLOWS: f64 = 2.0;

/// A weight is rounding if its part of the row that follows is below this share of the row.
const NO_WEIGHT: f64 = 64.0 * f64::EPSILON;

/// Share of the largest force that each row keeps where springs hold the body, each force times the energy norm of the
/// shift that a unit force causes. The rounding of the forces left out of balance is below it, and with it the slack is
/// still rounding.
const KEPT: f64 = 1024.0 * f64::EPSILON;

/// Share of the gaps beyond which the rounding of a distance hides whether dependent rows contradict each other.
const HIDDEN: f64 = 1e-8;

/// Rounding of a row's distance after a shift, in units of its terms.
const DISTANCE_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Returns `true` if a row that follows from others has another gap than they leave it, while distances that small are
/// rounding. `gaps` are its own and those of the others, times their weights; a row without others never does.
fn contradict(gaps: &[f64], rounding: f64) -> bool {
    let terms: f64 = gaps.iter().map(|gap| gap.abs()).sum();
    gaps.len() > 1 && rounding > HIDDEN * terms && gaps.iter().sum::<f64>().abs() > DEPENDENT * terms
}

impl Repair<'_> {
    /// The equilibrium of the rows that look closed if all these rows push, otherwise the better of both repairs.
    pub fn best_witness(&self, closed: &[bool]) -> Option<Witness> {
        let settled = self.settle(closed, true);
        if settled.as_ref().is_some_and(|witness| witness.is_equilibrium) {
            return settled;
        }
        let size = |witness: &Witness| self.bound(witness).size();
        [settled, self.settle(closed, false)].into_iter().flatten().min_by(|a, b| size(a).total_cmp(&size(b)))
    }

    /// The force without the change of the multipliers of closed rows; in equilibrium open rows lose their multipliers.
    fn base(&self, closed: &[bool], balances: bool) -> Force {
        let dropped = |row: usize| if closed[row] { 0.0 } else { -self.multiplier[row] };
        match balances {
            true => Force::new(1.0, (0..closed.len()).map(dropped).collect()),
            false => Force::new(0.0, vec![0.0; closed.len()]),
        }
    }

    /// A feasible point with closed rows at their gaps, and the multipliers that balance it or those of the answer.
    pub fn settle(&self, closed: &[bool], balances: bool) -> Option<Witness> {
        let rows = self.count();
        let mut closed = closed.to_vec();
        // The exchange that put a row first; 0 if none did.
        let mut first = vec![0; rows];
        for exchange in 0..=rows + EXCHANGES {
            // The deepest first: of two rows that contradict each other as equalities the tighter one is kept.
            let mut set: Vec<usize> = (0..rows).filter(|&row| closed[row]).collect();
            set.sort_by(|&a, &b| first[b].cmp(&first[a]).then(self.violation[b].total_cmp(&self.violation[a])));
            let fitted = self.fit(&set, &self.base(&closed, balances))?;
            let Fitted { change, distance, tolerance, triangle, .. } = &fitted;
            let independent = triangle.independent();
            let violated: Vec<usize> =
                (0..rows).filter(|&row| !closed[row] && distance[row] > tolerance[row]).collect();
            let missed = |row: usize| closed[row] && distance[row].abs() > tolerance[row];
            let follows =
                set.iter().zip(&independent).filter(|entry| !*entry.1 && missed(*entry.0)).map(|entry| *entry.0);
            let (deeper, looser): (Vec<usize>, Vec<usize>) = follows.partition(|&row| distance[row] > 0.0);
            let pulls = |row: &usize| {
                balances && self.multiplier[*row] + change[*row] > 0.0 && !self.answer.problem.is_two_sided(*row)
            };
            let pulling: Vec<usize> = set.iter().copied().filter(pulls).collect();
            let is_met = violated.is_empty() && deeper.is_empty() && looser.is_empty();
            if is_met && (pulling.is_empty() || exchange >= EXCHANGES) {
                let has_dependent = first.iter().any(|&first| first > 0) || independent.contains(&false);
                // Whether such a row is violated is rounding of the way.
                let is_excused =
                    |row: usize| !closed[row] && tolerance[row] > 0.0 && distance[row].abs() <= tolerance[row];
                let is_rounded = has_dependent || (0..rows).any(is_excused);
                if set.iter().zip(triangle.weights()).any(|(&row, weights)| {
                    let of_others = weights.map(|(other, weight)| -weight * self.gap[set[other]]);
                    contradict(&of_others.chain([self.gap[row]]).collect::<Vec<_>>(), tolerance[row])
                }) {
                    return None;
                }
                return Some(Witness { is_rounded, ..self.witness(&set, fitted, closed, balances) });
            }
            // Of copies that differ by rounding the tightest comes first in the end, unless they contradict each other.
            if exchange >= EXCHANGES && deeper.iter().any(|&row| first[row] > 0) {
                return None;
            }
            // An equality that follows from other rows contradicts them if it is missed.
            if looser.iter().any(|&row| self.answer.problem.is_two_sided(row)) {
                return None;
            }
            deeper.iter().for_each(|&row| first[row] = exchange + 1);
            violated.iter().for_each(|&row| closed[row] = true);
            looser.iter().filter(|_| deeper.is_empty()).for_each(|&row| closed[row] = false);
            // The force of a looser row passes to other rows, which may then stop pulling.
            if exchange < EXCHANGES && looser.is_empty() {
                pulling.iter().for_each(|&row| closed[row] = false);
            }
        }
        None
    }

    fn witness(&self, set: &[usize], fitted: Fitted, closed: Vec<bool>, balances: bool) -> Witness {
        let rest = self.rest(set, &fitted);
        let Fitted { change, error, distance, tolerance, triangle } = fitted;
        let balanced = |row: usize| self.multiplier[row] + if balances { change[row] } else { 0.0 };
        // A force that pulls is no multiplier, and nothing balances one on a loose dof.
        let holds = |row: usize| closed[row] && !self.norm.is_on_loose_dof(row);
        let mut multiplier: Vec<f64> = (0..change.len())
            .map(|row| if holds(row) { allowed(self.answer.problem, row, balanced(row)) } else { 0.0 })
            .collect();
        let is_balanced = |row: usize| multiplier[row] == balanced(row) && multiplier[row].is_finite();
        let is_equilibrium = balances && set.iter().all(|&row| is_balanced(row));
        let passes = self.pass_on(set, &triangle, &mut multiplier);
        let left = |row: usize| match balances {
            true if closed[row] => multiplier[row] - balanced(row),
            true => 0.0,
            false => multiplier[row] - self.multiplier[row] - change[row],
        };
        let rows = (0..change.len()).map(left).collect();
        let changed = |row: usize| match passes[row] {
            true => multiplier[row],
            false if balances && multiplier[row] != 0.0 => change[row],
            false => 0.0,
        };
        let (change, left) = ((0..change.len()).map(changed).collect(), Force::new(1.0 - error.alpha, rows));
        let mut slack = vec![0.0; multiplier.len()];
        for (&row, weights) in set.iter().zip(triangle.weights()) {
            // The others are put exactly at their gaps, which moves the row as well.
            let ways: Vec<f64> = weights.map(|(other, weight)| (weight * distance[set[other]]).abs()).collect();
            if !ways.is_empty() {
                let way = distance[row].abs() + tolerance[row] + ways.iter().sum::<f64>();
                slack[row] = multiplier[row].abs() * way;
            }
        }
        Witness { error, left, multiplier, change, passes, closed, rest, slack, is_equilibrium, is_rounded: false }
    }

    /// A row that follows from others passes its force on to them, as far as none of them pulls. Returns `true` for the
    /// rows whose multipliers it changed.
    ///
    /// A row that follows from others is at its gap by rounding only, and its force times this rounding is slack. With
    /// springs each row keeps a share of the largest force that is beyond rounding, so that its spring holds.
    fn pass_on(&self, set: &[usize], triangle: &Triangle, multiplier: &mut [f64]) -> Vec<bool> {
        let mut passes = vec![false; multiplier.len()];
        if !triangle.independent().contains(&false) {
            return passes;
        }
        let mut length = vec![0.0; multiplier.len()];
        set.iter().for_each(|&row| length[row] = self.product(row, row).sqrt());
        let share = if self.norm.springs.is_some() { KEPT } else { 0.0 };
        let kept = share * set.iter().map(|&row| multiplier[row].abs() * length[row]).fold(0.0, f64::max);
        let can_give = |row: usize, multiplier: &[f64]| match self.answer.problem.is_two_sided(row) {
            true => f64::INFINITY,
            false if kept > 0.0 => (-multiplier[row] - kept / length[row]).max(0.0),
            false => -multiplier[row],
        };
        for (&row, weights) in set.iter().zip(triangle.weights()) {
            let is_weight = |(other, weight): &(usize, f64)| weight.abs() * length[*other] > NO_WEIGHT * length[row];
            let others: Vec<(usize, f64)> =
                weights.map(|(other, weight)| (set[other], weight)).filter(is_weight).collect();
            let force = multiplier[row];
            if force == 0.0 || others.is_empty() || others.iter().any(|other| self.norm.is_on_loose_dof(other.0)) {
                continue;
            }
            let taking = others.iter().filter(|(_, weight)| weight * force > 0.0);
            let shares = taking.map(|&(other, weight)| can_give(other, multiplier) / (weight * force));
            let share = shares.fold((can_give(row, multiplier) / force.abs()).min(1.0), f64::min);
            for (row, weight) in others.into_iter().chain([(row, -1.0)]).filter(|_| share > 0.0) {
                passes[row] = true;
                multiplier[row] = allowed(self.answer.problem, row, multiplier[row] + share * (weight * force));
            }
        }
        passes
    }

    /// Upper bounds on the energy norm of the shift of each row alone exactly to its gap; zero for dependent rows.
    ///
    /// The shifts of all rows together put every row at its gap, so the sum of their lengths bounds the way to such a
    /// point, for all signs of the rounding errors in the distances. The part of a row that is orthogonal to the rows
    /// before it is at least 64 units in the last place if the triangle keeps the row: rounding of its column changes
    /// the lengths by a small share.
    fn rest(&self, set: &[usize], fitted: &Fitted) -> Vec<f64> {
        let mut rest = vec![0.0; self.count()];
        for (&row, length) in set.iter().zip(fitted.triangle.lengths_of_inverse()) {
            let shift = (fitted.distance[row].abs() + fitted.tolerance[row]) * length;
            rest[row] = self.norm.length(shift * shift);
        }
        rest
    }

    /// The multipliers that put the rows of `set` at their gaps beside the force `base`; `None` if there is no time.
    fn fit(&self, set: &[usize], base: &Force) -> Option<Fitted> {
        let columns = self.halves(set)?;
        let triangle = triangle_of(&columns, |a, b| self.product(set[a], set[b]), || self.norm.is_over())?;
        let independent = triangle.independent();
        let (mut change, mut steps) = (vec![0.0; self.count()], vec![0.0; self.count()]);
        let mut moved = self.boundary.block.backward(self.sweep(base));
        // The magnitudes of the shifts whose sum is `moved`: that keeps the rounding of each.
        let mut magnitude: Vec<f64> = moved.iter().map(|shift| shift.abs()).collect();
        let mut correction = 0;
        loop {
            let terms = self.by_row().mul_abs_transposed(&magnitude);
            let distance: Vec<f64> =
                self.violation.iter().zip(self.by_row().mul_transposed(&moved)).map(|(v, along)| v + along).collect();
            let mut tolerance: Vec<f64> =
                self.violation.iter().zip(terms).map(|(v, terms)| DISTANCE_ROUNDING * (v.abs() + terms)).collect();
            // A row that follows from others is at its gap as precisely as they are.
            for (&row, weights) in set.iter().zip(triangle.weights()) {
                let of_others = weights.map(|(other, weight)| weight.abs() * tolerance[set[other]]);
                tolerance[row] += FOLLOWS * of_others.sum::<f64>();
            }
            let is_met = |(&row, &kept): (&usize, &bool)| !kept || distance[row].abs() <= tolerance[row];
            if set.iter().zip(&independent).all(is_met) || correction == CORRECTIONS {
                return Some(Fitted { error: base.plus(&change, &steps), change, distance, tolerance, triangle });
            }
            correction += 1;
            let back: Vec<f64> = set.iter().map(|&row| -distance[row]).collect();
            let step = triangle.solve_normal(&back);
            let mut added = vec![0.0; self.count()];
            set.iter().zip(step).for_each(|(&row, step)| added[row] = step);
            change.iter_mut().zip(&added).for_each(|(sum, step)| *sum += step);
            // The shifts are those of the forces, except for the rounding of each step, even if steps cancel.
            steps.iter_mut().zip(&added).for_each(|(sum, step)| *sum += step.abs());
            for ((sum, most), step) in
                moved.iter_mut().zip(&mut magnitude).zip(self.boundary.block.backward(self.spread(&added)))
            {
                *sum += step;
                *most += step.abs();
            }
        }
    }
}

/// Rows after a fit: changes of multipliers, distances and their rounding, and the triangle of the rows of the set.
struct Fitted {
    change: Vec<f64>,
    /// The force that puts them there, which includes the change of the multipliers and the magnitudes of its steps.
    error: Force,
    distance: Vec<f64>,
    tolerance: Vec<f64>,
    triangle: Triangle,
}

/// R of the columns of Z that do not follow from others, and the weights with which the other columns follow from them.
#[derive(Default)]
struct Triangle {
    r: UpperTriangle,
    /// The place in Z of each column of R.
    kept: Vec<usize>,
    /// For each column of Z the weights of the columns of R before it; empty for a column of R.
    weights: Vec<Vec<f64>>,
}

/// Pivots below this share of the products that cancel in them are rounding of nearly dependent rows.
const PARALLEL: f64 = 1e-12;

/// A row follows from others if its component orthogonal to them is below this share of the terms.
const DEPENDENT: f64 = 64.0 * f64::EPSILON;

/// Number of times that a row is made orthogonal to others: the second removes the rounding of the first.
const TURNS: usize = 2;

/// R from the products of the columns of Z. If some are nearly parallel, such as rows on a part much softer than the
/// others, the products have lost their difference, and the columns themselves are made orthogonal.
///
/// `product` gives the product of two of the columns. `None` if it `is_over` before R is found.
fn triangle_of(
    columns: &[&[f64]],
    product: impl Fn(usize, usize) -> f64,
    is_over: impl Fn() -> bool,
) -> Option<Triangle> {
    let found = of_products(columns.len(), product, &is_over)?;
    if found.kept.len() < columns.len() { of_columns(columns, &is_over) } else { Some(found) }
}

fn of_products(count: usize, product: impl Fn(usize, usize) -> f64, is_over: &impl Fn() -> bool) -> Option<Triangle> {
    let mut found = Triangle::default();
    let lengths: Vec<f64> = (0..count).map(|column| product(column, column).sqrt()).collect();
    for column in 0..count {
        if is_over() {
            return None;
        }
        let entries = found.r.solve_lower(found.kept.iter().map(|&place| product(column, place)).collect());
        let pivot = product(column, column) - dot(&entries, &entries);
        found.take(entries, &lengths, |terms| (pivot > PARALLEL * terms * terms).then(|| pivot.sqrt()));
    }
    Some(found)
}

fn of_columns(columns: &[&[f64]], is_over: &impl Fn() -> bool) -> Option<Triangle> {
    let mut found = Triangle::default();
    let mut directions: Vec<Vec<f64>> = Vec::new();
    let lengths: Vec<f64> = columns.iter().map(|column| norm(column)).collect();
    for column in columns {
        if is_over() {
            return None;
        }
        let (mut entries, mut across) = (vec![0.0; directions.len()], column.to_vec());
        for _ in 0..TURNS {
            for (entry, direction) in entries.iter_mut().zip(&directions) {
                *entry += take_out(&mut across, direction);
            }
        }
        let left = norm(&across);
        if found.take(entries, &lengths, |terms| (left > DEPENDENT * terms).then_some(left)) {
            across.iter_mut().for_each(|entry| *entry /= left);
            directions.push(across);
        }
    }
    Some(found)
}

impl Triangle {
    /// Takes in the next column of Z, which has these entries in R. `diagonal` gives its diagonal entry, or `None` if
    /// it follows from the columns of R, from the lengths of the terms that cancel. Returns `true` if R has it.
    fn take(&mut self, entries: Vec<f64>, lengths: &[f64], diagonal: impl Fn(f64) -> Option<f64>) -> bool {
        let place = self.weights.len();
        let weights = self.r.solve_upper(entries.clone());
        let along = weights.iter().zip(&self.kept);
        let terms = along.fold(lengths[place], |sum, (weight, &other)| sum + weight.abs() * lengths[other]);
        let diagonal = diagonal(terms);
        if let Some(diagonal) = diagonal {
            self.r.push(entries, diagonal);
            self.kept.push(place);
        }
        self.weights.push(if diagonal.is_some() { Vec::new() } else { weights });
        diagonal.is_some()
    }

    /// `true` for each column of Z that does not follow from those before it.
    pub fn independent(&self) -> Vec<bool> {
        let mut independent = vec![false; self.weights.len()];
        self.kept.iter().for_each(|&place| independent[place] = true);
        independent
    }

    /// For each column of Z the earlier columns that it follows from, with their weights.
    pub fn weights(&self) -> impl Iterator<Item = impl Iterator<Item = (usize, f64)>> {
        self.weights.iter().map(|weights| self.kept.iter().copied().zip(weights.iter().copied()))
    }

    /// As [`UpperTriangle::solve_normal`], on all columns: zero on those that follow from others.
    pub fn solve_normal(&self, b: &[f64]) -> Vec<f64> {
        self.spread(self.r.solve_normal(self.kept.iter().map(|&place| b[place]).collect()))
    }

    /// As [`UpperTriangle::lengths_of_inverse`]; zero on columns that follow from others.
    pub fn lengths_of_inverse(&self) -> Vec<f64> {
        self.spread(self.r.lengths_of_inverse())
    }

    /// Values of the columns of R as values of all columns.
    fn spread(&self, values: Vec<f64>) -> Vec<f64> {
        let mut all = vec![0.0; self.weights.len()];
        self.kept.iter().zip(values).for_each(|(&place, value)| all[place] = value);
        all
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// Rounding of a handful of operations on nearly orthogonal columns.
    const ROUNDING: f64 = 1e-13;

    fn of(columns: &[&[f64]], is_over: bool) -> Option<Triangle> {
        triangle_of(columns, |a, b| dot(columns[a], columns[b]), || is_over)
    }

    #[test]
    fn what_cancels_in_a_column_are_the_lengths_of_its_parts_whatever_their_signs() {
        let mut found = Triangle::default();
        let lengths = [2.0, 5.0, 7.0, 7.0];
        assert!(found.take(Vec::new(), &lengths, |_| Some(2.0)) && found.take(vec![3.0], &lengths, |_| Some(4.0)));
        // R w = (x, 8) with w_2 = 2; columns of length 2 and 5 next to ones of length 7.
        for (place, x, first) in [(2, 8.0, 1.0), (3, 4.0, -1.0)] {
            let all = Cell::new(0.0);
            found.take(vec![x, 8.0], &lengths, |terms| {
                all.set(terms);
                None
            });
            assert_eq!((&found.weights[place][..], all.get()), (&[first, 2.0][..], 7.0 + 2.0 + 2.0 * 5.0));
        }
    }

    #[test]
    fn a_column_that_follows_from_others_is_left_out_with_its_weights_in_any_unit() {
        for unit in [1e-40, 1.0, 1e40] {
            let column = |entries: [f64; 3]| entries.map(|entry| unit * entry);
            // The third is twice the first less three times the second.
            let columns = [[1.0, 0.0, 2.0], [0.0, 1.0, -1.0], [2.0, -3.0, 7.0], [1.0, 1.0, 0.0]].map(column);
            let columns: Vec<&[f64]> = columns.iter().map(|column| &column[..]).collect();
            let found = of(&columns, false).unwrap();
            assert_eq!(found.independent(), [true, true, false, true], "{unit:e}");
            let off = found.weights[2].iter().zip([2.0, -3.0]).map(|(weight, exact)| (weight - exact).abs());
            assert!(off.fold(0.0, f64::max) < ROUNDING, "{unit:e}: {:?}", found.weights);
            // R'R are the products of the columns that are kept.
            for (a, b) in [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)] {
                let product: f64 = (0..=a).map(|row| found.r.column(a)[row] * found.r.column(b)[row]).sum();
                let exact = dot(columns[found.kept[a]], columns[found.kept[b]]);
                assert!((product - exact).abs() < ROUNDING * unit * unit * 6.0, "{unit:e}, {a}, {b}");
            }
            assert!(of(&columns, true).is_none());
            // The products alone tell that the first two are independent.
            let product = |a: usize, b: usize| dot(columns[a], columns[b]);
            assert_eq!(of_products(3, product, &|| false).unwrap().kept, [0, 1], "{unit:e}");
        }
    }

    #[test]
    fn gaps_of_dependent_rows_contradict_each_other_if_rounding_of_distances_could_hide_it() {
        assert!(contradict(&[-1.0, 2.0, -1.1], 1e-3) && contradict(&[-1e20, 2e20, -1.1e20], 1e17));
        // Equal gaps, distances with half of their digits or more, and a row that follows from no other.
        assert!(!contradict(&[-1.0, 2.0, -1.0], 1e-3));
        assert!(!contradict(&[-1.0, 2.0, -1.1], 1e-8) && !contradict(&[1.0], 1.0));
    }

    #[test]
    fn copies_of_a_column_take_no_room_in_the_triangle() {
        let columns = vec![&[3.0, 4.0][..]; 20_000];
        let found = of(&columns, false).unwrap();
        assert_eq!((found.r.size(), found.weights().map(Iterator::count).max()), (1, Some(1)));
        assert_eq!(found.solve_normal(&[50.0; 20_000])[..2], [2.0, 0.0]);
    }
}
