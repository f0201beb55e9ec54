//! Sparse linear equations, solved one after the other for one of their unknowns; those that follow from others are
//! found. All sums have twice the working precision.
//!
//! # Source
//! The choice of pivots: Duff, Erisman, Reid, *Direct Methods for Sparse Matrices*, Oxford (1986), ch. 7.

use std::collections::HashMap;

use super::twice::Sum;
use super::{SparseMatrix, SymmetricMatrix, Twice};
use crate::error::Error;

/// A pivot has at least this share of the largest entry of its row.
pub const PIVOT: f64 = 0.1;

/// A row follows from others, except for the rounding of its entries, if less than this share of them is left.
pub const FOLLOWS: f64 = 4.0 * f64::EPSILON;

/// Sparse numbers with their places, which increase.
pub type Sparse = Vec<(usize, Twice)>;

/// Takes the number at a place out, if there is one.
fn taken_out(values: &mut Sparse, place: usize) -> Option<Twice> {
    let found = values.binary_search_by_key(&place, |entry| entry.0);
    found.ok().map(|found| values.remove(found).1)
}

/// Sums by their places, in memory that serves one vector after another.
#[derive(Default)]
pub struct Sums {
    of_places: Vec<Option<Sum>>,
    /// The places with a sum, in the order of their first terms.
    places: Vec<usize>,
    terms: usize,
}

impl Sums {
    /// The sum at a place, which begins with none.
    pub fn at(&mut self, place: usize) -> &mut Sum {
        self.terms += 1;
        if place >= self.of_places.len() {
            self.of_places.resize(place + 1, None);
        }
        if self.of_places[place].is_none() {
            self.places.push(place);
        }
        self.of_places[place].get_or_insert_default()
    }

    /// All sums, in the order of their places; none is left.
    pub fn taken(&mut self) -> impl Iterator<Item = (usize, Sum)> + '_ {
        self.places.sort_unstable();
        let of_places = &mut self.of_places;
        self.places.drain(..).map(|place| (place, of_places[place].take().unwrap_or_default()))
    }
}

/// A dof that an equality gives: `u_dof = constant + sum of others`.
#[derive(Clone, Debug)]
pub struct Pivot {
    /// The unknown that it gives.
    pub dof: usize,
    /// Its value if all others are zero.
    pub constant: Twice,
    /// Dofs that stay, with their coefficients.
    pub others: Sparse,
    /// The weights of the equalities whose sum is the row of this pivot, by their numbers.
    pub weights: Sparse,
}

/// The largest magnitude of the coefficients.
pub fn largest(values: &[(usize, Twice)]) -> f64 {
    values.iter().map(|entry| entry.1.rounded().abs()).fold(0.0, f64::max)
}

impl Pivot {
    /// The dof with the least rank among those whose coefficients have at least this share of the largest.
    pub fn best<R: Ord>(&self, share: f64, rank: impl Fn(usize) -> R) -> Option<usize> {
        let largest = largest(&self.others);
        let may_be = |entry: &&(usize, Twice)| entry.1.rounded().abs() >= share * largest;
        self.others.iter().filter(may_be).map(|entry| entry.0).min_by_key(|&dof| rank(dof))
    }
}

/// An equation that follows from others: the sum of all these equations, with their weights, is zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Following {
    /// The equation.
    pub row: usize,
    /// Rows with weights, its own among them with weight one.
    pub weights: Vec<(usize, f64)>,
    /// `true` if nothing but zeros is left, `false` if rounding of the entries is.
    pub is_exact: bool,
}

impl SparseMatrix {
    /// The equations of `A u = values` that follow from the others within `accuracy`, relative to their entries and
    /// values, as far as they are found by this number of terms. `values` has an entry for each row, in any unit. A row
    /// that contradicts the others does not follow.
    pub fn following_rows(&self, values: &[f64], accuracy: f64, most_terms: usize) -> Vec<Following> {
        let by_row = self.transposed();
        let of_row = |row: usize| by_row.column(row).filter(|entry| entry.1 != 0.0);
        let mut order: Vec<usize> = (0..self.rows()).collect();
        order.sort_by_key(|&row| of_row(row).count());
        let (mut found, mut following) = (Pivots::default(), Vec::new());
        for row in order {
            if found.sums.terms > most_terms {
                break;
            }
            match found.reduced(of_row(row), values.get(row).copied().unwrap_or(0.0).into(), (row, accuracy)) {
                Remainder::Row(pivot) => {
                    if let Some(dof) = pivot.best(PIVOT, |dof| self.column(dof).count()) {
                        found.solve_for(dof, pivot);
                    }
                }
                Remainder::Follows { weights, is_exact } => {
                    let weights = weights.into_iter().map(|(row, weight)| (row, weight.rounded())).collect();
                    following.push(Following { row, weights, is_exact });
                }
                Remainder::Contradicts(_) | Remainder::Unclear => {}
            }
        }
        following
    }

