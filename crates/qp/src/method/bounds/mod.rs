//! Rows as bounds: reflections and shears that turn every row into one unknown of its own.
//!
//! A reflection turns what a row has beyond the rows before it onto a coordinate v of its own; a shear adds the rest,
//! the coordinates of those rows: `w = v + sum of s_j v_j`. This is a QR factorisation of the rows, so that independent
//! rows of a node become bounds whatever their angles are. Rows that depend on others, or nearly so, are *left out*:
//! the caller must look whether the answer meets them, and prefer those that it violates the next time.
//!
//! The rows between two meshes that do not match are *means*: each joins one node of its own with many that it shares
//! with others. There a reflection would fill up. A mean becomes the unknown of a *pivot*, the direction in which it
//! moves its own node, and a shear adds all the rest: `w = v_pivot + sum of s_k v_k`. No pivot stands in the shear of a
//! mean before it.
//!
//! Rows may share a *travel*, a dof t without stiffness: `n'u + c t <= g`. It is a coordinate of its own, and a shear
//! adds it in the same way. Forces along t then add up those of all its rows.

mod making;

use std::collections::{BTreeSet, HashMap};

use crate::error::{Error, LinearError};
use crate::linear::ldexp;
use crate::linear::multigrid::{Direction, Hold};
use crate::solution::ContactSet;

/// A row on one side of its unknown: `coefficient * v <= gap`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Side {
    row: usize,
    coefficient: f64,
    value: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// The unknown, after reflections and shears.
    pub unknown: usize,
    /// The least value, `-inf` without a lower bound.
    pub lower: f64,
    /// The greatest value, `+inf` without an upper bound.
    pub upper: f64,
    /// The travel t that the unknown contains, and its share s: `w = v + s t`.
    pub travel: Option<(usize, f64)>,
    /// The same for the coordinates of bounds before it; of a mean for all coordinates beside its pivot.
    shears: Direction,
    is_mean: bool,
    sides: [Option<Side>; 2],
}

/// All rows in the order in which they become bounds.
#[derive(Clone, Debug)]
pub struct Preferred {
    pub rows: Vec<usize>,
    /// Number of rows that are needed; they come first.
    pub needed: usize,
}

/// A row that is no bound, because it depends on bounds, at least nearly.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    pub row: usize,
    /// The bounds on which it depends, with the shares of their unknowns in it.
    pub shares: Vec<(usize, f64)>,
}

/// Reflects v at a unit vector w, in place: `v -= 2 w (w'v)`.
fn reflect(w: &Direction, v: &mut [f64]) {
    let along: f64 = w.iter().map(|&(place, w)| w * v[place]).sum();
    w.iter().for_each(|&(place, w)| v[place] -= 2.0 * along * w);
}

/// Rows B u <= g as bounds on unknowns w = S H U^-1 u. U are the units of the dofs, powers of two. H is orthogonal: a
/// product of one reflection for each row that has more than one entry beyond the rows before it and travels. S are the
/// shears.
#[derive(Clone, Debug)]
pub struct Bounds {
    /// The exponent of the unit of each dof.
    units: Vec<i32>,
    /// `true` if all units are 1.
    is_unscaled: bool,
    /// The unit vector of each reflection.
    reflections: Vec<Direction>,
    touching: HashMap<usize, Vec<usize>>,
    pub bounds: Vec<Bound>,
    /// `true` if all rows are bounds on single dofs, and nothing travels.
    pub is_plain: bool,
    /// The travels, the dofs without stiffness.
    pub travels: Vec<usize>,
    pub left_out: Vec<LeftOut>,
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
    /// The rows that contradict a row of those left out, which is violated, with weights; `None` if one of the bounds
    /// on which it depends is open.
    pub fn contradicting(&self, left: &LeftOut, multiplier: &[f64]) -> Option<Vec<(usize, f64)>> {
        let of_share = |&(index, share): &(usize, f64)| {
            let pressed = self.bounds[index].sides.iter().flatten().find(|side| multiplier[side.row] < 0.0)?;
            Some((pressed.row, -share / pressed.coefficient))
        };
        let others: Option<Vec<(usize, f64)>> =
            left.shares.iter().filter(|entry| entry.1 != 0.0).map(of_share).collect();
        let mut all = [others?, vec![(left.row, 1.0)]].concat();
        all.sort_unstable_by_key(|entry| entry.0);
        Some(all)
    }

