//! Linear complementarity problems with bounds and any matrix, in exact arithmetic: Lemke's method of `lemke`, with the
//! bounds as unknowns and rows of their own.

use num_bigint::BigInt;
use signorini::SparseMatrix;
use signorini::lcp::{Error, Lcp};

use super::dyadic::{Dyadic, dot, sign};
use super::lemke::{Variable, lemke};
use super::problem::Exact;
use super::solve::Outcome;
use super::tableau::Tableau;

/// M (n x n, row by row), q, l and u (n); infinite bounds are infinities.
#[derive(Clone, Debug)]
pub struct LcpCase {
    pub matrix: Vec<Vec<f64>>,
    pub offset: Vec<f64>,
    pub lower: Vec<f64>,
    pub upper: Vec<f64>,
}

/// A solution z and its w, each divided by `denominator > 0`.
#[derive(Clone, Debug)]
pub struct ExactPoint {
    pub z: Vec<Dyadic>,
    pub w: Vec<Dyadic>,
    pub denominator: Dyadic,
}

/// A column of the problem in nonnegative unknowns.
enum Column {
    /// The unknown `of` grows from its base with this sign.
    Part { of: usize, sign: i64 },
    /// The distance of the unknown `of` from its upper bound; its complement is the negative part of w.
    Slack { of: usize },
}

impl LcpCase {
    pub fn unknowns(&self) -> usize {
        self.offset.len()
    }

    /// # Errors
    /// Those of [`Lcp::new`].
    pub fn problem(&self) -> Result<Lcp, Error> {
        let n = self.unknowns();
        let rows = self.matrix.iter().enumerate();
        let entries: Vec<_> = rows.flat_map(|(i, row)| row.iter().enumerate().map(move |(j, &m)| (i, j, m))).collect();
        let entries: Vec<_> = entries.into_iter().filter(|entry| entry.2 != 0.0).collect();
        let matrix = SparseMatrix::from_triplets(n, n, &entries)?;
        Lcp::new(matrix, self.offset.clone(), self.lower.clone(), self.upper.clone())
    }

    /// The same with infinities for all bounds of 1e20 or more.
    pub fn bounded(&self) -> Self {
        let infinite = |&bound: &f64| if bound.abs() >= 1e20 { f64::INFINITY.copysign(bound) } else { bound };
        let bounds = |bounds: &[f64]| bounds.iter().map(infinite).collect();
        LcpCase { lower: bounds(&self.lower), upper: bounds(&self.upper), ..self.clone() }
    }

    fn base(&self, of: usize) -> Dyadic {
        let bound = [self.lower[of], self.upper[of]].into_iter().find(|bound| bound.is_finite());
        Dyadic::from(bound.unwrap_or(0.0))
    }

    /// w = M z + q of a point z over a denominator, times this denominator.
    pub fn image(&self, z: &[Dyadic], denominator: &Dyadic) -> Vec<Dyadic> {
        let exact = |row: &[f64]| row.iter().map(|&value| Dyadic::from(value)).collect::<Vec<_>>();
        let rows = self.matrix.iter().zip(&self.offset);
        rows.map(|(row, &q)| &dot(&exact(row), z) + &(&Dyadic::from(q) * denominator)).collect()
    }

    /// A verified solution; `None` if Lemke's method ends in a ray.
    pub fn solution(&self) -> Option<ExactPoint> {
        let columns = self.columns();
        let (mut tableau, unit) = self.tableau(&columns);
        if lemke(&mut tableau).is_some() {
            return None;
        }
        let denominator = Dyadic::new(tableau.denominator.clone(), 0);
        let mut z: Vec<Dyadic> = (0..self.unknowns()).map(|of| &self.base(of) * &denominator).collect();
        for (row, basic) in tableau.rows.iter().zip(&tableau.basic) {
            let Variable::Force(k) = basic else { continue };
            if let Column::Part { of, sign } = columns[*k] {
                z[of] = &z[of] + &(&Dyadic::integer(sign) * &Dyadic::new(row[0].clone(), unit));
            }
        }
        let w = self.image(&z, &denominator);
        let point = ExactPoint { z, w, denominator };
        self.check(&point);
        Some(point)
    }

