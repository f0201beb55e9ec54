//! The state of MPRGP, and the steps that it takes.

use std::cell::OnceCell;

use crate::linear::multigrid::{Face, Hold, Multigrid};
use crate::linear::{Spare, dot, largest};
use crate::method::Start;
use crate::method::bounds::{Bound, Bounds};
use crate::problem::ContactProblem;
use crate::solution::Iteration;

/// Rows that are open at the start although nothing has moved keep this share of their depth as distance.
const INSIDE: f64 = 1e-3;

/// The energy of a direction is rounding of zero below this share of the energy of its unknowns one by one.
const NO_ENERGY: f64 = 1e-13;

/// Bounds within this share of the distance to the first bound are met together with it.
const FIRST: f64 = 1e-12;

/// The place of an unknown with bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum At {
    Free,
    Lower,
    Upper,
    /// Both bounds are equal.
    Fixed,
}

/// The unknowns after reflections and shears, their gradient, and the bounds that they are at.
pub struct BoundedIterate<'a> {
    pub problem: &'a ContactProblem,
    pub bounds: &'a Bounds,
    pub load: Vec<f64>,
    /// Diagonal of K at the unknowns with bounds and at all others.
    diagonal: Vec<f64>,
    pub x: Vec<f64>,
    pub gradient: Vec<f64>,
    pub at: Vec<At>,
    /// An upper bound on the eigenvalues of D^-1 K, once it is asked for.
    largest_eigenvalue: OnceCell<f64>,
    multigrid: &'a Multigrid,
    /// Work vectors of the length of the unknowns.
    pub work: &'a Spare<f64>,
}

/// A direction with its product by K.
pub struct Move {
    pub way: Vec<f64>,
    pub force: Vec<f64>,
    /// `way'K way`, zero if that is rounding.
    pub energy: f64,
}

impl Move {
    pub fn of(way: Vec<f64>, iterate: &BoundedIterate) -> Self {
        let force = iterate.product(&way);
        let (energy, own) = (dot(&way, &force), way.iter().zip(&iterate.diagonal).map(|(p, d)| d * p * p));
        let is_rounding = energy.abs() <= NO_ENERGY * own.sum::<f64>() || !energy.is_finite();
        Move { way, force, energy: if is_rounding { 0.0 } else { energy } }
    }
}

impl<'a> BoundedIterate<'a> {
    pub fn new(problem: &'a ContactProblem, bounds: &'a Bounds, start: Start, multigrid: &'a Multigrid) -> Self {
        let mut load = problem.load().to_vec();
        bounds.turn_forces(&mut load);
        let is_unknown = start.displacement.is_none();
        let mut x = start.displacement.unwrap_or_else(|| vec![0.0; problem.dofs()]);
        bounds.turn(&mut x);
        let diagonal = bounds.turned_diagonal(problem.stiffness().diagonal());
        let at = vec![At::Free; bounds.bounds.len()];
        let (gradient, largest_eigenvalue) = (Vec::new(), OnceCell::new());
        let work = multigrid.work();
        let mut iterate =
            BoundedIterate { problem, bounds, load, diagonal, x, gradient, at, largest_eigenvalue, multigrid, work };
        if is_unknown {
            iterate.travel_along_load();
        }
        if let Some(closed) = &start.contact_set {
            for bound in &bounds.bounds {
                let value = &mut iterate.x[bound.unknown];
                if let Some(held) = bound.closed_at(closed) {
                    *value = held;
                } else if *value >= bound.upper {
                    *value = bound.upper - INSIDE * bound.upper.abs();
                } else if *value <= bound.lower {
                    *value = bound.lower + INSIDE * bound.lower.abs();
                }
            }
        }
        iterate.project();
        iterate.refresh_gradient();
        iterate
    }

