//! Cones in the few coordinates of the motions without energy.
//!
//! A point of a cone is found in doubles and decided in twice the working precision: rows that stop it are made to slide along
//! it exactly, one after the other, so that rows which are parallel but for their last bits leave no more than they do as they
//! stand.

use crate::error::Error;
use crate::qp::attempts;
use crate::qp::linear::{SparseMatrix, SymmetricMatrix, Twice, exponent, largest, ldexp};
use crate::qp::problem::ContactProblem;
use crate::qp::settings::{Method, Settings};

/// A point of a cone that is nearer to its tip than this share of c is the tip.
const TIP: f64 = 1e-8;

/// Coordinates below this share of the largest are what a solve in doubles leaves of zero.
const ROUNDING: f64 = 1e-10;

/// Turns in which a vector is made orthogonal to others: the second takes out what rounding of the first has left.
const TURNS: usize = 2;

/// A linear function of the coordinates.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub values: Vec<Twice>,
    /// The sum of the magnitudes of all terms of the values: what rounding is measured by.
    pub terms: f64,
}

impl Row {
    pub fn negative(&self) -> Self {
        Row { values: self.values.iter().map(|&value| -value).collect(), terms: self.terms }
    }

    fn is_zero(&self) -> bool {
        self.values.iter().all(|&value| value == Twice::ZERO)
    }
}

/// The cone `{a: rows a <= 0, fixed a = 0}`.
pub(super) struct Cone<'a> {
    pub rows: Vec<&'a Row>,
    pub fixed: Option<&'a Row>,
    /// What rounding may leave of a sum, as a share of its terms; `None` where the rows themselves are rounded, and doubles decide.
    pub rounding: Option<f64>,
}

impl Cone<'_> {
    /// The point that is nearest to c, about; `None` where that is the tip.
    pub fn nearest(&self, c: &[f64]) -> Option<Vec<Twice>> {
        let found: Vec<Twice> = self.nearest_in_doubles(c)?.into_iter().map(Twice::from).collect();
        let Some(rounding) = self.rounding else { return Some(found) };
        let mut face = Face::default();
        if let Some(fixed) = self.fixed {
            face.hold(fixed, rounding);
        }
        let least = TIP * size(&found);
        loop {
            let point = face.along(&found);
            let size = size(&point);
            if size <= least {
                return None;
            }
            let closing = |row: &&Row| product(&row.values, &point).rounded() / row.terms;
            let worst = self.rows.iter().copied().filter(|row| !row.is_zero());
            let worst = worst.max_by(|a, b| closing(a).total_cmp(&closing(b)));
            match worst.filter(|row| closing(row) > rounding * size) {
                // A row that follows from those which are held, and still stops the point, shows that their digits are lost.
                Some(row) if !face.hold(row, rounding) => return None,
                Some(_) => {}
                None => return Some(point),
            }
        }
    }

    /// The same as the answer to a contact problem with K = I, in doubles. What is fixed may grow, unless doubles decide.
    fn nearest_in_doubles(&self, c: &[f64]) -> Option<Vec<f64>> {
        let (size, dofs) = (largest(c), c.len());
        if dofs == 0 || !(size > 0.0 && size.is_finite()) {
            return None;
        }
        let diagonal: Vec<(usize, usize, f64)> = (0..dofs).map(|dof| (dof, dof, 1.0)).collect();
        let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(dofs, dofs, &diagonal).ok()?).ok()?;
        let grows = self.fixed.map(Row::negative);
        let falls = self.fixed.filter(|_| self.rounding.is_none());
        let rows: Vec<Vec<f64>> = (self.rows.iter().copied().chain(&grows).chain(falls))
            .filter(|row| !row.is_zero())
            .map(|row| row.values.iter().map(|value| value.rounded()).collect())
            .collect();
        let entries: Vec<(usize, usize, f64)> = (rows.iter().enumerate())
            .flat_map(|(number, row)| {
                let unit = exponent(largest(row));
                row.iter().enumerate().filter(|e| *e.1 != 0.0).map(move |(dof, &b)| (number, dof, ldexp(b, -unit)))
            })
            .collect();
        let contact = SparseMatrix::from_triplets(rows.len(), dofs, &entries).ok()?;
        let load = c.iter().map(|value| value / size).collect();
        let problem = ContactProblem::new(stiffness, load, contact, vec![0.0; rows.len()]).ok()?;
        let nearest = match attempts::solved(&problem, &Settings::with_method(Method::Auto)) {
            Ok(solution) => solution.displacement,
            Err(Error::NotCertified { solution, .. }) => solution.displacement,
            Err(_) => return None,
        };
        let distance = largest(&nearest);
        let kept = |value: &f64| if value.abs() > ROUNDING * distance { *value } else { 0.0 };
        (distance > TIP).then(|| nearest.iter().map(kept).collect())
    }
}

/// The coordinates at which some rows are zero: all that is at right angles to their orthogonal directions.
#[derive(Default)]
pub(super) struct Face {
    directions: Vec<Vec<Twice>>,
}

impl Face {
    /// The part of a vector in the face.
    fn along(&self, vector: &[Twice]) -> Vec<Twice> {
        let mut rest = vector.to_vec();
        for direction in (0..TURNS).flat_map(|_| &self.directions) {
            let share = product(direction, &rest) / product(direction, direction);
            rest.iter_mut().zip(direction).for_each(|(value, &d)| *value = *value - share * d);
        }
        rest
    }

    /// Takes a row in, and returns `true`, unless it follows from the others.
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
