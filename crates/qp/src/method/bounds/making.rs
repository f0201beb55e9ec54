//! How rows become bounds, one after another.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use super::{Bound, Bounds, LeftOut, Side, are_equal, length, no_bound};
use crate::error::Result;
use crate::linear::multigrid::{Direction, Units};
use crate::linear::{SparseMatrix, ldexp};

/// Entries of a unit vector, and shares along a reflection, below this are rounding: they would wander along chains.
const TURNING_ROUNDING: f64 = 1e-12;

/// A row with less than this share beyond the span of others is left out: 3 degrees. A pivot has this share of a mean.
const LEAST_BEYOND: f64 = 0.05;

/// The same for a row that is needed. The bounds of rows with a small angle between them take more steps.
const LEAST_BEYOND_IF_NEEDED: f64 = 1e-4;

/// Rows that share coordinates with others have at most this many beyond them; a long chain of rows would fill up.
const MOST_BEYOND: usize = 24;

/// A row of more nodes is a mean.
const GROUPS_OF_A_PAIR: usize = 2;

struct Making<'a> {
    /// The rows, each a column, with their gaps.
    by_row: &'a SparseMatrix,
    gap: &'a [f64],
    /// The node of each dof, one entry per dof.
    groups: &'a [u32],
    all: Bounds,
    bound_of: Vec<Option<usize>>,
    /// The places that the shears of means contain: none of them becomes a pivot.
    carried: HashSet<usize>,
}

impl Bounds {
    /// The bounds that rows B (m x n) and gaps g give if the dofs have these `units` and `travels` have no stiffness.
    /// The rows are taken in the order that is preferred, of which the first are `needed`, means last. Those without
    /// entries or with an infinite gap give no bounds.
    pub fn of(
        (contact, gap): (&SparseMatrix, &[f64]),
        (order, needed): (&[usize], usize),
        units: &Units,
        travels: Vec<usize>,
    ) -> Result<Self> {
        let by_row = &contact.transposed();
        let mut means = means((by_row, gap), &units.groups, &travels);
        let is_unscaled = units.exponents.iter().all(|&unit| unit == 0);
        let given =
            Bounds { units: units.exponents.clone(), is_unscaled, travels, rows: gap.len(), ..Bounds::default() };
        loop {
            let (all, bound_of, carried) = (given.clone(), vec![None; given.units.len()], HashSet::new());
            let mut making = Making { by_row, gap, groups: &units.groups, all, bound_of, carried };
            let is_mean: HashSet<usize> = means.iter().copied().collect();
            for (place, &row) in order.iter().enumerate().filter(|entry| gap[*entry.1].is_finite()) {
                if !is_mean.contains(&row) {
                    making.turn(row, if place < needed { LEAST_BEYOND_IF_NEEDED } else { LEAST_BEYOND })?;
                }
            }
            let mut with_pivot = Vec::new();
            for &row in &means {
                if making.pivot(row)? {
                    with_pivot.push(row);
                }
            }
            if with_pivot.len() == means.len() {
                let mut all = making.all;
                let is_own = |bound: &Bound| bound.shears().next().is_none();
                all.is_plain = all.reflections.is_empty() && all.travels.is_empty() && all.bounds.iter().all(is_own);
                return Ok(all);
            }
            // Means without a pivot are turned as other rows are.
            means = with_pivot;
        }
    }

    /// Turns a unit vector onto the coordinate of its largest entry: that, and its sign there. `None` without entries.
    fn onto_one(&mut self, unit: Direction) -> Option<(usize, f64)> {
        let &(first, value) = unit.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        Some((first, if unit.len() == 1 { value.signum() } else { self.reflect(unit, first) }))
    }

