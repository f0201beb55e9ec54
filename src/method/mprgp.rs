//! MPRGP: modified proportioning with reduced gradient projections, preconditioned in the free face.
//!
//! Rows are turned into bounds by reflections. With the gradient g = K u - f, split into the free gradient, of unknowns
//! that may move, and the chopped gradient, of those that want to leave their bound, an iteration is one of
//!
//! ```text
//! proportioning   where the chopped gradient outweighs the free one: a step along it, which opens rows
//! CG step         along conjugate directions of the free face, one cycle of the hierarchy each
//! expansion       where the CG step would cross bounds: its projection, which closes rows; should that raise the energy,
//!                 the step to the first bound and a projected gradient step of fixed length
//! ```
//!
//! The energy falls in every one of them. The hierarchy is built once, for K; a face is a small change of it.
//!
//! # Source
//! Z. Dostál, *Optimal Quadratic Programming Algorithms*, Springer (2009), algorithm 5.8 and section 5.10.

use super::bounds::{Bound, Bounds};
use super::holding::FreeMotion;
use super::{Outcome, SIGN_TOLERANCE};
use crate::error::Error;
use crate::problem::ContactProblem;
use crate::solution::{ContactSet, Iteration};
use crate::sparse::multigrid::{Direction, Face, Multigrid};
use crate::sparse::{dot, largest};
use crate::watch::Watch;

/// Iterations without a residual half as large as the best before, after which the loop has stagnated.
const PATIENCE: usize = 60;

/// Rows that are open at the start although nothing has moved keep this share of their depth as distance.
const INSIDE: f64 = 1e-3;

/// Energy of a direction below this share of its terms is rounding of zero.
const NO_ENERGY: f64 = 1e-13;

/// What is known beforehand.
#[derive(Clone, Copy, Debug, Default)]
pub struct Start<'a> {
    /// A displacement near the answer, one entry per dof.
    pub displacement: Option<&'a [f64]>,
    /// A contact set near that of the answer.
    pub contact_set: Option<&'a ContactSet>,
}

/// When the loop ends.
#[derive(Clone, Copy, Debug)]
pub struct Limits<'a> {
    /// Largest imbalance of forces and largest wrong-signed multiplier, relative to the largest force.
    pub tolerance: f64,
    /// Most cycles of the hierarchy.
    pub most_cycles: usize,
    /// Whether it must end before.
    pub watch: &'a Watch,
}

/// Finds displacement, multipliers and contact set; `iterations` counts the cycles of the hierarchy.
///
/// # Errors
/// [`Error::Numerical`] for rows that no turning makes bounds of, [`Error::NotConvex`] for a direction of negative energy
/// in a face, [`Error::Unbounded`] for a load that drives a motion which no row stops.
pub fn solve(problem: &ContactProblem, multigrid: &Multigrid, start: Start, limits: Limits) -> Result<Outcome, Error> {
    let bounds = Bounds::of(problem.contact(), problem.gap())?;
    let mut iterate = Iterate::new(problem, &bounds, start);
    let mut history = vec![iterate.step()];
    let mut face = None;
    let mut last: Option<Conjugate> = None;
    let (mut cycles, mut settled) = (0, false);
    let (mut best, mut since_best, mut is_fresh) = (f64::INFINITY, 0, true);
    while cycles < limits.most_cycles && since_best < PATIENCE && !limits.watch.is_over() {
        let residual = iterate.residual();
        if residual <= limits.tolerance {
            if is_fresh {
                settled = true;
                break;
            }
            // What the steps have carried along is checked before it is believed.
            iterate.refresh_gradient();
            (is_fresh, last) = (true, None);
            continue;
        }
        is_fresh = false;
        since_best += 1;
        if residual < 0.5 * best {
            (best, since_best) = (residual, 0);
        }
        let before = iterate.at.clone();
        if iterate.is_disproportionate() {
            iterate.proportion();
        } else {
            let gradient = iterate.free_gradient();
            let free_face = match face.take() {
                Some(free_face) => free_face,
                None => multigrid.face(&iterate.held())?,
            };
            let step = iterate.preconditioned(&free_face, &gradient);
            face = Some(free_face);
            cycles += 1;
            limits.watch.step("MPRGP", cycles);
            let direction = Conjugate::of(step, last.take(), &gradient, &iterate);
            if direction.is_free {
                return Err(iterate.free_motion(direction.p));
            }
            if direction.energy < 0.0 {
                let evidence = format!("a search direction p has p'Kp = {:e}", direction.energy);
                return Err(Error::NotConvex { evidence });
            }
            iterate.advance(&direction);
            last = Some(direction);
        }
        if iterate.at != before {
            (face, last) = (None, None);
            history.push(iterate.step());
        }
    }
    let (multiplier, contact_set) = bounds.multipliers(|index| iterate.held_gradient(index));
    let mut displacement = iterate.x;
    bounds.turn_back(&mut displacement);
    let variant = if settled { "" } else { "-unsettled" };
    Ok(Outcome { displacement, multiplier, contact_set, iterations: cycles, history, settled, variant })
}