    /// The rows under pressure that a row takes force from if it presses itself, with the force of it that leaves them
    /// none.
    pub fn relieved<'a>(&'a self, by: &'a LeftOut, multiplier: &'a [f64]) -> impl Iterator<Item = (usize, f64)> + 'a {
        by.shares.iter().flat_map(move |&(index, share)| {
            let of_side = move |side: &Side| (side.row, multiplier[side.row] * side.coefficient / share);
            self.bounds[index].sides.iter().flatten().map(of_side).filter(|entry| entry.1 < 0.0)
        })
    }

    /// The bounds in their order whose unknowns are no dofs; none if all rows are bounds on single dofs.
    fn joined(&self) -> impl DoubleEndedIterator<Item = &Bound> {
        (if self.is_plain { &[] } else { &self.bounds[..] }).iter()
    }

    /// The unknowns w = S H U^-1 u of a displacement u, in place.
    pub fn turn(&self, v: &mut [f64]) {
        self.scale(v, -1);
        self.reflections.iter().for_each(|reflection| reflect(reflection, v));
        for bound in self.joined().rev() {
            bound.shears().for_each(|(place, share)| v[bound.unknown] += share * v[place]);
        }
    }

    /// The displacement U H' S^-1 w of unknowns w, in place.
    pub fn turn_back(&self, v: &mut [f64]) {
        for bound in self.joined() {
            bound.shears().for_each(|(place, share)| v[bound.unknown] -= share * v[place]);
        }
        self.reflections.iter().rev().for_each(|reflection| reflect(reflection, v));
        self.scale(v, 1);
    }

    /// The forces S^-T H U f along the unknowns of forces f along the dofs, in place.
    pub fn turn_forces(&self, f: &mut [f64]) {
        self.scale(f, 1);
        self.reflections.iter().for_each(|reflection| reflect(reflection, f));
        for bound in self.joined().rev() {
            bound.shears().for_each(|(place, share)| f[place] -= share * f[bound.unknown]);
        }
    }

    /// The forces U^-1 H' S' h along the dofs of forces h along the unknowns, in place; none along travels.
    pub fn turn_forces_back(&self, h: &mut [f64]) {
        for bound in self.joined() {
            bound.shears().for_each(|(place, share)| h[place] += share * h[bound.unknown]);
        }
        self.travels.iter().for_each(|&travel| h[travel] = 0.0);
        self.reflections.iter().rev().for_each(|reflection| reflect(reflection, h));
        self.scale(h, -1);
    }

    /// Multiplies values of the dofs by their units to a power, 1 or -1.
    pub fn scale(&self, values: &mut [f64], power: i32) {
        if self.is_unscaled {
            return;
        }
        values.iter_mut().zip(&self.units).for_each(|(value, &unit)| *value = ldexp(*value, power * unit));
    }

    /// The diagonal of a matrix (n x n) in the unknowns, from its own: only the reflections are ignored.
    pub fn turned_diagonal(&self, mut diagonal: Vec<f64>) -> Vec<f64> {
        self.scale(&mut diagonal, 1);
        self.scale(&mut diagonal, 1);
        for bound in self.bounds.iter().rev() {
            bound.shears().for_each(|(place, share)| diagonal[place] += share * share * diagonal[bound.unknown]);
        }
        diagonal
    }

    /// Largest number of unknowns beside a travel that a shear joins.
    pub fn most_joined(&self) -> usize {
        self.bounds.iter().map(|bound| 1 + bound.shears.len()).max().unwrap_or(1)
    }

    /// What some bounds hold, in the order of all bounds, without their travels, in the units of the dofs: orthonormal
    /// vectors H' q that span the rows; of a mean its pivot, which gives way, and the row without what the holds before
    /// it hold.
    pub fn holds<'a>(&self, of_bounds: impl Iterator<Item = &'a Bound>) -> Vec<Hold> {
        if self.is_plain {
            return of_bounds.map(|bound| Hold::of(vec![(bound.unknown, 1.0)])).collect();
        }
        let (mut holds, mut touching) = (Vec::<Hold>::new(), HashMap::<usize, Vec<usize>>::new());
        for bound in of_bounds {
            let mut rest: HashMap<usize, f64> = bound.shears.iter().copied().chain([(bound.unknown, 1.0)]).collect();
            let before: BTreeSet<usize> =
                rest.keys().filter_map(|place| touching.get(place)).flatten().copied().collect();
            for other in before {
                let Hold { way, row } = &holds[other];
                let along: f64 = way.iter().map(|&(p, q)| q * rest.get(&p).copied().unwrap_or(0.0)).sum();
                row.iter().for_each(|&(place, q)| *rest.entry(place).or_insert(0.0) -= along * q);
            }
            let mut row: Direction = rest.into_iter().collect();
            row.sort_unstable_by_key(|entry| entry.0);
            let hold = if bound.is_mean {
                Hold { way: vec![(bound.unknown, 1.0)], row }
            } else {
                let length = length(&row);
                row.iter_mut().for_each(|entry| entry.1 /= length);
                Hold::of(row)
            };
            hold.way.iter().for_each(|entry| touching.entry(entry.0).or_default().push(holds.len()));
            holds.push(hold);
        }
        let back = |Hold { way, row }: Hold| match way == row {
            true => Hold::of(self.reflected(row, Order::Backward)),
            false => Hold { way: self.reflected(way, Order::Backward), row: self.reflected(row, Order::Backward) },
        };
        holds.into_iter().map(back).collect()
    }

    /// The multipliers of the rows if the forces on the unknowns with bounds are `force` (those out of balance there),
    /// and the rows that are closed.
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