    /// The rows of these equations that do not follow from the others, in increasing order.
    pub fn independent_rows(&self, values: &[f64], accuracy: f64) -> Vec<usize> {
        let mut stays = vec![true; self.rows()];
        self.following_rows(values, accuracy, usize::MAX).iter().for_each(|following| stays[following.row] = false);
        (0..self.rows()).filter(|&row| stays[row]).collect()
    }
}

/// What is left of an equality after the pivots so far.
pub enum Remainder {
    /// `sum of others + constant = 0`, not yet solved for a dof.
    Row(Pivot),
    /// Nothing is left, exactly or except for rounding: with these weights the sum of the equalities is zero.
    Follows {
        /// The weights.
        weights: Sparse,
        /// `true` if exactly nothing is left.
        is_exact: bool,
    },
    /// Nothing is left but a number: with these weights the equalities contradict each other.
    Contradicts(Sparse),
    /// No more is left than rounding of the entries may leave.
    Unclear,
}

/// The pivots so far. None depends on another.
#[derive(Default)]
pub struct Pivots {
    /// In the order in which they were found.
    pub pivots: Vec<Pivot>,
    by_dof: HashMap<usize, usize>,
    /// The pivots that depend on a dof that stays.
    depending: HashMap<usize, Vec<usize>>,
    sums: Sums,
}

impl Pivots {
    /// The equality `entries u = right` of a number with the pivots put in; it follows from them if less than this
    /// share of it is left.
    pub fn reduced(
        &mut self,
        entries: impl Iterator<Item = (usize, f64)>,
        right: Twice,
        (number, follows): (usize, f64),
    ) -> Remainder {
        let entries: Sparse = entries.map(|(dof, b)| (dof, b.into())).collect();
        let Pivots { pivots, by_dof, sums, .. } = self;
        let in_pivots: Vec<(&Pivot, Twice)> =
            entries.iter().filter_map(|&(dof, b)| Some((&pivots[*by_dof.get(&dof)?], b))).collect();
        let mut constant = Sum::default();
        constant.add(-right);
        sums.at(number).add(1.0.into());
        for &(pivot, b) in &in_pivots {
            constant.add(b * pivot.constant);
            // The row of a pivot is `u_dof - others = constant`.
            pivot.weights.iter().for_each(|&(number, weight)| sums.at(number).add(-(b * weight)));
        }
        let weights: Sparse = sums.taken().map(|(number, sum)| (number, sum.settled())).collect();
        let stays = entries.iter().filter(|entry| !by_dof.contains_key(&entry.0));
        stays.for_each(|&(dof, b)| sums.at(dof).add(b));
        for &(pivot, b) in &in_pivots {
            pivot.others.iter().for_each(|&(dof, a)| sums.at(dof).add(b * a));
        }
        let of_dofs: Vec<(usize, Sum)> = sums.taken().collect();
        let terms = of_dofs.iter().map(|entry| entry.1.terms).fold(0.0, f64::max);
        let settled = of_dofs.into_iter().map(|(dof, sum)| (dof, sum.settled()));
        let others: Sparse = settled.filter(|entry| entry.1 != Twice::ZERO).collect();
        let (left, size) = (constant.settled(), constant.terms);
        // The entries are rounded, and so is the right-hand side.
        let is_rounding = left.rounded().abs() <= follows * size;
        match (others.is_empty(), left == Twice::ZERO) {
            (true, true) => Remainder::Follows { weights, is_exact: true },
            (true, false) if is_rounding => Remainder::Follows { weights, is_exact: false },
            (true, false) => {
                let sign = Twice::from(if left.rounded() > 0.0 { 1.0 } else { -1.0 });
                Remainder::Contradicts(weights.into_iter().map(|(number, weight)| (number, weight * sign)).collect())
            }
            _ if largest(&others) > follows * terms => {
                Remainder::Row(Pivot { dof: 0, constant: left, others, weights })
            }
            _ if is_rounding => Remainder::Follows { weights, is_exact: false },
            _ => Remainder::Unclear,
        }
    }

