//! The triangle R of `Z'Z = R'R` for the rows that are put at their gaps.

use crate::qp::linear::{UpperTriangle, dot, norm, take_out};

/// R, and the weights with which columns of Z that it leaves out follow from those before them.
#[derive(Default)]
pub(super) struct Triangle {
    pub r: UpperTriangle,
    /// The weight of each earlier column; empty for a column that does not follow from others.
    pub weights: Vec<Vec<f64>>,
}

/// Pivots below this share of the products that cancel in them are rounding of nearly dependent rows.
const PARALLEL: f64 = 1e-12;

/// A row follows from others if its component orthogonal to them is below this share of the terms.
const DEPENDENT: f64 = 64.0 * f64::EPSILON;

/// Number of times that a row is made orthogonal to others: the second removes the rounding of the first.
const TURNS: usize = 2;

/// R from the products of the columns of Z. If some are nearly parallel, such as rows on a part much softer than the others,
/// the products have lost their difference, and the columns themselves are made orthogonal.
///
/// `None` if it `is_over` before R is found.
pub(super) fn triangle_of(columns: &[&[f64]], is_over: impl Fn() -> bool) -> Option<Triangle> {
    let found = of_products(columns, &is_over)?;
    if found.r.independent().contains(&false) { of_columns(columns, &is_over) } else { Some(found) }
}

fn of_products(columns: &[&[f64]], is_over: &impl Fn() -> bool) -> Option<Triangle> {
    let mut found = Triangle::default();
    let lengths: Vec<f64> = columns.iter().map(|column| norm(column)).collect();
    for (i, column) in columns.iter().enumerate() {
        if is_over() {
            return None;
        }
        let mut entries = vec![0.0; i];
        for j in (0..i).filter(|&j| found.r.independent()[j]) {
            let before = found.r.column(j);
            entries[j] = (dot(column, columns[j]) - dot(&before[..j], &entries[..j])) / before[j];
        }
        let pivot = dot(column, column) - dot(&entries, &entries);
        let (weights, terms) = found.combined(&entries, &lengths);
        if pivot > PARALLEL * terms * terms {
            found.push(entries, pivot.sqrt());
        } else {
            found.push_dependent(weights);
        }
    }
    Some(found)
}

fn of_columns(columns: &[&[f64]], is_over: &impl Fn() -> bool) -> Option<Triangle> {
    let mut found = Triangle::default();
    let mut directions: Vec<Vec<f64>> = Vec::new();
    let lengths: Vec<f64> = columns.iter().map(|column| norm(column)).collect();
    for (i, column) in columns.iter().enumerate() {
        if is_over() {
            return None;
        }
        let (mut entries, mut across) = (vec![0.0; i], column.to_vec());
        for _ in 0..TURNS {
            for (j, direction) in directions.iter().enumerate().filter(|entry| found.r.independent()[entry.0]) {
                entries[j] += take_out(&mut across, direction);
            }
        }
        let left = norm(&across);
        let (weights, terms) = found.combined(&entries, &lengths);
        if left > DEPENDENT * terms {
            found.push(entries, left);
        } else {
            found.push_dependent(weights);
        }
        across.iter_mut().for_each(|entry| *entry /= left);
        directions.push(across);
    }
    Some(found)
}

impl Triangle {
    /// The weights of the columns in the component of the next one along them, which has these entries in R, and the sum of the
    /// lengths of all terms, which cancel in the remainder.
    fn combined(&self, entries: &[f64], lengths: &[f64]) -> (Vec<f64>, f64) {
        let weights = self.r.solve_upper(entries.to_vec());
        let along = weights.iter().zip(lengths);
        let terms = along.fold(lengths[entries.len()], |sum, (weight, length)| sum + weight.abs() * length);
        (weights, terms)
    }

    /// Appends a column of R with these entries above its diagonal entry.
    fn push(&mut self, entries: Vec<f64>, diagonal: f64) {
        self.r.push(entries, diagonal);
        self.weights.push(Vec::new());
    }

    /// Appends a column that follows from earlier ones with these weights; nothing else of the column is kept.
    fn push_dependent(&mut self, weights: Vec<f64>) {
        self.r.push_dependent(vec![0.0; self.r.size()], 0.0);
        self.weights.push(weights);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of a handful of operations on nearly orthogonal columns.
    const ROUNDING: f64 = 1e-13;

    #[test]
    fn what_cancels_in_a_column_are_the_lengths_of_its_parts_whatever_their_signs() {
        let mut found = Triangle::default();
        found.push(Vec::new(), 2.0);
        found.push(vec![3.0], 4.0);
        // R w = (x, 8) with w_2 = 2; columns of length 2 and 5 next to one of length 7.
        for (x, first) in [(8.0, 1.0), (4.0, -1.0)] {
            let (weights, terms) = found.combined(&[x, 8.0], &[2.0, 5.0, 7.0]);
            assert_eq!((&weights[..], terms), (&[first, 2.0][..], 7.0 + 2.0 + 2.0 * 5.0));
        }
    }

    #[test]
    fn a_column_that_follows_from_others_is_left_out_with_its_weights_in_any_unit() {
        for unit in [1e-40, 1.0, 1e40] {
            let column = |entries: [f64; 3]| entries.map(|entry| unit * entry);
            // The third is twice the first less three times the second.
            let columns = [[1.0, 0.0, 2.0], [0.0, 1.0, -1.0], [2.0, -3.0, 7.0], [1.0, 1.0, 0.0]].map(column);
            let columns: Vec<&[f64]> = columns.iter().map(|column| &column[..]).collect();
            let Triangle { r, weights } = triangle_of(&columns, || false).unwrap();
            assert_eq!(r.independent(), [true, true, false, true], "{unit:e}");
            let off = weights[2].iter().zip([2.0, -3.0]).map(|(weight, exact)| (weight - exact).abs());
            assert!(off.fold(0.0, f64::max) < ROUNDING, "{unit:e}: {weights:?}");
            // R'R are the products of the columns that are kept.
            for (a, b) in [(0, 0), (0, 1), (1, 1), (0, 3), (1, 3), (3, 3)] {
                let product: f64 = (0..=a).map(|row| r.column(a)[row] * r.column(b)[row]).sum();
                let exact = dot(columns[a], columns[b]);
                assert!((product - exact).abs() < ROUNDING * unit * unit * 6.0, "{unit:e}, {a}, {b}");
            }
            assert!(triangle_of(&columns, || true).is_none());
        }
    }
}
