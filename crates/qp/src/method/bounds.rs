//! Rows as bounds: reflections that turn every row onto one unknown of its own.
//!
//! Rows may share a *travel*, a dof t without stiffness: `n'u + c t <= g`. The unknown of such a row is `w = n'u + c t`, scaled, so that
//! its bound does not move with t. Forces along t then add up those of all its rows.

use std::collections::{BTreeSet, HashMap};

use crate::error::Error;
use crate::linear::SparseMatrix;
use crate::linear::multigrid::Direction;
use crate::solution::ContactSet;

/// Entries of a unit vector below this are rounding of the reflections.
const TURNING_ROUNDING: f64 = 1e-12;

/// A row on one side of its unknown: `coefficient * v <= gap`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Side {
    row: usize,
    coefficient: f64,
    value: f64,
}

/// The bounds of one unknown.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// The unknown, after the reflections.
    pub unknown: usize,
    /// The least value, `-inf` without a lower bound.
    pub lower: f64,
    /// The greatest value, `+inf` without an upper bound.
    pub upper: f64,
    /// The travel t that the unknown contains, and its share s: `w = v + s t`.
    pub travel: Option<(usize, f64)>,
    sides: [Option<Side>; 2],
}

/// Reflects v at a unit vector w, in place: `v -= 2 w (w'v)`.
fn reflect(w: &Direction, v: &mut [f64]) {
    let along: f64 = w.iter().map(|&(place, w)| w * v[place]).sum();
    w.iter().for_each(|&(place, w)| v[place] -= 2.0 * along * w);
}

/// Rows B u <= g as bounds on unknowns w = S H u, with H orthogonal: a product of one reflection for each row that has more
/// than one entry beside a travel. S adds the travels.
#[derive(Clone, Debug)]
pub struct Bounds {
    /// The unit vector of each reflection.
    reflections: Vec<Direction>,
    /// The reflections that touch each place.
    touching: HashMap<usize, Vec<usize>>,
    /// The bounds.
    pub bounds: Vec<Bound>,
    /// The travels, the dofs without stiffness.
    pub travels: Vec<usize>,
    rows: usize,
}

/// The order in which reflections are applied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Order {
    /// The order of the product H.
    Forward,
    /// The reverse order, that of H'.
    Backward,
}

