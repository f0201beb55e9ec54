//! The equalities of a problem eliminated, sparse, with the way back.
//!
//! Equalities `E u = e` of rank r are solved for r dofs, the pivots: `u = u_0 + Z y`. The rest is a problem in y,
//!
//! ```text
//! minimise 1/2 y' Z'K Z y - (f - K u_0)' Z y   subject to   B Z y <= g - B u_0
//! ```
//!
//! which is definite wherever the equalities hold a motion without energy. The way back gives the multipliers of the
//! equalities from the forces on the pivots. All sums have twice the working precision.
//!
//! # Source
//! The choice of pivots: Duff, Erisman, Reid, *Direct Methods for Sparse Matrices*, Oxford (1986), ch. 7.

use std::collections::HashMap;

use crate::error::Error;
use crate::linear::multigrid::NearNullSpace;
use crate::linear::{SparseMatrix, SymmetricMatrix, Twice};
use crate::problem::{ContactProblem, Equality};
use crate::solution::{ContactSet, Iteration, Solution};

/// A pivot has at least this share of the largest entry of its row.
const PIVOT: f64 = 0.1;

/// A sum below this share of its terms is zero: far above the rounding of twice the working precision.
const CANCELLED: f64 = 1e-26;

/// A row follows from others, except for the rounding of its entries, if less than this share of them is left.
const FOLLOWS: f64 = 4.0 * f64::EPSILON;

/// The elimination may add this many entries to K for each one that it has, and `FEW` to any.
const FILL: usize = 4;

/// Entries that are not worth counting.
const FEW: usize = 2_000_000;

/// Sparse numbers with their places, which increase.
type Sparse = Vec<(usize, Twice)>;

/// Takes the number at a place out, if there is one.
fn taken_out(values: &mut Sparse, place: usize) -> Option<Twice> {
    let found = values.binary_search_by_key(&place, |entry| entry.0);
    found.ok().map(|found| values.remove(found).1)
}

/// A sum with the magnitudes of its terms.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    value: Twice,
    terms: f64,
}

impl Sum {
    fn add(&mut self, term: Twice) {
        self.value = self.value + term;
        self.terms += term.rounded().abs();
    }

    /// Adds a multiple of another sum, with the terms of that.
    fn add_share(&mut self, share: Twice, of: Sum) {
        self.value = self.value + share * of.value;
        self.terms += share.rounded().abs() * of.terms;
    }

    /// Zero if the terms cancel.
    fn settled(self) -> Twice {
        self.beyond(CANCELLED)
    }

    /// Zero if at most this share of the terms is left.
    fn beyond(self, share: f64) -> Twice {
        if self.value.rounded().abs() > share * self.terms { self.value } else { Twice::ZERO }
    }
}

/// Sums by their places, in memory that serves one vector after another.
#[derive(Default)]
struct Sums {
    of_places: Vec<Option<Sum>>,
    /// The places with a sum, in the order of their first terms.
    places: Vec<usize>,
}

impl Sums {
    /// The sum at a place, which begins with none.
    fn at(&mut self, place: usize) -> &mut Sum {
        if place >= self.of_places.len() {
            self.of_places.resize(place + 1, None);
        }
        if self.of_places[place].is_none() {
            self.places.push(place);
        }
        self.of_places[place].get_or_insert_default()
    }

    /// All sums, in the order of their places; none is left.
    fn taken(&mut self) -> impl Iterator<Item = (usize, Sum)> + '_ {
        self.places.sort_unstable();
        let of_places = &mut self.of_places;
        self.places.drain(..).map(|place| (place, of_places[place].take().unwrap_or_default()))
    }
}

/// A dof that an equality gives: `u_dof = constant + sum of others`.
#[derive(Clone, Debug)]
struct Pivot {
    dof: usize,
    constant: Twice,
    /// Dofs that stay, with their coefficients.
    others: Sparse,
    /// The weights of the equalities whose sum is the row of this pivot, by their numbers.
    weights: Sparse,
}