    fn columns(&self) -> Vec<Column> {
        let of_unknown = |of: usize| match (self.lower[of].is_finite(), self.upper[of].is_finite()) {
            (true, true) => vec![Column::Part { of, sign: 1 }, Column::Slack { of }],
            (true, false) => vec![Column::Part { of, sign: 1 }],
            (false, true) => vec![Column::Part { of, sign: -1 }],
            (false, false) => vec![Column::Part { of, sign: 1 }, Column::Part { of, sign: -1 }],
        };
        (0..self.unknowns()).flat_map(of_unknown).collect()
    }

    /// The problem in integers, and the exponent of the unit of z.
    fn tableau(&self, columns: &[Column]) -> (Tableau<Variable>, i64) {
        let bases: Vec<Dyadic> = (0..self.unknowns()).map(|of| self.base(of)).collect();
        let constants: Vec<Dyadic> = {
            let w = self.image(&bases, &Dyadic::integer(1));
            let constant = |column: &Column| match column {
                Column::Part { of, sign } => &Dyadic::integer(*sign) * &w[*of],
                Column::Slack { of } => &Dyadic::from(self.upper[*of]) - &Dyadic::from(self.lower[*of]),
            };
            columns.iter().map(constant).collect()
        };
        let entries = self.matrix.iter().flatten().map(|&value| Dyadic::from(value)).collect::<Vec<_>>();
        let lowest =
            |values: &mut dyn Iterator<Item = &Dyadic>| values.filter(|v| !v.is_zero()).map(Dyadic::exponent).min();
        let of_matrix = lowest(&mut entries.iter()).unwrap_or(0);
        let is_slack = |k: &usize| matches!(columns[*k], Column::Slack { .. });
        let (slacks, parts): (Vec<usize>, Vec<usize>) = (0..columns.len()).partition(is_slack);
        let of_w = lowest(&mut parts.iter().map(|&k| &constants[k]));
        let of_z = lowest(&mut slacks.iter().map(|&k| &constants[k]));
        let of_z = [of_w.map(|w| w - of_matrix), of_z].into_iter().flatten().min().unwrap_or(0);
        let row = |(k, column): (usize, &Column)| -> Vec<BigInt> {
            let entry = |(l, other): (usize, &Column)| match (column, other) {
                (Column::Part { of: i, sign: a }, Column::Part { of: j, sign: b }) => {
                    BigInt::from(a * b) * Dyadic::from(self.matrix[*i][*j]).over(of_matrix)
                }
                (Column::Slack { .. }, Column::Part { .. }) if l + 1 == k => BigInt::from(-1),
                (Column::Part { .. }, Column::Slack { .. }) if k + 1 == l => BigInt::from(1),
                _ => BigInt::ZERO,
            };
            let unit = if is_slack(&k) { of_z } else { of_z + of_matrix };
            std::iter::once(constants[k].over(unit)).chain(columns.iter().enumerate().map(entry)).collect()
        };
        let rows = columns.iter().enumerate().map(row).collect();
        let (basic, others) =
            ((0..columns.len()).map(Variable::Distance).collect(), (0..columns.len()).map(Variable::Force).collect());
        (Tableau::new(rows, basic, others), of_z)
    }

    /// Asserts every condition of a solution.
    fn check(&self, point: &ExactPoint) {
        assert!(point.denominator.sign() > 0);
        for i in 0..self.unknowns() {
            let at = |bound: f64| bound.is_finite() && point.z[i] == &Dyadic::from(bound) * &point.denominator;
            let beyond = |bound: f64| bound.is_finite() && point.z[i] > &Dyadic::from(bound) * &point.denominator;
            let (lower, upper, w) = (self.lower[i], self.upper[i], point.w[i].sign());
            let is_inside = (at(lower) || beyond(lower) || lower.is_infinite()) && !beyond(upper);
            let is_balanced = w == 0 || (w > 0 && at(lower)) || (w < 0 && at(upper));
            assert!(is_inside && is_balanced, "unknown {i} of the exact point misses its conditions");
        }
    }