impl Bounds {
    /// The bounds that rows B (m x n) and gaps g give if the dofs `travels` have no stiffness. Rows without entries or with an
    /// infinite gap give none.
    ///
    /// # Errors
    /// [`Error::Numerical`] for two rows that share an unknown and are neither parallel nor orthogonal, because no rotation makes them
    /// bounds; for a row of several travels, and for an unknown whose rows have different travels.
    pub fn of(contact: &SparseMatrix, gap: &[f64], travels: Vec<usize>) -> Result<Self, Error> {
        let by_row = contact.transposed();
        let (reflections, touching, bounds) = (Vec::new(), HashMap::new(), Vec::new());
        let mut all = Bounds { reflections, touching, bounds, travels, rows: gap.len() };
        let mut bound_of: Vec<Option<usize>> = vec![None; contact.columns()];
        for row in (0..gap.len()).filter(|&row| gap[row].is_finite()) {
            let is_travel = |entry: &(usize, f64)| all.travels.binary_search(&entry.0).is_ok();
            let (mut moving, mut entries): (Direction, Direction) =
                by_row.column(row).filter(|entry| entry.1 != 0.0).partition(is_travel);
            if moving.len() > 1 {
                return Err(no_bound(format!("contact row {row} (index from 0) has several dofs without stiffness")));
            }
            if entries.is_empty() {
                // The row of a node that is held: a bound on the travel itself.
                std::mem::swap(&mut moving, &mut entries);
            }
            let length = entries.iter().fold(0.0, |length: f64, entry| length.hypot(entry.1));
            let turned = all.reflected(entries.iter().map(|&(place, b)| (place, b / length)).collect(), Order::Forward);
            let Some(&(first, _)) = turned.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())) else { continue };
            let taken = turned.iter().find_map(|entry| bound_of[entry.0]);
            if let Some(index) = taken.filter(|_| turned.len() > 1) {
                let other = all.bounds[index].sides.iter().flatten().next().map_or(0, |side| side.row);
                return Err(no_bound(format!(
                    "contact rows {other} and {row} (indices from 0) share an unknown and are neither parallel nor at right angles"
                )));
            }
            let sign = if turned.len() == 1 { turned[0].1.signum() } else { all.reflect(turned, first) };
            let coefficient = sign * length;
            let travel = moving.first().map(|&(travel, c)| (travel, c / coefficient));
            let index = *bound_of[first].get_or_insert(all.bounds.len());
            if index == all.bounds.len() {
                let (lower, upper) = (f64::NEG_INFINITY, f64::INFINITY);
                all.bounds.push(Bound { unknown: first, lower, upper, travel, sides: [None; 2] });
            }
            let bound = &mut all.bounds[index];
            if !bound.travels_as(travel) {
                return Err(no_bound(format!(
                    "contact row {row} (index from 0) shares an unknown with one of another travel"
                )));
            }
            bound.take(Side { row, coefficient, value: gap[row] / coefficient });
        }
        Ok(all)
    }

    /// A unit vector after the reflections that touch it.
    fn reflected(&self, vector: Direction, order: Order) -> Direction {
        if vector.len() == 1 && vector.iter().all(|entry| !self.touching.contains_key(&entry.0)) {
            return vector;
        }
        let mut entries: HashMap<usize, f64> = vector.into_iter().collect();
        let of_place = |place: &usize| self.touching.get(place).into_iter().flatten().copied();
        let mut waiting: BTreeSet<usize> = entries.keys().flat_map(of_place).collect();
        loop {
            let next = match order {
                Order::Forward => waiting.pop_first(),
                Order::Backward => waiting.pop_last(),
            };
            let Some(next) = next else { break };
            let follows = |other: &usize| (*other > next) == (order == Order::Forward) && *other != next;
            let reflection = &self.reflections[next];
            let along: f64 = reflection.iter().map(|&(p, w)| w * entries.get(&p).copied().unwrap_or(0.0)).sum();
            for &(place, w) in reflection {
                *entries.entry(place).or_insert(0.0) -= 2.0 * along * w;
                waiting.extend(of_place(&place).filter(follows));
            }
        }
        let mut reflected: Direction = entries.into_iter().filter(|entry| entry.1.abs() > TURNING_ROUNDING).collect();
        reflected.sort_unstable_by_key(|entry| entry.0);
        reflected
    }

    /// Adds the reflection that turns a unit vector onto `place`, up to the sign that is returned.
    fn reflect(&mut self, mut unit: Direction, place: usize) -> f64 {
        let own = unit.iter().find(|entry| entry.0 == place).map_or(1.0, |entry| entry.1);
        // |u + sign e|^2 = 2 + 2 |u_place|.
        let length = (2.0 + 2.0 * own.abs()).sqrt();
        for entry in &mut unit {
            if entry.0 == place {
                entry.1 += own.signum();
            }
            entry.1 /= length;
            self.touching.entry(entry.0).or_default().push(self.reflections.len());
        }
        self.reflections.push(unit);
        -own.signum()
    }

    /// Returns `true` if all rows are bounds without a reflection and without a travel.
    pub fn is_plain(&self) -> bool {
        self.reflections.is_empty() && self.travels.is_empty()
    }

    /// The unknowns w = S H u of a displacement u, in place.
    pub fn turn(&self, v: &mut [f64]) {
        self.reflections.iter().for_each(|reflection| reflect(reflection, v));
        self.shears().for_each(|(unknown, travel, share)| v[unknown] += share * v[travel]);
    }

    /// The displacement H' S^-1 w of unknowns w, in place.
    pub fn turn_back(&self, v: &mut [f64]) {
        self.shears().for_each(|(unknown, travel, share)| v[unknown] -= share * v[travel]);
        self.reflections.iter().rev().for_each(|reflection| reflect(reflection, v));
    }

    /// The forces S^-T H f along the unknowns of forces f along the dofs, in place.
    pub fn turn_forces(&self, f: &mut [f64]) {
        self.reflections.iter().for_each(|reflection| reflect(reflection, f));
        self.shears().for_each(|(unknown, travel, share)| f[travel] -= share * f[unknown]);
    }

    /// Each unknown with a travel, that travel, and its share.
    fn shears(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        self.bounds.iter().filter_map(|bound| bound.travel.map(|(travel, share)| (bound.unknown, travel, share)))
    }

    /// The unit vector along which the unknown of a bound moves if nothing travels: its column of H'.
    pub fn direction(&self, bound: &Bound) -> Direction {
        self.reflected(vec![(bound.unknown, 1.0)], Order::Backward)
    }

    /// The multipliers of the rows if the forces on the unknowns with bounds are `force` (those out of balance there), and the
    /// rows that are closed.
    pub fn multipliers(&self, force: impl Fn(usize) -> f64) -> (Vec<f64>, ContactSet) {
        let (mut multiplier, mut closed) = (vec![0.0; self.rows], ContactSet::open(self.rows));
        for (index, bound) in self.bounds.iter().enumerate() {
            let force = force(index);
            // A negative force belongs to the upper bound.
            let side = bound.sides[usize::from(force < 0.0)];
            if let Some(side) = side.filter(|_| force != 0.0) {
                multiplier[side.row] = force / side.coefficient;
                closed.insert(side.row);
            }
        }
        (multiplier, closed)
    }
}