/// The largest magnitude of the coefficients.
fn largest(values: &Sparse) -> f64 {
    values.iter().map(|entry| entry.1.rounded().abs()).fold(0.0, f64::max)
}

impl Pivot {
    /// The dof with the least rank among those of large coefficients.
    fn best<R: Ord>(&self, rank: impl Fn(usize) -> R) -> Option<usize> {
        let largest = largest(&self.others);
        let may_be = |entry: &&(usize, Twice)| entry.1.rounded().abs() >= PIVOT * largest;
        self.others.iter().filter(may_be).map(|entry| entry.0).min_by_key(|&dof| rank(dof))
    }
}

impl SparseMatrix {
    /// The rows of the equations `A u = values` that do not follow from the others within `accuracy`, relative to their
    /// entries and values; in increasing order. `values` has an entry for each row, in any unit. A row that contradicts
    /// the others stays.
    pub fn independent_rows(&self, values: &[f64], accuracy: f64) -> Vec<usize> {
        let by_row = self.transposed();
        let of_row = |row: usize| by_row.column(row).filter(|entry| entry.1 != 0.0);
        let mut order: Vec<usize> = (0..self.rows()).collect();
        order.sort_by_key(|&row| of_row(row).count());
        let (mut found, mut stays) = (Found::default(), vec![true; self.rows()]);
        for row in order {
            let entries: Sparse = of_row(row).map(|(dof, a)| (dof, a.into())).collect();
            match found.reduced(&entries, values.get(row).copied().unwrap_or(0.0).into(), (row, accuracy)) {
                Reduced::Row(pivot) => {
                    if let Some(dof) = pivot.best(|dof| self.column(dof).count()) {
                        found.solve_for(dof, pivot);
                    }
                }
                Reduced::Follows => stays[row] = false,
                Reduced::Contradicts(_) | Reduced::Unclear => {}
            }
        }
        (0..self.rows()).filter(|&row| stays[row]).collect()
    }
}

/// The equalities of a problem, solved for some of its dofs.
#[derive(Clone, Debug)]
pub struct Elimination {
    equalities: Vec<Equality>,
    pivots: Vec<Pivot>,
    /// The number of each dof among those that stay, or that of its pivot.
    place: Vec<Result<usize, usize>>,
    /// The dofs, and the rows, that stay, in increasing order.
    dofs: Vec<usize>,
    rows: Vec<usize>,
}

impl Elimination {
    /// The elimination of all equalities of `problem`; `None` if it would fill the stiffness, or if it is open within
    /// rounding whether some of them follow from others or contradict them.
    ///
    /// # Errors
    /// [`Error::Infeasible`] for equalities that contradict each other.
    pub fn of(problem: &ContactProblem) -> Result<Option<Self>, Error> {
        let (equalities, by_row) = (problem.equalities().to_vec(), problem.contact().transposed());
        // Short rows first: they fill the others least.
        let mut order: Vec<usize> = (0..equalities.len()).collect();
        order.sort_by_key(|&number| by_row.column(equalities[number].row).count());
        // A dof of few equalities goes into few others; then one of few entries of K and B.
        let mut of_equalities = vec![0; problem.dofs()];
        let in_equalities = equalities.iter().flat_map(|pair| by_row.column(pair.row));
        in_equalities.filter(|entry| entry.1 != 0.0).for_each(|(dof, _)| of_equalities[dof] += 1);
        let columns: Vec<usize> = (0..problem.dofs())
            .map(|dof| problem.stiffness().lower().column(dof).count() + problem.contact().column(dof).count())
            .collect();
        let most = FEW + FILL * problem.stiffness().entries();
        let (mut found, mut fill) = (Found::default(), 0);
        for number in order {
            let row = equalities[number].row;
            let entries: Sparse =
                by_row.column(row).filter(|entry| entry.1 != 0.0).map(|(dof, b)| (dof, b.into())).collect();
            match found.reduced(&entries, problem.gap()[row].into(), (number, FOLLOWS)) {
                Reduced::Row(pivot) => {
                    let Some(dof) = pivot.best(|dof| (of_equalities[dof], columns[dof])) else { return Ok(None) };
                    fill += pivot.others.len() * (pivot.others.len() + columns[dof]);
                    if fill > most {
                        return Ok(None);
                    }
                    found.solve_for(dof, pivot);
                }
                Reduced::Follows => {}
                Reduced::Contradicts(weights) => {
                    let (rows, weights) = signed(&equalities, &weights);
                    return match problem.overlap(&rows, &weights) {
                        Some(_) => Err(problem.infeasible(&rows, &weights)),
                        None => Ok(None),
                    };
                }
                Reduced::Unclear => return Ok(None),
            }
        }
        Ok(Some(Self::with(problem, equalities, found.pivots)))
    }