/// Where an unknown with bounds is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum At {
    Free,
    Lower,
    Upper,
    /// Both bounds are one.
    Fixed,
}

/// The unknowns, turned, their gradient, and which of them are at bounds.
struct Iterate<'a> {
    problem: &'a ContactProblem,
    bounds: &'a Bounds,
    load: Vec<f64>,
    /// Diagonal of K at the unknowns with bounds and at all others.
    diagonal: Vec<f64>,
    x: Vec<f64>,
    gradient: Vec<f64>,
    at: Vec<At>,
}

/// A direction with its product.
struct Conjugate {
    p: Vec<f64>,
    moved: Vec<f64>,
    energy: f64,
    /// Free gradient along it.
    slope: f64,
    /// Does it cost nothing and meet no bound?
    is_free: bool,
}

impl Conjugate {
    fn of(step: Vec<f64>, last: Option<Conjugate>, gradient: &[f64], iterate: &Iterate) -> Self {
        let mut p = step;
        if let Some(last) = last {
            let share = dot(&p, &last.moved) / last.energy;
            p.iter_mut().zip(&last.p).for_each(|(p, before)| *p -= share * before);
        }
        let slope = dot(gradient, &p);
        if slope < 0.0 {
            // Rounding of the cycle may turn a direction uphill.
            p.iter_mut().for_each(|p| *p = -*p);
        }
        let slope = slope.abs();
        let moved = iterate.product(&p);
        let energy = dot(&p, &moved);
        let terms: f64 = p.iter().zip(&moved).map(|(p, m)| (p * m).abs()).sum();
        let costs_nothing = energy.abs() <= NO_ENERGY * terms || !energy.is_finite();
        let is_free = costs_nothing && iterate.longest_step(&p).is_infinite();
        let energy = if costs_nothing { 0.0 } else { energy };
        Conjugate { p, moved, energy, slope, is_free }
    }
}