    /// Moves each travel, of a body at rest, along its load, about as far as that reaches: N closed rows resist like
    /// `sqrt(N)` single ones, as a circle of that area on a half space does. Too deep or too shallow by half costs a
    /// few cycles.
    fn travel_along_load(&mut self) {
        for &travel in &self.bounds.travels {
            let (load, way) = (self.problem.load()[travel].abs(), self.problem.load()[travel].signum());
            let of_row = |bound: &Bound| {
                let share = bound.travel.filter(|own| own.0 == travel && own.1 != 0.0)?.1;
                let value = if way * share > 0.0 { bound.upper } else { bound.lower };
                let depth = way * value / share;
                depth.is_finite().then(|| (depth, share * share * self.diagonal[bound.unknown]))
            };
            let mut rows: Vec<(f64, f64)> = self.bounds.bounds.iter().filter_map(of_row).collect();
            rows.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            let (mut stiffness, mut force) = (0.0, 0.0);
            for (index, &(depth, own)) in rows.iter().enumerate() {
                stiffness += own;
                let resists = stiffness / ((index + 1) as f64).sqrt();
                let room = rows.get(index + 1).map_or(f64::INFINITY, |next| next.0 - depth);
                self.x[travel] = way * (depth + room.min((load - force) / resists));
                force += resists * room;
                if force >= load {
                    break;
                }
            }
        }
        for bound in &self.bounds.bounds {
            if let Some((travel, share)) = bound.travel {
                self.x[bound.unknown] = share * self.x[travel];
            }
        }
    }

    /// The direction of a step p that is conjugate to the last one, and the free gradient along it.
    pub fn conjugate(&self, mut p: Vec<f64>, last: Option<Move>, gradient: &[f64]) -> (Move, f64) {
        if let Some(last) = last {
            let share = dot(&p, &last.force) / last.energy;
            p.iter_mut().zip(&last.way).for_each(|(p, before)| *p -= share * before);
            [last.way, last.force].into_iter().for_each(|vector| self.work.give(vector));
        }
        let slope = dot(gradient, &p);
        if slope < 0.0 {
            // Rounding of the cycle may make a direction point uphill.
            p.iter_mut().for_each(|p| *p = -*p);
        }
        (Move::of(p, self), slope.abs())
    }

    pub fn product(&self, v: &[f64]) -> Vec<f64> {
        let mut u = self.work.copy(v);
        self.bounds.turn_back(&mut u);
        let mut moved = self.multigrid.product(self.problem.stiffness(), &u);
        self.work.give(u);
        self.bounds.turn_forces(&mut moved);
        moved
    }

    pub fn refresh_gradient(&mut self) {
        let moved = self.product(&self.x);
        self.work.give(std::mem::replace(&mut self.gradient, moved));
        self.gradient.iter_mut().zip(&self.load).for_each(|(g, f)| *g -= f);
    }

    /// As [`BoundedIterate::refresh_gradient`], in twice the working precision.
    pub fn refresh_gradient_accurately(&mut self) {
        let mut u = self.x.clone();
        self.bounds.turn_back(&mut u);
        let mut rest = self.problem.accurate_residual(&u, &vec![0.0; self.problem.rows()]);
        self.bounds.turn_forces(&mut rest);
        rest.iter_mut().for_each(|rest| *rest = -*rest);
        self.gradient = rest;
    }

    /// Moves the unknowns into their bounds, and records which are at a bound.
    fn project(&mut self) {
        for (bound, at) in self.bounds.bounds.iter().zip(&mut self.at) {
            let value = &mut self.x[bound.unknown];
            *value = value.min(bound.upper).max(bound.lower);
            *at = match (*value == bound.lower, *value == bound.upper) {
                (true, true) => At::Fixed,
                (true, false) => At::Lower,
                (false, true) => At::Upper,
                (false, false) => At::Free,
            };
        }
    }

    /// The part of the gradient at a closed bound that the bound carries.
    pub fn held_gradient(&self, index: usize) -> f64 {
        let gradient = self.gradient[self.bounds.bounds[index].unknown];
        match self.at[index] {
            At::Free => 0.0,
            At::Lower => gradient.max(0.0),
            At::Upper => gradient.min(0.0),
            At::Fixed => gradient,
        }
    }

    /// The part of the gradient at a closed bound that would open it.
    fn chopped_gradient(&self, index: usize) -> f64 {
        match self.at[index] {
            At::Free => 0.0,
            _ => self.gradient[self.bounds.bounds[index].unknown] - self.held_gradient(index),
        }
    }

    /// What `read` finds in the gradient of the unknowns that may move; it is zero at all others.
    pub fn of_free_gradient<R>(&self, read: impl FnOnce(&[f64]) -> R) -> R {
        let mut free = self.work.copy(&self.gradient);
        self.keep_free(&mut free);
        let found = read(&free);
        self.work.give(free);
        found
    }