    fn with(problem: &ContactProblem, equalities: Vec<Equality>, pivots: Vec<Pivot>) -> Self {
        let mut place = vec![Ok(0); problem.dofs()];
        pivots.iter().enumerate().for_each(|(number, pivot)| place[pivot.dof] = Err(number));
        let dofs: Vec<usize> = (0..problem.dofs()).filter(|&dof| place[dof].is_ok()).collect();
        dofs.iter().enumerate().for_each(|(number, &dof)| place[dof] = Ok(number));
        let mut is_equality = vec![false; problem.rows()];
        equalities.iter().flat_map(|pair| [pair.row, pair.opposed]).for_each(|row| is_equality[row] = true);
        let rows = (0..problem.rows()).filter(|&row| !is_equality[row]).collect();
        Elimination { equalities, pivots, place, dofs, rows }
    }

    /// The problem in the dofs that stay.
    ///
    /// # Errors
    /// As [`ContactProblem::new`].
    pub fn problem(&self, problem: &ContactProblem) -> Result<ContactProblem, Error> {
        let (stiffness, load) = (self.stiffness(problem)?, self.load(problem));
        let (by_row, mut sums) = (problem.contact().transposed(), Sums::default());
        let (mut entries, mut gap) = (Vec::with_capacity(by_row.entries()), Vec::with_capacity(self.rows.len()));
        for (number, &row) in self.rows.iter().enumerate() {
            let mut distance = Sum::default();
            distance.add(problem.gap()[row].into());
            for (dof, b) in by_row.column(row) {
                let b = Twice::from(b);
                self.staying_for(dof).for_each(|(place, a)| sums.at(place).add(b * a));
                if let Err(pivot) = self.place[dof] {
                    distance.add(-(b * self.pivots[pivot].constant));
                }
            }
            // What is left within the rounding of the entries of a row is no row of its own.
            let mut is_empty = true;
            for (place, sum) in sums.taken() {
                let value = sum.beyond(FOLLOWS).rounded();
                is_empty &= value == 0.0;
                entries.push((number, place, value));
            }
            gap.push(match (distance.terms.is_finite(), is_empty) {
                (false, _) => f64::INFINITY,
                (true, true) => distance.beyond(FOLLOWS).rounded(),
                (true, false) => distance.settled().rounded(),
            });
        }
        let contact = SparseMatrix::from_triplets(self.rows.len(), self.dofs.len(), &entries)?;
        let reduced = ContactProblem::new(stiffness, load, contact, gap)?;
        let Some(modes) = problem.near_null() else { return Ok(reduced) };
        let moves = |mode: &Vec<f64>| mode.iter().any(|&value| value != 0.0);
        match NearNullSpace::of_modes(modes.vectors().iter().map(|mode| self.staying(mode)).filter(moves).collect()) {
            Some(modes) => reduced.with_near_null(modes),
            None => Ok(reduced),
        }
    }