impl<'a> Iterate<'a> {
    fn new(problem: &'a ContactProblem, bounds: &'a Bounds, start: Start) -> Self {
        let mut load = problem.load().to_vec();
        bounds.turn(&mut load);
        let mut x = start.displacement.map_or_else(|| vec![0.0; problem.dofs()], <[f64]>::to_vec);
        bounds.turn(&mut x);
        let diagonal = problem.stiffness().diagonal();
        let at = vec![At::Free; bounds.bounds().len()];
        let mut iterate = Iterate { problem, bounds, load, diagonal, x, gradient: Vec::new(), at };
        for (index, bound) in bounds.bounds().iter().enumerate() {
            if let Some(closed) = start.contact_set {
                let value = &mut iterate.x[bound.unknown];
                if bounds.is_closed(index, true, closed) {
                    *value = bound.upper;
                } else if bounds.is_closed(index, false, closed) {
                    *value = bound.lower;
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

    fn product(&self, v: &[f64]) -> Vec<f64> {
        if self.bounds.is_plain() {
            return self.problem.stiffness().mul(v);
        }
        let mut u = v.to_vec();
        self.bounds.turn_back(&mut u);
        let mut moved = self.problem.stiffness().mul(&u);
        self.bounds.turn(&mut moved);
        moved
    }

    fn refresh_gradient(&mut self) {
        self.gradient = self.product(&self.x);
        self.gradient.iter_mut().zip(&self.load).for_each(|(g, f)| *g -= f);
    }

    /// Moves the unknowns into their bounds, and sees which are at them.
    fn project(&mut self) {
        for (bound, at) in self.bounds.bounds().iter().zip(&mut self.at) {
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

    /// The gradient of a bound that is closed, as far as the bound takes it.
    fn held_gradient(&self, index: usize) -> f64 {
        let gradient = self.gradient[self.bounds.bounds()[index].unknown];
        match self.at[index] {
            At::Free => 0.0,
            At::Lower => gradient.max(0.0),
            At::Upper => gradient.min(0.0),
            At::Fixed => gradient,
        }
    }

    /// The gradient of a bound that is closed, as far as the unknown wants to leave it.
    fn chopped_gradient(&self, index: usize) -> f64 {
        match self.at[index] {
            At::Free => 0.0,
            _ => self.gradient[self.bounds.bounds()[index].unknown] - self.held_gradient(index),
        }
    }

    fn free_gradient(&self) -> Vec<f64> {
        let mut free = self.gradient.clone();
        self.keep_free(&mut free);
        free
    }

    fn keep_free(&self, values: &mut [f64]) {
        for (bound, at) in self.bounds.bounds().iter().zip(&self.at) {
            if *at != At::Free {
                values[bound.unknown] = 0.0;
            }
        }
    }

    /// The largest force that is out of balance or wrong-signed, relative to the largest of load and multipliers.
    fn residual(&self) -> f64 {
        let bounds = 0..self.at.len();
        let held = bounds.clone().map(|index| self.held_gradient(index).abs()).fold(0.0, f64::max);
        let chopped = bounds.map(|index| self.chopped_gradient(index).abs()).fold(0.0, f64::max);
        let wrong = largest(&self.free_gradient()).max(chopped);
        if wrong == 0.0 { 0.0 } else { wrong / held.max(largest(&self.load)) }
    }

    /// Does the chopped gradient outweigh the free one?
    fn is_disproportionate(&self) -> bool {
        let weighted = |value: f64, unknown: usize| value * value / self.diagonal[unknown];
        let free: f64 = self.free_gradient().iter().enumerate().map(|(unknown, &g)| weighted(g, unknown)).sum();
        let chopped = |(index, bound): (usize, &Bound)| weighted(self.chopped_gradient(index), bound.unknown);
        self.bounds.bounds().iter().enumerate().map(chopped).sum::<f64>() > free
    }

    /// A step along the chopped gradient to the least energy, as far as the other bounds let it.
    fn proportion(&mut self) {
        let mut direction = vec![0.0; self.x.len()];
        for (index, bound) in self.bounds.bounds().iter().enumerate() {
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

    /// The longest t for which x - t d keeps within the bounds.
    fn longest_step(&self, direction: &[f64]) -> f64 {
        let room = |bound: &Bound| {
            let (value, speed) = (self.x[bound.unknown], direction[bound.unknown]);
            match speed {
                _ if speed > 0.0 => (value - bound.lower) / speed,
                _ if speed < 0.0 => (value - bound.upper) / speed,
                _ => f64::INFINITY,
            }
        };
        self.bounds.bounds().iter().map(room).fold(f64::INFINITY, f64::min)
    }

    /// The CG step, or where it would cross bounds, the expansion.
    fn advance(&mut self, direction: &Conjugate) {
        let length = direction.slope / direction.energy;
        let room = self.longest_step(&direction.p);
        if length <= room {
            self.step_along(&direction.p, &direction.moved, length);
            self.project();
            return;
        }
        let (x, gradient, at) = (self.x.clone(), self.gradient.clone(), self.at.clone());
        if length.is_finite() {
            self.x.iter_mut().zip(&direction.p).for_each(|(x, p)| *x -= length * p);
            self.project();
            self.refresh_gradient();
            let change: f64 = (self.x.iter().zip(&x))
                .zip(self.gradient.iter().zip(&gradient))
                .map(|((new, old), (g, before))| (new - old) * (g + before))
                .sum();
            if change < 0.0 {
                return;
            }
        }
        (self.x, self.gradient, self.at) = (x, gradient, at);
        self.step_along(&direction.p, &direction.moved, room);
        let share = 1.0 / self.largest_eigenvalue();
        let free = self.free_gradient();
        for ((x, g), d) in self.x.iter_mut().zip(&free).zip(&self.diagonal) {
            *x -= share * g / d;
        }
        self.project();
        self.refresh_gradient();
    }

    /// An upper bound on the eigenvalues of `D^-1 K`, by Gershgorin's circles.
    fn largest_eigenvalue(&self) -> f64 {
        let weights: Vec<f64> = self.diagonal.iter().map(|d| 1.0 / d.sqrt()).collect();
        let sums = self.problem.stiffness().mul_abs(&weights);
        sums.iter().zip(&weights).map(|(sum, weight)| sum * weight).fold(1.0, f64::max)
    }

    /// What may not move, in the dofs of the problem.
    fn held(&self) -> Vec<Direction> {
        let closed = self.bounds.bounds().iter().zip(&self.at).filter(|entry| *entry.1 != At::Free);
        closed.map(|(bound, _)| self.bounds.direction(bound)).collect()
    }

    fn preconditioned(&self, face: &Face, gradient: &[f64]) -> Vec<f64> {
        let mut force = gradient.to_vec();
        self.bounds.turn_back(&mut force);
        let mut step = face.cycle(&force);
        self.bounds.turn(&mut step);
        self.keep_free(&mut step);
        step
    }

    /// The set as it stands.
    fn step(&self) -> Iteration {
        let (_, contact_set) = self.bounds.multipliers(|index| match self.at[index] {
            At::Free => 0.0,
            At::Lower => 1.0,
            At::Upper | At::Fixed => -1.0,
        });
        Iteration { contact_set, penalty: 0.0 }
    }

    /// The load drives the way down the gradient, and nothing stops it.
    fn free_motion(&self, mut direction: Vec<f64>) -> Error {
        self.bounds.turn_back(&mut direction);
        let size = -largest(&direction);
        direction.iter_mut().for_each(|value| *value /= size);
        let driven = dot(self.problem.load(), &direction) > SIGN_TOLERANCE * largest(self.problem.load());
        FreeMotion { direction, driven }.into_error()
    }
}
