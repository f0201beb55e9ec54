//! Cones in the few coordinates of the modes without energy.
//!
//! A point of a cone is found in doubles and decided in twice the working precision: the point is made to slide exactly
//! along the rows that stop it, one after the other. So rows that are parallel except for their last bits leave exactly
//! the directions that these doubles leave.

use crate::linear::{SparseMatrix, SymmetricMatrix, Twice, exponent, largest, ldexp};
use crate::method::dual_active_set::dual_active_set;
use crate::problem::ContactProblem;

/// If a point of a cone is nearer to its tip than this share of c, it is the tip.
const TIP: f64 = 1e-8;

/// A row is touched if a point is nearer to it than this share of its terms, which is the precision of rounded rows.
const TOUCHED: f64 = 1e-8;

/// Coordinates below this share of the largest are zeros with the error of a solve in doubles.
const SOLVE_ROUNDING: f64 = 1e-10;

/// Number of times that a vector is made orthogonal to others: the second removes the rounding of the first.
const TURNS: usize = 2;

/// A linear function of the coordinates.
#[derive(Clone, Debug)]
pub struct Row {
    pub values: Vec<Twice>,
    /// The sum of the magnitudes of all terms of the values, the scale of rounding.
    pub terms: f64,
}

impl Row {
    fn is_zero(&self) -> bool {
        self.values.iter().all(|&value| value == Twice::ZERO)
    }
}

/// The cone `{a: rows a <= 0, fixed a = 0}`.
pub struct Cone<'a> {
    pub rows: Vec<&'a Row>,
    pub fixed: Option<&'a Row>,
    /// Rounding of a sum, as a share of its terms.
    pub rounding: f64,
    /// `false` if the rows themselves are rounded: then the point slides along all rows that it is close to in doubles.
    pub is_exact: bool,
}

impl Cone<'_> {
    /// The point nearest to c, approximately; `None` if that is the tip.
    pub fn nearest(&self, c: &[f64]) -> Option<Vec<Twice>> {
        let twice = |values: &[f64]| -> Vec<Twice> { values.iter().map(|&value| value.into()).collect() };
        let mut start = twice(&self.nearest_in_doubles(c)?);
        let rows = || self.rows.iter().copied().filter(|row| !row.is_zero());
        let closing = |row: &Row, point: &[Twice]| product(&row.values, point).rounded() / row.terms;
        let mut face = ConeFace::default();
        if let Some(fixed) = self.fixed {
            face.hold(fixed, self.rounding);
        }
        if !self.is_exact {
            for row in rows().filter(|row| closing(row, &start) > -TOUCHED * size(&start)) {
                face.hold(row, self.rounding);
            }
            // The nearest point lies on the rows that it touches; doubles gave it with fewer digits.
            start = twice(c);
        }
        let least = TIP * size(&start);
        loop {
            let point = face.along(&start);
            let size = size(&point);
            if size <= least {
                return None;
            }
            let worst = rows().max_by(|a, b| closing(a, &point).total_cmp(&closing(b, &point)));
            match worst.filter(|row| closing(row, &point) > self.rounding * size) {
                // If a row follows from the held rows and still stops the point, their digits are lost.
                Some(row) if !face.hold(row, self.rounding) => return None,
                Some(_) => {}
                None => return Some(point),
            }
        }
    }

    /// The same by a contact problem with K = I. The fixed row may be negative: two opposed rows would leave nothing.
    fn nearest_in_doubles(&self, c: &[f64]) -> Option<Vec<f64>> {
        let (size, dofs) = (largest(c), c.len());
        if dofs == 0 || !(size > 0.0 && size.is_finite()) {
            return None;
        }
        let stiffness = SymmetricMatrix::of_diagonal(vec![1.0; dofs]);
        let (mut entries, mut room) = (Vec::new(), Vec::new());
        for row in self.rows.iter().copied().chain(self.fixed).filter(|row| !row.is_zero()) {
            let values: Vec<f64> = row.values.iter().map(|value| value.rounded()).collect();
            let unit = exponent(largest(&values));
            let scaled = values.iter().enumerate().filter(|entry| *entry.1 != 0.0);
            entries.extend(scaled.map(|(dof, &b)| (room.len(), dof, ldexp(b, -unit))));
            // Rows along which a direction slides close by their rounding: without room for it they leave nothing.
            room.push(ldexp(self.rounding.max(f64::EPSILON) * row.terms, -unit));
        }
        let contact = SparseMatrix::from_triplets(room.len(), dofs, &entries).ok()?;
        let load = c.iter().map(|value| value / size).collect();
        let problem = ContactProblem::computed(stiffness, load, contact, room).ok()?;
        let nearest = dual_active_set(&problem, true).ok()?.displacement;
        let distance = largest(&nearest);
        let kept = |value: &f64| if value.abs() > SOLVE_ROUNDING * distance { *value } else { 0.0 };
        (distance > TIP).then(|| nearest.iter().map(kept).collect())
    }
}

