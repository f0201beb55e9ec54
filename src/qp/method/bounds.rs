//! Rows as bounds: reflections that turn every row onto one unknown of its own.

use std::collections::{BTreeSet, HashMap};

use crate::error::Error;
use crate::qp::linear::SparseMatrix;
use crate::qp::linear::multigrid::Direction;
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
    sides: [Option<Side>; 2],
}

/// `v -= 2 w (w'v)`.
#[derive(Clone, Debug)]
struct Reflection {
    vector: Direction,
}

impl Reflection {
    fn apply(&self, v: &mut [f64]) {
        let along: f64 = self.vector.iter().map(|&(place, w)| w * v[place]).sum();
        self.vector.iter().for_each(|&(place, w)| v[place] -= 2.0 * along * w);
    }
}

/// Rows B u <= g as bounds on unknowns v = H u, with H orthogonal: a product of one reflection for each row that has more
/// than one entry.
#[derive(Clone, Debug)]
pub struct Bounds {
    reflections: Vec<Reflection>,
    /// The reflections that touch each place.
    touching: HashMap<usize, Vec<usize>>,
    bounds: Vec<Bound>,
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
    /// The bounds that rows B (m x n) and gaps g give. Rows without entries or with an infinite gap give none.
    ///
    /// # Errors
    /// [`Error::Numerical`] for two rows that share an unknown and are neither parallel nor orthogonal: no rotation makes them
    /// bounds.
    pub fn of(contact: &SparseMatrix, gap: &[f64]) -> Result<Self, Error> {
        let by_row = contact.transposed();
        let mut all = Bounds { reflections: Vec::new(), touching: HashMap::new(), bounds: Vec::new(), rows: gap.len() };
        let mut bound_of: Vec<Option<usize>> = vec![None; contact.columns()];
        for row in (0..gap.len()).filter(|&row| gap[row].is_finite()) {
            let entries: Vec<(usize, f64)> = by_row.column(row).filter(|entry| entry.1 != 0.0).collect();
            let length = entries.iter().fold(0.0, |length: f64, entry| length.hypot(entry.1));
            let turned = all.reflected(entries.iter().map(|&(place, b)| (place, b / length)).collect(), Order::Forward);
            let Some(&(first, _)) = turned.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())) else { continue };
            let taken: Vec<usize> = turned.iter().filter_map(|entry| bound_of[entry.0]).collect();
            let index = match (taken[..].first(), turned.len()) {
                (Some(&index), 1) => index,
                (Some(&index), _) => {
                    let other = all.bounds[index].sides.iter().flatten().next().map_or(0, |side| side.row);
                    let reason = format!(
                        "contact rows {other} and {row} (indices from 0) share an unknown and are neither parallel nor at \
                         right angles; another method must take them"
                    );
                    return Err(Error::Numerical { step: "turning contact rows into bounds", reason });
                }
                (None, _) => {
                    bound_of[first] = Some(all.bounds.len());
                    let (lower, upper) = (f64::NEG_INFINITY, f64::INFINITY);
                    all.bounds.push(Bound { unknown: first, lower, upper, sides: [None; 2] });
                    all.bounds.len() - 1
                }
            };
            let sign = if turned.len() == 1 { turned[0].1.signum() } else { all.reflect(turned, first) };
            let coefficient = sign * length;
            all.bounds[index].take(Side { row, coefficient, value: gap[row] / coefficient });
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
        let first = |waiting: &mut BTreeSet<usize>| match order {
            Order::Forward => waiting.pop_first(),
            Order::Backward => waiting.pop_last(),
        };
        let follows = |other: usize, next: usize| match order {
            Order::Forward => other > next,
            Order::Backward => other < next,
        };
        while let Some(next) = first(&mut waiting) {
            let reflection = &self.reflections[next].vector;
            let along: f64 = reflection.iter().map(|&(p, w)| w * entries.get(&p).copied().unwrap_or(0.0)).sum();
            for &(place, w) in reflection {
                *entries.entry(place).or_insert(0.0) -= 2.0 * along * w;
                waiting.extend(of_place(&place).filter(|&other| follows(other, next)));
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
        self.reflections.push(Reflection { vector: unit });
        -own.signum()
    }

    /// The bounds.
    pub fn bounds(&self) -> &[Bound] {
        &self.bounds
    }

    /// Returns `true` if all rows are bounds without a reflection.
    pub fn is_plain(&self) -> bool {
        self.reflections.is_empty()
    }

    /// H u in place.
    pub fn turn(&self, v: &mut [f64]) {
        self.reflections.iter().for_each(|reflection| reflection.apply(v));
    }

    /// H' v in place.
    pub fn turn_back(&self, v: &mut [f64]) {
        self.reflections.iter().rev().for_each(|reflection| reflection.apply(v));
    }

    /// The unit vector along which the unknown of a bound moves: its column of H'.
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

impl Bound {
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
