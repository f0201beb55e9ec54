//! The triangle R of `Z'Z = R'R` for the rows that are put at their gaps.

use crate::linear::{UpperTriangle, dot, norm, take_out};

/// R of the columns of Z that do not follow from others, and the weights with which the other columns follow from them.
#[derive(Default)]
pub(super) struct Triangle {
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
pub fn triangle_of(
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
    /// it follows from the columns of R, from the lengths of all terms, which cancel in the remainder. Returns `true`
    /// if R has it.
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
        }
    }

    #[test]
    fn copies_of_a_column_take_no_room_in_the_triangle() {
        let columns = vec![&[3.0, 4.0][..]; 20_000];
        let found = of(&columns, false).unwrap();
        assert_eq!((found.r.size(), found.weights().map(Iterator::count).max()), (1, Some(1)));
        assert_eq!(found.solve_normal(&[50.0; 20_000])[..2], [2.0, 0.0]);
    }
}
