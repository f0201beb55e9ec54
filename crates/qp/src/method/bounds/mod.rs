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
#[derive(Clone, Debug, Default)]
pub struct Bounds {
    units: Vec<i32>,
    is_unscaled: bool,
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

impl Bounds {
    /// The rows that contradict a violated row that was left out, with weights; `None` if one of its bounds is open.
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

    /// The rows that a row takes force from if it presses, with the force of it that leaves them none.
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
            true => Hold::of(self.reflected(row, true)),
            false => Hold { way: self.reflected(way, true), row: self.reflected(row, true) },
        };
        holds.into_iter().map(back).collect()
    }

    /// The multipliers of the rows if the forces out of balance on bounded unknowns are `force`, and the closed rows.
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

/// Two shares are equal if they differ by no more than this share.
const EQUAL_SHARES: f64 = 1e-12;

fn are_equal(a: &[(usize, f64)], b: &[(usize, f64)]) -> bool {
    let is_near = |((p, a), (q, b)): (&(usize, f64), &(usize, f64))| p == q && (a - b).abs() <= EQUAL_SHARES * a.abs();
    a.len() == b.len() && a.iter().zip(b).all(is_near)
}

fn length(vector: &Direction) -> f64 {
    vector.iter().fold(0.0, |length: f64, entry| length.hypot(entry.1))
}