    /// The dofs that stay on which a dof depends, itself if it stays: their places and coefficients, a row of Z.
    fn staying_for(&self, dof: usize) -> impl Iterator<Item = (usize, Twice)> + '_ {
        let own = self.place[dof].ok().map(|place| (place, 1.0.into()));
        let others = self.place[dof].err().map_or(&[][..], |pivot| &self.pivots[pivot].others);
        own.into_iter().chain(others.iter().map(|&(other, a)| (self.place[other].unwrap_or(0), a)))
    }

    /// `Z'K Z`, column by column; entries between dofs that no equality joins stay bit by bit.
    fn stiffness(&self, problem: &ContactProblem) -> Result<SymmetricMatrix, Error> {
        let (lower, upper) = (problem.stiffness().lower(), problem.stiffness().upper());
        let mut columns: Vec<Sparse> = vec![Sparse::new(); self.dofs.len()];
        for dof in 0..problem.dofs() {
            self.staying_for(dof).for_each(|(place, a)| columns[place].push((dof, a)));
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
                let below = self.staying_for(dof).filter(|entry| entry.0 >= column);
                below.for_each(|(place, a)| sums.at(place).add_share(a, force));
            }
            for (row, sum) in sums.taken() {
                rows.push(row);
                values.push(sum.settled().rounded());
            }
            starts.push(rows.len());
        }
        SymmetricMatrix::from_lower(SparseMatrix::from_csc(self.dofs.len(), starts, rows, values)?)
    }

    /// `Z'(f - K u_0)`.
    fn load(&self, problem: &ContactProblem) -> Vec<f64> {
        let constant = |dof: usize| self.place[dof].err().map_or(Twice::ZERO, |pivot| self.pivots[pivot].constant);
        let mut forces: Vec<Sum> = vec![Sum::default(); problem.dofs()];
        forces.iter_mut().zip(problem.load()).for_each(|(force, &f)| force.add(f.into()));
        for (row, column, value) in problem.stiffness().lower().triplets() {
            let value = Twice::from(value);
            forces[row].add(-(value * constant(column)));
            if row != column {
                forces[column].add(-(value * constant(row)));
            }
        }
        let mut load: Vec<Sum> = self.dofs.iter().map(|&dof| forces[dof]).collect();
        for pivot in &self.pivots {
            for &(dof, a) in &pivot.others {
                load[self.place[dof].unwrap_or(0)].add(a * forces[pivot.dof].value);
            }
        }
        load.into_iter().map(|sum| sum.settled().rounded()).collect()
    }

    /// The entries of those dofs that stay, of one for each dof.
    pub fn staying(&self, of_dofs: &[f64]) -> Vec<f64> {
        self.dofs.iter().map(|&dof| of_dofs[dof]).collect()
    }

    /// The set of the rows that stay, from one of all rows.
    pub fn staying_rows(&self, set: &ContactSet) -> ContactSet {
        self.rows.iter().map(|&row| set.contains(row)).collect()
    }

    /// The displacement of all dofs, length n, from that of those that stay.
    fn displacement(&self, y: &[f64]) -> Vec<f64> {
        let given = |pivot: &Pivot| {
            let of = |&(dof, a): &(usize, Twice)| a * y[self.place[dof].unwrap_or(0)].into();
            pivot.others.iter().map(of).fold(pivot.constant, |sum, term| sum + term).rounded()
        };
        let value = |place: &Result<usize, usize>| match *place {
            Ok(place) => y[place],
            Err(pivot) => given(&self.pivots[pivot]),
        };
        self.place.iter().map(value).collect()
    }

    /// The multipliers of the equalities, one for each, that balance these forces on the pivots.
    fn balancing(&self, force: &[f64]) -> Vec<f64> {
        let mut multipliers = vec![Twice::ZERO; self.equalities.len()];
        for pivot in &self.pivots {
            for &(number, weight) in &pivot.weights {
                multipliers[number] = multipliers[number] + weight * force[pivot.dof].into();
            }
        }
        multipliers.into_iter().map(Twice::rounded).collect()
    }

    /// An answer in the dofs that stay as one of the whole, without a certificate.
    pub fn expanded(&self, problem: &ContactProblem, answer: Solution) -> Solution {
        let displacement = self.displacement(&answer.displacement);
        let mut multiplier = vec![0.0; problem.rows()];
        self.rows.iter().zip(&answer.multiplier).for_each(|(&row, &force)| multiplier[row] = force);
        let left: Vec<f64> = problem.accurate_residual(&displacement, &multiplier).iter().map(|force| -force).collect();
        for (pair, mu) in self.equalities.iter().zip(self.balancing(&left)) {
            if mu <= 0.0 { multiplier[pair.row] = mu } else { multiplier[pair.opposed] = -mu / pair.ratio }
        }
        let set = |of: &ContactSet| {
            let mut set = ContactSet::open(problem.rows());
            of.iter().filter_map(|place| self.rows.get(place)).for_each(|&row| set.insert(row));
            // One row of each pair: both together follow from each other.
            let pressing = |pair: &Equality| if multiplier[pair.opposed] < 0.0 { pair.opposed } else { pair.row };
            self.equalities.iter().for_each(|pair| set.insert(pressing(pair)));
            set
        };
        let history = answer.history.iter();
        let history = history.map(|step| Iteration { contact_set: set(&step.contact_set), ..step.clone() }).collect();
        let (contact_set, method) = (set(&answer.contact_set), format!("{}-eliminated", answer.method));
        Solution { contact_set, history, method, displacement, multiplier, proven: None, ..answer }
    }

    /// Rows that contradict each other, with their weights, from those of the rows that stay: the equalities take what
    /// is left on the pivots.
    pub fn contradiction(&self, problem: &ContactProblem, rows: &[usize], weights: &[f64]) -> (Vec<usize>, Vec<f64>) {
        let mut pressed = vec![0.0; problem.rows()];
        rows.iter().zip(weights).for_each(|(&row, weight)| pressed[self.rows[row]] += weight);
        let left: Vec<f64> = problem.contact().mul_transposed(&pressed).iter().map(|force| -force).collect();
        let of_equalities = self.balancing(&left).into_iter().map(Twice::from).enumerate().collect();
        let (mut all, mut of_all) = signed(&self.equalities, &of_equalities);
        all.extend(rows.iter().map(|&row| self.rows[row]));
        of_all.extend(weights);
        (all, of_all)
    }
}