    /// A unit vector after the reflections that touch it, in the order of the product H or, back, of H'.
    pub fn reflected(&self, vector: Direction, is_back: bool) -> Direction {
        if vector.len() == 1 && vector.iter().all(|entry| !self.touching.contains_key(&entry.0)) {
            return vector;
        }
        let mut entries: HashMap<usize, f64> = vector.into_iter().collect();
        let of_place = |place: &usize| self.touching.get(place).into_iter().flatten().copied();
        let mut waiting: BTreeSet<usize> = entries.keys().flat_map(of_place).collect();
        while let Some(next) = if is_back { waiting.pop_last() } else { waiting.pop_first() } {
            let follows = |other: &usize| (*other > next) != is_back && *other != next;
            let reflection = &self.reflections[next];
            let along: f64 = reflection.iter().map(|&(p, w)| w * entries.get(&p).copied().unwrap_or(0.0)).sum();
            if along.abs() <= TURNING_ROUNDING {
                continue;
            }
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
}

fn entries(by_row: &SparseMatrix, row: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
    by_row.column(row).filter(|entry| entry.1 != 0.0)
}

/// The rows of more nodes than a pair, first those whose heaviest node most touch: it can be a pivot only before them.
fn means((by_row, gap): (&SparseMatrix, &[f64]), groups: &[u32], travels: &[usize]) -> Vec<usize> {
    let (mut heaviest, mut touched) = (Vec::new(), HashMap::<u32, usize>::new());
    for row in (0..gap.len()).filter(|&row| gap[row].is_finite()) {
        let mut of_group = BTreeMap::<u32, f64>::new();
        for (dof, b) in entries(by_row, row).filter(|entry| travels.binary_search(&entry.0).is_err()) {
            let length = of_group.entry(groups[dof]).or_default();
            *length = length.hypot(b);
        }
        let Some((&first, _)) = of_group.iter().max_by(|a, b| a.1.total_cmp(b.1)) else { continue };
        if of_group.len() > GROUPS_OF_A_PAIR {
            heaviest.push((row, first));
            of_group.keys().for_each(|&group| *touched.entry(group).or_default() += 1);
        }
    }
    heaviest.sort_by_key(|(_, group)| std::cmp::Reverse(touched.get(group)));
    heaviest.into_iter().map(|(row, _)| row).collect()
}

impl Making<'_> {
    /// The length of a row in the units of the dofs, its unit vector after the reflections, and its travel.
    fn turned(&self, row: usize) -> Result<(f64, Direction, Direction)> {
        let is_travel = |entry: &(usize, f64)| self.all.travels.binary_search(&entry.0).is_ok();
        let entries = entries(self.by_row, row).map(|(dof, b)| (dof, ldexp(b, self.all.units[dof])));
        let (mut moving, mut entries): (Direction, Direction) = entries.partition(is_travel);
        if moving.len() > 1 {
            return Err(no_bound(row, "has several dofs without stiffness"));
        }
        if entries.is_empty() {
            // The row of a node that is held: a bound on the travel itself.
            std::mem::swap(&mut moving, &mut entries);
        }
        let length = length(&entries);
        let unit = entries.iter().map(|&(place, b)| (place, b / length)).collect();
        Ok((length, self.all.reflected(unit, false), moving))
    }

    /// Turns a row into a bound, if at least the share `least` of it is beyond the rows before it.
    fn turn(&mut self, row: usize, least: f64) -> Result<()> {
        let (length, turned, moving) = self.turned(row)?;
        let (shared, mut own): (Direction, Direction) =
            turned.into_iter().partition(|entry| self.bound_of[entry.0].is_some());
        if !shared.is_empty() && own.len() > MOST_BEYOND {
            return Err(no_bound(row, "shares dofs with too many others"));
        }
        let beyond = self::length(&own);
        // A row beyond others has a coordinate of its own; otherwise it may be parallel to the last of them.
        let (unknown, share) = if beyond > least {
            own.iter_mut().for_each(|entry| entry.1 /= beyond);
            let Some((first, sign)) = self.all.onto_one(own) else { return Ok(()) };
            (first, sign * beyond)
        } else if own.is_empty() {
            let Some(&last) = shared.iter().max_by_key(|entry| self.bound_of[entry.0]) else { return Ok(()) };
            last
        } else {
            self.leave_out(row, length, &shared);
            return Ok(());
        };
        let shears: Direction =
            shared.iter().filter(|entry| entry.0 != unknown).map(|&(place, c)| (place, c / share)).collect();
        let coefficient = share * length;
        let travel = moving.first().map(|&(travel, c)| (travel, c / coefficient));
        let index = *self.bound_of[unknown].get_or_insert(self.all.bounds.len());
        if index == self.all.bounds.len() {
            self.all.bounds.push(Bound::new(unknown, shears, travel));
        } else if !are_equal(&self.all.bounds[index].shears, &shears) {
            self.leave_out(row, length, &shared);
            return Ok(());
        }
        let bound = &mut self.all.bounds[index];
        if !are_equal(bound.travel.as_slice(), travel.as_slice()) {
            return Err(no_bound(row, "shares an unknown with one of another travel"));
        }
        bound.take(Side { row, coefficient, value: self.gap[row] / coefficient });
        Ok(())
    }

    /// Makes a mean a bound on its pivot, the direction at one node of what no other row has, if there is one.
    fn pivot(&mut self, row: usize) -> Result<bool> {
        let (length, turned, moving) = self.turned(row)?;
        let Some(group) = self.group_of_pivot(&turned) else { return Ok(false) };
        let (mut own, mut shears): (Direction, Direction) =
            turned.into_iter().partition(|entry| self.groups[entry.0] == group && self.may_be_pivot(entry.0));
        let beyond = self::length(&own);
        own.iter_mut().for_each(|entry| entry.1 /= beyond);
        let Some((unknown, sign)) = self.all.onto_one(own) else { return Ok(false) };
        let share = sign * beyond;
        shears.iter_mut().for_each(|entry| entry.1 /= share);
        self.carried.extend(shears.iter().map(|entry| entry.0));
        let coefficient = share * length;
        let travel = moving.first().map(|&(travel, c)| (travel, c / coefficient));
        let mut bound = Bound { is_mean: true, ..Bound::new(unknown, shears, travel) };
        bound.take(Side { row, coefficient, value: self.gap[row] / coefficient });
        self.bound_of[unknown] = Some(self.all.bounds.len());
        self.all.bounds.push(bound);
        Ok(true)
    }

    fn may_be_pivot(&self, place: usize) -> bool {
        self.bound_of[place].is_none() && !self.carried.contains(&place)
    }

    /// The node with most of what may be a pivot, in displacements: a soft node counts no more than a stiff one.
    fn group_of_pivot(&self, turned: &Direction) -> Option<u32> {
        let (mut of_group, mut whole) = (BTreeMap::<u32, f64>::new(), 0.0_f64);
        for &(place, c) in turned {
            let c = ldexp(c, -self.all.units[place]);
            whole = whole.hypot(c);
            if self.may_be_pivot(place) {
                let length = of_group.entry(self.groups[place]).or_default();
                *length = length.hypot(c);
            }
        }
        let heaviest = of_group.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        (heaviest.1 > LEAST_BEYOND * whole).then_some(heaviest.0)
    }

    /// Leaves a row out, `length` times a vector with entries on the coordinates of bounds, `shared`.
    fn leave_out(&mut self, row: usize, length: f64, shared: &Direction) {
        let of_place = |&(place, c): &(usize, f64)| self.bound_of[place].map(|index| (index, c * length));
        let mut rest: BTreeMap<usize, f64> = shared.iter().filter_map(of_place).collect();
        let mut shares = Vec::new();
        while let Some((index, share)) = rest.pop_last() {
            shares.push((index, share));
            for (before, c) in self.all.bounds[index].shears.iter().filter_map(of_place) {
                *rest.entry(before).or_insert(0.0) -= share * c / length;
            }
        }
        self.all.left_out.push(LeftOut { row, shares });
    }
}