    /// Solves a row for one of its dofs, and puts it into the pivots before.
    pub fn solve_for(&mut self, dof: usize, row: Pivot) {
        let Pivot { constant, mut others, weights, .. } = row;
        let Some(own) = taken_out(&mut others, dof) else { return };
        let divided =
            |values: Sparse, by: Twice| -> Sparse { values.into_iter().map(|(at, a)| (at, a / by)).collect() };
        let pivot =
            Pivot { dof, constant: -(constant / own), others: divided(others, -own), weights: divided(weights, own) };
        let number = self.pivots.len();
        let Pivots { pivots, depending, sums, .. } = self;
        for before in depending.remove(&dof).unwrap_or_default() {
            let earlier = &mut pivots[before];
            let Some(share) = taken_out(&mut earlier.others, dof) else { continue };
            earlier.others.iter().for_each(|&(other, a)| sums.at(other).add(a));
            for &(other, a) in &pivot.others {
                if sums.of_places.get(other).is_none_or(Option::is_none) {
                    depending.entry(other).or_default().push(before);
                }
                sums.at(other).add(share * a);
            }
            earlier.others = sums.taken().map(|(other, sum)| (other, sum.settled())).collect();
            earlier.constant = earlier.constant + share * pivot.constant;
            earlier.weights.iter().for_each(|&(equality, weight)| sums.at(equality).add(weight));
            pivot.weights.iter().for_each(|&(equality, weight)| sums.at(equality).add(share * weight));
            earlier.weights = sums.taken().map(|(equality, sum)| (equality, sum.value)).collect();
        }
        pivot.others.iter().for_each(|&(other, _)| depending.entry(other).or_default().push(number));
        self.by_dof.insert(dof, number);
        self.pivots.push(pivot);
    }
}

/// Solved equations as a change of unknowns: `u = u_0 + Z y`, with the unknowns y that stay.
#[derive(Clone, Debug)]
pub struct Solved {
    /// The others of each pivot are numbers among those that stay.
    pub pivots: Vec<Pivot>,
    /// The number of each unknown among those that stay, or that of its pivot.
    place: Vec<Result<usize, usize>>,
    /// The unknowns that stay, in increasing order.
    pub stays: Vec<usize>,
}

impl Solved {
    /// The equations with these pivots, in this number of unknowns.
    pub fn of(mut pivots: Vec<Pivot>, unknowns: usize) -> Self {
        let mut place = vec![Ok(0); unknowns];
        pivots.iter().enumerate().for_each(|(number, pivot)| place[pivot.dof] = Err(number));
        let stays: Vec<usize> = (0..unknowns).filter(|&dof| place[dof].is_ok()).collect();
        stays.iter().enumerate().for_each(|(number, &dof)| place[dof] = Ok(number));
        // No pivot depends on another.
        let others = pivots.iter_mut().flat_map(|pivot| &mut pivot.others);
        others.for_each(|(other, _)| *other = place[*other].unwrap_or(0));
        Solved { pivots, place, stays }
    }

    /// Some rows `b u = 0` of a matrix, each solved for the unknown of least rank; those that follow from the rows
    /// before within this accuracy are left out. Their numbers are those of all rows.
    pub fn of_rows<R: Ord>(
        matrix: &SparseMatrix,
        rows: &[usize],
        (accuracy, rank): (f64, impl Fn(usize) -> R),
    ) -> Self {
        let (by_row, mut found) = (matrix.transposed(), Pivots::default());
        for &row in rows {
            let entries = by_row.column(row).filter(|entry| entry.1 != 0.0);
            if let Remainder::Row(pivot) = found.reduced(entries, Twice::ZERO, (row, accuracy))
                && let Some(dof) = pivot.best(PIVOT, &rank)
            {
                found.solve_for(dof, pivot);
            }
        }
        Self::of(found.pivots, matrix.columns())
    }