/// The rows of the pairs, each on the side of its weight, with their magnitudes.
fn signed(equalities: &[Equality], weights: &Sparse) -> (Vec<usize>, Vec<f64>) {
    let of = |&(number, weight): &(usize, Twice)| {
        let Equality { row, opposed, ratio } = equalities[number];
        let weight = weight.rounded();
        if weight >= 0.0 { (row, weight) } else { (opposed, -weight / ratio) }
    };
    weights.iter().filter(|entry| entry.1.rounded() != 0.0).map(of).unzip()
}

/// What is left of an equality after the pivots so far.
enum Reduced {
    /// `sum of others + constant = 0`, not yet solved for a dof.
    Row(Pivot),
    Follows,
    /// Nothing is left but a number: with these weights the equalities contradict each other.
    Contradicts(Sparse),
    /// No more is left than rounding of the entries may leave.
    Unclear,
}

/// The pivots so far. None depends on another.
#[derive(Default)]
struct Found {
    pivots: Vec<Pivot>,
    by_dof: HashMap<usize, usize>,
    /// The pivots that depend on a dof that stays.
    depending: HashMap<usize, Vec<usize>>,
    sums: Sums,
}

impl Found {
    /// The equality `entries u = right` of a number with the pivots put in; it follows from them if less than this
    /// share of it is left.
    fn reduced(&mut self, entries: &Sparse, right: Twice, (number, follows): (usize, f64)) -> Reduced {
        let Found { pivots, by_dof, sums, .. } = self;
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
        match (others.is_empty(), left == Twice::ZERO) {
            (true, true) => Reduced::Follows,
            (true, false) => {
                let sign = if left.rounded() > 0.0 { 1.0 } else { -1.0 };
                Reduced::Contradicts(
                    weights.into_iter().map(|(number, weight)| (number, weight * sign.into())).collect(),
                )
            }
            _ if largest(&others) > follows * terms => Reduced::Row(Pivot { dof: 0, constant: left, others, weights }),
            // The entries are rounded, and so is the right-hand side.
            _ if left.rounded().abs() <= follows * size => Reduced::Follows,
            _ => Reduced::Unclear,
        }
    }