fn are_equal(a: &Direction, b: &Direction) -> bool {
    let is_near = |((p, a), (q, b)): (&(usize, f64), &(usize, f64))| p == q && (a - b).abs() <= EQUAL_SHARES * a.abs();
    a.len() == b.len() && a.iter().zip(b).all(is_near)
}

fn length(vector: &Direction) -> f64 {
    vector.iter().fold(0.0, |length: f64, entry| length.hypot(entry.1))
}

fn no_bound(what: String) -> Error {
    LinearError::Numerical {
        step: "turning contact rows into bounds",
        reason: format!("{what}; another method must take them"),
    }
    .into()
}

impl Bound {
    /// An unknown without bounds yet, of rows that are no mean.
    fn new(unknown: usize, shears: Direction, travel: Option<(usize, f64)>) -> Self {
        let (lower, upper) = (f64::NEG_INFINITY, f64::INFINITY);
        Bound { unknown, lower, upper, travel, shears, is_mean: false, sides: [None; 2] }
    }

    /// The coordinates that the unknown contains beside its own, with their shares.
    fn shears(&self) -> impl Iterator<Item = (usize, f64)> {
        self.shears.iter().copied().chain(self.travel)
    }

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
    use crate::linear::SparseMatrix;
    use crate::linear::multigrid::Units;

    const ROUNDING: f64 = 1e-14;

    /// Rounding of shears with shares up to 10.
    const OF_SHEARS: f64 = 1e-12;

    fn rows(entries: &[(usize, usize, f64)]) -> SparseMatrix {
        SparseMatrix::from_triplets(3, 5, entries).unwrap()
    }

    /// Two oblique rows that share the travel 4, and a row of the travel alone.
    const PRESSED: [(usize, usize, f64); 7] =
        [(0, 0, 0.6), (0, 1, 0.8), (0, 4, 0.8), (1, 2, 3.0), (1, 4, 1.5), (2, 4, 2.0), (2, 3, 0.0)];

    /// The bounds in other units, because every test is independent of them.
    fn of(contact: &SparseMatrix, gap: &[f64], travels: Vec<usize>) -> Result<Bounds, Error> {
        let units = Units { groups: vec![0, 0, 1, 2, 3], exponents: vec![1, 1, 3, 0, 0] };
        Bounds::of((contact, gap), &Preferred { rows: vec![0, 1, 2], needed: 0 }, &units, travels)
    }

