//! The triangle R of `Z'Z = R'R` for the rows that are put at their gaps.

use crate::qp::linear::{UpperTriangle, dot, norm, take_out};

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
pub(super) fn triangle_of(columns: &[&[f64]], is_over: impl Fn() -> bool) -> Option<UpperTriangle> {
    let found = of_products(columns, &is_over)?;
    if found.independent().contains(&false) { of_columns(columns, &is_over) } else { Some(found) }
}

fn of_products(columns: &[&[f64]], is_over: &impl Fn() -> bool) -> Option<UpperTriangle> {
    let mut found = UpperTriangle::default();
    let lengths: Vec<f64> = columns.iter().map(|column| norm(column)).collect();
    for (i, column) in columns.iter().enumerate() {
        if is_over() {
            return None;
        }
        let mut entries = vec![0.0; i];
        for j in (0..i).filter(|&j| found.independent()[j]) {
            let before = found.column(j);
            entries[j] = (dot(column, columns[j]) - dot(&before[..j], &entries[..j])) / before[j];
        }
        let pivot = dot(column, column) - dot(&entries, &entries);
        let terms = terms(&found, &entries, &lengths);
        close(&mut found, entries, pivot.max(0.0).sqrt(), pivot > PARALLEL * terms * terms);
    }
    Some(found)
}

fn of_columns(columns: &[&[f64]], is_over: &impl Fn() -> bool) -> Option<UpperTriangle> {
    let mut found = UpperTriangle::default();
    let mut directions: Vec<Vec<f64>> = Vec::new();
    let lengths: Vec<f64> = columns.iter().map(|column| norm(column)).collect();
    for (i, column) in columns.iter().enumerate() {
        if is_over() {
            return None;
        }
        let (mut entries, mut across) = (vec![0.0; i], column.to_vec());
        for _ in 0..TURNS {
            for (j, direction) in directions.iter().enumerate().filter(|entry| found.independent()[entry.0]) {
                entries[j] += take_out(&mut across, direction);
            }
        }
        let left = norm(&across);
        let terms = terms(&found, &entries, &lengths);
        close(&mut found, entries, left, left > DEPENDENT * terms);
        across.iter_mut().for_each(|entry| *entry /= left);
        directions.push(across);
    }
    Some(found)
}

/// The lengths of the columns, added up as they cancel in the part of the next one across them, whose entries in R are these.
fn terms(found: &UpperTriangle, entries: &[f64], lengths: &[f64]) -> f64 {
    let weights = found.solve_upper(entries.to_vec());
    weights.iter().zip(lengths).fold(lengths[entries.len()], |sum, (weight, length)| sum + weight.abs() * length)
}

/// Appends a column of R with these entries above its diagonal entry; nothing of a dependent one is kept.
fn close(found: &mut UpperTriangle, entries: Vec<f64>, diagonal: f64, is_independent: bool) {
    match is_independent {
        true => found.push(entries, diagonal, true),
        false => found.push(vec![0.0; entries.len()], 0.0, false),
    }
}