    /// Solves a row for one of its dofs, and puts it into the pivots before.
    fn solve_for(&mut self, dof: usize, row: Pivot) {
        let Pivot { constant, mut others, weights, .. } = row;
        let Some(own) = taken_out(&mut others, dof) else { return };
        let divided =
            |values: Sparse, by: Twice| -> Sparse { values.into_iter().map(|(at, a)| (at, a / by)).collect() };
        let pivot =
            Pivot { dof, constant: -(constant / own), others: divided(others, -own), weights: divided(weights, own) };
        let number = self.pivots.len();
        let Found { pivots, depending, sums, .. } = self;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Settings;
    use crate::solve;

    /// Rounding of sums of a handful of numbers of order ten.
    const ROUNDING: f64 = 1e-13;

    /// A ring of four dofs under loads, with the equality `u_0 - 2 u_1 + u_3 = 3` as two rows, the second three times
    /// as large, and one inequality before them.
    fn tied(load: [f64; 4]) -> ContactProblem {
        let diagonal = [4.0, 3.0, 2.0, 5.0].into_iter().enumerate().map(|(dof, value)| (dof, dof, value));
        let stiffness: Vec<_> = diagonal.chain([(1, 0, -1.0), (2, 1, -1.0), (3, 2, -1.0), (3, 0, -0.5)]).collect();
        let tie = [(0, 1.0), (1, -2.0), (3, 1.0)];
        let rows = [(0, 0, 1.0), (0, 1, 3.0), (0, 2, -1.0)].into_iter();
        let rows = rows.chain(tie.map(|(dof, b)| (1, dof, b))).chain(tie.map(|(dof, b)| (2, dof, -3.0 * b)));
        ContactProblem::of_entries(&stiffness, &load, &rows.collect::<Vec<_>>(), &[2.0, 3.0, -9.0])
    }

    /// The same with a second tie on the dofs that the first one is solved for: `u_0 + u_1 + 2 u_3 = 1`.
    fn twice_tied(load: [f64; 4]) -> ContactProblem {
        let second = SparseMatrix::from_triplets(1, 4, &[(0, 0, 1.0), (0, 1, 1.0), (0, 3, 2.0)]).unwrap();
        tied(load).with_equalities(&second, vec![1.0]).unwrap()
    }

    /// `1/2 u'K u - f'u`.
    fn objective(problem: &ContactProblem, u: &[f64]) -> f64 {
        let elastic = problem.stiffness().mul(u);
        u.iter().zip(elastic).zip(problem.load()).map(|((u, k), f)| u * (k / 2.0 - f)).sum()
    }

    #[test]
    fn the_rest_has_the_objective_and_the_distances_of_the_whole_on_the_equalities() {
        let problem = twice_tied([1.0, -2.0, 3.0, 0.5]);
        let elimination = Elimination::of(&problem).unwrap().unwrap();
        let rest = elimination.problem(&problem).unwrap();
        assert_eq!((rest.dofs(), rest.rows()), (2, 1));
        let at_rest = objective(&problem, &elimination.displacement(&[0.0; 2]));
        for y in [[0.0; 2], [1.0, 2.0], [-3.0, 0.5], [0.25, -7.0]] {
            let u = elimination.displacement(&y);
            let held = [u[0] - 2.0 * u[1] + u[3] - 3.0, u[0] + u[1] + 2.0 * u[3] - 1.0];
            assert!(held.iter().all(|left| left.abs() < ROUNDING), "{u:?}");
            let (whole, of_rest) = (objective(&problem, &u) - at_rest, objective(&rest, &y));
            assert!((whole - of_rest).abs() < ROUNDING * (1.0 + whole.abs()), "{y:?}: {whole} {of_rest}");
            assert!((problem.violation(&u)[0] - rest.violation(&y)[0]).abs() < ROUNDING, "{y:?}");
        }
    }

    #[test]
    fn the_answer_of_the_rest_is_one_of_the_whole_with_multipliers_that_push() {
        // The tie pulls to one side and to the other: the multiplier goes to the first row or to the second.
        for (load, pressing) in [([9.0, -9.0, 3.0, 9.0], 1), ([-9.0, 9.0, 3.0, -9.0], 2)] {
            let problem = twice_tied(load);
            let elimination = Elimination::of(&problem).unwrap().unwrap();
            let answer = solve(&elimination.problem(&problem).unwrap(), &Settings::default()).unwrap();
            let found = elimination.expanded(&problem, answer);
            let left = problem.accurate_residual(&found.displacement, &found.multiplier);
            assert!(left.iter().all(|force| force.abs() < ROUNDING), "{left:?}");
            assert!(
                found.multiplier[pressing] < -0.1 && found.multiplier[3 - pressing] == 0.0,
                "{:?}",
                found.multiplier
            );
            assert!(found.contact_set.contains(pressing) && !found.contact_set.contains(3 - pressing));
        }
    }

    #[test]
    fn rows_that_follow_within_an_accuracy_are_left_out_unless_they_contradict() {
        // The third is the sum of the others, except for 1e-12 in one entry; the last is the first with another value.
        let entries =
            [(0, 0, 1.0), (0, 1, 2.0), (1, 1, 1.0), (1, 2, -1.0), (2, 0, 1.0), (2, 1, 3.0), (2, 2, -1.0 + 1e-12)];
        let rows = |value: f64| {
            let again = [(3, 0, 1.0), (3, 1, 2.0)];
            let rows = SparseMatrix::from_triplets(4, 3, &[&entries[..], &again].concat()).unwrap();
            [1e-10, 1e-14].map(|accuracy| rows.independent_rows(&[1.0, 2.0, 3.0, value], accuracy))
        };
        assert_eq!(rows(1.0), [vec![0, 1], vec![0, 1, 2]]);
        assert_eq!(rows(1.5), [vec![0, 1, 3], vec![0, 1, 2, 3]]);
    }

    #[test]
    fn rows_that_follow_drop_out_and_contradictory_ones_are_named_with_weights_that_cancel() {
        let plain = tied([0.0; 4]);
        let entries = [(0, 0, 1.0), (0, 1, 1.0), (1, 1, 3.0), (1, 2, 1.0), (2, 0, 2.0), (2, 1, -1.0), (2, 2, -1.0)];
        // The third is twice the first less the second.
        let rows = SparseMatrix::from_triplets(3, 4, &entries).unwrap();
        let follows = plain.with_equalities(&rows, vec![1.0, 5.0, -3.0]).unwrap();
        // Two of these, and the tie.
        assert_eq!(Elimination::of(&follows).unwrap().unwrap().pivots.len(), 3);
        let contradicts = plain.with_equalities(&rows, vec![1.0, 5.0, -4.0]).unwrap();
        let Err(Error::Infeasible { rows, weights, overlap, .. }) = Elimination::of(&contradicts) else {
            panic!("nothing is found")
        };
        let weight =
            |row: usize| rows.iter().zip(&weights).filter(|entry| *entry.0 == row).map(|entry| entry.1).sum::<f64>();
        // Twice the first less the second less the third, in either direction.
        let exact = [2.0, -1.0, -1.0].map(|of_exact| of_exact * weight(3) / 2.0);
        assert!((0..3).all(|row| (weight(3 + row) - exact[row]).abs() < ROUNDING) && weight(3) != 0.0, "{weights:?}");
        assert!(overlap > 0.0);
    }
}