    #[test]
    fn the_unknown_of_a_row_is_its_displacement_and_its_share_of_the_travel() {
        let contact = rows(&PRESSED);
        let bounds = of(&contact, &[1.0, 6.0, 8.0], vec![4]).unwrap();
        let u = [0.3, -0.7, 0.2, 9.0, 0.5];
        let mut w = u.to_vec();
        bounds.turn(&mut w);
        for (bound, (moved, length)) in bounds.bounds.iter().zip(contact.mul(&u).into_iter().zip([2.0, 24.0, 2.0])) {
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
    fn oblique_rows_are_bounds_and_a_row_that_depends_on_them_is_left_out() {
        let entries = [(0, 0, 3.0), (1, 0, 0.6), (1, 1, 0.8), (2, 0, 1.0), (2, 1, -1.0), (2, 2, 0.5), (2, 4, 2.0)];
        let (contact, gap) = (rows(&entries), [1.0, 2.0, -3.0]);
        let bounds = of(&contact, &gap, vec![4]).unwrap();
        assert_eq!((bounds.bounds.len(), bounds.most_joined()), (3, 3));
        let u = [0.3, -0.7, 0.2, 9.0, 0.5];
        let mut w = u.to_vec();
        bounds.turn(&mut w);
        for ((bound, moved), gap) in bounds.bounds.iter().zip(contact.mul(&u)).zip(gap) {
            let coefficient = bound.sides.iter().flatten().next().unwrap().coefficient;
            assert!((coefficient * w[bound.unknown] - moved).abs() < ROUNDING, "{bound:?}");
            assert!((coefficient * bound.sides.iter().flatten().next().unwrap().value - gap).abs() < ROUNDING);
        }
        // Forces there and back, if none travel.
        let f = [2.0, -1.0, 0.5, 0.25, 0.0];
        let mut h = f.to_vec();
        bounds.turn_forces(&mut h);
        let work = |f: &[f64], u: &[f64]| f.iter().zip(u).map(|(f, u)| f * u).sum::<f64>();
        assert!((work(&f, &u) - work(&h, &w)).abs() < ROUNDING);
        bounds.turn_forces_back(&mut h);
        assert!(h.iter().zip(&f).all(|(back, f)| (back - f).abs() < ROUNDING));
        bounds.turn_back(&mut w);
        assert!(w.iter().zip(&u).all(|(back, u)| (back - u).abs() < ROUNDING));
        // The directions of two rows are orthonormal and span both rows, in the units of the dofs.
        let directions: Vec<Direction> =
            bounds.holds(bounds.bounds[1..].iter()).into_iter().map(|hold| hold.row).collect();
        let dot = |a: &Direction, b: &Direction| -> f64 {
            a.iter().map(|&(p, a)| a * b.iter().find(|entry| entry.0 == p).map_or(0.0, |entry| entry.1)).sum()
        };
        for (i, j) in (0..2).flat_map(|i| (0..2).map(move |j| (i, j))) {
            assert!((dot(&directions[i], &directions[j]) - f64::from(u8::from(i == j))).abs() < ROUNDING);
        }
        for row in [vec![(0, 1.2), (1, 1.6)], vec![(0, 2.0), (1, -2.0), (2, 4.0)]] {
            let beyond = directions.iter().fold(dot(&row, &row), |rest, direction| rest - dot(&row, direction).powi(2));
            assert!(beyond.abs() < 100.0 * ROUNDING, "{beyond:e}");
        }
        let dependent = [(0, 0, 3.0), (1, 0, 0.6), (1, 1, 0.8), (2, 0, 1.0), (2, 1, -1.0)];
        let bounds = of(&rows(&dependent), &gap, Vec::new()).unwrap();
        assert_eq!((bounds.bounds.len(), bounds.left_out.len()), (2, 1));
        let mut w = u.to_vec();
        bounds.turn(&mut w);
        let value: f64 = bounds.left_out[0].shares.iter().map(|&(i, share)| share * w[bounds.bounds[i].unknown]).sum();
        assert!((value - rows(&dependent).mul(&u)[2]).abs() < ROUNDING);
        // Row 2 is 7/12 of row 0 less 5/4 of row 1: only row 0 is relieved.
        let relieved: Vec<_> = bounds.relieved(&bounds.left_out[0], &[-3.0, -5.0, 0.0]).collect();
        assert!(relieved.len() == 1 && relieved[0].0 == 0 && (relieved[0].1 + 36.0 / 7.0).abs() < ROUNDING);
        let nearly_parallel = [(0, 0, 1.0), (1, 0, 1.0), (1, 1, 1e-3), (2, 1, 1.0)];
        assert_eq!(of(&rows(&nearly_parallel), &gap, Vec::new()).unwrap().left_out[0].row, 1);
    }

    /// Two means of the node with the dofs 0 and 1, and a row of the node with dof 2.
    const MEANS: [(usize, usize, f64); 9] = [
        (0, 0, 0.6),
        (0, 1, 0.8),
        (0, 2, -0.4),
        (0, 3, -0.6),
        (1, 0, 1.0),
        (1, 2, -0.9),
        (1, 3, -0.3),
        (1, 4, 0.2),
        (2, 2, -2.0),
    ];

    /// Checks that the unknowns are the rows, that forces and displacements turn there and back, and that every hold
    /// gives way to itself alone, so that what the ways leave of a displacement moves no row.
    #[track_caller]
    fn check(contact: &SparseMatrix, bounds: &Bounds) {
        let (u, f) = ([0.3, -0.7, 0.2, 9.0, 0.5], [2.0, -1.0, 0.5, 0.25, 3.0]);
        let (mut w, mut h) = (u.to_vec(), f.to_vec());
        bounds.turn(&mut w);
        bounds.turn_forces(&mut h);
        for bound in &bounds.bounds {
            let Side { row, coefficient, .. } = *bound.sides.iter().flatten().next().unwrap();
            assert!((coefficient * w[bound.unknown] - contact.mul(&u)[row]).abs() < OF_SHEARS, "{bound:?}");
        }
        let work = |f: &[f64], u: &[f64]| f.iter().zip(u).map(|(f, u)| f * u).sum::<f64>();
        assert!((work(&f, &u) - work(&h, &w)).abs() < OF_SHEARS);
        bounds.turn_back(&mut w);
        bounds.turn_forces_back(&mut h);
        assert!(w.iter().zip(&u).chain(h.iter().zip(&f)).all(|(back, before)| (back - before).abs() < OF_SHEARS));
        let holds = bounds.holds(bounds.bounds.iter());
        let mut moved = u.to_vec();
        bounds.scale(&mut moved, -1);
        let before = moved.clone();
        for (index, hold) in holds.iter().enumerate() {
            let along = |v: &[f64]| hold.row.iter().map(|&(place, c)| c * v[place]).sum::<f64>();
            for (other, Hold { way, .. }) in holds.iter().enumerate() {
                let mut dense = [0.0; 5];
                way.iter().for_each(|&(place, c)| dense[place] = c);
                assert!((along(&dense) - f64::from(u8::from(index == other))).abs() < OF_SHEARS, "{index} {other}");
            }
            hold.way.iter().for_each(|&(place, c)| moved[place] -= c * along(&before));
        }
        bounds.scale(&mut moved, 1);
        assert!(contact.mul(&moved).iter().all(|moved| moved.abs() < 10.0 * OF_SHEARS), "{:?}", contact.mul(&moved));
    }

    #[test]
    fn means_are_bounds_on_pivots_beside_other_rows() {
        let contact = rows(&MEANS);
        let bounds = of(&contact, &[1.0, 2.0, 3.0], Vec::new()).unwrap();
        assert!(bounds.bounds.len() == 3 && bounds.bounds.iter().all(|bound| bound.unknown < 3), "{bounds:?}");
        assert_eq!(bounds.bounds.iter().filter(|bound| bound.is_mean).count(), 2);
        check(&contact, &bounds);
    }

    #[test]
    fn a_mean_without_a_pivot_is_turned_as_other_rows() {
        // The heaviest node of both is 2, and the second has no node beside those of the first.
        let contact = rows(&[(0, 2, 0.5), (0, 3, 1.0), (0, 4, 0.5), (1, 2, 0.5), (1, 3, 1.0), (1, 4, -0.5)]);
        let bounds = of(&contact, &[1.0; 3], Vec::new()).unwrap();
        assert_eq!(bounds.bounds.iter().map(|bound| bound.is_mean).collect::<Vec<_>>(), [false, true]);
        check(&contact, &bounds);
    }

    #[test]
    fn rows_of_several_travels_and_of_different_ones_at_a_dof_are_no_bounds() {
        let of = |entries: &[(usize, usize, f64)], travels| of(&rows(entries), &[1.0; 3], travels);
        assert!(of(&[(0, 0, 1.0), (0, 3, 1.0), (0, 4, 1.0)], vec![3, 4]).is_err());
        assert!(of(&[(0, 0, 1.0), (0, 4, 1.0), (1, 0, -1.0), (1, 4, 1.0)], vec![4]).is_err());
        assert!(of(&[(0, 0, 1.0), (0, 4, 1.0), (1, 0, -1.0)], vec![4]).is_err());
        assert!(of(&[(0, 0, 1.0), (0, 4, 1.0), (1, 0, -2.0), (1, 4, -2.0)], vec![4]).is_ok());
    }
}