    /// Returns `true` if a point between the bounds has w of the required signs.
    pub fn is_feasible(&self) -> bool {
        let n = self.unknowns();
        let (mut contact, mut gap) = (Vec::new(), Vec::new());
        let mut push = |row: Vec<Dyadic>, bound: Dyadic| {
            contact.push(row);
            gap.push(bound);
        };
        for i in 0..n {
            for (bound, other, side) in [(self.lower[i], self.upper[i], -1), (self.upper[i], self.lower[i], 1)] {
                let side = Dyadic::integer(side);
                if bound.is_finite() {
                    let unit = (0..n).map(|j| if i == j { side.clone() } else { Dyadic::ZERO }).collect();
                    push(unit, &side * &Dyadic::from(bound));
                }
                // Without the other bound, w may not have the sign that only that one allows.
                if other.is_infinite() {
                    let row = self.matrix[i].iter().map(|&m| &side * &Dyadic::from(m)).collect();
                    push(row, -&(&side * &Dyadic::from(self.offset[i])));
                }
            }
        }
        let unit = |i: usize| (0..n).map(|j| Dyadic::integer(i64::from(i == j))).collect();
        let (stiffness, rows) = ((0..n).map(unit).collect(), (0..gap.len()).collect());
        let exact = Exact { stiffness, load: vec![Dyadic::ZERO; n], contact, gap, rows };
        matches!(exact.outcome(), Outcome::Solved(_))
    }

    /// Returns `true` if all principal minors of M are positive, by Schur complements times their pivots.
    pub fn is_p(&self) -> bool {
        let exact = self.matrix.iter().flatten().map(|&value| Dyadic::from(value));
        let low = exact.filter(|value| !value.is_zero()).map(|value| value.exponent()).min().unwrap_or(0);
        let whole = |row: &Vec<f64>| row.iter().map(|&value| Dyadic::from(value).over(low)).collect();
        has_positive_minors(self.matrix.iter().map(whole).collect())
    }
}

impl LcpCase {
    pub fn is_symmetric(&self) -> bool {
        (0..self.unknowns()).all(|i| (0..i).all(|j| self.matrix[i][j] == self.matrix[j][i]))
    }

    /// Returns `true` if a symmetric M is positive semidefinite, by Schur complements times their pivots.
    pub fn is_semidefinite(&self) -> bool {
        let exact = |row: &Vec<f64>| row.iter().map(|&value| Dyadic::from(value)).collect();
        let mut rows: Vec<Vec<Dyadic>> = self.matrix.iter().map(exact).collect();
        while let Some(last) = rows.pop() {
            let pivot = &last[rows.len()];
            if pivot.sign() < 0 || (pivot.is_zero() && last.iter().any(|entry| !entry.is_zero())) {
                return false;
            }
            let count = rows.len();
            if !pivot.is_zero() {
                for row in &mut rows {
                    let factor = row[count].clone();
                    (0..count).for_each(|j| row[j] = &(&row[j] * pivot) - &(&factor * &last[j]));
                }
            }
            rows.iter_mut().for_each(|row| row.truncate(count));
        }
        true
    }
}

fn has_positive_minors(mut rows: Vec<Vec<BigInt>>) -> bool {
    let Some(last) = rows.pop() else { return true };
    let place = rows.len();
    if sign(&last[place]) <= 0 {
        return false;
    }
    let entry = |row: &Vec<BigInt>, j: usize| &row[j] * &last[place] - &row[place] * &last[j];
    let complement = rows.iter().map(|row| (0..place).map(|j| entry(row, j)).collect()).collect();
    rows.iter_mut().for_each(|row| drop(row.pop()));
    has_positive_minors(rows) && has_positive_minors(complement)
}