/// The coordinates at which some rows are zero: the orthogonal complement of their orthogonal directions.
#[derive(Default)]
pub struct ConeFace {
    directions: Vec<Vec<Twice>>,
}

impl ConeFace {
    fn along(&self, vector: &[Twice]) -> Vec<Twice> {
        let mut rest = vector.to_vec();
        for direction in (0..TURNS).flat_map(|_| &self.directions) {
            let share = product(direction, &rest) / product(direction, direction);
            rest.iter_mut().zip(direction).for_each(|(value, &d)| *value = *value - share * d);
        }
        rest
    }

    /// Adds a row and returns `true`, unless it follows from the others.
    pub fn hold(&mut self, row: &Row, rounding: f64) -> bool {
        let direction = self.along(&row.values);
        let is_new = size(&direction) > rounding * row.terms;
        if is_new {
            self.directions.push(direction);
        }
        is_new
    }

    /// Returns `true` if a row follows from those that are held.
    pub fn contains(&self, row: &Row, rounding: f64) -> bool {
        size(&self.along(&row.values)) <= rounding * row.terms
    }
}

fn product(a: &[Twice], b: &[Twice]) -> Twice {
    a.iter().zip(b).fold(Twice::ZERO, |sum, (&a, &b)| sum + a * b)
}

fn size(vector: &[Twice]) -> f64 {
    vector.iter().fold(0.0, |size: f64, value| size.max(value.rounded().abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row<const N: usize>(values: [f64; N]) -> Row {
        Row { values: values.map(Twice::from).to_vec(), terms: values.iter().map(|value| value.abs()).sum() }
    }

    #[test]
    fn rows_that_differ_by_a_billionth_leave_a_point_between_them_if_they_are_exact() {
        // x <= 0 and x + 1e-9 y <= 0: nearest to (1, -1) is (0, -1), which the second row lets move by 1e-9.
        let rows = [row([1.0, 0.0]), row([1.0, 1e-9])];
        let cone = Cone { rows: rows.iter().collect(), fixed: None, rounding: 1e-28, is_exact: true };
        let nearest: Vec<f64> = cone.nearest(&[1.0, -1.0]).unwrap().into_iter().map(Twice::rounded).collect();
        // The distance of the point has the precision of a solve in doubles; its place on the first row is exact.
        assert!(nearest[0] == 0.0 && (nearest[1] + 1.0).abs() < TIP, "{nearest:?}");
        // If the rows themselves are rounded, both are touched, and they hold the point.
        assert!(Cone { is_exact: false, ..cone }.nearest(&[1.0, -1.0]).is_none());
    }

    #[test]
    fn rows_in_any_unit_stop_the_point_in_doubles() {
        for unit in [1e-30, 1.0, 1e30] {
            let rows = [row([unit, 0.0])];
            let cone = Cone { rows: rows.iter().collect(), fixed: None, rounding: 1e-28, is_exact: true };
            let nearest = cone.nearest_in_doubles(&[1.0, -1.0]).unwrap();
            assert!(nearest[0].abs() < TIP && (nearest[1] + 1.0).abs() < TIP, "{unit:e}: {nearest:?}");
        }
    }

    #[test]
    fn rounded_walls_on_both_sides_leave_the_way_between_them() {
        // x + h y = 0 at three heights h, from both sides; z is off by its rounding.
        let heights = [(0.0, 1e-12), (0.5, -2e-12), (1.0, 3e-12)];
        let rows: Vec<Row> =
            heights.iter().flat_map(|&(h, off)| [row([1.0, h, off]), row([-1.0, -h, 2.0 * off])]).collect();
        let cone = Cone { rows: rows.iter().collect(), fixed: None, rounding: 1e-10, is_exact: false };
        let nearest: Vec<f64> = cone.nearest(&[0.3, 0.2, 1.0]).unwrap().into_iter().map(Twice::rounded).collect();
        assert!(nearest[0].abs().max(nearest[1].abs()) < 1e-10 && (nearest[2] - 1.0).abs() < 1e-10, "{nearest:?}");
    }
}