    pub fn keep_free(&self, values: &mut [f64]) {
        self.closed().for_each(|bound| values[bound.unknown] = 0.0);
    }

    /// The bounds that are met.
    fn closed(&self) -> impl Iterator<Item = &'a Bound> {
        self.bounds.bounds.iter().zip(&self.at).filter(|entry| *entry.1 != At::Free).map(|entry| entry.0)
    }

    /// A travel by one while the body stays at rest.
    pub fn alone(&self, travel: usize) -> Vec<f64> {
        let mut way = vec![0.0; self.x.len()];
        way[travel] = 1.0;
        self.bounds.turn(&mut way);
        way
    }

    /// Returns `true` if a row of the travel is at its bound.
    pub fn is_held(&self, travel: usize) -> bool {
        self.closed().any(|bound| bound.travel.is_some_and(|own| own.0 == travel))
    }

    /// The largest force that is out of balance or wrong-signed, relative to the largest of load and multipliers.
    pub fn residual(&self) -> f64 {
        let bounds = 0..self.at.len();
        let held = bounds.clone().map(|index| self.held_gradient(index).abs()).fold(0.0, f64::max);
        let chopped = bounds.map(|index| self.chopped_gradient(index).abs()).fold(0.0, f64::max);
        let wrong = self.of_free_gradient(largest).max(chopped);
        if wrong == 0.0 { 0.0 } else { wrong / held.max(largest(&self.load)) }
    }

    /// Returns `true` if the chopped gradient is larger than the free one.
    pub fn is_disproportionate(&self) -> bool {
        let weighted = |value: f64, unknown: usize| value * value / self.diagonal[unknown];
        let sum = |free: &[f64]| free.iter().enumerate().map(|(unknown, &g)| weighted(g, unknown)).sum::<f64>();
        let free = self.of_free_gradient(sum);
        let chopped = |(index, bound): (usize, &Bound)| weighted(self.chopped_gradient(index), bound.unknown);
        self.bounds.bounds.iter().enumerate().map(chopped).sum::<f64>() > free
    }

    /// A step along the chopped gradient to the least energy, unless other bounds end it before.
    pub fn proportion(&mut self) {
        let mut direction = vec![0.0; self.x.len()];
        for (index, bound) in self.bounds.bounds.iter().enumerate() {
            direction[bound.unknown] = self.chopped_gradient(index) / self.diagonal[bound.unknown];
        }
        let moved = self.product(&direction);
        let length = (dot(&self.gradient, &direction) / dot(&direction, &moved)).min(self.longest_step(&direction));
        self.step_along(&direction, &moved, length);
        self.project();
    }

    fn step_along(&mut self, direction: &[f64], moved: &[f64], length: f64) {
        self.x.iter_mut().zip(direction).for_each(|(x, d)| *x -= length * d);
        self.gradient.iter_mut().zip(moved).for_each(|(g, m)| *g -= length * m);
    }

    /// The largest t that keeps x - t d within the bounds.
    pub fn longest_step(&self, direction: &[f64]) -> f64 {
        let room = |bound: &Bound| {
            let (value, speed) = (self.x[bound.unknown], direction[bound.unknown]);
            match speed {
                _ if speed > 0.0 => (value - bound.lower) / speed,
                _ if speed < 0.0 => (value - bound.upper) / speed,
                _ => f64::INFINITY,
            }
        };
        self.bounds.bounds.iter().map(room).fold(f64::INFINITY, f64::min)
    }

    /// The step of length `room`, which the first bounds end. Their unknowns are set exactly to them; otherwise
    /// rounding could leave them short of the bound in every iteration.
    fn step_to_bounds(&mut self, direction: &Move, room: f64) {
        let meets = |bound: &Bound, x: &[f64]| {
            let (value, speed) = (x[bound.unknown], direction.way[bound.unknown]);
            let met = if speed > 0.0 { bound.lower } else { bound.upper };
            (speed != 0.0 && (value - met) / speed <= room * (1.0 + FIRST)).then_some((bound.unknown, met))
        };
        let met: Vec<(usize, f64)> = self.bounds.bounds.iter().filter_map(|bound| meets(bound, &self.x)).collect();
        self.step_along(&direction.way, &direction.force, room);
        met.iter().for_each(|&(unknown, value)| self.x[unknown] = value);
        self.project();
    }

    /// The CG step or, if it would cross bounds, the expansion: its projection. If that raises the energy, the
    /// expansion is the least energy on the way there or the step to the first bound, whichever is lower, and a
    /// projected gradient step. Returns the direction if the next one is conjugate to it.
    pub fn advance(&mut self, direction: Move, slope: f64) -> Option<Move> {
        let length = slope / direction.energy;
        let room = self.longest_step(&direction.way);
        if length <= room {
            self.step_along(&direction.way, &direction.force, length);
            self.project();
            return Some(direction);
        }
        let (x, gradient, at) = (self.x.clone(), self.gradient.clone(), self.at.clone());
        let mut on_the_way = None;
        if length.is_finite() {
            self.x.iter_mut().zip(&direction.way).for_each(|(x, p)| *x -= length * p);
            self.project();
            self.refresh_gradient();
            on_the_way = self.least_energy_from(&x, &gradient);
        }
        let to_bounds = room * slope - 0.5 * room * room * direction.energy;
        match on_the_way {
            Some((share, _)) if share >= 1.0 => return None,
            Some((share, fall)) if fall >= to_bounds => {
                for (new, old) in self.x.iter_mut().zip(&x).chain(self.gradient.iter_mut().zip(&gradient)) {
                    *new = old + share * (*new - old);
                }
                self.project();
            }
            _ => {
                (self.x, self.gradient, self.at) = (x, gradient, at);
                self.step_to_bounds(&direction, room);
            }
        }
        let share = 1.0 / self.largest_eigenvalue.get_or_init(|| self.largest_eigenvalue());
        let mut free = self.work.copy(&self.gradient);
        self.keep_free(&mut free);
        self.bounds.travels.iter().for_each(|&travel| free[travel] = 0.0);
        for ((x, g), d) in self.x.iter_mut().zip(&free).zip(&self.diagonal) {
            *x -= share * g / d;
        }
        self.work.give(free);
        self.project();
        self.refresh_gradient();
        None
    }

    /// The share of the way from `x`, with its `gradient`, to the present unknowns that is to be taken, and the
    /// decrease of the energy: the whole way if the energy at its end is lower, otherwise the way to the least energy;
    /// `None` if the energy rises at once.
    fn least_energy_from(&self, x: &[f64], gradient: &[f64]) -> Option<(f64, f64)> {
        let (mut slope, mut curvature) = (0.0, 0.0);
        for ((new, old), (after, before)) in self.x.iter().zip(x).zip(self.gradient.iter().zip(gradient)) {
            slope += (new - old) * before;
            curvature += (new - old) * (after - before);
        }
        let at_end = slope + 0.5 * curvature;
        (slope < 0.0).then(|| match at_end < 0.0 {
            true => (1.0, -at_end),
            false => (-slope / curvature, 0.5 * slope * slope / curvature),
        })
    }

    /// An upper bound on the eigenvalues of `D^-1 K`, by Gershgorin's circles; shears multiply it at most by the
    /// unknowns that they join.
    fn largest_eigenvalue(&self) -> f64 {
        let mut weights: Vec<f64> = self.diagonal.iter().map(|d| 1.0 / d.sqrt()).collect();
        self.bounds.scale(&mut weights, 1);
        let sums = self.problem.stiffness().mul_abs(&weights);
        let circles = sums.iter().zip(&weights).map(|(sum, weight)| sum * weight).fold(1.0, f64::max);
        circles * self.bounds.most_joined() as f64
    }

    /// What the closed bounds hold, in the units of the dofs.
    pub fn held(&self) -> Vec<Hold> {
        self.bounds.holds(self.closed())
    }

    /// One cycle in a face, in which nothing travels and no bound opens.
    pub fn preconditioned(&self, face: &Face, gradient: &[f64]) -> Vec<f64> {
        let mut force = self.work.copy(gradient);
        self.bounds.turn_forces_back(&mut force);
        let mut step = face.cycle(&force);
        self.work.give(force);
        self.bounds.turn(&mut step);
        self.keep_free(&mut step);
        step
    }

    /// The present set, as an entry of the history.
    pub fn step(&self) -> Iteration {
        let (_, contact_set) = self.bounds.multipliers(|index| match self.at[index] {
            At::Free => 0.0,
            At::Lower => 1.0,
            At::Upper | At::Fixed => -1.0,
        });
        Iteration { contact_set, penalty: 0.0 }
    }
}