fn no_bound(row: usize, what: &str) -> Error {
    let reason = format!("contact row {row} (index from 0) {what}; another method must take them");
    LinearError::Numerical { step: "turning contact rows into bounds", reason }.into()
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
    use crate::linear::multigrid::Units;
    use crate::linear::{SparseMatrix, dot};

    type Entries<'a> = &'a [(usize, usize, f64)];

    /// Rounding of shears with shares up to 10.
    const ROUNDING: f64 = 1e-12;

    fn rows(entries: Entries) -> SparseMatrix {
        SparseMatrix::from_triplets(3, 5, entries).unwrap()
    }

    /// The bounds in other units, because every test is independent of them.
    fn of(entries: Entries, gap: [f64; 3], travels: &[usize]) -> Result<Bounds, Error> {
        let units = Units { groups: vec![0, 0, 1, 2, 3], exponents: vec![1, 1, 3, 0, 0] };
        Bounds::of((&rows(entries), &gap), (&[0, 1, 2], 0), &units, travels.to_vec())
    }

    /// Two oblique rows that share the travel 4, and a row of the travel alone.
    const PRESSED: Entries =
        &[(0, 0, 0.6), (0, 1, 0.8), (0, 4, 0.8), (1, 2, 3.0), (1, 4, 1.5), (2, 4, 2.0), (2, 3, 0.0)];

    const OBLIQUE: Entries =
        &[(0, 0, 3.0), (1, 0, 0.6), (1, 1, 0.8), (2, 0, 1.0), (2, 1, -1.0), (2, 2, 0.5), (2, 4, 2.0)];

    /// Two means of the node with the dofs 0 and 1, and a row of the node with dof 2.
    #[rustfmt::skip]
    const MEANS: Entries = &[
        (0, 0, 0.6), (0, 1, 0.8), (0, 2, -0.4), (0, 3, -0.6), (1, 0, 1.0), (1, 2, -0.9), (1, 3, -0.3), (1, 4, 0.2),
        (2, 2, -2.0),
    ];

    /// Means whose heaviest node is 2: the second has no node beside those of the first, and is turned as other rows
    /// are.
    const WITHOUT_PIVOT: Entries = &[(0, 2, 0.5), (0, 3, 1.0), (0, 4, 0.5), (1, 2, 0.5), (1, 3, 1.0), (1, 4, -0.5)];

    /// The unknowns are the rows, forces and displacements turn there and back, and every hold gives way to itself
    /// alone, so that what the ways leave of a displacement without travels moves no row.
    #[test]
    fn unknowns_are_the_rows_with_their_travels_and_what_is_held_moves_no_row() {
        let cases: [(Entries, &[usize], &[bool]); 4] = [
            (PRESSED, &[4], &[false; 3]),
            (OBLIQUE, &[4], &[false; 3]),
            (MEANS, &[], &[false, true, true]),
            (WITHOUT_PIVOT, &[], &[false, true]),
        ];
        let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < ROUNDING);
        for (entries, travels, means) in cases {
            let (contact, gap, bounds) =
                (rows(entries), [1.0, 6.0, 8.0], of(entries, [1.0, 6.0, 8.0], travels).unwrap());
            assert_eq!(bounds.bounds.iter().map(|bound| bound.is_mean).collect::<Vec<_>>(), means);
            let (u, mut f) = ([0.3, -0.7, 0.2, 9.0, 0.5], [2.0, -1.0, 0.5, 0.25, 3.0]);
            let (mut w, mut h) = (u.to_vec(), f.to_vec());
            bounds.turn(&mut w);
            bounds.turn_forces(&mut h);
            assert!((dot(&f, &u) - dot(&h, &w)).abs() < ROUNDING);
            for bound in &bounds.bounds {
                let Side { row, coefficient, value } = *bound.sides.iter().flatten().next().unwrap();
                assert!((coefficient * w[bound.unknown] - contact.mul(&u)[row]).abs() < ROUNDING, "{bound:?}");
                assert!((coefficient * value - gap[row]).abs() < ROUNDING, "{bound:?}");
            }
            bounds.turn_back(&mut w);
            bounds.turn_forces_back(&mut h);
            travels.iter().for_each(|&travel| f[travel] = 0.0);
            assert!(near(&w, &u) && near(&h, &f));
            let (holds, mut moved) = (bounds.holds(bounds.bounds.iter()), u.to_vec());
            travels.iter().for_each(|&travel| moved[travel] = 0.0);
            bounds.scale(&mut moved, -1);
            let before = moved.clone();
            for (index, hold) in holds.iter().enumerate() {
                let along = |v: &[f64]| hold.row.iter().map(|&(place, c)| c * v[place]).sum::<f64>();
                for (other, Hold { way, .. }) in holds.iter().enumerate() {
                    let mut dense = [0.0; 5];
                    way.iter().for_each(|&(place, c)| dense[place] = c);
                    assert!((along(&dense) - f64::from(u8::from(index == other))).abs() < ROUNDING, "{index} {other}");
                }
                hold.way.iter().for_each(|&(place, c)| moved[place] -= c * along(&before));
            }
            bounds.scale(&mut moved, 1);
            assert!(contact.mul(&moved).iter().all(|moved| moved.abs() < 10.0 * ROUNDING), "{:?}", contact.mul(&moved));
        }
    }

    #[test]
    fn a_row_that_depends_on_others_is_left_out_and_relieves_those_that_press_against_it() {
        let (gap, u) = ([1.0, 2.0, -3.0], [0.3, -0.7, 0.2, 9.0, 0.5]);
        let dependent = [(0, 0, 3.0), (1, 0, 0.6), (1, 1, 0.8), (2, 0, 1.0), (2, 1, -1.0)];
        let bounds = of(&dependent, gap, &[]).unwrap();
        assert_eq!((bounds.bounds.len(), bounds.left_out.len(), bounds.most_joined()), (2, 1, 2));
        let mut w = u.to_vec();
        bounds.turn(&mut w);
        let value: f64 = bounds.left_out[0].shares.iter().map(|&(i, share)| share * w[bounds.bounds[i].unknown]).sum();
        assert!((value - rows(&dependent).mul(&u)[2]).abs() < ROUNDING);
        // Row 2 is 7/12 of row 0 less 5/4 of row 1: only row 0 is relieved.
        let relieved: Vec<_> = bounds.relieved(&bounds.left_out[0], &[-3.0, -5.0, 0.0]).collect();
        assert!(relieved.len() == 1 && relieved[0].0 == 0 && (relieved[0].1 + 36.0 / 7.0).abs() < ROUNDING);
        let nearly_parallel = [(0, 0, 1.0), (1, 0, 1.0), (1, 1, 1e-3), (2, 1, 1.0)];
        assert_eq!(of(&nearly_parallel, gap, &[]).unwrap().left_out[0].row, 1);
    }

    #[test]
    fn rows_of_several_travels_and_of_different_ones_at_a_dof_are_no_bounds() {
        let is_bounded = |entries: Entries, travels| of(entries, [1.0; 3], travels).is_ok();
        assert!(!is_bounded(&[(0, 0, 1.0), (0, 3, 1.0), (0, 4, 1.0)], &[3, 4]));
        assert!(!is_bounded(&[(0, 0, 1.0), (0, 4, 1.0), (1, 0, -1.0), (1, 4, 1.0)], &[4]));
        assert!(!is_bounded(&[(0, 0, 1.0), (0, 4, 1.0), (1, 0, -1.0)], &[4]));
        assert!(is_bounded(&[(0, 0, 1.0), (0, 4, 1.0), (1, 0, -2.0), (1, 4, -2.0)], &[4]));
    }
}
