//! The triangle R of `Z'Z = R'R` for the rows that are put at their gaps.

use crate::qp::linear::{UpperTriangle, dot, norm, take_out};

/// R, and how columns of Z that it leaves out follow from those before them.
#[derive(Default)]
pub(super) struct Triangle {
    pub r: UpperTriangle,
    /// The weight of each column before; none for a column that follows from no others.
    pub weights: Vec<Vec<f64>>,
}

/// Pivots below this share of the products that cancel in them are what rounding leaves of nearly dependent rows.
const PARALLEL: f64 = 1e-12;

/// What is left of a row across all others follows from them if it is below this share of the terms.
const DEPENDENT: f64 = 64.0 * f64::EPSILON;

/// Turns in which a row is made orthogonal to others: the second takes out what rounding of the first has left.
const TURNS: usize = 2;

/// R from the products of the columns of Z. If some are nearly parallel, such as rows that reach a part much softer than the
/// others, the products have lost what tells them apart, and the columns themselves are made orthogonal.
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
        let is_independent = pivot > PARALLEL * terms * terms;
        found.close(entries, pivot.max(0.0).sqrt(), (!is_independent).then_some(weights));
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
        let is_independent = left > DEPENDENT * terms;
        found.close(entries, left, (!is_independent).then_some(weights));
        across.iter_mut().for_each(|entry| *entry /= left);
        directions.push(across);
    }
    Some(found)
}

impl Triangle {
    /// The weights of the columns in the part of the next one along them, whose entries in R are these, and the lengths of all,
    /// added up as they cancel in what is left of it.
    fn combined(&self, entries: &[f64], lengths: &[f64]) -> (Vec<f64>, f64) {
        let weights = self.r.solve_upper(entries.to_vec());
        let along = weights.iter().zip(lengths);
        let terms = along.fold(lengths[entries.len()], |sum, (weight, length)| sum + weight.abs() * length);
        (weights, terms)
    }

    /// Appends a column of R with these entries above its diagonal entry, or one that follows from those before with some weights,
    /// of which nothing else is kept.
    fn close(&mut self, entries: Vec<f64>, diagonal: f64, follows: Option<Vec<f64>>) {
        match follows {
            None => self.r.push(entries, diagonal, true),
            Some(_) => self.r.push(vec![0.0; entries.len()], 0.0, false),
        }
        self.weights.push(follows.unwrap_or_default());
    }
}