    /// A row of Z: what an unknown depends on.
    pub fn row(&self, dof: usize) -> impl Iterator<Item = (usize, Twice)> + '_ {
        let own = self.place[dof].ok().map(|place| (place, 1.0.into()));
        let others = self.place[dof].err().map_or(&[][..], |pivot| &self.pivots[pivot].others);
        own.into_iter().chain(others.iter().copied())
    }

    /// An entry of u_0.
    pub fn constant(&self, dof: usize) -> Twice {
        self.place[dof].err().map_or(Twice::ZERO, |pivot| self.pivots[pivot].constant)
    }

    /// `Z y`, length n, and `u_0` this many times.
    pub fn of_all(&self, y: &[f64], times: f64) -> impl Iterator<Item = Twice> {
        self.place.iter().map(move |place| match *place {
            Ok(place) => y[place].into(),
            Err(pivot) => {
                let Pivot { constant, others, .. } = &self.pivots[pivot];
                others.iter().fold(*constant * times.into(), |sum, &(place, a)| sum + a * y[place].into())
            }
        })
    }

    /// `Z'K Z`, column by column, for a matrix of the first unknowns; entries between unknowns that no equation joins
    /// stay bit by bit.
    pub fn congruent(&self, matrix: &SymmetricMatrix) -> Result<SymmetricMatrix, Error> {
        let (lower, upper) = (matrix.lower(), matrix.upper());
        let mut columns: Vec<Sparse> = vec![Sparse::new(); self.stays.len()];
        for dof in 0..matrix.dim() {
            self.row(dof).for_each(|(place, a)| columns[place].push((dof, a)));
        }
        let (mut forces, mut sums) = (Sums::default(), Sums::default());
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for (column, moved) in columns.into_iter().enumerate() {
            // K z, then Z' times that.
            for (dof, a) in moved {
                let above = upper.column(dof).filter(|entry| entry.0 != dof);
                lower.column(dof).chain(above).for_each(|(row, k)| forces.at(row).add(Twice::from(k) * a));
            }
            for (dof, force) in forces.taken() {
                let below = self.row(dof).filter(|entry| entry.0 >= column);
                below.for_each(|(place, a)| sums.at(place).add_share(a, force));
            }
            for (row, sum) in sums.taken() {
                rows.push(row);
                values.push(sum.settled().rounded());
            }
            starts.push(rows.len());
        }
        SymmetricMatrix::from_lower(SparseMatrix::from_csc(self.stays.len(), starts, rows, values)?)
    }

    /// The multipliers, in order, of the first `count` equations that balance these forces on the first unknowns: no
    /// force acts on the others.
    pub fn balancing(&self, force: &[f64], count: usize) -> Vec<f64> {
        let mut multipliers = vec![Twice::ZERO; count];
        for pivot in self.pivots.iter().filter(|pivot| pivot.dof < force.len()) {
            for &(number, weight) in pivot.weights.iter().filter(|entry| entry.0 < count) {
                multipliers[number] = multipliers[number] + weight * force[pivot.dof].into();
            }
        }
        multipliers.into_iter().map(Twice::rounded).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_vanish_on_every_combination_of_what_stays_and_forces_are_sums_of_rows() {
        // Chains of shared unknowns, and a row that follows from two others.
        let rows = [
            [1.0, -0.5, 0.0, 0.0, 0.0, 2.0],
            [0.0, 1.0, -1.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.7, 0.3, 0.0, -1.0],
            [1.0, 0.5, -1.0, 0.0, 0.0, 2.0],
        ];
        let matrix = SparseMatrix::from_table(4, 6, &rows.concat()).unwrap();
        for first in [&[][..], &[5], &[2, 3]] {
            let solved = Solved::of_rows(&matrix, &[0, 1, 2, 3], (1e-12, |dof| !first.contains(&dof)));
            assert_eq!(solved.stays.len(), 3);
            assert!(first.iter().take(1).all(|&unknown| solved.pivots.iter().any(|pivot| pivot.dof == unknown)));
            let lifted: Vec<f64> = solved.of_all(&[0.3, -2.0, 1.1], 0.0).map(Twice::rounded).collect();
            assert!(matrix.mul(&lifted).iter().all(|left| left.abs() < 1e-14), "{lifted:?}");
            let force = matrix.mul_transposed(&[0.2, -1.0, 3.0, 0.4]);
            let back = matrix.mul_transposed(&solved.balancing(&force, 4));
            assert!(force.iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-13), "{force:?} {back:?}");
        }
    }

    #[test]
    fn rows_that_follow_within_an_accuracy_are_left_out_unless_they_contradict() {
        // The third is the sum of the others, except for 1e-12 in one entry; the last is the first with another value.
        let rows = |value: f64| {
            let entries = [[1.0, 2.0, 0.0], [0.0, 1.0, -1.0], [1.0, 3.0, -1.0 + 1e-12], [1.0, 2.0, 0.0]];
            let rows = SparseMatrix::from_table(4, 3, &entries.concat()).unwrap();
            [1e-10, 1e-14].map(|accuracy| rows.independent_rows(&[1.0, 2.0, 3.0, value], accuracy))
        };
        assert_eq!(rows(1.0), [vec![0, 1], vec![0, 1, 2]]);
        assert_eq!(rows(1.5), [vec![0, 1, 3], vec![0, 1, 2, 3]]);
    }
}