/// Two shares of a travel are equal if they differ by no more than this share.
const EQUAL_SHARES: f64 = 1e-12;

/// The error of rows that are no bounds.
fn no_bound(what: String) -> Error {
    Error::Numerical {
        step: "turning contact rows into bounds",
        reason: format!("{what}; another method must take them"),
    }
}

impl Bound {
    /// Returns `true` if a row with this travel may join those of the bound.
    fn travels_as(&self, travel: Option<(usize, f64)>) -> bool {
        match (self.travel, travel) {
            (Some((own, a)), Some((other, b))) => own == other && (a - b).abs() <= EQUAL_SHARES * a.abs(),
            (own, other) => own == other,
        }
    }

    /// The value of a bound with a row in the set; the upper value if both rows are.
    pub fn closed_at(&self, closed: &ContactSet) -> Option<f64> {
        let is_closed = |side: &Option<Side>| side.is_some_and(|side| closed.contains(side.row));
        let [lower, upper] = &self.sides;
        if is_closed(upper) { Some(self.upper) } else { is_closed(lower).then_some(self.lower) }
    }

    fn take(&mut self, side: Side) {
        let upper = side.coefficient > 0.0;
        let place = &mut self.sides[usize::from(upper)];
        let is_tighter = |old: &Side| if upper { side.value < old.value } else { side.value > old.value };
        if place.as_ref().is_none_or(is_tighter) {
            *place = Some(side);
            if upper {
                self.upper = side.value;
            } else {
                self.lower = side.value;
            }
        }
        // Rows that meet except for rounding are an equality.
        self.lower = self.lower.min(self.upper);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of a reflection.
    const ROUNDING: f64 = 1e-14;

    fn rows(entries: &[(usize, usize, f64)]) -> SparseMatrix {
        SparseMatrix::from_triplets(3, 5, entries).unwrap()
    }

    /// Two oblique rows that share the travel 4, and a row of the travel alone.
    const PRESSED: [(usize, usize, f64); 7] =
        [(0, 0, 0.6), (0, 1, 0.8), (0, 4, 0.8), (1, 2, 3.0), (1, 4, 1.5), (2, 4, 2.0), (2, 3, 0.0)];

    #[test]
    fn the_unknown_of_a_row_is_its_displacement_and_its_share_of_the_travel() {
        let contact = rows(&PRESSED);
        let bounds = Bounds::of(&contact, &[1.0, 6.0, 8.0], vec![4]).unwrap();
        let u = [0.3, -0.7, 0.2, 9.0, 0.5];
        let mut w = u.to_vec();
        bounds.turn(&mut w);
        for (bound, (moved, length)) in bounds.bounds.iter().zip(contact.mul(&u).into_iter().zip([1.0, 3.0, 2.0])) {
            let sign = if bound.upper.is_finite() { 1.0 } else { -1.0 };
            assert!((sign * w[bound.unknown] - moved / length).abs() < ROUNDING, "{bound:?}");
        }
        assert_eq!((bounds.bounds[2].unknown, bounds.bounds[2].upper), (4, 4.0));
        // Work is the same in both: f'u = h'w.
        let f = [2.0, -1.0, 0.5, 0.25, 3.0];
        let mut h = f.to_vec();
        bounds.turn_forces(&mut h);
        let work = |f: &[f64], u: &[f64]| f.iter().zip(u).map(|(f, u)| f * u).sum::<f64>();
        assert!((work(&f, &u) - work(&h, &w)).abs() < ROUNDING);
        bounds.turn_back(&mut w);
        assert!(w.iter().zip(&u).all(|(back, u)| (back - u).abs() < ROUNDING));
    }

    #[test]
    fn rows_of_several_travels_and_of_different_ones_at_a_dof_are_no_bounds() {
        let of = |entries: &[(usize, usize, f64)], travels| Bounds::of(&rows(entries), &[1.0; 3], travels);
        assert!(of(&[(0, 0, 1.0), (0, 3, 1.0), (0, 4, 1.0)], vec![3, 4]).is_err());
        assert!(of(&[(0, 0, 1.0), (0, 4, 1.0), (1, 0, -1.0), (1, 4, 1.0)], vec![4]).is_err());
        assert!(of(&[(0, 0, 1.0), (0, 4, 1.0), (1, 0, -1.0)], vec![4]).is_err());
        assert!(of(&[(0, 0, 1.0), (0, 4, 1.0), (1, 0, -2.0), (1, 4, -2.0)], vec![4]).is_ok());
    }
}
